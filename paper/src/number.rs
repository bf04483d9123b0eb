//! Numbers for people.

/// Four digits.
pub(crate) fn short(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&size) {
        let decimals = (3 - size.log10().floor() as i32).clamp(0, 6) as usize;
        let text = format!("{value:.decimals$}");
        let text = if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        };
        text.replace('-', "−")
    } else {
        format!("{value:.3e}").replace('-', "−")
    }
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn short_numbers_have_four_digits() {
        assert_eq!(
            [0.0, 7.78392, -0.0269, 1234.5, 3e-6].map(short),
            ["0", "7.784", "−0.0269", "1234", "3.000e−6"]
        );
    }
}
