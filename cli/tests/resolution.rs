//! What traces and diagrams say where the elements are too long.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;

const SHORT: [&str; 4] = ["--set", "path.end=0.95", "--set", "stability.scan=axisymmetric"];

/// What is printed.
fn arclen(folder: &Path, arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_arclen"))
        .args(arguments)
        .args(SHORT)
        .current_dir(folder)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn resolution(file: &Path) -> Value {
    let all: Value = serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap();
    all["resolution"].clone()
}

#[test]
fn elements_that_are_too_long_are_told_with_a_number_that_is_enough() {
    let place = tempfile::tempdir().unwrap();
    let shown = arclen(place.path(), &["trace", "fig12", "--elements", "20", "--out", "coarse"]);
    let out = place.path().join("coarse");
    let said = resolution(&out.join("events.json"));
    let wanted = said["elements_wanted"].as_u64().unwrap();
    assert!(said["enough"] == false && wanted > 20, "{said}");
    let sentence = format!("take mesh.elements = {wanted} or more");
    assert!(shown.contains("not resolved: at z0 = ") && shown.contains(&sentence), "{shown}");
    let picture = fs::read_to_string(out.join("force_distance.svg")).unwrap();
    assert!(picture.contains("fig12 (elements too long: not resolved)"));
    let table = fs::read_to_string(out.join("branch.csv")).unwrap();
    let titles: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let column = titles.iter().position(|title| *title == "elements_per_film_length").unwrap();
    let values = table.lines().skip(1).map(|line| line.split(',').nth(column).unwrap());
    let least = values.map(|value| value.parse::<f64>().unwrap()).fold(f64::INFINITY, f64::min);
    assert!(least < 1.0 && least <= said["elements_per_film_length"].as_f64().unwrap());

    let wanted = (wanted + 2).to_string();
    let shown = arclen(place.path(), &["trace", "fig12", "--elements", &wanted, "--out", "fine"]);
    assert!(!shown.contains("not resolved"), "{shown}");
    let out = place.path().join("fine");
    assert_eq!(resolution(&out.join("events.json"))["enough"], true);
    let picture = fs::read_to_string(out.join("force_distance.svg")).unwrap();
    assert!(!picture.contains("not resolved"));
}

#[test]
fn a_diagram_says_it_too() {
    let place = tempfile::tempdir().unwrap();
    let shown =
        arclen(place.path(), &["diagram", "fig12", "--set", "mesh.elements=20", "--out", "o"]);
    assert!(shown.contains("not resolved: at z0 = "), "{shown}");
    let out = place.path().join("o");
    assert_eq!(resolution(&out.join("diagram.json"))["enough"], false);
    let picture = fs::read_to_string(out.join("diagram.svg")).unwrap();
    assert!(picture.contains("fig12 (elements too long: not resolved)"));
}

#[test]
fn an_error_is_asked_for_and_kept() {
    let place = tempfile::tempdir().unwrap();
    let mut before = 0;
    for tolerance in ["1e-3", "1e-5", "1e-7"] {
        let asked = format!("mesh.tolerance={tolerance}");
        let shown = arclen(place.path(), &["trace", "fig12", "--set", &asked, "--out", tolerance]);
        let said = resolution(&place.path().join(tolerance).join("events.json"));
        let elements = said["elements"].as_u64().unwrap();
        assert!(elements >= before && said["enough"] == true, "{said}");
        before = elements;
        assert_eq!(said["mesh_tolerance"].as_f64().unwrap(), tolerance.parse::<f64>().unwrap());
        assert_eq!(said["mesh_tolerance_met"], true);
        assert!(said["force_mesh_error"].as_f64() <= said["mesh_tolerance"].as_f64());
        let sentence =
            format!("mesh: {elements} elements for mesh.tolerance = {tolerance}; halving");
        assert!(shown.contains(&sentence), "{shown}");
    }
    assert!(before > 100);
}

#[test]
fn an_error_of_the_mesh_is_known_under_a_lever() {
    let place = tempfile::tempdir().unwrap();
    let lever = ["device.kind=cantilever", "device.stiffness=5", "mesh.tolerance=1e-6"];
    let keys: Vec<&str> = lever.iter().flat_map(|key| ["--set", key]).collect();
    let shown =
        arclen(place.path(), &[&["trace", "fig12"], keys.as_slice(), &["--out", "o"]].concat());
    assert!(shown.contains("elements for mesh.tolerance = 1e-6"), "{shown}");
    let said = resolution(&place.path().join("o").join("events.json"));
    assert_eq!(said["mesh_tolerance_met"], true);
    assert!(said.get("z0_mesh_error").is_none(), "{said}");
}
