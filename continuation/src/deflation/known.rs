//! The known solutions and the factor that removes them.
//!
//! ```text
//! m(u) = Π (1 + 1/q_i),    q_i = (u − u_i)·M(u − u_i) / ℓ²,
//! ∇ log m · x = − Σ 2 (u − u_i)·M x / (ℓ² q_i (q_i + 1)).
//! ```

use crate::any_problem::DynProblem;
use crate::step::dot;

/// Known solutions, and work space for distances from them.
pub(super) struct Known<'a> {
    problem: &'a DynProblem<'a>,
    /// The solutions.
    pub(super) solutions: Vec<Vec<f64>>,
    /// The length by which distances are divided; 0 until it is known.
    pub(super) length: f64,
    difference: Vec<f64>,
    metric: Vec<f64>,
}

impl<'a> Known<'a> {
    pub(super) fn new(problem: &'a DynProblem<'a>) -> Self {
        let n = problem.dim();
        Known {
            problem,
            solutions: Vec::new(),
            length: 0.0,
            difference: vec![0.0; n],
            metric: vec![0.0; n],
        }
    }

    /// Length of `x` in the problem's metric.
    pub(super) fn norm(&mut self, x: &[f64]) -> f64 {
        self.problem.metric(x, &mut self.metric);
        dot(x, &self.metric).max(0.0).sqrt()
    }

    /// Distance between two states.
    pub(super) fn distance(&mut self, u: &[f64], v: &[f64]) -> f64 {
        for i in 0..u.len() {
            self.difference[i] = u[i] - v[i];
        }
        self.problem.metric(&self.difference, &mut self.metric);
        dot(&self.difference, &self.metric).max(0.0).sqrt()
    }

    /// `log m` at `u`, and `∇ log m · x` with `mx = M x`; infinite at a known solution.
    pub(super) fn factor(&mut self, u: &[f64], mx: &[f64]) -> (f64, f64) {
        let (mut log, mut slope) = (0.0, 0.0);
        let l2 = self.length * self.length;
        for k in 0..self.solutions.len() {
            for i in 0..u.len() {
                self.difference[i] = u[i] - self.solutions[k][i];
            }
            self.problem.metric(&self.difference, &mut self.metric);
            let q = dot(&self.difference, &self.metric) / l2;
            log += q.recip().ln_1p();
            slope -= 2.0 * dot(&self.difference, mx) / (l2 * q * (q + 1.0));
        }
        (log, slope)
    }

    /// Distance of `u` from the nearest known solution; infinite if there is none.
    pub(super) fn apart(&mut self, u: &[f64]) -> f64 {
        let mut apart = f64::INFINITY;
        for k in 0..self.solutions.len() {
            let other = std::mem::take(&mut self.solutions[k]);
            apart = apart.min(self.distance(u, &other));
            self.solutions[k] = other;
        }
        apart
    }

    /// Whether `u` is, to `separation`, one of the known solutions.
    pub(super) fn contains(&mut self, u: &[f64], separation: f64) -> bool {
        let size = self.norm(u).max(self.length);
        for k in 0..self.solutions.len() {
            let other = std::mem::take(&mut self.solutions[k]);
            let near = separation * size.max(self.norm(&other));
            let distance = self.distance(u, &other);
            self.solutions[k] = other;
            if distance <= near {
                return true;
            }
        }
        false
    }
}
