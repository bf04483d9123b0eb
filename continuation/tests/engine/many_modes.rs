//! Tens of oscillating modes that become unstable one after the other or together, of which a few are seen at
//! a time: no Hopf point is invented where the nearest pair changes, and what cannot be told apart is said.

#![allow(clippy::unwrap_used)]

use crate::random::Random;
use continuation::{BandProblem, Branch, EventKind, Settings, StopReason, Tracer};

/// `z_k' = (p − c_k + i ω_k − |z_k|²) z_k + coupling (z_{k−1} − 2 z_k + z_{k+1})`, no flux at the ends.
fn trace(critical: Vec<f64>, frequency: Vec<f64>, coupling: f64) -> Branch {
    let blocks = critical.len();
    let problem = BandProblem::from_residual(2 * blocks, (3, 3), &["p"], move |u, p, r| {
        for k in 0..blocks {
            let (x, y) = (u[2 * k], u[2 * k + 1]);
            let growth = p[0] - critical[k] - x * x - y * y;
            let around = |c: usize| {
                let at = |j: usize| u[2 * j + c];
                coupling * (at(k.saturating_sub(1)) + at((k + 1).min(blocks - 1)) - 2.0 * at(k))
            };
            r[2 * k] = growth * x - frequency[k] * y + around(0);
            r[2 * k + 1] = frequency[k] * x + growth * y + around(1);
        }
    });
    let settings = Settings { target: Some(1.0), ..Settings::default() };
    let start = vec![0.0; 2 * blocks];
    Tracer::new(&problem, "p", &start, &[-1.0], settings).unwrap().run_quietly()
}

/// Every Hopf point is one of the exact ones, within its error, and none is there twice.
fn check(branch: &Branch, exact: &[f64], what: &str) {
    assert_eq!(branch.stopped.reason, StopReason::Target, "{what}: {:?}", branch.stopped);
    let mut last = f64::NEG_INFINITY;
    for event in &branch.events {
        assert_eq!(event.kind, EventKind::Hopf, "{what}: {}", event.p);
        let off = exact.iter().map(|c| (c - event.p).abs()).fold(f64::INFINITY, f64::min);
        let allowed = event.error_estimate.max(1e-11);
        assert!(off <= allowed, "{what}: {} is {off:e} from any, ± {allowed:e}", event.p);
        assert!(event.p > last + 1e-9, "{what}: {} twice", event.p);
        last = event.p;
    }
    let missed = exact.iter().filter(|c| **c < 1.0).count() - branch.events.len();
    let certain = branch.points.iter().all(|point| point.certified);
    assert!(missed == 0 || !certain, "{what}: {missed} missed, and every count is called certain");
}

#[test]
fn the_nearest_pair_that_changes_is_no_hopf_point() {
    let mut random = Random(7);
    for case in 0..2 {
        let blocks = 66 + random.between(0.0, 30.0) as usize;
        let coupling = random.between(2.0, 20.0);
        let branch = trace(vec![0.0; blocks], vec![1.0; blocks], coupling);
        let wave = |k: usize| std::f64::consts::PI * k as f64 / blocks as f64;
        let exact: Vec<f64> = (0..blocks).map(|k| coupling * (2.0 - 2.0 * wave(k).cos())).collect();
        check(&branch, &exact, &format!("chain {case}"));
        assert!(branch.events.len() >= 3, "chain {case}: {}", branch.events.len());
    }
    for case in 0..2 {
        let blocks = 66 + random.between(0.0, 10.0) as usize;
        let (first, last) = (random.between(-0.1, 0.4), random.between(0.5, 0.9));
        let c: Vec<f64> = (0..blocks)
            .map(|k| {
                let part = (k as f64 + random.between(0.0, 0.5)) / blocks as f64;
                first + (last - first) * part
            })
            .collect();
        let frequency = (0..blocks).map(|_| random.between(0.5, 2.0)).collect();
        let branch = trace(c.clone(), frequency, 0.0);
        check(&branch, &c, &format!("layers {case}"));
    }
}

/// The work grows with a power of the number of modes; it is bounded, and the end says why.
#[test]
fn modes_that_become_critical_together_are_counted_not_sought() {
    for blocks in [10, 20, 65, 100] {
        let branch = trace(vec![0.0; blocks], vec![1.0; blocks], 0.0);
        assert!(branch.events.is_empty(), "{blocks}: {:?}", branch.events);
        assert_eq!(branch.stopped.reason, StopReason::StepTooSmall, "{blocks}");
        let modes = format!("{} modes become critical", 2 * blocks);
        assert!(branch.stopped.detail.contains(&modes), "{blocks}: {}", branch.stopped.detail);
        assert!(branch.statistics.newton_iterations < 2000, "{blocks}: {:?}", branch.statistics);
    }
}
