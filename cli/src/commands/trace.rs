//! `arclen trace`: follow a branch, write what was found.

use super::progress::Observer;
use crate::arguments::TraceArguments;
use crate::case::ResolvedCase;
use crate::exit::Exit;
use crate::output::{Folder, TraceResult, branch_csv, events_json, summary};
use crate::pictures;
use crate::run::{RunError, run_trace};
use crate::terminal;
use std::path::{Path, PathBuf};

const TABLE: &str = "branch.csv";
const EVENTS: &str = "events.json";
const CASE: &str = "case.toml";

/// Trace a case.
pub(super) fn trace(arguments: &TraceArguments) -> Exit {
    let case = match super::loaded(&arguments.case, arguments.quiet) {
        Ok(loaded) => loaded.case,
        Err(exit) => return exit,
    };
    let folder = match folder(arguments, &case.name) {
        Ok(folder) => folder,
        Err(exit) => return exit,
    };
    let mut observer = Observer::new(case.path, arguments.quiet);
    let outcome = run_trace(&case, &mut |progress| observer.hear(progress));
    observer.finish();
    match outcome {
        Err(error) => {
            terminal::error(&error);
            match error {
                RunError::NotAvailable { .. } => Exit::BadInput,
                RunError::NoStart { .. } => Exit::StoppedEarly,
            }
        }
        Ok(result) => deliver(arguments, &case, &result, folder.as_ref()),
    }
}

/// The output folder, checked before the work starts; `None` when no files are wanted.
fn folder(arguments: &TraceArguments, case: &str) -> Result<Option<Folder>, Exit> {
    let path: PathBuf = match &arguments.out {
        Some(path) => path.clone(),
        None if arguments.json => return Ok(None),
        None => Path::new(".").join("arclen-out").join(case),
    };
    let names: Vec<&str> = [TABLE, EVENTS, CASE].into_iter().chain(pictures::NAMES).collect();
    Folder::check(&path, &names).map(Some).map_err(|error| {
        terminal::error(&error);
        Exit::BadInput
    })
}

/// Write files, JSON and summary.
fn deliver(
    arguments: &TraceArguments,
    case: &ResolvedCase,
    result: &TraceResult,
    folder: Option<&Folder>,
) -> Exit {
    let mut failed = false;
    let mut complain = |error: &dyn std::fmt::Display| {
        terminal::error(error);
        failed = true;
    };
    let json = match events_json(result) {
        Ok(json) => json,
        Err(error) => {
            complain(&error);
            String::new()
        }
    };
    let mut written = None;
    if let Some(folder) = folder {
        let mut files = vec![
            (EVENTS.to_string(), json.clone().into_bytes()),
            (CASE.to_string(), case.to_toml().into_bytes()),
        ];
        match branch_csv(&result.table) {
            Ok(table) => files.push((TABLE.to_string(), table)),
            Err(error) => complain(&error),
        }
        if !arguments.no_pictures {
            match pictures::draw_all(&result.pictures) {
                Ok(drawn) => files.extend(drawn),
                Err(error) => complain(&error),
            }
        }
        match folder.write(&files) {
            Ok(()) => written = Some(folder.path()),
            Err(error) => complain(&error),
        }
    }
    let mut printed = Exit::Done;
    if arguments.json {
        printed = super::print(&json);
    }
    if !arguments.quiet {
        let summary = summary(result, written);
        if arguments.json {
            terminal::err(&summary);
        } else {
            printed = super::print(&summary);
        }
    }
    if failed || printed != Exit::Done {
        Exit::NotWritten
    } else if result.stopped_because.is_complete() {
        Exit::Done
    } else {
        Exit::StoppedEarly
    }
}
