//! The scales of a branch that is much smaller than expected.
//!
//! The range of the parameter is what a target or a domain suggests. A branch may live on far less
//! of it: a small closed curve in a wide domain. Where the first step is refused at lengths far
//! below the default because the branch bends, unknowns and parameter are measured by what the first
//! step shows, and with them the limits of the step; the scales grow with the branch.

use super::Tracer;
use crate::step::{Refusal, Weights};

/// Part of the first step at which the scales shrink so that it may become shorter, and by which.
const ZOOM: f64 = 1e-2;
/// Scales in terms of that step: the longest one, a twentieth of the scales, is as long.
const SCALES: f64 = 20.0;
/// Least scale in terms of that step.
const UNSEEN: f64 = 2.0;
/// Least part of the expected scales: below it the rounding of the state is all there is.
const LEAST: f64 = 1e-12;
/// Part of its scale over which a branch has gone when that grows, to twice as much.
const GROWN: f64 = 0.5;

impl Tracer<'_> {
    /// Shrinks the scales if the first step, refused at the scaled length `h`, shows that they are far
    /// too large; the same length by the new ones.
    pub(super) fn zoom_in(&mut self, refusal: &Refusal, h: f64) -> Option<f64> {
        let geometric = matches!(
            refusal,
            Refusal::Contraction { .. } | Refusal::FarFromPrediction { .. } | Refusal::Turn { .. }
        );
        if !(geometric && self.s == 0.0 && self.previous_h == 0.0) {
            return None;
        }
        // in any case the step will say what the scales are
        let expected = *self.expected.get_or_insert(self.core.weights);
        if h >= ZOOM * self.size.h || self.core.weights.parameter < LEAST * expected.parameter {
            return None;
        }
        self.core.weights.unknowns *= ZOOM;
        self.core.weights.parameter *= ZOOM;
        self.current.scale_tangent(ZOOM);
        Some(h / ZOOM)
    }

    /// Measures by the first step, from `previous` to `current`, of scaled length `h`, if that could
    /// not be as long as it was to be.
    pub(super) fn zoom(&mut self, h: f64) {
        if self.expected.is_none() {
            return;
        }
        let weights = self.core.weights;
        // what does not vary yet will
        let least = (UNSEEN * h).min(1.0);
        let unknowns = self.core.excursion(&self.current.u, &self.previous.u);
        let parameter = (self.current.p - self.previous.p).abs();
        let scale = |x: f64, w: f64| (SCALES * x).clamp(least * w, w);
        let (unknowns, parameter) =
            (scale(unknowns, weights.unknowns), scale(parameter, weights.parameter));
        self.measure(Weights { unknowns, parameter });
    }

    /// Lets scales that were shrunk grow with the branch, as far as they were expected to be.
    pub(super) fn zoom_out(&mut self) {
        let Some(expected) = self.expected else { return };
        let mut weights = self.core.weights;
        let passed = (self.current.p - self.start.p).abs();
        if passed > GROWN * weights.parameter {
            weights.parameter = (2.0 * passed).min(expected.parameter).max(weights.parameter);
        }
        let passed = self.core.excursion(&self.current.u, &self.start.u);
        if passed > GROWN * weights.unknowns {
            weights.unknowns = (2.0 * passed).min(expected.unknowns).max(weights.unknowns);
        }
        if weights.parameter >= expected.parameter && weights.unknowns >= expected.unknowns {
            self.expected = None;
        }
        self.measure(weights);
    }

    /// Measures by other scales from here on.
    pub(super) fn measure(&mut self, mut weights: Weights) {
        if self.core.problem.unknown_scale(self.core.which).is_some() {
            let common = weights.unknowns.max(weights.parameter);
            weights = Weights { unknowns: common, parameter: common };
        }
        if weights == self.core.weights {
            return;
        }
        self.core.weights = weights;
        let x = &mut self.current;
        let norm = weights.norm(&x.mtu, &x.tu, x.tp);
        x.scale_tangent(1.0 / norm);
        self.size.h *= norm;
        self.past *= norm;
        self.previous_h = 0.0;
    }
}
