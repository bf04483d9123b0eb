//! What is measured on a branch.

use crate::curve::{State, Traced};
use continuation::EventKind;

/// Samples along the meridian.
const SAMPLES: usize = 801;
/// Half the distance over which a slope at a place is taken, in `R0`.
const NEAR: f64 = 1e-4;
/// Half the distance over which a power at a place is taken, as a share of the deformation.
const AROUND: f64 = 0.03;

/// Points of the branch in compression: deformation and reduced force, from the zero of the force.
pub(super) fn compression(traced: &Traced) -> Vec<(f64, f64)> {
    let points = &traced.branch.branch.points;
    (0..points.len())
        .map(|i| {
            let d = traced.branch.deformation(points[i].p).unwrap_or(f64::NAN);
            (d, traced.observable(i, "force"))
        })
        .filter(|(d, force)| *d >= 0.0 && *force >= 0.0)
        .collect()
}

/// Least slope, each over the largest one before it; `to` bounds the deformation.
pub(super) fn least_slope(traced: &Traced, to: f64) -> Option<f64> {
    let points = compression(traced);
    let (mut largest, mut least) = (0.0_f64, 1.0_f64);
    for pair in points.windows(2).filter(|pair| pair[1].0 <= to) {
        let slope = (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0);
        largest = largest.max(slope);
        if largest > 0.0 {
            least = least.min(slope / largest);
        }
    }
    (largest > 0.0).then_some(least)
}

/// Reduced force at a deformation, the first time.
pub(super) fn force(traced: &Traced, d: f64) -> Option<f64> {
    Some(traced.state(d, 1)?.observation.force)
}

/// `F̂/d̂` of the chord between two deformations.
pub(super) fn slope(traced: &Traced, from: f64, to: f64) -> Option<f64> {
    Some((force(traced, to)? - force(traced, from)?) / (to - from))
}

/// Slope `dF̂/dd̂` at the zero of the force: what counts as the linear response.
fn first_slope(traced: &Traced) -> Option<f64> {
    let at = |d: f64, pass: i32| Some(traced.state(d, pass)?.observation.force);
    Some((at(NEAR, 1)? - at(-NEAR, -1)?) / (2.0 * NEAR))
}

/// Power of the deformation with which the force grows at `d`.
pub(super) fn power(traced: &Traced, d: f64) -> Option<f64> {
    let around = [(1.0 - AROUND) * d, (1.0 + AROUND) * d];
    power_between(around.map(|d| Some((d, force(traced, d)?))))
}

/// The same of the deformation without a part of it.
pub(super) fn power_without(
    traced: &Traced,
    d: f64,
    part: impl Fn(f64) -> Option<f64>,
) -> Option<f64> {
    let around = [(1.0 - AROUND) * d, (1.0 + AROUND) * d];
    power_between(around.map(|d| Some((d - part(d)?, force(traced, d)?))))
}

/// By how much the film is thinner than at the zero of the force, where it is thinnest, in `R0`.
pub(super) fn film_share(traced: &Traced, d: f64) -> Option<f64> {
    let thinnest = |d: f64| {
        let profile = traced.profile(&traced.state(d, 1)?, SAMPLES)?;
        profile.delta.iter().copied().reduce(f64::min)
    };
    Some(thinnest(0.0)? - thinnest(d)?)
}

/// Force beyond the linear one at a deformation.
pub(super) fn beyond(traced: &Traced, d: f64) -> Option<f64> {
    Some(force(traced, d)? - first_slope(traced)? * d)
}

/// Power of the force beyond the linear one between two deformations.
pub(super) fn power_beyond(traced: &Traced, from: f64, to: f64) -> Option<f64> {
    power_between([from, to].map(|d| Some((d, beyond(traced, d)?))))
}

/// Power between two places of a curve.
fn power_between(places: [Option<(f64, f64)>; 2]) -> Option<f64> {
    let [Some((x0, y0)), Some((x1, y1))] = places else { return None };
    Some((y1 / y0).ln() / (x1 / x0).ln())
}

/// Where the slope has become `factor` times the first one.
pub(super) fn steeper(traced: &Traced, factor: f64) -> Option<f64> {
    let first = slope(traced, 0.0, 0.01)?;
    let points = compression(traced);
    points
        .windows(2)
        .find(|pair| (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0) > factor * first)
        .map(|pair| 0.5 * (pair[0].0 + pair[1].0))
}

/// Number of folds.
pub(super) fn folds(traced: &Traced) -> Option<f64> {
    complete(traced).then(|| traced.branch.branch.events_of(&EventKind::Fold).count() as f64)
}

/// Deformation and force at a fold.
pub(super) fn fold(traced: &Traced, which: usize) -> Option<(f64, f64)> {
    let event = traced.branch.branch.events_of(&EventKind::Fold).nth(which)?;
    Some((traced.branch.deformation(event.p)?, traced.observable(event.point, "force")))
}

/// The most attractive force.
pub(super) fn pull_off(traced: &Traced) -> Option<f64> {
    let kind = EventKind::Named(shell_contact::trace::PULL_OFF.to_owned());
    let event = traced.branch.branch.events_of(&kind).next()?;
    Some(traced.observable(event.point, "force"))
}

/// How far the pole lies below the highest point, in `R0`.
pub(super) fn dimple(traced: &Traced, d: f64) -> Option<f64> {
    let state = traced.state(d, 1)?;
    let profile = traced.profile(&state, SAMPLES)?;
    let highest = profile.z.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    Some(highest - profile.z.first()?)
}

/// Disjoining pressure at the pole over the largest one, and where that is.
pub(super) fn pressure(traced: &Traced, d: f64) -> Option<(f64, f64)> {
    let state = traced.state(d, 1)?;
    let profile = traced.profile(&state, SAMPLES)?;
    let all = &profile.disjoining_pressure;
    let top = (0..all.len()).max_by(|&i, &j| all[i].total_cmp(&all[j]))?;
    Some((all.first()? / all[top], profile.sigma[top]))
}

/// A ratio of parts of the energy.
pub(super) fn energies(traced: &Traced, d: f64, ratio: fn(&State) -> f64) -> Option<f64> {
    Some(ratio(&traced.state(d, 1)?))
}

/// Whether the branch was traced to its end.
pub(super) fn complete(traced: &Traced) -> bool {
    traced.branch.branch.is_complete()
}
