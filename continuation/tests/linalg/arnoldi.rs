//! Shift-invert Arnoldi against dense spectra and known eigenvalues.

use continuation::linalg::{Arnoldi, Band, Dense, EigenSettings, Eigenpairs, Matrix};
use faer::Mat;
use faer::linalg::solvers::DenseSolveCore;

use crate::support::*;

fn identity(x: &[f64], y: &mut [f64]) {
    y.copy_from_slice(x);
}

fn nearest<A: Matrix>(solver: &Arnoldi, a: &A, mass: Option<&A>, shift: f64) -> Eigenpairs {
    let mut shifted = a.clone();
    match mass {
        Some(m) => shifted.axpy(-shift, m),
        None => assert!(shifted.add_identity(-shift)),
    }
    factor(&mut shifted);
    let apply = |x: &[f64], y: &mut [f64]| match mass {
        Some(m) => m.mul(x, y),
        None => identity(x, y),
    };
    solver.nearest(shift, apply, |x| shifted.solve(x), None)
}

/// The first eigenvalues by distance from the shift; where they end is no conjugate left out.
fn check(found: &Eigenpairs, k: usize, exact: &[(f64, f64)], shift: (f64, f64), tolerance: f64) {
    let report = found.report;
    assert!(report.complete && report.converged == found.pairs.len(), "{report:?}");
    assert!(found.pairs.len() == k || found.pairs.len() == k + 1, "{}", found.pairs.len());
    let from = |z: (f64, f64)| (z.0 - shift.0).hypot(z.1 - shift.1);
    let mut sorted = exact.to_vec();
    sorted.sort_by(|a, b| from(*a).total_cmp(&from(*b)));
    for (pair, exact) in found.pairs.iter().zip(&sorted) {
        let distance = from(*exact);
        assert!((from(pair.value) - distance).abs() < tolerance * distance, "{:?}", pair.value);
        let e = sorted
            .iter()
            .fold(f64::INFINITY, |m: f64, z| m.min((pair.value.0 - z.0).hypot(pair.value.1 - z.1)));
        assert!(e < tolerance * distance, "{:?} of {exact:?}: {e:e}", pair.value);
    }
}

/// Residuals `A x − λ M x` relative to the terms.
fn check_vectors<A: Matrix>(found: &Eigenpairs, a: &A, mass: Option<&A>, tolerance: f64) {
    let n = a.dim();
    let product = |m: Option<&A>, x: &[f64]| {
        let mut y = x.to_vec();
        if let Some(m) = m {
            m.mul(x, &mut y);
        }
        y
    };
    for pair in &found.pairs {
        let length: f64 = pair.re.iter().chain(&pair.im).map(|x| x * x).sum();
        assert!((length - 1.0).abs() < 1e-12);
        let (ar, ai) = (product(Some(a), &pair.re), product(Some(a), &pair.im));
        let (mr, mi) = (product(mass, &pair.re), product(mass, &pair.im));
        let (p, q) = pair.value;
        for i in 0..n {
            let re = ar[i] - p * mr[i] + q * mi[i];
            let im = ai[i] - p * mi[i] - q * mr[i];
            assert!(re.hypot(im) < tolerance * a.norm(), "{:e} at {:?}", re.hypot(im), pair.value);
        }
    }
}

/// Brusselator on a line, diffusion and reaction: eigenvalues are those of 2 by 2 matrices.
fn brusselator(cells: usize, b: f64) -> (Band, Vec<(f64, f64)>) {
    let (a, d1, d2) = (2.0, 0.008, 0.004);
    let h = 1.0 / (cells as f64 + 1.0);
    let mut matrix = Band::new(2 * cells, 2, 2);
    let mut exact = Vec::new();
    for i in 0..cells {
        let (u, v) = (2 * i, 2 * i + 1);
        matrix.set(u, u, b - 1.0 - 2.0 * d1 / (h * h));
        matrix.set(u, v, a * a);
        matrix.set(v, u, -b);
        matrix.set(v, v, -a * a - 2.0 * d2 / (h * h));
        if i > 0 {
            for (k, d) in [(u, d1), (v, d2)] {
                matrix.set(k, k - 2, d / (h * h));
                matrix.set(k - 2, k, d / (h * h));
            }
        }
        let wave = 4.0 / (h * h) * (0.5 * std::f64::consts::PI * h * (i + 1) as f64).sin().powi(2);
        let (p, q) = (b - 1.0 - d1 * wave, -a * a - d2 * wave);
        let (mean, det) = (0.5 * (p + q), p * q + a * a * b);
        let root = mean * mean - det;
        if root < 0.0 {
            exact.extend([(mean, (-root).sqrt()), (mean, -(-root).sqrt())]);
        } else {
            exact.extend([(mean + root.sqrt(), 0.0), (mean - root.sqrt(), 0.0)]);
        }
    }
    (matrix, exact)
}

#[test]
fn random_matrices_about_real_shifts() {
    let mut random = Random(40);
    for n in [1, 2, 3, 10, 80] {
        let a = random.dense(n);
        let exact = a.spectrum(None).unwrap();
        for (k, shift) in [(1, 0.0), (4, 0.5), (7, -1.0)] {
            let k = k.min(n);
            let found = nearest(&Arnoldi::new(n, k), &a, None, shift);
            check(&found, k, &exact, (shift, 0.0), 1e-9);
            check_vectors(&found, &a, None, 1e-8);
        }
    }
}

#[test]
fn brusselator_about_zero_and_on_the_imaginary_axis() {
    // Hopf of the first mode at b = 1 + a² + (d1 + d2) wave
    let (_, exact) = brusselator(400, 0.0);
    assert_eq!(exact.len(), 800);
    for b in [5.0, 5.118, 6.5] {
        let (a, exact) = brusselator(400, b);
        let solver = Arnoldi::new(800, 6);
        let found = nearest(&solver, &a, None, 0.0);
        check(&found, 6, &exact, (0.0, 0.0), 1e-8);
        check_vectors(&found, &a, None, 1e-8);
        for omega in [2.0, 2.13, -1.9] {
            let found = solver.nearest_to_imaginary(&a, None, omega).unwrap();
            check(&found, 6, &exact, (0.0, omega), 1e-8);
            check_vectors(&found, &a, None, 1e-8);
        }
    }
}

#[test]
fn shift_at_an_eigenvalue() {
    // at a Hopf point the shifted matrix is singular
    let (a, exact) = brusselator(60, 5.3);
    let (re, im) = exact.iter().copied().find(|z| z.1 > 0.0).unwrap();
    let mut at = a.clone();
    assert!(at.add_identity(-re));
    for off in [1e-4, 1e-10, 0.0] {
        let found = Arnoldi::new(120, 3).nearest_to_imaginary(&at, None, im + off).unwrap();
        assert!(found.report.complete, "{:?}", found.report);
        let (p, q) = found.pairs[0].value;
        assert!(p.abs() < 1e-11 && (q - im).abs() < 1e-11, "{off:e}: {p:e} {:e}", q - im);
        let shifted: Vec<_> = exact.iter().map(|z| (z.0 - re, z.1)).collect();
        for pair in &found.pairs[1..] {
            let e = shifted.iter().fold(f64::INFINITY, |m: f64, z| {
                m.min((pair.value.0 - z.0).hypot(pair.value.1 - z.1))
            });
            assert!(e < 1e-9 && e < 100.0 * pair.error, "{off:e}: {e:e}, said {:e}", pair.error);
        }
    }
}

#[test]
fn multiple_and_defective_eigenvalues() {
    // two equal pairs, a triple real one
    let n = 50;
    let mut d = Mat::<f64>::zeros(n, n);
    for i in [0, 2] {
        (d[(i, i + 1)], d[(i + 1, i)]) = (1.5, -1.5);
    }
    for i in 4..7 {
        d[(i, i)] = 1.7;
    }
    (7..n).for_each(|i| d[(i, i)] = 2.0 + 0.1 * i as f64);
    let mut random = Random(41);
    let p = to_mat(&random.dense(n)) + Mat::<f64>::identity(n, n) * faer::Scale(8.0);
    let a = to_dense(&(&p * &d * p.full_piv_lu().inverse()));
    let found = nearest(&Arnoldi::new(n, 7), &a, None, 0.1);
    let mut exact = vec![(0.0, 1.5), (0.0, 1.5), (0.0, -1.5), (0.0, -1.5)];
    exact.extend([(1.7, 0.0); 3]);
    check(&found, 7, &exact, (0.1, 0.0), 1e-9);
    let upper = found.pairs.iter().filter(|p| p.value.1 > 1.0).count();
    assert_eq!(upper, 2);
    for pair in found.pairs.chunks(2).filter(|p| p[0].value.1 != 0.0) {
        let ((p, q), (r, s)) = (pair[0].value, pair[1].value);
        assert!(p == r && q == -s && q > 0.0, "{pair:?}");
    }
    let found = Arnoldi::new(n, 2).nearest_to_imaginary(&a, None, 1.4).unwrap();
    check(&found, 2, &exact, (0.0, 1.4), 1e-9);
    // Jordan block: half the digits
    d[(0, 2)] = 1.0;
    d[(1, 3)] = 1.0;
    let a = to_dense(&(&p * &d * p.full_piv_lu().inverse()));
    let found = nearest(&Arnoldi::new(n, 4), &a, None, 0.1);
    assert_eq!(found.pairs.len(), 4);
    for pair in &found.pairs {
        assert!(pair.value.0.abs() < 1e-5 && (pair.value.1.abs() - 1.5).abs() < 1e-5);
    }
}

#[test]
fn singular_mass() {
    // half of the unknowns follow without inertia
    let n = 60;
    let mut random = Random(42);
    let a = random.band(n, 3, 3);
    let mut m = Band::new(n, 3, 3);
    (0..n).step_by(2).for_each(|i| m.set(i, i, 1.0 + random.next().abs()));
    let exact = to_dense(&to_mat(&a)).spectrum(Some(&to_dense(&to_mat(&m)))).unwrap();
    assert_eq!(exact.len(), n / 2);
    let found = nearest(&Arnoldi::new(n, 5), &a, Some(&m), 0.2);
    check(&found, 5, &exact, (0.2, 0.0), 1e-8);
    check_vectors(&found, &a, Some(&m), 1e-8);
    let found = Arnoldi::new(n, 5).nearest_to_imaginary(&a, Some(&m), 1.0).unwrap();
    check(&found, 5, &exact, (0.0, 1.0), 1e-8);
    check_vectors(&found, &a, Some(&m), 1e-8);
    // fewer finite ones than wanted
    let mut a = Dense::new(4);
    (0..4).for_each(|i| a.set(i, (i + 1) % 4, 1.0 + i as f64));
    let mut m = Dense::new(4);
    m.set(2, 2, 1.0);
    m.set(2, 3, 0.5);
    let exact = a.spectrum(Some(&m)).unwrap();
    let found = nearest(&Arnoldi::new(4, 3), &a, Some(&m), 0.3);
    assert_eq!(found.pairs.len(), exact.len(), "{found:?}");
}

#[test]
fn symmetric_storage_has_no_complex_form_and_limits_are_kept() {
    let mut random = Random(43);
    let a = random.symmetric_band(10, 2);
    assert!(Arnoldi::new(10, 2).nearest_to_imaginary(&a, None, 1.0).is_none());
    let a = random.dense(200);
    let few = EigenSettings { max_solves: 15, tolerance: 1e-10, complete: true };
    let found = nearest(&Arnoldi::new(200, 6).with_settings(few), &a, None, 0.0);
    assert!(!found.report.complete && found.report.solves < 30, "{:?}", found.report);
    let bad = Arnoldi::new(5, 2).nearest(0.0, identity, |x| x.fill(f64::NAN), None);
    assert!(!bad.report.complete && bad.report.converged == 0);
}

/// Spectra with multiplicities up to three, real and complex. The seeds are fixed: a search for
/// copies may fail, here in one of some ten thousand cases.
#[test]
fn known_spectra() {
    for seed in 0..150 {
        let mut random = Random(seed);
        let mut integer = |below: f64| (0.5 * below * (random.next() + 1.0)) as usize;
        let (n, k, copies) = (2 + integer(58.0), 1 + integer(6.0), 1 + integer(3.0));
        let mut d = Mat::<f64>::zeros(n, n);
        let mut exact = Vec::new();
        let mut i = 0;
        while i < n {
            let (re, im) = (3.0 * random.next(), 3.0 * random.next().abs());
            let pair = random.next() > 0.0;
            for _ in 0..copies {
                if pair && i + 1 < n {
                    (d[(i, i)], d[(i + 1, i + 1)], d[(i, i + 1)], d[(i + 1, i)]) =
                        (re, re, im, -im);
                    exact.extend([(re, im), (re, -im)]);
                    i += 2;
                } else if i < n {
                    d[(i, i)] = re;
                    exact.push((re, 0.0));
                    i += 1;
                }
            }
        }
        let p = to_mat(&random.dense(n)) * faer::Scale(1.0 / (n as f64).sqrt())
            + Mat::<f64>::identity(n, n) * faer::Scale(2.0);
        let inverse = p.full_piv_lu().inverse();
        if inverse.norm_max() > 5.0 {
            continue;
        }
        let a = to_dense(&(&p * &d * inverse));
        let (shift, omega) = (random.next(), 2.0 * random.next());
        let real = nearest(&Arnoldi::new(n, k), &a, None, shift);
        let imaginary = Arnoldi::new(n, k).nearest_to_imaginary(&a, None, omega).unwrap();
        for (found, shift) in [(real, (shift, 0.0)), (imaginary, (0.0, omega))] {
            assert!(found.report.complete, "{:?}", found.report);
            let from = |z: &(f64, f64)| (z.0 - shift.0).hypot(z.1 - shift.1);
            let mut sorted = exact.clone();
            sorted.sort_by(|a, b| from(a).total_cmp(&from(b)));
            assert!(found.pairs.len() >= k.min(n));
            for (pair, exact) in found.pairs.iter().zip(&sorted) {
                let e = (from(&pair.value) - from(exact)).abs();
                assert!(
                    e < 1e-7 * from(exact).max(0.1),
                    "{:e} {:?} {:?}",
                    e,
                    found.pairs.iter().map(|p| p.value).collect::<Vec<_>>(),
                    &sorted[..k.min(n)]
                );
            }
        }
    }
}
