//! A tracer that keeps its problem.

use super::{TraceError, Tracer};
use crate::any_problem::Held;
use crate::problem::Problem;
use crate::settings::Settings;
use std::sync::Arc;

impl<'a> Tracer<'a> {
    /// [`Tracer::new`] of a problem that the tracer keeps: it may be returned, and stored beside other things.
    ///
    /// ```
    /// use continuation::{Settings, TraceError, Tracer, samples::Cusp};
    ///
    /// fn upwards(lambda: f64) -> Result<Tracer<'static>, TraceError> {
    ///     let settings = Settings { target: Some(2.0), ..Settings::default() };
    ///     Tracer::owning(Cusp, "mu", &[-1.5], &[-2.0, lambda], settings)
    /// }
    ///
    /// let (last, points) = upwards(1.0)?.fold((f64::NAN, 0), |(_, n), point| (point.p, n + 1));
    /// assert!(last == 2.0 && points > 10);
    /// # Ok::<(), TraceError>(())
    /// ```
    ///
    /// # Errors
    /// As [`Tracer::new`].
    pub fn owning<P: Problem + 'a>(
        problem: P,
        parameter: &str,
        u: &[f64],
        p: &[f64],
        settings: Settings,
    ) -> Result<Self, TraceError> {
        Self::of(Held::Shared(Arc::new(problem)), parameter, u, p, settings)
    }
}
