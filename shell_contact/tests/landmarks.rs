//! The knee and the first contact against definitions of their own, and under other devices and steps.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use continuation::{Branch, Settings};
use shell_contact::device::{Device, trace_loaded};
use shell_contact::landmarks::{CONTACT, KNEE, Wanted, locate};
use shell_contact::{
    ContactProblem, Dimensionless, Law, LoadedProblem, Mesh, Shell, trace_contact,
};
use std::ops::ControlFlow;

const ALL: Wanted = Wanted { knee: true, contact: true };

/// The hard shell of Fig. 12 with weak adhesion: no fold before its knee.
fn problem() -> ContactProblem {
    let groups = Dimensionless {
        bending: 3e-5,
        pressure: 3e-3,
        adhesion: 2e-6,
        film: 1.0 / 30.0,
        surface_tension: 0.0,
        gas_exponent: 1.07,
    };
    let shell = Shell { law: Law::Hooke, poisson: 0.5 };
    ContactProblem::new(&shell, &groups, Mesh::uniform(160).unwrap()).unwrap()
}

fn traced(problem: &ContactProblem, max_step: f64, target: f64) -> Branch {
    let settings =
        Settings { target: Some(target), max_step: Some(max_step), ..Settings::default() };
    let go_on = &mut |_: &continuation::Progress| ControlFlow::Continue(());
    let mut branch = trace_contact(problem, 1.1, settings, go_on).unwrap().branch;
    locate(problem, Device::Grip, &mut branch, ALL).unwrap();
    branch
}

fn of<'b>(branch: &'b Branch, name: &str) -> Vec<&'b continuation::Event> {
    branch.events.iter().filter(|event| event.kind.to_string() == name).collect()
}

#[test]
fn a_knee_is_where_the_slope_is_half_of_its_largest() {
    let problem = problem();
    let branch = traced(&problem, 0.01, 0.8);
    let [knee] = of(&branch, KNEE)[..] else { panic!("{:?}", branch.events) };
    assert!(knee.error_estimate < 1e-8 && knee.residual < 1e-8, "{knee:?}");
    // forces of traces that end at a height, without a tangent
    let force = |z0: f64| {
        let end = traced(&problem, 0.01, z0);
        end.points.last().unwrap().observables[0]
    };
    let slope = |z0: f64| (force(z0 - 1e-4) - force(z0 + 1e-4)) / 2e-4;
    let zero = of(&branch, "zero-force")[0].p;
    let steps = 24;
    let places = (0..=steps).map(|k| zero + (knee.p - zero) * f64::from(k) / f64::from(steps));
    let largest = places.map(slope).fold(0.0, f64::max);
    let half = slope(knee.p) / largest;
    assert!((half - 0.5).abs() < 5e-3, "{half} at {}", knee.p);
}

#[test]
fn landmarks_stand_still_with_steps_and_under_a_lever() {
    let problem = problem();
    let (fine, coarse) = (traced(&problem, 0.004, 0.8), traced(&problem, 0.03, 0.8));
    let device = Device::Cantilever { stiffness: 200.0 };
    let loaded = LoadedProblem::new(&problem, device).unwrap();
    let settings = Settings { target: Some(0.7), max_step: Some(0.01), ..Settings::default() };
    let go_on = &mut |_: &continuation::Progress| ControlFlow::Continue(());
    let mut lever = trace_loaded(&loaded, 1.1, settings, go_on).unwrap().branch;
    locate(&problem, device, &mut lever, ALL).unwrap();
    let height = lever.observables.iter().position(|name| name == "z0").unwrap();
    for name in [KNEE, CONTACT] {
        let places: Vec<f64> = [&fine, &coarse].iter().map(|b| of(b, name)[0].p).collect();
        assert!((places[0] - places[1]).abs() < 1e-8, "{name}: {places:?}");
        let [event] = of(&lever, name)[..] else { panic!("{name}: {:?}", lever.events) };
        let point = &lever.points[event.point];
        assert!((point.observables[height] - places[0]).abs() < 1e-8, "{name}");
        let base = point.observables[height] - point.observables[0] / 200.0;
        assert_eq!((event.p, point.p), (base, base));
    }
    for (k, event) in fine.events.iter().enumerate() {
        assert_eq!(fine.points[event.point].event, Some(k));
    }
    assert!(fine.points.windows(2).all(|w| w[0].s <= w[1].s));
}

#[test]
fn contact_radii_begin_at_the_contact() {
    let problem = problem();
    let branch = traced(&problem, 0.01, 0.8);
    let [contact] = of(&branch, CONTACT)[..] else { panic!("{:?}", branch.events) };
    let point = &branch.points[contact.point];
    let film = contact.p - point.observables[1];
    assert!((film - 1.0 / 30.0).abs() < 1e-11, "{film}");
    let radius = |k: usize| *branch.points[k].observables.last().unwrap();
    assert!(radius(contact.point - 1).is_nan() && radius(contact.point + 1) > 0.0);
}

#[test]
fn nothing_is_put_in_where_nothing_is_asked_for_and_no_knee_beyond_a_fold() {
    let problem = problem();
    let mut branch = traced(&problem, 0.01, 0.99);
    assert!(of(&branch, KNEE).is_empty(), "before the knee there is none");
    let before = branch.clone();
    locate(&problem, Device::Grip, &mut branch, Wanted::default()).unwrap();
    // no numbers that are none are equal: events and places are
    assert_eq!(branch.events, before.events);
    assert_eq!(branch.points.len(), before.points.len());
}
