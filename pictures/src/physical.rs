//! The pictures of a shell that is given in physical units, in the units of its laboratory.

use super::chart::DrawError;
use super::columns::{are_asked, within};
use super::draw;
use study::case::{ProblemCase, ResolvedCase};
use study::record::view::{Curve, Profile};
use study::record::{DiagramResult, Laboratory, Table, TraceResult, spoken};

/// Names of the pictures.
pub const PHYSICAL: [&str; 4] = [
    "force_deformation-physical.svg",
    "force_distance-physical.svg",
    "film_pressure-physical.svg",
    "energies-physical.svg",
];

/// The pictures of a trace with physical axes: file name and SVG; none of a case that is dimensionless.
///
/// # Errors
/// When something is missing.
pub fn draw_physical(
    case: &ResolvedCase,
    result: &TraceResult,
) -> Result<Vec<(String, Vec<u8>)>, DrawError> {
    let Some(laboratory) = Laboratory::of(case, &[&result.table]) else { return Ok(Vec::new()) };
    let of = |unit: &str| {
        let (name, factor) = laboratory.convert(unit).unwrap_or(("", 1.0));
        (spoken(name), factor)
    };
    let (length, force) = (of("R0"), of("sqrt(chi k_b)"));
    let energy = of("chi R0^2");
    let film = laboratory.convert("w0/delta_A").map(|(name, factor)| (spoken(name), factor));
    let pictures = &result.pictures;
    let title = super::titled(&pictures.title, case);
    let look = &case.picture;
    let mut files = Vec::new();
    let mut add = |name: &str, chart: super::chart::Chart| {
        chart.svg(look).map(|svg| files.push((name.to_owned(), svg.into_bytes())))
    };
    let deformation = format!("deformation Δ [{}]", length.0);
    let force_title = format!("force F [{}]", force.0);
    if let (ProblemCase::RingLoad(_), Some((angle, _, curve))) = (&case.problem, &pictures.diagram)
    {
        let (unit, factor) = of(result.table.unit("force"));
        let curve = scaled(curve, 1.0, factor);
        let chart = draw::along(&title, angle, &format!("force F [{unit}]"), &curve);
        let chart = if are_asked(look) { chart } else { within(chart, look, (1.0, factor)) };
        add(PHYSICAL_DIAGRAM, chart)?;
    }
    if let Some(curve) = &pictures.force_deformation {
        let curve = scaled(curve, length.1, force.1);
        add(PHYSICAL[0], draw::along(&title, &deformation, &force_title, &curve))?;
    }
    if let Some(curve) = &pictures.force_distance {
        let x = format!("plate distance z₀ [{}]", length.0);
        let curve = scaled(curve, length.1, force.1);
        let chart = draw::along(&title, &x, &force_title, &curve);
        let chart = if are_asked(look) { chart } else { within(chart, look, (length.1, force.1)) };
        add(PHYSICAL[1], chart)?;
    }
    if let (false, Some(film)) = (pictures.film_pressure.is_empty(), film) {
        let profile = |profile: &Profile| Profile {
            sigma: times(&profile.sigma, length.1),
            value: times(&profile.value, film.1),
            ..profile.clone()
        };
        let profiles: Vec<Profile> = pictures.film_pressure.iter().map(profile).collect();
        let titles = [
            format!("distance from the axis σ [{}]", length.0),
            format!("disjoining pressure Π [{}]", film.0),
        ];
        add(PHYSICAL[2], draw::pressure(&title, [&titles[0], &titles[1]], &profiles))?;
    }
    if !pictures.energies.is_empty() {
        let curves: Vec<Curve> =
            pictures.energies.iter().map(|curve| scaled(curve, length.1, energy.1)).collect();
        let energies = format!("energy U [{}]", energy.0);
        add(PHYSICAL[3], draw::curves(&title, &deformation, &energies, &curves))?;
    }
    Ok(files)
}

/// Name of the picture of a diagram in physical units.
pub const PHYSICAL_DIAGRAM: &str = "diagram-physical.svg";

/// The same of a whole diagram.
///
/// # Errors
/// When something is missing.
pub fn draw_physical_diagram(
    case: &ResolvedCase,
    result: &DiagramResult,
) -> Result<Vec<(String, Vec<u8>)>, DrawError> {
    let tables: Vec<&Table> = result.branches.iter().map(|branch| &branch.trace.table).collect();
    let Some(laboratory) = Laboratory::of(case, &tables) else { return Ok(Vec::new()) };
    let convert = |unit: &str| laboratory.convert(unit).unwrap_or(("", 1.0));
    let chart = super::diagram_chart(case, result, &convert);
    let asked = tables.first().map(|table| {
        let (x, y) = super::columns::asked(&case.picture, &result.parameter, table);
        (convert(table.unit(x)).1, convert(table.unit(y)).1)
    });
    let svg = within(chart, &case.picture, asked.unwrap_or((1.0, 1.0))).svg(&case.picture)?;
    Ok(vec![(PHYSICAL_DIAGRAM.to_owned(), svg.into_bytes())])
}

fn times(values: &[f64], factor: f64) -> Vec<f64> {
    values.iter().map(|value| factor * value).collect()
}

pub(super) fn scaled(curve: &Curve, x: f64, y: f64) -> Curve {
    let mut marks = curve.marks.clone();
    for mark in &mut marks {
        // as the curve's own points, to the last bit: they tell where stability changes
        (mark.x, mark.y) = (x * mark.x, y * mark.y);
    }
    Curve { x: times(&curve.x, x), y: times(&curve.y, y), marks, ..curve.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::ControlFlow;
    use study::case::{Override, load};
    use study::run::run_trace;

    #[test]
    fn a_physical_case_has_axes_of_its_laboratory() {
        let keys = ["mesh.elements=40", "path.end=1.0", "stability.scan=axisymmetric"];
        let case = load("polymer".as_ref(), &keys.map(Override::new), &[]).unwrap().case;
        let result = run_trace(&case, &mut |_| ControlFlow::Continue(())).unwrap();
        let files = draw_physical(&case, &result).unwrap();
        assert_eq!(files.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), PHYSICAL);
        let svg = |at: usize| String::from_utf8(files[at].1.clone()).unwrap();
        assert!(svg(0).contains("deformation Δ [nm]") && svg(0).contains("force F [nN]"));
        assert!(svg(2).contains("disjoining pressure Π [kPa]"));
        let plain = load("fig12".as_ref(), &[], &[]).unwrap().case;
        assert!(draw_physical(&plain, &result).unwrap().is_empty());
    }
}
