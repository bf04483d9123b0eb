//! The curve of Fig. 6 against collocation of the boundary-value problem.

use crate::{contact, trace};
use continuation::{EventKind, Watch};
use shell_contact::Mesh;
use std::f64::consts::PI;

/// `z0, F, V/V0` by AUTO-07p on the model written as a boundary-value problem (accuracy 2e-7),
/// physical parameters of Fig. 6.
const ROWS: [[f64; 3]; 14] = [
    [1.05, -0.00148593, 1.00000104],
    [1.01, 0.04899202, 0.99995911],
    [1.00, 0.13457528, 0.99982983],
    [0.99, 0.22873582, 0.99955337],
    [0.985, 0.27777771, 0.99933522],
    [0.98, 0.32646617, 0.99903857],
    [0.975, 0.36772677, 0.99860387],
    [0.97, 0.39322196, 0.99795221],
    [0.96, 0.43491916, 0.99620045],
    [0.92, 0.60714769, 0.98421210],
    [0.90, 0.68629959, 0.97516541],
    [0.875, 0.78165621, 0.96104429],
    [0.85, 0.87707652, 0.94388010],
    [0.83, 0.95594174, 0.92802034],
];
const ZERO_FORCE: f64 = 1.0234392;

/// The same curve at every step length: first contact, where the film stiffens within a few steps,
/// neither hides the zero of the force nor makes up a fold.
#[test]
fn fig_6_agrees_with_collocation_at_every_step_length() {
    let groups = [(25.0_f64 / 1500.0).powi(2) / 9.0, 2.895e-3, 1e-4 / 52.5, 1.0 / 30.0, 0.0, 1.07];
    let problem = contact(Mesh::uniform(400).unwrap(), 0.5, groups);
    let mut watches = vec![Watch::zero("force"), Watch::extremum("force")];
    watches.extend(ROWS[..13].iter().map(|row| Watch::parameter(row[0])));
    let mut pull_offs = Vec::new();
    for max_step in [1e-3, 1e-2, 1e-1] {
        let branch = trace(&problem, 1.3, 0.83, Some(max_step), &watches);
        let events = |kind: EventKind| branch.events_of(&kind).cloned().collect::<Vec<_>>();
        println!("max_step {max_step}: {} points, {:?}", branch.points.len(), branch.statistics);
        let zeros = events(EventKind::Zero("force".to_owned()));
        let minima = events(EventKind::Minimum("force".to_owned()));
        let folds = events(EventKind::Fold);
        assert_eq!((zeros.len(), minima.len(), folds.len()), (1, 1, 0), "{:?}", branch.events);
        assert_eq!(events(EventKind::Maximum("force".to_owned())).len(), 0);
        assert!((zeros[0].p - ZERO_FORCE).abs() < 1e-6, "{}", zeros[0].p);
        assert!(branch.points.iter().all(|q| q.unstable == Some(0)));
        pull_offs.push((minima[0].p, branch.points[minima[0].point].observables[0]));

        let targets = events(EventKind::Target);
        let mut worst = (0.0_f64, 0.0_f64);
        for [z0, force, volume] in ROWS {
            // the trace ends on the last row
            let hits: Vec<_> = targets.iter().filter(|e| (e.p - z0).abs() < 1e-12).collect();
            assert_eq!(hits.len(), usize::from(z0 > 0.83), "z0 = {z0}");
            let q = hits.first().map_or(branch.points.last().unwrap(), |e| &branch.points[e.point]);
            let p = problem.parameters_at(z0);
            let o = problem.observation(&q.u, &p).unwrap();
            assert_eq!(o.force, q.observables[0]);
            worst.0 = worst.0.max((o.force - force).abs());
            worst.1 = worst.1.max((o.volume / (4.0 * PI / 3.0) - volume).abs());
        }
        println!("  off by {:.1e} in the force, {:.1e} in the volume", worst.0, worst.1);
        println!("  pull-off {:?}, zero {}", pull_offs.last(), zeros[0].p);
        assert!(worst.0 < 1e-6 && worst.1 < 1e-6, "max_step {max_step}: {worst:?}");
    }
    for pull_off in &pull_offs {
        assert!((pull_off.0 - pull_offs[0].0).abs() < 1e-8, "{pull_offs:?}");
        assert!((pull_off.1 / pull_offs[0].1 - 1.0).abs() < 1e-10, "{pull_offs:?}");
    }
}
