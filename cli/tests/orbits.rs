//! Periodic orbits as scripts see them.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn arclen(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_arclen")).args(arguments).current_dir(folder).output().unwrap()
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// A column of a CSV file; empty cells are NaN.
fn column(path: &Path, name: &str) -> Vec<f64> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let at = reader.headers().unwrap().iter().position(|title| title == name).unwrap();
    let cell = |row: csv::StringRecord| row[at].parse().unwrap_or(f64::NAN);
    reader.records().map(|row| cell(row.unwrap())).collect()
}

/// Without being asked a diagram follows no cycles, and does not say that nothing was left out.
#[test]
fn a_diagram_says_whether_cycles_were_followed() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    let output = arclen(folder, &["diagram", "brusselator", "--out", "without"]);
    assert_eq!(output.status.code(), Some(0));
    let without = json(&folder.join("without/diagram.json"));
    assert_eq!(without["cycles"]["hopf_points"], 1);
    assert_eq!(without["cycles"]["followed"], false);
    assert_eq!(without["cycles"]["complete"], false);
    let detail = without["stopped_detail"].as_str().unwrap();
    assert!(detail.contains("cycles") && detail.contains("not followed"), "{detail}");

    let set = ["--set", "diagram.cycles=true"];
    let output = arclen(folder, &[&["diagram", "brusselator", "--out", "with"], &set[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let with = json(&folder.join("with/diagram.json"));
    assert_eq!(with["stopped_because"], "complete", "{}", with["stopped_detail"]);
    assert_eq!(with["cycles"]["complete"], true);
    let branches = with["branches"].as_array().unwrap();
    assert_eq!(branches.len(), 2);
    assert_eq!(branches[1]["kind"], "cycles");
    assert_eq!(branches[1]["from"]["branch"], 0);
    let from = branches[1]["from"]["event"].as_u64().unwrap() as usize;
    assert_eq!(branches[0]["events"][from]["kind"], "hopf");
    for file in ["branch-1.csv", "orbit-1.csv", "period.svg", "time-1.svg", "phase-1.svg"] {
        assert!(folder.join("with").join(file).is_file(), "{file}");
    }
    let csv = folder.join("with/branch-1.csv");
    let (b, period) = (column(&csv, "B"), column(&csv, "period"));
    assert_eq!(b.last(), Some(&4.0));
    assert!(period.windows(2).all(|w| w[0] < w[1]));
    let (high, low, mean) = (column(&csv, "max_x"), column(&csv, "min_x"), column(&csv, "mean_x"));
    assert!((0..b.len()).all(|i| low[i] < mean[i] && mean[i] < high[i]));
    // the mean of x is A: from y' + x' = A − x
    assert!(mean.iter().all(|m| (m - 1.0).abs() < 1e-7), "{mean:?}");
    assert!(column(&csv, "unstable").iter().all(|n| *n == 0.0));
    // each orbit closes
    let orbits = folder.join("with/orbit-1.csv");
    let (t, x) = (column(&orbits, "t"), column(&orbits, "x"));
    let starts: Vec<usize> = (0..t.len()).filter(|i| t[*i] == 0.0).collect();
    assert!(starts.len() >= 5);
    for (at, start) in starts.iter().enumerate() {
        let end = starts.get(at + 1).copied().unwrap_or(t.len()) - 1;
        assert_eq!(x[*start], x[end]);
    }
    // what an earlier run left and this one does not write is gone
    let output = arclen(folder, &["diagram", "brusselator", "--out", "with"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(!folder.join("with/orbit-1.csv").exists() && !folder.join("with/period.svg").exists());
}

#[test]
fn one_hopf_point_of_several_and_what_is_left_out() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    let output = arclen(folder, &["orbits", "ab", "--hopf", "1", "--no-pictures"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let found = json(&folder.join("arclen-out/ab/orbits.json"));
    assert!(output.status.success(), "{said} {}", found["stopped_detail"]);
    assert_eq!(found["cycles"]["hopf_points"], 2);
    assert_ne!(found["stopped_because"], "complete");
    assert!(found["stopped_detail"].as_str().unwrap().contains("left out, as was asked"));
    let branches = found["branches"].as_array().unwrap();
    let cycles: Vec<&Value> = branches.iter().filter(|one| one["kind"] == "cycles").collect();
    assert_eq!(cycles.len(), 1);
    // AUTO-07p, followed to a period of 1000: 0.110114
    assert_eq!(cycles[0]["stopped_because"], "period-unbounded", "{}", cycles[0]["stopped_detail"]);
    let csv = folder.join("arclen-out/ab").join(cycles[0]["csv"].as_str().unwrap());
    assert!(column(&csv, "p").last().is_some_and(|p| (p - 0.110_114).abs() < 1e-6));

    let output = arclen(folder, &["orbits", "ab", "--hopf", "2"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("no Hopf point number 2"));
    let output = arclen(folder, &["orbits", "fig12", "--out", "none"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("no periodic orbits"));
    assert!(!folder.join("none").exists());
    let output = arclen(folder, &["check", "ab", "--set", "diagram.cycles=\"yes\""]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("true or false"));
}

/// Multipliers, errors and types of the special points, as the JSON has them.
#[test]
fn events_of_cycles_have_period_multipliers_and_a_type_where_known() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    let arguments =
        ["orbits", "roessler", "--set", "path.end=0.13", "--depth", "0", "--no-pictures", "--json"];
    let output = arclen(folder, &arguments);
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let cycles = found["branches"].as_array().unwrap().iter().find(|b| b["kind"] == "cycles");
    let events = cycles.unwrap()["events"].as_array().unwrap();
    let doubling = events.iter().find(|e| e["kind"] == "period-doubling").unwrap();
    let multipliers = doubling["multipliers"].as_array().unwrap();
    let near = |re: f64| {
        multipliers.iter().any(|m| (m["re"].as_f64().unwrap() - re).abs() < 1e-6 && m["im"] == 0.0)
    };
    assert!(near(-1.0) && near(1.0), "{multipliers:?}");
    assert_eq!(doubling["type"], "supercritical");
    assert!(doubling["error_estimate"].as_f64().unwrap() < 1e-6);
    assert!(doubling["period"].as_f64().unwrap() > 5.0);
    assert_eq!((&doubling["unstable_before"], &doubling["unstable_after"]), (&0.into(), &1.into()));
    // doubled cycles were not wanted, and that is said
    assert_eq!(found["cycles"]["complete"], false);
    assert!(found["stopped_detail"].as_str().unwrap().contains("cycle_depth"));
}
