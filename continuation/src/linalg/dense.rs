//! Dense matrix, LU with partial pivoting, full spectrum.

use faer::linalg::solvers::Solve;
use faer::{Mat, Scale, Side};

use super::spectrum::{Spectrum, balance, deficiency, with_errors};
use super::vector::{add_scaled, dot, max_abs, pivot_or_floor, sign, solve_refined};
use super::{Facts, Matrix};

/// Largest dimension of which [`Dense`] computes the full spectrum (seconds above it).
pub const MAX_SPECTRUM: usize = 600;

/// An eigenvalue beyond this multiple of `|A| / |M|` is an infinite one, moved by rounding: those
/// of a differential-algebraic system of index two appear at about `ε^(-1/2)`.
const INFINITE: f64 = 1e7;

/// Shifts of a pencil, in units of `|A| / |M|`: irregular numbers, some on either side.
const SHIFTS: [f64; 4] = [0.739, -0.618, 0.213, -0.171];

/// A dense matrix, stored by columns; meant for at most a few hundred unknowns.
///
/// The LU factorisation is written out here, not taken from faer, because small pivots must be
/// replaced while eliminating and nothing may be allocated. A pivot is chosen by its size relative
/// to the largest entry of its row, so that the scales of the equations do not matter.
/// [`Matrix::factor`] does not report inertia: see [`Dense::symmetric_inertia`].
#[derive(Debug, Clone)]
pub struct Dense {
    n: usize,
    entries: Vec<f64>,
    factors: Vec<f64>,
    pivots: Vec<usize>,
    row_scale: Vec<f64>,
    rhs: Vec<f64>,
    residual: Vec<f64>,
    norm: f64,
    refine: bool,
}

impl Dense {
    /// A zero matrix of `n` rows.
    pub fn new(n: usize) -> Self {
        Self {
            n,
            entries: vec![0.0; n * n],
            factors: vec![0.0; n * n],
            pivots: vec![0; n],
            row_scale: vec![0.0; n],
            rhs: vec![0.0; n],
            residual: vec![0.0; n],
            norm: 0.0,
            refine: false,
        }
    }

    /// Sets entry `(i, j)`.
    pub fn set(&mut self, i: usize, j: usize, value: f64) {
        self.entries[i + j * self.n] = value;
    }

    /// The eigenvalues of symmetric matrices, with a mass matrix that is positive definite by a margin;
    /// `None` of others.
    fn real_spectrum(&self, mass: Option<&Self>) -> Option<Option<Vec<(f64, f64)>>> {
        if !self.is_symmetric() {
            return None;
        }
        let real = |values: Vec<f64>| values.into_iter().map(|v| (v, 0.0)).collect();
        let a = self.to_faer()?;
        let reduced = match mass {
            None => a,
            Some(mass) if mass.is_symmetric() => reduce(&a, &mass.to_faer()?)?,
            Some(_) => return None,
        };
        Some(reduced.self_adjoint_eigenvalues(Side::Lower).ok().map(real))
    }

    /// Adds to entry `(i, j)`.
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        self.entries[i + j * self.n] += value;
    }

    /// Entry `(i, j)`.
    pub fn get(&self, i: usize, j: usize) -> f64 {
        self.entries[i + j * self.n]
    }

    /// Column `j`.
    pub fn column(&self, j: usize) -> &[f64] {
        &self.entries[j * self.n..(j + 1) * self.n]
    }

    /// Column `j`, to be filled.
    pub fn column_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.entries[j * self.n..(j + 1) * self.n]
    }

    /// Numbers of (negative, positive) eigenvalues if the matrix is symmetric to rounding,
    /// `None` otherwise or if it is not finite. Allocates.
    ///
    /// Eigenvalues within rounding of zero, `n ε` times the largest, count as neither.
    pub fn symmetric_inertia(&self) -> Option<(usize, usize)> {
        if !self.is_symmetric() {
            return None;
        }
        let values = self.to_faer()?.self_adjoint_eigenvalues(Side::Lower).ok()?;
        let zero = self.n as f64 * f64::EPSILON * max_abs(&values);
        let negative = values.iter().filter(|v| **v < -zero).count();
        Some((negative, values.iter().filter(|v| **v > zero).count()))
    }

    /// Symmetric to rounding.
    fn is_symmetric(&self) -> bool {
        let tolerance = 8.0 * f64::EPSILON * self.norm();
        let same = |i, j| (self.get(i, j) - self.get(j, i)).abs() <= tolerance;
        (0..self.n).all(|j| (0..j).all(|i| same(i, j)))
    }

    /// A copy for faer; `None` if an entry is not finite.
    fn to_faer(&self) -> Option<Mat<f64>> {
        let finite = self.entries.iter().all(|v| v.is_finite());
        finite.then(|| Mat::from_fn(self.n, self.n, |i, j| self.get(i, j)))
    }

    /// Substitution with the factors, no refinement.
    fn substitute(&self, x: &mut [f64]) {
        let n = self.n;
        for (j, p) in self.pivots.iter().enumerate() {
            x.swap(j, *p);
        }
        for j in 0..n {
            let (head, tail) = x.split_at_mut(j + 1);
            add_scaled(tail, -head[j], &self.factors[j * n + j + 1..(j + 1) * n]);
        }
        for j in (0..n).rev() {
            let column = &self.factors[j * n..];
            let (head, tail) = x.split_at_mut(j);
            tail[0] /= column[j];
            add_scaled(head, -tail[0], column);
        }
    }

    /// Substitution with the transposed factors, no refinement.
    fn substitute_transpose(&self, x: &mut [f64]) {
        let n = self.n;
        for j in 0..n {
            let column = &self.factors[j * n..(j + 1) * n];
            x[j] = (x[j] - dot(&column[..j], &x[..j])) / column[j];
        }
        for j in (0..n).rev() {
            x[j] -= dot(&self.factors[j * n + j + 1..(j + 1) * n], &x[j + 1..]);
        }
        for (j, p) in self.pivots.iter().enumerate().rev() {
            x.swap(j, *p);
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

impl Matrix for Dense {
    fn dim(&self) -> usize {
        self.n
    }

    fn set_zero(&mut self) {
        self.entries.fill(0.0);
    }

    fn mul(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for j in 0..self.n {
            add_scaled(y, x[j], self.column(j));
        }
    }

    fn mul_transpose(&self, x: &[f64], y: &mut [f64]) {
        for j in 0..self.n {
            y[j] = dot(self.column(j), x);
        }
    }

    fn axpy(&mut self, a: f64, other: &Self) {
        debug_assert_eq!(self.n, other.n, "different dimensions");
        add_scaled(&mut self.entries, a, &other.entries);
    }

    fn norm(&self) -> f64 {
        max_abs(&self.entries)
    }

    fn factor(&mut self, floor: f64) -> Facts {
        let n = self.n;
        let floor = floor.max(f64::MIN_POSITIVE);
        self.norm = self.norm();
        self.factors.copy_from_slice(&self.entries);
        for i in 0..n {
            let largest = (0..n).map(|j| self.get(i, j).abs()).fold(0.0, f64::max);
            self.row_scale[i] = if largest > 0.0 { largest } else { 1.0 };
        }
        let (mut det_sign, mut perturbed) = (1, 0);
        for k in 0..n {
            let (mut p, mut best) = (k, -1.0);
            for i in k..n {
                let size = self.factors[i + k * n].abs() / self.row_scale[i];
                if size > best {
                    (p, best) = (i, size);
                }
            }
            self.pivots[k] = p;
            if p != k {
                det_sign = -det_sign;
                self.row_scale.swap(k, p);
                for j in 0..n {
                    self.factors.swap(k + j * n, p + j * n);
                }
            }
            let (pivot, replaced) = pivot_or_floor(self.factors[k + k * n], floor);
            self.factors[k + k * n] = pivot;
            perturbed += usize::from(replaced);
            det_sign *= sign(pivot);
            let (done, rest) = self.factors.split_at_mut((k + 1) * n);
            let l = &mut done[k * n + k + 1..];
            for value in l.iter_mut() {
                *value /= pivot;
            }
            for column in rest.chunks_exact_mut(n) {
                let t = column[k];
                if t != 0.0 {
                    add_scaled(&mut column[k + 1..], -t, l);
                }
            }
        }
        let largest = (0..n).map(|j| max_abs(&self.factors[j * n..=j * n + j])).fold(0.0, f64::max);
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

    fn add_identity(&mut self, a: f64) -> bool {
        self.entries.iter_mut().step_by(self.n + 1).for_each(|entry| *entry += a);
        true
    }

    /// `None` above [`MAX_SPECTRUM`] unknowns. Symmetric matrices have exactly real eigenvalues,
    /// with a mass matrix if that is positive definite to rounding. Allocates.
    ///
    /// Otherwise the pencil is shifted and inverted; eigenvalues beyond 1e7 `|A| / |M|` count as
    /// infinite, which leaves out those of differential-algebraic systems up to index two. `None`
    /// also where the pencil is singular for every `λ`.
    fn spectrum(&self, mass: Option<&Self>) -> Option<Vec<(f64, f64)>> {
        if self.n > MAX_SPECTRUM {
            return None;
        }
        if let Some(real) = self.real_spectrum(mass) {
            return real;
        }
        let mut a = self.to_faer()?;
        let Some(mass) = mass else {
            balance(&mut a);
            let values = a.eigenvalues().ok()?;
            return Some(values.iter().map(|z| (z.re, z.im)).collect());
        };
        let (inverse, shift, unit) = inverted(&a, &mass.to_faer()?, self.norm(), mass.norm())?;
        let values = inverse.eigenvalues().ok()?;
        let finite = values.iter().filter(|z| is_finite((z.re, z.im), unit));
        Some(finite.map(|z| from_inverse((z.re, z.im), shift)).collect())
    }

    fn spectrum_with_errors(&self, mass: Option<&Self>) -> Option<Spectrum> {
        if self.n > MAX_SPECTRUM {
            return None;
        }
        if let Some(real) = self.real_spectrum(mass) {
            let real = real?;
            let largest = real.iter().fold(0.0, |m: f64, v| m.max(v.0.abs()));
            return Some(Spectrum::uniform(real, 4.0 * self.n as f64 * f64::EPSILON * largest));
        }
        let a = self.to_faer()?;
        let Some(mass) = mass else { return with_errors(a) };
        let m = mass.to_faer()?;
        let (inverse, shift, unit) = inverted(&a, &m, self.norm(), mass.norm())?;
        let found = with_errors(inverse)?;
        let all = found.values.iter().zip(&found.errors);
        let finite = all.filter(|(z, _)| is_finite(**z, unit));
        // an error of the inverse moves the eigenvalue by that of its square
        let moved = |((re, im), error): (&(f64, f64), &f64)| {
            (from_inverse((*re, *im), shift), error / (re * re + im * im))
        };
        let (values, errors): (Vec<_>, Vec<_>) = finite.map(moved).unzip();
        let complete = self.n - values.len() == deficiency(&m);
        Some(Spectrum { values, errors, complete })
    }

    fn complex(&self, imaginary: &Self) -> Option<Self> {
        debug_assert_eq!(self.n, imaginary.n, "different dimensions");
        let mut out = Self::new(2 * self.n);
        for j in 0..self.n {
            for i in 0..self.n {
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

/// `L⁻¹ A L⁻ᵀ` with `M = L Lᵀ`; `None` if `M` is not positive definite by a margin.
fn reduce(a: &Mat<f64>, m: &Mat<f64>) -> Option<Mat<f64>> {
    let n = a.nrows();
    let llt = m.llt(Side::Lower).ok()?;
    let l = llt.L();
    let pivots = (0..n).map(|i| l[(i, i)] * l[(i, i)]);
    let (least, largest) =
        pivots.fold((f64::INFINITY, 0.0), |(l, g): (f64, f64), d| (l.min(d), g.max(d)));
    if least <= 1e-10 * largest {
        return None; // singular, or nearly: the reduction would be inaccurate
    }
    let mut c = a.clone();
    for _ in 0..2 {
        l.solve_lower_triangular_in_place(&mut c);
        c = c.transpose().to_owned();
    }
    Some(Mat::from_fn(n, n, |i, j| 0.5 * (c[(i, j)] + c[(j, i)])))
}

/// `(A − σM)⁻¹M`, whose eigenvalues `1/(λ − σ)` are those of `A x = λ M x`, with `σ` and the unit
/// `|A| / |M|`.
///
/// Not faer's QZ: version 0.24 returns wrong conjugates, and NaN from some size on. The error is of the
/// same order, `ε |A| / |M|` times the condition of the eigenvalue, as long as `A − σM` is well
/// conditioned for one of the shifts tried; all are of the size `|A| / |M|`.
fn inverted(a: &Mat<f64>, m: &Mat<f64>, a_norm: f64, m_norm: f64) -> Option<(Mat<f64>, f64, f64)> {
    let n = a.nrows();
    if m_norm == 0.0 {
        return Some((Mat::zeros(n, n), 0.0, 1.0));
    }
    let unit = if a_norm > 0.0 { a_norm / m_norm } else { 1.0 };
    let mut best = None;
    let mut best_ratio = 10.0 * f64::EPSILON; // below it the pencil is singular
    for shift in SHIFTS.map(|s| s * unit) {
        let lu = (a - m * Scale(shift)).full_piv_lu();
        let pivots = (0..n).map(|i| lu.U()[(i, i)].abs());
        let (least, largest) =
            pivots.fold((f64::INFINITY, 0.0), |(l, g): (f64, f64), d| (l.min(d), g.max(d)));
        if least > best_ratio * largest {
            best_ratio = least / largest;
            best = Some((shift, lu));
        }
    }
    let (shift, lu) = best?;
    Some((lu.solve(m), shift, unit))
}

/// Whether `1/(λ − σ)` belongs to a finite eigenvalue.
fn is_finite((re, im): (f64, f64), unit: f64) -> bool {
    re.hypot(im) * unit * INFINITE >= 1.0
}

fn from_inverse((re, im): (f64, f64), shift: f64) -> (f64, f64) {
    let square = re * re + im * im;
    (shift + re / square, -im / square)
}
