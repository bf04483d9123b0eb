//! Whether a corrected point is trusted to be the branch's next one.
//!
//! Wrong points seldom look wrong by themselves: Newton's method converges to *some* solution.
//! They betray themselves by slow convergence, by distance from the prediction, by the turn of
//! the tangent, and by the angle between secant and tangents (after AUTO, MATCONT, COCO and
//! pde2path, which each use some of these).

use super::corrector::Corrected;
use super::{Refusal, State};
use crate::settings::Settings;

/// Contraction of the corrector above which a step is refused.
const MAX_CONTRACTION: f64 = 0.3;
/// Distance from the prediction, relative to the step, above which a step is refused.
const MAX_DEVIATION: f64 = 0.5;

/// Numbers by which a step is judged and the next step length chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Quality {
    pub(crate) angle: f64,
    pub(crate) contraction: f64,
    pub(crate) deviation: f64,
}

impl Quality {
    /// The worst of the measures, each relative to its limit; above 1 the step is refused.
    pub(crate) fn badness(&self, settings: &Settings) -> f64 {
        // contraction and deviation shrink at least quadratically with the step, angles linearly
        let quadratic = (self.contraction / MAX_CONTRACTION).max(self.deviation / MAX_DEVIATION);
        (self.angle / settings.max_angle).max(quadratic.sqrt())
    }
}

/// Judges the step of scaled length `h` from `from` to `to`; `secant` holds the distance and
/// the cosines between secant and tangents.
pub(crate) fn judge(
    settings: &Settings,
    to: &State,
    h: f64,
    corrected: &Corrected,
    secant: (f64, f64, f64),
    tangents: f64,
) -> Result<Quality, Refusal> {
    let (distance, cos_from, cos_to) = secant;
    let angle = tangents.clamp(-1.0, 1.0).acos();
    let quality =
        Quality { angle, contraction: corrected.contraction, deviation: corrected.first / h };
    if quality.contraction > MAX_CONTRACTION {
        return Err(Refusal::Contraction { contraction: quality.contraction });
    }
    if quality.deviation > MAX_DEVIATION || distance > 2.0 * h {
        return Err(Refusal::FarFromPrediction { ratio: quality.deviation });
    }
    let limit = settings.max_angle;
    let worst = angle.max(cos_from.min(cos_to).clamp(-1.0, 1.0).acos());
    if worst > limit {
        return Err(Refusal::Turn { angle: worst });
    }
    if to.orientation == 0 {
        return Err(Refusal::Singular);
    }
    Ok(quality)
}
