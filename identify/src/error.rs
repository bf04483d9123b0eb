//! What can go wrong.

use crate::data::jpk::ArchiveError;
use continuation::{EvalError, TraceError};
use shell_contact::ParameterError;

/// Why the model has no value for some parameters.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A parameter is outside what the model allows.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A state could not be evaluated.
    #[error("a state of the branch could not be evaluated: {0}")]
    Evaluation(#[from] EvalError),
    /// The branch has no start.
    #[error("the branch has no start: {0}")]
    Trace(#[from] TraceError),
    /// The branch ends before the data do.
    #[error("the branch ends at an approach of {reached:.3e} m; the data go to {needed:.3e} m")]
    TooShort {
        /// Farthest approach of the branch, m.
        reached: f64,
        /// Farthest approach of the data, m.
        needed: f64,
    },
    /// The branch takes more work than an evaluation may.
    #[error(
        "the branch takes more than {most} points and corrections; it has come to an approach of {reached:.3e} m"
    )]
    TooDear {
        /// The budget.
        most: usize,
        /// Farthest approach of the branch, m.
        reached: f64,
    },
    /// The fit was stopped.
    #[error("stopped")]
    Stopped,
    /// No part of the branch is stable under this lever.
    #[error("no part of the branch is stable under this lever")]
    NothingStable,
}

/// Why there is no fit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// Stopped before there was anything to keep.
    #[error("stopped before a first shell was found")]
    Stopped,
    /// A quantity that must be known is not.
    #[error("{key}: not known; give its value in the file of known values, or free it")]
    Unknown {
        /// Which.
        key: &'static str,
    },
    /// No noise: a computed curve, or a constant one.
    #[error(
        "force: no noise can be read off: the force is constant or computed, or no segment has 8 samples; a fit \
         weighs the samples by their noise"
    )]
    NoNoise,
    /// The force never rises clearly above the baseline.
    #[error(
        "force: no contact: the force at the least height does not rise above the noise in at least \
         {fewest} samples; check the sign of the force (data.force_sign) and that height falls on approach"
    )]
    NoContact {
        /// Fewest samples in contact.
        fewest: usize,
    },
    /// Too few samples in contact.
    #[error(
        "force: {found} samples in contact; at least {fewest} are needed: measure farther or denser"
    )]
    FewInContact {
        /// How many there are.
        found: usize,
        /// How many are needed.
        fewest: usize,
    },
    /// Contact from the first sample on.
    #[error(
        "force: {found} samples of baseline before contact; at least {fewest} are needed, or offset and \
         contact point cannot be told apart: start farther away"
    )]
    NoBaseline {
        /// How many there are.
        found: usize,
        /// How many are needed.
        fewest: usize,
    },
    /// Units that cannot be.
    #[error(
        "height: the piezo moves by {span:.3e} m, the bubble's radius is {radius:.3e} m; one of the units \
         is wrong (data.height_unit, physical.radius)"
    )]
    Scale {
        /// Travel of the piezo, m.
        span: f64,
        /// Radius, m.
        radius: f64,
    },
    /// Plates that would have gone through each other.
    #[error(
        "height: beyond the contact point the plates approach by {squeezed:.3e} m, the lever's deflection taken off, \
         and the bubble is only {room:.3e} m thick there; a unit, the radius or the lever is wrong \
         (data.height_unit, physical.radius, instrument.spring_constant)"
    )]
    TooDeep {
        /// Approach beyond the contact point, m.
        squeezed: f64,
        /// Thickness of what deforms, m.
        room: f64,
    },
    /// Forces that the lever cannot have shown.
    #[error(
        "force: the largest, {force:.3e} N, bends a lever of {lever:.3e} N/m by {deflection:.3e} m, while the piezo \
         moves by {travel:.3e} m; one of the units is wrong (data.force_unit, instrument.spring_constant)"
    )]
    Deflection {
        /// Largest force, N.
        force: f64,
        /// Stiffness of the lever, N/m.
        lever: f64,
        /// Its deflection, m.
        deflection: f64,
        /// Travel of the piezo, m.
        travel: f64,
    },
    /// No start leads anywhere.
    #[error("no shell of the grid of starts has a branch that spans the data")]
    NoStart,
    /// The model has no value at the end.
    #[error(transparent)]
    Model(ModelError),
}

/// Why a file is no curve.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DataError {
    /// A format that is not read.
    #[error("{file}: {why}; {remedy}")]
    Format {
        /// The file.
        file: String,
        /// What it is.
        why: String,
        /// What to do.
        remedy: &'static str,
    },
    /// A JPK archive that gives no curve.
    #[error("{file}: {why}")]
    Archive {
        /// The file.
        file: String,
        /// What is wrong.
        why: Box<ArchiveError>,
    },
    /// Bytes that are no text.
    #[error("{file}, line {line}: not UTF-8 text; save the curve as UTF-8")]
    NotText {
        /// The file.
        file: String,
        /// The line.
        line: usize,
    },
    /// Nothing in it.
    #[error("{file}: no samples; expected a line of column names and a line for each sample")]
    Empty {
        /// The file.
        file: String,
    },
    /// A `.tab` without its header.
    #[error("{file}: no header; the last comment of a .tab names the columns, apart by tabs")]
    NoHeader {
        /// The file.
        file: String,
    },
    /// Metadata that are no JSON.
    #[error("{file}: the metadata are not JSON: {why}")]
    Metadata {
        /// The file.
        file: String,
        /// What is wrong.
        why: String,
    },
    /// A table that cannot be taken apart.
    #[error("{file}: {why}")]
    Table {
        /// The file.
        file: String,
        /// What is wrong.
        why: String,
    },
    /// A column that is not there.
    #[error(
        "{file}: {key}: no column \"{wanted}\"; the columns are: {found}. Name it with --set {key}=NAME"
    )]
    NoColumn {
        /// The file.
        file: String,
        /// Key that would name it.
        key: &'static str,
        /// What was looked for.
        wanted: String,
        /// What is there.
        found: String,
    },
    /// Several columns with one name.
    #[error(
        "{file}: {key}: several columns are called \"{name}\"; name one in full with --set {key}=NAME"
    )]
    ManyColumns {
        /// The file.
        file: String,
        /// Key that would tell.
        key: &'static str,
        /// The name.
        name: String,
    },
    /// A column without a unit.
    #[error(
        "{file}: {key}: the column \"{column}\" states no unit; give one of {allowed} with --set {key}=UNIT"
    )]
    NoUnit {
        /// The file.
        file: String,
        /// Key that would tell.
        key: &'static str,
        /// The column.
        column: String,
        /// What is allowed.
        allowed: String,
    },
    /// A unit of something else.
    #[error("{file}: {key} = {unit}: must be one of {allowed}")]
    Unit {
        /// The file.
        file: String,
        /// Key that would tell.
        key: &'static str,
        /// The unit.
        unit: String,
        /// What is allowed.
        allowed: String,
    },
    /// Volts.
    #[error(
        "{file}: the column \"{column}\" is in volts; a force needs {missing} (your values), or in the file of \
         known values"
    )]
    Volts {
        /// The file.
        file: String,
        /// The column.
        column: String,
        /// What is not known, and how to give it.
        missing: &'static str,
    },
    /// A field that is no number.
    #[error(
        "{file}, line {line}: {column} = \"{text}\": must be a finite number; remove the line, or see data.decimal"
    )]
    Number {
        /// The file.
        file: String,
        /// The line.
        line: usize,
        /// The column.
        column: String,
        /// What stands there.
        text: String,
    },
    /// A segment that is none.
    #[error(
        "{file}, line {line}: segment = \"{text}\": must be approach or retract (or extend, False, 0; True, 1)"
    )]
    Segment {
        /// The file.
        file: String,
        /// The line.
        line: usize,
        /// What stands there.
        text: String,
    },
    /// Heights that go the other way.
    #[error(
        "{file}: the height goes from {from:.4e} m to {to:.4e} m on {direction}; it must fall on approach: if \
         the file counts the other way, --set data.height=rises; if its lines were sorted, put them in the order \
         of time"
    )]
    Order {
        /// The file.
        file: String,
        /// Which segment.
        direction: &'static str,
        /// First height.
        from: f64,
        /// Last height.
        to: f64,
    },
    /// Heights that go to and fro.
    #[error(
        "{file}: the heights of the {direction} go to and fro; give the samples in the order of time"
    )]
    Unsorted {
        /// The file.
        file: String,
        /// Which segment.
        direction: &'static str,
    },
    /// A force that falls in contact.
    #[error(
        "{file}: the force falls from {far:.3e} N far away to {deep:.3e} N at the least height; it must be \
         positive in compression: if the file has the other sign, --set data.force_sign=-1"
    )]
    Sign {
        /// The file.
        file: String,
        /// Median far away, N.
        far: f64,
        /// Median at the least height, N.
        deep: f64,
    },
    /// A line with more fields than there are names.
    #[error(
        "{file}, line {line}: {found} fields under {names} names: numbers with a decimal comma need another separator \
         between columns (data.separator, data.decimal)"
    )]
    MoreFields {
        /// The file.
        file: String,
        /// The line.
        line: usize,
        /// How many fields it has.
        found: usize,
        /// How many columns have names.
        names: usize,
    },
    /// Commas that may be decimal.
    #[error("{file}: there are commas in numbers; say --set data.decimal=comma, or remove them")]
    DecimalComma {
        /// The file.
        file: String,
    },
    /// Commas that are both.
    #[error(
        "{file}: a decimal comma needs another separator; say --set data.separator=semicolon or tab"
    )]
    CommaTwice {
        /// The file.
        file: String,
    },
}
