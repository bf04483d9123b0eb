//! Finite eigenvalues of a pencil `A − λ M` whose mass matrix may be singular.
//!
//! How many eigenvalues are infinite follows from ranks, not from the size of computed eigenvalues: a
//! mass matrix that is regular once its rows and columns have the same size has none, however large
//! the eigenvalues are. Where it is singular its kernel is deflated: the equations without a derivative
//! are solved for as many unknowns as they determine (index one), and what they leave constrains the
//! rest (index two and higher), in orthonormal bases. The finite eigenvalues are then those of
//! `(A − σM)⁻¹M` for a regular `M`, balanced, so that slow modes beside fast ones keep their digits.

use super::spectrum::{Spectrum, as_it_is};
use faer::linalg::solvers::Solve;
use faer::{Mat, Scale};

/// Singular values below this many roundings, times the dimension, are zero.
const RANK: f64 = 32.0;
/// Singular values between rounding and this part of the largest, times what was lost before, leave the
/// rank uncertain.
const GREY: f64 = 1e-11;
/// Sweeps that give rows and columns the same size.
const SWEEPS: usize = 8;
/// Shifts of a pencil, in units of `|A| / |M|`: irregular numbers, some on either side.
const SHIFTS: [f64; 4] = [0.739, -0.618, 0.213, -0.171];
/// Pivots this much smaller than the largest of the same matrix, times the dimension, make a shift
/// no worse than another: it is what graded matrices have.
const SINGULAR: f64 = 1e-280;

/// The finite eigenvalues of `A x = λ M x`; `None` where the pencil is singular for every `λ`.
pub(super) fn finite_eigenvalues(a: Mat<f64>, m: Mat<f64>) -> Option<Vec<(f64, f64)>> {
    let Some(inverse) = Inverse::of(Reduced::of(a, m)?)? else { return Some(Vec::new()) };
    let values = inverse.operator.eigenvalues().ok()?;
    let values: Vec<(f64, f64)> = values.iter().map(|z| inverse.back((z.re, z.im))).collect();
    values.iter().all(|(re, im)| re.is_finite() && im.is_finite()).then_some(values)
}

/// The same with their errors; complete where the ranks are beyond doubt.
pub(super) fn finite_spectrum(a: Mat<f64>, m: Mat<f64>) -> Option<Spectrum> {
    let reduced = Reduced::of(a, m)?;
    let complete = reduced.clear;
    let Some(inverse) = Inverse::of(reduced)? else {
        return Some(Spectrum { values: Vec::new(), errors: Vec::new(), complete });
    };
    let found = as_it_is(&inverse.operator)?;
    let moved = |(z, error): (&(f64, f64), &f64)| {
        let (size, error) = (z.0.hypot(z.1), inverse.loss * error);
        // an eigenvalue of the operator that may be zero may belong to any other
        let by = if error < size { error / (size * (size - error)) } else { f64::INFINITY };
        (inverse.back(*z), by)
    };
    let (values, errors): (Vec<_>, Vec<_>) =
        found.values.iter().zip(&found.errors).map(moved).unzip();
    let finite = |z: &(f64, f64)| z.0.is_finite() && z.1.is_finite();
    values.iter().all(finite).then_some(Spectrum { values, errors, complete })
}

/// `(A − σM)⁻¹M`, whose eigenvalues are `1/(λ − σ)`.
struct Inverse {
    operator: Mat<f64>,
    shift: f64,
    /// By how much its errors exceed those of the QR iteration.
    loss: f64,
}

impl Inverse {
    /// `Some(None)` of a pencil without finite eigenvalues.
    fn of(Reduced { a, mut m, loss, .. }: Reduced) -> Option<Option<Self>> {
        if a.nrows() == 0 {
            return Some(None);
        }
        let (a_norm, m_norm) = (a.norm_max(), m.norm_max());
        let unit = if a_norm > 0.0 { a_norm / m_norm } else { 1.0 };
        let mut best = None;
        let mut best_ratio = SINGULAR;
        for shift in SHIFTS.map(|s| s * unit) {
            // rows of one size: what is left of the ratio of pivots is lost
            let shifted = &a - &m * Scale(shift);
            let rows: Vec<f64> = (0..a.nrows())
                .map(|i| (0..a.nrows()).fold(0.0_f64, |s, j| s.max(shifted[(i, j)].abs())))
                .map(|size| if size > 0.0 { (-size.log2().round()).exp2() } else { 1.0 })
                .collect();
            let scaled = Mat::from_fn(a.nrows(), a.nrows(), |i, j| rows[i] * shifted[(i, j)]);
            let lu = scaled.full_piv_lu();
            let pivots = (0..a.nrows()).map(|i| lu.U()[(i, i)].abs());
            let (least, most) =
                pivots.fold((f64::INFINITY, 0.0), |(l, g): (f64, f64), d| (l.min(d), g.max(d)));
            if least > best_ratio * most {
                best_ratio = least / most;
                best = Some((shift, lu, rows));
            }
        }
        let (shift, lu, rows) = best?;
        for j in 0..m.ncols() {
            (0..m.nrows()).for_each(|i| m[(i, j)] *= rows[i]);
        }
        let loss = loss * (1.0 + best_ratio.recip());
        Some(Some(Inverse { operator: balanced(lu.solve(&m)), shift, loss }))
    }

    /// The eigenvalue of the pencil to one of the operator.
    fn back(&self, (re, im): (f64, f64)) -> (f64, f64) {
        let size = re.hypot(im);
        (self.shift + re / size / size, -im / size / size)
    }
}

/// A pencil with the same finite eigenvalues, whose `M` is regular.
struct Reduced {
    a: Mat<f64>,
    m: Mat<f64>,
    /// Whether no rank was in doubt.
    clear: bool,
    /// By how much what was solved for magnifies rounding.
    loss: f64,
}

impl Reduced {
    fn of(mut a: Mat<f64>, mut m: Mat<f64>) -> Option<Self> {
        let (mut clear, mut loss) = (true, 1.0_f64);
        loop {
            let n = a.nrows();
            if n == 0 {
                return Some(Reduced { a, m, clear, loss });
            }
            equilibrate(&mut a, &mut m);
            let (u, s, v) = svd(&m)?;
            let zero = RANK * n as f64 * f64::EPSILON;
            let doubt = |x: &f64, of: f64, lost: f64| *x > zero * of && *x < GREY * lost * of;
            let rank = s.iter().filter(|x| **x > zero * s[0]).count();
            clear &= !s.iter().any(|x| doubt(x, s[0], loss));
            if rank == n {
                return Some(Reduced { a, m, clear, loss });
            }
            // [A11 A12; A21 A22] − λ [Σ 0; 0 0]
            let turned = u.transpose() * &a * &v;
            let q = n - rank;
            let block =
                |i: usize, j: usize, r: usize, c: usize| turned.submatrix(i, j, r, c).to_owned();
            let (a11, a12) = (block(0, 0, rank, rank), block(0, rank, rank, q));
            let (a21, a22) = (block(rank, 0, q, rank), block(rank, rank, q, q));
            let size = a21.norm_max().max(a22.norm_max()).max(a12.norm_max());
            let (u2, s2, v2) = svd(&a22)?;
            let solved = s2.iter().filter(|x| **x > zero * size).count();
            clear &= !s2.iter().any(|x| doubt(x, size, loss));
            if solved > 0 {
                loss *= (size / s2[solved - 1]).max(1.0);
            }
            let (b, c) = (&a12 * &v2, u2.transpose() * &a21);
            let reduced = Mat::from_fn(rank, rank, |i, j| {
                let sum: f64 = (0..solved).map(|k| b[(i, k)] / s2[k] * c[(k, j)]).sum();
                a11[(i, j)] - sum
            });
            let mass = Mat::from_fn(rank, rank, |i, j| if i == j { s[i] } else { 0.0 });
            let left = q - solved;
            if left == 0 {
                return Some(Reduced { a: reduced, m: mass, clear, loss });
            }
            if left > rank {
                return None;
            }
            // C x = 0, with as many free right-hand sides B
            let c = c.submatrix(solved, 0, left, rank).transpose().to_owned();
            let b = b.submatrix(0, solved, rank, left).to_owned();
            let (zc, zb) = (complement(&c, zero)?, complement(&b, zero)?);
            a = zb.transpose() * &reduced * &zc;
            m = zb.transpose() * &mass * &zc;
        }
    }
}

/// An orthonormal basis of what is orthogonal to the columns of `x`; `None` if they depend on each
/// other.
fn complement(x: &Mat<f64>, zero: f64) -> Option<Mat<f64>> {
    let (n, k) = (x.nrows(), x.ncols());
    let full = x.svd().ok()?;
    let s = full.S().column_vector();
    if (0..k).any(|i| s[i] <= zero * s[0]) || s[0] == 0.0 {
        return None;
    }
    Some(full.U().submatrix(0, k, n, n - k).to_owned())
}

/// `U`, the singular values from the largest on, and `V`.
fn svd(x: &Mat<f64>) -> Option<(Mat<f64>, Vec<f64>, Mat<f64>)> {
    let svd = x.svd().ok()?;
    let s = svd.S().column_vector();
    let values = (0..s.nrows()).map(|i| s[i]).collect();
    Some((svd.U().to_owned(), values, svd.V().to_owned()))
}

/// Scales rows and columns of both matrices so that those of `M` have the size 1; those in which `M`
/// has nothing get it from `A`. By powers of two: nothing is rounded.
fn equilibrate(a: &mut Mat<f64>, m: &mut Mat<f64>) {
    let n = a.nrows();
    let power = |x: f64| (-0.5 * x.log2()).round().exp2();
    let largest = |x: &Mat<f64>, i: usize, row: bool| {
        let at = |k: usize| if row { x[(i, k)].abs() } else { x[(k, i)].abs() };
        (0..n).map(at).fold(0.0, f64::max)
    };
    for _ in 0..SWEEPS {
        for row in [true, false] {
            for i in 0..n {
                let own = largest(m, i, row);
                let size = if own > 0.0 { own } else { largest(a, i, row) };
                // a whole power per sweep and side would overshoot: the square root
                let factor = if size > 0.0 && size.is_finite() { power(size) } else { 1.0 };
                for k in 0..n {
                    let at = if row { (i, k) } else { (k, i) };
                    a[at] *= factor;
                    m[at] *= factor;
                }
            }
        }
    }
}

/// A similar matrix whose rows and columns have about the same size (Parlett and Reinsch 1969), in the
/// order of their sizes.
fn balanced(mut x: Mat<f64>) -> Mat<f64> {
    let n = x.nrows();
    let sizes = |x: &Mat<f64>, i: usize| {
        let others = (0..n).filter(|k| *k != i);
        others.fold((0.0, 0.0), |(r, c): (f64, f64), k| (r + x[(i, k)].abs(), c + x[(k, i)].abs()))
    };
    for _ in 0..20 {
        let mut changed = false;
        for i in 0..n {
            let (row, column) = sizes(&x, i);
            if !(row > 0.0 && column > 0.0) {
                continue;
            }
            let factor = (0.5 * (row / column).log2()).round().exp2();
            if factor != 1.0 && factor.is_finite() && factor > 0.0 {
                for k in 0..n {
                    x[(i, k)] /= factor;
                    x[(k, i)] *= factor;
                }
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
    let mut order: Vec<usize> = (0..n).collect();
    let size = |i: usize| {
        let (row, column) = sizes(&x, i);
        row.max(column).max(x[(i, i)].abs())
    };
    order.sort_by(|i, j| size(*j).total_cmp(&size(*i)));
    Mat::from_fn(n, n, |i, j| x[(order[i], order[j])])
}
