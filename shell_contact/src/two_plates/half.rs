//! The whole meridian as two halves that share the coefficients next to the equator.
//!
//! In either half `S` runs from its own pole to the equator, and heights are counted from the plane
//! `z = 0` towards its own plate: the lower half is seen in a mirror, `S → π − S`, `z → −z`, in
//! which the energy density is the same. What differs from the half of a mirror-symmetric shell is
//! where coefficients stand among the unknowns. With knots `k = 0 … 2N` from the upper pole to the
//! lower, coefficients of `u` are odd about both poles and those of `w` even, so that the unknowns
//! are `u_1 … u_{2N−1}` and `w_0 … w_{2N}`. Interleaved by knot, `w_0, u_1, w_1, …, w_{2N−1}, w_{2N}`,
//! they are `4N` with half-bandwidth 7: as in the half model, `u_k` is unknown `2k − 1` and `w_k`
//! unknown `2k`, but the last, which follows the one before it.

use crate::half::HalfMeridian;
use crate::meridian::Mesh;
use crate::spline::Component;
use continuation::linalg::SymmetricBand;

/// Which half.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// That of the upper plate.
    Top,
    /// That of the lower plate.
    Bottom,
}

impl Side {
    /// Both.
    pub const BOTH: [Side; 2] = [Side::Top, Side::Bottom];

    /// Heights above `z = 0` in the half's own direction.
    pub(super) fn sign(self) -> f64 {
        match self {
            Side::Top => 1.0,
            Side::Bottom => -1.0,
        }
    }
}

/// One half of the whole meridian; the mesh is that of either.
#[derive(Debug, Clone, Copy)]
pub struct Half<'m> {
    mesh: &'m Mesh,
    side: Side,
}

impl<'m> Half<'m> {
    /// A half of the meridian of which the mesh is the upper one and its mirror image the lower.
    pub fn new(mesh: &'m Mesh, side: Side) -> Half<'m> {
        Half { mesh, side }
    }

    /// Number of unknowns of the whole meridian: four for each element of a half.
    pub fn unknowns(mesh: &Mesh) -> usize {
        4 * mesh.elements()
    }

    /// Where coefficient `j = −1 … N + 1` of a component, counted from this half's pole, stands
    /// among the unknowns, with its sign; `None` if parity makes it zero.
    pub fn slot(&self, component: Component, j: isize) -> Option<(usize, f64)> {
        let last = 2 * self.mesh.elements() as isize;
        let k = match self.side {
            Side::Top => j,
            Side::Bottom => last - j,
        };
        // reflected about the pole that it lies beyond
        let (k, beyond) = match k {
            k if k < 0 => (-k, true),
            k if k > last => (2 * last - k, true),
            k => (k, false),
        };
        match component {
            Component::U if k == 0 || k == last => None,
            Component::U => Some(((2 * k - 1) as usize, if beyond { -1.0 } else { 1.0 })),
            Component::W => {
                let place = if k == last { 2 * k - 1 } else { 2 * k };
                Some((place as usize, self.side.sign()))
            }
        }
    }

    /// Whether element `e` meets no pole: then its eight coefficients are neighbours among the
    /// unknowns, from [`Half::first`] on.
    #[inline(always)]
    fn is_interior(e: usize) -> bool {
        e >= 2
    }

    /// The first unknown of an element that meets no pole.
    #[inline(always)]
    fn first(&self, e: usize) -> usize {
        match self.side {
            Side::Top => 2 * e - 3,
            // element 2N − 1 − e from the upper pole
            Side::Bottom => 4 * self.mesh.elements() - 2 * e - 5,
        }
    }

    fn end_slot(&self, e: usize, k: usize) -> Option<(usize, f64)> {
        let component = if k.is_multiple_of(2) { Component::U } else { Component::W };
        self.slot(component, e as isize - 1 + (k / 2) as isize)
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

    #[cold]
    fn scatter_matrix_end(&self, e: usize, local: &[[f64; 8]; 8], out: &mut SymmetricBand) {
        for column in 0..8 {
            let Some((j, sign_j)) = self.end_slot(e, column) else { continue };
            for row in column..8 {
                let Some((i, sign_i)) = self.end_slot(e, row) else { continue };
                // two mirrored functions are one unknown: both triangles fall on its diagonal
                let twice = if i == j && row != column { 2.0 } else { 1.0 };
                out.add(i.max(j), i.min(j), twice * sign_i * sign_j * local[column][row]);
            }
        }
    }
}

/// The place of coefficient `k` of a lower element among its unknowns: functions in the order of
/// the upper pole, each with `u` before `w`.
#[inline(always)]
fn reversed(k: usize) -> usize {
    2 * (3 - k / 2) + k % 2
}

/// The sign of coefficient `k` of a lower element: `w` is counted downwards.
#[inline(always)]
fn mirror_sign(k: usize) -> f64 {
    if k.is_multiple_of(2) { 1.0 } else { -1.0 }
}

impl HalfMeridian for Half<'_> {
    #[inline(always)]
    fn mesh(&self) -> &Mesh {
        self.mesh
    }

    #[inline(always)]
    fn gather(&self, x: &[f64], e: usize) -> ([f64; 4], [f64; 4]) {
        if Half::is_interior(e) {
            let first = self.first(e);
            if let Some(c) = x.get(first..first + 8) {
                return match self.side {
                    Side::Top => ([c[0], c[2], c[4], c[6]], [c[1], c[3], c[5], c[7]]),
                    Side::Bottom => ([c[6], c[4], c[2], c[0]], [-c[7], -c[5], -c[3], -c[1]]),
                };
            }
        }
        self.gather_end(x, e)
    }

    #[inline(always)]
    fn scatter(&self, e: usize, local: &[f64; 8], out: &mut [f64]) {
        if Half::is_interior(e) {
            let first = self.first(e);
            if let Some(out) = out.get_mut(first..first + 8) {
                for k in 0..8 {
                    match self.side {
                        Side::Top => out[k] += local[k],
                        Side::Bottom => out[reversed(k)] += mirror_sign(k) * local[k],
                    }
                }
            }
        } else {
            for (k, value) in local.iter().enumerate() {
                if let Some((i, sign)) = self.end_slot(e, k) {
                    out[i] += sign * value;
                }
            }
        }
    }

    #[inline(always)]
    fn scatter_matrix(&self, e: usize, local: &[[f64; 8]; 8], out: &mut SymmetricBand) {
        if !Half::is_interior(e) {
            return self.scatter_matrix_end(e, local, out);
        }
        let turned;
        let local = match self.side {
            Side::Top => local,
            Side::Bottom => {
                turned = in_order_of_the_upper_pole(local);
                &turned
            }
        };
        let first = self.first(e);
        for column in 0..8 {
            let entries = out.column_mut(first + column);
            for (entry, value) in entries.iter_mut().zip(&local[column][column..]) {
                *entry += value;
            }
        }
    }

    /// No mirror image: the poles are compared with each other, not with the plane between them.
    #[inline(always)]
    fn floor(&self) -> f64 {
        f64::NEG_INFINITY
    }
}

/// A lower element's triangle `row ≥ column` over its unknowns in their order.
#[inline(always)]
fn in_order_of_the_upper_pole(local: &[[f64; 8]; 8]) -> [[f64; 8]; 8] {
    let mut out = [[0.0; 8]; 8];
    for column in 0..8 {
        for row in column..8 {
            let (i, j) = (reversed(row), reversed(column));
            out[i.min(j)][i.max(j)] = mirror_sign(row) * mirror_sign(column) * local[column][row];
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::close;
    use continuation::Matrix;
    use std::f64::consts::FRAC_PI_2;

    fn random(n: usize) -> Vec<f64> {
        (0..n).map(|i| (1.0 + i as f64 * 1.7).sin()).collect()
    }

    /// `u` and its second derivative vanish at both poles, `w` has no slope there, and what the
    /// halves say of the equator is the same up to the mirror.
    #[test]
    fn ends_and_equator_fit_for_any_unknowns() {
        let mesh = Mesh::graded(11, 3.0).unwrap();
        let x = random(Half::unknowns(&mesh));
        let [top, bottom] = Side::BOTH.map(|side| Half::new(&mesh, side));
        for half in [top, bottom] {
            let pole = half.displacement_in(&x, 0, 0.0);
            close(pole[0].0, 0.0, 0.0, 1e-12);
            close(pole[2].0, 0.0, 0.0, 1e-10);
            close(pole[1].1, 0.0, 0.0, 1e-11);
        }
        let [above, below] = [top, bottom].map(|half| half.displacement_in(&x, 10, FRAC_PI_2));
        for (k, reversal) in [(0, 1.0), (1, -1.0), (2, 1.0)] {
            close(above[k].0, reversal * below[k].0, 1e-12, 1e-11);
            close(above[k].1, -reversal * below[k].1, 1e-12, 1e-11);
        }
    }

    /// Neighbours among the unknowns, as the fast paths take them, are what the slots say.
    #[test]
    fn fast_paths_agree_with_the_slots() {
        let mesh = Mesh::uniform(9).unwrap();
        let n = Half::unknowns(&mesh);
        let x = random(n);
        let mut seen = vec![0; n];
        for side in Side::BOTH {
            let half = Half::new(&mesh, side);
            for e in 0..9 {
                assert_eq!(half.gather(&x, e), half.gather_end(&x, e));
                let local: [f64; 8] = std::array::from_fn(|k| (k as f64 + 0.3).cos());
                let (mut fast, mut slow) = (vec![0.0; n], vec![0.0; n]);
                half.scatter(e, &local, &mut fast);
                for (k, value) in local.iter().enumerate() {
                    if let Some((i, sign)) = half.end_slot(e, k) {
                        slow[i] += sign * value;
                        seen[i] += 1;
                    }
                }
                assert_eq!(fast, slow);
                let matrix: [[f64; 8]; 8] = std::array::from_fn(|j| {
                    std::array::from_fn(|i| if i >= j { ((8 * i + j) as f64).sin() } else { 0.0 })
                });
                let new = || SymmetricBand::new(n, crate::spline::HALF_BANDWIDTH);
                let (mut fast, mut slow) = (new(), new());
                half.scatter_matrix(e, &matrix, &mut fast);
                half.scatter_matrix_end(e, &matrix, &mut slow);
                fast.axpy(-1.0, &slow);
                assert_eq!(fast.norm(), 0.0);
            }
        }
        assert!(seen.iter().all(|&s| s > 0));
    }
}
