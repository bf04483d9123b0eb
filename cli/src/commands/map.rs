//! `arclen map`: curves of special points in two parameters.

use super::progress::Observer;
use crate::arguments::MapArguments;
use crate::case::ResolvedCase;
use crate::exit::Exit;
use crate::output::{Folder, MapResult, branch_csv, map_json, map_summary};
use crate::pictures;
use crate::run::run_map;
use crate::terminal;
use std::path::{Path, PathBuf};

const MAP: &str = "map.json";
const CASE: &str = "case.toml";

/// Map a case.
pub(super) fn map(arguments: &MapArguments) -> Exit {
    let case = match super::loaded(&arguments.case, &arguments.case.overrides(), arguments.quiet) {
        Ok(loaded) => loaded.case,
        Err(exit) => return exit,
    };
    let folder = match folder(arguments, &case.name) {
        Ok(folder) => folder,
        Err(exit) => return exit,
    };
    let mut observer = Observer::new(Some(case.path), arguments.quiet);
    let outcome = run_map(&case, &arguments.over, &mut |progress| observer.hear(progress));
    observer.finish();
    match outcome {
        Err(error) => {
            terminal::error(&error);
            Exit::BadInput
        }
        Ok(result) => deliver(arguments, &case, &result, folder.as_ref()),
    }
}

/// The output folder, checked before the work starts; `None` when no files are wanted.
fn folder(arguments: &MapArguments, case: &str) -> Result<Option<Folder>, Exit> {
    let path: PathBuf = match &arguments.out {
        Some(path) => path.clone(),
        None if arguments.json => return Ok(None),
        None => Path::new(".").join("arclen-out").join(case),
    };
    Folder::check(&path, &[MAP, CASE, pictures::MAP]).map(Some).map_err(|error| {
        terminal::error(&error);
        Exit::BadInput
    })
}

/// Write files, JSON and summary.
fn deliver(
    arguments: &MapArguments,
    case: &ResolvedCase,
    result: &MapResult,
    folder: Option<&Folder>,
) -> Exit {
    let mut failed = false;
    let mut complain = |error: &dyn std::fmt::Display| {
        terminal::error(error);
        failed = true;
    };
    let json = map_json(result).unwrap_or_else(|error| {
        complain(&error);
        String::new()
    });
    let mut written = None;
    if let Some(folder) = folder {
        let mut files = vec![
            (MAP.to_string(), json.clone().into_bytes()),
            (CASE.to_string(), case.to_toml().into_bytes()),
        ];
        for curve in &result.curves {
            match branch_csv(&curve.table) {
                Ok(table) => files.push((curve.csv.clone(), table)),
                Err(error) => complain(&error),
            }
        }
        if !arguments.no_pictures && !result.curves.is_empty() {
            match pictures::draw_map(result) {
                Ok(svg) => files.push((pictures::MAP.to_string(), svg.into_bytes())),
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
        let summary = map_summary(result, written);
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
