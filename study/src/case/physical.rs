//! Physical parameters of a contact case, and the dimensionless groups they make.

use super::Groups;
use super::path::PhysicalPath;
use crate::units::Quantity;
use shell_contact::film::Film;

/// The physical parameters of a contact case, as written and in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct PhysicalCase {
    /// Stress-free radius R0.
    pub radius: Quantity,
    /// What the shell resists with.
    pub stiffness: Stiffness,
    /// Ambient pressure P_A.
    pub pressure: Quantity,
    /// Adhesion energy w0.
    pub adhesion: Quantity,
    /// Length scale delta_A of the film.
    pub film: Quantity,
    /// The potential of the film.
    pub potential: Film,
    /// What adhesion and film follow from, as written; empty if they are given themselves.
    pub forces: Vec<(&'static str, Quantity)>,
    /// Surface tension gamma_BW.
    pub surface_tension: Quantity,
    /// Polytropic exponent of the gas.
    pub gas_exponent: f64,
    /// Stiffness of one lever on the whole bubble, where `device.stiffness` was given with its unit.
    pub lever: Option<Quantity>,
    /// The path, where it was given in the words or units of a laboratory.
    pub path: Option<PhysicalPath>,
}

/// What the shell resists with.
#[derive(Debug, Clone, PartialEq)]
pub enum Stiffness {
    /// A homogeneous shell: chi = E h, k_b = E h³ / (12 (1 − ν²)).
    Homogeneous {
        /// Young's modulus E.
        young: Quantity,
        /// Thickness h.
        thickness: Quantity,
    },
    /// Area modulus and bending modulus given by themselves.
    Moduli {
        /// Area modulus chi.
        chi: Quantity,
        /// Bending modulus k_b.
        bending: Quantity,
    },
}

impl PhysicalCase {
    /// The area modulus chi [N/m].
    pub fn chi(&self) -> f64 {
        match &self.stiffness {
            Stiffness::Homogeneous { young, thickness } => young.si * thickness.si,
            Stiffness::Moduli { chi, .. } => chi.si,
        }
    }

    /// `sqrt(chi k_b)`, the unit of dimensionless forces in N.
    pub fn force_scale(&self, groups: &Groups) -> f64 {
        let bending = groups.bending * self.chi() * self.radius.si * self.radius.si;
        (self.chi() * bending).sqrt()
    }

    /// The bending modulus k_b [N m].
    fn bending(&self, poisson: f64) -> f64 {
        match &self.stiffness {
            Stiffness::Homogeneous { young, thickness } => {
                young.si * thickness.si.powi(3) / (12.0 * (1.0 - poisson * poisson))
            }
            Stiffness::Moduli { bending, .. } => bending.si,
        }
    }
}

/// Lengths in R0, tensions in chi, pressures in chi / R0.
pub(super) fn dimensionless_of_physical(physical: &PhysicalCase, poisson: f64) -> Groups {
    let (radius, chi) = (physical.radius.si, physical.chi());
    Groups {
        bending: physical.bending(poisson) / (chi * radius * radius),
        pressure: physical.pressure.si * radius / chi,
        adhesion: physical.adhesion.si / chi,
        film: physical.film.si / radius,
        potential: physical.potential,
        surface_tension: physical.surface_tension.si / chi,
        gas_exponent: physical.gas_exponent,
    }
}
