//! Derivatives by differences: an evaluation depends on its arguments alone, and its claimed error
//! bounds the true one.

#![allow(clippy::unwrap_used)]

use continuation::linalg::Dense;
use continuation::{
    BandProblem, DenseProblem, EvalError, EventKind, ParamId, Problem, Settings, SparseProblem,
    StopReason, Tracer,
};
use std::ops::ControlFlow;

/// A linear congruential generator: the same numbers everywhere.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
    fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.unit()
    }
    fn scale(&mut self) -> f64 {
        10f64.powf(self.between(-6.0, 6.0))
    }
}

fn entry(problem: &impl Problem<Jacobian = Dense>, u: &[f64], p: &[f64]) -> f64 {
    let mut j = Dense::new(u.len());
    problem.jacobian(u, p, &mut j).unwrap();
    j.get(0, 0)
}

fn claimed(problem: &impl Problem, u: &[f64], p: &[f64]) -> f64 {
    let mut error = vec![0.0; u.len()];
    let mut du = vec![0.0; u.len()];
    du[0] = 1.0;
    problem.derivative_error(u, p, ParamId(0), &du, 0.0, &mut error).unwrap();
    error[0]
}

#[test]
fn another_scale_after_the_first() {
    let problem = DenseProblem::from_residual(1, &["k"], |u, p, r| {
        r[0] = p[0] / (1.0 + (u[0] / p[0]).powi(3));
    })
    .boxed();
    for k in [1.0, 1e-3, 1e3, 1e-6, 1.0] {
        assert!((entry(&problem, &[k], &[k]) + 0.75).abs() < 1e-11, "{k:e}");
    }
}

#[test]
fn a_peak_after_a_flat_place() {
    let problem = DenseProblem::from_residual(1, &["p"], |u, p, r| {
        r[0] = p[0] - u[0] - 50.0 * (-(u[0] - 5.0).powi(2)).exp();
    })
    .boxed();
    for x in [30.0, 6.0, 5.5, 30.0, 5.5] {
        let d: f64 = x - 5.0;
        let exact = -1.0 + 100.0 * d * (-d * d).exp();
        let found = entry(&problem, &[x], &[1.0]);
        assert!((found - exact).abs() < 1e-10, "{x}: {found} {exact}");
    }
    // and one far narrower than the unknown
    for width in [1e-2, 1e-3, 1e-4, 1e-5] {
        let problem = DenseProblem::from_residual(1, &["p"], move |u, p, r| {
            r[0] = p[0] - u[0] - 50.0 * (-((u[0] - 5.0) / width).powi(2)).exp();
        })
        .boxed();
        let x = 5.0 + 0.6 * width;
        let d: f64 = (x - 5.0) / width;
        let exact = -1.0 + 100.0 * d / width * (-d * d).exp();
        let found = entry(&problem, &[x], &[1.0]);
        assert!((found / exact - 1.0).abs() < 1e-14 * 1e5 / width, "{width}: {found} {exact}");
        assert!((found - exact).abs() <= claimed(&problem, &[x], &[1.0]) + 1e-14 * exact.abs());
    }
}

/// `f` and `f′` of a random family at scale `s`, amplitude `a` and shape `c`.
fn family(kind: usize, a: f64, s: f64, c: f64, x: f64) -> (f64, f64) {
    let y = x / s;
    match kind {
        0 => (a / (1.0 + y.powi(3)), -3.0 * a / s * y * y / (1.0 + y.powi(3)).powi(2)),
        1 => (a * (-c * y).exp(), -a * c / s * (-c * y).exp()),
        2 => {
            let m = 2.0 + (6.0 * c).floor();
            let q = 1.0 + y.powf(m);
            (a * y.powf(m) / q, a * m / s * y.powf(m - 1.0) / (q * q))
        }
        3 => (a * (y - c * y.powi(3)), a / s * (1.0 - 3.0 * c * y * y)),
        _ => (a * (c * 5.0 * y).sin() / (1.0 + y * y), {
            let (q, w) = (1.0 + y * y, c * 5.0);
            a / s * (w * (w * y).cos() / q - (w * y).sin() * 2.0 * y / (q * q))
        }),
    }
}

#[test]
fn a_used_problem_answers_as_a_new_one_and_within_its_claim() {
    let mut random = Random(7);
    for trial in 0..60 {
        let kind = trial % 5;
        let (a, s, c) = (random.scale(), random.scale(), random.between(0.2, 1.0));
        let f = move |u: &[f64], p: &[f64], r: &mut [f64]| {
            r[0] = family(kind, a, s, c, u[0]).0 - p[0];
            r[1] = u[1] * (1.0 + u[0] / s) - p[0] / s;
        };
        let used = DenseProblem::from_residual(2, &["p"], f).boxed();
        for _ in 0..8 {
            let x = s * random.between(0.1, 4.0);
            let u = [x, random.scale()];
            let (value, exact) = family(kind, a, s, c, x);
            let p = [value * random.between(0.5, 2.0)];
            let new = DenseProblem::from_residual(2, &["p"], f).boxed();
            let (one, two) = (entry(&used, &u, &p), entry(&new, &u, &p));
            assert_eq!(one.to_bits(), two.to_bits(), "{kind} {x:e}");
            let (error, bound) = ((one - exact).abs(), claimed(&used, &u, &p));
            let rounding = 64.0 * f64::EPSILON * exact.abs();
            assert!(error <= bound + rounding, "{kind} {a:e} {s:e} {x:e}: {error:e} > {bound:e}");
            let size = exact.abs().max(value.abs() / x);
            assert!(bound <= 1e-9 * size, "{kind} {a:e} {s:e} {x:e}: {bound:e} of {size:e}");
            assert!(error <= 1e-10 * size, "{kind} {a:e} {s:e} {x:e}: {error:e} of {size:e}");
        }
    }
}

#[test]
fn at_the_edge_of_a_domain_differences_are_one_sided() {
    let problem =
        DenseProblem::from_residual(1, &["p"], |u, p, r| r[0] = p[0] - u[0] - u[0].powf(2.5))
            .boxed();
    for x in [0.0, 1e-14, 1e-9, 1e-3, 1.0] {
        let exact = -1.0 - 2.5 * f64::powf(x, 1.5);
        let found = entry(&problem, &[x], &[0.5]);
        let bound = claimed(&problem, &[x], &[0.5]);
        assert!((found - exact).abs() < 1e-6, "{x:e}: {found} {exact}");
        assert!((found - exact).abs() <= bound + 1e-14, "{x:e}: {found} {exact} {bound:e}");
    }
    // a Hill term from its own edge
    let settings = Settings { target: Some(1.0), ..Settings::default() };
    let branch = Tracer::new(&problem, "p", &[0.0], &[0.0], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    assert_eq!(branch.stopped.reason, StopReason::Target, "{:?}", branch.stopped);
    let end = branch.points.last().unwrap().u[0];
    assert!((end + end.powf(2.5) - 1.0).abs() < 1e-12);
}

#[test]
fn a_ring_of_repressors_over_six_decades() {
    let cube = 2f64.cbrt();
    let ring = DenseProblem::from_residual(3, &["v", "K"], |u, p, r| {
        let k = p[1].powi(3);
        for i in 0..3 {
            r[i] = p[0] * k / (k + u[(i + 2) % 3].powi(3)) - 0.1 * u[i];
        }
    })
    .boxed();
    for turn in 0..2 {
        for k in [20.0, 1e-3, 1e3, 0.057] {
            let at = 0.3 * cube * k;
            let u = [0.8 * cube * k; 3];
            let settings = Settings { target: Some(2.0 * at), ..Settings::default() };
            let branch = Tracer::new(&ring, "v", &u, &[0.5 * at, k], settings)
                .unwrap()
                .run(&mut |_| ControlFlow::Continue(()));
            let hopf = branch.events_of(&EventKind::Hopf).next().unwrap();
            let error = (hopf.p / at - 1.0).abs();
            assert!(error < 1e-11, "{turn} {k}: {error:e}");
            assert!((hopf.p - at).abs() <= hopf.error_estimate + 1e-14 * at, "{turn} {k}");
            let form = hopf.hopf().unwrap();
            assert!((form.frequency - 0.1 * 3f64.sqrt()).abs() < 1e-10);
        }
    }
}

#[test]
fn an_estimate_contains_the_errors_of_differences() {
    for e in [1.0, 1e-1, 1e-2, 1e-3, 1e-4] {
        let problem = DenseProblem::from_residual(1, &["p"], move |u, p, r| {
            r[0] = p[0] + f64::hypot(u[0] - 0.3, e);
        })
        .boxed();
        let settings =
            Settings { domain: Some((-1.0, 1.0)), max_points: 2000, ..Settings::default() };
        let start = -f64::hypot(0.5, e);
        let settings = Settings { domain: Some((start - 0.2, 1.0)), ..settings };
        let branch = Tracer::new(&problem, "p", &[-0.2], &[start], settings)
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(()));
        let fold = branch.events_of(&EventKind::Fold).next().unwrap();
        let off = (branch.points[fold.point].u[0] - 0.3).abs();
        assert!(off <= fold.error_estimate, "{e:e}: {off:e} > {:e}", fold.error_estimate);
        assert!(fold.error_estimate < 1e-9, "{e:e}: {:e}", fold.error_estimate);
    }
}

/// Brusselator-like reactions on a line, `n` cells of two unknowns.
fn reactions(n: usize) -> impl Fn(&[f64], &[f64], &mut [f64]) {
    move |x, p, r| {
        let h2 = 1.0 / ((n + 1) as f64).powi(2);
        for i in 0..n {
            let (u, v) = (x[2 * i], x[2 * i + 1]);
            let rates = [2.0 - (p[0] + 1.0) * u + u * u * v, p[0] * u - u * u * v];
            for c in 0..2 {
                let (d, end) = [(0.008, 2.0), (0.004, p[0] / 2.0)][c];
                let left = if i > 0 { x[2 * i - 2 + c] } else { end };
                let right = if i + 1 < n { x[2 * i + 2 + c] } else { end };
                r[2 * i + c] = d * (left - 2.0 * x[2 * i + c] + right) / h2 + rates[c];
            }
        }
    }
}

#[test]
fn columns_of_one_colour_together() {
    let n = 20_usize;
    let pattern: Vec<(usize, usize)> = (0_usize..2 * n)
        .flat_map(|i| [i.wrapping_sub(2), i, i ^ 1, i + 2].map(|j| (i, j)))
        .filter(|(_, j)| *j < 2 * n)
        .collect();
    let dense = DenseProblem::from_residual(2 * n, &["B"], reactions(n)).boxed();
    let band = BandProblem::from_residual(2 * n, (2, 2), &["B"], reactions(n)).boxed();
    let sparse = SparseProblem::from_residual(2 * n, &pattern, &["B"], reactions(n)).unwrap();
    let mut random = Random(3);
    let x: Vec<f64> = (0..2 * n).map(|_| random.between(0.1, 3.0)).collect();
    let (mut a, mut b, mut c) = (dense.new_jacobian(), band.new_jacobian(), sparse.new_jacobian());
    dense.jacobian(&x, &[4.0], &mut a).unwrap();
    band.jacobian(&x, &[4.0], &mut b).unwrap();
    sparse.jacobian(&x, &[4.0], &mut c).unwrap();
    for i in 0..2 * n {
        for j in i.saturating_sub(2)..(i + 3).min(2 * n) {
            assert!((a.get(i, j) - b.get(i, j)).abs() < 1e-11, "{i} {j}");
            assert!((a.get(i, j) - c.get(i, j)).abs() < 1e-11, "{i} {j}");
        }
    }
    // the first Hopf point, B = 1 + A² + (D₁ + D₂) κ₁
    let settings = Settings { target: Some(5.3), ..Settings::default() };
    let mut u = vec![2.0; 2 * n];
    u.iter_mut().skip(1).step_by(2).for_each(|v| *v = 2.4);
    let h = 1.0 / (n + 1) as f64;
    let kappa = 4.0 / (h * h) * (0.5 * std::f64::consts::PI * h).sin().powi(2);
    let exact = 5.0 + 0.012 * kappa;
    let branch = Tracer::new(&band, "B", &u, &[4.8], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    let hopf = branch.events_of(&EventKind::Hopf).next().unwrap();
    assert!((hopf.p - exact).abs() < 1e-9, "{} {exact}", hopf.p);
}

/// A problem that has no derivative by its parameter.
struct Half(Vec<continuation::Parameter>);

impl Problem for Half {
    type Jacobian = Dense;
    fn dim(&self) -> usize {
        1
    }
    fn parameters(&self) -> &[continuation::Parameter] {
        &self.0
    }
    fn new_jacobian(&self) -> Dense {
        Dense::new(1)
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        r[0] = p[0].exp() - u[0] - u[0].powi(3);
        Ok(())
    }
    fn jacobian(&self, u: &[f64], _: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        j.set(0, 0, -1.0 - 3.0 * u[0] * u[0]);
        Ok(())
    }
}

#[test]
fn the_derivative_by_a_parameter_is_a_default() {
    let problem = Half(vec![continuation::Parameter::new("p", "", 1.0)]);
    let mut out = [0.0];
    for p in [-3.0, 0.0, 1e-9, 2.0, 5.0] {
        problem.parameter_derivative(&[0.5], &[p], ParamId(0), &mut out).unwrap();
        assert!((out[0] / p.exp() - 1.0).abs() < 1e-11, "{p}: {}", out[0]);
    }
    let settings = Settings { target: Some(2.0), ..Settings::default() };
    let branch = Tracer::new(&problem, "p", &[0.5], &[-1.0], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    assert_eq!(branch.stopped.reason, StopReason::Target);
}

/// A Jacobian with a part that is not a number from `p = 0.5` on.
struct Broken(Half);

impl Problem for Broken {
    type Jacobian = Dense;
    fn dim(&self) -> usize {
        1
    }
    fn parameters(&self) -> &[continuation::Parameter] {
        self.0.parameters()
    }
    fn new_jacobian(&self) -> Dense {
        Dense::new(1)
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        self.0.residual(u, p, r)
    }
    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        self.0.jacobian(u, p, j)?;
        if p[0] >= 0.5 {
            j.set(0, 0, f64::NAN);
        }
        Ok(())
    }
}

#[test]
fn a_jacobian_without_a_value_is_not_called_singular() {
    let problem = Broken(Half(vec![continuation::Parameter::new("p", "", 1.0)]));
    let settings = Settings { target: Some(2.0), ..Settings::default() };
    let error = Tracer::new(&problem, "p", &[0.5], &[1.0], settings).err().unwrap();
    assert!(error.to_string().contains("row 0 of the Jacobian is not finite"), "{error}");
}
