//! Structures with an imperfection: the branches that it disconnects, found from the first one.

#![allow(clippy::unwrap_used)]

use continuation::deflation::{DeflationSettings, disconnected, lies_on};
use continuation::linalg::SymmetricBand;
use continuation::{
    Branch, EvalError, EventKind, NearBifurcation, NearKind, NearSettings, ParamId, Parameter,
    Problem, Settings, Stability, both_ways, near_bifurcations,
};
use problems::arch::ShallowArch;
use problems::euler_column::EulerColumn;
use std::ops::ControlFlow;

/// The first branch, its near-bifurcations, and all branches.
fn explore<P: Problem>(
    problem: &P,
    u: &[f64],
    p: &[f64],
    domain: (f64, f64),
) -> (Vec<NearBifurcation>, Vec<Branch>) {
    let name = &problem.parameters()[0].name;
    let mut go_on = |_: &_| ControlFlow::Continue(());
    let settings = Settings { domain: Some(domain), ..Settings::default() };
    let search = DeflationSettings::default();
    let first = both_ways(problem, name, u, p, settings.clone(), &[], &mut go_on).unwrap();
    let near = near_bifurcations(problem, &first, NearSettings::default()).unwrap();
    let mut branches = vec![first];
    for start in disconnected(problem, &branches, &near, &[], &search).unwrap() {
        let known = |b: &Branch| lies_on(problem, b, &start.u, &start.p, &search).unwrap();
        if !branches.iter().any(known) {
            let (u, p, settings) = (&start.u, &start.p, settings.clone());
            branches.push(both_ways(problem, name, u, p, settings, &[], &mut go_on).unwrap());
        }
    }
    (near, branches)
}

/// Euler's column with a small constant moment along it: `−θ″ = λ sin θ + e`.
struct Imperfect(EulerColumn, f64);

impl Problem for Imperfect {
    type Jacobian = SymmetricBand;
    fn dim(&self) -> usize {
        self.0.dim()
    }
    fn parameters(&self) -> &[Parameter] {
        self.0.parameters()
    }
    fn new_jacobian(&self) -> SymmetricBand {
        self.0.new_jacobian()
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        self.0.residual(u, p, r)?;
        r.iter_mut().for_each(|r| *r -= self.1);
        Ok(())
    }
    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut SymmetricBand) -> Result<(), EvalError> {
        self.0.jacobian(u, p, j)
    }
    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        self.0.parameter_derivative(u, p, which, out)
    }
    fn metric(&self, x: &[f64], y: &mut [f64]) {
        self.0.metric(x, y);
    }
    fn stability(&self) -> Stability {
        self.0.stability()
    }
}

#[test]
fn the_column_that_buckles_the_other_way() {
    for e in [1e-4, 1e-2, 0.1] {
        let problem = Imperfect(EulerColumn::new(100), e);
        let (near, branches) = explore(&problem, &[0.0; 100], &[9.0], (9.0, 11.0));
        assert_eq!(near.len(), 1, "{e}");
        assert!((near[0].p - problem.0.branch_point(1)).abs() < 1e-3, "{}", near[0].p);
        assert_eq!(branches.len(), 2, "{e}");
        assert_eq!(branches[1].events_of(&EventKind::Fold).count(), 1);
        let fold = branches[1].events.iter().find(|f| f.kind == EventKind::Fold).unwrap();
        assert_eq!((fold.unstable_before.unwrap() + fold.unstable_after.unwrap()), 1);
    }
}

/// Rise 4: pitchforks of the symmetric load at `4 ± 3√12` times the factors of the mesh. Under loads
/// that press, the symmetric states beyond the first one and half of the asymmetric ones are
/// disconnected.
#[test]
fn the_arch_that_snaps_the_other_way() {
    for e in [1e-3, 1e-2] {
        let problem = ShallowArch::new(60);
        let start = problem.unloaded(4.0);
        let (near, branches) = explore(&problem, &start, &[0.0, 4.0, e], (0.0, 30.0));
        assert_eq!(near.len(), 1, "{e}: {near:?}");
        assert!((near[0].p - 14.38).abs() < 0.1, "{}", near[0].p);
        let passes = |b: &Branch| {
            let signs = b.points.windows(2).map(|w| (w[0].p - 10.0) * (w[1].p - 10.0));
            signs.filter(|product| *product < 0.0).count()
        };
        // the snapped states are far from it, connected only through negative loads: if not already
        // beside the near-bifurcation, they are found where they are asked for
        let all: Vec<_> = branches.iter().map(passes).collect();
        assert!(all == [2, 2] || all == [2, 2, 1], "{e}: {all:?}");
        let search = DeflationSettings::default();
        let found = disconnected(&problem, &branches, &[], &[10.0], &search).unwrap();
        let settings = Settings { domain: Some((0.0, 30.0)), ..Settings::default() };
        let snapped = branches[2..].iter().any(|b| passes(b) == 1);
        let snapped = snapped
            || found.iter().any(|start| {
                let (u, p, settings) = (&start.u, &start.p, settings.clone());
                let mut go_on = |_: &_| ControlFlow::Continue(());
                let name = &problem.parameters()[0].name;
                let branch = both_ways(&problem, name, u, p, settings, &[], &mut go_on).unwrap();
                passes(&branch) == 1
            });
        assert!(snapped, "{e}: {} found", found.len());
        let highest =
            branches[1..2].iter().flat_map(|b| &b.events).map(|f| f.p).fold(0.0, f64::max);
        assert!((26.0..26.5).contains(&highest), "{highest}");
    }
}

/// The same arch pulled as well: the load turns, and with it the imperfection, so that one branch
/// passes all five states. Nothing is found besides.
#[test]
fn nothing_where_all_is_connected() {
    let problem = ShallowArch::new(60);
    let start = problem.unloaded(4.0);
    let (near, branches) = explore(&problem, &start, &[0.0, 4.0, 1e-2], (-20.0, 30.0));
    let places: Vec<(NearKind, f64)> = near.iter().map(|n| (n.kind, n.p)).collect();
    assert_eq!(near.len(), 2, "{places:?}");
    assert!((places[0].1 - 14.38).abs() < 0.1 && (places[1].1 + 6.38).abs() < 0.1, "{places:?}");
    assert_eq!(branches.len(), 1);
}
