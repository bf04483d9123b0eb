//! The energy per `dS` at a point of the meridian, as a function of `(σ, σ', σ'', z, z', z'')`.
//!
//! ```text
//! e = [w_m(σ'² + z'², (σ/sin S)²) + w_b(K_s, K_φ)] sin S + [γ_BW + w_int(z_p − z)] σ a
//!     − (P_G − P_A) ½σ²(−z')
//! ```
//! with `a = √(σ'² + z'²)`; Eqs. (14), (15) of the half shell over `2π`. The last term is what the
//! gas contributes to gradient and band Hessian at given pressure. Of the 21 second derivatives
//! four vanish (`σσ''`, `σz''`, `σ''z`, `zz''`); the others are written out.

use crate::bending::{self, StrainJet, strain_jet};
use crate::film::Potential;
use crate::membrane::{Constant, Membrane};
use crate::meridian::Place;
use crate::params::{Law, Shell};
use crate::scalar::Scalar;

/// The numbers that enter the density.
#[derive(Debug, Clone, Copy)]
pub struct Coefficients {
    /// Bending stiffness `k_b`.
    pub bending: f64,
    /// Poisson ratio, of the bending energy and of a membrane law that has one.
    pub poisson: f64,
    /// The share `b` of Mooney and Rivlin's law; other laws do not read it.
    pub b: f64,
    /// Surface tension `γ_BW`.
    pub surface_tension: f64,
    /// Adhesion `W0`.
    pub adhesion: f64,
    /// Film length `δ_A`.
    pub film: f64,
    /// Height of the plate above the equator.
    pub plate: f64,
}

impl Coefficients {
    /// The material of a law with these constants.
    pub(crate) fn material(&self, law: Law) -> Shell {
        let law = match law {
            Law::MooneyRivlin { .. } => Law::MooneyRivlin { b: self.b },
            other => other,
        };
        Shell { law, poisson: self.poisson }
    }
}

/// Where on the reference sphere, and how much it counts.
#[derive(Debug, Clone, Copy)]
pub struct Site<T> {
    /// Weight in `dS`.
    pub weight: T,
    /// Weight in undeformed area, `weight · sin S`.
    pub area: T,
    /// `1/sin S`.
    pub csc: T,
}

/// Derivatives in `(σ, σ', σ'')` and `(z, z', z'')`.
#[derive(Debug, Clone, Copy)]
pub struct Gradient<T> {
    /// In `σ` and its derivatives.
    pub s: [T; 3],
    /// In `z` and its derivatives.
    pub z: [T; 3],
}

/// The second derivatives that do not vanish.
#[derive(Debug, Clone, Copy)]
#[allow(missing_docs)] // the names are the formulas: s_s1 is ∂²e/∂σ∂σ'
pub struct Hessian<T> {
    pub s_s: T,
    pub s_s1: T,
    pub s_z: T,
    pub s_z1: T,
    pub s1_s1: T,
    pub s1_s2: T,
    pub s1_z: T,
    pub s1_z1: T,
    pub s1_z2: T,
    pub s2_s2: T,
    pub s2_z1: T,
    pub s2_z2: T,
    pub z_z: T,
    pub z_z1: T,
    pub z1_z1: T,
    pub z1_z2: T,
    pub z2_z2: T,
}

impl<T: Scalar> Gradient<T> {
    /// All zero.
    pub fn zero() -> Gradient<T> {
        Gradient { s: [T::constant(0.0); 3], z: [T::constant(0.0); 3] }
    }
}

impl<T: Scalar> Hessian<T> {
    /// All zero.
    pub fn zero() -> Hessian<T> {
        let o = T::constant(0.0);
        Hessian {
            s_s: o,
            s_s1: o,
            s_z: o,
            s_z1: o,
            s1_s1: o,
            s1_s2: o,
            s1_z: o,
            s1_z1: o,
            s1_z2: o,
            s2_s2: o,
            s2_z1: o,
            s2_z2: o,
            z_z: o,
            z_z1: o,
            z1_z1: o,
            z1_z2: o,
            z2_z2: o,
        }
    }
}

/// The parts of the energy at a point, each per `dS` times the weight.
#[derive(Debug, Clone, Copy)]
pub struct Parts<T> {
    /// Membrane energy.
    pub stretching: T,
    /// Bending energy.
    pub bending: T,
    /// Interaction energy.
    pub film: T,
    /// Deformed area `σ a`.
    pub area: T,
    /// `½σ²(−z')`, whose integral is `V̂`.
    pub volume: T,
}

/// The parts of the energy.
#[inline(always)]
pub fn parts<T: Scalar, L: Membrane, F: Potential>(
    law: &L,
    film: &F,
    c: &Coefficients,
    at: &Site<T>,
    x: &Place<T>,
) -> Parts<T> {
    let ([s, s1, s2], [z, z1, z2]) = (x.s, x.z);
    let q = s1 * s1 + z1 * z1;
    let hoop = s * at.csc;
    let (ks, kphi) = bending::strains(s1, s2, z1, z2, at.csc);
    let area = s * q.sqrt() * at.weight;
    let delta = -(z - c.plate);
    let w = film.energy(delta, T::constant(c.adhesion), T::constant(c.film));
    Parts {
        stretching: law.energy(q, hoop * hoop) * at.area,
        bending: bending::energy(ks, kphi, c.poisson) * at.area * c.bending,
        film: w * area,
        area,
        volume: -(s * s * z1 * at.weight * 0.5),
    }
}

/// Quantities of a point that gradient and Hessian share.
struct Point<T> {
    iq: T,
    a: T,
    ia: T,
    hoop: T,
    strain: StrainJet<T>,
    moment_s: T,
    moment_phi: T,
}

#[inline(always)]
fn point<T: Scalar>(c: &Coefficients, at: &Site<T>, x: &Place<T>) -> Point<T> {
    let ([s, s1, s2], [_, z1, z2]) = (x.s, x.z);
    let q = s1 * s1 + z1 * z1;
    let iq = q.recip();
    let a = q.sqrt();
    let ia = a * iq;
    let strain = strain_jet(s1, s2, z1, z2, at.csc, iq, ia);
    let kb = at.area * c.bending;
    Point {
        iq,
        a,
        ia,
        hoop: s * at.csc,
        moment_s: kb * (strain.ks + strain.kphi * c.poisson),
        moment_phi: kb * (strain.kphi + strain.ks * c.poisson),
        strain,
    }
}

/// Gradient of the density without its gas term.
#[inline(always)]
pub fn gradient<T: Scalar, L: Membrane, F: Potential>(
    law: &L,
    film: &F,
    c: &Coefficients,
    at: &Site<T>,
    x: &Place<T>,
) -> Gradient<T> {
    let p = point(c, at, x);
    let ([s, s1, _], [z, z1, _]) = (x.s, x.z);
    let jet = law.jet(p.a * p.a, p.hoop * p.hoop);
    let f = film.jet(-(z - c.plate), c.adhesion, c.film);
    let g = (f.w + c.surface_tension) * at.weight;
    assemble_gradient(&p, at, s, s1, z1, jet.w_q, jet.w_m, g, -(f.d1 * at.weight))
}

#[inline(always)]
#[allow(clippy::too_many_arguments)] // private; the two callers hold all of these in registers
fn assemble_gradient<T: Scalar>(
    p: &Point<T>,
    at: &Site<T>,
    s: T,
    s1: T,
    z1: T,
    w_q: T,
    w_m: T,
    g: T,
    g_z: T,
) -> Gradient<T> {
    let k = &p.strain;
    // membrane and area both act along (σ', z')
    let pull = at.area * w_q * 2.0 + g * s * p.ia;
    Gradient {
        s: [
            at.weight * w_m * p.hoop * 2.0 + g * p.a,
            pull * s1 + p.moment_s * k.ks_s + p.moment_phi * k.kphi_s,
            p.moment_s * k.psi_s,
        ],
        z: [
            g_z * s * p.a,
            pull * z1 + p.moment_s * k.ks_z + p.moment_phi * k.kphi_z,
            p.moment_s * k.psi_z,
        ],
    }
}

/// Gradient without its gas term, and Hessian with it; `excess` is `P_G − P_A`.
#[inline(always)]
pub fn linearise<T: Scalar, L: Membrane, F: Potential>(
    law: &L,
    film: &F,
    c: &Coefficients,
    excess: f64,
    at: &Site<T>,
    x: &Place<T>,
) -> (Gradient<T>, Hessian<T>) {
    let p = point(c, at, x);
    let ([s, s1, _], [z, z1, _]) = (x.s, x.z);
    let jet = law.jet(p.a * p.a, p.hoop * p.hoop);
    let f = film.jet(-(z - c.plate), c.adhesion, c.film);
    let g = (f.w + c.surface_tension) * at.weight;
    let g_z = -(f.d1 * at.weight);
    let gradient = assemble_gradient(&p, at, s, s1, z1, jet.w_q, jet.w_m, g, g_z);

    let k = &p.strain;
    let (ms, mf) = (p.moment_s, p.moment_phi);
    let kb = at.area * c.bending;
    // derivatives of the two moments
    let ms_s = kb * (k.ks_s + k.kphi_s * c.poisson);
    let ms_z = kb * (k.ks_z + k.kphi_z * c.poisson);
    let mf_s = kb * (k.kphi_s + k.ks_s * c.poisson);
    let mf_z = kb * (k.kphi_z + k.ks_z * c.poisson);
    let (kb_s, kb_z) = (kb * k.psi_s, kb * k.psi_z);

    let pressure = at.weight * excess;
    let sa = s * p.a;
    let stretch = at.area * jet.w_qq * 4.0;
    let mixed = at.weight * jet.w_qm * p.hoop * 4.0 + g * p.ia;
    let gs_ia = g * s * p.ia;
    // second derivatives of a: (δ_ij − x_i x_j/q)/a
    let isotropic = at.area * jet.w_q * 2.0 + gs_ia;
    let along = stretch - gs_ia * p.iq;
    let film_pull = g_z * s * p.ia;
    let hoop = p.hoop * p.hoop;
    let hessian = Hessian {
        s_s: at.weight * at.csc * (jet.w_m + hoop * jet.w_mm * 2.0) * 2.0 + pressure * z1,
        s_s1: mixed * s1,
        s_z: g_z * p.a,
        s_z1: mixed * z1 + pressure * s,
        s1_s1: isotropic
            + along * s1 * s1
            + k.ks_s * ms_s
            + k.kphi_s * mf_s
            + ms * k.ks_ss
            + mf * k.kphi_ss,
        s1_s2: k.psi_s * ms_s - ms * k.psi_zz,
        s1_z: film_pull * s1,
        s1_z1: along * s1 * z1 + k.ks_z * ms_s + k.kphi_z * mf_s + ms * k.ks_sz + mf * k.kphi_sz,
        s1_z2: k.psi_z * ms_s + ms * k.psi_sz,
        s2_s2: k.psi_s * kb_s,
        s2_z1: k.psi_s * ms_z + ms * k.psi_sz,
        s2_z2: k.psi_z * kb_s,
        z_z: f.d2 * at.weight * sa,
        z_z1: film_pull * z1,
        z1_z1: isotropic
            + along * z1 * z1
            + k.ks_z * ms_z
            + k.kphi_z * mf_z
            + ms * k.ks_zz
            + mf * k.kphi_zz,
        z1_z2: k.psi_z * ms_z + ms * k.psi_zz,
        z2_z2: k.psi_z * kb_z,
    };
    (gradient, hessian)
}

/// Gradient of the bending energy per unit `k_b`.
#[inline(always)]
pub fn bending_gradient<T: Scalar>(poisson: f64, at: &Site<T>, x: &Place<T>) -> Gradient<T> {
    let c = Coefficients {
        bending: 1.0,
        poisson,
        b: 0.0,
        surface_tension: 0.0,
        adhesion: 0.0,
        film: 1.0,
        plate: 0.0,
    };
    let p = point(&c, at, x);
    let none = T::constant(0.0);
    assemble_gradient(&p, at, x.s[0], x.s[1], x.z[1], none, none, none, none)
}

/// Derivative of the gradient by a constant of the material: of the membrane, and of the bending
/// energy, where `∂/∂ν ½(K_s² + 2νK_sK_φ + K_φ²) = K_sK_φ`.
#[inline(always)]
pub fn material_gradient<T: Scalar, L: Membrane>(
    law: &L,
    constant: Constant,
    c: &Coefficients,
    at: &Site<T>,
    x: &Place<T>,
) -> Gradient<T> {
    let p = point(c, at, x);
    let none = T::constant(0.0);
    let kb = match constant {
        Constant::Poisson => at.area * c.bending,
        Constant::MooneyB => none,
    };
    let p = Point { moment_s: kb * p.strain.kphi, moment_phi: kb * p.strain.ks, ..p };
    let (w_q, w_m) = law.slopes_by(constant, p.a * p.a, p.hoop * p.hoop);
    assemble_gradient(&p, at, x.s[0], x.s[1], x.z[1], w_q, w_m, none, none)
}

/// Gradient of `g(z) σ a` from `g` and `dg/dz`.
#[inline(always)]
pub fn area_gradient<T: Scalar>(g: T, g_z: T, at: &Site<T>, x: &Place<T>) -> Gradient<T> {
    let ([s, s1, _], [_, z1, _]) = (x.s, x.z);
    let a = (s1 * s1 + z1 * z1).sqrt();
    let (g, g_z) = (g * at.weight, g_z * at.weight);
    let pull = g * s / a;
    let none = T::constant(0.0);
    Gradient { s: [g * a, pull * s1, none], z: [g_z * s * a, pull * z1, none] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::{close, partials, real};
    use crate::film::{Film, check};
    use crate::membrane::{Hooke, MooneyRivlin, Skalak};
    use num_dual::HyperDual64;

    fn certify<L: Membrane>(law: L, film: Film) {
        let c = Coefficients {
            bending: 2e-3,
            poisson: 0.4,
            b: 0.6,
            surface_tension: 0.07,
            adhesion: 3e-2,
            film: 0.04,
            plate: 1.01,
        };
        let excess = 0.37;
        for (angle, shift) in [(0.9_f64, 0.02), (0.01, 0.3), (1.5, -0.1), (3e-4, 0.01)] {
            let site = |w: f64| (w, w * angle.sin(), 1.0 / angle.sin());
            let (weight, area, csc) = site(0.013);
            let at = Site { weight, area, csc };
            let dual = Site { weight: real(weight), area: real(area), csc: real(csc) };
            let (sin, cos) = angle.sin_cos();
            let x = [
                sin * (1.0 + shift),
                cos + 0.3 * shift,
                -sin + 0.5 * shift * sin,
                cos - shift.abs() - 0.02,
                -sin - 0.4 * shift * sin,
                -cos + shift,
            ];
            let place = Place { s: [x[0], x[1], x[2]], z: [x[3], x[4], x[5]] };
            let total = |x: [HyperDual64; 6], gas: f64| {
                let place = Place { s: [x[0], x[1], x[2]], z: [x[3], x[4], x[5]] };
                let p = parts(&law, &film, &c, &dual, &place);
                p.stretching + p.bending + p.film + p.area * c.surface_tension - p.volume * gas
            };
            let plain = partials(x, |x| total(x, 0.0));
            let full = partials(x, |x| total(x, excess));
            let (g, h) = linearise(&law, &film, &c, excess, &at, &place);
            let again = gradient(&law, &film, &c, &at, &place);
            let size = plain.gradient.iter().fold(0.0_f64, |m, g| m.max(g.abs()));
            for k in 0..3 {
                close(g.s[k], plain.gradient[k], 1e-12, 1e-13 * size);
                close(g.z[k], plain.gradient[k + 3], 1e-12, 1e-13 * size);
                assert_eq!((g.s[k], g.z[k]), (again.s[k], again.z[k]));
            }
            let zero = 0.0;
            let rows = [
                [h.s_s, h.s_s1, zero, h.s_z, h.s_z1, zero],
                [h.s_s1, h.s1_s1, h.s1_s2, h.s1_z, h.s1_z1, h.s1_z2],
                [zero, h.s1_s2, h.s2_s2, zero, h.s2_z1, h.s2_z2],
                [h.s_z, h.s1_z, zero, h.z_z, h.z_z1, zero],
                [h.s_z1, h.s1_z1, h.s2_z1, h.z_z1, h.z1_z1, h.z1_z2],
                [zero, h.s1_z2, h.s2_z2, zero, h.z1_z2, h.z2_z2],
            ];
            let size = full.hessian.iter().flatten().fold(0.0_f64, |m, g| m.max(g.abs()));
            for i in 0..6 {
                for j in 0..6 {
                    close(rows[i][j], full.hessian[i][j], 1e-12, 1e-13 * size);
                }
            }

            // the pieces that parameter derivatives are made of
            let bend = partials(x, |x| {
                let place = Place { s: [x[0], x[1], x[2]], z: [x[3], x[4], x[5]] };
                parts(&law, &film, &Coefficients { bending: 1.0, ..c }, &dual, &place).bending
            });
            let b = bending_gradient(c.poisson, &at, &place);
            let of_film = partials(x, |x| {
                let place = Place { s: [x[0], x[1], x[2]], z: [x[3], x[4], x[5]] };
                parts(&law, &film, &c, &dual, &place).film
            });
            let jet = film.jet(c.plate - x[3], c.adhesion, c.film);
            let f = area_gradient(jet.w, -jet.d1, &at, &place);
            let largest = |g: &[f64; 6]| g.iter().fold(0.0_f64, |m, g| m.max(g.abs()));
            for k in 0..3 {
                close(b.s[k], bend.gradient[k], 1e-12, 1e-13 * largest(&bend.gradient));
                close(b.z[k], bend.gradient[k + 3], 1e-12, 1e-13 * largest(&bend.gradient));
                close(f.s[k], of_film.gradient[k], 1e-12, 1e-13 * largest(&of_film.gradient));
                close(f.z[k], of_film.gradient[k + 3], 1e-12, 1e-13 * largest(&of_film.gradient));
            }
        }
    }

    #[test]
    fn gradient_and_hessian_agree_with_dual_numbers() {
        for film in check::every() {
            certify(Hooke { poisson: 0.4 }, film);
            certify(MooneyRivlin { b: 0.6 }, film);
            certify(Skalak { poisson: 0.4 }, film);
        }
    }
}
