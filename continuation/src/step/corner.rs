//! Whether a step cuts a corner: where branches cross at an acute angle, Newton's method may go over from
//! one to the other, whose orientation and counts are the same behind the branch point.
//!
//! Position and tangent at both ends cannot tell a corner in the middle of a step from a smooth turn.
//! Anywhere else the secant does not halve the angle between the tangents. In the middle the solution is
//! not where the curvature before predicts it, and the cubic from both ends leaves the branch in between,
//! which costs a residual and a solve to see.

use super::corrector::{Constraint, Core};
use super::judge::Quality;
use super::{Refusal, State};
use crate::events::interpolate;

/// Angle between secant and tangent, in radians, below which a step is not refused for its angles alone.
const VISIBLE: f64 = 0.025;
/// The same below which a corner is not looked for: a branch that runs beside nearer than this part of a
/// step.
const FAINT: f64 = 1e-3;
/// Part of the angle by which the prediction has to be wrong for a corner in the middle: one at a part `x`
/// of the step makes `1 - x`.
const SURPRISE: f64 = 0.15;
/// Part of the whole turn by which the angles at both ends may differ: a corner at a quarter of the
/// step makes a half, a cubic that begins straight a third.
const ASYMMETRY: f64 = 0.45;
/// The same where a singular point is close.
const ASYMMETRY_NEAR_SINGULAR: f64 = 0.2;
/// Contraction over deviation above which a singular point is close: Newton's method, begun `d h` off the
/// branch, contracts by about `d h / 2r`, with `r` the distance to the singular point.
const SINGULAR: f64 = 5.0;
/// Part of both angles that is the angle between the tangents, below which the step turns one way and
/// back: a corner against the curvature before it.
const ONE_WAY: f64 = 0.6;
/// Contraction of the corrector above which the branch is looked for between the ends.
const SLOW: f64 = 0.15;
/// Part of the angle that the cubic may be off in the middle of a step that shows no corner: going over to a
/// branch that runs beside makes 1/20, the approach to a sharp fold 1/70.
const BESIDE: f64 = 1.0 / 30.0;
/// Part of the angle that the cubic may be off in the middle, in steps. A corner there makes 1/32, an arc
/// of 0.35 radians 1/1000.
const BOW: f64 = 1.0 / 80.0;

impl Core<'_> {
    /// Whether the step of scaled length `h` from `a` to `b`, whose factors are the latest, cuts a
    /// corner; `secant` and `tangents` as in [`super::judge`].
    pub(crate) fn cuts_a_corner(
        &mut self,
        (a, b): (&State, &State),
        h: f64,
        quality: &Quality,
        (_, cos_a, cos_b): (f64, f64, f64),
        tangents: f64,
    ) -> Result<bool, Refusal> {
        let angle = quality.angle;
        let [from, to] = [cos_a, cos_b].map(|x| x.clamp(-1.0, 1.0).acos());
        if from.max(to) < FAINT || a.orientation != b.orientation {
            return Ok(false);
        }
        let asymmetry = (from - to).abs() / (from + to);
        let limit = if quality.contraction > SINGULAR * quality.deviation {
            ASYMMETRY_NEAR_SINGULAR
        } else {
            ASYMMETRY
        };
        let uneven = asymmetry > limit || angle < ONE_WAY * (from + to);
        let visible = from.max(to) >= VISIBLE;
        if visible && uneven {
            return Ok(true);
        }
        let surprising = visible && quality.deviation >= SURPRISE * angle;
        // another branch close by, or an inflection and slow convergence: the cubic knows
        let doubtful = uneven || quality.contraction > SLOW;
        if !surprising && !doubtful {
            return Ok(false);
        }
        let bow = if surprising { BOW * angle } else { BESIDE * (from + to) };
        Ok(self.leaves_branch((a, b), h, tangents)? > bow * h)
    }

    /// How far the cubic from both ends is from the branch in the middle of the step.
    fn leaves_branch(
        &mut self,
        (a, b): (&State, &State),
        h: f64,
        tangents: f64,
    ) -> Result<f64, Refusal> {
        let mut middle = b.clone();
        interpolate(a, b, h, tangents, 0.5 * h, &mut middle);
        self.distance_from_branch(Constraint::Plane(a, 0.5 * h), &middle)
    }
}
