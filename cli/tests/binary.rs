//! The program as people and scripts meet it: exit codes, what is created, what is printed.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

const GOOD: &str = "problem = \"contact\"\n[shell]\nlaw = \"hooke\"\n[dimensionless]\nbending = 3e-5\n\
                    pressure = 3e-3\nadhesion = 2e-3\nfilm = 0.05\n[path]\nstart = 1.2\nend = 0.9\n";

fn arclen(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_arclen"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A folder that holds a good and a bad case, and the names of all it should hold.
fn place() -> tempfile::TempDir {
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("good.toml"), GOOD).unwrap();
    fs::write(place.path().join("bad.toml"), GOOD.replace("3e-5", "-1")).unwrap();
    place
}

/// Runs that must fail as input errors, create nothing and say `parts`.
#[track_caller]
fn refused(arguments: &[&str], parts: &[&str]) {
    let place = place();
    let output = arclen(place.path(), arguments);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    for part in parts {
        assert!(message.contains(part), "{arguments:?}: \"{part}\" is missing in:\n{message}");
    }
    assert!(!message.contains("panicked"), "{message}");
    assert_eq!(text(&output.stdout), "");
    let mut names: Vec<_> =
        fs::read_dir(place.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["bad.toml", "good.toml"], "{arguments:?} created something");
}

#[test]
fn input_errors_exit_with_2_and_create_nothing() {
    refused(
        &["trace", "bad.toml"],
        &["bad.toml, line 5: dimensionless.bending = -1: must be positive"],
    );
    refused(&["trace", "bad.toml", "--out", "results"], &["bad.toml, line 5"]);
    refused(&["trace", "gone.toml", "--out", "results"], &["gone.toml: no such file"]);
    refused(&["trace", ".", "--out", "results"], &["this is a folder"]);
    refused(&["trace", "nothing-like-it"], &["neither a case file nor a known name", "fig12"]);
    refused(&["trace", "fig21"], &["did you mean"]);
    refused(&["trace", "fig12", "--elements", "7"], &["--elements: mesh.elements = 7", "from 8"]);
    refused(&["trace", "fig12", "--elements", "-7"], &["--elements: mesh.elements = -7"]);
    refused(&["trace", "fig12", "--elements", "many"], &["--elements", "expected an integer"]);
    refused(&["trace", "fig12", "--set", "path.start=0.9"], &["--set: path.start = 0.9"]);
    refused(&["trace", "fig12", "--set", "nonsense"], &["expected KEY=VALUE"]);
    refused(&["trace", "fig12", "--out", "good.toml/deep"], &["good.toml is not a folder"]);
    refused(&["trace", "fig12", "--out", ""], &["--out"]);
    refused(&["check", "bad.toml"], &["bad.toml, line 5"]);
}

#[test]
fn usage_errors_exit_with_2() {
    refused(&[], &["Usage"]);
    refused(&["trace"], &["Usage", "CASE.toml|NAME"]);
    refused(&["trace", "good.toml", "--bogus"], &["--bogus"]);
    refused(&["dance"], &["dance"]);
    refused(&["completions", "no-shell"], &["no-shell"]);
}

#[test]
fn help_and_version_exit_with_0() {
    let place = place();
    let version = arclen(place.path(), &["--version"]);
    assert_eq!(version.status.code(), Some(0));
    assert_eq!(text(&version.stdout), format!("arclen {}\n", env!("CARGO_PKG_VERSION")));
    for arguments in [&["--help"][..], &["trace", "--help"], &["list"], &["completions", "bash"]] {
        let output = arclen(place.path(), arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        assert!(output.stdout.len() > 100 && output.stderr.is_empty(), "{arguments:?}");
    }
}

#[test]
fn check_prints_a_case_that_checks() {
    let place = place();
    let shipped =
        ["fig06", "fig07", "fig12", "fig16", "cantilever", "polymer", "dlvo", "two-plates"];
    for case in shipped.into_iter().chain(["good.toml", "ring-load"]) {
        let output = arclen(place.path(), &["check", case, "--set", "path.max_points=77"]);
        assert_eq!(output.status.code(), Some(0), "{case}: {}", text(&output.stderr));
        assert!(text(&output.stdout).contains("max_points = 77"), "{case}");
        fs::write(place.path().join("again.toml"), &output.stdout).unwrap();
        let again = arclen(place.path(), &["check", "again.toml"]);
        assert_eq!(text(&again.stdout), text(&output.stdout));
    }
}

#[test]
fn list_names_the_shipped_cases() {
    let output = arclen(place().path(), &["list"]);
    let names = ["fig06", "fig07", "fig12", "fig16", "cantilever", "polymer", "dlvo", "two-plates"];
    for name in names.into_iter().chain(["ring-load", "phase"]) {
        assert!(text(&output.stdout).contains(&format!("\n  {name} ")), "{name}");
    }
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_arclen"))
        .args(["completions", "zsh"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert_eq!(text(&output.stderr), "");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_behind_standard_output_is_a_failure() {
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_arclen"))
        .arg("list")
        .stdout(full)
        .stderr(Stdio::piped())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("standard output: cannot be written"));
}
