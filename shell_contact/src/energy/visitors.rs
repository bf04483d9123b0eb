//! What is computed at the places of a meridian.
//!
//! Their methods are inlined whatever their size: the loop around them is compiled for each width of
//! vectors, a function of its own would be compiled for the narrowest alone.

use crate::density::{self, Coefficients, Gradient, Hessian, Parts, Site};
use crate::film::Potential;
use crate::half::HalfMeridian;
use crate::membrane::Membrane;
use crate::meridian::{Cell, Local, Place};
use crate::scalar::Lanes;
use continuation::EvalError;
use continuation::linalg::SymmetricBand;
use continuation::linalg::kernel::Arithmetic;

/// What is passed over the places of half a meridian, element by element. Methods are to be inlined always.
pub(crate) trait Visitor<H> {
    /// Before the places of element `e`.
    #[inline(always)]
    fn begin(&mut self, _half: &H, _e: usize) {}

    /// Four places of it.
    fn cell<A: Arithmetic>(&mut self, cell: &Cell, place: &Place<Lanes>);

    /// After them.
    #[inline(always)]
    fn end(&mut self, _half: &H, _e: usize) -> Result<(), EvalError> {
        Ok(())
    }
}

/// What has a value at each place, weight included. To be inlined always.
pub trait ValueAt {
    /// The values at four places.
    fn at(&self, site: &Site<Lanes>, place: &Place<Lanes>) -> Lanes;
}

/// What has a gradient at each place, weight included. To be inlined always.
pub trait GradientAt {
    /// The gradients at four places.
    fn at(&self, site: &Site<Lanes>, place: &Place<Lanes>) -> Gradient<Lanes>;
}

/// What has a slope at each place in a direction, weight included. To be inlined always.
pub(crate) trait Direction {
    /// The slopes at four places.
    fn at(&self, site: &Site<Lanes>, place: &Place<Lanes>, along: &Place<Lanes>) -> Lanes;
}

/// Nothing but the checks.
pub(super) struct Clear;

impl<H> Visitor<H> for Clear {
    #[inline(always)]
    fn cell<A: Arithmetic>(&mut self, _cell: &Cell, _place: &Place<Lanes>) {}
}

/// `∫σ² z' dS`.
pub(super) struct Volume(pub(super) Lanes);

impl<H> Visitor<H> for Volume {
    #[inline(always)]
    fn cell<A: Arithmetic>(&mut self, cell: &Cell, p: &Place<Lanes>) {
        self.0 = self.0 + p.s[0] * p.s[0] * p.z[1] * cell.weight;
    }
}

/// `V̂` and its gradient.
pub(super) struct VolumeGradient<'a> {
    sum: Lanes,
    element: [f64; 8],
    out: &'a mut [f64],
}

impl<'a> VolumeGradient<'a> {
    pub(super) fn new(out: &'a mut [f64]) -> Self {
        VolumeGradient { sum: Lanes::ZERO, element: [0.0; 8], out }
    }

    pub(super) fn volume(&self) -> f64 {
        self.sum.sum()
    }
}

impl<H: HalfMeridian> Visitor<H> for VolumeGradient<'_> {
    #[inline(always)]
    fn begin(&mut self, _half: &H, _e: usize) {
        self.element = [0.0; 8];
    }

    #[inline(always)]
    fn cell<A: Arithmetic>(&mut self, cell: &Cell, p: &Place<Lanes>) {
        let ws = p.s[0] * cell.weight;
        let by_z1 = ws * p.s[0] * -0.5;
        let by_s = -(ws * p.z[1]);
        self.sum = self.sum + by_z1 * p.z[1];
        for j in 0..4 {
            self.element[2 * j] += (cell.basis[0][j] * by_s).sum();
            self.element[2 * j + 1] += (cell.basis[1][j] * by_z1).sum();
        }
    }

    #[inline(always)]
    fn end(&mut self, half: &H, e: usize) -> Result<(), EvalError> {
        half.scatter(e, &self.element, self.out);
        Ok(())
    }
}

/// The slope of `V̂`.
pub(super) struct VolumeSlope;

impl Direction for VolumeSlope {
    #[inline(always)]
    fn at(&self, at: &Site<Lanes>, x: &Place<Lanes>, d: &Place<Lanes>) -> Lanes {
        let s = x.s[0];
        -(s * (x.z[1] * d.s[0] + s * d.z[1] * 0.5) * at.weight)
    }
}

/// An integral.
pub(super) struct Integral<'a, I> {
    pub(super) value: &'a I,
    pub(super) sum: Lanes,
}

impl<H, I: ValueAt> Visitor<H> for Integral<'_, I> {
    #[inline(always)]
    fn cell<A: Arithmetic>(&mut self, cell: &Cell, place: &Place<Lanes>) {
        self.sum = self.sum + self.value.at(&cell.site(), place);
    }
}

/// An integral of slopes in a direction of the unknowns.
pub(super) struct Along<'a, D> {
    dx: &'a [f64],
    local: Local,
    value: &'a D,
    sum: Lanes,
}

impl<'a, D> Along<'a, D> {
    pub(super) fn new(half: &impl HalfMeridian, dx: &'a [f64], value: &'a D) -> Self {
        Along { dx, local: half.local(dx, 0), value, sum: Lanes::ZERO }
    }

    pub(super) fn sum(&self) -> f64 {
        self.sum.sum()
    }
}

impl<H: HalfMeridian, D: Direction> Visitor<H> for Along<'_, D> {
    #[inline(always)]
    fn begin(&mut self, half: &H, e: usize) {
        self.local = half.local(self.dx, e);
    }

    #[inline(always)]
    fn cell<A: Arithmetic>(&mut self, cell: &Cell, place: &Place<Lanes>) {
        let along = cell.displacement_by::<A>(&self.local);
        self.sum = self.sum + self.value.at(&cell.site(), place, &along);
    }
}

/// The parts of the energy.
pub(super) struct PartSums<'a, L, F> {
    law: &'a L,
    film: &'a F,
    c: &'a Coefficients,
    total: Parts<Lanes>,
}

impl<'a, L, F> PartSums<'a, L, F> {
    pub(super) fn new(law: &'a L, film: &'a F, c: &'a Coefficients) -> Self {
        let none = Lanes::ZERO;
        let total = Parts { stretching: none, bending: none, film: none, area: none, volume: none };
        PartSums { law, film, c, total }
    }

    /// All but the volume, which is left at zero.
    pub(super) fn total(&self) -> Parts<f64> {
        Parts {
            stretching: self.total.stretching.sum(),
            bending: self.total.bending.sum(),
            film: self.total.film.sum(),
            area: self.total.area.sum(),
            volume: 0.0,
        }
    }
}

impl<H, L: Membrane, F: Potential> Visitor<H> for PartSums<'_, L, F> {
    #[inline(always)]
    fn cell<A: Arithmetic>(&mut self, cell: &Cell, place: &Place<Lanes>) {
        let p = density::parts(self.law, self.film, self.c, &cell.site(), place);
        let total = &mut self.total;
        total.stretching = total.stretching + p.stretching;
        total.bending = total.bending + p.bending;
        total.film = total.film + p.film;
        total.area = total.area + p.area;
    }
}

/// A gradient over the unknowns.
pub(super) struct Sum<'a, G> {
    gradient: &'a G,
    element: [f64; 8],
    out: &'a mut [f64],
}

impl<'a, G> Sum<'a, G> {
    pub(super) fn new(gradient: &'a G, out: &'a mut [f64]) -> Self {
        Sum { gradient, element: [0.0; 8], out }
    }
}

impl<H: HalfMeridian, G: GradientAt> Visitor<H> for Sum<'_, G> {
    #[inline(always)]
    fn begin(&mut self, _half: &H, _e: usize) {
        self.element = [0.0; 8];
    }

    #[inline(always)]
    fn cell<A: Arithmetic>(&mut self, cell: &Cell, place: &Place<Lanes>) {
        sum_vector::<A>(cell, &self.gradient.at(&cell.site(), place), &mut self.element);
    }

    #[inline(always)]
    fn end(&mut self, half: &H, e: usize) -> Result<(), EvalError> {
        half.scatter(e, &self.element, self.out);
        Ok(())
    }
}

/// Gradient, unless `out` is empty, and band of the Hessian.
pub(super) struct Band<'a, L, F> {
    law: &'a L,
    film: &'a F,
    c: &'a Coefficients,
    excess: f64,
    vector: [f64; 8],
    lanes: LaneMatrix,
    matrix: [[f64; 8]; 8],
    out: &'a mut [f64],
    hessian: &'a mut SymmetricBand,
}

impl<'a, L, F> Band<'a, L, F> {
    pub(super) fn new(
        law: &'a L,
        film: &'a F,
        c: &'a Coefficients,
        excess: f64,
        out: &'a mut [f64],
        hessian: &'a mut SymmetricBand,
    ) -> Self {
        let (vector, lanes, matrix) = ([0.0; 8], [[Lanes::ZERO; 8]; 8], [[0.0; 8]; 8]);
        Band { law, film, c, excess, vector, lanes, matrix, out, hessian }
    }
}

impl<H: HalfMeridian, L: Membrane, F: Potential> Visitor<H> for Band<'_, L, F> {
    #[inline(always)]
    fn begin(&mut self, _half: &H, _e: usize) {
        self.vector = [0.0; 8];
        self.matrix = [[0.0; 8]; 8];
    }

    #[inline(always)]
    fn cell<A: Arithmetic>(&mut self, cell: &Cell, place: &Place<Lanes>) {
        let (gradient, hessian) =
            density::linearise(self.law, self.film, self.c, self.excess, &cell.site(), place);
        sum_vector::<A>(cell, &gradient, &mut self.vector);
        lane_matrix::<A>(cell, &hessian, &mut self.lanes);
        sum_up(&self.lanes, &mut self.matrix);
    }

    #[inline(always)]
    fn end(&mut self, half: &H, e: usize) -> Result<(), EvalError> {
        if !self.out.is_empty() {
            half.scatter(e, &self.vector, self.out);
        } else if !self.vector.iter().sum::<f64>().is_finite() {
            return Err(EvalError::NotFinite { at: e * half.gauss_points() });
        }
        half.scatter_matrix(e, &self.matrix, self.hessian);
        Ok(())
    }
}

/// Derivatives `[0, 1, 2]` of the basis against what they multiply.
#[inline(always)]
pub(crate) fn combine<A: Arithmetic>(basis: [Lanes; 3], by: [Lanes; 3]) -> Lanes {
    let [b, b1, b2] = basis;
    let [x, x1, x2] = by;
    b2.mul_add::<A>(x2, b1.mul_add::<A>(x1, b * x))
}

#[inline(always)]
fn sum_vector<A: Arithmetic>(cell: &Cell, g: &Gradient<Lanes>, out: &mut [f64; 8]) {
    let mut by_s = [Lanes::ZERO; 4];
    let mut by_z = [Lanes::ZERO; 4];
    for j in 0..4 {
        let n = [cell.basis[0][j], cell.basis[1][j], cell.basis[2][j]];
        by_s[j] = combine::<A>(n, g.s);
        by_z[j] = combine::<A>(n, g.z);
    }
    let (by_s, by_z) = (Lanes::sums(by_s).0, Lanes::sums(by_z).0);
    for j in 0..4 {
        out[2 * j] += by_s[j];
        out[2 * j + 1] += by_z[j];
    }
}

/// The lower triangle `[column][row]` of an element, four Gauss points side by side.
type LaneMatrix = [[Lanes; 8]; 8];

/// Adds the sums over the lanes to the triangle of an element.
#[inline(always)]
fn sum_up(lanes: &LaneMatrix, out: &mut [[f64; 8]; 8]) {
    for column in 0..8 {
        let (rows, of) = (&mut out[column], &lanes[column]);
        // four rows at a time, from the diagonal or just above it
        for first in [0, 4] {
            if first + 3 < column {
                continue;
            }
            let sums = Lanes::sums([of[first], of[first + 1], of[first + 2], of[first + 3]]);
            if let Some(rows) = rows[first..].first_chunk_mut::<4>() {
                *rows = (Lanes(*rows) + sums).0;
            }
        }
    }
}

/// `Bᵀ H B` at each of four Gauss points, into the triangle `row ≥ column` of `out`.
#[inline(always)]
fn lane_matrix<A: Arithmetic>(cell: &Cell, h: &Hessian<Lanes>, out: &mut LaneMatrix) {
    let mut basis = [[Lanes::ZERO; 3]; 4];
    for j in 0..4 {
        basis[j] = [cell.basis[0][j], cell.basis[1][j], cell.basis[2][j]];
    }
    for j in 0..4 {
        let n @ [b, b1, b2] = basis[j];
        // H applied to function j of u, and of w
        let by_u = [
            b1.mul_add::<A>(h.s_s1, h.s_s * b),
            combine::<A>(n, [h.s_s1, h.s1_s1, h.s1_s2]),
            b2.mul_add::<A>(h.s2_s2, h.s1_s2 * b1),
        ];
        let across = [
            b1.mul_add::<A>(h.s1_z, h.s_z * b),
            combine::<A>(n, [h.s_z1, h.s1_z1, h.s2_z1]),
            b2.mul_add::<A>(h.s2_z2, h.s1_z2 * b1),
        ];
        let by_w = [
            b1.mul_add::<A>(h.z_z1, h.z_z * b),
            combine::<A>(n, [h.z_z1, h.z1_z1, h.z1_z2]),
            b2.mul_add::<A>(h.z2_z2, h.z1_z2 * b1),
        ];
        for i in j..4 {
            out[2 * j][2 * i] = combine::<A>(basis[i], by_u);
            out[2 * j + 1][2 * i + 1] = combine::<A>(basis[i], by_w);
        }
        for i in 0..4 {
            let (column, row) = if i >= j { (2 * j, 2 * i + 1) } else { (2 * i + 1, 2 * j) };
            out[column][row] = combine::<A>(basis[i], across);
        }
    }
}
