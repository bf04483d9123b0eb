//! What to say of a trace that used up its points.

use super::Tracer;
use crate::branch::EventKind;

/// Folds on the second half of the points from which on they are a cascade.
const CASCADE: usize = 6;

impl Tracer<'_> {
    /// The limit, and whether the branch turned back and forth on the way.
    pub(super) fn out_of_points(&self) -> String {
        let limit = self.settings.max_points;
        let folds = self.events.iter().filter(|event| event.kind == EventKind::Fold);
        let late: Vec<f64> =
            folds.clone().filter(|fold| fold.point > limit / 2).map(|fold| fold.p).collect();
        let reached = format!("the limit of {limit} points was reached");
        if late.len() < CASCADE {
            return reached;
        }
        let low = late.iter().copied().fold(f64::INFINITY, f64::min);
        let high = late.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        format!(
            "{reached} in a cascade of folds that goes on: {} folds so far, the last {} of them on the \
             second half of the points, between {} = {low:.6} and {high:.6}",
            folds.count(),
            late.len(),
            self.place().0,
        )
    }
}
