//! Exact derivatives along one parameter by forward differentiation.
//!
//! Where everything moves with a parameter (the mesh of [`crate::ring_load`] with the contact
//! angle: Gauss points, weights, spline functions) the pointwise densities run on numbers that
//! carry their derivative with them.

use crate::scalar::Scalar;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number and its derivative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forward<T> {
    /// The number.
    pub value: T,
    /// Its derivative.
    pub slope: T,
}

impl<T: Scalar> Forward<T> {
    /// A number with its derivative.
    pub fn new(value: T, slope: T) -> Self {
        Forward { value, slope }
    }
}

impl<T: Scalar> Add for Forward<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Forward { value: self.value + o.value, slope: self.slope + o.slope }
    }
}

impl<T: Scalar> Sub for Forward<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Forward { value: self.value - o.value, slope: self.slope - o.slope }
    }
}

impl<T: Scalar> Mul for Forward<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        let slope = self.slope * o.value + self.value * o.slope;
        Forward { value: self.value * o.value, slope }
    }
}

impl<T: Scalar> Div for Forward<T> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        let value = self.value / o.value;
        Forward { value, slope: (self.slope - value * o.slope) / o.value }
    }
}

impl<T: Scalar> Neg for Forward<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Forward { value: -self.value, slope: -self.slope }
    }
}

impl<T: Scalar> Add<f64> for Forward<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, c: f64) -> Self {
        Forward { value: self.value + c, slope: self.slope }
    }
}

impl<T: Scalar> Sub<f64> for Forward<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, c: f64) -> Self {
        Forward { value: self.value - c, slope: self.slope }
    }
}

impl<T: Scalar> Mul<f64> for Forward<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, c: f64) -> Self {
        Forward { value: self.value * c, slope: self.slope * c }
    }
}

impl<T: Scalar> Scalar for Forward<T> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Forward { value: T::constant(value), slope: T::constant(0.0) }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        Forward { value, slope: self.slope / value * 0.5 }
    }
    #[inline(always)]
    fn recip(self) -> Self {
        let value = self.value.recip();
        Forward { value, slope: -(self.slope * value * value) }
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let value = self.value.exp();
        Forward { value, slope: self.slope * value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::close;

    /// `f(x) = (x² + 2)/√(3 − x) − 1/x`, whose derivative is known.
    #[test]
    fn derivative_of_a_formula() {
        let f = |x: Forward<f64>| (x * x + 2.0) / (-x + 3.0).sqrt() - x.recip() * 1.0 - 0.5;
        let x: f64 = 1.3;
        let y = f(Forward::new(x, 1.0));
        let root = (3.0 - x).sqrt();
        close(y.value, (x * x + 2.0) / root - 1.0 / x - 0.5, 1e-15, 0.0);
        let slope = 2.0 * x / root + (x * x + 2.0) / (2.0 * root.powi(3)) + 1.0 / (x * x);
        close(y.slope, slope, 1e-15, 0.0);
    }
}
