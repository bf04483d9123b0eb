//! Between onsets no count changes, whatever the step: a false onset of one wave at almost every
//! point is what a neutral motion that is not removed looks like.

use crate::support::contact;
use continuation::Settings;
use shell_contact::modes::{Parity, ScanSettings, scan_branch};
use shell_contact::{ContactProblem, Law, trace_contact};
use std::ops::ControlFlow;

const STEPS: [f64; 6] = [0.001, 0.0023, 0.005, 0.011, 0.023, 0.05];

/// `n`, parity, count before and after, plate distance.
type Onset = (usize, Parity, usize, usize, f64);

/// The onsets at one step, by class and in order along the branch; every point between two of a
/// class must have the count that they say.
fn onsets(problem: &ContactProblem, range: (f64, f64), step: f64) -> Vec<Onset> {
    let go_on = ControlFlow::Continue(());
    let settings = Settings {
        target: Some(range.1),
        max_step: Some(step),
        max_points: 20_000,
        ..Settings::default()
    };
    let traced = trace_contact(problem, range.0, settings, &mut |_| go_on).unwrap();
    let branch = &traced.branch;
    let scanned = scan_branch(problem, branch, &ScanSettings::default(), &mut |_| go_on).unwrap();
    assert!(scanned.missed.is_empty(), "step {step}: {:?}", scanned.missed);
    let mut onsets = Vec::new();
    for n in 0..=40 {
        for parity in Parity::BOTH {
            let own: Vec<_> =
                scanned.events.iter().filter(|e| (e.n, e.parity) == (n, Some(parity))).collect();
            for (k, point) in scanned.points.iter().enumerate() {
                let count = match n {
                    0 if parity == Parity::Symmetric => continue,
                    0 => point.antisymmetric,
                    n => point.count(n, parity).map_or(0, |count| count.negative),
                };
                // an event lies after the point of its number
                let before = own.iter().rev().find(|e| e.after_point < k);
                let after = own.iter().find(|e| e.after_point >= k);
                let told = before.map(|e| e.modes_after).or(after.map(|e| e.modes_before));
                assert_eq!(count, told.unwrap_or(count), "step {step}, n = {n}, point {k}");
            }
            onsets.extend(own.iter().map(|e| (n, parity, e.modes_before, e.modes_after, e.z0)));
        }
    }
    onsets
}

fn same_at_every_step(problem: &ContactProblem, range: (f64, f64), tolerance: f64) -> Vec<Onset> {
    let first = onsets(problem, range, STEPS[0]);
    for step in &STEPS[1..] {
        let now = onsets(problem, range, *step);
        let classes = |all: &[Onset]| -> Vec<_> {
            all.iter().map(|(n, parity, before, after, _)| (*n, *parity, *before, *after)).collect()
        };
        assert_eq!(classes(&first), classes(&now), "step {step}");
        for (a, b) in first.iter().zip(&now) {
            assert!((a.4 - b.4).abs() < tolerance, "step {step}: {a:?} and {b:?}");
        }
    }
    first
}

#[test]
fn counts_of_a_hard_shell_with_strong_adhesion_do_not_depend_on_the_step() {
    let problem = contact(80, Law::Hooke, [3e-5, 3e-3, 2e-3, 1.0 / 30.0, 0.0, 1.07]);
    let found = same_at_every_step(&problem, (1.06, 0.76), 2e-9);
    assert_eq!(found.iter().filter(|one| one.0 == 0).count(), 5, "{found:?}");
    assert!(found.iter().all(|one| one.0 != 1), "{found:?}");
}

#[test]
fn counts_of_a_soft_shell_do_not_depend_on_the_step() {
    let problem =
        contact(80, Law::MooneyRivlin { b: 1.0 }, [2.7e-3, 3.0, 2e-3, 1.0 / 30.0, 0.0, 1.07]);
    let found = same_at_every_step(&problem, (1.2, 0.62), 2e-9);
    assert_eq!(found.len(), 1, "{found:?}");
}
