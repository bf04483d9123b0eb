//! `arclen orbits`: the periodic orbits that leave the Hopf points of a branch.

use super::delivery::Made;
use super::progress::Observer;
use crate::Listen;
use crate::advice::Advised;
use crate::arguments::OrbitsArguments;
use crate::exit::Exit;
use crate::terminal;
use std::path::Path;
use study::case::ResolvedCase;
use study::record::{DiagramResult, Laboratory, Table, branch_csv, diagram_json, diagram_summary};
use study::run::run_orbits;

const ORBITS: &str = "orbits.json";
const CASE: &str = "case.toml";

/// Files of branches of cycles, with a `*` for the number of the branch.
pub(super) const TABLES: &str = "orbit-*.csv";

/// Follow the periodic orbits of a case.
pub(super) fn orbits(arguments: &OrbitsArguments, listen: &Listen<'_>) -> Exit {
    let overrides = arguments.overrides();
    let case = match super::loaded(&arguments.case, &overrides, arguments.output.quiet) {
        Ok(loaded) => loaded.case,
        Err(exit) => return exit,
    };
    let names: Vec<&str> =
        [ORBITS, CASE, pictures::DIAGRAM, pictures::PERIOD, "branch-*.csv", TABLES]
            .into_iter()
            .chain(pictures::ORBITS)
            .collect();
    let folder = match arguments.output.folder(&case.name, &names, &arguments.case.inputs()) {
        Ok(folder) => folder,
        Err(exit) => return exit,
    };
    let observer = Observer::new(None, arguments.output.quiet, listen);
    let outcome = run_orbits(&case, arguments.hopf, &mut |at| observer.update_diagram(at));
    observer.finish();
    let result = match outcome {
        Ok(result) => result,
        Err(error) => {
            terminal::error(&error.advised());
            return Exit::BadInput;
        }
    };
    let mut made = Made::json(ORBITS, diagram_json(&result));
    if folder.is_some() {
        made.file(CASE, case.to_toml());
        add_files(&mut made, &case, &result, !arguments.output.no_pictures);
    }
    let summary = |written: Option<&Path>| diagram_summary(&result, written);
    let inputs = arguments.case.inputs();
    arguments.output.deliver(folder.as_ref(), made, &inputs, summary, result.followed)
}

/// The tables of all branches, and the pictures.
pub(super) fn add_files(
    made: &mut Made,
    case: &ResolvedCase,
    result: &DiagramResult,
    with_pictures: bool,
) {
    let tables: Vec<&Table> = result.branches.iter().map(|branch| &branch.trace.table).collect();
    let laboratory = Laboratory::of(case, &tables);
    for branch in &result.branches {
        made.attempt(branch.csv(), branch_csv(&branch.trace.table));
        if let Some(laboratory) = &laboratory {
            let name = branch.csv().replace(".csv", "-physical.csv");
            made.attempt(name, branch_csv(&laboratory.table(case, &branch.trace.table)));
        }
        if let Some(orbits) = &branch.orbits {
            let table = orbits.table(&result.parameter);
            made.attempt(branch.orbit_csv(), branch_csv(&table));
        }
    }
    if with_pictures && result.has_curves() {
        made.attempt(pictures::DIAGRAM, pictures::draw_diagram(case, result));
        made.files(pictures::draw_physical_diagram(case, result));
        made.files(pictures::draw_orbits(case, result));
    }
}
