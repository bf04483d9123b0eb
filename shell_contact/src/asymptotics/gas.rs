//! The cap flat on a sphere whose gas resists: the cubic law of Eq. (39).

use std::f64::consts::PI;

/// Eq. (39) in full, as `F̂`: `F = 4πχΔ³/R0² / (2(1−ν) + 4/(3γP_A))`.
///
/// The plates cut caps of angle `θ² = 2d` off the sphere; the volume that is lost raises the
/// pressure, the pressure stretches the sphere, and acts on the cut. `γP_A → ∞` is the
/// incompressible capsule, [`incompressible_force`]; `γP_A → 0` is [`compressible_force`].
///
/// Domain: an estimate and not a limit of the model. It takes the contact radius of a cut sphere,
/// `a² = 2d`; a shell that bends and stretches touches the plate to `a² ≈ 1.3d … 1.8d` only, so that
/// the force beyond the linear one is [`CUBIC_SHARE`] of this. The power is that of computed curves
/// where gas keeps the cap flat (`γP_A ≳ 0.3`) and this exceeds the linear force, `d̂ ≳ 0.2`.
pub fn cubic_force(
    poisson: f64,
    bending: f64,
    pressure: f64,
    gas_exponent: f64,
    deformation: f64,
) -> f64 {
    let stiffness = gas_exponent * pressure;
    let cube = 4.0 * PI * deformation.powi(3) / bending.sqrt();
    // 1/(2(1−ν) + 4/(3γP)), finite at P = 0
    cube * 3.0 * stiffness / (6.0 * (1.0 - poisson) * stiffness + 4.0)
}

/// Share of [`cubic_force`] in computed forces beyond the linear one, `F − 8d̂ ≈ 0.37 × cubic` at
/// `d̂ = 0.3 … 0.4` (Mooney-Rivlin, `b = 1`; Hooke's law is stiffer there): from 0.2 to 0.5 for `k_b` from 3e-3 down to 3e-5 and `γP_A` from 3 to 100.
pub const CUBIC_SHARE: f64 = 0.37;

/// Limit `γP_A → ∞` of [`cubic_force`]: `F = 2πχΔ³/(R0²(1−ν))`, Eq. (40) at `ν = ½` (Lulevich).
pub fn incompressible_force(poisson: f64, bending: f64, deformation: f64) -> f64 {
    2.0 * PI * deformation.powi(3) / ((1.0 - poisson) * bending.sqrt())
}

/// Limit `γP_A → 0` of [`cubic_force`]: the gas alone, `F = 3πγP_AΔ³/R0`.
pub fn compressible_force(bending: f64, pressure: f64, gas_exponent: f64, deformation: f64) -> f64 {
    3.0 * PI * gas_exponent * pressure * deformation.powi(3) / bending.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubic_law_has_its_limits() {
        let (k, d) = (2.7e-3, 0.2);
        let stiff = cubic_force(0.3, k, 1e9, 1.07, d) / incompressible_force(0.3, k, d);
        let soft = cubic_force(0.3, k, 1e-9, 1.07, d) / compressible_force(k, 1e-9, 1.07, d);
        assert!((stiff - 1.0).abs() < 1e-8 && (soft - 1.0).abs() < 1e-8, "{stiff} {soft}");
        assert_eq!(cubic_force(0.5, k, 0.0, 1.07, d), 0.0);
    }
}
