//! Where a branch wants short elements, and the mesh on which it is followed to a tolerance.
//!
//! Cubic splines miss the energy of bending by `π k_b ∫ h⁴ w⁗²/720 sin S dS`, as piecewise linear functions
//! miss `w″`. Its derivative along the branch is the error of the force, in `√(χk_b)`:
//!
//! `δF = (2π √k_b / 720) ∫ h⁴ w⁗ t⁗ sin S dS`, `t = dw/dz0`.
//!
//! On a steep part `t` is the derivative by the force, and the same integral the error of the plate distance; at
//! a fold that of the fold, for there `t` is the mode that loses its stability. One mesh serves the whole branch:
//! elements as long as `(Σ λ |w⁗ t⁗|)^{-1/5}`, the sum over the states with weights `λ` of those whose errors
//! are largest, make the largest error least for their number. A floor keeps them short enough for the shell's
//! wavelength. This is a plan: what is known of the error is what [`Refined`](super::Refined) finds.

use crate::contact::ContactProblem;
use crate::meridian::Mesh;
use crate::params::ParameterError;
use crate::resolution::FEWEST_PER_WAVELENGTH;
use std::f64::consts::{FRAC_PI_2, TAU};

/// `(w″ - its best piecewise linear function)²` integrates to `h⁵ w⁗²/720` over an element.
const BEST_LINEAR: f64 = 720.0;

/// Elements per wavelength at least, with something to spare.
const PER_WAVELENGTH: f64 = 1.02 * FEWEST_PER_WAVELENGTH;

/// The planned error is this part of the tolerance: the plan sees bending alone.
const PART: f64 = 0.3;

/// Elements per length fall to `1/e` within this part of a wavelength at the earliest: neighbours are about as long.
const FADES: f64 = 0.25;

/// Rounds in which the weights of the states are found.
const ROUNDS: usize = 40;

/// A state of a branch on a coarse mesh.
#[derive(Debug, Clone, Copy)]
pub struct Place<'a> {
    /// The unknowns of the shell.
    pub u: &'a [f64],
    /// Plate distance, in `R0`.
    pub z0: f64,
    /// Force, in `√(χk_b)`.
    pub force: f64,
}

/// What a branch that was followed on a coarse mesh asks of a finer one.
#[derive(Debug, Clone)]
pub struct Demand {
    /// Elements of the coarse mesh.
    cells: Vec<Cell>,
    /// `δF / h⁴` of every step of the branch, per length, by element of the coarse mesh.
    steps: Vec<Vec<f64>>,
    /// Elements per length, up to a factor.
    density: Vec<f64>,
    /// Elements per length at least.
    least: f64,
    /// Within which length the density falls to `1/e` at the earliest.
    fade: f64,
}

/// An element of the coarse mesh.
#[derive(Debug, Clone, Copy)]
struct Cell {
    start: f64,
    length: f64,
}

/// No mesh for a tolerance.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ToleranceError {
    /// The tolerance is too small.
    #[error(
        "a mesh error of {tolerance:e} takes {elements:.0} elements; at most {most} are allowed"
    )]
    TooManyElements {
        /// The tolerance.
        tolerance: f64,
        /// Elements that it takes.
        elements: f64,
        /// How many are allowed.
        most: usize,
    },
    /// The elements are too short to be told apart.
    #[error(transparent)]
    Mesh(#[from] ParameterError),
}

impl Demand {
    /// From the states of a branch of `problem`, in their order.
    pub fn along<'a>(
        problem: &ContactProblem,
        branch: impl IntoIterator<Item = Place<'a>>,
    ) -> Demand {
        let knots = problem.mesh().knots();
        let cell = |e| Cell { start: knots.at(e), length: knots.at(e + 1) - knots.at(e) };
        let cells: Vec<Cell> = (0..knots.elements()).map(cell).collect();
        let branch: Vec<Place<'_>> = branch.into_iter().collect();
        let bending = problem.groups().bending;
        let wavelength = TAU * bending.sqrt().sqrt();
        let mut demand = Demand {
            steps: steps(problem.mesh(), &cells, &branch, bending),
            density: vec![1.0; cells.len()],
            least: PER_WAVELENGTH / wavelength,
            fade: FADES * wavelength,
            cells,
        };
        demand.share_out();
        demand
    }

    /// The same with so many elements per length at least.
    #[must_use]
    pub fn with_at_least(self, elements_per_length: f64) -> Demand {
        Demand { least: self.least.max(elements_per_length), ..self }
    }

    /// The mesh with the fewest elements on which the planned error is a part of `tolerance`: of the force at a given plate
    /// distance, or of the plate distance at a given force times the ratio of their ranges where that is less.
    ///
    /// # Errors
    /// When that takes more than `most` elements.
    pub fn mesh(&self, tolerance: f64, most: usize) -> Result<Mesh, ToleranceError> {
        let is_enough = |factor: f64| self.largest_error(factor) <= PART * tolerance;
        let (mut low, mut high) = (0.0, 1.0);
        while !is_enough(high) && self.elements(high) <= most as f64 {
            (low, high) = (high, 2.0 * high);
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if is_enough(middle) { high = middle } else { low = middle }
        }
        let elements = self.elements(high).ceil();
        if !is_enough(high) || elements > most as f64 {
            return Err(ToleranceError::TooManyElements { tolerance, elements, most });
        }
        Ok(Mesh::from_knots(&self.knots(high, elements as usize))?)
    }

    /// Finds the density that makes the largest error least for its number of elements: the weight of a state
    /// grows where its error is the largest.
    fn share_out(&mut self) {
        let mut weights = vec![1.0_f64; self.steps.len()];
        let mut sum = vec![0.0_f64; self.cells.len()];
        for _ in 0..ROUNDS {
            sum.fill(0.0);
            for (step, weight) in self.steps.iter().zip(&weights) {
                sum.iter_mut().zip(step).for_each(|(sum, error)| *sum += weight * error);
            }
            self.density.iter_mut().zip(&sum).for_each(|(density, sum)| *density = sum.powf(0.2));
            self.fade_out();
            // the error is that of h⁴ alone here, whatever the number of elements
            let errors: Vec<f64> =
                self.steps.iter().map(|step| self.error(step, 1.0, 0.0)).collect();
            let largest = errors.iter().copied().fold(0.0, f64::max);
            if largest == 0.0 {
                self.density.fill(1.0);
                return;
            }
            weights.iter_mut().zip(&errors).for_each(|(w, error)| *w *= (error / largest).sqrt());
            let all: f64 = weights.iter().sum();
            weights.iter_mut().for_each(|weight| *weight = (*weight / all).max(1e-9));
        }
    }

    /// Raises the density where it falls too fast.
    fn fade_out(&mut self) {
        let Demand { cells, density, fade, .. } = self;
        let kept = |e: usize| (-cells[e].length / *fade).exp();
        for e in 1..density.len() {
            density[e] = density[e].max(density[e - 1] * kept(e));
        }
        for e in (1..density.len()).rev() {
            density[e - 1] = density[e - 1].max(density[e] * kept(e - 1));
        }
    }

    /// Elements per length in each cell.
    fn densities(&self, factor: f64, least: f64) -> impl Iterator<Item = (&Cell, f64)> {
        self.cells.iter().zip(self.density.iter().map(move |density| (factor * density).max(least)))
    }

    fn elements(&self, factor: f64) -> f64 {
        self.densities(factor, self.least).map(|(cell, density)| density * cell.length).sum()
    }

    /// The planned error of a step.
    fn error(&self, step: &[f64], factor: f64, least: f64) -> f64 {
        let each = self.densities(factor, least).zip(step);
        each.map(|((cell, density), error)| error * cell.length / density.powi(4)).sum()
    }

    fn largest_error(&self, factor: f64) -> f64 {
        self.steps.iter().map(|step| self.error(step, factor, self.least)).fold(0.0, f64::max)
    }

    /// Knots that share out the integral of the density equally.
    fn knots(&self, factor: f64, elements: usize) -> Vec<f64> {
        let each = self.elements(factor) / elements as f64;
        let mut knots = Vec::with_capacity(elements + 1);
        let mut before = 0.0;
        for (cell, density) in self.densities(factor, self.least) {
            let here = density * cell.length;
            while knots.len() < elements {
                let share = each * knots.len() as f64 - before;
                if share > here {
                    break;
                }
                knots.push(cell.start + share / density);
            }
            before += here;
        }
        knots.push(FRAC_PI_2);
        knots
    }
}

/// What every step of the branch asks for.
fn steps(mesh: &Mesh, cells: &[Cell], branch: &[Place<'_>], bending: f64) -> Vec<Vec<f64>> {
    let span = |value: fn(&Place<'_>) -> f64| {
        let values = || branch.iter().map(value);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    };
    let ratio = span(|place| place.force) / span(|place| place.z0);
    let ratio = if ratio.is_finite() && ratio > 0.0 { ratio } else { 1.0 };
    // where the distance counts, its error does in R0 too, should that be the larger number
    let scale = TAU * bending.sqrt() / BEST_LINEAR * ratio.max(1.0);
    let mut steps = Vec::new();
    for ends in branch.windows(2) {
        let [from, to] = ends else { continue };
        let length = (ratio * (to.z0 - from.z0)).hypot(to.force - from.force);
        if length > 1e-12 {
            let change: Vec<f64> = from.u.iter().zip(to.u).map(|(a, b)| b - a).collect();
            let each = fourth(mesh, to.u).into_iter().zip(fourth(mesh, &change)).zip(cells);
            let error = |((w, t), cell): ((f64, f64), &Cell)| {
                scale * w * t / length * (cell.start + 0.5 * cell.length).sin()
            };
            steps.push(each.map(error).collect());
        }
    }
    steps
}

/// `|w⁗|` of a spline by element, from the jumps of `w‴` at its knots.
fn fourth(mesh: &Mesh, u: &[f64]) -> Vec<f64> {
    let knots = mesh.knots();
    let n = knots.elements();
    let third: Vec<f64> = (0..n).map(|e| mesh.displacement_in(u, e, knots.at(e))[3].1).collect();
    let mut at = vec![0.0; n + 1];
    for j in 1..n {
        let about = 0.5 * (knots.at(j + 1) - knots.at(j - 1));
        at[j] = ((third[j] - third[j - 1]) / about).abs();
    }
    (at[0], at[n]) = (at[1], at[n - 1]);
    // what is asked for does not vanish where the sign changes
    at.windows(2).map(|ends| 0.5 * (ends[0] + ends[1])).collect()
}
