//! The units of `f`, `u`, `p` and `q` do not matter.

use super::bands::{Ignition, ignition_branch};
use super::scaled::Scaled;
use super::{co_branch, co_oxidation};
use continuation::codim2::{Curve, FoldCurve, HopfCurve};
use continuation::{Branch, EventKind, Settings, Tracer, Watch};
use std::ops::ControlFlow;

/// Factors of `f`, `u` and both parameters.
const SCALES: [(f64, f64, [f64; 2]); 10] = [
    (1.0, 1.0, [1.0, 1.0]),
    (1e6, 1.0, [1.0, 1.0]),
    (1e-6, 1.0, [1.0, 1.0]),
    (1.0, 1e6, [1.0, 1.0]),
    (1.0, 1e-6, [1.0, 1.0]),
    (1.0, 1.0, [1e6, 1.0]),
    (1.0, 1.0, [1e-6, 1.0]),
    (1.0, 1.0, [1.0, 1e6]),
    (1.0, 1.0, [1.0, 1e-6]),
    (1e6, 1e-6, [1e-6, 1e6]),
];

/// Kinds and places, in the original units, and the number of steps.
type Account = (Vec<(String, f64, f64)>, usize);

fn account(curve: &Curve, first: &str, c: [f64; 2]) -> Account {
    let column = curve.column(first).unwrap();
    let events = curve.branch.events.iter();
    let all = events.map(|e| (e.kind.to_string(), column[e.point] / c[0], e.p / c[1]));
    (all.collect(), curve.branch.statistics.accepted)
}

fn same(accounts: &[Account]) {
    let (known, steps) = &accounts[0];
    println!("{known:?} in {steps} steps");
    assert!(!known.is_empty());
    for ((found, these), scales) in accounts.iter().zip(SCALES).skip(1) {
        assert_eq!(found.len(), known.len(), "{scales:?} {found:?}");
        for (found, known) in found.iter().zip(known) {
            assert_eq!(found.0, known.0, "{scales:?}");
            let off = (found.1 - known.1).abs().max((found.2 - known.2).abs());
            assert!(
                off < if found.0 == "generalised-hopf" { 1e-7 } else { 1e-8 },
                "{scales:?} {found:?} {known:?}"
            );
        }
        assert!(these.abs_diff(*steps) as f64 <= 0.1 * *steps as f64, "{scales:?} {these} {steps}");
    }
}

fn rescaled(branch: Branch, b: f64, c: [f64; 2]) -> Branch {
    let mut branch = branch;
    branch.parameters.iter_mut().zip(c).for_each(|(p, c)| *p *= c);
    for point in &mut branch.points {
        point.u.iter_mut().for_each(|u| *u *= b);
        point.p *= c[0];
    }
    branch
}

#[test]
fn fold_curves_of_a_dense_problem_and_of_a_band() {
    let settings = |c: f64, low: f64, high: f64| Settings {
        domain: Some((low * c, high * c)),
        ..Settings::default()
    };
    let dense = SCALES.map(|scales| {
        let branch = rescaled(co_branch(&co_oxidation()), scales.1, scales.2);
        let problem = Scaled::new(co_oxidation(), scales.0, scales.1, &scales.2);
        let fold = branch.events_of(&EventKind::Fold).next().unwrap();
        let curve = FoldCurve::at(&problem, &branch, fold, "k").unwrap();
        let found = curve
            .trace(&settings(scales.2[1], 0.2, 2.0), &[], &mut |_| ControlFlow::Continue(()))
            .unwrap();
        account(&found, "p", scales.2)
    });
    same(&dense);
    let band = SCALES.map(|scales| {
        let branch = rescaled(ignition_branch(&Ignition { n: 99 }), scales.1, scales.2);
        let problem = Scaled::new(Ignition { n: 99 }, scales.0, scales.1, &scales.2);
        let fold = branch.events_of(&EventKind::Fold).next().unwrap();
        let curve = FoldCurve::at(&problem, &branch, fold, "epsilon").unwrap();
        let watches = [Watch::stop_at("lambda", 9.0 * scales.2[0])];
        let found = curve
            .trace(&settings(scales.2[1], 0.1, 0.4), &watches, &mut |_| ControlFlow::Continue(()))
            .unwrap();
        account(&found, "lambda", scales.2)
    });
    same(&band);
}

#[test]
fn hopf_curves() {
    let hopf = SCALES.map(|scales| {
        let mut branch = co_branch(&co_oxidation());
        // the frequency is in units of f/u
        for event in &mut branch.events {
            if let continuation::Detail::Hopf(form) = &mut event.detail {
                form.frequency *= scales.0 / scales.1;
            }
        }
        let branch = rescaled(branch, scales.1, scales.2);
        let problem = Scaled::new(co_oxidation(), scales.0, scales.1, &scales.2);
        let event = branch.events_of(&EventKind::Hopf).next().unwrap();
        let curve = HopfCurve::at(&problem, &branch, event, "k").unwrap();
        let settings = Settings { domain: Some((0.0, 2.0 * scales.2[1])), ..Settings::default() };
        let found = curve.trace(&settings, &[], &mut |_| ControlFlow::Continue(())).unwrap();
        println!("{scales:?} {}", super::account(&found, "p"));
        account(&found, "p", scales.2)
    });
    same(&hopf);
}

/// Settings that a trace in the original units would use do not matter either.
#[test]
fn the_tracer_alone_finds_the_same() {
    let problem = co_oxidation();
    let branch = co_branch(&problem);
    let fold = branch.events_of(&EventKind::Fold).next().unwrap();
    let curve = FoldCurve::at(&problem, &branch, fold, "k").unwrap();
    let settings = Settings { target: Some(0.2), max_points: 400, ..Settings::default() };
    let (u, p) = (curve.start().to_vec(), curve.start_parameters());
    let alone = Tracer::new(&curve, "k", &u, &p, settings)
        .unwrap()
        .watching(&[Watch::zero("cusp")])
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    let kinds: Vec<_> = alone.events.iter().map(|e| e.kind.clone()).collect();
    assert_eq!(kinds, [EventKind::Cusp]);
}
