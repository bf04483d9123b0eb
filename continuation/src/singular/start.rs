//! A branch point where a trace begins: the branch along which it goes, and those that cross it.

use super::probe::Extended;
use super::{MAX_GAP, forms, kernel, multiple};
use crate::branch::Crossing;
use crate::step::{Core, State};

/// Largest kernel that is looked for.
const MOST: usize = 3;
/// Distance between the start and the branch point, in the scaled metric, below which they are the
/// same: at a double root Newton's method stops at the square root of rounding.
const SAME: f64 = 1e-6;
/// The same for the parameter, relative to its size and range: rounding, and the error of Jacobians
/// by differences.
pub(crate) const SAME_PARAMETER: f64 = 1e-10;

/// A start that is a branch point.
#[derive(Debug, Clone)]
pub(crate) struct Begun {
    pub(crate) crossing: Crossing,
    /// Estimated error of the point, as a scaled length.
    pub(crate) error: f64,
}

/// Whether the branch point near `x` is `x`, at the same parameter; then `x` becomes it, its tangent
/// that of the branch that follows the parameter most, upwards if `increasing`.
pub(crate) fn branch_point_at(
    core: &mut Core<'_>,
    x: &mut State,
    increasing: bool,
) -> Option<Begun> {
    let mut probe = core.probe();
    let z = Extended { u: x.u.clone(), p: x.p };
    let along = Extended { u: vec![0.0; x.u.len()], p: probe.weights.parameter };
    let mut found = None;
    for k in 1..=MOST.min(x.u.len()) {
        if let Ok(one) = kernel::find(&mut probe, &z, &along, k, |_, _, _| false) {
            found = Some((k, one));
            break;
        }
    }
    let (k, mut found) = found?;
    let mut off = found.z.clone();
    off.add(-1.0, &z);
    let moved = off.p.abs();
    let near = probe.norm(&off) <= SAME && found.gap <= MAX_GAP;
    if !near || moved > SAME_PARAMETER * (x.p.abs() + probe.weights.parameter) {
        return None;
    }
    let analysed = if k == 1 {
        forms::simple(&mut probe, &mut found, &along).ok()??
    } else {
        multiple::analyse(&mut probe, &mut found, &along).ok()??
    };
    core.statistics.newton_iterations += probe.assemblies;
    let mut tangent = analysed.traced;
    let mut crossing = analysed.crossing;
    // a vertical branch has no way up: its first component that is not small counts
    let largest = super::max_abs(&tangent.u);
    let first = tangent.u.iter().find(|t| t.abs() > 0.5 * largest).copied().unwrap_or(1.0);
    let way = if crossing.traced.dp == 0.0 { first } else { tangent.p };
    if (way < 0.0) == increasing {
        tangent.scale(-1.0);
        crossing.traced.du.iter_mut().for_each(|t| *t = -*t);
        crossing.traced.dp = -crossing.traced.dp;
    }
    let p = x.p;
    core.place(x, &found.z, &tangent).ok()?;
    x.p = p;
    // how far it was from the start, and how well that is known
    let known = found.correction.max(found.gap).max(found.resolution);
    let error = known + moved / core.weights.parameter;
    Some(Begun { crossing, error: error.max(f64::EPSILON) })
}
