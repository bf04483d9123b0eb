//! Newton's method for `f(u, p) = 0` at fixed parameters, damped.
//!
//! Damping follows the natural monotonicity test (Deuflhard, *Newton Methods for Nonlinear
//! Problems*, 2004, §3.3): a step is accepted when the *simplified* correction that follows it,
//! computed with the old factors, is shorter. The test is invariant under any linear
//! transformation of `f`. Full steps near a solution converge quadratically.

use crate::any_problem::DynProblem;
use crate::linalg::{Matrix, max_abs};
use crate::problem::{EvalError, ParamId, Problem, check_pattern};
use crate::sound::{ProblemError, check_lengths, check_sizes};

/// Why Newton's method gave no solution.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NewtonError {
    /// The problem is malformed, or a vector has the wrong length.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The starting state is outside the model's domain, or the Jacobian has no value at a state on
    /// the way.
    #[error("the problem has no value at the starting state: {0}")]
    Start(EvalError),
    /// The Jacobian is singular to rounding, and the residual is not zero.
    #[error("the Jacobian is singular after {iterations} iterations")]
    Singular {
        /// Iterations done.
        iterations: usize,
    },
    /// Even very short steps do not reduce the error; `cause` is set when they leave the domain.
    #[error("no admissible step reduces the error (iteration {iterations}, correction {correction:.3e}){}",
        .cause.map(|c| format!("; longer steps fail: {c}")).unwrap_or_default())]
    Stuck {
        /// Iterations done.
        iterations: usize,
        /// Length of the last correction in the problem's metric.
        correction: f64,
        /// Why longer steps were refused.
        cause: Option<EvalError>,
    },
    /// The iteration limit was reached.
    #[error("not converged after {iterations} iterations (last correction {correction:.3e})")]
    TooMany {
        /// Iterations done.
        iterations: usize,
        /// Length of the last correction in the problem's metric.
        correction: f64,
    },
}

/// Limits of [`newton`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NewtonSettings {
    /// Corrections shorter than this, relative to the solution or to the longest correction on the
    /// way, in the problem's metric, have converged.
    pub tolerance: f64,
    /// Most iterations, each one assembly.
    pub max_iterations: usize,
}

impl Default for NewtonSettings {
    fn default() -> Self {
        NewtonSettings { tolerance: 1e-12, max_iterations: 50 }
    }
}

/// What a successful solve cost and how close it came.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NewtonReport {
    /// Jacobian assemblies.
    pub iterations: usize,
    /// Length of the last correction in the problem's metric.
    pub correction: f64,
}

/// Solves `f(u, p) = 0` for `u`, starting from its given value. `u` has length [`Problem::dim`], `p`
/// holds the values of all parameters.
///
/// ```
/// use continuation::{DenseProblem, newton};
/// let problem = DenseProblem::from_residual(1, &["p"], |x, p, r| r[0] = x[0] * x[0] - p[0]);
/// let mut u = [1.0];
/// let report = newton(&problem, &mut u, &[2.0], &Default::default())?;
/// assert!((u[0] - 2f64.sqrt()).abs() < 1e-15 && report.iterations < 8);
/// # Ok::<(), continuation::NewtonError>(())
/// ```
///
/// # Errors
/// When no solution was found; `u` then holds the best state reached.
pub fn newton<P: Problem + ?Sized>(
    problem: &P,
    u: &mut [f64],
    p: &[f64],
    settings: &NewtonSettings,
) -> Result<NewtonReport, NewtonError> {
    solve(&problem, u, p, settings)
}

/// [`newton`] of a problem of unknown type.
pub(crate) fn solve(
    problem: &DynProblem<'_>,
    u: &mut [f64],
    p: &[f64],
    settings: &NewtonSettings,
) -> Result<NewtonReport, NewtonError> {
    check_sizes(problem)?;
    check_lengths(problem, u, p)?;
    let n = problem.dim();
    let mut jacobian = problem.new_jacobian();
    let (mut r, mut du) = (vec![0.0; n], vec![0.0; n]);
    let (mut trial, mut m) = (vec![0.0; n], vec![0.0; n]);
    let length = |x: &[f64], m: &mut [f64]| {
        problem.metric(x, m);
        x.iter().zip(m.iter()).map(|(a, b)| a * b).sum::<f64>().max(0.0).sqrt()
    };
    let mut damping = 1.0_f64;
    let (mut last, mut longest) = (f64::INFINITY, 0.0_f64);
    for iterations in 1..=settings.max_iterations {
        let refuse = |error| match iterations {
            1 => NewtonError::Start(error),
            _ => NewtonError::Stuck { iterations, correction: last, cause: Some(error) },
        };
        problem.linearise(u, p, &mut r, &mut jacobian).map_err(refuse)?;
        check_pattern(&jacobian).map_err(refuse)?;
        crate::problem::check_finite(&r).map_err(refuse)?;
        let floor = f64::EPSILON * jacobian.norm();
        let facts = jacobian.factor(floor);
        if facts.perturbed > 0 || !floor.is_finite() {
            finite_rows(&jacobian, &mut m).map_err(refuse)?;
        }
        if facts.perturbed > 0 && r.iter().any(|x| *x != 0.0) {
            return Err(NewtonError::Singular { iterations });
        }
        du.copy_from_slice(&r);
        jacobian.solve(&mut du);
        let correction = length(&du, &mut m);
        if !correction.is_finite() || !du.iter().all(|x| x.is_finite()) {
            finite_rows(&jacobian, &mut m).map_err(refuse)?;
            return Err(NewtonError::Singular { iterations });
        }
        longest = longest.max(correction);
        let size = length(u, &mut m);
        let converged = settings.tolerance * longest.max(size);
        // corrections that no longer shrink, of a residual that is rounding
        let stagnant = iterations > 2 && correction > 0.5 * last;
        if stagnant && residual_is_rounding(problem, u, p, &r, &mut m, jacobian.norm()) {
            return Ok(NewtonReport { iterations, correction });
        }
        last = correction;
        damping = (2.0 * damping).min(1.0);
        let mut cause = None;
        loop {
            for i in 0..n {
                trial[i] = u[i] - damping * du[i];
            }
            let outcome =
                problem.residual(&trial, p, &mut r).and_then(|()| crate::problem::check_finite(&r));
            match outcome {
                Ok(()) => {
                    jacobian.solve(&mut r);
                    let next = length(&r, &mut m);
                    if next <= (1.0 - damping / 4.0) * correction || correction <= converged {
                        break;
                    }
                }
                Err(EvalError::Aborted) => {
                    let cause = Some(EvalError::Aborted);
                    return Err(NewtonError::Stuck { iterations, correction, cause });
                }
                Err(error) => cause = Some(error),
            }
            damping /= 2.0;
            if damping < 1e-6 {
                // a correction that no step makes shorter is rounding if it is this small
                if correction <= settings.tolerance * (1.0 + size) && cause.is_none() {
                    return Ok(NewtonReport { iterations, correction });
                }
                return Err(NewtonError::Stuck { iterations, correction, cause });
            }
        }
        u.copy_from_slice(&trial);
        if correction <= converged {
            return Ok(NewtonReport { iterations, correction });
        }
        if iterations == settings.max_iterations {
            return Err(NewtonError::TooMany { iterations, correction });
        }
    }
    Err(NewtonError::TooMany { iterations: settings.max_iterations, correction: f64::NAN })
}

/// The first row of a matrix that holds something else than numbers, as an error: it is not singular.
pub(crate) fn finite_rows<M: Matrix>(matrix: &M, scratch: &mut [f64]) -> Result<(), EvalError> {
    let ones = vec![1.0; scratch.len()];
    matrix.mul(&ones, scratch);
    match scratch.iter().position(|x| !x.is_finite()) {
        Some(row) => Err(EvalError::JacobianNotFinite { row }),
        None => Ok(()),
    }
}

/// Whether a residual is no more than the rounding errors of its terms.
fn residual_is_rounding(
    problem: &DynProblem<'_>,
    u: &[f64],
    p: &[f64],
    r: &[f64],
    scratch: &mut [f64],
    jacobian: f64,
) -> bool {
    let mut terms = jacobian * max_abs(u);
    for (which, p_k) in p.iter().enumerate() {
        if problem.parameter_derivative(u, p, ParamId(which), scratch).is_ok() {
            terms += max_abs(scratch) * p_k.abs();
        }
    }
    max_abs(r) <= 4.0 * f64::EPSILON * terms
}
