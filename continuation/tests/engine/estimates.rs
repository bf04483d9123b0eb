//! `error_estimate` is never below the true error: random folds, branch points and zeros in closed form.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use continuation::{Branch, DenseProblem, EventKind, Problem, Settings, Tracer, Watch};
use std::ops::ControlFlow;

struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        2.0 * (self.0 >> 11) as f64 / (1u64 << 53) as f64 - 1.0
    }
}

fn horner(c: &[f64], x: f64) -> f64 {
    c.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

fn derivative(c: &[f64]) -> Vec<f64> {
    c.iter().enumerate().skip(1).map(|(k, c)| k as f64 * c).collect()
}

/// Sign changes between `lo` and `hi`, by bisection of a fine partition.
fn roots(c: &[f64], lo: f64, hi: f64) -> Vec<f64> {
    let at = |k: usize| lo + (hi - lo) * k as f64 / 4000.0;
    let mut found = Vec::new();
    for k in 0..4000 {
        let (mut a, mut b) = (at(k), at(k + 1));
        if horner(c, a) * horner(c, b) < 0.0 {
            for _ in 0..80 {
                let m = 0.5 * (a + b);
                if horner(c, a) * horner(c, m) <= 0.0 { b = m } else { a = m }
            }
            found.push(0.5 * (a + b));
        }
    }
    found
}

fn trace<P: Problem>(problem: &P, u: &[f64], p: f64) -> Branch {
    let settings =
        Settings { domain: Some((-300.0, 300.0)), max_points: 400, ..Settings::default() };
    let watches = [Watch::zero("u")];
    let tracer = Tracer::new(problem, "p", u, &[p], settings).unwrap().watching(&watches).unwrap();
    tracer.run(&mut |_| ControlFlow::Continue(()))
}

/// `p = P(u)` in units of any size: folds where `P' = 0`, zeros of `u` at `p = P(0)`.
#[test]
fn folds_and_zeros_of_random_polynomials() {
    let mut random = Random(3);
    let (mut folds, mut zeros) = (0, 0);
    for case in 0..300 {
        let degree = 2 + case % 4;
        let mut c: Vec<f64> = (0..=degree).map(|_| 2.0 * random.next()).collect();
        c[degree] += 0.5_f64.copysign(c[degree]);
        let unit = 10f64.powf(4.0 * random.next());
        let inner = c.clone();
        let problem = DenseProblem::from_residual(1, &["p"], move |u, p, r| {
            r[0] = p[0] - horner(&inner, u[0] / unit);
        })
        .boxed()
        .observing("u", |u, _| u[0]);
        let start = -2.0;
        let branch = trace(&problem, &[start * unit], horner(&c, start));
        let turns = roots(&derivative(&c), -20.0, 20.0);
        for event in &branch.events {
            let point = &branch.points[event.point];
            let near = match event.kind {
                EventKind::Fold => {
                    folds += 1;
                    let away = |x: &f64| (x * unit - point.u[0]).abs();
                    turns.iter().copied().min_by(|a, b| away(a).total_cmp(&away(b))).unwrap()
                }
                EventKind::Zero(_) => {
                    zeros += 1;
                    0.0
                }
                _ => continue,
            };
            let size = (point.u[0].abs() + unit).hypot(point.p.abs() + 1.0);
            let off = (point.u[0] - near * unit).hypot(point.p - horner(&c, near));
            let rounding = 16.0 * f64::EPSILON * size;
            assert!(
                off <= event.error_estimate + rounding,
                "{case}: {} at {}: {off:e}, estimate {:e}",
                event.kind,
                point.p,
                event.error_estimate
            );
        }
    }
    println!("{folds} folds, {zeros} zeros");
    assert!(folds > 150 && zeros > 80);
}

/// `u (p − P(u))`, `P(0) = p₀`: transcritical points and pitchforks at `p₀`, in units of any size.
#[test]
fn branch_points_of_random_polynomials() {
    let mut random = Random(5);
    let mut found = 0;
    for case in 0..150 {
        let mut c: Vec<f64> = (0..4).map(|_| 2.0 * random.next()).collect();
        if case % 3 == 0 {
            c[1] = 0.0;
        }
        let unit = 10f64.powf(4.0 * random.next());
        let inner = c.clone();
        let problem = DenseProblem::from_residual(1, &["p"], move |u, p, r| {
            r[0] = u[0] / unit * (p[0] - horner(&inner, u[0] / unit));
        })
        .boxed()
        .observing("u", |u, _| u[0]);
        let branch = trace(&problem, &[0.0], -4.0);
        let events: Vec<_> = branch.events_of(&EventKind::BranchPoint).collect();
        assert_eq!(events.len(), 1, "{case}");
        let point = &branch.points[events[0].point];
        let off = point.u[0].hypot(point.p - c[0]);
        assert!(off <= events[0].error_estimate + 1e-15, "{case}: {off:e} {events:?}");
        found += 1;
    }
    assert_eq!(found, 150);
}
