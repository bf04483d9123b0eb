//! Periodic orbits beside AUTO-07p: van der Pol, Lorenz and `ppp`, from a Hopf point to a value of the parameter.
//!
//! `cargo bench -p arclen-continuation --bench orbits` prints points, intervals, the last period and the least time
//! of some runs in milliseconds: with errors at every point, the same with the longest step that AUTO is given, and
//! without errors, as AUTO works. `benches/auto` has the same runs for AUTO. A word after `--` chooses the problems
//! that begin with it.
#![allow(clippy::print_stdout, clippy::expect_used)]

use continuation::cycles::{CycleSettings, SmallCycle, trace};
use continuation::linalg::{Dense, Matrix};
use continuation::{
    EvalError, EventKind, ParamId, Parameter, Problem, Settings, Stability, Tracer,
};
use std::ops::ControlFlow;
use std::time::Instant;

/// Derivatives by the unknowns, row by row, and by the parameter.
type Slopes<const N: usize> = fn([f64; N], f64) -> ([[f64; N]; N], [f64; N]);

/// `du/dt = f(u, p)` with `N` unknowns and one parameter.
struct System<const N: usize> {
    parameters: [Parameter; 1],
    rates: fn([f64; N], f64) -> [f64; N],
    slopes: Slopes<N>,
}

fn state<const N: usize>(u: &[f64]) -> [f64; N] {
    std::array::from_fn(|i| u[i])
}

impl<const N: usize> Problem for System<N> {
    type Jacobian = Dense;

    fn dim(&self) -> usize {
        N
    }

    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn new_jacobian(&self) -> Dense {
        Dense::new(N)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        r.copy_from_slice(&(self.rates)(state(u), p[0]));
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        j.set_zero();
        let (rows, _) = (self.slopes)(state(u), p[0]);
        for (r, row) in rows.iter().enumerate() {
            row.iter().enumerate().for_each(|(c, value)| j.set(r, c, *value));
        }
        Ok(())
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        _which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        out.copy_from_slice(&(self.slopes)(state(u), p[0]).1);
        Ok(())
    }

    fn stability(&self) -> Stability {
        Stability::Dynamics
    }
}

const fn parameter(name: &'static str, scale: f64) -> [Parameter; 1] {
    [Parameter::new(name, "", scale)]
}

fn run<const N: usize>(
    (name, system): (&str, &System<N>),
    (start, from, to): ([f64; N], f64, f64),
    (hopf, end, longest): (usize, f64, f64),
    repeats: u32,
) {
    if std::env::args().skip(1).any(|only| !only.starts_with('-') && !name.starts_with(&only)) {
        return;
    }
    let parameter = &system.parameters[0].name[..];
    let settings = Settings { target: Some(to), ..Settings::default() };
    let equilibria =
        Tracer::new(system, parameter, &start, &[from], settings).expect("a start").run_quietly();
    let hopf = equilibria.events_of(&EventKind::Hopf).nth(hopf).expect("a Hopf point");
    let settings = Settings { target: Some(end), ..Settings::default() };
    for (check, max_step) in [(true, None), (true, Some(longest)), (false, None)] {
        let cycles = CycleSettings { check, ..CycleSettings::default() };
        let settings = Settings { max_step, ..settings.clone() };
        let once = || {
            let small = SmallCycle::at_hopf(system, &equilibria, hopf, &cycles).expect("a cycle");
            let settings = Settings { increasing: Some(small.increasing), ..settings.clone() };
            trace(system, parameter, &small.cycle, &settings, &cycles, &[], &mut |_| {
                ControlFlow::Continue(())
            })
            .expect("a branch")
        };
        let (mut branch, mut best) = (once(), f64::INFINITY);
        for _ in 0..repeats {
            let clock = Instant::now();
            branch = once();
            best = best.min(1e3 * clock.elapsed().as_secs_f64());
        }
        let last = branch.cycles.last().expect("points");
        let intervals = branch.cycles.iter().map(|c| c.cycle.mesh.len() - 1);
        let (most, sum) = (intervals.clone().max().unwrap_or(0), intervals.sum::<usize>());
        println!(
            "{name:16} check {check:5}, longest step {max_step:?}: {best:8.2} ms  {:4} points, {:4} intervals at \
             most, {:3} on average, {:5} assemblies, {} to {parameter} = {:.9}, period {:.12}",
            branch.cycles.len(),
            most,
            sum / branch.cycles.len(),
            branch.branch.statistics.newton_iterations,
            branch.branch.stopped.reason,
            last.cycle.parameters[0],
            last.cycle.period,
        );
    }
}

fn main() {
    let van_der_pol = System {
        parameters: parameter("mu", 1.0),
        rates: |[u, v], p| [v, (p - u * u) * v - u],
        slopes: |[u, v], p| ([[0.0, 1.0], [-2.0 * u * v - 1.0, p - u * u]], [0.0, v]),
    };
    let lorenz = System {
        parameters: parameter("rho", 10.0),
        rates: |[x, y, z], p| [10.0 * (y - x), p * x - y - x * z, x * y - 8.0 / 3.0 * z],
        slopes: |[x, y, z], p| {
            ([[-10.0, 10.0, 0.0], [p - z, -1.0, -x], [y, x, -8.0 / 3.0]], [0.0, x, 0.0])
        },
    };
    let ppp = System {
        parameters: parameter("p1", 0.1),
        rates: |[a, b, c], p| {
            [
                a * (1.0 - a) - 3.0 * a * b,
                -0.25 * b + 3.0 * a * b - 3.0 * b * c - p * (1.0 - (-5.0 * b).exp()),
                -0.5 * c + 3.0 * b * c,
            ]
        },
        slopes: |[a, b, c], p| {
            let taken = (-5.0 * b).exp();
            (
                [
                    [1.0 - 2.0 * a - 3.0 * b, -3.0 * a, 0.0],
                    [3.0 * b, -0.25 + 3.0 * a - 3.0 * c - 5.0 * p * taken, -3.0 * b],
                    [0.0, 3.0 * c, -0.5 + 3.0 * b],
                ],
                [0.0, -(1.0 - taken), 0.0],
            )
        },
    };
    let fitzhugh_nagumo = System {
        parameters: parameter("I", 1.0),
        rates: |[v, w], p| [v - v * v * v / 3.0 - w + p, 0.08 * (v + 0.7 - 0.8 * w)],
        slopes: |[v, _], _| ([[1.0 - v * v, -1.0], [0.08, -0.064]], [1.0, 0.0]),
    };
    run(("FitzHugh-Nagumo", &fitzhugh_nagumo), ([-1.2, -0.62], 0.0, 2.0), (0, 1.2, 0.5), 3);
    run(("van der Pol, 5", &van_der_pol), ([0.0; 2], -1.0, 1.0), (0, 5.0, 1.0), 20);
    run(("van der Pol, 100", &van_der_pol), ([0.0; 2], -1.0, 1.0), (0, 100.0, 50.0), 3);
    let x = (8.0_f64 / 3.0 * 19.0).sqrt();
    run(("Lorenz, 15", &lorenz), ([x, x, 19.0], 20.0, 30.0), (0, 15.0, 1.0), 20);
    // prey and the first predator alone
    let b = 0.3_f64;
    let a = 1.0 - 3.0 * b;
    let p = (3.0 * a - 0.25) * b / (1.0 - (-5.0 * b).exp());
    run(("ppp", &ppp), ([a, b, 0.0], p, 0.35), (0, 0.25, 0.5), 20);
}
