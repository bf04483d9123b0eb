//! Single values of a case file, as the table of keys wants them.

use super::error::Complaint;
use super::keys::{ANY, Absent, Key, Kind, Range};
use super::reader::Section;
use super::resolve::Resolver;
use crate::units::{self, Quantity};

impl Resolver<'_> {
    /// A number, if it is there and allowed.
    pub(super) fn number(&self, section: Section<'_>, key: &Key) -> Option<f64> {
        self.reader.number(section, key.name, key.range())
    }

    /// A number that must be there.
    pub(super) fn required(&self, section: Section<'_>, key: &Key) -> Option<f64> {
        self.reader.required(section, key.name, key.range())
    }

    /// A number with a default; `None` only when the number given is wrong.
    pub(super) fn or_default(&self, section: Section<'_>, key: &Key) -> Option<f64> {
        match key.default {
            Absent::Number(default) => self.or(section, key.name, key.range(), default),
            _ => self.required(section, key),
        }
    }

    /// A whole number with a default.
    pub(super) fn count(&self, section: Section<'_>, key: &Key) -> Option<usize> {
        match (section.get(key.name), key.default) {
            (None, Absent::Count(default)) => Some(default),
            _ => {
                let (least, most) = key.bounds();
                self.reader.count(section, key.name, least, most)
            }
        }
    }

    /// Yes or no, with a default; `None` only when what is given is neither.
    pub(super) fn flag(&self, section: Section<'_>, key: &Key) -> Option<bool> {
        match (section.get(key.name), key.default) {
            (None, Absent::Flag(default)) => Some(default),
            _ => self.reader.flag(section, key.name),
        }
    }

    /// One of the words of a key.
    pub(super) fn word(&self, section: Section<'_>, key: &Key) -> Option<&'static str> {
        let Kind::Word(words) = key.kind else { return None };
        self.reader.word(section, key.name, words)
    }

    /// A quantity that must be there unless it has a default.
    pub(super) fn required_quantity(&self, section: Section<'_>, key: &Key) -> Option<Quantity> {
        let Kind::Quantity(dimension, range) = key.kind else { return None };
        match (section.get(key.name), key.default) {
            (None, Absent::Word(default)) => units::parse(default, dimension).ok(),
            _ => self.reader.required_quantity(section, key.name, dimension, range),
        }
    }

    /// A number in a range of the catalogue, with a default.
    pub(super) fn within(
        &self,
        section: Section<'_>,
        key: &str,
        allowed: problems::Allowed,
        default: f64,
    ) -> Option<f64> {
        let value = self.or(section, key, ANY, default)?;
        self.admits(section, key, allowed, value).then_some(value)
    }

    /// Whether the value of a key, if it is there, is in a range of the catalogue.
    pub(super) fn admits(
        &self,
        section: Section<'_>,
        key: &str,
        allowed: problems::Allowed,
        value: f64,
    ) -> bool {
        let Some(node) = section.get(key).filter(|_| !allowed.holds(value)) else { return true };
        let allowed = allowed.to_string();
        self.reader.refuse(section, key, node, Complaint::OutOfRange { allowed });
        false
    }

    /// A number with a default; `None` only when the number given is wrong.
    pub(super) fn or(
        &self,
        section: Section<'_>,
        key: &str,
        allowed: Range,
        default: f64,
    ) -> Option<f64> {
        match section.get(key) {
            None => Some(default),
            Some(_) => self.reader.number(section, key, allowed),
        }
    }
}
