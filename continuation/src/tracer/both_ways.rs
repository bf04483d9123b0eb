//! A branch that is known from a solution somewhere on it, followed both ways.

use super::Tracer;
use super::input::{Progress, TraceError, increases};
use crate::any_problem::DynProblem;
use crate::branch::{Branch, Detail, Event, Stop, StopReason};
use crate::events::Watch;
use crate::problem::Problem;
use crate::settings::Settings;
use std::ops::ControlFlow;

/// Traces the branch through the solution near `u` both ways, as one branch from end to end.
///
/// At the start the branch goes the way that [`Tracer::new`] would take; that half is traced first,
/// then the other one. All is given along the whole: arclengths count from the first point, events
/// and tangents have the branch's direction. [`Branch::stopped`] says why it ends at the last point,
/// [`Branch::began`] why at the first. A closed loop is traced once and begins at the start; both
/// ends then say so. [`Settings::max_points`] bounds each half.
///
/// The observer counts the points of both halves; `s` is the length of branch traced so far. If it
/// stops the first half there is no second one.
///
/// ```
/// use continuation::{EventKind, Settings, both_ways, samples::Cusp};
/// use std::ops::ControlFlow;
///
/// // the middle sheet of μ + x − x³ = 0, between μ = −1 and 1
/// let settings = Settings { domain: Some((-1.0, 1.0)), ..Settings::default() };
/// let branch = both_ways(&Cusp, "mu", &[0.1], &[0.0, 1.0], settings, &[], &mut |_| {
///     ControlFlow::Continue(())
/// })?;
/// let ends = [branch.points.first(), branch.points.last()].map(|end| end.map(|point| point.p));
/// assert_eq!(ends, [Some(1.0), Some(-1.0)]);
/// assert_eq!(branch.events_of(&EventKind::Fold).count(), 2);
/// assert!(branch.points.windows(2).all(|pair| pair[0].s < pair[1].s));
/// # Ok::<(), continuation::TraceError>(())
/// ```
///
/// # Errors
/// As for [`Tracer::new`] and [`Tracer::watching`].
pub fn both_ways<P: Problem>(
    problem: &P,
    parameter: &str,
    u: &[f64],
    p: &[f64],
    settings: Settings,
    watches: &[Watch],
    observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<Branch, TraceError> {
    both(problem, parameter, (u, p), settings, watches, observer)
}

/// [`both_ways`] of a problem of unknown type.
pub(crate) fn both<'a>(
    problem: &'a DynProblem<'a>,
    parameter: &str,
    (u, p): (&[f64], &[f64]),
    settings: Settings,
    watches: &[Watch],
    observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<Branch, TraceError> {
    let mut first = Tracer::of(problem, parameter, u, p, settings.clone())?.watching(watches)?;
    let increasing = increases(&settings, p[first.core.which.0]);
    let points = first.exhaust(observer);
    let (s, events, count) = (first.s, first.events.len(), points.len());
    let end = first.current.clone();
    let mut ahead = first.into_branch(points);
    match ahead.stopped.reason {
        StopReason::ClosedLoop => {
            ahead.began = Some(ahead.stopped.clone());
            return Ok(ahead);
        }
        StopReason::Interrupted => {
            let detail = "interrupted before the other direction was traced".to_owned();
            ahead.began = Some(Stop { reason: StopReason::Interrupted, detail });
            return Ok(ahead);
        }
        _ => {}
    }
    // from the same state to the last bit, so that the tangent is the same but for its sign
    let settings = Settings { increasing: Some(!increasing), ..settings };
    let mut second = Tracer::of(problem, parameter, u, p, settings)?.watching(watches)?;
    if ahead.stopped.reason == StopReason::MaxPoints {
        second.finish = Some(end);
    }
    let points = second.exhaust(&mut |at| {
        let (points, events) = (at.points + count, at.events + events);
        observer(&Progress { points, events, p: at.p, s: at.s + s })
    });
    let back = second.into_branch(points);
    if back.stopped.reason == StopReason::ClosedLoop {
        ahead.stopped = back.stopped.clone();
    }
    Ok(join(back, ahead))
}

/// One branch of two that begin at the same point: the first one reversed, then the second.
fn join(mut back: Branch, mut ahead: Branch) -> Branch {
    // a special point at the start is found by both halves
    if ahead.points.first().is_some_and(|point| point.event.is_some())
        && back.points.first().is_some_and(|point| point.event.is_some())
    {
        ahead.events.remove(0);
        ahead.points[0].event = None;
        for point in &mut ahead.points {
            point.event = point.event.map(|event| event - 1);
        }
    }
    reverse(&mut back);
    let (points, events) = (back.points.len(), back.events.len());
    let length = back.points.last().map_or(0.0, |point| point.s);
    back.points.extend(ahead.points.into_iter().skip(1).map(|mut point| {
        point.s += length;
        point.event = point.event.map(|event| events + event);
        point
    }));
    back.events.extend(ahead.events.into_iter().map(|mut event| {
        event.point += points - 1;
        event
    }));
    back.doubts.extend(ahead.doubts);
    let (total, more) = (&mut back.statistics, ahead.statistics);
    total.newton_iterations += more.newton_iterations;
    total.accepted += more.accepted;
    total.rejected += more.rejected;
    back.began = Some(std::mem::replace(&mut back.stopped, ahead.stopped));
    back
}

/// The same points from the last to the first.
fn reverse(branch: &mut Branch) {
    let (points, events) = (branch.points.len(), branch.events.len());
    let length = branch.points.last().map_or(0.0, |point| point.s);
    branch.points.reverse();
    for point in &mut branch.points {
        point.s = length - point.s;
        point.dp_ds = -point.dp_ds;
        point.event = point.event.map(|event| events - 1 - event);
    }
    branch.doubts.reverse();
    for doubt in &mut branch.doubts {
        std::mem::swap(&mut doubt.from, &mut doubt.to);
    }
    branch.events.reverse();
    for event in &mut branch.events {
        event.point = points - 1 - event.point;
        turn(event);
    }
}

/// An event seen from the other side.
fn turn(event: &mut Event) {
    std::mem::swap(&mut event.unstable_before, &mut event.unstable_after);
    if let Detail::Crossing(crossing) = &mut event.detail {
        let traced = &mut crossing.traced;
        traced.du.iter_mut().for_each(|x| *x = -*x);
        traced.dp = -traced.dp;
    }
}
