//! General sparse matrix, LU with partial pivoting in a fill-reducing order.

use std::sync::Arc;

use faer::c64;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::{amd, colamd};

use super::sparse_lu::{Columns, SparseLu};
use super::vector::{add_scaled, max_abs, sign, solve_refined};
use super::{Facts, MAX_GROWTH, Matrix, SymmetricPart};

/// Part of the entries with a mirror image above which a pattern counts as symmetric.
const SYMMETRIC: f64 = 0.9;
/// Difference of mirrored entries, relative to the largest one, that is rounding of their assembly.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Unknowns from which a factorisation in two dimensions costs many solves.
const LARGE: usize = 2000;

/// A sparse matrix with a fixed pattern, which always contains the diagonal.
///
/// `P A Q = L U` by the left-looking algorithm of Gilbert and Peierls, written out here and not
/// taken from faer: small pivots must be replaced while eliminating and their signs be known, and
/// faer's sparse LU shows neither. The columns are ordered once, by minimum degree on `A + Aᵀ`
/// (AMD) where the pattern is nearly symmetric, diagonal pivots then being preferred, and on `AᵀA`
/// (COLAMD) otherwise; both orderings are faer's. A pivot is chosen by its size relative to the
/// largest entry of its row, so that the scales of the equations do not matter. Later
/// factorisations repeat the first one's pivots and pattern unless a pivot becomes small.
///
/// The storage of the factors grows in the first factorisation, and later only where other pivots
/// cause more fill. A row or column that is nearly full belongs into an [`Arrow`](super::Arrow).
/// Inertia is not reported.
#[derive(Debug, Clone)]
pub struct Sparse {
    pattern: Arc<Pattern>,
    values: Vec<f64>,
    lu: SparseLu<f64>,
    row_scale: Vec<f64>,
    rhs: Vec<f64>,
    residual: Vec<f64>,
    scratch: Vec<f64>,
    norm: f64,
    refine: bool,
    growth: f64,
}

#[derive(Debug, PartialEq)]
struct Pattern {
    n: usize,
    start: Vec<usize>,
    rows: Vec<usize>,
    /// Index of entry `(j, j)`.
    diagonal: Vec<usize>,
}

/// An entry that is not in the pattern of a matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("entry ({row}, {column}) is not in the pattern of the matrix")]
pub struct OutsidePattern {
    /// Its row.
    pub row: usize,
    /// Its column.
    pub column: usize,
}

impl Sparse {
    /// A zero matrix of `n` rows with these entries `(row, column)` and the diagonal; repeated
    /// ones count once.
    ///
    /// # Errors
    /// For an entry beyond `n` rows or columns.
    pub fn new(n: usize, entries: &[(usize, usize)]) -> Result<Self, OutsidePattern> {
        if let Some(&(row, column)) = entries.iter().find(|(i, j)| *i >= n || *j >= n) {
            return Err(OutsidePattern { row, column });
        }
        let mut columns: Vec<Vec<usize>> = (0..n).map(|j| vec![j]).collect();
        for &(i, j) in entries {
            columns[j].push(i);
        }
        let (mut start, mut rows, mut diagonal) = (vec![0], Vec::new(), Vec::new());
        for (j, column) in columns.iter_mut().enumerate() {
            column.sort_unstable();
            column.dedup();
            diagonal.push(rows.len() + column.partition_point(|i| *i < j));
            rows.extend_from_slice(column);
            start.push(rows.len());
        }
        let pattern = Pattern { n, start, rows, diagonal };
        let symmetric = pattern.is_nearly_symmetric();
        let order = pattern.order(symmetric).unwrap_or_else(|| (0..n).collect());
        let entries = pattern.rows.len();
        Ok(Self {
            lu: SparseLu::new(order, symmetric, entries),
            pattern: Arc::new(pattern),
            values: vec![0.0; entries],
            row_scale: vec![0.0; n],
            rhs: vec![0.0; n],
            residual: vec![0.0; n],
            scratch: vec![0.0; n],
            norm: 0.0,
            refine: false,
            growth: f64::INFINITY,
        })
    }

    /// Index of entry `(i, j)` in [`Sparse::values_mut`], if it is in the pattern.
    ///
    /// An assembly that keeps these indices is as fast as one into an array.
    pub fn position(&self, i: usize, j: usize) -> Option<usize> {
        if j >= self.pattern.n {
            return None;
        }
        let first = self.pattern.start[j];
        let column = &self.pattern.rows[first..self.pattern.start[j + 1]];
        column.binary_search(&i).ok().map(|at| first + at)
    }

    fn is_symmetric(&self) -> bool {
        let rounding = ROUNDING * self.norm;
        (0..self.pattern.n).all(|j| {
            let (rows, values) = self.column(j);
            let below = rows.iter().zip(values);
            // an entry without a mirror image must be rounding itself
            below.clone().all(|(i, value)| (value - self.get(j, *i)).abs() <= rounding)
        })
    }

    fn found(&self, row: usize, column: usize) -> Result<usize, OutsidePattern> {
        self.position(row, column).ok_or(OutsidePattern { row, column })
    }

    /// Sets entry `(i, j)`.
    ///
    /// # Errors
    /// If it is not in the pattern.
    pub fn set(&mut self, i: usize, j: usize, value: f64) -> Result<(), OutsidePattern> {
        let at = self.found(i, j)?;
        self.values[at] = value;
        Ok(())
    }

    /// Adds to entry `(i, j)`.
    ///
    /// # Errors
    /// If it is not in the pattern.
    pub fn add(&mut self, i: usize, j: usize, value: f64) -> Result<(), OutsidePattern> {
        let at = self.found(i, j)?;
        self.values[at] += value;
        Ok(())
    }

    /// Entry `(i, j)`; zero outside the pattern.
    pub fn get(&self, i: usize, j: usize) -> f64 {
        self.position(i, j).map_or(0.0, |at| self.values[at])
    }

    /// The entries, by columns and in each by rows.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The entries, to be filled.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Rows and entries of column `j`.
    pub fn column(&self, j: usize) -> (&[usize], &[f64]) {
        let range = self.pattern.start[j]..self.pattern.start[j + 1];
        (&self.pattern.rows[range.clone()], &self.values[range])
    }

    /// Number of entries of the latest factors, both of them.
    pub fn fill(&self) -> usize {
        self.lu.entries()
    }

    /// Where columns start, and the rows of entries.
    pub(super) fn pattern(&self) -> (&[usize], &[usize]) {
        (&self.pattern.start, &self.pattern.rows)
    }

    /// Adds a matrix whose entries are in the pattern.
    pub(super) fn add_entries(&mut self, other: &impl Matrix) {
        other.entries(&mut |i, j, value| {
            if let Some(at) = self.position(i, j) {
                self.values[at] += value;
            }
        });
    }

    /// Sets the diagonal.
    pub(super) fn fill_diagonal(&mut self, value: f64) {
        self.pattern.diagonal.iter().for_each(|at| self.values[*at] = value);
    }

    /// Factors of complex matrices of the same pattern.
    pub(super) fn complex_lu(&self) -> SparseLu<c64> {
        self.lu.another(self.values.len())
    }

    /// Largest sum of magnitudes in a row.
    pub(super) fn row_sums(&self) -> f64 {
        let mut sums = vec![0.0; self.pattern.n];
        for (i, value) in self.pattern.rows.iter().zip(&self.values) {
            sums[*i] += value.abs();
        }
        max_abs(&sums)
    }

    /// `y = A x`.
    pub(super) fn times(&self, x: &[c64], y: &mut [c64]) {
        y.fill(c64::ZERO);
        for (j, x) in x.iter().enumerate() {
            let (rows, values) = self.column(j);
            rows.iter().zip(values).for_each(|(i, value)| y[*i] += x * value);
        }
    }

    fn solve_with(&mut self, x: &mut [f64], transposed: bool) {
        let mut rhs = std::mem::take(&mut self.rhs);
        let mut residual = std::mem::take(&mut self.residual);
        let mut scratch = std::mem::take(&mut self.scratch);
        let this = &*self;
        let multiply = |x: &[f64], y: &mut [f64]| {
            if transposed {
                this.mul_transpose(x, y)
            } else {
                this.mul(x, y)
            }
            this.norm * max_abs(x)
        };
        let substitute = |x: &mut [f64]| {
            if transposed {
                this.lu.solve_transpose(x, &mut scratch)
            } else {
                this.lu.solve(x, &mut scratch)
            }
        };
        solve_refined(x, &mut rhs, &mut residual, this.refine, substitute, multiply);
        self.rhs = rhs;
        self.residual = residual;
        self.scratch = scratch;
    }
}

impl Pattern {
    fn is_nearly_symmetric(&self) -> bool {
        let mirrored = |j: usize| {
            let column = &self.rows[self.start[j]..self.start[j + 1]];
            let has = |i: &&usize| {
                self.rows[self.start[**i]..self.start[**i + 1]].binary_search(&j).is_ok()
            };
            column.iter().filter(has).count()
        };
        let count: usize = (0..self.n).map(mirrored).sum();
        count as f64 >= SYMMETRIC * self.rows.len() as f64
    }

    /// Order of elimination of the columns.
    fn order(&self, symmetric: bool) -> Option<Vec<usize>> {
        let (n, entries) = (self.n, self.rows.len());
        let (mut order, mut inverse) = (vec![0; n], vec![0; n]);
        let matrix = SymbolicSparseColMatRef::new_checked(n, n, &self.start, None, &self.rows);
        let scratch = if symmetric {
            amd::order_scratch::<usize>(n, entries)
        } else {
            colamd::order_scratch::<usize>(n, n, entries)
        };
        let mut buffer = MemBuffer::new(scratch);
        let stack = MemStack::new(&mut buffer);
        if symmetric {
            amd::order(&mut order, &mut inverse, matrix, Default::default(), stack).ok()?;
        } else {
            colamd::order(&mut order, &mut inverse, matrix, Default::default(), stack).ok()?;
        }
        Some(order)
    }
}

impl Matrix for Sparse {
    fn dim(&self) -> usize {
        self.pattern.n
    }

    fn set_zero(&mut self) {
        self.values.fill(0.0);
    }

    fn mul(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for j in 0..self.pattern.n {
            let (rows, values) = self.column(j);
            for (i, v) in rows.iter().zip(values) {
                y[*i] += v * x[j];
            }
        }
    }

    fn prefers_solves(&self) -> bool {
        self.dim() >= LARGE
    }

    fn mul_transpose(&self, x: &[f64], y: &mut [f64]) {
        for j in 0..self.pattern.n {
            let (rows, values) = self.column(j);
            y[j] = rows.iter().zip(values).map(|(i, v)| v * x[*i]).sum();
        }
    }

    fn axpy(&mut self, a: f64, other: &Self) {
        debug_assert!(
            Arc::ptr_eq(&self.pattern, &other.pattern) || self.pattern == other.pattern,
            "different patterns"
        );
        add_scaled(&mut self.values, a, &other.values);
    }

    fn norm(&self) -> f64 {
        max_abs(&self.values)
    }

    fn factor(&mut self, floor: f64) -> Facts {
        self.norm = self.norm();
        self.row_scale.fill(0.0);
        for (i, v) in self.pattern.rows.iter().zip(&self.values) {
            self.row_scale[*i] = self.row_scale[*i].max(v.abs());
        }
        for scale in &mut self.row_scale {
            if *scale == 0.0 {
                *scale = 1.0;
            }
        }
        let columns =
            Columns { start: &self.pattern.start, rows: &self.pattern.rows, values: &self.values };
        let found = self.lu.factor(columns, &self.row_scale, floor.max(f64::MIN_POSITIVE));
        self.refine = found.perturbed == 0;
        self.growth = if self.norm > 0.0 { found.largest / self.norm } else { 1.0 };
        Facts {
            det_sign: Some(sign(found.direction)),
            inertia: None,
            growth: self.growth,
            perturbed: found.perturbed,
        }
    }

    fn solve(&mut self, x: &mut [f64]) {
        self.solve_with(x, false);
    }

    fn solve_transpose(&mut self, x: &mut [f64]) {
        self.solve_with(x, true);
    }

    fn entries(&self, visit: &mut dyn FnMut(usize, usize, f64)) -> bool {
        for j in 0..self.pattern.n {
            let (rows, values) = self.column(j);
            rows.iter().zip(values).for_each(|(i, value)| visit(*i, j, *value));
        }
        true
    }

    fn add_identity(&mut self, a: f64) -> bool {
        for at in &self.pattern.diagonal {
            self.values[*at] += a;
        }
        true
    }

    /// Of symmetric matrices only, from the signs of the pivots where all of them lie on the
    /// diagonal: `P A Pᵀ = L D Lᵀ` then.
    fn symmetric_part(&mut self) -> Option<SymmetricPart> {
        if !(self.refine && self.growth <= MAX_GROWTH && self.is_symmetric()) {
            return None;
        }
        let negative = self.lu.negative_pivots()?;
        Some(SymmetricPart { negative, positive: self.pattern.n - negative, whole: true })
    }

    fn complex(&self, imaginary: &Self) -> Option<Self> {
        debug_assert!(self.pattern == imaginary.pattern, "different patterns");
        let n = self.pattern.n;
        let mut entries = Vec::with_capacity(4 * self.values.len());
        for j in 0..n {
            for i in self.column(j).0 {
                let block = [(0, 0), (0, 1), (1, 0), (1, 1)];
                entries.extend(block.map(|(p, q)| (2 * i + p, 2 * j + q)));
            }
        }
        let mut out = Self::new(2 * n, &entries).ok()?;
        for j in 0..n {
            let (rows, re) = self.column(j);
            let (_, im) = imaginary.column(j);
            for ((i, a), b) in rows.iter().zip(re).zip(im) {
                out.set(2 * i, 2 * j, *a).ok()?;
                out.set(2 * i, 2 * j + 1, -b).ok()?;
                out.set(2 * i + 1, 2 * j, *b).ok()?;
                out.set(2 * i + 1, 2 * j + 1, *a).ok()?;
            }
        }
        Some(out)
    }
}
