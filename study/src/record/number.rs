//! Numbers as text.

/// The shortest text that reads back as the same number; empty for NaN and infinities.
pub(crate) fn exact(value: f64) -> String {
    let size = value.abs();
    if !value.is_finite() {
        String::new()
    } else if size == 0.0 || (1e-5..1e16).contains(&size) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// A number for people: six significant digits.
pub(crate) fn rounded(value: f64) -> String {
    let size = value.abs();
    if !value.is_finite() {
        "–".to_string()
    } else if size == 0.0 {
        "0".to_string()
    } else if (1e-3..1e6).contains(&size) {
        let whole = size.log10().floor() as i32 + 1;
        let decimals = (6 - whole).clamp(0, 8) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.5e}")
    }
}
