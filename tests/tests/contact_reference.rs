//! The contact problem against an independent solver of the same model (spherical unknowns on
//! uniform cubic B-splines, Hessian by automatic differentiation; 400 and 800 elements).
//!
//! Agreement asked for: 1e-6 relative, or ten times the difference between the reference's two
//! meshes where that is larger; 1e-9 absolute near zero.

use continuation::{Event, EventKind, Settings, StopReason, Tracer, Watch};
use serde::Deserialize;
use shell_contact::trace::PULL_OFF;
use shell_contact::{
    ContactBranch, ContactProblem, Dimensionless, Law, Mesh, Shell, trace_contact,
};
use std::collections::BTreeMap;
use std::ops::ControlFlow;

#[derive(Deserialize)]
struct Case {
    params: Params,
    z_start: f64,
    z_end: f64,
    #[serde(rename = "N400")]
    coarse: Reference,
    #[serde(rename = "N800")]
    fine: Reference,
}

#[derive(Deserialize)]
struct Params {
    law: String,
    nu: f64,
    b: f64,
    kb: f64,
    #[serde(rename = "PA")]
    pressure: f64,
    #[serde(rename = "W")]
    adhesion: f64,
    #[serde(rename = "dA")]
    film: f64,
    g: f64,
    gbw: f64,
}

#[derive(Deserialize)]
struct Reference {
    zero_force: Vec<f64>,
    folds: Vec<[f64; 3]>,
    pull_off: [f64; 2],
    points: Vec<Point>,
}

#[derive(Deserialize)]
struct Point {
    z0: f64,
    #[serde(rename = "F")]
    force: f64,
    #[serde(rename = "PG")]
    gas_pressure: f64,
    #[serde(rename = "V")]
    volume: f64,
    pole: f64,
    stretch: f64,
    bend: f64,
    interaction: f64,
    gas: f64,
    neg: usize,
}

fn cases() -> BTreeMap<String, Case> {
    serde_json::from_str(include_str!("data/contact.json")).unwrap()
}

fn problem(params: &Params, elements: usize) -> ContactProblem {
    let law = match params.law.as_str() {
        "hooke" => Law::Hooke,
        "mr" => Law::MooneyRivlin { b: params.b },
        other => panic!("{other}"),
    };
    let groups = Dimensionless {
        bending: params.kb,
        pressure: params.pressure,
        adhesion: params.adhesion,
        film: params.film,
        surface_tension: params.gbw,
        gas_exponent: params.g,
    };
    let shell = Shell { law, poisson: params.nu };
    ContactProblem::new(&shell, &groups, Mesh::uniform(elements).unwrap()).unwrap()
}

fn trace(case: &Case, elements: usize, max_step: Option<f64>) -> ContactBranch {
    let settings = Settings { target: Some(case.z_end), max_step, ..Settings::default() };
    traced(case, elements, settings)
}

fn traced(case: &Case, elements: usize, settings: Settings) -> ContactBranch {
    let problem = problem(&case.params, elements);
    trace_contact(&problem, case.z_start, settings, &mut |_| ControlFlow::Continue(())).unwrap()
}

/// Force where the branch first passes a plate distance, 400 elements.
fn force_at(case: &Case, z0: f64) -> f64 {
    let settings = Settings { target: Some(z0), ..Settings::default() };
    let problem = problem(&case.params, 400);
    let start = case.z_start;
    let traced = trace_contact(&problem, start, settings, &mut |_| ControlFlow::Continue(()));
    traced.unwrap().branch.points.last().unwrap().observables[0]
}

/// Deviation from the finer reference, in units of what is allowed.
fn deviation(ours: f64, coarse: f64, fine: f64) -> f64 {
    let allowed = (1e-6 * fine.abs()).max(10.0 * (coarse - fine).abs()).max(1e-9);
    (ours - fine).abs() / allowed
}

fn folds(traced: &ContactBranch) -> Vec<&Event> {
    traced.branch.events_of(&EventKind::Fold).collect()
}

fn value(traced: &ContactBranch, event: &Event, name: &str) -> f64 {
    let k = traced.branch.observables.iter().position(|o| o == name).unwrap();
    traced.branch.points[event.point].observables[k]
}

#[test]
fn special_points_of_all_eight_cases() {
    for (name, case) in cases() {
        let traced = trace(&case, 400, None);
        assert_eq!(traced.branch.stopped.reason, StopReason::Target, "{name}");
        let check = |what: &str, ours: f64, coarse: f64, fine: f64| {
            let by = deviation(ours, coarse, fine);
            assert!(by < 1.0, "{name} {what}: {ours} but {fine} ({by:.2} of what is allowed)");
        };
        let kind = EventKind::Zero("force".to_owned());
        let zeros: Vec<_> = traced.branch.events_of(&kind).collect();
        assert_eq!(zeros.len(), case.fine.zero_force.len(), "{name}");
        for (k, zero) in zeros.iter().enumerate() {
            check("zero force", zero.p, case.coarse.zero_force[k], case.fine.zero_force[k]);
        }
        let ours = folds(&traced);
        assert_eq!(ours.len(), case.fine.folds.len(), "{name}");
        for (k, fold) in ours.iter().enumerate() {
            let (coarse, fine) = (case.coarse.folds[k], case.fine.folds[k]);
            check("fold", fold.p, coarse[0], fine[0]);
            check("force at fold", value(&traced, fold, "force"), coarse[1], fine[1]);
            check("energy at fold", value(&traced, fold, "energy_total"), coarse[2], fine[2]);
            assert!(fold.error_estimate < 1e-10, "{name}: {:e}", fold.error_estimate);
        }
        let kind = EventKind::Named(PULL_OFF.to_owned());
        let pull_off: Vec<_> = traced.branch.events_of(&kind).collect();
        assert_eq!(pull_off.len(), 1, "{name}");
        let [z0, force] = case.fine.pull_off;
        let ours = value(&traced, pull_off[0], "force");
        // the reference's position is good to the width of its search; its force belongs to that
        // position, and the extremum lies beyond it
        let there = force_at(&case, z0);
        let close = (1e-6 * force.abs()).max(1e-9);
        assert!((there - force).abs() < close, "{name}: {there} at {z0}, reference {force}");
        assert!(
            ours <= there + 1e-10 * force.abs(),
            "{name}: {ours} at {}, {there} at {z0}",
            pull_off[0].p
        );
        assert!((pull_off[0].p - z0).abs() < 1e-4, "{name}");
        assert!(pull_off[0].error_estimate < 1e-9, "{name}");
    }
}

#[test]
fn every_point_of_all_eight_cases() {
    for (name, case) in cases() {
        let problem = problem(&case.params, 400);
        let (u, p) = (problem.initial_state(), problem.parameters_at(case.z_start));
        let settings = Settings { target: Some(case.z_end), ..Settings::default() };
        let watches: Vec<Watch> = case.fine.points.iter().map(|x| Watch::parameter(x.z0)).collect();
        let branch = Tracer::new(&problem, "z0", &u, &p, settings)
            .and_then(|t| t.watching(&watches))
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(()));
        let mut compared = 0;
        for (fine, coarse) in case.fine.points.iter().zip(&case.coarse.points) {
            // the reference lists the last stretch of the branch: the last passage counts
            let landing = |e: &&Event| e.kind == EventKind::Target && e.p == fine.z0;
            let event = branch.events.iter().rfind(landing).unwrap();
            if fine.z0 != coarse.z0 {
                continue;
            }
            let point = &branch.points[event.point];
            assert_eq!(point.unstable, Some(fine.neg), "{name}");
            for (what, f, c) in [
                ("force", fine.force, coarse.force),
                ("gas_pressure", fine.gas_pressure, coarse.gas_pressure),
                ("volume", fine.volume, coarse.volume),
                ("pole_height", fine.pole, coarse.pole),
                ("energy_stretching", fine.stretch, coarse.stretch),
                ("energy_bending", fine.bend, coarse.bend),
                ("energy_film", fine.interaction, coarse.interaction),
                ("energy_gas", fine.gas, coarse.gas),
            ] {
                let k = branch.observables.iter().position(|o| o == what).unwrap();
                let ours = point.observables[k];
                let by = deviation(ours, c, f);
                assert!(by < 1.0, "{name} {what} at {}: {ours} but {f} ({by:.2})", fine.z0);
                compared += 1;
            }
        }
        assert!(compared >= 40, "{name}: {compared} numbers compared");
    }
}

#[test]
fn reversal_at_a_sharp_fold() {
    let case = &cases()["fig12"];
    for elements in [100, 200, 400, 800] {
        for max_step in [1e-3, 3e-3, 1e-2, 3e-2, 1e-1] {
            let traced = trace(case, elements, Some(max_step));
            let what = format!("{elements} elements, max_step {max_step}");
            assert_eq!(traced.branch.stopped.reason, StopReason::Target, "{what}");
            let folds = folds(&traced);
            assert_eq!(folds.len(), 2, "{what}");
            let mut counts: Vec<_> =
                traced.branch.points.iter().map(|p| p.unstable.unwrap()).collect();
            counts.dedup();
            assert_eq!(counts, [0, 1, 0], "{what}");
            if elements == 400 {
                for (fold, z0) in folds.iter().zip([0.818_761_965_215_833, 0.873_240_647_380_716]) {
                    assert!((fold.p - z0).abs() < 1e-7, "{what}: {}", fold.p);
                }
            }
            let others = traced.branch.events.iter().filter(|e| e.kind == EventKind::BranchPoint);
            assert_eq!(others.count(), 0, "{what}");
            println!(
                "{what}: {} points {:?}",
                traced.branch.points.len(),
                traced.branch.statistics
            );
        }
    }
}

/// From a hundredth to a hundred times the step of the command line.
#[test]
fn same_special_points_at_every_step_length() {
    let case = &cases()["fig12"];
    let all = |max_step: f64| {
        let settings = Settings {
            target: Some(case.z_end),
            max_step: Some(max_step),
            max_points: 100_000,
            ..Settings::default()
        };
        let traced = traced(case, 200, settings);
        assert_eq!(traced.branch.stopped.reason, StopReason::Target, "max_step {max_step}");
        let events = traced.branch.events.iter().map(|e| (e.kind.to_string(), e.p));
        events.collect::<Vec<_>>()
    };
    let known = all(1e-2);
    assert_eq!(known.iter().filter(|(kind, _)| kind == "fold").count(), 2);
    for max_step in [1e-4, 1e-3, 1e-1, 1.0] {
        let found = all(max_step);
        assert_eq!(found.len(), known.len(), "max_step {max_step}: {found:?}");
        for ((kind, z0), (known_kind, known_z0)) in found.iter().zip(&known) {
            assert_eq!(kind, known_kind, "max_step {max_step}");
            // extrema of the force are flat: its values agree to rounding, their places less
            assert!((z0 - known_z0).abs() < 1e-8, "max_step {max_step}: {kind} {z0} {known_z0}");
        }
    }
}

#[test]
fn special_points_converge_with_order_four() {
    let case = &cases()["fig12"];
    let at = |elements: usize| {
        let traced = trace(case, elements, None);
        let folds = folds(&traced);
        [folds[0].p, folds[1].p, value(&traced, folds[0], "force")]
    };
    let (a, b, c) = (at(100), at(200), at(400));
    for k in 0..3 {
        let order = ((a[k] - b[k]) / (b[k] - c[k])).abs().log2();
        println!("order {order}");
        assert!((3.3..5.5).contains(&order), "order {order} of quantity {k}");
    }
}

#[test]
fn every_parameter_can_be_continued() {
    let case = &cases()["fig07"];
    let problem = problem(&case.params, 100);
    let settings = Settings { target: Some(0.9), ..Settings::default() };
    let start = trace_contact(&problem, case.z_start, settings, &mut |_| ControlFlow::Continue(()));
    let branch = start.unwrap().branch;
    let (u, p) = (&branch.points.last().unwrap().u, problem.parameters_at(0.9));
    for (parameter, k, factor) in [
        ("adhesion", 1, 0.1),
        ("bending", 2, 0.2),
        ("pressure", 3, 2.0),
        ("film", 4, 0.5),
        ("surface_tension", 5, 1.0),
    ] {
        let target = if k == 5 { 0.08 } else { factor * p[k] };
        let settings = Settings { target: Some(target), ..Settings::default() };
        let there = Tracer::new(&problem, parameter, u, &p, settings)
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(()));
        assert_eq!(there.stopped.reason, StopReason::Target, "{parameter}: {:?}", there.stopped);
        assert!(there.points.len() < 80, "{parameter}: {} points", there.points.len());
        // and back: the same state
        let mut q = p.clone();
        q[k] = target;
        let settings = Settings { target: Some(p[k]), ..Settings::default() };
        let far = &there.points.last().unwrap().u;
        let back = Tracer::new(&problem, parameter, far, &q, settings)
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(()));
        let last = &back.points.last().unwrap().u;
        let off = last.iter().zip(u).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(off < 1e-9, "{parameter}: {off:e}");
    }
}
