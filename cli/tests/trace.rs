//! Traces as scripts see them: files, columns, exit codes, numbers.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn arclen(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_arclen")).args(arguments).current_dir(folder).output().unwrap()
}

fn events(folder: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.join("events.json")).unwrap()).unwrap()
}

/// Rows of `branch.csv` without its header.
fn rows(folder: &Path) -> Vec<Vec<String>> {
    let text = fs::read_to_string(folder.join("branch.csv")).unwrap();
    text.lines().skip(1).map(|l| l.split(',').map(str::to_owned).collect()).collect()
}

#[test]
fn strong_adhesion_gives_two_folds_and_every_file() {
    let place = tempfile::tempdir().unwrap();
    let output = arclen(place.path(), &["trace", "fig12", "--elements", "100"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let out = place.path().join("arclen-out/fig12");
    for file in ["branch.csv", "events.json", "case.toml", "force_distance.svg", "shapes.svg"] {
        assert!(out.join(file).is_file(), "{file}");
    }
    let json = events(&out);
    let kinds: Vec<&str> =
        json["events"].as_array().unwrap().iter().map(|e| e["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds.iter().filter(|k| **k == "fold").count(), 2);
    assert_eq!(kinds.iter().filter(|k| **k == "pull-off").count(), 1);
    assert_eq!(json["stopped_because"], "target");
    assert_eq!(json["points"].as_u64().unwrap() as usize, rows(&out).len());
    let rows = rows(&out);
    assert_eq!(rows[0][1], "1.15");
    assert_eq!(rows.last().unwrap()[1], "0.65");
    // special points stand among the rows, in order along the branch
    let marked: Vec<&str> = rows.iter().map(|r| r[15].as_str()).filter(|e| !e.is_empty()).collect();
    assert_eq!(marked, kinds);
}

#[test]
fn where_the_dimples_meet_the_trace_stops_and_keeps_its_results() {
    let place = tempfile::tempdir().unwrap();
    let arguments = ["trace", "fig06", "--elements", "100", "--set", "path.end=0.02", "--out", "o"];
    let output = arclen(place.path(), &arguments);
    assert_eq!(output.status.code(), Some(3));
    let out = place.path().join("o");
    let json = events(&out);
    assert_eq!(json["stopped_because"], "step-too-small");
    let detail = json["stopped_detail"].as_str().unwrap();
    assert!(detail.contains("the dimples meet"), "{detail}");
    let last = rows(&out).pop().unwrap();
    let pole: f64 = last[5].parse().unwrap();
    assert!((0.0..1e-5).contains(&pole), "pole height {pole}");
}

#[test]
fn a_branch_that_leads_the_plate_away_ends_at_a_far_limit() {
    let place = tempfile::tempdir().unwrap();
    let case = "problem = \"contact\"
        [shell]
        law = \"skalak\"
        poisson = 0.21649336055526724
        [dimensionless]
        bending = 0.0006590882581160481
        pressure = 0.0
        adhesion = 2.7827605414952284e-05
        film = 0.09408600860650465
        surface_tension = 1.0565392785199967
        gas_exponent = 0.0
        [mesh]
        elements = 100
        grading = 10.533209817471288
        [path]
        start = 1.6153586247219722
        end = 0.4654094279780276";
    std::fs::write(place.path().join("case.toml"), case).unwrap();
    let output = arclen(place.path(), &["trace", "case.toml", "--no-pictures", "--out", "o"]);
    assert_eq!(output.status.code(), Some(0));
    let json = events(&place.path().join("o"));
    assert_eq!(json["stopped_because"], "domain");
    let detail = json["stopped_detail"].as_str().unwrap();
    assert!(detail.contains("led the plate away from its end"), "{detail}");
}

#[test]
fn the_limit_of_points_is_kept_and_said() {
    let place = tempfile::tempdir().unwrap();
    let arguments =
        ["trace", "fig06", "--elements", "50", "--set", "path.max_points=20", "--out", "o"];
    let output = arclen(place.path(), &arguments);
    assert_eq!(output.status.code(), Some(3));
    let out = place.path().join("o");
    assert_eq!(events(&out)["stopped_because"], "max-points");
    assert_eq!(rows(&out).len(), 20);
}

#[test]
fn a_start_without_equilibrium_is_an_input_error() {
    let place = tempfile::tempdir().unwrap();
    let arguments =
        ["trace", "fig06", "--set", "dimensionless.adhesion=2", "--set", "path.start=1.01"];
    let output = arclen(place.path(), &arguments);
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("path.start = 1.01"), "{message}");
    assert!(message.contains("no solution at the start"), "{message}");
    assert_eq!(fs::read_dir(place.path()).unwrap().count(), 0);
}

#[test]
fn physical_units_give_the_same_curve_as_their_groups() {
    let place = tempfile::tempdir().unwrap();
    let out = place.path().join("o");
    let arguments = ["trace", "polymer", "--set", "path.end=0.96", "--out", "o", "--json"];
    let output = arclen(place.path(), &arguments);
    assert_eq!(output.status.code(), Some(0));
    let printed: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(printed, events(&out));
    // Fig. 6, another program on the same model: F = 0.43491916 at P_A = 2.895e-3; one standard
    // atmosphere is 2.895e-3 chi/R0 to four digits
    let force: f64 = rows(&out).pop().unwrap()[3].parse().unwrap();
    assert!((force - 0.434_919_16).abs() < 1e-6, "{force}");
}

#[test]
fn catalogue_problems_have_their_own_columns() {
    let place = tempfile::tempdir().unwrap();
    let output = arclen(place.path(), &["trace", "bratu", "--out", "o"]);
    assert_eq!(output.status.code(), Some(0));
    let out = place.path().join("o");
    let header = fs::read_to_string(out.join("branch.csv")).unwrap();
    assert!(header.starts_with("point,lambda,max_u,unstable,event\n"), "{header}");
    let json = events(&out);
    let fold = &json["events"][0];
    assert_eq!(fold["kind"], "fold");
    assert_eq!(fold["parameter"], "lambda");
    assert!((fold["lambda"].as_f64().unwrap() - 3.513_827_869_849_8).abs() < 1e-10);
}

#[test]
fn every_problem_of_the_catalogue_can_be_traced_and_checked() {
    let place = tempfile::tempdir().unwrap();
    let listed = arclen(place.path(), &["list"]);
    let listed = String::from_utf8(listed.stdout).unwrap();
    for entry in problems::catalogue() {
        let line = listed.lines().find(|line| line.trim_start().starts_with(entry.name));
        assert!(line.unwrap().ends_with(entry.summary), "{line:?}");
        let checked = arclen(place.path(), &["check", entry.name]);
        assert_eq!(checked.status.code(), Some(0), "{}", entry.name);
        fs::write(place.path().join("again.toml"), &checked.stdout).unwrap();
        let output = arclen(place.path(), &["trace", "again.toml", "--out", "o", "--quiet"]);
        let out = place.path().join("o");
        let json = events(&out);
        let complete = ["target", "closed-loop", "domain"].map(Value::from);
        let expected = if complete.contains(&json["stopped_because"]) { 0 } else { 3 };
        assert_eq!(output.status.code(), Some(expected), "{}", entry.name);
        assert_eq!(json["parameter"], entry.parameter);
        let first: f64 = rows(&out)[0][1].parse().unwrap();
        assert_eq!(first, entry.start, "{}", entry.name);
        let picture = fs::read_to_string(out.join("diagram.svg"));
        assert!(picture.unwrap().contains("<svg"), "{}", entry.name);
    }
}

#[test]
fn values_that_make_no_problem_are_input_errors() {
    let place = tempfile::tempdir().unwrap();
    for (arguments, parts) in [
        (
            ["trace", "shallow-arch", "--set", "parameters.rise=-2"],
            ["parameters.rise = -2", "must be positive"],
        ),
        (
            ["check", "euler-column", "--set", "mesh.elements=3"],
            ["mesh.elements = 3", "a whole number from 8 to 100000"],
        ),
        (["check", "pitchfork", "--set", "path.start=2"], ["path.start = 2", "must be negative"]),
        (
            ["trace", "jkr-load", "--set", "path.start=-5"],
            ["path.start = -5", "must be greater than -4.71238898038469"],
        ),
    ] {
        let output = arclen(place.path(), &arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        for part in parts {
            assert!(message.contains(part), "{part}: {message}");
        }
    }
    assert_eq!(fs::read_dir(place.path()).unwrap().count(), 0);
}
