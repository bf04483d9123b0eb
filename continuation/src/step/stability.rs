//! How many modes are unstable, and how surely that is known.
//!
//! From the inertia where the factors report it (symmetric matrices), else from the full spectrum
//! of a dense matrix: both are certain.

use super::State;
use crate::linalg::Matrix;
use crate::problem::{Problem, Stability};

/// Counts unstable modes of one problem.
pub(crate) struct StabilityCount<P: Problem> {
    sense: Stability,
    multipliers: usize,
    mass: Option<P::Jacobian>,
}

impl<P: Problem> StabilityCount<P> {
    pub(crate) fn new(problem: &P) -> Self {
        let mut mass = problem.new_jacobian();
        mass.set_zero();
        let mass = problem.mass(&mut mass).then_some(mass);
        StabilityCount { sense: problem.stability(), multipliers: problem.multipliers(), mass }
    }

    /// Sets the counts at `x`, whose Jacobian is factored.
    pub(crate) fn judge(
        &mut self,
        _problem: &P,
        jacobian: &mut P::Jacobian,
        inertia: Option<(usize, usize)>,
        x: &mut State,
    ) {
        (x.unstable, x.count, x.certified) = (None, None, false);
        (x.pair, x.frequency, x.pairs) = (f64::NAN, f64::NAN, 0);
        let energy = self.sense == Stability::EnergyHessian;
        if let Some((negative, positive)) = inertia {
            let side = if energy { negative } else { positive };
            x.count = Some(side);
        } else if let Some(spectrum) = jacobian.spectrum(self.mass.as_ref()) {
            let largest = spectrum.iter().fold(0.0, |m: f64, (re, im)| m.max(re.hypot(*im)));
            let zero = 4.0 * spectrum.len() as f64 * f64::EPSILON * largest;
            let sign = if energy { -1.0 } else { 1.0 };
            x.count = Some(spectrum.iter().filter(|(re, _)| sign * re > zero).count());
            if !energy {
                let pairs = spectrum.iter().filter(|(_, im)| *im > 0.0);
                x.pairs = pairs.clone().count();
                let nearest = pairs.min_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
                if let Some((re, im)) = nearest {
                    (x.pair, x.frequency) = (*re, *im);
                }
            }
        }
        x.certified = x.count.is_some();
        if self.sense != Stability::None {
            let multipliers = if energy { self.multipliers } else { 0 };
            x.unstable = x.count.map(|count| count.saturating_sub(multipliers));
        }
    }
}
