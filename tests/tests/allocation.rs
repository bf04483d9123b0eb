//! Nothing allocates in Newton's method, in solves and in test functions.

use continuation::linalg::Bordered;
use continuation::{ParamId, Problem, Settings, Tracer, Watch};
use shell_contact::two_plates::{Support, SupportedProblem, TwoPlatesGroups, TwoPlatesProblem};
use shell_contact::{ContactProblem, Dimensionless, Law, Mesh, Shell};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

fn fig12(elements: usize) -> ContactProblem {
    let groups = Dimensionless {
        bending: 3e-5,
        pressure: 3e-3,
        adhesion: 2e-3,
        film: 1.0 / 30.0,
        surface_tension: 0.0,
        gas_exponent: 1.07,
    };
    let shell = Shell { law: Law::Hooke, poisson: 0.5 };
    ContactProblem::new(&shell, &groups, Mesh::uniform(elements).unwrap()).unwrap()
}

fn iterations_do_not_allocate<P: Problem>(problem: &P, u: &[f64], p: &[f64]) {
    let n = problem.dim();
    let mut jacobian = problem.new_jacobian();
    let mut bordered = Bordered::new(n, 1);
    let (mut r, mut m) = (vec![0.0; n], vec![0.0; n]);
    let mut observed = vec![0.0; problem.observables().len()];

    // the test runner's own thread is counted too, and may allocate once at any moment
    let counts = [(); 5].map(|()| {
        let region = Region::new(ALLOCATOR);
        problem.linearise(u, p, &mut r, &mut jacobian).unwrap();
        problem.parameter_derivative(u, p, ParamId(0), bordered.column_mut(0)).unwrap();
        problem.metric(&r, &mut m);
        bordered.row_mut(0).copy_from_slice(&m);
        bordered.set_corner(0, 0, 1.0);
        bordered.factor(&mut jacobian);
        let mut g = [0.5];
        bordered.solve(&mut jacobian, &mut r, &mut g);
        problem.observe(u, p, &mut observed).unwrap();
        problem.observable_slope(0, u, p, ParamId(0), &r, 1.0).unwrap();
        let change = region.change();
        change.allocations + change.reallocations
    });
    assert!(counts.contains(&0), "{counts:?}");
}

// one test: others would be counted too
#[test]
fn the_loop_does_not_allocate() {
    let problem = fig12(200);
    let (u, p) = (problem.initial_state(), problem.parameters_at(1.1));
    iterations_do_not_allocate(&problem, &u, &p);
    let groups = TwoPlatesGroups::equal(problem.groups());
    let mesh = problem.mesh().clone();
    let whole = TwoPlatesProblem::new(problem.shell(), &groups, mesh).unwrap();
    iterations_do_not_allocate(&whole, &whole.initial_state(), &whole.parameters_at(1.1));
    let support = Support { held: true, spring: Some(30.0) };
    let supported = SupportedProblem::new(&whole, support).unwrap();
    let x = supported.state(&whole.initial_state(), 1.1);
    iterations_do_not_allocate(&supported, &x, &supported.parameters_at(1.1));

    // a traced point costs its own storage and nothing per iteration: two vectors, and now and
    // then room for more points, special points and their names
    let settings = Settings { target: Some(0.95), ..Settings::default() };
    let watches = [Watch::zero("force"), Watch::extremum("force")];
    let mut tracer =
        Tracer::new(&problem, "z0", &u, &p, settings).unwrap().watching(&watches).unwrap();
    // the first steps look at the derivatives, once
    let begun = tracer.by_ref().take(6).count();
    let region = Region::new(ALLOCATOR);
    let points = tracer.by_ref().count();
    let change = region.change();
    let iterations = tracer.statistics().newton_iterations;
    let allowed = 2 * points + 12 * (tracer.events().len() + 2);
    assert!(begun == 6 && points > 20 && iterations > 2 * points);
    assert!(
        change.allocations <= allowed,
        "{change:?} for {points} points, {iterations} iterations"
    );
}
