//! Derivatives that are not those of the residual are named, and right ones never accused.

#![allow(clippy::unwrap_used)]

use continuation::linalg::Band;
use continuation::{
    BandProblem, Branch, EvalError, Matrix, ParamId, Parameter, Problem, Settings, TraceError,
    Tracer,
};
use std::ops::ControlFlow;

/// What is wrong.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fault {
    None,
    /// A part of the Jacobian has the wrong sign.
    Sign,
    /// A part is missing.
    Missing,
    /// Rows and columns are exchanged.
    Transposed,
    /// A factor in one entry.
    Factor,
    /// The sign of the derivative by the parameter.
    Parameter,
    NotANumber,
}

static PARAMETERS: [Parameter; 1] = [Parameter::new("p", "", 1.0)];

/// A chain `a u_i + b u_{i−1} + c u_i u_{i+1} + e^{d u_i} − 1 = p w_i` in units of its own.
struct Chain {
    n: usize,
    coefficients: [f64; 4],
    weights: Vec<f64>,
    unit: f64,
    fault: Fault,
}

impl Problem for Chain {
    type Jacobian = Band;
    fn dim(&self) -> usize {
        self.n
    }
    fn parameters(&self) -> &[Parameter] {
        &PARAMETERS
    }
    fn new_jacobian(&self) -> Band {
        Band::new(self.n, 1, 1)
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let [a, b, c, d] = self.coefficients;
        let x = |i: usize| u.get(i).map_or(0.0, |u| u / self.unit);
        for (i, r) in r.iter_mut().enumerate() {
            let before = if i > 0 { x(i - 1) } else { 0.0 };
            *r = a * x(i) + b * before + c * x(i) * x(i + 1) + (d * x(i)).exp_m1()
                - p[0] * self.weights[i];
        }
        Ok(())
    }
    fn jacobian(&self, u: &[f64], _p: &[f64], j: &mut Band) -> Result<(), EvalError> {
        let [a, b, c, d] = self.coefficients;
        let x = |i: usize| u.get(i).map_or(0.0, |u| u / self.unit);
        j.set_zero();
        let fault = self.fault;
        for i in 0..self.n {
            let own = match fault {
                Fault::Sign => -d,
                Fault::Missing => 0.0,
                Fault::NotANumber if i == self.n / 2 => f64::NAN,
                _ => d,
            };
            let own = a + c * x(i + 1) + own * (d * x(i)).exp();
            let factor = if fault == Fault::Factor && i == 0 { 1.6 } else { 1.0 };
            j.set(i, i, factor * own / self.unit);
            let mut off = |row: usize, column: usize, value: f64| {
                let at = if fault == Fault::Transposed { (column, row) } else { (row, column) };
                j.set(at.0, at.1, value / self.unit);
            };
            if i > 0 {
                off(i, i - 1, b);
            }
            if i + 1 < self.n {
                off(i, i + 1, c * x(i));
            }
        }
        Ok(())
    }
    fn parameter_derivative(
        &self,
        _u: &[f64],
        _p: &[f64],
        _which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        let sign = if self.fault == Fault::Parameter { 1.0 } else { -1.0 };
        out.iter_mut().zip(&self.weights).for_each(|(out, w)| *out = sign * w);
        Ok(())
    }
}

fn trace<P: Problem>(problem: &P) -> Result<Branch, TraceError> {
    let u = vec![0.0; problem.dim()];
    let settings = Settings { target: Some(2.0), max_points: 200, ..Settings::default() };
    let tracer = Tracer::new(problem, "p", &u, &[0.0], settings)?;
    Ok(tracer.run(&mut |_| ControlFlow::Continue(())))
}

/// What is said of it.
fn said<P: Problem>(problem: &P) -> String {
    match trace(problem) {
        Err(error) => error.to_string(),
        Ok(branch) => {
            let doubts = branch.doubts.iter().map(|doubt| doubt.reason.clone());
            assert!(branch.doubts.is_empty() || !branch.is_certain());
            doubts.chain([branch.stopped.detail]).collect::<Vec<_>>().join("; ")
        }
    }
}

fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

#[test]
fn every_kind_is_named() {
    let faults = [
        (Fault::None, ""),
        (Fault::Sign, "the Jacobian is wrong"),
        (Fault::Missing, "the Jacobian is wrong"),
        (Fault::Transposed, "the Jacobian is wrong"),
        (Fault::Factor, "the Jacobian is wrong"),
        (Fault::Parameter, "the derivative by `p` is wrong"),
        (Fault::NotANumber, "of the Jacobian is not finite"),
    ];
    let mut seed = 11;
    for case in 0..70 {
        let (fault, words) = faults[case % faults.len()];
        let n = 2 + (case / 7) * 3;
        let mut one = || random(&mut seed);
        let coefficients = [3.0 + one(), 1.2 + one(), 0.4 * one(), 0.8 + 0.4 * one()];
        let weights = (0..n).map(|_| 1.0 + one()).collect();
        let unit = [1.0, 1e-7, 1e5][case % 3];
        let found = said(&Chain { n, coefficients, weights, unit, fault });
        if fault == Fault::None {
            assert!(!found.contains("wrong"), "{case} {found}");
        } else {
            assert!(found.contains(words), "{case} {fault:?} {n}: {found}");
        }
    }
}

#[test]
fn kinks_noise_and_steep_functions_are_not_accused() {
    // derivatives of these are right wherever they exist
    type Residual = fn(f64, f64) -> f64;
    let hard: [Residual; 6] = [
        |x, p| x + 0.3 * x.abs() - p,
        |x, p| x + x.max(0.3) - p - 0.3,
        |x, p| x - p + 0.3 * ((x - 0.5) / 1e-3).tanh(),
        |x, p| x - p + 1e-9 * (1e7 * x).sin(),
        |x, p| x + 0.1 * (40.0 * x).sin() - p,
        |x, p| (x - p) * (1.0 + 1e6 * p * p),
    ];
    for (case, f) in hard.into_iter().enumerate() {
        let problem = BandProblem::from_residual(3, (0, 0), &["p"], move |u, p, r| {
            u.iter().zip(r).for_each(|(u, r)| *r = f(*u, p[0]));
        })
        .boxed();
        let found = said(&problem);
        assert!(!found.contains("wrong"), "{case} {found}");
    }
}
