//! Cycles whose period, multipliers and special points are known exactly.

use super::embedded::{Beside, Embedded, Random};
use super::systems::{hopf_form, slowing, van_der_pol};
use super::{assert_within, follow, follow_by};
use continuation::cycles::{
    Cycle, CyclePoint, CycleProblem, CycleSettings, Multiplier, SmallCycle, trace,
};
use continuation::{
    BandProblem, DenseProblem, EventKind, Progress, Settings, Stability, StopReason, Tracer,
    check_derivatives,
};
use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

/// A start on the circle of radius 1.
fn circle(problem: &Embedded, p: f64, settings: &CycleSettings) -> Cycle {
    Cycle::near(problem, &[p], problem.period(), |t, u| problem.circle(1.0, t, u), settings)
        .unwrap()
}

#[test]
fn the_hopf_normal_form_of_either_sign() {
    let problem = hopf_form();
    for s in [1.0, -1.0] {
        let equilibria = Tracer::new(
            &problem,
            "mu",
            &[0.0; 2],
            &[-0.7, s],
            Settings { target: Some(0.8), ..Settings::default() },
        )
        .unwrap()
        .run_quietly();
        let hopf = equilibria.events_of(&EventKind::Hopf).next().unwrap();
        let small =
            SmallCycle::at_hopf(&problem, &equilibria, hopf, &CycleSettings::default()).unwrap();
        assert_eq!(small.increasing, s > 0.0);
        let settings = Settings {
            increasing: Some(small.increasing),
            domain: Some((-1.0, 1.0)),
            ..Settings::default()
        };
        let branch = follow(&problem, "mu", &small.cycle, settings);
        assert_eq!(branch.branch.stopped.reason, StopReason::Domain);
        assert!(branch.branch.events.is_empty() && branch.branch.doubts.is_empty());
        let largest = branch.branch.column("max_u[0]").unwrap();
        let mean = branch.branch.column("mean_u[1]").unwrap();
        for (i, (point, cycle)) in branch.branch.points.iter().zip(&branch.cycles).enumerate() {
            let mu = point.p;
            let error = cycle.period_error.unwrap() * TAU + 1e-13;
            assert_within(cycle.cycle.period, TAU, error, 1e-8, "period");
            assert!(
                (largest[i] - (mu / s).sqrt()).abs() < 1e-7 * largest[i] && mean[i].abs() < 1e-9
            );
            let trivial = cycle.trivial.unwrap();
            let other = cycle.multipliers[1 - trivial];
            assert_within(
                other.log_modulus,
                -4.0 * PI * mu,
                other.error.unwrap(),
                1e-7,
                "multiplier",
            );
            assert!(cycle.trivial_error.unwrap() < 1e-8);
            assert_eq!(other.argument, 0.0);
            if mu.abs() > 1e-7 {
                assert!(point.certified);
                assert_eq!(point.unstable, Some(usize::from(mu < 0.0)));
            }
        }
    }
}

#[test]
fn random_systems_with_known_multipliers() {
    let mut random = Random(5);
    for round in 0..24 {
        let lambdas = [2.0 * random.next(), -3.0 + random.next()];
        let beside = lambdas[..round % 3].iter().map(|l| Beside::Linear(*l)).collect();
        let mut problem = Embedded::new(beside, &mut random, 0.2);
        (problem.m, problem.s) = (0.6 + 0.3 * random.next(), 1.0);
        problem.lift = 1.0;
        if round % 2 == 1 {
            let n = 2 + round % 3;
            let mass = |i: usize, x: f64| f64::from(u8::from(i % n == i / n)) + 0.3 * x;
            problem.mass = Some((0..n * n).map(|i| mass(i, random.next())).collect());
        }
        let r = problem.m.sqrt();
        let settings =
            CycleSettings { degree: 2 + round % 6, intervals: 30, ..CycleSettings::default() };
        let guess = |t: f64, u: &mut [f64]| problem.circle(1.1 * r, t, u);
        let period = problem.period();
        let start = Cycle::near(&problem, &[0.0], 1.03 * period, guess, &settings).unwrap();
        let equations = CycleProblem::new(&problem, &start).unwrap();
        if round < 3 {
            let x = equations.unknowns(&start);
            assert!(check_derivatives(&equations, &x, &[0.0], 1.0).unwrap().is_within(1e-7));
        }
        let branch = follow_by(
            &problem,
            "p",
            &start,
            Settings { target: Some(0.02), ..Settings::default() },
            &settings,
        );
        let cycle = &branch.cycles[0];
        assert_within(
            cycle.cycle.period,
            period,
            cycle.period_error.unwrap() * period + 1e-13,
            1e-7,
            "period",
        );
        let mut expected = vec![0.0, -2.0 * problem.m * problem.nu * period];
        expected.extend(lambdas[..round % 3].iter().map(|l| l * period));
        expected.sort_by(|a, b| b.total_cmp(a));
        for (found, log) in cycle.multipliers.iter().zip(&expected) {
            assert_within(found.log_modulus, *log, found.error.unwrap(), 1e-4, "multiplier");
            assert!(found.argument.abs() < 1e-9, "{found:?}");
        }
        let unstable = expected.iter().filter(|log| **log > 0.0).count();
        assert_eq!((cycle.unstable, cycle.certified), (Some(unstable), true));
    }
}

/// Meshes far too coarse for what they are asked: what is said to be certain is, and errors say how
/// little is known.
#[test]
fn coarse_meshes_claim_no_more_than_they_know() {
    let mut random = Random(23);
    let (mut points, mut certified) = (0, 0);
    for round in 0..240 {
        let lambdas = [0.6 * random.next(), 0.2 * random.next()];
        let beside = lambdas[..round % 3].iter().map(|l| Beside::Linear(*l)).collect();
        let mut problem = Embedded::new(beside, &mut random, 0.1 + 0.1 * (round % 4) as f64);
        problem.lift = 1.0;
        let intervals = 3 + round % 10;
        let settings = CycleSettings {
            degree: 2 + round % 5,
            intervals,
            max_intervals: intervals,
            ..CycleSettings::default()
        };
        let guess = |t: f64, u: &mut [f64]| problem.circle(1.0, t, u);
        let period = problem.period();
        let Ok(start) = Cycle::near(&problem, &[0.0], period, guess, &settings) else { continue };
        let observer = &mut |_: &Progress| ControlFlow::Continue(());
        let to = Settings { target: Some(0.3), max_points: 12, ..Settings::default() };
        let Ok(branch) = trace(&problem, "p", &start, &to, &settings, &[], observer) else {
            continue;
        };
        for point in &branch.cycles {
            points += 1;
            let m = problem.m + point.cycle.parameters[0];
            let mut expected = vec![0.0, -2.0 * m * problem.nu * period];
            expected.extend(lambdas[..round % 3].iter().map(|l| l * period));
            let unstable = expected.iter().filter(|log| **log > 0.0).count();
            if point.certified {
                certified += 1;
                assert_eq!(point.unstable, Some(unstable), "{round}: {:?}", point.multipliers);
            }
            expected.sort_by(|a, b| b.total_cmp(a));
            for (found, log) in point.multipliers.iter().zip(&expected) {
                let Some(error) = found.error else { continue };
                let off = (found.log_modulus - log).abs();
                assert!(off <= error, "{round}: {off:e}, said {error:e}");
            }
            if let Some(error) = point.period_error {
                let off = (point.cycle.period / period - 1.0).abs();
                assert!(off <= error + 1e-13, "{round}: period off {off:e}, said {error:e}");
            }
        }
    }
    assert!(points > 2500 && certified > 2000, "{certified} of {points}");
}

/// Most points take their errors from those on both sides: they hold where the period varies along the branch, too.
#[test]
fn errors_between_points_hold_while_the_period_varies() {
    let problem = van_der_pol();
    let mut random = Random(61);
    let mut points = 0;
    for round in 0..12 {
        let (from, to) = (1.0 + 0.5 * random.next(), 2.8 + random.next());
        let settings = CycleSettings {
            degree: 2 + round % 4,
            intervals: 20 + 2 * round,
            max_intervals: 40 + 4 * round,
            ..CycleSettings::default()
        };
        let guess = |t: f64, u: &mut [f64]| (u[0], u[1]) = (2.0 * t.cos(), -2.0 * t.sin());
        let period = 6.3 + 0.4 * from * from;
        let start = Cycle::near(&problem, &[from], period, guess, &settings).unwrap();
        let to = Settings { target: Some(to), max_points: 14, ..Settings::default() };
        let observer = &mut |_: &Progress| ControlFlow::Continue(());
        let branch = trace(&problem, "mu", &start, &to, &settings, &[], observer).unwrap();
        let fine = CycleSettings { degree: 6, intervals: 120, ..CycleSettings::default() };
        for point in &branch.cycles {
            let Some(error) = point.period_error else { continue };
            let (cycle, mu) = (&point.cycle, point.cycle.parameters[0]);
            let orbit = |t: f64, u: &mut [f64]| u.copy_from_slice(&cycle.state(t));
            let truth = Cycle::near(&problem, &[mu], cycle.period, orbit, &fine).unwrap();
            points += 1;
            let off = (cycle.period / truth.period - 1.0).abs();
            assert!(off <= error + 1e-12, "{round}, mu {mu}: off {off:e}, said {error:e}");
        }
    }
    assert!(points > 120, "{points}");
}

/// The same of an orbit that is fast and slow in turn, against itself on a fine mesh.
#[test]
fn coarse_meshes_of_relaxation_oscillations() {
    let problem = van_der_pol();
    let point = |mu: f64, settings: &CycleSettings| {
        let guess = |t: f64, u: &mut [f64]| (u[0], u[1]) = (2.0 * t.cos(), -2.0 * t.sin());
        let start = Cycle::near(&problem, &[mu], 6.3 + 0.4 * mu * mu, guess, settings).ok()?;
        let observer = &mut |_: &Progress| ControlFlow::Continue(());
        let short = Settings { max_points: 2, ..Settings::default() };
        let branch = trace(&problem, "mu", &start, &short, settings, &[], observer).ok()?;
        branch.cycles.into_iter().next()
    };
    let (mut points, mut certified) = (0, 0);
    for mu in [0.3, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0] {
        let fine = CycleSettings { intervals: 150, degree: 5, ..CycleSettings::default() };
        let exact = point(mu, &fine).unwrap();
        let own = |p: &CyclePoint| p.multipliers[1 - p.trivial.unwrap()];
        for (intervals, degree) in (3..=24).flat_map(|n| (2..=5).map(move |m| (n, m))) {
            let coarse = CycleSettings {
                intervals,
                degree,
                max_intervals: intervals,
                ..CycleSettings::default()
            };
            let Some(found) = point(mu, &coarse) else { continue };
            // a multiple of the period is another cycle
            if (found.cycle.period / exact.cycle.period - 1.0).abs() > 0.5 {
                continue;
            }
            points += 1;
            let case = format!("mu {mu}, {intervals} intervals of degree {degree}");
            if found.certified {
                certified += 1;
                assert_eq!(found.unstable, Some(0), "{case}: {:?}", found.multipliers);
            }
            if let Some(error) = own(&found).error.filter(|_| found.certified) {
                let off = (own(&found).log_modulus - own(&exact).log_modulus).abs();
                assert!(
                    off <= error + own(&exact).error.unwrap(),
                    "{case}: {off:e}, said {error:e}"
                );
            }
            if let Some(error) = found.period_error {
                let off = (found.cycle.period / exact.cycle.period - 1.0).abs();
                let reference = exact.period_error.unwrap() + 1e-12;
                assert!(off <= error + reference, "{case}: period off {off:e}, said {error:e}");
            }
        }
    }
    assert!(points > 400 && certified > 300, "{certified} of {points}");
}

#[test]
fn multipliers_of_many_orders_of_magnitude() {
    let mut random = Random(11);
    for _ in 0..4 {
        let logs = [20.0, -60.0, -7.0];
        let (nu, omega) = (1.0 + 0.4 * random.next(), 1.0 + 0.4 * random.next());
        let period = TAU / (nu * omega);
        let beside = logs.iter().map(|log| Beside::Linear(log / period)).collect();
        let mut problem = Embedded::new(beside, &mut random, 0.15);
        (problem.nu, problem.omega) = (nu, omega);
        let settings = CycleSettings { intervals: 80, ..CycleSettings::default() };
        let start = circle(&problem, 0.0, &settings);
        let branch = follow_by(
            &problem,
            "p",
            &start,
            Settings { max_points: 2, ..Settings::default() },
            &settings,
        );
        let cycle = &branch.cycles[0];
        let radial = -2.0 * problem.nu * period;
        let mut expected = vec![20.0, 0.0, -7.0, -60.0, radial];
        expected.sort_by(|a, b| b.total_cmp(a));
        for (found, log) in cycle.multipliers.iter().zip(&expected) {
            let most = if *log < -50.0 { 1e-5 } else { 1e-9 };
            assert_within(found.log_modulus, *log, found.error.unwrap(), most, "multiplier");
        }
        assert_eq!((cycle.unstable, cycle.certified), (Some(1), true));
        assert!(cycle.trivial_error.unwrap() < 1e-8);
    }
}

/// Errors at the mesh points are of order `2m`: the ratio on halving equal intervals.
#[test]
fn superconvergence_at_the_mesh_points() {
    let mut random = Random(23);
    let problem = Embedded::new(vec![Beside::Linear(-0.3)], &mut random, 0.25);
    let period = problem.period();
    for (degree, intervals) in [(2, 24), (3, 10), (4, 6), (5, 4)] {
        let errors = [1, 2].map(|k| {
            let settings = CycleSettings {
                degree,
                intervals: k * intervals,
                max_intervals: k * intervals,
                ..CycleSettings::default()
            };
            // a uniform mesh: solved, not adapted
            let mesh = (0..=k * intervals).map(|j| j as f64 / (k * intervals) as f64).collect();
            let mut values = Vec::new();
            for node in 0..k * intervals * degree {
                let mut u = [0.0; 3];
                problem.circle(1.0, period * node as f64 / (k * intervals * degree) as f64, &mut u);
                values.extend_from_slice(&u);
            }
            let cycle = Cycle { mesh, degree, values, period, parameters: vec![0.0] };
            let settings_of_trace = Settings { max_points: 2, ..Settings::default() };
            let branch = follow_by(&problem, "p", &cycle, settings_of_trace, &settings);
            let found = &branch.cycles[0].cycle;
            // the radius in the inner coordinates, at the mesh points
            (found.period - period).abs()
        });
        let order = (errors[0] / errors[1]).log2();
        assert!((order - 2.0 * degree as f64).abs() < 0.7, "{degree}: {errors:?}, order {order}");
    }
}

#[test]
fn folds_of_random_cycles_are_where_they_are() {
    let mut random = Random(31);
    for _ in 0..4 {
        let mut problem = Embedded::new(vec![Beside::Linear(-0.8)], &mut random, 0.1);
        problem.fold = true;
        // p = r⁴ − r²: down the inner branch to −1/4 and up the outer one
        let settings = CycleSettings::default();
        let r = 0.4_f64;
        let guess = |t: f64, u: &mut [f64]| problem.circle(r, t, u);
        let start = Cycle::near(&problem, &[r.powi(4) - r * r], problem.period(), guess, &settings)
            .unwrap();
        let trace =
            Settings { increasing: Some(false), domain: Some((-1.0, 0.5)), ..Settings::default() };
        let branch = follow(&problem, "p", &start, trace);
        let folds: Vec<_> = branch.branch.events_of(&EventKind::Fold).collect();
        assert_eq!((folds.len(), branch.branch.events.len()), (1, 1), "{:?}", branch.branch.events);
        let error = branch.event_errors[0].unwrap();
        assert_within(folds[0].p, -0.25, error, 1e-8, "fold");
        assert_eq!((folds[0].unstable_before, folds[0].unstable_after), (Some(1), Some(0)));
        assert!(branch.branch.doubts.is_empty(), "{:?}", branch.branch.doubts);
        assert_eq!(branch.branch.stopped.reason, StopReason::Domain);
    }
}

#[test]
fn tori_and_pitchforks_of_random_cycles() {
    let mut random = Random(41);
    for round in 0..6 {
        let (beside, kind) = match round % 2 {
            0 => (Beside::Torus(0.37), EventKind::NeimarkSacker),
            _ => (Beside::Pitchfork, EventKind::BranchPoint),
        };
        let problem = Embedded::new(vec![beside], &mut random, 0.1);
        let start = circle(&problem, -0.3, &CycleSettings::default());
        let branch =
            follow(&problem, "p", &start, Settings { target: Some(0.25), ..Settings::default() });
        let events = &branch.branch.events;
        assert_eq!(events.len(), 1, "{events:?}");
        assert_eq!(events[0].kind, kind);
        assert_within(events[0].p, 0.0, branch.event_errors[0].unwrap(), 1e-5, "event");
        assert!(events[0].p.abs() < 1e-8);
        let after = if round % 2 == 0 { 2 } else { 1 };
        assert_eq!((events[0].unstable_before, events[0].unstable_after), (Some(0), Some(after)));
        assert!(branch.branch.doubts.is_empty(), "{:?}", branch.branch.doubts);
        assert!(branch.cycles.iter().all(|cycle| cycle.trivial_error.unwrap() < 1e-8));
        if kind == EventKind::BranchPoint {
            // the cycles with y₃ = ±√p are stable, and both exist for p > 0
            let defaults = CycleSettings::default();
            let sides = [true, false].map(|forward| {
                let small = SmallCycle::at_branch_point(
                    &problem, &branch, &events[0], 0, forward, &defaults,
                );
                let small = small.unwrap();
                assert!(small.increasing);
                let target = Settings { target: Some(0.2), ..Settings::default() };
                let side = follow(&problem, "p", &small.cycle, target);
                let last = side.cycles.last().unwrap();
                assert_eq!((last.unstable, last.certified), (Some(0), true));
                let log = -2.0 * 0.2 * problem.period();
                let error = |m: &Multiplier| (m.log_modulus - log).abs();
                let multiplier =
                    last.multipliers.iter().min_by(|a, b| error(a).total_cmp(&error(b)));
                assert!(error(multiplier.unwrap()) < 1e-7, "{multiplier:?}");
                last.cycle.clone()
            });
            let middle = [0, 1].map(|k| sides[k].values.iter().sum::<f64>());
            assert!((middle[0] - middle[1]).abs() > 1e-2, "both ways are the same");
        }
    }
}

/// Multipliers `−exp(T(p ± a))`: doublings at `p = −a` and `a`, exactly.
#[test]
fn doublings_of_random_cycles() {
    let mut random = Random(47);
    for _ in 0..4 {
        let split = 0.2 + 0.05 * random.next();
        let problem = Embedded::new(vec![Beside::HalfTurn(split)], &mut random, 0.1);
        let start = circle(&problem, -0.5, &CycleSettings::default());
        let branch =
            follow(&problem, "p", &start, Settings { target: Some(0.5), ..Settings::default() });
        let events = &branch.branch.events;
        assert_eq!(events.len(), 2, "{events:?}");
        for (event, exact) in events.iter().zip([-split, split]) {
            assert_eq!(event.kind, EventKind::PeriodDoubling);
            assert!((event.p - exact).abs() < 1e-8, "{} {exact}", event.p);
        }
        for (k, exact) in [-split, split].into_iter().enumerate() {
            assert_within(events[k].p, exact, branch.event_errors[k].unwrap(), 1e-7, "doubling");
        }
        assert!(branch.branch.doubts.is_empty(), "{:?}", branch.branch.doubts);
        let counts =
            [events[0].unstable_before, events[0].unstable_after, events[1].unstable_after];
        assert_eq!(counts, [Some(0), Some(1), Some(2)]);
        // the doubled cycle leaves at the first of them and is stable
        let doubled =
            SmallCycle::at_doubling(&problem, &branch, &events[0], &CycleSettings::default())
                .unwrap();
        assert!(doubled.increasing);
        assert!((doubled.cycle.period / problem.period() - 2.0).abs() < 1e-3);
        let far = follow(
            &problem,
            "p",
            &doubled.cycle,
            Settings { target: Some(0.0), ..Settings::default() },
        );
        let last = far.cycles.last().unwrap();
        assert_eq!((last.unstable, last.certified), (Some(0), true));
        assert_eq!(far.branch.stopped.reason, StopReason::Target);
    }
}

/// `p = sin q` and so on: a circle in the plane of parameter and radius is one closed branch.
#[test]
fn a_closed_branch_of_cycles_ends_where_it_began() {
    // (r² − 1)² + p² = 1/4: folds at p = ±1/2
    let problem = DenseProblem::from_residual(2, &["p"], |u, p, r| {
        let square = u[0] * u[0] + u[1] * u[1];
        let g = (square - 1.0) * (square - 1.0) + p[0] * p[0] - 0.25;
        (r[0], r[1]) = (g * u[0] - u[1], u[0] + g * u[1]);
    })
    .with_stability(Stability::Dynamics);
    let guess =
        |t: f64, u: &mut [f64]| (u[0], u[1]) = (1.5_f64.sqrt() * t.cos(), 1.5_f64.sqrt() * t.sin());
    let start = Cycle::near(&problem, &[0.0], TAU, guess, &CycleSettings::default()).unwrap();
    let branch = follow(
        &problem,
        "p",
        &start,
        Settings { domain: Some((-2.0, 2.0)), ..Settings::default() },
    );
    assert_eq!(branch.branch.stopped.reason, StopReason::ClosedLoop, "{:?}", branch.branch.stopped);
    let folds: Vec<f64> = branch.branch.events_of(&EventKind::Fold).map(|e| e.p).collect();
    assert_eq!(folds.len(), 2);
    assert!((folds[0] - 0.5).abs() < 1e-8 && (folds[1] + 0.5).abs() < 1e-8, "{folds:?}");
}

/// `θ′ = 1 − p cos θ` on a circle: the period `2π/√(1 − p²)` grows without bound at `p = 1`.
#[test]
fn the_end_at_a_saddle_node_on_a_circle_is_told() {
    let problem = slowing();
    let guess = |t: f64, u: &mut [f64]| (u[0], u[1]) = (t.cos(), t.sin());
    let start = Cycle::near(&problem, &[0.0], TAU, guess, &CycleSettings::default()).unwrap();
    let branch = follow(
        &problem,
        "p",
        &start,
        Settings { domain: Some((-0.1, 2.0)), ..Settings::default() },
    );
    assert_eq!(
        branch.branch.stopped.reason,
        StopReason::PeriodUnbounded,
        "{:?}",
        branch.branch.stopped
    );
    for cycle in &branch.cycles {
        let exact = TAU / (1.0 - cycle.cycle.parameters[0].powi(2)).sqrt();
        // where the parameter has an error so has the exact period to it
        let by_p = cycle.parameter_error.unwrap() + 4e-16;
        let p = cycle.cycle.parameters[0];
        let error = (cycle.period_error.unwrap() + by_p * p / (1.0 - p * p) + 1e-11) * exact;
        assert_within(cycle.cycle.period, exact, error, 1e-3 * exact, "period");
    }
    assert!((branch.branch.points.last().unwrap().p - 1.0).abs() < 1e-5);
}

/// A chain of diffusively coupled Brusselators with no flux, in band storage: the homogeneous cycle is
/// that of one of them, and the multipliers are those of two unknowns for each mode of the chain.
#[test]
fn a_chain_in_band_storage() {
    const CELLS: usize = 8;
    let diffusion = [0.3, 0.1];
    let chain = BandProblem::from_residual(2 * CELLS, (2, 2), &["B"], move |u, p, r| {
        for i in 0..CELLS {
            let (x, y) = (u[2 * i], u[2 * i + 1]);
            r[2 * i] = 1.0 - (p[0] + 1.0) * x + x * x * y;
            r[2 * i + 1] = p[0] * x - x * x * y;
            for k in [i.checked_sub(1), Some(i + 1).filter(|k| *k < CELLS)].into_iter().flatten() {
                r[2 * i] += diffusion[0] * (u[2 * k] - x);
                r[2 * i + 1] += diffusion[1] * (u[2 * k + 1] - y);
            }
        }
    })
    .with_stability(Stability::Dynamics);
    let target = Settings { target: Some(2.6), ..Settings::default() };
    let settings = CycleSettings { intervals: 24, accuracy: 1e-8, ..CycleSettings::default() };
    let single = systems_cycle(&settings);
    let guess = |t: f64, u: &mut [f64]| {
        let state = single.state(t);
        u.chunks_exact_mut(2).for_each(|cell| cell.copy_from_slice(&state));
    };
    let start = Cycle::near(&chain, &[2.5], single.period, guess, &settings).unwrap();
    let branch = follow_by(&chain, "B", &start, target, &settings);
    let cycle = &branch.cycles[0];
    assert!((cycle.cycle.period - single.period).abs() < 1e-7);
    assert_eq!((cycle.unstable, cycle.certified), (Some(0), true), "{:?}", cycle.multipliers);
    assert!(cycle.trivial_error.unwrap() < 1e-7);
    // the product of all is the exponential of the integral of the divergence
    let sum: f64 = cycle.multipliers.iter().map(|m| m.log_modulus).sum();
    let said: f64 = cycle.multipliers.iter().map(|m| m.error.unwrap()).sum();
    let one = |x: f64, y: f64| -3.5 + 2.0 * x * y - x * x;
    let count = 4000;
    let mean: f64 = (0..count)
        .map(|k| {
            let u = single.state(single.period * f64::from(k) / f64::from(count));
            one(u[0], u[1])
        })
        .sum::<f64>()
        / f64::from(count);
    let ends = 2.0 * (CELLS as f64 - 1.0) * (diffusion[0] + diffusion[1]);
    let exact = single.period * (CELLS as f64 * mean - ends);
    assert!((sum - exact).abs() < said + 1e-5 * exact.abs(), "{sum} {exact} {said}");
}

fn systems_cycle(settings: &CycleSettings) -> Cycle {
    let problem = super::systems::brusselator();
    let guess = |t: f64, u: &mut [f64]| {
        let angle = TAU * t / 6.4;
        (u[0], u[1]) = (1.0 + 0.9 * angle.cos(), 2.5 - 0.9 * angle.cos() + 0.6 * angle.sin());
    };
    Cycle::near(&problem, &[2.5], 6.4, guess, settings).unwrap()
}
