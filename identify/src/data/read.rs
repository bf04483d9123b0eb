//! Files of curves: CSV, the `.tab` of afmformats, and JPK's archives.

use super::table::{Layout, Rows, check, curve};
use super::{Curve, jpk};
use crate::error::DataError;
use serde_json::Value;

/// Largest file that is read, bytes.
pub const LARGEST: u64 = 256 << 20;

/// A curve from the content of a file; its name says the format.
///
/// # Errors
/// Names the file and line, column or key, what was found and what to do.
pub fn read(name: &str, bytes: &[u8], layout: &Layout) -> Result<Curve, DataError> {
    let file = name.to_owned();
    let extension = name.rsplit_once('.').map(|(_, e)| e.to_lowercase()).unwrap_or_default();
    match extension.as_str() {
        "csv" | "txt" | "tsv" | "dat" | "tab" => {}
        jpk if jpk::ENDINGS.contains(&jpk) => {
            return match jpk::curve(bytes, layout) {
                Ok(curve) => check(Curve { name: file, ..curve }),
                Err(why) => Err(DataError::Archive { file, why: Box::new(why) }),
            };
        }
        other => {
            return Err(DataError::Format {
                file,
                why: format!("the format \".{other}\" is not known"),
                remedy: "give a .csv, .tab or .jpk-force; the Python package afmformats writes .tab from most \
                         instruments' files",
            });
        }
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = 1 + bytes[..error.valid_up_to()].iter().filter(|b| **b == b'\n').count();
        DataError::NotText { file: file.clone(), line }
    })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if extension == "tab" { tab(name, text, layout) } else { csv(name, text, layout) }
}

/// The layout of afmformats: comments with JSON between `BEGIN METADATA` and `END METADATA`, the last
/// comment being the header; columns apart by tabs, SI units.
fn tab(name: &str, text: &str, layout: &Layout) -> Result<Curve, DataError> {
    let (mut inside, mut json, mut header) = (false, String::new(), None);
    let mut rows = Vec::new();
    for (at, line) in text.lines().enumerate() {
        if let Some(comment) = line.strip_prefix('#') {
            let comment = comment.strip_prefix(' ').unwrap_or(comment);
            match comment.trim() {
                "BEGIN METADATA" => inside = true,
                "END METADATA" => inside = false,
                _ if inside => json.push_str(comment),
                "" => {}
                _ => header = Some(comment.to_owned()),
            }
        } else if !line.trim().is_empty() {
            rows.push((at + 1, line.split('\t').map(str::to_owned).collect()));
        }
    }
    let file = || name.to_owned();
    let Some(header) = header else { return Err(DataError::NoHeader { file: file() }) };
    let headers: Vec<String> = header.split('\t').map(str::to_owned).collect();
    let rows = Rows { file: name, headers, rows, si: true, comma: false };
    let mut curve = curve(&rows, layout)?;
    if !json.is_empty() {
        let metadata: Value = serde_json::from_str(&json)
            .map_err(|error| DataError::Metadata { file: file(), why: error.to_string() })?;
        curve.spring_constant = metadata.get("spring constant").and_then(Value::as_f64);
        rescale(&mut curve, layout.spring_constant);
        let stated = metadata.get("point count").and_then(Value::as_u64);
        if let Some(stated) = stated.filter(|stated| *stated != curve.len() as u64) {
            let found = curve.len();
            curve.notes.push(format!("the metadata state {stated} samples; the file has {found}"));
        }
    }
    Ok(curve)
}

/// Forces of the same deflections with the spring constant that is known, where the file states another.
fn rescale(curve: &mut Curve, known: Option<f64>) {
    if let (Some(stated), Some(known)) = (curve.spring_constant, known) {
        let forces = curve.segments.iter_mut().flat_map(|s| s.force.iter_mut());
        // equal constants leave the bits as they are
        forces.filter(|_| known != stated).for_each(|f| *f *= known / stated);
    }
}

/// A table with one line of headers; lines that start with `#` are left out.
fn csv(name: &str, text: &str, layout: &Layout) -> Result<Curve, DataError> {
    let mut lines = text.lines().enumerate().filter(|(_, l)| !l.starts_with('#'));
    let Some((first, header)) = lines.find(|(_, l)| !l.trim().is_empty()) else {
        return Err(DataError::Empty { file: name.to_owned() });
    };
    let separator = match layout.separator {
        Some(separator) => separator,
        // a tab or semicolon in the header is no part of a name
        None => ['\t', ';', ','].into_iter().find(|c| header.contains(*c)).unwrap_or(','),
    };
    let body = || text.lines().skip(first + 1).filter(|l| !l.starts_with('#'));
    let comma = match layout.decimal_comma {
        Some(comma) => comma,
        None if separator == ',' => false,
        // "1,5" cannot be two columns here, but might be 15 with a mark between thousands
        None if body().any(|l| l.contains(',')) => {
            return Err(DataError::DecimalComma { file: name.to_owned() });
        }
        None => false,
    };
    if comma && separator == ',' {
        return Err(DataError::CommaTwice { file: name.to_owned() });
    }
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(u8::try_from(separator).unwrap_or(b','))
        .comment(Some(b'#'))
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let bad =
        |error: csv::Error| DataError::Table { file: name.to_owned(), why: error.to_string() };
    let headers: Vec<String> = reader.headers().map_err(bad)?.iter().map(str::to_owned).collect();
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(bad)?;
        let line = record.position().map_or(0, |p| p.line() as usize);
        // a separator at the end of each line adds an empty field
        let filled = record.iter().zip(1..).filter(|(field, _)| !field.is_empty());
        let found = filled.last().map_or(0, |(_, count)| count);
        if found > headers.len() {
            let (file, names) = (name.to_owned(), headers.len());
            return Err(DataError::MoreFields { file, line, found, names });
        }
        rows.push((line, record.iter().map(str::to_owned).collect()));
    }
    curve(&Rows { file: name, headers, rows, si: false, comma }, layout)
}
