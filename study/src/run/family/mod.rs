//! Families of problems: what each kind must be able to do so that every run knows it.
//!
//! A family is one file here, with its solver's details beside it in `run`, and one line in [`of`].

mod catalogue;
mod contact;
mod ring_load;
mod two_plates;

use super::diagram::{DiagramObserver, Work};
use super::map::{Attempt, MapError, Second, Task};
use super::{Observer, RunError};
use crate::case::{ProblemCase, ResolvedCase};
use crate::record::{CycleResult, DiagramResult, Outline, TraceResult};

/// What is wanted of a trace besides its points and special points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wanted {
    /// Nothing: there are many cases.
    Nothing,
    /// What pictures show.
    Pictures,
    /// The same, and the states along the branch.
    States,
}

/// A kind of problem.
pub(super) trait Family {
    /// Its problem's name in case files.
    fn name(&self) -> &str;

    /// Traces a case.
    fn trace(
        &self,
        case: &ResolvedCase,
        wanted: Wanted,
        observer: &mut Observer<'_>,
    ) -> Result<TraceResult, RunError>;

    /// Explores the diagram of a case.
    fn diagram(
        &self,
        case: &ResolvedCase,
        work: Work<'_>,
        observer: &mut DiagramObserver<'_>,
    ) -> Result<DiagramResult, RunError>;

    /// Closes and opens the plates of a case once, if it has any.
    fn cycle(
        &self,
        case: &ResolvedCase,
        _reported: bool,
        _observer: &mut Observer<'_>,
    ) -> Result<CycleResult, RunError> {
        Err(RunError::NoPlates { case: case.name.clone(), problem: self.name().to_owned() })
    }

    /// Follows the periodic orbits of a case's branch, if its problem may have any.
    fn orbits(
        &self,
        case: &ResolvedCase,
        _hopf: Option<usize>,
        _observer: &mut DiagramObserver<'_>,
    ) -> Result<DiagramResult, RunError> {
        Err(RunError::NoOrbits { case: case.name.clone(), problem: self.name().to_owned() })
    }

    /// The second parameter that a key names.
    fn second_parameter(&self, case: &ResolvedCase, key: &str) -> Result<Second, MapError>;

    /// The base branch of a map with the second parameter at a value, and the curves from it.
    fn attempt(
        &self,
        task: &Task<'_>,
        at: f64,
        observer: &mut Observer<'_>,
    ) -> Result<Attempt, MapError>;

    /// The meridian of a state of one of its branches at a value of the continued parameter: none without a
    /// shell, or where the state is not admissible.
    fn meridian(
        &self,
        _case: &ResolvedCase,
        _u: &[f64],
        _parameter: f64,
    ) -> Result<Option<Outline>, RunError> {
        Ok(None)
    }

    /// `delta_A / R0`, for a shell whose curve is of a class of the phase diagram.
    fn film(&self) -> Option<f64> {
        None
    }
}

/// The family of a problem.
pub(super) fn of(problem: &ProblemCase) -> &dyn Family {
    match problem {
        ProblemCase::Contact(case) => case,
        ProblemCase::TwoPlates(case) => case,
        ProblemCase::RingLoad(case) => case,
        ProblemCase::Catalogue(case) => case,
    }
}
