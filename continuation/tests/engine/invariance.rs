//! The units of `f`, `u` and `p` do not matter: same special points, same types, same steps.

#![allow(clippy::unwrap_used)]

use crate::scaled;

use continuation::linalg::{Dense, Matrix};
use continuation::samples::Bratu;
use continuation::{
    Branch, DenseProblem, Detail, EvalError, ParamId, Parameter, Problem, Settings, Stability,
    Tracer,
};
use scaled::{SCALES, Scaled};
use std::ops::ControlFlow;

/// Kind, type and place, the place in the original unit.
fn account(branch: &Branch, c: f64) -> Vec<(String, f64)> {
    let what = |e: &continuation::Event| match &e.detail {
        Detail::Crossing(x) => {
            format!("{} {:?} {:?} {}", e.kind, x.shape, x.criticality, x.multiplicity)
        }
        Detail::Hopf(h) => format!("{} {:?}", e.kind, h.criticality),
        Detail::Fold(f) => format!("{} {}", e.kind, f.curvature > 0.0),
        _ => e.kind.to_string(),
    };
    branch.events.iter().map(|e| (what(e), e.p / c)).collect()
}

fn compare<P: Problem>(make: impl Fn() -> P, u: &[f64], p: f64, target: f64, sides: bool) {
    let trace = |(a, b, c): (f64, f64, f64)| {
        let problem = Scaled::new(make(), a, b, &[c]);
        let u: Vec<f64> = u.iter().map(|x| x * b).collect();
        let name = &problem.parameters()[0].name;
        let settings = Settings { target: Some(target * c), ..Settings::default() };
        let branch = Tracer::new(&problem, name, &u, &[p * c], settings.clone())
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(()));
        let mut all = account(&branch, c);
        let mut steps = branch.statistics.accepted;
        if sides {
            let ends = [target * c, (2.0 * p - target) * c];
            let domain = Some((ends[0].min(ends[1]), ends[0].max(ends[1])));
            let settings = Settings { target: None, domain, max_points: 150, ..settings };
            for event in &branch.events {
                let Some(crossing) = event.crossing() else { continue };
                let side = Tracer::leaving(
                    &problem,
                    &branch,
                    event,
                    &crossing.leaving[0],
                    true,
                    settings.clone(),
                )
                .unwrap()
                .run(&mut |_| ControlFlow::Continue(()));
                assert!(side.points.len() > 10, "{:?}", side.stopped);
                all.extend(account(&side, c));
                steps += side.statistics.accepted;
            }
        }
        (all, steps)
    };
    let (known, steps) = trace((1.0, 1.0, 1.0));
    assert!(!known.is_empty());
    for scales in SCALES {
        let (found, these) = trace(scales);
        let kinds = |all: &[(String, f64)]| all.iter().map(|e| e.0.clone()).collect::<Vec<_>>();
        assert_eq!(kinds(&found), kinds(&known), "{scales:?}");
        for ((kind, at), (_, known)) in found.iter().zip(&known) {
            let range = (target - p).abs();
            assert!((at - known).abs() < 1e-9 * range, "{scales:?} {kind}: {at} {known}");
        }
        assert!(these.abs_diff(steps) as f64 <= 0.1 * steps as f64, "{scales:?} {these} {steps}");
    }
}

#[test]
fn folds_and_pitchforks() {
    let enz = || {
        DenseProblem::from_residual(2, &["p"], |s, p, r| {
            let rate = |s: f64| 100.0 * s / (1.0 + s + s * s);
            r[0] = p[0] - 2.0 * s[0] + s[1] - rate(s[0]);
            r[1] = p[0] - 2.0 * s[1] + s[0] - rate(s[1]);
        })
        .boxed()
    };
    compare(enz, &[0.0, 0.0], 0.0, 40.0, true);
}

#[test]
fn hopf_points() {
    let ab = || {
        DenseProblem::from_residual(2, &["p"], |u, p, r| {
            let rate = p[0] * (1.0 - u[0]) * u[1].exp();
            r[0] = -u[0] + rate;
            r[1] = -u[1] + 18.0 * rate - 3.0 * u[1];
        })
        .boxed()
    };
    compare(ab, &[0.0, 0.0], 0.0, 0.25, false);
}

#[test]
fn a_branch_on_which_nothing_moves() {
    let column = || {
        let n = 60;
        let h2 = 1.0 / ((n + 1) as f64).powi(2);
        Buckling { n, h2 }
    };
    compare(column, &[0.0; 60], 9.0, 11.0, true);
}

#[test]
fn bands() {
    // the fold, and back on the other side until λ is small
    compare(|| Bratu::new(200), &[0.0; 200], 0.0, 3.6, false);
}

/// `−u″ = λ sin u` by finite differences, dense on purpose: no inertia is at hand.
struct Buckling {
    n: usize,
    h2: f64,
}

impl Problem for Buckling {
    type Jacobian = Dense;
    fn dim(&self) -> usize {
        self.n
    }
    fn parameters(&self) -> &[Parameter] {
        const { &[Parameter::new("load", "", 1.0)] }
    }
    fn new_jacobian(&self) -> Dense {
        Dense::new(self.n)
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let at = |i: usize| if i == 0 || i > self.n { 0.0 } else { u[i - 1] };
        for i in 1..=self.n {
            r[i - 1] = (2.0 * at(i) - at(i - 1) - at(i + 1)) / self.h2 - p[0] * at(i).sin();
        }
        Ok(())
    }
    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        j.set_zero();
        for i in 0..self.n {
            j.set(i, i, 2.0 / self.h2 - p[0] * u[i].cos());
            if i > 0 {
                j.set(i, i - 1, -1.0 / self.h2);
                j.set(i - 1, i, -1.0 / self.h2);
            }
        }
        Ok(())
    }
    fn parameter_derivative(
        &self,
        u: &[f64],
        _: &[f64],
        _: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        out.iter_mut().zip(u).for_each(|(o, u)| *o = -u.sin());
        Ok(())
    }
    fn stability(&self) -> Stability {
        Stability::EnergyHessian
    }
}
