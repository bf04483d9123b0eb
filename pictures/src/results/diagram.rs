//! Files of diagrams, and of the periodic orbits in them.

use super::{CASE, Results, Wanted};
use crate::{
    DIAGRAM, ORBITS, PERIOD, PHYSICAL_DIAGRAM, REPORT, draw_diagram, draw_orbits,
    draw_physical_diagram, report,
};
use study::case::ResolvedCase;
use study::record::{DiagramResult, Laboratory, Table, TraceResult, branch_csv, diagram_json};
use study::store::Checkpoint;

const BRANCHES: &str = "branch-*.csv";
const CYCLES: &str = "orbit-*.csv";

/// Names of the files that a diagram may leave, with a `*` for a number, and of what it keeps on its way.
pub fn diagram_names() -> Vec<&'static str> {
    let own = ["diagram.json", CASE, DIAGRAM, PHYSICAL_DIAGRAM, REPORT, BRANCHES, PERIOD, CYCLES];
    own.into_iter().chain(ORBITS).chain(Checkpoint::NAMES).collect()
}

/// What a diagram leaves: the JSON alone unless files are wanted.
pub fn diagram(case: &ResolvedCase, result: &DiagramResult, wanted: Option<Wanted>) -> Results {
    let mut made = Results::new("diagram.json", diagram_json(case, result));
    let Some(wanted) = wanted else { return made };
    add_branches(&mut made, case, result, wanted);
    if wanted.report {
        let label =
            |id: usize| if id == 0 { "first branch".into() } else { format!("branch {id}") };
        let curves: Vec<(String, &TraceResult)> =
            result.branches.iter().map(|branch| (label(branch.id), &branch.trace)).collect();
        made.attempt(REPORT, report(case, &result.stopped_detail, &curves));
    }
    made
}

/// Names of the files that periodic orbits may leave, with a `*` for a number.
pub fn orbits_names() -> Vec<&'static str> {
    ["orbits.json", CASE, DIAGRAM, PERIOD, BRANCHES, CYCLES].into_iter().chain(ORBITS).collect()
}

/// What periodic orbits leave: the JSON alone unless files are wanted.
pub fn orbits(case: &ResolvedCase, result: &DiagramResult, wanted: Option<Wanted>) -> Results {
    let mut made = Results::new("orbits.json", diagram_json(case, result));
    if let Some(wanted) = wanted {
        add_branches(&mut made, case, result, wanted);
    }
    made
}

/// The case, the tables of all branches, and the pictures.
fn add_branches(made: &mut Results, case: &ResolvedCase, result: &DiagramResult, wanted: Wanted) {
    made.file(CASE, case.to_toml());
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
    if wanted.pictures && result.has_curves() {
        made.attempt(DIAGRAM, draw_diagram(case, result));
        made.files(draw_physical_diagram(case, result));
        made.files(draw_orbits(case, result));
    }
}
