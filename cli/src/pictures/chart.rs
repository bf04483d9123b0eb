//! One chart: axes, lines, markers, and a legend beside them that covers nothing.

use super::axis::Axis;
use super::data::{Mark, drawable};
use super::palette::{FAINT, Form, GRID, form};
use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Why a picture could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the picture \"{picture}\" could not be drawn: {detail}")]
pub(crate) struct DrawError {
    /// Which picture.
    pub(crate) picture: String,
    /// What the drawing library says.
    pub(crate) detail: String,
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
    /// Solid or dashed.
    pub(super) dashed: bool,
}

/// A line of the legend.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Entry {
    /// A sample of a line.
    Line {
        /// Its colour.
        color: RGBColor,
        /// Solid or dashed.
        dashed: bool,
        /// What it stands for.
        label: String,
    },
    /// A marker.
    Marker {
        /// Kind of special point.
        kind: String,
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

const LEFT: u32 = 92;
const BOTTOM: u32 = 64;
const RIGHT: u32 = 18;
const TOP: u32 = 24;
const TITLE: u32 = 30;
const ROW: i32 = 24;
const FONT: &str = "Helvetica, Arial, 'DejaVu Sans', sans-serif";
const INK: RGBColor = RGBColor(30, 30, 30);

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type Context<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
type Outcome = Result<(), Box<dyn std::error::Error>>;

impl Chart {
    /// The chart as SVG.
    pub(super) fn svg(&self) -> Result<String, DrawError> {
        let top = TOP + if self.title.is_empty() { 0 } else { TITLE };
        let legend = self.legend_width();
        let width = LEFT + self.size.0 + RIGHT + legend;
        let rows = 20 + ROW as u32 * self.legend.len() as u32;
        let height = (top + self.size.1 + BOTTOM).max(top + rows);
        let mut svg = String::new();
        let outcome = {
            let root = SVGBackend::with_string(&mut svg, (width, height)).into_drawing_area();
            self.draw(&root, top).and_then(|()| Ok(root.present()?))
        };
        outcome.map_err(|error| DrawError {
            picture: self.y.title.clone(),
            detail: error.to_string(),
        })?;
        Ok(svg)
    }

    fn legend_width(&self) -> u32 {
        let longest = self.legend.iter().map(|entry| match entry {
            Entry::Line { label, .. } => label.chars().count(),
            Entry::Marker { kind } => kind.chars().count(),
        });
        longest.max().map_or(0, |chars| 62 + 8 * chars as u32)
    }

    fn draw(&self, root: &Area<'_>, top: u32) -> Outcome {
        root.fill(&WHITE)?;
        if !self.title.is_empty() {
            let style = text(19).pos(Pos::new(HPos::Left, VPos::Center));
            root.draw(&Text::new(self.title.clone(), (LEFT as i32, top as i32 - 20), style))?;
        }
        let (x, y) = (&self.x, &self.y);
        let (width, height) = root.dim_in_pixel();
        let rest = height - top - self.size.1 - BOTTOM;
        let plot = root.clone().shrink((0, top), (LEFT + self.size.0, height - top));
        let mut chart = ChartBuilder::on(&plot)
            .set_label_area_size(LabelAreaPosition::Left, LEFT)
            .set_label_area_size(LabelAreaPosition::Bottom, BOTTOM)
            .margin_bottom(rest)
            .build_cartesian_2d(x.low..x.high, y.low..y.high)?;
        self.axes(&mut chart, root, top)?;
        for line in &self.lines {
            draw_line(&mut chart, line)?;
        }
        for mark in self.marks.iter().filter(|mark| drawable(mark.x) && drawable(mark.y)) {
            let at = chart.backend_coord(&(mark.x / x.unit, mark.y / y.unit));
            draw_marker(root, form(&mark.kind), at)?;
        }
        let left = (LEFT + self.size.0 + RIGHT) as i32;
        debug_assert!(left <= width as i32);
        self.draw_legend(root, left, top as i32 + 12)
    }

    /// Grid, frame, ticks, labels and titles. The library's own mesh cannot place ticks where
    /// round numbers are, so all of it is drawn here.
    fn axes(&self, chart: &mut Context<'_, '_>, root: &Area<'_>, top: u32) -> Outcome {
        let (x, y) = (&self.x, &self.y);
        let left = LEFT as i32;
        let (right, above) = (left + self.size.0 as i32 - 1, top as i32);
        let below = above + self.size.1 as i32 - 1;
        let line = |from, to, style: ShapeStyle| root.draw(&PathElement::new([from, to], style));
        for &tick in &x.ticks {
            let at = chart.backend_coord(&(tick, y.low)).0;
            line((at, above), (at, below), GRID.stroke_width(1))?;
            line((at, below), (at, below + 6), INK.stroke_width(1))?;
            let style = text(15).pos(Pos::new(HPos::Center, VPos::Top));
            root.draw(&Text::new(x.label(tick), (at, below + 10), style))?;
        }
        for &tick in &y.ticks {
            let at = chart.backend_coord(&(x.low, tick)).1;
            line((left, at), (right, at), GRID.stroke_width(1))?;
            line((left - 6, at), (left, at), INK.stroke_width(1))?;
            let style = text(15).pos(Pos::new(HPos::Right, VPos::Center));
            root.draw(&Text::new(y.label(tick), (left - 10, at), style))?;
        }
        if y.has_zero() {
            let at = chart.backend_coord(&(x.low, 0.0)).1;
            line((left, at), (right, at), FAINT.stroke_width(1))?;
        }
        root.draw(&Rectangle::new([(left, above), (right, below)], INK.stroke_width(1)))?;
        let style = text(17).pos(Pos::new(HPos::Center, VPos::Bottom));
        let middle = ((left + right) / 2, below + BOTTOM as i32 - 6);
        root.draw(&Text::new(x.title.clone(), middle, style))?;
        let style = text(17)
            .transform(FontTransform::Rotate270)
            .pos(Pos::new(HPos::Center, VPos::Top));
        let middle = (14, (above + below) / 2);
        root.draw(&Text::new(y.title.clone(), middle, style))?;
        Ok(())
    }

    fn draw_legend(&self, root: &Area<'_>, left: i32, top: i32) -> Outcome {
        for (row, entry) in self.legend.iter().enumerate() {
            let y = top + ROW * row as i32;
            let label = match entry {
                Entry::Line { color, dashed, label } => {
                    let points = [(left, y), (left + 34, y)];
                    let style = color.stroke_width(2);
                    if *dashed {
                        root.draw(&DashedPathElement::new(points, 7, 5, style))?;
                    } else {
                        root.draw(&PathElement::new(points, style))?;
                    }
                    label
                }
                Entry::Marker { kind } => {
                    draw_marker(root, form(kind), (left + 17, y))?;
                    kind
                }
            };
            let style = text(15).pos(Pos::new(HPos::Left, VPos::Center));
            root.draw(&Text::new(label.clone(), (left + 44, y), style))?;
        }
        Ok(())
    }
}

fn text(size: u32) -> TextStyle<'static> {
    TextStyle::from((FONT, size).into_font()).color(&INK)
}

/// A line, or a dot where a line has one point only.
fn draw_line(chart: &mut Context<'_, '_>, line: &Line) -> Outcome {
    let style = line.color.stroke_width(line.width);
    match line.points.as_slice() {
        [] => {}
        [point] => {
            chart.draw_series([Circle::new(*point, 3, line.color.filled())])?;
        }
        points if line.dashed => {
            chart.draw_series(DashedLineSeries::new(points.iter().copied(), 7, 5, style))?;
        }
        points => {
            chart.draw_series([PathElement::new(points.to_vec(), style)])?;
        }
    }
    Ok(())
}

/// A marker: black with a white rim, so that it stands out from its curve.
fn draw_marker(root: &Area<'_>, form: Form, (x, y): (i32, i32)) -> Outcome {
    let polygon = |corners: &[(i32, i32)], fill: RGBColor| -> Outcome {
        let corners: Vec<(i32, i32)> = corners.iter().map(|(a, b)| (x + a, y + b)).collect();
        let mut rim = corners.clone();
        rim.extend(corners.iter().take(2).copied());
        root.draw(&Polygon::new(corners, fill.filled()))?;
        let edge = if fill == INK { WHITE } else { INK };
        Ok(root.draw(&PathElement::new(rim, edge.stroke_width(1)))?)
    };
    let diamond = [(0, -8), (7, 0), (0, 8), (-7, 0)];
    match form {
        Form::Disc => {
            root.draw(&Circle::new((x, y), 6, WHITE.filled()))?;
            Ok(root.draw(&Circle::new((x, y), 5, INK.filled()))?)
        }
        Form::Ring => {
            root.draw(&Circle::new((x, y), 6, WHITE.filled()))?;
            Ok(root.draw(&Circle::new((x, y), 5, INK.stroke_width(2)))?)
        }
        Form::Square => polygon(&[(-6, -6), (6, -6), (6, 6), (-6, 6)], INK),
        Form::Up => polygon(&[(0, -8), (7, 5), (-7, 5)], INK),
        Form::Down => polygon(&[(0, 8), (7, -5), (-7, -5)], INK),
        Form::Diamond => polygon(&diamond, INK),
        Form::HollowDiamond => polygon(&diamond, WHITE),
        Form::Cross => {
            for (color, width) in [(WHITE, 4), (INK, 2)] {
                for sign in [-1, 1] {
                    let ends = [(x - 5, y - 5 * sign), (x + 5, y + 5 * sign)];
                    root.draw(&PathElement::new(ends, color.stroke_width(width)))?;
                }
            }
            Ok(())
        }
    }
}
