//! Rössler's band (*Phys. Lett. A* 57 (1976) 397).
//!
//! ```text
//! x' = −y − z,   y' = x + ay,   z' = b + z(x − c)
//! ```
//! The equilibrium `x = az`, `y = −z`, `az² − cz + b = 0` (the smaller root) has a Hopf point at
//! `a = 0.005978441849616576` for `b = 0.2`, `c = 5.7`. The cycles that are born there double their period
//! again and again on the way to chaos at `a = 0.2`.

use crate::ode::{Ode, System};
use crate::visit::hand;
use crate::{Allowed, Constant, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::{Name, Parameter, names};

/// See the module.
#[derive(Debug, Clone, Copy, Default)]
pub struct Roessler;

impl System<3> for Roessler {
    const UNKNOWNS: &'static [Name] = names!["x", "y", "z"];
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("a", "", 0.1), Parameter::new("b", "", 1.0), Parameter::new("c", "", 1.0)];

    fn rates([x, y, z]: [f64; 3], p: &[f64]) -> [f64; 3] {
        [-y - z, x + p[0] * y, p[1] + z * (x - p[2])]
    }

    fn by_unknowns([x, _, z]: [f64; 3], p: &[f64]) -> [[f64; 3]; 3] {
        [[0.0, -1.0, -1.0], [1.0, p[0], 0.0], [z, 0.0, x - p[2]]]
    }

    fn by_parameter([_, y, z]: [f64; 3], _p: &[f64], which: usize) -> [f64; 3] {
        match which {
            0 => [0.0, y, 0.0],
            1 => [0.0, 0.0, 1.0],
            _ => [0.0, 0.0, -z],
        }
    }
}

const HOPF: &str = "the condition of Hurwitz in multiple precision";

pub(crate) static ENTRY: Entry = Entry {
    name: "roessler",
    summary: "Roessler's band: cycles from a Hopf point through period doublings",
    parameter: "a",
    axes: &[("a", "parameter a"), ("x", "state x"), ("y", "state y"), ("z", "state z")],
    start: -0.1,
    start_allowed: Allowed::Any,
    end: 0.2,
    parameters: &[
        Constant { name: "b", default: 0.2, allowed: Allowed::Above(0.0) },
        Constant { name: "c", default: 5.7, allowed: Allowed::Above(0.0) },
    ],
    elements: None,
    known: &[Known::hopf(0.005_978_441_849_616_576, 1e-9, HOPF)],
    id: Id::Roessler,
};

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    let (a, b, c) = (request.start, request.parameter(0), request.parameter(1));
    // the smaller root without cancellation; without one the trace says that there is no start
    let z = 2.0 * b / (c + (c * c - 4.0 * a * b).max(0.0).sqrt());
    let start = vec![a * z, -z, z];
    Ok(hand(visitor, &Ode(Roessler), Setup::new(ENTRY.parameter, start, request)))
}
