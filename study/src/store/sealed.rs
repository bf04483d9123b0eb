//! Files that know whether they are whole: what was written, and after it a seal with a checksum.
//!
//! A seal is 20 bytes: a mark of what the file belongs to, the length of the content, and CRC-32 of
//! the content, the mark and the length. It finds every flipped bit, every burst of up to 32 bits and
//! every cut.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

const SEAL: usize = 20;

/// What a file turned out to be.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Found {
    /// There is none.
    Nothing,
    /// It is whole: its content and its mark.
    Whole(Vec<u8>, u64),
    /// It is not what was written.
    Damaged,
}

/// A mark of what a file belongs to.
pub(super) fn mark(text: &str) -> u64 {
    // two checksums of the text, one of them backwards: no secret, only a name
    let backwards: Vec<u8> = text.bytes().rev().collect();
    u64::from(crc32fast::hash(text.as_bytes())) << 32 | u64::from(crc32fast::hash(&backwards))
}

/// Adds the seal to a content.
pub(super) fn seal(content: &mut Vec<u8>, mark: u64) {
    let length = content.len() as u64;
    content.extend(mark.to_le_bytes());
    content.extend(length.to_le_bytes());
    content.extend(crc32fast::hash(content).to_le_bytes());
}

/// Reads a sealed file.
///
/// # Errors
/// When the system does not let it be read.
pub(super) fn read(path: &Path) -> io::Result<Found> {
    match fs::read(path) {
        Ok(bytes) => Ok(open(bytes)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(Found::Nothing),
        Err(error) => Err(error),
    }
}

fn open(mut bytes: Vec<u8>) -> Found {
    let parts = bytes.len().checked_sub(SEAL).and_then(|length| {
        let (signed, sum) = bytes.split_last_chunk::<4>()?;
        let (rest, kept_length) = signed.split_last_chunk::<8>()?;
        let (_, mark) = rest.split_last_chunk::<8>()?;
        let whole = u64::from_le_bytes(*kept_length) == length as u64
            && u32::from_le_bytes(*sum) == crc32fast::hash(signed);
        whole.then(|| (length, u64::from_le_bytes(*mark)))
    });
    let Some((length, mark)) = parts else { return Found::Damaged };
    bytes.truncate(length);
    Found::Whole(bytes, mark)
}

/// Gives a damaged file another name, so that it can be looked at and is not met again; the new
/// name.
///
/// # Errors
/// When the system refuses.
pub(super) fn set_aside(path: &Path) -> io::Result<PathBuf> {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".damaged");
    let aside = path.with_file_name(name);
    fs::rename(path, &aside)?;
    Ok(aside)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn damage_of_any_kind_is_seen(
            content in prop::collection::vec(any::<u8>(), 0..300),
            of in any::<u64>(),
            at in any::<prop::sample::Index>(),
            bit in 0..8_u32,
            more in 1..40_usize,
        ) {
            let mut bytes = content.clone();
            seal(&mut bytes, of);
            prop_assert_eq!(open(bytes.clone()), Found::Whole(content, of));
            let mut flipped = bytes.clone();
            flipped[at.index(bytes.len())] ^= 1 << bit;
            prop_assert_eq!(open(flipped), Found::Damaged);
            let cut = bytes[..at.index(bytes.len())].to_vec();
            prop_assert_eq!(open(cut), Found::Damaged);
            let mut longer = bytes;
            longer.extend(vec![0; more]);
            prop_assert_eq!(open(longer), Found::Damaged);
        }
    }

    #[test]
    fn a_damaged_file_is_set_aside() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("x.cbor");
        assert_eq!(read(&path).unwrap(), Found::Nothing);
        fs::write(&path, "").unwrap();
        assert_eq!(read(&path).unwrap(), Found::Damaged);
        assert_eq!(set_aside(&path).unwrap(), place.path().join("x.cbor.damaged"));
        assert_eq!(read(&path).unwrap(), Found::Nothing);
    }
}
