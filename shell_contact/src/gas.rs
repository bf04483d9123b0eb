//! The enclosed gas, Eq. (20a): `P_G = P_0 (V_0/V)^γ` with `P_0 = P_A + 2γ_BW`.
//!
//! Volumes are `V̂`, the half volume over `2π` (1/3 for the sphere). The energy, Eq. (15c) with
//! `P_G − P_A` in place of `P_G − P_0`, is `P_A(V̂−V̂_0) + P_0V̂_0[(V̂_0/V̂)^(γ−1) − 1]/(γ−1)`.
//! It is second order in `V̂ − V̂_0`, and is evaluated in a form that neither cancels there nor
//! divides by `γ − 1`: `γ = 0` (constant pressure), `γ = 1` (isothermal) and everything between
//! need no cases.

/// `V̂` of the unstressed sphere.
pub const REST_VOLUME: f64 = 1.0 / 3.0;

/// The gas of one shell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gas {
    /// Ambient pressure `P_A`.
    pub ambient: f64,
    /// Surface tension `γ_BW`, which the gas balances at rest.
    pub surface_tension: f64,
    /// Gas exponent `γ ≥ 0`.
    pub exponent: f64,
}

impl Gas {
    /// `ln(V̂/V̂_0)`.
    fn log_ratio(volume: f64) -> f64 {
        ((volume - REST_VOLUME) / REST_VOLUME).ln_1p()
    }

    /// `P_G`.
    pub fn pressure(&self, volume: f64) -> f64 {
        self.ambient + self.excess(volume)
    }

    /// `P_G − P_A`.
    pub fn excess(&self, volume: f64) -> f64 {
        let y = -self.exponent * Self::log_ratio(volume);
        let relative = y.exp_m1();
        self.ambient * relative + 2.0 * self.surface_tension * (relative + 1.0)
    }

    /// `γP_G/V̂ = −∂P_G/∂V̂`, the factor of the rank-one term of the Hessian.
    pub fn stiffness(&self, volume: f64) -> f64 {
        self.exponent * self.pressure(volume) / volume
    }

    /// `∂(P_G − P_A)/∂P_A = (V_0/V)^γ − 1`.
    pub fn excess_by_ambient(&self, volume: f64) -> f64 {
        (-self.exponent * Self::log_ratio(volume)).exp_m1()
    }

    /// `∂(P_G − P_A)/∂γ_BW = 2(V_0/V)^γ`.
    pub fn excess_by_surface_tension(&self, volume: f64) -> f64 {
        2.0 * (-self.exponent * Self::log_ratio(volume)).exp()
    }

    /// `∂(P_G − P_A)/∂γ = −P_G ln(V/V_0)`.
    pub fn excess_by_exponent(&self, volume: f64) -> f64 {
        -Self::log_ratio(volume) * self.pressure(volume)
    }

    /// The gas energy; zero at `V̂_0`.
    pub fn energy(&self, volume: f64) -> f64 {
        let log = Self::log_ratio(volume);
        let y = (1.0 - self.exponent) * log;
        // x + φ = L [E(L) − E(y)] and φ = −L E(y), with E(t) = expm1(t)/t and x = expm1(L)
        let compression = log * (log * second(log) - y * second(y));
        let tension = -log * (1.0 + y * second(y));
        REST_VOLUME * (self.ambient * compression + 2.0 * self.surface_tension * tension)
    }
}

/// `(eᵗ − 1 − t)/t²`, to full precision everywhere.
fn second(t: f64) -> f64 {
    if t.abs() > 0.5 {
        return (t.exp_m1() - t) / (t * t);
    }
    // 1/2! + t/3! + t²/4! + …
    let mut sum = 1.0;
    for k in (3..=18).rev() {
        sum = 1.0 + sum * t / f64::from(k);
    }
    sum * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::{close, partials};

    const GAS: Gas = Gas { ambient: 3.0, surface_tension: 0.08, exponent: 1.07 };

    #[test]
    fn rest_state_balances_surface_tension() {
        close(GAS.pressure(REST_VOLUME), 3.16, 1e-15, 0.0);
        assert_eq!(GAS.energy(REST_VOLUME), 0.0);
    }

    /// Against Eq. (15c) as written, where it does not cancel.
    #[test]
    fn energy_is_that_of_the_equation_for_every_exponent() {
        for volume in [0.05, 0.2, 0.3, 0.5, 1.4] {
            for exponent in [0.0, 0.3, 1.0, 1.07, 1.4, 3.0] {
                let gas = Gas { exponent, ..GAS };
                let ratio: f64 = REST_VOLUME / volume;
                let work = if exponent == 1.0 {
                    ratio.ln()
                } else {
                    (ratio.powf(exponent - 1.0) - 1.0) / (exponent - 1.0)
                };
                let plain = 3.0 * (volume - REST_VOLUME) + 3.16 * REST_VOLUME * work;
                close(gas.energy(volume), plain, 1e-12, 1e-14);
                close(gas.pressure(volume), 3.16 * ratio.powf(exponent), 1e-13, 0.0);
            }
        }
    }

    #[test]
    fn nothing_happens_on_the_way_through_the_isothermal_exponent() {
        let at = |exponent: f64| Gas { exponent, ..GAS }.energy(0.27);
        let slope = (at(1.0 + 1e-3) - at(1.0 - 1e-3)) / 2e-3;
        for e in [1e-13, 1e-10, 1e-7] {
            close(at(1.0 + e) - at(1.0), slope * e, 1e-3, 1e-15);
        }
    }

    /// To second order the energy is `γP_0 (V̂−V̂_0)²/(2V̂_0) − (P_0−P_A)(V̂−V̂_0)`.
    #[test]
    fn small_volume_changes_keep_their_digits() {
        let gas = Gas { surface_tension: 0.0, ..GAS };
        let change = 1e-9 * REST_VOLUME;
        let exact = 0.5 * 1.07 * 3.0 * change * change / REST_VOLUME;
        // the volume itself is known to 1e-16 only
        close(gas.energy(REST_VOLUME + change), exact, 1e-6, 0.0);
        let constant = Gas { exponent: 0.0, ..gas };
        assert_eq!(constant.energy(0.2), 0.0);
    }

    /// Eq. (15c) as written, differentiated automatically.
    #[test]
    fn derivatives_agree_with_dual_numbers() {
        use num_dual::DualNum;
        for volume in [0.12, 0.29, 0.34, 0.6] {
            let rest = REST_VOLUME;
            let d = partials([volume, 3.0, 0.08, 1.07], |x| {
                let [v, ambient, tension, exponent] = x;
                let logarithm = (v.recip() * rest).ln();
                let power = exponent - 1.0;
                let work = ((logarithm * power).exp() - 1.0) * rest / power;
                ambient * (v - rest) + (ambient + tension * 2.0) * work
            });
            close(GAS.excess(volume), -d.gradient[0], 1e-12, 1e-14);
            close(GAS.stiffness(volume), d.hessian[0][0], 1e-12, 0.0);
            close(GAS.excess_by_ambient(volume), -d.hessian[0][1], 1e-12, 1e-14);
            close(GAS.excess_by_surface_tension(volume), -d.hessian[0][2], 1e-12, 0.0);
            close(GAS.excess_by_exponent(volume), -d.hessian[0][3], 1e-12, 1e-14);
        }
    }
}
