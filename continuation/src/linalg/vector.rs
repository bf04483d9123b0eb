//! A few loops over slices, and the one refinement rule all matrices share.

/// `xᵀ y`.
pub(super) fn dot(x: &[f64], y: &[f64]) -> f64 {
    debug_assert_eq!(x.len(), y.len());
    let mut lanes = [0.0; 4];
    let (xs, x_rest) = x.as_chunks::<4>();
    let (ys, y_rest) = y.as_chunks::<4>();
    for (a, b) in xs.iter().zip(ys) {
        for i in 0..4 {
            lanes[i] += a[i] * b[i];
        }
    }
    let rest: f64 = x_rest.iter().zip(y_rest).map(|(a, b)| a * b).sum();
    (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]) + rest
}

/// `Σ |x_i y_i|`, the scale of the rounding errors of [`dot`].
pub(super) fn dot_magnitude(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(a, b)| (a * b).abs()).sum()
}

/// `y += a x`.
pub(super) fn add_scaled(y: &mut [f64], a: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += a * x;
    }
}

/// Largest magnitude in `x`; 0 if empty.
pub(crate) fn max_abs(x: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let (chunks, rest) = x.as_chunks::<8>();
    for chunk in chunks {
        for i in 0..8 {
            let v = chunk[i].abs();
            lanes[i] = if v > lanes[i] { v } else { lanes[i] };
        }
    }
    let rest = rest.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    lanes.iter().fold(rest, |m, v| m.max(*v))
}

/// A residual below this multiple of its terms is rounding; refinement would add noise.
pub(super) const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A correction larger than this part of the solution is noise of a singular matrix: it is not
/// applied. So the sign of a solution that is dominated by the null vector stays that of the
/// factors, on which the signs of bordered determinants rest.
const LARGEST_CORRECTION: f64 = 0.1;

/// A pivot, or `±floor` in its place. Also returns whether it was replaced.
pub(super) fn pivot_or_floor(pivot: f64, floor: f64) -> (f64, bool) {
    if pivot.abs() >= floor {
        (pivot, false)
    } else if pivot < 0.0 {
        (-floor, true)
    } else {
        (floor, true)
    }
}

/// Sign of a factor of a determinant that is not zero.
pub(super) fn sign(x: f64) -> i8 {
    if x < 0.0 { -1 } else { 1 }
}

/// Solves in place by `substitute`, then refines once if the residual is above rounding and
/// refinement is `allowed`. `mul(x, y)` sets `y = A x` and returns the magnitude of its terms.
pub(super) fn solve_refined(
    x: &mut [f64],
    rhs: &mut [f64],
    residual: &mut [f64],
    allowed: bool,
    mut substitute: impl FnMut(&mut [f64]),
    mul: impl Fn(&[f64], &mut [f64]) -> f64,
) {
    rhs.copy_from_slice(x);
    substitute(x);
    if !allowed {
        return;
    }
    let scale = mul(x, residual) + max_abs(rhs);
    for (r, b) in residual.iter_mut().zip(rhs.iter()) {
        *r = b - *r;
    }
    if max_abs(residual) <= ROUNDING * scale {
        return;
    }
    substitute(residual);
    if max_abs(residual) <= LARGEST_CORRECTION * max_abs(x) {
        add_scaled(x, 1.0, residual);
    }
}
