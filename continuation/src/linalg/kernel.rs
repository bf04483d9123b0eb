//! Inner loops compiled for the vectors of the machine that runs them.

use pulp::{Arch, Simd, WithSimd};

/// How a product and a sum are rounded.
pub trait Arithmetic: Copy {
    /// `a b + c`.
    fn mul_add(a: f64, b: f64, c: f64) -> f64;
}

/// Rounded twice, as without a suitable instruction.
#[derive(Debug, Clone, Copy)]
pub struct Separate;

/// Rounded once.
#[derive(Debug, Clone, Copy)]
pub struct Fused;

impl Arithmetic for Separate {
    #[inline(always)]
    fn mul_add(a: f64, b: f64, c: f64) -> f64 {
        a * b + c
    }
}

impl Arithmetic for Fused {
    #[inline(always)]
    fn mul_add(a: f64, b: f64, c: f64) -> f64 {
        a.mul_add(b, c)
    }
}

/// One step of `L D Lᵀ` on a lower band by columns: subtracts what `column`, with its diagonal first, contributes to the
/// `K = W − 1` columns that follow. Its part of `L`, 1 in front.
#[inline(always)]
pub fn eliminate<A: Arithmetic, const K: usize, const W: usize>(
    column: &[f64; W],
    inverse_pivot: f64,
    next: &mut [[f64; W]; K],
) -> [f64; W] {
    let mut l = [1.0; W];
    for i in 1..W {
        l[i] = column[i] * inverse_pivot;
    }
    for k in 1..W {
        let t = column[k];
        for i in 0..W - k {
            next[k - 1][i] = A::mul_add(-t, l[k + i], next[k - 1][i]);
        }
    }
    l
}

/// A loop for [`run`].
pub trait Kernel {
    /// Its result.
    type Output;

    /// Runs it. This and what it calls is to be marked `#[inline(always)]`: a function of its own is compiled for
    /// the narrowest vectors alone.
    fn run<A: Arithmetic>(self) -> Self::Output;
}

/// Runs a loop with the widest vectors of this machine, and with fused products and sums where it has them:
/// results of two machines are the same to rounding.
#[inline(always)]
pub fn run<K: Kernel>(kernel: K) -> K::Output {
    Arch::new().dispatch(Vectorised(kernel))
}

struct Vectorised<K>(K);

impl<K: Kernel> WithSimd for Vectorised<K> {
    type Output = K::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> K::Output {
        let fuses = cfg!(any(target_arch = "x86_64", target_arch = "aarch64"));
        if fuses && !S::IS_SCALAR { self.0.run::<Fused>() } else { self.0.run::<Separate>() }
    }
}
