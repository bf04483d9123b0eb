//! What traces and diagrams of a shell say about modes without its symmetries.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests")]

use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn arclen(folder: &Path, arguments: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_arclen"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    output
}

fn json(file: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

/// Cells by the names of their columns, row by row.
fn rows(file: &Path) -> Vec<BTreeMap<String, String>> {
    let text = fs::read_to_string(file).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect());
    let titles: Vec<String> = lines.next().unwrap();
    lines.map(|cells: Vec<String>| titles.iter().cloned().zip(cells).collect()).collect()
}

fn count(row: &BTreeMap<String, String>, column: &str) -> u64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column} = {:?}", row[column]))
}

fn breaking(events: &Value) -> Vec<&Value> {
    events.as_array().unwrap().iter().filter(|e| e["kind"] == "symmetry-breaking").collect()
}

/// The columns of every row follow from the events: no count changes between them.
fn agree(rows: &[BTreeMap<String, String>], events: &Value) {
    let mut counts: BTreeMap<(u64, String), u64> = BTreeMap::new();
    let class = |e: &Value| (e["n"].as_u64().unwrap(), e["parity"].as_str().unwrap().to_owned());
    for event in breaking(events) {
        counts.entry(class(event)).or_insert(event["modes_before"].as_u64().unwrap());
    }
    let mut waiting = breaking(events).into_iter();
    for row in rows {
        if row["event"] == "symmetry-breaking" {
            let event = waiting.next().unwrap();
            let now = counts.get_mut(&class(event)).unwrap();
            assert_eq!(*now, event["modes_before"].as_u64().unwrap(), "{event}");
            *now = event["modes_after"].as_u64().unwrap();
            assert_ne!(event["modes_before"], event["modes_after"]);
            assert!(event["error_estimate"].as_f64().unwrap() < 1e-9, "{event}");
            assert!(event["residual"].as_f64().unwrap() < 1e-9, "{event}");
            assert_eq!(event["unstable_before"], event["unstable_after"], "{event}");
            assert_eq!(row["z0"].parse::<f64>().unwrap(), event["z0"].as_f64().unwrap());
            continue;
        }
        let waves = counts.iter().filter(|((n, _), _)| *n > 0);
        let modes: u64 = waves.clone().map(|(_, count)| count).sum();
        let first = waves.filter(|(_, count)| **count > 0).map(|((n, _), _)| *n).min();
        let odd = counts.get(&(0, "antisymmetric".to_owned())).copied().unwrap_or(0);
        let point = &row["point"];
        assert_eq!(count(row, "unstable_antisymmetric"), odd, "point {point}");
        assert_eq!(count(row, "unstable_modes"), modes, "point {point}");
        assert_eq!(row["first_n"].parse().ok(), first, "point {point}");
        let stable = count(row, "unstable") + odd + modes == 0;
        assert_eq!(row["stable"], if stable { "yes" } else { "no" }, "point {point}");
    }
    assert!(waiting.next().is_none());
}

/// `modes.csv` has the mode of every loss of symmetry at every knot: as large as one, with the end
/// conditions of its class.
fn modes_are_drawn_at_every_loss(out: &Path) {
    let events = json(&out.join("events.json"));
    let events = events["events"].as_array().unwrap();
    let mut reader = fs::read_to_string(out.join("modes.csv")).unwrap();
    assert!(reader.starts_with("event,n,parity,s,u,v,w\n"));
    let body = reader.split_off(reader.find('\n').unwrap() + 1);
    let mut by_event: BTreeMap<usize, Vec<Vec<&str>>> = BTreeMap::new();
    for line in body.lines() {
        let cells: Vec<&str> = line.split(',').collect();
        by_event.entry(cells[0].parse().unwrap()).or_default().push(cells);
    }
    let breaking: Vec<usize> =
        (0..events.len()).filter(|k| events[*k]["kind"] == "symmetry-breaking").collect();
    assert_eq!(by_event.keys().copied().collect::<Vec<_>>(), breaking);
    for (event, rows) in by_event {
        assert_eq!(rows.len(), 201);
        let event = &events[event];
        let number = |row: &[&str], k: usize| row[k].parse::<f64>().unwrap();
        assert_eq!(number(&rows[0], 1), event["n"].as_f64().unwrap());
        assert_eq!(rows[0][2], event["parity"].as_str().unwrap());
        let largest = rows.iter().map(|row| number(row, 6).abs()).fold(0.0, f64::max);
        assert!((largest - 1.0).abs() < 1e-12, "{event}: {largest}");
        let (pole, equator) = (&rows[0], &rows[200]);
        assert_eq!(number(pole, 3), 0.0);
        // a mode with waves has no height on the axis; at the equator its parity decides
        assert!(event["n"] == 0 || number(pole, 6).abs() < 1e-9, "{event}");
        let zero = if event["parity"] == "symmetric" { 6 } else { 4 };
        assert!(number(equator, zero).abs() < 1e-9, "{event}");
    }
}

#[test]
fn a_hard_shell_says_where_it_loses_its_symmetries() {
    let place = tempfile::tempdir().unwrap();
    let output = arclen(place.path(), &["trace", "fig12", "--elements", "200", "--out", "o"]);
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(shown.contains("n = 2 antisymmetric: 0 → 1"), "{shown}");
    assert!(shown.contains("stability: with and without symmetry, torsion left out\n"), "{shown}");
    let out = place.path().join("o");
    modes_are_drawn_at_every_loss(&out);
    let events = json(&out.join("events.json"));
    let stability = &events["stability"];
    assert_eq!((&stability["scan"], &stability["certain"]), (&"full".into(), &true.into()));
    assert_eq!(stability["not_located"], 0);
    assert!(stability["max_n"].as_u64().unwrap() >= 23);
    // an independent solver's, on as many elements
    let known = [
        (0, "antisymmetric", 1, 0, 1.030_245_113_687_822, 1e-8),
        (0, "antisymmetric", 0, 1, 0.818_761_892_820_134, 1e-8),
        (0, "antisymmetric", 1, 0, 0.873_037_246_214_319, 1e-8),
        (2, "antisymmetric", 0, 1, 0.870_442_532_599_110, 2e-9),
        (2, "symmetric", 0, 1, 0.870_433_406_386_868, 2e-9),
        (3, "antisymmetric", 0, 1, 0.862_890_273_041_686, 2e-9),
    ];
    let all = breaking(&events["events"]);
    for (event, (n, parity, before, after, z0, tolerance)) in all.iter().zip(known) {
        assert_eq!((&event["n"], &event["parity"]), (&n.into(), &parity.into()));
        assert_eq!(event["modes_before"], before, "{event}");
        assert_eq!(event["modes_after"], after, "{event}");
        assert!((event["z0"].as_f64().unwrap() - z0).abs() < tolerance, "{event}");
    }
    assert_eq!(all.len(), 27);
    let rows = rows(&out.join("branch.csv"));
    agree(&rows, &events["events"]);
    // stable between pull-off and the first fold only, and for a moment behind the second
    let words: Vec<&str> = rows.iter().map(|row| row["stable"].as_str()).collect();
    assert!(words.contains(&"yes") && words.first() == Some(&"no") && words.last() == Some(&"no"));
    let buckled = rows.iter().filter(|r| r["z0"].parse::<f64>().unwrap() < 0.815);
    assert!(buckled.clone().count() > 15 && buckled.clone().all(|r| r["stable"] == "no"));
    assert!(buckled.clone().all(|r| r["unstable"] == "0"));
    for file in ["force_distance.svg", "force_deformation.svg", "energies.svg"] {
        let picture = fs::read_to_string(out.join(file)).unwrap();
        for words in [
            ">stable</text>",
            "unstable to axisymmetric modes",
            "unstable to asymmetric modes only",
        ] {
            assert!(picture.contains(words), "{file}: {words}");
        }
    }
    assert!(
        fs::read_to_string(out.join("force_distance.svg")).unwrap().contains("symmetry-breaking")
    );
}

#[test]
fn a_soft_shell_loses_its_equatorial_symmetry_outside_pull_off_only() {
    let place = tempfile::tempdir().unwrap();
    let set = ["--set", "path.start=1.2", "--elements", "200", "--out", "o", "--no-pictures"];
    arclen(place.path(), &[&["trace", "fig07"][..], &set].concat());
    let events = json(&place.path().join("o/events.json"));
    let all = breaking(&events["events"]);
    assert_eq!(all.len(), 1);
    let found = all[0]["z0"].as_f64().unwrap();
    assert!((found - 1.051_748_457_489_736).abs() < 1e-9, "{found}");
    let rows = rows(&place.path().join("o/branch.csv"));
    agree(&rows, &events["events"]);
    assert_eq!(rows.last().unwrap()["stable"], "yes");
}

/// Shells that nobody chose: each count follows from the events along the whole branch.
#[test]
fn counts_of_random_shells_change_at_events_only() {
    let place = tempfile::tempdir().unwrap();
    let mut state = 2026_u64;
    let mut next = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut waves = 0;
    for shell in 0..5 {
        let bending = 10.0_f64.powf(-4.8 + 1.5 * next());
        let sets = [
            format!("shell.poisson={:.3}", 0.2 + 0.3 * next()),
            format!("dimensionless.bending={bending:.3e}"),
            format!("dimensionless.adhesion={:.3e}", bending * 10.0_f64.powf(-1.0 + 2.5 * next())),
            format!("dimensionless.film={:.4}", 0.02 + 0.03 * next()),
            format!("dimensionless.pressure={:.4}", 0.1 * next()),
            format!("dimensionless.surface_tension={:.4}", 0.003 * next()),
        ];
        let mut arguments =
            vec!["trace", "fig12", "--elements", "80", "--out", "o", "--no-pictures", "--quiet"];
        sets.iter().for_each(|set| arguments.extend(["--set", set]));
        arclen(place.path(), &arguments);
        let events = json(&place.path().join("o/events.json"));
        assert_eq!(events["stability"]["certain"], true, "shell {shell}: {sets:?}");
        agree(&rows(&place.path().join("o/branch.csv")), &events["events"]);
        waves += breaking(&events["events"]).iter().filter(|e| e["n"] != 0).count();
    }
    assert!(waves > 0, "none of the shells wrinkles");
}

#[test]
fn an_axisymmetric_scan_says_so_everywhere() {
    let place = tempfile::tempdir().unwrap();
    for command in ["trace", "diagram"] {
        let set =
            ["--elements", "50", "--set", "stability.scan=\"axisymmetric\"", "--out", command];
        let output = arclen(place.path(), &[&[command, "fig12"][..], &set].concat());
        let shown = String::from_utf8(output.stdout).unwrap();
        assert!(shown.contains("stability: against axisymmetric mirror images only"), "{shown}");
        let out = place.path().join(command);
        let (table, document, picture) = match command {
            "trace" => ("branch.csv", "events.json", "force_distance.svg"),
            _ => ("branch-0.csv", "diagram.json", "diagram.svg"),
        };
        let document = json(&out.join(document));
        assert_eq!(document["stability"], serde_json::json!({ "scan": "axisymmetric" }));
        let rows = rows(&out.join(table));
        assert!(rows.iter().all(|row| !row.contains_key("stable")));
        let picture = fs::read_to_string(out.join(picture)).unwrap();
        assert!(picture.contains("asymmetric modes not examined"), "{command}");
        assert!(!picture.contains(">stable</text>"), "{command}");
        assert!(
            !picture.contains("asymmetric modes only") && !picture.contains("symmetry-breaking")
        );
    }
    let settings = ["--set", "stability.scan=\"axisymmetrical\""];
    let output = Command::new(env!("CARGO_BIN_EXE_arclen"))
        .args([&["check", "fig12"][..], &settings].concat())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("stability.scan") && message.contains("axisymmetric"), "{message}");
}

#[test]
fn a_diagram_counts_what_breaks_symmetry_on_every_branch() {
    let place = tempfile::tempdir().unwrap();
    let output =
        arclen(place.path(), &["diagram", "fig12", "--set", "mesh.elements=100", "--out", "o"]);
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(shown.contains("27 symmetry-breaking"), "{shown}");
    assert!(shown.contains("stability: with and without symmetry, torsion left out\n"), "{shown}");
    let out = place.path().join("o");
    let diagram = json(&out.join("diagram.json"));
    assert_eq!(diagram["stability"]["scan"], "full");
    assert_eq!(diagram["stability"]["certain"], true);
    for branch in diagram["branches"].as_array().unwrap() {
        if branch["symmetry"] == "asymmetric about the equator" {
            // both parities are among the branch's own; waves are counted, and not located
            assert_eq!(branch["stability"]["scan"], "full");
            assert_eq!(branch["stability"]["parities"].as_array().unwrap().len(), 2);
            continue;
        }
        assert_eq!(branch["stability"]["scan"], "full");
        let rows = rows(&out.join(branch["csv"].as_str().unwrap()));
        assert_eq!(rows.len() as u64, branch["points"].as_u64().unwrap());
        agree(&rows, &branch["events"]);
    }
    let picture = fs::read_to_string(out.join("diagram.svg")).unwrap();
    for words in ["unstable to axisymmetric modes", "unstable to asymmetric modes only"] {
        assert!(picture.contains(words), "{words}");
    }
}
