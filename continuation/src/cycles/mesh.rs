//! Meshes: interpolation between them, and equidistribution of the interpolation error.

use super::basis::Basis;

/// Nodes of an interval, both ends included, at the largest degree.
const MOST_NODES: usize = 8;
/// Least part of the mean of the monitor function, so that no interval becomes very long.
const LEAST: f64 = 0.05;
/// Range of an unknown, relative to its largest value, below which it is constant.
const CONSTANT: f64 = 1e-9;
/// Range of an unknown, relative to the largest range, below which it is rounding of the others: one that an
/// invariant plane keeps at zero.
const ROUNDING: f64 = 1e-12;

/// A periodic piecewise polynomial on `[0, 1]`: `n` unknowns at `m` nodes of each interval.
#[derive(Clone, Copy)]
pub(super) struct Orbit<'o> {
    pub(super) n: usize,
    pub(super) mesh: &'o [f64],
    pub(super) values: &'o [f64],
    pub(super) basis: &'o Basis,
}

impl<'o> Orbit<'o> {
    pub(super) fn intervals(&self) -> usize {
        self.mesh.len() - 1
    }

    /// The unknowns at node `k` of interval `j`, `k = m` its right end.
    pub(super) fn node(&self, j: usize, k: usize) -> &'o [f64] {
        let m = self.basis.degree;
        let at = (j * m + k) % (self.intervals() * m);
        &self.values[at * self.n..(at + 1) * self.n]
    }

    /// The value at `t`, of period 1.
    pub(super) fn at(&self, t: f64, out: &mut [f64]) {
        let t = t - t.floor();
        let j = self.mesh.partition_point(|x| *x <= t).clamp(1, self.intervals()) - 1;
        let local = (t - self.mesh[j]) / (self.mesh[j + 1] - self.mesh[j]);
        let mut weights = [0.0; MOST_NODES];
        let weights = &mut weights[..=self.basis.degree];
        self.basis.evaluate(local, weights);
        self.within(j, weights, out);
    }

    /// The value in interval `j` where the polynomials of the nodes have these values.
    pub(super) fn within(&self, j: usize, weights: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for (k, weight) in weights.iter().enumerate() {
            out.iter_mut().zip(self.node(j, k)).for_each(|(o, u)| *o += weight * u);
        }
    }

    /// The values at the nodes of another mesh.
    pub(super) fn on(&self, mesh: &[f64], degree: usize) -> Vec<f64> {
        let intervals = mesh.len() - 1;
        let mut out = vec![0.0; intervals * degree * self.n];
        for (index, place) in out.chunks_exact_mut(self.n).enumerate() {
            let (j, k) = (index / degree, index % degree);
            let t = mesh[j] + (mesh[j + 1] - mesh[j]) * k as f64 / degree as f64;
            self.at(t, place);
        }
        out
    }

    /// The values at the nodes of the mesh whose intervals are half as long.
    pub(super) fn on_halved(&self, out: &mut [f64]) {
        let (m, n) = (self.basis.degree, self.n);
        let mut weights = vec![0.0; 2 * m * (m + 1)];
        for (index, weights) in weights.chunks_exact_mut(m + 1).enumerate() {
            self.basis.evaluate(index as f64 / (2 * m) as f64, weights);
        }
        let mut places = out.chunks_exact_mut(n);
        for j in 0..self.intervals() {
            for (weights, place) in weights.chunks_exact(m + 1).zip(&mut places) {
                self.within(j, weights, place);
            }
        }
    }

    /// A mesh of so many intervals on which the interpolation error is about the same everywhere (de
    /// Boor 1973, as in AUTO): equal integrals of the root of the derivative of order `m + 1`, which is
    /// estimated by differences of the one of order `m`, constant on each interval.
    pub(super) fn equidistributed(&self, intervals: usize) -> Vec<f64> {
        let (count, m, n) = (self.intervals(), self.basis.degree, self.n);
        let h = |j: usize| self.mesh[j % count + 1] - self.mesh[j % count];
        let mut tops = vec![0.0; count * n];
        for j in 0..count {
            let scale = h(j).powi(-(m as i32));
            for k in 0..=m {
                for (i, u) in self.node(j, k).iter().enumerate() {
                    tops[j * n + i] += scale * self.basis.top[k] * u;
                }
            }
        }
        let mut ranges: Vec<f64> = (0..n).map(|i| self.range(i)).collect();
        let least = ROUNDING * ranges.iter().fold(0.0_f64, |m, x| m.max(*x));
        ranges.iter_mut().filter(|x| **x < least).for_each(|x| *x = 0.0);
        let jump = |j: usize| -> f64 {
            // at the left end of interval j
            let before = (j + count - 1) % count;
            let width = 0.5 * (h(before) + h(j));
            let sum = |i: usize| {
                if ranges[i] > 0.0 {
                    ((tops[j % count * n + i] - tops[before * n + i]) / (width * ranges[i])).abs()
                } else {
                    0.0
                }
            };
            (0..n).map(sum).sum()
        };
        let power = 1.0 / (m as f64 + 1.0);
        let mut monitor: Vec<f64> =
            (0..count).map(|j| (0.5 * (jump(j) + jump(j + 1))).powf(power)).collect();
        let mean: f64 = (0..count).map(|j| h(j) * monitor[j]).sum();
        if !(mean > 0.0 && mean.is_finite()) {
            return uniform(intervals);
        }
        monitor.iter_mut().for_each(|x| *x = x.max(LEAST * mean));
        let mut sums = vec![0.0; count + 1];
        for j in 0..count {
            sums[j + 1] = sums[j] + h(j) * monitor[j];
        }
        let total = sums[count];
        let mut mesh = vec![0.0; intervals + 1];
        let mut j = 0;
        for (index, place) in mesh.iter_mut().enumerate().skip(1).take(intervals - 1) {
            let wanted = total * index as f64 / intervals as f64;
            while j + 1 < count && sums[j + 1] < wanted {
                j += 1;
            }
            *place = self.mesh[j] + h(j) * (wanted - sums[j]) / (sums[j + 1] - sums[j]);
        }
        mesh[intervals] = 1.0;
        mesh
    }

    /// Largest difference of the values of unknown `i`; 0 where that is rounding.
    fn range(&self, i: usize) -> f64 {
        let values = self.values.iter().skip(i).step_by(self.n);
        let (lo, hi) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(*v), hi.max(*v)));
        if hi - lo > CONSTANT * hi.abs().max(lo.abs()) { hi - lo } else { 0.0 }
    }
}

/// Equal intervals.
pub(super) fn uniform(intervals: usize) -> Vec<f64> {
    (0..=intervals).map(|j| j as f64 / intervals as f64).collect()
}

/// Every interval in two.
pub(super) fn halved(mesh: &[f64]) -> Vec<f64> {
    let mut out: Vec<f64> = mesh.windows(2).flat_map(|w| [w[0], 0.5 * (w[0] + w[1])]).collect();
    out.push(1.0);
    out
}
