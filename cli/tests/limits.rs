//! Values that make no sense are refused at once, with their key and what is allowed.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

fn arclen(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_arclen")).args(arguments).current_dir(folder).output().unwrap()
}

#[track_caller]
fn refused(arguments: &[&str], parts: &[&str]) {
    let place = tempfile::tempdir().unwrap();
    let begun = Instant::now();
    let output = arclen(place.path(), arguments);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    for part in parts {
        assert!(message.contains(part), "{arguments:?}: {part} is missing in: {message}");
    }
    assert!(begun.elapsed() < Duration::from_secs(10), "{arguments:?}");
    assert_eq!(fs::read_dir(place.path()).unwrap().count(), 0, "{arguments:?}");
}

#[test]
fn steps_that_are_lost_in_rounding_are_refused() {
    let key = "path.max_step";
    for step in ["5e-324", "1e-320", "1e-300", "1e-20"] {
        for case in ["fig12", "enz", "ring-load"] {
            let set = format!("{key}={step}");
            refused(&["trace", case, "--set", &set], &[key, step, "at least"]);
            refused(&["diagram", case, "--set", &set], &[key, step, "at least"]);
        }
    }
    refused(&["cycle", "fig12", "--set", "path.max_step=5e-324"], &["path.max_step", "at least"]);
}

#[test]
fn ranges_of_a_map_span_a_sensible_number_of_decades() {
    for case in [["fig12", "adhesion"], ["co-oxidation", "k"], ["ring-load", "bending"]] {
        for from in ["1e-320", "5e-324", "1e-200"] {
            let set = format!("map.from={from}");
            let map = ["map", case[0], "--over", case[1], "--set", &set];
            refused(&map, &["map.from", "at least"]);
        }
    }
}

#[test]
fn threads_are_limited() {
    for jobs in ["0", "-1", "1025", "100000", "18446744073709551615", "many"] {
        refused(&["sweep", "phase", &format!("--jobs={jobs}")], &["--jobs", jobs]);
    }
    refused(&["sweep", "phase", "--jobs", "1025"], &["1..=1024"]);
}

#[test]
fn names_too_long_for_a_folder_fail_before_the_computation() {
    let place = tempfile::tempdir().unwrap();
    let long = "n".repeat(300);
    let case = |name: &str| format!("name = \"{name}\"\nproblem = \"enz\"\n");
    let vary = "[[vary]]\nkey = \"path.max_points\"\nvalues = [5]\n";
    for name in [long.as_str(), &"ü".repeat(130)] {
        fs::write(place.path().join("c.toml"), case(name)).unwrap();
        fs::write(place.path().join("s.toml"), case(name) + vary).unwrap();
        for arguments in [["trace", "c.toml"], ["diagram", "c.toml"], ["sweep", "s.toml"]] {
            let output = arclen(place.path(), &arguments);
            let message = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(2), "{message}");
            assert!(message.contains("name = ") && message.contains("200 bytes"), "{message}");
        }
        assert_eq!(fs::read_dir(place.path()).unwrap().count(), 2);
    }
    for out in [long.clone(), format!("new/{long}"), format!("{long}/new")] {
        refused(&["trace", "enz", "--out", &out], &["--out", "300 bytes", "255"]);
    }
    // a name of a sensible length is none of that
    fs::write(place.path().join("c.toml"), case(&"n".repeat(200))).unwrap();
    let output = arclen(place.path(), &["trace", "c.toml", "-q", "--no-pictures"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}
