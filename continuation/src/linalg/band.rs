//! General band matrix, LU with partial pivoting.

use super::vector::{add_scaled, dot, max_abs, pivot_or_floor, sign, solve_refined};
use super::{Facts, Matrix, OutsidePattern, SymmetricBand, SymmetricPart};

/// Difference of mirrored entries, relative to the largest one, that is rounding of their assembly.
const SYMMETRIC: f64 = 4.0 * f64::EPSILON;

/// A band matrix with `kl` diagonals below and `ku` above the main one.
///
/// `P A = L U` by elimination with partial pivoting (Golub & Van Loan, section 4.3.6; the layout
/// is that of LAPACK's `gbtrf`, unblocked). A pivot is chosen by its size relative to the largest
/// entry of its row, so that the scales of the equations do not matter. Cost about
/// `2 n kl (kl + ku)` operations. Inertia is not reported.
#[derive(Debug, Clone)]
pub struct Band {
    n: usize,
    kl: usize,
    ku: usize,
    entries: Vec<f64>,
    factors: Vec<f64>,
    pivots: Vec<usize>,
    row_scale: Vec<f64>,
    rhs: Vec<f64>,
    residual: Vec<f64>,
    norm: f64,
    refine: bool,
    /// The symmetric part, if it was asked for.
    symmetric: Option<Box<SymmetricBand>>,
    misplaced: Option<OutsidePattern>,
}

impl Band {
    /// A zero matrix of `n` rows with `kl` sub- and `ku` superdiagonals.
    pub fn new(n: usize, kl: usize, ku: usize) -> Self {
        Self {
            n,
            kl,
            ku,
            entries: vec![0.0; n * (kl + ku + 1)],
            factors: vec![0.0; n * (2 * kl + ku + 1)],
            pivots: vec![0; n],
            row_scale: vec![0.0; n],
            rhs: vec![0.0; n],
            residual: vec![0.0; n],
            norm: 0.0,
            refine: false,
            symmetric: None,
            misplaced: None,
        }
    }

    /// Numbers of sub- and superdiagonals.
    pub fn bandwidths(&self) -> (usize, usize) {
        (self.kl, self.ku)
    }

    fn has(&self, i: usize, j: usize) -> bool {
        i < self.n && j < self.n && i <= j + self.kl && j <= i + self.ku
    }

    /// Of an entry in the band.
    fn index(&self, i: usize, j: usize) -> usize {
        j * (self.kl + self.ku + 1) + self.ku + i - j
    }

    fn entry(&mut self, row: usize, column: usize) -> Option<&mut f64> {
        if !self.has(row, column) {
            self.misplaced = self.misplaced.or(Some(OutsidePattern { row, column }));
            return None;
        }
        let at = self.index(row, column);
        self.entries.get_mut(at)
    }

    /// Sets entry `(i, j)`. One outside the band is not written, and [`Matrix::misplaced`] then.
    pub fn set(&mut self, i: usize, j: usize, value: f64) {
        if let Some(entry) = self.entry(i, j) {
            *entry = value;
        }
    }

    /// Adds to entry `(i, j)`. One outside the band is not written, and [`Matrix::misplaced`] then.
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        if let Some(entry) = self.entry(i, j) {
            *entry += value;
        }
    }

    /// Entry `(i, j)`; zero outside the band.
    pub fn get(&self, i: usize, j: usize) -> f64 {
        if self.has(i, j) { self.entries[self.index(i, j)] } else { 0.0 }
    }

    /// Rows `first..last` of column `j` that are in the band.
    fn rows(&self, j: usize) -> (usize, usize) {
        (j.saturating_sub(self.ku), (j + self.kl + 1).min(self.n))
    }

    /// The entries of column `j` from its first row in the band on, and that row.
    pub fn column(&self, j: usize) -> (usize, &[f64]) {
        let (first, last) = self.rows(j);
        let start = self.index(first, j);
        (first, &self.entries[start..start + last - first])
    }

    /// Substitution with the factors, no refinement.
    pub(super) fn substitute(&self, x: &mut [f64]) {
        let (n, kl, kv) = (self.n, self.kl, self.kl + self.ku);
        let ld = kl + kv + 1;
        for j in 0..n {
            x.swap(j, self.pivots[j]);
            let below = kl.min(n - 1 - j);
            let l = &self.factors[j * ld + kv + 1..][..below];
            let (head, tail) = x[j..].split_at_mut(1);
            add_scaled(&mut tail[..below], -head[0], l);
        }
        for j in (0..n).rev() {
            let above = kv.min(j);
            let column = &self.factors[j * ld + kv - above..][..=above];
            let (head, tail) = x.split_at_mut(j);
            tail[0] /= column[above];
            add_scaled(&mut head[j - above..], -tail[0], &column[..above]);
        }
    }

    /// Substitution with the transposed factors, no refinement.
    fn substitute_transpose(&self, x: &mut [f64]) {
        let (n, kl, kv) = (self.n, self.kl, self.kl + self.ku);
        let ld = kl + kv + 1;
        for j in 0..n {
            let above = kv.min(j);
            let column = &self.factors[j * ld + kv - above..][..=above];
            x[j] = (x[j] - dot(&column[..above], &x[j - above..j])) / column[above];
        }
        for j in (0..n).rev() {
            let below = kl.min(n - 1 - j);
            let l = &self.factors[j * ld + kv + 1..][..below];
            x[j] -= dot(l, &x[j + 1..j + 1 + below]);
            x.swap(j, self.pivots[j]);
        }
    }

    fn load(&mut self) {
        let (width, ld) = (self.kl + self.ku + 1, 2 * self.kl + self.ku + 1);
        self.row_scale.fill(0.0);
        self.factors.fill(0.0);
        for j in 0..self.n {
            let column = &self.entries[j * width..(j + 1) * width];
            self.factors[j * ld + self.kl..(j + 1) * ld].copy_from_slice(column);
            let (first, last) = self.rows(j);
            for i in first..last {
                let size = column[self.ku + i - j].abs();
                if size > self.row_scale[i] {
                    self.row_scale[i] = size;
                }
            }
        }
    }

    fn solve_with(&mut self, x: &mut [f64], transposed: bool) {
        let mut rhs = std::mem::take(&mut self.rhs);
        let mut residual = std::mem::take(&mut self.residual);
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
            if transposed { this.substitute_transpose(x) } else { this.substitute(x) }
        };
        solve_refined(x, &mut rhs, &mut residual, this.refine, substitute, multiply);
        self.rhs = rhs;
        self.residual = residual;
    }
}

impl Matrix for Band {
    fn dim(&self) -> usize {
        self.n
    }

    fn set_zero(&mut self) {
        self.entries.fill(0.0);
        self.misplaced = None;
    }

    fn misplaced(&self) -> Option<OutsidePattern> {
        self.misplaced
    }

    fn mul(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for j in 0..self.n {
            let (first, column) = self.column(j);
            add_scaled(&mut y[first..], x[j], column);
        }
    }

    fn mul_transpose(&self, x: &[f64], y: &mut [f64]) {
        for j in 0..self.n {
            let (first, column) = self.column(j);
            y[j] = dot(column, &x[first..first + column.len()]);
        }
    }

    fn axpy(&mut self, a: f64, other: &Self) {
        debug_assert_eq!(
            (self.n, self.kl, self.ku),
            (other.n, other.kl, other.ku),
            "different patterns"
        );
        add_scaled(&mut self.entries, a, &other.entries);
    }

    fn norm(&self) -> f64 {
        max_abs(&self.entries)
    }

    fn factor(&mut self, floor: f64) -> Facts {
        let (n, kl, kv) = (self.n, self.kl, self.kl + self.ku);
        let ld = kl + kv + 1;
        let floor = floor.max(f64::MIN_POSITIVE);
        self.norm = self.norm();
        self.load();
        let (mut det_sign, mut perturbed, mut last_column) = (1, 0, 0);
        for j in 0..n {
            let below = kl.min(n - 1 - j);
            let at = j * ld + kv;
            let (mut p, mut best) = (0, -1.0);
            for i in 0..=below {
                let scale = self.row_scale[j + i];
                let size = self.factors[at + i].abs() / if scale > 0.0 { scale } else { 1.0 };
                if size > best {
                    (p, best) = (i, size);
                }
            }
            self.pivots[j] = j + p;
            last_column = last_column.max((j + self.ku + p).min(n - 1));
            if p > 0 {
                det_sign = -det_sign;
                self.row_scale.swap(j, j + p);
                for k in j..=last_column {
                    let row = k * ld + kv + j - k;
                    self.factors.swap(row, row + p);
                }
            }
            let (pivot, replaced) = pivot_or_floor(self.factors[at], floor);
            self.factors[at] = pivot;
            perturbed += usize::from(replaced);
            det_sign *= sign(pivot);
            let (done, rest) = self.factors.split_at_mut((j + 1) * ld);
            let l = &mut done[at + 1..at + 1 + below];
            for value in l.iter_mut() {
                *value /= pivot;
            }
            for k in j + 1..=last_column {
                let row = (k - j - 1) * ld + kv + j - k;
                let t = rest[row];
                if t != 0.0 {
                    add_scaled(&mut rest[row + 1..row + 1 + below], -t, l);
                }
            }
        }
        let largest =
            (0..n).map(|j| max_abs(&self.factors[j * ld..=j * ld + kv])).fold(0.0, f64::max);
        self.refine = perturbed == 0;
        Facts {
            det_sign: Some(det_sign),
            inertia: None,
            growth: if self.norm > 0.0 { largest / self.norm } else { 1.0 },
            perturbed,
        }
    }

    fn solve(&mut self, x: &mut [f64]) {
        self.solve_with(x, false);
    }

    fn solve_transpose(&mut self, x: &mut [f64]) {
        self.solve_with(x, true);
    }

    fn entries(&self, visit: &mut dyn FnMut(usize, usize, f64)) -> bool {
        for j in 0..self.n {
            let (first, column) = self.column(j);
            column.iter().enumerate().for_each(|(k, value)| visit(first + k, j, *value));
        }
        true
    }

    fn add_identity(&mut self, a: f64) -> bool {
        for i in 0..self.n {
            self.add(i, i, a);
        }
        true
    }

    /// By `L D Lᵀ` of the band; half as dear as the factorisation, storage allocated once.
    fn symmetric_part(&mut self) -> Option<SymmetricPart> {
        let (n, kd) = (self.n, self.kl.max(self.ku));
        let mut part = self.symmetric.take().unwrap_or_else(|| Box::new(SymmetricBand::new(n, kd)));
        let mut apart = 0.0_f64;
        for j in 0..n {
            for (k, entry) in part.column_mut(j).iter_mut().enumerate() {
                let (below, above) = (self.get(j + k, j), self.get(j, j + k));
                *entry = 0.5 * (below + above);
                apart = apart.max((below - above).abs());
            }
        }
        let norm = part.norm();
        let facts = part.factor(f64::EPSILON * norm);
        self.symmetric = Some(part);
        let (negative, positive) = facts.inertia.filter(|_| facts.perturbed == 0)?;
        Some(SymmetricPart { negative, positive, whole: apart <= SYMMETRIC * norm })
    }

    fn complex(&self, imaginary: &Self) -> Option<Self> {
        debug_assert_eq!(
            (self.n, self.kl, self.ku),
            (imaginary.n, imaginary.kl, imaginary.ku),
            "different patterns"
        );
        let mut out = Self::new(2 * self.n, 2 * self.kl + 1, 2 * self.ku + 1);
        for j in 0..self.n {
            let (first, last) = self.rows(j);
            for i in first..last {
                let (a, b) = (self.get(i, j), imaginary.get(i, j));
                out.set(2 * i, 2 * j, a);
                out.set(2 * i, 2 * j + 1, -b);
                out.set(2 * i + 1, 2 * j, b);
                out.set(2 * i + 1, 2 * j + 1, a);
            }
        }
        Some(out)
    }
}
