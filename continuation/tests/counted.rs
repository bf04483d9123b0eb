//! Counting all unstable modes of a large problem without symmetry, where it is asked for.

#![allow(clippy::unwrap_used)]

use continuation::linalg::Band;
use continuation::{
    Branch, Counting, EvalError, EventKind, ParamId, Parameter, Problem, Settings, Stability,
    Tracer,
};
use std::ops::ControlFlow;

/// `n` decaying unknowns, as many of them slower than the pair `x' + i y' = (p − ½ + 300 i)(x + i y)`
/// as an iteration for a few eigenvalues ever asks for, in one band.
struct HiddenPair {
    n: usize,
}

const FREQUENCY: f64 = 300.0;

impl HiddenPair {
    fn rate(i: usize) -> f64 {
        -1.0 - 0.05 * i as f64
    }

    /// Every other unknown drives the one before, so strongly that the symmetric part is indefinite.
    fn coupling(i: usize) -> f64 {
        if i.is_multiple_of(2) { 40.0 } else { 0.0 }
    }

    fn pair(&self) -> usize {
        self.n / 2
    }
}

impl Problem for HiddenPair {
    type Jacobian = Band;
    fn dim(&self) -> usize {
        self.n
    }
    fn parameters(&self) -> &[Parameter] {
        &[Parameter { name: "p", unit: "", scale: 1.0 }]
    }
    fn new_jacobian(&self) -> Band {
        Band::new(self.n, 1, 1)
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        for i in 0..self.n {
            let next = if i + 1 < self.n { Self::coupling(i) * u[i + 1] } else { 0.0 };
            r[i] = Self::rate(i) * u[i] + next - u[i].powi(3);
        }
        let k = self.pair();
        let (x, y) = (u[k], u[k + 1]);
        let growth = p[0] - 0.5 - x * x - y * y;
        r[k] = growth * x - FREQUENCY * y;
        r[k + 1] = growth * y + FREQUENCY * x;
        Ok(())
    }
    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Band) -> Result<(), EvalError> {
        continuation::linalg::Matrix::set_zero(j);
        let k = self.pair();
        for i in (0..self.n).filter(|i| *i != k && *i != k + 1) {
            j.set(i, i, Self::rate(i) - 3.0 * u[i] * u[i]);
            if i + 1 < self.n {
                j.set(i, i + 1, Self::coupling(i));
            }
        }
        let (x, y) = (u[k], u[k + 1]);
        let growth = p[0] - 0.5 - x * x - y * y;
        j.set(k, k, growth - 2.0 * x * x);
        j.set(k, k + 1, -FREQUENCY - 2.0 * x * y);
        j.set(k + 1, k, FREQUENCY - 2.0 * x * y);
        j.set(k + 1, k + 1, growth - 2.0 * y * y);
        Ok(())
    }
    fn parameter_derivative(
        &self,
        u: &[f64],
        _: &[f64],
        _: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        out.fill(0.0);
        let k = self.pair();
        out[k..k + 2].copy_from_slice(&u[k..k + 2]);
        Ok(())
    }
    fn stability(&self) -> Stability {
        Stability::Dynamics
    }
}

fn trace(problem: &HiddenPair, counting: Counting) -> Branch {
    let settings =
        Settings { target: Some(1.0), max_step: Some(0.1), counting, ..Settings::default() };
    Tracer::new(problem, "p", &vec![0.0; problem.n], &[0.0], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()))
}

#[test]
fn a_fast_pair_among_many_slow_modes_is_counted() {
    let problem = HiddenPair { n: 610 };
    // the few eigenvalues nearest to zero do not show it, and do not say that they do
    let few = trace(&problem, Counting::Automatic);
    assert!(few.points.iter().all(|point| !point.certified));
    let counted = trace(&problem, Counting::Full);
    for point in counted.points.iter().filter(|point| (point.p - 0.5).abs() > 1e-6) {
        let right = if point.p > 0.5 { 2 } else { 0 };
        assert_eq!((point.unstable, point.certified), (Some(right), true), "{}", point.p);
    }
    assert!(counted.doubts.is_empty(), "{:?}", counted.doubts);
    let found: Vec<_> = counted.events_of(&EventKind::Hopf).map(|event| event.p).collect();
    assert!(found.len() == 1 && (found[0] - 0.5).abs() < 1e-8, "{found:?}");
}
