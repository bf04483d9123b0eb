//! A thin sphere buckling under external pressure (Zoelly, 1915).
//!
//! The shell of [`shell_contact`], Hooke's law, no plates, no film, no gas: energy `E + pV̂` of the
//! half shell over `2π`, the pressure following the surface. Lengths in `R0`, `p` in `χ/R0`,
//! `bending` = `k_b/(χR0²)`. Mirror-symmetric axisymmetric displacements by Ritz's method,
//!
//! ```text
//! w = Σ a_l √(2l+1) P_l(cos S),   v = Σ b_l √((2l+1)/(l(l+1))) dP_l(cos S)/dS,   l = 0, 2, 4, …
//! ```
//! radial and along the meridian, orthonormal over the half sphere, so that the metric is the
//! identity; integrals by Gauss-Legendre quadrature in `S`, exact to rounding for smooth shapes.
//!
//! Unlike on a mesh of splines, the sphere that shrinks uniformly to the radius `λ`,
//! `p = (1 − λ²)/(λ(1 − ν))`, is an exact solution, and every even `l ≥ 2` has an exact branch point
//! on it, transcritical. The second variation in `(a_l, b_l)`, with `N = l(l + 1)`,
//! `A = 1/(1 − ν²)`, `τ = (λ² − 1)/(2(1 − ν))` and `B = k_b N(N − 1 + ν)/λ²`, is singular where
//!
//! ```text
//! [2(1 + ν)Aλ² + (N − 2)τ + B] [(N − 1 + ν)NAλ² + N(N − 2)τ + B] = [(1 + ν)NAλ² + B]²
//! ```
//! With `k_b = 1e-3`, `ν = 0.3`: `l = 4` at 1.0193240417, `l = 6` at 1.0544402803 times `4√k_b`, which
//! the lowest one is to leading order. (`l = 5`, at 0.9685, is not symmetric about the equator.)

use crate::visit::hand;
use crate::{Allowed, Constant, Elements, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::linalg::{Dense, Matrix};
use continuation::{EvalError, Name, ParamId, Parameter, Problem, Stability, names};
use shell_contact::density::{self, Coefficients, Hessian, Site};
use shell_contact::film::FourTwo;
use shell_contact::membrane::Hooke;
use shell_contact::meridian::Place;
use shell_contact::quadrature::gauss_legendre;
use std::f64::consts::FRAC_PI_2;

/// `σ, σ', σ'', z, z', z''` of a basis function at a point.
type Jet = [f64; 6];

/// See the module. Parameters: pressure, bending.
#[derive(Debug, Clone)]
pub struct PressurisedSphere {
    dim: usize,
    poisson: f64,
    parameters: [Parameter; 2],
    points: Vec<Point>,
    /// Basis functions at the points, those of a point together.
    basis: Vec<Jet>,
}

/// A point's site and basis functions, and the deformed meridian there.
type Deformed<'a> = (&'a Site<f64>, &'a [Jet], Place<f64>);

#[derive(Debug, Clone, Copy)]
struct Point {
    site: Site<f64>,
    sphere: Jet,
}

/// `P_l(cos S)` and its first three derivatives in `S`, for `l = 0 … most`.
fn legendre(most: usize, s: f64) -> Vec<[f64; 4]> {
    let (sin, cos) = s.sin_cos();
    let cot = cos / sin;
    // P_l and P_l' = dP_l/dx by recurrence; the others by Legendre's equation
    let (mut p, mut dp) = ([0.0, 1.0], [0.0, 0.0]);
    (0..=most)
        .map(|l| {
            let n = l as f64;
            if l > 0 {
                let next = ((2.0 * n - 1.0) * cos * p[1] - (n - 1.0) * p[0]) / n;
                let slope = dp[0] + (2.0 * n - 1.0) * p[1];
                p = [p[1], next];
                dp = [dp[1], slope];
            }
            let m = n * (n + 1.0);
            let first = -sin * dp[1];
            let second = -cot * first - m * p[1];
            let third = -cot * second + first / (sin * sin) - m * first;
            [p[1], first, second, third]
        })
        .collect()
}

/// The jet of the displacement with radial part `w` and meridional part `v`.
fn jet(s: f64, w: [f64; 3], v: [f64; 3]) -> Jet {
    let (sin, cos) = s.sin_cos();
    let times_sin = |f: [f64; 3]| {
        [f[0] * sin, f[1] * sin + f[0] * cos, f[2] * sin + 2.0 * f[1] * cos - f[0] * sin]
    };
    let times_cos = |f: [f64; 3]| {
        [f[0] * cos, f[1] * cos - f[0] * sin, f[2] * cos - 2.0 * f[1] * sin - f[0] * cos]
    };
    let [ws, wc, vs, vc] = [times_sin(w), times_cos(w), times_sin(v), times_cos(v)];
    [ws[0] + vc[0], ws[1] + vc[1], ws[2] + vc[2], wc[0] - vs[0], wc[1] - vs[1], wc[2] - vs[2]]
}

fn dot(a: &Jet, b: &Jet) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `H x` for the pointwise Hessian.
fn apply(h: &Hessian<f64>, x: &Jet) -> Jet {
    let [s, s1, s2, z, z1, z2] = *x;
    [
        h.s_s * s + h.s_s1 * s1 + h.s_z * z + h.s_z1 * z1,
        h.s_s1 * s + h.s1_s1 * s1 + h.s1_s2 * s2 + h.s1_z * z + h.s1_z1 * z1 + h.s1_z2 * z2,
        h.s1_s2 * s1 + h.s2_s2 * s2 + h.s2_z1 * z1 + h.s2_z2 * z2,
        h.s_z * s + h.s1_z * s1 + h.z_z * z + h.z_z1 * z1,
        h.s_z1 * s + h.s1_z1 * s1 + h.s2_z1 * s2 + h.z_z1 * z + h.z1_z1 * z1 + h.z1_z2 * z2,
        h.s1_z2 * s1 + h.s2_z2 * s2 + h.z1_z2 * z1 + h.z2_z2 * z2,
    ]
}

impl PressurisedSphere {
    /// With the degrees `l = 0, 2, …, 2·count − 2`; `count ≥ 2`.
    pub fn new(count: usize, poisson: f64) -> Self {
        let count = count.max(2);
        let most = 2 * count - 2;
        let (mut points, mut basis) = (Vec::new(), Vec::new());
        for (x, weight) in gauss_legendre(3 * count + 12) {
            let s = FRAC_PI_2 * x;
            let weight = FRAC_PI_2 * weight;
            let site = Site { weight, area: weight * s.sin(), csc: 1.0 / s.sin() };
            points.push(Point { site, sphere: jet(s, [1.0, 0.0, 0.0], [0.0; 3]) });
            let p = legendre(most, s);
            for l in (0..=most).step_by(2) {
                let norm = (2.0 * l as f64 + 1.0).sqrt();
                basis.push(jet(s, [0, 1, 2].map(|k| norm * p[l][k]), [0.0; 3]));
            }
            for l in (2..=most).step_by(2) {
                let n = l as f64;
                let norm = ((2.0 * n + 1.0) / (n * (n + 1.0))).sqrt();
                basis.push(jet(s, [0.0; 3], [1, 2, 3].map(|k| norm * p[l][k])));
            }
        }
        let parameters = [
            Parameter::new("pressure", "chi/R0", 0.1),
            Parameter::new("bending", "chi R0^2", 1e-3),
        ];
        PressurisedSphere { dim: 2 * count - 1, poisson, parameters, points, basis }
    }

    /// Radius of the uniformly shrunk sphere.
    pub fn radius(&self, pressure: f64) -> f64 {
        let b = 0.5 * (1.0 - self.poisson) * pressure;
        (1.0 + b * b).sqrt() - b
    }

    fn coefficients(&self, p: &[f64]) -> Coefficients {
        Coefficients {
            bending: p[1],
            poisson: self.poisson,
            b: 0.0,
            surface_tension: 0.0,
            adhesion: 0.0,
            film: 1.0,
            plate: 1e3,
        }
    }

    fn places<'a>(&'a self, u: &'a [f64]) -> impl Iterator<Item = Result<Deformed<'a>, EvalError>> {
        self.points.iter().zip(self.basis.chunks_exact(self.dim)).enumerate().map(
            move |(at, (point, basis))| {
                let mut x = point.sphere;
                for (u, b) in u.iter().zip(basis) {
                    for (x, b) in x.iter_mut().zip(b) {
                        *x += u * b;
                    }
                }
                let [s, s1, s2, z, z1, z2] = x;
                let q = s1 * s1 + z1 * z1;
                if !(s.is_finite() && q.is_finite()) {
                    return Err(EvalError::NotFinite { at });
                }
                let what = "the shell crosses its axis, or its meridian has a cusp";
                if s <= 0.0 || q <= 1e-8 {
                    return Err(EvalError::Inadmissible { what, at, value: s.min(q) });
                }
                Ok((&point.site, basis, Place { s: [s, s1, s2], z: [z, z1, z2] }))
            },
        )
    }

    fn volume(&self, u: &[f64]) -> Result<f64, EvalError> {
        let mut sum = 0.0;
        for place in self.places(u) {
            let (site, _, x) = place?;
            sum -= 0.5 * site.weight * x.s[0] * x.s[0] * x.z[1];
        }
        Ok(sum)
    }
}

/// Gradient of `½σ²(−z')` at a point.
fn volume_gradient(site: &Site<f64>, x: &Place<f64>) -> Jet {
    let s = site.weight * x.s[0];
    [-s * x.z[1], 0.0, 0.0, 0.0, -0.5 * s * x.s[0], 0.0]
}

fn scatter(basis: &[Jet], g: &Jet, out: &mut [f64]) {
    for (out, b) in out.iter_mut().zip(basis) {
        *out += dot(b, g);
    }
}

impl Problem for PressurisedSphere {
    type Jacobian = Dense;

    fn dim(&self) -> usize {
        self.dim
    }

    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn new_jacobian(&self) -> Dense {
        Dense::new(self.dim)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let (law, c) = (Hooke { poisson: self.poisson }, self.coefficients(p));
        r.fill(0.0);
        for place in self.places(u) {
            let (site, basis, x) = place?;
            let g = density::gradient(&law, &FourTwo, &c, site, &x);
            let v = volume_gradient(site, &x);
            let [s, z] = [g.s, g.z];
            let mut total = [s[0], s[1], s[2], z[0], z[1], z[2]];
            total.iter_mut().zip(&v).for_each(|(t, v)| *t += p[0] * v);
            scatter(basis, &total, r);
        }
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        let (law, c) = (Hooke { poisson: self.poisson }, self.coefficients(p));
        j.set_zero();
        for place in self.places(u) {
            let (site, basis, x) = place?;
            let (_, hessian) = density::linearise(&law, &FourTwo, &c, -p[0], site, &x);
            for (k, b) in basis.iter().enumerate() {
                let column = apply(&hessian, b);
                for (i, b) in basis.iter().enumerate().take(k + 1) {
                    j.add(i, k, dot(b, &column));
                }
            }
        }
        for k in 0..self.dim {
            for i in 0..k {
                let value = j.get(i, k);
                j.set(k, i, value);
            }
        }
        Ok(())
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        _p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        out.fill(0.0);
        for place in self.places(u) {
            let (site, basis, x) = place?;
            if which.0 == 0 {
                scatter(basis, &volume_gradient(site, &x), out);
            } else {
                let g = density::bending_gradient(self.poisson, site, &x);
                scatter(basis, &[g.s[0], g.s[1], g.s[2], g.z[0], g.z[1], g.z[2]], out);
            }
        }
        Ok(())
    }

    /// Displacements are lengths in `R0`, of the size of the pressure in `χ/R0`.
    fn unknown_scale(&self, which: ParamId) -> Option<f64> {
        (which.0 == 0).then_some(0.1)
    }

    fn stability(&self) -> Stability {
        Stability::EnergyHessian
    }

    /// Radial displacement of the pole, outwards; volume of the sphere over that at rest; length
    /// of the displacement without its uniform part.
    fn observables(&self) -> &[Name] {
        names!["pole", "volume", "buckling"]
    }

    fn observe(&self, u: &[f64], _p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        let count = self.dim.div_ceil(2);
        out[0] = (0..count).map(|k| (4.0 * k as f64 + 1.0).sqrt() * u[k]).sum();
        out[1] = 3.0 * self.volume(u)?;
        out[2] = u[1..].iter().map(|x| x * x).sum::<f64>().sqrt();
        Ok(())
    }
}

const SOURCE: &str = "zero of the second variation, closed form";

pub(crate) static ENTRY: Entry = Entry {
    name: "pressurised-sphere",
    summary: "a sphere under external pressure: buckling at 1.0193 and 1.0544 times 4 sqrt(bending)",
    parameter: "pressure",
    axes: &[
        ("pressure", "external pressure pR₀/χ"),
        ("pole", "radial displacement of the pole over R₀"),
        ("volume", "volume over that at rest"),
        ("buckling", "amplitude of buckling"),
    ],
    start: 0.0,
    start_allowed: Allowed::AtLeast(0.0),
    end: 0.136,
    parameters: &[
        Constant { name: "bending", default: 1e-3, allowed: Allowed::Above(0.0) },
        Constant { name: "poisson", default: 0.3, allowed: Allowed::Within(-0.99, 0.5) },
    ],
    elements: Some(Elements { default: 12, least: 4, most: 64, what: "even degrees from 0" }),
    known: &[
        Known::branch_point(0.128_935_425_822_258, 1e-11, SOURCE).form("transcritical"),
        Known::branch_point(0.133_377_317_691_380, 1e-11, SOURCE).form("transcritical"),
    ],
    id: Id::PressurisedSphere,
};

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    let problem = PressurisedSphere::new(request.elements, request.parameter(1));
    let mut u = vec![0.0; problem.dim()];
    u[0] = problem.radius(request.start) - 1.0;
    let mut setup = Setup::new(ENTRY.parameter, u, request);
    // Poisson's ratio is not among the problem's parameters
    setup.p.truncate(2);
    Ok(hand(visitor, &problem, setup))
}
