//! The branch of mirror images from pole to pole, traced on half the shell.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod support;

use continuation::{Criticality, EventKind, Matrix, Settings, Shape, StopReason, Tracer};
use shell_contact::device::Loading;
use shell_contact::modes::{ScanSettings, WholeModes, WholeShell};
use shell_contact::two_plates::{
    Plate, Support, SupportedProblem, SymmetricBranch, TwoPlatesGroups, TwoPlatesProblem,
    trace_symmetric,
};
use shell_contact::{Law, force_watches};
use std::ops::ControlFlow;
use support::contact;

const FILM: f64 = 1.0 / 30.0;
const FIG12: [f64; 6] = [3e-5, 3e-3, 2e-3, FILM, 0.0, 1.07];
const FIG16: [f64; 6] = [2.7e-3, 3.0, 0.02, FILM, 0.0, 1.07];

fn whole(elements: usize, law: Law, groups: [f64; 6]) -> TwoPlatesProblem {
    let half = contact(elements, law, groups);
    let groups = TwoPlatesGroups::equal(half.groups());
    TwoPlatesProblem::new(half.shell(), &groups, half.mesh().clone()).unwrap()
}

fn settings(end: f64) -> Settings {
    Settings { target: Some(end), max_step: Some(0.01), ..Settings::default() }
}

fn traced<P: WholeShell>(
    problem: &P,
    (start, end): (f64, f64),
    scan: Option<ScanSettings>,
) -> SymmetricBranch {
    let go_on = &mut |_: &_| ControlFlow::Continue(());
    trace_symmetric(problem, start, settings(end), scan, go_on).unwrap().unwrap()
}

/// Every point is an equilibrium of the whole, with its observables, and as many unstable modes as the
/// inertia of the whole Hessian says; at special points too, where that is not singular.
fn is_of_the_whole<P: Loading>(problem: &P, found: &SymmetricBranch) {
    let branch = &found.branch;
    let mut hessian = problem.new_jacobian();
    let (mut r, mut seen) = (vec![0.0; problem.dim()], vec![0.0; problem.observables().len()]);
    let column = |name: &str| branch.observables.iter().position(|own| own == name).unwrap();
    for point in &branch.points {
        let p = problem.parameters_at(point.p);
        problem.linearise(&point.u, &p, &mut r, &mut hessian).unwrap();
        let largest = r.iter().fold(0.0_f64, |most, r| most.max(r.abs()));
        assert!(largest < 1e-10, "{largest:e} at {}", point.p);
        problem.observe(&point.u, &p, &mut seen).unwrap();
        assert_eq!(seen.len(), point.observables.len());
        for (a, b) in seen.iter().zip(&point.observables) {
            assert!(a == b || (a.is_nan() && b.is_nan()));
        }
        let [top, bottom] = ["force", "force_bottom"].map(|name| point.observables[column(name)]);
        assert!((top - bottom).abs() < 1e-8, "{top} {bottom}");
        if point.event.is_none() {
            let floor = f64::EPSILON * hessian.norm();
            let (negative, _) = hessian.factor(floor).inertia.unwrap();
            assert_eq!(Some(negative - problem.multipliers()), point.unstable, "at {}", point.p);
        }
    }
    // each change of the count has its special point
    for (k, event) in branch.events.iter().enumerate() {
        assert_eq!(branch.points[event.point].event, Some(k));
        let beside = [event.point.wrapping_sub(1), event.point + 1]
            .map(|at| branch.points.get(at).filter(|point| point.event.is_none()));
        for (at, count) in beside.into_iter().zip([event.unstable_before, event.unstable_after]) {
            assert!(at.is_none_or(|point| point.unstable == count), "{event:?}");
        }
    }
    assert!(branch.is_certain(), "{:?}", branch.doubts);
    assert_eq!(branch.stopped.reason, StopReason::Target, "{:?}", branch.stopped);
}

/// The tracer of the whole shell, which meets every odd mode, finds the same special points.
#[test]
fn the_branch_of_the_half_is_that_of_the_whole() {
    let problem = whole(100, Law::Hooke, FIG12);
    let found = traced(&problem, (1.15, 0.7), Some(ScanSettings::default()));
    is_of_the_whole(&problem, &found);
    let (u, p) = (problem.initial_state(), problem.parameters_at(1.15));
    let direct = Tracer::new(&problem, "z0", &u, &p, settings(0.7))
        .and_then(|tracer| tracer.watching(&force_watches()))
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    let kinds = |branch: &continuation::Branch| -> Vec<EventKind> {
        branch.events.iter().map(|event| event.kind.clone()).collect()
    };
    assert_eq!(kinds(&found.branch), kinds(&direct));
    let mut forks = 0;
    for (own, other) in found.branch.events.iter().zip(&direct.events) {
        let near = (own.p - other.p).abs();
        assert!(near <= own.error_estimate + 2.0 * other.error_estimate + 1e-10, "{own:?}");
        let counts = |event: &continuation::Event| (event.unstable_before, event.unstable_after);
        assert_eq!(counts(own), counts(other));
        if let (Some(a), Some(b)) = (own.crossing(), other.crossing()) {
            // two ways to the same bend: states on the branch, and the engine's third derivatives
            assert_eq!((a.shape, a.criticality), (b.shape, b.criticality));
            let apart = (a.curvature - b.curvature).abs();
            assert!(apart < 2e-3 * b.curvature.abs(), "{} {}", a.curvature, b.curvature);
            forks += 1;
        }
    }
    assert!(forks >= 4, "{forks}");
    // the null vector of a fold, up to its sign
    for (own, other) in found.branch.events.iter().zip(&direct.events) {
        if own.kind != EventKind::Fold {
            continue;
        }
        let [a, b] = [own, other].map(|event| event.critical_modes()[0].re.clone());
        let along: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
        assert!((along.abs() - 1.0).abs() < 1e-4, "{along}");
    }
    // modes with waves are those of the whole too
    let mut modes = WholeModes::new(problem.mesh());
    assert_eq!(found.waves.points.len(), found.branch.points.len());
    let mut counted = 0;
    for (point, scan) in found.branch.points.iter().zip(&found.waves.points).step_by(7) {
        modes.assemble(&problem, &point.u, &problem.parameters_at(point.p)).unwrap();
        let own = modes.scan(40);
        if own.certain && scan.certain {
            assert_eq!((own.modes, own.first_n), (scan.modes, scan.first_n), "at {}", point.p);
            counted += 1;
        }
    }
    assert!(counted > 10 && found.waves.events.len() > 10 && found.waves.missed.is_empty());
    for event in &found.waves.events {
        let (from, to) = (&found.branch.points[event.after_point], event.after_point + 1);
        let to = &found.branch.points[to];
        assert!((0.0..=1.0).contains(&event.share), "{}", event.share);
        assert!((event.z0 - from.p) * (event.z0 - to.p) < 1e-9, "{}", event.z0);
        assert_eq!(event.mode_shape.s.len(), 2 * 100 + 1);
    }
}

/// `z0 − z0c = c a²`, `a` the largest axial amplitude of the mode, against the independent solver.
#[test]
fn pitchforks_bend_as_the_independent_solver_says() {
    for (law, groups, start, end, at, bend, soft) in [
        (Law::Hooke, FIG12, 1.15, 0.8, 0.821_816_61, 0.545, Criticality::Subcritical),
        (
            Law::MooneyRivlin { b: 1.0 },
            FIG16,
            1.3,
            1.05,
            1.062_917_42,
            1.788,
            Criticality::Supercritical,
        ),
    ] {
        let problem = whole(100, law, groups);
        let found = traced(&problem, (start, end), None);
        assert!(found.waves.points.is_empty());
        let forks = found.branch.events_of(&EventKind::BranchPoint);
        let fork = forks.min_by(|a, b| (a.p - at).abs().total_cmp(&(b.p - at).abs())).unwrap();
        assert!((fork.p - at).abs() < 1e-6, "{}", fork.p);
        let crossing = fork.crossing().unwrap();
        assert_eq!((crossing.shape, crossing.criticality), (Shape::Pitchfork, Some(soft)));
        let p = problem.parameters_at(fork.p);
        let u = &found.branch.points[fork.point].u;
        let moved: Vec<f64> =
            u.iter().zip(&crossing.leaving[0].du).map(|(u, d)| u + 1e-6 * d).collect();
        let [a, b] = [u, &moved].map(|u| problem.profile(u, &p, 401).unwrap().z);
        let largest = a.iter().zip(&b).fold(0.0_f64, |most, (a, b)| most.max((b - a).abs())) / 1e-6;
        let own = 0.5 * crossing.curvature / (largest * largest);
        assert!((own - bend).abs() < 2e-3 * bend, "{own} is not {bend}");
        assert!(crossing.curvature_error < 1e-2 * crossing.curvature.abs());
    }
}

/// On a soft spring the flat shape's fold and the loss of its symmetry are 1e-10 apart, which stopped the
/// tracer of the whole with branches too close.
#[test]
fn a_soft_spring_passes_the_fold_beside_its_pitchfork() {
    let both = whole(60, Law::Hooke, FIG12);
    for stiffness in [3.0, 6.0, 8.0, 30.0] {
        let support = Support { held: false, spring: Some(stiffness) };
        let sprung = SupportedProblem::new(&both, support).unwrap();
        // a little beyond the fold of the flat shape, where its force is largest
        let end = 0.818_76 - 2.698 / (2.0 * stiffness) - 0.02;
        let found = traced(&sprung, (1.5, end), None);
        is_of_the_whole(&sprung, &found);
        let z0 = found.branch.observables.iter().position(|name| name == "z0").unwrap();
        let heights: Vec<f64> = found.branch.points.iter().map(|p| p.observables[z0]).collect();
        assert!(heights.iter().any(|z| *z < 0.818_76), "{stiffness}");
        for point in &found.branch.points {
            let (base, force) = (point.p, point.observables[0]);
            let taken = 2.0 * stiffness * (point.observables[z0] - base);
            assert!((force - taken).abs() < 1e-8, "{force} {taken}");
        }
    }
}

/// Whoever ends the work keeps the points that there are, with their own counts.
/// Under a soft spring its base moves far while the plate hardly does: errors are those of the base. Where counts change
/// does not depend on the steps.
#[test]
fn places_under_a_soft_spring_are_within_their_errors() {
    for stiffness in [3.0, 6.0, 30.0] {
        let shell = whole(80, Law::Hooke, FIG12);
        let support = Support { spring: Some(stiffness), held: false };
        let problem = SupportedProblem::new(&shell, support).unwrap();
        let scan = ScanSettings { max_n: 4, ..ScanSettings::default() };
        let places = |max_step: f64| -> Vec<(f64, f64)> {
            let path = Settings { max_step: Some(max_step), ..settings(0.4) };
            let go_on = &mut |_: &_| ControlFlow::Continue(());
            let found = trace_symmetric(&problem, 1.5, path, Some(scan), go_on).unwrap().unwrap();
            let pitchforks = found.branch.events_of(&EventKind::BranchPoint);
            let pitchforks = pitchforks.map(|event| (event.p, event.error_estimate));
            pitchforks.chain(found.waves.events.iter().map(|w| (w.z0, w.error_estimate))).collect()
        };
        let (one, other) = (places(0.02), places(0.013));
        assert!(one.len() == other.len() && !one.is_empty());
        for ((a, a_error), (b, b_error)) in one.iter().zip(&other) {
            assert!((a - b).abs() <= a_error + b_error, "{a} ± {a_error:e}, {b} ± {b_error:e}");
        }
    }
}

#[test]
fn what_is_interrupted_keeps_its_points() {
    let problem = whole(40, Law::Hooke, FIG12);
    let all = traced(&problem, (1.15, 0.9), None).branch.points.len();
    for stop in [10, all + 3] {
        let mut told = 0;
        let mut observer = |_: &_| {
            told += 1;
            if told < stop { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        let scan = Some(ScanSettings::default());
        let found =
            trace_symmetric(&problem, 1.15, settings(0.9), scan, &mut observer).unwrap().unwrap();
        assert_eq!(found.branch.stopped.reason, StopReason::Interrupted);
        assert!(found.branch.points.len() >= all.min(10), "{}", found.branch.points.len());
        if stop > all {
            assert_eq!(found.branch.points.len(), all);
        }
        assert!(found.branch.points.iter().all(|point| point.unstable.is_some()));
    }
}

#[test]
fn what_tells_up_from_down_has_no_half() {
    let both = whole(40, Law::Hooke, FIG12);
    assert!(both.mirror_half().is_some());
    let held = SupportedProblem::new(&both, Support { held: true, spring: None }).unwrap();
    assert!(held.mirror_half().is_none());
    let weak = Plate { adhesion: 1e-3, film: FILM };
    let groups = TwoPlatesGroups { bottom: weak, ..*both.groups() };
    let unequal = TwoPlatesProblem::new(both.shell(), &groups, both.mesh().clone()).unwrap();
    assert!(unequal.mirror_half().is_none());
    let go_on = &mut |_: &_| ControlFlow::Continue(());
    assert!(trace_symmetric(&unequal, 1.15, settings(1.0), None, go_on).is_none());
}
