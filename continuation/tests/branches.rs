//! Special points of problems with known answers.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use continuation::samples::{Bratu, Cusp};
use continuation::{Branch, EventKind, Problem, Settings, StopReason, Tracer, Watch};
use std::ops::ControlFlow;

fn trace<P: Problem>(
    problem: &P,
    parameter: &str,
    u: &[f64],
    p: &[f64],
    settings: Settings,
    watches: &[Watch],
) -> Branch {
    Tracer::new(problem, parameter, u, p, settings)
        .and_then(|t| t.watching(watches))
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()))
}

#[test]
fn cusp_has_its_two_folds_at_every_step_length() {
    let exact = 2.0 / (3.0 * 3f64.sqrt());
    for max_step in [None, Some(1e-3), Some(1e-2), Some(0.1), Some(1.0), Some(10.0)] {
        let settings =
            Settings { target: Some(2.0), max_step, max_points: 20_000, ..Settings::default() };
        let branch = trace(&Cusp, "mu", &[-1.5], &[-2.0, 1.0], settings, &[Watch::zero("x")]);
        assert_eq!(branch.stopped.reason, StopReason::Target, "{max_step:?} {:?}", branch.stopped);
        let folds: Vec<_> = branch.events_of(&EventKind::Fold).collect();
        assert_eq!(folds.len(), 2, "{max_step:?}");
        for (fold, p) in folds.iter().zip([exact, -exact]) {
            assert!((fold.p - p).abs() < 1e-12, "{max_step:?}: {}", fold.p - p);
            let x = branch.points[fold.point].u[0];
            assert!((x + p.signum() / 3f64.sqrt()).abs() < 1e-10, "{max_step:?}: x = {x}");
            assert!(fold.error_estimate < 1e-9);
        }
        let counts: Vec<_> = folds.iter().map(|f| (f.unstable_before, f.unstable_after)).collect();
        assert_eq!(counts, [(Some(0), Some(1)), (Some(1), Some(0))]);
        let zeros: Vec<_> =
            branch.events_of(&EventKind::Zero("x".to_owned())).map(|e| e.p).collect();
        assert_eq!(zeros.len(), 1);
        assert!(zeros[0].abs() < 1e-11);
        assert_eq!(branch.points.last().unwrap().p, 2.0);
        println!("{max_step:?}: {} points, {:?}", branch.points.len(), branch.statistics);
    }
}

#[test]
fn bratu_turns_at_the_known_fold() {
    for (n, fold, tolerance) in [(99, 3.513_647_903_969, 1e-12), (800, 3.513_827_869_849_8, 1e-12)]
    {
        let settings = Settings { increasing: Some(true), ..Settings::default() };
        let watch = [Watch::stop_at("max_u", 8.0)];
        let problem = Bratu::new(n);
        let branch = trace(&problem, "lambda", &vec![0.0; n], &[0.0], settings, &watch);
        assert_eq!(branch.stopped.reason, StopReason::Target, "{:?}", branch.stopped);
        let folds: Vec<_> = branch.events_of(&EventKind::Fold).collect();
        assert_eq!(folds.len(), 1);
        assert!((folds[0].p / fold - 1.0).abs() < tolerance, "{:e}", folds[0].p - fold);
        assert_eq!((folds[0].unstable_before, folds[0].unstable_after), (Some(0), Some(1)));
        let last = branch.points.last().unwrap();
        assert!((last.observables[0] - 8.0).abs() < 1e-9);
        println!("{n}: {} points, {:?}", branch.points.len(), branch.statistics);
    }
}
