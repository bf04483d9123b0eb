//! Random polynomial equations of degree 3: the special points and counts of a trace with default steps
//! are those that much shorter steps and the roots of characteristic polynomials show.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use continuation::linalg::Dense;
use continuation::{Branch, EventKind, Problem, Settings, StopReason, Tracer};
use std::ops::ControlFlow;

use crate::polynomial;
use polynomial::Polynomial;

use crate::random;
use random::Random;

impl Random {
    fn signed(&mut self) -> f64 {
        self.between(-1.0, 1.0)
    }

    fn below(&mut self, n: usize) -> usize {
        self.between(0.0, n as f64) as usize
    }
}

/// `n` equations with all linear terms and `3 n` others, which hold at the state returned; with
/// `trivial`, the first one has the factor `u_1`, which is zero there.
fn random_system(random: &mut Random, n: usize, trivial: bool) -> (Polynomial, Vec<f64>) {
    let mut u: Vec<f64> = (0..n).map(|_| random.signed()).collect();
    if trivial {
        u[0] = 0.0;
    }
    let p = -1.0_f64;
    let mut equations = Vec::new();
    for i in 0..n {
        let mut terms: Vec<(f64, Vec<i32>)> = Vec::new();
        for k in 0..=n {
            let mut powers = vec![0; n + 1];
            powers[k] = 1;
            terms.push((random.signed(), powers));
        }
        for _ in 0..3 * n {
            let mut powers = vec![0; n + 1];
            for _ in 0..2 + random.below(2) {
                powers[random.below(n + 1)] += 1;
            }
            terms.push((random.signed(), powers));
        }
        // grows nowhere without bound, at least by itself
        let mut own = vec![0; n + 1];
        own[i] = 3;
        terms.push((-1.0, own));
        if trivial && i == 0 {
            for (_, powers) in &mut terms {
                if powers[0] == 0 {
                    let most = (0..=n).max_by_key(|&k| powers[k]).unwrap();
                    if powers.iter().sum::<i32>() == 3 {
                        powers[most] -= 1;
                    }
                    powers[0] = 1;
                }
            }
        } else {
            let value: f64 = terms
                .iter()
                .map(|(c, powers)| {
                    let factors = u.iter().chain([&p]).zip(powers).map(|(x, q)| x.powi(*q));
                    c * factors.product::<f64>()
                })
                .sum();
            terms.push((-value, vec![0; n + 1]));
        }
        equations.push(terms);
    }
    (Polynomial::new(equations), u)
}

/// The coefficients of the characteristic polynomial, the leading one first (Faddeev-LeVerrier).
fn characteristic(a: &[Vec<f64>]) -> Vec<f64> {
    let n = a.len();
    let mut coefficients = vec![1.0];
    let mut m = vec![vec![0.0; n]; n];
    for k in 1..=n {
        for (i, row) in m.iter_mut().enumerate() {
            row[i] += coefficients[k - 1];
        }
        let product: Vec<Vec<f64>> = (0..n)
            .map(|i| (0..n).map(|j| (0..n).map(|l| a[i][l] * m[l][j]).sum()).collect())
            .collect();
        let trace: f64 = (0..n).map(|i| product[i][i]).sum();
        coefficients.push(-trace / k as f64);
        m = product;
    }
    coefficients
}

/// Roots of a monic polynomial (Durand-Kerner).
fn roots(c: &[f64]) -> Vec<(f64, f64)> {
    let n = c.len() - 1;
    let by_order = |(k, c): (usize, &f64)| c.abs().powf(1.0 / k as f64);
    let radius = c.iter().enumerate().skip(1).map(by_order).fold(0.0, f64::max);
    let mut z: Vec<(f64, f64)> = (0..n)
        .map(|k| {
            let angle = 0.4 + std::f64::consts::TAU * k as f64 / n as f64;
            (radius * angle.cos(), radius * angle.sin())
        })
        .collect();
    let mul = |a: (f64, f64), b: (f64, f64)| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
    for _ in 0..500 {
        let mut moved = 0.0_f64;
        for k in 0..n {
            let value = c.iter().skip(1).fold((1.0, 0.0), |v, c| {
                let v = mul(v, z[k]);
                (v.0 + c, v.1)
            });
            let others = (0..n).filter(|&l| l != k);
            let d = others.fold((1.0, 0.0), |d, l| mul(d, (z[k].0 - z[l].0, z[k].1 - z[l].1)));
            let size = d.0 * d.0 + d.1 * d.1;
            let step = mul(value, (d.0 / size, -d.1 / size));
            z[k] = (z[k].0 - step.0, z[k].1 - step.1);
            moved = moved.max(step.0.hypot(step.1));
        }
        if moved < 1e-14 * radius {
            break;
        }
    }
    z
}

/// Unstable eigenvalues, and the sign of the determinant.
fn judged(problem: &Polynomial, u: &[f64], p: f64) -> (usize, bool) {
    let n = problem.dim();
    let mut j = Dense::new(n);
    problem.jacobian(u, &[p], &mut j).unwrap();
    let rows: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|k| j.get(i, k)).collect()).collect();
    let c = characteristic(&rows);
    (roots(&c).iter().filter(|z| z.0 > 0.0).count(), c[n] > 0.0)
}

fn trace(problem: &Polynomial, u: &[f64], max_step: Option<f64>) -> Branch {
    let settings =
        Settings { domain: Some((-3.0, 3.0)), max_step, max_points: 40_000, ..Settings::default() };
    Tracer::new(problem, "p", u, &[-1.0], settings).unwrap().run(&mut |_| ControlFlow::Continue(()))
}

/// What changes along the branch, from its points alone: kind and parameter.
fn independent(problem: &Polynomial, fine: &Branch) -> Vec<(EventKind, f64)> {
    let points: Vec<_> = fine.points.iter().filter(|point| point.event.is_none()).collect();
    let mut found = Vec::new();
    let mut before = judged(problem, &points[0].u, points[0].p);
    for pair in points.windows(2) {
        let after = judged(problem, &pair[1].u, pair[1].p);
        let p = 0.5 * (pair[0].p + pair[1].p);
        let fold = pair[0].dp_ds * pair[1].dp_ds < 0.0;
        if fold {
            found.push((EventKind::Fold, p));
        }
        if (before.1 != after.1) != fold {
            found.push((EventKind::BranchPoint, p));
        }
        if before.0.abs_diff(after.0) >= 2 {
            found.push((EventKind::Hopf, p));
        }
        before = after;
    }
    found
}

#[test]
fn special_points_and_counts_of_random_systems() {
    let mut random = Random(5);
    let (mut compared, mut special, mut wrong, mut said) = (0, 0, Vec::new(), 0);
    for case in 0..500 {
        let n = 1 + case % 6;
        let trivial = case % 4 == 3;
        let (problem, u) = random_system(&mut random, n, trivial);
        let branch = trace(&problem, &u, None);
        let fine = trace(&problem, &u, Some(6.0 / 20.0 / 12.0));
        if fine.stopped.reason == StopReason::MaxPoints {
            continue;
        }
        compared += 1;
        let own: Vec<(EventKind, f64)> =
            branch.events.iter().map(|e| (e.kind.clone(), e.p)).collect();
        let known = independent(&problem, &fine);
        special += known.len();
        let mut faults = Vec::new();
        let alike = own.len() == known.len()
            && own.iter().zip(&known).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() < 0.05);
        if !alike {
            faults.push(format!("events {own:?}, known {known:?}"));
        }
        for point in branch.points.iter().filter(|point| point.event.is_none()) {
            let (unstable, _) = judged(&problem, &point.u, point.p);
            if point.certified && point.unstable != Some(unstable) {
                faults.push(format!("count {:?}, known {unstable} at {}", point.unstable, point.p));
            }
        }
        // where a loop is found closed depends on the steps
        let closed = branch.stopped.reason == StopReason::ClosedLoop;
        let (a, b) = (branch.points.last().unwrap(), fine.points.last().unwrap());
        let off = a.u.iter().zip(&b.u).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        if branch.stopped.reason != fine.stopped.reason || (!closed && off > 1e-6) {
            faults.push(format!("ends {:?} and {:?}, {off:.1e}", branch.stopped, fine.stopped));
        }
        if !faults.is_empty() {
            if branch.is_complete() && branch.is_certain() {
                wrong.push(format!("{case} (n = {n}): {}", faults.join("; ")));
            } else {
                said += 1;
            }
        }
    }
    println!("{compared} systems, {special} special points; {said} said to be uncertain");
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(compared > 480 && special > 1000 && said < 10);
}
