//! A case file as a tree in which every value knows where it came from, with overrides laid on top.

use super::error::LoadError;
use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// Where a value came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Origin {
    /// The file as a whole.
    File,
    /// A line of the file.
    Line(usize),
    /// An override, by the word for where it was given, such as an option of a command line.
    Given(&'static str),
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Origin::File => Ok(()),
            Origin::Line(line) => write!(f, ", line {line}"),
            Origin::Given(by) => write!(f, ", {by}"),
        }
    }
}

/// Keys in the order of the alphabet.
pub(crate) type Table = BTreeMap<String, Node>;

/// A value and where it came from.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Node {
    /// Where its key stands.
    pub origin: Origin,
    /// As written, shortened, for messages.
    pub raw: String,
    /// What it is.
    pub value: Value,
}

impl Node {
    /// Whether it is a string that begins as a number does: a quantity with a unit.
    pub(crate) fn is_quantity(&self) -> bool {
        let begins = |c: char| c.is_ascii_digit() || "+-.".contains(c);
        matches!(&self.value, Value::Text(text) if text.trim_start().starts_with(begins))
    }
}

/// What a value is.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    /// A string.
    Text(String),
    /// An integer; `None` when it does not fit into 64 bits.
    Integer(Option<i64>),
    /// A float, NaN and infinity included.
    Real(f64),
    /// `true` or `false`.
    Flag(bool),
    /// A table.
    Table(Table),
    /// An array.
    Array(Vec<Node>),
    /// A type that no key has, by name.
    Other(&'static str),
}

impl Value {
    /// The type's name in TOML, with its article.
    pub(crate) fn type_name(&self) -> &'static str {
        match self {
            Value::Text(_) => "a string",
            Value::Integer(_) => "an integer",
            Value::Real(_) => "a float",
            Value::Flag(_) => "a boolean",
            Value::Table(_) => "a table",
            Value::Array(_) => "an array",
            Value::Other(name) => name,
        }
    }
}

/// A value laid over a case: `path.end=0.7`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Override {
    /// The word for where it was given, in messages.
    pub given_by: &'static str,
    /// `KEY=VALUE`.
    pub text: String,
}

impl Override {
    /// `KEY=VALUE`, the key with its table.
    pub fn new(text: impl Into<String>) -> Self {
        Override::given_by("override", text)
    }

    /// The same with another word for where it was given, such as `--set`.
    pub fn given_by(word: &'static str, text: impl Into<String>) -> Self {
        Override { given_by: word, text: text.into() }
    }

    fn error(&self, message: impl Into<String>) -> LoadError {
        LoadError::Override {
            given_by: self.given_by,
            text: shown(&self.text),
            message: message.into(),
        }
    }

    /// Lay this value over the tree.
    fn apply(&self, root: &mut Table) -> Result<(), LoadError> {
        let Some((path, value)) = self.text.split_once('=') else {
            return Err(self.error("expected KEY=VALUE, for example dimensionless.adhesion=3e-3"));
        };
        let keys: Vec<&str> = path.split('.').map(str::trim).collect();
        let Some((last, tables)) = keys.split_last() else {
            return Err(self.error("the key is empty"));
        };
        if keys.iter().any(|key| key.is_empty()) {
            return Err(self.error("the key is empty; write it as table.key"));
        }
        if keys.len() > 8 {
            return Err(self.error("the key is too deep; write it as table.key"));
        }
        let origin = Origin::Given(self.given_by);
        let mut table = root;
        for key in tables {
            let node = table.entry((*key).to_string()).or_insert_with(|| Node {
                origin,
                raw: "a table".to_string(),
                value: Value::Table(Table::new()),
            });
            let Value::Table(inner) = &mut node.value else {
                return Err(self.error(format!("\"{}\" is not a table", shown(key))));
            };
            table = inner;
        }
        let value = value.trim();
        let parsed = match DeValue::parse(value) {
            Ok(parsed) => convert(parsed.get_ref(), &|_| origin, &|_| shown(value)),
            Err(_) => Value::Text(value.to_string()),
        };
        table.insert((*last).to_string(), Node { origin, raw: shown(value), value: parsed });
        Ok(())
    }
}

/// Parse `text` and lay the overrides over it, the later over the earlier.
///
/// # Errors
/// When the text is not TOML, or an override has no place.
pub(crate) fn parse(file: &str, text: &str, overrides: &[Override]) -> Result<Table, LoadError> {
    let table = DeTable::parse(text).map_err(|error| syntax(file, text, &error))?;
    let starts = line_starts(text);
    let origin = |span: Range<usize>| Origin::Line(line_of(&starts, span.start));
    let raw = |span: Range<usize>| shown(text.get(span).unwrap_or_default());
    let mut root = convert_table(table.get_ref(), &origin, &raw);
    for item in overrides {
        item.apply(&mut root)?;
    }
    Ok(root)
}

fn convert_table(
    table: &DeTable<'_>,
    origin: &dyn Fn(Range<usize>) -> Origin,
    raw: &dyn Fn(Range<usize>) -> String,
) -> Table {
    table
        .iter()
        .map(|(key, value)| {
            let node = Node {
                origin: origin(key.span()),
                raw: if value.get_ref().is_table() {
                    "a table".to_string()
                } else {
                    raw(value.span())
                },
                value: convert(value.get_ref(), origin, raw),
            };
            (key.get_ref().to_string(), node)
        })
        .collect()
}

fn convert(
    value: &DeValue<'_>,
    origin: &dyn Fn(Range<usize>) -> Origin,
    raw: &dyn Fn(Range<usize>) -> String,
) -> Value {
    match value {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Integer(integer) => {
            Value::Integer(i64::from_str_radix(integer.as_str(), integer.radix()).ok())
        }
        DeValue::Float(float) => Value::Real(float.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(value) => Value::Flag(*value),
        DeValue::Datetime(_) => Value::Other("a date"),
        DeValue::Array(items) => Value::Array(
            items
                .iter()
                .map(|item| Node {
                    origin: origin(item.span()),
                    raw: raw(item.span()),
                    value: convert(item.get_ref(), origin, raw),
                })
                .collect(),
        ),
        DeValue::Table(table) => Value::Table(convert_table(table, origin, raw)),
    }
}

/// A syntax error as one sentence with its line.
fn syntax(file: &str, text: &str, error: &toml::de::Error) -> LoadError {
    let span = error.span().unwrap_or_default();
    let line = line_of(&line_starts(text), span.start);
    let mut message = error.message().trim().replace('\n', "; ");
    if message == "duplicate key" {
        let key = shown(text.get(span).unwrap_or_default());
        message = format!("duplicate key \"{key}\"; keep one of the two");
    } else {
        message = format!("not valid TOML: {message}");
    }
    let text = shown(text.lines().nth(line - 1).unwrap_or_default());
    LoadError::Syntax { file: file.to_string(), line, message, text }
}

/// Offsets at which lines start.
fn line_starts(text: &str) -> Vec<usize> {
    let after_breaks = text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(at, _)| at + 1);
    std::iter::once(0).chain(after_breaks).collect()
}

/// The line, counted from one, of a byte offset.
fn line_of(starts: &[usize], offset: usize) -> usize {
    starts.partition_point(|start| *start <= offset).max(1)
}

/// A piece of text fit for a message: one line, no control characters, not too long.
pub fn shown(text: &str) -> String {
    const LONGEST: usize = 60;
    let trimmed = text.trim();
    let mut short: String = trimmed
        .chars()
        .take(LONGEST)
        .flat_map(|c| {
            let escaped: Vec<char> =
                if c.is_control() { c.escape_default().collect() } else { vec![c] };
            escaped
        })
        .collect();
    if trimmed.chars().nth(LONGEST).is_some() {
        short.push('…');
    }
    short
}
