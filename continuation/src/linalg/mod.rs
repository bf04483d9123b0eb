//! Structured linear algebra for continuation; knows no problem.
//!
//! A [`Matrix`] keeps its entries and its factors in storage allocated once.

/// What a factorisation learned about its matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facts {
    /// Sign of the determinant; `None` when a pivot had to be replaced.
    pub det_sign: Option<i8>,
    /// Numbers of (negative, positive) eigenvalues, for symmetric matrices.
    pub inertia: Option<(usize, usize)>,
    /// Largest growth of an entry during elimination, relative to the largest entry.
    pub growth: f64,
    /// Number of pivots that were below the floor and were replaced by it.
    pub perturbed: usize,
}

/// A square matrix that can be factored and solved with; entries survive [`Matrix::factor`].
pub trait Matrix: Clone + Send {
    /// Number of rows and columns.
    fn dim(&self) -> usize;
    /// Sets all entries to zero, keeping the pattern.
    fn set_zero(&mut self);
    /// `y = A x`.
    fn mul(&self, x: &[f64], y: &mut [f64]);
    /// `y = Aᵀ x`.
    fn mul_transpose(&self, x: &[f64], y: &mut [f64]);
    /// `A += a · other`, both of the same pattern.
    fn axpy(&mut self, a: f64, other: &Self);
    /// Largest absolute entry, the scale to which pivots are compared.
    fn norm(&self) -> f64;
    /// Factors the current entries. Pivots smaller than `floor` in magnitude are replaced by it.
    fn factor(&mut self, floor: f64) -> Facts;
    /// Solves `A x = b` in place with the latest factors.
    fn solve(&mut self, x: &mut [f64]);
    /// Solves `Aᵀ x = b` in place with the latest factors.
    fn solve_transpose(&mut self, x: &mut [f64]);
    /// All eigenvalues as (real, imaginary) pairs, where a full spectrum is affordable
    /// (small dense matrices); `None` otherwise.
    fn spectrum(&self) -> Option<Vec<(f64, f64)>> {
        None
    }
}
