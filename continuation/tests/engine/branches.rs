//! Special points of problems with known answers.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use continuation::linalg::Dense;
use continuation::samples::{Bratu, Cusp};
use continuation::{
    Branch, EvalError, EventKind, ParamId, Parameter, Problem, Settings, StopReason, Tracer, Watch,
};
use std::ops::ControlFlow;

fn trace<P: Problem>(
    problem: &P,
    parameter: &str,
    u: &[f64],
    p: &[f64],
    settings: Settings,
    watches: &[Watch],
) -> Branch {
    Tracer::new(problem, parameter, u, p, settings)
        .and_then(|t| t.watching(watches))
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()))
}

#[test]
fn cusp_has_its_two_folds_at_every_step_length() {
    let exact = 2.0 / (3.0 * 3f64.sqrt());
    for max_step in [None, Some(1e-3), Some(1e-2), Some(0.1), Some(1.0), Some(10.0)] {
        let settings =
            Settings { target: Some(2.0), max_step, max_points: 20_000, ..Settings::default() };
        let branch = trace(&Cusp, "mu", &[-1.5], &[-2.0, 1.0], settings, &[Watch::zero("x")]);
        assert_eq!(branch.stopped.reason, StopReason::Target, "{max_step:?} {:?}", branch.stopped);
        let folds: Vec<_> = branch.events_of(&EventKind::Fold).collect();
        assert_eq!(folds.len(), 2, "{max_step:?}");
        for (fold, p) in folds.iter().zip([exact, -exact]) {
            assert!((fold.p - p).abs() < 1e-12, "{max_step:?}: {}", fold.p - p);
            let x = branch.points[fold.point].u[0];
            assert!((x + p.signum() / 3f64.sqrt()).abs() < 1e-10, "{max_step:?}: x = {x}");
            assert!(fold.error_estimate < 1e-9);
        }
        let counts: Vec<_> = folds.iter().map(|f| (f.unstable_before, f.unstable_after)).collect();
        assert_eq!(counts, [(Some(0), Some(1)), (Some(1), Some(0))]);
        let zeros: Vec<_> =
            branch.events_of(&EventKind::Zero("x".to_owned())).map(|e| e.p).collect();
        assert_eq!(zeros.len(), 1);
        assert!(zeros[0].abs() < 1e-11);
        assert_eq!(branch.points.last().unwrap().p, 2.0);
        println!("{max_step:?}: {} points, {:?}", branch.points.len(), branch.statistics);
    }
}

#[test]
fn bratu_turns_at_the_known_fold() {
    for (n, fold, tolerance) in [(99, 3.513_647_903_969, 1e-12), (800, 3.513_827_869_849_8, 1e-12)]
    {
        let settings = Settings { increasing: Some(true), ..Settings::default() };
        let watch = [Watch::stop_at("max_u", 8.0)];
        let problem = Bratu::new(n);
        let branch = trace(&problem, "lambda", &vec![0.0; n], &[0.0], settings, &watch);
        assert_eq!(branch.stopped.reason, StopReason::Target, "{:?}", branch.stopped);
        let folds: Vec<_> = branch.events_of(&EventKind::Fold).collect();
        assert_eq!(folds.len(), 1);
        assert!((folds[0].p / fold - 1.0).abs() < tolerance, "{:e}", folds[0].p - fold);
        assert_eq!((folds[0].unstable_before, folds[0].unstable_after), (Some(0), Some(1)));
        let last = branch.points.last().unwrap();
        assert!((last.observables[0] - 8.0).abs() < 1e-9);
        println!("{n}: {} points, {:?}", branch.points.len(), branch.statistics);
    }
}

/// `x² + p² = 1`: a closed branch.
struct Circle;

impl Problem for Circle {
    type Jacobian = Dense;
    fn dim(&self) -> usize {
        1
    }
    fn parameters(&self) -> &[Parameter] {
        const { &[Parameter::new("p", "", 1.0)] }
    }
    fn new_jacobian(&self) -> Dense {
        Dense::new(1)
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        r[0] = u[0] * u[0] + p[0] * p[0] - 1.0;
        Ok(())
    }
    fn jacobian(&self, u: &[f64], _: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        j.set(0, 0, 2.0 * u[0]);
        Ok(())
    }
    fn parameter_derivative(
        &self,
        _: &[f64],
        p: &[f64],
        _: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        out[0] = 2.0 * p[0];
        Ok(())
    }
}

#[test]
fn a_closed_branch_ends_where_it_began() {
    for max_step in [None, Some(0.01), Some(0.5)] {
        let settings = Settings { max_step, ..Settings::default() };
        let branch = trace(&Circle, "p", &[1.0], &[0.3], settings, &[]);
        assert_eq!(branch.stopped.reason, StopReason::ClosedLoop, "{:?}", branch.stopped);
        let folds: Vec<f64> = branch.events_of(&EventKind::Fold).map(|e| e.p).collect();
        assert_eq!(folds.len(), 2, "{max_step:?}");
        assert!((folds[0] - 1.0).abs() < 1e-12 && (folds[1] + 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_branch_says_why_it_ended() {
    let domain = Settings { domain: Some((-0.5, 0.5)), ..Settings::default() };
    let branch = trace(&Circle, "p", &[1.0], &[0.3], domain, &[]);
    assert_eq!(branch.stopped.reason, StopReason::Domain);
    assert_eq!(branch.points.last().unwrap().p, 0.5);

    let few = Settings { max_points: 7, ..Settings::default() };
    let branch = trace(&Circle, "p", &[1.0], &[0.3], few, &[]);
    assert_eq!((branch.stopped.reason, branch.points.len()), (StopReason::MaxPoints, 7));

    let tracer = Tracer::new(&Circle, "p", &[1.0], &[0.3], Settings::default()).unwrap();
    let branch = tracer.run(&mut |at| {
        if at.points == 5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!((branch.stopped.reason, branch.points.len()), (StopReason::Interrupted, 5));

    let copy: Branch = serde_json::from_str(&serde_json::to_string(&branch).unwrap()).unwrap();
    assert_eq!(copy, branch);
}

#[test]
fn unusable_input_is_refused_with_a_reason() {
    let refuse = |parameter: &str, u: &[f64], p: &[f64], settings: Settings| {
        Tracer::new(&Circle, parameter, u, p, settings).err().unwrap().to_string()
    };
    let plain = Settings::default;
    assert!(refuse("q", &[1.0], &[0.0], plain()).contains("there are: p"));
    assert!(refuse("p", &[1.0, 2.0], &[0.0], plain()).contains("needs 1"));
    assert!(refuse("p", &[f64::NAN], &[0.0], plain()).contains("not finite"));
    assert!(refuse("p", &[1.0], &[3.0], plain()).contains("no solution at the start"));
    let settings = Settings { max_step: Some(-1.0), ..plain() };
    assert!(refuse("p", &[1.0], &[0.0], settings).contains("max_step"));
    let tracer = Tracer::new(&Circle, "p", &[1.0], &[0.0], plain()).unwrap();
    let error = tracer.watching(&[Watch::zero("force")]).err().unwrap().to_string();
    assert!(error.contains("no observable `force`"), "{error}");
}
