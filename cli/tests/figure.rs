//! Figures as scripts see them: files, numbers, exit codes.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn arclen(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_arclen")).args(arguments).current_dir(folder).output().unwrap()
}

fn read(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn all_figures_come_with_data_and_claims_with_verdicts() {
    let place = tempfile::tempdir().unwrap();
    let arguments = ["figure", "all", "--elements", "60", "--no-pictures", "--out", "o"];
    let output = arclen(place.path(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stdout));
    let out = place.path().join("o");
    let figures = read(&out.join("figures.json"));
    let figures = figures["figures"].as_array().unwrap();
    let numbers: Vec<u64> = figures.iter().map(|f| f["figure"].as_u64().unwrap()).collect();
    assert_eq!(numbers, [4, 5, 6, 7, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20]);
    for figure in figures {
        for curve in figure["curves"].as_array().unwrap() {
            assert_eq!(curve["stopped_because"], "target");
            for file in ["case", "csv"] {
                assert!(out.join(curve[file].as_str().unwrap()).is_file(), "{curve}");
            }
        }
    }
    let claims = read(&out.join("claims.json"));
    let claims = claims["claims"].as_array().unwrap();
    assert!(claims.len() >= 18, "{}", claims.len());
    for claim in claims {
        let decided = ["agrees", "disagrees"].contains(&claim["verdict"].as_str().unwrap());
        assert_eq!(decided, claim["tolerance"] != "none", "{claim}");
        assert!(!claim["why"].as_str().unwrap().is_empty(), "{claim}");
    }
}

/// Values known from independent solvers.
#[test]
fn measured_values_are_those_of_other_solvers_and_the_page_needs_nothing_else() {
    let place = tempfile::tempdir().unwrap();
    let arguments = ["figure", "5", "12", "--elements", "200", "--out", "o"];
    assert_eq!(arclen(place.path(), &arguments).status.code(), Some(0));
    let out = place.path().join("o");
    for name in ["fig05.svg", "fig05.png", "fig12.svg", "fig12.png"] {
        assert!(fs::metadata(out.join(name)).unwrap().len() > 10_000, "{name}");
    }
    let page = fs::read_to_string(out.join("index.html")).unwrap();
    assert_eq!(page.matches("<section id=\"fig").count(), 2);
    assert!(!page.contains("src=\"http") && page.contains("font/ttf;base64"));
    let table = page.split("<section id=\"claims\">").nth(1).unwrap();
    let rows: Vec<&str> = table.split("</table>").next().unwrap().split("<tr>").skip(1).collect();
    let cells = |row: &str| row.matches("<td").count() + row.matches("<th").count();
    assert!(rows.len() > 5 && rows.iter().all(|row| cells(row) == cells(rows[0])), "{rows:?}");
    for link in page.split("href=\"").skip(1).map(|rest| rest.split('"').next().unwrap()) {
        assert!(link.starts_with('#') || out.join(link).is_file(), "{link}");
    }

    let claims = read(&out.join("claims.json"));
    let claims = claims["claims"].as_array().unwrap();
    let of = |statement: &str| {
        let found = claims.iter().find(|c| c["statement"].as_str().unwrap().starts_with(statement));
        found.unwrap().clone()
    };
    for (statement, known, tolerance) in [
        ("force at the knee", 3.19, 0.02),
        ("a limit point at d = 0.07", 0.0814, 2e-4),
        ("… and F = 2.5", 2.698, 0.01),
        ("the branch turns down until", 0.0269, 2e-4),
        ("… and F = 0.71", 0.741, 5e-3),
    ] {
        let ours = of(statement)["ours"].as_f64().unwrap();
        assert!((ours - known).abs() < tolerance, "{statement}: {ours}");
    }
    assert_eq!(of("around Δ = 52 nm")["verdict"], "agrees");
    assert_eq!(of("a limit point at d = 0.07")["verdict"], "disagrees");

    // a case of a figure can be traced, and varied
    let again = ["trace", "o/cases/fig12-strong.toml", "--elements", "60", "--json", "--quiet"];
    let traced: Value = serde_json::from_slice(&arclen(place.path(), &again).stdout).unwrap();
    assert_eq!(traced["stopped_because"], "target");
}

#[test]
fn numbers_and_options_that_are_wrong_create_nothing() {
    let place = tempfile::tempdir().unwrap();
    for (arguments, parts) in [
        (vec!["figure", "21"], vec!["no figure \"21\"", "4, 5, 6, 7, 9, 10"]),
        (vec!["figure", "six"], vec!["no figure \"six\""]),
        (vec!["figure", "8"], vec!["figure 8 is a sketch", "nothing is computed"]),
        (vec!["figure", "12", "--elements", "3"], vec!["figure 12", "mesh.elements"]),
        (vec!["figure", "12", "--set", "shell.colour=3"], vec!["colour"]),
    ] {
        let output = arclen(place.path(), &arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        for part in parts {
            assert!(message.contains(part), "{part}: {message}");
        }
    }
    assert_eq!(fs::read_dir(place.path()).unwrap().count(), 0);
}
