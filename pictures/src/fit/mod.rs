//! Fits as pictures.

mod page;
mod picture;
mod smooth;

pub use page::fit_report;

use crate::{DrawingError, png};
use study::case::PictureCase;
use study::fit::Outcome;

/// Names of the pictures of a fit.
pub const NAMES: [&str; 4] = ["fit.svg", "fit.png", "profile.svg", "profile.png"];

/// What is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drawn {
    /// Nothing.
    Nothing,
    /// SVG alone: a batch holds the files of all its curves until the end, and PNG are ten times as large.
    Svg,
    /// SVG, and the same as PNG.
    SvgAndPng,
}

/// Why a picture could not be made.
#[derive(Debug, thiserror::Error)]
#[error("{name}.png: {error}")]
pub struct PictureError {
    /// Which.
    name: &'static str,
    /// What happened.
    error: DrawingError,
}

/// The pictures of a fit: file name and content.
///
/// # Errors
/// When the drawing library fails.
pub fn draw_fit(
    outcome: &Outcome,
    drawn: Drawn,
    look: &PictureCase,
) -> Result<Vec<(String, Vec<u8>)>, PictureError> {
    let mut files = Vec::new();
    if drawn == Drawn::Nothing {
        return Ok(files);
    }
    let drawings = [
        ("fit", Some(picture::fit(outcome, look))),
        ("profile", picture::profiles(&outcome.best.report, look)),
    ];
    for (name, svg) in drawings {
        let Some(svg) = svg else { continue };
        if drawn == Drawn::SvgAndPng {
            let pixels = png(&svg).map_err(|error| PictureError { name, error })?;
            files.push((format!("{name}.png"), pixels));
        }
        files.push((format!("{name}.svg"), svg.into_bytes()));
    }
    Ok(files)
}
