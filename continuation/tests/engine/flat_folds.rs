//! Folds of any even order: found where the branch turns, with an error that contains the truth and
//! an order that is said.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests")]

use continuation::{Branch, DenseProblem, Detail, EventKind, Problem, Settings, Tracer};
use std::ops::ControlFlow;

use crate::random;
use random::Random;

fn trace<P: Problem>(problem: &P, u: &[f64], p: f64, max_step: f64) -> Branch {
    let settings =
        Settings { domain: Some((-2.5, 1.5)), max_step: Some(max_step), ..Settings::default() };
    let tracer = Tracer::new(problem, "p", u, &[p], settings).unwrap();
    tracer.run(&mut |_| ControlFlow::Continue(()))
}

/// `p = −c xᵏ (1 + a x + b x²)`, `x` the distance along a direction from some place, beside two
/// unknowns that follow, from `x = −0.8`: one fold if `k` is even, none if it is odd.
fn flat(order: i32, random: &mut Random, step: f64) -> (f64, Branch) {
    let unit = 10f64.powf(random.between(-3.0, 3.0));
    let c = random.between(0.5, 2.0);
    let (a, b) = (random.between(-0.3, 0.3), random.between(0.1, 0.5));
    let place = random.between(-1.0, 1.0);
    let (cos, sin) = { random.between(0.0, 6.0) }.sin_cos();
    let (k, l) = (random.between(-1.0, 1.0), random.between(-1.0, 1.0));
    let p = move |x: f64| -c * x.powi(order) * (1.0 + a * x + b * x * x);
    let problem = DenseProblem::from_residual(3, &["p"], move |u, q, r| {
        let v = [u[0] / unit, u[1] / unit, u[2] / unit];
        let (s, t) = (cos * v[0] + sin * v[1], cos * v[1] - sin * v[0]);
        let f = q[0] - p(s - place);
        let g = k * s + 0.3 * s * s - t;
        (r[0], r[1]) = (cos * f - sin * g, sin * f + cos * g);
        r[2] = l * q[0] + s.sin() - v[2];
    })
    .boxed();
    let s = place - 0.8;
    let t = k * s + 0.3 * s * s;
    let start =
        [(cos * s - sin * t) * unit, (sin * s + cos * t) * unit, (l * p(-0.8) + s.sin()) * unit];
    let branch = trace(&problem, &start, p(-0.8), step * unit.max(1.0));
    let state = |s: f64| {
        let t = k * s + 0.3 * s * s;
        [(cos * s - sin * t) * unit, (sin * s + cos * t) * unit, s.sin() * unit]
    };
    let fold = state(place);
    let off = branch.events_of(&EventKind::Fold).map(|event| {
        let u = &branch.points[event.point].u;
        (0..3).map(|i| (u[i] - fold[i]).powi(2)).sum::<f64>().sqrt()
    });
    (off.fold(0.0, f64::max), branch)
}

#[test]
fn folds_of_even_order_are_found_where_the_branch_turns() {
    let mut random = Random(7);
    let mut worst = 0.0_f64;
    for case in 0..200 {
        let order = 2 + 2 * (case % 5);
        let step = 0.1 * 10f64.powf(random.between(-1.0, 1.0));
        let (off, branch) = flat(order, &mut random, step);
        let case = format!("{case}: order {order}, step {step:.3}");
        let [event] = &branch.events[..] else {
            panic!("{case}: {:?} {:?} {:?}", branch.events, branch.stopped, branch.doubts);
        };
        let Detail::Fold(form) = &event.detail else { panic!("{case}: {event:?}") };
        assert_eq!(form.order, Some(order as usize), "{case}: {form:?} {off}");
        assert_eq!((event.unstable_before, event.unstable_after), (Some(0), Some(1)), "{case}");
        assert!(off <= event.error_estimate, "{case}: {off:.1e} {:.1e}", event.error_estimate);
        worst = worst.max(event.error_estimate);
        assert!(branch.is_complete(), "{case}: {:?} {:?}", branch.stopped, branch.doubts);
    }
    println!("largest estimate {worst:.1e}");
}

#[test]
fn no_fold_where_the_branch_stands_still_and_goes_on() {
    let mut random = Random(11);
    for case in 0..100 {
        let order = 3 + 2 * (case % 4);
        let step = 0.1 * 10f64.powf(random.between(-1.0, 1.0));
        let (_, branch) = flat(order, &mut random, step);
        assert!(
            branch.events.is_empty(),
            "{case}: order {order}, step {step}: {:?}",
            branch.events
        );
        assert!(branch.is_complete(), "{case}: {:?} {:?}", branch.stopped, branch.doubts);
    }
}

/// `p = −∫ x exp(−w²/x²)`: flatter than any power at the fold. No order can be said, and the error still
/// contains it.
#[test]
fn a_fold_of_no_order_is_bracketed() {
    let (mut bracketed, mut doubted) = (0, 0);
    for place in [0.0, 0.1, 0.2345, -0.3] {
        for (step, w) in [(0.03, 0.02), (0.1, 0.2), (0.3, 0.05), (0.2, 0.03), (0.1, 1.0)] {
            // by Simpson's rule
            let p = move |x: f64| {
                let n = 200;
                let h = x / f64::from(n);
                let slope = |x: f64| if x == 0.0 { 0.0 } else { x * (-(w / x).powi(2)).exp() };
                let weight = |k: i32| if k % 2 == 1 { 4.0 } else { 2.0 };
                let inner: f64 = (1..n).map(|k| weight(k) * slope(h * f64::from(k))).sum();
                -(slope(x) + inner) * h / 3.0
            };
            let problem = DenseProblem::from_residual(1, &["p"], move |u, q, r| {
                r[0] = q[0] - p(u[0] - place);
            })
            .boxed();
            let branch = trace(&problem, &[place - 1.0], p(-1.0), step);
            let case = format!("{place}, {step}, {w}: {:?}", branch.events);
            let [event] = &branch.events[..] else {
                assert!(branch.events.is_empty() && !branch.is_certain(), "{case}");
                doubted += 1;
                continue;
            };
            let off = (branch.points[event.point].u[0] - place).abs();
            assert!(off <= event.error_estimate, "{case}: {off:.1e}");
            let Detail::Fold(form) = &event.detail else { panic!("{case}") };
            assert_eq!(form.order, None, "{case}");
            bracketed += 1;
        }
    }
    println!("{bracketed} bracketed, {doubted} doubted");
    assert!(bracketed > 4);
}
