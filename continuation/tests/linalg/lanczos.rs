//! Shift-invert Lanczos against dense spectra.

use continuation::linalg::{Dense, EigenReport, EigenSettings, Lanczos, Matrix, SymmetricBand};
use faer::Mat;

use crate::arch::arch;
use crate::support::*;

/// Eigenvalues of the pencil by the dense solver, ascending.
fn exact(a: &impl Matrix, m: Option<&SymmetricBand>) -> Vec<f64> {
    let mass = m.map(|m| to_dense(&to_mat(m)));
    let spectrum = to_dense(&to_mat(a)).spectrum(mass.as_ref()).unwrap();
    assert!(spectrum.iter().all(|z| z.1.abs() < 1e-8 * z.0.abs().max(1.0)));
    let mut values: Vec<f64> = spectrum.iter().map(|z| z.0).collect();
    values.sort_by(f64::total_cmp);
    values
}

fn apply(m: Option<&SymmetricBand>, x: &[f64], y: &mut [f64]) {
    match m {
        Some(m) => m.mul(x, y),
        None => y.copy_from_slice(x),
    }
}

/// Residuals of the eigenvectors and their orthogonality; `scale` is that of `A`.
fn check_vectors(a: &impl Matrix, m: Option<&SymmetricBand>, l: &Lanczos, tolerance: f64) {
    let n = a.dim();
    let (mut ax, mut mx) = (vec![0.0; n], vec![0.0; n]);
    for (i, value) in l.values().iter().enumerate() {
        a.mul(l.vector(i), &mut ax);
        apply(m, l.vector(i), &mut mx);
        let residual: Vec<f64> = ax.iter().zip(&mx).map(|(a, m)| a - value * m).collect();
        let scale = a.norm() * max_abs(l.vector(i));
        assert!(max_abs(&residual) < tolerance * scale, "{i}: {:e}", max_abs(&residual) / scale);
        for j in 0..l.values().len() {
            let product: f64 = l.vector(j).iter().zip(&mx).map(|(x, y)| x * y).sum();
            let expected = f64::from(i == j);
            assert!((product - expected).abs() < 1e-8, "{i} {j}: {product:e}");
        }
    }
}

/// The shifted matrix, factored, and the number of eigenvalues below the shift.
fn shifted(a: &SymmetricBand, m: Option<&SymmetricBand>, shift: f64) -> (SymmetricBand, usize) {
    let mut s = a.clone();
    match m {
        Some(m) => s.axpy(-shift, m),
        None => assert!(s.add_identity(-shift)),
    }
    let inertia = factor(&mut s).inertia.unwrap();
    (s, inertia.0)
}

fn nearest(
    l: &mut Lanczos,
    a: &SymmetricBand,
    m: Option<&SymmetricBand>,
    shift: f64,
) -> EigenReport {
    let (mut s, _) = shifted(a, m, shift);
    l.nearest(shift, |x, y| apply(m, x, y), |x| s.solve(x), None)
}

fn lowest(
    l: &mut Lanczos,
    a: &SymmetricBand,
    m: Option<&SymmetricBand>,
    shift: f64,
) -> EigenReport {
    let (mut s, below) = shifted(a, m, shift);
    l.lowest(shift, Some(below), |x, y| apply(m, x, y), |x| s.solve(x), None)
}

#[test]
fn nearest_to_any_shift() {
    let mut random = Random(30);
    for n in [1, 2, 3, 10, 60] {
        let a = random.symmetric_band(n, 3.min(n - 1));
        let values = exact(&a, None);
        let mut l = Lanczos::new(n, 4);
        for shift in [0.013, -1.1, 0.7, 30.0] {
            let report = nearest(&mut l, &a, None, shift);
            let mut expected = values.clone();
            expected.sort_by(|a, b| (a - shift).abs().total_cmp(&(b - shift).abs()));
            expected.truncate(4);
            assert!(report.complete && report.converged == expected.len(), "{report:?}");
            let e = error(l.values(), &expected);
            assert!(e < 1e-12, "n = {n}, shift {shift}: {e:e} {report:?}");
            check_vectors(&a, None, &l, 1e-6);
        }
    }
}

#[test]
fn lowest_of_an_arch() {
    for load in [0.0, 0.02, 0.1, 0.3] {
        let (a, m) = arch(50, load);
        let values = exact(&a, Some(&m));
        let negatives = values.iter().filter(|v| **v < 0.0).count();
        for k in [1, 5, 8] {
            let mut l = Lanczos::new(a.dim(), k);
            let report = lowest(&mut l, &a, Some(&m), 0.0);
            assert!(report.complete, "{report:?}");
            let count = k.max(negatives);
            assert_eq!(l.values().len(), count);
            for i in 0..count {
                let e = (l.values()[i] / values[i] - 1.0).abs();
                assert!(e < 1e-8, "load {load}, value {i} of {k}: {e:e}"); // the oracle's error
                assert!(l.errors()[i] < 1e-9 * l.values()[i].abs() && l.is_converged(i));
            }
            check_vectors(&a, Some(&m), &l, 1e-8);
        }
    }
}

#[test]
fn eigenvalues_of_an_arch_to_ten_digits_in_thirty_solves() {
    let (a, m) = arch(201, 0.02);
    assert_eq!((a.dim(), a.half_bandwidth()), (800, 7));
    let mut l = Lanczos::new(800, 5);
    let report = lowest(&mut l, &a, Some(&m), 0.0);
    assert!(report.complete && report.solves <= 30, "{report:?}");
    let mut other = Lanczos::new(800, 5)
        .with_settings(EigenSettings { tolerance: 1e-12, ..EigenSettings::default() });
    // a tight tolerance at the same shift, and another shift: rounding of the factors
    for (shift, tolerance) in [(0.0, 1e-11), (-0.05, 1e-9)] {
        assert!(lowest(&mut other, &a, Some(&m), shift).complete);
        for i in 0..5 {
            let e = (l.values()[i] / other.values()[i] - 1.0).abs();
            assert!(e < tolerance, "{i}: {e:e} {report:?}");
        }
    }
    let mut start = vec![0.0; 800];
    l.blend(&mut start);
    let (a, m) = arch(201, 0.0201);
    let (mut s, below) = shifted(&a, Some(&m), 0.0);
    let again = l.lowest(0.0, Some(below), |x, y| m.mul(x, y), |x| s.solve(x), Some(&start));
    assert!(again.complete && again.solves <= report.solves, "{again:?} {report:?}");
    println!("{report:?} {again:?}");
}

#[test]
fn all_copies_of_multiple_eigenvalues() {
    // Laplacian on a square: every unequal pair of wave numbers twice
    let side = 12;
    let mut a = SymmetricBand::new(side * side, side);
    for i in 0..side * side {
        a.add(i, i, 4.0);
        if i % side > 0 {
            a.add(i, i - 1, -1.0);
        }
        if i >= side {
            a.add(i, i - side, -1.0);
        }
    }
    let values = exact(&a, None);
    for k in [3, 6, 8] {
        let mut l = Lanczos::new(side * side, k);
        let report = lowest(&mut l, &a, None, 0.0);
        assert!(report.complete && error(l.values(), &values[..k]) < 1e-12, "{report:?}");
        check_vectors(&a, None, &l, 1e-7);
        // above some of them: the count is the proof
        let report = lowest(&mut l, &a, None, 0.6);
        assert!(report.complete, "{report:?}");
        assert!(error(l.values(), &values[..l.values().len()]) < 1e-12, "{report:?}");
    }
    // the identity
    let mut a = SymmetricBand::new(20, 0);
    a.add_identity(2.0);
    let mut l = Lanczos::new(20, 7);
    let report = nearest(&mut l, &a, None, 0.0);
    assert!(report.complete && error(l.values(), &[2.0; 7]) < 1e-14, "{report:?} {:?}", l.values());
}

/// A diagonal hidden by two reflections, dense.
fn hidden(diagonal: &[f64], random: &mut Random) -> Dense {
    let n = diagonal.len();
    let mut mat = Mat::from_fn(n, n, |i, j| if i == j { diagonal[i] } else { 0.0 });
    for _ in 0..2 {
        let v = random.vector(n);
        let scale = 2.0 / v.iter().map(|v| v * v).sum::<f64>();
        let h = Mat::from_fn(n, n, |i, j| f64::from(i == j) - scale * v[i] * v[j]);
        mat = &h * mat * &h;
    }
    to_dense(&mat)
}

#[test]
fn kernels_at_folds_and_double_bifurcation_points() {
    let mut random = Random(31);
    for kernel in [1, 2, 3] {
        for size in [1e-3, 1e-8, 1e-12, 1e-15, 0.0] {
            let mut diagonal: Vec<f64> = (1..=60).map(|i| f64::from(i) * 0.37).collect();
            (0..kernel).for_each(|i| diagonal[20 * i] = size * (1.0 + i as f64));
            let mut a = hidden(&diagonal, &mut random);
            factor(&mut a);
            let mut l = Lanczos::new(60, 6);
            let identity = |x: &[f64], y: &mut [f64]| y.copy_from_slice(x);
            let report = l.nearest(0.0, identity, |x| a.solve(x), None);
            assert!(report.complete, "{report:?}");
            diagonal.sort_by(f64::total_cmp);
            for i in 0..6 {
                let e = (l.values()[i] - diagonal[i]).abs();
                let tolerance = 1e-13 + 1e-10 * diagonal[i].abs();
                assert!(e < tolerance, "{kernel} of {size:e}, {i}: {e:e} {:?}", l.values());
            }
            check_vectors(&a, None, &l, 1e-8);
        }
    }
}

#[test]
fn negatives_far_from_the_shift_are_found() {
    let mut random = Random(32);
    let mut diagonal: Vec<f64> = (0..200).map(|i| 0.01 + 0.05 * f64::from(i)).collect();
    (diagonal[7], diagonal[100], diagonal[199]) = (-300.0, -40.0, -0.3);
    let mut a = hidden(&diagonal, &mut random);
    factor(&mut a);
    diagonal.sort_by(f64::total_cmp);
    let identity = |x: &[f64], y: &mut [f64]| y.copy_from_slice(x);
    for k in [2, 5] {
        let mut l = Lanczos::new(200, k);
        let report = l.lowest(0.0, Some(3), identity, |x| a.solve(x), None);
        assert!(report.complete, "{report:?}");
        assert!(error(l.values(), &diagonal[..k.max(3)]) < 1e-11, "{:?}", l.values());
        // a wrong count is not met, and said so
        let report = l.lowest(0.0, Some(4), identity, |x| a.solve(x), None);
        assert!(!report.complete && report.solves < 400, "{report:?}");
    }
}

#[test]
fn mass_without_multipliers() {
    // mean of u is prescribed by a multiplier, which has no mass
    let n = 40;
    let mut a = Dense::new(n + 1);
    for i in 0..n {
        a.set(i, i, 2.0);
        if i > 0 {
            a.set(i, i - 1, -1.0);
            a.set(i - 1, i, -1.0);
        }
        a.set(i, n, 1.0);
        a.set(n, i, 1.0);
    }
    let mut m = SymmetricBand::new(n + 1, 0);
    (0..n).for_each(|i| m.add(i, i, 0.5));
    let values = {
        // oracle: the restriction to the complement of the constant
        let ones = Mat::from_fn(n, 1, |_, _| (1.0 / n as f64).sqrt());
        let p = Mat::<f64>::identity(n, n) - &ones * ones.transpose();
        let k = Mat::from_fn(n, n, |i, j| a.get(i, j));
        let mut values = eigenvalues(&(&p * k * &p));
        values.sort_by(f64::total_cmp);
        values.remove(0); // of the constant
        values
    };
    factor(&mut a);
    let mut l = Lanczos::new(n + 1, 5);
    let report = l.lowest(0.0, Some(0), |x, y| m.mul(x, y), |x| a.solve(x), None);
    assert!(report.complete, "{report:?}");
    for i in 0..5 {
        let e = (l.values()[i] / (2.0 * values[i]) - 1.0).abs();
        assert!(e < 1e-11, "{i}: {e:e}");
    }
    check_vectors(&a, Some(&m), &l, 1e-8); // multipliers included
}

#[test]
fn nothing_to_find() {
    fn is_send(_: &impl Send) {}
    let mut l = Lanczos::new(5, 3);
    is_send(&l);
    let report = l.nearest(0.0, |_, y| y.fill(0.0), |_| {}, None);
    assert!(report.complete && l.values().is_empty(), "{report:?}");
    let identity = |x: &[f64], y: &mut [f64]| y.copy_from_slice(x);
    let report = l.nearest(0.0, identity, |x| x.fill(f64::NAN), None);
    assert!(!report.complete && report.converged == 0, "{report:?}");
    let mut empty = Lanczos::new(0, 3);
    assert!(empty.nearest(0.0, identity, |_| {}, None).complete);
    // fewer than wanted have mass
    let mass = |x: &[f64], y: &mut [f64]| {
        y.fill(0.0);
        y[1] = 2.0 * x[1];
    };
    let report = l.nearest(0.0, mass, |x| x.iter_mut().for_each(|x| *x /= 3.0), None);
    assert!(report.complete && (l.values()[0] - 1.5).abs() < 1e-15, "{report:?} {:?}", l.values());
}

#[test]
fn iteration_limit_and_restarts() {
    // 20 values in a cluster, from a distance: many restarts
    let mut random = Random(33);
    let diagonal: Vec<f64> = (0..300).map(|i| 1.0 + 1e-3 * f64::from(i)).collect();
    let mut a = hidden(&diagonal, &mut random);
    factor(&mut a);
    let identity = |x: &[f64], y: &mut [f64]| y.copy_from_slice(x);
    let mut l = Lanczos::new(300, 4);
    let report = l.nearest(0.0, identity, |x| a.solve(x), None);
    assert!(report.complete && report.solves > 60, "{report:?}");
    assert!(error(l.values(), &diagonal[..4]) < 1e-12);
    let few = EigenSettings { max_solves: 20, ..EigenSettings::default() };
    let mut l = Lanczos::new(300, 4).with_settings(few);
    let report = l.nearest(0.0, identity, |x| a.solve(x), None);
    assert!(!report.complete && report.solves <= 24 && report.converged < 4, "{report:?}");
}

/// Spectra with multiplicities up to three and values near the shift.
#[test]
fn known_spectra() {
    for seed in 0..200 {
        let mut random = Random(seed);
        let mut integer = |below: f64| (0.5 * below * (random.next() + 1.0)) as usize;
        let (n, k, copies) = (1 + integer(69.0), 1 + integer(7.0), 1 + integer(3.0));
        let mut diagonal: Vec<f64> = Vec::new();
        while diagonal.len() < n {
            let sign = if random.next() > 0.6 { -1.0 } else { 1.0 };
            let value = sign * 10f64.powf(2.0 * random.next());
            (0..copies).for_each(|_| diagonal.push(value));
        }
        diagonal.truncate(n);
        let mut a = hidden(&diagonal, &mut random);
        factor(&mut a);
        let below = diagonal.iter().filter(|v| **v < 0.0).count();
        let identity = |x: &[f64], y: &mut [f64]| y.copy_from_slice(x);
        let mut l = Lanczos::new(n, k);
        let report = l.lowest(0.0, Some(below), identity, |x| a.solve(x), None);
        diagonal.sort_by(f64::total_cmp);
        let expected = &diagonal[..k.max(below).min(n)];
        assert!(report.complete, "{:?}", report);
        assert_eq!(l.values().len(), expected.len());
        for (i, value) in l.values().iter().enumerate() {
            let e = (value - expected[i]).abs();
            assert!(e < 1e-9 * expected[i].abs() + 1e-13, "{}: {:?} {:?}", i, l.values(), expected);
        }
        let report = l.nearest(0.0, identity, |x| a.solve(x), None);
        diagonal.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        assert!(report.complete, "{:?}", report);
        for (value, expected) in l.values().iter().zip(&diagonal) {
            let e = (value.abs() - expected.abs()).abs();
            assert!(e < 1e-9 * expected.abs(), "{:?} {:?}", l.values(), &diagonal[..k.min(n)]);
        }
    }
}
