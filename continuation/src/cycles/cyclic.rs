//! The condensed system: one block of unknowns for each mesh point, one cycle, and one border.
//!
//! ```text
//! u_{j+1} + X_j u_j + z_j θ = g_j,   j = 0 … N − 1,   u_N = σ u_0
//! Σ q_j·u_j + q_θ θ = g_θ
//! ```
//! The inner blocks are eliminated one after the other, each from two block rows at once with row
//! exchanges between them (Wright 1992): what grows and what decays around the cycle are both solved
//! in the direction in which they decay. The blocks are never multiplied together.

use crate::linalg::{Dense, Facts, Matrix};

/// Calls a method with the size of a block as a constant where it is small.
macro_rules! sized {
    ($n:expr, $this:ident.$method:ident($($argument:expr),*)) => {
        match $n {
            1 => $this.$method(1, $($argument),*),
            2 => $this.$method(2, $($argument),*),
            3 => $this.$method(3, $($argument),*),
            4 => $this.$method(4, $($argument),*),
            n => $this.$method(n, $($argument),*),
        }
    };
}

/// The rows that determine one block of unknowns.
struct Stage<'s> {
    /// Factors of the two block rows, `2n × n` by columns.
    lu: &'s [f64],
    pivots: &'s [usize],
    /// Coefficients of the first block, of the next one and of `θ` in the pivot rows.
    first: &'s [f64],
    next: &'s [f64],
    border: &'s [f64],
    /// Multiples of the pivot rows in the border's row.
    multiples: &'s [f64],
}

/// The same, to be filled.
struct StageMut<'s> {
    lu: &'s mut [f64],
    pivots: &'s mut [usize],
    first: &'s mut [f64],
    next: &'s mut [f64],
    border: &'s mut [f64],
    multiples: &'s mut [f64],
}

/// Numbers of one stage.
const fn size(n: usize) -> usize {
    4 * n * n + 2 * n
}

#[inline(always)]
fn stages<'s>(
    n: usize,
    numbers: &'s [f64],
    pivots: &'s [usize],
) -> impl DoubleEndedIterator<Item = Stage<'s>> + ExactSizeIterator {
    numbers.chunks_exact(size(n)).zip(pivots.chunks_exact(n)).map(move |(numbers, pivots)| {
        let (lu, rest) = numbers.split_at(2 * n * n);
        let (first, rest) = rest.split_at(n * n);
        let (next, rest) = rest.split_at(n * n);
        let (border, multiples) = rest.split_at(n);
        Stage { lu, pivots, first, next, border, multiples }
    })
}

#[inline(always)]
fn stages_mut<'s>(
    n: usize,
    numbers: &'s mut [f64],
    pivots: &'s mut [usize],
) -> impl Iterator<Item = StageMut<'s>> {
    let all = numbers.chunks_exact_mut(size(n)).zip(pivots.chunks_exact_mut(n));
    all.map(move |(numbers, pivots)| {
        let (lu, rest) = numbers.split_at_mut(2 * n * n);
        let (first, rest) = rest.split_at_mut(n * n);
        let (next, rest) = rest.split_at_mut(n * n);
        let (border, multiples) = rest.split_at_mut(n);
        StageMut { lu, pivots, first, next, border, multiples }
    })
}

#[derive(Debug, Clone)]
pub(super) struct Cyclic {
    n: usize,
    /// The stages, one after the other.
    numbers: Vec<f64>,
    pivots: Vec<usize>,
    last: Dense,
    /// Scale of the column of `θ` in the last system.
    scale: f64,
    /// Work space: what the eliminated rows leave.
    carry: [Vec<f64>; 3],
    stack: Vec<f64>,
    tail: Vec<f64>,
}

impl Cyclic {
    pub(super) fn new(n: usize, intervals: usize) -> Self {
        Cyclic {
            n,
            numbers: vec![0.0; size(n) * (intervals - 1)],
            pivots: vec![0; n * (intervals - 1)],
            last: Dense::new(n + 1),
            scale: 1.0,
            carry: [vec![0.0; n * n], vec![0.0; n * n], vec![0.0; n]],
            stack: vec![0.0; 2 * n * (2 * n + 1)],
            tail: vec![0.0; n + 1],
        }
    }

    /// Factors the system. `blocks` holds the `X_j`, by columns, each followed by `z_j`; `q` holds the rows
    /// `q_j`, one after the other, and is overwritten.
    pub(super) fn factor(
        &mut self,
        closing: f64,
        blocks: &[f64],
        q: &mut [f64],
        corner: f64,
    ) -> Facts {
        sized!(self.n, self.factor_sized(closing, blocks, q, corner))
    }

    #[inline(always)]
    fn factor_sized(
        &mut self,
        n: usize,
        closing: f64,
        blocks: &[f64],
        q: &mut [f64],
        mut corner: f64,
    ) -> Facts {
        let x = |j: usize| blocks[j * n * (n + 1)..(j + 1) * n * (n + 1)].split_at(n * n);
        let (mut sign, mut perturbed) = (1_i8, 0);
        let [e, f, t] = &mut self.carry;
        let (x0, z0) = x(0);
        e.copy_from_slice(x0);
        t.copy_from_slice(z0);
        f.fill(0.0);
        (0..n).for_each(|i| f[i + i * n] = 1.0);
        for (index, stage) in stages_mut(n, &mut self.numbers, &mut self.pivots).enumerate() {
            let j = index + 1;
            let (xj, zj) = x(j);
            // columns: the first block, the next one and the border
            let rows = 2 * n;
            let others = &mut self.stack;
            others.fill(0.0);
            for c in 0..n {
                for r in 0..n {
                    stage.lu[r + c * rows] = f[r + c * n];
                    stage.lu[n + r + c * rows] = xj[r + c * n];
                    others[r + c * rows] = e[r + c * n];
                }
                others[n + c + (n + c) * rows] = 1.0;
                others[c + 2 * n * rows] = t[c];
                others[n + c + 2 * n * rows] = zj[c];
            }
            for c in 0..n {
                let column = &stage.lu[c * rows..(c + 1) * rows];
                let pivot = (c..rows)
                    .fold(c, |best, r| if column[r].abs() > column[best].abs() { r } else { best });
                stage.pivots[c] = pivot;
                if pivot != c {
                    sign = -sign;
                    (0..n).for_each(|k| stage.lu.swap(c + k * rows, pivot + k * rows));
                    (0..=2 * n).for_each(|k| others.swap(c + k * rows, pivot + k * rows));
                }
                let mut diagonal = stage.lu[c + c * rows];
                if diagonal == 0.0 {
                    diagonal = f64::EPSILON;
                    stage.lu[c + c * rows] = diagonal;
                    perturbed += 1;
                }
                if diagonal < 0.0 {
                    sign = -sign;
                }
                for r in c + 1..rows {
                    let multiple = stage.lu[r + c * rows] / diagonal;
                    stage.lu[r + c * rows] = multiple;
                    if multiple == 0.0 {
                        continue;
                    }
                    for k in c + 1..n {
                        stage.lu[r + k * rows] -= multiple * stage.lu[c + k * rows];
                    }
                    for k in 0..=2 * n {
                        others[r + k * rows] -= multiple * others[c + k * rows];
                    }
                }
            }
            for c in 0..n {
                for r in 0..n {
                    stage.first[r + c * n] = others[r + c * rows];
                    stage.next[r + c * n] = others[r + (n + c) * rows];
                    e[r + c * n] = others[n + r + c * rows];
                    f[r + c * n] = others[n + r + (n + c) * rows];
                }
                stage.border[c] = others[c + 2 * n * rows];
                t[c] = others[n + c + 2 * n * rows];
            }
            // the border's row: multiples of the pivot rows that remove this block
            for c in 0..n {
                let above: f64 = (0..c).map(|r| stage.multiples[r] * stage.lu[r + c * rows]).sum();
                stage.multiples[c] = (q[j * n + c] - above) / stage.lu[c + c * rows];
            }
            let next = (j + 1) % (q.len() / n);
            let factor = if next == 0 { closing } else { 1.0 };
            for c in 0..n {
                let dot =
                    |a: &[f64]| -> f64 { (0..n).map(|r| stage.multiples[r] * a[r + c * n]).sum() };
                let (by_first, by_next) = (dot(stage.first), dot(stage.next));
                q[c] -= by_first;
                q[next * n + c] -= factor * by_next;
            }
            corner -= (0..n).map(|r| stage.multiples[r] * stage.border[r]).sum::<f64>();
        }
        self.last.set_zero();
        let mut largest = 0.0_f64;
        for c in 0..n {
            for r in 0..n {
                let value = e[r + c * n] + closing * f[r + c * n];
                largest = largest.max(value.abs());
                self.last.set(r, c, value);
            }
            self.last.set(n, c, q[c]);
            largest = largest.max(q[c].abs());
        }
        let column = t.iter().fold(corner.abs(), |m, v| m.max(v.abs()));
        self.scale = if column > 0.0 && largest > 0.0 { largest / column } else { 1.0 };
        (0..n).for_each(|r| self.last.set(r, n, self.scale * t[r]));
        self.last.set(n, n, self.scale * corner);
        let facts = self.last.factor(f64::EPSILON * self.last.norm());
        Facts {
            det_sign: facts.det_sign.map(|s| s * sign),
            inertia: None,
            growth: facts.growth,
            perturbed: perturbed + facts.perturbed,
        }
    }

    /// Solves in place: `g` holds the blocks `g_j` and becomes `u_{j+1}`, the last one `u_0`; `border`
    /// becomes `θ`.
    pub(super) fn solve(&mut self, closing: f64, g: &mut [f64], border: &mut f64) {
        sized!(self.n, self.solve_sized(closing, g, border));
    }

    #[inline(always)]
    fn solve_sized(&mut self, n: usize, closing: f64, g: &mut [f64], border: &mut f64) {
        let rows = 2 * n;
        let count = g.len() / n;
        for (index, stage) in stages(n, &self.numbers, &self.pivots).enumerate() {
            let pair = &mut g[index * n..(index + 2) * n];
            (0..n).for_each(|c| pair.swap(c, stage.pivots[c]));
            for c in 0..n {
                let value = pair[c];
                for r in c + 1..rows {
                    pair[r] -= stage.lu[r + c * rows] * value;
                }
            }
            *border -= (0..n).map(|r| stage.multiples[r] * pair[r]).sum::<f64>();
        }
        self.tail[..n].copy_from_slice(&g[(count - 1) * n..]);
        self.tail[n] = *border;
        self.last.solve(&mut self.tail);
        *border = self.scale * self.tail[n];
        g[(count - 1) * n..].copy_from_slice(&self.tail[..n]);
        for (index, stage) in stages(n, &self.numbers, &self.pivots).enumerate().rev() {
            let (head, tail) = g.split_at_mut((index + 1) * n);
            let block = &mut head[index * n..];
            let last = index + 2 == count;
            let factor = if last { closing } else { 1.0 };
            for r in 0..n {
                let mut sum = stage.border[r] * *border;
                for c in 0..n {
                    sum += stage.first[r + c * n] * self.tail[c]
                        + factor * stage.next[r + c * n] * tail[c];
                }
                block[r] -= sum;
            }
            for c in (0..n).rev() {
                block[c] /= stage.lu[c + c * rows];
                let value = block[c];
                (0..c).for_each(|r| block[r] -= stage.lu[r + c * rows] * value);
            }
        }
    }

    /// Solves with the transposed matrix: `c` holds the right sides of the columns `u_1 … u_{N−1}, u_0`
    /// and becomes the unknowns of the rows `0 … N − 1`; `border` likewise.
    pub(super) fn solve_transpose(&mut self, closing: f64, c: &mut [f64], border: &mut f64) {
        sized!(self.n, self.solve_transpose_sized(closing, c, border));
    }

    #[inline(always)]
    fn solve_transpose_sized(&mut self, n: usize, closing: f64, c: &mut [f64], border: &mut f64) {
        let rows = 2 * n;
        let count = c.len() / n;
        for (index, stage) in stages(n, &self.numbers, &self.pivots).enumerate() {
            let (head, tail) = c.split_at_mut((index + 1) * n);
            let block = &mut head[index * n..];
            for r in 0..n {
                let above: f64 = (0..r).map(|k| stage.lu[k + r * rows] * block[k]).sum();
                block[r] = (block[r] - above) / stage.lu[r + r * rows];
            }
            let last = index + 2 == count;
            let factor = if last { closing } else { 1.0 };
            let end = tail.len() - n;
            for k in 0..n {
                let dot = |a: &[f64]| -> f64 { (0..n).map(|r| block[r] * a[r + k * n]).sum() };
                let (by_next, by_first) = (dot(stage.next), dot(stage.first));
                tail[k] -= factor * by_next;
                tail[end + k] -= by_first;
            }
            *border -= (0..n).map(|r| stage.border[r] * block[r]).sum::<f64>();
        }
        self.tail[..n].copy_from_slice(&c[(count - 1) * n..]);
        self.tail[n] = self.scale * *border;
        self.last.solve_transpose(&mut self.tail);
        *border = self.tail[n];
        c[(count - 1) * n..].copy_from_slice(&self.tail[..n]);
        for (index, stage) in stages(n, &self.numbers, &self.pivots).enumerate().rev() {
            let pair = &mut c[index * n..(index + 2) * n];
            for r in 0..n {
                pair[r] -= stage.multiples[r] * *border;
            }
            for k in (0..n).rev() {
                let below: f64 = (k + 1..rows).map(|r| stage.lu[r + k * rows] * pair[r]).sum();
                pair[k] -= below;
            }
            (0..n).rev().for_each(|k| pair.swap(k, stage.pivots[k]));
        }
    }
}
