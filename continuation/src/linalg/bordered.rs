//! Bordered systems by mixed block elimination.

use super::complement::Complement;
use super::vector::{ROUNDING, add_scaled, dot, dot_magnitude, max_abs, pivot_or_floor, sign};
use super::{Dense, Facts, Matrix};

/// Floor of the core's pivots relative to `|b| |c|`; for a core that is exactly zero (the scalar
/// cusp at its fold) it is `ε` instead.
///
/// The replaced pivot is made irrelevant by mixed elimination. The floor is far below rounding
/// because `|b| |c|` does not scale as `A` does, and only guards against overflow: a core that is
/// small beside its borders is not singular.
const BORDER_FLOOR: f64 = 1e-40;

/// Growth `|A| |x| / |b|` of a solution with a core and its first borders, above which that matrix
/// is singular to working precision, the core then at least twice.
const SINGULAR: f64 = 1e11;

/// A Schur complement larger than usual by this factor has cured a singular core.
const CURE: f64 = 1e4;

/// Floor, in roundings, of the last Schur complement of a matrix that is a core itself: well above
/// the error of the residual by which mixed elimination corrects the border's unknown, so that the
/// sign of the solutions is that of the factors.
const NOISE: f64 = 64.0;

/// Largest dimension, borders included, up to which the sign of a determinant that the Schur
/// complements do not tell is that of a dense copy: milliseconds.
const MAX_DENSE: usize = 200;
/// Sweeps in which the scales of its borders are found.
const SWEEPS: usize = 3;

/// What the factorisation of a bordered matrix learned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BorderedFacts {
    /// The factorisation of the core `A`.
    pub core: Facts,
    /// Schur complement of the last border, `d − cᵀA⁻¹b` for a single one; 1 without borders.
    pub schur: f64,
    /// Sign of the determinant of the whole bordered matrix; right also where the core is
    /// singular. `None` if the bordered matrix is singular to rounding; beyond 200 unknowns also if
    /// the core does not know the sign of its factors, or if it is singular and the borders before the
    /// last one do not cure that: the solutions are accurate then, but the signs of the single Schur complements are rounding.
    pub det_sign: Option<i8>,
    /// Numbers of (negative, positive) eigenvalues of the whole matrix, if it is symmetric and the
    /// core reports its own; `None` also where the sign of the determinant is unknown.
    pub inertia: Option<(usize, usize)>,
    /// Number of Schur complements that vanished to rounding and were replaced.
    pub perturbed: usize,
}

/// Solver for `[A B; Cᵀ D] [x; y] = [f; g]` with a core `A` of dimension `n` and `m` borders.
///
/// Mixed block elimination (Govaerts & Pryce 1993), applied to one border after the other: one
/// solve with `Aᵀ` and one with `A` per border to prepare, one solve with `A` per system. The
/// error is that of a stable solver of the bordered matrix even where `A` is singular, with one
/// border per rank defect. The method is invariant under scaling of the core and of each border.
#[derive(Debug, Clone)]
pub struct Bordered {
    n: usize,
    m: usize,
    b: Vec<f64>,
    c: Vec<f64>,
    d: Vec<f64>,
    /// Column `k`: solution of the core with the first `k` borders for column `k` of the border.
    w: Vec<f64>,
    /// The same for the transposed matrix and row `k`.
    v: Vec<f64>,
    delta: Vec<f64>,
    delta_transposed: Vec<f64>,
    y: Vec<f64>,
    rhs: Vec<f64>,
    residual: Vec<f64>,
    trial: Vec<f64>,
    core_norm: f64,
    /// Copy with which to solve where the Schur complements say nothing, the scales of its last rows and
    /// columns, and whether it is regular.
    dense: Option<Box<Dense>>,
    dense_scales: [Vec<f64>; 2],
    dense_solves: bool,
    complement: Complement,
}

impl Bordered {
    /// Storage for a core of dimension `n` and `m` borders, all zero.
    pub fn new(n: usize, m: usize) -> Self {
        Self {
            n,
            m,
            b: vec![0.0; n * m],
            c: vec![0.0; n * m],
            d: vec![0.0; m * m],
            w: vec![0.0; (n + m) * m],
            v: vec![0.0; (n + m) * m],
            delta: vec![1.0; m],
            delta_transposed: vec![1.0; m],
            y: vec![0.0; m],
            rhs: vec![0.0; n + m],
            residual: vec![0.0; n + m],
            trial: vec![0.0; n + m],
            core_norm: 0.0,
            dense: None,
            dense_scales: [vec![1.0; m], vec![1.0; m]],
            dense_solves: false,
            complement: Complement::new(m),
        }
    }

    /// Dimension of the core and number of borders.
    pub fn dims(&self) -> (usize, usize) {
        (self.n, self.m)
    }

    /// Column `k` of `B`, to be filled.
    pub fn column_mut(&mut self, k: usize) -> &mut [f64] {
        &mut self.b[k * self.n..(k + 1) * self.n]
    }

    /// Column `k` of `C`, row `k` of the lower border, to be filled.
    pub fn row_mut(&mut self, k: usize) -> &mut [f64] {
        &mut self.c[k * self.n..(k + 1) * self.n]
    }

    /// Sets entry `(i, k)` of the corner `D`.
    pub fn set_corner(&mut self, i: usize, k: usize, value: f64) {
        self.d[i + k * self.m] = value;
    }

    /// The core's part of the solution for column `k` alone, with the first `k` borders:
    /// `A⁻¹ b` for the first one. Valid after [`Bordered::factor`], not refined.
    pub fn core_column_solution(&self, k: usize) -> &[f64] {
        &self.w[k * (self.n + self.m)..][..self.n]
    }

    /// The same for the transposed matrix: `A⁻ᵀ c` for the first row.
    pub fn core_row_solution(&self, k: usize) -> &[f64] {
        &self.v[k * (self.n + self.m)..][..self.n]
    }

    /// Factors the core and prepares the borders. To be repeated when either changes.
    pub fn factor<A: Matrix>(&mut self, a: &mut A) -> BorderedFacts {
        let (mut facts, last_replaced) = self.factor_parts(a, 0.0, 1.0);
        if last_replaced {
            (facts.det_sign, facts.inertia) = (None, None);
        }
        let core = facts.core;
        facts.det_sign = facts.det_sign.or_else(|| self.other_sign(a, &core));
        facts
    }

    /// Sign of the determinant where the Schur complements of one border after the other do not tell.
    fn other_sign<A: Matrix>(&mut self, a: &mut A, core: &Facts) -> Option<i8> {
        self.dense_sign(a).or_else(|| self.complement_sign(a, core))
    }

    /// Sign of the determinant from that of a regular core and the Schur complement of all borders at
    /// once, whose rows may be taken in any order: `None` where the core is singular, or nearly.
    fn complement_sign<A: Matrix>(&mut self, a: &mut A, core: &Facts) -> Option<i8> {
        let n = self.n;
        let sign = core.det_sign.filter(|_| core.perturbed == 0 && self.m > 1)?;
        let mut x = std::mem::take(&mut self.trial);
        let mut sizes = std::mem::take(&mut self.y);
        // `cᵀ A⁻¹ δA A⁻¹ b`, by which the rounding `δA` of the factors may change an entry
        for (k, size) in sizes.iter_mut().enumerate() {
            x[..n].copy_from_slice(self.row(k));
            a.solve_transpose(&mut x[..n]);
            *size = x[..n].iter().map(|x| x.abs()).sum();
        }
        for k in 0..self.m {
            x[..n].copy_from_slice(self.column(k));
            a.solve(&mut x[..n]);
            let largest = self.core_norm * max_abs(&x[..n]);
            for (i, size) in sizes.iter().enumerate() {
                let d = self.corner(i, k, false);
                let value = d - dot(self.row(i), &x[..n]);
                let terms = d.abs() + dot_magnitude(self.row(i), &x[..n]);
                self.complement.set(i, k, value, NOISE * f64::EPSILON * (terms + size * largest));
            }
        }
        (self.trial, self.y) = (x, sizes);
        self.complement.det_sign().map(|complement| sign * complement)
    }

    /// Sign of the determinant of a small matrix from a dense copy, rows and columns of the borders
    /// scaled as the core; `None` if that is singular to rounding.
    fn dense_sign<A: Matrix>(&mut self, a: &A) -> Option<i8> {
        let (n, size) = (self.n, self.n + self.m);
        if size > MAX_DENSE || self.m == 0 {
            return None;
        }
        let mut copy = self.dense.take().unwrap_or_else(|| Box::new(Dense::new(size)));
        copy.set_zero();
        let unit = if self.core_norm > 0.0 { self.core_norm } else { 1.0 };
        self.trial[..n].fill(0.0);
        for j in 0..n {
            self.trial[j] = 1.0;
            a.mul(&self.trial[..n], &mut copy.column_mut(j)[..n]);
            self.trial[j] = 0.0;
        }
        // entries no larger than the core's, in the corner too: a column may be nothing else, where a
        // parameter acts on nothing, and a row where nothing moves
        self.dense_scales[1].fill(1.0);
        for sweep in 0..2 * SWEEPS {
            for k in 0..self.m {
                let by_row = sweep % 2 == 0;
                let [rows, columns] = &self.dense_scales;
                let (own, others) =
                    if by_row { (self.row(k), columns) } else { (self.column(k), rows) };
                let corner = |(i, scale): (usize, &f64)| {
                    let (row, column) = if by_row { (k, i) } else { (i, k) };
                    (self.corner(row, column, false) * scale).abs()
                };
                let largest = others.iter().enumerate().map(corner).fold(max_abs(own), f64::max);
                let scale = if largest > 0.0 { unit / largest } else { 1.0 };
                self.dense_scales[usize::from(!by_row)][k] = scale;
            }
        }
        for k in 0..self.m {
            let (by_row, by_column) = (self.dense_scales[0][k], self.dense_scales[1][k]);
            for i in 0..n {
                copy.set(i, n + k, by_column * self.column(k)[i]);
                copy.set(n + k, i, by_row * self.row(k)[i]);
            }
            for i in 0..self.m {
                let scaled = self.dense_scales[0][i] * by_column;
                copy.set(n + i, n + k, scaled * self.corner(i, k, false));
            }
        }
        let floor = 16.0 * size as f64 * f64::EPSILON * copy.norm();
        let facts = copy.factor(floor);
        self.dense = Some(copy);
        self.dense_solves = facts.perturbed == 0;
        facts.det_sign.filter(|_| self.dense_solves)
    }

    /// Solves with the dense copy.
    fn solve_dense(&mut self, f: &mut [f64], g: &mut [f64], transposed: bool) {
        let Some(copy) = &mut self.dense else { return };
        let [rows, columns] = &self.dense_scales;
        let (before, after) = if transposed { (columns, rows) } else { (rows, columns) };
        let (x, y) = self.trial.split_at_mut(self.n);
        x.copy_from_slice(f);
        y.iter_mut().zip(&*g).zip(before).for_each(|((y, g), scale)| *y = scale * g);
        if transposed {
            copy.solve_transpose(&mut self.trial);
        } else {
            copy.solve(&mut self.trial);
        }
        let (x, y) = self.trial.split_at(self.n);
        f.copy_from_slice(x);
        g.iter_mut().zip(y).zip(after).for_each(|((g, y), scale)| *g = scale * y);
    }

    /// Factors for use as a core: the facts are those of the factors, also where the last Schur
    /// complement vanishes. `floor` is that of a core which is zero, as are its borders.
    pub(super) fn factor_as_core<A: Matrix>(&mut self, a: &mut A, floor: f64) -> Facts {
        let (mut facts, _) = self.factor_parts(a, floor, NOISE);
        let known = facts.det_sign.is_some();
        let mut cured = 0;
        for k in 0..self.m {
            let borders = max_abs(self.column(k)) * max_abs(self.row(k));
            let borders = if self.core_norm > 0.0 { borders / self.core_norm } else { 1.0 };
            let usual = self.corner(k, k, false).abs() + borders;
            cured += usize::from(self.delta[k].abs() > CURE * usual);
        }
        let mut perturbed = facts.perturbed + facts.core.perturbed.saturating_sub(cured);
        if let (Some(delta), Some(other)) = (self.delta.last(), self.delta_transposed.last_mut()) {
            // equal but for rounding; where they are nothing else, the sign must be the same
            if (*delta - *other).abs() > 0.5 * delta.abs() {
                *other = *delta;
                perturbed = perturbed.max(1);
            }
        }
        if !known {
            // a regular matrix all the same, if the copy says so
            let core = facts.core;
            facts.det_sign = self.other_sign(a, &core);
            perturbed = if facts.det_sign.is_some() { 0 } else { perturbed };
        }
        Facts {
            det_sign: facts.det_sign,
            inertia: facts.inertia,
            growth: facts.core.growth,
            perturbed,
        }
    }

    /// Also returns whether the last Schur complement vanished and was replaced.
    fn factor_parts<A: Matrix>(
        &mut self,
        a: &mut A,
        zero_floor: f64,
        last_noise: f64,
    ) -> (BorderedFacts, bool) {
        let (n, m) = (self.n, self.m);
        self.dense_solves = false;
        self.core_norm = a.norm();
        let mut floor = f64::EPSILON * self.core_norm;
        for k in 0..m {
            let size = max_abs(self.column(k)) * max_abs(self.row(k));
            let part = if self.core_norm > 0.0 { BORDER_FLOOR } else { f64::EPSILON };
            floor = floor.max(part * size);
        }
        let core = a.factor(if floor > 0.0 { floor } else { zero_floor });
        let mut last_replaced = false;
        let mut facts = BorderedFacts {
            core,
            schur: 1.0,
            det_sign: core.det_sign,
            inertia: core.inertia.filter(|_| self.is_symmetric()),
            perturbed: 0,
        };
        let mut unknown = core.perturbed > m.min(1);
        for k in 0..m {
            for transposed in [false, true] {
                let mut z = std::mem::take(&mut self.trial);
                let mut y = std::mem::take(&mut self.y);
                z[..n].copy_from_slice(if transposed { self.row(k) } else { self.column(k) });
                for i in 0..k {
                    z[n + i] = self.corner(i, k, transposed);
                }
                self.eliminate(a, k, &mut z, &mut y, transposed);
                let solution = if transposed { &mut self.v } else { &mut self.w };
                solution[k * (n + m)..][..n + k].copy_from_slice(&z[..n + k]);
                let noise = if k + 1 == m { last_noise } else { 1.0 };
                let (delta, replaced) = self.schur(k, &z, transposed, noise);
                if transposed {
                    self.delta_transposed[k] = delta;
                } else {
                    self.delta[k] = delta;
                    facts.perturbed += usize::from(replaced);
                    facts.schur = delta;
                    let growth = self.core_norm * max_abs(&z[..n]);
                    unknown |= k > 0 && growth > SINGULAR * self.right_side(k);
                    last_replaced = replaced;
                    facts.inertia = facts.inertia.map(|(negative, positive)| {
                        if delta < 0.0 {
                            (negative + 1, positive)
                        } else {
                            (negative, positive + 1)
                        }
                    });
                }
                self.trial = z;
                self.y = y;
            }
        }
        let signs = self.delta.iter().fold(1, |s, delta| s * sign(*delta));
        facts.det_sign = facts.det_sign.filter(|_| !unknown).map(|s| s * signs);
        facts.inertia = facts.inertia.filter(|_| !unknown);
        (facts, last_replaced)
    }

    /// Solves in place: `f` becomes `x`, `g` becomes `y`. Refined once if the residual asks for it.
    pub fn solve<A: Matrix>(&mut self, a: &mut A, f: &mut [f64], g: &mut [f64]) {
        self.solve_with(a, f, g, false, true);
    }

    /// Solves with the transposed bordered matrix, `[Aᵀ C; Bᵀ Dᵀ] [x; y] = [f; g]`.
    pub fn solve_transpose<A: Matrix>(&mut self, a: &mut A, f: &mut [f64], g: &mut [f64]) {
        self.solve_with(a, f, g, true, true);
    }

    /// Largest entry of the core that was factored last.
    pub(crate) fn core_norm(&self) -> f64 {
        self.core_norm
    }

    /// Column `k` of `B`.
    pub fn column(&self, k: usize) -> &[f64] {
        &self.b[k * self.n..(k + 1) * self.n]
    }

    /// Column `k` of `C`, row `k` of the lower border.
    pub fn row(&self, k: usize) -> &[f64] {
        &self.c[k * self.n..(k + 1) * self.n]
    }

    /// Entry `(i, k)` of `D`, or of its transpose.
    pub(super) fn corner(&self, i: usize, k: usize, transposed: bool) -> f64 {
        if transposed { self.d[k + i * self.m] } else { self.d[i + k * self.m] }
    }

    /// All entries of the borders: those of `B`, `C` and `D`, each by columns.
    pub(super) fn entries(&self) -> [&[f64]; 3] {
        [&self.b, &self.c, &self.d]
    }

    pub(super) fn entries_mut(&mut self) -> [&mut [f64]; 3] {
        [&mut self.b, &mut self.c, &mut self.d]
    }

    /// Size of column `k` as a right-hand side of the core with the borders before it: its entries
    /// in their rows count as what the core makes of the state that they ask for.
    fn right_side(&self, k: usize) -> f64 {
        let mut size = max_abs(self.column(k));
        for i in 0..k {
            let row = max_abs(self.row(i));
            if row > 0.0 {
                size = size.max(self.core_norm * self.corner(i, k, false).abs() / row);
            }
        }
        size
    }

    fn is_symmetric(&self) -> bool {
        self.b == self.c
            && (0..self.m)
                .all(|k| (0..k).all(|i| self.corner(i, k, false) == self.corner(k, i, false)))
    }

    /// `d − cᵀz` of border `k` over the core with the first `k` borders, not smaller than `noise`
    /// times the rounding of a term.
    fn schur(&self, k: usize, z: &[f64], transposed: bool, noise: f64) -> (f64, bool) {
        let row = if transposed { self.column(k) } else { self.row(k) };
        let x = &z[..self.n];
        let d = self.corner(k, k, transposed);
        let mut value = d - dot(row, x);
        let mut scale = d.abs() + dot_magnitude(row, x);
        for i in 0..k {
            let term = self.corner(k, i, transposed) * z[self.n + i];
            value -= term;
            scale += term.abs();
        }
        if scale == 0.0 {
            // nothing but zeros so far: what the borders to come have in this row and column
            let entries = (0..self.m).flat_map(|i| [(i, k), (k, i)]);
            scale = entries.map(|(i, j)| self.corner(i, j, false).abs()).fold(0.0, f64::max);
        }
        pivot_or_floor(value, if scale > 0.0 { noise * f64::EPSILON * scale } else { 1.0 })
    }

    /// Solves with the core and the first `borders` borders; `z` holds `n + borders` unknowns.
    fn eliminate<A: Matrix>(
        &self,
        a: &mut A,
        borders: usize,
        z: &mut [f64],
        y: &mut [f64],
        transposed: bool,
    ) {
        let (n, ld) = (self.n, self.n + self.m);
        let (delta, delta_other, w, v) = if transposed {
            (&self.delta_transposed, &self.delta, &self.v, &self.w)
        } else {
            (&self.delta, &self.delta_transposed, &self.w, &self.v)
        };
        let (f, g) = z.split_at_mut(n);
        for k in (0..borders).rev() {
            let v = &v[k * ld..][..n + k];
            let column = if transposed { self.row(k) } else { self.column(k) };
            y[k] = (g[k] - dot(&v[..n], f) - dot(&v[n..], &g[..k])) / delta_other[k];
            add_scaled(f, -y[k], column);
            for i in 0..=k {
                g[i] -= self.corner(i, k, transposed) * y[k];
            }
        }
        if transposed {
            a.solve_transpose(f)
        } else {
            a.solve(f)
        }
        for k in 0..borders {
            let w = &w[k * ld..][..n + k];
            let row = if transposed { self.column(k) } else { self.row(k) };
            let mut rest = g[k] - dot(row, f);
            for i in 0..k {
                rest -= self.corner(k, i, transposed) * g[i];
            }
            let correction = rest / delta[k];
            add_scaled(f, -correction, &w[..n]);
            add_scaled(&mut g[..k], -correction, &w[n..]);
            g[k] = y[k] + correction;
        }
    }

    /// `residual = rhs − M z`; true if both parts are rounding.
    fn residual<A: Matrix>(
        &self,
        a: &A,
        z: &[f64],
        rhs: &[f64],
        residual: &mut [f64],
        transposed: bool,
    ) -> bool {
        let (x, y) = z.split_at(self.n);
        let (f, g) = rhs.split_at(self.n);
        let (r, s) = residual.split_at_mut(self.n);
        if transposed {
            a.mul_transpose(x, r)
        } else {
            a.mul(x, r)
        }
        for (r, f) in r.iter_mut().zip(f) {
            *r = f - *r;
        }
        let mut scale = self.core_norm * max_abs(x) + max_abs(f);
        let mut small = true;
        for k in 0..self.m {
            let (column, row) = if transposed {
                (self.row(k), self.column(k))
            } else {
                (self.column(k), self.row(k))
            };
            add_scaled(r, -y[k], column);
            scale += max_abs(column) * y[k].abs();
            s[k] = g[k] - dot(row, x);
            let mut scale = g[k].abs() + dot_magnitude(row, x);
            for i in 0..self.m {
                let term = self.corner(k, i, transposed) * y[i];
                s[k] -= term;
                scale += term.abs();
            }
            small &= s[k].abs() <= ROUNDING * scale;
        }
        small && max_abs(r) <= ROUNDING * scale
    }

    pub(super) fn solve_with<A: Matrix>(
        &mut self,
        a: &mut A,
        f: &mut [f64],
        g: &mut [f64],
        transposed: bool,
        refine: bool,
    ) {
        if self.dense_solves {
            return self.solve_dense(f, g, transposed);
        }
        let n = self.n;
        let mut rhs = std::mem::take(&mut self.rhs);
        let mut z = std::mem::take(&mut self.trial);
        let mut residual = std::mem::take(&mut self.residual);
        let mut y = std::mem::take(&mut self.y);
        rhs[..n].copy_from_slice(f);
        rhs[n..].copy_from_slice(g);
        z.copy_from_slice(&rhs);
        self.eliminate(a, self.m, &mut z, &mut y, transposed);
        if refine && !self.residual(a, &z, &rhs, &mut residual, transposed) {
            self.eliminate(a, self.m, &mut residual, &mut y, transposed);
            // A correction as large as the solution, in both parts, is noise of a singular matrix.
            let (dx, dy) = residual.split_at(n);
            if max_abs(dx) <= 0.5 * max_abs(&z[..n]) || max_abs(dy) <= 0.5 * max_abs(&z[n..]) {
                add_scaled(&mut z, 1.0, &residual);
            }
        }
        f.copy_from_slice(&z[..n]);
        g.copy_from_slice(&z[n..]);
        self.rhs = rhs;
        self.trial = z;
        self.residual = residual;
        self.y = y;
    }
}
