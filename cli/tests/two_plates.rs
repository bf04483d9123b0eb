//! Cases from pole to pole between two plates.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn arclen(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_arclen")).args(arguments).current_dir(folder).output().unwrap()
}

fn json(file: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

/// A column of a table, empty cells as NaN.
fn column(file: &Path, name: &str) -> Vec<f64> {
    let text = fs::read_to_string(file).unwrap();
    let mut lines = text.lines();
    let at = lines.next().unwrap().split(',').position(|title| title == name).unwrap();
    lines.map(|line| line.split(',').nth(at).unwrap().parse().unwrap_or(f64::NAN)).collect()
}

/// Two equal plates, the shell free between them: the symmetric branch with its folds, and a pitchfork
/// at every loss of mirror symmetry, as the independent solver has them on as many elements.
#[test]
fn a_trace_sees_where_mirror_symmetry_is_lost() {
    let place = tempfile::tempdir().unwrap();
    let output = arclen(place.path(), &["trace", "two-plates", "--elements", "200", "--out", "o"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(shown.contains("with and without symmetry, torsion left out"), "{shown}");
    let out = place.path().join("o");
    let titles = fs::read_to_string(out.join("branch.csv")).unwrap();
    let titles: Vec<&str> = titles.lines().next().unwrap().split(',').skip(14).collect();
    let own = ["pole_top", "pole_bottom", "shift", "force_bottom", "contact_radius_bottom"];
    let modes = ["unstable_antisymmetric", "unstable_modes", "first_n", "stable"];
    assert_eq!(titles, [&["contact_radius", "event"][..], &own, &modes].concat());
    let events = json(&out.join("events.json"));
    assert_eq!(events["stability"]["scan"], "full");
    assert_eq!(events["stability"]["parities"], serde_json::json!(["symmetric", "antisymmetric"]));
    let all = events["events"].as_array().unwrap();
    let of = |kind: &str| -> Vec<f64> {
        all.iter().filter(|e| e["kind"] == kind).map(|e| e["z0"].as_f64().unwrap()).collect()
    };
    let known = [1.030_245_113_69, 0.818_761_89, 0.873_037_246_2, 0.821_816_609_7, 0.777_922_861_7];
    let forks = of("branch-point");
    assert_eq!((forks.len(), of("fold").len(), of("pull-off").len()), (5, 2, 1));
    for (found, known) in forks.iter().zip(known) {
        assert!((found - known).abs() < 1e-8, "{found} {known}");
    }
    // everywhere both plates carry the same, and nothing has moved
    let file = out.join("branch.csv");
    for (top, bottom) in column(&file, "force").iter().zip(column(&file, "force_bottom")) {
        assert!((top - bottom).abs() < 1e-8);
    }
    assert!(column(&file, "shift").iter().all(|shift| shift.abs() < 1e-7));
    // what is written resolves to itself
    let written = out.join("case.toml");
    let again = arclen(place.path(), &["check", written.to_str().unwrap()]);
    assert_eq!(again.status.code(), Some(0));
    assert_eq!(String::from_utf8(again.stdout).unwrap(), fs::read_to_string(&written).unwrap());
    for picture in ["force_distance.svg", "shapes.svg"] {
        assert!(out.join(picture).exists(), "{picture}");
    }
    let picture = fs::read_to_string(out.join("force_distance.svg")).unwrap();
    let words = |line: &str| picture.contains(&format!(">{line}</text>"));
    assert!(words("stable"));
    // modes with waves turn where they do about the half shell
    let output = arclen(place.path(), &["trace", "fig12", "--elements", "200", "--out", "h"]);
    assert_eq!(output.status.code(), Some(0));
    let half = json(&place.path().join("h/events.json"));
    let waves = |of: &Value| -> Vec<(i64, f64, i64)> {
        let all = of["events"].as_array().unwrap().iter();
        let turn = |e: &Value| {
            let change = e["modes_after"].as_i64()? - e["modes_before"].as_i64()?;
            Some((e["n"].as_i64().filter(|n| *n > 0)?, e["z0"].as_f64()?, change))
        };
        all.filter_map(turn).collect()
    };
    let (whole, half) = (waves(&events), waves(&half));
    assert!(whole.len() > 20 && whole.len() == half.len(), "{} {}", whole.len(), half.len());
    for (a, b) in whole.iter().zip(&half) {
        // both are enclosed to 1e-10
        assert!(a.0 == b.0 && a.2 == b.2 && (a.1 - b.1).abs() < 3e-10, "{a:?} {b:?}");
    }

    // the same without: said, and drawn as what it is
    let line = "trace two-plates --elements 60 --set stability.scan=axisymmetric --out a";
    let output = arclen(place.path(), &line.split(' ').collect::<Vec<_>>());
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(shown.contains("against axisymmetric modes only, with and without mirror"), "{shown}");
    assert_eq!(json(&place.path().join("a/events.json"))["stability"]["scan"], "axisymmetric");
    let picture = fs::read_to_string(place.path().join("a/force_distance.svg")).unwrap();
    let words = |line: &str| picture.contains(&format!(">{line}</text>"));
    assert!(words("stable to axisymmetric modes") && !words("stable"));
}

/// Under a grip the bubble leaves its mirror image on both ways; what its jumps dissipate is the area of
/// the loop, and the modes that it looks at and those that it only counts are said.
#[test]
fn a_cycle_leaves_the_symmetric_branch_and_comes_back() {
    let place = tempfile::tempdir().unwrap();
    let line = "cycle two-plates --elements 60 --out o --report";
    let output = arclen(place.path(), &line.split(' ').collect::<Vec<_>>());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(shown.contains("against axisymmetric modes with and without mirror"), "{shown}");
    assert!(shown.contains("unstable to others, first on approach"), "{shown}");
    let out = place.path().join("o");
    let cycle = json(&out.join("cycle.json"));
    assert_eq!(cycle["stopped_because"], "closed-loop");
    let ways: Vec<&str> = cycle["jumps"]
        .as_array()
        .unwrap()
        .iter()
        .map(|j| j["direction"].as_str().unwrap())
        .collect();
    assert_eq!(ways, ["approach", "approach", "retract", "retract"]);
    let number = |name: &str| cycle[name].as_f64().unwrap();
    let (lost, area) = (number("dissipated_total"), number("loop_area"));
    assert!(lost > 0.0 && (lost - area).abs() < 1e-6 * lost, "{lost} {area}");
    let followed = &cycle["stability"]["followed"];
    assert_eq!(followed["parities"], serde_json::json!(["symmetric", "antisymmetric"]));
    assert_eq!(cycle["stability"]["scan"], "full");
    assert!(cycle["stability"]["unstable_states"].as_u64().unwrap() > 10);
    // the flat shell is stable to everything, the one with a dimple is not
    let text = fs::read_to_string(out.join("cycle.csv")).unwrap();
    let last: Vec<&str> = text.lines().skip(1).map(|l| l.rsplit(',').next().unwrap()).collect();
    assert!(last.contains(&"no") && last[0] == "yes" && last[last.len() - 1] == "yes");
    for file in ["loop.svg", "jump-4.svg", "report.html", "branch.csv"] {
        assert!(out.join(file).exists(), "{file}");
    }
    // the report has both poles and both plates, and says what is unstable to waves
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    let start = page.find("id=\"data\">").unwrap() + 10;
    let end = start + page[start..].find("</script>").unwrap();
    let data: Value = serde_json::from_str(&page[start..end]).unwrap();
    assert!(
        data["subtitle"].as_str().unwrap().contains("of the complete branch against axisymmetric")
    );
    for curve in data["curves"].as_array().unwrap() {
        let states = curve["states"].as_array().unwrap();
        assert!(states.len() > 20);
        for state in states {
            let (plate, below) =
                (state["plate"].as_f64().unwrap(), state["below"].as_f64().unwrap());
            assert!((plate + below).abs() < 1e-9);
            let z = state["z"].as_array().unwrap();
            let ends = [&z[0], &z[z.len() - 1]].map(|z| z.as_f64().unwrap());
            assert!(below < ends[1] && ends[1] < ends[0] && ends[0] < plate, "{ends:?}");
        }
    }
    let unstable = |curve: usize| -> usize {
        let counts = data["curves"][curve]["unstable"].as_array().unwrap().iter();
        counts.filter(|n| n.as_i64().unwrap() > 0).count()
    };
    let counted = cycle["stability"]["unstable_states"].as_u64().unwrap() as usize;
    // the turn stands on both ways
    assert_eq!(unstable(1) + unstable(2), counted + 1);
}

/// Where no cycle can be it is said why and what to do.
#[test]
fn a_cycle_that_cannot_be_says_what_to_do() {
    let place = tempfile::tempdir().unwrap();
    let refused = |more: &[&str], says: &[&str]| {
        let sets = more.iter().flat_map(|text| ["--set", text]);
        let line = ["cycle", "two-plates", "--elements", "40"];
        let line: Vec<&str> = line.into_iter().chain(sets).collect();
        let output = arclen(place.path(), &line);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{more:?} {error}");
        for words in says {
            assert!(error.contains(words), "{more:?}: {words} in {error}");
        }
    };
    refused(&["path.end=-0.2"], &["path.end", "-0.2", "positive"]);
    refused(&["path.start=0.9"], &["path.start", "0.9", "greater than 1"]);
    refused(&["path.end=1.15"], &["path.end", "different from path.start"]);
    refused(&["plate.bottom.film=0"], &["plate.bottom.film", "positive"]);
    let cantilever = ["plate.top.device=cantilever", "plate.top.stiffness=30"];
    let crossed = [&cantilever[..], &["path.start=-0.5", "path.end=0.5"]].concat();
    refused(&crossed, &["path.start", "-0.5", "the plates cross", "larger path.start"]);
    // no state between plates that attract so strongly
    let strong = ["plate.top.adhesion=0.5", "plate.bottom.adhesion=0.5"];
    refused(&strong, &["path.start = 1.15", "no solution at the start", "larger path.start"]);
}

/// From pull-off the bubble leaves one plate; the diagram has both ways it may take.
#[test]
fn a_diagram_follows_the_bubble_onto_one_plate() {
    let place = tempfile::tempdir().unwrap();
    let line = "diagram two-plates --elements 100 --out o --set path.end=1.0";
    let output = arclen(place.path(), &line.split(' ').collect::<Vec<_>>());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let diagram = json(&place.path().join("o/diagram.json"));
    assert_eq!(diagram["stopped_because"], "complete");
    let branches = diagram["branches"].as_array().unwrap();
    assert_eq!(branches.len(), 3);
    let mut ends = Vec::new();
    for branch in &branches[1..] {
        assert_eq!(branch["from"]["branch"], 0);
        let file = place.path().join("o").join(branch["csv"].as_str().unwrap());
        let (shift, unstable) = (column(&file, "shift"), column(&file, "unstable"));
        // stable at the end, next to one plate
        assert_eq!(unstable.last(), Some(&0.0));
        ends.push(*shift.last().unwrap());
    }
    assert!(ends[0].abs() > 0.05 && (ends[0] + ends[1]).abs() < 1e-6, "{ends:?}");
}

/// One plate, the equator held; and a cantilever above a rigid plate.
#[test]
fn one_plate_and_a_cantilever() {
    let place = tempfile::tempdir().unwrap();
    let case = "problem = \"two-plates\"\nequator = \"held\"\n[shell]\nlaw = \"hooke\"\n\
                [dimensionless]\nbending = 3e-5\npressure = 3e-3\n[plate.top]\nadhesion = 2e-6\n\
                film = 0.0333\n[mesh]\nelements = 60\n[path]\nstart = 1.1\nend = 0.95\n";
    fs::write(place.path().join("one.toml"), case).unwrap();
    let output = arclen(place.path(), &["trace", "one.toml", "--out", "o"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let file = place.path().join("o/branch.csv");
    let last = |name: &str| *column(&file, name).last().unwrap();
    assert!(last("force") > 0.1 && last("force_bottom") == 0.0);
    assert!(last("pole_top") < 0.96 && last("pole_bottom") > 0.99 && last("shift").abs() < 1e-12);
    assert!(column(&file, "unstable").iter().all(|n| *n == 0.0));

    let line = "trace two-plates --elements 60 --out c --set plate.top.device=cantilever \
                --set plate.top.stiffness=30 --set path.start=1.3 --set path.end=1.05";
    let output = arclen(place.path(), &line.split_whitespace().collect::<Vec<_>>());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let file = place.path().join("c/branch.csv");
    let (z0, force, base) = (column(&file, "z0"), column(&file, "force"), column(&file, "base"));
    for k in 0..base.len() {
        // the upper plate alone gives way
        assert!((2.0 * (z0[k] - base[k]) - force[k] / 30.0).abs() < 1e-9);
    }
}

#[test]
fn bad_plates_are_named_with_what_to_do() {
    let place = tempfile::tempdir().unwrap();
    let refused = |more: &[&str], says: &[&str]| {
        let sets = more.iter().flat_map(|text| ["--set", text]);
        let line: Vec<&str> = ["check", "two-plates"].into_iter().chain(sets).collect();
        let output = arclen(place.path(), &line);
        assert_eq!(output.status.code(), Some(2), "{more:?}");
        let error = String::from_utf8(output.stderr).unwrap();
        for words in says {
            assert!(error.contains(words), "{more:?}: {words} in {error}");
        }
    };
    refused(&["path.end=-0.2"], &["path.end", "-0.2", "positive"]);
    refused(&["plate.bottom.film=0"], &["plate.bottom.film", "positive"]);
    refused(&["plate.top.adhesion=-1"], &["plate.top.adhesion", "positive"]);
    refused(&["plate.left.film=1"], &["plate.left", "top, bottom"]);
    refused(&["plate.bottom.device=cantilever"], &["plate.bottom.device", "[plate.top]"]);
    refused(&["plate.top.device=cantilever"], &["plate.top.stiffness", "needs its stiffness"]);
    refused(&["plate.top.stiffness=3"], &["plate.top.stiffness", "a grip has none"]);
    refused(&["equator=pinned"], &["equator", "free", "held"]);
    refused(&["dimensionless.adhesion=1e-3"], &["dimensionless.adhesion", "plate.top"]);
    let case = "problem = \"two-plates\"\n[shell]\nlaw = \"hooke\"\n[dimensionless]\n\
                bending = 3e-5\npressure = 3e-3\n[plate.top]\nadhesion = 2e-3\nfilm = 0.03\n\
                [path]\nstart = 1.1\nend = 0.9\n";
    fs::write(place.path().join("one.toml"), case).unwrap();
    let output = arclen(place.path(), &["check", "one.toml"]);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(error.contains("plate.bottom") && error.contains("equator = \"held\""), "{error}");
    for (key, words) in [
        ("film", &["no such parameter", "plate.top.film, plate.bottom.adhesion"][..]),
        ("z0", &["is the parameter of the branch"]),
        ("plate.top.flim", &["did you mean plate.top.film?"]),
    ] {
        let output = arclen(place.path(), &["map", "two-plates", "--over", key]);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(words.iter().all(|part| error.contains(part)), "{error}");
    }
}

/// Over what leaves both plates alike the folds are those of half the shell, and the pitchforks have curves
/// besides; a film of one plate alone moves folds too.
#[test]
fn folds_of_the_whole_shell_have_curves_in_two_parameters() {
    let place = tempfile::tempdir().unwrap();
    let map = |case: &str, key: &str, out: &str, sets: &[&str]| {
        let words = ["map", case, "--over", key, "--elements", "40", "--out", out, "-q"];
        let output = arclen(place.path(), &[&words[..], sets].concat());
        assert!(output.status.code().is_some_and(|code| code != 2), "{output:?}");
        json(&place.path().join(out).join("map.json"))
    };
    let range = ["--set", "map.from=2e-3", "--set", "map.to=4e-3", "--set", "path.end=0.815"];
    let whole = map("two-plates", "pressure", "whole", &range);
    let half = map("fig12", "pressure", "half", &range);
    let of = |map: &Value, kind: &str| -> Vec<String> {
        let curves = map["curves"].as_array().unwrap().iter();
        let own = curves.filter(|curve| curve["kind"] == kind);
        own.map(|curve| curve["csv"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(of(&whole, "fold").len(), 2);
    assert_eq!(of(&whole, "fold"), of(&half, "fold"));
    for file in of(&half, "fold") {
        let ends = |out: &str| -> Vec<[f64; 3]> {
            let at = |name: &str| column(&place.path().join(out).join(&file), name);
            let (z0, pressure, force) = (at("z0"), at("pressure"), at("force"));
            let last = z0.len() - 1;
            let mut ends = [0, last].map(|k| [pressure[k], z0[k], force[k]]).to_vec();
            ends.sort_by(|a, b| a[0].total_cmp(&b[0]));
            ends
        };
        for (a, b) in ends("whole").iter().zip(ends("half")) {
            for (a, b) in a.iter().zip(b) {
                assert!((a - b).abs() < 1e-8, "{file}: {a} {b}");
            }
        }
    }
    // where the bubble leaves one plate, at the flat fold, behind the other one, where one dimple grows
    assert!(of(&whole, "branch-point").len() >= 4 && of(&half, "branch-point").is_empty());
    let one = map(
        "two-plates",
        "plate.top.film",
        "one",
        &["--set", "map.from=0.032", "--set", "map.to=0.035", "--set", "path.end=0.815"],
    );
    let folds = of(&one, "fold");
    assert!(!folds.is_empty());
    let at = |name: &str| column(&place.path().join("one").join(&folds[0]), name);
    let (z0, film) = (at("z0"), at("film_top"));
    let apart = z0.iter().zip(&film).filter(|(_, film)| (*film - 0.0333333333).abs() > 1e-4);
    assert!(apart.clone().count() > 2);
    let unlike = at("pole_top").iter().zip(at("pole_bottom")).any(|(a, b)| (a - b).abs() > 1e-4);
    assert!(unlike, "of unequal plates no state is a mirror image");
}

/// The symmetric branch of Fig. 12 with the asymmetric ones: the bubble on one plate, one dimple
/// deeper than the other, and one pole flat while the other is buckled.
#[test]
fn asymmetric_branches_stand_beside_the_symmetric_one() {
    let place = tempfile::tempdir().unwrap();
    let output = arclen(place.path(), &["diagram", "fig12", "--elements", "100", "--out", "o"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let out = place.path().join("o");
    let json = self::json(&out.join("diagram.json"));
    // modes with waves lead on, and nothing follows them
    assert_eq!(json["stopped_because"], "incomplete");
    let detail = json["stopped_detail"].as_str().unwrap();
    assert!(detail.contains("waves around the axis") && !detail.contains("mirror"), "{detail}");
    assert_eq!(json["stability"]["scan"], "full");
    let branches = json["branches"].as_array().unwrap();
    let kinds: Vec<&str> = branches.iter().map(|b| b["symmetry"].as_str().unwrap()).collect();
    let (mirror, other) = ("symmetric about the equator", "asymmetric about the equator");
    assert_eq!(kinds, [mirror, other, other, other, other]);
    // every fork has its branch: it begins there, or ends there
    let forks: Vec<usize> = branches[0]["events"]
        .as_array()
        .unwrap()
        .iter()
        .enumerate()
        .filter(|(_, e)| e["kind"] == "symmetry-breaking" && e["n"] == 0)
        .map(|(k, _)| k)
        .collect();
    assert_eq!(forks.len(), 5);
    let joints = json["joints"].as_array().unwrap();
    assert_eq!(joints.len(), 5);
    for (joint, fork) in joints.iter().zip(&forks) {
        assert_eq!(joint["passed"][0]["event"], *fork);
        assert_eq!(joint["open"], 0);
        let met =
            joint["begun"].as_array().unwrap().len() + joint["passed"].as_array().unwrap().len();
        assert!(met >= 2, "{joint}");
    }
    // a branch that is stable to axisymmetric modes at the closest plates, flat at one pole
    let (mut ends, mut seen, mut all_stable) = (Vec::new(), Vec::new(), Vec::new());
    let mut turns = 0;
    for branch in &branches[1..] {
        let name = branch["csv"].as_str().unwrap();
        assert!(name.ends_with("-asymmetric.csv"));
        assert_eq!(branch["from"]["branch"], 0);
        let file = out.join(name);
        let (top, bottom) = (column(&file, "force"), column(&file, "force_bottom"));
        assert!(top.iter().zip(&bottom).all(|(a, b)| (a - b).abs() < 1e-8));
        let (z0, unstable, shift) =
            (column(&file, "z0"), column(&file, "unstable"), column(&file, "shift"));
        // one of both images
        let sides = shift.iter().map(|s| s * shift[shift.len() / 2] > -1e-9);
        assert!(sides.clone().all(|same| same), "{name}: {shift:?}");
        let closest = (0..z0.len()).find(|k| z0[*k] == 0.65);
        ends.extend(closest.map(|k| (unstable[k], shift[k].abs())));
        let modes = column(&file, "unstable_modes");
        let text = fs::read_to_string(&file).unwrap();
        let words: Vec<&str> =
            text.lines().skip(1).map(|l| l.rsplit(',').next().unwrap()).collect();
        let says = |n: f64| if n > 0.0 { "no" } else { "yes" };
        for (k, word) in words.iter().enumerate() {
            assert_eq!(*word, says(unstable[k] + modes[k]), "{name}, point {k}");
        }
        // where waves turn is found
        assert_eq!(branch["stability"]["not_located"], 0, "{name}");
        let events = branch["events"].as_array().unwrap();
        let turned = events.iter().filter(|e| e["kind"] == "symmetry-breaking");
        assert!(turned.clone().all(|e| e["n"].as_i64().unwrap() > 0));
        turns += turned.count();
        all_stable.push(words.iter().all(|word| *word == "yes"));
        seen.push(modes.iter().any(|n| *n > 0.0));
    }
    // away from both plates the shell is round; between them a dimple is not
    assert_eq!(seen.iter().filter(|seen| **seen).count(), 3, "{seen:?}");
    assert!(!all_stable.contains(&true));
    assert!(turns > 30, "{turns}");
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert_eq!(ends.len(), 2);
    assert!(ends[0].0 == 0.0 && ends[1].0 == 1.0 && ends[0].1 > 0.1, "{ends:?}");
    let picture = fs::read_to_string(out.join("diagram.svg")).unwrap();
    assert!(picture.contains("asymmetric about the equator"));

    // the same without: said, and the files of the others are gone
    let line = "diagram fig12 --elements 100 --set stability.scan=axisymmetric --out o";
    let output = arclen(place.path(), &line.split(' ').collect::<Vec<_>>());
    assert_eq!(output.status.code(), Some(0));
    let json = self::json(&out.join("diagram.json"));
    assert_eq!(json["stopped_because"], "complete");
    assert!(json["stopped_detail"].as_str().unwrap().contains("without mirror symmetry"));
    assert_eq!(json["branches"].as_array().unwrap().len(), 1);
    let entries = fs::read_dir(&out).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["branch-0.csv", "case.toml", "diagram.json", "diagram.svg"]);
}

/// A soft shell keeps its circular shape: with the branch onto one plate its diagram is complete. No
/// deeper than the first branch, that one is left out, and the diagram is not.
#[test]
fn a_diagram_is_complete_when_nothing_known_is_left_out() {
    let place = tempfile::tempdir().unwrap();
    let soft = "problem = \"contact\"\n[shell]\nlaw = \"mooney-rivlin\"\nb = 1.0\n\
                [dimensionless]\nbending = 2.7e-3\npressure = 3.0\nadhesion = 2e-3\n\
                film = 0.0333\n[mesh]\nelements = 60\n[path]\nstart = 1.15\nend = 0.9\n";
    fs::write(place.path().join("soft.toml"), soft).unwrap();
    for (more, code, word, branches) in
        [(&[][..], 0, "complete", 2), (&["--depth", "0"], 3, "incomplete", 1)]
    {
        let line = [&["diagram", "soft.toml", "--out", "o"][..], more].concat();
        let output = arclen(place.path(), &line);
        assert_eq!(output.status.code(), Some(code), "{}", String::from_utf8_lossy(&output.stdout));
        let json = self::json(&place.path().join("o/diagram.json"));
        assert_eq!(json["stopped_because"], word, "{}", json["stopped_detail"]);
        assert_eq!(json["branches"].as_array().unwrap().len(), branches);
    }
}
