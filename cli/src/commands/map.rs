//! `arclen map`: curves of special points in two parameters.

use super::delivery::Made;
use super::progress::Observer;
use crate::Listen;
use crate::advice::Advised;
use crate::arguments::MapArguments;
use crate::exit::Exit;

use crate::terminal;
use study::case::ResolvedCase;
use study::record::{Laboratory, MapResult, Table, branch_csv, map_json, map_summary};
use study::run::run_map;
use study::store::Folder;

const MAP: &str = "map.json";
const CASE: &str = "case.toml";

/// Map a case.
pub(super) fn map(arguments: &MapArguments, listen: &Listen<'_>) -> Exit {
    let overrides = arguments.case.with_looks(&arguments.output);
    let case = match super::loaded(&arguments.case, &overrides, arguments.output.quiet) {
        Ok(loaded) => loaded.case,
        Err(exit) => return exit,
    };
    let names = [
        MAP,
        CASE,
        pictures::MAP,
        pictures::PHYSICAL_MAP,
        "fold-*.csv",
        "hopf-*.csv",
        "branch-point-*.csv",
    ];
    let folder = match arguments.output.folder(&case.name, &names, &arguments.case.inputs()) {
        Ok(folder) => folder,
        Err(exit) => return exit,
    };
    let mut observer = Observer::new(Some(case.path), arguments.output.quiet, listen);
    let outcome = run_map(&case, &arguments.over, &mut |progress| observer.update(progress));
    observer.finish();
    match outcome {
        Err(error) => {
            terminal::error(&error.advised());
            Exit::BadInput
        }
        Ok(result) => deliver(arguments, &case, &result, folder.as_ref()),
    }
}

/// Write files, JSON and summary.
fn deliver(
    arguments: &MapArguments,
    case: &ResolvedCase,
    result: &MapResult,
    folder: Option<&Folder>,
) -> Exit {
    let mut made = Made::json(MAP, map_json(result));
    if folder.is_some() {
        made.file(CASE, case.to_toml());
        let tables: Vec<&Table> = result.curves.iter().map(|curve| &curve.table).collect();
        let laboratory = Laboratory::of(case, &tables);
        for curve in &result.curves {
            made.attempt(curve.csv.clone(), branch_csv(&curve.table));
            if let Some(laboratory) = &laboratory {
                let name = curve.csv.replace(".csv", "-physical.csv");
                made.attempt(name, branch_csv(&laboratory.table(case, &curve.table)));
            }
        }
        if !arguments.output.no_pictures && !result.curves.is_empty() {
            made.files(pictures::draw_map(case, result));
        }
    }
    let complete = result.stopped_because.is_complete();
    arguments.output.deliver(
        folder,
        made,
        &arguments.case.inputs(),
        |written| map_summary(result, written),
        complete,
    )
}
