//! Physical parameters of shells, as they were written.

use super::Dimensionless;
use super::error::Complaint;
use super::keys::{self, Key};
use super::path::PhysicalPath;
use super::reader::Section;
use super::resolve::Resolver;
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

impl Stiffness {
    /// The area modulus chi [N/m].
    pub fn chi(&self) -> f64 {
        match self {
            Stiffness::Homogeneous { young, thickness } => young.si * thickness.si,
            Stiffness::Moduli { chi, .. } => chi.si,
        }
    }

    /// The numbers alone, in SI units.
    fn numbers(&self) -> shell_contact::Stiffness {
        match self {
            Stiffness::Homogeneous { young, thickness } => {
                shell_contact::Stiffness::Solid { young: young.si, thickness: thickness.si }
            }
            Stiffness::Moduli { chi, bending } => {
                shell_contact::Stiffness::Coating { chi: chi.si, bending: bending.si }
            }
        }
    }
}

/// The physical parameters of a shell whose films are no part of it: between plates of their own, or under a ring
/// load.
#[derive(Debug, Clone, PartialEq)]
pub struct PhysicalShell {
    /// Stress-free radius R0.
    pub radius: Quantity,
    /// What the shell resists with.
    pub stiffness: Stiffness,
    /// Ambient pressure P_A.
    pub pressure: Quantity,
    /// Surface tension gamma_BW; `None` under a ring load, which has none.
    pub surface_tension: Option<Quantity>,
    /// Polytropic exponent of the gas.
    pub gas_exponent: f64,
    /// The path, where its ends were given with units.
    pub path: Option<PhysicalPath>,
}

impl PhysicalShell {
    /// The numbers alone, in SI units, beside a film of this adhesion in N/m and length in m.
    pub fn numbers(&self, adhesion: f64, film: f64) -> Physical {
        Physical {
            radius: self.radius.si,
            stiffness: self.stiffness.numbers(),
            pressure: self.pressure.si,
            adhesion,
            film,
            surface_tension: self.surface_tension.as_ref().map_or(0.0, |tension| tension.si),
            gas_exponent: self.gas_exponent,
        }
    }

    /// `sqrt(chi k_b)`, the unit of dimensionless forces between plates, in N.
    pub fn force_scale(&self, poisson: f64) -> f64 {
        let (chi, bending) = self.numbers(0.0, 0.0).moduli(poisson);
        (chi * bending).sqrt()
    }

    /// Thickness of the homogeneous wall with these moduli, `sqrt(12 (1 − ν²) k_b/chi)`, in m.
    pub fn thickness(&self, poisson: f64) -> f64 {
        let (chi, bending) = self.numbers(0.0, 0.0).moduli(poisson);
        (12.0 * (1.0 - poisson * poisson) * bending / chi).sqrt()
    }
}

/// Keys of a shell in `[physical]` whose defaults, or whose presence, are the problem's.
pub(super) struct ShellKeys {
    pub(super) pressure: Key,
    pub(super) surface_tension: Option<Key>,
    pub(super) gas_exponent: Key,
}

impl ShellKeys {
    /// Those of a bubble between plates.
    pub(super) const OF_BUBBLES: ShellKeys = ShellKeys {
        pressure: keys::PHYSICAL_PRESSURE,
        surface_tension: Some(keys::PHYSICAL_SURFACE_TENSION),
        gas_exponent: keys::GAS_EXPONENT,
    };
}

impl Resolver<'_> {
    /// Whether a case has its parameters in `[physical]`; complains unless it has one of the two tables.
    pub(super) fn is_physical(
        &self,
        dimensionless: Section<'_>,
        physical: Section<'_>,
    ) -> Option<bool> {
        match (dimensionless.exists(), physical.exists()) {
            (true, false) => Some(false),
            (false, true) => Some(true),
            (true, true) => {
                let why = "the case has both [dimensionless] and [physical]; keep one of them";
                let place = dimensionless.origin.max(physical.origin);
                let name =
                    if place == physical.origin { "physical" } else { "dimensionless" }.to_string();
                self.reader.push(place, name, None, Complaint::Conflict(why.to_string()));
                None
            }
            (false, false) => {
                let hint = "give the parameters in a table [dimensionless] or [physical]";
                self.reader.missing(self.root, "dimensionless", hint);
                None
            }
        }
    }

    /// What `[physical]` says of the shell itself.
    pub(super) fn shell_quantities(
        &self,
        section: Section<'_>,
        own: &ShellKeys,
    ) -> Option<PhysicalShell> {
        let radius = self.required_quantity(section, &keys::RADIUS);
        let stiffness = self.stiffness(section);
        let pressure = self.required_quantity(section, &own.pressure);
        let surface_tension =
            own.surface_tension.as_ref().map(|key| self.required_quantity(section, key));
        let gas_exponent = self.or_default(section, &own.gas_exponent);
        let surface_tension = match surface_tension {
            Some(given) => Some(given?),
            None => None,
        };
        Some(PhysicalShell {
            radius: radius?,
            stiffness: stiffness?,
            pressure: pressure?,
            surface_tension,
            gas_exponent: gas_exponent?,
            path: None,
        })
    }

    /// The same with its dimensionless groups, where films are no part of the table.
    pub(super) fn physical_shell(
        &self,
        section: Section<'_>,
        own: &ShellKeys,
        poisson: f64,
    ) -> Option<(Dimensionless, PhysicalShell)> {
        let shell = self.shell_quantities(section, own)?;
        // the groups of a film, which are looked at too, are 1 with these
        let groups = shell.numbers(shell.stiffness.chi(), shell.radius.si).groups(poisson);
        self.admits_groups(section, &groups)?;
        Some((groups, shell))
    }
}

/// The film of one plate and its lever in physical units.
#[derive(Debug, Clone, PartialEq)]
pub struct PhysicalPlate {
    /// Adhesion energy w0.
    pub adhesion: Quantity,
    /// Length scale delta_A of the film.
    pub film: Quantity,
    /// What adhesion and film follow from, as written; empty if they are given themselves.
    pub forces: Vec<(&'static str, Quantity)>,
    /// Stiffness of the cantilever behind the plate, where it was given with its unit.
    pub lever: Option<Quantity>,
}

impl PhysicalCase {
    /// The area modulus chi [N/m].
    pub fn chi(&self) -> f64 {
        self.stiffness.chi()
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
            stiffness: self.stiffness.numbers(),
            pressure: self.pressure.si,
            adhesion: self.adhesion.si,
            film: self.film.si,
            surface_tension: self.surface_tension.si,
            gas_exponent: self.gas_exponent,
        }
    }
}
