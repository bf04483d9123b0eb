//! Settings of a diagram.

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
}

impl Default for DiagramSettings {
    fn default() -> Self {
        DiagramSettings { trace: Settings::default(), depth: 2, max_branches: 1000 }
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
        self.trace.validate()
    }
}
