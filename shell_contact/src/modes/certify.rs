//! Tests of the assembled matrices: against the energy of the perturbed surface in space, and
//! against the Hessian of the half model.

use super::ends::{Ends, Neutral};
use super::{AsymmetricModes, Parity, elements};
use crate::contact::ContactProblem;
use crate::dual::close;
use crate::film::{Film, Potential, check};
use crate::gas::Gas;
use crate::membrane::Membrane;
use crate::meridian::Mesh;
use crate::params::{Dimensionless, Law, Shell};
use crate::quadrature::gauss_legendre;
use continuation::{Matrix, Problem};
use std::f64::consts::PI;

const GROUPS: Dimensionless = Dimensionless {
    bending: 2e-3,
    pressure: 0.4,
    adhesion: 3e-3,
    film: 0.05,
    surface_tension: 0.03,
    gas_exponent: 1.3,
};

fn problem(law: Law) -> ContactProblem {
    problem_with(law, Film::FourTwo)
}

fn problem_with(law: Law, film: Film) -> ContactProblem {
    let mesh = Mesh::graded(14, 2.5).unwrap();
    ContactProblem::with_potential(&Shell { law, poisson: 0.4 }, &GROUPS, mesh, film).unwrap()
}

fn state(n: usize) -> Vec<f64> {
    (0..n).map(|i| 0.02 * ((i as f64) * 0.37 + 0.3).sin()).collect()
}

type V3 = [f64; 3];

fn cross(a: V3, b: V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn inner(a: V3, b: V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A product of a function of `S` and a trigonometric one of `φ`: values and derivatives.
fn product(f: V3, g: V3) -> [f64; 6] {
    // 1, S, φ, SS, Sφ, φφ
    [f[0] * g[0], f[1] * g[0], f[0] * g[1], f[2] * g[0], f[1] * g[1], f[0] * g[2]]
}

/// Energy over `2π`, without the gas's, and volume over `2π` of the half shell
/// `r + ε (u cos nφ, v sin nφ, w cos nφ)`, in Cartesian components.
fn surface(
    problem: &ContactProblem,
    state: &[f64],
    ends: &Ends,
    n: usize,
    x: &[f64],
    epsilon: f64,
) -> (f64, f64) {
    let mesh = problem.mesh();
    let (plate, nu, kb) = (1.07, problem.shell().poisson, GROUPS.bending);
    let (mut energy, mut volume) = (0.0, 0.0);
    let around = 32;
    for e in 0..mesh.elements() {
        let (start, width) = (mesh.knots().at(e), mesh.knots().at(e + 1) - mesh.knots().at(e));
        for (t, weight) in gauss_legendre(mesh.gauss_points()) {
            let s = start + width * t;
            let weight = weight * width / f64::from(around);
            let basis = mesh.knots().basis(e, s);
            let field = |f: usize| -> V3 {
                std::array::from_fn(|k| {
                    (0..4)
                        .map(|i| {
                            let slot = ends.slot(f, e as isize - 1 + i as isize);
                            let c: f64 = slot.terms().iter().map(|&(i, c)| c * x[i]).sum();
                            basis[k][i] * c * epsilon
                        })
                        .sum()
                })
            };
            let (u, v, w) = (field(0), field(1), field(2));
            let base = mesh.place(state, s);
            for i in 0..around {
                let phi = 2.0 * PI * (f64::from(i) + 0.3) / f64::from(around);
                let m = n as f64;
                let (sn, cn) = (m * phi).sin_cos();
                let (sp, cp) = phi.sin_cos();
                let cosine = [cn, -m * sn, -m * m * cn];
                let sine = [sn, m * cn, -m * m * sn];
                let add =
                    |a: [f64; 6], b: [f64; 6]| -> [f64; 6] { std::array::from_fn(|k| a[k] + b[k]) };
                let radial = add(product(base.s, [1.0, 0.0, 0.0]), product(u, cosine));
                let turning = product(v, sine);
                let axial = add(product(base.z, [1.0, 0.0, 0.0]), product(w, cosine));
                // e_ρ = (cos φ, sin φ), e_φ = (−sin φ, cos φ)
                let rotate = |f: [f64; 6], e: [f64; 3]| -> [f64; 6] {
                    [
                        f[0] * e[0],
                        f[1] * e[0],
                        f[2] * e[0] + f[0] * e[1],
                        f[3] * e[0],
                        f[4] * e[0] + f[1] * e[1],
                        f[5] * e[0] + 2.0 * f[2] * e[1] + f[0] * e[2],
                    ]
                };
                let cx = add(rotate(radial, [cp, -sp, -cp]), rotate(turning, [-sp, -cp, sp]));
                let cy = add(rotate(radial, [sp, cp, -sp]), rotate(turning, [cp, -sp, -cp]));
                let at = |k: usize| [cx[k], cy[k], axial[k]];
                let (r, rs, rf) = (at(0), at(1), at(2));
                let i0 = 1.0 / s.sin();
                let normal = cross(rs, rf);
                let j = inner(normal, normal).sqrt();
                let (c11, c12, c22) = (inner(rs, rs), inner(rs, rf) * i0, inner(rf, rf) * i0 * i0);
                let bend = |y: V3| -inner(normal, y) / j;
                let (b11, b12, b22) = (bend(at(3)), bend(at(4)) * i0, bend(at(5)) * i0 * i0);
                // eigenvectors of C, and U⁻¹ from them
                let angle = 0.5 * (2.0 * c12).atan2(c11 - c22);
                let (sa, ca) = angle.sin_cos();
                let q = c11 * ca * ca + 2.0 * c12 * ca * sa + c22 * sa * sa;
                let m = c11 * sa * sa - 2.0 * c12 * ca * sa + c22 * ca * ca;
                let (p, o) = (1.0 / q.sqrt(), 1.0 / m.sqrt());
                let (i11, i12, i22) =
                    (p * ca * ca + o * sa * sa, (p - o) * ca * sa, p * sa * sa + o * ca * ca);
                let k11 = i11 * b11 + i12 * b12 - 1.0;
                let k22 = i12 * b12 + i22 * b22 - 1.0;
                let k12 = 0.5 * (i11 * b12 + i12 * b22 + i12 * b11 + i22 * b12);
                let membrane = problem.shell.energy(q, m);
                let bending = 0.5
                    * kb
                    * (k11 * k11 + 2.0 * nu * k11 * k22 + k22 * k22 + 2.0 * (1.0 - nu) * k12 * k12);
                let film = problem.potential.energy(plate - r[2], GROUPS.adhesion, GROUPS.film);
                energy +=
                    weight * ((membrane + bending) * s.sin() + (film + GROUPS.surface_tension) * j);
                volume += weight * inner(r, normal) / 3.0;
            }
        }
    }
    (energy, volume)
}

#[test]
fn second_differences_of_the_energy_in_space() {
    let [_, dlvo] = check::every();
    for (law, film) in [
        (Law::Hooke, Film::FourTwo),
        (Law::MooneyRivlin { b: 0.7 }, Film::FourTwo),
        (Law::Skalak, Film::FourTwo),
        (Law::Hooke, dlvo),
    ] {
        let problem = problem_with(law, film);
        let u = state(problem.dim());
        let mut modes = AsymmetricModes::new(problem.mesh());
        modes.assemble(&problem, &u, &problem.parameters_at(1.07)).unwrap();
        let gas = Gas {
            ambient: GROUPS.pressure,
            surface_tension: GROUPS.surface_tension,
            exponent: GROUPS.gas_exponent,
        };
        for n in [1, 2, 3, 5] {
            for parity in Parity::BOTH {
                let ends = modes.ends(n, parity, Neutral::Kept);
                modes.matrix(&ends, n);
                let k = modes.band.clone();
                let dim = k.dim();
                let x: Vec<f64> = (0..dim).map(|i| (1.0 + i as f64 * 0.41).sin()).collect();
                // unit pivots of what the class does not have do not count
                let mut mass = elements::band(problem.mesh().elements());
                modes.masses.matrix(&ends, n, &mut mass);
                let x: Vec<f64> =
                    (0..dim).map(|i| if mass.get(i, i) == 0.0 { 0.0 } else { x[i] }).collect();
                let mut y = vec![0.0; dim];
                k.mul(&x, &mut y);
                let form: f64 = x.iter().zip(&y).map(|(a, b)| a * b).sum();

                let at = |t: f64| surface(&problem, &u, &ends, n, &x, t);
                let rest = at(0.0);
                let pair = |t: f64| {
                    let (plus, minus) = (at(t), at(-t));
                    let gases = 2.0 * (gas.energy(0.5 * (plus.1 + minus.1)) - gas.energy(rest.1));
                    plus.0 + minus.0 - 2.0 * rest.0 + gases
                };
                let h = 4e-4;
                let difference = (270.0 * pair(h) - 27.0 * pair(2.0 * h) + 2.0 * pair(3.0 * h))
                    / (180.0 * h * h);
                close(0.5 * form, difference, 1e-7, 0.0);
            }
        }
    }
}

/// `n = 0` with the half model's end conditions is its Hessian.
#[test]
fn without_waves_the_matrix_is_the_half_models() {
    let problem = problem(Law::MooneyRivlin { b: 0.4 });
    let u = state(problem.dim());
    let p = problem.parameters_at(1.07);
    let mut modes = AsymmetricModes::new(problem.mesh());
    modes.assemble(&problem, &u, &p).unwrap();
    let mut hessian = problem.new_jacobian();
    problem.jacobian(&u, &p, &mut hessian).unwrap();
    hessian.clear_rank_one();
    let ends = modes.ends(0, Parity::Symmetric, Neutral::Pinned);
    modes.matrix(&ends, 0);
    let k = &modes.band;
    // w_0, u_1, w_1, …, u_N
    let place = |i: usize| if i % 2 == 1 { 3 * i.div_ceil(2) } else { 3 * (i / 2) + 2 };
    for i in 0..problem.dim() {
        for j in i.saturating_sub(7)..=i {
            let size = (hessian.get(i, i) * hessian.get(j, j)).abs().sqrt();
            close(k.get(place(i), place(j)), hessian.get(i, j), 1e-13, 1e-13 * size);
        }
    }
}

/// One elimination for both parities finds the inertia that each matrix has by itself.
#[test]
fn the_shared_elimination_counts_what_each_matrix_has() {
    let problem = problem(Law::Hooke);
    let mut modes = AsymmetricModes::new(problem.mesh());
    let mut unstable = 0;
    // the rougher the state, the more modes are unstable
    for size in [1.0, 4.0, 6.0, 8.0, 12.0] {
        let u: Vec<f64> = state(problem.dim()).iter().map(|u| size * u).collect();
        modes.assemble(&problem, &u, &problem.parameters_at(1.4)).unwrap();
        for n in 1..9 {
            let ends = Parity::BOTH.map(|parity| modes.ends(n, parity, Neutral::Pinned));
            let both = modes.elimination.negative(&modes.elements, ends.each_ref(), n);
            for (ends, found) in ends.iter().zip(both) {
                modes.matrix(ends, n);
                let dim = modes.band.dim();
                let mut dense = continuation::linalg::Dense::new(dim);
                dense.set_zero();
                for i in 0..dim {
                    for j in 0..dim {
                        dense.set(i, j, modes.band.get(i, j));
                    }
                }
                let (negative, _) = dense.symmetric_inertia().unwrap();
                if let Some(found) = found {
                    assert_eq!(found, negative, "n = {n}, {size}");
                    unstable += negative;
                }
                assert_eq!(modes.negative_below(ends, n, 0.0).negative, negative);
            }
        }
    }
    assert!(unstable > 15, "{unstable}");
}
