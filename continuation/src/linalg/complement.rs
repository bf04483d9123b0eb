//! Sign of the determinant of a small matrix whose entries are known to errors.

/// Storage for a matrix of dimension `m` and for the errors of its entries, both by columns.
#[derive(Debug, Clone)]
pub(super) struct Complement {
    m: usize,
    values: Vec<f64>,
    errors: Vec<f64>,
}

impl Complement {
    pub(super) fn new(m: usize) -> Self {
        Self { m, values: vec![0.0; m * m], errors: vec![0.0; m * m] }
    }

    pub(super) fn set(&mut self, i: usize, k: usize, value: f64, error: f64) {
        self.values[i + k * self.m] = value;
        self.errors[i + k * self.m] = error;
    }

    /// Sign of the determinant by elimination with complete pivoting; `None` where the errors allow
    /// either, or the matrix is singular. The entries are lost.
    pub(super) fn det_sign(&mut self) -> Option<i8> {
        let m = self.m;
        let mut sign = 1;
        for step in 0..m {
            // the entry that is known best
            let (mut best, mut at) = (0.0, (step, step));
            for k in step..m {
                for i in step..m {
                    let (value, error) = (self.values[i + k * m].abs(), self.errors[i + k * m]);
                    // what is not a number is not known
                    let known = if error == 0.0 { f64::INFINITY } else { value / error };
                    if value > 0.0 && known > best {
                        (best, at) = (known, (i, k));
                    }
                }
            }
            if best <= 2.0 {
                return None;
            }
            for (from, rows) in [(at.0, true), (at.1, false)] {
                if from == step {
                    continue;
                }
                sign = -sign;
                for other in 0..m {
                    let place =
                        |line: usize| if rows { line + other * m } else { other + line * m };
                    self.values.swap(place(from), place(step));
                    self.errors.swap(place(from), place(step));
                }
            }
            let (pivot, doubt) = (self.values[step + step * m], self.errors[step + step * m]);
            sign = if pivot < 0.0 { -sign } else { sign };
            // no smaller than this
            let least = pivot.abs() - doubt;
            for k in step + 1..m {
                let (above, above_error) = (self.values[step + k * m], self.errors[step + k * m]);
                for i in step + 1..m {
                    let (left, left_error) = (self.values[i + step * m], self.errors[i + step * m]);
                    let product = left * above / pivot;
                    let error = left_error * (above.abs() + above_error)
                        + left.abs() * above_error
                        + product.abs() * doubt;
                    self.values[i + k * m] -= product;
                    self.errors[i + k * m] += error / least + 4.0 * f64::EPSILON * product.abs();
                }
            }
        }
        Some(sign)
    }
}

#[cfg(test)]
mod tests {
    use super::Complement;

    fn sign(rows: &[&[f64]], error: f64) -> Option<i8> {
        let mut small = Complement::new(rows.len());
        for (i, row) in rows.iter().enumerate() {
            row.iter().enumerate().for_each(|(k, value)| small.set(i, k, *value, error));
        }
        small.det_sign()
    }

    #[test]
    fn signs_that_the_errors_allow() {
        assert_eq!(sign(&[&[0.0, 2.0], &[3.0, 0.0]], 1e-3), Some(-1));
        assert_eq!(sign(&[&[0.0, 2.0, 0.0], &[0.0, 0.0, 3.0], &[1.0, 0.0, 0.0]], 1e-3), Some(1));
        assert_eq!(sign(&[&[1.0, 1.0], &[1.0, 1.001]], 1e-5), Some(1));
        assert_eq!(sign(&[&[1.0, 1.0], &[1.0, 1.001]], 1e-3), None);
        assert_eq!(sign(&[&[1.0, 1.0], &[1.0, 1.0]], 0.0), None);
        assert_eq!(sign(&[&[1e-8, 1.0], &[-1.0, 0.0]], 1e-6), Some(1));
        assert_eq!(sign(&[], 0.0), Some(1));
    }
}
