//! Settings of a diagram.

use crate::deflation::DeflationSettings;
use crate::near::NearSettings;
use crate::settings::{Settings, SettingsError};
use serde::{Deserialize, Serialize};

/// How a diagram is explored.
///
/// ```
/// use continuation::{Settings, diagram::DiagramSettings};
/// let trace = Settings { domain: Some((0.0, 2.0)), ..Settings::default() };
/// let settings = DiagramSettings { trace, depth: 1, ..DiagramSettings::default() };
/// assert!(settings.validate().is_ok());
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DiagramSettings {
    /// How branches are traced. Without a target the first branch is followed both ways in the
    /// domain; with one, or without a domain, one way to its end. All others stay in the domain;
    /// without one, in the range of the parameter on the first branch.
    pub trace: Settings,
    /// Most branch points between a branch and the first one: with 0 there is only the first, with
    /// 1 also those that leave it.
    pub depth: usize,
    /// Most branches.
    pub max_branches: usize,
    /// How disconnected branches are sought beside near-bifurcations; `None`: not at all.
    pub search: Option<Search>,
}

/// How disconnected branches are sought.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Search {
    /// What counts as a near-bifurcation.
    pub near: NearSettings,
    /// How further solutions are sought beside it.
    pub deflation: DeflationSettings,
}

impl Default for DiagramSettings {
    fn default() -> Self {
        DiagramSettings {
            trace: Settings::default(),
            depth: 2,
            max_branches: 1000,
            search: Some(Search::default()),
        }
    }
}

impl DiagramSettings {
    /// Checks every value.
    ///
    /// # Errors
    /// The first setting that is out of range.
    pub fn validate(&self) -> Result<(), SettingsError> {
        if self.max_branches == 0 {
            return Err(SettingsError { key: "max_branches", value: 0.0, allowed: "at least 1" });
        }
        if let Some(search) = &self.search {
            search.near.validate()?;
            search.deflation.validate()?;
        }
        self.trace.validate()
    }
}
