//! Are the derivatives of a problem those of its residual?

use crate::linalg::{Matrix, max_abs};
use crate::problem::{EvalError, ParamId, Problem};

/// How far derivatives deviate from differences of the residual.
///
/// Deviations are relative to the largest entry of the derivative: near 1e-9 for correct ones,
/// where the residual is smooth; of order one for wrong ones.
#[derive(Debug, Clone, PartialEq)]
pub struct DerivativeCheck {
    /// Largest relative deviation in the Jacobian.
    pub jacobian: f64,
    /// Row and column of it.
    pub at: (usize, usize),
    /// Largest relative deviation of each parameter's derivative, in the problem's order.
    pub parameters: Vec<f64>,
    /// Largest relative deviation of residual and Jacobian computed together
    /// ([`Problem::linearise`]) from those computed apart.
    pub linearise: f64,
}

impl DerivativeCheck {
    /// Whether every deviation is at most `tolerance`.
    pub fn is_within(&self, tolerance: f64) -> bool {
        let mut all = self.parameters.iter().chain([&self.jacobian, &self.linearise]);
        !all.any(|deviation| deviation.is_nan() || *deviation > tolerance)
    }
}

/// Compares Jacobian and parameter derivatives with four-point differences of the residual at a
/// state; `scale` is a typical magnitude of the unknowns, in their unit: differences reach over
/// 2e-3 of it, or of the unknown if that is larger. Every matrix is assembled twice, so that entries
/// left from an earlier assembly are seen. Costs `4 n` residuals: for tests.
///
/// ```
/// use continuation::{check_derivatives, samples::Bratu};
/// let check = check_derivatives(&Bratu::new(9), &[0.4; 9], &[1.3], 1.0)?;
/// assert!(check.is_within(1e-9), "{check:?}");
/// # Ok::<(), continuation::EvalError>(())
/// ```
///
/// # Errors
/// Where the problem has no value at or near the state.
pub fn check_derivatives<P: Problem + ?Sized>(
    problem: &P,
    u: &[f64],
    p: &[f64],
    scale: f64,
) -> Result<DerivativeCheck, EvalError> {
    let n = problem.dim();
    let mut jacobian = problem.new_jacobian();
    problem.jacobian(u, p, &mut jacobian)?;
    problem.jacobian(u, p, &mut jacobian)?;
    let (mut unit, mut column) = (vec![0.0; n], vec![0.0; n]);
    let (mut place, mut values) = (u.to_vec(), p.to_vec());
    let mut size = jacobian.norm();
    let mut worst = (0.0, (0, 0));
    for k in 0..n {
        let h = 1e-3 * scale.abs().max(u[k].abs());
        let difference = stencil(h, n, |x, r| {
            place[k] = u[k] + x;
            let outcome = problem.residual(&place, p, r);
            place[k] = u[k];
            outcome
        })?;
        unit[k] = 1.0;
        jacobian.mul(&unit, &mut column);
        unit[k] = 0.0;
        size = size.max(max_abs(&difference));
        for (i, (a, b)) in column.iter().zip(&difference).enumerate() {
            let d = (a - b).abs();
            if d.is_nan() || d > worst.0 {
                worst = (d, (i, k));
            }
        }
    }
    let mut parameters = Vec::new();
    for (k, parameter) in problem.parameters().iter().enumerate() {
        let h = 1e-3 * parameter.scale.abs().max(p[k].abs());
        let difference = stencil(h, n, |x, r| {
            values[k] = p[k] + x;
            let outcome = problem.residual(u, &values, r);
            values[k] = p[k];
            outcome
        })?;
        problem.parameter_derivative(u, p, ParamId(k), &mut column)?;
        let size = max_abs(&column).max(max_abs(&difference));
        parameters.push(relative(deviation(&column, &difference), size));
    }
    let (mut r, mut together) = (vec![0.0; n], vec![0.0; n]);
    problem.residual(u, p, &mut r)?;
    let mut second = problem.new_jacobian();
    problem.linearise(u, p, &mut together, &mut second)?;
    problem.linearise(u, p, &mut together, &mut second)?;
    let residuals = relative(deviation(&r, &together), max_abs(&r));
    second.axpy(-1.0, &jacobian);
    let linearise = residuals.max(relative(second.norm(), size));
    Ok(DerivativeCheck { jacobian: relative(worst.0, size), at: worst.1, parameters, linearise })
}

fn stencil(
    h: f64,
    n: usize,
    mut residual: impl FnMut(f64, &mut [f64]) -> Result<(), EvalError>,
) -> Result<Vec<f64>, EvalError> {
    let (mut r, mut sum) = (vec![0.0; n], vec![0.0; n]);
    for (place, weight) in [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)] {
        residual(place * h, &mut r)?;
        for (s, r) in sum.iter_mut().zip(&r) {
            *s += weight * r / (12.0 * h);
        }
    }
    Ok(sum)
}

fn deviation(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |m: f64, (a, b)| {
        let d = (a - b).abs();
        if d <= m { m } else { d } // NaN counts
    })
}

fn relative(deviation: f64, size: f64) -> f64 {
    if deviation == 0.0 { 0.0 } else { deviation / size }
}
