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
    /// The same without the power.
    name: String,
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
        let name = title.to_string();
        let title = if power == 0 {
            title.to_string()
        } else {
            format!("{title}  (×10{})", superscript(power))
        };
        let axis = Axis {
            low,
            high,
            ticks: Vec::new(),
            decimals: 0,
            unit,
            title,
            name,
            logarithmic: false,
        };
        axis.ticked(count)
    }

    /// The same with about `count` ticks.
    pub(super) fn ticked(mut self, count: usize) -> Self {
        if self.logarithmic {
            self.ticks = logarithmic_ticks(self.low, self.high, count);
            return self;
        }
        let step = nice_step((self.high - self.low) / count.max(2) as f64);
        let first = (self.low / step).ceil() as i64;
        let last = (self.high / step).floor() as i64;
        self.ticks = (first..=last.min(first + 50)).map(|i| i as f64 * step).collect();
        self.decimals = (-(step * 1.000_001).log10().floor()).clamp(0.0, 12.0) as usize;
        self
    }

    /// An axis from `low` to `high`, logarithms to base ten.
    pub(super) fn of_logarithms(title: &str, low: f64, high: f64) -> Self {
        let (title, name) = (title.to_owned(), title.to_owned());
        let ticks = Vec::new();
        let axis =
            Axis { low, high, ticks, decimals: 0, unit: 1.0, title, name, logarithmic: true };
        axis.ticked(8)
    }

    /// The same axis from and to other data, divided as is said; what is not said stays. A logarithmic axis
    /// begins at `positive`, the least of its data above zero, where it is not told to begin elsewhere.
    pub(super) fn bounded(
        &self,
        (from, to): (Option<f64>, Option<f64>),
        logarithmic: Option<bool>,
        positive: f64,
    ) -> Self {
        let logarithmic = logarithmic.unwrap_or(self.logarithmic);
        let [low, high] = [self.low, self.high].map(|end| self.value(end));
        let (mut low, mut high) = (from.unwrap_or(low), to.unwrap_or(high));
        if low >= high {
            // an end beyond all data: as much on the other side
            if from.is_some() {
                high = low + 0.1 * low.abs().max(1e-6);
            } else {
                low = high - 0.1 * high.abs().max(1e-6);
            }
        }
        if !logarithmic {
            return Axis::exactly(&self.name, low, high, 7);
        }
        if from.is_none() && (low <= 0.0 || positive > low) {
            low = 0.9 * positive.min(high);
        }
        if !(low > 0.0 && high > low) {
            return Axis::exactly(&self.name, low, high, 7);
        }
        Axis::of_logarithms(&self.name, low.log10(), high.log10())
    }

    /// A part of it, in the units of its labels.
    pub(super) fn part(&self, (low, high): (f64, f64), count: usize) -> Self {
        let part = Axis { low, high, ..self.clone() };
        let ticked = part.clone().ticked(count);
        let mut part = if ticked.ticks.len() < 2 { part.ticked(2 * count) } else { ticked };
        if part.logarithmic && part.ticks.len() < 2 {
            part.ticks = vec![low + 0.2 * (high - low), high - 0.2 * (high - low)];
        }
        part
    }

    /// Whether both show the same range.
    pub(super) fn is_like(&self, other: &Axis) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs().max(b.abs());
        near(self.value(self.low), other.value(other.low))
            && near(self.value(self.high), other.value(other.high))
    }

    /// Where a number is, in the units of the labels; not drawable where a logarithm has no place for it.
    pub(super) fn place(&self, value: f64) -> f64 {
        match self.logarithmic {
            true if value > 0.0 => value.log10(),
            true => f64::NAN,
            false => value / self.unit,
        }
    }

    /// The number at a place.
    pub(super) fn value(&self, place: f64) -> f64 {
        if self.logarithmic { 10_f64.powf(place) } else { place * self.unit }
    }

    /// The label of a tick.
    pub(super) fn label(&self, value: f64) -> String {
        if self.logarithmic {
            return power_label(value);
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

/// Powers of ten; between them their doubles and fives where there are few of them, or every digit.
fn logarithmic_ticks(low: f64, high: f64, count: usize) -> Vec<f64> {
    let (first, last) = (low.floor() as i32, high.ceil() as i32);
    let inside = |tick: &f64| *tick >= low - 1e-9 && *tick <= high + 1e-9;
    let decades = high - low;
    let of = |digits: &'static [f64]| -> Vec<f64> {
        (first..=last)
            .flat_map(|power| digits.iter().map(move |digit| f64::from(power) + digit.log10()))
            .filter(inside)
            .collect()
    };
    let powers: Vec<f64> = of(&[1.0]);
    if powers.len() > 2 {
        let every = powers.len().div_ceil(count.max(2) + 1);
        return powers.into_iter().step_by(every).collect();
    }
    if decades > 0.9 {
        return of(&[1.0, 2.0, 5.0]);
    }
    of(&[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0])
}

/// A power of ten, or a digit times one.
fn power_label(place: f64) -> String {
    let exponent = (place + 1e-9).floor() as i32;
    let digit = 10_f64.powf(place - f64::from(exponent));
    let round = (digit - 1.0).abs() < 1e-6;
    match (round, exponent) {
        (_, -1..=3) | (false, -2) => {
            let text = format!("{:.4}", digit * 10_f64.powi(exponent));
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        (true, _) => format!("10{}", superscript(exponent)),
        _ => {
            let digits = format!("{digit:.1}");
            format!("{}·10{}", digits.trim_end_matches(".0"), superscript(exponent))
        }
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
    fn a_logarithmic_axis_has_ticks_whatever_its_range() {
        let labels = |low: f64, high: f64| {
            let axis = Axis::of("x", [low, high].into_iter(), 7);
            let axis = axis.bounded((Some(low), Some(high)), Some(true), low);
            axis.ticks.iter().map(|tick| axis.label(*tick)).collect::<Vec<_>>()
        };
        assert_eq!(
            labels(1e-6, 1e2),
            ["10⁻⁶", "10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²", "0.1", "1", "10", "100"]
        );
        assert_eq!(labels(3e-4, 6e-3), ["5·10⁻⁴", "10⁻³", "2·10⁻³", "5·10⁻³"]);
        assert_eq!(labels(0.2, 0.4), ["0.2", "0.3", "0.4"]);
        // what has no logarithm is not drawn, and an axis of such data stays as it is
        let axis = Axis::of("x", [-1.0, 2.0].into_iter(), 7);
        let bounded = axis.bounded((None, None), Some(true), 0.5);
        assert!(bounded.place(-1.0).is_nan() && bounded.low < 0.5_f64.log10());
        assert_eq!(axis.bounded((Some(0.0), Some(1.0)), None, 0.5).high, 1.0);
        assert!((bounded.value(bounded.place(1.7)) - 1.7).abs() < 1e-12);
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
