//! Where attempts start: beside a solution, along the directions in which it is softest.
//!
//! The directions span the space that a few inverse iterations amplify most: of `J` itself where it
//! is symmetric, of `JᵀJ` otherwise. How far to go is measured, not guessed: along `v` to the
//! multiple `X` at which `(J(u + X v) − J(u)) v` has become as large as `J(u) v`. A quadratic
//! nonlinearity has its other solution at `2X`, a symmetric cubic one at `√3 X`, in any units.

use super::known::Known;
use crate::any_problem::DynProblem;
use crate::linalg::{Matrix, max_abs};
use crate::problem::check_finite;
use crate::step::dot;

/// Inverse iterations; the ratio of neighbouring eigenvalues need not be resolved.
const ITERATIONS: usize = 8;

/// A direction of unit length and its natural amplitude.
pub(super) struct Soft {
    pub(super) direction: Vec<f64>,
    /// Where the Jacobian's action on the direction has doubled.
    pub(super) amplitude: Option<f64>,
}

/// The `count` softest directions at `u`, the softest first; none where the problem has no value.
pub(super) fn soft(
    problem: &DynProblem<'_>,
    known: &mut Known<'_>,
    u: &[f64],
    p: &[f64],
    count: usize,
) -> Vec<Soft> {
    let n = problem.dim();
    let mut jacobian = problem.new_jacobian();
    let mut r = vec![0.0; n];
    if problem.linearise(u, p, &mut r, &mut jacobian).is_err() || check_finite(&r).is_err() {
        return Vec::new();
    }
    let floor = f64::EPSILON * jacobian.norm();
    let symmetric = jacobian.factor(floor).inertia.is_some();
    let mut y = vec![0.0; n];
    let mut apply = |x: &mut [f64]| {
        problem.metric(x, &mut y);
        x.copy_from_slice(&y);
        if symmetric {
            jacobian.solve(x);
            problem.metric(x, &mut y);
            x.copy_from_slice(&y);
        } else {
            jacobian.solve_transpose(x);
        }
        jacobian.solve(x);
    };
    let mut vectors: Vec<Vec<f64>> = (0..count.min(n))
        .map(|k| (0..n).map(|i| crate::singular::arbitrary(k, i)).collect())
        .collect();
    for _ in 0..ITERATIONS {
        vectors.iter_mut().for_each(|x| apply(x));
        orthonormalise(known, problem, &mut vectors);
    }
    let scale = known.norm(u);
    let sizes = [scale, known.length, 1.0];
    let guess = sizes.into_iter().find(|x| *x > 0.0).unwrap_or(1.0);
    let mut found: Vec<Soft> = Vec::new();
    for direction in vectors {
        let amplitude = amplitude(problem, u, p, &direction, guess);
        found.push(Soft { direction, amplitude });
    }
    found
}

/// Gram-Schmidt in the problem's metric; vectors that vanish are dropped.
fn orthonormalise(known: &mut Known<'_>, problem: &DynProblem<'_>, vectors: &mut Vec<Vec<f64>>) {
    let mut done: Vec<Vec<f64>> = Vec::with_capacity(vectors.len());
    let mut m = vec![0.0; problem.dim()];
    for mut v in vectors.drain(..) {
        let before = known.norm(&v);
        v.iter_mut().for_each(|x| *x /= before);
        for _ in 0..2 {
            for w in &done {
                problem.metric(w, &mut m);
                let along = dot(&m, &v);
                v.iter_mut().zip(w).for_each(|(x, w)| *x -= along * w);
            }
        }
        let norm = known.norm(&v);
        if norm.is_finite() && norm > 1e-10 {
            v.iter_mut().for_each(|x| *x /= norm);
            done.push(v);
        }
    }
    *vectors = done;
}

/// The multiple of `v` at which the Jacobian's action on it has changed by as much as it is;
/// `None` if it does not change within twelve decades of `guess`.
pub(super) fn amplitude(
    problem: &DynProblem<'_>,
    u: &[f64],
    p: &[f64],
    v: &[f64],
    guess: f64,
) -> Option<f64> {
    let n = problem.dim();
    let mut jacobian = problem.new_jacobian();
    let (mut place, mut here, mut there) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    problem.jacobian(u, p, &mut jacobian).ok()?;
    jacobian.mul(v, &mut here);
    let reference = max_abs(&here);
    if !(reference.is_finite() && reference > 0.0) {
        return None;
    }
    // the larger change of both sides; a state outside of the domain is too far
    let mut change = |x: f64| {
        [x, -x].into_iter().fold(0.0, |largest: f64, x| {
            for i in 0..n {
                place[i] = u[i] + x * v[i];
            }
            let value = match problem.jacobian(&place, p, &mut jacobian) {
                Ok(()) => {
                    jacobian.mul(v, &mut there);
                    there.iter_mut().zip(&here).for_each(|(a, b)| *a -= b);
                    max_abs(&there) / reference
                }
                Err(_) => f64::INFINITY,
            };
            largest.max(if value.is_nan() { f64::INFINITY } else { value })
        })
    };
    let (mut low, mut high) = (guess, guess);
    let up = change(guess) < 1.0;
    for _ in 0..14 {
        if up {
            (low, high) = (high, 8.0 * high);
        } else {
            (low, high) = (low / 8.0, low);
        }
        if (change(if up { high } else { low }) < 1.0) != up {
            break;
        }
    }
    let bracketed = change(low) < 1.0 && change(high) >= 1.0;
    if !bracketed {
        return None;
    }
    for _ in 0..4 {
        let middle = (low * high).sqrt();
        if change(middle) < 1.0 { low = middle } else { high = middle }
    }
    Some((low * high).sqrt())
}
