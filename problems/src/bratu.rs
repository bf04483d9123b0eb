//! The Bratu problem `u″ + λeᵘ = 0`, `u(0) = u(1) = 0`: [`continuation::samples::Bratu`].
//!
//! The branch leaves `λ = 0` upwards, turns at the fold and comes back at ever larger amplitude,
//! without reaching 0; the trace ends at `max u = 8`.

use crate::visit::hand;
use crate::{Allowed, Elements, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::{Watch, samples::Bratu};

pub(crate) static ENTRY: Entry = Entry {
    name: "bratu",
    summary: "Bratu problem u'' + lambda exp(u) = 0 through its fold at 3.5138 to max u = 8",
    parameter: "lambda",
    axes: &[("lambda", "strength of the reaction λ"), ("max_u", "largest u")],
    start: 0.0,
    start_allowed: Allowed::Within(0.0, 3.5),
    end: -1.0,
    parameters: &[],
    elements: Some(Elements { default: 800, least: 8, most: 100_000, what: "interior nodes" }),
    known: &[Known::fold(
        3.513_827_869_849_8,
        1e-12,
        "second-order differences on 800 nodes; 3.513830719125 (theta tanh theta = 1) in the limit",
    )],
    id: Id::Bratu,
};

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    let u = vec![0.0; request.elements];
    let setup = Setup::new(ENTRY.parameter, u, request).upwards();
    Ok(hand(visitor, &Bratu::new(request.elements), setup.watching(Watch::stop_at("max_u", 8.0))))
}
