//! The normal form of a fold.

use super::probe::{Extended, Probe};
use crate::branch::FoldForm;
use crate::problem::{EvalError, Problem};
use crate::step::{State, dot};

/// `p″ = −ψᵀ F_zz[t, t] / ψᵀ F_p` along the unit tangent `t`, with `left` = `ψ / ψᵀ F_p`.
pub(crate) fn fold_form<P: Problem>(
    probe: &mut Probe<'_, P>,
    x: &State,
    left: &[f64],
) -> Result<FoldForm, EvalError> {
    let z = Extended { u: x.u.clone(), p: x.p };
    let t = Extended { u: x.tu.clone(), p: x.tp };
    let second = probe.second(&z, &t, 1.0, &[&t])?;
    Ok(FoldForm { curvature: -dot(left, &second[0]) / (x.length * x.length) })
}
