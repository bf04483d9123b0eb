//! A stirred tank with the reactions A → B → C: AUTO's demo `abc`, from its residual alone.
//!
//! ```text
//! u' = −u + p(1 − u)e^w
//! v' = −v + p e^w (1 − u − 0.04 v)
//! w' = −2.55 w + 8 p e^w (1 − u + 0.04 v)
//! ```
//! (Doedel & Heinemann, *Chem. Eng. Sci.* 38 (1983) 1493; AUTO-07p manual, demo `abc`.) From the
//! origin: Hopf points 0.204184535701, 0.229839037648, 0.259957854245, 0.346208521607, not in this
//! order along the branch.

use crate::visit::hand;
use crate::{Allowed, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::{DenseProblem, ParamId};

const SOURCE: &str = "recomputed in multiple precision; AUTO-07p demo abc";

pub(crate) static ENTRY: Entry = Entry {
    name: "abc",
    summary: "AUTO's reactions A -> B -> C in a stirred tank: four Hopf points",
    parameter: "p",
    axes: &[
        ("p", "Damköhler number p"),
        ("u", "conversion of A, u"),
        ("v", "concentration of B, v"),
        ("w", "temperature w"),
    ],
    start: 0.0,
    start_allowed: Allowed::AtLeast(0.0),
    end: 0.4,
    parameters: &[],
    elements: None,
    known: &[
        Known::hopf(0.204_184_535_701, 1e-10, SOURCE),
        Known::hopf(0.229_839_037_648, 1e-10, SOURCE),
        Known::hopf(0.259_957_854_245, 1e-10, SOURCE),
        Known::hopf(0.346_208_521_607, 1e-10, SOURCE),
    ],
    id: Id::Abc,
};

fn rates(x: &[f64], p: &[f64], r: &mut [f64]) {
    let [u, v, w] = [x[0], x[1], x[2]];
    let e = p[0] * w.exp();
    r[0] = -u + (1.0 - u) * e;
    r[1] = -v + e * (1.0 - u - 0.04 * v);
    r[2] = -2.55 * w + 8.0 * e * (1.0 - u + 0.04 * v);
}

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    let problem = DenseProblem::from_residual(3, &["p"], rates)
        .with_scale(ParamId(0), 0.1)
        .observing("u", |x, _| x[0])
        .observing("v", |x, _| x[1])
        .observing("w", |x, _| x[2]);
    Ok(hand(visitor, &problem, Setup::new(ENTRY.parameter, vec![0.0; 3], request)))
}
