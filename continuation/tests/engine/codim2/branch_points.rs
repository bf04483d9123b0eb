//! Curves of branch points that persist, and of one that does not.

use super::trace;
use crate::random::Random;
use continuation::codim2::{BranchPointCurve, Curve};
use continuation::linalg::{Band, Matrix};
use continuation::{
    DenseProblem, EvalError, EventKind, ParamId, Parameter, Problem, Settings, StopReason,
};
use std::f64::consts::PI;
use std::ops::ControlFlow;

fn follow(curve: &BranchPointCurve<'_>, domain: (f64, f64)) -> Curve {
    let settings = Settings { domain: Some(domain), ..Settings::default() };
    curve.trace(&settings, &[], &mut |_| ControlFlow::Continue(())).unwrap()
}

/// A column on an elastic foundation, `w⁗ + λw″ + kw + w³ = 0`, simply supported, by finite
/// differences: `A²w − λAw + kw + w³` with `A = tridiag(−1, 2, −1)/h²`.
struct Column {
    n: usize,
}

impl Column {
    fn h2(&self) -> f64 {
        (self.n as f64 + 1.0).powi(-2)
    }
    fn second(&self, w: &[f64], i: usize) -> f64 {
        let at = |k: usize| if k == 0 || k > self.n { 0.0 } else { w[k - 1] };
        (2.0 * at(i + 1) - at(i) - at(i + 2)) / self.h2()
    }
}

impl Problem for Column {
    type Jacobian = Band;
    fn dim(&self) -> usize {
        self.n
    }
    fn parameters(&self) -> &[Parameter] {
        const { &[Parameter::new("load", "", 10.0), Parameter::new("foundation", "", 100.0)] }
    }
    fn new_jacobian(&self) -> Band {
        Band::new(self.n, 2, 2)
    }
    fn residual(&self, w: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let aw: Vec<f64> = (0..self.n).map(|i| self.second(w, i)).collect();
        for i in 0..self.n {
            r[i] = self.second(&aw, i) - p[0] * aw[i] + p[1] * w[i] + w[i].powi(3);
        }
        Ok(())
    }
    fn jacobian(&self, w: &[f64], p: &[f64], j: &mut Band) -> Result<(), EvalError> {
        j.set_zero();
        let (a, n) = (1.0 / self.h2(), self.n);
        for i in 0..n {
            let ends = f64::from(u8::from(i == 0)) + f64::from(u8::from(i + 1 == n));
            let middle = (6.0 - ends) * a * a - 2.0 * p[0] * a + p[1] + 3.0 * w[i] * w[i];
            j.set(i, i, middle);
            for (k, value) in [(1, -4.0 * a * a + p[0] * a), (2, a * a)] {
                if i + k < n {
                    j.set(i, i + k, value);
                    j.set(i + k, i, value);
                }
            }
        }
        Ok(())
    }
    fn parameter_derivative(
        &self,
        w: &[f64],
        _: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        for i in 0..self.n {
            out[i] = if which.0 == 0 { -self.second(w, i) } else { w[i] };
        }
        Ok(())
    }
    fn metric(&self, x: &[f64], y: &mut [f64]) {
        y.iter_mut().zip(x).for_each(|(y, x)| *y = self.h2().sqrt() * x);
    }
}

#[test]
fn buckling_of_a_column_on_an_elastic_foundation() {
    for n in [30, 60, 120] {
        let column = Column { n };
        let branch = trace(&column, "load", &vec![0.0; n], &[8.0, 0.0], 12.0);
        let event = branch.events_of(&EventKind::BranchPoint).next().unwrap();
        let curve = BranchPointCurve::at(&column, &branch, event, "foundation").unwrap();
        let found = follow(&curve, (-50.0, 300.0));
        let mu = 4.0 / column.h2() * (0.5 * PI * column.h2().sqrt()).sin().powi(2);
        let (load, beta) = (found.column("load").unwrap(), found.column("beta").unwrap());
        println!(
            "{n}: {} points {:?} {:?} {:?}",
            load.len(),
            found.branch.statistics,
            found.first_end,
            found.branch.stopped
        );
        let mut worst = 0.0_f64;
        for (point, (load, beta)) in found.branch.points.iter().zip(load.iter().zip(&beta)) {
            worst = worst.max((load - (mu + point.p / mu)).abs());
            assert!(beta.abs() < 1e-12);
        }
        println!("worst {worst:e}");
        // about ε |f_u| over what the load does to the mode
        assert!(worst < 1e-10 * f64::from(n as u16).powi(4) / 30f64.powi(4) * 10.0);
        let ends = (found.first_end.reason, found.branch.stopped.reason);
        assert_eq!(ends, (StopReason::Domain, StopReason::Domain));
    }
}

/// AUTO's `enz` with the rate `q`: on the symmetric branch `3 + q R'(s) = 0`, `p = s + q R(s)`.
pub(crate) fn enz(s: &[f64], p: &[f64], r: &mut [f64]) {
    let rate = |s: f64| p[1] * s / (1.0 + s + s * s);
    r[0] = p[0] - 2.0 * s[0] + s[1] - rate(s[0]);
    r[1] = p[0] - 2.0 * s[1] + s[0] - rate(s[1]);
}

#[test]
fn symmetry_breaking_on_a_branch_that_moves() {
    let problem = || DenseProblem::from_residual(2, &["p", "q"], enz).boxed();
    // the least q: s^3 = 3 s + 1
    let s = 2.0 * (PI / 9.0).cos();
    let meet = 3.0 * (1.0 + s + s * s).powi(2) / (s * s - 1.0);
    let branch = trace(&problem(), "p", &[0.0, 0.0], &[0.0, 100.0], 40.0);
    let events: Vec<_> = branch.events_of(&EventKind::BranchPoint).collect();
    assert_eq!(events.len(), 2);
    for event in events {
        let problem = problem();
        let curve = BranchPointCurve::at(&problem, &branch, event, "q").unwrap();
        let found = follow(&curve, (20.0, 200.0));
        let (p, beta) = (found.column("p").unwrap(), found.column("beta").unwrap());
        println!("{} points, {:?} {:?}", p.len(), found.first_end, found.branch.stopped);
        for (point, (p, beta)) in found.branch.points.iter().zip(p.iter().zip(&beta)) {
            let (s, q) = (point.u[0], point.p);
            let d = 1.0 + s + s * s;
            // the part that breaks the symmetry divides by the speed of the eigenvalue along the branch,
            // which vanishes like the root of the distance to where two such points meet; `q` is known
            // to 1e-10 there
            let off = (point.u[1] - s).abs() * (q - meet).abs().max(1e-10).sqrt();
            assert!(off < 1e-11 && beta.abs() < 1e-10, "{q}: {off:e} {beta:e}");
            assert!((3.0 + q * (1.0 - s * s) / (d * d)).abs() < 1e-8);
            assert!((p - (s + q * s / d)).abs() < 1e-8);
        }
        assert!(p.len() > 20);
        // where they meet, the symmetric branch only touches: the curve ends there, or goes on through
        let points = &found.branch.points;
        let least = points.iter().fold(f64::INFINITY, |q, point| q.min(point.p));
        assert!((least - meet).abs() < 0.1 && points[points.len() - 1].p == 200.0);
        assert_eq!(found.branch.stopped.reason, StopReason::Domain);
        let through = found.first_end.reason == StopReason::Domain && points[0].p == 200.0;
        assert!(through || found.first_end.detail.contains("meet there"), "{:?}", found.first_end);
    }
}

/// The two curves of `enz` end where they meet, or go on through, wherever they begin: what Newton's
/// method tries beyond the place does not turn the orientation of what comes after.
#[test]
fn curves_that_meet_do_so_from_every_start() {
    let s = 2.0 * (PI / 9.0).cos();
    let meet = 3.0 * (1.0 + s + s * s).powi(2) / (s * s - 1.0);
    let mut random = Random(7);
    for _ in 0..16 {
        let q = random.between(60.0, 150.0);
        let problem = DenseProblem::from_residual(2, &["p", "q"], enz).boxed();
        let branch = trace(&problem, "p", &[0.0, 0.0], &[0.0, q], 60.0);
        let events: Vec<_> = branch.events_of(&EventKind::BranchPoint).collect();
        assert_eq!(events.len(), 2, "{q}");
        for event in events {
            let curve = BranchPointCurve::at(&problem, &branch, event, "q").unwrap();
            let found = follow(&curve, (20.0, 200.0));
            let points = &found.branch.points;
            let least = points.iter().fold(f64::INFINITY, |q, point| q.min(point.p));
            assert!((least - meet).abs() < 0.1, "{q}: {least}");
            assert_eq!(found.branch.stopped.reason, StopReason::Domain, "{q}");
            let through = found.first_end.reason == StopReason::Domain && points[0].p == 200.0;
            let meets = found.first_end.detail.contains("meet there");
            assert!(through || meets, "{q}: {:?}", found.first_end);
        }
    }
}

#[test]
fn an_imperfection_ends_the_curve_with_a_reason() {
    let problem = DenseProblem::from_residual(1, &["p", "e"], |x, p, r| {
        r[0] = p[0] * x[0] - x[0].powi(3) + p[1];
    })
    .boxed();
    let branch = trace(&problem, "p", &[0.0], &[-1.0, 0.0], 1.0);
    let event = branch.events_of(&EventKind::BranchPoint).next().unwrap();
    let curve = BranchPointCurve::at(&problem, &branch, event, "e").unwrap();
    let found = follow(&curve, (-1.0, 1.0));
    println!("{:?} {:?}", found.first_end, found.branch.stopped);
    for end in [&found.first_end, &found.branch.stopped] {
        assert!(end.detail.contains("does not persist"), "{end:?}");
    }
    assert!(found.branch.points.last().unwrap().p < 1e-4);
    assert!(found.branch.events.is_empty());
}
