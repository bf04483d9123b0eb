//! Mechanics with answers known otherwise: inflation, inertia, the paper's weak form, parity, and
//! what is refused.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod support;
use continuation::{EvalError, Matrix, ParamId, Problem};
use shell_contact::energy;
use shell_contact::weak_form::balances;
use shell_contact::{ContactProblem, Dimensionless, Law, Mesh, Shell};
use std::f64::consts::{FRAC_PI_2, PI};
use support::{contact, newton, states_at};

const FIG06: [f64; 6] = [3e-5, 3e-3, 2e-6, 1.0 / 30.0, 0.0, 1.07];

/// Stretch of the second uniform state of a sphere with Hooke's law at constant excess pressure
/// `2γ_BW`: `2γ = 2(τ + γ)/λ` with `τ = (λ²−1)/(2(1−ν))` has the roots 1 and this.
fn inflated(tension: f64, poisson: f64) -> f64 {
    2.0 * (1.0 - poisson) * tension - 1.0
}

/// Uniform inflation, exact: fourth order in the radius.
#[test]
fn uniform_inflation_converges_to_fourth_order() {
    let tension = 1.6;
    let exact = inflated(tension, 0.3);
    assert!(exact > 1.2);
    let error = |elements: usize| {
        let groups = Dimensionless {
            bending: 1e-3,
            pressure: 0.0,
            adhesion: 0.0,
            film: 0.1,
            surface_tension: tension,
            gas_exponent: 0.0,
        };
        let shell = Shell { law: Law::Hooke, poisson: 0.3 };
        let mesh = Mesh::graded(elements, 2.0).unwrap();
        let problem = ContactProblem::new(&shell, &groups, mesh).unwrap();
        let p = problem.parameters_at(5.0);
        let mut u = problem.initial_state();
        // start on the inflated sphere's side
        for e in 0..elements {
            let (near, far) = (problem.mesh().knots().at(e), problem.mesh().knots().at(e + 1));
            u[2 * e] = (exact - 1.0) * near.cos();
            u[2 * e + 1] = (exact - 1.0) * far.sin();
        }
        newton(&problem, &mut u, &p).expect("inflated");
        (0..=200).fold(0.0_f64, |worst, i| {
            let place = problem.mesh().place(&u, FRAC_PI_2 * f64::from(i) / 200.0);
            worst.max((place.s[0].hypot(place.z[0]) - exact).abs())
        })
    };
    let errors = [10, 20, 40].map(error);
    println!("radius {exact}: errors {errors:?}");
    assert!(errors[2] < 1e-7);
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1]).log2() > 3.6, "{errors:?}");
    }
}

/// Number of negative eigenvalues by an eigenvalue solver that knows no structure.
fn dense_negatives(problem: &ContactProblem, u: &[f64], p: &[f64]) -> usize {
    let n = problem.dim();
    let mut j = problem.new_jacobian();
    problem.jacobian(u, p, &mut j).unwrap();
    // cyclic Jacobi rotations
    let mut a = vec![vec![0.0; n]; n];
    for c in 0..n {
        let (mut e, mut column) = (vec![0.0; n], vec![0.0; n]);
        e[c] = 1.0;
        j.mul(&e, &mut column);
        for r in 0..n {
            a[r][c] = column[r];
        }
    }
    for _ in 0..12 {
        for p in 0..n {
            for q in p + 1..n {
                if a[p][q].abs() < 1e-300 {
                    continue;
                }
                let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let t = if theta == 0.0 { 1.0 } else { t };
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for k in 0..n {
                    let (x, y) = (a[k][p], a[k][q]);
                    (a[k][p], a[k][q]) = (c * x - s * y, s * x + c * y);
                }
                for k in 0..n {
                    let (x, y) = (a[p][k], a[q][k]);
                    (a[p][k], a[q][k]) = (c * x - s * y, s * x + c * y);
                }
            }
        }
    }
    (0..n).filter(|&i| a[i][i] < 0.0).count()
}

/// A shell under growing external pressure: stable, then one and more unstable modes.
#[test]
fn inertia_is_that_of_the_dense_matrix() {
    let mut seen = Vec::new();
    for pressure in [0.0, 0.05, 0.11, 0.14, 0.2, 0.4] {
        // the gas at rest holds P_A; a state with the ambient pressure changed afterwards is
        // loaded: exponent 0 and negative excess through the sphere shrunk by hand
        let problem = contact(20, Law::Hooke, [1e-3, 0.5, 0.0, 0.1, 0.0, 1.0]);
        let p = problem.parameters_at(3.0);
        let mut u = problem.initial_state();
        let shrink = -0.5 * pressure;
        for e in 0..20 {
            let (near, far) = (problem.mesh().knots().at(e), problem.mesh().knots().at(e + 1));
            u[2 * e] = shrink * near.cos();
            u[2 * e + 1] = shrink * far.sin();
        }
        let mut j = problem.new_jacobian();
        problem.jacobian(&u, &p, &mut j).unwrap();
        let floor = f64::EPSILON * j.norm();
        let (negative, positive) = j.factor(floor).inertia.unwrap();
        assert_eq!(negative, dense_negatives(&problem, &u, &p), "shrunk by {shrink}");
        assert_eq!(negative + positive, problem.dim());
        seen.push(negative);
    }
    assert!(seen[0] == 0 && seen[5] > 2, "{seen:?}");
}

/// Eqs. (25a), (25b), corrected: residuals vanish as the mesh is refined, and do not where the
/// state is no equilibrium.
#[test]
fn weak_form_of_the_paper_holds_on_equilibria() {
    let z0 = 0.864;
    let largest = |n: usize| {
        let problem = contact(n, Law::Hooke, FIG06);
        let (u, _) = states_at(&problem, 1.06, &[z0]).remove(0);
        let p = problem.parameters_at(z0);
        let balances = balances(&problem, &u, &p).unwrap();
        assert_eq!(balances.len(), n - 3);
        balances.iter().fold((0.0_f64, 0.0_f64), |(a, b), k| {
            (a.max((k.normal / k.weight).abs()), b.max((k.tangential / k.weight).abs()))
        })
    };
    let (coarse, fine) = (largest(100), largest(200));
    let problem = contact(100, Law::Hooke, FIG06);
    let sphere = problem.initial_state();
    let off = balances(&problem, &sphere, &problem.parameters_at(1.04)).unwrap();
    let force = off.iter().fold(0.0_f64, |a, k| a.max((k.normal / k.weight).abs()));
    println!(
        "normal {:.2e} {:.2e}, tangential {:.2e} {:.2e}; off {force:.2e}",
        coarse.0, fine.0, coarse.1, fine.1
    );
    assert!((coarse.0 / fine.0).log2() > 1.7 && (coarse.1 / fine.1).log2() > 1.7);
    assert!(force > 1e-5);
}

/// dU_T/dz0 = -2 √k_b F along a branch of equilibria.
#[test]
fn energy_changes_by_the_work_of_two_plates() {
    let problem = contact(100, Law::Hooke, FIG06);
    let h = 1e-3;
    let z: Vec<f64> = [2.0, 1.0, 0.0, -1.0, -2.0].iter().map(|k| 0.9 + k * h).collect();
    let o: Vec<_> = states_at(&problem, 1.06, &z)
        .iter()
        .zip(&z)
        .map(|((u, _), &z)| problem.observation(u, &problem.parameters_at(z)).unwrap())
        .collect();
    let e: Vec<f64> = o.iter().map(|o| o.energy_total).collect();
    let slope = (8.0 * (e[1] - e[3]) - (e[0] - e[4])) / (12.0 * h);
    let work = -2.0 * FIG06[0].sqrt() * o[2].force;
    assert!(((slope - work) / work).abs() < 1e-7, "{slope} {work}");
}

/// The sphere is an exact equilibrium without a film, surface tension included.
#[test]
fn unstressed_sphere_is_an_equilibrium() {
    for law in [Law::Hooke, Law::MooneyRivlin { b: 0.5 }, Law::Skalak] {
        let problem = contact(400, law, [3e-5, 3.0, 0.0, 0.03, 0.08, 1.07]);
        let (u, p) = (problem.initial_state(), problem.parameters_at(1.1));
        let mut r = vec![1.0; problem.dim()];
        problem.residual(&u, &p, &mut r).unwrap();
        assert!(
            r.iter().all(|r| r.abs() < 1e-15),
            "{:e}",
            r.iter().fold(0.0, |m: f64, r| m.max(r.abs()))
        );
        let o = problem.observation(&u, &p).unwrap();
        assert!((o.volume - 4.0 / 3.0 * PI).abs() < 1e-13);
        assert!((o.energy_surface - 4.0 * PI * 0.08).abs() < 1e-13);
        assert_eq!(o.pole_height, 1.0);
        assert!(o.energy_gas.abs() < 1e-14 && o.contact_radius.is_nan());
    }
}

/// The number of Gauss points does not matter.
#[test]
fn four_gauss_points_are_enough() {
    let problem = contact(200, Law::Hooke, FIG06);
    let (u, _) = states_at(&problem, 1.06, &[0.864]).remove(0);
    let force = |points: usize| {
        let mesh = Mesh::uniform(200).unwrap().with_gauss_points(points).unwrap();
        let problem = ContactProblem::new(problem.shell(), problem.groups(), mesh).unwrap();
        let mut u = u.clone();
        let p = problem.parameters_at(0.864);
        newton(&problem, &mut u, &p).unwrap();
        problem.observation(&u, &p).unwrap().force
    };
    let fine = force(8);
    let gaps = [3, 4, 5].map(|n| ((force(n) - fine) / fine).abs());
    println!("3, 4, 5 points against 8: {gaps:?}");
    assert!(gaps[0] < 1e-6 && gaps[1] < 1e-7 && gaps[2] < 1e-9);
}

fn refusal(problem: &ContactProblem, u: &[f64], z0: f64) -> (String, usize) {
    let p = problem.parameters_at(z0);
    let n = problem.dim();
    let (mut r, mut j) = (vec![0.0; n], problem.new_jacobian());
    let error = problem.residual(u, &p, &mut r).unwrap_err();
    assert_eq!(problem.linearise(u, &p, &mut r, &mut j), Err(error));
    assert_eq!(problem.admissible(u, &p), Err(error));
    assert_eq!(problem.observation(u, &p).unwrap_err(), error);
    assert_eq!(problem.parameter_derivative(u, &p, ParamId(0), &mut r), Err(error));
    match error {
        EvalError::Inadmissible { what, at, .. } => (what.to_string(), at),
        EvalError::NotFinite { at } => ("not finite".into(), at),
        other => panic!("{other}"),
    }
}

#[test]
fn states_outside_the_model_are_refused() {
    let n = 40;
    let problem = contact(n, Law::Hooke, FIG06);
    let sphere = problem.initial_state();
    assert!(refusal(&problem, &sphere, 0.99).0.contains("plate"));
    assert!(refusal(&problem, &sphere, 1.0).0.contains("plate"));
    assert!(problem.admissible(&sphere, &problem.parameters_at(1.0 + 1e-9)).is_ok());

    let mut deep = sphere.clone();
    for e in 0..n {
        deep[2 * e] = -1.3 * (1.0 - (e as f64 / 6.0).powi(2)).max(0.0);
    }
    assert!(refusal(&problem, &deep, 1.2).0.contains("mirror image"));

    let mut inside = sphere.clone();
    inside[1] = -0.2;
    assert!(refusal(&problem, &inside, 1.2).0.contains("axis"));

    let mut nan = sphere.clone();
    nan[17] = f64::NAN;
    assert_eq!(refusal(&problem, &nan, 1.2), ("not finite".into(), 17));
    let (what, at) = refusal(&problem, &sphere, f64::NAN);
    assert_eq!((what.as_str(), at), ("not finite", 2 * n));
    let mut p = problem.parameters_at(1.2);
    p[2] = 0.0;
    assert!(problem.admissible(&sphere, &p).is_err());
}

/// A coarse spline that pokes through the plate between Gauss points only.
#[test]
fn shell_between_gauss_points_does_not_pass_the_plate() {
    let problem = contact(40, Law::Hooke, FIG06);
    let mut u = problem.initial_state();
    u[20] = 0.3; // a bump of w about knot 10
    let mesh = problem.mesh();
    let z = |s: f64| mesh.place(&u, s).z[0];
    let samples = 40_000;
    let top = (0..=samples)
        .map(|i| z(FRAC_PI_2 * f64::from(i) / f64::from(samples)))
        .fold(0.0_f64, f64::max);
    assert!(top > 1.0);
    let nodes = (0..40).flat_map(|e| {
        let (a, b) = (mesh.knots().at(e), mesh.knots().at(e + 1));
        shell_contact::quadrature::gauss_legendre(4).into_iter().map(move |(x, _)| a + (b - a) * x)
    });
    let at_nodes = nodes.map(z).fold(0.0_f64, f64::max);
    assert!(at_nodes < top - 1e-6);
    let between = 0.5 * (top + at_nodes);
    assert!(matches!(
        energy::admissible(mesh, &u, between),
        Err(EvalError::Inadmissible { what, .. }) if what.contains("plate")
    ));
    assert!(energy::admissible(mesh, &u, top + 1e-6).is_ok());
}

/// σ odd and z even at the pole, σ even and z odd at the equator, for any unknowns.
#[test]
fn parity_holds_at_pole_and_equator() {
    let mesh = Mesh::graded(12, 3.0).unwrap();
    let u: Vec<f64> = (0..24).map(|i| 0.01 * f64::from(i).sin()).collect();
    let (pole, equator) = (mesh.place(&u, 0.0), mesh.place(&u, FRAC_PI_2));
    for zero in [pole.s[0], pole.s[2], pole.z[1], equator.s[1], equator.z[0], equator.z[2]] {
        assert!(zero.abs() < 1e-12, "{zero:e}");
    }
}

/// The plate distance the profile reports, the sign of the disjoining pressure, and the tensions
/// of a shell whose gas presses outwards.
#[test]
fn profile_shows_repulsion_under_the_plate() {
    let problem = contact(200, Law::Hooke, FIG06);
    let (u, _) = states_at(&problem, 1.06, &[0.962]).remove(0);
    let p = problem.parameters_at(0.962);
    let profile = problem.profile(&u, &p, 101).unwrap();
    let o = problem.observation(&u, &p).unwrap();
    assert_eq!(profile.angle.len(), 101);
    assert!((profile.z[0] - o.pole_height).abs() < 1e-14);
    assert!((profile.delta[0] - (0.962 - o.pole_height)).abs() < 1e-14);
    let most = profile.disjoining_pressure.iter().fold(0.0_f64, |m, x| m.max(*x));
    assert!(most > 0.5, "repulsion somewhere: {most}");
    assert!((profile.tension_s[0] - profile.tension_phi[0]).abs() < 1e-9);
    assert!(o.contact_radius > 0.2 && o.contact_radius < 0.5, "{}", o.contact_radius);
}
