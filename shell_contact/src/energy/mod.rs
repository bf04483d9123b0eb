//! Assembly of energy, gradient and Hessian of the half shell, over `2π`.
//!
//! A shell without mirror symmetry is the sum over its two halves ([`HalfMeridian`]).
//!
//! One pass gives `V̂` and its gradient `v`; with the gas pressure known a second pass gives the
//! rest. Each element is summed into a local 8-vector and 8×8 triangle, then scattered. The gas
//! couples everything through `V̂`: Hessian = band + `(γP_G/V̂) v vᵀ`, the band containing
//! `−(P_G − P_A) ∂²V̂`. Nothing here allocates.
//!
//! There is one loop over the Gauss points (`visit`), which checks each place; what is computed there
//! is a `Visitor`.

mod clear;
pub(crate) mod gradients;
mod visitors;

pub(crate) use visitors::{Direction, Visitor, combine};
pub use visitors::{GradientAt, ValueAt};

use crate::density::{Coefficients, Parts, Site};
use crate::film::{Potential, Wall};
use crate::half::HalfMeridian;
use crate::membrane::Membrane;
use crate::meridian::Cell;
use crate::scalar::Lanes;
use clear::{check_gap, check_place, check_pole};
use continuation::EvalError;
use continuation::linalg::SymmetricBand;
use continuation::linalg::kernel::{self, Arithmetic, Kernel};
use visitors::{Along, Band, Clear, Integral, PartSums, Sum, Volume, VolumeGradient};

const NO_VOLUME: &str = "the shell encloses no volume";

impl Cell {
    /// Where the cell is, for densities.
    #[inline(always)]
    pub(crate) fn site(&self) -> Site<Lanes> {
        Site { weight: self.weight, area: self.weight * self.sin, csc: self.csc }
    }
}

/// The loop over half a meridian.
struct Pass<'a, H, V, const CHECKED: bool> {
    half: &'a H,
    x: &'a [f64],
    wall: Wall,
    visitor: &'a mut V,
}

impl<H: HalfMeridian, V: Visitor<H>, const CHECKED: bool> Kernel for Pass<'_, H, V, CHECKED> {
    type Output = Result<(), EvalError>;

    #[inline(always)]
    fn run<A: Arithmetic>(self) -> Result<(), EvalError> {
        let Pass { half, x, wall, visitor } = self;
        for e in 0..half.elements() {
            let local = half.local(x, e);
            if CHECKED {
                check_gap(half, x, e, &local, wall)?;
            }
            visitor.begin(half, e);
            for (k, cell) in half.cells(e).iter().enumerate() {
                let place = cell.place_by::<A>(&local);
                if CHECKED {
                    check_place(half, e, k, &place, wall)?;
                }
                visitor.cell::<A>(cell, &place);
            }
            visitor.end(half, e)?;
        }
        Ok(())
    }
}

/// Passes a visitor over half a meridian, checking each place.
pub(crate) fn visit<H: HalfMeridian, V: Visitor<H>>(
    half: &H,
    x: &[f64],
    wall: impl Into<Wall>,
    visitor: &mut V,
) -> Result<(), EvalError> {
    let wall = wall.into();
    check_pole(half, x, wall)?;
    kernel::run(Pass::<_, _, true> { half, x, wall, visitor })
}

/// [`visit`] where places may be anything.
pub(crate) fn visit_unchecked<H: HalfMeridian, V: Visitor<H>>(
    half: &H,
    x: &[f64],
    visitor: &mut V,
) {
    let wall = Wall::from(f64::INFINITY);
    let pass = Pass::<_, _, false> { half, x, wall, visitor };
    // visitors of such a pass refuse nothing
    let _: Result<(), EvalError> = kernel::run(pass);
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
    let mut volume = Volume(Lanes::ZERO);
    visit_unchecked(mesh, x, &mut volume);
    -0.5 * volume.0.sum()
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
    let mut volume = VolumeGradient::new(v);
    visit_unchecked(mesh, x, &mut volume);
    volume.volume()
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
    visit(mesh, x, wall, &mut Clear)
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
    let mut sums = PartSums::new(law, film, c);
    visit(mesh, x, film.wall(c), &mut sums)?;
    Ok(sums.total())
}

/// The integral over the meridian of what has a value at each place.
pub(crate) fn integrate(
    mesh: &impl HalfMeridian,
    x: &[f64],
    wall: impl Into<Wall>,
    value: &impl ValueAt,
) -> Result<f64, EvalError> {
    let mut integral = Integral { value, sum: Lanes::ZERO };
    visit(mesh, x, wall, &mut integral)?;
    Ok(integral.sum.sum())
}

/// The integral of what has a value at each place and direction, that of the unknowns `dx`.
pub(crate) fn integrate_along(
    mesh: &impl HalfMeridian,
    x: &[f64],
    dx: &[f64],
    wall: impl Into<Wall>,
    value: &impl Direction,
) -> Result<f64, EvalError> {
    let mut along = Along::new(mesh, dx, value);
    visit(mesh, x, wall, &mut along)?;
    Ok(along.sum())
}

/// Slope of `V̂` in the direction of the unknowns `dx`.
pub(crate) fn volume_along(
    mesh: &impl HalfMeridian,
    x: &[f64],
    dx: &[f64],
    wall: impl Into<Wall>,
) -> Result<f64, EvalError> {
    integrate_along(mesh, x, dx, wall, &visitors::VolumeSlope)
}

/// Adds to `out` the gradient over the unknowns of the integral whose pointwise gradient is given.
///
/// # Errors
/// When the state is not admissible.
pub fn add_gradient(
    mesh: &impl HalfMeridian,
    x: &[f64],
    wall: impl Into<Wall>,
    out: &mut [f64],
    gradient: &impl GradientAt,
) -> Result<(), EvalError> {
    visit(mesh, x, wall, &mut Sum::new(gradient, out))?;
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
    visit(mesh, x, film.wall(c), &mut Band::new(law, film, c, excess, out, hessian))?;
    check_finite(out)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::close;
    use crate::film::FourTwo;
    use crate::membrane::MooneyRivlin;
    use crate::meridian::Mesh;
    use crate::spline::HALF_BANDWIDTH;
    use continuation::Matrix;
    use continuation::linalg::kernel::{Fused, Separate};

    /// Machines with and without wide vectors and fused products find the same to rounding.
    #[test]
    fn every_arithmetic_assembles_the_same() {
        let mesh = Mesh::graded(20, 3.0).unwrap();
        let n = mesh.unknowns();
        let x: Vec<f64> = (0..n).map(|i| 2e-3 * (1.0 + 1.7 * i as f64).sin()).collect();
        let c = Coefficients {
            bending: 3e-5,
            poisson: 0.4,
            b: 0.3,
            surface_tension: 0.05,
            adhesion: 2e-3,
            film: 1.0 / 30.0,
            plate: 1.04,
        };
        let law = MooneyRivlin { b: c.b };
        let assembled = |how: fn(Pass<'_, Mesh, Band<'_, MooneyRivlin, FourTwo>, true>)| {
            let (mut r, mut j) = (vec![0.0; n], SymmetricBand::new(n, HALF_BANDWIDTH));
            let mut band = Band::new(&law, &FourTwo, &c, 0.2, &mut r, &mut j);
            how(Pass { half: &mesh, x: &x, wall: Wall::from(c.plate), visitor: &mut band });
            (r, j)
        };
        let (r, j) = assembled(|pass| pass.run::<Separate>().unwrap());
        let size = r.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
        for (again, mut other) in [
            assembled(|pass| pass.run::<Fused>().unwrap()),
            assembled(|pass| kernel::run(pass).unwrap()),
        ] {
            for (a, b) in r.iter().zip(&again) {
                close(*a, *b, 1e-13, 1e-13 * size);
            }
            other.axpy(-1.0, &j);
            assert!(other.norm() <= 1e-14 * j.norm());
        }
    }
}
