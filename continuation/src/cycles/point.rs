//! What is known of one cycle: multipliers, stability, errors, and what is observed on it.

use super::collocation::CycleProblem;
use super::cycle::Cycle;
use super::finer::Finer;
use super::floquet::Multiplier;
use crate::problem::ParamId;
use serde::{Deserialize, Serialize};

/// Deviation of the trivial multiplier from 1 above which it is not told from the others: nothing is
/// known of stability then, nor of errors.
const UNKNOWN: f64 = 0.05;
/// Factor by which the change on halving the intervals is less than the error: `1/(1 − 2^(−2m))`, at
/// most 16/15, and what the asymptotic law leaves open.
const SAFETY: f64 = 1.5;

/// A cycle of a branch with what is known of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CyclePoint {
    /// The orbit, its period and the parameters.
    pub cycle: Cycle,
    /// The Floquet multipliers, the largest first, the trivial one among them; empty where they have no
    /// finite values.
    pub multipliers: Vec<Multiplier>,
    /// Index of the trivial multiplier, the one nearest to 1.
    pub trivial: Option<usize>,
    /// How far the trivial multiplier is from 1: the error that is seen, of which the other multipliers
    /// have at least as much; `None` without multipliers.
    pub trivial_error: Option<f64>,
    /// Estimated relative error of period and states at the mesh points, from the solution with every
    /// interval halved, its own or those of two neighbours that agree; `None` where it was not sought or not found, and
    /// where the trivial multiplier is not identified: the mesh is too coarse for its errors to be estimated.
    pub error: Option<f64>,
    /// The same, of the period alone.
    pub period_error: Option<f64>,
    /// Estimated error of the parameter: not zero where the branch is vertical and the finer solution
    /// was sought across it.
    pub parameter_error: Option<f64>,
    /// Number of multipliers outside the unit circle, the trivial one not counted; `None` where that one
    /// is not identified.
    pub unstable: Option<usize>,
    /// Whether that number is certain as far as the errors of the multipliers are: the trivial one is
    /// identified, and no other is within its error of the unit circle.
    pub certified: bool,
}

/// Index of the multiplier nearest to 1.
pub(super) fn trivial(all: &[Multiplier]) -> Option<usize> {
    let off = |m: &Multiplier| m.distance(&Multiplier::ONE);
    (0..all.len()).min_by(|a, b| off(&all[*a]).total_cmp(&off(&all[*b])))
}

impl CyclePoint {
    /// What is known of a solution of the collocation equations.
    pub(super) fn of(
        equations: &CycleProblem<'_>,
        x: &[f64],
        p: &[f64],
        finer: Option<&Finer>,
        which: ParamId,
    ) -> Self {
        let cycle = equations.cycle(x, p);
        let multipliers = equations.multipliers(x, p).unwrap_or_default();
        let trivial = trivial(&multipliers);
        let trivial_error = trivial.map(|t| multipliers[t].distance(&Multiplier::ONE));
        let mut point = CyclePoint {
            cycle,
            multipliers,
            trivial,
            trivial_error,
            error: None,
            period_error: None,
            parameter_error: None,
            unstable: None,
            certified: false,
        };
        point.estimate(equations, x, finer, which);
        point
    }

    /// Errors from the solution with every interval halved, and the count that they allow.
    pub(super) fn estimate(
        &mut self,
        equations: &CycleProblem<'_>,
        x: &[f64],
        finer: Option<&Finer>,
        which: ParamId,
    ) {
        // halving says nothing of an orbit that neither mesh resolves
        let resolved = self.trivial_error.is_some_and(|off| off <= UNKNOWN);
        if let Some(finer) = finer.filter(|_| resolved) {
            let period = SAFETY * (finer.period / self.cycle.period - 1.0).abs();
            let (n, m) = (equations.n, equations.basis.degree);
            let states = (0..equations.intervals() * n).map(|i| {
                let (j, k) = (i / n, i % n);
                (x[j * m * n + k] - finer.mesh_values[i]).abs()
            });
            let states = SAFETY * states.fold(0.0, f64::max) / self.cycle.amplitude();
            self.error = Some(period.max(states));
            self.period_error = Some(period);
            let p = self.cycle.parameters[which.0];
            self.parameter_error = Some(SAFETY * (finer.state.p - p).abs());
            let trivial = self.trivial_error.unwrap_or(f64::NAN);
            assign_errors(&mut self.multipliers, &finer.multipliers, trivial);
        }
        self.judge();
    }

    /// Counts unstable multipliers.
    pub(super) fn judge(&mut self) {
        let (Some(trivial), Some(off)) = (self.trivial, self.trivial_error) else { return };
        if off.is_nan() || off > UNKNOWN {
            return;
        }
        let others = || self.multipliers.iter().enumerate().filter(|(i, _)| *i != trivial);
        self.unstable = Some(others().filter(|(_, m)| m.log_modulus > 0.0).count());
        let certain = |(_, m): (usize, &Multiplier)| {
            m.error.is_some_and(|error| m.log_modulus.abs() > 2.0 * error)
        };
        let away = others().all(certain);
        self.certified = away && self.error.is_some();
    }
}

/// Errors of the multipliers: how much they change when the intervals are halved, each against the
/// nearest one that is left, what the trivial one shows, and rounding.
fn assign_errors(multipliers: &mut [Multiplier], finer: &[Multiplier], trivial: f64) {
    let mut free: Vec<&Multiplier> = finer.iter().collect();
    for multiplier in multipliers {
        let nearest = (0..free.len())
            .min_by(|a, b| free[*a].distance(multiplier).total_cmp(&free[*b].distance(multiplier)));
        let change = nearest.map_or(f64::NAN, |i| free.swap_remove(i).distance(multiplier));
        let rounding = 1e-14 * (1.0 + multiplier.log_modulus.abs());
        let error = SAFETY * change + trivial + rounding;
        multiplier.error = error.is_finite().then_some(error);
    }
}
