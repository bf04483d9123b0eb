//! A traced branch as plain numbers, free of solver and problem.

use super::summary::count;
use crate::pictures::{Curve, Profile, Shape};
use continuation::StopReason;
use serde::{Deserialize, Serialize};

/// One cell of a table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) enum Cell {
    /// A number; anything but a finite one is written as an empty cell.
    #[serde(rename = "r")]
    Real(f64),
    /// A count.
    #[serde(rename = "n")]
    Count(usize),
    /// A word.
    #[serde(rename = "t")]
    Text(String),
    /// Not defined.
    #[serde(rename = "e")]
    Empty,
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Cell::Real(value)
    }
}

impl From<Option<f64>> for Cell {
    fn from(value: Option<f64>) -> Self {
        value.map_or(Cell::Empty, Cell::Real)
    }
}

impl From<usize> for Cell {
    fn from(value: usize) -> Self {
        Cell::Count(value)
    }
}

impl From<Option<usize>> for Cell {
    fn from(value: Option<usize>) -> Self {
        value.map_or(Cell::Empty, Cell::Count)
    }
}

impl From<&str> for Cell {
    fn from(value: &str) -> Self {
        if value.is_empty() { Cell::Empty } else { Cell::Text(value.to_string()) }
    }
}

/// The points of a branch: named columns and rows in order along the branch.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Table {
    columns: Vec<String>,
    rows: Vec<Vec<Cell>>,
}

impl Table {
    /// An empty table with the given columns.
    pub(crate) fn with_columns(columns: &[&str]) -> Self {
        Table { columns: columns.iter().map(ToString::to_string).collect(), rows: Vec::new() }
    }

    /// An empty table of a contact problem: the fixed columns, then `event`.
    pub(crate) fn contact() -> Self {
        Self::with_columns(&ContactRow::COLUMNS)
    }

    /// An empty table of any other problem: `point`, the parameter, observables, `unstable`,
    /// `event`.
    pub(crate) fn general(parameter: &str, observables: &[&str]) -> Self {
        let first = ["point", parameter].into_iter();
        let columns: Vec<&str> =
            first.chain(observables.iter().copied()).chain(["unstable", "event"]).collect();
        Self::with_columns(&columns)
    }

    /// The same with further columns at the end.
    pub(crate) fn and(mut self, columns: Vec<String>) -> Self {
        self.columns.extend(columns);
        self
    }

    /// The numbers of a column, NaN where there is none; empty without such a column.
    pub(crate) fn numbers(&self, column: &str) -> Vec<f64> {
        let Some(at) = self.columns.iter().position(|name| name == column) else {
            return Vec::new();
        };
        let number = |row: &Vec<Cell>| match row[at] {
            Cell::Real(value) => value,
            Cell::Count(count) => count as f64,
            _ => f64::NAN,
        };
        self.rows.iter().map(number).collect()
    }

    /// The words of a column, with the numbers of their rows.
    pub(crate) fn words(&self, column: &str) -> impl Iterator<Item = (usize, &str)> {
        let at = self.columns.iter().position(|name| name == column);
        self.rows.iter().enumerate().filter_map(move |(row, cells)| match &cells[at?] {
            Cell::Text(word) => Some((row, word.as_str())),
            _ => None,
        })
    }

    /// Add a row; a short one is filled up with empty cells, what is too long is cut.
    pub(crate) fn push(&mut self, mut row: Vec<Cell>) {
        row.resize(self.columns.len(), Cell::Empty);
        self.rows.push(row);
    }

    /// Changes all numbers of a column.
    pub(crate) fn convert(&mut self, column: &str, change: impl Fn(f64) -> f64) {
        let Some(at) = self.columns.iter().position(|name| name == column) else { return };
        for row in &mut self.rows {
            if let Cell::Real(value) = row[at] {
                row[at] = Cell::Real(change(value));
            }
        }
    }

    /// Names of the columns.
    pub(crate) fn columns(&self) -> &[String] {
        &self.columns
    }

    /// The rows, as long as [`Self::columns`] each.
    pub(crate) fn rows(&self) -> &[Vec<Cell>] {
        &self.rows
    }
}

/// One point of a contact branch; NaN stands for "not defined".
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct ContactRow {
    /// Number of the point, from zero.
    pub(crate) point: usize,
    /// Plate distance, in R0.
    pub(crate) z0: f64,
    /// Deformation from the first zero of the force on approach, in R0.
    pub(crate) deformation: f64,
    /// Force on one plate, in sqrt(chi k_b), positive in compression.
    pub(crate) force: f64,
    /// Unstable modes at fixed plate distance.
    pub(crate) unstable: Option<usize>,
    /// Height of the pole above the equator, in R0.
    pub(crate) pole_height: f64,
    /// Pressure of the gas, in chi/R0.
    pub(crate) gas_pressure: f64,
    /// Volume of the whole shell, in R0³.
    pub(crate) volume: f64,
    /// Total energy of the whole shell, in chi R0², as the others.
    pub(crate) energy_total: f64,
    /// Energy of stretching.
    pub(crate) energy_stretching: f64,
    /// Energy of bending.
    pub(crate) energy_bending: f64,
    /// Energy of the film.
    pub(crate) energy_film: f64,
    /// Energy of the gas, zero at the initial volume.
    pub(crate) energy_gas: f64,
    /// Surface tension times the deformed area.
    pub(crate) energy_surface: f64,
    /// Radius of the contact region, in R0.
    pub(crate) contact_radius: f64,
    /// Kind of the special point that this is, else empty.
    pub(crate) event: String,
}

impl ContactRow {
    /// The columns, in the order in which files have them.
    pub(crate) const COLUMNS: [&'static str; 16] = [
        "point",
        "z0",
        "deformation",
        "force",
        "unstable",
        "pole_height",
        "gas_pressure",
        "volume",
        "energy_total",
        "energy_stretching",
        "energy_bending",
        "energy_film",
        "energy_gas",
        "energy_surface",
        "contact_radius",
        "event",
    ];

    /// The cells, in the order of [`Self::COLUMNS`].
    pub(crate) fn cells(&self) -> Vec<Cell> {
        vec![
            self.point.into(),
            self.z0.into(),
            self.deformation.into(),
            self.force.into(),
            self.unstable.into(),
            self.pole_height.into(),
            self.gas_pressure.into(),
            self.volume.into(),
            self.energy_total.into(),
            self.energy_stretching.into(),
            self.energy_bending.into(),
            self.energy_film.into(),
            self.energy_gas.into(),
            self.energy_surface.into(),
            self.contact_radius.into(),
            self.event.as_str().into(),
        ]
    }
}

/// A special point; what is not defined is `None`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct EventRecord {
    /// Kind, as in the contract: `fold`, `branch-point`, `zero-force`, …
    pub(crate) kind: String,
    /// Value of the continued parameter.
    pub(crate) parameter: Option<f64>,
    /// Plate distance, where the continued parameter is another.
    pub(crate) z0: Option<f64>,
    /// Force.
    pub(crate) force: Option<f64>,
    /// Deformation.
    pub(crate) deformation: Option<f64>,
    /// Total energy.
    pub(crate) energy_total: Option<f64>,
    /// Unstable modes before, along the branch.
    pub(crate) unstable_before: Option<usize>,
    /// Unstable modes after.
    pub(crate) unstable_after: Option<usize>,
    /// Largest component of the residual.
    pub(crate) residual: Option<f64>,
    /// Estimated error of the location.
    pub(crate) error_estimate: Option<f64>,
    /// Further observables by name, for problems whose observables are not the ones above.
    pub(crate) observables: Vec<(String, f64)>,
    /// What the normal form says.
    pub(crate) form: FormRecord,
    /// The mode without the branch's symmetries that turns here.
    pub(crate) mode: Option<ModeRecord>,
}

/// A mode without the symmetries of its branch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ModeRecord {
    /// Waves around the axis.
    pub(crate) n: usize,
    /// `symmetric` or `antisymmetric` about the equator.
    pub(crate) parity: &'static str,
    /// Unstable modes of its class before, along the branch.
    pub(crate) before: usize,
    /// And after.
    pub(crate) after: usize,
}

/// The amplitudes of a mode at a special point, at the knots from the pole to the equator: radial and
/// axial ones times `cos nφ`, those around the axis times `sin nφ`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ShapeRecord {
    /// Number of the special point.
    pub(crate) event: usize,
    /// Waves around the axis.
    pub(crate) n: usize,
    /// `symmetric` or `antisymmetric` about the equator.
    pub(crate) parity: &'static str,
    /// Knots.
    pub(crate) s: Vec<f64>,
    /// Radial, around the axis, axial.
    pub(crate) amplitudes: [Vec<f64>; 3],
}

/// Which modes the stability of a contact branch was examined for.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct StabilityRecord {
    /// Whether more than axisymmetric mirror images.
    pub(crate) full: bool,
    /// Whether axisymmetric modes that break the mirror symmetry are among the branch's own.
    pub(crate) both_parities: bool,
    /// The most waves that were examined.
    pub(crate) max_n: Option<usize>,
    /// Whether every count is certain.
    pub(crate) certain: Option<bool>,
    /// Changes of a count that are not among the special points.
    pub(crate) not_located: usize,
}

impl StabilityRecord {
    /// What was examined, in sentences.
    pub(super) fn text(&self) -> String {
        let mut text = match (self.full, self.certain) {
            (false, _) if self.both_parities => {
                "stability: against axisymmetric modes only, with and without mirror symmetry\n"
            }
            (false, _) => "stability: against axisymmetric mirror images only\n",
            (true, Some(true)) => "stability: with and without symmetry, torsion left out\n",
            (true, _) => {
                "stability: with and without symmetry, torsion left out; not certain at every point\n"
            }
        }
        .to_owned();
        if self.not_located > 0 {
            let number = count(self.not_located, "loss of symmetry lies", "losses of symmetry lie");
            text += &format!("{number} between points, not located\n");
        }
        text
    }

    /// The same of several branches.
    pub(super) fn and(self, other: &StabilityRecord) -> StabilityRecord {
        StabilityRecord {
            full: self.full && other.full,
            both_parities: self.both_parities && other.both_parities,
            max_n: self.max_n.max(other.max_n),
            certain: self.certain.zip(other.certain).map(|(a, b)| a && b),
            not_located: self.not_located + other.not_located,
        }
    }
}

/// How well the elements resolve what the solution varies on, where that is worst.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ResolutionRecord {
    /// Elements per film length.
    pub(crate) per_film_length: f64,
    /// Elements per wavelength of the shell.
    pub(crate) per_wavelength: f64,
    /// How many of both are called enough.
    pub(crate) needed: [f64; 2],
    /// Plate distance where that is.
    pub(crate) z0: f64,
    /// Whether both are enough.
    pub(crate) enough: bool,
    /// Elements of the mesh.
    pub(crate) elements: usize,
    /// Elements that would be enough there.
    pub(crate) wanted: usize,
}

impl ResolutionRecord {
    /// A warning in a sentence, where there is one to be given.
    pub(super) fn text(&self) -> String {
        if self.enough {
            return String::new();
        }
        format!(
            "not resolved: at z0 = {:.5} {} elements are {:.2} per film length ({} needed) \
             and {:.1} per wavelength of the shell ({} needed): folds and forces may be those of the \
             mesh; take mesh.elements = {} or more\n",
            self.z0,
            self.elements,
            self.per_film_length,
            self.needed[0],
            self.per_wavelength,
            self.needed[1],
            self.wanted,
        )
    }

    /// A title that says it.
    pub(crate) fn titled(&self, title: &str) -> String {
        if self.enough {
            title.to_owned()
        } else {
            format!("{title} (elements too long: not resolved)")
        }
    }

    /// The worse of two.
    pub(super) fn and(self, other: &ResolutionRecord) -> ResolutionRecord {
        let ratio = |one: &ResolutionRecord| one.wanted as f64 / one.elements as f64;
        if ratio(&self) >= ratio(other) { self } else { *other }
    }
}

/// Two states of equal total potential at one value of the device's parameter.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MaxwellRecord {
    /// Name of the parameter.
    pub(crate) parameter: &'static str,
    /// Its value.
    pub(crate) value: f64,
    /// Total potential of both.
    pub(crate) potential: f64,
    /// Plate distances.
    pub(crate) z0: [f64; 2],
    /// Forces.
    pub(crate) force: [f64; 2],
    /// Energies without the device.
    pub(crate) energy: [f64; 2],
    /// Unstable modes.
    pub(crate) unstable: [Option<usize>; 2],
    /// Estimated error of the parameter.
    pub(crate) error_estimate: f64,
}

/// The normal form of a special point; what does not apply is `None`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct FormRecord {
    /// `transcritical`, `pitchfork`, `multiple` or `degenerate` of a branch point; `supercritical`
    /// or `subcritical` of a Hopf point.
    pub(crate) kind: Option<&'static str>,
    /// `supercritical` or `subcritical`.
    pub(crate) criticality: Option<&'static str>,
    /// Number of modes that become critical at a branch point.
    pub(crate) multiplicity: Option<usize>,
    /// Number of other branches through it.
    pub(crate) branches: Option<usize>,
    /// Second derivative of the parameter by the arclength, at a fold or along a pitchfork.
    pub(crate) curvature: Option<f64>,
    /// The power with which the parameter turns at a fold, where that is above two.
    pub(crate) order: Option<usize>,
    /// Imaginary part of the critical eigenvalues of a Hopf point.
    pub(crate) frequency: Option<f64>,
    /// Its first Lyapunov coefficient.
    pub(crate) lyapunov: Option<f64>,
    /// Estimated error of that.
    pub(crate) lyapunov_error: Option<f64>,
    /// Whether the numbers of unstable modes are certain.
    pub(crate) certified: Option<bool>,
}

/// Everything a trace hands over.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TraceResult {
    /// Name of the case.
    pub(crate) case: String,
    /// Name of the continued parameter: `z0`, or the problem's own.
    pub(crate) parameter: String,
    /// The points.
    pub(crate) table: Table,
    /// The special points, in order along the branch.
    pub(crate) events: Vec<EventRecord>,
    /// Pairs of states of equal potential; `None` where that has no meaning.
    pub(crate) maxwell: Option<Vec<MaxwellRecord>>,
    /// What its stability was examined for; `None` where that has no meaning.
    pub(crate) stability: Option<StabilityRecord>,
    /// How well its elements resolve a contact branch; `None` where that was not examined.
    pub(crate) resolution: Option<ResolutionRecord>,
    /// Why the branch ended.
    pub(crate) stopped_because: StopReason,
    /// The same in a sentence; may be empty.
    pub(crate) stopped_detail: String,
    /// Number of points.
    pub(crate) points: usize,
    /// Whether all numbers of unstable modes are certain.
    pub(crate) certified: Option<bool>,
    /// Jacobian assemblies.
    pub(crate) newton_iterations: usize,
    /// From the resolved case to the last point and event.
    pub(crate) seconds: f64,
    /// Modes at special points where the branch's symmetries are lost.
    pub(crate) shapes: Vec<ShapeRecord>,
    /// What the pictures show.
    pub(crate) pictures: Pictures,
}

/// What the pictures of a trace show; a picture without data is not drawn.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Pictures {
    /// Title of every picture.
    pub(crate) title: String,
    /// Force against deformation.
    pub(crate) force_deformation: Option<Curve>,
    /// Force against plate distance.
    pub(crate) force_distance: Option<Curve>,
    /// Deformed shapes at a few points.
    pub(crate) shapes: Vec<Shape>,
    /// Disjoining pressure at the same points.
    pub(crate) film_pressure: Vec<Profile>,
    /// Energy components against deformation.
    pub(crate) energies: Vec<Curve>,
    /// First observable against the parameter, for other problems; with the axes' labels.
    pub(crate) diagram: Option<(String, String, Curve)>,
    /// States along the branch, for a report, if one was asked for.
    pub(crate) states: Vec<report::State>,
}
