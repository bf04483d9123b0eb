//! Residual, Jacobian, factors and modes of the contact problem: `cargo bench -p arclen-shell`.

use continuation::{Matrix, Problem};
use criterion::{Criterion, criterion_group, criterion_main};
use shell_contact::contact::parameter::Z0;
use shell_contact::modes::AsymmetricModes;
use shell_contact::two_plates::{TwoPlatesGroups, TwoPlatesProblem};
use shell_contact::{ContactProblem, Dimensionless, Law, Mesh, Shell};
use std::hint::black_box;

fn problem(elements: usize, law: Law) -> Option<ContactProblem> {
    let groups = Dimensionless {
        bending: 3e-5,
        pressure: 3e-3,
        adhesion: 2e-3,
        film: 1.0 / 30.0,
        surface_tension: 0.0,
        gas_exponent: 1.07,
    };
    ContactProblem::new(&Shell { law, poisson: 0.5 }, &groups, Mesh::uniform(elements).ok()?).ok()
}

fn assembly(c: &mut Criterion) {
    if let Some(half) = problem(400, Law::Hooke) {
        let groups = TwoPlatesGroups::equal(half.groups());
        if let Ok(whole) = TwoPlatesProblem::new(half.shell(), &groups, half.mesh().clone()) {
            let (u, p) = (whole.initial_state(), whole.parameters_at(1.03));
            let mut r = vec![0.0; whole.dim()];
            let mut j = whole.new_jacobian();
            c.bench_function("linearise/two_plates/400", |b| {
                b.iter(|| whole.linearise(black_box(&u), &p, &mut r, &mut j));
            });
        }
    }
    for (name, law) in [("hooke", Law::Hooke), ("mooney_rivlin", Law::MooneyRivlin { b: 1.0 })] {
        for elements in [400, 3200] {
            let Some(problem) = problem(elements, law) else { continue };
            let (u, p) = (problem.initial_state(), problem.parameters_at(1.03));
            let mut r = vec![0.0; problem.dim()];
            let mut j = problem.new_jacobian();
            c.bench_function(&format!("linearise/{name}/{elements}"), |b| {
                b.iter(|| problem.linearise(black_box(&u), &p, &mut r, &mut j));
            });
            if law == Law::Hooke {
                c.bench_function(&format!("residual/{name}/{elements}"), |b| {
                    b.iter(|| problem.residual(black_box(&u), &p, &mut r));
                });
                c.bench_function(&format!("by_z0/{name}/{elements}"), |b| {
                    b.iter(|| problem.parameter_derivative(black_box(&u), &p, Z0, &mut r));
                });
                c.bench_function(&format!("factor/{name}/{elements}"), |b| {
                    b.iter(|| j.factor(1e-30));
                });
                c.bench_function(&format!("solve/{name}/{elements}"), |b| {
                    b.iter(|| {
                        r.fill(1.0);
                        j.solve(black_box(&mut r));
                    });
                });
                let mut modes = AsymmetricModes::new(problem.mesh());
                c.bench_function(&format!("modes/{name}/{elements}"), |b| {
                    b.iter(|| modes.assemble(&problem, black_box(&u), &p));
                });
                c.bench_function(&format!("scan/{name}/{elements}"), |b| {
                    b.iter(|| modes.scan(black_box(6)));
                });
                c.bench_function(&format!("observe/{name}/{elements}"), |b| {
                    b.iter(|| problem.observation(black_box(&u), &p));
                });
                c.bench_function(&format!("admissible/{name}/{elements}"), |b| {
                    b.iter(|| problem.admissible(black_box(&u), &p));
                });
            }
        }
    }
}

criterion_group!(benches, assembly);
criterion_main!(benches);
