//! Where a step begins: ahead of the last states.

use super::Tracer;

impl Tracer<'_> {
    /// Quadratic extrapolation of the branch; along the tangent at first.
    pub(super) fn predict(&mut self, h: f64) {
        self.trial.p = self.predicted(h);
        let Self { current, previous, trial, .. } = self;
        let bend = if self.previous_h > 0.0 { 0.5 * h * h / self.previous_h } else { 0.0 };
        for i in 0..trial.u.len() {
            trial.u[i] = current.u[i] + (h + bend) * current.tu[i] - bend * previous.tu[i];
        }
    }

    /// The parameter of that.
    pub(super) fn predicted(&self, h: f64) -> f64 {
        let bend = if self.previous_h > 0.0 { 0.5 * h * h / self.previous_h } else { 0.0 };
        self.current.p + (h + bend) * self.current.tp - bend * self.previous.tp
    }
}
