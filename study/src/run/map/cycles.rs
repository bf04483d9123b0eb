//! Curves of special cycles: limit points and period doublings of those that leave the Hopf points of a base
//! branch, where the case asks for cycles.

use super::Task;
use super::curves::{Found, bounds, end, smooth};
use crate::record::{MapPoint, Table};
use crate::run::{Observer, listen};
use continuation::cycles::{
    CycleBranch, CycleCurve, CycleError, CycleSettings, SmallCycle, curve, trace,
};
use continuation::{Branch, Event, EventKind, Problem, Settings, StopReason};

/// The kinds of special cycles of which there are curves, and their names.
const KINDS: [(EventKind, &str); 2] =
    [(EventKind::Fold, "cycle-fold"), (EventKind::PeriodDoubling, "period-doubling")];
/// How near a curve has to come to a special cycle to pass through it: relative to the distance of its neighbouring
/// points, and relative to the range of the first parameter and the period.
const THROUGH: [f64; 2] = [0.1, 1e-6];

/// Follows the cycles from every Hopf point of `base`, and a curve through every special cycle that lies on none of
/// those before; also says why some cannot be followed. `at` is the second parameter's value on the base branch.
pub(super) fn curves<P: Problem>(
    problem: &P,
    base: &Branch,
    (task, at): (&Task<'_>, f64),
    observer: &mut Observer<'_>,
) -> (Vec<Found>, Vec<String>) {
    let (mut found, mut refused) = (Vec::new(), Vec::new());
    let mut known: Vec<(usize, CycleCurve)> = Vec::new();
    let cycles = CycleSettings::default();
    for hopf in base.events_of(&EventKind::Hopf) {
        let place = format!("{} = {:.8}", base.parameter, hopf.p);
        let branch = match branch(problem, base, hopf, (task, &cycles), observer) {
            Ok(branch) => branch,
            Err(error) => {
                refused.push(format!("no cycles from the Hopf point at {place}: {error}"));
                continue;
            }
        };
        let stopped = &branch.branch.stopped;
        let unbounded = stopped.reason == StopReason::PeriodUnbounded;
        if !(stopped.reason.is_complete() || unbounded) {
            refused.push(format!(
                "the cycles from the Hopf point at {place} end early ({}): {}",
                stopped.reason, stopped.detail
            ));
        }
        if let Some(doubt) = branch.branch.doubts.first() {
            refused.push(format!(
                "curves may be missing: on the cycles from the Hopf point at {place}, {} from {:.8} to {:.8}, {}",
                base.parameter, doubt.from, doubt.to, doubt.reason
            ));
        }
        for (number, (kind, name)) in KINDS.iter().enumerate() {
            for event in branch.branch.events_of(kind) {
                let passed = |(other, curve): &(usize, CycleCurve)| {
                    *other == number && passes(curve, &branch, event, at)
                };
                if known.iter().any(passed) {
                    continue;
                }
                let bounds = bounds(base, &task.case.path);
                let settings = settings(base, task);
                let followed = curve(
                    problem,
                    &branch,
                    event,
                    &task.key,
                    (&settings, &cycles),
                    Some((bounds[0], bounds[1])),
                    &mut listen(observer),
                );
                match followed {
                    Ok(curve) => {
                        found.push(plain(name, &curve, bounds));
                        let interrupted = [&curve.began, &curve.stopped]
                            .iter()
                            .any(|end| end.reason == StopReason::Interrupted);
                        known.push((number, curve));
                        if interrupted {
                            return (found, refused);
                        }
                    }
                    Err(error) => refused.push(format!(
                        "the {name} of cycles at {} = {:.8} starts no curve: {error}",
                        base.parameter, event.p
                    )),
                }
            }
        }
    }
    (found, refused)
}

/// The branch of cycles from a Hopf point, within the bounds of the map.
fn branch<P: Problem>(
    problem: &P,
    base: &Branch,
    hopf: &Event,
    (task, cycles): (&Task<'_>, &CycleSettings),
    observer: &mut Observer<'_>,
) -> Result<CycleBranch, CycleError> {
    let small = SmallCycle::at_hopf(problem, base, hopf, cycles)?;
    let bounds = bounds(base, &task.case.path);
    let settings = Settings {
        domain: Some((bounds[0], bounds[1])),
        increasing: Some(small.increasing),
        max_points: task.case.path.max_points,
        ..Settings::default()
    };
    let hear = &mut listen(observer);
    trace(problem, &base.parameter, &small.cycle, &settings, cycles, &[], hear)
}

fn settings(base: &Branch, task: &Task<'_>) -> Settings {
    let path = &task.case.path;
    let longest = path.max_step.or(smooth(base, task));
    Settings {
        domain: Some(task.range),
        max_step: longest.map(|x| x.max(path.min_step.unwrap_or(0.0))),
        min_step: path.min_step,
        max_points: path.max_points,
        ..Settings::default()
    }
}

/// Whether a curve passes through a special cycle, where the second parameter is `at`.
fn passes(curve: &CycleCurve, branch: &CycleBranch, event: &Event, at: f64) -> bool {
    let Some(cycle) = branch.cycles.get(event.point) else { return false };
    let firsts = branch.branch.points.iter().map(|point| (point.p - event.p).abs());
    let range = firsts.fold(0.0, f64::max);
    curve.points.windows(2).any(|pair| {
        let ([p, q], [r, s]) = (curve.at(&pair[0]), curve.at(&pair[1]));
        if (q - at) * (s - at) > 0.0 || q == s {
            return false;
        }
        let part = (at - q) / (s - q);
        let between = |x: f64, y: f64| x + part * (y - x);
        let [t, u] = [0, 1].map(|k| pair[k].cycle.period);
        let near = |x: f64, wanted: f64, apart: f64, size: f64| {
            (x - wanted).abs() <= THROUGH[0] * apart.abs() + THROUGH[1] * size
        };
        near(between(p, r), event.p, r - p, range)
            && near(between(t, u), cycle.cycle.period, u - t, cycle.cycle.period)
    })
}

fn plain(kind: &str, curve: &CycleCurve, bounds: [f64; 2]) -> Found {
    let [parameter, key] = &curve.parameters;
    let mut table = Table::with_columns(&["point", parameter, key, "period", "event"]);
    let places: Vec<[f64; 2]> = curve.points.iter().map(|point| curve.at(point)).collect();
    for (index, (point, [first, second])) in curve.points.iter().zip(&places).enumerate() {
        let event = point.event.and_then(|e| curve.events.get(e));
        let event = event.map(|event| event.kind.to_string()).unwrap_or_default();
        let period = point.cycle.period;
        table.push(vec![
            index.into(),
            (*first).into(),
            (*second).into(),
            period.into(),
            event.as_str().into(),
        ]);
    }
    let point = |event: &Event| MapPoint {
        kind: format!("cycle-{}", event.kind),
        curves: Vec::new(),
        first: places[event.point][0],
        second: places[event.point][1],
        observables: vec![("period".to_owned(), curve.points[event.point].cycle.period)],
        unstable_before: None,
        unstable_after: None,
        residual: event.residual,
        // that of the event leaves the collocation out
        error_estimate: None,
    };
    let (first, second): (Vec<f64>, Vec<f64>) = places.iter().map(|[p, q]| (*p, *q)).unzip();
    Found {
        kind: kind.to_owned(),
        points: curve.events.iter().map(point).collect(),
        table,
        began: end(&curve.began, first.first(), parameter, bounds),
        stopped: end(&curve.stopped, first.last(), parameter, bounds),
        first,
        second,
        newton_iterations: curve.newton_iterations,
    }
}
