//! Text in SVG, with small letters above and below the line: the one way in which pictures write.

use std::fmt::Write;

/// How a text looks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Style {
    /// Size in pixels.
    pub(crate) size: f64,
    /// Bold or not.
    pub(crate) bold: bool,
    /// `start`, `middle` or `end`.
    pub(crate) anchor: &'static str,
    /// Whether it reads upwards.
    pub(crate) upright: bool,
    /// Whether it has a white rim, which keeps it apart from lines below it.
    pub(crate) rim: bool,
}

impl Style {
    pub(crate) fn title() -> Style {
        Style { size: 20.0, bold: true, anchor: "start", upright: false, rim: false }
    }

    pub(crate) fn small() -> Style {
        Style { size: 13.0, bold: false, anchor: "start", upright: false, rim: false }
    }

    pub(crate) fn anchored(self, anchor: &'static str) -> Style {
        Style { anchor, ..self }
    }

    pub(crate) fn sized(self, size: f64) -> Style {
        Style { size, ..self }
    }

    pub(crate) fn bold(self) -> Style {
        Style { bold: true, ..self }
    }

    pub(crate) fn upwards(self) -> Style {
        Style { upright: true, ..self }
    }

    pub(crate) fn with_rim(self) -> Style {
        Style { rim: true, ..self }
    }
}

/// The small digit or sign that a character is, with its level.
fn small(c: char) -> Option<(i8, char)> {
    const BELOW: &str = "₀₁₂₃₄₅₆₇₈₉";
    const ABOVE: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹";
    let digit = |digits: &str| {
        let at = digits.chars().position(|own| own == c)?;
        char::from_digit(u32::try_from(at).ok()?, 10)
    };
    match c {
        '⁻' => Some((1, '−')),
        _ => digit(BELOW).map(|d| (-1, d)).or_else(|| digit(ABOVE).map(|d| (1, d))),
    }
}

/// Stretches of text: level −1 below, 0 on, 1 above the line. `_{…}` and `^{…}` set small, `_x` does for a
/// single letter (a word with an underscore in it stays as it is), and so do the characters for small digits.
fn runs(text: &str) -> Vec<(i8, String)> {
    let mut runs = vec![(0, String::new())];
    let mut rest = text.chars().peekable();
    let mut before = None;
    while let Some(c) = rest.next() {
        let previous = before.replace(c);
        if let Some((level, digit)) = small(c) {
            match runs.last_mut() {
                Some((own, text)) if *own == level => text.push(digit),
                _ => runs.push((level, digit.to_string())),
            }
            continue;
        }
        if runs.last().is_some_and(|(level, _)| *level != 0) {
            runs.push((0, String::new()));
        }
        let level = match c {
            '_' => -1,
            '^' => 1,
            _ => 0,
        };
        if level != 0 && rest.peek() == Some(&'{') {
            rest.next();
            runs.push((level, rest.by_ref().take_while(|c| *c != '}').collect()));
        } else if c == '_'
            && previous.is_some_and(char::is_alphanumeric)
            && let Some(letter) = alone(rest.clone())
        {
            rest.next();
            runs.push((-1, letter.to_string()));
        } else if let Some(last) = runs.last_mut() {
            last.1.push(c);
        }
    }
    runs.retain(|(_, text)| !text.is_empty());
    runs
}

/// A letter or digit that begins and ends a word.
fn alone(mut rest: impl Iterator<Item = char>) -> Option<char> {
    let letter = rest.next().filter(|c| c.is_alphanumeric())?;
    let ends = rest.next().is_none_or(|next| !(next.is_alphanumeric() || next == '_'));
    ends.then_some(letter)
}

/// About how wide a text is, in pixels.
pub(crate) fn width(text: &str, size: f64) -> f64 {
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
pub(crate) fn put(out: &mut String, text: &str, [x, y]: [f64; 2], style: &Style) {
    if text.is_empty() {
        return;
    }
    let Style { size, bold, anchor, upright, rim } = *style;
    let _ = write!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" fill=\"#1e1e1e\"");
    if bold {
        out.push_str(" font-weight=\"bold\"");
    }
    if rim {
        out.push_str(
            " paint-order=\"stroke\" stroke=\"#ffffff\" stroke-width=\"3\" stroke-linejoin=\"round\"",
        );
    }
    if anchor != "start" {
        let _ = write!(out, " text-anchor=\"{anchor}\"");
    }
    if upright {
        let _ = write!(out, " transform=\"rotate(-90 {x:.1} {y:.1})\"");
    }
    out.push('>');
    let mut at = 0.0;
    let runs = runs(text);
    if let [(0, text)] = runs.as_slice() {
        escape(out, text);
        out.push_str("</text>\n");
        return;
    }
    for (level, text) in runs {
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
        let parts = runs("χ k_{b}^{½} a_bc");
        let parts: Vec<(i8, &str)> = parts.iter().map(|(l, t)| (*l, t.as_str())).collect();
        assert_eq!(parts, [(0, "χ k"), (-1, "b"), (1, "½"), (0, " a_bc")]);
        let parts: Vec<(i8, String)> = runs("√(χ k_b)");
        assert_eq!(parts[1], (-1, "b".to_owned()));
        let parts = runs("z₀/R₀² ×10⁻¹²");
        let parts: Vec<(i8, &str)> = parts.iter().map(|(l, t)| (*l, t.as_str())).collect();
        let wanted = [(0, "z"), (-1, "0"), (0, "/R"), (-1, "0"), (1, "2"), (0, " ×10"), (1, "−12")];
        assert_eq!(parts, wanted);
    }
}
