//! Curves of special points in two parameters, with known special points of codimension two.

#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::panic)]

mod bands;
pub(crate) mod branch_points;
mod hopf;
mod hopf_by_differences;
mod invariance;
mod large;
#[allow(dead_code, reason = "the factors for one parameter")]
use crate::scaled;
mod scales;

use continuation::codim2::{Curve, CurveError, FoldCurve};
use continuation::samples::Cusp;
use continuation::{
    Branch, DenseProblem, Event, EventKind, Problem, Settings, Stability, StopReason, Tracer, Watch,
};
use std::ops::ControlFlow;

fn trace<P: Problem>(problem: &P, name: &str, u: &[f64], p: &[f64], target: f64) -> Branch {
    let settings = Settings { target: Some(target), ..Settings::default() };
    let tracer = Tracer::new(problem, name, u, p, settings).unwrap();
    tracer.run(&mut |_| ControlFlow::Continue(()))
}

fn follow(
    curve: &FoldCurve<'_>,
    (low, high): (f64, f64),
    max_step: Option<f64>,
    watches: &[Watch],
) -> Curve {
    let settings = Settings { domain: Some((low, high)), max_step, ..Settings::default() };
    curve.trace(&settings, watches, &mut |_| ControlFlow::Continue(())).unwrap()
}

fn of_kind<'c>(curve: &'c Curve, kind: &EventKind) -> Vec<&'c Event> {
    curve.branch.events.iter().filter(|e| e.kind == *kind).collect()
}

fn account(curve: &Curve, first: &str) -> String {
    let column = curve.column(first).unwrap();
    let events = curve.branch.events.iter();
    let all: Vec<String> = events
        .map(|e| {
            format!("{} ({:.13}, {:.13}) ±{:.1e}", e.kind, column[e.point], e.p, e.error_estimate)
        })
        .collect();
    let ends = (&curve.first_end.detail, &curve.branch.stopped.detail);
    format!("{} points, {:?}: {} {ends:?}", column.len(), curve.branch.statistics, all.join("; "))
}

#[test]
fn the_cusp_at_every_step_length() {
    let branch = trace(&Cusp, "mu", &[-1.5], &[-2.0, 1.0], 2.0);
    let fold = branch.events_of(&EventKind::Fold).next().unwrap();
    let curve = FoldCurve::at(&Cusp, &branch, fold, "lambda").unwrap();
    for max_step in [None, Some(0.005), Some(0.01), Some(0.1), Some(0.5), Some(5.0)] {
        let found = follow(&curve, (-1.0, 2.0), max_step, &[]);
        println!("{max_step:?} {}", account(&found, "mu"));
        let mu = found.column("mu").unwrap();
        for (point, mu) in found.branch.points.iter().zip(&mu) {
            assert!((27.0 * mu * mu - 4.0 * point.p.powi(3)).abs() < 1e-10, "{max_step:?}");
            assert_eq!(*mu, *point.u.last().unwrap());
        }
        assert_eq!(found.branch.events.len(), 1, "{max_step:?}");
        let cusp = &found.branch.events[0];
        assert_eq!((cusp.kind.clone(), cusp.kind.to_string()), (EventKind::Cusp, "cusp".into()));
        assert!(mu[cusp.point].abs() < 1e-10 && cusp.p.abs() < 1e-10, "{max_step:?}");
        let x = found.branch.points[cusp.point].u[0];
        assert!(x.abs() < 2.0 * cusp.error_estimate && cusp.error_estimate < 1e-8);
        let ends = (found.first_end.reason, found.branch.stopped.reason);
        assert_eq!(ends, (StopReason::Domain, StopReason::Domain));
        let last = found.branch.points.len() - 1;
        assert!((mu[0] + mu[last]).abs() < 1e-10 && found.branch.points[0].p == 2.0);
        assert!(found.branch.points.windows(2).all(|w| w[1].s > w[0].s));
    }
}

/// The fold in `λ` at `μ = 1/2`, where `2x³ = −μ`; the curve is traced in `μ`.
#[test]
fn the_cusp_with_the_parameters_exchanged() {
    let settings =
        Settings { domain: Some((0.0, 3.0)), increasing: Some(false), ..Settings::default() };
    let branch = Tracer::new(&Cusp, "lambda", &[-1.3], &[0.5, 2.0], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    let fold = branch.events_of(&EventKind::Fold).next().unwrap();
    let curve = FoldCurve::at(&Cusp, &branch, fold, "mu").unwrap();
    for max_step in [None, Some(0.01), Some(5.0)] {
        let found = follow(&curve, (-1.0, 1.0), max_step, &[]);
        println!("{max_step:?} {}", account(&found, "lambda"));
        let lambda = found.column("lambda").unwrap();
        let [cusp] = &found.branch.events[..] else { panic!("{max_step:?}") };
        assert_eq!(cusp.kind, EventKind::Cusp);
        assert!(lambda[cusp.point].abs() < 1e-10 && cusp.p.abs() < 1e-10);
    }
}

#[test]
fn unusable_starts_are_refused_with_a_reason() {
    let branch = trace(&Cusp, "mu", &[1.5], &[2.0, 1.0], -2.0);
    let fold = branch.events_of(&EventKind::Fold).next().unwrap();
    let refuse = |event: &Event, second: &str| FoldCurve::at(&Cusp, &branch, event, second).err();
    assert!(matches!(refuse(fold, "mu"), Some(CurveError::SameParameter { .. })));
    assert!(matches!(refuse(fold, "nu"), Some(CurveError::UnknownParameter { .. })));
    let other = Event { kind: EventKind::Hopf, ..fold.clone() };
    assert!(matches!(refuse(&other, "lambda"), Some(CurveError::Kind { .. })));
    let other = Event { point: 100_000, ..fold.clone() };
    assert!(matches!(refuse(&other, "lambda"), Some(CurveError::Foreign { .. })));
}

pub(crate) fn co_oxidation() -> impl Problem {
    DenseProblem::from_residual(3, &["p", "k"], |u, p, r| {
        let [x, y, s] = [u[0], u[1], u[2]];
        let z = 1.0 - x - y - s;
        r[0] = 5.0 * z * z - 2.0 * x * x - 10.0 * x * y;
        r[1] = p[0] * z - 0.1 * y - 10.0 * x * y;
        r[2] = 0.0675 * (z - p[1] * s);
    })
    .boxed()
}

pub(crate) fn co_branch<P: Problem>(problem: &P) -> Branch {
    let mut u = vec![0.1, 0.2, 0.5];
    continuation::newton(problem, &mut u, &[1.0, 0.4], &Default::default()).unwrap();
    trace(problem, "p", &u, &[1.0, 0.4], 2.5)
}

/// Multiple precision; the tutorial of BifurcationKit.jl prints 0.356654 for the cusp's `k`.
#[test]
fn the_fold_curve_of_co_oxidation() {
    let problem = co_oxidation();
    let branch = co_branch(&problem);
    println!("{:?}", branch.events.iter().map(|e| (e.kind.to_string(), e.p)).collect::<Vec<_>>());
    let takens =
        [(1.161_198_708_821_7, 0.722_339_072_522), (1.417_627_637_600_6, 0.971_397_573_485)];
    for fold in branch.events_of(&EventKind::Fold) {
        for max_step in [None, Some(0.003), Some(0.3)] {
            let curve = FoldCurve::at(&problem, &branch, fold, "k").unwrap();
            let found = follow(&curve, (0.2, 2.0), max_step, &[Watch::stop_at("p", 3.0)]);
            println!(
                "{max_step:?} {} {:?} {:?}",
                account(&found, "p"),
                found.first_end,
                found.branch.stopped
            );
            let p = found.column("p").unwrap();
            let cusp = of_kind(&found, &EventKind::Cusp);
            assert_eq!(cusp.len(), 1);
            assert!((cusp[0].p - 0.355_991_273_209).abs() < 1e-10);
            assert!((p[cusp[0].point] - 1.006_408_329_678_3).abs() < 1e-10);
            let mut all = of_kind(&found, &EventKind::BogdanovTakens);
            all.sort_by(|a, b| a.p.total_cmp(&b.p));
            assert_eq!(all.len(), 2);
            for (event, (at, k)) in all.iter().zip(takens) {
                assert!((event.p - k).abs() < 1e-10 && (p[event.point] - at).abs() < 1e-10);
                assert!(event.error_estimate < 1e-8);
            }
        }
    }
}

/// A shallow arch of rise `h` under the load `p`, in two modes: folds at `3b² = h² − 1`, where from
/// `h² = 5.5` on the antisymmetric mode has become critical before. One cusp, at `h = 1`.
#[test]
fn no_cusp_where_another_mode_becomes_critical() {
    let arch = DenseProblem::from_residual(2, &["load", "rise"], |u, p, r| {
        let (b, a, h) = (u[0], u[1], p[1]);
        let thrust = h * h - b * b - 4.0 * a * a;
        r[0] = b - h - thrust * b + p[0];
        r[1] = 16.0 * a - 4.0 * thrust * a;
    })
    .boxed()
    .with_stability(Stability::EnergyHessian);
    let branch = trace(&arch, "load", &[1.5, 0.0], &[0.0, 1.5], 3.0);
    let fold = branch.events_of(&EventKind::Fold).next().unwrap();
    for max_step in [None, Some(0.01), Some(0.1), Some(0.3), Some(5.0)] {
        let curve = FoldCurve::at(&arch, &branch, fold, "rise").unwrap();
        let found = follow(&curve, (0.5, 4.0), max_step, &[]);
        println!("{max_step:?} {}", account(&found, "load"));
        for point in &found.branch.points {
            let (b, h) = (point.u[0], point.p);
            assert!((3.0 * b * b - h * h + 1.0).abs() < 1e-7, "{max_step:?} {:?}", point.u);
        }
        let cusp = of_kind(&found, &EventKind::Cusp);
        assert_eq!(cusp.len(), 1, "{max_step:?}");
        assert!((cusp[0].p - 1.0).abs() < 1e-9);
    }
}
