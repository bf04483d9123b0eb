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
        assert!(["paper", "ours"].contains(&claim["source"].as_str().unwrap()), "{claim}");
    }
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(
        shown.contains("claims of the paper: ") && shown.contains("ours, no sentence"),
        "{shown}"
    );
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
    let tolerance = Value::from("±17 % (limit point)");
    // limit points have one tolerance
    for statement in ["a limit point at d = 0.07", "… and F = 2.5", "the branch turns down until"]
    {
        let claim = of(statement);
        assert_eq!((&claim["verdict"], &claim["tolerance"]), (&"agrees".into(), &tolerance));
    }

    // a case of a figure can be traced, and varied
    let again = ["trace", "o/cases/fig12-strong.toml", "--elements", "60", "--json", "--quiet"];
    let traced: Value = serde_json::from_slice(&arclen(place.path(), &again).stdout).unwrap();
    assert_eq!(traced["stopped_because"], "target");
}

/// What rests on stability counts every kind of mode, and every window stands in its row.
#[test]
fn claims_say_how_they_are_measured_and_rest_on_all_modes() {
    let place = tempfile::tempdir().unwrap();
    let line = "figure 6 10 12 18 --elements 200 --no-pictures --out o";
    let output = arclen(place.path(), &line.split(' ').collect::<Vec<_>>());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stdout));
    let claims = read(&place.path().join("o/claims.json"));
    let claims = claims["claims"].as_array().unwrap();
    let rows = |figure: u64, words: &str| -> Vec<(f64, String, String, String)> {
        let own = claims.iter().filter(|c| c["figure"] == figure);
        let text = |c: &Value, key: &str| c[key].as_str().unwrap().to_owned();
        own.filter(|c| c["statement"].as_str().unwrap().contains(words))
            .map(|c| {
                let [verdict, source, measured] =
                    ["verdict", "source", "measured"].map(|key| text(c, key));
                (c["ours"].as_f64().unwrap(), verdict, source, measured)
            })
            .collect()
    };
    // (figure, words, number, its tolerance, verdict, source, what stands in the row)
    for (figure, words, known) in [
        (
            12,
            "expected to become unstable",
            &[(13.0, 0.1, "agrees", "0.08252 to 0.1117"), (1.0, 1e-12, "agrees", "0.08252")][..],
        ),
        (
            18,
            "cubic",
            &[(2.500, 2e-3, "disagrees", "0.2 to 0.38"), (2.717_98, 2e-3, "agrees", "0.3")],
        ),
        (
            6,
            "Δ^(1/2)",
            &[
                (0.693, 2e-3, "disagrees", "of the deformation"),
                (0.627, 2e-3, "disagrees", "0.01074 R0"),
                (0.535, 5e-3, "agrees", "0.02344 R0"),
            ],
        ),
        (
            6,
            "same order",
            &[(0.380, 1e-3, "agrees", "= 0.4"), (0.0905, 1e-3, "disagrees", "= 0.244")],
        ),
        (
            10,
            "2.5 h/R0 (k_b = 3e-5)",
            &[
                (3.053, 5e-3, "agrees", "half of its largest"),
                (3.03, 0.02, "agrees", "strongest curvature"),
                (2.783, 5e-3, "agrees", "back at 8"),
            ],
        ),
        (10, "entire range", &[(1.675, 1e-3, "disagrees", "0.35")]),
    ] {
        let found = rows(figure, words);
        assert_eq!(found.len(), known.len(), "{words}: {found:?}");
        for ((ours, verdict, source, measured), (number, by, said, window)) in
            found.iter().zip(known)
        {
            assert!((ours - number).abs() < *by, "{words}: {ours}, {measured}");
            assert_eq!((&verdict[..], &source[..]), (*said, "paper"), "{words}");
            assert!(measured.contains(window), "{window}: {measured}");
        }
    }
    let (_, verdict, source, _) = &rows(6, "one stable branch")[0];
    assert_eq!((&verdict[..], &source[..]), ("disagrees", "ours"));

    // without those modes nothing is known
    let line = "figure 7 12 --elements 60 --no-pictures --set stability.scan=axisymmetric --out a";
    let output = arclen(place.path(), &line.split(' ').collect::<Vec<_>>());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stdout));
    let claims = read(&place.path().join("a/claims.json"));
    for words in ["stable throughout", "expected to become unstable", "loses its circular shape"] {
        let own = claims["claims"].as_array().unwrap().iter();
        let own: Vec<_> =
            own.filter(|c| c["statement"].as_str().unwrap().contains(words)).collect();
        assert!(!own.is_empty() && own.iter().all(|c| c["verdict"] == "cannot-be-decided"));
    }
}

/// The figure that is not of the paper: every window of instability, and its ends.
#[test]
fn windows_of_instability_are_those_of_another_solver() {
    let place = tempfile::tempdir().unwrap();
    let arguments = ["figure", "stability", "--elements", "200", "--out", "o"];
    let output = arclen(place.path(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stdout));
    let out = place.path().join("o");
    for name in ["stability.svg", "stability.png", "index.html", "data/stability-c.csv"] {
        assert!(fs::metadata(out.join(name)).unwrap().len() > 1000, "{name}");
    }
    let page = fs::read_to_string(out.join("index.html")).unwrap();
    for link in page.split("href=\"").skip(1).map(|rest| rest.split('"').next().unwrap()) {
        assert!(link.starts_with('#') || out.join(link).is_file(), "{link}");
    }
    assert_eq!(read(&out.join("figures.json"))["figures"][0]["figure"], "stability");
    let table = fs::read_to_string(out.join("data/stability-windows.csv")).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|l| l.split(',').collect()).collect();
    let (onset, end) = ("onset", "end of branch");
    for (curve, n, parity, from, to, words) in [
        ("fig06", "0", "antisymmetric", 1.06, 1.033_367_373_8, [end, onset]),
        ("fig06", "4", "symmetric", 0.783_226_730_7, 0.65, [onset, end]),
        ("fig07", "0", "antisymmetric", 1.2, 1.051_748_457_5, [end, onset]),
        ("fig12", "2", "symmetric", 0.870_433_406_4, 0.728_624_141_6, [onset, onset]),
        ("fig12", "2", "antisymmetric", 0.870_442_532_6, 0.729_626_278_4, [onset, onset]),
        ("fig12", "12", "symmetric", 0.649_891_234_4, 0.6, [onset, end]),
        // between the folds
        ("fig12", "0", "symmetric", 0.818_761_9, 0.873_240_6, [onset, onset]),
        ("fig16", "0", "antisymmetric", 1.112_531_532_5, 1.062_917_422_4, [onset, onset]),
    ] {
        let near = |cell: &str, known: f64| (cell.parse::<f64>().unwrap() - known).abs() < 1e-7;
        let found = rows.iter().filter(|r| r[..3] == [curve, n, parity]);
        let found: Vec<_> = found.filter(|r| near(r[3], from) && near(r[4], to)).collect();
        assert_eq!(found.len(), 1, "{curve} {n} {parity} {from}: {table}");
        assert_eq!(found[0][7..], words, "{curve} {n} {parity}");
    }
    // soft shells keep their circular shape; no shell has a window of one wave
    let soft = rows.iter().filter(|r| r[0] == "fig07" || r[0] == "fig16");
    assert!(soft.clone().count() == 4 && soft.clone().all(|r| r[1] == "0"), "{table}");
    assert!(rows.iter().all(|r| r[1] != "1"), "{table}");
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
