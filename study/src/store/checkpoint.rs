//! What is kept of a diagram while it is explored: one file for each finished branch, one for the
//! branch that is traced at the moment, in a folder of their own that the finished diagram removes.
//!
//! Every file is written under another name and renamed, so that a program that is killed at any
//! moment leaves whole files. What belongs together is told by the case, whose text is kept beside. A
//! file that is not whole all the same, because a disk or a copy damaged it, is set aside, and what
//! it held is computed again.

use super::folder::{Folder, FolderError, remove};
use super::sealed::{self, Found};
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
pub enum CheckpointError {
    /// Another case.
    #[error(
        "{}: holds an unfinished diagram of another case ({difference})", .path.display()
    )]
    Foreign {
        /// The folder.
        path: PathBuf,
        /// The first line that differs.
        difference: String,
    },
    /// A file that cannot be read.
    #[error(
        "{}: cannot be read: {detail}", .path.display()
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
pub struct Checkpoint {
    path: PathBuf,
    folder: Folder,
    fingerprint: String,
    latest: Instant,
    failure: Option<CheckpointError>,
}

impl Checkpoint {
    /// The files of the checkpoint, in the folder of the results.
    pub const NAMES: [&str; 3] =
        ["unfinished/case.toml", "unfinished/part.cbor", "unfinished/branch-*.cbor"];

    /// The checkpoint in the folder `out`, of a case whose text is `case`. Nothing is created.
    ///
    /// # Errors
    /// When the folder cannot be had.
    pub fn check(out: &Path, case: &str) -> Result<Self, CheckpointError> {
        let path = out.join(FOLDER);
        let folder = Folder::check(&path, &[CASE, PART])?;
        let version = env!("CARGO_PKG_VERSION");
        let fingerprint = format!("# arclen {version}\n{case}");
        Ok(Checkpoint { path, folder, fingerprint, latest: Instant::now(), failure: None })
    }

    /// What is kept there, and the files that were damaged.
    ///
    /// # Errors
    /// When it is of another case or cannot be read.
    pub fn load(&self) -> Result<(Saved, Vec<PathBuf>), CheckpointError> {
        let file = self.path.join(CASE);
        let kept = match fs::read(&file) {
            Ok(kept) => kept,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Default::default()),
            Err(error) => return Err(unreadable(&file, &error)),
        };
        let mut damaged = Vec::new();
        if kept != self.fingerprint.as_bytes() {
            if !kept.is_empty() && !self.is_vouched_for()? {
                return Err(CheckpointError::Foreign {
                    path: self.path.clone(),
                    difference: difference(&String::from_utf8_lossy(&kept), &self.fingerprint),
                });
            }
            set_aside(&file, &mut damaged)?;
            self.folder.write(&[(CASE.to_owned(), self.fingerprint.clone().into_bytes())])?;
        }
        let mut saved = Saved::default();
        while let Some((branch, seconds)) =
            self.read::<(DiagramBranch, f64)>(&name(saved.finished.len()), &mut damaged)?
        {
            // a whole file may still be that of another branch
            if branch.id != saved.finished.len() {
                set_aside(&self.path.join(name(saved.finished.len())), &mut damaged)?;
                break;
            }
            saved.finished.push(branch);
            saved.seconds = seconds;
        }
        if let Some((after, part, seconds)) =
            self.read::<(usize, Unfinished, f64)>(PART, &mut damaged)?
            && after == saved.finished.len()
        {
            saved.unfinished = Some(part);
            saved.seconds = seconds;
        }
        Ok((saved, damaged))
    }

    /// Whether a whole file beside the case says that it is of this one.
    fn is_vouched_for(&self) -> Result<bool, CheckpointError> {
        for name in [name(0), PART.to_owned()] {
            let path = self.path.join(name);
            let found = sealed::read(&path).map_err(|error| unreadable(&path, &error))?;
            if matches!(found, Found::Whole(_, mark) if mark == sealed::mark(&self.fingerprint)) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// What a file holds; one that is damaged is set aside.
    fn read<T: DeserializeOwned>(
        &self,
        name: &str,
        damaged: &mut Vec<PathBuf>,
    ) -> Result<Option<T>, CheckpointError> {
        let path = self.path.join(name);
        let value = match sealed::read(&path).map_err(|error| unreadable(&path, &error))? {
            Found::Nothing => return Ok(None),
            Found::Whole(bytes, mark) if mark == sealed::mark(&self.fingerprint) => {
                ciborium::from_reader(&bytes[..]).ok()
            }
            Found::Whole(..) | Found::Damaged => None,
        };
        if value.is_none() {
            set_aside(&path, damaged)?;
        }
        Ok(value)
    }

    /// Begins anew: removes what is there, and keeps the case.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn begin(&mut self, resumed: bool) -> Result<(), CheckpointError> {
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
    pub fn remove(&self) -> Result<(), CheckpointError> {
        // the case first: without it the rest is nothing
        let own = [
            CASE,
            PART,
            "branch-*.cbor",
            "case.toml.damaged",
            "part.cbor.damaged",
            "branch-*.cbor.damaged",
        ];
        remove(&self.path, &own)
            .map_err(|source| FolderError::Write { path: self.path.clone(), source }.into())
    }

    /// The first file that could not be kept, if any.
    pub fn failure(&self) -> Option<&CheckpointError> {
        self.failure.as_ref()
    }

    fn write(&mut self, name: String, value: &impl Serialize) {
        self.latest = Instant::now();
        let mut bytes = Vec::new();
        let written = match ciborium::into_writer(value, &mut bytes) {
            Ok(()) => {
                sealed::seal(&mut bytes, sealed::mark(&self.fingerprint));
                let mut files = vec![(name, bytes)];
                // somebody may have removed the folder
                if !self.path.join(CASE).exists() {
                    files.push((CASE.to_owned(), self.fingerprint.clone().into_bytes()));
                }
                self.folder.write(&files)
            }
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

fn set_aside(path: &Path, damaged: &mut Vec<PathBuf>) -> Result<(), CheckpointError> {
    sealed::set_aside(path)
        .map_err(|source| FolderError::Write { path: path.to_path_buf(), source })?;
    damaged.push(path.to_path_buf());
    Ok(())
}

/// The first line in which two texts differ.
pub(super) fn difference(kept: &str, asked: &str) -> String {
    let mut lines = kept.lines().map(str::trim).zip(asked.lines().map(str::trim));
    match lines.find(|(a, b)| a != b) {
        Some((a, b)) => format!("there: {a}; here: {b}"),
        None => "one of them says more".to_owned(),
    }
}
