//! Diagrams as scripts see them, and as a machine that is switched off leaves them.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

fn arclen(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_arclen")).args(arguments).current_dir(folder).output().unwrap()
}

/// `diagram.json` without the time it took.
fn diagram(folder: &Path) -> Value {
    let text = fs::read_to_string(folder.join("diagram.json")).unwrap();
    let mut json: Value = serde_json::from_str(&text).unwrap();
    assert!(json["seconds"].as_f64().unwrap() >= 0.0);
    json["seconds"] = Value::Null;
    json
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn two_enzymes_and_the_branch_that_breaks_their_symmetry() {
    let place = tempfile::tempdir().unwrap();
    let output = arclen(place.path(), &["diagram", "enz"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let out = place.path().join("arclen-out/enz");
    let files = ["branch-0.csv", "branch-1.csv", "case.toml", "diagram.json", "diagram.svg"];
    assert_eq!(names(&out), files);
    let json = diagram(&out);
    assert_eq!(json["stopped_because"], "complete");
    let branches = json["branches"].as_array().unwrap();
    assert_eq!(branches.len(), 2);
    assert_eq!(branches[0]["from"], Value::Null);
    assert_eq!(branches[1]["from"]["branch"], 0);
    assert_eq!(branches[1]["stopped_because"], "closed-loop");
    let events = |branch: usize, kind: &str| -> Vec<f64> {
        let all = branches[branch]["events"].as_array().unwrap();
        let mut values: Vec<f64> =
            all.iter().filter(|e| e["kind"] == kind).map(|e| e["p"].as_f64().unwrap()).collect();
        values.sort_by(f64::total_cmp);
        values.dedup_by(|a, b| (*a - *b).abs() < 1e-8);
        values
    };
    let near = |found: Vec<f64>, known: &[f64]| {
        assert_eq!(found.len(), known.len(), "{found:?}");
        for (found, known) in found.iter().zip(known) {
            assert!((found - known).abs() < 1e-9 * known, "{found} {known}");
        }
    };
    near(events(0, "fold"), &[18.887_067_657_924, 34.356_924_998_526]);
    near(events(0, "branch-point"), &[22.181_637_926_124, 34.222_886_544_190]);
    near(events(1, "fold"), &[25.372_714_838_124, 26.622_071_770_045]);
    near(events(1, "branch-point"), &[22.181_637_926_124, 34.222_886_544_190]);
    let pitchforks = branches[1]["events"].as_array().unwrap();
    let pitchforks = pitchforks.iter().filter(|e| e["kind"] == "branch-point");
    assert!(pitchforks.map(|e| &e["type"]).all(|t| t == "pitchfork"));
    // every joint knows both branches
    let joints = json["joints"].as_array().unwrap();
    assert_eq!(joints.len(), 2);
    assert!(joints.iter().all(|j| j["passed"].as_array().unwrap().len() == 2 && j["open"] == 0));
}

#[test]
fn predator_and_prey_complete() {
    let place = tempfile::tempdir().unwrap();
    let output = arclen(place.path(), &["diagram", "pp2", "--json", "--quiet"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(names(place.path()).is_empty());
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let mut found = Vec::new();
    for branch in json["branches"].as_array().unwrap() {
        for event in branch["events"].as_array().unwrap() {
            found.push((event["kind"].as_str().unwrap(), event["p"].as_f64().unwrap()));
        }
    }
    let known = [
        ("branch-point", 0.6),
        ("branch-point", 0.821_904_345_374),
        ("fold", 0.832_929_322_234),
        ("hopf", 0.671_593_847_479),
    ];
    assert_eq!(found.len(), known.len(), "{found:?}");
    for (kind, value) in known {
        let near = |p: f64| (p - value).abs() < 1e-10;
        assert!(found.iter().any(|(k, p)| *k == kind && near(*p)), "{kind} {value}: {found:?}");
    }
}

#[test]
fn killed_ten_times_it_is_the_same_diagram() {
    let place = tempfile::tempdir().unwrap();
    let run = ["diagram", "mittelmann", "--set", "mesh.elements=20", "--quiet", "--no-pictures"];
    let begun = Instant::now();
    let whole = arclen(place.path(), &[&run[..], &["--out", "whole"]].concat());
    assert_eq!(whole.status.code(), Some(0), "{}", String::from_utf8_lossy(&whole.stderr));
    let took = begun.elapsed();
    let arguments = [&run[..], &["--out", "part"]].concat();
    let mut kills = 0;
    for life in 0..200 {
        let mut child = Command::new(env!("CARGO_BIN_EXE_arclen"))
            .args(&arguments)
            .current_dir(place.path())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        // moments that have nothing to do with what is computed
        let part = 0.02 + 0.1 * (0.618_034 * f64::from(life)).fract();
        if kills < 10 {
            sleep(took.mul_f64(part).max(Duration::from_millis(5)));
            kills += i32::from(child.try_wait().unwrap().is_none());
            child.kill().unwrap();
        }
        if child.wait().unwrap().success() {
            break;
        }
    }
    assert_eq!(kills, 10);
    let (whole, part) = (place.path().join("whole"), place.path().join("part"));
    assert!(diagram(&whole)["branches"].as_array().unwrap().len() >= 10);
    assert!(diagram(&whole) == diagram(&part));
    assert_eq!(names(&whole), names(&part));
    for name in names(&whole).iter().filter(|name| name.ends_with(".csv")) {
        assert!(
            fs::read(whole.join(name)).unwrap() == fs::read(part.join(name)).unwrap(),
            "{name}"
        );
    }
}

#[test]
fn an_unfinished_diagram_of_another_case_is_left_alone() {
    let place = tempfile::tempdir().unwrap();
    let kept = place.path().join("out/unfinished");
    fs::create_dir_all(&kept).unwrap();
    fs::write(kept.join("case.toml"), "# arclen 0.0.0\nname = \"other\"\n").unwrap();
    let output = arclen(place.path(), &["diagram", "pp2", "--out", "out", "--quiet"]);
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("another case") && message.contains("--restart"), "{message}");
    assert_eq!(names(&place.path().join("out")), ["unfinished"]);
    let output = arclen(place.path(), &["diagram", "pp2", "--out", "out", "--quiet", "--restart"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(!kept.exists());
}

#[test]
fn bad_input_creates_nothing_and_names_the_key() {
    for (set, words) in [
        ("diagram.depth=-1", ["diagram.depth", "from 0 to 100"]),
        ("diagram.max_branches=0", ["diagram.max_branches", "from 1"]),
        ("diagram.search=all", ["diagram.search", "near-bifurcations"]),
        ("diagram.from=0.5", ["diagram.to", "missing"]),
        ("diagram.deep=1", ["diagram.deep", "depth"]),
    ] {
        let place = tempfile::tempdir().unwrap();
        let output = arclen(place.path(), &["diagram", "pp2", "--set", set]);
        assert_eq!(output.status.code(), Some(2), "{set}");
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(words.iter().all(|word| message.contains(word)), "{set}: {message}");
        assert!(names(place.path()).is_empty(), "{set}");
    }
}

#[test]
fn limits_stop_early_and_say_so() {
    let place = tempfile::tempdir().unwrap();
    let limited = ["diagram", "swift-hohenberg", "--set", "diagram.max_branches=4", "--out", "o"];
    let output = arclen(place.path(), &limited);
    assert_eq!(output.status.code(), Some(3));
    let json = diagram(&place.path().join("o"));
    assert_eq!(json["stopped_because"], "max-branches");
    assert_eq!(json["branches"].as_array().unwrap().len(), 4);
    // fewer branches than before: none of the old files stays
    let output = arclen(place.path(), &["diagram", "pp2", "--depth", "0", "--out", "o", "--quiet"]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(
        names(&place.path().join("o")),
        ["branch-0.csv", "case.toml", "diagram.json", "diagram.svg"]
    );
}
