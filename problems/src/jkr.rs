//! Adhesive contact of a sphere and a half space (Johnson, Kendall & Roberts, *Proc. R. Soc. Lond. A*
//! 324 (1971) 301).
//!
//! Contact radius `a`, approach `δ`, contact modulus `E*`, radius `R`, work of adhesion `w`:
//!
//! ```text
//! energy  U(a, δ) = E*(aδ² − ⅔a³δ/R + a⁵/(5R²)) − πwa²
//! ∂U/∂a = 0:   δ = a²/R − √(2πwa/E*)
//! ∂U/∂δ = P:   P = 2E*(aδ − a³/(3R)) = 4E*a³/(3R) − √(8πwE*a³)
//! ```
//! The other root of `∂U/∂a = 0`, `δ > a²/R`, overlaps outside the contact and is refused, as is
//! `a ≤ 0`.
//!
//! [`LoadControl`] (unknowns `a, δ`, energy `U − Pδ`): fold, the pull-off under dead load, at
//! `P = −3πwR/2`, `a³ = 9πwR²/(8E*)`. [`GripControl`] (unknown `a`, parameter `δ`): fold at
//! `P = −5πwR/6`, `a³ = πwR²/(8E*)`, `δ = −3a²/R`. Jacobians are Hessians: stable beyond the fold's
//! contact radius, unstable below. Either branch ends in the point contact `a = 0`; the traces end
//! at a tenth of the fold's radius.

use crate::visit::hand;
use crate::{Allowed, Constant, Entry, Id, Known, ProblemError, Request, Setup, Visitor};
use continuation::linalg::{Dense, Matrix};
use continuation::{EvalError, Name, ParamId, Parameter, Problem, Stability, Watch, names};
use std::f64::consts::PI;

const MODULUS: Parameter = Parameter::new("modulus", "", 1.0);
const RADIUS: Parameter = Parameter::new("radius", "", 1.0);
const ADHESION: Parameter = Parameter::new("adhesion", "", 1.0);

/// Approach and load of the contact in equilibrium with radius `a`; `law` = `[E*, R, w]`.
pub fn equilibrium(a: f64, law: [f64; 3]) -> (f64, f64) {
    let [e, r, w] = law;
    let approach = a * a / r - (2.0 * PI * w * a / e).sqrt();
    (approach, 4.0 * e * a.powi(3) / (3.0 * r) - (8.0 * PI * w * e * a.powi(3)).sqrt())
}

/// The radii at the folds of load control and of grip control.
pub fn critical_radii(law: [f64; 3]) -> (f64, f64) {
    let [e, r, w] = law;
    let size = PI * w * r * r / (8.0 * e);
    ((9.0 * size).cbrt(), size.cbrt())
}

/// Half the opening `a²/R − δ` that adhesion sustains is positive; so is `a`.
fn check(a: f64, approach: f64, radius: f64) -> Result<(), EvalError> {
    let inadmissible = |what, value| Err(EvalError::Inadmissible { what, at: 0, value });
    if !(a.is_finite() && approach.is_finite()) {
        return Err(EvalError::NotFinite { at: usize::from(a.is_finite()) });
    }
    if a <= 0.0 {
        return inadmissible("no contact: radius not positive", a);
    }
    let opening = a * a / radius - approach;
    if opening <= 0.0 {
        return inadmissible(
            "the surfaces overlap outside the contact: opening not positive",
            opening,
        );
    }
    Ok(())
}

/// Derivatives of `U`, and of its gradient by the parameters.
struct Energy {
    a: f64,
    approach: f64,
    law: [f64; 3],
}

impl Energy {
    /// `δ − a²/R`, negative.
    fn gap(&self) -> f64 {
        self.approach - self.a * self.a / self.law[1]
    }

    fn by_radius(&self) -> f64 {
        self.law[0] * self.gap().powi(2) - 2.0 * PI * self.law[2] * self.a
    }

    fn by_approach(&self) -> f64 {
        2.0 * self.law[0] * self.a * (self.approach - self.a * self.a / (3.0 * self.law[1]))
    }

    /// `[∂²U/∂a², ∂²U/∂a∂δ, ∂²U/∂δ²]`.
    fn hessian(&self) -> [f64; 3] {
        let [e, r, w] = self.law;
        let gap = self.gap();
        [-4.0 * e * self.a / r * gap - 2.0 * PI * w, 2.0 * e * gap, 2.0 * e * self.a]
    }

    /// Derivatives of `[∂U/∂a, ∂U/∂δ]` by `law[which]`.
    fn by_law(&self, which: usize) -> [f64; 2] {
        let [e, r, _] = self.law;
        let (a, gap) = (self.a, self.gap());
        match which {
            0 => [gap * gap, self.by_approach() / e],
            1 => [2.0 * e * gap * a * a / (r * r), 2.0 * e * a.powi(3) / (3.0 * r * r)],
            _ => [-2.0 * PI * a, 0.0],
        }
    }
}

/// Under a load `P`.
#[derive(Debug, Clone, Copy, Default)]
pub struct LoadControl;

static LOAD: [Parameter; 4] = [Parameter::new("load", "", 1.0), MODULUS, RADIUS, ADHESION];

fn energy(a: f64, approach: f64, p: &[f64]) -> Energy {
    Energy { a, approach, law: [p[1], p[2], p[3]] }
}

impl Problem for LoadControl {
    type Jacobian = Dense;

    fn dim(&self) -> usize {
        2
    }

    fn parameters(&self) -> &[Parameter] {
        &LOAD
    }

    fn new_jacobian(&self) -> Dense {
        Dense::new(2)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        check(u[0], u[1], p[2])?;
        let energy = energy(u[0], u[1], p);
        r[0] = energy.by_radius();
        r[1] = energy.by_approach() - p[0];
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        check(u[0], u[1], p[2])?;
        let [aa, ad, dd] = energy(u[0], u[1], p).hessian();
        j.set_zero();
        j.set(0, 0, aa);
        j.set(0, 1, ad);
        j.set(1, 0, ad);
        j.set(1, 1, dd);
        Ok(())
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        check(u[0], u[1], p[2])?;
        let slopes = match which.0 {
            0 => [0.0, -1.0],
            k => energy(u[0], u[1], p).by_law(k - 1),
        };
        out.copy_from_slice(&slopes);
        Ok(())
    }

    fn stability(&self) -> Stability {
        Stability::EnergyHessian
    }

    fn observables(&self) -> &[Name] {
        names!["contact_radius", "approach"]
    }

    fn observe(&self, u: &[f64], _p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        out.copy_from_slice(u);
        Ok(())
    }
}

/// At a given approach `δ`.
#[derive(Debug, Clone, Copy, Default)]
pub struct GripControl;

static GRIP: [Parameter; 4] = [Parameter::new("approach", "", 1.0), MODULUS, RADIUS, ADHESION];

impl Problem for GripControl {
    type Jacobian = Dense;

    fn dim(&self) -> usize {
        1
    }

    fn parameters(&self) -> &[Parameter] {
        &GRIP
    }

    fn new_jacobian(&self) -> Dense {
        Dense::new(1)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        check(u[0], p[0], p[2])?;
        r[0] = energy(u[0], p[0], p).by_radius();
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        check(u[0], p[0], p[2])?;
        j.set(0, 0, energy(u[0], p[0], p).hessian()[0]);
        Ok(())
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        check(u[0], p[0], p[2])?;
        let energy = energy(u[0], p[0], p);
        out[0] = match which.0 {
            0 => energy.hessian()[1],
            k => energy.by_law(k - 1)[0],
        };
        Ok(())
    }

    fn stability(&self) -> Stability {
        Stability::EnergyHessian
    }

    fn observables(&self) -> &[Name] {
        names!["load", "contact_radius"]
    }

    fn observe(&self, u: &[f64], p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        out[0] = energy(u[0], p[0], p).by_approach();
        out[1] = u[0];
        Ok(())
    }
}

const CONSTANTS: &[Constant] = &[
    Constant { name: "modulus", default: 1.0, allowed: Allowed::Above(0.0) },
    Constant { name: "radius", default: 1.0, allowed: Allowed::Above(0.0) },
    Constant { name: "adhesion", default: 1.0, allowed: Allowed::Above(0.0) },
];

pub(crate) static LOAD_ENTRY: Entry = Entry {
    name: "jkr-load",
    summary: "adhesive contact of a sphere under a load: pull-off at P = -3 pi w R/2",
    parameter: "load",
    axes: &[("load", "load P"), ("contact_radius", "contact radius a"), ("approach", "approach δ")],
    start: 5.0,
    start_allowed: Allowed::Any,
    end: -6.0,
    parameters: CONSTANTS,
    elements: None,
    known: &[Known::fold(-4.712_388_980_384_69, 1e-11, "-3 pi w R/2")],
    id: Id::JkrLoad,
};

pub(crate) static GRIP_ENTRY: Entry = Entry {
    name: "jkr-grip",
    summary: "adhesive contact of a sphere at a given approach: fold at P = -5 pi w R/6",
    parameter: "approach",
    axes: &[("approach", "approach δ"), ("load", "load P"), ("contact_radius", "contact radius a")],
    start: 3.0,
    start_allowed: Allowed::Any,
    end: -2.0,
    parameters: CONSTANTS,
    elements: None,
    known: &[Known::fold(-1.608_772_047_833_269, 1e-11, "-3 a^2/R, a^3 = pi w R^2/(8 E*)")],
    id: Id::JkrGrip,
};

fn law(request: &Request) -> [f64; 3] {
    [0, 1, 2].map(|k| request.parameter(k))
}

fn start_above(request: &Request, fold: f64) -> Result<(), ProblemError> {
    let allowed = Allowed::Above(fold);
    if allowed.holds(request.start) {
        return Ok(());
    }
    Err(ProblemError::OutOfRange { key: "path.start".to_owned(), value: request.start, allowed })
}

pub(crate) fn load<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    let [e, r, w] = law(request);
    let (fold, _) = critical_radii([e, r, w]);
    start_above(request, equilibrium(fold, [e, r, w]).1)?;
    // P is a quadratic in a^{3/2}
    let half = 3.0 * r / (8.0 * e) * (8.0 * PI * w * e).sqrt();
    let root = half + (half * half + 3.0 * r * request.start / (4.0 * e)).max(0.0).sqrt();
    let a = root.powi(2).cbrt();
    let u = vec![a, equilibrium(a, [e, r, w]).0];
    let setup = Setup::new(LOAD_ENTRY.parameter, u, request);
    let end = Watch::stop_at("contact_radius", 0.1 * fold);
    Ok(hand(visitor, &LoadControl, setup.watching(end)))
}

pub(crate) fn grip<V: Visitor>(request: &Request, visitor: V) -> Result<V::Output, ProblemError> {
    let [e, r, w] = law(request);
    let (_, fold) = critical_radii([e, r, w]);
    start_above(request, equilibrium(fold, [e, r, w]).0)?;
    // δ is convex in a and grows beyond the fold: Newton's method from the right is monotone
    let soft = 2.0 * PI * w / e;
    let mut a = fold + (r * request.start.abs()).sqrt() + 4.0 * (r * r * soft).cbrt();
    for _ in 0..100 {
        let slope = 2.0 * a / r - 0.5 * (soft / a).sqrt();
        a -= (equilibrium(a, [e, r, w]).0 - request.start) / slope;
    }
    let setup = Setup::new(GRIP_ENTRY.parameter, vec![a], request);
    let end = Watch::stop_at("contact_radius", 0.1 * fold);
    Ok(hand(visitor, &GripControl, setup.watching(end)))
}
