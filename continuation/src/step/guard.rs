//! The parameter's domain as a guard: nothing beyond it is evaluated.

use crate::problem::EvalError;

/// Distance beyond a bound, relative to it and to the domain's width, that rounding and the last
/// corrections explain: the problem is asked at the bound then.
const SLACK: f64 = 1e-10;

/// The values of the continued parameter at which a problem may be evaluated.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Guard {
    domain: (f64, f64),
    width: f64,
}

impl Guard {
    /// Of a domain; without one all are.
    pub(crate) fn new(domain: Option<(f64, f64)>) -> Self {
        let domain = domain.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        let width = domain.1 - domain.0;
        Guard { domain, width: if width.is_finite() { width } else { 0.0 } }
    }

    /// Where to evaluate for the value `p`.
    pub(crate) fn admit(&self, p: f64) -> Result<f64, EvalError> {
        let bound = self.nearest(p);
        if (p - bound).abs() <= SLACK * (self.width + bound.abs()) || p.is_nan() {
            return Ok(bound);
        }
        Err(EvalError::OutsideDomain { value: p, bound })
    }

    /// The bound beyond which `p` lies, or `p`.
    pub(crate) fn nearest(&self, p: f64) -> f64 {
        p.max(self.domain.0).min(self.domain.1)
    }
}
