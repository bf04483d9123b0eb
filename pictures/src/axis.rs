//! Ranges, ticks and their labels.

use study::record::view::drawable;

/// One axis: its range in the units of its labels, its ticks, its title.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axis {
    /// Lower end.
    pub(super) low: f64,
    /// Upper end.
    pub(super) high: f64,
    /// Where the ticks are.
    pub(super) ticks: Vec<f64>,
    /// Digits after the point in the labels of ticks.
    decimals: usize,
    /// Data divided by this are in the units of the labels.
    pub(super) unit: f64,
    /// Title, a power of ten included where the labels need one.
    pub(super) title: String,
    /// Whether places on it are logarithms to base ten.
    logarithmic: bool,
}

/// Data that are nowhere larger than this are what rounding leaves of zero.
const NOTHING: f64 = 1e-25;

impl Axis {
    /// An axis that shows all of `values`, with some room at both ends, and about `count` ticks.
    pub(super) fn of(title: &str, values: impl Iterator<Item = f64>, count: usize) -> Self {
        let (low, high) = values
            .filter(|value| drawable(*value))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let (low, high) = if low > high { (0.0, 1.0) } else { (low, high) };
        let size = low.abs().max(high.abs());
        let (low, high) = if size < NOTHING {
            (-1.0, 1.0)
        } else if high - low > 1e-9 * size {
            let room = 0.04 * (high - low);
            (low - room, high + room)
        } else {
            (low - 0.1 * size, high + 0.1 * size)
        };
        Self::exactly(title, low, high, count)
    }

    /// An axis from `low` to `high`, which differ, and are not far apart from zero and each other.
    pub(super) fn exactly(title: &str, low: f64, high: f64, count: usize) -> Self {
        let exponent = low.abs().max(high.abs()).log10().floor() as i32;
        let power = if (-2..=3).contains(&exponent) { 0 } else { exponent };
        let unit = 10_f64.powi(power);
        let (low, high) = (low / unit, high / unit);
        let title = if power == 0 {
            title.to_string()
        } else {
            format!("{title}  (×10{})", superscript(power))
        };
        let step = nice_step((high - low) / count.max(2) as f64);
        let first = (low / step).ceil() as i64;
        let last = (high / step).floor() as i64;
        let ticks = (first..=last.min(first + 50)).map(|i| i as f64 * step).collect();
        let decimals = (-(step * 1.000_001).log10().floor()).clamp(0.0, 12.0) as usize;
        Axis { low, high, ticks, decimals, unit, title, logarithmic: false }
    }

    /// An axis from `low` to `high`, logarithms to base ten, with ticks at powers of ten.
    pub(super) fn of_logarithms(title: &str, low: f64, high: f64) -> Self {
        let (first, last) = (low.ceil() as i32, high.floor() as i32);
        let every = ((last - first) / 8 + 1).max(1) as usize;
        let ticks = (first..=last).step_by(every).map(f64::from).collect();
        let title = title.to_owned();
        Axis { low, high, ticks, decimals: 0, unit: 1.0, title, logarithmic: true }
    }

    /// The label of a tick.
    pub(super) fn label(&self, value: f64) -> String {
        if self.logarithmic {
            return format!("10{}", superscript(value as i32));
        }
        let text = format!("{value:.*}", self.decimals);
        let zero = text.bytes().all(|b| matches!(b, b'0' | b'-' | b'.'));
        if zero { "0".to_string() } else { text.replace('-', "−") }
    }

    /// Whether zero lies inside.
    pub(super) fn has_zero(&self) -> bool {
        self.low < 0.0 && self.high > 0.0 && !self.logarithmic
    }
}

/// 1, 2 or 5 times a power of ten, at least `rough`.
fn nice_step(rough: f64) -> f64 {
    let power = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0].into_iter().find(|m| m * power >= rough * 0.999_999);
    step.unwrap_or(10.0) * power
}

fn superscript(exponent: i32) -> String {
    exponent
        .to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            digit => char::from_u32(0x2070 + digit.to_digit(10).unwrap_or(0)).unwrap_or('⁰'),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(values: &[f64]) -> Vec<String> {
        let axis = Axis::of("x", values.iter().copied(), 6);
        axis.ticks.iter().map(|tick| axis.label(*tick)).collect()
    }

    #[test]
    fn what_rounding_leaves_of_zero_is_flat() {
        let axis = Axis::of("norm", [0.0, 2.2e-31, 0.0].into_iter(), 7);
        assert_eq!((axis.low, axis.high, axis.unit), (-1.0, 1.0, 1.0));
        let small = Axis::of("energy", [0.0, 2.2e-21].into_iter(), 7);
        assert!(small.unit < 1e-20);
    }

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!(labels(&[0.0, 1.0]), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(&[-3.0, 12.0]), ["0", "5", "10"]);
    }

    #[test]
    fn small_and_large_numbers_move_a_power_of_ten_to_the_title() {
        let axis = Axis::of("p", [0.0, 3e-6].into_iter(), 6);
        assert_eq!(axis.title, "p  (×10⁻⁶)");
        assert!(axis.high < 10.0);
        assert_eq!(Axis::of("p", [2e10].into_iter(), 6).title, "p  (×10¹⁰)");
    }

    #[test]
    fn degenerate_data_still_have_a_range() {
        for values in [vec![], vec![f64::NAN], vec![0.0], vec![1.0; 3], vec![1.0, 1.0 + 1e-15]] {
            let axis = Axis::of("x", values.iter().copied(), 6);
            assert!(axis.low < axis.high, "{values:?}");
            assert!(axis.ticks.len() > 1, "{values:?}: {axis:?}");
        }
        for tiny in [1e-300, 1e-320, 1e99] {
            let axis = Axis::of("x", [tiny, -tiny].into_iter(), 6);
            assert!(axis.low < axis.high && axis.low.is_finite() && axis.high.is_finite());
        }
    }
}
