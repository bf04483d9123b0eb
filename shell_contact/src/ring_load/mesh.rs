//! The mesh that moves with the ring: a knot at the contact angle `α`, its neighbours close by.
//!
//! All knots are linear in `α`: `t_j = α a_j` inside the ring, `t_j = α + (π/2 − α) b_j` outside.
//! With the ring anywhere else the answer wobbles as it crosses elements. The knot is double: the
//! ring's force is a jump in shear, so in the third derivative of `w`, and by the shell's curvature
//! one in the slope of the tension, so in the second derivative of `u`; a moment is a jump in that
//! of `w`. Between both knots lies an element of no length.

use crate::meridian::Mesh;
use crate::params::ParameterError;
use crate::spline::FEWEST_ELEMENTS;
use std::f64::consts::FRAC_PI_2;

/// Part of the elements that lies inside the ring.
const INSIDE: f64 = 0.3;
/// How many times longer the elements at the pole are than those at the ring.
const INNER_GRADING: f64 = 2.0;
/// How many times longer the elements at the equator are than those at the ring, unless asked
/// otherwise.
pub const DEFAULT_GRADING: f64 = 8.0;
/// Angles nearer to pole or equator than this are refused, in radians.
pub(super) const LEAST_ANGLE: f64 = 1e-3;

/// Where the knots are, in parts of the meridian inside and outside the ring.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    /// Number of elements inside, index of the first of the ring's knots.
    pub(super) ring: usize,
    parts: Vec<f64>,
}

/// `n + 1` places from 0 to 1, the last interval `ratio` times as long as the first.
fn graded(n: usize, ratio: f64) -> impl Iterator<Item = f64> {
    let beta = ratio.acosh();
    (0..=n).map(move |i| {
        let x = i as f64 / n as f64;
        if beta < 1e-6 { x } else { (beta * x).sinh() / beta.sinh() }
    })
}

impl Layout {
    /// A mesh of `elements`, those at the equator `grading` times as long as those at the ring.
    pub(super) fn new(elements: usize, grading: f64) -> Result<Layout, ParameterError> {
        if elements < 2 * FEWEST_ELEMENTS {
            return Err(ParameterError::OutOfRange {
                key: "elements",
                value: elements as f64,
                allowed: "at least 16",
                remedy: "eight on either side of the ring are the least; 400 serve",
            });
        }
        if !(1.0..=1000.0).contains(&grading) {
            return Err(ParameterError::OutOfRange {
                key: "grading",
                value: grading,
                allowed: "from 1 to 1000",
                remedy: "1 is a uniform mesh on either side of the ring",
            });
        }
        let inside = (INSIDE * elements as f64).round() as usize;
        let ring = inside.clamp(FEWEST_ELEMENTS, elements - FEWEST_ELEMENTS);
        let mut parts: Vec<f64> = graded(ring, INNER_GRADING).map(|x| 1.0 - x).collect();
        parts.reverse();
        parts.extend(graded(elements - ring, grading));
        Ok(Layout { ring, parts })
    }

    /// Knot `j` with the ring at `alpha`.
    pub(super) fn knot(&self, j: usize, alpha: f64) -> f64 {
        match self.parts[j] {
            part if j <= self.ring => alpha * part,
            part => alpha + (FRAC_PI_2 - alpha) * part,
        }
    }

    /// Its derivative in `alpha`.
    pub(super) fn slope(&self, j: usize) -> f64 {
        if j <= self.ring { self.parts[j] } else { 1.0 - self.parts[j] }
    }

    /// The mesh with the ring at a valid `alpha`.
    pub(super) fn mesh(&self, alpha: f64) -> Mesh {
        Mesh::from_trusted(self.parts.len() - 1, |j| self.knot(j, alpha))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::close;

    #[test]
    fn the_ring_is_a_knot_and_neighbours_are_alike() {
        let layout = Layout::new(400, DEFAULT_GRADING).unwrap();
        let alpha = 0.2;
        let t = |j: usize| layout.knot(j, alpha);
        close(t(layout.ring), alpha, 1e-15, 0.0);
        close(t(layout.ring + 1), alpha, 1e-15, 0.0);
        assert_eq!((t(0), t(401)), (0.0, FRAC_PI_2));
        let (left, right) = (alpha - t(layout.ring - 1), t(layout.ring + 2) - alpha);
        assert!(left / right > 0.5 && left / right < 2.0, "{left} and {right}");
        for j in 0..=401 {
            let h = 1e-3;
            let slope = (layout.knot(j, alpha + h) - layout.knot(j, alpha - h)) / (2.0 * h);
            close(layout.slope(j), slope, 1e-10, 1e-12);
        }
        assert!(Layout::new(15, 8.0).is_err() && Layout::new(400, 0.5).is_err());
    }
}
