//! The ring load's equations against automatic differentiation of the energy on its mesh, written once more on
//! hyper-dual numbers: residual, Jacobian and the derivatives by all parameters but the angle, with which the mesh
//! moves.

use super::{RingGroups, RingLoadProblem, parameter};
use crate::certify::{H, Material, Rest, dot, energy_on, state};
use crate::dual::{close, real};
use crate::params::{Law, Shell};
use continuation::{Matrix, ParamId, Problem};
use num_dual::HyperDual64;

/// `E + k_b q z(S_L) + m z'(S_L)` at `x + ε1 a + ε2 b`.
fn potential(
    problem: &RingLoadProblem,
    (u, a, b): (&[f64], &[f64], &[f64]),
    p: [H; parameter::COUNT],
) -> H {
    let [alpha, moment, kb, ambient, exponent, nu, share] = p;
    let (x, q) = u.split_at(u.len() - 1);
    problem.with_mesh(alpha.re, |mesh, ring, _| {
        let material = Material { law: problem.shell().law, kb, nu, share };
        let rest = Rest { ambient, tension: real(0.0), exponent };
        let (mut height, mut slope) = (real(alpha.re.cos()), real(-alpha.re.sin()));
        for at in ring {
            let i = at.unknown;
            let moved = HyperDual64::new(x[i], a[i], b[i], 0.0);
            height += moved * at.height[0];
            slope += moved * at.slope[0];
        }
        energy_on(mesh, (x, a, b), material, rest, |_| real(0.0))
            + kb * q[0] * height
            + moment * slope
    })
}

#[test]
fn equations_and_parameter_derivatives_agree_with_dual_numbers() {
    let groups = RingGroups { bending: 1e-3, pressure: 0.7, gas_exponent: 1.2 };
    for law in [Law::Hooke, Law::MooneyRivlin { b: 0.6 }, Law::Skalak] {
        let shell = Shell { law, poisson: 0.4 };
        let problem = RingLoadProblem::new(&shell, &groups, 20, 4.0).unwrap();
        let n = problem.dim() - 1;
        let mut u = state(n + 1, 0.3, 0.01);
        u[n] = 0.7;
        let mut p = problem.parameters_at(0.3);
        p[parameter::MOMENT.0] = 2e-4;
        assert_eq!(p.len(), problem.parameters().len());
        let plain: [H; parameter::COUNT] =
            std::array::from_fn(|k| real(p.get(k).copied().unwrap_or(0.0)));
        let (mut r, mut j) = (vec![0.0; n + 1], problem.new_jacobian());
        problem.linearise(&u, &p, &mut r, &mut j).unwrap();
        let still = vec![0.0; n];
        for seed in 0..4 {
            let (a, b) =
                (state(n, 1.0 + f64::from(seed), 1.0), state(n, 2.7 * f64::from(seed), 1.0));
            let e = potential(&problem, (&u, &a, &b), plain);
            let size = |x: &[f64], y: &[f64]| dot(x, x).sqrt() * dot(y, y).sqrt();
            close(dot(&r[..n], &a), e.eps1, 1e-12, 1e-13 * size(&r, &a));
            let (mut moved, mut product) = (b.clone(), vec![0.0; n + 1]);
            moved.push(0.0);
            j.mul(&moved, &mut product);
            close(dot(&product[..n], &a), e.eps1eps2, 1e-12, 1e-13 * size(&product, &a));
            let mut slope = vec![0.0; n + 1];
            for k in parameter::MOMENT.0..p.len() {
                let mut dual = plain;
                dual[k].eps2 = 1.0;
                let e = potential(&problem, (&u, &a, &still), dual);
                problem.parameter_derivative(&u, &p, ParamId(k), &mut slope).unwrap();
                close(dot(&slope[..n], &a), e.eps1eps2, 1e-12, 1e-13 * size(&slope, &a));
                assert_eq!(slope[n], 0.0);
            }
        }
    }
}
