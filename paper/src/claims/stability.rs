//! What is unstable along a branch: its own modes, those that break the mirror symmetry, and those
//! with waves around the axis. Nothing is known of a branch that was not scanned.

use crate::curve::Traced;
use continuation::EventKind;
use shell_contact::modes::Parity;

/// Numbers of unstable modes of every kind at the points between two deformations, from the zero of
/// the force on; none where a point was not scanned.
fn counts(traced: &Traced, from: f64, to: f64, after: usize) -> Option<Vec<usize>> {
    let points = &traced.branch.branch.points;
    let scans = &traced.scanned.as_ref()?.points;
    let inside = (after..points.len()).filter(|i| {
        let d = traced.branch.deformation(points[*i].p).unwrap_or(f64::NAN);
        (from..=to).contains(&d)
    });
    let count = |i: usize| {
        let scan = scans.get(i)?;
        Some(points[i].unstable? + scan.antisymmetric + scan.modes)
    };
    inside.map(count).collect()
}

/// Most unstable modes of every kind from the zero of the force to a deformation.
pub(super) fn most(traced: &Traced, to: f64) -> Option<f64> {
    let zero = EventKind::Zero("force".to_owned());
    let zero = traced.branch.branch.events_of(&zero).next()?.point;
    counts(traced, 0.0, to, zero)?.into_iter().max().map(|n| n as f64)
}

/// A loss of stability.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Loss {
    /// Deformation at which it begins.
    pub(super) from: f64,
    /// And at which it ends; none if that is not on the branch.
    pub(super) to: Option<f64>,
    /// Waves around the axis.
    pub(super) n: usize,
}

/// The losses that begin after a point of the branch, in order along it.
fn losses(traced: &Traced, after: usize) -> Option<Vec<Loss>> {
    let events = &traced.scanned.as_ref()?.events;
    let deformation = |z0: f64| traced.branch.deformation(z0);
    let mut losses = Vec::new();
    for (k, event) in events.iter().enumerate().filter(|(_, event)| event.after_point >= after) {
        if event.modes_before > 0 || event.modes_after == 0 {
            continue;
        }
        let class = |parity: Option<Parity>, n: usize| (n, parity) == (event.n, event.parity);
        let end = events[k..].iter().find(|e| class(e.parity, e.n) && e.modes_after == 0);
        let to = match end {
            Some(end) => Some(deformation(end.z0)?),
            None => None,
        };
        losses.push(Loss { from: deformation(event.z0)?, to, n: event.n });
    }
    Some(losses)
}

/// The first loss of the axisymmetric shape after the zero of the force.
pub(super) fn first_waves(traced: &Traced) -> Option<Loss> {
    let zero = EventKind::Zero("force".to_owned());
    let zero = traced.branch.branch.events_of(&zero).next()?.point;
    losses(traced, zero)?.into_iter().find(|loss| loss.n > 0)
}

/// A branch after its last fold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Buckled {
    /// Deformations between which the force falls.
    pub(super) falls: (f64, f64),
    /// Fewest unstable modes of every kind there.
    pub(super) fewest: f64,
    /// Deformations between which the mirror symmetry is lost.
    pub(super) mirror: (f64, f64),
    /// Where the first mode with waves becomes unstable, and how many it has.
    pub(super) waves: Loss,
}

impl Buckled {
    /// Share of the falling part on which the mirror symmetry is lost.
    pub(super) fn share(&self) -> f64 {
        let common = self.falls.1.min(self.mirror.1) - self.falls.0.max(self.mirror.0);
        common.max(0.0) / (self.falls.1 - self.falls.0)
    }
}

/// What happens after the last fold of a branch whose force rises and falls again there.
pub(super) fn buckled(traced: &Traced) -> Option<Buckled> {
    let branch = &traced.branch.branch;
    let fold = branch.events_of(&EventKind::Fold).last()?.point;
    let first = |kind: EventKind, after: usize| {
        branch.events_of(&kind).map(|event| event.point).find(|point| *point > after)
    };
    let top = first(EventKind::Maximum("force".to_owned()), fold)?;
    let bottom = first(EventKind::Minimum("force".to_owned()), top)?;
    let deformation = |point: usize| traced.branch.deformation(branch.points[point].p);
    let falls = (deformation(top)?, deformation(bottom)?);
    let losses = losses(traced, fold)?;
    let mirror = losses.iter().find(|loss| loss.n == 0)?;
    Some(Buckled {
        falls,
        fewest: counts(traced, falls.0, falls.1, top)?.into_iter().min()? as f64,
        mirror: (mirror.from, mirror.to?),
        waves: *losses.iter().find(|loss| loss.n > 0)?,
    })
}
