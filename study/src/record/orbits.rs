//! Branches of periodic orbits: what is known of each cycle, and a few of them over time.

use super::result::{Cell, Table};
use super::view::Curve;
use continuation::cycles::Multiplier;
use serde::ser::{Serialize, SerializeMap, Serializer};

/// What is known of a cycle at a special point.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CycleRecord {
    /// The period.
    pub period: f64,
    /// Estimated relative error of it; `None` where it is not known.
    pub period_error: Option<f64>,
    /// Floquet multipliers, the largest first, the trivial one among them.
    pub multipliers: Vec<Multiplier>,
    /// How far the trivial one is from 1.
    pub trivial_error: Option<f64>,
}

/// One cycle over time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct OrbitRecord {
    /// Number of its point on the branch.
    pub point: usize,
    /// Value of the continued parameter.
    pub parameter: f64,
    /// The period.
    pub period: f64,
    /// What it is, for a legend.
    pub label: String,
    /// Whether it is unstable; `None` where that is not known.
    pub unstable: Option<bool>,
    /// Times, from zero to the period.
    pub t: Vec<f64>,
    /// One list of values for each observable.
    pub values: Vec<Vec<f64>>,
}

/// What a branch of cycles has beyond its points.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct OrbitsRecord {
    /// Period over the parameter.
    pub period: Curve,
    /// Names of the observables, or of the unknowns.
    pub names: Vec<String>,
    /// A few cycles along the branch: first, last, at special points, and some between.
    pub orbits: Vec<OrbitRecord>,
    /// The Hopf point at which they vanish, where it is on a branch of the diagram: branch and event.
    pub vanishes_at: Option<(usize, usize)>,
}

impl OrbitsRecord {
    /// The cycles as one table, each from time zero to its period.
    pub fn table(&self, parameter: &str) -> Table {
        let columns: Vec<&str> = ["point", parameter, "t"]
            .into_iter()
            .chain(self.names.iter().map(String::as_str))
            .collect();
        let mut table = Table::with_columns(&columns);
        for orbit in &self.orbits {
            for (at, t) in orbit.t.iter().enumerate() {
                let mut row: Vec<Cell> =
                    vec![orbit.point.into(), orbit.parameter.into(), (*t).into()];
                row.extend(orbit.values.iter().map(|values| Cell::from(values[at])));
                table.push(row);
            }
        }
        table
    }
}

/// What was done about the cycles of a diagram.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CyclesRecord {
    /// Number of Hopf points on the branches of equilibria.
    pub hopf_points: usize,
    /// Whether their cycles were asked for.
    pub wanted: bool,
    /// Whether every branch of cycles was followed to an end of its own and nothing is open.
    pub complete: bool,
    /// What is open, in sentences.
    pub open: Vec<String>,
}

impl Serialize for CyclesRecord {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("hopf_points", &self.hopf_points)?;
        map.serialize_entry("followed", &self.wanted)?;
        map.serialize_entry("complete", &(self.wanted && self.complete))?;
        map.serialize_entry("open", &self.open)?;
        map.end()
    }
}

/// Multipliers as JSON: real and imaginary part, null where they are no finite numbers; the logarithm of
/// the modulus and the argument, which are numbers always.
pub(super) struct MultipliersOf<'a>(pub(super) &'a [Multiplier]);

impl Serialize for MultipliersOf<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.iter().map(MultiplierOf))
    }
}

struct MultiplierOf<'a>(&'a Multiplier);

impl Serialize for MultiplierOf<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Multiplier { log_modulus, argument, error } = self.0;
        let (re, im) = self.0.value();
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("re", &re)?;
        map.serialize_entry("im", &im)?;
        map.serialize_entry("log_modulus", log_modulus)?;
        map.serialize_entry("argument", argument)?;
        map.serialize_entry("error", error)?;
        map.end()
    }
}
