//! A curve of special points, traced both ways and ordered from end to end.

use super::underlying::CurveError;
use crate::any_problem::DynProblem;
use crate::branch::{Branch, Stop};
use crate::events::Watch;
use crate::settings::Settings;
use crate::tracer::{Progress, both};
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

    /// Removes an event that only marks where the trace was to end.
    pub(super) fn forget(&mut self, event: usize) {
        self.branch.events.remove(event);
        for point in &mut self.branch.points {
            point.event = match point.event {
                Some(e) if e == event => None,
                Some(e) if e > event => Some(e - 1),
                other => other,
            };
        }
    }
}

/// Traces `problem` both ways from `(u, p)`.
pub(super) fn trace(
    problem: &DynProblem<'_>,
    (second, u, p): (&str, &[f64], &[f64]),
    settings: &Settings,
    watches: &[Watch],
    observer: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
) -> Result<Curve, CurveError> {
    let settings = Settings { increasing: Some(true), ..settings.clone() };
    let branch = both(problem, second, (u, p), settings, watches, observer)?;
    let first_end = branch.began.clone().unwrap_or_else(|| branch.stopped.clone());
    Ok(Curve { branch, first_end })
}
