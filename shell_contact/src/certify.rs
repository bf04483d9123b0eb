//! Tests of the assembled problem against automatic differentiation of its total energy.
//!
//! The energy is written once more from the equations, on hyper-dual numbers, with the unknowns
//! moved along two directions and every parameter dual: residual, Hessian (gas term included) and
//! parameter derivatives are all mixed derivatives of this one function.

use crate::bending;
use crate::contact::{ContactProblem, parameter};
use crate::dual::{close, real};
use crate::film::{Film, Potential, check};
use crate::gas::REST_VOLUME;
use crate::membrane;
use crate::meridian::Mesh;
use crate::params::{Dimensionless, Law, Shell};
use crate::quadrature::gauss_legendre;
use continuation::{Matrix, ParamId, Problem};
use num_dual::{DualNum, HyperDual64};

pub(crate) type H = HyperDual64;

pub(crate) fn problem(law: Law, gauss: usize) -> ContactProblem {
    problem_with(law, gauss, Film::FourTwo)
}

fn problem_with(law: Law, gauss: usize, film: Film) -> ContactProblem {
    let groups = Dimensionless {
        bending: 2e-3,
        pressure: 0.4,
        adhesion: 3e-3,
        film: 0.05,
        surface_tension: 0.03,
        gas_exponent: 1.3,
    };
    let mesh = Mesh::graded(14, 2.5).unwrap().with_gauss_points(gauss).unwrap();
    ContactProblem::with_potential(&Shell { law, poisson: 0.4 }, &groups, mesh, film).unwrap()
}

/// A smooth-ish deformed state under the plate.
pub(crate) fn state(n: usize, seed: f64, size: f64) -> Vec<f64> {
    (0..n).map(|i| size * ((i as f64) * 0.37 + seed).sin()).collect()
}

/// The total energy at `u + ε1 a + ε2 b` and dual parameters.
pub(crate) fn energy(
    problem: &ContactProblem,
    u: &[f64],
    a: &[f64],
    b: &[f64],
    p: [H; parameter::COUNT],
) -> H {
    let [plate, adhesion, kb, ambient, length, tension, exponent, nu, share] = p;
    let material = Material { law: problem.shell.law, kb, nu, share };
    let film = |z: H| problem.potential.energy(plate - z, adhesion, length) + tension;
    let rest = Rest { ambient, tension, exponent };
    energy_on(problem.mesh(), (u, a, b), material, rest, film)
}

/// The constants of a shell as dual numbers.
#[derive(Clone, Copy)]
pub(crate) struct Material {
    pub(crate) law: Law,
    pub(crate) kb: H,
    pub(crate) nu: H,
    pub(crate) share: H,
}

/// The gas at rest.
#[derive(Clone, Copy)]
pub(crate) struct Rest {
    pub(crate) ambient: H,
    pub(crate) tension: H,
    pub(crate) exponent: H,
}

/// The energy of shell, gas and of `surface` per deformed area, at `u + ε1 a + ε2 b`.
pub(crate) fn energy_on(
    mesh: &Mesh,
    (u, a, b): (&[f64], &[f64], &[f64]),
    Material { law, kb, nu, share }: Material,
    Rest { ambient, tension, exponent }: Rest,
    surface: impl Fn(H) -> H,
) -> H {
    let mut total = real(0.0);
    let mut volume = real(0.0);
    for e in 0..mesh.elements() {
        let (start, width) = (mesh.knots().at(e), mesh.knots().at(e + 1) - mesh.knots().at(e));
        if width == 0.0 {
            continue; // between the knots of a double one
        }
        for (x, weight) in gauss_legendre(mesh.gauss_points()) {
            let s = start + width * x;
            let weight = weight * width;
            let [d, da, db] = [u, a, b].map(|x| mesh.displacement_in(x, e, s));
            let u = |k: usize| H::new(d[k].0, da[k].0, db[k].0, 0.0);
            let w = |k: usize| H::new(d[k].1, da[k].1, db[k].1, 0.0);
            let (sin, cos) = s.sin_cos();
            let (r, r1, r2) = (u(0) + sin, u(1) + cos, u(2) - sin);
            let (z, z1, z2) = (w(0) + cos, w(1) - sin, w(2) - cos);
            let q = r1 * r1 + z1 * z1;
            let hoop = r * (1.0 / sin);
            let membrane = membrane::check::energy(law, [q, hoop * hoop], nu, share);
            let (ks, kphi) = bending::strains(r1, r2, z1, z2, real(1.0 / sin));
            let bend = kb * (ks * ks + nu * ks * kphi * 2.0 + kphi * kphi) * 0.5;
            total += (membrane + bend) * (weight * sin) + surface(z) * r * q.sqrt() * weight;
            volume += -(r * r * z1) * (0.5 * weight);
        }
    }
    let rest = ambient + tension * 2.0;
    let power = exponent - 1.0;
    let work = (((volume.recip() * REST_VOLUME).ln() * power).exp() - 1.0) * REST_VOLUME / power;
    total + ambient * (volume - REST_VOLUME) + rest * work
}

/// The values of parameters as dual numbers; a law without `b` does not read the last.
pub(crate) fn duals(p: &[f64]) -> [H; parameter::COUNT] {
    std::array::from_fn(|k| real(p.get(k).copied().unwrap_or(0.0)))
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[test]
fn residual_hessian_and_parameter_derivatives_agree_with_dual_numbers() {
    for law in [Law::Hooke, Law::MooneyRivlin { b: 0.7 }, Law::Skalak] {
        for (film, gauss) in check::every().into_iter().flat_map(|film| [(film, 4), (film, 6)]) {
            let problem = problem_with(law, gauss, film);
            let n = problem.dim();
            let u = state(n, 0.3, 0.01);
            let p = problem.parameters_at(1.07);
            let mut r = vec![0.0; n];
            let mut j = problem.new_jacobian();
            problem.linearise(&u, &p, &mut r, &mut j).unwrap();
            let mut alone = vec![0.0; n];
            problem.residual(&u, &p, &mut alone).unwrap();
            for i in 0..n {
                close(alone[i], r[i], 1e-13, 1e-15);
            }
            let mut again = problem.new_jacobian();
            problem.jacobian(&u, &p, &mut again).unwrap();
            let plain = duals(&p);
            for seed in 0..4 {
                let a = state(n, 1.0 + f64::from(seed), 1.0);
                let b = state(n, 2.7 * f64::from(seed), 1.0);
                let e = energy(&problem, &u, &a, &b, plain);
                let mut jb = vec![0.0; n];
                j.mul(&b, &mut jb);
                let size = |x: &[f64], y: &[f64]| dot(x, x).sqrt() * dot(y, y).sqrt();
                close(dot(&r, &a), e.eps1, 1e-12, 1e-14 * size(&r, &a));
                close(dot(&a, &jb), e.eps1eps2, 1e-12, 1e-14 * size(&a, &jb));
                again.mul(&b, &mut alone);
                close(dot(&a, &alone), dot(&a, &jb), 1e-13, 1e-14 * size(&a, &jb));
                for k in 0..problem.parameters().len() {
                    let mut dual = plain;
                    dual[k].eps2 = 1.0;
                    let e = energy(&problem, &u, &a, &vec![0.0; n], dual);
                    problem.parameter_derivative(&u, &p, ParamId(k), &mut alone).unwrap();
                    close(dot(&alone, &a), e.eps1eps2, 1e-12, 1e-13 * size(&alone, &a));
                }
            }
        }
    }
}

/// Analytic slopes of observables against central differences of the observables themselves.
#[test]
fn observable_slopes_agree_with_differences() {
    check::every().into_iter().for_each(slopes_agree);
}

fn slopes_agree(film: Film) {
    let problem = problem_with(Law::Hooke, 4, film);
    let n = problem.dim();
    let u = state(n, 0.3, 0.01);
    let du = state(n, 1.9, 1.0);
    let p = problem.parameters_at(1.07);
    for which in 0..problem.parameters().len() {
        let step = |t: f64| {
            let moved: Vec<f64> = u.iter().zip(&du).map(|(u, d)| u + t * d).collect();
            let mut p = p.clone();
            p[which] += t * 0.3 * p[which];
            problem.observation(&moved, &p).unwrap().to_array()
        };
        let h = 1e-5;
        let (up, down, up2, down2) = (step(h), step(-h), step(2.0 * h), step(-2.0 * h));
        let mut known = 0;
        for k in 0..up.len() {
            let slope =
                problem.observable_slope(k, &u, &p, ParamId(which), &du, 0.3 * p[which]).unwrap();
            if let Some(slope) = slope {
                known += 1;
                let difference = (8.0 * (up[k] - down[k]) - (up2[k] - down2[k])) / (12.0 * h);
                close(slope, difference, 1e-8, 1e-9);
            }
        }
        assert_eq!(known, 4);
    }
}

/// The gradient is that of the reported energy: U_T = 4π E.
#[test]
fn residual_is_the_gradient_of_the_reported_energy() {
    check::every().into_iter().for_each(is_gradient);
}

fn is_gradient(film: Film) {
    let problem = problem_with(Law::MooneyRivlin { b: 1.0 }, 4, film);
    let n = problem.dim();
    let (u, du) = (state(n, 0.3, 0.01), state(n, 5.0, 1.0));
    let p = problem.parameters_at(1.07);
    let mut r = vec![0.0; n];
    problem.residual(&u, &p, &mut r).unwrap();
    let total = |t: f64| {
        let moved: Vec<f64> = u.iter().zip(&du).map(|(u, d)| u + t * d).collect();
        problem.observation(&moved, &p).unwrap().energy_total
    };
    let h = 1e-5;
    let difference =
        (8.0 * (total(h) - total(-h)) - (total(2.0 * h) - total(-2.0 * h))) / (12.0 * h);
    close(4.0 * std::f64::consts::PI * dot(&r, &du), difference, 1e-8, 0.0);
}

/// Threads may share every problem of a shell.
#[test]
fn problems_are_send_and_sync() {
    fn shared<T: Send + Sync>() {}
    shared::<ContactProblem>();
    shared::<crate::device::LoadedProblem<'_>>();
    shared::<crate::two_plates::TwoPlatesProblem>();
    shared::<crate::two_plates::SupportedProblem<'_>>();
    shared::<crate::ring_load::RingLoadProblem>();
}
