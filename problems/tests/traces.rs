//! Default traces: they reach their end, and meet the known points of the first branch.

#![allow(clippy::unwrap_used)]

use continuation::{Branch, Detail, Event, Shape};
use problems::{Entry, Known, On, catalogue, find};
use std::ops::ControlFlow;

fn trace(entry: &Entry) -> Branch {
    entry.trace(&entry.request(), &mut |_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn default_traces_come_to_their_end() {
    for entry in catalogue() {
        let (name, branch) = (entry.name, trace(entry));
        assert!(branch.stopped.reason.is_complete(), "{name}: {:?}", branch.stopped);
        assert!(!branch.observables.is_empty(), "{name}");
        assert!(branch.points.iter().all(|p| p.unstable.is_some()), "{name}");
    }
}

fn is(event: &Event, known: &Known) -> bool {
    let form = match &event.detail {
        Detail::Crossing(crossing) => match crossing.shape {
            Shape::Transcritical => "transcritical",
            Shape::Pitchfork => "pitchfork",
            Shape::Multiple if crossing.multiplicity == 2 => "double",
            _ => "other",
        },
        _ => "",
    };
    event.kind.to_string() == known.kind && known.agrees(event.p) && form == known.form
}

#[test]
fn default_traces_meet_what_is_known_of_the_first_branch_and_no_more() {
    for entry in catalogue() {
        let (name, branch) = (entry.name, trace(entry));
        let first: Vec<&Known> = entry.known.iter().filter(|k| k.on == On::FirstBranch).collect();
        let special: Vec<&Event> = branch
            .events
            .iter()
            .filter(|e| ["fold", "branch-point", "hopf"].contains(&e.kind.to_string().as_str()))
            .collect();
        let found: Vec<_> = special.iter().map(|e| (e.kind.to_string(), e.p)).collect();
        for known in &first {
            assert!(special.iter().any(|e| is(e, known)), "{name}: {known:?} not in {found:?}");
        }
        if name != "swift-hohenberg-snaking" {
            assert_eq!(special.len(), first.len(), "{name}: {found:?}");
        }
    }
}

/// A fold more or less means a fold that was passed over, or a jump to another strand.
#[test]
fn the_snake_has_seventeen_folds_in_turn() {
    let entry = find("swift-hohenberg-snaking").unwrap();
    let branch = trace(entry);
    let folds: Vec<f64> =
        branch.events.iter().filter(|e| e.kind.to_string() == "fold").map(|e| e.p).collect();
    assert_eq!(folds.len(), 17, "{folds:?}");
    let known = entry.known;
    for (k, fold) in folds.iter().enumerate() {
        // the first six in order, then alternately near the two limits
        let known = if k < 6 { &known[k] } else { &known[6 + k % 2] };
        assert!((fold - known.value).abs() < if k < 6 { 1e-10 } else { 1e-7 }, "{k}: {fold}");
    }
}

#[test]
fn the_mechanical_ones_lose_their_stability_where_they_should() {
    let counts = |name: &str| {
        let branch = trace(find(name).unwrap());
        branch.events.iter().map(|e| (e.unstable_before, e.unstable_after)).collect::<Vec<_>>()
    };
    assert_eq!(counts("euler-column"), [(Some(0), Some(1))]);
    assert_eq!(counts("pressurised-sphere"), [(Some(0), Some(1)), (Some(1), Some(2))]);
    let arch = [(Some(0), Some(1)), (Some(1), Some(2)), (Some(2), Some(1)), (Some(1), Some(0))];
    assert_eq!(counts("shallow-arch"), arch);
}

#[test]
fn entries_are_told_apart_and_say_what_they_are() {
    let entries = catalogue();
    for (k, entry) in entries.iter().enumerate() {
        assert!(entries[..k].iter().all(|other| other.name < entry.name), "{}", entry.name);
        assert!((20..100).contains(&entry.summary.len()), "{}: {}", entry.name, entry.summary);
        assert!(!entry.known.is_empty() && entry.start != entry.end, "{}", entry.name);
        for known in entry.known {
            assert!(!known.source.is_empty() && known.value.is_finite(), "{}", entry.name);
            assert!(known.second.is_some() == (known.on == On::TwoParameters), "{}", entry.name);
        }
    }
}

/// Name of the parameter, then of the observables.
struct Names;

impl problems::Visitor for Names {
    type Output = Vec<String>;

    fn visit<P: continuation::Problem>(self, problem: &P, setup: problems::Setup) -> Vec<String> {
        let observables = problem.observables().iter().map(ToString::to_string);
        std::iter::once(setup.parameter.to_string()).chain(observables).collect()
    }
}

#[test]
fn axes_are_the_parameter_and_the_observables() {
    for entry in problems::catalogue() {
        let names = entry.visit(&entry.request(), Names).unwrap();
        let axes: Vec<&str> = entry.axes.iter().map(|(name, _)| *name).collect();
        assert_eq!(axes, names, "{}", entry.name);
        assert!(entry.axes.iter().all(|(_, words)| !words.is_empty()), "{}", entry.name);
    }
}
