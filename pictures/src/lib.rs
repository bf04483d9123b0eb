//! Pictures of a branch as SVG: plain data in, text out.
//!
//! Stable parts are solid, unstable parts dashed, parts that are unstable to asymmetric modes only
//! dotted; on a curve that is alone these have a colour of their own, and lie on top. A quantity has one
//! colour in every picture, and so has a state whose shape and film pressure are shown. Special points
//! have their short names beside them ([`labels`]). All text is written by one engine, which sets small
//! letters below and above the line.

mod axis;
mod chart;
mod columns;
mod cycle;
mod detail;
mod draw;
mod drawing;
pub mod fit;
mod heading;
mod label;
mod look;
mod map;
mod marker;
mod orbits;
mod page;
mod palette;
mod path;
mod phase;
mod physical;
mod region;
pub mod results;
mod sheet;
mod text;

#[cfg(test)]
mod tests;

pub use chart::DrawError;
pub use columns::{COLUMNS, draw_columns};
pub use cycle::{LOOP, PHYSICAL_LOOP, draw_cycle};
pub use heading::titled;
pub use label::labels;
pub use map::{MAP, PHYSICAL_MAP, draw_map};
pub use orbits::{ORBITS, PERIOD, draw_orbits};
pub use page::{REPORT, cycle_report, report};
pub use phase::{PHASE, draw_phase};
pub use physical::{PHYSICAL, PHYSICAL_DIAGRAM, draw_physical, draw_physical_diagram};
pub use sheet::{BOLD, DrawingError, FAMILY, FONT, Ink, Panel, PanelLine, Pen, Sheet, pdf, png};
pub use text::escape;

use draw::Level;
use study::case::ResolvedCase;
use study::record::view::Curve;
use study::record::{BranchRecord, DiagramResult, Pictures};

/// Names of all pictures that a trace may write.
pub const NAMES: [&str; 6] = [
    "force_deformation.svg",
    "force_distance.svg",
    "shapes.svg",
    "film_pressure.svg",
    "energies.svg",
    "diagram.svg",
];

/// Name of the picture of a whole diagram.
pub const DIAGRAM: &str = "diagram.svg";

/// All branches of a diagram of a case as SVG.
///
/// # Errors
/// When the drawing library fails.
pub fn draw_diagram(case: &ResolvedCase, result: &DiagramResult) -> Result<String, DrawError> {
    let picture = &case.picture;
    let chart = diagram_chart(case, result, &|_| ("", 1.0));
    chart.with_axes(&picture.x, &picture.y).svg(picture)
}

/// The chart of a diagram, in units that stand for the dimensionless ones of columns; `""` for those themselves.
fn diagram_chart(
    case: &ResolvedCase,
    result: &DiagramResult,
    convert: &dyn Fn(&str) -> (&'static str, f64),
) -> chart::Chart {
    let picture = &case.picture;
    let first = result.branches.first().map(|branch| &branch.trace.table);
    let asked = first.map(|table| columns::asked(picture, &result.parameter, table));
    let own = columns::are_asked(picture);
    let curves: Vec<(Level, Curve)> = result
        .branches
        .iter()
        .map(|branch| match asked {
            // of cycles there are extrema of one observable only
            Some((x, y)) if own && branch.orbits.is_none() => {
                let table = &branch.trace.table;
                (level(branch), columns::curve(table, x, y, branch.curve.examined))
            }
            _ => (level(branch), branch.curve.clone()),
        })
        .filter(|(level, _)| !own || !matches!(level, Level::Cycles(_)))
        .collect();
    let extrema = curves.iter().any(|(level, _)| matches!(level, Level::Cycles(_)));
    let (x, y) = match (asked, first) {
        (Some((x, y)), Some(table)) if own => {
            (columns::title(case, table, x), columns::title(case, table, y))
        }
        _ => (columns::named(case, &result.axes.0), columns::named(case, &result.axes.1)),
    };
    let y = if extrema { format!("{y}; of cycles maximum and minimum") } else { y };
    let of = |column: Option<&str>, title: String| match (column, first) {
        (Some(column), Some(table)) => match convert(table.unit(column)) {
            ("", _) => (title, 1.0),
            (unit, factor) => (columns::physical_title(table, column, unit), factor),
        },
        _ => (title, 1.0),
    };
    let (x, y) = (of(asked.map(|(x, _)| x), x), of(asked.map(|(_, y)| y), y));
    let curves: Vec<(Level, Curve)> = curves
        .into_iter()
        .map(|(level, curve)| (level, physical::scaled(&curve, x.1, y.1)))
        .collect();
    let curves: Vec<(Level, &Curve)> =
        curves.iter().map(|(level, curve)| (*level, curve)).collect();
    draw::branches(&titled(&result.title(), case), &x.0, &y.0, &curves)
}

fn level(branch: &BranchRecord) -> Level {
    match branch.is_asymmetric() {
        _ if branch.orbits.is_some() => Level::Cycles(branch.depth),
        true => Level::Asymmetric,
        false => Level::Depth(branch.depth),
    }
}

/// All pictures for which there are data: file name and SVG.
///
/// # Errors
/// When the drawing library fails.
pub fn draw_all(
    case: &ResolvedCase,
    pictures: &Pictures,
) -> Result<Vec<(String, Vec<u8>)>, DrawError> {
    let title = titled(&pictures.title, case);
    let look = &case.picture;
    let mut files = Vec::new();
    let mut add = |name: &str, chart: chart::Chart| {
        chart.svg(look).map(|svg| files.push((name.to_string(), svg.into_bytes())))
    };
    // axes that a case asks for are those of the columns that it names, where it names some
    let main = |chart: chart::Chart| match columns::are_asked(look) {
        true => chart,
        false => chart.with_axes(&look.x, &look.y),
    };
    if let Some(curve) = &pictures.force_deformation {
        add(NAMES[0], draw::along(&title, draw::DEFORMATION, draw::FORCE, curve))?;
    }
    if let Some(curve) = &pictures.force_distance {
        add(NAMES[1], main(draw::along(&title, draw::DISTANCE, draw::FORCE, curve)))?;
    }
    if !pictures.shapes.is_empty() {
        add(NAMES[2], draw::shapes(&title, &pictures.shapes, look))?;
    }
    if !pictures.film_pressure.is_empty() {
        add(NAMES[3], draw::film_pressure(&title, &pictures.film_pressure))?;
    }
    if !pictures.energies.is_empty() {
        add(NAMES[4], draw::energies(&title, &pictures.energies))?;
    }
    if let Some((x, y, curve)) = &pictures.diagram {
        let (x, y) = (columns::named(case, x), columns::named(case, y));
        add(NAMES[5], main(draw::along(&title, &x, &y, curve)))?;
    }
    Ok(files)
}
