//! Special points: test functions, their detection in a step, and their location.

mod detect;
mod extrapolate;
mod flat;
mod hermite;
mod locate;
mod root;
mod watched;

pub(crate) use detect::{Beside, Candidate, Detector, Plateau, Role};
pub(crate) use extrapolate::{Hidden, Stretch};
pub(crate) use flat::flat_fold;
pub(crate) use hermite::basis;
pub(crate) use locate::{Located, bend, interpolate, locate};
pub(crate) use watched::locate_watched;

use serde::{Deserialize, Serialize};

/// A scalar function to watch along a branch; see [`crate::Tracer::watching`]. The start of the branch
/// does not count.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Watch {
    /// An observable takes this value: an event [`Zero`](crate::EventKind::Zero) if that is 0, else
    /// [`Named`](crate::EventKind::Named).
    Value {
        /// Name of the observable.
        observable: String,
        /// The value.
        level: f64,
        /// Whether the trace ends there.
        stop: bool,
    },
    /// An observable has a minimum or maximum along the branch: an event
    /// [`Minimum`](crate::EventKind::Minimum) or [`Maximum`](crate::EventKind::Maximum).
    Extremum {
        /// Name of the observable.
        observable: String,
    },
    /// The parameter takes this value: an event [`Target`](crate::EventKind::Target), every time.
    Parameter {
        /// The value, met exactly.
        value: f64,
    },
}

impl Watch {
    /// Watches for zeros of an observable.
    pub fn zero(observable: &str) -> Self {
        Watch::Value { observable: observable.to_owned(), level: 0.0, stop: false }
    }

    /// Ends the trace where an observable takes this value.
    pub fn stop_at(observable: &str, level: f64) -> Self {
        Watch::Value { observable: observable.to_owned(), level, stop: true }
    }

    /// Watches for minima and maxima of an observable.
    pub fn extremum(observable: &str) -> Self {
        Watch::Extremum { observable: observable.to_owned() }
    }

    /// Has the trace land on this value of the parameter.
    pub fn parameter(value: f64) -> Self {
        Watch::Parameter { value }
    }
}
