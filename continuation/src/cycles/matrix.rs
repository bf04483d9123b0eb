//! The Jacobian of the collocation equations: a cycle of dense blocks with one border.

use super::cyclic::Cyclic;
use crate::linalg::{Dense, Facts, Matrix, max_abs};
use crate::step::dot;

/// One interval: its equations in the unknowns at its left end, `left`, and at its other nodes, `inner`.
#[derive(Debug, Clone)]
pub(super) struct Block {
    pub(super) inner: Dense,
    /// By columns.
    pub(super) left: Vec<f64>,
    /// The column of the border.
    pub(super) column: Vec<f64>,
    /// The border's row, at the left end and at the other nodes.
    pub(super) row_left: Vec<f64>,
    pub(super) row: Vec<f64>,
    /// `inner⁻¹ left` and `inner⁻¹ column`, after factoring.
    solved: Vec<f64>,
    solved_column: Vec<f64>,
}

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
    pub(super) blocks: Vec<Block>,
    pub(super) corner: f64,
    cyclic: Cyclic,
    /// Rows of the condensed border.
    q: Vec<f64>,
    condensed: Vec<f64>,
    local: Vec<f64>,
    product: Vec<f64>,
}

impl CycleMatrix {
    /// A zero matrix; the end of the last interval is `closing` times the start of the first.
    pub(super) fn new(n: usize, m: usize, intervals: usize, closing: f64) -> Self {
        let k = n * m;
        let block = Block {
            inner: Dense::new(k),
            left: vec![0.0; k * n],
            column: vec![0.0; k],
            row_left: vec![0.0; n],
            row: vec![0.0; k],
            solved: vec![0.0; k * n],
            solved_column: vec![0.0; k],
        };
        CycleMatrix {
            n,
            m,
            closing,
            blocks: vec![block; intervals],
            corner: 0.0,
            cyclic: Cyclic::new(n, intervals),
            q: vec![0.0; n * intervals],
            condensed: vec![0.0; n * (n + 1) * intervals],
            local: vec![0.0; k],
            product: vec![0.0; n * intervals],
        }
    }

    /// Condenses the intervals: afterwards [`CycleMatrix::transfer`] is known. The sign of the product of
    /// their determinants and the number of replaced pivots.
    pub(super) fn condense(&mut self) -> (Option<i8>, usize, f64) {
        let (n, k) = (self.n, self.n * self.m);
        let (mut sign, mut perturbed, mut growth) = (Some(1), 0, 1.0_f64);
        for block in &mut self.blocks {
            let floor = f64::EPSILON * block.inner.norm();
            let facts = block.inner.factor(if floor > 0.0 { floor } else { f64::EPSILON });
            sign = sign.zip(facts.det_sign).map(|(a, b)| a * b);
            perturbed += facts.perturbed;
            growth = growth.max(facts.growth);
            block.solved.copy_from_slice(&block.left);
            for c in 0..n {
                block.inner.solve(&mut block.solved[c * k..(c + 1) * k]);
            }
        }
        (sign, perturbed, growth)
    }

    /// Entry `(r, c)` of the matrix that leads from one mesh point to the next, in interval `j`.
    pub(super) fn transfer(&self, j: usize, r: usize, c: usize) -> f64 {
        let k = self.n * self.m;
        -self.blocks[j].solved[k - self.n + r + c * k]
    }

    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.blocks.len()
    }

    /// Where the right end of interval `j` is, and its factor.
    fn right(&self, j: usize) -> (usize, f64) {
        let k = self.n * self.m;
        if j + 1 == self.blocks.len() { (0, self.closing) } else { ((j + 1) * k, 1.0) }
    }
}

impl Matrix for CycleMatrix {
    fn dim(&self) -> usize {
        self.blocks.len() * self.n * self.m + 1
    }

    fn set_zero(&mut self) {
        for block in &mut self.blocks {
            block.inner.set_zero();
            block.left.fill(0.0);
            block.column.fill(0.0);
            block.row_left.fill(0.0);
            block.row.fill(0.0);
        }
        self.corner = 0.0;
    }

    fn mul(&self, x: &[f64], y: &mut [f64]) {
        let (n, k, end) = (self.n, self.n * self.m, self.dim() - 1);
        let mut last = self.corner * x[end];
        for (j, block) in self.blocks.iter().enumerate() {
            let out = &mut y[j * k..(j + 1) * k];
            (0..k).for_each(|r| out[r] = block.column[r] * x[end]);
            for c in 0..n {
                let value = x[j * k + c];
                add(out, value, &block.left[c * k..(c + 1) * k]);
                last += block.row_left[c] * value;
            }
            let (right, factor) = self.right(j);
            for c in 0..k {
                let inside = c < k - n;
                let value = if inside { x[j * k + n + c] } else { factor * x[right + c + n - k] };
                add(out, value, block.inner.column(c));
                last += block.row[c] * value;
            }
        }
        y[end] = last;
    }

    fn mul_transpose(&self, x: &[f64], y: &mut [f64]) {
        let (n, k, end) = (self.n, self.n * self.m, self.dim() - 1);
        y.fill(0.0);
        y[end] = self.corner * x[end];
        for (j, block) in self.blocks.iter().enumerate() {
            let rows = &x[j * k..(j + 1) * k];
            for c in 0..n {
                y[j * k + c] +=
                    dot(&block.left[c * k..(c + 1) * k], rows) + block.row_left[c] * x[end];
            }
            let (right, factor) = self.right(j);
            for c in 0..k {
                let value = dot(block.inner.column(c), rows) + block.row[c] * x[end];
                if c < k - n {
                    y[j * k + n + c] += value;
                } else {
                    y[right + c + n - k] += factor * value;
                }
            }
            y[end] += dot(&block.column, rows);
        }
    }

    fn axpy(&mut self, a: f64, other: &Self) {
        let add = |y: &mut [f64], x: &[f64]| y.iter_mut().zip(x).for_each(|(y, x)| *y += a * x);
        for (block, other) in self.blocks.iter_mut().zip(&other.blocks) {
            block.inner.axpy(a, &other.inner);
            add(&mut block.left, &other.left);
            add(&mut block.column, &other.column);
            add(&mut block.row_left, &other.row_left);
            add(&mut block.row, &other.row);
        }
        self.corner += a * other.corner;
    }

    fn norm(&self) -> f64 {
        self.blocks.iter().fold(self.corner.abs(), |norm, block| {
            [&block.left, &block.column, &block.row_left, &block.row]
                .into_iter()
                .fold(norm.max(block.inner.norm()), |norm, part| norm.max(max_abs(part)))
        })
    }

    /// The floors are those of the condensed blocks, at their own rounding.
    fn factor(&mut self, _floor: f64) -> Facts {
        let (n, k, count) = (self.n, self.n * self.m, self.blocks.len());
        let (sign, perturbed, growth) = self.condense();
        let mut corner = self.corner;
        for (j, block) in self.blocks.iter_mut().enumerate() {
            block.solved_column.copy_from_slice(&block.column);
            block.inner.solve(&mut block.solved_column);
            for c in 0..n {
                let column = &block.solved[c * k..(c + 1) * k];
                let sum: f64 = block.row.iter().zip(column).map(|(a, b)| a * b).sum();
                self.q[j * n + c] = block.row_left[c] - sum;
            }
            corner -= block.row.iter().zip(&block.solved_column).map(|(a, b)| a * b).sum::<f64>();
        }
        // the condensed blocks, gathered: the last n rows of each
        let mut gathered = std::mem::take(&mut self.condensed);
        for (block, out) in self.blocks.iter().zip(gathered.chunks_exact_mut(n * (n + 1))) {
            for c in 0..n {
                out[c * n..(c + 1) * n]
                    .copy_from_slice(&block.solved[(c + 1) * k - n..(c + 1) * k]);
            }
            out[n * n..].copy_from_slice(&block.solved_column[k - n..]);
        }
        let at = |j: usize| gathered[j * n * (n + 1)..(j + 1) * n * (n + 1)].split_at(n * n);
        let facts = self.cyclic.factor(self.closing, at, &mut self.q, corner);
        self.condensed = gathered;
        // the first block of unknowns comes last in the elimination
        let moved = n * (count * k - n) % 2 == 1;
        let sign = sign.zip(facts.det_sign).map(|(a, b)| if moved { -a * b } else { a * b });
        Facts {
            det_sign: sign,
            inertia: None,
            growth: growth.max(facts.growth),
            perturbed: perturbed + facts.perturbed,
        }
    }

    fn solve(&mut self, x: &mut [f64]) {
        let (n, k, end) = (self.n, self.n * self.m, self.dim() - 1);
        let mut g = std::mem::take(&mut self.product);
        let mut border = x[end];
        for (j, block) in self.blocks.iter_mut().enumerate() {
            let rows = &mut x[j * k..(j + 1) * k];
            block.inner.solve(rows);
            g[j * n..(j + 1) * n].copy_from_slice(&rows[k - n..]);
            border -= block.row.iter().zip(rows.iter()).map(|(a, b)| a * b).sum::<f64>();
        }
        self.cyclic.solve(self.closing, &mut g, &mut border);
        let count = self.blocks.len();
        for (j, block) in self.blocks.iter().enumerate() {
            // g holds u_1 … u_{N−1}, u_0
            let from = if j == 0 { count - 1 } else { j - 1 };
            let left = &g[from * n..(from + 1) * n];
            self.local.copy_from_slice(&x[j * k..(j + 1) * k]);
            for r in 0..k - n {
                let mut value = self.local[r] - block.solved_column[r] * border;
                for c in 0..n {
                    value -= block.solved[r + c * k] * left[c];
                }
                x[j * k + n + r] = value;
            }
            x[j * k..j * k + n].copy_from_slice(left);
        }
        x[end] = border;
        self.product = g;
    }

    fn solve_transpose(&mut self, x: &mut [f64]) {
        let (n, k, end) = (self.n, self.n * self.m, self.dim() - 1);
        let count = self.blocks.len();
        let mut c = std::mem::take(&mut self.product);
        let mut border = x[end];
        for (j, block) in self.blocks.iter().enumerate() {
            let inside = &x[j * k + n..(j + 1) * k];
            // node j is column j − 1 of the condensed system, the first node its last one
            let to = if j == 0 { count - 1 } else { j - 1 };
            for i in 0..n {
                let column = &block.solved[i * k..(i + 1) * k - n];
                let sum: f64 = column.iter().zip(inside).map(|(a, b)| a * b).sum();
                c[to * n + i] = x[j * k + i] - sum;
            }
            let column = &block.solved_column[..k - n];
            border -= column.iter().zip(inside).map(|(a, b)| a * b).sum::<f64>();
        }
        self.cyclic.solve_transpose(self.closing, &mut c, &mut border);
        for (j, block) in self.blocks.iter_mut().enumerate() {
            self.local[..k - n].copy_from_slice(&x[j * k + n..(j + 1) * k]);
            self.local[k - n..].copy_from_slice(&c[j * n..(j + 1) * n]);
            (0..k).for_each(|r| self.local[r] -= block.row[r] * border);
            block.inner.solve_transpose(&mut self.local);
            x[j * k..(j + 1) * k].copy_from_slice(&self.local);
        }
        x[end] = border;
        self.product = c;
    }
}

/// `y += a x`.
fn add(y: &mut [f64], a: f64, x: &[f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += a * x);
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
        for block in &mut matrix.blocks {
            for c in 0..n * m {
                block.inner.column_mut(c).iter_mut().for_each(|x| *x = random(seed));
            }
            let parts = [&mut block.left, &mut block.column, &mut block.row_left, &mut block.row];
            parts.into_iter().flatten().for_each(|x| *x = random(seed));
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
