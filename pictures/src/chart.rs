//! One chart: axes, lines, markers, and a legend beside them that covers nothing.

use super::axis::Axis;
use super::palette::{FAINT, Form, GRID, form};
use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use study::record::view::{Mark, Stability, drawable};

/// Why a picture could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the picture \"{picture}\" could not be drawn: {detail}")]
pub struct DrawError {
    /// Which picture.
    pub picture: String,
    /// What the drawing library says.
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

    /// Lengths of a dash and of the gap after it.
    fn pattern(self) -> Option<(i32, i32)> {
        match self {
            Stroke::Solid => None,
            Stroke::Dashed => Some((7 * PX, 5 * PX)),
            Stroke::Dotted => Some((2 * PX, 3 * PX)),
        }
    }
}

/// A line through points.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Line {
    /// The points, all drawable.
    pub(super) points: Vec<(f64, f64)>,
    /// Its colour.
    pub(super) color: RGBColor,
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
    pub(super) color: RGBColor,
}

/// A line of the legend.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Entry {
    /// A sample of a line.
    Line {
        /// Its colour.
        color: RGBColor,
        /// Solid or not.
        stroke: Stroke,
        /// What it stands for.
        label: String,
    },
    /// A sample of a tile.
    Tile {
        /// Its colour.
        color: RGBColor,
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

/// Everything on a chart.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chart {
    /// Title; empty for none.
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

/// Units of drawing per pixel. The library rounds to whole units; ten to a pixel keep curves
/// smooth.
const PX: i32 = 10;
const BOTTOM: i32 = 58 * PX;
const RIGHT: i32 = 18 * PX;
const TOP: i32 = 18 * PX;
const TITLE: i32 = 30 * PX;
const ROW: i32 = 24 * PX;
/// Width of a digit in the labels of ticks.
const DIGIT: i32 = 9 * PX;
const FONT: &str = "Helvetica, Arial, 'DejaVu Sans', sans-serif";
const INK: RGBColor = RGBColor(30, 30, 30);

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type Plot<'a> = DrawingArea<SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
type Outcome = Result<(), Box<dyn std::error::Error>>;

/// The plotting area, in units of drawing.
#[derive(Clone, Copy)]
struct Frame {
    left: i32,
    top: i32,
    right: i32,
    bottom: i32,
}

impl Chart {
    /// The chart as SVG.
    pub(super) fn svg(&self) -> Result<String, DrawError> {
        self.svg_over(&[])
    }

    /// The chart as SVG, on top of tiles.
    pub(super) fn svg_over(&self, tiles: &[Tile]) -> Result<String, DrawError> {
        let frame = self.frame();
        let rows = 20 * PX + ROW * self.legend.len() as i32;
        let width = (frame.right + RIGHT + self.legend_width()) as u32;
        let height = (frame.bottom + BOTTOM).max(frame.top + rows) as u32;
        let mut svg = String::new();
        let outcome = {
            let root = SVGBackend::with_string(&mut svg, (width, height)).into_drawing_area();
            self.draw(&root, frame, tiles).and_then(|()| Ok(root.present()?))
        };
        outcome.map_err(|error| DrawError {
            picture: self.y.title.clone(),
            detail: error.to_string(),
        })?;
        let px = PX as u32;
        let (fine, real) = (
            format!("width=\"{width}\" height=\"{height}\""),
            format!("width=\"{}\" height=\"{}\"", width / px, height / px),
        );
        Ok(svg.replacen(&fine, &format!("{real} stroke-linejoin=\"round\""), 1))
    }

    /// The plotting area: to the right of the widest label.
    fn frame(&self) -> Frame {
        let digits = self.y.ticks.iter().map(|tick| self.y.label(*tick).chars().count());
        let left = 46 * PX + DIGIT * digits.max().unwrap_or(0) as i32;
        let top = TOP + if self.title.is_empty() { 0 } else { TITLE };
        let (width, height) = (self.size.0 as i32 * PX, self.size.1 as i32 * PX);
        Frame { left, top, right: left + width, bottom: top + height }
    }

    fn legend_width(&self) -> i32 {
        let longest = self.legend.iter().map(|entry| match entry {
            Entry::Line { label, .. } | Entry::Tile { label, .. } => label.chars().count(),
            Entry::Marker { kind } => kind.chars().count(),
            Entry::Note { label } => label.chars().count(),
        });
        longest.max().map_or(0, |chars| 62 * PX + 8 * PX * chars as i32)
    }

    fn draw(&self, root: &Area<'_>, frame: Frame, tiles: &[Tile]) -> Outcome {
        root.fill(&WHITE)?;
        if !self.title.is_empty() {
            let style = text(19).pos(Pos::new(HPos::Left, VPos::Center));
            let at = (frame.left, frame.top - 18 * PX);
            root.draw(&Text::new(self.title.clone(), at, style))?;
        }
        let plot =
            root.clone().apply_coord_spec(Cartesian2d::<RangedCoordf64, RangedCoordf64>::new(
                self.x.low..self.x.high,
                self.y.low..self.y.high,
                (frame.left..frame.right, frame.bottom..frame.top),
            ));
        for Tile { from, to, color } in tiles {
            plot.draw(&Rectangle::new([*from, *to], color.filled()))?;
        }
        self.axes(root, &plot, frame)?;
        for line in &self.lines {
            draw_line(&plot, line)?;
        }
        for mark in self.marks.iter().filter(|mark| drawable(mark.x) && drawable(mark.y)) {
            let at = plot.map_coordinate(&(mark.x / self.x.unit, mark.y / self.y.unit));
            draw_marker(root, form(&mark.kind), at)?;
        }
        self.draw_legend(root, frame.right + RIGHT, frame.top + 12 * PX)
    }

    /// Grid, frame, ticks, labels and titles.
    fn axes(&self, root: &Area<'_>, plot: &Plot<'_>, frame: Frame) -> Outcome {
        let (x, y) = (&self.x, &self.y);
        let Frame { left, top, right, bottom } = frame;
        let line = |from, to, color: RGBColor| {
            root.draw(&PathElement::new([from, to], color.stroke_width(PX as u32)))
        };
        for &tick in &x.ticks {
            let at = plot.map_coordinate(&(tick, y.low)).0;
            line((at, top), (at, bottom), GRID)?;
            line((at, bottom), (at, bottom + 6 * PX), INK)?;
            let style = text(15).pos(Pos::new(HPos::Center, VPos::Top));
            root.draw(&Text::new(x.label(tick), (at, bottom + 10 * PX), style))?;
        }
        for &tick in &y.ticks {
            let at = plot.map_coordinate(&(x.low, tick)).1;
            line((left, at), (right, at), GRID)?;
            line((left - 6 * PX, at), (left, at), INK)?;
            let style = text(15).pos(Pos::new(HPos::Right, VPos::Center));
            root.draw(&Text::new(y.label(tick), (left - 10 * PX, at), style))?;
        }
        if y.has_zero() {
            let at = plot.map_coordinate(&(x.low, 0.0)).1;
            line((left, at), (right, at), FAINT)?;
        }
        // as a path: the library draws rectangles with thin lines only
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        let around = [0, 1, 2, 3, 0, 1].map(|at| corners[at]);
        root.draw(&PathElement::new(around, INK.stroke_width(PX as u32)))?;
        let style = text(17).pos(Pos::new(HPos::Center, VPos::Bottom));
        let middle = ((left + right) / 2, bottom + BOTTOM - 8 * PX);
        root.draw(&Text::new(x.title.clone(), middle, style))?;
        let style =
            text(17).transform(FontTransform::Rotate270).pos(Pos::new(HPos::Center, VPos::Top));
        root.draw(&Text::new(y.title.clone(), (10 * PX, (top + bottom) / 2), style))?;
        Ok(())
    }

    fn draw_legend(&self, root: &Area<'_>, left: i32, top: i32) -> Outcome {
        for (row, entry) in self.legend.iter().enumerate() {
            let y = top + ROW * row as i32;
            let label = match entry {
                Entry::Line { color, stroke, label } => {
                    let points = [(left, y), (left + 34 * PX, y)];
                    let style = color.stroke_width(2 * PX as u32);
                    match stroke.pattern() {
                        Some((dash, gap)) => {
                            root.draw(&DashedPathElement::new(points, dash, gap, style))?;
                        }
                        None => root.draw(&PathElement::new(points, style))?,
                    }
                    label
                }
                Entry::Tile { color, label } => {
                    let corners = [(left + 6 * PX, y - 8 * PX), (left + 28 * PX, y + 8 * PX)];
                    root.draw(&Rectangle::new(corners, color.filled()))?;
                    label
                }
                Entry::Marker { kind } => {
                    draw_marker(root, form(kind), (left + 17 * PX, y))?;
                    kind
                }
                Entry::Note { label } => label,
            };
            let style = text(15).pos(Pos::new(HPos::Left, VPos::Center));
            root.draw(&Text::new(label.clone(), (left + 44 * PX, y), style))?;
        }
        Ok(())
    }
}

fn text(size: i32) -> TextStyle<'static> {
    TextStyle::from((FONT, size * PX).into_font()).color(&INK)
}

/// A line, or a dot where a line has one point only.
fn draw_line(plot: &Plot<'_>, line: &Line) -> Outcome {
    let style = line.color.stroke_width(line.width * PX as u32);
    match line.points.as_slice() {
        [] => {}
        [point] => plot.draw(&Circle::new(*point, 3 * PX, line.color.filled()))?,
        points => match line.stroke.pattern() {
            Some((dash, gap)) => {
                plot.draw(&DashedPathElement::new(points.iter().copied(), dash, gap, style))?;
            }
            None => plot.draw(&PathElement::new(points.to_vec(), style))?,
        },
    }
    Ok(())
}

/// A marker: black with a white rim, so that it stands out from its curve.
fn draw_marker(root: &Area<'_>, form: Form, (x, y): (i32, i32)) -> Outcome {
    let polygon = |corners: &[(i32, i32)], fill: RGBColor| -> Outcome {
        let corners: Vec<(i32, i32)> =
            corners.iter().map(|(a, b)| (x + a * PX, y + b * PX)).collect();
        let mut rim = corners.clone();
        rim.extend(corners.iter().take(2).copied());
        root.draw(&Polygon::new(corners, fill.filled()))?;
        let edge = if fill == INK { WHITE } else { INK };
        Ok(root.draw(&PathElement::new(rim, edge.stroke_width(PX as u32)))?)
    };
    let diamond = [(0, -8), (7, 0), (0, 8), (-7, 0)];
    match form {
        Form::Disc => {
            root.draw(&Circle::new((x, y), 6 * PX, WHITE.filled()))?;
            Ok(root.draw(&Circle::new((x, y), 5 * PX, INK.filled()))?)
        }
        Form::Ring => {
            root.draw(&Circle::new((x, y), 6 * PX, WHITE.filled()))?;
            Ok(root.draw(&Circle::new((x, y), 5 * PX, INK.stroke_width(2 * PX as u32)))?)
        }
        Form::Square => polygon(&[(-6, -6), (6, -6), (6, 6), (-6, 6)], INK),
        Form::Up => polygon(&[(0, -8), (7, 5), (-7, 5)], INK),
        Form::Down => polygon(&[(0, 8), (7, -5), (-7, -5)], INK),
        Form::Diamond => polygon(&diamond, INK),
        Form::HollowDiamond => polygon(&diamond, WHITE),
        Form::Cross => {
            for (color, width) in [(WHITE, 4), (INK, 2)] {
                for sign in [-1, 1] {
                    let (a, b) = (5 * PX, 5 * PX * sign);
                    let ends = [(x - a, y - b), (x + a, y + b)];
                    root.draw(&PathElement::new(ends, color.stroke_width(width * PX as u32)))?;
                }
            }
            Ok(())
        }
    }
}
