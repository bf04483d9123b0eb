//! Whether a problem is well formed: what no state and no parameter could mend.

use crate::any_problem::DynProblem;
use crate::linalg::{Matrix, OutsidePattern};
use crate::name::Name;
use crate::problem::ParamId;
use crate::singular::arbitrary;

/// What is wrong with a problem, whatever the state.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProblemError {
    /// [`Problem::dim`](crate::Problem::dim) is zero.
    #[error("the problem has no unknowns: its dimension is 0")]
    NoUnknowns,
    /// [`Problem::new_jacobian`](crate::Problem::new_jacobian) makes a matrix of another dimension than [`Problem::dim`](crate::Problem::dim).
    #[error("the Jacobian has dimension {got}, but the problem has {expected} unknowns")]
    JacobianSize {
        /// The matrix's dimension.
        got: usize,
        /// The number of unknowns.
        expected: usize,
    },
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
    /// An entry that a method leaves as it was, or only adds to.
    #[error("{what} never sets its entry {at}: what was there before shows through")]
    Unwritten {
        /// What the method computes.
        what: &'static str,
        /// Index of the entry.
        at: usize,
    },
    /// The mass matrix has an entry outside the Jacobian's pattern.
    #[error("the mass matrix: {0}")]
    Mass(OutsidePattern),
    /// A scale, [`crate::Parameter::scale`] or [`Problem::unknown_scale`](crate::Problem::unknown_scale), that is not positive and finite.
    #[error("the scale of `{parameter}` is {value}; it must be positive and finite")]
    Scale {
        /// Name of the parameter.
        parameter: Name,
        /// The scale.
        value: f64,
    },
    /// The residual is zero at every state, and so are its derivatives.
    #[error("the residual is zero whatever the state: there is no equation")]
    NoEquation,
}

/// What the entries hold before a method is to set them.
const BEFORE: [f64; 2] = [0.734_112_9, -1.913_377_1];
/// By how much less than the difference of what was there before two results of a method that adds
/// to it may differ, relative to that: rounding.
const ADDED: f64 = 1e-9;

/// Number of unknowns and dimension of the Jacobian.
pub(crate) fn check_sizes(problem: &DynProblem<'_>) -> Result<(), ProblemError> {
    let expected = problem.dim();
    if expected == 0 {
        return Err(ProblemError::NoUnknowns);
    }
    let got = problem.new_jacobian().dim();
    if got != expected {
        return Err(ProblemError::JacobianSize { got, expected });
    }
    Ok(())
}

/// Lengths of the unknowns and of the parameters.
pub(crate) fn check_lengths(
    problem: &DynProblem<'_>,
    u: &[f64],
    p: &[f64],
) -> Result<(), ProblemError> {
    let pairs = [
        ("the state", u.len(), problem.dim()),
        ("the parameter vector", p.len(), problem.parameters().len()),
    ];
    for (what, got, expected) in pairs {
        if got != expected {
            return Err(ProblemError::Length { what, got, expected });
        }
    }
    Ok(())
}

/// What a few evaluations at a state say of the problem; sizes and lengths are right. A state
/// without a value says nothing.
pub(crate) fn examine(
    problem: &DynProblem<'_>,
    which: ParamId,
    u: &[f64],
    p: &[f64],
) -> Result<(), ProblemError> {
    let n = problem.dim();
    let parameter = &problem.parameters()[which.0].name;
    let scales = [Some(problem.parameters()[which.0].scale), problem.unknown_scale(which)];
    for value in scales.into_iter().flatten() {
        if !(value.is_finite() && value > 0.0) {
            return Err(ProblemError::Scale { parameter: parameter.clone(), value });
        }
    }
    let mut mass = problem.new_jacobian();
    mass.set_zero();
    if problem.mass(&mut mass)
        && let Some(entry) = mass.misplaced()
    {
        return Err(ProblemError::Mass(entry));
    }
    let r = written("the residual", n, |out| problem.residual(u, p, out).is_ok())?;
    let slope = written("the derivative by the parameter", n, |out| {
        problem.parameter_derivative(u, p, which, out).is_ok()
    })?;
    written("the metric", n, |out| {
        problem.metric(u, out);
        true
    })?;
    written("the observables", problem.observables().len(), |out| {
        problem.observe(u, p, out).is_ok()
    })?;
    let zero = |x: &Option<Vec<f64>>| x.as_ref().is_some_and(|x| x.iter().all(|x| *x == 0.0));
    if zero(&r) && zero(&slope) && vanishes(problem, which, u, p) {
        return Err(ProblemError::NoEquation);
    }
    Ok(())
}

/// The result of a method, `None` if there is none; every entry must be set, not added to.
fn written(
    what: &'static str,
    length: usize,
    mut evaluate: impl FnMut(&mut [f64]) -> bool,
) -> Result<Option<Vec<f64>>, ProblemError> {
    let [mut first, mut second] = BEFORE.map(|value| vec![value; length]);
    if length == 0 || !(evaluate(&mut first) && evaluate(&mut second)) {
        return Ok(None);
    }
    let apart = BEFORE[0] - BEFORE[1];
    let shows = |(a, b): (&f64, &f64)| (a - b - apart).abs() <= ADDED * apart.abs();
    match first.iter().zip(&second).position(shows) {
        Some(at) => Err(ProblemError::Unwritten { what, at }),
        None => Ok(Some(first)),
    }
}

/// Whether the residual and both its derivatives are zero at this state and at others.
fn vanishes(problem: &DynProblem<'_>, which: ParamId, u: &[f64], p: &[f64]) -> bool {
    let n = u.len();
    let (mut r, mut slope, mut j) = (vec![0.0; n], vec![0.0; n], problem.new_jacobian());
    let size = u.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
    (0..3).all(|place| {
        let at = |(i, u): (usize, &f64)| {
            if place == 0 { *u } else { u + 0.3 * size * arbitrary(place, i) }
        };
        let x: Vec<f64> = u.iter().enumerate().map(at).collect();
        problem.linearise(&x, p, &mut r, &mut j).is_ok()
            && problem.parameter_derivative(&x, p, which, &mut slope).is_ok()
            && j.norm() == 0.0
            && r.iter().chain(&slope).all(|x| *x == 0.0)
    })
}
