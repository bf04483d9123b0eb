//! The outcomes of a sweep on disk, one file for each case, in the folder `cases` of its results.
//!
//! A file is written under another name and renamed, so that a program that is killed at any moment
//! leaves whole files, and what is finished stays finished. Every file holds the text of its case;
//! `plan.json` beside them says what varies, and tells a sweep that has changed from one that goes
//! on. The files stay when the sweep is done: the tables are made from them, and so is the union of
//! several shards.

use super::record::CaseRecord;
use crate::output::checkpoint::difference;
use crate::output::folder::{Folder, FolderError};
use crate::output::result::Table;
use crate::run::Outcome;
use crate::sweep::{Plan, SweepCase};
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::{self, BufReader, ErrorKind, Write};
use std::path::{Path, PathBuf};

const FOLDER: &str = "cases";
const PLAN: &str = "plan.json";

/// Why the outcomes of a sweep cannot be kept or used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum StoreError {
    /// The folder is that of another sweep.
    #[error(
        "{}: holds the cases of another sweep, or of this one before it was changed \
         ({difference}); give another --out, or --restart to begin anew", .path.display()
    )]
    Foreign {
        /// The folder.
        path: PathBuf,
        /// The first line that differs.
        difference: String,
    },
    /// No sweep at all.
    #[error("{}: no results of a sweep; give the folders that \"arclen sweep\" wrote", .path.display())]
    Missing {
        /// The folder.
        path: PathBuf,
    },
    /// Shards of different sweeps.
    #[error("{}: not of the same sweep as {} ({difference})", .path.display(), .first.display())]
    Different {
        /// The folder.
        path: PathBuf,
        /// The first one.
        first: PathBuf,
        /// The first line that differs.
        difference: String,
    },
    /// A file that cannot be read.
    #[error("{}: cannot be read: {detail}", .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What happened.
        detail: String,
    },
    /// A file or folder that cannot be written or removed.
    #[error(transparent)]
    Folder(#[from] FolderError),
}

/// The beginning of a case's file.
#[derive(Serialize, Deserialize)]
struct Head {
    /// The text of the case, or why it is none.
    case: String,
    record: CaseRecord,
    curve: Vec<String>,
    events: Vec<String>,
}

/// A case that is kept: what is known of it without reading its points.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Kept {
    /// How it went.
    pub(crate) record: CaseRecord,
    /// Columns of its points.
    pub(super) curve: Vec<String>,
    /// Columns of its special points.
    pub(super) events: Vec<String>,
    path: PathBuf,
}

impl Kept {
    /// A case of which only the record is wanted.
    pub(crate) fn in_memory(record: CaseRecord) -> Self {
        Kept { record, curve: Vec::new(), events: Vec::new(), path: PathBuf::new() }
    }

    /// Its points and its special points.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub(super) fn tables(&self) -> Result<(Table, Table), StoreError> {
        let failed = |error: &dyn std::fmt::Display| unreadable(&self.path, error);
        let mut file = BufReader::new(fs::File::open(&self.path).map_err(|error| failed(&error))?);
        let _: Head = ciborium::from_reader(&mut file).map_err(|error| failed(&error))?;
        ciborium::from_reader(&mut file).map_err(|error| failed(&error))
    }
}

/// The folder in which the outcomes of a sweep are kept.
#[derive(Debug)]
pub(crate) struct Store {
    path: PathBuf,
    plan: Plan,
}

impl Store {
    /// The store in the folder `out`, of a sweep. Nothing is created.
    ///
    /// # Errors
    /// When the folder cannot be had.
    pub(crate) fn check(out: &Path, plan: &Plan) -> Result<Self, StoreError> {
        let path = out.join(FOLDER);
        Folder::check(&path, &[PLAN])?;
        Ok(Store { path, plan: plan.clone() })
    }

    /// The store that a sweep left in the folder `out`.
    ///
    /// # Errors
    /// When there is none, or it cannot be read.
    pub(crate) fn open(out: &Path) -> Result<Self, StoreError> {
        let path = out.join(FOLDER);
        let file = path.join(PLAN);
        let Some(text) = text(&file)? else {
            return Err(StoreError::Missing { path: out.to_path_buf() });
        };
        let plan = serde_json::from_str(&text).map_err(|error| unreadable(&file, &error))?;
        Ok(Store { path, plan })
    }

    /// What varies.
    pub(crate) fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The cases that are kept, those of `cases` in their order. A file that is not whole, which only
    /// a computer that lost its power leaves, is taken for none.
    ///
    /// # Errors
    /// When they are of another sweep, or cannot be read.
    pub(crate) fn load(&self, cases: &[SweepCase]) -> Result<Vec<Kept>, StoreError> {
        let Some(kept) = text(&self.path.join(PLAN))? else { return Ok(Vec::new()) };
        let asked = document(&self.plan)?;
        let foreign = |kept: &str, asked: &str| StoreError::Foreign {
            path: self.path.clone(),
            difference: difference(kept, asked),
        };
        if kept != asked {
            return Err(foreign(&kept, &asked));
        }
        let mut found = Vec::new();
        for case in cases {
            let Some((kept, of)) = self.head(case.index)? else { continue };
            let own = identity(case);
            if of != own {
                return Err(foreign(&of, &own));
            }
            found.push(kept);
        }
        Ok(found)
    }

    /// All cases that are kept, of whatever shard, in order.
    ///
    /// # Errors
    /// When they cannot be read.
    pub(crate) fn all(&self) -> Result<Vec<Kept>, StoreError> {
        let count = self.plan.count().unwrap_or(0);
        let shard = self.plan.shard;
        let own = (0..count).filter(|case| shard.holds(*case));
        let heads = own.map(|case| self.head(case));
        Ok(heads.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().map(|(k, _)| k).collect())
    }

    fn head(&self, case: usize) -> Result<Option<(Kept, String)>, StoreError> {
        let path = self.path.join(name(case));
        let file = match fs::File::open(&path) {
            Ok(file) => file,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(unreadable(&path, &error)),
        };
        let head: Option<Head> = ciborium::from_reader(BufReader::new(file)).ok();
        Ok(head.map(|Head { case, record, curve, events }| {
            (Kept { record, curve, events, path }, case)
        }))
    }

    /// Makes the folder; unless `resumed`, removes what is there.
    ///
    /// # Errors
    /// When the system refuses.
    pub(crate) fn begin(&self, resumed: bool) -> Result<(), StoreError> {
        let failed = |source| FolderError::Write { path: self.path.clone(), source };
        if !resumed {
            // the plan first: without it the rest is nothing
            for removed in [fs::remove_file(self.path.join(PLAN)), fs::remove_dir_all(&self.path)] {
                match removed {
                    Err(error) if error.kind() != ErrorKind::NotFound => Err(failed(error))?,
                    _ => {}
                }
            }
        }
        fs::create_dir_all(&self.path).map_err(failed)?;
        self.replace(PLAN, document(&self.plan)?.as_bytes()).map_err(failed)?;
        Ok(())
    }

    /// Keeps the outcome of a case.
    ///
    /// # Errors
    /// When the system refuses.
    pub(crate) fn keep(&self, case: &SweepCase, outcome: &Outcome) -> Result<Kept, StoreError> {
        let path = self.path.join(name(case.index));
        let head = Head {
            case: identity(case),
            record: outcome.record.clone(),
            curve: outcome.curve.columns().to_vec(),
            events: outcome.events.columns().to_vec(),
        };
        let mut bytes = Vec::new();
        ciborium::into_writer(&head, &mut bytes)
            .and_then(|()| ciborium::into_writer(&(&outcome.curve, &outcome.events), &mut bytes))
            .map_err(|error| io::Error::other(error.to_string()))
            .and_then(|()| self.replace(&name(case.index), &bytes))
            .map_err(|source| FolderError::Write { path: path.clone(), source })?;
        let Head { record, curve, events, .. } = head;
        Ok(Kept { record, curve, events, path })
    }

    /// Removes what a program that was killed left half written.
    pub(crate) fn tidy(&self) {
        for entry in fs::read_dir(&self.path).into_iter().flatten().flatten() {
            if entry.file_name().to_string_lossy().starts_with(TEMPORARY) {
                // one that stays does no harm
                let _ = fs::remove_file(entry.path());
            }
        }
    }

    /// Writes a file at once. It need not reach the disk before the next case begins: a killed
    /// program loses nothing that the system has.
    fn replace(&self, name: &str, bytes: &[u8]) -> io::Result<()> {
        let mut file = tempfile::Builder::new().prefix(TEMPORARY).tempfile_in(&self.path)?;
        file.write_all(bytes)?;
        file.persist(self.path.join(name)).map_err(|error| error.error)?;
        Ok(())
    }
}

const TEMPORARY: &str = ".arclen-";

/// Refuses stores of different sweeps.
///
/// # Errors
/// When two plans differ in more than their shards.
pub(crate) fn of_one_sweep(stores: &[(PathBuf, Store)]) -> Result<(), StoreError> {
    let Some(((first, store), others)) = stores.split_first() else { return Ok(()) };
    let plan = document(&store.plan)?;
    for (path, other) in others {
        let same_shard = Plan { shard: store.plan.shard, ..other.plan.clone() };
        let own = document(&same_shard)?;
        if own != plan {
            return Err(StoreError::Different {
                path: path.clone(),
                first: first.clone(),
                difference: difference(&own, &plan),
            });
        }
    }
    Ok(())
}

/// What a case is recognised by.
fn identity(case: &SweepCase) -> String {
    match &case.case {
        Ok(case) => case.to_toml(),
        Err(reason) => format!("# {reason}"),
    }
}

fn name(case: usize) -> String {
    format!("case-{case:06}.cbor")
}

fn document(plan: &Plan) -> Result<String, StoreError> {
    serde_json::to_string_pretty(plan).map_err(|error| unreadable(Path::new(PLAN), &error))
}

fn text(path: &Path) -> Result<Option<String>, StoreError> {
    match fs::read_to_string(path) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(unreadable(path, &error)),
    }
}

fn unreadable(path: &Path, error: &dyn std::fmt::Display) -> StoreError {
    StoreError::Unreadable { path: path.to_path_buf(), detail: error.to_string() }
}
