//! Eigenvalues and shapes of modes on the whole meridian, with the mass of module `eigen`.

use super::eigen::{LOCATED, iterate};
use super::ends::{Ends, FIELDS, Neutral, Slot};
use super::whole::{Place, WholeModes};
use super::{ModeCount, ModeShape, Parity, solve};
use crate::two_plates::Side;
use continuation::Matrix;
use std::f64::consts::PI;

/// A mode whose product with its mirror image is so near to one or minus one, relative to its square,
/// has a parity: about a state that is its own mirror image the rest is rounding, unless modes of both
/// parities turn together.
const OF_ONE_PARITY: f64 = 1e-3;

impl WholeModes<'_> {
    /// The count of `n` waves and its eigenvalue nearest to zero, whose mode `x` becomes; the search
    /// begins with what `x` was, unless it is empty.
    pub(super) fn count_and_value(&mut self, n: usize, x: &mut Vec<f64>) -> (ModeCount, f64) {
        let count = self.count(n);
        self.set_mass(n);
        let WholeModes { mass, band, scale, .. } = self;
        (count, iterate(mass, |x| solve(band, scale, x), 0.0, LOCATED, x))
    }

    fn ends(&self, n: usize) -> Ends {
        Ends::new(self.mesh.knots(), n, Parity::Symmetric, Neutral::Pinned)
    }

    /// Sets the mass to that of `n` waves.
    fn set_mass(&mut self, n: usize) {
        let ends = self.ends(n);
        let WholeModes { mass, masses, mesh, .. } = self;
        mass.set_zero();
        for side in Side::BOTH {
            let place = Place { elements: mesh.elements(), side };
            for (e, local) in masses.elements().iter().enumerate() {
                for f in 0..FIELDS {
                    let slots: [Slot; 4] = std::array::from_fn(|i| place.slot(&ends, e, 3 * i + f));
                    for (a, slot_a) in slots.iter().enumerate() {
                        for (b, slot_b) in slots.iter().enumerate() {
                            for &(i, ci) in slot_a.terms() {
                                for &(j, cj) in slot_b.terms() {
                                    if i >= j {
                                        mass.add(i, j, ci * cj * local[a][b]);
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }

    /// The amplitudes of a mode found by `count_and_value`, from the upper pole to the lower, `w`
    /// upwards.
    pub(super) fn shape_of(&self, n: usize, x: &[f64]) -> ModeShape {
        let ends = self.ends(n);
        let knots = self.mesh.knots();
        let elements = knots.elements();
        let value = |side: Side, f: usize, j: usize| -> f64 {
            let place = Place { elements, side };
            let e = j.min(elements - 1);
            let basis = knots.basis(e, knots.at(j))[0];
            let coefficient = |i: usize| -> f64 {
                let slot = place.slot(&ends, e, FIELDS * i + f);
                slot.terms().iter().map(|&(k, c)| c * x[k]).sum()
            };
            // slots count w towards the half's own plate
            let upwards = if f == 2 && side == Side::Bottom { -1.0 } else { 1.0 };
            upwards * (0..4).map(|i| basis[i] * coefficient(i)).sum::<f64>()
        };
        let field = |f: usize| -> Vec<f64> {
            let above = (0..=elements).map(|j| value(Side::Top, f, j));
            above.chain((0..elements).rev().map(|j| value(Side::Bottom, f, j))).collect()
        };
        let above = (0..=elements).map(|j| knots.at(j));
        let s = above.chain((0..elements).rev().map(|j| PI - knots.at(j))).collect();
        ModeShape { s, u: field(0), v: field(1), w: field(2) }.normalised()
    }

    /// The parity of a mode, if it has one.
    pub(super) fn parity_of(&self, x: &[f64]) -> Option<Parity> {
        let last = x.len() / FIELDS - 1;
        let (mut square, mut product) = (0.0, 0.0);
        for k in 0..=last {
            for f in 0..FIELDS {
                let sign = if f == 2 { -1.0 } else { 1.0 };
                let (own, other) = (x[FIELDS * k + f], x[FIELDS * (last - k) + f]);
                square += own * own;
                product += sign * own * other;
            }
        }
        let share = product / square;
        if (share - 1.0).abs() < OF_ONE_PARITY {
            return Some(Parity::Symmetric);
        }
        ((share + 1.0).abs() < OF_ONE_PARITY).then_some(Parity::Antisymmetric)
    }
}
