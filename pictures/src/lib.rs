//! Pictures of a branch as SVG: plain data in, text out.
//!
//! Stable parts are solid, unstable parts dashed, parts that are unstable to asymmetric modes only
//! dotted; on a curve that is alone these have a colour of their own, and lie on top. A quantity has one
//! colour in every picture, and so has a state whose shape and film pressure are shown. Special points
//! have their short names beside them ([`labels`]). All text is written by one engine, which sets small
//! letters below and above the line.

mod axis;
mod chart;
mod cycle;
mod draw;
pub mod fit;
mod heading;
mod label;
mod map;
mod orbits;
mod page;
mod palette;
mod path;
mod phase;
mod physical;
pub mod results;
mod sheet;
mod text;

#[cfg(test)]
mod tests;

pub use chart::DrawError;
pub use cycle::{LOOP, draw_cycle};
pub use heading::titled;
pub use label::labels;
pub use map::{MAP, draw_map};
pub use orbits::{ORBITS, PERIOD, draw_orbits};
pub use page::{REPORT, cycle_report, report};
pub use phase::{PHASE, draw_phase};
pub use physical::{PHYSICAL, draw_physical};
pub use sheet::{BOLD, FAMILY, FONT, Ink, Panel, PanelLine, Pen, PngError, Sheet, png};
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
    let curves: Vec<(Level, &Curve)> =
        result.branches.iter().map(|branch| (level(branch), &branch.curve)).collect();
    let (x, y) = &result.axes;
    let extrema = result.branches.iter().any(|branch| branch.orbits.is_some());
    let y = if extrema { format!("{y}; of cycles maximum and minimum") } else { y.clone() };
    draw::branches(&titled(&result.title(), case), x, &y, &curves)
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
pub fn draw_all(pictures: &Pictures) -> Result<Vec<(String, Vec<u8>)>, DrawError> {
    let title = pictures.title.as_str();
    let mut files = Vec::new();
    let mut add = |name: &str, svg: String| files.push((name.to_string(), svg.into_bytes()));
    if let Some(curve) = &pictures.force_deformation {
        add(NAMES[0], draw::force_deformation(title, curve)?);
    }
    if let Some(curve) = &pictures.force_distance {
        add(NAMES[1], draw::force_distance(title, curve)?);
    }
    if !pictures.shapes.is_empty() {
        add(NAMES[2], draw::shapes(title, &pictures.shapes)?);
    }
    if !pictures.film_pressure.is_empty() {
        add(NAMES[3], draw::film_pressure(title, &pictures.film_pressure)?);
    }
    if !pictures.energies.is_empty() {
        add(NAMES[4], draw::energies(title, &pictures.energies)?);
    }
    if let Some((x, y, curve)) = &pictures.diagram {
        add(NAMES[5], draw::diagram(title, x, y, curve)?);
    }
    Ok(files)
}
