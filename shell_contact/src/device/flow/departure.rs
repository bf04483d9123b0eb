//! How a motion begins beside an equilibrium: along which mode, to which side, how far.

use super::super::Loading;
use super::{MotionError, Relaxation, dot, length};
use continuation::Matrix;
use continuation::linalg::Arrow;
use std::f64::consts::PI;

/// Distance from a fold at which a motion begins, in `R0`, at most: where the potential is cubic
/// along the critical mode.
const FARTHEST_DEPARTURE: f64 = 1e-3;
/// The same at least: well above the error of the fold and of rounding.
const NEAREST_DEPARTURE: f64 = 1e-7;
/// Sums of two modes that are tried.
const DIRECTIONS: usize = 8;
/// Slopes that differ by less are those of two mirror images: at the distances of a departure other
/// ones differ by the cubic term, a part of them.
const EQUALLY_STEEP: f64 = 1e-6;
/// Most corrections of a state across the mode.
const CORRECTIONS: usize = 12;
/// Corrections shorter than this, in `R0`, have converged: the slope is the third power of a distance.
const GIVEN_WAY: f64 = 1e-13;
/// Slopes this much larger than rounding are none.
const CLEAR: f64 = 8.0;
/// The same with a shift, which is at most twice the smallest eigenvalue or the least shift.
pub(super) const SHIFTED_ITERATIONS: usize = 60;

/// How a motion begins beside an equilibrium.
pub(super) struct Departure {
    /// Sides of the mode.
    pub(super) sides: [Option<f64>; 2],
    /// How far along it, in `R0`.
    pub(super) distance: f64,
    /// Time scale there.
    pub(super) time: f64,
    pub(super) line: Line,
}

/// What is looked at beside an equilibrium.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Line {
    /// The straight line along the mode.
    Straight,
    /// The states of least potential in the planes across it.
    Curved,
}

impl<P: Loading> Relaxation<P> {
    /// The mode whose eigenvalue is nearest to zero, with the factors that the Hessian holds.
    pub(super) fn inverse_iterations(&mut self, problem: &P, iterations: usize) {
        self.mode.fill(1.0);
        for _ in 0..iterations {
            problem.metric(&self.mode, &mut self.work);
            self.mode.copy_from_slice(&self.work);
            self.hessian.solve(&mut self.mode);
            let size = length(problem, &self.mode, &mut self.work);
            self.mode.iter_mut().for_each(|m| *m /= size);
        }
    }

    /// The steepest departure among sums of the critical mode and the next one; the mode is that sum then.
    ///
    /// Two poles far from each other buckle at the same place to rounding, together or one against the
    /// other: the critical mode is any sum of the two, and the potential falls along that of one pole.
    pub(super) fn between_two_modes(
        &mut self,
        problem: &P,
        x: &[f64],
        p: &[f64],
    ) -> Option<Departure> {
        let first = self.mode.clone();
        for (k, m) in self.mode.iter_mut().enumerate() {
            *m = ((7 * k) % 5) as f64 - 2.0; // no symmetry
        }
        for _ in 0..SHIFTED_ITERATIONS {
            problem.metric(&self.mode, &mut self.work);
            let along = dot(&self.work, &first);
            self.mode.iter_mut().zip(&first).for_each(|(m, f)| *m -= along * f);
            problem.metric(&self.mode, &mut self.work);
            self.mode.copy_from_slice(&self.work);
            self.hessian.solve(&mut self.mode);
            let size = length(problem, &self.mode, &mut self.work);
            self.mode.iter_mut().for_each(|m| *m /= size);
        }
        let second = self.mode.clone();
        let sum = |mode: &mut [f64], k: usize| {
            let (sin, cos) = (k as f64 * PI / DIRECTIONS as f64).sin_cos();
            let both = first.iter().zip(&second);
            mode.iter_mut().zip(both).for_each(|(m, (a, b))| *m = cos * a + sin * b);
        };
        let mut best: Option<(usize, Departure)> = None;
        for k in 1..DIRECTIONS {
            sum(&mut self.mode, k);
            let Ok(departure) = self.downwards(problem, x, p, Line::Straight) else { continue };
            // how steep it is does not depend on where it was measured: the slope grows as the square
            let bend = |d: &Departure| d.distance * d.time;
            if best.as_ref().is_none_or(|(_, best)| bend(&departure) < bend(best)) {
                best = Some((k, departure));
            }
        }
        let (k, departure) = best?;
        sum(&mut self.mode, k);
        Some(departure)
    }

    /// The sides of the critical mode to which the potential falls, the steeper first.
    pub(super) fn downwards(
        &mut self,
        problem: &P,
        x: &[f64],
        p: &[f64],
        line: Line,
    ) -> Result<Departure, MotionError> {
        // farther out the straight line along the mode climbs the stiff directions
        let (mut distance, mut both) = (FARTHEST_DEPARTURE, None);
        // the state is an equilibrium: its own slope is rounding, added up along the mode
        problem.residual(x, p, &mut self.correction).map_err(MotionError::Start)?;
        let terms = self.correction.iter().zip(&self.mode).map(|(r, m)| (r * m).powi(2));
        let rounding = CLEAR * terms.sum::<f64>().sqrt();
        while distance >= NEAREST_DEPARTURE {
            // slopes of the potential along the mode, away from the state
            let up = self.slope(problem, x, p, distance, line);
            let down = self.slope(problem, x, p, -distance, line).map(|slope| -slope);
            if let (Some(up), Some(down)) = (up, down) {
                let least = up.abs().min(down.abs());
                let alike = up.abs().max(down.abs()) < 2.0 * least && least > rounding;
                let time = distance / up.min(down).abs();
                let depart = |sides| Departure { sides, distance, time, line };
                if alike && up * down < 0.0 {
                    let first = if up < down { 1.0 } else { -1.0 };
                    return Ok(depart([Some(first), None]));
                }
                if alike && up < 0.0 && both.is_none() {
                    // by symmetry both may be equally steep: then rounding does not choose
                    let equal = (up - down).abs() < EQUALLY_STEEP * up.abs();
                    let grows = self.mode.iter().sum::<f64>() >= 0.0;
                    let upwards = if equal { grows } else { up < down };
                    let first = if upwards { 1.0 } else { -1.0 };
                    both = Some(depart([Some(first), Some(-first)]));
                }
            }
            distance *= 0.25;
        }
        both.ok_or(MotionError::NoWayDown)
    }

    /// Slope of the potential along the mode at this distance from `x`; the state there is the trial.
    pub(super) fn slope(
        &mut self,
        problem: &P,
        x: &[f64],
        p: &[f64],
        distance: f64,
        line: Line,
    ) -> Option<f64> {
        for ((to, from), mode) in self.trial.iter_mut().zip(x).zip(&self.mode) {
            *to = from + distance * mode;
        }
        if line == Line::Curved {
            return self.give_way(problem, p);
        }
        problem.residual(&self.trial, p, &mut self.correction).ok()?;
        Some(dot(&self.correction, &self.mode))
    }

    /// Moves the trial across the mode to the least potential there; its slope along the mode.
    pub(super) fn give_way(&mut self, problem: &P, p: &[f64]) -> Option<f64> {
        let n = self.mode.len();
        let bordered = self.bordered.get_or_insert_with(|| Arrow::new(problem.new_jacobian(), 1));
        problem.metric(&self.mode, &mut self.work);
        bordered.column_mut(0).copy_from_slice(&self.work);
        bordered.row_mut(0).copy_from_slice(&self.work);
        bordered.set_corner(0, 0, 0.0);
        let mut step = vec![0.0; n + 1];
        let mut last = f64::INFINITY;
        for _ in 0..CORRECTIONS {
            problem.linearise(&self.trial, p, &mut step[..n], bordered.core_mut()).ok()?;
            self.assemblies += 1;
            bordered.factor(f64::EPSILON);
            // along the mode nothing moves; the last unknown is the force that holds the state there
            step[n] = 0.0;
            bordered.solve(&mut step);
            let moved = &step[..n];
            self.trial.iter_mut().zip(moved).for_each(|(x, d)| *x -= d);
            let size = length(problem, moved, &mut self.work);
            if size < GIVEN_WAY || (size < 1e2 * GIVEN_WAY && size > 0.3 * last) {
                problem.residual(&self.trial, p, &mut self.correction).ok()?;
                return Some(dot(&self.correction, &self.mode));
            }
            if !size.is_finite() || size > 2.0 * last {
                return None;
            }
            last = size;
        }
        None
    }
}
