//! Two predators in a chain with their prey: AUTO's demo `ppp`.
//!
//! ```text
//! u₁' = u₁(1 − u₁) − p₄u₁u₂
//! u₂' = −p₂u₂ + p₄u₁u₂ − p₅u₂u₃ − p₁(1 − e^{−p₆u₂})
//! u₃' = −p₃u₃ + p₅u₂u₃
//! ```
//! (AUTO-07p manual, demo `ppp`: `p₂ = 1/4`, `p₃ = 1/2`, `p₄ = p₅ = 3`, `p₆ = 5`.) Prey alone, `(1, 0, 0)`, has a
//! branch point at `p₁ = (p₄ − p₂)/p₆ = 11/20`, where the first predator enters; on the branches that leave, a
//! second predator enters, and cycles are born.

use crate::ode::{Ode, System};
use crate::visit::hand;
use crate::{Allowed, Constant, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::{Name, Parameter, names};

/// See the module.
#[derive(Debug, Clone, Copy, Default)]
pub struct Ppp;

impl System<3> for Ppp {
    const UNKNOWNS: &'static [Name] = names!["u1", "u2", "u3"];
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("p1", "", 1.0),
        Parameter::new("p2", "", 1.0),
        Parameter::new("p3", "", 1.0),
        Parameter::new("p4", "", 1.0),
        Parameter::new("p5", "", 1.0),
        Parameter::new("p6", "", 1.0),
    ];

    fn rates([u, v, w]: [f64; 3], p: &[f64]) -> [f64; 3] {
        // 1 − e^{−p₆v} without cancellation
        let lost = -(-p[5] * v).exp_m1();
        [
            u * (1.0 - u) - p[3] * u * v,
            -p[1] * v + p[3] * u * v - p[4] * v * w - p[0] * lost,
            -p[2] * w + p[4] * v * w,
        ]
    }

    fn by_unknowns([u, v, w]: [f64; 3], p: &[f64]) -> [[f64; 3]; 3] {
        let by_v = -p[1] + p[3] * u - p[4] * w - p[0] * p[5] * (-p[5] * v).exp();
        [
            [1.0 - 2.0 * u - p[3] * v, -p[3] * u, 0.0],
            [p[3] * v, by_v, -p[4] * v],
            [0.0, p[4] * w, -p[2] + p[4] * v],
        ]
    }

    fn by_parameter([u, v, w]: [f64; 3], p: &[f64], which: usize) -> [f64; 3] {
        match which {
            0 => [0.0, (-p[5] * v).exp_m1(), 0.0],
            1 => [0.0, -v, 0.0],
            2 => [0.0, 0.0, -w],
            3 => [-u * v, u * v, 0.0],
            4 => [0.0, -v * w, v * w],
            _ => [0.0, -p[0] * v * (-p[5] * v).exp(), 0.0],
        }
    }
}

pub(crate) static ENTRY: Entry = Entry {
    name: "ppp",
    summary: "AUTO's two predators and their prey: cycles from a Hopf point of the coexistence",
    parameter: "p1",
    axes: &[
        ("p1", "harvest of the first predator, p₁"),
        ("u1", "prey u₁"),
        ("u2", "first predator u₂"),
        ("u3", "second predator u₃"),
    ],
    start: 0.0,
    start_allowed: Allowed::Any,
    end: 0.6,
    parameters: &[
        Constant { name: "p2", default: 0.25, allowed: Allowed::Any },
        Constant { name: "p3", default: 0.5, allowed: Allowed::Any },
        Constant { name: "p4", default: 3.0, allowed: Allowed::Any },
        Constant { name: "p5", default: 3.0, allowed: Allowed::Any },
        Constant { name: "p6", default: 5.0, allowed: Allowed::Any },
    ],
    elements: None,
    known: &[Known::branch_point(0.55, 1e-10, "(p4 - p2)/p6").form("transcritical")],
    id: Id::Ppp,
};

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    Ok(hand(visitor, &Ode(Ppp), Setup::new(ENTRY.parameter, vec![1.0, 0.0, 0.0], request)))
}
