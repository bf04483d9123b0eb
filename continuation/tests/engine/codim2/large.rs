//! Hopf curves of problems too large for a full spectrum.

use crate::storages::{A, Brusselator, D, Entries, follow};
use continuation::codim2::HopfCurve;
use continuation::linalg::{Band, Dense, Sparse};
use continuation::{
    BandProblem, Counting, EventKind, Problem, Settings, SparseProblem, Stability, Tracer,
};
use std::ops::ControlFlow;

/// The first two Hopf points of the Brusselator on a line, as curves in its length.
fn hopf_curves<J: Entries>(cells: usize) {
    check(&Brusselator::<J>::new(cells), cells);
}

fn residual(cells: usize) -> impl Fn(&[f64], &[f64], &mut [f64]) {
    move |u, p, r| Brusselator::<Band>::new(cells).residual(u, p, r).unwrap()
}

fn check<P: Problem>(problem: &P, cells: usize) {
    let u: Vec<f64> = (0..cells).flat_map(|_| [A, 2.0]).collect();
    let branch = follow(problem, &u, 4.0, 6.0);
    let points: Vec<_> = branch.events_of(&EventKind::Hopf).collect();
    assert!(points.len() >= 2, "{:?}", branch.events);
    for (k, event) in points.iter().take(2).enumerate() {
        let kappa = Brusselator::<Band>::new(cells).kappa(k + 1);
        let curve = HopfCurve::at(problem, &branch, event, "L").unwrap();
        let settings = Settings { domain: Some((0.7, 1.6)), ..Settings::default() };
        let found = curve.trace(&settings, &[], &mut |_| ControlFlow::Continue(())).unwrap();
        let [b, omega] = ["B", "omega"].map(|name| found.column(name).unwrap());
        let ends = (found.branch.points[0].p, found.branch.points[b.len() - 1].p);
        assert_eq!(
            (ends.0.min(ends.1), ends.0.max(ends.1)),
            (0.7, 1.6),
            "{:?}",
            found.branch.stopped
        );
        println!("{cells} {k}: {} points, {:?}", b.len(), found.branch.statistics);
        for ((point, b), omega) in found.branch.points.iter().zip(&b).zip(&omega) {
            let [x, y] = D.map(|d| d * kappa / (point.p * point.p));
            assert!((b - (1.0 + A * A + x + y)).abs() < 1e-9, "{} {b}", point.p);
            let det = (b - 1.0 - x) * (-A * A - y) + b * A * A;
            assert!((omega * omega - det).abs() < 1e-8, "{} {omega}", point.p);
        }
    }
}

#[test]
fn hopf_curves_in_every_storage_beyond_full_spectra() {
    hopf_curves::<Dense>(30);
    hopf_curves::<Band>(30);
    hopf_curves::<Band>(50);
    hopf_curves::<Dense>(65);
    hopf_curves::<Band>(65);
    hopf_curves::<Sparse>(65);
    hopf_curves::<Band>(300);
    hopf_curves::<Sparse>(300);
}

#[test]
fn hopf_curves_from_residuals_alone() {
    for cells in [30, 100] {
        let band = BandProblem::from_residual(2 * cells, (2, 2), &["B", "L"], residual(cells));
        check(&band.with_stability(Stability::Dynamics).boxed(), cells);
        let pattern = Brusselator::<Band>::new(cells).pattern();
        let sparse =
            SparseProblem::from_residual(2 * cells, &pattern, &["B", "L"], residual(cells));
        check(&sparse.unwrap().with_stability(Stability::Dynamics).boxed(), cells);
    }
}

/// Brusselators side by side, of which one has the parameter `B`, the others less. On its Hopf curve
/// `B = 1 + A²` the frequency is `A`: it does not depend on `B`, so that the first of the curve's two rows
/// and the first of its columns alone are singular.
#[test]
fn a_frequency_that_does_not_depend_on_the_parameter() {
    for n in [60, 200, 400] {
        let own = move |i: usize, b: f64| if i == 0 { b } else { 0.1 + 0.8 * i as f64 / n as f64 };
        let f = move |u: &[f64], p: &[f64], r: &mut [f64]| {
            for i in 0..n / 2 {
                let (x, y, b) = (u[2 * i], u[2 * i + 1], own(i, p[0]));
                r[2 * i] = p[1] - (b + 1.0) * x + x * x * y;
                r[2 * i + 1] = b * x - x * x * y;
            }
        };
        let problem = BandProblem::from_residual(n, (1, 1), &["B", "A"], f);
        let problem = problem.with_stability(Stability::Dynamics).boxed();
        let u: Vec<f64> = (0..n / 2).flat_map(|i| [1.0, own(i, 1.0)]).collect();
        let settings =
            Settings { target: Some(3.0), counting: Counting::Full, ..Settings::default() };
        let branch = Tracer::new(&problem, "B", &u, &[1.0, 1.0], settings)
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(()));
        let hopf: Vec<_> = branch.events_of(&EventKind::Hopf).collect();
        assert!(hopf.len() == 1 && (hopf[0].p - 2.0).abs() < 1e-10, "{n}: {:?}", branch.events);
        let curve = HopfCurve::at(&problem, &branch, hopf[0], "A").unwrap();
        let settings = Settings { domain: Some((0.8, 1.2)), ..Settings::default() };
        let found = curve.trace(&settings, &[], &mut |_| ControlFlow::Continue(())).unwrap();
        let [b, omega] = ["B", "omega"].map(|name| found.column(name).unwrap());
        let places: Vec<f64> = found.branch.points.iter().map(|point| point.p).collect();
        let (low, high) = (places[0].min(places[b.len() - 1]), places[0].max(places[b.len() - 1]));
        assert_eq!((low, high), (0.8, 1.2), "{n}: {:?}", found.branch.stopped);
        for ((a, b), omega) in places.iter().zip(&b).zip(&omega) {
            assert!((b - 1.0 - a * a).abs() < 1e-9 && (omega - a).abs() < 1e-9, "{n}: {a} {b}");
        }
    }
}
