//! How results leave a command: files, JSON on standard output, a summary, an exit code.

use crate::advice::Advised;
use crate::arguments::{Format, OutputArguments};
use crate::exit::Exit;
use crate::terminal;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use study::store::{Earlier, Files, Folder, with_files};

impl OutputArguments {
    /// The output folder; `None` when no files are wanted.
    pub(super) fn place(&self, case: &str) -> Option<PathBuf> {
        match &self.out {
            Some(path) => Some(path.clone()),
            None if self.json => None,
            None => Some(Path::new(".").join("arclen-out").join(case)),
        }
    }

    /// The output folder for these files, checked before the work starts; none of them may be one of
    /// `inputs`. A name may have a `*` for a number.
    pub(super) fn folder(
        &self,
        case: &str,
        names: &[&str],
        inputs: &[PathBuf],
    ) -> Result<Option<Folder>, Exit> {
        let others: Vec<String> = names
            .iter()
            .filter_map(|name| name.strip_suffix(".svg"))
            .flat_map(|stem| ["png", "pdf"].map(|ending| format!("{stem}.{ending}")))
            .collect();
        let names: Vec<&str> =
            names.iter().copied().chain(others.iter().map(String::as_str)).collect();
        let claimed = self.place(case).map(|path| Folder::claim(&path, &names, inputs));
        claimed.transpose().map_err(|error| {
            terminal::error(&error.advised());
            Exit::BadInput
        })
    }

    /// Writes files, JSON and summary; what cannot be made is said and left out. Files that an earlier
    /// run left there and that say something else now are removed, `inputs` never. `summary` is told
    /// where the files went, if they went anywhere; `complete` says whether all was computed.
    pub(super) fn deliver(
        &self,
        folder: Option<&Folder>,
        mut made: Made,
        inputs: &[PathBuf],
        summary: impl FnOnce(Option<&Path>) -> String,
        complete: bool,
    ) -> Exit {
        let mut written = None;
        if let Some(folder) = folder {
            made.format(&self.format);
            made.list();
            let earlier = made.earlier(folder.path());
            written = made.take(folder.write_surely(&made.files)).map(|()| folder.path());
            if !made.failed {
                earlier.remove(folder.path(), &made.sums, inputs);
            }
        }
        let mut printed = Exit::Done;
        if self.json {
            printed = super::print(&made.json);
        }
        if !self.quiet {
            let summary = summary(written);
            if self.json {
                terminal::err(&summary);
            } else {
                printed = super::print(&summary);
            }
        }
        if made.failed || printed != Exit::Done {
            Exit::NotWritten
        } else if complete {
            Exit::Done
        } else {
            Exit::StoppedEarly
        }
    }
}

/// What a command has made for its user.
#[derive(Debug, Default)]
pub(super) struct Made {
    name: String,
    json: String,
    files: Vec<(String, Vec<u8>)>,
    /// Checksums of all files, those written already included.
    sums: Files,
    failed: bool,
}

impl Made {
    /// The JSON, which is also the file `name`.
    pub(super) fn json<E: Display>(name: &str, json: Result<String, E>) -> Self {
        let mut made = Made { name: name.to_owned(), ..Made::default() };
        made.json = made.take(json).unwrap_or_default();
        let text = made.json.clone();
        made.file(name, text);
        made
    }

    /// A file.
    pub(super) fn file(&mut self, name: impl Into<String>, bytes: impl Into<Vec<u8>>) {
        self.files.push((name.into(), bytes.into()));
    }

    /// A file that could perhaps not be made.
    pub(super) fn attempt<E: Display>(
        &mut self,
        name: impl Into<String>,
        bytes: Result<impl Into<Vec<u8>>, E>,
    ) {
        if let Some(bytes) = self.take(bytes) {
            self.file(name, bytes);
        }
    }

    /// Several files.
    pub(super) fn files<E: Display>(&mut self, files: Result<Vec<(String, Vec<u8>)>, E>) {
        if let Some(files) = self.take(files) {
            self.files.extend(files);
        }
    }

    /// A file that was written already, with this checksum, or could not be.
    pub(super) fn done<E: Display>(&mut self, name: &str, written: Result<u32, E>) {
        if let Some(sum) = self.take(written) {
            self.sums.insert(name.to_owned(), sum);
        }
    }

    /// Pictures in the formats that are wanted; those that have a PNG already keep it and their SVG.
    fn format(&mut self, formats: &[Format]) {
        let made = std::mem::take(&mut self.files);
        let names: Vec<String> = made.iter().map(|(name, _)| name.clone()).collect();
        for (name, bytes) in made {
            let Some(stem) = name.strip_suffix(".svg").map(str::to_owned) else {
                self.files.push((name, bytes));
                continue;
            };
            let svg = String::from_utf8_lossy(&bytes);
            let (png, kept) = (format!("{stem}.png"), names.contains(&format!("{stem}.png")));
            if formats.contains(&Format::Png)
                && !kept
                && let Some(pixels) = self.take(pictures::png(&svg))
            {
                self.files.push((png, pixels));
            }
            if formats.contains(&Format::Pdf)
                && let Some(page) = self.take(pictures::pdf(&svg))
            {
                self.files.push((format!("{stem}.pdf"), page));
            }
            if formats.contains(&Format::Svg) || kept {
                self.files.push((name, bytes));
            }
        }
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

    /// What earlier runs left in the folder.
    fn earlier(&self, folder: &Path) -> Earlier {
        let case = self.files.iter().find(|(name, _)| name == "case.toml");
        let case = case.and_then(|(_, bytes)| std::str::from_utf8(bytes).ok());
        Earlier::read(folder, &self.name, case)
    }

    /// What was made; an error is said.
    fn take<T, E: Display>(&mut self, made: Result<T, E>) -> Option<T> {
        made.map_err(|error| {
            terminal::error(&error);
            self.failed = true;
        })
        .ok()
    }
}
