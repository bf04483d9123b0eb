//! Cycles as scripts see them: files, exit codes, numbers.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn arclen(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_arclen")).args(arguments).current_dir(folder).output().unwrap()
}

fn read(file: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn near(value: &Value, known: f64, tolerance: f64) {
    assert!((number(value) - known).abs() < tolerance, "{value} is not {known}");
}

/// A cycle with 100 elements in the folder `o`, and its JSON.
fn cycle(folder: &Path, case: &str, sets: &[&str]) -> (Output, Value) {
    let mut all = vec!["cycle", case, "--elements", "100", "--out", "o"];
    all.extend(sets.iter().flat_map(|set| ["--set", set]));
    let output = arclen(folder, &all);
    let file = folder.join("o/cycle.json");
    (output, if file.is_file() { read(&file) } else { Value::Null })
}

fn columns(file: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let mut reader = csv::Reader::from_path(file).unwrap();
    let names = reader.headers().unwrap().iter().map(str::to_string).collect();
    let rows = reader.records().map(|row| row.unwrap().iter().map(str::to_string).collect());
    (names, rows.collect())
}

/// The picture draws what the path is unstable to as its table says, and what was not counted.
#[test]
fn the_picture_shows_states_that_other_modes_destroy() {
    let place = tempfile::tempdir().unwrap();
    for (scan, others, left_out) in [("full", true, false), ("axisymmetric", false, true)] {
        let scan = format!("stability.scan={scan}");
        let (output, json) =
            cycle(place.path(), "fig16", &["path.start=1.2", "path.end=0.9", &scan]);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        let counted = json["stability"]["unstable_states"].as_u64().is_some_and(|n| n > 0);
        assert_eq!(counted, others);
        let picture = fs::read_to_string(place.path().join("o/loop.svg")).unwrap();
        let shows = |words: &str| picture.contains(words);
        assert!(shows("unstable to axisymmetric modes"));
        assert_eq!(shows("unstable to asymmetric modes only"), others, "{scan}");
        assert_eq!(shows("asymmetric modes not examined"), left_out, "{scan}");
    }
}

#[test]
fn a_grip_s_cycle_leaves_its_files_and_closes() {
    let place = tempfile::tempdir().unwrap();
    let (output, json) = cycle(place.path(), "fig16", &["path.start=1.2", "path.end=0.9"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let out = place.path().join("o");
    for file in ["cycle.json", "cycle.csv", "branch.csv", "case.toml", "loop.svg", "jump-1.svg"] {
        assert!(out.join(file).is_file(), "{file}");
    }
    assert_eq!((&json["device"], &json["parameter"]), (&"grip".into(), &"z0".into()));
    let jumps = json["jumps"].as_array().unwrap();
    assert_eq!(jumps.len(), 2);
    for (jump, (direction, fold)) in
        jumps.iter().zip([("approach", 1.128_512_4), ("retract", 1.149_605_6)])
    {
        assert_eq!(jump["direction"], direction);
        near(&jump["parameter"], fold, 1e-6);
        assert_eq!(
            (&jump["z0_before"], &jump["z0_after"]),
            (&jump["parameter"], &jump["parameter"])
        );
        let drop = number(&jump["energy_before"]) - number(&jump["energy_after"]);
        near(&jump["dissipated"], drop, 1e-15);
    }
    near(&json["pull_off"]["z0"], 1.062_942_7, 1e-4);
    near(&json["pull_off"]["force"], -1.450_496, 1e-5);
    let total = number(&json["dissipated_total"]);
    near(&json["loop_area"], total, 1e-6 * total);
    let work = number(&json["work"]["approach"]) + number(&json["work"]["retract"]);
    near(&json["loop_area"], work, 1e-12);
    assert_eq!((&json["closed"], &json["stopped_because"]), (&true.into(), &"closed-loop".into()));
    let maxwell = json["maxwell"].as_array().unwrap();
    assert_eq!(maxwell.len(), 1);
    near(&maxwell[0]["z0"], 1.136_885_2, 1e-6);
    assert!(
        maxwell[0]["force"].as_array().unwrap().len() == 2
            && number(&maxwell[0]["error_estimate"]) < 1e-8
    );
    assert_eq!(json["unstable"][0]["modes"], 1);

    let (names, rows) = columns(&out.join("cycle.csv"));
    assert_eq!(names[..6], ["direction", "step", "z0", "force", "energy_total", "event"]);
    // what else the states are unstable to: the bubble between plates that it does not touch goes to one
    assert_eq!(names[6..], ["unstable_antisymmetric", "unstable_modes", "first_n", "stable"]);
    assert_eq!((rows[0][6].as_str(), rows[0][9].as_str()), ("1", "no"));
    assert!(rows.iter().any(|row| row[9] == "yes"));
    assert_eq!(json["stability"]["followed"]["parities"], serde_json::json!(["symmetric"]));
    assert_eq!(rows.len(), json["points"].as_u64().unwrap() as usize);
    assert_eq!((rows[0][2].as_str(), rows.last().unwrap()[2].as_str()), ("1.2", "1.2"));
    assert_eq!(rows.iter().filter(|row| row[5] == "jump").count(), 2);
    let (names, rows) = columns(&out.join("branch.csv"));
    assert_eq!(names[..5], ["point", "z0", "deformation", "force", "unstable"]);
    assert!(rows.iter().any(|row| row[4] == "1") && rows.last().unwrap()[1] == "0.9");
    let summary = String::from_utf8_lossy(&output.stdout).into_owned();
    for words in ["pull-off: force -1.4505", "area of the loop", "Maxwell point", "2 jumps"] {
        assert!(summary.contains(words), "{summary}");
    }
    // the case that was written makes the same cycle
    let again = arclen(place.path(), &["cycle", "o/case.toml", "--json", "--quiet"]);
    let again: Value = serde_json::from_slice(&again.stdout).unwrap();
    assert_eq!(again["jumps"], json["jumps"]);
}

#[test]
fn a_report_goes_both_ways() {
    let place = tempfile::tempdir().unwrap();
    let words = ["cycle", "fig16", "--elements", "60", "--report", "-q", "--no-pictures"];
    let sets = ["--set", "path.start=1.2", "--set", "path.end=0.9", "--out", "o"];
    let output = arclen(place.path(), &[&words[..], &sets[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let page = fs::read_to_string(place.path().join("o/report.html")).unwrap();
    let start = page.find("id=\"data\">").unwrap() + 10;
    let end = start + page[start..].find("</script>").unwrap();
    let data: Value = serde_json::from_str(&page[start..end]).unwrap();
    let json = read(&place.path().join("o/cycle.json"));
    let curves = data["curves"].as_array().unwrap();
    let labels: Vec<_> = curves.iter().map(|curve| curve["label"].as_str().unwrap()).collect();
    assert_eq!(labels, ["complete branch", "approach", "retract"]);
    let at = |curve: &Value, name: &str, point: usize| number(&curve["columns"][name][point]);
    let mut points = 0;
    for (curve, jump) in curves[1..].iter().zip(json["jumps"].as_array().unwrap()) {
        let count = curve["unstable"].as_array().unwrap().len();
        points += count;
        assert_eq!(curve["states"].as_array().unwrap().len(), count);
        let jumps = curve["jumps"].as_array().unwrap();
        assert_eq!(jumps.len(), 1);
        let after = jumps[0].as_u64().unwrap() as usize;
        for (name, point) in [("before", after - 1), ("after", after)] {
            near(&jump[format!("z0_{name}")], at(curve, "z0", point), 1e-6);
            near(&jump[format!("force_{name}")], at(curve, "force", point), 1e-6);
        }
        let kinds = ["stretching", "bending", "film", "gas", "surface"];
        for point in 0..count {
            let sum: f64 = kinds.map(|k| at(curve, &format!("energy_{k}"), point)).iter().sum();
            assert!((sum - at(curve, "energy_total", point)).abs() < 1e-8, "{point}");
        }
    }
    // where the plates turn is on both ways
    assert_eq!(points as u64, json["points"].as_u64().unwrap() + 1);
    let last = curves[1]["unstable"].as_array().unwrap().len() - 1;
    assert_eq!((at(&curves[1], "z0", last), at(&curves[2], "z0", 0)), (0.9, 0.9));
}

#[test]
fn a_cantilever_and_a_dead_load_jump_along_their_lines() {
    let place = tempfile::tempdir().unwrap();
    let (output, json) = cycle(place.path(), "cantilever", &["path.end=0.9"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!((&json["device"], &json["parameter"]), (&"cantilever".into(), &"base".into()));
    near(&json["stiffness"], 20.0, 0.0001);
    let jumps = json["jumps"].as_array().unwrap();
    assert_eq!(jumps.len(), 2);
    for jump in jumps {
        for when in ["before", "after"] {
            let [z0, force] = ["z0", "force"].map(|name| number(&jump[format!("{name}_{when}")]));
            near(&jump["parameter"], z0 - force / 20.0, 1e-9);
        }
    }
    let total = number(&json["dissipated_total"]);
    near(&json["loop_area"], total, 1e-6 * total);
    let out = place.path().join("o");
    assert_eq!(columns(&out.join("cycle.csv")).0[5], "base");
    assert!(columns(&out.join("branch.csv")).0.contains(&"base".to_string()));
    let dead = ["device.kind=dead-load", "path.start=0", "path.end=3"];
    let (output, json) = cycle(place.path(), "fig12", &dead);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(json["parameter"], "force");
    assert_eq!(json["jumps"].as_array().unwrap().len(), 3);
    let total = number(&json["dissipated_total"]);
    near(&json["loop_area"], total, 1e-6 * total);
}

#[test]
fn beyond_the_pull_off_there_is_no_state() {
    let place = tempfile::tempdir().unwrap();
    let sets = ["device.kind=dead-load", "path.start=1", "path.end=-3"];
    let (output, json) = cycle(place.path(), "fig16", &sets);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let away = &json["jumps"][0];
    assert_eq!(away["direction"], "retract");
    for null in ["z0_after", "force_after", "dissipated"] {
        assert!(away[null].is_null(), "{away}");
    }
    assert!(json["dissipated_total"].is_null() && json["loop_area"].is_null());
    assert_eq!(json["closed"], false);
    let back = &json["jumps"][1];
    assert!(back["z0_before"].is_null() && back["z0_after"].is_f64());
}

#[test]
fn without_a_fold_there_is_no_jump_and_the_summary_says_so() {
    let place = tempfile::tempdir().unwrap();
    let (output, json) = cycle(place.path(), "fig07", &["path.end=0.9"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(String::from_utf8_lossy(&output.stdout).starts_with("no jumps"));
    assert_eq!((&json["jumps"], &json["maxwell"]), (&Value::Array(vec![]), &Value::Array(vec![])));
    assert_eq!(json["dissipated_total"].to_string(), "0.0");
    near(&json["loop_area"], 0.0, 1e-9);
}

#[test]
fn a_cycle_cut_short_keeps_what_it_has() {
    let place = tempfile::tempdir().unwrap();
    let (output, json) = cycle(place.path(), "fig16", &["path.max_points=60"]);
    assert_eq!(output.status.code(), Some(3), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(json["stopped_because"], "max-points");
    assert_eq!((json["jumps"].as_array().unwrap().len(), &json["closed"]), (1, &false.into()));
    assert!(json["loop_area"].is_null() && json["points"].as_u64().unwrap() <= 62);
    assert!(place.path().join("o/loop.svg").is_file());
    let coarse = ["path.max_step=0.2", "path.min_step=0.19"];
    let (output, json) = cycle(place.path(), "fig16", &coarse);
    assert_eq!(output.status.code(), Some(3), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(json["stopped_because"], "step-too-small");
}

#[test]
fn a_trace_goes_in_the_device_s_parameter() {
    let place = tempfile::tempdir().unwrap();
    let trace =
        ["trace", "cantilever", "--elements", "100", "--set", "path.end=0.75", "--out", "o"];
    let output = arclen(place.path(), &trace);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let json = read(&place.path().join("o/events.json"));
    assert_eq!(json["parameter"], "base");
    let events = json["events"].as_array().unwrap();
    let folds: Vec<&Value> = events.iter().filter(|event| event["kind"] == "fold").collect();
    assert_eq!(folds.len(), 2);
    near(&folds[0]["base"], 1.155_085_8, 1e-6);
    near(&folds[0]["z0"], 1.132_383_2, 1e-5);
    assert!(folds[0]["deformation"].is_f64() && folds[0]["force"].is_f64());
    assert_eq!((&folds[0]["unstable_before"], &folds[0]["unstable_after"]), (&0.into(), &1.into()));
    near(&json["maxwell"][0]["base"], 1.179_609_1, 1e-6);
    let (names, rows) = columns(&place.path().join("o/branch.csv"));
    let stability = ["unstable_antisymmetric", "unstable_modes", "first_n", "stable"];
    assert_eq!(names[15..17], ["event", "base"]);
    assert_eq!(names[17..21], stability);
    assert_eq!(names[21..], ["elements_per_film_length"]);
    assert_eq!(rows.last().unwrap()[16], "0.75");
    let load = ["device.kind=dead-load", "path.start=0", "path.end=2"];
    let mut trace = vec!["trace", "fig12", "--elements", "100", "--json"];
    trace.extend(load.iter().flat_map(|set| ["--set", set]));
    let output = arclen(place.path(), &trace);
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["parameter"], "force");
    // plain traces have theirs too
    let output = arclen(place.path(), &["trace", "fig16", "--elements", "100", "--json"]);
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    near(&json["maxwell"][0]["z0"], 1.136_885_2, 1e-6);
}

#[test]
fn wrong_devices_are_refused_with_the_right_ones() {
    let place = tempfile::tempdir().unwrap();
    for (command, case, sets, words) in [
        (
            "cycle",
            "fig16",
            &["device.kind=gripp"][..],
            &["device.kind", "(did you mean \"grip\"?)"][..],
        ),
        ("cycle", "fig16", &["device.kind=cantilever"], &["device.stiffness: missing"]),
        ("cycle", "cantilever", &["device.stiffness=0"], &["device.stiffness = 0", "positive"]),
        ("cycle", "cantilever", &["device.stiffness=-3"], &["positive"]),
        ("cycle", "cantilever", &["device.stiffness=soft"], &["expected a number"]),
        ("cycle", "fig16", &["device.kind=grip", "device.stiffness=2"], &["only a cantilever has"]),
        ("cycle", "fig16", &["device.kind=3"], &["expected a string"]),
        ("cycle", "fig16", &["device.knid=grip"], &["device.knid: unknown key", "kind, stiffness"]),
        ("cycle", "fig16", &["device.stiffness=2"], &["device.kind: missing", "dead-load"]),
        ("cycle", "fig16", &["path.start=0.9"], &["greater than 1"]),
        (
            "cycle",
            "fig16",
            &["device.kind=dead-load", "path.start=-3"],
            &["no stable state has force = -3"],
        ),
        ("cycle", "cusp", &[], &["a cycle needs plates"]),
        ("diagram", "cantilever", &[], &["only trace and cycle know devices"]),
    ] {
        let mut all = vec![command, case];
        all.extend(sets.iter().flat_map(|set| ["--set", set]));
        if case != "cusp" {
            all.extend(["--elements", "50"]);
        }
        let output = arclen(place.path(), &all);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{all:?}: {message}");
        for word in words {
            assert!(message.contains(word), "{all:?}: {message}");
        }
    }
    assert!(fs::read_dir(place.path()).unwrap().next().is_none(), "nothing is created");
}
