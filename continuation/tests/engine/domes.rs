//! Star domes of elastic bars: double branch points with the symmetry of a polygon, in a problem of
//! mechanics, from the residual alone.

#![allow(clippy::unwrap_used)]

use continuation::{
    Branch, DenseProblem, Event, EventKind, Problem, Settings, Shape, Stability, StopReason, Tracer,
};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

use crate::random;
use random::Random;

type Node = [f64; 3];

/// Apex, `n` nodes of a ring, and `n` supports between their directions; every node carries the load
/// `p`, the ring's a tenth of it.
struct Dome {
    free: Vec<Node>,
    fixed: Vec<Node>,
    bars: Vec<(usize, usize, f64)>,
}

impl Dome {
    /// The first node of the ring lies in the direction `turned`.
    fn new(n: usize, turned: f64) -> Self {
        let at = |radius: f64, height: f64, k: f64| {
            let (sin, cos) = (turned + TAU * k / n as f64).sin_cos();
            [radius * cos, radius * sin, height]
        };
        let mut free = vec![[0.0, 0.0, 0.35]];
        free.extend((0..n).map(|k| at(1.0, 0.25, k as f64)));
        let fixed: Vec<Node> = (0..n).map(|k| at(1.75, 0.0, k as f64 + 0.5)).collect();
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        for k in 0..n {
            let next = 1 + (k + 1) % n;
            pairs.extend([(0, 1 + k), (1 + k, next), (1 + k, n + 1 + k), (next, n + 1 + k)]);
        }
        let place = |i: usize| if i <= n { free[i] } else { fixed[i - n - 1] };
        let bars = pairs.iter().map(|&(i, j)| (i, j, distance(place(i), place(j)))).collect();
        Dome { free, fixed, bars }
    }

    fn residual(&self, u: &[f64], p: f64, r: &mut [f64]) {
        let n = self.free.len();
        let place = |i: usize| -> Node {
            if i < n {
                std::array::from_fn(|c| self.free[i][c] + u[3 * i + c])
            } else {
                self.fixed[i - n]
            }
        };
        r.fill(0.0);
        for i in 0..n {
            r[3 * i + 2] = if i == 0 { p } else { 0.1 * p };
        }
        for &(i, j, rest) in &self.bars {
            let (a, b) = (place(i), place(j));
            let length = distance(a, b);
            // Green's strain
            let force = 0.5 * (length * length / (rest * rest) - 1.0) / rest;
            for c in 0..3 {
                let pull = force * (b[c] - a[c]);
                if i < n {
                    r[3 * i + c] -= pull;
                }
                if j < n {
                    r[3 * j + c] += pull;
                }
            }
        }
    }
}

fn distance(a: Node, b: Node) -> f64 {
    (0..3).map(|c| (a[c] - b[c]).powi(2)).sum::<f64>().sqrt()
}

/// All displacements are zero at first: the places that they are added to are rounded, and moving a zero
/// by its last place does not show it.
#[test]
fn the_jacobian_of_the_unloaded_dome() {
    for n in 3..=9 {
        let dome = Dome::new(n, 0.0);
        let size = 3 * dome.free.len();
        let at = |k: usize, h: f64| {
            let (mut u, mut r) = (vec![0.0; size], vec![0.0; size]);
            u[k] = h;
            dome.residual(&u, 0.0, &mut r);
            r
        };
        // of third degree: differences over long steps are exact but for rounding
        let column = |k: usize| {
            let [a, b, c, d] = [0.5, -0.5, 1.0, -1.0].map(|h| at(k, h));
            (0..size).map(|i| (8.0 * (a[i] - b[i]) - (c[i] - d[i])) / 6.0).collect::<Vec<f64>>()
        };
        let columns: Vec<Vec<f64>> = (0..size).map(column).collect();
        let problem =
            DenseProblem::from_residual(size, &["p"], move |u, p, r| dome.residual(u, p[0], r));
        let mut found = problem.new_jacobian();
        problem.jacobian(&vec![0.0; size], &[0.0], &mut found).unwrap();
        for (k, column) in columns.iter().enumerate() {
            for (i, exact) in column.iter().enumerate() {
                let off = (found.get(i, k) - exact).abs();
                assert!(off < 1e-11, "{n} ({i}, {k}): {} {exact}", found.get(i, k));
            }
        }
    }
}

/// The way from a special point to the same distance on every branch that leaves it: steps may differ
/// in length, and the branches are curved.
fn sides<P: Problem>(problem: &P, trunk: &Branch, event: &Event) -> Vec<Vec<f64>> {
    let settings = Settings { max_step: Some(0.01), max_points: 6, ..Settings::default() };
    let mut ways: Vec<Vec<Vec<f64>>> = Vec::new();
    for direction in &event.crossing().unwrap().leaving {
        for forward in [true, false] {
            let side = Tracer::leaving(problem, trunk, event, direction, forward, settings.clone())
                .unwrap()
                .run(&mut |_| ControlFlow::Continue(()));
            let start = &side.points[0].u;
            let from_start = |u: &[f64]| u.iter().zip(start).map(|(u, s)| u - s).collect();
            ways.push(side.points.iter().map(|point| from_start(&point.u)).collect());
        }
    }
    let length = |d: &Vec<f64>| d.iter().map(|x| x * x).sum::<f64>().sqrt();
    let farthest = |way: &Vec<Vec<f64>>| way.iter().map(length).fold(0.0, f64::max);
    let common = 0.99 * ways.iter().map(farthest).fold(f64::INFINITY, f64::min);
    let at = |way: &Vec<Vec<f64>>| {
        let beyond = way.iter().position(|d| length(d) > common).unwrap();
        let (before, after) = (&way[beyond - 1], &way[beyond]);
        let part = (common - length(before)) / (length(after) - length(before));
        before.iter().zip(after).map(|(b, a)| b + part * (a - b)).collect()
    };
    ways.iter().map(at).collect()
}

/// The same displacements one corner on.
fn turn(u: &[f64], n: usize) -> Vec<f64> {
    let (sin, cos) = (TAU / n as f64).sin_cos();
    let mut turned = vec![0.0; u.len()];
    for i in 0..=n {
        let to = if i == 0 { 0 } else { 1 + i % n };
        let [x, y, z] = [0, 1, 2].map(|c| u[3 * i + c]);
        turned[3 * to..3 * to + 3].copy_from_slice(&[cos * x - sin * y, sin * x + cos * y, z]);
    }
    turned
}

fn angle(a: &[f64], b: &[f64]) -> f64 {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    (dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()).clamp(-1.0, 1.0).acos()
}

#[test]
fn double_branch_points_of_star_domes() {
    // turned anywhere: the same but for rounding, which decides nothing
    for (n, turned) in [5, 6, 7].into_iter().flat_map(|n| [(n, 0.0), (n, 0.37), (n, 1.1)]) {
        let dome = Dome::new(n, turned);
        let size = 3 * dome.free.len();
        let problem =
            DenseProblem::from_residual(size, &["p"], move |u, p, r| dome.residual(u, p[0], r))
                .with_stability(Stability::EnergyHessian)
                .boxed();
        let settings = Settings {
            target: Some(0.03),
            max_step: Some(0.01),
            max_points: 400,
            ..Settings::default()
        };
        let trunk = Tracer::new(&problem, "p", &vec![0.0; size], &[0.0], settings)
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(()));
        assert_eq!(trunk.stopped.reason, StopReason::Target, "{n}: {:?}", trunk.stopped);
        assert!(trunk.doubts.is_empty(), "{n}: {:?}", trunk.doubts);
        let double = trunk.events.iter().filter(|event| {
            event.unstable_before.zip(event.unstable_after).is_some_and(|(a, b)| a.abs_diff(b) == 2)
        });
        assert!(double.clone().count() >= 4, "{n}");
        for event in double {
            assert_eq!(event.kind, EventKind::BranchPoint);
            let crossing = event.crossing().unwrap();
            assert_eq!(crossing.multiplicity, 2, "{n}: {}", event.p);
            assert_eq!(crossing.shape, Shape::Multiple, "{n}: {}", event.p);
            // three lines where the mode is that of a triangle, two families of three with that of a hexagon
            let hexagon = n == 6 && event.p.abs() < 0.0103;
            let expected = match n {
                6 if hexagon => 6,
                6 => 3,
                _ => n,
            };
            assert_eq!(crossing.leaving.len(), expected, "{n}: {}", event.p);
            let sides = sides(&problem, &trunk, event);
            let case = format!("{n}: {}", event.p);
            assert_eq!(sides.len(), 2 * expected, "{case}");
            for (i, one) in sides.iter().enumerate() {
                let closest = sides[..i].iter().map(|other| angle(one, other)).fold(9.0, f64::min);
                assert!(closest > 0.2, "{case}: two of the directions are one branch, {closest}");
                let turned = turn(one, n);
                let same = sides.iter().map(|other| angle(&turned, other)).fold(9.0, f64::min);
                assert!(same < 0.02, "{case}: turned by a corner, it is no branch, {same}");
            }
        }
        // turned over, the dome does the same under the opposite load
        let mirrored = trunk.events.iter().zip(trunk.events.iter().rev());
        for (one, other) in mirrored {
            let allowed = one.error_estimate + other.error_estimate + 1e-12;
            assert!((one.p + other.p).abs() <= allowed, "{n}: {} {}", one.p, other.p);
            assert_eq!(one.kind, other.kind, "{n}");
        }
    }
}

/// Displacements that are small beside the places they are added to hide the rounding of these from a
/// move by their own last place; steps of powers of two may share it and agree on a wrong slope.
#[test]
fn slopes_are_not_the_rounding_of_what_unknowns_are_added_to() {
    let mut random = Random(12345);
    for (n, turned) in [(5, 0.1), (6, 0.5), (7, 0.9)] {
        let (dome, copy) = (Dome::new(n, turned), Dome::new(n, turned));
        let size = 3 * dome.free.len();
        let problem =
            DenseProblem::from_residual(size, &["p"], move |u, p, r| copy.residual(u, p[0], r));
        let mut found = problem.new_jacobian();
        for case in 0..2000 {
            let scale = 10f64.powf(random.between(-6.0, 0.0));
            let mut entry = || {
                let smaller = random.between(0.0, 1.0) < 0.5;
                let part = if smaller { 10f64.powf(random.between(-18.0, 0.0)) } else { 1.0 };
                scale * part * random.between(-1.0, 1.0)
            };
            let u: Vec<f64> = (0..size).map(|_| entry()).collect();
            problem.jacobian(&u, &[0.009], &mut found).unwrap();
            for k in 0..size {
                let at = |h: f64| {
                    let (mut moved, mut r) = (u.clone(), vec![0.0; size]);
                    moved[k] += h;
                    dome.residual(&moved, 0.009, &mut r);
                    r
                };
                // of third degree: differences over long steps are exact but for rounding
                let [a, b, c, d] = [0.5, -0.5, 1.0, -1.0].map(at);
                for i in 0..size {
                    let exact = (8.0 * (a[i] - b[i]) - (c[i] - d[i])) / 6.0;
                    let off = (found.get(i, k) - exact).abs();
                    assert!(off < 1e-9 * exact.abs().max(0.1), "{n} {case} ({i}, {k}): {off:e}");
                }
            }
        }
    }
}
