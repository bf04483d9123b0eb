//! One periodic orbit, and where it comes from.

use super::basis::Basis;
use super::collocation::CycleProblem;
use super::mesh::{Orbit, halved, uniform};
use super::settings::CycleSettings;
use crate::any_problem::DynProblem;
use crate::branch::EventKind;
use crate::codim2::CurveError;
use crate::newton::{self, NewtonError, NewtonSettings};
use crate::problem::{EvalError, Problem};
use crate::settings::SettingsError;
use crate::step::Refusal;
use crate::tracer::TraceError;
use serde::{Deserialize, Serialize};

/// Part of the error that is left at most where more intervals help.
const FUTILE: f64 = 0.5;

/// Why there is no cycle, or no branch of cycles.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CycleError {
    /// A setting is out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The problem is not a dynamical system.
    #[error("cycles need a problem with `Stability::Dynamics`: M du/dt = f(u, p)")]
    NoDynamics,
    /// The mass matrix is singular.
    #[error(
        "cycles need a mass matrix of full rank; equations without a derivative are not supported"
    )]
    SingularMass,
    /// Too many unknowns for a dense block.
    #[error(
        "an interval would have {size} unknowns, in a dense block; at most {most} are supported"
    )]
    TooLarge {
        /// Unknowns of an interval: those of the problem times the degree.
        size: usize,
        /// The most there may be.
        most: usize,
    },
    /// A vector of the wrong length, or a mesh that does not increase from 0 to 1.
    #[error("the orbit does not fit: {what} is {got}, but {expected} is needed")]
    Shape {
        /// What does not fit.
        what: &'static str,
        /// Its size.
        got: usize,
        /// The right size.
        expected: usize,
    },
    /// Times or values that are no orbit.
    #[error("{what} (index {at})")]
    Samples {
        /// What is wrong.
        what: &'static str,
        /// Where.
        at: usize,
    },
    /// The orbit is a single point.
    #[error("the orbit is a single state, an equilibrium: it has no period")]
    Constant,
    /// Newton's method did not converge to a cycle.
    #[error("no cycle near the start: {0}")]
    Newton(#[from] NewtonError),
    /// The event is of another kind.
    #[error("the event is a {found}, not a {wanted}")]
    Kind {
        /// What it is.
        found: EventKind,
        /// What is needed.
        wanted: EventKind,
    },
    /// The branch does not hold the event, or is not one of this problem.
    #[error("the branch is not one of this problem through that special point: {what}")]
    Foreign {
        /// What does not fit.
        what: &'static str,
    },
    /// The event has no eigenvector or frequency.
    #[error("the special point has no critical eigenvector: it was not computed there")]
    NoEigenvector,
    /// No cycle of small amplitude was found.
    #[error(
        "no small cycle of amplitude {amplitude:.2e} or less near the special point: {refusal}"
    )]
    NoSmallCycle {
        /// The last amplitude tried.
        amplitude: f64,
        /// Why the corrector refused it.
        refusal: Refusal,
    },
    /// The problem has no value where it is needed.
    #[error("the problem has no value on the orbit: {0}")]
    Evaluation(#[from] EvalError),
    /// The branch could not begin.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// The curve in two parameters could not begin.
    #[error(transparent)]
    Curve(#[from] CurveError),
}

/// A periodic orbit `u(t) = u(t + T)`, a piecewise polynomial.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cycle {
    /// The mesh points, from 0 to 1.
    pub mesh: Vec<f64>,
    /// Degree of the polynomial on each interval.
    pub degree: usize,
    /// The states at the nodes, `degree` of them equally spaced in each interval from its left end on,
    /// one after the other; the right end of the last interval is the start.
    pub values: Vec<f64>,
    /// The period.
    pub period: f64,
    /// The values of all parameters.
    pub parameters: Vec<f64>,
}

impl Cycle {
    /// The cycle near a guess: `period` and the states `orbit(t)` at times from 0 to it. On a uniform
    /// mesh first, then on one that is adapted to the orbit.
    ///
    /// # Errors
    /// When the problem has no cycles of its own, or there is none near the guess.
    pub fn near<P: Problem + ?Sized>(
        problem: &P,
        p: &[f64],
        period: f64,
        orbit: impl Fn(f64, &mut [f64]),
        settings: &CycleSettings,
    ) -> Result<Self, CycleError> {
        Self::near_of(&problem, p, period, &orbit, settings)
    }

    /// [`Self::near`] of a problem of unknown type.
    pub(crate) fn near_of(
        problem: &DynProblem<'_>,
        p: &[f64],
        period: f64,
        orbit: impl Fn(f64, &mut [f64]),
        settings: &CycleSettings,
    ) -> Result<Self, CycleError> {
        settings.validate()?;
        let (n, m) = (problem.dim(), settings.degree);
        let mesh = uniform(settings.intervals);
        let mut values = vec![0.0; settings.intervals * m * n];
        for (index, state) in values.chunks_exact_mut(n).enumerate() {
            orbit(period * index as f64 / (settings.intervals * m) as f64, state);
        }
        let guess = Cycle { mesh, degree: m, values, period, parameters: p.to_vec() };
        guess.solved(problem)?.adapted(problem, settings)
    }

    /// The cycle near a time series: states, `n` numbers each, at increasing times that span at least one
    /// period, as of an integration that has come close to it. The period is guessed from where the
    /// series comes back to its last state most closely.
    ///
    /// # Errors
    /// As [`Cycle::near`], and when the series is no orbit or does not return.
    pub fn from_series<P: Problem + ?Sized>(
        problem: &P,
        p: &[f64],
        times: &[f64],
        states: &[f64],
        settings: &CycleSettings,
    ) -> Result<Self, CycleError> {
        let (n, count) = (problem.dim(), times.len());
        if states.len() != n * count {
            let (got, expected) = (states.len(), n * count);
            return Err(CycleError::Shape { what: "the number of values", got, expected });
        }
        if let Some(at) = (1..count).find(|i| times[*i].is_nan() || times[*i] <= times[i - 1]) {
            return Err(CycleError::Samples { what: "the times do not increase", at });
        }
        if let Some(at) = states.iter().position(|x| !x.is_finite()) {
            return Err(CycleError::Samples { what: "a state is not finite", at });
        }
        let what = "the series does not come back to its last state";
        if count < 5 {
            return Err(CycleError::Samples { what, at: count });
        }
        // the state at any time: the cubic through four neighbours
        let at = |t: f64, out: &mut [f64]| {
            let right = times.partition_point(|x| *x <= t).clamp(2, count - 2);
            let nodes = right - 2..right + 2;
            out.fill(0.0);
            for i in nodes.clone() {
                let weight: f64 = (nodes.clone().filter(|k| *k != i))
                    .map(|k| (t - times[k]) / (times[i] - times[k]))
                    .product();
                out.iter_mut().zip(&states[i * n..(i + 1) * n]).for_each(|(o, x)| *o += weight * x);
            }
        };
        let scales: Vec<f64> = (0..n)
            .map(|i| {
                let values = states.iter().skip(i).step_by(n);
                let (lo, hi) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| {
                    (lo.min(*v), hi.max(*v))
                });
                if hi > lo { hi - lo } else { f64::INFINITY }
            })
            .collect();
        let end = &states[(count - 1) * n..];
        let distance = |state: &[f64]| -> f64 {
            let square = |i: usize| ((state[i] - end[i]) / scales[i]).powi(2);
            (0..n).map(square).sum::<f64>().sqrt()
        };
        let from_end: Vec<f64> = states.chunks_exact(n).map(distance).collect();
        // back in time: away from the last state first, then the first return
        let away = 0.25 * from_end.iter().fold(0.0_f64, |m, d| m.max(*d));
        let left = (0..count).rev().find(|i| from_end[*i] > away);
        let back = left.and_then(|left| {
            (1..left).rev().find(|i| {
                let d = from_end[*i];
                d < 0.5 * away && d <= from_end[i - 1] && d <= from_end[i + 1]
            })
        });
        let Some(back) = back else {
            return Err(CycleError::Samples { what, at: count - 1 });
        };
        // the closest point between the samples
        let (mut lo, mut hi) = (times[back - 1], times[back + 1]);
        let mut state = vec![0.0; n];
        for _ in 0..60 {
            let (a, b) = (lo + 0.382 * (hi - lo), lo + 0.618 * (hi - lo));
            at(a, &mut state);
            let left = distance(&state);
            at(b, &mut state);
            if left < distance(&state) { hi = b } else { lo = a }
        }
        let (start, stop) = (0.5 * (lo + hi), times[count - 1]);
        Self::near(problem, p, stop - start, |t, out| at(start + t, out), settings)
    }

    /// The state at time `t`.
    pub fn state(&self, t: f64) -> Vec<f64> {
        let n = self.dim();
        let basis = Basis::new(self.degree);
        let orbit = Orbit { n, mesh: &self.mesh, values: &self.values, basis: &basis };
        let mut out = vec![0.0; n];
        orbit.at(t / self.period, &mut out);
        out
    }

    /// Number of unknowns of a state.
    pub fn dim(&self) -> usize {
        let nodes = self.degree * self.mesh.len().saturating_sub(1);
        self.values.len() / nodes.max(1)
    }

    pub(super) fn check(&self, n: usize, parameters: usize) -> Result<(), CycleError> {
        let intervals = self.mesh.len().saturating_sub(1);
        let increases = self.mesh.windows(2).all(|w| w[0] < w[1]);
        let ends = self.mesh.first() == Some(&0.0) && self.mesh.last() == Some(&1.0);
        if !(increases && ends) {
            return Err(CycleError::Samples {
                what: "the mesh does not increase from 0 to 1",
                at: 0,
            });
        }
        if !(2..=7).contains(&self.degree) {
            return Err(CycleError::Shape { what: "the degree", got: self.degree, expected: 4 });
        }
        let expected = intervals * self.degree * n;
        if self.values.len() != expected {
            let got = self.values.len();
            return Err(CycleError::Shape { what: "the number of values", got, expected });
        }
        if self.parameters.len() != parameters {
            let (got, expected) = (self.parameters.len(), parameters);
            return Err(CycleError::Shape { what: "the number of parameters", got, expected });
        }
        if let Some(at) = self.values.iter().position(|x| !x.is_finite()) {
            return Err(CycleError::Samples { what: "a state is not finite", at });
        }
        if !(self.period > 0.0 && self.period.is_finite()) {
            return Err(CycleError::Samples { what: "the period is not positive", at: 0 });
        }
        Ok(())
    }

    /// The same orbit, interpolated on another mesh.
    pub(super) fn on(&self, mesh: Vec<f64>) -> Cycle {
        let basis = Basis::new(self.degree);
        let orbit = Orbit { n: self.dim(), mesh: &self.mesh, values: &self.values, basis: &basis };
        let values = orbit.on(&mesh, self.degree);
        Cycle { values, mesh, ..self.clone() }
    }

    /// The solution on the cycle's own mesh.
    pub(super) fn solved(&self, problem: &DynProblem<'_>) -> Result<Cycle, CycleError> {
        let equations = CycleProblem::of(problem, self)?;
        let mut x = equations.unknowns(self);
        newton::solve(&equations, &mut x, &self.parameters, &NewtonSettings::default())?;
        let found = equations.cycle(&x, &self.parameters);
        // Newton's method may have ended on an equilibrium
        let shrunk = found.amplitude() < 1e-6 * self.amplitude();
        if shrunk { Err(CycleError::Constant) } else { Ok(found) }
    }

    /// Mean of the states at the nodes, which lie as densely as the mesh.
    pub(super) fn mean(&self) -> Vec<f64> {
        let (n, per_interval) = (self.dim(), self.degree * self.dim());
        let mut mean = vec![0.0; n];
        for (w, values) in self.mesh.windows(2).zip(self.values.chunks_exact(per_interval)) {
            let weight = (w[1] - w[0]) / self.degree as f64;
            for state in values.chunks_exact(n) {
                mean.iter_mut().zip(state).for_each(|(m, u)| *m += weight * u);
            }
        }
        mean
    }

    /// By how much the state changes within half a period, at most, over the amplitude: 0 where half
    /// the period is one too.
    pub(super) fn halfway(&self) -> f64 {
        let n = self.dim();
        let basis = Basis::new(self.degree);
        let orbit = Orbit { n, mesh: &self.mesh, values: &self.values, basis: &basis };
        let (mut here, mut there) = (vec![0.0; n], vec![0.0; n]);
        let mut most = 0.0_f64;
        for t in self.mesh.iter().filter(|t| **t < 0.5) {
            orbit.at(*t, &mut here);
            orbit.at(t + 0.5, &mut there);
            most = here.iter().zip(&there).fold(most, |m, (a, b)| m.max((a - b).abs()));
        }
        most / self.amplitude()
    }

    /// Largest range of an unknown.
    pub(super) fn amplitude(&self) -> f64 {
        let n = self.dim();
        let range = |i: usize| {
            let values = self.values.iter().skip(i).step_by(n);
            let (lo, hi) = values
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(*v), hi.max(*v)));
            hi - lo
        };
        (0..n).map(range).fold(0.0, f64::max)
    }

    /// The cycle on a mesh of its own, with as many intervals as its accuracy asks for: see
    /// [`CycleSettings::accuracy`].
    pub(super) fn adapted(
        &self,
        problem: &DynProblem<'_>,
        settings: &CycleSettings,
    ) -> Result<Cycle, CycleError> {
        let basis = Basis::new(self.degree);
        let mut cycle = self.clone();
        let mut intervals = settings.intervals.max(self.mesh.len() - 1);
        let mut before: Option<(Cycle, f64)> = None;
        for round in 0..4 {
            let n = cycle.dim();
            let orbit = Orbit { n, mesh: &cycle.mesh, values: &cycle.values, basis: &basis };
            let mesh = orbit.equidistributed(intervals);
            let next = match cycle.on(mesh).solved(problem) {
                Ok(next) => next,
                // what was solved stays
                Err(error) => return if round > 0 { Ok(cycle) } else { Err(error) },
            };
            cycle = next;
            let Some(error) = cycle.discretisation_error(problem) else { break };
            // more intervals do not help against rounding, which is large near a singular point
            if let Some((fewer, larger)) = before.take()
                && fewer.mesh.len() < cycle.mesh.len()
                && error > FUTILE * larger
            {
                return Ok(if error < larger { cycle } else { fewer });
            }
            if error <= settings.accuracy {
                // once more on the mesh of a good orbit
                if round > 0 {
                    break;
                }
                continue;
            }
            let power = 1.0 / (2.0 * self.degree as f64);
            let grown = (1.3 * (error / settings.accuracy).powf(power)).clamp(1.3, 3.0);
            intervals = ((intervals as f64 * grown).ceil() as usize).min(settings.max_intervals);
            before = Some((cycle.clone(), error));
        }
        Ok(cycle)
    }

    /// Relative change of period and states at the mesh points when every interval is halved; `None`
    /// where there is no solution then.
    pub(super) fn discretisation_error(&self, problem: &DynProblem<'_>) -> Option<f64> {
        let fine = self.on(halved(&self.mesh)).solved(problem).ok()?;
        let period = (fine.period / self.period - 1.0).abs();
        let (n, m, size) = (self.dim(), self.degree, self.amplitude());
        let mut states = 0.0_f64;
        for j in 0..self.mesh.len() - 1 {
            let here = &self.values[j * m * n..(j * m + 1) * n];
            let there = &fine.values[2 * j * m * n..(2 * j * m + 1) * n];
            states = here.iter().zip(there).fold(states, |s, (a, b)| s.max((a - b).abs()));
        }
        Some(period.max(states / size))
    }
}
