//! One curve from the two halves that were traced from its start.

use super::{CycleCurve, CycleCurvePoint, Half, SpecialCycles};
use crate::branch::Event;

/// Errors of a cusp within which a neighbour does not tell whether a parameter turns.
const APART: f64 = 1e2;

/// Both halves as one curve, the first one backwards.
pub(super) fn join(
    back: Half,
    forward: Half,
    (kind, parameters, indices): (SpecialCycles, [String; 2], [usize; 2]),
) -> CycleCurve {
    let length = back.points.last().map_or(0.0, |point| point.s);
    let (old, count) = (back.events.len(), back.points.len());
    let mut points: Vec<CycleCurvePoint> = back.points.into_iter().rev().collect();
    points.iter_mut().for_each(|point| point.s = length - point.s);
    let mut events: Vec<Event> = back.events;
    events.iter_mut().for_each(|event| event.point = count - 1 - event.point);
    // the start belongs to both
    points.extend(forward.points.into_iter().skip(1).map(|mut point| {
        point.s += length;
        point.event = point.event.map(|e| e + old);
        point
    }));
    events.extend(forward.events.into_iter().map(|mut event| {
        event.point += count - 1;
        event
    }));
    let (began, stopped) = (back.stopped, forward.stopped);
    let newton_iterations = 0;
    CycleCurve { kind, parameters, points, events, began, stopped, newton_iterations, indices }
}

/// Drops zeros of the cusp's test at which neither parameter turns.
pub(super) fn confirm_cusps(curve: &mut CycleCurve) {
    for index in (0..curve.events.len()).rev() {
        let event = &curve.events[index];
        let at = &curve.points[event.point];
        let apart =
            |other: &&CycleCurvePoint| (other.s - at.s).abs() > APART * event.error_estimate;
        let before = curve.points[..event.point].iter().rev().find(apart);
        let after = curve.points[event.point + 1..].iter().find(apart);
        let (Some(before), Some(after)) = (before, after) else { continue };
        let [x, y, z] = [before, at, after].map(|point| curve.at(point));
        if (0..2).any(|k| (x[k] - y[k]) * (z[k] - y[k]) >= 0.0) {
            continue;
        }
        curve.events.remove(index);
        for point in &mut curve.points {
            point.event = match point.event {
                Some(e) if e == index => None,
                Some(e) if e > index => Some(e - 1),
                other => other,
            };
        }
    }
}
