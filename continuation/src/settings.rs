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

/// How unstable modes are counted where the matrix is not symmetric.
///
/// Symmetric matrices cost nothing extra in any storage: their inertia comes with the factors. The
/// same holds where the symmetric part is definite. [`crate::Point::certified`] says at every point
/// whether the number is certain.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Counting {
    /// All eigenvalues up to 120 unknowns ([`crate::linalg::Dense`]: up to 600), some 10 ms a
    /// point; beyond it the few nearest to zero, which give a lower bound.
    #[default]
    Automatic,
    /// All eigenvalues up to 600 unknowns, whatever the storage: certain, and half a second a point
    /// at 400 unknowns. Beyond it the eigenvalues on the unstable side are counted by the argument
    /// principle ([`crate::linalg::count_right`]): certain, for 300 to 500 complex factorisations a
    /// point. With a mass matrix that is not symmetric and positive definite counts stay uncertain.
    Full,
    /// The few eigenvalues nearest to zero: never certain, cheap at every size.
    Few,
}

/// How a branch is traced. Lengths are arclengths in the problem's metric
/// ([`crate::Problem::metric`]); a range is that of the continued parameter: the distance from the
/// start to the target, else the width of the domain, else the parameter's scale.
///
/// ```
/// use continuation::Settings;
/// let settings = Settings { target: Some(2.0), max_step: Some(0.1), ..Settings::default() };
/// assert!(settings.validate().is_ok());
/// let error = Settings { max_angle: 3.0, ..settings }.validate().unwrap_err();
/// assert_eq!((error.key, error.value), ("max_angle", 3.0));
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// The trace ends the first time the parameter takes this value after leaving its start; met
    /// exactly, as the last point, which is no event. A target at the start is met at once, by a trace
    /// of one point, unless [`Settings::increasing`] says which way it is to be left first.
    pub target: Option<f64>,
    /// The trace ends where the parameter meets a bound of this interval, of which one may be infinite, with
    /// the start inside; met exactly, as the last point. No state outside is evaluated, but for the
    /// differences: those of a problem that has no derivatives of its own, and those for the normal form
    /// of a branch point, which look how far the nonlinearity lets them.
    pub domain: Option<(f64, f64)>,
    /// Whether the parameter increases at first; `None`: towards the target, else upwards. Without
    /// meaning for [`crate::Tracer::leaving`], which has a direction.
    pub increasing: Option<bool>,
    /// Longest step; `None`: a twentieth of the parameter's range in scaled arclength.
    pub max_step: Option<f64>,
    /// Shortest step; `None`: 1e-10 of the parameter's range in scaled arclength.
    pub min_step: Option<f64>,
    /// First step; `None`: a tenth of the longest.
    pub first_step: Option<f64>,
    /// Largest number of points, at least 2; special points of the last step may come on top.
    pub max_points: usize,
    /// Corrections smaller than this have converged, relative to 1 plus the size of the state, in
    /// the scaled metric, in which unknowns and parameter are divided by their ranges.
    pub tolerance: f64,
    /// Most corrector iterations in a step, at least 2; a good step needs three.
    pub max_iterations: usize,
    /// Largest angle between successive tangents, and between tangents and secant, in radians and
    /// in the scaled metric; below 1.5.
    pub max_angle: f64,
    /// Number of eigenvalues, the most unstable ones, to compute at every point
    /// ([`crate::Point::eigenvalues`]); costs an assembly and some solves each.
    pub eigenvalues: usize,
    /// How unstable modes are counted where the matrix is not symmetric.
    pub counting: Counting,
    /// Folds, zeros and extrema are located to this distance along the branch, in the scaled
    /// metric. Branch points and Hopf points are met by Newton's method, to rounding.
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
            counting: Counting::Automatic,
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
