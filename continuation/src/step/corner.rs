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
use crate::problem::Problem;

/// Angle between secant and tangent, in radians, below which a corner is not looked for.
const VISIBLE: f64 = 0.025;
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
/// Part of the angle that the cubic may be off in the middle, in steps. A corner there makes 1/32, an arc
/// of 0.35 radians 1/1000.
const BOW: f64 = 1.0 / 80.0;

impl<P: Problem + ?Sized> Core<'_, P> {
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
        if from.max(to) < VISIBLE || a.orientation != b.orientation {
            return Ok(false);
        }
        let asymmetry = (from - to).abs() / (from + to);
        let limit = if quality.contraction > SINGULAR * quality.deviation {
            ASYMMETRY_NEAR_SINGULAR
        } else {
            ASYMMETRY
        };
        if asymmetry > limit || angle < ONE_WAY * (from + to) {
            return Ok(true);
        }
        if quality.deviation < SURPRISE * angle {
            return Ok(false);
        }
        let mut middle = b.clone();
        interpolate(a, b, h, tangents, 0.5 * h, &mut middle);
        let off = self.distance_from_branch(Constraint::Plane(a, 0.5 * h), &middle)?;
        Ok(off > BOW * angle * h)
    }
}
