//! Hopf points of problems without derivatives of their own that are linear in some directions: the curve of such
//! points, and the first Lyapunov coefficient.

use continuation::codim2::HopfCurve;
use continuation::{Criticality, DenseProblem, EventKind, Settings, StopReason, Tracer};
use std::ops::ControlFlow;

/// Rosenzweig and MacArthur's predator and prey, linear in the predators: the prey oscillates where there is more room
/// than `K = 2x + 1/(ah)`, always gently.
#[test]
fn predator_and_prey() {
    let (a, h, e) = (1.0, 0.5, 0.8);
    let problem = DenseProblem::from_residual(2, &["K", "m"], move |u, p, r| {
        let eaten = a * u[0] * u[1] / (1.0 + a * h * u[0]);
        r[0] = u[0] * (1.0 - u[0] / p[0]) - eaten;
        r[1] = e * eaten - p[1] * u[1];
    })
    .boxed();
    let prey = |m: f64| m / (a * (e - h * m));
    let (m, x) = (0.3, prey(0.3));
    let start = [x, (1.0 - x / 2.0) * (1.0 + a * h * x) / a];
    let settings = Settings { target: Some(10.0), ..Settings::default() };
    let branch = Tracer::new(&problem, "K", &start, &[2.0, m], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()));
    let hopf = branch.events_of(&EventKind::Hopf).next().unwrap();
    assert_eq!(hopf.hopf().unwrap().criticality, Some(Criticality::Supercritical));
    let curve = HopfCurve::at(&problem, &branch, hopf, "m").unwrap();
    let settings = Settings { domain: Some((0.05, 0.5)), ..Settings::default() };
    let found = curve.trace(&settings, &[], &mut |_| ControlFlow::Continue(())).unwrap().branch;
    assert_eq!(found.stopped.reason, StopReason::Domain);
    assert!(found.events.is_empty(), "{:?}", found.events);
    assert!((20..200).contains(&found.points.len()), "{}", found.points.len());
    let ends = [&found.points[0], &found.points[found.points.len() - 1]].map(|point| point.p);
    assert!(ends.map(|end| (end - 0.275).abs()).iter().all(|d| (d - 0.225).abs() < 1e-12));
    for point in &found.points {
        let known = 2.0 * prey(point.p) + 1.0 / (a * h);
        assert!((point.u[2] / known - 1.0).abs() < 1e-9, "{} {known}", point.u[2]);
    }
}

/// Coefficients of `x²`, `xy`, `y²`, `x³`, `x²y`, `xy²`, `y³`.
type Terms = [f64; 7];

fn sum(c: &Terms, x: f64, y: f64) -> f64 {
    let quadratic = c[0] * x * x + c[1] * x * y + c[2] * y * y;
    quadratic + c[3] * x.powi(3) + c[4] * x * x * y + c[5] * x * y * y + c[6] * y.powi(3)
}

/// Guckenheimer and Holmes, Eq. (3.4.11), of `x′ = −ωy + f`, `y′ = ωx + g`; with an eigenvector of length 1
/// `l₁` is `2a/ω`. Its largest part, too.
fn coefficient(omega: f64, f: &Terms, g: &Terms) -> (f64, f64) {
    let (fxx, fxy, fyy) = (2.0 * f[0], f[1], 2.0 * f[2]);
    let (gxx, gxy, gyy) = (2.0 * g[0], g[1], 2.0 * g[2]);
    let cubic = [6.0 * f[3], 2.0 * f[5], 2.0 * g[4], 6.0 * g[6]];
    let quadratic =
        [fxy * fxx, fxy * fyy, -gxy * gxx, -gxy * gyy, -fxx * gxx, fyy * gyy].map(|x| x / omega);
    let parts = cubic.into_iter().chain(quadratic).map(|x| x / 8.0 / omega);
    (parts.clone().sum(), parts.map(f64::abs).fold(0.0, f64::max))
}

/// Random systems in which most terms are missing, in units from 1e-4 to 1e4: some are linear along one part of the
/// eigenvector, some along both.
#[test]
fn lyapunov_coefficients_of_systems_with_few_terms() {
    let mut state = 7_u64;
    let mut random = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut signs = 0;
    for k in 0..200 {
        let mut terms = || -> Terms {
            std::array::from_fn(|_| if random() < 0.3 { 2.0 * random() - 1.0 } else { 0.0 })
        };
        let (f, g) = (terms(), terms());
        let omega = 10_f64.powf(2.0 * random() - 1.0);
        let unit = 10_f64.powf(8.0 * random() - 4.0);
        let (exact, part) = coefficient(omega, &f, &g);
        let problem = DenseProblem::from_residual(2, &["p"], move |u, p, r| {
            let (x, y) = (u[0] / unit, u[1] / unit);
            r[0] = unit * (p[0] * x - omega * y + sum(&f, x, y));
            r[1] = unit * (omega * x + p[0] * y + sum(&g, x, y));
        })
        .boxed();
        let settings = Settings { target: Some(0.1), ..Settings::default() };
        let branch = Tracer::new(&problem, "p", &[0.0; 2], &[-0.13], settings)
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(()));
        let event = branch.events_of(&EventKind::Hopf).next().unwrap();
        let form = event.hopf().unwrap();
        let (found, error) = (form.lyapunov * unit * unit, form.lyapunov_error * unit * unit);
        let off = (found - exact).abs();
        let what = format!("{k}: {found} ± {error:e}, is {exact}");
        assert!(off < 10.0 * error + 1e-9, "{what}");
        // where there is nothing but rounding, that of terms which the coefficient does not have
        assert!(part == 0.0 || off < 1e-6 * (part + 0.01), "{what}");
        if let Some(criticality) = form.criticality {
            signs += 1;
            let sign =
                if exact < 0.0 { Criticality::Supercritical } else { Criticality::Subcritical };
            assert_eq!(criticality, sign, "{what}");
        }
    }
    assert!(signs > 150, "{signs}");
}

/// Rossler's system, `z′ = b + z(x − c)`: at `a = b`, `c = 2a` a zero-Hopf point, where the first Lyapunov coefficient has a
/// pole. It changes its sign there, which is no generalised Hopf point.
#[test]
fn the_sign_changes_at_a_pole() {
    for k in 0..8 {
        let b = 0.13 + 0.03 * f64::from(k);
        let problem = DenseProblem::from_residual(3, &["c", "a"], move |u, p, r| {
            r[0] = -u[1] - u[2];
            r[1] = u[0] + p[1] * u[1];
            r[2] = b + u[2] * (u[0] - p[0]);
        })
        .boxed();
        let (a, c) = (0.8 * b, 3.0_f64);
        let z = (c - (c * c - 4.0 * a * b).sqrt()) / (2.0 * a);
        let settings = Settings { domain: Some((0.0, 3.5)), ..Settings::default() };
        let settings = Settings { increasing: Some(false), max_points: 200, ..settings };
        let branch = Tracer::new(&problem, "c", &[a * z, -z, z], &[c, a], settings)
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(()));
        let hopf = branch.events_of(&EventKind::Hopf).next().unwrap();
        let curve = HopfCurve::at(&problem, &branch, hopf, "a").unwrap();
        let settings =
            Settings { domain: Some((0.5 * b, 1.2 * b)), max_points: 300, ..Settings::default() };
        let found = curve.trace(&settings, &[], &mut |_| ControlFlow::Continue(())).unwrap().branch;
        let poles: Vec<f64> = found.events_of(&EventKind::ZeroHopf).map(|event| event.p).collect();
        assert!(poles.len() == 1 && (poles[0] / b - 1.0).abs() < 1e-7, "{b}: {poles:?}");
        for event in found.events_of(&EventKind::GeneralisedHopf) {
            assert!((event.p / b - 1.0).abs() > 1e-6, "{b}: {event:?}");
        }
    }
}
