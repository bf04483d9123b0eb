//! Where branches meet: a path that goes on without a jump, and one that does not. The potentials are
//! `½(p − 1)x² ± ¼x⁴ + ⅙x⁶ + ½y²`, whose pitchfork at `p = 1` is to the path's side with the upper sign.

use super::close;
use continuation::linalg::SymmetricBand;
use continuation::{
    EvalError, Matrix, Name, ParamId, Parameter, Problem, Settings, Stability, StopReason, names,
};
use shell_contact::Device;
use shell_contact::device::{Cycle, CycleSettings, Loading, RelaxationSettings, balance, travel};
use std::ops::ControlFlow;

struct Pitchfork {
    /// Of the fourth power.
    sign: f64,
    parameters: [Parameter; 1],
}

impl Pitchfork {
    fn new(sign: f64) -> Pitchfork {
        Pitchfork { sign, parameters: [Parameter::new("z0", "", 1.0)] }
    }
}

impl Problem for Pitchfork {
    type Jacobian = SymmetricBand;

    fn dim(&self) -> usize {
        2
    }

    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn new_jacobian(&self) -> SymmetricBand {
        SymmetricBand::new(2, 1)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let x = u[0];
        r[0] = (p[0] - 1.0) * x + self.sign * x.powi(3) + x.powi(5);
        r[1] = u[1];
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut SymmetricBand) -> Result<(), EvalError> {
        j.set_zero();
        j.add(0, 0, p[0] - 1.0 + 3.0 * self.sign * u[0].powi(2) + 5.0 * u[0].powi(4));
        j.add(1, 1, 1.0);
        Ok(())
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        _: &[f64],
        _: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        out.copy_from_slice(&[u[0], 0.0]);
        Ok(())
    }

    fn stability(&self) -> Stability {
        Stability::EnergyHessian
    }

    fn observables(&self) -> &[Name] {
        names!["force", "energy_total"]
    }

    fn observe(&self, u: &[f64], p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        out.copy_from_slice(&[self.mean_force(u, p)?, self.energy(u, p)?]);
        Ok(())
    }
}

impl Loading for Pitchfork {
    fn device(&self) -> Device {
        Device::Grip
    }

    fn parameters_at(&self, value: f64) -> Vec<f64> {
        vec![value]
    }

    fn plate(&self, _: &[f64], p: &[f64]) -> f64 {
        p[0]
    }

    // dΠ = −2√k_b F dp with √k_b = 1
    fn mean_force(&self, u: &[f64], _: &[f64]) -> Result<f64, EvalError> {
        Ok(-0.25 * u[0].powi(2))
    }

    fn mean_force_along(&self, u: &[f64], _: &[f64], du: &[f64], _: f64) -> Result<f64, EvalError> {
        Ok(-0.5 * u[0] * du[0])
    }

    fn energy(&self, u: &[f64], p: &[f64]) -> Result<f64, EvalError> {
        let (x, y) = (u[0], u[1]);
        Ok(0.5 * (p[0] - 1.0) * x.powi(2)
            + 0.25 * self.sign * x.powi(4)
            + x.powi(6) / 6.0
            + 0.5 * y * y)
    }

    fn add_drag(&self, a: f64, h: &mut SymmetricBand) {
        h.add(0, 0, a);
        h.add(1, 1, a);
    }

    fn shell_part<'x>(&self, x: &'x [f64]) -> &'x [f64] {
        x
    }

    fn root(&self, _: &[f64]) -> f64 {
        1.0
    }

    fn mirrored(&self, x: &[f64], _: &[f64]) -> Option<Vec<f64>> {
        Some(vec![-x[0], x[1]])
    }
}

fn go(problem: &Pitchfork) -> Cycle {
    let trace = Settings { max_step: Some(0.02), ..Settings::default() };
    let relaxation = RelaxationSettings::default();
    let settings = CycleSettings { start: 1.5, end: 0.7, trace, relaxation };
    let cycle =
        travel(problem, &[0.0, 0.0], &settings, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(cycle.stopped.reason, StopReason::ClosedLoop, "{:?}", cycle.stopped);
    cycle
}

/// The stable states beyond the fork are followed there and back, and nothing is dissipated.
#[test]
fn a_path_goes_on_where_a_pitchfork_opens_to_its_side() {
    let problem = Pitchfork::new(1.0);
    let cycle = go(&problem);
    assert!(cycle.jumps.is_empty(), "{:?}", cycle.jumps);
    let turn = cycle.points.iter().find(|point| point.parameter == 0.7).unwrap();
    // x² = (−1 + √(1 + 4(1 − p)))/2
    close(turn.u[0].powi(2), 0.5 * (2.2_f64.sqrt() - 1.0), 1e-10);
    let work = balance(&problem, &cycle).unwrap();
    close(work.loop_area.unwrap(), 0.0, 1e-9 * work.approach.abs());
    assert!(cycle.points.iter().any(|point| point.event.as_deref() == Some("branch-point")));
}

/// The other way round they are a jump away: at `p = 1` to `x = ±1`, and back from the fold at `p = 5/4`.
#[test]
fn a_path_jumps_where_a_pitchfork_opens_against_it() {
    let problem = Pitchfork::new(-1.0);
    let cycle = go(&problem);
    assert_eq!(cycle.jumps.len(), 2, "{:?}", cycle.jumps);
    let [there, back] = [&cycle.jumps[0], &cycle.jumps[1]];
    close(there.parameter, 1.0, 1e-8);
    close(cycle.points[there.after.unwrap()].u[0].abs(), 1.0, 1e-7);
    close(back.parameter, 1.25, 1e-9);
    close(there.dissipated.unwrap(), 0.25 - 1.0 / 6.0, 1e-8);
    let lost = cycle.dissipated().unwrap();
    close(balance(&problem, &cycle).unwrap().loop_area.unwrap(), lost, 1e-7 * lost);
}
