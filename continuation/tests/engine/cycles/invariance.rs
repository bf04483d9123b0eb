//! The same branch in other units.

use super::embedded::{Beside, Embedded, Random};
use super::follow;
use super::systems::brusselator;
use continuation::cycles::{Cycle, CycleSettings};
use continuation::linalg::Dense;
use continuation::{EvalError, ParamId, Parameter, Problem, Settings, Stability};

/// `v = u / length`, `τ = t / time`, `q = p / unit`, equations times `factor`.
struct Scaled {
    length: f64,
    time: f64,
    unit: f64,
    factor: f64,
    parameters: [Parameter; 1],
}

impl Scaled {
    fn new(length: f64, time: f64, unit: f64, factor: f64) -> Self {
        let parameters = [Parameter::new("q", "", 1.0 / unit)];
        Scaled { length, time, unit, factor, parameters }
    }
}

impl Problem for Scaled {
    type Jacobian = Dense;

    fn dim(&self) -> usize {
        2
    }

    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn new_jacobian(&self) -> Dense {
        Dense::new(2)
    }

    fn residual(&self, v: &[f64], q: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let u = [self.length * v[0], self.length * v[1]];
        brusselator().residual(&u, &[self.unit * q[0]], r)?;
        r.iter_mut().for_each(|r| *r *= self.factor * self.time / self.length);
        Ok(())
    }

    fn jacobian(&self, v: &[f64], q: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        let u = [self.length * v[0], self.length * v[1]];
        brusselator().jacobian(&u, &[self.unit * q[0]], j)?;
        for c in 0..2 {
            j.column_mut(c).iter_mut().for_each(|x| *x *= self.factor * self.time);
        }
        Ok(())
    }

    fn parameter_derivative(
        &self,
        v: &[f64],
        q: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        let u = [self.length * v[0], self.length * v[1]];
        brusselator().parameter_derivative(&u, &[self.unit * q[0]], which, out)?;
        out.iter_mut().for_each(|r| *r *= self.factor * self.time / self.length * self.unit);
        Ok(())
    }

    fn stability(&self) -> Stability {
        Stability::Dynamics
    }

    fn mass(&self, m: &mut Dense) -> bool {
        m.set(0, 0, self.factor);
        m.set(1, 1, self.factor);
        true
    }
}

#[test]
fn scales_do_not_matter() {
    let branch = |length: f64, time: f64, unit: f64, factor: f64| {
        let problem = Scaled::new(length, time, unit, factor);
        let guess = |t: f64, v: &mut [f64]| {
            let angle = std::f64::consts::TAU * t * time / 7.1;
            v[0] = (1.0 + 1.4 * angle.cos()) / length;
            v[1] = (3.0 - 1.4 * angle.cos() + 0.8 * angle.sin()) / length;
        };
        let settings = CycleSettings::default();
        let start = Cycle::near(&problem, &[2.6 / unit], 7.1 / time, guess, &settings).unwrap();
        follow(&problem, "q", &start, Settings { target: Some(4.0 / unit), ..Settings::default() })
    };
    let plain = branch(1.0, 1.0, 1.0, 1.0);
    let scales = [
        (1e6, 1.0, 1.0, 1.0),
        (1.0, 1e7, 1.0, 1.0),
        (1.0, 1.0, 1e-6, 1.0),
        (1.0, 1.0, 1.0, 1e9),
        (1e-5, 1e-4, 1e3, 1e-8),
    ];
    for (length, time, unit, factor) in scales {
        let other = branch(length, time, unit, factor);
        assert_eq!(
            other.branch.points.len(),
            plain.branch.points.len(),
            "{length} {time} {unit} {factor}"
        );
        for (a, b) in plain.cycles.iter().zip(&other.cycles) {
            let (p, q) = (a.cycle.parameters[0], b.cycle.parameters[0] * unit);
            assert!((p - q).abs() < 1e-6, "{p} {q}");
            let (t, u) = (a.cycle.period, b.cycle.period * time);
            // along the branch the period changes by about 2 a unit of the parameter
            assert!((t - u).abs() < 1e-8 + 3.0 * (p - q).abs(), "{t} {u}");
            assert_eq!((a.unstable, a.certified), (b.unstable, b.certified));
        }
    }
}

#[test]
fn step_lengths_do_not_matter() {
    let mut random = Random(61);
    let problem = Embedded::new(vec![Beside::HalfTurn(0.2)], &mut random, 0.1);
    let guess = |t: f64, u: &mut [f64]| problem.circle(1.0, t, u);
    let start =
        Cycle::near(&problem, &[-0.5], problem.period(), guess, &CycleSettings::default()).unwrap();
    // a default step is a twentieth of the range 1
    for factor in [0.1, 0.5, 3.0, 10.0] {
        let step = Some(0.05 * factor);
        let settings =
            Settings { target: Some(0.5), max_step: step, first_step: step, ..Settings::default() };
        let branch = follow(&problem, "p", &start, settings);
        let found: Vec<f64> = branch.branch.events.iter().map(|event| event.p).collect();
        assert_eq!(found.len(), 2, "{factor}: {found:?}");
        assert!(
            (found[0] + 0.2).abs() < 1e-8 && (found[1] - 0.2).abs() < 1e-8,
            "{factor}: {found:?}"
        );
        assert!(branch.branch.doubts.is_empty());
    }
}
