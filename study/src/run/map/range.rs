//! The range of the second parameter, and the order in which it is searched.

use super::MapError;
use crate::case::MapCase;

/// Bounds of a positive parameter differ by at most twelve decades: beyond, rounding has taken over.
const LEAST: f64 = 1e-12;

/// The range: as the case says, else from a tenth to ten times the case's value; about a value of zero
/// as far as is `usual`.
///
/// # Errors
/// When it is not given and the value is zero without a usual range, when the value lies outside, or
/// when the bounds lie too many decades apart.
pub(super) fn bounds(
    key: &str,
    value: f64,
    usual: Option<f64>,
    map: MapCase,
) -> Result<(f64, f64), MapError> {
    let (near, far) = match usual {
        Some(usual) if value == 0.0 => (-usual, usual),
        _ => (0.1 * value, 10.0 * value),
    };
    let (low, high) = (map.from.unwrap_or(near.min(far)), map.to.unwrap_or(near.max(far)));
    if value == 0.0 && usual.is_none() && (map.from.is_none() || map.to.is_none()) {
        return Err(MapError::NoRange { key: key.to_string(), value });
    }
    let (inner, outer) = if low > 0.0 { (low, high) } else { (-high, -low) };
    if 0.0 < inner && inner < LEAST * outer {
        let (key, other) = if low > 0.0 { ("map.from", "map.to") } else { ("map.to", "map.from") };
        let (value, least) = (inner.copysign(low), LEAST * outer);
        return Err(MapError::TooWide { key, other, value, least });
    }
    if !(low < high && (low..=high).contains(&value)) {
        return Err(MapError::Outside { key: key.to_string(), value, range: (low, high) });
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
    use super::*;

    #[test]
    fn the_default_is_a_tenth_to_ten_times() {
        let map = MapCase::default();
        assert_eq!(bounds("k", 0.5, None, map).unwrap(), (0.05, 5.0));
        assert_eq!(bounds("k", -2.0, None, map).unwrap(), (-20.0, -0.2));
        assert!(matches!(bounds("k", 0.0, None, map), Err(MapError::NoRange { .. })));
        assert_eq!(bounds("k", 0.0, Some(0.5), map).unwrap(), (-0.5, 0.5));
        let given = MapCase { from: Some(-1.0), to: Some(1.0) };
        assert_eq!(bounds("k", 0.0, None, given).unwrap(), (-1.0, 1.0));
        assert!(matches!(bounds("k", 2.0, None, given), Err(MapError::Outside { .. })));
        let half = MapCase { from: Some(1.0), to: None };
        assert_eq!(bounds("k", 2.0, None, half).unwrap(), (1.0, 20.0));
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
