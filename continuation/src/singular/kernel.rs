//! Points where `[F_u F_p]` loses rank, by an augmented Newton method.
//!
//! With `k` the rank defect, the matrix is bordered to a regular one,
//! ```text
//!     | F_u  F_p  B |
//! K = | C_u  C_p  0 |,   K⁻¹ = | V  · |,   V: right vectors, W: left vectors, G: k × (k + 1),
//!                              | G  W |
//! ```
//! and `G = 0` exactly where the rank is short by `k`: `V` then spans the kernel, `W` the left
//! kernel (Govaerts, *Numerical Methods for Bifurcations of Dynamical Equilibria*, SIAM, 2000,
//! ch. 5, the minimally augmented systems). Along the kernel coordinates `y` the state moves by
//! `V y` and `dG_ji/dy_l = -w_jᵀ F_zz[v_i, v_l]`, so that Newton's method (Gauss-Newton for
//! `k > 1`, where symmetry makes the equations consistent) needs differences of the Jacobian in
//! `k + 1` directions and no further factorisation; from one side for `k = 1`, until Broyden's update
//! does as well. The residual is solved as `F + B β = 0`: `β`
//! vanishes at a true branch point, and measures by how much an imperfect one is unfolded.

use super::probe::{Extended, Probe};
use super::small::least_squares;
use crate::linalg::{Bordered, Dense, Matrix};
use crate::problem::EvalError;

const MAX_ITERATIONS: usize = 14;
/// Corrections below this, in natural amplitudes, have converged.
const CONVERGED: f64 = 1e-12;
/// Corrections that no longer shrink are rounding if they are below this.
const ROUNDING: f64 = 1e-8;

/// Relative rounding of the entries of a Jacobian, each a sum of a few terms, in the stored matrix
/// whose singular point is found in place of the exact one.
const ENTRIES: f64 = 2.0 * f64::EPSILON;

/// Corrections below this, in natural amplitudes, and this part of the one before, need no differences
/// any more: what is left of the defect after each corrects the quadratic form.
const SETTLED: f64 = 2e-2;
const FAST: f64 = 0.1;
/// What corrections that never shrank fast may have left to go, in terms of the last one.
const SLOW: f64 = 16.0;

/// Natural amplitudes that differ by less are one.
const ALIKE: f64 = 10.0;

/// Corrections longer than this, in natural amplitudes, lead astray.
const LONGEST: f64 = 10.0;
/// Least part of a correction that is taken where the whole has no value.
const LEAST_PART: f64 = 0.03;
/// Points nearer to each other than this, in natural amplitudes, are one with a larger kernel.
const COINCIDENT: f64 = 1e-8;

/// Why no singular point was found.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Failure {
    /// The problem has no value on the way.
    Evaluation(EvalError),
    /// The iteration leaves the neighbourhood of its start or does not converge.
    NoConvergence,
    /// The kernel is smaller than was asked for: these are estimates of the points, near to each
    /// other, where it has one dimension.
    Apart(Vec<Extended>),
    /// There is none: beside the step two branches come this close to each other, in the problem's
    /// metric.
    Close(f64),
}

impl From<EvalError> for Failure {
    fn from(error: EvalError) -> Self {
        Failure::Evaluation(error)
    }
}

/// A point where the rank of `[F_u F_p]` is short by `k`.
#[derive(Debug, Clone)]
pub(crate) struct Singular {
    pub(crate) z: Extended,
    /// `k + 1` vectors that span the kernel, orthonormal in the scaled metric; the first one is
    /// the nearest to the direction that was given.
    pub(crate) right: Vec<Extended>,
    /// `k` vectors that span the left kernel.
    pub(crate) left: Vec<Vec<f64>>,
    /// `form[j][i][l] = w_jᵀ F_zz[v_i, v_l]`.
    pub(crate) form: Vec<Vec<Vec<f64>>>,
    /// Natural amplitude of each right vector; 1 for the first.
    pub(crate) amplitude: Vec<f64>,
    /// The last correction, in natural amplitudes.
    pub(crate) correction: f64,
    /// By how much the rounding of the Jacobian's entries may move the point, in natural
    /// amplitudes: that of a differential operator on a fine mesh outweighs everything else.
    pub(crate) resolution: f64,
    /// Length of the residual that remains: by how much an imperfect branch point is unfolded.
    pub(crate) unfolding: f64,
    /// Size of the gap, in natural amplitudes, that this makes between the branches.
    pub(crate) gap: f64,
    /// The bordered system at the point, for further solves.
    pub(crate) frame: Frame,
}

/// The borders, and the solver that holds them.
#[derive(Debug, Clone)]
pub(crate) struct Frame {
    k: usize,
    bordered: Bordered,
    rhs: Vec<f64>,
    tail: Vec<f64>,
}

impl Frame {
    pub(super) fn new(n: usize, k: usize) -> Self {
        Frame { k, bordered: Bordered::new(n, k + 1), rhs: vec![0.0; n], tail: vec![0.0; k + 1] }
    }

    pub(super) fn set_row(&mut self, i: usize, c: &Extended) {
        self.bordered.row_mut(i).copy_from_slice(&c.u);
        self.bordered.set_corner(i, 0, c.p);
    }

    pub(super) fn set_column(&mut self, j: usize, b: &[f64]) {
        self.bordered.column_mut(j + 1).copy_from_slice(b);
    }

    pub(super) fn factor(&mut self, probe: &mut Probe<'_>) {
        self.bordered.column_mut(0).copy_from_slice(&probe.by_parameter);
        self.bordered.factor(&mut probe.jacobian);
    }

    /// Column `i` of `V`, and of `G`.
    pub(super) fn right(&mut self, probe: &mut Probe<'_>, i: usize) -> (Extended, Vec<f64>) {
        self.rhs.fill(0.0);
        self.tail.fill(0.0);
        self.tail[i] = 1.0;
        self.bordered.solve(&mut probe.jacobian, &mut self.rhs, &mut self.tail);
        (Extended { u: self.rhs.clone(), p: self.tail[0] }, self.tail[1..].to_vec())
    }

    /// Row `j` of `W`.
    pub(super) fn left(&mut self, probe: &mut Probe<'_>, j: usize) -> Vec<f64> {
        self.rhs.fill(0.0);
        self.tail.fill(0.0);
        self.tail[j + 1] = 1.0;
        self.bordered.solve_transpose(&mut probe.jacobian, &mut self.rhs, &mut self.tail);
        self.rhs.clone()
    }

    /// Solves `K [x; β] = [r; 0]`.
    pub(crate) fn solve(&mut self, probe: &mut Probe<'_>, r: &[f64]) -> (Extended, Vec<f64>) {
        self.rhs.copy_from_slice(r);
        self.tail.fill(0.0);
        self.bordered.solve(&mut probe.jacobian, &mut self.rhs, &mut self.tail);
        (Extended { u: self.rhs.clone(), p: self.tail[0] }, self.tail[1..].to_vec())
    }

    /// Borders by what the latest factors say is nearly in the kernels: the right vectors,
    /// orthonormalised, and the left ones, normalised.
    pub(super) fn renew(&mut self, probe: &mut Probe<'_>) -> Option<()> {
        let mut right: Vec<Extended> = Vec::with_capacity(self.k + 1);
        for i in 0..=self.k {
            let (mut v, _) = self.right(probe, i);
            for done in &right {
                let along = probe.covector(done).dot(&v);
                v.add(-along, done);
            }
            let norm = probe.norm(&v);
            if !(norm.is_finite() && norm > 0.0) {
                return None;
            }
            v.scale(1.0 / norm);
            right.push(v);
        }
        let mut left: Vec<Vec<f64>> = (0..self.k).map(|j| self.left(probe, j)).collect();
        super::small::orthonormalise(&mut left)?;
        for (i, v) in right.iter().enumerate() {
            let c = probe.covector(v);
            self.set_row(i, &c);
        }
        for (j, w) in left.iter().enumerate() {
            self.set_column(j, w);
        }
        self.factor(probe);
        Some(())
    }

    /// Turns the right vectors within their span so that the first is the nearest to `direction`:
    /// where they mix the branch with what leaves it, the form's entries must cancel to tell the two
    /// apart, and differences along a mixture are no better than its natural amplitude allows.
    fn turn(&mut self, probe: &mut Probe<'_>, direction: &Extended) -> Option<()> {
        let along = probe.covector(direction);
        let right: Vec<Extended> = (0..=self.k).map(|i| self.right(probe, i).0).collect();
        let mut first = Extended::zero(direction.u.len());
        for v in &right {
            first.add(along.dot(v), v);
        }
        let mut turned = Vec::with_capacity(self.k + 1);
        let mut left = right;
        let mut next = first;
        loop {
            let norm = probe.norm(&next);
            if !(norm.is_finite() && norm > 0.0) {
                return None;
            }
            next.scale(1.0 / norm);
            let done = probe.covector(&next);
            for v in &mut left {
                let along = done.dot(v);
                v.add(-along, &next);
            }
            turned.push(done);
            if turned.len() > self.k {
                break;
            }
            // of those that remain the longest: one of them was used up
            let norms: Vec<f64> = left.iter().map(|v| probe.norm(v)).collect();
            let longest = (0..left.len()).max_by(|&a, &b| norms[a].total_cmp(&norms[b]))?;
            next = left.swap_remove(longest);
        }
        for (i, c) in turned.iter().enumerate() {
            self.set_row(i, c);
        }
        self.factor(probe);
        Some(())
    }
}

/// Numbers without any pattern, in (-1, 1), always the same.
pub(crate) fn arbitrary(seed: usize, i: usize) -> f64 {
    let x =
        ((i + 1) as f64 * 0.754_877_666_246_692_7 + seed as f64 * 0.569_840_290_998_053_2).fract();
    2.0 * (x * 1e4).fract() - 1.0
}

/// Finds the point near `seed` where the rank is short by `k`; `tangent` is a direction of the
/// branch that is followed. `is_useless` says of a state, and of the radius about it in which the
/// point will lie, whether it is none that is sought.
pub(crate) fn find(
    probe: &mut Probe<'_>,
    seed: &Extended,
    tangent: &Extended,
    k: usize,
    is_useless: impl Fn(&mut Probe<'_>, &Extended, f64) -> bool,
) -> Result<Singular, Failure> {
    let n = probe.dim();
    let mut z = seed.clone();
    probe.assemble(&z)?;
    let mut frame = Frame::new(n, k);
    let row = probe.covector(tangent);
    frame.set_row(0, &row);
    for i in 1..=k {
        let u = (0..n).map(|m| arbitrary(i, m)).collect();
        let row = probe.covector(&Extended { u, p: 0.0 });
        frame.set_row(i, &row);
        let column: Vec<f64> = (0..n).map(|m| arbitrary(i + k, m)).collect();
        frame.set_column(i - 1, &column);
    }
    frame.factor(probe);
    for _ in 0..2 {
        frame.renew(probe).ok_or(Failure::NoConvergence)?;
    }
    let mut amplitude = Vec::new();
    // of larger kernels the vectors may turn within their span
    let steering = if k == 1 { Known::Roughly } else { Known::Nothing };
    let mut known = steering.clone();
    let mut moved: Option<Vec<f64>> = None;
    let mut pace = Pace::default();
    for iteration in 0..MAX_ITERATIONS {
        let exact = matches!(known, Known::Nothing);
        let mut local = Local::of(probe, &mut frame, &z, &mut amplitude, tangent, known)?;
        if let Some(y) = &moved {
            local.learn(y, &amplitude);
        }
        let residual: Vec<f64> = probe.residual.iter().map(|r| -r).collect();
        let (mut step, beta) = frame.solve(probe, &residual);
        let y = least_squares(&local.matrix(), &local.defect()).ok_or(Failure::NoConvergence)?;
        let widest = amplitude.iter().fold(1.0, |m: f64, x| m.max(*x));
        let mut correction = probe.norm(&step) / widest;
        for ((y, v), x) in y.iter().zip(&local.right).zip(&amplitude) {
            step.add(*y, v);
            correction = correction.max(y.abs() / x);
        }
        let resolution = local.resolution(&amplitude);
        let grows = iteration > 3 && correction > 10.0 * pace.last.max(CONVERGED).max(resolution);
        if correction.is_nan() || correction > LONGEST || grows {
            return Err(Failure::NoConvergence);
        }
        let size = 1.0 + probe.norm(&z) / widest;
        let converged = correction <= CONVERGED * size;
        let rounding = (ROUNDING * size).max(resolution);
        let (fast, slow) = pace.see(correction, rounding);
        // a form that is only about right makes corrections slow that are not rounding
        let stagnant = slow && (exact || correction <= resolution);
        z.add(1.0, &step);
        if converged && (iteration > 0 || correction == 0.0) || stagnant {
            let left = if pace.contracts || correction == 0.0 { 1.0 } else { SLOW };
            return finish(probe, frame, z, amplitude, tangent, left * correction, &beta);
        }
        if fast && iteration > 0 {
            let radius = probe.norm(&step);
            if is_useless(probe, &z, radius) {
                return Err(Failure::NoConvergence);
            }
        }
        let settled = k == 1 && (fast && correction <= SETTLED || correction <= ROUNDING);
        known = match steering {
            _ if slow => Known::Nothing,
            _ if settled => Known::Form(local.form),
            // the function varies on a scale that differences from one side do not meet
            Known::Roughly if iteration > 1 && !fast => Known::Nothing,
            _ => steering.clone(),
        };
        moved = (settled && !slow && correction > ROUNDING).then_some(y);
        // a state without a value is met by a shorter correction
        let mut part = 1.0;
        while let Err(error) = probe.assemble(&z) {
            part *= 0.5;
            if part < LEAST_PART {
                return Err(error.into());
            }
            z.add(-part, &step);
            moved = None;
        }
        frame.factor(probe);
        frame.renew(probe).ok_or(Failure::NoConvergence)?;
    }
    Err(Failure::NoConvergence)
}

/// How the corrections shrink.
struct Pace {
    last: f64,
    /// Whether they have shrunk fast, or are so small that they grow again. Towards a degenerate point they
    /// never do either.
    contracts: bool,
}

impl Default for Pace {
    fn default() -> Self {
        Pace { last: f64::INFINITY, contracts: false }
    }
}

impl Pace {
    /// Whether a correction is much shorter than the one before, and whether it is no longer much shorter
    /// where it may be `rounding`.
    fn see(&mut self, correction: f64, rounding: f64) -> (bool, bool) {
        let fast = correction <= FAST * self.last;
        let small = correction <= rounding;
        self.contracts |= self.last.is_finite() && (fast || small && correction >= self.last);
        let slow = self.contracts && small && correction > 0.25 * self.last;
        self.last = correction;
        (fast, slow)
    }
}

fn finish(
    probe: &mut Probe<'_>,
    mut frame: Frame,
    z: Extended,
    mut amplitude: Vec<f64>,
    tangent: &Extended,
    correction: f64,
    beta: &[f64],
) -> Result<Singular, Failure> {
    probe.assemble(&z)?;
    frame.factor(probe);
    frame.renew(probe).ok_or(Failure::NoConvergence)?;
    frame.turn(probe, tangent).ok_or(Failure::NoConvergence)?;
    // of one direction beside the branch it is known; of several the vectors have turned
    if frame.k > 1 {
        amplitude.clear();
    }
    let local = Local::of(probe, &mut frame, &z, &mut amplitude, tangent, Known::Nothing)?;
    // lengths, in natural amplitudes, over which the quadratic form makes the defect and the
    // unfolding
    let x = &amplitude;
    let (mut curved, mut defect) = (0.0_f64, 0.0_f64);
    for (f, g) in local.form.iter().zip(&local.g) {
        for i in 0..x.len() {
            defect = defect.max((g[i] * x[i]).abs());
            for l in 0..x.len() {
                curved = curved.max((f[i][l] * x[i] * x[l]).abs());
            }
        }
    }
    // nor is a defect within rounding one
    if curved > 0.0 && defect > (COINCIDENT * curved).max(2.0 * local.noise) {
        return Err(Failure::Apart(local.apart(&z)));
    }
    let unfolding = super::max_abs(beta);
    let gap = if curved > 0.0 { (unfolding / curved).sqrt() } else { 0.0 };
    // less than the iteration tells from zero: what corrections leave of a trivial branch
    let gap = if gap > CONVERGED { gap } else { 0.0 };
    let resolution = local.resolution(&amplitude);
    let Local { right, left, form, .. } = local;
    Ok(Singular { z, right, left, form, amplitude, correction, resolution, unfolding, gap, frame })
}

/// Vectors, defect and quadratic form at an assembled and factored point.
struct Local {
    right: Vec<Extended>,
    left: Vec<Vec<f64>>,
    g: Vec<Vec<f64>>,
    form: Form,
    /// Rounding of `g`, each column times its natural amplitude.
    noise: f64,
}

/// `form[j][i][l] = w_jᵀ F_zz[v_i, v_l]`.
type Form = Vec<Vec<Vec<f64>>>;

/// What is known of the quadratic form.
#[derive(Debug, Clone)]
enum Known {
    /// Nothing: differences from four places in each direction.
    Nothing,
    /// Nothing, and one place beside the point says enough: the form steers the iteration only.
    Roughly,
    /// That of a point near by.
    Form(Form),
}

impl Local {
    fn of(
        probe: &mut Probe<'_>,
        frame: &mut Frame,
        z: &Extended,
        amplitude: &mut Vec<f64>,
        tangent: &Extended,
        known: Known,
    ) -> Result<Self, Failure> {
        let k = frame.k;
        let (mut right, mut g) = (Vec::new(), vec![Vec::new(); k]);
        for i in 0..=k {
            let (v, column) = frame.right(probe, i);
            right.push(v);
            for (g, c) in g.iter_mut().zip(column) {
                g.push(c);
            }
        }
        let left: Vec<Vec<f64>> = (0..k).map(|j| frame.left(probe, j)).collect();
        if amplitude.is_empty() {
            *amplitude = amplitudes(probe, z, &right, tangent)?;
        }
        let form = match known {
            Known::Form(form) => form,
            Known::Roughly => quadratic_form(probe, z, (&right, &left), amplitude, true)?,
            Known::Nothing => quadratic_form(probe, z, (&right, &left), amplitude, false)?,
        };
        let norm = |x: &[f64]| crate::step::dot(x, x).sqrt();
        let widest = right.iter().zip(&*amplitude).map(|(v, x)| norm(&v.u) * x);
        let widest = widest.fold(0.0, f64::max);
        let longest = left.iter().map(|w| norm(w)).fold(0.0, f64::max);
        let noise = ENTRIES * probe.jacobian.norm() * longest * widest;
        Ok(Local { right, left, g, form, noise })
    }

    /// Corrects the form of one vector beside the branch by what is left of the defect after a step `y`
    /// that was to remove it (Broyden, in natural amplitudes).
    fn learn(&mut self, y: &[f64], amplitude: &[f64]) {
        let along: Vec<f64> = y.iter().zip(amplitude).map(|(y, x)| y / (x * x)).collect();
        let square = crate::step::dot(y, &along);
        for (row, g) in self.form[0].iter_mut().zip(&self.g[0]) {
            for (f, along) in row.iter_mut().zip(&along) {
                *f -= g * along / square;
            }
        }
    }

    /// By how much `noise` moves the point, in natural amplitudes. The place of a simple point
    /// along the branch follows from what the branch does to the critical mode, that of a multiple
    /// one from the largest of the terms.
    fn resolution(&self, amplitude: &[f64]) -> f64 {
        let size = |f: &Vec<Vec<f64>>| {
            let rows = f.iter().zip(amplitude);
            let terms =
                rows.flat_map(|(row, x)| row.iter().zip(amplitude).map(move |(t, y)| t * x * y));
            terms.fold(0.0, |m: f64, t| m.max(t.abs()))
        };
        let mut slope = self.form.iter().map(size).fold(0.0, f64::max);
        if let [form] = &self.form[..] {
            let along = (form[0][1] * amplitude[1]).abs();
            slope = if along > 0.0 { along } else { slope };
        }
        if slope > 0.0 { self.noise / slope } else { 0.0 }
    }

    /// The derivative of the defect, row by row.
    fn matrix(&self) -> Vec<Vec<f64>> {
        self.form.iter().flatten().cloned().collect()
    }

    /// Where along the branch the single modes become critical: the real eigenvalues `s` of
    /// `G − s G_s` on the vectors other than the branch's own.
    fn apart(&self, z: &Extended) -> Vec<Extended> {
        let k = self.left.len();
        let (mut g, mut slope) = (Dense::new(k), Dense::new(k));
        for j in 0..k {
            for i in 0..k {
                g.set(j, i, self.g[j][i + 1]);
                slope.set(j, i, self.form[j][i + 1][0]);
            }
        }
        let values = g.spectrum(Some(&slope)).unwrap_or_default();
        let real = values.into_iter().filter(|(re, im)| im.abs() <= 1e-6 * re.hypot(*im));
        real.map(|(s, _)| {
            let mut seed = z.clone();
            seed.add(s, &self.right[0]);
            seed
        })
        .collect()
    }

    fn defect(&self) -> Vec<f64> {
        self.g.iter().flatten().copied().collect()
    }
}

/// `form[j][i][l] = w_jᵀ F_zz[v_i, v_l]`, by differences along each right vector.
fn quadratic_form(
    probe: &mut Probe<'_>,
    z: &Extended,
    (right, left): (&[Extended], &[Vec<f64>]),
    amplitude: &[f64],
    roughly: bool,
) -> Result<Form, EvalError> {
    let k = left.len();
    let mut form = vec![vec![vec![0.0; k + 1]; k + 1]; k];
    let all: Vec<&Extended> = right.iter().collect();
    for (l, v) in right.iter().enumerate() {
        let second = match roughly {
            true => probe.second_from_one_side(z, v, amplitude[l], &all)?,
            false => probe.second(z, v, amplitude[l], &all)?,
        };
        for (j, w) in left.iter().enumerate() {
            for (i, y) in second.iter().enumerate() {
                form[j][i][l] = crate::step::dot(w, y);
            }
        }
    }
    // differences in both orders: their mean is symmetric; along the branch itself a step is a
    // part of the parameter's range, whatever happens within, along the others of a natural one
    for f in &mut form {
        for i in 0..=k {
            for l in 0..i {
                let mean = if l == 0 { f[0][i] } else { 0.5 * (f[i][l] + f[l][i]) };
                (f[i][l], f[l][i]) = (mean, mean);
            }
        }
    }
    Ok(form)
}

/// Natural amplitudes of the right vectors, measured against what the branch's own direction does
/// to the Jacobian over the range of the parameter.
fn amplitudes(
    probe: &mut Probe<'_>,
    z: &Extended,
    right: &[Extended],
    tangent: &Extended,
) -> Result<Vec<f64>, EvalError> {
    let mut amplitude = vec![1.0];
    let others: Vec<&Extended> = right[1..].iter().collect();
    let along = probe.second_from_one_side(z, tangent, 1.0, &others)?;
    for (v, by_branch) in right[1..].iter().zip(&along) {
        let reference = super::max_abs(by_branch);
        let found = if reference > 0.0 { probe.amplitude_here(z, v, reference) } else { None };
        amplitude.push(found.unwrap_or(1.0));
    }
    // known to a factor of some: vectors that a symmetry turns into each other have one amplitude
    let others = &mut amplitude[1..];
    let least = others.iter().copied().fold(f64::INFINITY, f64::min);
    let most = others.iter().copied().fold(0.0, f64::max);
    if most <= ALIKE * least {
        others.fill((least * most).sqrt());
    }
    Ok(amplitude)
}

#[cfg(test)]
mod tests {
    use super::Pace;

    /// Whether corrections are taken for rounding, one by one.
    fn slow(corrections: &[f64]) -> Vec<bool> {
        let mut pace = Pace::default();
        corrections.iter().map(|c| pace.see(*c, 1e-8).1).collect()
    }

    #[test]
    fn rounding_is_told_from_creeping() {
        // quadratic, then rounding
        assert_eq!(slow(&[1e-2, 1e-4, 1e-9, 8e-10]), [false, false, false, true]);
        // rounding from the start: known as soon as it grows
        assert_eq!(slow(&[4e-9, 3e-9, 5e-9]), [false, false, true]);
        // towards a triple root: by two thirds each time, also below the threshold
        let mut creeping: Vec<f64> = vec![1e-7];
        creeping.extend((1..40).map(|k| 1e-7 * (2f64 / 3.0).powi(k)));
        assert!(slow(&creeping).iter().all(|slow| !slow));
    }
}
