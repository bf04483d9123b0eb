//! Java's `.properties`: `key=value` lines in Latin-1 with `\` escapes.

use super::error::ArchiveError;
use std::collections::BTreeMap;

/// The properties of one entry.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Properties {
    /// The entry they stand in.
    pub(super) entry: String,
    values: BTreeMap<String, String>,
}

impl Properties {
    /// Reads them; a key that stands twice has its last value, as in Java.
    pub(super) fn parse(entry: &str, bytes: &[u8]) -> Result<Properties, ArchiveError> {
        // Latin-1: each byte is the character of its number
        let text: String = bytes.iter().map(|b| char::from(*b)).collect();
        let mut values = BTreeMap::new();
        let mut lines = text.lines().enumerate();
        while let Some((at, first)) = lines.next() {
            let mut logical = first.trim_start_matches(BLANK).to_owned();
            if logical.is_empty() || logical.starts_with(['#', '!']) {
                continue;
            }
            while continues(&logical) {
                logical.pop();
                let Some((_, more)) = lines.next() else { break };
                logical.push_str(more.trim_start_matches(BLANK));
            }
            let malformed = || ArchiveError::Properties { entry: entry.to_owned(), line: at + 1 };
            let (key, value) = divide(&logical);
            let key = unescape(key).ok_or_else(malformed)?;
            let value = unescape(value).ok_or_else(malformed)?;
            values.insert(key, value);
        }
        Ok(Properties { entry: entry.to_owned(), values })
    }

    /// The value of a key.
    pub(super) fn get(&self, key: &str) -> Option<&str> {
        self.values.get(key).map(String::as_str)
    }

    /// The first value whose key ends so.
    pub(super) fn ending(&self, end: &str) -> Option<(&str, &str)> {
        self.values
            .iter()
            .find(|(key, _)| key.ends_with(end))
            .map(|(key, value)| (key.as_str(), value.as_str()))
    }
}

/// What may stand before a key and around its separator.
const BLANK: [char; 3] = [' ', '\t', '\u{c}'];

/// Whether an odd number of backslashes ends the line: the next line belongs to it.
fn continues(line: &str) -> bool {
    line.chars().rev().take_while(|c| *c == '\\').count() % 2 == 1
}

/// Key and value: apart by the first `=`, `:` or blank that is not escaped, with blanks around it.
fn divide(line: &str) -> (&str, &str) {
    let mut escaped = false;
    for (at, c) in line.char_indices() {
        if !escaped && (c == '=' || c == ':' || BLANK.contains(&c)) {
            let rest = line[at..].trim_start_matches(BLANK);
            let value = rest.strip_prefix(['=', ':']).unwrap_or(rest);
            return (&line[..at], value.trim_start_matches(BLANK));
        }
        escaped = c == '\\' && !escaped;
    }
    (line, "")
}

/// `None` where `\u` is not followed by four hexadecimal digits.
fn unescape(text: &str) -> Option<String> {
    let mut plain = String::with_capacity(text.len());
    let mut units: Vec<u16> = Vec::new();
    let mut chars = text.chars();
    while let Some(c) = chars.next() {
        if c != '\\' {
            flush(&mut plain, &mut units);
            plain.push(c);
            continue;
        }
        match chars.next() {
            Some('u') => {
                let digits: String = chars.by_ref().take(4).collect();
                let all = digits.len() == 4 && digits.chars().all(|d| d.is_ascii_hexdigit());
                units.push(u16::from_str_radix(&digits, 16).ok().filter(|_| all)?);
                continue;
            }
            other => {
                flush(&mut plain, &mut units);
                match other {
                    Some('t') => plain.push('\t'),
                    Some('n') => plain.push('\n'),
                    Some('r') => plain.push('\r'),
                    Some('f') => plain.push('\u{c}'),
                    Some(c) => plain.push(c),
                    None => {}
                }
            }
        }
    }
    flush(&mut plain, &mut units);
    Some(plain)
}

/// Adds UTF-16 units that stood together: two may be one character.
fn flush(plain: &mut String, units: &mut Vec<u16>) {
    plain.push_str(&String::from_utf16_lossy(units));
    units.clear();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_form_that_java_writes() {
        let text = b"# comment\n! comment\r\n\na=1\n b : two words \nc d\ntime=2016-03-31 17\\:51\\:15\n\
                     long=one\\\n   and two\nkey\\ with\\=blank=x\nunit=\\u00b5m\nhat=\\ud83e\\udda9\nlatin=\xb5m\n\
                     path=C\\:\\\\a\nempty\nempty2=\na=last\nend=x\\";
        let found = Properties::parse("e", text).unwrap();
        for (key, value) in [
            ("a", "last"),
            ("b", "two words "),
            ("c", "d"),
            ("time", "2016-03-31 17:51:15"),
            ("long", "oneand two"),
            ("key with=blank", "x"),
            ("unit", "\u{b5}m"),
            ("hat", "\u{1f9a9}"),
            ("latin", "\u{b5}m"),
            ("path", "C:\\a"),
            ("empty", ""),
            ("empty2", ""),
            ("end", "x"),
        ] {
            assert_eq!(found.get(key), Some(value), "{key}");
        }
        assert_eq!(found.get("comment"), None);
    }

    #[test]
    fn an_unfinished_escape_is_named() {
        for bad in ["a=1\nb=\\u12", "a=1\nb=\\u12g4", "a=1\nb=\\u+123"] {
            let error = Properties::parse("e", bad.as_bytes()).unwrap_err();
            assert_eq!(error, ArchiveError::Properties { entry: "e".into(), line: 2 }, "{bad}");
        }
    }
}
