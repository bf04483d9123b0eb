//! Matrices and eigenvalue solvers do not allocate once they have been used.

use continuation::linalg::{Arrow, Band, Bordered, Lanczos, Matrix, Sparse, SymmetricBand};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

fn count(what: &str, mut action: impl FnMut()) {
    action();
    // the test runner's own thread is counted too, and may allocate once at any moment
    let counts = [(); 5].map(|()| {
        let region = Region::new(ALLOCATOR);
        action();
        let change = region.change();
        change.allocations + change.reallocations
    });
    assert!(counts.contains(&0), "{what}: {counts:?}");
}

// one test: others would be counted too
#[test]
fn later_factorisations_and_eigenvalues_do_not_allocate() {
    let n = 144;
    let entries: Vec<_> = (0..n)
        .flat_map(|i| [(i, i + 1), (i + 1, i), (i, i + 12), (i + 12, i)])
        .filter(|(i, j)| *i < n && *j < n)
        .collect();
    let mut sparse = Sparse::new(n, &entries).unwrap();
    let mut band = Band::new(n, 1, 1);
    let mut symmetric = SymmetricBand::new(n, 1);
    for i in 0..n {
        sparse.set(i, i, 4.0).unwrap();
        band.set(i, i, 3.0);
        symmetric.add(i, i, 2.0 + 0.01 * i as f64);
        if i > 0 {
            symmetric.add(i, i - 1, -1.0);
            band.set(i, i - 1, 1.0);
        }
    }
    for &(i, j) in &entries {
        sparse.set(i, j, -0.9).unwrap();
    }

    let mut solver = Bordered::new(n, 2);
    (0..2).for_each(|k| solver.column_mut(k)[k] = 1.0);
    (0..2).for_each(|k| solver.row_mut(k)[k] = 1.0);
    let (mut f, mut g) = (vec![1.0; n], [1.0, 2.0]);
    count("sparse", || {
        solver.factor(&mut sparse);
        solver.solve(&mut sparse, &mut f, &mut g);
        solver.solve_transpose(&mut sparse, &mut f, &mut g);
    });

    let mut arrow = Arrow::new(band, 1);
    arrow.column_mut(0).fill(1.0);
    arrow.row_mut(0).fill(1.0);
    let mut solver = Bordered::new(n + 1, 1);
    solver.column_mut(0)[n] = 1.0;
    solver.row_mut(0)[n] = 1.0;
    let (mut f, mut g) = (vec![1.0; n + 1], [1.0]);
    count("arrow", || {
        solver.factor(&mut arrow);
        solver.solve(&mut arrow, &mut f, &mut g);
    });

    let below = symmetric.factor(1e-16).inertia.map(|(negative, _)| negative);
    let mut lanczos = Lanczos::new(n, 5);
    let mut start = vec![0.0; n];
    count("lanczos", || {
        let mass = |x: &[f64], y: &mut [f64]| y.copy_from_slice(x);
        assert!(lanczos.lowest(0.0, below, mass, |x| symmetric.solve(x), None).complete);
        lanczos.blend(&mut start);
        assert!(lanczos.nearest(0.0, mass, |x| symmetric.solve(x), Some(&start)).complete);
    });
}
