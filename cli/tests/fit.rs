//! `arclen fit`: files, exit codes, and what a wrong input is told.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

const CURVE: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/../identify/tests/data/open-1-hard-knee.tab");
const LAB: &str = "[instrument]\nspring_constant_sd = \"5 %\"\nnoise = \"150 pN\"\n[shell]\nlaw = \"hooke\"\n\
                   [physical]\nradius = \"1.58 um\"\nradius_sd = \"50 nm\"\n";

fn arclen(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_arclen")).current_dir(folder).args(arguments).output().unwrap()
}

fn words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_curve_becomes_files_and_a_case_that_can_be_traced() {
    let folder = tempfile::tempdir().unwrap();
    let lab = folder.path().join("lab.toml");
    std::fs::write(&lab, LAB).unwrap();
    let out = folder.path().join("out");
    let fit = |more: &[&str]| {
        let base = ["fit", CURVE, "--known", "lab.toml", "--out", "out", "--profile", "none"];
        arclen(folder.path(), &[&base, more].concat())
    };
    let output = fit(&["--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let young = json["derived"].as_array().unwrap().iter().find(|e| e["key"] == "young").unwrap();
    let [low, high] = [0, 1].map(|k| young["interval95"][k].as_f64().unwrap());
    assert!(low < 1.7e9 && 1.7e9 < high, "{low} {high}");
    let wanted = ["parameters", "contact", "baseline", "jumps", "pull_off", "quality", "warnings"];
    for key in wanted.into_iter().chain(["weakest_direction", "cost", "files"]) {
        assert!(json.get(key).is_some(), "{key}");
    }
    for name in ["fit.json", "fit.csv", "fit.svg", "case.toml"] {
        assert!(out.join(name).is_file(), "{name}");
    }
    let table = std::fs::read_to_string(out.join("fit.csv")).unwrap();
    let header = "segment,piezo,separation,approach_one_pole,force,model,residual,used";
    assert_eq!(table.lines().next(), Some(header));
    let check = arclen(folder.path(), &["check", "out/case.toml"]);
    assert_eq!(check.status.code(), Some(0), "{}", words(&check));
    // the shell that was found, as a plan
    let plan = arclen(
        folder.path(),
        &[
            "fit",
            "--plan",
            "out/case.toml",
            "--known",
            "lab.toml",
            "--json",
            "--set",
            "instrument.spring_constant=1.2 N/m",
        ],
    );
    assert_eq!(plan.status.code(), Some(0), "{}", words(&plan));
    let json: Value = serde_json::from_slice(&plan.stdout).unwrap();
    let depths = json["depths"].as_array().unwrap();
    let sd = |depth: &Value| depth["relative_sd"]["young"].as_f64().unwrap();
    // beyond the knee Young's modulus is known, before it is not
    assert!(sd(&depths[0]) > 5.0 * sd(depths.last().unwrap()));
}

#[test]
fn of_several_curves_one_that_fails_does_not_stop_the_others() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("lab.toml"), LAB).unwrap();
    std::fs::write(folder.path().join("bad.csv"), "force_nN,height_nm\n1,2\nx,3\n").unwrap();
    let arguments =
        ["fit", CURVE, "bad.csv", "--known", "lab.toml", "--out", "out", "--profile", "none"];
    let output = arclen(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(3), "{}", words(&output));
    assert!(words(&output).contains("bad.csv, line 3: force_nN = \"x\""), "{}", words(&output));
    let table = std::fs::read_to_string(folder.path().join("out/fits.csv")).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    assert!(lines.len() == 3 && lines[1].contains(",fitted,false,"), "{table}");
    assert!(lines[2].contains(",failed,true,"), "{table}");
    assert!(folder.path().join("out/open-1-hard-knee/fit.json").is_file());
}

#[test]
fn wrong_inputs_are_named_and_nothing_is_created() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("lab.toml"), LAB.replace("radius_sd", "radius_ds")).unwrap();
    for (more, expected) in [
        (&["--known", "lab.toml"][..], "did you mean \"radius_sd\""),
        (&["--law", "hook"], "--law hook"),
        (&["--law", "hooke"], "physical.radius: missing"),
        (&["--law", "hooke", "--prior", "radius=1.58:0.05"], "the unit is missing"),
        (&["--law", "hooke", "--free", "yuong"], "--free yuong: unknown key"),
        (&["--law", "hooke", "--prior", "radius=1.58 um:50 nm", "--range", "1"], "--range 1"),
        (&["--law", "hooke", "--profile", "E"], "--profile E"),
    ] {
        let output = arclen(folder.path(), &[&["fit", CURVE, "--out", "out"], more].concat());
        assert_eq!(output.status.code(), Some(2), "{more:?}: {}", words(&output));
        assert!(words(&output).contains(expected), "{more:?}: {}", words(&output));
        assert!(!folder.path().join("out").exists(), "{more:?}");
    }
}
