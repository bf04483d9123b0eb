//! Whether a place is one of the model's.
//!
//! States outside the model are refused (module [`crate::film`] says why), between Gauss points
//! too: in elements whose coefficients do not already keep the film open the spline's maximum is
//! bounded by bisection, with `max z ≤ max(z_a, z_b) + h²/8 max|z''|`.

use crate::film::Wall;
use crate::half::HalfMeridian;
use crate::meridian::{Local, Place};
use crate::scalar::{Lanes, WIDTH};
use continuation::EvalError;

/// Least squared meridional stretch: below it the meridian has a cusp.
const LEAST_SQUARED_STRETCH: f64 = 1e-8;

const DIMPLES_MEET: &str = "the dimples meet: the shell crosses its mirror image";
const INSIDE_OUT: &str = "the shell crosses its axis: radius not positive";
const CUSP: &str = "the meridian has a cusp: squared stretch vanishes";

/// Pole and wall.
pub(super) fn check_pole(mesh: &impl HalfMeridian, x: &[f64], wall: Wall) -> Result<(), EvalError> {
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
pub(super) fn check_gap(
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
pub(super) fn check_place(
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
