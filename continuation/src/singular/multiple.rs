//! Branch points with a kernel of several dimensions: which branches meet there.
//!
//! With the traced branch along `t` and `φ_1 … φ_k` spanning the vertical part of the kernel, the
//! reduced equations are `2 y₀ a_j(ξ) + q_j(ξ) = 0` where the quadratic terms `q` are there, and
//! `6 y₀ a_j(ξ) + c_j(ξ) = 0` where symmetry removes them; `a_j = ψ_jᵀ F_zz[t, φ·]`. All their real
//! solutions are branches (Küpper, Mittelmann and Weber, *Numerical Methods for Bifurcation
//! Problems*, Birkhäuser, 1984).

use super::circle::{Reduced, Separated};
use super::forms::{Analysed, VERTICAL, direction};
use super::kernel::Singular;
use super::probe::{Extended, Probe};
use super::roots::{Forms, solutions};
use super::small::least_squares;
use crate::branch::{Crossing, Direction, Offset, Shape};
use crate::problem::EvalError;
use crate::step::dot;

/// Quadratic terms below this part of the linear ones are rounding.
const NO_QUADRATIC: f64 = 1e-5;

/// Analyses a point with a kernel of several dimensions; `expected` is the direction in which the
/// traced branch passes.
pub(super) fn analyse(
    probe: &mut Probe<'_>,
    at: &mut Singular,
    expected: &Extended,
) -> Result<Option<Analysed>, EvalError> {
    let k = at.left.len();
    let hat = Hat::of(at);
    let wanted: Vec<f64> = at
        .right
        .iter()
        .zip(&at.amplitude)
        .map(|(v, x)| probe.covector(v).dot(expected) / x)
        .collect();
    let Some(wanted) = unit(wanted) else { return Ok(None) };
    let Some(own) = hat.tangent(wanted.clone()) else { return Ok(None) };
    let traced = hat.vector(at, &own);
    let range = probe.weights.parameter;
    let from_side = traced.p.abs() < VERTICAL * range;
    let normal = if from_side {
        own.clone()
    } else {
        at.right.iter().zip(&at.amplitude).map(|(v, x)| v.p * x / range).collect()
    };
    let Some(basis) = complement(normal) else { return Ok(None) };
    let a = Forms {
        k,
        degree: 1,
        coefficients: (0..k)
            .map(|j| basis.iter().map(|e| hat.bilinear(j, &own, e)).collect())
            .collect(),
    };
    let quadratic = Forms {
        k,
        degree: 2,
        coefficients: (0..k)
            .map(|j| {
                basis
                    .iter()
                    .flat_map(|e| basis.iter().map(|f| hat.bilinear(j, e, f)))
                    .collect::<Vec<f64>>()
            })
            .collect(),
    };
    let vectors: Vec<Extended> = basis.iter().map(|e| hat.vector(at, e)).collect();
    let mut crossing = Crossing {
        shape: Shape::Multiple,
        criticality: None,
        from_side,
        multiplicity: k,
        curvature: 0.0,
        curvature_error: 0.0,
        traced: direction(probe, traced.clone(), 0.0, 1.0),
        leaving: Vec::new(),
    };
    let n = at.z.u.len();
    let combine = |coefficients: &[f64]| {
        let mut v = Extended::zero(n);
        for (c, e) in coefficients.iter().zip(&vectors) {
            v.add(*c, e);
        }
        v
    };
    if quadratic.size() > NO_QUADRATIC * a.size() {
        for (xi, lambda) in solutions(&quadratic, &a).unwrap_or_default() {
            let mut v = combine(&xi);
            v.add(0.5 * lambda, &traced);
            let length = probe.length(&v);
            crossing.leaving.push(direction(probe, v, 0.0, length));
        }
    } else {
        let (cubic, bends) = cubic_terms(probe, at, &vectors)?;
        let mut fork = |xi: &[f64], lambda: f64| {
            let v = combine(xi);
            let mut curvature = lambda / 3.0 * traced.p;
            for (i, row) in bends.iter().enumerate() {
                for (l, h) in row.iter().enumerate() {
                    curvature += xi[i] * xi[l] * h;
                }
            }
            let length = probe.length(&v);
            let over_range = 0.5 * curvature.abs() / range;
            let reach = if over_range > 0.0 { over_range.sqrt().recip() } else { 1.0 };
            let bend = 0.5 * curvature / (length * length);
            let amplitude = length * reach.clamp(1e-3, 1e3);
            direction(probe, v, bend, amplitude)
        };
        let first = || {
            let mut xi = vec![0.0; k];
            xi[0] = 1.0;
            (xi, -cubic.coefficients[0][0] / a.coefficients[0][0])
        };
        match solutions(&cubic, &a) {
            Some(all) => crossing.leaving.extend(all.iter().map(|(xi, l)| fork(xi, *l))),
            None => {
                let (xi, lambda) = first();
                let any = fork(&xi, lambda);
                match beyond_cubic(probe, at, (&traced, &vectors, &a), from_side) {
                    // one stands for all
                    Separated::Circle => crossing.leaving.push(any),
                    Separated::Branches(rays) => {
                        for ray in rays {
                            let (sin, cos) = ray.angle.sin_cos();
                            let v = combine(&[cos, sin]);
                            let length = probe.length(&v);
                            let reached = ray.amplitude * length;
                            let bend = ray.offset.p / (reached * reached);
                            let separate = direction(probe, v, bend, any.amplitude);
                            let offset = Some(Offset { multiple: reached, du: ray.offset.u });
                            crossing.leaving.push(Direction { offset, ..separate });
                        }
                    }
                    Separated::Unknown => crossing.shape = Shape::Degenerate,
                }
            }
        }
    }
    let alignment = (dot(&wanted, &own).abs(), 0.0);
    Ok(Some(Analysed { crossing, traced, alignment }))
}

/// What tells directions apart that solve the cubic equations all alike: `vectors` across the traced
/// tangent, with the linear forms `a` there.
fn beyond_cubic(
    probe: &mut Probe<'_>,
    at: &mut Singular,
    (traced, vectors, a): (&Extended, &[Extended], &Forms),
    from_side: bool,
) -> Separated {
    if from_side {
        return Separated::Unknown;
    }
    let Singular { frame, z, .. } = at;
    Reduced { probe, frame, z, along: traced, across: vectors, linear: a }.separate()
}

/// Symmetric cubic coefficients of the reduced equations on `vectors`, and the parameter's part of
/// the second-order corrections `h`.
fn cubic_terms(
    probe: &mut Probe<'_>,
    at: &mut Singular,
    vectors: &[Extended],
) -> Result<(Forms, Vec<Vec<f64>>), EvalError> {
    let k = vectors.len();
    let all: Vec<&Extended> = vectors.iter().collect();
    let mut h = vec![vec![Extended::zero(at.z.u.len()); k]; k];
    for (i, v) in vectors.iter().enumerate() {
        let second = probe.second(&at.z, v, 1.0, &all)?;
        for (l, y) in second.iter().enumerate() {
            let minus: Vec<f64> = y.iter().map(|y| -y).collect();
            h[i][l] = at.frame.solve(probe, &minus).0;
        }
    }
    // third derivatives by polarisation: F_zzz[a, b, ·] from a + b and a − b
    let mut tensors = vec![vec![0.0; k * k * k]; k];
    for i in 0..k {
        for l in 0..=i {
            let mut third = vec![vec![0.0; at.z.u.len()]; k];
            for sign in [1.0, -1.0] {
                let mut v = vectors[i].clone();
                v.add(sign, &vectors[l]);
                if i == l && sign < 0.0 {
                    continue;
                }
                let part = probe.third(&at.z, &v, 1.0, &all)?;
                for (t, p) in third.iter_mut().zip(&part) {
                    for (t, p) in t.iter_mut().zip(p) {
                        *t += 0.25 * sign * p;
                    }
                }
            }
            for (m, t) in third.iter().enumerate() {
                for (j, w) in at.left.iter().enumerate() {
                    let value = dot(w, t);
                    tensors[j][(i * k + l) * k + m] = value;
                    tensors[j][(l * k + i) * k + m] = value;
                }
            }
        }
    }
    for (i, v) in vectors.iter().enumerate() {
        let corrections: Vec<&Extended> = h.iter().flatten().collect();
        let second = probe.second(&at.z, v, 1.0, &corrections)?;
        for l in 0..k {
            for m in 0..k {
                for (j, w) in at.left.iter().enumerate() {
                    let value = dot(w, &second[l * k + m]);
                    for (a, b, c) in [(i, l, m), (l, i, m), (l, m, i)] {
                        tensors[j][(a * k + b) * k + c] += value;
                    }
                }
            }
        }
    }
    let coefficients = tensors.into_iter().map(|t| symmetrised(&t, k)).collect();
    let bends = h.iter().map(|row| row.iter().map(|h| h.p).collect()).collect();
    Ok((Forms { k, degree: 3, coefficients }, bends))
}

fn symmetrised(t: &[f64], k: usize) -> Vec<f64> {
    let at = |a: usize, b: usize, c: usize| t[(a * k + b) * k + c];
    let mut out = Vec::with_capacity(t.len());
    for a in 0..k {
        for b in 0..k {
            for c in 0..k {
                let sum = at(a, b, c)
                    + at(a, c, b)
                    + at(b, a, c)
                    + at(b, c, a)
                    + at(c, a, b)
                    + at(c, b, a);
                out.push(sum / 6.0);
            }
        }
    }
    out
}

/// The quadratic forms in natural amplitudes.
struct Hat {
    form: Vec<Vec<Vec<f64>>>,
}

impl Hat {
    fn of(at: &Singular) -> Self {
        let x = &at.amplitude;
        let scaled = |f: &Vec<Vec<f64>>| {
            let rows = f.iter().enumerate();
            rows.map(|(i, row)| {
                row.iter().enumerate().map(|(l, t)| t * x[i] * x[l]).collect::<Vec<f64>>()
            })
            .collect::<Vec<_>>()
        };
        Hat { form: at.form.iter().map(scaled).collect() }
    }

    fn bilinear(&self, j: usize, y: &[f64], z: &[f64]) -> f64 {
        self.form[j].iter().zip(y).map(|(row, y)| y * dot(row, z)).sum()
    }

    /// The vector with these coordinates.
    fn vector(&self, at: &Singular, y: &[f64]) -> Extended {
        let mut v = Extended::zero(at.z.u.len());
        for ((y, x), r) in y.iter().zip(&at.amplitude).zip(&at.right) {
            v.add(y * x, r);
        }
        v
    }

    /// The direction near `y` on which all forms vanish.
    fn tangent(&self, mut y: Vec<f64>) -> Option<Vec<f64>> {
        let size = self.form.iter().flatten().flatten().fold(0.0, |m: f64, t| m.max(t.abs()));
        for _ in 0..20 {
            let mut rows: Vec<Vec<f64>> = self
                .form
                .iter()
                .map(|f| f.iter().map(|row| 2.0 * dot(row, &y)).collect())
                .collect();
            let mut b: Vec<f64> = (0..self.form.len()).map(|j| -self.bilinear(j, &y, &y)).collect();
            rows.push(y.iter().map(|y| y * size).collect());
            b.push(0.0);
            let step = least_squares(&rows, &b)?;
            y.iter_mut().zip(&step).for_each(|(y, s)| *y += s);
            y = unit(y)?;
            if super::max_abs(&step) < 1e-10 {
                return Some(y);
            }
        }
        None
    }
}

fn unit(mut y: Vec<f64>) -> Option<Vec<f64>> {
    let norm = dot(&y, &y).sqrt();
    y.iter_mut().for_each(|y| *y /= norm);
    (norm.is_finite() && norm > 0.0).then_some(y)
}

/// An orthonormal basis of the space normal to `n`.
fn complement(n: Vec<f64>) -> Option<Vec<Vec<f64>>> {
    let dim = n.len();
    let n = unit(n)?;
    let skip = (0..dim).max_by(|a, b| n[*a].abs().total_cmp(&n[*b].abs()))?;
    let mut vectors = vec![n];
    for i in (0..dim).filter(|i| *i != skip) {
        let mut e = vec![0.0; dim];
        e[i] = 1.0;
        vectors.push(e);
    }
    super::small::orthonormalise(&mut vectors)?;
    vectors.remove(0);
    Some(vectors)
}
