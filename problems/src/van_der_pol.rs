//! Van der Pol's oscillator (*Phil. Mag.* 2 (1926) 978).
//!
//! ```text
//! u' = v,   v' = (μ − u²)v − u
//! ```
//! With `u = √μ y` this is `y'' − μ(1 − y²)y' + y = 0`, of the same period. Cycles of radius `2√μ` are
//! born at the supercritical Hopf point `μ = 0`; their period is 6.663286859323130 at `μ = 1` (Andersen &
//! Geer, *SIAM J. Appl. Math.* 42 (1982) 678) and grows as `(3 − 2 ln 2)μ`.

use crate::ode::{Ode, System};
use crate::visit::hand;
use crate::{Allowed, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::{Name, Parameter, names};

/// See the module.
#[derive(Debug, Clone, Copy, Default)]
pub struct VanDerPol;

impl System<2> for VanDerPol {
    const UNKNOWNS: &'static [Name] = names!["u", "v"];
    const PARAMETERS: &'static [Parameter] = &[Parameter::new("mu", "", 1.0)];

    fn rates([u, v]: [f64; 2], p: &[f64]) -> [f64; 2] {
        [v, (p[0] - u * u) * v - u]
    }

    fn by_unknowns([u, v]: [f64; 2], p: &[f64]) -> [[f64; 2]; 2] {
        [[0.0, 1.0], [-2.0 * u * v - 1.0, p[0] - u * u]]
    }

    fn by_parameter([_, v]: [f64; 2], _p: &[f64], _which: usize) -> [f64; 2] {
        [0.0, v]
    }
}

pub(crate) static ENTRY: Entry = Entry {
    name: "van-der-pol",
    summary: "Van der Pol's oscillator: stable cycles from a Hopf point to relaxation",
    parameter: "mu",
    axes: &[("mu", "damping μ"), ("u", "state u"), ("v", "velocity v")],
    start: -1.0,
    start_allowed: Allowed::Any,
    end: 5.0,
    parameters: &[],
    elements: None,
    known: &[Known::hopf(0.0, 1e-10, "the trace of the Jacobian is mu")],
    id: Id::VanDerPol,
};

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    Ok(hand(visitor, &Ode(VanDerPol), Setup::new(ENTRY.parameter, vec![0.0; 2], request)))
}
