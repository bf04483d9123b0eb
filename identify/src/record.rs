//! What a fit reports: plain records, serialisable; all numbers in SI units.

use crate::uncertainty::profile::ProfilePoint;
use crate::uncertainty::verdict::{Reach, Verdict};
use serde::Serialize;

/// A quantity with what is known of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// Its name.
    pub key: String,
    /// Its value.
    pub value: f64,
    /// Its SI unit; empty for pure numbers.
    pub unit: &'static str,
    /// Standard deviation.
    pub sd: Option<f64>,
    /// What would be left of it, by the covariance, if the lever's stiffness were known exactly.
    pub sd_statistical: Option<f64>,
    /// Ends of the 68 % interval; null: open.
    pub interval68: [Option<f64>; 2],
    /// Ends of the 95 % interval.
    pub interval95: [Option<f64>; 2],
    /// `covariance`, `profile`, or `fixed`.
    pub method: &'static str,
    /// What was known beforehand.
    pub prior: Option<PriorRecord>,
    /// By how many standard deviations of the prior the estimate lies above it.
    pub prior_pull: Option<f64>,
    /// Whether it is at a bound of the search.
    pub at_bound: bool,
    /// What may be said of it.
    pub verdict: Option<Verdict>,
}

/// A prior.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PriorRecord {
    /// Its value.
    pub value: f64,
    /// Its standard deviation.
    pub sd: f64,
}

/// A jump of the lever.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Jump {
    /// `approach` or `retract`.
    pub direction: &'static str,
    /// Piezo height of the last sample before it, m.
    pub height_measured: f64,
    /// Piezo height at the model's fold; null where its stretch goes on.
    pub height_modelled: Option<f64>,
    /// Force before it, baseline taken away, N.
    pub force_before: f64,
    /// Force after it.
    pub force_after: f64,
}

/// The most attractive force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PullOff {
    /// Among the samples, baseline taken away, N.
    pub measured: f64,
    /// Of the model at the samples.
    pub modelled: f64,
}

/// How good the fit is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Quality {
    /// `χ²` over degrees of freedom.
    pub chi2_dof: f64,
    /// Standard deviation of the noise, from third differences, N.
    pub noise: f64,
    /// Autocorrelation of the residuals at the next sample.
    pub residual_autocorrelation: f64,
    /// Factor by which the variance of the data was widened for both.
    pub widened: f64,
    /// Condition number of the normal matrix, scaled to a unit diagonal.
    pub condition: f64,
    /// Samples that were fitted.
    pub samples_used: usize,
    /// All samples.
    pub samples: usize,
    /// Starts that were compared.
    pub starts: usize,
    /// Different minima that fit about as well, this one included.
    pub minima: usize,
    /// Whether the descent settled.
    pub converged: bool,
    /// Elements from pole to equator.
    pub elements: usize,
}

/// A remark on a fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Warning {
    /// A word for programs.
    pub code: &'static str,
    /// A sentence for people.
    pub text: String,
}

/// A profile.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ProfileRecord {
    /// Of what.
    pub key: String,
    /// Values of the quantity.
    pub values: Vec<f64>,
    /// Growth of the cost at each.
    pub points: Vec<ProfilePoint>,
}

/// What it cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Cost {
    /// Evaluations of the model, profiles included.
    pub evaluations: usize,
}

/// A fit's report.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// The curve.
    pub curve: String,
    /// The membrane's law.
    pub law: &'static str,
    /// Poles that deform.
    pub contacts: u8,
    /// Parameters, fitted ones first.
    pub parameters: Vec<Estimate>,
    /// `young`, `thickness`, `sqrt_chi_kb`.
    pub derived: Vec<Estimate>,
    /// Piezo height of the contact point: where the plates would be `2 R0` apart, m.
    pub contact: f64,
    /// Baseline: force at the farthest sample, N, and its slope by approach, N/m.
    pub baseline: Baseline,
    /// Jumps of the lever.
    pub jumps: Vec<Jump>,
    /// Most attractive force.
    pub pull_off: PullOff,
    /// How far into the shell's regimes the curve goes.
    pub reach: Reach,
    /// How good the fit is.
    pub quality: Quality,
    /// The combination that is known least, in words.
    pub weakest_direction: String,
    /// Remarks.
    pub warnings: Vec<Warning>,
    /// Profiles.
    pub profiles: Vec<ProfileRecord>,
    /// What it cost.
    pub cost: Cost,
}

/// A baseline.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Baseline {
    /// Force at the farthest sample, N.
    pub offset: f64,
    /// Slope by approach, N/m.
    pub tilt: f64,
}

/// A sample with its fit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Row {
    /// `approach` or `retract`.
    pub segment: &'static str,
    /// Piezo height, m.
    pub piezo: f64,
    /// Distance of the plates, m: twice the height of one above the equator where both poles deform.
    pub separation: f64,
    /// Approach of one pole beyond the free radius, m.
    pub approach_one_pole: f64,
    /// Force as measured, N.
    pub force: f64,
    /// The model, N.
    pub model: f64,
    /// Force minus model, N.
    pub residual: f64,
    /// Whether the sample was fitted.
    pub used: bool,
}

impl Report {
    /// Whether the model describes the data: settled, and `χ²/dof ≤ 2`.
    pub fn is_good(&self) -> bool {
        let stopped = self.warnings.iter().any(|warning| warning.code == "stopped");
        self.quality.converged && self.quality.chi2_dof <= 2.0 && !stopped
    }

    /// A quantity by its name.
    pub fn estimate(&self, key: &str) -> Option<&Estimate> {
        self.derived.iter().chain(&self.parameters).find(|e| e.key == key)
    }
}
