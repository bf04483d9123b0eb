//! Automatic differentiation for tests: value, gradient and Hessian by hyper-dual numbers.

use crate::scalar::Scalar;
use num_dual::{DualNum, HyperDual64};

impl Scalar for HyperDual64 {
    fn constant(value: f64) -> Self {
        HyperDual64::from(value)
    }
    fn sqrt(self) -> Self {
        DualNum::sqrt(&self)
    }
    fn recip(self) -> Self {
        DualNum::recip(&self)
    }
    fn exp(self) -> Self {
        DualNum::exp(&self)
    }
}

pub(crate) fn real(value: f64) -> HyperDual64 {
    HyperDual64::from(value)
}

pub(crate) struct Partials<const N: usize> {
    pub(crate) value: f64,
    pub(crate) gradient: [f64; N],
    pub(crate) hessian: [[f64; N]; N],
}

/// All first and second partial derivatives of `f` at `x`.
pub(crate) fn partials<const N: usize>(
    x: [f64; N],
    f: impl Fn([HyperDual64; N]) -> HyperDual64,
) -> Partials<N> {
    let mut out = Partials { value: 0.0, gradient: [0.0; N], hessian: [[0.0; N]; N] };
    for i in 0..N {
        for j in 0..N {
            let mut arg = x.map(HyperDual64::from);
            arg[i].eps1 = 1.0;
            arg[j].eps2 = 1.0;
            let y = f(arg);
            out.value = y.re;
            out.gradient[i] = y.eps1;
            out.hessian[i][j] = y.eps1eps2;
        }
    }
    out
}

/// Asserts `a = b` to a relative or an absolute tolerance.
#[track_caller]
pub(crate) fn close(a: f64, b: f64, relative: f64, absolute: f64) {
    let allowed = absolute + relative * a.abs().max(b.abs());
    assert!((a - b).abs() <= allowed, "{a:e} and {b:e} differ by {:e}", (a - b).abs());
}
