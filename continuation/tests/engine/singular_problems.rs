//! Jacobians that are singular along the whole branch, told apart from those at a branch point.

#![allow(clippy::unwrap_used)]

use continuation::linalg::{Arrow, Dense};
use continuation::{
    BandProblem, DenseProblem, EvalError, Matrix, ParamId, Parameter, Problem, Settings,
    SparseProblem, Stability, StopReason, TraceError, Tracer,
};
use std::ops::ControlFlow;

fn outcome<P: Problem>(problem: &P, u: &[f64], p: f64, target: f64) -> Result<(), TraceError> {
    let settings = Settings { target: Some(target), ..Settings::default() };
    Tracer::new(problem, "p", u, &[p], settings).map(|_| ())
}

fn deficient<P: Problem>(problem: &P, u: &[f64], p: f64, target: f64, deficiency: usize) {
    let expected = Err(TraceError::SingularEverywhere { deficiency });
    assert_eq!(outcome(problem, u, p, target), expected, "{u:?}");
}

/// A reversible reaction: the total is conserved.
fn reaction() -> impl Problem {
    DenseProblem::from_residual(2, &["p"], |u, p, r| {
        r[0] = -p[0] * u[0] + u[1];
        r[1] = p[0] * u[0] - u[1];
    })
    .boxed()
}

#[test]
fn conserved_quantities() {
    for start in [[1.0, 1.0], [1.0, 1.1], [0.3, 2.0], [1.0, 1.0 + 1e-9]] {
        deficient(&reaction(), &start, 1.0, 2.0, 1);
    }
    // nonlinear, in other units, two at once: A ⇌ B, C ⇌ 2 D
    for unit in [1e-6, 1.0, 1e8] {
        let two = DenseProblem::from_residual(4, &["p"], move |u, p, r| {
            let x: [f64; 4] = std::array::from_fn(|i| u[i] / unit);
            let (first, second) = (p[0] * x[0] - x[1], x[2] - p[0] * x[3] * x[3]);
            r.copy_from_slice(&[-first, first, -second, 2.0 * second]);
        })
        .boxed();
        for start in [[1.0, 1.0, 1.0, 1.0], [1.0, 1.2, 1.0, 0.9]] {
            deficient(&two, &start.map(|x| unit * x), 1.0, 2.0, 2);
        }
    }
    // the remedy: the total as an equation
    let total = DenseProblem::from_residual(2, &["p"], |u, p, r| {
        r[0] = -p[0] * u[0] + u[1];
        r[1] = u[0] + u[1] - 2.0;
    })
    .boxed();
    let settings = Settings { target: Some(2.0), ..Settings::default() };
    let branch = Tracer::new(&total, "p", &[1.0, 1.0], &[1.0], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    let end = branch.points.last().unwrap();
    assert!((end.u[0] - 2.0 / 3.0).abs() < 1e-12 && (end.u[1] - 4.0 / 3.0).abs() < 1e-12);
}

#[test]
fn symmetries_that_move_solutions() {
    let circle = DenseProblem::from_residual(2, &["p"], |u, p, r| {
        let rest = p[0] - u[0] * u[0] - u[1] * u[1];
        r[0] = rest * u[0];
        r[1] = rest * u[1];
    })
    .boxed();
    deficient(&circle, &[1.0, 0.0], 1.0, 0.2, 1);
    deficient(&circle, &[0.6, 0.8], 1.0, 2.0, 1);
    deficient(&circle, &[0.7, 0.8], 1.0, 2.0, 1);
    // the trivial solution is a branch, also where the circle begins
    assert_eq!(outcome(&circle, &[0.0, 0.0], -1.0, 1.0), Ok(()));
    // two bodies and a spring: free to move along the line
    let free = DenseProblem::from_residual(2, &["p"], |x, p, r| {
        r[0] = x[1] - x[0] - 1.0 - p[0];
        r[1] = -r[0];
    })
    .boxed();
    deficient(&free, &[0.0, 1.0], 0.0, 1.0, 1);
    deficient(&free, &[0.0, 1.5], 0.0, 1.0, 1);
}

static PARAMETERS: [Parameter; 1] = [Parameter::new("p", "", 1.0)];

/// `½|u|² − p u₁` with the constraint `u₁ + u₂ = 1`, once or twice, its multipliers at the end.
struct Constrained(usize);

impl Problem for Constrained {
    type Jacobian = Arrow<Dense>;
    fn dim(&self) -> usize {
        2 + self.0
    }
    fn parameters(&self) -> &[Parameter] {
        &PARAMETERS
    }
    fn new_jacobian(&self) -> Arrow<Dense> {
        Arrow::new(Dense::new(2), self.0)
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let force: f64 = u[2..].iter().sum();
        r[0] = u[0] - p[0] + force;
        r[1] = u[1] + force;
        r[2..].fill(u[0] + u[1] - 1.0);
        Ok(())
    }
    fn jacobian(&self, _u: &[f64], _p: &[f64], j: &mut Arrow<Dense>) -> Result<(), EvalError> {
        j.set_zero();
        for i in 0..2 {
            j.core_mut().set(i, i, 1.0);
        }
        for k in 0..self.0 {
            j.column_mut(k).fill(1.0);
            j.row_mut(k).fill(1.0);
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
        out.fill(0.0);
        out[0] = -1.0;
        Ok(())
    }
    fn stability(&self) -> Stability {
        Stability::EnergyHessian
    }
    fn multipliers(&self) -> usize {
        self.0
    }
}

#[test]
fn the_same_constraint_twice() {
    for force in [[-0.5, 0.0], [-0.25, -0.25], [0.0, 0.0]] {
        deficient(&Constrained(2), &[0.5, 0.5, force[0], force[1]], 0.0, 1.0, 1);
    }
    assert_eq!(outcome(&Constrained(1), &[0.5, 0.5, -0.5], 0.0, 1.0), Ok(()));
}

/// Random regular problems with a conserved quantity and a symmetry put in, or not.
#[test]
fn random_problems() {
    let mut seed = 7_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    for case in 0..60 {
        let (n, kind) = (3 + case % 4, case % 3);
        let a: Vec<f64> = (0..n * n).map(|_| random()).collect();
        let b: Vec<f64> = (0..n).map(|_| random()).collect();
        let (w, scale) =
            ((0..n).map(|_| 1.0 + random()).collect::<Vec<f64>>(), 10f64.powi(case as i32 % 7 - 3));
        let problem = DenseProblem::from_residual(n, &["p"], move |u, p, r| {
            // a symmetry: the last unknown counts nowhere
            let used = if kind == 2 { n - 1 } else { n };
            for i in 0..n {
                let sum: f64 = (0..used).map(|k| a[i + k * n] * u[k] / scale).sum();
                let own = if i < used { 3.0 * u[i] / scale } else { 0.0 };
                r[i] = own + sum + 0.1 * (u[0] / scale).sin() - p[0] * b[i];
            }
            // a conserved quantity: the rows depend on each other
            if kind == 1 {
                r[n - 1] = -(0..n - 1).map(|i| w[i] * r[i]).sum::<f64>();
            }
            // the last equation has nothing of its own left
            if kind == 2 {
                r[n - 1] = r[0] - r[1];
            }
        })
        .boxed();
        let start = vec![0.1 * scale; n];
        if kind == 0 {
            assert_eq!(outcome(&problem, &start, 0.5, 1.0), Ok(()), "{case}");
        } else {
            deficient(&problem, &start, 0.5, 1.0, 1);
        }
    }
}

#[test]
fn a_target_at_the_start_is_met_at_once() {
    let line = DenseProblem::from_residual(1, &["p"], |u, p, r| r[0] = u[0] - p[0]).boxed();
    for p in [0.0, 0.3, -7e9] {
        let settings = Settings { target: Some(p), ..Settings::default() };
        let branch = Tracer::new(&line, "p", &[p], &[p], settings)
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(()));
        assert_eq!((branch.stopped.reason, branch.points.len()), (StopReason::Target, 1));
    }
    // to be left first: round the circle and back
    let circle = DenseProblem::from_residual(1, &["p"], |u, p, r| {
        r[0] = u[0] * u[0] + p[0] * p[0] - 1.0;
    })
    .boxed();
    let settings = Settings { target: Some(0.0), increasing: Some(true), ..Settings::default() };
    let branch = Tracer::new(&circle, "p", &[1.0], &[0.0], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    let end = branch.points.last().unwrap();
    assert!(branch.stopped.reason == StopReason::Target && (end.u[0] + 1.0).abs() < 1e-12);
}

/// Two species that turn into each other and diffuse between walls: the total is conserved, unless the
/// first leaks out at the end.
fn diffusion(n: usize, leak: f64) -> impl Fn(&[f64], &[f64], &mut [f64]) {
    let stiff = (n as f64).powi(2);
    move |u, p, r| {
        for i in 0..n {
            let flux = |s: usize| {
                let left = if i > 0 { u[2 * i - 2 + s] - u[2 * i + s] } else { 0.0 };
                let right = if i + 1 < n { u[2 * i + 2 + s] - u[2 * i + s] } else { 0.0 };
                stiff * (left + right)
            };
            let reaction = p[0] * u[2 * i] - u[2 * i + 1] * u[2 * i + 1];
            r[2 * i] = flux(0) - reaction;
            r[2 * i + 1] = 0.1 * flux(1) + reaction;
        }
        r[0] -= leak * (u[0] - 1.0);
    }
}

#[test]
fn large_problems_in_every_storage() {
    for n in [20_usize, 60, 200] {
        let pattern: Vec<(usize, usize)> = (0..2 * n)
            .flat_map(|i| (i.saturating_sub(2)..(i + 3).min(2 * n)).map(move |j| (i, j)))
            .collect();
        let start = vec![1.0; 2 * n];
        for leak in [0.0, 1.0] {
            let f = || diffusion(n, leak);
            let band = BandProblem::from_residual(2 * n, (2, 2), &["p"], f()).boxed();
            let sparse = SparseProblem::from_residual(2 * n, &pattern, &["p"], f()).unwrap();
            let dense = DenseProblem::from_residual(2 * n, &["p"], f()).boxed();
            let outcomes = [
                outcome(&band, &start, 1.0, 1.5),
                outcome(&sparse, &start, 1.0, 1.5),
                outcome(&dense, &start, 1.0, 1.5),
            ];
            let right = match leak {
                0.0 => Err(TraceError::SingularEverywhere { deficiency: 1 }),
                _ => Ok(()),
            };
            assert!(outcomes.iter().all(|o| *o == right), "{n} {leak} {outcomes:?}");
        }
    }
}

/// `p⁴ u'''' + u'' = 0` with small steps: near its trivial solution nothing is singular, though the rows
/// are up to 1e12 times as large as what they leave of a smooth state.
#[test]
fn stiff_operators_are_regular() {
    for n in [30, 100, 400, 800] {
        let h = std::f64::consts::PI / (n as f64 + 1.0);
        let problem = BandProblem::from_residual(n, (2, 2), &["p"], move |u, p, r| {
            let at = |i: isize| match i {
                -1 => -u[0],
                i if i == n as isize + 1 => -u[n - 1],
                i => u.get((i - 1) as usize).copied().unwrap_or(0.0),
            };
            for (k, r) in r.iter_mut().enumerate() {
                let i = k as isize + 1;
                let second = at(i - 1) - 2.0 * at(i) + at(i + 1);
                let fourth =
                    at(i - 2) - 4.0 * at(i - 1) + 6.0 * at(i) - 4.0 * at(i + 1) + at(i + 2);
                *r = p[0] * fourth / h.powi(4) + second / h.powi(2) + u[k].powi(3);
            }
        })
        .boxed();
        assert_eq!(outcome(&problem, &vec![0.0; n], 1.2, 0.7), Ok(()), "{n}");
    }
}
