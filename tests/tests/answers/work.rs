//! Work, energy and the folds of the hard shell with strong adhesion.

use crate::{contact, trace, zero_force};
use continuation::{EventKind, Watch};
use shell_contact::{ContactProblem, Mesh};

/// Fig. 12.
fn hard_shell(elements: usize) -> ContactProblem {
    contact(Mesh::uniform(elements).unwrap(), 0.5, [3e-5, 3e-3, 2e-3, 1.0 / 30.0, 0.0, 1.07])
}

/// Snap to and from contact: deformation and force at the two folds, at every step length.
#[test]
fn folds_of_the_hard_shell_lie_where_they_are_known_to() {
    let problem = hard_shell(400);
    let mut first: Option<Vec<[f64; 2]>> = None;
    for max_step in [2e-3, 1e-2, 1e-1] {
        let branch = trace(&problem, 1.15, 0.68, Some(max_step), &[Watch::zero("force")]);
        let z = branch.events_of(&EventKind::Zero("force".to_owned())).count();
        assert_eq!(z, 1);
        let rest = zero_force(&branch);
        let folds: Vec<[f64; 2]> = branch
            .events_of(&EventKind::Fold)
            .map(|e| [rest - e.p, branch.points[e.point].observables[0]])
            .collect();
        let counts: Vec<_> = branch
            .events_of(&EventKind::Fold)
            .map(|e| (e.unstable_before, e.unstable_after))
            .collect();
        println!("{max_step}: {} points, {folds:?} {counts:?}", branch.points.len());
        assert_eq!(counts, [(Some(0), Some(1)), (Some(1), Some(0))]);
        for (fold, [d, force]) in folds.iter().zip([[0.0814, 2.698], [0.0269, 0.741]]) {
            assert!((fold[0] - d).abs() < 5e-5 && (fold[1] - force).abs() < 5e-4, "{fold:?}");
        }
        let first = first.get_or_insert_with(|| folds.clone());
        for (a, b) in folds.iter().flatten().zip(first.iter().flatten()) {
            assert!((a - b).abs() < 1e-8, "{a} {b}");
        }
    }
}

/// `dU_T = −2√k_b F̂ dz0` by the trapezoidal rule, through both folds: second order.
#[test]
fn energy_changes_by_the_work_of_the_plates_through_both_folds() {
    let problem = hard_shell(200);
    let scale = problem.groups().bending.sqrt();
    let runs = [8e-3, 4e-3, 2e-3, 1e-3].map(|max_step| {
        let branch = trace(&problem, 1.15, 0.68, Some(max_step), &[]);
        assert_eq!(branch.events_of(&EventKind::Fold).count(), 2);
        let mut error = 0.0;
        for pair in branch.points.windows(2) {
            let [a, b] = [&pair[0], &pair[1]];
            let work = -scale * (a.observables[0] + b.observables[0]) * (b.p - a.p);
            error += (b.observables[4] - a.observables[4] - work).abs();
        }
        let size = branch.points.iter().fold(0.0_f64, |m, q| m.max(q.observables[4].abs()));
        (error / size, branch.points.len())
    });
    let orders = [0, 1, 2].map(|k| (runs[k].0 / runs[k + 1].0).log2());
    println!("{runs:?}, orders {orders:.2?}");
    assert!(runs[3].0 < 1e-4 && orders[2] > 1.7, "{runs:?}");
}
