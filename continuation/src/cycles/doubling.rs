//! To which side doubled cycles lie: the normal form of a period doubling.
//!
//! Doubled cycles are solved for at three small amplitudes `ε`, and `(p − p₀)/ε²` is extrapolated to zero.
//! Its error is what an extrapolation with the located `p₀` and one without it differ by, and rounding.

use super::birth::{correct, depart, twice};
use super::cycle::Cycle;
use super::trace::CycleBranch;
use crate::any_problem::DynProblem;
use crate::branch::{Criticality, Detail, DoublingForm, EventKind};
use crate::problem::ParamId;

/// Errors by which the curvature must differ from 0 for a criticality to be claimed.
const CLEAR: f64 = 3.0;
/// Relative rounding of the parameter at a corrected cycle.
const ROUNDING: f64 = 1e-12;

/// Adds their forms to the period doublings of a branch.
pub(super) fn add_forms(problem: &DynProblem<'_>, which: ParamId, branch: &mut CycleBranch) {
    for at in 0..branch.branch.events.len() {
        if branch.branch.events[at].kind == EventKind::PeriodDoubling
            && let Some(form) = form(problem, which, branch, at)
        {
            branch.branch.events[at].detail = Detail::Doubling(form);
        }
    }
}

fn form(
    problem: &DynProblem<'_>,
    which: ParamId,
    branch: &CycleBranch,
    at: usize,
) -> Option<DoublingForm> {
    let event = &branch.branch.events[at];
    let known = branch.cycles.get(event.point)?;
    let mut single = Cycle { parameters: branch.branch.parameters.clone(), ..known.cycle.clone() };
    single.parameters[which.0] = event.p;
    let (base, direction) = twice(problem, &single).ok()?;
    let (_, largest, direction) =
        depart(problem, which, &base, direction, single.amplitude()).ok()?;
    let shift = |epsilon: f64| -> Option<f64> {
        let (cycle, _) = correct(problem, which, &base, &direction, epsilon).ok()?;
        Some(cycle.parameters[which.0] - event.p)
    };
    // amplitudes whose squares halve: p − p₀ = c ε² + d ε⁴
    let [a, b, c] = [1.0, 0.5_f64.sqrt(), 0.5].map(|factor| shift(factor * largest));
    let (a, b, c, square) = (a?, b?, c?, 0.25 * largest * largest);
    // with the located p₀, and by differences alone, in which it does not enter
    let with = 2.0 * c / square - b / (2.0 * square);
    let (outer, inner) = ((a - b) / (2.0 * square), (b - c) / square);
    let without = 2.0 * inner - outer;
    let rounding = ROUNDING * (1.0 + event.p.abs()) / square;
    let curvature = 2.0 * without;
    let curvature_error = 2.0 * ((without - with).abs() + 10.0 * rounding);
    if !(curvature.is_finite() && curvature_error.is_finite()) {
        return None;
    }
    let clear = curvature.abs() > CLEAR * curvature_error;
    let criticality = if clear { criticality(branch, at, curvature) } else { None };
    Some(DoublingForm { curvature, curvature_error, criticality })
}

/// The doubled cycles lie to the side of `curvature`; the single ones are unstable to the other side, or
/// to the same.
fn criticality(branch: &CycleBranch, at: usize, curvature: f64) -> Option<Criticality> {
    let event = &branch.branch.events[at];
    let points = &branch.branch.points;
    let before = event.point.checked_sub(1).and_then(|k| points.get(k))?;
    let after = points.get(event.point + 1)?;
    let (less, more) = (event.unstable_before?, event.unstable_after?);
    let passes = (before.p - event.p) * (after.p - event.p) < 0.0;
    if !(points[event.point].certified && passes && less.abs_diff(more) == 1) {
        return None;
    }
    let unstable_side = if more > less { after.p - event.p } else { before.p - event.p };
    let soft = unstable_side * curvature > 0.0;
    Some(if soft { Criticality::Supercritical } else { Criticality::Subcritical })
}
