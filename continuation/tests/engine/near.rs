//! Near-bifurcations: imperfect branch points and folds in pairs, and nothing else.

#![allow(clippy::unwrap_used)]

use crate::scaled;

use continuation::samples::{Bratu, Cusp};
use continuation::{
    Branch, DenseProblem, EventKind, NearBifurcation, NearError, NearKind, NearSettings, Problem,
    Settings, Tracer, Watch, near_bifurcations,
};
use scaled::{SCALES, Scaled};
use std::ops::ControlFlow;

fn trace<P: Problem>(problem: &P, u: &[f64], p: &[f64], settings: Settings) -> Branch {
    let name = &problem.parameters()[0].name;
    Tracer::new(problem, name, u, p, settings).unwrap().run(&mut |_| ControlFlow::Continue(()))
}

fn near<P: Problem>(problem: &P, branch: &Branch) -> Vec<NearBifurcation> {
    near_bifurcations(problem, branch, NearSettings::default()).unwrap()
}

/// `p x − x³ + e`: both branches pass the branch point of `e = 0`.
#[test]
fn imperfect_pitchforks_from_either_branch() {
    for e in [1e-9, 1e-6, 1e-4, 1e-3, 1e-2, 3e-2] {
        let problem = DenseProblem::from_residual(1, &["p"], move |x, p, r| {
            r[0] = p[0] * x[0] - x[0].powi(3) + e;
        })
        .boxed();
        let up = Settings { target: Some(1.0), ..Settings::default() };
        let primary = trace(&problem, &[0.0], &[-1.0], up.clone());
        assert!(primary.events.is_empty());
        let domain = Some((-1.0, 1.01));
        let down = Settings { domain, increasing: Some(false), ..up };
        let other = trace(&problem, &[-1.0], &[1.0], down);
        assert_eq!(other.events.len(), 1, "its fold");
        for branch in [primary, other] {
            let near = near(&problem, &branch);
            assert_eq!(near.len(), 1, "{e:e}: {near:?}");
            let only = &near[0];
            assert_eq!(only.kind, NearKind::BranchPoint);
            assert!(only.p.abs() < 1e-8 && only.u[0].abs() < 1e-8, "{only:?}");
            // the gap is the root of the imperfection in natural amplitudes
            assert!((0.3..3.0).contains(&(only.gap / e.sqrt())), "{e:e}: {}", only.gap);
            assert_eq!(branch.points[only.point].s, only.s);
            let length = only.direction.du[0].hypot(only.direction.dp);
            assert!((length - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn a_gap_that_is_wide_is_none() {
    let problem = DenseProblem::from_residual(1, &["p"], |x, p, r| {
        r[0] = p[0] * x[0] - x[0].powi(3) + 1.0;
    })
    .boxed();
    let settings = Settings { target: Some(1.0), ..Settings::default() };
    let branch = trace(&problem, &[0.7], &[-1.0], settings);
    assert_eq!(near(&problem, &branch), []);
}

/// `(u − p)(u − 2) = e`: two hyperbolas, with folds or without.
#[test]
fn imperfect_transcritical_points_of_either_sign() {
    for e in [1e-4, -1e-4, 1e-2, -1e-2, 0.1, -0.1] {
        let problem = DenseProblem::from_residual(1, &["p"], move |u, p, r| {
            r[0] = (u[0] - p[0]) * (u[0] - 2.0) - e;
        })
        .boxed();
        let domain = Some((0.0, 4.1));
        let settings = Settings { target: Some(4.0), domain, ..Settings::default() };
        let branch = trace(&problem, &[0.0], &[0.0], settings);
        let near = near(&problem, &branch);
        assert_eq!(near.len(), 1, "{e:e}: {near:?}");
        assert!((near[0].p - 2.0).abs() < 1e-8 && (near[0].u[0] - 2.0).abs() < 1e-8);
    }
}

/// Branch points that are there, folds that are far apart, Hopf points and nothing.
#[test]
fn what_is_no_near_bifurcation() {
    for lambda in [-1.0, -0.1, -0.01, 0.5, 1.0] {
        let settings = Settings { target: Some(2.0), ..Settings::default() };
        let branch = trace(&Cusp, &[-1.5], &[-2.0, lambda], settings);
        assert_eq!(near(&Cusp, &branch), [], "{lambda}");
    }
    let bratu = Bratu::new(99);
    let settings = Settings { increasing: Some(true), ..Settings::default() };
    let branch = Tracer::new(&bratu, "lambda", &[0.0; 99], &[0.0], settings)
        .unwrap()
        .watching(&[Watch::stop_at("max_u", 8.0)])
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    assert_eq!(near(&bratu, &branch), []);
    let ab = DenseProblem::from_residual(2, &["p"], |u, p, r| {
        let rate = p[0] * (1.0 - u[0]) * u[1].exp();
        r[0] = -u[0] + rate;
        r[1] = -u[1] + 18.0 * rate - 3.0 * u[1];
    })
    .boxed();
    let settings = Settings { target: Some(0.25), ..Settings::default() };
    assert_eq!(near(&ab, &trace(&ab, &[0.0, 0.0], &[0.0], settings)), []);
    let enz = enz(0.0);
    let settings = Settings { target: Some(40.0), ..Settings::default() };
    let branch = trace(&enz, &[0.0, 0.0], &[0.0], settings);
    assert_eq!(branch.events_of(&EventKind::BranchPoint).count(), 2);
    assert_eq!(near(&enz, &branch), []);
}

/// AUTO's demo `enz`, its symmetry broken by `e`.
fn enz(e: f64) -> impl Problem {
    DenseProblem::from_residual(2, &["p"], move |u, p, r| {
        let rate = |s: f64| 100.0 * s / (1.0 + s + s * s);
        r[0] = p[0] + e - 2.0 * u[0] + u[1] - rate(u[0]);
        r[1] = p[0] - 2.0 * u[1] + u[0] - rate(u[1]);
    })
    .boxed()
}

/// Both pitchforks of the symmetric branch are missed by little, at `p` lower by `e/2`.
#[test]
fn a_broken_symmetry() {
    for e in [1e-4, 1e-2] {
        let problem = enz(e);
        let settings = Settings { target: Some(40.0), ..Settings::default() };
        let branch = trace(&problem, &[0.0, 0.0], &[0.0], settings);
        assert_eq!(branch.events_of(&EventKind::BranchPoint).count(), 0);
        let near = near(&problem, &branch);
        let p: Vec<f64> = near.iter().map(|n| n.p + 0.5 * e).collect();
        assert_eq!(near.len(), 2, "{e:e}: {p:?}");
        assert!((p[0] - 34.222_886_544_190).abs() < 1e-7, "{p:?}");
        assert!((p[1] - 22.181_637_926_124).abs() < 1e-7, "{p:?}");
    }
}

#[test]
fn two_folds_close_together() {
    for lambda in [0.01, 0.1, 0.2_f64] {
        let settings = Settings { target: Some(2.0), ..Settings::default() };
        let branch = trace(&Cusp, &[-1.5], &[-2.0, lambda], settings);
        let near = near(&Cusp, &branch);
        assert_eq!(near.len(), 1, "{near:?}");
        let only = &near[0];
        assert_eq!(only.kind, NearKind::Folds);
        assert!((only.gap - (lambda / 3.0).powf(1.5)).abs() < 1e-12, "{}", only.gap);
        assert!(only.p.abs() < 1e-12 && only.u[0].abs() < 1e-9);
    }
}

/// A pitchfork with a second unknown, imperfect and without symmetry.
#[test]
fn units_do_not_matter() {
    let make = || {
        DenseProblem::from_residual(2, &["p"], |x, p, r| {
            r[0] = p[0] * x[0] - x[0].powi(3) + 0.3 * x[1] * x[0] + 1e-3;
            r[1] = x[1] + x[0] * x[0] - 0.2 * p[0];
        })
        .boxed()
    };
    let gap = |(a, b, c): (f64, f64, f64)| {
        let problem = Scaled::new(make(), a, b, &[c]);
        let settings = Settings { target: Some(c), ..Settings::default() };
        let branch = trace(&problem, &[0.0, -0.2 * b], &[-c], settings);
        let near = near(&problem, &branch);
        assert_eq!(near.len(), 1, "{a:e} {b:e} {c:e}: {near:?}");
        assert!(near[0].p.abs() < 1e-2 * c);
        near[0].gap
    };
    let plain = gap((1.0, 1.0, 1.0));
    for scale in SCALES {
        assert!((0.2..5.0).contains(&(gap(scale) / plain)), "{scale:?}");
    }
}

#[test]
fn what_is_wrong_is_an_error() {
    let settings = Settings { target: Some(2.0), ..Settings::default() };
    let branch = trace(&Cusp, &[-1.5], &[-2.0, 1.0], settings);
    let wrong = NearSettings { max_gap: f64::NAN, ..NearSettings::default() };
    let error = near_bifurcations(&Cusp, &branch, wrong).unwrap_err();
    assert!(matches!(error, NearError::Settings(e) if e.key == "max_gap"));
    let error = near_bifurcations(&Bratu::new(3), &branch, NearSettings::default()).unwrap_err();
    assert!(matches!(error, NearError::Foreign { .. }));
}

#[test]
fn data_survive_a_file() {
    let settings = Settings { target: Some(2.0), ..Settings::default() };
    let branch = trace(&Cusp, &[-1.5], &[-2.0, 0.1], settings);
    let near = near(&Cusp, &branch);
    let text = serde_json::to_string(&near).unwrap();
    assert_eq!(serde_json::from_str::<Vec<NearBifurcation>>(&text).unwrap(), near);
}
