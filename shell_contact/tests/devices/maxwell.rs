//! Maxwell points.

use super::{close, fig12, fig16, grip_branch};
use continuation::{NewtonSettings, Settings, newton};
use shell_contact::device::{Loading, maxwell_points, trace_loaded};
use shell_contact::{Device, LoadedProblem};
use std::ops::ControlFlow;

/// Both states are equilibria of equal energy, between the folds; coarser steps find the same.
#[test]
fn energies_are_equal_at_a_maxwell_point() {
    for (problem, start, end, between) in [
        (fig16(200), 1.3, 1.0, (1.128_512, 1.149_606)),
        (fig12(200), 1.15, 0.7, (0.818_762, 0.873_241)),
    ] {
        let branch = grip_branch(&problem, start, end);
        let points = maxwell_points(&problem, &branch);
        let [point] = &points[..] else { panic!("{points:?}") };
        assert!(point.is_stable() && point.error_estimate < 1e-10);
        assert!(between.0 < point.parameter && point.parameter < between.1);
        let p = problem.parameters_at(point.parameter);
        let energies = [0, 1].map(|k| {
            let mut u = point.states[k].clone();
            newton(&problem, &mut u, &p, &NewtonSettings::default()).unwrap();
            let seen = problem.observation(&u, &p).unwrap();
            close(seen.force, point.force[k], 1e-9);
            seen.energy_total
        });
        close(energies[0], energies[1], 1e-13);
        assert!((point.force[0] - point.force[1]).abs() > 0.1);
        let coarse = Settings { target: Some(end), max_step: Some(0.1), ..Settings::default() };
        let coarse = shell_contact::trace_contact(&problem, start, coarse, &mut |_| {
            ControlFlow::Continue(())
        });
        let again = maxwell_points(&problem, &coarse.unwrap().branch);
        assert_eq!(again.len(), 1);
        close(again[0].parameter, point.parameter, 1e-10);
        println!("{:.12} {:?}", point.parameter, point.force);
    }
}

/// Under other devices the potentials with that of the device are equal, at one value of its parameter.
#[test]
fn other_devices_have_theirs() {
    let problem = fig16(200);
    for (device, start, end) in [
        (Device::Cantilever { stiffness: 20.0 }, 1.35, 0.9),
        (Device::Cantilever { stiffness: 200.0 }, 1.3, 1.0),
    ] {
        let loaded = LoadedProblem::new(&problem, device).unwrap();
        let settings = Settings { target: Some(end), max_step: Some(0.02), ..Settings::default() };
        let branch = trace_loaded(&loaded, start, settings, &mut |_| ControlFlow::Continue(()));
        let points = maxwell_points(&loaded, &branch.unwrap().branch);
        let [point] = &points[..] else { panic!("{points:?}") };
        let p = loaded.parameters_at(point.parameter);
        let potentials = [0, 1].map(|k| {
            close(device.parameter(point.z0[k], point.force[k]), point.parameter, 1e-10);
            loaded.potential(&point.states[k], &p).unwrap()
        });
        close(potentials[0], potentials[1], 1e-13);
        assert!((point.z0[0] - point.z0[1]).abs() > 1e-4 && point.is_stable());
        println!("{device:?} {:.12} {:?}", point.parameter, point.z0);
    }
}
