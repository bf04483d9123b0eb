//! Gauss-Legendre quadrature.

use std::f64::consts::PI;

/// Fewest Gauss points per element.
pub const FEWEST: usize = 2;
/// Most Gauss points per element.
pub const MOST: usize = 8;

/// Nodes in `(0, 1)`, ascending, and weights (sum 1) of the Gauss-Legendre rule with `count`
/// points, by Newton's method on the Legendre polynomial: full precision for any count.
pub fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    let mut rule: Vec<(f64, f64)> = (0..count)
        .map(|i| {
            let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
            for _ in 0..10 {
                let (p, dp) = legendre(count, x);
                x -= p / dp;
            }
            let dp = legendre(count, x).1;
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * dp * dp))
        })
        .collect();
    rule.sort_by(|a, b| a.0.total_cmp(&b.0));
    rule
}

/// The Legendre polynomial of degree `n` and its derivative.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut p) = (1.0, x);
    for k in 1..n {
        let k = k as f64;
        (before, p) = (p, ((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0));
    }
    (p, n as f64 * (x * p - before) / (x * x - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_for_polynomials_of_degree_twice_the_count_less_one() {
        for count in FEWEST..=MOST {
            let rule = gauss_legendre(count);
            for degree in 0..2 * count {
                let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(degree as i32)).sum();
                let exact = 1.0 / (degree + 1) as f64;
                assert!((sum - exact).abs() < 4e-16, "{count} points, degree {degree}: {sum}");
            }
        }
    }
}
