//! A cycle for a report: the ways to and fro as curves with their states.

use super::states;
use super::two_plates::BetweenPlates;
use crate::record::{ContactRow, MODES, PathRow, ReportedCycle, Table, Way};
use continuation::Problem;
use shell_contact::device::{Cycle, CyclePoint};
use shell_contact::{ContactBranch, ContactProblem, Device, Observation};
use std::iter;
use std::ops::Range;

/// Both ways of a cycle, and the states along the complete branch.
pub(super) fn reported(
    problem: &ContactProblem,
    traced: &ContactBranch,
    cycle: &Cycle,
) -> ReportedCycle {
    let all = traced.branch.points.len() + cycle.points.len();
    let seen = |point: &CyclePoint| {
        let u = point.u.get(..problem.dim())?;
        problem.observation(u, &problem.parameters_at(point.z0)).ok()
    };
    ReportedCycle {
        ways: spans(cycle)
            .into_iter()
            .map(|span| {
                let points = &cycle.points[span.clone()];
                let way = way(traced, cycle, span, &seen);
                let special =
                    |at: usize| points[at].event.is_some() || way.jumps.contains(&(at + 1));
                let shown = states::shown(points.len(), all, special);
                let state =
                    |at: usize| states::between_plates(problem, at, &points[at].u, points[at].z0);
                Way { states: shown.filter_map(state).collect(), ..way }
            })
            .collect(),
        branch: states::of_contact(problem, &traced.branch, all),
    }
}

/// The points of each way. The later one begins where the earlier one ended, unless the plate has
/// been far away in between.
fn spans(cycle: &Cycle) -> Vec<Range<usize>> {
    let points = &cycle.points;
    let turn = (1..points.len()).find(|&at| points[at].direction != points[at - 1].direction);
    let Some(turn) = turn else { return iter::once(0..points.len()).collect() };
    let returned = cycle.jumps.iter().any(|j| j.after == Some(turn) && j.before.is_none());
    let begin = if returned { turn } else { turn - 1 };
    [0..turn, begin..points.len()].to_vec()
}

/// Both ways of a cycle from pole to pole, and the states along the complete branch.
pub(super) fn between_plates<P: BetweenPlates>(
    problem: &P,
    traced: &ContactBranch,
    cycle: &Cycle,
) -> ReportedCycle {
    let all = traced.branch.points.len() + cycle.points.len();
    let seen =
        |point: &CyclePoint| problem.whole(&point.u, &problem.parameters_at(point.parameter)).ok();
    ReportedCycle {
        ways: spans(cycle)
            .into_iter()
            .map(|span| {
                let points = &cycle.points[span.clone()];
                let way = way(traced, cycle, span, &seen);
                let special =
                    |at: usize| points[at].event.is_some() || way.jumps.contains(&(at + 1));
                let shown = states::shown(points.len(), all, special);
                let state = |at: usize| {
                    states::from_pole_to_pole(problem, at, &points[at].u, points[at].parameter)
                };
                Way { states: shown.filter_map(state).collect(), ..way }
            })
            .collect(),
        branch: states::of_two_plates(problem, &traced.branch, all),
    }
}

fn way(
    traced: &ContactBranch,
    cycle: &Cycle,
    span: Range<usize>,
    seen: &dyn Fn(&CyclePoint) -> Option<Observation>,
) -> Way {
    let points = &cycle.points[span.clone()];
    let cantilever = matches!(cycle.device, Device::Cantilever { .. });
    let base = cantilever.then(|| cycle.device.parameter_name().to_owned());
    let mut table = Table::contact().and(base.into_iter().collect());
    for (at, point) in points.iter().enumerate() {
        let mut cells = row(traced, at, point, seen(point)).cells();
        cells.extend(cantilever.then(|| point.parameter.into()));
        table.push(cells);
    }
    let landed = cycle.jumps.iter().filter(|jump| jump.before.is_some());
    let within = |after: usize| (after > span.start).then(|| after - span.start);
    let jumps: Vec<usize> = landed
        .filter_map(|jump| jump.after.filter(|after| span.contains(after)).and_then(within))
        .collect();
    let label = points.last().map_or("", |point| point.direction.name());
    Way { label, table, jumps, states: Vec::new() }
}

/// Puts what the states of the path are unstable to beside those of its ways.
pub(super) fn count(reported: &mut ReportedCycle, cycle: &Cycle, path: &[PathRow]) {
    if path.iter().all(|row| row.modes.is_none()) {
        return;
    }
    for (way, span) in reported.ways.iter_mut().zip(spans(cycle)) {
        let cells = path[span].iter().map(|row| row.modes.map(|modes| modes.cells().to_vec()));
        let cells = cells.map(Option::unwrap_or_default).collect();
        way.table = way.table.beside(&MODES, cells);
    }
}

/// One state of the path, in the columns of a branch: stable to the modes that the path follows.
fn row(
    traced: &ContactBranch,
    at: usize,
    point: &CyclePoint,
    seen: Option<Observation>,
) -> ContactRow {
    let known = ContactRow {
        point: at,
        z0: point.z0,
        deformation: traced.deformation(point.z0).unwrap_or(f64::NAN),
        force: point.force,
        unstable: Some(0),
        energy_total: point.energy,
        event: point.event.clone().unwrap_or_default(),
        ..ContactRow::default()
    };
    let value = |of: fn(&Observation) -> f64| seen.as_ref().map_or(f64::NAN, of);
    ContactRow {
        pole_height: value(|seen| seen.pole_height),
        gas_pressure: value(|seen| seen.gas_pressure),
        volume: value(|seen| seen.volume),
        energy_stretching: value(|seen| seen.energy_stretching),
        energy_bending: value(|seen| seen.energy_bending),
        energy_film: value(|seen| seen.energy_film),
        energy_gas: value(|seen| seen.energy_gas),
        energy_surface: value(|seen| seen.energy_surface),
        contact_radius: value(|seen| seen.contact_radius),
        ..known
    }
}
