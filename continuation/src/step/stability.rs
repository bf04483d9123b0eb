//! How many modes are unstable, and how surely that is known.
//!
//! From the inertia where the factors report it (symmetric matrices, in any storage), from a
//! symmetric part that is definite, or from the full spectrum where that is affordable: all three
//! are certain. Of larger matrices by the argument principle, where that is asked for. Else from a few
//! eigenvalues by iteration, which is a lower bound and no more.

use super::State;
use crate::any_problem::DynProblem;
use crate::linalg::{AnyMatrix, Matrix};
use crate::modes::{ModeSolver, has_certain_signs, zero};
use crate::problem::{ParamId, Stability};
use crate::settings::Counting;

/// Eigenvalues computed at every point where nothing else tells the stability.
const FEW: usize = 10;
/// Most of them: beyond it the number of unstable ones is a lower bound, and the work stays bounded.
const MOST: usize = 24;

/// Counts unstable modes of one problem.
pub(crate) struct StabilityCount {
    sense: Stability,
    multipliers: usize,
    /// Number of eigenvalues that are reported at every point.
    wanted: usize,
    solver: ModeSolver,
    /// Where stability is not read from the Jacobian.
    hessian: Option<AnyMatrix>,
    /// Number of unstable ones among the latest few eigenvalues.
    pub(super) last: usize,
}

impl StabilityCount {
    pub(crate) fn new(problem: &DynProblem<'_>, wanted: usize, counting: Counting) -> Self {
        StabilityCount {
            sense: problem.stability(),
            multipliers: problem.multipliers(),
            wanted,
            solver: ModeSolver::new(problem, wanted).counting(counting),
            hessian: (problem.stability() == Stability::SeparateHessian)
                .then(|| problem.new_jacobian()),
            last: 0,
        }
    }

    /// Whether eigenvalues are wanted, so that the factors must belong to the very state.
    pub(crate) fn wants_eigenvalues(&self) -> bool {
        self.wanted > 0
    }

    /// The eigenvalues that are reported at a state; the Jacobian there is assembled.
    pub(crate) fn eigenvalues(
        &mut self,
        problem: &DynProblem<'_>,
        jacobian: &mut AnyMatrix,
        (u, p): (&[f64], &[f64]),
        values: &mut Vec<(f64, f64)>,
    ) {
        if let Some(hessian) = &mut self.hessian {
            let inertia = hessian_inertia(problem, u, p, hessian);
            self.solver.solve(problem, hessian, inertia, values);
        } else {
            let floor = f64::EPSILON * jacobian.norm();
            let inertia = jacobian.factor(floor).inertia;
            self.solver.solve(problem, jacobian, inertia, values);
        }
    }

    /// Sets the counts at `x`, whose Jacobian is factored.
    pub(crate) fn judge(
        &mut self,
        problem: &DynProblem<'_>,
        jacobian: &mut AnyMatrix,
        inertia: Option<(usize, usize)>,
        (which, p): (ParamId, &mut [f64]),
        x: &mut State,
    ) {
        (x.unstable, x.count, x.certified) = (None, None, false);
        (x.pair, x.frequency, x.pairs) = (f64::NAN, f64::NAN, 0);
        (x.unstable_pairs, x.critical) = (0, false);
        (x.real, x.far) = (f64::NAN, f64::NAN);
        x.eigenvalues.clear();
        if let Some(curve) = problem.special_points() {
            p[which.0] = x.p;
            if let Ok(others) = curve.others(&x.u, p) {
                self.read(&others.values, (false, f64::INFINITY), x);
                (x.count, x.unstable) = (others.unstable, others.unstable);
                x.certified = others.certified;
                self.solver.pick(others.values, &mut x.eigenvalues);
            }
            return;
        }
        if let Some(hessian) = &mut self.hessian {
            p[which.0] = x.p;
            let inertia = hessian_inertia(problem, &x.u, p, hessian);
            x.unstable = inertia.map(|(negative, _)| negative.saturating_sub(self.multipliers));
            x.certified = inertia.is_some();
            self.solver.solve(problem, hessian, inertia, &mut x.eigenvalues);
            return;
        }
        let energy = self.sense == Stability::EnergyHessian;
        if let Some((negative, positive)) = inertia {
            x.count = Some(if energy { negative } else { positive });
            x.certified = true;
            self.solver.solve(problem, jacobian, inertia, &mut x.eigenvalues);
        } else if let Some(count) = self.by_symmetric_part(jacobian, energy) {
            x.count = Some(count);
            x.certified = true;
            if self.wanted > 0 {
                let few = self.solver.few(problem, jacobian, self.wanted);
                self.solver.pick(few, &mut x.eigenvalues);
            }
        } else if let Some(spectrum) = self.solver.spectrum(jacobian) {
            let slow = self.solver.slow(jacobian);
            self.read(&spectrum.values, (energy, slow), x);
            x.certified = has_certain_signs(&spectrum, slow);
            let reported = self.solver.weighted(problem, jacobian).unwrap_or(spectrum.values);
            self.solver.pick(reported, &mut x.eigenvalues);
        } else if self.sense != Stability::None {
            // more than twice as many as were unstable last, so that the unstable ones are among them
            let count = FEW.max(2 * self.last + FEW / 2).min(MOST).max(self.wanted);
            let mut few = self.solver.few(problem, jacobian, count);
            let all = self.solver.by_argument(jacobian, &mut few);
            self.read(&few, (energy, f64::INFINITY), x);
            self.last = x.count.unwrap_or(0);
            // a count that says less than was found is not believed
            if let Some((all, critical)) = all.filter(|(all, _)| *all >= self.last) {
                (x.count, x.critical, x.certified) = (Some(all), critical, true);
            }
            self.solver.pick(few, &mut x.eigenvalues);
        }
        if self.sense != Stability::None {
            let multipliers = if energy { self.multipliers } else { 0 };
            x.unstable = x.count.map(|count| count.saturating_sub(multipliers));
        }
    }

    /// The number of eigenvalues on the unstable side, where the symmetric part decides it.
    fn by_symmetric_part(&mut self, jacobian: &mut AnyMatrix, energy: bool) -> Option<usize> {
        if self.sense == Stability::None || !self.solver.mass_is_definite() {
            return None;
        }
        let part = jacobian.symmetric_part()?;
        let decided = part.whole || part.negative == 0 || part.positive == 0;
        decided.then_some(if energy { part.negative } else { part.positive })
    }

    /// Counts in a spectrum, or in a part of it. Eigenvalues larger than `slow` say nothing of the
    /// rounding errors of the others.
    fn read(&self, spectrum: &[(f64, f64)], (energy, slow): (bool, f64), x: &mut State) {
        let zero = zero(spectrum, slow);
        let sign = if energy { -1.0 } else { 1.0 };
        x.count = Some(spectrum.iter().filter(|(re, _)| sign * re > zero).count());
        x.critical = spectrum.iter().any(|(re, _)| re.abs() <= zero);
        if energy {
            return;
        }
        let real = spectrum.iter().filter(|(_, im)| *im == 0.0).map(|(re, _)| *re);
        let farthest = real.clone().max_by(|a, b| a.abs().total_cmp(&b.abs()));
        x.far = farthest.map_or(0.0, f64::recip);
        x.real = real.min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(f64::NAN);
        let pairs = spectrum.iter().filter(|(_, im)| *im > 0.0);
        x.pairs = pairs.clone().count();
        x.unstable_pairs = pairs.clone().filter(|(re, _)| *re > zero).count();
        let nearest = pairs.min_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
        if let Some((re, im)) = nearest {
            (x.pair, x.frequency) = (*re, *im);
        }
    }
}

/// Assembles and factors the Hessian that is not the Jacobian; its numbers of negative and positive
/// eigenvalues.
pub(crate) fn hessian_inertia(
    problem: &DynProblem<'_>,
    u: &[f64],
    p: &[f64],
    hessian: &mut AnyMatrix,
) -> Option<(usize, usize)> {
    problem.energy_hessian(u, p, hessian).ok()?;
    let floor = f64::EPSILON * hessian.norm();
    hessian.factor(floor).inertia
}
