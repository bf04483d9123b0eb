//! An excitable cell (FitzHugh, *Biophys. J.* 1 (1961) 445; Nagumo, Arimoto & Yoshizawa, *Proc. IRE* 50
//! (1962) 2061).
//!
//! ```text
//! v' = v − v³/3 − w + I,   w' = ε(v + a − bw)
//! ```
//! Hopf points where `v² = 1 − εb`: `I = 0.331281337454746` and `1.418718662545254` for `ε = 0.08`, `a = 0.7`,
//! `b = 0.8`, both subcritical. The unstable cycles grow within a narrow range of `I` along the middle branch of the cubic
//! to relaxation oscillations, a canard explosion, and turn to stable ones at a limit point of cycles.

use crate::ode::{Ode, System};
use crate::visit::hand;
use crate::{Allowed, Constant, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::{Name, Parameter, names};

/// See the module.
#[derive(Debug, Clone, Copy, Default)]
pub struct FitzHughNagumo;

impl System<2> for FitzHughNagumo {
    const UNKNOWNS: &'static [Name] = names!["v", "w"];
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("I", "", 1.0),
        Parameter::new("epsilon", "", 0.1),
        Parameter::new("a", "", 1.0),
        Parameter::new("b", "", 1.0),
    ];

    fn rates([v, w]: [f64; 2], p: &[f64]) -> [f64; 2] {
        [v - v * v * v / 3.0 - w + p[0], p[1] * (v + p[2] - p[3] * w)]
    }

    fn by_unknowns([v, _]: [f64; 2], p: &[f64]) -> [[f64; 2]; 2] {
        [[1.0 - v * v, -1.0], [p[1], -p[1] * p[3]]]
    }

    fn by_parameter([v, w]: [f64; 2], p: &[f64], which: usize) -> [f64; 2] {
        match which {
            0 => [1.0, 0.0],
            1 => [0.0, v + p[2] - p[3] * w],
            2 => [0.0, p[1]],
            _ => [0.0, -p[1] * w],
        }
    }
}

const HOPF: &str = "v^2 = 1 - epsilon b";

pub(crate) static ENTRY: Entry = Entry {
    name: "fitzhugh-nagumo",
    summary: "FitzHugh and Nagumo's nerve: cycles between two Hopf points, a canard explosion",
    parameter: "I",
    axes: &[("I", "current I"), ("v", "voltage v"), ("w", "recovery w")],
    start: 0.0,
    start_allowed: Allowed::Any,
    end: 2.0,
    parameters: &[
        Constant { name: "epsilon", default: 0.08, allowed: Allowed::Above(0.0) },
        Constant { name: "a", default: 0.7, allowed: Allowed::Any },
        Constant { name: "b", default: 0.8, allowed: Allowed::Any },
    ],
    elements: None,
    known: &[
        Known::hopf(0.331_281_337_454_745_8, 1e-9, HOPF),
        Known::hopf(1.418_718_662_545_254_2, 1e-9, HOPF),
    ],
    id: Id::FitzHughNagumo,
};

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    let (i, a, b) = (request.start, request.parameter(1), request.parameter(2));
    // v − v³/3 + I = (v + a)/b by bisection: the left side less the right one goes to ∓∞
    let gap = |v: f64| b * (v - v * v * v / 3.0 + i) - v - a;
    let (mut low, mut high) = (-1e3, 1e3);
    if gap(low) < gap(high) {
        std::mem::swap(&mut low, &mut high);
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if gap(middle) > 0.0 { low = middle } else { high = middle }
    }
    let v = 0.5 * (low + high);
    let start = vec![v, v - v * v * v / 3.0 + i];
    Ok(hand(visitor, &Ode(FitzHughNagumo), Setup::new(ENTRY.parameter, start, request)))
}
