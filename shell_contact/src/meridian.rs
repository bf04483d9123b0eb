//! The reference meridian: mesh, Gauss points with their basis values, mass matrix.
//!
//! Gauss points are kept in groups of four (one [`Lanes`] each); an element with a count that is
//! no multiple of four is filled up with copies of its last point of weight zero.

use crate::half::HalfMeridian;
use crate::params::ParameterError;
use crate::quadrature::{FEWEST, MOST, gauss_legendre};
use crate::scalar::{Lanes, Scalar, WIDTH};
use crate::spline::{Basis, Component, HALF_BANDWIDTH, Knots};
use continuation::linalg::SymmetricBand;
use continuation::linalg::kernel::Arithmetic;
use std::f64::consts::FRAC_PI_2;

/// Gauss points per element unless asked otherwise.
pub const DEFAULT_GAUSS_POINTS: usize = 4;

/// Four Gauss points of an element.
#[derive(Debug, Clone)]
pub struct Cell {
    /// Basis functions `[derivative 0, 1, 2][function]`.
    pub basis: [[Lanes; 4]; 3],
    /// Weights in `dS`.
    pub weight: Lanes,
    /// `sin S`.
    pub sin: Lanes,
    /// `cos S`.
    pub cos: Lanes,
    /// `1/sin S`.
    pub csc: Lanes,
}

/// `σ, σ', σ''` and `z, z', z''` at a place.
#[derive(Debug, Clone, Copy)]
pub struct Place<T> {
    /// `σ` and its derivatives.
    pub s: [T; 3],
    /// `z` and its derivatives.
    pub z: [T; 3],
}

/// Spline coefficients of one element, as differences to the second one: derivatives then lose
/// no digits to the size of the displacement.
#[derive(Debug, Clone, Copy)]
pub struct Local {
    u: [f64; 4],
    w: [f64; 4],
    u_base: f64,
    w_base: f64,
}

impl Local {
    /// From the four coefficients of `u` and of `w`.
    #[inline(always)]
    pub(crate) fn new((mut u, mut w): ([f64; 4], [f64; 4])) -> Local {
        let (u_base, w_base) = (u[1], w[1]);
        for k in 0..4 {
            u[k] -= u_base;
            w[k] -= w_base;
        }
        Local { u, w, u_base, w_base }
    }

    /// The coefficients of `u` and of `w` as differences to the second one, and that one.
    pub(crate) fn parts(&self) -> [([f64; 4], f64); 2] {
        [(self.u, self.u_base), (self.w, self.w_base)]
    }

    /// Largest coefficient of `w`, a bound for `w` in the element.
    #[inline(always)]
    pub fn w_bound(&self) -> f64 {
        // one after the other: as pairs they become an instruction that older valgrinds do not know
        let max = |a: f64, b: f64| if a > b { a } else { b };
        self.w_base + max(self.w[3], max(self.w[2], max(self.w[0], 0.0)))
    }

    /// `w` where the functions have these values.
    pub(crate) fn height(&self, functions: &[f64; 4]) -> f64 {
        self.w_base + functions.iter().zip(&self.w).map(|(b, c)| b * c).sum::<f64>()
    }

    /// `(u, w)` and three derivatives where the functions have the values `basis`.
    pub(crate) fn displacement(&self, basis: &Basis) -> [(f64, f64); 4] {
        let derivative = |k: usize| {
            let dot = |c: &[f64; 4]| (0..4).map(|j| basis[k][j] * c[j]).sum::<f64>();
            let base = if k == 0 { (self.u_base, self.w_base) } else { (0.0, 0.0) };
            (base.0 + dot(&self.u), base.1 + dot(&self.w))
        };
        [0, 1, 2, 3].map(derivative)
    }
}

/// A derivative of the functions against coefficients, of which the second is zero.
#[inline(always)]
fn dot<A: Arithmetic>(b: &[Lanes; 4], c: &[f64; 4]) -> Lanes {
    let (first, third, last) = (b[0] * c[0], Lanes::constant(c[2]), Lanes::constant(c[3]));
    b[3].mul_add::<A>(last, b[2].mul_add::<A>(third, first))
}

impl Cell {
    /// The displacements `(u, w)` and their derivatives, without the reference sphere.
    #[inline(always)]
    pub(crate) fn displacement_by<A: Arithmetic>(&self, c: &Local) -> Place<Lanes> {
        let mut place = Place { s: [Lanes::ZERO; 3], z: [Lanes::ZERO; 3] };
        for k in 0..3 {
            place.s[k] = dot::<A>(&self.basis[k], &c.u);
            place.z[k] = dot::<A>(&self.basis[k], &c.w);
        }
        place.s[0] = place.s[0] + c.u_base;
        place.z[0] = place.z[0] + c.w_base;
        place
    }

    /// The deformed meridian.
    #[inline(always)]
    pub(crate) fn place_by<A: Arithmetic>(&self, c: &Local) -> Place<Lanes> {
        let d = self.displacement_by::<A>(c);
        Place {
            s: [self.sin + d.s[0], self.cos + d.s[1], d.s[2] - self.sin],
            z: [self.cos + d.z[0], d.z[1] - self.sin, d.z[2] - self.cos],
        }
    }
}

/// The discretised reference meridian.
#[derive(Debug, Clone)]
pub struct Mesh {
    knots: Knots,
    gauss_points: usize,
    cells_per_element: usize,
    rule: Vec<(f64, f64)>,
    cells: Vec<Cell>,
    cos_knots: Vec<f64>,
    mass: SymmetricBand,
}

impl Mesh {
    /// `elements` equal elements.
    ///
    /// # Errors
    /// When there are fewer than eight.
    pub fn uniform(elements: usize) -> Result<Mesh, ParameterError> {
        Mesh::graded(elements, 1.0)
    }

    /// Elements that grow smoothly from the pole to the equator, where they are
    /// `pole_concentration` times as long: `S = (π/2) sinh(βx)/sinh β`, `cosh β` the concentration.
    ///
    /// # Errors
    /// When there are fewer than eight elements, or the concentration is not in `[1, 1000]`.
    pub fn graded(elements: usize, pole_concentration: f64) -> Result<Mesh, ParameterError> {
        if !(1.0..=1000.0).contains(&pole_concentration) {
            return Err(ParameterError::OutOfRange {
                key: "pole_concentration",
                value: pole_concentration,
                allowed: "from 1 to 1000",
                remedy: "1 is a uniform mesh",
            });
        }
        if elements < crate::spline::FEWEST_ELEMENTS {
            return Err(ParameterError::too_few_elements(elements));
        }
        let beta = pole_concentration.acosh();
        let knots: Vec<f64> = (0..=elements)
            .map(|i| {
                let x = i as f64 / elements as f64;
                let share = if beta < 1e-6 { x } else { (beta * x).sinh() / beta.sinh() };
                FRAC_PI_2 * share
            })
            .collect();
        Mesh::from_knots(&knots)
    }

    /// Any increasing knots from 0 to `π/2`.
    ///
    /// # Errors
    /// When the knots are not that, or make fewer than eight elements.
    pub fn from_knots(knots: &[f64]) -> Result<Mesh, ParameterError> {
        Ok(Mesh::build(Knots::new(knots)?, DEFAULT_GAUSS_POINTS))
    }

    /// [`Knots::trusted`].
    pub(crate) fn from_trusted(elements: usize, f: impl Fn(usize) -> f64) -> Mesh {
        Mesh::build(Knots::trusted(elements, f), DEFAULT_GAUSS_POINTS)
    }

    /// The same knots with another number of Gauss points per element, 2 to 8.
    ///
    /// # Errors
    /// When the number is outside that range.
    pub fn with_gauss_points(self, count: usize) -> Result<Mesh, ParameterError> {
        if !(FEWEST..=MOST).contains(&count) {
            return Err(ParameterError::OutOfRange {
                key: "gauss_points",
                value: count as f64,
                allowed: "from 2 to 8",
                remedy: "4 is ample for cubic splines",
            });
        }
        Ok(Mesh::build(self.knots, count))
    }

    fn build(knots: Knots, gauss_points: usize) -> Mesh {
        let cells_per_element = gauss_points.div_ceil(WIDTH);
        let empty = Cell {
            basis: [[Lanes::ZERO; 4]; 3],
            weight: Lanes::ZERO,
            sin: Lanes::ZERO,
            cos: Lanes::ZERO,
            csc: Lanes::ZERO,
        };
        let cells = vec![empty; knots.elements() * cells_per_element];
        let mass = SymmetricBand::new(2 * knots.elements(), HALF_BANDWIDTH);
        let cos_knots = vec![0.0; knots.elements() + 1];
        let rule = gauss_legendre(gauss_points);
        let mut mesh =
            Mesh { knots, gauss_points, cells_per_element, rule, cells, cos_knots, mass };
        mesh.fill();
        mesh.assemble_mass();
        mesh
    }

    /// Computes the cells from the knots.
    fn fill(&mut self) {
        let Mesh { knots, gauss_points, cells_per_element, rule, cells, cos_knots, .. } = self;
        for (j, cos) in cos_knots.iter_mut().enumerate() {
            *cos = knots.at(j).cos();
        }
        for (index, cell) in cells.iter_mut().enumerate() {
            let (e, group) = (index / *cells_per_element, index % *cells_per_element);
            let (start, length) = (knots.at(e), knots.at(e + 1) - knots.at(e));
            for lane in 0..WIDTH {
                let g = group * WIDTH + lane;
                let (x, weight) = rule[g.min(*gauss_points - 1)];
                let s = start + length * x;
                // nothing is summed over an element of no length
                let basis = if length > 0.0 { knots.basis(e, s) } else { [[0.0; 4]; 4] };
                for k in 0..3 {
                    for j in 0..4 {
                        cell.basis[k][j].0[lane] = basis[k][j];
                    }
                }
                cell.weight.0[lane] = if g < *gauss_points { weight * length } else { 0.0 };
                let (sin, cos) = s.sin_cos();
                cell.sin.0[lane] = sin;
                cell.cos.0[lane] = cos;
                cell.csc.0[lane] = 1.0 / sin;
            }
        }
    }

    /// Moves the knots to `f(0), …, f(N)` ([`Knots::trusted`]), and all that follows from them but the mass
    /// matrix, which stays that of the mesh as it was made. Allocates nothing.
    pub(crate) fn move_knots(&mut self, f: impl Fn(usize) -> f64) {
        self.knots.move_to(f);
        self.fill();
    }

    /// Points in `[0, 1]` and weights of the Gauss rule of an element.
    pub(crate) fn rule(&self) -> &[(f64, f64)] {
        &self.rule
    }

    fn assemble_mass(&mut self) {
        let mut mass = SymmetricBand::new(self.unknowns(), HALF_BANDWIDTH);
        add_mass(self, 1.0, &mut mass);
        self.mass = mass;
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.knots.elements()
    }

    /// Number of unknowns, two per element.
    pub fn unknowns(&self) -> usize {
        2 * self.elements()
    }

    /// Gauss points per element.
    pub fn gauss_points(&self) -> usize {
        self.gauss_points
    }

    /// The knots.
    pub fn knots(&self) -> &Knots {
        &self.knots
    }

    /// Cosine of knot `j`, the largest in element `j`.
    #[inline(always)]
    pub fn cos_knot(&self, j: usize) -> f64 {
        self.cos_knots[j]
    }

    /// `∫(u² + w²) sin S dS` as a matrix over the unknowns.
    pub fn mass(&self) -> &SymmetricBand {
        &self.mass
    }

    /// The Gauss points of element `e`.
    #[inline(always)]
    pub fn cells(&self, e: usize) -> &[Cell] {
        let k = self.cells_per_element;
        &self.cells[e * k..(e + 1) * k]
    }

    /// The coefficients element `e` sees.
    #[inline(always)]
    pub fn local(&self, x: &[f64], e: usize) -> Local {
        Local::new(self.knots.gather(x, e))
    }

    /// The deformed meridian at any `S`.
    pub fn place(&self, x: &[f64], s: f64) -> Place<f64> {
        HalfMeridian::place(self, x, s)
    }

    /// `(u, w)` and three derivatives at `S` in element `e`.
    pub fn displacement_in(&self, x: &[f64], e: usize, s: f64) -> [(f64, f64); 4] {
        HalfMeridian::displacement_in(self, x, e, s)
    }

    /// Adds the element vector `local` (ordered `u, w` by function) to `out`.
    #[inline(always)]
    pub fn scatter(&self, e: usize, local: &[f64; 8], out: &mut [f64]) {
        if self.knots.is_interior(e) {
            let first = 2 * e - 3;
            if let Some(out) = out.get_mut(first..first + 8) {
                for k in 0..8 {
                    out[k] += local[k];
                }
            }
        } else {
            for (k, value) in local.iter().enumerate() {
                if let Some((i, sign)) = self.slot(e, k) {
                    out[i] += sign * value;
                }
            }
        }
    }

    /// Adds the element matrix `local`, stored `[column][row]` for `row ≥ column`, to `out`.
    #[inline(always)]
    pub fn scatter_matrix(&self, e: usize, local: &[[f64; 8]; 8], out: &mut SymmetricBand) {
        if self.knots.is_interior(e) {
            let first = 2 * e - 3;
            for column in 0..8 {
                let entries = out.column_mut(first + column);
                for (entry, value) in entries.iter_mut().zip(&local[column][column..]) {
                    *entry += value;
                }
            }
        } else {
            self.scatter_end(e, local, out);
        }
    }

    #[cold]
    fn scatter_end(&self, e: usize, local: &[[f64; 8]; 8], out: &mut SymmetricBand) {
        for column in 0..8 {
            let Some((j, sign_j)) = self.slot(e, column) else { continue };
            for row in column..8 {
                let Some((i, sign_i)) = self.slot(e, row) else { continue };
                // two mirrored functions are one unknown: both triangles fall on its diagonal
                let twice = if i == j && row != column { 2.0 } else { 1.0 };
                out.add(i.max(j), i.min(j), twice * sign_i * sign_j * local[column][row]);
            }
        }
    }

    fn slot(&self, e: usize, k: usize) -> Option<(usize, f64)> {
        let component = if k.is_multiple_of(2) { Component::U } else { Component::W };
        self.knots.slot(component, e as isize - 1 + (k / 2) as isize)
    }
}

/// Adds `factor ∫(u² + w²) sin S dS` over a half, as a matrix over the unknowns.
pub(crate) fn add_mass(half: &impl HalfMeridian, factor: f64, out: &mut SymmetricBand) {
    for e in 0..half.elements() {
        let mut local = [[0.0; 8]; 8];
        for cell in half.cells(e) {
            let area = cell.weight * cell.sin;
            for i in 0..4 {
                for j in 0..=i {
                    let m = factor * (area * cell.basis[0][i] * cell.basis[0][j]).sum();
                    local[2 * j][2 * i] += m;
                    local[2 * j + 1][2 * i + 1] += m;
                }
            }
        }
        half.scatter_matrix(e, &local, out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::close;
    use continuation::linalg::Matrix;
    use continuation::linalg::kernel::{Fused, Separate};

    /// ∫(u² + w²) sin S dS by sampling against x·Mx.
    #[test]
    fn mass_matrix_is_the_integral() {
        for count in [4, 5, 7] {
            let mesh = Mesh::graded(12, 3.0).unwrap().with_gauss_points(count).unwrap();
            let n = mesh.unknowns();
            let x: Vec<f64> = (0..n).map(|i| (0.3 + i as f64 * 0.9).sin()).collect();
            let mut y = vec![0.0; n];
            mesh.mass().mul(&x, &mut y);
            let product: f64 = x.iter().zip(&y).map(|(a, b)| a * b).sum();
            let samples = 200_000;
            let h = FRAC_PI_2 / samples as f64;
            let sum: f64 = (0..samples)
                .map(|i| {
                    let s = (i as f64 + 0.5) * h;
                    let (u, w) = mesh.displacement_in(&x, mesh.knots().element_of(s), s)[0];
                    (u * u + w * w) * s.sin() * h
                })
                .sum();
            close(product, sum, 1e-6, 0.0);
        }
    }

    #[test]
    fn cells_hold_what_the_spline_says() {
        let mesh = Mesh::graded(10, 4.0).unwrap();
        let x: Vec<f64> = (0..20).map(|i| 0.1 * (i as f64).cos()).collect();
        for e in 0..10 {
            let local = mesh.local(&x, e);
            for cell in mesh.cells(e) {
                let both = [cell.place_by::<Separate>(&local), cell.place_by::<Fused>(&local)];
                for l in 0..WIDTH {
                    let s = cell.sin.0[l].atan2(cell.cos.0[l]);
                    let place = mesh.place(&x, s);
                    for (lanes, k) in both.iter().flat_map(|lanes| [0, 1, 2].map(|k| (lanes, k))) {
                        close(lanes.s[k].0[l], place.s[k], 1e-11, 1e-12);
                        close(lanes.z[k].0[l], place.z[k], 1e-11, 1e-12);
                    }
                }
            }
        }
    }
}
