//! Shells before a plate whose film is double layer and van der Waals: exact integrals, a second
//! formulation, work and energy, the limit of a rigid sphere, and the film that breaks.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use continuation::{Branch, EventKind, Problem, Settings, Tracer, Watch};
use shell_contact::asymptotics::derjaguin_pull_off;
use shell_contact::film::{Dlvo, Film, Potential};
use shell_contact::weak_form::balances;
use shell_contact::{ContactProblem, Dimensionless, Law, Mesh, Shell};
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// `[bending, pressure, adhesion, film]`.
fn shell(elements: usize, debye: f64, groups: [f64; 4]) -> ContactProblem {
    let [bending, pressure, adhesion, film] = groups;
    let groups = Dimensionless {
        bending,
        pressure,
        adhesion,
        film,
        surface_tension: 0.0,
        gas_exponent: 1.07,
    };
    let shell = Shell { law: Law::Hooke, poisson: 0.5 };
    let potential = Film::Dlvo(Dlvo::new(debye).unwrap());
    let mesh = Mesh::uniform(elements).unwrap();
    ContactProblem::with_potential(&shell, &groups, mesh, potential).unwrap()
}

/// Fig. 12 but for its potential.
const HARD: [f64; 4] = [3e-5, 3e-3, 2e-3, 1.0 / 30.0];

fn trace(problem: &ContactProblem, start: f64, end: f64, max_step: Option<f64>) -> Branch {
    let settings = Settings { target: Some(end), max_step, ..Settings::default() };
    let (u, p) = (problem.initial_state(), problem.parameters_at(start));
    Tracer::new(problem, "z0", &u, &p, settings)
        .and_then(|tracer| tracer.watching(&[Watch::extremum("force")]))
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()))
}

/// Of an undeformed sphere both are integrals of `w` over the height: in closed form from `A`, `Z`
/// and `λ`.
#[test]
fn energy_and_force_of_a_sphere_are_their_exact_integrals() {
    let (debye, [bending, _, w0, length]) = (0.15, HARD);
    let problem = shell(400, debye, HARD);
    let hamaker = 12.0 * PI * w0 * length * length / (1.0 - 2.0 * debye);
    let strength = 2.0 * debye * w0 * (1.0 / debye).exp() / (1.0 - 2.0 * debye);
    let lambda = debye * length;
    let w = |h: f64| strength * (-h / lambda).exp() - hamaker / (12.0 * PI * h * h);
    let integral = |h: f64| -strength * lambda * (-h / lambda).exp() + hamaker / (12.0 * PI * h);
    for gap in [0.7, 0.9, 1.0, 1.3, 3.0] {
        let plate = 1.0 + gap * length;
        let seen =
            problem.observation(&problem.initial_state(), &problem.parameters_at(plate)).unwrap();
        let energy = 4.0 * PI * (integral(plate) - integral(plate - 1.0));
        let force = 2.0 * PI / bending.sqrt() * (w(plate - 1.0) - w(plate));
        let off = [seen.energy_film / energy - 1.0, seen.force / force - 1.0];
        println!("{gap}: energy off by {:.1e}, force by {:.1e}", off[0], off[1]);
        assert!(off.iter().all(|off| off.abs() < 1e-9), "{gap}: {off:?}");
    }
}

/// The balances of forces, written from curvatures and tensions, hold on states that make the energy
/// stationary.
#[test]
fn weak_form_holds_on_equilibria() {
    let largest = |elements: usize| {
        let problem = shell(elements, 0.2, [3e-3, 3e-3, 1e-3, 0.1]);
        let branch = trace(&problem, 1.3, 0.9, None);
        let end = branch.points.last().unwrap();
        let p = problem.parameters_at(end.p);
        let all = balances(&problem, &end.u, &p).unwrap();
        all.iter().fold((0.0_f64, 0.0_f64), |(a, b), k| {
            (a.max((k.normal / k.weight).abs()), b.max((k.tangential / k.weight).abs()))
        })
    };
    let (coarse, fine) = (largest(25), largest(50));
    println!("normal {:.1e} {:.1e}, tangential {:.1e} {:.1e}", coarse.0, fine.0, coarse.1, fine.1);
    assert!((coarse.0 / fine.0).log2() > 1.7 && (coarse.1 / fine.1).log2() > 1.7);
}

/// `dU_T = −2√k_b F̂ dz0` by the trapezoidal rule, through both folds: second order.
#[test]
fn energy_changes_by_the_work_of_the_plates() {
    let problem = shell(200, 0.15, HARD);
    let scale = HARD[0].sqrt();
    let errors = [2e-3, 1e-3, 5e-4].map(|step| {
        let branch = trace(&problem, 1.15, 0.85, Some(step));
        assert!(branch.stopped.reason.is_complete(), "{:?}", branch.stopped);
        let error: f64 = branch
            .points
            .windows(2)
            .map(|pair| {
                let [a, b] = [&pair[0], &pair[1]];
                let work = -scale * (a.observables[0] + b.observables[0]) * (b.p - a.p);
                (b.observables[4] - a.observables[4] - work).abs()
            })
            .sum();
        let size = branch.points.iter().fold(0.0_f64, |m, q| m.max(q.observables[4].abs()));
        error / size
    });
    let orders = [0, 1].map(|k| (errors[k] / errors[k + 1]).log2());
    println!("{errors:?}, orders {orders:.2?}");
    assert!(errors[2] < 1e-4 && orders[1] > 1.8, "{errors:?} {orders:?}");
}

/// Pull-off of a stiff shell: a rigid sphere's `2π[w(z0 − 1) − w(z0)]`, Derjaguin's `−2πR0w0` for a
/// thin film; approached in proportion to the adhesion.
#[test]
fn pull_off_of_a_stiff_shell_is_derjaguins() {
    let (bending, film, debye) = (3e-5, 1.0 / 30.0, 0.15);
    let potential = Dlvo::new(debye).unwrap();
    let w = |h: f64| potential.energy(h, 1.0, film);
    let rigid = (0..2000)
        .map(|i| film * (0.9 + 1e-4 * f64::from(i)))
        .fold(0.0_f64, |m, gap| m.min(w(gap) - w(1.0 + gap)));
    let errors = [1e-6, 5e-7, 2.5e-7].map(|adhesion| {
        let problem = shell(200, debye, [bending, 3e-3, adhesion, film]);
        let branch = trace(&problem, 1.3, 1.01, None);
        let minimum = EventKind::Minimum("force".to_owned());
        let at = branch.events_of(&minimum).next().unwrap().point;
        let force = branch.points[at].observables[0];
        -force / derjaguin_pull_off(adhesion, bending) - rigid
    });
    let orders = [0, 1].map(|k| (errors[k] / errors[k + 1]).log2());
    println!("rigid {rigid:.6}, off by {errors:?}, orders {orders:.3?}");
    assert!((rigid + 1.0).abs() < 3.0 * film * film, "{rigid}");
    assert!(errors[0].abs() < 0.01 && (orders[1] - 1.0).abs() < 0.05, "{errors:?} {orders:?}");
}

/// A weak double layer does not bear the pressure of a stiff shell: the branch ends where the film
/// is as thin as the barrier, and says so; no state beyond is found.
#[test]
fn a_branch_ends_where_the_film_breaks() {
    let problem = shell(200, 0.3, [3e-5, 3e-3, 1e-5, 1.0 / 30.0]);
    let branch = trace(&problem, 1.15, 0.8, None);
    assert!(!branch.stopped.reason.is_complete());
    assert!(branch.stopped.detail.contains("the film breaks"), "{:?}", branch.stopped);
    let Film::Dlvo(film) = problem.film() else { unreachable!() };
    let least = film.barrier() / 30.0;
    let pole = |u: &[f64]| 1.0 + problem.mesh().displacement_in(u, 0, 0.0)[0].1;
    let gaps: Vec<f64> = branch.points.iter().map(|point| point.p - pole(&point.u)).collect();
    assert!(gaps.iter().all(|gap| *gap > least), "{gaps:?}");
    // it ends within a step of the barrier, not somewhere before
    let last = gaps[gaps.len() - 1];
    assert!(last < 1.2 * least, "{last} and {least}");
    let mut p = problem.parameters_at(1.0 + 0.99 * least);
    let sphere = problem.initial_state();
    let refused = problem.admissible(&sphere, &p).unwrap_err().to_string();
    assert!(refused.contains("the film breaks"), "{refused}");
    p[0] = 1.0 + 1.01 * least;
    assert!(problem.admissible(&sphere, &p).is_ok());
    let mut r = vec![0.0; problem.dim()];
    assert!(problem.residual(&sphere, &p, &mut r).is_ok());
}
