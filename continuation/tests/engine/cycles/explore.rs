//! All cycles of a problem: where they end, what is met twice, and which way they double.

use super::systems::{System, brusselator, hopf_form, lorenz};
use continuation::cycles::{CycleOrigin, CycleSettings, Explored, Follow, explore};
use continuation::{Branch, Criticality, DenseProblem, EventKind, Problem, Settings, Stability};
use continuation::{StopReason, Tracer};
use std::ops::ControlFlow;

fn equilibria<P: Problem>(problem: &P, name: &str, u: &[f64], p: &[f64], end: f64) -> Branch {
    let settings = Settings { target: Some(end), ..Settings::default() };
    Tracer::new(problem, name, u, p, settings).unwrap().run_quietly()
}

fn all<P: Problem>(
    problem: &P,
    branches: &[&Branch],
    domain: (f64, f64),
    depth: usize,
) -> Explored {
    let trace = Settings { domain: Some(domain), ..Settings::default() };
    let cycles = CycleSettings::default();
    let follow = Follow { trace: &trace, cycles: &cycles, depth, max_branches: 20 };
    explore(problem, branches, &|_, _| true, &follow, &mut |_, _| ControlFlow::Continue(()))
        .unwrap()
}

/// Cycles between two Hopf points: `g = (p − a)(b − p) − r²` on the radius.
fn bubble(a: f64, b: f64) -> impl Problem {
    DenseProblem::from_residual(2, &["p"], move |u, p, r| {
        let g = (p[0] - a) * (b - p[0]) - u[0] * u[0] - u[1] * u[1];
        r[0] = g * u[0] - 1.5 * u[1];
        r[1] = 1.5 * u[0] + g * u[1];
    })
    .with_stability(Stability::Dynamics)
}

#[test]
fn cycles_between_two_hopf_points_are_followed_once() {
    for (a, b) in [(0.2, 1.1), (0.5, 3.0), (1.0, 1.7)] {
        let problem = bubble(a, b);
        let branch = equilibria(&problem, "p", &[0.0, 0.0], &[0.0], b + 1.0);
        assert_eq!(branch.events_of(&EventKind::Hopf).count(), 2);
        let found = all(&problem, &[&branch], (0.0, b + 1.0), 1);
        assert_eq!(found.branches.len(), 1, "{:?}", found.failed);
        let one = &found.branches[0];
        assert_eq!(one.cycles.branch.stopped.reason, StopReason::CyclesVanish);
        assert_eq!(one.vanishes_at, Some((0, 1)));
        assert_eq!(found.known, [CycleOrigin::Hopf { branch: 0, event: 1 }]);
        let last = one.cycles.branch.points.last().unwrap();
        assert!(last.p < b && last.p > b - 0.2 * (b - a), "{} {b}", last.p);
        assert!(found.is_complete());
    }
}

/// Near misses: a Hopf point with the same place and frequency, of other unknowns, is not the end.
#[test]
fn a_hopf_point_elsewhere_is_not_taken_for_the_end() {
    let problem = DenseProblem::from_residual(4, &["p"], |u, p, r| {
        let g = (p[0] - 0.5) * (2.0 - p[0]) - u[0] * u[0] - u[1] * u[1];
        r[0] = g * u[0] - 1.5 * u[1];
        r[1] = 1.5 * u[0] + g * u[1];
        // cycles of a second pair, born where the first ones vanish
        let h = p[0] - 2.02 - u[2] * u[2] - u[3] * u[3];
        r[2] = h * u[2] - 1.5 * u[3];
        r[3] = 1.5 * u[2] + h * u[3];
    })
    .with_stability(Stability::Dynamics);
    let settings = Settings { target: Some(3.0), max_step: Some(5e-3), ..Settings::default() };
    let branch = Tracer::new(&problem, "p", &[0.0; 4], &[0.0], settings).unwrap().run_quietly();
    assert_eq!(branch.events_of(&EventKind::Hopf).count(), 3, "{:?}", branch.events);
    let found = all(&problem, &[&branch], (0.0, 3.0), 0);
    // whatever is taken for the end, both families are there
    let largest = |k: usize| {
        let all = found.branches.iter().flat_map(|one| &one.cycles.cycles);
        all.flat_map(|c| c.cycle.values.chunks(4).map(move |u| u[k].abs())).fold(0.0, f64::max)
    };
    assert!(largest(0) > 0.5, "{}", largest(0));
    assert!(largest(2) > 0.5 || !found.is_complete(), "{} {:?}", largest(2), found.failed);
}

#[test]
fn the_word_complete_is_not_said_of_cycles_near_a_homoclinic_orbit() {
    let problem = lorenz();
    let r = (8.0_f64 / 3.0 * 19.0).sqrt();
    let branch = equilibria(&problem, "rho", &[r, r, 19.0], &[20.0], 30.0);
    let found = all(&problem, &[&branch], (10.0, 30.0), 1);
    assert_eq!(found.branches.len(), 1);
    assert_eq!(found.branches[0].cycles.branch.stopped.reason, StopReason::PeriodUnbounded);
    assert!(!found.is_complete());
}

#[test]
fn an_interrupt_keeps_what_was_traced_and_is_not_complete() {
    let problem = brusselator();
    let branch = equilibria(&problem, "B", &[1.0, 1.0], &[1.0], 3.0);
    let trace = Settings { domain: Some((1.0, 3.0)), ..Settings::default() };
    let cycles = CycleSettings::default();
    let follow = Follow { trace: &trace, cycles: &cycles, depth: 1, max_branches: 5 };
    let mut points = 0;
    let found = explore(&problem, &[&branch], &|_, _| true, &follow, &mut |_, _| {
        points += 1;
        if points < 4 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    })
    .unwrap();
    assert!(found.interrupted && !found.is_complete());
    assert_eq!(found.branches[0].cycles.branch.points.len(), 4);
}

/// A circle on which a Möbius band turns half as fast: `w = (a, b)` across it, with multiplier −e^{2πλ}, and
/// `λ` less `s |w|²`: supercritical for `s > 0`. Curvature and side are known.
fn moebius(s: f64) -> System {
    let mut system = hopf_form();
    system.n = 4;
    system.parameters[1].name = "s".into();
    system.field = |u, p, r| {
        let g = 1.0 - u[0] * u[0] - u[1] * u[1];
        r[0] = g * u[0] - u[1];
        r[1] = u[0] + g * u[1];
        // across the circle: growth λ along a vector that turns by half the angle, decay across it
        let (c, d) = (u[0], u[1]);
        let (x, y) = (u[2], u[3]);
        let growth = p[0] - p[1] * (x * x + y * y);
        let (mean, half) = (0.5 * (growth - 1.0), 0.5 * (growth + 1.0));
        r[2] = mean * x + half * (c * x + d * y) - 0.5 * y;
        r[3] = mean * y + half * (d * x - c * y) + 0.5 * x;
    };
    system.slopes = |u, p, set| {
        let (a, b) = (u[0], u[1]);
        let g = 1.0 - a * a - b * b;
        set(0, 0, g - 2.0 * a * a);
        set(0, 1, -2.0 * a * b - 1.0);
        set(1, 0, 1.0 - 2.0 * a * b);
        set(1, 1, g - 2.0 * b * b);
        let (x, y) = (u[2], u[3]);
        let growth = p[0] - p[1] * (x * x + y * y);
        let (mean, half) = (0.5 * (growth - 1.0), 0.5 * (growth + 1.0));
        let (by_x, by_y) = (-2.0 * p[1] * x, -2.0 * p[1] * y);
        let along = (0.5 * (x + a * x + b * y), 0.5 * (y + b * x - a * y));
        set(2, 0, half * x);
        set(2, 1, half * y);
        set(3, 0, -half * y);
        set(3, 1, half * x);
        set(2, 2, mean + half * a + along.0 * by_x);
        set(2, 3, half * b - 0.5 + along.0 * by_y);
        set(3, 2, half * b + 0.5 + along.1 * by_x);
        set(3, 3, mean - half * a + along.1 * by_y);
        set(2, 4, along.0);
        set(3, 4, along.1);
        let square = x * x + y * y;
        set(2, 5, -square * along.0);
        set(3, 5, -square * along.1);
    };
    let _ = s;
    system
}

#[test]
fn doublings_are_called_by_the_side_of_the_doubled_cycles() {
    use continuation::cycles::{Cycle, SmallCycle};
    for s in [1.0, -1.0, 0.3, -2.5] {
        let problem = moebius(s);
        let cycles = CycleSettings::default();
        let circle = |t: f64, u: &mut [f64]| u.copy_from_slice(&[t.cos(), t.sin(), 0.0, 0.0]);
        let start =
            Cycle::near(&problem, &[-0.2, s], std::f64::consts::TAU, circle, &cycles).unwrap();
        let settings = Settings { target: Some(0.3), ..Settings::default() };
        let branch = super::follow(&problem, "mu", &start, settings);
        let event = branch.branch.events_of(&EventKind::PeriodDoubling).next().unwrap();
        assert!(event.p.abs() < 1e-9, "{}", event.p);
        let form = event.doubling().unwrap();
        // the doubled cycle is w = ρ (cos t/2, sin t/2) with sρ² = μ, the mode of length 1 in the mean square
        let exact = 2.0 * s;
        assert!((form.curvature - exact).abs() <= form.curvature_error, "{s}: {form:?} {exact}");
        assert!(form.curvature_error < 1e-4 * exact.abs(), "{form:?}");
        let side = if s > 0.0 { Criticality::Supercritical } else { Criticality::Subcritical };
        assert_eq!(form.criticality, Some(side), "{s}");
        // and the cycle that is followed lies on that side
        let small = SmallCycle::at_doubling(&problem, &branch, event, &cycles).unwrap();
        assert_eq!(small.increasing, s > 0.0);
    }
}

/// Where the cubic term is zero the side is not known by it, and none is claimed.
#[test]
fn a_degenerate_doubling_has_no_side() {
    use continuation::cycles::Cycle;
    let problem = moebius(0.0);
    let cycles = CycleSettings::default();
    let circle = |t: f64, u: &mut [f64]| u.copy_from_slice(&[t.cos(), t.sin(), 0.0, 0.0]);
    let start =
        Cycle::near(&problem, &[-0.2, 0.0], std::f64::consts::TAU, circle, &cycles).unwrap();
    let settings = Settings { target: Some(0.3), ..Settings::default() };
    let branch = super::follow(&problem, "mu", &start, settings);
    let event = branch.branch.events_of(&EventKind::PeriodDoubling).next().unwrap();
    assert_eq!(event.doubling().and_then(|form| form.criticality), None, "{:?}", event.detail);
}
