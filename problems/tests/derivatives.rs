//! Every derivative of every problem against four-point differences, at several states.

#![allow(clippy::unwrap_used)]

use continuation::{Matrix, ParamId, Problem};
use problems::{Entry, Request, Setup, Visitor, catalogue};

const TOLERANCE: f64 = 1e-7;

/// A small version of a problem: its code is that of the large one.
fn small(entry: &Entry) -> Request {
    let elements = entry.elements.map_or(0, |e| e.least);
    Request { elements, ..entry.request() }
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// Numbers in [-1, 1] that follow no pattern.
fn scatter(seed: usize, n: usize) -> Vec<f64> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(seed as u64 + 1);
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    (0..n).map(|_| next()).collect()
}

/// `d f(x)/dh` at `h = 0` by central differences over four points.
fn difference(f: impl Fn(f64) -> Vec<f64>, h: f64) -> Vec<f64> {
    let [a, b, c, d] = [1.0, -1.0, 2.0, -2.0].map(|place| f(place * h));
    (0..a.len()).map(|i| (8.0 * (a[i] - b[i]) - (c[i] - d[i])) / (12.0 * h)).collect()
}

#[track_caller]
fn close(what: &str, found: &[f64], expected: &[f64], scale: f64) {
    let error: Vec<f64> = found.iter().zip(expected).map(|(a, b)| a - b).collect();
    let size = largest(expected).max(scale);
    assert!(largest(&error) <= TOLERANCE * size, "{what}: {:e} of {size:e}", largest(&error));
}

struct Certify(&'static str);

impl Visitor for Certify {
    type Output = ();

    fn visit<P: Problem>(self, problem: &P, setup: Setup) {
        let n = problem.dim();
        let names: Vec<&str> = problem.parameters().iter().map(|p| &p.name[..]).collect();
        assert_eq!((setup.u.len(), setup.p.len()), (n, names.len()), "{}", self.0);
        let size = 1.0 + largest(&setup.u);
        for (state, shift) in [0.0, 0.01, 0.03].into_iter().enumerate() {
            let mut u = setup.u.clone();
            for (u, x) in u.iter_mut().zip(scatter(state, n)) {
                *u += shift * x * if self.0.starts_with("jkr") { u.abs() } else { size };
            }
            let mut p = setup.p.clone();
            for (p, x) in p.iter_mut().zip(scatter(state + 7, names.len())) {
                *p *= 1.0 + 3.0 * shift * x;
            }
            self.state(problem, &u, &p, 1e-3 * shift.max(0.003) / 0.03);
        }
    }
}

impl Certify {
    fn state<P: Problem>(&self, problem: &P, u: &[f64], p: &[f64], h: f64) {
        let n = problem.dim();
        let residual = |u: &[f64], p: &[f64]| {
            let mut r = vec![0.0; n];
            problem.residual(u, p, &mut r).unwrap();
            r
        };
        let mut j = problem.new_jacobian();
        problem.jacobian(u, p, &mut j).unwrap();
        let (scale, mut column) = (j.norm(), vec![0.0; n]);
        let mut unit = vec![0.0; n];
        for i in 0..n {
            unit.fill(0.0);
            unit[i] = 1.0;
            j.mul(&unit, &mut column);
            let shifted = |t: f64| {
                let mut u = u.to_vec();
                u[i] += t;
                residual(&u, p)
            };
            let what = format!("{}: column {i} of the Jacobian", self.0);
            close(&what, &difference(shifted, h), &column, 1e-3 * scale);
        }

        // both at once are the same as one after the other
        let (mut r, mut again) = (vec![0.0; n], problem.new_jacobian());
        problem.linearise(u, p, &mut r, &mut again).unwrap();
        close(self.0, &r, &residual(u, p), 1e-7);
        again.axpy(-1.0, &j);
        assert!(again.norm() <= 1e-12 * scale);

        for (k, parameter) in problem.parameters().iter().enumerate() {
            problem.parameter_derivative(u, p, ParamId(k), &mut column).unwrap();
            let shifted = |t: f64| {
                let mut p = p.to_vec();
                p[k] += t * parameter.scale;
                residual(u, &p)
            };
            let mut slope = difference(shifted, h);
            slope.iter_mut().for_each(|s| *s /= parameter.scale);
            let what = format!("{}: derivative by {}", self.0, parameter.name);
            close(&what, &slope, &column, 1e-3 * scale);
        }
        self.observables(problem, u, p, h);
        self.products(problem, u);
    }

    fn observables<P: Problem>(&self, problem: &P, u: &[f64], p: &[f64], h: f64) {
        let names = problem.observables();
        assert!(!names.is_empty(), "{}: nothing to draw", self.0);
        let direction = scatter(3, u.len());
        let (which, dp) = (ParamId(0), 0.3 * problem.parameters()[0].scale);
        for (k, name) in names.iter().enumerate() {
            let slope = problem.observable_slope(k, u, p, which, &direction, dp).unwrap();
            let along = |t: f64| {
                let u: Vec<f64> = u.iter().zip(&direction).map(|(u, d)| u + t * d).collect();
                let mut p = p.to_vec();
                p[0] += t * dp;
                let mut out = vec![f64::NAN; names.len()];
                problem.observe(&u, &p, &mut out).unwrap();
                vec![out[k]]
            };
            assert!(along(0.0)[0].is_finite(), "{}: {name}", self.0);
            if let Some(slope) = slope {
                close(
                    &format!("{}: slope of {name}", self.0),
                    &difference(along, 0.3 * h),
                    &[slope],
                    1e-3,
                );
            }
        }
    }

    /// Metric and mass matrix are symmetric and positive.
    fn products<P: Problem>(&self, problem: &P, u: &[f64]) {
        let n = u.len();
        let (x, y) = (scatter(5, n), scatter(6, n));
        let mut mass = problem.new_jacobian();
        let has_mass = problem.mass(&mut mass);
        type Apply<'a> = &'a dyn Fn(&[f64], &mut [f64]);
        let metric: Apply<'_> = &|x, y| problem.metric(x, y);
        let matrix: Apply<'_> = &|x, y| mass.mul(x, y);
        for apply in [Some(metric), has_mass.then_some(matrix)].into_iter().flatten() {
            let product = |x: &[f64], y: &[f64]| {
                let mut my = vec![0.0; n];
                apply(y, &mut my);
                x.iter().zip(&my).map(|(x, y)| x * y).sum::<f64>()
            };
            assert!(product(&x, &x) > 0.0 && product(&y, &y) > 0.0, "{}", self.0);
            let (a, b) = (product(&x, &y), product(&y, &x));
            assert!((a - b).abs() <= 1e-12 * (product(&x, &x) + product(&y, &y)), "{}", self.0);
        }
    }
}

#[test]
fn every_derivative_agrees_with_differences() {
    for entry in catalogue() {
        let certified = entry.visit(&small(entry), Certify(entry.name));
        assert!(certified.is_ok(), "{}: {certified:?}", entry.name);
    }
}
