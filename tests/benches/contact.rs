//! The budgets of the main job; recorded in `RESULTS.md` beside this file.
//!
//! `cargo bench -p arclen-tests --bench contact`

#![allow(missing_docs)]

use continuation::linalg::Bordered;
use continuation::{ParamId, Problem, Settings};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use shell_contact::{ContactProblem, Dimensionless, Law, Mesh, Shell, trace_contact};
use std::ops::ControlFlow;

fn problem(adhesion: f64, mesh: Mesh) -> ContactProblem {
    let groups = Dimensionless {
        bending: (25.0_f64 / 1500.0).powi(2) / 9.0,
        pressure: 2.895e-3,
        adhesion,
        film: 1.0 / 30.0,
        surface_tension: 0.0,
        gas_exponent: 1.07,
    };
    let shell = Shell { law: Law::Hooke, poisson: 0.5 };
    ContactProblem::new(&shell, &groups, mesh).unwrap()
}

/// Assembly, factorisation and bordered solve of one Newton iteration.
fn newton_iteration(c: &mut Criterion) {
    let mut group = c.benchmark_group("newton_iteration");
    for elements in [400_usize, 800, 1600, 3200] {
        let problem = problem(2e-3, Mesh::uniform(elements).unwrap());
        let n = problem.dim();
        let (u, p) = (problem.initial_state(), problem.parameters_at(1.1));
        let mut jacobian = problem.new_jacobian();
        let mut bordered = Bordered::new(n, 1);
        let (mut r, mut m) = (vec![0.0; n], vec![1.0; n]);
        problem.metric(&r, &mut m);
        group.throughput(Throughput::Elements(elements as u64));
        group.bench_function(BenchmarkId::from_parameter(elements), |b| {
            b.iter(|| {
                problem.linearise(&u, &p, &mut r, &mut jacobian).unwrap();
                problem.parameter_derivative(&u, &p, ParamId(0), bordered.column_mut(0)).unwrap();
                bordered.row_mut(0).copy_from_slice(&m);
                bordered.set_corner(0, 0, 1.0);
                bordered.factor(&mut jacobian);
                let mut g = [0.5];
                bordered.solve(&mut jacobian, &mut r, &mut g);
                g[0]
            });
        });
    }
}

fn trace(problem: &ContactProblem, start: f64, end: f64) -> usize {
    let settings = Settings { target: Some(end), ..Settings::default() };
    let traced = trace_contact(problem, start, settings, &mut |_| ControlFlow::Continue(()));
    traced.unwrap().branch.points.len()
}

fn branches(c: &mut Criterion) {
    let mut group = c.benchmark_group("branch");
    group.sample_size(10);
    let strong = problem(2e-3, Mesh::uniform(400).unwrap());
    group.bench_function("strong adhesion, 400 elements", |b| {
        b.iter(|| trace(&strong, 1.15, 0.65));
    });
    let weak = problem(1e-4 / 52.5, Mesh::uniform(400).unwrap());
    group.bench_function("weak adhesion, 400 elements", |b| b.iter(|| trace(&weak, 1.3, 0.83)));
    let graded = problem(1e-4 / 52.5, Mesh::graded(150, 4.0).unwrap());
    group.bench_function("weak adhesion, 150 graded elements", |b| {
        b.iter(|| trace(&graded, 1.3, 0.83));
    });
}

criterion_group!(benches, newton_iteration, branches);
criterion_main!(benches);
