//! What Arnoldi's iteration and sparse elimination need of real and complex numbers.

use faer::{Mat, c64};
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Sub};

use super::vector;

/// Eigenvalues of a small matrix and its eigenvectors, columns of length one.
pub(super) type SmallEigen = (Vec<c64>, Mat<c64>);

pub(super) trait Scalar:
    Copy
    + Debug
    + PartialEq
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + 'static
{
    const ZERO: Self;
    /// Whether eigenvalues come in conjugate pairs.
    const REAL: bool;
    fn real(x: f64) -> Self;
    fn complex(self) -> c64;
    fn conj(self) -> Self;
    fn square(self) -> f64;
    fn size(self) -> f64;
    /// The number over its size; 1 for zero.
    fn direction(self) -> Self;
    /// `xᴴ y`.
    fn dot(x: &[Self], y: &[Self]) -> Self;
    /// `y += a x`.
    fn add_scaled(y: &mut [Self], a: Self, x: &[Self]);
    /// Vectors of this type that span a complex one, and its conjugate: one or two, orthogonal,
    /// the longer one first.
    fn parts(x: &[c64], visit: impl FnMut(Vec<Self>));
    /// Fills with random numbers from a source of real ones.
    fn fill(x: &mut [Self], source: impl FnMut(&mut [f64]));
}

pub(super) fn norm<T: Scalar>(x: &[T]) -> f64 {
    x.iter().map(|x| x.square()).sum::<f64>().sqrt()
}

/// Eigenvalues and vectors of the `m` by `m` matrix of these entries; `None` if that fails.
///
/// In complex arithmetic for real matrices too: faer 0.24 gives wrong eigenvectors of real
/// matrices with equal complex pairs.
pub(super) fn eigen(m: usize, entry: impl FnMut(usize, usize) -> c64) -> Option<SmallEigen> {
    let eigen = Mat::from_fn(m, m, entry).eigen().ok()?;
    let mut vectors = eigen.U().to_owned();
    for j in 0..m {
        let length = (0..m).map(|i| vectors[(i, j)].norm_sqr()).sum::<f64>().sqrt();
        (0..m).for_each(|i| vectors[(i, j)] /= length);
    }
    Some(((0..m).map(|i| eigen.S()[i]).collect(), vectors))
}

impl Scalar for f64 {
    const ZERO: Self = 0.0;
    const REAL: bool = true;

    fn real(x: f64) -> Self {
        x
    }

    fn complex(self) -> c64 {
        c64::new(self, 0.0)
    }

    fn conj(self) -> Self {
        self
    }

    fn square(self) -> f64 {
        self * self
    }

    fn size(self) -> f64 {
        self.abs()
    }

    fn direction(self) -> Self {
        f64::from(vector::sign(self))
    }

    fn dot(x: &[Self], y: &[Self]) -> Self {
        vector::dot(x, y)
    }

    fn add_scaled(y: &mut [Self], a: Self, x: &[Self]) {
        vector::add_scaled(y, a, x);
    }

    fn parts(x: &[c64], mut visit: impl FnMut(Vec<Self>)) {
        let square: c64 = x.iter().map(|x| x * x).sum();
        let turn = c64::from_polar(1.0, -0.5 * square.arg());
        visit(x.iter().map(|x| (turn * x).re).collect());
        visit(x.iter().map(|x| (turn * x).im).collect());
    }

    fn fill(x: &mut [Self], mut source: impl FnMut(&mut [f64])) {
        source(x);
    }
}

impl Scalar for c64 {
    const ZERO: Self = c64::new(0.0, 0.0);
    const REAL: bool = false;

    fn real(x: f64) -> Self {
        c64::new(x, 0.0)
    }

    fn complex(self) -> c64 {
        self
    }

    fn conj(self) -> Self {
        c64::conj(&self)
    }

    fn square(self) -> f64 {
        self.norm_sqr()
    }

    fn size(self) -> f64 {
        self.norm()
    }

    fn direction(self) -> Self {
        let size = self.norm();
        if size > 0.0 { self / size } else { Self::real(1.0) }
    }

    fn dot(x: &[Self], y: &[Self]) -> Self {
        x.iter().zip(y).map(|(x, y)| c64::conj(x) * y).sum()
    }

    fn add_scaled(y: &mut [Self], a: Self, x: &[Self]) {
        for (y, x) in y.iter_mut().zip(x) {
            *y += a * x;
        }
    }

    fn parts(x: &[c64], mut visit: impl FnMut(Vec<Self>)) {
        visit(x.to_vec());
    }

    fn fill(x: &mut [Self], mut source: impl FnMut(&mut [f64])) {
        let mut part = [0.0; 2];
        for x in x {
            source(&mut part);
            *x = c64::new(part[0], part[1]);
        }
    }
}
