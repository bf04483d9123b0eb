//! Details that are too small to be seen, enlarged beside a chart: special points that nearly coincide, and what is
//! unstable along what is stable.

use super::chart::{Chart, Frame, Line};
use super::drawing::{Drawing, LETTERS, RIGHT, clip, draw_line};
use super::marker::INK;
use super::palette::{GRID, hex};
use super::path::Place;
use super::text::{self, Style};
use std::fmt::Write as _;
use study::record::view::drawable;

/// A part of a chart, in the units of the axes' labels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Window {
    /// From the left to the right.
    pub(super) x: (f64, f64),
    /// From the bottom to the top.
    pub(super) y: (f64, f64),
}

/// What is enlarged.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) enum Sought {
    /// Nothing.
    #[default]
    Nothing,
    /// What an eye would miss.
    Hidden,
    /// These parts.
    Windows(Vec<Window>),
}

/// Most details of a chart.
const MOST: usize = 2;
/// Special points that are nearer than this, in pixels, cover each other.
const COVERED: f64 = 12.0;
/// What is nearer is the same point.
const SAME: f64 = 0.05;
/// Curves that are nearer look like one.
const ALONG: f64 = 3.0;
/// They do so for as many pixels at least.
const LONG: f64 = 25.0;
/// The farthest that is enlarged.
const LARGEST: f64 = 2000.0;
/// Size of a detail's frame with the usual letters, and the narrowest one.
const SIZE: (f64, f64) = (190.0, 150.0);
/// Size of one with true proportions.
const LARGE: (f64, f64) = (330.0, 240.0);
/// Windows that fill so much of the window around both are shown as one.
const TOGETHER: f64 = 0.15;
/// A pull-off so near to zero force, in pixels, is not seen.
const FLAT: f64 = 15.0;

/// A detail: its part of the chart, and where it is drawn.
#[derive(Debug)]
pub(super) struct Detail {
    /// The part in the chart, in pixels.
    part: [f64; 4],
    frame: Frame,
    x: super::axis::Axis,
    y: super::axis::Axis,
    /// A letter where there are several.
    name: &'static str,
    /// Pixels for the labels below.
    below: f64,
}

impl Detail {
    /// All details of a chart: below its legend, which begins at a place and is so wide.
    pub(super) fn all(
        drawing: &Drawing<'_>,
        frame: Frame,
        [left, top, width]: [f64; 3],
    ) -> Vec<Detail> {
        let chart = drawing.chart;
        let mut windows = match &chart.details {
            Sought::Nothing => Vec::new(),
            Sought::Windows(windows) => windows.clone(),
            Sought::Hidden => hidden(chart, frame),
        };
        windows.truncate(MOST);
        let names: [&str; MOST] = if windows.len() > 1 { ["a", "b"] } else { ["", ""] };
        let mut top = top + drawing.scaled(12.0);
        let below = drawing.scaled(LETTERS[3]) + 10.0;
        let mut out = Vec::new();
        for (window, name) in windows.into_iter().zip(names) {
            let size = match chart.proportional {
                true => LARGE,
                false => (SIZE.0.max(width - drawing.scaled(70.0)).min(1.3 * SIZE.0), SIZE.1),
            };
            let window =
                if chart.proportional { proportional(window, size, frame) } else { window };
            let x = chart.x.part(window.x, 4);
            let y = chart.y.part(window.y, 4);
            let letters = drawing.scaled(LETTERS[3]);
            let across = x.ticks.iter().map(|tick| text::width(&x.label(*tick), letters) + 12.0);
            let x = if across.sum::<f64>() > size.0 { chart.x.part(window.x, 2) } else { x };
            let labels = y.ticks.iter().map(|tick| text::width(&y.label(*tick), letters));
            let left = left + 10.0 + labels.fold(0.0, f64::max);
            let own = Frame {
                left,
                top,
                right: left + size.0,
                bottom: top + size.1,
                x: window.x,
                y: window.y,
            };
            let (a, b) =
                (frame.place((window.x.0, window.y.1)), frame.place((window.x.1, window.y.0)));
            out.push(Detail { part: [a.0, a.1, b.0, b.1], frame: own, x, y, name, below });
            top = own.bottom + below + drawing.scaled(22.0);
        }
        out
    }

    /// Where it ends on the right, with some room.
    pub(super) fn right(&self) -> f64 {
        self.frame.right + RIGHT
    }

    /// Where it ends below.
    pub(super) fn bottom(&self) -> f64 {
        self.frame.bottom + self.below + 4.0
    }

    /// Its part, drawn on the chart.
    pub(super) fn mark(&self, svg: &mut String) {
        // a frame that is smaller than a marker would be hidden below it
        let grown = |from: f64, to: f64| {
            let lack = (18.0 - (to - from)).max(0.0);
            (from - 0.5 * lack, to + 0.5 * lack)
        };
        let [left, top, right, bottom] = self.part;
        let ((left, right), (top, bottom)) = (grown(left, right), grown(top, bottom));
        let _ = writeln!(
            svg,
            "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\" stroke=\"{INK}\" \
             stroke-dasharray=\"3 2\"/>",
            right - left,
            bottom - top
        );
        let style = Style::small().anchored("end").with_rim();
        text::put(svg, self.name, [left - 3.0, top + 4.0], &style);
    }

    /// The detail itself.
    pub(super) fn draw(&self, drawing: &Drawing<'_>, svg: &mut String) {
        let frame = self.frame;
        let Frame { left, top, right, bottom, .. } = frame;
        let letters = drawing.scaled(LETTERS[3]);
        let small = Style::small().sized(letters);
        let caption = if self.name.is_empty() {
            "detail".to_owned()
        } else {
            format!("detail {}", self.name)
        };
        text::put(svg, &caption, [left, top - 6.0], &small);
        let mut grid = String::new();
        for tick in &self.x.ticks {
            let at = frame.place((*tick, frame.y.0)).0;
            let _ = write!(grid, "M{at:.1} {top:.1}V{bottom:.1}");
            text::put(
                svg,
                &self.x.label(*tick),
                [at, bottom + letters + 4.0],
                &small.anchored("middle"),
            );
        }
        for tick in &self.y.ticks {
            let at = frame.place((frame.x.0, *tick)).1;
            let _ = write!(grid, "M{left:.1} {at:.1}H{right:.1}");
            text::put(
                svg,
                &self.y.label(*tick),
                [left - 6.0, at + 0.36 * letters],
                &small.anchored("end"),
            );
        }
        if drawing.look.parts.grid {
            let _ = writeln!(svg, "<path d=\"{grid}\" stroke=\"{}\"/>", hex(GRID));
        }
        clip(svg, &format!("detail{}", self.name), frame);
        let lines = self.lines(&drawing.chart.lines);
        for line in &lines {
            let places: Vec<Place> = line.points.iter().map(|point| frame.place(*point)).collect();
            draw_line(svg, line, &places, drawing.look.line);
        }
        drawing.arrows(svg, frame);
        svg.push_str("</g>\n");
        let _ = writeln!(
            svg,
            "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\" stroke=\"{INK}\" \
             stroke-dasharray=\"3 2\"/>",
            right - left,
            bottom - top
        );
        drawing.special_points(svg, frame, &lines);
    }

    /// The stretches of lines that come near it.
    fn lines(&self, all: &[Line]) -> Vec<Line> {
        let Frame { x, y, .. } = self.frame;
        let (wide, high) = (x.1 - x.0, y.1 - y.0);
        // neighbours give a line its slope at the frame
        let far = |p: (f64, f64), q: (f64, f64)| {
            let apart = |a: f64, b: f64, (low, high): (f64, f64), room: f64| {
                (a < low - room && b < low - room) || (a > high + room && b > high + room)
            };
            apart(p.0, q.0, x, 0.5 * wide) || apart(p.1, q.1, y, 0.5 * high)
        };
        let mut out = Vec::new();
        for line in all {
            let points = &line.points;
            let mut at = 0;
            while at + 1 < points.len() {
                if far(points[at], points[at + 1]) {
                    at += 1;
                    continue;
                }
                let from = at.saturating_sub(2);
                while at + 1 < points.len() && !far(points[at], points[at + 1]) {
                    at += 1;
                }
                let to = (at + 3).min(points.len());
                out.push(Line { points: points[from..to].to_vec(), ..line.clone() });
            }
        }
        out
    }
}

/// A window grown until a unit is as long on both axes as in the chart.
fn proportional(window: Window, size: (f64, f64), frame: Frame) -> Window {
    let unit = (
        (frame.right - frame.left) / (frame.x.1 - frame.x.0),
        (frame.bottom - frame.top) / (frame.y.1 - frame.y.0),
    );
    let (wide, high) = ((window.x.1 - window.x.0) * unit.0, (window.y.1 - window.y.0) * unit.1);
    let scale = (size.0 / wide).min(size.1 / high);
    let half = (0.5 * size.0 / scale / unit.0, 0.5 * size.1 / scale / unit.1);
    let middle = (0.5 * (window.x.0 + window.x.1), 0.5 * (window.y.0 + window.y.1));
    Window { x: (middle.0 - half.0, middle.0 + half.0), y: (middle.1 - half.1, middle.1 + half.1) }
}

/// The window around a place, half as high as this many pixels, and wide in the proportion of details.
pub(super) fn around(frame: Frame, (x, y): Place, half: f64) -> Window {
    let across = half * SIZE.0 / SIZE.1;
    let (from, to) = (frame.point((x - across, y + half)), frame.point((x + across, y - half)));
    Window { x: (from.0, to.0), y: (from.1, to.1) }
}

/// What an eye would miss.
fn hidden(chart: &Chart, frame: Frame) -> Vec<Window> {
    let lines: Vec<(bool, Vec<Place>)> = chart
        .lines
        .iter()
        .filter(|line| line.width > 1)
        .map(|line| (line.is_unstable(), line.points.iter().map(|p| frame.place(*p)).collect()))
        .collect();
    let mut found = Vec::new();
    let run = along(&lines, frame);
    if let Some((place, gap)) = run {
        found.push(around(frame, place, (2.5 * gap).max(0.5)));
    }
    let marks: Vec<(&str, Place)> = chart
        .marks
        .iter()
        .map(|mark| (mark.kind.as_str(), (chart.x.place(mark.x), chart.y.place(mark.y))))
        .filter(|(_, point)| drawable(point.0) && drawable(point.1))
        .map(|(kind, point)| (kind, frame.place(point)))
        .filter(|(_, place)| frame.holds(*place))
        .collect();
    if let Some(window) = covered(&marks, frame) {
        // what is nearly the same is shown once
        match found.pop() {
            Some(own) => match together(own, window) {
                Some(both) => found.push(both),
                None => found.extend([own, window]),
            },
            None => found.push(window),
        }
    }
    if let Some(window) = pull_off(chart, frame, &marks) {
        // what lies in it is seen in it
        let middle = |(a, b): (f64, f64)| 0.5 * (a + b);
        let inside = |(a, b): (f64, f64), at: f64| a <= at && at <= b;
        found.retain(|own| !(inside(window.x, middle(own.x)) && inside(window.y, middle(own.y))));
        found.push(window);
    }
    found
}

/// A window around two that are of about the same size and place.
fn together(a: Window, b: Window) -> Option<Window> {
    let around = |p: (f64, f64), q: (f64, f64)| {
        let both = (p.0.min(q.0), p.1.max(q.1));
        let most = (p.1 - p.0).max(q.1 - q.0);
        (both.1 - both.0 < (1.0 + TOGETHER) * most + 0.5 * (p.1 - p.0).min(q.1 - q.0))
            .then_some(both)
    };
    Some(Window { x: around(a.x, b.x)?, y: around(a.y, b.y)? })
}

/// The attraction, where it is small beside what presses.
fn pull_off(chart: &Chart, frame: Frame, marks: &[(&str, Place)]) -> Option<Window> {
    let (_, pull) = marks.iter().find(|(kind, _)| *kind == "pull-off")?;
    let (_, zero) = marks.iter().find(|(kind, _)| *kind == "zero-force")?;
    let depth = pull.1 - frame.place((chart.x.low, 0.0)).1;
    let apart = pull.0 - zero.0;
    if !(chart.y.has_zero() && depth > SAME && depth < FLAT && apart.abs() > 1.0) {
        return None;
    }
    let (near, far) = (zero.0 - apart, pull.0 + 4.0 * apart);
    let (left, right) = (near.min(far).max(frame.left), near.max(far).min(frame.right));
    let zero = pull.1 - depth;
    let (from, to) =
        (frame.point((left, zero + 1.4 * depth)), frame.point((right, zero - 1.4 * depth)));
    Some(Window { x: (from.0, to.0), y: (from.1, to.1) })
}

/// Special points of which one covers the other, the fold or branch point with the nearest neighbour first.
fn covered(marks: &[(&str, Place)], frame: Frame) -> Option<Window> {
    let important = |kind: &str| super::label::rank(kind) > 2;
    let mut best: Option<(f64, Place)> = None;
    for (at, (kind, place)) in marks.iter().enumerate().filter(|(_, mark)| important(mark.0)) {
        for (other, neighbour) in marks.iter().enumerate().filter(|(k, _)| *k != at).map(|(_, m)| m)
        {
            let far = (place.0 - neighbour.0).hypot(place.1 - neighbour.1);
            // two folds that nearly coincide come before a fold and an extremum of the force
            let far_enough =
                far > SAME && far < COVERED && !super::label::letters(other).is_empty();
            let weight = if important(other) { far } else { far + COVERED };
            let _ = kind;
            if far_enough && best.is_none_or(|(least, _)| weight < least) {
                let middle = (0.5 * (place.0 + neighbour.0), 0.5 * (place.1 + neighbour.1));
                best = Some((weight, middle));
            }
        }
    }
    let (weight, middle) = best?;
    let far = if weight > COVERED { weight - COVERED } else { weight };
    Some(around(frame, middle, (1.3 * far).max(0.05)))
}

/// Where an unstable curve runs along another so near that both look like one: the place where they are
/// farthest apart, and how far.
fn along(lines: &[(bool, Vec<Place>)], frame: Frame) -> Option<(Place, f64)> {
    let mut best: Option<(f64, Place, f64)> = None;
    for (_, unstable) in lines.iter().filter(|(is_unstable, _)| *is_unstable) {
        let mut length = 0.0;
        let mut widest: Option<(Place, f64)> = None;
        for pair in unstable.windows(2) {
            let steps = ((pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1) / 4.0)
                .ceil()
                .clamp(1.0, 200.0);
            for step in 0..steps as usize {
                let t = step as f64 / steps;
                let place = (
                    pair[0].0 + t * (pair[1].0 - pair[0].0),
                    pair[0].1 + t * (pair[1].1 - pair[0].1),
                );
                let gap = lines
                    .iter()
                    .filter(|(is_unstable, _)| !is_unstable)
                    .map(|(_, line)| distance(place, line))
                    .fold(f64::INFINITY, f64::min);
                let near = gap > SAME && gap < ALONG && frame.holds(place);
                if near && gap > 8.0 / LARGEST {
                    length += (pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1) / steps;
                    if widest.is_none_or(|(_, most)| gap > most) {
                        widest = Some((place, gap));
                    }
                } else {
                    best = longer(best, length, widest);
                    (length, widest) = (0.0, None);
                }
            }
        }
        best = longer(best, length, widest);
    }
    let (length, place, gap) = best?;
    (length > LONG).then_some((place, gap))
}

/// The longer of two runs.
fn longer(
    best: Option<(f64, Place, f64)>,
    length: f64,
    widest: Option<(Place, f64)>,
) -> Option<(f64, Place, f64)> {
    match (best, widest) {
        (_, None) => best,
        (Some((most, ..)), Some(_)) if most >= length => best,
        (_, Some((place, gap))) => Some((length, place, gap)),
    }
}

/// How far a place is from a line.
pub(super) fn distance((x, y): Place, line: &[Place]) -> f64 {
    let mut least = f64::INFINITY;
    for pair in line.windows(2) {
        let ((ax, ay), (bx, by)) = (pair[0], pair[1]);
        let (dx, dy) = (bx - ax, by - ay);
        let square = dx * dx + dy * dy;
        let t = if square > 0.0 {
            (((x - ax) * dx + (y - ay) * dy) / square).clamp(0.0, 1.0)
        } else {
            0.0
        };
        least = least.min((x - ax - t * dx).hypot(y - ay - t * dy));
    }
    least
}
