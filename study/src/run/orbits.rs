//! The periodic orbits of a diagram: those that leave its Hopf points, as plain numbers.

use super::diagram::{DiagramObserver, DiagramProgress};
use super::form::form;
use super::{Progress, RunError};
use crate::case::ResolvedCase;
use crate::record::view::{Curve, Mark};
use crate::record::{
    BranchOrigin, BranchRecord, Cell, CycleRecord, CyclesRecord, DiagramResult, EventRecord,
    OrbitRecord, OrbitsRecord, Pictures, Table, TraceResult,
};
use continuation::cycles::{
    Cycle, CycleBranch, CycleError, CycleOrigin, CyclePoint, CycleSettings, Explored, Follow,
    FollowedCycles, explore,
};
use continuation::diagram::Diagram;
use continuation::{Branch, EventKind, Problem, Settings, StopReason};
use problems::{Setup, Visitor};
use std::time::Instant;

/// Cycles of a branch that are shown over time, at most, but for special points.
const SHOWN: usize = 5;
/// Unknowns that are shown of a problem without observables, at most: as many as the branch has.
const MOST_UNKNOWNS: usize = 16;

/// Follows the cycles of a diagram's branches of equilibria.
pub(super) struct FollowCycles<'d, 'w, 'o> {
    pub(super) case: &'d ResolvedCase,
    pub(super) diagram: &'d Diagram,
    /// The Hopf point that is wanted, by its number among those of the diagram; all without one.
    pub(super) only: Option<usize>,
    pub(super) observer: &'w mut DiagramObserver<'o>,
}

/// The cycles with what the problem says of them.
pub(super) struct Followed {
    explored: Explored,
    names: Vec<String>,
    orbits: Vec<Vec<OrbitRecord>>,
    hopf_points: usize,
    seconds: f64,
    only: Option<usize>,
}

/// Number of Hopf points of a diagram.
pub(super) fn hopf_points(diagram: &Diagram) -> usize {
    let of = |branch: &Branch| branch.events_of(&EventKind::Hopf).count();
    diagram.branches.iter().map(|one| of(&one.branch)).sum()
}

impl Visitor for FollowCycles<'_, '_, '_> {
    type Output = Result<Followed, CycleError>;

    fn visit<P: Problem>(self, problem: &P, setup: Setup) -> Self::Output {
        let clock = Instant::now();
        let branches: Vec<&Branch> = self.diagram.branches.iter().map(|one| &one.branch).collect();
        // Hopf points in the order of the diagram
        let mut numbers = Vec::new();
        for (at, branch) in branches.iter().enumerate() {
            let hopf = branch.events.iter().enumerate().filter(|(_, e)| e.kind == EventKind::Hopf);
            numbers.extend(hopf.map(|(event, _)| (at, event)));
        }
        let chosen = |branch: usize, event: usize| {
            let number = numbers.iter().position(|at| *at == (branch, event));
            self.only.is_none_or(|only| number == Some(only))
        };
        let places = branches.iter().flat_map(|branch| branch.points.iter().map(|point| point.p));
        let range =
            places.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
        let domain = self.case.diagram.within.unwrap_or(range);
        let trace = Settings { domain: Some(domain), target: None, ..setup.settings.clone() };
        let cycles = CycleSettings::default();
        let most = self.case.diagram.max_branches.saturating_sub(branches.len());
        let depth = self.case.diagram.cycle_depth;
        let follow = Follow { trace: &trace, cycles: &cycles, depth, max_branches: most };
        let observer = self.observer;
        let explored = explore(problem, &branches, &chosen, &follow, &mut |number, at| {
            let branch = Progress { points: at.points, events: at.events, parameter: at.p };
            observer(DiagramProgress { branches: branches.len() + number, waiting: 0, branch })
        })?;
        let names = names(problem);
        let shown = |one: &FollowedCycles| shown(problem, &one.cycles);
        let orbits = explored.branches.iter().map(shown).collect();
        let seconds = clock.elapsed().as_secs_f64();
        let (hopf_points, only) = (numbers.len(), self.only);
        Ok(Followed { explored, names, orbits, hopf_points, seconds, only })
    }
}

/// Names of what is shown of a state.
fn names<P: Problem>(problem: &P) -> Vec<String> {
    let own = problem.observables();
    if own.is_empty() {
        return (0..problem.dim().min(MOST_UNKNOWNS)).map(|i| format!("u[{i}]")).collect();
    }
    own.iter().map(|name| name.to_string()).collect()
}

/// A few cycles of a branch over time.
fn shown<P: Problem>(problem: &P, branch: &CycleBranch) -> Vec<OrbitRecord> {
    let count = branch.cycles.len();
    let Some(last) = count.checked_sub(1) else { return Vec::new() };
    let mut places: Vec<usize> = (0..SHOWN).map(|k| k * last / (SHOWN - 1)).collect();
    places.extend(branch.branch.events.iter().map(|event| event.point));
    places.sort_unstable();
    places.dedup();
    let orbit = |at: usize| {
        let point = branch.branch.points.get(at)?;
        let event = point.event.and_then(|e| branch.branch.events.get(e));
        let event = event.map(|e| format!(" ({})", e.kind)).unwrap_or_default();
        let cycle = &branch.cycles.get(at)?.cycle;
        let (t, values) = over_time(problem, cycle)?;
        Some(OrbitRecord {
            point: at,
            parameter: point.p,
            period: cycle.period,
            label: format!("{} = {:.6}{event}", branch.branch.parameter, point.p),
            unstable: point.unstable.map(|n| n > 0),
            t,
            values,
        })
    };
    places.into_iter().filter_map(orbit).collect()
}

/// Times and what is observed at them, at the nodes of the mesh; `None` where the problem has no value.
fn over_time<P: Problem>(problem: &P, cycle: &Cycle) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
    let (n, m) = (problem.dim(), cycle.degree);
    let mut t: Vec<f64> = Vec::with_capacity(cycle.values.len() / n + 1);
    for w in cycle.mesh.windows(2) {
        let node = |k: usize| cycle.period * (w[0] + (w[1] - w[0]) * k as f64 / m as f64);
        t.extend((0..m).map(node));
    }
    t.push(cycle.period);
    let own = problem.observables().len();
    let count = if own == 0 { n.min(MOST_UNKNOWNS) } else { own };
    let mut values = vec![Vec::with_capacity(t.len()); count];
    let mut observed = vec![0.0; own];
    let states = cycle.values.chunks_exact(n);
    for u in states.chain(cycle.values.chunks_exact(n).take(1)) {
        if own > 0 {
            problem.observe(u, &cycle.parameters, &mut observed).ok()?;
        }
        let here = if own == 0 { &u[..count] } else { &observed[..] };
        values.iter_mut().zip(here).for_each(|(list, value)| list.push(*value));
    }
    Some((t, values))
}

/// Adds the cycles to the diagram, and says what is open.
pub(super) fn add(
    case: &ResolvedCase,
    result: &mut DiagramResult,
    followed: Followed,
    observable: &str,
) {
    let Followed { explored, names, orbits, hopf_points, seconds, only } = followed;
    let observable = match (observable, names.first()) {
        ("", Some(first)) => first.clone(),
        (given, _) => given.to_owned(),
    };
    let ids: Vec<usize> = result.branches.iter().map(|one| one.id).collect();
    let first = ids.iter().max().map_or(0, |id| id + 1);
    let mut sentences = open(&explored, &ids, first, &result.parameter);
    let left = if only.is_some() { hopf_points.saturating_sub(1) } else { 0 };
    if left > 0 {
        let what = points(left, "further Hopf point was", "further Hopf points were");
        sentences.insert(0, format!("{what} left out, as was asked"));
    }
    let complete = explored.is_complete() && left == 0;
    let surely = |one: &FollowedCycles| {
        let reason = one.cycles.branch.stopped.reason;
        reason.is_complete() || reason == StopReason::PeriodUnbounded
    };
    result.followed &= explored.branches.iter().all(surely)
        && explored.failed.is_empty()
        && !explored.full
        && !explored.interrupted;
    for ((number, one), orbits) in explored.branches.into_iter().enumerate().zip(orbits) {
        let from = origin(one.from, &ids, first);
        let vanishes_at = one.vanishes_at.map(|(branch, event)| (ids[branch], event));
        let depth = one.depth + 1;
        let (trace, curve, period) = record(case, &one.cycles, &observable);
        result.newton_iterations += trace.newton_iterations;
        result.branches.push(BranchRecord {
            id: first + number,
            from,
            depth,
            symmetry: None,
            began_because: None,
            near: Vec::new(),
            trace,
            curve,
            orbits: Some(OrbitsRecord { period, names: names.clone(), orbits, vanishes_at }),
        });
    }
    result.seconds += seconds;
    let word = |text: &mut String| {
        if !text.is_empty() {
            text.push_str("; ");
        }
    };
    if !sentences.is_empty() {
        word(&mut result.stopped_detail);
        result.stopped_detail += &sentences.join("; ");
    }
    if explored.interrupted {
        result.stopped_because = "interrupted";
    } else if explored.full {
        result.stopped_because = "max-branches";
    } else if !complete && result.stopped_because == "complete" {
        result.stopped_because = "incomplete";
    }
    result.cycles = Some(CyclesRecord { hopf_points, wanted: true, complete, open: sentences });
}

/// Says that the cycles were not followed, where there are any.
pub(super) fn leave_out(result: &mut DiagramResult, hopf_points: usize) {
    if hopf_points == 0 {
        return;
    }
    let what = points(hopf_points, "Hopf point", "Hopf points");
    let sentence = format!("the cycles that leave {what} were not followed: see diagram.cycles");
    result.stopped_detail = match (result.stopped_because, result.stopped_detail.as_str()) {
        ("complete", _) => {
            format!("every branch of equilibria was followed to its end; {sentence}")
        }
        (_, "") => sentence.clone(),
        (_, other) => format!("{other}; {sentence}"),
    };
    let open = vec![sentence];
    result.cycles = Some(CyclesRecord { hopf_points, wanted: false, complete: false, open });
}

fn points(n: usize, one: &str, many: &str) -> String {
    if n == 1 { format!("one {one}") } else { format!("{n} {many}") }
}

/// Where a branch of cycles begins, in the numbers of the diagram.
fn origin(from: CycleOrigin, ids: &[usize], first: usize) -> BranchOrigin {
    match from {
        CycleOrigin::Hopf { branch, event } => BranchOrigin::Switch { branch: ids[branch], event },
        CycleOrigin::Doubling { branch, event } | CycleOrigin::Crossing { branch, event, .. } => {
            BranchOrigin::Switch { branch: first + branch, event }
        }
        _ => BranchOrigin::Start,
    }
}

/// What is open, in sentences.
fn open(explored: &Explored, ids: &[usize], first: usize, parameter: &str) -> Vec<String> {
    let mut out = Vec::new();
    for (from, error) in &explored.failed {
        let place = match origin(*from, ids, first) {
            BranchOrigin::Switch { branch, event } => format!("event {event} of branch {branch}"),
            _ => "a special point".to_owned(),
        };
        out.push(format!("no cycles could be followed from {place}: {error}"));
    }
    let unbounded = explored
        .branches
        .iter()
        .filter(|one| one.cycles.branch.stopped.reason == StopReason::PeriodUnbounded)
        .count();
    if unbounded > 0 {
        let what = points(unbounded, "branch of cycles", "branches of cycles");
        out.push(format!(
            "{what} came so close to where the period grows without bound that {parameter} no longer \
             changes: not followed further"
        ));
    }
    let early = explored.branches.iter().filter(|one| {
        let reason = one.cycles.branch.stopped.reason;
        !reason.is_complete()
            && !matches!(reason, StopReason::PeriodUnbounded | StopReason::Interrupted)
    });
    match early.count() {
        0 => {}
        n => out.push(format!(
            "{} ended early, see its own reason",
            points(n, "branch of cycles", "branches of cycles")
        )),
    }
    let doubtful = explored.branches.iter().filter(|one| !one.cycles.branch.is_certain()).count();
    if doubtful > 0 {
        let what = points(doubtful, "branch of cycles", "branches of cycles");
        out.push(format!("the counts of unstable multipliers of {what} are not certain"));
    }
    if !explored.deeper.is_empty() {
        let doublings = |from: &&CycleOrigin| matches!(from, CycleOrigin::Doubling { .. });
        let n = explored.deeper.iter().filter(doublings).count();
        let m = explored.deeper.len() - n;
        for (n, one, many) in [
            (n, "period doubling", "period doublings"),
            (
                m,
                "half branch at a branch point of cycles",
                "half branches at branch points of cycles",
            ),
        ] {
            if n > 0 {
                let what = points(n, one, many);
                out.push(format!("what leaves at {what} is deeper than diagram.cycle_depth"));
            }
        }
    }
    if !explored.tori.is_empty() {
        let what = points(explored.tori.len(), "Neimark-Sacker point", "Neimark-Sacker points");
        out.push(format!("the tori that leave at {what} are not followed"));
    }
    if !explored.unresolved.is_empty() {
        let n = explored.unresolved.len();
        let what = points(n, "branch point of cycles", "branch points of cycles");
        out.push(format!("at {what} it is not known which branches leave"));
    }
    if explored.full {
        out.push("the limit of branches was reached among the cycles".to_owned());
    }
    out
}

/// A branch of cycles as plain numbers: its points, and maximum and minimum of an observable and the
/// period over the parameter.
fn record(
    case: &ResolvedCase,
    cycles: &CycleBranch,
    observable: &str,
) -> (TraceResult, Curve, Curve) {
    let branch = &cycles.branch;
    let names: Vec<&str> = branch.observables.iter().map(String::as_str).collect();
    let further = ["certified", "trivial_error", "error"].map(str::to_owned).to_vec();
    let mut table = Table::general(&branch.parameter, &names).and(further);
    for (index, (point, cycle)) in branch.points.iter().zip(&cycles.cycles).enumerate() {
        let kind = point.event.map(|e| branch.events[e].kind.to_string()).unwrap_or_default();
        let mut row: Vec<Cell> = vec![index.into(), point.p.into()];
        row.extend(point.observables.iter().map(|&v| Cell::from(v)));
        row.extend([point.unstable.into(), kind.as_str().into()]);
        let certified = if point.certified { "yes" } else { "no" };
        row.push(if point.unstable.is_some() { certified.into() } else { Cell::Empty });
        row.extend([cycle.trivial_error.into(), cycle.error.into()]);
        table.push(row);
    }
    let observed =
        |k: usize| -> Vec<f64> { branch.points.iter().map(|point| point.observables[k]).collect() };
    let place = |name: &str| names.iter().position(|own| *own == name);
    let shown: Vec<Vec<f64>> = ["max", "min"]
        .iter()
        .filter_map(|what| place(&format!("{what}_{observable}")).map(observed))
        .collect();
    let curve = along(branch, observable, &shown);
    let periods: Vec<Vec<f64>> = place("period").map(observed).into_iter().collect();
    let period = along(branch, "period", &periods);
    let events = branch.events.iter().zip(&cycles.event_errors);
    let events = events.map(|(event, error)| {
        let point = &branch.points[event.point];
        let named = branch.observables.iter().cloned().zip(point.observables.iter().copied());
        EventRecord {
            kind: event.kind.to_string(),
            parameter: Some(event.p),
            unstable_before: event.unstable_before,
            unstable_after: event.unstable_after,
            residual: Some(event.residual),
            error_estimate: *error,
            observables: named.collect(),
            form: form(branch, event),
            cycle: cycles.cycles.get(event.point).map(of_point),
            ..EventRecord::default()
        }
    });
    let certain = branch.points.iter().any(|p| p.unstable.is_some()).then(|| branch.is_certain());
    let trace = TraceResult {
        case: case.name.clone(),
        parameter: branch.parameter.clone(),
        table,
        events: events.collect(),
        maxwell: None,
        stability: None,
        resolution: None,
        stopped_because: branch.stopped.reason,
        stopped_detail: branch.stopped.detail.clone(),
        points: branch.points.len(),
        certified: certain,
        newton_iterations: branch.statistics.newton_iterations,
        seconds: 0.0,
        shapes: Vec::new(),
        pictures: Pictures::default(),
    };
    (trace, curve, period)
}

fn of_point(point: &CyclePoint) -> CycleRecord {
    CycleRecord {
        period: point.cycle.period,
        period_error: point.period_error,
        multipliers: point.multipliers.clone(),
        trivial_error: point.trivial_error,
    }
}

/// Several quantities over the parameter as one curve, with gaps between them and where it is not known
/// whether the cycles are stable.
fn along(branch: &Branch, label: &str, quantities: &[Vec<f64>]) -> Curve {
    let mut curve = Curve { label: label.to_owned(), ..Curve::default() };
    for values in quantities {
        for (point, value) in branch.points.iter().zip(values) {
            curve.x.push(point.p);
            curve.y.push(if point.unstable.is_some() { *value } else { f64::NAN });
            curve.unstable.push(point.unstable.is_some_and(|n| n > 0));
        }
        curve.x.push(f64::NAN);
        curve.y.push(f64::NAN);
        curve.unstable.push(false);
        curve.marks.extend(branch.events.iter().map(|event| Mark {
            kind: event.kind.to_string(),
            x: branch.points[event.point].p,
            y: values[event.point],
        }));
    }
    curve
}

/// Why there are no cycles, in the case's words.
pub(super) fn refused(case: &ResolvedCase, error: CycleError) -> RunError {
    RunError::Orbits { case: case.name.clone(), error }
}
