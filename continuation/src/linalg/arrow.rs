//! A matrix with a few full rows and columns.

use super::vector::{add_scaled, dot, max_abs};
use super::{Bordered, Dense, Facts, Matrix, OutsidePattern, Spectrum};

/// Largest dimension of which an [`Arrow`] computes the full spectrum.
const MAX_SPECTRUM: usize = 100;

/// `[A B; Cᵀ D]`: a core `A` with `m` further rows and columns, for integral constraints and their
/// multipliers, global unknowns and the like.
///
/// The full rows never enter the factorisation of the core; a [`Bordered`] solver eliminates them.
/// An arrow is a [`Matrix`] itself and may be the core of another [`Bordered`] solver or arrow,
/// also where it is singular. Its core may be singular as often as there are borders to cure it.
///
/// What is conserved, or free, makes a Jacobian singular everywhere. One more equation fixes it, and a
/// multiplier that vanishes at every solution keeps the matrix square:
///
/// ```
/// use continuation::linalg::{Arrow, Dense, Matrix};
/// // A ⇌ B: the rows of the core cancel, the total u₁ + u₂ is fixed by the full row
/// let mut j = Arrow::new(Dense::new(2), 1);
/// for (row, rate) in [(0, -1.0), (1, 1.0)] {
///     j.core_mut().set(row, 0, rate);
///     j.core_mut().set(row, 1, -rate);
/// }
/// j.column_mut(0).fill(1.0); // the multiplier in both equations: along what is conserved
/// j.row_mut(0).fill(1.0); // the total
/// let facts = j.factor(f64::EPSILON * j.norm());
/// assert_eq!((facts.perturbed, facts.det_sign), (0, Some(1)));
/// ```
///
/// If the borders are symmetric, `B = C` and `D = Dᵀ` to the bit, and the core reports its
/// inertia, so does the arrow. A constraint adds one negative eigenvalue that is no instability.
/// The floor given to [`Matrix::factor`] is used for a matrix of zeros only; otherwise core and
/// Schur complements have floors at their own rounding, which do not depend on the scale of the
/// borders.
#[derive(Debug, Clone)]
pub struct Arrow<A> {
    core: A,
    borders: Bordered,
    n: usize,
    m: usize,
    refine: bool,
}

impl<A: Matrix> Arrow<A> {
    /// The core with `m` further rows and columns, all zero.
    pub fn new(core: A, m: usize) -> Self {
        let n = core.dim();
        Self { core, borders: Bordered::new(n, m), n, m, refine: false }
    }

    /// Dimension of the core and number of borders.
    pub fn dims(&self) -> (usize, usize) {
        (self.n, self.m)
    }

    /// The core `A`.
    pub fn core(&self) -> &A {
        &self.core
    }

    /// The core `A`, to be filled.
    pub fn core_mut(&mut self) -> &mut A {
        &mut self.core
    }

    /// Column `k` of `B`, that is, column `n + k` without its end in the corner.
    pub fn column(&self, k: usize) -> &[f64] {
        self.borders.column(k)
    }

    /// Column `k` of `B`, to be filled.
    pub fn column_mut(&mut self, k: usize) -> &mut [f64] {
        self.borders.column_mut(k)
    }

    /// Column `k` of `C`, that is, row `n + k` without its end in the corner.
    pub fn row(&self, k: usize) -> &[f64] {
        self.borders.row(k)
    }

    /// Column `k` of `C`, to be filled.
    pub fn row_mut(&mut self, k: usize) -> &mut [f64] {
        self.borders.row_mut(k)
    }

    /// Entry `(i, k)` of the corner `D`.
    pub fn corner(&self, i: usize, k: usize) -> f64 {
        self.borders.corner(i, k, false)
    }

    /// Sets entry `(i, k)` of the corner `D`.
    pub fn set_corner(&mut self, i: usize, k: usize, value: f64) {
        self.borders.set_corner(i, k, value);
    }

    fn multiply(&self, x: &[f64], y: &mut [f64], transposed: bool) {
        let (x, p) = x.split_at(self.n);
        let (y, q) = y.split_at_mut(self.n);
        if transposed {
            self.core.mul_transpose(x, y);
        } else {
            self.core.mul(x, y);
        }
        for k in 0..self.m {
            let (column, row) = (self.column(k), self.row(k));
            let (column, row) = if transposed { (row, column) } else { (column, row) };
            add_scaled(y, p[k], column);
            q[k] = dot(row, x);
            for i in 0..self.m {
                q[k] += self.borders.corner(k, i, transposed) * p[i];
            }
        }
    }
}

impl<A: Matrix> Matrix for Arrow<A> {
    fn dim(&self) -> usize {
        self.n + self.m
    }

    fn set_zero(&mut self) {
        self.core.set_zero();
        self.borders.entries_mut().into_iter().for_each(|part| part.fill(0.0));
    }

    fn misplaced(&self) -> Option<OutsidePattern> {
        self.core.misplaced()
    }

    fn mul(&self, x: &[f64], y: &mut [f64]) {
        self.multiply(x, y, false);
    }

    fn mul_transpose(&self, x: &[f64], y: &mut [f64]) {
        self.multiply(x, y, true);
    }

    fn axpy(&mut self, a: f64, other: &Self) {
        debug_assert_eq!((self.n, self.m), (other.n, other.m), "different patterns");
        self.core.axpy(a, &other.core);
        for (part, other) in self.borders.entries_mut().into_iter().zip(other.borders.entries()) {
            add_scaled(part, a, other);
        }
    }

    fn norm(&self) -> f64 {
        self.borders.entries().into_iter().map(max_abs).fold(self.core.norm(), f64::max)
    }

    fn factor(&mut self, floor: f64) -> Facts {
        let facts = self.borders.factor_as_core(&mut self.core, floor);
        self.refine = facts.perturbed == 0;
        facts
    }

    fn solve(&mut self, x: &mut [f64]) {
        let (f, g) = x.split_at_mut(self.n);
        self.borders.solve_with(&mut self.core, f, g, false, self.refine);
    }

    fn solve_transpose(&mut self, x: &mut [f64]) {
        let (f, g) = x.split_at_mut(self.n);
        self.borders.solve_with(&mut self.core, f, g, true, self.refine);
    }

    fn entries(&self, visit: &mut dyn FnMut(usize, usize, f64)) -> bool {
        for k in 0..self.m {
            let last = self.n + k;
            self.column(k).iter().enumerate().for_each(|(i, value)| visit(i, last, *value));
            self.row(k).iter().enumerate().for_each(|(j, value)| visit(last, j, *value));
            (0..self.m).for_each(|i| visit(self.n + i, last, self.corner(i, k)));
        }
        self.core.entries(visit)
    }

    fn add_identity(&mut self, a: f64) -> bool {
        if !self.core.add_identity(a) {
            return false;
        }
        for k in 0..self.m {
            let value = self.corner(k, k) + a;
            self.set_corner(k, k, value);
        }
        true
    }

    /// Through a [`Dense`] copy, up to 100 unknowns; `None` beyond.
    fn spectrum(&self, mass: Option<&Self>) -> Option<Vec<(f64, f64)>> {
        if self.dim() > MAX_SPECTRUM {
            return None;
        }
        dense(self).spectrum(mass.map(dense).as_ref())
    }

    fn spectrum_with_errors(&self, mass: Option<&Self>) -> Option<Spectrum> {
        if self.dim() > MAX_SPECTRUM {
            return None;
        }
        dense(self).spectrum_with_errors(mass.map(dense).as_ref())
    }

    fn complex(&self, imaginary: &Self) -> Option<Self> {
        debug_assert_eq!((self.n, self.m), (imaginary.n, imaginary.m), "different patterns");
        let mut out = Self::new(self.core.complex(&imaginary.core)?, 2 * self.m);
        for k in 0..self.m {
            for i in 0..self.n {
                let (a, b) = (self.column(k)[i], imaginary.column(k)[i]);
                out.column_mut(2 * k)[2 * i..2 * i + 2].copy_from_slice(&[a, b]);
                out.column_mut(2 * k + 1)[2 * i..2 * i + 2].copy_from_slice(&[-b, a]);
                let (a, b) = (self.row(k)[i], imaginary.row(k)[i]);
                out.row_mut(2 * k)[2 * i..2 * i + 2].copy_from_slice(&[a, -b]);
                out.row_mut(2 * k + 1)[2 * i..2 * i + 2].copy_from_slice(&[b, a]);
            }
            for i in 0..self.m {
                let (a, b) = (self.corner(i, k), imaginary.corner(i, k));
                out.set_corner(2 * i, 2 * k, a);
                out.set_corner(2 * i, 2 * k + 1, -b);
                out.set_corner(2 * i + 1, 2 * k, b);
                out.set_corner(2 * i + 1, 2 * k + 1, a);
            }
        }
        Some(out)
    }
}

/// The matrix by its action on unit vectors.
fn dense(a: &impl Matrix) -> Dense {
    let n = a.dim();
    let mut out = Dense::new(n);
    let mut unit = vec![0.0; n];
    for j in 0..n {
        unit[j] = 1.0;
        a.mul(&unit, out.column_mut(j));
        unit[j] = 0.0;
    }
    out
}
