//! What a key is: its name, kind, unit, default and line of help.

use crate::units::Dimension;

/// A range of numbers, in words too.
#[derive(Debug, Clone, Copy)]
pub struct Range {
    /// Whether a finite number is allowed.
    pub(crate) holds: fn(f64) -> bool,
    /// The same in words: "must be …".
    pub words: &'static str,
}

impl Range {
    /// Whether a number is allowed.
    pub fn contains(&self, value: f64) -> bool {
        value.is_finite() && (self.holds)(value)
    }
}

/// Any finite number.
pub(crate) const ANY: Range = Range { holds: |_| true, words: "a finite number" };
/// Greater than zero.
pub(crate) const POSITIVE: Range = Range { holds: |x| x > 0.0, words: "positive and finite" };
/// Zero or greater.
pub(crate) const NOT_NEGATIVE: Range =
    Range { holds: |x| x >= 0.0, words: "zero or positive, and finite" };
/// From 0 to 1.
pub(crate) const FRACTION: Range =
    Range { holds: |x| (0.0..=1.0).contains(&x), words: "from 0 to 1" };
/// Ratios of the longest element to the shortest.
pub(super) const GRADINGS: Range =
    Range { holds: |x| (1.0..=1000.0).contains(&x), words: "from 1 (uniform) to 1000" };
/// Tolerances of meshes.
pub(super) const MESH_TOLERANCES: Range =
    Range { holds: |x| (1e-10..=1e-2).contains(&x), words: "from 1e-10 to 1e-2" };
/// Poisson's ratios of an elastic solid.
pub(crate) const POISSON_RATIOS: Range =
    Range { holds: |x| x > -1.0 && x <= 0.5, words: "greater than -1 and at most 0.5" };
/// Poisson's ratios of Skalak's law.
pub(crate) const POISSON_SKALAK: Range =
    Range { holds: |x| x > -1.0 && x < 1.0, words: "between -1 and 1 (C = nu/(1 - nu))" };

/// What a key holds.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum Kind {
    /// A number.
    Number(Range),
    /// A whole number between two bounds, these included.
    Count {
        /// The least.
        least: i64,
        /// The largest.
        most: i64,
    },
    /// A physical quantity with its unit, in quotes.
    Quantity(Dimension, Range),
    /// One of a few words.
    Word(&'static [&'static str]),
    /// A word that depends on the problem; what it may be, in words.
    Text(&'static str),
    /// Yes or no: `true` or `false`, without quotes.
    Flag,
}

/// What a key is where a file does not say it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Absent {
    /// An error: the file must say it.
    Required,
    /// A number.
    Number(f64),
    /// A whole number.
    Count(usize),
    /// A word.
    Word(&'static str),
    /// Yes or no.
    Flag(bool),
    /// Something that depends on other keys, in words.
    Other(&'static str),
}

/// A key.
#[derive(Debug, Clone, Copy)]
pub struct Key {
    /// Its name.
    pub name: &'static str,
    /// What it holds.
    pub kind: Kind,
    /// What numbers are measured in; empty for pure numbers, and for quantities, which say it themselves.
    pub unit: &'static str,
    /// What it is where a file does not say it.
    pub default: Absent,
    /// One line of help.
    pub help: &'static str,
}

impl Key {
    /// The range of its numbers.
    pub(crate) fn range(&self) -> Range {
        match self.kind {
            Kind::Number(range) | Kind::Quantity(_, range) => range,
            Kind::Count { .. } | Kind::Word(_) | Kind::Text(_) | Kind::Flag => ANY,
        }
    }

    /// The bounds of its whole numbers.
    pub(crate) fn bounds(&self) -> (i64, i64) {
        match self.kind {
            Kind::Count { least, most } => (least, most),
            _ => (i64::MIN, i64::MAX),
        }
    }
}

/// A table of a case file.
#[derive(Debug, Clone, Copy)]
pub struct Keys {
    /// Its name.
    pub table: &'static str,
    /// The problems whose cases have it.
    pub problems: &'static str,
    /// Its keys.
    pub keys: &'static [Key],
}

/// The names of keys.
pub(crate) const fn names<const N: usize>(keys: &[Key; N]) -> [&'static str; N] {
    let mut names = [""; N];
    let mut at = 0;
    while at < N {
        names[at] = keys[at].name;
        at += 1;
    }
    names
}

/// One after the other.
pub(super) const fn joined<const A: usize, const B: usize, const N: usize>(
    first: [Key; A],
    second: [Key; B],
) -> [Key; N] {
    let mut all = [first[0]; N];
    let mut at = 0;
    while at < N {
        all[at] = if at < A { first[at] } else { second[at - A] };
        at += 1;
    }
    all
}

pub(super) const fn key(
    name: &'static str,
    kind: Kind,
    unit: &'static str,
    default: Absent,
    help: &'static str,
) -> Key {
    Key { name, kind, unit, default, help }
}

pub(super) const fn number(
    name: &'static str,
    range: Range,
    unit: &'static str,
    default: Absent,
    help: &'static str,
) -> Key {
    key(name, Kind::Number(range), unit, default, help)
}

pub(super) const fn count(
    name: &'static str,
    least: i64,
    most: i64,
    default: Absent,
    help: &'static str,
) -> Key {
    key(name, Kind::Count { least, most }, "", default, help)
}

pub(super) const fn quantity(
    name: &'static str,
    dimension: Dimension,
    range: Range,
    default: Absent,
    help: &'static str,
) -> Key {
    key(name, Kind::Quantity(dimension, range), "", default, help)
}
