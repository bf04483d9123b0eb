//! How results leave a command: files, JSON on standard output, a summary, an exit code.

use super::Done;
use crate::advice::Advised;
use crate::arguments::{Format, OutputArguments};
use crate::exit::Exit;
use crate::terminal;
use pictures::results::{Formats, Results, Wanted};
use std::path::{Path, PathBuf};
use study::store::Folder;

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
        claimed.transpose().map_err(|error| super::refuse(&error.advised()))
    }

    /// The files that are wanted, if any are.
    pub(super) fn wanted(&self, folder: Option<&Folder>, report: bool) -> Option<Wanted> {
        folder.map(|_| Wanted { pictures: !self.no_pictures, report })
    }

    /// Writes files, JSON and summary; what cannot be made is said and left out. Files that an earlier
    /// run left there and that say something else now are removed, `inputs` never. `summary` is told
    /// where the files went, if they went anywhere; `complete` says whether all was computed.
    pub(super) fn deliver(
        &self,
        folder: Option<&Folder>,
        mut results: Results,
        inputs: &[PathBuf],
        summary: impl FnOnce(Option<&Path>) -> String,
        complete: bool,
    ) -> Done {
        let mut written = None;
        if let Some(folder) = folder {
            let wanted = |format| self.format.contains(&format);
            let [svg, png, pdf] = [Format::Svg, Format::Png, Format::Pdf].map(wanted);
            results.choose(Formats { svg, png, pdf });
            written = results.write(folder, inputs).then(|| folder.path());
        }
        for problem in results.problems() {
            terminal::error(problem);
        }
        let mut printed = Exit::Done;
        if self.json {
            printed = super::print(results.text());
        }
        if !self.quiet {
            let summary = summary(written);
            if self.json {
                terminal::err(&summary);
            } else {
                printed = super::print(&summary);
            }
        }
        if !results.problems().is_empty() || printed != Exit::Done {
            Err(Exit::NotWritten)
        } else if complete {
            Ok(Exit::Done)
        } else {
            Ok(Exit::StoppedEarly)
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::arguments::{Arguments, Command};
    use clap::Parser;
    use std::path::Path;

    #[test]
    fn json_without_a_folder_writes_no_files() {
        let place = |more: &[&str]| {
            let line = ["arclen", "trace", "fig12"].iter().chain(more);
            match Arguments::try_parse_from(line).unwrap().command {
                Command::Trace(arguments) => arguments.output.place("fig12"),
                other => panic!("{other:?}"),
            }
        };
        assert_eq!(place(&["--json"]), None);
        assert_eq!(place(&[]).unwrap(), Path::new("./arclen-out/fig12"));
        assert_eq!(place(&["--json", "--out", "x"]).unwrap(), Path::new("x"));
        let eps = ["arclen", "trace", "fig12", "--format", "eps"];
        assert!(Arguments::try_parse_from(eps).is_err());
    }
}
