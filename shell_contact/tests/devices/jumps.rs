//! Dissipative motions.

use super::{close, ends, fig12, fig16, gripped};
use continuation::Problem;
use shell_contact::device::{
    Loading, Motion, MotionError, Relaxation, RelaxationSettings, free_start,
};
use shell_contact::{Device, LoadedProblem};

/// Where a motion leads does not depend on how closely it is followed.
#[test]
fn the_state_reached_does_not_depend_on_the_limits_of_steps() {
    for (problem, start, end) in [(fig16(200), 1.2, 1.1), (fig12(200), 0.9, 0.8)] {
        let cycle = gripped(&problem, 1.2_f64.max(start), end);
        assert_eq!(cycle.jumps.len(), 2);
        for jump in &cycle.jumps {
            let (before, after) = ends(&cycle, jump);
            let p = problem.parameters_at(jump.parameter);
            let usual = RelaxationSettings::default();
            for (settings, least) in [
                (RelaxationSettings { accuracy: 0.01, ..usual }, 1),
                (RelaxationSettings { accuracy: 0.9, ..usual }, 0),
                (RelaxationSettings { longest_move: 0.005, ..usual }, 0),
                (RelaxationSettings { longest_move: 0.0005, ..usual }, 1),
                (RelaxationSettings { longest_time: 10.0, ..usual }, 0),
                (RelaxationSettings { longest_time: 1.0, ..usual }, 0),
                (RelaxationSettings { longest_time: 0.1, ..usual }, 1),
            ] {
                let mut relaxation = Relaxation::new(&problem, settings);
                let motion = relaxation.from_fold(&problem, &before.u, &p);
                assert_eq!(motion, Ok(Motion::Rest), "{settings:?}");
                assert!(least == 0 || relaxation.steps() > jump.steps, "{settings:?}");
                let off = relaxation.state().iter().zip(&after.u);
                let off = off.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
                println!("{:.6}: {} steps, off by {off:.1e}", jump.parameter, relaxation.steps());
                assert!(off < 1e-9, "{settings:?}: {off:e}");
            }
        }
    }
}

/// The energy falls from step to step: a motion that is cut short is below its beginning.
#[test]
fn a_motion_that_is_cut_short_says_so_and_has_lost_energy() {
    let problem = fig16(100);
    let cycle = gripped(&problem, 1.2, 1.1);
    let (before, after) = ends(&cycle, &cycle.jumps[0]);
    let p = problem.parameters_at(before.z0);
    let mut last = before.energy;
    for max_steps in [10, 15, 20] {
        let settings = RelaxationSettings { max_steps, ..RelaxationSettings::default() };
        let mut relaxation = Relaxation::new(&problem, settings);
        let motion = relaxation.from_fold(&problem, &before.u, &p);
        assert_eq!(motion, Err(MotionError::TooMany { steps: max_steps }));
        let energy = problem.potential(relaxation.state(), &p).unwrap();
        assert!(energy < last && energy > after.energy, "{energy} {last}");
        last = energy;
    }
}

/// A stable state loses nothing.
#[test]
fn a_stable_state_has_no_way_down() {
    let problem = fig16(100);
    let u = free_start(&problem, 1.3).unwrap();
    let p = problem.parameters_at(1.3);
    let mut relaxation = Relaxation::new(&problem, RelaxationSettings::default());
    assert_eq!(relaxation.from_fold(&problem, &u, &p), Err(MotionError::NoWayDown));
    // from elsewhere in its basin the motion comes back to it
    let mut moved = u.clone();
    moved.iter_mut().enumerate().for_each(|(k, u)| *u *= 1.0 + 0.1 * (k as f64).sin());
    assert_eq!(relaxation.from_state(&problem, &moved, &p), Ok(Motion::Rest));
    let off = relaxation.state().iter().zip(&u).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
    assert!(off < 1e-10, "{off:e}");
}

/// Where Newton's method finds no state near the sphere at rest, or an unstable one, the sphere moves.
#[test]
fn the_free_shell_near_a_strong_film_is_the_one_it_moves_to() {
    let problem = fig16(100);
    let p = problem.parameters_at(1.1);
    let u = free_start(&problem, 1.1).unwrap();
    let force = problem.observation(&u, &p).unwrap().force;
    close(force, -1.42, 0.05);
}

/// A tensile load beyond the pull-off: the plate flies away.
#[test]
fn a_plate_under_too_large_a_load_flies_away() {
    let problem = fig16(100);
    let loaded = LoadedProblem::new(&problem, Device::DeadLoad).unwrap();
    let x = loaded.state(&problem.initial_state(), 1.1);
    let mut relaxation = Relaxation::new(&loaded, RelaxationSettings::default());
    let away = relaxation.from_state(&loaded, &x, &loaded.parameters_at(-2.0));
    assert_eq!(away, Ok(Motion::Away));
    assert_eq!(relaxation.state().len(), loaded.dim());
    let back = relaxation.from_state(&loaded, &x, &loaded.parameters_at(0.0));
    assert_eq!(back, Ok(Motion::Rest));
}
