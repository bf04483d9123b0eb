//! The cusp `μ + λx − x³ = 0`, read as `dx/dt`: [`continuation::samples::Cusp`].
//!
//! Folds at `μ = ±2(λ/3)^{3/2}`, which meet in a cusp at `μ = λ = 0`. The branch starts at the root
//! of largest magnitude on the side of `μ`.

use crate::visit::hand;
use crate::{Allowed, Constant, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::{Watch, samples::Cusp};

const FOLDS: &str = "2 (lambda/3)^(3/2)";

pub(crate) static ENTRY: Entry = Entry {
    name: "cusp",
    summary: "mu + lambda x - x^3 = 0, with folds at mu = -/+ 2 (lambda/3)^(3/2)",
    parameter: "mu",
    axes: &[("mu", "parameter μ"), ("x", "state x")],
    start: -2.0,
    start_allowed: Allowed::Any,
    end: 2.0,
    parameters: &[Constant { name: "lambda", default: 1.0, allowed: Allowed::Any }],
    elements: None,
    known: &[
        Known::fold(0.384_900_179_459_750_5, 1e-12, FOLDS),
        Known::fold(-0.384_900_179_459_750_5, 1e-12, FOLDS),
        Known::double("cusp", 0.0, ("lambda", 0.0), 1e-10, FOLDS),
    ],
    id: Id::Cusp,
};

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    let (mu, lambda) = (request.start, request.parameter(0));
    let mut x = mu.signum() * (1.0 + mu.abs() + lambda.abs());
    // from outside all roots Newton's method is monotone
    for _ in 0..100 {
        x -= (x * x * x - lambda * x - mu) / (3.0 * x * x - lambda);
    }
    let setup = Setup::new(ENTRY.parameter, vec![x], request).watching(Watch::zero("x"));
    Ok(hand(visitor, &Cusp, setup))
}
