//! What a cycle does where its state has lost its stability: it goes on along another branch, or jumps.

use super::super::Loading;
use super::super::flow::{Motion, MotionError, Side};
use super::super::walker::dot;
use super::{CyclePoint, Direction, End, JUMP, Jump, Traveller};
use continuation::{EvalError, NewtonSettings, StopReason, newton};

/// How far beyond a branch point states of other branches are sought: the nearer one is nearer to it
/// by the square root of their ratio at least, unless it is a jump away. Of a weak film the modes that turn are
/// so soft that only farther states can be told to be stable.
const BEYOND: [[f64; 2]; 4] = [[1e-6, 1e-8], [1e-5, 1e-7], [1e-4, 1e-6], [1e-3, 1e-5]];
/// States so near to a branch point, in `R0`, are no jump away: it is known to the root of rounding.
const AT_POINT: f64 = 1e-6;

impl<P: Loading> Traveller<'_, P> {
    /// At a branch point: goes on without a jump if beyond it there are stable states of another
    /// branch, ever nearer to it, and records the first of them.
    pub(super) fn pass(&mut self, direction: Direction, target: f64) -> bool {
        BEYOND.into_iter().any(|beyond| self.pass_by(direction, target, beyond))
    }

    /// The same with states sought at these distances.
    fn pass_by(&mut self, direction: Direction, target: f64, steps: [f64; 2]) -> bool {
        let problem = self.problem;
        let (at, ahead) = (self.parameter, target - self.parameter);
        let mut distances = [0.0; 2];
        let mut beyond = Vec::new();
        for (distance, step) in distances.iter_mut().zip(steps) {
            if ahead.abs() < step {
                return false;
            }
            let Some(x) = self.stable_beyond(at + step.copysign(ahead)) else { return false };
            let apart: Vec<f64> = x.iter().zip(&self.x).map(|(a, b)| a - b).collect();
            let mut m = vec![0.0; apart.len()];
            problem.metric(&apart, &mut m);
            *distance = dot(&m, &apart).max(0.0).sqrt();
            if beyond.is_empty() {
                beyond = x;
            }
        }
        // a tenth or less where branches meet, all of it after a jump
        if distances[0] > AT_POINT && distances[1] > 0.5 * distances[0] {
            return false;
        }
        let before = std::mem::replace(&mut self.x, beyond);
        self.parameter = at + steps[0].copysign(ahead);
        match self.landing(direction) {
            Ok(point) => {
                self.cycle.points.push(CyclePoint { event: None, ..point });
                true
            }
            Err(_) => {
                (self.x, self.parameter) = (before, at);
                false
            }
        }
    }

    /// The stable state where the device's parameter has another value, a little off: on the branch
    /// that goes on, or where the motion from there leads.
    pub(super) fn stable_beyond(&mut self, parameter: f64) -> Option<Vec<f64>> {
        let problem = self.problem;
        let p = problem.parameters_at(parameter);
        let mut x = self.x.clone();
        let report = newton(problem, &mut x, &p, &NewtonSettings::default()).ok()?;
        self.cycle.newton_iterations += report.iterations;
        if self.relaxation.is_stable(problem, &x, &p) {
            return Some(x);
        }
        let motion = self.relaxation.from_saddle(problem, &x, &p, Side::First);
        self.cycle.newton_iterations += self.relaxation.assemblies();
        (motion == Ok(Motion::Rest)).then(|| self.relaxation.state().to_vec())
    }

    /// Follows the dissipative motion from the state that was lost.
    pub(super) fn jump(&mut self, direction: Direction) -> Result<(), End> {
        let problem = self.problem;
        let p = problem.parameters_at(self.parameter);
        let motion = self.relaxation.from_fold(problem, &self.x, &p);
        self.cycle.newton_iterations += self.relaxation.assemblies();
        let before = self.cycle.points.len().saturating_sub(1);
        let mut jump = Jump {
            direction,
            parameter: self.parameter,
            before: Some(before),
            after: None,
            dissipated: None,
            steps: self.relaxation.steps(),
        };
        match motion {
            Ok(Motion::Rest) => {
                self.x.copy_from_slice(self.relaxation.state());
                let landed =
                    self.landing(direction).map_err(|e| self.refused(&MotionError::Start(e)))?;
                jump.after = Some(self.cycle.points.len());
                jump.dissipated = Some(self.cycle.points[before].potential - landed.potential);
                self.cycle.points.push(landed);
                self.cycle.jumps.push(jump);
                Ok(())
            }
            Ok(Motion::Away) => {
                self.cycle.jumps.push(jump);
                self.away = true;
                Ok(())
            }
            Err(error) => Err(self.refused(&error)),
        }
    }

    pub(super) fn refused(&self, error: &MotionError) -> End {
        let name = self.problem.device().parameter_name();
        let detail = format!("the jump at {name} = {:.10} was lost: {error}", self.parameter);
        End::stop(StopReason::StepTooSmall, detail)
    }

    pub(super) fn landing(&self, direction: Direction) -> Result<CyclePoint, EvalError> {
        let problem = self.problem;
        let p = problem.parameters_at(self.parameter);
        let z0 = problem.plate(&self.x, &p);
        Ok(CyclePoint {
            direction,
            parameter: self.parameter,
            z0,
            force: problem.force(&self.x, &p)?,
            energy: problem.energy(&self.x, &p)?,
            potential: problem.potential(&self.x, &p)?,
            u: problem.shell_part(&self.x).to_vec(),
            event: Some(JUMP.to_owned()),
        })
    }
}
