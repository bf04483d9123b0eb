//! Very thin shells, whose branches nearly touch and whose folds are sharp.

#![allow(clippy::unwrap_used)]

use continuation::{Detail, EventKind, Settings, StopReason};
use shell_contact::{
    ContactBranch, ContactProblem, Dimensionless, Law, Mesh, Shell, trace_contact,
};
use std::ops::ControlFlow;

fn trace(problem: &ContactProblem, start: f64, settings: Settings) -> ContactBranch {
    trace_contact(problem, start, settings, &mut |_| ControlFlow::Continue(())).unwrap()
}

/// Pitchforks that are imperfect by little more than rounding: the same end at every step length, not
/// another branch at each.
#[test]
fn no_step_length_jumps_across_the_gap_of_an_imperfect_pitchfork() {
    let shell = Shell { law: Law::Skalak, poisson: 0.4 };
    let groups = Dimensionless {
        bending: 1.5e-6,
        pressure: 3e-4,
        adhesion: 2e-5,
        film: 0.013,
        surface_tension: 0.0375,
        gas_exponent: 0.0,
    };
    let problem = ContactProblem::new(&shell, &groups, Mesh::uniform(200).unwrap()).unwrap();
    let mut ends = Vec::new();
    for max_step in [0.001, 0.005, 0.01, 0.02] {
        let settings =
            Settings { target: Some(0.74), max_step: Some(max_step), ..Settings::default() };
        let branch = trace(&problem, 1.9, settings).branch;
        let stopped = &branch.stopped;
        assert_eq!(stopped.reason, StopReason::BranchesTooClose, "{max_step}: {stopped:?}");
        assert!(branch.events_of(&EventKind::BranchPoint).next().is_none(), "{max_step}");
        ends.push(branch.points.last().unwrap().p);
    }
    for end in &ends {
        assert!((end / ends[0] - 1.0).abs() < 1e-6, "{ends:?}");
    }
}

/// Folds sharper than 1e-7 of the range are passed with the default settings.
#[test]
fn needle_sharp_folds_are_passed_at_default_steps() {
    let shell = Shell { law: Law::Hooke, poisson: 0.5 };
    let groups = Dimensionless {
        bending: 3.838_803_467_874_241e-6,
        pressure: 0.003_634_460_293_314_932_6,
        adhesion: 4.618_002_714_548_425e-8,
        film: 0.050_238_855_723_206_63,
        surface_tension: 0.0,
        gas_exponent: 1.4,
    };
    let mesh = Mesh::graded(134, 3.963_359_478_191_135_7).unwrap();
    let problem = ContactProblem::new(&shell, &groups, mesh).unwrap();
    let target = Some(0.280_330_732_762_804);
    let settings = Settings { target, max_step: Some(0.01), ..Settings::default() };
    let branch = trace(&problem, 1.554_895_376_327_445_1, settings).branch;
    assert_eq!(branch.stopped.reason, StopReason::Target, "{:?}", branch.stopped);
    let folds: Vec<f64> = branch.events_of(&EventKind::Fold).map(|e| e.p).collect();
    let known = [0.514_322_191, 0.769_834_865, 0.467_338_316, 0.547_389_86, 0.298_175_598];
    assert_eq!(folds.len(), 6, "{folds:?}");
    for (fold, known) in folds.iter().zip(known) {
        assert!((fold - known).abs() < 1e-8, "{folds:?}");
    }
}

/// Where the tangent turns fast a slope shows the error of a state much magnified: a bracket closed about
/// places 1e-8 apart, said to be known to 7e-11.
#[test]
fn the_pull_off_is_known_as_well_as_it_says_at_every_step_length() {
    let shell = Shell { law: Law::Skalak, poisson: 0.3235 };
    let groups = Dimensionless {
        bending: 3.615_359e-4,
        pressure: 4.288_824e-3,
        adhesion: 4.938_423e-3,
        film: 2.839_31e-2,
        surface_tension: 0.0,
        gas_exponent: 1.07,
    };
    let problem = ContactProblem::new(&shell, &groups, Mesh::uniform(300).unwrap()).unwrap();
    let mut places = Vec::new();
    for k in 0..18 {
        let max_step = Some(0.003 + 0.001 * f64::from(k));
        let settings = Settings { target: Some(1.0), max_step, ..Settings::default() };
        let branch = trace(&problem, 1.13357, settings).branch;
        let pull_off = branch.events.iter().find(|event| event.kind.to_string() == "pull-off");
        let event = pull_off.unwrap();
        places.push((event.p, event.error_estimate));
    }
    let mean = places.iter().map(|(p, _)| p).sum::<f64>() / places.len() as f64;
    let beyond = places.iter().filter(|(p, error)| (p - mean).abs() > *error).count();
    assert!(
        places.iter().all(|(p, error)| (p - mean).abs() < 1e-11 && *error < 1e-9),
        "{places:?}"
    );
    assert!(beyond <= 1, "{beyond}: {places:?}");
}

/// A soft shell pulled into strong adhesion passes two folds and comes back so close to itself that
/// Newton's method went over, at one step length in three, where position, angles and orientation looked
/// right: the folds between were lost.
#[test]
fn a_branch_that_comes_back_beside_itself_is_followed() {
    let shells = [
        (0.9108, [1.568_479e-7, 2.095_177e-2, 1.461_085e-4, 1.330_274e-2], (1.07321, 0.985), 2),
        (0.4685, [3.958_952e-7, 7.742_196e-2, 2.886_59e-3, 3.327_241e-2], (1.15309, 0.955), 4),
    ];
    for (b, [bending, pressure, adhesion, film], (start, end), expected) in shells {
        let shell = Shell { law: Law::MooneyRivlin { b }, poisson: 0.5 };
        let groups = Dimensionless {
            bending,
            pressure,
            adhesion,
            film,
            surface_tension: 0.0,
            gas_exponent: 1.07,
        };
        let problem = ContactProblem::new(&shell, &groups, Mesh::uniform(300).unwrap()).unwrap();
        let mut first: Option<Vec<f64>> = None;
        for max_step in [0.005, 0.01, 0.0143, 0.02] {
            let settings =
                Settings { target: Some(end), max_step: Some(max_step), ..Settings::default() };
            let branch = trace(&problem, start, settings).branch;
            assert_eq!(branch.stopped.reason, StopReason::Target, "{max_step}");
            let folds: Vec<f64> = branch.events_of(&EventKind::Fold).map(|event| event.p).collect();
            assert_eq!(folds.len(), expected, "{b} {max_step}: {folds:?}");
            let known = first.get_or_insert(folds.clone());
            assert!(known.iter().zip(&folds).all(|(a, b)| (a - b).abs() < 1e-9), "{folds:?}");
        }
    }
}

/// Imperfect pitchforks of a gap at the edge of what is told apart: where a branch point is no more than
/// bracketed the branch says that it is not certain which way it went on.
#[test]
fn what_is_only_bracketed_is_not_certain() {
    let shell = Shell { law: Law::Hooke, poisson: 0.384_536_898_529_598 };
    let groups = Dimensionless {
        bending: 2.367_752_263_824_953_8e-7,
        pressure: 8.307_777_492_564_623e-4,
        adhesion: 0.041_709_430_855_428_72,
        film: 0.106_012_876_270_159_79,
        surface_tension: 0.0,
        gas_exponent: 1.07,
    };
    let problem = ContactProblem::new(&shell, &groups, Mesh::uniform(300).unwrap()).unwrap();
    let mut known: Vec<(Vec<f64>, bool)> = Vec::new();
    for max_step in [0.005, 0.007, 0.01] {
        let settings =
            Settings { target: Some(1.05), max_step: Some(max_step), ..Settings::default() };
        let branch = trace(&problem, 1.736_077_257_6, settings).branch;
        let places: Vec<f64> = branch
            .events
            .iter()
            .filter(|event| matches!(event.kind, EventKind::Fold | EventKind::BranchPoint))
            .map(|event| event.p)
            .collect();
        let bracketed = |event: &&continuation::Event| {
            event.kind == EventKind::BranchPoint && event.detail == Detail::None
        };
        let vague = branch.events.iter().filter(bracketed).count();
        println!("{max_step}: {places:?}, {vague} bracketed, {:?}", branch.doubts);
        assert!(vague == 0 || !branch.is_certain(), "{max_step}: {places:?}");
        let certain = branch.is_complete() && branch.is_certain();
        for (other, also) in &known {
            let same = other.len() == places.len()
                && other.iter().zip(&places).all(|(a, b)| (a - b).abs() < 1e-6);
            assert!(same || !(certain && *also), "{max_step}: {places:?} {other:?}");
        }
        known.push((places, certain));
    }
}
