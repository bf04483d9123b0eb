//! Null vectors of a Jacobian that is singular, or nearly so, once.

use crate::linalg::{Bordered, Matrix};
use crate::step::dot;

/// Cosine between a border and the null vector below which the border is renewed. Between two
/// renewals `g` is a smooth function.
const ALIGNED: f64 = 0.9;

/// The solution of `[A b; cᵀ 0] [v; g] = [0; 1]` and that of the transposed system.
#[derive(Clone)]
pub(super) struct Null {
    bordered: Bordered,
    pub(super) right: Vec<f64>,
    pub(super) left: Vec<f64>,
    /// Vanishes exactly where `A` is singular.
    pub(super) g: f64,
    /// Number of negative eigenvalues beside the critical one, of a symmetric matrix.
    pub(super) negative: Option<usize>,
    symmetric: bool,
}

impl Null {
    pub(super) fn new(n: usize) -> Self {
        let mut bordered = Bordered::new(n, 1);
        for (i, c) in bordered.row_mut(0).iter_mut().enumerate() {
            *c = crate::singular::arbitrary(1, i);
        }
        for (i, b) in bordered.column_mut(0).iter_mut().enumerate() {
            *b = crate::singular::arbitrary(2, i);
        }
        Null {
            bordered,
            right: vec![0.0; n],
            left: vec![0.0; n],
            g: 0.0,
            negative: None,
            symmetric: false,
        }
    }

    /// Factors `a` and solves for the null vectors; false where they are not finite.
    pub(super) fn solve<A: Matrix>(&mut self, a: &mut A) -> bool {
        let facts = self.bordered.factor(a);
        // the border adds one negative eigenvalue
        self.negative = facts.inertia.map(|(negative, _)| negative.saturating_sub(1));
        self.symmetric = facts.core.inertia.is_some();
        let mut tail = [1.0];
        self.left.fill(0.0);
        self.bordered.solve_transpose(a, &mut self.left, &mut tail);
        self.right.fill(0.0);
        tail = [1.0];
        self.bordered.solve(a, &mut self.right, &mut tail);
        self.g = tail[0];
        self.g.is_finite() && self.right.iter().chain(&self.left).all(|x| x.is_finite())
    }

    /// Replaces the borders by the null vectors, of length 1, where they are no longer near to
    /// them. Their directions do not jump, so that the sign of `g` keeps its meaning.
    pub(super) fn renew(&mut self) -> bool {
        let cosine = |border: &[f64], null: &[f64]| {
            dot(border, null) / (dot(border, border) * dot(null, null)).sqrt()
        };
        let near = cosine(self.bordered.row(0), &self.right) > ALIGNED
            && cosine(self.bordered.column(0), &self.left) > ALIGNED;
        if !near {
            self.take();
        }
        !near
    }

    /// Replaces the borders by the null vectors.
    pub(super) fn take(&mut self) {
        let Null { bordered, right, left, symmetric, .. } = self;
        let norm = dot(right, right).sqrt();
        bordered.row_mut(0).iter_mut().zip(right.iter()).for_each(|(c, v)| *c = v / norm);
        if *symmetric {
            // the two are equal but for rounding
            bordered.column_mut(0).iter_mut().zip(right.iter()).for_each(|(b, v)| *b = v / norm);
        } else {
            let norm = dot(left, left).sqrt();
            bordered.column_mut(0).iter_mut().zip(left.iter()).for_each(|(b, w)| *b = w / norm);
        }
    }
}
