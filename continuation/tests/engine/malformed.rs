//! Problems that are wrong in themselves: a typed error, never a panic and never silence.

#![allow(clippy::unwrap_used)]

use continuation::linalg::{Arrow, Band, Bordered, Dense, OutsidePattern, SymmetricBand};
use continuation::{
    DenseProblem, EvalError, Matrix, Name, NewtonError, ParamId, Parameter, Problem, ProblemError,
    Settings, StopReason, TraceError, Tracer, names, newton,
};
use std::ops::ControlFlow;

fn error<P: Problem>(problem: &P, u: &[f64], p: &[f64]) -> TraceError {
    let settings = Settings { target: Some(2.0), ..Settings::default() };
    Tracer::new(problem, "p", u, p, settings).err().unwrap()
}

static PARAMETERS: [Parameter; 1] = [Parameter::new("p", "", 1.0)];

/// `f_i = p − u_i` in a matrix of any type, with faults.
struct Simple<A> {
    n: usize,
    new: fn(usize) -> A,
    fill: fn(usize, &mut A),
    skips_metric: bool,
    adds_slope: bool,
    observes: bool,
}

impl<A: Matrix> Simple<A> {
    fn new(n: usize, new: fn(usize) -> A, fill: fn(usize, &mut A)) -> Self {
        Simple { n, new, fill, skips_metric: false, adds_slope: false, observes: true }
    }
}

impl<A: Matrix> Problem for Simple<A> {
    type Jacobian = A;
    fn dim(&self) -> usize {
        self.n
    }
    fn parameters(&self) -> &[Parameter] {
        &PARAMETERS
    }
    fn new_jacobian(&self) -> A {
        (self.new)(self.n)
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        r.iter_mut().zip(u).for_each(|(r, u)| *r = p[0] - u);
        Ok(())
    }
    fn jacobian(&self, _u: &[f64], _p: &[f64], j: &mut A) -> Result<(), EvalError> {
        j.set_zero();
        (self.fill)(self.n, j);
        Ok(())
    }
    fn parameter_derivative(
        &self,
        _u: &[f64],
        _p: &[f64],
        _which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        if self.adds_slope {
            out.iter_mut().for_each(|o| *o += 1.0);
        } else {
            out.fill(1.0);
        }
        Ok(())
    }
    fn metric(&self, x: &[f64], y: &mut [f64]) {
        if !self.skips_metric {
            y.copy_from_slice(x);
        }
    }
    fn observables(&self) -> &[Name] {
        names!["first"]
    }
    fn observe(&self, u: &[f64], _p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        if self.observes {
            out[0] = u[0];
        }
        Ok(())
    }
}

fn diagonal(n: usize, j: &mut Dense) {
    (0..n).for_each(|i| j.set(i, i, -1.0));
}

#[test]
fn sizes() {
    let wrong = |n: usize| Dense::new(n + 1);
    let problem = Simple::new(2, wrong, |_, _| {});
    let expected = ProblemError::JacobianSize { got: 3, expected: 2 };
    assert_eq!(error(&problem, &[1.0, 1.0], &[1.0]), TraceError::Problem(expected.clone()));
    let mut u = [1.0, 1.0];
    let found = newton(&problem, &mut u, &[1.0], &Default::default());
    assert_eq!(found, Err(NewtonError::Problem(expected)));
    let empty = Simple::new(0, Dense::new, diagonal);
    assert_eq!(error(&empty, &[], &[1.0]), TraceError::Problem(ProblemError::NoUnknowns));
    let good = Simple::new(2, Dense::new, diagonal);
    for (u, p) in [(&[1.0][..], &[1.0][..]), (&[1.0; 3], &[1.0]), (&[1.0; 2], &[])] {
        assert!(matches!(error(&good, u, p), TraceError::Length { .. }));
        let mut u = u.to_vec();
        let found = newton(&good, &mut u, p, &Default::default());
        assert!(matches!(found, Err(NewtonError::Problem(ProblemError::Length { .. }))));
    }
    let nothing = DenseProblem::from_residual(0, &["p"], |_, _, _| {}).boxed();
    assert_eq!(error(&nothing, &[], &[1.0]), TraceError::Problem(ProblemError::NoUnknowns));
}

#[test]
fn entries_that_are_never_set() {
    let unwritten = |what, at| TraceError::Problem(ProblemError::Unwritten { what, at });
    let skips = DenseProblem::from_residual(2, &["p"], |u, p, r| r[0] = p[0] - u[0] - u[1]).boxed();
    assert_eq!(error(&skips, &[0.0, 0.0], &[0.0]), unwritten("the residual", 1));
    let adds = DenseProblem::from_residual(2, &["p"], |u, p, r| {
        r[0] += p[0] - u[0];
        r[1] = p[0] - u[1];
    })
    .boxed();
    assert_eq!(error(&adds, &[0.0, 0.0], &[0.0]), unwritten("the residual", 0));
    let slope = Simple { adds_slope: true, ..Simple::new(2, Dense::new, diagonal) };
    assert_eq!(error(&slope, &[0.0; 2], &[0.0]), unwritten("the derivative by the parameter", 0));
    let metric = Simple { skips_metric: true, ..Simple::new(2, Dense::new, diagonal) };
    assert_eq!(error(&metric, &[0.0; 2], &[0.0]), unwritten("the metric", 0));
    let blind = Simple { observes: false, ..Simple::new(2, Dense::new, diagonal) };
    assert_eq!(error(&blind, &[0.0; 2], &[0.0]), unwritten("the observables", 0));
}

#[test]
fn nothing_to_solve() {
    let zero = DenseProblem::from_residual(2, &["p"], |_, _, r| r.fill(0.0)).boxed();
    assert_eq!(error(&zero, &[1.0, 2.0], &[1.0]), TraceError::Problem(ProblemError::NoEquation));
    // zero with both derivatives at the start, and not elsewhere
    let flat = DenseProblem::from_residual(1, &["p"], |u, p, r| r[0] = u[0].powi(3) - p[0].powi(3))
        .boxed();
    let settings = Settings { target: Some(2.0), ..Settings::default() };
    let found = Tracer::new(&flat, "p", &[0.0], &[0.0], settings).err();
    assert_ne!(found, Some(TraceError::Problem(ProblemError::NoEquation)));
    for scale in [0.0, f64::NAN, f64::INFINITY, -1.0] {
        let problem = DenseProblem::from_residual(1, &["p"], |u, p, r| r[0] = u[0] - p[0])
            .boxed()
            .with_scale(ParamId(0), scale);
        let found = error(&problem, &[0.0], &[0.0]);
        assert!(
            matches!(found, TraceError::Problem(ProblemError::Scale { parameter, .. }) if parameter == "p")
        );
    }
}

#[test]
fn entries_outside_the_band() {
    let mut band = Band::new(4, 1, 1);
    band.set(1, 1, 5.0);
    band.set(3, 0, 7.0);
    band.add(0, 2, 7.0);
    assert_eq!(band.misplaced(), Some(OutsidePattern { row: 3, column: 0 }));
    let mut dense = Dense::new(4);
    (0..4).for_each(|i| (0..4).for_each(|j| dense.set(i, j, band.get(i, j))));
    let total: f64 = (0..4).map(|j| dense.column(j).iter().sum::<f64>()).sum();
    assert_eq!(total, 5.0);
    dense.set(4, 0, 1.0);
    assert_eq!(dense.misplaced(), Some(OutsidePattern { row: 4, column: 0 }));
    assert_eq!(dense.get(0, 1), 0.0);
    let mut symmetric = SymmetricBand::new(4, 1);
    symmetric.add(0, 1, 1.0);
    assert_eq!(symmetric.misplaced(), Some(OutsidePattern { row: 0, column: 1 }));
    symmetric.set_zero();
    assert_eq!(symmetric.misplaced(), None);

    let entry = OutsidePattern { row: 3, column: 0 };
    let outside = TraceError::Start(NewtonError::Start(EvalError::OutsidePattern(entry)));
    let problem = Simple::new(
        4,
        |n| Band::new(n, 1, 1),
        |n, j: &mut Band| {
            (0..n).for_each(|i| j.set(i, i, -1.0));
            j.set(3, 0, 1e-3);
        },
    );
    assert_eq!(error(&problem, &[1.0; 4], &[1.0]), outside);
    let arrow = Simple::new(
        5,
        |n| Arrow::new(Band::new(n - 1, 1, 1), 1),
        |n, j: &mut Arrow<Band>| {
            (0..n - 1).for_each(|i| j.core_mut().set(i, i, -1.0));
            j.core_mut().add(3, 0, 1e-3);
            j.set_corner(0, 0, -1.0);
        },
    );
    assert_eq!(error(&arrow, &[1.0; 5], &[1.0]), outside);
}

/// Permutation matrices from cores that are singular more often than the elimination can see.
#[test]
fn determinants_of_regular_arrows() {
    let shift = |transposed: bool| {
        let mut core = Dense::new(2);
        if transposed {
            core.set(1, 0, 1.0)
        } else {
            core.set(0, 1, 1.0)
        }
        core
    };
    let unit = |i: usize| if i == 0 { [1.0, 0.0] } else { [0.0, 1.0] };
    let mut regular = 0;
    for transposed in [false, true] {
        for borders in [vec![0], vec![1], vec![0, 1], vec![1, 0]] {
            for rows in [vec![0], vec![1], vec![0, 1], vec![1, 0]] {
                let m = borders.len();
                if rows.len() != m {
                    continue;
                }
                for size in [1e-9, 1.0, 1e7] {
                    let mut arrow = Arrow::new(shift(transposed), m);
                    let mut bordered = Bordered::new(2, m);
                    let mut full = Dense::new(2 + m);
                    full.set(usize::from(transposed), usize::from(!transposed), 1.0);
                    for k in 0..m {
                        let (b, c) = (unit(borders[k]), unit(rows[k]).map(|x| size * x));
                        arrow.column_mut(k).copy_from_slice(&b);
                        arrow.row_mut(k).copy_from_slice(&c);
                        bordered.column_mut(k).copy_from_slice(&b);
                        bordered.row_mut(k).copy_from_slice(&c);
                        for i in 0..2 {
                            full.set(i, 2 + k, b[i]);
                            full.set(2 + k, i, c[i]);
                        }
                    }
                    let exact = full.factor(0.0);
                    let facts = arrow.factor(f64::EPSILON * arrow.norm());
                    let sign = bordered.factor(&mut shift(transposed)).det_sign;
                    if exact.perturbed > 0 {
                        continue;
                    }
                    regular += 1;
                    assert_eq!(facts.det_sign, exact.det_sign, "{transposed} {borders:?} {rows:?}");
                    assert_eq!(sign, exact.det_sign);
                    if facts.perturbed > 0 {
                        continue;
                    }
                    let mut x = vec![1.0; 2 + m];
                    arrow.solve(&mut x);
                    let mut back = vec![0.0; 2 + m];
                    arrow.mul(&x, &mut back);
                    let largest = x.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
                    let rounding = 8.0 * f64::EPSILON * largest * arrow.norm();
                    assert!(back.iter().all(|b| (b - 1.0).abs() < rounding), "{back:?}");
                }
            }
        }
    }
    assert_eq!(regular, 3 * (2 + 8));
}

#[test]
fn an_arrow_of_a_singular_core_is_traced() {
    // u₁ = x₁, x₀ = p, λ from the equation of the core's empty row
    struct Shift;
    impl Problem for Shift {
        type Jacobian = Arrow<Dense>;
        fn dim(&self) -> usize {
            3
        }
        fn parameters(&self) -> &[Parameter] {
            &PARAMETERS
        }
        fn new_jacobian(&self) -> Arrow<Dense> {
            Arrow::new(Dense::new(2), 1)
        }
        fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
            r[0] = u[1] - p[0].sin();
            r[1] = u[2] - u[1] * u[1];
            r[2] = u[0] - p[0];
            Ok(())
        }
        fn jacobian(&self, u: &[f64], _p: &[f64], j: &mut Arrow<Dense>) -> Result<(), EvalError> {
            j.set_zero();
            j.core_mut().set(0, 1, 1.0);
            j.core_mut().set(1, 1, -2.0 * u[1]);
            j.column_mut(0)[1] = 1.0;
            j.row_mut(0)[0] = 1.0;
            Ok(())
        }
        fn parameter_derivative(
            &self,
            _u: &[f64],
            p: &[f64],
            _which: ParamId,
            out: &mut [f64],
        ) -> Result<(), EvalError> {
            out.copy_from_slice(&[-p[0].cos(), 0.0, -1.0]);
            Ok(())
        }
    }
    let settings = Settings { target: Some(2.0), ..Settings::default() };
    let branch = Tracer::new(&Shift, "p", &[0.0; 3], &[0.0], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    assert_eq!(branch.stopped.reason, StopReason::Target, "{:?}", branch.stopped);
    let end = branch.points.last().unwrap();
    assert!((end.u[2] - 2f64.sin().powi(2)).abs() < 1e-10 && branch.events.is_empty());
}
