//! The film of a case: its potential, the keys that each potential has, and how they are written.
//!
//! All that a case knows of potentials is here; the physics is in [`shell_contact::film`].

use super::document::Origin;
use super::error::Complaint;
use super::keys::{self, Absent, Key, Kind, POSITIVE, Range, key, number, quantity};
use super::reader::Section;
use super::resolve::Resolver;
use crate::units::{Dimension, Quantity};
use shell_contact::film::{Dlvo, Film, SurfaceForces, double_layer_of_surface_potential};

/// What notes say of keys that an override of the potential makes useless.
pub const PASSED_OVER: &str = "is passed over";

/// A potential, and the keys that no other has.
struct Choice {
    name: &'static str,
    /// In `[dimensionless]` and of a plate.
    groups: &'static [Key],
    /// In `[physical]`.
    physical: &'static [Key],
}

const FOUR_TWO: Choice = Choice {
    name: "four-two",
    groups: &[],
    physical: &[keys::PHYSICAL_ADHESION, keys::PHYSICAL_FILM],
};
const DLVO: Choice = Choice {
    name: "dlvo",
    groups: &[DEBYE],
    physical: &[HAMAKER, PHYSICAL_DEBYE, DOUBLE_LAYER, SURFACE_POTENTIAL],
};
const CHOICES: [&Choice; 2] = [&FOUR_TWO, &DLVO];
const NAMES: [&str; CHOICES.len()] = [FOUR_TWO.name, DLVO.name];

const OF_DLVO: Absent = Absent::Other("required by dlvo, an error else");
const STRENGTH: Absent = Absent::Other("dlvo: double_layer or surface_potential");

/// `potential`.
const POTENTIAL: Key = key(
    "potential",
    Kind::Word(&NAMES),
    "",
    Absent::Word(FOUR_TWO.name),
    "Potential of the film: two powers of its height, or double layer and van der Waals",
);
/// `debye`, dimensionless.
const DEBYE: Key = number(
    "debye",
    Range { holds: Dlvo::allows, words: Dlvo::ALLOWED },
    "delta_A",
    OF_DLVO,
    "Debye length over the film thickness",
);
/// `physical.hamaker`.
const HAMAKER: Key = quantity(
    "hamaker",
    Dimension::Energy,
    POSITIVE,
    OF_DLVO,
    "Hamaker's constant A of shell and plate across the liquid",
);
/// `physical.debye`.
const PHYSICAL_DEBYE: Key =
    quantity("debye", Dimension::Length, POSITIVE, OF_DLVO, "Debye length of the liquid");
/// `physical.double_layer`.
const DOUBLE_LAYER: Key = quantity(
    "double_layer",
    Dimension::Tension,
    POSITIVE,
    STRENGTH,
    "Strength Z of the double layer, whose energy is Z exp(-h/debye)",
);
/// `physical.surface_potential`.
const SURFACE_POTENTIAL: Key = quantity(
    "surface_potential",
    Dimension::Voltage,
    Range { holds: |x| x != 0.0 && x.abs() <= 1.0, words: "not zero and at most 1 V" },
    STRENGTH,
    "Potential of both surfaces in water with a 1:1 salt at 25 °C",
);

/// The keys of potentials beside adhesion and film, dimensionless.
pub(super) const GROUPS: [Key; 2] = [POTENTIAL, DEBYE];
/// The keys of potentials beside adhesion and film in `[physical]`.
pub(super) const PHYSICAL: [Key; 5] =
    [POTENTIAL, HAMAKER, PHYSICAL_DEBYE, DOUBLE_LAYER, SURFACE_POTENTIAL];

/// The film of a case in physical units.
pub(super) struct PhysicalFilm {
    /// Adhesion w0, as given or as it follows.
    pub(super) adhesion: Quantity,
    /// Film thickness delta_A, as given or as it follows.
    pub(super) film: Quantity,
    /// The potential.
    pub(super) potential: Film,
    /// What adhesion and film follow from, as written; empty if they are given themselves.
    pub(super) forces: Vec<(&'static str, Quantity)>,
}

impl Resolver<'_> {
    /// Adhesion, film thickness and potential of `[dimensionless]` or a plate.
    pub(super) fn film(&self, section: Section<'_>) -> Option<(f64, f64, Film)> {
        let adhesion = self.required(section, &keys::ADHESION);
        let film = self.required(section, &keys::FILM);
        let choice = self.choice(section, |choice| choice.groups)?;
        let potential = if choice.name == DLVO.name {
            if section.get(DEBYE.name).is_none() {
                let hint = "dlvo needs the Debye length over the film thickness, such as 0.1";
                self.reader.missing(section, DEBYE.name, hint);
            }
            let debye = self.number(section, &DEBYE);
            Film::Dlvo(Dlvo::new(debye?).ok()?)
        } else {
            Film::FourTwo
        };
        Some((adhesion?, film?, potential))
    }

    /// The film of `[physical]`.
    pub(super) fn physical_film(&self, section: Section<'_>) -> Option<PhysicalFilm> {
        let choice = self.choice(section, |choice| choice.physical)?;
        if choice.name == DLVO.name {
            return self.surface_forces(section);
        }
        let adhesion = self.required_quantity(section, &keys::PHYSICAL_ADHESION);
        let film = self.required_quantity(section, &keys::PHYSICAL_FILM);
        let (potential, forces) = (Film::FourTwo, Vec::new());
        Some(PhysicalFilm { adhesion: adhesion?, film: film?, potential, forces })
    }

    /// The potential that a table asks for; complains about keys of others in it. What a file says for its own
    /// potential is passed over where an override asks for another.
    fn choice(
        &self,
        section: Section<'_>,
        own: fn(&Choice) -> &'static [Key],
    ) -> Option<&'static Choice> {
        let name = match section.get(POTENTIAL.name) {
            None => FOUR_TWO.name,
            Some(_) => self.word(section, &POTENTIAL)?,
        };
        let choice = CHOICES.into_iter().find(|choice| choice.name == name)?;
        let given = |origin: Origin| matches!(origin, Origin::Given(_));
        let replaced = section.get(POTENTIAL.name).is_some_and(|node| given(node.origin));
        let mut good = true;
        for other in CHOICES.into_iter().filter(|other| other.name != name) {
            for key in own(other) {
                let Some(node) = section.get(key.name) else { continue };
                if replaced && !given(node.origin) {
                    self.note(format!(
                        "{} {PASSED_OVER}: potential {name} has no such key",
                        section.path(key.name)
                    ));
                    continue;
                }
                let why = format!(
                    "potential {name} has no such key; leave it out, or say potential = \"{}\"",
                    other.name
                );
                self.reader.refuse(section, key.name, node, Complaint::Conflict(why));
                good = false;
            }
        }
        good.then_some(choice)
    }

    /// Hamaker's constant, Debye length and double layer, and the well that they make.
    fn surface_forces(&self, section: Section<'_>) -> Option<PhysicalFilm> {
        let hamaker = self.required_quantity(section, &HAMAKER);
        let debye = self.required_quantity(section, &PHYSICAL_DEBYE);
        let given = [DOUBLE_LAYER, SURFACE_POTENTIAL].map(|key| section.get(key.name).is_some());
        let strength = match given {
            [true, false] => self.required_quantity(section, &DOUBLE_LAYER),
            [false, true] => self.required_quantity(section, &SURFACE_POTENTIAL),
            [true, true] => {
                let node = section.get(SURFACE_POTENTIAL.name)?;
                let why = "double_layer says the same; keep one of them".to_owned();
                self.reader.refuse(section, SURFACE_POTENTIAL.name, node, Complaint::Conflict(why));
                None
            }
            [false, false] => {
                let hint = "give the double layer's strength (\"2 mJ/m2\"), or surface_potential \
                            (\"30 mV\")";
                self.reader.missing(section, DOUBLE_LAYER.name, hint);
                None
            }
        };
        let (hamaker, debye, strength) = (hamaker?, debye?, strength?);
        let (name, double_layer) = match given {
            [true, _] => (DOUBLE_LAYER.name, strength.si),
            _ => {
                let z = double_layer_of_surface_potential(strength.si, debye.si);
                (SURFACE_POTENTIAL.name, z)
            }
        };
        let forces = SurfaceForces { hamaker: hamaker.si, double_layer, debye: debye.si };
        let refuse = |key: &str, why: String| {
            if let Some(node) = section.get(key) {
                self.reader.refuse(section, key, node, Complaint::Conflict(why));
            }
        };
        let Some((film, adhesion)) = forces.well() else {
            let most = SurfaceForces::MOST / forces.attraction() * hamaker.si;
            let why = format!(
                "the attraction overcomes this double layer ({double_layer:.3e} J/m2) at every \
                 height: the film has no minimum; hamaker must be less than {most:.3e} J, or the \
                 double layer stronger"
            );
            refuse(HAMAKER.name, why);
            return None;
        };
        let Ok(potential) = Dlvo::new(debye.si / film) else {
            let why = format!(
                "the attraction is too weak: the film would be {film:.3e} m thick, {:.0} Debye \
                 lengths; at most 100 are allowed",
                film / debye.si
            );
            refuse(HAMAKER.name, why);
            return None;
        };
        Some(PhysicalFilm {
            adhesion: Quantity { si: adhesion, text: format!("{adhesion:.3e} N/m") },
            film: Quantity { si: film, text: format!("{:.4} nm", film * 1e9) },
            potential: Film::Dlvo(potential),
            forces: vec![(HAMAKER.name, hamaker), (PHYSICAL_DEBYE.name, debye), (name, strength)],
        })
    }
}

/// A key as a case file has it, its value in TOML, and what it means.
pub(super) type Line = (&'static str, String, &'static str);

/// What a case file says of a potential beside adhesion and film: nothing of the first one.
pub(super) fn written(film: &Film) -> Vec<Line> {
    match film {
        Film::FourTwo => Vec::new(),
        Film::Dlvo(dlvo) => {
            vec![chosen(DLVO.name), (DEBYE.name, format!("{:?}", dlvo.debye()), "lambda / delta_A")]
        }
    }
}

/// The potential without which a key of a table has no meaning; `None` for a key of all.
pub(super) fn owner(table: &str, key: &str) -> Option<&'static str> {
    let own = |choice: &Choice| match table {
        "physical" => choice.physical,
        _ => choice.groups,
    };
    let has = |choice: &&Choice| own(choice).iter().any(|own| own.name == key);
    CHOICES.into_iter().find(has).map(|choice| choice.name)
}

/// Values for the keys of a potential that a case in physical units does not have: those that make the same
/// depth and height of the film.
pub(super) fn others([adhesion, film]: [f64; 2], potential: &Film) -> Vec<(&'static str, String)> {
    let digits = |value: f64, unit: &str| format!("{} {unit}", rounded(value));
    match *potential {
        Film::FourTwo => {
            let forces = SurfaceForces::of_well(film, adhesion, TYPICAL * film);
            vec![
                (POTENTIAL.name, FOUR_TWO.name.to_owned()),
                match forces.hamaker < 1e-18 {
                    true => (HAMAKER.name, digits(forces.hamaker * 1e21, "zJ")),
                    false => (HAMAKER.name, digits(forces.hamaker * 1e18, "aJ")),
                },
                (PHYSICAL_DEBYE.name, digits(forces.debye * 1e9, "nm")),
                (DOUBLE_LAYER.name, digits(forces.double_layer * 1e3, "mJ/m2")),
            ]
        }
        Film::Dlvo(_) => vec![
            (keys::PHYSICAL_ADHESION.name, digits(adhesion * 1e3, "mN/m")),
            (keys::PHYSICAL_FILM.name, digits(film * 1e9, "nm")),
        ],
    }
}

/// The same of a film that is given by dimensionless groups.
pub(super) fn others_of_groups(potential: &Film) -> Vec<(&'static str, String)> {
    match potential {
        Film::FourTwo => {
            vec![(POTENTIAL.name, FOUR_TWO.name.to_owned()), (DEBYE.name, TYPICAL.to_string())]
        }
        Film::Dlvo(_) => Vec::new(),
    }
}

/// A Debye length over the thickness of the film, as in water with some salt.
const TYPICAL: f64 = 0.1;

/// Four digits, which a slider's start needs no more of.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// The choice itself.
fn chosen(name: &str) -> Line {
    (POTENTIAL.name, format!("\"{name}\""), "potential of the film")
}
