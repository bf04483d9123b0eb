//! Failures that were met in use; each test carries the name of what went wrong.

#![allow(clippy::unwrap_used)]

use continuation::linalg::Dense;
use continuation::samples::{Bratu, Cusp};
use continuation::{
    Branch, DenseProblem, EvalError, EventKind, Matrix, ParamId, Parameter, Problem, Settings,
    StopReason, Tracer, Watch, check_derivatives, modes,
};
use std::ops::ControlFlow;

fn cusp(settings: Settings, watches: &[Watch]) -> Branch {
    Tracer::new(&Cusp, "mu", &[-1.5], &[-2.0, 1.0], settings)
        .unwrap()
        .watching(watches)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()))
}

#[test]
fn one_step_limit_alone() {
    let settings = Settings { target: Some(2.0), max_points: 300, ..Settings::default() };
    for (min_step, max_step) in [(Some(1.0), None), (None, Some(1e-9))] {
        let branch = cusp(Settings { min_step, max_step, ..settings.clone() }, &[]);
        assert!(branch.points.len() > 1);
    }
}

#[test]
fn domain_open_on_one_side() {
    let settings =
        Settings { domain: Some((-3.0, f64::INFINITY)), max_points: 500, ..Settings::default() };
    let branch = cusp(settings, &[]);
    assert_eq!(branch.events_of(&EventKind::Fold).count(), 2, "{:?}", branch.stopped);
}

#[test]
fn domain_that_the_start_leaves_at_once_or_is_not_in() {
    let settings =
        Settings { domain: Some((-2.0, 1.0)), increasing: Some(false), ..Settings::default() };
    let branch = cusp(settings, &[]);
    assert_eq!((branch.stopped.reason, branch.points.len()), (StopReason::Domain, 1));
    let settings = Settings { domain: Some((-1.0, 1.0)), ..Settings::default() };
    let error = Tracer::new(&Cusp, "mu", &[-1.5], &[-2.0, 1.0], settings).err().unwrap();
    assert!(error.to_string().contains("domain"), "{error}");
}

#[test]
fn value_just_before_a_fold() {
    let fold = 2.0 / (3.0 * 3f64.sqrt());
    for distance in [1e-3, 1e-5, 1e-6, 1e-8] {
        for max_step in [None, Some(0.1), Some(1.0)] {
            let value = fold - distance;
            let settings = Settings { target: Some(value), max_step, ..Settings::default() };
            let end = cusp(settings, &[]).points.pop().unwrap();
            assert!(end.u[0] < -1.0 / 3f64.sqrt(), "{distance:e} {max_step:?}: {:?}", end.u);
            let settings = Settings { target: Some(2.0), max_step, ..Settings::default() };
            let landings = cusp(settings, &[Watch::parameter(value)]);
            let count = landings.events_of(&EventKind::Target).count();
            assert_eq!(count, 3, "{distance:e} {max_step:?}");
        }
    }
}

#[test]
fn first_step_away_from_a_branch_point_sees_events_too() {
    let problem = DenseProblem::from_residual(1, &["p"], |x, p, r| r[0] = x[0] * (p[0] - x[0]))
        .boxed()
        .observing("x", |x, _| x[0]);
    let settings = Settings { target: Some(1.0), ..Settings::default() };
    let trunk = Tracer::new(&problem, "p", &[0.0], &[-1.0], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    let event = &trunk.events[0];
    let direction = &event.crossing().unwrap().leaving[0];
    let settings = Settings {
        target: Some(0.2),
        first_step: Some(0.6),
        max_step: Some(1.0),
        ..Settings::default()
    };
    let forward = direction.dp > 0.0;
    let side = Tracer::leaving(&problem, &trunk, event, direction, forward, settings)
        .unwrap()
        .watching(&[Watch::Value { observable: "x".to_owned(), level: 0.1, stop: false }])
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    assert_eq!(side.stopped.reason, StopReason::Target, "{:?}", side.stopped);
    assert_eq!(side.events.len(), 1);
    assert!((side.events[0].p - 0.1).abs() < 1e-12);
}

#[test]
fn unknowns_of_very_different_size() {
    let fold = 2.0 / (3.0 * 3f64.sqrt());
    for size in [1e-9, 1.0, 1e6, 1e9, 1e12] {
        let problem = DenseProblem::from_residual(2, &["p"], move |u, p, r| {
            r[0] = p[0] + u[0] - u[0].powi(3);
            r[1] = u[1] / size - u[0];
        })
        .boxed();
        let mut j = Dense::new(2);
        problem.jacobian(&[-1.5, -1.5 * size], &[-2.0], &mut j).unwrap();
        assert!((j.get(0, 0) + 5.75).abs() < 1e-10, "{size:e}: {}", j.get(0, 0));
        assert!((j.get(1, 1) * size - 1.0).abs() < 1e-10, "{size:e}");
        let settings = Settings { target: Some(2.0), ..Settings::default() };
        let branch = Tracer::new(&problem, "p", &[-1.5, -1.5 * size], &[-2.0], settings)
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(()));
        let folds: Vec<f64> = branch.events_of(&EventKind::Fold).map(|e| e.p.abs()).collect();
        assert_eq!(folds.len(), 2, "{size:e} {:?}", branch.stopped);
        assert!(folds.iter().all(|p| (p / fold - 1.0).abs() < 1e-9), "{size:e} {folds:?}");
    }
}

/// Bratu's problem again, its Jacobian dense.
struct DenseBratu(Bratu);

impl Problem for DenseBratu {
    type Jacobian = Dense;
    fn dim(&self) -> usize {
        self.0.dim()
    }
    fn parameters(&self) -> &[continuation::Parameter] {
        self.0.parameters()
    }
    fn new_jacobian(&self) -> Dense {
        Dense::new(self.dim())
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), continuation::EvalError> {
        self.0.residual(u, p, r)
    }
    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), continuation::EvalError> {
        let mut band = self.0.new_jacobian();
        self.0.jacobian(u, p, &mut band)?;
        let mut unit = vec![0.0; u.len()];
        for k in 0..u.len() {
            unit[k] = 1.0;
            band.mul(&unit, j.column_mut(k));
            unit[k] = 0.0;
        }
        Ok(())
    }
    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: continuation::ParamId,
        out: &mut [f64],
    ) -> Result<(), continuation::EvalError> {
        self.0.parameter_derivative(u, p, which, out)
    }
    fn metric(&self, x: &[f64], y: &mut [f64]) {
        self.0.metric(x, y);
    }
    fn stability(&self) -> continuation::Stability {
        self.0.stability()
    }
}

#[test]
fn modes_do_not_depend_on_the_storage() {
    let (n, p) = (9, [0.5]);
    let band = modes(&Bratu::new(n), &vec![0.1; n], &p, 3).unwrap();
    let dense = modes(&DenseBratu(Bratu::new(n)), &vec![0.1; n], &p, 3).unwrap();
    assert!(band.certified && dense.certified);
    for (a, b) in band.values.iter().zip(&dense.values) {
        assert!((a.0 / b.0 - 1.0).abs() < 1e-10, "{a:?} {b:?}");
    }
}

#[test]
fn eigenvalues_at_a_branch_point_are_its_own() {
    let problem =
        DenseProblem::from_residual(1, &["p"], |x, p, r| r[0] = p[0] * x[0] - x[0].powi(3)).boxed();
    let settings = Settings { target: Some(1.0), eigenvalues: 1, ..Settings::default() };
    let branch = Tracer::new(&problem, "p", &[0.0], &[-1.0], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    for point in &branch.points {
        assert!((point.eigenvalues[0].0 - point.p).abs() < 1e-9, "{point:?}");
    }
}

fn events(
    n: usize,
    start: f64,
    steps: (Option<f64>, Option<f64>),
    f: impl Fn(&[f64], &[f64], &mut [f64]) + Send + Sync + 'static,
) -> Vec<(String, f64, Option<usize>, Option<usize>)> {
    let problem = DenseProblem::from_residual(n, &["p"], f).boxed();
    let settings = Settings {
        target: Some(1.0),
        max_step: steps.0,
        first_step: steps.1,
        ..Settings::default()
    };
    let branch = Tracer::new(&problem, "p", &vec![0.0; n], &[start], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    assert_eq!(branch.stopped.reason, StopReason::Target, "{:?}", branch.stopped);
    let events = branch.events.iter();
    events.map(|e| (e.kind.to_string(), e.p, e.unstable_before, e.unstable_after)).collect()
}

fn hopf(u: &[f64], p: f64, r: &mut [f64]) {
    let square = u[0] * u[0] + u[1] * u[1];
    r[0] = p * u[0] - u[1] - u[0] * square;
    r[1] = u[0] + p * u[1] - u[1] * square;
}

#[test]
fn step_that_ends_on_a_hopf_point_or_a_pitchfork() {
    for step in [0.5, 0.25, 0.125, 0.0625, 0.01, 0.02, 0.05] {
        let steps = (Some(step), Some(step));
        let found = events(2, -1.0, steps, |u, p, r| hopf(u, p[0], r));
        assert_eq!(found.len(), 1, "{step}: {found:?}");
        assert_eq!((&found[0].0[..], found[0].2, found[0].3), ("hopf", Some(0), Some(2)));
        assert!(found[0].1.abs() < 1e-12, "{step}: {found:?}");
        let found = events(1, -1.0, steps, |u, p, r| r[0] = p[0] * u[0] - u[0].powi(3));
        assert_eq!(found.len(), 1, "{step}: {found:?}");
        assert_eq!((&found[0].0[..], found[0].2, found[0].3), ("branch-point", Some(0), Some(1)));
    }
}

#[test]
fn hopf_point_beside_a_branch_point_of_the_opposite_exchange() {
    for gap in [0.1, 1e-2, 1e-3, 1e-5] {
        for shift in [0.0, 0.123_456_7] {
            let found = events(3, -1.0, (None, None), move |u, p, r| {
                hopf(u, p[0] - shift, r);
                r[2] = (gap + shift - p[0]) * u[2] - u[2].powi(3);
            });
            let kinds: Vec<&str> = found.iter().map(|e| &e.0[..]).collect();
            assert_eq!(kinds, ["hopf", "branch-point"], "{gap} {shift}: {found:?}");
            assert!((found[0].1 - shift).abs() < 1e-11, "{gap} {shift}: {found:?}");
            assert!((found[1].1 - shift - gap).abs() < 1e-11, "{gap} {shift}: {found:?}");
        }
    }
}

#[test]
fn derivatives_where_the_residual_is_flat() {
    let flat = DenseProblem::from_residual(1, &["p"], |u, p, r| r[0] = u[0] - (p[0] / 1e-2).tanh())
        .boxed();
    let mut out = [1.0];
    flat.parameter_derivative(&[-1.0], &[-1.0], ParamId(0), &mut out).unwrap();
    assert_eq!(out[0], 0.0);
    let kink =
        DenseProblem::from_residual(1, &["p"], |u, p, r| r[0] = p[0].max(0.0) - u[0]).boxed();
    kink.parameter_derivative(&[0.0], &[-1.0], ParamId(0), &mut out).unwrap();
    assert_eq!(out[0], 0.0);
    // a value that is rounding says nothing of the length over which f varies
    let smooth = DenseProblem::from_residual(1, &["p"], |u, p, r| r[0] = p[0] + u[0].exp()).boxed();
    let mut j = Dense::new(1);
    smooth.jacobian(&[1e-17], &[-1.0], &mut j).unwrap();
    assert!((j.get(0, 0) - 1.0).abs() < 1e-11, "{}", j.get(0, 0));
}

#[test]
fn branches_that_cross_at_a_small_angle() {
    for angle in [1e-1, 1e-2] {
        let problem = DenseProblem::from_residual(1, &["p"], move |u, p, r| {
            r[0] = (u[0] - p[0]) * (u[0] - (1.0 + angle) * p[0]);
        })
        .boxed();
        let settings = Settings { target: Some(1.0), ..Settings::default() };
        let branch = Tracer::new(&problem, "p", &[-1.0], &[-1.0], settings)
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(()));
        let end = branch.points.last().unwrap();
        assert!((end.u[0] - 1.0).abs() < 1e-9, "{angle}: {:?} {:?}", end, branch.stopped);
        assert_eq!(branch.events.len(), 1, "{angle}: {:?}", branch.events);
        assert!(branch.events[0].p.abs() < 1e-7, "{angle}: {:?}", branch.events);
    }
}

#[test]
fn no_exchange_of_stability_to_first_order() {
    let problem = DenseProblem::from_residual(1, &["p"], |u, p, r| {
        r[0] = p[0].powi(3) * u[0] - u[0].powi(3);
    })
    .boxed();
    let settings = Settings { target: Some(1.0), ..Settings::default() };
    let branch = Tracer::new(&problem, "p", &[0.0], &[-1.0], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    for event in &branch.events {
        if let Some(crossing) = event.crossing() {
            assert_ne!(crossing.shape, continuation::Shape::Pitchfork, "{crossing:?}");
        }
    }
}

#[test]
fn starts_at_or_beside_a_fold() {
    // p = u² + u³/2: a fold at 0, another one at u = -4/3
    let problem = DenseProblem::from_residual(1, &["p"], |u, p, r| {
        r[0] = p[0] - u[0] * u[0] - 0.5 * u[0].powi(3);
    })
    .boxed();
    for u in [0.0, 1e-12, 1e-9, 1e-7, -1e-7, 1e-6, 1e-4, -1e-4, 1e-2, 0.1] {
        let p = u * u + 0.5 * f64::powi(u, 3);
        for increasing in [true, false] {
            let domain = Some((-1.0, 1.0));
            let settings = Settings { domain, increasing: Some(increasing), ..Settings::default() };
            let branch = Tracer::new(&problem, "p", &[u], &[p], settings)
                .unwrap_or_else(|e| panic!("{u} {increasing}: {e}"))
                .run(&mut |_| ControlFlow::Continue(()));
            assert_eq!(branch.stopped.reason, StopReason::Domain, "{u}: {:?}", branch.stopped);
            let folds: Vec<f64> =
                branch.events_of(&EventKind::Fold).map(|e| branch.points[e.point].u[0]).collect();
            let mut known = vec![0.0, -4.0 / 3.0];
            // to the right of both: only the way to the left meets them
            let left = branch.points.last().unwrap().u[0] < u;
            if !left {
                known.retain(|fold| *fold > u);
            } else {
                known.retain(|fold| *fold < u);
            }
            // a fold that is the start itself, to the accuracy to which it can be solved there, is the
            // branch's first special point
            if branch.points[0].event.is_some() {
                known.retain(|fold| *fold != 0.0);
                known.insert(0, 0.0);
            } else {
                assert!(u != 0.0);
                if u.abs() < 1e-6 && folds.len() != known.len() {
                    known.retain(|fold| *fold != 0.0);
                }
            }
            assert_eq!(folds.len(), known.len(), "{u} {increasing}: {folds:?} {known:?}");
            for (fold, known) in folds.iter().zip(&known) {
                assert!((fold - known).abs() < 1e-8, "{u} {increasing}: {folds:?}");
            }
            assert!(branch.points.len() < 120, "{u}: {}", branch.points.len());
        }
    }
}

#[test]
fn assembly_that_forgets_what_was_there() {
    struct Adds;
    impl Problem for Adds {
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
            r[0] = 3.0 * u[0] - p[0];
            Ok(())
        }
        fn jacobian(&self, _: &[f64], _: &[f64], j: &mut Dense) -> Result<(), EvalError> {
            j.add(0, 0, 3.0);
            Ok(())
        }
        fn parameter_derivative(
            &self,
            _: &[f64],
            _: &[f64],
            _: ParamId,
            out: &mut [f64],
        ) -> Result<(), EvalError> {
            out[0] = -1.0;
            Ok(())
        }
    }
    let check = check_derivatives(&Adds, &[0.3], &[0.5], 1.0).unwrap();
    assert!(check.jacobian > 0.4, "{check:?}");
}

#[test]
fn every_direction_a_branch() {
    for n in [2, 3] {
        let problem = DenseProblem::from_residual(n, &["p"], |u, p, r| {
            let square: f64 = u.iter().map(|x| x * x).sum();
            r.iter_mut().zip(u).for_each(|(r, u)| *r = (p[0] - square) * u);
        })
        .boxed();
        let settings = Settings { target: Some(1.0), ..Settings::default() };
        let branch = Tracer::new(&problem, "p", &vec![0.0; n], &[-1.0], settings)
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(()));
        let crossing = branch.events[0].crossing().unwrap();
        assert_eq!((crossing.multiplicity, crossing.leaving.len()), (n, 1));
    }
}
