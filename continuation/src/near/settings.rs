//! Settings of the search for near-bifurcations: documented defaults, validated, serialisable.

use crate::settings::SettingsError;
use serde::{Deserialize, Serialize};

/// What counts as a near-bifurcation ([`crate::near_bifurcations`]).
///
/// ```
/// use continuation::NearSettings;
/// let settings = NearSettings { max_gap: -1.0, ..NearSettings::default() };
/// assert!(settings.validate().is_err_and(|e| e.key == "max_gap"));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct NearSettings {
    /// Largest gap between the branches near an imperfect branch point, in natural amplitudes: 1 is
    /// as far as the problem changes over the range of the parameter.
    pub max_gap: f64,
    /// Largest distance of two folds in a row, in parts of the branch's range of the parameter.
    pub max_fold_gap: f64,
}

impl Default for NearSettings {
    fn default() -> Self {
        NearSettings { max_gap: 0.3, max_fold_gap: 0.02 }
    }
}

impl NearSettings {
    /// Checks every value.
    ///
    /// # Errors
    /// The first setting that is out of range.
    pub fn validate(&self) -> Result<(), SettingsError> {
        for (key, value) in [("max_gap", self.max_gap), ("max_fold_gap", self.max_fold_gap)] {
            if !(value.is_finite() && value >= 0.0) {
                return Err(SettingsError { key, value, allowed: "finite and not negative" });
            }
        }
        Ok(())
    }
}
