//! What the integrals of module [`crate::energy`] need to know of half a meridian.
//!
//! The shell that is its own mirror image is one half, its [`Mesh`]; a shell without that symmetry
//! is two ([`crate::two_plates::Half`]), with the same elements and other neighbours at the equator.
//! In either the distance from the pole runs upwards from 0 and the height is that above the
//! equator's reference plane, towards the half's own pole: densities and checks are the same.

use crate::meridian::{Cell, Local, Mesh, Place};
use crate::spline::Knots;
use continuation::linalg::SymmetricBand;

/// Half a meridian, from a pole to the equator.
pub trait HalfMeridian {
    /// Elements, Gauss points and knots.
    fn mesh(&self) -> &Mesh;

    /// The four coefficients of `u` and of `w` that element `e` sees, end conditions folded in.
    fn gather(&self, x: &[f64], e: usize) -> ([f64; 4], [f64; 4]);

    /// Adds the element vector `local` (ordered `u, w` by function) to `out`.
    fn scatter(&self, e: usize, local: &[f64; 8], out: &mut [f64]);

    /// Adds the element matrix `local`, stored `[column][row]` for `row ≥ column`, to `out`.
    fn scatter_matrix(&self, e: usize, local: &[[f64; 8]; 8], out: &mut SymmetricBand);

    /// The height that no point may lie below: that of the mirror image, if there is one.
    fn floor(&self) -> f64;

    /// Number of elements.
    #[inline(always)]
    fn elements(&self) -> usize {
        self.mesh().elements()
    }

    /// Gauss points per element.
    #[inline(always)]
    fn gauss_points(&self) -> usize {
        self.mesh().gauss_points()
    }

    /// The knots.
    #[inline(always)]
    fn knots(&self) -> &Knots {
        self.mesh().knots()
    }

    /// The Gauss points of element `e`.
    #[inline(always)]
    fn cells(&self, e: usize) -> &[Cell] {
        self.mesh().cells(e)
    }

    /// Cosine of knot `j`, the largest in element `j`.
    #[inline(always)]
    fn cos_knot(&self, j: usize) -> f64 {
        self.mesh().cos_knot(j)
    }

    /// The coefficients element `e` sees.
    #[inline(always)]
    fn local(&self, x: &[f64], e: usize) -> Local {
        Local::new(self.gather(x, e))
    }

    /// `(u, w)` and three derivatives at `S` in element `e`.
    fn displacement_in(&self, x: &[f64], e: usize, s: f64) -> [(f64, f64); 4] {
        self.local(x, e).displacement(&self.knots().basis(e, s))
    }

    /// The deformed meridian at any `S`.
    fn place(&self, x: &[f64], s: f64) -> Place<f64> {
        let d = self.displacement_in(x, self.knots().element_of(s), s);
        let (sin, cos) = s.sin_cos();
        Place {
            s: [sin + d[0].0, cos + d[1].0, d[2].0 - sin],
            z: [cos + d[0].1, d[1].1 - sin, d[2].1 - cos],
        }
    }
}

/// The half of a shell that is its own mirror image.
impl HalfMeridian for Mesh {
    #[inline(always)]
    fn mesh(&self) -> &Mesh {
        self
    }

    #[inline(always)]
    fn gather(&self, x: &[f64], e: usize) -> ([f64; 4], [f64; 4]) {
        Mesh::knots(self).gather(x, e)
    }

    #[inline(always)]
    fn scatter(&self, e: usize, local: &[f64; 8], out: &mut [f64]) {
        Mesh::scatter(self, e, local, out);
    }

    #[inline(always)]
    fn scatter_matrix(&self, e: usize, local: &[[f64; 8]; 8], out: &mut SymmetricBand) {
        Mesh::scatter_matrix(self, e, local, out);
    }

    #[inline(always)]
    fn floor(&self) -> f64 {
        0.0
    }
}
