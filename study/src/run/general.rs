//! Problems of the catalogue.

use super::form::{StabilityColumns, certified, form};
use super::{Observer, RunError, listen, settings};
use crate::case::{CatalogueCase, ResolvedCase};
use crate::record::Pictures;
use crate::record::view::{Curve, Mark};
use crate::record::{EventRecord, Table, TraceResult};
use continuation::{Branch, TraceError};
use problems::{Constant, Entry, ProblemError, Request};
use std::time::Instant;

/// Trace a problem of the catalogue.
pub(super) fn run(
    case: &ResolvedCase,
    problem: &CatalogueCase,
    observer: &mut Observer<'_>,
) -> Result<TraceResult, RunError> {
    let clock = Instant::now();
    let (entry, request) = request(case, problem)?;
    let branch =
        entry.trace(&request, &mut listen(observer)).map_err(|error| refused(case, error))?;
    Ok(result(case, &branch, clock.elapsed().as_secs_f64()))
}

/// The entry of the catalogue, and what the case asks of it.
pub(super) fn request(
    case: &ResolvedCase,
    problem: &CatalogueCase,
) -> Result<(&'static Entry, Request), RunError> {
    let entry = problems::find(&problem.name).ok_or_else(|| RunError::NotAvailable {
        case: case.name.clone(),
        problem: problem.name.clone(),
    })?;
    let value = |constant: &Constant| {
        problem.parameters.get(constant.name).copied().unwrap_or(constant.default)
    };
    let request = Request {
        start: case.path.start,
        parameters: entry.parameters.iter().map(value).collect(),
        elements: problem.elements.unwrap_or(entry.request().elements),
        settings: settings(&case.path),
    };
    Ok((entry, request))
}

/// Why there is no result, in the case's words.
pub(super) fn refused(case: &ResolvedCase, error: ProblemError) -> RunError {
    match error {
        ProblemError::Trace(detail) => no_start(case, detail),
        error => RunError::Problem { case: case.name.clone(), error },
    }
}

/// No first point.
pub(super) fn no_start(case: &ResolvedCase, detail: TraceError) -> RunError {
    RunError::NoStart {
        case: case.name.clone(),
        start: case.path.start,
        detail,
        remedy: "choose another start or other parameters",
    }
}

/// A traced branch as plain numbers.
pub(super) fn result(case: &ResolvedCase, branch: &Branch, seconds: f64) -> TraceResult {
    let names: Vec<&str> = branch.observables.iter().map(String::as_str).collect();
    let stability = StabilityColumns::of(branch);
    let mut table = Table::general(&branch.parameter, &names).and(stability.titles());
    for (index, point) in branch.points.iter().enumerate() {
        let kind = point.event.map(|e| branch.events[e].kind.to_string()).unwrap_or_default();
        let mut row = vec![index.into(), point.p.into()];
        row.extend(point.observables.iter().map(|&v| v.into()));
        row.extend([point.unstable.into(), kind.as_str().into()]);
        row.extend(stability.cells(point));
        table.push(row);
    }
    let mut curve =
        Curve { label: names.first().copied().unwrap_or("").to_owned(), ..Curve::default() };
    for point in &branch.points {
        curve.x.push(point.p);
        curve.y.push(point.observables.first().copied().unwrap_or(f64::NAN));
        curve.unstable.push(point.unstable.is_some_and(|n| n > 0));
    }
    let mut events = Vec::new();
    for event in &branch.events {
        let point = &branch.points[event.point];
        let named = branch.observables.iter().cloned().zip(point.observables.iter().copied());
        events.push(EventRecord {
            kind: event.kind.to_string(),
            parameter: Some(event.p),
            unstable_before: event.unstable_before,
            unstable_after: event.unstable_after,
            residual: Some(event.residual),
            error_estimate: Some(event.error_estimate),
            observables: named.collect(),
            form: form(branch, event),
            u: point.u.clone(),
            eigenvectors: event.critical_modes(),
            ..EventRecord::default()
        });
        curve.marks.push(Mark {
            kind: event.kind.to_string(),
            x: curve.x[event.point],
            y: curve.y[event.point],
        });
    }
    let pictures = Pictures {
        title: case.name.clone(),
        diagram: Some((branch.parameter.clone(), curve.label.clone(), curve)),
        ..Pictures::default()
    };
    TraceResult {
        case: case.name.clone(),
        parameter: branch.parameter.clone(),
        table,
        events,
        maxwell: None,
        stability: None,
        resolution: None,
        stopped_because: branch.stopped.reason,
        stopped_detail: branch.stopped.detail.clone(),
        points: branch.points.len(),
        certified: certified(branch),
        newton_iterations: branch.statistics.newton_iterations,
        seconds,
        shapes: Vec::new(),
        pictures,
    }
}
