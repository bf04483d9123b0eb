//! Step length control.

use super::judge::Quality;
use crate::settings::Settings;
use serde::{Deserialize, Serialize};

/// The step length in scaled arclength, with its limits in the problem's metric.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct StepSize {
    /// Next step.
    pub(crate) h: f64,
    /// Longest step in the problem's metric, if set by the user.
    longest: Option<f64>,
    /// Shortest step in the problem's metric, if set by the user.
    shortest: Option<f64>,
    /// The parameter's range in scaled arclength.
    range: f64,
}

impl StepSize {
    /// `range` is the parameter's range in scaled arclength; `length` the tangent's length in
    /// the problem's metric at the start.
    pub(crate) fn new(settings: &Settings, range: f64, length: f64) -> Self {
        let mut size =
            StepSize { h: 0.0, longest: settings.max_step, shortest: settings.min_step, range };
        let first = settings.first_step.map_or(0.1 * size.longest(length), |s| s / length);
        size.h = first.clamp(size.shortest(length), size.longest(length));
        size
    }

    /// Longest scaled step where the tangent has this length in the problem's metric.
    pub(crate) fn longest(&self, length: f64) -> f64 {
        let least = self.shortest.map_or(0.0, |s| s / length);
        self.longest.map_or((0.05 * self.range).max(least), |s| s / length)
    }

    /// Shortest scaled step.
    pub(crate) fn shortest(&self, length: f64) -> f64 {
        let most = self.longest.map_or(f64::INFINITY, |s| 1e-3 * s / length);
        self.shortest.map_or((1e-10 * self.range).min(most), |s| s / length)
    }

    /// Below this scaled length a step is so short that what it still shows is real.
    pub(crate) fn resolution(&self, length: f64) -> f64 {
        (1e-3 * self.longest(length)).min(1e-5 * self.range).max(4.0 * self.shortest(length))
    }

    /// Chooses the next step after an accepted one of length `h`.
    pub(crate) fn accept(&mut self, h: f64, quality: &Quality, settings: &Settings, length: f64) {
        let target = 0.5;
        let factor = (target / quality.badness(settings).max(1e-3)).clamp(0.5, 2.0);
        self.h = (h * factor).min(self.longest(length)).max(self.shortest(length));
    }
}
