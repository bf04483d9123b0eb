//! Element matrices of the second variation: assembled once per state, summed up for any `n`.
//!
//! Even powers of `n` couple `u` and `w`, and `v` with itself; odd powers couple `v` to the two
//! others. Each element keeps these blocks by power, so that a wave number costs one weighted sum.

use super::density::{POWERS, second_variation};
use super::ends::{Ends, HALF_BANDWIDTH};
use crate::density::{Coefficients, Site};
use crate::film::Potential;
use crate::membrane::Membrane;
use crate::meridian::{Cell, Mesh};
use crate::scalar::Lanes;
use continuation::Matrix;
use continuation::linalg::SymmetricBand;

/// A block: function of the first field by function of the second.
type Block<T> = [[T; 4]; 4];

/// Pairs of fields that even powers couple, and odd ones.
const EVEN: [(usize, usize); 4] = [(0, 0), (2, 2), (1, 1), (0, 2)];
const ODD: [(usize, usize); 2] = [(0, 1), (1, 2)];

/// The blocks of an element.
#[derive(Clone, Debug)]
pub(super) struct Element {
    even: [[Block<f64>; 4]; 3],
    odd: [[Block<f64>; 2]; 2],
}

impl Element {
    pub(super) const ZERO: Element =
        Element { even: [[[[0.0; 4]; 4]; 4]; 3], odd: [[[[0.0; 4]; 4]; 2]; 2] };

    /// The 12×12 matrix for `n`, index `3j + f`.
    fn at(&self, n: f64) -> [[f64; 12]; 12] {
        let mut out = [[0.0; 12]; 12];
        let n2 = n * n;
        let even = [1.0, n2, n2 * n2];
        for (pair, &(f, g)) in EVEN.iter().enumerate() {
            let blocks = self.even.each_ref().map(|b| &b[pair]);
            put(&mut out, f, g, |i, j| {
                even[0] * blocks[0][i][j] + even[1] * blocks[1][i][j] + even[2] * blocks[2][i][j]
            });
        }
        for (pair, &(f, g)) in ODD.iter().enumerate() {
            let blocks = self.odd.each_ref().map(|b| &b[pair]);
            put(&mut out, f, g, |i, j| n * (blocks[0][i][j] + n2 * blocks[1][i][j]));
        }
        out
    }
}

#[inline(always)]
fn put(out: &mut [[f64; 12]; 12], f: usize, g: usize, value: impl Fn(usize, usize) -> f64) {
    for i in 0..4 {
        for j in 0..4 {
            let x = value(i, j);
            out[3 * i + f][3 * j + g] = x;
            out[3 * j + g][3 * i + f] = x;
        }
    }
}

/// Sets the elements to the second variation of the state `u`.
pub(super) fn assemble<L: Membrane, F: Potential>(
    mesh: &Mesh,
    u: &[f64],
    law: &L,
    film: &F,
    c: &Coefficients,
    excess: f64,
    out: &mut [Element],
) {
    let mut hessian = [[[Lanes::ZERO; 9]; 9]; POWERS];
    let mut lanes = [[Lanes::ZERO; 4]; 4];
    for (e, element) in out.iter_mut().enumerate() {
        *element = Element::ZERO;
        let local = mesh.local(u, e);
        for cell in mesh.cells(e) {
            let site = Site { weight: cell.weight, area: cell.weight * cell.sin, csc: cell.csc };
            let place = cell.place(&local);
            second_variation(law, film, c, excess, &site, &place, &mut hessian);
            for k in 0..3 {
                for (pair, &(f, g)) in EVEN.iter().enumerate() {
                    block(cell, &hessian[2 * k], f, g, &mut lanes);
                    add(&lanes, &mut element.even[k][pair]);
                }
            }
            for k in 0..2 {
                for (pair, &(f, g)) in ODD.iter().enumerate() {
                    block(cell, &hessian[2 * k + 1], f, g, &mut lanes);
                    add(&lanes, &mut element.odd[k][pair]);
                }
            }
        }
    }
}

/// `Bᵀ H B` for a pair of fields at four Gauss points; kept apart for the vectoriser.
#[inline(never)]
fn block(cell: &Cell, h: &[[Lanes; 9]; 9], f: usize, g: usize, out: &mut Block<Lanes>) {
    let n = &cell.basis;
    for j in 0..4 {
        let mut half = [Lanes::ZERO; 3];
        for d in 0..3 {
            let row = &h[3 * d + f];
            half[d] = row[g] * n[0][j] + row[3 + g] * n[1][j] + row[6 + g] * n[2][j];
        }
        for i in 0..4 {
            out[i][j] = n[0][i] * half[0] + n[1][i] * half[1] + n[2][i] * half[2];
        }
    }
}

fn add(lanes: &Block<Lanes>, out: &mut Block<f64>) {
    for (out, lanes) in out.iter_mut().flatten().zip(lanes.iter().flatten()) {
        *out += lanes.sum();
    }
}

/// Sets `out` to the matrix of the class `ends` at `n`; unknowns that the class does not have get
/// a unit pivot.
pub(super) fn matrix(elements: &[Element], ends: &Ends, n: usize, out: &mut SymmetricBand) {
    out.set_zero();
    for (e, element) in elements.iter().enumerate() {
        scatter(ends, e, &element.at(n as f64), n == 0, out);
    }
    unit_pivots(ends, elements.len(), n == 0, out);
}

/// Sets `out` to the mass matrix `∫(u² + v² + w²) sin S dS` of the class.
pub(super) fn mass(mesh: &Mesh, ends: &Ends, n: usize, out: &mut SymmetricBand) {
    out.set_zero();
    for e in 0..mesh.elements() {
        let mut local = [[0.0; 12]; 12];
        for cell in mesh.cells(e) {
            let area = cell.weight * cell.sin;
            for i in 0..4 {
                for j in 0..4 {
                    let m = (area * cell.basis[0][i] * cell.basis[0][j]).sum();
                    for f in 0..3 {
                        local[3 * i + f][3 * j + f] += m;
                    }
                }
            }
        }
        scatter(ends, e, &local, n == 0, out);
    }
}

fn scatter(
    ends: &Ends,
    e: usize,
    local: &[[f64; 12]; 12],
    without_v: bool,
    out: &mut SymmetricBand,
) {
    if ends.is_interior(e) && !without_v {
        for column in 0..12 {
            let entries = out.column_mut(3 * (e - 1) + column);
            for (entry, value) in entries[..12 - column].iter_mut().zip(&local[column][column..]) {
                *entry += value;
            }
        }
        return;
    }
    let slot = |k: usize| ends.slot(k % 3, e as isize - 1 + (k / 3) as isize);
    for a in 0..12 {
        for b in 0..12 {
            if without_v && (a % 3 == 1 || b % 3 == 1) {
                continue;
            }
            for &(i, ci) in slot(a).terms() {
                for &(j, cj) in slot(b).terms() {
                    if i >= j {
                        out.add(i, j, ci * cj * local[a][b]);
                    }
                }
            }
        }
    }
}

fn unit_pivots(ends: &Ends, elements: usize, without_v: bool, out: &mut SymmetricBand) {
    for j in 0..=elements {
        for f in 0..3 {
            let own = 3 * j + f;
            let absent = without_v && f == 1;
            let has = ends.slot(f, j as isize).terms().first().is_some_and(|t| t.0 == own);
            if absent || !has {
                out.add(own, own, 1.0);
            }
        }
    }
}

/// A zero band for `elements` elements.
pub(super) fn band(elements: usize) -> SymmetricBand {
    SymmetricBand::new(3 * (elements + 1), HALF_BANDWIDTH)
}
