//! Which files a run leaves, and what happens where they cannot be written.

use super::*;
use continuation::StopReason;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use study::case::{Override, ResolvedCase, load};
use study::record::TraceResult;
use study::run::run_trace;

/// A short branch of a case, and the case as it is shipped.
fn example() -> (ResolvedCase, TraceResult) {
    let keys = ["mesh.elements=40", "path.end=0.85", "stability.scan=axisymmetric"];
    let case = load("fig12".as_ref(), &keys.map(Override::new), &[]).unwrap().case;
    let result = run_trace(&case, &mut |_| ControlFlow::Continue(())).unwrap();
    (load("fig12".as_ref(), &[], &[]).unwrap().case, result)
}

/// All files but the page.
fn made((case, result): &(ResolvedCase, TraceResult), pictures: bool) -> Results {
    trace(case, result, Some(Wanted { pictures, report: false }))
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_finished_trace_leaves_all_its_files() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("deep/out");
    let folder = Folder::check(&path, &[]).unwrap();
    let example = example();
    assert!(made(&example, true).write(&folder, &[]));
    // the last picture is that of other problems
    let drawn = crate::NAMES.into_iter().filter(|name| *name != "diagram.svg");
    let mut expected: Vec<&str> = [BRANCH, "events.json", CASE].into_iter().chain(drawn).collect();
    expected.sort_unstable();
    assert_eq!(names(&path), expected);
    assert_eq!(load(&path.join(CASE), &[], &[]).unwrap().case, example.0);
}

#[test]
fn pictures_have_the_formats_that_are_wanted() {
    let place = tempfile::tempdir().unwrap();
    let example = example();
    for (svg, png, pdf) in [(true, false, false), (false, true, false), (true, true, true)] {
        let path = place.path().join(format!("{svg}-{png}"));
        let mut made = made(&example, true);
        made.choose(Formats { svg, png, pdf });
        assert!(made.write(&Folder::check(&path, &[]).unwrap(), &[]));
        let names = names(&path);
        let there =
            ["shapes.svg", "shapes.png", "shapes.pdf"].map(|name| names.contains(&name.to_owned()));
        assert_eq!(there, [svg, png, pdf], "{names:?}");
    }
    let png = fs::read(place.path().join("false-true/shapes.png")).unwrap();
    assert_eq!(&png[1..4], b"PNG");
    let pdf = fs::read(place.path().join("true-true/shapes.pdf")).unwrap();
    assert_eq!(&pdf[..5], b"%PDF-");
}

#[test]
fn a_trace_that_stopped_early_leaves_its_files() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::check(place.path(), &[]).unwrap();
    let (case, mut result) = example();
    for reason in [StopReason::Interrupted, StopReason::StepTooSmall, StopReason::MaxPoints] {
        result.stopped_because = reason;
        let example = (case.clone(), result.clone());
        assert!(made(&example, false).write(&folder, &[]));
        assert_eq!(names(place.path()), [BRANCH, CASE, "events.json"]);
        let json = fs::read_to_string(place.path().join("events.json")).unwrap();
        assert!(json.contains(&format!("\"stopped_because\": \"{reason}\"")));
    }
}

#[test]
fn a_folder_that_vanished_under_a_file_is_told() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("out");
    let folder = Folder::check(&path, &[]).unwrap();
    fs::write(&path, "").unwrap();
    let mut made = made(&example(), false);
    assert!(!made.write(&folder, &[]));
    assert_eq!(made.problems().len(), 1);
}
