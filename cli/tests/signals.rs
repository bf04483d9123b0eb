//! A program that is asked to stop, by whatever signal, leaves what it has computed.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

const SIGNALS: [&str; 3] = ["INT", "TERM", "HUP"];

fn start(folder: &Path, arguments: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_arclen"))
        .args(arguments)
        .args(["--out", "o", "--no-pictures"])
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn send(child: &Child, signal: &str) {
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-s", signal, &id]).status().unwrap().success());
}

/// Sends the signal after `wait`; what the run then leaves as `json`, unless it was done before.
fn stopped(arguments: &[&str], signal: &str, wait: Duration, json: &str) -> Option<Value> {
    let place = tempfile::tempdir().unwrap();
    let mut child = start(place.path(), arguments);
    sleep(wait);
    if child.try_wait().unwrap().is_some() {
        return None;
    }
    send(&child, signal);
    // a second one right after the first is the same wish
    send(&child, signal);
    let begun = Instant::now();
    let output = child.wait_with_output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    let said = format!("{arguments:?} {signal}: {message}");
    assert!(begun.elapsed() < Duration::from_secs(60), "{said}");
    let text = fs::read_to_string(place.path().join("o").join(json)).unwrap();
    if output.status.code() == Some(0) {
        // the signal met a run that was done, and that says so
        let json: Value = serde_json::from_str(&text).unwrap();
        assert_ne!(json["stopped_because"], "interrupted", "{said}");
        return None;
    }
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(
        place.path().join("o/case.toml").is_file() || json == "sweep.json" || json == "fits.json",
        "{said}"
    );
    Some(serde_json::from_str(&text).unwrap())
}

/// Long enough to be interrupted, however fast the machine.
const LONG: [&str; 4] = ["--set", "path.max_step=1e-5", "--set", "path.max_points=1000000"];

#[test]
fn a_trace_keeps_its_points() {
    for signal in SIGNALS {
        let run = [&["trace", "fig12", "--elements", "200"][..], &LONG].concat();
        let json = stopped(&run, signal, Duration::from_millis(1200), "events.json").unwrap();
        assert_eq!(json["stopped_because"], "interrupted");
        assert!(json["points"].as_u64().unwrap() > 1, "{signal}");
    }
}

/// Curves that are not fitted yet are listed as stopped, those that are have their folders.
#[test]
fn a_batch_of_fits_keeps_what_was_found() {
    let curve = concat!(env!("CARGO_MANIFEST_DIR"), "/../identify/tests/data/open-1-hard-knee.csv");
    let known = ["--set", "instrument.spring_constant=1.2 N/m", "--law", "hooke"];
    let prior = ["--prior", "radius=1.58 um:50 nm", "--jobs", "1"];
    let run = [&["fit"][..], &[curve; 12], &known, &prior].concat();
    let json = stopped(&run, "INT", Duration::from_millis(4000), "fits.json").unwrap();
    let fits = json["fits"].as_array().unwrap();
    let stopped = fits
        .iter()
        .filter(|fit| fit["error"].as_str().is_some_and(|error| error.contains("stopped")));
    assert!(fits.len() == 12 && stopped.count() >= 1, "{json}");
}

#[test]
fn a_cycle_keeps_its_path() {
    for (signal, wait) in SIGNALS.iter().zip([900, 1500, 2500]) {
        let run = [&["cycle", "fig12", "--elements", "200"][..], &LONG].concat();
        let json = stopped(&run, signal, Duration::from_millis(wait), "cycle.json").unwrap();
        assert_eq!(json["stopped_because"], "interrupted");
        assert!(json["branch_points"].as_u64().unwrap() >= 1, "{signal}");
    }
}

#[test]
fn a_cycle_may_be_stopped_at_any_moment() {
    for k in 0..12 {
        let wait = Duration::from_millis(150 + 130 * k);
        let run = ["cycle", "fig12", "--elements", "200"];
        if let Some(json) = stopped(&run, "TERM", wait, "cycle.json") {
            assert_eq!(json["stopped_because"], "interrupted", "{k}");
        }
    }
}

#[test]
fn a_map_keeps_its_curves() {
    for signal in SIGNALS {
        let run = [
            &["map", "fig12", "--elements", "300", "--over", "adhesion"][..],
            &["--set", "path.max_points=100000", "--set", "path.max_step=1e-3"],
        ]
        .concat();
        let json = stopped(&run, signal, Duration::from_millis(2000), "map.json").unwrap();
        assert_eq!(json["stopped_because"], "interrupted");
    }
}

#[test]
fn a_diagram_goes_on_where_it_was_stopped() {
    let place = tempfile::tempdir().unwrap();
    let run = ["diagram", "mittelmann", "--set", "mesh.elements=20", "-q"];
    for signal in SIGNALS {
        let child = start(place.path(), &run);
        sleep(Duration::from_millis(700));
        send(&child, signal);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(3), "{signal}");
        let text = fs::read_to_string(place.path().join("o/diagram.json")).unwrap();
        let json: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(json["stopped_because"], "interrupted");
        assert!(place.path().join("o/unfinished/case.toml").is_file());
    }
}

#[test]
fn a_sweep_goes_on_where_it_was_stopped() {
    let place = tempfile::tempdir().unwrap();
    fs::write(
        place.path().join("s.toml"),
        "case = \"fig12\"\n[mesh]\nelements = 100\n[[vary]]\nkey = \"dimensionless.adhesion\"\n\
         from = 1e-3\nto = 2e-3\ncount = 400\n",
    )
    .unwrap();
    let mut finished = 0;
    for signal in SIGNALS {
        let child = start(place.path(), &["sweep", "s.toml", "-q"]);
        sleep(Duration::from_millis(2000));
        send(&child, signal);
        let output = child.wait_with_output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(3), "{signal}: {message}");
        let kept = fs::read_dir(place.path().join("o/cases")).unwrap().count();
        assert!(kept >= finished, "{signal}");
        finished = kept;
    }
    assert!(finished > 1);
}
