//! The quantities of a measurement: their keys, units, and the coordinates in which they are fitted.

use serde::{Deserialize, Serialize};
use shell_contact::{LawName, Shell};
use std::ops::{Index, IndexMut};

/// How many keys there are.
pub const COUNT: usize = 14;

/// A quantity that a fit knows or looks for. All are in SI units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Key {
    /// Stretching modulus `χ`, N/m.
    Chi,
    /// Bending modulus `k_b`, N m.
    Bending,
    /// Adhesion energy `w0`, N/m.
    Adhesion,
    /// Film length `δ_A`, m.
    Film,
    /// Stress-free radius `R0`, m.
    Radius,
    /// Height of the piezo at which the plates would be `2 R0` apart with an undeflected lever
    /// (`R0` to go where there is one contact), m.
    Contact,
    /// Force that is read where nothing touches, at the farthest sample, N.
    Offset,
    /// Slope of that baseline, by approach, N/m.
    Tilt,
    /// Ambient pressure `P_A`, Pa.
    Pressure,
    /// Surface tension `γ_BW`, N/m.
    SurfaceTension,
    /// Gas exponent `γ`.
    GasExponent,
    /// Poisson ratio `ν`.
    Poisson,
    /// Share `b` of Mooney and Rivlin's law, Eq. (6b).
    MooneyB,
    /// Stiffness of the lever, N/m.
    SpringConstant,
}

impl Key {
    /// All keys, in the order of [`Parameters`].
    pub const ALL: [Key; COUNT] = [
        Key::Chi,
        Key::Bending,
        Key::Adhesion,
        Key::Film,
        Key::Radius,
        Key::Contact,
        Key::Offset,
        Key::Tilt,
        Key::Pressure,
        Key::SurfaceTension,
        Key::GasExponent,
        Key::Poisson,
        Key::MooneyB,
        Key::SpringConstant,
    ];

    /// Its name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Key::Chi => "chi",
            Key::Bending => "bending",
            Key::Adhesion => "adhesion",
            Key::Film => "film",
            Key::Radius => "radius",
            Key::Contact => "contact",
            Key::Offset => "offset",
            Key::Tilt => "tilt",
            Key::Pressure => "pressure",
            Key::SurfaceTension => "surface_tension",
            Key::GasExponent => "gas_exponent",
            Key::Poisson => "poisson",
            Key::MooneyB => "b",
            Key::SpringConstant => "spring_constant",
        }
    }

    /// The key of that name.
    pub fn of(name: &str) -> Option<Key> {
        Key::ALL.into_iter().find(|key| key.name() == name)
    }

    /// Its SI unit; empty for pure numbers.
    pub fn unit(self) -> &'static str {
        match self {
            Key::Chi | Key::Adhesion | Key::SurfaceTension | Key::SpringConstant | Key::Tilt => {
                "N/m"
            }
            Key::Bending => "N m",
            Key::Film | Key::Radius | Key::Contact => "m",
            Key::Offset => "N",
            Key::Pressure => "Pa",
            Key::GasExponent | Key::Poisson | Key::MooneyB => "",
        }
    }

    /// Whether it is positive and fitted by its logarithm.
    pub fn is_logarithmic(self) -> bool {
        use Key::{Adhesion, Bending, Chi, Film, Pressure, Radius, SpringConstant};
        matches!(self, Chi | Bending | Adhesion | Film | Radius | Pressure | SpringConstant)
    }

    /// Whether the shell's branch does not depend on it: only where it is seen.
    pub fn is_of_the_instrument(self) -> bool {
        use Key::{Contact, Offset, SpringConstant, Tilt};
        matches!(self, Contact | Offset | Tilt | SpringConstant)
    }

    /// The coordinate in which it is fitted.
    pub fn coordinate(self, value: f64) -> f64 {
        if self.is_logarithmic() { value.ln() } else { value }
    }

    /// The value at a coordinate.
    pub fn value(self, coordinate: f64) -> f64 {
        if self.is_logarithmic() { coordinate.exp() } else { coordinate }
    }

    /// `d value / d coordinate`.
    pub fn slope(self, value: f64) -> f64 {
        if self.is_logarithmic() { value } else { 1.0 }
    }

    fn at(self) -> usize {
        self as usize
    }
}

/// A value of every key, SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters(pub [f64; COUNT]);

impl Default for Parameters {
    /// Of what a laboratory rarely says otherwise: air at sea level, the paper's gas exponent, no
    /// surface tension, `ν = ½`, `b = 1`. All others are NaN.
    fn default() -> Self {
        let mut p = Parameters([f64::NAN; COUNT]);
        p[Key::Offset] = 0.0;
        p[Key::Tilt] = 0.0;
        p[Key::Pressure] = 101_325.0;
        p[Key::SurfaceTension] = 0.0;
        p[Key::GasExponent] = shell_contact::default_gas_exponent();
        p[Key::Poisson] = 0.5;
        p[Key::MooneyB] = 1.0;
        p
    }
}

impl Index<Key> for Parameters {
    type Output = f64;
    fn index(&self, key: Key) -> &f64 {
        &self.0[key.at()]
    }
}

impl IndexMut<Key> for Parameters {
    fn index_mut(&mut self, key: Key) -> &mut f64 {
        &mut self.0[key.at()]
    }
}

impl Parameters {
    /// Thickness of the homogeneous shell with these moduli, `h = √(12(1−ν²)k_b/χ)`, Eq. (11), m.
    pub fn thickness(&self) -> f64 {
        let rest = 1.0 - self[Key::Poisson] * self[Key::Poisson];
        (12.0 * rest * self[Key::Bending] / self[Key::Chi]).sqrt()
    }

    /// Its Young modulus `E = χ/h`, Pa.
    pub fn young(&self) -> f64 {
        self[Key::Chi] / self.thickness()
    }

    /// The material of a law with these constants.
    pub fn shell(&self, law: LawName) -> Shell {
        Shell { law: law.with_b(self[Key::MooneyB]), poisson: self[Key::Poisson] }
    }

    /// `√(χ k_b)`, N: what the slope of the first contact fixes, Eq. (32).
    pub fn force_scale(&self) -> f64 {
        (self[Key::Chi] * self[Key::Bending]).sqrt()
    }
}
