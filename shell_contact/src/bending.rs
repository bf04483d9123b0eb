//! Bending strains and energy, Eqs. (4) and (9).
//!
//! With the tangent angle `ψ` (`cos ψ = σ'/a`, `sin ψ = −z'/a`): `λ_s k_s = ψ'`,
//! `λ_φ k_φ = sin ψ/sin S`, bending strains `K = λ k − 1`. Only `σ', σ'', z', z''` and `1/sin S`
//! enter, never a quotient of two small numbers other than `z'/sin S`, which is regular at the pole.

use crate::scalar::Scalar;

/// Bending strains `(K_s, K_φ)` from `(σ', σ'')`, `(z', z'')` and `1/sin S`.
#[inline(always)]
pub fn strains<T: Scalar>(s1: T, s2: T, z1: T, z2: T, csc: T) -> (T, T) {
    let q = s1 * s1 + z1 * z1;
    let turning = (z1 * s2 - s1 * z2) / q;
    let hoop = -(z1 * csc) / q.sqrt();
    (turning - 1.0, hoop - 1.0)
}

/// Energy `½(K_s² + 2νK_sK_φ + K_φ²)` per undeformed area and unit `k_b`, Eq. (9).
#[inline(always)]
pub fn energy<T: Scalar>(ks: T, kphi: T, poisson: f64) -> T {
    (ks * ks + ks * kphi * (2.0 * poisson) + kphi * kphi) * 0.5
}

/// First and second derivatives of the bending strains in `(σ', z')`; those in `σ''` and `z''`
/// are `ψ_s1` and `ψ_z1` themselves, because `ψ' = ψ_s1 σ'' + ψ_z1 z''`.
#[derive(Debug, Clone, Copy)]
pub struct StrainJet<T> {
    /// `K_s`.
    pub ks: T,
    /// `K_φ`.
    pub kphi: T,
    /// `∂ψ/∂σ' = ∂K_s/∂σ''`.
    pub psi_s: T,
    /// `∂ψ/∂z' = ∂K_s/∂z''`.
    pub psi_z: T,
    /// `∂K_s/∂σ'`.
    pub ks_s: T,
    /// `∂K_s/∂z'`.
    pub ks_z: T,
    /// `∂K_φ/∂σ'`.
    pub kphi_s: T,
    /// `∂K_φ/∂z'`.
    pub kphi_z: T,
    /// `∂²ψ/∂z'² = −∂²ψ/∂σ'² = ∂²K_s/∂z'∂z''`.
    pub psi_zz: T,
    /// `∂²ψ/∂σ'∂z'`.
    pub psi_sz: T,
    /// `∂²K_s/∂σ'²`.
    pub ks_ss: T,
    /// `∂²K_s/∂σ'∂z'`.
    pub ks_sz: T,
    /// `∂²K_s/∂z'²`.
    pub ks_zz: T,
    /// `∂²K_φ/∂σ'²`.
    pub kphi_ss: T,
    /// `∂²K_φ/∂σ'∂z'`.
    pub kphi_sz: T,
    /// `∂²K_φ/∂z'²`.
    pub kphi_zz: T,
}

/// The strains and their derivatives; `iq = 1/a²` and `ia = 1/a` are shared with the caller.
#[inline(always)]
pub fn strain_jet<T: Scalar>(s1: T, s2: T, z1: T, z2: T, csc: T, iq: T, ia: T) -> StrainJet<T> {
    let psi_s = z1 * iq;
    let psi_z = -(s1 * iq);
    let turning = psi_s * s2 + psi_z * z2;
    let (sine, cosine) = (-(z1 * ia) * csc, s1 * ia * csc); // of ψ, over sin S
    let ks_s = -((z2 + s1 * turning * 2.0) * iq);
    let ks_z = (s2 - z1 * turning * 2.0) * iq;
    let psi_zz = -(psi_s * psi_z * 2.0);
    let psi_sz = psi_z * psi_z - psi_s * psi_s;
    let m2 = iq * -2.0;
    StrainJet {
        ks: turning - 1.0,
        kphi: sine - 1.0,
        psi_s,
        psi_z,
        ks_s,
        ks_z,
        kphi_s: cosine * psi_s,
        kphi_z: cosine * psi_z,
        psi_zz,
        psi_sz,
        ks_ss: (turning + s1 * ks_s * 2.0) * m2,
        ks_sz: (s1 * ks_z + z1 * ks_s) * m2,
        ks_zz: (turning + z1 * ks_z * 2.0) * m2,
        kphi_ss: -(sine * psi_s * psi_s) - cosine * psi_zz,
        kphi_sz: cosine * psi_sz - sine * psi_s * psi_z,
        kphi_zz: cosine * psi_zz - sine * psi_z * psi_z,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::{close, partials};

    #[test]
    fn strain_derivatives_agree_with_dual_numbers() {
        for (x, csc) in [
            ([0.9, -0.3, -0.4, -0.8], 2.0),
            ([1.02, 0.1, 0.03, 0.9], 40.0),
            ([-0.3, 2.0, -0.8, 1.4], 1.1),
        ] {
            let [s1, s2, z1, z2] = x;
            let q: f64 = s1 * s1 + z1 * z1;
            let j = strain_jet(s1, s2, z1, z2, csc, 1.0 / q, 1.0 / q.sqrt());
            let close = |a, b| close(a, b, 1e-12, 1e-13);
            let k = partials(x, |x| strains(x[0], x[1], x[2], x[3], crate::dual::real(csc)).0);
            close(j.ks, k.value);
            for (i, d) in [j.ks_s, j.psi_s, j.ks_z, j.psi_z].into_iter().enumerate() {
                close(d, k.gradient[i]);
            }
            close(j.ks_ss, k.hessian[0][0]);
            close(-j.psi_zz, k.hessian[0][1]);
            close(j.ks_sz, k.hessian[0][2]);
            close(j.psi_sz, k.hessian[0][3]);
            close(j.psi_sz, k.hessian[1][2]);
            close(j.ks_zz, k.hessian[2][2]);
            close(j.psi_zz, k.hessian[2][3]);
            let h = partials(x, |x| strains(x[0], x[1], x[2], x[3], crate::dual::real(csc)).1);
            close(j.kphi, h.value);
            close(j.kphi_s, h.gradient[0]);
            close(j.kphi_z, h.gradient[2]);
            close(j.kphi_ss, h.hessian[0][0]);
            close(j.kphi_sz, h.hessian[0][2]);
            close(j.kphi_zz, h.hessian[2][2]);
        }
    }

    #[test]
    fn energy_is_quadratic() {
        assert_eq!(energy(2.0, 3.0, 0.5), 0.5 * (4.0 + 6.0 + 9.0));
    }
}
