//! `arclen trace`: follow a branch, write what was found.

use super::delivery::Made;
use super::progress::Observer;
use crate::Listen;
use crate::advice::Advised;
use crate::arguments::TraceArguments;
use crate::exit::Exit;
use pictures::{REPORT, report};

use crate::terminal;
use study::case::ResolvedCase;
use study::record::{TraceResult, branch_csv, events_json, modes_csv, physical_table, summary};
use study::run::{run_trace, run_trace_reported};
use study::store::Folder;

const TABLE: &str = "branch.csv";
const PHYSICAL: &str = "branch-physical.csv";
const EVENTS: &str = "events.json";
const MODES: &str = "modes.csv";
const CASE: &str = "case.toml";

/// Trace a case.
pub(super) fn trace(arguments: &TraceArguments, listen: &Listen<'_>) -> Exit {
    let overrides = arguments.case.with_looks(&arguments.output);
    let case = match super::loaded(&arguments.case, &overrides, arguments.output.quiet) {
        Ok(loaded) => loaded.case,
        Err(exit) => return exit,
    };
    let folder = match folder(arguments, &case.name) {
        Ok(folder) => folder,
        Err(exit) => return exit,
    };
    let mut observer = Observer::new(Some(case.path), arguments.output.quiet, listen);
    let run = if arguments.report { run_trace_reported } else { run_trace };
    let outcome = run(&case, &mut |progress| observer.update(progress));
    observer.finish();
    match outcome {
        Err(error) => {
            terminal::error(&error.advised());
            Exit::BadInput
        }
        Ok(result) => deliver(arguments, &case, &result, folder.as_ref()),
    }
}

/// The output folder, checked before the work starts; `None` when no files are wanted.
fn folder(arguments: &TraceArguments, case: &str) -> Result<Option<Folder>, Exit> {
    let names: Vec<&str> = [TABLE, PHYSICAL, EVENTS, MODES, CASE, REPORT]
        .into_iter()
        .chain(pictures::NAMES)
        .chain(pictures::PHYSICAL)
        .chain(pictures::COLUMNS)
        .collect();
    arguments.output.folder(case, &names, &arguments.case.inputs())
}

/// Write files, JSON and summary.
fn deliver(
    arguments: &TraceArguments,
    case: &ResolvedCase,
    result: &TraceResult,
    folder: Option<&Folder>,
) -> Exit {
    let mut made = Made::json(EVENTS, events_json(result));
    if folder.is_some() {
        made.file(CASE, case.to_toml());
        made.attempt(TABLE, branch_csv(&result.table));
        if let Some(table) = physical_table(case, &result.table) {
            made.attempt(PHYSICAL, branch_csv(&table));
        }
        if !result.shapes.is_empty() {
            made.attempt(MODES, modes_csv(&result.shapes));
        }
        if arguments.report {
            let curves = [("branch".to_owned(), result)];
            made.attempt(REPORT, report(case, &result.stopped_detail, &curves));
        }
        if !arguments.output.no_pictures {
            made.files(pictures::draw_all(case, &result.pictures));
            made.files(pictures::draw_physical(case, result));
            made.files(pictures::draw_columns(case, result));
        }
    }
    let complete = result.stopped_because.is_complete();
    arguments.output.deliver(
        folder,
        made,
        &arguments.case.inputs(),
        |written| summary(case, result, written),
        complete,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::{Arguments, Command};
    use clap::Parser;
    use continuation::StopReason;
    use std::fs;
    use std::ops::ControlFlow;
    use std::path::Path;
    use study::case::{LoadedCase, Override, load};

    /// A short branch.
    fn example() -> TraceResult {
        let keys = ["mesh.elements=40", "path.end=0.85", "stability.scan=axisymmetric"];
        let overrides = keys.map(Override::new);
        let case = load("fig12".as_ref(), &overrides, &[]).unwrap().case;
        run_trace(&case, &mut |_| ControlFlow::Continue(())).unwrap()
    }

    fn arguments(more: &[&str]) -> TraceArguments {
        let line = ["arclen", "trace", "fig12", "--quiet"].iter().chain(more);
        match Arguments::try_parse_from(line).unwrap().command {
            Command::Trace(arguments) => arguments,
            other => panic!("{other:?}"),
        }
    }

    fn deliver_to(folder: &Path, more: &[&str], result: &TraceResult) -> Exit {
        let LoadedCase { case, .. } = load("fig12".as_ref(), &[], &[]).unwrap();
        let folder = Folder::check(folder, &[]).unwrap();
        deliver(&arguments(more), &case, result, Some(&folder))
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_finished_trace_leaves_all_its_files() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("deep/out");
        let result = example();
        assert_eq!(deliver_to(&folder, &[], &result), Exit::Done);
        // the last picture is that of other problems
        let drawn = pictures::NAMES.into_iter().filter(|name| *name != "diagram.svg");
        let mut expected: Vec<&str> = [TABLE, EVENTS, CASE].into_iter().chain(drawn).collect();
        expected.sort_unstable();
        assert_eq!(names(&folder), expected);
        let written = load(&folder.join(CASE), &[], &[]).unwrap();
        assert_eq!(written, load("fig12".as_ref(), &[], &[]).unwrap());
    }

    #[test]
    fn pictures_have_the_formats_that_are_wanted() {
        let place = tempfile::tempdir().unwrap();
        let result = example();
        for (format, endings) in [
            ("svg", [true, false, false]),
            ("png", [false, true, false]),
            ("svg,png,pdf", [true; 3]),
        ] {
            let out = place.path().join(format);
            assert_eq!(deliver_to(&out, &["--format", format], &result), Exit::Done);
            let names = names(&out);
            let there = ["shapes.svg", "shapes.png", "shapes.pdf"]
                .map(|name| names.contains(&name.to_owned()));
            assert_eq!(there, endings, "{names:?}");
        }
        let png = fs::read(place.path().join("png/shapes.png")).unwrap();
        assert_eq!(&png[1..4], b"PNG");
        let pdf = fs::read(place.path().join("svg,png,pdf/shapes.pdf")).unwrap();
        assert_eq!(&pdf[..5], b"%PDF-");
        assert!(
            Arguments::try_parse_from(["arclen", "trace", "fig12", "--format", "eps"]).is_err()
        );
    }

    #[test]
    fn a_trace_that_stopped_early_leaves_its_files_and_exits_with_3() {
        let place = tempfile::tempdir().unwrap();
        let mut result = example();
        for reason in [StopReason::Interrupted, StopReason::StepTooSmall, StopReason::MaxPoints] {
            result.stopped_because = reason;
            assert_eq!(deliver_to(place.path(), &["--no-pictures"], &result), Exit::StoppedEarly);
            assert_eq!(names(place.path()), [TABLE, CASE, EVENTS]);
            let json = fs::read_to_string(place.path().join(EVENTS)).unwrap();
            assert!(json.contains(&format!("\"stopped_because\": \"{reason}\"")));
        }
    }

    #[test]
    fn a_folder_that_vanished_under_a_file_exits_with_1() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("out");
        let checked = Folder::check(&folder, &[]).unwrap();
        fs::write(&folder, "").unwrap();
        let LoadedCase { case, .. } = load("fig12".as_ref(), &[], &[]).unwrap();
        let exit = deliver(&arguments(&[]), &case, &example(), Some(&checked));
        assert_eq!(exit, Exit::NotWritten);
    }

    #[test]
    fn json_without_a_folder_writes_no_files() {
        assert_eq!(folder(&arguments(&["--json"]), "fig12").unwrap(), None);
        let place = folder(&arguments(&[]), "fig12").unwrap().unwrap();
        assert_eq!(place.path(), Path::new("./arclen-out/fig12"));
        let place = folder(&arguments(&["--json", "--out", "x"]), "fig12").unwrap().unwrap();
        assert_eq!(place.path(), Path::new("x"));
    }
}
