//! The picture of a map: curves of special points over the second parameter, and between folds the region in
//! which there are several states.

use super::chart::{Chart, DrawError, Entry};
use super::columns::named;
use super::draw::{self, DISTANCE};
use super::heading::titled;
use super::palette::SEVERAL;
use super::region;
use study::case::{AxisScale, ProblemCase, ResolvedCase};
use study::record::view::{Curve, Mark};
use study::record::{Laboratory, MapResult, spoken};

/// Name of the picture.
pub const MAP: &str = "map.svg";
/// Name of the same in physical units.
pub const PHYSICAL_MAP: &str = "map-physical.svg";

/// The map of a case as SVG, the first parameter over the second, one colour for each kind of curve; of a case in
/// physical units once more in those.
///
/// # Errors
/// When the drawing library fails.
pub fn draw_map(
    case: &ResolvedCase,
    result: &MapResult,
) -> Result<Vec<(String, Vec<u8>)>, DrawError> {
    let y = match result.parameter.as_str() {
        "z0" => DISTANCE.to_owned(),
        "alpha" => "contact angle α (degrees)".to_owned(),
        "base" => "base of the cantilever/R₀".to_owned(),
        other => named(case, other),
    };
    let x = match result.key.as_str() {
        key if !matches!(result.parameter.as_str(), "z0" | "alpha" | "base") => &named(case, key),
        "adhesion" => "adhesion w₀/χ",
        "bending" => "bending stiffness k_{b}/(χR₀²)",
        "pressure" => "ambient pressure P_{A}R₀/χ",
        "film" => "film length δ_{A}/R₀",
        "adhesion_top" => "adhesion of the upper plate w₀/χ",
        "film_top" => "film length of the upper plate δ_{A}/R₀",
        "adhesion_bottom" => "adhesion of the lower plate w₀/χ",
        "film_bottom" => "film length of the lower plate δ_{A}/R₀",
        "surface_tension" => "surface tension γ_{BW}/χ",
        "gas_exponent" => "gas exponent γ",
        "poisson" => "Poisson's ratio ν",
        "b" => "share b of Mooney-Rivlin's law",
        "moment" => "moment at the ring m/(χR₀²)",
        other => other,
    };
    let svg = chart(case, result, [x, &y], (1.0, 1.0)).svg(&case.picture)?;
    let mut files = vec![(MAP.to_owned(), svg.into_bytes())];
    if let Some((x, y, factors)) = physical(case, result) {
        let svg = chart(case, result, [&x, &y], factors).svg(&case.picture)?;
        files.push((PHYSICAL_MAP.to_owned(), svg.into_bytes()));
    }
    Ok(files)
}

/// Titles of the axes in physical units, and what numbers must be multiplied with.
fn physical(case: &ResolvedCase, result: &MapResult) -> Option<(String, String, (f64, f64))> {
    let tables: Vec<_> = result.curves.iter().map(|curve| &curve.table).collect();
    let laboratory = Laboratory::of(case, &tables)?;
    let table = tables.first()?;
    let words = match result.key.as_str() {
        "adhesion" => "adhesion w₀",
        "surface_tension" => "surface tension γ_{BW}",
        "bending" => "bending stiffness k_{b}",
        "pressure" => "ambient pressure P_{A}",
        "film" => "film length δ_{A}",
        "adhesion_top" => "adhesion of the upper plate w₀",
        "adhesion_bottom" => "adhesion of the lower plate w₀",
        "film_top" => "film length of the upper plate δ_{A}",
        "film_bottom" => "film length of the lower plate δ_{A}",
        _ => return None,
    };
    let (unit, x) = laboratory.convert(table.unit(&result.key))?;
    let (length, y) = laboratory.convert("R0")?;
    let first = match result.parameter.as_str() {
        "base" => format!("base of the cantilever [{}]", spoken(length)),
        _ => format!("plate distance z₀ [{}]", spoken(length)),
    };
    Some((format!("{words} [{}]", spoken(unit)), first, (x, y)))
}

fn chart(case: &ResolvedCase, result: &MapResult, titles: [&str; 2], (x, y): (f64, f64)) -> Chart {
    let times = |values: &[f64], factor: f64| -> Vec<f64> {
        values.iter().map(|value| factor * value).collect()
    };
    let mut curves: Vec<Curve> = Vec::new();
    for curve in &result.curves {
        let (second, first) = (times(&curve.second, x), times(&curve.first, y));
        match curves.iter_mut().find(|known| known.label == curve.kind) {
            Some(known) => {
                // a gap between curves of a kind
                known.x.push(f64::NAN);
                known.y.push(f64::NAN);
                known.x.extend(second);
                known.y.extend(first);
            }
            None => {
                let label = curve.kind.clone();
                curves.push(Curve { label, x: second, y: first, ..Curve::default() });
            }
        }
    }
    if let Some(last) = curves.last_mut() {
        let mark = |point: &study::record::MapPoint| Mark {
            kind: point.kind.clone(),
            x: x * point.second,
            y: y * point.first,
        };
        last.marks = result.points.iter().map(mark).collect();
    }
    let mut picture = case.picture.clone();
    for (axis, factor) in [(&mut picture.x, x), (&mut picture.y, y)] {
        for end in [&mut axis.from, &mut axis.to] {
            *end = end.map(|end| factor * end);
        }
    }
    let own = value(case, &result.key).map(|value| x * value);
    // one of the numbers varies: what follows are those of the case, which has a line of its own
    let heading = titled(&result.case, case).replacen('\n', "\nthis case: ", 1);
    let mut chart = draw::plane(&heading, titles, &curves, own, &picture);
    // the branch comes from where its path starts, with one state
    let folds: Vec<Vec<(f64, f64)>> = result
        .curves
        .iter()
        .filter(|curve| curve.kind == "fold")
        .map(|curve| {
            let points = curve.second.iter().zip(&curve.first);
            points.map(|(a, b)| (chart.x.place(x * a), chart.y.place(y * b))).collect()
        })
        .collect();
    let path = [case.path.start, case.path.end].map(|end| chart.y.place(y * end));
    let regions = region::several(&folds, (chart.x.low, chart.x.high), (path[0], path[1]));
    if !regions.is_empty() && picture.y.scale != AxisScale::Logarithmic {
        chart.regions = regions.into_iter().map(|outline| (outline, SEVERAL)).collect();
        let label = "several states: hysteresis".to_owned();
        chart.legend.push(Entry::Tile { color: SEVERAL, label });
    }
    chart
}

/// The value of a key in the case.
fn value(case: &ResolvedCase, key: &str) -> Option<f64> {
    match &case.problem {
        ProblemCase::Contact(contact) => match key {
            "adhesion" => Some(contact.groups.adhesion),
            "bending" => Some(contact.groups.bending),
            "pressure" => Some(contact.groups.pressure),
            "film" => Some(contact.groups.film),
            "surface_tension" => Some(contact.groups.surface_tension),
            "gas_exponent" => Some(contact.groups.gas_exponent),
            "poisson" => Some(contact.shell.poisson),
            "b" => contact.shell.law.b(),
            _ => None,
        },
        ProblemCase::RingLoad(ring) => match key {
            "bending" => Some(ring.groups.bending),
            "pressure" => Some(ring.groups.pressure),
            "gas_exponent" => Some(ring.groups.gas_exponent),
            "poisson" => Some(ring.shell.poisson),
            "b" => ring.shell.law.b(),
            _ => None,
        },
        ProblemCase::TwoPlates(plates) => match (key, plates.plates) {
            ("bending", _) => Some(plates.bending),
            ("pressure", _) => Some(plates.pressure),
            ("surface_tension", _) => Some(plates.surface_tension),
            ("gas_exponent", _) => Some(plates.gas_exponent),
            ("poisson", _) => Some(plates.shell.poisson),
            ("b", _) => plates.shell.law.b(),
            ("adhesion_top", [Some(plate), _]) | ("adhesion_bottom", [_, Some(plate)]) => {
                Some(plate.adhesion)
            }
            ("film_top", [Some(plate), _]) | ("film_bottom", [_, Some(plate)]) => Some(plate.film),
            _ => None,
        },
        ProblemCase::Catalogue(problem) => problem.parameters.get(key).copied(),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::ControlFlow;
    use study::case::{catalogue, load};
    use study::run::run_map;

    #[test]
    fn a_map_shows_where_its_case_is() {
        let case = load("cusp".as_ref(), &[], &catalogue()).unwrap().case;
        let map = run_map(&case, "lambda", &mut |_| ControlFlow::Continue(())).unwrap();
        let files = draw_map(&case, &map).unwrap();
        assert_eq!(files.len(), 1, "it is dimensionless");
        let svg = String::from_utf8(files[0].1.clone()).unwrap();
        assert!(svg.contains("hysteresis") && svg.contains(">parameter μ<"), "{svg}");
        assert!(svg.contains(">this case<") && svg.contains(">fold<"), "{svg}");
        // the parameter that varies is that of the case in the title, and said to be
        assert!(svg.contains("this case: "), "{svg}");
    }
}
