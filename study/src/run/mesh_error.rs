//! How far the mesh moves a contact branch and its special points.

use super::resolution::height;
use crate::record::{MeshErrorRecord, PlaceError};
use shell_contact::discretisation::{Refined, Shift};
use shell_contact::{ContactBranch, ContactProblem};

/// Points of a branch that are looked at beside its special points.
const SAMPLES: usize = 12;

/// Estimates of the mesh's error along a branch in `z0`.
pub(super) struct MeshErrors {
    events: Vec<Option<PlaceError>>,
    record: Option<MeshErrorRecord>,
}

impl MeshErrors {
    /// Nothing is known.
    pub(super) fn unknown() -> MeshErrors {
        MeshErrors { events: Vec::new(), record: None }
    }

    /// Of a branch. Under a device nothing is known of special points, whose places are in its parameter.
    pub(super) fn of(problem: &ContactProblem, traced: &ContactBranch) -> MeshErrors {
        let branch = &traced.branch;
        let Ok(mut refined) = Refined::new(problem) else { return MeshErrors::unknown() };
        let (height, n) = (height(branch), problem.mesh().unknowns());
        let mut look = |index: usize, kind| {
            let point = &branch.points[index];
            // beside the edge of the model the finer shell may be outside: then nothing is known
            let (u, parameters) = (&point.u[..n], problem.parameters_at(height(point)));
            refined.shift(u, &parameters, kind).ok().flatten()
        };
        let held = branch.parameter == "z0";
        let found = branch.events.iter().filter(|_| held);
        let found = found.map(|event| look(event.point, Some(&event.kind)));
        let events: Vec<Option<PlaceError>> =
            found.map(|shift| shift.map(|s| PlaceError { z0: s.z0, force: s.force })).collect();
        let ordinary: Vec<usize> =
            (0..branch.points.len()).filter(|&i| branch.points[i].event.is_none()).collect();
        let last = ordinary.len().saturating_sub(1);
        // both ends among them: the error often is the largest at one
        let mut samples: Vec<usize> =
            (0..SAMPLES).filter_map(|k| ordinary.get(k * last / (SAMPLES - 1)).copied()).collect();
        samples.dedup();
        let (forces, heights) =
            (span(traced, |i| force(traced, i)), span(traced, |i| height(&branch.points[i])));
        let mut worst: Option<(f64, usize)> = None;
        let mut looked_at = 0;
        for index in samples {
            let Some(shift) = look(index, None) else { continue };
            // on a steep part the height at a given force is what is off
            let error = least(shift, forces / heights);
            looked_at += usize::from(error.is_finite());
            if error.is_finite() && worst.is_none_or(|(most, _)| error > most) {
                worst = Some((error, index));
            }
        }
        let known = || events.iter().flatten();
        let places = known().filter_map(|event| event.z0);
        let extremes = known().filter_map(|event| event.force);
        let record = worst.map(|(force, index)| MeshErrorRecord {
            force,
            at: height(&branch.points[index]),
            z0: places.max_by(f64::total_cmp),
            extremum: extremes.max_by(f64::total_cmp),
            samples: looked_at,
        });
        MeshErrors { events, record }
    }

    /// What is known of a special point.
    pub(super) fn event(&self, number: usize) -> Option<PlaceError> {
        self.events.get(number).copied().flatten()
    }

    /// The worst along the branch.
    pub(super) fn record(&self) -> Option<MeshErrorRecord> {
        self.record
    }
}

/// The error of the force at the same height, or that of the height at the same force in its scale.
fn least(shift: Shift, per_height: f64) -> f64 {
    let of = |x: Option<f64>, scale: f64| x.map_or(f64::INFINITY, |x| x * scale);
    of(shift.force, 1.0).min(of(shift.z0, per_height))
}

fn force(traced: &ContactBranch, index: usize) -> f64 {
    let at = traced.branch.observables.iter().position(|name| name == "force");
    at.map_or(f64::NAN, |k| traced.branch.points[index].observables[k])
}

/// Difference of the largest and the smallest value along the branch.
fn span(traced: &ContactBranch, value: impl Fn(usize) -> f64) -> f64 {
    let values = || (0..traced.branch.points.len()).map(&value);
    values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
}
