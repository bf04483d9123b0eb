//! Further solutions of `f(u, p) = 0` at the same parameters: deflation.
//!
//! Newton's method finds one solution; from another start often the same again. Deflation removes
//! the known solutions `u_i`: the zeros of
//! ```text
//! m(u) f(u),    m = Π (1 + ℓ²/|u − u_i|²),
//! ```
//! are those of `f` without them, and where the iteration has converged to one solution, the same
//! start leads to another. The factor tends to 1 far away, where the problem is not disturbed. The
//! Jacobian `m J + f ∇mᵀ` is full, but not needed: the step is the plain one, `−J⁻¹f`, times a
//! number, so that the problem's own factorisation serves. Distances are those of the problem's
//! metric, divided by a length `ℓ` of the problem itself, so that units do not matter.
//!
//! No method finds all solutions of a general problem. What decides is where attempts start. Here:
//! beside every known solution, along its softest directions, either way, at multiples of the
//! amplitude at which the Jacobian changes; at any states that are handed over, of which those of
//! the same branch at other parameters ([`Deflation::along`]) are the best, for a branch that is
//! not connected at one value often comes near at another. Every start is used again until it leads
//! to nothing new, and all are tried again when a solution was found, until a round over all of
//! them finds none. The report says how many attempts that took and how they ended.
//!
//! ```
//! use continuation::{deflation::{DeflationSettings, further_solutions}, samples::Cusp};
//!
//! // μ + x − x³ at μ = 0, where x = 1 is known
//! let settings = DeflationSettings::default();
//! let mut found = further_solutions(&Cusp, &[0.0, 1.0], &[vec![1.0]], settings)?;
//! found.sort_by(|a, b| a[0].total_cmp(&b[0]));
//! assert_eq!(found.len(), 2);
//! assert!((found[0][0] + 1.0).abs() < 1e-12 && found[1][0].abs() < 1e-12);
//! # Ok::<(), continuation::deflation::DeflationError>(())
//! ```
//!
//! # Limits
//! Solutions that differ only in unknowns without weight in the metric (multipliers) count as the
//! same. Solutions at which the Jacobian is singular (folds, branch points) are found slowly and to
//! half of the digits, if at all; a continuous family of them is found again and again until
//! `max_solutions`. That nothing more was found proves nothing.
//!
//! # References
//! - P. E. Farrell, Á. Birkisson and S. W. Funke, Deflation techniques for finding distinct
//!   solutions of nonlinear partial differential equations, *SIAM J. Sci. Comput.* 37 (2015)
//!   A2026-A2045.
//! - P. E. Farrell, C. H. L. Beentjes and Á. Birkisson, The computation of disconnected bifurcation
//!   diagrams, arXiv:1603.00809 (2016).
//! - P. Deuflhard, *Newton Methods for Nonlinear Problems*, Springer, 2004.

mod attempt;
mod disconnected;
mod known;
mod passing;
mod settings;
mod starts;

pub(crate) use disconnected::off_branches;
pub use disconnected::{OffBranch, disconnected, disconnected_observed, lies_on};
pub use settings::DeflationSettings;

use crate::any_problem::DynProblem;
use crate::branch::Branch;
use crate::newton;
use crate::problem::{Problem, check_finite};
use crate::settings::SettingsError;
use attempt::{Damping, Failure, Solver};
use known::Known;
use passing::Passage;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Why a search could not begin.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeflationError {
    /// A setting is out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// A vector of the wrong length.
    #[error("{what} has length {got}, but the problem needs {expected}")]
    Length {
        /// Which vector.
        what: &'static str,
        /// Its length.
        got: usize,
        /// The right length.
        expected: usize,
    },
    /// A vector holds a number that is not finite.
    #[error("{what} holds a number that is not finite (index {at})")]
    NotFinite {
        /// Which vector.
        what: &'static str,
        /// Where.
        at: usize,
    },
    /// A branch in a parameter that the problem does not have.
    #[error("the problem has no parameter `{name}`, in which the branch was traced")]
    Foreign {
        /// The branch's parameter.
        name: String,
    },
    /// Nothing to begin with.
    #[error("no branch is known")]
    NoBranch,
}

/// A solution that was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Solution {
    /// The unknowns.
    pub u: Vec<f64>,
    /// Largest component of the residual, in the unit of `f`.
    pub residual: f64,
    /// Length of the last correction in the problem's metric: an estimate of the error.
    pub correction: f64,
    /// Distance from the nearest other solution that is known, in the problem's metric; infinite if
    /// there is none.
    #[serde(skip_serializing_if = "is_infinite", default = "infinite")]
    pub apart: f64,
}

fn is_infinite(x: &f64) -> bool {
    x.is_infinite()
}

fn infinite() -> f64 {
    f64::INFINITY
}

/// What a search did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DeflationReport {
    /// Different starts that were there to be tried.
    pub starts: usize,
    /// Attempts; a start counts as often as it was tried.
    pub attempts: usize,
    /// Attempts that found a new solution.
    pub found: usize,
    /// Attempts that ended at a known solution.
    pub known: usize,
    /// Attempts that ended where the problem has no value.
    pub inadmissible: usize,
    /// Attempts that left every bound.
    pub diverged: usize,
    /// Attempts that used up their iterations, or whose steps reduced nothing.
    pub stalled: usize,
    /// Jacobian assemblies and factorisations of all attempts.
    pub newton_iterations: usize,
    /// Whether the search ended because every start, with every solution known, leads to nothing
    /// new; and not by a limit or by the observer.
    pub exhausted: bool,
}

/// What a search found, and what it did.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Deflated {
    /// The further solutions, in the order in which they were found.
    pub solutions: Vec<Solution>,
    /// What was done.
    pub report: DeflationReport,
}

/// A search for further solutions at one parameter vector.
pub struct Deflation<'a> {
    problem: &'a DynProblem<'a>,
    p: Vec<f64>,
    settings: DeflationSettings,
    known: Known<'a>,
    /// How far the branches lead from their starts.
    extent: f64,
    /// Solutions of branches that Newton's method did not meet.
    unresolved: Vec<Passage>,
    starts: Vec<Start>,
}

/// Where attempts begin.
struct Start {
    u: Vec<f64>,
    /// Number of known solutions when it last led to nothing new.
    tried: Option<usize>,
}

impl<'a> Deflation<'a> {
    /// Prepares a search at the parameters `p`.
    ///
    /// # Errors
    /// When a setting is out of range or `p` has the wrong length.
    pub fn new<P: Problem>(
        problem: &'a P,
        p: &[f64],
        settings: DeflationSettings,
    ) -> Result<Self, DeflationError> {
        Self::of(problem, p, settings)
    }

    /// [`Deflation::new`] of a problem of unknown type.
    pub(crate) fn of(
        problem: &'a DynProblem<'a>,
        p: &[f64],
        settings: DeflationSettings,
    ) -> Result<Self, DeflationError> {
        settings.validate()?;
        check("the parameter vector", p, problem.parameters().len())?;
        let known = Known::new(problem);
        Ok(Deflation {
            problem,
            p: p.to_vec(),
            settings,
            known,
            extent: 0.0,
            unresolved: Vec::new(),
            starts: Vec::new(),
        })
    }

    /// Adds solutions that are known. Newton's method leads from each to a solution proper, if it
    /// can.
    ///
    /// # Errors
    /// When one has the wrong length or is not finite.
    pub fn known<U: AsRef<[f64]>>(mut self, solutions: &[U]) -> Result<Self, DeflationError> {
        for u in solutions {
            check("a known solution", u.as_ref(), self.problem.dim())?;
            let mut polished = u.as_ref().to_vec();
            let settings = self.settings.newton();
            if newton::solve(self.problem, &mut polished, &self.p, &settings).is_err() {
                polished.copy_from_slice(u.as_ref());
            }
            self.admit(polished);
        }
        Ok(self)
    }

    /// Adds states from which attempts start.
    ///
    /// # Errors
    /// When one has the wrong length or is not finite.
    pub fn starts<U: AsRef<[f64]>>(mut self, states: &[U]) -> Result<Self, DeflationError> {
        for u in states {
            check("a start", u.as_ref(), self.problem.dim())?;
            self.starts.push(Start { u: u.as_ref().to_vec(), tried: None });
        }
        Ok(self)
    }

    /// Starts from `u` along `direction`, either way, at the multiples
    /// [`DeflationSettings::amplitudes`] of its natural amplitude: the near-null direction of a
    /// near-bifurcation, say.
    ///
    /// # Errors
    /// When a vector has the wrong length or is not finite.
    pub fn perturbed(mut self, u: &[f64], direction: &[f64]) -> Result<Self, DeflationError> {
        check("a start", u, self.problem.dim())?;
        check("a direction", direction, self.problem.dim())?;
        let (size, norm) = (self.known.norm(u), self.known.norm(direction));
        if norm > 0.0 {
            let unit: Vec<f64> = direction.iter().map(|x| x / norm).collect();
            let guess = if size > 0.0 { size } else { 1.0 };
            let amplitude = starts::amplitude(self.problem, u, &self.p, &unit, guess);
            self.beside(u, &unit, amplitude.unwrap_or(guess));
        }
        Ok(self)
    }

    /// Adds what a branch knows: where it passes the parameter's value in `p` its solutions there
    /// are known, each met by Newton's method and told from its neighbours, and `count` of its other
    /// points, evenly spread over them, are starts. A branch at other values of the parameters that
    /// were not continued gives starts only.
    ///
    /// # Errors
    /// When the branch is not one of this problem.
    pub fn along(mut self, branch: &Branch, count: usize) -> Result<Self, DeflationError> {
        let which = check_branch(self.problem, branch)?;
        let same = |k: usize| k == which || branch.parameters[k] == self.p[k];
        if (0..self.p.len()).all(same) {
            let found = passing::solutions(self.problem, branch, &self.p, which, &self.settings);
            let extent = passing::extent(&mut self.known, branch);
            self.extent = self.extent.max(extent);
            self.known.length = self.known.length.max(extent);
            found.solutions.into_iter().for_each(|u| self.admit(u));
            self.unresolved.extend(found.unresolved);
        }
        let last = branch.points.len().saturating_sub(1);
        for k in 0..count.min(branch.points.len()) {
            let at = (last * k) / count.saturating_sub(1).max(1);
            if let Some(point) = branch.points.get(at) {
                self.starts.push(Start { u: point.u.clone(), tried: None });
            }
        }
        Ok(self)
    }

    /// Searches until all starts are exhausted or a limit is met.
    pub fn run(self) -> Deflated {
        self.run_observed(&mut |_| ControlFlow::Continue(()))
    }

    /// The same; the observer is called after every attempt and may end the search. Nothing found is
    /// lost.
    pub fn run_observed(
        mut self,
        observer: &mut dyn FnMut(&DeflationReport) -> ControlFlow<()>,
    ) -> Deflated {
        self.measure();
        for k in 0..self.known.solutions.len() {
            self.beside_solution(k);
        }
        let mut solver = Solver::new(self.problem, &self.p);
        let mut report = DeflationReport::default();
        let mut solutions: Vec<Solution> = Vec::new();
        let limits = self.settings.newton();
        let mut next = 0;
        loop {
            // in turn, those that have not been tried with all that is known now
            let count = self.starts.len();
            let known = self.known.solutions.len();
            let open = |k: &usize| self.starts[*k].tried.is_none_or(|tried| tried < known);
            let Some(k) = (next..count).chain(0..next).find(open) else {
                report.exhausted = true;
                break;
            };
            if solutions.len() >= self.settings.max_solutions
                || report.attempts >= self.settings.max_attempts
            {
                break;
            }
            let start = std::mem::take(&mut self.starts[k].u);
            let reach = self.reach(&start);
            let mut outcome = Err(Failure::Stalled);
            for damping in [Damping::Monotone, Damping::Free] {
                report.attempts += 1;
                let within = (reach, self.settings.reach);
                outcome = solver.attempt(&mut self.known, &start, within, damping, &limits);
                if outcome.is_ok() && !self.is_new(&solver.u) {
                    outcome = Err(Failure::Known);
                }
                match outcome {
                    Ok(_) => report.found += 1,
                    Err(Failure::Known) => report.known += 1,
                    Err(Failure::Inadmissible) => report.inadmissible += 1,
                    Err(Failure::Diverged) => report.diverged += 1,
                    Err(Failure::Stalled) => report.stalled += 1,
                }
                report.newton_iterations = solver.assemblies;
                if outcome.is_ok() {
                    break;
                }
            }
            self.starts[k].u = start;
            match outcome {
                Ok(converged) => {
                    let found = self.solution(solver.u.clone(), converged.correction);
                    self.admit(found.u.clone());
                    solutions.push(found);
                    self.measure();
                    self.beside_solution(self.known.solutions.len() - 1);
                }
                Err(_) => {
                    self.starts[k].tried = Some(known);
                    next = k + 1;
                }
            }
            report.starts = self.starts.len();
            if observer(&report).is_break() {
                break;
            }
        }
        report.starts = self.starts.len();
        Deflated { solutions, report }
    }

    /// Adds a known solution, if it is not there already.
    fn admit(&mut self, u: Vec<f64>) {
        if self.known.solutions.is_empty() || !self.known.contains(&u, self.settings.separation) {
            self.known.solutions.push(u);
        }
    }

    /// Whether `u` is neither known nor a solution of a branch that Newton's method did not meet
    /// before; the latter is known from now on.
    fn is_new(&mut self, u: &[f64]) -> bool {
        if self.known.contains(u, self.settings.separation) {
            return false;
        }
        let known = &mut self.known;
        let Some(k) = self.unresolved.iter().position(|passage| passage.covers(known, u)) else {
            return true;
        };
        self.unresolved.swap_remove(k);
        self.known.solutions.push(u.to_vec());
        false
    }

    fn solution(&mut self, u: Vec<f64>, correction: f64) -> Solution {
        let mut r = vec![0.0; u.len()];
        let value = self.problem.residual(&u, &self.p, &mut r).and_then(|()| check_finite(&r));
        let residual = value.map_or(f64::NAN, |()| crate::linalg::max_abs(&r));
        let apart = self.known.apart(&u);
        Solution { u, residual, correction, apart }
    }

    /// Chooses the length by which distances are divided.
    fn measure(&mut self) {
        if let Some(length) = self.settings.length {
            self.known.length = length;
            return;
        }
        let known = std::mem::take(&mut self.known.solutions);
        let mut length = self.extent;
        for (k, u) in known.iter().enumerate() {
            for other in &known[..k] {
                length = length.max(self.known.distance(u, other));
            }
        }
        if length == 0.0 {
            for u in &known {
                let directions = starts::soft(self.problem, &mut self.known, u, &self.p, 2);
                let amplitudes = directions.iter().filter_map(|soft| soft.amplitude);
                length = amplitudes.fold(length, f64::max);
            }
        }
        for u in known.iter().chain(self.starts.iter().map(|start| &start.u)) {
            if length == 0.0 {
                length = self.known.norm(u);
            }
        }
        self.known.solutions = known;
        self.known.length = if length > 0.0 && length.is_finite() { length } else { 1.0 };
    }

    /// A length that matters to an attempt from `start`.
    fn reach(&mut self, start: &[f64]) -> f64 {
        self.known.length.max(self.known.norm(start))
    }

    /// Adds starts beside the known solution `k`.
    fn beside_solution(&mut self, k: usize) {
        let u = self.known.solutions[k].clone();
        let count = self.settings.modes;
        let softest = starts::soft(self.problem, &mut self.known, &u, &self.p, count);
        for soft in softest {
            let amplitude = soft.amplitude.unwrap_or(self.known.length);
            self.beside(&u, &soft.direction, amplitude);
        }
    }

    /// Adds starts along a direction of unit length, either way.
    fn beside(&mut self, u: &[f64], direction: &[f64], amplitude: f64) {
        for a in &self.settings.amplitudes {
            for side in [a * amplitude, -a * amplitude] {
                let u = u.iter().zip(direction).map(|(u, d)| u + side * d).collect();
                self.starts.push(Start { u, tried: None });
            }
        }
    }
}

/// Further solutions at the parameters `p` besides `known`, from starts beside the known ones:
/// [`Deflation`] in one call.
///
/// # Errors
/// When a setting is out of range, or a vector has the wrong length or is not finite.
pub fn further_solutions<P: Problem + ?Sized>(
    problem: &P,
    p: &[f64],
    known: &[Vec<f64>],
    settings: DeflationSettings,
) -> Result<Vec<Vec<f64>>, DeflationError> {
    further(&problem, p, known, settings)
}

/// [`further_solutions`] of a problem of unknown type.
pub(crate) fn further(
    problem: &DynProblem<'_>,
    p: &[f64],
    known: &[Vec<f64>],
    settings: DeflationSettings,
) -> Result<Vec<Vec<f64>>, DeflationError> {
    let found = Deflation::of(problem, p, settings)?.known(known)?.run();
    Ok(found.solutions.into_iter().map(|solution| solution.u).collect())
}

/// Checks that a branch can be one of the problem; the index of its parameter.
fn check_branch(problem: &DynProblem<'_>, branch: &Branch) -> Result<usize, DeflationError> {
    let names = problem.parameters();
    let Some(which) = names.iter().position(|q| q.name == branch.parameter) else {
        return Err(DeflationError::Foreign { name: branch.parameter.clone() });
    };
    check("the branch's parameter vector", &branch.parameters, names.len())?;
    for point in &branch.points {
        check("a point of the branch", &point.u, problem.dim())?;
    }
    Ok(which)
}

fn check(what: &'static str, values: &[f64], expected: usize) -> Result<(), DeflationError> {
    if values.len() != expected {
        return Err(DeflationError::Length { what, got: values.len(), expected });
    }
    match values.iter().position(|v| !v.is_finite()) {
        Some(at) => Err(DeflationError::NotFinite { what, at }),
        None => Ok(()),
    }
}
