//! Branches along which the unknowns grow beyond all bounds while the parameter comes to rest.
//!
//! At `u = c (p − p₀)^(−1/m)` a trace goes on for ever, and from where powers of `u` leave no digits to the
//! other terms of the equations it follows rounding.

use super::Tracer;
use crate::branch::StopReason;
use crate::step::{Core, State};

/// Growth of the unknowns beyond which a branch goes to infinity. At `u = c / (p − p₀)` a rounding error of
/// the parameter then moves the branch by a part 1e-10 of itself; ten to a hundred times farther the
/// corrector no longer settles.
const UNBOUNDED: f64 = 1e6;
/// The parameter's part of the tangent, in its scale, below which the growth does not take it along.
const COMES_TO_REST: f64 = 1e-3;

/// Size of the unknowns: what they have at the start or are expected to reach, at least 1.
pub(super) fn extent(core: &mut Core<'_>, start: &State) -> f64 {
    let origin = vec![0.0; start.u.len()];
    core.excursion(&start.u, &origin).max(core.weights.unknowns).max(1.0)
}

impl Tracer<'_> {
    /// Ends the trace where the unknowns have grown beyond all bounds.
    pub(super) fn check_bounded(&mut self) {
        let (x, w) = (&self.current, self.core.weights);
        if self.stop.is_some() || x.tp.abs() > COMES_TO_REST * w.parameter {
            return;
        }
        let away = self.core.excursion(&x.u, &self.start.u);
        if away > UNBOUNDED * self.extent {
            let name = &self.core.problem.parameters()[self.core.which.0].name;
            let detail = format!(
                "the unknowns grow without bound as {name} tends to {:.8}: they are {:.0e} times \
                 as large as at the start",
                x.p,
                away / self.extent,
            );
            self.end(StopReason::Unbounded, detail);
        }
    }
}
