//! The path of a contact case, in the words and units of a laboratory: `path.quantity`, and `path.start` and
//! `path.end` as quantities.
//!
//! Both poles of the bubble deform alike, and `z0` is half the distance of the plates in `R0`, so
//!
//! ```text
//! separation = 2 R0 z0        total = 2 R0 (1 − z0)
//! approach   = R0 (1 − z0)    piezo = total + F/K = 2 R0 (1 − base)
//! ```
//!
//! `piezo` is the travel of one lever's base beyond the height at which its plate would touch the free shell
//! undeflected, `K` the lever's stiffness: the base of half the bubble on a spring of `2 K` is `z0 − F/(2K)`.

use super::document::{Node, Value};
use super::error::Complaint;
use super::keys::{self, ANY, POSITIVE, Range};
use super::reader::Section;
use super::resolve::{CONTACT_START, Resolver};
use super::{Device, PathCase};
use crate::units::{self, Dimension, Quantity};

/// What the ends of a path measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PathQuantity {
    /// The device's own parameter: `z0`, the force, or the base of a spring.
    #[default]
    Parameter,
    /// The distance of the plates.
    Separation,
    /// How far one plate has come from the pole of the free shell towards its equator.
    Approach,
    /// The same of both plates together.
    Total,
    /// The travel of a lever's base from where the plate would touch the free shell.
    Piezo,
}

impl PathQuantity {
    /// The names that a case file may use.
    pub(super) const NAMES: [&str; 5] = ["parameter", "separation", "approach", "total", "piezo"];
    const ALL: [PathQuantity; 5] = [
        PathQuantity::Parameter,
        PathQuantity::Separation,
        PathQuantity::Approach,
        PathQuantity::Total,
        PathQuantity::Piezo,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// The device's parameter where this is `x`, both dimensionless.
    fn parameter(self, x: f64) -> f64 {
        match self {
            PathQuantity::Parameter => x,
            PathQuantity::Separation => 0.5 * x,
            PathQuantity::Approach => 1.0 - x,
            PathQuantity::Total | PathQuantity::Piezo => 1.0 - 0.5 * x,
        }
    }

    /// Why a device cannot be driven by it, and what to do.
    fn refused_by(self, device: Device) -> Option<String> {
        let name = self.name();
        match (self, device) {
            (PathQuantity::Parameter, _)
            | (PathQuantity::Piezo, Device::Cantilever { .. })
            | (
                PathQuantity::Separation | PathQuantity::Approach | PathQuantity::Total,
                Device::Grip,
            ) => None,
            (_, Device::DeadLoad) => Some(format!(
                "a dead load prescribes the force, not the {name}; leave path.quantity out and give forces"
            )),
            (PathQuantity::Piezo, _) => Some(
                "a grip has no lever between piezo and plate; take \"total\", or device.kind = \
                 \"cantilever\""
                    .to_owned(),
            ),
            _ => Some(format!(
                "a cantilever prescribes its base, not the {name}, which depends on the force; take \
                 \"piezo\", or leave out the table [device]"
            )),
        }
    }
}

/// One end of a path as it was given.
#[derive(Debug, Clone, PartialEq)]
pub enum PathEnd {
    /// A number, in `R0` (a force in `sqrt(chi k_b)`).
    Number(f64),
    /// A quantity with its unit.
    Quantity(Quantity),
}

impl PathEnd {
    fn is_physical(&self) -> bool {
        matches!(self, PathEnd::Quantity(_))
    }
}

/// A path as it was given in a case in physical units.
#[derive(Debug, Clone, PartialEq)]
pub struct PhysicalPath {
    /// What its ends measure.
    pub quantity: PathQuantity,
    /// `path.start`.
    pub start: PathEnd,
    /// `path.end`.
    pub end: PathEnd,
}

/// What the parameters of a case are measured in.
#[derive(Debug, Clone, Copy)]
pub(super) enum Scale {
    /// The case is dimensionless.
    None,
    /// The case is physical, and wrong: nothing more is to be said.
    Unknown,
    /// The case is physical.
    Known {
        /// `R0`, m.
        radius: f64,
        /// `sqrt(chi k_b)`, N.
        force: f64,
    },
}

impl Resolver<'_> {
    /// The path of a contact case, and how it was given if that was in other words than the solver's.
    pub(super) fn contact_path(
        &self,
        device: Option<Device>,
        scale: Scale,
    ) -> Option<(PathCase, Option<PhysicalPath>)> {
        let section = self.contact_path_table();
        let quantity = match section.get(keys::PATH_QUANTITY.name) {
            None => PathQuantity::Parameter,
            Some(node) => {
                let word = self.word(section, &keys::PATH_QUANTITY)?;
                let quantity =
                    PathQuantity::ALL.into_iter().find(|q| q.name() == word).unwrap_or_default();
                if let Some(why) = device.and_then(|device| quantity.refused_by(device)) {
                    let name = keys::PATH_QUANTITY.name;
                    self.reader.refuse(section, name, node, Complaint::Conflict(why));
                    return None;
                }
                quantity
            }
        };
        let is_grip = device.is_none_or(|device| device == Device::Grip);
        let ranges = if is_grip { [CONTACT_START, POSITIVE] } else { [ANY, ANY] };
        let force = device == Some(Device::DeadLoad);
        self.path_of(section, ranges, (quantity, force), scale)
    }

    /// The path between two plates, whose ends may be lengths with their units.
    pub(super) fn plates_path(
        &self,
        ranges: [Range; 2],
        scale: Scale,
    ) -> Option<(PathCase, Option<PhysicalPath>)> {
        self.path_of(self.path_table(), ranges, (PathQuantity::Parameter, false), scale)
    }

    /// A path of a quantity, and how its ends were given where that is not the bare parameter.
    fn path_of(
        &self,
        section: Section<'_>,
        ranges: [Range; 2],
        (quantity, force): (PathQuantity, bool),
        scale: Scale,
    ) -> Option<(PathCase, Option<PhysicalPath>)> {
        let [start, end] = [("start", ranges[0]), ("end", ranges[1])]
            .map(|(key, range)| self.path_end(section, key, range, (quantity, force), scale));
        let path = self.path_between(
            section,
            start.as_ref().map(|(value, _)| *value),
            end.as_ref().map(|(value, _)| *value),
        );
        let ((_, start), (_, end)) = (start?, end?);
        let given = start.is_physical() || end.is_physical() || quantity != PathQuantity::Parameter;
        let given = given.then_some(PhysicalPath { quantity, start, end });
        Some((path?, given))
    }

    /// One end: the value of the device's parameter, and how it was given.
    fn path_end(
        &self,
        section: Section<'_>,
        key: &'static str,
        range: Range,
        (quantity, force): (PathQuantity, bool),
        scale: Scale,
    ) -> Option<(f64, PathEnd)> {
        let node = section.get(key);
        let dimension = if force { Dimension::Force } else { Dimension::Length };
        // in a dimensionless case a text is a quantity only if it can be read as one: else a number is expected
        let is_quantity = |node: &&Node| match (&node.value, scale) {
            (Value::Text(text), Scale::None) => units::parse(text, dimension).is_ok(),
            (Value::Text(_), _) => true,
            _ => false,
        };
        let given = match node.filter(is_quantity) {
            Some(node) => {
                let given = self.reader.quantity(section, key, dimension, ANY)?;
                let unit = match scale {
                    Scale::Known { force: unit, .. } if force => unit,
                    Scale::Known { radius, .. } => radius,
                    Scale::Unknown => return None,
                    Scale::None => {
                        let unit = if force { "sqrt(chi k_b)" } else { "R0" };
                        let why = format!(
                            "a quantity with a unit needs the shell in physical units, in a table \
                             [physical]; with [dimensionless] give a number, in {unit}"
                        );
                        self.reader.refuse(section, key, node, Complaint::Conflict(why));
                        return None;
                    }
                };
                (given.si / unit, PathEnd::Quantity(given))
            }
            _ if quantity == PathQuantity::Parameter => {
                let value = self.reader.required(section, key, range)?;
                (value, PathEnd::Number(value))
            }
            _ => {
                let value = self.reader.required(section, key, ANY)?;
                (value, PathEnd::Number(value))
            }
        };
        let value = quantity.parameter(given.0);
        if let Some(node) = node
            && !range.contains(value)
        {
            let allowed = format!("such that z0/R0 is {}; it makes z0/R0 = {value}", range.words);
            self.reader.refuse(section, key, node, Complaint::OutOfRange { allowed });
            return None;
        }
        Some((value, given.1))
    }
}

#[cfg(test)]
mod tests {
    use super::super::source::load_text;
    use super::super::{ContactCase, Override, ProblemCase, ResolvedCase};

    /// `R0` = 1.5 um, `sqrt(chi k_b)` = sqrt(0.05 · 3e-16) N.
    const CASE: &str = "problem = \"contact\"\n[shell]\nlaw = \"hooke\"\n[physical]\nradius = \"1.5 um\"\n\
        chi = \"0.05 N/m\"\nbending = \"3e-16 N m\"\npressure = \"1 atm\"\nadhesion = \"0.1 mN/m\"\n\
        film = \"50 nm\"\n[path]\nstart = 1.3\nend = 0.6\n";

    fn read(overrides: &[&str]) -> Result<ResolvedCase, String> {
        let overrides: Vec<Override> =
            overrides.iter().map(|text| Override::given_by("--set", *text)).collect();
        let loaded = load_text("a.toml", "a", CASE, &overrides, &[]);
        loaded.map(|loaded| loaded.case).map_err(|error| error.to_string())
    }

    fn contact(case: &ResolvedCase) -> &ContactCase {
        match &case.problem {
            ProblemCase::Contact(contact) => contact,
            other => unreachable!("{other:?}"),
        }
    }

    fn near(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-12 * b.abs().max(1.0), "{a} {b}");
    }

    #[test]
    fn a_laboratorys_lengths_are_values_of_the_parameter() {
        let ends = |overrides: &[&str]| {
            let case = read(overrides).unwrap();
            // and the file that is written says the same
            let again = load_text("b.toml", "a", &case.to_toml(), &[], &[]).unwrap().case;
            assert_eq!(again, case);
            (case.path.start, case.path.end)
        };
        let (start, end) = ends(&["path.start=1.95 um", "path.end=900 nm"]);
        near(start, 1.3);
        near(end, 0.6);
        for (quantity, from, to) in [
            ("separation", "3.9 um", "1.8 um"),
            ("approach", "-450 nm", "600 nm"),
            ("total", "-0.9 um", "1.2 um"),
        ] {
            let [quantity, from, to] = [
                format!("path.quantity={quantity}"),
                format!("path.start={from}"),
                format!("path.end={to}"),
            ];
            let (start, end) = ends(&[&quantity, &from, &to]);
            near(start, 1.3);
            near(end, 0.6);
        }
        // numbers are in R0
        near(ends(&["path.quantity=approach", "path.start=-0.3", "path.end=0.4"]).1, 0.6);
        let lever = ["device.kind=cantilever", "device.stiffness=0.08 N/m", "path.quantity=piezo"];
        let piezo = [&lever[..], &["path.start=-300 nm", "path.end=1.5 um"]].concat();
        let (start, end) = ends(&piezo);
        near(start, 1.1);
        near(end, 0.5);
        let unit = (0.05_f64 * 3e-16).sqrt();
        let stiffness = contact(&read(&piezo).unwrap()).device.stiffness().unwrap();
        near(stiffness, 2.0 * 0.08 * 1.5e-6 / unit);
        let load = ["device.kind=dead-load", "path.start=-1 nN", "path.end=20 nN"];
        near(ends(&load).1 / (2e-8 / unit), 1.0);
    }

    #[test]
    fn what_no_device_prescribes_is_refused_with_the_way_out() {
        for (overrides, parts) in [
            (&["path.quantity=piezo"][..], &["path.quantity", "total", "cantilever"][..]),
            (&["path.quantity=aproach"], &["did you mean \"approach\"", "separation"]),
            (
                &["device.kind=cantilever", "device.stiffness=0.08 N/m", "path.quantity=approach"],
                &["path.quantity", "depends on the force", "piezo"],
            ),
            (&["path.end=50 nN"], &["path.end = 50 nN", "unit of force"]),
            (&["path.quantity=approach", "path.start=50 nm"], &["path.start", "greater than 1"]),
            (
                &["device.kind=cantilever", "device.stiffness=8 nN"],
                &["device.stiffness", "tension"],
            ),
            (
                &["device.kind=cantilever", "device.stiffness=-8 N/m"],
                &["device.stiffness", "must be positive"],
            ),
            (&["device.kind=grip", "device.stiffness=8 N/m"], &["only a cantilever has"]),
            (&["events.knee=yes"], &["events.knee", "true or false"]),
        ] {
            let message = read(overrides).unwrap_err();
            assert!(parts.iter().all(|part| message.contains(part)), "{overrides:?}: {message}");
        }
    }
}
