//! Curves and parameters that are hard on a fit: a shell that buckles, shells beyond reason, and people who do not
//! wait.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

#[path = "common/buckling.rs"]
mod buckling;
mod common;

use buckling::{draw, measure};
use common::{heights, open, parameters, truth};
use identify::attend::Attended;
use identify::branch::{Effort, Group, Span, trace};
use identify::fit::Setup;
use identify::fit::objective::{DerivedPrior, Prior};
use identify::model::Model;
use identify::uncertainty::Derived;
use identify::{FitError, Key, LawName, ModelError, Parameters, Profiles};
use identify::{Progress, Stage, identify, identify_attended};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// A polymer shell of 25 nm (E = 2.1 GPa) with strong adhesion: it snaps in, and buckles with a jump of hundreds of
/// nanonewtons. Shells without the jump are minima too.
#[test]
fn a_shell_that_buckles_is_found_from_the_grid() {
    let bending = 2.1e9 * 25e-9_f64.powi(3) / (12.0 * 0.75);
    let mut p = parameters([52.5, bending, 0.105, 50e-9, 1.5e-6, 15.0, 6e-6]);
    p[Key::Offset] = 3e-9;
    let noise = 1.5e-9;
    let mut curve = heights(8e-6, 5.1e-6, 600);
    let effort = Effort {
        elements: 200,
        points: 2000,
        force_error: 1e-3 * noise,
        work: f64::INFINITY,
        max_angle: Effort::ANGLE,
    };
    let model = Model { law: LawName::Hooke, contacts: 2, nominal_spring_constant: 15.0, effort };
    measure(&mut curve, &model, &p, noise, 7);
    let mut base = Parameters::default();
    base[Key::SpringConstant] = 15.0;
    base[Key::Radius] = 1.54e-6;
    let optical = Prior { key: Key::Radius, value: 1.54e-6, sd: 5e-8 };
    let mut setup = Setup::new(LawName::Hooke, base, vec![optical]);
    setup.spring_constant_sd = 0.0;
    let found = identify(&curve, &setup, &Profiles::None).unwrap();
    let report = &found.report;
    let jumps = report.jumps.iter().filter(|jump| jump.direction == "approach");
    let largest =
        jumps.map(|jump| (jump.force_after - jump.force_before).abs()).fold(0.0, f64::max);
    println!("jumps {:?}\n{} evaluations", report.jumps, report.cost.evaluations);
    for key in ["young", "thickness", "adhesion", "film", "radius", "contact"] {
        let e = report.estimate(key).unwrap();
        println!("{key}: {:.4e}, truth {:.4e}, {:?}", e.value, truth(&p, key), e.interval95);
    }
    assert!(report.is_good(), "{:?}", report.quality);
    assert!(largest > 5e-7, "{largest:e}");
    for key in ["young", "thickness", "adhesion", "film", "radius"] {
        let e = report.estimate(key).unwrap();
        assert!((e.value / truth(&p, key) - 1.0).abs() < 0.03, "{key}: {:e}", e.value);
    }
}

/// Random shells of that kind; `benches/coverage.rs` has fifty.
#[test]
fn most_random_shells_that_buckle_are_found() {
    let drawn = (110..125).filter_map(|seed| Some((seed, draw(seed)?)));
    let found: Vec<bool> = drawn.map(|(seed, shell)| shell.is_found(seed)).collect();
    let missed = found.iter().filter(|found| !**found).count();
    assert!(found.len() >= 6 && missed * 4 <= found.len(), "{missed} of {} missed", found.len());
}

/// Shells at the bounds of the search: no branch takes more than its budget, whatever comes of it.
#[test]
fn no_evaluation_exceeds_its_budget() {
    let effort = Effort {
        elements: 100,
        points: 500,
        force_error: 1e-13,
        work: 600.0,
        max_angle: Effort::WIDE,
    };
    let (mut dear, mut most) = (0, 0);
    for (chi, bending) in [(1e-4, 1e-21), (0.05, 3e-16), (50.0, 4e-15), (1e5, 1e-9), (1e3, 1e-21)] {
        for (adhesion, film) in [(1e-8, 4e-9), (0.1, 3e-9), (1.0, 4e-9), (1e-3, 3e-7)] {
            let p = parameters([chi, bending, adhesion, film, 1.5e-6, 0.1, 0.0]);
            let span = Span { start: 1.6, end: 0.05, enough: &|_, _| false, stop: &|| false };
            match trace(LawName::Hooke, &p, &span, effort, &Group::ALL) {
                Ok(branch) => {
                    most = most.max(branch.assemblies);
                    dear += usize::from(branch.too_dear.is_some());
                    // what one step may take comes on top
                    assert!(branch.assemblies < 1200, "{p:?}: {}", branch.assemblies);
                }
                Err(ModelError::Stopped) => panic!("nobody stopped it"),
                Err(_) => {}
            }
        }
    }
    println!("{dear} too dear, {most} assemblies at most");
    assert!(dear > 0, "the budget was never tried");
}

/// Progress never falls, and a stop is obeyed wherever it comes; what was found is kept.
#[test]
fn a_stop_keeps_what_was_found() {
    let known = open(2);
    let curve = known.curve.thinned(4);
    let setup = known.setup();
    let told = Mutex::new(Vec::<Progress>::new());
    let listener = |progress| told.lock().unwrap().push(progress);
    let attended = Attended { stop: None, listener: Some(&listener) };
    identify_attended(&curve, &setup, &Profiles::WhereNeeded, attended).unwrap();
    let told = told.into_inner().unwrap();
    assert!(told.windows(2).all(|w| w[0].share <= w[1].share), "{told:?}");
    let stages = [Stage::Starts, Stage::Descents, Stage::Polish, Stage::Profiles];
    assert!(stages.iter().all(|stage| told.iter().any(|progress| progress.stage == *stage)));
    let stopped = |when: Stage, after: usize| {
        let (stop, seen) = (AtomicBool::new(false), AtomicUsize::new(0));
        let listener = |progress: Progress| {
            if progress.stage == when && seen.fetch_add(1, Ordering::Relaxed) == after {
                stop.store(true, Ordering::Relaxed);
            }
        };
        let attended = Attended { stop: Some(&stop), listener: Some(&listener) };
        identify_attended(&curve, &setup, &Profiles::WhereNeeded, attended)
    };
    assert!(matches!(stopped(Stage::Starts, 2), Err(FitError::Stopped)));
    for (stage, after) in [(Stage::Descents, 2), (Stage::Polish, 0), (Stage::Polish, 1)] {
        let report = stopped(stage, after).unwrap().report;
        assert!(!report.is_good() && report.warnings.iter().any(|w| w.code == "stopped"));
        let chi = report.estimate("chi").unwrap().value;
        assert!(chi > 0.0 && chi.is_finite(), "{stage:?}: {chi:e}");
    }
    let report = stopped(Stage::Profiles, 1).unwrap().report;
    assert!(report.quality.converged && !report.is_good());
    assert_eq!(report.profiles.len(), 1, "the one that was followed to its end");
}

/// Before its knee a curve does not say E and h one by one; who knows E beforehand gets h.
#[test]
fn what_is_known_of_youngs_modulus_counts() {
    let known = open(1);
    let mut setup = known.setup();
    // the first third of the contact only
    let contact = known.truth[Key::Contact];
    setup.range = Some((contact - 0.06e-6, f64::INFINITY));
    setup.start = Some(known.truth);
    let sd = |setup: &Setup| {
        let found = identify(&known.curve, setup, &Profiles::None).unwrap();
        let e = found.report.estimate("thickness").unwrap().clone();
        (e.value, e.sd.unwrap() / e.value, found.report)
    };
    let (_, without, _) = sd(&setup);
    setup.derived = vec![DerivedPrior { of: Derived::Young, value: 1.75e9, sd: 0.1e9 }];
    let (h, with, report) = sd(&setup);
    println!("sd of h: {without:.3} without, {with:.3} with");
    assert!(with < 0.5 * without, "{without} {with}");
    assert!((h / 22e-9 - 1.0).abs() < 4.0 * with, "{h:e} {with}");
    let young = report.estimate("young").unwrap();
    let pull = (young.value / 1.75e9).ln() / (0.1 / 1.75);
    assert!((young.prior_pull.unwrap() - pull).abs() < 1e-9 && young.prior.is_some());
}
