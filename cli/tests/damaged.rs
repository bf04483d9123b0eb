//! What a disk, a person or a kill does to the files that are kept changes no result.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod support;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};
use support::{Random, arclen, command, copy, equal, files, names, stderr};

const SWEEP: &str = "problem = \"enz\"\n[[vary]]\nkey = \"path.max_step\"\nfrom = 0.5\nto = 1.5\n\
                     count = 6\n";

#[test]
fn damaged_cases_of_a_sweep_are_computed_again() {
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("s.toml"), SWEEP).unwrap();
    let at = |name: &str| place.path().join(name);
    let whole = arclen(place.path(), &["sweep", "s.toml", "--out", "whole", "-q"]);
    assert_eq!(whole.status.code(), Some(0), "{}", stderr(&whole));
    let mut random = Random(7);
    for trial in 0..60 {
        let out = format!("o{trial}");
        copy(&at("whole"), &at(&out));
        let kept = files(&at(&out).join("cases"));
        let mut said = String::new();
        let first = random.below(kept.len());
        let second = random.below(kept.len());
        for chosen in [first, second].iter().take(1 + trial % 2) {
            said += &random.damage(&kept[*chosen]);
        }
        let output = arclen(place.path(), &["sweep", "s.toml", "--out", &out, "-q"]);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(0), "{said}: {message}");
        let name = kept[first].file_name().unwrap().to_str().unwrap();
        assert!(message.contains(name) && message.contains("damaged"), "{said}: {message}");
        assert!(at(&out).join("cases").join(format!("{name}.damaged")).is_file(), "{said}");
        equal(&at("whole"), &at(&out), &said);
        // and it is whole again
        let output = arclen(place.path(), &["sweep", "s.toml", "--out", &out, "-q"]);
        assert_eq!((output.status.code(), stderr(&output)), (Some(0), String::new()), "{said}");
        fs::remove_dir_all(at(&out)).unwrap();
    }
}

#[test]
fn a_damaged_case_is_named_when_shards_are_united() {
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("s.toml"), SWEEP).unwrap();
    for (shard, out) in [("1/2", "a"), ("2/2", "b")] {
        let run = ["sweep", "s.toml", "--shard", shard, "--out", out, "-q"];
        assert_eq!(arclen(place.path(), &run).status.code(), Some(0));
    }
    let case = place.path().join("b/cases/case-000003.cbor");
    let mut bytes = fs::read(&case).unwrap();
    bytes[100] ^= 4;
    fs::write(&case, bytes).unwrap();
    let output = arclen(place.path(), &["merge", "a", "b", "--out", "m", "-q"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(stderr(&output).contains("case-000003.cbor: damaged"), "{}", stderr(&output));
    assert!(case.is_file());
}

const DIAGRAM: [&str; 6] =
    ["diagram", "mittelmann", "--set", "mesh.elements=14", "-q", "--no-pictures"];

fn diagram(folder: &Path, out: &str) -> Output {
    arclen(folder, &[&DIAGRAM[..], &["--out", out]].concat())
}

fn begin(folder: &Path, out: &str) -> Child {
    command(folder, &[&DIAGRAM[..], &["--out", out]].concat()).spawn().unwrap()
}

#[test]
fn damaged_branches_of_a_diagram_are_computed_again() {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    let clock = Instant::now();
    assert_eq!(diagram(place.path(), "whole").status.code(), Some(0));
    let took = clock.elapsed();
    // killed in the midst of it; a slower moment of the machine needs more time
    let mut part = 0.6;
    while fs::read_dir(at("part/unfinished")).map_or(0, Iterator::count) < 6 {
        let mut child = begin(place.path(), "part");
        sleep(took.mul_f64(part));
        child.kill().unwrap();
        child.wait().unwrap();
        part *= 0.5;
    }
    let mut random = Random(3);
    for trial in 0..6 {
        let out = format!("o{trial}");
        copy(&at("part"), &at(&out));
        let kept = files(&at(&out).join("unfinished"));
        let hidden = |path: &Path| path.file_name().unwrap().to_str().unwrap().starts_with('.');
        let kept: Vec<&PathBuf> = kept.iter().filter(|path| !hidden(path)).collect();
        let chosen = kept[random.below(kept.len())];
        let said = random.damage(chosen);
        let output = diagram(place.path(), &out);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(0), "{said}: {message}");
        let name = chosen.file_name().unwrap().to_str().unwrap();
        assert!(message.contains(name) && message.contains("damaged"), "{said}: {message}");
        equal(&at("whole"), &at(&out), &said);
        assert!(!at(&out).join("unfinished").exists(), "{said}");
        fs::remove_dir_all(at(&out)).unwrap();
    }
}

#[test]
fn a_folder_that_is_removed_meanwhile_is_made_again() {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    let clock = Instant::now();
    assert_eq!(diagram(place.path(), "whole").status.code(), Some(0));
    let took = clock.elapsed();
    let mut child = begin(place.path(), "gone");
    for _ in 0..4 {
        sleep(took / 10);
        // what is removed after the end stays away
        if child.try_wait().unwrap().is_none() {
            // it may be written to at this very moment
            let _ = fs::remove_dir_all(at("gone"));
        }
    }
    assert_eq!(child.wait().unwrap().code(), Some(0));
    equal(&at("whole"), &at("gone"), "removed four times");
}

#[test]
fn a_sweep_says_which_cases_were_removed_under_it() {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    let long =
        SWEEP.replace("enz", "mittelmann").replace("[[vary]]", "[mesh]\nelements = 14\n[[vary]]");
    fs::write(at("s.toml"), long.replace("count = 6", "count = 40")).unwrap();
    let run = |out: &'static str| ["sweep", "s.toml", "--jobs", "1", "-q", "--out", out];
    let clock = Instant::now();
    let done = arclen(place.path(), &run("whole")).status.code();
    let took = clock.elapsed();
    let child = command(place.path(), &run("gone")).stderr(Stdio::piped()).spawn().unwrap();
    while files_of(&at("gone/cases")) < 5 && clock.elapsed() < 3 * took {
        sleep(Duration::from_millis(1));
    }
    let _ = fs::remove_dir_all(at("gone"));
    let output = child.wait_with_output().unwrap();
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(3), "{message}");
    assert!(message.contains("were removed while this ran"), "{message}");
    assert_eq!(arclen(place.path(), &run("gone")).status.code(), done);
    equal(&at("whole"), &at("gone"), "computed again");
}

fn files_of(folder: &Path) -> usize {
    fs::read_dir(folder).map_or(0, Iterator::count)
}

#[test]
fn a_used_folder_keeps_nothing_of_another_case() {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    let run = |arguments: &[&str]| {
        let output = arclen(place.path(), &[arguments, &["--out", "o", "-q"]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    };
    run(&["trace", "fig12", "--elements", "60", "--report"]);
    assert!(at("o/report.html").is_file() && names(&at("o")).len() > 5);
    fs::write(at("o/branch-9.csv"), "mine").unwrap();
    fs::write(at("o/notes.txt"), "mine").unwrap();
    run(&["trace", "enz", "--no-pictures"]);
    let mine = ["branch-9.csv", "notes.txt"];
    let left = |own: &[&str]| {
        let mut all: Vec<&str> = own.iter().chain(&mine).copied().collect();
        all.sort_unstable();
        assert_eq!(names(&at("o")), all);
    };
    left(&["branch.csv", "case.toml", "events.json"]);
    run(&["diagram", "pp2", "--report"]);
    assert!(at("o/report.html").is_file() && !at("o/events.json").exists());
    run(&["map", "co-oxidation", "--over", "k", "--no-pictures"]);
    assert!(!at("o/diagram.json").exists() && !at("o/branch-0.csv").exists());
    assert_eq!(fs::read_to_string(at("o/branch-9.csv")).unwrap(), "mine");
}

#[cfg(target_os = "linux")]
#[test]
fn kills_leave_no_rubbish_after_the_next_run() {
    let place = tempfile::tempdir().unwrap();
    let out = place.path().join("o");
    for life in 0..15_u64 {
        let mut child = begin(place.path(), "o");
        sleep(Duration::from_millis(120 + 61 * life % 100));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    fs::create_dir_all(out.join("unfinished")).unwrap();
    fs::write(out.join(".arclen-mine"), "mine").unwrap();
    assert_eq!(diagram(place.path(), "o").status.code(), Some(0));
    let hidden: Vec<String> =
        names(&out).into_iter().filter(|name| name.starts_with('.')).collect();
    assert_eq!(hidden, [".arclen-mine"]);
}
