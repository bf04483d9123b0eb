//! Membrane energies per undeformed area, Eq. (6), in units of `χ`.
//!
//! A law is a function of the squared principal stretches `q = λ_s²` and `m = λ_φ²`, in which all
//! three laws are rational: no root is taken and nothing is singular. All energies vanish at rest,
//! and are written in the strains `q − 1` and `m − 1` so that small ones keep their digits.

mod hooke;
mod mooney_rivlin;
mod skalak;

pub use hooke::Hooke;
pub use mooney_rivlin::MooneyRivlin;
pub use skalak::Skalak;

use crate::params::{Law, Shell};
use crate::scalar::Scalar;

/// Value and derivatives of a membrane energy in `(q, m)`.
#[derive(Debug, Clone, Copy)]
pub struct MembraneJet<T> {
    /// Energy.
    pub w: T,
    /// `∂w/∂q`.
    pub w_q: T,
    /// `∂w/∂m`.
    pub w_m: T,
    /// `∂²w/∂q²`.
    pub w_qq: T,
    /// `∂²w/∂q∂m`.
    pub w_qm: T,
    /// `∂²w/∂m²`.
    pub w_mm: T,
}

/// A constant of the material that a law may depend on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Constant {
    /// Poisson's ratio `ν`.
    Poisson,
    /// The share `b` of Mooney and Rivlin's law.
    MooneyB,
}

/// A membrane law.
pub trait Membrane: Copy {
    /// The energy alone.
    fn energy<T: Scalar>(&self, q: T, m: T) -> T;
    /// The energy and its first and second derivatives.
    fn jet<T: Scalar>(&self, q: T, m: T) -> MembraneJet<T>;
    /// `(∂w/∂q − ∂w/∂m)/(q − m)`, regular at `q = m`: the second derivative in a small shear
    /// `C_12` is twice this.
    fn shear<T: Scalar>(&self, q: T, m: T) -> T;
    /// Derivatives of `(∂w/∂q, ∂w/∂m)` by a constant; zero where the law does not have it.
    fn slopes_by<T: Scalar>(&self, constant: Constant, q: T, m: T) -> (T, T);
}

/// Runs `$body` with `$law` bound to the law of a [`Shell`] as its own type.
macro_rules! with_law {
    ($shell:expr, |$law:ident| $body:expr) => {
        match $shell.law {
            Law::Hooke => {
                let $law = Hooke { poisson: $shell.poisson };
                $body
            }
            Law::MooneyRivlin { b } => {
                let $law = MooneyRivlin { b };
                $body
            }
            Law::Skalak => {
                let $law = Skalak { poisson: $shell.poisson };
                $body
            }
        }
    };
}

/// The law that a shell has, chosen at every evaluation: loops over it are compiled once, as those over a
/// [`Film`](crate::film::Film) are.
impl Membrane for Shell {
    #[inline(always)]
    fn energy<T: Scalar>(&self, q: T, m: T) -> T {
        with_law!(self, |law| law.energy(q, m))
    }

    #[inline(always)]
    fn jet<T: Scalar>(&self, q: T, m: T) -> MembraneJet<T> {
        with_law!(self, |law| law.jet(q, m))
    }

    #[inline(always)]
    fn shear<T: Scalar>(&self, q: T, m: T) -> T {
        with_law!(self, |law| law.shear(q, m))
    }

    #[inline(always)]
    fn slopes_by<T: Scalar>(&self, constant: Constant, q: T, m: T) -> (T, T) {
        with_law!(self, |law| law.slopes_by(constant, q, m))
    }
}

/// Tensions `(τ_ss, τ_φφ)` per deformed length, Eq. (8), from the stretches
/// (`(1/λ_φ) ∂w/∂λ_s` and `(1/λ_s) ∂w/∂λ_φ`; Hooke's law of Eq. (8a) as printed lacks a factor).
pub fn tensions<L: Membrane>(law: &L, stretch_s: f64, stretch_phi: f64) -> (f64, f64) {
    let jet = law.jet(stretch_s * stretch_s, stretch_phi * stretch_phi);
    let tau_s = 2.0 * stretch_s * jet.w_q / stretch_phi;
    let tau_phi = 2.0 * stretch_phi * jet.w_m / stretch_s;
    (tau_s, tau_phi)
}

/// The laws of Eq. (6) once more, of `[q, m, constant]`, for certificates.
#[cfg(test)]
pub(crate) mod check {
    use crate::params::Law;
    use num_dual::HyperDual64 as H;

    /// The law's energy, with its constants as dual numbers.
    pub(crate) fn energy(law: Law, [q, m]: [H; 2], poisson: H, b: H) -> H {
        match law {
            Law::Hooke => hooke([q, m, poisson]),
            Law::MooneyRivlin { .. } => mooney_rivlin([q, m, b]),
            Law::Skalak => skalak([q, m, poisson]),
        }
    }

    pub(crate) fn hooke([q, m, nu]: [H; 3]) -> H {
        let (x, y) = (q - 1.0, m - 1.0);
        (x * x + nu * x * y * 2.0 + y * y) / ((-(nu * nu) + 1.0) * 8.0)
    }

    pub(crate) fn mooney_rivlin([q, m, b]: [H; 3]) -> H {
        let (x, y) = (q - 1.0, m - 1.0);
        // q + m + 1/(qm) - 3 and 1/q + 1/m + qm - 3, whose digits would cancel
        let first = (x * x + x * y + y * y + x * y * (x + y)) / (q * m);
        let second = x * x / q + y * y / m + x * y;
        ((-b + 1.0) * first + b * second) * (1.0 / 6.0)
    }

    pub(crate) fn skalak([q, m, nu]: [H; 3]) -> H {
        let (x, y, i2) = (q - 1.0, m - 1.0, q * m - 1.0);
        (x * x + y * y + nu / (-nu + 1.0) * i2 * i2) / ((nu + 1.0) * 8.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::{close, partials, real};
    use num_dual::HyperDual64;

    fn certify<L: Membrane>(law: L) {
        for q in [0.3, 0.81, 1.0, 1.07, 2.5] {
            for m in [0.4, 0.95, 1.0, 1.3] {
                let jet = law.jet(q, m);
                let d = partials([q, m], |x| law.energy(x[0], x[1]));
                close(jet.w, d.value, 1e-12, 1e-15);
                close(jet.w_q, d.gradient[0], 1e-12, 1e-15);
                close(jet.w_m, d.gradient[1], 1e-12, 1e-15);
                close(jet.w_qq, d.hessian[0][0], 1e-12, 1e-15);
                close(jet.w_qm, d.hessian[0][1], 1e-12, 1e-15);
                close(jet.w_mm, d.hessian[1][1], 1e-12, 1e-15);
                close(law.shear(q, m) * (q - m), jet.w_q - jet.w_m, 1e-12, 1e-15);
                // at equal stretches the difference quotient is a derivative
                let even = law.jet(q, q);
                close(law.shear(q, q), even.w_qq - even.w_qm, 1e-12, 1e-15);
            }
        }
    }

    #[test]
    fn derivatives_agree_with_dual_numbers() {
        certify(Hooke { poisson: 0.5 });
        certify(Hooke { poisson: -0.2 });
        certify(MooneyRivlin { b: 1.0 });
        certify(MooneyRivlin { b: 0.0 });
        certify(MooneyRivlin { b: 0.3 });
        certify(Skalak { poisson: 0.0 });
        certify(Skalak { poisson: 0.6 });
        for law in [Law::Hooke, Law::MooneyRivlin { b: 0.3 }, Law::Skalak] {
            certify(Shell { law, poisson: 0.4 });
        }
    }

    /// The laws once more from their equations, with constants that are dual numbers too.
    #[test]
    fn slopes_by_constants_agree_with_dual_numbers() {
        fn certify<L: Membrane>(
            law: L,
            (constant, value): (Constant, f64),
            energy: impl Fn([HyperDual64; 3]) -> HyperDual64,
        ) {
            for q in [0.3, 0.81, 1.0, 1.07, 2.5] {
                for m in [0.4, 0.95, 1.0, 1.3] {
                    let d = partials([q, m, value], &energy);
                    close(law.energy(q, m), d.value, 1e-12, 1e-15);
                    let (by_q, by_m) = law.slopes_by(constant, q, m);
                    close(by_q, d.hessian[0][2], 1e-12, 1e-15);
                    close(by_m, d.hessian[1][2], 1e-12, 1e-15);
                }
            }
        }
        for poisson in [-0.2, 0.0, 0.5, 0.8] {
            let at = (Constant::Poisson, poisson);
            certify(Hooke { poisson }, at, check::hooke);
            certify(Skalak { poisson }, at, check::skalak);
            // an incompressible law has no ratio of its own
            let law = MooneyRivlin { b: 0.3 };
            certify(law, at, |[q, m, _]| check::mooney_rivlin([q, m, real(0.3)]));
        }
        for b in [0.0, 0.3, 1.0] {
            certify(MooneyRivlin { b }, (Constant::MooneyB, b), check::mooney_rivlin);
            let law = Hooke { poisson: 0.4 };
            certify(law, (Constant::MooneyB, b), |[q, m, _]| check::hooke([q, m, real(0.4)]));
            let law = Skalak { poisson: 0.4 };
            certify(law, (Constant::MooneyB, b), |[q, m, _]| check::skalak([q, m, real(0.4)]));
        }
    }

    /// Young modulus one: at small strain all laws are Hooke's with their Poisson ratio.
    #[test]
    fn all_laws_linearise_to_hookes() {
        let same = |a: MembraneJet<f64>, b: MembraneJet<f64>| {
            close(a.w_qq, b.w_qq, 1e-14, 0.0);
            close(a.w_qm, b.w_qm, 1e-14, 1e-16);
            close(a.w_mm, b.w_mm, 1e-14, 0.0);
            assert!(a.w == 0.0 && a.w_q.abs() < 1e-16 && a.w_m.abs() < 1e-16);
        };
        for b in [0.0, 0.4, 1.0] {
            same(MooneyRivlin { b }.jet(1.0, 1.0), Hooke { poisson: 0.5 }.jet(1.0, 1.0));
        }
        for poisson in [0.0, 0.3, 0.8] {
            same(Skalak { poisson }.jet(1.0, 1.0), Hooke { poisson }.jet(1.0, 1.0));
        }
    }

    /// Eq. (8b) as printed, and Eq. (8a) with the factor it lacks.
    #[test]
    fn tensions_are_those_of_the_paper() {
        let (ls, lp) = (1.13_f64, 0.92_f64);
        let (b, j) = (0.7, ls * lp);
        let (s, p) = tensions(&MooneyRivlin { b }, ls, lp);
        let g = 1.0 / 3.0;
        close(s, g / j * (ls * ls - 1.0 / (j * j)) * (1.0 + b * (lp * lp - 1.0)), 1e-13, 0.0);
        close(p, g / j * (lp * lp - 1.0 / (j * j)) * (1.0 + b * (ls * ls - 1.0)), 1e-13, 0.0);
        let nu = 0.3;
        let (s, p) = tensions(&Hooke { poisson: nu }, ls, lp);
        let g = 0.5 / (1.0 + nu) / (1.0 - nu);
        close(s, g * ls / lp * (ls * ls - 1.0 + nu * (lp * lp - 1.0)), 1e-13, 0.0);
        close(p, g * lp / ls * (lp * lp - 1.0 + nu * (ls * ls - 1.0)), 1e-13, 0.0);
    }
}
