//! Polynomial equations from a list of terms.

use continuation::linalg::Dense;
use continuation::{EvalError, ParamId, Parameter, Problem, Stability};

/// A coefficient, and the exponents of the unknowns and of the parameter.
type Term = (f64, Vec<i32>);

pub(crate) struct Polynomial {
    equations: Vec<Vec<Term>>,
}

#[derive(serde::Deserialize)]
struct File {
    start: Vec<f64>,
    p: f64,
    equations: Vec<Vec<Term>>,
}

impl Polynomial {
    /// From the terms of each equation.
    #[allow(dead_code, reason = "some tests read their equations")]
    pub(crate) fn new(equations: Vec<Vec<Term>>) -> Self {
        Polynomial { equations }
    }

    /// The problem, with the unknowns and the parameter at a solution.
    #[allow(dead_code, reason = "some tests make their equations")]
    pub(crate) fn read(text: &str) -> (Self, Vec<f64>, f64) {
        let File { start, p, equations } = serde_json::from_str(text).unwrap();
        (Polynomial { equations }, start, p)
    }

    /// Derivative of an equation by a variable, the parameter last.
    fn derivative(&self, equation: usize, k: usize, u: &[f64], p: &[f64]) -> f64 {
        let terms = self.equations[equation].iter().filter(|(_, powers)| powers[k] > 0);
        let term = |(coefficient, powers): &Term| {
            let factors =
                u.iter().chain(p).zip(powers).enumerate().map(|(i, (x, &q))| {
                    if i == k { f64::from(q) * x.powi(q - 1) } else { x.powi(q) }
                });
            coefficient * factors.product::<f64>()
        };
        terms.map(term).sum()
    }
}

impl Problem for Polynomial {
    type Jacobian = Dense;

    fn dim(&self) -> usize {
        self.equations.len()
    }

    fn parameters(&self) -> &[Parameter] {
        const P: &[Parameter] = &[Parameter::new("p", "", 1.0)];
        P
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        for (r, terms) in r.iter_mut().zip(&self.equations) {
            let term = |(coefficient, powers): &Term| {
                let factors = u.iter().chain(p).zip(powers).map(|(x, q)| x.powi(*q));
                coefficient * factors.product::<f64>()
            };
            *r = terms.iter().map(term).sum();
        }
        Ok(())
    }

    fn new_jacobian(&self) -> Dense {
        Dense::new(self.dim())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        for i in 0..self.dim() {
            for k in 0..self.dim() {
                j.set(i, k, self.derivative(i, k, u, p));
            }
        }
        Ok(())
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        _which: ParamId,
        dr: &mut [f64],
    ) -> Result<(), EvalError> {
        for (i, d) in dr.iter_mut().enumerate() {
            *d = self.derivative(i, self.dim(), u, p);
        }
        Ok(())
    }

    fn stability(&self) -> Stability {
        Stability::Dynamics
    }
}
