//! Markers of special points.

use super::palette::Form;
use super::path::Place;
use std::fmt::Write as _;

/// Nearly black.
pub(super) const INK: &str = "#1e1e1e";

/// A marker: black with a white rim, so that it stands out from its curve.
pub(super) fn draw_marker(svg: &mut String, form: Form, (x, y): Place, scale: f64) {
    let (d, filled) = match form {
        Form::Disc => ("M5 0A5 5 0 1 1-5 0A5 5 0 1 1 5 0Z", true),
        Form::Ring => ("M5 0A5 5 0 1 1-5 0A5 5 0 1 1 5 0Z", false),
        Form::Square => ("M-5-5H5V5H-5Z", true),
        Form::Up => ("M0-7L6 5H-6Z", true),
        Form::Down => ("M0 7L6-5H-6Z", true),
        Form::Diamond => ("M0-7L6 0L0 7L-6 0Z", true),
        Form::HollowDiamond => ("M0-7L6 0L0 7L-6 0Z", false),
        Form::Cross => ("M-5-5L5 5M5-5L-5 5", false),
    };
    let size = if scale == 1.0 { String::new() } else { format!(" scale({scale:.2})") };
    let at = format!("transform=\"translate({x:.1} {y:.1}){size}\"");
    if form == Form::Cross {
        let _ = writeln!(
            svg,
            "<g {at}><path d=\"{d}\" stroke=\"#ffffff\" stroke-width=\"4\"/><path d=\"{d}\" \
             stroke=\"{INK}\" stroke-width=\"2\"/></g>"
        );
        return;
    }
    let (fill, edge, width) = if filled { (INK, "#ffffff", 1.2) } else { ("#ffffff", INK, 1.8) };
    let _ = writeln!(
        svg,
        "<path d=\"{d}\" {at} fill=\"{fill}\" stroke=\"{edge}\" stroke-width=\"{width}\"/>"
    );
}
