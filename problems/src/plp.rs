//! A membrane with an enzyme and two substrates: AUTO's demo `plp`.
//!
//! ```text
//! s' = 110 − s − pR,   a' = 0.2(500 − a) − pR,   R = sa/(1 + s + 0.1 s²)
//! ```
//! (Doedel & Kernévez, *Appl. Math. Comput.* 18 (1986) 243; AUTO-07p manual, demo `plp`.) From
//! `(110, 500)`: Hopf points 3.499953827987, 4.650457812603.

use crate::ode::{Ode, System};
use crate::visit::hand;
use crate::{Allowed, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::{Name, Parameter, names};

/// See the module.
#[derive(Debug, Clone, Copy, Default)]
pub struct Plp;

/// `R` and its derivatives by `s` and `a`.
fn reaction(s: f64, a: f64) -> [f64; 3] {
    let d = 1.0 + s + 0.1 * s * s;
    [s * a / d, a * (1.0 - 0.1 * s * s) / (d * d), s / d]
}

impl System<2> for Plp {
    const UNKNOWNS: &'static [Name] = names!["s", "a"];
    const PARAMETERS: &'static [Parameter] = &[Parameter::new("p", "", 1.0)];

    fn rates([s, a]: [f64; 2], p: &[f64]) -> [f64; 2] {
        let rate = p[0] * reaction(s, a)[0];
        [110.0 - s - rate, 0.2 * (500.0 - a) - rate]
    }

    fn by_unknowns([s, a]: [f64; 2], p: &[f64]) -> [[f64; 2]; 2] {
        let [_, by_s, by_a] = reaction(s, a).map(|x| p[0] * x);
        [[-1.0 - by_s, -by_a], [-by_s, -0.2 - by_a]]
    }

    fn by_parameter([s, a]: [f64; 2], _p: &[f64], _which: usize) -> [f64; 2] {
        let [rate, ..] = reaction(s, a);
        [-rate, -rate]
    }
}

const SOURCE: &str = "recomputed in multiple precision; AUTO-07p demo plp";

pub(crate) static ENTRY: Entry = Entry {
    name: "plp",
    summary: "AUTO's enzyme membrane with two substrates: two Hopf points",
    parameter: "p",
    axes: &[("p", "enzyme activity p"), ("s", "first substrate s"), ("a", "second substrate a")],
    start: 0.0,
    start_allowed: Allowed::AtLeast(0.0),
    end: 10.0,
    parameters: &[],
    elements: None,
    known: &[
        Known::hopf(3.499_953_827_987, 1e-10, SOURCE),
        Known::hopf(4.650_457_812_603, 1e-10, SOURCE),
    ],
    id: Id::Plp,
};

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    Ok(hand(visitor, &Ode(Plp), Setup::new(ENTRY.parameter, vec![110.0, 500.0], request)))
}
