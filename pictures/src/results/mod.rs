//! What a run leaves in its folder: its JSON, tables, pictures and page, with their checksums.
//!
//! Each kind of run has a function that makes its [`Results`], and one that names the files that may be among them.

mod diagram;
mod fit;
mod runs;
mod sweep;

#[cfg(test)]
mod tests;

pub use diagram::{diagram, diagram_names, orbits, orbits_names};
pub use fit::{FITS_NAMES, fit, fit_names, fits, no_fit, plan};
pub use runs::{cycle, cycle_names, map, map_names, trace, trace_names};
pub use sweep::{SWEEP_NAMES, sweep};

use crate::{pdf, png};
use std::fmt::Display;
use std::path::PathBuf;
use study::store::{Earlier, Files, Folder, with_files};

const CASE: &str = "case.toml";
const BRANCH: &str = "branch.csv";

/// What is wanted of a run besides its tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Wanted {
    /// Pictures.
    pub pictures: bool,
    /// The page.
    pub report: bool,
}

/// The formats that are wanted of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Formats {
    /// Lines and letters.
    pub svg: bool,
    /// Pixels.
    pub png: bool,
    /// A page.
    pub pdf: bool,
}

/// What a run has made for its user.
#[derive(Debug, Default)]
pub struct Results {
    name: String,
    json: String,
    files: Vec<(String, Vec<u8>)>,
    /// Checksums of all files, those written already included.
    sums: Files,
    problems: Vec<String>,
}

impl Results {
    /// The JSON, which is also the file `name`.
    pub fn new<E: Display>(name: &str, json: Result<String, E>) -> Self {
        let mut made = Results { name: name.to_owned(), ..Results::default() };
        made.json = made.take(json).unwrap_or_default();
        let text = made.json.clone();
        made.file(name, text);
        made
    }

    /// A file.
    pub fn file(&mut self, name: impl Into<String>, bytes: impl Into<Vec<u8>>) {
        self.files.push((name.into(), bytes.into()));
    }

    /// A file that could perhaps not be made.
    pub fn attempt<E: Display>(
        &mut self,
        name: impl Into<String>,
        bytes: Result<impl Into<Vec<u8>>, E>,
    ) {
        if let Some(bytes) = self.take(bytes) {
            self.file(name, bytes);
        }
    }

    /// Several files.
    pub fn files<E: Display>(&mut self, files: Result<Vec<(String, Vec<u8>)>, E>) {
        if let Some(files) = self.take(files) {
            self.files.extend(files);
        }
    }

    /// A file that was written already, with this checksum, or could not be.
    fn done<E: Display>(&mut self, name: &str, written: Result<u32, E>) {
        if let Some(sum) = self.take(written) {
            self.sums.insert(name.to_owned(), sum);
        }
    }

    /// The JSON, with the list of files once they are written.
    pub fn text(&self) -> &str {
        &self.json
    }

    /// What could not be made or written.
    pub fn problems(&self) -> &[String] {
        &self.problems
    }

    /// Pictures in the formats that are wanted; those that have a PNG already keep it and their SVG.
    pub fn choose(&mut self, formats: Formats) {
        let made = std::mem::take(&mut self.files);
        let names: Vec<String> = made.iter().map(|(name, _)| name.clone()).collect();
        for (name, bytes) in made {
            let Some(stem) = name.strip_suffix(".svg").map(str::to_owned) else {
                self.files.push((name, bytes));
                continue;
            };
            let svg = String::from_utf8_lossy(&bytes);
            let twin = format!("{stem}.png");
            let kept = names.contains(&twin);
            if formats.png
                && !kept
                && let Some(pixels) = self.take(png(&svg))
            {
                self.files.push((twin, pixels));
            }
            if formats.pdf
                && let Some(page) = self.take(pdf(&svg))
            {
                self.files.push((format!("{stem}.pdf"), page));
            }
            if formats.svg || kept {
                self.files.push((name, bytes));
            }
        }
    }

    /// Writes the files, and says whether that worked. Files that an earlier run left there and that say something
    /// else now are removed if nothing went wrong, `inputs` never.
    pub fn write(&mut self, folder: &Folder, inputs: &[PathBuf]) -> bool {
        self.list();
        let case = self.files.iter().find(|(name, _)| name == CASE);
        let case = case.and_then(|(_, bytes)| std::str::from_utf8(bytes).ok());
        let earlier = Earlier::read(folder.path(), &self.name, case);
        let written = folder.write_surely(&self.files);
        let written = self.take(written).is_some();
        if self.problems.is_empty() {
            earlier.remove(folder.path(), &self.sums, inputs);
        }
        written
    }

    /// Lists the files in the JSON.
    fn list(&mut self) {
        let others = self.files.iter().filter(|(name, _)| *name != self.name);
        self.sums.extend(others.map(|(name, bytes)| (name.clone(), crc32fast::hash(bytes))));
        self.json = with_files(&self.json, &self.sums);
        for (_, bytes) in self.files.iter_mut().filter(|(name, _)| *name == self.name) {
            bytes.clone_from(&self.json.clone().into_bytes());
        }
        // a file itself, but its own checksum it cannot hold
        self.sums.insert(self.name.clone(), 0);
    }

    /// What was made; an error is kept.
    fn take<T, E: Display>(&mut self, made: Result<T, E>) -> Option<T> {
        made.map_err(|error| self.problems.push(error.to_string())).ok()
    }
}
