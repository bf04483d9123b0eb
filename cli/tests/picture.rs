//! How pictures look: every command that draws obeys `[picture]` and `--picture`.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn arclen(arguments: &[&str], out: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_arclen"));
    command.args(arguments).arg("--out").arg(out).output().unwrap()
}

/// A sweep over a plane of two keys.
const SWEEP: &str = "problem = \"contact\"
[shell]
law = \"hooke\"
[dimensionless]
bending = 3e-5
pressure = 3e-3
adhesion = 2e-3
film = 0.0333
[mesh]
elements = 30
[path]
start = 1.15
end = 0.9
[stability]
scan = \"axisymmetric\"
[picture]
height = 321
[[vary]]
key = \"dimensionless.bending\"
values = [3e-5, 6e-5]
[[vary]]
key = \"dimensionless.pressure\"
values = [3e-3, 6e-3]
";

#[test]
fn every_command_that_draws_obeys() {
    let place = tempfile::tempdir().unwrap();
    let sweep = place.path().join("plane.toml");
    fs::write(&sweep, SWEEP).unwrap();
    let small = ["--elements", "40", "--set", "path.end=0.8"];
    let cases: [(&[&str], &[&str]); 7] = [
        (&["trace", "fig06"], &["force_distance", "energies", "film_pressure"]),
        (&["trace", "cusp"], &["diagram"]),
        (&["diagram", "cusp"], &["diagram"]),
        (&["orbits", "brusselator"], &["diagram", "period", "time-1", "phase-1"]),
        (&["cycle", "fig06"], &["loop"]),
        (&["map", "cusp", "--over", "lambda"], &["map"]),
        (&["sweep", sweep.to_str().unwrap()], &["phase"]),
    ];
    for (k, (words, pictures)) in cases.into_iter().enumerate() {
        let out = place.path().join(k.to_string());
        let more: &[&str] = if words[1] == "fig06" { &small } else { &[] };
        let looks =
            ["-q", "--format", "svg,pdf", "--picture", "width=234", "--picture", "grid=false"];
        let output = arclen(&[words, more, &looks].concat(), &out);
        assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
        for picture in pictures {
            let svg = fs::read_to_string(out.join(format!("{picture}.svg"))).unwrap();
            assert!(svg.contains("width=\"234.0\" height=\""), "{words:?} {picture}");
            // the grid's grey
            assert!(!svg.contains("stroke=\"#e4e4e4\""), "{words:?} {picture}");
            let high = svg.contains("height=\"321.0\"");
            assert_eq!(high, words[0] == "sweep", "{words:?} {picture}");
            let pdf = fs::read(out.join(format!("{picture}.pdf"))).unwrap();
            assert_eq!(&pdf[..5], b"%PDF-", "{words:?} {picture}");
        }
    }
    let out = place.path().join("figure");
    let figure = ["figure", "12", "--elements", "40", "-q", "--format", "svg,pdf"];
    let output = arclen(
        &[&figure[..], &["--picture", "width=234", "--picture", "title=false"]].concat(),
        &out,
    );
    assert!(output.status.code().is_some_and(|code| code != 2), "{output:?}");
    let svg = fs::read_to_string(out.join("fig12.svg")).unwrap();
    assert!(svg.contains("width=\"236.0\"") && !svg.contains("Figure 12"));
    assert!(out.join("fig12.pdf").exists());
}

#[test]
fn what_is_wrong_is_said_before_anything_is_computed() {
    let place = tempfile::tempdir().unwrap();
    let out = place.path().join("out");
    for (words, said) in [
        (
            &["trace", "fig12", "--picture", "width=3"][..],
            "fig12, --picture: picture.width = 3: must be a whole number from 150 to 4000",
        ),
        (
            &["cycle", "fig12", "--picture", "legends=true"],
            "picture.legends: unknown key (did you mean \"legend\"?)",
        ),
        (
            &["map", "cusp", "--over", "lambda", "--picture", "y=z0"],
            "picture.y = z0: must be one of mu, x, unstable",
        ),
        (&["figure", "12", "--picture", "font_size=big"], "pictures, --picture: picture.font_size"),
        (&["figure", "12", "--picture", "x=z0"], "these pictures have axes of their own"),
        (&["trace", "fig12", "--picture", "x_from"], "--picture picture.x_from"),
    ] {
        let output = arclen(words, &out);
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{words:?}: {text}");
        assert!(text.contains(said), "{words:?}: {text}");
        assert!(!out.exists(), "{words:?}");
    }
}

#[test]
fn physical_units_stand_beside_the_dimensionless_ones_everywhere() {
    let place = tempfile::tempdir().unwrap();
    let small = ["--elements", "60", "--set", "path.end=1.0", "--set", "path.start=1.2"];
    let names = |folder: &Path| -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    };
    for (command, files, said) in [
        ("trace", &["branch-physical.csv", "force_distance-physical.svg"][..], "z0 [nm]"),
        ("cycle", &["cycle-physical.csv", "branch-physical.csv", "loop-physical.svg"], "nN at"),
        ("diagram", &["branch-0-physical.csv", "diagram-physical.svg"], "complete"),
    ] {
        let out = place.path().join(command);
        let output = arclen(&[&[command, "polymer"][..], &small].concat(), &out);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(text.contains(said), "{command}: {text}");
        let there = names(&out);
        for file in files {
            assert!(there.iter().any(|name| name == file), "{command}: {file}: {there:?}");
        }
    }
    let out = place.path().join("map");
    let words = ["map", "polymer", "--over", "adhesion", "--set", "physical.adhesion=0.5 N/m"];
    let output = arclen(&[&words[..], &["--elements", "100", "-q"]].concat(), &out);
    assert!(output.status.code() != Some(2), "{output:?}");
    assert!(names(&out).contains(&"map-physical.svg".to_owned()), "{:?}", names(&out));
    let table = fs::read_to_string(out.join("fold-0-physical.csv")).unwrap();
    assert!(table.starts_with("point,z0_nm,adhesion_N_per_m,force_"), "{table}");
    // the same numbers, in nanometres and nanonewtons
    let read = |folder: &str, file: &str, column: &str| -> Vec<f64> {
        let mut table = csv::Reader::from_path(place.path().join(folder).join(file)).unwrap();
        let at = table.headers().unwrap().iter().position(|name| name == column).unwrap();
        table.records().map(|row| row.unwrap()[at].parse().unwrap()).collect()
    };
    for (folder, plain) in [("trace", "branch"), ("cycle", "cycle"), ("diagram", "branch-0")] {
        let z0 = read(folder, &format!("{plain}.csv"), "z0");
        let physical = read(folder, &format!("{plain}-physical.csv"), "z0_nm");
        assert_eq!(z0.len(), physical.len());
        let near = |(z, nm): (&f64, &f64)| (nm / (1500.0 * z) - 1.0).abs() < 1e-12;
        assert!(z0.iter().zip(&physical).all(near), "{folder}");
    }
}
