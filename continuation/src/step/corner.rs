//! Whether a step cuts a corner: where branches cross at an acute angle, Newton's method may go over from
//! one to the other, whose orientation and counts are the same behind the branch point.
//!
//! Positions and tangents at both ends tell a corner from a smooth turn only where it is near one of them.
//! Else the cubic through both ends leaves the branch in between, which a residual and a solve see. A smooth
//! branch that turns fast is off the cubic too, but differently: its tangent in the middle is that of the
//! cubic, and Newton's method converges fast from there. Beside a corner it does not, since the branch point
//! is near, or the tangent is that of one of the branches.

use super::corrector::{Constraint, Core, Precision};
use super::judge::Quality;
use super::{Refusal, State};
use crate::events::interpolate;

/// Angle between secant and tangent, in radians, below which a step is not refused for its angles alone.
const VISIBLE: f64 = 0.025;
/// The same below which a corner is not looked for: a branch that runs beside nearer than this part of a
/// step.
const FAINT: f64 = 1e-3;
/// Part of the whole turn by which the angles at both ends may differ: a corner at a quarter of the
/// step makes a half, a cubic that begins straight a third.
const ASYMMETRY: f64 = 0.45;
/// The same where a singular point is close.
const ASYMMETRY_NEAR_SINGULAR: f64 = 0.2;
/// The same from which the cubic is asked. Smooth turns make 0.05.
const UNEVEN: f64 = 0.1;
/// Contraction over deviation above which a singular point is close: Newton's method, begun `d h` off the
/// branch, contracts by about `d h / 2r`, with `r` the distance to the singular point.
const SINGULAR: f64 = 5.0;
/// Part of both angles that is the angle between the tangents, below which the step turns one way and
/// back: a corner against the curvature before it.
const ONE_WAY: f64 = 0.6;
/// Contraction of the corrector above which the cubic is asked.
const SLOW: f64 = 0.1;
/// The same above which another branch may be close.
const SLOWER: f64 = 0.15;
/// Part of the angle by which the prediction has to be wrong for the cubic to be asked: a corner at a part
/// `x` of the step makes `1 - x` of its own angle.
const SURPRISE: f64 = 0.1;
/// The same by which it was wrong beyond doubt.
const WRONG: f64 = 0.15;
/// Part of the turn that the cubic may be off in the middle of a step, in steps, at most: going over to a
/// branch that runs beside makes 1/20, the approach to a sharp fold 1/70.
const BESIDE: f64 = 1.0 / 30.0;
/// The same where the prediction was wrong. A corner in the middle that is all of the turn makes 1/32.
const SURPRISED: f64 = 1.0 / 80.0;
/// The same up to which nothing more is asked: an arc of 0.35 radians makes 1/1000.
const BOW: f64 = 1.0 / 100.0;
/// Part of the whole turn between branch and cubic in the middle. A corner makes up to a half of its own
/// angle; sharp folds, where steps are longest for what they turn, 1/40.
const BENT: f64 = 0.05;
/// The same relative to how far the cubic is off, in steps: a corner in the middle makes 16, smooth branches
/// up to 2.
const BENT_BY_BOW: f64 = 4.0;
/// Contraction of Newton's method from the cubic above which a singular point is near: smooth turns make
/// 0.03, what shows no corner otherwise a quarter.
const CONTRACTION: f64 = 0.05;

impl Core<'_> {
    /// Whether the step of scaled length `h` from `a` to `b`, whose factors are the latest, cuts a
    /// corner; `secant` and `tangents` as in [`super::judge`], `middle` is overwritten.
    pub(crate) fn cuts_a_corner(
        &mut self,
        (a, b): (&State, &State),
        h: f64,
        quality: &Quality,
        (_, cos_a, cos_b): (f64, f64, f64),
        tangents: f64,
        middle: &mut State,
    ) -> Result<bool, Refusal> {
        let [from, to] = [cos_a, cos_b].map(|x| x.clamp(-1.0, 1.0).acos());
        let turn = from + to;
        if from.max(to) < FAINT || a.orientation != b.orientation {
            return Ok(false);
        }
        let asymmetry = (from - to).abs() / turn;
        let near_singular = quality.contraction > SINGULAR * quality.deviation;
        let limit = if near_singular { ASYMMETRY_NEAR_SINGULAR } else { ASYMMETRY };
        let one_way = quality.angle >= ONE_WAY * turn;
        let visible = from.max(to) >= VISIBLE;
        if visible && (asymmetry > limit || !one_way) {
            return Ok(true);
        }
        let surprising = quality.deviation > SURPRISE * quality.angle;
        if !surprising && asymmetry <= UNEVEN && one_way && quality.contraction <= SLOW {
            return Ok(false);
        }
        interpolate(a, b, h, tangents, 0.5 * h, middle);
        let bow = self.distance_from_branch(Constraint::Plane(a, 0.5 * h), middle)? / h;
        let wrong = visible && quality.deviation >= WRONG * quality.angle;
        let slow = asymmetry > limit || !one_way || quality.contraction > SLOWER;
        if wrong && bow > SURPRISED * quality.angle || slow && bow > BESIDE * turn {
            return Ok(true);
        }
        if bow <= BOW * turn {
            return Ok(false);
        }
        match self.correct(Constraint::Plane(a, 0.5 * h), middle, Precision::Look) {
            Err(Refusal::Evaluation(error)) => Err(Refusal::Evaluation(error)),
            Err(_) => Ok(true),
            Ok(corrected) => {
                let bent = self.bend_in_the_middle((a, b), h, tangents, middle);
                Ok(corrected.contraction > CONTRACTION
                    || bent > (BENT * turn).min(BENT_BY_BOW * bow))
            }
        }
    }

    /// Angle between the branch, which `middle` lies on, and the cubic from both ends in its middle.
    fn bend_in_the_middle(
        &mut self,
        (a, b): (&State, &State),
        h: f64,
        tangents: f64,
        middle: &State,
    ) -> f64 {
        let slope =
            |a: f64, ta: f64, b: f64, tb: f64| 1.5 * (b - a) - 0.25 * h * (ta + tb / tangents);
        let before = a.u.iter().zip(&a.tu);
        for (du, ((a, ta), (b, tb))) in self.du.iter_mut().zip(before.zip(b.u.iter().zip(&b.tu))) {
            *du = slope(*a, *ta, *b, *tb);
        }
        let dp = slope(a.p, a.tp, b.p, b.tp);
        self.problem.metric(&self.du, &mut self.mdu);
        let along = self.weights.dot(&self.mdu, dp, &middle.tu, middle.tp);
        let norm = self.weights.norm(&self.mdu, &self.du, dp);
        if norm > 0.0 { (along / norm).clamp(-1.0, 1.0).acos() } else { 0.0 }
    }
}
