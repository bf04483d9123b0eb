//! Branches along which the unknowns grow without bound.

#![allow(clippy::unwrap_used)]

use continuation::{Branch, DenseProblem, Settings, StopReason, Tracer};
use std::ops::ControlFlow;

use crate::random;
use random::Random;

fn follow(
    f: impl Fn(f64, f64) -> f64 + Send + Sync + 'static,
    (u, p): (f64, f64),
    settings: Settings,
) -> Branch {
    let problem =
        DenseProblem::from_residual(1, &["p"], move |u, p, r| r[0] = f(u[0], p[0])).boxed();
    Tracer::new(&problem, "p", &[u], &[p], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()))
}

fn is_unbounded(branch: &Branch, pole: f64, case: &str) {
    let last = branch.points.last().unwrap();
    assert_eq!(branch.stopped.reason, StopReason::Unbounded, "{case}: {:?}", branch.stopped);
    assert!(branch.events.is_empty(), "{case}: {:?}", branch.events);
    let largest = last.u.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
    assert!((last.p - pole).abs() < 1e-3 && largest > 1e6, "{case}: {} {:?}", last.p, last.u);
    assert!(branch.points.len() < 3000, "{case}: {}", branch.points.len());
    assert!(!branch.is_complete());
}

#[test]
fn a_branch_to_infinity_ends_as_unbounded_without_invented_points() {
    let cubic = |u: f64, p: f64| 0.37 * u.powi(3) * (p - 0.3) - 0.71 * u * u * p - 1.0;
    let pole = |u: f64, p: f64| u * (p - 0.3) - 1.0;
    let root = |u: f64, p: f64| u * u * (p - 0.3) - 1.0;
    for target in [-3.0, 0.0, 0.29] {
        let settings = Settings { target: Some(target), ..Settings::default() };
        let starts = [(2.0, 1.0), (1.0 / 0.7, 1.0), (1.0 / 0.7f64.sqrt(), 1.0)];
        let branches = [
            follow(cubic, starts[0], settings.clone()),
            follow(pole, starts[1], settings.clone()),
            follow(root, starts[2], settings),
        ];
        for branch in branches {
            is_unbounded(&branch, 0.3, &format!("{target}"));
        }
    }
}

/// Poles of random places, signs and orders, beside an unknown that stays finite, seen from all sides.
#[test]
fn random_poles() {
    let mut seed = Random(3);
    let mut random = |low, high| seed.between(low, high);
    for case in 0..60 {
        let pole = random(-0.5, 0.5);
        let size = 10f64.powf(random(-1.0, 1.0));
        let sign = if random(0.0, 1.0) < 0.5 { 1.0 } else { -1.0 };
        let (order, angle, k) = (1 + case % 3, random(0.0, 3.0), random(-1.0, 1.0));
        let from = if random(0.0, 1.0) < 0.5 { 1.0 } else { -1.0 };
        let (cos, sin) = (angle.cos(), angle.sin());
        // xᵐ = c / |p − pole|, y = k sin p + 1/x
        let problem = DenseProblem::from_residual(2, &["p"], move |u, p, r| {
            let (x, y) = (cos * u[0] + sin * u[1], cos * u[1] - sin * u[0]);
            let f = (sign * x / size).powi(order) * from * (p[0] - pole) - 1.0;
            let g = (y - k * p[0].sin()) * x - 1.0;
            r[0] = cos * f - sin * g;
            r[1] = sin * f + cos * g;
        })
        .boxed();
        let x = sign * size / (1.0 - from * pole).powf(1.0 / f64::from(order));
        let y = 1.0 / x + k * from.sin();
        let start = [cos * x - sin * y, sin * x + cos * y];
        let settings = Settings { target: Some(-2.0 * from), ..Settings::default() };
        let branch = Tracer::new(&problem, "p", &start, &[from], settings)
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(()));
        is_unbounded(&branch, pole, &format!("{case}: order {order}, pole {pole}"));
    }
}

#[test]
fn large_numbers_are_not_infinite() {
    // in units in which it is large
    let settings = Settings { target: Some(1.0), ..Settings::default() };
    let branch = follow(|u, p| u - 1e9 * p, (0.0, 0.0), settings);
    assert_eq!(branch.stopped.reason, StopReason::Target);
}

#[test]
fn growth_of_any_size_that_takes_the_parameter_along_is_not_infinite() {
    // u = exp(p), to 1e13 times what it is at the start
    let settings = Settings { target: Some(30.0), ..Settings::default() };
    let branch = follow(|u, p| u * (-p).exp() - 1.0, (1.0, 0.0), settings);
    assert_eq!(branch.stopped.reason, StopReason::Target, "{:?}", branch.stopped);
}

#[test]
fn a_branch_that_leaves_a_neighbourhood_of_zero_is_not_infinite() {
    // from 1e-9 beside a trivial branch, on a nearly vertical one
    let settings = Settings { target: Some(1.5), ..Settings::default() };
    let branch = follow(|u, p| u * (p - 1.0) - u * u * u - 1e-9, (-1e-9, 0.0), settings);
    assert_eq!(branch.stopped.reason, StopReason::Target, "{:?}", branch.stopped);
}

#[test]
fn a_branch_that_turns_back_and_forth_without_end_is_called_a_cascade() {
    let settings =
        Settings { target: Some(2.0), max_points: 800, max_step: Some(0.1), ..Settings::default() };
    let branch = follow(|u, p| p - u.sin(), (0.0, 0.0), settings.clone());
    let stopped = &branch.stopped;
    assert_eq!(stopped.reason, StopReason::MaxPoints);
    let folds = branch.events.len();
    let words = format!("800 points was reached in a cascade of folds that goes on: {folds} folds");
    assert!(stopped.detail.contains(&words), "{}", stopped.detail);
    // one that only needs more points is not
    let settings = Settings { target: Some(1e3), max_step: Some(0.01), ..settings };
    let branch = follow(|u, p| p - u, (0.0, 0.0), settings);
    assert_eq!(branch.stopped.detail, "the limit of 800 points was reached");
}
