//! The known points, each by a way of its own: singular Jacobians on branches that are known in
//! closed form, exact formulas, other resolutions.

#![allow(clippy::unwrap_used)]

use approx::assert_relative_eq;
use continuation::linalg::{Dense, SymmetricBand};
use continuation::{EventKind, Matrix, NewtonSettings, Problem, Settings, Tracer, newton};
use problems::arch::ShallowArch;
use problems::co_oxidation::CoOxidation;
use problems::enz::Enz;
use problems::euler_column::EulerColumn;
use problems::mittelmann::Mittelmann;
use problems::ode::Ode;
use problems::pressurised_sphere::PressurisedSphere;
use problems::swift_hohenberg::SwiftHohenberg;
use problems::{Known, On, Request, find, jkr};
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// The solution that `u` must be, to rounding.
fn solves<P: Problem>(problem: &P, u: &[f64], p: &[f64]) {
    let mut r = vec![0.0; problem.dim()];
    problem.residual(u, p, &mut r).unwrap();
    let mut j = problem.new_jacobian();
    problem.jacobian(u, p, &mut j).unwrap();
    let (worst, scale) = (r.iter().fold(0.0_f64, |m, r| m.max(r.abs())), j.norm());
    assert!(worst <= 1e-13 * scale, "residual {worst:e} at {p:?}, scale {scale:e}");
}

/// Numbers of (negative, positive) eigenvalues.
trait Inertia {
    fn inertia(&mut self) -> (usize, usize);
}

impl Inertia for SymmetricBand {
    fn inertia(&mut self) -> (usize, usize) {
        let floor = f64::EPSILON * self.norm();
        self.factor(floor).inertia.unwrap()
    }
}

impl Inertia for Dense {
    fn inertia(&mut self) -> (usize, usize) {
        self.symmetric_inertia().unwrap()
    }
}

/// How many eigenvalues change sign as the parameter passes `known`, to its tolerance, on the branch
/// of solutions `u`.
fn crossings<P: Problem<Jacobian: Inertia>>(
    problem: &P,
    known: &Known,
    further: &[f64],
    u: impl Fn(f64) -> Vec<f64>,
) -> usize {
    let positive = |way: f64| {
        // far enough for the inertia to be certain; the place itself is checked by its formula
        let value = known.value * (1.0 + way * known.tolerance.max(1e-3));
        let mut p = vec![value];
        p.extend_from_slice(further);
        let u = u(value);
        solves(problem, &u, &p);
        let mut j = problem.new_jacobian();
        problem.jacobian(&u, &p, &mut j).unwrap();
        let (negative, positive) = j.inertia();
        assert_eq!(negative + positive, problem.dim());
        positive
    };
    positive(-1.0).abs_diff(positive(1.0))
}

fn branch_points(name: &str) -> Vec<Known> {
    let known = find(name).unwrap().known;
    known.iter().copied().filter(|k| k.kind == "branch-point").collect()
}

#[test]
fn euler_column_buckles_at_the_discrete_loads() {
    for (n, load) in [(30, 9.861_160_440_778), (100, 9.868_808_678_860), (800, 9.869_591_749_270)] {
        assert_relative_eq!(EulerColumn::new(n).branch_point(1), load, max_relative = 1e-12);
    }
    let [known] = branch_points("euler-column")[..] else { panic!() };
    let problem = EulerColumn::new(800);
    assert_eq!(crossings(&problem, &known, &[], |_| vec![0.0; 800]), 1);
}

#[test]
fn swift_hohenberg_has_its_five_pitchforks() {
    let problem = SwiftHohenberg::new(200);
    let known = branch_points("swift-hohenberg");
    for (known, waves) in known.iter().zip([4, 3, 5, 2, 1]) {
        assert!(known.agrees(problem.branch_point(waves)), "{}", problem.branch_point(waves));
        assert_eq!(crossings(&problem, known, &[], |_| vec![0.0; 400]), 1, "{known:?}");
    }
}

#[test]
fn mittelmann_has_a_double_and_a_simple_point() {
    let problem = Mittelmann::new(30);
    for ((known, (j, k)), count) in
        branch_points("mittelmann").iter().zip([(0, 1), (1, 1)]).zip([2, 1])
    {
        let (lambda, u) = problem.branch_point(j, k);
        assert!(known.agrees(lambda), "{lambda}");
        // the constant solution of the upper branch, by Newton's method from the branch point
        let constant = |lambda: f64| {
            let mut u = u;
            for _ in 0..5 {
                u -= (u - lambda * u.exp()) / (1.0 - lambda * u.exp());
            }
            vec![u; problem.dim()]
        };
        assert_eq!(crossings(&problem, known, &[], constant), count, "{known:?}");
    }
    for ((j, k), limit) in [((0, 1), 0.272_435_228_668), ((1, 1), 0.151_974_940_576)] {
        let error = [40, 80].map(|n| Mittelmann::new(n).branch_point(j, k).0 - limit);
        assert!((error[0] / error[1] - 4.0).abs() < 0.02, "{error:?}");
    }
}

#[test]
fn shallow_arch_has_the_closed_answers() {
    let rise = 2.5;
    let problem = ShallowArch::new(99);
    let h = std::f64::consts::PI / 100.0;
    let m = |k: f64| (2.0 / h * (0.5 * k * h).sin()).powi(2);
    for known in branch_points("shallow-arch") {
        // b of the symmetric branch that carries the load, on the side of the known point
        let symmetric = |load: f64| {
            let mut b = known.value.signum() * (rise * rise - m(2.0) / m(1.0)).sqrt();
            for _ in 0..8 {
                let f = m(1.0).powi(2) * (rise - b + (rise * rise - b * b) * b) - load;
                b -= f / (m(1.0).powi(2) * (rise * rise - 1.0 - 3.0 * b * b));
            }
            problem.unloaded(b)
        };
        assert_eq!(crossings(&problem, &known, &[rise, 0.0], symmetric), 1, "{known:?}");
    }
    // p = h +- 3 sqrt(h^2 - 4) and h +- 2 ((h^2 - 1)/3)^(3/2) as the mesh is refined
    let points = |n: usize| {
        let entry = find("shallow-arch").unwrap();
        let branch = entry
            .trace(&Request { elements: n, ..entry.request() }, &mut |_| ControlFlow::Continue(()))
            .unwrap();
        branch.events_of(&EventKind::Fold).map(|e| e.p).collect::<Vec<_>>()
    };
    let drop = 2.0 * ((rise * rise - 1.0) / 3.0_f64).powf(1.5);
    for (coarse, (fine, exact)) in
        points(49).iter().zip(points(99).iter().zip([rise + drop, rise - drop]))
    {
        let ratio = (coarse - exact) / (fine - exact);
        assert!((ratio - 4.0).abs() < 0.02, "{ratio}");
    }
}

/// The determinant of the second variation in the mode `l`, in closed form.
fn second_variation(l: f64, pressure: f64, bending: f64, poisson: f64) -> f64 {
    let b = 0.5 * (1.0 - poisson) * pressure;
    let radius = (1.0 + b * b).sqrt() - b;
    let n = l * (l + 1.0);
    let stretch = radius * radius / (1.0 - poisson * poisson);
    let tension = 0.5 * (radius * radius - 1.0) / (1.0 - poisson);
    let bend = bending / (radius * radius) * n * (n - 1.0 + poisson);
    let aa = 2.0 * (1.0 + poisson) * stretch + (n - 2.0) * tension + bend;
    let bb = n * (n - 1.0 + poisson) * stretch + n * (n - 2.0) * tension + bend;
    aa * bb - ((1.0 + poisson) * n * stretch + bend).powi(2)
}

#[test]
fn pressurised_sphere_buckles_at_the_closed_pressures() {
    let problem = PressurisedSphere::new(12, 0.3);
    let shrunk = |pressure: f64| {
        let mut u = vec![0.0; problem.dim()];
        u[0] = problem.radius(pressure) - 1.0;
        u
    };
    for (known, l) in branch_points("pressurised-sphere").iter().zip([4.0, 6.0]) {
        let sides = [-1.0, 1.0].map(|way| known.value * (1.0 + way * known.tolerance));
        let [before, after] = sides.map(|p| second_variation(l, p, 1e-3, 0.3));
        assert!(before > 0.0 && after < 0.0, "{known:?}: {before:e} {after:e}");
        assert_eq!(crossings(&problem, known, &[1e-3], shrunk), 1, "{known:?}");
    }
}

#[test]
fn enzyme_breaks_its_symmetry_where_the_difference_mode_is_singular() {
    let rate = |s: f64| 100.0 * s / (1.0 + s + s * s);
    for (known, (low, high)) in branch_points("enz").iter().zip([(1.0, 2.0), (2.0, 6.0)]) {
        // −3 − 100 R'(s) = 0 on s₁ = s₂ = s
        let mode = |s: f64| -3.0 - 100.0 * (1.0 - s * s) / (1.0 + s + s * s).powi(2);
        let s = root(mode, low, high);
        assert!(known.agrees(s + rate(s)), "{} {}", s + rate(s), known.value);
    }
    // the asymmetric branch, found away from the branch points
    let problem = Ode(Enz);
    let mut folds = Vec::new();
    for increasing in [true, false] {
        let settings = Settings {
            domain: Some((22.0, 34.5)),
            increasing: Some(increasing),
            max_points: 400,
            ..Settings::default()
        };
        let tracer = Tracer::new(&problem, "p", &[0.5, 12.0], &[26.0], settings).unwrap();
        let branch = tracer.run(&mut |_| ControlFlow::Continue(()));
        let first = &branch.points[0].u;
        assert!((first[0] - first[1]).abs() > 1.0, "{first:?}");
        folds.extend(branch.events_of(&EventKind::Fold).map(|e| e.p));
    }
    for known in find("enz").unwrap().known.iter().filter(|k| k.on == On::AfterSwitching) {
        assert!(folds.iter().any(|p| known.agrees(*p)), "{known:?}: {folds:?}");
    }
}

#[test]
fn predators_and_prey_in_closed_form() {
    let known = |kind: &str, on: On| {
        let known = find("pp2").unwrap().known;
        *known.iter().find(|k| k.kind == kind && k.on == on).unwrap()
    };
    // prey alone: p = 3u(1 − u)/(1 − e^{−5u}); predators enter at u = 1/3
    let alone = |u: f64| -3.0 * u * (1.0 - u) / (-5.0 * u).exp_m1();
    assert!(known("branch-point", On::AfterSwitching).agrees(alone(1.0 / 3.0)));
    let slope =
        |u: f64| (1.0 - 2.0 * u) * -(-5.0 * u).exp_m1() - 5.0 * u * (1.0 - u) * (-5.0 * u).exp();
    assert!(known("fold", On::AfterSwitching).agrees(alone(root(slope, 0.1, 0.9))));
    // both: u = 1/3, v = 2 − 3p(1 − e^{−5/3}), and the trace of the Jacobian vanishes
    let e = (-5.0_f64 / 3.0).exp();
    let hopf = 1.0 / (5.0 * e - 3.0 * (1.0 - e));
    let trace = |p: f64| 1.0 - (2.0 - 3.0 * p * (1.0 - e)) - 5.0 * p * e;
    assert!(trace(-hopf).abs() < 1e-12);
    assert!(known("hopf", On::AfterSwitching).agrees(-hopf), "{hopf}");
}

#[test]
fn carbon_monoxide_has_its_points_of_two_parameters() {
    let entry = find("co-oxidation").unwrap();
    for known in entry.known.iter().filter(|k| k.kind == "bogdanov-takens") {
        let (p, k) = (known.value, known.second.unwrap().1);
        // the singular equilibrium is approached linearly
        let mut u = if k < 0.8 { [0.0163, 0.5, 0.2] } else { [0.116, 0.2, 0.35] };
        u[2] = (1.0 - u[0] - u[1]) / (1.0 + k);
        let (problem, mut j) = (Ode(CoOxidation), Ode(CoOxidation).new_jacobian());
        let mut r = [0.0; 3];
        for _ in 0..60 {
            problem.linearise(&u, &[p, k], &mut r, &mut j).unwrap();
            j.factor(0.0);
            j.solve(&mut r);
            for (u, r) in u.iter_mut().zip(r) {
                *u -= r;
            }
        }
        problem.linearise(&u, &[p, k], &mut r, &mut j).unwrap();
        assert!(r.iter().all(|r| r.abs() < 1e-12), "{r:?}");
        let mut sizes: Vec<f64> =
            j.spectrum(None).unwrap().iter().map(|(re, im)| re.hypot(*im)).collect();
        sizes.sort_by(f64::total_cmp);
        assert!(sizes[1] < 2e-3 && sizes[2] > 0.1, "{known:?} {sizes:?}");
    }
    // two folds on one side of the cusp, none on the other
    let cusp = entry.known.iter().find(|k| k.kind == "cusp").unwrap();
    let folds = [1e-5, -1e-5].map(|way| {
        let parameters = vec![cusp.second.unwrap().1 * (1.0 + way)];
        let mut request = Request { parameters, start: 0.95, ..entry.request() };
        request.settings.target = Some(1.05);
        request.settings.max_step = Some(1e-3);
        let branch = entry.trace(&request, &mut |_| ControlFlow::Continue(())).unwrap();
        branch.events_of(&EventKind::Fold).map(|e| e.p).collect::<Vec<_>>()
    });
    assert_eq!(folds.each_ref().map(Vec::len), [2, 0], "{folds:?}");
    assert!(folds[0].iter().all(|p| (p / cusp.value - 1.0).abs() < 1e-4), "{folds:?}");
}

#[test]
fn contact_lets_go_at_the_jkr_loads_whatever_the_units() {
    for law in [[1.0, 1.0, 1.0], [3.0, 0.5, 0.2], [2e6, 1e-3, 0.05]] {
        let [_, r, w] = law;
        let (dead, gripped) = jkr::critical_radii(law);
        let (approach, load) = jkr::equilibrium(gripped, law);
        assert_relative_eq!(load, -5.0 / 6.0 * PI * w * r, max_relative = 1e-12);
        assert_relative_eq!(approach, -3.0 * gripped * gripped / r, max_relative = 1e-12);
        for (name, exact, start) in [
            ("jkr-load", -1.5 * PI * w * r, 2.0 * PI * w * r),
            ("jkr-grip", approach, -2.0 * approach),
        ] {
            let entry = find(name).unwrap();
            let mut request = Request { start, parameters: law.to_vec(), ..entry.request() };
            request.settings.target = Some(2.0 * exact);
            let branch = entry.trace(&request, &mut |_| ControlFlow::Continue(())).unwrap();
            let folds: Vec<_> = branch.events_of(&EventKind::Fold).collect();
            assert_eq!(folds.len(), 1, "{name} {law:?}");
            assert_relative_eq!(folds[0].p, exact, max_relative = 1e-10);
            let counts = (folds[0].unstable_before, folds[0].unstable_after);
            assert_eq!(counts, (Some(0), Some(1)));
            let at = &branch.points[folds[0].point];
            let radius = if name == "jkr-load" { dead } else { gripped };
            assert_relative_eq!(at.u[0], radius, max_relative = 1e-5);
        }
    }
}

/// The buckled column is Euler's elastica: `√λ = 2K(sin θ_max/2)`, to second order.
#[test]
fn buckled_column_is_the_elastica() {
    let (lambda, mut errors) = (13.0_f64, Vec::new());
    // K by the arithmetic-geometric mean
    let quarter = |k: f64| {
        let (mut a, mut g) = (1.0_f64, (1.0 - k * k).sqrt());
        for _ in 0..40 {
            (a, g) = (0.5 * (a + g), (a * g).sqrt());
        }
        0.5 * PI / a
    };
    let k = root(|k| 2.0 * quarter(k) - lambda.sqrt(), 0.0, 0.99);
    for n in [49, 99, 199] {
        let problem = EulerColumn::new(n);
        let mut u: Vec<f64> =
            (1..=n).map(|i| 1.5 * (PI * i as f64 / (n as f64 + 1.0)).sin()).collect();
        newton(&problem, &mut u, &[lambda], &NewtonSettings::default()).unwrap();
        errors.push((0.5 * u[n / 2]).sin() - k);
    }
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1] - 4.0).abs() < 0.05, "{errors:?}");
    }
}

/// The folds of the snake on other meshes: high order.
#[test]
fn snaking_folds_converge() {
    let entry = find("swift-hohenberg-snaking").unwrap();
    let folds = [240, 300, 600].map(|elements| {
        let request = Request { elements, ..entry.request() };
        let branch = entry.trace(&request, &mut |_| ControlFlow::Continue(())).unwrap();
        branch.events_of(&EventKind::Fold).map(|e| e.p).collect::<Vec<_>>()
    });
    for (k, fine) in folds[2].iter().enumerate() {
        let order = ((folds[0][k] - fine) / (folds[1][k] - fine)).ln() / (300.0_f64 / 240.0).ln();
        assert!(order > 9.0, "{order}");
        assert!((folds[1][k] - fine).abs() < 3e-9);
    }
}

/// A root between two values of opposite sign.
fn root(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let sign = f(low).signum();
    assert!(sign * f(high) < 0.0, "{} {}", f(low), f(high));
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if sign * f(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
