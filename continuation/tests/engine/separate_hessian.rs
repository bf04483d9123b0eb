//! Stability read from a matrix that is not the Jacobian.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use continuation::linalg::{Arrow, SymmetricBand};
use continuation::{
    EvalError, EventKind, Matrix, ParamId, Parameter, Problem, Settings, Stability, Tracer, modes,
};
use std::ops::ControlFlow;

/// `x² + p − 1 = 0`, `q = x`: a fold at `p = 1`. The energy's Hessian is `diag(x + ½, −1)`, with one
/// multiplier.
struct Held([Parameter; 1]);

impl Problem for Held {
    type Jacobian = Arrow<SymmetricBand>;
    fn dim(&self) -> usize {
        2
    }
    fn parameters(&self) -> &[Parameter] {
        &self.0
    }
    fn new_jacobian(&self) -> Self::Jacobian {
        Arrow::new(SymmetricBand::new(1, 0), 1)
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        r.copy_from_slice(&[u[0] * u[0] + p[0] - 1.0 + u[1] - u[0], u[1] - u[0]]);
        Ok(())
    }
    fn jacobian(&self, u: &[f64], _: &[f64], j: &mut Self::Jacobian) -> Result<(), EvalError> {
        j.set_zero();
        j.core_mut().column_mut(0)[0] = 2.0 * u[0] - 1.0;
        j.column_mut(0)[0] = 1.0;
        j.row_mut(0)[0] = -1.0;
        j.set_corner(0, 0, 1.0);
        Ok(())
    }
    fn parameter_derivative(
        &self,
        _: &[f64],
        _: &[f64],
        _: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        out.copy_from_slice(&[1.0, 0.0]);
        Ok(())
    }
    fn stability(&self) -> Stability {
        Stability::SeparateHessian
    }
    fn energy_hessian(
        &self,
        u: &[f64],
        _: &[f64],
        h: &mut Self::Jacobian,
    ) -> Result<(), EvalError> {
        h.set_zero();
        h.core_mut().column_mut(0)[0] = u[0] + 0.5;
        h.set_corner(0, 0, -1.0);
        Ok(())
    }
    fn multipliers(&self) -> usize {
        1
    }
}

#[test]
fn modes_change_where_the_jacobian_is_regular_and_stay_at_a_fold() {
    let problem = Held([Parameter::new("p", "", 1.0)]);
    for step in [0.01, 0.1, 1.0] {
        let settings = Settings {
            increasing: Some(true),
            target: Some(-1.0),
            max_step: Some(step),
            ..Settings::default()
        };
        let start = [1.0, 1.0];
        let tracer = Tracer::new(&problem, "p", &start, &[0.0], settings).unwrap();
        let branch = tracer.run(&mut |_| ControlFlow::Continue(()));
        let kinds: Vec<&EventKind> = branch.events.iter().map(|event| &event.kind).collect();
        assert_eq!(kinds, [&EventKind::Fold, &EventKind::StabilityChange], "step {step}");
        let [fold, change] = &branch.events[..] else { panic!("{kinds:?}") };
        assert_eq!((fold.unstable_before, fold.unstable_after), (Some(0), Some(0)));
        assert!((fold.p - 1.0).abs() < 1e-10);
        // x = −½ on the way down
        assert_eq!((change.unstable_before, change.unstable_after), (Some(0), Some(1)));
        assert!((change.p - 0.75).abs() < 1e-8, "{}", change.p);
        assert!((branch.points[change.point].u[0] + 0.5).abs() < 1e-8);
        assert!(branch.points.iter().all(|point| point.certified));
    }
    // the lowest but for the multiplier's
    let found = modes(&problem, &[-1.0, -1.0], &[0.0], 2).unwrap();
    assert!(found.values.iter().any(|(value, _)| (value + 0.5).abs() < 1e-12), "{found:?}");
}
