//! A figure of several panels as SVG, and the same as PNG and PDF.
//!
//! Panels stand in two columns, each with its legend beside it, so that no legend covers a curve.
//! Lines are cut at the frame; data are solid where stable and dashed where not, laws are dotted.

mod panel;
mod pdf;
mod png;

pub use pdf::pdf;
pub use png::{DrawingError, png};

use super::look::Look;
use super::palette::{Color, of_quantity, of_state};
use super::text;
use panel::Layout;
use std::fmt::Write;
use study::case::PictureCase;
use study::record::view::Curve;

/// The regular face of the shipped font.
pub const FONT: &[u8] = include_bytes!("../../fonts/DejaVuSans-subset.ttf");
/// Its bold face.
pub const BOLD: &[u8] = include_bytes!("../../fonts/DejaVuSans-Bold-subset.ttf");
/// The fonts of texts in a figure: the shipped one, or one of the same widths.
pub const FAMILY: &str = "'DejaVu Sans', Verdana, sans-serif";

/// What gives a line its colour.
#[derive(Debug, Clone, PartialEq)]
pub enum Ink {
    /// A quantity: the same in every figure.
    Quantity(&'static str),
    /// The place in a list of states or of curves: the same for all panels that show them.
    Place(usize),
    /// A law, by its own place: the same in every figure.
    Law(usize),
    /// What is there for comparison only.
    Faint,
}

impl Ink {
    fn color(&self) -> Color {
        match self {
            Ink::Quantity(name) => of_quantity(name),
            Ink::Place(at) => of_state(*at),
            // not black, which is the first curve's
            Ink::Law(at) => of_state(2 + *at % 5),
            Ink::Faint => super::palette::FAINT,
        }
    }
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pen {
    /// Data: solid where stable, dashed where not.
    Data,
    /// A law: dotted.
    Law,
    /// Thin and solid: plates.
    Thin,
    /// The points alone.
    Points,
}

/// A line of a panel with its entry in the legend.
#[derive(Debug, Clone, PartialEq)]
pub struct PanelLine {
    /// For the legend; empty for none. `_{…}` and `^{…}` set small.
    pub label: String,
    /// Its colour.
    pub ink: Ink,
    /// How it is drawn.
    pub pen: Pen,
    /// Whether it belongs to the right axis.
    pub right: bool,
    /// Its points; the label of the curve itself is not shown.
    pub curve: Curve,
}

/// One panel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Panel {
    /// Title, with the letter.
    pub title: String,
    /// Title of the horizontal axis.
    pub x: String,
    /// Title of the vertical axis.
    pub y: String,
    /// Title of the right axis, if it has one.
    pub right: Option<String>,
    /// Lines, the first at the bottom.
    pub lines: Vec<PanelLine>,
    /// Range of the horizontal axis; all data without one.
    pub x_range: Option<[f64; 2]>,
    /// Range of the vertical axis; all data inside the horizontal one without.
    pub y_range: Option<[f64; 2]>,
    /// Whether a unit is as long on both axes.
    pub proportional: bool,
    /// What dashes mean, if not "unstable".
    pub dashed: Option<&'static str>,
}

/// A figure.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sheet {
    /// Title.
    pub title: String,
    /// A line below it.
    pub subtitle: String,
    /// Panels, row by row.
    pub panels: Vec<Panel>,
}

/// Panels side by side.
const COLUMNS: usize = 2;
const MARGIN: f64 = 16.0;
const HEAD: f64 = 64.0;

impl Sheet {
    /// The figure as SVG.
    pub fn svg(&self, picture: &PictureCase) -> String {
        match picture.parts.title {
            true => self.drawing(&self.title, &self.subtitle, Look::of(picture)),
            false => self.drawing("", "", Look::of(picture)),
        }
    }

    /// Each panel alone, for a page that has the title and as many columns as fit.
    pub fn parts(&self, picture: &PictureCase) -> Vec<String> {
        let layouts = self.layouts(Look::of(picture));
        // all are equally wide, so that a page scales them alike
        let width = layouts.iter().map(|layout| layout.width).fold(0.0, f64::max);
        let alone = |layout: &Layout<'_>| {
            let mut body = String::new();
            layout.draw(&mut body, MARGIN, MARGIN);
            page([width + 2.0 * MARGIN, layout.height + 2.0 * MARGIN], &body)
        };
        layouts.iter().map(alone).collect()
    }

    /// The panels with their sizes; those of a row are equally high.
    fn layouts(&self, look: Look) -> Vec<Layout<'_>> {
        let mut layouts: Vec<Layout<'_>> =
            self.panels.iter().enumerate().map(|(i, p)| Layout::of(p, i, look)).collect();
        for row in layouts.chunks_mut(COLUMNS) {
            let height = row.iter().map(|layout| layout.plot[1]).fold(0.0, f64::max);
            row.iter_mut().for_each(|layout| layout.heighten(height));
        }
        layouts
    }

    fn drawing(&self, title: &str, subtitle: &str, look: Look) -> String {
        let layouts = self.layouts(look);
        let columns = layouts.len().clamp(1, COLUMNS);
        let mut widths = vec![0.0_f64; columns];
        for (i, layout) in layouts.iter().enumerate() {
            widths[i % columns] = widths[i % columns].max(layout.width);
        }
        let header =
            text::width(title, 20.0 * look.letters).max(text::width(subtitle, 13.0 * look.letters));
        let width = (widths.iter().sum::<f64>() + MARGIN * (columns as f64 + 1.0))
            .max(header + 2.0 * MARGIN);
        let mut body = String::new();
        let mut top = if title.is_empty() { MARGIN } else { 8.0 + (HEAD - 8.0) * look.letters };
        for row in layouts.chunks(columns) {
            let mut left = MARGIN;
            for (layout, column) in row.iter().zip(&widths) {
                layout.draw(&mut body, left, top);
                left += column + MARGIN;
            }
            top += row.iter().fold(0.0_f64, |h, layout| h.max(layout.height)) + MARGIN;
        }
        let mut svg = String::new();
        let style = text::Style::title().sized(20.0 * look.letters);
        text::put(&mut svg, title, [MARGIN, 8.0 + 20.0 * look.letters], &style);
        let style = text::Style::small().sized(13.0 * look.letters);
        text::put(&mut svg, subtitle, [MARGIN, 8.0 + 42.0 * look.letters], &style);
        svg.push_str(&body);
        page([width, top], &svg)
    }
}

/// A drawing of a size with what is on it.
fn page([width, height]: [f64; 2], body: &str) -> String {
    let mut svg = String::new();
    let _ = write!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"{FAMILY}\" stroke-linejoin=\"round\" \
         fill=\"none\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{body}</svg>\n"
    );
    svg
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet() -> Sheet {
        let x: Vec<f64> = (0..200).map(|i| f64::from(i) / 100.0).collect();
        let y = x.iter().map(|x| x * x).collect();
        let unstable = x.iter().map(|x| *x > 1.0).collect();
        let curve = Curve { x, y, unstable, ..Curve::default() };
        let line = |label: &str, pen, right| PanelLine {
            label: label.into(),
            ink: Ink::Place(0),
            pen,
            right,
            curve: curve.clone(),
        };
        let panel = Panel {
            title: "(a) k_{b} < 3 & more".into(),
            x: "Δ/R_{0}".into(),
            y: "F\u{302}".into(),
            right: Some("W\u{302}_{s}".into()),
            lines: vec![line("data", Pen::Data, false), line("law", Pen::Law, true)],
            x_range: Some([0.0, 1.5]),
            ..Panel::default()
        };
        Sheet { title: "T".into(), subtitle: "s".into(), panels: vec![panel.clone(), panel] }
    }

    #[test]
    fn svg_is_well_formed_and_lines_are_cut_at_the_frame() {
        let svg = sheet().svg(&PictureCase::default());
        assert_eq!(svg.matches("<clipPath").count(), 2);
        assert!(svg.contains("stroke-dasharray") && svg.contains("&lt; 3 &amp; more"));
        assert!(resvg::usvg::Tree::from_str(&svg, &resvg::usvg::Options::default()).is_ok());
    }

    #[test]
    fn png_has_ink_of_text_without_any_font_of_the_machine() {
        let with = png(&sheet().svg(&PictureCase::default())).unwrap();
        let mut bare = sheet();
        bare.title = String::new();
        let without = png(&bare.svg(&PictureCase::default())).unwrap();
        assert_eq!(&with[1..4], b"PNG");
        assert!(with != without);
    }
}
