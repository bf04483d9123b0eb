//! The same special points at every step length, from a hundredth of the default to a hundred
//! times it: nothing missed, nothing jumped.

#![allow(clippy::unwrap_used)]

use continuation::samples::{Bratu, Cusp};
use continuation::{Branch, DenseProblem, Problem, Settings, StopReason, Tracer, Watch};
use std::ops::ControlFlow;

const FACTORS: [f64; 9] = [0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0];

fn account(branch: &Branch) -> Vec<(String, f64)> {
    branch.events.iter().map(|e| (e.kind.to_string(), e.p)).collect()
}

/// Traces with each step length and compares with the first, and with what is `known`.
fn compare(known: &[(&str, f64)], range: f64, mut trace: impl FnMut(Settings) -> Branch) {
    for factor in FACTORS {
        let settings = Settings {
            max_step: Some(factor * 0.05 * range),
            max_points: 1_000_000,
            ..Settings::default()
        };
        let branch = trace(settings);
        let found = account(&branch);
        assert_eq!(branch.stopped.reason, StopReason::Target, "{factor}: {:?}", branch.stopped);
        assert_eq!(found.len(), known.len(), "{factor}: {found:?}");
        for ((kind, p), (name, exact)) in found.iter().zip(known) {
            assert_eq!(kind, name, "{factor}: {found:?}");
            assert!((p / exact - 1.0).abs() < 1e-10, "{factor}: {kind} at {p}, known {exact}");
        }
    }
}

fn follow<P: Problem>(problem: &P, name: &str, u: &[f64], p: &[f64], s: Settings) -> Branch {
    Tracer::new(problem, name, u, p, s).unwrap().run(&mut |_| ControlFlow::Continue(()))
}

#[test]
fn cusp() {
    let exact = 2.0 / (3.0 * 3f64.sqrt());
    compare(&[("fold", exact), ("fold", -exact)], 4.0, |s| {
        let settings = Settings { target: Some(2.0), ..s };
        follow(&Cusp, "mu", &[-1.5], &[-2.0, 1.0], settings)
    });
}

#[test]
fn ab() {
    let problem = DenseProblem::from_residual(2, &["p"], |u, p, r| {
        let rate = p[0] * (1.0 - u[0]) * u[1].exp();
        r[0] = -u[0] + rate;
        r[1] = -u[1] + 18.0 * rate - 3.0 * u[1];
    })
    .boxed();
    let known = [
        ("hopf", 0.111_153_484_190),
        ("fold", 0.111_565_080_074),
        ("fold", 0.099_574_136_736),
        ("hopf", 0.183_834_607_986),
    ];
    compare(&known, 0.25, |s| {
        follow(&problem, "p", &[0.0, 0.0], &[0.0], Settings { target: Some(0.25), ..s })
    });
}

#[test]
fn enz() {
    let problem = DenseProblem::from_residual(2, &["p"], |s, p, r| {
        let rate = |s: f64| 100.0 * s / (1.0 + s + s * s);
        r[0] = p[0] - 2.0 * s[0] + s[1] - rate(s[0]);
        r[1] = p[0] - 2.0 * s[1] + s[0] - rate(s[1]);
    })
    .boxed();
    let known = [
        ("fold", 34.356_924_998_526),
        ("branch-point", 34.222_886_544_190),
        ("branch-point", 22.181_637_926_124),
        ("fold", 18.887_067_657_924),
    ];
    compare(&known, 40.0, |s| {
        follow(&problem, "p", &[0.0, 0.0], &[0.0], Settings { target: Some(40.0), ..s })
    });
}

#[test]
fn pp2() {
    let problem = DenseProblem::from_residual(2, &["p"], |x, p, r| {
        let (u, v) = (x[0], x[1]);
        r[0] = 3.0 * u * (1.0 - u) - u * v - p[0] * (1.0 - (-5.0 * u).exp());
        r[1] = -v + 3.0 * u * v;
    })
    .boxed()
    .observing("u", |x, _| x[0]);
    compare(&[("branch-point", 0.6)], 1.0, |s| {
        follow(&problem, "p", &[0.0, 0.0], &[0.0], Settings { target: Some(1.0), ..s })
    });
    // the branch of u alone, up to u = 1
    let trunk = follow(
        &problem,
        "p",
        &[0.0, 0.0],
        &[0.0],
        Settings { target: Some(1.0), ..Settings::default() },
    );
    let event = &trunk.events[0];
    let direction = &event.crossing().unwrap().leaving[0];
    let known = [("branch-point", 0.821_904_345_374), ("fold", 0.832_929_322_234)];
    compare(&known, 0.6, |s| {
        let settings = Settings { target: Some(0.0), ..s };
        Tracer::leaving(&problem, &trunk, event, direction, direction.du[0] > 0.0, settings)
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(()))
    });
}

#[test]
fn bratu() {
    let problem = Bratu::new(100);
    let trace = |s: Settings| {
        let settings = Settings { increasing: Some(true), ..s };
        Tracer::new(&problem, "lambda", &[0.0; 100], &[0.0], settings)
            .unwrap()
            .watching(&[Watch::stop_at("max_u", 8.0)])
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(()))
    };
    let reference = account(&trace(Settings::default()));
    let known: Vec<(&str, f64)> = reference.iter().map(|(kind, p)| (&kind[..], *p)).collect();
    assert_eq!(known.len(), 2);
    compare(&known, 4.0, trace);
}
