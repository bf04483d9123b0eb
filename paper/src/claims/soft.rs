//! What the paper says of soft shells.

use super::measure::{
    beyond, dimple, energies, folds, force, power, power_beyond, pressure, pull_off, slope, steeper,
};
use super::tolerance::{ALMOST, FLAT, LAW, MUCH, POWER, ROUGHLY, SAME, SLOPE, VANISHES};
use super::{Branches, Claim, Row, stability};
use crate::estimates::{self, Recovered};
use crate::laws;
use crate::manifest::Law;
use shell_contact::asymptotics::incompressible_force;
use shell_contact::identify::{Combination, Formulas};

/// Fig. 7.
pub(super) fn lipid(of: &Branches<'_>) -> Vec<Claim> {
    let row = |statement, measured, why| Row::new(7, statement, measured, why);
    let Some(t) = of.get("soft") else { return Vec::new() };
    let first = slope(t, 0.0, 0.02);
    let last_step = incompressible_force(0.5, t.bending(), 0.35);
    let full = laws::force(Law::Cubic, &t.problem, 0.35);
    let cubic = |from, to| power_beyond(t, from, to);
    let law = "F = 4πχΔ³/R0², Eq. (39)";
    let rival = |d| {
        energies(t, d, |s| {
            let o = &s.observation;
            o.energy_stretching / o.energy_bending.max(o.energy_gas)
        })
    };
    let least = [0.05, 0.1, 0.2, 0.3, 0.38]
        .into_iter()
        .map(rival)
        .try_fold(f64::INFINITY, |m, r| Some(m.min(r?)));
    vec![
        row(
            "the Reissner slope of nearly 8 was recovered throughout the linear regime",
            "chord of the first 0.02 R0",
            "a film of R0/30 thins under the load and takes part of the deformation",
        )
        .near(SLOPE, 8.0, first),
        row(
            "no buckling: the shape remains flat",
            "depth of the pole below the highest point at Δ/R0 = 0.38, R0",
            "the gas keeps the cap up",
        )
        .bounded(FLAT, dimple(t, 0.38)),
        row(
            "the curve is stable throughout",
            "most unstable modes of every kind from zero force to Δ/R0 = 0.38, plates fixed",
            "no sentence of the paper says so; the gas keeps the shell round",
        )
        .ours()
        .exactly(0.0, stability::most(t, 0.38)),
        row(
            "the transition takes place at roughly Δ/R0 ≈ 0.2",
            "deformation at which the slope has doubled, R0",
            "doubling of the slope is taken for the transition",
        )
        .near(ROUGHLY, 0.2, steeper(t, 2.0)),
        row(
            "a nonlinear regime with an O(d³) dependence",
            "power of the force beyond the linear one, from Δ/R0 = 0.2 to 0.38",
            "from the transition to the end of the figure",
        )
        .near(POWER, 3.0, cubic(0.2, 0.38)),
        row(
            "a nonlinear regime with an O(d³) dependence",
            "power of the force beyond the linear one, from Δ/R0 = 0.3 to 0.38",
            "at the largest deformations, as in Fig. 18",
        )
        .near(POWER, 3.0, cubic(0.3, 0.38)),
        row(
            law,
            "force beyond the linear one over this, at Δ/R0 = 0.35",
            "(39) is one part of the force; its last step needs P_A ≫ 1, and the plate touches a \
             smaller area than the cut of a sphere",
        )
        .near(LAW, 1.0, beyond(t, 0.35).map(|f| f / last_step)),
        row(
            law,
            "total force over this, at Δ/R0 = 0.35",
            "with the linear part, which (39) leaves out",
        )
        .near(LAW, 1.0, force(t, 0.35).map(|f| f / last_step)),
        row(
            law,
            "total force over the line before the last step of (39), at Δ/R0 = 0.35",
            "without the limit P_A ≫ 1: the law is still too strong",
        )
        .near(LAW, 1.0, force(t, 0.35).map(|f| f / full)),
        row(
            "stretching remains the dominant elastic energy for the entire range",
            "stretching over the larger of bending and gas, the least at 0.05, 0.1, 0.2, 0.3 and 0.38",
            "up to Δ/R0 = 0.11 the shell is bent more than it is stretched; beyond, stretching is the \
             largest to the end",
        )
        .above(1.0, least),
    ]
}

/// Fig. 9.
pub(super) fn estimates(of: &Branches<'_>) -> Vec<Claim> {
    let row = |statement, measured, why| Row::new(9, statement, measured, why);
    let hard = of.get("hard");
    let get = |formulas, combination| {
        let found = hard.and_then(|t| estimates::recover(t, combination, formulas).ok());
        (found.as_ref().map(Recovered::chi), found.as_ref().map(Recovered::bending))
    };
    let printed = get(Formulas::Printed, Combination::SlopeDimple);
    let corrected = get(Formulas::Corrected, Combination::KneeDimple);
    let soft = |name: &str, formulas| {
        let t = of.get(name)?;
        let found = estimates::recover(t, Combination::SlopeUpturn, formulas).ok()?;
        Some(found.chi() / t.chi())
    };
    let point = "(33) is the law of a point load: between plates it makes the shell several times too thick";
    vec![
        row("slope and (33) give back χ = 51 N/m of the hard shell", "χ by the printed formulas, N/m", point)
            .near(LAW, 51.0, printed.0),
        row("slope and (33) give back k_b = 3.4e-15 N m", "k_b by the printed formulas, 1e-15 N m", point)
            .near(LAW, 3.4, printed.1.map(|k| k * 1e15)),
        row(
            "a combination of two regimes gives back χ = 51 N/m of the hard shell",
            "χ by force at the knee and the plate's square-root law, N/m",
            "with the law of the plate, and where it does not matter from where the deformation counts",
        )
        .ours()
        .near(LAW, 51.0, corrected.0),
        row(
            "fitting (32) and (39) gives χ very similar to that of the simulation (caption)",
            "χ by the printed formulas over the true one",
            "the cubic law is two to three times too strong",
        )
        .near(LAW, 1.0, soft("soft-caption", Formulas::Printed)),
        row(
            "fitting (32) and (39) gives χ very similar to that of the simulation (text)",
            "χ by the printed formulas over the true one",
            "the upturn is hardly developed here, so that its cubic part cannot be told from the linear one",
        )
        .near(LAW, 1.0, soft("soft-text", Formulas::Printed)),
    ]
}

/// Fig. 14.
pub(super) fn bending(of: &Branches<'_>) -> Vec<Claim> {
    let row = |statement, measured, why| Row::new(14, statement, measured, why);
    let names = ["b-2.7e-5", "b-2.7e-4", "b-2.7e-3", "b-2.7e-2"];
    let onset: Option<Vec<f64>> = names.iter().map(|n| steeper(of.get(n)?, 1.5)).collect();
    let grows = onset.map(|o| o.windows(2).map(|p| p[1] - p[0]).fold(f64::INFINITY, f64::min));
    let soft = of.get("b-2.7e-5");
    vec![
        row(
            "the standard slope of 8 for the stiffest shell, P_A = 3",
            "chord of the first 0.05 R0",
            "finite bending stiffness and the film both make it softer",
        )
        .near(SLOPE, 8.0, of.get("b-2.7e-2").and_then(|t| slope(t, 0.0, 0.05))),
        row(
            "as k_b increases the linear regime extends to larger deformations",
            "least growth of the deformation at which the slope is 1.5 times the first, R0",
            "it grows from each of the four shells to the next",
        )
        .above(0.0, grows),
        row(
            "buckling is bypassed even for the smallest k_b (P_A = 3)",
            "number of folds",
            "the gas keeps the cap up",
        )
        .exactly(0.0, soft.and_then(folds)),
        row(
            "buckling is bypassed even for the smallest k_b (P_A = 0.3)",
            "number of folds",
            "at a tenth of the pressure the most flexible shell still snaps; the paper does not show it",
        )
        .exactly(0.0, of.get("a-2.7e-5").and_then(folds)),
        row(
            "stretching dominates over gas and bending (k_b = 2.7e-5, P_A = 3)",
            "stretching over the larger of both at Δ/R0 = 0.3",
            "thin as it is, the shell is stretched all over",
        )
        .above(1.0, soft.and_then(|t| energies(t, 0.3, |s| {
            let o = &s.observation;
            o.energy_stretching / o.energy_bending.max(o.energy_gas)
        }))),
    ]
}

/// Fig. 15.
pub(super) fn adhesion(of: &Branches<'_>) -> Vec<Claim> {
    let row = |statement, measured, why| Row::new(15, statement, measured, why);
    let at = |name: &str, d| of.get(name).and_then(|t| force(t, d));
    let ratio = |a: Option<f64>, b: Option<f64>| a.zip(b).map(|(a, b)| a / b);
    let pull = |name: &str| of.get(name).and_then(pull_off);
    let count = |name: &str| of.get(name).and_then(folds);
    let first = |name: &str| of.get(name).and_then(|t| slope(t, 0.0, 0.02));
    vec![
        row(
            "two limit points generate a hysteresis loop (W0 = 2e-2)",
            "number of folds",
            "snap-in on approach, snap-off on retraction",
        )
        .exactly(2.0, count("2e-2")),
        row("… and for W0 = 5e-2", "number of folds", "the same, farther out")
            .exactly(2.0, count("5e-2")),
        row(
            "weak adhesion, W0 = 2e-3: no limit points",
            "number of folds",
            "attraction without a turn; the paper says of strong adhesion only that there are some",
        )
        .ours()
        .exactly(0.0, count("2e-3")),
        row(
            "the maximum attraction increases significantly with W0",
            "pull-off at 2e-2 over that at 2e-3",
            "twice counts as significant",
        )
        .bounded(MUCH, ratio(pull("2e-2"), pull("2e-3"))),
        row(
            "… and is much larger for W0 = 5e-2",
            "pull-off at 5e-2 over that at 2e-2",
            "twice counts as much larger",
        )
        .bounded(MUCH, ratio(pull("5e-2"), pull("2e-2"))),
        row(
            "W0 = 2e-4 does not significantly differ from 2e-3 in compression",
            "force at 2e-4 over that at 2e-3, Δ/R0 = 0.2",
            "once pressed on, the shell hardly feels so weak a film",
        )
        .near(SAME, 1.0, ratio(at("2e-4", 0.2), at("2e-3", 0.2))),
        row(
            "W0 = 2e-2 requires a higher force for the same deformation",
            "force at 2e-2 over that at 2e-3, Δ/R0 = 0.2",
            "deformation counts from a shell that is flattened already",
        )
        .above(1.0, ratio(at("2e-2", 0.2), at("2e-3", 0.2))),
        row(
            "an almost quadratic pattern (W0 = 2e-2)",
            "power of the deformation at Δ/R0 = 0.2",
            "it passes through the square on the way from linear to cubic",
        )
        .near(ALMOST, 2.0, of.get("2e-2").and_then(|t| power(t, 0.2))),
        row(
            "strong adhesion: a slope larger than Reissner's (W0 = 5e-2)",
            "chord of the first 0.02 R0",
            "the contact area grows instead of the pressure",
        )
        .above(8.0, first("5e-2")),
    ]
}

/// Fig. 16.
pub(super) fn stronger_adhesion(of: &Branches<'_>) -> Vec<Claim> {
    let row = |statement, measured, why| Row::new(16, statement, measured, why);
    let Some(t) = of.get("strong") else { return Vec::new() };
    vec![
        row(
            "stretching and the interaction potential dominate",
            "the smaller of both over the larger of bending and gas at Δ/R0 = 0.2",
            "the wide contact area stores the one and pays with the other",
        )
        .above(
            1.0,
            energies(t, 0.2, |s| {
                let o = &s.observation;
                let lesser = o.energy_stretching.min(o.energy_film.abs());
                lesser / o.energy_bending.max(o.energy_gas)
            }),
        ),
        row(
            "gas compression gains importance over bending",
            "gas over bending at Δ/R0 = 0.3, over the same at 0.1",
            "bending grows with the rim, the gas with the volume that is lost",
        )
        .above(1.0, {
            let share =
                |d| energies(t, d, |s| s.observation.energy_gas / s.observation.energy_bending);
            share(0.3).zip(share(0.1)).map(|(late, early)| late / early)
        }),
        row(
            "the contact area grows without a dimple",
            "depth of the pole below the highest point at Δ/R0 = 0.3, R0",
            "the film holds the shell at the plate",
        )
        .bounded(FLAT, dimple(t, 0.3)),
    ]
}

/// Fig. 17.
pub(super) fn strongest_adhesion(of: &Branches<'_>) -> Vec<Claim> {
    let row = |statement, measured, why| Row::new(17, statement, measured, why);
    let Some(t) = of.get("strong") else { return Vec::new() };
    vec![
        row(
            "the load almost vanishes in the contact region",
            "pressure at the pole over the largest at Δ/R0 = 0.1",
            "a fifth is taken for almost nothing",
        )
        .bounded(VANISHES, pressure(t, 0.1).map(|p| p.0.abs())),
        row(
            "an almost linear response",
            "power of the deformation at Δ/R0 = 0.05",
            "linear at first",
        )
        .near(ALMOST, 1.0, power(t, 0.05)),
        row(
            "an almost linear response",
            "power of the deformation at Δ/R0 = 0.1",
            "halfway to the square already",
        )
        .near(ALMOST, 1.0, power(t, 0.1)),
        row(
            "an almost linear response",
            "power of the deformation at Δ/R0 = 0.2",
            "beyond the square: the gas resists here too",
        )
        .near(ALMOST, 1.0, power(t, 0.2)),
    ]
}

/// Fig. 18.
pub(super) fn surface_tension(of: &Branches<'_>) -> Vec<Claim> {
    let row = |statement, measured, why| Row::new(18, statement, measured, why);
    let at = |name: &str| of.get(name).and_then(|t| force(t, 0.2));
    let ratio = |a: &str, b: &str| at(a).zip(at(b)).map(|(a, b)| a / b);
    let gas =
        |name: &str| of.get(name).and_then(|t| energies(t, 0.3, |s| s.observation.energy_gas));
    let linear = |name: &str| of.get(name).and_then(|t| steeper(t, 1.5));
    let cubic = |from| of.get("8e-2").and_then(|t| power_beyond(t, from, 0.38));
    let less = linear("0.0").zip(linear("8e-2")).map(|(a, b)| b / a);
    vec![
        row(
            "surface tension 8e-2 increases the required force",
            "force over that without, Δ/R0 = 0.2",
            "the gas starts at a higher pressure",
        )
        .above(1.0, ratio("8e-2", "0.0")),
        row(
            "… significantly so at 8e-1",
            "force over that at 8e-2, Δ/R0 = 0.2",
            "twice counts as significant",
        )
        .bounded(MUCH, ratio("8e-1", "8e-2")),
        row(
            "gas compression becomes more energy consuming",
            "energy of the gas at 8e-2 over that without, Δ/R0 = 0.3",
            "its pressure has the capillary part from the start",
        )
        .above(1.0, gas("8e-2").zip(gas("0.0")).map(|(a, b)| a / b)),
        row(
            "the validity of the Reissner regime shrinks (8e-2)",
            "deformation at which the slope is 1.5 times the first, over that without",
            "the upturn starts earlier",
        )
        .below(1.0, less),
        row(
            "8e-2: a cubic response for large deformations",
            "power of the force beyond the linear one, from Δ/R0 = 0.2 to 0.38",
            "the power grows along the curve, and the window decides",
        )
        .near(POWER, 3.0, cubic(0.2)),
        row(
            "8e-2: a cubic response for large deformations",
            "power of the force beyond the linear one, from Δ/R0 = 0.3 to 0.38",
            "at the largest deformations only",
        )
        .near(POWER, 3.0, cubic(0.3)),
        row(
            "8e-1: an almost quadratic or even linear form",
            "power of the deformation at Δ/R0 = 0.2",
            "between linear and quadratic, and growing",
        )
        .one_of(ALMOST, &[1.0, 2.0], of.get("8e-1").and_then(|t| power(t, 0.2))),
    ]
}

/// Fig. 19.
pub(super) fn weak_tension(of: &Branches<'_>) -> Vec<Claim> {
    let row = |statement, measured, why| Row::new(19, statement, measured, why);
    let Some(t) = of.get("tense") else { return Vec::new() };
    vec![
        row(
            "the shape evolves as without surface tension: it remains flat",
            "depth of the pole below the highest point at Δ/R0 = 0.38, R0",
            "the gas keeps the cap up",
        )
        .bounded(FLAT, dimple(t, 0.38)),
        row(
            "a larger contribution of volume compression than without: the gas over bending",
            "gas over bending at Δ/R0 = 0.3",
            "it stays below bending in Fig. 7; the capillary pressure lifts it above",
        )
        .above(1.0, energies(t, 0.3, |s| s.observation.energy_gas / s.observation.energy_bending)),
    ]
}

/// Fig. 20.
pub(super) fn strong_tension(of: &Branches<'_>) -> Vec<Claim> {
    let row = |statement, measured, why| Row::new(20, statement, measured, why);
    let Some(t) = of.get("tense") else { return Vec::new() };
    vec![
        row(
            "a strong and almost flat repulsive force within the contact region",
            "pressure at the pole over the largest at Δ/R0 = 0.3",
            "the film carries the capillary pressure",
        )
        .above(0.8, pressure(t, 0.3).map(|p| p.0)),
        row(
            "… even at nearly zero deformation",
            "pressure at the pole at Δ/R0 = 0.02 over that at 0.3",
            "the capillary pressure is there from the start",
        )
        .above(
            0.5,
            t.state(0.02, 1).zip(t.state(0.3, 1)).and_then(|(a, b)| {
                let at = |s| Some(*t.profile(s, 11)?.disjoining_pressure.first()?);
                Some(at(&a)? / at(&b)?)
            }),
        ),
    ]
}
