//! Derivatives of the Jacobian along a direction, multiplied from the left.
//!
//! `d/dε [f_u(u + εv)ᵀ w, f_p(u + εv), f_q(u + εv)]` by central differences of exact derivatives
//! over four points. The order-two difference from the inner points tells the truncation error
//! (about the square of how far the two orders are apart), by which the step adapts: it depends on
//! neither the unit of `u` nor that of `f`.

use crate::any_problem::DynProblem;
use crate::linalg::{AnyMatrix, Matrix, max_abs};
use crate::problem::{EvalError, ParamId, check_finite};

/// Where the difference evaluates, in steps; its weights of order four and two.
const PLACES: [(f64, f64, f64); 4] = [
    (1.0, 8.0 / 12.0, 0.5),
    (-1.0, -8.0 / 12.0, -0.5),
    (2.0, -1.0 / 12.0, 0.0),
    (-2.0, 1.0 / 12.0, 0.0),
];
/// Disagreement of the orders that is aimed at: the higher one is right to about its square.
const AIM: f64 = 3e-6;
/// Disagreement above which the step is sought anew.
const POOR: f64 = 2e-5;
/// Disagreement below which the step may grow.
const FINE: f64 = 1e-8;
/// Longest step, in units of the direction.
const LONGEST: f64 = 0.1;

/// A direction of unknowns and first parameter, and the multiple of it that is a natural unit.
#[derive(Clone, Copy)]
pub(super) struct Along<'v> {
    pub(super) u: &'v [f64],
    pub(super) p: f64,
    pub(super) unit: f64,
}

/// The step of a difference along a curve, `step` in its scales, but no more of the second parameter
/// than that part of its value: it may be one that has to be positive.
pub(super) fn slope_step(step: f64, q: f64, dq: f64) -> f64 {
    let most = step * (q / dq).abs();
    if most > 0.0 { step.min(most.max(1e-4 * step)) } else { step }
}

/// Work space of the differences along one direction.
#[derive(Clone)]
pub(super) struct Differences {
    shifted: AnyMatrix,
    place: Vec<f64>,
    p: Vec<f64>,
    value: Vec<f64>,
    /// Step, in units of the direction; 0 until it is known.
    step: f64,
    /// For each left vector, then for each parameter: the derivative.
    pub(super) derivatives: Vec<Vec<f64>>,
    lower: Vec<Vec<f64>>,
    /// Largest value that was differenced, of the left products.
    size: f64,
    /// Estimated error, relative to the largest component of the left products' derivatives.
    pub(super) error: f64,
    lefts: usize,
    parameters: Vec<ParamId>,
}

impl Differences {
    pub(super) fn new(problem: &DynProblem<'_>, lefts: usize, parameters: &[ParamId]) -> Self {
        let n = problem.dim();
        let all = lefts + parameters.len();
        Differences {
            shifted: problem.new_jacobian(),
            place: vec![0.0; n],
            p: vec![0.0; problem.parameters().len()],
            value: vec![0.0; n],
            step: 0.0,
            derivatives: vec![vec![0.0; n]; all],
            lower: vec![vec![0.0; n]; all],
            size: 0.0,
            error: 0.0,
            lefts,
            parameters: parameters.to_vec(),
        }
    }

    /// Computes the derivatives along `v`. The first of the parameters is the one that varies with
    /// it.
    pub(super) fn along(
        &mut self,
        problem: &DynProblem<'_>,
        (u, p): (&[f64], &[f64]),
        v: Along<'_>,
        lefts: &[&[f64]],
    ) -> Result<(), EvalError> {
        let mut apart = f64::INFINITY;
        if self.step > 0.0
            && let Ok(found) = self.differ(problem, (u, p), v, lefts)
        {
            apart = found;
        }
        if apart > POOR {
            self.search(problem, (u, p), v, lefts)?;
        } else if apart < FINE {
            self.step = (1.25 * self.step).min(LONGEST);
        }
        Ok(())
    }

    /// Steps ever shorter, then longer ones, until the orders agree; else the best one.
    fn search(
        &mut self,
        problem: &DynProblem<'_>,
        at: (&[f64], &[f64]),
        v: Along<'_>,
        lefts: &[&[f64]],
    ) -> Result<(), EvalError> {
        let (mut best, mut least) = (0.0, f64::INFINITY);
        let mut failure = EvalError::NotFinite { at: 0 };
        let half_decades = (0..=16).map(|k| -k).chain(1..=12);
        for k in half_decades {
            self.step = LONGEST * 10f64.powf(0.5 * f64::from(k));
            match self.differ(problem, at, v, lefts) {
                Ok(apart) if apart <= AIM => return Ok(()),
                Ok(apart) if apart < least => (best, least) = (self.step, apart),
                Ok(_) => {}
                Err(error) => failure = error,
            }
        }
        self.step = best;
        if least.is_finite() {
            self.differ(problem, at, v, lefts)?;
            return Ok(());
        }
        Err(failure)
    }

    /// The differences with the present step; how far the two orders are apart.
    fn differ(
        &mut self,
        problem: &DynProblem<'_>,
        (u, p): (&[f64], &[f64]),
        v: Along<'_>,
        lefts: &[&[f64]],
    ) -> Result<f64, EvalError> {
        let h = self.step * v.unit;
        for part in self.derivatives.iter_mut().chain(&mut self.lower) {
            part.fill(0.0);
        }
        self.size = 0.0;
        // the products nearly vanish; their rounding is that of the terms
        let mut terms = 0.0_f64;
        for (place, fourth, second) in PLACES {
            for ((x, u), v) in self.place.iter_mut().zip(u).zip(v.u) {
                *x = u + place * h * v;
            }
            self.p.copy_from_slice(p);
            self.p[self.parameters[0].0] += place * h * v.p;
            problem.jacobian(&self.place, &self.p, &mut self.shifted)?;
            let largest = lefts.iter().map(|left| max_abs(left)).fold(0.0, f64::max);
            terms = terms.max(self.shifted.norm() * largest);
            for k in 0..self.derivatives.len() {
                match k.checked_sub(self.lefts) {
                    None => self.shifted.mul_transpose(lefts[k], &mut self.value),
                    Some(i) => {
                        let which = self.parameters[i];
                        let at = (&self.place, &self.p);
                        problem.parameter_derivative(at.0, at.1, which, &mut self.value)?;
                    }
                }
                check_finite(&self.value)?;
                if k < self.lefts {
                    self.size = self.size.max(max_abs(&self.value));
                }
                let parts = self.derivatives[k].iter_mut().zip(&mut self.lower[k]);
                for ((d, l), x) in parts.zip(&self.value) {
                    *d += fourth / h * x;
                    *l += second / h * x;
                }
            }
        }
        let (mut apart, mut largest) = (0.0_f64, 0.0_f64);
        for (d, l) in self.derivatives[..self.lefts].iter().zip(&self.lower) {
            for (d, l) in d.iter().zip(l) {
                apart = apart.max((d - l).abs());
                largest = largest.max(d.abs());
            }
        }
        let noise = f64::EPSILON * self.size / h;
        let rounding = f64::EPSILON * terms.max(self.size) / h;
        self.error =
            if largest > 0.0 { (apart / largest).powi(2) + rounding / largest } else { 0.0 };
        // what rounding explains says nothing against the step
        let real = if apart <= 8.0 * noise { 0.0 } else { apart };
        Ok(if largest > 0.0 { real / largest } else { 0.0 })
    }
}
