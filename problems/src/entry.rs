//! An entry of the catalogue: its name, what it takes, what is known of it.

use crate::Id;
use continuation::{NewtonError, Settings, TraceError};
use std::fmt;

/// A problem of the catalogue with its defaults and its known answers.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Its name.
    pub name: &'static str,
    /// What it is, in a line.
    pub summary: &'static str,
    /// The continued parameter.
    pub parameter: &'static str,
    /// The parameter and the observables, by name, with what axes of pictures call them.
    pub axes: &'static [(&'static str, &'static str)],
    /// Where the parameter starts.
    pub start: f64,
    /// Where it may start.
    pub start_allowed: Allowed,
    /// Where the trace ends. Where the branch turns back before it, an observable ends the trace
    /// (see [`crate::Setup::watches`]).
    pub end: f64,
    /// Further parameters.
    pub parameters: &'static [Constant],
    /// Size of the discretisation, where there is one.
    pub elements: Option<Elements>,
    /// What is known, at the default parameters and elements.
    pub known: &'static [Known],
    pub(crate) id: Id,
}

/// A further parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constant {
    /// Its name.
    pub name: &'static str,
    /// Its default.
    pub default: f64,
    /// What it may be.
    pub allowed: Allowed,
}

/// Size of a discretisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Elements {
    /// Its default.
    pub default: usize,
    /// The smallest.
    pub least: usize,
    /// The largest.
    pub most: usize,
    /// What is counted.
    pub what: &'static str,
}

/// A range of finite numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Allowed {
    /// Any.
    Any,
    /// Greater than this.
    Above(f64),
    /// Less than this.
    Below(f64),
    /// At least this.
    AtLeast(f64),
    /// From the first to the second, both included.
    Within(f64, f64),
    /// A whole number from the first to the second, both included.
    Count(usize, usize),
}

impl Allowed {
    /// Whether `value` is allowed.
    pub fn holds(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Allowed::Any => true,
                Allowed::Above(low) => value > low,
                Allowed::Below(high) => value < high,
                Allowed::AtLeast(low) => value >= low,
                Allowed::Within(low, high) => (low..=high).contains(&value),
                Allowed::Count(low, high) => {
                    value.fract() == 0.0 && (low as f64..=high as f64).contains(&value)
                }
            }
    }
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Allowed::Any => write!(f, "a finite number"),
            Allowed::Above(0.0) => write!(f, "positive"),
            Allowed::Above(low) => write!(f, "greater than {low}"),
            Allowed::Below(0.0) => write!(f, "negative"),
            Allowed::Below(high) => write!(f, "less than {high}"),
            Allowed::AtLeast(low) => write!(f, "at least {low}"),
            Allowed::Within(low, high) => write!(f, "from {low} to {high}"),
            Allowed::Count(low, high) => write!(f, "a whole number from {low} to {high}"),
        }
    }
}

/// A special point that is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    /// What it is: a kind of event by its name in files (`fold`, `branch-point`, `hopf`), or a
    /// point of two parameters (`cusp`, `bogdanov-takens`).
    pub kind: &'static str,
    /// More about it (`transcritical`, `pitchfork`, `double`), else empty.
    pub form: &'static str,
    /// Value of the continued parameter.
    pub value: f64,
    /// Value of a second parameter, for points of two parameters.
    pub second: Option<(&'static str, f64)>,
    /// To how much the value is known: relative, absolute for the value 0.
    pub tolerance: f64,
    /// Where it is met.
    pub on: On,
    /// Where the value comes from.
    pub source: &'static str,
}

/// Where a known point is met.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum On {
    /// On the branch that the default trace follows.
    FirstBranch,
    /// On a branch that leaves the first one.
    AfterSwitching,
    /// On a curve of folds or Hopf points.
    TwoParameters,
}

impl Known {
    const fn new(kind: &'static str, value: f64, tolerance: f64, source: &'static str) -> Known {
        let on = On::FirstBranch;
        Known { kind, form: "", value, second: None, tolerance, on, source }
    }

    pub(crate) const fn fold(value: f64, tolerance: f64, source: &'static str) -> Known {
        Known::new("fold", value, tolerance, source)
    }

    pub(crate) const fn branch_point(value: f64, tolerance: f64, source: &'static str) -> Known {
        Known::new("branch-point", value, tolerance, source)
    }

    pub(crate) const fn hopf(value: f64, tolerance: f64, source: &'static str) -> Known {
        Known::new("hopf", value, tolerance, source)
    }

    /// A point of two parameters.
    pub(crate) const fn double(
        kind: &'static str,
        value: f64,
        second: (&'static str, f64),
        tolerance: f64,
        source: &'static str,
    ) -> Known {
        let known = Known::new(kind, value, tolerance, source);
        Known { second: Some(second), on: On::TwoParameters, ..known }
    }

    pub(crate) const fn form(self, form: &'static str) -> Known {
        Known { form, ..self }
    }

    pub(crate) const fn after_switching(self) -> Known {
        Known { on: On::AfterSwitching, ..self }
    }

    /// Whether `value` is the known one, to its tolerance.
    pub fn agrees(&self, value: f64) -> bool {
        let size = if self.value == 0.0 { 1.0 } else { self.value.abs() };
        (value - self.value).abs() <= self.tolerance * size
    }
}

/// What is asked of a problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Start of the continued parameter.
    pub start: f64,
    /// Values of the further parameters, in the order of [`Entry::parameters`].
    pub parameters: Vec<f64>,
    /// Size of the discretisation; of no effect where there is none.
    pub elements: usize,
    /// How to trace; the target is the end.
    pub settings: Settings,
}

impl Request {
    /// Value of a further parameter; `check` has seen to it that it is there.
    pub(crate) fn parameter(&self, k: usize) -> f64 {
        self.parameters.get(k).copied().unwrap_or(f64::NAN)
    }
}

impl Entry {
    /// The problem as it is by default.
    pub fn request(&self) -> Request {
        Request {
            start: self.start,
            parameters: self.parameters.iter().map(|constant| constant.default).collect(),
            elements: self.elements.map_or(0, |elements| elements.default),
            settings: Settings { target: Some(self.end), ..Settings::default() },
        }
    }

    pub(crate) fn check(&self, request: &Request) -> Result<(), ProblemError> {
        let refuse = |key: String, value: f64, allowed: Allowed| {
            if allowed.holds(value) {
                Ok(())
            } else {
                Err(ProblemError::OutOfRange { key, value, allowed })
            }
        };
        let (expected, got) = (self.parameters.len(), request.parameters.len());
        if got != expected {
            return Err(ProblemError::Parameters { name: self.name, expected, got });
        }
        for (constant, value) in self.parameters.iter().zip(&request.parameters) {
            refuse(format!("parameters.{}", constant.name), *value, constant.allowed)?;
        }
        if let Some(elements) = self.elements {
            let allowed = Allowed::Count(elements.least, elements.most);
            refuse("mesh.elements".to_owned(), request.elements as f64, allowed)?;
        }
        refuse("path.start".to_owned(), request.start, self.start_allowed)
    }
}

/// Why a problem of the catalogue cannot be had, or not be traced.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProblemError {
    /// A value that makes no problem.
    #[error("{key} = {value}: must be {allowed}")]
    OutOfRange {
        /// Its key in case files.
        key: String,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: Allowed,
    },
    /// Not as many parameters as the entry lists.
    #[error("{name} takes {expected} further parameters, not {got}")]
    Parameters {
        /// Name of the entry.
        name: &'static str,
        /// How many there are.
        expected: usize,
        /// How many were given.
        got: usize,
    },
    /// No solution to start from.
    #[error("path.start = {value}: no solution there: {cause}")]
    Start {
        /// The start.
        value: f64,
        /// What Newton's method says.
        cause: NewtonError,
    },
    /// The trace could not begin.
    #[error(transparent)]
    Trace(#[from] TraceError),
}
