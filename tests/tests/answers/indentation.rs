//! The dimple: where the flat cap gives way to it, and its force far beyond.

use crate::{contact, trace, zero_force};
use continuation::{Branch, EventKind, Matrix, Problem, Watch};
use shell_contact::asymptotics::{knee_deformation, knee_force, plate_pogorelov_force};
use shell_contact::contact::parameter::Z0;
use shell_contact::{ContactProblem, Mesh};

/// `−dF̂/dz0` along the branch.
fn stiffness(problem: &ContactProblem, branch: &Branch) -> Vec<f64> {
    let mut j = problem.new_jacobian();
    let mut du = vec![0.0; problem.dim()];
    branch
        .points
        .iter()
        .map(|q| {
            let p = problem.parameters_at(q.p);
            problem.jacobian(&q.u, &p, &mut j).unwrap();
            j.factor(f64::EPSILON * j.norm());
            problem.parameter_derivative(&q.u, &p, Z0, &mut du).unwrap();
            j.solve(&mut du);
            du.iter_mut().for_each(|x| *x = -*x);
            -problem.observable_slope(0, &q.u, &p, Z0, &du, 1.0).unwrap().unwrap()
        })
        .collect()
}

/// A thin film (`8W0 = 0.24δ_A²`, weak adhesion): half of the largest `dF/dΔ` is met at 7.64, 7.47, 7.53 `√k_b` for ever thinner films.
#[test]
fn flat_cap_gives_way_at_the_known_knee() {
    let thickness = 0.01_f64;
    let bending = thickness * thickness / 9.0;
    for (film, known, folds) in [(0.2, 7.64, 0), (0.05, 7.47, 0), (0.0125, 7.53, 2)] {
        let film = film * thickness;
        let adhesion = 0.03 * film * film / 8.0;
        let groups = [bending, 0.0, adhesion, film, 0.0, 1.07];
        let problem = contact(Mesh::graded(400, 6.0).unwrap(), 0.5, groups);
        let z = 1.0 - 11.0 * bending.sqrt();
        let branch = trace(&problem, 1.0 + 4.0 * film, z, Some(2e-4), &[Watch::zero("force")]);
        let rest = zero_force(&branch);
        let k = stiffness(&problem, &branch);
        // at a fold the slope is infinite: the largest one is sought well before
        let flat = |i: &usize| rest - branch.points[*i].p < 6.0 * bending.sqrt();
        let top = (0..k.len()).filter(flat).max_by(|&a, &b| k[a].total_cmp(&k[b])).unwrap();
        let half = 0.5 * k[top];
        let after = (top..k.len()).find(|&i| k[i] < half).expect("the knee");
        let share = (k[after - 1] - half) / (k[after - 1] - k[after]);
        let z = branch.points[after - 1].p
            + share * (branch.points[after].p - branch.points[after - 1].p);
        let knee = (rest - z) / bending.sqrt();
        println!(
            "film {film:.1e}: {} points, rest {rest:.6}, most {:.2}, knee {knee:.3}, events {:?}",
            branch.points.len(),
            k[top],
            branch.events.iter().map(|e| (e.kind.to_string(), e.p)).collect::<Vec<_>>()
        );
        assert_eq!(branch.events_of(&EventKind::Fold).count(), folds);
        assert!((knee / known - 1.0).abs() < 0.015, "{knee} {known}");
        let force = branch.points[after].observables[0] / knee_force(bending);
        println!("  force {force:.3} of the asymptotic one");
        assert!((force - 1.0).abs() < 0.08, "{force}");
        assert!((knee * bending.sqrt() / knee_deformation(bending) - 1.0).abs() < 0.015);
    }
}

/// Computed over asymptotic force 0.932, 0.954, 0.969 at Δ/h = 11.2, 21.4, 41.7.
#[test]
fn force_on_a_deep_dimple_approaches_the_plate_law() {
    let thickness = 1e-3_f64;
    let bending = thickness * thickness / 9.0;
    let deep = [(11.2, 0.932), (21.4, 0.954), (41.7, 0.969)];
    let runs = [0.1, 0.025].map(|film| {
        let film = film * thickness;
        let groups = [bending, 0.0, film * film / 8.0, film, 0.0, 1.07];
        let problem = contact(Mesh::graded(700, 5.0).unwrap(), 0.5, groups);
        // the free bubble floats about 0.7 film lengths below the plate
        let rest = 1.0 + 0.7 * film;
        let mut watches = vec![Watch::zero("force")];
        watches.extend(deep.map(|(d, _)| Watch::parameter(rest - d * thickness)));
        let branch = trace(&problem, 1.0 + 4.0 * film, 1.0 - 0.043, None, &watches);
        assert!((zero_force(&branch) - rest).abs() < 0.02 * film);
        let ratios: Vec<f64> = branch
            .events_of(&EventKind::Target)
            .map(|e| &branch.points[e.point])
            .map(|q| q.observables[0] / plate_pogorelov_force(bending, zero_force(&branch) - q.p))
            .collect();
        println!("film {film:e}: {} points, {ratios:.4?}", branch.points.len());
        assert_eq!(ratios.len(), 3);
        assert!(ratios.windows(2).all(|r| r[0] < r[1]) && ratios[2] < 1.0);
        ratios
    });
    for (k, (d, known)) in deep.into_iter().enumerate() {
        let [thick, thin] = [0, 1].map(|run| (runs[run][k] - known).abs());
        assert!(thick < 2e-3 && thin < 1e-3, "{d}: {thick:.1e} {thin:.1e}");
    }
}
