//! Branch points with several critical modes at once.

#![allow(clippy::unwrap_used)]

use continuation::{Branch, DenseProblem, EventKind, Problem, Settings, Shape, Tracer};
use std::ops::ControlFlow;

fn trunk<P: Problem>(problem: &P, n: usize) -> Branch {
    let settings = Settings { target: Some(1.0), ..Settings::default() };
    Tracer::new(problem, "p", &vec![0.0; n], &[-1.0], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()))
}

/// End points of all branches that leave the only branch point, both ways.
fn ends<P: Problem>(problem: &P, branch: &Branch, settings: &Settings) -> Vec<(f64, Vec<f64>)> {
    let event = &branch.events[0];
    let mut ends = Vec::new();
    for direction in &event.crossing().unwrap().leaving {
        for forward in [true, false] {
            let side =
                Tracer::leaving(problem, branch, event, direction, forward, settings.clone())
                    .unwrap()
                    .run(&mut |_| ControlFlow::Continue(()));
            assert!(side.stopped.reason.is_complete(), "{:?}", side.stopped);
            let end = side.points.last().unwrap();
            ends.push((end.p, end.u.clone()));
        }
    }
    ends
}

#[test]
fn two_modes_with_the_symmetry_of_the_square() {
    let problem = DenseProblem::from_residual(2, &["p"], |u, p, r| {
        let (x, y) = (u[0], u[1]);
        r[0] = p[0] * x - x * (x * x + 3.0 * y * y);
        r[1] = p[0] * y - y * (y * y + 3.0 * x * x);
    })
    .boxed();
    let branch = trunk(&problem, 2);
    assert_eq!(branch.events.len(), 1);
    let event = &branch.events[0];
    assert_eq!(event.kind, EventKind::BranchPoint);
    assert!(event.p.abs() < 1e-10, "{}", event.p);
    assert_eq!((event.unstable_before, event.unstable_after), (Some(0), Some(2)));
    let crossing = event.crossing().unwrap();
    assert_eq!((crossing.shape, crossing.multiplicity), (Shape::Multiple, 2));
    assert_eq!(crossing.leaving.len(), 4, "two axes, two diagonals");
    let settings = Settings { target: Some(1.0), ..Settings::default() };
    let ends = ends(&problem, &branch, &settings);
    for (p, u) in &ends {
        // axes: x² = p; diagonals: 4 x² = p
        let size = u[0].hypot(u[1]);
        let axis = (u[0] * u[1]).abs() < 1e-9;
        let known: f64 = if axis { 1.0 } else { 0.5f64.sqrt() };
        assert!((size - known).abs() < 1e-9 && *p == 1.0, "{u:?}");
    }
    for (i, (_, u)) in ends.iter().enumerate() {
        assert!(ends[..i].iter().all(|(_, v)| (u[0] - v[0]).hypot(u[1] - v[1]) > 0.1));
    }
}

#[test]
fn three_modes_that_resonate() {
    // hexagons: quadratic terms, four branches through the point
    let problem = DenseProblem::from_residual(3, &["p"], |u, p, r| {
        let sum: f64 = u.iter().map(|x| x * x).sum();
        for i in 0..3 {
            let (y, z) = (u[(i + 1) % 3], u[(i + 2) % 3]);
            r[i] = p[0] * u[i] + 0.5 * y * z - u[i] * (2.0 * sum - u[i] * u[i]);
        }
    })
    .boxed();
    let branch = trunk(&problem, 3);
    assert_eq!(branch.events.len(), 1);
    let crossing = branch.events[0].crossing().unwrap();
    assert!(branch.events[0].p.abs() < 1e-10);
    assert_eq!(crossing.multiplicity, 3);
    // rolls along each axis, hexagons along the diagonals
    assert_eq!(crossing.leaving.len(), 7, "{:?}", crossing.leaving);
    let settings = Settings { domain: Some((-1.0, 0.9)), ..Settings::default() };
    let mut rolls = 0;
    for (_, u) in ends(&problem, &branch, &settings) {
        let x = u.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let hexagon = u.iter().all(|v| (v.abs() - x).abs() < 1e-9);
        let roll = u.iter().filter(|v| v.abs() < 1e-9).count() == 2;
        assert!(x > 0.1 && (hexagon || roll), "{u:?}");
        rolls += usize::from(roll);
    }
    assert_eq!(rolls, 6);
}

/// Two branch points a millionth of the range apart are two.
#[test]
fn near_but_not_the_same() {
    for gap in [1e-2, 1e-4, 1e-6, 1e-7] {
        let problem = DenseProblem::from_residual(2, &["p"], move |u, p, r| {
            let (x, y) = (u[0], u[1]);
            r[0] = p[0] * x - x * (x * x + 3.0 * y * y);
            r[1] = (p[0] - gap) * y - y * (y * y + 3.0 * x * x);
        })
        .boxed();
        let branch = trunk(&problem, 2);
        let found: Vec<f64> = branch.events.iter().map(|e| e.p).collect();
        assert_eq!(found.len(), 2, "{gap}: {found:?}");
        assert!(found[0].abs() < 1e-11 && (found[1] - gap).abs() < 1e-11, "{gap}: {found:?}");
        for event in &branch.events {
            assert_eq!(event.crossing().unwrap().shape, Shape::Pitchfork);
        }
    }
}

/// `ż = (p − |z|²) z + c z̄^{n−1}`, beside an unknown that follows, in turned coordinates: `n` lines of
/// branches, at the angles `π k/n`.
#[test]
fn two_modes_with_the_symmetry_of_a_polygon() {
    for corners in 5..=9_i32 {
        for (c, turn) in [(0.3, 0.4), (-0.4, 1.1), (0.05, 0.0)] {
            let (sin, cos) = f64::sin_cos(turn);
            let problem = DenseProblem::from_residual(3, &["p"], move |u, p, r| {
                let (x, y) = (cos * u[0] + sin * u[1], cos * u[1] - sin * u[0]);
                let square = x * x + y * y;
                // z̄^{n−1}
                let (mut re, mut im) = (1.0, 0.0);
                for _ in 1..corners {
                    (re, im) = (re * x + im * y, im * x - re * y);
                }
                let f = (p[0] - square) * x + c * re + 0.3 * u[2] * x;
                let g = (p[0] - square) * y + c * im + 0.3 * u[2] * y;
                (r[0], r[1]) = (cos * f - sin * g, sin * f + cos * g);
                r[2] = 0.5 * square - u[2];
            })
            .boxed();
            let branch = trunk(&problem, 3);
            let case = format!("{corners} corners, {c}");
            assert_eq!(branch.events.len(), 1, "{case}: {:?}", branch.events);
            let crossing = branch.events[0].crossing().unwrap();
            assert_eq!(crossing.shape, Shape::Multiple, "{case}");
            assert_eq!(crossing.leaving.len(), corners as usize, "{case}");
            let settings = Settings { target: Some(0.3), ..Settings::default() };
            let ends = ends(&problem, &branch, &settings);
            let mut angles: Vec<f64> = Vec::new();
            for (p, u) in &ends {
                assert_eq!(*p, 0.3);
                let angle = u[1].atan2(u[0]) - turn;
                let steps = angle * f64::from(corners) / std::f64::consts::PI;
                assert!((steps - steps.round()).abs() < 1e-6, "{case}: {angle}");
                angles.push(steps.round().rem_euclid(2.0 * f64::from(corners)));
            }
            angles.sort_by(f64::total_cmp);
            let all: Vec<f64> = (0..2 * corners).map(f64::from).collect();
            assert_eq!(angles, all, "{case}");
        }
    }
}

/// A circle of branches: one stands for all.
#[test]
fn a_circle_of_branches_is_not_a_polygon() {
    let problem = DenseProblem::from_residual(2, &["p"], |u, p, r| {
        let square = u[0] * u[0] + u[1] * u[1];
        (r[0], r[1]) = ((p[0] - square) * u[0], (p[0] - square) * u[1]);
    })
    .boxed();
    let branch = trunk(&problem, 2);
    let crossing = branch.events[0].crossing().unwrap();
    assert_eq!((crossing.shape, crossing.leaving.len()), (Shape::Multiple, 1));
}
