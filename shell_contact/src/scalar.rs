//! Scalars that pointwise densities are written in.
//!
//! The same source runs on `f64` (profiles, single points), on [`Lanes`] (four quadrature points
//! in lockstep, which the compiler turns into vector instructions) and, in tests, on dual numbers,
//! which differentiate it automatically and so certify every hand-written derivative.

use continuation::linalg::kernel::Arithmetic;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// What a pointwise density needs of its numbers.
pub trait Scalar:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// A constant.
    fn constant(value: f64) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Reciprocal.
    fn recip(self) -> Self;
    /// Exponential.
    fn exp(self) -> Self;
}

impl Scalar for f64 {
    #[inline(always)]
    fn constant(value: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn recip(self) -> f64 {
        1.0 / self
    }
    #[inline(always)]
    fn exp(self) -> f64 {
        f64::exp(self)
    }
}

/// Four numbers that are computed with in lockstep.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(32))]
pub struct Lanes(pub [f64; WIDTH]);

/// How many numbers [`Lanes`] holds.
pub const WIDTH: usize = 4;

impl Lanes {
    /// All zero.
    pub const ZERO: Lanes = Lanes([0.0; WIDTH]);

    /// The sum of the four numbers.
    #[inline(always)]
    pub fn sum(self) -> f64 {
        let [a, b, c, d] = self.0;
        (a + c) + (b + d)
    }

    /// The sums of the four numbers of each.
    #[inline(always)]
    pub fn sums([a, b, c, d]: [Lanes; 4]) -> Lanes {
        // halves are added crosswise first: the same order as in [`Lanes::sum`]
        let (a, b, c, d) = (a.0, b.0, c.0, d.0);
        let left = [a[0] + a[2], b[0] + b[2], c[0] + c[2], d[0] + d[2]];
        let right = [a[1] + a[3], b[1] + b[3], c[1] + c[3], d[1] + d[3]];
        Lanes(left) + Lanes(right)
    }

    /// `self · b + c`.
    #[inline(always)]
    pub(crate) fn mul_add<A: Arithmetic>(self, b: Lanes, c: Lanes) -> Lanes {
        let mut out = self.0;
        for l in 0..WIDTH {
            out[l] = A::mul_add(out[l], b.0[l], c.0[l]);
        }
        Lanes(out)
    }

    /// The smaller of each pair; undefined for NaN.
    #[inline(always)]
    pub fn min(self, other: Lanes) -> Lanes {
        let mut out = self.0;
        for l in 0..WIDTH {
            out[l] = if out[l] < other.0[l] { out[l] } else { other.0[l] };
        }
        Lanes(out)
    }

    /// Whether all four numbers are positive.
    #[inline(always)]
    pub fn positive(self) -> bool {
        let [a, b, c, d] = self.0;
        (a > 0.0) & (b > 0.0) & (c > 0.0) & (d > 0.0)
    }
}

macro_rules! lanewise {
    ($trait:ident, $method:ident, $assign:tt) => {
        impl $trait for Lanes {
            type Output = Lanes;
            #[inline(always)]
            fn $method(self, other: Lanes) -> Lanes {
                let mut out = self.0;
                for l in 0..WIDTH {
                    out[l] $assign other.0[l];
                }
                Lanes(out)
            }
        }
        impl $trait<f64> for Lanes {
            type Output = Lanes;
            #[inline(always)]
            fn $method(self, other: f64) -> Lanes {
                let mut out = self.0;
                for l in 0..WIDTH {
                    out[l] $assign other;
                }
                Lanes(out)
            }
        }
    };
}
lanewise!(Add, add, +=);
lanewise!(Sub, sub, -=);
lanewise!(Mul, mul, *=);
lanewise!(Div, div, /=);

impl Neg for Lanes {
    type Output = Lanes;
    #[inline(always)]
    fn neg(self) -> Lanes {
        let mut out = self.0;
        for x in &mut out {
            *x = -*x;
        }
        Lanes(out)
    }
}

impl Scalar for Lanes {
    #[inline(always)]
    fn constant(value: f64) -> Lanes {
        Lanes([value; WIDTH])
    }
    #[inline(always)]
    fn sqrt(self) -> Lanes {
        let mut out = self.0;
        for x in &mut out {
            *x = x.sqrt();
        }
        Lanes(out)
    }
    #[inline(always)]
    fn recip(self) -> Lanes {
        let mut out = self.0;
        for x in &mut out {
            *x = 1.0 / *x;
        }
        Lanes(out)
    }
    #[inline(always)]
    fn exp(self) -> Lanes {
        let mut out = self.0;
        for x in &mut out {
            *x = x.exp();
        }
        Lanes(out)
    }
}
