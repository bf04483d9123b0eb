//! The cap turned inside out: its onset, and the square-root laws far beyond it.
//!
//! With a thin film of weak adhesion and `k_b → 0` all curves are one: `F/(k_bχR0)` is a function of
//! `Δ/(R0√k_b)`, of which this module has the knee and the far end.

/// Deformation at which the flat cap under a plate gives way to a dimple: a pitchfork of the ring
/// solution. `2.26 h/R0` at `ν = 0.3`, `2.49 h/R0` at `ν = ½`.
///
/// Domain: `k_b → 0`, thin film, weak adhesion (`8W0/δ_A² ≲ 1`). A thicker film adds its own
/// thinning to the deformation; stronger adhesion postpones the dimple or suppresses it.
pub fn knee_deformation(bending: f64) -> f64 {
    7.48 * bending.sqrt()
}

/// Force `F̂` at the knee, `F = 77.0 k_b χR0`; the domain is that of [`knee_deformation`].
pub fn knee_force(bending: f64) -> f64 {
    77.0 * bending.sqrt()
}

/// Force `F̂` of a plate on a dimple whose rim follows it.
///
/// Domain: thin film, `k_b → 0` and then `d̂ ≫ √k_b`, reached slowly: the computed force is 0.93,
/// 0.95, 0.97 of this at 11, 21, 42 thicknesses (`ν = ½`); where the gas does not resist.
pub fn plate_pogorelov_force(bending: f64, deformation: f64) -> f64 {
    29.63 * bending.powf(0.25) * deformation.sqrt()
}

/// Pogorelov's force `F̂` of a point load on a dimple, `F² = 3.56 E²h⁵Δ/((1−ν²)^(3/2)R0²)`.
///
/// Domain: a point load; `k_b → 0`, `d̂ ≫ √k_b`. The force of a plate, which pushes on the rim, is
/// 2.4 times as large. In these units it does not depend on `ν`.
pub fn point_pogorelov_force(bending: f64, deformation: f64) -> f64 {
    (3.56 * 12.0_f64.powf(1.5)).sqrt() * bending.powf(0.25) * deformation.sqrt()
}

/// Eq. (33) as printed, with `(1−ν²)²` in place of `(1−ν²)^(3/2)` in [`point_pogorelov_force`].
pub fn printed_pogorelov_force(poisson: f64, bending: f64, deformation: f64) -> f64 {
    point_pogorelov_force(bending, deformation) * (1.0 - poisson * poisson).powf(-0.25)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eq. (33) in SI units: E = 2.1 GPa, h = 25 nm, R0 = 1.5 μm, Δ = 100 nm.
    #[test]
    fn printed_law_is_eq_33() {
        let (e, h, r, delta, nu) = (2.1e9_f64, 25e-9_f64, 1.5e-6_f64, 1e-7_f64, 0.5_f64);
        let rest = 1.0 - nu * nu;
        let force = (3.56 * e * e * h.powi(5) * delta / (rest * rest * r * r)).sqrt();
        let bending = (h / r).powi(2) / (12.0 * rest);
        let unit = e * h * r * bending.sqrt();
        let printed = printed_pogorelov_force(nu, bending, delta / r) * unit;
        assert!((printed / force - 1.0).abs() < 1e-12, "{printed} {force}");
    }

    /// The square-root law of the plate passes the knee within a tenth, on both axes.
    #[test]
    fn knee_lies_near_the_plate_law() {
        let ratio = knee_force(1e-6) / plate_pogorelov_force(1e-6, knee_deformation(1e-6));
        assert!((0.9..1.0).contains(&ratio), "{ratio}");
    }
}
