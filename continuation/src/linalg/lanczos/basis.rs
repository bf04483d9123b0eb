//! The Krylov basis of [`Lanczos`]: storage, steps, restarts.

use super::Lanczos;
use crate::linalg::small_symmetric::SmallSymmetric;
use crate::linalg::vector::{add_scaled, dot};

/// Passes of Gram-Schmidt after which a vector counts as dependent.
const PASSES: usize = 5;
/// Basis vectors beyond the wanted ones.
const ROOM: usize = 30;
/// Coordinates that are rotated at a time in a restart.
const CHUNK: usize = 64;

impl Lanczos {
    pub(super) fn reserve(&mut self, wanted: usize) {
        if wanted <= self.room && self.capacity > 0 {
            return;
        }
        self.room = wanted;
        let capacity = (2 * wanted + ROOM).min(self.n);
        let n = self.n;
        self.capacity = capacity;
        self.basis = vec![0.0; (capacity + 1) * n];
        self.mass_basis = vec![0.0; (capacity + 1) * n];
        self.t = vec![0.0; capacity * capacity];
        self.lost = Vec::with_capacity(4 * capacity);
        self.small = SmallSymmetric::new(capacity);
        self.ranking = Vec::with_capacity(capacity);
        self.rotated = vec![0.0; capacity * CHUNK];
        for list in [&mut self.values, &mut self.errors] {
            *list = Vec::with_capacity(wanted);
        }
        self.converged = Vec::with_capacity(wanted);
        self.order = Vec::with_capacity(wanted);
        self.vectors = vec![0.0; wanted * n];
    }

    /// Applies the operator to the next vector, which gives a column of the projected matrix and
    /// the vector after it; false if there is none, the space being invariant.
    pub(super) fn expand(
        &mut self,
        mass: &mut impl FnMut(&[f64], &mut [f64]),
        solve: &mut impl FnMut(&mut [f64]),
    ) -> bool {
        let (n, j, ld) = (self.n, self.m, self.capacity);
        self.w.copy_from_slice(&self.mass_basis[j * n..(j + 1) * n]);
        solve(&mut self.w);
        self.solves += 1;
        self.t[j * ld..][..=j].fill(0.0);
        self.m += 1;
        let rest = self.append(true, mass);
        self.beta = rest.unwrap_or(0.0);
        for i in 0..j {
            self.t[j + i * ld] = self.t[i + j * ld];
        }
        self.chained = rest.is_some();
        self.chained
    }

    /// Orthogonalises `w` against the basis and appends it; its norm before normalisation, `None`
    /// if nothing is left of it. The coefficients go into the last column if it is `open`.
    pub(super) fn append(
        &mut self,
        open: bool,
        mass: &mut impl FnMut(&[f64], &mut [f64]),
    ) -> Option<f64> {
        let (n, m, ld) = (self.n, self.m, self.capacity);
        let mut first = if open && self.chained { m.saturating_sub(2) } else { 0 };
        for _ in 0..=PASSES {
            let mut removed = 0.0;
            for i in first..m {
                let h = dot(&self.mass_basis[i * n..(i + 1) * n], &self.w);
                add_scaled(&mut self.w, -h, &self.basis[i * n..(i + 1) * n]);
                removed += h * h;
                if open {
                    self.t[i + (m - 1) * ld] += h;
                }
            }
            if first > 0 {
                first = 0; // the bulk is gone, now all of them
                continue;
            }
            mass(&self.w, &mut self.u);
            let square = dot(&self.w, &self.u);
            if !(square > 0.0 && square.is_finite()) || m == self.n {
                return None;
            }
            if square >= removed {
                let norm = square.sqrt();
                let (v, mv) = (&mut self.basis[m * n..], &mut self.mass_basis[m * n..]);
                for i in 0..n {
                    v[i] = self.w[i] / norm;
                    mv[i] = self.u[i] / norm;
                }
                return Some(norm);
            }
        }
        None
    }

    /// Makes a random vector the next one; false if the basis spans the whole space already.
    pub(super) fn append_random(&mut self, mass: &mut impl FnMut(&[f64], &mut [f64])) -> bool {
        self.noise.fill(&mut self.w);
        self.chained = false;
        self.m < self.n && self.append(false, mass).is_some()
    }

    /// Replaces the basis by the first `keep` Ritz vectors. The next vector stays the next one,
    /// unless it is to be replaced.
    pub(super) fn restart(&mut self, keep: usize, stays: bool) {
        let (n, m, ld) = (self.n, self.m, self.capacity);
        let keep = keep.min(m);
        for vectors in [&mut self.basis, &mut self.mass_basis] {
            for from in (0..n).step_by(CHUNK) {
                let width = CHUNK.min(n - from);
                for (r, &i) in self.ranking[..keep].iter().enumerate() {
                    let target = &mut self.rotated[r * CHUNK..][..width];
                    target.fill(0.0);
                    for j in 0..m {
                        let v = &vectors[j * n + from..][..width];
                        add_scaled(target, self.small.component(i, j), v);
                    }
                }
                for r in 0..keep {
                    vectors[r * n + from..][..width]
                        .copy_from_slice(&self.rotated[r * CHUNK..][..width]);
                }
            }
            vectors.copy_within(m * n..(m + 1) * n, keep * n);
        }
        if self.chained && !stays {
            let row = self.lost.len();
            self.lost.resize(row + ld, 0.0);
            self.lost[row + m - 1] = self.beta;
        }
        for row in self.lost.chunks_exact_mut(ld) {
            for (w, &i) in self.w.iter_mut().zip(&self.ranking[..keep]) {
                *w = (0..m).map(|j| row[j] * self.small.component(i, j)).sum();
            }
            row.fill(0.0);
            row[..keep].copy_from_slice(&self.w[..keep]);
        }
        for r in 0..keep {
            self.t[r * ld..][..keep].fill(0.0);
            self.t[r * (ld + 1)] = self.small.value(self.ranking[r]);
        }
        (self.m, self.beta) = (keep, 0.0);
        self.chained = false; // to all of them, not to the last alone
    }
}
