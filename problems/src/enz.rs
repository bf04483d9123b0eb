//! An enzyme in two compartments: AUTO's demo `enz`.
//!
//! ```text
//! s₁' = p − 2s₁ + s₂ − 100 R(s₁),   s₂' = p − 2s₂ + s₁ − 100 R(s₂),   R(s) = s/(1 + s + s²)
//! ```
//! (Kernévez, *Enzyme Mathematics*, North-Holland 1980; AUTO-07p manual, demo `enz`.) The branch
//! `s₁ = s₂` from the origin: fold 34.356924998526, branch point 34.222886544190, branch point
//! 22.181637926124, fold 18.887067657924. On the asymmetric branch that leaves it: folds
//! 25.372714838124, 26.622071770045. Both branch points are pitchforks; from the asymmetric branch
//! the one at 22.1816 is met at its vertical tangent, and AUTO labels it a fold.

use crate::ode::{Ode, System};
use crate::visit::hand;
use crate::{Allowed, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::{Name, Parameter, names};

/// See the module.
#[derive(Debug, Clone, Copy, Default)]
pub struct Enz;

impl System<2> for Enz {
    const UNKNOWNS: &'static [Name] = names!["s1", "s2"];
    const PARAMETERS: &'static [Parameter] = &[Parameter::new("p", "", 10.0)];

    fn rates([a, b]: [f64; 2], p: &[f64]) -> [f64; 2] {
        let rate = |s: f64| 100.0 * s / (1.0 + s + s * s);
        [p[0] - 2.0 * a + b - rate(a), p[0] - 2.0 * b + a - rate(b)]
    }

    fn by_unknowns([a, b]: [f64; 2], _p: &[f64]) -> [[f64; 2]; 2] {
        let slope = |s: f64| 100.0 * (1.0 - s * s) / (1.0 + s + s * s).powi(2);
        [[-2.0 - slope(a), 1.0], [1.0, -2.0 - slope(b)]]
    }

    fn by_parameter(_u: [f64; 2], _p: &[f64], _which: usize) -> [f64; 2] {
        [1.0, 1.0]
    }
}

const SOURCE: &str = "recomputed in multiple precision; AUTO-07p demo enz";

pub(crate) static ENTRY: Entry = Entry {
    name: "enz",
    summary: "AUTO's enzyme in two compartments: folds and the symmetry-breaking pitchforks",
    parameter: "p",
    axes: &[
        ("p", "supply of substrate p"),
        ("s1", "substrate in the first compartment, s₁"),
        ("s2", "substrate in the second compartment, s₂"),
    ],
    start: 0.0,
    start_allowed: Allowed::AtLeast(0.0),
    end: 40.0,
    parameters: &[],
    elements: None,
    known: &[
        Known::fold(34.356_924_998_526, 1e-10, SOURCE),
        Known::branch_point(34.222_886_544_190, 1e-10, SOURCE).form("pitchfork"),
        Known::branch_point(22.181_637_926_124, 1e-10, SOURCE).form("pitchfork"),
        Known::fold(18.887_067_657_924, 1e-10, SOURCE),
        Known::fold(25.372_714_838_124, 1e-10, SOURCE).after_switching(),
        Known::fold(26.622_071_770_045, 1e-10, SOURCE).after_switching(),
    ],
    id: Id::Enz,
};

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    Ok(hand(visitor, &Ode(Enz), Setup::new(ENTRY.parameter, vec![0.0; 2], request)))
}
