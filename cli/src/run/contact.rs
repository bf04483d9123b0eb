//! The contact problem: a shell between two plates.

use super::form::{StabilityColumns, certified, form};
use super::{Observer, RunError, listen, settings};
use crate::case::{ContactCase, Law, ResolvedCase};
use crate::output::{ContactRow, EventRecord, Pictures, Table, TraceResult};
use crate::pictures::{Curve, Mark, Profile, Shape};
use continuation::{Point, Settings, TraceError};
use shell_contact::{ContactBranch, ContactProblem, Dimensionless, Mesh, Shell, trace_contact};
use std::time::Instant;

/// Samples along the meridian in pictures of shapes and profiles.
const SAMPLES: usize = 801;

/// Longest step by default, in R0: short enough for curves that look smooth.
const SMOOTH: f64 = 0.01;

/// Trace a contact case.
pub(super) fn run(
    case: &ResolvedCase,
    contact: &ContactCase,
    observer: &mut Observer<'_>,
) -> Result<TraceResult, RunError> {
    let clock = Instant::now();
    let (problem, traced) = branch(case, contact, observer)?;
    let seconds = clock.elapsed().as_secs_f64();
    let pictures = pictures(&case.name, &problem, &traced);
    Ok(TraceResult { pictures, ..result(case, &traced, seconds) })
}

/// The branch itself, and its problem.
pub(crate) fn branch(
    case: &ResolvedCase,
    contact: &ContactCase,
    observer: &mut Observer<'_>,
) -> Result<(ContactProblem, ContactBranch), RunError> {
    let problem = problem(case, contact)?;
    let start = case.path.start;
    let traced = trace_contact(&problem, start, path(case), &mut listen(observer))
        .map_err(|detail| no_start(case, detail))?;
    Ok((problem, traced))
}

/// The tracer's settings.
pub(super) fn path(case: &ResolvedCase) -> Settings {
    let path = settings(&case.path);
    let max_step = path.max_step.or(Some(SMOOTH.max(path.min_step.unwrap_or(0.0))));
    Settings { max_step, ..path }
}

/// No first point.
pub(super) fn no_start(case: &ResolvedCase, detail: TraceError) -> RunError {
    RunError::NoStart {
        case: case.name.clone(),
        start: case.path.start,
        detail,
        remedy: "start farther from the shell (a film that attracts strongly pulls a soft \
                 shell onto the plate: try a larger path.start)",
    }
}

/// A traced branch as plain numbers, without pictures.
pub(crate) fn result(case: &ResolvedCase, traced: &ContactBranch, seconds: f64) -> TraceResult {
    let (table, events) = tabulate(traced);
    let branch = &traced.branch;
    TraceResult {
        case: case.name.clone(),
        parameter: branch.parameter.clone(),
        table,
        events,
        stopped_because: branch.stopped.reason,
        stopped_detail: branch.stopped.detail.clone(),
        points: branch.points.len(),
        certified: certified(branch),
        newton_iterations: branch.statistics.newton_iterations,
        seconds,
        pictures: Pictures::default(),
    }
}

/// The problem that a case describes.
pub(super) fn problem(
    case: &ResolvedCase,
    contact: &ContactCase,
) -> Result<ContactProblem, RunError> {
    build(contact).map_err(|error| RunError::Parameters { case: case.name.clone(), error })
}

fn build(contact: &ContactCase) -> Result<ContactProblem, shell_contact::ParameterError> {
    let law = match contact.shell.law {
        Law::Hooke => shell_contact::Law::Hooke,
        Law::MooneyRivlin { b } => shell_contact::Law::MooneyRivlin { b },
        Law::Skalak => shell_contact::Law::Skalak,
    };
    let shell = Shell { law, poisson: contact.shell.poisson };
    let g = &contact.groups;
    let groups = Dimensionless {
        bending: g.bending,
        pressure: g.pressure,
        adhesion: g.adhesion,
        film: g.film,
        surface_tension: g.surface_tension,
        gas_exponent: g.gas_exponent,
    };
    let mesh = match contact.mesh.grading {
        Some(ratio) => Mesh::graded(contact.mesh.elements, ratio)?,
        None => Mesh::uniform(contact.mesh.elements)?,
    };
    ContactProblem::new(&shell, &groups, mesh)
}

/// One point in the contract's columns.
fn row(traced: &ContactBranch, index: usize, point: &Point) -> ContactRow {
    let branch = &traced.branch;
    let observed = |name: &str| {
        let at = branch.observables.iter().position(|n| n == name);
        at.map_or(f64::NAN, |k| point.observables[k])
    };
    ContactRow {
        point: index,
        z0: point.p,
        deformation: traced.deformation(point.p).unwrap_or(f64::NAN),
        force: observed("force"),
        unstable: point.unstable,
        pole_height: observed("pole_height"),
        gas_pressure: observed("gas_pressure"),
        volume: observed("volume"),
        energy_total: observed("energy_total"),
        energy_stretching: observed("energy_stretching"),
        energy_bending: observed("energy_bending"),
        energy_film: observed("energy_film"),
        energy_gas: observed("energy_gas"),
        energy_surface: observed("energy_surface"),
        contact_radius: observed("contact_radius"),
        event: point.event.map(|e| branch.events[e].kind.to_string()).unwrap_or_default(),
    }
}

fn tabulate(traced: &ContactBranch) -> (Table, Vec<EventRecord>) {
    let branch = &traced.branch;
    let stability = StabilityColumns::of(branch);
    let mut table = Table::contact().and(stability.titles());
    for (index, point) in branch.points.iter().enumerate() {
        let mut cells = row(traced, index, point).cells();
        cells.extend(stability.cells(point));
        table.push(cells);
    }
    let events = branch.events.iter().map(|event| {
        let at = row(traced, event.point, &branch.points[event.point]);
        EventRecord {
            kind: event.kind.to_string(),
            parameter: Some(event.p),
            force: Some(at.force),
            deformation: traced.deformation(event.p),
            energy_total: Some(at.energy_total),
            unstable_before: event.unstable_before,
            unstable_after: event.unstable_after,
            residual: Some(event.residual),
            error_estimate: Some(event.error_estimate),
            observables: Vec::new(),
            form: form(branch, event),
        }
    });
    let events = events.collect();
    (table, events)
}

fn pictures(title: &str, problem: &ContactProblem, traced: &ContactBranch) -> Pictures {
    let branch = &traced.branch;
    let rows: Vec<ContactRow> =
        branch.points.iter().enumerate().map(|(i, p)| row(traced, i, p)).collect();
    let unstable: Vec<bool> =
        branch.points.iter().map(|p| p.unstable.is_some_and(|n| n > 0)).collect();
    let curve = |label: &str, x: &dyn Fn(&ContactRow) -> f64, y: &dyn Fn(&ContactRow) -> f64| {
        let (x, y): (Vec<f64>, Vec<f64>) = rows.iter().map(|r| (x(r), y(r))).unzip();
        let mark = |e: &continuation::Event| Mark {
            kind: e.kind.to_string(),
            x: x[e.point],
            y: y[e.point],
        };
        let marks = branch.events.iter().map(mark).collect();
        Curve { label: label.to_owned(), marks, x, y, unstable: unstable.clone() }
    };
    let plain = |label: &str, y: &dyn Fn(&ContactRow) -> f64| Curve {
        marks: Vec::new(),
        ..curve(label, &|r| r.deformation, y)
    };
    let (mut shapes, mut film_pressure) = (Vec::new(), Vec::new());
    for index in chosen(&rows) {
        let point = &branch.points[index];
        let parameters = problem.parameters_at(point.p);
        let Ok(profile) = problem.profile(&point.u, &parameters, SAMPLES) else { continue };
        let label = match traced.deformation(point.p) {
            Some(d) => format!("Δ/R₀ = {d:.3}"),
            None => format!("z₀/R₀ = {:.3}", point.p),
        };
        shapes.push(Shape {
            label: label.clone(),
            sigma: profile.sigma.clone(),
            z: profile.z,
            plate: point.p,
            unstable: unstable[index],
        });
        film_pressure.push(Profile {
            label,
            sigma: profile.sigma,
            value: profile.disjoining_pressure,
            unstable: unstable[index],
        });
    }
    Pictures {
        title: title.to_owned(),
        force_deformation: traced
            .zero_force
            .map(|_| curve("force", &|r| r.deformation, &|r| r.force)),
        force_distance: Some(curve("force", &|r| r.z0, &|r| r.force)),
        shapes,
        film_pressure,
        energies: if traced.zero_force.is_some() {
            vec![
                plain("total", &|r| r.energy_total),
                plain("stretching", &|r| r.energy_stretching),
                plain("bending", &|r| r.energy_bending),
                plain("film", &|r| r.energy_film),
                plain("gas", &|r| r.energy_gas),
                plain("surface", &|r| r.energy_surface),
            ]
        } else {
            Vec::new()
        },
        diagram: None,
    }
}

/// Points to draw: the first zero of the force, and three more, evenly spaced up to the end of
/// the branch in the number of radii that the plate has come.
fn chosen(rows: &[ContactRow]) -> Vec<usize> {
    let Some(last) = rows.len().checked_sub(1) else { return Vec::new() };
    let first = rows.iter().position(|r| r.event == "zero-force").unwrap_or(0);
    let mut travelled = vec![0.0];
    for pair in rows[first..].windows(2) {
        let so_far = travelled[travelled.len() - 1];
        travelled.push(so_far + (pair[1].z0 - pair[0].z0).abs());
    }
    let total = travelled[travelled.len() - 1];
    let mut chosen = vec![first];
    for part in [1.0 / 3.0, 2.0 / 3.0, 1.0] {
        let at = travelled.iter().position(|t| *t >= part * total).unwrap_or(0) + first;
        chosen.push(at.min(last));
    }
    chosen.dedup();
    chosen
}
