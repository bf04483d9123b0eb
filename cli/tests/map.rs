//! Maps as scripts see them: files, columns, exit codes, numbers.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn arclen(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_arclen")).args(arguments).current_dir(folder).output().unwrap()
}

fn json(folder: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.join("map.json")).unwrap()).unwrap()
}

fn points<'j>(json: &'j Value, kind: &str) -> Vec<&'j Value> {
    json["points"].as_array().unwrap().iter().filter(|p| p["kind"] == kind).collect()
}

fn near(value: &Value, known: f64, tolerance: f64) {
    let value = value.as_f64().unwrap();
    assert!((value - known).abs() < tolerance, "{value} is not {known}");
}

#[test]
fn co_oxidation_over_k_has_every_special_point_once() {
    let place = tempfile::tempdir().unwrap();
    let output = arclen(place.path(), &["map", "co-oxidation", "--over", "k", "--out", "o"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let out = place.path().join("o");
    let json = json(&out);
    let curves: Vec<&str> =
        json["curves"].as_array().unwrap().iter().map(|c| c["kind"].as_str().unwrap()).collect();
    // two folds and two Hopf points on the base branch, one curve each pair
    assert_eq!(curves, ["fold", "hopf"]);
    for file in ["fold-0.csv", "hopf-0.csv", "map.json", "map.svg", "case.toml"] {
        assert!(out.join(file).is_file(), "{file}");
    }
    let cusp = points(&json, "cusp");
    assert_eq!(cusp.len(), 1);
    near(&cusp[0]["p"], 1.006_408_329_678_3, 1e-9);
    near(&cusp[0]["k"], 0.355_991_273_209, 1e-9);
    let mut takens = points(&json, "bogdanov-takens");
    takens.sort_by(|a, b| a["k"].as_f64().unwrap().total_cmp(&b["k"].as_f64().unwrap()));
    assert_eq!(takens.len(), 2);
    near(&takens[0]["p"], 1.161_198_708_821_7, 1e-9);
    near(&takens[1]["k"], 0.971_397_573_485, 1e-9);
    assert!(takens.iter().all(|t| t["curves"].as_array().unwrap().len() == 2));
    assert_eq!(points(&json, "generalised-hopf").len(), 2);
    assert!(json["points"].as_array().unwrap().iter().all(|p| p["error_estimate"].is_f64()));
    let table = fs::read_to_string(out.join("hopf-0.csv")).unwrap();
    assert!(table.starts_with("point,p,k,x,y,s,omega,unstable,event\n"), "{table:.60}");
    assert!(table.contains("generalised-hopf"));
}

#[test]
fn the_cusp_lies_within_given_bounds() {
    let place = tempfile::tempdir().unwrap();
    let over = ["map", "cusp", "--over", "lambda", "--set", "map.from=-1", "--set", "map.to=2"];
    let output = arclen(place.path(), &[&over[..], &["--json"]].concat());
    assert_eq!(output.status.code(), Some(0));
    assert!(fs::read_dir(place.path()).unwrap().next().is_none(), "--json alone writes no files");
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((json["from"].as_f64(), json["to"].as_f64()), (Some(-1.0), Some(2.0)));
    let cusp = points(&json, "cusp");
    assert_eq!(cusp.len(), 1);
    near(&cusp[0]["mu"], 0.0, 1e-8);
    near(&cusp[0]["lambda"], 0.0, 1e-8);
    assert_eq!(json["curves"][0]["stopped_because"], "domain");
}

/// Without a fold at weak adhesion the map is found at a stronger one.
#[test]
fn a_case_without_a_fold_is_searched() {
    let place = tempfile::tempdir().unwrap();
    let arguments = ["map", "fig07", "--over", "dimensionless.adhesion", "--elements", "100"];
    let output = arclen(place.path(), &[&arguments[..], &["--out", "o"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let json = json(&place.path().join("o"));
    assert!(json["notes"][0].as_str().unwrap().contains("curves begin at"));
    let cusp = points(&json, "cusp");
    assert_eq!(cusp.len(), 1);
    near(&cusp[0]["z0"], 1.08846, 2e-5);
    near(&cusp[0]["adhesion"], 6.4976e-3, 2e-6);
    assert!(cusp[0]["force"].as_f64().unwrap() < 0.0);
}

/// Folds over gas and material, against branches of cases that say the same.
#[test]
fn folds_over_gas_and_material_are_those_of_cases() {
    let place = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        let output = arclen(place.path(), &[arguments, &["--elements", "60"]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    let gas = ["--set", "dimensionless.gas_exponent=1", "--set", "dimensionless.pressure=0.01"];
    let rubber = ["--set", "shell.law=mooney-rivlin", "--set", "shell.b=0.5"];
    for (case, more, key, table, from, to) in [
        ("fig16", &[][..], "gas_exponent", "dimensionless", 0.8, 1.4),
        ("fig16", &[], "poisson", "shell", 0.3, 0.5),
        ("fig16", &[], "b", "shell", 0.2, 1.0),
        ("ring-load", &gas, "gas_exponent", "dimensionless", 0.5, 1.5),
        ("ring-load", &gas, "poisson", "shell", 0.2, 0.4),
        ("ring-load", &rubber, "b", "shell", 0.2, 1.0),
    ] {
        let (first, out) = match case {
            "ring-load" => ("alpha", format!("ring-{key}")),
            _ => ("z0", key.to_owned()),
        };
        let (from, to) = (format!("map.from={from}"), format!("map.to={to}"));
        let over = ["map", case, "--over", key, "--set", &from, "--set", &to, "--out", &out];
        run(&[&over[..], more].concat());
        let csv = fs::read_to_string(place.path().join(&out).join("fold-0.csv")).unwrap();
        assert!(csv.starts_with(&format!("point,{first},{key},")));
        let last: Vec<&str> = csv.lines().last().unwrap().split(',').collect();
        let (mapped, value): (f64, &str) = (last[1].parse().unwrap(), last[2]);
        let changed = format!("{table}.{key}={value}");
        let trace = run(&[&["trace", case][..], more, &["--set", &changed, "--json"]].concat());
        let trace: Value = serde_json::from_slice(&trace).unwrap();
        let events = trace["events"].as_array().unwrap();
        let folds: Vec<f64> = events
            .iter()
            .filter(|e| e["kind"] == "fold")
            .filter_map(|e| e[first].as_f64())
            .collect();
        let found = folds.iter().any(|fold| (fold - mapped).abs() < 1e-8);
        assert!(found, "{case}, {key}: {mapped} {folds:?}");
    }
}

#[test]
fn a_map_cut_short_keeps_its_points() {
    let place = tempfile::tempdir().unwrap();
    let few = ["map", "co-oxidation", "--over", "k", "--set", "path.max_points=30", "--out", "o"];
    let output = arclen(place.path(), &few);
    assert_eq!(output.status.code(), Some(3), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(json(&place.path().join("o"))["stopped_because"], "max-points");
}

#[test]
fn wrong_keys_are_refused_with_the_right_ones() {
    let place = tempfile::tempdir().unwrap();
    for (arguments, words) in [
        (vec!["co-oxidation", "--over", "q"], vec!["--over q", "allowed here: k"]),
        (vec!["co-oxidation", "--over", "p"], vec!["is the parameter of the branch"]),
        (vec!["fig16", "--over", "adhesoin"], vec!["did you mean adhesion?", "surface_tension"]),
        (vec!["fig16", "--over", "surface_tension"], vec!["map.from and map.to"]),
        (vec!["fig16", "--over", "adhesion", "--set", "map.from=0.1"], vec!["is not between"]),
        (vec!["fig12", "--over", "b"], vec!["a shell of the law hooke has no such parameter"]),
        (
            vec!["fig16", "--over", "b", "--set", "map.to=2"],
            vec!["map.to = 2: b must be from 0 to 1"],
        ),
        (vec!["ring-load", "--over", "alpha"], vec!["is the parameter of the branch"]),
        (vec!["ring-load", "--over", "poison"], vec!["did you mean poisson?", "moment, bending"]),
        (vec!["ring-load", "--over", "b"], vec!["a shell of the law hooke has no such parameter"]),
        (vec!["plp", "--over", "p"], vec!["plp has no parameter besides p"]),
        (vec!["pressurised-sphere", "--over", "poisson"], vec!["allowed here: bending"]),
        (vec!["fig16", "--over", "adhesion", "--set", "map.form=1"], vec!["map.form", "from"]),
        (vec!["fig16"], vec!["--over"]),
    ] {
        let all: Vec<&str> = ["map"].into_iter().chain(arguments.iter().copied()).collect();
        let output = arclen(place.path(), &all);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        for word in words {
            assert!(message.contains(word), "{arguments:?}: {message}");
        }
    }
    assert!(fs::read_dir(place.path()).unwrap().next().is_none(), "nothing is created");
}

/// Rössler's cycles over the second parameter: with `diagram.cycles`, and without it none.
#[test]
fn period_doublings_are_followed_where_the_case_asks_for_cycles() {
    let place = tempfile::tempdir().unwrap();
    let over = ["map", "roessler", "--over", "c", "--set", "map.from=4", "--set", "map.to=5.7"];
    let over = [&over[..], &["--set", "path.end=0.13", "--out", "o"]].concat();
    let without = arclen(place.path(), &over);
    assert_eq!(without.status.code(), Some(0), "{}", String::from_utf8_lossy(&without.stderr));
    let kinds = |json: &Value| -> Vec<String> {
        let curves = json["curves"].as_array().unwrap();
        curves.iter().map(|curve| curve["kind"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(kinds(&json(&place.path().join("o"))), ["hopf"]);
    let with = [&over[..], &["--set", "diagram.cycles=true"]].concat();
    let with = arclen(place.path(), &with);
    assert_eq!(with.status.code(), Some(0), "{}", String::from_utf8_lossy(&with.stderr));
    let map = json(&place.path().join("o"));
    assert_eq!(kinds(&map), ["hopf", "period-doubling"]);
    let table = fs::read_to_string(place.path().join("o/period-doubling-0.csv")).unwrap();
    assert!(table.starts_with("point,a,c,period,event\n"), "{table:.60}");
    let last = table.lines().last().unwrap().split(',').collect::<Vec<_>>();
    // where a branch at c = 5.7 alone has it
    let output = arclen(
        place.path(),
        &[
            "orbits",
            "roessler",
            "--set",
            "path.end=0.13",
            "--depth",
            "0",
            "--no-pictures",
            "--json",
        ],
    );
    let orbits: Value = serde_json::from_slice(&output.stdout).unwrap();
    let cycles = orbits["branches"].as_array().unwrap().iter().find(|b| b["kind"] == "cycles");
    let events = cycles.unwrap()["events"].as_array().unwrap();
    let doubling = events.iter().find(|e| e["kind"] == "period-doubling").unwrap();
    assert_eq!(last[2].parse::<f64>().unwrap(), 5.7);
    near(&doubling["a"], last[1].parse().unwrap(), 1e-8);
    near(&doubling["period"], last[3].parse().unwrap(), 1e-7);
}
