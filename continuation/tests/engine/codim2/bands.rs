//! Banded problems: the same points, at the cost of a band.

use super::{account, follow};
use continuation::codim2::FoldCurve;
use continuation::linalg::{Matrix, SymmetricBand};
use continuation::{
    Branch, EvalError, EventKind, Name, ParamId, Parameter, Problem, Settings, Stability, Tracer,
    Watch, names,
};
use std::ops::ControlFlow;
use std::time::Instant;

/// `−u″ = λ exp(u/(1 + εu))` by finite differences, multiplied by the spacing: thermal ignition
/// with Arrhenius' law.
pub(super) struct Ignition {
    pub(super) n: usize,
}

impl Ignition {
    fn h(&self) -> f64 {
        1.0 / (self.n as f64 + 1.0)
    }
}

impl Problem for Ignition {
    type Jacobian = SymmetricBand;
    fn dim(&self) -> usize {
        self.n
    }
    fn parameters(&self) -> &[Parameter] {
        const { &[Parameter::new("lambda", "", 1.0), Parameter::new("epsilon", "", 0.1)] }
    }
    fn new_jacobian(&self) -> SymmetricBand {
        SymmetricBand::new(self.n, 1)
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let h = self.h();
        let at = |i: usize| if i == 0 || i > self.n { 0.0 } else { u[i - 1] };
        for i in 1..=self.n {
            let rate = (at(i) / (1.0 + p[1] * at(i))).exp();
            r[i - 1] = (2.0 * at(i) - at(i - 1) - at(i + 1)) / h - h * p[0] * rate;
        }
        Ok(())
    }
    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut SymmetricBand) -> Result<(), EvalError> {
        let h = self.h();
        j.set_zero();
        for (i, u) in u.iter().enumerate() {
            let d = 1.0 / (1.0 + p[1] * u);
            let column = j.column_mut(i);
            column[0] = 2.0 / h - h * p[0] * (u * d).exp() * d * d;
            if let Some(below) = column.get_mut(1) {
                *below = -1.0 / h;
            }
        }
        Ok(())
    }
    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        for (o, u) in out.iter_mut().zip(u) {
            let d = u / (1.0 + p[1] * u);
            *o = -self.h() * d.exp() * if which.0 == 0 { 1.0 } else { -p[0] * d * d };
        }
        Ok(())
    }
    fn metric(&self, x: &[f64], y: &mut [f64]) {
        y.iter_mut().zip(x).for_each(|(y, x)| *y = self.h() * x);
    }
    fn stability(&self) -> Stability {
        Stability::EnergyHessian
    }
    fn observables(&self) -> &[Name] {
        names!["middle"]
    }
    fn observe(&self, u: &[f64], _: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        out[0] = u[self.n / 2];
        Ok(())
    }
}

pub(super) fn ignition_branch<P: Problem>(problem: &P) -> Branch {
    let settings = Settings { increasing: Some(true), ..Settings::default() };
    let u = vec![0.0; problem.dim()];
    Tracer::new(problem, "lambda", &u, &[0.0, 0.2], settings)
        .unwrap()
        .watching(&[Watch::stop_at("middle", 30.0)])
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()))
}

/// The cusp of the differential equation, from its time map `√(λ/8) = ∫₀¹ √m ds / √(∫₀¹ f(m(1 −
/// s²t)) dt)` in multiple precision: `λ' = λ'' = 0` at `m = max u = 4.896547899874779`.
const CUSP: (f64, f64) = (5.229_494_254_692_837, 0.245_780_427_232_365_6);

#[test]
fn the_cusp_of_ignition_at_the_cost_of_a_band() {
    let mut found = Vec::new();
    for n in [399, 799] {
        let problem = Ignition { n };
        let branch = ignition_branch(&problem);
        let mut cusps = Vec::new();
        for fold in branch.events_of(&EventKind::Fold) {
            let curve = FoldCurve::at(&problem, &branch, fold, "epsilon").unwrap();
            let begin = Instant::now();
            let result = follow(&curve, (0.1, 0.4), None, &[Watch::stop_at("lambda", 9.0)]);
            let seconds = begin.elapsed().as_secs_f64();
            let points = result.branch.points.len();
            println!(
                "{n}: {:.2} ms per point; {}",
                1e3 * seconds / points as f64,
                account(&result, "lambda")
            );
            let lambda = result.column("lambda").unwrap();
            let [cusp, ..] = &result.branch.events[..] else { panic!("no cusp") };
            let cusp = result.branch.events_of(&EventKind::Cusp).next().unwrap_or(cusp);
            assert_eq!(cusp.kind, EventKind::Cusp);
            cusps.push((lambda[cusp.point], cusp.p));
            assert!(seconds / (points as f64) < 0.02, "{seconds} s for {points} points");
        }
        assert_eq!(cusps.len(), 2);
        // met from both folds
        assert!((cusps[0].0 - cusps[1].0).abs() < 1e-8 && (cusps[0].1 - cusps[1].1).abs() < 1e-8);
        found.push(cusps[0]);
    }
    let limit = |a: f64, b: f64| b + (b - a) / 3.0;
    let lambda = limit(found[0].0, found[1].0);
    let epsilon = limit(found[0].1, found[1].1);
    println!("extrapolated: {lambda:.12} {epsilon:.12}");
    assert!((lambda / CUSP.0 - 1.0).abs() < 1e-8 && (epsilon / CUSP.1 - 1.0).abs() < 1e-8);
    assert!((found[1].0 / CUSP.0 - 1.0).abs() < 1e-5 && (found[1].1 / CUSP.1 - 1.0).abs() < 1e-5);
}
