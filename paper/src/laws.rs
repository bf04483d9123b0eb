//! The laws of the regimes, for the case of a branch.

use super::manifest::Law;
use shell_contact::ContactProblem;
use shell_contact::asymptotics::{
    CUBIC_SHARE, REISSNER_SLOPE, cubic_force, plate_pogorelov_force, printed_pogorelov_force,
};

/// The reduced force of a law at a deformation of one pole; NaN below zero.
pub(super) fn force(law: Law, problem: &ContactProblem, deformation: f64) -> f64 {
    if deformation.is_nan() || deformation < 0.0 {
        return f64::NAN;
    }
    let (g, nu) = (problem.groups(), problem.shell().poisson);
    let cubic = || cubic_force(nu, g.bending, g.pressure, g.gas_exponent, deformation);
    match law {
        Law::Reissner => REISSNER_SLOPE * deformation,
        Law::PrintedPogorelov => printed_pogorelov_force(nu, g.bending, deformation),
        Law::PlatePogorelov => plate_pogorelov_force(g.bending, deformation),
        Law::Cubic => cubic(),
        Law::LinearAndCubicShare => REISSNER_SLOPE * deformation + CUBIC_SHARE * cubic(),
    }
}
