//! Small deformation: the cap stays flat, the force is linear.

use crate::params::Shell;
use std::f64::consts::PI;

/// Reissner's slope `F̂/d̂`, Eq. (32): `F = 4Eh²Δ/(R0√(3(1−ν²))) = 8√(χk_b) Δ/R0` for any `ν`.
///
/// Domain: `k_b → 0` and `d̂ ≪ √k_b`. Finite `k_b` and the gas change it as [`point_load_slope`]
/// says; at finite `d̂` a plate finds the flat cap stiffer (`F/d̂` is 8 at first and 10.3 at the
/// knee), and a film that thins finds it softer.
pub const REISSNER_SLOPE: f64 = 8.0;

/// Initial slope `F̂/d̂` under two opposite point loads: linear, unstressed, at ambient pressure
/// `pressure` with gas exponent `gas_exponent`, no film and no surface tension.
///
/// With `A = 1/(1−ν²)`, `N = n(n+1)`, `B = N(N−1+ν)`, `c = 4π/(2n+1)` and
/// `D = A²[2(1+ν)B − (1+ν)²N²] + k_bAB[2(1+ν) + B − 2(1+ν)N]`
/// ```text
/// d̂/F̂ = √k_b { 2/(4π[2(1+ν)A + 3γP_A]) + Σ_{n = 2, 4, …} 2B(A + k_b)/(cD) }
/// ```
/// The gas resists `n = 0` only. [`REISSNER_SLOPE`] is the limit `k_b → 0`.
///
/// Domain: `d̂ ≪ √k_b`, any `k_b` of a shell.
pub fn point_load_slope(shell: &Shell, bending: f64, pressure: f64, gas_exponent: f64) -> f64 {
    let nu = shell.poisson;
    let a = 1.0 / (1.0 - nu * nu);
    let t = 1.0 + nu;
    let uniform = 2.0 / (4.0 * PI * (2.0 * t * a + 3.0 * gas_exponent * pressure));
    // terms fall as n⁻³ once n exceeds k_b^(-1/4)
    let sum: f64 = (1..=200_000_u32)
        .rev()
        .map(|half| {
            let n = 2.0 * f64::from(half);
            let m = n * (n + 1.0);
            let b = m * (m - 1.0 + nu);
            let d = a * a * (2.0 * t * b - t * t * m * m)
                + bending * a * b * (2.0 * t + b - 2.0 * t * m);
            2.0 * b * (a + bending) * (2.0 * n + 1.0) / (4.0 * PI * d)
        })
        .sum();
    1.0 / (bending.sqrt() * (uniform + sum))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Law;

    #[test]
    fn point_load_series_gives_the_known_slopes() {
        let slope = |poisson, bending| {
            point_load_slope(&Shell { law: Law::Hooke, poisson }, bending, 0.0, 1.07)
        };
        let solid =
            |poisson: f64, h: f64| slope(poisson, h * h / (12.0 * (1.0 - poisson * poisson)));
        assert!((solid(0.3, 0.01) - 7.88197).abs() < 5e-6);
        assert!((solid(0.5, 1.0 / 60.0) - 7.78392).abs() < 5e-6);
        assert!((solid(0.5, 0.1) - 7.21413).abs() < 5e-6);
        for poisson in [0.0, 0.3, 0.5] {
            let gaps = [1e-6, 1e-8].map(|bending| REISSNER_SLOPE - slope(poisson, bending));
            assert!(gaps[0] > 0.0 && gaps[1] < 0.4 * gaps[0] && gaps[1] < 0.02, "{gaps:?}");
        }
    }
}
