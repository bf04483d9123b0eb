//! Random matrices and dense oracles by faer.

use continuation::linalg::{Band, Dense, Matrix, SymmetricBand};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

/// Uniform numbers in (-1, 1), reproducible.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub(crate) fn vector(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.next()).collect()
    }

    pub(crate) fn symmetric_band(&mut self, n: usize, kd: usize) -> SymmetricBand {
        let mut a = SymmetricBand::new(n, kd);
        for j in 0..n {
            a.column_mut(j).iter_mut().for_each(|entry| *entry = self.next());
        }
        a
    }

    pub(crate) fn band(&mut self, n: usize, kl: usize, ku: usize) -> Band {
        let mut a = Band::new(n, kl, ku);
        for j in 0..n {
            for i in j.saturating_sub(ku)..(j + kl + 1).min(n) {
                a.set(i, j, self.next());
            }
        }
        a
    }

    pub(crate) fn dense(&mut self, n: usize) -> Dense {
        let mut a = Dense::new(n);
        (0..n).for_each(|j| a.column_mut(j).iter_mut().for_each(|entry| *entry = self.next()));
        a
    }
}

/// The matrix by its action on unit vectors.
pub(crate) fn to_mat(a: &impl Matrix) -> Mat<f64> {
    let n = a.dim();
    let mut mat = Mat::zeros(n, n);
    let mut y = vec![0.0; n];
    for j in 0..n {
        let mut e = vec![0.0; n];
        e[j] = 1.0;
        a.mul(&e, &mut y);
        (0..n).for_each(|i| mat[(i, j)] = y[i]);
    }
    mat
}

pub(crate) fn to_dense(mat: &Mat<f64>) -> Dense {
    let n = mat.nrows();
    let mut a = Dense::new(n);
    (0..n * n).for_each(|k| a.set(k / n, k % n, mat[(k / n, k % n)]));
    a
}

pub(crate) fn dense_solve(a: &Mat<f64>, b: &[f64]) -> Vec<f64> {
    let rhs = Mat::from_fn(b.len(), 1, |i, _| b[i]);
    let x = a.full_piv_lu().solve(&rhs);
    (0..b.len()).map(|i| x[(i, 0)]).collect()
}

pub(crate) fn det_sign(a: &Mat<f64>) -> i8 {
    if a.determinant() < 0.0 { -1 } else { 1 }
}

pub(crate) fn eigenvalues(a: &Mat<f64>) -> Vec<f64> {
    a.self_adjoint_eigenvalues(Side::Lower).unwrap()
}

pub(crate) fn negatives(a: &Mat<f64>) -> usize {
    eigenvalues(a).iter().filter(|v| **v < 0.0).count()
}

pub(crate) fn condition(a: &Mat<f64>) -> f64 {
    let values = a.singular_values().unwrap();
    values[0] / values[values.len() - 1]
}

pub(crate) fn max_abs(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

pub(crate) fn error(x: &[f64], exact: &[f64]) -> f64 {
    let difference: Vec<f64> = x.iter().zip(exact).map(|(a, b)| a - b).collect();
    max_abs(&difference) / max_abs(exact)
}

pub(crate) fn factor(a: &mut impl Matrix) -> continuation::Facts {
    let floor = f64::EPSILON * a.norm();
    a.factor(floor)
}

/// Residual of a solve relative to `|A| |x|`, with the dense copy of the matrix.
pub(crate) fn backward_error(a: &Mat<f64>, x: &[f64], b: &[f64]) -> f64 {
    let n = b.len();
    let mut worst: f64 = 0.0;
    let norm = (0..n)
        .flat_map(|i| (0..n).map(move |j| (i, j)))
        .fold(0.0, |m: f64, (i, j)| m.max(a[(i, j)].abs()));
    for i in 0..n {
        let r = b[i] - (0..n).map(|j| a[(i, j)] * x[j]).sum::<f64>();
        worst = worst.max(r.abs());
    }
    worst / (norm * max_abs(x) + max_abs(b))
}

/// Shifts the diagonal so that the eigenvalue of smallest magnitude becomes `value`.
pub(crate) fn shift_smallest(a: &mut SymmetricBand, value: f64) {
    let values = eigenvalues(&to_mat(a));
    let smallest =
        values.iter().fold(f64::INFINITY, |m: f64, v| if v.abs() < m.abs() { *v } else { m });
    (0..a.dim()).for_each(|i| a.add(i, i, value - smallest));
}
