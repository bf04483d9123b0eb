//! Stiff and soft cantilevers, plates that fly away, and Derjaguin's limit.

use super::{close, ends, fig16, gripped, held};
use crate::support::contact;
use continuation::StopReason;
use shell_contact::device::{Direction, balance};
use shell_contact::{Device, Law};

/// A stiff cantilever is a grip: the differences fall like `1/k_c`.
#[test]
fn a_stiff_cantilever_is_a_grip() {
    let problem = fig16(100);
    let grip = gripped(&problem, 1.3, 1.0);
    let off = [1e4, 1e5].map(|stiffness| {
        let cycle = held(&problem, Device::Cantilever { stiffness }, 1.3, 1.0);
        assert_eq!(cycle.jumps.len(), 2);
        [0, 1].map(|k| {
            let ((a, _), (b, _)) = (ends(&grip, &grip.jumps[k]), ends(&cycle, &cycle.jumps[k]));
            let after = ends(&grip, &grip.jumps[k]).1.force - ends(&cycle, &cycle.jumps[k]).1.force;
            let energy = grip.jumps[k].dissipated.unwrap() - cycle.jumps[k].dissipated.unwrap();
            [a.z0 - b.z0, after, energy]
        })
    });
    println!("{off:?}");
    for k in 0..2 {
        let [z0, force, energy] = off[1][k];
        assert!(z0.abs() < 1e-8 && force.abs() < 1e-3 && energy.abs() < 1e-6, "{off:?}");
        for q in 1..3 {
            close(off[1][k][q] / off[0][k][q], 0.1, 0.02);
        }
    }
}

/// A soft cantilever is a dead load: with a base far away the force at its folds is that at the
/// folds of the load.
#[test]
fn a_soft_cantilever_is_a_dead_load() {
    let problem = super::fig12(200);
    let dead = held(&problem, Device::DeadLoad, 0.0, 4.0);
    let snap = |cycle: &shell_contact::device::Cycle| {
        let jump = &cycle.jumps[0];
        let (a, b) = ends(cycle, jump);
        [a.z0, a.force, b.z0, b.force]
    };
    let exact = snap(&dead);
    let stiffness = 0.01;
    // from no force to that of four, and back
    let soft = held(&problem, Device::Cantilever { stiffness }, -50.0, -400.0);
    assert_eq!(soft.stopped.reason, StopReason::ClosedLoop, "{:?}", soft.stopped);
    let near = snap(&soft);
    println!("{exact:?} {near:?}");
    assert_eq!(soft.jumps.len(), dead.jumps.len());
    for (a, b) in exact.into_iter().zip(near) {
        close(a, b, 0.03);
    }
    close(exact[1], near[1], 1e-5);
}

/// From compression to a tension that nothing holds, and back: the plate flies away at the pull-off and
/// comes back when it is no longer pulled.
#[test]
fn a_plate_flies_away_and_comes_back() {
    let problem = fig16(100);
    let cycle = held(&problem, Device::DeadLoad, 2.0, -3.0);
    assert_eq!(cycle.stopped.reason, StopReason::Target, "{:?}", cycle.stopped);
    assert!(cycle.stopped.detail.contains("came back") && !cycle.closed);
    let [away, back] = &cycle.jumps[..] else { panic!("{:?}", cycle.jumps) };
    assert_eq!((away.direction, back.direction), (Direction::Retract, Direction::Approach));
    assert_eq!((away.after, away.dissipated), (None, None));
    let before = &cycle.points[away.before.unwrap()];
    close(before.force, cycle.pull_off().unwrap().force, 1e-12);
    close(before.z0, 1.062_942_7, 1e-4);
    assert_eq!((back.before, back.parameter, back.dissipated), (None, 0.0, None));
    close(cycle.points[back.after.unwrap()].force, 0.0, 1e-10);
    assert_eq!(cycle.dissipated(), None);
    assert_eq!(balance(&problem, &cycle).unwrap().loop_area, None);
    let last = cycle.points.last().unwrap();
    close(last.force, 2.0, 1e-9);
    close(last.z0, cycle.points[0].z0, 1e-9);
}

/// Pull-off of a stiff shell and weak adhesion, in a cycle: `−2πR0w0`, in proportion to the adhesion.
#[test]
fn pull_off_on_the_way_out_is_derjaguins() {
    let (bending, film) = (3e-5_f64, 0.01);
    let ratio = [4e-7, 2e-7].map(|adhesion| {
        let problem = contact(200, Law::Hooke, [bending, 3e-3, adhesion, film, 0.0, 1.07]);
        let cycle = gripped(&problem, 1.1, 0.99);
        let pull_off = cycle.pull_off().unwrap();
        pull_off.force * bending.sqrt() / (2.0 * std::f64::consts::PI * adhesion)
    });
    println!("{ratio:?}");
    assert!(ratio.iter().all(|r| (r + 1.0).abs() < 0.02), "{ratio:?}");
    assert!((ratio[1] + 1.0).abs() < (ratio[0] + 1.0).abs());
}
