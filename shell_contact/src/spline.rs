//! Cubic B-splines on `S ∈ [0, π/2]` over arbitrary increasing knots, reflected about both ends.
//!
//! With the knots `t_0 = 0 < … < t_N = π/2` continued by reflection, the basis function `B_j`
//! (centred at `t_j`, `j = −1, …, N+1`) satisfies `B_{−j}(−S) = B_j(S)` and likewise about `π/2`.
//! Parity is then a statement about coefficients: a function is even about an end if and only if
//! the coefficients mirrored there are equal, odd if and only if they are opposite. The
//! displacement `u` (of `σ`) is odd at the pole and even at the equator, `w` (of `z`) the reverse,
//! so the free coefficients are `u_1 … u_N` and `w_0 … w_{N−1}`. Interleaved by knot,
//! `w_0, u_1, w_1, …, u_N`, they give `2N` unknowns and half-bandwidth 7.

use crate::params::ParameterError;
use crate::scalar::Scalar;
use std::f64::consts::FRAC_PI_2;

/// Half-bandwidth of matrices over the interleaved coefficients.
pub const HALF_BANDWIDTH: usize = 7;

/// Which displacement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Component {
    /// `u = σ − sin S`: odd at the pole, even at the equator.
    U,
    /// `w = z − cos S`: even at the pole, odd at the equator.
    W,
}

/// Values and derivatives of the four basis functions of an element: `[derivative][function]`.
pub type Basis = [[f64; 4]; 4];

/// The four functions of the element between the knots `t(0)` and `t(1)`, which depend on
/// `t(−2), …, t(3)`, and three derivatives, at `s`.
pub(crate) fn basis_over<T: Scalar>(t: impl Fn(isize) -> T, s: T) -> [[T; 4]; 4] {
    let zero = T::constant(0.0);
    // each of t_{e-2}, …, t_{e+3} is read several times
    let near: [T; 6] = std::array::from_fn(|i| t(i as isize - 2));
    let t = |k: isize| near[(k + 2) as usize];
    // de Boor's triangle: degree d functions on t_{e-d}.., four entries at most
    let mut triangle = [[zero; 4]; 4];
    triangle[0][0] = T::constant(1.0);
    for d in 1..=3_usize {
        for r in 0..d {
            let (right, left) = (t(r as isize + 1), t(r as isize + 1 - d as isize));
            let share = triangle[d - 1][r] / (right - left);
            triangle[d][r] = triangle[d][r] + (right - s) * share;
            triangle[d][r + 1] = triangle[d][r + 1] + (s - left) * share;
        }
    }
    let mut out = [[zero; 4]; 4];
    out[0] = triangle[3];
    // derivative k: differentiate k times from degree 3 - k
    for k in 1..=3_usize {
        let mut row = triangle[3 - k];
        for d in 4 - k..=3 {
            let mut next = [zero; 4];
            for r in 0..d {
                let width = t(r as isize + 1) - t(r as isize + 1 - d as isize);
                let slope = row[r] * d as f64 / width;
                next[r] = next[r] - slope;
                next[r + 1] = next[r + 1] + slope;
            }
            row = next;
        }
        out[k] = row;
    }
    out
}

/// The knots, continued by reflection.
#[derive(Debug, Clone, PartialEq)]
pub struct Knots {
    /// `t_{-3}, …, t_{N+3}`
    extended: Vec<f64>,
    elements: usize,
}

/// Fewest elements of a mesh.
pub const FEWEST_ELEMENTS: usize = 8;

impl Knots {
    /// Knots `0 = t_0 < … < t_N = π/2`, at least eight elements.
    ///
    /// # Errors
    /// When they are too few, not increasing, or do not end at 0 and `π/2`.
    pub fn new(knots: &[f64]) -> Result<Knots, ParameterError> {
        let elements = knots.len().saturating_sub(1);
        if elements < FEWEST_ELEMENTS {
            return Err(ParameterError::too_few_elements(elements));
        }
        if let Some(e) = (0..elements).find(|&e| {
            let gap = knots[e + 1] - knots[e];
            !(gap > 1e-9 && gap.is_finite())
        }) {
            return Err(ParameterError::Knots { at: e + 1, value: knots[e + 1] });
        }
        if knots[0].abs() > 1e-12 {
            return Err(ParameterError::Knots { at: 0, value: knots[0] });
        }
        if (knots[elements] - FRAC_PI_2).abs() > 1e-12 {
            return Err(ParameterError::Knots { at: elements, value: knots[elements] });
        }
        Ok(Knots::trusted(elements, |j| knots[j]))
    }

    /// Knots `f(0), …, f(N)` that are valid, or equal in pairs away from the ends: between those lies
    /// an element of no length, and the spline's second derivative may jump there.
    pub(crate) fn trusted(elements: usize, f: impl Fn(usize) -> f64) -> Knots {
        let mut knots = Knots { extended: vec![0.0; elements + 7], elements };
        knots.move_to(f);
        knots
    }

    /// Number of elements `N`.
    pub fn elements(&self) -> usize {
        self.elements
    }

    /// Knot `t_j`, `j = 0, …, N`.
    pub fn at(&self, j: usize) -> f64 {
        self.extended[j + 3]
    }

    /// The element that contains `S` (the first or last one for `S` outside).
    pub fn element_of(&self, s: f64) -> usize {
        let inner = &self.extended[4..3 + self.elements];
        inner.partition_point(|&t| t <= s)
    }

    /// The functions `B_{e−1}, …, B_{e+2}` and their first three derivatives at `S` in element
    /// `e` (or on the continuation of its polynomials).
    pub fn basis(&self, e: usize, s: f64) -> Basis {
        basis_over(|k| self.extended[(e as isize + 3 + k) as usize], s)
    }

    /// Moves the knots to `f(0), …, f(N)`, which are trusted to be valid; allocates nothing.
    pub(crate) fn move_to(&mut self, f: impl Fn(usize) -> f64) {
        let n = self.elements;
        for j in 0..=n {
            self.extended[3 + j] = f(j);
        }
        self.extended[3] = 0.0;
        self.extended[3 + n] = FRAC_PI_2;
        for k in 1..=3 {
            self.extended[3 - k] = -self.extended[3 + k];
            self.extended[3 + n + k] = 2.0 * FRAC_PI_2 - self.extended[3 + n - k];
        }
    }

    /// Where coefficient `j ∈ −1, …, N+1` of a component stands among the unknowns, with its sign;
    /// `None` if parity makes it zero.
    pub fn slot(&self, component: Component, j: isize) -> Option<(usize, f64)> {
        let n = self.elements as isize;
        let (mirrored, crossings) = match j {
            j if j < 0 => (-j, (true, false)),
            j if j > n => (2 * n - j, (false, true)),
            j => (j, (false, false)),
        };
        match component {
            Component::U if mirrored == 0 => None,
            Component::U => {
                let sign = if crossings.0 { -1.0 } else { 1.0 };
                Some(((2 * mirrored - 1) as usize, sign))
            }
            Component::W if mirrored == n => None,
            Component::W => {
                let sign = if crossings.1 { -1.0 } else { 1.0 };
                Some(((2 * mirrored) as usize, sign))
            }
        }
    }

    /// Whether element `e` meets no end: then its eight coefficients are the unknowns
    /// `2e−3, …, 2e+4` in order.
    #[inline(always)]
    pub fn is_interior(&self, e: usize) -> bool {
        e >= 2 && e + 2 < self.elements
    }

    /// The four coefficients of `u` and of `w` that element `e` sees, parity folded in.
    #[inline(always)]
    pub fn gather(&self, x: &[f64], e: usize) -> ([f64; 4], [f64; 4]) {
        if self.is_interior(e) {
            let first = 2 * e - 3;
            if let Some(c) = x.get(first..first + 8) {
                return ([c[0], c[2], c[4], c[6]], [c[1], c[3], c[5], c[7]]);
            }
        }
        self.gather_end(x, e)
    }

    #[cold]
    fn gather_end(&self, x: &[f64], e: usize) -> ([f64; 4], [f64; 4]) {
        let pick = |component| {
            let mut c = [0.0; 4];
            for (k, c) in c.iter_mut().enumerate() {
                if let Some((i, sign)) = self.slot(component, e as isize - 1 + k as isize) {
                    *c = sign * x[i];
                }
            }
            c
        };
        (pick(Component::U), pick(Component::W))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::close;

    fn uneven(n: usize) -> Knots {
        let t: Vec<f64> = (0..=n)
            .map(|i| {
                let x = i as f64 / n as f64;
                FRAC_PI_2 * (x + 0.3 * x * (1.0 - x) * (1.0 + x))
            })
            .collect();
        Knots::new(&t).unwrap()
    }

    #[test]
    fn partition_of_unity_and_derivatives() {
        let knots = uneven(11);
        for e in 0..11 {
            for f in [0.0, 0.2, 0.7, 1.0] {
                let s = knots.at(e) + f * (knots.at(e + 1) - knots.at(e));
                let b = knots.basis(e, s);
                close(b[0].iter().sum(), 1.0, 1e-14, 0.0);
                let h = 1e-4;
                let (up, down) = (knots.basis(e, s + h), knots.basis(e, s - h));
                for k in 0..3 {
                    close(b[k + 1].iter().sum(), 0.0, 0.0, 1e-9);
                    for j in 0..4 {
                        assert!(b[0][j] >= 0.0);
                        close((up[k][j] - down[k][j]) / (2.0 * h), b[k + 1][j], 1e-6, 1e-4);
                    }
                }
            }
        }
    }

    #[test]
    fn twice_continuously_differentiable_across_knots() {
        let knots = uneven(9);
        for e in 0..8 {
            let s = knots.at(e + 1);
            let (left, right) = (knots.basis(e, s), knots.basis(e + 1, s));
            for k in 0..3 {
                close(left[k][0], 0.0, 0.0, 1e-12);
                for j in 0..3 {
                    close(left[k][j + 1], right[k][j], 1e-12, 1e-12);
                }
            }
        }
    }

    /// u odd at the pole and even at the equator, w the reverse, for any coefficients.
    #[test]
    fn parity_holds_by_folding() {
        let n = 10;
        let knots = uneven(n);
        let x: Vec<f64> = (0..2 * n).map(|i| (1.0 + i as f64 * 1.7).sin()).collect();
        let value = |e: usize, s: f64, k: usize| {
            let (u, w) = knots.gather(&x, e);
            let b = knots.basis(e, s)[k];
            let dot = |c: [f64; 4]| b.iter().zip(c).map(|(b, c)| b * c).sum::<f64>();
            (dot(u), dot(w))
        };
        for (k, pole_u) in [(0, true), (1, false), (2, true)] {
            let (u, w) = value(0, 0.0, k);
            close(if pole_u { u } else { w }, 0.0, 0.0, 1e-12);
            let (u, w) = value(n - 1, FRAC_PI_2, k);
            close(if pole_u { w } else { u }, 0.0, 0.0, 1e-12);
        }
    }

    #[test]
    fn every_unknown_is_seen_and_interior_elements_are_contiguous() {
        let n = 9;
        let knots = uneven(n);
        let mut seen = vec![0; 2 * n];
        for e in 0..n {
            let mut slots = Vec::new();
            for j in 0..4 {
                for c in [Component::U, Component::W] {
                    if let Some((i, sign)) = knots.slot(c, e as isize - 1 + j) {
                        seen[i] += 1;
                        slots.push((i, sign));
                    }
                }
            }
            if knots.is_interior(e) {
                let plain: Vec<_> = (2 * e - 3..2 * e + 5).map(|i| (i, 1.0)).collect();
                assert_eq!(slots, plain);
            }
        }
        assert!(seen.iter().all(|&s| s > 0));
    }

    #[test]
    fn knots_are_validated() {
        assert!(Knots::new(&[0.0, 1.0, FRAC_PI_2]).is_err());
        let mut t: Vec<f64> = (0..=8).map(|i| FRAC_PI_2 * f64::from(i) / 8.0).collect();
        assert!(Knots::new(&t).is_ok());
        t[3] = t[4];
        assert!(matches!(Knots::new(&t), Err(ParameterError::Knots { at: 4, .. })));
        t[3] = f64::NAN;
        assert!(Knots::new(&t).is_err());
    }
}
