//! Spheres under pressure alone.

use crate::membrane::{Hooke, MooneyRivlin, Skalak, tensions};
use crate::params::{Law, Shell};

/// Buckling pressure of a sphere to leading order (Zoelly), in `χ/R0`; the shape of the critical
/// modes changes it by terms of order `√k_b`.
pub fn buckling_pressure(bending: f64) -> f64 {
    4.0 * bending.sqrt()
}

/// The membrane limit: excess pressure `2τ(λ)/λ` inside a sphere of `stretch` times its radius at
/// rest, in `χ/R0`.
///
/// Exact: bending strains vanish on a sphere of any radius, Eq. (9). For Hooke's law
/// `τ = (λ²−1)/(2(1−ν))`, to leading order `2(λ−1)/(1−ν)`.
pub fn inflation_pressure(shell: &Shell, stretch: f64) -> f64 {
    let tension = match shell.law {
        Law::Hooke => tensions(&Hooke { poisson: shell.poisson }, stretch, stretch),
        Law::MooneyRivlin { b } => tensions(&MooneyRivlin { b }, stretch, stretch),
        Law::Skalak => tensions(&Skalak { poisson: shell.poisson }, stretch, stretch),
    };
    2.0 * tension.0 / stretch
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hookes_sphere_and_the_linear_limit_of_all_laws() {
        let hooke = Shell { law: Law::Hooke, poisson: 0.3 };
        let exact = (1.44 - 1.0) / (1.2 * 0.7);
        assert!((inflation_pressure(&hooke, 1.2) - exact).abs() < 1e-14);
        for (law, poisson) in
            [(Law::Hooke, 0.3), (Law::Skalak, 0.3), (Law::MooneyRivlin { b: 0.4 }, 0.5)]
        {
            let errors = [1e-3, 1e-4].map(|e| {
                let linear = 2.0 * e / (1.0 - poisson);
                inflation_pressure(&Shell { law, poisson }, 1.0 + e) / linear - 1.0
            });
            assert!(errors[1].abs() < 1e-3 && (errors[0] / errors[1] - 10.0).abs() < 0.1);
        }
    }
}
