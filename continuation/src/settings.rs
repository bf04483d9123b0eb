//! Settings of a trace: documented defaults, validated, serialisable.

use serde::{Deserialize, Serialize};

/// A setting outside its range.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("setting `{key}` is {value}; it must be {allowed}")]
pub struct SettingsError {
    /// Name of the setting.
    pub key: &'static str,
    /// Its value.
    pub value: f64,
    /// What is allowed.
    pub allowed: &'static str,
}

/// How a branch is traced. Lengths are arclengths in the problem's metric
/// ([`crate::Problem::metric`]).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// The trace ends the first time the parameter takes this value after leaving its start.
    pub target: Option<f64>,
    /// The trace ends where the parameter leaves this interval.
    pub domain: Option<(f64, f64)>,
    /// Whether the parameter increases at first; `None`: towards the target, else upwards.
    pub increasing: Option<bool>,
    /// Longest step; `None`: a twentieth of the parameter's range in scaled arclength.
    pub max_step: Option<f64>,
    /// Shortest step; `None`: 1e-7 of the parameter's range in scaled arclength.
    pub min_step: Option<f64>,
    /// First step; `None`: a tenth of the longest.
    pub first_step: Option<f64>,
    /// Largest number of points.
    pub max_points: usize,
    /// Corrections smaller than this, relative to the scale of the unknowns, have converged.
    pub tolerance: f64,
    /// Most corrector iterations in a step; a good step needs three.
    pub max_iterations: usize,
    /// Largest angle between successive tangents, in radians.
    pub max_angle: f64,
    /// Number of eigenvalues, the most unstable ones, to compute at every point.
    pub eigenvalues: usize,
    /// Special points are located to this fraction of the scale of the unknowns.
    pub event_tolerance: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            target: None,
            domain: None,
            increasing: None,
            max_step: None,
            min_step: None,
            first_step: None,
            max_points: 5000,
            tolerance: 1e-11,
            max_iterations: 8,
            max_angle: 0.35,
            eigenvalues: 0,
            event_tolerance: 1e-12,
        }
    }
}

impl Settings {
    /// Checks every value.
    ///
    /// # Errors
    /// The first setting that is out of range.
    pub fn validate(&self) -> Result<(), SettingsError> {
        let positive = |key, value: Option<f64>| match value {
            Some(v) if !(v.is_finite() && v > 0.0) => {
                Err(SettingsError { key, value: v, allowed: "finite and positive" })
            }
            _ => Ok(()),
        };
        positive("max_step", self.max_step)?;
        positive("min_step", self.min_step)?;
        positive("first_step", self.first_step)?;
        positive("tolerance", Some(self.tolerance))?;
        positive("event_tolerance", Some(self.event_tolerance))?;
        if let (Some(lo), Some(hi)) = (self.min_step, self.max_step)
            && lo > hi
        {
            return Err(SettingsError { key: "min_step", value: lo, allowed: "at most max_step" });
        }
        if let Some(t) = self.target
            && !t.is_finite()
        {
            return Err(SettingsError { key: "target", value: t, allowed: "finite" });
        }
        if let Some((lo, hi)) = self.domain
            && (lo.is_nan() || hi.is_nan() || lo >= hi)
        {
            return Err(SettingsError { key: "domain", value: lo, allowed: "an interval lo < hi" });
        }
        if self.max_points < 2 {
            let value = self.max_points as f64;
            return Err(SettingsError { key: "max_points", value, allowed: "at least 2" });
        }
        if self.max_iterations < 2 {
            let value = self.max_iterations as f64;
            return Err(SettingsError { key: "max_iterations", value, allowed: "at least 2" });
        }
        if !(self.max_angle > 0.0 && self.max_angle < 1.5) {
            let value = self.max_angle;
            return Err(SettingsError { key: "max_angle", value, allowed: "in (0, 1.5) radians" });
        }
        Ok(())
    }
}
