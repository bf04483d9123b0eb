//! The capillary limit: tension alone, a given volume.

use crate::quadrature::gauss_legendre;
use std::f64::consts::PI;

/// A drop of constant tension and of the volume of the unit sphere between two plates it does not
/// wet (contact angle `π`), mirror symmetric.
///
/// Domain: surface tension much above `χ`, ambient pressure much above that, so that the volume
/// stays; film and adhesion vanishing. The meridian is `sin ψ = R_e(σ² − a²)/[σ(R_e² − a²)]` from the edge of the contact `σ = a` to
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
