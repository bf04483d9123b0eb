//! Does the branch come back to where it began?

use super::Tracer;
use crate::branch::StopReason;
use crate::events::basis;
use crate::problem::Problem;
use crate::step::State;

/// How far from the start, relative to the step, a branch may pass and still be the same: the
/// error of the Hermite cubic by which the step is interpolated.
const SAME: f64 = 0.02;

impl<P: Problem> Tracer<'_, P> {
    /// Whether the step of scaled length `h` passes over the start of the branch, and in which
    /// direction.
    pub(super) fn passes_start(&mut self, h: f64) -> Option<StopReason> {
        if !self.left_start {
            return None;
        }
        let Self { core, current, trial, start, work, .. } = self;
        let w = core.weights;
        let side = |x: &State| {
            let du = x.u.iter().zip(&start.u).zip(&start.mtu);
            let along: f64 = du.map(|((a, b), m)| (a - b) * m).sum();
            along / (w.unknowns * w.unknowns)
                + start.tp * (x.p - start.p) / (w.parameter * w.parameter)
        };
        if side(current) * side(trial) > 0.0 {
            return None;
        }
        let (distance, ..) = core.secant(current, start);
        if distance > 1.5 * h {
            return None;
        }
        // the point of the step as far from its beginning as the start is
        let [w0, w1, w2, w3] = basis((distance / h).min(1.0));
        let (w1, w3) = (w1 * h, w3 * h);
        for i in 0..work.u.len() {
            work.u[i] = w0 * current.u[i] + w1 * current.tu[i] + w2 * trial.u[i] + w3 * trial.tu[i];
        }
        work.p = w0 * current.p + w1 * current.tp + w2 * trial.p + w3 * trial.tp;
        let (off, ..) = core.secant(work, start);
        if off.is_nan() || off > SAME * h {
            return None;
        }
        let direction = w.dot(&start.mtu, start.tp, &current.tu, current.tp);
        Some(if direction > 0.0 { StopReason::ClosedLoop } else { StopReason::ReturnedToStart })
    }
}
