//! Settings of branches of cycles.

use crate::settings::SettingsError;
use serde::{Deserialize, Serialize};

/// How cycles are discretised.
///
/// ```
/// use continuation::cycles::CycleSettings;
/// let settings = CycleSettings { degree: 5, ..CycleSettings::default() };
/// assert!(settings.validate().is_ok());
/// assert!(CycleSettings { degree: 9, ..settings }.validate().is_err());
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CycleSettings {
    /// Degree of the polynomials, 2 to 7, and number of Gauss points of an interval.
    pub degree: usize,
    /// Number of intervals at the start, and the least; at least 3.
    pub intervals: usize,
    /// The most intervals, where the accuracy asks for more.
    pub max_intervals: usize,
    /// Relative change of period and states on halving every interval that is aimed at; a mesh that
    /// does not reach it with [`CycleSettings::max_intervals`] stays, and the error is what is reported.
    pub accuracy: f64,
    /// Points between adaptations of the mesh; at least 2.
    pub adapt_every: usize,
    /// The trace ends with [`PeriodUnbounded`](crate::StopReason::PeriodUnbounded) where the period is so
    /// many times the shortest of the branch while the parameter has come to rest.
    pub period_growth: f64,
    /// Whether the errors of every point are estimated, by solving it, or its neighbours on the same mesh if these
    /// agree, again with every interval halved.
    /// Without it the only error that is known is that of the trivial multiplier, and no count of
    /// multipliers is certified.
    pub check: bool,
}

impl Default for CycleSettings {
    fn default() -> Self {
        CycleSettings {
            degree: 4,
            intervals: 30,
            max_intervals: 400,
            accuracy: 1e-10,
            adapt_every: 6,
            period_growth: 5.0,
            check: true,
        }
    }
}

impl CycleSettings {
    /// Checks all ranges.
    ///
    /// # Errors
    /// The first setting that is out of range.
    pub fn validate(&self) -> Result<(), SettingsError> {
        let whole = |key, value: usize, ok: bool, allowed| {
            if ok { Ok(()) } else { Err(SettingsError { key, value: value as f64, allowed }) }
        };
        whole("degree", self.degree, (2..=7).contains(&self.degree), "2 to 7")?;
        whole("intervals", self.intervals, self.intervals >= 3, "at least 3")?;
        let most = self.max_intervals;
        whole("max_intervals", most, most >= self.intervals, "at least intervals")?;
        whole("adapt_every", self.adapt_every, self.adapt_every >= 2, "at least 2")?;
        if !(self.accuracy > 0.0 && self.accuracy < 1.0) {
            let (value, allowed) = (self.accuracy, "between 0 and 1");
            return Err(SettingsError { key: "accuracy", value, allowed });
        }
        if !(self.period_growth > 1.0 && self.period_growth.is_finite()) {
            let (value, allowed) = (self.period_growth, "above 1 and finite");
            return Err(SettingsError { key: "period_growth", value, allowed });
        }
        Ok(())
    }
}
