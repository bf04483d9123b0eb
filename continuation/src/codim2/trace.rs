//! A curve of special points, traced both ways and ordered from end to end.

use super::underlying::CurveError;
use crate::branch::{Branch, Stop, StopReason};
use crate::events::Watch;
use crate::problem::Problem;
use crate::settings::Settings;
use crate::tracer::{Progress, Tracer};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// A curve of special points in two parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// The points from one end to the other: [`Branch::parameter`] is the second parameter, the
    /// first one is the first of the observables, by its name, and the last unknown.
    /// [`Branch::stopped`] says why the curve ends at the last point.
    pub branch: Branch,
    /// Why it ends at the first point; for a closed loop the same as `branch.stopped`.
    pub first_end: Stop,
}

impl Curve {
    /// The values of the named observable, or of the second parameter, at every point.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let points = self.branch.points.iter();
        if name == self.branch.parameter {
            return Some(points.map(|point| point.p).collect());
        }
        let k = self.branch.observables.iter().position(|o| o == name)?;
        Some(points.map(|point| point.observables[k]).collect())
    }
}

/// Traces `problem` both ways from `(u, p)`.
pub(super) fn trace<P: Problem>(
    problem: &P,
    (second, u, p): (&str, &[f64], &[f64]),
    settings: &Settings,
    watches: &[Watch],
    observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<Curve, CurveError> {
    let mut run = |increasing, offset: Option<&Branch>| -> Result<Branch, CurveError> {
        let settings = Settings { increasing: Some(increasing), ..settings.clone() };
        let tracer = Tracer::new(problem, second, u, p, settings)?.watching(watches)?;
        let (points, events) = offset.map_or((0, 0), |b| (b.points.len(), b.events.len()));
        Ok(tracer.run(&mut |at| {
            let (points, events) = (at.points + points, at.events + events);
            observer(&Progress { points, events, ..*at })
        }))
    };
    let forward = run(true, None)?;
    if matches!(forward.stopped.reason, StopReason::ClosedLoop | StopReason::Interrupted) {
        let first_end = forward.stopped.clone();
        return Ok(Curve { branch: forward, first_end });
    }
    let backward = run(false, Some(&forward))?;
    Ok(join(backward, forward))
}

/// One curve of two that begin at the same point: the first one reversed, then the second.
fn join(mut back: Branch, mut ahead: Branch) -> Curve {
    let (points, events) = (back.points.len(), back.events.len());
    let length = back.points.last().map_or(0.0, |point| point.s);
    back.points.reverse();
    for point in &mut back.points {
        point.s = length - point.s;
        point.dp_ds = -point.dp_ds;
        point.event = point.event.map(|event| events - 1 - event);
    }
    back.events.reverse();
    for event in &mut back.events {
        event.point = points - 1 - event.point;
        std::mem::swap(&mut event.unstable_before, &mut event.unstable_after);
    }
    for mut point in ahead.points.drain(..).skip(1) {
        point.s += length;
        point.event = point.event.map(|event| events + event);
        back.points.push(point);
    }
    for mut event in ahead.events.drain(..) {
        event.point += points - 1;
        back.events.push(event);
    }
    back.statistics.newton_iterations += ahead.statistics.newton_iterations;
    back.statistics.accepted += ahead.statistics.accepted;
    back.statistics.rejected += ahead.statistics.rejected;
    let first_end = std::mem::replace(&mut back.stopped, ahead.stopped);
    Curve { branch: back, first_end }
}
