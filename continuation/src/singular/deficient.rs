//! Is `[F_u F_p]` short of rank at one point, or at every solution near it?
//!
//! At a branch point it is short of rank at that point alone. Where a quantity is conserved, a
//! symmetry moves every solution, or an equation follows from the others, it is so everywhere, and the
//! solutions are no branch but a surface. The two are told apart a little way off, on the solutions of
//! the equations that are left when those along the left kernel are dropped (Lyapunov and Schmidt):
//! along a surface all of these have the same kernel, beside a branch point they have not.

use super::kernel::{Frame, arbitrary};
use super::max_abs;
use super::probe::{Extended, Probe};
use crate::linalg::Matrix;
use crate::problem::EvalError;
use crate::step::{Weights, dot};
use faer::Mat;

/// Largest rank defect that is looked for.
const MOST: usize = 6;
/// What rounding leaves of a kernel vector's image under `[F_u F_p]`, relative to the terms of its rows.
const SMALL: f64 = 64.0 * f64::EPSILON;
/// What differences leave of it, in units of the error that they say they have.
const MISSED: f64 = 4.0;
/// Growth of a solution, relative to its right-hand side row by row, above which the bordered matrix
/// is singular.
const GROWTH: f64 = 1e10;
/// A row smaller than this part of the largest counts as that: it may be zero.
const ROW: f64 = 1e-4;
/// Number of unknowns up to which ranks are those of a dense copy.
const DENSE: usize = 60;
/// Renewals of the borders at the first point.
const RENEWALS: usize = 4;
/// How far off is looked, in the scaled metric, and how often the distance is halved where there is
/// no value.
const AWAY: [f64; 3] = [0.03, 0.1, -0.05];
const HALVINGS: usize = 6;
/// Corrections onto the equations that are left.
const CORRECTIONS: usize = 6;

/// The rank defect that `[F_u F_p]` has at `z` and at every solution near by, if it has one. No state
/// outside `domain` is asked for.
pub(crate) fn deficient_everywhere(
    probe: &mut Probe<'_>,
    z: &Extended,
    domain: Option<(f64, f64)>,
) -> Option<usize> {
    if probe.dim() <= DENSE {
        return of_small(probe, z, domain);
    }
    for k in 1..=MOST.min(probe.dim()) {
        let mut frame = Frame::new(probe.dim(), k);
        let regular = begin(probe, &mut frame, z, k).ok()?;
        let Some(regular) = regular else { continue };
        if !vanishes(probe, &mut frame, z, k) {
            return None;
        }
        if !regular {
            continue;
        }
        // the start need not be a solution
        let mut at = z.clone();
        if !onto(probe, &mut frame, &mut at, z, f64::INFINITY, k, domain)? {
            return None;
        }
        return near_by(probe, &mut frame, &at, k, domain).then_some(k);
    }
    None
}

/// Prepares the borders at `z`; whether the bordered matrix is regular, `None` if it is so singular
/// that nothing can be said.
fn begin(
    probe: &mut Probe<'_>,
    frame: &mut Frame,
    z: &Extended,
    k: usize,
) -> Result<Option<bool>, EvalError> {
    let n = probe.dim();
    probe.assemble(z)?;
    for i in 0..=k {
        let d = direction(probe, i + 1);
        let row = probe.covector(&d);
        frame.set_row(i, &row);
        if i < k {
            let column: Vec<f64> = (0..n).map(|m| arbitrary(i + k + 2, m)).collect();
            frame.set_column(i, &column);
        }
    }
    frame.factor(probe);
    for _ in 0..RENEWALS {
        if frame.renew(probe).is_none() {
            return Ok(None);
        }
    }
    let rows = row_sizes(probe);
    // a row that is zero is one that is short
    let least = ROW * max_abs(&rows);
    let r: Vec<f64> =
        rows.iter().enumerate().map(|(i, s)| s.max(least) * arbitrary(3 * k + 7, i)).collect();
    let (x, _) = frame.solve(probe, &r);
    let size = probe.norm(&x);
    Ok(Some(size <= GROWTH))
}

/// A direction without any pattern, of about unit length in the scaled metric.
fn direction(probe: &mut Probe<'_>, seed: usize) -> Extended {
    let n = probe.dim();
    let mut d = Extended { u: (0..n).map(|m| arbitrary(seed, m)).collect(), p: 0.0 };
    let norm = probe.norm(&d);
    if norm > 0.0 {
        d.scale(1.0 / norm);
    }
    d.p = arbitrary(seed, n) * probe.weights.parameter;
    d
}

/// `[F_u F_p] x` at the assembled point.
fn product(probe: &Probe<'_>, x: &Extended) -> Vec<f64> {
    let mut y = vec![0.0; x.u.len()];
    probe.jacobian.mul(&x.u, &mut y);
    for (y, f) in y.iter_mut().zip(&probe.by_parameter) {
        *y += x.p * f;
    }
    y
}

/// Size of the rows of `[F_u F_p]`, for unknowns and parameter in units of their scales.
fn row_sizes(probe: &mut Probe<'_>) -> Vec<f64> {
    let mut sizes = vec![0.0_f64; probe.dim()];
    for seed in 11..14 {
        let d = direction(probe, seed);
        for (s, y) in sizes.iter_mut().zip(product(probe, &d)) {
            *s = s.max(y.abs());
        }
    }
    sizes
}

/// Whether what the borders hold is the kernel to rounding.
fn vanishes(probe: &mut Probe<'_>, frame: &mut Frame, at: &Extended, k: usize) -> bool {
    let rows = row_sizes(probe);
    let left: Vec<Vec<f64>> = (0..k).map(|j| frame.left(probe, j)).collect();
    (0..=k).all(|i| {
        let (mut v, _) = frame.right(probe, i);
        let norm = probe.norm(&v);
        v.scale(1.0 / norm);
        let y = product(probe, &v);
        let Ok(missed) = probe.derivative_error(at, &v) else { return false };
        let rest = rows.iter().zip(&missed).map(|(size, error)| SMALL * size + MISSED * error);
        let rest: Vec<f64> = rest.collect();
        left.iter().all(|w| {
            let terms: f64 = w.iter().zip(&rest).map(|(w, s)| (w * s).abs()).sum();
            dot(w, &y).abs() <= terms
        })
    })
}

/// Whether the kernel is as large at solutions near `z`, on all sides.
fn near_by(
    probe: &mut Probe<'_>,
    frame: &mut Frame,
    z: &Extended,
    k: usize,
    domain: Option<(f64, f64)>,
) -> bool {
    let kernel: Vec<Extended> = (0..=k).map(|i| frame.right(probe, i).0).collect();
    let mut found = 0;
    for (trial, away) in AWAY.into_iter().enumerate() {
        let mut step = Extended::zero(probe.dim());
        for (i, v) in kernel.iter().enumerate() {
            step.add(arbitrary(trial + 21, i), v);
        }
        let norm = probe.norm(&step);
        step.scale(away / norm);
        for _ in 0..HALVINGS {
            let mut at = z.clone();
            at.add(1.0, &step);
            let far = 3.0 * probe.norm(&step);
            match onto(probe, &mut frame.clone(), &mut at, z, far, k, domain) {
                Some(true) => {
                    found += 1;
                    break;
                }
                Some(false) => return false,
                None => step.scale(-0.5),
            }
        }
    }
    // one place may be special for another reason
    found > 1
}

/// Whether the kernel is as large at the solution near `at` of the equations that are left; `None`
/// where there is none.
fn onto(
    probe: &mut Probe<'_>,
    frame: &mut Frame,
    at: &mut Extended,
    z: &Extended,
    far: f64,
    k: usize,
    domain: Option<(f64, f64)>,
) -> Option<bool> {
    let inside = |p: f64| domain.is_none_or(|(lo, hi)| (lo..=hi).contains(&p));
    for _ in 0..CORRECTIONS {
        if !inside(at.p) {
            return None;
        }
        probe.assemble(at).ok()?;
        frame.factor(probe);
        let r: Vec<f64> = probe.residual.iter().map(|r| -r).collect();
        if max_abs(&r) == 0.0 {
            break;
        }
        let (step, _) = frame.solve(probe, &r);
        at.add(1.0, &step);
        let mut off = at.clone();
        off.add(-1.0, z);
        let distance = probe.norm(&off);
        if distance.is_nan() || distance > far {
            return None;
        }
    }
    if !inside(at.p) {
        return None;
    }
    probe.assemble(at).ok()?;
    frame.factor(probe);
    for _ in 0..2 {
        frame.renew(probe)?;
    }
    Some(vanishes(probe, frame, at, k))
}

/// `[F_u F_p]` with rows and columns of one size, as singular values and vectors.
struct Ranked {
    left: Mat<f64>,
    values: Vec<f64>,
    right: Mat<f64>,
    rows: Vec<f64>,
    columns: Vec<f64>,
    /// How many singular values are rounding.
    deficiency: usize,
}

impl Ranked {
    /// At the assembled point `at`.
    fn of(probe: &mut Probe<'_>, at: &Extended) -> Option<Self> {
        let n = probe.dim();
        let Weights { unknowns, parameter } = probe.weights;
        let mut columns: Vec<f64> = vec![unknowns; n];
        columns.push(parameter);
        let mut x = Mat::<f64>::zeros(n, n + 1);
        let (mut unit, mut y) = (vec![0.0; n], vec![0.0; n]);
        for j in 0..=n {
            if j < n {
                unit[j] = 1.0;
                probe.jacobian.mul(&unit, &mut y);
                unit[j] = 0.0;
            } else {
                y.copy_from_slice(&probe.by_parameter);
            }
            y.iter().enumerate().for_each(|(i, y)| x[(i, j)] = y * columns[j]);
        }
        let size = |largest: f64| if largest > 0.0 { largest.recip() } else { 1.0 };
        let row = |i: usize| size((0..=n).fold(0.0, |m: f64, j| m.max(x[(i, j)].abs())));
        let rows: Vec<f64> = (0..n).map(row).collect();
        let mut x = Mat::from_fn(n, n + 1, |i, j| x[(i, j)] * rows[i]);
        for (j, column) in columns.iter_mut().enumerate() {
            let factor = size((0..n).fold(0.0, |m: f64, i| m.max(x[(i, j)].abs())));
            (0..n).for_each(|i| x[(i, j)] *= factor);
            *column *= factor;
        }
        let svd = x.svd().ok()?;
        let s = svd.S().column_vector();
        let values = (0..n).map(|i| s[i]).collect();
        let (left, right) = (svd.U().to_owned(), svd.V().to_owned());
        let mut ranked = Ranked { left, values, right, rows, columns, deficiency: 0 };
        for j in (0..n).rev() {
            let missed = probe.derivative_error(at, &ranked.vector(j)).ok()?;
            let terms = (0..n).map(|i| (ranked.left[(i, j)] * ranked.rows[i] * missed[i]).abs());
            let missed: f64 = terms.sum();
            if ranked.values[j] > SMALL * n as f64 * ranked.values[0] + MISSED * missed {
                break;
            }
            ranked.deficiency += 1;
        }
        Some(ranked)
    }

    /// Right singular vector `j`.
    fn vector(&self, j: usize) -> Extended {
        let mut v: Vec<f64> =
            self.columns.iter().enumerate().map(|(i, c)| c * self.right[(i, j)]).collect();
        let p = v.pop().unwrap_or(0.0);
        Extended { u: v, p }
    }

    /// The shortest solution of `[F_u F_p] x = −r`, its `k` smallest singular values left out.
    fn correction(&self, r: &[f64], k: usize) -> Extended {
        let n = r.len();
        let mut x = Extended::zero(n);
        for j in 0..n - k.min(n) {
            let part: f64 = (0..n).map(|i| self.left[(i, j)] * self.rows[i] * r[i]).sum();
            x.add(-part / self.values[j], &self.vector(j));
        }
        x
    }
}

/// [`deficient_everywhere`] by singular values.
fn of_small(probe: &mut Probe<'_>, z: &Extended, domain: Option<(f64, f64)>) -> Option<usize> {
    probe.assemble(z).ok()?;
    let k = Ranked::of(probe, z)?.deficiency;
    if k == 0 {
        return None;
    }
    // the start need not be a solution
    let (at, ranked) = solve_small(probe, z.clone(), f64::INFINITY, k, domain)?;
    if ranked.deficiency < k {
        return None;
    }
    let n = probe.dim();
    let kernel: Vec<Extended> = (n - k..=n).map(|j| ranked.vector(j)).collect();
    let mut found = 0;
    for (trial, away) in AWAY.into_iter().enumerate() {
        let mut step = Extended::zero(n);
        kernel.iter().enumerate().for_each(|(i, v)| step.add(arbitrary(trial + 21, i), v));
        let norm = probe.norm(&step);
        step.scale(away / norm);
        for _ in 0..HALVINGS {
            let mut beside = at.clone();
            beside.add(1.0, &step);
            let far = 3.0 * probe.norm(&step);
            match solve_small(probe, beside, far, k, domain) {
                Some((_, ranked)) if ranked.deficiency < k => return None,
                Some(_) => {
                    found += 1;
                    break;
                }
                None => step.scale(-0.5),
            }
        }
    }
    (found > 1).then_some(k)
}

/// The solution, no farther than `far`, of the equations that are left.
fn solve_small(
    probe: &mut Probe<'_>,
    mut at: Extended,
    far: f64,
    k: usize,
    domain: Option<(f64, f64)>,
) -> Option<(Extended, Ranked)> {
    let inside = |p: f64| domain.is_none_or(|(lo, hi)| (lo..=hi).contains(&p));
    let begun = at.clone();
    for correction in 0..=CORRECTIONS {
        if !inside(at.p) {
            return None;
        }
        probe.assemble(&at).ok()?;
        let ranked = Ranked::of(probe, &at)?;
        if correction == CORRECTIONS || max_abs(&probe.residual) == 0.0 {
            return Some((at, ranked));
        }
        at.add(1.0, &ranked.correction(&probe.residual, k));
        let mut off = at.clone();
        off.add(-1.0, &begun);
        let distance = probe.norm(&off);
        if distance.is_nan() || distance > far {
            return None;
        }
    }
    None
}
