//! Counting all unstable modes of a large problem without symmetry, where it is asked for.

#![allow(clippy::unwrap_used)]

use continuation::{BandProblem, Branch, Counting, EventKind, Settings, Tracer};
use std::ops::ControlFlow;

const N: usize = 610;
/// The pair `x' + i y' = (p − ½ + 300 i)(x + i y) − …` stands in the middle of decaying unknowns, more of
/// which are slower than an iteration for a few eigenvalues ever asks for.
const PAIR: usize = N / 2;
const FREQUENCY: f64 = 300.0;

fn residual(u: &[f64], p: &[f64], r: &mut [f64]) {
    for i in 0..N {
        // every other unknown drives the one before, so strongly that the symmetric part is indefinite
        let next = if i.is_multiple_of(2) && i + 1 < N { 40.0 * u[i + 1] } else { 0.0 };
        r[i] = (-1.0 - 0.05 * i as f64) * u[i] + next - u[i].powi(3);
    }
    let (x, y) = (u[PAIR], u[PAIR + 1]);
    let growth = p[0] - 0.5 - x * x - y * y;
    r[PAIR] = growth * x - FREQUENCY * y;
    r[PAIR + 1] = growth * y + FREQUENCY * x;
}

fn trace(counting: Counting) -> Branch {
    let problem = BandProblem::from_residual(N, (1, 1), &["p"], residual);
    let settings =
        Settings { target: Some(1.0), max_step: Some(0.1), counting, ..Settings::default() };
    Tracer::new(&problem, "p", &[0.0; N], &[0.0], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()))
}

#[test]
fn a_fast_pair_among_many_slow_modes_is_counted() {
    // the few eigenvalues nearest to zero do not show it, and do not say that they do
    let few = trace(Counting::Automatic);
    assert!(few.points.iter().all(|point| !point.certified));
    let counted = trace(Counting::Full);
    for point in counted.points.iter().filter(|point| (point.p - 0.5).abs() > 1e-6) {
        let right = if point.p > 0.5 { 2 } else { 0 };
        assert_eq!((point.unstable, point.certified), (Some(right), true), "{}", point.p);
    }
    assert!(counted.doubts.is_empty(), "{:?}", counted.doubts);
    let found: Vec<_> = counted.events_of(&EventKind::Hopf).map(|event| event.p).collect();
    assert!(found.len() == 1 && (found[0] - 0.5).abs() < 1e-8, "{found:?}");
}
