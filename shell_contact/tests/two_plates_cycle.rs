//! Cycles of the shell from pole to pole, under a grip and with its upper plate on a cantilever.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod support;

use continuation::{Matrix, Settings, StopReason};
use shell_contact::device::{
    Cycle, CycleSettings, Direction, Loading, RelaxationSettings, balance, travel,
};
use shell_contact::two_plates::{
    Plate, Support, SupportedProblem, TwoPlatesGroups, TwoPlatesProblem, stable_start,
};
use shell_contact::{Law, trace_contact};
use std::ops::ControlFlow;
use support::contact;

const FILM: f64 = 1.0 / 30.0;
const FIG12: [f64; 6] = [3e-5, 3e-3, 2e-3, FILM, 0.0, 1.07];

fn fig12(elements: usize) -> TwoPlatesProblem {
    let half = contact(elements, Law::Hooke, FIG12);
    let groups = TwoPlatesGroups::equal(half.groups());
    TwoPlatesProblem::new(half.shell(), &groups, half.mesh().clone()).unwrap()
}

fn settings(start: f64, end: f64, relaxation: RelaxationSettings) -> CycleSettings {
    let trace = Settings { max_step: Some(0.01), ..Settings::default() };
    CycleSettings { start, end, trace, relaxation }
}

fn go<P: Loading>(problem: &P, x: &[f64], settings: &CycleSettings) -> Cycle {
    travel(problem, x, settings, &mut |_| ControlFlow::Continue(())).unwrap()
}

#[track_caller]
fn near(got: f64, want: f64, tolerance: f64) {
    assert!((got - want).abs() <= tolerance, "{got} is not {want} to {tolerance:e}");
}

/// What the jumps dissipate is the area of the loop, and every state reached is a stable equilibrium.
fn is_balanced<P: Loading>(problem: &P, cycle: &Cycle) {
    assert_eq!(cycle.stopped.reason, StopReason::ClosedLoop, "{:?}", cycle.stopped);
    let (area, lost) = (balance(problem, cycle).unwrap(), cycle.dissipated().unwrap());
    near(area.loop_area.unwrap(), lost, 1e-6 * lost);
    let mut hessian = problem.new_jacobian();
    for jump in &cycle.jumps {
        assert!(jump.dissipated.unwrap() > 0.0, "{jump:?}");
        let after = &cycle.points[jump.after.unwrap()];
        let p = problem.parameters_at(jump.parameter);
        let mut r = vec![0.0; problem.dim()];
        problem.linearise(&after.u, &p, &mut r, &mut hessian).unwrap();
        assert!(r.iter().all(|r| r.abs() < 1e-10));
        let floor = f64::EPSILON * hessian.norm();
        let (negative, _) = hessian.factor(floor).inertia.unwrap();
        assert_eq!(negative, problem.multipliers(), "after the jump at {}", jump.parameter);
    }
}

/// Shift of the equator towards the upper plate, and heights of both poles over it.
fn shape(problem: &TwoPlatesProblem, cycle: &Cycle, at: Option<usize>) -> [f64; 3] {
    let point = &cycle.points[at.unwrap()];
    let seen = problem.observation(&point.u, &problem.parameters_at(point.z0)).unwrap();
    [seen.shift.abs(), seen.pole_top.min(seen.pole_bottom), seen.pole_top.max(seen.pole_bottom)]
}

/// The bubble hangs on one plate and comes off where its branch folds; between both plates it keeps its
/// mirror image until one pole buckles; on the way back that pole snaps out first, and at pull-off the
/// bubble goes to one plate again. Places are those of the independent solver to the difference of its
/// meshes, or of this one's.
#[test]
fn a_bubble_leaves_its_mirror_image_on_both_ways() {
    let problem = fig12(100);
    let x = stable_start(&problem, &problem.initial_state(), 1.15).unwrap();
    let cycle = go(&problem, &x, &settings(1.15, 0.65, RelaxationSettings::default()));
    is_balanced(&problem, &cycle);
    let ways: Vec<Direction> = cycle.jumps.iter().map(|jump| jump.direction).collect();
    let (approach, retract) = (Direction::Approach, Direction::Retract);
    assert_eq!(ways, [approach, approach, retract, retract]);
    let places = [1.008_13, 0.818_762, 0.874_234, 1.030_245_11];
    for (jump, place) in cycle.jumps.iter().zip(places) {
        near(jump.parameter, place, 5e-6);
    }
    // to both plates; one pole buckles; it snaps out; onto one plate
    let after: Vec<[f64; 3]> =
        cycle.jumps.iter().map(|j| shape(&problem, &cycle, j.after)).collect();
    for k in [0, 2] {
        near(after[k][0], 0.0, 1e-9);
        near(after[k][1], after[k][2], 1e-9);
    }
    assert!(after[1][1] < 0.6 && after[1][2] > 0.8, "{:?}", after[1]);
    assert!(after[3][0] > 0.1 && after[3][2] > 1.0, "{:?}", after[3]);
    // how closely the motions are followed does not matter
    let fine =
        RelaxationSettings { accuracy: 0.03, longest_move: 0.01, ..RelaxationSettings::default() };
    let again = go(&problem, &x, &settings(1.15, 0.65, fine));
    assert_eq!(again.jumps.len(), 4);
    for (a, b) in cycle.jumps.iter().zip(&again.jumps) {
        near(a.dissipated.unwrap(), b.dissipated.unwrap(), 1e-10);
    }
}

/// Both poles lose their stability at the same place to rounding, so that the critical mode is any sum of
/// the two: on every mesh one of them buckles.
#[test]
fn which_sum_of_two_modes_is_found_does_not_matter() {
    for elements in (71..125).step_by(9) {
        let problem = fig12(elements);
        let x = stable_start(&problem, &problem.initial_state(), 1.15).unwrap();
        for accuracy in [0.1, 0.03] {
            let relaxation = RelaxationSettings { accuracy, ..RelaxationSettings::default() };
            let cycle = go(&problem, &x, &settings(1.15, 0.79, relaxation));
            let buckled = &cycle.jumps[1]; // the first is that onto both plates
            near(buckled.parameter, 0.818_762, 1e-4);
            let [_, lower, upper] = shape(&problem, &cycle, buckled.after);
            assert!(lower < 0.6 && upper > 0.78, "{elements}: {lower}, {upper}");
        }
    }
}

/// A weak film lets the bubble come off its plate without a jump: both ways lead through the pitchfork of the
/// mirror images, whose mode is the softer the weaker the film, and nothing is dissipated.
#[test]
fn a_weak_film_is_left_and_met_without_a_jump() {
    for adhesion in [8.18e-4, 8.18e-5, 2e-5, 8.18e-6, 2e-6] {
        let half = contact(60, Law::Hooke, [1.01e-3, 1.66e-3, adhesion, 0.066, 0.0, 1.4]);
        let groups = TwoPlatesGroups::equal(half.groups());
        let problem = TwoPlatesProblem::new(half.shell(), &groups, half.mesh().clone()).unwrap();
        let x = stable_start(&problem, &problem.initial_state(), 1.4).unwrap();
        let cycle = go(&problem, &x, &settings(1.4, 0.9, RelaxationSettings::default()));
        assert_eq!(cycle.stopped.reason, StopReason::ClosedLoop, "{adhesion}: {:?}", cycle.stopped);
        assert!(cycle.jumps.is_empty(), "{adhesion}: {:?}", cycle.jumps);
        let work = balance(&problem, &cycle).unwrap();
        near(work.loop_area.unwrap(), 0.0, 1e-9 * work.approach.abs());
        // on one plate at first, between both when they are near
        let shift = |at: Option<usize>| shape(&problem, &cycle, at)[0];
        assert!(shift(Some(0)) > 0.1);
        let turn = cycle.points.iter().position(|point| point.direction == Direction::Retract);
        near(shift(turn), 0.0, 1e-7);
    }
}

/// Beyond its folds the buckled shell loses its mirror image too: one dimple grows while the other
/// heals, and the way back is another one.
#[test]
fn of_two_dimples_one_grows() {
    let problem = fig12(100);
    let half = contact(100, Law::Hooke, FIG12);
    let trace = Settings { target: Some(0.7), max_step: Some(0.01), ..Settings::default() };
    let branch = trace_contact(&half, 1.15, trace, &mut |_| ControlFlow::Continue(())).unwrap();
    let buckled = branch.branch.points.iter().rev().find(|point| point.p > 0.85).unwrap();
    let (x, start) = (problem.joined(&buckled.u, &buckled.u, 0.0), buckled.p);
    let cycle = go(&problem, &x, &settings(start, 0.75, RelaxationSettings::default()));
    is_balanced(&problem, &cycle);
    assert_eq!(cycle.jumps.len(), 4);
    // antisymmetric modes turn at the first and the third, at 400 elements
    near(cycle.jumps[0].parameter, 0.821_816_61, 2e-7);
    near(cycle.jumps[2].parameter, 0.777_922_86, 5e-7);
    for jump in &cycle.jumps {
        let [before, after] = [jump.before, jump.after].map(|at| shape(&problem, &cycle, at)[0]);
        assert_ne!(before < 1e-6, after < 1e-6);
    }
}

/// A plate that attracts more strongly keeps the bubble; one plate alone with the equator held; the
/// upper plate on a cantilever, whose loop is measured by its base.
#[test]
fn other_plates_and_supports() {
    let half = contact(60, Law::Hooke, FIG12);
    let groups = TwoPlatesGroups::equal(half.groups());
    let with = |groups: &TwoPlatesGroups| {
        TwoPlatesProblem::new(half.shell(), groups, half.mesh().clone()).unwrap()
    };
    let weak = Plate { adhesion: 1e-3, film: FILM };
    let unequal = with(&TwoPlatesGroups { bottom: weak, ..groups });
    let x = stable_start(&unequal, &unequal.initial_state(), 1.15).unwrap();
    let cycle = go(&unequal, &x, &settings(1.15, 0.95, RelaxationSettings::default()));
    is_balanced(&unequal, &cycle);
    let last = cycle.points.last().unwrap();
    let seen = unequal.observation(&last.u, &unequal.parameters_at(1.15)).unwrap();
    assert!(seen.shift > 0.1, "{seen:?}");

    let absent = Plate { adhesion: 0.0, film: FILM };
    let one = with(&TwoPlatesGroups { bottom: absent, ..groups });
    let held = SupportedProblem::new(&one, Support { held: true, spring: None }).unwrap();
    let rest = held.state(&one.initial_state(), 1.15);
    let x = stable_start(&held, &rest, 1.15).unwrap();
    let cycle = go(&held, &x, &settings(1.15, 0.8, RelaxationSettings::default()));
    is_balanced(&held, &cycle);
    assert!(!cycle.jumps.is_empty());

    let both = with(&groups);
    let spring = Support { held: false, spring: Some(20.0) };
    let sprung = SupportedProblem::new(&both, spring).unwrap();
    let rest = sprung.state(&both.initial_state(), 1.2);
    let x = stable_start(&sprung, &rest, 1.2).unwrap();
    let there = settings(1.2, 0.9, RelaxationSettings::default());
    // it may come back on the other plate, and does so from then on
    let first = go(&sprung, &x, &there);
    let cycle = go(&sprung, &first.points.last().unwrap().u, &there);
    is_balanced(&sprung, &cycle);
    assert!(cycle.jumps.len() >= 2);
    for point in &cycle.points {
        // the spring takes up the force: F = 2 k_c (z0 - base)
        near(point.force, 40.0 * (point.z0 - point.parameter), 1e-8);
    }
}
