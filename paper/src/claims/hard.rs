//! What the paper says of hard shells.

use super::knee::{Knee, knee};
use super::measure::{
    complete, dimple, energies, film_share, fold, folds, force, least_slope, power, power_without,
    pressure, slope,
};
use super::stability::{Buckled, buckled, first_waves, most};
use super::tolerance::{
    DIFFERENT, FLAT, LAW, LIMIT_POINT, ORDER, POWER, ROUGHLY, SAME, SLOPE, VANISHES,
};
use super::{Branches, Claim, Row};
use crate::laws;
use crate::manifest::Law;
use crate::number::short;

/// Fig. 5.
pub(super) fn measured_shells(of: &Branches<'_>) -> Vec<Claim> {
    let row = |statement, measured, why| Row::new(5, statement, measured, why);
    let (elsner, bubble) = (of.get("elsner"), of.get("abou-saleh"));
    let nm = |d: f64| elsner.map(|t| d * 1e-9 / t.radius());
    let bend = elsner.and_then(|t| Some(knee(t)?.half * t.radius() * 1e9));
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
        .near(ROUGHLY, 52.0, bend),
        row(
            "force at the knee (drawn, not stated)",
            "force at 52 nm, nN",
            "the paper gives no number; ours can be held beside the drawing",
        )
        .ours()
        .open(at_52),
        row(
            "the curve initially exhibits a linear response (Reissner's slope 8)",
            "chord of the first 20 nm, F/√(χk_b) per Δ/R0",
            "a film thinner than the shell hardly shows in the first slope",
        )
        .near(SLOPE, 8.0, first),
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
        .bounded(FLAT, flat),
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
    let row = |statement, measured, why| Row::new(6, statement, measured, why);
    let Some(t) = of.get("hard") else { return Vec::new() };
    let late = knee(t).map(|k| 2.0 * k.half);
    let thinned = |d| film_share(t, d);
    let film = t.branch.zero_force.map(|z0| z0 - 1.0);
    let stretching =
        |d| energies(t, d, |s| s.observation.energy_stretching / s.observation.energy_bending);
    let gas = |d| {
        energies(t, d, |s| {
            let o = &s.observation;
            o.energy_gas / o.energy_stretching.max(o.energy_bending)
        })
    };
    let waves = first_waves(t);
    let round = waves.map_or(f64::NAN, |loss| loss.from);
    let lost = waves.map_or("no waves around the axis were found".to_owned(), |loss| {
        format!("the circular shape is lost to {} waves at Δ/R0 = {}", loss.n, short(loss.from))
    });
    let order = "finally the energy of the gas becomes of the same order as the elastic ones";
    let root = "buckled shapes: F grows as Δ^(1/2) (Pogorelov)";
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
            order,
            "gas over the larger of stretching and bending at Δ/R0 = 0.4, where Fig. 6(g) ends",
            &format!("for a shell that is kept round: {lost}"),
        )
        .near(ORDER, 1.0, gas(0.4)),
        row(
            order,
            &format!(
                "gas over the larger of stretching and bending at Δ/R0 = {}, the last stable state",
                short(round)
            ),
            &lost,
        )
        .near(ORDER, 1.0, waves.and_then(|loss| gas(loss.from))),
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
        .bounded(VANISHES, pressure(t, 0.1).map(|p| p.0.abs())),
        row(
            root,
            "power of the deformation at twice the knee",
            "as Δ is counted, from zero force: the film takes a part of it",
        )
        .near(POWER, 0.5, late.and_then(|d| power(t, d))),
        row(
            root,
            &format!(
                "power of the height that the shell has lost, Δ less the {} R0 by which the film \
                 thins, at twice the knee",
                short(late.and_then(thinned).unwrap_or(f64::NAN))
            ),
            "the film that is left lies on the rim of the dimple",
        )
        .near(POWER, 0.5, late.and_then(|d| power_without(t, d, thinned))),
        row(
            root,
            &format!(
                "power of R0 − z0, Δ less the {} R0 between plate and round shell at zero force, at \
                 twice the knee",
                short(film.unwrap_or(f64::NAN))
            ),
            "as if there were no film",
        )
        .near(POWER, 0.5, late.and_then(|d| power_without(t, d, |_| film))),
        row(
            "Eq. (33) describes the force on the buckled shell",
            "computed force over Eq. (33) at Δ/R0 = 0.15",
            "(33) is the law of a point load; a plate pushes on the rim of the dimple",
        )
        .near(
            LAW,
            1.0,
            force(t, 0.15).map(|f| f / laws::force(Law::PrintedPogorelov, &t.problem, 0.15)),
        ),
        row(
            "flat and buckled shapes are one stable branch",
            "most unstable modes of every kind from zero force to Δ/R0 = 0.4, plates fixed",
            &format!("no fold and no branch point between them, but {lost}"),
        )
        .ours()
        .exactly(0.0, most(t, 0.4)),
    ]
}

/// Fig. 10.
pub(super) fn bending(of: &Branches<'_>) -> Vec<Claim> {
    let row = |statement, measured, why| Row::new(10, statement, measured, why);
    let bend = |name: &str| of.get(name).and_then(knee);
    let in_h = |name: &str, reading: fn(&Knee) -> Option<f64>| {
        Some(reading(&bend(name)?)? / of.get(name)?.thickness())
    };
    let half: fn(&Knee) -> Option<f64> = |k| Some(k.half);
    let chord = |name: &str| bend(name).map(|k| k.force / k.half);
    let same = bend("a-3e-5").zip(bend("b-3e-5")).map(|(a, b)| b.half / a.half);
    let root = bend("b-3e-4").and_then(|k| Some(k.half / of.get("b-3e-4")?.bending().sqrt()));
    let stiff = of.get("a-3e-3");
    let secant = |d: f64| stiff.and_then(|t| Some(force(t, d)? / d));
    let straight = secant(0.35).zip(secant(0.05));
    let knee_of = "the linear regime is valid until d is on the order of 2.5 h/R0 (k_b = 3e-5)";
    vec![
        row(
            knee_of,
            "deformation where the slope is half of its largest, h",
            "2.5 h/R0 is the knee of a thin film; this film of two thicknesses thins as well",
        )
        .near(ORDER, 2.5, in_h("a-3e-5", half)),
        row(
            knee_of,
            "deformation at the strongest curvature of F̂ over d̂, h",
            "nearly the same place",
        )
        .near(ORDER, 2.5, in_h("a-3e-5", |k| Some(k.sharpest))),
        row(
            knee_of,
            "deformation where the slope is back at 8, h",
            "the slope is above Reissner's before the knee",
        )
        .near(ORDER, 2.5, in_h("a-3e-5", |k| k.reissner)),
        row(
            "the linear regime is valid until d is on the order of 2.5 h/R0 (k_b = 3e-4)",
            "deformation where the slope is half of its largest, h",
            "the film is thinner than this shell and adds less",
        )
        .near(ORDER, 2.5, in_h("a-3e-4", half)),
        row(
            "2.5 h/R0 ≈ 7.5 (k_b/χR0²)^(1/2) at P_A = 3e-4 too (k_b = 3e-4)",
            "deformation where the slope is half of its largest, over √k_b",
            "7.48 is the pitchfork of a shallow cap under a plate",
        )
        .near(ORDER, 7.5, root),
        row(
            "F/√(χk_b) has the fixed slope 8 (k_b = 3e-5)",
            "chord from zero force to the knee",
            "first softer by the film, then stiffer than 8 by the plate: the chord is near 8",
        )
        .near(SLOPE, 8.0, chord("a-3e-5")),
        row(
            "F/√(χk_b) has the fixed slope 8 (k_b = 3e-4)",
            "chord from zero force to the knee",
            "the chord is near 8, though no part of the curve has this slope",
        )
        .near(SLOPE, 8.0, chord("a-3e-4")),
        row(
            "the buckling point remains the same for the same k_b at P_A = 3e-4",
            "knee at P_A = 3e-4 over that at 3e-3",
            "the gas does not resist before the knee",
        )
        .near(SAME, 1.0, same),
        row(
            "k_b = 3e-3 eliminates the post-buckling regime",
            "least slope over the largest one before it, to Δ/R0 = 0.35",
            "the slope never falls",
        )
        .above(0.5, stiff.and_then(|t| least_slope(t, 0.35))),
        row(
            "k_b = 3e-3: a linear response for the entire range",
            "F/d at Δ/R0 = 0.35 over that at 0.05",
            &straight.map_or("the branch ends before".to_owned(), |(late, early)| {
                format!("F/d rises from {} to {}", short(early), short(late))
            }),
        )
        .near(SAME, 1.0, straight.map(|(late, early)| late / early)),
    ]
}

/// Fig. 11.
pub(super) fn adhesion(of: &Branches<'_>) -> Vec<Claim> {
    let row = |statement, measured, why| Row::new(11, statement, measured, why);
    let weak = of.get("a-weak").and_then(knee);
    let strong = of.get("a-strong").and_then(|t| fold(t, 0));
    let ratio = strong.zip(weak).map(|(s, w)| (s.0 / w.half, s.1 / w.force));
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
    let row = |statement, measured, why| Row::new(12, statement, measured, why);
    let Some(t) = of.get("strong") else { return Vec::new() };
    let (first, second) = (fold(t, 0), fold(t, 1));
    let gap = t.state(0.05, 1).zip(t.state(0.05, 3)).map(|(flat, dimpled)| {
        (flat.observation.energy_total - dimpled.observation.energy_total) * 1e3
    });
    let late = buckled(t);
    let shape = late.as_ref();
    let range = |(from, to): (f64, f64)| format!("Δ/R0 = {} to {}", short(from), short(to));
    let falls = shape.map_or("not reached".to_owned(), |b| range(b.falls));
    let lost = shape.map_or("not reached".to_owned(), |b| {
        format!(
            "mirror symmetry is lost for {}, the circular shape to {} waves from Δ/R0 = {} on: a \
             plate held in place does not keep the state between two plates",
            range(b.mirror),
            b.waves.n,
            short(b.waves.from)
        )
    });
    let reading = "the paper reads its drawing to one or two digits";
    vec![
        row(
            "a limit point at d = 0.07",
            "deformation at the first fold",
            "outside the rounding of 0.07, on two meshes and in an independent solver; inside what \
             the second limit point is allowed",
        )
        .near(LIMIT_POINT, 0.07, first.map(|f| f.0)),
        row("… and F = 2.5", "force at the first fold", reading).near(
            LIMIT_POINT,
            2.5,
            first.map(|f| f.1),
        ),
        row("the branch turns down until d = 0.03", "deformation at the second fold", reading)
            .near(LIMIT_POINT, 0.03, second.map(|f| f.0)),
        row("… and F = 0.71", "force at the second fold", reading).near(
            LIMIT_POINT,
            0.71,
            second.map(|f| f.1),
        ),
        row("two limit points", "number of folds", "the part between them is unstable")
            .exactly(2.0, folds(t)),
        row(
            "the linear branch has the higher total energy after the buckling point",
            "total energy flat minus buckled at Δ/R0 = 0.05, 1e-3 χR0²",
            "the buckled state is the lower one",
        )
        .above(0.0, gap),
        row(
            "the post-buckling branch is expected to become unstable, its slope being negative",
            &format!(
                "fewest unstable modes of every kind where its force falls, {falls}, plates fixed"
            ),
            &lost,
        )
        .above(0.5, shape.map(|b| b.fewest)),
        row(
            "the post-buckling branch is expected to become unstable, its slope being negative",
            &format!(
                "share of that part, {falls}, where one dimple grows while the other heals, plates \
                 fixed"
            ),
            "two contacts are springs in series: where the force falls, one gives way to the other",
        )
        .above(0.9, shape.map(Buckled::share)),
        row(
            "the post-buckling branch loses its circular shape before its force falls",
            "deformation where the first waves begin, over that where the force begins to fall",
            "the paper's model is axisymmetric",
        )
        .ours()
        .below(1.0, shape.map(|b| b.waves.from / b.falls.0)),
    ]
}

/// Fig. 13.
pub(super) fn thick_shell(of: &Branches<'_>) -> Vec<Claim> {
    let row = |statement, measured, why| Row::new(13, statement, measured, why);
    let Some(t) = of.get("strong") else { return Vec::new() };
    let first = slope(t, 0.0, 0.02);
    vec![
        row(
            "buckling of the thicker shell is bypassed",
            "number of folds",
            "the branch goes on without a turn",
        )
        .exactly(0.0, folds(t)),
        row(
            "a nearly flat contact region is maintained",
            "depth of the pole below the highest point at Δ/R0 = 0.3, R0",
            "what the pole does under the plate decides",
        )
        .bounded(FLAT, if complete(t) { dimple(t, 0.3) } else { None }),
        row(
            "deviations from sphericity produce a different slope of the linear part",
            "chord of the first 0.02 R0, over Reissner's 8",
            "more than a tenth is different",
        )
        .bounded(DIFFERENT, first.map(|s| (s / 8.0).max(8.0 / s))),
    ]
}
