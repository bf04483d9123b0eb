//! An iteration of Newton's method for a cycle does not allocate once it has been done.

use continuation::cycles::{Cycle, CycleProblem, CycleSettings};
use continuation::linalg::Bordered;
use continuation::{ParamId, Problem};
use problems::brusselator::Brusselator;
use problems::lorenz::Lorenz;
use problems::ode::Ode;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Everything that a corrected step does: equations, Jacobian, borders, factors, solves, lengths.
fn iterate<P: Problem>(what: &str, problem: &P, cycle: &Cycle) {
    let equations = CycleProblem::new(problem, cycle).unwrap();
    let n = equations.dim();
    let mut x = equations.unknowns(cycle);
    let mut matrix = equations.new_jacobian();
    let mut solver = Bordered::new(n, 1);
    let (mut r, mut y, mut end) = (vec![0.0; n], vec![0.0; n], [0.0]);
    let mut iteration = || {
        equations.residual(&x, &cycle.parameters, &mut r).unwrap();
        equations.jacobian(&x, &cycle.parameters, &mut matrix).unwrap();
        let column = solver.column_mut(0);
        equations.parameter_derivative(&x, &cycle.parameters, ParamId(0), column).unwrap();
        equations.metric(&x, solver.row_mut(0));
        solver.factor(&mut matrix);
        solver.solve(&mut matrix, &mut r, &mut end);
        equations.metric(&r, &mut y);
        x.iter_mut().zip(&r).for_each(|(x, r)| *x -= 1e-3 * r);
    };
    iteration();
    // the test runner's own thread is counted too, and may allocate once at any moment
    let counts = [(); 5].map(|()| {
        let region = Region::new(ALLOCATOR);
        (0..3).for_each(|_| iteration());
        let change = region.change();
        change.allocations + change.reallocations
    });
    assert!(counts.contains(&0), "{what}: {counts:?}");
}

// one test: others would be counted too
#[test]
fn newtons_method_for_cycles_does_not_allocate() {
    for (degree, intervals) in [(4, 30), (3, 12), (7, 9)] {
        let settings = CycleSettings { degree, intervals, ..CycleSettings::default() };
        let problem = Ode(Brusselator);
        let guess = |t: f64, u: &mut [f64]| {
            (u[0], u[1]) = (1.0 + 0.5 * t.cos(), 2.1 - 0.5 * (t - 0.8).cos());
        };
        let cycle = Cycle::near(&problem, &[2.2, 1.0], 6.3, guess, &settings).unwrap();
        iterate("brusselator", &problem, &cycle);
        // any orbit serves for counting
        let nodes = (cycle.mesh.len() - 1) * degree;
        let values = (0..3 * nodes).map(|i| (i as f64 * 0.37).sin() * 5.0 + 9.0).collect();
        let parameters = vec![20.0, 10.0, 8.0 / 3.0];
        let orbit = Cycle { values, parameters, ..cycle };
        iterate("lorenz", &Ode(Lorenz), &orbit);
    }
}
