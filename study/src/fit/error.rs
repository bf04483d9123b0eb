//! Why a curve has no fit, and a measurement no plan.

use crate::case::document::shown;
use crate::units::UnitError;
use identify::data::read::LARGEST;
use identify::{DataError, FitError, Key, LawName, ModelError};
use std::fmt;
use std::io;

/// What may be asked of a fit beside the values of the laboratory ([`Wishes`](super::lab::Wishes)).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wish {
    /// A key keeps its known value.
    Fix,
    /// A key is looked for.
    Free,
    /// A value is known with an error.
    Prior,
    /// Heights between which samples count.
    Range,
    /// Quantities that get a profile of their own.
    Profile,
}

impl fmt::Display for Wish {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Wish::Fix => "fix",
            Wish::Free => "free",
            Wish::Prior => "prior",
            Wish::Range => "range",
            Wish::Profile => "profile",
        })
    }
}

/// What is wrong with what is known and asked for, whatever the curve.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SetupError {
    /// No such key.
    #[error("{wish} {}: unknown key; allowed: {}", shown(.name), .allowed.join(", "))]
    UnknownKey {
        /// Where it was named.
        wish: Wish,
        /// The name.
        name: String,
        /// What is allowed.
        allowed: Vec<&'static str>,
    },
    /// A list of profiles that is none.
    #[error(
        "{} {name}: unknown; allowed: none, or young, thickness, sqrt_chi_kb, chi, bending, adhesion, film, \
         radius, apart by commas",
        Wish::Profile
    )]
    UnknownProfile {
        /// What stands there.
        name: String,
    },
    /// A key without a value cannot keep it.
    #[error("{} {name}: there is no value to keep; give it in the file of known values", Wish::Fix)]
    NothingToKeep {
        /// The key, as it was named.
        name: String,
    },
    /// Not a quantity of the right kind.
    #[error("{wish}: {key} = {}: {error}", shown(.text))]
    Quantity {
        /// Where it stands.
        wish: Wish,
        /// Of which key.
        key: &'static str,
        /// As written.
        text: String,
        /// What is wrong with it.
        error: UnitError,
    },
    /// Not a number.
    #[error("{wish}: {key} = {}: must be a number", shown(.text))]
    Number {
        /// Where it stands.
        wish: Wish,
        /// Of which key.
        key: &'static str,
        /// As written.
        text: String,
    },
    /// A prior that is not `KEY=VALUE:SD`.
    #[error(
        "{} {}: expected KEY=VALUE:SD, for example radius=\"1.5 um\":\"0.05 um\"",
        Wish::Prior,
        shown(.text)
    )]
    PriorForm {
        /// As written.
        text: String,
    },
    /// A prior of nothing, or with no error.
    #[error("{} {name}: value and standard deviation must be positive", Wish::Prior)]
    PriorSign {
        /// The key, as it was named.
        name: String,
    },
    /// A range that is not `A:B`.
    #[error(
        "{} {}: expected two piezo heights such as \"7.5 um\":\"8.6 um\"",
        Wish::Range,
        shown(.text)
    )]
    RangeForm {
        /// As written.
        text: String,
    },
    /// A range between equal heights.
    #[error("{} {}: the heights must differ", Wish::Range, shown(.text))]
    RangeEmpty {
        /// As written.
        text: String,
    },
    /// The share `b` of a law that has none.
    #[error("{wish} b: the law {} has no b; only mooney-rivlin has", .law.name())]
    NoShare {
        /// Where it was named.
        wish: Wish,
        /// The law.
        law: LawName,
    },
    /// Something that has to be known is not.
    #[error(transparent)]
    Missing(#[from] Missing),
}

/// What has to be known, and is not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Missing {
    /// The law.
    #[error(
        "shell.law: missing; say law = \"hooke\", \"mooney-rivlin\" or \"skalak\" in the file of known values"
    )]
    Law,
    /// The lever's stiffness.
    #[error(
        "instrument.spring_constant: missing; neither the file of known values nor the curve states it"
    )]
    SpringConstant,
    /// The bubble's radius.
    #[error("physical.radius: missing; give the optical radius, and its error as radius_sd")]
    Radius,
    /// The noise, of a planned measurement.
    #[error("instrument.noise: missing; the standard deviation of the force")]
    Noise,
}

/// Why a curve has no fit.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Failure {
    /// A file that cannot be read.
    #[error("{file}: cannot be read: {source}")]
    Unreadable {
        /// Its path.
        file: String,
        /// What the system says.
        source: io::Error,
    },
    /// A file that is no curve.
    #[error("{file}: longer than {LARGEST} bytes; this is not a curve")]
    TooLong {
        /// Its path.
        file: String,
    },
    /// A file whose content is no curve.
    #[error("{}", of_curve(.curve, .file, .error))]
    Data {
        /// The file, and of a map which curve.
        curve: String,
        /// The file's path.
        file: String,
        /// What is wrong with it.
        error: Box<DataError>,
    },
    /// What is known or asked for makes no fit.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The fit found nothing, or was stopped.
    #[error("{curve}: {error}")]
    Fit {
        /// The file, and of a map which curve.
        curve: String,
        /// Why.
        error: FitError,
    },
}

/// Whose fault it is that there is no fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// A file, or what is known, is wrong.
    Input,
    /// Nothing fits the curve.
    NotFound,
    /// Stopped before there was anything to keep.
    Stopped,
}

impl Failure {
    /// Whose fault it is.
    pub fn fault(&self) -> Fault {
        match self {
            Failure::Fit { error: FitError::Stopped, .. } => Fault::Stopped,
            Failure::Fit { error: FitError::NoStart | FitError::Model(_), .. } => Fault::NotFound,
            _ => Fault::Input,
        }
    }
}

/// The error of a file, with which curve of a map it is.
fn of_curve(curve: &str, file: &str, error: &DataError) -> String {
    let message = error.to_string();
    message.strip_prefix(file).map(|rest| format!("{curve}{rest}")).unwrap_or(message)
}

/// Why a measurement has no plan.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// A case without plates.
    #[error("{case}: problem: only a contact case has a lever; problem = \"contact\"")]
    NotContact {
        /// Its name.
        case: String,
    },
    /// A case with a device of its own.
    #[error(
        "{case}: device: a plan reads the path as plate distances and takes its lever from LAB; leave the table \
         out"
    )]
    Device {
        /// Its name.
        case: String,
    },
    /// A case without units.
    #[error("{case}: physical: missing; a plan needs the shell in physical units")]
    NotPhysical {
        /// Its name.
        case: String,
    },
    /// A potential that fits do not know.
    #[error(
        "{case}: physical.potential: fits and plans know the potential four-two only; a plan needs adhesion and \
         film"
    )]
    Potential {
        /// The case's name.
        case: String,
    },
    /// What is known or asked for makes no plan.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The measurement cannot be computed.
    #[error("{case}: {error}")]
    Model {
        /// The case's name.
        case: String,
        /// Why.
        error: ModelError,
    },
}

impl From<Missing> for PlanError {
    fn from(missing: Missing) -> Self {
        PlanError::Setup(missing.into())
    }
}

/// The names of keys.
pub(super) fn keys() -> Vec<&'static str> {
    Key::ALL.map(Key::name).to_vec()
}
