//! Normal forms of functions that vary on a scale far below their natural amplitude, and signs that
//! are claimed only where they are known.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests")]

use continuation::linalg::Dense;
use continuation::{
    Branch, Criticality, Detail, EvalError, EventKind, ParamId, Parameter, Problem, Settings,
    Stability, Tracer,
};
use std::ops::ControlFlow;

type Values = dyn Fn(&[f64], f64) -> Vec<f64> + Send + Sync;

/// Residual, Jacobian by rows and parameter derivative in closed form.
struct Exact {
    n: usize,
    parameters: [Parameter; 1],
    residual: Box<Values>,
    jacobian: Box<Values>,
    slope: Box<Values>,
}

impl Exact {
    fn new(
        n: usize,
        residual: impl Fn(&[f64], f64) -> Vec<f64> + Send + Sync + 'static,
        jacobian: impl Fn(&[f64], f64) -> Vec<f64> + Send + Sync + 'static,
        slope: impl Fn(&[f64], f64) -> Vec<f64> + Send + Sync + 'static,
    ) -> Self {
        let (residual, jacobian) = (Box::new(residual), Box::new(jacobian));
        Exact {
            n,
            parameters: [Parameter::new("p", "", 1.0)],
            residual,
            jacobian,
            slope: Box::new(slope),
        }
    }
}

impl Problem for Exact {
    type Jacobian = Dense;
    fn dim(&self) -> usize {
        self.n
    }
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn new_jacobian(&self) -> Dense {
        Dense::new(self.n)
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        r.copy_from_slice(&(self.residual)(u, p[0]));
        Ok(())
    }
    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        for (k, v) in (self.jacobian)(u, p[0]).into_iter().enumerate() {
            j.set(k / self.n, k % self.n, v);
        }
        Ok(())
    }
    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        _: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        out.copy_from_slice(&(self.slope)(u, p[0]));
        Ok(())
    }
    fn stability(&self) -> Stability {
        Stability::Dynamics
    }
}

fn trace(problem: &Exact, u: &[f64], settings: Settings, start: f64) -> Branch {
    let tracer = Tracer::new(problem, "p", u, &[start], settings).unwrap();
    tracer.run(&mut |_| ControlFlow::Continue(()))
}

fn to(target: f64) -> Settings {
    Settings { target: Some(target), ..Settings::default() }
}

/// `p = −√(u² + e²)`: the curvature at the fold is `−1/e`.
#[test]
fn folds_sharper_than_the_scale_of_the_branch() {
    for e in [1e-1_f64, 1e-2, 1e-3, 1e-4] {
        let problem = Exact::new(
            1,
            move |u, p| vec![p + u[0].hypot(e)],
            move |u, _| vec![u[0] / u[0].hypot(e)],
            |_, _| vec![1.0],
        );
        let settings = Settings { domain: Some((-1.1, 1.0)), ..Settings::default() };
        let branch = trace(&problem, &[1.0], settings, -1.0_f64.hypot(e));
        let fold = branch.events_of(&EventKind::Fold).next().unwrap();
        let Detail::Fold(form) = &fold.detail else { panic!("{e}: {fold:?}") };
        let off = (form.curvature * e + 1.0).abs();
        assert!(off < 1e-3, "{e}: {form:?}");
        assert!(off <= 3.0 * form.curvature_error * e + 1e-9, "{e}: {form:?}");
    }
}

/// `x(p + x² − 5x²/(1 + x²/e²))`: supercritical, `p″ = 8`, though subcritical on any larger scale.
#[test]
fn pitchforks_that_turn_on_a_fine_scale() {
    for e in [1e-1_f64, 1e-2, 1e-3] {
        let d = move |x: f64| 1.0 + (x / e).powi(2);
        let problem = Exact::new(
            1,
            move |u, p| vec![u[0] * (p + u[0].powi(2) * (1.0 - 5.0 / d(u[0])))],
            move |u, p| {
                let x2 = u[0] * u[0];
                vec![p + 3.0 * x2 - 15.0 * x2 / d(u[0]) + 10.0 * (x2 / e / d(u[0])).powi(2)]
            },
            |u, _| vec![u[0]],
        );
        let branch = trace(&problem, &[0.0], to(1.0), -1.0);
        let event = branch.events_of(&EventKind::BranchPoint).next().unwrap();
        let Detail::Crossing(crossing) = &event.detail else { panic!("{e}: {event:?}") };
        assert_ne!(crossing.criticality, Some(Criticality::Subcritical), "{e}: {crossing:?}");
        if crossing.criticality.is_some() {
            let off = (crossing.curvature - 8.0).abs();
            assert!(off <= 0.1_f64.min(3.0 * crossing.curvature_error), "{e}: {crossing:?}");
        }
        assert!(e < 1e-2 || crossing.criticality.is_some(), "{e}: {crossing:?}");
    }
}

/// `z' = (p + i + g(|z|²)) z` in real form, `g` and its slope given.
fn oscillator(g: fn(f64, f64) -> (f64, f64), e: f64) -> Exact {
    let square = |u: &[f64]| u[0] * u[0] + u[1] * u[1];
    Exact::new(
        2,
        move |u, p| {
            let growth = p + g(square(u), e).0;
            vec![growth * u[0] - u[1], u[0] + growth * u[1]]
        },
        move |u, p| {
            let (value, slope) = g(square(u), e);
            let (growth, cross) = (p + value, 2.0 * slope * u[0] * u[1]);
            let own = |x: f64| growth + 2.0 * slope * x * x;
            vec![own(u[0]), cross - 1.0, cross + 1.0, own(u[1])]
        },
        |u, _| u.to_vec(),
    )
}

fn lyapunov(problem: &Exact) -> (f64, f64, Option<Criticality>) {
    let branch = trace(problem, &[0.0, 0.0], to(1.0), -1.0);
    let event = branch.events_of(&EventKind::Hopf).next().unwrap();
    let Detail::Hopf(form) = &event.detail else { panic!("{event:?}") };
    (form.lyapunov, form.lyapunov_error, form.criticality)
}

#[test]
fn hopf_points_that_turn_on_a_fine_scale() {
    let (reference, ..) = lyapunov(&oscillator(|a, _| (-4.0 * a, -4.0), 1.0));
    assert!(reference < 0.0);
    for e in [1e-1, 1e-2, 1e-3] {
        let turning = |a: f64, e: f64| {
            let d = 1.0 + a / (e * e);
            (a - 5.0 * a / d, 1.0 - 5.0 / (d * d))
        };
        let (value, error, criticality) = lyapunov(&oscillator(turning, e));
        assert_ne!(criticality, Some(Criticality::Subcritical), "{e}: {value} {error}");
        if criticality.is_some() {
            let off = (value / reference - 1.0).abs();
            assert!(off < 0.02, "{e}: {value} {error} for {reference}");
        }
        assert!(e < 1e-2 || criticality.is_some(), "{e}: {value} {error}");
    }
}

/// `x″ = −d x + 2 p x′ − x³`: a conservative system at `p = 0`, where `l₁ = 0`.
#[test]
fn no_sign_where_the_lyapunov_coefficient_vanishes() {
    for root in [1.0_f64, 1e-1, 1e-2, 1e-3, 1e-4] {
        let d = root * root;
        let problem = Exact::new(
            2,
            move |u, p| vec![u[1], -d * u[0] + 2.0 * p * u[1] - u[0].powi(3)],
            move |u, p| vec![0.0, 1.0, -d - 3.0 * u[0] * u[0], 2.0 * p],
            |u, _| vec![0.0, 2.0 * u[1]],
        );
        let branch = trace(&problem, &[0.0, 0.0], to(root), -0.7 * root);
        for event in branch.events_of(&EventKind::Hopf) {
            if let Detail::Hopf(form) = &event.detail {
                assert_eq!(form.criticality, None, "{root}: {form:?}");
                assert!(form.lyapunov.abs() <= 3.0 * form.lyapunov_error, "{root}: {form:?}");
            }
        }
        assert!(root < 1e-2 || branch.events_of(&EventKind::Hopf).count() == 1, "{root}");
    }
}
