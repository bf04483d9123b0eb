//! Elimination within one interval: small dense blocks, row by row, in one piece of memory.
//!
//! A block has `k = n m` rows of `[left | inner | column]`, `n`, `k` and 1 numbers wide, and below them
//! the border's row. Eliminating the inner unknowns leaves, in the last `n` rows, those at the right end by
//! those at the left end and the border, and in the border's row what it says of both. Usual sizes are compiled
//! with their loops of fixed length.

/// Numbers that are moved at once.
const LANES: usize = 4;

/// Rows of a block up to which whole rows are eliminated.
const WHOLE: usize = 12;

/// Calls an inlined function with the sizes `n` and `k` as constants where they are usual.
macro_rules! sized {
    ($n:expr, $k:expr, $function:ident($($argument:expr),* $(,)?)) => {
        match ($n, $k) {
            (1, 4) => $function(1, 4, $($argument),*),
            (2, 8) => $function(2, 8, $($argument),*),
            (3, 12) => $function(3, 12, $($argument),*),
            (4, 16) => $function(4, 16, $($argument),*),
            (n, k) => $function(n, k, $($argument),*),
        }
    };
}
pub(super) use sized;

/// Factors of all intervals.
#[derive(Debug, Clone)]
pub(super) struct Factors {
    n: usize,
    k: usize,
    upper: Vec<f64>,
    lower: Vec<f64>,
    pivots: Vec<usize>,
    inverse: Vec<f64>,
    scale: Vec<f64>,
}

/// Factors of one interval.
#[derive(Clone, Copy)]
pub(super) struct Interval<'f> {
    /// `k + 1` rows of `[U | left | column]`, the last one that of the border; what is left of the diagonal
    /// is of no use.
    upper: &'f [f64],
    /// Multiples of the pivot rows in the other rows, by columns of `k + 1`.
    lower: &'f [f64],
    pivots: &'f [usize],
    /// Reciprocals of the diagonal of `U`.
    inverse: &'f [f64],
}

/// What the elimination learned.
#[derive(Debug, Clone, Copy)]
pub(super) struct Learned {
    pub(super) sign: i8,
    pub(super) perturbed: usize,
    /// Of the pivots.
    pub(super) growth: f64,
}

/// Width of a row of `[left | inner | column]` with its padding.
pub(super) const fn stride(n: usize, k: usize) -> usize {
    (n + k + 1).next_multiple_of(LANES)
}

/// The larger of `m` and `|x|`.
#[inline(always)]
fn larger(m: f64, x: f64) -> f64 {
    if x.abs() > m { x.abs() } else { m }
}

impl Factors {
    pub(super) fn new(n: usize, k: usize, intervals: usize) -> Self {
        Factors {
            n,
            k,
            upper: vec![0.0; (k + 1) * stride(n, k) * intervals],
            lower: vec![0.0; (k + 1) * k * intervals],
            pivots: vec![0; k * intervals],
            inverse: vec![0.0; k * intervals],
            scale: vec![0.0; k],
        }
    }

    /// Number of intervals.
    pub(super) fn count(&self) -> usize {
        self.pivots.len() / self.k
    }

    /// The factors of each interval.
    pub(super) fn intervals(&self) -> impl Iterator<Item = Interval<'_>> {
        let (n, k) = (self.n, self.k);
        let upper = self.upper.chunks_exact((k + 1) * stride(n, k));
        let parts = upper.zip(self.lower.chunks_exact((k + 1) * k));
        let others = self.pivots.chunks_exact(k).zip(self.inverse.chunks_exact(k));
        parts.zip(others).map(|((upper, lower), (pivots, inverse))| Interval {
            upper,
            lower,
            pivots,
            inverse,
        })
    }

    /// Eliminates the inner unknowns of interval `j`, from the border's row too if that is wanted; its `entries` are rows of `[left | inner | column]`. Pivots are chosen by
    /// their size relative to the largest entry of their row.
    #[inline(always)]
    pub(super) fn eliminate(
        &mut self,
        n: usize,
        k: usize,
        j: usize,
        entries: &[f64],
        bordered: bool,
    ) -> Learned {
        let rows = k + usize::from(bordered);
        let (wide, ld) = (n + k + 1, stride(n, k));
        let upper = &mut self.upper[j * (k + 1) * ld..(j + 1) * (k + 1) * ld];
        let lower = &mut self.lower[j * (k + 1) * k..(j + 1) * (k + 1) * k];
        let pivots = &mut self.pivots[j * k..(j + 1) * k];
        let inverse = &mut self.inverse[j * k..(j + 1) * k];
        let scale = &mut self.scale[..k];
        let mut norm = 0.0_f64;
        for (r, (row, place)) in
            entries.chunks_exact(wide).zip(upper.chunks_exact_mut(ld)).take(rows).enumerate()
        {
            place[..k].copy_from_slice(&row[n..n + k]);
            place[k..k + n].copy_from_slice(&row[..n]);
            place[k + n] = row[n + k];
            if r < k {
                let largest = place[..k].iter().fold(0.0, |m, x| larger(m, *x));
                norm = larger(norm, largest);
                scale[r] = if largest > 0.0 { 1.0 / largest } else { 1.0 };
            }
        }
        let floor = f64::EPSILON * if norm > 0.0 { norm } else { 1.0 };
        let mut learned = Learned { sign: 1, perturbed: 0, growth: 1.0 };
        let mut largest = 0.0;
        for c in 0..k {
            let (mut p, mut best) = (c, -1.0);
            for r in c..k {
                let size = upper[r * ld + c].abs() * scale[r];
                if size > best {
                    (p, best) = (r, size);
                }
            }
            pivots[c] = p;
            if p != c {
                learned.sign = -learned.sign;
                scale.swap(c, p);
                let (top, bottom) = upper.split_at_mut(p * ld);
                top[c * ld..c * ld + ld].swap_with_slice(&mut bottom[..ld]);
                (0..c).for_each(|j| lower.swap(j * (k + 1) + c, j * (k + 1) + p));
            }
            let mut pivot = upper[c * ld + c];
            if pivot.abs() < floor {
                pivot = if pivot < 0.0 { -floor } else { floor };
                upper[c * ld + c] = pivot;
                learned.perturbed += 1;
            }
            if pivot < 0.0 {
                learned.sign = -learned.sign;
            }
            let reciprocal = 1.0 / pivot;
            inverse[c] = reciprocal;
            largest = larger(largest, pivot);
            let (top, bottom) = upper[..rows * ld].split_at_mut((c + 1) * ld);
            // what is left of the pivot is of no use: all of a short row is faster than a part of it
            let from = if k <= WHOLE { 0 } else { c / LANES * LANES };
            let source = &top[c * ld + from..];
            let multiples = &mut lower[c * (k + 1) + c + 1..(c + 1) * (k + 1)];
            for (row, multiple) in bottom.chunks_exact_mut(ld).zip(multiples) {
                let t = row[c] * reciprocal;
                *multiple = t;
                let (to, _) = row[from..].as_chunks_mut::<LANES>();
                let (by, _) = source.as_chunks::<LANES>();
                for (to, by) in to.iter_mut().zip(by) {
                    (0..LANES).for_each(|i| to[i] -= t * by[i]);
                }
            }
        }
        learned.growth = if norm > 0.0 { largest / norm } else { 1.0 };
        learned
    }
}

impl<'f> Interval<'f> {
    /// `u_right + X u_left + z θ`: `X` by columns, then `z`.
    #[inline(always)]
    pub(super) fn condensed(&self, n: usize, k: usize, out: &mut [f64]) {
        let ld = stride(n, k);
        for c in 0..=n {
            let column = &mut out[c * n..(c + 1) * n];
            for r in (0..n).rev() {
                let row = &self.upper[(k - n + r) * ld..];
                let mut value = row[k + c];
                for i in r + 1..n {
                    value -= row[k - n + i] * column[i];
                }
                column[r] = value * self.inverse[k - n + r];
            }
        }
    }

    /// What the border's row says of the left end, and of the border.
    pub(super) fn border(&self, n: usize, k: usize) -> (&'f [f64], f64) {
        let row = &self.upper[k * stride(n, k)..];
        (&row[k..k + n], row[k + n])
    }

    /// First half of a solve: `b` becomes `L⁻¹ b`, and `right` what the block says of its right end.
    /// What its rows leave in that of the border.
    #[inline(always)]
    pub(super) fn forward(&self, n: usize, k: usize, b: &mut [f64], right: &mut [f64]) -> f64 {
        let ld = stride(n, k);
        let b = &mut b[..k];
        (0..k).for_each(|c| b.swap(c, self.pivots[c]));
        let mut border = 0.0;
        for c in 0..k {
            let column = &self.lower[c * (k + 1)..(c + 1) * (k + 1)];
            let value = b[c];
            for r in c + 1..k {
                b[r] -= column[r] * value;
            }
            border += column[k] * value;
        }
        for r in (0..n).rev() {
            let row = &self.upper[(k - n + r) * ld..];
            let mut value = b[k - n + r];
            for i in r + 1..n {
                value -= row[k - n + i] * right[i];
            }
            right[r] = value * self.inverse[k - n + r];
        }
        border
    }

    /// Second half: the unknowns at the nodes between, in place of the first rows of `b`.
    #[inline(always)]
    pub(super) fn backward(
        &self,
        n: usize,
        k: usize,
        b: &mut [f64],
        (left, right, border): (&[f64], &[f64], f64),
    ) {
        let ld = stride(n, k);
        let inside = k - n;
        let b = &mut b[..inside];
        for r in (0..inside).rev() {
            let row = &self.upper[r * ld..(r + 1) * ld];
            let mut value = b[r] - row[k + n] * border;
            for i in 0..n {
                value -= row[k + i] * left[i] + row[inside + i] * right[i];
            }
            for i in r + 1..inside {
                value -= row[i] * b[i];
            }
            b[r] = value * self.inverse[r];
        }
    }

    /// `b` becomes `U⁻ᵀ b`, and `left`, `border` what is to be taken from their columns.
    #[inline(always)]
    pub(super) fn forward_transposed(
        &self,
        n: usize,
        k: usize,
        b: &mut [f64],
        left: &mut [f64],
    ) -> f64 {
        let ld = stride(n, k);
        let b = &mut b[..k];
        left.fill(0.0);
        let mut border = 0.0;
        for r in 0..k {
            let row = &self.upper[r * ld..(r + 1) * ld];
            let value = b[r] * self.inverse[r];
            b[r] = value;
            for c in r + 1..k {
                b[c] -= row[c] * value;
            }
            for c in 0..n {
                left[c] += row[k + c] * value;
            }
            border += row[k + n] * value;
        }
        border
    }

    /// Second half of a transposed solve: `b`, with what the right end adds and the border takes, becomes
    /// the unknowns of the block's rows.
    #[inline(always)]
    pub(super) fn backward_transposed(
        &self,
        n: usize,
        k: usize,
        b: &mut [f64],
        right: &mut [f64],
        border: f64,
    ) {
        let ld = stride(n, k);
        let b = &mut b[..k];
        let inside = k - n;
        for r in 0..n {
            let mut value = right[r];
            for i in 0..r {
                value -= self.upper[(inside + i) * ld + inside + r] * right[i];
            }
            right[r] = value * self.inverse[inside + r];
            b[inside + r] += right[r];
        }
        (0..k).for_each(|c| b[c] -= self.lower[c * (k + 1) + k] * border);
        for c in (0..k).rev() {
            let column = &self.lower[c * (k + 1)..(c + 1) * (k + 1)];
            let mut value = b[c];
            for r in c + 1..k {
                value -= column[r] * b[r];
            }
            b[c] = value;
        }
        (0..k).rev().for_each(|c| b.swap(c, self.pivots[c]));
    }
}
