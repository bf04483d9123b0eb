//! Small dynamical systems, given by their residual alone: folds and Hopf points known to many
//! digits (recomputed in multiple precision from the equations; AUTO-07p's demos by their names).

#![allow(clippy::unwrap_used)]

use continuation::linalg::{Dense, Matrix};
use continuation::{
    Branch, Criticality, DenseProblem, EventKind, Problem, Settings, StopReason, Tracer,
};
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
    })
    .boxed();
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
    })
    .boxed();
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
    })
    .boxed();
    let settings = Settings { target: Some(10.0), ..Settings::default() };
    let branch = trace(&problem, &[110.0, 500.0], 0.0, settings);
    let hopf: Vec<f64> = branch.events_of(&EventKind::Hopf).map(|e| e.p).collect();
    assert_eq!(hopf.len(), 2, "{:?}", branch.events);
    for (p, known) in hopf.iter().zip([3.499_953_827_987, 4.650_457_812_603]) {
        assert!((p / known - 1.0).abs() < 1e-8, "{p}, known {known}");
    }
}

/// `x' = μx − y + σ x r²`, `y' = x + μy + σ y r²`: with `|q| = 1`, `r² = 2|z|²` and `l₁ = 2σ`.
#[test]
fn lyapunov_coefficient_of_the_normal_form() {
    for sigma in [-1.0, 0.7] {
        let problem = DenseProblem::from_residual(2, &["p"], move |u, p, r| {
            let square = u[0] * u[0] + u[1] * u[1];
            r[0] = p[0] * u[0] - u[1] + sigma * u[0] * square;
            r[1] = u[0] + p[0] * u[1] + sigma * u[1] * square;
        })
        .boxed();
        let settings = Settings { target: Some(1.0), ..Settings::default() };
        let branch = trace(&problem, &[0.0, 0.0], -1.0, settings);
        assert_eq!(branch.events.len(), 1);
        let hopf = branch.events[0].hopf().unwrap();
        assert!(branch.events[0].p.abs() < 1e-12);
        assert!((hopf.frequency - 1.0).abs() < 1e-12);
        assert!((hopf.lyapunov - 2.0 * sigma).abs() < 1e-7, "{hopf:?}");
        let expected =
            if sigma < 0.0 { Criticality::Supercritical } else { Criticality::Subcritical };
        assert_eq!(hopf.criticality, Some(expected));
    }
}

/// The amplitude of the periodic solution beside a Hopf point, by integration in time, is what the
/// coefficient says: `|z|² = −μ'(p) Δp / (ω l₁)`.
#[test]
fn lyapunov_coefficient_gives_the_amplitude_of_the_oscillation() {
    let f = |u: [f64; 2], p: f64| {
        let rate = p * (1.0 - u[0]) * u[1].exp();
        [-u[0] + rate, -4.0 * u[1] + 18.0 * rate]
    };
    let problem = DenseProblem::from_residual(2, &["p"], move |u, p, r| {
        r.copy_from_slice(&f([u[0], u[1]], p[0]));
    })
    .boxed();
    let step = -1e-4;
    let settings = Settings { target: Some(0.25), ..Settings::default() };
    let branch = trace(&problem, &[0.0, 0.0], 0.0, settings);
    let event = branch.events_of(&EventKind::Hopf).last().unwrap();
    let hopf = event.hopf().unwrap();
    assert_eq!(hopf.criticality, Some(Criticality::Supercritical));
    let equilibrium = |p: f64| {
        let mut u = branch.points[event.point].u.clone();
        continuation::newton(&problem, &mut u, &[p], &Default::default()).unwrap();
        u
    };
    let jacobian = |p: f64| {
        let mut j = Dense::new(2);
        problem.jacobian(&equilibrium(p), &[p], &mut j).unwrap();
        j
    };
    let growth = |p: f64| jacobian(p).spectrum(None).unwrap()[0].0;
    let slope = (growth(event.p + 1e-5) - growth(event.p - 1e-5)) / 2e-5;
    let j = jacobian(event.p);
    // the second component of the eigenvector (j12, iω − j11) of length 1
    let (re, im) = (-j.get(0, 0), hopf.frequency);
    let part = re.hypot(im) / (j.get(0, 1).powi(2) + re * re + im * im).sqrt();
    let z = (-slope * step / (hopf.frequency * hopf.lyapunov)).sqrt();
    let predicted = 4.0 * part * z;

    let p = event.p + step;
    let u = equilibrium(p);
    let mut x = [u[0], u[1] + 0.5 * predicted];
    let dt = 2e-3;
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let (settle, measure) = (400_000, 10_000);
    for i in 0..settle + measure {
        let add = |a: [f64; 2], s: f64, b: [f64; 2]| [a[0] + s * b[0], a[1] + s * b[1]];
        let k1 = f(x, p);
        let k2 = f(add(x, 0.5 * dt, k1), p);
        let k3 = f(add(x, 0.5 * dt, k2), p);
        let k4 = f(add(x, dt, k3), p);
        for i in 0..2 {
            x[i] += dt / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
        if i >= settle {
            (low, high) = (low.min(x[1]), high.max(x[1]));
        }
    }
    let measured = high - low;
    assert!((measured / predicted - 1.0).abs() < 0.01, "{measured} {predicted}");
}
