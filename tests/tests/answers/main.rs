//! Known answers of the shell between plates: exact series, limits, and other programs' results.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod adhesion;
mod buckling;
mod collocation;
mod drop;
mod identify;
mod indentation;
mod point_load;
mod work;

use continuation::{Branch, EventKind, Settings, Tracer, Watch};
use shell_contact::{ContactProblem, Dimensionless, Law, Mesh, Shell};
use std::ops::ControlFlow;

/// `[bending, pressure, adhesion, film, surface_tension, gas_exponent]`, Hooke's law.
pub(crate) fn contact(mesh: Mesh, poisson: f64, groups: [f64; 6]) -> ContactProblem {
    let [bending, pressure, adhesion, film, surface_tension, gas_exponent] = groups;
    let groups = Dimensionless { bending, pressure, adhesion, film, surface_tension, gas_exponent };
    ContactProblem::new(&Shell { law: Law::Hooke, poisson }, &groups, mesh).unwrap()
}

/// Traces from the free shell at `start` to `target`.
pub(crate) fn trace(
    problem: &ContactProblem,
    start: f64,
    target: f64,
    max_step: Option<f64>,
    watches: &[Watch],
) -> Branch {
    let settings = Settings { target: Some(target), max_step, ..Settings::default() };
    let (u, p) = (problem.initial_state(), problem.parameters_at(start));
    let branch = Tracer::new(problem, "z0", &u, &p, settings)
        .and_then(|t| t.watching(watches))
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    assert!(branch.stopped.reason.is_complete(), "{:?}", branch.stopped);
    assert!((branch.points.last().unwrap().p - target).abs() < 1e-13);
    branch
}

/// Plate height at the last zero of the force on the way in.
pub(crate) fn zero_force(branch: &Branch) -> f64 {
    let kind = EventKind::Zero("force".to_owned());
    branch.events_of(&kind).last().expect("the force changes sign").p
}
