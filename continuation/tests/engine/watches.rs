//! Watched functions with poles, jumps and corners: no zero is reported that is none.

#![allow(clippy::unwrap_used)]

use continuation::{Branch, DenseProblem, EventKind, Settings, StopReason, Tracer, Watch};
use std::ops::ControlFlow;

/// `u = p` from −1 to 1, on which `g` is observed.
fn line(g: impl Fn(f64) -> f64 + Send + Sync + 'static, watches: &[Watch]) -> Branch {
    let problem = DenseProblem::from_residual(1, &["p"], |u, p, r| r[0] = u[0] - p[0])
        .boxed()
        .observing("g", move |u, _| g(u[0]));
    let settings = Settings { target: Some(1.0), ..Settings::default() };
    Tracer::new(&problem, "p", &[-1.0], &[-1.0], settings)
        .unwrap()
        .watching(watches)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()))
}

fn zeros(branch: &Branch) -> Vec<f64> {
    assert_eq!((branch.stopped.reason, branch.points.last().unwrap().p), (StopReason::Target, 1.0));
    branch.events_of(&EventKind::Zero("g".to_owned())).map(|e| e.p).collect()
}

/// Numbers in (0, 1).
struct Lcg(u64);

impl Lcg {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[test]
fn poles_and_jumps_are_no_zeros() {
    let mut random = Lcg(7);
    for _ in 0..20 {
        let c = 1.6 * random.next() - 0.8;
        let size = 10_f64.powf(6.0 * random.next() - 3.0);
        let z = if c > 0.0 { c - 0.7 } else { c + 0.7 };
        let watches = [Watch::zero("g")];
        type G = Box<dyn Fn(f64) -> f64 + Send + Sync>;
        let none: [G; 5] = [
            Box::new(move |u| size / (u - c)),
            Box::new(move |u| size / (u - c).powi(3)),
            Box::new(move |u| size * (u - c).signum()),
            Box::new(move |u| size * (4.0 * (u - c)).sin().atan2((4.0 * (u - c)).cos() - 1e-3)),
            Box::new(move |u| size * ((u - c).signum() + 0.1 * u)),
        ];
        for (k, g) in none.into_iter().enumerate() {
            // a phase also passes zero, unless it wraps there
            let wraps = k == 3;
            let found = zeros(&line(g, &watches));
            assert!(wraps || found.is_empty(), "{k}, {c}, {size}: {found:?}");
            assert!(!found.iter().any(|p| (p - c).abs() < 1e-6 && !wraps), "{k}, {c}: {found:?}");
        }
        // a zero besides is found
        let some: [G; 4] = [
            Box::new(move |u| size * (u - z) / (u - c)),
            Box::new(move |u| size * (u - z) * (u - c).signum()),
            Box::new(move |u| size * (u - z).cbrt() + 1e-3 * size / (u - c).powi(2) * (u - z)),
            Box::new(move |u| size * ((u - z) * 1e6).tanh()),
        ];
        for (k, g) in some.into_iter().enumerate() {
            let found = zeros(&line(g, &watches));
            assert!(found.len() == 1 && (found[0] - z).abs() < 1e-11, "{k}, {c}, {z}: {found:?}");
        }
    }
}

#[test]
fn a_phase_that_wraps_passes_zero_once() {
    for c in [-0.4, 0.1, 0.333] {
        let found = zeros(&line(
            move |u| (6.0 * (u - c)).sin().atan2((6.0 * (u - c)).cos()),
            &[Watch::zero("g")],
        ));
        let real: Vec<f64> = (-3..=3)
            .map(|k| c + f64::from(k) * std::f64::consts::TAU / 6.0)
            .filter(|p| p.abs() < 1.0)
            .collect();
        assert_eq!(found.len(), real.len(), "{found:?}");
        assert!(found.iter().zip(&real).all(|(a, b)| (a - b).abs() < 1e-11));
    }
}

#[test]
fn a_value_that_is_jumped_over_does_not_stop_the_trace() {
    for level in [-1e12, -10.0, 0.0, 3.0] {
        let branch = line(|u| 1.0 / (u - 0.3), &[Watch::stop_at("g", level)]);
        let end = branch.points.last().unwrap();
        // next to the pole, nearer than any step comes, a value may be passed unseen
        if level == 0.0 || (level < -1e6 && end.p == 1.0) {
            assert_eq!(end.p, 1.0);
        } else {
            assert!((end.p - 0.3 - 1.0 / level).abs() < 1e-11, "{level}: {}", end.p);
            assert!((end.observables[0] / level - 1.0).abs() < 1e-3);
        }
    }
    let branch = line(|u| (u - 0.3).signum(), &[Watch::stop_at("g", 0.5)]);
    assert_eq!(branch.points.last().unwrap().p, 1.0);
}

#[test]
fn corners_are_extrema_but_poles_and_jumps_are_not() {
    let mut random = Lcg(11);
    for _ in 0..20 {
        let c = 1.6 * random.next() - 0.8;
        let slope = 10_f64.powf(2.0 * random.next() - 1.0);
        let watches = [Watch::extremum("g")];
        let count = |branch: &Branch| {
            let kinds = [EventKind::Minimum("g".to_owned()), EventKind::Maximum("g".to_owned())];
            kinds.map(|kind| branch.events_of(&kind).map(|e| e.p).collect::<Vec<f64>>())
        };
        for power in [1.0, 0.5, 2.0] {
            let corner =
                move |u: f64| if u < c { (c - u).powf(power) } else { slope * (u - c).powf(power) };
            let [low, high] = count(&line(corner, &watches));
            assert!(low.len() == 1 && high.is_empty(), "{power} {c}: {low:?} {high:?}");
            assert!((low[0] - c).abs() < 2e-6, "{power} {c}: {low:?}");
        }
        let [low, high] = count(&line(move |u| 1.0 / (u - c).powi(2), &watches));
        assert!(low.is_empty() && high.is_empty(), "{c}: {low:?} {high:?}");
        let [low, high] = count(&line(move |u| slope * u + (u - c).signum(), &watches));
        assert!(low.is_empty() && high.is_empty(), "{c}: {low:?} {high:?}");
    }
}
