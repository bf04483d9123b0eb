//! End conditions of the three spline fields `u, v, w`, by wave number and parity.
//!
//! Smooth vector fields at a pole: `u + v = O(S^{n+1})`, `u − v = O(S^{|n−1|})`, `w = O(Sⁿ)`, each
//! times an even function. What is essential (finite energy) or a parity is imposed on the three
//! coefficients next to the end; higher orders follow by themselves. For `n ≥ 2` the slope of `w`
//! is essential: `(n² − 1)w'/S` would have a logarithmic energy.
//!
//! | at the pole | `u, v` | `w` |
//! |---|---|---|
//! | `n = 0` | odd (`v` is left out) | even |
//! | `n = 1` | even, `u + v = 0` | odd |
//! | `n` even | odd | even and zero |
//! | `n ≥ 3` odd | even and zero | odd, slope zero |
//!
//! At the equator `u` and `v` are even and `w` odd for modes that are their own mirror images, and
//! the reverse for the others.
//!
//! Unknown `3j + f` is coefficient `j = 0 … N` of field `f`. Those that an end condition takes
//! away keep their place and a unit pivot: every class has the same dimension and half-bandwidth
//! 11.

use super::Parity;
use crate::spline::Knots;

/// Fields of a mode: `u, v, w`.
pub(super) const FIELDS: usize = 3;

/// Half-bandwidth of the three interleaved fields.
pub(super) const HALF_BANDWIDTH: usize = 11;

/// What holds of a field at an end.
#[derive(Clone, Copy, PartialEq)]
enum End {
    Even,
    Odd,
    EvenAndZero,
    Flat,
    /// `n = 1`: `v` is even and cancels `u` at the pole.
    Cancels,
    Absent,
}

/// How the neutral modes of `n = 1` are treated.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Neutral {
    /// `u − v = 0` at the pole: in-plane translation and material rotation are excluded, and the
    /// inertia on what is left is that of the matrix without its zeros.
    Pinned,
    /// They are among the modes.
    Kept,
}

/// A coefficient as a combination of unknowns.
#[derive(Clone, Copy, Default, Debug)]
pub(super) struct Slot {
    pub(super) terms: [(usize, f64); 3],
    pub(super) count: usize,
}

impl Slot {
    pub(super) fn new(terms: &[(usize, f64)]) -> Slot {
        let mut slot = Slot::default();
        for (to, from) in slot.terms.iter_mut().zip(terms) {
            *to = *from;
        }
        slot.count = terms.len();
        slot
    }

    pub(super) fn terms(&self) -> &[(usize, f64)] {
        &self.terms[..self.count]
    }
}

/// The end conditions of a class of modes.
#[derive(Clone, Debug)]
pub(super) struct Ends {
    elements: usize,
    /// Coefficients `−1, 0, 1` at the pole and `N − 1, N, N + 1` at the equator, by field.
    pole: [[Slot; 3]; 3],
    equator: [[Slot; 3]; 3],
}

impl Ends {
    pub(super) fn new(knots: &Knots, n: usize, parity: Parity, neutral: Neutral) -> Ends {
        let elements = knots.elements();
        let pole = match n {
            0 => [End::Odd, End::Absent, End::Even],
            1 if neutral == Neutral::Kept => [End::Even, End::Cancels, End::Odd],
            1 => [End::EvenAndZero, End::EvenAndZero, End::Odd],
            n if n.is_multiple_of(2) => [End::Odd, End::Odd, End::EvenAndZero],
            _ => [End::EvenAndZero, End::EvenAndZero, End::Flat],
        };
        let (tangential, axial) = match parity {
            Parity::Symmetric => (End::Even, End::Odd),
            Parity::Antisymmetric => (End::Odd, End::Even),
        };
        let around = if n == 0 { End::Absent } else { tangential };
        let equator = [tangential, around, axial];
        // value at the pole: B_0 c_0 + 2 B_1 c_1 of an even field
        let basis = knots.basis(0, 0.0)[0];
        let share = 2.0 * basis[2] / basis[1];
        Ends {
            elements,
            pole: std::array::from_fn(|f| at_end(pole[f], share, |j, f| 3 * j + f, f)),
            equator: std::array::from_fn(|f| {
                let mut slots = at_end(equator[f], share, |j, f| 3 * (elements - j) + f, f);
                slots.reverse();
                slots
            }),
        }
    }

    /// How coefficient `j = −1, …, N + 1` of field `f` follows from the unknowns.
    pub(super) fn slot(&self, f: usize, j: isize) -> Slot {
        let n = self.elements as isize;
        if j <= 1 {
            self.pole[f][(j + 1) as usize]
        } else if j >= n - 1 {
            self.equator[f][(j - n + 1) as usize]
        } else {
            // an absent field has no unknowns inside either, but nothing is coupled to it there
            Slot::new(&[(3 * j as usize + f, 1.0)])
        }
    }
}

/// The three coefficients next to an end, from the outer one inwards.
fn at_end(end: End, share: f64, unknown: impl Fn(usize, usize) -> usize, f: usize) -> [Slot; 3] {
    let (zero, one) = (unknown(0, f), unknown(1, f));
    let own = |i: usize| Slot::new(&[(i, 1.0)]);
    match end {
        End::Even => [own(one), own(zero), own(one)],
        End::Odd => [Slot::new(&[(one, -1.0)]), Slot::default(), own(one)],
        End::EvenAndZero => [own(one), Slot::new(&[(one, -share)]), own(one)],
        End::Cancels => {
            let other =
                Slot::new(&[(unknown(0, f - 1), -1.0), (unknown(1, f - 1), -share), (one, -share)]);
            [own(one), other, own(one)]
        }
        End::Flat | End::Absent => [Slot::default(); 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// Value, slope and second derivative of a field with random unknowns at both ends.
    fn ends(n: usize, parity: Parity, neutral: Neutral) -> [[[f64; 3]; 3]; 2] {
        let t: Vec<f64> = (0..=9)
            .map(|i| {
                let x = f64::from(i) / 9.0;
                FRAC_PI_2 * (x + 0.3 * x * (1.0 - x) * (1.0 + x))
            })
            .collect();
        let knots = Knots::new(&t).unwrap();
        let ends = Ends::new(&knots, n, parity, neutral);
        let x: Vec<f64> = (0..30).map(|i| (1.0 + f64::from(i) * 1.7).sin()).collect();
        let value = |e: usize, s: f64, f: usize| {
            let basis = knots.basis(e, s);
            std::array::from_fn(|k| {
                (0..4)
                    .map(|i| {
                        let slot = ends.slot(f, e as isize - 1 + i as isize);
                        basis[k][i] * slot.terms().iter().map(|&(i, c)| c * x[i]).sum::<f64>()
                    })
                    .sum()
            })
        };
        let at = |e, s| [value(e, s, 0), value(e, s, 1), value(e, s, 2)];
        [at(0, 0.0), at(8, FRAC_PI_2)]
    }

    #[test]
    fn conditions_hold_for_any_unknowns() {
        let zero = |x: f64| assert!(x.abs() < 1e-11, "{x}");
        for n in [0, 1, 2, 3, 4, 7] {
            for parity in [Parity::Symmetric, Parity::Antisymmetric] {
                for neutral in [Neutral::Pinned, Neutral::Kept] {
                    let [[u, v, w], [ue, ve, we]] = ends(n, parity, neutral);
                    match n {
                        0 => vec![u[0], u[2], w[1]],
                        1 => vec![u[1], v[1], w[0], w[2], u[0] + v[0]],
                        n if n % 2 == 0 => vec![u[0], u[2], v[0], v[2], w[0], w[1]],
                        _ => vec![u[0], u[1], v[0], v[1], w[0], w[1], w[2]],
                    }
                    .into_iter()
                    .for_each(zero);
                    if n == 1 && neutral == Neutral::Pinned {
                        zero(u[0] - v[0]);
                    }
                    let (even, odd) = match parity {
                        Parity::Symmetric => ([ue, ve], we),
                        Parity::Antisymmetric => ([we, we], ue),
                    };
                    even.iter().for_each(|e| zero(e[1]));
                    zero(odd[0]);
                    zero(odd[2]);
                }
            }
        }
    }
}
