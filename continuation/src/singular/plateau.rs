//! Derivatives by differences whose step meets the scale on which the function varies.
//!
//! The natural amplitude says where the nonlinearity matters, not on what scale it varies: a
//! coefficient of the normal form may be another one on a hundredth of it. A value is believed where
//! it stands still over a range of steps, the finest such range, and only then.

use crate::problem::EvalError;

/// Ratio of successive steps. Truncation errors of fourth order shrink 256 times.
const FINER: f64 = 0.25;
/// Most steps: rounding has all of a second derivative at the last one.
const MOST: i32 = 9;
/// Fewest values of which the finest range is sought.
const LEAST: i32 = 3;
/// The step far below the first two that shows a finer scale, 1000 times shorter.
const DEEP: i32 = 5;
/// By how much a step is longer that smooth functions hardly tell from it: what falls like its fourth
/// power changes by 8 %.
const LONGER: f64 = 1.02;
/// A change by that part over such a step is rounding.
const IRREGULAR: f64 = 0.3;
/// What a step `1 / FINER` times as long has of the rounding of a second derivative.
const COARSER: f64 = FINER * FINER;
/// Differences of this many times the expected rounding may be rounding.
const FEW: f64 = 8.0;
/// Relative difference of the first two values that is truncation.
const CONVERGED: f64 = 1e-4;
/// Relative difference of the first two values that is rounding.
const ROUNDING: f64 = 1e-7;
/// Relative error that values have that are the same to the last digits.
const LAST_DIGITS: f64 = 16.0 * f64::EPSILON;
/// Relative difference of values that stand still in rounding.
const STANDS: f64 = 1e-2;

/// A value with its estimated error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Settled {
    pub(super) value: f64,
    pub(super) error: f64,
    /// Whether the value stands still anywhere; otherwise the error is the spread of all values.
    pub(super) converged: bool,
}

impl Settled {
    /// Whether the sign of the value is known.
    pub(super) fn is_signed(&self) -> bool {
        self.converged && self.value.abs() > 3.0 * self.error
    }
}

/// The limit of `value` for short steps, given as parts of the natural one. `None` where it has no
/// value. A second derivative may have a `rounding` of this size over the natural step, and more the
/// shorter the step is; 0 where that is not known.
pub(super) fn settle(
    rounding: f64,
    mut value: impl FnMut(f64) -> Result<Option<f64>, EvalError>,
) -> Result<Option<Settled>, EvalError> {
    let mut at = |part: f64| value(part).map(|v| v.filter(|v| v.is_finite()));
    let mut known = [None; MOST as usize];
    for k in [0, 1, DEEP] {
        known[k as usize] = Some(at(FINER.powi(k)));
    }
    let mut steps = MOST;
    if let [Some(Ok(Some(coarse))), Some(Ok(Some(fine)))] = known[..2] {
        let truncation = (coarse - fine).abs();
        let size = coarse.abs().max(fine.abs());
        // what rounding has of `fine`
        let mut left = 0.0;
        let mut smooth = false;
        let mut k = DEEP;
        while k > 1 && !smooth {
            let Ok(Some(v)) = *known[k as usize].get_or_insert_with(|| at(FINER.powi(k))) else {
                break;
            };
            let off = (v - fine).abs();
            smooth = off <= STANDS * size;
            if !smooth {
                // where it may, or a step hardly longer has quite another value, rounding has it, and all
                // of the shorter ones; the next longer one has sixteen times less
                let mut irregular = if off <= rounding * COARSER.powi(-k) { off } else { 0.0 };
                for longer in [LONGER, LONGER * LONGER] {
                    if irregular <= IRREGULAR * off {
                        let beside = at(longer * FINER.powi(k));
                        irregular = beside.ok().flatten().map_or(0.0, |beside| (v - beside).abs());
                    }
                }
                if irregular <= IRREGULAR * off {
                    break;
                }
                steps = k.max(LEAST);
                let mut noise = irregular.max(off);
                left = noise * COARSER.powi(k - 1);
                while k > 1 && noise > 0.5 * STANDS * size {
                    (k, noise) = (k - 1, noise * COARSER);
                }
            }
        }
        if smooth && truncation <= (CONVERGED * size).max(FEW * left) {
            // a difference this small is rounding, of which the longer step has less
            let rounded = truncation <= (ROUNDING * size).max(FEW * left);
            let value = if rounded { coarse } else { fine };
            let error = truncation.max(LAST_DIGITS * size);
            return Ok(Some(Settled { value, error, converged: true }));
        }
    }
    let mut values = Vec::new();
    let mut failure = None;
    for k in 0..steps {
        match known[k as usize].unwrap_or_else(|| at(FINER.powi(k))) {
            Ok(Some(v)) => values.push(v),
            Ok(None) => return Ok(None),
            // a long step may leave the domain, a short one does not
            Err(error) => failure = Some(error),
        }
    }
    if values.len() < LEAST as usize {
        return failure.map_or(Ok(None), Err);
    }
    let spread = |v: &[f64]| {
        let (lo, hi) = v
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(*v), hi.max(*v)));
        hi - lo
    };
    let mut still = values.windows(3).filter(|w| spread(w) <= STANDS * w[1].abs());
    if let Some(finest) = still.next_back() {
        // of the two neighbours the nearer one says what truncation or rounding leave
        let near = (finest[0] - finest[1]).abs().min((finest[2] - finest[1]).abs());
        let error = near.max(1e-2 * spread(finest)).max(LAST_DIGITS * finest[1].abs());
        return Ok(Some(Settled { value: finest[1], error, converged: true }));
    }
    let error = spread(&values);
    let value = values[values.len() / 3];
    Ok(Some(Settled { value, error, converged: false }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(f: impl Fn(f64) -> f64) -> Settled {
        settle(0.0, |h| Ok(Some(f(h)))).unwrap().unwrap()
    }

    #[test]
    fn values_settle_on_the_finest_scale() {
        // smooth: truncation of fourth order
        let smooth = of(|h| 2.0 + 1e-5 * h.powi(4));
        assert!((smooth.value - 2.0).abs() <= smooth.error && smooth.is_signed());
        for e in [1e-1, 3e-2, 1e-2] {
            // one coefficient on the natural scale, another one below e
            let found = of(|h: f64| 6.0 - 30.0 / (1.0 + (h / e).powi(2)).powi(2));
            assert!((found.value + 24.0).abs() < 0.3 && found.is_signed(), "{e} {found:?}");
        }
        // rounding grows as the step shrinks
        let noisy = of(|h| 1.0 + 1e-9 * (1e3 / h).sin() / (h * h));
        assert!((noisy.value - 1.0).abs() < 1e-3 && noisy.is_signed(), "{noisy:?}");
        // nothing but rounding has no sign
        let zero = of(|h| 1e-9 * (1e3 / h).sin() / h);
        assert!(!zero.is_signed(), "{zero:?}");
    }

    #[test]
    fn steps_that_leave_the_domain_teach_nothing() {
        let found =
            settle(
                0.0,
                |h| if h > 0.01 { Err(EvalError::NotFinite { at: 0 }) } else { Ok(Some(3.0)) },
            );
        assert_eq!(found.unwrap().map(|f| (f.value, f.converged)), Some((3.0, true)));
    }
}
