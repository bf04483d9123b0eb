//! The pictures of a cycle: the loop with its jumps as arrows, and the shapes before and after each.

use super::axis::Axis;
use super::chart::{Arrow, Chart, DrawError, Entry, Line, Stroke};
use super::columns::within;
use super::detail::{Sought, Window, distance};
use super::draw::{DISTANCE, FORCE, WIDE, curve_lines, shapes, unstable_entries, values};
use super::heading::{fit, titled};
use super::palette::{FAINT, of_state};
use super::physical::scaled;
use study::case::ResolvedCase;
use study::record::view::{Curve, CyclePictures, Shape, drawable};
use study::record::{CycleResult, Laboratory, spoken};

/// Name of the picture of the loop.
pub const LOOP: &str = "loop.svg";

/// Plate distance and force.
type Place = (f64, f64);

/// Name of the same in physical units.
pub const PHYSICAL_LOOP: &str = "loop-physical.svg";

/// A jump that is shorter than this, in pixels, is enlarged.
const SHORT: f64 = 60.0;
/// Where two shapes are further apart than this they differ, in R0.
const APART: f64 = 0.01;

/// All pictures of a cycle: file name and SVG; of a case in physical units the loop once more in those.
///
/// # Errors
/// When the drawing library fails.
pub fn draw_cycle(
    case: &ResolvedCase,
    result: &CycleResult,
) -> Result<Vec<(String, Vec<u8>)>, DrawError> {
    let (cycle, picture) = (&result.pictures, &case.picture);
    let title = titled(&cycle.title, case);
    let chart = hysteresis(cycle, &title, [DISTANCE, FORCE]);
    let svg = chart.with_axes(&picture.x, &picture.y).svg(picture)?;
    let mut files = vec![(LOOP.to_owned(), svg.into_bytes())];
    if let Some(laboratory) = Laboratory::of(case, &[&result.branch]) {
        let of = |unit: &str| laboratory.convert(unit).unwrap_or(("", 1.0));
        let (length, force) = (of("R0"), of("sqrt(chi k_b)"));
        let scaled = in_units(cycle, (length.1, force.1));
        let x = format!("plate distance z₀ [{}]", spoken(length.0));
        let y = format!("force F [{}]", spoken(force.0));
        let chart = hysteresis(&scaled, &title, [&x, &y]);
        let svg = within(chart, picture, (length.1, force.1)).svg(picture)?;
        files.push((PHYSICAL_LOOP.to_owned(), svg.into_bytes()));
    }
    for (at, (title, pair)) in cycle.shapes.iter().enumerate() {
        let mut chart = shapes(&titled(title, case), pair, picture);
        chart.details = pole(pair);
        files.push((format!("jump-{}.svg", at + 1), chart.svg(picture)?.into_bytes()));
    }
    Ok(files)
}

/// The same cycle with its distances and forces multiplied.
fn in_units(cycle: &CyclePictures, (x, y): (f64, f64)) -> CyclePictures {
    let place = |(a, b): Place| (x * a, y * b);
    CyclePictures {
        complete: scaled(&cycle.complete, x, y),
        approach: scaled(&cycle.approach, x, y),
        retract: scaled(&cycle.retract, x, y),
        jumps: cycle.jumps.iter().map(|(from, to)| (place(*from), place(*to))).collect(),
        ..cycle.clone()
    }
}

/// The pole, where the shapes before and after a jump differ.
fn pole(pair: &[Shape]) -> Sought {
    let [before, after] = pair else { return Sought::Nothing };
    let line = |shape: &Shape| -> Vec<Place> {
        shape.sigma.iter().copied().zip(shape.z.iter().copied()).collect()
    };
    let (a, b) = (line(before), line(after));
    let differ = |own: &[Place], other: &[Place]| -> Vec<Place> {
        own.iter().copied().filter(|place| distance(*place, other) > APART).collect()
    };
    let places = [differ(&a, &b), differ(&b, &a)].concat();
    let upper: Vec<Place> = places.into_iter().filter(|place| place.1 > 0.0).collect();
    if upper.is_empty() {
        return Sought::Nothing;
    }
    let wide = upper.iter().map(|place| place.0).fold(0.0, f64::max);
    let (low, high) = upper
        .iter()
        .map(|place| place.1)
        .fold((f64::INFINITY, 0.0_f64), |(low, high), z| (low.min(z), high.max(z)));
    // from pole to pole a dimple is small, and what differs down to the equator is seen as it is
    if before.plate_below.is_some() && low < 0.5 * high {
        return Sought::Nothing;
    }
    // with the plates, where they are near
    let plates = pair.iter().map(|shape| shape.plate).filter(|plate| *plate < high + 0.3);
    let high = plates.fold(high, f64::max);
    let room = 0.05 * (high - low).max(wide);
    Sought::Windows(vec![Window { x: (-wide - room, wide + room), y: (low - room, high + room) }])
}

/// The loop over the complete branch.
fn hysteresis(cycle: &CyclePictures, title: &str, axes: [&str; 2]) -> Chart {
    let curves = [&cycle.complete, &cycle.approach, &cycle.retract];
    let all: Vec<Curve> = curves.into_iter().cloned().collect();
    let x = Axis::of(axes[0], values(&all, |c| &c.x), 7);
    let y = Axis::of(axes[1], values(&all, |c| &c.y), 7);
    let units = (x.unit, y.unit);
    let (way_in, way_out, leap) = (of_state(1), of_state(2), of_state(3));
    let complete = curve_lines(&cycle.complete, FAINT, (&x, &y));
    let (unstable, mut lines): (Vec<Line>, Vec<Line>) =
        complete.into_iter().partition(|line| line.stroke != Stroke::Solid);
    // where both ways are one, the way out is a rim
    for (curve, color, width) in [(&cycle.retract, way_out, 4), (&cycle.approach, way_in, 2)] {
        lines.extend(curve_lines(curve, color, (&x, &y)).into_iter().map(|l| Line { width, ..l }));
    }
    lines.extend(unstable);
    let size = (f64::from(WIDE.0), f64::from(WIDE.1));
    let scale = (size.0 / (x.high - x.low), size.1 / (y.high - y.low));
    let mut arrows = Vec::new();
    let in_axes = |(a, b): Place| (a / units.0, b / units.1);
    let good = |(a, b): Place| drawable(a) && drawable(b);
    for (curve, color) in [(&cycle.retract, way_out), (&cycle.approach, way_in)] {
        if let Some((from, to)) = far_along(curve, scale, units) {
            arrows.push(Arrow { from: in_axes(from), to: in_axes(to), color });
        }
    }
    for (from, to) in &cycle.jumps {
        let (a, b) = (in_axes(*from), in_axes(*to));
        if good(a) && good(b) {
            lines.push(Line { points: vec![a, b], color: leap, width: 2, stroke: Stroke::Solid });
            arrows.push(Arrow { from: a, to: b, color: leap });
        }
    }
    let solid = |color, label: &str| {
        let (stroke, label) = (Stroke::Solid, label.to_owned());
        Entry::Line { color, stroke, label }
    };
    let mut legend = vec![solid(way_in, "approach"), solid(way_out, "retract")];
    if !cycle.jumps.is_empty() {
        legend.push(solid(FAINT, "not visited"));
        legend.push(solid(leap, "jump"));
    }
    legend.extend(unstable_entries(&all, FAINT));
    let marks = cycle.complete.marks.clone();
    if !marks.is_empty() {
        legend.push(Entry::Marker { kind: "fold".to_owned() });
    }
    let chart = Chart { lines, arrows, marks, legend, ..Chart::new(fit(title), x, y, WIDE) };
    let details = short_jumps(cycle, scale, units);
    Chart { details, ..chart }
}

/// Jumps that are too short to be seen.
fn short_jumps(cycle: &CyclePictures, scale: (f64, f64), units: (f64, f64)) -> Sought {
    let windows = cycle.jumps.iter().filter_map(|(from, to)| {
        let (a, b) = ((from.0 / units.0, from.1 / units.1), (to.0 / units.0, to.1 / units.1));
        let pixels = ((b.0 - a.0) * scale.0).hypot((b.1 - a.1) * scale.1);
        let middle = (0.5 * (a.0 + b.0), 0.5 * (a.1 + b.1));
        let (across, up) = (1.1 * pixels / scale.0, 0.9 * pixels / scale.1);
        (pixels > 0.0 && pixels < SHORT && drawable(pixels)).then_some(Window {
            x: (middle.0 - across, middle.0 + across),
            y: (middle.1 - up, middle.1 + up),
        })
    });
    Sought::Windows(windows.collect())
}

/// How far along a curve its arrow is: apart from that of the way back.
const FAR: f64 = 0.4;

/// The step of a curve that far along it as it is drawn, for an arrow that shows which way it goes.
fn far_along(curve: &Curve, scale: (f64, f64), units: (f64, f64)) -> Option<(Place, Place)> {
    let at = |k: usize| (curve.x[k], curve.y[k]);
    let step = |k: usize| {
        let ((x0, y0), (x1, y1)) = (at(k), at(k + 1));
        let length = ((x1 - x0) / units.0 * scale.0).hypot((y1 - y0) / units.1 * scale.1);
        if drawable(length) { length } else { 0.0 }
    };
    let steps = curve.x.len().checked_sub(1)?;
    let total: f64 = (0..steps).map(step).sum();
    let mut so_far = 0.0;
    for k in 0..steps {
        so_far += step(k);
        if so_far >= FAR * total && step(k) > 0.0 {
            return Some((at(k), at(k + 1)));
        }
    }
    None
}
