//! SVG to PDF: one page of the drawing's size, its letters as outlines, so that it looks the same everywhere.

use super::png::{DrawingError, tree};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Filter, Pdf, Rect, Ref};
use resvg::tiny_skia::{PathSegment, Transform};
use resvg::usvg::{
    Color, Fill, FillRule, Group, LineCap, LineJoin, Node, Paint, PaintOrder, Path, Stroke,
};
use std::io::Write as _;

/// Points of a page to a pixel of the drawing: 96 pixels are an inch, which is 72 points.
const POINT: f32 = 0.75;

/// The drawing as PDF.
///
/// # Errors
/// When it is not valid.
pub fn pdf(svg: &str) -> Result<Vec<u8>, DrawingError> {
    let tree = tree(svg)?;
    let (width, height) = (tree.size().width() * POINT, tree.size().height() * POINT);
    let mut content = Content::new();
    // pages have their origin below
    content.transform([POINT, 0.0, 0.0, -POINT, 0.0, height]);
    group(&mut content, tree.root());
    let raw = content.finish();
    let failed = |error: std::io::Error| DrawingError::Encoding(error.to_string());
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::default());
    packed.write_all(raw.as_slice()).map_err(failed)?;
    let packed = packed.finish().map_err(failed)?;
    let [catalog, pages, page, stream] = [1, 2, 3, 4].map(Ref::new);
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([page]).count(1);
    let mut writer = pdf.page(page);
    writer.parent(pages).media_box(Rect::new(0.0, 0.0, width, height)).contents(stream);
    writer.resources();
    drop(writer);
    pdf.stream(stream, &packed).filter(Filter::FlateDecode);
    Ok(pdf.finish())
}

fn group(content: &mut Content, group: &Group) {
    content.save_state();
    if let Some(clip) = group.clip_path() {
        // charts are cut at rectangles, which have no transformation of their own
        for node in clip.root().children() {
            if let Node::Path(path) = node {
                outline(content, path, path.abs_transform());
            }
        }
        content.clip_nonzero();
        content.end_path();
    }
    for node in group.children() {
        match node {
            Node::Group(inner) => self::group(content, inner),
            Node::Path(path) => draw(content, path),
            Node::Text(text) => self::group(content, text.flattened()),
            Node::Image(_) => {}
        }
    }
    content.restore_state();
}

fn draw(content: &mut Content, path: &Path) {
    if !path.is_visible() {
        return;
    }
    let transform = path.abs_transform();
    let fill_it = |content: &mut Content| {
        if let Some(fill) = path.fill() {
            fill_path(content, path, transform, fill);
        }
    };
    let stroke_it = |content: &mut Content| {
        if let Some(stroke) = path.stroke() {
            stroke_path(content, path, transform, stroke);
        }
    };
    match path.paint_order() {
        PaintOrder::FillAndStroke => {
            fill_it(content);
            stroke_it(content);
        }
        PaintOrder::StrokeAndFill => {
            stroke_it(content);
            fill_it(content);
        }
    }
}

fn fill_path(content: &mut Content, path: &Path, transform: Transform, fill: &Fill) {
    let Some([r, g, b]) = color(fill.paint()) else { return };
    content.set_fill_rgb(r, g, b);
    outline(content, path, transform);
    match fill.rule() {
        FillRule::NonZero => content.fill_nonzero(),
        FillRule::EvenOdd => content.fill_even_odd(),
    };
}

fn stroke_path(content: &mut Content, path: &Path, transform: Transform, stroke: &Stroke) {
    let Some([r, g, b]) = color(stroke.paint()) else { return };
    // markers and letters are scaled alike in both directions
    let scale = transform.get_scale().0;
    content.set_stroke_rgb(r, g, b);
    content.set_line_width(rounded(stroke.width().get() * scale));
    content.set_line_cap(match stroke.linecap() {
        LineCap::Butt => LineCapStyle::ButtCap,
        LineCap::Round => LineCapStyle::RoundCap,
        LineCap::Square => LineCapStyle::ProjectingSquareCap,
    });
    content.set_line_join(match stroke.linejoin() {
        LineJoin::Round => LineJoinStyle::RoundJoin,
        LineJoin::Bevel => LineJoinStyle::BevelJoin,
        LineJoin::Miter | LineJoin::MiterClip => LineJoinStyle::MiterJoin,
    });
    let dashes = stroke.dasharray().unwrap_or_default();
    let dashes = dashes.iter().map(|length| rounded(length * scale));
    content.set_dash_pattern(dashes, rounded(stroke.dashoffset() * scale));
    outline(content, path, transform);
    content.stroke();
}

/// Charts have plain colours only.
fn color(paint: &Paint) -> Option<[f32; 3]> {
    let Paint::Color(Color { red, green, blue }) = paint else { return None };
    Some([*red, *green, *blue].map(|part| (1e3 * f32::from(part) / 255.0).round() / 1e3))
}

/// A hundredth of a pixel is seen by nobody.
fn rounded(value: f32) -> f32 {
    (100.0 * value).round() / 100.0
}

fn outline(content: &mut Content, path: &Path, transform: Transform) {
    let at = |mut point: resvg::tiny_skia::Point| {
        transform.map_point(&mut point);
        (rounded(point.x), rounded(point.y))
    };
    let mut last = resvg::tiny_skia::Point::zero();
    for segment in path.data().segments() {
        match segment {
            PathSegment::MoveTo(to) => {
                let (x, y) = at(to);
                content.move_to(x, y);
                last = to;
            }
            PathSegment::LineTo(to) => {
                let (x, y) = at(to);
                content.line_to(x, y);
                last = to;
            }
            PathSegment::QuadTo(middle, to) => {
                // the cubic that is the same curve
                let towards = |end: resvg::tiny_skia::Point| resvg::tiny_skia::Point {
                    x: end.x + (middle.x - end.x) * (2.0 / 3.0),
                    y: end.y + (middle.y - end.y) * (2.0 / 3.0),
                };
                let ((a, b), (c, d), (x, y)) = (at(towards(last)), at(towards(to)), at(to));
                content.cubic_to(a, b, c, d, x, y);
                last = to;
            }
            PathSegment::CubicTo(one, two, to) => {
                let ((a, b), (c, d), (x, y)) = (at(one), at(two), at(to));
                content.cubic_to(a, b, c, d, x, y);
                last = to;
            }
            PathSegment::Close => {
                content.close_path();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use std::io::Read;

    #[test]
    fn a_page_is_as_large_as_the_drawing_and_has_its_lines_and_letters() {
        let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"400\" height=\"200\" font-family=\"DejaVu Sans\">\
                   <clipPath id=\"c\"><rect width=\"90\" height=\"90\"/></clipPath>\
                   <g clip-path=\"url(#c)\"><path d=\"M10 10L80 10\" fill=\"none\" stroke=\"#ff0000\" stroke-dasharray=\"7 5\"/></g>\
                   <text x=\"20\" y=\"50\" font-size=\"20\">k</text></svg>";
        let file = pdf(svg).unwrap();
        assert_eq!(&file[..5], b"%PDF-");
        let text = String::from_utf8_lossy(&file);
        assert!(text.contains("/MediaBox [0 0 300 150]"), "{text}");
        let start = file.windows(8).position(|w| w == b"stream\n\x78").unwrap() + 7;
        let mut content = String::new();
        ZlibDecoder::new(&file[start..]).read_to_string(&mut content).unwrap();
        assert!(content.starts_with("0.75 0 0 -0.75 0 150 cm"), "{content}");
        assert!(content.contains("1 0 0 RG") && content.contains("[7 5] 0 d"), "{content}");
        assert!(content.contains("10 10 m\n80 10 l\nS"), "{content}");
        assert!(content.contains("\nW\n") && content.matches("\nf").count() == 1, "{content}");
        assert!(pdf("no drawing").is_err());
    }
}
