//! A stirred tank with the reaction A → B: AUTO's demo `ab`.
//!
//! ```text
//! u' = −u + p(1 − u)eᵛ,   v' = −v + 18 p(1 − u)eᵛ − 3v
//! ```
//! `u` conversion, `v` temperature, `p` the Damköhler number (Uppal, Ray & Poore, *Chem. Eng. Sci.*
//! 29 (1974) 967; Doedel, AUTO-07p manual, demo `ab`). From `(0, 0)`: Hopf 0.111153484190, fold
//! 0.111565080074, fold 0.099574136736, Hopf 0.183834607986.

use crate::ode::{Ode, System};
use crate::visit::hand;
use crate::{Allowed, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::{Name, Parameter, names};

/// See the module.
#[derive(Debug, Clone, Copy, Default)]
pub struct Ab;

impl System<2> for Ab {
    const UNKNOWNS: &'static [Name] = names!["u", "v"];
    const PARAMETERS: &'static [Parameter] = &[Parameter::new("p", "", 0.1)];

    fn rates([u, v]: [f64; 2], p: &[f64]) -> [f64; 2] {
        let rate = p[0] * (1.0 - u) * v.exp();
        [-u + rate, -4.0 * v + 18.0 * rate]
    }

    fn by_unknowns([u, v]: [f64; 2], p: &[f64]) -> [[f64; 2]; 2] {
        let k = p[0] * v.exp();
        let rate = (1.0 - u) * k;
        [[-1.0 - k, rate], [-18.0 * k, -4.0 + 18.0 * rate]]
    }

    fn by_parameter([u, v]: [f64; 2], _p: &[f64], _which: usize) -> [f64; 2] {
        let rate = (1.0 - u) * v.exp();
        [rate, 18.0 * rate]
    }
}

const SOURCE: &str = "recomputed in multiple precision; AUTO-07p demo ab";

pub(crate) static ENTRY: Entry = Entry {
    name: "ab",
    summary: "AUTO's reaction A -> B in a stirred tank: two Hopf points, two folds",
    parameter: "p",
    axes: &[("p", "Damköhler number p"), ("u", "conversion u"), ("v", "temperature v")],
    start: 0.0,
    start_allowed: Allowed::AtLeast(0.0),
    end: 0.25,
    parameters: &[],
    elements: None,
    known: &[
        Known::hopf(0.111_153_484_190, 1e-10, SOURCE),
        Known::fold(0.111_565_080_074, 1e-10, SOURCE),
        Known::fold(0.099_574_136_736, 1e-10, SOURCE),
        Known::hopf(0.183_834_607_986, 1e-10, SOURCE),
    ],
    id: Id::Ab,
};

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    Ok(hand(visitor, &Ode(Ab), Setup::new(ENTRY.parameter, vec![0.0; 2], request)))
}
