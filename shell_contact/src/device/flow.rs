//! Dissipative motion: where a state goes that has lost its stability.
//!
//! With the device held fixed the state follows the gradient flow `M x' = −grad Π`, `M` the matrix
//! of the metric (of the plate's height too, where that is free), by implicit Euler steps
//! `(M/τ + H) dx = −grad Π`. Away from equilibria `τ` is as long as the step still tells where the
//! motion goes; near one it grows without bound and the step becomes Newton's. A step is taken if
//! `M/τ + H` is positive definite, the state is admissible, `Π` falls, and one more Newton iteration
//! of the same Euler step would move it by a small part of its length; else `τ` shrinks. So the
//! state that is reached is the one to which the motion leads, not merely another solution.
//!
//! A motion begins at a fold, moved along the critical mode to the side on which `Π` falls.

use super::{Device, Loading};
use continuation::{EvalError, Matrix, NewtonError, NewtonSettings, newton};

/// How closely the motion is followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelaxationSettings {
    /// Largest second Newton correction of an Euler step, relative to the step.
    pub accuracy: f64,
    /// Longest step, as a length in the metric, in `R0`.
    pub longest_move: f64,
    /// Longest `τ` in units of the first one; infinite: no limit.
    pub longest_time: f64,
    /// Most steps.
    pub max_steps: usize,
}

impl Default for RelaxationSettings {
    fn default() -> Self {
        RelaxationSettings {
            accuracy: 0.1,
            longest_move: 0.05,
            longest_time: f64::INFINITY,
            max_steps: 20_000,
        }
    }
}

/// How a motion ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// At a stable equilibrium.
    Rest,
    /// The plate flies away: nothing holds the load any more.
    Away,
}

/// Why a motion was not followed to its end.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// The state at the beginning has no energy or no Hessian.
    #[error("the motion cannot begin: {0}")]
    Start(EvalError),
    /// The potential falls to neither side of the state along its critical mode.
    #[error("the state is in equilibrium and loses its stability to neither side")]
    NoWayDown,
    /// No step however short was acceptable.
    #[error("no step of the motion was acceptable after {steps} steps{}",
        .cause.map(|c| format!(": {c}")).unwrap_or_default())]
    Stuck {
        /// Steps done.
        steps: usize,
        /// Why the last trial had no value, if so.
        cause: Option<EvalError>,
    },
    /// The limit of steps was reached.
    #[error("the motion did not end within {steps} steps")]
    TooMany {
        /// Steps done.
        steps: usize,
    },
    /// Newton's method did not confirm the state of rest.
    #[error("the motion's end was not confirmed: {0}")]
    End(NewtonError),
}

/// Distance from a fold at which a motion begins, in `R0`, at most: where the potential is cubic
/// along the critical mode.
const FARTHEST_DEPARTURE: f64 = 1e-3;
/// The same at least: well above the error of the fold and of rounding.
const NEAREST_DEPARTURE: f64 = 1e-7;
/// Part of the fold's time scale that the first step takes.
const FIRST: f64 = 0.125;
/// Inverse iterations for the critical mode.
const ITERATIONS: usize = 6;
/// A Newton step shorter than this ends the motion, where the Hessian is positive definite.
const NEAR: f64 = 1e-3;
/// Newton's method may go this much farther to the state of rest.
const SAME_PLACE: f64 = 10.0;
/// Shortest `τ` relative to the first.
const SHORTEST: f64 = 1e-14;
/// A plate that still moves outwards here does not come back.
const FAR: f64 = 10.0;
/// What rounding may add to an energy that falls, in units of its terms.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Follows motions of one problem; all storage is allocated once.
#[derive(Debug, Clone)]
pub struct Relaxation<P: Loading> {
    settings: RelaxationSettings,
    hessian: P::Jacobian,
    x: Vec<f64>,
    gradient: Vec<f64>,
    step: Vec<f64>,
    trial: Vec<f64>,
    correction: Vec<f64>,
    work: Vec<f64>,
    mode: Vec<f64>,
    potential: f64,
    steps: usize,
    assemblies: usize,
}

/// What a trial step found.
enum Trial {
    Taken { ratio: f64, length: f64 },
    Refused { shrink: f64, cause: Option<EvalError> },
}

impl<P: Loading> Relaxation<P> {
    /// Storage for motions of a problem.
    pub fn new(problem: &P, settings: RelaxationSettings) -> Self {
        let n = problem.dim();
        let zero = || vec![0.0; n];
        Relaxation {
            settings,
            hessian: problem.new_jacobian(),
            x: zero(),
            gradient: zero(),
            step: zero(),
            trial: zero(),
            correction: zero(),
            work: zero(),
            mode: zero(),
            potential: f64::NAN,
            steps: 0,
            assemblies: 0,
        }
    }

    /// The state that the latest motion reached.
    pub fn state(&self) -> &[f64] {
        &self.x
    }

    /// Steps of the latest motion.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Assemblies of the Hessian by the latest motion.
    pub fn assemblies(&self) -> usize {
        self.assemblies
    }

    /// The motion that begins at `x`, a state that is about to lose its stability at `p`: a fold,
    /// or a branch point.
    ///
    /// # Errors
    /// When the motion could not be followed.
    pub fn from_fold(&mut self, problem: &P, x: &[f64], p: &[f64]) -> Result<Motion, MotionError> {
        (self.steps, self.assemblies) = (0, 0);
        let (sides, distance, time) = self.departure(problem, x, p)?;
        let mut outcome = Err(MotionError::NoWayDown);
        for side in sides.into_iter().flatten() {
            for ((to, from), mode) in self.x.iter_mut().zip(x).zip(&self.mode) {
                *to = from + side * distance * mode;
            }
            outcome = self.follow(problem, p, FIRST * time);
            if outcome.is_ok() {
                break;
            }
        }
        outcome
    }

    /// The motion that begins at `x`, which is no equilibrium.
    ///
    /// # Errors
    /// When the motion could not be followed.
    pub fn from_state(&mut self, problem: &P, x: &[f64], p: &[f64]) -> Result<Motion, MotionError> {
        (self.steps, self.assemblies) = (0, 0);
        self.x.copy_from_slice(x);
        self.follow(problem, p, 1.0)
    }

    /// The critical mode; the sides of it to which the potential falls, the steeper first; how far
    /// to begin and on which time scale.
    fn departure(
        &mut self,
        problem: &P,
        x: &[f64],
        p: &[f64],
    ) -> Result<([Option<f64>; 2], f64, f64), MotionError> {
        self.x.copy_from_slice(x);
        self.assemble(problem, p).map_err(MotionError::Start)?;
        let floor = f64::EPSILON * self.hessian.norm();
        self.hessian.factor(floor);
        self.mode.fill(1.0);
        for _ in 0..ITERATIONS {
            problem.metric(&self.mode, &mut self.work);
            self.mode.copy_from_slice(&self.work);
            self.hessian.solve(&mut self.mode);
            let size = length(problem, &self.mode, &mut self.work);
            self.mode.iter_mut().for_each(|m| *m /= size);
        }
        // downwards: farther out the straight line along the mode climbs the stiff directions
        let (mut distance, mut both) = (FARTHEST_DEPARTURE, None);
        while distance >= NEAREST_DEPARTURE {
            // slopes of the potential along the mode, away from the state
            let up = self.slope(problem, x, p, distance);
            let down = self.slope(problem, x, p, -distance).map(|slope| -slope);
            if let (Some(up), Some(down)) = (up, down) {
                let alike = up.abs().max(down.abs()) < 2.0 * up.abs().min(down.abs());
                let (first, time) =
                    (if up < down { 1.0 } else { -1.0 }, distance / up.min(down).abs());
                if alike && up * down < 0.0 {
                    return Ok(([Some(first), None], distance, time));
                }
                if alike && up < 0.0 && both.is_none() {
                    both = Some(([Some(first), Some(-first)], distance, time));
                }
            }
            distance *= 0.25;
        }
        both.ok_or(MotionError::NoWayDown)
    }

    fn slope(&mut self, problem: &P, x: &[f64], p: &[f64], distance: f64) -> Option<f64> {
        for ((to, from), mode) in self.trial.iter_mut().zip(x).zip(&self.mode) {
            *to = from + distance * mode;
        }
        problem.residual(&self.trial, p, &mut self.correction).ok()?;
        Some(dot(&self.correction, &self.mode))
    }

    /// Gradient and Hessian at `x`.
    fn assemble(&mut self, problem: &P, p: &[f64]) -> Result<(), EvalError> {
        self.assemblies += 1;
        problem.linearise(&self.x, p, &mut self.gradient, &mut self.hessian)
    }

    /// Follows the motion from `self.x`.
    fn follow(&mut self, problem: &P, p: &[f64], first: f64) -> Result<Motion, MotionError> {
        let RelaxationSettings { accuracy, longest_time, max_steps, .. } = self.settings;
        self.potential = problem.potential(&self.x, p).map_err(MotionError::Start)?;
        self.assemble(problem, p).map_err(MotionError::Start)?;
        let mut tau = first;
        let begun = self.steps;
        while self.steps - begun < max_steps {
            let (mut drag, mut cause) = (0.0, None);
            let (ratio, moved) = loop {
                problem.add_drag(1.0 / tau - drag, &mut self.hessian);
                drag = 1.0 / tau;
                match self.attempt(problem, p, drag) {
                    Trial::Taken { ratio, length } => break (ratio, length),
                    Trial::Refused { shrink, cause: why } => {
                        cause = why.or(cause);
                        tau *= shrink;
                    }
                }
                if tau < SHORTEST * first {
                    return Err(MotionError::Stuck { steps: self.steps, cause });
                }
            };
            std::mem::swap(&mut self.x, &mut self.trial);
            self.steps += 1;
            self.assemble(problem, p)
                .map_err(|e| MotionError::Stuck { steps: self.steps, cause: Some(e) })?;
            if self.flies_away(problem, p) {
                return Ok(Motion::Away);
            }
            if moved < SAME_PLACE * NEAR && self.is_near_rest(problem) {
                return self.rest(problem, p);
            }
            let growth = (0.5 * accuracy / ratio).clamp(1.0, 4.0);
            tau = (tau * growth).min(longest_time * first);
        }
        Err(MotionError::TooMany { steps: self.steps })
    }

    /// Tries the Euler step for which the Hessian holds the drag.
    fn attempt(&mut self, problem: &P, p: &[f64], drag: f64) -> Trial {
        let refuse = |shrink, cause| Trial::Refused { shrink, cause };
        let floor = f64::EPSILON * self.hessian.norm();
        let facts = self.hessian.factor(floor);
        if facts.perturbed > 0 || facts.inertia.is_none_or(|(negative, _)| negative > 0) {
            return refuse(0.5, None);
        }
        for (step, g) in self.step.iter_mut().zip(&self.gradient) {
            *step = -g;
        }
        self.hessian.solve(&mut self.step);
        let size = length(problem, &self.step, &mut self.work);
        if size.is_nan() || size > self.settings.longest_move {
            return refuse(0.5, None);
        }
        for ((to, x), d) in self.trial.iter_mut().zip(&self.x).zip(&self.step) {
            *to = x + d;
        }
        let outcome = problem.residual(&self.trial, p, &mut self.correction);
        let potential = match outcome.and_then(|()| problem.potential(&self.trial, p)) {
            Ok(potential) => potential,
            Err(cause) => return refuse(0.4, Some(cause)),
        };
        let rounding = ROUNDING * (1.0 + self.potential.abs());
        if potential.is_nan() || potential > self.potential + rounding {
            return refuse(0.5, None);
        }
        problem.metric(&self.step, &mut self.work);
        for (r, m) in self.correction.iter_mut().zip(&self.work) {
            *r += drag * m;
        }
        self.hessian.solve(&mut self.correction);
        let left = length(problem, &self.correction, &mut self.work);
        let ratio = if size > 0.0 { left / size } else { 0.0 };
        // differences of this size are rounding
        if ratio > self.settings.accuracy && left > 1e-12 {
            return refuse((0.7 * self.settings.accuracy / ratio).clamp(0.1, 0.5), None);
        }
        self.potential = potential;
        Trial::Taken { ratio, length: size }
    }

    fn flies_away(&self, problem: &P, p: &[f64]) -> bool {
        // the attraction only falls with the distance: a load that overcomes it here always does
        problem.device() == Device::DeadLoad
            && problem.plate(&self.x, p) > FAR
            && self.gradient.last().is_some_and(|g| *g < 0.0)
    }

    /// Whether Newton's method from here goes a short way to a minimum.
    fn is_near_rest(&mut self, problem: &P) -> bool {
        let floor = f64::EPSILON * self.hessian.norm();
        let facts = self.hessian.factor(floor);
        if facts.perturbed > 0 || facts.inertia.is_none_or(|(negative, _)| negative > 0) {
            return false;
        }
        self.step.copy_from_slice(&self.gradient);
        self.hessian.solve(&mut self.step);
        length(problem, &self.step, &mut self.work) < NEAR
    }

    /// Newton's method to the state of rest.
    fn rest(&mut self, problem: &P, p: &[f64]) -> Result<Motion, MotionError> {
        self.trial.copy_from_slice(&self.x);
        let report = newton(problem, &mut self.x, p, &NewtonSettings::default())
            .map_err(MotionError::End)?;
        self.assemblies += report.iterations;
        for (d, x) in self.trial.iter_mut().zip(&self.x) {
            *d -= x;
        }
        let stuck = MotionError::Stuck { steps: self.steps, cause: None };
        if length(problem, &self.trial, &mut self.work) > SAME_PLACE * NEAR {
            return Err(stuck);
        }
        self.assemble(problem, p).map_err(MotionError::Start)?;
        if self.is_near_rest(problem) { Ok(Motion::Rest) } else { Err(stuck) }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Length in the problem's metric.
fn length<P: Loading>(problem: &P, x: &[f64], work: &mut [f64]) -> f64 {
    problem.metric(x, work);
    dot(x, work).max(0.0).sqrt()
}
