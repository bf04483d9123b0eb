//! Kernels on the lower band of a symmetric matrix: `A = L D Lᵀ` without pivoting, substitution,
//! product.
//!
//! Column `j` holds `A[j..=j + kd, j]` contiguously; `kd` zero columns follow the last one, so
//! that no loop has a short end. Half-bandwidths up to 8, and 11, are compiled with fixed loop lengths.
//! Golub & Van Loan, *Matrix Computations*, 4th ed., sections 4.1.2 and 4.3.

use super::kernel::{self, Arithmetic, Kernel};
use super::vector::pivot_or_floor;

/// What [`factor`] found.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pivots {
    /// Number of negative pivots.
    pub(super) negative: usize,
    /// Number of pivots replaced by the floor.
    pub(super) perturbed: usize,
    /// Largest `|l_ij d_j l_ij|`, `|d_j|`: the largest term met in the elimination.
    pub(super) largest: f64,
}

macro_rules! by_half_bandwidth {
    ($kd:expr, $fixed:ident, $general:ident, $($arg:expr),*) => {
        match $kd {
            1 => $fixed::<1, 2>($($arg),*),
            2 => $fixed::<2, 3>($($arg),*),
            3 => $fixed::<3, 4>($($arg),*),
            4 => $fixed::<4, 5>($($arg),*),
            5 => $fixed::<5, 6>($($arg),*),
            6 => $fixed::<6, 7>($($arg),*),
            7 => $fixed::<7, 8>($($arg),*),
            8 => $fixed::<8, 9>($($arg),*),
            11 => $fixed::<11, 12>($($arg),*),
            kd => $general(kd, $($arg),*),
        }
    };
}

/// Overwrites the columns by `L` below and `1/D` on the diagonal; `n + kd` columns.
pub(super) fn factor(kd: usize, columns: &mut [f64], n: usize, floor: f64) -> Pivots {
    by_half_bandwidth!(kd, factor_fixed, factor_general, columns, n, floor)
}

/// Solves in place with the factors; `x` has `n + kd` entries, the last `kd` zero.
pub(super) fn solve(kd: usize, columns: &[f64], n: usize, x: &mut [f64]) {
    by_half_bandwidth!(kd, solve_fixed, solve_general, columns, n, x);
}

/// `y = A x`; `x` and `y` have `n` entries.
pub(super) fn mul(kd: usize, columns: &[f64], x: &[f64], y: &mut [f64]) {
    by_half_bandwidth!(kd, mul_fixed, mul_general, columns, x, y);
}

fn factor_fixed<const K: usize, const W: usize>(
    columns: &mut [f64],
    n: usize,
    floor: f64,
) -> Pivots {
    kernel::run(Factor::<K, W> { columns, n, floor })
}

struct Factor<'a, const K: usize, const W: usize> {
    columns: &'a mut [f64],
    n: usize,
    floor: f64,
}

impl<const K: usize, const W: usize> Kernel for Factor<'_, K, W> {
    type Output = Pivots;

    #[inline(always)]
    fn run<A: Arithmetic>(self) -> Pivots {
        let Factor { columns, n, floor } = self;
        let (columns, _) = columns.as_chunks_mut::<W>();
        let mut largest = [0.0; W];
        let (mut negative, mut perturbed) = (0, 0);
        for j in 0..n {
            let Some((column, next)) = columns[j..].split_first_mut() else { break };
            let Some(next) = next.first_chunk_mut::<K>() else { break };
            let (d, replaced) = pivot_or_floor(column[0], floor);
            perturbed += usize::from(replaced);
            negative += usize::from(d < 0.0);
            column[0] = d;
            let inverse = 1.0 / d;
            let l = kernel::eliminate::<A, K, W>(column, inverse, next);
            for i in 0..W {
                let term = (column[i] * l[i]).abs();
                largest[i] = if term > largest[i] { term } else { largest[i] };
            }
            *column = l;
            column[0] = inverse;
        }
        let largest = largest.iter().fold(0.0, |m: f64, v| m.max(*v));
        Pivots { negative, perturbed, largest }
    }
}

fn factor_general(kd: usize, columns: &mut [f64], n: usize, floor: f64) -> Pivots {
    let w = kd + 1;
    let mut pivots = Pivots { negative: 0, perturbed: 0, largest: 0.0 };
    for j in 0..n {
        let (column, next) = columns[j * w..].split_at_mut(w);
        let (d, replaced) = pivot_or_floor(column[0], floor);
        pivots.perturbed += usize::from(replaced);
        pivots.negative += usize::from(d < 0.0);
        let inverse = 1.0 / d;
        for (k, target) in next.chunks_exact_mut(w).take(kd).enumerate() {
            let t = column[k + 1] * inverse;
            for (a, l) in target.iter_mut().zip(&column[k + 1..]) {
                *a -= t * l;
            }
        }
        let mut largest = d.abs();
        for a in &mut column[1..] {
            let l = *a * inverse;
            largest = largest.max((l * *a).abs());
            *a = l;
        }
        pivots.largest = pivots.largest.max(largest);
        column[0] = inverse;
    }
    pivots
}

fn solve_fixed<const K: usize, const W: usize>(columns: &[f64], n: usize, x: &mut [f64]) {
    kernel::run(Solve::<K, W> { columns, n, x });
}

struct Solve<'a, const K: usize, const W: usize> {
    columns: &'a [f64],
    n: usize,
    x: &'a mut [f64],
}

impl<const K: usize, const W: usize> Kernel for Solve<'_, K, W> {
    type Output = ();

    #[inline(always)]
    fn run<A: Arithmetic>(self) {
        let Solve { columns, n, x } = self;
        let x = &mut x[..n];
        let (columns, _) = columns.as_chunks::<W>();
        let columns = &columns[..n];
        // The nearest unknown, just computed, comes last: nothing else waits for it. L z = b first.
        let mut recent = [0.0; K];
        for j in 0..n {
            let mut z = x[j];
            if j >= K {
                for i in (1..W).rev() {
                    z = A::mul_add(-columns[j - i][i], recent[i - 1], z);
                }
            } else {
                for i in (1..=j).rev() {
                    z = A::mul_add(-columns[j - i][i], recent[i - 1], z);
                }
            }
            push(&mut recent, z);
            x[j] = z * columns[j][0];
        }
        // Lᵀ x = D⁻¹ z; behind the end there is nothing
        recent = [0.0; K];
        for (column, x) in columns.iter().zip(x).rev() {
            let mut s = *x;
            for i in (1..W).rev() {
                s = A::mul_add(-column[i], recent[i - 1], s);
            }
            push(&mut recent, s);
            *x = s;
        }
    }
}

/// Puts `x` first and forgets the last.
#[inline(always)]
fn push<const K: usize>(recent: &mut [f64; K], x: f64) {
    for i in (1..K).rev() {
        recent[i] = recent[i - 1];
    }
    recent[0] = x;
}

fn solve_general(kd: usize, columns: &[f64], n: usize, x: &mut [f64]) {
    let w = kd + 1;
    for (j, column) in columns.chunks_exact(w).take(n).enumerate() {
        let (head, tail) = x[j..].split_at_mut(1);
        for (t, l) in tail.iter_mut().zip(&column[1..]) {
            *t -= l * head[0];
        }
        head[0] *= column[0];
    }
    for j in (0..n).rev() {
        let column = &columns[j * w..(j + 1) * w];
        let (head, tail) = x[j..].split_at_mut(1);
        for (t, l) in tail.iter().zip(&column[1..]) {
            head[0] -= l * t;
        }
    }
}

fn mul_fixed<const K: usize, const W: usize>(columns: &[f64], x: &[f64], y: &mut [f64]) {
    let n = y.len();
    let (columns, _) = columns.as_chunks::<W>();
    let mut waiting = [0.0; W]; // contributions from the left to the next W rows
    let mut padded;
    for (j, column) in columns[..n].iter().enumerate() {
        let segment = match x[j..].first_chunk::<W>() {
            Some(segment) => segment,
            None => {
                padded = [0.0; W];
                padded[..n - j].copy_from_slice(&x[j..]);
                &padded
            }
        };
        let mut s = waiting[0];
        for i in 0..W {
            s += column[i] * segment[i];
        }
        y[j] = s;
        for i in 0..K {
            waiting[i] = waiting[i + 1] + column[i + 1] * segment[0];
        }
    }
}

fn mul_general(kd: usize, columns: &[f64], x: &[f64], y: &mut [f64]) {
    y.fill(0.0);
    for (j, column) in columns.chunks_exact(kd + 1).take(y.len()).enumerate() {
        let mut s = column[0] * x[j];
        for ((a, x_i), y_i) in column[1..].iter().zip(&x[j + 1..]).zip(&mut y[j + 1..]) {
            s += a * x_i;
            *y_i += a * x[j];
        }
        y[j] += s;
    }
}
