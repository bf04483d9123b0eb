//! Observables that are the same on both sides of a pitchfork have an extremum there, on the branch
//! that leaves it: neither departure nor passage may stumble over that.

#![allow(clippy::unwrap_used)]

use continuation::diagram::{Diagram, DiagramSettings, Explorer};
use continuation::{
    DenseProblem, EventKind, Problem, Settings, Shape, Stability, StopReason, Watch,
};
use std::ops::ControlFlow;

/// Two springs in series, `F(x) = x³ − x`, with a coupling: equal ones (`a = b = p`) lose their
/// symmetry at `3p² = 1 − c`, just inside the extrema of the force, and the unequal ones are an
/// ellipse between the two points. The states are rotated and stretched, so that nothing is zero to
/// the bit.
fn springs(c: f64) -> impl Problem {
    let force = |x: f64| x * x * x - x;
    let shape = |u: &[f64]| (0.8 * u[0] - 0.6e-2 * u[1], 0.6 * u[0] + 0.8e-2 * u[1]);
    DenseProblem::from_residual(2, &["p"], move |u, p, r| {
        let (a, b) = shape(u);
        let (apart, sum) = (force(a) - force(b) + c * (a - b), a + b - 2.0 * p[0]);
        r[0] = 40.0 * (0.8 * apart - 0.6 * sum);
        r[1] = 40.0 * (0.6 * apart + 0.8 * sum);
    })
    .boxed()
    .with_stability(Stability::None)
    .observing("force", move |u, _| {
        let (a, b) = shape(u);
        0.5 * (force(a) + force(b))
    })
}

fn explore(c: f64) -> Diagram {
    let problem = springs(c);
    let trace = Settings { target: Some(1.0), ..Settings::default() };
    let settings = DiagramSettings { trace, search: None, ..DiagramSettings::default() };
    // a = b = −1
    let u = [-1.4, -20.0];
    let watches = [Watch::zero("force"), Watch::extremum("force")];
    let explorer = Explorer::new(&problem, "p", &u, &[-1.0], settings, &watches).unwrap();
    explorer.run(&mut |_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn branches_leave_and_arrive_where_an_observable_is_stationary() {
    for c in [0.02, 0.1, 0.3] {
        let diagram = explore(c);
        let ends: Vec<_> = diagram.branches.iter().map(|one| &one.branch.stopped).collect();
        assert!(diagram.is_complete(), "c = {c}: {ends:?}");
        let trunk = &diagram.branches[0].branch;
        let at = ((1.0 - c) / 3.0_f64).sqrt();
        let forks: Vec<_> = trunk.events_of(&EventKind::BranchPoint).collect();
        assert_eq!(forks.len(), 2);
        for (fork, sign) in forks.iter().zip([-1.0, 1.0]) {
            assert!((fork.p - sign * at).abs() < 1e-10);
            assert_eq!(fork.crossing().unwrap().shape, Shape::Pitchfork);
        }
        // the ellipse once around, through the other fork
        assert_eq!(diagram.branches.len(), 2, "c = {c}: {ends:?}");
        let ellipse = &diagram.branches[1].branch;
        assert_eq!(ellipse.stopped.reason, StopReason::ClosedLoop);
        let kinds: Vec<_> = ellipse.events.iter().map(|e| e.kind.to_string()).collect();
        let count = |name: &str| kinds.iter().filter(|kind| kind.starts_with(name)).count();
        // six ordered pairs of the roots −1, 0, 1, and an extremum between those of each sum
        assert_eq!(
            (count("zero"), count("force-m"), count("fold")),
            (6, 4, 0),
            "c = {c}: {kinds:?}"
        );
        assert_eq!(count("branch-point"), 2);
    }
}
