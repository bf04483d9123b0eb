//! Physical quantities with their units: `"25 nm"`, `"2.1 GPa"`, `"1e-4 N/m"`.
//!
//! A unit that is a power of ten of the SI unit shifts the decimal exponent before the number is
//! read, so `"25 nm"` is exactly the `f64` nearest to 25e-9 and nothing is lost to a product.

use std::fmt;

/// What a quantity measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Metres.
    Length,
    /// Pascals: pressures and Young's moduli.
    Pressure,
    /// Newtons per metre: tensions, surface energies, area moduli.
    Tension,
    /// Newton metres: the bending modulus of a shell.
    Moment,
    /// Joules: Hamaker's constant.
    Energy,
    /// Volts: the potential of a surface.
    Voltage,
    /// Newtons.
    Force,
    /// Metres per volt: how far a lever's end moves for a volt of the detector.
    Sensitivity,
}

/// How a unit relates to the SI unit of its dimension.
#[derive(Clone, Copy)]
enum Factor {
    /// A power of ten.
    Ten(i32),
    /// Any other factor.
    Times(f64),
}

use Dimension::{Energy, Force, Length, Moment, Pressure, Sensitivity, Tension, Voltage};
use Factor::{Ten, Times};

/// Every unit that is understood: the normal spelling, its dimension, its factor.
const UNITS: &[(&str, Dimension, Factor)] = &[
    ("m", Length, Ten(0)),
    ("mm", Length, Ten(-3)),
    ("um", Length, Ten(-6)),
    ("nm", Length, Ten(-9)),
    ("angstrom", Length, Ten(-10)),
    ("Pa", Pressure, Ten(0)),
    ("kPa", Pressure, Ten(3)),
    ("MPa", Pressure, Ten(6)),
    ("GPa", Pressure, Ten(9)),
    ("bar", Pressure, Ten(5)),
    ("atm", Pressure, Times(101_325.0)),
    ("N/m", Tension, Ten(0)),
    ("mN/m", Tension, Ten(-3)),
    ("uN/m", Tension, Ten(-6)),
    ("J/m2", Tension, Ten(0)),
    ("mJ/m2", Tension, Ten(-3)),
    ("uJ/m2", Tension, Ten(-6)),
    ("N m", Moment, Ten(0)),
    ("J", Moment, Ten(0)),
    ("aJ", Moment, Ten(-18)),
    ("J", Energy, Ten(0)),
    ("aJ", Energy, Ten(-18)),
    ("zJ", Energy, Ten(-21)),
    ("V", Voltage, Ten(0)),
    ("mV", Voltage, Ten(-3)),
    ("N", Force, Ten(0)),
    ("uN", Force, Ten(-6)),
    ("nN", Force, Ten(-9)),
    ("pN", Force, Ten(-12)),
    ("m/V", Sensitivity, Ten(0)),
    ("um/V", Sensitivity, Ten(-6)),
    ("nm/V", Sensitivity, Ten(-9)),
    ("nm/mV", Sensitivity, Ten(-6)),
];

impl Dimension {
    /// An example, for messages.
    pub fn example(self) -> &'static str {
        match self {
            Length => "25 nm",
            Pressure => "2.1 GPa",
            Tension => "0.05 N/m",
            Moment => "3e-16 N m",
            Energy => "5e-21 J",
            Voltage => "30 mV",
            Force => "50 pN",
            Sensitivity => "60 nm/V",
        }
    }

    /// The units of this dimension, for messages.
    fn units(self) -> String {
        let names: Vec<&str> =
            UNITS.iter().filter(|(_, d, _)| *d == self).map(|(name, ..)| *name).collect();
        names.join(", ")
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Length => "length",
            Pressure => "pressure",
            Tension => "tension",
            Moment => "bending moment",
            Energy => "Hamaker constant",
            Voltage => "voltage",
            Force => "force",
            Sensitivity => "sensitivity",
        })
    }
}

/// A physical quantity: its value in SI units and the words it was written in.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Value in the SI unit of its dimension.
    pub si: f64,
    /// As written, trimmed.
    pub text: String,
}

/// Why a text is not a quantity of the dimension asked for.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum UnitError {
    /// No number at the start.
    #[error("expected a {dimension} such as \"{}\": a number, then a unit ({})", .dimension.example(), .dimension.units())]
    NoNumber {
        /// What was asked for.
        dimension: Dimension,
    },
    /// A number alone.
    #[error("the unit is missing: expected a {dimension} such as \"{}\" (units: {})", .dimension.example(), .dimension.units())]
    NoUnit {
        /// What was asked for.
        dimension: Dimension,
    },
    /// A unit of something else.
    #[error("expected a {dimension} such as \"{}\"; \"{unit}\" is a unit of {actual} (allowed: {})", .dimension.example(), .dimension.units())]
    WrongDimension {
        /// What was asked for.
        dimension: Dimension,
        /// The unit found.
        unit: String,
        /// What that unit measures.
        actual: Dimension,
    },
    /// No unit that is known.
    #[error("unknown unit \"{unit}\"{}: expected a {dimension} such as \"{}\" (allowed: {})", suggestion(unit, *.dimension), .dimension.example(), .dimension.units())]
    UnknownUnit {
        /// What was asked for.
        dimension: Dimension,
        /// The unit found.
        unit: String,
    },
    /// NaN, infinity, or a number too large to hold.
    #[error("not a finite number: expected a {dimension} such as \"{}\"", .dimension.example())]
    NotFinite {
        /// What was asked for.
        dimension: Dimension,
    },
}

/// The unit that differs from `unit` only in case, as a question.
fn suggestion(unit: &str, dimension: Dimension) -> String {
    UNITS
        .iter()
        .find(|(name, d, _)| *d == dimension && name.eq_ignore_ascii_case(unit))
        .map_or_else(String::new, |(name, ..)| format!(" (did you mean \"{name}\"?)"))
}

/// Read `text` as a quantity of the given dimension.
///
/// # Errors
/// When it is not a finite number followed by a unit of that dimension.
pub fn parse(text: &str, dimension: Dimension) -> Result<Quantity, UnitError> {
    let trimmed = text.trim();
    let (number, unit) = split(trimmed);
    if number.is_empty() {
        let word = trimmed.trim_start_matches(['+', '-']).to_ascii_lowercase();
        let infinite = ["nan", "inf"].iter().any(|w| word.starts_with(w));
        return Err(if infinite {
            UnitError::NotFinite { dimension }
        } else {
            UnitError::NoNumber { dimension }
        });
    }
    let unit = unit.trim();
    if unit.is_empty() {
        return Err(UnitError::NoUnit { dimension });
    }
    let name = normal(unit);
    // a joule is a unit of more than one dimension
    let named = || UNITS.iter().filter(|(known, ..)| *known == name);
    let own = named().find(|(_, actual, _)| *actual == dimension);
    let Some(&(_, actual, factor)) = own.or_else(|| named().next()) else {
        return Err(UnitError::UnknownUnit { dimension, unit: unit.to_string() });
    };
    if actual != dimension {
        return Err(UnitError::WrongDimension { dimension, unit: unit.to_string(), actual });
    }
    let si = match factor {
        Ten(shift) => scaled(number, shift),
        Times(factor) => scaled(number, 0).map(|value| value * factor),
    };
    match si {
        Some(si) if si.is_finite() => Ok(Quantity { si, text: trimmed.to_string() }),
        _ => Err(UnitError::NotFinite { dimension }),
    }
}

/// Split into the longest decimal number at the start and the rest.
fn split(text: &str) -> (&str, &str) {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut at = usize::from(bytes.first().is_some_and(|b| matches!(b, b'+' | b'-')));
    let whole = digits(at);
    at += whole;
    let mut fraction = 0;
    if bytes.get(at) == Some(&b'.') {
        fraction = digits(at + 1);
        at += 1 + fraction;
    }
    if whole + fraction == 0 {
        return ("", text);
    }
    if bytes.get(at).is_some_and(|b| matches!(b, b'e' | b'E')) {
        let sign = usize::from(bytes.get(at + 1).is_some_and(|b| matches!(b, b'+' | b'-')));
        let exponent = digits(at + 1 + sign);
        if exponent > 0 {
            at += 1 + sign + exponent;
        }
    }
    text.split_at(at)
}

/// `number` times ten to the power `shift`, rounded once.
fn scaled(number: &str, shift: i32) -> Option<f64> {
    let (mantissa, exponent) = match number.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
        None => (number, 0),
    };
    format!("{mantissa}e{}", exponent.checked_add(shift)?).parse().ok()
}

/// One spelling per unit: micro signs become `u`, products a single space, squares a `2`.
fn normal(unit: &str) -> String {
    let plain = unit
        .replace(['\u{b5}', '\u{3bc}'], "u")
        .replace(['*', '\u{b7}', '\u{22c5}'], " ")
        .replace('\u{b2}', "2")
        .replace('^', "");
    let joined = plain.split_whitespace().collect::<Vec<_>>().join(" ").replace(" /", "/");
    match joined.replace("/ ", "/").as_str() {
        "\u{c5}" | "\u{212b}" | "A" | "Angstrom" | "angstroms" => "angstrom".to_string(),
        "Nm" => "N m".to_string(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn si(text: &str, dimension: Dimension) -> f64 {
        parse(text, dimension).unwrap().si
    }

    #[test]
    fn powers_of_ten_are_exact() {
        assert_eq!(si("25 nm", Length), 25e-9);
        assert_eq!(si("1.5um", Length), 1.5e-6);
        assert_eq!(si("1.5 µm", Length), 1.5e-6);
        assert_eq!(si("1.5 μm", Length), 1.5e-6);
        assert_eq!(si("3 Å", Length), 3e-10);
        assert_eq!(si("2.1 GPa", Pressure), 2.1e9);
        assert_eq!(si("101325 Pa", Pressure), 101_325.0);
        assert_eq!(si("1 atm", Pressure), 101_325.0);
        assert_eq!(si("1.01325 bar", Pressure), 101_325.0);
        assert_eq!(si("1e-4 N/m", Tension), 1e-4);
        assert_eq!(si("0.1 mN/m", Tension), 1e-4);
        assert_eq!(si("0.1 mJ/m^2", Tension), 1e-4);
        assert_eq!(si("0.1 mJ/m²", Tension), 1e-4);
        for unit in ["N m", "N*m", "N·m", "N  m", "Nm", "J"] {
            assert_eq!(si(&format!("3e-16 {unit}"), Moment), 3e-16, "{unit}");
        }
        assert_eq!(si("+.5E2 aJ", Moment), 50e-18);
        assert_eq!(si("5 zJ", Energy), 5e-21);
        assert_eq!(si("5e-21 J", Energy), 5e-21);
        assert_eq!(si("-30 mV", Voltage), -0.03);
        assert_eq!(si("60 nm/V", Sensitivity), 60e-9);
        assert_eq!(si("0.06 nm / mV", Sensitivity), 60e-9);
    }

    #[test]
    fn negative_values_are_read_and_left_to_the_range_of_their_key() {
        assert_eq!(si("-25 nm", Length), -25e-9);
    }

    #[test]
    fn each_mistake_has_its_own_words() {
        let message = |text: &str| parse(text, Length).unwrap_err().to_string();
        assert!(message("25 Pa").contains("expected a length such as \"25 nm\""));
        assert!(message("25 Pa").contains("\"Pa\" is a unit of pressure"));
        assert!(message("25").contains("the unit is missing"));
        assert!(message("25 ").contains("the unit is missing"));
        assert!(message("").contains("a number, then a unit"));
        assert!(message("nm").contains("a number, then a unit"));
        assert!(message("25 parsec").contains("unknown unit \"parsec\""));
        assert!(message("nan nm").contains("not a finite number"));
        assert!(message("-inf nm").contains("not a finite number"));
        assert!(message("1e999 nm").contains("not a finite number"));
        assert!(message("1e99999999999 nm").contains("not a finite number"));
        let message = parse("2 mpa", Pressure).unwrap_err().to_string();
        assert!(message.contains("did you mean \"MPa\"?"), "{message}");
    }
}
