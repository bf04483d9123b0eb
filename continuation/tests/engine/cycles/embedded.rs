//! Systems with known cycles and multipliers in random coordinates.

use continuation::linalg::{Dense, Matrix};
use continuation::{EvalError, ParamId, Parameter, Problem, Stability};

pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// From −1 to 1.
    pub(crate) fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// What happens beside the circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Beside {
    /// `y′ = λ y`.
    Linear(f64),
    /// `y′ = (p − y²) y`: a pitchfork of cycles at `p = 0`.
    Pitchfork,
    /// Two unknowns: `z′ = (p − |z|² + iκ) z`: a torus at `p = 0`.
    Torus(f64),
    /// Two unknowns: a linear pair in coordinates that make half a turn per turn of the circle, so that
    /// the multipliers are `−exp(2π(p + a))` and `−exp(2π(p − a))` for the period `2π`.
    HalfTurn(f64),
}

/// On the circle `x′ = ν (g x − ω y)`, `y′ = ν (ω x + g y)` with `g = m − s r²`, or, with `fold`,
/// `g = p + r² − r⁴`; other unknowns beside it. Seen in the coordinates `u = A Ψ(y)`,
/// `Ψ_i = y_i + Σ_{k<i} a_ik y_k²`.
pub(crate) struct Embedded {
    pub(crate) nu: f64,
    pub(crate) omega: f64,
    pub(crate) m: f64,
    pub(crate) s: f64,
    pub(crate) fold: bool,
    /// How much of `p` is added to `m`.
    pub(crate) lift: f64,
    pub(crate) beside: Vec<Beside>,
    pub(crate) a: Vec<f64>,
    pub(crate) quadratic: Vec<f64>,
    pub(crate) mass: Option<Vec<f64>>,
    /// Of `a`, by columns.
    inverse: Vec<f64>,
}

static PARAMETERS: [Parameter; 1] = [Parameter::new("p", "", 1.0)];

impl Embedded {
    pub(crate) fn new(beside: Vec<Beside>, random: &mut Random, bend: f64) -> Self {
        let n = 2 + beside.iter().map(Beside::size).sum::<usize>();
        let mut a = vec![0.0; n * n];
        for (i, a) in a.iter_mut().enumerate() {
            *a = f64::from(u8::from(i % n == i / n)) + 0.35 * random.next();
        }
        let quadratic = (0..n * n).map(|_| bend * random.next()).collect();
        let mut factored = Dense::new(n);
        let mut inverse = vec![0.0; n * n];
        for c in 0..n {
            factored.column_mut(c).copy_from_slice(&a[c * n..(c + 1) * n]);
            inverse[c + c * n] = 1.0;
        }
        factored.factor(1e-300);
        inverse.chunks_exact_mut(n).for_each(|column| factored.solve(column));
        Embedded {
            nu: 1.0 + 0.4 * random.next(),
            omega: 1.0 + 0.4 * random.next(),
            m: 1.0,
            s: 1.0,
            fold: false,
            lift: 0.0,
            beside,
            a,
            quadratic,
            mass: None,
            inverse,
        }
    }

    fn n(&self) -> usize {
        2 + self.beside.iter().map(Beside::size).sum::<usize>()
    }

    pub(crate) fn period(&self) -> f64 {
        std::f64::consts::TAU / (self.nu * self.omega)
    }

    /// The image of a state of the inner coordinates.
    pub(crate) fn image(&self, y: &[f64]) -> Vec<f64> {
        let n = self.n();
        let z: Vec<f64> = (0..n)
            .map(|i| y[i] + (0..i).map(|k| self.quadratic[i + k * n] * y[k] * y[k]).sum::<f64>())
            .collect();
        (0..n).map(|r| (0..n).map(|c| self.a[r + c * n] * z[c]).sum()).collect()
    }

    /// The circle of radius `r` at time `t`.
    pub(crate) fn circle(&self, r: f64, t: f64, u: &mut [f64]) {
        let mut y = vec![0.0; self.n()];
        let (sin, cos) = (self.nu * self.omega * t).sin_cos();
        (y[0], y[1]) = (r * cos, r * sin);
        u.copy_from_slice(&self.image(&y));
    }

    fn inner(&self, u: &[f64]) -> Vec<f64> {
        let n = self.n();
        let z: Vec<f64> =
            (0..n).map(|r| (0..n).map(|c| self.inverse[r + c * n] * u[c]).sum()).collect();
        let mut y = vec![0.0; n];
        for i in 0..n {
            y[i] = z[i] - (0..i).map(|k| self.quadratic[i + k * n] * y[k] * y[k]).sum::<f64>();
        }
        y
    }

    /// Inner field and its derivatives, by `y` and, in column `n`, by `p`.
    fn field(&self, y: &[f64], p: f64, g: &mut [f64], d: &mut [f64]) {
        let n = self.n();
        d.fill(0.0);
        let square = y[0] * y[0] + y[1] * y[1];
        let (growth, slope, by_p) = if self.fold {
            (p + square - square * square, 1.0 - 2.0 * square, 1.0)
        } else {
            (self.m + self.lift * p - self.s * square, -self.s, self.lift)
        };
        let (nu, omega) = (self.nu, self.omega);
        g[0] = nu * (growth * y[0] - omega * y[1]);
        g[1] = nu * (omega * y[0] + growth * y[1]);
        let mut set = |r: usize, c: usize, v: f64| d[r + c * n] += v;
        for (r, v) in [(0, y[0]), (1, y[1])] {
            set(r, 0, nu * 2.0 * slope * y[0] * v);
            set(r, 1, nu * 2.0 * slope * y[1] * v);
            set(r, r, nu * growth);
            set(r, n, nu * by_p * v);
        }
        set(0, 1, -nu * omega);
        set(1, 0, nu * omega);
        let mut i = 2;
        for beside in &self.beside {
            match *beside {
                Beside::Linear(lambda) => {
                    g[i] = lambda * y[i];
                    set(i, i, lambda);
                }
                Beside::Pitchfork => {
                    g[i] = (p - y[i] * y[i]) * y[i];
                    set(i, i, p - 3.0 * y[i] * y[i]);
                    set(i, n, y[i]);
                }
                Beside::Torus(kappa) => {
                    let (a, b) = (y[i], y[i + 1]);
                    let rest = p - a * a - b * b;
                    g[i] = rest * a - kappa * b;
                    g[i + 1] = kappa * a + rest * b;
                    set(i, i, rest - 2.0 * a * a);
                    set(i, i + 1, -kappa - 2.0 * a * b);
                    set(i + 1, i, kappa - 2.0 * a * b);
                    set(i + 1, i + 1, rest - 2.0 * b * b);
                    set(i, n, a);
                    set(i + 1, n, b);
                }
                Beside::HalfTurn(split) => {
                    // in the frame that turns by half the angle θ: diag(p + a, p − a); x = r cos θ
                    let (a, b) = (y[i], y[i + 1]);
                    let cubic = a * a + b * b;
                    let (x, w) = (split * y[0], split * y[1]);
                    let half = 0.5 * self.nu * self.omega;
                    let rest = p - cubic;
                    g[i] = (rest + x) * a + (w - half) * b;
                    g[i + 1] = (w + half) * a + (rest - x) * b;
                    set(i, i, rest + x - 2.0 * a * a);
                    set(i, i + 1, w - half - 2.0 * a * b);
                    set(i + 1, i, w + half - 2.0 * a * b);
                    set(i + 1, i + 1, rest - x - 2.0 * b * b);
                    set(i, 0, split * a);
                    set(i, 1, split * b);
                    set(i + 1, 0, -split * b);
                    set(i + 1, 1, split * a);
                    set(i, n, a);
                    set(i + 1, n, b);
                }
            }
            i += beside.size();
        }
    }

    /// `DΨ x`.
    fn push(&self, y: &[f64], x: &[f64]) -> Vec<f64> {
        let n = self.n();
        let z: Vec<f64> = (0..n)
            .map(|i| {
                x[i] + (0..i).map(|k| 2.0 * self.quadratic[i + k * n] * y[k] * x[k]).sum::<f64>()
            })
            .collect();
        let v: Vec<f64> = (0..n).map(|r| (0..n).map(|c| self.a[r + c * n] * z[c]).sum()).collect();
        self.weighted(v)
    }

    /// With a mass matrix the equations are multiplied by it.
    fn weighted(&self, v: Vec<f64>) -> Vec<f64> {
        let n = self.n();
        match &self.mass {
            None => v,
            Some(m) => (0..n).map(|r| (0..n).map(|c| m[r + c * n] * v[c]).sum()).collect(),
        }
    }
}

impl Beside {
    fn size(&self) -> usize {
        match self {
            Beside::Linear(_) | Beside::Pitchfork => 1,
            Beside::Torus(_) | Beside::HalfTurn(_) => 2,
        }
    }
}

impl Problem for Embedded {
    type Jacobian = Dense;

    fn dim(&self) -> usize {
        self.n()
    }

    fn parameters(&self) -> &[Parameter] {
        &PARAMETERS
    }

    fn new_jacobian(&self) -> Dense {
        Dense::new(self.n())
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let n = self.n();
        let y = self.inner(u);
        let (mut g, mut d) = (vec![0.0; n], vec![0.0; n * (n + 1)]);
        self.field(&y, p[0], &mut g, &mut d);
        r.copy_from_slice(&self.push(&y, &g));
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        let n = self.n();
        let y = self.inner(u);
        let (mut g, mut d) = (vec![0.0; n], vec![0.0; n * (n + 1)]);
        self.field(&y, p[0], &mut g, &mut d);
        for c in 0..n {
            // the direction of the inner coordinates that unknown c moves
            let z = &self.inverse[c * n..(c + 1) * n];
            let mut x = vec![0.0; n];
            for i in 0..n {
                let sum: f64 = (0..i).map(|k| 2.0 * self.quadratic[i + k * n] * y[k] * x[k]).sum();
                x[i] = z[i] - sum;
            }
            let along: Vec<f64> =
                (0..n).map(|r| (0..n).map(|k| d[r + k * n] * x[k]).sum()).collect();
            let mut column = self.push(&y, &along);
            let second: Vec<f64> = (0..n)
                .map(|i| (0..i).map(|k| 2.0 * self.quadratic[i + k * n] * x[k] * g[k]).sum())
                .collect();
            let second: Vec<f64> =
                (0..n).map(|r| (0..n).map(|k| self.a[r + k * n] * second[k]).sum()).collect();
            column.iter_mut().zip(self.weighted(second)).for_each(|(a, b)| *a += b);
            j.column_mut(c).copy_from_slice(&column);
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
        let n = self.n();
        let y = self.inner(u);
        let (mut g, mut d) = (vec![0.0; n], vec![0.0; n * (n + 1)]);
        self.field(&y, p[0], &mut g, &mut d);
        out.copy_from_slice(&self.push(&y, &d[n * n..]));
        Ok(())
    }

    fn stability(&self) -> Stability {
        Stability::Dynamics
    }

    fn mass(&self, m: &mut Dense) -> bool {
        let n = self.n();
        let Some(mass) = &self.mass else { return false };
        (0..n).for_each(|c| m.column_mut(c).copy_from_slice(&mass[c * n..(c + 1) * n]));
        true
    }
}
