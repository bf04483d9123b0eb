//! Typed access to the tables of a case; complaints are collected, so that one run names them all.

use super::document::{Node, Origin, Table, Value, shown};
use super::error::{CaseError, Complaint};
use super::keys::Range;
use crate::closest::closest;
use crate::units::{self, Dimension, Quantity};
use std::cell::RefCell;

/// One table of a case, or its absence.
#[derive(Clone, Copy)]
pub(crate) struct Section<'a> {
    /// Its name; empty at the top level.
    pub name: &'static str,
    /// Where it stands.
    pub origin: Origin,
    table: Option<&'a Table>,
}

impl<'a> Section<'a> {
    /// The top level.
    pub(crate) fn root(table: &'a Table) -> Self {
        Section { name: "", origin: Origin::File, table: Some(table) }
    }

    /// A table that stands somewhere else, such as in an array.
    pub(crate) fn of(name: &'static str, origin: Origin, table: &'a Table) -> Self {
        Section { name, origin, table: Some(table) }
    }

    /// Whether the case has this table.
    pub(crate) fn exists(&self) -> bool {
        self.table.is_some()
    }

    /// A value, if it is there.
    pub(crate) fn get(&self, key: &str) -> Option<&'a Node> {
        self.table?.get(key)
    }

    /// All keys that are there.
    pub(crate) fn keys(&self) -> impl Iterator<Item = (&'a String, &'a Node)> {
        self.table.into_iter().flatten()
    }

    /// The full TOML path of a key.
    pub(crate) fn path(&self, key: &str) -> String {
        let bare = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_');
        let key = if !key.is_empty() && key.chars().all(bare) {
            key.to_string()
        } else {
            format!("\"{}\"", shown(key))
        };
        if self.name.is_empty() { key } else { format!("{}.{key}", self.name) }
    }
}

/// Reads values and collects what is wrong with them.
pub(crate) struct Reader {
    file: String,
    errors: RefCell<Vec<CaseError>>,
}

impl Reader {
    /// A reader whose complaints name `file`.
    pub(crate) fn new(file: &str) -> Self {
        Reader { file: file.to_string(), errors: RefCell::default() }
    }

    /// The complaints, in order of appearance.
    pub(crate) fn into_errors(self) -> Vec<CaseError> {
        let mut errors = self.errors.into_inner();
        errors.sort_by_key(|error| error.origin);
        errors
    }

    /// Whether nothing was wrong so far.
    pub(crate) fn has_no_errors(&self) -> bool {
        self.errors.borrow().is_empty()
    }

    /// Complain about a value.
    pub(crate) fn refuse(&self, section: Section<'_>, key: &str, node: &Node, why: Complaint) {
        self.push(node.origin, section.path(key), Some(node.raw.clone()), why);
    }

    /// Complain about a key that is not there.
    pub(crate) fn missing(&self, section: Section<'_>, key: &str, hint: impl Into<String>) {
        self.push(
            section.origin,
            section.path(key),
            None,
            Complaint::Missing { hint: hint.into() },
        );
    }

    /// Complain about anything.
    pub(crate) fn push(&self, origin: Origin, key: String, value: Option<String>, why: Complaint) {
        let file = self.file.clone();
        self.errors.borrow_mut().push(CaseError { file, origin, key, value, complaint: why });
    }

    /// The table `name`; an absent section if there is none, or something that is no table.
    pub(crate) fn section<'a>(&self, root: Section<'a>, name: &'static str) -> Section<'a> {
        let absent = Section { name, origin: Origin::File, table: None };
        let Some(node) = root.get(name) else { return absent };
        if let Value::Table(table) = &node.value {
            return Section { name, origin: node.origin, table: Some(table) };
        }
        self.wrong_type(root, name, node, &format!("a table [{name}]"), "");
        absent
    }

    /// Complain about every key that is not in `allowed`; `others` are tables with keys of their
    /// own, in which a misplaced key may be at home.
    pub(crate) fn only(
        &self,
        section: Section<'_>,
        allowed: &[&str],
        others: &[(&'static str, &[&str])],
    ) {
        for (key, node) in section.keys().filter(|(key, _)| !allowed.contains(&key.as_str())) {
            let belongs = others
                .iter()
                .find(|(name, keys)| *name != section.name && keys.contains(&key.as_str()))
                .map(|(name, _)| *name);
            let suggestion = match belongs {
                Some(_) => None,
                None => closest(key, allowed.iter().copied()).map(ToString::to_string),
            };
            let allowed = allowed.iter().map(ToString::to_string).collect();
            let why = Complaint::UnknownKey { allowed, suggestion, belongs };
            self.push(node.origin, section.path(key), None, why);
        }
    }

    /// Complain about a value of the wrong type.
    pub(crate) fn wrong_type(
        &self,
        section: Section<'_>,
        key: &str,
        node: &Node,
        expected: &str,
        hint: &'static str,
    ) {
        let found = node.value.type_name();
        let why = Complaint::WrongType { expected: expected.to_string(), found, hint };
        self.refuse(section, key, node, why);
    }

    /// A number, if it is there and allowed.
    pub(crate) fn number(&self, section: Section<'_>, key: &str, allowed: Range) -> Option<f64> {
        let node = section.get(key)?;
        let value = match node.value {
            Value::Real(value) => value,
            Value::Integer(Some(value)) => value as f64,
            Value::Integer(None) => f64::NAN,
            Value::Text(_) => {
                let hint = "; write it without quotes and without a unit";
                self.wrong_type(section, key, node, "a number", hint);
                return None;
            }
            _ => {
                self.wrong_type(section, key, node, "a number", "");
                return None;
            }
        };
        if value.is_finite() && (allowed.holds)(value) {
            return Some(value);
        }
        let allowed = allowed.words.to_string();
        self.refuse(section, key, node, Complaint::OutOfRange { allowed });
        None
    }

    /// A number that must be there.
    pub(crate) fn required(&self, section: Section<'_>, key: &str, allowed: Range) -> Option<f64> {
        if section.get(key).is_none() {
            self.missing(section, key, format!("give a number, {}", allowed.words));
        }
        self.number(section, key, allowed)
    }

    /// A whole number between two bounds, if it is there.
    pub(crate) fn count(
        &self,
        section: Section<'_>,
        key: &str,
        low: i64,
        high: i64,
    ) -> Option<usize> {
        let node = section.get(key)?;
        let Value::Integer(value) = node.value else {
            self.wrong_type(section, key, node, "an integer", "");
            return None;
        };
        match value {
            Some(value) if (low..=high).contains(&value) => usize::try_from(value).ok(),
            _ => {
                let allowed = format!("a whole number from {low} to {high}");
                self.refuse(section, key, node, Complaint::OutOfRange { allowed });
                None
            }
        }
    }

    /// `true` or `false`, if it is there.
    pub(crate) fn flag(&self, section: Section<'_>, key: &str) -> Option<bool> {
        let node = section.get(key)?;
        if let Value::Flag(value) = node.value {
            return Some(value);
        }
        let hint = match node.value {
            Value::Text(_) => "; write it without quotes",
            _ => "",
        };
        self.wrong_type(section, key, node, "true or false", hint);
        None
    }

    /// A string, if it is there.
    pub(crate) fn text<'a>(&self, section: Section<'a>, key: &str) -> Option<&'a str> {
        let node = section.get(key)?;
        if let Value::Text(text) = &node.value {
            return Some(text);
        }
        self.wrong_type(section, key, node, "a string", "; write it in quotes");
        None
    }

    /// One of a few words, if it is there.
    pub(crate) fn word(
        &self,
        section: Section<'_>,
        key: &str,
        words: &[&'static str],
    ) -> Option<&'static str> {
        let text = self.text(section, key)?;
        let known = words.iter().find(|word| **word == text).copied();
        if let (None, Some(node)) = (known, section.get(key)) {
            let suggestion = closest(text, words.iter().copied()).map(ToString::to_string);
            let allowed = words.iter().map(ToString::to_string).collect();
            self.refuse(section, key, node, Complaint::UnknownWord { allowed, suggestion });
        }
        known
    }

    /// An array, if it is there.
    pub(crate) fn array<'a>(
        &self,
        section: Section<'a>,
        key: &str,
        of: &str,
    ) -> Option<&'a [Node]> {
        let node = section.get(key)?;
        if let Value::Array(items) = &node.value {
            return Some(items);
        }
        self.wrong_type(section, key, node, &format!("an array of {of}"), "");
        None
    }

    /// A physical quantity, if it is there and allowed.
    pub(crate) fn quantity(
        &self,
        section: Section<'_>,
        key: &str,
        dimension: Dimension,
        allowed: Range,
    ) -> Option<Quantity> {
        let node = section.get(key)?;
        let Value::Text(text) = &node.value else {
            let expected =
                format!("a {dimension} with its unit such as \"{}\"", dimension.example());
            let hint = match node.value {
                Value::Integer(_) | Value::Real(_) => "; add the unit, in quotes",
                _ => "",
            };
            self.wrong_type(section, key, node, &expected, hint);
            return None;
        };
        match units::parse(text, dimension) {
            Err(error) => self.refuse(section, key, node, error.into()),
            Ok(quantity) if (allowed.holds)(quantity.si) => return Some(quantity),
            Ok(_) => {
                let allowed = allowed.words.to_string();
                self.refuse(section, key, node, Complaint::OutOfRange { allowed });
            }
        }
        None
    }

    /// A physical quantity that must be there.
    pub(crate) fn required_quantity(
        &self,
        section: Section<'_>,
        key: &str,
        dimension: Dimension,
        allowed: Range,
    ) -> Option<Quantity> {
        if section.get(key).is_none() {
            let hint = format!("give a {dimension} such as \"{}\"", dimension.example());
            self.missing(section, key, hint);
        }
        self.quantity(section, key, dimension, allowed)
    }
}
