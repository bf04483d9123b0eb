//! The keys of case files, each once: name, unit, default, range, and one line of help.
//!
//! The reader of case files, its messages and `docs/keys.md` are made from these.

use super::{Device, LawName, PathQuantity, StabilityCase, film, picture, problem};
use crate::units::Dimension;
use std::fmt::Write as _;

pub(crate) use super::key::{
    ANY, FRACTION, NOT_NEGATIVE, POISSON_RATIOS, POISSON_SKALAK, POSITIVE, names,
};
pub use super::key::{Absent, Key, Keys, Kind, Range};
use super::key::{GRADINGS, MESH_TOLERANCES, count, joined};
pub(super) use super::key::{key, number, quantity};
use Absent::{Other, Required};

/// `shell.law`.
pub(crate) const LAW: Key =
    key("law", Kind::Word(&LawName::NAMES), "", Required, "Law of the membrane");
/// `shell.poisson`.
pub(crate) const POISSON: Key = number(
    "poisson",
    POISSON_RATIOS,
    "",
    Absent::Number(0.5),
    "Poisson's ratio; Skalak's law takes any between -1 and 1",
);
/// `shell.b`.
pub(crate) const B: Key = number(
    "b",
    FRACTION,
    "",
    Other("required by mooney-rivlin, unused else"),
    "Mooney-Rivlin's constant; 0 is neo-Hookean",
);
/// The table `[shell]`.
pub(crate) const SHELL: [Key; 3] = [LAW, POISSON, B];

/// `dimensionless.bending`.
pub(crate) const BENDING: Key =
    number("bending", POSITIVE, "chi R0^2", Required, "Bending modulus k_b");
/// `dimensionless.pressure`.
pub(crate) const PRESSURE: Key =
    number("pressure", NOT_NEGATIVE, "chi/R0", Required, "Ambient pressure P_A");
/// `dimensionless.adhesion`.
pub(crate) const ADHESION: Key =
    number("adhesion", POSITIVE, "chi", Required, "Adhesion: depth w0 of the film's potential");
/// `dimensionless.film`.
pub(crate) const FILM: Key = number(
    "film",
    POSITIVE,
    "R0",
    Required,
    "Film thickness delta_A at which the potential is least",
);
/// `dimensionless.surface_tension`.
pub(crate) const SURFACE_TENSION: Key = number(
    "surface_tension",
    NOT_NEGATIVE,
    "chi",
    Absent::Number(0.0),
    "Surface tension gamma_BW of the shell's outside",
);
/// `gas_exponent`.
pub(crate) const GAS_EXPONENT: Key = number(
    "gas_exponent",
    NOT_NEGATIVE,
    "",
    Absent::Number(1.07),
    "Polytropic exponent of the gas; 0 is constant pressure",
);
/// The table `[dimensionless]` of a contact case.
pub(crate) const GROUPS: [Key; 6 + film::GROUPS.len()] =
    joined([BENDING, PRESSURE, ADHESION, FILM, SURFACE_TENSION, GAS_EXPONENT], film::GROUPS);
/// The same between two plates, whose films are their own.
pub(crate) const GROUPS_WITHOUT_FILM: [Key; 4] = [BENDING, PRESSURE, SURFACE_TENSION, GAS_EXPONENT];
const OF_FOUR_TWO: Absent = Other("required by four-two, an error else");
const MODULI: Absent = Other("young and thickness, or chi and bending");
/// `physical.radius`.
pub(crate) const RADIUS: Key =
    quantity("radius", Dimension::Length, POSITIVE, Required, "Radius R0 of the unstressed shell");
/// `physical.young`.
pub(crate) const YOUNG: Key =
    quantity("young", Dimension::Pressure, POSITIVE, MODULI, "Young's modulus of the wall");
/// `physical.thickness`.
pub(crate) const THICKNESS: Key =
    quantity("thickness", Dimension::Length, POSITIVE, MODULI, "Thickness of the wall");
/// `physical.chi`.
pub(crate) const CHI: Key = quantity(
    "chi",
    Dimension::Tension,
    POSITIVE,
    MODULI,
    "Area modulus chi, E h of a homogeneous wall",
);
/// `physical.bending`.
pub(crate) const PHYSICAL_BENDING: Key =
    quantity("bending", Dimension::Moment, POSITIVE, MODULI, BENDING.help);
/// `physical.pressure`.
pub(crate) const PHYSICAL_PRESSURE: Key =
    quantity("pressure", Dimension::Pressure, NOT_NEGATIVE, Required, PRESSURE.help);
/// `physical.adhesion`.
pub(crate) const PHYSICAL_ADHESION: Key =
    quantity("adhesion", Dimension::Tension, POSITIVE, OF_FOUR_TWO, ADHESION.help);
/// `physical.film`.
pub(crate) const PHYSICAL_FILM: Key =
    quantity("film", Dimension::Length, POSITIVE, OF_FOUR_TWO, FILM.help);
/// `physical.surface_tension`.
pub(crate) const PHYSICAL_SURFACE_TENSION: Key = quantity(
    "surface_tension",
    Dimension::Tension,
    NOT_NEGATIVE,
    Absent::Word("0 N/m"),
    SURFACE_TENSION.help,
);
/// The table `[physical]`.
pub(crate) const PHYSICAL: [Key; 10 + film::PHYSICAL.len()] = joined(
    [
        RADIUS,
        YOUNG,
        THICKNESS,
        CHI,
        PHYSICAL_BENDING,
        PHYSICAL_PRESSURE,
        PHYSICAL_ADHESION,
        PHYSICAL_FILM,
        PHYSICAL_SURFACE_TENSION,
        GAS_EXPONENT,
    ],
    film::PHYSICAL,
);

/// The table `[physical]` between two plates, whose films are their own.
pub(crate) const PHYSICAL_WITHOUT_FILM: [Key; 8] = [
    RADIUS,
    YOUNG,
    THICKNESS,
    CHI,
    PHYSICAL_BENDING,
    PHYSICAL_PRESSURE,
    PHYSICAL_SURFACE_TENSION,
    GAS_EXPONENT,
];

/// `mesh.elements`.
pub(crate) const ELEMENTS: Key =
    count("elements", 8, 100_000, Absent::Count(400), "Number of elements along the meridian");
/// `mesh.grading`.
pub(crate) const GRADING: Key = number(
    "grading",
    GRADINGS,
    "",
    Other("uniform; under a ring load the problem's own"),
    "Longest element over shortest, shrinking towards the pole",
);
/// `mesh.tolerance`.
pub(crate) const TOLERANCE: Key = number(
    "tolerance",
    MESH_TOLERANCES,
    "sqrt(chi k_b)",
    Other("a fixed mesh"),
    "Error of the mesh to stay below, in place of a number of elements",
);
/// The table `[mesh]`.
pub(crate) const MESH: [Key; 3] = [ELEMENTS, GRADING, TOLERANCE];
/// The same where meshes are fixed.
pub(crate) const FIXED_MESH: [Key; 2] = [ELEMENTS, GRADING];

/// `path.start`.
pub(crate) const START: Key = number(
    "start",
    ANY,
    "the parameter's own",
    Other("required; problems of the catalogue have their own"),
    "Where the continued parameter starts",
);
/// `path.end`.
pub(crate) const END: Key = Key { name: "end", help: "Where it ends", ..START };
/// `path.max_step`.
pub(crate) const MAX_STEP: Key = number(
    "max_step",
    POSITIVE,
    "the problem's metric",
    Other("the tracer's own"),
    "Longest step along the branch",
);
/// `path.min_step`.
pub(crate) const MIN_STEP: Key =
    Key { name: "min_step", help: "Shortest step along the branch", ..MAX_STEP };
/// `path.max_points`.
pub(crate) const MAX_POINTS: Key =
    count("max_points", 2, 10_000_000, Absent::Count(5000), "Most points of a branch");
/// `path.eigenvalues`.
pub(crate) const EIGENVALUES: Key = count(
    "eigenvalues",
    0,
    200,
    Absent::Count(0),
    "Eigenvalues to compute at every point, the most unstable ones",
);
/// `path.quantity` of a contact case.
pub(crate) const PATH_QUANTITY: Key = key(
    "quantity",
    Kind::Word(&PathQuantity::NAMES),
    "",
    Absent::Word(PathQuantity::NAMES[0]),
    "What start and end measure: the parameter itself, the plates' separation 2 R0 z0, the approach of one pole \
     R0 - R0 z0, that of both (total), or the travel of a lever's base (piezo)",
);
/// `path.start` of a contact case.
pub(crate) const CONTACT_PATH_START: Key = Key {
    unit: "R0, of a dead load sqrt(chi k_b)",
    default: Required,
    help: "Where the path starts; with [physical] also a quantity in quotes, such as \"1.7 um\"",
    ..START
};
/// `path.end` of a contact case.
pub(crate) const CONTACT_PATH_END: Key =
    Key { name: "end", help: "Where it ends, likewise", ..CONTACT_PATH_START };
/// The table `[path]` of a contact case.
pub(crate) const CONTACT_PATH: [Key; 7] = [
    PATH_QUANTITY,
    CONTACT_PATH_START,
    CONTACT_PATH_END,
    MAX_STEP,
    MIN_STEP,
    MAX_POINTS,
    EIGENVALUES,
];
/// `events.knee`.
pub(crate) const KNEE: Key = key(
    "knee",
    Kind::Flag,
    "",
    Absent::Flag(false),
    "Whether a trace looks for the knee, where the slope of the force has fallen to half of its largest since zero \
     force",
);
/// `events.contact`.
pub(crate) const CONTACT: Key = key(
    "contact",
    Kind::Flag,
    "",
    Absent::Flag(false),
    "Whether a trace looks for the contact, where the film at the pole turns from attraction to repulsion",
);
/// The table `[events]`.
pub(crate) const EVENTS: [Key; 2] = [KNEE, CONTACT];
/// The table `[path]`.
pub(crate) const PATH: [Key; 6] = [START, END, MAX_STEP, MIN_STEP, MAX_POINTS, EIGENVALUES];

/// `diagram.depth`.
pub(crate) const DEPTH: Key = count(
    "depth",
    0,
    100,
    Absent::Count(2),
    "Most branch points between a branch and the first one",
);
/// `diagram.max_branches`.
pub(crate) const MAX_BRANCHES: Key =
    count("max_branches", 1, 1_000_000, Absent::Count(1000), "Most branches");
/// `diagram.from`.
pub(crate) const DIAGRAM_FROM: Key = number(
    "from",
    ANY,
    "the parameter's own",
    Other("from path.start to path.end"),
    "Bound of the parameter, inside which the first branch is followed both ways",
);
/// `diagram.to`.
pub(crate) const DIAGRAM_TO: Key = Key { name: "to", help: "The other bound", ..DIAGRAM_FROM };
/// `diagram.search`.
pub(crate) const SEARCH: Key = key(
    "search",
    Kind::Word(&["near-bifurcations", "none"]),
    "",
    Absent::Word("near-bifurcations"),
    "Where disconnected branches are sought",
);
/// `diagram.cycles`.
pub(crate) const CYCLES: Key = key(
    "cycles",
    Kind::Flag,
    "",
    Absent::Flag(false),
    "Whether the periodic orbits that leave Hopf points are followed, by maps too",
);
/// `diagram.cycle_depth`.
pub(crate) const CYCLE_DEPTH: Key = count(
    "cycle_depth",
    0,
    20,
    Absent::Count(1),
    "Most period doublings and branch points between a branch of cycles and its Hopf point",
);
/// The table `[diagram]`.
pub(crate) const DIAGRAM: [Key; 7] =
    [DEPTH, MAX_BRANCHES, DIAGRAM_FROM, DIAGRAM_TO, SEARCH, CYCLES, CYCLE_DEPTH];

/// `map.from`.
pub(crate) const MAP_FROM: Key = number(
    "from",
    ANY,
    "the second parameter's own",
    Other("a tenth of the case's value"),
    "Lower bound of the second parameter",
);
/// `map.to`.
pub(crate) const MAP_TO: Key = Key {
    name: "to",
    default: Other("ten times the case's value"),
    help: "Upper bound of the second parameter",
    ..MAP_FROM
};
/// The table `[map]`.
pub(crate) const MAP: [Key; 2] = [MAP_FROM, MAP_TO];

/// `device.kind`.
pub(crate) const DEVICE_KIND: Key = key(
    "kind",
    Kind::Word(&Device::NAMES),
    "",
    Other("grip without the table"),
    "What holds the plates",
);
/// `device.stiffness`.
pub(crate) const STIFFNESS: Key = number(
    "stiffness",
    POSITIVE,
    "sqrt(chi k_b)/R0",
    Other("required by a cantilever, an error else"),
    "Stiffness of a cantilever, per plate",
);
/// `device.stiffness` of a contact case.
pub(crate) const DEVICE_STIFFNESS: Key = Key {
    help: "Stiffness of a cantilever, per plate; or, with [physical], in quotes that of one lever on the whole \
           bubble, such as \"0.08 N/m\"",
    ..STIFFNESS
};
/// The table `[device]`.
pub(crate) const DEVICE: [Key; 2] = [DEVICE_KIND, DEVICE_STIFFNESS];

/// `stability.scan`.
pub(crate) const SCAN: Key = key(
    "scan",
    Kind::Word(&StabilityCase::NAMES),
    "",
    Absent::Word(StabilityCase::NAMES[0]),
    "Which modes are counted besides those with the symmetries of the state",
);
/// `stability.max_n`; the bound of wave numbers is 22 at most in the shells studied.
pub(crate) const MAX_N: Key =
    count("max_n", 4, 1000, Absent::Count(40), "Most waves around the axis");
/// The table `[stability]`.
pub(crate) const STABILITY: [Key; 2] = [SCAN, MAX_N];

/// `device` of a plate.
pub(crate) const PLATE_DEVICE: Key = key(
    "device",
    Kind::Word(&["grip", "cantilever"]),
    "",
    Absent::Word("grip"),
    "What holds the plate; only the upper one may hang on a cantilever",
);
/// The tables `[plate.top]` and `[plate.bottom]`.
pub(crate) const PLATE: [Key; 4 + film::GROUPS.len()] =
    joined([ADHESION, FILM, PLATE_DEVICE, STIFFNESS], film::GROUPS);
/// `stiffness` of a plate beside `[physical]`.
const PLATE_STIFFNESS: Key = Key {
    help: "Stiffness of the cantilever that the plate hangs on; in quotes with its unit, such as \"0.08 N/m\"",
    ..STIFFNESS
};
/// The same tables beside `[physical]`.
pub(crate) const PHYSICAL_PLATE: [Key; 4 + film::PHYSICAL.len()] =
    joined([PHYSICAL_ADHESION, PHYSICAL_FILM, PLATE_DEVICE, PLATE_STIFFNESS], film::PHYSICAL);

/// What stands behind a problem whose keys are others beside `[physical]`.
pub const WITH_PHYSICAL: &str = " with [physical]";
/// The problem of plates beside `[physical]`.
const PHYSICAL_PLATES: &str = "two-plates with [physical]";

/// Every table of a case file with its keys, those of catalogue problems' own parameters left out: these
/// are in [`super::CatalogueEntry`].
pub const TABLES: [Keys; 20] = [
    Keys { table: "shell", problems: "contact, two-plates, ring-load", keys: &SHELL },
    Keys { table: "dimensionless", problems: "contact", keys: &GROUPS },
    Keys { table: "dimensionless", problems: "two-plates", keys: &GROUPS_WITHOUT_FILM },
    Keys { table: "dimensionless", problems: "ring-load", keys: &problem::ring_load::GROUPS },
    Keys { table: "physical", problems: "contact", keys: &PHYSICAL },
    Keys { table: "physical", problems: "two-plates", keys: &PHYSICAL_WITHOUT_FILM },
    Keys { table: "physical", problems: "ring-load", keys: &problem::ring_load::PHYSICAL },
    Keys { table: "plate.top", problems: "two-plates", keys: &PLATE },
    Keys { table: "plate.bottom", problems: "two-plates", keys: &PLATE },
    Keys { table: "plate.top", problems: PHYSICAL_PLATES, keys: &PHYSICAL_PLATE },
    Keys { table: "plate.bottom", problems: PHYSICAL_PLATES, keys: &PHYSICAL_PLATE },
    Keys { table: "device", problems: "contact", keys: &DEVICE },
    Keys { table: "mesh", problems: "all with a mesh", keys: &MESH },
    Keys { table: "path", problems: "contact", keys: &CONTACT_PATH },
    Keys { table: "path", problems: "two-plates, ring-load, catalogue", keys: &PATH },
    Keys { table: "events", problems: "contact", keys: &EVENTS },
    Keys { table: "diagram", problems: "all", keys: &DIAGRAM },
    Keys { table: "map", problems: "all", keys: &MAP },
    Keys { table: "stability", problems: "contact, two-plates", keys: &STABILITY },
    Keys { table: "picture", problems: "all", keys: &picture::KEYS },
];

/// The tables as Markdown, as `docs/keys.md` has them.
pub fn markdown() -> String {
    let mut out = String::new();
    for Keys { table, problems, keys } in TABLES {
        let _ = writeln!(out, "\n## `[{table}]`: {problems}\n");
        let _ =
            writeln!(out, "| key | what it is | value | unit | default |\n|---|---|---|---|---|");
        for key in keys {
            let (value, unit) = match key.kind {
                Kind::Number(range) => (range.words.to_owned(), key.unit.to_owned()),
                Kind::Count { least, most } => (format!("{least} to {most}"), String::new()),
                Kind::Quantity(dimension, range) => (
                    range.words.to_owned(),
                    format!("{dimension}, such as \"{}\"", dimension.example()),
                ),
                Kind::Word(words) => (words.join(", "), String::new()),
                Kind::Text(words) => (words.to_owned(), String::new()),
                Kind::Flag => ("true, false".to_owned(), String::new()),
            };
            let default = match key.default {
                Required => "required".to_owned(),
                Absent::Number(value) => value.to_string(),
                Absent::Count(value) => value.to_string(),
                Absent::Flag(value) => value.to_string(),
                Absent::Word(word) | Other(word) => word.to_owned(),
            };
            let _ =
                writeln!(out, "| `{}` | {} | {value} | {unit} | {default} |", key.name, key.help);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::path::Path;

    #[test]
    fn defaults_are_allowed() {
        for Keys { table, keys, .. } in TABLES {
            for key in keys {
                let good = match (key.default, key.kind) {
                    (Absent::Number(value), Kind::Number(range)) => range.contains(value),
                    (Absent::Count(value), Kind::Count { least, most }) => {
                        (least..=most).contains(&(value as i64))
                    }
                    (Absent::Word(word), Kind::Word(words)) => words.contains(&word),
                    (Absent::Flag(_), Kind::Flag) => true,
                    (Absent::Word(text), Kind::Quantity(dimension, range)) => {
                        crate::units::parse(text, dimension).is_ok_and(|q| range.contains(q.si))
                    }
                    (Required | Other(_), _) => true,
                    _ => false,
                };
                assert!(good, "{table}.{}: {:?}", key.name, key.default);
            }
        }
    }

    #[test]
    fn a_key_stands_once_in_a_table() {
        for Keys { table, keys, .. } in TABLES {
            let names: BTreeSet<_> = keys.iter().map(|key| key.name).collect();
            assert_eq!(names.len(), keys.len(), "{table}");
        }
    }

    #[test]
    fn the_book_has_these_keys() {
        // beside the workspace only: a package alone has no book
        let book = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/keys.md");
        if let Ok(text) = std::fs::read_to_string(book) {
            assert!(text.ends_with(&markdown()), "docs/keys.md is out of date:\n{}", markdown());
        }
    }
}
