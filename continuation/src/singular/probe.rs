//! Derivatives of `[F_u F_p]` along directions, by differences with steps that the problem itself
//! sets.
//!
//! Differences of exact Jacobians: the first derivative over four points is right to about 1e-12,
//! the second to about 1e-8, of what the nonlinearity does over its natural amplitude.

use crate::any_problem::Held;
use crate::linalg::{AnyMatrix, Matrix};
use crate::problem::{EvalError, ParamId, check_finite, check_pattern};
use crate::step::{Guard, Weights, dot};
use serde::{Deserialize, Serialize};

/// A vector of unknowns and continued parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Extended {
    pub(crate) u: Vec<f64>,
    pub(crate) p: f64,
}

impl Extended {
    pub(crate) fn zero(n: usize) -> Self {
        Extended { u: vec![0.0; n], p: 0.0 }
    }

    /// `self += a x`.
    pub(crate) fn add(&mut self, a: f64, x: &Extended) {
        for (u, x) in self.u.iter_mut().zip(&x.u) {
            *u += a * x;
        }
        self.p += a * x.p;
    }

    pub(crate) fn scale(&mut self, a: f64) {
        self.u.iter_mut().for_each(|u| *u *= a);
        self.p *= a;
    }

    /// Plain inner product, of a covector and a vector.
    pub(crate) fn dot(&self, x: &Extended) -> f64 {
        dot(&self.u, &x.u) + self.p * x.p
    }
}

/// Step of first differences, in natural amplitudes.
pub(super) const FIRST: f64 = 1e-3;
/// The same from one side: a hundredth of the scale on which sharp turns of a branch vary.
const BESIDE: f64 = 1e-5;
/// Step of second differences.
pub(super) const SECOND: f64 = 1e-2;

/// Derivatives along a direction `v`, with a left vector `w`.
pub(super) struct Bending {
    /// `F_zz[v, v]`.
    pub(super) second: Vec<f64>,
    /// `wᵀF_zz[v, ·]`.
    pub(super) row: Extended,
    /// `wᵀF_zzz[v, v, v]`.
    pub(super) third: f64,
}

/// Evaluates a problem near a point; allocated when a special point is analysed.
#[derive(Clone)]
pub(crate) struct Probe<'a> {
    pub(crate) problem: Held<'a>,
    pub(crate) which: ParamId,
    pub(crate) weights: Weights,
    guard: Guard,
    pub(crate) jacobian: AnyMatrix,
    pub(crate) residual: Vec<f64>,
    pub(crate) by_parameter: Vec<f64>,
    /// Jacobian assemblies so far.
    pub(crate) assemblies: usize,
    p: Vec<f64>,
    shifted: AnyMatrix,
    place: Vec<f64>,
    slope: Vec<f64>,
    product: Vec<f64>,
    metric: Vec<f64>,
}

impl<'a> Probe<'a> {
    pub(crate) fn new(
        problem: impl Into<Held<'a>>,
        which: ParamId,
        p: &[f64],
        weights: Weights,
    ) -> Self {
        let problem = problem.into();
        let n = problem.dim();
        let vector = || vec![0.0; n];
        Probe {
            which,
            weights,
            guard: Guard::new(None),
            jacobian: problem.new_jacobian(),
            residual: vector(),
            by_parameter: vector(),
            assemblies: 0,
            p: p.to_vec(),
            shifted: problem.new_jacobian(),
            place: vector(),
            slope: vector(),
            product: vector(),
            metric: vector(),
            problem,
        }
    }

    /// Refuses points outside a domain; differences reach beyond it.
    pub(crate) fn within(self, guard: Guard) -> Self {
        Probe { guard, ..self }
    }

    /// Replaces the values of all parameters.
    pub(crate) fn set_parameters(&mut self, p: &[f64]) {
        self.p.copy_from_slice(p);
    }

    pub(crate) fn dim(&self) -> usize {
        self.residual.len()
    }

    /// Residual, Jacobian and parameter derivative at `z`.
    pub(crate) fn assemble(&mut self, z: &Extended) -> Result<(), EvalError> {
        self.p[self.which.0] = self.guard.admit(z.p)?;
        self.assemblies += 1;
        self.problem.linearise(&z.u, &self.p, &mut self.residual, &mut self.jacobian)?;
        check_pattern(&self.jacobian)?;
        let column = &mut self.by_parameter;
        self.problem.parameter_derivative(&z.u, &self.p, self.which, column)?;
        check_finite(&self.residual)?;
        check_finite(&self.by_parameter)
    }

    /// The residual alone, at `z`.
    pub(crate) fn residual_at(&mut self, z: &Extended) -> Result<&[f64], EvalError> {
        self.p[self.which.0] = z.p;
        self.problem.residual(&z.u, &self.p, &mut self.product)?;
        Ok(&self.product)
    }

    /// `x` as a covector of the scaled metric.
    pub(crate) fn covector(&mut self, x: &Extended) -> Extended {
        let Weights { unknowns, parameter } = self.weights;
        let mut y = Extended::zero(x.u.len());
        self.problem.metric(&x.u, &mut y.u);
        y.u.iter_mut().for_each(|y| *y /= unknowns * unknowns);
        y.p = x.p / (parameter * parameter);
        y
    }

    /// Length in the scaled metric.
    pub(crate) fn norm(&mut self, x: &Extended) -> f64 {
        self.problem.metric(&x.u, &mut self.metric);
        self.weights.norm(&self.metric, &x.u, x.p)
    }

    /// Length in the problem's metric.
    pub(crate) fn length(&mut self, x: &Extended) -> f64 {
        self.problem.metric(&x.u, &mut self.metric);
        (dot(&self.metric, &x.u) + x.p * x.p).max(0.0).sqrt()
    }

    /// Jacobian and parameter derivative at `z + h v`.
    fn assemble_beside(&mut self, z: &Extended, v: &Extended, h: f64) -> Result<(), EvalError> {
        for ((place, u), v) in self.place.iter_mut().zip(&z.u).zip(&v.u) {
            *place = u + h * v;
        }
        self.p[self.which.0] = z.p + h * v.p;
        self.assemblies += 1;
        self.problem.jacobian(&self.place, &self.p, &mut self.shifted)?;
        self.problem.parameter_derivative(&self.place, &self.p, self.which, &mut self.slope)
    }

    /// Adds `a [F_u F_p](z + h v) x_i` to `out[i]` for every `x_i`.
    fn accumulate(
        &mut self,
        z: &Extended,
        v: &Extended,
        h: f64,
        a: f64,
        xs: &[&Extended],
        out: &mut [Vec<f64>],
    ) -> Result<(), EvalError> {
        self.assemble_beside(z, v, h)?;
        for (x, out) in xs.iter().zip(out) {
            self.shifted.mul(&x.u, &mut self.product);
            for ((o, y), f) in out.iter_mut().zip(&self.product).zip(&self.slope) {
                *o += a * (y + x.p * f);
            }
            check_finite(out)?;
        }
        Ok(())
    }

    /// A bound, by component, of what the problem's own derivatives miss of `[F_u F_p] v` at `z`.
    pub(crate) fn derivative_error(
        &mut self,
        z: &Extended,
        v: &Extended,
    ) -> Result<Vec<f64>, EvalError> {
        self.p[self.which.0] = z.p;
        let mut error = vec![0.0; self.dim()];
        self.problem.derivative_error(&z.u, &self.p, self.which, &v.u, v.p, &mut error)?;
        Ok(error)
    }

    fn stencil(
        &mut self,
        z: &Extended,
        v: &Extended,
        terms: &[(f64, f64)],
        xs: &[&Extended],
    ) -> Result<Vec<Vec<f64>>, EvalError> {
        let mut out = vec![vec![0.0; self.dim()]; xs.len()];
        for &(h, a) in terms {
            self.accumulate(z, v, h, a, xs, &mut out)?;
        }
        Ok(out)
    }

    /// `F_zz[v, x_i]` for every `x_i`; `amplitude` is the natural multiple of `v`.
    pub(crate) fn second(
        &mut self,
        z: &Extended,
        v: &Extended,
        amplitude: f64,
        xs: &[&Extended],
    ) -> Result<Vec<Vec<f64>>, EvalError> {
        let h = FIRST * amplitude;
        let a = 1.0 / (12.0 * h);
        let terms = [(h, 8.0 * a), (-h, -8.0 * a), (2.0 * h, -a), (-2.0 * h, a)];
        self.stencil(z, v, &terms, xs)
    }

    /// The same from one place and the matrix that was assembled last, that at `z`: enough to steer an
    /// iteration.
    pub(crate) fn second_from_one_side(
        &mut self,
        z: &Extended,
        v: &Extended,
        amplitude: f64,
        xs: &[&Extended],
    ) -> Result<Vec<Vec<f64>>, EvalError> {
        let h = BESIDE * amplitude;
        let mut out: Vec<Vec<f64>> = xs.iter().map(|x| self.without_here(x)).collect();
        self.accumulate(z, v, h, 1.0, xs, &mut out)?;
        out.iter_mut().flatten().for_each(|y| *y /= h);
        Ok(out)
    }

    /// `F_zzz[v, v, x_i]` for every `x_i`, and `F_zz[v, x_i]` from the same evaluations.
    pub(crate) fn third(
        &mut self,
        z: &Extended,
        v: &Extended,
        amplitude: f64,
        xs: &[&Extended],
    ) -> Result<Vec<Vec<f64>>, EvalError> {
        let h = SECOND * amplitude;
        let a = 1.0 / (12.0 * h * h);
        let terms =
            [(h, 16.0 * a), (-h, 16.0 * a), (2.0 * h, -a), (-2.0 * h, -a), (0.0, -30.0 * a)];
        self.stencil(z, v, &terms, xs)
    }

    /// What bends a branch along `v` in the direction of `w`, all from four places; the matrix that was
    /// assembled last is that at `z`.
    pub(super) fn bending(
        &mut self,
        z: &Extended,
        v: &Extended,
        amplitude: f64,
        w: &[f64],
    ) -> Result<Bending, EvalError> {
        let h = SECOND * amplitude;
        let (a, b) = (1.0 / (12.0 * h), 1.0 / (12.0 * h * h));
        let n = self.dim();
        let mut bending = Bending { second: vec![0.0; n], row: Extended::zero(n), third: 0.0 };
        self.jacobian.mul(&v.u, &mut self.product);
        let here = dot(w, &self.product) + v.p * dot(w, &self.by_parameter);
        bending.third = -30.0 * b * here;
        let places = [
            (h, 8.0 * a, 16.0 * b),
            (-h, -8.0 * a, 16.0 * b),
            (2.0 * h, -a, -b),
            (-2.0 * h, a, -b),
        ];
        for (x, first, second) in places {
            self.assemble_beside(z, v, x)?;
            self.shifted.mul(&v.u, &mut self.product);
            for (y, f) in self.product.iter_mut().zip(&self.slope) {
                *y += v.p * f;
            }
            bending.third += second * dot(w, &self.product);
            for (s, y) in bending.second.iter_mut().zip(&self.product) {
                *s += first * y;
            }
            self.shifted.mul_transpose(w, &mut self.product);
            for (r, y) in bending.row.u.iter_mut().zip(&self.product) {
                *r += first * y;
            }
            bending.row.p += first * dot(w, &self.slope);
        }
        check_finite(&bending.second)?;
        check_finite(&bending.row.u)?;
        Ok(bending)
    }

    /// `−[F_u F_p](z) v`.
    fn without(&mut self, z: &Extended, v: &Extended) -> Result<Vec<f64>, EvalError> {
        let mut out = [vec![0.0; self.dim()]];
        self.accumulate(z, v, 0.0, -1.0, &[v], &mut out)?;
        let [out] = out;
        Ok(out)
    }

    /// The same with the matrix that was assembled last, that at `z`.
    fn without_here(&self, v: &Extended) -> Vec<f64> {
        let mut out = vec![0.0; self.dim()];
        self.jacobian.mul(&v.u, &mut out);
        for (o, f) in out.iter_mut().zip(&self.by_parameter) {
            *o = -(*o + v.p * f);
        }
        out
    }

    /// Largest component of `([F_u F_p](z + x v) − [F_u F_p](z)) x_i`, given every
    /// `base_i = −[F_u F_p](z) x_i`.
    fn change(
        &mut self,
        z: &Extended,
        v: &Extended,
        x: f64,
        (xs, base): (&[&Extended], &[Vec<f64>]),
        out: &mut [Vec<f64>],
    ) -> Result<f64, EvalError> {
        out.iter_mut().zip(base).for_each(|(out, base)| out.copy_from_slice(base));
        self.accumulate(z, v, x, 1.0, xs, out)?;
        Ok(out.iter().map(|out| super::max_abs(out)).fold(0.0, f64::max))
    }

    /// [`Self::amplitude`] in the plane of two vectors to a factor of two or so, where the change is about linear in it: steps
    /// that do not depend on the unit of the unknowns. The smaller one of both: a problem may be linear in one of them.
    pub(crate) fn natural(
        &mut self,
        z: &Extended,
        plane: [&Extended; 2],
        reference: f64,
    ) -> Option<f64> {
        let mut base = Vec::with_capacity(2);
        for v in plane {
            base.push(self.without(z, v).ok()?);
        }
        let applied = (&plane[..], &base[..]);
        let mut smallest = None::<(f64, &Extended)>;
        for v in plane {
            let found = self.amplitude_over(z, v, reference, applied);
            if let Some(x) = found.filter(|x| smallest.is_none_or(|(least, _)| *x < least)) {
                smallest = Some((x, v));
            }
        }
        let (mut x, v) = smallest?;
        let mut out = vec![vec![0.0; self.dim()]; 2];
        for _ in 0..3 {
            match self.change(z, v, x, applied, &mut out) {
                Ok(change) if change > 0.0 => x *= (reference / change).clamp(0.01, 20.0),
                _ => break,
            }
        }
        Some(x)
    }

    /// The multiple `X` of `v` for which `[F_u F_p](z + X v) − [F_u F_p](z)`, applied to `v`, is as
    /// large as `reference`: where the nonlinearity matters. It scales with the unknowns, whatever
    /// their unit. `None` if no multiple within twelve decades is found: the problem is linear in
    /// `v` as far as can be seen.
    pub(crate) fn amplitude(&mut self, z: &Extended, v: &Extended, reference: f64) -> Option<f64> {
        let base = self.without(z, v).ok()?;
        self.amplitude_over(z, v, reference, (&[v], &[base]))
    }

    /// The same where the matrix that was assembled last is that at `z`.
    pub(crate) fn amplitude_here(
        &mut self,
        z: &Extended,
        v: &Extended,
        reference: f64,
    ) -> Option<f64> {
        let base = self.without_here(v);
        self.amplitude_over(z, v, reference, (&[v], &[base]))
    }

    fn amplitude_over(
        &mut self,
        z: &Extended,
        v: &Extended,
        reference: f64,
        applied: (&[&Extended], &[Vec<f64>]),
    ) -> Option<f64> {
        let mut x = 1.0;
        let mut out = applied.1.to_vec();
        let (mut too_small, mut too_large) = (0.0_f64, f64::INFINITY);
        for _ in 0..40 {
            let change = self.change(z, v, x, applied, &mut out).map(|change| change / reference);
            match change {
                Ok(m) if (0.05..=5.0).contains(&m) => return Some(x),
                Ok(m) if m < 0.05 => {
                    too_small = too_small.max(x);
                    x *= 8.0;
                }
                _ => {
                    too_large = too_large.min(x);
                    x /= 8.0;
                }
            }
            if x >= too_large || x <= too_small {
                // between a point that is too small and one that is too large or has no value
                return Some(if too_small > 0.0 { (too_small * too_large).sqrt() } else { x });
            }
            if !(1e-12..=1e12).contains(&x) {
                return None;
            }
        }
        None
    }
}
