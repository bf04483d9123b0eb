//! Meshes that are made for a tolerance keep it, and with fewer elements than equal ones.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod support;

use continuation::{Point, Settings};
use shell_contact::discretisation::{Demand, Place, Refined, ToleranceError};
use shell_contact::{
    ContactBranch, ContactProblem, Dimensionless, Law, Mesh, Shell, trace_contact,
};
use std::ops::ControlFlow;

/// Place of the force among the observables.
const FORCE: usize = 0;

fn trace(problem: &ContactProblem, end: f64) -> ContactBranch {
    let settings = Settings { target: Some(end), max_step: Some(0.02), ..Settings::default() };
    trace_contact(problem, 1.3, settings, &mut |_| ControlFlow::Continue(())).unwrap()
}

fn span(points: &[Point], value: impl Fn(&Point) -> f64) -> f64 {
    let all = || points.iter().map(&value);
    all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
}

/// The largest error that halving the elements shows: of the force at the same plate distance, or of the distance at the same
/// force times the ratio of their ranges; and that of folds and zeros in the distance.
fn error(problem: &ContactProblem, end: f64) -> f64 {
    let branch = trace(problem, end).branch;
    let ratio = span(&branch.points, |x| x.observables[FORCE]) / span(&branch.points, |x| x.p);
    let mut refined = Refined::new(problem).unwrap();
    let mut largest: f64 = 0.0;
    for (k, point) in branch.points.iter().enumerate() {
        let p = problem.parameters_at(point.p);
        let kind = point.event.map(|e| &branch.events[e].kind);
        if kind.is_none() && k % 5 != 0 && k + 1 != branch.points.len() {
            continue;
        }
        let Ok(Some(shift)) = refined.shift(&point.u, &p, kind) else { continue };
        let by_height =
            shift.z0.map_or(f64::INFINITY, |x| if kind.is_some() { x } else { x * ratio });
        let off = by_height.min(shift.force.unwrap_or(f64::INFINITY));
        if off.is_finite() {
            largest = largest.max(off);
        }
    }
    largest
}

fn demand(problem: &ContactProblem, end: f64) -> Demand {
    let branch = trace(problem, end).branch;
    let places = branch.points.iter();
    let places = places.map(|x| Place { u: &x.u, z0: x.p, force: x.observables[FORCE] });
    Demand::along(problem, places)
}

/// A number in `[0, 1)`, the next of a sequence.
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

/// So do all of 300 such shells. Equal elements, as many, are off by 1.9 times as much in the mean.
#[test]
fn tolerances_are_kept_for_random_shells() {
    let mut state = 20;
    let mut gain = 0.0;
    let count = 24;
    for k in 0..count {
        let mut between = |low: f64, high: f64| low * (high / low).powf(random(&mut state));
        let groups = Dimensionless {
            bending: between(3e-5, 3e-3),
            pressure: between(1e-3, 1e-1),
            adhesion: between(2e-4, 5e-3),
            film: between(0.02, 0.08),
            surface_tension: if k % 3 == 0 { between(1e-3, 0.1) } else { 0.0 },
            gas_exponent: between(1.0, 1.4),
        };
        let law = [Law::Hooke, Law::Skalak, Law::MooneyRivlin { b: 0.5 }][k % 3];
        let tolerance = between(1e-8, 1e-4);
        let shell = Shell { law, poisson: 0.5 };
        let on = |mesh| ContactProblem::new(&shell, &groups, mesh).unwrap();
        let mesh = demand(&on(Mesh::uniform(80).unwrap()), 0.75).mesh(tolerance, 20_000).unwrap();
        let elements = mesh.elements();
        let own = error(&on(mesh), 0.75);
        let equal = error(&on(Mesh::uniform(elements).unwrap()), 0.75);
        assert!(
            own <= tolerance,
            "shell {k}: {own:.1e} by {elements} elements, not {tolerance:.1e}"
        );
        gain += (equal / own).ln() / 24.0;
    }
    assert!(gain.exp() > 1.5, "equal elements are off by {:.2} times as much", gain.exp());
}

#[test]
fn a_tolerance_that_takes_too_many_elements_is_refused() {
    let groups = Dimensionless {
        bending: 3e-5,
        pressure: 3e-3,
        adhesion: 2e-3,
        film: 1.0 / 30.0,
        surface_tension: 0.0,
        gas_exponent: 1.07,
    };
    let shell = Shell { law: Law::Hooke, poisson: 0.5 };
    let coarse = ContactProblem::new(&shell, &groups, Mesh::uniform(60).unwrap()).unwrap();
    let demand = demand(&coarse, 0.75);
    let few = demand.mesh(1e-4, 2000).unwrap().elements();
    let many = demand.mesh(1e-8, 2000).unwrap().elements();
    // the fourth order, but where the floor holds
    assert!(few < 200 && many > 5 * few, "{few} and {many}");
    let refused = demand.mesh(1e-8, many - 1).unwrap_err();
    assert!(matches!(refused, ToleranceError::TooManyElements { most, .. } if most == many - 1));
}
