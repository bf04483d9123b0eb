//! `arclen fit`: files, exit codes, and what a wrong input is told.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

#[path = "../../identify/tests/archives/mod.rs"]
#[allow(dead_code, reason = "other tests use more of it")]
mod archives;

use archives::{Archive, Common, Samples};
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
        let base = ["fit", CURVE, "--known", "lab.toml", "--out", "out", "--profile", "young"];
        arclen(folder.path(), &[&base, more].concat())
    };
    let output = fit(&["--json", "--report"]);
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let young = json["derived"].as_array().unwrap().iter().find(|e| e["key"] == "young").unwrap();
    let [low, high] = [0, 1].map(|k| young["interval95"][k].as_f64().unwrap());
    assert!(low < 1.7e9 && 1.7e9 < high, "{low} {high}");
    let wanted = ["parameters", "contact", "baseline", "jumps", "pull_off", "quality", "warnings"];
    for key in wanted.into_iter().chain(["weakest_direction", "cost", "files"]) {
        assert!(json.get(key).is_some(), "{key}");
    }
    for name in ["fit.json", "fit.csv", "fit.svg", "fit.png", "case.toml"] {
        assert!(out.join(name).is_file(), "{name}");
    }
    // the page stands alone, with all pictures, every quantity and its verdict
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert_eq!(page.matches("<svg").count(), 2);
    assert!(!["src=", "href=\"http", "<script"].iter().any(|part| page.contains(part)));
    for words in ["young", "identified", "95 % interval", "No jump was found", "chi2/dof"] {
        assert!(page.contains(words), "{words}");
    }
    // each known point of the profile is a dot, and the curve through them is no polygon
    let known = json["profiles"][0]["values"].as_array().unwrap().len();
    let drawing = std::fs::read_to_string(out.join("profile.svg")).unwrap();
    let longest = drawing.lines().map(|path| path.matches('L').count()).max().unwrap();
    assert!(drawing.matches("h0").count() == known && longest > 10 * known, "{known} {longest}");
    for name in ["fit.png", "profile.png"] {
        let bytes = std::fs::read(out.join(name)).unwrap();
        assert!(
            bytes.starts_with(b"\x89PNG") && bytes.ends_with(b"IEND\xae\x42\x60\x82"),
            "{name}"
        );
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
        (&["--law", "hooke", "--prior", "young=2 nm:1 nm"], "unit of length"),
        (&["--law", "hooke", "--prior", "yung=2 GPa:1 GPa"], "allowed: young, thickness"),
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

/// The curve of `CURVE` as an archive of JPK: integers of 4 bytes, 0.1 uV of deflection and 2 fm of height to a count.
fn archive() -> Archive {
    const SENSITIVITY: f64 = 6e-8;
    let (volt, metre, stiffness) = (1e-7, 2e-15, 1.2);
    let mut archive = Archive::new(Common::Shared);
    archive.encode(Samples::SignedInteger, false);
    for (channel, multiplier) in [("vDeflection", volt), ("measuredHeight", metre)] {
        archive.set(channel, "encoder.scaling.multiplier", &format!("{multiplier:e}"));
        archive.set(channel, "encoder.scaling.offset", "0");
    }
    archive.conversion("vDeflection", "distance", SENSITIVITY, 0.0);
    archive.conversion("vDeflection", "force", stiffness, 0.0);
    archive.conversion("measuredHeight", "nominal", 1.0, 8e-6);
    archive.remove_channel("height");
    let text = std::fs::read_to_string(CURVE).unwrap();
    let rows = || text.lines().filter(|line| !line.starts_with('#'));
    for (segment, name) in ["False", "True"].into_iter().enumerate() {
        let of = |column: usize, count: f64, offset: f64| -> Vec<i64> {
            rows()
                .map(|row| row.split('\t').collect::<Vec<_>>())
                .filter(|row| row[2] == name)
                .map(|row| ((row[column].parse::<f64>().unwrap() - offset) / count).round() as i64)
                .collect()
        };
        archive.raw(segment, "vDeflection", &of(0, volt * SENSITIVITY * stiffness, 0.0));
        archive.raw(segment, "measuredHeight", &of(1, metre, 8e-6));
    }
    archive
}

#[test]
fn an_archive_gives_the_shell_that_its_table_gives() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("lab.toml"), LAB).unwrap();
    std::fs::write(folder.path().join("a.jpk-force"), archive().zip()).unwrap();
    let mut uncalibrated = archive();
    uncalibrated.undefine("vDeflection", "distance");
    uncalibrated.undefine("vDeflection", "force");
    std::fs::write(folder.path().join("volts.jpk-force"), uncalibrated.zip()).unwrap();
    let fit = |curve: &str, more: &[&str]| {
        let base = ["fit", curve, "--known", "lab.toml", "--json", "--profile", "none"];
        arclen(folder.path(), &[&base, more].concat())
    };
    let derived = |output: Output| -> Vec<f64> {
        assert_eq!(output.status.code(), Some(0), "{}", words(&output));
        let json: Value = serde_json::from_slice(&output.stdout).unwrap();
        let own = json["derived"].as_array().unwrap().iter();
        own.map(|e| e["value"].as_f64().unwrap()).collect()
    };
    let table = derived(fit(CURVE, &[]));
    let known =
        ["--set", "instrument.sensitivity=60 nm/V", "--set", "instrument.spring_constant=1.2 N/m"];
    let prior =
        ["--set", "instrument.sensitivity=60 nm/V", "--prior", "spring_constant=1.2 N/m:0.06 N/m"];
    let archives =
        [("a.jpk-force", &[][..]), ("volts.jpk-force", &known), ("volts.jpk-force", &prior)];
    for (curve, more) in archives {
        for (value, wanted) in derived(fit(curve, more)).into_iter().zip(&table) {
            // a count is 7 fN, far below the noise
            assert!((value / wanted - 1.0).abs() < 1e-3, "{curve}: {value:e} {wanted:e}");
        }
    }
    let refused = fit("volts.jpk-force", &[]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(words(&refused).contains("--set instrument.sensitivity="), "{}", words(&refused));
    let refused = fit("volts.jpk-force", &["--set", "instrument.sensitivity=60 nm"]);
    assert!(words(&refused).contains("expected a sensitivity such as \"60 nm/V\""));
}

#[test]
fn all_curves_of_a_map_are_fitted_unless_one_is_chosen() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("lab.toml"), LAB).unwrap();
    let mut map = archive();
    map.map(&[3, 17]);
    // a measurement that was broken off
    map.entry("index/17/segments/1/channels/vDeflection.dat", Some(vec![0; 12]));
    std::fs::write(folder.path().join("m.jpk-force-map"), map.zip()).unwrap();
    let fit = |more: &[&str]| {
        let base = ["fit", "m.jpk-force-map", "--known", "lab.toml", "--profile", "none"];
        arclen(folder.path(), &[&base, more].concat())
    };
    let output = fit(&["--out", "all"]);
    assert_eq!(output.status.code(), Some(3), "{}", words(&output));
    let place = "m.jpk-force-map, curve 17: index/17/segments/1/channels/vDeflection.dat: 12 bytes";
    assert!(words(&output).contains(place), "{}", words(&output));
    let table = std::fs::read_to_string(folder.path().join("all/fits.csv")).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    assert!(lines.len() == 3 && lines[1].contains(",m-3,fitted,false,"), "{table}");
    assert!(folder.path().join("all/m-3/fit.json").is_file());
    let output = fit(&["--set", "data.curve=3", "--out", "one"]);
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    assert!(folder.path().join("one/fit.json").is_file());
}
