//! Starts, typed errors, and what is said where something is not known.

use super::systems::{hopf_form, van_der_pol};
use super::{follow, follow_by};
use continuation::cycles::{Cycle, CycleBranch, CycleError, CycleSettings, SmallCycle, trace};
use continuation::{
    BandProblem, DenseProblem, EventKind, Settings, SparseProblem, Stability, StopReason, Tracer,
    Watch,
};
use std::ops::ControlFlow;

fn relaxation(t: f64, u: &mut [f64]) {
    (u[0], u[1]) = (2.0 * t.cos(), -2.0 * t.sin());
}

#[test]
fn unusable_starts_are_typed_errors() {
    let settings = CycleSettings::default();
    let problem = van_der_pol();
    let none = DenseProblem::from_residual(2, &["mu"], |u, p, r| {
        (r[0], r[1]) = (u[1], p[0] * (1.0 - u[0] * u[0]) * u[1] - u[0]);
    })
    .with_stability(Stability::None);
    let near = Cycle::near(&none, &[1.0], 6.6, relaxation, &settings);
    assert!(matches!(near, Err(CycleError::NoDynamics)), "{near:?}");
    let constant = Cycle::near(&problem, &[1.0], 6.6, |_, u| u.fill(0.3), &settings);
    assert!(matches!(constant, Err(CycleError::Constant)), "{constant:?}");
    // all orbits of the normal form decay below the Hopf point
    let form = hopf_form();
    let decays =
        Cycle::near(&form, &[-0.3, 1.0], 6.3, |t, u| (u[0], u[1]) = (t.cos(), t.sin()), &settings);
    assert!(matches!(decays, Err(CycleError::Newton(_) | CycleError::Constant)), "{decays:?}");
    let wrong = CycleSettings { degree: 8, ..settings.clone() };
    let error = Cycle::near(&problem, &[1.0], 6.6, relaxation, &wrong);
    assert!(matches!(error, Err(CycleError::Settings(e)) if e.key == "degree"));
    let short = Cycle::from_series(&problem, &[1.0], &[0.0, 1.0], &[0.0; 4], &settings);
    assert!(matches!(short, Err(CycleError::Samples { .. })));
    let lengths = Cycle::from_series(&problem, &[1.0], &[0.0, 1.0], &[0.0; 3], &settings);
    assert!(matches!(lengths, Err(CycleError::Shape { got: 3, expected: 4, .. })));
    let line: Vec<f64> = (0..40).map(f64::from).collect();
    let states: Vec<f64> = line.iter().flat_map(|t| [*t, 0.5 * t]).collect();
    let gone = Cycle::from_series(&problem, &[1.0], &line, &states, &settings);
    assert!(matches!(gone, Err(CycleError::Samples { .. })), "{gone:?}");
    let large = DenseProblem::from_residual(300, &["p"], |u, p, r| {
        (0..300).for_each(|i| r[i] = u[(i + 1) % 300] - p[0] * u[i]);
    })
    .with_stability(Stability::Dynamics);
    let large = Cycle::near(&large, &[1.0], 1.0, |t, u| u.fill(t), &settings);
    assert!(matches!(large, Err(CycleError::TooLarge { size: 1200, most: 800 })), "{large:?}");
    // the event of a branch of equilibria must be a Hopf point
    let target = Settings { target: Some(0.5), ..Settings::default() };
    let mut equilibria =
        Tracer::new(&form, "mu", &[0.0; 2], &[-0.5, 1.0], target).unwrap().run_quietly();
    equilibria.events[0].kind = EventKind::Fold;
    let kind = SmallCycle::at_hopf(&form, &equilibria, &equilibria.events[0], &settings);
    assert!(matches!(kind, Err(CycleError::Kind { found: EventKind::Fold, .. })));
    equilibria.events[0].kind = EventKind::Hopf;
    equilibria.events[0].eigenvectors.clear();
    let vector = SmallCycle::at_hopf(&form, &equilibria, &equilibria.events[0], &settings);
    assert!(matches!(vector, Err(CycleError::NoEigenvector)));
}

/// Without the finer solution no error is known, and nothing is certified.
#[test]
fn what_is_not_checked_is_not_certified() {
    let problem = van_der_pol();
    let settings = CycleSettings { check: false, ..CycleSettings::default() };
    let start = Cycle::near(&problem, &[1.0], 6.6, relaxation, &settings).unwrap();
    let branch = follow_by(
        &problem,
        "mu",
        &start,
        Settings { target: Some(2.0), ..Settings::default() },
        &settings,
    );
    assert!(branch.cycles.iter().all(|c| c.error.is_none() && !c.certified));
    assert!(branch.cycles.iter().all(|c| c.multipliers.iter().all(|m| m.error.is_none())));
    assert!(!branch.branch.is_certain());
}

/// A mesh that is far too coarse says so.
#[test]
fn a_coarse_mesh_reports_its_errors() {
    let problem = van_der_pol();
    let settings =
        CycleSettings { degree: 3, intervals: 10, max_intervals: 10, ..CycleSettings::default() };
    let start = Cycle::near(&problem, &[1.0], 6.6, relaxation, &settings).unwrap();
    let branch = follow_by(
        &problem,
        "mu",
        &start,
        Settings { max_points: 3, ..Settings::default() },
        &settings,
    );
    let cycle = &branch.cycles[0];
    let off = (cycle.cycle.period / 6.663_286_859_323 - 1.0).abs();
    let said = cycle.period_error.unwrap();
    assert!(off > 1e-7 && off <= said && said < 1e2 * off, "{off:e} {said:e}");
    assert!(cycle.trivial_error.unwrap() > 1e-8);
}

#[test]
fn other_storages_and_a_saved_branch() {
    fn field(u: &[f64], p: &[f64], r: &mut [f64]) {
        (r[0], r[1]) = (u[1], p[0] * (1.0 - u[0] * u[0]) * u[1] - u[0]);
    }
    let settings = CycleSettings::default();
    let target = Settings { target: Some(1.2), ..Settings::default() };
    let exact = 6.663_286_859_323;
    let check = |branch: CycleBranch| {
        let first = &branch.cycles[0];
        assert!((first.cycle.period - exact).abs() < 1e-8, "{}", first.cycle.period);
        assert_eq!((first.unstable, first.certified), (Some(0), true), "{first:?}");
        let text = serde_json::to_string(&branch).unwrap();
        assert_eq!(serde_json::from_str::<CycleBranch>(&text).unwrap(), branch);
    };
    let dense = DenseProblem::from_residual(2, &["mu"], field).with_stability(Stability::Dynamics);
    let start = Cycle::near(&dense, &[1.0], 6.6, relaxation, &settings).unwrap();
    check(follow(&dense, "mu", &start, target.clone()));
    let band =
        BandProblem::from_residual(2, (1, 1), &["mu"], field).with_stability(Stability::Dynamics);
    let start = Cycle::near(&band, &[1.0], 6.6, relaxation, &settings).unwrap();
    check(follow(&band, "mu", &start, target.clone()));
    let pattern = [(0, 1), (1, 0), (1, 1), (0, 0)];
    let sparse = SparseProblem::from_residual(2, &pattern, &["mu"], field)
        .unwrap()
        .with_stability(Stability::Dynamics);
    let start = Cycle::near(&sparse, &[1.0], 6.6, relaxation, &settings).unwrap();
    check(follow(&sparse, "mu", &start, target));
}

#[test]
fn the_period_and_parameters_can_be_watched() {
    let problem = van_der_pol();
    let start = Cycle::near(&problem, &[1.0], 6.6, relaxation, &CycleSettings::default()).unwrap();
    let watches = [Watch::stop_at("period", 8.0), Watch::parameter(1.5)];
    let branch = trace(
        &problem,
        "mu",
        &start,
        &Settings { target: Some(5.0), ..Settings::default() },
        &CycleSettings::default(),
        &watches,
        &mut |_| ControlFlow::Continue(()),
    )
    .unwrap();
    assert_eq!(branch.branch.stopped.reason, StopReason::Target);
    assert!((branch.cycles.last().unwrap().cycle.period - 8.0).abs() < 1e-8);
    let landing = branch.branch.events_of(&EventKind::Target).next().unwrap();
    assert_eq!(landing.p, 1.5);
    let points = &branch.branch.points;
    assert!(points.windows(2).all(|w| w[0].s < w[1].s && w[0].p < w[1].p));
    // interrupted: what is computed is kept
    let observer = &mut |progress: &continuation::Progress| {
        if progress.points >= 4 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let settings = Settings { target: Some(5.0), ..Settings::default() };
    let cut =
        trace(&problem, "mu", &start, &settings, &CycleSettings::default(), &[], observer).unwrap();
    assert_eq!((cut.branch.stopped.reason, cut.branch.points.len()), (StopReason::Interrupted, 4));
}
