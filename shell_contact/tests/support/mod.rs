//! A small Newton method and arclength walk, enough to reach the reference states.
#![allow(dead_code, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use continuation::linalg::SymmetricBand;
use continuation::{Matrix, Problem};
use shell_contact::contact::parameter::Z0;
use shell_contact::{ContactProblem, Dimensionless, Law, Mesh, Shell};

pub(crate) fn contact(elements: usize, law: Law, d: [f64; 6]) -> ContactProblem {
    with_poisson(elements, law, 0.5, d)
}

pub(crate) fn with_poisson(elements: usize, law: Law, poisson: f64, d: [f64; 6]) -> ContactProblem {
    let [bending, pressure, adhesion, film, surface_tension, gas_exponent] = d;
    let groups = Dimensionless { bending, pressure, adhesion, film, surface_tension, gas_exponent };
    let mesh = Mesh::uniform(elements).unwrap();
    ContactProblem::new(&Shell { law, poisson }, &groups, mesh).unwrap()
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn largest(a: &[f64]) -> f64 {
    a.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// Newton's method at fixed parameters, halving steps that leave the model; the number of
/// negative eigenvalues of the last Hessian.
pub(crate) fn newton(problem: &ContactProblem, u: &mut [f64], p: &[f64]) -> Option<usize> {
    let n = problem.dim();
    let (mut r, mut j) = (vec![0.0; n], problem.new_jacobian());
    let mut last = f64::INFINITY;
    for _ in 0..30 {
        problem.linearise(u, p, &mut r, &mut j).ok()?;
        let facts = factor(&mut j);
        j.solve(&mut r);
        let size = largest(&r);
        if size < 1e-11 || (size < 1e-9 && size > 0.3 * last) {
            return facts;
        }
        last = size;
        let mut share = 1.0;
        let trial =
            |share: f64| -> Vec<f64> { u.iter().zip(&r).map(|(u, d)| u - share * d).collect() };
        while problem.admissible(&trial(share), p).is_err() {
            share *= 0.5;
            if share < 1e-3 {
                return None;
            }
        }
        u.copy_from_slice(&trial(share));
    }
    None
}

fn factor(j: &mut SymmetricBand) -> Option<usize> {
    let floor = f64::EPSILON * j.norm();
    j.factor(floor).inertia.map(|(negative, _)| negative)
}

/// A point of the walk.
#[derive(Clone)]
pub(crate) struct Point {
    pub(crate) z0: f64,
    pub(crate) u: Vec<f64>,
}

/// Walks from `start` to `end` by arclength and visits every accepted point.
pub(crate) fn walk(
    problem: &ContactProblem,
    start: f64,
    end: f64,
    mut visit: impl FnMut(&Point, &Point),
) {
    let n = problem.dim();
    let mut p = problem.parameters_at(start);
    let mut u = problem.initial_state();
    newton(problem, &mut u, &p).expect("the free shell");
    let (mut r, mut rp, mut m) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let mut j = problem.new_jacobian();
    let (mut tu, mut tp) = (vec![0.0; n], -1.0);
    let mut step = 1e-3;
    for _ in 0..3000 {
        // tangent
        problem.linearise(&u, &p, &mut r, &mut j).unwrap();
        problem.parameter_derivative(&u, &p, Z0, &mut rp).unwrap();
        factor(&mut j);
        j.solve(&mut rp);
        problem.metric(&rp, &mut m);
        let length = (1.0 + dot(&rp, &m)).sqrt();
        let ahead = tp - dot(&tu, &m); // with the new direction (-rp, 1)
        tp = ahead.signum() / length;
        for i in 0..n {
            tu[i] = -rp[i] * tp;
        }
        loop {
            assert!(step > 1e-9, "walk stuck at z0 = {}", p[0]);
            match correct(problem, &u, &p, &tu, tp, step) {
                Some((new_u, new_p, iterations)) => {
                    let before = Point { z0: p[0], u: std::mem::take(&mut u) };
                    let after = Point { z0: new_p[0], u: new_u };
                    visit(&before, &after);
                    u = after.u;
                    p = new_p;
                    step = (step * if iterations <= 4 { 1.4 } else { 0.8 }).min(8e-3);
                    break;
                }
                None => step *= 0.5,
            }
        }
        if p[0] <= end {
            return;
        }
    }
    panic!("walk did not arrive");
}

fn correct(
    problem: &ContactProblem,
    u0: &[f64],
    p0: &[f64],
    tu: &[f64],
    tp: f64,
    step: f64,
) -> Option<(Vec<f64>, Vec<f64>, usize)> {
    let n = u0.len();
    let mut u: Vec<f64> = u0.iter().zip(tu).map(|(u, t)| u + step * t).collect();
    let mut p = p0.to_vec();
    p[0] += step * tp;
    let (mut r, mut rp, mut m) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let mut j = problem.new_jacobian();
    problem.metric(tu, &mut m);
    let mut last = f64::INFINITY;
    for iteration in 1..=7 {
        problem.linearise(&u, &p, &mut r, &mut j).ok()?;
        problem.parameter_derivative(&u, &p, Z0, &mut rp).ok()?;
        factor(&mut j);
        j.solve(&mut r);
        j.solve(&mut rp);
        let moved: Vec<f64> = u.iter().zip(u0).map(|(a, b)| a - b).collect();
        let constraint = dot(&m, &moved) + tp * (p[0] - p0[0]) - step;
        let dp = (-constraint + dot(&m, &r)) / (tp - dot(&m, &rp));
        let du: Vec<f64> = r.iter().zip(&rp).map(|(r, s)| -r - s * dp).collect();
        for (u, d) in u.iter_mut().zip(&du) {
            *u += d;
        }
        p[0] += dp;
        let size = largest(&du).max(dp.abs());
        if size > 2.0 * last || size > 0.1 {
            return None;
        }
        last = size;
        if size < 1e-9 {
            return Some((u, p, iteration));
        }
    }
    None
}

/// The states at given plate distances on the last stretch of the branch, with their numbers of
/// negative eigenvalues.
pub(crate) fn states_at(
    problem: &ContactProblem,
    start: f64,
    targets: &[f64],
) -> Vec<(Vec<f64>, usize)> {
    let mut found: Vec<Option<(Vec<f64>, usize)>> = vec![None; targets.len()];
    let end = targets.iter().fold(f64::INFINITY, |m: f64, z| m.min(*z)) - 1e-3;
    walk(problem, start, end, |a, b| {
        for (k, &z) in targets.iter().enumerate() {
            if (a.z0 - z) * (b.z0 - z) <= 0.0 {
                let f = (z - a.z0) / (b.z0 - a.z0);
                let mut u: Vec<f64> = a.u.iter().zip(&b.u).map(|(a, b)| a + f * (b - a)).collect();
                let negative = newton(problem, &mut u, &problem.parameters_at(z));
                found[k] = negative.map(|n| (u, n));
            }
        }
    });
    found.into_iter().map(|x| x.expect("every target is passed")).collect()
}
