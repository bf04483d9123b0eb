//! Two branches that cross, in one unknown: [`Transcritical`] and [`Pitchfork`].

use crate::ode::{Ode, System};
use crate::visit::hand;
use crate::{Allowed, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::{Name, Parameter, names};

const P: &[Parameter] = &[Parameter::new("p", "", 1.0)];

/// `du/dt = (u − p)(u − 2)`: the branches `u = p` and `u = 2` cross at `p = 2` and exchange their
/// stability.
#[derive(Debug, Clone, Copy, Default)]
pub struct Transcritical;

impl System<1> for Transcritical {
    const UNKNOWNS: &'static [Name] = names!["u"];
    const PARAMETERS: &'static [Parameter] = P;

    fn rates([u]: [f64; 1], p: &[f64]) -> [f64; 1] {
        [(u - p[0]) * (u - 2.0)]
    }

    fn by_unknowns([u]: [f64; 1], p: &[f64]) -> [[f64; 1]; 1] {
        [[2.0 * u - 2.0 - p[0]]]
    }

    fn by_parameter([u]: [f64; 1], _p: &[f64], _which: usize) -> [f64; 1] {
        [2.0 - u]
    }
}

pub(crate) static TRANSCRITICAL: Entry = Entry {
    name: "transcritical",
    summary: "(u - p)(u - 2) = 0 along u = p, crossed by u = 2 at p = 2",
    parameter: "p",
    axes: &[("p", "parameter p"), ("u", "state u")],
    start: 0.0,
    start_allowed: Allowed::Any,
    end: 4.0,
    parameters: &[],
    elements: None,
    known: &[Known::branch_point(2.0, 1e-10, "the two factors").form("transcritical")],
    id: Id::Transcritical,
};

pub(crate) fn transcritical<V: Visitor>(
    request: &Request,
    visitor: V,
) -> Result<V::Output, ProblemError> {
    let setup = Setup::new(TRANSCRITICAL.parameter, vec![request.start], request);
    Ok(hand(visitor, &Ode(Transcritical), setup))
}

/// `dx/dt = −x³ − px`, from its side branch `x² = −p`.
///
/// The side branch is vertical in the branch point `x = p = 0`, which therefore looks like a fold
/// from it; it is none, for `∂f/∂p` vanishes there and `x = 0` crosses. The branch comes back with
/// `x < 0`.
#[derive(Debug, Clone, Copy, Default)]
pub struct Pitchfork;

impl System<1> for Pitchfork {
    const UNKNOWNS: &'static [Name] = names!["x"];
    const PARAMETERS: &'static [Parameter] = P;

    fn rates([x]: [f64; 1], p: &[f64]) -> [f64; 1] {
        [-x * (x * x + p[0])]
    }

    fn by_unknowns([x]: [f64; 1], p: &[f64]) -> [[f64; 1]; 1] {
        [[-3.0 * x * x - p[0]]]
    }

    fn by_parameter([x]: [f64; 1], _p: &[f64], _which: usize) -> [f64; 1] {
        [-x]
    }
}

pub(crate) static PITCHFORK: Entry = Entry {
    name: "pitchfork",
    summary: "-x^3 - p x = 0 along x^2 = -p, through the branch point p = 0 and back",
    parameter: "p",
    axes: &[("p", "parameter p"), ("x", "state x")],
    start: -1.0,
    start_allowed: Allowed::Below(0.0),
    end: -2.0,
    parameters: &[],
    elements: None,
    known: &[Known::branch_point(0.0, 1e-10, "-x (x^2 + p)").form("pitchfork")],
    id: Id::Pitchfork,
};

pub(crate) fn pitchfork<V: Visitor>(
    request: &Request,
    visitor: V,
) -> Result<V::Output, ProblemError> {
    let x = (-request.start).sqrt();
    let setup = Setup::new(PITCHFORK.parameter, vec![x], request).upwards();
    Ok(hand(visitor, &Ode(Pitchfork), setup))
}
