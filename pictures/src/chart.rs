//! One chart: axes, lines, markers with their names, and a legend beside them that covers nothing.

use super::axis::Axis;
use super::label::{self, Names};
use super::palette::{Color, FAINT, Form, GRID, form, hex};
use super::path::{self, Place};
use super::sheet::FAMILY;
use super::text::{self, Style};
use std::fmt::Write as _;
use study::record::view::{Mark, Stability, drawable};

/// Why a picture could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the picture \"{picture}\" could not be drawn: {detail}")]
pub struct DrawError {
    /// Which picture.
    pub picture: String,
    /// What is missing.
    pub detail: String,
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stroke {
    /// Without gaps.
    Solid,
    /// In dashes.
    Dashed,
    /// In dots.
    Dotted,
}

impl Stroke {
    /// The stroke of what is stable, or not.
    pub(super) fn of(stability: Stability) -> Stroke {
        match stability {
            Stability::Stable => Stroke::Solid,
            Stability::Asymmetric => Stroke::Dotted,
            Stability::Unstable => Stroke::Dashed,
        }
    }

    /// Lengths of a dash and of the gap after it, as an attribute.
    fn pattern(self) -> &'static str {
        match self {
            Stroke::Solid => "",
            Stroke::Dashed => " stroke-dasharray=\"7 5\"",
            Stroke::Dotted => " stroke-dasharray=\"2 3\"",
        }
    }
}

/// A line through points.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Line {
    /// The points, all drawable.
    pub(super) points: Vec<(f64, f64)>,
    /// Its colour.
    pub(super) color: Color,
    /// Its width in pixels.
    pub(super) width: u32,
    /// Solid or not.
    pub(super) stroke: Stroke,
}

/// A coloured rectangle, in the units of the axes' labels.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tile {
    /// One corner.
    pub(super) from: (f64, f64),
    /// The opposite one.
    pub(super) to: (f64, f64),
    /// Its colour.
    pub(super) color: Color,
}

/// A line of the legend.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Entry {
    /// A sample of a line.
    Line {
        /// Its colour.
        color: Color,
        /// Solid or not.
        stroke: Stroke,
        /// What it stands for.
        label: String,
    },
    /// A sample of a tile.
    Tile {
        /// Its colour.
        color: Color,
        /// What it stands for.
        label: String,
    },
    /// A marker.
    Marker {
        /// Kind of special point.
        kind: String,
    },
    /// Words alone.
    Note {
        /// The words.
        label: String,
    },
}

impl Entry {
    fn label(&self) -> String {
        match self {
            Entry::Line { label, .. } | Entry::Tile { label, .. } | Entry::Note { label } => {
                label.clone()
            }
            Entry::Marker { kind } => match label::letters(kind) {
                "" => kind.clone(),
                letters => format!("{kind} ({letters})"),
            },
        }
    }
}

/// Everything on a chart.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chart {
    /// Title; empty for none. What follows a line break is written small below it.
    pub(super) title: String,
    /// Horizontal axis.
    pub(super) x: Axis,
    /// Vertical axis.
    pub(super) y: Axis,
    /// Lines, the first at the bottom.
    pub(super) lines: Vec<Line>,
    /// Special points, on top.
    pub(super) marks: Vec<Mark>,
    /// The legend, from the top.
    pub(super) legend: Vec<Entry>,
    /// Size of the plotting area in pixels.
    pub(super) size: (u32, u32),
}

const BOTTOM: f64 = 58.0;
const RIGHT: f64 = 18.0;
const TOP: f64 = 18.0;
const TITLE: f64 = 30.0;
const SUBTITLE: f64 = 20.0;
const ROW: f64 = 24.0;
/// Sizes of letters: title, axes, ticks and legend, names of special points.
const LETTERS: [f64; 4] = [18.0, 16.0, 14.0, 13.0];
const INK: &str = "#1e1e1e";

/// The plotting area in pixels, and where numbers are in it.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
    x: (f64, f64),
    y: (f64, f64),
}

impl Frame {
    /// The place of a point in the units of the axes' labels.
    fn place(&self, (x, y): (f64, f64)) -> Place {
        let across = (x - self.x.0) / (self.x.1 - self.x.0);
        let up = (y - self.y.0) / (self.y.1 - self.y.0);
        (self.left + across * (self.right - self.left), self.bottom - up * (self.bottom - self.top))
    }
}

impl Chart {
    /// The chart as SVG.
    pub(super) fn svg(&self) -> Result<String, DrawError> {
        self.svg_over(&[])
    }

    /// The chart as SVG, on top of tiles.
    pub(super) fn svg_over(&self, tiles: &[Tile]) -> Result<String, DrawError> {
        let frame = self.frame();
        let rows = 20.0 + ROW * self.legend.len() as f64;
        let heading = self.heading().into_iter().zip([LETTERS[0], LETTERS[3]]);
        let heading = heading.map(|(line, size)| text::width(line, size)).fold(0.0, f64::max);
        let width = (frame.right + RIGHT + self.legend_width()).max(frame.left + heading + RIGHT);
        let height = (frame.bottom + BOTTOM).max(frame.top + rows);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"{FAMILY}\" fill=\"none\" \
             stroke-linejoin=\"round\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
        );
        for tile in tiles {
            let ((a, b), (c, d)) = (frame.place(tile.from), frame.place(tile.to));
            rectangle(&mut svg, [a.min(c), b.min(d), (c - a).abs(), (d - b).abs()], tile.color);
        }
        self.axes(&mut svg, frame);
        let [left, top, right, bottom] = [frame.left, frame.top, frame.right, frame.bottom];
        let _ = writeln!(
            svg,
            "<clipPath id=\"frame\"><rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{:.1}\" \
             height=\"{:.1}\"/></clipPath>\n<g clip-path=\"url(#frame)\">",
            right - left,
            bottom - top
        );
        for line in &self.lines {
            let places: Vec<Place> = line.points.iter().map(|point| frame.place(*point)).collect();
            draw_line(&mut svg, line, &places);
        }
        svg.push_str("</g>\n");
        self.special_points(&mut svg, frame);
        self.draw_legend(&mut svg, frame.right + RIGHT, frame.top + 12.0);
        svg.push_str("</svg>\n");
        Ok(svg)
    }

    /// Title and the line below it.
    fn heading(&self) -> [&str; 2] {
        let (title, more) = self.title.split_once('\n').unwrap_or((&self.title, ""));
        [title, more]
    }

    /// The plotting area: to the right of the widest label.
    fn frame(&self) -> Frame {
        let labels = self.y.ticks.iter().map(|tick| text::width(&self.y.label(*tick), LETTERS[2]));
        let left = (50.0 + labels.fold(0.0, f64::max)).ceil();
        let [title, more] = self.heading();
        let above = if title.is_empty() { 0.0 } else { TITLE };
        let top = TOP + above + if more.is_empty() { 0.0 } else { SUBTITLE };
        let (width, height) = (f64::from(self.size.0), f64::from(self.size.1));
        let (right, bottom) = (left + width, top + height);
        let (x, y) = ((self.x.low, self.x.high), (self.y.low, self.y.high));
        Frame { left, top, right, bottom, x, y }
    }

    fn legend_width(&self) -> f64 {
        let longest = self.legend.iter().map(|entry| text::width(&entry.label(), LETTERS[2]));
        longest.fold(0.0, f64::max) + if self.legend.is_empty() { 0.0 } else { 58.0 }
    }

    /// Grid, frame, ticks, labels and titles.
    fn axes(&self, svg: &mut String, frame: Frame) {
        let (x, y) = (&self.x, &self.y);
        let Frame { left, top, right, bottom, .. } = frame;
        let ticks = Style::small().sized(LETTERS[2]);
        let (mut grid, mut marks) = (String::new(), String::new());
        for &tick in &x.ticks {
            let at = frame.place((tick, y.low)).0;
            let _ = write!(grid, "M{at:.1} {top:.1}V{bottom:.1}");
            let _ = write!(marks, "M{at:.1} {bottom:.1}v6");
        }
        for &tick in &y.ticks {
            let at = frame.place((x.low, tick)).1;
            let _ = write!(grid, "M{left:.1} {at:.1}H{right:.1}");
            let _ = write!(marks, "M{left:.1} {at:.1}h-6");
        }
        let _ = writeln!(svg, "<path d=\"{grid}\" stroke=\"{}\"/>", hex(GRID));
        if y.has_zero() {
            let at = frame.place((x.low, 0.0)).1;
            let _ = writeln!(
                svg,
                "<path d=\"M{left:.1} {at:.1}H{right:.1}\" stroke=\"{}\"/>",
                hex(FAINT)
            );
        }
        let _ = writeln!(
            svg,
            "<path d=\"{marks}M{left:.1} {top:.1}H{right:.1}V{bottom:.1}H{left:.1}Z\" stroke=\"{INK}\"/>"
        );
        for &tick in &x.ticks {
            let at = [frame.place((tick, y.low)).0, bottom + 21.0];
            text::put(svg, &x.label(tick), at, &ticks.anchored("middle"));
        }
        for &tick in &y.ticks {
            let at = [left - 10.0, frame.place((x.low, tick)).1 + 5.0];
            text::put(svg, &y.label(tick), at, &ticks.anchored("end"));
        }
        let titles = Style::small().sized(LETTERS[1]).anchored("middle");
        text::put(svg, &x.title, [0.5 * (left + right), bottom + BOTTOM - 12.0], &titles);
        text::put(svg, &y.title, [22.0, 0.5 * (top + bottom)], &titles.upwards());
        let [title, more] = self.heading();
        let above = if more.is_empty() { 0.0 } else { SUBTITLE };
        text::put(svg, title, [left, top - 12.0 - above], &Style::title().sized(LETTERS[0]));
        text::put(svg, more, [left, top - 11.0], &Style::small().sized(LETTERS[3]));
    }

    /// Markers, the more important ones on top, and their names where there is room.
    fn special_points(&self, svg: &mut String, frame: Frame) {
        let mut marks: Vec<(&Mark, Place)> = Vec::new();
        for mark in self.marks.iter().filter(|mark| drawable(mark.x) && drawable(mark.y)) {
            marks.push((mark, frame.place((mark.x / self.x.unit, mark.y / self.y.unit))));
        }
        let lines: Vec<Vec<Place>> = self
            .lines
            .iter()
            .map(|line| line.points.iter().map(|point| frame.place(*point)).collect())
            .collect();
        let names = Names::beside(&marks, &lines, frame, LETTERS[3]);
        marks.sort_by_key(|(mark, _)| label::rank(&mark.kind));
        for (mark, place) in &marks {
            draw_marker(svg, form(&mark.kind), *place);
        }
        names.draw(svg);
    }

    fn draw_legend(&self, svg: &mut String, left: f64, top: f64) {
        for (row, entry) in self.legend.iter().enumerate() {
            let y = top + ROW * row as f64;
            match entry {
                Entry::Line { color, stroke, .. } => {
                    let line =
                        Line { points: Vec::new(), color: *color, width: 2, stroke: *stroke };
                    draw_line(svg, &line, &[(left, y), (left + 34.0, y)]);
                }
                Entry::Tile { color, .. } => {
                    rectangle(svg, [left + 6.0, y - 8.0, 22.0, 16.0], *color);
                }
                Entry::Marker { kind } => draw_marker(svg, form(kind), (left + 17.0, y)),
                Entry::Note { .. } => {}
            }
            let style = Style::small().sized(LETTERS[2]);
            text::put(svg, &entry.label(), [left + 44.0, y + 5.0], &style);
        }
    }
}

fn rectangle(svg: &mut String, [x, y, width, height]: [f64; 4], color: Color) {
    let _ = writeln!(
        svg,
        "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"{}\" \
         shape-rendering=\"crispEdges\"/>",
        hex(color)
    );
}

/// A line, or a dot where a line has one point only.
fn draw_line(svg: &mut String, line: &Line, places: &[Place]) {
    let color = hex(line.color);
    match places {
        [] => {}
        [(x, y)] => {
            let _ = writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{color}\"/>");
        }
        places => {
            let _ = writeln!(
                svg,
                "<path d=\"{}\" stroke=\"{color}\" stroke-width=\"{}\"{}/>",
                path::through(places),
                line.width,
                line.stroke.pattern()
            );
        }
    }
}

/// A marker: black with a white rim, so that it stands out from its curve.
fn draw_marker(svg: &mut String, form: Form, (x, y): Place) {
    let (d, filled) = match form {
        Form::Disc => ("M5 0A5 5 0 1 1-5 0A5 5 0 1 1 5 0Z", true),
        Form::Ring => ("M5 0A5 5 0 1 1-5 0A5 5 0 1 1 5 0Z", false),
        Form::Square => ("M-5-5H5V5H-5Z", true),
        Form::Up => ("M0-7L6 5H-6Z", true),
        Form::Down => ("M0 7L6-5H-6Z", true),
        Form::Diamond => ("M0-7L6 0L0 7L-6 0Z", true),
        Form::HollowDiamond => ("M0-7L6 0L0 7L-6 0Z", false),
        Form::Cross => {
            let _ = writeln!(
                svg,
                "<g transform=\"translate({x:.1} {y:.1})\"><path d=\"M-5-5L5 5M5-5L-5 5\" \
                 stroke=\"#ffffff\" stroke-width=\"4\"/><path d=\"M-5-5L5 5M5-5L-5 5\" stroke=\"{INK}\" \
                 stroke-width=\"2\"/></g>"
            );
            return;
        }
    };
    let (fill, edge, width) = if filled { (INK, "#ffffff", 1.2) } else { ("#ffffff", INK, 1.8) };
    let _ = writeln!(
        svg,
        "<path d=\"{d}\" transform=\"translate({x:.1} {y:.1})\" fill=\"{fill}\" stroke=\"{edge}\" \
         stroke-width=\"{width}\"/>"
    );
}
