//! Floquet multipliers from the matrices that lead from one mesh point to the next.
//!
//! The product `G_{N−1} … G_0` is never formed. Orthogonal iteration around the cycle,
//! `G_j Q_j = Q_{j+1} R_j`, turns it into a periodic Schur form (Bojanczyk, Golub & Van Dooren 1992; Lust
//! 2001): multipliers that differ in modulus end up on the diagonal, where their logarithms are sums,
//! and those of about the same modulus share a small diagonal block. What is neglected is rounding of
//! one factor, so that multipliers are as accurate as the factors determine them, be they 1e-60 or 1e20.

use crate::linalg::{Dense, Matrix};
use serde::{Deserialize, Serialize};

/// Rounds of the iteration around the cycle after which it is looked at, the last one final; the first one
/// only where it begins with what was found near by. Moduli
/// whose ratio is below 0.6 are separated by the last.
const LOOKS: [usize; 7] = [1, 2, 3, 6, 12, 30, 75];
/// Steps of the iteration with the product itself, between looks.
const INNER: usize = 30;
/// Entries below the diagonal, of orthogonal matrices, that are rounding; times the dimension.
const SEPARATE: f64 = 32.0 * f64::EPSILON;

/// A Floquet multiplier `μ`, by its logarithm: it may be too large or too small for a number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Multiplier {
    /// `ln |μ|`; negative infinity for zero.
    pub log_modulus: f64,
    /// The argument of `μ`, in `(−π, π]`: 0 or `π` for real ones.
    pub argument: f64,
    /// Estimated error of `ln μ`, the relative error of `μ` where it is small: one and a half times the
    /// change when all intervals are halved, plus the deviation of the trivial multiplier from 1, plus
    /// rounding; `None` where it is not known.
    pub error: Option<f64>,
}

impl Multiplier {
    /// Real and imaginary part; zero or infinite where they are too small or too large.
    pub fn value(&self) -> (f64, f64) {
        let size = self.log_modulus.exp();
        if self.argument == 0.0 {
            return (size, 0.0);
        }
        if self.argument == std::f64::consts::PI {
            return (-size, 0.0);
        }
        (size * self.argument.cos(), size * self.argument.sin())
    }

    /// `|μ|`.
    pub fn modulus(&self) -> f64 {
        self.log_modulus.exp()
    }

    /// The number 1.
    pub(super) const ONE: Multiplier = Multiplier { log_modulus: 0.0, argument: 0.0, error: None };

    /// `|ln μ − ln ν|`: the relative distance where that is small.
    pub(super) fn distance(&self, other: &Multiplier) -> f64 {
        let zero = f64::NEG_INFINITY;
        if self.log_modulus == zero && other.log_modulus == zero {
            return 0.0;
        }
        let turn = (self.argument - other.argument).abs();
        let turn = turn.min(std::f64::consts::TAU - turn);
        (self.log_modulus - other.log_modulus).hypot(turn)
    }
}

/// The eigenvalues of the product of matrices `G_{N−1} … G_0`: those of largest modulus first. `g` has the
/// `−G_j`, by columns, each followed by another column. `None` where an entry is not finite.
pub(super) fn multipliers(n: usize, g: &[f64], latest: &mut Latest) -> Option<Vec<Multiplier>> {
    match n {
        1 => multipliers_sized(1, g, latest),
        2 => multipliers_sized(2, g, latest),
        3 => multipliers_sized(3, g, latest),
        4 => multipliers_sized(4, g, latest),
        n => multipliers_sized(n, g, latest),
    }
}

/// Where the iteration ended for a product near by, from which it begins again: one round usually tells that
/// the subspaces are invariant still, in whatever order.
#[derive(Debug, Default)]
pub(super) struct Latest {
    q: Vec<f64>,
    /// Number of diagonal blocks that were told apart.
    blocks: usize,
}

#[inline(always)]
fn multipliers_sized(n: usize, g: &[f64], latest: &mut Latest) -> Option<Vec<Multiplier>> {
    let count = g.len() / (n * (n + 1));
    let mut q = std::mem::take(&mut latest.q);
    let again = q.len() == n * n;
    if !again {
        // not along the axes, which may be invariant in the wrong order
        q = (0..n * n).map(|i| crate::singular::arbitrary(3, i)).collect();
        orthogonalise(n, &mut q, &mut vec![0.0; n * n]);
    }
    let mut rounds = 0;
    let (mut triangles, mut start) = (vec![0.0; n * n * count], vec![0.0; n * n]);
    let mut product = vec![0.0; n * n];
    for (look, until) in LOOKS.into_iter().enumerate().skip(usize::from(!again)) {
        while rounds < until {
            start.copy_from_slice(&q);
            for (g, triangle) in g.chunks_exact(n * (n + 1)).zip(triangles.chunks_exact_mut(n * n))
            {
                let (from, to) = (&q[..n * n], &mut product[..n * n]);
                for c in 0..n {
                    for r in 0..n {
                        to[r + c * n] =
                            -(0..n).map(|k| g[r + k * n] * from[k + c * n]).sum::<f64>();
                    }
                }
                std::mem::swap(&mut q, &mut product);
                orthogonalise(n, &mut q, triangle);
            }
            rounds += 1;
        }
        if !q.iter().chain(&triangles).all(|x| x.is_finite()) {
            return None;
        }
        // how the subspaces moved in the last round
        let turned =
            |r: usize, c: usize| -> f64 { (0..n).map(|k| start[k + r * n] * q[k + c * n]).sum() };
        let mut between = vec![0.0; n * n];
        for c in 0..n {
            (0..n).for_each(|r| between[r + c * n] = turned(r, c));
        }
        let blocks = blocks(n, &between);
        let done = blocks.iter().all(|(from, to)| to - from <= 2)
            && (look > 0 || blocks.len() >= latest.blocks);
        if done || look + 1 == LOOKS.len() {
            latest.blocks = blocks.len();
            let mut all = Vec::with_capacity(n);
            for (from, to) in blocks {
                all.extend(of_block(n, count, (from, to), &between, &triangles)?);
            }
            all.sort_by(|a, b| {
                let order = b.log_modulus.total_cmp(&a.log_modulus);
                order.then(b.argument.total_cmp(&a.argument))
            });
            latest.q = q;
            return Some(all);
        }
        if let Some((whole, _)) = product_of(n, count, (0, n), &between, &triangles) {
            improve(n, &whole, &start, &mut q);
        }
    }
    None
}

/// Ranges of the diagonal blocks of a matrix whose entries below them are rounding.
fn blocks(n: usize, a: &[f64]) -> Vec<(usize, usize)> {
    let small = SEPARATE * n as f64;
    let splits = |at: usize| (0..at).all(|c| (at..n).all(|r| a[r + c * n].abs() <= small));
    let mut out = Vec::new();
    let mut from = 0;
    for to in 1..=n {
        if to == n || splits(to) {
            out.push((from, to));
            from = to;
        }
    }
    out
}

/// The eigenvalues of one diagonal block.
fn of_block(
    n: usize,
    count: usize,
    (from, to): (usize, usize),
    between: &[f64],
    triangles: &[f64],
) -> Option<Vec<Multiplier>> {
    let k = to - from;
    let entry = |j: usize, r: usize, c: usize| triangles[j * n * n + from + r + (from + c) * n];
    if k == 1 {
        let mut log = between[from + from * n].abs().ln();
        let mut negative = between[from + from * n] < 0.0;
        for j in 0..count {
            log += entry(j, 0, 0).abs().ln();
            negative ^= entry(j, 0, 0) < 0.0;
        }
        let argument = if negative { std::f64::consts::PI } else { 0.0 };
        return Some(vec![Multiplier { log_modulus: log, argument, error: None }]);
    }
    let Some((product, log)) = product_of(n, count, (from, to), between, triangles) else {
        let zero = Multiplier { log_modulus: f64::NEG_INFINITY, argument: 0.0, error: None };
        return Some(vec![zero; k]);
    };
    let values = if k == 2 {
        pair(product[0], product[2], product[1], product[3])
    } else {
        let mut dense = Dense::new(k);
        for c in 0..k {
            dense.column_mut(c).copy_from_slice(&product[c * k..(c + 1) * k]);
        }
        dense.spectrum(None)?
    };
    let multiplier = |(re, im): (f64, f64)| {
        let argument = if im == 0.0 && re < 0.0 { std::f64::consts::PI } else { im.atan2(re) };
        Multiplier { log_modulus: log + re.hypot(im).ln(), argument, error: None }
    };
    Some(values.into_iter().map(multiplier).collect())
}

/// A diagonal block of the product in the basis of the round's start, over its size, and the logarithm of that;
/// `None` where it is zero.
#[inline(always)]
fn product_of(
    n: usize,
    count: usize,
    (from, to): (usize, usize),
    between: &[f64],
    triangles: &[f64],
) -> Option<(Vec<f64>, f64)> {
    let k = to - from;
    let entry = |j: usize, r: usize, c: usize| triangles[j * n * n + from + r + (from + c) * n];
    let mut product = vec![0.0; k * k];
    (0..k).for_each(|i| product[i + i * k] = 1.0);
    let (mut log, mut next) = (0.0, vec![0.0; k * k]);
    for j in 0..=count {
        for c in 0..k {
            for r in 0..k {
                let factor = |r: usize, i: usize| {
                    if j < count { entry(j, r, i) } else { between[from + r + (from + i) * n] }
                };
                next[r + c * k] = (0..k).map(|i| factor(r, i) * product[i + c * k]).sum();
            }
        }
        let size = next.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        if size == 0.0 {
            return None;
        }
        log += size.ln();
        product.iter_mut().zip(&next).for_each(|(p, x)| *p = x / size);
    }
    Some((product, log))
}

/// `q = start Z` with the subspaces `Z` of the product.
#[inline(always)]
fn improve(n: usize, product: &[f64], start: &[f64], q: &mut [f64]) {
    let times = |a: &[f64], b: &[f64], out: &mut [f64]| {
        for c in 0..n {
            for r in 0..n {
                out[r + c * n] = (0..n).map(|k| a[r + k * n] * b[k + c * n]).sum();
            }
        }
    };
    let (mut z, mut next, mut r) = (vec![0.0; n * n], vec![0.0; n * n], vec![0.0; n * n]);
    (0..n).for_each(|i| z[i + i * n] = 1.0);
    for _ in 0..INNER {
        times(product, &z, &mut next);
        orthogonalise(n, &mut next, &mut r);
        std::mem::swap(&mut z, &mut next);
    }
    times(start, &z, q);
    orthogonalise(n, q, &mut r);
}

/// The eigenvalues of `[a b; c d]`.
fn pair(a: f64, b: f64, c: f64, d: f64) -> Vec<(f64, f64)> {
    let (mean, half) = (0.5 * (a + d), 0.5 * (a - d));
    let under = half * half + b * c;
    if under < 0.0 {
        let im = (-under).sqrt();
        return vec![(mean, im), (mean, -im)];
    }
    // the larger one without cancellation, the other from the determinant
    let larger = mean + under.sqrt().copysign(mean);
    let other = if larger == 0.0 { 0.0 } else { (a * d - b * c) / larger };
    vec![(larger, 0.0), (other, 0.0)]
}

/// `A = Q R` by modified Gram-Schmidt, done twice; `a` becomes `Q`, with non-negative diagonal of `R`.
#[inline(always)]
fn orthogonalise(n: usize, a: &mut [f64], r: &mut [f64]) {
    let (a, r) = (&mut a[..n * n], &mut r[..n * n]);
    r.fill(0.0);
    for c in 0..n {
        let (done, rest) = a.split_at_mut(c * n);
        let column = &mut rest[..n];
        let before = norm(column);
        for _ in 0..2 {
            for (k, other) in done.chunks_exact(n).enumerate() {
                let along: f64 = other.iter().zip(column.iter()).map(|(a, b)| a * b).sum();
                r[k + c * n] += along;
                column.iter_mut().zip(other).for_each(|(x, o)| *x -= along * o);
            }
        }
        let size = norm(column);
        if size > 1e-300_f64.max(4.0 * f64::EPSILON * f64::EPSILON * before) {
            r[c + c * n] = size;
            column.iter_mut().for_each(|x| *x /= size);
            continue;
        }
        // the column depends on those before: any direction that completes them
        r[c + c * n] = 0.0;
        complete(n, done, column);
    }
}

/// A unit vector orthogonal to the columns of `done`.
fn complete(n: usize, done: &[f64], column: &mut [f64]) {
    for axis in 0..n {
        column.fill(0.0);
        column[axis] = 1.0;
        for _ in 0..2 {
            for other in done.chunks_exact(n) {
                let along: f64 = other.iter().zip(column.iter()).map(|(a, b)| a * b).sum();
                column.iter_mut().zip(other).for_each(|(x, o)| *x -= along * o);
            }
        }
        let size = norm(column);
        if size > 0.5 / (n as f64).sqrt() {
            column.iter_mut().for_each(|x| *x /= size);
            return;
        }
    }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::{Latest, multipliers};

    fn random(seed: &mut u64) -> f64 {
        *seed =
            seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn times(n: usize, a: &[f64], b: &[f64]) -> Vec<f64> {
        let at = |i: usize| (0..n).map(|k| a[i % n + k * n] * b[k + i / n * n]).sum();
        (0..n * n).map(at).collect()
    }

    /// The matrices as they are kept: with the other sign, and a column more.
    fn joined(n: usize, g: &[Vec<f64>]) -> Vec<f64> {
        g.iter().flat_map(|g| g.iter().map(|x| -x).chain(vec![9.0; n])).collect()
    }

    /// Inverse by elimination without exchanges, of a matrix near the identity.
    fn inverse(n: usize, a: &[f64]) -> Vec<f64> {
        let mut a = a.to_vec();
        let mut out: Vec<f64> = (0..n * n).map(|i| f64::from(u8::from(i % n == i / n))).collect();
        for c in 0..n {
            let pivot = a[c + c * n];
            for k in 0..n {
                a[c + k * n] /= pivot;
                out[c + k * n] /= pivot;
            }
            for r in (0..n).filter(|r| *r != c) {
                let multiple = a[r + c * n];
                for k in 0..n {
                    a[r + k * n] -= multiple * a[c + k * n];
                    out[r + k * n] -= multiple * out[c + k * n];
                }
            }
        }
        out
    }

    /// `G_j = W_{j+1} D W_j⁻¹` with random `W`: the multipliers are the powers of `D`'s entries.
    #[test]
    fn multipliers_of_any_size_are_relatively_accurate() {
        let mut seed = 3;
        let (n, count) = (5, 40);
        // e^{-60}, e^{20} and a pair of modulus e^{-3}
        let logs = [20.0, 0.0, -60.0];
        // begun with what belongs to another product
        let mut latest = Latest::default();
        for _ in 0..20 {
            let w: Vec<Vec<f64>> = (0..count)
                .map(|_| {
                    (0..n * n)
                        .map(|i| f64::from(u8::from(i % n == i / n)) + 0.2 * random(&mut seed))
                        .collect()
                })
                .collect();
            let mut d = vec![0.0; n * n];
            for (i, log) in logs.iter().enumerate() {
                d[i + i * n] = (log / 40.0_f64).exp();
            }
            let (size, turn) = ((-3.0 / 40.0_f64).exp(), 0.7 / 40.0_f64);
            (d[3 + 3 * n], d[4 + 4 * n]) = (size * turn.cos(), size * turn.cos());
            (d[4 + 3 * n], d[3 + 4 * n]) = (size * turn.sin(), -size * turn.sin());
            let g: Vec<Vec<f64>> = (0..count)
                .map(|j| times(n, &times(n, &w[(j + 1) % count], &d), &inverse(n, &w[j])))
                .collect();
            let found = multipliers(n, &joined(n, &g), &mut latest).unwrap();
            let expected = [(20.0, 0.0), (0.0, 0.0), (-3.0, 0.7), (-3.0, -0.7), (-60.0, 0.0)];
            for (found, (log, argument)) in found.iter().zip(expected) {
                assert!((found.log_modulus - log).abs() < 2e-12, "{found:?} {log}");
                assert!((found.argument - argument).abs() < 2e-12, "{found:?} {argument}");
            }
        }
    }

    #[test]
    fn a_nilpotent_product_has_multipliers_zero() {
        let g = vec![0.0, 0.0, 1.0, 0.0];
        let found =
            multipliers(2, &joined(2, &[g.clone(), g.clone(), g]), &mut Latest::default()).unwrap();
        assert!(found.iter().all(|m| m.modulus() == 0.0));
    }
}
