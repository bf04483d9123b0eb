//! The paper's weak form, Eqs. (25a) and (25b), as a check of a state that was found otherwise.
//!
//! Galerkin residuals of the normal and tangential force balances with cubic B-splines as test
//! functions, with the factor `m_ss` that the printed (25a) lacks in its first bending term.
//! They are the variation of the energy in the directions `B n` and `B t_s`, which lie outside the
//! space of `(u, w)` splines: on a discrete equilibrium they vanish at the order of the
//! discretisation, not to rounding. Test functions that do not touch pole or equator are used, so
//! the boundary terms vanish.

use crate::contact::ContactProblem;
use crate::energy;
use crate::film::Potential;
use crate::membrane::tensions;
use crate::quadrature::gauss_legendre;
use continuation::EvalError;

/// Residuals of one test function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Balance {
    /// Knot at which the test function is centred.
    pub knot: usize,
    /// Normal residual, Eq. (25a).
    pub normal: f64,
    /// Tangential residual, Eq. (25b).
    pub tangential: f64,
    /// Integral of the test function over the deformed surface, `∫Bσa dS`; residuals divided by
    /// it are pressures.
    pub weight: f64,
}

/// Both residuals for every test function centred at knots `2 … N−2`.
///
/// # Errors
/// When the state is not admissible.
pub fn balances(problem: &ContactProblem, u: &[f64], p: &[f64]) -> Result<Vec<Balance>, EvalError> {
    let (c, gas) = problem.coefficients(u, p)?;
    let mesh = &problem.mesh;
    energy::admissible(mesh, u, problem.potential.wall(&c))?;
    let excess = gas.excess(energy::volume(mesh, u)?);
    let knots = mesh.knots();
    let n = knots.elements();
    let mut out: Vec<Balance> =
        (0..=n).map(|knot| Balance { knot, normal: 0.0, tangential: 0.0, weight: 0.0 }).collect();
    for e in 0..n {
        let (start, length) = (knots.at(e), knots.at(e + 1) - knots.at(e));
        for (x, weight) in gauss_legendre(8) {
            let (angle, weight) = (start + length * x, weight * length);
            let (sin, cos) = angle.sin_cos();
            let basis = knots.basis(e, angle);
            let d = mesh.displacement_in(u, e, angle);
            let (s, s1, s2, s3) = (sin + d[0].0, cos + d[1].0, d[2].0 - sin, d[3].0 - cos);
            let (z, z1, z2, z3) = (cos + d[0].1, d[1].1 - sin, d[2].1 - cos, d[3].1 + sin);

            let q = s1 * s1 + z1 * z1;
            let a = q.sqrt();
            let a1 = (s1 * s2 + z1 * z2) / a;
            let turning = (z1 * s2 - s1 * z2) / q; // ψ' = λ_s k_s
            let turning1 = (z1 * s3 - s1 * z3) / q - 2.0 * turning * a1 / a;
            let (ks, kphi) = (turning / a, -z1 / (a * s));
            let ks1 = (turning1 - ks * a1) / a;
            let (stretch_s, stretch_phi) = (a, s / sin);
            let (bend_s, bend_phi) = (turning - 1.0, stretch_phi * kphi - 1.0);
            let ms = c.bending / stretch_phi * (bend_s + c.poisson * bend_phi);
            let mphi = c.bending / stretch_s * (bend_phi + c.poisson * bend_s);
            let material = c.material(problem.shell.law);
            let (tau_s, tau_phi) = tensions(&material, stretch_s, stretch_phi);
            let film = problem.potential.jet(c.plate - z, c.adhesion, c.film);
            // attraction positive, as Eq. (16) has it
            let disjoining = film.d1 * s1 / a;
            let pressure = ks * tau_s + kphi * tau_phi + (ks + kphi) * (c.surface_tension + film.w)
                - excess
                - disjoining;

            for k in 0..4 {
                let Some(balance) = (e + k).checked_sub(1).and_then(|j| out.get_mut(j)) else {
                    continue;
                };
                let (b, b1, b2) = (basis[0][k], basis[1][k], basis[2][k]);
                balance.weight += weight * b * s * a;
                balance.normal += weight
                    * (pressure * b * s * a - s * ms * (b2 * a - b1 * a1) / q - mphi * b1 * s1 / a);
                balance.tangential += weight
                    * (tau_s * b1 * s
                        + b * s1 * tau_phi
                        + s * ms * (ks1 * b + ks * b1)
                        + ks * mphi * b * s1);
            }
        }
    }
    out.truncate(n - 1);
    out.drain(..2);
    Ok(out)
}
