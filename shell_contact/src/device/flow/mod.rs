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

mod departure;

use super::{Device, Loading};
use continuation::linalg::Arrow;
use continuation::{EvalError, Matrix, NewtonError, NewtonSettings, newton};
use departure::{Departure, Line, SHIFTED_ITERATIONS};

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
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
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

/// Part of the fold's time scale that the first step takes.
const FIRST: f64 = 0.125;
/// Inverse iterations for the critical mode.
const ITERATIONS: usize = 6;
/// The shifts tried, in `χ/R0²`: an eigenvalue above the least is as good as zero.
const LEAST_SHIFT: f64 = 1e-12;
/// The largest: no mode of a shell is softer by more than its own stiffness.
const LARGEST_SHIFT: f64 = 1e3;
/// A Newton step shorter than this ends the motion, where the Hessian is positive definite.
const NEAR: f64 = 1e-3;
/// How much shorter it must be after one that led to no state of rest.
const LESS_NEAR: f64 = 0.1;
/// Newton's method may go this much farther to the state of rest.
const SAME_PLACE: f64 = 10.0;
/// Shortest `τ` relative to the first.
const SHORTEST: f64 = 1e-14;
/// A plate that still moves outwards here does not come back.
const FAR: f64 = 10.0;
/// Second corrections shorter than this, in `R0`, are rounding.
const LEAST_DIFFERENCE: f64 = 1e-12;
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
    /// The Hessian bordered with the mode, where it was needed.
    bordered: Option<Arrow<P::Jacobian>>,
    potential: f64,
    steps: usize,
    assemblies: usize,
}

/// Which side of an unstable equilibrium a motion leaves it to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// To which the potential falls more steeply; to the other one if no motion leads there.
    First,
    /// The other one.
    Second,
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
            bordered: None,
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
        self.x.copy_from_slice(x);
        self.assemble(problem, p).map_err(MotionError::Start)?;
        let floor = f64::EPSILON * self.hessian.norm();
        self.hessian.factor(floor);
        self.inverse_iterations(problem, ITERATIONS);
        match self.downwards(problem, x, p, Line::Straight) {
            Ok(departure) => self.leave(problem, x, p, departure),
            // at a pitchfork the potential falls as the fourth power, less than the stiff
            // directions climb unless they give way
            Err(_) => match self.downwards(problem, x, p, Line::Curved) {
                Ok(departure) => self.leave(problem, x, p, departure),
                Err(error) => {
                    let departure = self.between_two_modes(problem, x, p).ok_or(error)?;
                    self.leave(problem, x, p, departure)
                }
            },
        }
    }

    /// Follows the motion to the first side on which it can be.
    fn leave(
        &mut self,
        problem: &P,
        x: &[f64],
        p: &[f64],
        departure: Departure,
    ) -> Result<Motion, MotionError> {
        let Departure { sides, distance, time, line } = departure;
        let mut outcome = Err(MotionError::NoWayDown);
        for side in sides.into_iter().flatten() {
            if self.slope(problem, x, p, side * distance, line).is_none() {
                continue;
            }
            self.x.copy_from_slice(&self.trial);
            outcome = self.follow(problem, p, FIRST * time);
            if outcome.is_ok() {
                break;
            }
        }
        outcome
    }

    /// The motion that begins at `x`, an equilibrium that is unstable, along its most unstable mode.
    /// Of two sides to which the potential falls equally the first is that along which the unknowns
    /// grow on the whole.
    ///
    /// # Errors
    /// When the motion could not be followed.
    pub fn from_saddle(
        &mut self,
        problem: &P,
        x: &[f64],
        p: &[f64],
        side: Side,
    ) -> Result<Motion, MotionError> {
        (self.steps, self.assemblies) = (0, 0);
        self.x.copy_from_slice(x);
        self.assemble(problem, p).map_err(MotionError::Start)?;
        let mut drag = LEAST_SHIFT;
        problem.add_drag(drag, &mut self.hessian);
        while !self.is_definite(problem) {
            if drag > LARGEST_SHIFT {
                return Err(MotionError::NoWayDown);
            }
            problem.add_drag(drag, &mut self.hessian);
            drag *= 2.0;
        }
        self.inverse_iterations(problem, SHIFTED_ITERATIONS);
        let mut departure = self.downwards(problem, x, p, Line::Straight)?;
        if side == Side::Second {
            departure.sides = [departure.sides[1], None];
        }
        self.leave(problem, x, p, departure)
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

    /// Whether an equilibrium is stable.
    pub fn is_stable(&mut self, problem: &P, x: &[f64], p: &[f64]) -> bool {
        self.x.copy_from_slice(x);
        self.assemble(problem, p).is_ok() && self.is_definite(problem)
    }

    /// Whether the Hessian as it is, factored here, is positive definite but for multipliers.
    fn is_definite(&mut self, problem: &P) -> bool {
        let floor = f64::EPSILON * self.hessian.norm();
        let facts = self.hessian.factor(floor);
        let multipliers = problem.multipliers();
        facts.perturbed == 0 && facts.inertia.is_some_and(|(negative, _)| negative <= multipliers)
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
        let (begun, mut near, mut unconfirmed) = (self.steps, NEAR, None);
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
                    let stuck = MotionError::Stuck { steps: self.steps, cause };
                    return Err(unconfirmed.unwrap_or(stuck));
                }
            };
            std::mem::swap(&mut self.x, &mut self.trial);
            self.steps += 1;
            self.assemble(problem, p)
                .map_err(|e| MotionError::Stuck { steps: self.steps, cause: Some(e) })?;
            if self.flies_away(problem, p) {
                return Ok(Motion::Away);
            }
            if moved < SAME_PLACE * near && self.is_near_rest(problem, near) {
                match self.rest(problem, p) {
                    Ok(motion) => return Ok(motion),
                    // a place that is nearly at rest, as beside a fold, is passed
                    Err(error) => {
                        (near, unconfirmed) = (LESS_NEAR * near, Some(error));
                        self.x.copy_from_slice(&self.trial);
                        self.assemble(problem, p).map_err(MotionError::Start)?;
                    }
                }
            }
            let growth = (0.5 * accuracy / ratio).clamp(1.0, 4.0);
            tau = (tau * growth).min(longest_time * first);
        }
        Err(unconfirmed.unwrap_or(MotionError::TooMany { steps: self.steps }))
    }

    /// Tries the Euler step for which the Hessian holds the drag.
    fn attempt(&mut self, problem: &P, p: &[f64], drag: f64) -> Trial {
        let refuse = |shrink, cause| Trial::Refused { shrink, cause };
        if !self.is_definite(problem) {
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
        // differences of this size are rounding: they say nothing of the step
        let ratio = if left > LEAST_DIFFERENCE { left / size } else { 0.0 };
        if ratio > self.settings.accuracy {
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
    fn is_near_rest(&mut self, problem: &P, near: f64) -> bool {
        if !self.is_definite(problem) {
            return false;
        }
        self.step.copy_from_slice(&self.gradient);
        self.hessian.solve(&mut self.step);
        length(problem, &self.step, &mut self.work) < near
    }

    /// Newton's method to the state of rest; the trial is where it began.
    fn rest(&mut self, problem: &P, p: &[f64]) -> Result<Motion, MotionError> {
        self.trial.copy_from_slice(&self.x);
        let report = newton(problem, &mut self.x, p, &NewtonSettings::default())
            .map_err(MotionError::End)?;
        self.assemblies += report.iterations;
        for ((d, from), to) in self.step.iter_mut().zip(&self.trial).zip(&self.x) {
            *d = to - from;
        }
        let stuck = MotionError::Stuck { steps: self.steps, cause: None };
        if length(problem, &self.step, &mut self.work) > SAME_PLACE * NEAR {
            return Err(stuck);
        }
        self.assemble(problem, p).map_err(MotionError::Start)?;
        if self.is_near_rest(problem, NEAR) { Ok(Motion::Rest) } else { Err(stuck) }
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
