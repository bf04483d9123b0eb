//! `certified` is said of no count that is wrong: non-normal matrices, masses of any scale.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use continuation::linalg::Dense;
use continuation::{
    Branch, EvalError, Matrix, ParamId, Parameter, Problem, Settings, Stability, Tracer,
};
use std::ops::ControlFlow;

/// `M u' = (A + p I) u − u³`, of which `u = 0` is followed.
struct Linear {
    a: Dense,
    mass: Option<Dense>,
}

impl Problem for Linear {
    type Jacobian = Dense;
    fn dim(&self) -> usize {
        self.a.dim()
    }
    fn parameters(&self) -> &[Parameter] {
        const { &[Parameter::new("p", "", 1.0)] }
    }
    fn new_jacobian(&self) -> Dense {
        Dense::new(self.dim())
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        self.a.mul(u, r);
        r.iter_mut().zip(u).for_each(|(r, u)| *r += p[0] * u - u.powi(3));
        Ok(())
    }
    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        j.set_zero();
        j.axpy(1.0, &self.a);
        (0..u.len()).for_each(|i| j.add(i, i, p[0] - 3.0 * u[i] * u[i]));
        Ok(())
    }
    fn parameter_derivative(
        &self,
        u: &[f64],
        _: &[f64],
        _: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        out.copy_from_slice(u);
        Ok(())
    }
    fn mass(&self, m: &mut Dense) -> bool {
        let Some(mass) = &self.mass else { return false };
        m.axpy(1.0, mass);
        true
    }
    fn stability(&self) -> Stability {
        Stability::Dynamics
    }
}

fn trace(problem: &Linear) -> Branch {
    let settings = Settings { target: Some(1.0), ..Settings::default() };
    let tracer = Tracer::new(problem, "p", &vec![0.0; problem.dim()], &[0.0], settings).unwrap();
    tracer.run(&mut |_| ControlFlow::Continue(()))
}

/// `H T H` with a reflection `H` and `T` tridiagonal, of eigenvalues `−2.5 + 2 cos(kπ/(n + 1))`: the
/// quotient of the entries beside the diagonal makes their condition `ratio^(n/2)`.
fn hidden(n: usize, ratio: f64) -> Dense {
    let v: Vec<f64> = (0..n).map(|i| 1.0 + (1.7 * i as f64).sin()).collect();
    let vv: f64 = v.iter().map(|x| x * x).sum();
    let h = |i: usize, j: usize| f64::from(u8::from(i == j)) - 2.0 * v[i] * v[j] / vv;
    let t = |i: usize, j: usize| match i as isize - j as isize {
        0 => -2.5,
        1 => ratio.sqrt(),
        -1 => ratio.sqrt().recip(),
        _ => 0.0,
    };
    let mut a = Dense::new(n);
    for i in 0..n {
        for j in 0..n {
            let near = |k: usize| (k.saturating_sub(1)..n.min(k + 2)).map(move |l| (k, l));
            let all = (0..n).flat_map(near);
            a.set(i, j, all.map(|(k, l)| h(i, k) * t(k, l) * h(l, j)).sum());
        }
    }
    a
}

#[test]
fn non_normal_matrices() {
    let (mut certain, mut doubtful) = (0, 0);
    for n in [10, 25, 40] {
        for ratio in [1.5, 3.0, 10.0, 100.0, 1600.0] {
            let branch = trace(&Linear { a: hidden(n, ratio), mass: None });
            let angle = |k: usize| k as f64 * std::f64::consts::PI / (n as f64 + 1.0);
            for point in &branch.points {
                let value = |k: usize| point.p - 2.5 + 2.0 * angle(k).cos();
                // what rounding of the entries moves the eigenvalues by
                let moved = 10.0 * f64::EPSILON * ratio.powf(0.5 * n as f64);
                if moved > 1.0 {
                    // no count of these entries is known
                    assert!(!point.certified, "{n} {ratio} {}", point.p);
                }
                if !point.certified {
                    doubtful += 1;
                    continue;
                }
                // at a crossing either count is right
                if (1..=n).any(|k| value(k).abs() < moved.max(1e-6)) {
                    continue;
                }
                let exact = (1..=n).filter(|k| value(*k) > 0.0).count();
                assert_eq!(point.unstable, Some(exact), "{n} {ratio} {}", point.p);
                certain += 1;
            }
            assert!(n > 25 || ratio > 3.0 || branch.is_certain(), "{n} {ratio}");
        }
    }
    println!("{certain} certain counts, {doubtful} others");
    assert!(certain > 100 && doubtful > 100);
}

#[test]
fn masses_of_any_scale() {
    let diagonal = |d: [f64; 2]| {
        let mut m = Dense::new(2);
        (0..2).for_each(|i| m.set(i, i, d[i]));
        m
    };
    for small in [1.0, 1e-3, 1e-6, 1e-9, 1e-12] {
        for sign in [1.0, -1.0] {
            // the second eigenvalue is about sign/small, and never infinite
            let (mut a, mass) = (diagonal([-3.0, 2.0 * sign]), Some(diagonal([1.0, small])));
            a.set(0, 1, 0.25); // not symmetric
            let branch = trace(&Linear { a, mass });
            let exact = usize::from(sign > 0.0);
            let said = branch.points.iter().filter(|point| point.certified);
            assert!(said.clone().all(|point| point.unstable == Some(exact)), "{small} {sign}");
            assert!(small < 1e-4 || said.count() == branch.points.len(), "{small} {sign}");
        }
    }
    // no equation for the second unknown: infinite, and known to be
    let mut a = diagonal([-3.0, 2.0]);
    a.set(0, 1, 0.25);
    let branch = trace(&Linear { a, mass: Some(diagonal([1.0, 0.0])) });
    assert!(branch.points.iter().all(|point| point.certified && point.unstable == Some(0)));
}

struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        2.0 * (self.0 >> 11) as f64 / (1u64 << 53) as f64 - 1.0
    }

    /// `H₁ D H₂` with reflections, of condition `10^digits`.
    fn regular(&mut self, n: usize, digits: f64) -> Vec<Vec<f64>> {
        let mut reflection = || {
            let v: Vec<f64> = (0..n).map(|_| self.next()).collect();
            let vv: f64 = v.iter().map(|x| x * x).sum();
            move |i: usize, j: usize| f64::from(u8::from(i == j)) - 2.0 * v[i] * v[j] / vv
        };
        let (left, right) = (reflection(), reflection());
        let d = |k: usize| 10f64.powf(-digits * k as f64 / (n as f64 - 1.0).max(1.0));
        let at = |i: usize, j: usize| (0..n).map(|k| left(i, k) * d(k) * right(k, j)).sum();
        (0..n).map(|i| (0..n).map(|j| at(i, j)).collect()).collect()
    }
}

/// Pencils `P (Λ ⊕ I) Q − λ P (I ⊕ N) Q` of index up to three whose finite eigenvalues are known.
#[test]
fn pencils_of_any_condition_and_index() {
    let mut random = Random(9);
    let (mut certain, mut doubtful) = (0, 0);
    for case in 0..600 {
        let (finite, index) = (1 + case % 5, case / 5 % 4);
        // chains of infinite eigenvalues: one of length `index`, and a single one
        let n = finite + if index == 0 { 0 } else { index + 1 };
        let digits = f64::from(case as u32 / 20 % 7);
        let (p, q) = (random.regular(n, digits), random.regular(n, 0.5 * digits));
        let values: Vec<f64> = (0..finite)
            .map(|_| {
                let size = 10f64.powf(1.5 * random.next() - 0.5);
                size.copysign(random.next())
            })
            .collect();
        let (mut a, mut m) = (Dense::new(n), Dense::new(n));
        for i in 0..n {
            for j in 0..n {
                let own = |k: usize| if k < finite { (values[k], 1.0) } else { (1.0, 0.0) };
                for k in 0..n {
                    let (in_a, in_m) = own(k);
                    a.add(i, j, p[i][k] * in_a * q[k][j]);
                    m.add(i, j, p[i][k] * in_m * q[k][j]);
                }
                for k in finite..(finite + index).saturating_sub(1) {
                    m.add(i, j, p[i][k] * q[k + 1][j]);
                }
            }
        }
        // what rounding of the entries moves the finite ones by, with room
        let moved = f64::EPSILON * 10f64.powf(1.5 * digits) * 1e3;
        let exact = values.iter().filter(|v| **v > 0.0).count();
        let problem = Linear { a, mass: Some(m) };
        let settings = Settings { target: Some(1.0), ..Settings::default() };
        let Ok(mut tracer) = Tracer::new(&problem, "p", &vec![0.0; n], &[0.0], settings) else {
            continue;
        };
        let point = tracer.next().unwrap();
        if !point.certified {
            doubtful += 1;
            continue;
        }
        if values.iter().all(|v| v.abs() > moved) {
            assert_eq!(point.unstable, Some(exact), "{case} {index} {digits} {values:?}");
            certain += 1;
        }
    }
    println!("{certain} certain counts, {doubtful} others");
    assert!(certain > 200, "{certain}");
}
