//! The normal form of a fold.

use super::plateau::settle;
use super::probe::{Extended, Probe};
use crate::branch::FoldForm;
use crate::problem::EvalError;
use crate::step::{State, dot};

/// `p″ = −ψᵀ F_zz[t, t] / ψᵀ F_p` along the unit tangent `t`, with `left` = `ψ / ψᵀ F_p`; and a bound of
/// what errors of the problem's derivatives do to dp/ds.
pub(crate) fn fold_form(
    probe: &mut Probe<'_>,
    x: &State,
    left: &[f64],
) -> Result<(FoldForm, f64), EvalError> {
    let z = Extended { u: x.u.clone(), p: x.p };
    let t = Extended { u: x.tu.clone(), p: x.tp };
    let bent = settle(0.0, |part| {
        let second = probe.second(&z, &t, part, &[&t])?;
        Ok(Some(-dot(left, &second[0])))
    })?;
    let Some(bent) = bent else { return Err(EvalError::NotFinite { at: 0 }) };
    let along = bent.value;
    let missed = probe.derivative_error(&z, &t)?;
    let missed: f64 = missed.iter().zip(left).map(|(e, w)| e * w.abs()).sum();
    let square = x.length * x.length;
    let order = bent.is_signed().then_some(2);
    let form = FoldForm { curvature: along / square, curvature_error: bent.error / square, order };
    Ok((form, missed))
}
