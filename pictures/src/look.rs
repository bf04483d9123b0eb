//! How charts look: sizes and parts, from the table `[picture]` of a case.

use study::case::{Parts, PictureCase};

/// The size of letters that charts are made for.
const LETTERS: f64 = 14.0;
/// Their width of curves.
const LINE: f64 = 2.0;

/// How a chart looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Look {
    /// Letters, and what goes with them, to those that charts are made for.
    pub(crate) letters: f64,
    /// Curves, likewise.
    pub(crate) line: f64,
    /// Width and height of the plotting area, where they are given.
    pub(crate) size: (Option<f64>, Option<f64>),
    /// What is drawn.
    pub(crate) parts: Parts,
}

impl Look {
    /// The look that a case asks for.
    pub(crate) fn of(picture: &PictureCase) -> Look {
        let pixels = |size: Option<usize>| size.map(|size| size as f64);
        Look {
            letters: picture.font_size / LETTERS,
            line: picture.line_width / LINE,
            size: (pixels(picture.width), pixels(picture.height)),
            parts: picture.parts,
        }
    }

    /// The plotting area of a chart that is made for this one.
    pub(crate) fn area(&self, (width, height): (u32, u32)) -> (f64, f64) {
        (self.size.0.unwrap_or(f64::from(width)), self.size.1.unwrap_or(f64::from(height)))
    }

    /// How many ticks fit on an axis of so many pixels: labels lie across a horizontal one.
    pub(crate) fn ticks(&self, pixels: f64, horizontal: bool) -> usize {
        let room = if horizontal { 84.0 } else { 60.0 };
        ((pixels / (room * self.letters)).round() as usize).clamp(2, 9)
    }
}

impl Default for Look {
    fn default() -> Self {
        Look::of(&PictureCase::default())
    }
}
