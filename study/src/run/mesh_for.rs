//! A mesh for a tolerance: the branch is followed on a coarse mesh, which says where elements are wanted.

use super::contact::{build, follow};
use super::resolution::{Resolved, height};
use super::{Progress, RunError};
use crate::case::{ContactCase, PathCase, ResolvedCase};
use shell_contact::discretisation::{Demand, Place};
use shell_contact::{ContactBranch, ContactProblem, Device, Mesh};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::ops::ControlFlow;

/// Elements of the first coarse mesh at least, and per wavelength of the shell.
const COARSE: f64 = 60.0;
const PER_WAVELENGTH: f64 = 16.0;

/// Elements per film length, with something to spare.
const SPARE: f64 = 1.1;

/// Most elements of a coarse mesh.
const MOST_COARSE: usize = 2000;

/// Most elements of a mesh.
const MOST: usize = 20_000;

/// Longest steps on coarse meshes, in `R0`.
const STEP: f64 = 0.03;

/// The mesh with which the branch of a case is followed to a tolerance; always the same for the same case.
pub(super) fn tolerance(
    case: &ResolvedCase,
    contact: &ContactCase,
    tolerance: f64,
) -> Result<Mesh, RunError> {
    let mut elements = first(contact.groups.bending);
    let (problem, traced, resolution) = loop {
        let coarse = pilot(case, contact, elements);
        let record = coarse
            .as_ref()
            .ok()
            .and_then(|(problem, traced)| Resolved::of(problem, traced).record());
        let wanted = match record {
            Some(record) if record.enough => elements,
            Some(record) => record.wanted,
            None => 2 * elements,
        };
        if wanted <= elements || elements >= MOST_COARSE {
            let (problem, traced) = coarse?;
            break (problem, traced, record);
        }
        elements = wanted.min(MOST_COARSE);
    };
    let branch = &traced.branch;
    let (height, n) = (height(branch), problem.mesh().unknowns());
    let force = branch.observables.iter().position(|name| name == "force");
    let places = branch.points.iter().map(|point| Place {
        u: &point.u[..n],
        z0: height(point),
        force: force.map_or(f64::NAN, |k| point.observables[k]),
    });
    let refused = |error| RunError::Tolerance { case: case.name.clone(), error };
    let demand = Demand::along(&problem, places);
    let film = resolution.map_or(0.0, |one| elements as f64 / FRAC_PI_2 / one.per_film_length);
    demand.with_at_least(SPARE * film).mesh(tolerance, MOST).map_err(refused)
}

/// Elements that resolve the shell's wavelength.
fn first(bending: f64) -> usize {
    let wavelength = TAU * bending.sqrt().sqrt();
    let elements = (PER_WAVELENGTH * FRAC_PI_2 / wavelength).max(COARSE);
    if elements < MOST_COARSE as f64 { elements.ceil() as usize } else { MOST_COARSE }
}

/// The branch on a coarse mesh, in long steps.
fn pilot(
    case: &ResolvedCase,
    contact: &ContactCase,
    elements: usize,
) -> Result<(ContactProblem, ContactBranch), RunError> {
    let refused = |error| RunError::Parameters { case: case.name.clone(), error };
    let mesh = Mesh::uniform(elements).map_err(refused)?;
    let problem = build(contact, mesh).map_err(refused)?;
    // under a device its own parameter counts in the length of a step
    let long =
        (contact.device == Device::Grip).then(|| case.path.max_step.unwrap_or(STEP).max(STEP));
    let path = PathCase { max_step: long.or(case.path.max_step), eigenvalues: 0, ..case.path };
    let coarse = ResolvedCase { path, ..case.clone() };
    let go_on = &mut |_: Progress| ControlFlow::Continue(());
    let (traced, _) = follow(&coarse, contact.device, &problem, go_on)?;
    Ok((problem, traced))
}
