//! What the collocation equations do within one interval, with loops of fixed length for usual sizes.

use super::basis::Basis;
use crate::linalg::{AnyMatrix, Dense, Matrix};

/// States at the Gauss points, and their derivatives times the interval's length.
#[inline(always)]
pub(super) fn interpolate(
    n: usize,
    k: usize,
    basis: &Basis,
    nodes: &[f64],
    u: &mut [f64],
    du: &mut [f64],
) {
    let (m, nodes) = (k / n, &nodes[..k + n]);
    let (u, du) = (&mut u[..k], &mut du[..k]);
    let (values, slopes) = (&basis.values[..m * (m + 1)], &basis.slopes[..m * (m + 1)]);
    u.fill(0.0);
    du.fill(0.0);
    for i in 0..m {
        for l in 0..=m {
            let (value, slope) = (values[i * (m + 1) + l], slopes[i * (m + 1) + l]);
            for c in 0..n {
                u[i * n + c] += value * nodes[l * n + c];
                du[i * n + c] += slope * nodes[l * n + c];
            }
        }
    }
}

/// Adds to the unknowns of an interval, and to `pending` for its right end, the integrals of the polynomials
/// with the one whose values are `nodes`; the first of `out` begins with what is pending there.
#[inline(always)]
pub(super) fn weigh(
    n: usize,
    k: usize,
    basis: &Basis,
    h: f64,
    nodes: &[f64],
    out: &mut [f64],
    pending: &mut [f64],
) {
    let m = k / n;
    let (nodes, out, pending) = (&nodes[..k + n], &mut out[..k], &mut pending[..n]);
    let products = &basis.products[..(m + 1) * (m + 1)];
    let sum = |l: usize, c: usize| -> f64 {
        h * (0..=m).map(|i| products[l * (m + 1) + i] * nodes[i * n + c]).sum::<f64>()
    };
    for c in 0..n {
        out[c] = sum(0, c) + pending[c];
        pending[c] = sum(m, c);
    }
    for l in 1..m {
        for c in 0..n {
            out[l * n + c] = sum(l, c);
        }
    }
}

/// The rows of one Gauss point: `slopes_k − h T values_k J`, the derivatives of `u′` being those without a
/// mass matrix, and the border's column.
#[inline(always)]
pub(super) fn fill(
    n: usize,
    k: usize,
    basis: &Basis,
    i: usize,
    (scale, by_period): (f64, f64),
    (jacobian, f): (&[f64], &[f64]),
    rows: &mut [f64],
) {
    let (m, wide) = (k / n, n + k + 1);
    let (jacobian, f) = (&jacobian[..n * n], &f[..n]);
    for l in 0..=m {
        let by = scale * basis.values[i * (m + 1) + l];
        let slope = basis.slopes[i * (m + 1) + l];
        for r in 0..n {
            let place = &mut rows[r * wide + l * n..r * wide + (l + 1) * n];
            for c in 0..n {
                place[c] = by * jacobian[r * n + c];
            }
            place[r] += slope;
        }
    }
    for r in 0..n {
        rows[r * wide + k + n] = by_period * f[r];
    }
}

/// The entries of a matrix, row by row.
pub(super) fn rows_of(a: &AnyMatrix, rows: &mut [f64], unit: &mut [f64]) {
    let n = unit.len();
    if let Some(dense) = a.downcast::<Dense>() {
        for c in 0..n {
            dense.column(c).iter().enumerate().for_each(|(r, value)| rows[r * n + c] = *value);
        }
        return;
    }
    rows.fill(0.0);
    if a.entries(&mut |r, c, value| rows[r * n + c] += value) {
        return;
    }
    let mut column = vec![0.0; n];
    for c in 0..n {
        unit.fill(0.0);
        unit[c] = 1.0;
        a.mul(unit, &mut column);
        (0..n).for_each(|r| rows[r * n + c] = column[r]);
    }
}
