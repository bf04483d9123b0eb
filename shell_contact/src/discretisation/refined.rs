//! How far the discrete shell is from the continuous one, by a mesh twice as fine.
//!
//! A spline on the mesh is one on the mesh whose elements are halved (`Knots` are inserted), but no
//! equilibrium there. One Newton correction in the plane across the branch makes it one, up to the square of
//! what it moves: `(Δu, Δz0)` and the force there are what halving changes. Cubic splines converge
//! at the fourth order in `z0` and force, so that all further halvings together change 1/15 of it.
//!
//! At an ordinary point the state is brought back to the plate's height along the branch and by one more correction:
//! beside a fold the changes at either end of that way nearly cancel, and to first order little is left of them.
//! At a fold the plate's height is stationary along the branch: its change in the plane is that of the fold, to
//! first order. So is the force at its extrema. Where along the branch either lies is more sensitive, and with it the force
//! at a fold and the plate distance at an extremum: nothing is said of these.

use crate::contact::{ContactProblem, parameter};
use crate::meridian::Mesh;
use crate::params::ParameterError;
use crate::spline::{Component, Knots};
use continuation::linalg::{Bordered, Matrix, SymmetricBand};
use continuation::{EvalError, EventKind, Problem};

/// All further halvings together, at the fourth order.
const REST: f64 = 16.0 / 15.0;

/// A second correction is no larger than this part of the first, and of the way along the branch.
const SMALL: f64 = 0.1;

/// Place of the force among the observables.
const FORCE: usize = 0;

/// What halving the elements changes, as an estimate of the mesh's error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shift {
    /// Of the plate distance: of a fold, of a zero of the force; elsewhere at the same force.
    pub z0: Option<f64>,
    /// Of the force: of an extremum of the force; elsewhere at the same plate distance.
    pub force: Option<f64>,
}

/// A contact problem on its mesh and on one twice as fine.
#[derive(Debug)]
pub struct Refined<'a> {
    coarse: &'a ContactProblem,
    fine: ContactProblem,
    jacobian: SymmetricBand,
    bordered: Bordered,
    u: Vec<f64>,
    residual: Vec<f64>,
    tangent: Vec<f64>,
    by_height: f64,
}

/// What one correction found: changes of the plate's height and of the force in the plane across the
/// branch, and the slope of the force along it.
struct Corrected {
    z0: f64,
    force: f64,
    slope: f64,
    /// Of the correction.
    length: f64,
}

/// What is stationary, or given, at a place.
enum Place {
    Ordinary,
    Fold,
    Zero,
    Extremum,
}

impl<'a> Refined<'a> {
    /// The problem and its refinement.
    ///
    /// # Errors
    /// When the refined mesh is not one, its elements being too short.
    pub fn new(coarse: &'a ContactProblem) -> Result<Refined<'a>, ParameterError> {
        let mesh = halved(coarse.mesh())?;
        let fine =
            ContactProblem::with_potential(coarse.shell(), coarse.groups(), mesh, coarse.film())?;
        let n = fine.dim();
        let (jacobian, bordered) = (fine.new_jacobian(), Bordered::new(n, 1));
        let zero = || vec![0.0; n];
        let (u, residual, tangent) = (zero(), zero(), zero());
        Ok(Refined { coarse, fine, jacobian, bordered, u, residual, tangent, by_height: 1.0 })
    }

    /// What halving changes at an equilibrium `u` with parameters `p`, which is a special point of this kind, if it
    /// is one; `None` for a kind of which this says nothing.
    ///
    /// # Errors
    /// When a state is not admissible.
    pub fn shift(
        &mut self,
        u: &[f64],
        p: &[f64],
        kind: Option<&EventKind>,
    ) -> Result<Option<Shift>, EvalError> {
        let place = match kind {
            None => Place::Ordinary,
            Some(EventKind::Fold) => Place::Fold,
            Some(EventKind::Zero(name)) if name == "force" => Place::Zero,
            Some(EventKind::Minimum(name) | EventKind::Maximum(name)) if name == "force" => {
                Place::Extremum
            }
            Some(EventKind::Named(name)) if name == crate::trace::PULL_OFF => Place::Extremum,
            Some(_) => return Ok(None),
        };
        let force = self.coarse.observation(u, p)?.force;
        self.insert_knots(u);
        self.take_tangent(p)?;
        let found = self.correct(p, force)?;
        let rest = |x: f64| Some((REST * x).abs()).filter(|x| x.is_finite());
        // to first order along the branch, back to the same force
        let at_same_force = rest(found.z0 - self.by_height * found.force / found.slope);
        let at_same_height = match place {
            Place::Ordinary => self.at_same_height(p, force, &found)?.and_then(rest),
            _ => None,
        };
        Ok(Some(match place {
            Place::Ordinary => Shift { z0: at_same_force, force: at_same_height },
            Place::Zero => Shift { z0: at_same_force, force: None },
            Place::Fold => Shift { z0: rest(found.z0), force: None },
            Place::Extremum => Shift { z0: None, force: rest(found.force) },
        }))
    }

    /// The direction of the branch at `self.u`, of length 1.
    fn take_tangent(&mut self, p: &[f64]) -> Result<(), EvalError> {
        self.assemble(p)?;
        // at a fold the band is singular, and this is its null vector all the same
        self.bordered.row_mut(0).fill(0.0);
        self.bordered.set_corner(0, 0, 1.0);
        self.bordered.factor(&mut self.jacobian);
        self.solve_tangent();
        Ok(())
    }

    fn solve_tangent(&mut self) {
        let mut height = [1.0];
        self.tangent.fill(0.0);
        self.bordered.solve(&mut self.jacobian, &mut self.tangent, &mut height);
        self.fine.metric(&self.tangent, self.bordered.row_mut(0));
        let along = self.bordered.row(0).iter().zip(&self.tangent);
        let size = along.map(|(m, t)| m * t).sum::<f64>() + height[0] * height[0];
        let scale = size.sqrt().recip();
        self.tangent.iter_mut().for_each(|t| *t *= scale);
        self.by_height = height[0] * scale;
    }

    /// Moves `self.u` and the plate in the plane across the branch; the change of the force is that from `force`.
    fn correct(&mut self, p: &[f64], force: f64) -> Result<Corrected, EvalError> {
        self.fine.metric(&self.tangent, self.bordered.row_mut(0));
        self.bordered.set_corner(0, 0, self.by_height);
        self.bordered.factor(&mut self.jacobian);
        let mut moved = [0.0];
        self.bordered.solve(&mut self.jacobian, &mut self.residual, &mut moved);
        self.u.iter_mut().zip(&self.residual).for_each(|(u, d)| *u -= d);
        let mut along = vec![0.0; self.u.len()];
        self.fine.metric(&self.residual, &mut along);
        let length = along.iter().zip(&self.residual).map(|(m, d)| m * d).sum::<f64>();
        let mut p = p.to_vec();
        p[parameter::Z0.0] -= moved[0];
        self.solve_tangent();
        let slope = self.fine.observable_slope(
            FORCE,
            &self.u,
            &p,
            parameter::Z0,
            &self.tangent,
            self.by_height,
        )?;
        let there = self.fine.observation(&self.u, &p)?.force;
        let slope = slope.unwrap_or(f64::NAN);
        let length = length.max(0.0).sqrt();
        Ok(Corrected { z0: -moved[0], force: there - force, slope, length })
    }

    /// How far the force is from `force` where the plate is back at its height: along the branch, and once across it.
    /// `None` where that correction is no small part of the way, beside a fold that halving moves as far.
    fn at_same_height(
        &mut self,
        p: &[f64],
        force: f64,
        found: &Corrected,
    ) -> Result<Option<f64>, EvalError> {
        let along = -found.z0 / self.by_height;
        self.u.iter_mut().zip(&self.tangent).for_each(|(u, t)| *u += along * t);
        if self.assemble(p).is_err() {
            return Ok(None);
        }
        self.jacobian.factor(f64::EPSILON * self.jacobian.norm());
        self.jacobian.solve(&mut self.residual);
        self.u.iter_mut().zip(&self.residual).for_each(|(u, d)| *u -= d);
        self.fine.metric(&self.residual, self.bordered.row_mut(0));
        let across = self.bordered.row(0).iter().zip(&self.residual);
        let across = across.map(|(m, d)| m * d).sum::<f64>().max(0.0).sqrt();
        if across.is_nan() || across > SMALL * along.abs().max(found.length) {
            return Ok(None);
        }
        Ok(Some(self.fine.observation(&self.u, p)?.force - force))
    }

    fn assemble(&mut self, p: &[f64]) -> Result<(), EvalError> {
        self.fine.linearise(&self.u, p, &mut self.residual, &mut self.jacobian)?;
        let column = self.bordered.column_mut(0);
        self.fine.parameter_derivative(&self.u, p, parameter::Z0, column)
    }

    /// Sets `self.u` to the same spline on the finer knots: its coefficient at a knot is the polar form at that knot and
    /// its two neighbours.
    fn insert_knots(&mut self, u: &[f64]) {
        let (coarse, fine) = (self.coarse.mesh(), self.fine.mesh().knots());
        for j in 0..=fine.elements() {
            // the element to the right of an old knot, or that in which a new one lies
            let e = (j / 2).min(coarse.elements() - 1);
            let at = fine.at(j);
            let polar = polar_form(&coarse.displacement_in(u, e, at), neighbours(fine, j));
            for (component, value) in [(Component::U, polar.0), (Component::W, polar.1)] {
                if let Some((i, sign)) = fine.slot(component, j as isize) {
                    self.u[i] = sign * value;
                }
            }
        }
    }
}

/// Distances from knot `j` to the ones before and behind it, as the knots are continued.
fn neighbours(knots: &Knots, j: usize) -> [f64; 2] {
    let before = if j > 0 { knots.at(j) - knots.at(j - 1) } else { knots.at(1) - knots.at(0) };
    let last = knots.elements();
    let behind = if j < last { knots.at(j + 1) - knots.at(j) } else { before };
    [-before, behind]
}

/// The polar form of a cubic at the place of its derivatives and at two distances from there.
fn polar_form(d: &[(f64, f64); 4], [a, b]: [f64; 2]) -> (f64, f64) {
    let of = |value: f64, first: f64, second: f64| {
        value + first * (a + b) / 3.0 + second * (a * b) / 6.0
    };
    (of(d[0].0, d[1].0, d[2].0), of(d[0].1, d[1].1, d[2].1))
}

/// Every element in two.
fn halved(mesh: &Mesh) -> Result<Mesh, ParameterError> {
    let knots = mesh.knots();
    let middle = |e: usize| 0.5 * (knots.at(e) + knots.at(e + 1));
    let mut finer = Vec::with_capacity(2 * knots.elements() + 1);
    for e in 0..knots.elements() {
        finer.extend([knots.at(e), middle(e)]);
    }
    finer.push(knots.at(knots.elements()));
    Mesh::from_knots(&finer)?.with_gauss_points(mesh.gauss_points())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::close;
    use crate::params::{Dimensionless, Law, Shell};
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn inserted_knots_change_nothing() {
        let groups = Dimensionless {
            bending: 3e-5,
            pressure: 3e-3,
            adhesion: 2e-3,
            film: 1.0 / 30.0,
            surface_tension: 0.0,
            gas_exponent: 1.07,
        };
        let shell = Shell { law: Law::Hooke, poisson: 0.5 };
        for grading in [1.0, 6.0] {
            let mesh = Mesh::graded(13, grading).unwrap();
            let problem = ContactProblem::new(&shell, &groups, mesh).unwrap();
            let u: Vec<f64> = (0..problem.dim()).map(|i| (1.0 + 1.7 * i as f64).sin()).collect();
            let mut refined = Refined::new(&problem).unwrap();
            refined.insert_knots(&u);
            for k in 0..=500 {
                let s = FRAC_PI_2 * f64::from(k) / 500.0;
                let (was, is) =
                    (problem.mesh().place(&u, s), refined.fine.mesh().place(&refined.u, s));
                for (a, b) in was.s.iter().chain(&was.z).zip(is.s.iter().chain(&is.z)) {
                    close(*a, *b, 1e-10, 1e-11);
                }
            }
        }
    }
}
