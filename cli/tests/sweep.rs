//! Sweeps as scripts and clusters see them: tables, resumption, shards, exit codes.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

/// Twenty cases, some of which have folds.
const SWEEP: &str = r#"case = "base.toml"
mesh.elements = 60
[[vary]]
key = "dimensionless.adhesion"
from = 1e-5
to = 4e-3
count = 5
scale = "log"
[[vary]]
key = "dimensionless.pressure"
values = [1e-3, 1e-2, 0.1, 1]
"#;

const BASE: &str = r#"problem = "contact"
[shell]
law = "hooke"
[dimensionless]
bending = 1e-4
pressure = 3e-3
adhesion = 2e-3
film = 0.03
[path]
start = 1.25
end = 0.8
"#;

const FILES: [&str; 4] = ["curves.csv", "events.csv", "phase.csv", "phase.svg"];

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_arclen"));
    command.args(arguments).current_dir(folder).stdin(Stdio::null());
    command
}

fn arclen(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A folder with a sweep and its base.
fn place(sweep: &str) -> tempfile::TempDir {
    let place = tempfile::tempdir().unwrap();
    fs::create_dir(place.path().join("in")).unwrap();
    fs::write(place.path().join("in/sweep.toml"), sweep).unwrap();
    fs::write(place.path().join("in/base.toml"), BASE).unwrap();
    place
}

/// Runs that must succeed.
#[track_caller]
fn succeeds(folder: &Path, arguments: &[&str]) {
    let output = arclen(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
}

fn json(folder: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.join("sweep.json")).unwrap()).unwrap()
}

/// `sweep.json` without times.
fn timeless(folder: &Path) -> Value {
    let mut json = json(folder);
    json["seconds"] = Value::Null;
    for case in json["cases"].as_array_mut().unwrap() {
        assert!(case["seconds"].as_f64().unwrap() >= 0.0);
        case["seconds"] = Value::Null;
    }
    json
}

/// The results in two folders are equal to the last bit, times excepted.
#[track_caller]
fn equal(one: &Path, other: &Path) {
    for file in FILES {
        let same = fs::read(one.join(file)).unwrap() == fs::read(other.join(file)).unwrap();
        assert!(same, "{file} differs");
    }
    assert_eq!(timeless(one), timeless(other));
}

#[test]
fn results_do_not_depend_on_the_number_of_threads_nor_on_shards() {
    let place = place(SWEEP);
    let at = |name: &str| place.path().join(name);
    succeeds(place.path(), &["sweep", "in/sweep.toml", "--jobs", "1", "--out", "one"]);
    succeeds(place.path(), &["sweep", "in/sweep.toml", "--jobs", "3", "--out", "three", "-q"]);
    equal(&at("one"), &at("three"));

    let json = json(&at("one"));
    let cases = json["cases"].as_array().unwrap();
    assert_eq!((cases.len(), &json["stopped_because"]), (20, &Value::from("complete")));
    assert_eq!(cases[6]["values"]["dimensionless.pressure"], 0.1);
    assert_eq!(cases[6]["status"], "finished");
    let classes: Vec<_> = cases.iter().filter_map(|case| case["class"].as_str()).collect();
    assert!(classes.contains(&"buckles") && classes.contains(&"bypasses-buckling"), "{classes:?}");
    let points: u64 = cases.iter().filter_map(|case| case["points"].as_u64()).sum();
    let curves = fs::read_to_string(at("one/curves.csv")).unwrap();
    assert_eq!(curves.lines().count() as u64, 1 + points);
    let header = "case,dimensionless.adhesion,dimensionless.pressure,point,z0,deformation,force,";
    assert!(curves.starts_with(header), "{}", curves.lines().next().unwrap());
    assert!(curves.lines().nth(1).unwrap().starts_with("0,0.00001,0.001,0,1.25,"));
    let events = fs::read_to_string(at("one/events.csv")).unwrap();
    let special: u64 = cases.iter().filter_map(|case| case["special_points"].as_u64()).sum();
    assert_eq!(events.lines().count() as u64, 1 + special);
    assert!(
        events.starts_with("case,dimensionless.adhesion,dimensionless.pressure,kind,z0,force,")
    );

    for shard in ["1/3", "2/3", "3/3"] {
        succeeds(place.path(), &["sweep", "in/sweep.toml", "--shard", shard, "-q"]);
    }
    let folder = |k: usize| format!("arclen-out/sweep-{k}-of-3");
    let output = arclen(place.path(), &["merge", &folder(3), &folder(1), "--out", "part"]);
    assert_eq!(output.status.code(), Some(3), "a shard is missing");
    assert_eq!(self::json(&at("part"))["waiting"], 7);
    let all = ["merge", &folder(3), &folder(1), &folder(2), &folder(1), "--out", "merged"];
    succeeds(place.path(), &all);
    equal(&at("one"), &at("merged"));
    let output = arclen(place.path(), &["merge", "in", "--out", "m"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("in: no results of a sweep"));
    assert!(!at("m").exists());
}

#[test]
fn a_sweep_that_is_killed_goes_on_and_loses_no_finished_case() {
    let place = place(SWEEP);
    let at = |name: &str| place.path().join(name);
    let whole = ["sweep", "in/sweep.toml", "-q", "--out", "whole"];
    succeeds(place.path(), &whole);
    let kept = || -> Vec<(String, Vec<u8>)> {
        let entries = fs::read_dir(at("killed/cases")).into_iter().flatten().flatten();
        let names = entries.map(|entry| entry.file_name().into_string().unwrap());
        let mut names: Vec<_> = names.filter(|name| name.starts_with("case-")).collect();
        names.sort();
        names.iter().map(|n| (n.clone(), fs::read(at("killed/cases").join(n)).unwrap())).collect()
    };
    let mut before = kept();
    let mut interruptions = 0;
    for round in 0..10 {
        let arguments = ["sweep", "in/sweep.toml", "-q", "--out", "killed", "--jobs", "2"];
        let mut child = command(place.path(), &arguments).spawn().unwrap();
        // after the next case at the earliest, at a moment that differs from round to round
        while kept().len() == before.len() && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_millis(7 * round % 20));
        child.kill().unwrap();
        interruptions += usize::from(!child.wait().unwrap().success());
        let after = kept();
        for case in &before {
            assert!(after.contains(case), "{} was lost or computed again", case.0);
        }
        before = after;
    }
    assert!(interruptions > 3, "killed {interruptions} times only");
    succeeds(place.path(), &["sweep", "in/sweep.toml", "--out", "killed"]);
    equal(&at("whole"), &at("killed"));
    let left = fs::read_dir(at("killed/cases")).unwrap().flatten();
    assert!(!left.into_iter().any(|e| e.file_name().to_string_lossy().starts_with(".arclen")));
}

#[test]
fn a_changed_sweep_is_refused_unless_it_begins_anew() {
    let place = place(SWEEP);
    let run = ["sweep", "in/sweep.toml", "-q", "--out", "o", "--no-pictures"];
    fs::write(place.path().join("in/sweep.toml"), SWEEP.replace("count = 5", "count = 2")).unwrap();
    succeeds(place.path(), &run);
    let before = fs::read(place.path().join("o/curves.csv")).unwrap();
    // a sweep that is done has nothing left to do
    succeeds(place.path(), &run);
    assert_eq!(fs::read(place.path().join("o/curves.csv")).unwrap(), before);
    for (from, to, said) in [("4e-3", "3e-3", "here: 0.003"), ("= 60", "= 61", "elements = 61")] {
        let changed = SWEEP.replace("count = 5", "count = 2").replace(from, to);
        fs::write(place.path().join("in/sweep.toml"), changed).unwrap();
        let output = arclen(place.path(), &run);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        for part in ["o/cases: holds the cases of another sweep", "--restart", "there: ", said] {
            assert!(message.contains(part), "{part}: {message}");
        }
        assert_eq!(fs::read(place.path().join("o/curves.csv")).unwrap(), before);
    }
    succeeds(place.path(), &[&run[..], &["--restart"]].concat());
    assert_ne!(fs::read(place.path().join("o/curves.csv")).unwrap(), before);
}

#[test]
fn a_case_that_fails_is_recorded_and_the_others_go_on() {
    // an adhesion that is none, one that leaves no first point, one that is good
    let sweep = "case = \"base.toml\"\nmesh.elements = 60\n[[vary]]\n\
                 key = \"dimensionless.adhesion\"\nvalues = [-1, 1e6, 1e-4]\n";
    let place = place(sweep);
    let output = arclen(place.path(), &["sweep", "in/sweep.toml", "--out", "o"]);
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    let json = json(&place.path().join("o"));
    let field = |case: usize, name: &str| json["cases"][case][name].clone();
    assert_eq!([field(0, "status"), field(1, "status")], ["failed", "failed"]);
    assert!(field(0, "reason").as_str().unwrap().contains("line 4: dimensionless.adhesion = -1"));
    assert!(field(1, "reason").as_str().unwrap().contains("path.start = 1.25"));
    assert_eq!(
        (field(2, "status"), field(2, "stopped_because")),
        ("finished".into(), "target".into())
    );
    assert_eq!((&json["failed"], &json["finished"]), (&2.into(), &1.into()));
    let summary = text(&output.stdout);
    assert!(summary.contains("case 0: failed") && summary.contains("1 of 3 cases finished"));
    let curves = fs::read_to_string(place.path().join("o/curves.csv")).unwrap();
    assert!(curves.lines().skip(1).all(|line| line.starts_with("2,0.0001,")));
}

#[test]
fn problems_of_the_catalogue_can_be_swept() {
    let sweep = "case = \"cusp\"\n[[vary]]\nkey = \"parameters.lambda\"\nvalues = [1, 2]\n";
    let place = place(sweep);
    let output = arclen(place.path(), &["sweep", "in/sweep.toml", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["cases"][1]["values"]["parameters.lambda"], 2);
    assert!(!place.path().join("arclen-out").exists(), "--json alone writes no files");
    succeeds(place.path(), &["sweep", "in/sweep.toml"]);
    let out = place.path().join("arclen-out/sweep");
    let events = fs::read_to_string(out.join("events.csv")).unwrap();
    assert!(events.lines().any(|line| line.starts_with("1,2,fold,")), "{events}");
    assert!(!out.join("phase.csv").exists());
}

#[test]
fn a_sweep_counts_waves_where_it_is_asked_to_and_says_what_it_counted() {
    let vary = "[[vary]]\nkey = \"dimensionless.adhesion\"\nvalues = [2e-6, 2e-3]\n";
    let text_of = |scan: &str| format!("case = \"fig12\"\nmesh.elements = 60\n{scan}{vary}");
    let place = place(&text_of(""));
    fs::write(place.path().join("in/full.toml"), text_of("stability.scan = \"full\"\n")).unwrap();
    let run = |file: &str| {
        let output = arclen(place.path(), &["sweep", &format!("in/{file}.toml"), "--out", file]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let at = place.path().join(file);
        let read = |name: &str| fs::read_to_string(at.join(name)).unwrap();
        (text(&output.stdout), json(&at), read("curves.csv"), read("events.csv"))
    };
    let (own_summary, own, own_curves, own_events) = run("sweep");
    let (full_summary, full, full_curves, full_events) = run("full");
    assert!(own_summary.contains("stability: against axisymmetric mirror images only"));
    assert!(full_summary.contains("stability: with and without symmetry"), "{full_summary}");
    assert!(full_summary.contains("with waves around the axis in 1 case, without in 1"));
    for case in 0..2 {
        assert_eq!(own["cases"][case]["stability"]["scan"], "axisymmetric");
        assert!(own["cases"][case].get("first_loss").is_none());
        assert_eq!(full["cases"][case]["stability"]["scan"], "full");
        // what is counted beside the branch does not change what it is
        assert_eq!(own["cases"][case]["class"], full["cases"][case]["class"]);
    }
    // four waves first with a weak film; with a strong one the mirror image goes first, at the fold
    let loss = |case: usize, name: &str| full["cases"][case]["first_loss"][name].clone();
    assert_eq!(
        (loss(0, "n"), loss(1, "n"), loss(1, "parity")),
        (4.into(), 0.into(), "antisymmetric".into())
    );
    assert!((loss(0, "z0").as_f64().unwrap() - 0.78323).abs() < 1e-4);
    let columns = "unstable_antisymmetric,unstable_modes,first_n,stable";
    assert!(full_curves.lines().next().unwrap().contains(columns));
    assert!(!own_curves.contains(columns) && !own_events.contains("symmetry-breaking"));
    let header = full_events.lines().next().unwrap();
    assert!(header.ends_with("n,parity,modes_before,modes_after"), "{header}");
    let waves = full_events.lines().filter(|line| line.ends_with(",2,symmetric,0,1"));
    assert_eq!(waves.count(), 1, "{full_events}");
}

#[test]
fn input_errors_exit_with_2_and_create_nothing() {
    let place = place(&SWEEP.replace("values", "vlaues"));
    for (arguments, part) in [
        (&["sweep", "in/sweep.toml"][..], "did you mean \"values\""),
        (&["sweep", "gone.toml"], "gone.toml: no such file"),
        (&["sweep", "in/sweep.toml", "--shard", "3/2"], "k/n"),
        (&["sweep", "in/sweep.toml", "--jobs", "0"], "--jobs"),
        (&["merge"], "DIR"),
        (&["merge", "gone"], "gone: no results of a sweep"),
    ] {
        let output = arclen(place.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(text(&output.stderr).contains(part), "{arguments:?}: {}", text(&output.stderr));
        assert_eq!(fs::read_dir(place.path()).unwrap().count(), 1, "{arguments:?}");
    }
}
