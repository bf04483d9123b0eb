//! Both problems against automatic differentiation of their total energy.
//!
//! The energy is written once more from the equations, over one coordinate from pole to pole and
//! on hyper-dual numbers; nothing of the halves enters but the values of the splines.

use super::{
    NAMES, Plate, Side, Support, SupportedProblem, TwoPlatesGroups, TwoPlatesProblem, parameter,
};
use crate::bending;
use crate::certify::{H, dot, state};
use crate::dual::{close, real};
use crate::film::{Film, Potential, check};
use crate::half::HalfMeridian;
use crate::membrane;
use crate::meridian::Mesh;
use crate::params::{Law, Shell};
use crate::quadrature::gauss_legendre;
use continuation::{Matrix, ParamId, Problem};
use num_dual::DualNum;
use std::f64::consts::{FRAC_PI_2, PI};

const Z0: f64 = 1.07;
const SUPPORTS: [Support; 3] = [
    Support { held: true, spring: None },
    Support { held: false, spring: Some(7.0) },
    Support { held: true, spring: Some(7.0) },
];

fn problem(law: Law) -> TwoPlatesProblem {
    problem_with(law, (Film::FourTwo, Film::FourTwo))
}

fn problem_with(law: Law, films: (Film, Film)) -> TwoPlatesProblem {
    let groups = TwoPlatesGroups {
        bending: 2e-3,
        pressure: 0.4,
        surface_tension: 0.03,
        gas_exponent: 1.3,
        top: Plate { adhesion: 3e-3, film: 0.05 },
        bottom: Plate { adhesion: 5e-3, film: 0.04 },
    };
    let mesh = Mesh::graded(10, 2.5).unwrap();
    let shell = Shell { law, poisson: 0.4 };
    TwoPlatesProblem::with_potentials(&shell, &groups, mesh, films).unwrap()
}

/// `(u, w)` upwards and two derivatives in `S` from the upper pole.
fn displacement(problem: &TwoPlatesProblem, x: &[f64], s: f64, side: Side) -> [(f64, f64); 3] {
    let half = problem.halves()[side as usize];
    let (own, sign) = match side {
        Side::Top => (s, 1.0),
        Side::Bottom => (PI - s, -1.0),
    };
    let d = half.displacement_in(x, problem.mesh().knots().element_of(own), own);
    [
        (d[0].0, sign * d[0].1),
        (sign * d[1].0, d[1].1), // two reflections of w'
        (d[2].0, sign * d[2].1),
    ]
}

/// Directions and parameters as hyper-dual numbers.
struct Moved<'a> {
    a: &'a [f64],
    b: &'a [f64],
    p: [H; COUNT],
    /// Heights of the upper plate and, negative, of the lower.
    plates: [H; 2],
}

/// The total energy over `2π` at `u + ε1 a + ε2 b`.
fn energy(problem: &TwoPlatesProblem, u: &[f64], moved: &Moved<'_>) -> H {
    let [_, kb, ambient, tension, .., exponent, nu, share] = moved.p;
    let films = [(moved.p[4], moved.p[5]), (moved.p[6], moved.p[7])];
    let mesh = problem.mesh();
    let n = mesh.elements();
    let knot = |k: usize| if k <= n { mesh.knots().at(k) } else { PI - mesh.knots().at(2 * n - k) };
    let (mut total, mut volume) = (real(0.0), real(0.0));
    for e in 0..2 * n {
        let side = if e < n { Side::Top } else { Side::Bottom };
        let width = knot(e + 1) - knot(e);
        for (x, weight) in gauss_legendre(mesh.gauss_points()) {
            let s = knot(e) + width * x;
            let weight = weight * width;
            let [d, da, db] = [u, moved.a, moved.b].map(|x| displacement(problem, x, s, side));
            let u = |k: usize| H::new(d[k].0, da[k].0, db[k].0, 0.0);
            let w = |k: usize| H::new(d[k].1, da[k].1, db[k].1, 0.0);
            let (sin, cos) = s.sin_cos();
            let (r, r1, r2) = (u(0) + sin, u(1) + cos, u(2) - sin);
            let (z, z1, z2) = (w(0) + cos, w(1) - sin, w(2) - cos);
            let q = r1 * r1 + z1 * z1;
            let hoop = r * (1.0 / sin);
            let membrane = membrane::check::energy(problem.shell.law, [q, hoop * hoop], nu, share);
            let (ks, kphi) = bending::strains(r1, r2, z1, z2, real(1.0 / sin));
            let bend = kb * (ks * ks + nu * ks * kphi * 2.0 + kphi * kphi) * 0.5;
            let gap = match side {
                Side::Top => moved.plates[0] - z,
                Side::Bottom => z + moved.plates[1],
            };
            let (adhesion, length) = films[side as usize];
            let films = [problem.potentials.0, problem.potentials.1];
            let film = films[side as usize].energy(gap, adhesion, length);
            total += (membrane + bend) * (weight * sin) + (film + tension) * r * q.sqrt() * weight;
            volume += -(r * r * z1) * (0.5 * weight);
        }
    }
    let rest = 2.0 / 3.0;
    let power = exponent - 1.0;
    let work = (((volume.recip() * rest).ln() * power).exp() - 1.0) * rest / power;
    total + ambient * (volume - rest) + (ambient + tension * 2.0) * work
}

/// As many as there are with a law that has `b`.
const COUNT: usize = parameter::B.0 + 1;

fn parameters(p: &[f64]) -> [H; COUNT] {
    std::array::from_fn(|k| real(p.get(k).copied().unwrap_or(0.0)))
}

/// A problem against `potential(a, b, p)`, its total energy moved along two directions of its
/// unknowns and with dual parameters.
fn certify<P: Problem>(
    problem: &P,
    x: &[f64],
    p: &[f64],
    potential: impl Fn(&[f64], &[f64], [H; COUNT]) -> H,
) {
    let n = problem.dim();
    let (mut r, mut alone) = (vec![0.0; n], vec![0.0; n]);
    let (mut j, mut again) = (problem.new_jacobian(), problem.new_jacobian());
    problem.linearise(x, p, &mut r, &mut j).unwrap();
    problem.residual(x, p, &mut alone).unwrap();
    problem.jacobian(x, p, &mut again).unwrap();
    assert!((0..n).all(|i| (r[i] - alone[i]).abs() < 1e-14));
    let size = |x: &[f64], y: &[f64]| dot(x, x).sqrt() * dot(y, y).sqrt();
    let (mut jb, mut jb_again) = (vec![0.0; n], vec![0.0; n]);
    for seed in 0..4 {
        let a = state(n, 1.0 + f64::from(seed), 1.0);
        let b = state(n, 2.7 * f64::from(seed), 1.0);
        let e = potential(&a, &b, parameters(p));
        close(dot(&r, &a), e.eps1, 1e-12, 1e-14 * size(&r, &a));
        j.mul(&b, &mut jb);
        again.mul(&b, &mut jb_again);
        close(dot(&a, &jb), e.eps1eps2, 1e-12, 1e-14 * size(&a, &jb));
        close(dot(&a, &jb), dot(&a, &jb_again), 1e-13, 1e-14 * size(&a, &jb));
        for k in 0..p.len() {
            let mut dual = parameters(p);
            dual[k].eps2 = 1.0;
            let e = potential(&a, &vec![0.0; n], dual);
            problem.parameter_derivative(x, p, ParamId(k), &mut alone).unwrap();
            close(dot(&alone, &a), e.eps1eps2, 1e-12, 1e-13 * size(&alone, &a));
        }
    }
}

#[test]
fn residual_hessian_and_parameter_derivatives_agree_with_dual_numbers() {
    for law in [Law::Hooke, Law::MooneyRivlin { b: 0.7 }, Law::Skalak] {
        let problem = problem(law);
        let u = state(problem.dim(), 0.3, 0.01);
        let p = problem.parameters_at(Z0);
        certify(&problem, &u, &p, |a, b, p| {
            energy(&problem, &u, &Moved { a, b, p, plates: [p[0]; 2] })
        });
    }
}

#[test]
fn plates_with_different_potentials_agree_with_dual_numbers() {
    let [one, other] = check::every();
    for films in [(one, other), (other, one)] {
        let problem = problem_with(Law::Hooke, films);
        let u = state(problem.dim(), 0.3, 0.01);
        let p = problem.parameters_at(Z0);
        certify(&problem, &u, &p, |a, b, p| {
            energy(&problem, &u, &Moved { a, b, p, plates: [p[0]; 2] })
        });
        slopes_agree(&problem, &u, &p, [8, 8]);
    }
}

#[test]
fn supports_agree_with_dual_numbers() {
    let shell = problem(Law::MooneyRivlin { b: 0.7 });
    let n = shell.dim();
    for support in SUPPORTS {
        let problem = SupportedProblem::new(&shell, support).unwrap();
        let mut x = problem.state(&state(n, 0.3, 0.01), 1.09);
        if support.held {
            x[n] = 0.02;
        }
        let p = problem.parameters_at(Z0);
        certify(&problem, &x, &p, |a, b, p| {
            let unknown = |k: usize| H::new(x[k], a[k], b[k], 0.0);
            let last = problem.dim() - 1;
            let top = if support.spring.is_some() { unknown(last) } else { p[0] };
            let moved = Moved { a: &a[..n], b: &b[..n], p, plates: [top, p[0]] };
            let mut total = energy(&shell, &x[..n], &moved);
            if support.held {
                let [w, wa, wb] = [&x[..n], moved.a, moved.b]
                    .map(|x| displacement(&shell, x, FRAC_PI_2, Side::Top)[0].1);
                total -= unknown(n) * H::new(w, wa, wb, 0.0);
            }
            if let Some(stiffness) = support.spring {
                let stretch = top - p[0];
                let unit = p[parameter::BENDING.0].sqrt() * (0.25 * stiffness / PI);
                total += unit * stretch * stretch;
            }
            total
        });
    }
}

/// Analytic slopes of observables against central differences of the observables themselves.
fn slopes_agree<P: Problem>(problem: &P, x: &[f64], p: &[f64], known: [usize; 2]) {
    let dx = state(x.len(), 1.9, 1.0);
    let observables = problem.observables().len();
    for which in 0..p.len() {
        let at = |t: f64| {
            let moved: Vec<f64> = x.iter().zip(&dx).map(|(x, d)| x + t * d).collect();
            let mut p = p.to_vec();
            p[which] += t * 0.3 * p[which];
            let mut out = vec![0.0; observables];
            problem.observe(&moved, &p, &mut out).unwrap();
            out
        };
        let h = 1e-5;
        let (up, down, up2, down2) = (at(h), at(-h), at(2.0 * h), at(-2.0 * h));
        let mut count = 0;
        for k in 0..observables {
            let dp = 0.3 * p[which];
            let slope = problem.observable_slope(k, x, p, ParamId(which), &dx, dp).unwrap();
            if let Some(slope) = slope {
                count += 1;
                let difference = (8.0 * (up[k] - down[k]) - (up2[k] - down2[k])) / (12.0 * h);
                close(slope, difference, 1e-8, 1e-9);
            }
        }
        assert!(known.contains(&count), "{count}");
    }
}

#[test]
fn observable_slopes_agree_with_differences() {
    let shell = problem(Law::Hooke);
    let n = shell.dim();
    slopes_agree(&shell, &state(n, 0.3, 0.01), &shell.parameters_at(Z0), [8, 8]);
    for support in SUPPORTS {
        let problem = SupportedProblem::new(&shell, support).unwrap();
        let x = problem.state(&state(n, 0.3, 0.01), 1.09);
        slopes_agree(&problem, &x, &problem.parameters_at(Z0), [8, 9]);
    }
}

/// The gradient is that of the reported energy: U_T = 2π E.
#[test]
fn residual_is_the_gradient_of_the_reported_energy() {
    let problem = problem(Law::MooneyRivlin { b: 1.0 });
    let n = problem.dim();
    let (u, p) = (state(n, 0.3, 0.01), problem.parameters_at(Z0));
    let total = energy(
        &problem,
        &u,
        &Moved { a: &vec![0.0; n], b: &vec![0.0; n], p: parameters(&p), plates: [real(Z0); 2] },
    );
    let seen = problem.observation(&u, &p).unwrap();
    close(seen.whole.energy_total, 2.0 * PI * total.re, 1e-12, 0.0);
    close(problem.total_energy(&u, &p).unwrap(), seen.whole.energy_total, 1e-14, 0.0);
    assert_eq!(seen.to_array().len(), NAMES.len());
}

#[test]
fn impossible_parameters_are_named() {
    let shell = problem(Law::Hooke);
    for value in [0.0, -1.0, f64::INFINITY] {
        let support = Support { spring: Some(value), ..Support::default() };
        let error = SupportedProblem::new(&shell, support).map(|_| ()).unwrap_err();
        assert_eq!(error.key(), "plate.top.stiffness");
    }
    let mut groups = *shell.groups();
    groups.bottom.film = -1.0;
    let mesh = Mesh::uniform(10).unwrap();
    let error = TwoPlatesProblem::new(shell.shell(), &groups, mesh).map(|_| ()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "plate.bottom.film = -1: must be positive (delta_A/R0, for example 0.033)"
    );
    let u = shell.initial_state();
    let crossed = shell.admissible(&u, &shell.parameters_at(-0.1)).unwrap_err().to_string();
    assert!(crossed.starts_with("the plates cross"), "{crossed}");
}
