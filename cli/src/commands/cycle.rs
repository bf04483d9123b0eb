//! `arclen cycle`: once to and fro, with the jumps between stable states.

use super::delivery::Made;
use super::progress::Observer;
use crate::Listen;
use crate::advice::Advised;
use crate::arguments::CycleArguments;
use crate::exit::Exit;
use pictures::{REPORT, cycle_report};

use crate::terminal;
use study::case::ResolvedCase;
use study::record::{CycleResult, Laboratory, branch_csv, cycle_json, cycle_summary, cycle_table};
use study::run::run_cycle;
use study::store::Folder;

const CYCLE: &str = "cycle.json";
const PATH: &str = "cycle.csv";
const BRANCH: &str = "branch.csv";
/// The same in physical units.
const PHYSICAL: [&str; 2] = ["cycle-physical.csv", "branch-physical.csv"];
const CASE: &str = "case.toml";

/// Travel a case to and fro.
pub(super) fn cycle(arguments: &CycleArguments, listen: &Listen<'_>) -> Exit {
    let overrides = arguments.case.with_looks(&arguments.output);
    let case = match super::loaded(&arguments.case, &overrides, arguments.output.quiet) {
        Ok(loaded) => loaded.case,
        Err(exit) => return exit,
    };
    let names: Vec<&str> =
        [CYCLE, PATH, BRANCH, CASE, REPORT, pictures::LOOP, pictures::PHYSICAL_LOOP]
            .into_iter()
            .chain(PHYSICAL)
            .collect();
    let folder = match arguments.output.folder(&case.name, &names, &arguments.case.inputs()) {
        Ok(folder) => folder,
        Err(exit) => return exit,
    };
    let mut observer = Observer::new(Some(case.path), arguments.output.quiet, listen);
    let outcome = run_cycle(&case, arguments.report, &mut |progress| observer.update(progress));
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
    arguments: &CycleArguments,
    case: &ResolvedCase,
    result: &CycleResult,
    folder: Option<&Folder>,
) -> Exit {
    let mut made = Made::json(CYCLE, cycle_json(result));
    if folder.is_some() {
        made.file(CASE, case.to_toml());
        made.attempt(PATH, branch_csv(&cycle_table(result)));
        made.attempt(BRANCH, branch_csv(&result.branch));
        if let Some(laboratory) = Laboratory::of(case, &[&result.branch]) {
            let path = laboratory.table(case, &cycle_table(result));
            made.attempt(PHYSICAL[0], branch_csv(&path));
            made.attempt(PHYSICAL[1], branch_csv(&laboratory.table(case, &result.branch)));
        }
        if arguments.report {
            made.attempt(REPORT, cycle_report(case, result));
        }
        if !arguments.output.no_pictures {
            made.files(pictures::draw_cycle(case, result));
        }
    }
    let complete = result.stopped_because.is_complete();
    arguments.output.deliver(
        folder,
        made,
        &arguments.case.inputs(),
        |written| cycle_summary(case, result, written),
        complete,
    )
}
