//! All real solutions of the reduced equations at a multiple branch point.
//!
//! `d_j(ξ) + λ a_j(ξ) = 0`, `j = 1 … k`, `|ξ| = 1`, where `d` is homogeneous of degree 2 or 3 and
//! `a` linear. For `k = 2`, `λ` is eliminated and the directions are the real roots of one binary
//! form, all of them found as eigenvalues of its companion matrix. For `k > 2` Newton's method
//! starts from many directions, spread evenly.

use super::small::least_squares;
use crate::linalg::{Dense, Matrix};

/// Homogeneous forms of one degree, one per equation.
#[derive(Debug, Clone)]
pub(super) struct Forms {
    pub(super) k: usize,
    pub(super) degree: usize,
    /// Per equation the symmetric tensor of coefficients, `k^degree` entries.
    pub(super) coefficients: Vec<Vec<f64>>,
}

impl Forms {
    pub(super) fn size(&self) -> f64 {
        self.coefficients.iter().flatten().fold(0.0, |m: f64, c| m.max(c.abs()))
    }

    /// The forms at `x`, and their derivatives by rows.
    pub(super) fn at(&self, x: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>) {
        let (k, degree) = (self.k, self.degree);
        let mut values = Vec::with_capacity(k);
        let mut slopes = Vec::with_capacity(k);
        for tensor in &self.coefficients {
            // contract all indices but one; the tensor is symmetric
            let mut rest = tensor.clone();
            for _ in 1..degree {
                rest = rest.chunks_exact(k).map(|c| crate::step::dot(c, x)).collect();
            }
            values.push(crate::step::dot(&rest, x));
            slopes.push(rest.iter().map(|r| degree as f64 * r).collect());
        }
        (values, slopes)
    }
}

/// Two directions this near to each other are one.
const SAME: f64 = 1e-6;
/// Residual, relative to the forms, below which a direction is one of a continuous family.
const FLAT: f64 = 1e-6;

/// All `(ξ, λ)`, one of each pair `±ξ`. `None` where every direction solves the equations.
pub(super) fn solutions(d: &Forms, a: &Forms) -> Option<Vec<(Vec<f64>, f64)>> {
    // that directions in no relation to the forms solve them is seen before any search: of a family of
    // solutions it would find as many as rounding makes regular
    let off = |seed| {
        let x = normalised((0..d.k).map(|i| super::arbitrary(seed, i)).collect())?;
        Some(residual(d, a, &x, multiplier(d, a, &x)))
    };
    if (1..=3).all(|seed| off(seed).is_some_and(|r| r <= FLAT * d.size())) {
        return None;
    }
    let directions = if d.k == 2 { binary(d, a)? } else { search(d, a) };
    let mut found: Vec<(Vec<f64>, f64)> = Vec::new();
    for start in directions {
        let Some((x, lambda)) = polish(d, a, start) else { continue };
        let same = |y: &Vec<f64>| (1.0 - crate::step::dot(y, &x).abs()) < SAME;
        if !found.iter().any(|(y, _)| same(y)) {
            found.push((x, lambda));
        }
    }
    let mut first = vec![0.0; d.k];
    first[0] = 1.0;
    (!found.is_empty() || residual(d, a, &first, multiplier(d, a, &first)) > FLAT * d.size())
        .then_some(found)
}

/// The `λ` for which `d(x) + λ a(x)` is least.
fn multiplier(d: &Forms, a: &Forms, x: &[f64]) -> f64 {
    let ((d, _), (a, _)) = (d.at(x), a.at(x));
    let aa = crate::step::dot(&a, &a);
    if aa > 0.0 { -crate::step::dot(&a, &d) / aa } else { 0.0 }
}

/// Largest component of `d(x) + λ a(x)`.
fn residual(d: &Forms, a: &Forms, x: &[f64], lambda: f64) -> f64 {
    let ((d, _), (a, _)) = (d.at(x), a.at(x));
    d.iter().zip(&a).map(|(d, a)| (d + lambda * a).abs()).fold(0.0, f64::max)
}

/// Zeros of `a₁ d₂ − a₂ d₁` as directions in the plane.
fn binary(d: &Forms, a: &Forms) -> Option<Vec<Vec<f64>>> {
    let degree = d.degree + 1;
    // turned by an angle of no significance, so that no root is at infinity
    let (sin, cos) = 0.654_321_f64.sin_cos();
    let direction = |t: f64| {
        let norm = t.hypot(1.0);
        vec![(cos - sin * t) / norm, (sin + cos * t) / norm]
    };
    let value = |t: f64| {
        let x = direction(t);
        let ((d, _), (a, _)) = (d.at(&x), a.at(&x));
        (a[0] * d[1] - a[1] * d[0]) * t.hypot(1.0).powi(degree as i32)
    };
    let size = d.size() * a.size();
    let nodes: Vec<f64> = (0..=degree).map(|i| -1.0 + 2.0 * i as f64 / degree as f64).collect();
    let rows: Vec<Vec<f64>> =
        nodes.iter().map(|t| (0..=degree).map(|n| t.powi(n as i32)).collect()).collect();
    let values: Vec<f64> = nodes.iter().map(|t| value(*t)).collect();
    let c = least_squares(&rows, &values)?;
    let largest = crate::linalg::max_abs(&c);
    if largest <= 1e-7 * size {
        return None;
    }
    if c[degree].abs() <= 1e-12 * largest {
        return Some(Vec::new());
    }
    let mut companion = Dense::new(degree);
    for i in 0..degree {
        if i > 0 {
            companion.set(i, i - 1, 1.0);
        }
        companion.set(i, degree - 1, -c[i] / c[degree]);
    }
    let roots = companion.spectrum(None)?;
    let real = roots.into_iter().filter(|(re, im)| im.abs() <= 1e-5 * (1.0 + re.abs()));
    Some(real.map(|(re, _)| direction(re)).collect())
}

/// Directions from which Newton's method starts: signs and zeros, and a spread of others.
fn search(d: &Forms, _a: &Forms) -> Vec<Vec<f64>> {
    let k = d.k;
    let mut starts = Vec::new();
    for code in 1..3_usize.pow(k.min(6) as u32) {
        let mut rest = code;
        let x: Vec<f64> = (0..k)
            .map(|_| {
                let digit = rest % 3;
                rest /= 3;
                [0.0, 1.0, -1.0][digit]
            })
            .collect();
        starts.push(x);
    }
    for seed in 0..100 * k {
        starts.push((0..k).map(|i| super::kernel::arbitrary(seed + 3, i)).collect());
    }
    starts.into_iter().filter_map(normalised).collect()
}

fn normalised(mut x: Vec<f64>) -> Option<Vec<f64>> {
    let norm = crate::step::dot(&x, &x).sqrt();
    x.iter_mut().for_each(|x| *x /= norm);
    (norm > 1e-8).then_some(x)
}

/// Newton's method on `d(ξ) + λ a(ξ) = 0`, `|ξ| = 1`; regular solutions only.
fn polish(d: &Forms, a: &Forms, mut x: Vec<f64>) -> Option<(Vec<f64>, f64)> {
    let k = d.k;
    let size = d.size().max(f64::MIN_POSITIVE);
    let scale = size / a.size();
    let mut lambda = multiplier(d, a, &x);
    for iteration in 0..50 {
        let ((dv, dd), (av, da)) = (d.at(&x), a.at(&x));
        let residual: Vec<f64> = dv.iter().zip(&av).map(|(d, a)| d + lambda * a).collect();
        let mut rows: Vec<Vec<f64>> = (0..k)
            .map(|j| {
                let mut row: Vec<f64> = (0..k).map(|i| dd[j][i] + lambda * da[j][i]).collect();
                row.push(av[j] * scale);
                row
            })
            .collect();
        let mut last: Vec<f64> = x.iter().map(|x| x * size).collect();
        last.push(0.0);
        rows.push(last);
        let mut b: Vec<f64> = residual.iter().map(|r| -r).collect();
        b.push(0.0);
        let step = least_squares(&rows, &b)?;
        let length = crate::linalg::max_abs(&step[..k]);
        let damping = if length > 0.3 { 0.3 / length } else { 1.0 };
        for (x, s) in x.iter_mut().zip(&step) {
            *x += damping * s;
        }
        x = normalised(x)?;
        lambda += damping * scale * step[k];
        if iteration > 0 && length < 1e-12 {
            return Some((x, lambda));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn linear(k: usize) -> Forms {
        let coefficients = (0..k).map(|j| (0..k).map(|i| f64::from(u8::from(i == j))).collect());
        Forms { k, degree: 1, coefficients: coefficients.collect() }
    }

    /// `ξ_j³ + c ξ_j Σ_{i≠j} ξ_i²`: the square (or cube) symmetry.
    fn symmetric(k: usize, c: f64) -> Forms {
        let coefficients = (0..k)
            .map(|j| {
                let mut t = vec![0.0; k * k * k];
                let mut set = |a: usize, b: usize, e: usize, v: f64| {
                    t[(a * k + b) * k + e] = v;
                };
                set(j, j, j, 1.0);
                for i in (0..k).filter(|i| *i != j) {
                    set(j, i, i, c / 3.0);
                    set(i, j, i, c / 3.0);
                    set(i, i, j, c / 3.0);
                }
                t
            })
            .collect();
        Forms { k, degree: 3, coefficients }
    }

    #[test]
    fn branches_with_the_symmetry_of_the_square() {
        let found = solutions(&symmetric(2, 3.0), &linear(2)).unwrap();
        assert_eq!(found.len(), 4, "{found:?}"); // two axes, two diagonals
        for (x, lambda) in found {
            let known = if (x[0] * x[1]).abs() < 1e-9 { -1.0 } else { -2.0 };
            assert!((lambda - known).abs() < 1e-12);
        }
    }

    #[test]
    fn branches_with_the_symmetry_of_the_cube() {
        let found = solutions(&symmetric(3, 3.0), &linear(3)).unwrap();
        // 3 axes, 6 diagonals of faces, 4 of the cube
        assert_eq!(found.len(), 13, "{found:?}");
    }

    #[test]
    fn a_continuous_family_of_solutions_is_said_so() {
        assert!(solutions(&symmetric(2, 1.0), &linear(2)).is_none());
        assert!(solutions(&symmetric(3, 1.0), &linear(3)).is_none());
    }
}
