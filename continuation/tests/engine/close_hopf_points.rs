//! Hopf points close to each other: each one is reported, or what could not be told apart is said.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use continuation::{Branch, DenseProblem, Event, EventKind, Problem, Settings, Tracer};
use std::ops::ControlFlow;

fn trace<P: Problem>(problem: &P, n: usize) -> Branch {
    let settings = Settings { target: Some(1.0), ..Settings::default() };
    Tracer::new(problem, "p", &vec![0.0; n], &[-1.0], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()))
}

/// Two oscillators of the same and of different frequencies, unstable from `c` and `c + gap` on.
#[test]
fn two_pairs_that_cross_one_after_the_other() {
    for k in 1..=12 {
        let gap = 10f64.powi(-k);
        for (ratio, c) in [(1.0, 0.1234), (1.7, 0.0), (3.1, 0.1234), (1.7, -0.4321)] {
            let problem = DenseProblem::from_residual(4, &["p"], move |u, p, r| {
                let pairs = [(p[0] - c, 1.3), (p[0] - c - gap, 1.3 * ratio)];
                for (i, (rate, w)) in pairs.into_iter().enumerate() {
                    let (x, y) = (u[2 * i], u[2 * i + 1]);
                    let square = x * x + y * y;
                    r[2 * i] = rate * x - w * y - square * x;
                    r[2 * i + 1] = w * x + rate * y - square * y;
                }
            })
            .boxed();
            let branch = trace(&problem, 4);
            let case = format!("{gap:.0e}, {ratio}, {c}: {:?}", branch.events);
            assert!(branch.events.iter().all(|event| event.kind == EventKind::Hopf), "{case}");
            let counts = |e: &Event| (e.unstable_before.unwrap(), e.unstable_after.unwrap());
            let right = |e: &Event, known: f64| (e.p - known).abs() <= e.error_estimate + 1e-14;
            match &branch.events[..] {
                [a, b] => {
                    assert_eq!([counts(a), counts(b)], [(0, 2), (2, 4)], "{case}");
                    assert!(right(a, c) && right(b, c + gap), "{case}");
                }
                // nearer than steps are divided it is one point, with both pairs in its counts
                [one] => {
                    assert!(gap < 1e-8, "{case}");
                    assert_eq!(counts(one), (0, 4), "{case}");
                    assert!(right(one, c) || right(one, c + gap), "{case}");
                }
                _ => unreachable!("{case}"),
            }
            assert!(branch.points.len() < 200, "{case}: {}", branch.points.len());
        }
    }
}

/// A pair that is unstable for `c < p < c + w` only.
#[test]
fn windows_of_any_width() {
    for k in 1..=10 {
        let w = 10f64.powi(-k);
        for c in [0.1234, 0.0, -0.4321] {
            let problem = DenseProblem::from_residual(2, &["p"], move |u, p, r| {
                let (x, y) = (u[0], u[1]);
                let rate = (p[0] - c) * (c + w - p[0]);
                r[0] = rate * x - 1.3 * y - (x * x + y * y) * x;
                r[1] = 1.3 * x + rate * y - (x * x + y * y) * y;
            })
            .boxed();
            let branch = trace(&problem, 2);
            let found: Vec<f64> = branch.events_of(&EventKind::Hopf).map(|e| e.p).collect();
            let case =
                format!("{w:.0e}, {c}: {found:?} {:?} {}", branch.doubts, branch.points.len());
            assert_eq!(found.len(), branch.events.len(), "{case}");
            let both = found.len() == 2
                && (found[0] - c).abs() < 1e-10 / w.min(1.0)
                && (found[1] - c - w).abs() < 1e-10 / w.min(1.0);
            assert!(both || (found.is_empty() && !branch.is_certain()), "{case}");
            assert!(both || w < 1e-4, "{case}");
        }
    }
}
