//! Band and bordered solves at the sizes of a shell: `cargo bench -p continuation --bench linalg`.
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
//! 620 from a random vector (25 solves), 510 from the eigenvectors at a neighbouring load (22).
#![allow(missing_docs, reason = "criterion's macros generate undocumented functions")]

use std::hint::black_box;

use continuation::linalg::{Bordered, Lanczos, Matrix, SymmetricBand};
use criterion::{Criterion, criterion_group, criterion_main};

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

criterion_group!(benches, symmetric_band, lowest_eigenvalues);
criterion_main!(benches);
