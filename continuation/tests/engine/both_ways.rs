//! A branch from a solution somewhere on it, followed both ways and kept as one.

#![allow(clippy::unwrap_used)]

use continuation::samples::Cusp;
use continuation::{
    Branch, DenseProblem, EventKind, Problem, Settings, StopReason, Tracer, Watch, both_ways,
};
use std::ops::ControlFlow;

fn trace<P: Problem>(problem: &P, name: &str, u: &[f64], p: &[f64], settings: Settings) -> Branch {
    both_ways(problem, name, u, p, settings, &[], &mut |_| ControlFlow::Continue(())).unwrap()
}

/// What holds of every branch.
fn consistent(branch: &Branch) {
    assert_eq!(branch.points[0].s, 0.0);
    for pair in branch.points.windows(2) {
        assert!(pair[0].s < pair[1].s);
        let (dp, ds) = (pair[1].p - pair[0].p, pair[1].s - pair[0].s);
        let bound = 1.1 * pair[0].dp_ds.abs().max(pair[1].dp_ds.abs()) + 0.05;
        assert!((dp / ds).abs() <= bound, "{dp} in {ds}");
        if dp.abs() > 0.2 * ds {
            assert!(dp * pair[0].dp_ds > 0.0 || dp * pair[1].dp_ds > 0.0, "tangents lead onwards");
        }
    }
    let mut last = 0;
    for (k, event) in branch.events.iter().enumerate() {
        assert!(event.point >= last);
        last = event.point;
        assert_eq!(branch.points[event.point].event, Some(k));
        assert_eq!(branch.points[event.point].p, event.p);
        let mut after = branch.points[event.point + 1..].iter();
        let regular = after.find(|q| q.event.is_none()).unwrap();
        assert_eq!(regular.unstable, event.unstable_after);
    }
    let marked = branch.points.iter().filter(|q| q.event.is_some()).count();
    assert_eq!(marked, branch.events.len());
}

#[test]
fn the_cusp_from_its_middle_sheet() {
    let exact = 2.0 / (3.0 * 3f64.sqrt());
    for (increasing, sign) in [(None, 1.0), (Some(true), 1.0), (Some(false), -1.0)] {
        let settings = Settings { domain: Some((-2.0, 1.5)), increasing, ..Settings::default() };
        let branch = trace(&Cusp, "mu", &[-0.05], &[0.0, 1.0], settings);
        consistent(&branch);
        // μ increases at the start, so x decreases there: from the upper sheet to the lower one
        let (first, last) = (&branch.points[0], branch.points.last().unwrap());
        let ends = if sign > 0.0 { [1.5, -2.0] } else { [-2.0, 1.5] };
        assert_eq!([first.p, last.p], ends);
        assert!(first.u[0] * sign > 1.0 && last.u[0] * sign < -1.0);
        let folds: Vec<_> = branch.events_of(&EventKind::Fold).collect();
        assert_eq!(folds.len(), 2);
        for (fold, side) in folds.iter().zip([-sign, sign]) {
            assert!((fold.p - side * exact).abs() < 1e-12, "{increasing:?}: {}", fold.p);
        }
        let counts: Vec<_> = folds.iter().map(|f| (f.unstable_before, f.unstable_after)).collect();
        assert_eq!(counts, [(Some(0), Some(1)), (Some(1), Some(0))]);
        assert_eq!(branch.stopped.reason, StopReason::Domain);
        assert_eq!(branch.began.as_ref().unwrap().reason, StopReason::Domain);
        assert!(branch.is_complete());
        // the length of the curve μ = x³ − x between the ends
        let f = |x: f64| (1.0 + (3.0 * x * x - 1.0).powi(2)).sqrt();
        let (a, b) = (first.u[0], last.u[0]);
        let n = 20_000;
        let h = (a - b) / f64::from(n);
        let length: f64 = (0..n).map(|i| f(b + (f64::from(i) + 0.5) * h) * h).sum();
        assert!((last.s / length.abs() - 1.0).abs() < 1e-2, "{} {length}", last.s);
        let copy: Branch = serde_json::from_str(&serde_json::to_string(&branch).unwrap()).unwrap();
        assert_eq!(copy, branch);
    }
}

fn circle() -> impl Problem {
    DenseProblem::from_residual(1, &["p"], |u, p, r| r[0] = u[0] * u[0] + p[0] * p[0] - 1.0).boxed()
}

#[test]
fn a_closed_loop_is_traced_once() {
    let branch = trace(&circle(), "p", &[1.0], &[0.3], Settings::default());
    consistent(&branch);
    assert_eq!(branch.stopped.reason, StopReason::ClosedLoop);
    assert_eq!(branch.began.as_ref(), Some(&branch.stopped));
    assert_eq!(branch.events_of(&EventKind::Fold).count(), 2);
    let length = branch.points.last().unwrap().s;
    assert!(length > 6.0 && length < 6.29 + 0.2, "{length}");
}

#[test]
fn a_loop_longer_than_one_half_may_be_is_not_traced_twice() {
    let whole = trace(&circle(), "p", &[1.0], &[0.3], Settings::default()).points.len();
    for max_points in [2 * whole / 3, 4 * whole / 5, whole - 2] {
        let settings = Settings { max_points, ..Settings::default() };
        let branch = trace(&circle(), "p", &[1.0], &[0.3], settings);
        consistent(&branch);
        let (began, stopped) = (branch.began.as_ref().unwrap(), &branch.stopped);
        assert_eq!(
            (began.reason, stopped.reason),
            (StopReason::ClosedLoop, StopReason::ClosedLoop)
        );
        assert_eq!(branch.events_of(&EventKind::Fold).count(), 2, "{max_points}");
        let length = branch.points.last().unwrap().s;
        assert!(length > 6.0 && length < 6.29 + 0.4, "{length}");
    }
    // two short halves do not meet
    let settings = Settings { max_points: whole / 3, ..Settings::default() };
    let branch = trace(&circle(), "p", &[1.0], &[0.3], settings);
    let (began, stopped) = (branch.began.as_ref().unwrap(), &branch.stopped);
    assert_eq!((began.reason, stopped.reason), (StopReason::MaxPoints, StopReason::MaxPoints));
    assert!(!branch.is_complete());
    assert_eq!(branch.points.len(), 2 * (whole / 3) - 1);
}

#[test]
fn branch_points_on_both_sides_can_be_left() {
    // x (x² + p² − 1): pitchforks at p = ±1 on x = 0, joined by a circle
    let problem = DenseProblem::from_residual(1, &["p"], |u, p, r| {
        r[0] = u[0] * (1.0 - p[0] * p[0] - u[0] * u[0]);
    })
    .boxed();
    let settings = Settings { domain: Some((-2.0, 2.5)), ..Settings::default() };
    let branch = trace(&problem, "p", &[0.0], &[0.1], settings.clone());
    consistent(&branch);
    let found: Vec<_> = branch.events_of(&EventKind::BranchPoint).collect();
    assert_eq!(found.len(), 2);
    let counts: Vec<_> = found.iter().map(|f| (f.unstable_before, f.unstable_after)).collect();
    assert_eq!(counts, [(Some(0), Some(1)), (Some(1), Some(0))]);
    for (event, p) in found.iter().zip([-1.0, 1.0]) {
        assert!((event.p - p).abs() < 1e-9);
        let crossing = event.crossing().unwrap();
        assert!(crossing.traced.dp > 0.0, "along the branch");
        let side =
            Tracer::leaving(&problem, &branch, event, &crossing.leaving[0], true, settings.clone())
                .unwrap()
                .run(&mut |_| ControlFlow::Continue(()));
        let p_end = side.points.iter().map(|q| q.p * p).fold(f64::INFINITY, f64::min);
        assert!(p_end < -0.9, "the circle leads to the other one: {p_end}");
    }
    // the same as from one end
    let one = Tracer::new(&problem, "p", &[0.0], &[-2.0], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    assert!((one.points.last().unwrap().s - branch.points.last().unwrap().s).abs() < 1e-12);
    assert_eq!(one.events.len(), branch.events.len());
}

#[test]
fn watches_work_on_both_halves_and_observers_count_on() {
    let settings = Settings { domain: Some((-2.0, 2.0)), ..Settings::default() };
    let watches = [Watch::parameter(0.0), Watch::extremum("x")];
    let (mut calls, mut last) = (0, 0.0);
    let branch =
        both_ways(&Cusp, "mu", &[0.1], &[0.1, 1.0], settings.clone(), &watches, &mut |at| {
            calls += 1;
            assert_eq!(at.points, calls);
            assert!(at.s >= last);
            last = at.s;
            ControlFlow::Continue(())
        })
        .unwrap();
    consistent(&branch);
    assert_eq!(calls, branch.points.len() + 1, "the start is met twice");
    assert_eq!(branch.events_of(&EventKind::Target).count(), 3);
    assert_eq!(branch.events.len(), 5);
    // an interrupted first half is the whole
    let mut calls = 0;
    let branch = both_ways(&Cusp, "mu", &[0.1], &[0.1, 1.0], settings, &[], &mut |_| {
        calls += 1;
        if calls == 5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })
    .unwrap();
    assert_eq!((calls, branch.points.len()), (5, 5));
    assert_eq!(branch.began.unwrap().reason, StopReason::Interrupted);
    assert_eq!(branch.stopped.reason, StopReason::Interrupted);
}
