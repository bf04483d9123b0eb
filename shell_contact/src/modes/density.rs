//! The second variation at a point of the meridian, as a polynomial in `n`.
//!
//! The surface is perturbed by `(u cos nφ, v sin nφ, w cos nφ)` in the cylindrical directions.
//! Every strain is linear in `cos nφ` or `sin nφ`, so the mean over `φ` is half the sum of the
//! pointwise second variations at the two phases `(cos, sin) = (1, 0)` and `(0, 1)`.
//!
//! *Phase c.* Metric and curvature stay diagonal. With `B = u + nv` for the change of radius the
//! density is that of the half meridian, [`density::linearise`], but for the hoop bending strain,
//! which gains `[−z'(n²u + nv) + σ' n²w]/(sin S λ σ)` and so a second-order term too.
//!
//! *Phase s.* Nothing changes to first order but the shear, the twist and the slope of the
//! parallels: with `(r_φ)_ρ = A = −(nu + v)`, `(r_φ)_z = D = −nw`, normal slope
//! `λω = σ'D − z'A` and `λτ = σ'A + z'D` the second-order parts of area, strains and curvatures
//! are quadratic in few linear forms, written out below.
//!
//! Both phases are quadratic forms in variables that are themselves polynomials in `n` of the nine
//! numbers `p = (u, v, w, u', v', w', u'', v'', w'')`; expanding them gives five 9×9 matrices. In
//! those of `n³` and `n⁴` no derivative takes part. The expansion is written out: which entries are
//! zero is the same at every point.

use crate::bending::strain_jet;
use crate::density::{self, Coefficients, Site};
use crate::film::Potential;
use crate::membrane::Membrane;
use crate::meridian::Place;
use crate::scalar::Scalar;

/// Powers of `n`, from 0.
pub(super) const POWERS: usize = 5;

/// `Σ nᵏ H[k]` is the Hessian in `p`, both phases together, times the weight; of two fields the rows of the first
/// of them in the order `u, v, w`.
pub(super) type Polynomial<T> = [[[T; 9]; 9]; POWERS];

/// Variables of phase c: `B = u + nv`, `U … W2` the fields and their derivatives, `R = n²u + nv`, `X = n²w`.
const B: usize = 0;
const U: usize = 1;
const U1: usize = 2;
const U2: usize = 3;
const W: usize = 4;
const W1: usize = 5;
const W2: usize = 6;
const R: usize = 7;
const X: usize = 8;

/// Variables of phase s: `A = −(nu + v)`, `D = −nw` and their derivatives, `V … V2` those of `v`,
/// `E = A − nB = −2nu − (1 + n²)v`.
const A: usize = 0;
const D: usize = 1;
const A1: usize = 2;
const D1: usize = 3;
const V: usize = 4;
const V1: usize = 5;
const V2: usize = 6;
const E: usize = 7;

/// A quadratic form by its Hessian, whose upper triangle is kept.
struct Quadratic<T, const N: usize>([[T; N]; N]);

impl<T: Scalar, const N: usize> Quadratic<T, N> {
    #[inline(always)]
    fn zero() -> Self {
        Quadratic([[T::constant(0.0); N]; N])
    }

    /// Adds `c f g` of two linear forms, given by their entries that are not zero.
    #[inline(always)]
    fn add(&mut self, c: T, f: &[(usize, T)], g: &[(usize, T)]) {
        for &(a, fa) in f {
            let cf = c * fa;
            for &(b, gb) in g {
                let term = if a == b { cf * gb * 2.0 } else { cf * gb };
                let entry = &mut self.0[a.min(b)][a.max(b)];
                *entry = *entry + term;
            }
        }
    }

    /// An entry.
    #[inline(always)]
    fn get(&self, a: usize, b: usize) -> T {
        self.0[a.min(b)][a.max(b)]
    }
}

/// The fields' indices in `p`.
mod p {
    pub(super) const U: usize = 0;
    pub(super) const V: usize = 1;
    pub(super) const W: usize = 2;
    pub(super) const U1: usize = 3;
    pub(super) const V1: usize = 4;
    pub(super) const W1: usize = 5;
    pub(super) const U2: usize = 6;
    pub(super) const V2: usize = 7;
    pub(super) const W2: usize = 8;
}

/// Sets both entries of a field with itself.
#[inline(always)]
fn set<T: Copy>(h: &mut [[T; 9]; 9], i: usize, j: usize, value: T) {
    h[i][j] = value;
    h[j][i] = value;
}

/// Both phases in `p`: `u` is `B + U + n²R` of phase c and `−nA − 2nE` of phase s, `v` is `n(B + R)` and
/// `V − A − (1 + n²)E`, `w` is `W + n²X` and `−nD`; `u' = U1 − nA1`, `v' = V1 − A1`, `w' = W1 − nD1`.
#[inline(always)]
fn expand<T: Scalar>(
    cosine: &Quadratic<T, 9>,
    sine: &Quadratic<T, 8>,
    [h0, h1, h2, h3, h4]: &mut Polynomial<T>,
) {
    let c = |a, b| cosine.get(a, b);
    let s = |a, b| sine.get(a, b);

    // u with itself
    h0[p::U][p::U] = c(B, B) + c(B, U) * 2.0;
    h2[p::U][p::U] = c(B, R) * 2.0 + s(A, A) + s(A, E) * 4.0;
    h4[p::U][p::U] = c(R, R);
    set(h0, p::U, p::U1, c(B, U1));
    set(h2, p::U, p::U1, c(U1, R) + s(A, A1));
    set(h2, p::U, p::U2, c(U2, R));
    h0[p::U1][p::U1] = c(U1, U1);
    h2[p::U1][p::U1] = s(A1, A1);
    set(h0, p::U1, p::U2, c(U1, U2));
    h0[p::U2][p::U2] = c(U2, U2);

    // w with itself
    h0[p::W][p::W] = c(W, W);
    h2[p::W][p::W] = s(D, D);
    h4[p::W][p::W] = c(X, X);
    set(h0, p::W, p::W1, c(W, W1));
    set(h2, p::W, p::W1, c(W1, X) + s(D, D1));
    set(h2, p::W, p::W2, c(W2, X));
    h0[p::W1][p::W1] = c(W1, W1);
    h2[p::W1][p::W1] = s(D1, D1);
    set(h0, p::W1, p::W2, c(W1, W2));
    h0[p::W2][p::W2] = c(W2, W2);

    // v with itself
    h0[p::V][p::V] = s(A, A) + (s(A, E) - s(A, V)) * 2.0;
    h2[p::V][p::V] = c(B, B) + c(B, R) * 2.0 + c(R, R) + s(A, E) * 2.0;
    set(h0, p::V, p::V1, s(A, A1) - s(A, V1));
    set(h0, p::V, p::V2, -s(A, V2));
    h0[p::V1][p::V1] = s(A1, A1) - s(A1, V1) * 2.0 + s(V1, V1);

    // u with w
    h0[p::U][p::W] = c(B, W);
    h2[p::U][p::W] = c(B, X) + s(A, D) + s(D, E) * 2.0;
    h4[p::U][p::W] = c(R, X);
    h0[p::U][p::W1] = c(B, W1) + c(U, W1);
    h2[p::U][p::W1] = c(W1, R) + s(A, D1);
    h2[p::U][p::W2] = c(W2, R);
    h0[p::U1][p::W] = c(U1, W);
    h2[p::U1][p::W] = c(U1, X) + s(A1, D);
    h0[p::U1][p::W1] = c(U1, W1);
    h2[p::U1][p::W1] = s(A1, D1);
    h0[p::U1][p::W2] = c(U1, W2);
    h2[p::U2][p::W] = c(U2, X);
    h0[p::U2][p::W1] = c(U2, W1);
    h0[p::U2][p::W2] = c(U2, W2);

    // u with v
    h1[p::U][p::V] = c(B, B) + c(B, U) + c(B, R) + s(A, A) - s(A, V) + s(A, E) * 3.0;
    h3[p::U][p::V] = c(B, R) + c(R, R) + s(A, E);
    h1[p::U][p::V1] = s(A, A1) - s(A, V1);
    h1[p::U][p::V2] = -s(A, V2);
    h1[p::U1][p::V] = c(B, U1) + c(U1, R) + s(A, A1);
    h1[p::U1][p::V1] = s(A1, A1) - s(A1, V1);
    h1[p::U2][p::V] = c(U2, R);

    // v with w
    h1[p::V][p::W] = c(B, W) + s(A, D) - s(D, V) + s(D, E);
    h3[p::V][p::W] = c(B, X) + c(R, X) + s(D, E);
    h1[p::V][p::W1] = c(B, W1) + c(W1, R) + s(A, D1);
    h1[p::V][p::W2] = c(W2, R);
    h1[p::V1][p::W] = s(A1, D) - s(D, V1);
    h1[p::V1][p::W1] = s(A1, D1) - s(D1, V1);
    h1[p::V2][p::W] = -s(D, V2);
}

/// Sets `out` to the second variation at a point; `excess` is `P_G − P_A`. Entries that are zero everywhere are
/// not written.
#[inline(always)]
pub(super) fn second_variation<T: Scalar, L: Membrane, F: Potential>(
    law: &L,
    film: &F,
    c: &Coefficients,
    excess: f64,
    at: &Site<T>,
    x: &Place<T>,
    out: &mut Polynomial<T>,
) {
    let (cosine, sine) = (cosine(law, film, c, excess, at, x), sine(law, film, c, excess, at, x));
    expand(&cosine, &sine, out);
}

#[inline(always)]
fn cosine<T: Scalar, L: Membrane, F: Potential>(
    law: &L,
    film: &F,
    c: &Coefficients,
    excess: f64,
    at: &Site<T>,
    x: &Place<T>,
) -> Quadratic<T, 9> {
    let (_, h) = density::linearise(law, film, c, 0.0, at, x);
    let mut q = Quadratic::zero();
    for (a, b, value) in [
        (B, B, h.s_s),
        (B, U1, h.s_s1),
        (B, W, h.s_z),
        (B, W1, h.s_z1),
        (U1, U1, h.s1_s1),
        (U1, U2, h.s1_s2),
        (U1, W, h.s1_z),
        (U1, W1, h.s1_z1),
        (U1, W2, h.s1_z2),
        (U2, U2, h.s2_s2),
        (U2, W1, h.s2_z1),
        (U2, W2, h.s2_z2),
        (W, W, h.z_z),
        (W, W1, h.z_z1),
        (W1, W1, h.z1_z1),
        (W1, W2, h.z1_z2),
        (W2, W2, h.z2_z2),
    ] {
        q.0[a][b] = value;
    }
    let ([s, s1, s2], [_, z1, z2]) = (x.s, x.z);
    let unit = T::constant(1.0);

    // −Δp ½ (r_ρ N_ρ + r_φ N_φ) = Δp ½ (σ + u)(σ + B)(z' + w')
    let half = at.weight * (0.5 * excess);
    q.add(half * z1, &[(U, unit)], &[(B, unit)]);
    q.add(half * s, &[(W1, unit)], &[(U, unit), (B, unit)]);

    // what the hoop bending strain gains: y = (−z'R + σ'X)/(sin S λ σ), to second order
    let iq = (s1 * s1 + z1 * z1).recip();
    let ia = iq.sqrt();
    let k = strain_jet(s1, s2, z1, z2, at.csc, iq, ia);
    let kb = at.area * c.bending;
    let moment = kb * (k.kphi + k.ks * c.poisson);
    let f = at.csc * ia / s;
    let y = [(R, -(z1 * f)), (X, s1 * f)];
    let nu = c.poisson;
    let by_strain = [
        (U1, k.kphi_s + k.ks_s * nu),
        (W1, k.kphi_z + k.ks_z * nu),
        (U2, k.psi_s * nu),
        (W2, k.psi_z * nu),
    ];
    q.add(kb, &by_strain, &y);
    q.add(kb * 0.5, &y, &y);
    q.add(moment * f, &[(U1, unit)], &[(X, unit)]);
    q.add(-(moment * f), &[(W1, unit)], &[(R, unit)]);
    q.add(-moment, &y, &[(U1, s1 * iq), (W1, z1 * iq), (B, s.recip())]);
    q
}

#[inline(always)]
fn sine<T: Scalar, L: Membrane, F: Potential>(
    law: &L,
    film: &F,
    c: &Coefficients,
    excess: f64,
    at: &Site<T>,
    x: &Place<T>,
) -> Quadratic<T, 8> {
    let ([s, s1, s2], [z, z1, z2]) = (x.s, x.z);
    let lambda2 = s1 * s1 + z1 * z1;
    let iq = lambda2.recip();
    let ia = iq.sqrt();
    let lambda = lambda2 * ia;
    let mu = s * at.csc;
    let is = s.recip();
    let k = strain_jet(s1, s2, z1, z2, at.csc, iq, ia);
    let (turning, hoop) = (k.ks + 1.0, k.kphi + 1.0); // λ_s k_s and λ_φ k_φ
    let kb = at.area * c.bending;
    let ms = kb * (k.ks + k.kphi * c.poisson);
    let mf = kb * (k.kphi + k.ks * c.poisson);
    let (m, csc2) = (mu * mu, at.csc * at.csc);
    let jet = law.jet(lambda2, m);
    let tension = film.jet(-(z - c.plate), c.adhesion, c.film).w + c.surface_tension;

    let unit = T::constant(1.0);
    let one = |a: usize| [(a, unit)];
    let omega = [(D, s1 * ia), (A, -(z1 * ia))];
    let tau = [(A, s1 * ia), (D, z1 * ia)];
    // C_12, U_12 and b_12
    let c12 = [(A, s1 * at.csc), (D, z1 * at.csc), (V1, mu)];
    let per = (lambda + mu).recip();
    let u12 = c12.map(|(a, x)| (a, x * per));
    let f = at.csc * ia;
    let g = f * lambda * s1 * is;
    let b12 = [(A1, z1 * f), (D1, -(s1 * f)), (D, g * s1 * ia), (A, -(g * z1 * ia))];
    // twist: K_12 = ½[(λ + μ) b_12 − U_12 (b_11 + b_22)]/(λμ)
    let i_lm = (lambda * mu).recip();
    let (by_b, by_u) = ((lambda + mu) * i_lm * 0.5, -((lambda * turning + mu * hoop) * i_lm * 0.5));
    let k12 = [
        (A, b12[3].1 * by_b + u12[0].1 * by_u),
        (D, b12[2].1 * by_b + u12[1].1 * by_u),
        (V1, u12[2].1 * by_u),
        (A1, b12[0].1 * by_b),
        (D1, b12[1].1 * by_b),
    ];

    let mut q = Quadratic::zero();
    // area: J = λσ + λω²/(2σ) − v'τ, with what surface and curvatures multiply it by
    let area = at.weight * tension - (ms * turning + mf * hoop) * ia * is * 2.0;
    q.add(area * lambda * is * 0.5, &omega, &omega);
    q.add(-area, &one(V1), &tau);
    // C_11 = λ² + v'², C_22 = μ² + (A² + D²)/sin² S
    let by_slope = at.area * jet.w_m * csc2 + ms * turning * is * is * 0.5;
    q.add(by_slope, &one(A), &one(A));
    q.add(by_slope, &one(D), &one(D));
    q.add(at.area * jet.w_q + mf * hoop * iq * 0.5, &one(V1), &one(V1));
    q.add(at.area * law.shear(lambda2, m), &c12, &c12);
    // the square root U of C turns a shear into stretch
    q.add(-(ms * turning / m + mf * hoop * iq) * 0.5, &u12, &u12);
    q.add(-((ms + mf) * i_lm), &u12, &b12);
    // b_11 and b_22
    let along = ms * iq * is;
    q.add(along, &one(V1), &[(A, z2), (D, -s2)]);
    q.add(ms * ia * is, &omega, &one(V2));
    q.add(mf * at.csc * ia * is, &one(V1), &one(D));
    q.add(mf * at.csc * is * is, &omega, &one(E));
    q.add(kb * (1.0 - c.poisson), &k12, &k12);
    // −Δp ½ (r_ρ N_ρ + r_φ N_φ) = Δp ½ (−σ v'D + v λω)
    let half = at.weight * (0.5 * excess);
    q.add(-(half * s), &one(V1), &one(D));
    q.add(half * lambda, &one(V), &omega);
    q
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::{partials, real};
    use crate::film::{Film, check};
    use crate::membrane::{Hooke, MooneyRivlin, Skalak};
    use num_dual::HyperDual64;

    type H = HyperDual64;

    fn is_kept(i: usize, j: usize) -> bool {
        i % 3 <= j % 3
    }

    fn cross(a: [H; 3], b: [H; 3]) -> [H; 3] {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }

    fn inner(a: [H; 3], b: [H; 3]) -> H {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }

    /// The energy per `dS dφ` of the perturbed surface at a phase, from its vectors.
    #[allow(clippy::too_many_arguments)]
    fn energy<L: Membrane>(
        law: &L,
        film: Film,
        k: &Coefficients,
        excess: f64,
        angle: f64,
        x: &Place<f64>,
        n: f64,
        phase: (f64, f64),
        p: [H; 9],
    ) -> H {
        let (c, s) = phase;
        let [u, v, w, u1, v1, w1, u2, v2, w2] = p;
        let s0 = angle.sin();
        let tilt = |v: H, u: H| -(u * n + v);
        let (a, a1) = (tilt(v, u), tilt(v1, u1));
        let (b, b1) = (u + v * n, u1 + v1 * n);
        let (d, d1) = (w * -n, w1 * -n);
        let r = [u * c + x.s[0], v * s, w * c + x.z[0]];
        let rs = [u1 * c + x.s[1], v1 * s, w1 * c + x.z[1]];
        let rss = [u2 * c + x.s[2], v2 * s, w2 * c + x.z[2]];
        let rf = [a * s, b * c + x.s[0], d * s];
        let rsf = [a1 * s, b1 * c + x.s[1], d1 * s];
        let rff = [a * (n * c) - b * c - x.s[0], (a - b * n) * s, d * (n * c)];
        let normal = cross(rs, rf);
        let j = inner(normal, normal).sqrt();
        let [c11, c12, c22] =
            [inner(rs, rs), inner(rs, rf) * (1.0 / s0), inner(rf, rf) * (1.0 / (s0 * s0))];
        let bend = |y: [H; 3], by: f64| -(inner(normal, y) / j) * by;
        let [b11, b12, b22] = [bend(rss, 1.0), bend(rsf, 1.0 / s0), bend(rff, 1.0 / (s0 * s0))];
        let det = j * (1.0 / s0);
        let t = (c11 + c22 + det * 2.0).sqrt();
        let [i11, i12, i22] = [(c22 + det) / t / det, -(c12 / t / det), (c11 + det) / t / det];
        let k11 = i11 * b11 + i12 * b12 - 1.0;
        let k22 = i12 * b12 + i22 * b22 - 1.0;
        let k12 = (i11 * b12 + i12 * b22 + i12 * b11 + i22 * b12) * 0.5;
        let (mean, half) = ((c11 + c22) * 0.5, (c11 - c22) * 0.5);
        // principal stretches; the branch of the root is the base state's
        let root = (half * half + c12 * c12).sqrt();
        let membrane = law.energy(mean + root, mean - root);
        let nu = k.poisson;
        let bending =
            (k11 * k11 + k11 * k22 * (2.0 * nu) + k22 * k22 + k12 * k12 * (2.0 * (1.0 - nu)))
                * (0.5 * k.bending);
        let gap = -(r[2] - k.plate);
        let film = film.energy(gap, real(k.adhesion), real(k.film)) + k.surface_tension;
        // the flux of (x, y, 0)/2
        let volume = (r[0] * normal[0] + r[1] * normal[1]) * 0.5;
        (membrane + bending) * s0 + film * j - volume * excess
    }

    fn certify<L: Membrane>(law: L, film: Film) {
        let k = Coefficients {
            bending: 2e-3,
            poisson: 0.4,
            b: 0.0,
            surface_tension: 0.07,
            adhesion: 3e-2,
            film: 0.04,
            plate: 1.01,
        };
        let excess = 0.37;
        for (angle, shift) in [(0.9_f64, 0.02), (0.1, 0.3), (1.5, -0.1), (0.4, 0.05)] {
            let (sin, cos) = angle.sin_cos();
            let x = Place {
                s: [sin * (1.0 + shift), cos + 0.3 * shift, -sin + 0.5 * shift * sin],
                z: [cos - shift.abs() - 0.02, -sin - 0.4 * shift * sin, -cos + shift],
            };
            let at = Site { weight: 1.0, area: sin, csc: 1.0 / sin };
            let mut found = [[[0.0; 9]; 9]; POWERS];
            second_variation(&law, &film, &k, excess, &at, &x, &mut found);
            for n in 0..7 {
                let n = f64::from(n);
                let both = [(1.0, 0.0), (0.0, 1.0)].map(|phase| {
                    partials([0.0; 9], |p| energy(&law, film, &k, excess, angle, &x, n, phase, p))
                });
                for i in 0..9 {
                    for j in (0..9).filter(|&j| is_kept(i, j)) {
                        let exact = both[0].hessian[i][j] + both[1].hessian[i][j];
                        let sum =
                            (0..POWERS).map(|e| found[e][i][j] * n.powi(e as i32)).sum::<f64>();
                        let row =
                            |i: usize| both[0].hessian[i][i].abs() + both[1].hessian[i][i].abs();
                        let size = (row(i) * row(j)).sqrt().max(exact.abs());
                        let derived = i >= 3 || j >= 3;
                        let highest = found[3][i][j].abs() + found[4][i][j].abs();
                        assert!(!derived || highest == 0.0, "({i}, {j}) has {highest:e}");
                        assert!(
                            (sum - exact).abs() <= 1e-11 * size + 1e-13,
                            "n = {n}, S = {angle}, ({i}, {j}): {sum:e} and {exact:e}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn both_phases_agree_with_dual_numbers_on_the_surface_itself() {
        for film in check::every() {
            certify(Hooke { poisson: 0.4 }, film);
            certify(MooneyRivlin { b: 0.6 }, film);
            certify(Skalak { poisson: 0.4 }, film);
        }
    }
}
