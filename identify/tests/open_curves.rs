//! Curves that another solver made, with known truth.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

mod common;

use common::{Known, open, truth};
use identify::uncertainty::verdict::Verdict;
use identify::{Identification, Profiles, identify};

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
/// `∝ √(k_b/χ)`, and the pressure of the gas sets the scale of the moduli: the lever's error would reach the
/// radius. So the optical radius calibrates the lever, and no interval is wider than what was known beforehand.
#[test]
fn an_uncertain_lever_and_the_optical_radius_share_their_error() {
    let known = open(1);
    let mut setup = known.setup();
    setup.spring_constant_sd = 0.1;
    let found = identify(&known.curve, &setup, &Profiles::WhereNeeded).unwrap();
    contains_truth(&found, &known);
    for key in ["radius", "spring_constant"] {
        let estimate = found.report.estimate(key).unwrap();
        let prior = estimate.prior.unwrap();
        assert!(estimate.sd.unwrap() < prior.sd, "{key} {:?} {:?}", estimate.sd, prior);
        let [low, high] = estimate.interval95.map(|end| end.unwrap());
        assert!(high - low < 2.0 * 1.96 * prior.sd, "{key} {low:e} {high:e} {prior:?}");
    }
    let sds = |key: &str| {
        let e = found.report.estimate(key).unwrap();
        (e.sd.unwrap() / e.value, e.sd_statistical.unwrap() / e.value)
    };
    // 10 % become about the 3 % of the radius; its share remains in what forces fix
    assert!(sds("spring_constant").0 < 0.05);
    let (all, own) = sds("adhesion");
    assert!(own < 0.8 * all && all < 0.08, "{own} {all}");
    assert!(sds("young").0 < 0.02);
}

#[test]
fn the_same_curve_gives_the_same_fit() {
    let known = open(2);
    let thin = known.curve.thinned(4);
    let fit = || identify(&thin, &known.setup(), &Profiles::None).unwrap().parameters.0;
    assert_eq!(fit().map(f64::to_bits), fit().map(f64::to_bits));
}
