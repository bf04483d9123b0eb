//! Ring-load cases through the program.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::Path;
use std::process::{Command, Output};

const CASE: &str = "problem = \"ring-load\"\n[shell]\nlaw = \"hooke\"\npoisson = 0.3\n[dimensionless]\n\
                    bending = 9.157509157509157e-6\n[mesh]\nelements = 80\n[path]\nstart = 4.5\nend = 14\n";

fn arclen(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_arclen"));
    command.current_dir(folder).args(arguments).output().unwrap()
}

fn folder(text: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("ring.toml"), text).unwrap();
    folder
}

fn json(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

#[test]
fn trace_in_degrees_with_the_fixed_columns() {
    let folder = folder(CASE);
    let output = arclen(folder.path(), &["trace", "ring.toml", "--out", "o"]);
    assert!(output.status.success(), "{output:?}");
    let table = std::fs::read_to_string(folder.path().join("o/branch.csv")).unwrap();
    let title = "point,alpha,deflection_over_h,force,unstable,pole_height,ring_height,admissible,\
                 energy_total,event,";
    assert!(table.starts_with(title), "{table}");
    let rows: Vec<Vec<&str>> =
        table.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let number = |text: &str| text.parse::<f64>().unwrap();
    assert_eq!((number(rows[0][1]), number(rows[rows.len() - 1][1])), (4.5, 14.0));
    assert!((number(rows[0][3]) - 43.280).abs() < 1e-3);
    assert!(rows.iter().all(|row| row[7] == "false"));
    let events = json(&folder.path().join("o/events.json"));
    assert_eq!(events["parameter"], "alpha");
    let folds = events["events"].as_array().unwrap().iter().filter(|e| e["kind"] == "fold");
    let angles: Vec<f64> = folds.map(|fold| fold["alpha"].as_f64().unwrap()).collect();
    assert_eq!(angles.len(), 2);
    assert!((angles[0] - 8.6366).abs() < 2e-4 && (angles[1] - 8.6340).abs() < 2e-4);
    for picture in ["diagram.svg", "shapes.svg"] {
        assert!(folder.path().join("o").join(picture).exists(), "{picture}");
    }
}

#[test]
fn diagram_lists_the_dimple() {
    let folder = folder(CASE);
    let arguments = ["diagram", "ring.toml", "--depth", "1", "--out", "o"];
    let output = arclen(folder.path(), &arguments);
    assert!(output.status.success(), "{output:?}");
    let diagram = json(&folder.path().join("o/diagram.json"));
    let branches = diagram["branches"].as_array().unwrap();
    assert_eq!(branches.len(), 2);
    assert_eq!(branches[1]["from"]["deflation"], true);
    assert!(branches[1]["from"]["parameter"].as_f64().unwrap() > 4.5);
    let near = &branches[0]["near_bifurcations"][0];
    assert!((near["alpha"].as_f64().unwrap() - 8.706).abs() < 1e-2, "{near}");
    let table = std::fs::read_to_string(folder.path().join("o/branch-1.csv")).unwrap();
    let ends = table.lines().skip(1).map(|line| line.split(',').nth(7).unwrap());
    assert!(ends.clone().any(|flag| flag == "true"));
}

#[test]
fn bad_input_is_refused() {
    let folder = folder(CASE);
    for (setting, words) in [
        ("path.start=0", "between 0 and 90 degrees"),
        ("mesh.elements=10", "at least 16"),
        ("dimensionless.bending=-1", "must be positive"),
        ("dimensionless.adhesion=1", "adhesion"),
    ] {
        let output = arclen(folder.path(), &["trace", "ring.toml", "--set", setting, "--out", "o"]);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{setting}: {error}");
        assert!(error.contains(words), "{setting}: {error}");
        assert!(!folder.path().join("o").exists());
    }
}

#[test]
fn map_over_the_moment_has_a_cusp() {
    let folder = folder(CASE);
    let output = arclen(folder.path(), &["map", "ring.toml", "--over", "moment", "--out", "o"]);
    assert!(output.status.success(), "{output:?}");
    let map = json(&folder.path().join("o/map.json"));
    let cusp = &map["points"][0];
    assert_eq!(cusp["kind"], "cusp");
    assert!((cusp["alpha"].as_f64().unwrap() - 8.4603).abs() < 1e-3, "{cusp}");
    assert!((cusp["moment"].as_f64().unwrap() - 1.034e-6).abs() < 1e-9, "{cusp}");
}
