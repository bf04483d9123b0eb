//! Structured linear algebra for continuation; knows no problem.
//!
//! A [`Matrix`] keeps its entries and its factors in storage allocated once:
//! [`SymmetricBand`] (`L D Lᵀ`, inertia, a rank-one term), [`Band`] (LU with partial pivoting),
//! [`Dense`] (the same, and the full spectrum), [`Sparse`] (the same in a fill-reducing order) and
//! [`Arrow`] (any of them with a few full rows and columns). [`Bordered`] solves
//! `[A B; Cᵀ D] [x; y] = [f; g]` with one factorisation of the core `A`, accurately also where `A`
//! is singular, as it is at folds and branch points. [`Lanczos`] and [`Arnoldi`] find a few
//! eigenvalues of large pencils, symmetric or not, from solves; [`count_right`] counts those with a
//! positive real part, all of them.
//!
//! Pivots below a floor are replaced by it, and the factors then are those of a matrix within the
//! floor of the given one; borders repair that. Solutions are refined once where their residual is
//! above rounding. Nothing is allocated after construction, but the spectra, the LU to which a
//! symmetric band resorts when both its eliminations are unstable, and the first sparse factors.
//!
//! # Limits
//! Normwise accuracy: a matrix whose rows and columns differ by many orders of magnitude in ways
//! that no diagonal scaling explains is solved to the rounding of its largest entry. A solve
//! uses the entries for its residual: they must not change between [`Matrix::factor`] and
//! [`Matrix::solve`].
//!
//! # References
//! - W. Govaerts and J. D. Pryce, Mixed block elimination for linear systems with wider borders,
//!   *IMA J. Numer. Anal.* 13 (1993) 161-180.
//! - G. H. Golub and C. F. Van Loan, *Matrix Computations*, 4th ed., Johns Hopkins, 2013.

mod any;
mod arnoldi;
mod arrow;
mod band;
mod bordered;
mod complement;
mod dense;
mod eigen;
mod half_plane;
pub mod kernel;
mod krylov;
mod lanczos;
mod ldlt;
mod pencil;
mod scalar;
mod small_symmetric;
mod sparse;
mod sparse_lu;
mod spectrum;
mod symmetric_band;
mod vector;

pub(crate) use vector::max_abs;

pub use any::AnyMatrix;
pub use arnoldi::{Arnoldi, Eigenpair, Eigenpairs};
pub use arrow::Arrow;
pub use band::Band;
pub use bordered::{Bordered, BorderedFacts};
pub use dense::{Dense, MAX_SPECTRUM};
pub use eigen::{EigenReport, EigenSettings};
pub use half_plane::{HalfPlane, count_right};
pub use lanczos::Lanczos;
pub use sparse::{OutsidePattern, Sparse};
pub use spectrum::Spectrum;
pub use symmetric_band::{MAX_GROWTH, SymmetricBand};

/// What a factorisation learned about its matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facts {
    /// Sign of the determinant of the factors. Where a pivot had to be replaced
    /// (`perturbed > 0`) it says nothing about the matrix itself, but together with Schur
    /// complements from the same factors it gives the sign of a regular bordered determinant.
    /// `None` if the method does not know it; the tracer, which needs the orientation of the branch,
    /// then refuses every step.
    pub det_sign: Option<i8>,
    /// Numbers of (negative, positive) eigenvalues of the factors, for symmetric matrices;
    /// with the same proviso.
    pub inertia: Option<(usize, usize)>,
    /// Largest growth of an entry during elimination, relative to the largest entry.
    pub growth: f64,
    /// Number of pivots that were below the floor and were replaced by it.
    pub perturbed: usize,
}

/// The symmetric part of a matrix: how many of its eigenvalues have which sign.
///
/// Of a symmetric matrix that is the inertia. Of another one it decides two cases: where no
/// eigenvalue of the symmetric part is positive, none of the matrix has a positive real part, and
/// the other way round (Bendixson 1902). In between it bounds nothing: `[[1, 9], [0, 1]]` has two
/// eigenvalues on the right, its symmetric part has one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SymmetricPart {
    /// Number of negative eigenvalues.
    pub negative: usize,
    /// Number of positive eigenvalues.
    pub positive: usize,
    /// Whether the matrix is symmetric, to rounding.
    pub whole: bool,
}

/// A square matrix that can be factored and solved with; entries survive [`Matrix::factor`].
///
/// All vectors have length [`Matrix::dim`]. Nothing fails: a singular matrix is factored with its
/// small pivots replaced, and [`Facts::perturbed`] says so.
pub trait Matrix: Clone + Send + Sync + 'static {
    /// Number of rows and columns.
    fn dim(&self) -> usize;
    /// Sets all entries to zero, keeping the pattern. Factors stay.
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
    /// Solves `A x = b` in place with the latest factors; `x` is `b` at first.
    fn solve(&mut self, x: &mut [f64]);
    /// Solves `Aᵀ x = b` in place with the latest factors.
    fn solve_transpose(&mut self, x: &mut [f64]);
    /// Whether a factorisation costs so much more than a solve that corrections go on with factors of a
    /// state near by (false by default).
    fn prefers_solves(&self) -> bool {
        false
    }
    /// The first entry since [`Matrix::set_zero`] that was to be written outside the pattern, where the
    /// type does not refuse it at once; it is not written, and an assembly with one is an error
    /// ([`crate::EvalError::OutsidePattern`]). `None` by default.
    fn misplaced(&self) -> Option<OutsidePattern> {
        None
    }
    /// Visits the entries that may differ from zero as (row, column, value), an entry in parts if that is
    /// how it is kept, true; false (the default) where the type does not list them.
    fn entries(&self, visit: &mut dyn FnMut(usize, usize, f64)) -> bool {
        let _ = visit;
        false
    }
    /// `A += a I`, true; false (the default) where the type does not do that.
    fn add_identity(&mut self, a: f64) -> bool {
        let _ = a;
        false
    }
    /// All eigenvalues of `A x = λ x`, or of `A x = λ M x` with a mass matrix, as (real,
    /// imaginary) pairs, where a full spectrum is affordable (small dense matrices); `None`
    /// otherwise. Infinite eigenvalues (of a singular `M`) are left out.
    fn spectrum(&self, mass: Option<&Self>) -> Option<Vec<(f64, f64)>> {
        let _ = mass;
        None
    }
    /// The same with what rounding may have moved each of them by. Dearer.
    fn spectrum_with_errors(&self, mass: Option<&Self>) -> Option<Spectrum> {
        self.spectrum(mass).map(Spectrum::unknown)
    }
    /// Numbers of negative and positive eigenvalues of the symmetric part `(A + Aᵀ)/2` of a matrix
    /// that is stored without symmetry, where they are cheap and certain; `None` (the default)
    /// otherwise. The factors stay those of [`Matrix::factor`], which came before.
    fn symmetric_part(&mut self) -> Option<SymmetricPart> {
        None
    }
    /// The real form of the complex matrix `A + i B`, of twice the dimension: entry `(j, k)`
    /// becomes the block `[a −b; b a]` at rows `2j, 2j + 1` and columns `2k, 2k + 1`, so that
    /// unknowns are real and imaginary parts in turn and a band stays a band. `None` where the
    /// type cannot hold it (symmetric storage).
    fn complex(&self, imaginary: &Self) -> Option<Self> {
        let _ = imaginary;
        None
    }
}
