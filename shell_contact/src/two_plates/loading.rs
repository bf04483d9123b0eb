//! The shell from pole to pole as a device moves its plates: cycles, jumps and where they begin.
//!
//! Both plates belong to one grip, `z0` being half their distance. An upper plate on a cantilever of
//! stiffness `k_c` whose base is at `z = base` moves by `z_t − base = 2(z0 − base)`, so that it is to
//! `z0` a spring of stiffness `2k_c`: [`Device::Cantilever`] with that stiffness, and the potential
//! `(√k_b/2) k_c (z_t − base)²`.
//!
//! The drag of a motion is that of the metric. A multiplier has none: held, the equator stays where it
//! is, and the motion is that of the rest.

use super::{SupportedProblem, TwoPlatesProblem, parameter};
use crate::device::{Device, Loading, MotionError, Relaxation, RelaxationSettings, Side};
use crate::film::Potential;
use continuation::linalg::{Arrow, SymmetricBand};
use continuation::{EvalError, Matrix, NewtonSettings, Problem, newton};

/// Energies that differ by less, relative, are those of mirror images.
const SAME_ENERGY: f64 = 1e-9;

/// A stable state of the shell between plates where the device's parameter is `value`: the one that
/// Newton's method finds from `rest`, or that to which the shell moves from there. Where the
/// equilibrium between two plates is unstable it is a state on one of them, on that of the lower
/// energy if they differ.
///
/// # Errors
/// When the motion does not come to an end.
pub fn stable_start<P: Loading>(
    problem: &P,
    rest: &[f64],
    value: f64,
) -> Result<Vec<f64>, MotionError> {
    let p = problem.parameters_at(value);
    let mut relaxation = Relaxation::new(problem, RelaxationSettings::default());
    let mut x = rest.to_vec();
    if newton(problem, &mut x, &p, &NewtonSettings::default()).is_err() {
        relaxation.from_state(problem, rest, &p)?;
        return Ok(relaxation.state().to_vec());
    }
    let mut hessian = problem.new_jacobian();
    problem.jacobian(&x, &p, &mut hessian).map_err(MotionError::Start)?;
    let floor = f64::EPSILON * hessian.norm();
    let inertia = hessian.factor(floor).inertia;
    if inertia.is_some_and(|(negative, _)| negative <= problem.multipliers()) {
        return Ok(x);
    }
    relaxation.from_saddle(problem, &x, &p, Side::First)?;
    let first = relaxation.state().to_vec();
    if relaxation.from_saddle(problem, &x, &p, Side::Second).is_err() {
        return Ok(first);
    }
    let energy = |x: &[f64]| problem.potential(x, &p).map_err(MotionError::Start);
    let (one, other) = (energy(&first)?, energy(relaxation.state())?);
    // of two mirror images the first
    let lower = one - other > SAME_ENERGY * one.abs().max(other.abs());
    Ok(if lower { relaxation.state().to_vec() } else { first })
}

/// The columns of the forces on both plates.
fn both_forces() -> [usize; 2] {
    [column("force"), column("force_bottom")]
}

fn column(name: &str) -> usize {
    super::NAMES.iter().position(|own| *own == name).unwrap_or(usize::MAX)
}

impl TwoPlatesProblem {
    /// Whether both plates have the same film.
    pub(super) fn plates_are_alike(&self) -> bool {
        let (top, bottom) = (self.groups.top, self.groups.bottom);
        // potentials of other types may be the same functions: in attraction, at rest, in repulsion
        let same = |at: f64| {
            let (delta, w) = (at * top.film, top.adhesion);
            let (a, b) = &self.potentials;
            a.energy(delta, w, top.film) == b.energy(delta, w, top.film)
        };
        top == bottom && [2.0, 1.0, 0.7].into_iter().all(same)
    }
}

impl Loading for TwoPlatesProblem {
    fn device(&self) -> Device {
        Device::Grip
    }

    fn parameters_at(&self, value: f64) -> Vec<f64> {
        TwoPlatesProblem::parameters_at(self, value)
    }

    fn plate(&self, _: &[f64], p: &[f64]) -> f64 {
        p[parameter::Z0.0]
    }

    fn mean_force(&self, x: &[f64], p: &[f64]) -> Result<f64, EvalError> {
        let (c, _) = self.coefficients(x.len(), p)?;
        self.mean_force_between(x, &c)
    }

    fn forces(&self) -> [usize; 2] {
        both_forces()
    }

    fn energy(&self, x: &[f64], p: &[f64]) -> Result<f64, EvalError> {
        self.total_energy(x, p)
    }

    fn add_drag(&self, a: f64, h: &mut SymmetricBand) {
        h.axpy(a, &self.mass);
    }

    fn root(&self, p: &[f64]) -> f64 {
        p[parameter::BENDING.0].sqrt()
    }

    fn shell_part<'x>(&self, x: &'x [f64]) -> &'x [f64] {
        x
    }

    /// Where both plates are the same.
    fn mirrored(&self, x: &[f64], _: &[f64]) -> Option<Vec<f64>> {
        let alike = self.plates_are_alike();
        alike.then(|| self.reflected(x))
    }
}

impl Loading for SupportedProblem<'_> {
    fn device(&self) -> Device {
        match self.support().spring {
            Some(stiffness) => Device::Cantilever { stiffness: 2.0 * stiffness },
            None => Device::Grip,
        }
    }

    fn parameters_at(&self, value: f64) -> Vec<f64> {
        SupportedProblem::parameters_at(self, value)
    }

    fn plate(&self, x: &[f64], p: &[f64]) -> f64 {
        self.half_distance(x, p)
    }

    fn mean_force(&self, x: &[f64], p: &[f64]) -> Result<f64, EvalError> {
        let (u, c, _) = self.inner(x, p)?;
        self.shell().mean_force_between(u, &c)
    }

    fn forces(&self) -> [usize; 2] {
        both_forces()
    }

    fn energy(&self, x: &[f64], p: &[f64]) -> Result<f64, EvalError> {
        let (u, c, gas) = self.inner(x, p)?;
        self.shell().energy_between(u, &c, &gas)
    }

    fn add_drag(&self, a: f64, h: &mut Arrow<SymmetricBand>) {
        h.core_mut().axpy(a, &self.shell().mass);
        if let Some(k) = self.spring_border() {
            let corner = h.corner(k, k);
            h.set_corner(k, k, corner + a);
        }
    }

    fn root(&self, p: &[f64]) -> f64 {
        p[parameter::BENDING.0].sqrt()
    }

    fn shell_part<'x>(&self, x: &'x [f64]) -> &'x [f64] {
        x
    }

    fn force(&self, x: &[f64], p: &[f64]) -> Result<f64, EvalError> {
        Ok(self.observation(x, p)?.0.whole.force)
    }

    /// Between two equal plates. A spring leaves the mirror in the middle between them, where the shell is
    /// free to follow it.
    fn mirrored(&self, x: &[f64], p: &[f64]) -> Option<Vec<f64>> {
        let shell = self.shell();
        let (u, more) = x.split_at(shell.dim());
        let Some(spring) = self.spring_border() else {
            // the multiplier is a difference of forces
            let more = more.iter().map(|m| -m);
            return shell
                .plates_are_alike()
                .then(|| shell.reflected(u).into_iter().chain(more).collect());
        };
        if self.support().held || !shell.plates_are_alike() {
            return None;
        }
        // twice the height of the middle: the lower plate is at minus the base
        let lift = more.get(spring)? - p.first()?;
        Some(
            shell
                .lifted(shell.reflected(u), lift)
                .into_iter()
                .chain(more.iter().copied())
                .collect(),
        )
    }
}
