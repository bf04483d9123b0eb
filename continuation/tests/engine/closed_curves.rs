//! Small closed curves in a wide domain.

#![allow(clippy::unwrap_used)]

use continuation::linalg::Dense;
use continuation::{
    Branch, EvalError, EventKind, ParamId, Parameter, Problem, Settings, StopReason, Tracer,
};
use std::ops::ControlFlow;

/// `((u − u₀)/a)² + (p − p₀)² = r²`.
struct Ellipse {
    r2: f64,
    aspect: f64,
    u0: f64,
    p0: f64,
    parameters: Vec<Parameter>,
}

impl Problem for Ellipse {
    type Jacobian = Dense;

    fn dim(&self) -> usize {
        1
    }

    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn new_jacobian(&self) -> Dense {
        Dense::new(1)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let (x, y) = ((u[0] - self.u0) / self.aspect, p[0] - self.p0);
        r[0] = (x * x + y * y) / self.r2 - 1.0;
        Ok(())
    }

    fn jacobian(&self, u: &[f64], _p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        j.set(0, 0, 2.0 * (u[0] - self.u0) / (self.aspect * self.aspect * self.r2));
        Ok(())
    }

    fn parameter_derivative(
        &self,
        _u: &[f64],
        p: &[f64],
        _which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        out[0] = 2.0 * (p[0] - self.p0) / self.r2;
        Ok(())
    }
}

fn ellipse(radius: f64, aspect: f64, angle: f64, (u0, p0): (f64, f64)) -> Branch {
    let r2 = radius * radius;
    let problem = Ellipse { r2, aspect, u0, p0, parameters: vec![Parameter::new("p", "", 1.0)] };
    let settings = Settings { domain: Some((p0 - 1.0, p0 + 1.0)), ..Settings::default() };
    let start = (u0 + aspect * radius * angle.sin(), p0 + radius * angle.cos());
    Tracer::new(&problem, "p", &[start.0], &[start.1], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()))
}

/// The parameter's range is a hint: a curve far smaller than it is followed all the way, whatever its
/// shape and wherever it begins.
#[test]
fn small_closed_curves_in_a_wide_domain() {
    for k in -6..=-1 {
        for (aspect, angle) in [(1.0, 0.3), (1.0, 1.5), (1.0, 2.5), (1e3, 0.3), (1e3, 1.5)] {
            for centre in [(0.0, 0.0), (1.0, 0.5)] {
                closed(10_f64.powi(k), aspect, angle, centre);
            }
        }
        closed(10_f64.powi(k), 1e-3, 0.3, (0.0, 0.0));
        closed(10_f64.powi(k), 1e-3, 1.5, (0.0, 0.0));
    }
    // larger than the domain
    for radius in [1.0 + 1e-6, 2.0, 1e2] {
        let branch = ellipse(radius, 1.0, 0.5 * std::f64::consts::PI, (0.0, 0.0));
        assert_eq!(branch.stopped.reason, StopReason::Domain);
    }
}

fn closed(radius: f64, aspect: f64, angle: f64, centre: (f64, f64)) {
    let branch = ellipse(radius, aspect, angle, centre);
    let name = format!("{radius:.0e} {aspect:.0e} {angle} {centre:?}");
    assert_eq!(branch.stopped.reason, StopReason::ClosedLoop, "{name} {:?}", branch.stopped);
    let folds: Vec<f64> = branch.events_of(&EventKind::Fold).map(|e| e.p - centre.1).collect();
    assert_eq!(folds.len(), 2, "{name} {folds:?}");
    for fold in folds {
        assert!((fold.abs() / radius - 1.0).abs() < 1e-6, "{name} {fold}");
    }
    assert!(branch.points.len() > 15 && branch.points.len() < 200, "{name}");
}
