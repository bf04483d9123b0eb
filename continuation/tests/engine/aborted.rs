//! A problem that ends the computation: at once, with everything kept that was computed.

#![allow(clippy::unwrap_used)]

use continuation::diagram::{DiagramSettings, DiagramStop, Explorer};
use continuation::linalg::Dense;
use continuation::{
    Branch, EvalError, Matrix, NewtonError, Parameter, Problem, Settings, Stability, StopReason,
    TraceError, Tracer, newton,
};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

static PARAMETERS: [Parameter; 1] = [Parameter::new("p", "", 1.0)];

/// `x' = p x − x³`, `y' = (x² − ½) y − y³`, of which only so many evaluations are to be had.
struct Patient {
    left: AtomicUsize,
    refused: AtomicUsize,
}

impl Patient {
    fn new(evaluations: usize) -> Self {
        Patient { left: evaluations.into(), refused: 0.into() }
    }
    fn ask(&self) -> Result<(), EvalError> {
        let granted = self.left.fetch_update(Relaxed, Relaxed, |left| left.checked_sub(1));
        granted.map(|_| ()).map_err(|_| {
            self.refused.fetch_add(1, Relaxed);
            EvalError::Aborted
        })
    }
}

impl Problem for Patient {
    type Jacobian = Dense;
    fn dim(&self) -> usize {
        2
    }
    fn parameters(&self) -> &[Parameter] {
        &PARAMETERS
    }
    fn new_jacobian(&self) -> Dense {
        Dense::new(2)
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        self.ask()?;
        r[0] = p[0] * u[0] - u[0].powi(3);
        r[1] = (u[0] * u[0] - 0.5) * u[1] - u[1].powi(3);
        Ok(())
    }
    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        self.ask()?;
        j.set_zero();
        j.set(0, 0, p[0] - 3.0 * u[0] * u[0]);
        j.set(1, 0, 2.0 * u[0] * u[1]);
        j.set(1, 1, u[0] * u[0] - 0.5 - 3.0 * u[1] * u[1]);
        Ok(())
    }
    fn stability(&self) -> Stability {
        Stability::Dynamics
    }
}

fn settings() -> Settings {
    Settings { target: Some(1.0), ..Settings::default() }
}

fn trace(problem: &Patient) -> Result<Branch, TraceError> {
    Ok(Tracer::new(problem, "p", &[0.0, 0.0], &[-1.0], settings())?.run_quietly())
}

const PLENTY: usize = 1_000_000;
/// More than what one normal form tries for want of a value.
const FEW: usize = 200;

#[test]
fn a_trace_ends_at_once_and_keeps_its_points() {
    let patient = Patient::new(PLENTY);
    let whole = trace(&patient).unwrap();
    assert_eq!(whole.stopped.reason, StopReason::Target);
    let needed = PLENTY - patient.left.load(Relaxed);
    let (mut begun, mut most) = (0, 0);
    for evaluations in 0..needed {
        let problem = Patient::new(evaluations);
        let Ok(part) = trace(&problem) else { continue };
        begun += 1;
        most = most.max(problem.refused.load(Relaxed));
        assert_eq!(part.stopped.reason, StopReason::Interrupted, "after {evaluations}");
        for (point, whole) in part.points.iter().zip(&whole.points) {
            assert_eq!((point.s, point.p, &point.u), (whole.s, whole.p, &whole.u));
        }
        assert!(part.points.len() <= whole.points.len());
    }
    // most of the computation is steps, and they are what is kept
    assert!(begun > needed / 2, "{begun} of {needed}");
    assert!(most <= FEW, "asked {most} times more");
}

#[test]
fn a_step_away_from_a_branch_point_ends_at_once() {
    let trunk = trace(&Patient::new(PLENTY)).unwrap();
    let event = &trunk.events[0];
    let direction = &event.crossing().unwrap().leaving[0];
    let leave = |problem: &Patient| {
        let fork = Tracer::leaving(problem, &trunk, event, direction, true, settings());
        fork.map(Tracer::run_quietly)
    };
    let patient = Patient::new(PLENTY);
    leave(&patient).unwrap();
    for evaluations in 0..PLENTY - patient.left.load(Relaxed) {
        let problem = Patient::new(evaluations);
        let Ok(fork) = leave(&problem) else { continue };
        assert_eq!(fork.stopped.reason, StopReason::Interrupted, "after {evaluations}");
        assert!(
            problem.refused.load(Relaxed) <= FEW,
            "asked {} times more",
            problem.refused.load(Relaxed)
        );
    }
}

#[test]
fn a_diagram_keeps_its_branches() {
    let run = |problem: &Patient| {
        let settings = DiagramSettings { trace: settings(), ..DiagramSettings::default() };
        let explorer = Explorer::new(problem, "p", &[0.0, 0.0], &[-1.0], settings, &[]).unwrap();
        explorer.run(&mut |_| ControlFlow::Continue(())).unwrap()
    };
    let patient = Patient::new(PLENTY);
    let whole = run(&patient);
    assert_eq!(whole.branches.len(), 7);
    let half = run(&Patient::new((PLENTY - patient.left.load(Relaxed)) / 2));
    assert_eq!(half.stopped, DiagramStop::Interrupted);
    let finished = half.branches.len() - 1;
    assert!(finished > 0 && finished < 6);
    assert_eq!(half.branches[..finished], whole.branches[..finished]);
}

#[test]
fn newton_tries_no_shorter_step() {
    for evaluations in 1..6 {
        let problem = Patient::new(evaluations);
        let error = newton(&problem, &mut [2.0, 1.0], &[1.0], &Default::default()).unwrap_err();
        let (NewtonError::Start(cause) | NewtonError::Stuck { cause: Some(cause), .. }) = error
        else {
            panic!("{error}");
        };
        assert_eq!((cause, problem.refused.load(Relaxed)), (EvalError::Aborted, 1));
    }
}
