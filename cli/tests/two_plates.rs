//! Cases from pole to pole between two plates.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn arclen(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_arclen")).args(arguments).current_dir(folder).output().unwrap()
}

fn json(file: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

/// A column of a table, empty cells as NaN.
fn column(file: &Path, name: &str) -> Vec<f64> {
    let text = fs::read_to_string(file).unwrap();
    let mut lines = text.lines();
    let at = lines.next().unwrap().split(',').position(|title| title == name).unwrap();
    lines.map(|line| line.split(',').nth(at).unwrap().parse().unwrap_or(f64::NAN)).collect()
}

/// Two equal plates, the shell free between them: the symmetric branch with its folds, and a pitchfork
/// at every loss of mirror symmetry, as the independent solver has them on as many elements.
#[test]
fn a_trace_sees_where_mirror_symmetry_is_lost() {
    let place = tempfile::tempdir().unwrap();
    let output = arclen(place.path(), &["trace", "two-plates", "--elements", "200", "--out", "o"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(shown.contains("against axisymmetric modes only, with and without mirror"), "{shown}");
    let out = place.path().join("o");
    let titles = fs::read_to_string(out.join("branch.csv")).unwrap();
    let titles: Vec<&str> = titles.lines().next().unwrap().split(',').skip(14).collect();
    let own = ["pole_top", "pole_bottom", "shift", "force_bottom", "contact_radius_bottom"];
    assert_eq!(titles, [&["contact_radius", "event"][..], &own].concat());
    let events = json(&out.join("events.json"));
    assert_eq!(events["stability"]["scan"], "axisymmetric");
    assert_eq!(events["stability"]["parities"], serde_json::json!(["symmetric", "antisymmetric"]));
    let all = events["events"].as_array().unwrap();
    let of = |kind: &str| -> Vec<f64> {
        all.iter().filter(|e| e["kind"] == kind).map(|e| e["z0"].as_f64().unwrap()).collect()
    };
    let known = [1.030_245_113_69, 0.818_761_89, 0.873_037_246_2, 0.821_816_609_7, 0.777_922_861_7];
    let forks = of("branch-point");
    assert_eq!((forks.len(), of("fold").len(), of("pull-off").len()), (5, 2, 1));
    for (found, known) in forks.iter().zip(known) {
        assert!((found - known).abs() < 1e-8, "{found} {known}");
    }
    // everywhere both plates carry the same, and nothing has moved
    let file = out.join("branch.csv");
    for (top, bottom) in column(&file, "force").iter().zip(column(&file, "force_bottom")) {
        assert!((top - bottom).abs() < 1e-8);
    }
    assert!(column(&file, "shift").iter().all(|shift| shift.abs() < 1e-7));
    // what is written resolves to itself
    let written = out.join("case.toml");
    let again = arclen(place.path(), &["check", written.to_str().unwrap()]);
    assert_eq!(again.status.code(), Some(0));
    assert_eq!(String::from_utf8(again.stdout).unwrap(), fs::read_to_string(&written).unwrap());
    for picture in ["force_distance.svg", "shapes.svg"] {
        assert!(out.join(picture).exists(), "{picture}");
    }
    let picture = fs::read_to_string(out.join("force_distance.svg")).unwrap();
    let words = |line: &str| picture.lines().any(|l| l.trim() == line);
    assert!(words("stable to axisymmetric modes") && !words("stable"));
}

/// From pull-off the bubble leaves one plate; the diagram has both ways it may take.
#[test]
fn a_diagram_follows_the_bubble_onto_one_plate() {
    let place = tempfile::tempdir().unwrap();
    let line = "diagram two-plates --elements 100 --out o --set path.end=1.0";
    let output = arclen(place.path(), &line.split(' ').collect::<Vec<_>>());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let diagram = json(&place.path().join("o/diagram.json"));
    assert_eq!(diagram["stopped_because"], "complete");
    let branches = diagram["branches"].as_array().unwrap();
    assert_eq!(branches.len(), 3);
    let mut ends = Vec::new();
    for branch in &branches[1..] {
        assert_eq!(branch["from"]["branch"], 0);
        let file = place.path().join("o").join(branch["csv"].as_str().unwrap());
        let (shift, unstable) = (column(&file, "shift"), column(&file, "unstable"));
        // stable at the end, next to one plate
        assert_eq!(unstable.last(), Some(&0.0));
        ends.push(*shift.last().unwrap());
    }
    assert!(ends[0].abs() > 0.05 && (ends[0] + ends[1]).abs() < 1e-6, "{ends:?}");
}

/// One plate, the equator held; and a cantilever above a rigid plate.
#[test]
fn one_plate_and_a_cantilever() {
    let place = tempfile::tempdir().unwrap();
    let case = "problem = \"two-plates\"\nequator = \"held\"\n[shell]\nlaw = \"hooke\"\n\
                [dimensionless]\nbending = 3e-5\npressure = 3e-3\n[plate.top]\nadhesion = 2e-6\n\
                film = 0.0333\n[mesh]\nelements = 60\n[path]\nstart = 1.1\nend = 0.95\n";
    fs::write(place.path().join("one.toml"), case).unwrap();
    let output = arclen(place.path(), &["trace", "one.toml", "--out", "o"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let file = place.path().join("o/branch.csv");
    let last = |name: &str| *column(&file, name).last().unwrap();
    assert!(last("force") > 0.1 && last("force_bottom") == 0.0);
    assert!(last("pole_top") < 0.96 && last("pole_bottom") > 0.99 && last("shift").abs() < 1e-12);
    assert!(column(&file, "unstable").iter().all(|n| *n == 0.0));

    let line = "trace two-plates --elements 60 --out c --set plate.top.device=cantilever \
                --set plate.top.stiffness=30 --set path.start=1.3 --set path.end=1.05";
    let output = arclen(place.path(), &line.split_whitespace().collect::<Vec<_>>());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let file = place.path().join("c/branch.csv");
    let (z0, force, base) = (column(&file, "z0"), column(&file, "force"), column(&file, "base"));
    for k in 0..base.len() {
        // the upper plate alone gives way
        assert!((2.0 * (z0[k] - base[k]) - force[k] / 30.0).abs() < 1e-9);
    }
}

#[test]
fn bad_plates_are_named_with_what_to_do() {
    let place = tempfile::tempdir().unwrap();
    let refused = |more: &[&str], says: &[&str]| {
        let sets = more.iter().flat_map(|text| ["--set", text]);
        let line: Vec<&str> = ["check", "two-plates"].into_iter().chain(sets).collect();
        let output = arclen(place.path(), &line);
        assert_eq!(output.status.code(), Some(2), "{more:?}");
        let error = String::from_utf8(output.stderr).unwrap();
        for words in says {
            assert!(error.contains(words), "{more:?}: {words} in {error}");
        }
    };
    refused(&["path.end=-0.2"], &["path.end", "-0.2", "positive"]);
    refused(&["plate.bottom.film=0"], &["plate.bottom.film", "positive"]);
    refused(&["plate.top.adhesion=-1"], &["plate.top.adhesion", "positive"]);
    refused(&["plate.left.film=1"], &["plate.left", "top, bottom"]);
    refused(&["plate.bottom.device=cantilever"], &["plate.bottom.device", "[plate.top]"]);
    refused(&["plate.top.device=cantilever"], &["plate.top.stiffness", "needs its stiffness"]);
    refused(&["plate.top.stiffness=3"], &["plate.top.stiffness", "a grip has none"]);
    refused(&["equator=pinned"], &["equator", "free", "held"]);
    refused(&["dimensionless.adhesion=1e-3"], &["dimensionless.adhesion", "plate.top"]);
    let case = "problem = \"two-plates\"\n[shell]\nlaw = \"hooke\"\n[dimensionless]\n\
                bending = 3e-5\npressure = 3e-3\n[plate.top]\nadhesion = 2e-3\nfilm = 0.03\n\
                [path]\nstart = 1.1\nend = 0.9\n";
    fs::write(place.path().join("one.toml"), case).unwrap();
    let output = arclen(place.path(), &["check", "one.toml"]);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(error.contains("plate.bottom") && error.contains("equator = \"held\""), "{error}");
    for command in ["cycle", "map"] {
        let line: Vec<&str> = match command {
            "map" => vec!["map", "two-plates", "--over", "film"],
            _ => vec![command, "two-plates"],
        };
        let output = arclen(place.path(), &line);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.contains("mirror-symmetric states only"), "{error}");
    }
}
