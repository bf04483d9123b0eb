//! What is kept of a diagram while it is explored: one file for each finished branch, one for the
//! branch that is traced at the moment, in a folder of their own that the finished diagram removes.
//!
//! Every file is written under another name and renamed, so that a program that is killed at any
//! moment leaves whole files. What belongs together is told by the case, whose text is kept beside.

use super::folder::{Folder, FolderError};
use crate::run::{Keep, Saved};
use continuation::diagram::{DiagramBranch, Unfinished};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

const FOLDER: &str = "unfinished";
const CASE: &str = "case.toml";
const PART: &str = "part.cbor";
/// Time between two copies of a branch that is not finished.
const EVERY: Duration = Duration::from_secs(2);

/// Why what was kept cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum CheckpointError {
    /// Another case.
    #[error(
        "{}: holds an unfinished diagram of another case ({difference}); give another --out, or \
         --restart to begin anew", .path.display()
    )]
    Foreign {
        /// The folder.
        path: PathBuf,
        /// The first line that differs.
        difference: String,
    },
    /// A file that cannot be read.
    #[error(
        "{}: cannot be read: {detail}; give --restart to begin the diagram anew", .path.display()
    )]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What happened.
        detail: String,
    },
    /// A file that cannot be written or removed.
    #[error(transparent)]
    Folder(#[from] FolderError),
}

/// The folder in which an unfinished diagram is kept.
pub(crate) struct Checkpoint {
    path: PathBuf,
    folder: Folder,
    fingerprint: String,
    latest: Instant,
    failure: Option<CheckpointError>,
}

impl Checkpoint {
    /// The files of the checkpoint, in the folder of the results.
    pub(crate) const NAMES: [&str; 3] =
        ["unfinished/case.toml", "unfinished/part.cbor", "unfinished/branch-*.cbor"];

    /// The checkpoint in the folder `out`, of a case whose text is `case`. Nothing is created.
    ///
    /// # Errors
    /// When the folder cannot be had.
    pub(crate) fn check(out: &Path, case: &str) -> Result<Self, CheckpointError> {
        let path = out.join(FOLDER);
        let folder = Folder::check(&path, &[CASE, PART])?;
        let version = env!("CARGO_PKG_VERSION");
        let fingerprint = format!("# arclen {version}\n{case}");
        Ok(Checkpoint { path, folder, fingerprint, latest: Instant::now(), failure: None })
    }

    /// What is kept there.
    ///
    /// # Errors
    /// When it is of another case or cannot be read.
    pub(crate) fn load(&self) -> Result<Saved, CheckpointError> {
        let file = self.path.join(CASE);
        let kept = match fs::read_to_string(&file) {
            Ok(kept) => kept,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Saved::default()),
            Err(error) => return Err(unreadable(&file, &error)),
        };
        if kept != self.fingerprint {
            return Err(CheckpointError::Foreign {
                path: self.path.clone(),
                difference: difference(&kept, &self.fingerprint),
            });
        }
        let mut saved = Saved::default();
        while let Some((branch, seconds)) = read(&self.path.join(name(saved.finished.len())))? {
            saved.finished.push(branch);
            saved.seconds = seconds;
        }
        if let Some((after, part, seconds)) =
            read::<(usize, Unfinished, f64)>(&self.path.join(PART))?
            && after == saved.finished.len()
        {
            saved.unfinished = Some(part);
            saved.seconds = seconds;
        }
        Ok(saved)
    }

    /// Begins anew: removes what is there, and keeps the case.
    ///
    /// # Errors
    /// When the system refuses.
    pub(crate) fn begin(&mut self, resumed: bool) -> Result<(), CheckpointError> {
        if !resumed {
            self.remove()?;
            self.folder.write(&[(CASE.to_owned(), self.fingerprint.clone().into_bytes())])?;
        }
        Ok(())
    }

    /// Removes it all.
    ///
    /// # Errors
    /// When the system refuses.
    pub(crate) fn remove(&self) -> Result<(), CheckpointError> {
        // the case first: without it the rest is nothing
        for result in [fs::remove_file(self.path.join(CASE)), fs::remove_dir_all(&self.path)] {
            match result {
                Err(error) if error.kind() != ErrorKind::NotFound => {
                    return Err(
                        FolderError::Write { path: self.path.clone(), source: error }.into()
                    );
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// The first file that could not be kept, if any.
    pub(crate) fn failure(&self) -> Option<&CheckpointError> {
        self.failure.as_ref()
    }

    fn write(&mut self, name: String, value: &impl Serialize) {
        self.latest = Instant::now();
        let mut bytes = Vec::new();
        let written = match ciborium::into_writer(value, &mut bytes) {
            Ok(()) => self.folder.write(&[(name, bytes)]),
            Err(error) => Err(FolderError::Write {
                path: self.path.join(name),
                source: io::Error::other(error.to_string()),
            }),
        };
        if let Err(error) = written
            && self.failure.is_none()
        {
            self.failure = Some(error.into());
        }
    }
}

impl Keep for Checkpoint {
    fn branch(&mut self, branch: &DiagramBranch, seconds: f64) {
        self.write(name(branch.id), &(branch, seconds));
    }

    fn is_due(&self) -> bool {
        self.latest.elapsed() > EVERY
    }

    fn unfinished(&mut self, after: usize, branch: &Unfinished, seconds: f64) {
        self.write(PART.to_owned(), &(after, branch, seconds));
    }
}

fn name(branch: usize) -> String {
    format!("branch-{branch}.cbor")
}

fn unreadable(path: &Path, error: &dyn std::fmt::Display) -> CheckpointError {
    CheckpointError::Unreadable { path: path.to_path_buf(), detail: error.to_string() }
}

fn read<T: DeserializeOwned>(path: &Path) -> Result<Option<T>, CheckpointError> {
    let file = match fs::File::open(path) {
        Ok(file) => io::BufReader::new(file),
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(unreadable(path, &error)),
    };
    ciborium::from_reader(file).map(Some).map_err(|error| unreadable(path, &error))
}

/// The first line in which two texts differ.
pub(super) fn difference(kept: &str, asked: &str) -> String {
    let mut lines = kept.lines().map(str::trim).zip(asked.lines().map(str::trim));
    match lines.find(|(a, b)| a != b) {
        Some((a, b)) => format!("there: {a}; here: {b}"),
        None => "one of them says more".to_owned(),
    }
}
