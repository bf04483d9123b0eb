//! Which branches meet at a simple branch point, and how.
//!
//! The tangents are the real roots of the algebraic bifurcation equation
//! `ψᵀ F_zz[y₀v₀ + y₁v₁, y₀v₀ + y₁v₁] = 0` on the kernel of `[F_u F_p]` (Keller 1977; Govaerts
//! 2000, section 6.4). Where one of them is vertical (no component along the parameter) the
//! point is a pitchfork, and its branch bends by
//! `μ = −ψᵀ(F_zzz[φ, φ, φ] + 3 F_zz[φ, h]) / (3 ψᵀ F_zz[φ, t])` along the other tangent `t`, with
//! `F_z h = −F_zz[φ, φ]`. All is measured in natural amplitudes, so that types do not depend on
//! the scales of `f`, `u` or `p`.

use super::kernel::Singular;
use super::plateau::settle;
use super::probe::{Extended, FIRST, Probe, SECOND};
use crate::branch::{Criticality, Crossing, Direction, Shape};
use crate::linalg::Matrix;
use crate::problem::{EvalError, Stability};
use crate::step::dot;

/// A tangent whose parameter part, per natural amplitude and range, is below this is vertical.
pub(super) const VERTICAL: f64 = 1e-5;
/// A pitchfork that bends by more than this, in ranges of the parameter per natural amplitude, has no
/// exchange of stability to first order.
const STEEPEST: f64 = 1e6;
/// A discriminant below this part of its terms: the branches touch, they do not cross.
const TOUCHING: f64 = 1e-8;

/// The crossing, and the tangent of the traced branch among its own.
pub(super) struct Analysed {
    pub(super) crossing: Crossing,
    pub(super) traced: Extended,
    /// Cosines between the direction expected of the traced branch and the two tangents.
    pub(super) alignment: (f64, f64),
}

/// Analyses a point with a kernel of one dimension; `expected` is the direction in which the
/// traced branch passes.
pub(super) fn simple(
    probe: &mut Probe<'_>,
    at: &mut Singular,
    expected: &Extended,
) -> Result<Option<Analysed>, EvalError> {
    let x = at.amplitude[1];
    let f = &at.form[0];
    let (a, b, c) = (f[0][0], f[0][1] * x, f[1][1] * x * x);
    let Some(roots) = directions(a, b, c) else { return Ok(None) };
    let wanted: Vec<f64> = at.right.iter().map(|v| probe.covector(v).dot(expected)).collect();
    let wanted = unit([wanted[0], wanted[1] / x]);
    let cosine = |r: [f64; 2]| r[0] * wanted[0] + r[1] * wanted[1];
    let (mut own, mut other) = (roots[0], roots[1]);
    if cosine(other).abs() > cosine(own).abs() {
        (own, other) = (other, own);
    }
    let alignment = (cosine(own).abs(), cosine(other).abs());
    if cosine(own) < 0.0 {
        own = own.map(|y| -y);
    }
    let vector = |y: [f64; 2]| {
        let mut v = Extended::zero(at.z.u.len());
        v.add(y[0], &at.right[0]);
        v.add(y[1] * x, &at.right[1]);
        v
    };
    let (traced, leaving) = (vector(own), vector(other));
    let range = probe.weights.parameter;
    // differences over the first step magnify the rounding of the Jacobian
    let level = (at.resolution / FIRST).max(VERTICAL);
    let vertical = |v: &Extended| v.p.abs() < level * range;
    let mut crossing = Crossing {
        shape: Shape::Transcritical,
        criticality: None,
        from_side: false,
        multiplicity: 1,
        curvature: 0.0,
        curvature_error: 0.0,
        traced: direction(probe, traced.clone(), 0.0, 1.0),
        leaving: Vec::new(),
    };
    let (mut bend, mut reach) = (0.0, 1.0);
    match (vertical(&traced), vertical(&leaving)) {
        (true, true) => crossing.shape = Shape::Degenerate,
        (false, false) => {}
        (from_side, _) => {
            crossing.shape = Shape::Pitchfork;
            crossing.from_side = from_side;
            let (trunk, fork) = if from_side { (&leaving, &traced) } else { (&traced, &leaving) };
            let bent = pitchfork(probe, at, trunk, fork)?;
            let bent = bent.filter(|b| b.curvature.abs() < STEEPEST * range);
            if bent.is_none() {
                crossing.shape = Shape::Degenerate;
            }
            if let Some(bent) = bent {
                let length = probe.length(fork);
                crossing.curvature = bent.curvature / (length * length);
                crossing.curvature_error = bent.error / (length * length);
                crossing.criticality = bent.criticality;
                if !from_side {
                    bend = 0.5 * crossing.curvature;
                    let over_range = 0.5 * bent.curvature.abs() / range;
                    reach = if over_range > 0.0 { over_range.sqrt().recip() } else { 1.0 };
                }
            }
        }
    }
    let length = probe.length(&leaving);
    let amplitude = length * reach.clamp(1e-3, 1e3);
    crossing.leaving.push(direction(probe, leaving, bend, amplitude));
    Ok(Some(Analysed { crossing, traced, alignment }))
}

/// A tangent of unit length in the problem's metric.
pub(super) fn direction(
    probe: &mut Probe<'_>,
    mut v: Extended,
    bend: f64,
    amplitude: f64,
) -> Direction {
    let length = probe.length(&v);
    v.scale(1.0 / length);
    if v.p.abs() < VERTICAL * probe.weights.parameter * (1.0 / length) {
        v.p = 0.0; // rounding
    }
    Direction { du: v.u, dp: v.p, bend, amplitude, offset: None }
}

fn unit(y: [f64; 2]) -> [f64; 2] {
    let norm = y[0].hypot(y[1]);
    y.map(|y| y / norm)
}

/// The two real directions on which `a y₀² + 2 b y₀y₁ + c y₁²` vanishes, if they are apart.
fn directions(a: f64, b: f64, c: f64) -> Option<[[f64; 2]; 2]> {
    let size = a.abs().max(b.abs()).max(c.abs());
    if size.is_nan() || size <= 0.0 {
        return None;
    }
    let (a, b, c) = (a / size, b / size, c / size);
    let discriminant = b * b - a * c;
    if discriminant < TOUCHING {
        return None;
    }
    // the pair of roots without cancellation: (q : a) and (c : q)
    let q = -(b + discriminant.sqrt().copysign(b));
    Some([unit([q, a]), unit([c, q])])
}

/// How the vertical branch of a pitchfork bends.
struct Bent {
    /// `d²p/dx²`, `x` the multiple of the vertical direction.
    curvature: f64,
    error: f64,
    criticality: Option<Criticality>,
}

fn pitchfork(
    probe: &mut Probe<'_>,
    at: &mut Singular,
    trunk: &Extended,
    fork: &Extended,
) -> Result<Option<Bent>, EvalError> {
    let w = at.left[0].clone();
    let mut exchange = f64::NAN;
    // weights of a second difference of 64 / 12 in sum, and the rounding that moves the point
    let rounding = at.resolution * probe.weights.parameter * 64.0 / (36.0 * SECOND * SECOND);
    let bent = settle(rounding, |part| {
        let mut bending = probe.bending(&at.z, fork, part, &w)?;
        bending.second.iter_mut().for_each(|y| *y = -*y);
        let (h, _) = at.frame.solve(probe, &bending.second);
        exchange = bending.row.dot(trunk);
        let cubic = bending.third + 3.0 * bending.row.dot(&h);
        let along = -cubic / (3.0 * exchange);
        Ok((exchange != 0.0).then_some(h.p + along * trunk.p))
    })?;
    let Some(bent) = bent else { return Ok(None) };
    let curvature = bent.value;
    // the critical eigenvalue on the trunk changes by exchange / (w·Mφ) per multiple of it
    let mut mass = probe.problem.new_jacobian();
    mass.set_zero();
    let crossing = if probe.problem.mass(&mut mass) {
        let mut product = vec![0.0; w.len()];
        mass.mul(&fork.u, &mut product);
        dot(&w, &product)
    } else {
        dot(&w, &fork.u)
    };
    let sign = match probe.problem.stability() {
        Stability::Dynamics => 1.0,
        Stability::EnergyHessian => -1.0,
        Stability::SeparateHessian | Stability::None => 0.0,
    };
    // positive where the new solutions face a trunk that is unstable in the critical mode
    let soft = sign * exchange * curvature * trunk.p * crossing;
    let significant = curvature.abs() > 1e-6 * probe.weights.parameter && bent.is_signed();
    let criticality = match soft {
        s if s > 0.0 && significant => Some(Criticality::Supercritical),
        s if s < 0.0 && significant => Some(Criticality::Subcritical),
        _ => None,
    };
    Ok(Some(Bent { curvature, error: bent.error, criticality }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_of_quadratic_forms() {
        // y0 y1: the axes
        let [first, second] = directions(0.0, 0.5, 0.0).unwrap();
        assert!((first[0] * second[0]).abs() < 1e-15 && (first[1] * second[1]).abs() < 1e-15);
        // (y0 - 2 y1)(y0 + 3 y1)
        for y in directions(1.0, 0.5, -6.0).unwrap() {
            assert!((y[0] * y[0] + y[0] * y[1] - 6.0 * y[1] * y[1]).abs() < 1e-14);
        }
        assert_eq!(directions(1.0, 0.0, 1.0), None);
        assert_eq!(directions(1.0, 1.0, 1.0), None);
    }
}
