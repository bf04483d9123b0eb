//! Equidistant nodes between two ends where the unknown is given.

/// `n` interior nodes a distance `h` apart.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Grid {
    pub(crate) n: usize,
    pub(crate) h: f64,
}

impl Grid {
    /// Interior nodes of an interval of this length.
    pub(crate) fn new(n: usize, length: f64) -> Grid {
        let n = n.max(1);
        Grid { n, h: length / (n as f64 + 1.0) }
    }

    /// Position of interior node `i`.
    pub(crate) fn x(&self, i: usize) -> f64 {
        (i as f64 + 1.0) * self.h
    }

    /// Neighbours of interior node `i`; `end` at both ends.
    pub(crate) fn neighbours(&self, u: &[f64], i: usize, end: f64) -> (f64, f64) {
        let before = if i == 0 { end } else { u[i - 1] };
        (before, u.get(i + 1).copied().unwrap_or(end))
    }

    /// `∂²u` at interior node `i`, from differences: a smooth `u` loses no digits to the spacing.
    pub(crate) fn second(&self, u: &[f64], i: usize, end: f64) -> f64 {
        let (before, after) = self.neighbours(u, i, end);
        self.second_of(before, u[i], after)
    }

    /// The same from three neighbouring values.
    pub(crate) fn second_of(&self, before: f64, here: f64, after: f64) -> f64 {
        ((after - here) - (here - before)) / (self.h * self.h)
    }

    /// Value in the middle: of the node there, else of the cubic through the four around it.
    pub(crate) fn middle(&self, u: &[f64], end: f64) -> f64 {
        let m = self.n / 2;
        if self.n % 2 == 1 {
            return u[m];
        }
        let (before, _) = self.neighbours(u, m - 1, end);
        let (_, after) = self.neighbours(u, m, end);
        (9.0 * (u[m - 1] + u[m]) - before - after) / 16.0
    }

    /// `y = h x`, the metric of `L²`.
    pub(crate) fn weigh(&self, x: &[f64], y: &mut [f64]) {
        for (y, x) in y.iter_mut().zip(x) {
            *y = self.h * x;
        }
    }

    /// `√∫u²` of a function that vanishes at the ends.
    pub(crate) fn norm(&self, u: &[f64]) -> f64 {
        (self.h * u.iter().map(|u| u * u).sum::<f64>()).sqrt()
    }
}

/// Adds `weight` on the diagonal.
pub(crate) fn diagonal(m: &mut continuation::linalg::SymmetricBand, n: usize, weight: f64) {
    for i in 0..n {
        m.add(i, i, weight);
    }
}
