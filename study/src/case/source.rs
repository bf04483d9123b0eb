//! Where a case comes from: a file, a shipped case, or a problem of the catalogue.

use super::catalogue::catalogue;
use super::document::{self, Override};
use super::name::plain_name;
use super::problem::BUILT_IN;
use super::resolve::resolve;
use super::{CatalogueEntry, LoadError, LoadedCase};
use crate::closest::closest;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

/// The cases that come with the program: name and text.
pub const SHIPPED: &[(&str, &str)] = &[
    ("fig06", include_str!("../../cases/fig06.toml")),
    ("fig07", include_str!("../../cases/fig07.toml")),
    ("fig12", include_str!("../../cases/fig12.toml")),
    ("fig16", include_str!("../../cases/fig16.toml")),
    ("cantilever", include_str!("../../cases/cantilever.toml")),
    ("polymer", include_str!("../../cases/polymer.toml")),
    ("dlvo", include_str!("../../cases/dlvo.toml")),
    ("ring-load", include_str!("../../cases/ring-load.toml")),
    ("two-plates", include_str!("../../cases/two-plates.toml")),
];

/// The sweeps that come with the program, likewise.
pub const SWEEPS: &[(&str, &str)] = &[("phase", include_str!("../../cases/phase.toml"))];

/// Case files are small; what is longer is something else.
const LONGEST: u64 = 1 << 20;

/// The case that `what` names: a shipped case, a problem of the catalogue, or the path of a case file;
/// with overrides such as `dimensionless.adhesion=3e-3`, checked.
///
/// # Errors
/// When there is no such case, or something is wrong with it.
pub fn find(what: impl AsRef<Path>, overrides: &[&str]) -> Result<LoadedCase, LoadError> {
    load(what.as_ref(), &given(overrides), &catalogue())
}

/// The case that the text of a case file says, by the name that messages and results call it.
///
/// # Errors
/// When something is wrong with it.
pub fn parse(name: &str, text: &str, overrides: &[&str]) -> Result<LoadedCase, LoadError> {
    load_text(name, &plain_name(name), text, &given(overrides), &catalogue())
}

fn given(overrides: &[&str]) -> Vec<Override> {
    overrides.iter().copied().map(Override::new).collect()
}

/// The case that `what` names, with the overrides laid over it, checked.
///
/// # Errors
/// When there is no such case, or something is wrong with it.
pub fn load(
    what: &Path,
    overrides: &[Override],
    catalogue: &[CatalogueEntry],
) -> Result<LoadedCase, LoadError> {
    let word = what.to_string_lossy();
    // that of a sweep is no case, as its text is told
    if let Some((name, text)) = SHIPPED.iter().chain(SWEEPS).find(|(name, _)| *name == word) {
        return load_text(name, name, text, overrides, catalogue);
    }
    let built_in = BUILT_IN.iter().any(|(name, _)| *name == word);
    if built_in || catalogue.iter().any(|entry| entry.name == word) {
        let text = format!("problem = \"{word}\"\n");
        return load_text(&word, &word, &text, overrides, catalogue);
    }
    let is_path = word.contains(['/', '\\']) || what.extension().is_some() || what.exists();
    if !is_path {
        let known: Vec<String> = SHIPPED
            .iter()
            .map(|(name, _)| (*name).to_string())
            .chain(catalogue.iter().map(|entry| entry.name.clone()))
            .collect();
        let suggestion = closest(&word, known.iter().map(String::as_str)).map(str::to_string);
        return Err(LoadError::UnknownName { name: document::shown(&word), suggestion, known });
    }
    let text = read(what)?;
    let name = plain_name(&what.file_stem().unwrap_or_default().to_string_lossy());
    load_text(&word, &name, &text, overrides, catalogue)
}

/// A case from its text; `file` is what messages call it.
pub fn load_text(
    file: &str,
    name: &str,
    text: &str,
    overrides: &[Override],
    catalogue: &[CatalogueEntry],
) -> Result<LoadedCase, LoadError> {
    let tree = document::parse(file, text, overrides)?;
    resolve(file, name, &tree, catalogue).map_err(LoadError::Invalid)
}

/// The text of a file.
///
/// # Errors
/// When it cannot be read, is too long, or is no text.
pub(crate) fn read(path: &Path) -> Result<String, LoadError> {
    let file = path.display().to_string();
    let unreadable = |source: std::io::Error| match source.kind() {
        ErrorKind::NotFound => LoadError::Missing { file: file.clone() },
        ErrorKind::IsADirectory => LoadError::Folder { file: file.clone() },
        _ => LoadError::Unreadable { file: file.clone(), source },
    };
    if std::fs::metadata(path).map_err(unreadable)?.is_dir() {
        return Err(LoadError::Folder { file });
    }
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|opened| opened.take(LONGEST + 1).read_to_end(&mut bytes))
        .map_err(unreadable)?;
    if bytes.len() as u64 > LONGEST {
        return Err(LoadError::TooLong { file, limit: LONGEST });
    }
    String::from_utf8(bytes).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + good.iter().filter(|byte| **byte == b'\n').count();
        LoadError::NotUtf8 { file, line }
    })
}
