//! Problems whose crossings are known, and what a trace of them must say.

use continuation::linalg::{Band, Dense, Matrix, Sparse};
use continuation::{
    Branch, EvalError, EventKind, ParamId, Parameter, Problem, Settings, Stability, StopReason,
    Tracer,
};
use std::marker::PhantomData;
use std::ops::ControlFlow;

pub(crate) use crate::random::Random;

/// Where entries of a Jacobian go.
pub(crate) trait Entries: Matrix {
    fn with_band(n: usize, band: usize) -> Self;
    fn put(&mut self, i: usize, j: usize, value: f64);
}

impl Entries for Dense {
    fn with_band(n: usize, _: usize) -> Self {
        Dense::new(n)
    }
    fn put(&mut self, i: usize, j: usize, value: f64) {
        self.add(i, j, value);
    }
}

impl Entries for Band {
    fn with_band(n: usize, band: usize) -> Self {
        Band::new(n, band, band)
    }
    fn put(&mut self, i: usize, j: usize, value: f64) {
        self.add(i, j, value);
    }
}

impl Entries for Sparse {
    fn with_band(n: usize, band: usize) -> Self {
        let near = |i: usize| (i.saturating_sub(band)..(i + band + 1).min(n)).map(move |j| (i, j));
        let pattern: Vec<(usize, usize)> = (0..n).flat_map(near).collect();
        Sparse::new(n, &pattern).unwrap()
    }
    fn put(&mut self, i: usize, j: usize, value: f64) {
        self.add(i, j, value).unwrap();
    }
}

/// `u = T v`, `v_i' = (p − c_i) v_i − v_i³`: branch points of `u = 0` at the `c_i`.
pub(crate) struct Modes<J> {
    c: Vec<f64>,
    /// Two layers of 2 × 2 blocks; `T` is their product, the identity if they are empty.
    layers: [Vec<[f64; 4]>; 2],
    pub(crate) sense: Stability,
    matrix: PhantomData<fn() -> J>,
}

/// Reach of `T D T⁻¹`.
const REACH: usize = 4;

impl<J: Entries> Modes<J> {
    pub(crate) fn new(c: &[f64], layers: [Vec<[f64; 4]>; 2]) -> Self {
        Modes { c: c.to_vec(), layers, sense: Stability::Dynamics, matrix: PhantomData }
    }

    fn layer(&self, which: usize, inverse: bool, x: &mut [f64]) {
        for (k, block) in self.layers[which].iter().enumerate() {
            let i = 2 * k + which;
            let [a, b, c, d] = if inverse {
                let det = block[0] * block[3] - block[1] * block[2];
                [block[3], -block[1], -block[2], block[0]].map(|x| x / det)
            } else {
                *block
            };
            (x[i], x[i + 1]) = (a * x[i] + b * x[i + 1], c * x[i] + d * x[i + 1]);
        }
    }

    fn invert_similarity(&self, x: &mut [f64]) {
        self.layer(0, true, x);
        self.layer(1, true, x);
    }

    fn apply_similarity(&self, x: &mut [f64]) {
        self.layer(1, false, x);
        self.layer(0, false, x);
    }

    fn sign(&self) -> f64 {
        if self.sense == Stability::EnergyHessian { -1.0 } else { 1.0 }
    }
}

impl<J: Entries> Problem for Modes<J> {
    type Jacobian = J;
    fn dim(&self) -> usize {
        self.c.len()
    }
    fn parameters(&self) -> &[Parameter] {
        const { &[Parameter::new("p", "", 1.0)] }
    }
    fn new_jacobian(&self) -> J {
        J::with_band(self.dim(), if self.layers[0].is_empty() { 0 } else { REACH })
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let mut v = u.to_vec();
        self.invert_similarity(&mut v);
        for (v, c) in v.iter_mut().zip(&self.c) {
            *v = self.sign() * ((p[0] - c) * *v - v.powi(3));
        }
        self.apply_similarity(&mut v);
        r.copy_from_slice(&v);
        Ok(())
    }
    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut J) -> Result<(), EvalError> {
        let n = self.dim();
        let mut v = u.to_vec();
        self.invert_similarity(&mut v);
        j.set_zero();
        let mut x = vec![0.0; n];
        for k in 0..n {
            x.fill(0.0);
            x[k] = 1.0;
            self.invert_similarity(&mut x);
            for ((x, c), v) in x.iter_mut().zip(&self.c).zip(&v) {
                *x *= self.sign() * (p[0] - c - 3.0 * v * v);
            }
            self.apply_similarity(&mut x);
            for (i, x) in x.iter().enumerate().filter(|(_, x)| **x != 0.0) {
                j.put(i, k, *x);
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
        let sign = self.sign();
        out.iter_mut().zip(u).for_each(|(o, u)| *o = sign * u);
        Ok(())
    }
    fn stability(&self) -> Stability {
        self.sense
    }
}

pub(crate) fn trace<P: Problem>(problem: &P, from: f64, to: f64) -> Branch {
    trace_with(problem, from, Settings { target: Some(to), ..Settings::default() })
}

pub(crate) fn trace_with<P: Problem>(problem: &P, from: f64, settings: Settings) -> Branch {
    let u = vec![0.0; problem.dim()];
    let name = &problem.parameters()[0].name;
    Tracer::new(problem, name, &u, &[from], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()))
}

/// Every crossing is found, none invented; counts are right or said to be uncertain, and then no
/// larger than the right ones.
pub(crate) fn check(branch: &Branch, c: &[f64], what: &str) {
    assert_eq!(branch.stopped.reason, StopReason::Target, "{what}: {:?}", branch.stopped);
    let mut exact: Vec<f64> = c.iter().copied().filter(|c| (0.0..1.0).contains(c)).collect();
    exact.sort_by(f64::total_cmp);
    let found: Vec<f64> = branch.events.iter().map(|e| e.p).collect();
    assert_eq!(found.len(), exact.len(), "{what}: {found:?}, {exact:?}, {:?}", branch.doubts);
    for (event, exact) in branch.events.iter().zip(&exact) {
        assert_eq!(event.kind, EventKind::BranchPoint, "{what}");
        // the products of the test's own matrices are rounded
        let largest = c.iter().fold(1.0, |m: f64, c| m.max(c.abs()));
        let rounding = 64.0 * f64::EPSILON * largest;
        // and an eigenvalue is known from them as well as the similarity, two layers of blocks of
        // condition 4 at most, allows
        let resolved = f64::max(1e-9, 4.0 * 16.0_f64.powi(2) * f64::EPSILON * largest);
        let off = (event.p - exact).abs();
        assert!(off < resolved, "{what}: {} for {exact}, {:?}", event.p, branch.doubts);
        assert!(
            off <= event.error_estimate + rounding,
            "{what}: {off:e} {:e}",
            event.error_estimate
        );
    }
    for point in branch.points.iter().filter(|point| point.event.is_none()) {
        let right = c.iter().filter(|c| point.p > **c).count();
        let count = point.unstable.unwrap();
        let holds = if point.certified { count == right } else { count <= right };
        assert!(holds, "{what}: {count} for {right} at {}, {}", point.p, point.certified);
    }
}

pub(crate) fn in_every_storage(c: &[f64], layers: &[Vec<[f64; 4]>; 2], what: &str) {
    check(&trace(&Modes::<Band>::new(c, layers.clone()), 0.0, 1.0), c, &format!("{what}, band"));
    check(
        &trace(&Modes::<Sparse>::new(c, layers.clone()), 0.0, 1.0),
        c,
        &format!("{what}, sparse"),
    );
    if c.len() <= 100 {
        let dense = Modes::<Dense>::new(c, layers.clone());
        check(&trace(&dense, 0.0, 1.0), c, &format!("{what}, dense"));
    }
}

impl Random {
    pub(crate) fn next(&mut self) -> f64 {
        self.between(0.0, 1.0)
    }

    /// One to six crossings anywhere, some just before and after the target, the others far.
    pub(crate) fn crossings(&mut self, n: usize) -> Vec<f64> {
        let crossings = 1 + (6.0 * self.next()) as usize;
        let mut c: Vec<f64> = (0..crossings)
            .map(|_| match (6.0 * self.next()) as usize {
                0 => 1.0 - 0.02 * self.next(),
                1 => 1.0 + 0.02 * self.next(),
                2 => 0.5 + 0.05 * self.next(),
                _ => 0.001 + 0.998 * self.next(),
            })
            .collect();
        // crossings closer than this are one to the steps that can be made
        c.sort_by(f64::total_cmp);
        c.dedup_by(|a, b| *a - *b < 1e-4);
        while c.len() < n {
            let far = 10f64.powf(4.0 * self.next());
            c.push(if self.next() < 0.1 { -0.1 - 0.01 * far } else { 1.5 + far });
        }
        // in no order
        for i in (1..n).rev() {
            c.swap(i, (self.next() * (i + 1) as f64) as usize);
        }
        c
    }

    pub(crate) fn layers(&mut self, n: usize, rotations: bool) -> [Vec<[f64; 4]>; 2] {
        [0, 1].map(|first| {
            let blocks = (n - first) / 2;
            (0..blocks)
                .map(|_| {
                    let (a, b) = (self.next(), self.next());
                    if rotations {
                        let (s, c) = (6.0 * a).sin_cos();
                        [c, -s, s, c]
                    } else {
                        [1.0, a, -0.5 * b, 1.0]
                    }
                })
                .collect()
        })
    }
}

/// The random problems with these numbers, in every storage.
pub(crate) fn random_problems(numbers: impl IntoIterator<Item = usize>) {
    let mut random = Random(1);
    let mut drawn = 0;
    for number in numbers {
        while drawn <= number {
            let k = drawn;
            drawn += 1;
            let n = if k % 20 == 0 { 400 } else { 41 + (60.0 * random.next()) as usize };
            let c = random.crossings(n);
            let layers = match k % 3 {
                0 => [Vec::new(), Vec::new()],
                kind => random.layers(n, kind == 1),
            };
            if k == number {
                in_every_storage(&c, &layers, &format!("problem {k}, {n} unknowns"));
            }
        }
    }
}
