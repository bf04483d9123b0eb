//! The output folder: checked before the work, made after it, its files replaced atomically.

use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Component, Path, PathBuf};
use tempfile::{Builder, NamedTempFile};

/// A folder into which results can be written as far as can be known beforehand.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Folder {
    path: PathBuf,
}

/// Why results cannot be written to a folder.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum FolderError {
    /// No path at all.
    #[error("--out: the path of the output folder is empty; give a folder")]
    Empty,
    /// A part of the path is a file.
    #[error("--out {}: {} is not a folder; give another path", .path.display(), .part.display())]
    NotAFolder {
        /// The folder asked for.
        path: PathBuf,
        /// The part of it that is something else.
        part: PathBuf,
    },
    /// A place in which nothing can be made.
    #[error("--out {}: cannot write to {}: {source}; give another path", .path.display(), .part.display())]
    NotWritable {
        /// The folder asked for.
        path: PathBuf,
        /// The nearest folder that exists.
        part: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A folder in the place of an output file.
    #[error("--out {}: {} is a folder, so the file of that name cannot be written; remove it or give another path", .path.display(), .name)]
    Occupied {
        /// The folder asked for.
        path: PathBuf,
        /// The file's name.
        name: String,
    },
    /// Writing failed after the work was done.
    #[error("{}: cannot be written: {source}", .path.display())]
    Write {
        /// The folder or file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

impl Folder {
    /// Check that `path` is, or can become, a folder in which the files `names` can be written.
    /// Nothing is created.
    ///
    /// # Errors
    /// When it cannot.
    pub(crate) fn check(path: &Path, names: &[&str]) -> Result<Self, FolderError> {
        if path.as_os_str().is_empty() {
            return Err(FolderError::Empty);
        }
        let part = nearest_existing(path)?;
        let not_writable = |source| FolderError::NotWritable {
            path: path.to_path_buf(),
            part: part.clone(),
            source,
        };
        tempfile::tempfile_in(&part).map_err(not_writable)?;
        for name in names {
            if path.join(name).is_dir() {
                let name = (*name).to_string();
                return Err(FolderError::Occupied { path: path.to_path_buf(), name });
            }
        }
        Ok(Folder { path: path.to_path_buf() })
    }

    /// Where it is.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Make the folder and write the files: first all under temporary names, then all renamed, so
    /// that no reader ever sees half a file, nor new files beside old ones when a disk is full.
    ///
    /// # Errors
    /// When the system refuses.
    pub(crate) fn write(&self, files: &[(String, Vec<u8>)]) -> Result<(), FolderError> {
        let failed = |path: &Path| {
            let path = path.to_path_buf();
            move |source| FolderError::Write { path, source }
        };
        fs::create_dir_all(&self.path).map_err(failed(&self.path))?;
        let mut ready = Vec::with_capacity(files.len());
        for (name, bytes) in files {
            let target = self.path.join(name);
            if let Some(parent) = target.parent() {
                fs::create_dir_all(parent).map_err(failed(parent))?;
            }
            let temporary = self.temporary(bytes).map_err(failed(&target))?;
            ready.push((target, temporary));
        }
        for (target, temporary) in ready {
            temporary.persist(&target).map_err(|error| failed(&target)(error.error))?;
        }
        Ok(())
    }

    /// Removes the tables `NAME-K.csv` with `K` from `first` on: those of an earlier run that had more
    /// of them. One that cannot be removed stays.
    pub(crate) fn remove_numbered(&self, name: &str, first: usize) {
        for k in first.. {
            if fs::remove_file(self.path.join(format!("{name}-{k}.csv"))).is_err() {
                return;
            }
        }
    }

    /// Make the folder and write a file from what `fill` says, likewise replaced at once; for files
    /// that need not fit into memory.
    ///
    /// # Errors
    /// When the system, or `fill`, refuses.
    pub(crate) fn stream(
        &self,
        name: &str,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), FolderError> {
        let target = self.path.join(name);
        let write = || {
            fs::create_dir_all(&self.path)?;
            let file = self.temporary(&[])?;
            let mut buffered = io::BufWriter::new(file);
            fill(&mut buffered)?;
            let file = buffered.into_inner().map_err(io::IntoInnerError::into_error)?;
            file.as_file().sync_all()?;
            file.persist(&target).map_err(|error| error.error)?;
            Ok(())
        };
        write().map_err(|source| FolderError::Write { path: target.clone(), source })
    }

    fn temporary(&self, bytes: &[u8]) -> io::Result<NamedTempFile> {
        let mut builder = Builder::new();
        builder.prefix(".arclen-");
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let mut file = builder.tempfile_in(&self.path)?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        Ok(file)
    }
}

/// The longest existing beginning of a path, which must be a folder.
fn nearest_existing(path: &Path) -> Result<PathBuf, FolderError> {
    let mut nearest = PathBuf::from(".");
    let mut so_far = PathBuf::new();
    let mut missing = false;
    for component in path.components() {
        so_far.push(component);
        if missing && component == Component::ParentDir {
            let source = io::Error::new(ErrorKind::NotFound, "\"..\" after a folder to be made");
            let path = path.to_path_buf();
            return Err(FolderError::NotWritable { path, part: so_far, source });
        }
        match fs::metadata(&so_far) {
            Ok(found) if found.is_dir() => nearest.clone_from(&so_far),
            Ok(_) => {
                return Err(FolderError::NotAFolder { path: path.to_path_buf(), part: so_far });
            }
            Err(error) if error.kind() == ErrorKind::NotFound => {
                // a link that leads nowhere exists without being found
                if fs::symlink_metadata(&so_far).is_ok() {
                    return Err(FolderError::NotAFolder { path: path.to_path_buf(), part: so_far });
                }
                missing = true;
            }
            Err(source) => {
                let path = path.to_path_buf();
                return Err(FolderError::NotWritable { path, part: so_far, source });
            }
        }
    }
    Ok(nearest)
}
