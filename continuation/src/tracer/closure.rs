//! Does the branch come back to where it began, or to where its other half ended?

use super::Tracer;
use crate::branch::StopReason;
use crate::events::basis;
use crate::step::{Constraint, Core, Precision, State};

/// How far from the start, relative to the step, a branch may pass and still be the same: the
/// error of the Hermite cubic by which the step is interpolated.
const NEAR: f64 = 0.02;
/// The same once it is corrected on the plane of the start, which brings it nearer but on the other side of a
/// flat loop.
const SAME: f64 = 1e-4;

impl Tracer<'_> {
    /// Whether the step of scaled length `h` closes the branch: over its start, in which
    /// direction, or over the end of its other half; and at which part of the step.
    pub(super) fn closes(&mut self, h: f64) -> Option<(StopReason, f64)> {
        let Self { core, current, trial, start, finish, work, .. } = self;
        if self.left_start
            && let Some(at) = passes(core, current, trial, start, work, h)
        {
            let w = core.weights;
            let direction = w.dot(&start.mtu, start.tp, &current.tu, current.tp);
            let reason =
                if direction > 0.0 { StopReason::ClosedLoop } else { StopReason::ReturnedToStart };
            return Some((reason, at));
        }
        let end = finish.as_ref()?;
        let at = passes(core, current, trial, end, work, h)?;
        Some((StopReason::ClosedLoop, at))
    }
}

/// Whether the step of scaled length `h` from `current` to `trial` passes over `at`, and where.
fn passes(
    core: &mut Core<'_>,
    current: &State,
    trial: &State,
    at: &State,
    work: &mut State,
    h: f64,
) -> Option<f64> {
    let w = core.weights;
    let side = |x: &State| {
        let du = x.u.iter().zip(&at.u).zip(&at.mtu);
        let along: f64 = du.map(|((a, b), m)| (a - b) * m).sum();
        along / (w.unknowns * w.unknowns) + at.tp * (x.p - at.p) / (w.parameter * w.parameter)
    };
    if side(current) * side(trial) > 0.0 {
        return None;
    }
    let (distance, ..) = core.secant(current, at);
    if distance > 1.5 * h {
        return None;
    }
    // the point of the step as far from its beginning as the place is
    let [w0, w1, w2, w3] = basis((distance / h).min(1.0));
    let (w1, w3) = (w1 * h, w3 * h);
    for i in 0..work.u.len() {
        work.u[i] = w0 * current.u[i] + w1 * current.tu[i] + w2 * trial.u[i] + w3 * trial.tu[i];
    }
    work.p = w0 * current.p + w1 * current.tp + w2 * trial.p + w3 * trial.tp;
    let (off, ..) = core.secant(work, at);
    if off > NEAR * h {
        return None;
    }
    // at a branch point it does not converge, or not to the digit
    if core.correct(Constraint::Plane(at, 0.0), work, Precision::Look).is_ok() {
        let (corrected, ..) = core.secant(work, at);
        if corrected > SAME * h && corrected > 0.5 * off {
            return None;
        }
    }
    // as far along the tangent
    let du = at.u.iter().zip(&current.u).zip(&current.mtu);
    let along: f64 = du.map(|((a, b), m)| (a - b) * m).sum();
    let along = along / (w.unknowns * w.unknowns)
        + current.tp * (at.p - current.p) / (w.parameter * w.parameter);
    Some(along)
}
