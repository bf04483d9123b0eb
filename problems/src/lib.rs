//! The catalogue: bifurcation problems with known answers, each traced by its name.
//!
//! Every entry uses nothing but the public interface of [`continuation`].

use continuation::samples::{Bratu, Cusp};
use continuation::{Branch, Problem, Progress, Settings, TraceError, Tracer, Watch};
use std::ops::ControlFlow;

/// Progress is told to this function, which may stop the trace.
pub type Observer<'o> = dyn FnMut(&Progress) -> ControlFlow<()> + 'o;

/// A problem of the catalogue, its defaults and how to trace it.
#[derive(Clone, Copy)]
pub struct Entry {
    /// Its name.
    pub name: &'static str,
    /// What it is and what is known of it.
    pub summary: &'static str,
    /// The continued parameter.
    pub parameter: &'static str,
    /// Where the parameter starts.
    pub start: f64,
    /// Where the trace ends.
    pub end: f64,
    /// Further parameters and their defaults.
    pub parameters: &'static [(&'static str, f64)],
    /// Default number of nodes or elements, where the problem has a mesh.
    pub elements: Option<usize>,
    run: fn(&Request, &mut Observer<'_>) -> Result<Branch, TraceError>,
}

/// What is asked of a trace.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Start of the continued parameter.
    pub start: f64,
    /// Values of the further parameters, in the order of [`Entry::parameters`].
    pub parameters: Vec<f64>,
    /// Number of nodes or elements.
    pub elements: usize,
    /// How to trace; its target is the end.
    pub settings: Settings,
}

impl Entry {
    /// Traces the problem.
    ///
    /// # Errors
    /// When the start is unusable.
    pub fn trace(
        &self,
        request: &Request,
        observer: &mut Observer<'_>,
    ) -> Result<Branch, TraceError> {
        (self.run)(request, observer)
    }
}

/// All problems of the catalogue.
pub fn catalogue() -> &'static [Entry] {
    &ENTRIES
}

static ENTRIES: [Entry; 2] = [
    Entry {
        name: "bratu",
        summary: "Bratu problem u'' + lambda exp(u) = 0 through its fold at 3.5138 to max u = 8",
        parameter: "lambda",
        start: 0.0,
        end: -1.0, // never reached: the trace ends at max u = 8
        parameters: &[],
        elements: Some(800),
        run: bratu,
    },
    Entry {
        name: "cusp",
        summary: "mu + lambda x - x^3 = 0, with folds at mu = -/+ 2 (lambda/3)^(3/2)",
        parameter: "mu",
        start: -2.0,
        end: 2.0,
        parameters: &[("lambda", 1.0)],
        elements: None,
        run: cusp,
    },
];

fn run<P: Problem>(
    problem: &P,
    parameter: &str,
    u: &[f64],
    p: &[f64],
    request: &Request,
    watches: &[Watch],
    observer: &mut Observer<'_>,
) -> Result<Branch, TraceError> {
    let tracer = Tracer::new(problem, parameter, u, p, request.settings.clone())?;
    Ok(tracer.watching(watches)?.run(observer))
}

/// The branch leaves λ = 0 upwards, turns at the fold and comes back at ever larger amplitude; the
/// trace ends at max u = 8.
fn bratu(request: &Request, observer: &mut Observer<'_>) -> Result<Branch, TraceError> {
    let mut request = request.clone();
    request.settings.increasing = Some(true);
    let problem = Bratu::new(request.elements);
    let u = vec![0.0; problem.dim()];
    let watches = [Watch::stop_at("max_u", 8.0)];
    run(&problem, "lambda", &u, &[request.start], &request, &watches, observer)
}

fn cusp(request: &Request, observer: &mut Observer<'_>) -> Result<Branch, TraceError> {
    let lambda = request.parameters.first().copied().unwrap_or(1.0);
    // the root of μ + λ x − x³ of largest magnitude, on the side of μ
    let mu = request.start;
    let mut x = mu.signum() * (1.0 + mu.abs() + lambda.abs());
    for _ in 0..100 {
        x -= (x * x * x - lambda * x - mu) / (3.0 * x * x - lambda);
    }
    run(&Cusp, "mu", &[x], &[mu, lambda], request, &[Watch::zero("x")], observer)
}
