//! Oxidation of CO on platinum (Bykov, Yablonskii & Kim, *Dokl. Akad. Nauk SSSR* 242 (1978) 637).
//!
//! ```text
//! x' = 5z² − 2x² − 10xy
//! y' = pz − 0.1y − 10xy
//! s' = 0.0675(z − ks),   z = 1 − x − y − s
//! ```
//! Coverages `x` of oxygen, `y` of CO, `s` of an inactive species, `z` of nothing. From the solution
//! near `(0.1, 0.2, 0.5)` at `p = 1`, both ways: folds 1.052200287870, 1.042048505379; Hopf
//! 1.040991569533, 1.051557462458, at `k = 0.4`. With `k` free: Bogdanov-Takens points at `(p, k)` =
//! (1.1611987088217, 0.722339072522) and (1.4176276376006, 0.971397573485), cusp at (1.0064083296783,
//! 0.355991273209); the tutorial of BifurcationKit.jl prints 0.356654 for the last, where there still
//! are two folds, at 1.0070588 and 1.0070794.

use crate::ode::{Ode, System};
use crate::visit::hand;
use crate::{Allowed, Constant, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::{Name, NewtonSettings, Parameter, names, newton};

/// See the module.
#[derive(Debug, Clone, Copy, Default)]
pub struct CoOxidation;

impl System<3> for CoOxidation {
    const UNKNOWNS: &'static [Name] = names!["x", "y", "s"];
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("p", "", 1.0), Parameter::new("k", "", 0.4)];

    fn rates([x, y, s]: [f64; 3], p: &[f64]) -> [f64; 3] {
        let z = 1.0 - x - y - s;
        [
            5.0 * z * z - 2.0 * x * x - 10.0 * x * y,
            p[0] * z - 0.1 * y - 10.0 * x * y,
            0.0675 * (z - p[1] * s),
        ]
    }

    fn by_unknowns([x, y, s]: [f64; 3], p: &[f64]) -> [[f64; 3]; 3] {
        let z = 10.0 * (1.0 - x - y - s);
        [
            [-z - 4.0 * x - 10.0 * y, -z - 10.0 * x, -z],
            [-p[0] - 10.0 * y, -p[0] - 0.1 - 10.0 * x, -p[0]],
            [-0.0675, -0.0675, -0.0675 * (1.0 + p[1])],
        ]
    }

    fn by_parameter([x, y, s]: [f64; 3], _p: &[f64], which: usize) -> [f64; 3] {
        match which {
            0 => [0.0, 1.0 - x - y - s, 0.0],
            _ => [0.0, 0.0, -0.0675 * s],
        }
    }
}

const SOURCE: &str = "recomputed in multiple precision";
const TAKENS: &str = "bogdanov-takens";

pub(crate) static ENTRY: Entry = Entry {
    name: "co-oxidation",
    summary: "oxidation of CO on platinum: folds and Hopf points close together",
    parameter: "p",
    axes: &[
        ("p", "adsorption rate of CO, p"),
        ("x", "coverage by oxygen, x"),
        ("y", "coverage by CO, y"),
        ("s", "coverage by the inactive species, s"),
    ],
    start: 0.6,
    start_allowed: Allowed::Above(0.0),
    end: 2.5,
    parameters: &[Constant { name: "k", default: 0.4, allowed: Allowed::Above(0.0) }],
    elements: None,
    known: &[
        Known::hopf(1.051_557_462_458, 1e-10, SOURCE),
        Known::fold(1.052_200_287_870, 1e-10, SOURCE),
        Known::hopf(1.040_991_569_533, 1e-10, SOURCE),
        Known::fold(1.042_048_505_379, 1e-10, SOURCE),
        Known::double(TAKENS, 1.161_198_708_821_7, ("k", 0.722_339_072_522), 1e-10, SOURCE),
        Known::double(TAKENS, 1.417_627_637_600_6, ("k", 0.971_397_573_485), 1e-10, SOURCE),
        Known::double("cusp", 1.006_408_329_678_3, ("k", 0.355_991_273_209), 1e-10, SOURCE),
    ],
    id: Id::CoOxidation,
};

/// A solution at the start: from `p = 1` there in steps, each a Newton iteration.
pub(crate) fn visit<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    const STEPS: u32 = 40;
    let (mut u, k) = ([0.1, 0.2, 0.5], request.parameter(0));
    for i in 0..=STEPS {
        let way = f64::from(i) / f64::from(STEPS);
        let p = [1.0 + way * (request.start - 1.0), k];
        newton(&Ode(CoOxidation), &mut u, &p, &NewtonSettings::default())
            .map_err(|cause| ProblemError::Start { value: p[0], cause })?;
    }
    Ok(hand(visitor, &Ode(CoOxidation), Setup::new(ENTRY.parameter, u.to_vec(), request)))
}
