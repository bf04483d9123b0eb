//! Cycles in a rigid grip.

use super::{close, ends, fig12, fig16, grip_branch, gripped, settings};
use continuation::{EventKind, Matrix, Problem, StopReason};
use shell_contact::device::{CycleError, Direction, JUMP, balance, travel};
use shell_contact::{ContactProblem, Law};
use std::ops::ControlFlow;

/// Jumps lie at the folds; the states after them are stable, at the same height; the energy that is
/// dissipated is the difference of the energies; and the loop's area is the sum.
#[test]
fn a_grip_jumps_at_its_folds_and_the_loop_is_what_it_dissipates() {
    for (problem, start, end, known) in [
        (fig16(400), 1.3, 0.55, [1.128_512_371_317_8, 1.149_605_589_414_2]),
        (fig12(400), 1.15, 0.65, [0.818_761_957_896, 0.873_240_646_816_3]),
    ] {
        let cycle = gripped(&problem, start, end);
        assert_eq!(cycle.stopped.reason, StopReason::ClosedLoop, "{:?}", cycle.stopped);
        let branch = grip_branch(&problem, start, end);
        let folds: Vec<f64> = branch.events_of(&EventKind::Fold).map(|e| e.p).collect();
        let directions: Vec<Direction> = cycle.jumps.iter().map(|jump| jump.direction).collect();
        assert_eq!(directions, [Direction::Approach, Direction::Retract]);
        let mut hessian = problem.new_jacobian();
        for (k, jump) in cycle.jumps.iter().enumerate() {
            close(jump.parameter, folds[k], 1e-10);
            close(jump.parameter, known[k], 2e-9);
            let (before, after) = ends(&cycle, jump);
            assert_eq!((before.z0, after.z0), (jump.parameter, jump.parameter));
            assert_eq!(after.event.as_deref(), Some(JUMP));
            let dissipated = jump.dissipated.unwrap();
            close(dissipated, before.energy - after.energy, 1e-16);
            assert!(dissipated > 0.0);
            let p = problem.parameters_at(after.z0);
            let mut r = vec![0.0; problem.dim()];
            problem.linearise(&after.u, &p, &mut r, &mut hessian).unwrap();
            let floor = f64::EPSILON * hessian.norm();
            assert_eq!(hessian.factor(floor).inertia.unwrap().0, 0);
            hessian.solve(&mut r);
            assert!(r.iter().all(|step| step.abs() < 1e-11));
            println!("{:?} at {:.12}: {dissipated:.9e}", jump.direction, jump.parameter);
        }
        let (total, balance) = (cycle.dissipated().unwrap(), balance(&problem, &cycle).unwrap());
        let area = balance.loop_area.unwrap();
        println!("dissipated {total:.12e}, area off by {:.1e}", area / total - 1.0);
        close(area, total, 1e-7 * total);
        assert!((area - total).abs() < 10.0 * balance.error_estimate);
        close(area, balance.approach + balance.retract, 1e-15);
    }
}

/// The states that jumps reach converge with the mesh, and do not depend on the steps of the trace.
#[test]
fn jumps_converge_with_the_mesh_and_do_not_depend_on_steps() {
    let forces = [100, 200, 400].map(|elements| {
        let problem = fig16(elements);
        let cycle = gripped(&problem, 1.2, 1.08);
        let after: Vec<f64> = cycle.jumps.iter().map(|jump| ends(&cycle, jump).1.force).collect();
        let mut finer = settings(1.2, 1.08, 0.004);
        finer.trace.first_step = Some(1e-3);
        let again = super::go(&problem, &problem.initial_state(), &finer);
        for (k, jump) in again.jumps.iter().enumerate() {
            close(ends(&again, jump).1.force, after[k], 1e-9);
            close(jump.parameter, cycle.jumps[k].parameter, 1e-11);
        }
        assert_eq!((after.len(), again.jumps.len()), (2, 2));
        after
    });
    println!("{forces:?}");
    for k in 0..2 {
        let (coarse, fine) = (forces[0][k] - forces[1][k], forces[1][k] - forces[2][k]);
        assert!(fine.abs() < 1e-7 && fine.abs() < 0.3 * coarse.abs() + 1e-9, "{coarse:e} {fine:e}");
    }
}

fn quiet() -> ContactProblem {
    let law = Law::MooneyRivlin { b: 1.0 };
    super::contact(100, law, [2.7e-3, 3.0, 2e-3, 1.0 / 30.0, 0.0, 1.07])
}

#[test]
fn without_folds_nothing_is_dissipated() {
    let problem = quiet();
    let cycle = gripped(&problem, 1.2, 0.8);
    assert!(cycle.closed && cycle.jumps.is_empty());
    assert_eq!(cycle.dissipated().map(f64::to_bits), Some(0.0_f64.to_bits()));
    let balance = balance(&problem, &cycle).unwrap();
    close(balance.loop_area.unwrap(), 0.0, 1e-9 * balance.approach);
    let branch = grip_branch(&problem, 1.2, 0.8);
    let lowest = branch.events_of(&EventKind::Minimum("force".into())).next();
    assert!(lowest.is_none(), "it is called pull-off");
    let pull_off = EventKind::Named(shell_contact::trace::PULL_OFF.into());
    let point = branch.events_of(&pull_off).next().unwrap().point;
    close(cycle.pull_off().unwrap().force, branch.points[point].observables[0], 1e-12);
}

/// A start between the folds: the shell snaps in, and has not snapped off when the path is back.
#[test]
fn a_start_within_the_hysteresis_does_not_close() {
    let problem = fig16(100);
    let cycle = gripped(&problem, 1.14, 1.0);
    assert_eq!((cycle.jumps.len(), cycle.closed), (1, false));
    assert_eq!(cycle.stopped.reason, StopReason::Target);
    assert!(cycle.stopped.detail.contains("another state"));
    let balance = balance(&problem, &cycle).unwrap();
    assert_eq!(balance.loop_area, None);
    // what the plates do not get back is in the shell or dissipated
    let change = cycle.points[cycle.points.len() - 1].energy - cycle.points[0].energy;
    let work = balance.approach + balance.retract;
    close(work, change + cycle.dissipated().unwrap(), 1e-7 * change.abs());
}

#[test]
fn a_turn_before_the_fold_closes_without_a_jump() {
    let problem = fig16(100);
    let cycle = gripped(&problem, 1.3, 1.13);
    assert!(cycle.closed && cycle.jumps.is_empty());
}

#[test]
fn early_ends_keep_what_was_travelled() {
    let problem = fig16(100);
    let u = problem.initial_state();
    let mut few = settings(1.3, 0.8, 0.02);
    few.trace.max_points = 40;
    let cycle = super::go(&problem, &u, &few);
    assert_eq!(cycle.stopped.reason, StopReason::MaxPoints);
    assert!(cycle.stopped.detail.contains("40 points"), "{}", cycle.stopped.detail);
    assert!((38..=42).contains(&cycle.points.len()) && cycle.jumps.len() == 1);
    let mut heard = 0;
    let stopped = travel(&problem, &u, &settings(1.3, 0.8, 0.02), &mut |_| {
        heard += 1;
        if heard < 7 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    let stopped = stopped.unwrap();
    assert_eq!((stopped.stopped.reason, stopped.points.len()), (StopReason::Interrupted, 7));
    let mut coarse = settings(1.3, 0.8, 0.2);
    coarse.trace.min_step = Some(0.19);
    let refused = super::go(&problem, &u, &coarse);
    assert_eq!(refused.stopped.reason, StopReason::StepTooSmall);
}

#[test]
fn an_unstable_start_is_refused() {
    let problem = fig16(100);
    let branch = grip_branch(&problem, 1.3, 1.0);
    let unstable = branch.points.iter().find(|point| point.unstable == Some(1)).unwrap();
    let outcome = travel(&problem, &unstable.u, &settings(unstable.p, 1.0, 0.02), &mut |_| {
        ControlFlow::Continue(())
    });
    assert_eq!(outcome.unwrap_err(), CycleError::Unstable { modes: 1 });
}
