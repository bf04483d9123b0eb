//! Convection in three modes (Lorenz, *J. Atmos. Sci.* 20 (1963) 130).
//!
//! ```text
//! x' = σ(y − x),   y' = ρx − y − xz,   z' = xy − βz
//! ```
//! The state of rest loses its stability at `ρ = 1`, a pitchfork; the two branches that leave it have
//! Hopf points at `ρ = σ(σ + β + 3)/(σ − β − 1)`, subcritical: 470/19 for `σ = 10`, `β = 8/3`. The unstable
//! cycles that leave there end at a homoclinic orbit of the state of rest at `ρ = 13.926557` (Sparrow,
//! *The Lorenz Equations*, Springer 1982; Doedel, Krauskopf & Osinga, *Nonlinearity* 19 (2006) 2947).

use crate::ode::{Ode, System};
use crate::visit::hand;
use crate::{Allowed, Constant, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::{Name, Parameter, names};

/// See the module.
#[derive(Debug, Clone, Copy, Default)]
pub struct Lorenz;

impl System<3> for Lorenz {
    const UNKNOWNS: &'static [Name] = names!["x", "y", "z"];
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("rho", "", 10.0),
        Parameter::new("sigma", "", 10.0),
        Parameter::new("beta", "", 1.0),
    ];

    fn rates([x, y, z]: [f64; 3], p: &[f64]) -> [f64; 3] {
        [p[1] * (y - x), p[0] * x - y - x * z, x * y - p[2] * z]
    }

    fn by_unknowns([x, y, z]: [f64; 3], p: &[f64]) -> [[f64; 3]; 3] {
        [[-p[1], p[1], 0.0], [p[0] - z, -1.0, -x], [y, x, -p[2]]]
    }

    fn by_parameter([x, y, z]: [f64; 3], _p: &[f64], which: usize) -> [f64; 3] {
        match which {
            0 => [0.0, x, 0.0],
            1 => [y - x, 0.0, 0.0],
            _ => [0.0, 0.0, -z],
        }
    }
}

pub(crate) static ENTRY: Entry = Entry {
    name: "lorenz",
    summary: "Lorenz's convection: unstable cycles from a Hopf point to a homoclinic orbit",
    parameter: "rho",
    axes: &[
        ("rho", "Rayleigh number over its critical value, ρ"),
        ("x", "convection x"),
        ("y", "temperature across, y"),
        ("z", "temperature upwards, z"),
    ],
    start: 0.0,
    start_allowed: Allowed::Any,
    end: 30.0,
    parameters: &[
        Constant { name: "sigma", default: 10.0, allowed: Allowed::Above(0.0) },
        Constant { name: "beta", default: 8.0 / 3.0, allowed: Allowed::Above(0.0) },
    ],
    elements: None,
    known: &[
        Known::branch_point(1.0, 1e-10, "rho = 1").form("pitchfork"),
        Known::hopf(470.0 / 19.0, 1e-10, "sigma (sigma + beta + 3)/(sigma - beta - 1)")
            .after_switching(),
    ],
    id: Id::Lorenz,
};

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    Ok(hand(visitor, &Ode(Lorenz), Setup::new(ENTRY.parameter, vec![0.0; 3], request)))
}
