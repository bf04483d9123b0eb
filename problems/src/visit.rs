//! Doing something with a problem of the catalogue without knowing its type.
//!
//! ```
//! use continuation::Problem;
//! use problems::{Setup, Visitor};
//!
//! struct Size;
//! impl Visitor for Size {
//!     type Output = usize;
//!     fn visit<P: Problem>(self, problem: &P, _: Setup) -> usize {
//!         problem.dim()
//!     }
//! }
//!
//! let bratu = problems::find("bratu").ok_or("no such problem")?;
//! assert_eq!(bratu.visit(&bratu.request(), Size)?, 800);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::{Entry, Id, ProblemError, Request};
use continuation::{Branch, Matrix, Name, Problem, Progress, Settings, TraceError, Tracer, Watch};
use std::ops::ControlFlow;

/// What is done with a problem of the catalogue.
pub trait Visitor {
    /// What comes of it.
    type Output;
    /// Does it; `setup` says where and how the problem's branch starts.
    fn visit<P: Problem>(self, problem: &P, setup: Setup) -> Self::Output;
}

/// Hands a problem over as one of its type of Jacobian, so that a visitor is compiled for each of
/// these and not for each problem.
pub(crate) fn hand<V: Visitor, J: Matrix>(
    visitor: V,
    problem: &dyn Problem<Jacobian = J>,
    setup: Setup,
) -> V::Output {
    visitor.visit(&problem, setup)
}

/// Where and how the branch of a problem starts.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// The continued parameter.
    pub parameter: Name,
    /// The unknowns at the start, or near them.
    pub u: Vec<f64>,
    /// All parameters at the start.
    pub p: Vec<f64>,
    /// How to trace.
    pub settings: Settings,
    /// What to watch; may end the trace.
    pub watches: Vec<Watch>,
}

impl Setup {
    /// The first branch of `entry` from `u`; the continued parameter is the first of `p`.
    pub(crate) fn new(parameter: &'static str, u: Vec<f64>, request: &Request) -> Setup {
        let mut p = vec![request.start];
        p.extend_from_slice(&request.parameters);
        let parameter = Name::Borrowed(parameter);
        Setup { parameter, u, p, settings: request.settings.clone(), watches: Vec::new() }
    }

    pub(crate) fn watching(mut self, watch: Watch) -> Setup {
        self.watches.push(watch);
        self
    }

    /// Upwards at first, wherever the end is.
    pub(crate) fn upwards(mut self) -> Setup {
        self.settings.increasing = Some(true);
        self
    }
}

/// Progress is told to this function, which may stop the trace.
pub type Observer<'o> = dyn FnMut(&Progress) -> ControlFlow<()> + 'o;

struct Trace<'a, 'o>(&'a mut Observer<'o>);

impl Visitor for Trace<'_, '_> {
    type Output = Result<Branch, TraceError>;

    fn visit<P: Problem>(self, problem: &P, setup: Setup) -> Self::Output {
        let tracer = Tracer::new(problem, &setup.parameter, &setup.u, &setup.p, setup.settings)?;
        Ok(tracer.watching(&setup.watches)?.run(self.0))
    }
}

impl Entry {
    /// Hands the problem to a visitor.
    ///
    /// # Errors
    /// When a value of the request is out of range, or there is no solution to start from.
    pub fn visit<V: Visitor>(
        &self,
        request: &Request,
        visitor: V,
    ) -> Result<V::Output, ProblemError> {
        self.check(request)?;
        Id::visit(self.id, request, visitor)
    }

    /// Traces the first branch.
    ///
    /// # Errors
    /// As [`Entry::visit`], and when the trace cannot begin.
    pub fn trace(
        &self,
        request: &Request,
        observer: &mut Observer<'_>,
    ) -> Result<Branch, ProblemError> {
        Ok(self.visit(request, Trace(observer))??)
    }
}
