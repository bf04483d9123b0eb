//! The linear response to opposite point loads against its Legendre series.

use crate::contact;
use continuation::{Matrix, Problem};
use shell_contact::asymptotics::point_load_slope;
use shell_contact::{ContactProblem, Mesh};
use std::f64::consts::PI;

/// `F̂/d̂` of the discrete unstressed sphere: `H x = F/(2π) ∂w(0)/∂x`.
fn slope(problem: &ContactProblem) -> f64 {
    let n = problem.dim();
    let (u, p) = (problem.initial_state(), problem.parameters_at(2.0));
    let mut load = vec![0.0; n];
    for i in 0..4 {
        let mut unit = vec![0.0; n];
        unit[i] = 1.0;
        load[i] = problem.mesh().displacement_in(&unit, 0, 0.0)[0].1;
    }
    let mut hessian = problem.new_jacobian();
    problem.jacobian(&u, &p, &mut hessian).unwrap();
    let facts = hessian.factor(f64::EPSILON * hessian.norm());
    assert_eq!(facts.inertia, Some((0, n)), "the unstressed sphere is stable");
    let mut x = load.clone();
    hessian.solve(&mut x);
    let compliance: f64 = load.iter().zip(&x).map(|(a, b)| a * b).sum();
    2.0 * PI / (problem.groups().bending.sqrt() * compliance)
}

/// Second order: the load is a point, where the displacement is like `r² ln r`.
#[test]
fn point_load_slopes_converge_to_the_series_at_second_order() {
    let solid = |poisson: f64, h: f64| h * h / (12.0 * (1.0 - poisson * poisson));
    let cases = [
        (0.3, solid(0.3, 0.01), 0.0, 0.0, Some(7.88197)),
        (0.5, solid(0.5, 1.0 / 60.0), 0.0, 0.0, Some(7.78392)),
        (0.5, solid(0.5, 0.1), 0.0, 0.0, Some(7.21413)),
        (0.3, 1e-3, 0.5, 1.07, None),
        (0.5, 2.7e-3, 3.0, 1.07, None),
        (-0.2, 1e-4, 100.0, 1.4, None),
        // constant pressure does not stiffen
        (0.3, 1e-3, 0.5, 0.0, None),
    ];
    for (poisson, bending, pressure, gas_exponent, known) in cases {
        let groups = [bending, pressure, 0.0, 0.1, 0.0, gas_exponent];
        let problem = |n| contact(Mesh::uniform(n).unwrap(), poisson, groups);
        let series = point_load_slope(problem(8).shell(), bending, pressure, gas_exponent);
        let errors = [100, 200, 400].map(|n| slope(&problem(n)) / series - 1.0);
        let order = (errors[1] / errors[2]).log2();
        println!(
            "nu {poisson}, k_b {bending:.1e}, P {pressure}: {series:.5}, {errors:?}, order {order:.2}"
        );
        assert!(errors[2].abs() < 1e-3 && (1.8..2.2).contains(&order), "{errors:?}");
        let graded = slope(&contact(Mesh::graded(400, 50.0).unwrap(), poisson, groups));
        println!("  graded: {:.1e}", graded / series - 1.0);
        assert!((graded / series - 1.0).abs() < 2e-6);
        if let Some(known) = known {
            assert!((series - known).abs() < 5e-6);
        } else if gas_exponent > 0.0 {
            let without = point_load_slope(problem(8).shell(), bending, 0.0, gas_exponent);
            assert!(series / without > 1.0 + 1e-4, "the gas is felt: {series} {without}");
        }
    }
}
