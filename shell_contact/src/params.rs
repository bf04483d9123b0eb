//! Parameters, physical and dimensionless, and what is allowed of them.
//!
//! Lengths are in the stress-free radius `R0`, membrane tensions in `χ` (for a solid shell `E h`,
//! the two-dimensional Young modulus), energies in `χR0²`, pressures in `χ/R0`, Eq. (21).

use serde::{Deserialize, Serialize};
use std::fmt;

/// What is wrong with a parameter, where, and what would be right.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// A number outside what the model allows.
    #[error("{key} = {value}: must be {allowed} ({remedy})")]
    OutOfRange {
        /// Name of the parameter, as in a case file.
        key: &'static str,
        /// The value given.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
        /// What to do about it.
        remedy: &'static str,
    },
    /// Knots that do not increase from 0 to `π/2`.
    #[error("knot {at} = {value}: knots must increase from 0 to π/2")]
    Knots {
        /// Index of the first offending knot.
        at: usize,
        /// Its value.
        value: f64,
    },
}

impl ParameterError {
    pub(crate) fn too_few_elements(elements: usize) -> ParameterError {
        ParameterError::OutOfRange {
            key: "elements",
            value: elements as f64,
            allowed: "at least 8",
            remedy: "400 resolve a thin shell's dimple",
        }
    }

    /// The same of a parameter that goes by another name: those of `from` become those of `to`.
    pub(crate) fn renamed<const N: usize>(
        self,
        from: [&str; N],
        to: [&'static str; N],
    ) -> ParameterError {
        let at = from.iter().position(|name| *name == self.key());
        match (self, at) {
            (ParameterError::OutOfRange { value, allowed, remedy, .. }, Some(k)) => {
                ParameterError::OutOfRange { key: to[k], value, allowed, remedy }
            }
            (other, _) => other,
        }
    }

    /// Name of the offending parameter, as in a case file.
    pub fn key(&self) -> &'static str {
        match self {
            ParameterError::OutOfRange { key, .. } => key,
            ParameterError::Knots { .. } => "knots",
        }
    }
}

/// Checks `value` against a predicate; NaN and infinity never pass.
fn require(
    key: &'static str,
    value: f64,
    good: bool,
    allowed: &'static str,
    remedy: &'static str,
) -> Result<(), ParameterError> {
    if value.is_finite() && good {
        Ok(())
    } else {
        Err(ParameterError::OutOfRange { key, value, allowed, remedy })
    }
}

fn positive(key: &'static str, value: f64, remedy: &'static str) -> Result<(), ParameterError> {
    require(key, value, value > 0.0, "positive", remedy)
}

fn not_negative(key: &'static str, value: f64, remedy: &'static str) -> Result<(), ParameterError> {
    require(key, value, value >= 0.0, "zero or positive", remedy)
}

/// The membrane law, Eq. (6).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "law", rename_all = "kebab-case")]
pub enum Law {
    /// Hooke's law, Eq. (6a).
    Hooke,
    /// Mooney-Rivlin, Eq. (6b): strain softening. Its membrane is incompressible (`ν = ½` at small
    /// strain); the Poisson ratio of [`Shell`] then enters the bending energy only.
    MooneyRivlin {
        /// Share `b` of the second term, in `[0, 1]`.
        b: f64,
    },
    /// Skalak's law: strain hardening, `C = ν/(1−ν)`.
    Skalak,
}

impl Law {
    /// Which law it is.
    pub fn name(self) -> LawName {
        match self {
            Law::Hooke => LawName::Hooke,
            Law::MooneyRivlin { .. } => LawName::MooneyRivlin,
            Law::Skalak => LawName::Skalak,
        }
    }

    /// The share `b`, of the law that has one.
    pub fn b(self) -> Option<f64> {
        match self {
            Law::MooneyRivlin { b } => Some(b),
            Law::Hooke | Law::Skalak => None,
        }
    }
}

impl fmt::Display for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name().name())
    }
}

/// The laws without their constants.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LawName {
    /// Hooke's, Eq. (6a).
    Hooke,
    /// Mooney and Rivlin's, Eq. (6b).
    MooneyRivlin,
    /// Skalak's.
    Skalak,
}

impl LawName {
    /// All of them.
    pub const ALL: [LawName; 3] = [LawName::Hooke, LawName::MooneyRivlin, LawName::Skalak];
    /// Their names.
    pub const NAMES: [&'static str; 3] =
        [LawName::Hooke.name(), LawName::MooneyRivlin.name(), LawName::Skalak.name()];

    /// Its name in files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            LawName::Hooke => "hooke",
            LawName::MooneyRivlin => "mooney-rivlin",
            LawName::Skalak => "skalak",
        }
    }

    /// The law of that name.
    pub fn of(name: &str) -> Option<LawName> {
        LawName::ALL.into_iter().find(|law| law.name() == name)
    }

    /// The law with this share `b`, which only Mooney and Rivlin's has.
    pub fn with_b(self, b: f64) -> Law {
        match self {
            LawName::Hooke => Law::Hooke,
            LawName::MooneyRivlin => Law::MooneyRivlin { b },
            LawName::Skalak => Law::Skalak,
        }
    }
}

/// What the shell is made of.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Shell {
    /// Membrane law.
    #[serde(flatten)]
    pub law: Law,
    /// Poisson ratio `ν`.
    pub poisson: f64,
}

impl Shell {
    /// Checks the Poisson ratio and the law's own constants.
    ///
    /// # Errors
    /// Names the first constant that is outside what the law allows.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let nu = self.poisson;
        require(
            "poisson",
            nu,
            nu > -1.0 && nu < 1.0,
            "greater than -1 and less than 1",
            "0.5 is an incompressible coating",
        )?;
        match self.law {
            Law::Hooke => Ok(()),
            Law::MooneyRivlin { b } => require(
                "b",
                b,
                (0.0..=1.0).contains(&b),
                "from 0 to 1",
                "0 is neo-Hookean, 1 the Mooney-Rivlin law of Eq. (6b)",
            ),
            // C < 0 leaves the energy without a lower bound at large strain
            Law::Skalak => require(
                "poisson",
                nu,
                nu >= 0.0,
                "at least 0 and less than 1 for Skalak's law",
                "C = nu/(1 - nu) must not be negative",
            ),
        }
    }
}

/// The dimensionless groups of Eq. (21a).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dimensionless {
    /// Bending stiffness `k_b/(χR0²)`; `(h/R0)²/(12(1−ν²))` for a solid shell, Eq. (21b).
    pub bending: f64,
    /// Ambient pressure `P_A R0/χ`.
    pub pressure: f64,
    /// Adhesion energy `w0/χ`, the depth of the potential of Eq. (13a).
    pub adhesion: f64,
    /// Film length `δ_A/R0` of Eq. (13a), where the potential has its minimum.
    pub film: f64,
    /// Surface tension `γ_BW/χ`.
    #[serde(default)]
    pub surface_tension: f64,
    /// Gas exponent `γ` of Eq. (20a); 0 is constant pressure, 1 isothermal.
    #[serde(default = "default_gas_exponent")]
    pub gas_exponent: f64,
}

/// The gas exponent of the paper, `γ = 1.07`.
pub fn default_gas_exponent() -> f64 {
    1.07
}

impl Dimensionless {
    /// Checks every group.
    ///
    /// # Errors
    /// Names the first group that is outside what the model allows.
    pub fn validate(&self) -> Result<(), ParameterError> {
        positive("bending", self.bending, "k_b/(chi R0^2), for example 3e-5")?;
        not_negative("pressure", self.pressure, "P_A R0/chi; 0 is an empty shell in vacuum")?;
        not_negative("adhesion", self.adhesion, "w0/chi; 0 switches the film off")?;
        positive("film", self.film, "delta_A/R0, for example 0.033")?;
        not_negative("surface_tension", self.surface_tension, "gamma_BW/chi, often 0")?;
        not_negative("gas_exponent", self.gas_exponent, "1.07 in the paper; 0 is constant pressure")
    }
}

/// How stiff the shell is: from its material, or measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Stiffness {
    /// A homogeneous solid shell: `χ = E h`, `k_b = E h³/(12(1−ν²))`, Eq. (11).
    Solid {
        /// Young modulus `E`, Pa.
        young: f64,
        /// Thickness `h`, m.
        thickness: f64,
    },
    /// A coating whose thickness means little: both moduli are given.
    Coating {
        /// Stretching modulus `χ`, N/m.
        chi: f64,
        /// Bending modulus `k_b`, N m.
        bending: f64,
    },
}

/// A shell, its gas and its film in SI units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Physical {
    /// Stress-free radius `R0`, m.
    pub radius: f64,
    /// Stretching and bending stiffness.
    #[serde(flatten)]
    pub stiffness: Stiffness,
    /// Ambient pressure `P_A`, Pa.
    pub pressure: f64,
    /// Adhesion energy `w0`, N/m.
    pub adhesion: f64,
    /// Film length `δ_A`, m.
    pub film: f64,
    /// Surface tension `γ_BW`, N/m.
    #[serde(default)]
    pub surface_tension: f64,
    /// Gas exponent `γ`.
    #[serde(default = "default_gas_exponent")]
    pub gas_exponent: f64,
}

impl Physical {
    /// Stretching and bending moduli `(χ, k_b)` in N/m and N m, Eq. (11).
    pub fn moduli(&self, poisson: f64) -> (f64, f64) {
        match self.stiffness {
            Stiffness::Coating { chi, bending } => (chi, bending),
            Stiffness::Solid { young, thickness } => {
                let cube = thickness * thickness * thickness;
                (young * thickness, young * cube / (12.0 * (1.0 - poisson * poisson)))
            }
        }
    }

    /// The dimensionless groups of Eq. (21) and the scales that lead back.
    ///
    /// # Errors
    /// Names the first quantity that is outside what the model allows, by its physical name.
    pub fn to_dimensionless(
        &self,
        poisson: f64,
    ) -> Result<(Dimensionless, Scales), ParameterError> {
        require(
            "poisson",
            poisson,
            poisson > -1.0 && poisson < 1.0,
            "greater than -1 and less than 1",
            "0.5 is an incompressible coating",
        )?;
        positive("radius", self.radius, "the stress-free radius in metres")?;
        match self.stiffness {
            Stiffness::Solid { young, thickness } => {
                positive("young", young, "the Young modulus in pascal")?;
                positive("thickness", thickness, "the thickness of the coating in metres")?;
            }
            Stiffness::Coating { chi, bending } => {
                positive("chi", chi, "the stretching modulus in newton per metre")?;
                positive("bending", bending, "the bending modulus in newton metre")?;
            }
        }
        not_negative("pressure", self.pressure, "the ambient pressure in pascal")?;
        not_negative("adhesion", self.adhesion, "the adhesion energy in newton per metre")?;
        positive("film", self.film, "the film length in metres")?;
        not_negative("surface_tension", self.surface_tension, "in newton per metre")?;
        not_negative("gas_exponent", self.gas_exponent, "1.07 in the paper")?;
        let groups = self.groups(poisson);
        groups.validate()?;
        Ok((groups, self.scales(poisson)))
    }

    /// The dimensionless groups of Eq. (21), whatever the numbers are: lengths in `R0`, tensions in `χ`, pressures in
    /// `χ/R0`.
    pub fn groups(&self, poisson: f64) -> Dimensionless {
        let (chi, bending) = self.moduli(poisson);
        let radius = self.radius;
        Dimensionless {
            bending: bending / (chi * radius * radius),
            pressure: self.pressure * radius / chi,
            adhesion: self.adhesion / chi,
            film: self.film / radius,
            surface_tension: self.surface_tension / chi,
            gas_exponent: self.gas_exponent,
        }
    }

    /// What leads back from them.
    pub fn scales(&self, poisson: f64) -> Scales {
        let (tension, bending) = self.moduli(poisson);
        Scales { length: self.radius, tension, bending }
    }
}

/// What dimensionless results are multiplied by to get SI units.
///
/// `z0` counts from the equator to one plate. An instrument that closes both plates sees twice the
/// deformation reported here, `2Δ`, at the same force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Scales {
    /// `R0`, m: of `z0`, deformation, radii.
    pub length: f64,
    /// `χ`, N/m: of membrane tensions.
    pub tension: f64,
    /// `k_b`, N m.
    pub bending: f64,
}

impl Scales {
    /// `√(χ k_b)`, N: of the reported force `F̂`, Eq. (23).
    pub fn force(&self) -> f64 {
        (self.tension * self.bending).sqrt()
    }

    /// `χR0²`, J: of energies.
    pub fn energy(&self) -> f64 {
        self.tension * self.length * self.length
    }

    /// `χ/R0`, Pa: of pressures.
    pub fn pressure(&self) -> f64 {
        self.tension / self.length
    }

    /// `R0³`, m³: of volumes.
    pub fn volume(&self) -> f64 {
        self.length * self.length * self.length
    }

    /// Approach of two plates, `2Δ` in m, at the deformation `Δ/R0` of one pole.
    pub fn total_approach(&self, deformation: f64) -> f64 {
        2.0 * self.length * deformation
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::close;
    use proptest::prelude::*;

    const GOOD: Dimensionless = Dimensionless {
        bending: 3e-5,
        pressure: 3e-3,
        adhesion: 2e-3,
        film: 0.03,
        surface_tension: 0.0,
        gas_exponent: 1.07,
    };

    #[test]
    fn each_bad_group_is_named() {
        assert!(GOOD.validate().is_ok());
        let name = |d: Dimensionless| d.validate().unwrap_err().key();
        assert_eq!(name(Dimensionless { bending: 0.0, ..GOOD }), "bending");
        assert_eq!(name(Dimensionless { pressure: -1.0, ..GOOD }), "pressure");
        assert_eq!(name(Dimensionless { adhesion: f64::NAN, ..GOOD }), "adhesion");
        assert_eq!(name(Dimensionless { film: 0.0, ..GOOD }), "film");
        assert_eq!(name(Dimensionless { surface_tension: -0.1, ..GOOD }), "surface_tension");
        assert_eq!(name(Dimensionless { gas_exponent: f64::INFINITY, ..GOOD }), "gas_exponent");
        assert!(Dimensionless { adhesion: 0.0, pressure: 0.0, ..GOOD }.validate().is_ok());
        let text = Dimensionless { film: -0.5, ..GOOD }.validate().unwrap_err().to_string();
        assert_eq!(text, "film = -0.5: must be positive (delta_A/R0, for example 0.033)");
    }

    #[test]
    fn laws_allow_what_they_can() {
        let ok = |law, poisson| Shell { law, poisson }.validate().is_ok();
        assert!(ok(Law::Hooke, -0.5) && !ok(Law::Hooke, 1.0) && !ok(Law::Hooke, -1.0));
        assert!(ok(Law::Skalak, 0.0) && !ok(Law::Skalak, -0.1));
        assert!(ok(Law::MooneyRivlin { b: 0.0 }, 0.5));
        assert!(!ok(Law::MooneyRivlin { b: 1.1 }, 0.5));
    }

    /// The polymer shell of Fig. 6: h/R0 = 1/60.
    #[test]
    fn physical_shell_becomes_the_groups_of_eq_21() {
        let physical = Physical {
            radius: 1.5e-6,
            stiffness: Stiffness::Solid { young: 2.1e9, thickness: 25e-9 },
            pressure: 101_325.0,
            adhesion: 1e-4,
            film: 50e-9,
            surface_tension: 0.0,
            gas_exponent: 1.07,
        };
        let (d, scales) = physical.to_dimensionless(0.5).unwrap();
        close(d.bending, (25.0_f64 / 1500.0).powi(2) / 9.0, 1e-14, 0.0);
        close(d.pressure, 2.895e-3, 1e-5, 0.0);
        close(d.adhesion, 1e-4 / 52.5, 1e-14, 0.0);
        close(d.film, 1.0 / 30.0, 1e-14, 0.0);
        close(scales.force(), 52.5 * 1.5e-6 * d.bending.sqrt(), 1e-14, 0.0);
        close(scales.total_approach(0.1), 3e-7, 1e-14, 0.0);
        let coating = Physical {
            stiffness: Stiffness::Coating { chi: 52.5, bending: scales.bending },
            ..physical
        };
        close(coating.to_dimensionless(0.5).unwrap().0.bending, d.bending, 1e-14, 0.0);
        let bad = Physical { radius: -1.0, ..physical };
        assert_eq!(bad.to_dimensionless(0.5).unwrap_err().key(), "radius");
    }

    proptest! {
        #[test]
        fn validation_never_lets_a_number_through_that_is_not_finite(
            which in 0..6_usize, bad in prop::sample::select(vec![f64::NAN, f64::INFINITY, -1e-3])
        ) {
            let mut d = GOOD;
            let slot = match which {
                0 => &mut d.bending, 1 => &mut d.pressure, 2 => &mut d.adhesion,
                3 => &mut d.film, 4 => &mut d.surface_tension, _ => &mut d.gas_exponent,
            };
            *slot = bad;
            prop_assert!(d.validate().is_err());
        }
    }
}
