//! Any two columns of a branch as a picture, and what axes call columns.

use super::chart::{Chart, DrawError};
use super::draw;
use study::case::{PictureCase, ProblemCase, ResolvedCase, catalogue, shown};
use study::record::view::{Curve, Examined, Mark};
use study::record::{Laboratory, Table, TraceResult, spoken};

/// Names of the picture of two columns, and of the same in physical units.
pub const COLUMNS: [&str; 2] = ["columns.svg", "columns-physical.svg"];

/// Whether a case asks for columns of its own.
pub(super) fn are_asked(picture: &PictureCase) -> bool {
    picture.x.column.is_some() || picture.y.column.is_some()
}

/// The title of an axis that shows a column of a case's branches.
pub(super) fn title(case: &ResolvedCase, table: &Table, column: &str) -> String {
    if let ProblemCase::Catalogue(_) = &case.problem {
        return named(case, column);
    }
    let label = match column {
        "z0" => return draw::DISTANCE.to_owned(),
        "deformation" => return draw::DEFORMATION.to_owned(),
        "force" if table.unit(column) == "sqrt(chi k_b)" => return draw::FORCE.to_owned(),
        _ => table.label(column),
    };
    let unit = match table.unit(column) {
        "" => return label.to_owned(),
        "R0" => "R₀",
        "R0^3" => "R₀³",
        "chi/R0" => "χ/R₀",
        "chi R0^2" => "χR₀²",
        "sqrt(chi k_b)" => "√(χk_{b})",
        "2e-6 pi chi R0" => "2·10^{−6} πχR₀",
        other => other,
    };
    format!("{label} [{unit}]")
}

/// The same in a physical unit.
pub(super) fn physical_title(table: &Table, column: &str, unit: &str) -> String {
    let label = match column {
        "z0" => "plate distance z₀",
        "deformation" => "deformation Δ",
        "force" => "force F",
        _ => table.label(column),
    };
    format!("{label} [{}]", spoken(unit))
}

/// What an axis calls the parameter or an observable of a problem of the catalogue: what the catalogue says, else
/// its name.
pub(super) fn named(case: &ResolvedCase, name: &str) -> String {
    let entry = catalogue().into_iter().find(|entry| entry.name == case.problem.name());
    let words = entry.and_then(|entry| entry.axes.into_iter().find(|(own, _)| own == name));
    words
        .map_or_else(|| letter(name).map_or_else(|| shown(name), str::to_owned), |(_, words)| words)
}

/// The Greek letter that a name spells.
fn letter(name: &str) -> Option<&'static str> {
    const LETTERS: [(&str, &str); 8] = [
        ("alpha", "α"),
        ("beta", "β"),
        ("gamma", "γ"),
        ("lambda", "λ"),
        ("mu", "μ"),
        ("nu", "ν"),
        ("rho", "ρ"),
        ("sigma", "σ"),
    ];
    LETTERS.into_iter().find(|(own, _)| *own == name).map(|(_, letter)| letter)
}

/// One column over another, with the special points; of losses of symmetry there are too many.
pub(super) fn curve(table: &Table, x: &str, y: &str, examined: Examined) -> Curve {
    let some = |name: &str| -> Vec<bool> {
        table.numbers(name).into_iter().map(|count| count > 0.0).collect()
    };
    let (xs, ys) = (table.numbers(x), table.numbers(y));
    let marks = table
        .words("event")
        .filter(|(_, kind)| *kind != "symmetry-breaking")
        .map(|(row, kind)| Mark { kind: kind.to_owned(), x: xs[row], y: ys[row] })
        .collect();
    let (antisymmetric, modes) = (some("unstable_antisymmetric"), some("unstable_modes"));
    let holds = |flags: &[bool], at: usize| flags.get(at).copied().unwrap_or(false);
    let asymmetric =
        (0..xs.len()).map(|at| holds(&antisymmetric, at) || holds(&modes, at)).collect();
    Curve {
        label: y.to_owned(),
        unstable: some("unstable"),
        asymmetric,
        examined,
        marks,
        x: xs,
        y: ys,
    }
}

/// The columns that a case asks for: where it names one only, the other is the picture's own.
pub(super) fn asked<'c>(
    picture: &'c PictureCase,
    parameter: &'c str,
    table: &'c Table,
) -> (&'c str, &'c str) {
    let first = table.columns().iter().map(String::as_str);
    let mut others = first.filter(|name| *name != "point" && *name != parameter);
    let usual = if table.columns().iter().any(|name| name == "force") {
        "force"
    } else {
        others.next().unwrap_or(parameter)
    };
    (picture.x.column.as_deref().unwrap_or(parameter), picture.y.column.as_deref().unwrap_or(usual))
}

/// The pictures of the columns that a case asks for: file name and SVG; none if it asks for none.
///
/// # Errors
/// When something is missing.
pub fn draw_columns(
    case: &ResolvedCase,
    result: &TraceResult,
) -> Result<Vec<(String, Vec<u8>)>, DrawError> {
    let picture = &case.picture;
    let mut files = Vec::new();
    if !are_asked(picture) {
        return Ok(files);
    }
    let table = &result.table;
    let (x, y) = asked(picture, &result.parameter, table);
    let examined = [&result.pictures.force_distance, &result.pictures.force_deformation];
    let examined = examined.into_iter().flatten().next().map(|curve| curve.examined);
    let own = curve(table, x, y, examined.unwrap_or_default());
    let heading = super::titled(&result.pictures.title, case);
    let titles = [title(case, table, x), title(case, table, y)];
    let chart = draw::along(&heading, &titles[0], &titles[1], &own);
    let svg = chart.with_axes(&picture.x, &picture.y).svg(picture)?;
    files.push((COLUMNS[0].to_owned(), svg.into_bytes()));
    if let Some(laboratory) = Laboratory::of(case, &[table]) {
        let of = |column: &str| match laboratory.convert(table.unit(column)) {
            Some((unit, factor)) => (physical_title(table, column, unit), factor),
            None => (title(case, table, column), 1.0),
        };
        let (x, y) = (of(x), of(y));
        let scaled = super::physical::scaled(&own, x.1, y.1);
        let chart = draw::along(&heading, &x.0, &y.0, &scaled);
        let svg = within(chart, picture, (x.1, y.1)).svg(picture)?;
        files.push((COLUMNS[1].to_owned(), svg.into_bytes()));
    }
    Ok(files)
}

/// The axes that a case asks for, whose ends are dimensionless, on a chart in other units.
pub(super) fn within(chart: Chart, picture: &PictureCase, (x, y): (f64, f64)) -> Chart {
    let times = |axis: &study::case::AxisCase, factor: f64| study::case::AxisCase {
        from: axis.from.map(|end| factor * end),
        to: axis.to.map(|end| factor * end),
        ..axis.clone()
    };
    chart.with_axes(&times(&picture.x, x), &times(&picture.y, y))
}
