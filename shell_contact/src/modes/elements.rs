//! The matrices of the second variation: assembled once per state, summed up for any `n`.
//!
//! Even powers of `n` couple `u` and `w`, and `v` with itself; odd powers couple `v` to the two
//! others. An entry is thus `m (a₀ + a₁ n² + a₂ n⁴)`, `m = n` where `v` meets another field and 1
//! elsewhere. Elements that meet no end condition are summed up to three such bands, whatever the
//! class; those at the ends are kept one by one.

use super::density::{POWERS, Polynomial, second_variation};
use super::ends::{Ends, FIELDS, HALF_BANDWIDTH, Slot};
use crate::density::Coefficients;
use crate::energy::{self, Visitor, combine};
use crate::film::Potential;
use crate::half::HalfMeridian;
use crate::membrane::Membrane;
use crate::meridian::{Cell, Mesh, Place};
use crate::scalar::Lanes;
use continuation::linalg::SymmetricBand;
use continuation::linalg::kernel::Arithmetic;
use continuation::{EvalError, Matrix};

/// A block: function of the first field by function of the second.
type Block<T> = [[T; 4]; 4];

/// Pairs of fields that even powers couple, and odd ones.
const EVEN: [(usize, usize); 4] = [(0, 0), (2, 2), (1, 1), (0, 2)];
const ODD: [(usize, usize); 2] = [(0, 1), (1, 2)];

/// Rows of a column of the lower band.
pub(super) const ROWS: usize = HALF_BANDWIDTH + 1;

/// A column of the lower band, from the diagonal downwards.
pub(super) type Column = [f64; ROWS];

/// Elements next to the pole that its conditions reach.
pub(super) const AT_POLE: usize = 3;

/// Elements next to the equator that its conditions reach.
pub(super) const AT_EQUATOR: usize = 2;

/// The second variation of a state.
#[derive(Clone, Debug)]
pub(super) struct Elements {
    count: usize,
    pole: [Element; AT_POLE],
    equator: [Element; AT_EQUATOR],
    /// All others, by power of `n²`: columns of the unknowns.
    inside: [Vec<Column>; 3],
}

/// The blocks of an element; those of a field with itself by their upper triangle.
#[derive(Clone, Debug)]
pub(super) struct Element {
    even: [[Block<f64>; 4]; 3],
    odd: [[Block<f64>; 2]; 2],
}

impl Element {
    pub(super) const ZERO: Element =
        Element { even: [[[[0.0; 4]; 4]; 4]; 3], odd: [[[[0.0; 4]; 4]; 2]; 2] };

    /// The 12×12 matrix for `n`, index `3j + f`.
    pub(super) fn at(&self, n: f64) -> [[f64; 12]; 12] {
        let mut out = [[0.0; 12]; 12];
        let n2 = n * n;
        let even = [1.0, n2, n2 * n2];
        for (pair, &(f, g)) in EVEN.iter().enumerate() {
            let blocks = self.even.each_ref().map(|b| &b[pair]);
            put(&mut out, f, g, |i, j| {
                even[0] * blocks[0][i][j] + even[1] * blocks[1][i][j] + even[2] * blocks[2][i][j]
            });
        }
        for (pair, &(f, g)) in ODD.iter().enumerate() {
            let blocks = self.odd.each_ref().map(|b| &b[pair]);
            put(&mut out, f, g, |i, j| n * (blocks[0][i][j] + n2 * blocks[1][i][j]));
        }
        out
    }

    /// The factors of `n²ᵏ` in the 12×12 matrix, without those of odd couplings.
    pub(super) fn power(&self, k: usize) -> [[f64; 12]; 12] {
        let mut out = [[0.0; 12]; 12];
        for (pair, &(f, g)) in EVEN.iter().enumerate() {
            put(&mut out, f, g, |i, j| self.even[k][pair][i][j]);
        }
        if let Some(odd) = self.odd.get(k) {
            for (pair, &(f, g)) in ODD.iter().enumerate() {
                put(&mut out, f, g, |i, j| odd[pair][i][j]);
            }
        }
        out
    }
}

impl Elements {
    /// Room for `count` elements.
    pub(super) fn new(count: usize) -> Elements {
        let zero = vec![[0.0; ROWS]; FIELDS * (count + 1)];
        Elements {
            count,
            pole: [Element::ZERO; AT_POLE],
            equator: [Element::ZERO; AT_EQUATOR],
            inside: [zero.clone(), zero.clone(), zero],
        }
    }

    /// Number of elements.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Sets `out` to the columns for `n` of what meets no end condition.
    pub(super) fn columns(&self, n: usize, out: &mut [Column]) {
        sum_up(&self.inside, n, out);
    }

    /// Passes every entry of the lower triangle that the elements next to the pole contribute.
    pub(super) fn at_pole(&self, ends: &Ends, n: usize, add: &mut impl FnMut(usize, usize, f64)) {
        for (e, element) in self.pole.iter().enumerate() {
            scatter(ends, e, &element.at(n as f64), n == 0, add);
        }
    }

    /// The same next to the equator.
    pub(super) fn at_equator(
        &self,
        ends: &Ends,
        n: usize,
        add: &mut impl FnMut(usize, usize, f64),
    ) {
        for (k, element) in self.equator.iter().enumerate() {
            let e = self.count - AT_EQUATOR + k;
            scatter(ends, e, &element.at(n as f64), n == 0, add);
        }
    }

    fn set(&mut self, e: usize, element: &Element) {
        if e < AT_POLE {
            self.pole[e] = element.clone();
        } else if e + AT_EQUATOR >= self.count {
            self.equator[e + AT_EQUATOR - self.count] = element.clone();
        } else {
            for (k, columns) in self.inside.iter_mut().enumerate() {
                let local = element.power(k);
                for (i, column) in columns[FIELDS * (e - 1)..][..12].iter_mut().enumerate() {
                    for (entry, value) in column.iter_mut().zip(&local[i][i..]) {
                        *entry += value;
                    }
                }
            }
        }
    }
}

/// Sets `out` to the columns for `n` of three bands, by power of `n²`.
pub(super) fn sum_up(powers: &[Vec<Column>; 3], n: usize, out: &mut [Column]) {
    let n = n as f64;
    let n2 = n * n;
    let factors: [Column; FIELDS] = std::array::from_fn(|f| {
        std::array::from_fn(|k| if (f == 1) != ((f + k) % FIELDS == 1) { n } else { 1.0 })
    });
    let [a, b, c] = powers;
    for (j, (((out, a), b), c)) in out.iter_mut().zip(a).zip(b).zip(c).enumerate() {
        let factor = &factors[j % FIELDS];
        for k in 0..ROWS {
            out[k] = factor[k] * (a[k] + n2 * (b[k] + n2 * c[k]));
        }
    }
}

#[inline(always)]
fn put(out: &mut [[f64; 12]; 12], f: usize, g: usize, value: impl Fn(usize, usize) -> f64) {
    for i in 0..4 {
        // of a field with itself only the upper triangle is known
        for j in if f == g { i } else { 0 }..4 {
            let x = value(i, j);
            out[3 * i + f][3 * j + g] = x;
            out[3 * j + g][3 * i + f] = x;
        }
    }
}

/// Sets the elements to the second variation of the state `u`.
pub(super) fn assemble<L: Membrane, F: Potential>(
    mesh: &Mesh,
    u: &[f64],
    law: &L,
    film: &F,
    c: &Coefficients,
    excess: f64,
    out: &mut Elements,
) {
    out.inside.iter_mut().for_each(|columns| columns.fill([0.0; ROWS]));
    elements(mesh, u, law, film, c, excess, &mut |e, element| out.set(e, element));
}

/// Passes the elements of one half in the state `u`, from its pole to the equator.
pub(super) fn elements<H: HalfMeridian, L: Membrane, F: Potential>(
    half: &H,
    u: &[f64],
    law: &L,
    film: &F,
    c: &Coefficients,
    excess: f64,
    pass: &mut impl FnMut(usize, &Element),
) {
    let hessian = [[[Lanes::ZERO; 9]; 9]; POWERS];
    let mut variation = Variation { law, film, c, excess, hessian, element: Element::ZERO, pass };
    energy::visit_unchecked(half, u, &mut variation);
}

/// The second variation, summed up by element.
struct Variation<'a, L, F, P> {
    law: &'a L,
    film: &'a F,
    c: &'a Coefficients,
    excess: f64,
    hessian: Polynomial<Lanes>,
    element: Element,
    pass: &'a mut P,
}

impl<H, L, F, P> Visitor<H> for Variation<'_, L, F, P>
where
    L: Membrane,
    F: Potential,
    P: FnMut(usize, &Element),
{
    #[inline(always)]
    fn begin(&mut self, _half: &H, _e: usize) {
        self.element = Element::ZERO;
    }

    #[inline(always)]
    fn cell<A: Arithmetic>(&mut self, cell: &Cell, place: &Place<Lanes>) {
        let Variation { law, film, c, excess, hessian, element, .. } = self;
        second_variation(*law, *film, c, *excess, &cell.site(), place, hessian);
        let mut lanes = [[Lanes::ZERO; 4]; 4];
        for (pair, &(f, g)) in EVEN.iter().enumerate() {
            for k in 0..2 {
                if f == g {
                    own_block::<A>(cell, &hessian[2 * k], f, &mut lanes);
                } else {
                    block::<A>(cell, &hessian[2 * k], f, g, &mut lanes);
                }
                add(&lanes, &mut element.even[k][pair]);
            }
            values(cell, hessian[4][f][g], &mut lanes);
            add(&lanes, &mut element.even[2][pair]);
        }
        for (pair, &(f, g)) in ODD.iter().enumerate() {
            block::<A>(cell, &hessian[1], f, g, &mut lanes);
            add(&lanes, &mut element.odd[0][pair]);
            values(cell, hessian[3][f][g], &mut lanes);
            add(&lanes, &mut element.odd[1][pair]);
        }
    }

    #[inline(always)]
    fn end(&mut self, _half: &H, e: usize) -> Result<(), EvalError> {
        (self.pass)(e, &self.element);
        Ok(())
    }
}

/// `Bᵀ H B` for a pair of fields at four Gauss points.
#[inline(always)]
fn block<A: Arithmetic>(
    cell: &Cell,
    h: &[[Lanes; 9]; 9],
    f: usize,
    g: usize,
    out: &mut Block<Lanes>,
) {
    for j in 0..4 {
        let half = applied::<A>(cell, h, f, g, j);
        for i in 0..4 {
            out[i][j] = combine::<A>(basis(cell, i), half);
        }
    }
}

/// The same for a field with itself, upper triangle.
#[inline(always)]
fn own_block<A: Arithmetic>(cell: &Cell, h: &[[Lanes; 9]; 9], f: usize, out: &mut Block<Lanes>) {
    for j in 0..4 {
        let half = applied::<A>(cell, h, f, f, j);
        for i in 0..=j {
            out[i][j] = combine::<A>(basis(cell, i), half);
        }
    }
}

/// `H B` for function `j` of the second field.
#[inline(always)]
fn applied<A: Arithmetic>(
    cell: &Cell,
    h: &[[Lanes; 9]; 9],
    f: usize,
    g: usize,
    j: usize,
) -> [Lanes; 3] {
    let n = basis(cell, j);
    let mut out = [Lanes::ZERO; 3];
    for d in 0..3 {
        let row = &h[3 * d + f];
        out[d] = combine::<A>(n, [row[g], row[3 + g], row[6 + g]]);
    }
    out
}

/// Function `j` and its derivatives.
#[inline(always)]
fn basis(cell: &Cell, j: usize) -> [Lanes; 3] {
    [cell.basis[0][j], cell.basis[1][j], cell.basis[2][j]]
}

/// The same where no derivative takes part: so it is for `n³` and `n⁴`.
#[inline(always)]
fn values(cell: &Cell, h: Lanes, out: &mut Block<Lanes>) {
    let n = &cell.basis[0];
    for j in 0..4 {
        let half = h * n[j];
        for i in 0..4 {
            out[i][j] = n[i] * half;
        }
    }
}

#[inline(always)]
fn add(lanes: &Block<Lanes>, out: &mut Block<f64>) {
    for i in 0..4 {
        out[i] = (Lanes(out[i]) + Lanes::sums(lanes[i])).0;
    }
}

/// Sets `out` to the matrix of the class `ends` at `n`, with `columns` for scratch; unknowns that
/// the class does not have get a unit pivot.
pub(super) fn matrix(
    elements: &Elements,
    ends: &Ends,
    n: usize,
    columns: &mut [Column],
    out: &mut SymmetricBand,
) {
    out.set_zero();
    elements.columns(n, columns);
    for (j, column) in columns.iter().enumerate().take(out.dim()) {
        // without waves there is no v: what couples it to others has the factor n
        if n > 0 || j % FIELDS != 1 {
            let to = out.column_mut(j);
            to.copy_from_slice(&column[..to.len()]);
        }
    }
    let mut add = |i, j, value| out.add(i, j, value);
    elements.at_pole(ends, n, &mut add);
    elements.at_equator(ends, n, &mut add);
    unit_pivots(ends, 0..=elements.count, n == 0, &mut add);
}

/// The mass `∫(u² + v² + w²) sin S dS` by element, which no state changes.
#[derive(Clone, Debug)]
pub(super) struct Masses {
    /// Functions by functions, the same for each field.
    elements: Vec<Block<f64>>,
}

impl Masses {
    /// The masses of a mesh.
    pub(super) fn new(mesh: &Mesh) -> Masses {
        let of = |e: usize| {
            let mut local = [[0.0; 4]; 4];
            for cell in mesh.cells(e) {
                let area = cell.weight * cell.sin;
                for i in 0..4 {
                    for j in 0..4 {
                        local[i][j] += (area * cell.basis[0][i] * cell.basis[0][j]).sum();
                    }
                }
            }
            local
        };
        Masses { elements: (0..mesh.elements()).map(of).collect() }
    }

    /// Functions by functions, of each element.
    pub(super) fn elements(&self) -> &[[[f64; 4]; 4]] {
        &self.elements
    }

    /// Sets `out` to the mass matrix of the class.
    pub(super) fn matrix(&self, ends: &Ends, n: usize, out: &mut SymmetricBand) {
        out.set_zero();
        for (e, local) in self.elements.iter().enumerate() {
            if e >= AT_POLE && e + AT_EQUATOR < self.elements.len() {
                for j in 0..4 {
                    for f in (0..FIELDS).filter(|&f| n > 0 || f != 1) {
                        let column = out.column_mut(FIELDS * (e - 1 + j) + f);
                        for i in j..4 {
                            column[FIELDS * (i - j)] += local[i][j];
                        }
                    }
                }
                continue;
            }
            let mut all = [[0.0; 12]; 12];
            for f in 0..FIELDS {
                put(&mut all, f, f, |i, j| local[i][j]);
            }
            scatter(ends, e, &all, n == 0, &mut |i, j, value| out.add(i, j, value));
        }
    }
}

/// Passes the entries of an element's matrix, end conditions applied.
fn scatter(
    ends: &Ends,
    e: usize,
    local: &[[f64; 12]; 12],
    without_v: bool,
    add: &mut impl FnMut(usize, usize, f64),
) {
    let slots: [Slot; 12] =
        std::array::from_fn(|k| ends.slot(k % FIELDS, e as isize - 1 + (k / FIELDS) as isize));
    for (a, slot_a) in slots.iter().enumerate() {
        for (b, slot_b) in slots.iter().enumerate() {
            if without_v && (a % FIELDS == 1 || b % FIELDS == 1) {
                continue;
            }
            for &(i, ci) in slot_a.terms() {
                for &(j, cj) in slot_b.terms() {
                    if i >= j {
                        add(i, j, ci * cj * local[a][b]);
                    }
                }
            }
        }
    }
}

/// Passes a unit pivot for each unknown of the knots `at` that the class does not have.
pub(super) fn unit_pivots(
    ends: &Ends,
    at: impl Iterator<Item = usize>,
    without_v: bool,
    add: &mut impl FnMut(usize, usize, f64),
) {
    for j in at {
        for f in 0..FIELDS {
            let own = FIELDS * j + f;
            let absent = without_v && f == 1;
            let has = ends.slot(f, j as isize).terms().first().is_some_and(|t| t.0 == own);
            if absent || !has {
                add(own, own, 1.0);
            }
        }
    }
}

/// A zero band for `elements` elements.
pub(super) fn band(elements: usize) -> SymmetricBand {
    SymmetricBand::new(FIELDS * (elements + 1), HALF_BANDWIDTH)
}
