//! The curves that begin on one base branch.

use super::Task;
use crate::case::{PathCase, ProblemCase};
use crate::record::{MapPoint, PLATES, Table};
use crate::run::{Observer, listen};
use continuation::codim2::{BranchPointCurve, Curve, CurveError, FoldCurve, HopfCurve};
use continuation::{Branch, Event, EventKind, Problem, Settings, Stop, StopReason, Watch};

/// How near, relative to the ranges along the base branch, a curve has to come to a special point
/// to pass through it.
const THROUGH: f64 = 1e-5;
/// Observable of a curve of Hopf points that is worth a column.
const OMEGA: &str = "omega";

/// A curve as plain numbers.
pub(super) struct Found {
    pub(super) kind: String,
    pub(super) table: Table,
    /// Values of the second and of the first parameter.
    pub(super) second: Vec<f64>,
    pub(super) first: Vec<f64>,
    pub(super) points: Vec<MapPoint>,
    pub(super) began: Stop,
    pub(super) stopped: Stop,
    pub(super) newton_iterations: usize,
}

/// The kinds of special points of which there are curves; which of them are worth a search.
const KINDS: [EventKind; 3] = [EventKind::Fold, EventKind::Hopf, EventKind::BranchPoint];

/// Traces a curve through every special point of `base` that lies on none of those before; also
/// says why some cannot be traced.
pub(super) fn curves<P: Problem>(
    problem: &P,
    base: &Branch,
    task: &Task<'_>,
    observer: &mut Observer<'_>,
) -> (Vec<Found>, Vec<String>) {
    let (mut found, mut refused) = (Vec::new(), Vec::new());
    if base.stopped.reason == StopReason::Interrupted {
        return (found, refused);
    }
    for kind in KINDS {
        let mut known: Vec<Curve> = Vec::new();
        for event in base.events_of(&kind) {
            if known.iter().any(|curve| passes(problem, curve, base, event)) {
                continue;
            }
            let interrupted = |found: &Found| !may_go_on(found);
            if found.last().is_some_and(interrupted) {
                return (found, refused);
            }
            match trace(problem, base, event, task, observer) {
                // a branch point that does not persist is no curve
                Ok(curve) if kind == EventKind::BranchPoint && !persists(&curve) => {}
                Ok(curve) => {
                    found.push(plain(
                        problem,
                        &kind,
                        &curve,
                        &base.parameter,
                        (task, bounds(base, &task.case.path)),
                    ));
                    known.push(curve);
                }
                Err(error) => refused.push(format!(
                    "the {kind} at {} = {:.8} starts no curve: {error}",
                    base.parameter, event.p
                )),
            }
        }
    }
    (found, refused)
}

pub(super) fn may_go_on(found: &Found) -> bool {
    ![&found.began, &found.stopped].iter().any(|end| end.reason == StopReason::Interrupted)
}

fn persists(curve: &Curve) -> bool {
    let ends = [&curve.first_end, &curve.branch.stopped];
    !ends.iter().any(|end| end.detail.contains("does not persist"))
}

fn trace<P: Problem>(
    problem: &P,
    base: &Branch,
    event: &Event,
    task: &Task<'_>,
    observer: &mut Observer<'_>,
) -> Result<Curve, CurveError> {
    let path = &task.case.path;
    let settings = Settings {
        domain: Some(task.range),
        max_step: path.max_step.or(smooth(base, task)).map(|x| x.max(path.min_step.unwrap_or(0.0))),
        min_step: path.min_step,
        max_points: path.max_points,
        ..Settings::default()
    };
    let bounds = bounds(base, path);
    let stop = |at: &f64| Watch::stop_at(&base.parameter, *at);
    let mut watches: Vec<Watch> = bounds.iter().map(stop).collect();
    // where the curve comes back to the base branch
    let position = problem.parameters().iter().position(|q| q.name == task.key);
    if let Some(value) = position.and_then(|k| base.parameters.get(k)) {
        watches.push(Watch::parameter(*value));
    }
    let (key, hear) = (task.key.as_str(), &mut listen(observer));
    match event.kind {
        EventKind::Hopf => {
            HopfCurve::at(problem, base, event, key)?.trace(&settings, &watches, hear)
        }
        EventKind::BranchPoint => {
            BranchPointCurve::at(problem, base, event, key)?.trace(&settings, &watches, hear)
        }
        _ => FoldCurve::at(problem, base, event, key)?.trace(&settings, &watches, hear),
    }
}

/// Bounds of the first parameter, the same for all curves: those of the path; where a special
/// point lies beyond them, where the branch went, with as much room again on either side.
pub(super) fn bounds(base: &Branch, path: &PathCase) -> [f64; 2] {
    let (low, high) = (path.start.min(path.end), path.start.max(path.end));
    let special = |event: &&Event| {
        matches!(event.kind, EventKind::Fold | EventKind::Hopf | EventKind::BranchPoint)
    };
    let mut special = base.events.iter().filter(special);
    if special.all(|event| low < event.p && event.p < high) {
        return [low, high];
    }
    let values = base.points.iter().map(|point| point.p);
    let (low, high) = values.fold((low, high), |(low, high), p| (low.min(p), high.max(p)));
    [low - (high - low), high + (high - low)]
}

/// Longest step by default: short enough for curves that look smooth, and not so short that the
/// range of the second parameter takes more than a hundred of them.
pub(super) fn smooth(base: &Branch, task: &Task<'_>) -> Option<f64> {
    let length = base.points.last().map_or(0.0, |point| point.s);
    let step = (length / 60.0).max((task.range.1 - task.range.0) / 100.0);
    (step.is_finite() && step > 0.0).then_some(step)
}

/// Why a curve ends, said for the bound of the path too.
pub(super) fn end(stop: &Stop, first: Option<&f64>, parameter: &str, bounds: [f64; 2]) -> Stop {
    let near = |at: &f64| bounds.iter().any(|x| (x - at).abs() <= 1e-9 * (1.0 + x.abs()));
    if stop.reason == StopReason::Target && first.is_some_and(near) {
        let detail = format!("{parameter} reached its bound");
        return Stop { reason: StopReason::Domain, detail };
    }
    stop.clone()
}

/// Whether a curve passes through a special point of the base branch.
fn passes<P: Problem>(problem: &P, curve: &Curve, base: &Branch, event: &Event) -> bool {
    let n = problem.dim();
    let Some(at) = base.points.get(event.point) else { return false };
    let mut scratch = vec![0.0; n];
    let mut apart = |a: &[f64], b: &[f64]| {
        let d: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
        problem.metric(&d, &mut scratch);
        d.iter().zip(&scratch).map(|(d, m)| d * m).sum::<f64>().max(0.0).sqrt()
    };
    let (mut unknowns, mut parameter) = (0.0_f64, 0.0_f64);
    for point in &base.points {
        unknowns = unknowns.max(apart(&point.u, &at.u));
        parameter = parameter.max((point.p - at.p).abs());
    }
    let Some(first) = curve.column(&base.parameter) else { return false };
    let landings = curve.branch.events.iter().filter(|e| e.kind == EventKind::Target);
    landings.map(|e| (&curve.branch.points[e.point], first[e.point])).any(|(point, first)| {
        (first - at.p).abs() <= THROUGH * parameter
            && apart(&point.u[..n], &at.u) <= THROUGH.sqrt() * unknowns
    })
}

/// Whether an event of a curve is a special point, and no landing or bound.
fn is_special(kind: &EventKind) -> bool {
    matches!(
        kind,
        EventKind::Cusp
            | EventKind::BogdanovTakens
            | EventKind::ZeroHopf
            | EventKind::GeneralisedHopf
            | EventKind::DoubleHopf
            | EventKind::BranchPoint
    )
}

fn plain<P: Problem>(
    problem: &P,
    kind: &EventKind,
    curve: &Curve,
    parameter: &str,
    (task, bounds): (&Task<'_>, [f64; 2]),
) -> Found {
    let key = task.key.as_str();
    let branch = &curve.branch;
    let column = |name: &str| curve.column(name).unwrap_or_default();
    let (first, second) = (column(parameter), column(key));
    let own = problem.observables().iter().map(|name| &name[..]);
    let names: Vec<&str> =
        own.chain([OMEGA].into_iter().filter(|_| *kind == EventKind::Hopf)).collect();
    let columns: Vec<Vec<f64>> = names.iter().map(|name| column(name)).collect();
    let titles = ["point", parameter, key].into_iter().chain(names.iter().copied());
    let titles: Vec<&str> = titles.chain(["unstable", "event"]).collect();
    let mut table = Table::with_columns(&titles);
    if matches!(task.case.problem, ProblemCase::Contact(_) | ProblemCase::TwoPlates(_)) {
        table = table.described(PLATES);
    }
    for (index, point) in branch.points.iter().enumerate() {
        let event = point.event.map(|e| &branch.events[e].kind).filter(|kind| is_special(kind));
        let mut row = vec![index.into(), first[index].into(), second[index].into()];
        row.extend(columns.iter().map(|values| values[index].into()));
        let event = event.map(ToString::to_string).unwrap_or_default();
        row.extend([point.unstable.into(), event.as_str().into()]);
        table.push(row);
    }
    let special = branch.events.iter().filter(|event| is_special(&event.kind));
    let points = special.map(|event| {
        let at = event.point;
        let values = names.iter().zip(&columns).map(|(name, x)| ((*name).to_string(), x[at]));
        MapPoint {
            kind: event.kind.to_string(),
            curves: Vec::new(),
            first: first[at],
            second: second[at],
            observables: values.collect(),
            unstable_before: event.unstable_before,
            unstable_after: event.unstable_after,
            residual: event.residual,
            error_estimate: Some(event.error_estimate),
        }
    });
    Found {
        kind: kind.to_string(),
        points: points.collect(),
        table,
        second,
        began: end(&curve.first_end, first.first(), parameter, bounds),
        stopped: end(&branch.stopped, first.last(), parameter, bounds),
        first,
        newton_iterations: branch.statistics.newton_iterations,
    }
}
