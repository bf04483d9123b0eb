//! Small systems with derivatives by hand, and an independent integrator.

use continuation::linalg::{Dense, Matrix};
use continuation::{EvalError, ParamId, Parameter, Problem, Stability};

pub(crate) type Field = fn(&[f64], &[f64], &mut [f64]);
pub(crate) type Slopes = fn(&[f64], &[f64], &mut dyn FnMut(usize, usize, f64));

/// `du/dt = f(u, p)`; `slopes` visits the entries of the Jacobian, column `n + k` that of parameter `k`.
#[derive(Clone)]
pub(crate) struct System {
    pub(crate) n: usize,
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) field: Field,
    pub(crate) slopes: Slopes,
}

const fn parameter(name: &'static str, scale: f64) -> Parameter {
    Parameter::new(name, "", scale)
}

impl Problem for System {
    type Jacobian = Dense;

    fn dim(&self) -> usize {
        self.n
    }

    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn new_jacobian(&self) -> Dense {
        Dense::new(self.n)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        (self.field)(u, p, r);
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        j.set_zero();
        (self.slopes)(u, p, &mut |r, c, v| {
            if c < self.n {
                j.add(r, c, v);
            }
        });
        Ok(())
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        out.fill(0.0);
        (self.slopes)(u, p, &mut |r, c, v| {
            if c == self.n + which.0 {
                out[r] += v;
            }
        });
        Ok(())
    }

    fn stability(&self) -> Stability {
        Stability::Dynamics
    }
}

/// The van der Pol oscillator: period 6.66328686 at μ = 1.
pub(crate) fn van_der_pol() -> System {
    System {
        n: 2,
        parameters: vec![parameter("mu", 1.0)],
        field: |u, p, r| {
            r[0] = u[1];
            r[1] = p[0] * (1.0 - u[0] * u[0]) * u[1] - u[0];
        },
        slopes: |u, p, set| {
            set(0, 1, 1.0);
            set(1, 0, -2.0 * p[0] * u[0] * u[1] - 1.0);
            set(1, 1, p[0] * (1.0 - u[0] * u[0]));
            set(1, 2, (1.0 - u[0] * u[0]) * u[1]);
        },
    }
}

/// Lorenz with σ = 10, β = 8/3.
pub(crate) fn lorenz() -> System {
    System {
        n: 3,
        parameters: vec![parameter("rho", 10.0)],
        field: |u, p, r| {
            r[0] = 10.0 * (u[1] - u[0]);
            r[1] = u[0] * (p[0] - u[2]) - u[1];
            r[2] = u[0] * u[1] - 8.0 / 3.0 * u[2];
        },
        slopes: |u, p, set| {
            set(0, 0, -10.0);
            set(0, 1, 10.0);
            set(1, 0, p[0] - u[2]);
            set(1, 1, -1.0);
            set(1, 2, -u[0]);
            set(2, 0, u[1]);
            set(2, 1, u[0]);
            set(2, 2, -8.0 / 3.0);
            set(1, 3, u[0]);
        },
    }
}

/// The Hopf normal form, `s` +1 (supercritical) or −1: cycles of radius `√(μ/s)`, period 2π, with the
/// multiplier `exp(−4πμ)` for either sign.
pub(crate) fn hopf_form() -> System {
    System {
        n: 2,
        parameters: vec![parameter("mu", 1.0), parameter("s", 1.0)],
        field: |u, p, r| {
            let g = p[0] - p[1] * (u[0] * u[0] + u[1] * u[1]);
            r[0] = g * u[0] - u[1];
            r[1] = u[0] + g * u[1];
        },
        slopes: |u, p, set| {
            let square = u[0] * u[0] + u[1] * u[1];
            let g = p[0] - p[1] * square;
            set(0, 0, g - 2.0 * p[1] * u[0] * u[0]);
            set(0, 1, -1.0 - 2.0 * p[1] * u[0] * u[1]);
            set(1, 0, 1.0 - 2.0 * p[1] * u[0] * u[1]);
            set(1, 1, g - 2.0 * p[1] * u[1] * u[1]);
            set(0, 2, u[0]);
            set(1, 2, u[1]);
            set(0, 3, -square * u[0]);
            set(1, 3, -square * u[1]);
        },
    }
}

/// The Brusselator with A = 1: a Hopf point at B = 2.
pub(crate) fn brusselator() -> System {
    System {
        n: 2,
        parameters: vec![parameter("B", 1.0)],
        field: |u, p, r| {
            r[0] = 1.0 - (p[0] + 1.0) * u[0] + u[0] * u[0] * u[1];
            r[1] = p[0] * u[0] - u[0] * u[0] * u[1];
        },
        slopes: |u, p, set| {
            set(0, 0, -(p[0] + 1.0) + 2.0 * u[0] * u[1]);
            set(0, 1, u[0] * u[0]);
            set(1, 0, p[0] - 2.0 * u[0] * u[1]);
            set(1, 1, -u[0] * u[0]);
            set(0, 2, -u[0]);
            set(1, 2, u[0]);
        },
    }
}

/// Rössler with a = b = 0.2, in c.
pub(crate) fn roessler() -> System {
    System {
        n: 3,
        parameters: vec![parameter("c", 1.0)],
        field: |u, p, r| {
            r[0] = -u[1] - u[2];
            r[1] = u[0] + 0.2 * u[1];
            r[2] = 0.2 + u[2] * (u[0] - p[0]);
        },
        slopes: |u, p, set| {
            set(0, 1, -1.0);
            set(0, 2, -1.0);
            set(1, 0, 1.0);
            set(1, 1, 0.2);
            set(2, 0, u[2]);
            set(2, 2, u[0] - p[0]);
            set(2, 3, -u[2]);
        },
    }
}

/// `θ′ = 1 − p cos θ` on the unit circle.
pub(crate) fn slowing() -> System {
    System {
        n: 2,
        parameters: vec![parameter("p", 1.0)],
        field: |u, p, r| {
            let (rest, turn) = (1.0 - u[0] * u[0] - u[1] * u[1], 1.0 - p[0] * u[0]);
            r[0] = rest * u[0] - turn * u[1];
            r[1] = turn * u[0] + rest * u[1];
        },
        slopes: |u, p, set| {
            let (rest, turn) = (1.0 - u[0] * u[0] - u[1] * u[1], 1.0 - p[0] * u[0]);
            set(0, 0, rest - 2.0 * u[0] * u[0] + p[0] * u[1]);
            set(0, 1, -2.0 * u[0] * u[1] - turn);
            set(1, 0, turn - p[0] * u[0] - 2.0 * u[0] * u[1]);
            set(1, 1, rest - 2.0 * u[1] * u[1]);
            set(0, 2, u[0] * u[1]);
            set(1, 2, -u[0] * u[0]);
        },
    }
}

/// One extrapolated step of the modified midpoint rule, of order 16 (Gragg, Bulirsch and Stoer).
fn step(f: &dyn Fn(&[f64], &mut [f64]), x: &mut [f64], h: f64) {
    let n = x.len();
    let mut table: Vec<Vec<f64>> = Vec::new();
    let mut slope = vec![0.0; n];
    for level in 1..=8 {
        let parts = 2 * level;
        let part = h / parts as f64;
        let mut before = x.to_vec();
        f(&before, &mut slope);
        let mut here: Vec<f64> = (0..n).map(|i| x[i] + part * slope[i]).collect();
        for _ in 1..parts {
            f(&here, &mut slope);
            let next: Vec<f64> = (0..n).map(|i| before[i] + 2.0 * part * slope[i]).collect();
            before = std::mem::replace(&mut here, next);
        }
        let mut row = vec![here];
        for k in 1..level {
            let ratio = (level as f64 / (level - k) as f64).powi(2) - 1.0;
            let (last, old) = (&row[k - 1], &table[level - 2]);
            let old: Vec<f64> = old[(k - 1) * n..k * n].to_vec();
            row.push((0..n).map(|i| last[i] + (last[i] - old[i]) / ratio).collect());
        }
        table.push(row.concat());
    }
    let last = &table[7];
    x.copy_from_slice(&last[7 * n..]);
}

/// State and monodromy matrix (by columns) after a time, in equal steps.
pub(crate) fn flow(
    system: &System,
    p: &[f64],
    u: &[f64],
    time: f64,
    steps: usize,
) -> (Vec<f64>, Vec<f64>) {
    let n = system.n;
    let mut x = u.to_vec();
    x.extend((0..n * n).map(|i| f64::from(u8::from(i % n == i / n))));
    let right = |x: &[f64], out: &mut [f64]| {
        (system.field)(&x[..n], p, &mut out[..n]);
        out[n..].fill(0.0);
        (system.slopes)(&x[..n], p, &mut |r, c, v| {
            if c < n {
                for k in 0..n {
                    out[n + k * n + r] += v * x[n + k * n + c];
                }
            }
        });
    };
    for _ in 0..steps {
        step(&right, &mut x, time / steps as f64);
    }
    (x[..n].to_vec(), x[n..].to_vec())
}

/// A cycle by shooting from `u`, independent of the library: state, period and monodromy matrix. The
/// section is the plane across the flow at the guess.
pub(crate) fn shoot(
    system: &System,
    p: &[f64],
    u: &[f64],
    period: f64,
    steps: usize,
) -> (Vec<f64>, f64, Vec<f64>) {
    let n = system.n;
    let (mut u, mut period) = (u.to_vec(), period);
    let mut normal = vec![0.0; n];
    (system.field)(&u, p, &mut normal);
    let anchor = u.clone();
    for _ in 0..12 {
        let (end, monodromy) = flow(system, p, &u, period, steps);
        let mut speed = vec![0.0; n];
        (system.field)(&end, p, &mut speed);
        let mut a = Dense::new(n + 1);
        for c in 0..n {
            for r in 0..n {
                a.set(r, c, monodromy[c * n + r] - f64::from(u8::from(r == c)));
            }
            a.set(c, n, speed[c]);
            a.set(n, c, normal[c]);
        }
        let mut rhs: Vec<f64> = (0..n).map(|i| u[i] - end[i]).collect();
        rhs.push((0..n).map(|i| normal[i] * (anchor[i] - u[i])).sum());
        a.factor(1e-300);
        a.solve(&mut rhs);
        (0..n).for_each(|i| u[i] += rhs[i]);
        period += rhs[n];
        if rhs.iter().all(|x| x.abs() < 1e-11) {
            break;
        }
    }
    let (_, monodromy) = flow(system, p, &u, period, steps);
    (u, period, monodromy)
}

/// Eigenvalues of a matrix given by columns.
pub(crate) fn eigenvalues(n: usize, a: &[f64]) -> Vec<(f64, f64)> {
    let mut dense = Dense::new(n);
    for c in 0..n {
        dense.column_mut(c).copy_from_slice(&a[c * n..(c + 1) * n]);
    }
    dense.spectrum(None).unwrap()
}
