//! SVG to PNG, with the shipped font and no other.

use super::{BOLD, FONT};
use resvg::{tiny_skia, usvg};
use std::sync::Arc;

/// Pixels of the picture to a pixel of the drawing.
const SCALE: f32 = 2.0;

/// Why a drawing could not be made a picture.
#[derive(Debug, thiserror::Error)]
pub enum DrawingError {
    /// The drawing is not valid.
    #[error("the drawing cannot be read: {0}")]
    Drawing(#[from] usvg::Error),
    /// The picture has no size, or one beyond what can be held.
    #[error("a picture of {width} by {height} pixels cannot be made")]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// The encoder failed.
    #[error("the picture cannot be encoded: {0}")]
    Encoding(String),
}

/// The drawing as PNG.
///
/// # Errors
/// When it is not valid or too large.
pub fn png(svg: &str) -> Result<Vec<u8>, DrawingError> {
    let tree = tree(svg)?;
    let size = tree.size();
    let (width, height) =
        ((size.width() * SCALE).ceil() as u32, (size.height() * SCALE).ceil() as u32);
    let mut pixels =
        tiny_skia::Pixmap::new(width, height).ok_or(DrawingError::Size { width, height })?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    pixels.encode_png().map_err(|error| DrawingError::Encoding(error.to_string()))
}

/// The drawing, read with the shipped font.
pub(super) fn tree(svg: &str) -> Result<usvg::Tree, DrawingError> {
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(FONT.to_vec());
    fonts.load_font_data(BOLD.to_vec());
    fonts.set_sans_serif_family("DejaVu Sans");
    let options = usvg::Options { fontdb: Arc::new(fonts), ..usvg::Options::default() };
    Ok(usvg::Tree::from_str(svg, &options)?)
}
