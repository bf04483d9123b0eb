//! Whole diagrams: what is found, that nothing is found twice, and that each ends by itself.

#![allow(clippy::unwrap_used)]

use continuation::diagram::{
    Diagram, DiagramError, DiagramSettings, DiagramStop, Explorer, Origin,
};
use continuation::linalg::Dense;
use continuation::{
    DenseProblem, EvalError, EventKind, Matrix, ParamId, Parameter, Problem, Settings, Stability,
    StopReason,
};
use std::ops::ControlFlow;

fn within(lo: f64, hi: f64) -> DiagramSettings {
    let trace = Settings { domain: Some((lo, hi)), ..Settings::default() };
    DiagramSettings { trace, ..DiagramSettings::default() }
}

fn explore<P: Problem>(problem: &P, u: &[f64], p: &[f64], settings: DiagramSettings) -> Diagram {
    let name = &problem.parameters()[0].name;
    let explorer = Explorer::new(problem, name, u, p, settings, &[]).unwrap();
    explorer.run(&mut |_| ControlFlow::Continue(())).unwrap()
}

/// Every solution is on one branch only, but for the joints.
fn nothing_twice(diagram: &Diagram) {
    let inner = |points: &[continuation::Point]| {
        let middle = &points[1..points.len().saturating_sub(1).max(1)];
        middle.iter().filter(|q| q.event.is_none()).cloned().collect::<Vec<_>>()
    };
    for (i, one) in diagram.branches.iter().enumerate() {
        for other in &diagram.branches[..i] {
            for q in inner(&one.branch.points) {
                // the other branch's points at both sides of the same parameter
                for pair in other.branch.points.windows(2) {
                    let (a, b) = (&pair[0], &pair[1]);
                    let t = (q.p - a.p) / (b.p - a.p);
                    if !(0.0..=1.0).contains(&t) {
                        continue;
                    }
                    let far = q.u.iter().zip(a.u.iter().zip(&b.u));
                    let far =
                        far.map(|(q, (a, b))| (q - a - t * (b - a)).abs()).fold(0.0, f64::max);
                    let near = 1e-3 * (b.s - a.s);
                    assert!(far > near, "{} and {} at {}: {far}", one.id, other.id, q.p);
                }
            }
        }
    }
}

#[test]
fn no_special_points() {
    let problem =
        DenseProblem::from_residual(1, &["p"], |u, p, r| r[0] = p[0] - u[0] - u[0].powi(3)).boxed();
    let diagram = explore(&problem, &[0.0], &[0.0], within(-1.0, 2.0));
    assert_eq!((diagram.branches.len(), diagram.joints.len()), (1, 0));
    assert!(diagram.is_complete());
    let points = &diagram.branches[0].branch.points;
    assert_eq!((points[0].p, points.last().unwrap().p), (-1.0, 2.0));
}

#[test]
fn isola_with_a_branch_across() {
    // a circle in (x, p), and through each of its two crossings with y = x - p … another branch
    let problem = DenseProblem::from_residual(2, &["p"], |u, p, r| {
        r[0] = u[0] * u[0] + p[0] * p[0] - 1.0;
        r[1] = u[1] * (u[0] - 0.5 - u[1] * u[1]);
    })
    .boxed();
    let diagram = explore(&problem, &[1.0, 0.0], &[0.0], within(-2.0, 2.0));
    assert!(
        diagram.is_complete(),
        "{:?}",
        diagram.branches.iter().map(|b| &b.branch.stopped).collect::<Vec<_>>()
    );
    assert_eq!(diagram.branches[0].branch.stopped.reason, StopReason::ClosedLoop);
    // both halves of each fork connect the two points
    assert_eq!(diagram.joints.len(), 2);
    assert_eq!(diagram.branches.len(), 2, "{:?}", diagram.joints);
    assert!(diagram.joints.iter().all(|joint| joint.open == 0), "{:?}", diagram.joints);
    nothing_twice(&diagram);
}

#[test]
fn hundreds_of_special_points() {
    // the sine crosses u = 0 three hundred times
    let n = 300.0 * std::f64::consts::PI;
    let problem = DenseProblem::from_residual(1, &["p"], |u, p, r| {
        r[0] = u[0] * (p[0].sin() - u[0]);
    })
    .boxed();
    let trace = Settings {
        target: Some(n - 1.0),
        domain: Some((-1.0, n - 1.0)),
        max_step: Some(0.5),
        max_points: 20_000,
        ..Settings::default()
    };
    let settings = DiagramSettings { trace, depth: 1, ..DiagramSettings::default() };
    let diagram = explore(&problem, &[0.0], &[-1.0], settings);
    assert!(diagram.is_complete());
    let points = diagram.branches[0].branch.events_of(&EventKind::BranchPoint).count();
    assert_eq!(points, 300);
    // the sine passes all joints, to the right and to the left of the first
    assert_eq!(
        diagram.branches.len(),
        3,
        "{:?}",
        diagram.branches.iter().map(|b| (b.origin, b.branch.points.len())).collect::<Vec<_>>()
    );
    assert_eq!(diagram.joints.len(), 300);
    nothing_twice(&diagram);
}

#[test]
fn branches_that_an_imperfection_keeps_apart() {
    for imperfection in [1e-2, 1e-3, 1e-5] {
        let problem = DenseProblem::from_residual(1, &["p"], move |u, p, r| {
            r[0] = p[0] * u[0] - u[0].powi(3) + imperfection;
        })
        .boxed();
        let diagram = explore(&problem, &[0.0], &[-1.0], within(-1.0, 1.0));
        assert!(diagram.is_complete());
        assert_eq!(diagram.branches.len(), 2, "{imperfection}");
        let other = &diagram.branches[1];
        assert!(matches!(other.origin, Origin::Deflation { branch: 0, near: 0, .. }));
        // one branch, from bound to bound, around its fold
        let ends = [other.branch.points[0].p, other.branch.points.last().unwrap().p];
        assert_eq!(ends, [1.0, 1.0]);
        assert_eq!(other.branch.events_of(&EventKind::Fold).count(), 1);
        nothing_twice(&diagram);
        let none = DiagramSettings { search: None, ..within(-1.0, 1.0) };
        assert_eq!(explore(&problem, &[0.0], &[-1.0], none).branches.len(), 1);
    }
}

#[test]
fn depth_bounds_the_exploration() {
    for (depth, branches) in [(0, 1), (1, 3), (2, 7), (3, 15)] {
        let settings = DiagramSettings { depth, ..within(-1.0, 1.0) };
        let diagram = explore(&Chain, &[0.0; 3], &[-1.0], settings);
        assert_eq!(diagram.branches.len(), branches, "{depth}");
        assert!(diagram.is_complete());
        let deepest = diagram.branches.iter().map(|one| one.depth).max();
        assert_eq!(deepest, Some(depth));
        nothing_twice(&diagram);
    }
}

#[test]
fn limits_and_interruptions_keep_what_is_there() {
    let problem = DenseProblem::from_residual(2, &["p"], |u, p, r| {
        r[0] = p[0] * u[0] - u[0].powi(3);
        r[1] = (p[0] - 0.5) * u[1] - u[1].powi(3);
    })
    .boxed();
    let settings = DiagramSettings { max_branches: 2, ..within(-1.0, 1.0) };
    let diagram = explore(&problem, &[0.0; 2], &[-1.0], settings);
    assert_eq!((diagram.branches.len(), diagram.stopped), (2, DiagramStop::MaxBranches));
    let explorer =
        Explorer::new(&problem, "p", &[0.0; 2], &[-1.0], within(-1.0, 1.0), &[]).unwrap();
    let diagram = explorer
        .run(&mut |at| {
            if at.branches == 1 && at.at.points == 3 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        })
        .unwrap();
    assert_eq!((diagram.branches.len(), diagram.stopped), (2, DiagramStop::Interrupted));
    let last = &diagram.branches[1].branch;
    assert!(last.points.len() >= 3 && last.stopped.reason == StopReason::Interrupted);
}

#[test]
fn resumed_after_any_number_of_branches_it_is_the_same() {
    let (u, p) = ([0.0; 3], [-1.0]);
    let settings = DiagramSettings { depth: 3, ..within(-1.0, 1.0) };
    let whole = explore(&Chain, &u, &p, settings.clone());
    assert_eq!(whole.branches.len(), 15);
    for kept in 0..=whole.branches.len() {
        let start = Explorer::new(&Chain, "p", &u, &p, settings.clone(), &[]);
        let finished = whole.branches[..kept].to_vec();
        let resumed = start.unwrap().resume(finished, None).unwrap();
        assert!(resumed.run(&mut |_| ControlFlow::Continue(())).unwrap() == whole, "{kept}");
    }
}

#[test]
fn stopped_and_resumed_within_branches_it_is_the_same() {
    let settings = DiagramSettings { depth: 2, ..within(-1.0, 1.0) };
    let target = Settings { target: Some(1.0), ..settings.trace.clone() };
    let settings = DiagramSettings { trace: target, ..settings };
    let new = || Explorer::new(&Chain, "p", &[0.0; 3], &[-1.0], settings.clone(), &[]).unwrap();
    let whole = new().run(&mut |_| ControlFlow::Continue(())).unwrap();
    // killed after every few points: each time only what was handed out is kept
    for every in [1, 2, 7, 20] {
        let (mut finished, mut unfinished) =
            (Vec::new(), None::<continuation::diagram::Unfinished>);
        let mut lives = 0;
        let all = loop {
            lives += 1;
            let mut explorer = new().resume(finished.clone(), unfinished.take()).unwrap();
            let (mut left, mut killed) = (every, false);
            while explorer
                .next_branch(&mut |at| {
                    left -= 1;
                    if left > 0 || killed {
                        return ControlFlow::Continue(());
                    }
                    killed = true;
                    unfinished = at.unfinished();
                    assert_eq!(unfinished.as_ref().unwrap().points().len(), at.at.points);
                    ControlFlow::Break(())
                })
                .unwrap()
                .is_some()
            {}
            if !killed {
                break explorer.finish();
            }
            let done = explorer.branches();
            finished = done[..done.len() - 1].to_vec();
            // through a file and back
            let mut bytes = Vec::new();
            ciborium::into_writer(&(&finished, &unfinished), &mut bytes).unwrap();
            (finished, unfinished) = ciborium::from_reader(&bytes[..]).unwrap();
        };
        assert!(all == whole, "{every}");
        assert!(lives > 3);
    }
}

/// Each branch has a fork.
struct Chain;

impl Problem for Chain {
    type Jacobian = Dense;

    fn dim(&self) -> usize {
        3
    }

    fn parameters(&self) -> &[Parameter] {
        const { &[Parameter::new("p", "", 1.0)] }
    }

    fn new_jacobian(&self) -> Dense {
        Dense::new(3)
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        for (i, r) in r.iter_mut().enumerate() {
            let drive = if i == 0 { p[0] } else { u[i - 1] * u[i - 1] - DRIVES[i] };
            *r = drive * u[i] - u[i].powi(3);
        }
        Ok(())
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        j.set_zero();
        for i in 0..3 {
            let drive = if i == 0 { p[0] } else { u[i - 1] * u[i - 1] - DRIVES[i] };
            j.set(i, i, drive - 3.0 * u[i] * u[i]);
            if i > 0 {
                j.set(i, i - 1, 2.0 * u[i - 1] * u[i]);
            }
        }
        Ok(())
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        _: &[f64],
        _: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        out.copy_from_slice(&[u[0], 0.0, 0.0]);
        Ok(())
    }

    fn stability(&self) -> Stability {
        Stability::Dynamics
    }
}

const DRIVES: [f64; 3] = [0.0, 0.5, 0.2];

#[test]
fn branches_of_another_diagram_are_refused() {
    let problem = |c: f64| {
        DenseProblem::from_residual(1, &["p"], move |u, p, r| {
            r[0] = (p[0] - c) * u[0] - u[0].powi(3)
        })
        .boxed()
    };
    let (one, other) = (problem(0.0), problem(5.0));
    let diagram = explore(&one, &[0.0], &[-1.0], within(-1.0, 1.0));
    assert!(matches!(diagram.branches[1].origin, Origin::Switch { branch: 0, event: 0, .. }));
    let finished = vec![diagram.branches[1].clone()];
    let explorer = Explorer::new(&one, "p", &[0.0], &[-1.0], within(-1.0, 1.0), &[]).unwrap();
    let error = explorer.resume(finished, None).err().unwrap();
    assert!(matches!(error, DiagramError::Foreign { branch: 0, .. }), "{error}");
    let wide = DenseProblem::from_residual(2, &["p"], |u, p, r| {
        r[0] = p[0] - u[0];
        r[1] = u[1];
    })
    .boxed();
    let explorer =
        Explorer::new(&wide, "p", &[-1.0, 0.0], &[-1.0], within(-1.0, 1.0), &[]).unwrap();
    let error = explorer.resume(diagram.branches, None).err().unwrap();
    assert!(matches!(error, DiagramError::Foreign { branch: 0, .. }), "{error}");
    let unbounded = Explorer::new(&other, "p", &[0.0], &[-1.0], DiagramSettings::default(), &[]);
    assert_eq!(unbounded.err(), Some(DiagramError::Unbounded));
}

/// `x (p³ − x²)`: the sign of the determinant shows a branch point, no quadratic form what leaves it.
#[test]
fn branch_points_of_unknown_branches_leave_a_diagram_incomplete() {
    let problem = DenseProblem::from_residual(1, &["p"], |u, p, r| {
        r[0] = u[0] * (p[0].powi(3) - u[0] * u[0]);
    })
    .boxed();
    let diagram = explore(&problem, &[0.0], &[-1.0], within(-1.0, 1.0));
    let branch = &diagram.branches[0].branch;
    let events: Vec<_> = branch.events_of(&EventKind::BranchPoint).collect();
    assert!(events.len() == 1 && events[0].p.abs() < 0.1, "{events:?}");
    assert!(events[0].p.abs() <= events[0].error_estimate, "{events:?}");
    assert!(diagram.branches[0].unresolved() == 1 || diagram.branches.len() > 1, "{events:?}");
    assert!(!diagram.is_complete());
}
