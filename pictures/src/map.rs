//! The picture of a map: curves of special points over the second parameter.

use super::chart::DrawError;
use super::draw::{self, DISTANCE};
use super::heading::titled;
use study::case::{Law, ProblemCase, ResolvedCase};
use study::record::MapResult;
use study::record::view::{Curve, Mark};

/// Name of the picture.
pub const MAP: &str = "map.svg";

/// The map of a case as SVG: the first parameter over the second, one colour for each kind of curve.
///
/// # Errors
/// When the drawing library fails.
pub fn draw_map(case: &ResolvedCase, result: &MapResult) -> Result<String, DrawError> {
    let mut curves: Vec<Curve> = Vec::new();
    for curve in &result.curves {
        match curves.iter_mut().find(|known| known.label == curve.kind) {
            Some(known) => {
                // a gap between curves of a kind
                known.x.push(f64::NAN);
                known.y.push(f64::NAN);
                known.x.extend_from_slice(&curve.second);
                known.y.extend_from_slice(&curve.first);
            }
            None => curves.push(Curve {
                label: curve.kind.clone(),
                x: curve.second.clone(),
                y: curve.first.clone(),
                ..Curve::default()
            }),
        }
    }
    if let Some(last) = curves.last_mut() {
        last.marks = result
            .points
            .iter()
            .map(|point| Mark { kind: point.kind.clone(), x: point.second, y: point.first })
            .collect();
    }
    let y = match result.parameter.as_str() {
        "z0" => DISTANCE,
        "alpha" => "contact angle α (degrees)",
        other => other,
    };
    let x = match result.key.as_str() {
        _ if !matches!(result.parameter.as_str(), "z0" | "alpha") => &result.key,
        "adhesion" => "adhesion w₀/χ",
        "bending" => "bending stiffness k_{b}/(χR₀²)",
        "pressure" => "ambient pressure P_{A}R₀/χ",
        "film" => "film length δ_{A}/R₀",
        "surface_tension" => "surface tension γ_{BW}/χ",
        "gas_exponent" => "gas exponent γ",
        "poisson" => "Poisson's ratio ν",
        "b" => "share b of Mooney-Rivlin's law",
        "moment" => "moment at the ring m/(χR₀²)",
        other => other,
    };
    let own = value(case, &result.key);
    draw::plane(&titled(&result.case, case), x, y, &curves, own)
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
            "b" => match contact.shell.law {
                Law::MooneyRivlin { b } => Some(b),
                Law::Hooke | Law::Skalak => None,
            },
            _ => None,
        },
        ProblemCase::RingLoad(ring) => match key {
            "bending" => Some(ring.bending),
            "pressure" => Some(ring.pressure),
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
        let svg = draw_map(&case, &map).unwrap();
        assert!(svg.contains(">this case<") && svg.contains(">fold<"), "{svg}");
    }
}
