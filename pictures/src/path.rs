//! Lines as paths of SVG: smooth through the points that were computed, and no longer than the eye needs.

use std::fmt::Write as _;

/// A place in pixels.
pub(super) type Place = (f64, f64);

/// How far a drawn line may be off the curve, in pixels: six times smaller than what is seen, so that
/// pictures may be enlarged.
const NEAR: f64 = 0.04;
/// Most points that are put between two neighbours.
const BETWEEN: usize = 24;
/// Fewer points than these are meant as they are: plates, arrows, samples.
const CURVE: usize = 5;
/// A turn at a point beyond this angle, in radians, is a corner and stays one.
const CORNER: f64 = 1.2;

/// The path through points by straight lines.
pub(super) fn straight(points: &[Place]) -> String {
    let mut d = String::new();
    for (at, (x, y)) in points.iter().enumerate() {
        let pen = if at == 0 { 'M' } else { 'L' };
        let _ = write!(d, "{pen}{} {}", Rounded(*x), Rounded(*y));
    }
    d
}

/// The path through points.
pub(super) fn through(points: &[Place]) -> String {
    let mut d = String::new();
    for (at, (x, y)) in drawn(points).into_iter().enumerate() {
        let pen = if at == 0 { 'M' } else { 'L' };
        let _ = write!(d, "{pen}{} {}", Rounded(x), Rounded(y));
    }
    d
}

/// The points of a line as it is drawn.
fn drawn(points: &[Place]) -> Vec<Place> {
    let mut apart: Vec<Place> = Vec::with_capacity(points.len());
    for point in points {
        if apart.last().is_none_or(|last| distance(*last, *point) > 1e-6) {
            apart.push(*point);
        }
    }
    if apart.len() < CURVE {
        return if apart.len() == 1 { points.to_vec() } else { apart };
    }
    thinned(&smooth(&apart))
}

/// A number with two digits after the point at most.
struct Rounded(f64);

impl std::fmt::Display for Rounded {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let hundredths = (100.0 * self.0).round() as i64;
        let (sign, size) = (if hundredths < 0 { "-" } else { "" }, hundredths.abs());
        match (size / 100, size % 100) {
            (whole, 0) => write!(f, "{sign}{whole}"),
            (whole, part) if part % 10 == 0 => write!(f, "{sign}{whole}.{}", part / 10),
            (whole, part) => write!(f, "{sign}{whole}.{part:02}"),
        }
    }
}

fn distance(a: Place, b: Place) -> f64 {
    (b.0 - a.0).hypot(b.1 - a.1)
}

/// Cubics of Hermite between neighbours, with the slopes of the parabola through three points whose
/// parameter is the root of the chord (centripetal Catmull and Rom: no loops, no overshoot worth seeing).
fn smooth(points: &[Place]) -> Vec<Place> {
    let last = points.len() - 1;
    let knot = |k: usize| distance(points[k], points[k + 1]).sqrt();
    let corner = |k: usize| {
        if k == 0 || k == last {
            return true;
        }
        let (a, b, c) = (points[k - 1], points[k], points[k + 1]);
        let (u, v) = ((b.0 - a.0, b.1 - a.1), (c.0 - b.0, c.1 - b.1));
        (u.0 * v.1 - u.1 * v.0).atan2(u.0 * v.0 + u.1 * v.1).abs() > CORNER
    };
    // by the parameter of the curve
    let slope = |k: usize| -> Place {
        let (before, after) = (knot(k - 1), knot(k));
        let part = |a: f64, b: f64, c: f64| {
            let (left, right) = ((b - a) / before, (c - b) / after);
            (left * after + right * before) / (before + after)
        };
        let (a, b, c) = (points[k - 1], points[k], points[k + 1]);
        (part(a.0, b.0, c.0), part(a.1, b.1, c.1))
    };
    let mut out = vec![points[0]];
    for k in 0..last {
        let (a, b, width) = (points[k], points[k + 1], knot(k));
        let chord = ((b.0 - a.0) / width, (b.1 - a.1) / width);
        // at an end or a corner: the slope that makes a parabola with the other one
        let (from, to) = match (corner(k), corner(k + 1)) {
            (true, true) => (chord, chord),
            (true, false) => {
                let to = slope(k + 1);
                ((2.0 * chord.0 - to.0, 2.0 * chord.1 - to.1), to)
            }
            (false, true) => {
                let from = slope(k);
                (from, (2.0 * chord.0 - from.0, 2.0 * chord.1 - from.1))
            }
            (false, false) => (slope(k), slope(k + 1)),
        };
        let off = [from, to].map(|own| (own.0 - chord.0).hypot(own.1 - chord.1) * width);
        let parts = ((off[0].max(off[1]) / NEAR).sqrt().ceil() as usize).clamp(1, BETWEEN);
        for step in 1..parts {
            let t = step as f64 / parts as f64;
            let rest = 1.0 - t;
            let at = |a: f64, b: f64, from: f64, to: f64| {
                rest * rest * (1.0 + 2.0 * t) * a
                    + t * t * (3.0 - 2.0 * t) * b
                    + width * t * rest * (rest * from - t * to)
            };
            out.push((at(a.0, b.0, from.0, to.0), at(a.1, b.1, from.1, to.1)));
        }
        out.push(b);
    }
    out
}

/// The points without which a straight line would be off (Ramer, Douglas and Peucker).
fn thinned(points: &[Place]) -> Vec<Place> {
    let last = points.len() - 1;
    let mut keep = vec![false; last + 1];
    (keep[0], keep[last]) = (true, true);
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let worst = (from + 1..to)
            .map(|at| (off(points[from], points[at], points[to]), at))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((far, at)) = worst
            && far > NEAR
        {
            keep[at] = true;
            open.extend([(from, at), (at, to)]);
        }
    }
    points.iter().zip(keep).filter(|(_, keep)| *keep).map(|(point, _)| *point).collect()
}

/// How far a point is off the line between two others.
fn off(from: Place, at: Place, to: Place) -> f64 {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let (x, y) = (at.0 - from.0, at.1 - from.1);
    let length = dx.hypot(dy);
    if length == 0.0 {
        return x.hypot(y);
    }
    let along = ((x * dx + y * dy) / (length * length)).clamp(0.0, 1.0);
    (x - along * dx).hypot(y - along * dy)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn circle(points: usize) -> Vec<Place> {
        let angles = (0..=points).map(|k| TAU * k as f64 / points as f64);
        angles.map(|a| (300.0 + 200.0 * a.cos(), 300.0 + 200.0 * a.sin())).collect()
    }

    /// Largest distance of the drawn line from the circle, at points and between them.
    fn error(drawn: &[Place]) -> f64 {
        let far = |p: Place| ((p.0 - 300.0).hypot(p.1 - 300.0) - 200.0).abs();
        let middles = drawn.windows(2).map(|w| (0.5 * (w[0].0 + w[1].0), 0.5 * (w[0].1 + w[1].1)));
        drawn.iter().copied().chain(middles).map(far).fold(0.0, f64::max)
    }

    #[test]
    fn few_points_are_joined_smoothly_and_many_are_thinned() {
        let few = drawn(&circle(24));
        assert!(error(&few) < 0.3, "{}", error(&few));
        // straight lines would be off by 1.7 pixels
        assert!(few.len() > 60);
        let many = drawn(&circle(5000));
        assert!(error(&many) < 2.0 * NEAR && many.len() < 260, "{} {}", error(&many), many.len());
    }

    #[test]
    fn corners_ends_and_repeated_points_stay() {
        let corner =
            [(0.0, 0.0), (10.0, 0.0), (20.0, 0.0), (20.0, 10.0), (20.0, 20.0), (20.0, 20.0)];
        assert_eq!(drawn(&corner), [(0.0, 0.0), (20.0, 0.0), (20.0, 20.0)]);
        assert_eq!(through(&[(1.0, 2.0), (1.0, 2.0)]), "M1 2L1 2");
        assert_eq!(through(&[(1.0, 2.004), (-0.101, 2.5), (3.25, 0.0)]), "M1 2L-0.1 2.5L3.25 0");
        assert_eq!(through(&[]), "");
    }

    #[test]
    fn a_spike_does_not_overshoot() {
        let points: Vec<Place> =
            (0..9).map(|k| (20.0 * k as f64, if k == 4 { 100.0 } else { 0.0 })).collect();
        let all = drawn(&points);
        let low = all.iter().map(|p| p.1).fold(0.0, f64::min);
        let high = all.iter().map(|p| p.1).fold(0.0, f64::max);
        assert!(low > -3.0 && high < 103.0, "{low} {high}");
    }
}
