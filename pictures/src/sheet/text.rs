//! Text in SVG, with small letters above and below the line.

use std::fmt::Write;

/// How a text looks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Style {
    /// Size in pixels.
    pub(super) size: f64,
    /// Bold or not.
    pub(super) bold: bool,
    /// `start`, `middle` or `end`.
    pub(super) anchor: &'static str,
    /// Whether it reads upwards.
    pub(super) upright: bool,
}

impl Style {
    pub(super) fn title() -> Style {
        Style { size: 20.0, bold: true, anchor: "start", upright: false }
    }

    pub(super) fn small() -> Style {
        Style { size: 13.0, bold: false, anchor: "start", upright: false }
    }

    pub(super) fn anchored(self, anchor: &'static str) -> Style {
        Style { anchor, ..self }
    }

    pub(super) fn sized(self, size: f64) -> Style {
        Style { size, ..self }
    }
}

/// A stretch of text: level −1 below, 0 on, 1 above the line.
fn runs(text: &str) -> Vec<(i8, String)> {
    let mut runs = vec![(0, String::new())];
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        let level = match c {
            '_' => -1,
            '^' => 1,
            _ => 0,
        };
        if level != 0 && rest.peek() == Some(&'{') {
            rest.next();
            runs.push((level, rest.by_ref().take_while(|c| *c != '}').collect()));
            runs.push((0, String::new()));
        } else if let Some(last) = runs.last_mut() {
            last.1.push(c);
        }
    }
    runs.retain(|(_, text)| !text.is_empty());
    runs
}

/// About how wide a text is, in pixels.
pub(super) fn width(text: &str, size: f64) -> f64 {
    runs(text)
        .iter()
        .map(|(level, text)| {
            let size = if *level == 0 { size } else { 0.7 * size };
            let ems = text.chars().map(|c| match c {
                '\u{300}'..='\u{36f}' => 0.0,
                ' ' | '.' | ',' | ':' | 'i' | 'l' | 'j' | '\'' | '/' | '(' | ')' | 't' | 'f' => {
                    0.36
                }
                'm' | 'w' | 'M' | 'W' | '→' | '=' | '≈' | '×' | '+' | '−' => 0.9,
                'A'..='Z' => 0.7,
                _ => 0.62,
            });
            size * ems.sum::<f64>()
        })
        .sum()
}

/// Writes a text at a place.
pub(super) fn put(out: &mut String, text: &str, [x, y]: [f64; 2], style: &Style) {
    if text.is_empty() {
        return;
    }
    let Style { size, bold, anchor, upright } = *style;
    let _ = write!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" fill=\"#1e1e1e\"");
    if bold {
        out.push_str(" font-weight=\"bold\"");
    }
    if anchor != "start" {
        let _ = write!(out, " text-anchor=\"{anchor}\"");
    }
    if upright {
        let _ = write!(out, " transform=\"rotate(-90 {x:.1} {y:.1})\"");
    }
    out.push('>');
    let mut at = 0.0;
    for (level, text) in runs(text) {
        let wanted = match level {
            -1 => 0.24 * size,
            1 => -0.38 * size,
            _ => 0.0,
        };
        let small = if level == 0 { size } else { 0.7 * size };
        let _ = write!(out, "<tspan dy=\"{:.2}\" font-size=\"{small:.2}\">", wanted - at);
        at = wanted;
        escape(out, &text);
        out.push_str("</tspan>");
    }
    out.push_str("</text>\n");
}

/// Writes text with the characters that SVG and HTML reserve.
pub fn escape(out: &mut String, text: &str) {
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_letters_are_told_apart() {
        let parts = runs("χ k_{b}^{½} a_b");
        let parts: Vec<(i8, &str)> = parts.iter().map(|(l, t)| (*l, t.as_str())).collect();
        assert_eq!(parts, [(0, "χ k"), (-1, "b"), (1, "½"), (0, " a_b")]);
    }
}
