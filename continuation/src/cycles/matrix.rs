//! The Jacobian of the collocation equations: a cycle of dense blocks with one border.

use super::block::{Factors, Learned, sized};
use super::cyclic::Cyclic;
use crate::linalg::{Facts, Matrix, max_abs};

/// The matrix of a collocation method for periodic solutions: `N` intervals with `m` nodes of `n`
/// unknowns each, closed to a cycle, with one full row and column (phase condition and period).
///
/// The unknowns inside an interval are condensed with a dense factorisation of their own, the mesh
/// points then by a block elimination with row exchanges between neighbours: `O(N (n m)³)` operations,
/// stable where solutions grow or decay by many orders of magnitude around the cycle. The factors serve
/// solves with the matrix and its transpose and give the sign of the determinant.
#[derive(Debug, Clone)]
pub struct CycleMatrix {
    n: usize,
    m: usize,
    closing: f64,
    /// Of each interval `k = n m` rows of `[left | inner | column]` and the border's row: the equations in the
    /// unknowns at its left end, at its other nodes, and in the border.
    entries: Vec<f64>,
    pub(super) corner: f64,
    factors: Factors,
    cyclic: Cyclic,
    /// Rows of the condensed border.
    q: Vec<f64>,
    /// What leads from one mesh point to the next, by columns, and the border's column.
    condensed: Vec<f64>,
    local: Vec<f64>,
    product: Vec<f64>,
}

impl CycleMatrix {
    /// A zero matrix; the end of the last interval is `closing` times the start of the first.
    pub(super) fn new(n: usize, m: usize, intervals: usize, closing: f64) -> Self {
        let k = n * m;
        CycleMatrix {
            n,
            m,
            closing,
            entries: vec![0.0; intervals * (k + 1) * (n + k + 1)],
            corner: 0.0,
            factors: Factors::new(n, k, intervals),
            cyclic: Cyclic::new(n, intervals),
            q: vec![0.0; n * intervals],
            condensed: vec![0.0; n * (n + 1) * intervals],
            local: vec![0.0; n],
            product: vec![0.0; n * intervals],
        }
    }

    /// The rows of an interval, the border's row last, of `n + k + 1` numbers each.
    pub(super) fn block_mut(&mut self, j: usize) -> &mut [f64] {
        let k = self.n * self.m;
        let size = (k + 1) * (self.n + k + 1);
        &mut self.entries[j * size..(j + 1) * size]
    }

    /// Condenses the intervals, the border if it is wanted: afterwards [`CycleMatrix::transfers`] are known. The
    /// sign of the product of their determinants, the number of replaced pivots, and the growth.
    pub(super) fn condense(&mut self, bordered: bool) -> (i8, usize, f64) {
        sized!(self.n, self.n * self.m, condense(self, bordered))
    }

    /// The matrices `-G` that lead from one mesh point to the next, each by columns and followed by the
    /// border's column.
    pub(super) fn transfers(&self) -> &[f64] {
        &self.condensed
    }

    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.factors.count()
    }

    /// The unknowns at the right end of interval `j`, and their factor.
    fn right<'x>(&self, j: usize, x: &'x [f64]) -> (&'x [f64], f64) {
        let k = self.n * self.m;
        let last = j + 1 == self.factors.count();
        let (at, factor) = if last { (0, self.closing) } else { ((j + 1) * k, 1.0) };
        (&x[at..at + self.n], factor)
    }
}

#[inline(always)]
fn condense(n: usize, k: usize, matrix: &mut CycleMatrix, bordered: bool) -> (i8, usize, f64) {
    let mut all = Learned { sign: 1, perturbed: 0, growth: 1.0 };
    let blocks = matrix.entries.chunks_exact((k + 1) * (n + k + 1));
    let out = matrix.condensed.chunks_exact_mut(n * (n + 1));
    for (j, block) in blocks.enumerate() {
        let learned = matrix.factors.eliminate(n, k, j, block, bordered);
        all.sign *= learned.sign;
        all.perturbed += learned.perturbed;
        all.growth = all.growth.max(learned.growth);
    }
    for (factors, out) in matrix.factors.intervals().zip(out) {
        factors.condensed(n, k, out);
    }
    (all.sign, all.perturbed, all.growth)
}

#[inline(always)]
fn multiply(n: usize, k: usize, matrix: &CycleMatrix, x: &[f64], y: &mut [f64]) {
    let end = matrix.factors.count() * k;
    let wide = n + k + 1;
    let mut last = matrix.corner * x[end];
    let blocks = matrix.entries.chunks_exact((k + 1) * wide);
    for (j, (block, out)) in blocks.zip(y.chunks_exact_mut(k)).enumerate() {
        let inside = &x[j * k..(j + 1) * k];
        let (right, factor) = matrix.right(j, x);
        let along = |row: &[f64]| -> f64 {
            let by_right: f64 = (0..n).map(|c| row[k + c] * right[c]).sum();
            (0..k).map(|c| row[c] * inside[c]).sum::<f64>() + factor * by_right
        };
        for (row, out) in block.chunks_exact(wide).zip(out) {
            *out = along(row) + row[k + n] * x[end];
        }
        last += along(&block[k * wide..]);
    }
    y[end] = last;
}

#[inline(always)]
fn multiply_transposed(n: usize, k: usize, matrix: &CycleMatrix, x: &[f64], y: &mut [f64]) {
    let end = matrix.factors.count() * k;
    let wide = n + k + 1;
    y.fill(0.0);
    let mut last = matrix.corner * x[end];
    for (j, block) in matrix.entries.chunks_exact((k + 1) * wide).enumerate() {
        let is_last = j + 1 == matrix.factors.count();
        let (at, factor) = if is_last { (0, matrix.closing) } else { ((j + 1) * k, 1.0) };
        for (r, row) in block.chunks_exact(wide).enumerate() {
            let value = if r < k { x[j * k + r] } else { x[end] };
            (0..k).for_each(|c| y[j * k + c] += value * row[c]);
            (0..n).for_each(|c| y[at + c] += factor * value * row[k + c]);
            if r < k {
                last += value * row[k + n];
            }
        }
    }
    y[end] = last;
}

#[inline(always)]
fn solve(n: usize, k: usize, matrix: &mut CycleMatrix, x: &mut [f64]) {
    let (count, end) = (matrix.factors.count(), matrix.factors.count() * k);
    let g = &mut matrix.product[..count * n];
    let mut border = x[end];
    for ((factors, rows), right) in
        matrix.factors.intervals().zip(x.chunks_exact_mut(k)).zip(g.chunks_exact_mut(n))
    {
        border -= factors.forward(n, k, rows, right);
    }
    matrix.cyclic.solve(matrix.closing, g, &mut border);
    for (j, (factors, rows)) in matrix.factors.intervals().zip(x.chunks_exact_mut(k)).enumerate() {
        // g holds u_1 … u_{N−1}, u_0
        let from = if j == 0 { count - 1 } else { j - 1 };
        let left = &g[from * n..(from + 1) * n];
        let factor = if j + 1 == count { matrix.closing } else { 1.0 };
        let right = &mut matrix.local[..n];
        right.iter_mut().zip(&g[j * n..(j + 1) * n]).for_each(|(r, g)| *r = factor * g);
        factors.backward(n, k, rows, (left, right, border));
        rows.copy_within(..k - n, n);
        rows[..n].copy_from_slice(left);
    }
    x[end] = border;
}

#[inline(always)]
fn solve_transposed(n: usize, k: usize, matrix: &mut CycleMatrix, x: &mut [f64]) {
    let (count, end) = (matrix.factors.count(), matrix.factors.count() * k);
    let c = &mut matrix.product[..count * n];
    let mut border = x[end];
    for (j, (factors, rows)) in matrix.factors.intervals().zip(x.chunks_exact_mut(k)).enumerate() {
        // node j is column j − 1 of the condensed system, the first node its last one
        let to = if j == 0 { count - 1 } else { j - 1 };
        let place = &mut c[to * n..(to + 1) * n];
        place.copy_from_slice(&rows[..n]);
        rows.copy_within(n.., 0);
        rows[k - n..].fill(0.0);
        let by_left = &mut matrix.local[..n];
        border -= factors.forward_transposed(n, k, rows, by_left);
        place.iter_mut().zip(by_left).for_each(|(c, by)| *c -= *by);
    }
    matrix.cyclic.solve_transpose(matrix.closing, c, &mut border);
    let blocks = matrix.factors.intervals().zip(x.chunks_exact_mut(k));
    for ((factors, rows), right) in blocks.zip(c.chunks_exact_mut(n)) {
        factors.backward_transposed(n, k, rows, right, border);
    }
    x[end] = border;
}

impl Matrix for CycleMatrix {
    fn dim(&self) -> usize {
        self.factors.count() * self.n * self.m + 1
    }

    fn set_zero(&mut self) {
        self.entries.fill(0.0);
        self.corner = 0.0;
    }

    fn mul(&self, x: &[f64], y: &mut [f64]) {
        sized!(self.n, self.n * self.m, multiply(self, x, y));
    }

    fn mul_transpose(&self, x: &[f64], y: &mut [f64]) {
        sized!(self.n, self.n * self.m, multiply_transposed(self, x, y));
    }

    fn axpy(&mut self, a: f64, other: &Self) {
        self.entries.iter_mut().zip(&other.entries).for_each(|(y, x)| *y += a * x);
        self.corner += a * other.corner;
    }

    fn norm(&self) -> f64 {
        max_abs(&self.entries).max(self.corner.abs())
    }

    /// The floors are those of the condensed blocks, at their own rounding.
    fn factor(&mut self, _floor: f64) -> Facts {
        let (n, k, count) = (self.n, self.n * self.m, self.factors.count());
        let (sign, perturbed, growth) = self.condense(true);
        let mut corner = self.corner;
        for (factors, q) in self.factors.intervals().zip(self.q.chunks_exact_mut(n)) {
            let (row, by) = factors.border(n, k);
            q.copy_from_slice(row);
            corner += by;
        }
        let facts = self.cyclic.factor(self.closing, &self.condensed, &mut self.q, corner);
        // the first block of unknowns comes last in the elimination
        let moved = n * (count * k - n) % 2 == 1;
        let sign = facts.det_sign.map(|s| if moved { -sign * s } else { sign * s });
        Facts {
            det_sign: sign,
            inertia: None,
            growth: growth.max(facts.growth),
            perturbed: perturbed + facts.perturbed,
        }
    }

    fn solve(&mut self, x: &mut [f64]) {
        sized!(self.n, self.n * self.m, solve(self, x));
    }

    fn solve_transpose(&mut self, x: &mut [f64]) {
        sized!(self.n, self.n * self.m, solve_transposed(self, x));
    }
}

#[cfg(test)]
mod tests {
    use super::CycleMatrix;
    use crate::linalg::{Dense, Matrix};

    fn random(seed: &mut u64) -> f64 {
        *seed =
            seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn filled(n: usize, m: usize, intervals: usize, closing: f64, seed: &mut u64) -> CycleMatrix {
        let mut matrix = CycleMatrix::new(n, m, intervals, closing);
        let wide = n * m + n + 1;
        for j in 0..intervals {
            matrix.block_mut(j).iter_mut().for_each(|x| *x = random(seed));
            // the corner stands elsewhere
            matrix.block_mut(j)[n * m * wide + wide - 1] = 0.0;
        }
        matrix.corner = random(seed);
        matrix
    }

    /// Against a dense copy: products, solves both ways and the sign of the determinant.
    #[test]
    fn random_matrices_agree_with_dense_ones() {
        let mut seed = 7;
        for round in 0..200 {
            let (n, m, intervals) = (1 + round % 4, 2 + round % 3, 1 + round % 7);
            let closing = if round % 2 == 0 { 1.0 } else { -1.0 };
            let mut a = filled(n, m, intervals, closing, &mut seed);
            let size = a.dim();
            let mut full = Dense::new(size);
            let mut unit = vec![0.0; size];
            let mut row = vec![0.0; size];
            for c in 0..size {
                unit[c] = 1.0;
                a.mul(&unit, full.column_mut(c));
                unit[c] = 0.0;
            }
            for r in 0..size {
                unit[r] = 1.0;
                a.mul_transpose(&unit, &mut row);
                unit[r] = 0.0;
                assert!((0..size).all(|c| row[c] == full.get(r, c)));
            }
            let facts = a.factor(0.0);
            let expected = full.factor(1e-16);
            assert_eq!(facts.det_sign, expected.det_sign, "{n} {m} {intervals}");
            let b: Vec<f64> = (0..size).map(|_| random(&mut seed)).collect();
            for transposed in [false, true] {
                let (mut x, mut y) = (b.clone(), b.clone());
                if transposed {
                    a.solve_transpose(&mut x);
                    full.solve_transpose(&mut y);
                } else {
                    a.solve(&mut x);
                    full.solve(&mut y);
                }
                let size = y.iter().fold(0.0_f64, |m, y| m.max(y.abs()));
                let off = x.iter().zip(&y).fold(0.0_f64, |m, (x, y)| m.max((x - y).abs()));
                assert!(off <= 1e-8 * size, "{n} {m} {intervals} {transposed} {off:e} {size:e}");
            }
        }
    }
}
