//! Curves that another solver made, with known truth.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

mod common;

use common::{Known, open};
use identify::uncertainty::verdict::Verdict;
use identify::{Identification, Key, Parameters, Profiles, identify};

const QUANTITIES: [&str; 9] = [
    "young",
    "thickness",
    "sqrt_chi_kb",
    "chi",
    "bending",
    "adhesion",
    "film",
    "radius",
    "contact",
];

fn truth(p: &Parameters, key: &str) -> f64 {
    match key {
        "young" => p.young(),
        "thickness" => p.thickness(),
        "sqrt_chi_kb" => p.force_scale(),
        other => p[Key::of(other).unwrap()],
    }
}

fn contains_truth(found: &Identification, known: &Known) {
    for key in QUANTITIES {
        let estimate = found.report.estimate(key).unwrap();
        let truth = truth(&known.truth, key);
        let [low, high] = estimate.interval95.map(|end| end.unwrap());
        assert!(low < truth && truth < high, "{key}: {truth:e} is not in {low:e}..{high:e}");
    }
}

fn ratio(found: &Identification, known: &Known, key: &str) -> f64 {
    (found.report.estimate(key).unwrap().value / truth(&known.truth, key) - 1.0).abs()
}

#[test]
fn a_hard_shell_past_its_knee() {
    let known = open(1);
    let found = identify(&known.curve, &known.setup(), &Profiles::WhereNeeded).unwrap();
    contains_truth(&found, &known);
    assert!(ratio(&found, &known, "young") < 0.015);
    assert!(ratio(&found, &known, "thickness") < 0.005);
    assert_eq!(found.report.estimate("young").unwrap().verdict, Some(Verdict::Identified));
    assert!(found.report.reach.knee && found.report.is_good());
    let json = serde_json::to_value(&found.report).unwrap();
    assert!(json["parameters"][0]["interval95"][0].is_number());
}

#[test]
fn a_soft_shell_at_its_upturn() {
    let known = open(2);
    let found = identify(&known.curve, &known.setup(), &Profiles::None).unwrap();
    contains_truth(&found, &known);
    assert!(ratio(&found, &known, "chi") < 0.04 && ratio(&found, &known, "bending") < 0.04);
    // no profile was followed where it was needed
    assert_ne!(found.report.estimate("young").unwrap().verdict, Some(Verdict::Identified));
    assert!(found.report.warnings.iter().any(|w| w.code == "profile-needed"));
}

#[test]
fn snap_in_and_snap_off_are_where_they_were() {
    let known = open(3);
    let found = identify(&known.curve, &known.setup(), &Profiles::None).unwrap();
    contains_truth(&found, &known);
    assert!(ratio(&found, &known, "chi") < 0.04 && ratio(&found, &known, "bending") < 0.04);
    let jumps = &found.report.jumps;
    assert_eq!(jumps.iter().map(|j| j.direction).collect::<Vec<_>>(), ["approach", "retract"]);
    let h = &known.curve.segments[0].height;
    let spacing = (h[1] - h[0]).abs();
    for jump in jumps {
        let off = (jump.height_measured - jump.height_modelled.unwrap()).abs();
        assert!(off < 3.0 * spacing, "{off:e} m, samples are {spacing:e} m apart");
    }
}

/// Up to 3/4 of the knee's deformation the curve fixes √(χ k_b) and no more.
#[test]
fn before_the_knee_the_moduli_are_not_called_identified() {
    let known = open(1);
    let mut setup = known.setup();
    setup.range = Some((7.7e-6, 1.0));
    let found = identify(&known.curve, &setup, &Profiles::WhereNeeded).unwrap();
    contains_truth(&found, &known);
    for key in ["young", "thickness", "chi", "bending"] {
        let estimate = found.report.estimate(key).unwrap();
        assert_ne!(estimate.verdict, Some(Verdict::Identified), "{key}");
        assert_eq!(estimate.method, "profile");
    }
    assert!(ratio(&found, &known, "sqrt_chi_kb") < 0.08);
    assert!(found.report.warnings.iter().any(|w| w.code == "before-knee"));
}

/// A stiffer lever means larger forces. Of a hard shell past its knee these are `∝ k_b/R0` at deformations
/// `∝ √(k_b/χ)`: it is the radius that the lever's error reaches, and the adhesion, not the moduli.
#[test]
fn an_uncertain_lever_widens_what_forces_fix() {
    let known = open(1);
    let mut setup = known.setup();
    setup.spring_constant_sd = 0.1;
    let found = identify(&known.curve, &setup, &Profiles::None).unwrap();
    for key in ["radius", "adhesion"] {
        let estimate = found.report.estimate(key).unwrap();
        let (all, own) = (estimate.sd.unwrap(), estimate.sd_statistical.unwrap());
        assert!(
            own < 0.05 * estimate.value && all > 0.08 * estimate.value,
            "{key} {own:e} {all:e}"
        );
    }
    let young = found.report.estimate("young").unwrap();
    assert!(young.sd.unwrap() < 0.02 * young.value);
    assert!(found.report.warnings.iter().any(|w| w.code == "spring-constant"));
}

#[test]
fn the_same_curve_gives_the_same_fit() {
    let known = open(2);
    let thin = known.curve.thinned(4);
    let fit = || identify(&thin, &known.setup(), &Profiles::None).unwrap().parameters.0;
    assert_eq!(fit().map(f64::to_bits), fit().map(f64::to_bits));
}
