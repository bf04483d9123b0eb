//! Shift-invert Arnoldi for pencils that are not symmetric.

use faer::c64;

use super::Matrix;
use super::eigen::{EigenReport, EigenSettings};
use super::krylov::{Dominant, dominant};

/// Ratio of the distances of the nearest and the farthest eigenvalue from the shift below which
/// the latter would be inaccurate.
const TOO_NEAR: f64 = 1e-7;
/// Part of the farther distance by which the shift then moves.
const ASIDE: f64 = 1e-4;

/// An eigenvalue and its eigenvector.
#[derive(Debug, Clone, PartialEq)]
pub struct Eigenpair {
    /// The eigenvalue, real and imaginary part.
    pub value: (f64, f64),
    /// Real part of the eigenvector, whose Euclidean length is one.
    pub re: Vec<f64>,
    /// Its imaginary part.
    pub im: Vec<f64>,
    /// Estimate of the error of the eigenvalue: the residual times the eigenvalue's condition
    /// number, as far as the iteration knows it.
    pub error: f64,
    /// Whether the residual met the tolerance.
    pub converged: bool,
}

/// Eigenvalues nearest to a shift, nearest first.
#[derive(Debug, Clone, PartialEq)]
pub struct Eigenpairs {
    /// The eigenvalues; of a real pencil about a real shift complex pairs stand next to each
    /// other, the one in the upper half plane first.
    pub pairs: Vec<Eigenpair>,
    /// How the iteration ended.
    pub report: EigenReport,
}

/// Eigenvalues of `A x = λ M x` nearest to a shift `σ`, from solves with `A − σM`; neither matrix
/// need be symmetric, `M` may be singular.
///
/// Arnoldi's iteration with `(A − σM)⁻¹M` and Krylov-Schur restarts (Stewart 2001); copies of
/// multiple eigenvalues are searched for from random vectors, as in [`Lanczos`](super::Lanczos).
/// Every vector is improved by one inverse iteration, which frees it from the null space of `M`.
/// A call allocates. The default tolerance is 1e-10.
///
/// # References
/// - G. W. Stewart, A Krylov-Schur algorithm for large eigenproblems, *SIAM J. Matrix Anal. Appl.*
///   23 (2001) 601-614.
#[derive(Debug, Clone)]
pub struct Arnoldi {
    n: usize,
    k: usize,
    settings: EigenSettings,
}

impl Arnoldi {
    /// A solver for `k` eigenvalues of pencils of dimension `n`; one more if that would leave out
    /// a conjugate.
    pub fn new(n: usize, k: usize) -> Self {
        Self { n, k, settings: EigenSettings { tolerance: 1e-10, ..EigenSettings::default() } }
    }

    /// The same with other settings.
    #[must_use]
    pub fn with_settings(mut self, settings: EigenSettings) -> Self {
        self.settings = settings;
        self
    }

    /// The eigenvalues nearest to the real `shift`.
    ///
    /// `mass(x, y)` sets `y = M x`, `solve(x)` replaces `x` by `(A − σM)⁻¹x`. A shift within
    /// rounding of an eigenvalue finds that one, but the others less accurately, as their errors
    /// say: keep a small distance.
    pub fn nearest(
        &self,
        shift: f64,
        mut mass: impl FnMut(&[f64], &mut [f64]),
        mut solve: impl FnMut(&mut [f64]),
        start: Option<&[f64]>,
    ) -> Eigenpairs {
        let mut mx = vec![0.0; self.n];
        let apply = |x: &mut [f64]| {
            mass(x, &mut mx);
            x.copy_from_slice(&mx);
            solve(x);
        };
        let found = dominant(self.n, self.k, &self.settings, apply, start);
        collect(found, c64::new(shift, 0.0), self.k.min(self.n))
    }

    /// The eigenvalues nearest to the point `i ω` of the imaginary axis, those of the lower half
    /// plane not among them unless they are as near; `M` is the identity if `mass` is `None`.
    ///
    /// `None` if the matrix has no complex form ([`Matrix::complex`]), as symmetric storage.
    /// Builds and factors the real form of `A − i ω M`; twice if the shift is so near to an
    /// eigenvalue that the others would be lost in the rounding.
    pub fn nearest_to_imaginary<A: Matrix>(
        &self,
        a: &A,
        mass: Option<&A>,
        omega: f64,
    ) -> Option<Eigenpairs> {
        let first = self.about_imaginary(a, mass, omega)?;
        let distance = |p: &Eigenpair| p.value.0.hypot(p.value.1 - omega);
        let (Some(near), Some(far)) = (first.pairs.first(), first.pairs.last()) else {
            return Some(first);
        };
        if distance(near) >= TOO_NEAR * distance(far) {
            return Some(first);
        }
        let mut second = self.about_imaginary(a, mass, omega + ASIDE * distance(far))?;
        second.pairs.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        second.report.solves += first.report.solves;
        Some(second)
    }

    fn about_imaginary<A: Matrix>(
        &self,
        a: &A,
        mass: Option<&A>,
        omega: f64,
    ) -> Option<Eigenpairs> {
        let n = self.n;
        debug_assert_eq!(n, a.dim(), "another dimension");
        let mut imaginary = a.clone();
        imaginary.set_zero();
        match mass {
            Some(mass) => imaginary.axpy(-omega, mass),
            None => {
                if !imaginary.add_identity(-omega) {
                    return None;
                }
            }
        }
        let mut shifted = a.complex(&imaginary)?;
        shifted.factor(f64::EPSILON * shifted.norm());
        let mut buffer = vec![0.0; 2 * n];
        let (mut part, mut image) = (vec![0.0; n], vec![0.0; n]);
        let apply = |x: &mut [c64]| {
            for which in 0..2 {
                for (p, x) in part.iter_mut().zip(x.iter()) {
                    *p = if which == 0 { x.re } else { x.im };
                }
                match mass {
                    Some(mass) => mass.mul(&part, &mut image),
                    None => image.copy_from_slice(&part),
                }
                for (i, y) in image.iter().enumerate() {
                    buffer[2 * i + which] = *y;
                }
            }
            shifted.solve(&mut buffer);
            for (x, pair) in x.iter_mut().zip(buffer.chunks_exact(2)) {
                *x = c64::new(pair[0], pair[1]);
            }
        };
        let found = dominant(n, self.k, &self.settings, apply, None);
        Some(collect(found, c64::new(0.0, omega), self.k.min(n)))
    }
}

/// From the eigenvalues `θ` of the operator to those of the pencil, `σ + 1/θ`.
fn collect(found: Dominant, shift: c64, wanted: usize) -> Eigenpairs {
    let mut pairs: Vec<Eigenpair> = found
        .ritz
        .into_iter()
        .map(|ritz| {
            let distance = ritz.theta.inv();
            let value = shift + distance;
            Eigenpair {
                value: (value.re, value.im),
                re: ritz.vector.iter().map(|x| x.re).collect(),
                im: ritz.vector.iter().map(|x| x.im).collect(),
                error: distance.norm() * ritz.error,
                converged: ritz.converged,
            }
        })
        .collect();
    // inversion exchanges the half planes
    for i in 1..pairs.len() {
        let ((p, q), (r, s)) = (pairs[i - 1].value, pairs[i].value);
        if shift.im == 0.0 && p == r && q == -s && q < 0.0 {
            pairs.swap(i - 1, i);
        }
    }
    let report = EigenReport {
        solves: found.applications,
        wanted: wanted.max(pairs.len()),
        converged: pairs.iter().filter(|p| p.converged).count(),
        complete: found.complete,
    };
    Eigenpairs { pairs, report }
}
