//! Every command with a film of double layer and van der Waals.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod support;

use serde_json::Value;
use std::fs;
use std::path::Path;
use support::{arclen, names, stderr};

const DLVO: [&str; 4] =
    ["--set", "dimensionless.potential=\"dlvo\"", "--set", "dimensionless.debye=0.15"];

const PATH: [&str; 2] = ["--set", "path.end=0.8"];

#[track_caller]
fn run(folder: &Path, arguments: &[&str]) {
    let output = arclen(folder, &[arguments, &["--out", "o", "-q", "--no-pictures"]].concat());
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", stderr(&output));
}

fn json(folder: &Path, file: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.join("o").join(file)).unwrap()).unwrap()
}

fn kinds(events: &Value) -> Vec<&str> {
    let events = events["events"].as_array().unwrap();
    events.iter().map(|event| event["kind"].as_str().unwrap()).collect()
}

#[test]
fn a_trace_counts_all_modes_and_a_diagram_follows_them() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    run(folder, &[&["trace", "fig12", "--elements", "80"][..], &DLVO].concat());
    let events = json(folder, "events.json");
    let kinds = kinds(&events);
    assert!(kinds.contains(&"fold") && kinds.contains(&"symmetry-breaking"), "{kinds:?}");
    let case = fs::read_to_string(folder.join("o/case.toml")).unwrap();
    assert!(case.contains("potential = \"dlvo\"") && case.contains("debye = 0.15"), "{case}");
    run(folder, &[&["diagram", "fig12", "--elements", "80"][..], &DLVO, &PATH].concat());
    assert!(names(&folder.join("o")).iter().any(|name| name.contains("asymmetric")));
}

/// Between two equal plates the mirror images are the states of the half model.
#[test]
fn two_plates_have_the_zero_of_one() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    let zero = |arguments: &[&str]| {
        run(folder, arguments);
        let events = json(folder, "events.json");
        let all = events["events"].as_array().unwrap();
        let at = all.iter().find(|event| event["kind"] == "zero-force").unwrap();
        at["p"].as_f64().or(at["parameter"].as_f64()).or(at["z0"].as_f64()).unwrap()
    };
    let path = ["--set", "path.end=0.88", "--elements", "60"];
    let half = zero(&[&["trace", "fig12"][..], &DLVO, &path].concat());
    let plates = ["top", "bottom"].map(|side| {
        [format!("plate.{side}.potential=\"dlvo\""), format!("plate.{side}.debye=0.15")]
    });
    let mut whole = [&["trace", "two-plates"][..], &path].concat();
    whole.extend(plates.iter().flatten().flat_map(|set| ["--set", set.as_str()]));
    assert!((zero(&whole) - half).abs() < 1e-9, "{half}");
    // between plates of different kinds the shell moves towards the one that attracts more
    let shift = |arguments: &[&str]| {
        run(folder, &[arguments, &["--set", "path.end=1.12"]].concat());
        let table = fs::read_to_string(folder.join("o/branch.csv")).unwrap();
        let at = table.lines().next().unwrap().split(',').position(|column| column == "shift");
        table.lines().last().unwrap().split(',').nth(at.unwrap()).unwrap().parse::<f64>().unwrap()
    };
    assert!(shift(&whole).abs() < 1e-12);
    whole.truncate(whole.len() - 4);
    assert!(shift(&whole).abs() > 1e-6);
}

#[test]
fn maps_cycles_and_sweeps_take_it() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    let map = ["map", "fig12", "--over", "film", "--elements", "40"];
    let path = ["--set", "map.from=0.02", "--set", "map.to=0.05"];
    run(folder, &[&map[..], &DLVO, &path].concat());
    assert!(!json(folder, "map.json")["curves"].as_array().unwrap().is_empty());
    let over = [&["map", "fig12", "--over", "debye", "-q"][..], &DLVO].concat();
    let output = arclen(folder, &over);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("debye") && stderr(&output).contains("film"));
    run(folder, &[&["cycle", "fig16", "--elements", "60"][..], &DLVO].concat());
    assert!(json(folder, "cycle.json")["loop_area"].as_f64().unwrap() > 0.0);
    let sweep = "case = \"fig12\"\n[dimensionless]\npotential = \"dlvo\"\n[mesh]\nelements = 40\n\
                 [path]\nend = 0.95\n[[vary]]\nkey = \"dimensionless.debye\"\n\
                 values = [0.05, 0.1, 0.2]\n";
    fs::write(folder.join("s.toml"), sweep).unwrap();
    run(folder, &["sweep", "s.toml"]);
    let curves = fs::read_to_string(folder.join("o/curves.csv")).unwrap();
    assert!(curves.starts_with("case,dimensionless.debye,"), "{}", &curves[..80]);
}

#[test]
fn surface_forces_are_told_in_physical_units() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    run(folder, &["trace", "dlvo", "--elements", "80"]);
    assert!(folder.join("o/branch-physical.csv").is_file());
    let output = arclen(folder, &["check", "dlvo", "--set", "physical.debye=\"30 nm\""]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let output = arclen(folder, &["check", "dlvo", "--set", "physical.hamaker=\"1e-18 J\""]);
    assert_eq!(output.status.code(), Some(2));
    let message = stderr(&output);
    assert!(message.contains("physical.hamaker") && message.contains("must be less than"));
    // a shell that is pressed harder than its film bears
    let weak = ["--set", "physical.surface_potential=\"16 mV\"", "--set", "path.end=0.7"];
    let trace = ["trace", "dlvo", "--elements", "80", "--out", "weak", "-q", "--no-pictures"];
    let output = arclen(folder, &[&trace[..], &weak].concat());
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    let events = fs::read_to_string(folder.join("weak/events.json")).unwrap();
    assert!(events.contains("the film breaks"), "{events}");
    fs::write(
        folder.join("lab.toml"),
        "[instrument]\nspring_constant = \"0.3 N/m\"\nnoise = \"50 pN\"\n",
    )
    .unwrap();
    let output = arclen(folder, &["fit", "--plan", "dlvo", "--known", "lab.toml", "-q"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("physical.potential"), "{}", stderr(&output));
}
