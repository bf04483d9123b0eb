//! The states along curves that a report shows.

use super::two_plates::BetweenPlates;
use crate::record::{Outline, State};
use continuation::{Branch, Problem};
use shell_contact::{ContactProblem, RingLoadProblem};

/// Samples along the meridian from which the points of a report are chosen.
const FINE: usize = 601;
/// Points of a meridian in a report, and states in all, so that it stays a file to be sent about.
const OUTLINE: usize = 110;
const STATES: usize = 800;

/// Which of the `count` points of a curve are shown, in a report of `all` points: every one, or as
/// many as there is room for, the ends and those that are special.
pub(super) fn shown(
    count: usize,
    all: usize,
    special: impl Fn(usize) -> bool,
) -> impl Iterator<Item = usize> {
    let every = all.div_ceil(STATES).max(1);
    (0..count).filter(move |at| at % every == 0 || at + 1 == count || special(*at))
}

/// A shell between plates at a height; `None` where it is not admissible.
pub(super) fn between_plates(
    problem: &ContactProblem,
    point: usize,
    u: &[f64],
    plate: f64,
) -> Option<State> {
    let outline = meridian_between_plates(problem, u, plate)?;
    Some(State { point, plate, plate_below: None, outline: outline.thinned(OUTLINE) })
}

/// The meridian of a shell between plates at a height.
pub(super) fn meridian_between_plates(
    problem: &ContactProblem,
    u: &[f64],
    plate: f64,
) -> Option<Outline> {
    let parameters = problem.parameters_at(plate);
    let profile = problem.profile(u.get(..problem.dim())?, &parameters, FINE).ok()?;
    let (sigma, z) = (profile.sigma, profile.z);
    Some(Outline { sigma, z, pressure: profile.disjoining_pressure })
}

/// A shell from pole to pole between plates of their own; `None` where it is not admissible.
pub(super) fn from_pole_to_pole<P: BetweenPlates>(
    problem: &P,
    point: usize,
    u: &[f64],
    parameter: f64,
) -> Option<State> {
    let p = problem.parameters_at(parameter);
    let profile = problem.meridian(u, &p).ok()?;
    let [plate, below] = problem.heights(u, &p).ok()?;
    let outline =
        Outline { sigma: profile.sigma, z: profile.z, pressure: profile.disjoining_pressure };
    Some(State { point, plate, plate_below: Some(below), outline: outline.thinned(OUTLINE) })
}

/// The meridian of a ring-loaded shell at an angle in degrees.
pub(super) fn meridian_in_ring(
    problem: &RingLoadProblem,
    u: &[f64],
    degrees: f64,
) -> Option<Outline> {
    let parameters = problem.parameters_at(degrees.to_radians());
    let profile = problem.profile(u, &parameters, FINE).ok()?;
    Some(Outline { sigma: profile.sigma, z: profile.z, pressure: Vec::new() })
}

/// The states along a branch of the contact problem, for a report of `all` points.
pub(super) fn of_contact(problem: &ContactProblem, branch: &Branch, all: usize) -> Vec<State> {
    let points = &branch.points;
    let state = |at: usize| {
        let point = &points[at];
        // under a device the plate's distance is the last unknown
        let plate = point.u.get(problem.dim()).copied().unwrap_or(point.p);
        between_plates(problem, at, &point.u, plate)
    };
    shown(points.len(), all, |at| points[at].event.is_some()).filter_map(state).collect()
}

/// The same from pole to pole.
pub(super) fn of_two_plates<P: BetweenPlates>(
    problem: &P,
    branch: &Branch,
    all: usize,
) -> Vec<State> {
    let points = &branch.points;
    let state = |at: usize| from_pole_to_pole(problem, at, &points[at].u, points[at].p);
    shown(points.len(), all, |at| points[at].event.is_some()).filter_map(state).collect()
}

/// The same of a ring-loaded shell, whose angles are in degrees: there is no film.
pub(super) fn of_ring_load(problem: &RingLoadProblem, branch: &Branch, all: usize) -> Vec<State> {
    let points = &branch.points;
    let state = |at: usize| {
        let point = &points[at];
        let parameters = problem.parameters_at(point.p.to_radians());
        let outline = meridian_in_ring(problem, &point.u, point.p)?;
        let plate = problem.observation(&point.u, &parameters).ok()?.ring_height;
        Some(State { point: at, plate, plate_below: None, outline: outline.thinned(OUTLINE) })
    };
    shown(points.len(), all, |at| points[at].event.is_some()).filter_map(state).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_has_room_for_so_many_states() {
        assert_eq!(shown(5, 5, |_| false).count(), 5);
        let some: Vec<usize> = shown(8, 2 * STATES, |at| at == 3).collect();
        assert_eq!(some, [0, 2, 3, 4, 6, 7]);
        assert_eq!(shown(0, 0, |_| false).count(), 0);
    }
}
