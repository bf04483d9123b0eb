//! How many eigenvalues lie to the right of the imaginary axis, by the argument principle.
//!
//! Along the imaginary axis `arg det(iω M − A)` grows by `π/2` from `ω = 0` to infinity for each
//! eigenvalue on the left and falls by as much for each on the right, so that
//!
//! ```text
//! right = n/2 − (1/π) ∫₀^∞ (d/dω) arg det(iω M − A) dω.
//! ```
//!
//! The determinant's argument comes from complex factors, its slope from a second factorisation
//! beside the first. With `R = (iω M − A)⁻¹ M` no eigenvalue is nearer to `iω` than
//! `ρ = 1/‖R‖₂`, and within that disc `|d³ arg det/dω³| ≤ 2 ‖R‖_F² ‖R‖₂`; steps are so short that the
//! trapezoidal rule of the slopes, which knows nothing of turns by `2π`, is then right to 0.3, and the
//! argument itself must agree with it. The two norms are estimated from above, from products with
//! random vectors; the sum must be an integer to 0.1.

use faer::c64;
use std::f64::consts::{PI, TAU};

use super::sparse::Sparse;
use super::sparse_lu::{Columns, SparseLu};
use super::{Matrix, scalar};

/// Longest step over the radius of the disc without eigenvalues.
const LONGEST: f64 = 0.25;
/// Largest error of the trapezoidal rule over a step, by its bound.
const BOUND: f64 = 0.3;
/// Largest difference between an argument and what the rule says.
const AGREEMENT: f64 = 0.6;
/// Products with `Rᴴ R` from which the norm of `R` is estimated, and the factor on the estimate: whatever
/// the spectrum, the chance that it is too small is about `2·10⁻⁸ √n` at most (the power method from a
/// random start; J. Kuczyński and H. Woźniakowski, *SIAM J. Matrix Anal. Appl.* 13 (1992) 1094-1122).
const PRODUCTS: usize = 12;
const SAFETY: f64 = 2.0;
/// An eigenvalue within this many roundings of the matrix from the axis is on neither side.
const ROUNDINGS: f64 = 64.0;
/// Then the line is moved to the right by this many times that distance.
const ASIDE: f64 = 8.0;
/// Distance of the second factorisation over the radius.
const BESIDE: f64 = 1e-4;
/// Distance from zero over the radius above which the nearest eigenvalue is of a pair: of a real one they
/// are as one, or two with the factor on the estimate.
const PAIR: f64 = 4.0;
/// Most nodes; beyond it nothing is said.
const MOST_NODES: usize = 4000;
/// Most multiplications of one factorisation; beyond it nothing is said.
const MOST_WORK: f64 = 2e9;

/// A count of eigenvalues, and what it cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfPlane {
    /// Eigenvalues with a positive real part, each as often as its multiplicity, without those on the
    /// axis.
    pub right: usize,
    /// Whether an eigenvalue lies on the imaginary axis, to rounding.
    pub critical: bool,
    /// Where a complex pair comes nearest to the imaginary axis: about the imaginary part of one that is
    /// much nearer to the axis than to zero, if there is any.
    pub pair: Option<f64>,
    /// Complex factorisations, each about five times as dear as a real one.
    pub factorisations: usize,
}

/// Counts the eigenvalues of `A x = λ M x` with a positive real part; `M` is the identity, or symmetric
/// and positive definite, which the caller knows.
///
/// The cost grows with the logarithm of the largest eigenvalue over the distance of the nearest one from
/// the axis: 300 to 500 factorisations, in the order that keeps them sparse.
///
/// Where an eigenvalue lies on the axis to rounding, those are counted that lie to the right of a line
/// close beside it. `None` where one lies there too, where matrices have no list of entries
/// ([`Matrix::entries`]), or where it would be too dear.
///
/// ```
/// use continuation::linalg::{Band, count_right};
/// // diffusion with growth: 3 − 4/h² sin²(kπh/2) is positive for k = 1 only if h is small
/// let n = 2000;
/// let h = std::f64::consts::PI / (n + 1) as f64;
/// let mut a = Band::new(n, 1, 1);
/// for i in 0..n {
///     a.set(i, i, 3.0 - 2.0 / (h * h));
///     if i > 0 {
///         a.set(i, i - 1, 1.0 / (h * h) - 0.3 / h); // with drift: not symmetric
///         a.set(i - 1, i, 1.0 / (h * h) + 0.3 / h);
///     }
/// }
/// assert_eq!(count_right(&a, None).map(|count| count.right), Some(1));
/// ```
pub fn count_right<A: Matrix>(a: &A, mass: Option<&A>) -> Option<HalfPlane> {
    let mut axis = Axis::new(a, mass)?;
    match axis.count() {
        Err(Unsaid::OnTheAxis(omega)) => {
            axis.shift = ASIDE * axis.rounding;
            let found = axis.count().ok()?;
            let pair = if omega > 0.0 { Some(omega) } else { found.pair };
            Some(HalfPlane { critical: true, pair, ..found })
        }
        found => found.ok(),
    }
}

/// Why there is no count.
enum Unsaid {
    /// An eigenvalue about here, too near to the line.
    OnTheAxis(f64),
    Unknown,
}

/// A place on the axis.
#[derive(Clone, Copy)]
struct Node {
    omega: f64,
    /// `arg det`, modulo `2π`, and its derivative.
    argument: f64,
    slope: f64,
    /// No eigenvalue is nearer than this.
    radius: f64,
    /// `ρ² ‖R‖_F²`: about how many eigenvalues are as near as the nearest.
    near: f64,
}

struct Axis {
    /// Real part of the line along which is integrated.
    shift: f64,
    /// Distances from the line that are rounding.
    rounding: f64,
    a: Sparse,
    mass: Sparse,
    identity: bool,
    lu: SparseLu<c64>,
    values: Vec<c64>,
    scale: Vec<f64>,
    x: Vec<c64>,
    y: Vec<c64>,
    scratch: Vec<c64>,
    random: u64,
    factorisations: usize,
}

impl Axis {
    fn new<A: Matrix>(a: &A, mass: Option<&A>) -> Option<Self> {
        let n = a.dim();
        let mut pattern = Vec::new();
        let mut listed = a.entries(&mut |i, j, _| pattern.push((i, j)));
        if let Some(mass) = mass {
            listed &= mass.entries(&mut |i, j, _| pattern.push((i, j)));
        }
        if !listed {
            return None;
        }
        let mut plain = Sparse::new(n, &pattern).ok()?;
        let mut weight = plain.clone();
        plain.add_entries(a);
        match mass {
            Some(mass) => weight.add_entries(mass),
            None => weight.fill_diagonal(1.0),
        }
        let lu = plain.complex_lu();
        Some(Axis {
            shift: 0.0,
            rounding: 0.0,
            values: vec![c64::ZERO; plain.values().len()],
            scale: vec![0.0; n],
            x: vec![c64::ZERO; n],
            y: vec![c64::ZERO; n],
            scratch: vec![c64::ZERO; n],
            lu,
            a: plain,
            mass: weight,
            identity: mass.is_none(),
            random: 1,
            factorisations: 0,
        })
    }

    fn count(&mut self) -> Result<HalfPlane, Unsaid> {
        let n = self.a.dim() as f64;
        // all eigenvalues are smaller
        let largest = self.a.row_sums() * self.inverse_mass().ok_or(Unsaid::Unknown)?;
        self.rounding = ROUNDINGS * f64::EPSILON * largest;
        if !largest.is_finite() || largest <= 0.0 {
            return Err(Unsaid::Unknown);
        }
        // beyond it the rest of the integral is the first term of its expansion, to 0.02
        let end = largest * f64::max(2.0, (17.0 * n).cbrt());
        let mut node = self.node(0.0)?;
        let (mut sum, mut nodes) = (0.0, 1);
        let (mut step, mut pair) = (f64::INFINITY, None);
        while node.omega < end {
            step = step.min(node.step());
            let next = self.node(node.omega + step)?;
            nodes += 1;
            if nodes > MOST_NODES {
                return Err(Unsaid::Unknown);
            }
            let rule = 0.5 * step * (node.slope + next.slope);
            let turn = next.argument - node.argument - rule;
            let off = turn - TAU * (turn / TAU).round();
            if off.abs() > AGREEMENT || step > 2.0 * next.step() {
                step *= 0.5;
                continue;
            }
            sum += rule + off;
            if next.omega > PAIR * next.radius && pair.is_none_or(|(_, r)| next.radius < r) {
                pair = Some((next.omega, next.radius));
            }
            (node, step) = (next, f64::INFINITY);
        }
        let rest = node.slope * node.omega;
        let right = 0.5 * n - (sum + rest) / PI;
        let whole = right.round();
        if (right - whole).abs() > 0.1 || !(0.0..=n).contains(&whole) {
            return Err(Unsaid::Unknown);
        }
        Ok(HalfPlane {
            right: whole as usize,
            critical: false,
            pair: pair.map(|(omega, _)| omega),
            factorisations: self.factorisations,
        })
    }

    /// `‖M⁻¹‖₂`, from above.
    fn inverse_mass(&mut self) -> Option<f64> {
        if self.identity {
            return Some(1.0);
        }
        let mut mass = self.mass.clone();
        let facts = mass.factor(f64::EPSILON * mass.norm());
        let mut x = vec![0.0; self.a.dim()];
        x.iter_mut().for_each(|x| *x = self.between());
        let mut size = 0.0;
        for _ in 0..PRODUCTS {
            let length = scalar::norm(&x);
            x.iter_mut().for_each(|x| *x /= length);
            mass.solve(&mut x);
            size = f64::max(size, scalar::norm(&x));
        }
        (facts.perturbed == 0).then_some(SAFETY * size)
    }

    fn node(&mut self, omega: f64) -> Result<Node, Unsaid> {
        let argument = self.factor(omega)?;
        let (norm, frobenius) = self.norms();
        let radius = 1.0 / norm;
        if !(radius.is_finite() && radius > self.rounding) {
            return Err(Unsaid::OnTheAxis(omega));
        }
        let beside = BESIDE * radius;
        let turn = self.factor(omega + beside)? - argument;
        let slope = (turn - TAU * (turn / TAU).round()) / beside;
        Ok(Node {
            omega,
            argument,
            slope,
            radius,
            near: f64::max(1.0, radius * radius * frobenius),
        })
    }

    /// Factors `(σ + iω) M − A`; the argument of its determinant.
    fn factor(&mut self, omega: f64) -> Result<f64, Unsaid> {
        let parts = self.a.values().iter().zip(self.mass.values());
        for (value, (a, m)) in self.values.iter_mut().zip(parts) {
            *value = c64::new(self.shift * m - a, omega * m);
        }
        let (start, rows) = self.a.pattern();
        self.scale.fill(0.0);
        for (i, value) in rows.iter().zip(&self.values) {
            self.scale[*i] = self.scale[*i].max(value.norm());
        }
        self.scale.iter_mut().filter(|scale| **scale == 0.0).for_each(|scale| *scale = 1.0);
        let columns = Columns { start, rows, values: &self.values };
        let found = self.lu.factor(columns, &self.scale, f64::MIN_POSITIVE);
        self.factorisations += 1;
        if self.lu.work() > MOST_WORK {
            return Err(Unsaid::Unknown);
        }
        if found.perturbed > 0 {
            return Err(Unsaid::OnTheAxis(omega));
        }
        Ok(found.direction.arg())
    }

    /// `‖R‖₂` and `‖R‖_F²`, from above.
    fn norms(&mut self) -> (f64, f64) {
        for k in 0..self.x.len() {
            self.x[k] = c64::new(self.between(), self.between());
        }
        let Self { x, y, scratch, lu, mass, .. } = self;
        let (mut norm, mut frobenius) = (0.0, 0.0);
        for product in 0..PRODUCTS {
            let length = scalar::norm(x);
            x.iter_mut().for_each(|x| *x /= length);
            // R x
            mass.times(x, y);
            lu.solve(y, scratch);
            let size = scalar::norm(y);
            norm = f64::max(norm, size);
            if product == 0 {
                frobenius = x.len() as f64 * size * size;
            }
            // Rᴴ R x
            y.iter_mut().for_each(|y| *y = y.conj());
            lu.solve_transpose(y, scratch);
            y.iter_mut().for_each(|y| *y = y.conj());
            mass.times(y, x);
            norm = f64::max(norm, scalar::norm(x).sqrt());
        }
        let norm = SAFETY * norm;
        (norm, f64::max(SAFETY * SAFETY * frobenius, norm * norm))
    }

    /// A random number from −1 to 1.
    fn between(&mut self) -> f64 {
        self.random = self
            .random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.random >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

impl Node {
    /// Longest step for which the rule is right.
    fn step(&self) -> f64 {
        // h³/12 · 2 ‖R‖_F² ‖R‖₂
        self.radius * f64::min(LONGEST, (6.0 * BOUND / self.near).cbrt())
    }
}
