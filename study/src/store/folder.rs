//! The output folder: checked before the work, made after it, its files replaced atomically.

use super::temporary;
use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Component, Path, PathBuf};
use tempfile::{Builder, NamedTempFile};

/// Longest name of a file or folder, in bytes, as nearly all systems have it.
const LONGEST: usize = 255;

/// A folder into which results can be written as far as can be known beforehand.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Folder {
    path: PathBuf,
}

/// Why results cannot be written to a folder.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FolderError {
    /// No path at all.
    #[error("the path of the output folder is empty; give a folder")]
    Empty,
    /// A part of the path is a file.
    #[error("{}: {} is not a folder; give another path", .path.display(), .part.display())]
    NotAFolder {
        /// The folder asked for.
        path: PathBuf,
        /// The part of it that is something else.
        part: PathBuf,
    },
    /// A place in which nothing can be made.
    #[error("{}: cannot write to {}: {source}; give another path", .path.display(), .part.display())]
    NotWritable {
        /// The folder asked for.
        path: PathBuf,
        /// The nearest folder that exists.
        part: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A folder in the place of an output file.
    #[error("{}: {} is a folder, so the file of that name cannot be written; remove it or give another path", .path.display(), .name)]
    Occupied {
        /// The folder asked for.
        path: PathBuf,
        /// The file's name.
        name: String,
    },
    /// A file that the work starts from, in the place of an output file.
    #[error(
        "{}: writing {name} there would overwrite {}, from which this starts; give another \
         folder for the results", .path.display(), .input.display()
    )]
    Input {
        /// The folder asked for.
        path: PathBuf,
        /// The output file's name.
        name: String,
        /// The file that would be lost.
        input: PathBuf,
    },
    /// A name that no system takes.
    #[error("{}: a name of {length} bytes is too long for a folder; give one of at most {LONGEST}", .path.display())]
    LongName {
        /// The folder asked for.
        path: PathBuf,
        /// The name's length.
        length: usize,
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
    pub fn check(path: &Path, names: &[&str]) -> Result<Self, FolderError> {
        if path.as_os_str().is_empty() {
            return Err(FolderError::Empty);
        }
        let lengths = path.components().map(|part| part.as_os_str().len());
        if let Some(length) = lengths.max().filter(|length| *length > LONGEST) {
            return Err(FolderError::LongName { path: path.to_path_buf(), length });
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

    /// The folder for these files, none of which may be one of `inputs`; what programs left there
    /// half written that were killed is removed.
    ///
    /// # Errors
    /// When the files cannot, or must not, be written.
    pub fn claim(path: &Path, names: &[&str], inputs: &[PathBuf]) -> Result<Self, FolderError> {
        let folder = Folder::check(path, names)?;
        folder.spare(inputs, names)?;
        for place in ["", "unfinished", "cases"] {
            temporary::tidy(&path.join(place));
        }
        Ok(folder)
    }

    /// Check that none of the files `names` is one of `inputs`, through whatever links and whatever
    /// way it is reached. A name may have a `*` for a number.
    ///
    /// # Errors
    /// When one of them is.
    fn spare(&self, inputs: &[PathBuf], names: &[&str]) -> Result<(), FolderError> {
        for input in inputs {
            let Ok(known) = identity(input) else { continue };
            let is_input = |path: &Path| identity(path).is_ok_and(|found| found == known);
            let found = names.iter().find_map(|name| {
                let (folder, name) = match name.rsplit_once('/') {
                    Some((folder, name)) => (self.path.join(folder), name),
                    None => (self.path.clone(), *name),
                };
                let mut files = numbered(&folder, name);
                files.push(folder.join(name));
                files.into_iter().find(|file| is_input(file))
            });
            if let Some(file) = found {
                let name = file.strip_prefix(&self.path).unwrap_or(&file).display().to_string();
                let (path, input) = (self.path.clone(), input.clone());
                return Err(FolderError::Input { path, name, input });
            }
        }
        Ok(())
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Make the folder and write the files: first all under temporary names, then all renamed, so
    /// that no reader ever sees half a file, nor new files beside old ones when a disk is full.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn write(&self, files: &[(String, Vec<u8>)]) -> Result<(), FolderError> {
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

    /// The same, and once more if somebody has removed the folder meanwhile.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn write_surely(&self, files: &[(String, Vec<u8>)]) -> Result<(), FolderError> {
        let there = || files.iter().all(|(name, _)| self.path.join(name).is_file());
        if self.write(files).is_ok() && there() {
            return Ok(());
        }
        self.write(files)
    }

    /// Make the folder and write a file from what `fill` says, likewise replaced at once; for files
    /// that need not fit into memory. Its checksum is returned.
    ///
    /// # Errors
    /// When the system, or `fill`, refuses.
    pub fn stream(
        &self,
        name: &str,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<u32, FolderError> {
        let target = self.path.join(name);
        let write = || {
            fs::create_dir_all(&self.path)?;
            let file = self.temporary(&[])?;
            let summing = Summing { file, sum: crc32fast::Hasher::new() };
            let mut buffered = io::BufWriter::new(summing);
            fill(&mut buffered)?;
            let Summing { file, sum } =
                buffered.into_inner().map_err(io::IntoInnerError::into_error)?;
            file.as_file().sync_all()?;
            file.persist(&target).map_err(|error| error.error)?;
            Ok(sum.finalize())
        };
        write().map_err(|source| FolderError::Write { path: target.clone(), source })
    }

    fn temporary(&self, bytes: &[u8]) -> io::Result<NamedTempFile> {
        let mut builder = Builder::new();
        let prefix = temporary::prefix();
        builder.prefix(&prefix);
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let mut file = builder.tempfile_in(&self.path)?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        Ok(file)
    }
}

/// Adds up what it writes.
struct Summing {
    file: NamedTempFile,
    sum: crc32fast::Hasher,
}

impl Write for Summing {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes)?;
        self.sum.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Removes the files of a folder that are called `names`, in which a `*` stands for a number, and the
/// folder if nothing is left in it.
///
/// # Errors
/// When the system refuses.
pub(super) fn remove(folder: &Path, names: &[&str]) -> io::Result<()> {
    for name in names {
        let mut files = numbered(folder, name);
        files.push(folder.join(name));
        for file in files {
            match fs::remove_file(&file) {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
    }
    // what else is there is not the program's
    let _ = fs::remove_dir(folder);
    Ok(())
}

/// The files of a folder whose names are `name` with a number in the place of its `*`.
fn numbered(folder: &Path, name: &str) -> Vec<PathBuf> {
    let Some((before, after)) = name.split_once('*') else { return Vec::new() };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let is_one = |found: &str| {
        let number = found.strip_prefix(before).and_then(|rest| rest.strip_suffix(after));
        number.is_some_and(|n| !n.is_empty() && n.bytes().all(|byte| byte.is_ascii_digit()))
    };
    entries
        .filter(|entry| entry.file_name().to_str().is_some_and(is_one))
        .map(|entry| entry.path())
        .collect()
}

/// What tells whether two paths lead to the same file.
#[cfg(unix)]
fn identity(path: &Path) -> io::Result<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    fs::metadata(path).map(|found| (found.dev(), found.ino()))
}

/// The same where files have no numbers.
#[cfg(not(unix))]
fn identity(path: &Path) -> io::Result<PathBuf> {
    fs::canonicalize(path)
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
