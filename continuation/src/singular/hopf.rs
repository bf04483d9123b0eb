//! Hopf points by an augmented Newton method, and the first Lyapunov coefficient.
//!
//! `A = f_u − iω M` is bordered to a regular complex matrix; the scalar `g` of its inverse vanishes
//! exactly where `iω` is an eigenvalue. Newton's method in the arclength and `ω` uses
//! `g_s = −wᴴ (f_u)_s v` and `g_ω = i wᴴ M v` (Govaerts 2000, section 4.3, in complex form). The
//! coefficient is that of Kuznetsov, *Elements of Applied Bifurcation Theory*, Eq. (10.35):
//! `l₁ = Re pᴴ[C(q,q,q̄) − 2B(q, A₀⁻¹B(q,q̄)) + B(q̄, (2iωM − A₀)⁻¹B(q,q))] / (2ω)`, `A₀ = f_u`.

use super::plateau::settle;
use super::probe::{Extended, Probe};
use crate::branch::{Criticality, Eigenvector, HopfForm};
use crate::events::{bend, interpolate};
use crate::linalg::{AnyMatrix, Bordered, Matrix};
use crate::problem::EvalError;
use crate::step::{Constraint, Core, Precision, Refusal, State, dot};

const MAX_ITERATIONS: usize = 10;

/// A Hopf point on the traced branch.
#[derive(Debug, Clone)]
pub(crate) struct HopfPoint {
    /// Scaled distance from the step's first end.
    pub(crate) at: f64,
    /// Estimated error, as a scaled length.
    pub(crate) error: f64,
    pub(crate) form: Option<HopfForm>,
    pub(crate) vector: Option<Eigenvector>,
}

/// Polishes a Hopf point near the scaled distance `at` from `a`, with eigenvalues near `±iω`.
/// `None` where the matrix has no complex form; the bracketing search then has the last word.
pub(crate) fn locate_hopf(
    core: &mut Core<'_>,
    a: &State,
    b: &State,
    h: f64,
    mut at: f64,
    mut omega: f64,
    x: &mut State,
) -> Result<Option<HopfPoint>, Refusal> {
    let mut probe = core.probe();
    let bend = bend(core, a, b);
    let mut critical: Option<Critical> = None;
    let mut last = f64::INFINITY;
    for _ in 0..MAX_ITERATIONS {
        interpolate(a, b, h, bend, at, x);
        core.correct(Constraint::Plane(a, at), x, Precision::Event)?;
        let z = Extended { u: x.u.clone(), p: x.p };
        probe.assemble(&z).map_err(Refusal::Evaluation)?;
        let border = critical.take().map(|c| (c.right, c.left));
        let Some(found) = Critical::of(&probe, omega, border) else { return Ok(None) };
        let t = Extended { u: x.tu.clone(), p: x.tp };
        let (re, im) = found.parts();
        let by_s = probe.second(&z, &t, 1.0, &[&re, &im]).map_err(Refusal::Evaluation)?;
        let g_s = found.left.dot(&Complex::join(&by_s[0], &by_s[1]));
        let g_omega = found.left.dot(&found.mass_right);
        // g − g_s δs + i g_ω δω = 0, in real and imaginary parts
        let (ds, dw) = solve2([-g_s.0, -g_omega.1], [-g_s.1, g_omega.0], [-found.g.0, -found.g.1]);
        // δs is measured along the tangent at x
        let cosine = core.weights.dot(&a.mtu, a.tp, &x.tu, x.tp);
        let (step, relative) = (ds * cosine, (dw / omega).abs());
        if !(step.is_finite() && relative.is_finite())
            || at + step < -0.5 * h
            || at + step > 1.5 * h
        {
            return Ok(None);
        }
        at += step;
        omega += dw;
        let size = (step / h).abs().max(relative);
        let done = size <= 1e-13 || (size < 1e-9 && size > 0.25 * last);
        last = size;
        critical = Some(found);
        if done {
            if !(0.0..=h).contains(&at) {
                return Ok(None);
            }
            // what errors of the derivatives do to g, and so to the location
            let determinant = g_s.0 * g_omega.0 + g_s.1 * g_omega.1;
            let mut moved = 0.0;
            if let Some(found) = &critical {
                let missed = found.missed(&mut probe, &z).map_err(Refusal::Evaluation)?;
                moved = missed * cosine * g_omega.0.hypot(g_omega.1) / determinant.abs();
            }
            let vector = critical.as_ref().map(Critical::eigenvector);
            let form = critical.and_then(|c| normal_form(&mut probe, &z, &t, omega, &c).ok());
            core.statistics.newton_iterations += probe.assemblies;
            let error = step.abs().max(f64::EPSILON) + moved;
            return Ok(Some(HopfPoint { at, error, form: form.flatten(), vector }));
        }
    }
    Ok(None)
}

/// A complex vector, real and imaginary parts in turn.
#[derive(Debug, Clone)]
struct Complex(Vec<f64>);

impl Complex {
    fn join(re: &[f64], im: &[f64]) -> Self {
        Complex(re.iter().zip(im).flat_map(|(a, b)| [*a, *b]).collect())
    }

    fn split(&self) -> (Vec<f64>, Vec<f64>) {
        self.0.chunks_exact(2).map(|c| (c[0], c[1])).unzip()
    }

    /// `selfᴴ y`.
    fn dot(&self, y: &Complex) -> (f64, f64) {
        let pairs = self.0.chunks_exact(2).zip(y.0.chunks_exact(2));
        pairs.fold((0.0, 0.0), |(re, im), (a, b)| {
            (re + a[0] * b[0] + a[1] * b[1], im + a[0] * b[1] - a[1] * b[0])
        })
    }

    /// `i self`.
    fn turned(&self) -> Self {
        Complex(self.0.chunks_exact(2).flat_map(|c| [-c[1], c[0]]).collect())
    }

    fn normalise(&mut self) {
        let norm = dot(&self.0, &self.0).sqrt();
        self.0.iter_mut().for_each(|x| *x /= norm);
    }
}

/// Null vectors of `f_u − iω M`, bordered.
struct Critical {
    right: Complex,
    left: Complex,
    /// `M` times the right vector.
    mass_right: Complex,
    g: (f64, f64),
    /// `f_u − iω M`, and the mass matrix, where it is not the identity.
    mass: Mass,
}

impl Critical {
    /// Bordered null vectors at an assembled point; borders from before, or arbitrary ones that
    /// are improved once.
    fn of(probe: &Probe<'_>, omega: f64, border: Option<(Complex, Complex)>) -> Option<Self> {
        let n = probe.dim();
        let mass = Mass::of(probe)?;
        let mut matrix = mass.shifted(probe, omega)?;
        let mut bordered = Bordered::new(2 * n, 2);
        let known = border.is_some();
        let arbitrary =
            |seed: usize| Complex((0..2 * n).map(|i| super::kernel::arbitrary(seed, i)).collect());
        let (mut right, mut left) = border.unwrap_or_else(|| (arbitrary(1), arbitrary(2)));
        let mut g = (0.0, 0.0);
        for _ in 0..if known { 1 } else { 3 } {
            right.normalise();
            left.normalise();
            bordered.row_mut(0).copy_from_slice(&right.0);
            bordered.row_mut(1).copy_from_slice(&right.turned().0);
            bordered.column_mut(0).copy_from_slice(&left.0);
            bordered.column_mut(1).copy_from_slice(&left.turned().0);
            bordered.factor(&mut matrix);
            let mut tail = [1.0, 0.0];
            let mut v = vec![0.0; 2 * n];
            bordered.solve(&mut matrix, &mut v, &mut tail);
            g = (tail[0], tail[1]);
            let mut tail = [1.0, 0.0];
            let mut w = vec![0.0; 2 * n];
            bordered.solve_transpose(&mut matrix, &mut w, &mut tail);
            (right, left) = (Complex(v), Complex(w));
        }
        let mass_right = mass.times(&right);
        let finite = |c: &Complex| c.0.iter().all(|x| x.is_finite());
        (finite(&right) && finite(&left)).then_some(Critical { right, left, mass_right, g, mass })
    }

    /// Real and imaginary part of the right eigenvector `q`, of length 1, and the left one `p`
    /// with `pᴴ M q = 1`.
    fn eigenvectors(&self) -> (Extended, Extended, Complex) {
        let mut q = self.right.clone();
        q.normalise();
        let (re, im) = self.left.dot(&self.mass.times(&q));
        let size = re * re + im * im;
        let (c, s) = (re / size, im / size);
        let turn = |w: &[f64]| [c * w[0] - s * w[1], c * w[1] + s * w[0]];
        let p = Complex(self.left.0.chunks_exact(2).flat_map(turn).collect());
        let (a, b) = q.split();
        (Extended { u: a, p: 0.0 }, Extended { u: b, p: 0.0 }, p)
    }

    /// The right eigenvector, of length 1.
    fn eigenvector(&self) -> Eigenvector {
        let mut q = self.right.clone();
        q.normalise();
        let (re, im) = q.split();
        Eigenvector { re, im }
    }

    /// A bound of what errors of the problem's own derivatives change of `g`.
    fn missed(&self, probe: &mut Probe<'_>, z: &Extended) -> Result<f64, EvalError> {
        let (re, im) = self.parts();
        let errors = [probe.derivative_error(z, &re)?, probe.derivative_error(z, &im)?];
        let size = |(w, (a, b)): (&[f64], (&f64, &f64))| w[0].hypot(w[1]) * (a + b);
        Ok(self.left.0.chunks_exact(2).zip(errors[0].iter().zip(&errors[1])).map(size).sum())
    }

    /// The right vector's real and imaginary parts.
    fn parts(&self) -> (Extended, Extended) {
        let (re, im) = self.right.split();
        (Extended { u: re, p: 0.0 }, Extended { u: im, p: 0.0 })
    }
}

/// The mass matrix; the identity where the problem has none.
struct Mass(AnyMatrix);

impl Mass {
    fn of(probe: &Probe<'_>) -> Option<Self> {
        let mut m = probe.problem.new_jacobian();
        m.set_zero();
        if !probe.problem.mass(&mut m) {
            m.set_zero();
            if !m.add_identity(1.0) {
                return None;
            }
        }
        Some(Mass(m))
    }

    /// `f_u − iω M` in real form.
    fn shifted(&self, probe: &Probe<'_>, omega: f64) -> Option<AnyMatrix> {
        let mut imaginary = self.0.clone();
        imaginary.set_zero();
        imaginary.axpy(-omega, &self.0);
        probe.jacobian.complex(&imaginary)
    }

    fn times(&self, x: &Complex) -> Complex {
        let (re, im) = x.split();
        let (mut a, mut b) = (re.clone(), im.clone());
        self.0.mul(&re, &mut a);
        self.0.mul(&im, &mut b);
        Complex::join(&a, &b)
    }
}

/// The normal form at a located point; `t` is the branch's tangent there.
fn normal_form(
    probe: &mut Probe<'_>,
    z: &Extended,
    t: &Extended,
    omega: f64,
    critical: &Critical,
) -> Result<Option<HopfForm>, EvalError> {
    let (a, b, p) = critical.eigenvectors();
    let by_branch = probe.second(z, t, 1.0, &[&a, &b])?;
    let reference = super::max_abs(&by_branch[0]).max(super::max_abs(&by_branch[1]));
    let amplitude = if reference > 0.0 { probe.natural(z, [&a, &b], reference) } else { None };
    let amplitude = amplitude.unwrap_or(1.0);
    let found =
        settle(0.0, |part| lyapunov(probe, z, omega, critical, &p, (&a, &b), part * amplitude))?;
    let Some(found) = found else { return Ok(None) };
    let criticality = match found.value {
        _ if !found.is_signed() => None,
        l if l < 0.0 => Some(Criticality::Supercritical),
        _ => Some(Criticality::Subcritical),
    };
    let (lyapunov, lyapunov_error) = (found.value, found.error);
    Ok(Some(HopfForm { frequency: omega, lyapunov, lyapunov_error, criticality }))
}

/// The first Lyapunov coefficient and its estimated error at `z`, where `probe` is assembled, with
/// critical eigenvalues `±iω` and the null vectors of `f_u − iωM`, their real and imaginary parts in
/// turn. `None` where the matrix has no complex form.
pub(crate) fn lyapunov_coefficient(
    probe: &mut Probe<'_>,
    z: &Extended,
    omega: f64,
    right: &[f64],
    left: &[f64],
) -> Result<Option<(f64, f64)>, EvalError> {
    let Some(mass) = Mass::of(probe) else { return Ok(None) };
    let (right, left) = (Complex(right.to_vec()), Complex(left.to_vec()));
    let mass_right = mass.times(&right);
    let critical = Critical { right, left, mass_right, g: (0.0, 0.0), mass };
    let (a, b, p) = critical.eigenvectors();
    // where the nonlinearity does as much as the oscillation
    let (mut by_a, mut by_b) = (vec![0.0; probe.dim()], vec![0.0; probe.dim()]);
    probe.jacobian.mul(&a.u, &mut by_a);
    probe.jacobian.mul(&b.u, &mut by_b);
    let reference = super::max_abs(&by_a).max(super::max_abs(&by_b));
    // of slow oscillations beside fast modes more: rounding is that of the whole matrix
    let whole = probe.jacobian.norm() * super::max_abs(&a.u).max(super::max_abs(&b.u));
    let reference = reference * (whole / reference).sqrt().clamp(1.0, 20.0);
    let amplitude = probe.natural(z, [&a, &b], reference).unwrap_or(1.0);
    let mut value = [f64::NAN; 3];
    for (value, x) in value.iter_mut().zip([4.0, 2.0, 1.0]) {
        let x = x * amplitude;
        let Some(l) = lyapunov(probe, z, omega, &critical, &p, (&a, &b), x)? else {
            return Ok(None);
        };
        *value = l;
    }
    // differences of order four, extrapolated; shorter steps show the rounding errors
    let extrapolated = |coarse: f64, fine: f64| fine + (fine - coarse) / 15.0;
    let [value, check] = [extrapolated(value[0], value[1]), extrapolated(value[1], value[2])];
    Ok(Some((value, (value - check).abs())))
}

fn lyapunov(
    probe: &mut Probe<'_>,
    z: &Extended,
    omega: f64,
    critical: &Critical,
    p: &Complex,
    (a, b): (&Extended, &Extended),
    amplitude: f64,
) -> Result<Option<f64>, EvalError> {
    let add = |x: &[f64], s: f64, y: &[f64]| -> Vec<f64> {
        x.iter().zip(y).map(|(x, y)| x + s * y).collect()
    };
    let real = |u: Vec<f64>| Extended { u, p: 0.0 };
    let from_a = probe.second(z, a, amplitude, &[a, b])?;
    let from_b = probe.second(z, b, amplitude, &[b])?;
    let (aa, ab, bb) = (&from_a[0], &from_a[1], &from_b[0]);
    // h11 = A⁻¹ B(q, q̄)
    let mut h11 = add(aa, 1.0, bb);
    let floor = f64::EPSILON * probe.jacobian.norm();
    probe.jacobian.factor(floor);
    probe.jacobian.solve(&mut h11);
    let h11 = real(h11);
    // h20 = (2iωM − A)⁻¹ B(q, q)
    let Some(mut shifted) = critical.mass.shifted(probe, 2.0 * omega) else { return Ok(None) };
    let twice: Vec<f64> = ab.iter().map(|x| 2.0 * x).collect();
    let mut h20 = Complex::join(&add(aa, -1.0, bb), &twice);
    let floor = f64::EPSILON * shifted.norm();
    shifted.factor(floor);
    shifted.solve(&mut h20.0);
    let (c, d) = h20.split();
    let (c, d) = (real(c.iter().map(|x| -x).collect()), real(d.iter().map(|x| -x).collect()));
    let by_a = probe.second(z, a, amplitude, &[&h11, &c, &d])?;
    let by_b = probe.second(z, b, amplitude, &[&h11, &c, &d])?;
    let cubic_a = probe.third(z, a, amplitude, &[a, b])?;
    let cubic_b = probe.third(z, b, amplitude, &[a, b])?;
    let mut re = add(&cubic_a[0], 1.0, &cubic_b[0]);
    let mut im = add(&cubic_a[1], 1.0, &cubic_b[1]);
    re = add(&re, -2.0, &by_a[0]);
    im = add(&im, -2.0, &by_b[0]);
    re = add(&add(&re, 1.0, &by_a[1]), 1.0, &by_b[2]);
    im = add(&add(&im, 1.0, &by_a[2]), -1.0, &by_b[1]);
    let (value, _) = p.dot(&Complex::join(&re, &im));
    let l1 = value / (2.0 * omega);
    Ok(l1.is_finite().then_some(l1))
}

/// Solves two equations with rows `a`, `b`... and right-hand sides `r`.
fn solve2(a: [f64; 2], b: [f64; 2], r: [f64; 2]) -> (f64, f64) {
    let determinant = a[0] * b[1] - a[1] * b[0];
    ((r[0] * b[1] - a[1] * r[1]) / determinant, (a[0] * r[1] - r[0] * b[0]) / determinant)
}
