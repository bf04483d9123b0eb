//! Reports and the live page in a real browser, by `tests/browser`; where there is none, this says so and passes.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(clippy::print_stderr, reason = "a test that does not run says so")]

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};

/// The first program of these names on the path.
fn program(names: &[&str]) -> Option<PathBuf> {
    let path = env::var_os("PATH")?;
    let folders: Vec<PathBuf> = env::split_paths(&path).collect();
    names
        .iter()
        .find_map(|name| folders.iter().map(|folder| folder.join(name)).find(|file| file.is_file()))
}

/// Browser and node, or what is missing.
fn tools(tests: &Path) -> Result<(PathBuf, PathBuf), &'static str> {
    let node = program(&["node"]).ok_or("node")?;
    let browser = program(&["chromium", "chromium-browser", "google-chrome"]);
    let browser = browser.ok_or("Chromium")?;
    if !tests.join("node_modules/playwright-core").is_dir() {
        return Err("playwright-core: run \"npm ci\" in tests/browser");
    }
    Ok((node, browser))
}

#[test]
fn a_report_is_written_where_it_is_asked_for() {
    let place = tempfile::tempdir().unwrap();
    let arclen = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_arclen"));
        let status = command.args(arguments).args(["-q", "--no-pictures"]).current_dir(&place);
        assert!(status.status().unwrap().success(), "{arguments:?}");
    };
    arclen(&["trace", "cusp", "--out", "without"]);
    assert!(!place.path().join("without/report.html").exists());
    arclen(&["trace", "fig06", "--elements", "40", "--report", "--out", "trace"]);
    arclen(&["diagram", "cusp", "--report", "--out", "diagram"]);
    let ring = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases/ring-load.toml");
    let ring = ["trace", ring.to_str().unwrap(), "--elements", "80", "--set", "path.end=10"];
    arclen(&[&ring[..], &["--report", "--out", "ring"]].concat());
    let page = fs::read_to_string(place.path().join("ring/report.html")).unwrap();
    assert!(
        page.contains("\"bounds\":\"planes of the rings\"") && page.contains("\"pressure\":[]")
    );
    assert!(page.contains("\"flags\":{\"admissible\":[false,"));
    for (folder, states) in [("trace", true), ("diagram", false), ("ring", true)] {
        let page = fs::read_to_string(place.path().join(folder).join("report.html")).unwrap();
        assert!(page.starts_with("<!DOCTYPE html>"));
        assert_eq!(page.contains("\"sigma\":["), states, "{folder}");
    }
}

#[test]
fn reports_work_in_a_browser() {
    in_a_browser("report.test.js");
}

#[test]
fn the_live_page_works_in_a_browser() {
    in_a_browser("explore.test.js");
}

/// One browser at a time: tests measure how fast pages are.
static TURN: Mutex<()> = Mutex::new(());

/// Runs a file of tests; where there is no browser, says so.
fn in_a_browser(file: &str) {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/browser");
    let (node, browser) = match tools(&tests) {
        Ok(tools) => tools,
        Err(missing) => {
            assert!(env::var_os("ARCLEN_NEEDS_BROWSER").is_none(), "{missing} is missing");
            eprintln!("not run, for lack of {missing}");
            return;
        }
    };
    let output = Command::new(node)
        .args(["--test", file])
        .current_dir(&tests)
        .env("ARCLEN", env!("CARGO_BIN_EXE_arclen"))
        .env("BROWSER", browser)
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{text}\n{}", String::from_utf8_lossy(&output.stderr));
    eprintln!("{text}");
}
