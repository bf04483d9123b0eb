//! A traced branch as plain numbers, free of solver and problem.

use super::column::{Column, PLATES};
use super::orbits::CycleRecord;
use super::outline::State;
use super::summary::count;
use super::view::{Curve, Profile, Shape};
use crate::case::picture::PLATES as AXES;
use continuation::{Eigenvector, StopReason};
use serde::{Deserialize, Serialize};

/// One cell of a table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Cell {
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
pub struct Table {
    columns: Vec<String>,
    rows: Vec<Vec<Cell>>,
    /// What is known of columns of these names.
    #[serde(skip)]
    known: &'static [Column],
}

impl Table {
    /// An empty table with the given columns.
    pub fn with_columns(columns: &[&str]) -> Self {
        let columns = columns.iter().map(ToString::to_string).collect();
        Table { columns, ..Table::default() }
    }

    /// The same with labels and units for its columns.
    pub(crate) fn described(self, known: &'static [Column]) -> Self {
        Table { known, ..self }
    }

    /// An empty table of a contact problem: the fixed columns, then `event`.
    pub fn contact() -> Self {
        Self::with_columns(&ContactRow::COLUMNS).described(PLATES)
    }

    /// An empty table of any other problem: `point`, the parameter, observables, `unstable`,
    /// `event`.
    pub fn general(parameter: &str, observables: &[&str]) -> Self {
        let first = ["point", parameter].into_iter();
        let columns: Vec<&str> =
            first.chain(observables.iter().copied()).chain(["unstable", "event"]).collect();
        Self::with_columns(&columns)
    }

    /// The same with further columns at the end.
    pub fn and(mut self, columns: Vec<String>) -> Self {
        self.columns.extend(columns);
        self
    }

    /// The numbers of a column, NaN where there is none; empty without such a column.
    pub fn numbers(&self, column: &str) -> Vec<f64> {
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

    /// The same with more columns, and their cells row by row.
    pub(crate) fn beside(&self, columns: &[&str], cells: Vec<Vec<Cell>>) -> Table {
        let names = columns.iter().map(ToString::to_string).collect();
        let mut out = Table { rows: Vec::new(), ..self.clone() }.and(names);
        for (row, more) in self.rows.iter().zip(cells) {
            out.push(row.iter().cloned().chain(more).collect());
        }
        out
    }

    /// The same without the rows that have this word in a column.
    pub(crate) fn without(&self, column: &str, word: &str) -> Table {
        let at = self.columns.iter().position(|name| name == column);
        let is_one = |row: &&Vec<Cell>| matches!(at.map(|at| &row[at]), Some(Cell::Text(own)) if own == word);
        let rows = self.rows.iter().filter(|row| !is_one(row)).cloned().collect();
        Table { columns: self.columns.clone(), rows, known: self.known }
    }

    /// The words of a column, with the numbers of their rows.
    pub fn words(&self, column: &str) -> impl Iterator<Item = (usize, &str)> {
        let at = self.columns.iter().position(|name| name == column);
        self.rows.iter().enumerate().filter_map(move |(row, cells)| match &cells[at?] {
            Cell::Text(word) => Some((row, word.as_str())),
            _ => None,
        })
    }

    /// Add a row; a short one is filled up with empty cells, what is too long is cut.
    pub fn push(&mut self, mut row: Vec<Cell>) {
        row.resize(self.columns.len(), Cell::Empty);
        self.rows.push(row);
    }

    /// Changes all numbers of a column.
    pub fn convert(&mut self, column: &str, change: impl Fn(f64) -> f64) {
        let Some(at) = self.columns.iter().position(|name| name == column) else { return };
        for row in &mut self.rows {
            if let Cell::Real(value) = row[at] {
                row[at] = Cell::Real(change(value));
            }
        }
    }

    /// What a column is, in words: its name where there is nothing better.
    pub fn label<'a>(&self, column: &'a str) -> &'a str {
        self.about(column).map_or(column, |known| known.label)
    }

    /// The unit of a column; empty for counts, words and what has none.
    pub fn unit(&self, column: &str) -> &'static str {
        self.about(column).map_or("", |known| known.unit)
    }

    fn about(&self, column: &str) -> Option<&'static Column> {
        self.known.iter().find(|known| known.name == column)
    }

    /// Names of the columns.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// The rows, as long as [`Self::columns`] each.
    pub fn rows(&self) -> &[Vec<Cell>] {
        &self.rows
    }
}

/// One point of a contact branch; NaN stands for "not defined".
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ContactRow {
    /// Number of the point, from zero.
    pub point: usize,
    /// Plate distance, in R0.
    pub z0: f64,
    /// Deformation from the first zero of the force on approach, in R0.
    pub deformation: f64,
    /// Force on one plate, in sqrt(chi k_b), positive in compression.
    pub force: f64,
    /// Unstable modes at fixed plate distance.
    pub unstable: Option<usize>,
    /// Height of the pole above the equator, in R0.
    pub pole_height: f64,
    /// Pressure of the gas, in chi/R0.
    pub gas_pressure: f64,
    /// Volume of the whole shell, in R0³.
    pub volume: f64,
    /// Total energy of the whole shell, in chi R0², as the others.
    pub energy_total: f64,
    /// Energy of stretching.
    pub energy_stretching: f64,
    /// Energy of bending.
    pub energy_bending: f64,
    /// Energy of the film.
    pub energy_film: f64,
    /// Energy of the gas, zero at the initial volume.
    pub energy_gas: f64,
    /// Surface tension times the deformed area.
    pub energy_surface: f64,
    /// Radius of the contact region, in R0.
    pub contact_radius: f64,
    /// Kind of the special point that this is, else empty.
    pub event: String,
}

impl ContactRow {
    /// The columns, in the order in which files have them.
    pub const COLUMNS: [&'static str; 16] = {
        let mut all = ["point"; 16];
        // between them what pictures may have on an axis
        let mut k = 0;
        while k < AXES.len() {
            all[k + 1] = AXES[k];
            k += 1;
        }
        all[15] = "event";
        all
    };

    /// The cells, in the order of [`Self::COLUMNS`].
    pub fn cells(&self) -> Vec<Cell> {
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
pub struct EventRecord {
    /// Kind, as in the contract: `fold`, `branch-point`, `zero-force`, …
    pub kind: String,
    /// Value of the continued parameter.
    pub parameter: Option<f64>,
    /// Plate distance, where the continued parameter is another.
    pub z0: Option<f64>,
    /// Force.
    pub force: Option<f64>,
    /// Deformation.
    pub deformation: Option<f64>,
    /// Total energy.
    pub energy_total: Option<f64>,
    /// Unstable modes before, along the branch.
    pub unstable_before: Option<usize>,
    /// Unstable modes after.
    pub unstable_after: Option<usize>,
    /// Largest component of the residual.
    pub residual: Option<f64>,
    /// Estimated error of the location.
    pub error_estimate: Option<f64>,
    /// Further observables by name, for problems whose observables are not the ones above.
    pub observables: Vec<(String, f64)>,
    /// What the normal form says.
    pub form: FormRecord,
    /// What the mesh moves, where that was estimated.
    pub mesh_error: Option<PlaceError>,
    /// The mode without the branch's symmetries that turns here.
    pub mode: Option<ModeRecord>,
    /// The solver's unknowns here; files leave them out.
    pub u: Vec<f64>,
    /// Eigenvectors to the critical eigenvalues, of length 1: of the branch's own unknowns.
    pub eigenvectors: Vec<Eigenvector>,
    /// On a branch of periodic orbits, what is known of the cycle.
    pub cycle: Option<CycleRecord>,
}

/// A mode without the symmetries of its branch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeRecord {
    /// Waves around the axis.
    pub n: usize,
    /// `symmetric` or `antisymmetric` about the equator.
    pub parity: &'static str,
    /// Unstable modes of its class before, along the branch.
    pub before: usize,
    /// And after.
    pub after: usize,
}

/// The amplitudes of a mode at a special point, at the knots from the pole to the equator: radial and
/// axial ones times `cos nφ`, those around the axis times `sin nφ`.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapeRecord {
    /// Number of the special point.
    pub event: usize,
    /// Waves around the axis.
    pub n: usize,
    /// `symmetric` or `antisymmetric` about the equator.
    pub parity: &'static str,
    /// Knots.
    pub s: Vec<f64>,
    /// Radial, around the axis, axial.
    pub amplitudes: [Vec<f64>; 3],
}

/// Which modes the stability of a contact branch was examined for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct StabilityRecord {
    /// Whether more than axisymmetric mirror images.
    pub full: bool,
    /// Whether axisymmetric modes that break the mirror symmetry are among the branch's own.
    pub both_parities: bool,
    /// The most waves that were examined.
    pub max_n: Option<usize>,
    /// Whether every count is certain.
    pub certain: Option<bool>,
    /// Changes of a count that are not among the special points.
    pub not_located: usize,
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
pub struct ResolutionRecord {
    /// Elements per film length; infinite without a film.
    pub per_film_length: f64,
    /// Elements per wavelength of the shell.
    pub per_wavelength: f64,
    /// How many of both are called enough.
    pub needed: [f64; 2],
    /// Where that is.
    pub at: f64,
    /// Of which quantity: `z0`, or the parameter of a shell without plates.
    pub parameter: &'static str,
    /// Whether both are enough.
    pub enough: bool,
    /// Elements of the mesh.
    pub elements: usize,
    /// Elements that would be enough there.
    pub wanted: usize,
    /// How far the mesh moves the branch, where that was estimated.
    pub mesh_error: Option<MeshErrorRecord>,
    /// The error of the mesh that was asked for, where one was.
    pub tolerance: Option<f64>,
}

/// Estimates of what the mesh changes along a branch, from one twice as fine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshErrorRecord {
    /// Of the force at a given plate distance, in `√(χk_b)`, where that is worst among the points looked at.
    pub force: f64,
    /// Where that is, in `z0`.
    pub at: f64,
    /// Of the plate distance of folds and zeros of the force, the worst.
    pub z0: Option<f64>,
    /// Of the extreme forces, the worst.
    pub extremum: Option<f64>,
    /// How many points were looked at for the force.
    pub samples: usize,
}

/// The same at a special point: of its plate distance and of the force there, each where it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceError {
    /// In `R0`.
    pub z0: Option<f64>,
    /// In `√(χk_b)`.
    pub force: Option<f64>,
}

impl ResolutionRecord {
    /// A warning in a sentence, where there is one to be given.
    pub(super) fn text(&self) -> String {
        if self.enough {
            return self.mesh_error.map_or_else(String::new, |error| {
                self.asked().unwrap_or_else(|| "mesh: ".to_owned()) + &error.text()
            });
        }
        let film = if self.per_film_length.is_finite() {
            format!("{:.2} per film length ({} needed) and ", self.per_film_length, self.needed[0])
        } else {
            String::new()
        };
        format!(
            "not resolved: at {} = {:.5} {} elements are {film}{:.1} per wavelength of the shell ({} \
             needed): folds and forces may be those of the mesh; take mesh.elements = {} or more\n",
            self.parameter,
            self.at,
            self.elements,
            self.per_wavelength,
            self.needed[1],
            self.wanted,
        )
    }

    /// Whether the mesh's error is below what was asked for, at all places that were looked at; `None` where nothing
    /// was asked for, or nothing is known: of a branch that is not resolved no estimate holds.
    pub fn meets_tolerance(&self) -> Option<bool> {
        let (tolerance, error) = (self.tolerance?, self.mesh_error?);
        let special = [error.z0, error.extremum].into_iter().flatten();
        self.enough.then(|| special.fold(error.force, f64::max) <= tolerance)
    }

    /// What was asked for, and whether it was met.
    fn asked(&self) -> Option<String> {
        let (tolerance, elements) = (self.tolerance?, self.elements);
        Some(if self.meets_tolerance()? {
            format!("mesh: {elements} elements for mesh.tolerance = {tolerance:e}; ")
        } else {
            format!(
                "mesh: mesh.tolerance = {tolerance:e} is not met by {elements} elements: take a smaller one; "
            )
        })
    }

    /// A title that says it.
    pub fn titled(&self, title: &str) -> String {
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

impl MeshErrorRecord {
    /// What people see.
    fn text(&self) -> String {
        let MeshErrorRecord { force, samples, .. } = self;
        let places = self.z0.map_or_else(String::new, |x| {
            format!(", folds and zeros of the force by at most {x:.0e} in z0")
        });
        format!(
            "halving the elements moves the force by at most {force:.0e} at {samples} \
             points{places}\n"
        )
    }
}

/// Two states of equal total potential at one value of the device's parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct MaxwellRecord {
    /// Name of the parameter.
    pub parameter: &'static str,
    /// Its value.
    pub value: f64,
    /// Total potential of both.
    pub potential: f64,
    /// Plate distances.
    pub z0: [f64; 2],
    /// Forces.
    pub force: [f64; 2],
    /// Energies without the device.
    pub energy: [f64; 2],
    /// Unstable modes.
    pub unstable: [Option<usize>; 2],
    /// Estimated error of the parameter.
    pub error_estimate: f64,
}

/// The normal form of a special point; what does not apply is `None`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FormRecord {
    /// `transcritical`, `pitchfork`, `multiple` or `degenerate` of a branch point; `supercritical`
    /// or `subcritical` of a Hopf point.
    pub kind: Option<&'static str>,
    /// `supercritical` or `subcritical`.
    pub criticality: Option<&'static str>,
    /// Number of modes that become critical at a branch point.
    pub multiplicity: Option<usize>,
    /// Number of other branches through it.
    pub branches: Option<usize>,
    /// Second derivative of the parameter by the arclength, at a fold or along a pitchfork.
    pub curvature: Option<f64>,
    /// The power with which the parameter turns at a fold, where that is above two.
    pub order: Option<usize>,
    /// Imaginary part of the critical eigenvalues of a Hopf point.
    pub frequency: Option<f64>,
    /// Its first Lyapunov coefficient.
    pub lyapunov: Option<f64>,
    /// Estimated error of that.
    pub lyapunov_error: Option<f64>,
    /// Whether the numbers of unstable modes are certain.
    pub certified: Option<bool>,
}

/// Everything a trace hands over.
#[derive(Debug, Clone, PartialEq)]
pub struct TraceResult {
    /// Name of the case.
    pub case: String,
    /// Name of the continued parameter: `z0`, or the problem's own.
    pub parameter: String,
    /// The points.
    pub table: Table,
    /// The special points, in order along the branch.
    pub events: Vec<EventRecord>,
    /// Pairs of states of equal potential; `None` where that has no meaning.
    pub maxwell: Option<Vec<MaxwellRecord>>,
    /// What its stability was examined for; `None` where that has no meaning.
    pub stability: Option<StabilityRecord>,
    /// How well its elements resolve a contact branch; `None` where that was not examined.
    pub resolution: Option<ResolutionRecord>,
    /// Why the branch ended.
    pub stopped_because: StopReason,
    /// The same in a sentence; may be empty.
    pub stopped_detail: String,
    /// Number of points.
    pub points: usize,
    /// Whether all numbers of unstable modes are certain.
    pub certified: Option<bool>,
    /// Jacobian assemblies.
    pub newton_iterations: usize,
    /// From the resolved case to the last point and event.
    pub seconds: f64,
    /// Modes at special points where the branch's symmetries are lost.
    pub shapes: Vec<ShapeRecord>,
    /// What the pictures show.
    pub pictures: Pictures,
}

/// What the pictures of a trace show; a picture without data is not drawn.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Pictures {
    /// Title of every picture.
    pub title: String,
    /// Force against deformation.
    pub force_deformation: Option<Curve>,
    /// Force against plate distance.
    pub force_distance: Option<Curve>,
    /// Deformed shapes at a few points.
    pub shapes: Vec<Shape>,
    /// Disjoining pressure at the same points.
    pub film_pressure: Vec<Profile>,
    /// Energy components against deformation.
    pub energies: Vec<Curve>,
    /// First observable against the parameter, for other problems; with the axes' labels.
    pub diagram: Option<(String, String, Curve)>,
    /// States along the branch, for a report, if one was asked for.
    pub states: Vec<State>,
}
