//! Which eigenvalues of `f_u x = λ M x` are infinite follows from ranks, whatever the units.

#![allow(clippy::unwrap_used)]

use continuation::linalg::Dense;
use continuation::{
    Branch, EvalError, EventKind, Matrix, ParamId, Parameter, Problem, Settings, Stability,
    StopReason, Tracer,
};
use std::ops::ControlFlow;

static PARAMETERS: [Parameter; 1] = [Parameter::new("p", "", 1.0)];

/// `x' = p − z`, `ε z' = x − z³/3 + z`; units of both unknowns and both equations.
struct Relaxation {
    epsilon: f64,
    units: [f64; 4],
}

impl Problem for Relaxation {
    type Jacobian = Dense;
    fn dim(&self) -> usize {
        2
    }
    fn parameters(&self) -> &[Parameter] {
        &PARAMETERS
    }
    fn new_jacobian(&self) -> Dense {
        Dense::new(2)
    }
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        let [a, b, e, f] = self.units;
        let (x, z) = (u[0] / a, u[1] / b);
        r[0] = e * (p[0] - z);
        r[1] = f * (x - z.powi(3) / 3.0 + z);
        Ok(())
    }
    fn jacobian(&self, u: &[f64], _p: &[f64], j: &mut Dense) -> Result<(), EvalError> {
        let [a, b, e, f] = self.units;
        let z = u[1] / b;
        j.set_zero();
        j.set(0, 1, -e / b);
        j.set(1, 0, f / a);
        j.set(1, 1, f / b * (1.0 - z * z));
        Ok(())
    }
    fn parameter_derivative(
        &self,
        _u: &[f64],
        _p: &[f64],
        _which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        out.copy_from_slice(&[self.units[2], 0.0]);
        Ok(())
    }
    fn stability(&self) -> Stability {
        Stability::Dynamics
    }
    fn mass(&self, m: &mut Dense) -> bool {
        let [a, b, e, f] = self.units;
        m.set(0, 0, e / a);
        m.set(1, 1, self.epsilon * f / b);
        true
    }
}

fn follow(problem: &Relaxation) -> Branch {
    let z: f64 = -2.0;
    let start = [problem.units[0] * (z.powi(3) / 3.0 - z), problem.units[1] * z];
    let settings = Settings { target: Some(2.1), ..Settings::default() };
    Tracer::new(problem, "p", &start, &[z], settings)
        .unwrap()
        .run(&mut |_| ControlFlow::Continue(()))
}

#[test]
fn small_masses_keep_their_hopf_points() {
    for epsilon in [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
        let branch = follow(&Relaxation { epsilon, units: [1.0; 4] });
        assert_eq!(branch.stopped.reason, StopReason::Target, "{epsilon:e} {:?}", branch.stopped);
        let kinds: Vec<_> = branch.events.iter().map(|e| (e.kind.to_string(), e.p)).collect();
        assert!(branch.events.iter().all(|e| e.kind == EventKind::Hopf), "{epsilon:e} {kinds:?}");
        let hopf: Vec<_> = branch.events.iter().collect();
        assert_eq!(hopf.len(), 2, "{epsilon:e} {kinds:?}");
        for (event, p) in hopf.iter().zip([-1.0, 1.0]) {
            assert!((event.p - p).abs() < 1e-9, "{epsilon:e}: {}", event.p);
            match event.hopf().map(|form| form.frequency) {
                Some(omega) => assert!((omega * epsilon.sqrt() - 1.0).abs() < 1e-6, "{omega}"),
                None => eprintln!("{epsilon:e}: no normal form"),
            }
        }
        for point in branch.points.iter().filter(|x| x.event.is_none()) {
            let exact = if point.p.abs() < 1.0 { 2 } else { 0 };
            assert_eq!((point.unstable, point.certified), (Some(exact), true), "{epsilon:e}");
        }
    }
}

#[test]
fn units_do_not_make_eigenvalues_infinite() {
    for units in [[1e9, 1.0, 1.0, 1.0], [1.0, 1e-6, 1e5, 1e-3], [1.0, 1.0, 1e-4, 1e4]] {
        let branch = follow(&Relaxation { epsilon: 1e-4, units });
        let hopf: Vec<f64> = branch.events_of(&EventKind::Hopf).map(|e| e.p).collect();
        assert_eq!(hopf.len(), 2, "{units:?} {:?}", branch.events);
        assert!((hopf[0] + 1.0).abs() < 1e-8 && (hopf[1] - 1.0).abs() < 1e-8, "{hopf:?}");
    }
}

#[test]
fn an_eigenvalue_through_infinity_is_no_branch_point() {
    let branch = follow(&Relaxation { epsilon: 0.0, units: [1.0; 4] });
    assert_eq!(branch.stopped.reason, StopReason::Target, "{:?}", branch.stopped);
    let found: Vec<f64> = branch.events_of(&EventKind::SingularityInduced).map(|e| e.p).collect();
    assert_eq!((found.len(), branch.events.len()), (2, 2), "{:?}", branch.events);
    assert!((found[0] + 1.0).abs() < 1e-9 && (found[1] - 1.0).abs() < 1e-9, "{found:?}");
    for point in branch.points.iter().filter(|x| x.event.is_none()) {
        let exact = usize::from(point.p.abs() < 1.0);
        assert_eq!((point.unstable, point.certified), (Some(exact), true), "{}", point.p);
    }
}

fn dense(n: usize, entries: &[(usize, usize, f64)]) -> Dense {
    let mut a = Dense::new(n);
    entries.iter().for_each(|&(i, j, v)| a.set(i, j, v));
    a
}

fn real(a: &Dense, m: &Dense) -> Vec<f64> {
    let mut values: Vec<f64> = a.spectrum(Some(m)).unwrap().iter().map(|z| z.0).collect();
    values.sort_by(f64::total_cmp);
    values
}

#[test]
fn masses_of_different_units() {
    let a = dense(2, &[(0, 0, -1.0), (1, 1, 1.0)]);
    for big in [1e4, 1e8, 1e12] {
        let values = real(&a, &dense(2, &[(0, 0, big), (1, 1, 1.0)]));
        assert_eq!(values.len(), 2);
        assert!((values[0] * big + 1.0).abs() < 1e-3 && (values[1] - 1.0).abs() < 1e-12);
        // the same, not symmetric
        let skew = dense(2, &[(0, 0, -1.0), (0, 1, 0.5), (1, 1, 1.0)]);
        let values = real(&skew, &dense(2, &[(0, 0, big), (1, 1, 1.0)]));
        assert!((values[0] * big + 1.0).abs() < 1e-3 && (values[1] - 1.0).abs() < 1e-12);
    }
}

/// Random systems `x' = A x + B y + …`, with constraints of index one, two and three, hidden by random
/// row operations and unknowns.
#[test]
fn indices_one_to_three() {
    let mut seed = 12345_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    for case in 0..60 {
        // a chain x1' = x2, … whose first is given takes away as many finite eigenvalues as it is long
        let index = 1 + case % 3;
        let (slow, n) = (4, 4 + index);
        let (mut a, mut m) = (Dense::new(n), Dense::new(n));
        let mut expected = Vec::new();
        for i in 0..slow {
            let value = (i as f64 + 1.0) * if i % 2 == 0 { -1.0 } else { 1.0 };
            expected.push(value);
            a.set(i, i, value);
            m.set(i, i, 1.0);
        }
        for i in 0..index {
            a.set(slow + i, slow + i, 1.0);
            if i + 1 < index {
                m.set(slow + i, slow + i + 1, 1.0);
            }
        }
        let mixed = |x: &Dense, left: &[f64], right: &[f64]| {
            let product = |a: &Dense, b: &Dense| {
                let mut out = Dense::new(n);
                (0..n).for_each(|j| a.mul(b.column(j), out.column_mut(j)));
                out
            };
            let of = |values: &[f64]| {
                let mut out = Dense::new(n);
                for j in 0..n {
                    out.column_mut(j).copy_from_slice(&values[j * n..(j + 1) * n]);
                    out.add(j, j, 3.0);
                }
                out
            };
            product(&product(&of(left), x), &of(right))
        };
        let left: Vec<f64> = (0..n * n).map(|_| random()).collect();
        let right: Vec<f64> = (0..n * n).map(|_| random()).collect();
        let values = mixed(&a, &left, &right).spectrum(Some(&mixed(&m, &left, &right))).unwrap();
        assert_eq!(values.len(), slow, "index {index}: {values:?}");
        let mut found: Vec<f64> = values.iter().map(|z| z.0).collect();
        found.sort_by(f64::total_cmp);
        expected.sort_by(f64::total_cmp);
        for (a, b) in found.iter().zip(&expected) {
            assert!((a - b).abs() < 1e-8, "index {index}: {values:?}");
        }
    }
    // the same constraint twice: singular for every λ
    let a = dense(3, &[(0, 0, 1.0), (1, 0, 1.0), (2, 0, 1.0), (0, 1, 1.0), (0, 2, 1.0)]);
    assert_eq!(a.spectrum(Some(&dense(3, &[(0, 0, 1.0)]))), None);
}
