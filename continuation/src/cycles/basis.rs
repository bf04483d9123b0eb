//! Gauss points and Lagrange polynomials of one interval.

/// The polynomials of degree `m` on `[0, 1]`, by their values at `k/m`, and the `m` Gauss points.
#[derive(Debug, Clone)]
pub(super) struct Basis {
    pub(super) degree: usize,
    /// The Gauss points.
    pub(super) points: Vec<f64>,
    /// Their weights, of sum 1.
    pub(super) weights: Vec<f64>,
    /// Row `i` of `m + 1`: the values of the polynomials at Gauss point `i`.
    pub(super) values: Vec<f64>,
    /// Their derivatives there.
    pub(super) slopes: Vec<f64>,
    /// Integrals of products of two polynomials by the Gauss rule, `(m + 1)²`.
    pub(super) products: Vec<f64>,
    /// Reciprocal of `Π (k − l)` over the other nodes `l`.
    scales: Vec<f64>,
    /// The derivative of order `m` of each polynomial, a constant.
    pub(super) top: Vec<f64>,
}

impl Basis {
    pub(super) fn new(degree: usize) -> Self {
        let (points, weights) = gauss(degree);
        let mut basis = Basis {
            degree,
            values: vec![0.0; (degree + 1) * degree],
            slopes: vec![0.0; (degree + 1) * degree],
            products: vec![0.0; (degree + 1) * (degree + 1)],
            scales: (0..=degree)
                .map(|k| {
                    let others = (0..=degree).filter(|l| *l != k);
                    others.map(|l| k as f64 - l as f64).product::<f64>().recip()
                })
                .collect(),
            top: vec![0.0; degree + 1],
            points,
            weights,
        };
        for i in 0..degree {
            let t = basis.points[i];
            let mut row = vec![0.0; degree + 1];
            basis.evaluate(t, &mut row);
            basis.values[i * (degree + 1)..][..degree + 1].copy_from_slice(&row);
            for (k, product) in basis.products.iter_mut().enumerate() {
                *product += basis.weights[i] * row[k / (degree + 1)] * row[k % (degree + 1)];
            }
            basis.differentiate(t, &mut row);
            basis.slopes[i * (degree + 1)..][..degree + 1].copy_from_slice(&row);
        }
        let m = degree as f64;
        for k in 0..=degree {
            // m! over the product of the differences of the nodes
            let node = |k: usize| k as f64 / m;
            let product: f64 =
                (0..=degree).filter(|l| *l != k).map(|l| node(k) - node(l)).product();
            let factorial: f64 = (1..=degree).map(|x| x as f64).product();
            basis.top[k] = factorial / product;
        }
        basis
    }

    /// Values of the polynomials at `t`.
    pub(super) fn evaluate(&self, t: f64, out: &mut [f64]) {
        let x = self.degree as f64 * t;
        // products of what is left of a node, then of what is right of it
        let mut product = 1.0;
        for (k, out) in out.iter_mut().enumerate() {
            *out = product * self.scales[k];
            product *= x - k as f64;
        }
        product = 1.0;
        for (k, out) in out.iter_mut().enumerate().rev() {
            *out *= product;
            product *= x - k as f64;
        }
    }

    /// Derivatives of the polynomials at `t`.
    pub(super) fn differentiate(&self, t: f64, out: &mut [f64]) {
        let m = self.degree as f64;
        for k in 0..=self.degree {
            let mut sum = 0.0;
            for left_out in (0..=self.degree).filter(|l| *l != k) {
                let rest: f64 = (0..=self.degree)
                    .filter(|l| *l != k && *l != left_out)
                    .map(|l| (m * t - l as f64) / (k as f64 - l as f64))
                    .product();
                sum += m / (k as f64 - left_out as f64) * rest;
            }
            out[k] = sum;
        }
    }
}

/// Points and weights of the Gauss rule with `m` points on `[0, 1]`.
fn gauss(m: usize) -> (Vec<f64>, Vec<f64>) {
    let mut points = vec![0.0; m];
    let mut weights = vec![0.0; m];
    for i in 0..m {
        // Newton's method from Tricomi's estimate of the root of the Legendre polynomial
        let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (m as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..20 {
            let (mut before, mut here) = (1.0, x);
            for k in 2..=m {
                let k = k as f64;
                (before, here) = (here, ((2.0 * k - 1.0) * x * here - (k - 1.0) * before) / k);
            }
            slope = m as f64 * (x * here - before) / (x * x - 1.0);
            x -= here / slope;
        }
        points[i] = 0.5 * (1.0 + x);
        weights[i] = 1.0 / ((1.0 - x * x) * slope * slope);
    }
    (points, weights)
}

#[cfg(test)]
mod tests {
    use super::Basis;

    #[test]
    fn rules_are_exact_to_twice_the_degree() {
        for m in 2..=7 {
            let basis = Basis::new(m);
            for power in 0..2 * m {
                let sum: f64 = (basis.points.iter().zip(&basis.weights))
                    .map(|(x, w)| w * x.powi(power as i32))
                    .sum();
                assert!((sum * (power as f64 + 1.0) - 1.0).abs() < 1e-13, "{m} {power}");
            }
        }
    }

    #[test]
    fn polynomials_of_the_degree_are_reproduced() {
        for m in 2..=7 {
            let basis = Basis::new(m);
            let node = |k: usize| (k as f64 / m as f64).powi(m as i32);
            for i in 0..m {
                let t = basis.points[i];
                let value: f64 = (0..=m).map(|k| basis.values[i * (m + 1) + k] * node(k)).sum();
                let slope: f64 = (0..=m).map(|k| basis.slopes[i * (m + 1) + k] * node(k)).sum();
                assert!((value - t.powi(m as i32)).abs() < 1e-13);
                assert!((slope - m as f64 * t.powi(m as i32 - 1)).abs() < 1e-12);
            }
            let top: f64 = (0..=m).map(|k| basis.top[k] * node(k)).sum();
            let factorial: f64 = (1..=m).map(|x| x as f64).product();
            assert!((top / factorial - 1.0).abs() < 1e-10);
        }
    }
}
