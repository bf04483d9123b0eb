//! What can be wrong with a case, in words that name the place, the value and the way out.

use super::document::Origin;
use crate::units::UnitError;
use std::fmt;
use std::io;

/// Why there is no case.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// Neither a file nor a known name.
    #[error("{name}: neither a case file nor a known name{}; a case file ends in .toml, known names are: {}", did_you_mean(.suggestion.as_deref()), .known.join(", "))]
    UnknownName {
        /// What was asked for.
        name: String,
        /// The nearest known name.
        suggestion: Option<String>,
        /// All known names.
        known: Vec<String>,
    },
    /// A file that is not there.
    #[error("{file}: no such file")]
    Missing {
        /// Its path.
        file: String,
    },
    /// A folder in place of a file.
    #[error("{file}: this is a folder; give the path of a case file inside it")]
    Folder {
        /// Its path.
        file: String,
    },
    /// A file that cannot be read.
    #[error("{file}: cannot be read: {source}")]
    Unreadable {
        /// Its path.
        file: String,
        /// What the system says.
        source: io::Error,
    },
    /// A file too large to be a case file.
    #[error("{file}: longer than {limit} bytes; this is not a case file")]
    TooLong {
        /// Its path.
        file: String,
        /// What is allowed.
        limit: u64,
    },
    /// A file that is not text.
    #[error("{file}, line {line}: not UTF-8 text; save the case file as UTF-8")]
    NotUtf8 {
        /// Its path.
        file: String,
        /// Line of the first bad byte.
        line: usize,
    },
    /// Text that is not TOML.
    #[error("{file}, line {line}: {message}\n  {text}")]
    Syntax {
        /// Its path.
        file: String,
        /// Where.
        line: usize,
        /// What is wrong, and what to do.
        message: String,
        /// The line itself.
        text: String,
    },
    /// An override that cannot be applied.
    #[error("{given_by} {text}: {message}")]
    Override {
        /// The word for where it was given.
        given_by: &'static str,
        /// As given.
        text: String,
        /// What is wrong, and what to do.
        message: String,
    },
    /// Values that are wrong, in order of appearance.
    #[error("{}", lines(.0))]
    Invalid(Vec<CaseError>),
}

fn lines(errors: &[CaseError]) -> String {
    errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

/// One thing wrong with a case.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub struct CaseError {
    /// The file, or the name of the shipped case.
    pub file: String,
    /// Where it came from.
    pub origin: Origin,
    /// Full TOML path of the key.
    pub key: String,
    /// The value as written, if there is one.
    pub value: Option<String>,
    /// What is wrong with it.
    pub complaint: Complaint,
}

impl fmt::Display for CaseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}: {}", self.file, self.origin, self.key)?;
        if let Some(value) = &self.value {
            write!(f, " = {value}")?;
        }
        write!(f, ": {}", self.complaint)
    }
}

/// What is wrong with a key or its value.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Complaint {
    /// A key that means nothing here.
    #[error("unknown key{}{}; allowed here: {}", did_you_mean(.suggestion.as_deref()), elsewhere(.belongs), .allowed.join(", "))]
    UnknownKey {
        /// What may stand here.
        allowed: Vec<String>,
        /// The nearest of those.
        suggestion: Option<String>,
        /// The table in which the key does mean something.
        belongs: Option<&'static str>,
    },
    /// A key without which there is no case.
    #[error("missing; {hint}")]
    Missing {
        /// What to write.
        hint: String,
    },
    /// A value of the wrong type.
    #[error("expected {expected}, got {found}{hint}")]
    WrongType {
        /// The type that is allowed.
        expected: String,
        /// The type found.
        found: &'static str,
        /// What to do; may be empty.
        hint: &'static str,
    },
    /// A value outside its range.
    #[error("must be {allowed}")]
    OutOfRange {
        /// What is allowed.
        allowed: String,
    },
    /// A word that is not one of a few.
    #[error("must be one of {}{}", .allowed.join(", "), did_you_mean(.suggestion.as_deref()))]
    UnknownWord {
        /// What is allowed.
        allowed: Vec<String>,
        /// The nearest of those.
        suggestion: Option<String>,
    },
    /// Not a physical quantity of the right kind.
    #[error(transparent)]
    Unit(#[from] UnitError),
    /// Values that do not go together.
    #[error("{0}")]
    Conflict(String),
}

fn did_you_mean(suggestion: Option<&str>) -> String {
    suggestion.map_or_else(String::new, |word| format!(" (did you mean \"{word}\"?)"))
}

fn elsewhere(table: &Option<&'static str>) -> String {
    table.map_or_else(String::new, |table| format!(" (it belongs in [{table}])"))
}
