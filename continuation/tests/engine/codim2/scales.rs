//! Curves do not depend on how wide the domain is, nor on where on them they begin.

use super::{account, follow, of_kind, trace};
use continuation::codim2::{BranchPointCurve, Curve, FoldCurve, HopfCurve};
use continuation::linalg::Dense;
use continuation::{
    Branch, DenseProblem, EvalError, Event, EventKind, ParamId, Parameter, Problem, Settings,
    Stability,
};
use std::ops::ControlFlow;

/// A function of unknowns and parameters.
trait Values: Fn(&[f64], &[f64], &mut [f64]) + Send + Sync {}
impl<F: Fn(&[f64], &[f64], &mut [f64]) + Send + Sync> Values for F {}

/// A problem with its derivatives: `f`, then `∂f_i/∂(u, p)_j` row by row.
struct Exact<F, D> {
    n: usize,
    parameters: Vec<Parameter>,
    f: F,
    d: D,
}

impl<F: Values, D: Values> Exact<F, D> {
    fn new(n: usize, names: &[&'static str], f: F, d: D) -> Self {
        let parameters = names.iter().map(|name| Parameter::new(name, "", 1.0)).collect();
        Exact { n, parameters, f, d }
    }

    fn derivative(&self, u: &[f64], p: &[f64], i: usize, j: usize) -> f64 {
        let columns = self.n + self.parameters.len();
        let mut all = vec![0.0; self.n * columns];
        (self.d)(u, p, &mut all);
        all[i * columns + j]
    }
}

impl<F: Values, D: Values> Problem for Exact<F, D> {
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
        (self.f)(u, p, r);
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        for i in 0..self.n {
            for k in 0..self.n {
                j.set(i, k, self.derivative(u, p, i, k));
            }
        }
        Ok(())
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        for (i, out) in out.iter_mut().enumerate() {
            *out = self.derivative(u, p, i, self.n + which.0);
        }
        Ok(())
    }

    fn stability(&self) -> Stability {
        Stability::Dynamics
    }
}

const BETA: f64 = 0.74;

fn reactor(x: &[f64], p: &[f64], r: &mut [f64]) {
    let (u, v, [d, b]) = (x[0], x[1], [p[0], p[1]]);
    let rate = d * (1.0 - u) * v.exp();
    r[0] = -u + rate;
    r[1] = -v + b * rate - BETA * v;
}

fn reactor_derivatives(x: &[f64], p: &[f64], d: &mut [f64]) {
    let (u, v, [a, b]) = (x[0], x[1], [p[0], p[1]]);
    let e = v.exp();
    let all = [
        -1.0 - a * e,
        a * (1.0 - u) * e,
        (1.0 - u) * e,
        0.0,
        -a * b * e,
        -1.0 - BETA + a * b * (1.0 - u) * e,
        b * (1.0 - u) * e,
        a * (1.0 - u) * e,
    ];
    d.copy_from_slice(&all);
}

fn hopf_curve<P: Problem>(
    problem: &P,
    branch: &Branch,
    event: &Event,
    second: &str,
    domain: (f64, f64),
) -> Curve {
    let settings = Settings { domain: Some(domain), ..Settings::default() };
    HopfCurve::at(problem, branch, event, second)
        .unwrap()
        .trace(&settings, &[], &mut |_| ControlFlow::Continue(()))
        .unwrap()
}

fn reactor_takens<P: Problem>(problem: &P) {
    let branch = trace(problem, "d", &[0.0, 0.0], &[0.0, 7.06], 0.5);
    assert_eq!(branch.events_of(&EventKind::Hopf).count(), 2);
    for event in branch.events_of(&EventKind::Hopf) {
        for domain in [(5.0, 15.0), (7.0, 8.0), (2.0, 30.0), (7.05, 7.2)] {
            let found = hopf_curve(problem, &branch, event, "b", domain);
            println!("{domain:?} {}", account(&found, "d"));
            let takens = of_kind(&found, &EventKind::BogdanovTakens);
            assert_eq!(takens.len(), 1, "{domain:?}");
            assert!((takens[0].p - (1.0 + BETA).powi(3) / BETA).abs() < 1e-9, "{domain:?}");
            // l₁ = 0 at B = 8.9535044406
            let general = of_kind(&found, &EventKind::GeneralisedHopf);
            assert_eq!(general.len(), usize::from(domain.1 > 9.0), "{domain:?}");
        }
    }
}

/// A stirred tank: Bogdanov-Takens at `B = (1 + β)³/β`, from either Hopf point.
#[test]
fn the_double_zero_of_a_reactor_in_every_domain() {
    reactor_takens(&DenseProblem::from_residual(2, &["d", "b"], reactor).boxed());
    reactor_takens(&Exact::new(2, &["d", "b"], reactor, reactor_derivatives));
}

fn ends_at(curve: &Curve, (low, high): (f64, f64)) {
    let ends = [curve.branch.points.first(), curve.branch.points.last()].map(|x| x.unwrap().p);
    assert!(ends == [low, high] || ends == [high, low], "{ends:?}");
}

/// `z' = (p − a + c a²/2) z + i z` with `a = |z|²/q²`: Hopf points at `p = 0` for every `q`.
#[test]
fn a_hopf_curve_on_which_nothing_moves() {
    for c in [0.0, 0.5, -1.0] {
        for q0 in [1.0, 1e-3, 30.0] {
            let problem = DenseProblem::from_residual(2, &["p", "q"], move |x, p, r| {
                let a = (x[0] * x[0] + x[1] * x[1]) / (p[1] * p[1]);
                let g = p[0] - a + c * a * a / 2.0;
                r[0] = g * x[0] - x[1];
                r[1] = g * x[1] + x[0];
            })
            .boxed();
            let branch = trace(&problem, "p", &[0.0, 0.0], &[-0.5, q0], 0.5);
            let event = branch.events_of(&EventKind::Hopf).next().unwrap();
            let domain = (0.5 * q0, 2.0 * q0);
            let found = hopf_curve(&problem, &branch, event, "q", domain);
            println!("{c} {q0} {domain:?} {}", account(&found, "p"));
            ends_at(&found, domain);
            assert!(found.branch.events.is_empty());
            assert!(found.column("p").unwrap().iter().all(|p| p.abs() < 1e-9));
        }
    }
}

/// `p x − x³ + b x²`: branch points at `x = p = 0` for every `b`.
#[test]
fn a_branch_point_curve_on_which_nothing_moves() {
    for b in [0.0, 0.1, 1.0, -2.0] {
        let problem = DenseProblem::from_residual(1, &["p", "b"], |x, p, r| {
            r[0] = p[0] * x[0] - x[0].powi(3) + p[1] * x[0] * x[0];
        })
        .boxed();
        let branch = trace(&problem, "p", &[0.0], &[-1.0, b], 1.0);
        let event = branch.events_of(&EventKind::BranchPoint).next().unwrap();
        let curve = BranchPointCurve::at(&problem, &branch, event, "b").unwrap();
        for domain in [(-3.0, 3.0), (-100.0, 100.0)] {
            let settings = Settings { domain: Some(domain), ..Settings::default() };
            let found = curve.trace(&settings, &[], &mut |_| ControlFlow::Continue(())).unwrap();
            println!("{b} {domain:?} {}", account(&found, "p"));
            ends_at(&found, domain);
            for point in &found.branch.points {
                assert!(point.u[0].abs() < 1e-9 && point.u[2].abs() < 1e-9, "{:?}", point.u);
            }
        }
    }
}

/// `p/q = x/q − (x/q)³/3`: folds at `p = ±2q/3`.
#[test]
fn a_fold_line_to_the_end_of_every_domain() {
    let f = |x: &[f64], p: &[f64], r: &mut [f64]| {
        let y = x[0] / p[1];
        r[0] = p[0] / p[1] - y + y * y * y / 3.0;
    };
    let d = |x: &[f64], p: &[f64], d: &mut [f64]| {
        let (y, q) = (x[0] / p[1], p[1]);
        d[0] = (-1.0 + y * y) / q;
        d[1] = 1.0 / q;
        d[2] = -p[0] / (q * q) - (-1.0 + y * y) * x[0] / (q * q);
    };
    let problem = Exact::new(1, &["p", "q"], f, d);
    let branch = trace(&problem, "p", &[-2.1], &[1.0, 1.0], -2.0);
    for event in branch.events_of(&EventKind::Fold) {
        let curve = FoldCurve::at(&problem, &branch, event, "q").unwrap();
        for domain in [(0.01, 2.0), (1e-3, 1e3), (1e-6, 10.0), (0.9, 1.1)] {
            let found = follow(&curve, domain, None, &[]);
            println!("{domain:?} {}", account(&found, "p"));
            ends_at(&found, domain);
            for (point, p) in found.branch.points.iter().zip(found.column("p").unwrap()) {
                assert!((p.abs() / point.p - 2.0 / 3.0).abs() < 1e-9);
            }
            assert!(found.branch.events.is_empty());
        }
    }
}

fn ring(x: &[f64], p: &[f64], r: &mut [f64]) {
    let (v, k3) = (p[0], p[1].powi(3));
    for i in 0..3 {
        r[i] = v * k3 / (k3 + x[(i + 2) % 3].powi(3)) - 0.1 * x[i];
    }
}

fn ring_derivatives(x: &[f64], p: &[f64], d: &mut [f64]) {
    let (v, k3) = (p[0], p[1].powi(3));
    d.fill(0.0);
    for i in 0..3 {
        let j = (i + 2) % 3;
        let (y3, s) = (x[j].powi(3), k3 + x[j].powi(3));
        d[i * 5 + i] = -0.1;
        d[i * 5 + j] = -3.0 * v * k3 * x[j] * x[j] / (s * s);
        d[i * 5 + 3] = k3 / s;
        d[i * 5 + 4] = 3.0 * v * p[1] * p[1] * y3 / (s * s);
    }
}

/// Three repressors in a ring: Hopf points on the line `v = 0.3·2^(1/3)·K`, on which `l₁ ~ −1/K²`.
#[test]
fn no_generalised_hopf_point_where_the_coefficient_tends_to_zero() {
    let problem = Exact::new(3, &["v", "k"], ring, ring_derivatives);
    let k = 20.0;
    let mut u = vec![0.5 * k; 3];
    let p = [0.1 * k, k];
    continuation::newton(&problem, &mut u, &p, &Default::default()).unwrap();
    let branch = trace(&problem, "v", &u, &p, k);
    let event = branch.events_of(&EventKind::Hopf).next().unwrap();
    for domain in [(10.0, 40.0), (0.2, 1000.0), (0.2, 1e6)] {
        let found = hopf_curve(&problem, &branch, event, "k", domain);
        println!("{domain:?} {}", account(&found, "v"));
        ends_at(&found, domain);
        assert!(found.branch.events.is_empty());
        for (point, v) in found.branch.points.iter().zip(found.column("v").unwrap()) {
            assert!((v / point.p / (0.3 * 2_f64.cbrt()) - 1.0).abs() < 1e-9);
        }
    }
}
