//! The two functions of the multipliers that vanish at period doublings and Neimark-Sacker points.

use super::floquet::Multiplier;

/// The two functions of the multipliers: `(Π(1 + μ), Π(μ_i μ_j − 1))`, over the root of the sum of the
/// squares of the polynomials' coefficients, the trivial multiplier left out of the second.
pub(super) fn functions(known: &[Multiplier]) -> [f64; 2] {
    let doubling = normalised(known.iter().map(|m| (m.log_modulus, m.argument)), -1.0);
    let trivial = super::point::trivial(known);
    let others: Vec<&Multiplier> =
        known.iter().enumerate().filter(|(i, _)| Some(*i) != trivial).map(|(_, m)| m).collect();
    let pairs = others.iter().enumerate().flat_map(|(i, a)| {
        others[i + 1..]
            .iter()
            .map(move |b| (a.log_modulus + b.log_modulus, a.argument + b.argument))
    });
    [doubling, normalised(pairs, 1.0)]
}

/// `Π(μ − z)`, `z` 1 or −1, over the root of the sum of the squares of the coefficients of the
/// polynomial `Π(μ + x)`: at most of order one whatever the sizes of the numbers, and as smooth.
fn normalised(values: impl Iterator<Item = (f64, f64)>, z: f64) -> f64 {
    let (mut coefficients, mut product) = (vec![(1.0, 0.0)], (1.0, 0.0));
    let times = |a: (f64, f64), b: (f64, f64)| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
    for (log, argument) in values {
        // large numbers by their reciprocals: a common factor
        let (value, one) = if log > 0.0 {
            let turn = if argument.abs() == std::f64::consts::PI {
                (-1.0, 0.0)
            } else {
                (argument.cos(), argument.sin())
            };
            (turn, (-log).exp())
        } else {
            let size = log.exp();
            let turn = if argument.abs() == std::f64::consts::PI {
                (-size, 0.0)
            } else {
                (size * argument.cos(), size * argument.sin())
            };
            (turn, 1.0)
        };
        product = times(product, (value.0 - z * one, value.1));
        let before = coefficients.clone();
        coefficients.push((0.0, 0.0));
        for (k, c) in coefficients.iter_mut().enumerate() {
            let low = before.get(k).map_or((0.0, 0.0), |b| times(*b, value));
            let high = if k > 0 { before[k - 1] } else { (0.0, 0.0) };
            *c = (low.0 + one * high.0, low.1 + one * high.1);
        }
    }
    let size = coefficients.iter().map(|c| c.0 * c.0 + c.1 * c.1).sum::<f64>().sqrt();
    product.0 / size
}
