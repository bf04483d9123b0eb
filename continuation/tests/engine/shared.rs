//! Threads share problems: what one of them evaluates is what it would evaluate alone.

use super::codim2::{co_branch, co_oxidation};
use super::cycles::systems::van_der_pol;
use continuation::codim2::{BranchPointCurve, Curve, CurveError, FoldCurve, HopfCurve};
use continuation::cycles::{Cycle, CycleProblem, CycleSettings};
use continuation::linalg::{AnyMatrix, Band, Dense, Matrix, Sparse};
use continuation::{
    BandProblem, BoxedResidual, DenseProblem, EventKind, ParamId, Parameter, Problem,
    ResidualProblem, Settings, Tracer,
};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering::SeqCst};
use std::time::{Duration, Instant};

const THREADS: usize = 4;

/// The same work on several threads at once.
fn everywhere<T: Send>(work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    std::thread::scope(|scope| {
        let work = &work;
        let begun: Vec<_> = (0..THREADS).map(|thread| scope.spawn(move || work(thread))).collect();
        begun.into_iter().map(|thread| thread.join().unwrap()).collect()
    })
}

#[test]
fn problems_matrices_and_tracers_are_send_and_sync() {
    fn shared<T: Send + Sync>() {}
    fn movable<T: Send>() {}
    shared::<ResidualProblem<Dense, BoxedResidual>>();
    shared::<ResidualProblem<Band, BoxedResidual>>();
    shared::<ResidualProblem<Sparse, BoxedResidual>>();
    shared::<FoldCurve<'_>>();
    shared::<HopfCurve<'_>>();
    shared::<BranchPointCurve<'_>>();
    shared::<CycleProblem<'_>>();
    shared::<AnyMatrix>();
    movable::<Tracer<'static>>();
}

/// A residual that waits until another thread is inside of it too, for at most some seconds.
#[test]
fn no_evaluation_waits_for_another() {
    let (inside, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let problem = DenseProblem::from_residual(1, &["p"], |u, p, r| {
        let present = inside.fetch_add(1, SeqCst) + 1;
        most.fetch_max(present, SeqCst);
        let begun = Instant::now();
        while most.load(SeqCst) < 2 && begun.elapsed() < Duration::from_secs(10) {
            std::thread::yield_now();
        }
        inside.fetch_sub(1, SeqCst);
        r[0] = u[0].sin() - p[0];
    });
    everywhere(|_| problem.jacobian(&[0.3], &[0.1], &mut problem.new_jacobian()).unwrap());
    assert!(most.load(SeqCst) >= 2);
}

/// Derivatives by differences and their errors at many states, to the last bit.
#[test]
fn derivatives_are_those_of_one_thread() {
    let n = 12;
    let problem = BandProblem::from_residual(n, (1, 1), &["p"], |u, p, r| {
        for i in 0..n {
            let left = if i > 0 { u[i - 1] } else { 0.0 };
            let right = if i + 1 < n { u[i + 1] } else { 0.0 };
            r[i] = left - 2.0 * u[i] + right + p[0] * (3.0 * u[i]).exp();
        }
    });
    let evaluate = |thread: usize| -> Vec<u64> {
        let (mut j, mut slope, mut error) = (problem.new_jacobian(), vec![0.0; n], vec![0.0; n]);
        let mut all = Vec::new();
        for round in 0..40 {
            let u: Vec<f64> = (0..n).map(|i| ((i + round * (thread + 1)) as f64).sin()).collect();
            let p = [0.1 * (round + thread) as f64];
            problem.jacobian(&u, &p, &mut j).unwrap();
            problem.parameter_derivative(&u, &p, ParamId(0), &mut slope).unwrap();
            problem.derivative_error(&u, &p, ParamId(0), &u, 1.0, &mut error).unwrap();
            let entries = (0..n).flat_map(|i| (0..n).map(move |k| (i, k)));
            all.extend(entries.map(|(i, k)| j.get(i, k).to_bits()));
            all.extend(slope.iter().chain(&error).map(|x| x.to_bits()));
        }
        all
    };
    for (thread, found) in everywhere(evaluate).into_iter().enumerate() {
        assert_eq!(found, evaluate(thread));
    }
}

/// Borders follow a trace: another one, before it or beside it, does not change them.
fn alone_and_beside_others(
    trace: impl Fn(&Settings) -> Result<Curve, CurveError> + Sync,
    domains: [(f64, f64); THREADS],
) {
    let run = |thread: usize| {
        trace(&Settings { domain: Some(domains[thread]), ..Settings::default() }).unwrap()
    };
    let first: Vec<Curve> = (0..THREADS).map(run).collect();
    assert!(first.iter().all(|curve| curve.branch.points.len() > 10));
    for (thread, found) in everywhere(run).into_iter().enumerate() {
        assert_eq!(format!("{found:?}"), format!("{:?}", first[thread]), "{thread}");
    }
    assert_eq!(format!("{:?}", run(0)), format!("{:?}", first[0]));
}

#[test]
fn curves_of_special_points_are_those_of_one_thread() {
    let quiet = |_: &continuation::Progress| ControlFlow::Continue(());
    let problem = co_oxidation();
    let branch = co_branch(&problem);
    let domains = [(0.0, 2.0), (0.1, 2.0), (0.0, 1.5), (0.2, 1.0)];
    let fold = branch.events_of(&EventKind::Fold).next().unwrap();
    let curve = FoldCurve::at(&problem, &branch, fold, "k").unwrap();
    alone_and_beside_others(|settings| curve.trace(settings, &[], &mut { quiet }), domains);
    let hopf = branch.events_of(&EventKind::Hopf).next().unwrap();
    let curve = HopfCurve::at(&problem, &branch, hopf, "k").unwrap();
    alone_and_beside_others(|settings| curve.trace(settings, &[], &mut { quiet }), domains);

    let enz = DenseProblem::from_residual(2, &["p", "q"], super::codim2::branch_points::enz);
    let settings = Settings { target: Some(40.0), ..Settings::default() };
    let start = Tracer::new(&enz, "p", &[0.0, 0.0], &[0.0, 100.0], settings).unwrap();
    let branch = start.run_quietly();
    let event = branch.events_of(&EventKind::BranchPoint).next().unwrap();
    let curve = BranchPointCurve::at(&enz, &branch, event, "q").unwrap();
    let domains = [(20.0, 200.0), (90.0, 150.0), (50.0, 120.0), (20.0, 400.0)];
    alone_and_beside_others(|settings| curve.trace(settings, &[], &mut { quiet }), domains);
}

#[test]
fn equations_of_orbits_are_those_of_one_thread() {
    let problem = van_der_pol();
    let settings = CycleSettings::default();
    let guess = |t: f64, u: &mut [f64]| (u[0], u[1]) = (2.0 * t.cos(), -2.0 * t.sin());
    let orbit = Cycle::near(&problem, &[1.0], 6.6, guess, &settings).unwrap();
    let equations = CycleProblem::new(&problem, &orbit).unwrap();
    let x = equations.unknowns(&orbit);
    let evaluate = |thread: usize| {
        let mut j = equations.new_jacobian();
        let (mut r, mut product) = (x.clone(), x.clone());
        let (mut all, mut moduli) = (Vec::new(), Vec::new());
        for round in 0..10 {
            let moved: Vec<f64> =
                x.iter().map(|x| x * (1.0 + 1e-3 * (round * (thread + 1)) as f64)).collect();
            equations.linearise(&moved, &[1.0], &mut r, &mut j).unwrap();
            j.mul(&x, &mut product);
            all.extend(r.iter().chain(&product).map(|x| x.to_bits()));
            let found = equations.multipliers(&moved, &[1.0]).unwrap();
            moduli.extend(found.iter().map(|m| m.log_modulus));
        }
        (all, moduli)
    };
    for (thread, (found, moduli)) in everywhere(evaluate).into_iter().enumerate() {
        let (alone, known) = evaluate(thread);
        assert_eq!(found, alone);
        // those begin where the ones before ended: the same to rounding
        for (a, b) in moduli.iter().zip(&known) {
            assert!((a - b).abs() <= 1e-10 * (1.0 + b.abs()), "{a} and {b}");
        }
    }
}

/// Names that a program makes: through a branch, its events and a curve in two parameters.
#[test]
fn names_may_be_made_as_the_program_runs() {
    let (load, rise) = (format!("load_{}", 1), format!("rise_{}", 2));
    let problem = DenseProblem::from_residual(1, &[load.clone(), rise.clone()], |u, p, r| {
        r[0] = p[0] + p[1] * u[0] - u[0].powi(3);
    })
    .observing(format!("height of {load}"), |u, _| u[0]);
    let expected = Parameter::named(load.clone(), "", 1.0);
    assert_eq!(problem.parameters()[0], expected);
    let settings = Settings { target: Some(2.0), ..Settings::default() };
    let branch =
        Tracer::new(&problem, &load, &[-1.5], &[-2.0, 1.0], settings).unwrap().run_quietly();
    assert_eq!((&branch.parameter, &branch.observables[0][..]), (&load, "height of load_1"));
    let fold = branch.events_of(&EventKind::Fold).next().unwrap();
    let settings = Settings { domain: Some((0.5, 1.5)), ..Settings::default() };
    let curve = FoldCurve::at(&problem, &branch, fold, &rise)
        .unwrap()
        .trace(&settings, &[], &mut |_| ControlFlow::Continue(()))
        .unwrap();
    assert_eq!(curve.branch.parameter, rise);
    let mu = curve.column(&load).unwrap();
    for (point, mu) in curve.branch.points.iter().zip(&mu) {
        assert!((27.0 * mu * mu - 4.0 * point.p.powi(3)).abs() < 1e-9);
    }
}
