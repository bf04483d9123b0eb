//! Tables of text: columns by name with their units, numbers with a decimal point or comma.

use super::{Curve, Direction, Segment};
use crate::error::DataError;

/// What a reader is told about a file; what it is not told must stand in the file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Layout {
    /// Name of the column of forces.
    pub force_column: Option<String>,
    /// Name of the column of piezo heights.
    pub height_column: Option<String>,
    /// Name of the column that says the segment.
    pub segment_column: Option<String>,
    /// Unit of the forces.
    pub force_unit: Option<String>,
    /// Unit of the heights.
    pub height_unit: Option<String>,
    /// Whether numbers have a decimal comma.
    pub decimal_comma: Option<bool>,
    /// What stands between columns.
    pub separator: Option<char>,
    /// −1 where attraction is positive in the file.
    pub force_sign: Option<f64>,
    /// Whether the height rises on approach in the file.
    pub height_rises: Option<bool>,
    /// Sensitivity of the deflection, m/V; it replaces that of the file.
    pub sensitivity: Option<f64>,
    /// Spring constant of the lever, N/m; it replaces that of the file where forces come from deflections.
    pub spring_constant: Option<f64>,
    /// Which curve of a file that holds several.
    pub curve: Option<usize>,
}

/// What of a column's name says that it is the force, in the order in which they are preferred.
const FORCE: [&str; 2] = ["force", "kraft"];
/// The same of the height over which the head moves: that of its sensor before that of the piezo's voltage.
const HEIGHT: [&str; 6] =
    ["height (measured)", "height_measured", "height_piezo", "height (piezo)", "piezo", "height"];
/// The same of the segment.
const SEGMENT: [&str; 2] = ["segment", "direction"];

/// How much farther down than up forces go, and farthest at the least height, where the sign is another.
const FLIPPED: f64 = 5.0;

/// Units of force, in newtons.
const FORCES: [(&str, f64); 5] =
    [("N", 1.0), ("mN", 1e-3), ("uN", 1e-6), ("nN", 1e-9), ("pN", 1e-12)];
/// Units of length, in metres.
const LENGTHS: [(&str, f64); 5] =
    [("m", 1.0), ("mm", 1e-3), ("um", 1e-6), ("nm", 1e-9), ("pm", 1e-12)];

/// Units of a deflection that a sensitivity makes a length, in volts.
const VOLTS: [(&str, f64); 2] = [("V", 1.0), ("mV", 1e-3)];

/// A column's name without the unit at its end: `force [nN]`, `force (nN)`, `force_nN`, `force / nN`.
fn split(header: &str) -> (String, Option<String>) {
    let header = header.trim().trim_matches('"').trim();
    let plain = |unit: &str| unit.replace(['\u{b5}', '\u{3bc}'], "u").trim().to_owned();
    let known = |unit: &str| {
        let unit = plain(unit);
        FORCES.iter().chain(&LENGTHS).chain(&VOLTS).any(|(name, _)| *name == unit)
    };
    for (open, close) in [('[', "]"), ('(', ")")] {
        if let Some((name, rest)) = header.rsplit_once(open)
            && let Some(unit) = rest.strip_suffix(close)
            && known(unit)
        {
            return (name.trim().to_lowercase(), Some(plain(unit)));
        }
    }
    for between in ["/", "_", " "] {
        if let Some((name, unit)) = header.rsplit_once(between)
            && known(unit)
        {
            return (name.trim().to_lowercase(), Some(plain(unit)));
        }
    }
    (header.to_lowercase(), None)
}

/// A column that was found.
struct Column {
    at: usize,
    header: String,
    unit: Option<String>,
}

fn find(
    file: &str,
    headers: &[String],
    told: Option<&String>,
    names: &[&str],
    key: &'static str,
) -> Result<Option<Column>, DataError> {
    let column = |at: usize| Column {
        at,
        header: headers[at].trim().to_owned(),
        unit: split(&headers[at]).1,
    };
    if let Some(told) = told {
        let wanted = told.trim().to_lowercase();
        let same = |h: &String| h.trim().to_lowercase() == wanted || split(h).0 == wanted;
        return match headers.iter().position(same) {
            Some(at) => Ok(Some(column(at))),
            None => Err(DataError::NoColumn {
                file: file.to_owned(),
                key,
                wanted: told.clone(),
                found: headers.join(", "),
            }),
        };
    }
    for name in names {
        let found: Vec<usize> =
            (0..headers.len()).filter(|&at| split(&headers[at]).0 == *name).collect();
        match found.as_slice() {
            [] => {}
            [at] => return Ok(Some(column(*at))),
            _ => {
                return Err(DataError::ManyColumns {
                    file: file.to_owned(),
                    key,
                    name: (*name).to_owned(),
                });
            }
        }
    }
    Ok(None)
}

/// The unit of a column: told, in its name, or that of the format.
fn unit(
    file: &str,
    column: &Column,
    told: Option<&String>,
    units: &[(&str, f64)],
    key: &'static str,
    si: bool,
) -> Result<String, DataError> {
    let stated = told.map(|u| u.replace(['\u{b5}', '\u{3bc}'], "u").trim().to_owned());
    match stated.or_else(|| column.unit.clone()) {
        Some(unit) => Ok(unit),
        None if si => Ok(units[0].0.to_owned()),
        None => Err(DataError::NoUnit {
            file: file.to_owned(),
            key,
            column: column.header.clone(),
            allowed: names(units),
        }),
    }
}

fn names(units: &[(&str, f64)]) -> String {
    units.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
}

fn factor(
    file: &str,
    unit: &str,
    units: &[(&str, f64)],
    key: &'static str,
) -> Result<f64, DataError> {
    units.iter().find(|(name, _)| *name == unit).map(|(_, factor)| *factor).ok_or_else(|| {
        let (file, unit) = (file.to_owned(), unit.to_owned());
        DataError::Unit { file, key, unit, allowed: names(units) }
    })
}

/// What makes newtons of a column of forces, or of volts where the lever is known.
fn newtons(file: &str, column: &Column, layout: &Layout, si: bool) -> Result<f64, DataError> {
    const KEY: &str = "data.force_unit";
    let unit = unit(file, column, layout.force_unit.as_ref(), &FORCES, KEY, si)?;
    let Some((_, volt)) = VOLTS.iter().find(|(name, _)| *name == unit) else {
        return factor(file, &unit, &[&FORCES[..], &VOLTS[..]].concat(), KEY);
    };
    let missing = match (layout.sensitivity, layout.spring_constant) {
        (Some(sensitivity), Some(stiffness)) => return Ok(volt * sensitivity * stiffness),
        (None, Some(_)) => {
            "the sensitivity of the deflection: --set instrument.sensitivity=\"60 nm/V\""
        }
        (Some(_), None) => {
            "the spring constant of the lever: --set instrument.spring_constant=\"0.08 N/m\""
        }
        (None, None) => {
            "sensitivity and spring constant of the lever: --set instrument.sensitivity=\"60 nm/V\" --set \
             instrument.spring_constant=\"0.08 N/m\""
        }
    };
    Err(DataError::Volts { file: file.to_owned(), column: column.header.clone(), missing })
}

/// Rows of a table: line number in the file, and its fields.
pub(super) struct Rows<'a> {
    pub(super) file: &'a str,
    pub(super) headers: Vec<String>,
    pub(super) rows: Vec<(usize, Vec<String>)>,
    /// Whether units are SI where none is stated: the format says so.
    pub(super) si: bool,
    pub(super) comma: bool,
}

/// A curve from a table.
pub(super) fn curve(rows: &Rows<'_>, layout: &Layout) -> Result<Curve, DataError> {
    let file = rows.file;
    let headers = &rows.headers;
    let missing = |key: &'static str, names: &[&str]| DataError::NoColumn {
        file: file.to_owned(),
        key,
        wanted: names.join(" or "),
        found: headers.join(", "),
    };
    let force = find(file, headers, layout.force_column.as_ref(), &FORCE, "data.force_column")?
        .ok_or_else(|| missing("data.force_column", &FORCE))?;
    let height = find(file, headers, layout.height_column.as_ref(), &HEIGHT, "data.height_column")?
        .ok_or_else(|| missing("data.height_column", &HEIGHT))?;
    let segment =
        find(file, headers, layout.segment_column.as_ref(), &SEGMENT, "data.segment_column")?;
    let to_newton = newtons(file, &force, layout, rows.si)?;
    let key = "data.height_unit";
    let to_metre = unit(file, &height, layout.height_unit.as_ref(), &LENGTHS, key, rows.si)?;
    let to_metre = factor(file, &to_metre, &LENGTHS, key)?;
    let sign = layout.force_sign.unwrap_or(1.0);
    let turn = if layout.height_rises == Some(true) { -1.0 } else { 1.0 };
    let mut curve = Curve { name: file.to_owned(), ..Curve::default() };
    if layout.height_column.is_none()
        && let Some(other) = headers
            .iter()
            .map(|h| h.trim())
            .find(|h| HEIGHT.contains(&split(h).0.as_str()) && *h != height.header)
    {
        curve.notes.push(format!(
            "of two heights \"{}\" is taken; --set data.height_column=\"{other}\" takes the other",
            height.header
        ));
    }
    for (line, fields) in &rows.rows {
        let number = |column: &Column| -> Result<f64, DataError> {
            let text = fields.get(column.at).map_or("", |f| f.trim());
            let dotted = if rows.comma { text.replace(',', ".") } else { text.to_owned() };
            match dotted.parse::<f64>() {
                Ok(value) if value.is_finite() => Ok(value),
                _ => Err(DataError::Number {
                    file: file.to_owned(),
                    line: *line,
                    column: column.header.clone(),
                    text: text.chars().take(40).collect(),
                }),
            }
        };
        let direction = match &segment {
            None => None,
            Some(column) => Some(direction(file, *line, column, fields)?),
        };
        let (h, f) = (turn * to_metre * number(&height)?, sign * to_newton * number(&force)?);
        let direction = direction.unwrap_or(Direction::Approach);
        match curve.segments.last_mut().filter(|s| s.direction == direction) {
            Some(last) => {
                last.height.push(h);
                last.force.push(f);
            }
            None => curve.segments.push(Segment { direction, height: vec![h], force: vec![f] }),
        }
    }
    if segment.is_none() {
        divide(&mut curve);
    }
    check(curve)
}

fn direction(
    file: &str,
    line: usize,
    column: &Column,
    fields: &[String],
) -> Result<Direction, DataError> {
    let text = fields.get(column.at).map_or("", |f| f.trim());
    match text.to_lowercase().as_str() {
        "approach" | "extend" | "trace" | "false" | "0" => Ok(Direction::Approach),
        "retract" | "retrace" | "true" | "1" => Ok(Direction::Retract),
        _ => Err(DataError::Segment { file: file.to_owned(), line, text: text.to_owned() }),
    }
}

/// Without a column of segments: the approach ends at the least height.
fn divide(curve: &mut Curve) {
    let Some(whole) = curve.segments.pop() else { return };
    let lowest = (0..whole.height.len())
        .min_by(|&a, &b| whole.height[a].total_cmp(&whole.height[b]))
        .unwrap_or(0);
    let cut = lowest + 1;
    let note = "no column says the segment; the approach is taken to end at the least height";
    curve.notes.push(note.to_owned());
    let part = |direction, range: std::ops::Range<usize>| Segment {
        direction,
        height: whole.height[range.clone()].to_vec(),
        force: whole.force[range].to_vec(),
    };
    for part in
        [part(Direction::Approach, 0..cut), part(Direction::Retract, cut..whole.height.len())]
    {
        if part.height.len() > 2 {
            curve.segments.push(part);
        }
    }
}

/// Checks that heights fall on approach and rise on retract, and that forces are of contact.
pub(super) fn check(mut curve: Curve) -> Result<Curve, DataError> {
    let file = curve.name.clone();
    if curve.is_empty() {
        return Err(DataError::Empty { file });
    }
    // told only where no segment is without order: lines in no order go both ways
    let mut reversed = None;
    for segment in &curve.segments {
        let (h, n) = (&segment.height, segment.height.len());
        if n < 3 {
            continue;
        }
        let falls = h[n - 1] < h[0];
        let direction = segment.direction.name();
        // a piezo creeps and shakes; what goes back over a tenth of the way is no segment
        let way = (h[n - 1] - h[0]).abs();
        let (mut turned, mut extreme) = (0.0_f64, h[0]);
        for x in h {
            let back = if falls { x - extreme } else { extreme - x };
            turned = turned.max(back);
            extreme = if falls { extreme.min(*x) } else { extreme.max(*x) };
        }
        if turned > 0.1 * way {
            return Err(DataError::Unsorted { file, direction });
        }
        if falls != (segment.direction == Direction::Approach) && reversed.is_none() {
            reversed = Some((direction, h[0], h[n - 1]));
        }
    }
    if let Some((direction, from, to)) = reversed {
        return Err(DataError::Order { file, direction, from, to });
    }
    // the deepest samples press, or the sign is another; what ends in attraction may be either
    let main = curve
        .segments
        .iter()
        .find(|s| s.direction == Direction::Approach)
        .or_else(|| curve.segments.first());
    if let Some(main) = main {
        let mut force = main.force.clone();
        if main.direction == Direction::Retract {
            force.reverse();
        }
        let tenth = force.len() / 10 + 1;
        let far = super::median(&mut force[..tenth].to_vec()).unwrap_or(0.0);
        let deep = super::median(&mut force[force.len() - tenth..].to_vec()).unwrap_or(0.0);
        let highest = force.iter().fold(f64::NEG_INFINITY, |m, f| m.max(*f)) - far;
        let lowest = far - force.iter().fold(f64::INFINITY, |m, f| m.min(*f));
        let last = force.iter().rev().take(tenth).fold(f64::INFINITY, |m, f| m.min(*f));
        if lowest > FLIPPED * highest && far - last >= lowest {
            return Err(DataError::Sign { file, far, deep });
        }
    }
    curve.name = file;
    Ok(curve)
}
