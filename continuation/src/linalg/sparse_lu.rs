//! Sparse LU by the left-looking algorithm of Gilbert and Peierls.
//!
//! Column `k` of the factors solves a sparse triangular system with the columns before; a
//! depth-first search finds its pattern in time proportional to the work (Gilbert & Peierls 1988;
//! T. A. Davis, *Direct Methods for Sparse Linear Systems*, SIAM, 2006, chapter 6). Later
//! factorisations keep pivots and pattern, without the search, as long as the pivots stay large
//! enough (as KLU does, Davis & Palamadai Natarajan 2010).

use super::scalar::Scalar;

/// A row that has no pivot yet.
const NONE: usize = usize::MAX;
/// A diagonal entry of at least this part of the largest candidate is the pivot, where the order
/// of the columns counts on that.
const DIAGONAL: f64 = 0.1;
/// Pivots of an earlier factorisation are kept if they are at least this part of the largest
/// candidate.
const KEPT: f64 = 0.01;

/// A matrix by columns: entries `start[j]..start[j + 1]` of `rows` and `values` are column `j`.
#[derive(Clone, Copy)]
pub(super) struct Columns<'a, T> {
    pub(super) start: &'a [usize],
    pub(super) rows: &'a [usize],
    pub(super) values: &'a [T],
}

/// What a factorisation found.
#[derive(Debug, Clone, Copy)]
pub(super) struct Found<T> {
    /// The determinant over its magnitude.
    pub(super) direction: T,
    pub(super) perturbed: usize,
    /// Largest entry of `U`.
    pub(super) largest: f64,
}

/// `P A Q = L U` with `L` of unit diagonal, real or complex.
#[derive(Debug, Clone)]
pub(super) struct SparseLu<T> {
    n: usize,
    /// Step `k` eliminates column `order[k]`.
    order: Vec<usize>,
    order_sign: i8,
    prefer_diagonal: bool,
    /// Row of the pivot of step `k`, and the step in which a row was the pivot.
    pivot_row: Vec<usize>,
    step: Vec<usize>,
    lower: Triangle<T>,
    upper: Triangle<T>,
    pivots: Vec<T>,
    /// Whether pivots and pattern are those of a complete factorisation.
    analysed: bool,
    x: Vec<T>,
    visited: Vec<bool>,
    stack: Vec<(usize, usize)>,
    reach: Vec<usize>,
}

/// Columns of a factor without its diagonal.
#[derive(Debug, Clone, Default)]
struct Triangle<T> {
    start: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<T>,
}

impl<T> Triangle<T> {
    fn new(n: usize, capacity: usize) -> Self {
        Self {
            start: Vec::with_capacity(n + 1),
            rows: Vec::with_capacity(capacity),
            values: Vec::with_capacity(capacity),
        }
    }

    fn clear(&mut self) {
        self.start.clear();
        self.start.push(0);
        self.rows.clear();
        self.values.clear();
    }

    fn push(&mut self, row: usize, value: T) {
        self.rows.push(row);
        self.values.push(value);
    }

    fn close(&mut self) {
        self.start.push(self.rows.len());
    }

    fn column(&self, k: usize) -> (&[usize], &[T]) {
        let range = self.start[k]..self.start[k + 1];
        (&self.rows[range.clone()], &self.values[range])
    }
}

/// `x[rows] -= a · values`.
fn subtract<T: Scalar>(x: &mut [T], a: T, (rows, values): (&[usize], &[T])) {
    for (i, v) in rows.iter().zip(values) {
        x[*i] = x[*i] - a * *v;
    }
}

fn inner<T: Scalar>(x: &[T], (rows, values): (&[usize], &[T])) -> T {
    rows.iter().zip(values).fold(T::ZERO, |sum, (i, v)| sum + x[*i] * *v)
}

impl<T: Scalar> SparseLu<T> {
    /// Storage for matrices of about `entries` entries whose columns are eliminated in this order.
    pub(super) fn new(order: Vec<usize>, prefer_diagonal: bool, entries: usize) -> Self {
        let n = order.len();
        let mut visited = vec![false; n];
        let order_sign = parity(&order, &mut visited);
        Self {
            n,
            order,
            order_sign,
            prefer_diagonal,
            pivot_row: vec![0; n],
            step: vec![NONE; n],
            lower: Triangle::new(n, 4 * entries),
            upper: Triangle::new(n, 4 * entries),
            pivots: vec![T::real(1.0); n],
            analysed: false,
            x: vec![T::ZERO; n],
            visited,
            stack: Vec::with_capacity(n),
            reach: Vec::with_capacity(n),
        }
    }

    /// Factors `a`; candidates for pivots are compared relative to the `scale` of their rows.
    pub(super) fn factor(&mut self, a: Columns<'_, T>, scale: &[f64], floor: f64) -> Found<T> {
        let mut found = None;
        if self.analysed {
            found = self.repeat(a, scale, floor);
        }
        let (perturbed, largest) = found.unwrap_or_else(|| self.analyse(a, scale, floor));
        let rows = parity(&self.pivot_row, &mut self.visited);
        let sign = T::real(f64::from(rows * self.order_sign));
        let direction = self.pivots.iter().fold(sign, |d, pivot| d * pivot.direction());
        Found { direction, perturbed, largest }
    }

    /// Chooses pivots and finds the pattern.
    fn analyse(&mut self, a: Columns<'_, T>, scale: &[f64], floor: f64) -> (usize, f64) {
        self.lower.clear();
        self.upper.clear();
        self.step.fill(NONE);
        self.x.fill(T::ZERO);
        let (mut perturbed, mut largest) = (0, 0.0);
        let mut first_free = 0;
        for k in 0..self.n {
            let column = self.order[k];
            let range = a.start[column]..a.start[column + 1];
            self.reach.clear();
            for &i in &a.rows[range.clone()] {
                self.search(i);
            }
            for at in range {
                self.x[a.rows[at]] = a.values[at];
            }
            let (mut pivot, mut best, mut diagonal) = (NONE, -1.0, -1.0);
            // the search leaves rows before those they lead to last
            for &i in self.reach.iter().rev() {
                self.visited[i] = false;
                let step = self.step[i];
                let value = self.x[i];
                if step == NONE {
                    let size = value.size() / scale[i];
                    if size > best {
                        (pivot, best) = (i, size);
                    }
                    if i == column {
                        diagonal = size;
                    }
                } else {
                    self.upper.push(step, value);
                    largest = f64::max(largest, value.size());
                    self.x[i] = T::ZERO;
                    subtract(&mut self.x, value, self.lower.column(step));
                }
            }
            if self.prefer_diagonal && diagonal >= DIAGONAL * best && diagonal >= 0.0 {
                pivot = column;
            }
            if pivot == NONE {
                // no entry is left: any row will do, the diagonal if it is free
                while first_free < self.n && self.step[first_free] != NONE {
                    first_free += 1;
                }
                pivot = if self.step[column] == NONE { column } else { first_free };
            }
            let (value, replaced) = pivot_or_floor(self.x[pivot], floor);
            perturbed += usize::from(replaced);
            largest = f64::max(largest, value.size());
            self.pivots[k] = value;
            self.pivot_row[k] = pivot;
            self.step[pivot] = k;
            for &i in self.reach.iter().rev() {
                if self.step[i] == NONE {
                    self.lower.push(i, self.x[i] / value);
                }
                self.x[i] = T::ZERO;
            }
            self.x[pivot] = T::ZERO;
            self.upper.close();
            self.lower.close();
        }
        for row in &mut self.lower.rows {
            *row = self.step[*row];
        }
        self.analysed = true;
        (perturbed, largest)
    }

    /// Depth-first search from row `i` through the columns of `L`; appends what it meets to
    /// `reach`, each row after those it leads to.
    fn search(&mut self, i: usize) {
        if self.visited[i] {
            return;
        }
        self.visited[i] = true;
        self.stack.push((i, 0));
        while let Some((row, next)) = self.stack.pop() {
            let step = self.step[row];
            let below = if step == NONE { &[][..] } else { self.lower.column(step).0 };
            match below[next..].iter().position(|r| !self.visited[*r]) {
                Some(at) => {
                    let child = below[next + at];
                    self.stack.push((row, next + at + 1));
                    self.visited[child] = true;
                    self.stack.push((child, 0));
                }
                None => self.reach.push(row),
            }
        }
    }

    /// Factors with the pivots and the pattern of before; `None` if a pivot has become small.
    fn repeat(&mut self, a: Columns<'_, T>, scale: &[f64], floor: f64) -> Option<(usize, f64)> {
        self.x.fill(T::ZERO); // indexed by steps here
        let (mut perturbed, mut largest) = (0, 0.0);
        for k in 0..self.n {
            let column = self.order[k];
            for at in a.start[column]..a.start[column + 1] {
                self.x[self.step[a.rows[at]]] = a.values[at];
            }
            for at in self.upper.start[k]..self.upper.start[k + 1] {
                let step = self.upper.rows[at];
                let value = std::mem::replace(&mut self.x[step], T::ZERO);
                self.upper.values[at] = value;
                largest = f64::max(largest, value.size());
                subtract(&mut self.x, value, self.lower.column(step));
            }
            let raw = std::mem::replace(&mut self.x[k], T::ZERO);
            let (value, replaced) = pivot_or_floor(raw, floor);
            let size = raw.size() / scale[self.pivot_row[k]];
            let mut best = 0.0;
            for at in self.lower.start[k]..self.lower.start[k + 1] {
                let step = self.lower.rows[at];
                let below = std::mem::replace(&mut self.x[step], T::ZERO);
                best = f64::max(best, below.size() / scale[self.pivot_row[step]]);
                self.lower.values[at] = below / value;
            }
            if !(size >= KEPT * best && size.is_finite()) {
                return None;
            }
            perturbed += usize::from(replaced);
            largest = f64::max(largest, value.size());
            self.pivots[k] = value;
        }
        Some((perturbed, largest))
    }

    /// `x ← A⁻¹ x` with scratch space of the same length.
    pub(super) fn solve(&self, x: &mut [T], z: &mut [T]) {
        for k in 0..self.n {
            z[k] = x[self.pivot_row[k]];
        }
        for k in 0..self.n {
            let value = z[k];
            if value != T::ZERO {
                subtract(z, value, self.lower.column(k));
            }
        }
        for k in (0..self.n).rev() {
            let value = z[k] / self.pivots[k];
            z[k] = value;
            if value != T::ZERO {
                subtract(z, value, self.upper.column(k));
            }
        }
        for k in 0..self.n {
            x[self.order[k]] = z[k];
        }
    }

    /// `x ← A⁻ᵀ x` with scratch space of the same length.
    pub(super) fn solve_transpose(&self, x: &mut [T], z: &mut [T]) {
        for k in 0..self.n {
            z[k] = x[self.order[k]];
        }
        for k in 0..self.n {
            z[k] = (z[k] - inner(z, self.upper.column(k))) / self.pivots[k];
        }
        for k in (0..self.n).rev() {
            z[k] = z[k] - inner(z, self.lower.column(k));
        }
        for k in 0..self.n {
            x[self.pivot_row[k]] = z[k];
        }
    }

    /// Factors of matrices of the same pattern, with other numbers.
    pub(super) fn another<S: Scalar>(&self, entries: usize) -> SparseLu<S> {
        SparseLu::new(self.order.clone(), self.prefer_diagonal, entries)
    }

    /// Multiplications of the latest factorisation.
    pub(super) fn work(&self) -> f64 {
        let length = |step: &usize| self.lower.start[step + 1] - self.lower.start[*step];
        self.upper.rows.iter().map(|step| length(step) as f64).sum()
    }

    /// Number of entries of both factors.
    pub(super) fn entries(&self) -> usize {
        self.lower.rows.len() + self.upper.rows.len() + self.n
    }
}

impl SparseLu<f64> {
    /// Number of negative pivots, where all lie on the diagonal.
    pub(super) fn negative_pivots(&self) -> Option<usize> {
        let diagonal = self.pivot_row == self.order;
        diagonal.then(|| self.pivots.iter().filter(|pivot| **pivot < 0.0).count())
    }
}

/// A pivot, or one of magnitude `floor` in its place. Also returns whether it was replaced.
fn pivot_or_floor<T: Scalar>(pivot: T, floor: f64) -> (T, bool) {
    if pivot.size() >= floor { (pivot, false) } else { (pivot.direction() * T::real(floor), true) }
}

/// Sign of a permutation; `visited` is all false before and after.
fn parity(permutation: &[usize], visited: &mut [bool]) -> i8 {
    let mut result = 1;
    for first in 0..permutation.len() {
        let mut at = first;
        let mut length = 0;
        while !visited[at] {
            visited[at] = true;
            at = permutation[at];
            length += 1;
        }
        if length > 0 && length % 2 == 0 {
            result = -result;
        }
    }
    visited.fill(false);
    result
}
