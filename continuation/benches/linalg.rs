//! Band and bordered solves at the sizes of a shell: `cargo bench -p arclen-continuation --bench linalg`.
//!
//! Half-bandwidth 7, microseconds on one core of a shared machine, without / with rank-one term:
//!
//! |                 | n = 800 | n = 1600 |
//! |-----------------|---------|----------|
//! | factor          | 17 / 35 | 40 / 53  |
//! | solve           | 19 / 21 | 39 / 46  |
//! | bordered factor | 60 / 89 | 129 / 190 |
//! | bordered solve  | 27 / 32 | 60 / 60  |
//!
//! Five lowest eigenvalues of an arch of 800 unknowns, factored already, copies searched for:
//! 580 from a random vector (25 solves), 500 from the eigenvectors at a neighbouring load (22).
//! Six eigenvalues of a Brusselator of 800 unknowns: 2800 about zero, 6100 about 2i with the
//! factorisation. Five-point convection and diffusion, 10000 unknowns: 27000 for the first
//! factorisation, 7500 for a later one, 380 for a solve.
#![allow(missing_docs, reason = "criterion's macros generate undocumented functions")]

use std::hint::black_box;

use continuation::linalg::{Arnoldi, Band, Bordered, Lanczos, Matrix, Sparse, SymmetricBand};
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};

#[path = "../tests/linalg/arch.rs"]
mod arch;

const KD: usize = 7;

/// A diagonally dominant band with decaying diagonals.
fn sample(n: usize, rank_one: bool) -> SymmetricBand {
    let mut a = SymmetricBand::new(n, KD);
    for j in 0..n {
        for (k, entry) in a.column_mut(j).iter_mut().enumerate() {
            let wave = ((3 * j + 5 * k) as f64).sin();
            *entry = if k == 0 { 6.0 + wave } else { wave / k as f64 };
        }
    }
    if rank_one {
        let v: Vec<f64> = (0..n).map(|i| (0.01 * i as f64).cos()).collect();
        a.set_rank_one(0.3, &v);
    }
    a
}

fn symmetric_band(c: &mut Criterion) {
    for n in [800, 1600] {
        for rank_one in [false, true] {
            let name = format!("n={n} kd={KD}{}", if rank_one { " rank-one" } else { "" });
            let mut a = sample(n, rank_one);
            let b: Vec<f64> = (0..n).map(|i| (0.1 * i as f64).sin()).collect();
            let mut x = b.clone();
            let floor = f64::EPSILON * a.norm();
            c.bench_function(&format!("factor {name}"), |t| t.iter(|| black_box(a.factor(floor))));
            c.bench_function(&format!("solve {name}"), |t| {
                t.iter(|| {
                    x.copy_from_slice(&b);
                    a.solve(black_box(&mut x));
                });
            });
            c.bench_function(&format!("mul {name}"), |t| t.iter(|| a.mul(black_box(&b), &mut x)));
            let mut s = Bordered::new(n, 1);
            s.column_mut(0).copy_from_slice(&b);
            s.row_mut(0).copy_from_slice(&b);
            s.set_corner(0, 0, 0.5);
            c.bench_function(&format!("bordered factor {name}"), |t| {
                t.iter(|| black_box(s.factor(&mut a)));
            });
            c.bench_function(&format!("bordered solve {name}"), |t| {
                t.iter(|| {
                    x.copy_from_slice(&b);
                    s.solve(&mut a, black_box(&mut x), &mut [1.0]);
                });
            });
        }
    }
}

/// The five lowest eigenvalues of an arch of 800 unknowns, its matrix factored already; from a
/// random vector and from the eigenvectors at a neighbouring load.
fn lowest_eigenvalues(c: &mut Criterion) {
    let (mut a, m) = arch::arch(201, 0.02);
    let below = a.factor(f64::EPSILON * a.norm()).inertia.map(|(negative, _)| negative);
    let mut lanczos = Lanczos::new(800, 5);
    let mut run = |name: &str, a: &mut SymmetricBand, start: Option<&[f64]>| {
        c.bench_function(name, |t| {
            t.iter(|| lanczos.lowest(0.0, below, |x, y| m.mul(x, y), |x| a.solve(x), start));
        });
        let mut blend = vec![0.0; 800];
        lanczos.blend(&mut blend);
        blend
    };
    let (mut before, _) = arch::arch(201, 0.0199);
    before.factor(f64::EPSILON * before.norm());
    let start = run("five lowest n=800 before", &mut before, None);
    run("five lowest n=800", &mut a, None);
    run("five lowest n=800 started", &mut a, Some(&start));
}

/// The six eigenvalues of a Brusselator of 800 unknowns nearest to zero and to its frequency.
fn nearest_eigenvalues(c: &mut Criterion) {
    let (cells, b) = (400, 5.118);
    let h = 1.0 / (f64::from(cells) + 1.0);
    let mut a = Band::new(2 * cells as usize, 2, 2);
    for i in 0..2 * cells as usize {
        let diffusion = if i % 2 == 0 { 0.008 } else { 0.004 } / (h * h);
        let reaction = [[b - 1.0, 4.0], [-b, -4.0]][i % 2];
        a.add(i, i, reaction[i % 2] - 2.0 * diffusion);
        a.add(i, i ^ 1, reaction[1 - i % 2]);
        if i > 1 {
            a.add(i, i - 2, diffusion);
            a.add(i - 2, i, diffusion);
        }
    }
    let solver = Arnoldi::new(a.dim(), 6);
    let mut factored = a.clone();
    factored.factor(f64::EPSILON * a.norm());
    let identity = |x: &[f64], y: &mut [f64]| y.copy_from_slice(x);
    c.bench_function("six nearest to zero n=800", |t| {
        t.iter(|| solver.nearest(0.0, identity, |x| factored.solve(x), None));
    });
    c.bench_function("six nearest to 2i n=800", |t| {
        t.iter(|| solver.nearest_to_imaginary(&a, None, 2.0));
    });
}

/// A Laplacian with a little convection on a square of 100 by 100 cells.
fn sparse(c: &mut Criterion) {
    let side = 100;
    let n = side * side;
    let entry = |i: usize, j: usize| ((i, j), -1.0 - 0.1 * f64::from(u8::from(i > j)));
    let mut entries = Vec::new();
    for i in 0..n {
        if i % side > 0 {
            entries.extend([entry(i, i - 1), entry(i - 1, i)]);
        }
        if i >= side {
            entries.extend([entry(i, i - side), entry(i - side, i)]);
        }
    }
    let pattern: Vec<_> = entries.iter().map(|(at, _)| *at).collect();
    let Ok(mut a) = Sparse::new(n, &pattern) else { return };
    for ((i, j), value) in entries {
        if let Some(at) = a.position(i, j) {
            a.values_mut()[at] = value;
        }
    }
    a.add_identity(4.3);
    let floor = f64::EPSILON * a.norm();
    c.bench_function("sparse first factor n=10000", |t| {
        t.iter_batched(|| a.clone(), |mut a| a.factor(floor), BatchSize::LargeInput);
    });
    a.factor(floor);
    c.bench_function("sparse factor n=10000", |t| t.iter(|| black_box(a.factor(floor))));
    let mut x = vec![1.0; n];
    c.bench_function("sparse solve n=10000", |t| t.iter(|| a.solve(black_box(&mut x))));
}

criterion_group!(benches, symmetric_band, sparse, lowest_eigenvalues, nearest_eigenvalues);
criterion_main!(benches);
