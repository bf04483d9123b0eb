//! Steps of large sparse problems go on with factors of a state near by: what is read from these holds for
//! the state itself, however near to a special point it comes.

#![allow(clippy::unwrap_used)]

use crate::random::Random;
use continuation::{Branch, EventKind, Settings, SparseProblem, StopReason, Tracer};

const N: usize = 2100;

/// A trunk `s + 0.3 s³ = p` that drags the others along, `z_j = s² j/N`, and modes
/// `(s − c_k + 50 (z − s²)) y_k = y_k³` with the last `z`, so that a state beside the branch has quite other
/// eigenvalues.
fn trace(c: &[f64], max_step: f64) -> Branch {
    let modes = c.len();
    let (first, last) = (modes + 1, N - 1);
    let mut pattern = vec![(0, 0)];
    for k in 1..=modes {
        pattern.extend([(k, k), (k, 0), (k, last)]);
    }
    pattern.extend((first..N).flat_map(|j| [(j, j), (j, 0)]));
    let c = c.to_vec();
    let problem = SparseProblem::from_residual(N, &pattern, &["p"], move |u, p, r| {
        let s = u[0];
        r[0] = p[0] - s - 0.3 * s.powi(3);
        for (k, c) in c.iter().enumerate() {
            let y = u[k + 1];
            r[k + 1] = (s - c + 50.0 * (u[last] - s * s)) * y - y.powi(3);
        }
        for j in first..N {
            r[j] = s * s * j as f64 / last as f64 - u[j];
        }
    })
    .unwrap();
    let settings = Settings { target: Some(1.3), max_step: Some(max_step), ..Settings::default() };
    let p = -1.3;
    let start = vec![0.0; N];
    Tracer::new(&problem, "p", &start, &[p], settings).unwrap().run_quietly()
}

/// On the trunk mode `k` is critical at `s = c_k`.
#[test]
fn branch_points_beside_the_ends_of_steps_are_found_once() {
    let mut random = Random(11);
    for case in 0..8 {
        let mut c: Vec<f64> =
            (0..3).map(|k| -0.75 + 0.6 * f64::from(k) + random.between(0.0, 0.3)).collect();
        let max_step = random.between(1.0, 4.0);
        // one is put where a step ends: after, at, and just before it
        let points = trace(&c, max_step).points;
        let end = points[points.len() / 2].u[0];
        let nearest = (0..3).min_by(|a, b| (c[*a] - end).abs().total_cmp(&(c[*b] - end).abs()));
        let exponent = random.between(-7.0, -3.0);
        c[nearest.unwrap()] = end + [1.0, -1.0][case % 2] * 10_f64.powf(exponent);
        let branch = trace(&c, max_step);
        let what = format!("{case}: {c:?}, {max_step}");
        assert_eq!(branch.stopped.reason, StopReason::Target, "{what}: {:?}", branch.stopped);
        let found: Vec<f64> = branch.events_of(&EventKind::BranchPoint).map(|e| e.p).collect();
        let mut exact: Vec<f64> = c.iter().map(|s| s + 0.3 * s.powi(3)).collect();
        exact.sort_by(f64::total_cmp);
        assert_eq!(found.len(), exact.len(), "{what}: {found:?}");
        for (found, exact) in found.iter().zip(&exact) {
            assert!((found - exact).abs() < 1e-9, "{what}: {found} {exact}");
        }
        for point in branch.points.iter().filter(|point| point.event.is_none()) {
            let s = point.u[0];
            if c.iter().all(|c| (c - s).abs() > 1e-9) {
                let unstable = c.iter().filter(|c| **c < s).count();
                // where it is not certain it is a lower bound
                let said = point.unstable.unwrap();
                let right = said == unstable || (said < unstable && !point.certified);
                assert!(right, "{what}: {said} at s = {s}, {}", point.certified);
            }
        }
    }
}
