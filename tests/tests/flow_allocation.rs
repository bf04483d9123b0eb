//! A dissipative motion allocates for its end, and nothing for its steps.

use continuation::{EventKind, Settings};
use shell_contact::device::{LoadedProblem, Motion, Relaxation, RelaxationSettings, loaded_start};
use shell_contact::{ContactProblem, Device, Dimensionless, Law, Mesh, Shell, trace_contact};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;
use std::ops::ControlFlow;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

fn fig16() -> ContactProblem {
    let groups = Dimensionless {
        bending: 2.7e-3,
        pressure: 3.0,
        adhesion: 2e-2,
        film: 1.0 / 30.0,
        surface_tension: 0.0,
        gas_exponent: 1.07,
    };
    let shell = Shell { law: Law::MooneyRivlin { b: 1.0 }, poisson: 0.5 };
    ContactProblem::new(&shell, &groups, Mesh::uniform(100).unwrap()).unwrap()
}

/// Steps of a motion, and what it allocates: the least of five times, as the test runner's own thread is
/// counted too and may allocate once at any moment.
fn counted(mut motion: impl FnMut() -> usize) -> (usize, usize) {
    let counts = [(); 5].map(|()| {
        let region = Region::new(ALLOCATOR);
        let steps = motion();
        (steps, region.change().allocations)
    });
    assert!(counts.iter().all(|(steps, _)| *steps == counts[0].0), "{counts:?}");
    counts.into_iter().min().unwrap()
}

// one test: others would be counted too
#[test]
fn steps_of_a_motion_do_not_allocate() {
    let problem = fig16();
    let settings = Settings { target: Some(1.1), ..Settings::default() };
    let branch = trace_contact(&problem, 1.3, settings, &mut |_| ControlFlow::Continue(()));
    let branch = branch.unwrap().branch;
    let fold = branch.events_of(&EventKind::Fold).next().unwrap();
    let (u, p) = (&branch.points[fold.point].u, problem.parameters_at(fold.p));
    let usual = RelaxationSettings::default();
    let closely = RelaxationSettings { accuracy: 0.005, ..usual };
    let counts = [usual, closely].map(|settings| {
        counted(|| {
            let mut relaxation = Relaxation::new(&problem, settings);
            assert_eq!(relaxation.from_fold(&problem, u, &p), Ok(Motion::Rest));
            relaxation.steps()
        })
    });
    println!("{counts:?}");
    assert!(counts[1].0 > 2 * counts[0].0 && counts[1].1 == counts[0].1, "{counts:?}");

    let loaded = LoadedProblem::new(&problem, Device::DeadLoad).unwrap();
    let (x, p) = (loaded_start(&loaded, 1.0).unwrap(), loaded.parameters_at(1.5));
    let counts = [usual, closely].map(|settings| {
        counted(|| {
            let mut relaxation = Relaxation::new(&loaded, settings);
            assert_eq!(relaxation.from_state(&loaded, &x, &p), Ok(Motion::Rest));
            relaxation.steps()
        })
    });
    println!("{counts:?}");
    assert!(counts[1].0 > counts[0].0 && counts[1].1 == counts[0].1, "{counts:?}");
}
