//! How pictures of a case look: the table `[picture]`, which every command that draws obeys.

use super::document::{self, Override};
use super::error::{CaseError, Complaint, LoadError};
use super::key::count;
use super::keys::{Absent, Key, Kind, Range, key, names, number};
use super::reader::{Reader, Section};
use super::resolve::{HOMES, Resolver};
use super::write::Lines;
use crate::closest::closest;

/// How an axis is divided.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum AxisScale {
    /// As suits the picture.
    #[default]
    Automatic,
    /// Equal steps.
    Linear,
    /// Equal factors.
    Logarithmic,
}

impl AxisScale {
    const NAMES: [&'static str; 3] = ["automatic", "linear", "logarithmic"];
    const ALL: [AxisScale; 3] = [AxisScale::Automatic, AxisScale::Linear, AxisScale::Logarithmic];

    fn name(self) -> &'static str {
        let at = AxisScale::ALL.iter().position(|own| *own == self);
        AxisScale::NAMES[at.unwrap_or(0)]
    }
}

/// One axis of the main picture.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct AxisCase {
    /// The column that it shows; the picture's own without it.
    pub column: Option<String>,
    /// Where it begins.
    pub from: Option<f64>,
    /// Where it ends.
    pub to: Option<f64>,
    /// How it is divided.
    pub scale: AxisScale,
}

/// Parts of a picture that may be left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parts {
    /// Title and the line below it.
    pub title: bool,
    /// The legend.
    pub legend: bool,
    /// The grid.
    pub grid: bool,
    /// Special points.
    pub marks: bool,
    /// Their names.
    pub names: bool,
    /// What is unstable.
    pub unstable: bool,
    /// Enlarged details.
    pub inset: bool,
}

/// How pictures look.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureCase {
    /// Width of the plotting area in pixels; the picture's own without it.
    pub width: Option<usize>,
    /// Height of the plotting area in pixels.
    pub height: Option<usize>,
    /// Size of the letters at ticks and in the legend, in pixels; others go with it.
    pub font_size: f64,
    /// Width of curves in pixels.
    pub line_width: f64,
    /// The horizontal axis of the main picture.
    pub x: AxisCase,
    /// Its vertical axis.
    pub y: AxisCase,
    /// What is drawn.
    pub parts: Parts,
}

impl Default for PictureCase {
    fn default() -> Self {
        PictureCase {
            width: None,
            height: None,
            font_size: FONT_SIZE_DEFAULT,
            line_width: LINE_WIDTH_DEFAULT,
            x: AxisCase::default(),
            y: AxisCase::default(),
            parts: Parts {
                title: true,
                legend: true,
                grid: true,
                marks: true,
                names: true,
                unstable: true,
                inset: true,
            },
        }
    }
}

const FONT_SIZE_DEFAULT: f64 = 14.0;
const LINE_WIDTH_DEFAULT: f64 = 2.0;
const OWN: Absent = Absent::Other("the picture's own");
const FONT_SIZES: Range = Range { holds: |x| (6.0..=60.0).contains(&x), words: "from 6 to 60" };
const LINE_WIDTHS: Range = Range { holds: |x| (0.2..=20.0).contains(&x), words: "from 0.2 to 20" };

const WIDTH: Key =
    count("width", 150, 4000, Absent::Count(620), "Width of the plotting area, in pixels");
const HEIGHT: Key = Key {
    name: "height",
    default: Absent::Count(440),
    help: "Its height, in pixels; shapes keep their proportions",
    ..WIDTH
};
const FONT_SIZE: Key = number(
    "font_size",
    FONT_SIZES,
    "pixels",
    Absent::Number(FONT_SIZE_DEFAULT),
    "Size of the letters at ticks and in the legend; titles and markers go with it",
);
const LINE_WIDTH: Key = number(
    "line_width",
    LINE_WIDTHS,
    "pixels",
    Absent::Number(LINE_WIDTH_DEFAULT),
    "Width of curves",
);
const X: Key = key(
    "x",
    Kind::Text("a column of the branch"),
    "",
    OWN,
    "Column of the horizontal axis: a trace then draws columns.svg beside its other pictures, a diagram its picture",
);
const Y: Key = Key { name: "y", help: "Column of the vertical axis, likewise", ..X };
const X_FROM: Key = number(
    "x_from",
    super::keys::ANY,
    "the axis' own",
    Absent::Other("all data"),
    "Where the horizontal axis of the main picture begins",
);
const X_TO: Key = Key { name: "x_to", help: "Where it ends", ..X_FROM };
const Y_FROM: Key =
    Key { name: "y_from", help: "Where the vertical axis of the main picture begins", ..X_FROM };
const Y_TO: Key = Key { name: "y_to", help: "Where it ends", ..X_FROM };
const X_SCALE: Key = key(
    "x_scale",
    Kind::Word(&AxisScale::NAMES),
    "",
    Absent::Word(AxisScale::NAMES[0]),
    "How the horizontal axis of the main picture is divided",
);
const Y_SCALE: Key = Key { name: "y_scale", help: "How its vertical axis is divided", ..X_SCALE };

const fn part(name: &'static str, help: &'static str) -> Key {
    key(name, Kind::Flag, "", Absent::Flag(true), help)
}
const PARTS: [Key; 7] = [
    part("title", "Whether pictures have their titles"),
    part("legend", "Whether they have legends"),
    part("grid", "Whether they have grids"),
    part("marks", "Whether special points are drawn"),
    part("names", "Whether special points have their names"),
    part("unstable", "Whether what is unstable is drawn"),
    part("inset", "Whether details that are too small to be seen are enlarged beside the picture"),
];

/// The table `[picture]`.
pub(super) const KEYS: [Key; 19] = super::key::joined(
    [WIDTH, HEIGHT, FONT_SIZE, LINE_WIDTH, X, Y, X_FROM, X_TO, Y_FROM, Y_TO, X_SCALE, Y_SCALE],
    PARTS,
);
/// Its names.
pub(super) const NAMES: &[&str] = &names(&KEYS);

/// Columns of shells between plates that an axis may show.
pub(crate) const PLATES: [&str; 14] = [
    "z0",
    "deformation",
    "force",
    "unstable",
    "pole_height",
    "gas_pressure",
    "volume",
    "energy_total",
    "energy_stretching",
    "energy_bending",
    "energy_film",
    "energy_gas",
    "energy_surface",
    "contact_radius",
];
/// Columns of shells under a ring load that an axis may show.
pub(crate) const RING: &[&str] = &[
    "alpha",
    "deflection_over_h",
    "force",
    "unstable",
    "pole_height",
    "ring_height",
    "energy_total",
];

impl Resolver<'_> {
    /// The table `[picture]` of a problem whose branches have these columns.
    pub(super) fn picture(&self, columns: &[&str]) -> Option<PictureCase> {
        picture(self.reader, self.table("picture", NAMES), Some(columns))
    }
}

/// Without `columns`, the axes of what is drawn have no columns to choose.
fn picture(reader: &Reader, section: Section<'_>, columns: Option<&[&str]>) -> Option<PictureCase> {
    let default = PictureCase::default();
    let size = |key: &Key| match section.get(key.name) {
        None => Some(None),
        Some(_) => {
            let (least, most) = key.bounds();
            reader.count(section, key.name, least, most).map(Some)
        }
    };
    let real = |key: &Key| match section.get(key.name) {
        None => Some(None),
        Some(_) => reader.number(section, key.name, key.range()).map(Some),
    };
    let flag = |key: &Key| match section.get(key.name) {
        None => Some(true),
        Some(_) => reader.flag(section, key.name),
    };
    let [title, legend, grid, marks, names, unstable, inset] = PARTS.map(|key| flag(&key));
    let (width, height) = (size(&WIDTH), size(&HEIGHT));
    let (font_size, line_width) = (real(&FONT_SIZE), real(&LINE_WIDTH));
    let axis = |[column, from, to, scale]: [&Key; 4]| {
        let column = match section.get(column.name) {
            None => Some(None),
            Some(_) => chosen(reader, section, column.name, columns).map(Some),
        };
        let word = match section.get(scale.name) {
            None => Some(AxisScale::NAMES[0]),
            Some(_) => reader.word(section, scale.name, &AxisScale::NAMES),
        };
        let (low, high) = (real(from), real(to));
        let at = AxisScale::NAMES.iter().position(|name| Some(*name) == word)?;
        let scale = AxisScale::ALL[at];
        if let (Some(Some(low)), Some(Some(high)), Some(node)) = (low, high, section.get(to.name))
            && low >= high
        {
            let allowed = format!("greater than picture.{}, which is {low:?}", from.name);
            reader.refuse(section, to.name, node, Complaint::OutOfRange { allowed });
        }
        for (key, value) in [(from, low), (to, high)] {
            if let (AxisScale::Logarithmic, Some(Some(value)), Some(node)) =
                (scale, value, section.get(key.name))
                && value <= 0.0
            {
                let allowed = "positive on a logarithmic axis".to_owned();
                reader.refuse(section, key.name, node, Complaint::OutOfRange { allowed });
            }
        }
        Some(AxisCase { column: column?, from: low?, to: high?, scale })
    };
    let (x, y) = (axis([&X, &X_FROM, &X_TO, &X_SCALE]), axis([&Y, &Y_FROM, &Y_TO, &Y_SCALE]));
    Some(PictureCase {
        width: width?,
        height: height?,
        font_size: font_size?.unwrap_or(default.font_size),
        line_width: line_width?.unwrap_or(default.line_width),
        x: x?,
        y: y?,
        parts: Parts {
            title: title?,
            legend: legend?,
            grid: grid?,
            marks: marks?,
            names: names?,
            unstable: unstable?,
            inset: inset?,
        },
    })
}

/// A column, which must be one of those that there are.
fn chosen(
    reader: &Reader,
    section: Section<'_>,
    key: &str,
    columns: Option<&[&str]>,
) -> Option<String> {
    let word = reader.text(section, key)?;
    let node = section.get(key)?;
    let why = match columns {
        Some(columns) if columns.contains(&word) => return Some(word.to_owned()),
        Some(columns) => Complaint::UnknownWord {
            allowed: columns.iter().map(ToString::to_string).collect(),
            suggestion: closest(word, columns.iter().copied()).map(str::to_owned),
        },
        None => Complaint::Conflict("these pictures have axes of their own".to_owned()),
    };
    reader.refuse(section, key, node, why);
    None
}

/// The look of pictures that belong to no single case, from `picture.KEY=VALUE` alone.
///
/// # Errors
/// Everything that is wrong with them.
pub fn picture_of(overrides: &[Override]) -> Result<PictureCase, LoadError> {
    let tree = document::parse("pictures", "", overrides)?;
    let reader = Reader::new("pictures");
    let root = Section::root(&tree);
    reader.only(root, &["picture"], HOMES);
    let section = reader.section(root, "picture");
    reader.only(section, NAMES, HOMES);
    match picture(&reader, section, None) {
        Some(picture) if reader.has_no_errors() => Ok(picture),
        _ => Err(LoadError::from(reader.into_errors())),
    }
}

impl From<Vec<CaseError>> for LoadError {
    fn from(errors: Vec<CaseError>) -> Self {
        LoadError::Invalid(errors)
    }
}

/// What differs from the default.
pub(super) fn write(out: &mut Lines, picture: &PictureCase) {
    let default = PictureCase::default();
    if *picture == default {
        return;
    }
    out.table("picture");
    for (key, size) in [(&WIDTH, picture.width), (&HEIGHT, picture.height)] {
        if let Some(size) = size {
            out.count(key.name, size);
        }
    }
    out.number(FONT_SIZE.name, picture.font_size);
    out.number(LINE_WIDTH.name, picture.line_width);
    let axes = [
        (&picture.x, [&X, &X_FROM, &X_TO, &X_SCALE]),
        (&picture.y, [&Y, &Y_FROM, &Y_TO, &Y_SCALE]),
    ];
    for (axis, [column, from, to, scale]) in axes {
        if let Some(name) = &axis.column {
            out.text(column.name, name);
        }
        for (key, value) in [(from, axis.from), (to, axis.to)] {
            if let Some(value) = value {
                out.number(key.name, value);
            }
        }
        out.text(scale.name, axis.scale.name());
    }
    let Parts { title, legend, grid, marks, names, unstable, inset } = picture.parts;
    let values = [title, legend, grid, marks, names, unstable, inset];
    for (key, value) in PARTS.iter().zip(values) {
        out.line(&format!("{} = {value}", key.name));
    }
}
