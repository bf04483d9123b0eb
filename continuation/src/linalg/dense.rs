//! Dense matrix, LU with partial pivoting, full spectrum.

use faer::{Mat, Side};

use super::pencil::{finite_eigenvalues, finite_spectrum};
use super::spectrum::{Spectrum, balance, with_errors};
use super::vector::{add_scaled, dot, max_abs, pivot_or_floor, sign, solve_refined};
use super::{Facts, Matrix, OutsidePattern};

/// Largest dimension of which [`Dense`] computes the full spectrum (seconds above it).
pub const MAX_SPECTRUM: usize = 600;

/// Square roots of masses that differ by more than this belong to fast and slow modes.
const GRADED: f64 = 1e-4;

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
    misplaced: Option<OutsidePattern>,
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
            misplaced: None,
        }
    }

    fn entry(&mut self, row: usize, column: usize) -> Option<&mut f64> {
        if row >= self.n || column >= self.n {
            self.misplaced = self.misplaced.or(Some(OutsidePattern { row, column }));
            return None;
        }
        self.entries.get_mut(row + column * self.n)
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

    /// Sets entry `(i, j)`. One outside the matrix is not written, and [`Matrix::misplaced`] then.
    pub fn set(&mut self, i: usize, j: usize, value: f64) {
        if let Some(entry) = self.entry(i, j) {
            *entry = value;
        }
    }

    /// Adds to entry `(i, j)`. One outside the matrix is not written, and [`Matrix::misplaced`] then.
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        if let Some(entry) = self.entry(i, j) {
            *entry += value;
        }
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
        self.misplaced = None;
    }

    fn misplaced(&self) -> Option<OutsidePattern> {
        self.misplaced
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

    fn entries(&self, visit: &mut dyn FnMut(usize, usize, f64)) -> bool {
        for j in 0..self.n {
            self.column(j).iter().enumerate().for_each(|(i, value)| visit(i, j, *value));
        }
        true
    }

    fn add_identity(&mut self, a: f64) -> bool {
        self.entries.iter_mut().step_by(self.n + 1).for_each(|entry| *entry += a);
        true
    }

    /// `None` above [`MAX_SPECTRUM`] unknowns. Symmetric matrices have exactly real eigenvalues,
    /// with a mass matrix if that is positive definite to rounding. Allocates.
    ///
    /// Otherwise the kernel of the mass matrix is deflated, which leaves out the infinite eigenvalues of
    /// differential-algebraic systems of any index, and no others: how many there are follows from
    /// ranks, not from the size of eigenvalues. `None` also where the pencil is singular for every `λ`.
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
        finite_eigenvalues(a, mass.to_faer()?)
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
        finite_spectrum(a, mass.to_faer()?)
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
    // powers of two, so that nothing is rounded: masses of different units
    let scales: Vec<f64> = (0..n).map(|i| (-0.5 * m[(i, i)].log2()).round().exp2()).collect();
    if !scales.iter().all(|s| s.is_finite() && *s > 0.0) {
        return None;
    }
    let widest = scales.iter().fold(0.0, |m: f64, s| m.max(*s));
    if scales.iter().any(|s| *s < GRADED * widest) {
        return None; // a symmetric solver would lose the slow modes in the rounding of the fast ones
    }
    let scaled = |x: &Mat<f64>| Mat::from_fn(n, n, |i, j| scales[i] * x[(i, j)] * scales[j]);
    let (a, m) = (scaled(a), scaled(m));
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
