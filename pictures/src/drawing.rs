//! A chart as SVG: frame, axes, lines, special points, legend and details, each in its place.

use super::chart::{Arrow, Chart, Entry, Frame, Line};
use super::detail::Detail;
use super::label::{self, Names};
use super::look::Look;
use super::marker::{INK, draw_marker};
use super::palette::{Color, FAINT, GRID, form, hex};
use super::path::{self, Place};
use super::sheet::FAMILY;
use super::text::{self, Style};
use std::fmt::Write as _;
use study::record::view::{Mark, drawable};

const BOTTOM: f64 = 58.0;
pub(super) const RIGHT: f64 = 18.0;
const TOP: f64 = 18.0;
const TITLE: f64 = 30.0;
const SUBTITLE: f64 = 20.0;
const ROW: f64 = 24.0;
/// Length of an arrow's head, and half its width.
const HEAD: (f64, f64) = (13.0, 5.0);
/// Sizes of letters: title, axes, ticks and legend, names of special points.
pub(super) const LETTERS: [f64; 4] = [18.0, 16.0, 14.0, 13.0];

/// A chart that is being drawn.
pub(super) struct Drawing<'c> {
    pub(super) chart: &'c Chart,
    pub(super) look: Look,
}

impl Drawing<'_> {
    /// So many pixels with the usual letters.
    pub(super) fn scaled(&self, pixels: f64) -> f64 {
        self.look.letters * pixels
    }

    pub(super) fn svg(&self) -> String {
        let chart = self.chart;
        let legend = self.legend_width();
        let heading = self.heading();
        let frame = self.frame(heading.len());
        let rows = match self.entries() {
            [] => 0.0,
            entries => 20.0 + self.scaled(ROW) * entries.len() as f64,
        };
        let details = match self.look.parts.inset {
            true => Detail::all(self, frame, [frame.right + RIGHT, frame.top + rows, legend]),
            false => Vec::new(),
        };
        let beside = details.iter().map(Detail::right).fold(frame.right + RIGHT + legend, f64::max);
        let sizes = [LETTERS[0], LETTERS[3]];
        let above = heading.iter().enumerate().map(|(at, line)| {
            text::width(line, self.scaled(sizes[at.min(1)])) * if at == 0 { 1.06 } else { 1.0 }
        });
        let width = beside.max(frame.left + above.fold(0.0, f64::max) + RIGHT);
        let below =
            details.iter().map(Detail::bottom).fold(frame.bottom + self.scaled(BOTTOM), f64::max);
        let height = below.max(frame.top + rows);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"{FAMILY}\" fill=\"none\" \
             stroke-linejoin=\"round\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
        );
        for tile in &chart.tiles {
            let ((a, b), (c, d)) = (frame.place(tile.from), frame.place(tile.to));
            rectangle(&mut svg, [a.min(c), b.min(d), (c - a).abs(), (d - b).abs()], tile.color);
        }
        clip(&mut svg, "frame", frame);
        for (points, color) in &chart.regions {
            let places: Vec<Place> = points.iter().map(|point| frame.place(*point)).collect();
            let d = path::straight(&places);
            let _ = writeln!(svg, "<path d=\"{d}Z\" fill=\"{}\"/>", hex(*color));
        }
        svg.push_str("</g>\n");
        self.axes(&mut svg, frame);
        self.heading_text(&mut svg, frame, &heading);
        svg.push_str("<g clip-path=\"url(#frame)\">\n");
        for line in &chart.lines {
            let places: Vec<Place> = line.points.iter().map(|point| frame.place(*point)).collect();
            draw_line(&mut svg, line, &places, self.look.line);
        }
        self.arrows(&mut svg, frame);
        svg.push_str("</g>\n");
        for detail in &details {
            detail.mark(&mut svg);
        }
        self.special_points(&mut svg, frame, &chart.lines);
        self.draw_legend(&mut svg, frame.right + RIGHT, frame.top + 12.0);
        for detail in &details {
            detail.draw(self, &mut svg);
        }
        svg.push_str("</svg>\n");
        svg
    }

    /// Heads of arrows, as large in every frame.
    pub(super) fn arrows(&self, svg: &mut String, frame: Frame) {
        for Arrow { from, to, color } in &self.chart.arrows {
            let ((ax, ay), (bx, by)) = (frame.place(*from), frame.place(*to));
            let length = (bx - ax).hypot(by - ay);
            if !(length > 0.0 && drawable(length) && frame.holds((bx, by))) {
                continue;
            }
            let (dx, dy) = ((bx - ax) / length, (by - ay) / length);
            let (back, side) = (self.scaled(HEAD.0), self.scaled(HEAD.1));
            let corner =
                |way: f64| (bx - back * dx - way * side * dy, by - back * dy + way * side * dx);
            let d = path::straight(&[corner(1.0), (bx, by), corner(-1.0)]);
            let width = 2.0 * self.look.line;
            let _ = writeln!(
                svg,
                "<path d=\"{d}\" stroke=\"{}\" stroke-width=\"{width}\"/>",
                hex(*color)
            );
        }
    }

    /// The entries of the legend that are shown.
    fn entries(&self) -> &[Entry] {
        if self.look.parts.legend { &self.chart.legend } else { &[] }
    }

    /// Title and the lines below it, broken where they are much longer than the chart is wide.
    fn heading(&self) -> Vec<String> {
        if !self.look.parts.title || self.chart.title.is_empty() {
            return Vec::new();
        }
        let (title, more) = self.chart.title.split_once('\n').unwrap_or((&self.chart.title, ""));
        let mut lines = vec![title.to_owned()];
        let room = self.look.area(self.chart.size).0 + 0.7 * self.legend_width();
        let mut line = String::new();
        for part in more.split_inclusive([',', ';']) {
            let longer = format!("{line}{part}");
            if !line.is_empty() && text::width(longer.trim(), self.scaled(LETTERS[3])) > room {
                lines.push(line.trim().to_owned());
                line = part.to_owned();
            } else {
                line = longer;
            }
        }
        if !line.trim().is_empty() {
            lines.push(line.trim().to_owned());
        }
        lines
    }

    fn heading_text(&self, svg: &mut String, frame: Frame, heading: &[String]) {
        let small = self.scaled(SUBTITLE) * heading.len().saturating_sub(1) as f64;
        for (at, line) in heading.iter().enumerate() {
            if at == 0 {
                let style = Style::title().sized(self.scaled(LETTERS[0]));
                text::put(svg, line, [frame.left, frame.top - 12.0 - small], &style);
            } else {
                let style = Style::small().sized(self.scaled(LETTERS[3]));
                let up = small - self.scaled(SUBTITLE) * at as f64;
                text::put(svg, line, [frame.left, frame.top - 11.0 - up], &style);
            }
        }
    }

    /// The plotting area: to the right of the widest label.
    fn frame(&self, heading: usize) -> Frame {
        let Chart { x, y, .. } = self.chart;
        let labels =
            y.ticks.iter().map(|tick| text::width(&y.label(*tick), self.scaled(LETTERS[2])));
        let left = (14.0 + self.scaled(36.0) + labels.fold(0.0, f64::max)).ceil();
        let above = match heading {
            0 => 0.0,
            lines => self.scaled(TITLE) + self.scaled(SUBTITLE) * (lines - 1) as f64,
        };
        let top = TOP + above;
        let (width, height) = match self.chart.proportional {
            true => (f64::from(self.chart.size.0), f64::from(self.chart.size.1)),
            false => self.look.area(self.chart.size),
        };
        let (right, bottom) = (left + width, top + height);
        Frame { left, top, right, bottom, x: (x.low, x.high), y: (y.low, y.high) }
    }

    fn legend_width(&self) -> f64 {
        let letters = self.scaled(LETTERS[2]);
        let longest = self.entries().iter().map(|entry| text::width(&entry.label(), letters));
        let samples = if self.entries().is_empty() { 0.0 } else { 58.0 };
        longest.fold(0.0, f64::max) + samples
    }

    /// Grid, frame, ticks, labels and titles.
    fn axes(&self, svg: &mut String, frame: Frame) {
        let Chart { x, y, .. } = self.chart;
        let Frame { left, top, right, bottom, .. } = frame;
        let ticks = Style::small().sized(self.scaled(LETTERS[2]));
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
        if self.look.parts.grid {
            let _ = writeln!(svg, "<path d=\"{grid}\" stroke=\"{}\"/>", hex(GRID));
        }
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
        let below = self.scaled(LETTERS[2]) + 7.0;
        for &tick in &x.ticks {
            let at = [frame.place((tick, y.low)).0, bottom + below];
            text::put(svg, &x.label(tick), at, &ticks.anchored("middle"));
        }
        for &tick in &y.ticks {
            let at = [left - 10.0, frame.place((x.low, tick)).1 + self.scaled(5.0)];
            text::put(svg, &y.label(tick), at, &ticks.anchored("end"));
        }
        let titles = Style::small().sized(self.scaled(LETTERS[1])).anchored("middle");
        let across = 0.5 * (left + right);
        let title = [across, bottom + self.scaled(BOTTOM - 12.0)];
        text::put(svg, &x.title, title, &fitting(&x.title, titles, right - left));
        let title = [6.0 + self.scaled(LETTERS[1]), 0.5 * (top + bottom)];
        text::put(svg, &y.title, title, &fitting(&y.title, titles, bottom - top).upwards());
    }

    /// Markers, the more important ones on top, and their names where there is room.
    pub(super) fn special_points(&self, svg: &mut String, frame: Frame, lines: &[Line]) {
        let chart = self.chart;
        let mut marks: Vec<(&Mark, Place)> = Vec::new();
        let all = label::labels(chart.marks.iter().map(|mark| mark.kind.as_str()));
        let mut names: Vec<String> = Vec::new();
        for (mark, name) in chart.marks.iter().zip(all) {
            let point = (chart.x.place(mark.x), chart.y.place(mark.y));
            let place = frame.place(point);
            if drawable(point.0) && drawable(point.1) && frame.holds(place) {
                marks.push((mark, place));
                names.push(name);
            }
        }
        let lines: Vec<Vec<Place>> = lines
            .iter()
            .map(|line| line.points.iter().map(|point| frame.place(*point)).collect())
            .collect();
        let names = match self.look.parts.names {
            true => Names::beside(&marks, names, &lines, frame, self.scaled(LETTERS[3])),
            false => Names::default(),
        };
        marks.sort_by_key(|(mark, _)| label::rank(&mark.kind));
        for (mark, place) in &marks {
            draw_marker(svg, form(&mark.kind), *place, self.look.letters);
        }
        names.draw(svg);
    }

    fn draw_legend(&self, svg: &mut String, left: f64, top: f64) {
        for (row, entry) in self.entries().iter().enumerate() {
            let y = top + self.scaled(ROW) * row as f64;
            match entry {
                Entry::Line { color, stroke, .. } => {
                    let line =
                        Line { points: Vec::new(), color: *color, width: 2, stroke: *stroke };
                    draw_line(svg, &line, &[(left, y), (left + 34.0, y)], self.look.line);
                }
                Entry::Tile { color, .. } => {
                    rectangle(svg, [left + 6.0, y - 8.0, 22.0, 16.0], *color);
                }
                Entry::Marker { kind } => {
                    draw_marker(svg, form(kind), (left + 17.0, y), self.look.letters);
                }
                Entry::Note { .. } => {}
            }
            let style = Style::small().sized(self.scaled(LETTERS[2]));
            text::put(svg, &entry.label(), [left + 44.0, y + self.scaled(5.0)], &style);
        }
    }
}

/// A style in which a text is no longer than this, as far as it stays readable.
fn fitting(text: &str, style: Style, room: f64) -> Style {
    let width = text::width(text, style.size);
    style.sized(if width > room { style.size * (room / width).max(0.6) } else { style.size })
}

/// Begins a group that is cut at a frame.
pub(super) fn clip(svg: &mut String, id: &str, frame: Frame) {
    let Frame { left, top, right, bottom, .. } = frame;
    let _ = writeln!(
        svg,
        "<clipPath id=\"{id}\"><rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{:.1}\" \
         height=\"{:.1}\"/></clipPath>\n<g clip-path=\"url(#{id})\">",
        right - left,
        bottom - top
    );
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
pub(super) fn draw_line(svg: &mut String, line: &Line, places: &[Place], scale: f64) {
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
                width(line, scale),
                line.stroke.pattern()
            );
        }
    }
}

/// How wide a line is drawn: curves as a case asks for, what helps the eye as it is.
fn width(line: &Line, scale: f64) -> f64 {
    let width = f64::from(line.width);
    if line.width > 1 { width * scale } else { width }
}
