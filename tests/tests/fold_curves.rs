//! Fold curves of the shell in plate distance and adhesion: where folds are born, and what it costs.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

use continuation::codim2::{Curve, FoldCurve};
use continuation::{Branch, EventKind, Settings, StopReason, Watch};
use shell_contact::{ContactProblem, Dimensionless, Law, Mesh, Shell, trace_contact};
use std::ops::ControlFlow;

/// The shell of Fig. 16 of the reference paper.
fn shell(elements: usize) -> ContactProblem {
    let groups = Dimensionless {
        bending: 2.7e-3,
        pressure: 3.0,
        adhesion: 2e-2,
        film: 1.0 / 30.0,
        surface_tension: 0.0,
        gas_exponent: 1.07,
    };
    let shell = Shell { law: Law::MooneyRivlin { b: 1.0 }, poisson: 0.5 };
    ContactProblem::new(&shell, &groups, Mesh::uniform(elements).unwrap()).unwrap()
}

fn base(problem: &ContactProblem) -> Branch {
    let settings = Settings { target: Some(0.8), ..Settings::default() };
    trace_contact(problem, 1.3, settings, &mut |_| ControlFlow::Continue(())).unwrap().branch
}

fn follow(curve: &FoldCurve<'_>, max_step: Option<f64>) -> Curve {
    let settings = Settings { domain: Some((2e-3, 0.2)), max_step, ..Settings::default() };
    let bounds = [0.8, 1.3].map(|z0| Watch::stop_at("z0", z0));
    curve.trace(&settings, &bounds, &mut |_| ControlFlow::Continue(())).unwrap()
}

/// At a given length of steps, from both folds, the same cusp within its error estimates, at so many
/// Newton iterations a point.
#[test]
fn the_cusp_of_fig16_in_plate_distance_and_adhesion() {
    let problem = shell(400);
    let base = base(&problem);
    let folds: Vec<_> = base.events_of(&EventKind::Fold).collect();
    assert_eq!(folds.len(), 2);
    let (mut heights, mut estimates) = (Vec::new(), Vec::new());
    let mut work = f64::INFINITY;
    for (fold, max_step) in folds.iter().zip([None, Some(0.02)]) {
        let curve = FoldCurve::at(&problem, &base, fold, "adhesion").unwrap();
        let found = follow(&curve, max_step);
        let points = found.branch.points.len();
        let iterations = found.branch.statistics.newton_iterations;
        work = work.min(iterations as f64 / points as f64);
        assert!(points > 40);
        let z0 = found.column("z0").unwrap();
        let cusps: Vec<_> = found.branch.events_of(&EventKind::Cusp).collect();
        assert_eq!(cusps.len(), 1);
        let cusp = cusps[0];
        println!("cusp {:.13} {:.13e} ±{:.1e}", z0[cusp.point], cusp.p, cusp.error_estimate);
        assert!((z0[cusp.point] - 1.088_458_29).abs() < 2e-8);
        assert!((cusp.p - 6.497_57e-3).abs() < 2e-9);
        heights.push(found.column("pole_height").unwrap()[cusp.point]);
        estimates.push(cusp.error_estimate);
        let ends = [found.first_end.reason, found.branch.stopped.reason];
        assert!(ends.contains(&StopReason::Target) && ends.contains(&StopReason::Domain));
    }
    println!("{work:.1} Newton iterations a point, pole heights {heights:?}");
    assert!(work < 3.0, "{work} Newton iterations a point");
    // the pole moves more than the length in which errors are measured
    let apart = (heights[0] - heights[1]).abs();
    assert!(apart < 30.0 * (estimates[0] + estimates[1]), "{apart} {estimates:?}");
    assert!(estimates.iter().all(|e| *e < 1e-7));
}

/// The finer the mesh, the more rounding does a curve of folds suffer, most of all at the cusp: corrections end at 1e-8 or
/// so, far above the tolerance, and slopes of tests are noise. From either fold and at steps of any length it is the same
/// cusp within the errors, at a like cost.
#[test]
fn rounding_does_not_end_fold_curves_on_fine_meshes() {
    for elements in [100, 300, 400, 600] {
        let problem = shell(elements);
        let base = base(&problem);
        let mut cusps = Vec::new();
        for fold in base.events_of(&EventKind::Fold) {
            for max_step in [None, Some(0.05), Some(0.02)] {
                let curve = FoldCurve::at(&problem, &base, fold, "adhesion").unwrap();
                let found = follow(&curve, max_step);
                let what = format!("{elements} elements, steps to {max_step:?}");
                let reasons = [found.first_end.reason, found.branch.stopped.reason];
                assert!(reasons.contains(&StopReason::Target), "{what}: {reasons:?}");
                assert!(reasons.contains(&StopReason::Domain), "{what}: {reasons:?}");
                let iterations = found.branch.statistics.newton_iterations;
                assert!(iterations < 600, "{what}: {iterations} iterations");
                let found_here: Vec<_> = found.branch.events_of(&EventKind::Cusp).collect();
                assert_eq!(found_here.len(), 1, "{what}");
                let cusp = found_here[0];
                let at = |name: &str| found.column(name).unwrap()[cusp.point];
                cusps.push((what, [at("z0"), cusp.p], cusp.error_estimate));
            }
        }
        for (what, place, error) in &cusps {
            for (_, other, its_error) in &cusps {
                for (a, b) in place.iter().zip(other) {
                    let off = (a - b).abs();
                    assert!(off <= error + its_error, "{what}: {off:e}, {error:e} {its_error:e}");
                }
            }
        }
    }
}
