//! The problem whose special points form a curve, and how its two parameters are measured.

use crate::any_problem::DynProblem;
use crate::branch::{Branch, Event, EventKind, Point};
use crate::linalg::{Matrix, max_abs};
use crate::name::{Name, listed};
use crate::problem::{EvalError, ParamId, Parameter};
use crate::singular::{Extended, Probe};
use crate::step::{Weights, dot};
use crate::tracer::TraceError;

/// Why a curve of special points could not begin.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CurveError {
    /// No parameter of that name.
    #[error("no parameter `{name}`; there are: {known}")]
    UnknownParameter {
        /// The name asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// The second parameter is the one that is continued already.
    #[error("`{name}` is the parameter of the branch; a curve needs another one besides")]
    SameParameter {
        /// Its name.
        name: String,
    },
    /// The event is of another kind.
    #[error("the event is a {found}, not a {wanted}")]
    Kind {
        /// What it is.
        found: EventKind,
        /// What is needed.
        wanted: EventKind,
    },
    /// The branch is not one of this problem, or does not hold the event.
    #[error("the branch is not one of this problem through that special point: {what}")]
    Foreign {
        /// What does not fit.
        what: &'static str,
    },
    /// The problem has no value at the special point.
    #[error("the problem has no value at the special point: {0}")]
    Evaluation(#[from] EvalError),
    /// The Jacobian is not singular once: no null vectors.
    #[error("no simple null vector at the special point")]
    NoNullVector,
    /// The matrix of the problem has no complex form ([`crate::Matrix::complex`]).
    #[error("curves of Hopf points need a matrix with a complex form; this type has none")]
    NoComplexForm,
    /// The curve could not begin.
    #[error(transparent)]
    Trace(#[from] TraceError),
}

/// Lengths by which unknowns and first parameter are measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scales {
    /// Range of the unknowns, in the problem's metric.
    pub(super) unknowns: f64,
    /// Range of the first parameter.
    pub(super) first: f64,
    /// Typical size of the second one.
    pub(super) second: f64,
    /// Length of a unit of the first parameter in the problem's metric.
    pub(super) metric: f64,
}

/// The problem, its first parameter, now an unknown, and its second.
#[derive(Clone)]
pub(super) struct Underlying<'a> {
    pub(super) problem: &'a DynProblem<'a>,
    pub(super) first: ParamId,
    pub(super) second: ParamId,
    pub(super) scales: Scales,
    /// All parameters but the first.
    pub(super) parameters: Vec<Parameter>,
    /// The state of the special point.
    pub(super) u: Vec<f64>,
    /// All parameters there.
    pub(super) p: Vec<f64>,
    zero: Vec<f64>,
    /// Whether the unknowns vary along the branch.
    moves: bool,
}

impl<'a> Underlying<'a> {
    pub(super) fn at(
        problem: &'a DynProblem<'a>,
        branch: &Branch,
        event: &Event,
        second: &str,
        wanted: EventKind,
    ) -> Result<Self, CurveError> {
        if event.kind != wanted {
            return Err(CurveError::Kind { found: event.kind.clone(), wanted });
        }
        let foreign = |what| CurveError::Foreign { what };
        let all = problem.parameters();
        let index = |name: &str| all.iter().position(|q| q.name == name).map(ParamId);
        let first = index(&branch.parameter).ok_or(foreign("it has no such parameter"))?;
        let second = index(second).ok_or_else(|| CurveError::UnknownParameter {
            name: second.to_owned(),
            known: listed(all),
        })?;
        if first == second {
            return Err(CurveError::SameParameter { name: branch.parameter.clone() });
        }
        let at = branch.points.get(event.point).ok_or(foreign("it has no such point"))?;
        if at.u.len() != problem.dim() || branch.parameters.len() != all.len() {
            return Err(foreign("the dimensions differ"));
        }
        let mut p = branch.parameters.clone();
        p[first.0] = at.p;
        let (scales, moves) = scales(problem, branch, at, first, second);
        let rest = (0..all.len()).filter(|i| *i != first.0);
        Ok(Underlying {
            problem,
            first,
            second,
            scales,
            parameters: rest.map(|i| all[i].clone()).collect(),
            u: at.u.clone(),
            p,
            zero: vec![0.0; problem.dim()],
            moves,
        })
    }

    /// The same of the equations of cycles, on a mesh on which no branch was traced: `scales` are those of the
    /// unknowns and of the first parameter.
    pub(super) fn of_cycles(
        problem: &'a DynProblem<'a>,
        (first, second): (ParamId, ParamId),
        (u, p): (Vec<f64>, Vec<f64>),
        (unknowns, range): (f64, f64),
    ) -> Self {
        let all = problem.parameters();
        let typical = all[second.0].scale.abs();
        let scales = Scales {
            unknowns,
            first: range,
            second: if typical > 0.0 && typical.is_finite() { typical } else { 1.0 },
            metric: unknowns / range,
        };
        let rest = (0..all.len()).filter(|i| *i != first.0);
        Underlying {
            problem,
            first,
            second,
            scales,
            parameters: rest.map(|i| all[i].clone()).collect(),
            zero: vec![0.0; u.len()],
            u,
            p,
            moves: true,
        }
    }

    /// The same from another state.
    pub(super) fn from(&self, u: Vec<f64>, p: Vec<f64>) -> Self {
        Underlying {
            problem: self.problem,
            first: self.first,
            second: self.second,
            scales: self.scales,
            parameters: self.parameters.clone(),
            u,
            p,
            zero: self.zero.clone(),
            moves: self.moves,
        }
    }

    /// Where the unknowns do not vary along the branch but for rounding (the trivial solution of a
    /// symmetric problem), their scale is the amplitude of the critical mode `v` at which the
    /// nonlinearity does to it as much as the first parameter over its range.
    pub(super) fn widen(&mut self, v: &[f64]) -> Result<(), EvalError> {
        let (n, problem) = (self.problem.dim(), self.problem);
        let Scales { unknowns, first, .. } = self.scales;
        let weights = Weights { unknowns, parameter: first };
        let mut probe = Probe::new(problem, self.first, &self.p, weights);
        let z = Extended { u: self.u.clone(), p: self.p[self.first.0] };
        probe.assemble(&z)?;
        let along = Extended { u: vec![0.0; n], p: first };
        let mode = Extended { u: v.to_vec(), p: 0.0 };
        let by_parameter = max_abs(&probe.second(&z, &along, 1.0, &[&mode])?[0]);
        let mut product = vec![0.0; n];
        probe.jacobian.mul(v, &mut product);
        let reference = if by_parameter > 0.0 { by_parameter } else { max_abs(&product) };
        let Some(amplitude) = probe.amplitude(&z, &mode, reference) else { return Ok(()) };
        let natural = amplitude * self.length(v, &mut product);
        if !self.moves || unknowns < 1e-6 * natural {
            self.scales.unknowns = natural;
            if problem.unknown_scale(self.first).is_none() {
                self.scales.metric = natural / first;
            }
        }
        Ok(())
    }

    /// Index of a parameter of the curve among the problem's.
    pub(super) fn original(&self, which: ParamId) -> ParamId {
        ParamId(which.0 + usize::from(which.0 >= self.first.0))
    }

    /// Index of the second parameter among those of the curve.
    pub(super) fn second_of_curve(&self) -> ParamId {
        ParamId(self.second.0 - usize::from(self.second.0 > self.first.0))
    }

    /// The start's parameters of the curve.
    pub(super) fn start(&self) -> Vec<f64> {
        let rest = (0..self.p.len()).filter(|i| *i != self.first.0);
        rest.map(|i| self.p[i]).collect()
    }

    /// All parameters of the problem from those of the curve and the first one's value.
    pub(super) fn fill(&self, first: f64, curve: &[f64], p: &mut [f64]) {
        for (i, value) in curve.iter().enumerate() {
            p[self.original(ParamId(i)).0] = *value;
        }
        p[self.first.0] = first;
    }

    /// `y = M x` on the unknowns and the first parameter.
    pub(super) fn metric(&self, x: &[f64], y: &mut [f64]) {
        let n = self.problem.dim();
        self.problem.metric(&x[..n], &mut y[..n]);
        y[n] = self.scales.metric.powi(2) * x[n];
    }

    /// The scale that the unknowns share with both parameters.
    pub(super) fn unknown_scale(&self, which: ParamId) -> Option<f64> {
        let one = self.problem.unknown_scale(self.first)?;
        let other = self.problem.unknown_scale(self.original(which))?;
        (one == other).then_some(one)
    }

    /// Length in the problem's metric; Euclidean where that vanishes.
    pub(super) fn length(&self, x: &[f64], scratch: &mut [f64]) -> f64 {
        self.problem.metric(x, scratch);
        let square = dot(x, scratch);
        if square > 0.0 { square.sqrt() } else { dot(x, x).sqrt() }
    }

    /// Names of the first parameter, the problem's own observables and the `tests`.
    pub(super) fn names(&self, tests: &[&'static str]) -> Vec<Name> {
        let own = self.problem.observables().iter().cloned();
        let first = self.problem.parameters()[self.first.0].name.clone();
        std::iter::once(first).chain(own).chain(tests.iter().map(|test| (*test).into())).collect()
    }

    /// The problem's own observable `k` along `(du, dp, dq)`, where it knows that itself.
    pub(super) fn own_slope(
        &self,
        k: usize,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        du: &[f64],
        dq: f64,
    ) -> Result<Option<f64>, EvalError> {
        let n = self.problem.dim();
        let by_first = self.problem.observable_slope(k, u, p, self.first, &du[..n], du[n])?;
        let Some(by_first) = by_first else { return Ok(None) };
        let rest = self.problem.observable_slope(k, u, p, self.original(which), &self.zero, dq)?;
        Ok(rest.map(|by_second| by_first + by_second))
    }
}

/// The ranges along the branch on which the special point lies.
fn scales(
    problem: &DynProblem<'_>,
    branch: &Branch,
    at: &Point,
    first: ParamId,
    second: ParamId,
) -> (Scales, bool) {
    let n = problem.dim();
    let (mut d, mut m) = (vec![0.0; n], vec![0.0; n]);
    let (mut unknowns, mut range) = (0.0_f64, 0.0_f64);
    for point in branch.points.iter().filter(|point| point.u.len() == n) {
        d.iter_mut().zip(&point.u).zip(&at.u).for_each(|((d, a), b)| *d = a - b);
        problem.metric(&d, &mut m);
        unknowns = unknowns.max(dot(&d, &m).max(0.0).sqrt());
        range = range.max((point.p - at.p).abs());
    }
    let parameters = problem.parameters();
    let positive = |x: f64, otherwise: f64| if x.is_finite() && x > 0.0 { x } else { otherwise };
    let first_scale = positive(range, positive(parameters[first.0].scale.abs(), 1.0));
    let moves = unknowns.is_finite() && unknowns > 0.0;
    let unknowns = positive(unknowns, 1.0);
    let second = positive(parameters[second.0].scale.abs(), 1.0);
    let metric = if problem.unknown_scale(first).is_some() { 1.0 } else { unknowns / first_scale };
    (Scales { unknowns, first: first_scale, second, metric }, moves)
}
