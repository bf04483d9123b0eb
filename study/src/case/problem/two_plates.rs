//! A case between two plates of their own: `[plate.top]`, `[plate.bottom]`, `equator`.

use super::{ProblemCase, Read};
use crate::case::document::Value;
use crate::case::error::Complaint;
use crate::case::keys::{self, ANY, POSITIVE, names};
use crate::case::path::Scale;
use crate::case::physical::ShellKeys;
use crate::case::reader::Section;
use crate::case::resolve::{CONTACT_START, HOMES, Resolver};
use crate::case::write::{self, Lines};
use crate::case::{MeshCase, PhysicalPlate, PhysicalShell, Shell, film};
use crate::units::{Dimension, Quantity};
use shell_contact::film::Film;

/// A microbubble from pole to pole between two plates.
#[derive(Debug, Clone, PartialEq)]
pub struct TwoPlatesCase {
    /// The shell's material.
    pub shell: Shell,
    /// `k_b / (chi R0²)`.
    pub bending: f64,
    /// `P_A R0 / chi`.
    pub pressure: f64,
    /// `gamma_BW / chi`.
    pub surface_tension: f64,
    /// The polytropic exponent of the gas.
    pub gas_exponent: f64,
    /// The upper plate and the lower; `None` for one that is not there.
    pub plates: [Option<PlateCase>; 2],
    /// Whether the equator is held in the mid-plane.
    pub held: bool,
    /// The shell in physical units, if it was given in them.
    pub physical: Option<Box<PhysicalShell>>,
    /// The same of the films of the plates that there are.
    pub physical_plates: [Option<Box<PhysicalPlate>>; 2],
    /// The mesh of either half.
    pub mesh: MeshCase,
}

impl TwoPlatesCase {
    /// Name of the continued parameter: half the distance of the plates, or the base of a spring.
    pub fn parameter(&self) -> &'static str {
        let [top, _] = self.plates;
        if top.is_some_and(|plate| plate.stiffness.is_some()) { "base" } else { "z0" }
    }
}

/// One of two plates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlateCase {
    /// `w0 / chi`.
    pub adhesion: f64,
    /// `delta_A / R0`.
    pub film: f64,
    /// The potential whose depth and length these are.
    pub potential: Film,
    /// `k_c` of the cantilever that it hangs on, in `sqrt(chi k_b)/R0`; rigid without one.
    pub stiffness: Option<f64>,
}

/// Keys of the whole shell; those of the films are the plates'.
const GROUPS: &[&str] = &names(&keys::GROUPS_WITHOUT_FILM);
/// The same in physical units.
const PHYSICAL: &[&str] = &names(&keys::PHYSICAL_WITHOUT_FILM);
/// Keys of a plate.
const PLATE: &[&str] = &names(&keys::PLATE);
/// The same in physical units.
const PHYSICAL_PLATE: &[&str] = &names(&keys::PHYSICAL_PLATE);
/// The tables of the plates.
const TABLES: [(&str, &str); 2] = [("top", "plate.top"), ("bottom", "plate.bottom")];

/// What may be said of the equator.
const EQUATOR: [&str; 2] = ["free", "held"];
/// What may hold a plate.
const DEVICES: [&str; 2] = ["grip", "cantilever"];

impl<'a> Resolver<'a> {
    pub(in crate::case) fn two_plates(&mut self) -> Read {
        let tables = [
            "name",
            "problem",
            "equator",
            "shell",
            "dimensionless",
            "physical",
            "plate",
            "mesh",
            "path",
            "diagram",
            "map",
            "stability",
            "picture",
        ];
        self.reader.only(self.root, &tables, HOMES);
        let shell = self.shell();
        let dimensionless = self.reader.section(self.root, "dimensionless");
        let homes: Vec<_> = std::iter::once((TABLES[0].1, PLATE)).chain(HOMES.to_vec()).collect();
        self.reader.only(dimensionless, GROUPS, &homes);
        let physical = self.reader.section(self.root, "physical");
        let homes: Vec<_> =
            std::iter::once((TABLES[0].1, PHYSICAL_PLATE)).chain(HOMES.to_vec()).collect();
        self.reader.only(physical, PHYSICAL, &homes);
        let poisson = shell.map_or(0.5, |shell| shell.poisson);
        let groups = match self.is_physical(dimensionless, physical) {
            Some(false) => self.groups_without_film(dimensionless).map(|groups| (groups, None)),
            Some(true) => self.physical_shell(physical, &ShellKeys::OF_BUBBLES, poisson).map(
                |(all, given)| {
                    let groups = [all.bending, all.pressure, all.surface_tension, all.gas_exponent];
                    (groups, Some(Box::new(given)))
                },
            ),
            None => None,
        };
        let held = self.equator();
        let given = groups.as_ref().and_then(|(_, given)| given.as_deref());
        let units = match given {
            Some(shell) => PlateUnits::Physical { shell, poisson },
            None if physical.exists() => PlateUnits::Unknown,
            None => PlateUnits::Dimensionless,
        };
        let plates = self.plates(held.unwrap_or(false), units);
        let mesh = self.fixed_mesh();
        let on_spring = plates
            .as_ref()
            .is_some_and(|[top, _]| top.as_ref().is_some_and(|(p, _)| p.stiffness.is_some()));
        let ranges = if on_spring { [ANY, ANY] } else { [CONTACT_START, POSITIVE] };
        let (path, ends) = self.plates_path(ranges, units.scale()).unzip();
        let problem = match (shell, groups, plates, held, mesh) {
            (Some(shell), Some((groups, physical)), Some(plates), Some(held), Some(mesh)) => {
                let [bending, pressure, surface_tension, gas_exponent] = groups;
                let (plates, physical_plates) = separated(plates);
                let physical = physical
                    .map(|given| Box::new(PhysicalShell { path: ends.flatten(), ..*given }));
                Some(ProblemCase::TwoPlates(TwoPlatesCase {
                    shell,
                    bending,
                    pressure,
                    surface_tension,
                    gas_exponent,
                    plates,
                    held,
                    physical,
                    physical_plates,
                    mesh,
                }))
            }
            _ => None,
        };
        (problem, path)
    }

    /// Whether the equator is held.
    fn equator(&self) -> Option<bool> {
        if self.root.get("equator").is_none() {
            return Some(false);
        }
        self.reader.word(self.root, "equator", &EQUATOR).map(|word| word == EQUATOR[1])
    }

    /// Both plates; one may be absent if something else holds the shell.
    fn plates(&self, held: bool, units: PlateUnits<'_>) -> Option<[Option<Plate>; 2]> {
        let plate = self.reader.section(self.root, "plate");
        self.reader.only(plate, &TABLES.map(|(key, _)| key), HOMES);
        let mut plates = [None, None];
        let mut good = true;
        for (k, (key, name)) in TABLES.into_iter().enumerate() {
            let Some(node) = plate.get(key) else { continue };
            let Value::Table(table) = &node.value else {
                self.reader.wrong_type(plate, key, node, &format!("a table [{name}]"), "");
                good = false;
                continue;
            };
            let section = Section::of(name, node.origin, table);
            let (own, homes) = match units {
                PlateUnits::Dimensionless => (PLATE, HOMES),
                _ => (PHYSICAL_PLATE, HOMES),
            };
            self.reader.only(section, own, homes);
            plates[k] = self.plate(section, k == 0, units);
            good &= plates[k].is_some();
        }
        let absent: Vec<&str> = TABLES
            .iter()
            .filter(|(key, _)| plate.get(key).is_none())
            .map(|(key, _)| *key)
            .collect();
        match absent[..] {
            [] => {}
            [_] if held => {}
            [key] => {
                let hint = "give its adhesion and film; a shell before one plate alone needs \
                            equator = \"held\", or it leaves that plate for good";
                self.reader.missing(plate, key, hint);
                good = false;
            }
            _ => {
                let hint = "give adhesion and film of both plates, [plate.top] and [plate.bottom]";
                self.reader.missing(self.root, "plate", hint);
                good = false;
            }
        }
        good.then_some(plates)
    }

    fn plate(&self, section: Section<'a>, top: bool, units: PlateUnits<'_>) -> Option<Plate> {
        let film = self.plate_film(section, units);
        let device = match section.get("device") {
            None => Some(DEVICES[0]),
            Some(_) => self.reader.word(section, "device", &DEVICES),
        };
        let given = section.get("stiffness");
        let stiffness = match given {
            Some(node) if node.is_quantity() => self.plate_lever(section, units).unzip(),
            _ => (self.number(section, &keys::STIFFNESS), None),
        };
        let cantilever = device? == DEVICES[1];
        if let (true, false, Some(node)) = (cantilever, top, section.get("device")) {
            let why = "only the upper plate may hang on a cantilever: give it to [plate.top]";
            self.reader.refuse(section, "device", node, Complaint::Conflict(why.to_owned()));
            return None;
        }
        match (cantilever, given) {
            (true, None) => {
                let hint = "a cantilever needs its stiffness, in sqrt(chi k_b)/R0";
                self.reader.missing(section, "stiffness", hint);
                return None;
            }
            (false, Some(node)) => {
                let why = "a grip has none; say device = \"cantilever\", or leave it out";
                self.reader.refuse(section, "stiffness", node, Complaint::Conflict(why.to_owned()));
                return None;
            }
            _ => {}
        }
        let (stiffness, lever) =
            if cantilever { (Some(stiffness.0?), stiffness.1) } else { (None, None) };
        let (adhesion, film, potential, given) = film?;
        let given = given.map(|given| PhysicalPlate { lever, ..given });
        Some((PlateCase { adhesion, film, potential, stiffness }, given))
    }

    /// The film of a plate: adhesion, length and potential, and how they were given in physical units.
    fn plate_film(
        &self,
        section: Section<'a>,
        units: PlateUnits<'_>,
    ) -> Option<(f64, f64, Film, Option<PhysicalPlate>)> {
        if let PlateUnits::Dimensionless = units {
            let (adhesion, film, potential) = self.film(section)?;
            return Some((adhesion, film, potential, None));
        }
        let film::PhysicalFilm { adhesion, film, potential, forces } =
            self.physical_film(section)?;
        let PlateUnits::Physical { shell, poisson } = units else { return None };
        let groups = shell.numbers(adhesion.si, film.si).groups(poisson);
        self.admits_groups(section, &groups)?;
        let given = PhysicalPlate { adhesion, film, forces, lever: None };
        Some((groups.adhesion, groups.film, potential, Some(given)))
    }

    /// A cantilever with its unit: `k_c = K R0/sqrt(chi k_b)`, as it gives way behind one plate.
    fn plate_lever(&self, section: Section<'a>, units: PlateUnits<'_>) -> Option<(f64, Quantity)> {
        let key = keys::STIFFNESS;
        let node = section.get(key.name)?;
        let given = self.reader.quantity(section, key.name, Dimension::Tension, POSITIVE)?;
        let why = match units.scale() {
            Scale::Known { radius, force } => {
                let stiffness = given.si * radius / force;
                if key.range().contains(stiffness) {
                    return Some((stiffness, given));
                }
                format!(
                    "this lever makes the dimensionless stiffness {stiffness:?}, which must be {}; check the units",
                    key.range().words
                )
            }
            Scale::Unknown => return None,
            Scale::None => {
                "a stiffness with a unit needs the shell in physical units, in a table [physical]; \
                            with [dimensionless] give K R0/sqrt(chi k_b), a number"
                    .to_owned()
            }
        };
        self.reader.refuse(section, key.name, node, Complaint::Conflict(why));
        None
    }
}

/// A plate, and how its film and its lever were given in physical units.
type Plate = (PlateCase, Option<PhysicalPlate>);

/// In what the keys of a plate are.
#[derive(Clone, Copy)]
enum PlateUnits<'s> {
    /// In those of `[dimensionless]`.
    Dimensionless,
    /// In physical ones, of a shell that is wrong.
    Unknown,
    /// In physical ones.
    Physical { shell: &'s PhysicalShell, poisson: f64 },
}

impl PlateUnits<'_> {
    fn scale(self) -> Scale {
        match self {
            PlateUnits::Dimensionless => Scale::None,
            PlateUnits::Unknown => Scale::Unknown,
            PlateUnits::Physical { shell, poisson } => {
                Scale::Known { radius: shell.radius.si, force: shell.force_scale(poisson) }
            }
        }
    }
}

/// The plates, and what is physical of them.
fn separated(
    plates: [Option<Plate>; 2],
) -> ([Option<PlateCase>; 2], [Option<Box<PhysicalPlate>>; 2]) {
    let [top, bottom] = plates.map(|plate| match plate {
        Some((plate, given)) => (Some(plate), given.map(Box::new)),
        None => (None, None),
    });
    ([top.0, bottom.0], [top.1, bottom.1])
}

/// The case as a case file has it.
pub(super) fn write(out: &mut Lines, case: &TwoPlatesCase) {
    out.text("problem", "two-plates");
    out.text("equator", EQUATOR[usize::from(case.held)]);
    write::shell(out, case.shell);
    let groups = [
        ("bending", case.bending),
        ("pressure", case.pressure),
        ("surface_tension", case.surface_tension),
        ("gas_exponent", case.gas_exponent),
    ];
    write::shell_groups(out, case.physical.as_deref(), &groups);
    let plates = case.plates.into_iter().zip(&case.physical_plates);
    for (name, (plate, given)) in ["plate.top", "plate.bottom"].into_iter().zip(plates) {
        let Some(plate) = plate else { continue };
        out.table(name);
        if let Some(given) = given {
            write::film(out, (&given.adhesion, &given.film, &given.forces), &plate.potential);
        } else {
            out.number("adhesion", plate.adhesion);
            out.number("film", plate.film);
            for (key, value, _) in film::written(&plate.potential) {
                out.line(&format!("{key} = {value}"));
            }
        }
        out.text("device", DEVICES[usize::from(plate.stiffness.is_some())]);
        match (plate.stiffness, given.as_ref().and_then(|given| given.lever.as_ref())) {
            (Some(stiffness), Some(lever)) => {
                out.line(&format!("# in sqrt(chi k_b)/R0: {stiffness:?}"));
                out.text("stiffness", &lever.text);
            }
            (Some(stiffness), None) => out.number("stiffness", stiffness),
            (None, _) => {}
        }
    }
    write::mesh(out, case.mesh);
}
