//! What may be said of a number: identified, weak, or not identifiable.

use crate::fit::Fitted;
use crate::parameters::Key;
use serde::{Deserialize, Serialize};

/// What may be said of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The data fix it.
    Identified,
    /// The data narrow it, or a prior does; its interval is what is known.
    Weak,
    /// The data do not say.
    NotIdentifiable,
}

/// Half width of the 68 % interval, of the logarithm, up to which a quantity is identified.
const IDENTIFIED: f64 = 0.25;
/// The same, up to which it is weak.
const WEAK: f64 = 0.7;
/// Share of the prior's standard deviation above which the data have said nothing.
const PRIOR_ONLY: f64 = 0.9;

/// Where in the regimes of the shell a curve has been.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Reach {
    /// Whether the slope of the fitted curve has fallen to half of its largest: the cap gave way.
    pub knee: bool,
    /// Whether the force grows clearly faster than its travel where the data end: gas and stretching.
    pub upturn: bool,
    /// Largest approach of one pole beyond zero force, in `R0`.
    pub deformation: f64,
    /// Share of the lever's deflection in the travel beyond zero force.
    pub lever_share: f64,
}

/// Least approach of one pole, in `R0`, at which a growing slope is one of gas and stretching and not of a
/// film that gets thin.
const BEYOND_FILM: f64 = 0.12;
/// Power of the deformation from which on it is an upturn.
const UPTURN: f64 = 1.2;

/// Reads it off the fitted branch where there are data.
pub fn reach(fitted: &Fitted<'_>) -> Reach {
    let objective = &fitted.objective;
    let p = objective.parameters(&fitted.best.x);
    let heights = objective.curve.segments.iter().flat_map(|s| &s.height);
    let nearest = heights
        .zip(&objective.used)
        .filter(|(_, used)| **used)
        .map(|(h, _)| *h)
        .fold(f64::INFINITY, f64::min);
    let most = p[Key::Contact] - nearest;
    let branch = &fitted.branch;
    let nodes = branch.nodes();
    let zero = nodes.iter().position(|n| n.force > 0.0).unwrap_or(0);
    let origin = nodes.get(zero).map_or(1.0, |n| n.z);
    let (mut largest, mut knee, mut power, mut deformation) = (0.0_f64, false, 0.0, 0.0_f64);
    let mut lever_share = 0.0;
    for node in &nodes[zero..] {
        let travel = branch.travel(node.z, node.force);
        if travel > most {
            break;
        }
        // steep in the grip: no knee but a fold
        let slope = if node.dz < 0.0 { -node.dforce / node.dz } else { 0.0 };
        largest = largest.max(slope);
        knee |= largest > 0.0 && slope < 0.5 * largest;
        deformation = deformation.max(origin - node.z);
        if node.force > 0.0 && origin > node.z {
            power = slope * (origin - node.z) / node.force;
            let bend = p.force_scale() * node.force / p[Key::SpringConstant];
            let squeeze = f64::from(objective.model.contacts) * p[Key::Radius] * (origin - node.z);
            lever_share = bend / (bend + squeeze);
        }
    }
    Reach { knee, upturn: deformation > BEYOND_FILM && power > UPTURN, deformation, lever_share }
}

/// What may be said of a quantity whose 68 % interval has the half widths `half` in its logarithm (`None`:
/// open). `prior_sd` is in the same coordinate; `trusted` says whether the curve shows what fixes it.
pub fn judge(half: [Option<f64>; 2], prior_sd: Option<f64>, trusted: bool) -> Verdict {
    let [Some(low), Some(high)] = half else { return Verdict::NotIdentifiable };
    let width = 0.5 * (low + high);
    let prior_only = prior_sd.is_some_and(|sd| width > PRIOR_ONLY * sd);
    match width {
        w if w.is_nan() || w > WEAK => Verdict::NotIdentifiable,
        w if w > IDENTIFIED || prior_only || !trusted => Verdict::Weak,
        _ => Verdict::Identified,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_row_by_row() {
        let closed = |w: f64| [Some(w), Some(w)];
        for (half, prior, trusted, verdict) in [
            (closed(0.01), None, true, Verdict::Identified),
            (closed(0.01), None, false, Verdict::Weak),
            (closed(0.3), None, true, Verdict::Weak),
            (closed(0.03), Some(0.031), true, Verdict::Weak),
            (closed(0.01), Some(0.031), true, Verdict::Identified),
            (closed(0.8), None, true, Verdict::NotIdentifiable),
            ([Some(0.1), None], None, true, Verdict::NotIdentifiable),
            (closed(f64::NAN), None, true, Verdict::NotIdentifiable),
        ] {
            assert_eq!(judge(half, prior, trusted), verdict, "{half:?} {prior:?} {trusted}");
        }
    }
}
