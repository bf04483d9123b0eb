//! Branches and the states along them as one self-contained HTML file.
//!
//! [`Report`] holds plain numbers; [`Report::html`] embeds them, rounded, in a page with its script,
//! its style and the library that draws the charts. Moving along a curve, by pointer or keyboard,
//! shows the state at that point.

mod outline;
mod page;
mod round;

pub use outline::Outline;

use serde::Serialize;

/// Everything on the page.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Report {
    /// Title of the page.
    pub title: String,
    /// A line below it.
    pub subtitle: String,
    /// What the curves are drawn over, and of; the first chart is the largest.
    pub charts: Vec<Chart>,
    /// The curves.
    pub curves: Vec<Curve>,
    /// The curve that is selected at first.
    pub selected: usize,
    /// What stands above and below the shell, for the legend.
    pub bounds: String,
}

/// A chart of the curves.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Chart {
    /// What it shows.
    pub title: String,
    /// Column of the abscissa, and the axis' title.
    pub x: (String, String),
    /// Title of the other axis.
    pub y: String,
    /// Columns of the ordinate with their names. A chart of one shows all curves, a chart of several
    /// the selected curve alone.
    pub columns: Vec<(String, String)>,
}

/// A branch.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Curve {
    /// Its name.
    pub label: String,
    /// Its columns by name, all equally long; NaN is not defined.
    #[serde(serialize_with = "round::columns")]
    pub columns: Vec<(String, Vec<f64>)>,
    /// Number of unstable modes at every point, negative where it is not known.
    pub unstable: Vec<i32>,
    /// Special points.
    pub marks: Vec<Mark>,
    /// Properties by name, one value for every point.
    #[serde(serialize_with = "round::flags")]
    pub flags: Vec<(String, Vec<bool>)>,
    /// Points to which the state before them jumps; in order.
    pub jumps: Vec<usize>,
    /// States along the curve, in order.
    pub states: Vec<State>,
}

/// A special point.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Mark {
    /// The point of the curve that it is.
    pub point: usize,
    /// Its kind, as in the tables.
    pub kind: String,
    /// Unstable modes before and after, where they are known for the point itself; else the page
    /// takes those of its neighbours.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unstable: Option<[Option<usize>; 2]>,
}

/// The state at a point: an axisymmetric, mirror-symmetric shell between two plates or rings.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct State {
    /// The point of the curve.
    pub point: usize,
    /// Height of the upper plate, or of the plane of the upper ring.
    #[serde(serialize_with = "round::number")]
    pub plate: f64,
    /// The meridian, from the pole to the equator.
    #[serde(flatten)]
    pub outline: Outline,
}

impl Report {
    /// The page.
    ///
    /// # Errors
    /// What the writer of JSON reports; memory does not fail, so none is expected.
    pub fn html(&self) -> Result<String, serde_json::Error> {
        page::page(&self.title, &serde_json::to_string(self)?)
    }
}
