//! Across a stretch on which the parameter stands still to rounding, as at a fold of high order: signs of
//! dp/ds say nothing within it, those on its two sides do.

use super::Tracer;
use crate::events::Plateau;

/// Ratio of the lengths that are tried, and their number: the branch is straight there.
const LONGER: f64 = 1.3;
const TRIES: i32 = 15;

impl Tracer<'_> {
    /// Tries longer steps than the one of length `h`, which ends on the plateau. Where none reaches its
    /// other side the next step may end on it.
    pub(super) fn cross_plateau(&mut self, h: f64) -> bool {
        self.detector.set_plateau(Plateau::Cross);
        let crossed = (1..=TRIES).any(|k| self.attempt(h * LONGER.powi(k), false).is_ok());
        let (next, count) = if crossed {
            (Plateau::Refuse, &mut self.core.statistics.accepted)
        } else {
            (Plateau::Enter, &mut self.core.statistics.rejected)
        };
        *count += 1;
        self.detector.set_plateau(next);
        crossed
    }
}
