//! Folds and stability of devices, seen from the branch of the grip.

use super::{close, ends, fig12, fig16, grip_branch, held};
use continuation::{EventKind, Matrix, Problem, Settings, StopReason};
use shell_contact::device::StartError;
use shell_contact::device::{balance, loaded_start, trace_loaded, under};
use shell_contact::{Device, LoadedProblem};
use std::ops::ControlFlow;

const CANTILEVERS: [Device; 2] =
    [Device::Cantilever { stiffness: 20.0 }, Device::Cantilever { stiffness: 200.0 }];

/// The bordered Hessian is singular where the stiffness is the slope of the force: fig16 at
/// `z0 = 1.2` has `dF/dz0 = 1.54848`.
#[test]
fn a_cantilever_as_stiff_as_the_slope_of_the_force_is_on_the_border_of_stability() {
    let problem = fig16(400);
    let branch = grip_branch(&problem, 1.3, 1.2);
    let last = branch.points.last().unwrap();
    let negatives = [1.54848 - 1e-5, 1.54848 + 1e-5].map(|stiffness| {
        let loaded = LoadedProblem::new(&problem, Device::Cantilever { stiffness }).unwrap();
        let mut hessian = loaded.new_jacobian();
        let x = loaded.state(&last.u, last.p);
        loaded.jacobian(&x, &loaded.parameters_at(1.0), &mut hessian).unwrap();
        hessian.factor(f64::EPSILON * hessian.norm()).inertia.unwrap().0
    });
    assert_eq!(negatives, [1, 0]);
}

/// The folds found on the grip's branch are where the path of a device jumps, and the counts of
/// unstable modes change there.
#[test]
fn devices_jump_where_the_branch_of_the_grip_says() {
    let cases = [(fig16(200), 1.35, 0.6), (fig12(200), 1.3, 0.66)];
    for (problem, start, end) in cases {
        let branch = grip_branch(&problem, 1.3, 0.5);
        for device in CANTILEVERS.into_iter().chain([Device::DeadLoad]) {
            let folds = under::folds(&problem, &branch, device).unwrap();
            let counts = under::unstable_modes(&problem, &branch, device).unwrap();
            for fold in &folds {
                let around = [fold.unstable_before, fold.unstable_after];
                assert!(around == [Some(0), Some(1)] || around == [Some(1), Some(0)], "{fold:?}");
                assert!(fold.error_estimate < 1e-9);
            }
            let changes = counts.windows(2).filter(|w| w[0] != w[1]).count();
            assert_eq!(changes, folds.len(), "{device:?}");
            let (start, end) = if device == Device::DeadLoad { (0.0, 4.0) } else { (start, end) };
            let cycle = held(&problem, device, start, end);
            assert_eq!(cycle.stopped.reason, StopReason::ClosedLoop, "{:?}", cycle.stopped);
            for jump in &cycle.jumps {
                let (before, after) = ends(&cycle, jump);
                let fold = folds
                    .iter()
                    .min_by(|a, b| (a.z0 - before.z0).abs().total_cmp(&(b.z0 - before.z0).abs()));
                let fold = fold.unwrap();
                println!(
                    "{device:?} {:.10}: off by {:.1e} {:.1e}, dissipated {:?}",
                    jump.parameter,
                    fold.parameter - jump.parameter,
                    fold.z0 - before.z0,
                    jump.dissipated
                );
                close(fold.parameter, jump.parameter, 1e-10);
                close(fold.z0, before.z0, 1e-8);
                // along the device's line
                let own = device.parameter(after.z0, after.force);
                close(own, jump.parameter, 1e-9);
                assert!(jump.dissipated.unwrap() > 0.0);
                close(jump.dissipated.unwrap(), before.potential - after.potential, 1e-15);
            }
            let (total, balance) =
                (cycle.dissipated().unwrap(), balance(&problem, &cycle).unwrap());
            let area = balance.loop_area.unwrap();
            println!("  {} jumps, area off by {:.1e}", cycle.jumps.len(), area / total - 1.0);
            close(area, total, 1e-6 * total + 1e-9 * balance.approach.abs());
        }
    }
}

/// Under the grip the folds are those of the trace.
#[test]
fn folds_under_the_grip_are_those_of_the_trace() {
    let problem = fig12(200);
    let branch = grip_branch(&problem, 1.15, 0.65);
    let traced: Vec<_> = branch.events_of(&EventKind::Fold).collect();
    let folds = under::folds(&problem, &branch, Device::Grip).unwrap();
    assert_eq!(folds.len(), traced.len());
    for (fold, event) in folds.iter().zip(traced) {
        close(fold.z0, event.p, 1e-11);
        close(fold.force, branch.points[event.point].observables[0], 1e-7);
        assert_eq!(fold.unstable_before, event.unstable_before);
        assert_eq!(fold.unstable_after, event.unstable_after);
    }
}

/// At the fold of a soft spring behind the sharp maximum of the force the branch turns within 1e-7.
#[test]
fn a_branch_passes_the_needle_of_a_soft_spring() {
    let problem = fig12(100);
    for (stiffness, start, end, folds) in [(20.0, 1.15, 0.65, 4), (1.0, 3.0, -3.0, 6)] {
        let loaded = LoadedProblem::new(&problem, Device::Cantilever { stiffness }).unwrap();
        let settings = Settings { target: Some(end), ..Settings::default() };
        let traced = trace_loaded(&loaded, start, settings, &mut |_| ControlFlow::Continue(()));
        let branch = traced.unwrap().branch;
        assert_eq!(branch.stopped.reason, StopReason::Target, "{:?}", branch.stopped);
        assert_eq!(branch.events_of(&EventKind::Fold).count(), folds);
    }
}

#[test]
fn a_load_that_no_stable_state_holds_has_no_start() {
    let problem = fig16(100);
    let loaded = LoadedProblem::new(&problem, Device::DeadLoad).unwrap();
    match loaded_start(&loaded, -3.0) {
        Err(StartError::NoState { name: "force", value, low, high }) => {
            assert_eq!(value, -3.0);
            assert!((-1.46..-1.4).contains(&low) && high > 10.0, "{low} {high}");
        }
        other => panic!("{other:?}"),
    }
}
