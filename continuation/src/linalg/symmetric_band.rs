//! Symmetric band matrix plus a rank-one term, `B + c v vᵀ`, factored with inertia.

use super::vector::{add_scaled, dot, dot_magnitude, max_abs, pivot_or_floor, sign, solve_refined};
use super::{Band, Facts, Matrix, OutsidePattern, ldlt};

/// Growth of the unpivoted elimination above which its factors are not used.
///
/// The backward error of the factors is about `ε · growth` relative to the largest entry, so the
/// inertia belongs to a matrix within 2e-10 of the given one and one refinement restores solutions.
pub const MAX_GROWTH: f64 = 1e6;

/// Part of the floor below which the floor of the band is not reduced when the rank-one term
/// dominates the norm.
const LEAST_FLOOR: f64 = 1e-32;

/// A Schur complement that lifts a replaced pivot by this factor has cured the singular band.
const CURE: f64 = 16.0;

/// `A = B + c v vᵀ`: a symmetric band `B` of half-bandwidth `kd` and an optional rank-one term.
///
/// **Band.** `B = L D Lᵀ` without pivoting; the signs of `D` give the inertia. If entries grow by
/// more than [`MAX_GROWTH`], the elimination is repeated from the last unknown to the first, and
/// if that grows too, solutions and the sign of the determinant come from a [`Band`] LU with
/// partial pivoting, whose storage is allocated the first time this happens; the inertia is then
/// reported only if the backward error of the better elimination is below the smallest eigenvalue
/// (estimated by inverse iteration) and its parity agrees with the LU.
///
/// **Rank-one term.** With `u = √|c| v`, `σ = sign c`, the system is bordered,
/// `[B u; uᵀ −σ] [x; y] = [f; 0]`, and solved by mixed block elimination (Govaerts & Pryce 1993),
/// accurate also where `B` is nearly singular and `A` is not. `c` may have any size; its sign may
/// be negative. With `δ = −σ − uᵀB⁻¹u`: `det A = −σ δ det B`, and `A` has
/// `neg(B) + [δ < 0] − [σ > 0]` negative eigenvalues.
///
/// A band that is singular to rounding, but cured by the rank-one term, counts as unperturbed.
#[derive(Debug, Clone)]
pub struct SymmetricBand {
    n: usize,
    kd: usize,
    /// Lower band by columns, `kd + 1` entries each; zero below the last row.
    entries: Vec<f64>,
    c: f64,
    v: Vec<f64>,
    /// `L` and `1/D` in the same layout, followed by `kd` zero columns.
    factors: Vec<f64>,
    method: Method,
    lu: Option<Box<Band>>,
    border: Option<Border>,
    u: Vec<f64>,
    w: Vec<f64>,
    padded: Vec<f64>,
    rhs: Vec<f64>,
    residual: Vec<f64>,
    band_norm: f64,
    refine: bool,
    misplaced: Option<OutsidePattern>,
}

/// Which factors of the band the solves use.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Method {
    Forward,
    Backward,
    Lu,
}

/// The factored border: `σ` and the Schur complement `δ`; `u` and `w = B⁻¹u` lie beside it.
#[derive(Debug, Clone, Copy)]
struct Border {
    sigma: f64,
    delta: f64,
}

impl SymmetricBand {
    /// A zero matrix of `n` rows with `half_bandwidth` diagonals on either side of the main one.
    pub fn new(n: usize, half_bandwidth: usize) -> Self {
        let width = half_bandwidth + 1;
        Self {
            n,
            kd: half_bandwidth,
            entries: vec![0.0; n * width],
            c: 0.0,
            v: vec![0.0; n],
            factors: vec![0.0; (n + half_bandwidth) * width],
            method: Method::Forward,
            lu: None,
            border: None,
            u: vec![0.0; n],
            w: vec![0.0; n],
            padded: vec![0.0; n + half_bandwidth],
            rhs: vec![0.0; n],
            residual: vec![0.0; n],
            band_norm: 0.0,
            refine: false,
            misplaced: None,
        }
    }

    /// Number of diagonals on either side of the main one.
    pub fn half_bandwidth(&self) -> usize {
        self.kd
    }

    /// Adds `value` to entry `(i, j)` of the band, `j <= i <= j + kd`, and to its mirror image. One
    /// outside this lower half is not written, and [`Matrix::misplaced`] then.
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        if i < self.n && j <= i && i <= j + self.kd {
            self.entries[j * (self.kd + 1) + i - j] += value;
        } else {
            self.misplaced = self.misplaced.or(Some(OutsidePattern { row: i, column: j }));
        }
    }

    /// Entries `(j, j), (j + 1, j), …` of the band, to be filled: `kd + 1` of them, fewer in the
    /// last columns.
    #[inline]
    pub fn column_mut(&mut self, j: usize) -> &mut [f64] {
        let (start, length) = (j * (self.kd + 1), (self.kd + 1).min(self.n - j));
        &mut self.entries[start..start + length]
    }

    /// Entry `(i, j)` of `B + c v vᵀ`, in either triangle.
    pub fn get(&self, i: usize, j: usize) -> f64 {
        let (i, j) = (i.max(j), i.min(j));
        let band = if i - j <= self.kd { self.entries[j * (self.kd + 1) + i - j] } else { 0.0 };
        if self.c == 0.0 { band } else { band + self.c * self.v[i] * self.v[j] }
    }

    /// Sets the rank-one term `c v vᵀ`; `c = 0` means none.
    pub fn set_rank_one(&mut self, c: f64, v: &[f64]) {
        self.c = c;
        self.v.copy_from_slice(v);
    }

    /// `c` and `v` of the rank-one term, to be set in place.
    pub fn rank_one_mut(&mut self) -> (&mut f64, &mut [f64]) {
        (&mut self.c, &mut self.v)
    }

    /// The rank-one term, if there is one.
    pub fn rank_one(&self) -> Option<(f64, &[f64])> {
        (self.c != 0.0).then_some((self.c, &self.v[..]))
    }

    /// Removes the rank-one term.
    pub fn clear_rank_one(&mut self) {
        self.c = 0.0;
    }

    /// Copies the band into the factors, from the last unknown to the first if `backward`.
    fn load(&mut self, backward: bool) {
        let (n, w) = (self.n, self.kd + 1);
        if !backward {
            let (head, tail) = self.factors.split_at_mut(n * w);
            head.copy_from_slice(&self.entries);
            tail.fill(0.0);
            return;
        }
        self.factors.fill(0.0);
        for j in 0..n {
            for k in 0..w.min(n - j) {
                self.factors[(n - 1 - j - k) * w + k] = self.entries[j * w + k];
            }
        }
    }

    /// Largest term of the elimination relative to the largest entry.
    fn growth(&self, pivots: ldlt::Pivots) -> f64 {
        if self.band_norm > 0.0 { pivots.largest / self.band_norm } else { 1.0 }
    }

    /// Factors the band alone.
    fn factor_band(&mut self, floor: f64) -> Facts {
        let mut best = (0, f64::INFINITY);
        for method in [Method::Forward, Method::Backward] {
            self.load(method == Method::Backward);
            let pivots = ldlt::factor(self.kd, &mut self.factors, self.n, floor);
            let growth = self.growth(pivots);
            if growth <= MAX_GROWTH {
                self.method = method;
                return Facts {
                    det_sign: Some(parity(pivots.negative)),
                    inertia: Some((pivots.negative, self.n - pivots.negative)),
                    growth,
                    perturbed: pivots.perturbed,
                };
            }
            if growth < best.1 {
                best = (pivots.negative, growth);
            }
        }
        self.method = Method::Lu;
        let (n, kd) = (self.n, self.kd);
        let mut lu = self.lu.take().unwrap_or_else(|| Box::new(Band::new(n, kd, kd)));
        for j in 0..n {
            for k in 0..(kd + 1).min(n - j) {
                let value = self.entries[j * (kd + 1) + k];
                lu.set(j + k, j, value);
                lu.set(j, j + k, value);
            }
        }
        let mut facts = lu.factor(floor);
        let (negative, growth) = best;
        let backward_error = (kd + 1) as f64 * f64::EPSILON * growth * self.band_norm;
        let trusted = facts.perturbed == 0
            && facts.det_sign == Some(parity(negative))
            && backward_error < 0.1 * self.smallest_eigenvalue(&lu);
        facts.inertia = trusted.then_some((negative, n - negative));
        self.lu = Some(lu);
        facts
    }

    /// Estimate, from above, of the smallest eigenvalue of the band in magnitude.
    fn smallest_eigenvalue(&mut self, lu: &Band) -> f64 {
        let x = &mut self.rhs;
        for (i, x) in x.iter_mut().enumerate() {
            *x = 1.0 + ((i * 7919) % 1009) as f64 / 1009.0; // no symmetry, nothing special
        }
        let mut estimate = f64::INFINITY;
        for _ in 0..3 {
            let before = dot(x, x).sqrt();
            lu.substitute(x);
            let after = dot(x, x).sqrt();
            estimate = before / after;
            x.iter_mut().for_each(|x| *x /= after);
        }
        estimate
    }

    /// `x ← B⁻¹ x` with the factors of the band.
    fn substitute_band(&self, x: &mut [f64], padded: &mut [f64]) {
        let (head, tail) = padded.split_at_mut(self.n);
        match (self.method, &self.lu) {
            (Method::Lu, Some(lu)) => lu.substitute(x),
            (Method::Backward, _) => {
                head.iter_mut().zip(x.iter().rev()).for_each(|(p, x)| *p = *x);
                tail.fill(0.0);
                ldlt::solve(self.kd, &self.factors, self.n, padded);
                x.iter_mut().rev().zip(padded.iter()).for_each(|(x, p)| *x = *p);
            }
            _ => {
                head.copy_from_slice(x);
                tail.fill(0.0);
                ldlt::solve(self.kd, &self.factors, self.n, padded);
                x.copy_from_slice(&padded[..self.n]);
            }
        }
    }

    /// `x ← (B + c v vᵀ)⁻¹ x` by mixed block elimination, no refinement.
    fn substitute(&self, x: &mut [f64], padded: &mut [f64]) {
        let Some(Border { sigma, delta }) = self.border else {
            self.substitute_band(x, padded);
            return;
        };
        let y = -dot(&self.w, x) / delta;
        add_scaled(x, -y, &self.u);
        self.substitute_band(x, padded);
        let dy = (sigma * y - dot(&self.u, x)) / delta;
        add_scaled(x, -dy, &self.w);
    }

    /// Prepares the border of the rank-one term and corrects what is known of the band by it.
    fn factor_border(&mut self, mut facts: Facts) -> Facts {
        let (sigma, root) = (self.c.signum(), self.c.abs().sqrt());
        for (u, v) in self.u.iter_mut().zip(&self.v) {
            *u = root * v;
        }
        let mut w = std::mem::take(&mut self.w);
        let mut padded = std::mem::take(&mut self.padded);
        w.copy_from_slice(&self.u);
        self.substitute_band(&mut w, &mut padded);
        let scale = 1.0 + dot_magnitude(&self.u, &w);
        let (delta, singular) = pivot_or_floor(-sigma - dot(&self.u, &w), f64::EPSILON * scale);
        self.w = w;
        self.padded = padded;
        self.border = Some(Border { sigma, delta });
        if delta.abs() > CURE {
            facts.perturbed = facts.perturbed.saturating_sub(1);
        }
        facts.perturbed += usize::from(singular);
        facts.det_sign = facts.det_sign.map(|s| s * sign(-sigma * delta));
        facts.inertia = facts.inertia.and_then(|(negative, _)| {
            let total = negative + usize::from(delta < 0.0);
            let negative = total.checked_sub(usize::from(sigma > 0.0))?;
            Some((negative, self.n.checked_sub(negative)?))
        });
        facts
    }
}

fn parity(negative: usize) -> i8 {
    if negative.is_multiple_of(2) { 1 } else { -1 }
}

impl Matrix for SymmetricBand {
    fn dim(&self) -> usize {
        self.n
    }

    /// Sets the band to zero and removes the rank-one term.
    fn set_zero(&mut self) {
        self.entries.fill(0.0);
        self.c = 0.0;
        self.misplaced = None;
    }

    fn misplaced(&self) -> Option<OutsidePattern> {
        self.misplaced
    }

    fn mul(&self, x: &[f64], y: &mut [f64]) {
        ldlt::mul(self.kd, &self.entries, x, y);
        if self.c != 0.0 {
            add_scaled(y, self.c * dot(&self.v, x), &self.v);
        }
    }

    fn mul_transpose(&self, x: &[f64], y: &mut [f64]) {
        self.mul(x, y);
    }

    /// Adds the bands, and the coefficients of the rank-one terms.
    ///
    /// If both matrices have a rank-one term it must be with the same `v`: the sum of two
    /// different ones has rank two. If only `other` has one, its `v` is copied.
    fn axpy(&mut self, a: f64, other: &Self) {
        debug_assert_eq!((self.n, self.kd), (other.n, other.kd), "different patterns");
        add_scaled(&mut self.entries, a, &other.entries);
        if let Some((c, v)) = other.rank_one() {
            debug_assert!(self.c == 0.0 || self.v == v, "rank-one terms with different vectors");
            if self.c == 0.0 {
                self.v.copy_from_slice(v);
            }
            self.c += a * c;
        }
    }

    /// Largest entry of the band plus that of the rank-one term.
    fn norm(&self) -> f64 {
        let band = max_abs(&self.entries);
        if self.c == 0.0 { band } else { band + self.c.abs() * max_abs(&self.v).powi(2) }
    }

    fn factor(&mut self, floor: f64) -> Facts {
        self.band_norm = max_abs(&self.entries);
        let norm = self.norm();
        // The floor is meant relative to the whole; the pivots are those of the band.
        let part = if norm > 0.0 { (self.band_norm / norm).max(LEAST_FLOOR) } else { 1.0 };
        let mut facts = self.factor_band((floor * part).max(f64::MIN_POSITIVE));
        self.border = None;
        if self.c != 0.0 {
            facts = self.factor_border(facts);
        }
        self.refine = facts.perturbed == 0;
        facts
    }

    fn solve(&mut self, x: &mut [f64]) {
        let mut rhs = std::mem::take(&mut self.rhs);
        let mut residual = std::mem::take(&mut self.residual);
        let mut padded = std::mem::take(&mut self.padded);
        let this = &*self;
        let multiply = |x: &[f64], y: &mut [f64]| {
            this.mul(x, y);
            let band = this.band_norm * max_abs(x);
            if this.c == 0.0 {
                return band;
            }
            band + this.c.abs() * max_abs(&this.v) * dot_magnitude(&this.v, x)
        };
        let substitute = |x: &mut [f64]| this.substitute(x, &mut padded);
        solve_refined(x, &mut rhs, &mut residual, this.refine, substitute, multiply);
        self.rhs = rhs;
        self.residual = residual;
        self.padded = padded;
    }

    fn solve_transpose(&mut self, x: &mut [f64]) {
        self.solve(x);
    }

    fn add_identity(&mut self, a: f64) -> bool {
        for j in 0..self.n {
            self.add(j, j, a);
        }
        true
    }
}
