//! A case between two plates of their own: `[plate.top]`, `[plate.bottom]`, `equator`.

use super::{ProblemCase, Read};
use crate::case::document::Value;
use crate::case::error::Complaint;
use crate::case::keys::{self, ANY, POSITIVE, names};
use crate::case::reader::Section;
use crate::case::resolve::{CONTACT_START, HOMES, Resolver};
use crate::case::write::{self, Lines};
use crate::case::{MeshCase, Shell, film};
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
/// Keys of a plate.
const PLATE: &[&str] = &names(&keys::PLATE);
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
        let groups = self.reader.section(self.root, "dimensionless");
        let homes: Vec<_> = std::iter::once((TABLES[0].1, PLATE)).chain(HOMES.to_vec()).collect();
        self.reader.only(groups, GROUPS, &homes);
        let groups = self.groups_without_film(groups);
        let held = self.equator();
        let plates = self.plates(held.unwrap_or(false));
        let mesh = self.fixed_mesh();
        let on_spring = plates.is_some_and(|[top, _]| top.is_some_and(|p| p.stiffness.is_some()));
        let (start, end) = if on_spring { (ANY, ANY) } else { (CONTACT_START, POSITIVE) };
        let path = self.path(None, start, end);
        let problem = match (shell, groups, plates, held, mesh) {
            (Some(shell), Some(groups), Some(plates), Some(held), Some(mesh)) => {
                let [bending, pressure, surface_tension, gas_exponent] = groups;
                Some(ProblemCase::TwoPlates(TwoPlatesCase {
                    shell,
                    bending,
                    pressure,
                    surface_tension,
                    gas_exponent,
                    plates,
                    held,
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
    fn plates(&self, held: bool) -> Option<[Option<PlateCase>; 2]> {
        let plate = self.reader.section(self.root, "plate");
        self.reader.only(plate, &TABLES.map(|(key, _)| key), HOMES);
        let mut plates = [None; 2];
        let mut good = true;
        for (k, (key, name)) in TABLES.into_iter().enumerate() {
            let Some(node) = plate.get(key) else { continue };
            let Value::Table(table) = &node.value else {
                self.reader.wrong_type(plate, key, node, &format!("a table [{name}]"), "");
                good = false;
                continue;
            };
            let section = Section::of(name, node.origin, table);
            self.reader.only(section, PLATE, HOMES);
            plates[k] = self.plate(section, k == 0);
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

    fn plate(&self, section: Section<'a>, top: bool) -> Option<PlateCase> {
        let film = self.film(section);
        let device = match section.get("device") {
            None => Some(DEVICES[0]),
            Some(_) => self.reader.word(section, "device", &DEVICES),
        };
        let stiffness = self.number(section, &keys::STIFFNESS);
        let given = section.get("stiffness");
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
        let stiffness = if cantilever { Some(stiffness?) } else { None };
        let (adhesion, film, potential) = film?;
        Some(PlateCase { adhesion, film, potential, stiffness })
    }
}

/// The case as a case file has it.
pub(super) fn write(out: &mut Lines, case: &TwoPlatesCase) {
    out.text("problem", "two-plates");
    out.text("equator", EQUATOR[usize::from(case.held)]);
    write::shell(out, case.shell);
    out.table("dimensionless");
    out.number("bending", case.bending);
    out.number("pressure", case.pressure);
    out.number("surface_tension", case.surface_tension);
    out.number("gas_exponent", case.gas_exponent);
    for (name, plate) in ["plate.top", "plate.bottom"].into_iter().zip(case.plates) {
        let Some(plate) = plate else { continue };
        out.table(name);
        out.number("adhesion", plate.adhesion);
        out.number("film", plate.film);
        for (key, value, _) in film::written(&plate.potential) {
            out.line(&format!("{key} = {value}"));
        }
        out.text("device", DEVICES[usize::from(plate.stiffness.is_some())]);
        if let Some(stiffness) = plate.stiffness {
            out.number("stiffness", stiffness);
        }
    }
    write::mesh(out, case.mesh);
}
