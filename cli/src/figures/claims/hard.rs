//! What the paper says of hard shells.

use super::measure::{
    complete, dimple, energies, fold, folds, force, knee, least_slope, power, pressure, slope,
    unstable,
};
use super::{Branches, Claim, Row};
use continuation::EventKind;

/// Fig. 5.
pub(super) fn measured_shells(of: &Branches<'_>) -> Vec<Claim> {
    let row = |statement, measured, why| Row { figure: 5, statement, measured, why };
    let (elsner, bubble) = (of.get("elsner"), of.get("abou-saleh"));
    let nm = |d: f64| elsner.map(|t| d * 1e-9 / t.radius());
    let bend = elsner.and_then(|t| Some(knee(t)?.0 * t.radius() * 1e9));
    let at_52 = elsner.and_then(|t| Some(force(t, nm(52.0)?)? * t.force_unit() * 1e9));
    let first = elsner.and_then(|t| slope(t, 0.0, nm(20.0)?));
    let turns = elsner
        .and_then(|t| Some(slope(t, nm(180.0)?, nm(200.0)?)? / slope(t, nm(70.0)?, nm(90.0)?)?));
    let flat = bubble.and_then(|t| dimple(t, 0.85e-6 / t.radius()));
    let upward = bubble.and_then(|t| power(t, 0.82e-6 / t.radius()));
    vec![
        row(
            "around Δ = 52 nm we observe transition to the non-linear regime",
            "deformation where the slope has fallen to half its largest value, nm",
            "the knee of the computed curve lies where the paper has it",
        )
        .near(52.0, bend, 0.06),
        row(
            "force at the knee (drawn, not stated)",
            "force at 52 nm, nN",
            "the paper gives no number; ours can be held beside the drawing",
        )
        .open(at_52),
        row(
            "the curve initially exhibits a linear response (Reissner's slope 8)",
            "chord of the first 20 nm, F/√(χk_b) per Δ/R0",
            "a film thinner than the shell hardly shows in the first slope",
        )
        .near(8.0, first, 0.1),
        row(
            "at relatively high deformations the response is slightly curved upwards",
            "slope at 190 nm over that at 80 nm",
            "the gas resists",
        )
        .above(1.0, turns),
        row(
            "lipid bubble: buckling is bypassed, the pole area remains flattened",
            "depth of the pole below the highest point at 2Δ = 1.7 μm, R0",
            "a slight hollow, no crater",
        )
        .below(0.02, flat),
        row(
            "lipid bubble: a strong curved upwards regime",
            "power of the deformation at 2Δ = 1.64 μm",
            "the force grows faster than its square",
        )
        .above(1.5, upward),
    ]
}

/// Fig. 6.
pub(super) fn weak_adhesion(of: &Branches<'_>) -> Vec<Claim> {
    let row = |statement, measured, why| Row { figure: 6, statement, measured, why };
    let Some(t) = of.get("hard") else { return Vec::new() };
    let bend = knee(t);
    let stretching =
        |d| energies(t, d, |s| s.observation.energy_stretching / s.observation.energy_bending);
    let gas = energies(t, 0.4, |s| {
        let o = &s.observation;
        o.energy_gas / (o.energy_stretching + o.energy_bending)
    });
    vec![
        row(
            "in the linear regime stretching is the dominant component",
            "stretching over bending at Δ/R0 = 0.03",
            "the flat cap is compressed more than it is bent",
        )
        .above(1.0, stretching(0.03)),
        row(
            "after the buckling point an exchange in favour of bending",
            "bending over stretching at Δ/R0 = 0.1",
            "the reversed cap is free of compression, the rim is bent",
        )
        .above(1.0, stretching(0.1).map(f64::recip)),
        row(
            "finally the energy of the gas becomes of the same order as the elastic ones",
            "gas over elastic energy at Δ/R0 = 0.4",
            "a tenth counts as the same order",
        )
        .above(0.1, gas),
        row(
            "the load is first a point load at the pole",
            "distance of the largest pressure from the axis at Δ/R0 = 0.01, R0",
            "the largest pressure is at the pole",
        )
        .below(0.01, pressure(t, 0.01).map(|p| p.1)),
        row(
            "when buckling takes place the pressure is essentially applied around a ring",
            "pressure at the pole over the largest at Δ/R0 = 0.1",
            "nothing presses on the crater",
        )
        .below(0.01, pressure(t, 0.1).map(|p| p.0.abs())),
        row(
            "buckled shapes: F grows as Δ^(1/2) (Pogorelov)",
            "power of the deformation at twice the knee",
            "so soon after the knee, with a film of two thicknesses, the power is larger; it comes \
             down to ½ for a thin film and deep dimples only",
        )
        .within(0.5, bend.and_then(|(d, _)| power(t, 2.0 * d)), 0.1),
        row(
            "Eq. (33) describes the force on the buckled shell",
            "computed force over Eq. (33) at Δ/R0 = 0.15",
            "(33) is the law of a point load; a plate pushes on the rim of the dimple",
        )
        .near(
            1.0,
            force(t, 0.15).map(|f| {
                f / crate::figures::laws::force(
                    crate::figures::manifest::Law::PrintedPogorelov,
                    &t.problem,
                    0.15,
                )
            }),
            0.2,
        ),
        row(
            "flat and buckled shapes are one stable branch",
            "most unstable modes at fixed plate distance",
            "no fold and no branch point between them",
        )
        .within(0.0, unstable(t, |_, _| true), 0.0),
    ]
}

/// Fig. 10.
pub(super) fn bending(of: &Branches<'_>) -> Vec<Claim> {
    let row = |statement, measured, why| Row { figure: 10, statement, measured, why };
    let bend = |name: &str| of.get(name).and_then(knee);
    let in_h = |name: &str| Some(bend(name)?.0 / of.get(name)?.thickness());
    let chord = |name: &str| bend(name).map(|(d, f)| f / d);
    let same = bend("a-3e-5").zip(bend("b-3e-5")).map(|(a, b)| b.0 / a.0);
    let root = bend("a-3e-4").and_then(|(d, _)| Some(d / of.get("a-3e-4")?.bending().sqrt()));
    let stiff = of.get("a-3e-3").and_then(|t| least_slope(t, 0.35));
    let order = "2.5 h/R0 is the knee of a thin film; this film of two thicknesses thins by 0.02 R0 \
                 more before the knee";
    vec![
        row(
            "the linear regime is valid until d is on the order of 2.5 h/R0 (k_b = 3e-5)",
            "deformation at the knee, h",
            order,
        )
        .near(2.5, in_h("a-3e-5"), 0.25),
        row(
            "the linear regime is valid until d is on the order of 2.5 h/R0 (k_b = 3e-4)",
            "deformation at the knee, h",
            "the film is thinner than this shell and adds less",
        )
        .near(2.5, in_h("a-3e-4"), 0.25),
        row(
            "2.5 h/R0 ≈ 7.5 (k_b/χR0²)^(1/2) (k_b = 3e-4)",
            "deformation at the knee over √k_b",
            "7.48 is the pitchfork of a shallow cap under a plate",
        )
        .near(7.5, root, 0.15),
        row(
            "F/√(χk_b) has the fixed slope 8 (k_b = 3e-5)",
            "chord from zero force to the knee",
            "first softer by the film, then stiffer than 8 by the plate: the chord is near 8",
        )
        .near(8.0, chord("a-3e-5"), 0.1),
        row(
            "F/√(χk_b) has the fixed slope 8 (k_b = 3e-4)",
            "chord from zero force to the knee",
            "the chord is near 8, though no part of the curve has this slope",
        )
        .near(8.0, chord("a-3e-4"), 0.1),
        row(
            "the buckling point remains the same for the same k_b at P_A = 3e-4",
            "knee at P_A = 3e-4 over that at 3e-3",
            "the gas does not resist before the knee",
        )
        .near(1.0, same, 0.02),
        row(
            "k_b = 3e-3 eliminates the post-buckling regime",
            "least slope over the largest one before it, to Δ/R0 = 0.35",
            "the slope never falls",
        )
        .above(0.5, stiff),
    ]
}

/// Fig. 11.
pub(super) fn adhesion(of: &Branches<'_>) -> Vec<Claim> {
    let row = |statement, measured, why| Row { figure: 11, statement, measured, why };
    let weak = of.get("a-weak").and_then(knee);
    let strong = of.get("a-strong").and_then(|t| fold(t, 0));
    let ratio = strong.zip(weak).map(|(s, w)| (s.0 / w.0, s.1 / w.1));
    let fold_or_knee = "at the fold with strong adhesion over that at the knee with weak";
    vec![
        row(
            "strong adhesion postpones buckling to higher deformations (k_b = 3e-5)",
            &format!("deformation {fold_or_knee}"),
            "the film holds the cap at the plate",
        )
        .above(1.0, ratio.map(|r| r.0)),
        row("… and to higher forces", &format!("force {fold_or_knee}"), "both in √(χk_b)")
            .above(1.0, ratio.map(|r| r.1)),
        row(
            "… and bypasses it for the thicker shell (k_b = 3e-4)",
            "least slope over the largest one before it, to Δ/R0 = 0.35",
            "neither a fold nor a knee",
        )
        .above(0.5, of.get("b-strong").and_then(|t| least_slope(t, 0.35))),
    ]
}

/// Fig. 12.
pub(super) fn strong_adhesion(of: &Branches<'_>) -> Vec<Claim> {
    let row = |statement, measured, why| Row { figure: 12, statement, measured, why };
    let Some(t) = of.get("strong") else { return Vec::new() };
    let (first, second) = (fold(t, 0), fold(t, 1));
    let gap = t.state(0.05, 1).zip(t.state(0.05, 3)).map(|(flat, dimpled)| {
        (flat.observation.energy_total - dimpled.observation.energy_total) * 1e3
    });
    let last = t.branch.branch.events_of(&EventKind::Fold).last().map_or(0, |e| e.point);
    let points = &t.branch.branch.points;
    let falls = |i: usize| {
        let next = (i + 1).min(points.len() - 1);
        points[next].p < points[i].p && t.observable(next, "force") < t.observable(i, "force")
    };
    let reading = "the paper reads its drawing to one or two digits";
    vec![
        row("a limit point at d = 0.07", "deformation at the first fold", "the fold of the computed branch lies farther, on two meshes and in an independent solver")
            .within(0.07, first.map(|f| f.0), 0.007),
        row("… and F = 2.5", "force at the first fold", reading).near(2.5, first.map(|f| f.1), 0.1),
        row("the branch turns down until d = 0.03", "deformation at the second fold", reading)
            .within(0.03, second.map(|f| f.0), 0.005),
        row("… and F = 0.71", "force at the second fold", reading).near(0.71, second.map(|f| f.1), 0.1),
        row("two limit points", "number of folds", "the part between them is unstable")
            .within(2.0, folds(t), 0.0),
        row(
            "the linear branch has the higher total energy after the buckling point",
            "total energy flat minus buckled at Δ/R0 = 0.05, 1e-3 χR0²",
            "the buckled state is the lower one",
        )
        .above(0.0, gap),
        row(
            "the post-buckling branch is expected to become unstable, its slope being negative",
            "most unstable modes on its falling part, at fixed plate distance",
            "a falling force is unstable under a dead load; a plate held in place keeps the state",
        )
        .above(0.5, unstable(t, |i, _| i > last && falls(i))),
    ]
}

/// Fig. 13.
pub(super) fn thick_shell(of: &Branches<'_>) -> Vec<Claim> {
    let row = |statement, measured, why| Row { figure: 13, statement, measured, why };
    let Some(t) = of.get("strong") else { return Vec::new() };
    let first = slope(t, 0.0, 0.02);
    vec![
        row(
            "buckling of the thicker shell is bypassed",
            "number of folds",
            "the branch goes on without a turn",
        )
        .within(0.0, folds(t), 0.0),
        row(
            "a nearly flat contact region is maintained",
            "depth of the pole below the highest point at Δ/R0 = 0.3, R0",
            "what the pole does under the plate decides",
        )
        .below(0.02, if complete(t) { dimple(t, 0.3) } else { None }),
        row(
            "deviations from sphericity produce a different slope of the linear part",
            "chord of the first 0.02 R0, over Reissner's 8",
            "more than a tenth is different",
        )
        .above(1.1, first.map(|s| (s / 8.0).max(8.0 / s))),
    ]
}
