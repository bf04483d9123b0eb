//! Steps that would leave the domain of the parameter.

use super::Tracer;
use crate::step::{Constraint, Corrected, Precision, Refusal};

/// Distance from a bound, in scales of the parameter, that is rounding.
const ON_BOUND: f64 = 1e-14;

/// Halvings that find where a prediction meets a bound.
const HALVINGS: usize = 60;

impl Tracer<'_> {
    /// Whether the whole step lies on a bound of the domain, to rounding: the branch tends to it.
    pub(super) fn runs_along_bound(&self) -> bool {
        let Some((lo, hi)) = self.settings.domain else { return false };
        let near = ON_BOUND * self.core.weights.parameter;
        let on =
            |bound: f64| [&self.current, &self.trial].iter().all(|x| (x.p - bound).abs() <= near);
        self.left_start && (on(lo) || on(hi))
    }

    /// Where on a step of scaled length `h` the prediction meets a bound of the domain, and the bound; the
    /// prediction is made.
    pub(super) fn meets_bound(&mut self, h: f64) -> Option<(f64, f64)> {
        let (lo, hi) = self.settings.domain?;
        let p = self.trial.p;
        let bound = p.max(lo).min(hi);
        if p == bound || self.current.p == bound {
            return None;
        }
        let beyond = (p - bound).signum();
        let (mut inside, mut outside) = (0.0, h);
        for _ in 0..HALVINGS {
            let at = 0.5 * (inside + outside);
            if (self.predicted(at) - bound) * beyond > 0.0 {
                outside = at;
            } else {
                inside = at;
            }
        }
        Some((outside, bound))
    }

    /// A step that ends on the bound where the prediction of scaled length `h` meets it; its length.
    pub(super) fn step_to_bound(
        &mut self,
        h: f64,
        bound: f64,
    ) -> Result<(f64, Corrected), Refusal> {
        self.predict(h);
        let Self { core, current, trial, .. } = self;
        trial.p = bound;
        let done = core.correct(Constraint::Parameter(current, bound), trial, Precision::Event)?;
        trial.p = bound;
        let (distance, cosine, _) = core.secant(current, trial);
        let along = distance * cosine;
        if !(along > 0.0 && along <= 2.0 * h) {
            return Err(Refusal::FarFromPrediction { ratio: along / h });
        }
        Ok((along, done))
    }
}
