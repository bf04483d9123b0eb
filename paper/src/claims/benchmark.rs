//! What the paper says of the benchmark (Fig. 4).

use super::measure::{folds, force, pressure, slope};
use super::tolerance::{ROUGHLY, SAME, SLOPE, VANISHES};
use super::{Branches, Claim, Row, stability};
use crate::manifest::Ordinate;
use crate::ring::{RingBranch, RingPoint};

/// Fig. 4.
pub(super) fn ring_load(of: &Branches<'_>, rings: &[RingBranch]) -> Vec<Claim> {
    let row = |statement, measured, why| Row::new(4, statement, measured, why);
    let (weak, strong) = (of.get("weak"), of.get("strong"));
    let ring = |word: &str| rings.iter().find(|r| r.label.ends_with(word)).map(|r| &r.points[..]);
    let buckled = ring("buckled");
    let least = buckled.map(|points| points.iter().fold(f64::INFINITY, |m, q| m.min(q.alpha)));
    let film = |d: f64| {
        let t = weak?;
        Some(t.ordinate(Ordinate::Benchmark, force(t, d * t.thickness())?))
    };
    let at = |points: Option<&[RingPoint]>, d: f64, unstable: bool, y: fn(&RingPoint) -> f64| {
        let points = points?;
        points.windows(2).find_map(|pair| {
            let (a, b) = (&pair[0], &pair[1]);
            let inside = (a.deflection - d) * (b.deflection - d) <= 0.0;
            (inside && a.unstable == unstable && b.unstable == unstable).then(|| {
                let share = (d - a.deflection) / (b.deflection - a.deflection);
                y(a) + share * (y(b) - y(a))
            })
        })
    };
    let ratio = |a: Option<f64>, b: Option<f64>| a.zip(b).map(|(a, b)| a / b);
    let gain = at(buckled, 3.0, true, |q| q.energy)
        .zip(at(buckled, 3.0, false, |q| q.energy))
        .map(|(flat, dimple)| (flat - dimple) / flat);
    vec![
        row(
            "the post-buckling regime emerges at a contact angle of roughly 10°",
            "contact angle at which the buckled branch of the ring load begins, degrees",
            "the fold at which the dimple appears",
        )
        .near(ROUGHLY, 10.0, least),
        row(
            "the film model recovers the ring load: flat",
            "force between plates over that of the ring at Δ/h = 1.5",
            "the film is half a thickness and takes part of the deformation",
        )
        .near(SAME, 1.0, ratio(film(1.5), at(ring("flat"), 1.5, false, |q| q.force))),
        row(
            "the film model recovers the ring load: buckled",
            "force between plates over that of the ring at Δ/h = 6",
            "on the dimple the film is thin, and the load a ring",
        )
        .near(SAME, 1.0, ratio(film(6.0), at(buckled, 6.0, false, |q| q.force))),
        row(
            "the buckled branch has the lower energy after the buckling point",
            "share of the flat energy that is gained at Δ/h = 3",
            "both states on the branch of the ring load",
        )
        .above(0.0, gain),
        row(
            "only the stable part is recovered with the film, as one branch",
            "most unstable modes of every kind from zero force to Δ/h = 10, plates fixed, weak \
             adhesion",
            "the film smooths the bifurcation away, and up to there nothing else is lost",
        )
        .exactly(0.0, weak.and_then(|t| stability::most(t, 10.0 * t.thickness()))),
        row(
            "a stronger potential gives rise to limit points",
            "number of folds at 1.5e-3 N/m",
            "the paper does not say which potential it took; this one has two",
        )
        .above(1.0, strong.and_then(folds)),
        row(
            "the initial part is linear (Reissner's slope 8)",
            "chord between Δ/h = 0.5 and 1, F/√(χk_b) per Δ/R0",
            "near 8 once the film has thinned",
        )
        .near(SLOPE, 8.0, weak.and_then(|t| slope(t, 0.5 * t.thickness(), t.thickness()))),
        row(
            "the pressure concentrates at the end of the contact area",
            "pressure at the pole over the largest at Δ/h = 4",
            "nothing presses inside the ring",
        )
        .bounded(VANISHES, weak.and_then(|t| pressure(t, 4.0 * t.thickness())).map(|p| p.0.abs())),
    ]
}
