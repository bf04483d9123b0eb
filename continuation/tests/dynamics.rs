//! Small dynamical systems, given by their residual alone: folds and Hopf points known to many
//! digits (recomputed in multiple precision from the equations; AUTO-07p's demos by their names).

#![allow(clippy::unwrap_used)]

use continuation::{Branch, DenseProblem, EventKind, Problem, Settings, StopReason, Tracer};
use std::ops::ControlFlow;

fn trace<P: Problem>(problem: &P, u: &[f64], p: f64, settings: Settings) -> Branch {
    Tracer::new(problem, "p", u, &[p], settings).unwrap().run(&mut |_| ControlFlow::Continue(()))
}

/// Kinds and places in order along the branch.
fn check(branch: &Branch, expected: &[(EventKind, f64)]) {
    let found: Vec<_> = branch.events.iter().map(|e| (e.kind.clone(), e.p)).collect();
    assert_eq!(branch.stopped.reason, StopReason::Target, "{:?} {found:?}", branch.stopped);
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for ((kind, p), (expected_kind, known)) in found.iter().zip(expected) {
        assert_eq!(kind, expected_kind, "{found:?}");
        let tolerance = if *kind == EventKind::Hopf { 1e-8 } else { 1e-10 };
        assert!((p / known - 1.0).abs() < tolerance, "{kind} at {p}, known {known}");
    }
}

#[test]
fn ab() {
    let problem = DenseProblem::from_residual(2, &["p"], |u, p, r| {
        let rate = p[0] * (1.0 - u[0]) * u[1].exp();
        r[0] = -u[0] + rate;
        r[1] = -u[1] + 18.0 * rate - 3.0 * u[1];
    });
    let expected = [
        (EventKind::Hopf, 0.111_153_484_190),
        (EventKind::Fold, 0.111_565_080_074),
        (EventKind::Fold, 0.099_574_136_736),
        (EventKind::Hopf, 0.183_834_607_986),
    ];
    for max_step in [None, Some(0.01), Some(0.5)] {
        let settings = Settings { target: Some(0.25), max_step, ..Settings::default() };
        check(&trace(&problem, &[0.0, 0.0], 0.0, settings), &expected);
    }
}

#[test]
fn abc() {
    let problem = DenseProblem::from_residual(3, &["p"], |x, p, r| {
        let [u, v, w] = [x[0], x[1], x[2]];
        let e = p[0] * w.exp();
        r[0] = -u + (1.0 - u) * e;
        r[1] = -v + e * (1.0 - u - 0.04 * v);
        r[2] = -2.55 * w + 8.0 * e * (1.0 - u + 0.04 * v);
    });
    let settings = Settings { target: Some(0.4), ..Settings::default() };
    let branch = trace(&problem, &[0.0; 3], 0.0, settings);
    let hopf: Vec<f64> = branch.events_of(&EventKind::Hopf).map(|e| e.p).collect();
    let known = [0.204_184_535_701, 0.229_839_037_648, 0.259_957_854_245, 0.346_208_521_607];
    assert_eq!(hopf.len(), 4, "{:?}", branch.events);
    for known in known {
        assert!(hopf.iter().any(|p| (p / known - 1.0).abs() < 1e-8), "{known}: {hopf:?}");
    }
}

#[test]
fn plp() {
    let problem = DenseProblem::from_residual(2, &["p"], |x, p, r| {
        let [s, a] = [x[0], x[1]];
        let rate = s * a / (1.0 + s + 0.1 * s * s);
        r[0] = 110.0 - s - p[0] * rate;
        r[1] = 0.2 * (500.0 - a) - p[0] * rate;
    });
    let settings = Settings { target: Some(10.0), ..Settings::default() };
    let branch = trace(&problem, &[110.0, 500.0], 0.0, settings);
    let hopf: Vec<f64> = branch.events_of(&EventKind::Hopf).map(|e| e.p).collect();
    assert_eq!(hopf.len(), 2, "{:?}", branch.events);
    for (p, known) in hopf.iter().zip([3.499_953_827_987, 4.650_457_812_603]) {
        assert!((p / known - 1.0).abs() < 1e-8, "{p}, known {known}");
    }
}
