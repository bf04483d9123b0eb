//! Entries of a zip archive, unpacked within bounds: no claim of the archive about its own size is trusted.

use super::error::ArchiveError;
use super::properties::Properties;
use std::collections::BTreeMap;
use std::io::{Cursor, Read};
use zip::ZipArchive;

/// Longest file of properties, bytes; the longest seen has 127 kB.
const PROPERTIES: u64 = 8 << 20;
/// Longest channel, bytes: two million samples of 8 bytes.
const CHANNEL: u64 = 16 << 20;
/// Most that is unpacked for a curve, bytes.
const CURVE: u64 = 256 << 20;

/// An open archive.
pub(super) struct Archive<'a> {
    zip: ZipArchive<Cursor<&'a [u8]>>,
    entries: BTreeMap<String, usize>,
    /// Bytes that may still be unpacked.
    left: u64,
}

impl<'a> Archive<'a> {
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, ArchiveError> {
        let bad = |why: String| ArchiveError::NotZip { why };
        let zip = ZipArchive::new(Cursor::new(bytes)).map_err(|e| bad(e.to_string()))?;
        if zip.has_duplicate_names() {
            return Err(bad("two entries have the same name".to_owned()));
        }
        let mut entries = BTreeMap::new();
        for at in 0..zip.len() {
            let name = match zip.name_for_index(at) {
                Some(Ok(name)) => name.into_owned(),
                Some(Err(error)) => return Err(bad(error.to_string())),
                None => return Err(bad(format!("entry {at} has no name"))),
            };
            entries.insert(name, at);
        }
        Ok(Archive { zip, entries, left: CURVE })
    }

    /// The names of all entries, in alphabetical order.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.keys().map(String::as_str)
    }

    pub(super) fn has(&self, entry: &str) -> bool {
        self.entries.contains_key(entry)
    }

    /// The numbers that follow `folder` in names: those of `index/`, or of the `segments/` of a curve.
    pub(super) fn numbers(&self, folder: &str) -> Result<Vec<usize>, ArchiveError> {
        let mut found: Vec<usize> = Vec::new();
        for name in self.names() {
            let Some(rest) = name.strip_prefix(folder).filter(|rest| !rest.is_empty()) else {
                continue;
            };
            let number = rest.split('/').next().unwrap_or(rest);
            let plain = number.bytes().all(|b| b.is_ascii_digit()) && rest.contains('/');
            match number.parse().ok().filter(|_| plain) {
                Some(number) => found.push(number),
                None => return Err(ArchiveError::Misplaced { entry: name.to_owned() }),
            }
        }
        found.sort_unstable();
        found.dedup();
        Ok(found)
    }

    pub(super) fn properties(&mut self, entry: &str) -> Result<Properties, ArchiveError> {
        let bytes = self.unpack(entry, PROPERTIES)?;
        Properties::parse(entry, &bytes)
    }

    pub(super) fn channel(&mut self, entry: &str) -> Result<Vec<u8>, ArchiveError> {
        self.unpack(entry, CHANNEL)
    }

    fn unpack(&mut self, entry: &str, most: u64) -> Result<Vec<u8>, ArchiveError> {
        let Some(at) = self.entries.get(entry) else {
            return Err(ArchiveError::NoEntry { entry: entry.to_owned() });
        };
        let damaged = |why: String| ArchiveError::Damaged { entry: entry.to_owned(), why };
        let limit = most.min(self.left);
        let file = self.zip.by_index(*at).map_err(|error| damaged(error.to_string()))?;
        let mut bytes = Vec::new();
        // one byte more than is allowed: that it is there says enough
        file.take(limit + 1).read_to_end(&mut bytes).map_err(|error| damaged(error.to_string()))?;
        if bytes.len() as u64 > limit {
            return Err(ArchiveError::TooLong { entry: entry.to_owned(), limit });
        }
        self.left -= bytes.len() as u64;
        Ok(bytes)
    }
}
