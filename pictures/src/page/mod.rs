//! Branches and the states along them as one self-contained HTML file.
//!
//! [`Report`] holds plain numbers; [`Report::html`] embeds them, rounded, in a page with its script,
//! its style and the library that draws the charts. Moving along a curve, by pointer or keyboard,
//! shows the state at that point.

mod html;
mod report;
mod round;

pub(crate) use html::{STYLE, escaped};
pub use report::{REPORT, cycle_report, report};

use serde::Serialize;
use std::collections::BTreeMap;

/// Everything on the page.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
struct Report {
    /// Title of the page.
    title: String,
    /// Law and groups, or what the problem is; `_{…}` and `^{…}` set small.
    about: String,
    /// A line below them.
    subtitle: String,
    /// What the curves are drawn over, and of; the first chart is the largest.
    charts: Vec<Chart>,
    /// The curves.
    curves: Vec<Curve>,
    /// The curve that is selected at first.
    selected: usize,
    /// What stands above and below the shell, for the legend.
    bounds: String,
    /// The units of a case that is in physical ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    laboratory: Option<Units>,
}

/// Physical units: each with what dimensionless numbers are to be multiplied with.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
struct Units {
    /// Of columns, by name.
    columns: BTreeMap<String, (String, f64)>,
    /// Of the shapes.
    length: (String, f64),
    /// Of the film's pressure.
    film: (String, f64),
}

/// A chart of the curves.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
struct Chart {
    /// What it shows.
    title: String,
    /// Column of the abscissa, and the axis' title.
    x: (String, String),
    /// Title of the other axis.
    y: String,
    /// Titles of both in physical units.
    #[serde(skip_serializing_if = "Option::is_none")]
    physical: Option<(String, String)>,
    /// Columns of the ordinate with their names. A chart of one shows all curves, a chart of several
    /// the selected curve alone.
    columns: Vec<(String, String)>,
}

/// A branch.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
struct Curve {
    /// Its name.
    label: String,
    /// Its columns by name, all equally long; NaN is not defined.
    #[serde(serialize_with = "round::columns")]
    columns: Vec<(String, Vec<f64>)>,
    /// Number of unstable modes at every point, negative where it is not known.
    unstable: Vec<i32>,
    /// Special points.
    marks: Vec<Mark>,
    /// Properties by name, one value for every point.
    #[serde(serialize_with = "round::flags")]
    flags: Vec<(String, Vec<bool>)>,
    /// Points to which the state before them jumps; in order.
    jumps: Vec<usize>,
    /// States along the curve, in order.
    states: Vec<State>,
}

/// A special point.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
struct Mark {
    /// The point of the curve that it is.
    point: usize,
    /// Its kind, as in the tables.
    kind: String,
    /// Unstable modes before and after, where they are known for the point itself; else the page
    /// takes those of its neighbours.
    #[serde(skip_serializing_if = "Option::is_none")]
    unstable: Option<[Option<usize>; 2]>,
}

/// The state at a point: an axisymmetric shell between two plates or rings, its own mirror image unless it has
/// a lower plate of its own.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
struct State {
    /// The point of the curve.
    point: usize,
    /// Height of the upper plate, or of the plane of the upper ring.
    #[serde(serialize_with = "round::number")]
    plate: f64,
    /// Height of the lower plate, of a shell from pole to pole; null for one that is not there.
    #[serde(serialize_with = "round::optional", skip_serializing_if = "Option::is_none")]
    below: Option<f64>,
    /// The meridian, from the pole to the equator or to the other pole: distances from the axis.
    #[serde(serialize_with = "round::numbers")]
    sigma: Vec<f64>,
    /// Heights above the equator.
    #[serde(serialize_with = "round::numbers")]
    z: Vec<f64>,
    /// Pressure on it; empty without one.
    #[serde(serialize_with = "round::numbers")]
    pressure: Vec<f64>,
}

impl Report {
    /// The page.
    ///
    /// # Errors
    /// What the writer of JSON reports; memory does not fail, so none is expected.
    fn html(&self) -> Result<String, serde_json::Error> {
        html::page(&self.title, &serde_json::to_string(self)?)
    }
}
