//! Sign changes along the symmetric branch against an independent solver (second derivatives by
//! automatic differentiation, splines in `u, v, w`).

use crate::support::{contact, newton, walk, with_poisson};
use shell_contact::modes::{AsymmetricModes, Parity};
use shell_contact::{ContactProblem, Law};

/// Counts along a walk, and the onsets of one class between its points by bisection.
fn onsets(
    problem: &ContactProblem,
    range: (f64, f64),
    classes: &[(usize, Parity)],
) -> Vec<(usize, Parity, usize, usize, f64)> {
    let mut modes = AsymmetricModes::new(problem.mesh());
    let mut found = Vec::new();
    let mut count = |u: &[f64], z0: f64, n: usize, parity: Parity| {
        modes.assemble(problem, u, &problem.parameters_at(z0)).unwrap();
        modes.count(n, parity).negative
    };
    walk(problem, range.0, range.1, |a, b| {
        for &(n, parity) in classes {
            let (before, after) = (count(&a.u, a.z0, n, parity), count(&b.u, b.z0, n, parity));
            if before == after {
                continue;
            }
            // along the chord in z0; beside a fold the chord does not tell the states apart
            let (mut lo, mut hi) = (a.clone(), b.clone());
            while (hi.z0 - lo.z0).abs() > 1e-11 {
                let z0 = 0.5 * (lo.z0 + hi.z0);
                let mut u: Vec<f64> = lo.u.iter().zip(&hi.u).map(|(x, y)| 0.5 * (x + y)).collect();
                if newton(problem, &mut u, &problem.parameters_at(z0)).is_none() {
                    break;
                }
                let point = support_point(z0, u);
                let now = count(&point.u, z0, n, parity);
                if now == before { lo = point } else { hi = point }
            }
            found.push((n, parity, before, after, 0.5 * (lo.z0 + hi.z0)));
        }
    });
    found
}

fn support_point(z0: f64, u: Vec<f64>) -> crate::support::Point {
    crate::support::Point { z0, u }
}

#[track_caller]
fn expect(
    found: &[(usize, Parity, usize, usize, f64)],
    class: (usize, Parity),
    known: &[(usize, usize, f64)],
    tolerance: f64,
) {
    let own: Vec<_> = found.iter().filter(|f| (f.0, f.1) == class).collect();
    assert_eq!(own.len(), known.len(), "{class:?}");
    for (f, k) in own.iter().zip(known) {
        let tolerance = if k.2 == AT_FOLD { 1e-7 } else { tolerance };
        assert_eq!((f.2, f.3), (k.0, k.1), "{class:?}");
        assert!((f.4 - k.2).abs() < tolerance, "{class:?}: {} and {}", f.4, k.2);
    }
}

/// Loss of equatorial symmetry within 4e-8 of a fold, where steps in `z0` end early.
const AT_FOLD: f64 = 0.818761892820134;

const SYM: Parity = Parity::Symmetric;
const ANTI: Parity = Parity::Antisymmetric;

/// Strong adhesion of a hard shell: pull-off, snap-in, the buckled branch.
#[test]
fn hard_shell_with_strong_adhesion() {
    let problem = contact(200, Law::Hooke, [3e-5, 3e-3, 2e-3, 1.0 / 30.0, 0.0, 1.07]);
    let classes =
        [(0, ANTI), (1, SYM), (1, ANTI), (2, SYM), (2, ANTI), (3, SYM), (3, ANTI), (7, SYM)];
    let found = onsets(&problem, (1.15, 0.65), &classes);
    expect(
        &found,
        (0, ANTI),
        &[
            (1, 0, 1.030245113687822),
            (0, 1, AT_FOLD),
            (1, 0, 0.8730372462143192),
            (0, 1, 0.8218166095879053),
            (1, 0, 0.7779228617006498),
        ],
        1e-8,
    );
    expect(&found, (1, SYM), &[], 0.0);
    expect(&found, (1, ANTI), &[], 0.0);
    expect(&found, (2, SYM), &[(0, 1, 0.8704334063868676), (1, 0, 0.7286241415986777)], 1e-9);
    expect(&found, (2, ANTI), &[(0, 1, 0.8704425325991098), (1, 0, 0.7296262784277104)], 1e-9);
    expect(&found, (3, SYM), &[(0, 1, 0.8628900930917855)], 1e-9);
    expect(&found, (3, ANTI), &[(0, 1, 0.8628902730416855)], 1e-9);
    expect(&found, (7, SYM), &[(0, 1, 0.823360579745303)], 1e-9);
}

/// A soft shell loses its equatorial symmetry only.
#[test]
fn soft_shell_with_strong_adhesion() {
    let problem =
        contact(200, Law::MooneyRivlin { b: 1.0 }, [2.7e-3, 3.0, 2e-2, 1.0 / 30.0, 0.0, 1.07]);
    let found = onsets(&problem, (1.3, 0.62), &[(0, ANTI), (1, SYM), (1, ANTI), (2, SYM)]);
    expect(
        &found,
        (0, ANTI),
        &[(1, 0, 1.1408234754096622), (0, 1, 1.1125315324630451), (1, 0, 1.062917422394104)],
        1e-9,
    );
    for class in [(1, SYM), (1, ANTI), (2, SYM)] {
        expect(&found, class, &[], 0.0);
    }
}

/// Weak adhesion: four waves first, five just after.
#[test]
fn hard_shell_with_weak_adhesion() {
    let problem = contact(200, Law::Hooke, [3e-5, 3e-3, 2e-6, 1.0 / 30.0, 0.0, 1.07]);
    let found = onsets(&problem, (1.06, 0.78), &[(0, ANTI), (1, ANTI), (4, SYM), (5, SYM)]);
    expect(&found, (0, ANTI), &[(1, 0, 1.0333673738068547)], 1e-9);
    expect(&found, (1, ANTI), &[], 0.0);
    expect(&found, (4, SYM), &[(0, 1, 0.7832267306627115)], 3e-9);
    expect(&found, (5, SYM), &[(0, 1, 0.7830003322036003)], 3e-9);
}

/// A thin hard shell in vacuum: no false onset of one wave, where the material's rotation is
/// neutral to rounding; five waves first.
#[test]
fn thin_hard_shell() {
    let bending = 0.01_f64.powi(2) / (12.0 * (1.0 - 0.09));
    let problem = with_poisson(200, Law::Hooke, 0.3, [bending, 0.0, 5e-8, 2e-3, 0.0, 0.0]);
    let found = onsets(&problem, (1.012, 0.86), &[(0, ANTI), (1, SYM), (1, ANTI), (5, SYM)]);
    expect(&found, (0, ANTI), &[(1, 0, 1.0020072954066124)], 1e-9);
    expect(&found, (1, SYM), &[], 0.0);
    expect(&found, (1, ANTI), &[], 0.0);
    expect(&found, (5, SYM), &[(0, 1, 0.8697848249582948)], 1e-9);
}

/// The shell of Fig. 7, soft and with weak adhesion, loses its equatorial symmetry outside pull-off
/// and nothing else down to deep dimples.
#[test]
fn soft_shell_with_weak_adhesion() {
    let problem =
        contact(200, Law::MooneyRivlin { b: 1.0 }, [2.7e-3, 3.0, 2e-3, 1.0 / 30.0, 0.0, 1.07]);
    let mut classes = vec![(0, ANTI)];
    classes.extend((1..=8).flat_map(|n| [(n, SYM), (n, ANTI)]));
    let found = onsets(&problem, (1.2, 0.612), &classes);
    expect(&found, (0, ANTI), &[(1, 0, 1.0517484574897358)], 1e-9);
    assert_eq!(found.len(), 1, "{found:?}");
}

/// A thick hard shell (`R/h = 25`) in vacuum keeps its symmetry under the plate.
#[test]
fn thick_hard_shell() {
    let bending = 0.04_f64.powi(2) / (12.0 * (1.0 - 0.09));
    let problem = with_poisson(200, Law::Hooke, 0.3, [bending, 0.0, 8e-7, 8e-3, 0.0, 0.0]);
    let mut classes = vec![(0, ANTI)];
    classes.extend((1..=12).flat_map(|n| [(n, SYM), (n, ANTI)]));
    let found = onsets(&problem, (1.048, 0.5985), &classes);
    expect(&found, (0, ANTI), &[(1, 0, 1.0080307631144052)], 1e-9);
    assert_eq!(found.len(), 1, "{found:?}");
}
