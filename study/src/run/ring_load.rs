//! The ring-loaded shell. The library's contact angle is in radians, a case's and a result's in
//! degrees.

use super::form::{StabilityColumns, certified, form};
use super::resolution::Resolved;
use super::states::of_ring_load;
use super::{Observer, Progress, RunError, listen, settings};
use crate::case::{PathCase, ResolvedCase, RingLoadCase};
use crate::record::view::{Curve, Examined, Mark, Shape, Stability};
use crate::record::{Cell, EventRecord, Pictures, RING, Table, TraceResult};
use continuation::diagram::{Diagram, Origin};
use continuation::{Branch, Point, Settings, TraceError, Tracer, Watch};
use shell_contact::RingLoadProblem;
use std::ops::ControlFlow;
use std::time::Instant;

/// The columns before `event` after `point` and the angle: as files have them.
const COLUMNS: [&str; 9] = [
    "point",
    "alpha",
    "deflection_over_h",
    "force",
    "unstable",
    "pole_height",
    "ring_height",
    "admissible",
    "energy_total",
];
/// What stands after `event`.
const MORE: [&str; 2] = ["pole_over_h", "highest_over_h"];
/// Longest step by default.
const SMOOTH: f64 = 5e-3;
/// Samples along the meridian in the picture of shapes.
const SAMPLES: usize = 801;
/// The axes of the pictures.
pub const AXES: (&str, &str) = ("contact angle α (degrees)", "force 10⁶F/(2πEhR₀)");

/// Where and how the branch of a case starts.
pub(super) struct Start {
    pub(super) problem: RingLoadProblem,
    pub(super) u: Vec<f64>,
    pub(super) p: Vec<f64>,
}

/// The problem of a case, at the path's start.
pub(super) fn start(case: &ResolvedCase, ring: &RingLoadCase) -> Result<Start, RunError> {
    let grading = ring.mesh.grading.unwrap_or(shell_contact::ring_load::DEFAULT_GRADING);
    let problem = RingLoadProblem::new(&ring.shell, &ring.groups, ring.mesh.elements, grading)
        .map_err(|error| RunError::Parameters { case: case.name.clone(), error })?;
    let (u, p) = (problem.initial_state(), problem.parameters_at(case.path.start.to_radians()));
    Ok(Start { problem, u, p })
}

/// The tracer's settings.
pub(super) fn path(path: &PathCase) -> Settings {
    let plain = settings(path);
    let max_step = plain.max_step.or(Some(SMOOTH.max(plain.min_step.unwrap_or(0.0))));
    Settings { max_step, target: plain.target.map(f64::to_radians), ..plain }
}

/// What is watched: the extrema of the force.
pub(super) fn watches() -> Vec<Watch> {
    vec![Watch::extremum("force")]
}

/// No first point.
pub(super) fn no_start(case: &ResolvedCase, detail: TraceError) -> RunError {
    RunError::NoStart {
        case: case.name.clone(),
        start: case.path.start,
        detail,
        remedy: "start at a smaller contact angle, where the flat state is the only one",
    }
}

/// Trace a case; `reported` also takes the states along the branch, for a report.
pub(super) fn run(
    case: &ResolvedCase,
    ring: &RingLoadCase,
    reported: bool,
    observer: &mut Observer<'_>,
) -> Result<TraceResult, RunError> {
    let clock = Instant::now();
    let Start { problem, u, p } = start(case, ring)?;
    let observer = &mut in_degrees(observer);
    let traced = Tracer::new(&problem, "alpha", &u, &p, path(&case.path))
        .and_then(|tracer| tracer.watching(&watches()))
        .map(|tracer| tracer.run(&mut listen(observer)));
    let branch = traced.map_err(|detail| no_start(case, detail))?;
    let seconds = clock.elapsed().as_secs_f64();
    let shapes = shapes(&problem, &branch);
    let mut branch = branch;
    to_degrees(&mut branch);
    let resolved = resolved(ring, &problem, &branch);
    let pictures = Pictures {
        title: resolved.titled(&case.name),
        diagram: Some((AXES.0.to_owned(), AXES.1.to_owned(), curve(&branch))),
        shapes,
        states: if reported {
            of_ring_load(&problem, &branch, branch.points.len())
        } else {
            Vec::new()
        },
        ..Pictures::default()
    };
    let resolution = resolved.record();
    Ok(TraceResult { pictures, resolution, ..result(case, &branch, seconds) })
}

/// Whether the elements about the ring resolve the shell along a branch in degrees.
pub(super) fn resolved(
    ring: &RingLoadCase,
    problem: &RingLoadProblem,
    branch: &Branch,
) -> Resolved {
    let look = |point: &Point| {
        problem.resolution(&point.u, &problem.parameters_at(point.p.to_radians())).ok()
    };
    let each = branch.points.iter().map(look).collect();
    Resolved::along(branch, ring.mesh.elements, ("alpha", |point: &Point| point.p), each)
}

/// An observer of angles in degrees hears of angles in radians.
pub(super) fn in_degrees<'o>(
    observer: &'o mut Observer<'_>,
) -> impl FnMut(Progress) -> ControlFlow<()> + 'o {
    move |at| observer(Progress { parameter: at.parameter.to_degrees(), ..at })
}

/// Turns a branch's angles into degrees.
fn to_degrees(branch: &mut Branch) {
    for point in &mut branch.points {
        point.p = point.p.to_degrees();
    }
    for event in &mut branch.events {
        event.p = event.p.to_degrees();
    }
}

/// A diagram with its angles in degrees.
pub(super) fn diagram_in_degrees(mut diagram: Diagram) -> Diagram {
    for one in &mut diagram.branches {
        to_degrees(&mut one.branch);
        for near in &mut one.near {
            near.p = near.p.to_degrees();
        }
        if let Origin::Deflation { parameter, .. } = &mut one.origin {
            *parameter = parameter.to_degrees();
        }
    }
    diagram
}

/// A branch, in degrees, as plain numbers without pictures.
pub(super) fn result(case: &ResolvedCase, branch: &Branch, seconds: f64) -> TraceResult {
    let stability = StabilityColumns::of(branch);
    let columns: Vec<&str> = COLUMNS.into_iter().chain(["event"]).chain(MORE).collect();
    let mut table = Table::with_columns(&columns).described(RING).and(stability.titles());
    let place = |name: &str| branch.observables.iter().position(|known| known == name);
    for (index, point) in branch.points.iter().enumerate() {
        let observed = |name: &str| place(name).map(|k| point.observables[k]);
        let kind = point.event.map(|e| branch.events[e].kind.to_string()).unwrap_or_default();
        let cell = |name: &&str| -> Cell {
            match *name {
                "point" => index.into(),
                "alpha" => point.p.into(),
                "unstable" => point.unstable.into(),
                "admissible" => match observed("admissible") {
                    Some(flag) => if flag > 0.5 { "true" } else { "false" }.into(),
                    None => Cell::Empty,
                },
                "event" => kind.as_str().into(),
                name => observed(name).into(),
            }
        };
        let mut row: Vec<Cell> = columns.iter().map(cell).collect();
        row.extend(stability.cells(point));
        table.push(row);
    }
    let events = branch.events.iter().map(|event| {
        let point = &branch.points[event.point];
        let observed = |name: &str| place(name).map(|k| point.observables[k]);
        let named = ["deflection_over_h", "pole_over_h", "highest_over_h", "pole_height"];
        EventRecord {
            kind: event.kind.to_string(),
            parameter: Some(event.p),
            z0: None,
            force: observed("force"),
            deformation: observed("ring_height").map(|z| 1.0 - z),
            energy_total: observed("energy_total"),
            unstable_before: event.unstable_before,
            unstable_after: event.unstable_after,
            residual: Some(event.residual),
            error_estimate: Some(event.error_estimate),
            observables: named
                .iter()
                .filter_map(|name| Some(((*name).to_owned(), observed(name)?)))
                .collect(),
            form: form(branch, event),
            mesh_error: None,
            mode: None,
            u: point.u.clone(),
            eigenvectors: event.critical_modes(),
            cycle: None,
        }
    });
    TraceResult {
        case: case.name.clone(),
        parameter: branch.parameter.clone(),
        events: events.collect(),
        maxwell: None,
        stability: None,
        table,
        resolution: None,
        stopped_because: branch.stopped.reason,
        stopped_detail: branch.stopped.detail.clone(),
        points: branch.points.len(),
        certified: certified(branch),
        newton_iterations: branch.statistics.newton_iterations,
        seconds,
        shapes: Vec::new(),
        pictures: Pictures::default(),
    }
}

/// Force over angle of a branch in degrees.
pub(super) fn curve(branch: &Branch) -> Curve {
    let force = branch.observables.iter().position(|name| name == "force");
    let value = |at: usize| force.map_or(f64::NAN, |k| branch.points[at].observables[k]);
    let mark = |event: &continuation::Event| Mark {
        kind: event.kind.to_string(),
        x: event.p,
        y: value(event.point),
    };
    Curve {
        label: "force".to_owned(),
        x: branch.points.iter().map(|point| point.p).collect(),
        y: (0..branch.points.len()).map(value).collect(),
        unstable: branch.points.iter().map(|p| p.unstable.is_some_and(|n| n > 0)).collect(),
        examined: Examined::Axisymmetric,
        marks: branch.events.iter().map(mark).collect(),
        ..Curve::default()
    }
}

/// Shapes at four points of a branch in radians, evenly spread over its length.
fn shapes(problem: &RingLoadProblem, branch: &Branch) -> Vec<Shape> {
    let length = branch.points.last().map_or(0.0, |point| point.s);
    let chosen = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0]
        .map(|part| branch.points.iter().position(|point| point.s >= part * length).unwrap_or(0));
    let shape = |at: usize| {
        let point = branch.points.get(at)?;
        let p = problem.parameters_at(point.p);
        let profile = problem.profile(&point.u, &p, SAMPLES).ok()?;
        let ring = problem.observation(&point.u, &p).ok()?.ring_height;
        Some(Shape {
            label: format!("α = {:.2}°", point.p.to_degrees()),
            sigma: profile.sigma,
            z: profile.z,
            plate: ring,
            plate_below: None,
            stability: Stability::of(point.unstable.is_some_and(|n| n > 0), false),
        })
    };
    let mut chosen = chosen.to_vec();
    chosen.dedup();
    chosen.into_iter().filter_map(shape).collect()
}
