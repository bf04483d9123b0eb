//! Curves of Hopf points, and what lies on them.

use super::{account, co_branch, co_oxidation, follow, trace};
use continuation::codim2::{Curve, FoldCurve, HopfCurve};
use continuation::{DenseProblem, EventKind, Settings, StopReason, Tracer};
use std::ops::ControlFlow;

fn hopf_curve(curve: &HopfCurve<'_>, domain: (f64, f64), max_step: Option<f64>) -> Curve {
    let settings = Settings { domain: Some(domain), max_step, ..Settings::default() };
    curve.trace(&settings, &[], &mut |_| ControlFlow::Continue(())).unwrap()
}

/// In multiple precision, with derivatives written out: the zeros of `l₁`, and the double zeros.
const KNOWN: [(char, f64, f64); 4] = [
    ('h', 0.891_318_980_774_318_6, 0.232_487_354_203_036_6),
    ('h', 0.924_255_015_218_579_2, 0.305_879_267_477_928_9),
    ('t', 1.161_198_708_821_7, 0.722_339_072_522),
    ('t', 1.417_627_637_600_6, 0.971_397_573_485),
];

/// From one Bogdanov-Takens point to the other.
#[test]
fn the_hopf_curve_of_co_oxidation() {
    let problem = co_oxidation();
    let branch = co_branch(&problem);
    for event in branch.events_of(&EventKind::Hopf) {
        for max_step in [None, Some(0.01), Some(0.3)] {
            let curve = HopfCurve::at(&problem, &branch, event, "k").unwrap();
            let found = hopf_curve(&curve, (0.0, 2.0), max_step);
            println!(
                "{max_step:?} {} {:?} {:?}",
                account(&found, "p"),
                found.first_end,
                found.branch.stopped
            );
            let p = found.column("p").unwrap();
            let mut events = found.branch.events.clone();
            events.sort_by(|a, b| a.p.total_cmp(&b.p));
            assert_eq!(events.len(), 4, "{max_step:?}");
            for (event, (kind, at, k)) in events.iter().zip(&KNOWN) {
                let (kind, accuracy) = match kind {
                    'h' => (EventKind::GeneralisedHopf, 1e-7),
                    _ => (EventKind::BogdanovTakens, 1e-9),
                };
                let off = (p[event.point] - at).abs().max((event.p - k).abs());
                assert_eq!(event.kind, kind);
                assert!(off < accuracy, "{max_step:?} {kind} off by {off:e}");
                assert!(event.error_estimate < 1e-6, "{max_step:?} {event:?}");
            }
            for end in [&found.first_end, &found.branch.stopped] {
                assert_eq!(end.reason, StopReason::Target);
            }
        }
    }
}

/// `y = T x` hides that the equations of `x` are decoupled.
fn mixed(
    f: impl Fn(&[f64], &[f64], &mut [f64]) + Copy,
    n: usize,
) -> impl Fn(&[f64], &[f64], &mut [f64]) {
    move |y, p, r| {
        // x_i = y_i + (y_0 + … + y_{i−1}) / 2 − 0.3; the inverse of the lower triangle on the result
        let mut x = vec![0.0; n];
        let mut sum = 0.0;
        for i in 0..n {
            x[i] = y[i] + 0.5 * sum - 0.3;
            sum += y[i];
        }
        let mut g = vec![0.0; n];
        f(&x, p, &mut g);
        sum = 0.0;
        for i in 0..n {
            r[i] = g[i] - 0.5 * sum;
            sum += r[i];
        }
    }
}

fn fold_and_pair(x: &[f64], p: &[f64], r: &mut [f64]) {
    let (fold, q) = (p[0] - p[1] * p[1], p[1]);
    r[0] = fold - x[0] * x[0];
    let growth = q - 0.3 + x[0] - x[1] * x[1] - x[2] * x[2];
    r[1] = growth * x[1] - 1.7 * x[2];
    r[2] = growth * x[2] + 1.7 * x[1];
}

/// A fold at `p = q²`, where a pair has the real part `q − 0.3`; Hopf points at `p = q² + (0.3 −
/// q)²`, where the eigenvalue `−2x` vanishes at `q = 0.3` too.
#[test]
fn zero_hopf_points_on_a_fold_curve_and_on_a_hopf_curve() {
    let problem = DenseProblem::from_residual(3, &["p", "q"], mixed(fold_and_pair, 3)).boxed();
    let start = [1.3, -0.35, -0.175];
    let branch = trace(&problem, "p", &start, &[1.0, 0.0], -1.0);
    println!("{:?}", branch.events.iter().map(|e| (e.kind.to_string(), e.p)).collect::<Vec<_>>());
    let fold = branch.events_of(&EventKind::Fold).next();
    let settings =
        Settings { domain: Some((-0.5, 1.5)), increasing: Some(false), ..Settings::default() };
    let branch = match fold {
        Some(_) => branch,
        None => Tracer::new(&problem, "p", &start, &[1.0, 0.0], settings)
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(())),
    };
    let fold = branch.events_of(&EventKind::Fold).next().unwrap();
    for max_step in [None, Some(0.01), Some(1.0)] {
        let curve = FoldCurve::at(&problem, &branch, fold, "q").unwrap();
        let found = follow(&curve, (-1.0, 1.0), max_step, &[]);
        println!("{max_step:?} {}", account(&found, "p"));
        let p = found.column("p").unwrap();
        let [event] = &found.branch.events[..] else { panic!("{:?}", found.branch.events) };
        assert_eq!(event.kind, EventKind::ZeroHopf);
        assert!((p[event.point] - 0.09).abs() < 1e-9 && (event.p - 0.3).abs() < 1e-9);
    }
    let hopf = branch.events_of(&EventKind::Hopf).next().unwrap();
    for max_step in [None, Some(0.01), Some(1.0)] {
        let curve = HopfCurve::at(&problem, &branch, hopf, "q").unwrap();
        let found = hopf_curve(&curve, (-1.0, 1.0), max_step);
        println!("{max_step:?} {}", account(&found, "p"));
        let p = found.column("p").unwrap();
        let [event] = &found.branch.events[..] else { panic!("{:?}", found.branch.events) };
        assert_eq!(event.kind, EventKind::ZeroHopf);
        assert!((p[event.point] - 0.09).abs() < 1e-9 && (event.p - 0.3).abs() < 1e-9);
    }
}

fn two_pairs(x: &[f64], p: &[f64], r: &mut [f64]) {
    let (a, b) = (x[0] * x[0] + x[1] * x[1], x[2] * x[2] + x[3] * x[3]);
    let first = p[0] - p[1] * p[1] + (p[1] - 0.25) * a - a * a;
    let second = p[0] + p[1] - 0.2 - b;
    r[0] = first * x[0] - x[1];
    r[1] = first * x[1] + x[0];
    r[2] = second * x[2] - 2.3 * x[3];
    r[3] = second * x[3] + 2.3 * x[2];
}

/// Hopf points at `p = q²`, with `l₁` proportional to `q − 0.25`, and at `p = 0.2 − q`.
#[test]
fn generalised_and_double_hopf_points() {
    let problem = DenseProblem::from_residual(4, &["p", "q"], mixed(two_pairs, 4)).boxed();
    let branch = trace(&problem, "p", &[0.3, 0.15, 0.075, 0.0375], &[-1.0, 0.0], 0.1);
    let hopf = branch.events_of(&EventKind::Hopf).next().unwrap();
    let double = 0.5 * (1.8_f64.sqrt() - 1.0);
    for max_step in [None, Some(0.01), Some(1.0)] {
        let curve = HopfCurve::at(&problem, &branch, hopf, "q").unwrap();
        let found = hopf_curve(&curve, (-0.5, 0.5), max_step);
        println!("{max_step:?} {}", account(&found, "p"));
        let p = found.column("p").unwrap();
        let kinds: Vec<String> = found.branch.events.iter().map(|e| e.kind.to_string()).collect();
        assert_eq!(kinds, ["double-hopf", "generalised-hopf"]);
        for (event, q) in found.branch.events.iter().zip([double, 0.25]) {
            assert!((event.p - q).abs() < 1e-8 && (p[event.point] - q * q).abs() < 1e-8);
        }
    }
}
