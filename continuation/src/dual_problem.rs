//! A small problem written once for every kind of number: derivatives by dual numbers.

use crate::linalg::{Dense, Matrix};
use crate::name::Name;
use crate::pool::Pool;
use crate::problem::{EvalError, ParamId, Parameter, Problem, Stability, check_finite};
use num_dual::{Dual64, DualNum};

/// A number on which a residual is evaluated: `f64`, or one that carries derivatives along.
pub trait Number: DualNum<Primitive = f64> + Copy {}
impl<D: DualNum<Primitive = f64> + Copy> Number for D {}

/// `f(u, p)` on any kind of [`Number`].
pub trait Residual: Send + Sync {
    /// Number of unknowns.
    fn dim(&self) -> usize;
    /// The parameters, in the order of `p`.
    fn parameters(&self) -> &[Parameter];
    /// `r = f(u, p)`; `u` and `r` have length [`Residual::dim`], `p` that of [`Residual::parameters`].
    /// A state without a value gives NaN, which the problem reports as an error.
    fn evaluate<D: Number>(&self, u: &[D], p: &[D], r: &mut [D]);
    /// What the Jacobian's eigenvalues mean; by default `f` is `du/dt`.
    fn stability(&self) -> Stability {
        Stability::Dynamics
    }
    /// Names of what [`Residual::observe`] computes.
    fn observables(&self) -> &[Name] {
        &[]
    }
    /// Scalar functions of a state, `out` in the order of [`Residual::observables`].
    fn observe<D: Number>(&self, u: &[D], p: &[D], out: &mut [D]) {
        let _ = (u, p, out);
    }
}

/// `f(u, p) = 0` with a dense Jacobian that is exact to rounding: one evaluation of `f` on dual
/// numbers for each unknown. For up to some tens of unknowns. With the feature `dual`.
///
/// ```
/// use continuation::{DualProblem, Number, Parameter, Residual, Settings, Tracer};
/// use std::ops::ControlFlow;
///
/// struct Brusselator(Vec<Parameter>);
/// impl Residual for Brusselator {
///     fn dim(&self) -> usize { 2 }
///     fn parameters(&self) -> &[Parameter] { &self.0 }
///     fn evaluate<D: Number>(&self, u: &[D], p: &[D], r: &mut [D]) {
///         let (x, y, b) = (u[0], u[1], p[0]);
///         r[0] = x * x * y - x * (b + 1.0) + 1.0;
///         r[1] = x * b - x * x * y;
///     }
/// }
/// let problem = DualProblem::new(Brusselator(vec![Parameter::new("b", "", 1.0)]));
/// let settings = Settings { target: Some(3.0), ..Settings::default() };
/// let branch = Tracer::new(&problem, "b", &[1.0, 1.0], &[1.0], settings)?
///     .run(&mut |_| ControlFlow::Continue(()));
/// let hopf = &branch.events[0];
/// assert!((hopf.p - 2.0).abs() < 1e-12 && hopf.hopf().unwrap().lyapunov < 0.0);
/// # Ok::<(), continuation::TraceError>(())
/// ```
pub struct DualProblem<R> {
    residual: R,
    scratch: Pool<Scratch>,
}

struct Scratch {
    u: Vec<Dual64>,
    p: Vec<Dual64>,
    r: Vec<Dual64>,
    observed: Vec<Dual64>,
}

impl<R: Residual> DualProblem<R> {
    /// The problem of this residual.
    pub fn new(residual: R) -> Self {
        let scratch = Pool::new(Scratch::new(&residual));
        DualProblem { residual, scratch }
    }

    /// The residual.
    pub fn residual(&self) -> &R {
        &self.residual
    }

    fn with<T>(&self, evaluate: impl FnOnce(&mut Scratch) -> T) -> T {
        self.scratch.with(|| Scratch::new(&self.residual), evaluate)
    }
}

impl Scratch {
    fn new(residual: &impl Residual) -> Self {
        let zero = Dual64::from_re(0.0);
        let n = residual.dim();
        Scratch {
            u: vec![zero; n],
            p: vec![zero; residual.parameters().len()],
            r: vec![zero; n],
            observed: vec![zero; residual.observables().len()],
        }
    }

    /// The state, with derivatives along `(du, dp)`; missing ones are zero.
    fn place(
        &mut self,
        u: &[f64],
        p: &[f64],
        du: impl Fn(usize) -> f64,
        dp: impl Fn(usize) -> f64,
    ) {
        for (i, (x, v)) in self.u.iter_mut().zip(u).enumerate() {
            *x = Dual64::new(*v, du(i));
        }
        for (i, (x, v)) in self.p.iter_mut().zip(p).enumerate() {
            *x = Dual64::new(*v, dp(i));
        }
    }
}

fn unit(k: usize) -> impl Fn(usize) -> f64 {
    move |i| if i == k { 1.0 } else { 0.0 }
}

impl<R: Residual> Problem for DualProblem<R> {
    type Jacobian = Dense;

    fn dim(&self) -> usize {
        self.residual.dim()
    }

    fn parameters(&self) -> &[Parameter] {
        self.residual.parameters()
    }

    fn new_jacobian(&self) -> Dense {
        Dense::new(self.dim())
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        self.residual.evaluate(u, p, r);
        check_finite(r)
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        self.with(|scratch| {
            j.set_zero();
            for k in 0..u.len() {
                scratch.place(u, p, unit(k), |_| 0.0);
                let Scratch { u, p, r, .. } = scratch;
                self.residual.evaluate(u, p, r);
                for (a, r) in j.column_mut(k).iter_mut().zip(r.iter()) {
                    *a = r.eps;
                }
                check_finite(j.column(k))?;
            }
            Ok(())
        })
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        self.with(|scratch| {
            scratch.place(u, p, |_| 0.0, unit(which.0));
            let Scratch { u, p, r, .. } = scratch;
            self.residual.evaluate(u, p, r);
            out.iter_mut().zip(r.iter()).for_each(|(o, r)| *o = r.eps);
            check_finite(out)
        })
    }

    fn stability(&self) -> Stability {
        self.residual.stability()
    }

    fn observables(&self) -> &[Name] {
        self.residual.observables()
    }

    fn observe(&self, u: &[f64], p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        self.residual.observe(u, p, out);
        check_finite(out)
    }

    fn observable_slope(
        &self,
        k: usize,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        du: &[f64],
        dp: f64,
    ) -> Result<Option<f64>, EvalError> {
        self.with(|scratch| {
            scratch.place(u, p, |i| du[i], |i| if i == which.0 { dp } else { 0.0 });
            let Scratch { u, p, observed, .. } = scratch;
            self.residual.observe(u, p, observed);
            Ok(Some(observed[k].eps))
        })
    }
}
