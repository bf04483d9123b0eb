//! Physical parameters of a contact case, as they were written.

use super::Dimensionless;
use super::path::PhysicalPath;
use crate::units::Quantity;
use shell_contact::Physical;
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
    pub fn force_scale(&self, groups: &Dimensionless) -> f64 {
        let bending = groups.bending * self.chi() * self.radius.si * self.radius.si;
        (self.chi() * bending).sqrt()
    }

    /// The numbers alone, in SI units.
    pub fn numbers(&self) -> Physical {
        Physical {
            radius: self.radius.si,
            stiffness: match &self.stiffness {
                Stiffness::Homogeneous { young, thickness } => {
                    shell_contact::Stiffness::Solid { young: young.si, thickness: thickness.si }
                }
                Stiffness::Moduli { chi, bending } => {
                    shell_contact::Stiffness::Coating { chi: chi.si, bending: bending.si }
                }
            },
            pressure: self.pressure.si,
            adhesion: self.adhesion.si,
            film: self.film.si,
            surface_tension: self.surface_tension.si,
            gas_exponent: self.gas_exponent,
        }
    }
}
