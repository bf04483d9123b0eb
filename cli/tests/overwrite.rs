//! What is read is never written over, by whatever way it is reached.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const CASE: &str =
    "# mine, with notes\nproblem = \"enz\"\n[path]\nmax_points = 10\n[diagram]\nmax_branches = 1\n";
const SWEEP: &str = "problem = \"enz\"\n[path]\nmax_points = 10\n[[vary]]\nkey = \"path.max_points\"\n\
                     values = [5, 6]\n";

fn arclen(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_arclen")).args(arguments).current_dir(folder).output().unwrap()
}

/// Runs that must be refused before anything is written; `kept` is read, and stays.
#[track_caller]
fn refused(folder: &Path, arguments: &[&str], kept: &str) {
    let list = || {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };
    let (before, names) = (fs::read(folder.join(kept)).unwrap(), list());
    let output = arclen(folder, arguments);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    for part in ["--out", "overwrite", "another folder"] {
        assert!(message.contains(part), "{arguments:?}: {part} is missing in: {message}");
    }
    assert!(fs::read(folder.join(kept)).unwrap() == before, "{arguments:?}");
    assert_eq!(list(), names, "{arguments:?}");
}

#[test]
fn no_command_writes_over_its_case() {
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("case.toml"), CASE).unwrap();
    for command in ["trace", "diagram", "cycle"] {
        refused(place.path(), &[command, "case.toml", "--out", "."], "case.toml");
    }
    refused(place.path(), &["map", "case.toml", "--over", "k", "--out", "."], "case.toml");
    refused(place.path(), &["trace", "case.toml", "--out", ".", "--report", "-q"], "case.toml");
    refused(place.path(), &["trace", "./case.toml", "--out", "./.", "--json"], "case.toml");
    // another name, or another folder, is no trouble
    fs::write(place.path().join("other.toml"), CASE).unwrap();
    fs::remove_file(place.path().join("case.toml")).unwrap();
    let done = arclen(place.path(), &["trace", "other.toml", "--out", ".", "-q"]);
    assert_eq!(done.status.code(), Some(3), "{}", String::from_utf8_lossy(&done.stderr));
    assert_eq!(fs::read_to_string(place.path().join("other.toml")).unwrap(), CASE);
}

#[test]
fn no_other_file_is_written_over_either() {
    let place = tempfile::tempdir().unwrap();
    for (name, arguments) in [
        ("events.json", &["trace", "events.json"][..]),
        ("branch.csv", &["trace", "branch.csv"]),
        ("branch-3.csv", &["diagram", "branch-3.csv"]),
        ("report.html", &["diagram", "report.html"]),
        ("fold-0.csv", &["map", "fold-0.csv", "--over", "k"]),
        ("cycle.csv", &["cycle", "cycle.csv"]),
    ] {
        fs::write(place.path().join(name), CASE).unwrap();
        refused(place.path(), &[arguments, &["--out", "."]].concat(), name);
    }
    fs::write(place.path().join("sweep.json"), SWEEP).unwrap();
    refused(place.path(), &["sweep", "sweep.json", "--out", "."], "sweep.json");
    fs::write(place.path().join("curves.csv"), CASE).unwrap();
    fs::write(
        place.path().join("s.toml"),
        "case = \"./curves.csv\"\n[[vary]]\nkey = \"path.max_points\"\nvalues = [5, 6]\n",
    )
    .unwrap();
    refused(place.path(), &["sweep", "s.toml", "--out", "."], "curves.csv");
    let kept = place.path().join("o/unfinished");
    fs::create_dir_all(&kept).unwrap();
    fs::write(kept.join("case.toml"), CASE).unwrap();
    let inside = ["diagram", "o/unfinished/case.toml", "--out", "o", "--restart"];
    refused(place.path(), &inside, "o/unfinished/case.toml");
}

#[cfg(unix)]
#[test]
fn links_and_other_ways_to_a_file_lead_to_it() {
    use std::os::unix::fs::symlink;
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    fs::create_dir_all(at("deep/er")).unwrap();
    fs::write(at("deep/case.toml"), CASE).unwrap();
    symlink("deep/case.toml", at("link.toml")).unwrap();
    symlink("deep", at("folder")).unwrap();
    fs::create_dir(at("hard")).unwrap();
    fs::hard_link(at("deep/case.toml"), at("hard/case.toml")).unwrap();
    fs::create_dir(at("soft")).unwrap();
    symlink("../deep/case.toml", at("soft/case.toml")).unwrap();
    let absolute = at("deep").display().to_string();
    for (input, out) in [
        ("link.toml", "deep"),
        ("deep/case.toml", "folder"),
        ("folder/case.toml", "deep"),
        ("deep/er/../case.toml", "./deep/er/.."),
        ("deep/case.toml", &absolute),
        ("deep/case.toml", "hard"),
        ("deep/case.toml", "soft"),
        ("soft/case.toml", "deep"),
    ] {
        refused(place.path(), &["trace", input, "--out", out], "deep/case.toml");
    }
}
