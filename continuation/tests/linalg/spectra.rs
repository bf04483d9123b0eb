//! Full spectra of dense pencils, and the real form of complex matrices.

use continuation::linalg::{Dense, MAX_SPECTRUM, Matrix};
use faer::Mat;

use crate::support::*;

/// The real form multiplies, shifts and solves as complex arithmetic does.
pub(crate) fn check_complex(a: &impl Matrix, b: &impl Matrix, form: &mut impl Matrix) {
    let mut random = Random(77);
    let (n, re, im) = (a.dim(), to_mat(a), to_mat(b));
    assert_eq!(form.dim(), 2 * n);
    let x = random.vector(2 * n);
    let mut expected = vec![0.0; 2 * n];
    for i in 0..n {
        for j in 0..n {
            let (p, q) = (re[(i, j)], im[(i, j)]);
            expected[2 * i] += p * x[2 * j] - q * x[2 * j + 1];
            expected[2 * i + 1] += p * x[2 * j + 1] + q * x[2 * j];
        }
    }
    let mut y = vec![0.0; 2 * n];
    form.mul(&x, &mut y);
    assert!(error(&y, &expected) < 1e-14);
    factor(form);
    form.solve(&mut y);
    assert!(error(&y, &x) < 1e-9, "{:e}", error(&y, &x));
}

#[test]
fn complex_matrices_as_real_ones() {
    let mut random = Random(20);
    let (a, b) = (random.dense(7), random.dense(7));
    check_complex(&a, &b, &mut a.complex(&b).unwrap());
    for (kl, ku) in [(0, 0), (2, 1), (1, 4)] {
        let (a, b) = (random.band(9, kl, ku), random.band(9, kl, ku));
        let mut form = a.complex(&b).unwrap();
        assert_eq!(form.bandwidths(), (2 * kl + 1, 2 * ku + 1));
        check_complex(&a, &b, &mut form);
    }
    let a = random.symmetric_band(5, 1);
    assert!(a.complex(&a).is_none());
}

#[test]
fn multiples_of_the_identity() {
    fn check(mut a: impl Matrix) {
        let before = to_mat(&a);
        assert!(a.add_identity(2.5));
        let n = a.dim();
        assert_eq!(to_mat(&a) - before, Mat::from_fn(n, n, |i, j| if i == j { 2.5 } else { 0.0 }));
    }
    check(Dense::new(4));
    let mut band = Random(0).band(6, 1, 2);
    (0..6).for_each(|i| band.set(i, i, 0.5));
    check(band);
    check(continuation::linalg::SymmetricBand::new(5, 2));
}

/// Largest distance of a value to its nearest partner, both ways; the lists are equally long.
pub(crate) fn distance(found: &[(f64, f64)], exact: &[(f64, f64)]) -> f64 {
    assert_eq!(found.len(), exact.len(), "{found:?} {exact:?}");
    let one_way = |p: &[(f64, f64)], q: &[(f64, f64)]| {
        p.iter()
            .map(|z| q.iter().fold(f64::INFINITY, |m, w| m.min((z.0 - w.0).hypot(z.1 - w.1))))
            .fold(0.0, f64::max)
    };
    one_way(found, exact).max(one_way(exact, found))
}

/// `P diag Q` and `P Q` with regular random `P`, `Q`: a pencil with known eigenvalues; a pair
/// `(re, im)` with `im != 0` stands for itself and its conjugate, `None` for an infinite one.
fn pencil(random: &mut Random, values: &[Option<(f64, f64)>]) -> (Dense, Dense) {
    let n = values.iter().map(|v| if v.is_some_and(|v| v.1 != 0.0) { 2 } else { 1 }).sum();
    let (mut a, mut m) = (Mat::zeros(n, n), Mat::<f64>::identity(n, n));
    let mut i = 0;
    for value in values {
        match *value {
            None => (a[(i, i)], m[(i, i)]) = (1.0, 0.0),
            Some((re, 0.0)) => a[(i, i)] = re,
            Some((re, im)) => {
                (a[(i, i)], a[(i + 1, i + 1)]) = (re, re);
                (a[(i, i + 1)], a[(i + 1, i)]) = (im, -im);
                i += 1;
            }
        }
        i += 1;
    }
    let regular = |random: &mut Random| {
        let r = to_mat(&random.dense(n));
        r.qr().compute_thin_Q() * faer::Scale(2.0) + r * faer::Scale(0.2)
    };
    let (p, q) = (regular(random), regular(random));
    (to_dense(&(&p * a * &q)), to_dense(&(&p * m * &q)))
}

#[test]
fn generalised_eigenvalues_of_known_pencils() {
    let mut random = Random(21);
    for infinite in [0, 1, 3] {
        for n in [3, 10, 40] {
            let mut values: Vec<Option<(f64, f64)>> = (0..n)
                .map(|i| {
                    Some((random.next() * 3.0, f64::from(i % 3 == 0) * (1.0 + 0.1 * f64::from(i))))
                })
                .collect();
            values.extend((0..infinite).map(|_| None));
            let (a, m) = pencil(&mut random, &values);
            let mut exact = Vec::new();
            for (re, im) in values.into_iter().flatten() {
                exact.push((re, im));
                if im != 0.0 {
                    exact.push((re, -im));
                }
            }
            let found = a.spectrum(Some(&m)).unwrap();
            let e = distance(&found, &exact);
            assert!(e < 1e-11, "n = {n}, {infinite} infinite: {e:e}");
        }
    }
}

#[test]
fn differential_algebraic_systems_have_fewer_eigenvalues() {
    // pendulum at rest in Cartesian coordinates, its constraint on velocity level (index two):
    // x'' = -λx, y'' = -λy - g at (0, -1), λ = g: oscillation of frequency sqrt(g)
    let g = 9.81;
    let mut a = Dense::new(5);
    let mut m = Dense::new(5);
    for (i, j, v) in [(0, 2, 1.0), (1, 3, 1.0), (2, 0, -g), (3, 1, -g), (3, 4, 1.0), (4, 3, -1.0)] {
        a.set(i, j, v);
    }
    (0..4).for_each(|i| m.set(i, i, 1.0));
    let mut found = a.spectrum(Some(&m)).unwrap();
    found.retain(|z| z.0.hypot(z.1) > 1e-6); // y itself is not fixed by the velocity
    assert!(distance(&found, &[(0.0, g.sqrt()), (0.0, -g.sqrt())]) < 1e-7, "{found:?}");
}

#[test]
fn symmetric_matrices_have_exactly_real_eigenvalues() {
    let mut random = Random(22);
    let n = 30;
    let r = to_mat(&random.dense(n));
    let mut a = to_mat(&random.dense(n));
    a = &a + a.transpose();
    let m = &r * r.transpose() + Mat::<f64>::identity(n, n);
    let plain = to_dense(&a).spectrum(None).unwrap();
    let exact: Vec<(f64, f64)> = eigenvalues(&a).into_iter().map(|v| (v, 0.0)).collect();
    assert!(plain.iter().all(|z| z.1 == 0.0) && distance(&plain, &exact) < 1e-13);
    let found = to_dense(&a).spectrum(Some(&to_dense(&m))).unwrap();
    assert!(found.iter().all(|z| z.1 == 0.0));
    // the oracle goes through the other algorithm: M⁻¹A
    let quotient =
        Mat::from_fn(n, n, |_, _| 0.0) + faer::linalg::solvers::Solve::solve(&m.full_piv_lu(), &a);
    let exact: Vec<(f64, f64)> =
        quotient.eigenvalues().unwrap().iter().map(|z| (z.re, z.im)).collect();
    assert!(distance(&found, &exact) < 1e-11);
    // semidefinite: fewer eigenvalues
    let mut semi = Dense::new(3);
    semi.set(0, 0, 2.0);
    semi.set(1, 1, 1.0);
    let mut k = Dense::new(3);
    for (i, j, v) in [(0, 0, 4.0), (1, 1, 3.0), (2, 2, 1.0), (0, 2, 1.0), (2, 0, 1.0)] {
        k.set(i, j, v);
    }
    let found = k.spectrum(Some(&semi)).unwrap();
    assert!(distance(&found, &[(1.5, 0.0), (3.0, 0.0)]) < 1e-13, "{found:?}");
}

#[test]
fn no_spectrum_of_large_matrices() {
    assert!(Dense::new(MAX_SPECTRUM + 1).spectrum(None).is_none());
    let (mut a, m) = (Dense::new(3), Dense::new(3));
    a.add_identity(1.0);
    assert_eq!(a.spectrum(Some(&m)), Some(vec![])); // no mass, no dynamics
}
