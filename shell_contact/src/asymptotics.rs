//! Formulas for limits of the model: what a computed curve must approach.
//!
//! Dimensionless as everywhere: lengths in `R0`, the force in `√(χk_b)`, one pole's deformation.

use crate::params::Shell;
use crate::quadrature::gauss_legendre;
use std::f64::consts::PI;

/// Initial slope `F̂/d̂` under two opposite point loads: linear, unstressed, at ambient pressure
/// `pressure` with gas exponent `gas_exponent`, no film and no surface tension.
///
/// With `A = 1/(1−ν²)`, `N = n(n+1)`, `B = N(N−1+ν)`, `c = 4π/(2n+1)` and
/// `D = A²[2(1+ν)B − (1+ν)²N²] + k_bAB[2(1+ν) + B − 2(1+ν)N]`
/// ```text
/// d̂/F̂ = √k_b { 2/(4π[2(1+ν)A + 3γP_A]) + Σ_{n = 2, 4, …} 2B(A + k_b)/(cD) }
/// ```
/// The gas resists `n = 0` only. Eq. (32), Reissner's slope 8, is the limit `k_b → 0` for any `ν`.
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

/// Deformation at which the flat cap under a plate gives way to a dimple, as `k_b → 0` with a thin
/// film of weak adhesion: a pitchfork of the ring solution.
pub fn knee_deformation(bending: f64) -> f64 {
    7.48 * bending.sqrt()
}

/// Force of a plate on a dimple whose rim follows it, as `k_b → 0` and then `d̂ → ∞`.
///
/// About 2.3 times Pogorelov's law for a point load, Eq. (33).
pub fn plate_pogorelov_force(bending: f64, deformation: f64) -> f64 {
    29.63 * bending.powf(0.25) * deformation.sqrt()
}

/// Buckling pressure of a sphere to leading order (Zoelly), in `χ/R0`.
pub fn buckling_pressure(bending: f64) -> f64 {
    4.0 * bending.sqrt()
}

/// Jump of the meridional curvature at the edge of the contact area as the film length vanishes
/// (Seifert and Lipowsky, Phys. Rev. A 42, 4768, 1990): the curvature just outside a flat contact.
pub fn contact_curvature(adhesion: f64, bending: f64) -> f64 {
    (2.0 * adhesion / bending).sqrt()
}

/// A drop of constant tension and of the volume of the unit sphere between two plates it does not
/// wet (contact angle `π`), mirror symmetric.
///
/// The meridian is `sin ψ = R_e(σ² − a²)/[σ(R_e² − a²)]` from the edge of the contact `σ = a` to
/// the equator `σ = R_e`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drop {
    /// Radius `a` of the contact area.
    pub contact_radius: f64,
    /// Radius `R_e` of the equator.
    pub equator_radius: f64,
}

impl Drop {
    /// The drop with its plates at `±z0`, `0 < z0 < 1`.
    pub fn between_plates(z0: f64) -> Drop {
        let (mut low, mut high) = (0.0, 1.0 - 1e-9);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if Drop::of_ratio(middle).1 > z0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        Drop::of_ratio(0.5 * (low + high)).0
    }

    /// The drop with `a/R_e = ratio`, and its half height.
    fn of_ratio(ratio: f64) -> (Drop, f64) {
        let panels = 48_u32;
        let rule = gauss_legendre(8);
        let (mut height, mut volume) = (0.0, 0.0);
        for panel in 0..panels {
            for &(x, weight) in &rule {
                // σ = 1 − (1 − a)t² takes the root at the equator out of the integrand
                let t = (f64::from(panel) + x) / f64::from(panels);
                let gap = 1.0 - ratio;
                let sigma = 1.0 - gap * t * t;
                let scale = sigma * (1.0 - ratio * ratio);
                let sin = (sigma * sigma - ratio * ratio) / scale;
                let cos_per_t = (gap * (sigma + ratio * ratio) / scale * (1.0 + sin)).sqrt();
                let dz = 2.0 * gap * sin / cos_per_t * weight / f64::from(panels);
                height += dz;
                volume += PI * sigma * sigma * dz;
            }
        }
        let equator_radius = (2.0 * PI / 3.0 / volume).cbrt();
        let drop = Drop { contact_radius: ratio * equator_radius, equator_radius };
        (drop, height * equator_radius)
    }

    /// Pressure in the drop above that outside, per unit tension: `2R_e/(R_e² − a²)`.
    pub fn pressure(&self) -> f64 {
        let (a, r) = (self.contact_radius, self.equator_radius);
        2.0 * r / (r * r - a * a)
    }

    /// Force on a plate per unit tension, `F/(γR0) = πa²Δp`.
    pub fn force(&self) -> f64 {
        PI * self.contact_radius * self.contact_radius * self.pressure()
    }
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
            let gaps = [1e-6, 1e-8].map(|bending| 8.0 - slope(poisson, bending));
            assert!(gaps[0] > 0.0 && gaps[1] < 0.4 * gaps[0] && gaps[1] < 0.02, "{gaps:?}");
        }
    }

    #[test]
    fn drop_gives_the_known_forces() {
        let known =
            [(0.95, 0.12009), (0.9, 0.29691), (0.8, 0.81770), (0.7, 1.64732), (0.5, 5.31762)];
        for (z0, force) in known {
            let drop = Drop::between_plates(z0);
            assert!((drop.force() - force).abs() < 6e-6, "{z0}: {}", drop.force());
        }
    }
}
