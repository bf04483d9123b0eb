//! No state outside the domain of the parameter is evaluated.

#![allow(clippy::unwrap_used)]

use continuation::diagram::{DiagramSettings, Explorer};
use continuation::linalg::Dense;
use continuation::{
    Branch, EvalError, EventKind, Matrix, ParamId, Parameter, Problem, Settings, StopReason,
    Tracer, both_ways,
};
use std::ops::ControlFlow;
use std::sync::Mutex;

static PARAMETERS: [Parameter; 1] = [Parameter::new("p", "", 1.0)];

const NONE: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

/// `f(u, p) = 0` with `f`, `f_u` and `f_p` in closed form, and the parameters that were asked for.
struct Asked<F> {
    f: F,
    /// The lowest and the highest.
    range: Mutex<(f64, f64)>,
}

impl<F: Fn(f64, f64) -> [f64; 3] + Send + Sync> Asked<F> {
    fn new(f: F) -> Self {
        Asked { f, range: Mutex::new(NONE) }
    }
    fn value(&self, u: f64, p: f64) -> [f64; 3] {
        let mut range = self.range.lock().unwrap();
        *range = (range.0.min(p), range.1.max(p));
        drop(range);
        (self.f)(u, p)
    }
    fn range(&self) -> (f64, f64) {
        *self.range.lock().unwrap()
    }
    fn forget(&self) {
        *self.range.lock().unwrap() = NONE;
    }
    fn inside(&self, (lo, hi): (f64, f64)) -> bool {
        let (lowest, highest) = self.range();
        lo <= lowest && highest <= hi
    }
}

impl<F: Fn(f64, f64) -> [f64; 3] + Send + Sync> Problem for Asked<F> {
    type Jacobian = Dense;
    fn dim(&self) -> usize {
        1
    }
    fn parameters(&self) -> &[Parameter] {
        &PARAMETERS
    }
    fn new_jacobian(&self) -> Dense {
        Dense::new(1)
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        r[0] = self.value(u[0], p[0])[0];
        Ok(())
    }
    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        j.set_zero();
        j.set(0, 0, self.value(u[0], p[0])[1]);
        Ok(())
    }
    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        _which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        out[0] = self.value(u[0], p[0])[2];
        Ok(())
    }
}

fn both<P: Problem>(problem: &P, u: f64, p: f64, domain: (f64, f64)) -> Branch {
    let settings = Settings { domain: Some(domain), ..Settings::default() };
    both_ways(problem, "p", &[u], &[p], settings, &[], &mut |_| ControlFlow::Continue(())).unwrap()
}

/// Branches `u = g(p)` that have no value beyond the domain, or another one.
#[test]
fn no_parameter_outside_is_asked_for() {
    type Curve = fn(f64) -> [f64; 2];
    let curves: [(Curve, (f64, f64), f64); 5] = [
        (|p| [p.sqrt(), 0.5 / p.sqrt()], (0.0, 2.0), 1.0),
        (|p| [p.sqrt(), 0.5 / p.sqrt()], (1e-9, 2.0), 1.0),
        (|p| [p.ln(), 1.0 / p], (1e-4, 30.0), 0.5),
        (|p| [(1.0 - p).recip(), (1.0 - p).powi(-2)], (-5.0, 0.99), 0.0),
        (|p| [(9.0 * p).sin(), 9.0 * (9.0 * p).cos()], (-0.3, 2e5_f64.recip()), -0.1),
    ];
    for (case, (g, domain, start)) in curves.into_iter().enumerate() {
        // with a sum of odd powers, so that corrections take more than one step
        let problem = Asked::new(|u, p| {
            let [value, slope] = g(p);
            let d = u - value;
            [d + d.powi(3), 1.0 + 3.0 * d * d, -(1.0 + 3.0 * d * d) * slope]
        });
        let branch = both(&problem, g(start)[0], start, domain);
        assert!(problem.inside(domain), "{case}: {:?}", problem.range());
        let reasons = [branch.began.unwrap().reason, branch.stopped.reason];
        let slow = case == 0; // the slope at zero is infinite
        assert!(slow || reasons == [StopReason::Domain; 2], "{case}: {reasons:?}");
        assert!(branch.events.is_empty() && branch.points.len() < 2000, "{case}");
        let ends = [branch.points[0].p, branch.points.last().unwrap().p];
        assert!(slow || ends.contains(&domain.0) && ends.contains(&domain.1));
    }
}

/// Folds a little way before a bound, on it, and behind it.
#[test]
fn folds_near_a_bound() {
    for (case, before) in
        [0.3, 1e-2, 1e-4, 1e-6, 1e-8, 0.0, -1e-8, -1e-4, -0.2].into_iter().enumerate()
    {
        let bound = 1.0 + before;
        let domain = (-0.5, bound);
        // p = 1 − u² − 0.3 u³, the turn at p = 1
        let problem =
            Asked::new(|u: f64, p| [p - 1.0 + u * u + 0.3 * u.powi(3), 2.0 * u + 0.9 * u * u, 1.0]);
        let settings = Settings { domain: Some(domain), ..Settings::default() };
        let settings = Settings { increasing: Some(true), ..settings };
        let branch = Tracer::new(&problem, "p", &[1.0], &[-0.3], settings)
            .unwrap()
            .run(&mut |_| ControlFlow::Continue(()));
        let folds = branch.events.iter().filter(|e| e.kind == EventKind::Fold).count();
        assert_eq!(branch.stopped.reason, StopReason::Domain, "{before:e} {:?}", branch.stopped);
        let end = branch.points.last().unwrap();
        match before {
            b if b > 0.0 => assert!(folds == 1 && end.p == -0.5 && end.u[0] < 0.0, "{before:e}"),
            b if b < 0.0 => assert!(folds == 0 && end.p == bound && end.u[0] > 0.0, "{before:e}"),
            _ => assert!(folds == 1, "{before:e}"),
        }
        // differences for the fold's curvature reach a little beyond it
        let reach = if folds == 1 { 0.02 } else { 0.0 };
        assert!(problem.inside((domain.0, domain.1 + reach)), "{case} {:?}", problem.range());
    }
}

/// A pitchfork at p = 1, and branches that leave through both bounds: only its normal form may look
/// beyond them.
#[test]
fn diagrams_stay_inside() {
    let problem = Asked::new(|u: f64, p| [(p - 1.0) * u - u.powi(3), p - 1.0 - 3.0 * u * u, u]);
    let domain = (0.2, 1.7);
    let trace = Settings { domain: Some(domain), ..Settings::default() };
    let settings = DiagramSettings { trace, ..DiagramSettings::default() };
    let diagram = Explorer::new(&problem, "p", &[0.0], &[0.5], settings, &[])
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()))
        .unwrap();
    assert_eq!(diagram.branches.len(), 3);
    let points = diagram.branches.iter().flat_map(|b| &b.branch.points);
    assert!(points.clone().count() > 30 && points.clone().all(|x| (0.2..=1.7).contains(&x.p)));
    for branch in &diagram.branches[1..] {
        problem.forget();
        let end = branch.branch.points.last().unwrap();
        let settings = Settings { domain: Some(domain), ..Settings::default() };
        let settings = Settings { increasing: Some(end.p < 1.0), ..settings };
        Tracer::new(&problem, "p", &[end.u[0] * 0.9], &[1.0 + 0.81 * (end.p - 1.0)], settings)
            .unwrap()
            .take(3)
            .count();
        assert!(problem.inside(domain), "{:?}", problem.range());
    }
}
