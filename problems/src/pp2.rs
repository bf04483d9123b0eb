//! Predator and prey with harvesting: AUTO's demo `pp2`, from its residual alone.
//!
//! ```text
//! u' = 3u(1 − u) − uv − p(1 − e^{−5u}),   v' = −v + 3uv
//! ```
//! (AUTO-07p manual, demo `pp2`.) The trivial branch `u = v = 0` has a branch point at `p = 3/5`.
//! On the branch of prey alone, which leaves there: branch point 0.821904345374 (predators enter),
//! fold 0.832929322234. On the branch with both: Hopf 0.671593847479.

use crate::visit::hand;
use crate::{Allowed, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::DenseProblem;

const SOURCE: &str = "recomputed in multiple precision; AUTO-07p demo pp2";

pub(crate) static ENTRY: Entry = Entry {
    name: "pp2",
    summary: "AUTO's harvested predator and prey: branch point at 0.6, then two more branches",
    parameter: "p",
    axes: &[("p", "harvest p"), ("u", "prey u"), ("v", "predators v")],
    start: 0.0,
    start_allowed: Allowed::Any,
    end: 1.0,
    parameters: &[],
    elements: None,
    known: &[
        Known::branch_point(0.6, 1e-10, "3 - 5p = 0").form("transcritical"),
        Known::branch_point(0.821_904_345_374, 1e-10, SOURCE)
            .form("transcritical")
            .after_switching(),
        Known::fold(0.832_929_322_234, 1e-10, SOURCE).after_switching(),
        Known::hopf(0.671_593_847_479, 1e-10, SOURCE).after_switching(),
    ],
    id: Id::Pp2,
};

fn rates(x: &[f64], p: &[f64], r: &mut [f64]) {
    let [u, v] = [x[0], x[1]];
    // 1 − e^{−5u} without cancellation
    r[0] = 3.0 * u * (1.0 - u) - u * v + p[0] * (-5.0 * u).exp_m1();
    r[1] = -v + 3.0 * u * v;
}

pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    let problem = DenseProblem::from_residual(2, &["p"], rates)
        .observing("u", |x, _| x[0])
        .observing("v", |x, _| x[1]);
    Ok(hand(visitor, &problem, Setup::new(ENTRY.parameter, vec![0.0; 2], request)))
}
