//! Files of traces, cycles and maps.

use super::{BRANCH, CASE, Results, Wanted};
use crate::{
    COLUMNS, LOOP, MAP, NAMES, PHYSICAL, PHYSICAL_DIAGRAM, PHYSICAL_LOOP, PHYSICAL_MAP, REPORT,
    cycle_report, draw_all, draw_columns, draw_cycle, draw_map, draw_physical, report,
};
use study::case::ResolvedCase;
use study::record::{CycleResult, Laboratory, MapResult, Table, TraceResult};
use study::record::{
    branch_csv, cycle_json, cycle_table, events_json, map_json, modes_csv, physical_table,
};

const EVENTS: &str = "events.json";
const IN_UNITS: &str = "branch-physical.csv";
const MODES: &str = "modes.csv";
const CYCLE: &str = "cycle.json";
const PATH: &str = "cycle.csv";
const PATH_IN_UNITS: &str = "cycle-physical.csv";
const CURVES: &str = "map.json";

/// Names of the files that a trace may leave.
pub fn trace_names() -> Vec<&'static str> {
    let own = [BRANCH, IN_UNITS, EVENTS, MODES, CASE, REPORT];
    own.into_iter().chain(NAMES).chain(PHYSICAL).chain([PHYSICAL_DIAGRAM]).chain(COLUMNS).collect()
}

/// What a trace leaves: the JSON alone unless files are wanted.
pub fn trace(case: &ResolvedCase, result: &TraceResult, wanted: Option<Wanted>) -> Results {
    let mut made = Results::new(EVENTS, events_json(case, result));
    let Some(wanted) = wanted else { return made };
    made.file(CASE, case.to_toml());
    made.attempt(BRANCH, branch_csv(&result.table));
    if let Some(table) = physical_table(case, &result.table) {
        made.attempt(IN_UNITS, branch_csv(&table));
    }
    if !result.shapes.is_empty() {
        made.attempt(MODES, modes_csv(&result.shapes));
    }
    if wanted.report {
        let curves = [("branch".to_owned(), result)];
        made.attempt(REPORT, report(case, &result.stopped_detail, &curves));
    }
    if wanted.pictures {
        made.files(draw_all(case, &result.pictures));
        made.files(draw_physical(case, result));
        made.files(draw_columns(case, result));
    }
    made
}

/// Names of the files that a cycle may leave.
pub fn cycle_names() -> Vec<&'static str> {
    vec![CYCLE, PATH, PATH_IN_UNITS, BRANCH, IN_UNITS, CASE, REPORT, LOOP, PHYSICAL_LOOP]
}

/// What a cycle leaves: the JSON alone unless files are wanted.
pub fn cycle(case: &ResolvedCase, result: &CycleResult, wanted: Option<Wanted>) -> Results {
    let mut made = Results::new(CYCLE, cycle_json(result));
    let Some(wanted) = wanted else { return made };
    made.file(CASE, case.to_toml());
    made.attempt(PATH, branch_csv(&cycle_table(result)));
    made.attempt(BRANCH, branch_csv(&result.branch));
    if let Some(laboratory) = Laboratory::of(case, &[&result.branch]) {
        let path = laboratory.table(case, &cycle_table(result));
        made.attempt(PATH_IN_UNITS, branch_csv(&path));
        made.attempt(IN_UNITS, branch_csv(&laboratory.table(case, &result.branch)));
    }
    if wanted.report {
        made.attempt(REPORT, cycle_report(case, result));
    }
    if wanted.pictures {
        made.files(draw_cycle(case, result));
    }
    made
}

/// Names of the files that a map may leave, with a `*` for a number.
pub fn map_names() -> Vec<&'static str> {
    vec![CURVES, CASE, MAP, PHYSICAL_MAP, "fold-*.csv", "hopf-*.csv", "branch-point-*.csv"]
}

/// What a map leaves: the JSON alone unless files are wanted.
pub fn map(case: &ResolvedCase, result: &MapResult, wanted: Option<Wanted>) -> Results {
    let mut made = Results::new(CURVES, map_json(case, result));
    let Some(wanted) = wanted else { return made };
    made.file(CASE, case.to_toml());
    let tables: Vec<&Table> = result.curves.iter().map(|curve| &curve.table).collect();
    let laboratory = Laboratory::of(case, &tables);
    for curve in &result.curves {
        made.attempt(curve.csv.clone(), branch_csv(&curve.table));
        if let Some(laboratory) = laboratory.as_ref().filter(|one| one.converts(&curve.table)) {
            let name = curve.csv.replace(".csv", "-physical.csv");
            made.attempt(name, branch_csv(&laboratory.table(case, &curve.table)));
        }
    }
    if wanted.pictures && !result.curves.is_empty() {
        made.files(draw_map(case, result));
    }
    made
}
