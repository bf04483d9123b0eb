//! Full spectra, and how far rounding may have moved each eigenvalue.
//!
//! The QR iteration returns the eigenvalues of a matrix within `ε |A|` of the given one. That moves
//! a simple eigenvalue by `ε |A| κ`, `κ = |x| |y| / |yᴴx|` with its right and left vector, to first
//! order. Advection and chemistry make `κ` as large as 1e20: whole spectra are then rounding, and
//! their sign says nothing. Balancing takes away what a diagonal similarity
//! explains, without any rounding; what remains is said.

use faer::linalg::solvers::{DenseSolveCore, Eigen, FullPivLu, Solve};
use faer::{Mat, Side, c64};

/// Rounding errors of the QR iteration, in units of `ε |A|` by the Frobenius norm.
const BACKWARD: f64 = 8.0;
/// Weight that holds the scale of an unknown where nothing else does.
const HELD: f64 = 1e-9;

/// Eigenvalues with bounds of their errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Real and imaginary parts.
    pub values: Vec<(f64, f64)>,
    /// What rounding may have moved each by, to first order; infinite where that is not known.
    pub errors: Vec<f64>,
    /// Whether it is certain which eigenvalues of a singular pencil are infinite.
    pub complete: bool,
}

impl Spectrum {
    /// Of values of which nothing more is known.
    pub(super) fn unknown(values: Vec<(f64, f64)>) -> Self {
        Spectrum { errors: vec![f64::INFINITY; values.len()], values, complete: false }
    }

    /// Of values that have the same error.
    pub(super) fn uniform(values: Vec<(f64, f64)>, error: f64) -> Self {
        Spectrum { errors: vec![error; values.len()], values, complete: true }
    }

    /// Whether it is certain which real parts are positive: no error reaches over the imaginary axis,
    /// but those below `zero`, the size of a real part that counts as zero.
    pub(crate) fn has_certain_signs(&self, zero: f64) -> bool {
        let signed = |((re, _), error): (&(f64, f64), &f64)| re.abs() > *error || *error <= zero;
        self.complete && self.values.iter().zip(&self.errors).all(signed)
    }
}

/// `D⁻¹ A D` with `|a_ij|` and `|a_ji|` as nearly the same as can be, `D` of powers of two: the
/// logarithms of `D` fit those of all quotients in the least squares sense, which makes a tridiagonal
/// matrix as good as symmetric in one step.
pub(super) fn balance(a: &mut Mat<f64>) {
    let n = a.nrows();
    let mut normal = Mat::<f64>::zeros(n, n);
    let mut rhs = Mat::<f64>::zeros(n, 1);
    for i in 0..n {
        // what hangs together with nothing stays as it is
        normal[(i, i)] += HELD;
        for j in 0..i {
            let (below, above) = (a[(i, j)].abs(), a[(j, i)].abs());
            let quotient = 0.5 * (below.log2() - above.log2());
            if quotient.is_finite() {
                normal[(i, i)] += 1.0;
                normal[(j, j)] += 1.0;
                normal[(i, j)] -= 1.0;
                normal[(j, i)] -= 1.0;
                rhs[(i, 0)] += quotient;
                rhs[(j, 0)] -= quotient;
            }
        }
    }
    let Ok(llt) = normal.llt(Side::Lower) else { return };
    let exponents = llt.solve(&rhs);
    let whole = |i: usize| exponents[(i, 0)].round_ties_even();
    let balanced = Mat::from_fn(n, n, |i, j| a[(i, j)] * (whole(j) - whole(i)).exp2());
    let norm = balanced.norm_l2();
    if norm.is_finite() && norm < a.norm_l2() {
        *a = balanced;
    }
}

/// The eigenvalues of `a` with their errors.
pub(super) fn with_errors(mut a: Mat<f64>) -> Option<Spectrum> {
    balance(&mut a);
    as_it_is(&a)
}

/// The same without balancing.
pub(super) fn as_it_is(a: &Mat<f64>) -> Option<Spectrum> {
    let n = a.nrows();
    let eigen = Eigen::new_from_real(a.as_ref()).ok()?;
    let values: Vec<(f64, f64)> = (0..n).map(|i| eigen.S()[i]).map(|z| (z.re, z.im)).collect();
    let errors = conditions(eigen.U().to_owned());
    let rounding = BACKWARD * f64::EPSILON * a.norm_l2();
    let errors = errors.into_iter().map(|condition| rounding * condition).collect();
    Some(Spectrum { values, errors, complete: true })
}

/// `|x| |y| / |yᴴx|` of every eigenvalue, its right vectors the columns of `right`: infinite where they
/// do not span the space.
fn conditions(right: Mat<c64>) -> Vec<f64> {
    let n = right.nrows();
    let left = FullPivLu::new(right.as_ref()).inverse();
    let length = |x: c64| x.re * x.re + x.im * x.im;
    (0..n)
        .map(|i| {
            let x: f64 = (0..n).map(|k| length(right[(k, i)])).sum();
            let y: f64 = (0..n).map(|k| length(left[(i, k)])).sum();
            let condition = (x * y).sqrt();
            if condition.is_finite() { condition } else { f64::INFINITY }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eigenvalues `d + 2 √(l r) cos(kπ/(n + 1))`, of any condition.
    fn toeplitz(n: usize, d: f64, l: f64, r: f64) -> (Mat<f64>, Vec<f64>) {
        let entry = |i: usize, j: usize| match i as isize - j as isize {
            0 => d,
            1 => l,
            -1 => r,
            _ => 0.0,
        };
        let angle = |k: usize| k as f64 * std::f64::consts::PI / (n as f64 + 1.0);
        let exact = (1..=n).map(|k| d + 2.0 * (l * r).sqrt() * angle(k).cos()).collect();
        (Mat::from_fn(n, n, entry), exact)
    }

    #[test]
    fn balancing_finds_the_similarity_that_is_there() {
        let (a, mut exact) = toeplitz(100, -2.5, 40.0, 0.025);
        let found = with_errors(a).unwrap();
        let mut values: Vec<f64> = found.values.iter().map(|z| z.0).collect();
        values.sort_by(f64::total_cmp);
        exact.sort_by(f64::total_cmp);
        for (v, e) in values.iter().zip(&exact) {
            assert!((v - e).abs() < 1e-10, "{v} {e}");
        }
        assert!(found.has_certain_signs(0.0), "{:?}", found.errors);
        let widest = found.errors.iter().fold(0.0, |m: f64, e| m.max(*e));
        assert!(widest < 1e-12, "{widest}");
    }

    #[test]
    fn a_spectrum_that_is_rounding_is_not_certain() {
        // the same, its similarity hidden by a reflection: eigenvalues from -4.5 to -0.5
        let (n, (a, exact)) = (60, toeplitz(60, -2.5, 40.0, 0.025));
        let v: Vec<f64> = (0..n).map(|i| 1.0 + (i as f64).sin()).collect();
        let vv: f64 = v.iter().map(|x| x * x).sum();
        let h = Mat::from_fn(n, n, |i, j| f64::from(u8::from(i == j)) - 2.0 * v[i] * v[j] / vv);
        let found = with_errors(&h * &a * &h).unwrap();
        let wrong = found.values.iter().any(|z| z.0 > 0.0);
        assert!(exact.iter().all(|e| *e < 0.0) && wrong);
        assert!(!found.has_certain_signs(1e-12));
    }
}
