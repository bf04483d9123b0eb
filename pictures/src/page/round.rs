//! Numbers of seven significant digits, for a page that people look at; null where not defined.

use serde::ser::{SerializeMap, SerializeSeq, Serializer};
use serde::{Serialize, ser};

/// A number with seven significant digits.
struct Rounded(f64);

impl Serialize for Rounded {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        number(&self.0, serializer)
    }
}

pub(super) fn number<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if !value.is_finite() {
        return serializer.serialize_none();
    }
    let rounded: f64 = format!("{value:.6e}").parse().map_err(ser::Error::custom)?;
    // whole numbers need no ".0"
    if rounded.fract() == 0.0 && rounded.abs() < 1e9 {
        serializer.serialize_i64(rounded as i64)
    } else {
        serializer.serialize_f64(rounded)
    }
}

pub(super) fn optional<S: Serializer>(
    value: &Option<f64>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    number(&value.unwrap_or(f64::NAN), serializer)
}

pub(super) fn numbers<S: Serializer>(values: &[f64], serializer: S) -> Result<S::Ok, S::Error> {
    let mut seq = serializer.serialize_seq(Some(values.len()))?;
    for &value in values {
        seq.serialize_element(&Rounded(value))?;
    }
    seq.end()
}

struct Numbers<'a>(&'a [f64]);

impl Serialize for Numbers<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        numbers(self.0, serializer)
    }
}

pub(super) fn columns<S: Serializer>(
    columns: &[(String, Vec<f64>)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(columns.len()))?;
    for (name, values) in columns {
        map.serialize_entry(name, &Numbers(values))?;
    }
    map.end()
}

pub(super) fn flags<S: Serializer>(
    flags: &[(String, Vec<bool>)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(flags.iter().map(|(name, values)| (name, values)))
}

#[cfg(test)]
mod tests {
    use super::Numbers;

    #[test]
    fn seven_digits_are_kept() {
        let values = [0.1234567891, 1.0, -3e-12 / 7.0, f64::NAN, f64::INFINITY, 12_345_678.9, -0.0];
        let json = serde_json::to_string(&Numbers(&values)).unwrap_or_default();
        assert_eq!(json, "[0.1234568,1,-4.285714e-13,null,null,12345680,0]");
    }
}
