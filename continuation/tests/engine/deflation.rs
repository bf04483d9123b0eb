//! Further solutions at the same parameters: all of them where their number is known.

#![allow(clippy::unwrap_used)]

use crate::scaled;

use continuation::deflation::{Deflated, Deflation, DeflationError, DeflationSettings};
use continuation::linalg::Dense;
use continuation::samples::{Bratu, Cusp};
use continuation::{
    DenseProblem, EvalError, EventKind, NewtonSettings, ParamId, Parameter, Problem, Settings,
    Tracer, Watch, newton,
};
use scaled::{SCALES, Scaled};
use std::ops::ControlFlow;

fn search<P: Problem>(problem: &P, p: &[f64], known: &[Vec<f64>]) -> Deflated {
    let settings = DeflationSettings::default();
    Deflation::new(problem, p, settings).unwrap().known(known).unwrap().run()
}

/// First unknowns of the known and the found solutions, sorted.
fn firsts(known: &[Vec<f64>], found: &Deflated) -> Vec<f64> {
    let mut all: Vec<f64> = known.iter().map(|u| u[0]).collect();
    all.extend(found.solutions.iter().map(|s| s.u[0]));
    all.sort_by(f64::total_cmp);
    all
}

/// Newton's method stays at every solution that was found.
fn stays<P: Problem>(problem: &P, p: &[f64], found: &Deflated) {
    for solution in &found.solutions {
        let mut u = solution.u.clone();
        newton(problem, &mut u, p, &NewtonSettings::default()).unwrap();
        let moved = u.iter().zip(&solution.u).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
        let size = u.iter().fold(solution.apart, |m, x| m.max(x.abs()));
        assert!(moved <= 1e-10 * size, "moved by {moved:e}");
    }
}

#[test]
fn the_cusp_has_three_solutions_from_any_one() {
    for first in [1.0, 0.0, -1.0] {
        let known = [vec![first]];
        let found = search(&Cusp, &[0.0, 1.0], &known);
        let all = firsts(&known, &found);
        assert_eq!(all.len(), 3, "{all:?}");
        for (x, exact) in all.iter().zip([-1.0, 0.0, 1.0]) {
            assert!((x - exact).abs() < 1e-12, "{all:?}");
        }
        assert!(found.report.exhausted);
        stays(&Cusp, &[0.0, 1.0], &found);
    }
}

#[test]
fn one_solution_remains_one() {
    // beyond the fold
    let found = search(&Cusp, &[2.0, 1.0], &[vec![1.521_379_706_804_568]]);
    assert!(found.solutions.is_empty() && found.report.exhausted, "{:?}", found.report);
}

#[test]
fn solutions_close_to_a_fold_are_told_apart() {
    let mu = 0.384_900_179_459 - 1e-9;
    let found = search(&Cusp, &[mu, 1.0], &[vec![1.154_7]]);
    let x = firsts(&[], &found);
    assert_eq!(x.len(), 2, "{x:?}");
    let apart = x[1] - x[0];
    assert!((2e-5..1e-4).contains(&apart), "{apart:e}");
    stays(&Cusp, &[mu, 1.0], &found);
}

/// Chebyshev's polynomial of degree 12: roots `cos((2k + 1)π/24)`, crowded at the ends.
struct Chebyshev(Vec<Parameter>);

impl Chebyshev {
    fn new() -> Self {
        Chebyshev(vec![Parameter::new("p", "", 1.0)])
    }

    fn value_and_slope(x: f64) -> (f64, f64) {
        let (mut t, mut d) = ([1.0, x], [0.0, 1.0]);
        for _ in 2..=12 {
            d = [d[1], 2.0 * t[1] + 2.0 * x * d[1] - d[0]];
            t = [t[1], 2.0 * x * t[1] - t[0]];
        }
        (t[1], d[1])
    }
}

impl Problem for Chebyshev {
    type Jacobian = Dense;
    fn dim(&self) -> usize {
        1
    }
    fn parameters(&self) -> &[Parameter] {
        &self.0
    }
    fn new_jacobian(&self) -> Dense {
        Dense::new(1)
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        r[0] = Self::value_and_slope(u[0]).0 + p[0];
        Ok(())
    }
    fn jacobian(&self, u: &[f64], _p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        j.set(0, 0, Self::value_and_slope(u[0]).1);
        Ok(())
    }
    fn parameter_derivative(
        &self,
        _u: &[f64],
        _p: &[f64],
        _which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        out[0] = 1.0;
        Ok(())
    }
}

#[test]
fn twelve_roots_of_a_polynomial_in_any_unit() {
    let root = |k: usize| ((2 * k + 1) as f64 * std::f64::consts::PI / 24.0).cos();
    for (a, b, c) in SCALES.into_iter().chain([(1.0, 1.0, 1.0)]) {
        let problem = Scaled::new(Chebyshev::new(), a, b, &[c]);
        let known = [vec![b * root(0)]];
        let found = search(&problem, &[0.0], &known);
        let all = firsts(&known, &found);
        assert_eq!(all.len(), 12, "{a:e} {b:e}: {all:?}, {:?}", found.report);
        for (k, x) in all.iter().rev().enumerate() {
            assert!((x / b - root(k)).abs() < 1e-12);
        }
        stays(&problem, &[0.0], &found);
    }
}

#[test]
fn nine_solutions_of_two_coupled_cubics() {
    // x − x³ + e y = 0, y − y³ + e x = 0
    let problem = DenseProblem::from_residual(2, &["e"], |u, p, r| {
        r[0] = u[0] - u[0].powi(3) + p[0] * u[1];
        r[1] = u[1] - u[1].powi(3) + p[0] * u[0];
    })
    .boxed();
    let known = [vec![0.0, 0.0]];
    let found = search(&problem, &[0.1], &known);
    assert_eq!(found.solutions.len(), 8, "{:?}", found.report);
    stays(&problem, &[0.1], &found);
}

/// Bratu at λ = 3, of 99 interior nodes: a band with one side diagonal, solved as such.
#[test]
fn bratu_has_two_solutions() {
    let problem = Bratu::new(99);
    let mut lower = vec![0.0; 99];
    newton(&problem, &mut lower, &[3.0], &NewtonSettings::default()).unwrap();
    let found = search(&problem, &[3.0], &[lower.clone()]);
    assert_eq!(found.solutions.len(), 1, "{:?}", found.report);
    assert!(found.report.exhausted);
    stays(&problem, &[3.0], &found);
    // the one to which the branch leads around its fold
    let settings = Settings { increasing: Some(true), ..Settings::default() };
    let branch = Tracer::new(&problem, "lambda", &[0.0; 99], &[0.0], settings)
        .unwrap()
        .watching(&[Watch::parameter(3.0), Watch::stop_at("max_u", 8.0)])
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    let upper = branch.events_of(&EventKind::Target).nth(1).unwrap();
    let upper = &branch.points[upper.point].u;
    let off = upper.iter().zip(&found.solutions[0].u).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f64::max) < 1e-9);
    // all that the branch passes is known
    let settings = DeflationSettings::default();
    let rest = Deflation::new(&problem, &[3.0], settings).unwrap().along(&branch, 5).unwrap().run();
    assert!(rest.solutions.is_empty() && rest.report.exhausted, "{:?}", rest.report);
}

#[test]
fn bratu_in_any_unit() {
    for (a, b, c) in SCALES {
        let problem = Scaled::new(Bratu::new(40), a, b, &[c]);
        let mut lower = vec![0.0; 40];
        newton(&problem, &mut lower, &[3.0 * c], &NewtonSettings::default()).unwrap();
        let found = search(&problem, &[3.0 * c], &[lower]);
        assert_eq!(found.solutions.len(), 1, "{a:e} {b:e} {c:e}: {:?}", found.report);
        let largest = found.solutions[0].u.iter().fold(0.0, |m: f64, x| m.max(*x));
        assert!((1.7..4.0).contains(&(largest / b)), "{largest:e}");
    }
}

/// `ln x` twice: `(ln x)² = 1`, of which `x = e` and `1/e` are the solutions; negative `x` are
/// outside of the domain.
#[test]
fn steps_out_of_the_domain_are_shortened() {
    let problem =
        DenseProblem::from_residual(1, &["p"], |x, p, r| r[0] = x[0].ln().powi(2) - p[0]).boxed();
    let known = [vec![1.0_f64.exp()]];
    let found = search(&problem, &[1.0], &known);
    assert_eq!(found.solutions.len(), 1, "{:?}", found.report);
    assert!((found.solutions[0].u[0] - (-1.0_f64).exp()).abs() < 1e-12);
    // a start outside is counted, not an error
    let settings = DeflationSettings { modes: 0, ..DeflationSettings::default() };
    let none =
        Deflation::new(&problem, &[1.0], settings).unwrap().starts(&[vec![-1.0]]).unwrap().run();
    assert!(none.solutions.is_empty() && none.report.inadmissible > 0, "{:?}", none.report);
}

#[test]
fn what_the_other_starts_need_is_kept_when_the_search_is_ended() {
    let settings = DeflationSettings::default();
    let search = Deflation::new(&Cusp, &[0.0, 1.0], settings).unwrap();
    let search = search.known(&[[1.0]]).unwrap();
    let found = search.run_observed(&mut |report| match report.found {
        0 => ControlFlow::Continue(()),
        _ => ControlFlow::Break(()),
    });
    assert_eq!(found.solutions.len(), 1);
    assert!(!found.report.exhausted);
}

#[test]
fn what_is_wrong_is_an_error() {
    let new = |settings| Deflation::new(&Cusp, &[0.0, 1.0], settings);
    let settings = DeflationSettings::default();
    let error = new(DeflationSettings { tolerance: 0.0, ..settings.clone() }).err().unwrap();
    assert!(matches!(error, DeflationError::Settings(e) if e.key == "tolerance"));
    let error = Deflation::new(&Cusp, &[0.0], settings.clone()).err().unwrap();
    assert!(matches!(error, DeflationError::Length { got: 1, expected: 2, .. }));
    let error = Deflation::new(&Cusp, &[f64::NAN, 1.0], settings.clone()).err().unwrap();
    assert!(matches!(error, DeflationError::NotFinite { at: 0, .. }));
    let error = new(settings.clone()).unwrap().known(&[[1.0, 2.0]]).err().unwrap();
    assert!(matches!(error, DeflationError::Length { got: 2, expected: 1, .. }));
    let error = new(settings.clone()).unwrap().starts(&[[f64::INFINITY]]).err().unwrap();
    assert!(matches!(error, DeflationError::NotFinite { .. }));
    let trace = Settings { target: Some(1.0), ..Settings::default() };
    let branch = Tracer::new(&Chebyshev::new(), "p", &[1.0], &[0.0], trace)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    let error = new(settings).unwrap().along(&branch, 3).err().unwrap();
    assert!(matches!(error, DeflationError::Foreign { name } if name == "p"));
}

/// A solution that is not on the branch is found although another one is known beforehand.
#[test]
fn a_branch_takes_only_what_is_its_own() {
    let settings = Settings { target: Some(0.2), ..Settings::default() };
    // the lower sheet, left of the fold: the other two solutions are not on it
    let branch = Tracer::new(&Cusp, "mu", &[-1.2], &[-0.5, 1.0], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    let at = [0.1, 1.0];
    let alone = Deflation::new(&Cusp, &at, DeflationSettings::default()).unwrap();
    let alone = alone.along(&branch, 4).unwrap().run();
    assert_eq!(alone.solutions.len(), 2);
    // the same solution handed over first must not make the passage run to another one
    let lowest =
        branch.points.iter().min_by(|a, b| (a.p - 0.1).abs().total_cmp(&(b.p - 0.1).abs()));
    let both = Deflation::new(&Cusp, &at, DeflationSettings::default()).unwrap();
    let both = both.known(&[lowest.unwrap().u.clone()]).unwrap().along(&branch, 4).unwrap().run();
    assert_eq!(both.solutions.len(), 2);
}
