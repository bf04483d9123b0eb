//! The meridian at a point of a branch.

use crate::round;
use serde::Serialize;

/// A meridian, and the pressure on it if there is one.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Outline {
    /// Distances from the axis.
    #[serde(serialize_with = "round::numbers")]
    pub sigma: Vec<f64>,
    /// Heights above the equator.
    #[serde(serialize_with = "round::numbers")]
    pub z: Vec<f64>,
    /// Pressure on it; empty without one.
    #[serde(serialize_with = "round::numbers")]
    pub pressure: Vec<f64>,
}
