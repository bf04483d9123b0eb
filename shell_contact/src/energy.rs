//! Assembly of energy, gradient and Hessian of the half shell, over `2π`.
//!
//! A shell without mirror symmetry is the sum over its two halves ([`HalfMeridian`]).
//!
//! One pass gives `V̂` and its gradient `v`; with the gas pressure known a second pass gives the
//! rest. Each element is summed into a local 8-vector and 8×8 triangle, then scattered. The gas
//! couples everything through `V̂`: Hessian = band + `(γP_G/V̂) v vᵀ`, the band containing
//! `−(P_G − P_A) ∂²V̂`. Nothing here allocates.
//!
//! States outside the model are refused (module [`crate::film`] says why), between Gauss points
//! too: in elements whose coefficients do not already keep the film open the spline's maximum is
//! bounded by bisection, with `max z ≤ max(z_a, z_b) + h²/8 max|z''|`.

use crate::density::{self, Coefficients, Gradient, Hessian, Parts, Site};
use crate::film::{Potential, Wall};
use crate::half::HalfMeridian;
use crate::membrane::Membrane;
use crate::meridian::{Cell, Local, Place};
use crate::scalar::{Lanes, WIDTH};
use continuation::EvalError;
use continuation::linalg::SymmetricBand;

/// Least squared meridional stretch: below it the meridian has a cusp.
const LEAST_SQUARED_STRETCH: f64 = 1e-8;

const DIMPLES_MEET: &str = "the dimples meet: the shell crosses its mirror image";
const INSIDE_OUT: &str = "the shell crosses its axis: radius not positive";
const CUSP: &str = "the meridian has a cusp: squared stretch vanishes";
const NO_VOLUME: &str = "the shell encloses no volume";

impl Cell {
    /// Where the cell is, for densities.
    #[inline(always)]
    fn site(&self) -> Site<Lanes> {
        Site { weight: self.weight, area: self.weight * self.sin, csc: self.csc }
    }
}

/// `V̂ = ½∫σ²(−z') dS`, half the enclosed volume over `2π`.
///
/// # Errors
/// When it is not positive, or the unknowns are not finite.
pub fn volume(mesh: &impl HalfMeridian, x: &[f64]) -> Result<f64, EvalError> {
    check_volume(half_volume(mesh, x), x)
}

/// [`volume`] of one of two halves, which may have any sign.
pub(crate) fn half_volume(mesh: &impl HalfMeridian, x: &[f64]) -> f64 {
    let mut sum = Lanes::ZERO;
    for e in 0..mesh.elements() {
        let local = mesh.local(x, e);
        for cell in mesh.cells(e) {
            let p = cell.place(&local);
            sum = sum + p.s[0] * p.s[0] * p.z[1] * cell.weight;
        }
    }
    -0.5 * sum.sum()
}

/// `V̂`, and its gradient in `v`.
///
/// # Errors
/// As [`volume`].
pub fn volume_gradient(
    mesh: &impl HalfMeridian,
    x: &[f64],
    v: &mut [f64],
) -> Result<f64, EvalError> {
    v.fill(0.0);
    let volume = add_volume_gradient(mesh, x, v);
    check_volume(volume, x)
}

/// [`volume_gradient`] of one of two halves, whose volume may have any sign; adds to `v`.
pub(crate) fn add_volume_gradient(mesh: &impl HalfMeridian, x: &[f64], v: &mut [f64]) -> f64 {
    let mut sum = Lanes::ZERO;
    for e in 0..mesh.elements() {
        let local = mesh.local(x, e);
        let mut element = [0.0; 8];
        for cell in mesh.cells(e) {
            let p = cell.place(&local);
            let ws = p.s[0] * cell.weight;
            let by_z1 = ws * p.s[0] * -0.5;
            let by_s = -(ws * p.z[1]);
            sum = sum + by_z1 * p.z[1];
            for j in 0..4 {
                element[2 * j] += (cell.basis[0][j] * by_s).sum();
                element[2 * j + 1] += (cell.basis[1][j] * by_z1).sum();
            }
        }
        mesh.scatter(e, &element, v);
    }
    sum.sum()
}

/// The volume of a shell, if it has one.
pub(crate) fn check_volume(volume: f64, x: &[f64]) -> Result<f64, EvalError> {
    if volume > 0.0 && volume.is_finite() {
        Ok(volume)
    } else if let Some(at) = x.iter().position(|x| !x.is_finite()) {
        Err(EvalError::NotFinite { at })
    } else {
        Err(EvalError::Inadmissible { what: NO_VOLUME, at: 0, value: volume })
    }
}

/// Whether the shell stays on its side of wall, axis and equator; a fraction of an assembly.
///
/// # Errors
/// Says what is violated, at which Gauss point.
pub fn admissible(
    mesh: &impl HalfMeridian,
    x: &[f64],
    wall: impl Into<Wall>,
) -> Result<(), EvalError> {
    volume(mesh, x)?;
    is_clear(mesh, x, wall)
}

/// [`admissible`] of one of two halves, whose volume may have any sign.
pub(crate) fn is_clear(
    mesh: &impl HalfMeridian,
    x: &[f64],
    wall: impl Into<Wall>,
) -> Result<(), EvalError> {
    let wall = wall.into();
    check_pole(mesh, x, wall)?;
    for e in 0..mesh.elements() {
        let local = mesh.local(x, e);
        check_gap(mesh, x, e, &local, wall)?;
        for (k, cell) in mesh.cells(e).iter().enumerate() {
            check_place(mesh, e, k, &cell.place(&local), wall)?;
        }
    }
    Ok(())
}

/// Pole and wall.
fn check_pole(mesh: &impl HalfMeridian, x: &[f64], wall: Wall) -> Result<(), EvalError> {
    let z = 1.0 + mesh.displacement_in(x, 0, 0.0)[0].1;
    if z < mesh.floor() {
        return Err(EvalError::Inadmissible { what: DIMPLES_MEET, at: 0, value: z });
    }
    if z >= wall.height {
        let value = wall.height - z;
        return Err(EvalError::Inadmissible { what: wall.what, at: 0, value });
    }
    Ok(())
}

#[inline(always)]
fn check_gap(
    mesh: &impl HalfMeridian,
    x: &[f64],
    e: usize,
    c: &Local,
    wall: Wall,
) -> Result<(), EvalError> {
    // cos S + w, each bounded by its largest coefficient
    if wall.height > mesh.cos_knot(e) + c.w_bound() { Ok(()) } else { search_gap(mesh, x, e, wall) }
}

/// Bisection: looks for a point of element `e` at or above the wall until none can be left.
#[cold]
fn search_gap(mesh: &impl HalfMeridian, x: &[f64], e: usize, wall: Wall) -> Result<(), EvalError> {
    let (start, end) = (mesh.knots().at(e), mesh.knots().at(e + 1));
    let w = |s: f64| mesh.displacement_in(x, e, s);
    let z = |s: f64| s.cos() + w(s)[0].1;
    // w'' is linear in an element
    let bend = 1.0 + w(start)[2].1.abs().max(w(end)[2].1.abs());
    let mut parts = 1;
    while parts <= 256 {
        let h = (end - start) / f64::from(parts);
        let margin = 0.125 * h * h * bend;
        let mut highest = f64::NEG_INFINITY;
        for i in 0..=parts {
            highest = highest.max(z(start + h * f64::from(i)));
        }
        if highest >= wall.height {
            let at = e * mesh.gauss_points();
            let value = wall.height - highest;
            return Err(EvalError::Inadmissible { what: wall.what, at, value });
        }
        if highest + margin < wall.height {
            break;
        }
        parts *= 4;
    }
    Ok(())
}

#[inline(always)]
fn check_place(
    mesh: &impl HalfMeridian,
    e: usize,
    k: usize,
    p: &Place<Lanes>,
    wall: Wall,
) -> Result<(), EvalError> {
    let delta = -(p.z[0] - wall.height);
    let q = p.s[1] * p.s[1] + p.z[1] * p.z[1] - LEAST_SQUARED_STRETCH;
    if delta.min(p.s[0]).min((p.z[0] - mesh.floor()).min(q)).positive() {
        Ok(())
    } else {
        Err(refuse(mesh, e, k, p, wall))
    }
}

#[cold]
fn refuse(mesh: &impl HalfMeridian, e: usize, k: usize, p: &Place<Lanes>, wall: Wall) -> EvalError {
    for lane in 0..WIDTH {
        let at = e * mesh.gauss_points() + (k * WIDTH + lane).min(mesh.gauss_points() - 1);
        let [s, s1, _] = p.s.map(|x| x.0[lane]);
        let [z, z1, _] = p.z.map(|x| x.0[lane]);
        let q = s1 * s1 + z1 * z1;
        let found = [
            (wall.height - z, 0.0, wall.what),
            (z, mesh.floor(), DIMPLES_MEET),
            (s, 0.0, INSIDE_OUT),
            (q, LEAST_SQUARED_STRETCH, CUSP),
        ];
        for (value, least, what) in found {
            if value <= least {
                return EvalError::Inadmissible { what, at, value };
            }
            if !value.is_finite() {
                return EvalError::NotFinite { at };
            }
        }
    }
    EvalError::NotFinite { at: e * mesh.gauss_points() }
}

/// The integrals of the parts of the energy.
///
/// # Errors
/// When the state is not admissible.
pub fn parts<L: Membrane, F: Potential>(
    mesh: &impl HalfMeridian,
    x: &[f64],
    law: &L,
    film: &F,
    c: &Coefficients,
) -> Result<Parts<f64>, EvalError> {
    let volume = volume(mesh, x)?;
    Ok(Parts { volume, ..half_parts(mesh, x, law, film, c)? })
}

/// [`parts`] of one of two halves but for its volume, which is left at zero.
pub(crate) fn half_parts<L: Membrane, F: Potential>(
    mesh: &impl HalfMeridian,
    x: &[f64],
    law: &L,
    film: &F,
    c: &Coefficients,
) -> Result<Parts<f64>, EvalError> {
    let none = Lanes::ZERO;
    let mut total = Parts { stretching: none, bending: none, film: none, area: none, volume: none };
    each_cell(mesh, x, film.wall(c), |cell, place| {
        let p = density::parts(law, film, c, &cell.site(), place);
        total.stretching = total.stretching + p.stretching;
        total.bending = total.bending + p.bending;
        total.film = total.film + p.film;
        total.area = total.area + p.area;
    })?;
    Ok(Parts {
        stretching: total.stretching.sum(),
        bending: total.bending.sum(),
        film: total.film.sum(),
        area: total.area.sum(),
        volume: 0.0,
    })
}

/// Visits all Gauss points, checking each.
fn each_cell(
    mesh: &impl HalfMeridian,
    x: &[f64],
    wall: Wall,
    mut visit: impl FnMut(&Cell, &Place<Lanes>),
) -> Result<(), EvalError> {
    check_pole(mesh, x, wall)?;
    for e in 0..mesh.elements() {
        let local = mesh.local(x, e);
        check_gap(mesh, x, e, &local, wall)?;
        for (k, cell) in mesh.cells(e).iter().enumerate() {
            let place = cell.place(&local);
            check_place(mesh, e, k, &place, wall)?;
            visit(cell, &place);
        }
    }
    Ok(())
}

/// The integral of `f(site, place)` over the meridian.
pub(crate) fn integrate(
    mesh: &impl HalfMeridian,
    x: &[f64],
    wall: impl Into<Wall>,
    f: impl Fn(&Site<Lanes>, &Place<Lanes>) -> Lanes,
) -> Result<f64, EvalError> {
    let mut sum = Lanes::ZERO;
    each_cell(mesh, x, wall.into(), |cell, place| sum = sum + f(&cell.site(), place))?;
    Ok(sum.sum())
}

/// The integral of `f(site, place, direction)`, the direction being that of the unknowns `dx`.
pub(crate) fn integrate_along(
    mesh: &impl HalfMeridian,
    x: &[f64],
    dx: &[f64],
    wall: impl Into<Wall>,
    f: impl Fn(&Site<Lanes>, &Place<Lanes>, &Place<Lanes>) -> Lanes,
) -> Result<f64, EvalError> {
    let wall = wall.into();
    let mut sum = Lanes::ZERO;
    for e in 0..mesh.elements() {
        let (local, along) = (mesh.local(x, e), mesh.local(dx, e));
        check_gap(mesh, x, e, &local, wall)?;
        for (k, cell) in mesh.cells(e).iter().enumerate() {
            let place = cell.place(&local);
            check_place(mesh, e, k, &place, wall)?;
            sum = sum + f(&cell.site(), &place, &cell.displacement(&along));
        }
    }
    Ok(sum.sum())
}

/// Slope of `V̂` in the direction of the unknowns `dx`.
pub(crate) fn volume_along(
    mesh: &impl HalfMeridian,
    x: &[f64],
    dx: &[f64],
    wall: impl Into<Wall>,
) -> Result<f64, EvalError> {
    integrate_along(mesh, x, dx, wall, |at, x, d| {
        let s = x.s[0];
        -(s * (x.z[1] * d.s[0] + s * d.z[1] * 0.5) * at.weight)
    })
}

/// Adds to `out` the gradient over the unknowns of the integral whose pointwise gradient is `f`.
///
/// # Errors
/// When the state is not admissible.
pub fn add_gradient(
    mesh: &impl HalfMeridian,
    x: &[f64],
    wall: impl Into<Wall>,
    out: &mut [f64],
    f: impl Fn(&Site<Lanes>, &Place<Lanes>) -> Gradient<Lanes>,
) -> Result<(), EvalError> {
    let wall = wall.into();
    check_pole(mesh, x, wall)?;
    for e in 0..mesh.elements() {
        let local = mesh.local(x, e);
        check_gap(mesh, x, e, &local, wall)?;
        let mut element = [0.0; 8];
        for (k, cell) in mesh.cells(e).iter().enumerate() {
            let place = cell.place(&local);
            check_place(mesh, e, k, &place, wall)?;
            sum_vector(cell, &f(&cell.site(), &place), &mut element);
        }
        mesh.scatter(e, &element, out);
    }
    check_finite(out)
}

/// Adds the gradient without its gas term to `out`, unless that is empty, and the band of the Hessian, the gas term at
/// the excess pressure `P_G − P_A` included, to `hessian`.
///
/// # Errors
/// When the state is not admissible.
#[allow(clippy::too_many_arguments)] // state, model and the two results
pub fn add_linearisation<L: Membrane, F: Potential>(
    mesh: &impl HalfMeridian,
    x: &[f64],
    law: &L,
    film: &F,
    c: &Coefficients,
    excess: f64,
    out: &mut [f64],
    hessian: &mut SymmetricBand,
) -> Result<(), EvalError> {
    let wall = film.wall(c);
    check_pole(mesh, x, wall)?;
    let mut triangle = [[Lanes::ZERO; 8]; 8];
    let mut lanes = (Gradient::zero(), Hessian::zero());
    for e in 0..mesh.elements() {
        let local = mesh.local(x, e);
        check_gap(mesh, x, e, &local, wall)?;
        let mut vector = [0.0; 8];
        let mut matrix = [[0.0; 8]; 8];
        for (k, cell) in mesh.cells(e).iter().enumerate() {
            let place = cell.place(&local);
            check_place(mesh, e, k, &place, wall)?;
            lane_density(law, film, c, excess, cell, &place, &mut lanes);
            lane_matrix(cell, &lanes.1, &mut triangle);
            sum_vector(cell, &lanes.0, &mut vector);
            sum_matrix(&triangle, &mut matrix);
        }
        if !out.is_empty() {
            mesh.scatter(e, &vector, out);
        } else if !vector.iter().sum::<f64>().is_finite() {
            return Err(EvalError::NotFinite { at: e * mesh.gauss_points() });
        }
        mesh.scatter_matrix(e, &matrix, hessian);
    }
    check_finite(out)
}

#[inline(always)]
fn sum_vector(cell: &Cell, g: &Gradient<Lanes>, out: &mut [f64; 8]) {
    let [n, n1, n2] = &cell.basis;
    for j in 0..4 {
        out[2 * j] += (n[j] * g.s[0] + n1[j] * g.s[1] + n2[j] * g.s[2]).sum();
        out[2 * j + 1] += (n[j] * g.z[0] + n1[j] * g.z[1] + n2[j] * g.z[2]).sum();
    }
}

/// The lower triangle `[column][row]` of an element, four Gauss points side by side.
type LaneMatrix = [[Lanes; 8]; 8];

/// `Bᵀ H B` at each of four Gauss points, into the triangle `row ≥ column` of `out`.
///
/// A function of its own, not inlined, writing to memory: the compiler then keeps to vector
/// instructions, which it gives up when the sums over the lanes are in sight (a factor of two).
#[inline(never)]
fn lane_matrix(cell: &Cell, h: &Hessian<Lanes>, out: &mut LaneMatrix) {
    let [n, n1, n2] = &cell.basis;
    for j in 0..4 {
        let (b, b1, b2) = (n[j], n1[j], n2[j]);
        // H applied to function j of u, and of w
        let u_s = h.s_s * b + h.s_s1 * b1;
        let u_s1 = h.s_s1 * b + h.s1_s1 * b1 + h.s1_s2 * b2;
        let u_s2 = h.s1_s2 * b1 + h.s2_s2 * b2;
        let u_z = h.s_z * b + h.s1_z * b1;
        let u_z1 = h.s_z1 * b + h.s1_z1 * b1 + h.s2_z1 * b2;
        let u_z2 = h.s1_z2 * b1 + h.s2_z2 * b2;
        let w_z = h.z_z * b + h.z_z1 * b1;
        let w_z1 = h.z_z1 * b + h.z1_z1 * b1 + h.z1_z2 * b2;
        let w_z2 = h.z1_z2 * b1 + h.z2_z2 * b2;
        for i in j..4 {
            out[2 * j][2 * i] = n[i] * u_s + n1[i] * u_s1 + n2[i] * u_s2;
            out[2 * j + 1][2 * i + 1] = n[i] * w_z + n1[i] * w_z1 + n2[i] * w_z2;
        }
        for i in 0..4 {
            let (column, row) = if i >= j { (2 * j, 2 * i + 1) } else { (2 * i + 1, 2 * j) };
            out[column][row] = n[i] * u_z + n1[i] * u_z1 + n2[i] * u_z2;
        }
    }
}

/// Adds the sums over the lanes of a triangle.
#[inline(always)]
fn sum_matrix(lanes: &LaneMatrix, out: &mut [[f64; 8]; 8]) {
    for column in 0..8 {
        for row in column..8 {
            out[column][row] += lanes[column][row].sum();
        }
    }
}

/// [`density::linearise`] kept apart for the same reason as [`lane_matrix`].
#[inline(never)]
fn lane_density<L: Membrane, F: Potential>(
    law: &L,
    film: &F,
    c: &Coefficients,
    excess: f64,
    cell: &Cell,
    place: &Place<Lanes>,
    out: &mut (Gradient<Lanes>, Hessian<Lanes>),
) {
    *out = density::linearise(law, film, c, excess, &cell.site(), place);
}

fn check_finite(values: &[f64]) -> Result<(), EvalError> {
    if values.iter().sum::<f64>().is_finite() {
        return Ok(());
    }
    match values.iter().position(|v| !v.is_finite()) {
        Some(at) => Err(EvalError::NotFinite { at }),
        None => Ok(()),
    }
}
