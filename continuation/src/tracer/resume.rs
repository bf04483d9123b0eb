//! A trace that goes on with another discretisation of the same branch.

use super::Tracer;
use crate::any_problem::DynProblem;
use crate::problem::ParamId;
use crate::settings::Settings;
use crate::step::{Constraint, Core, Precision, Refusal, State, StepSize, Weights};

/// What one trace hands on to the next.
#[derive(Debug, Clone)]
pub(crate) struct Baton {
    /// The last point, with its tangent.
    pub(crate) at: State,
    weights: Weights,
    size: StepSize,
    /// Range of the parameter.
    range: f64,
    /// Whether the derivatives were looked at.
    examined: bool,
}

impl Baton {
    /// Has the unknowns measured by this length, if it is longer than the one so far.
    pub(crate) fn measure_by(&mut self, unknowns: f64) {
        self.weights.unknowns = self.weights.unknowns.max(unknowns);
    }
}

impl<'a> Tracer<'a> {
    /// Where the trace stands, and by which lengths it measures.
    pub(crate) fn baton(&self, range: f64) -> Baton {
        Baton {
            at: self.current.clone(),
            weights: self.core.weights,
            size: self.size,
            range,
            examined: self.is_examined(),
        }
    }

    /// A trace from `baton`, whose state is near a solution of `problem`: corrected on the plane across
    /// its tangent, so that the parameter need not be what determines it. Refused where the correction is
    /// longer than `most`, in the scaled metric.
    pub(crate) fn resume(
        problem: &'a DynProblem<'a>,
        which: ParamId,
        p: &[f64],
        baton: &Baton,
        settings: Settings,
        most: f64,
    ) -> Result<Self, Refusal> {
        let mut core = Core::new(problem, which, p, baton.weights, &settings);
        let mut base = baton.at.clone();
        base.mtu.resize(base.u.len(), 0.0);
        problem.metric(&base.tu, &mut base.mtu);
        let norm = baton.weights.norm(&base.mtu, &base.tu, base.tp);
        base.scale_tangent(1.0 / norm);
        let mut start = State::new(base.u.len(), problem.observables().len());
        start.u.copy_from_slice(&base.u);
        start.p = base.p;
        let corrected =
            core.correct(Constraint::Plane(&base, 0.0), &mut start, Precision::Event)?;
        if corrected.first > most {
            return Err(Refusal::FarFromPrediction { ratio: corrected.first });
        }
        let mut tracer =
            Self::set_up(core, start, p, settings, baton.range).map_err(|_| Refusal::Singular)?;
        tracer.size = baton.size;
        tracer.examined = baton.examined;
        // the same step, in the lengths by which it is measured now
        tracer.size.h *= norm;
        Ok(tracer)
    }

    /// The range of the parameter by which the trace measured at its start.
    pub(crate) fn expected_range(&self) -> f64 {
        self.core.weights.parameter
    }
}
