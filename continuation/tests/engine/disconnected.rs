//! Branches that no branch point leads to, found from the one that is known.

#![allow(clippy::unwrap_used)]

use crate::scaled;

use continuation::deflation::{
    DeflationError, DeflationSettings, disconnected, disconnected_observed, lies_on,
};
use continuation::samples::{Bratu, Cusp};
use continuation::{
    Branch, DenseProblem, EventKind, NearSettings, Problem, Settings, Tracer, both_ways,
    near_bifurcations,
};
use scaled::{SCALES, Scaled};
use std::ops::ControlFlow;

/// The first branch, and those found from it, at values of the parameter too.
fn explore<P: Problem>(
    problem: &P,
    u: &[f64],
    p: &[f64],
    settings: &Settings,
    values: &[f64],
) -> Vec<Branch> {
    let name = &problem.parameters()[0].name;
    let mut go_on = |_: &_| ControlFlow::Continue(());
    let search = DeflationSettings::default();
    let first = both_ways(problem, name, u, p, settings.clone(), &[], &mut go_on).unwrap();
    let near = near_bifurcations(problem, &first, NearSettings::default()).unwrap();
    let mut branches = vec![first];
    for start in disconnected(problem, &branches, &near, values, &search).unwrap() {
        let known = |b: &Branch| lies_on(problem, b, &start.u, &start.p, &search).unwrap();
        if !branches.iter().any(known) {
            let settings = settings.clone();
            let (u, p) = (&start.u, &start.p);
            branches.push(both_ways(problem, name, u, p, settings, &[], &mut go_on).unwrap());
        }
    }
    branches
}

fn within(lo: f64, hi: f64) -> Settings {
    Settings { domain: Some((lo, hi)), ..Settings::default() }
}

fn folds(branch: &Branch) -> Vec<f64> {
    branch.events_of(&EventKind::Fold).map(|e| e.p).collect()
}

#[test]
fn the_other_branch_of_an_imperfect_pitchfork_in_any_unit() {
    for e in [1e-6, 1e-3, 3e-2_f64] {
        for (a, b, c) in SCALES.into_iter().chain([(1.0, 1.0, 1.0)]) {
            let inner = DenseProblem::from_residual(1, &["p"], move |x, p, r| {
                r[0] = p[0] * x[0] - x[0].powi(3) + e;
            })
            .boxed();
            let problem = Scaled::new(inner, a, b, &[c]);
            let branches = explore(&problem, &[0.0], &[-c], &within(-c, c), &[]);
            assert_eq!(branches.len(), 2, "{e:e} {a:e} {b:e} {c:e}");
            let fold = folds(&branches[1]);
            assert_eq!(fold.len(), 1);
            let exact = 3.0 * (0.5 * e).powf(2.0 / 3.0);
            assert!((fold[0] / c - exact).abs() < 1e-9, "{:e}", fold[0] / c - exact);
            let ends = [branches[1].points.first(), branches[1].points.last()];
            assert!(ends.iter().all(|end| (end.unwrap().p / c - 1.0).abs() < 1e-12));
        }
    }
}

#[test]
fn the_other_branch_of_an_imperfect_transcritical_point() {
    for e in [1e-4, -1e-4, 1e-2, -1e-2, 0.1, -0.1] {
        let problem = DenseProblem::from_residual(1, &["p"], move |u, p, r| {
            r[0] = (u[0] - p[0]) * (u[0] - 2.0) - e;
        })
        .boxed();
        let branches = explore(&problem, &[0.0], &[0.0], &within(0.0, 4.0), &[]);
        assert_eq!(branches.len(), 2, "{e:e}");
        let expected = if e > 0.0 { 0 } else { 1 };
        assert!(branches.iter().all(|b| folds(b).len() == expected), "{e:e}");
    }
}

/// AUTO's `enz`, its symmetry broken: what branch points joined are two branches.
#[test]
fn the_other_branch_of_a_broken_symmetry() {
    for e in [1e-3, 1e-2] {
        let problem = DenseProblem::from_residual(2, &["p"], move |u, p, r| {
            let rate = |s: f64| 100.0 * s / (1.0 + s + s * s);
            r[0] = p[0] + e - 2.0 * u[0] + u[1] - rate(u[0]);
            r[1] = p[0] - 2.0 * u[1] + u[0] - rate(u[1]);
        })
        .boxed();
        let branches = explore(&problem, &[0.0, 0.0], &[0.0], &within(0.0, 40.0), &[]);
        assert_eq!(branches.len(), 2, "{e:e}");
        // the middle part of the symmetric branch with the other asymmetric one: a closed loop
        assert_eq!(folds(&branches[1]).len(), 4, "{:?}", branches[1].stopped);
    }
}

/// The lower sheet of the cusp ends at its bound; the others are found at one value.
#[test]
fn a_sheet_that_begins_beyond_the_bound() {
    let branches = explore(&Cusp, &[-1.3], &[-1.0, 1.0], &within(-1.2, 0.3), &[0.0]);
    assert_eq!(branches.len(), 2);
    let search = DeflationSettings::default();
    let at = |x: f64| {
        let lies = |b: &Branch| lies_on(&Cusp, b, &[x], &[0.0, 1.0], &search).unwrap();
        branches.iter().map(lies).collect::<Vec<_>>()
    };
    assert_eq!(at(-1.0), [true, false]);
    assert_eq!(at(0.0), [false, true]);
    assert_eq!(at(1.0), [false, true]);
    assert_eq!(at(0.5), [false, false]);
}

/// Bratu's upper states from a branch that stops before the fold: two solutions at λ = 3.
#[test]
fn numbers_of_solutions_from_a_part_of_a_branch() {
    let problem = Bratu::new(99);
    let branches = explore(&problem, &[0.0; 99], &[0.0], &within(-0.1, 3.2), &[3.0]);
    assert_eq!(branches.len(), 2);
    let largest = |b: &Branch| b.points.iter().map(|q| q.observables[0]).fold(0.0, f64::max);
    assert!(largest(&branches[0]) < 1.0 && largest(&branches[1]) > 1.5);
}

#[test]
fn neighbours_at_a_fold_lie_on_one_branch() {
    let search = DeflationSettings::default();
    let settings = Settings { target: Some(2.0), ..Settings::default() };
    let branch = Tracer::new(&Cusp, "mu", &[-1.5], &[-2.0, 1.0], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    for below in [1e-3, 1e-6, 1e-9] {
        let mu = 0.384_900_179_459_750_5 - below;
        // both solutions beside x = −1/√3
        let x = |sign: f64| {
            let mut u = [-1.0 / 3f64.sqrt() + sign * (below / 3f64.sqrt()).sqrt()];
            let newton = continuation::NewtonSettings::default();
            continuation::newton(&Cusp, &mut u, &[mu, 1.0], &newton).unwrap();
            u
        };
        let pair = [x(-1.0), x(1.0)];
        assert!(pair[1][0] - pair[0][0] > below.sqrt());
        for u in pair {
            assert!(lies_on(&Cusp, &branch, &u, &[mu, 1.0], &search).unwrap(), "{below:e}");
        }
    }
    // not at another value of the other parameter
    assert!(!lies_on(&Cusp, &branch, &[1.0], &[0.0, 2.0], &search).unwrap());
}

#[test]
fn a_search_that_is_ended_returns_what_it_found() {
    let branches = explore(&Cusp, &[-1.3], &[-1.0, 1.0], &within(-1.2, 0.3), &[]);
    let search = DeflationSettings::default();
    let (mut calls, mut seen) = (0, 0);
    let found = disconnected_observed(&Cusp, &branches, &[], &[0.0, 0.1], &search, &mut |report| {
        (calls, seen) = (calls + 1, report.found);
        if seen == 1 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!((found.unwrap().len(), seen), (1, 1));
    assert!(calls > 0);
}

#[test]
fn what_is_wrong_is_an_error() {
    let search = DeflationSettings::default();
    let error = disconnected(&Cusp, &[], &[], &[0.0], &search).unwrap_err();
    assert_eq!(error, DeflationError::NoBranch);
    let settings = Settings { target: Some(1.0), ..Settings::default() };
    let branch = Tracer::new(&Cusp, "mu", &[-1.5], &[-2.0, 1.0], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    let error =
        disconnected(&Cusp, std::slice::from_ref(&branch), &[], &[f64::NAN], &search).unwrap_err();
    assert!(matches!(error, DeflationError::NotFinite { .. }));
    let error = disconnected(&Bratu::new(2), &[branch], &[], &[0.0], &search).unwrap_err();
    assert!(matches!(error, DeflationError::Foreign { .. }));
}
