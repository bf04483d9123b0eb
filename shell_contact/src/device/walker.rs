//! Tangents and corrections on the curve of equilibria in the space of shell and plate height,
//! where it has no folds of any device, or of shell and a device's parameter.

use super::Loading;
use crate::contact::parameter;
use continuation::linalg::Arrow;
use continuation::{EvalError, Matrix};

/// A place on the curve: shell and plate.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Place {
    pub(super) u: Vec<f64>,
    pub(super) z0: f64,
}

/// The unit tangent of the curve, in the metric `du·M du + dz0²`, and the force's slope along it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tangent {
    pub(super) du: Vec<f64>,
    pub(super) dz0: f64,
    pub(super) dforce: f64,
}

/// Most corrections of a state.
const MOST: usize = 20;
/// Corrections shorter than this have converged.
const CONVERGED: f64 = 1e-13;

pub(super) struct Walker<'c, P: Loading> {
    problem: &'c P,
    p: Vec<f64>,
    matrix: Arrow<P::Jacobian>,
    x: Vec<f64>,
    /// `M` times the direction by which states are compared, and its part of the plate.
    row: Vec<f64>,
}

impl<'c, P: Loading> Walker<'c, P> {
    pub(super) fn new(problem: &'c P) -> Self {
        let n = problem.dim();
        Walker {
            problem,
            p: problem.parameters_at(1.0),
            matrix: Arrow::new(problem.new_jacobian(), 1),
            x: vec![0.0; n + 1],
            row: vec![0.0; n + 1],
        }
    }

    /// `√k_b`.
    pub(super) fn root(&self) -> f64 {
        self.problem.root(&self.p)
    }

    pub(super) fn force(&mut self, at: &Place) -> Result<f64, EvalError> {
        self.p[0] = at.z0;
        self.problem.mean_force(&at.u, &self.p)
    }

    /// Directions are compared with this one from now on.
    pub(super) fn look_along(&mut self, du: &[f64], dz0: f64) {
        let n = du.len();
        self.problem.metric(du, &mut self.row[..n]);
        self.row[n] = dz0;
    }

    /// Length of the direction with which [`Self::look_along`] was called last.
    pub(super) fn size_of(&self, du: &[f64], dz0: f64) -> f64 {
        (dot(&self.row[..du.len()], du) + dz0 * dz0).max(0.0).sqrt()
    }

    /// The same, with the direction from one place to another; its length.
    pub(super) fn look_from_to(&mut self, from: &Place, to: &Place) -> f64 {
        let du: Vec<f64> = to.u.iter().zip(&from.u).map(|(a, b)| a - b).collect();
        let dz0 = to.z0 - from.z0;
        self.look_along(&du, dz0);
        self.size_of(&du, dz0)
    }

    /// Fills the matrix at a place: the Hessian bordered with the plate's column and the direction.
    fn assemble(&mut self, at: &Place) -> Result<(), EvalError> {
        let n = at.u.len();
        self.p[0] = at.z0;
        self.problem.linearise(&at.u, &self.p, &mut self.x[..n], self.matrix.core_mut())?;
        let column = self.matrix.column_mut(0);
        self.problem.parameter_derivative(&at.u, &self.p, parameter::Z0, column)?;
        self.matrix.row_mut(0).copy_from_slice(&self.row[..n]);
        self.matrix.set_corner(0, 0, self.row[n]);
        self.matrix.factor(f64::EPSILON);
        Ok(())
    }

    /// The tangent at a place, along the direction rather than against it.
    pub(super) fn tangent(&mut self, at: &Place) -> Result<Tangent, EvalError> {
        let n = at.u.len();
        self.assemble(at)?;
        self.x[..n].fill(0.0);
        self.x[n] = 1.0;
        self.matrix.solve(&mut self.x);
        let (mut du, mut dz0) = (self.x[..n].to_vec(), self.x[n]);
        let mut m = vec![0.0; n];
        self.problem.metric(&du, &mut m);
        let size = (dot(&m, &du) + dz0 * dz0).sqrt();
        du.iter_mut().for_each(|d| *d /= size);
        dz0 /= size;
        let dforce = self.problem.mean_force_along(&at.u, &self.p, &du, dz0)?;
        Ok(Tangent { du, dz0, dforce })
    }

    /// The state of the curve in the plane normal to the direction at this distance from `base`,
    /// starting from `at`; `None` if there is none near.
    pub(super) fn correct(&mut self, base: &Place, distance: f64, at: &mut Place) -> Option<()> {
        let n = base.u.len();
        let mut last = f64::INFINITY;
        for _ in 0..MOST {
            self.assemble(at).ok()?;
            let along: f64 =
                self.row.iter().zip(at.u.iter().zip(&base.u)).map(|(m, (a, b))| m * (a - b)).sum();
            self.x[n] = along + self.row[n] * (at.z0 - base.z0) - distance;
            self.matrix.solve(&mut self.x);
            for (u, d) in at.u.iter_mut().zip(&self.x) {
                *u -= d;
            }
            at.z0 -= self.x[n];
            let size = self.x.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
            if size < CONVERGED || (size < 1e3 * CONVERGED && size > 0.3 * last) {
                return Some(());
            }
            if size.is_nan() || size > 2.0 * last {
                return None;
            }
            last = size;
        }
        None
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
