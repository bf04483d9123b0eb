//! The Brusselator (Prigogine & Lefever, *J. Chem. Phys.* 48 (1968) 1695).
//!
//! ```text
//! x' = A − (B + 1)x + x²y,   y' = Bx − x²y
//! ```
//! The state `(A, B/A)` has a supercritical Hopf point at `B = 1 + A²`.

use crate::ode::{Ode, System};
use crate::visit::hand;
use crate::{Allowed, Constant, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::{Name, Parameter, names};

/// See the module.
#[derive(Debug, Clone, Copy, Default)]
pub struct Brusselator;

impl System<2> for Brusselator {
    const UNKNOWNS: &'static [Name] = names!["x", "y"];
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("B", "", 1.0), Parameter::new("A", "", 1.0)];

    fn rates([x, y]: [f64; 2], p: &[f64]) -> [f64; 2] {
        [p[1] - (p[0] + 1.0) * x + x * x * y, p[0] * x - x * x * y]
    }

    fn by_unknowns([x, y]: [f64; 2], p: &[f64]) -> [[f64; 2]; 2] {
        [[2.0 * x * y - p[0] - 1.0, x * x], [p[0] - 2.0 * x * y, -x * x]]
    }

    fn by_parameter([x, _]: [f64; 2], _p: &[f64], which: usize) -> [f64; 2] {
        if which == 0 { [-x, x] } else { [1.0, 0.0] }
    }
}

pub(crate) static ENTRY: Entry = Entry {
    name: "brusselator",
    summary: "the Brusselator: stable cycles from a Hopf point",
    parameter: "B",
    axes: &[
        ("B", "supply of the second substance B"),
        ("x", "concentration x"),
        ("y", "concentration y"),
    ],
    start: 1.0,
    start_allowed: Allowed::Any,
    end: 4.0,
    parameters: &[Constant { name: "A", default: 1.0, allowed: Allowed::Above(0.0) }],
    elements: None,
    known: &[Known::hopf(2.0, 1e-10, "1 + A^2")],
    id: Id::Brusselator,
};

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    let a = request.parameter(0);
    let start = vec![a, request.start / a];
    Ok(hand(visitor, &Ode(Brusselator), Setup::new(ENTRY.parameter, start, request)))
}
