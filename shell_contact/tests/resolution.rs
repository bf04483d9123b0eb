//! A mesh that is called fine enough has the special points and forces of one four times as fine.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use continuation::{EventKind, Settings, Tracer};
use shell_contact::resolution::Resolution;
use shell_contact::two_plates::{Plate, TwoPlatesGroups, TwoPlatesProblem};
use shell_contact::{
    ContactProblem, Dimensionless, Law, Mesh, RingGroups, RingLoadProblem, Shell, trace_contact,
};
use std::ops::ControlFlow;

struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Folds of a traced branch, force at its end, the least resolution, and why it ended; `None` where the
/// film pulls the shell onto the plate at the start.
fn traced(
    shell: &Shell,
    groups: &Dimensionless,
    mesh: Mesh,
) -> Option<(usize, f64, Resolution, String)> {
    let problem = ContactProblem::new(shell, groups, mesh).unwrap();
    let settings = Settings {
        target: Some(0.75),
        max_step: Some(0.01),
        domain: Some((f64::NEG_INFINITY, 3.0)),
        max_points: 3000,
        ..Settings::default()
    };
    let start = 1.1 + 6.0 * groups.film;
    let traced =
        trace_contact(&problem, start, settings, &mut |_| ControlFlow::Continue(())).ok()?;
    let branch = traced.branch;
    let all = branch
        .points
        .iter()
        .map(|point| problem.resolution(&point.u, &problem.parameters_at(point.p)).unwrap());
    let least = all.reduce(Resolution::least).unwrap();
    let force = branch.observables.iter().position(|name| name == "force").unwrap();
    let end = branch.points.last().unwrap().observables[force];
    let folds = branch.events_of(&EventKind::Fold).count();
    Some((folds, end, least, format!("{:?}", branch.stopped.reason)))
}

#[test]
fn what_is_called_resolved_is() {
    let mut random = Random(1);
    let (mut enough, mut coarse, mut alarms) = (0, 0, 0);
    for case in 0..48 {
        let groups = Dimensionless {
            bending: 10f64.powf(random.between(-6.5, -2.0)),
            pressure: [0.0, 0.05, 0.2][case % 3],
            adhesion: 10f64.powf(random.between(-4.5, -1.0)),
            film: 10f64.powf(random.between(-2.6, -1.0)),
            surface_tension: [0.0, 0.0, 0.1, 1.0][case % 4],
            gas_exponent: 1.07,
        };
        let law =
            [Law::Hooke, Law::MooneyRivlin { b: random.between(0.0, 1.0) }, Law::Skalak][case % 3];
        let poisson = match law {
            Law::Hooke => random.between(-0.3, 0.5),
            Law::Skalak => random.between(0.0, 0.8),
            _ => 0.5,
        };
        let shell = Shell { law, poisson };
        let mesh = |elements| match case % 5 {
            0 => Mesh::graded(elements, 3.0).unwrap(),
            _ => Mesh::uniform(elements).unwrap(),
        };
        let Some((folds, end, least, stop)) = traced(&shell, &groups, mesh(90)) else { continue };
        let Some((known, right, _, whole)) = traced(&shell, &groups, mesh(360)) else { continue };
        let same =
            folds == known && stop == whole && (end - right).abs() < 0.02 * right.abs().max(1.0);
        if least.is_enough() {
            enough += 1;
            assert!(
                same,
                "{case}: {groups:?}: {least:?}, {folds} folds of {known}, {end} for {right}"
            );
        } else {
            coarse += 1;
            alarms += usize::from(same);
        }
    }
    println!("{enough} fine enough, {coarse} not, of which {alarms} would have been");
    assert!(enough > 15 && coarse > 10 && alarms < coarse);
}

#[test]
fn halves_between_two_plates_are_resolved_as_one_half_is() {
    let groups = Dimensionless {
        bending: 3e-5,
        pressure: 3e-3,
        adhesion: 2e-3,
        film: 1.0 / 30.0,
        surface_tension: 0.0,
        gas_exponent: 1.07,
    };
    let shell = Shell { law: Law::Hooke, poisson: 0.5 };
    let half = ContactProblem::new(&shell, &groups, Mesh::uniform(60).unwrap()).unwrap();
    let equal = TwoPlatesGroups::equal(&groups);
    let whole = TwoPlatesProblem::new(&shell, &equal, Mesh::uniform(60).unwrap()).unwrap();
    // the free sphere near its plates
    for z0 in [1.02, 1.05, 1.2] {
        let one = half.resolution(&half.initial_state(), &half.parameters_at(z0)).unwrap();
        let both = whole.resolution(&whole.initial_state(), &whole.parameters_at(z0)).unwrap();
        assert!((one.per_film_length / both.per_film_length - 1.0).abs() < 1e-12);
        assert!((one.per_wavelength / both.per_wavelength - 1.0).abs() < 1e-12);
    }
    // pressed ten times as far into the film of one plate
    let top = Plate { film: 10.0 * groups.film, ..equal.top };
    let other = TwoPlatesGroups { top, ..equal };
    let uneven = TwoPlatesProblem::new(&shell, &other, Mesh::uniform(60).unwrap()).unwrap();
    let state = uneven.initial_state();
    let worse = uneven.resolution(&state, &uneven.parameters_at(1.03)).unwrap();
    let even = whole.resolution(&state, &whole.parameters_at(1.03)).unwrap();
    assert!(worse.per_film_length < 0.9 * even.per_film_length, "{worse:?} {even:?}");
}

/// Force and stability of a thin shell under a ring load at 4.5 to 8 degrees.
fn ring(bending: f64, elements: usize) -> (Vec<String>, f64, Resolution) {
    let shell = Shell { law: Law::Hooke, poisson: 0.3 };
    let groups = RingGroups { bending, pressure: 0.0, gas_exponent: 0.0 };
    let problem = RingLoadProblem::new(&shell, &groups, elements, 8.0).unwrap();
    let p = problem.parameters_at(4.5_f64.to_radians());
    let settings = Settings {
        target: Some(8.0_f64.to_radians()),
        max_step: Some(5e-3),
        max_points: 3000,
        ..Settings::default()
    };
    let branch = Tracer::new(&problem, "alpha", &problem.initial_state(), &p, settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    let all = branch
        .points
        .iter()
        .map(|point| problem.resolution(&point.u, &problem.parameters_at(point.p)).unwrap());
    let least = all.reduce(Resolution::least).unwrap();
    let force = branch.observables.iter().position(|name| name == "force").unwrap();
    let kinds = branch.events.iter().map(|event| event.kind.to_string()).collect();
    (kinds, branch.points.last().unwrap().observables[force], least)
}

#[test]
fn what_is_called_resolved_under_a_ring_is() {
    let (mut enough, mut coarse) = (0, 0);
    for bending in [9.157_509_157_509_157e-6, 1e-7, 1e-9] {
        let (known, right, _) = ring(bending, 600);
        for elements in [40, 60, 100, 160, 300] {
            let (kinds, force, least) = ring(bending, elements);
            if least.is_enough() {
                enough += 1;
                assert_eq!(kinds, known, "{bending} {elements}");
                assert!(
                    (force - right).abs() < 1e-3 * right.abs(),
                    "{bending} {elements}: {force}"
                );
            } else {
                coarse += 1;
            }
        }
    }
    println!("{enough} fine enough, {coarse} not");
    assert!(enough >= 5 && coarse >= 3, "{enough} {coarse}");
    assert!(!ring(1e-9, 40).2.is_enough(), "it has an extremum of its own");
}
