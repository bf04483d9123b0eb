//! The pictures of periodic orbits: the period over the parameter, and some cycles over time and in the
//! plane of two observables.

use super::axis::Axis;
use super::chart::{Chart, DrawError, Entry};
use super::columns::named;
use super::draw::{WIDE, branches, curve_lines, of_one_state, state_entry, values};
use super::heading::titled;
use super::palette::of_state;
use study::case::{ResolvedCase, shown};
use study::record::view::{Curve, Stability};
use study::record::{BranchRecord, DiagramResult, OrbitRecord, OrbitsRecord};

/// Name of the chart of periods.
pub const PERIOD: &str = "period.svg";
/// Names of the pictures of cycles, with a `*` for the number of the branch.
pub const ORBITS: [&str; 2] = ["time-*.svg", "phase-*.svg"];

/// As many cycles as there are colours.
const MOST: usize = 7;

/// All pictures of the periodic orbits of a diagram: file name and SVG.
///
/// # Errors
/// When the drawing library fails.
pub fn draw_orbits(
    case: &ResolvedCase,
    result: &DiagramResult,
) -> Result<Vec<(String, Vec<u8>)>, DrawError> {
    let look = &case.picture;
    let mut files = Vec::new();
    let with: Vec<(&BranchRecord, &OrbitsRecord)> = result
        .branches
        .iter()
        .filter_map(|branch| branch.orbits.as_ref().map(|orbits| (branch, orbits)))
        .collect();
    if with.is_empty() {
        return Ok(files);
    }
    let curves: Vec<_> =
        with.iter().map(|(branch, orbits)| (super::level(branch), &orbits.period)).collect();
    let parameter = named(case, &result.parameter);
    let svg = branches(&titled(&result.title(), case), &parameter, "period", &curves).svg(look)?;
    files.push((PERIOD.to_owned(), svg.into_bytes()));
    for (branch, orbits) in with {
        let Some(first) = orbits.names.first() else { continue };
        let title = format!("{}: branch {}", result.case, branch.id);
        let shown = some(&orbits.orbits);
        let over_time: Vec<Curve> = shown.iter().map(|orbit| curve(&orbit.t, orbit, 0)).collect();
        let (x, y) = (named(case, first), orbits.names.get(1).map(|name| named(case, name)));
        let svg = cycles(&title, ["time t", &x], &shown, &over_time).svg(look)?;
        files.push((ORBITS[0].replace('*', &branch.id.to_string()), svg.into_bytes()));
        let Some(y) = y else { continue };
        let plane: Vec<Curve> =
            shown.iter().map(|orbit| curve(&orbit.values[0], orbit, 1)).collect();
        let svg = cycles(&title, [&x, &y], &shown, &plane).svg(look)?;
        files.push((ORBITS[1].replace('*', &branch.id.to_string()), svg.into_bytes()));
    }
    Ok(files)
}

/// At most as many cycles as there are colours, from the first to the last.
fn some(orbits: &[OrbitRecord]) -> Vec<&OrbitRecord> {
    if orbits.len() <= MOST {
        return orbits.iter().collect();
    }
    (0..MOST).map(|k| &orbits[k * (orbits.len() - 1) / (MOST - 1)]).collect()
}

fn curve(x: &[f64], orbit: &OrbitRecord, observable: usize) -> Curve {
    let y = orbit.values.get(observable).cloned().unwrap_or_default();
    Curve { x: x.to_vec(), y, ..of_one_state(stability(orbit), x.len()) }
}

fn stability(orbit: &OrbitRecord) -> Stability {
    Stability::of(orbit.unstable == Some(true), false)
}

/// A chart of one curve for each cycle.
fn cycles(title: &str, [x, y]: [&str; 2], orbits: &[&OrbitRecord], curves: &[Curve]) -> Chart {
    let x = Axis::of(&shown(x), values(curves, |c| &c.x), 7);
    let y = Axis::of(&shown(y), values(curves, |c| &c.y), 7);
    let mut lines = Vec::new();
    let mut legend: Vec<Entry> = Vec::new();
    for (at, (orbit, curve)) in orbits.iter().zip(curves).enumerate() {
        lines.extend(curve_lines(curve, of_state(at), (&x, &y)));
        let label = match orbit.unstable {
            Some(_) => orbit.label.clone(),
            None => format!("{}, stability not known", orbit.label),
        };
        legend.push(state_entry(at, &label, stability(orbit)));
    }
    let title = shown(title);
    Chart { lines, legend, ..Chart::new(title, x, y, WIDE) }
}
