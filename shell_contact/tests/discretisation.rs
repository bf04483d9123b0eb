//! What the estimates of the mesh's error say against meshes that are finer.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod support;

use continuation::{EventKind, Settings};
use shell_contact::discretisation::{Refined, Shift};
use shell_contact::spline::Component;
use shell_contact::{ContactBranch, ContactProblem, Law, trace_contact};
use std::ops::ControlFlow;
use support::contact;

/// Kinds of special points, where they are, the force there, and what is said of both.
type Found = Vec<(EventKind, f64, f64, Shift)>;

fn trace(problem: &ContactProblem, end: f64) -> ContactBranch {
    let settings = Settings { target: Some(end), max_step: Some(0.02), ..Settings::default() };
    trace_contact(problem, 1.3, settings, &mut |_| ControlFlow::Continue(())).unwrap()
}

fn special_points(elements: usize, law: Law, groups: [f64; 6], end: f64) -> Found {
    let problem = contact(elements, law, groups);
    let branch = trace(&problem, end).branch;
    let mut refined = Refined::new(&problem).unwrap();
    let of = |event: &continuation::Event| {
        let point = &branch.points[event.point];
        let p = problem.parameters_at(event.p);
        let shift = refined.shift(&point.u, &p, Some(&event.kind)).unwrap().unwrap();
        (event.kind.clone(), event.p, point.observables[0], shift)
    };
    branch.events.iter().map(of).collect()
}

fn agree(what: &str, estimate: Option<f64>, moved: f64, rounding: f64) {
    let Some(estimate) = estimate else { return };
    let within = estimate < 2.0 * moved && moved < 2.0 * estimate;
    assert!(within || (moved - estimate).abs() < rounding, "{what}: {estimate:e}, not {moved:e}");
}

const FIG12: [f64; 6] = [3e-5, 3e-3, 2e-3, 1.0 / 30.0, 0.0, 1.07];

/// Special points move to those of a mesh four times as fine by what was estimated, within a factor of two.
#[test]
fn special_points_move_as_estimated() {
    let stiff = [1e-3, 1e-2, 5e-3, 0.05, 0.02, 1.4];
    for (law, groups, end, elements, count) in [
        (Law::Hooke, FIG12, 0.7, 150, 8),
        (Law::Hooke, FIG12, 0.7, 400, 8),
        (Law::Skalak, FIG12, 0.75, 200, 8),
        (Law::MooneyRivlin { b: 0.4 }, stiff, 0.7, 60, 2),
    ] {
        let found = special_points(elements, law, groups, end);
        let finer = special_points(4 * elements, law, groups, end);
        assert_eq!((found.len(), finer.len()), (count, count));
        for ((kind, z0, force, shift), (again, z0_finer, force_finer, _)) in
            found.iter().zip(&finer)
        {
            assert_eq!(kind, again);
            let what = format!("{elements} elements, {kind}");
            agree(&what, shift.z0, (z0 - z0_finer).abs(), 1e-11);
            agree(&what, shift.force, (force - force_finer).abs(), 1e-9);
            assert!(shift.z0.is_some() || shift.force.is_some());
        }
    }
}

/// The force at a given plate distance too, at every point of the branch.
#[test]
fn forces_change_as_estimated() {
    let of = |elements: usize| contact(elements, Law::Hooke, FIG12);
    let (problem, finer) = (of(200), of(800));
    let branch = trace(&problem, 0.7).branch;
    let mut refined = Refined::new(&problem).unwrap();
    let mut seen = 0;
    for point in branch.points.iter().filter(|point| point.event.is_none()) {
        let p = problem.parameters_at(point.p);
        let shift = refined.shift(&point.u, &p, None).unwrap().unwrap();
        // the same state on the finer mesh, from the spline's values
        let mut u = start_on(&finer, &problem, &point.u);
        let newton = continuation::NewtonSettings::default();
        if continuation::newton(&finer, &mut u, &p, &newton).is_err() {
            continue;
        }
        let force = finer.observation(&u, &p).unwrap().force;
        let what = format!("z0 = {}", point.p);
        agree(&what, shift.force, (force - point.observables[0]).abs(), 1e-9);
        seen += usize::from(shift.force.is_some());
    }
    assert!(seen > 100, "{seen}");
}

/// Coefficients on another mesh that interpolate nothing but are near: the spline's own values at the knots.
fn start_on(to: &ContactProblem, from: &ContactProblem, u: &[f64]) -> Vec<f64> {
    let knots = to.mesh().knots();
    let mut out = to.initial_state();
    for j in 0..=knots.elements() {
        let s = knots.at(j);
        let place = from.mesh().place(u, s);
        let values = [place.s[0] - s.sin(), place.z[0] - s.cos()];
        for (component, value) in [Component::U, Component::W].into_iter().zip(values) {
            if let Some((i, sign)) = knots.slot(component, j as isize) {
                out[i] = sign * value;
            }
        }
    }
    out
}

/// A number in `[0, 1)`, the next of a sequence.
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

/// Whether the elements resolve every state of a branch.
fn is_resolved(problem: &ContactProblem, branch: &continuation::Branch) -> bool {
    branch.points.iter().all(|point| {
        let p = problem.parameters_at(point.p);
        problem.resolution(&point.u, &p).unwrap().is_enough()
    })
}

/// Of 803 estimates for 300 shells as these 4 are outside a factor of two, at errors below 3e-8.
#[test]
fn so_it_is_for_random_shells() {
    let mut state = 20;
    let (mut compared, mut outside) = (0, 0);
    for k in 0..40 {
        let mut between = |low: f64, high: f64| low * (high / low).powf(random(&mut state));
        let groups = [
            between(3e-5, 3e-3),
            between(1e-3, 1e-1),
            between(2e-4, 5e-3),
            between(0.02, 0.08),
            if k % 3 == 0 { between(1e-3, 0.1) } else { 0.0 },
            between(1.0, 1.4),
        ];
        let law = [Law::Hooke, Law::Skalak, Law::MooneyRivlin { b: 0.5 }][k % 3];
        let elements = between(60.0, 240.0) as usize;
        let problem = contact(elements, law, groups);
        let branch = trace(&problem, 0.75).branch;
        if !is_resolved(&problem, &branch) {
            continue;
        }
        let found = special_points(elements, law, groups, 0.75);
        let finer = special_points(4 * elements, law, groups, 0.75);
        assert_eq!(found.len(), finer.len(), "shell {k}");
        for ((kind, z0, force, shift), (_, z0_finer, force_finer, _)) in found.iter().zip(&finer) {
            for (estimate, moved, rounding) in [
                (shift.z0, (z0 - z0_finer).abs(), 1e-11),
                (shift.force, (force - force_finer).abs(), 1e-9),
            ] {
                let Some(estimate) = estimate else { continue };
                let ratio = estimate / moved;
                let agrees = (0.5..2.0).contains(&ratio) || (estimate - moved).abs() < rounding;
                assert!(agrees || moved < 3e-8, "shell {k}, {kind}: {estimate:e}, not {moved:e}");
                compared += 1;
                outside += usize::from(!agrees);
            }
        }
    }
    assert!(compared > 80 && outside <= 1, "{outside} of {compared}");
}

/// The forces of random shells too, at every seventh point and at all beside folds, but where halving moves the fold over the
/// point; and the largest of a shell is known well. (Of 200 shells: 2175 points, none outside; the largest to 2 %.)
#[test]
fn the_largest_errors_of_forces_are_those_that_are_said() {
    let mut state = 77;
    let mut compared = 0;
    for k in 0..60 {
        let mut between = |low: f64, high: f64| low * (high / low).powf(random(&mut state));
        let groups = [
            between(3e-5, 3e-3),
            between(1e-3, 1e-1),
            between(2e-4, 5e-3),
            between(0.02, 0.08),
            if k % 3 == 0 { between(1e-3, 0.1) } else { 0.0 },
            between(1.0, 1.4),
        ];
        let law = [Law::Hooke, Law::Skalak, Law::MooneyRivlin { b: 0.5 }][k % 3];
        let elements = between(80.0, 240.0) as usize;
        let (problem, finer) = (contact(elements, law, groups), contact(4 * elements, law, groups));
        let branch = trace(&problem, 0.75).branch;
        if !is_resolved(&problem, &branch) {
            continue;
        }
        let folds: Vec<f64> = branch.events_of(&EventKind::Fold).map(|fold| fold.p).collect();
        let mut refined = Refined::new(&problem).unwrap();
        let mut found = Vec::new();
        for (i, point) in branch.points.iter().enumerate() {
            let beside = folds.iter().any(|fold| (fold - point.p).abs() < 1e-3);
            if point.event.is_some() || !(beside || i % 7 == 0) {
                continue;
            }
            let p = problem.parameters_at(point.p);
            let estimate = refined.shift(&point.u, &p, None).unwrap().unwrap().force;
            let mut u = start_on(&finer, &problem, &point.u);
            let newton = continuation::NewtonSettings::default();
            if continuation::newton(&finer, &mut u, &p, &newton).is_ok() {
                let force = finer.observation(&u, &p).unwrap().force;
                found.extend(estimate.map(|said| (said, (force - point.observables[0]).abs())));
            }
        }
        for (said, off) in &found {
            assert!(*off < 2.0 * said + 1e-9, "shell {k}: {said:e}, not {off:e}");
        }
        let largest = |of: fn(&(f64, f64)) -> f64| found.iter().map(of).fold(0.0, f64::max);
        let (said, off) = (largest(|x| x.0), largest(|x| x.1));
        assert!((said / off - 1.0).abs() < 0.1 || off < 1e-8, "shell {k}: {said:e}, not {off:e}");
        compared += found.len();
    }
    assert!(compared > 400, "{compared}");
}
