//! Whether the derivatives that a trace works with are those of the residual.
//!
//! A wrong Jacobian does not stop Newton's method: it converges linearly to the right states, with wrong
//! tangents, counts and special points. One direction without any pattern shows it by differences of
//! the residual whose error is known; a kink or noise does not pass for it, because what differs must
//! differ at another state and along another direction too.

use crate::any_problem::DynProblem;
use crate::differences::{self, magnitude};
use crate::linalg::{Matrix, max_abs};
use crate::name::Name;
use crate::problem::ParamId;
use crate::singular::arbitrary;
use crate::step::Guard;
use std::fmt;

/// A deviation below this part of the derivative is not wrong.
const TELL: f64 = 1e-4;
/// A deviation is told from the errors of the differences if it is this many times as large.
const SURE: f64 = 100.0;
/// How far off a second state confirms it, in units of the unknowns; one without a value does not.
const BESIDE: [f64; 3] = [1e-2, 1e-4, 1e-6];
/// An unknown smaller than this part of the largest counts as that.
const LEAST: f64 = 1e-3;

/// A derivative that is not that of the residual.
#[derive(Debug, Clone, PartialEq)]
pub struct WrongDerivative {
    /// The parameter whose derivative it is; `None` of the Jacobian.
    pub parameter: Option<Name>,
    /// Row of the largest deviation.
    pub row: usize,
    /// What the problem says: an entry, or a row of the Jacobian times a direction.
    pub given: f64,
    /// What differences of the residual say.
    pub measured: f64,
    /// Estimated error of that.
    pub error: f64,
}

impl fmt::Display for WrongDerivative {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { row, given, measured, error, .. } = self;
        match &self.parameter {
            Some(name) => write!(f, "the derivative by `{name}` is wrong: its entry {row}")?,
            None => write!(f, "the Jacobian is wrong: along a direction row {row}")?,
        }
        write!(
            f,
            " is {given:.4e}, differences of the residual say {measured:.4e} (error {error:.0e}); \
             `check_derivatives` finds the entries"
        )
    }
}

/// The derivative by which the problem deviates most from its residual at a state, if that is beyond
/// doubt. Allocates, and costs some 50 residuals: to be asked rarely.
pub(crate) fn wrong_derivative(
    problem: &DynProblem<'_>,
    which: ParamId,
    (u, p): (&[f64], &[f64]),
    guard: Guard,
    scale: f64,
) -> Option<WrongDerivative> {
    let largest = if max_abs(u) > 0.0 { max_abs(u) } else { scale };
    let along = |seed: usize| -> Vec<f64> {
        let size = |u: &f64| u.abs().max(LEAST * largest);
        u.iter().enumerate().map(|(i, u)| size(u) * arbitrary(seed, i)).collect()
    };
    let by = |parameter: bool| {
        let first =
            compare(problem, which, (u, p), guard, (!parameter).then(|| along(41)).as_deref())?;
        if first.is_empty() {
            return None;
        }
        for off in BESIDE {
            let step = along(42);
            let beside: Vec<f64> = u.iter().zip(&step).map(|(u, d)| u + off * d).collect();
            let direction = (!parameter).then(|| along(43));
            if let Some(second) = compare(problem, which, (&beside, p), guard, direction.as_deref())
            {
                let rows = first.iter().filter(|a| second.iter().any(|b| a.row == b.row));
                let size = |w: &WrongDerivative| (w.given - w.measured).abs();
                return rows.max_by(|a, b| size(a).total_cmp(&size(b))).cloned();
            }
        }
        None
    };
    by(false).or_else(|| by(true))
}

/// The rows in which the derivative along a direction, or by the parameter, deviates; `None` without a
/// value.
fn compare(
    problem: &DynProblem<'_>,
    which: ParamId,
    (u, p): (&[f64], &[f64]),
    guard: Guard,
    direction: Option<&[f64]>,
) -> Option<Vec<WrongDerivative>> {
    let n = u.len();
    let (mut given, mut missed, zero) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let (du, dp) = match direction {
        Some(du) => {
            let mut jacobian = problem.new_jacobian();
            let mut r = vec![0.0; n];
            problem.linearise(u, p, &mut r, &mut jacobian).ok()?;
            jacobian.mul(du, &mut given);
            (du, 0.0)
        }
        None => {
            problem.parameter_derivative(u, p, which, &mut given).ok()?;
            (&zero[..], 1.0)
        }
    };
    problem.derivative_error(u, p, which, du, dp, &mut missed).ok()?;
    let unit = match direction {
        Some(_) => 1.0,
        None => magnitude(p[which.0], problem.parameters()[which.0].scale),
    };
    let inside = |p: f64| guard.nearest(p) == p;
    let residual = |u: &[f64], p: &[f64], r: &mut [f64]| problem.residual(u, p, r);
    let ladder = differences::along(residual, (u, p), which, (du, dp), unit, inside);
    let parameter = direction.is_none().then_some(&problem.parameters()[which.0].name);
    let size = max_abs(&ladder.derivative).max(max_abs(&given));
    let rows = (0..n).filter_map(|row| {
        let (given, measured) = (given[row], ladder.derivative[row]);
        let error = ladder.error[row] + missed[row] + f64::EPSILON * size;
        let deviation = (given - measured).abs();
        let wrong = deviation > TELL * given.abs().max(measured.abs()) + SURE * error;
        wrong.then_some(WrongDerivative {
            parameter: parameter.cloned(),
            row,
            given,
            measured,
            error,
        })
    });
    Some(rows.collect())
}
