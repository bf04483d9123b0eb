//! One branch of a diagram.

use super::joints::Joints;
use crate::any_problem::DynProblem;
use crate::branch::{Branch, EventKind, Point, StopReason};
use crate::tracer::{Progress, Snapshot, Tracer};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// A branch that is not finished: its points so far, and where its trace stands.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Part {
    pub(super) points: Vec<Point>,
    pub(super) state: Snapshot,
}

/// Told of every point, and offered a copy of the trace as it stands; may stop it.
pub(super) type Listener<'o> =
    dyn FnMut(&Progress, Option<&dyn Fn() -> Part>) -> ControlFlow<()> + 'o;

/// Traces to the end from the beginning or from `part`, or to a joint from which the branch would go on along a ray that is taken.
pub(super) fn follow(
    problem: &DynProblem<'_>,
    mut tracer: Tracer<'_>,
    part: Option<Part>,
    joints: &Joints,
    observer: &mut Listener<'_>,
) -> Branch {
    let mut points: Vec<Point> = Vec::new();
    if let Some(part) = part.filter(|part| tracer.fits(&part.state)) {
        points = part.points;
        tracer.restore(part.state);
    }
    let mut interrupted = false;
    while let Some(point) = tracer.next() {
        let known =
            point.event.filter(|event| leads_back(problem, &tracer, *event, &point, joints));
        let progress = Progress {
            points: points.len() + 1,
            events: tracer.events().len(),
            p: point.p,
            s: point.s,
        };
        points.push(point);
        if let Some(event) = known {
            let detail = "the branch goes on as one that is known already".to_owned();
            tracer.cut(event + 1, StopReason::Retraced, detail);
            break;
        }
        let copy = || Part { points: points.clone(), state: tracer.snapshot() };
        if !interrupted && observer(&progress, Some(&copy)).is_break() {
            interrupted = true;
            tracer.interrupt();
        }
    }
    tracer.into_branch(points)
}

/// Whether the branch goes on from this point along a ray that is taken.
fn leads_back(
    problem: &DynProblem<'_>,
    tracer: &Tracer<'_>,
    event: usize,
    point: &Point,
    joints: &Joints,
) -> bool {
    let event = &tracer.events()[event];
    let Some(crossing) = event.crossing().filter(|_| event.kind == EventKind::BranchPoint) else {
        return false;
    };
    let Some(node) = joints.find(problem, &point.u, event.p, event.error_estimate) else {
        return false;
    };
    let traced = (&crossing.traced.du[..], crossing.traced.dp);
    let ahead = joints.ray(problem, node, traced, 1.0);
    ahead.is_some_and(|ray| joints.nodes[node].rays[ray].taken)
}
