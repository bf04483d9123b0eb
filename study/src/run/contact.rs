//! The contact problem: a shell between two plates.

use super::form::{StabilityColumns, certified, form};
use super::mesh_error::MeshErrors;
use super::mesh_for;
use super::resolution::Resolved;
use super::stability::Stability;
use super::states::of_contact;
use super::{Observer, RunError, listen, settings};
use crate::case::{ContactCase, ResolvedCase};
use crate::record::view::{self, Curve, Mark, Profile, Shape};
use crate::record::{Cell, ContactRow, EventRecord, MaxwellRecord, Pictures, Table, TraceResult};
use continuation::{Event, Point, Problem, Settings, StopReason, TraceError};
use shell_contact::device::{MaxwellPoint, StartError, maxwell_points, trace_loaded};
use shell_contact::landmarks;
use shell_contact::{ContactBranch, ContactProblem, Device, LoadedProblem};
use shell_contact::{Mesh, trace_contact};
use std::time::Instant;

/// Samples along the meridian in pictures of shapes and profiles.
pub(super) const SAMPLES: usize = 801;

/// Longest step by default, in R0: short enough for curves that look smooth.
const SMOOTH: f64 = 0.01;

/// Fewest steps over the range of a device's parameter by default.
const STEPS: f64 = 100.0;

/// Trace a contact case.
pub(super) fn run(
    case: &ResolvedCase,
    contact: &ContactCase,
    observer: &mut Observer<'_>,
) -> Result<TraceResult, RunError> {
    pictured(case, contact, false, observer)
}

/// The same with the states along the branch.
pub(super) fn run_reported(
    case: &ResolvedCase,
    contact: &ContactCase,
    observer: &mut Observer<'_>,
) -> Result<TraceResult, RunError> {
    pictured(case, contact, true, observer)
}

fn pictured(
    case: &ResolvedCase,
    contact: &ContactCase,
    with_states: bool,
    observer: &mut Observer<'_>,
) -> Result<TraceResult, RunError> {
    let (traced, stability) = scanned(case, contact, observer)?;
    let Traced { problem, branch, maxwell, seconds } = traced;
    let errors = MeshErrors::of(&problem, &branch);
    let resolved = Resolved::of(&problem, &branch).with(&errors, &contact.mesh);
    let mut pictures = pictures(&resolved.titled(&case.name), &problem, &branch, &stability);
    if with_states {
        pictures.states = of_contact(&problem, &branch.branch, branch.branch.points.len());
    }
    let result = examined(case, &branch, seconds, &stability, Some(&resolved));
    let mut result = TraceResult { pictures, maxwell: Some(maxwell), ..result };
    for (k, event) in result.events.iter_mut().enumerate() {
        event.mesh_error = errors.event(k);
    }
    Ok(result)
}

/// The same without what pictures show, and without estimates of what the elements add.
pub(super) fn run_plain(
    case: &ResolvedCase,
    contact: &ContactCase,
    observer: &mut Observer<'_>,
) -> Result<TraceResult, RunError> {
    let (traced, stability) = scanned(case, contact, observer)?;
    let Traced { problem, branch, maxwell, seconds } = traced;
    let resolved = Resolved::of(&problem, &branch);
    let result = examined(case, &branch, seconds, &stability, Some(&resolved));
    Ok(TraceResult { maxwell: Some(maxwell), ..result })
}

/// A branch under the case's device.
struct Traced {
    problem: ContactProblem,
    branch: ContactBranch,
    maxwell: Vec<MaxwellRecord>,
    seconds: f64,
}

fn traced(
    case: &ResolvedCase,
    contact: &ContactCase,
    observer: &mut Observer<'_>,
) -> Result<Traced, RunError> {
    let clock = Instant::now();
    let problem = shell(case, contact)?;
    let (mut branch, maxwell) = follow(case, contact.device, &problem, observer)?;
    // states of a traced branch are admissible: there is nothing that could be refused
    let _ = landmarks::locate(&problem, contact.device, &mut branch.branch, contact.events);
    Ok(Traced { problem, branch, maxwell, seconds: clock.elapsed().as_secs_f64() })
}

/// A traced branch with what is unstable beyond its own counts.
fn scanned(
    case: &ResolvedCase,
    contact: &ContactCase,
    observer: &mut Observer<'_>,
) -> Result<(Traced, Stability), RunError> {
    let clock = Instant::now();
    let mut traced = traced(case, contact, observer)?;
    let stability = Stability::of(case, &traced.problem, &mut traced.branch, observer);
    traced.seconds = clock.elapsed().as_secs_f64();
    Ok((traced, stability))
}

/// The branch itself under a held plate, and its problem.
pub fn branch(
    case: &ResolvedCase,
    contact: &ContactCase,
    observer: &mut Observer<'_>,
) -> Result<(ContactProblem, ContactBranch), RunError> {
    let problem = shell(case, contact)?;
    let traced = held(case, &problem, observer)?;
    Ok((problem, traced))
}

/// The branch under plates that are held. It ends too where they have gone as far behind their start
/// as the end lies before it, or one radius if that is more: a branch that turned back at a fold may
/// lead away without an end.
fn held(
    case: &ResolvedCase,
    problem: &ContactProblem,
    observer: &mut Observer<'_>,
) -> Result<ContactBranch, RunError> {
    let (start, end) = (case.path.start, case.path.end);
    let way = (end - start).abs().max(1.0);
    let (limit, domain) = if end < start {
        (start + way, (f64::NEG_INFINITY, start + way))
    } else {
        (start - way, (start - way, f64::INFINITY))
    };
    let settings = Settings { domain: Some(domain), ..path(case) };
    let mut traced = trace_contact(problem, start, settings, &mut listen(observer))
        .map_err(|detail| no_start(case, detail))?;
    let stopped = &mut traced.branch.stopped;
    if stopped.reason == StopReason::Domain {
        stopped.detail = format!(
            "the branch turned back and led the plate away from its end, to z0 = {limit}, the far \
             limit of a trace from {start} to {end}"
        );
    }
    Ok(traced)
}

/// The branch in the device's parameter, and its Maxwell points.
pub(super) fn follow(
    case: &ResolvedCase,
    device: Device,
    problem: &ContactProblem,
    observer: &mut Observer<'_>,
) -> Result<(ContactBranch, Vec<MaxwellRecord>), RunError> {
    let (traced, points) = if device == Device::Grip {
        let traced = held(case, problem, observer)?;
        let points = maxwell_points(problem, &traced.branch);
        (traced, points)
    } else {
        let loaded = LoadedProblem::new(problem, device).map_err(|e| not_held(case, e.into()))?;
        let (start, listen) = (case.path.start, &mut listen(observer));
        let traced = trace_loaded(&loaded, start, loaded_path(case), listen)
            .map_err(|detail| not_held(case, detail))?;
        let points = maxwell_points(&loaded, &traced.branch);
        (traced, points)
    };
    Ok((traced, points.iter().map(|point| maxwell(device, point)).collect()))
}

fn maxwell(device: Device, point: &MaxwellPoint) -> MaxwellRecord {
    MaxwellRecord {
        parameter: device.parameter_name(),
        value: point.parameter,
        potential: point.potential,
        z0: point.z0,
        force: point.force,
        energy: point.energy,
        unstable: point.unstable,
        error_estimate: point.error_estimate,
    }
}

/// The tracer's settings under a device.
pub(super) fn loaded_path(case: &ResolvedCase) -> Settings {
    let settings = path(case);
    if case.path.max_step.is_some() {
        return settings;
    }
    // the device's parameter counts in the length of a step
    let range = (case.path.end - case.path.start).abs();
    let max_step = settings.max_step.map(|step| step.max(range / STEPS));
    Settings { max_step, ..settings }
}

/// No stable state to start from under a device.
pub(super) fn not_held(case: &ResolvedCase, detail: StartError) -> RunError {
    RunError::NotHeld { case: case.name.clone(), start: case.path.start, detail }
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

/// A traced branch as plain numbers, without pictures and without a look at its stability and mesh.
pub fn result(case: &ResolvedCase, traced: &ContactBranch, seconds: f64) -> TraceResult {
    examined(case, traced, seconds, &Stability::default(), None)
}

fn examined(
    case: &ResolvedCase,
    traced: &ContactBranch,
    seconds: f64,
    stability: &Stability,
    resolved: Option<&Resolved>,
) -> TraceResult {
    let (table, events) = tabulate(traced, stability, resolved);
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
        maxwell: None,
        stability: Some(stability.record()),
        resolution: resolved.and_then(Resolved::record),
        shapes: stability.shapes(branch),
        pictures: Pictures::default(),
    }
}

/// The problem that a case describes, for what knows no device.
pub(super) fn problem(
    case: &ResolvedCase,
    contact: &ContactCase,
) -> Result<ContactProblem, RunError> {
    if contact.device != Device::Grip {
        let (case, device) = (case.name.clone(), contact.device.name());
        return Err(RunError::Device { case, device });
    }
    shell(case, contact)
}

/// The shell of a case, whatever holds its plates.
pub(super) fn shell(
    case: &ResolvedCase,
    contact: &ContactCase,
) -> Result<ContactProblem, RunError> {
    let refused = |error| RunError::Parameters { case: case.name.clone(), error };
    let fixed = |elements: usize| match contact.mesh.grading {
        Some(ratio) => Mesh::graded(elements, ratio),
        None => Mesh::uniform(elements),
    };
    let mesh = match contact.mesh.tolerance {
        Some(tolerance) => mesh_for::tolerance(case, contact, tolerance)?,
        None => fixed(contact.mesh.elements).map_err(refused)?,
    };
    build(contact, mesh).map_err(refused)
}

/// The problem on a mesh.
pub(super) fn build(
    contact: &ContactCase,
    mesh: Mesh,
) -> Result<ContactProblem, shell_contact::ParameterError> {
    ContactProblem::with_potential(&contact.shell, &contact.groups, mesh, contact.potential)
}

/// One point in the contract's columns.
pub(super) fn row(traced: &ContactBranch, index: usize, point: &Point) -> ContactRow {
    let branch = &traced.branch;
    let observed = |name: &str| {
        let at = branch.observables.iter().position(|n| n == name);
        at.map_or(f64::NAN, |k| point.observables[k])
    };
    // the continued parameter, unless a device has another
    let z0 = if branch.parameter == "z0" { point.p } else { observed("z0") };
    ContactRow {
        point: index,
        z0,
        deformation: traced.deformation(z0).unwrap_or(f64::NAN),
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

fn tabulate(
    traced: &ContactBranch,
    scanned: &Stability,
    resolved: Option<&Resolved>,
) -> (Table, Vec<EventRecord>) {
    let branch = &traced.branch;
    let stability = StabilityColumns::of(branch);
    let loaded = branch.parameter != "z0";
    let base = branch.parameter == "base";
    let own = base.then(|| branch.parameter.clone());
    let mut table = Table::contact()
        .and(own.into_iter().collect())
        .and(stability.titles())
        .and(scanned.titles());
    let counted = table.columns().len();
    table = table.and(resolved.map(Resolved::title).into_iter().collect());
    for (index, point) in branch.points.iter().enumerate() {
        let mut cells = row(traced, index, point).cells();
        cells.extend(base.then(|| point.p.into()));
        cells.extend(stability.cells(point));
        cells.resize(counted - scanned.titles().len(), Cell::Empty);
        cells.extend(scanned.cells(index, point));
        cells.resize(counted, Cell::Empty);
        cells.extend(resolved.map(|resolved| resolved.cell(index)));
        table.push(cells);
    }
    let events = branch.events.iter().enumerate().map(|(k, event)| {
        let mode = scanned.mode(branch, k);
        EventRecord { mode, ..event_record(traced, event, loaded) }
    });
    let events = events.collect();
    (table, events)
}

/// A special point with what every contact case says of it.
pub(super) fn event_record(traced: &ContactBranch, event: &Event, loaded: bool) -> EventRecord {
    let branch = &traced.branch;
    let at = row(traced, event.point, &branch.points[event.point]);
    EventRecord {
        kind: event.kind.to_string(),
        parameter: Some(event.p),
        z0: loaded.then_some(at.z0),
        force: Some(at.force),
        deformation: traced.deformation(at.z0),
        energy_total: Some(at.energy_total),
        unstable_before: event.unstable_before,
        unstable_after: event.unstable_after,
        residual: Some(event.residual),
        error_estimate: Some(event.error_estimate),
        observables: Vec::new(),
        form: form(branch, event),
        mesh_error: None,
        mode: None,
        u: branch.points[event.point].u.clone(),
        eigenvectors: event.critical_modes(),
        cycle: None,
    }
}

fn pictures(
    title: &str,
    problem: &ContactProblem,
    traced: &ContactBranch,
    stability: &Stability,
) -> Pictures {
    let branch = &traced.branch;
    let rows: Vec<ContactRow> =
        branch.points.iter().enumerate().map(|(i, p)| row(traced, i, p)).collect();
    let curve =
        |label: &str, x: &Column<'_>, y: &Column<'_>| drawn(traced, stability, &rows, label, x, y);
    let plain = |label: &str, y: &Column<'_>| Curve {
        marks: Vec::new(),
        ..curve(label, &|r| r.deformation, y)
    };
    let (mut shapes, mut film_pressure) = (Vec::new(), Vec::new());
    for index in chosen(&rows) {
        let point = &branch.points[index];
        let z0 = rows[index].z0;
        let parameters = problem.parameters_at(z0);
        let u = &point.u[..problem.dim()];
        let Ok(profile) = problem.profile(u, &parameters, SAMPLES) else { continue };
        let own = point.unstable.is_some_and(|n| n > 0);
        let state = view::Stability::of(own, stability.is_asymmetric(index));
        let label = match traced.deformation(z0) {
            Some(d) => format!("Δ/R₀ = {d:.3}"),
            None => format!("z₀/R₀ = {z0:.3}"),
        };
        shapes.push(Shape {
            label: label.clone(),
            sigma: profile.sigma.clone(),
            z: profile.z,
            plate: z0,
            plate_below: None,
            stability: state,
        });
        film_pressure.push(Profile {
            label,
            sigma: profile.sigma,
            value: profile.disjoining_pressure,
            stability: state,
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
        ..Pictures::default()
    }
}

/// A column of the table.
pub(super) type Column<'c> = dyn Fn(&ContactRow) -> f64 + 'c;

/// One column over another, with the special points that are drawn.
pub(super) fn drawn(
    traced: &ContactBranch,
    stability: &Stability,
    rows: &[ContactRow],
    label: &str,
    x: &Column<'_>,
    y: &Column<'_>,
) -> Curve {
    let branch = &traced.branch;
    let (x, y): (Vec<f64>, Vec<f64>) = rows.iter().map(|r| (x(r), y(r))).unzip();
    let marks = branch.events.iter().filter(|event| stability.is_drawn(event));
    let mark = |event: &continuation::Event| Mark {
        kind: event.kind.to_string(),
        x: x[event.point],
        y: y[event.point],
    };
    Curve {
        label: label.to_owned(),
        marks: marks.map(mark).collect(),
        x,
        y,
        unstable: branch.points.iter().map(|p| p.unstable.is_some_and(|n| n > 0)).collect(),
        asymmetric: (0..branch.points.len()).map(|i| stability.is_asymmetric(i)).collect(),
        examined: stability.examined(),
    }
}

/// A branch of a diagram and its force over the plate distance.
pub(super) fn on_diagram(
    case: &ResolvedCase,
    problem: &ContactProblem,
    traced: &ContactBranch,
    stability: &Stability,
) -> (TraceResult, Curve) {
    let points = traced.branch.points.iter().enumerate();
    let rows: Vec<ContactRow> = points.map(|(i, p)| row(traced, i, p)).collect();
    let curve = drawn(traced, stability, &rows, "force", &|r| r.z0, &|r| r.force);
    (examined(case, traced, 0.0, stability, Some(&Resolved::of(problem, traced))), curve)
}

/// Points to draw: the first zero of the force, and three more, evenly spaced up to the end of
/// the branch in the number of radii that the plate has come.
pub(super) fn chosen(rows: &[ContactRow]) -> Vec<usize> {
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
