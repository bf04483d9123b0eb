//! Curves as laboratories sometimes have them: refused with file, key and remedy, or fitted with warnings.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

const CURVE: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/../identify/tests/data/open-1-hard-knee.tab");
const LAB: &str = "[instrument]\nspring_constant = \"1.2 N/m\"\nspring_constant_sd = \"5 %\"\n[shell]\nlaw = \"hooke\"\n\
                   [physical]\nradius = \"1.58 um\"\nradius_sd = \"50 nm\"\n";
/// Height at which the good curve meets the shell, m.
const CONTACT: f64 = 7.8e-6;

/// A sample: whether on the way out, height, force.
type Sample = (bool, f64, f64);

fn good() -> Vec<Sample> {
    let text = std::fs::read_to_string(CURVE).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with('#'));
    rows.map(|row| {
        let fields: Vec<&str> = row.split('\t').collect();
        (fields[2] == "True", fields[1].parse().unwrap(), fields[0].parse().unwrap())
    })
    .collect()
}

fn changed(change: impl Fn(Sample) -> Sample) -> Vec<Sample> {
    good().into_iter().map(change).collect()
}

fn kept(keep: impl Fn(&Sample) -> bool) -> Vec<Sample> {
    good().into_iter().filter(|sample| keep(sample)).collect()
}

fn fit(folder: &Path, name: &str, samples: &[Sample], more: &[&str]) -> Output {
    let mut text = "segment,height_m,force_N\n".to_owned();
    for (out, height, force) in samples {
        let segment = if *out { "retract" } else { "approach" };
        text.push_str(&format!("{segment},{height:e},{force:e}\n"));
    }
    let curve = format!("{name}.csv");
    std::fs::write(folder.join(&curve), text).unwrap();
    std::fs::write(folder.join("lab.toml"), LAB).unwrap();
    let base = ["fit", &curve, "--known", "lab.toml", "--out", name, "--profile", "none"];
    Command::new(env!("CARGO_BIN_EXE_arclen"))
        .current_dir(folder)
        .args([&base, more].concat())
        .output()
        .unwrap()
}

fn words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn what_no_fit_can_use_is_named_with_file_key_and_remedy() {
    let folder = tempfile::tempdir().unwrap();
    // by what is left of a cube, which is as good as chance
    let mut shuffled: Vec<(usize, Sample)> =
        good().into_iter().enumerate().map(|(at, sample)| (at.pow(3) % 1009, sample)).collect();
    shuffled.sort_by_key(|(key, _)| *key);
    let shuffled = shuffled.into_iter().map(|(_, sample)| sample).collect();
    let mut sorted = kept(|(out, ..)| !out);
    sorted.sort_by(|a, b| a.1.total_cmp(&b.1));
    let far = |s: &Sample| s.1 > CONTACT;
    let mut few = kept(|s| !s.0 && far(s));
    few.extend(kept(|s| !s.0 && !far(s)).into_iter().take(6));
    let cases: Vec<(&str, Vec<Sample>, &[&str])> = vec![
        (
            "nan",
            changed(|(o, h, f)| (o, h, if h < 7.2e-6 { f64::NAN } else { f })),
            &["line ", "force_N = \"NaN\"", "finite number"],
        ),
        (
            "endless",
            changed(|(o, h, f)| (o, if h < 7.2e-6 { f64::INFINITY } else { h }, f)),
            &["height_m = \"inf\"", "finite number"],
        ),
        ("shuffled", shuffled, &["to and fro", "order of time"]),
        ("sorted", sorted, &["data.height=rises", "if its lines were sorted"]),
        ("flipped", changed(|(o, h, f)| (o, h, -f)), &["data.force_sign=-1"]),
        (
            "strong",
            changed(|(o, h, f)| (o, h, 1e9 * f)),
            &["data.force_unit", "instrument.spring_constant"],
        ),
        (
            "faint",
            changed(|(o, h, f)| (o, h, 1e-9 * f)),
            &["data.force_unit", "instrument.spring_constant"],
        ),
        ("long", changed(|(o, h, f)| (o, 1e9 * h, f)), &["data.height_unit", "physical.radius"]),
        (
            "micrometres",
            changed(|(o, h, f)| (o, 1e3 * h, f)),
            &["only 3.160e-6 m thick", "data.height_unit"],
        ),
        ("short", changed(|(o, h, f)| (o, 1e-9 * h, f)), &["one of the units is wrong"]),
        (
            "deep",
            kept(|(_, h, _)| *h < 7.75e-6),
            &["samples of baseline before contact", "start farther away"],
        ),
        ("shy", kept(far), &["no contact", "data.force_sign"]),
        ("few", few, &["samples in contact; at least 12 are needed", "measure farther or denser"]),
        ("five", good().into_iter().take(5).collect(), &["no segment has 8 samples"]),
        ("constant", changed(|(o, h, _)| (o, h, 1e-9)), &["the force is constant"]),
        ("nothing", Vec::new(), &["no samples"]),
    ];
    for (name, samples, expected) in cases {
        let output = fit(folder.path(), name, &samples, &[]);
        let message = words(&output);
        assert_eq!(output.status.code(), Some(2), "{name}: {message}");
        for part in
            [format!("{name}.csv")].iter().map(String::as_str).chain(expected.iter().copied())
        {
            assert!(message.contains(part), "{name}: {part}: {message}");
        }
        assert!(!folder.path().join(name).exists(), "{name}");
    }
}

fn report(folder: &Path, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join(name).join("fit.json")).unwrap()).unwrap()
}

fn warned(report: &Value, code: &str) -> bool {
    report["warnings"].as_array().unwrap().iter().any(|warning| warning["code"] == code)
}

/// Whether the 95 % interval of Young's modulus holds 1.7 GPa.
fn holds_the_truth(report: &Value) -> bool {
    let derived = report["derived"].as_array().unwrap();
    let young = derived.iter().find(|e| e["key"] == "young").unwrap();
    let [low, high] = [0, 1].map(|end| young["interval95"][end].as_f64().unwrap());
    low < 1.7e9 && 1.7e9 < high
}

#[test]
fn one_segment_alone_is_fitted_drawn_and_told() {
    let folder = tempfile::tempdir().unwrap();
    for (name, out) in [("approach", false), ("retract", true)] {
        let output = fit(folder.path(), name, &kept(|s| s.0 == out), &[]);
        assert_eq!(output.status.code(), Some(0), "{name}: {}", words(&output));
        let report = report(folder.path(), name);
        assert!(warned(&report, "one-segment") && holds_the_truth(&report), "{name}");
        let drawing = std::fs::read_to_string(folder.path().join(name).join("fit.svg")).unwrap();
        assert!(drawing.contains(&format!("model, {name}")), "{name}");
    }
}

#[test]
fn outliers_fail_a_fit_of_squares_and_not_a_robust_one() {
    let folder = tempfile::tempdir().unwrap();
    // every tenth sample off by 20 nN, a hundred times the noise
    let samples: Vec<Sample> = good()
        .into_iter()
        .enumerate()
        .map(|(at, (o, h, f))| (o, h, if at % 10 == 3 { f + 2e-8 } else { f }))
        .collect();
    let output = fit(folder.path(), "squares", &samples, &[]);
    assert_eq!(output.status.code(), Some(3), "{}", words(&output));
    let squares = report(folder.path(), "squares");
    assert!(warned(&squares, "outliers") && warned(&squares, "poor-fit"));
    let output = fit(folder.path(), "robust", &samples, &["--robust"]);
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    let robust = report(folder.path(), "robust");
    assert!(warned(&robust, "outliers") && holds_the_truth(&robust));
}
