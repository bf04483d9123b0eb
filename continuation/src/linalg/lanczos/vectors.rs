//! Eigenvectors, eigenvalues and their errors from the basis of [`Lanczos`].

use super::{Lanczos, Wanted};
use crate::linalg::vector::{add_scaled, dot};

impl Lanczos {
    /// Eigenvectors, improved by one inverse iteration, eigenvalues and their errors.
    pub(super) fn finish(
        &mut self,
        wanted: Wanted,
        shift: f64,
        mass: &mut impl FnMut(&[f64], &mut [f64]),
        solve: &mut impl FnMut(&mut [f64]),
    ) {
        let n = self.n;
        for list in [&mut self.values, &mut self.errors] {
            list.clear();
        }
        self.converged.clear();
        self.order.clear();
        if self.m == 0 || !self.small.decompose(&self.t, self.capacity, 0, self.m) {
            return;
        }
        let found = self.rank(wanted).min(self.room);
        let small = &self.small;
        self.ranking[..found]
            .sort_unstable_by(|&i, &j| small.value(j).abs().total_cmp(&small.value(i).abs()));
        for (r, &i) in self.ranking[..found].iter().enumerate() {
            let x = &mut self.vectors[r * n..(r + 1) * n];
            x.fill(0.0);
            for j in 0..self.m {
                add_scaled(x, self.small.component(i, j), &self.basis[j * n..(j + 1) * n]);
            }
        }
        // M x takes the place of the basis
        for r in 0..found {
            let excess = self.excess(self.ranking[r]);
            let ritz = self.small.value(self.ranking[r]);
            let x = &mut self.vectors[r * n..(r + 1) * n];
            let (done, rest) = self.mass_basis.split_at_mut(r * n);
            let mx = &mut rest[..n];
            mass(x, mx);
            let y = &mut self.w;
            y.copy_from_slice(mx);
            solve(y);
            self.solves += 1;
            // A vector of larger θ that rounding left in this one hardly matters there.
            for (i, mv) in done.chunks_exact(n).enumerate() {
                let h = dot(mv, y);
                add_scaled(y, -h, &self.basis[i * n..(i + 1) * n]);
            }
            let theta = dot(mx, y);
            x.iter_mut().zip(y.iter()).for_each(|(x, y)| *x = y - theta * *x);
            mass(x, &mut self.u);
            let residual = dot(x, &self.u).max(0.0);
            let length = (theta * theta + residual).sqrt();
            // x is the residual now, and M y = M x θ + M r
            for i in 0..n {
                mx[i] = (mx[i] * theta + self.u[i]) / length;
                x[i] = y[i] / length;
            }
            self.basis[r * n..(r + 1) * n].copy_from_slice(x);
            let relative = residual.sqrt() / theta.abs();
            let distance = theta / (theta * theta + residual);
            self.values.push(shift + distance);
            self.errors.push(distance.abs() * relative.min(self.sharpened(r, ritz, relative)));
            self.converged.push(excess <= 1.0 || relative <= self.settings.tolerance);
            self.order.push(r);
        }
    }

    /// The quadratic bound of a relative error: residual² / gap, without the values that are as
    /// near as the residual.
    fn sharpened(&self, r: usize, ritz: f64, residual: f64) -> f64 {
        let gap = (0..self.small.len())
            .filter(|&i| i != self.ranking[r])
            .map(|i| (self.small.value(i) / ritz - 1.0).abs())
            .filter(|gap| *gap > residual)
            .fold(1.0, f64::min);
        residual * residual / gap
    }

    /// Puts values, errors and flags into order; the vectors stay where they are.
    pub(super) fn sort(&mut self, shift: f64, ascending: bool) {
        let (values, found) = (&self.values, self.values.len());
        let key = |i: usize| if ascending { values[i] } else { (values[i] - shift).abs() };
        self.order.sort_unstable_by(|&i, &j| key(i).total_cmp(&key(j)));
        for (r, &i) in self.order.iter().enumerate() {
            self.w[r] = self.values[i];
            self.u[r] = self.errors[i];
            self.ranking[r] = usize::from(self.converged[i]);
        }
        self.values.copy_from_slice(&self.w[..found]);
        self.errors.copy_from_slice(&self.u[..found]);
        for (flag, r) in self.converged.iter_mut().zip(&self.ranking) {
            *flag = *r == 1;
        }
    }
}
