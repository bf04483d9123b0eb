//! One page with everything: figures, their data, and the claims.

use super::Computed;
use super::claims::{Claim, Source, Tally, Verdict};
use super::estimates::EstimateRow;
use super::files::{WINDOWS, data_name};
use super::manifest::{STABILITY, stem};
use super::number::short;
use pictures::{BOLD, FAMILY, FONT, escape};
use std::fmt::Write;

const STYLE: &str = include_str!("page.css");

/// The page as HTML, with these drawings of each figure's panels; it needs no other file to be read, and links the data
/// beside it.
pub(super) fn page(computed: &Computed, drawings: &[Vec<String>]) -> String {
    let mut out = String::from(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n",
    );
    out.push_str("<title>Figures, computed</title>\n<style>\n");
    for (weight, font) in [("normal", FONT), ("bold", BOLD)] {
        let _ = writeln!(
            out,
            "@font-face{{font-family:'DejaVu Sans';font-weight:{weight};src:url(data:font/ttf;base64,{})}}",
            base64(font)
        );
    }
    let _ = writeln!(out, "body{{font-family:{FAMILY}}}\n{STYLE}</style></head><body>");
    out.push_str("<h1>Compression of coated microbubbles: the figures, computed</h1>\n");
    out.push_str(
        "<p>Figures of Lytra and Pelekasis, <i>Static response of coated microbubbles compressed \
         between rigid plates</i>, Phys. Fluids 30 (2018), computed by arclen. Dashed lines are \
         unstable at fixed plate distance to axisymmetric mirror images, dotted ones are laws. The \
         deformation is that of one pole, plate against equator, unless an axis says otherwise; an \
         instrument that closes both plates reads twice as much.</p>\n",
    );
    if !computed.early.is_empty() {
        out.push_str("<p class=\"bad\">Incomplete: ");
        escape(&mut out, &computed.early.join("; "));
        out.push_str("</p>\n");
    }
    out.push_str("<nav>");
    for figure in &computed.figures {
        let n = figure.manifest.number;
        let shown = if n == STABILITY { "Stability".to_owned() } else { format!("Fig. {n}") };
        let _ = write!(out, "<a href=\"#fig{n}\">{shown}</a> ");
    }
    if !computed.claims.is_empty() {
        out.push_str("<a href=\"#claims\">Claims</a>");
    }
    out.push_str("</nav>\n");
    claims(&mut out, &computed.claims);
    for (figure, panels) in computed.figures.iter().zip(drawings) {
        let m = &figure.manifest;
        let n = m.number;
        let _ = write!(out, "<section id=\"fig{n}\"><h2>");
        small(&mut out, &m.heading());
        out.push_str("</h2>\n");
        // ids of clipping paths are unique in one figure only
        let own = format!("f{n}-frame-");
        let drawn: String = panels.iter().map(|svg| svg.replace("frame-", &own)).collect();
        let _ = write!(out, "<div class=\"drawing\">{drawn}</div><p>");
        small(&mut out, &m.caption);
        out.push_str("</p>\n");
        if !m.notes.is_empty() {
            out.push_str("<ul class=\"notes\">");
            for note in &m.notes {
                out.push_str("<li>");
                small(&mut out, note);
                out.push_str("</li>");
            }
            out.push_str("</ul>\n");
        }
        if n == 9 {
            estimates(&mut out, &computed.estimates);
        }
        let _ = write!(
            out,
            "<p class=\"files\"><a href=\"{0}.svg\">SVG</a> <a href=\"{0}.png\">PNG</a> data:",
            stem(n)
        );
        if m.scans() {
            let _ = write!(out, " <a href=\"{WINDOWS}\">(windows)</a>");
        }
        for panel in &m.panels {
            let name = data_name(n, &panel.letter);
            let shown = if panel.letter.is_empty() { "curves" } else { &panel.letter };
            let _ = write!(out, " <a href=\"{name}\">({shown})</a>");
        }
        out.push_str(" cases:");
        for traced in &figure.traced {
            let _ = write!(out, " <a href=\"cases/{0}.toml\">{0}</a>", traced.case.name);
        }
        out.push_str("</p></section>\n");
    }
    out.push_str("</body></html>\n");
    out
}

fn claims(out: &mut String, claims: &[Claim]) {
    if claims.is_empty() {
        return;
    }
    out.push_str("<section id=\"claims\"><h2>Claims</h2>\n");
    let _ = writeln!(
        out,
        "<p>Of the paper: {}. <span class=\"ours\">Ours</span>, which no sentence of it makes: {}. \
         Where the paper does not say how a number is to be taken, each way is a row. Unstable modes \
         of every kind are the mirror-symmetric axisymmetric ones, those that break the mirror \
         symmetry, and those with waves around the axis.</p>",
        Tally::of(claims, Source::Paper),
        Tally::of(claims, Source::Ours)
    );
    out.push_str("<div class=\"wide\"><table><tr>");
    for title in
        ["Fig.", "Statement", "Measured here", "Paper", "Here", "Tolerance", "Verdict", "Why"]
    {
        let _ = write!(out, "<th>{title}</th>");
    }
    out.push_str("</tr>\n");
    for claim in claims {
        let (class, verdict) = match claim.verdict {
            Verdict::Agrees => ("good", "agrees"),
            Verdict::Disagrees => ("bad", "disagrees"),
            Verdict::CannotBeDecided => ("open", "cannot be decided"),
        };
        let _ = write!(out, "<tr><td>{}</td><td>", claim.figure);
        if claim.source == Source::Ours {
            out.push_str("<span class=\"ours\">ours:</span> ");
        }
        escape(out, claim.statement.trim());
        out.push_str("</td>");
        let (paper, ours) = (number(claim.paper), number(claim.ours));
        for text in [&claim.measured, &paper, &ours, &claim.tolerance] {
            out.push_str("<td>");
            escape(out, text.trim());
            out.push_str("</td>");
        }
        let _ = write!(out, "<td class=\"{class}\">{verdict}</td><td>");
        escape(out, &claim.why);
        out.push_str("</td></tr>\n");
    }
    out.push_str("</table></div></section>\n");
}

fn estimates(out: &mut String, rows: &[EstimateRow]) {
    if rows.is_empty() {
        return;
    }
    out.push_str(
        "<h3>Moduli that the curves give back</h3>\n<div class=\"wide\"><table><tr><th>Curve</th><th>Combination</th>\
         <th>Formulas</th><th>χ (N/m): found</th><th>true</th><th>k<sub>b</sub> (N m): found</th>\
         <th>true</th><th>E (MPa): found</th><th>true</th><th>h (nm): found</th><th>true</th>\
         <th>Parts of the curve</th></tr>\n",
    );
    for row in rows {
        out.push_str("<tr>");
        let cells = [
            &row.chi,
            &row.bending,
            &row.young.map(|x| x.map(|x| x * 1e-6)),
            &row.thickness.map(|x| x.map(|x| x * 1e9)),
        ];
        let cells = cells.into_iter().flatten().map(|x| number(*x));
        let first = [&row.curve, &row.combination, &row.formulas].map(Clone::clone);
        for text in first.into_iter().chain(cells).chain([row.used.clone()]) {
            out.push_str("<td>");
            escape(out, &text);
            out.push_str("</td>");
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</table></div>\n");
}

fn number(value: Option<f64>) -> String {
    value.map_or("–".to_owned(), short)
}

/// Text with its small letters.
fn small(out: &mut String, text: &str) {
    let mut rest = text;
    while let Some(at) = rest.find("_{").into_iter().chain(rest.find("^{")).min() {
        let tag = if rest[at..].starts_with('_') { "sub" } else { "sup" };
        escape(out, &rest[..at]);
        let (inner, after) = rest[at + 2..].split_once('}').unwrap_or((&rest[at + 2..], ""));
        let _ = write!(out, "<{tag}>");
        escape(out, inner);
        let _ = write!(out, "</{tag}>");
        rest = after;
    }
    escape(out, rest);
}

/// Bytes as text that a page can hold.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let word =
            chunk.iter().fold(0_u32, |w, b| (w << 8) | u32::from(*b)) << (8 * (3 - chunk.len()));
        for k in 0..4 {
            if k <= chunk.len() {
                out.push(char::from(LETTERS[(word >> (18 - 6 * k)) as usize & 63]));
            } else {
                out.push('=');
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_rfc_4648() {
        let of = |text: &str| base64(text.as_bytes());
        assert_eq!(
            ["", "f", "fo", "foo", "foob"].map(of),
            ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg=="]
        );
    }
}
