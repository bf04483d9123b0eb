//! Branches that come close to each other: followed through the avoided crossing at every step
//! length, or the trace stops and says so; never a jump from one to the other.

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

/// Imperfect pitchforks in a rotated plane: the branch from below bends onto the stable side, and
/// has no event, however small the imperfection.
#[test]
fn imperfect_pitchforks_are_followed_or_the_trace_stops() {
    let mut random = Random(7);
    let (mut followed, mut stopped) = (0, 0);
    for case in 0..60 {
        let gap = 10f64.powf(random.between(-17.0, -2.0));
        let (angle, place) = (random.between(0.0, 6.0), random.between(-0.3, 0.3));
        let (sin, cos) = f64::sin_cos(angle);
        let problem = DenseProblem::from_residual(2, &["p"], move |u, p, r| {
            let (x, y) = (cos * u[0] + sin * u[1], cos * u[1] - sin * u[0]);
            r[0] = (p[0] - place) * x - x.powi(3) + gap;
            r[1] = y - 0.3 * p[0] - x * x;
        })
        .boxed();
        let start = |x: f64, p: f64| {
            let y = 0.3 * p + x * x;
            [cos * x - sin * y, sin * x + cos * y]
        };
        for max_step in [None, Some(0.01), Some(0.05), Some(0.3)] {
            let settings = Settings { target: Some(1.0), max_step, ..Settings::default() };
            let branch = follow(&problem, &start(gap / (1.0 + place), -1.0), -1.0, settings);
            let last = branch.points.last().unwrap();
            let x = cos * last.u[0] + sin * last.u[1];
            let right = (1.0 - place).sqrt();
            match branch.stopped.reason {
                // what is exact to rounding is a pitchfork
                StopReason::Target if gap < 1e-13 && x.abs() < 0.1 => {
                    assert_eq!(branch.events.len(), 1, "{case} {gap:e}: {:?}", branch.events);
                    assert!((branch.events[0].p - place).abs() < 1e-6, "{case} {gap:e}");
                }
                StopReason::Target => {
                    assert!(branch.events.is_empty(), "{case} {gap:e}: {:?}", branch.events);
                    assert!((x - right).abs() < 1e-2, "{case} {gap:e} {max_step:?}: x = {x}");
                    followed += 1;
                }
                StopReason::BranchesTooClose => {
                    assert!(gap < 1e-9 && branch.events.is_empty(), "{case} {gap:e}");
                    assert!((last.p - place).abs() < 1e-3, "{case} {gap:e}: {}", last.p);
                    stopped += 1;
                }
                reason => panic!("{case} {gap:e} {max_step:?}: {reason} {}", branch.stopped.detail),
            }
        }
    }
    assert!(followed > 100, "{followed} followed, {stopped} stopped");
}

/// An exact branch point with branches at an acute angle is met at every step length.
#[test]
fn an_acute_crossing_is_met_at_every_step_length() {
    let (problem, start, p) = Polynomial::read(include_str!("data/crossing.json"));
    for factor in [0.2, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0] {
        let settings = Settings {
            domain: Some((-3.0, 3.0)),
            increasing: Some(true),
            max_step: Some(0.3 * factor),
            ..Settings::default()
        };
        let branch = follow(&problem, &start, p, settings);
        let last = branch.points.last().unwrap();
        assert_eq!(branch.stopped.reason, StopReason::Domain, "{factor}");
        let found: Vec<f64> = branch.events_of(&EventKind::BranchPoint).map(|e| e.p).collect();
        assert_eq!(found.len(), 1, "{factor}: {found:?}");
        assert!((found[0] + 0.004_525_755).abs() < 1e-8, "{factor}: {found:?}");
        assert!(last.p == -3.0 && (last.u[0] - 16.543_612_449_9).abs() < 1e-6, "{factor}");
    }
}

/// Two branches that cross at any acute angle at any part of a step: the branch that was begun with is
/// the one that is followed.
#[test]
fn no_step_cuts_the_corner_of_an_acute_crossing() {
    let mut random = Random(19);
    let mut wrong = Vec::new();
    for case in 0..3000 {
        let place = random.between(-0.5, 0.5);
        let slope = random.between(-1.0, 1.0);
        let opening = 10f64.powf(random.between(-1.7, 0.0));
        let [b, c] = [random.between(-0.4, 0.4), random.between(-0.2, 0.2) * opening];
        let turn = random.between(0.0, 3.0);
        let (sin, cos) = f64::sin_cos(turn);
        let cubic = random.between(-0.3, 0.3);
        let own = move |p: f64| {
            slope * (p - place) + b * (p - place).powi(2) + cubic * (p - place).powi(3)
        };
        let other = move |p: f64| own(p) + opening * (p - place) + c * (p - place).powi(2);
        let problem = DenseProblem::from_residual(2, &["p"], move |u, p, r| {
            let (x, y) = (cos * u[0] + sin * u[1], cos * u[1] - sin * u[0]);
            let (f, g) = ((x - own(p[0])) * (x - other(p[0])), y - 0.5 * x);
            r[0] = cos * f - sin * g;
            r[1] = sin * f + cos * g;
        })
        .boxed();
        let at = |x: f64| [cos * x - sin * 0.5 * x, sin * x + cos * 0.5 * x];
        let max_step = Some(10f64.powf(random.between(-2.0, 0.3)));
        let settings = Settings { target: Some(1.0), max_step, ..Settings::default() };
        let branch = follow(&problem, &at(own(-1.0)), -1.0, settings);
        let last = branch.points.last().unwrap();
        let found: Vec<f64> = branch.events_of(&EventKind::BranchPoint).map(|e| e.p).collect();
        let right = branch.stopped.reason == StopReason::Target
            && (cos * last.u[0] + sin * last.u[1] - own(1.0)).abs() < 1e-6
            && found.len() == 1
            && (found[0] - place).abs() < 1e-6;
        if !right {
            wrong.push((case, opening, place, max_step, found, last.u.clone(), last.p));
        }
    }
    assert!(wrong.is_empty(), "{} wrong: {wrong:#?}", wrong.len());
}
