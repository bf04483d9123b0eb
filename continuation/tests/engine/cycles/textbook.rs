//! Textbook systems against values of the literature and against shooting with an integrator of order 16.

use super::systems::{
    System, brusselator, eigenvalues, flow, lorenz, roessler, shoot, van_der_pol,
};
use super::{assert_within, follow};
use continuation::cycles::{Cycle, CycleBranch, CycleSettings, SmallCycle};
use continuation::{Branch, EventKind, Settings, StopReason, Tracer};

/// Period and multipliers of a point against shooting from its first state.
fn agrees(system: &System, branch: &CycleBranch, point: usize, steps: usize) {
    let found = &branch.cycles[point];
    let cycle = &found.cycle;
    let (_, period, monodromy) =
        shoot(system, &cycle.parameters, &cycle.state(0.0), cycle.period, steps);
    assert_within(
        cycle.period,
        period,
        found.period_error.unwrap() * period + 1e-12,
        1e-8,
        "period",
    );
    let mut expected = eigenvalues(system.n, &monodromy);
    expected.sort_by(|a, b| b.0.hypot(b.1).total_cmp(&a.0.hypot(a.1)));
    for (multiplier, (re, im)) in found.multipliers.iter().zip(&expected) {
        let (a, b) = multiplier.value();
        let off = (a - re).hypot(b - im);
        // the oracle's own error: rounding of the largest entry
        let oracle = 1e-11 * monodromy.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
        let said = multiplier.error.unwrap() * a.hypot(b);
        assert!(off <= said + oracle, "{multiplier:?} {re} {im} {off:e}");
        assert!(off <= 1e-8 * (1.0 + re.hypot(*im)), "{multiplier:?} {re} {im} {off:e}");
    }
}

fn hopf(problem: &System, name: &str, u: &[f64], p: f64, target: f64) -> Branch {
    let settings = Settings { target: Some(target), ..Settings::default() };
    Tracer::new(problem, name, u, &[p], settings).unwrap().run_quietly()
}

#[test]
fn van_der_pol_has_the_period_of_the_literature() {
    let problem = van_der_pol();
    let guess = |t: f64, u: &mut [f64]| (u[0], u[1]) = (2.0 * t.cos(), -2.0 * t.sin());
    let start = Cycle::near(&problem, &[1.0], 6.6, guess, &CycleSettings::default()).unwrap();
    assert!((start.period - 6.663_286_859_323).abs() < 2e-10, "{}", start.period);
    let branch =
        follow(&problem, "mu", &start, Settings { target: Some(6.0), ..Settings::default() });
    assert_eq!(branch.branch.stopped.reason, StopReason::Target);
    agrees(&problem, &branch, 0, 60);
    let middle = branch.branch.points.iter().position(|point| point.p > 3.0).unwrap();
    agrees(&problem, &branch, middle, 200);
    let last = branch.cycles.last().unwrap();
    let (_, period, _) = shoot(&problem, &[6.0], &last.cycle.state(0.0), last.cycle.period, 1200);
    assert_within(
        last.cycle.period,
        period,
        last.period_error.unwrap() * period + 1e-10,
        1e-7,
        "period",
    );
    assert_eq!(last.unstable, Some(0));
    assert!(branch.branch.events.is_empty());
}

#[test]
fn lorenz_cycles_approach_a_homoclinic_orbit() {
    let problem = lorenz();
    let r = (8.0_f64 / 3.0 * 19.0).sqrt();
    let equilibria = hopf(&problem, "rho", &[r, r, 19.0], 20.0, 30.0);
    let event = equilibria.events_of(&EventKind::Hopf).next().unwrap();
    assert!((event.p - 470.0 / 19.0).abs() < 1e-9);
    let small =
        SmallCycle::at_hopf(&problem, &equilibria, event, &CycleSettings::default()).unwrap();
    assert!(!small.increasing, "subcritical");
    let settings =
        Settings { increasing: Some(false), domain: Some((10.0, 30.0)), ..Settings::default() };
    let branch = follow(&problem, "rho", &small.cycle, settings);
    let stopped = &branch.branch.stopped;
    assert_eq!(stopped.reason, StopReason::PeriodUnbounded, "{}", stopped.detail);
    let last = branch.branch.points.last().unwrap();
    assert!((last.p - 13.926_557).abs() < 3e-6, "{}", last.p);
    // unstable all the way; where a count is called certain it is right
    assert!(branch.branch.points.iter().filter(|p| p.certified).all(|p| p.unstable == Some(1)));
    assert!(branch.branch.points.iter().filter(|p| p.certified).count() > 30);
    assert!(branch.branch.events.is_empty(), "{:?}", branch.branch.events);
    for below in [23.5, 17.0] {
        let at = branch.branch.points.iter().position(|p| p.p < below).unwrap();
        agrees(&problem, &branch, at, 60);
    }
}

#[test]
fn brusselator_cycles_are_stable_beyond_the_hopf_point() {
    let problem = brusselator();
    let equilibria = hopf(&problem, "B", &[1.0, 1.0], 1.0, 3.0);
    let event = equilibria.events_of(&EventKind::Hopf).next().unwrap();
    assert!((event.p - 2.0).abs() < 1e-10);
    let small =
        SmallCycle::at_hopf(&problem, &equilibria, event, &CycleSettings::default()).unwrap();
    assert!(small.increasing && event.hopf().unwrap().lyapunov < 0.0);
    let branch =
        follow(&problem, "B", &small.cycle, Settings { target: Some(4.0), ..Settings::default() });
    assert_eq!(branch.branch.stopped.reason, StopReason::Target);
    assert!(branch.branch.points.iter().all(|point| point.unstable == Some(0)));
    let three = branch.branch.points.iter().position(|point| point.p > 3.0).unwrap();
    agrees(&problem, &branch, three, 200);
    // and back: the cycles vanish where they were born
    let back = Settings { target: Some(1.0), ..Settings::default() };
    let back = follow(&problem, "B", &branch.cycles[three].cycle, back);
    assert_eq!(back.branch.stopped.reason, StopReason::CyclesVanish, "{:?}", back.branch.stopped);
    let last = back.branch.points.last().unwrap();
    assert!(last.p > 2.0 && last.p < 2.01, "{} {:?}", last.p, back.branch.stopped);
    assert!(back.branch.events.is_empty(), "{:?}", back.branch.events);
}

/// The multiplier nearest to −1, plus 1, by shooting.
fn flip(system: &System, p: f64, cycle: &mut (Vec<f64>, f64)) -> f64 {
    let (u, period, monodromy) = shoot(system, &[p], &cycle.0, cycle.1, 300);
    *cycle = (u, period);
    let all = eigenvalues(system.n, &monodromy);
    all.iter().map(|(re, _)| re + 1.0).min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap()
}

#[test]
fn roessler_doubles_its_period_where_shooting_says() {
    let problem = roessler();
    // the transient by the integrator, then a time series
    let mut u = flow(&problem, &[2.5], &[1.0, 1.0, 0.0], 300.0, 1500).0;
    let (mut times, mut states) = (Vec::new(), Vec::new());
    for i in 0..300 {
        times.push(f64::from(i) * 0.05);
        states.extend_from_slice(&u);
        u = flow(&problem, &[2.5], &u, 0.05, 1).0;
    }
    let start =
        Cycle::from_series(&problem, &[2.5], &times, &states, &CycleSettings::default()).unwrap();
    let branch =
        follow(&problem, "c", &start, Settings { target: Some(3.2), ..Settings::default() });
    agrees(&problem, &branch, 0, 100);
    let events = &branch.branch.events;
    assert_eq!(events.len(), 1, "{events:?}");
    let event = &events[0];
    assert_eq!(event.kind, EventKind::PeriodDoubling);
    assert_eq!((event.unstable_before, event.unstable_after), (Some(0), Some(1)));
    assert!(branch.branch.doubts.is_empty());
    // by the secant method on the multiplier of the independent integration
    let found = &branch.cycles[event.point].cycle;
    let mut cycle = (found.state(0.0), found.period);
    let (mut a, mut b) = (event.p - 1e-3, event.p + 1e-3);
    let (mut fa, mut fb) = (flip(&problem, a, &mut cycle), flip(&problem, b, &mut cycle));
    for _ in 0..5 {
        if fa == fb {
            break;
        }
        (a, b) = (b, b - fb * (b - a) / (fb - fa));
        (fa, fb) = (fb, flip(&problem, b, &mut cycle));
    }
    assert_within(event.p, b, branch.event_errors[0].unwrap() + 1e-11, 1e-7, "doubling");
    assert!((event.p - b).abs() < 1e-8, "{} {b}", event.p);
    // the doubled cycles are stable and double again
    let small =
        SmallCycle::at_doubling(&problem, &branch, event, &CycleSettings::default()).unwrap();
    assert!(small.increasing);
    let doubled =
        follow(&problem, "c", &small.cycle, Settings { target: Some(4.0), ..Settings::default() });
    assert_eq!(doubled.branch.points[3].unstable, Some(0));
    let again = doubled.branch.events_of(&EventKind::PeriodDoubling).next().unwrap();
    assert!((again.p - 3.837_358).abs() < 2e-6, "{}", again.p);
    let at = doubled.branch.points.iter().position(|point| point.p > 3.3).unwrap();
    agrees(&problem, &doubled, at, 200);
}

/// Within the explosion multipliers are known badly: differences of their functions to one side alone had steps refused
/// until the branch came to a standstill.
#[test]
fn no_standstill_in_a_canard_explosion() {
    let system = System {
        n: 2,
        parameters: vec![continuation::Parameter::new("I", "", 1.0)],
        field: |u, p, r| {
            r[0] = u[0] - u[0].powi(3) / 3.0 - u[1] + p[0];
            r[1] = 0.08 * (u[0] + 0.7 - 0.8 * u[1]);
        },
        slopes: |u, _, set| {
            set(0, 0, 1.0 - u[0] * u[0]);
            set(0, 1, -1.0);
            set(0, 2, 1.0);
            set(1, 0, 0.08);
            set(1, 1, -0.064);
        },
    };
    let settings = Settings { target: Some(0.5), ..Settings::default() };
    let equilibria =
        Tracer::new(&system, "I", &[-1.2, -0.62], &[0.0], settings).unwrap().run_quietly();
    let hopf = equilibria.events_of(&EventKind::Hopf).next().unwrap();
    let cycles = CycleSettings::default();
    let small = SmallCycle::at_hopf(&system, &equilibria, hopf, &cycles).unwrap();
    let settings = Settings {
        domain: Some((0.0, 1.0)),
        increasing: Some(small.increasing),
        max_points: 300,
        ..Settings::default()
    };
    let branch = super::follow(&system, "I", &small.cycle, settings);
    assert_eq!(branch.branch.stopped.reason, StopReason::Domain);
    assert!(branch.cycles.last().unwrap().period_error.unwrap() < 1e-9);
}
