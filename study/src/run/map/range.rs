//! The range of the second parameter, and the order in which it is searched.

use super::{MapError, Second};
use crate::case::MapCase;

/// Bounds of a positive parameter differ by at most twelve decades: beyond, rounding has taken over.
const LEAST: f64 = 1e-12;

/// The range: as the case says, else from a tenth to ten times the case's value; about a value of zero
/// as far as is `usual`; within its limits.
///
/// # Errors
/// When it is not given and the value is zero without a usual range, when the value lies outside, when a
/// bound is beyond the limits, or when the bounds lie too many decades apart.
pub(super) fn bounds(second: &Second, map: MapCase) -> Result<(f64, f64), MapError> {
    let Second { key, value, usual, limits } = second;
    let value = *value;
    let (near, far) = match usual {
        Some(usual) if value == 0.0 => (-usual, *usual),
        _ => (0.1 * value, 10.0 * value),
    };
    let (mut least, mut most) = (near.min(far), near.max(far));
    if let Some(limits) = limits {
        (least, most) = (least.max(limits.low), most.min(limits.high));
        for (bound, given) in [("map.from", map.from), ("map.to", map.to)] {
            if let Some(value) = given.filter(|value| !limits.allowed.contains(*value)) {
                let (key, allowed) = (key.clone(), limits.allowed.words);
                return Err(MapError::Bound { bound, value, key, allowed });
            }
        }
    }
    let (low, high) = (map.from.unwrap_or(least), map.to.unwrap_or(most));
    if value == 0.0 && usual.is_none() && (map.from.is_none() || map.to.is_none()) {
        return Err(MapError::NoRange { key: key.clone(), value });
    }
    let (inner, outer) = if low > 0.0 { (low, high) } else { (-high, -low) };
    if 0.0 < inner && inner < LEAST * outer {
        let (key, other) = if low > 0.0 { ("map.from", "map.to") } else { ("map.to", "map.from") };
        let (value, least) = (inner.copysign(low), LEAST * outer);
        return Err(MapError::TooWide { key, other, value, least });
    }
    if !(low < high && (low..=high).contains(&value)) {
        return Err(MapError::Outside { key: key.clone(), value, range: (low, high) });
    }
    Ok((low, high))
}

/// Values in a range, coarsely first: its ends, its middle, the middles of the halves, and so on
/// down to `parts` parts, a power of two; evenly spaced in the logarithm where both ends are
/// positive.
pub(super) fn search((low, high): (f64, f64), parts: usize) -> Vec<f64> {
    let at = |part: usize| {
        let t = part as f64 / parts as f64;
        let inside = if low > 0.0 { low * (high / low).powf(t) } else { low + t * (high - low) };
        inside.clamp(low, high)
    };
    let mut order = vec![0, parts];
    let mut stride = parts;
    while stride > 1 {
        order.extend((stride / 2..parts).step_by(stride));
        stride /= 2;
    }
    order.into_iter().map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::super::Limits;
    use super::*;
    use crate::case::keys::FRACTION;

    #[test]
    fn the_default_is_a_tenth_to_ten_times() {
        let second = |value, usual| Second { key: "k".to_string(), value, usual, limits: None };
        let map = MapCase::default();
        assert_eq!(bounds(&second(0.5, None), map).unwrap(), (0.05, 5.0));
        assert_eq!(bounds(&second(-2.0, None), map).unwrap(), (-20.0, -0.2));
        assert!(matches!(bounds(&second(0.0, None), map), Err(MapError::NoRange { .. })));
        assert_eq!(bounds(&second(0.0, Some(0.5)), map).unwrap(), (-0.5, 0.5));
        let given = MapCase { from: Some(-1.0), to: Some(1.0) };
        assert_eq!(bounds(&second(0.0, None), given).unwrap(), (-1.0, 1.0));
        assert!(matches!(bounds(&second(2.0, None), given), Err(MapError::Outside { .. })));
        let half = MapCase { from: Some(1.0), to: None };
        assert_eq!(bounds(&second(2.0, None), half).unwrap(), (1.0, 20.0));
    }

    #[test]
    fn a_range_stays_within_the_limits() {
        let fraction = |value| {
            let limits = Limits { low: 0.0, high: 1.0, allowed: FRACTION };
            Second { key: "b".to_string(), value, usual: Some(1.0), limits: Some(limits) }
        };
        let map = MapCase::default();
        assert_eq!(bounds(&fraction(0.5), map).unwrap(), (0.05, 1.0));
        assert_eq!(bounds(&fraction(0.0), map).unwrap(), (0.0, 1.0));
        for given in [MapCase { from: Some(-0.1), to: None }, MapCase { from: None, to: Some(1.1) }]
        {
            assert!(matches!(bounds(&fraction(0.5), given), Err(MapError::Bound { .. })));
        }
    }

    #[test]
    fn a_range_is_searched_coarsely_first() {
        assert_eq!(search((0.0, 8.0), 8), [0.0, 8.0, 4.0, 2.0, 6.0, 1.0, 3.0, 5.0, 7.0]);
        let logarithmic = search((0.01, 100.0), 4);
        for (found, expected) in logarithmic.iter().zip([0.01, 100.0, 1.0, 0.1, 10.0]) {
            assert!((found / expected - 1.0).abs() < 1e-12);
        }
    }
}
