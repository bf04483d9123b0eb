//! Curves of limit points and period doublings against exact ones.

use super::follow;
use super::systems::System;
use continuation::cycles::{
    Cycle, CycleCurve, CycleError, CycleSettings, SmallCycle, SpecialCycles, curve,
};
use continuation::{EventKind, Parameter, Progress, Settings, StopReason, Tracer};
use std::ops::ControlFlow;

const fn parameter(name: &'static str) -> Parameter {
    Parameter::new(name, "", 1.0)
}

/// Bautin's normal form: cycles of radius `√ρ` where `μ + s ρ − ρ² = 0`, limit points at `μ = −s²/4`.
fn bautin() -> System {
    System {
        n: 2,
        parameters: vec![parameter("mu"), parameter("s")],
        field: |u, p, r| {
            let square = u[0] * u[0] + u[1] * u[1];
            let g = p[0] + p[1] * square - square * square;
            r[0] = g * u[0] - u[1];
            r[1] = u[0] + g * u[1];
        },
        slopes: |u, p, set| {
            let square = u[0] * u[0] + u[1] * u[1];
            let g = p[0] + p[1] * square - square * square;
            let by_square = 2.0 * (p[1] - 2.0 * square);
            set(0, 0, g + by_square * u[0] * u[0]);
            set(0, 1, -1.0 + by_square * u[0] * u[1]);
            set(1, 0, 1.0 + by_square * u[0] * u[1]);
            set(1, 1, g + by_square * u[1] * u[1]);
            set(0, 2, u[0]);
            set(1, 2, u[1]);
            set(0, 3, square * u[0]);
            set(1, 3, square * u[1]);
        },
    }
}

/// Of a circle that is run through in `2π`, beside which `z` makes half a turn: multipliers
/// `−exp(2πα)`, `−exp(−2π)`, with `α = p − q² + 0.3 q`.
fn half_turn() -> System {
    System {
        n: 4,
        parameters: vec![parameter("p"), parameter("q")],
        field: |u, p, r| {
            let alpha = p[0] - p[1] * p[1] + 0.3 * p[1];
            let [x, y, a, b] = [u[0], u[1], u[2], u[3]];
            let (g, square) = (1.0 - x * x - y * y, a * a + b * b);
            let (mean, half) = (0.5 * (alpha - 1.0), 0.5 * (alpha + 1.0));
            r[0] = g * x - y;
            r[1] = x + g * y;
            r[2] = mean * a + half * (x * a + y * b) - 0.5 * b - square * a;
            r[3] = mean * b + half * (y * a - x * b) + 0.5 * a - square * b;
        },
        slopes: |u, p, set| {
            let alpha = p[0] - p[1] * p[1] + 0.3 * p[1];
            let [x, y, a, b] = [u[0], u[1], u[2], u[3]];
            let (g, square) = (1.0 - x * x - y * y, a * a + b * b);
            let (mean, half) = (0.5 * (alpha - 1.0), 0.5 * (alpha + 1.0));
            set(0, 0, g - 2.0 * x * x);
            set(0, 1, -1.0 - 2.0 * x * y);
            set(1, 0, 1.0 - 2.0 * x * y);
            set(1, 1, g - 2.0 * y * y);
            set(2, 0, half * a);
            set(2, 1, half * b);
            set(3, 0, -half * b);
            set(3, 1, half * a);
            set(2, 2, mean + half * x - square - 2.0 * a * a);
            set(2, 3, half * y - 0.5 - 2.0 * a * b);
            set(3, 2, half * y + 0.5 - 2.0 * a * b);
            set(3, 3, mean - half * x - square - 2.0 * b * b);
            let by_alpha = [0.5 * (a + x * a + y * b), 0.5 * (b + y * a - x * b)];
            for (row, by) in [2, 3].into_iter().zip(by_alpha) {
                set(row, 4, by);
                set(row, 5, by * (0.3 - 2.0 * p[1]));
            }
        },
    }
}

fn circle(system: &System, p: &[f64], radius: f64) -> Cycle {
    let orbit = |t: f64, u: &mut [f64]| {
        u.fill(0.0);
        (u[0], u[1]) = (radius * t.cos(), radius * t.sin());
    };
    let period = std::f64::consts::TAU;
    Cycle::near(system, p, period, orbit, &CycleSettings::default()).unwrap()
}

fn follow_special(
    system: &System,
    (first, increasing, range): (&str, bool, (f64, f64)),
    start: &Cycle,
    (kind, second): (&EventKind, &str),
    domain: (f64, f64),
) -> Result<CycleCurve, CycleError> {
    let settings =
        Settings { domain: Some(range), increasing: Some(increasing), ..Settings::default() };
    let branch = follow(system, first, start, settings);
    let event = branch.branch.events_of(kind).next().unwrap();
    let settings = Settings { domain: Some(domain), ..Settings::default() };
    let cycles = CycleSettings::default();
    let observer = &mut |_: &Progress| ControlFlow::Continue(());
    curve(system, &branch, event, second, (&settings, &cycles), None, observer)
}

#[test]
fn limit_points_of_cycles_end_at_the_generalised_hopf_point() {
    let system = bautin();
    let start = circle(&system, &[-0.2, 1.0], ((1.0 + 0.2_f64.sqrt()) / 2.0).sqrt());
    let curve = follow_special(
        &system,
        ("mu", false, (-1.0, -0.05)),
        &start,
        (&EventKind::Fold, "s"),
        (-1.0, 2.0),
    )
    .unwrap();
    assert_eq!(curve.kind, SpecialCycles::LimitPoints);
    assert!(curve.points.len() > 20);
    for point in &curve.points {
        let [mu, s] = curve.at(point);
        assert!((mu + 0.25 * s * s).abs() < 1e-8 * (1.0 + s * s), "{mu} {s}");
        assert!((point.cycle.period / std::f64::consts::TAU - 1.0).abs() < 1e-9);
        // radius √(s/2)
        let state = point.cycle.state(0.0);
        assert!((state[0].hypot(state[1]) - (0.5 * s).sqrt()).abs() < 1e-5);
        // two multipliers are 1, to the root of rounding
        assert!(point.multipliers.iter().all(|m| m.log_modulus.abs() < 1e-5), "{mu} {s}");
    }
    assert!(curve.points.iter().filter_map(|point| point.error).all(|error| error < 1e-7));
    assert!(curve.points.iter().any(|point| point.error.is_some()));
    assert!(curve.events.is_empty());
    assert_eq!(curve.began.reason, StopReason::CyclesVanish, "{}", curve.began.detail);
    assert_eq!(curve.stopped.reason, StopReason::Domain, "{}", curve.stopped.detail);
    assert!((curve.at(curve.points.last().unwrap())[1] - 2.0).abs() < 1e-12);
    // from where it ends, the generalised Hopf point is near
    let [mu, s] = curve.at(&curve.points[0]);
    assert!(s > 0.0 && s < 0.02 && mu.abs() < 1e-4, "{mu} {s}");
}

#[test]
fn period_doublings_in_two_parameters() {
    let system = half_turn();
    let start = circle(&system, &[-0.2, 0.5], 1.0);
    let kind = EventKind::PeriodDoubling;
    let curve =
        follow_special(&system, ("p", true, (-1.0, 0.3)), &start, (&kind, "q"), (-1.0, 1.5))
            .unwrap();
    assert_eq!(curve.kind, SpecialCycles::Doublings);
    let mut least = f64::INFINITY;
    for point in &curve.points {
        let [p, q] = curve.at(point);
        assert!((p - q * q + 0.3 * q).abs() < 1e-8, "{p} {q}");
        assert!((point.cycle.period / std::f64::consts::TAU - 1.0).abs() < 1e-9);
        let flips = |m: &continuation::cycles::Multiplier| {
            m.argument == std::f64::consts::PI && m.log_modulus.abs() < 1e-7
        };
        assert!(point.multipliers.iter().any(flips), "{:?}", point.multipliers);
        least = least.min(p);
    }
    // the curve turns in the first parameter at q = 0.15
    assert!(least < -0.02);
    let ends = [curve.points.first(), curve.points.last()].map(|x| curve.at(x.unwrap())[1]);
    assert!((ends[0] + 1.0).abs() < 1e-12 && (ends[1] - 1.5).abs() < 1e-12, "{ends:?}");
    assert!([&curve.began, &curve.stopped].iter().all(|stop| stop.reason == StopReason::Domain));
}

#[test]
fn curves_of_other_points_and_unknown_parameters_are_refused() {
    let system = bautin();
    let start = circle(&system, &[-0.2, 1.0], ((1.0 + 0.2_f64.sqrt()) / 2.0).sqrt());
    let fold = |second| {
        follow_special(
            &system,
            ("mu", false, (-1.0, -0.05)),
            &start,
            (&EventKind::Fold, second),
            (-1.0, 2.0),
        )
    };
    let unknown = fold("nu").unwrap_err().to_string();
    assert!(unknown.contains("nu") && unknown.contains("mu, s"), "{unknown}");
    assert!(fold("mu").unwrap_err().to_string().contains("mu"));
}

/// `g = μ + s v − v³` with `v = ρ − 1`: limit points at `s = 3 v²`, `μ = −2 v³`, a cusp at the origin.
fn cusp() -> System {
    System {
        n: 2,
        parameters: vec![parameter("mu"), parameter("s")],
        field: |u, p, r| {
            let v = u[0] * u[0] + u[1] * u[1] - 1.0;
            let g = p[0] + p[1] * v - v * v * v;
            r[0] = g * u[0] - u[1];
            r[1] = u[0] + g * u[1];
        },
        slopes: |u, p, set| {
            let v = u[0] * u[0] + u[1] * u[1] - 1.0;
            let g = p[0] + p[1] * v - v * v * v;
            let by_square = 2.0 * (p[1] - 3.0 * v * v);
            set(0, 0, g + by_square * u[0] * u[0]);
            set(0, 1, -1.0 + by_square * u[0] * u[1]);
            set(1, 0, 1.0 + by_square * u[0] * u[1]);
            set(1, 1, g + by_square * u[1] * u[1]);
            set(0, 2, u[0]);
            set(1, 2, u[1]);
            set(0, 3, v * u[0]);
            set(1, 3, v * u[1]);
        },
    }
}

#[test]
fn a_cusp_of_cycles_lies_between_two_branches_of_limit_points() {
    let system = cusp();
    // μ = 0 and s = 0.5, on the lower of the three sheets
    let start = circle(&system, &[0.0, 0.5], (1.0 - 0.5_f64.sqrt()).sqrt());
    let kind = EventKind::Fold;
    let curve =
        follow_special(&system, ("mu", true, (-0.5, 0.5)), &start, (&kind, "s"), (-1.0, 0.8))
            .unwrap();
    for point in &curve.points {
        let [mu, s] = curve.at(point);
        assert!((27.0 * mu * mu - 4.0 * s.powi(3)).abs() < 1e-7, "{mu} {s}");
    }
    let kinds: Vec<&EventKind> = curve.events.iter().map(|event| &event.kind).collect();
    assert_eq!(kinds, [&EventKind::Cusp]);
    let [mu, s] = curve.at(&curve.points[curve.events[0].point]);
    assert!(mu.abs() < 1e-6 && s.abs() < 1e-6, "{mu} {s}");
    assert!([&curve.began, &curve.stopped].iter().all(|stop| stop.reason == StopReason::Domain));
    // once along both branches that meet there
    let ends = [curve.points.first(), curve.points.last()].map(|x| curve.at(x.unwrap()));
    assert!(ends[0][0] * ends[1][0] < 0.0 && ends.iter().all(|end| (end[1] - 0.8).abs() < 1e-12));
}

/// Rössler's first period doubling in `a` and `c`, against branches in `a` alone.
#[test]
fn period_doublings_agree_with_branches_in_one_parameter() {
    let system = System {
        n: 3,
        parameters: vec![parameter("a"), parameter("c")],
        field: |u, p, r| {
            r[0] = -u[1] - u[2];
            r[1] = u[0] + p[0] * u[1];
            r[2] = 0.2 + u[2] * (u[0] - p[1]);
        },
        slopes: |u, p, set| {
            set(0, 1, -1.0);
            set(0, 2, -1.0);
            set(1, 0, 1.0);
            set(1, 1, p[0]);
            set(1, 3, u[1]);
            set(2, 0, u[2]);
            set(2, 2, u[0] - p[1]);
            set(2, 4, -u[2]);
        },
    };
    let z = 0.2 / 5.7;
    let settings = Settings { target: Some(0.02), ..Settings::default() };
    let equilibria = Tracer::new(&system, "a", &[-0.1 * z, -z, z], &[-0.1, 5.7], settings)
        .unwrap()
        .run_quietly();
    let hopf = equilibria.events_of(&EventKind::Hopf).next().unwrap();
    let cycles = CycleSettings::default();
    let small = SmallCycle::at_hopf(&system, &equilibria, hopf, &cycles).unwrap();
    let kind = EventKind::PeriodDoubling;
    let range = ("a", true, (0.0, 0.13));
    let curve = follow_special(&system, range, &small.cycle, (&kind, "c"), (4.0, 5.7)).unwrap();
    assert_eq!(curve.began.reason, StopReason::Domain, "{}", curve.began.detail);
    for at in [0, curve.points.len() / 2] {
        let point = &curve.points[at];
        let [a, _] = curve.at(point);
        // from a little before it
        let mut start = point.cycle.clone();
        start.parameters[0] = a - 0.002;
        let settings = Settings { target: Some(a + 0.002), ..Settings::default() };
        let branch = follow(&system, "a", &start, settings);
        let doubling = branch.branch.events_of(&kind).next().unwrap();
        assert!((doubling.p - a).abs() < 1e-8, "{} {a}", doubling.p);
    }
}
