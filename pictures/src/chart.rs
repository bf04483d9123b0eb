//! One chart: axes, lines, markers with their names, and a legend beside them that covers nothing.

use super::axis::Axis;
use super::detail::Sought;
use super::drawing::Drawing;
use super::label;
use super::look::Look;
use super::palette::Color;
use super::path::Place;
use study::case::{AxisCase, AxisScale, PictureCase, shown};
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
    pub(super) fn pattern(self) -> &'static str {
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
    /// Its width in pixels; what is thinner than two is no curve, but helps the eye.
    pub(super) width: u32,
    /// Solid or not.
    pub(super) stroke: Stroke,
}

impl Line {
    /// Whether it is a curve of what is unstable.
    pub(super) fn is_unstable(&self) -> bool {
        self.stroke != Stroke::Solid && self.width > 1
    }
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

/// The head of an arrow, in the units of the axes' labels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Arrow {
    /// Where it comes from.
    pub(super) from: (f64, f64),
    /// Where its tip is.
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
    pub(super) fn label(&self) -> String {
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
    /// Coloured rectangles, below everything.
    pub(super) tiles: Vec<Tile>,
    /// Coloured regions, above them: their outlines.
    pub(super) regions: Vec<(Vec<(f64, f64)>, Color)>,
    /// Lines, the first at the bottom.
    pub(super) lines: Vec<Line>,
    /// Heads of arrows.
    pub(super) arrows: Vec<Arrow>,
    /// Special points, on top.
    pub(super) marks: Vec<Mark>,
    /// The legend, from the top.
    pub(super) legend: Vec<Entry>,
    /// Size of the plotting area in pixels.
    pub(super) size: (u32, u32),
    /// Whether a unit is as long on both axes.
    pub(super) proportional: bool,
    /// What is enlarged beside the chart.
    pub(super) details: Sought,
}

/// The plotting area in pixels, and where numbers are in it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
    pub(super) x: (f64, f64),
    pub(super) y: (f64, f64),
}

impl Frame {
    /// The place of a point in the units of the axes' labels.
    pub(super) fn place(&self, (x, y): (f64, f64)) -> Place {
        let across = (x - self.x.0) / (self.x.1 - self.x.0);
        let up = (y - self.y.0) / (self.y.1 - self.y.0);
        (self.left + across * (self.right - self.left), self.bottom - up * (self.bottom - self.top))
    }

    /// The point at a place.
    pub(super) fn point(&self, (x, y): Place) -> (f64, f64) {
        let across = (x - self.left) / (self.right - self.left);
        let up = (self.bottom - y) / (self.bottom - self.top);
        (self.x.0 + across * (self.x.1 - self.x.0), self.y.0 + up * (self.y.1 - self.y.0))
    }

    /// Whether a place is inside, or on the edge.
    pub(super) fn holds(&self, (x, y): Place) -> bool {
        let near = 0.01;
        x >= self.left - near
            && x <= self.right + near
            && y >= self.top - near
            && y <= self.bottom + near
    }
}

impl Chart {
    /// A chart without anything on it.
    pub(super) fn new(title: String, x: Axis, y: Axis, size: (u32, u32)) -> Chart {
        Chart {
            title,
            x,
            y,
            tiles: Vec::new(),
            regions: Vec::new(),
            lines: Vec::new(),
            arrows: Vec::new(),
            marks: Vec::new(),
            legend: Vec::new(),
            size,
            proportional: false,
            details: Sought::Nothing,
        }
    }

    /// The same chart with the axes that a case asks for.
    pub(super) fn with_axes(mut self, x: &AxisCase, y: &AxisCase) -> Chart {
        let logarithmic = |axis: &AxisCase| match axis.scale {
            AxisScale::Automatic => None,
            AxisScale::Linear => Some(false),
            AxisScale::Logarithmic => Some(true),
        };
        let least = |own: &Axis, pick: &dyn Fn((f64, f64)) -> f64| {
            let values = self.lines.iter().flat_map(|line| &line.points);
            let values = values.map(|point| own.value(pick(*point)));
            values.filter(|value| *value > 0.0).fold(f64::INFINITY, f64::min)
        };
        let (lowest, leftmost) = (least(&self.y, &|p| p.1), least(&self.x, &|p| p.0));
        let new_x = self.x.bounded((x.from, x.to), logarithmic(x), leftmost);
        let inside = |a: f64| (new_x.low..=new_x.high).contains(&new_x.place(self.x.value(a)));
        // a part of the horizontal axis is shown as high as what is in it
        let (from, to) = match (x.from.or(x.to), y.from, y.to) {
            (Some(_), None, None) => {
                let points = self.lines.iter().filter(|line| line.width > 1);
                let points = points.flat_map(|line| &line.points).filter(|point| inside(point.0));
                let heights: Vec<f64> = points.map(|point| self.y.value(point.1)).collect();
                let shown = Axis::of("", heights.iter().copied(), 7);
                let some = !heights.is_empty() && !shown.is_like(&self.y);
                (some.then(|| shown.value(shown.low)), some.then(|| shown.value(shown.high)))
            }
            (_, from, to) => (from, to),
        };
        let new_y = self.y.bounded((from, to), logarithmic(y), lowest);
        let moved =
            |(a, b): (f64, f64)| (new_x.place(self.x.value(a)), new_y.place(self.y.value(b)));
        let good = |(a, b): &(f64, f64)| drawable(*a) && drawable(*b);
        let lines = std::mem::take(&mut self.lines);
        self.lines = lines
            .into_iter()
            .flat_map(|line| {
                let points: Vec<(f64, f64)> = line.points.iter().copied().map(moved).collect();
                // what a logarithmic axis has no place for is a gap
                let parts: Vec<Line> = points
                    .split(|point| !good(point))
                    .filter(|part| !part.is_empty())
                    .map(|part| Line { points: part.to_vec(), ..line.clone() })
                    .collect();
                parts
            })
            .collect();
        for (points, _) in &mut self.regions {
            points.iter_mut().for_each(|point| *point = moved(*point));
        }
        for arrow in &mut self.arrows {
            (arrow.from, arrow.to) = (moved(arrow.from), moved(arrow.to));
        }
        for tile in &mut self.tiles {
            (tile.from, tile.to) = (moved(tile.from), moved(tile.to));
        }
        (self.x, self.y) = (new_x, new_y);
        // kinds of special points of which none is left
        let (x, y) = (&self.x, &self.y);
        let left = |kind: &str| {
            self.marks.iter().any(|mark| {
                let (a, b) = (x.place(mark.x), y.place(mark.y));
                shown(&mark.kind) == kind && a >= x.low && a <= x.high && b >= y.low && b <= y.high
            })
        };
        self.legend.retain(|entry| match entry {
            Entry::Marker { kind } => left(kind),
            _ => true,
        });
        self
    }

    /// The chart as SVG.
    pub(super) fn svg(&self, picture: &PictureCase) -> Result<String, DrawError> {
        let look = Look::of(picture);
        let mut chart = self.clone();
        if !look.parts.unstable {
            chart.lines.retain(|line| !line.is_unstable());
            let solid = |entry: &Entry| !matches!(entry, Entry::Line { stroke, .. } if *stroke != Stroke::Solid);
            chart.legend.retain(solid);
        }
        if !look.parts.marks {
            chart.marks.clear();
            chart.legend.retain(|entry| !matches!(entry, Entry::Marker { .. }));
        }
        let standard = look.size == (None, None) && look.letters == 1.0;
        if !standard && !chart.proportional {
            let (width, height) = look.area(chart.size);
            chart.x = chart.x.ticked(look.ticks(width, true));
            chart.y = chart.y.ticked(look.ticks(height, false));
        }
        let drawing = Drawing { chart: &chart, look };
        Ok(drawing.svg())
    }
}
