//! Two special points that undo each other within one step.

#![allow(clippy::unwrap_used)]

use continuation::{Branch, DenseProblem, EventKind, Problem, Settings, StopReason, Tracer};
use std::ops::ControlFlow;

use crate::polynomial;
use crate::random;
use polynomial::Polynomial;
use random::Random;

fn follow<P: Problem>(problem: &P, u: &[f64], p: f64, settings: Settings) -> Branch {
    Tracer::new(problem, "p", u, &[p], settings).unwrap().run(&mut |_| ControlFlow::Continue(()))
}

fn places(branch: &Branch, kind: &EventKind) -> Vec<f64> {
    branch.events_of(kind).map(|e| e.p).collect()
}

/// What a random member of a kind of problems is made of: two points `2 w` apart about `c`.
#[derive(Clone, Copy)]
struct Member {
    c: f64,
    w: f64,
    omega: f64,
    tilt: f64,
    bend: [f64; 2],
}

impl Member {
    fn new(random: &mut Random) -> Self {
        Member {
            c: random.between(-0.8, 0.8),
            w: 10f64.powf(random.between(-3.0, -1.0)),
            omega: random.between(1.0, 2.0),
            tilt: random.between(-0.4, 0.4),
            bend: [random.between(-1.0, 1.0), random.between(-1.0, 1.0)],
        }
    }

    /// Positive between the two points, and no parabola.
    fn growth(&self, p: f64) -> f64 {
        (self.w * self.w - (p - self.c).powi(2)) * (1.0 + self.tilt * p)
    }

    /// What of it was found wrongly, if anything.
    fn missed(&self, found: Vec<f64>) -> Option<(f64, f64, Vec<f64>)> {
        let right = found.len() == 2
            && (found[0] - (self.c - self.w)).abs() < 1e-7
            && (found[1] - (self.c + self.w)).abs() < 1e-7;
        (!right).then_some((self.c, self.w, found))
    }
}

#[test]
fn two_hopf_points_within_a_default_step_are_found() {
    let (problem, start, p) = Polynomial::read(include_str!("data/double_hopf.json"));
    let mut found = Vec::new();
    for increasing in [true, false] {
        for max_step in [None, Some(0.03), Some(0.6)] {
            let settings = Settings {
                domain: Some((-3.0, 3.0)),
                increasing: Some(increasing),
                max_step,
                ..Settings::default()
            };
            found.push(places(&follow(&problem, &start, p, settings), &EventKind::Hopf));
        }
    }
    // on one side of the start only
    for known in [0.502_17, 0.513_68] {
        let passes = |hopf: &&Vec<f64>| hopf.iter().any(|p| (p - known).abs() < 1e-5);
        assert_eq!(found.iter().filter(passes).count(), 3, "{known}: {found:?}");
    }
}

/// Oscillations that grow in a narrow window only, along an equilibrium that moves and bends.
#[test]
fn narrow_windows_of_oscillation_are_seen() {
    let (mut random, mut missed) = (Random(11), Vec::new());
    for _ in 0..60 {
        let m = Member::new(&mut random);
        let Member { omega, bend: [k, l], .. } = m;
        let problem = DenseProblem::from_residual(3, &["p"], move |u, p, r| {
            let (x, y) = (u[0] - k * p[0] * p[0], u[1] - l * p[0]);
            let g = m.growth(p[0]) - x * x - y * y;
            r[0] = g * x - omega * y;
            r[1] = g * y + omega * x;
            r[2] = x - 2.0 * u[2] + p[0].sin();
        })
        .boxed();
        let start = [k, -l, -0.5 * 1f64.sin()];
        let settings = Settings { target: Some(1.0), ..Settings::default() };
        let branch = follow(&problem, &start, -1.0, settings);
        assert_eq!(branch.stopped.reason, StopReason::Target);
        missed.extend(m.missed(places(&branch, &EventKind::Hopf)));
        assert!(branch.statistics.newton_iterations < 600, "{:?}", branch.statistics);
    }
    assert!(missed.is_empty(), "{missed:?}");
}

/// Two pitchforks on a trivial branch, beside modes that stay stable.
#[test]
fn two_pitchforks_within_a_step_are_seen() {
    let (mut random, mut missed) = (Random(5), Vec::new());
    for _ in 0..60 {
        let m = Member::new(&mut random);
        let (cos, sin) = (m.omega.cos(), m.omega.sin());
        let k = m.bend[0];
        let problem = DenseProblem::from_residual(2, &["p"], move |u, p, r| {
            let (x, y) = (cos * u[0] + sin * u[1], cos * u[1] - sin * u[0]);
            let (f, g) = (m.growth(p[0]) * x - x * x * x, k * x * x - 3.0 * y);
            r[0] = cos * f - sin * g;
            r[1] = sin * f + cos * g;
        })
        .boxed();
        let settings = Settings { target: Some(1.0), ..Settings::default() };
        let branch = follow(&problem, &[0.0, 0.0], -1.0, settings);
        missed.extend(m.missed(places(&branch, &EventKind::BranchPoint)));
    }
    assert!(missed.is_empty(), "{missed:?}");
}

/// A hysteresis far narrower than a step: `p = c + u + u³ − 3 w² u` along `u`, turned and beside
/// another unknown.
#[test]
fn two_folds_within_a_step_are_seen() {
    let (mut random, mut missed) = (Random(7), Vec::new());
    for _ in 0..60 {
        let Member { c, w, tilt, bend: [k, l], .. } = Member::new(&mut random);
        // folds at u = c ± w
        let cubic = move |u: f64| (u - c).powi(3) - 3.0 * w * w * (u - c) + tilt * (u - c).powi(4);
        let problem = DenseProblem::from_residual(2, &["p"], move |u, p, r| {
            r[0] = p[0] - cubic(u[0]);
            r[1] = u[1] - k * u[0] - l * u[0] * u[0];
        })
        .boxed();
        let u = c - 0.9;
        let start = [u, k * u + l * u * u];
        let settings = Settings { target: Some(cubic(c + 0.9)), ..Settings::default() };
        let branch = follow(&problem, &start, cubic(u), settings);
        let found = places(&branch, &EventKind::Fold);
        if found.len() != 2 || found[0] <= found[1] {
            missed.push((c, w, found));
        }
    }
    assert!(missed.is_empty(), "{missed:?}");
}
