//! A mesh at one contact angle, with the derivatives of all that moves when the angle does.

use super::mesh::Layout;
use crate::density::{self, Coefficients, Gradient, Site};
use crate::film::NoFilm;
use crate::forward::Forward;
use crate::gas::Gas;
use crate::membrane::Membrane;
use crate::meridian::{Cell, Local, Mesh, Place};
use crate::scalar::{Lanes, WIDTH};
use crate::spline::{Component, Knots, basis_over};
use std::f64::consts::FRAC_PI_2;
use std::sync::{Mutex, MutexGuard};

type D = Forward<Lanes>;

/// What one spline coefficient of `w` does at the ring.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct AtRing {
    /// Index among the unknowns.
    pub(super) unknown: usize,
    /// `∂z(S_L)/∂x`, and its derivative in the angle.
    pub(super) height: [f64; 2],
    /// `∂z'(S_L)/∂x`, and its derivative in the angle.
    pub(super) slope: [f64; 2],
}

/// Derivatives in the angle of what a [`Cell`] holds.
#[derive(Debug, Clone, Copy)]
struct CellSlopes {
    basis: [[Lanes; 4]; 3],
    weight: Lanes,
    /// Of the Gauss points' `S`.
    place: Lanes,
}

/// The mesh at a contact angle.
#[derive(Debug, Clone)]
pub(super) struct MovingMesh {
    layout: Layout,
    mesh: Mesh,
    alpha: f64,
    ring: [AtRing; 4],
    slopes: Vec<CellSlopes>,
    /// The angle at which `slopes` are valid.
    slopes_at: f64,
    volume_gradient: Vec<f64>,
}

/// The mesh at the angle at which it was last wanted. Threads that share a problem wait for each other.
#[derive(Debug)]
pub(super) struct Moving(Mutex<MovingMesh>);

impl Moving {
    pub(super) fn new(mesh: MovingMesh) -> Moving {
        Moving(Mutex::new(mesh))
    }

    pub(super) fn lock(&self) -> MutexGuard<'_, MovingMesh> {
        // a thread that panicked may have left it between two angles
        self.0.lock().unwrap_or_else(|poisoned| {
            let mut mesh = poisoned.into_inner();
            mesh.forget();
            mesh
        })
    }
}

impl Clone for Moving {
    fn clone(&self) -> Moving {
        Moving::new(self.lock().clone())
    }
}

impl MovingMesh {
    /// Makes the next angle a new one.
    fn forget(&mut self) {
        (self.alpha, self.slopes_at) = (f64::NAN, f64::NAN);
    }

    pub(super) fn new(layout: Layout, alpha: f64) -> MovingMesh {
        let mesh = layout.mesh(alpha);
        let zero =
            CellSlopes { basis: [[Lanes::ZERO; 4]; 3], weight: Lanes::ZERO, place: Lanes::ZERO };
        let cells = (0..mesh.elements()).map(|e| mesh.cells(e).len()).sum();
        let volume_gradient = vec![0.0; mesh.unknowns()];
        let mut moving = MovingMesh {
            layout,
            mesh,
            alpha,
            ring: [AtRing::default(); 4],
            slopes: vec![zero; cells],
            slopes_at: f64::NAN,
            volume_gradient,
        };
        moving.fill_ring();
        moving
    }

    /// The mesh with the ring at a valid angle.
    pub(super) fn at(&mut self, alpha: f64) -> (&Mesh, &[AtRing; 4]) {
        if alpha != self.alpha {
            let layout = &self.layout;
            self.mesh.move_knots(|j| layout.knot(j, alpha));
            self.alpha = alpha;
            self.fill_ring();
        }
        (&self.mesh, &self.ring)
    }

    /// Index of the element outside the ring.
    pub(super) fn outside(&self) -> usize {
        self.layout.ring + 1
    }

    fn fill_ring(&mut self) {
        let e = self.outside();
        let knots = self.mesh.knots();
        let here = Forward::new(self.alpha, 1.0);
        let basis = basis_over(|k| knot(knots, &self.layout, e as isize + k), here);
        for (j, entry) in self.ring.iter_mut().enumerate() {
            *entry = AtRing::default();
            let Some((unknown, sign)) = knots.slot(Component::W, e as isize - 1 + j as isize)
            else {
                continue;
            };
            let pair = |b: Forward<f64>| [sign * b.value, sign * b.slope];
            *entry = AtRing { unknown, height: pair(basis[0][j]), slope: pair(basis[1][j]) };
        }
    }

    fn fill_slopes(&mut self) {
        if self.slopes_at == self.alpha {
            return;
        }
        let knots = self.mesh.knots();
        let per_element = self.mesh.cells(0).len();
        let rule = self.mesh.rule();
        let none = [[Forward::new(0.0, 0.0); 4]; 4];
        for (index, out) in self.slopes.iter_mut().enumerate() {
            let (e, group) = (index / per_element, index % per_element);
            let t = |k: isize| knot(knots, &self.layout, e as isize + k);
            let length = t(1) - t(0);
            for lane in 0..WIDTH {
                let g = group * WIDTH + lane;
                let (x, weight) = rule[g.min(rule.len() - 1)];
                let s = t(0) + length * x;
                // nothing is summed over the element of no length
                let basis = if length.value > 0.0 { basis_over(t, s) } else { none };
                for k in 0..3 {
                    for j in 0..4 {
                        out.basis[k][j].0[lane] = basis[k][j].slope;
                    }
                }
                out.weight.0[lane] = if g < rule.len() { weight * length.slope } else { 0.0 };
                out.place.0[lane] = s.slope;
            }
        }
        self.slopes_at = self.alpha;
    }

    /// `out = ∂²E/∂x∂α`, the coefficients `x` fixed: how the gradient of the energy without the
    /// ring's own terms changes as everything moves with the angle. `x` is admissible.
    pub(super) fn angle_derivative<L: Membrane>(
        &mut self,
        law: &L,
        x: &[f64],
        c: &Coefficients,
        gas: &Gas,
        out: &mut [f64],
    ) {
        self.fill_slopes();
        let MovingMesh { mesh, slopes, volume_gradient, .. } = self;
        let per_element = mesh.cells(0).len();
        let places = |e: usize| {
            let local = mesh.local(x, e);
            let cells = mesh.cells(e).iter().zip(&slopes[e * per_element..]);
            cells.map(move |(cell, slopes)| MovingCell::new(cell, slopes, &local))
        };
        // the volume and its gradient v, and how both change
        volume_gradient.fill(0.0);
        out.fill(0.0);
        let (mut volume, mut volume_slope) = (0.0, 0.0);
        for e in 0..mesh.elements() {
            let (mut v, mut v_slope) = ([0.0; 8], [0.0; 8]);
            for cell in places(e) {
                let ([s, ..], [_, z1, _]) = (cell.place.s, cell.place.z);
                let ws = s * cell.site.weight;
                let by_z1 = ws * s * -0.5;
                let by_s = -(ws * z1);
                let part = by_z1 * z1;
                volume += part.value.sum();
                volume_slope += part.slope.sum();
                for j in 0..4 {
                    let [a, b] = [cell.basis[0][j] * by_s, cell.basis[1][j] * by_z1];
                    v[2 * j] += a.value.sum();
                    v[2 * j + 1] += b.value.sum();
                    v_slope[2 * j] += a.slope.sum();
                    v_slope[2 * j + 1] += b.slope.sum();
                }
            }
            mesh.scatter(e, &v, volume_gradient);
            mesh.scatter(e, &v_slope, out);
        }
        let (excess, stiffness) = (gas.excess(volume), gas.stiffness(volume));
        for (out, v) in out.iter_mut().zip(volume_gradient.iter()) {
            *out = stiffness * volume_slope * v - excess * *out;
        }
        for e in 0..mesh.elements() {
            let mut vector = [0.0; 8];
            for cell in places(e) {
                let g = density::gradient(law, &NoFilm, c, &cell.site, &cell.place);
                cell.add_slopes(&g, &mut vector);
            }
            mesh.scatter(e, &vector, out);
        }
    }
}

/// Knot `j` with its derivative in the angle, continued by reflection.
fn knot(knots: &Knots, layout: &Layout, j: isize) -> Forward<f64> {
    let n = knots.elements() as isize;
    let inside = |j: isize| {
        let j = j as usize;
        Forward::new(knots.at(j), layout.slope(j))
    };
    match j {
        j if j < 0 => -inside(-j),
        j if j > n => -inside(2 * n - j) + 2.0 * FRAC_PI_2,
        j => inside(j),
    }
}

/// Four Gauss points with all that moves.
struct MovingCell {
    basis: [[D; 4]; 3],
    site: Site<D>,
    place: Place<D>,
}

impl MovingCell {
    fn new(cell: &Cell, slopes: &CellSlopes, local: &Local) -> MovingCell {
        let basis: [[D; 4]; 3] = std::array::from_fn(|k| {
            std::array::from_fn(|j| D::new(cell.basis[k][j], slopes.basis[k][j]))
        });
        let weight = D::new(cell.weight, slopes.weight);
        let sin = D::new(cell.sin, cell.cos * slopes.place);
        let cos = D::new(cell.cos, -(cell.sin * slopes.place));
        let csc = D::new(cell.csc, -(cell.csc * cell.csc * cell.cos * slopes.place));
        let [(u, u_base), (w, w_base)] = local.parts();
        let dot = |k: usize, c: &[f64; 4]| {
            let b = &basis[k];
            b[0] * c[0] + b[2] * c[2] + b[3] * c[3]
        };
        let place = Place {
            s: [sin + dot(0, &u) + u_base, cos + dot(1, &u), dot(2, &u) - sin],
            z: [cos + dot(0, &w) + w_base, dot(1, &w) - sin, dot(2, &w) - cos],
        };
        MovingCell { basis, site: Site { weight, area: weight * sin, csc }, place }
    }

    fn add_slopes(&self, g: &Gradient<D>, out: &mut [f64; 8]) {
        let [n, n1, n2] = &self.basis;
        for j in 0..4 {
            let u = n[j] * g.s[0] + n1[j] * g.s[1] + n2[j] * g.s[2];
            let w = n[j] * g.z[0] + n1[j] * g.z[1] + n2[j] * g.z[2];
            out[2 * j] += u.slope.sum();
            out[2 * j + 1] += w.slope.sum();
        }
    }
}
