//! The pictures of a cycle: the loop with its jumps as arrows, and the shapes before and after each.

use super::axis::Axis;
use super::chart::{Chart, DrawError, Entry, Line, Stroke};
use super::draw::{DISTANCE, FORCE, WIDE, curve_lines, shapes, unstable_entries, values};
use super::heading::fit;
use super::palette::{Color, FAINT, of_state};
use study::record::view::{Curve, CyclePictures, drawable};

/// Name of the picture of the loop.
pub const LOOP: &str = "loop.svg";

/// Plate distance and force.
type Place = (f64, f64);

/// Length of an arrow's head, as part of the picture's height.
const HEAD: f64 = 0.03;
/// Half its width.
const HALF: f64 = 0.011;

/// All pictures of a cycle: file name and SVG.
///
/// # Errors
/// When the drawing library fails.
pub fn draw_cycle(cycle: &CyclePictures) -> Result<Vec<(String, Vec<u8>)>, DrawError> {
    let mut files = vec![(LOOP.to_owned(), hysteresis(cycle)?.into_bytes())];
    for (at, (title, pair)) in cycle.shapes.iter().enumerate() {
        let svg = shapes(title, pair)?;
        files.push((format!("jump-{}.svg", at + 1), svg.into_bytes()));
    }
    Ok(files)
}

/// The loop over the complete branch.
fn hysteresis(cycle: &CyclePictures) -> Result<String, DrawError> {
    let curves = [&cycle.complete, &cycle.approach, &cycle.retract];
    let all: Vec<Curve> = curves.into_iter().cloned().collect();
    let x = Axis::of(DISTANCE, values(&all, |c| &c.x), 7);
    let y = Axis::of(FORCE, values(&all, |c| &c.y), 7);
    let units = (x.unit, y.unit);
    let (way_in, way_out, leap) = (of_state(1), of_state(2), of_state(3));
    let complete = curve_lines(&cycle.complete, FAINT, units);
    let (unstable, mut lines): (Vec<Line>, Vec<Line>) =
        complete.into_iter().partition(|line| line.stroke != Stroke::Solid);
    // where both ways are one, the way out is a rim
    for (curve, color, width) in [(&cycle.retract, way_out, 4), (&cycle.approach, way_in, 2)] {
        lines.extend(curve_lines(curve, color, units).into_iter().map(|l| Line { width, ..l }));
    }
    lines.extend(unstable);
    let size = (f64::from(WIDE.0), f64::from(WIDE.1));
    let scale = (size.0 / (x.high - x.low), size.1 / (y.high - y.low));
    let mut arrow = |from: Place, to: Place, color: Color, shaft: bool| {
        let (a, b) = ((from.0 / units.0, from.1 / units.1), (to.0 / units.0, to.1 / units.1));
        if ![a.0, a.1, b.0, b.1].into_iter().all(drawable) {
            return;
        }
        // in pixels, so that heads are as wide everywhere
        let along = ((b.0 - a.0) * scale.0, (b.1 - a.1) * scale.1);
        let length = along.0.hypot(along.1);
        if length == 0.0 {
            return;
        }
        let along = (along.0 / length, along.1 / length);
        let corner = |back: f64, side: f64| {
            let (dx, dy) = (along.0 * back - along.1 * side, along.1 * back + along.0 * side);
            (b.0 - size.1 * dx / scale.0, b.1 - size.1 * dy / scale.1)
        };
        if shaft {
            lines.push(Line { points: vec![a, b], color, width: 2, stroke: Stroke::Solid });
        }
        let points = vec![corner(HEAD, HALF), b, corner(HEAD, -HALF)];
        lines.push(Line { points, color, width: 2, stroke: Stroke::Solid });
    };
    for (curve, color) in [(&cycle.retract, way_out), (&cycle.approach, way_in)] {
        if let Some((from, to)) = far_along(curve, scale, units) {
            arrow(from, to, color, false);
        }
    }
    for (from, to) in &cycle.jumps {
        arrow(*from, *to, leap, true);
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
    Chart { title: fit(&cycle.title), x, y, lines, marks, legend, size: WIDE }.svg()
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
