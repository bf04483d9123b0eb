//! The tables that say what varies.

use super::plan::{Axis, Setting};
use crate::case::document::{Node, Origin, Value};
use crate::case::error::Complaint;
use crate::case::keys::{ANY, Range};
use crate::case::reader::{Reader, Section};

const KEYS: &[&str] = &["key", "values", "from", "to", "count", "scale", "zip"];
const SCALES: &[&str] = &["linear", "log"];
const MOST: i64 = 1_000_000;
const NOT_ZERO: Range = Range { holds: |x| x != 0.0, words: "different from 0 for scale log" };

/// An axis as the file has it.
pub(super) struct Read {
    /// The axis.
    pub(super) axis: Axis,
    /// Where its key stands.
    pub(super) origin: Origin,
}

/// Reads the axes; what is wrong is left with the reader.
pub(super) fn axes(reader: &Reader, root: Section<'_>) -> Vec<Read> {
    let hint = "write a table [[vary]] with key and values, or key, from, to and count";
    if root.get("vary").is_none() {
        reader.missing(root, "vary", hint);
    }
    let items = reader.array(root, "vary", "tables [[vary]]").unwrap_or_default();
    if let (Some(node), []) = (root.get("vary"), items)
        && matches!(node.value, Value::Array(_))
    {
        reader.missing(root, "vary", hint);
    }
    let mut read: Vec<Read> = Vec::new();
    for item in items {
        let Value::Table(table) = &item.value else {
            reader.wrong_type(root, "vary", item, "a table [[vary]]", "");
            continue;
        };
        let section = Section::of("vary", item.origin, table);
        reader.only(section, KEYS, &[]);
        if let Some(axis) = axis(reader, section, &read) {
            read.push(axis);
        }
    }
    read
}

fn axis(reader: &Reader, section: Section<'_>, others: &[Read]) -> Option<Read> {
    if section.get("key").is_none() {
        reader.missing(section, "key", "name what varies, such as \"dimensionless.adhesion\"");
    }
    let key = reader.text(section, "key").and_then(|key| free(reader, section, key, others));
    let zip = reader.text(section, "zip").map(str::to_owned);
    let logarithmic = reader.word(section, "scale", SCALES) == Some("log");
    let values = match (section.get("values"), range_key(section)) {
        (Some(_), None) => list(reader, section),
        (None, _) => range(reader, section, logarithmic),
        (Some(_), Some(other)) => {
            let why = format!("does not go with vary.{other}; give a list of values, or a range");
            reader.push(section.origin, "vary.values".into(), None, Complaint::Conflict(why));
            None
        }
    }?;
    let axis = Axis { key: key?, logarithmic, zip, values };
    let origin = section.get("key").map_or(section.origin, |node| node.origin);
    let partner = others.iter().map(|other| &other.axis).find(|other| {
        axis.zip.is_some() && other.zip == axis.zip && other.values.len() != axis.values.len()
    });
    if let (Some(partner), Some(node)) = (partner, section.get("zip")) {
        let why = format!(
            "{} has {} values and {} has {}; what advances together has equally many",
            axis.key,
            axis.values.len(),
            partner.key,
            partner.values.len()
        );
        reader.refuse(section, "zip", node, Complaint::Conflict(why));
        return None;
    }
    Some(Read { axis, origin })
}

/// The key, unless it cannot vary or another axis has it.
fn free(reader: &Reader, section: Section<'_>, key: &str, others: &[Read]) -> Option<String> {
    let key: String = key.split('.').map(str::trim).collect::<Vec<_>>().join(".");
    let inside = |a: &str, b: &str| a.strip_prefix(b).is_some_and(|rest| rest.starts_with('.'));
    let why = if matches!(&*key, "problem" | "name" | "case" | "vary") {
        format!("{key} cannot vary: a sweep is of one problem; vary keys of its tables")
    } else if key.split('.').any(str::is_empty) || key.split('.').count() > 8 {
        "write it as table.key".to_owned()
    } else if others.iter().any(|other| other.axis.key == key) {
        "varies already; keep one of the two tables".to_owned()
    } else if others.iter().any(|o| inside(&o.axis.key, &key) || inside(&key, &o.axis.key)) {
        "is a table of which another key varies".to_owned()
    } else {
        return Some(key);
    };
    if let Some(node) = section.get("key") {
        reader.refuse(section, "key", node, Complaint::Conflict(why));
    }
    None
}

/// The first key of a range that is there.
fn range_key(section: Section<'_>) -> Option<&'static str> {
    ["from", "to", "count"].into_iter().find(|key| section.get(key).is_some())
}

fn list(reader: &Reader, section: Section<'_>) -> Option<Vec<Setting>> {
    let items = reader.array(section, "values", "numbers or strings")?;
    if items.is_empty() {
        reader.missing(section, "values", "the list is empty; give at least one value");
        return None;
    }
    let read: Vec<Option<Setting>> =
        items.iter().map(|item| setting(reader, section, item)).collect();
    read.into_iter().collect()
}

fn setting(reader: &Reader, section: Section<'_>, item: &Node) -> Option<Setting> {
    match &item.value {
        Value::Integer(Some(value)) => Some(Setting::Integer(*value)),
        Value::Real(value) => Some(Setting::Real(*value)),
        Value::Text(text) => Some(Setting::Text(text.clone())),
        _ => {
            reader.wrong_type(section, "values", item, "numbers or strings", "");
            None
        }
    }
}

fn range(reader: &Reader, section: Section<'_>, logarithmic: bool) -> Option<Vec<Setting>> {
    let allowed = if logarithmic { NOT_ZERO } else { ANY };
    let from = reader.required(section, "from", allowed);
    let to = reader.required(section, "to", allowed);
    if section.get("count").is_none() {
        reader.missing(section, "count", "give the number of values from vary.from to vary.to");
    }
    let count = reader.count(section, "count", 2, MOST);
    let (from, to, count) = (from?, to?, count?);
    if logarithmic
        && from.signum() != to.signum()
        && let Some(node) = section.get("to")
    {
        let allowed = "of the same sign as vary.from for scale log".to_owned();
        reader.refuse(section, "to", node, Complaint::OutOfRange { allowed });
        return None;
    }
    let whole = |key| matches!(section.get(key).map(|n| &n.value), Some(Value::Integer(_)));
    let whole = whole("from") && whole("to");
    Some(
        spaced(from, to, count, logarithmic)
            .map(|value| match value {
                value if whole && value.fract() == 0.0 => Setting::Integer(value as i64),
                value => Setting::Real(value),
            })
            .collect(),
    )
}

/// Evenly spaced numbers, or numbers with evenly spaced logarithms, both ends included; rounded to
/// fifteen digits, so that a decade of three has 0.01 in its middle and not 0.010000000000000002.
fn spaced(from: f64, to: f64, count: usize, logarithmic: bool) -> impl Iterator<Item = f64> {
    let last = count - 1;
    (0..count).map(move |at| {
        let part = at as f64 / last as f64;
        match at {
            0 => from,
            at if at == last => to,
            _ if logarithmic => fifteen_digits(from * (to / from).powf(part)),
            _ => fifteen_digits(from + (to - from) * part),
        }
    })
}

fn fifteen_digits(value: f64) -> f64 {
    format!("{value:.14e}").parse().unwrap_or(value)
}
