//! A few equations: least squares, and all real roots of small polynomials.

/// Solves `A x ≈ b` in the sense of least squares, `A` by rows with at least as many rows as
/// columns, by Householder reflections. `None` where the columns are dependent.
pub(crate) fn least_squares(rows: &[Vec<f64>], b: &[f64]) -> Option<Vec<f64>> {
    let (m, n) = (rows.len(), rows.first()?.len());
    let mut a: Vec<Vec<f64>> = rows.to_vec();
    let mut b = b.to_vec();
    let size = a.iter().flatten().fold(0.0, |s: f64, v| s.max(v.abs()));
    for k in 0..n {
        let norm = (k..m).map(|i| a[i][k] * a[i][k]).sum::<f64>().sqrt();
        if norm.is_nan() || norm <= 1e-14 * size {
            return None;
        }
        let alpha = if a[k][k] > 0.0 { -norm } else { norm };
        let mut v: Vec<f64> = (k..m).map(|i| a[i][k]).collect();
        v[0] -= alpha;
        let vv: f64 = v.iter().map(|x| x * x).sum();
        if vv > 0.0 {
            for j in k..n {
                let along: f64 = v.iter().enumerate().map(|(i, v)| v * a[k + i][j]).sum();
                for (i, v) in v.iter().enumerate() {
                    a[k + i][j] -= 2.0 * along / vv * v;
                }
            }
            let along: f64 = v.iter().zip(&b[k..]).map(|(v, b)| v * b).sum();
            for (v, b) in v.iter().zip(&mut b[k..]) {
                *b -= 2.0 * along / vv * v;
            }
        }
    }
    let mut x = vec![0.0; n];
    for k in (0..n).rev() {
        let rest: f64 = (k + 1..n).map(|j| a[k][j] * x[j]).sum();
        x[k] = (b[k] - rest) / a[k][k];
    }
    x.iter().all(|v| v.is_finite()).then_some(x)
}

/// Orthonormalises vectors in the plain inner product; `None` where they are dependent.
pub(crate) fn orthonormalise(vectors: &mut [Vec<f64>]) -> Option<()> {
    for i in 0..vectors.len() {
        let (done, rest) = vectors.split_at_mut(i);
        let v = &mut rest[0];
        for d in done.iter() {
            let along = crate::step::dot(d, v);
            for (v, d) in v.iter_mut().zip(d) {
                *v -= along * d;
            }
        }
        let norm = crate::step::dot(v, v).sqrt();
        if !(norm.is_finite() && norm > 0.0) {
            return None;
        }
        v.iter_mut().for_each(|v| *v /= norm);
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_squares_of_a_line() {
        let rows: Vec<Vec<f64>> = (0..5).map(|i| vec![1.0, f64::from(i)]).collect();
        let b: Vec<f64> = (0..5).map(|i| 3.0 - 0.5 * f64::from(i)).collect();
        let x = least_squares(&rows, &b).unwrap();
        assert!((x[0] - 3.0).abs() < 1e-14 && (x[1] + 0.5).abs() < 1e-14);
        assert_eq!(least_squares(&[vec![1.0, 1.0], vec![2.0, 2.0]], &[1.0, 2.0]), None);
    }
}
