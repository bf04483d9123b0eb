//! Eigenvalues `K_n x = μ M x` with the mass `∫(u² + v² + w²) sin S dS`: `μ` is in `χ/R0²` per
//! undeformed area and comparable between wave numbers.

use super::ends::{Ends, Neutral};
use super::{AsymmetricModes, ModeCount, Parity};
use continuation::Matrix;
use continuation::linalg::SymmetricBand;
use std::f64::consts::PI;

/// Inverse iterations: more are of no use, a cluster then holds any vector of its space.
const ITERATIONS: usize = 60;

/// What a vector to begin with gets of one without any symmetry, relative to its largest entry.
const BESIDE: f64 = 1e-3;

/// Relative change of an eigenvalue at which the iteration ends.
const SETTLED: f64 = 1e-13;

/// The same where an eigenvalue only guides a bisection.
pub(super) const LOCATED: f64 = 1e-9;

/// Shifts beyond this are not tried: the stiffest modes that a shell has are far below.
const FARTHEST: f64 = 1e9;

/// Width of a bracket, in `χ/R0²`, at which eigenvalues near zero are told apart by their vectors.
const CLOSE: f64 = 1e-10;

/// A mode's amplitudes at the knots, so normalised that `w` (or, where `w` vanishes, the largest
/// component) is at most one in size and positive there.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeShape {
    /// Knots.
    pub s: Vec<f64>,
    /// Radial amplitude, times `cos nφ`.
    pub u: Vec<f64>,
    /// Amplitude around the axis, times `sin nφ`.
    pub v: Vec<f64>,
    /// Axial amplitude, times `cos nφ`.
    pub w: Vec<f64>,
}

impl ModeShape {
    /// The same from pole to pole.
    pub(crate) fn mirrored(&self, parity: Parity) -> ModeShape {
        let even = if parity == Parity::Symmetric { 1.0 } else { -1.0 };
        // w is upwards in both halves
        let field = |own: &[f64], sign: f64| -> Vec<f64> {
            let below = own.iter().rev().skip(1).map(|x| sign * x);
            own.iter().copied().chain(below).collect()
        };
        let below = self.s.iter().rev().skip(1).map(|s| PI - s);
        ModeShape {
            s: self.s.iter().copied().chain(below).collect(),
            u: field(&self.u, even),
            v: field(&self.v, even),
            w: field(&self.w, -even),
        }
    }

    pub(super) fn normalised(mut self) -> ModeShape {
        let largest =
            |x: &[f64]| x.iter().fold(0.0_f64, |m, &x| if x.abs() > m.abs() { x } else { m });
        let all = [largest(&self.u), largest(&self.v)];
        let mut by = largest(&self.w);
        if by.abs() < 1e-6 * largest(&all).abs() {
            by = largest(&all);
        }
        if by != 0.0 {
            for x in [&mut self.u, &mut self.v, &mut self.w].into_iter().flatten() {
                *x /= by;
            }
        }
        self
    }
}

/// An eigenvalue and its mode.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// Waves around the axis.
    pub n: usize,
    /// Under reflection.
    pub parity: Parity,
    /// Eigenvalue, `χ/R0²` per undeformed area.
    pub value: f64,
    /// Amplitudes.
    pub shape: ModeShape,
}

impl AsymmetricModes<'_> {
    /// The mode of a class whose eigenvalue is nearest to zero: at an onset, the one that turns.
    /// For `n = 1` neutral motions are excluded by a condition at the pole, which leaves the sign
    /// of the eigenvalue but not its size.
    pub fn nearest_zero(&mut self, n: usize, parity: Parity) -> Mode {
        let ends = self.ends(n, parity, Neutral::Pinned);
        self.negative_below(&ends, n, 0.0);
        let mut x = Vec::new();
        let value = self.inverse_iteration(&ends, n, 0.0, &mut x);
        Mode { n, parity, value, shape: self.shape(&ends, n, &x) }
    }

    /// The count of a class and its eigenvalue nearest to zero, whose mode `x` becomes; the search
    /// begins with what `x` was, unless it is empty.
    pub(super) fn count_and_value(
        &mut self,
        n: usize,
        parity: Parity,
        x: &mut Vec<f64>,
    ) -> (ModeCount, f64) {
        let ends = self.ends(n, parity, Neutral::Pinned);
        let count = self.negative_below(&ends, n, 0.0);
        (count, self.iterate(&ends, n, 0.0, LOCATED, x))
    }

    /// The amplitudes of a mode found by `count_and_value`.
    pub(super) fn shape_of(&self, n: usize, parity: Parity, x: &[f64]) -> ModeShape {
        self.shape(&self.ends(n, parity, Neutral::Pinned), n, x)
    }

    /// The mode of smallest eigenvalue of a class; for `n = 1` as in
    /// [`AsymmetricModes::nearest_zero`]. `None` if the inertia cannot be told.
    pub fn lowest(&mut self, n: usize, parity: Parity) -> Option<Mode> {
        let ends = self.ends(n, parity, Neutral::Pinned);
        let (value, x) = self.eigenpair(&ends, n, 0)?;
        Some(Mode { n, parity, value, shape: self.shape(&ends, n, &x) })
    }

    /// Eigenvalues number `0, …, count − 1` of a class, neutral motions of `n = 1` included.
    /// `None` if the inertia cannot be told.
    pub fn spectrum(&mut self, n: usize, parity: Parity, count: usize) -> Option<Vec<f64>> {
        let ends = self.ends(n, parity, Neutral::Kept);
        (0..count).map(|k| Some(self.eigenpair(&ends, n, k)?.0)).collect()
    }

    /// Eigenpair number `k` by bisection on the inertia and inverse iteration.
    fn eigenpair(&mut self, ends: &Ends, n: usize, k: usize) -> Option<(f64, Vec<f64>)> {
        // a bracket: no more than k eigenvalues below lo, more than k below hi
        let (mut lo, mut hi) = (f64::NEG_INFINITY, f64::INFINITY);
        for sign in [-1.0, 1.0] {
            let mut step = 1e-3;
            while step < FARTHEST && (lo.is_infinite() || hi.is_infinite()) {
                let (at, below) = self.count_beside(ends, n, sign * step, step)?;
                if below > k {
                    hi = hi.min(at)
                } else {
                    lo = lo.max(at)
                }
                if (below > k) == (sign > 0.0) {
                    break;
                }
                step *= 2.0;
            }
        }
        if lo.is_infinite() || hi.is_infinite() {
            return None;
        }
        while hi - lo > 1e-3 * (lo.abs() + hi.abs()) && hi - lo > CLOSE {
            let (at, below) = self.count_beside(ends, n, 0.5 * (lo + hi), hi - lo)?;
            if below > k { hi = at } else { lo = at }
        }
        let shift = 0.5 * (lo + hi);
        self.negative_below(ends, n, shift);
        let mut x = Vec::new();
        let value = self.inverse_iteration(ends, n, shift, &mut x);
        Some((value, x))
    }

    /// The number of eigenvalues below a shift near `wanted`: where the elimination without
    /// pivoting grows, or the shift is an eigenvalue, another one within a fifth of `width` does.
    fn count_beside(
        &mut self,
        ends: &Ends,
        n: usize,
        wanted: f64,
        width: f64,
    ) -> Option<(f64, usize)> {
        [0.0, 0.07, -0.11, 0.19, -0.02].into_iter().find_map(|share| {
            let at = wanted + share * width;
            let count = self.negative_below(ends, n, at);
            count.certain.then_some((at, count.negative))
        })
    }

    /// The eigenpair nearest to `shift`, at which the matrix has just been factored; begins with
    /// the vector `x`, unless it is empty, and leaves the mode in it.
    fn inverse_iteration(&mut self, ends: &Ends, n: usize, shift: f64, x: &mut Vec<f64>) -> f64 {
        let value = self.iterate(ends, n, shift, SETTLED, x);
        self.rayleigh(ends, n, x).unwrap_or(value)
    }

    /// The same until the eigenvalue, an inverse Rayleigh quotient whose error is the square of the
    /// vector's, changes by less than `tolerance`, relative.
    fn iterate(
        &mut self,
        ends: &Ends,
        n: usize,
        shift: f64,
        tolerance: f64,
        x: &mut Vec<f64>,
    ) -> f64 {
        self.masses.matrix(ends, n, &mut self.mass);
        let AsymmetricModes { mass, band, scale, .. } = self;
        iterate(mass, |x| super::solve(band, scale, x), shift, tolerance, x)
    }

    /// `xᵀKx/xᵀMx`, whose error is the square of the vector's. The band's factors are lost.
    fn rayleigh(&mut self, ends: &Ends, n: usize, x: &[f64]) -> Option<f64> {
        self.matrix(ends, n);
        let mut y = vec![0.0; x.len()];
        self.mass.mul(x, &mut y);
        let mass = dot(x, &y);
        self.band.mul(x, &mut y);
        let value = dot(x, &y) / mass;
        value.is_finite().then_some(value)
    }

    fn shape(&self, ends: &Ends, n: usize, x: &[f64]) -> ModeShape {
        let knots = self.mesh.knots();
        let elements = knots.elements();
        let s: Vec<f64> = (0..=elements).map(|j| knots.at(j)).collect();
        let field = |f: usize| -> Vec<f64> {
            if n == 0 && f == 1 {
                return vec![0.0; elements + 1];
            }
            s.iter()
                .enumerate()
                .map(|(j, &s)| {
                    let e = j.min(elements - 1);
                    let basis = knots.basis(e, s)[0];
                    let value = |i: usize| {
                        let slot = ends.slot(f, e as isize - 1 + i as isize);
                        slot.terms().iter().map(|&(i, c)| c * x[i]).sum::<f64>()
                    };
                    (0..4).map(|i| basis[i] * value(i)).sum()
                })
                .collect()
        };
        ModeShape { u: field(0), v: field(1), w: field(2), s }.normalised()
    }
}

/// The eigenvalue nearest to `shift` of a matrix `K` with the mass, `solve` being `(K − shift M)⁻¹`, until
/// it changes by less than `tolerance`, relative; begins with the vector `x`, unless it is empty, and
/// leaves the mode in it.
pub(super) fn iterate(
    mass: &SymmetricBand,
    mut solve: impl FnMut(&mut [f64]),
    shift: f64,
    tolerance: f64,
    x: &mut Vec<f64>,
) -> f64 {
    let dim = mass.dim();
    // any vector without symmetry; M keeps it to the unknowns of the class
    let start = |i: usize| 1.0 + ((i * 7919) % 1009) as f64 / 1009.0;
    // some of it in any case: the mode that was nearest to zero may have been another
    let largest = x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let known = x.len() == dim && largest > 0.0 && largest.is_finite();
    let share = if known { BESIDE * largest } else { 1.0 };
    if !known {
        x.clear();
        x.resize(dim, 0.0);
    }
    x.iter_mut().enumerate().for_each(|(i, x)| *x += share * start(i));
    let mut y = vec![0.0; dim];
    let mut value = f64::NAN;
    for _ in 0..ITERATIONS {
        mass.mul(x, &mut y);
        let size = dot(x, &y).sqrt();
        y.iter_mut().for_each(|y| *y /= size);
        x.copy_from_slice(&y);
        solve(x);
        // y = Mx̂ of unit size: 1/(μ − shift) = yᵀ K⁻¹ y
        let next = shift + 1.0 / (dot(x, &y));
        let settled = (next - value).abs() <= tolerance * (next.abs() + shift.abs());
        value = next;
        if settled {
            break;
        }
    }
    value
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
