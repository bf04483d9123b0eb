//! The outcomes of a sweep on disk, one file for each case, in the folder `cases` of its results.
//!
//! A file is written under another name and renamed, so that a program that is killed at any moment
//! leaves whole files, and what is finished stays finished. Every file holds the text of its case;
//! `plan.json` beside them says what varies, and tells a sweep that has changed from one that goes
//! on. The files stay when the sweep is done: the tables are made from them, and so is the union of
//! several shards. A file that a disk or a copy damaged is set aside, and its case computed again.

use super::checkpoint::difference;
use super::folder::{Folder, FolderError, remove};
use super::sealed::{self, Found};
use super::temporary;
use crate::record::{CaseRecord, Table};
use crate::run::Outcome;
use crate::sweep::{Plan, SweepCase};
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

const FOLDER: &str = "cases";
const PLAN: &str = "plan.json";

/// Why the outcomes of a sweep cannot be kept or used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// The folder is that of another sweep.
    #[error(
        "{}: holds the cases of another sweep, or of this one before it was changed \
         ({difference})", .path.display()
    )]
    Foreign {
        /// The folder.
        path: PathBuf,
        /// The first line that differs.
        difference: String,
    },
    /// No sweep at all.
    #[error("{}: no results of a sweep", .path.display())]
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
    /// A plan that is not that of the cases beside it.
    #[error(
        "{}: damaged, or of another sweep than the cases beside it; start the sweep again",
        .path.display()
    )]
    Stray {
        /// The plan.
        path: PathBuf,
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
pub struct Kept {
    /// How it went.
    pub record: CaseRecord,
    /// Columns of its points.
    pub(super) curve: Vec<String>,
    /// Columns of its special points.
    pub(super) events: Vec<String>,
    path: PathBuf,
}

impl Kept {
    /// A case of which only the record is wanted.
    pub fn in_memory(record: CaseRecord) -> Self {
        Kept { record, curve: Vec::new(), events: Vec::new(), path: PathBuf::new() }
    }

    /// Its points and its special points.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub(super) fn tables(&self) -> Result<(Table, Table), StoreError> {
        let failed = |error: &dyn std::fmt::Display| unreadable(&self.path, error);
        let bytes = match sealed::read(&self.path).map_err(|error| failed(&error))? {
            Found::Whole(bytes, _) => bytes,
            Found::Nothing => return Err(failed(&"it is gone; start the same sweep again")),
            Found::Damaged => return Err(failed(&"damaged; start the same sweep again")),
        };
        let mut file = &bytes[..];
        let _: Head = ciborium::from_reader(&mut file).map_err(|error| failed(&error))?;
        ciborium::from_reader(&mut file).map_err(|error| failed(&error))
    }

    /// Whether its file is still there.
    pub fn is_there(&self) -> bool {
        self.path.as_os_str().is_empty() || self.path.is_file()
    }
}

/// The folder in which the outcomes of a sweep are kept.
#[derive(Debug)]
pub struct Store {
    path: PathBuf,
    plan: Plan,
}

impl Store {
    /// The store in the folder `out`, of a sweep. Nothing is created.
    ///
    /// # Errors
    /// When the folder cannot be had.
    pub fn check(out: &Path, plan: &Plan) -> Result<Self, StoreError> {
        let path = out.join(FOLDER);
        Folder::check(&path, &[PLAN])?;
        Ok(Store { path, plan: plan.clone() })
    }

    /// The store that a sweep left in the folder `out`.
    ///
    /// # Errors
    /// When there is none, or it cannot be read.
    pub fn open(out: &Path) -> Result<Self, StoreError> {
        let path = out.join(FOLDER);
        let file = path.join(PLAN);
        let Some(text) = text(&file)? else {
            return Err(StoreError::Missing { path: out.to_path_buf() });
        };
        let plan = serde_json::from_str(&text).map_err(|error| unreadable(&file, &error))?;
        Ok(Store { path, plan })
    }

    /// What varies.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The cases that are kept, those of `cases` in their order, and the files that were damaged.
    ///
    /// # Errors
    /// When they are of another sweep, or cannot be read.
    pub fn load(&self, cases: &[SweepCase]) -> Result<(Vec<Kept>, Vec<PathBuf>), StoreError> {
        let file = self.path.join(PLAN);
        let kept = match fs::read(&file) {
            Ok(kept) => kept,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Default::default()),
            Err(error) => return Err(unreadable(&file, &error)),
        };
        let asked = document(&self.plan)?;
        let foreign = |kept: &str, asked: &str| StoreError::Foreign {
            path: self.path.clone(),
            difference: difference(kept, asked),
        };
        let mut damaged = Vec::new();
        if kept != asked.as_bytes() {
            let is_one = serde_json::from_slice::<Plan>(&kept).is_ok();
            if is_one && !self.is_vouched_for(cases, sealed::mark(&asked))? {
                return Err(foreign(&String::from_utf8_lossy(&kept), &asked));
            }
            set_aside(&file, &mut damaged)?;
        }
        let mut found = Vec::new();
        for case in cases {
            match self.head(case.index)? {
                Case::Missing => {}
                Case::Damaged(path) => set_aside(&path, &mut damaged)?,
                Case::Whole(kept, of, _) => {
                    let own = identity(case);
                    if of != own {
                        return Err(foreign(&of, &own));
                    }
                    found.push(*kept);
                }
            }
        }
        Ok((found, damaged))
    }

    /// Whether a whole file beside the plan says that it is of this sweep.
    fn is_vouched_for(&self, cases: &[SweepCase], mark: u64) -> Result<bool, StoreError> {
        for case in cases {
            let path = self.path.join(name(case.index));
            match sealed::read(&path).map_err(|error| unreadable(&path, &error))? {
                Found::Whole(_, found) => return Ok(found == mark),
                Found::Nothing | Found::Damaged => {}
            }
        }
        Ok(false)
    }

    /// All cases that are kept, of whatever shard, in order, and the files that are damaged.
    ///
    /// # Errors
    /// When they cannot be read.
    pub fn all(&self) -> Result<(Vec<Kept>, Vec<PathBuf>), StoreError> {
        let of = sealed::mark(&document(&self.plan)?);
        let (mut all, mut damaged) = (Vec::new(), Vec::new());
        for case in self.numbers()? {
            match self.head(case)? {
                Case::Missing => {}
                Case::Damaged(path) => damaged.push(path),
                Case::Whole(kept, _, mark) if mark == of => all.push(*kept),
                Case::Whole(..) => return Err(StoreError::Stray { path: self.path.join(PLAN) }),
            }
        }
        Ok((all, damaged))
    }

    /// The numbers of the cases that have a file, in order. The plan is not asked: it may be damaged.
    fn numbers(&self) -> Result<Vec<usize>, StoreError> {
        let failed = |error: io::Error| unreadable(&self.path, &error);
        let mut numbers = Vec::new();
        for entry in fs::read_dir(&self.path).map_err(failed)? {
            let found = entry.map_err(failed)?.file_name();
            let number = found.to_str().and_then(|found| {
                found.strip_prefix("case-")?.strip_suffix(".cbor")?.parse::<usize>().ok()
            });
            numbers.extend(number.filter(|case| found.to_str() == Some(&name(*case))));
        }
        numbers.sort_unstable();
        Ok(numbers)
    }

    fn head(&self, case: usize) -> Result<Case, StoreError> {
        let path = self.path.join(name(case));
        let (bytes, mark) = match sealed::read(&path).map_err(|error| unreadable(&path, &error))? {
            Found::Nothing => return Ok(Case::Missing),
            Found::Damaged => return Ok(Case::Damaged(path)),
            Found::Whole(bytes, mark) => (bytes, mark),
        };
        let head: Result<Head, _> = ciborium::from_reader(&bytes[..]);
        Ok(match head {
            // a whole file may still be that of another case
            Ok(Head { case: text, record, curve, events }) if record.case == case => {
                Case::Whole(Box::new(Kept { record, curve, events, path }), text, mark)
            }
            _ => Case::Damaged(path),
        })
    }

    /// Makes the folder; unless `resumed`, removes what is there.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn begin(&self, resumed: bool) -> Result<(), StoreError> {
        let failed = |source| FolderError::Write { path: self.path.clone(), source };
        if !resumed {
            // the plan first: without it the rest is nothing
            remove(&self.path, &[PLAN, "case-*.cbor"]).map_err(failed)?;
        }
        fs::create_dir_all(&self.path).map_err(failed)?;
        self.replace(PLAN, document(&self.plan)?.as_bytes()).map_err(failed)?;
        Ok(())
    }

    /// Keeps the outcome of a case.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn keep(&self, case: &SweepCase, outcome: &Outcome) -> Result<Kept, StoreError> {
        let path = self.path.join(name(case.index));
        let head = Head {
            case: identity(case),
            record: outcome.record.clone(),
            curve: outcome.curve.columns().to_vec(),
            events: outcome.events.columns().to_vec(),
        };
        let mut bytes = Vec::new();
        let mark = sealed::mark(&document(&self.plan)?);
        ciborium::into_writer(&head, &mut bytes)
            .and_then(|()| ciborium::into_writer(&(&outcome.curve, &outcome.events), &mut bytes))
            .map_err(|error| io::Error::other(error.to_string()))
            .and_then(|()| {
                sealed::seal(&mut bytes, mark);
                self.replace(&name(case.index), &bytes)
            })
            .or_else(|error| {
                // somebody may have removed the folder
                if error.kind() != ErrorKind::NotFound {
                    return Err(error);
                }
                fs::create_dir_all(&self.path)?;
                self.replace(PLAN, document(&self.plan).map_err(io::Error::other)?.as_bytes())?;
                self.replace(&name(case.index), &bytes)
            })
            .map_err(|source| FolderError::Write { path: path.clone(), source })?;
        let Head { record, curve, events, .. } = head;
        Ok(Kept { record, curve, events, path })
    }

    /// Writes a file at once. It need not reach the disk before the next case begins: a killed
    /// program loses nothing that the system has.
    fn replace(&self, name: &str, bytes: &[u8]) -> io::Result<()> {
        let prefix = temporary::prefix();
        let mut file = tempfile::Builder::new().prefix(&prefix).tempfile_in(&self.path)?;
        file.write_all(bytes)?;
        file.persist(self.path.join(name)).map_err(|error| error.error)?;
        Ok(())
    }
}

/// What there is of a case.
enum Case {
    /// Nothing.
    Missing,
    /// A file that is not what was written.
    Damaged(PathBuf),
    /// What is known of it, what it is recognised by, and the mark of its sweep.
    Whole(Box<Kept>, String, u64),
}

fn set_aside(path: &Path, damaged: &mut Vec<PathBuf>) -> Result<(), StoreError> {
    sealed::set_aside(path)
        .map_err(|source| FolderError::Write { path: path.to_path_buf(), source })?;
    damaged.push(path.to_path_buf());
    Ok(())
}

/// Refuses stores of different sweeps.
///
/// # Errors
/// When two plans differ in more than their shards.
pub fn of_one_sweep(stores: &[(PathBuf, Store)]) -> Result<(), StoreError> {
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
