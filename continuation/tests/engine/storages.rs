//! The same problem in every storage of its Jacobian: the same special points, the same counts.

#![allow(clippy::unwrap_used)]

use continuation::linalg::{Arrow, Band, Dense, Sparse};
use continuation::{
    Branch, EvalError, EventKind, Matrix, ParamId, Parameter, Problem, Settings, Stability, Tracer,
};
use std::ops::ControlFlow;

/// Where entries of a Jacobian go.
pub(crate) trait Entries: Matrix {
    fn new(n: usize, pattern: &[(usize, usize)], band: usize) -> Self;
    fn put(&mut self, i: usize, j: usize, value: f64);
}

impl Entries for Dense {
    fn new(n: usize, _: &[(usize, usize)], _: usize) -> Self {
        Dense::new(n)
    }
    fn put(&mut self, i: usize, j: usize, value: f64) {
        self.add(i, j, value);
    }
}

impl Entries for Band {
    fn new(n: usize, _: &[(usize, usize)], band: usize) -> Self {
        Band::new(n, band, band)
    }
    fn put(&mut self, i: usize, j: usize, value: f64) {
        self.add(i, j, value);
    }
}

impl Entries for Sparse {
    fn new(n: usize, pattern: &[(usize, usize)], _: usize) -> Self {
        Sparse::new(n, pattern).unwrap()
    }
    fn put(&mut self, i: usize, j: usize, value: f64) {
        self.add(i, j, value).unwrap();
    }
}

/// The Brusselator on a line, concentrations held at the ends: `u″` and `v″` with the constants
/// `D`, rates with `A = 2`; `B` and the length `L` are the parameters. The homogeneous state loses
/// stability to oscillations with `k` half waves at `B = 1 + A² + (D₁ + D₂) κ_k / L²`.
pub(crate) struct Brusselator<J> {
    cells: usize,
    matrix: std::marker::PhantomData<fn() -> J>,
}

pub(crate) const A: f64 = 2.0;
pub(crate) const D: [f64; 2] = [0.008, 0.004];

impl<J: Entries> Brusselator<J> {
    pub(crate) fn new(cells: usize) -> Self {
        Brusselator { cells, matrix: std::marker::PhantomData }
    }

    fn h(&self) -> f64 {
        1.0 / (self.cells + 1) as f64
    }

    /// Eigenvalue of the negative second difference at `L = 1`.
    pub(crate) fn kappa(&self, k: usize) -> f64 {
        let h = self.h();
        4.0 / (h * h) * (0.5 * std::f64::consts::PI * k as f64 * h).sin().powi(2)
    }

    pub(crate) fn pattern(&self) -> Vec<(usize, usize)> {
        let n = 2 * self.cells;
        let mut pattern = Vec::new();
        for i in 0..n {
            for j in [i.wrapping_sub(2), i, i ^ 1, i + 2] {
                if j < n {
                    pattern.push((i, j));
                }
            }
        }
        pattern
    }
}

impl<J: Entries> Problem for Brusselator<J> {
    type Jacobian = J;

    fn dim(&self) -> usize {
        2 * self.cells
    }

    fn parameters(&self) -> &[Parameter] {
        const { &[Parameter::new("B", "", 1.0), Parameter::new("L", "", 1.0)] }
    }

    fn new_jacobian(&self) -> J {
        J::new(self.dim(), &self.pattern(), 2)
    }

    fn residual(&self, x: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let (n, h2) = (self.cells, (p[1] * self.h()).powi(2));
        let ends = [A, p[0] / A];
        for i in 0..n {
            let (u, v) = (x[2 * i], x[2 * i + 1]);
            let rates = [A - (p[0] + 1.0) * u + u * u * v, p[0] * u - u * u * v];
            for c in 0..2 {
                let left = if i > 0 { x[2 * i - 2 + c] } else { ends[c] };
                let right = if i + 1 < n { x[2 * i + 2 + c] } else { ends[c] };
                r[2 * i + c] = D[c] * (left - 2.0 * x[2 * i + c] + right) / h2 + rates[c];
            }
        }
        Ok(())
    }

    fn jacobian(&self, x: &[f64], p: &[f64], j: &mut J) -> Result<(), EvalError> {
        let (n, h2) = (self.cells, (p[1] * self.h()).powi(2));
        j.set_zero();
        for i in 0..n {
            let (u, v) = (x[2 * i], x[2 * i + 1]);
            let rates = [[2.0 * u * v - p[0] - 1.0, u * u], [p[0] - 2.0 * u * v, -u * u]];
            for c in 0..2 {
                let row = 2 * i + c;
                for (d, rate) in rates[c].iter().enumerate() {
                    j.put(row, 2 * i + d, *rate);
                }
                j.put(row, row, -2.0 * D[c] / h2);
                if i > 0 {
                    j.put(row, row - 2, D[c] / h2);
                }
                if i + 1 < n {
                    j.put(row, row + 2, D[c] / h2);
                }
            }
        }
        Ok(())
    }

    fn parameter_derivative(
        &self,
        x: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        let (n, h2) = (self.cells, (p[1] * self.h()).powi(2));
        if which.0 == 1 {
            // diffusion is what a residual without rates is
            let mut rates = vec![0.0; 2 * n];
            self.residual(x, p, out)?;
            self.residual(x, &[p[0], f64::INFINITY], &mut rates)?;
            for (out, rates) in out.iter_mut().zip(&rates) {
                *out = -2.0 / p[1] * (*out - rates);
            }
            return Ok(());
        }
        for i in 0..n {
            let ends = f64::from(u8::from(i == 0)) + f64::from(u8::from(i + 1 == n));
            out[2 * i] = -x[2 * i];
            out[2 * i + 1] = x[2 * i] + D[1] * ends / (A * h2);
        }
        Ok(())
    }

    fn stability(&self) -> Stability {
        Stability::Dynamics
    }
}

pub(crate) fn follow<P: Problem>(problem: &P, u: &[f64], start: f64, end: f64) -> Branch {
    let settings = Settings { target: Some(end), ..Settings::default() };
    let mut p = vec![1.0; problem.parameters().len()];
    p[0] = start;
    Tracer::new(problem, &problem.parameters()[0].name, u, &p, settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()))
}

fn oscillations<J: Entries>(cells: usize) {
    let problem = Brusselator::<J>::new(cells);
    let u: Vec<f64> = (0..cells).flat_map(|_| [A, 2.0]).collect();
    let branch = follow(&problem, &u, 4.0, 9.5);
    let hopf: Vec<_> = branch.events_of(&EventKind::Hopf).collect();
    let known: Vec<f64> = (1..)
        .map(|k| 1.0 + A * A + (D[0] + D[1]) * problem.kappa(k))
        .take_while(|b| *b < 9.5)
        .collect();
    assert!(known.len() >= 6);
    let found: Vec<f64> = hopf.iter().map(|e| e.p).collect();
    assert_eq!(found.len(), known.len(), "{found:?} {known:?}");
    for (k, (event, known)) in hopf.iter().zip(&known).enumerate() {
        assert!((event.p - known).abs() < 1e-8, "{found:?} {known:?}");
        let counts = (event.unstable_before, event.unstable_after);
        assert_eq!(counts, (Some(2 * k), Some(2 * k + 2)));
    }
    assert_eq!(branch.events.len(), known.len());
}

#[test]
fn oscillations_of_every_wavelength() {
    oscillations::<Dense>(40);
    oscillations::<Band>(40);
    oscillations::<Sparse>(40);
    oscillations::<Band>(400);
    oscillations::<Sparse>(400);
}

/// Bratu's problem on a square, `Δu + λ exp u = 0`, by five-point differences.
struct Square<J> {
    side: usize,
    matrix: std::marker::PhantomData<fn() -> J>,
}

impl<J: Entries> Square<J> {
    fn new(side: usize) -> Self {
        Square { side, matrix: std::marker::PhantomData }
    }

    fn neighbours(&self, i: usize) -> impl Iterator<Item = usize> {
        let m = self.side;
        let (x, y) = (i % m, i / m);
        let all = [
            (x > 0).then(|| i - 1),
            (x + 1 < m).then(|| i + 1),
            (y > 0).then(|| i - m),
            (y + 1 < m).then(|| i + m),
        ];
        all.into_iter().flatten()
    }
}

impl<J: Entries> Problem for Square<J> {
    type Jacobian = J;

    fn dim(&self) -> usize {
        self.side * self.side
    }

    fn parameters(&self) -> &[Parameter] {
        const { &[Parameter::new("lambda", "", 1.0)] }
    }

    fn new_jacobian(&self) -> J {
        let mut pattern = Vec::new();
        for i in 0..self.dim() {
            pattern.push((i, i));
            pattern.extend(self.neighbours(i).map(|j| (i, j)));
        }
        J::new(self.dim(), &pattern, self.side)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let h = 1.0 / (self.side + 1) as f64;
        for i in 0..u.len() {
            let around: f64 = self.neighbours(i).map(|j| u[j]).sum();
            r[i] = (around - 4.0 * u[i]) / (h * h) + p[0] * u[i].exp();
        }
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut J) -> Result<(), EvalError> {
        let h = 1.0 / (self.side + 1) as f64;
        j.set_zero();
        for i in 0..u.len() {
            j.put(i, i, -4.0 / (h * h) + p[0] * u[i].exp());
            for k in self.neighbours(i) {
                j.put(i, k, 1.0 / (h * h));
            }
        }
        Ok(())
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        _: &[f64],
        _: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        out.iter_mut().zip(u).for_each(|(o, u)| *o = u.exp());
        Ok(())
    }

    fn stability(&self) -> Stability {
        Stability::Dynamics
    }
}

/// The events up to a number of points past the fold.
fn square<J: Entries>(side: usize) -> Vec<(EventKind, f64, Option<usize>, Option<usize>)> {
    let problem = Square::<J>::new(side);
    let settings = Settings { domain: Some((0.0, 8.0)), max_points: 150, ..Settings::default() };
    let branch = Tracer::new(&problem, "lambda", &vec![0.0; side * side], &[0.0], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    let events = branch.events.iter();
    events.map(|e| (e.kind.clone(), e.p, e.unstable_before, e.unstable_after)).collect()
}

#[test]
fn square_in_every_storage() {
    let dense = square::<Dense>(12);
    assert_eq!(dense[0].0, EventKind::Fold);
    // the fold of the continuous problem is at 6.80812442
    assert!((dense[0].1 - 6.808).abs() < 0.03, "{dense:?}");
    for other in [square::<Sparse>(12), square::<Band>(12)] {
        assert_eq!(other.len(), dense.len(), "{other:?} {dense:?}");
        for (a, b) in other.iter().zip(&dense) {
            assert_eq!((&a.0, a.2, a.3), (&b.0, b.2, b.3), "{other:?} {dense:?}");
            assert!((a.1 - b.1).abs() < 1e-9, "{other:?} {dense:?}");
        }
    }
    let fine = square::<Sparse>(30);
    assert!(fine[0].0 == EventKind::Fold && (fine[0].1 - 6.808_124).abs() < 3e-3, "{fine:?}");
}

/// A chain of links with torsional springs under an end load, as an energy, whose last link is held
/// in line by a force (the multiplier): `Σ (θ_i − θ_{i−1})²/2 + p Σ cos θ_i + μ Σ sin θ_i`.
struct Chain<J> {
    links: usize,
    matrix: std::marker::PhantomData<fn() -> J>,
}

impl<J> Chain<J> {
    fn new(links: usize) -> Self {
        Chain { links, matrix: std::marker::PhantomData }
    }

    fn rows(&self, x: &[f64], p: f64) -> Vec<(usize, usize, f64)> {
        let n = self.links;
        let mut rows = Vec::new();
        for i in 0..n {
            let springs = 1.0 + f64::from(u8::from(i + 1 < n));
            rows.push((i, i, springs - p * x[i].cos() - x[n] * x[i].sin()));
            if i > 0 {
                rows.push((i, i - 1, -1.0));
                rows.push((i - 1, i, -1.0));
            }
        }
        rows
    }

    fn force(&self, x: &[f64], p: f64, r: &mut [f64]) {
        let n = self.links;
        r[n] = 0.0;
        for i in 0..n {
            let before = if i > 0 { x[i - 1] } else { 0.0 };
            let after = if i + 1 < n { x[i] - x[i + 1] } else { 0.0 };
            r[i] = x[i] - before + after - p * x[i].sin() + x[n] * x[i].cos();
            r[n] += x[i].sin();
        }
    }
}

macro_rules! chain {
    ($matrix:ty, $new:expr, $fill:expr) => {
        impl Problem for Chain<$matrix> {
            type Jacobian = $matrix;
            fn dim(&self) -> usize {
                self.links + 1
            }
            fn parameters(&self) -> &[Parameter] {
                const { &[Parameter::new("load", "", 1.0)] }
            }
            fn new_jacobian(&self) -> $matrix {
                $new(self.links)
            }
            fn residual(&self, x: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
                self.force(x, p[0], r);
                Ok(())
            }
            fn jacobian(&self, x: &[f64], p: &[f64], j: &mut $matrix) -> Result<(), EvalError> {
                j.set_zero();
                $fill(self, x, p[0], j);
                Ok(())
            }
            fn parameter_derivative(
                &self,
                x: &[f64],
                _: &[f64],
                _: ParamId,
                out: &mut [f64],
            ) -> Result<(), EvalError> {
                let n = self.links;
                out[n] = 0.0;
                (0..n).for_each(|i| out[i] = -x[i].sin());
                Ok(())
            }
            fn stability(&self) -> Stability {
                Stability::EnergyHessian
            }
            fn multipliers(&self) -> usize {
                1
            }
        }
    };
}

chain!(
    Dense,
    |n: usize| Dense::new(n + 1),
    |chain: &Chain<Dense>, x: &[f64], p: f64, j: &mut Dense| {
        let n = chain.links;
        for (i, k, value) in chain.rows(x, p) {
            j.add(i, k, value);
        }
        for i in 0..n {
            j.set(i, n, x[i].cos());
            j.set(n, i, x[i].cos());
        }
    }
);
chain!(
    Arrow<Band>,
    |n: usize| Arrow::new(Band::new(n, 1, 1), 1),
    |chain: &Chain<Arrow<Band>>, x: &[f64], p: f64, j: &mut Arrow<Band>| {
        let n = chain.links;
        for (i, k, value) in chain.rows(x, p) {
            j.core_mut().add(i, k, value);
        }
        for i in 0..n {
            j.row_mut(0)[i] = x[i].cos();
            j.column_mut(0)[i] = x[i].cos();
        }
    }
);

#[test]
fn constraint_in_a_full_matrix_and_in_an_arrow() {
    let n = 30;
    let full = follow(&Chain::<Dense>::new(n), &vec![0.0; n + 1], 0.001, 0.3);
    let arrow = follow(&Chain::<Arrow<Band>>::new(n), &vec![0.0; n + 1], 0.001, 0.3);
    assert!(full.events.len() >= 3);
    let points = |branch: &Branch| -> Vec<(EventKind, usize)> {
        let events = branch.events.iter();
        events.map(|e| (e.kind.clone(), e.crossing().unwrap().multiplicity)).collect()
    };
    assert_eq!(points(&full), points(&arrow));
    for (a, b) in full.events.iter().zip(&arrow.events) {
        assert!((a.p - b.p).abs() < 1e-11, "{} {}", a.p, b.p);
        assert_eq!((a.unstable_before, a.unstable_after), (b.unstable_before, b.unstable_after));
    }
    // straight, the multiplier counted out, the chain is stable until it buckles
    assert_eq!(full.points[0].unstable, Some(0));
    assert_eq!(arrow.points[0].unstable, Some(0));
}

/// A Hopf point with an algebraic equation: the third unknown is the sum of squares, at once.
struct Algebraic;

impl Problem for Algebraic {
    type Jacobian = Dense;

    fn dim(&self) -> usize {
        3
    }

    fn parameters(&self) -> &[Parameter] {
        const { &[Parameter::new("p", "", 1.0)] }
    }

    fn new_jacobian(&self) -> Dense {
        Dense::new(3)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        r[0] = 2.0 * (p[0] * u[0] - u[1] - u[0] * u[2]);
        r[1] = u[0] + p[0] * u[1] - u[1] * u[2];
        r[2] = u[2] - u[0] * u[0] - u[1] * u[1];
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        let rows = [
            [2.0 * (p[0] - u[2]), -2.0, -2.0 * u[0]],
            [1.0, p[0] - u[2], -u[1]],
            [-2.0 * u[0], -2.0 * u[1], 1.0],
        ];
        for (i, row) in rows.iter().enumerate() {
            row.iter().enumerate().for_each(|(k, value)| j.set(i, k, *value));
        }
        Ok(())
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        _: &[f64],
        _: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        out.copy_from_slice(&[2.0 * u[0], u[1], 0.0]);
        Ok(())
    }

    fn mass(&self, m: &mut Dense) -> bool {
        m.set(0, 0, 2.0);
        m.set(1, 1, 1.0);
        true
    }

    fn stability(&self) -> Stability {
        Stability::Dynamics
    }
}

#[test]
fn oscillations_with_an_algebraic_equation() {
    let branch = follow(&Algebraic, &[0.0; 3], -1.0, 1.0);
    assert_eq!(branch.events.len(), 1, "{:?}", branch.events);
    let event = &branch.events[0];
    assert_eq!(event.kind, EventKind::Hopf);
    assert!(event.p.abs() < 1e-12);
    assert_eq!((event.unstable_before, event.unstable_after), (Some(0), Some(2)));
    let continuation::Detail::Hopf(form) = event.detail else { panic!("{:?}", event.detail) };
    assert!((form.frequency - 1.0).abs() < 1e-10);
    assert_eq!(form.criticality, Some(continuation::Criticality::Supercritical));
}
