//! Settings of a search for further solutions: documented defaults, validated, serialisable.

use crate::newton::NewtonSettings;
use crate::settings::SettingsError;
use serde::{Deserialize, Serialize};

/// How far and how hard [`crate::deflation`] searches. Lengths are lengths in the problem's metric
/// ([`crate::Problem::metric`]).
///
/// ```
/// use continuation::deflation::DeflationSettings;
/// let settings = DeflationSettings { max_attempts: 0, ..DeflationSettings::default() };
/// assert!(settings.validate().is_err_and(|e| e.key == "max_attempts"));
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DeflationSettings {
    /// Corrections shorter than this, relative to the solution or to the longest correction on the
    /// way, have converged.
    pub tolerance: f64,
    /// Most iterations of an attempt, each one assembly and one factorisation.
    pub max_iterations: usize,
    /// Solutions nearer to each other than this, relative to their size or to the length below, are
    /// the same.
    pub separation: f64,
    /// The length `ℓ` by which distances from known solutions are divided; `None`: from the
    /// distances between known solutions, the branches and the amplitudes at which the Jacobian changes.
    pub length: Option<f64>,
    /// Solutions farther than this from the start of the attempt are not sought: an attempt that goes
    /// farther ends. `None`: anywhere.
    pub reach: Option<f64>,
    /// Number of near-null directions along which each known solution is perturbed.
    pub modes: usize,
    /// The multiples of a direction's natural amplitude, where the Jacobian has changed by as much
    /// as it is, at which attempts start on either side.
    pub amplitudes: Vec<f64>,
    /// The search ends when so many further solutions are known.
    pub max_solutions: usize,
    /// The search ends after so many attempts; the report then says that it is not exhausted.
    pub max_attempts: usize,
}

impl Default for DeflationSettings {
    fn default() -> Self {
        DeflationSettings {
            tolerance: 1e-12,
            max_iterations: 60,
            separation: 1e-6,
            length: None,
            reach: None,
            modes: 4,
            amplitudes: vec![1.0, 2.0, 5.0],
            max_solutions: 100,
            max_attempts: 2000,
        }
    }
}

impl DeflationSettings {
    /// Those of the plain method.
    pub(super) fn newton(&self) -> NewtonSettings {
        NewtonSettings { tolerance: self.tolerance, max_iterations: self.max_iterations }
    }

    /// Checks every value.
    ///
    /// # Errors
    /// The first setting that is out of range.
    pub fn validate(&self) -> Result<(), SettingsError> {
        let refuse = |key, value, allowed| Err(SettingsError { key, value, allowed });
        for (key, value) in [("tolerance", self.tolerance), ("separation", self.separation)] {
            if !(value > 0.0 && value < 0.1) {
                return refuse(key, value, "positive and below 0.1");
            }
        }
        if self.separation <= self.tolerance {
            return refuse("separation", self.separation, "above `tolerance`");
        }
        for (key, value) in [("length", self.length), ("reach", self.reach)] {
            if let Some(value) = value
                && !(value.is_finite() && value > 0.0)
            {
                return refuse(key, value, "finite and positive");
            }
        }
        if let Some(value) = self.amplitudes.iter().find(|a| !(a.is_finite() && **a > 0.0)) {
            return refuse("amplitudes", *value, "finite and positive");
        }
        for (key, count, least, allowed) in [
            ("max_iterations", self.max_iterations, 2, "at least 2"),
            ("max_solutions", self.max_solutions, 1, "at least 1"),
            ("max_attempts", self.max_attempts, 1, "at least 1"),
        ] {
            if count < least {
                return refuse(key, count as f64, allowed);
            }
        }
        Ok(())
    }
}
