//! Names of cases and sweeps, fit for folders.

use super::error::Complaint;
use super::reader::{Reader, Section};

/// Names name folders and files; systems allow 255 bytes, of which suffixes take some.
const LONGEST_NAME: usize = 200;

/// The key `name` of a file, if it is there and fit for a folder.
pub(crate) fn own_name<'a>(reader: &Reader, root: Section<'a>) -> Option<&'a str> {
    let text = reader.text(root, "name")?;
    if text == plain_name(text) {
        return Some(text);
    }
    let node = root.get("name")?;
    let allowed = format!(
        "a name fit for a folder: no slashes, no dot at its start, at most {LONGEST_NAME} bytes"
    );
    reader.refuse(root, "name", node, Complaint::OutOfRange { allowed });
    None
}

/// The nearest name that is fit for a folder.
pub fn plain_name(text: &str) -> String {
    let awkward = |c: char| c.is_control() || matches!(c, '/' | '\\' | ':');
    let mut name = text.trim().trim_start_matches('.').replace(awkward, "_");
    while name.len() > LONGEST_NAME {
        name.pop();
    }
    if name.is_empty() { "case".to_string() } else { name }
}
