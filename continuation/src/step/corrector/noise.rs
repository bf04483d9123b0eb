//! Whether corrections that no longer shrink are rounding errors.
//!
//! Rounding of the residual, which the matrix may amplify, is measured: states that are a rounding apart have
//! corrections that differ by their distance, and by the noise.

use super::super::State;
use super::{Constraint, Core};
use crate::singular::arbitrary;

/// Corrections up to this many times the measured noise are noise.
const TIMES: f64 = 8.0;
/// States measured.
const SAMPLES: usize = 3;
/// Relative distance between them.
const APART: f64 = 2.0 * f64::EPSILON;
/// Noise is accepted up to this part of a step: another branch may be a part of a step away.
const PART: f64 = 1e-3;

impl Core<'_> {
    /// Whether a correction of this length to `x`, made already, is no more than the noise of corrections there, by
    /// the latest factors.
    pub(super) fn is_noise(
        &mut self,
        constraint: Constraint<'_>,
        x: &mut State,
        correction: f64,
    ) -> bool {
        if let Constraint::Plane(_, h) = constraint
            && correction > PART * h.abs()
        {
            return false;
        }
        let Ok((_, dp)) = self.correction(constraint, x) else { return false };
        self.shifted[0].copy_from_slice(&self.du);
        self.shifted[1].copy_from_slice(&x.u);
        let mut noise = 0.0_f64;
        for sample in 0..SAMPLES {
            for (i, u) in x.u.iter_mut().enumerate() {
                *u += APART * arbitrary(sample + 2, i) * *u;
            }
            let found = self.correction(constraint, x);
            // what is left of the difference when the distance is taken off
            let [here, at] = &self.shifted;
            for (((du, here), u), at) in self.du.iter_mut().zip(here).zip(&x.u).zip(at) {
                *du -= here + (u - at);
            }
            x.u.copy_from_slice(at);
            let Ok((_, there)) = found else { return false };
            self.problem.metric(&self.du, &mut self.mdu);
            noise = noise.max(self.weights.norm(&self.mdu, &self.du, there - dp));
        }
        correction <= TIMES * noise
    }
}
