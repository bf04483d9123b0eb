//! Every tolerance does what it says: a bound that holds with the default fails when the tolerance
//! is a hundred times looser.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use continuation::samples::Cusp;
use continuation::{Branch, EventKind, Settings, Tracer};
use std::ops::ControlFlow;

fn trace(settings: Settings) -> Branch {
    let settings = Settings { target: Some(2.0), ..settings };
    Tracer::new(&Cusp, "mu", &[-1.5], &[-2.0, 1.0], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()))
}

/// Largest deviation of a point from the curve.
fn off(branch: &Branch) -> f64 {
    let residual = |p: &continuation::Point| (p.p + p.u[0] - p.u[0].powi(3)).abs();
    branch.points.iter().map(residual).fold(0.0, f64::max)
}

#[test]
fn tolerance_bounds_the_distance_from_the_branch() {
    let with = |factor: f64| {
        let default = Settings::default();
        off(&trace(Settings { tolerance: factor * default.tolerance, ..default }))
    };
    assert!(with(1.0) < 1e-11, "{:e}", with(1.0));
    assert!(with(100.0) > 1e-11, "{:e}", with(100.0));
}

#[test]
fn event_tolerance_bounds_the_place_of_special_points() {
    let exact = 1.0 / 3f64.sqrt();
    let with = |factor: f64| {
        let default = Settings::default();
        let mut worst = 0.0_f64;
        for k in 0..20 {
            let settings = Settings {
                event_tolerance: factor * default.event_tolerance,
                max_step: Some(0.2 * 1.2f64.powi(k)),
                ..default.clone()
            };
            let branch = trace(settings);
            for fold in branch.events_of(&EventKind::Fold) {
                let error = (branch.points[fold.point].u[0].abs() - exact).abs();
                assert!(error < 3.0 * fold.error_estimate + 1e-15, "an honest estimate");
                worst = worst.max(error);
            }
        }
        worst
    };
    println!("{:e} {:e}", with(1.0), with(100.0));
    assert!(with(1.0) < 1e-11, "{:e}", with(1.0));
    assert!(with(100.0) > 1e-11, "{:e}", with(100.0));
}

#[test]
fn max_angle_bounds_the_turn_of_a_step() {
    let turn = |branch: &Branch| {
        let angle = |p: &continuation::Point| {
            let slope = 3.0 * p.u[0] * p.u[0] - 1.0; // dμ/dx
            1f64.atan2(slope)
        };
        let pairs = branch.points.windows(2);
        pairs.map(|w| (angle(&w[0]) - angle(&w[1])).abs()).fold(0.0, f64::max)
    };
    let with = |max_angle: f64| {
        turn(&trace(Settings { max_angle, max_step: Some(4.0), ..Settings::default() }))
    };
    let limit = Settings::default().max_angle;
    println!("{} {}", with(limit), with(4.0 * limit));
    // twice the limit: the tracer measures in its scaled metric
    assert!(with(limit) < 2.0 * limit, "{}", with(limit));
    assert!(with(4.0 * limit) > 2.0 * limit, "{}", with(4.0 * limit));
}
