//! Cycles of the catalogue against what is known of them.
#![allow(clippy::unwrap_used)]

use continuation::cycles::{CycleSettings, Explored, Follow, explore};
use continuation::diagram::{DiagramSettings, Explorer};
use continuation::{Branch, EventKind, Problem, Settings, StopReason};
use problems::{Setup, Visitor, find};
use std::ops::ControlFlow;

struct Cycles {
    domain: (f64, f64),
    depth: usize,
}

impl Visitor for Cycles {
    type Output = (Vec<Branch>, Explored);

    fn visit<P: Problem>(self, problem: &P, setup: Setup) -> Self::Output {
        let trace = Settings { domain: Some(self.domain), ..setup.settings.clone() };
        let settings =
            DiagramSettings { trace: setup.settings, search: None, ..Default::default() };
        let (name, u, p) = (&setup.parameter, &setup.u, &setup.p);
        let mut explorer = Explorer::new(problem, name, u, p, settings, &setup.watches).unwrap();
        while explorer.next_branch(&mut |_| ControlFlow::Continue(())).unwrap().is_some() {}
        let equilibria: Vec<Branch> =
            explorer.finish().branches.into_iter().map(|one| one.branch).collect();
        let branches: Vec<&Branch> = equilibria.iter().collect();
        let cycles = CycleSettings::default();
        let follow = Follow { trace: &trace, cycles: &cycles, depth: self.depth, max_branches: 20 };
        let all = &|_, _| true;
        let found =
            explore(problem, &branches, all, &follow, &mut |_, _| ControlFlow::Continue(()));
        (equilibria, found.unwrap())
    }
}

fn cycles(name: &str, end: Option<f64>, domain: (f64, f64), depth: usize) -> Explored {
    let entry = find(name).unwrap();
    let mut request = entry.request();
    if end.is_some() {
        request.settings.target = end;
    }
    entry.visit(&request, Cycles { domain, depth }).unwrap().1
}

/// The period at a value of the parameter, by interpolation between the two points beside it.
fn period_at(found: &Explored, branch: usize, p: f64) -> f64 {
    let one = &found.branches[branch].cycles;
    let after = one.branch.points.iter().position(|point| point.p >= p).unwrap();
    let point = &one.branch.points[after];
    assert!((point.p - p).abs() < 1e-9, "no point at {p}: {}", point.p);
    one.cycles[after].cycle.period
}

#[test]
fn van_der_pol_at_one() {
    let found = cycles("van-der-pol", Some(1.0), (-1.0, 1.0), 0);
    assert_eq!(found.branches.len(), 1);
    assert!((period_at(&found, 0, 1.0) - 6.663_286_859_323_13).abs() < 1e-9);
    assert!(found.is_complete());
}

#[test]
fn lorenz_cycles_end_at_the_homoclinic_orbit() {
    let found = cycles("lorenz", None, (0.0, 30.0), 0);
    // one from each of the two branches, mirror images
    assert_eq!(found.branches.len(), 2, "{:?}", found.failed);
    for one in &found.branches {
        assert_eq!(one.cycles.branch.stopped.reason, StopReason::PeriodUnbounded);
        let last = one.cycles.branch.points.last().unwrap();
        assert!((last.p - 13.926_557).abs() < 1e-5, "{}", last.p);
        let certified = one.cycles.branch.points.iter().filter(|p| p.certified);
        assert!(certified.clone().count() > 30 && certified.clone().all(|p| p.unstable == Some(1)));
    }
}

#[test]
fn fitzhugh_nagumo_cycles_join_two_subcritical_hopf_points_through_canards() {
    let found = cycles("fitzhugh-nagumo", None, (0.0, 2.0), 0);
    assert_eq!(found.branches.len(), 1, "{:?}", found.failed);
    let one = &found.branches[0];
    assert_eq!(one.cycles.branch.stopped.reason, StopReason::CyclesVanish);
    assert!(one.vanishes_at.is_some());
    let branch = &one.cycles.branch;
    // the equations have the symmetry v → −v about I = a/b: the ends of the range are mirror images
    let places = branch.column("I").unwrap();
    let lowest = places.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = places.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    assert!((lowest + highest - 2.0 * 0.7 / 0.8).abs() < 1e-7, "{lowest} {highest}");
    assert!(lowest < 0.331_281_337, "{lowest}");
    // the turns lie within the explosion, where I is the same to rounding: met, or said to be missing
    let folds = branch.events_of(&EventKind::Fold).count();
    assert!(folds == 2 || !branch.is_certain() && !found.is_complete(), "{folds}");
    // the explosion: the range grows by more than half of its largest while I moves by less than 1e-3
    let heights = one.cycles.branch.column("max_v").unwrap();
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for (h, i) in heights.iter().zip(&places) {
        if (i - lowest).abs() < 1e-3 {
            (least, most) = (least.min(*h), most.max(*h));
        }
    }
    assert!(most - least > 1.0, "{least} {most}");
}

#[test]
fn roessler_doubles_its_period() {
    let found = cycles("roessler", Some(0.15), (-0.1, 0.15), 1);
    let first = &found.branches[0].cycles;
    let doubling = first.branch.events_of(&EventKind::PeriodDoubling).next().unwrap();
    assert!(doubling.doubling().unwrap().criticality.is_some());
    let doubled = found.branches.iter().find(|one| one.depth == 1).unwrap();
    let ratio = doubled.cycles.cycles[0].cycle.period / first.cycles[doubling.point].cycle.period;
    assert!((ratio - 2.0).abs() < 0.02, "{ratio}");
}

#[test]
fn ab_approaches_a_homoclinic_orbit_and_ppp_has_cycles() {
    let found = cycles("ab", None, (0.0, 0.25), 0);
    assert!(!found.branches.is_empty(), "{:?}", found.failed);
    let ends = |one: &continuation::cycles::FollowedCycles| {
        one.cycles.branch.stopped.reason == StopReason::PeriodUnbounded
    };
    assert!(found.branches.iter().any(ends));
    let found = cycles("ppp", None, (0.0, 0.6), 0);
    assert!(!found.branches.is_empty(), "{:?}", found.failed);
}
