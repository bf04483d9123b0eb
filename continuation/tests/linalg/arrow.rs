//! Arrows against dense matrices: regular, over singular cores, singular themselves, nested.

use continuation::linalg::{Arrow, Band, Bordered, Dense, Lanczos, Matrix, SymmetricBand};
use faer::Mat;

use crate::bordered::Case;
use crate::support::*;

/// An arrow with random borders, symmetric or not, and a corner of zeros or random numbers.
fn arrow<A: Matrix>(
    core: A,
    m: usize,
    symmetric: bool,
    corner: f64,
    random: &mut Random,
) -> Arrow<A> {
    let n = core.dim();
    let mut a = Arrow::new(core, m);
    for k in 0..m {
        let b = random.vector(n);
        let c = if symmetric { b.clone() } else { random.vector(n) };
        a.column_mut(k).copy_from_slice(&b);
        a.row_mut(k).copy_from_slice(&c);
    }
    for k in 0..m {
        for i in 0..=k {
            let value = corner * random.next();
            a.set_corner(i, k, value);
            a.set_corner(k, i, if symmetric { value } else { corner * random.next() });
        }
    }
    a
}

/// The entries one by one.
fn assembled<A: Matrix>(a: &Arrow<A>) -> Mat<f64> {
    let (n, m) = a.dims();
    let core = to_mat(a.core());
    Mat::from_fn(n + m, n + m, |i, j| match (i < n, j < n) {
        (true, true) => core[(i, j)],
        (true, false) => a.column(j - n)[i],
        (false, true) => a.row(i - n)[j],
        (false, false) => a.corner(i - n, j - n),
    })
}

fn check(a: &mut impl Matrix, mat: &Mat<f64>, random: &mut Random) {
    let n = a.dim();
    let facts = factor(a);
    assert_eq!(facts.perturbed, 0, "{facts:?}");
    assert_eq!(facts.det_sign, Some(det_sign(mat)));
    let b = random.vector(n);
    let mut x = b.clone();
    a.solve(&mut x);
    let e = error(&x, &dense_solve(mat, &b));
    assert!(e < 1e-11, "solve: {e:e} {facts:?}");
    x.copy_from_slice(&b);
    a.solve_transpose(&mut x);
    let e = error(&x, &dense_solve(&mat.transpose().to_owned(), &b));
    assert!(e < 1e-11, "transposed solve: {e:e} {facts:?}");
}

#[test]
fn regular_arrows() {
    let mut random = Random(70);
    let mut tested = 0;
    for m in (0..4).cycle().take(60) {
        let mut a = arrow(random.band(20, 2, 1), m, false, 1.0, &mut random);
        let mat = assembled(&a);
        assert_eq!(to_mat(&a), mat);
        let (x, mut y) = (random.vector(20 + m), vec![0.0; 20 + m]);
        a.mul_transpose(&x, &mut y);
        let expected: Vec<f64> =
            (0..20 + m).map(|j| (0..20 + m).map(|i| mat[(i, j)] * x[i]).sum()).collect();
        assert!(error(&y, &expected) < 1e-14);
        assert_eq!(a.norm(), mat.norm_max());
        if condition(&mat) < 1e4 {
            tested += 1;
            check(&mut a, &mat, &mut random);
        }
        let mut b = arrow(random.band(20, 2, 1), m, false, 1.0, &mut random);
        b.axpy(-0.5, &a);
        assert!(b.add_identity(2.0));
        b.axpy(0.5, &a);
        b.axpy(-1.0, &b.clone());
        assert_eq!(b.norm(), 0.0);
        a.set_zero();
        assert_eq!(a.norm(), 0.0);
    }
    assert!(tested > 30, "{tested}");
}

/// Too large for a dense copy, with a first border whose own complement vanishes: the others decide.
#[test]
fn large_arrows_whose_first_border_says_nothing() {
    let mut random = Random(29);
    let (mut known, mut unknown) = (0, 0);
    for case in 0..24 {
        let (n, m) = (220, 2 + case % 2);
        let core = random.band(n, 2, 3);
        let mut a = arrow(core, m, false, 1.0, &mut random);
        // the corner at which the first border makes a singular matrix, and a little off
        let mut x = a.column(0).to_vec();
        let mut core = a.core().clone();
        core.factor(f64::EPSILON * core.norm());
        core.solve(&mut x);
        let singular: f64 = a.row(0).iter().zip(&x).map(|(c, x)| c * x).sum();
        let off = [0.0, 1e-14, -1e-12][case % 3];
        a.set_corner(0, 0, singular * (1.0 + off));
        let mat = assembled(&a);
        let facts = factor(&mut a);
        match facts.det_sign {
            Some(sign) => {
                known += 1;
                assert_eq!(sign, det_sign(&mat), "{case}: {facts:?}");
            }
            None => unknown += 1,
        }
    }
    assert!(known >= 20, "{known} known, {unknown} not");
}

#[test]
fn symmetric_arrows_know_their_inertia() {
    let mut random = Random(71);
    for m in [1, 2, 3] {
        for smallest in [1.0, 1e-6, 1e-12, 0.0] {
            let mut core = random.symmetric_band(30, 3);
            shift_smallest(&mut core, smallest);
            let mut a = arrow(core, m, true, 0.0, &mut random); // constraints
            let mat = assembled(&a);
            check(&mut a, &mat, &mut random);
            let negative = negatives(&mat);
            assert_eq!(factor(&mut a).inertia, Some((negative, 30 + m - negative)));
            a.row_mut(0)[3] += 1.0;
            assert_eq!(factor(&mut a).inertia, None);
        }
    }
}

/// Moves the diagonal and the first row of a border so that the arrow, its corner zero, has the
/// eigenvalue zero; `off` more on the diagonal.
fn make_singular(a: &mut Arrow<Band>, off: f64, random: &mut Random) {
    let (n, m) = a.dims();
    let x: Vec<f64> = (0..n).map(|_| 1.0 + 0.5 * random.next()).collect();
    let y = random.vector(m);
    for k in 0..m {
        let product: f64 = a.row(k).iter().zip(&x).map(|(c, x)| c * x).sum();
        let square: f64 = x.iter().map(|x| x * x).sum();
        a.row_mut(k).iter_mut().zip(&x).for_each(|(c, x)| *c -= product / square * x);
    }
    let mut r = vec![0.0; n];
    a.core().mul(&x, &mut r);
    for k in 0..m {
        r.iter_mut().zip(a.column(k)).for_each(|(r, b)| *r += y[k] * b);
    }
    for i in 0..n {
        a.core_mut().add(i, i, off - r[i] / x[i]);
    }
}

#[test]
fn folds_of_constrained_problems() {
    let mut random = Random(72);
    let mut tested = 0;
    for m in [1, 2, 3].into_iter().cycle().take(90) {
        for off in [0.0, 1e-16, 1e-15, 1e-13, 1e-9, 1e-4] {
            let mut a = arrow(random.band(25, 2, 2), m, false, 0.0, &mut random);
            make_singular(&mut a, off, &mut random);
            let mut case = Case::new(&a, 1, &mut random, false);
            if condition(&case.mat) > 1e4 {
                continue;
            }
            tested += 1;
            case.check(&mut a, &mut random);
        }
    }
    assert!(tested > 150, "{tested}");
}

#[test]
fn core_and_arrow_singular_at_once() {
    let mut random = Random(73);
    let mut tested = 0;
    for round in 0..200 {
        // a singular symmetric core, and a border that does not cure it
        let mut core = random.symmetric_band(20, 3);
        shift_smallest(&mut core, 0.0);
        let mut a = arrow(core, 1, true, 1.0, &mut random);
        let eigen = to_mat(a.core()).self_adjoint_eigen(faer::Side::Lower).unwrap();
        let null =
            (0..20).min_by(|&i, &j| eigen.S()[i].abs().total_cmp(&eigen.S()[j].abs())).unwrap();
        let part = if round % 2 == 0 { 0.0 } else { 1e-9 };
        let product: f64 = (0..20).map(|i| a.column(0)[i] * eigen.U()[(i, null)]).sum();
        for i in 0..20 {
            let value = a.column(0)[i] - (product - part) * eigen.U()[(i, null)];
            a.column_mut(0)[i] = value;
            a.row_mut(0)[i] = value;
        }
        let mut case = Case::new(&a, 1, &mut random, true);
        if condition(&case.mat) > 1e4 {
            continue;
        }
        tested += 1;
        let facts = case.check(&mut a, &mut random);
        let negative = negatives(&case.mat);
        assert_eq!(facts.inertia, Some((negative, 22 - negative)));
    }
    assert!(tested > 50, "{tested}");
}

#[test]
fn arrows_of_arrows() {
    let mut random = Random(74);
    let mut tested = 0;
    for _ in 0..40 {
        let inner = arrow(random.dense(10), 2, false, 1.0, &mut random);
        let mut outer = arrow(inner, 1, false, 1.0, &mut random);
        let mat = assembled(&outer);
        if condition(&mat) > 1e4 {
            continue;
        }
        tested += 1;
        check(&mut outer, &mat, &mut random);
        let mut case = Case::new(&outer, 2, &mut random, false);
        if condition(&case.mat) < 1e4 {
            case.check(&mut outer, &mut random);
        }
    }
    assert!(tested > 20, "{tested}");
    // scalar corner cases: [0 b; c 0] and nothing at all
    let mut a = Arrow::new(Dense::new(1), 1);
    a.column_mut(0)[0] = 2.0;
    a.row_mut(0)[0] = 3.0;
    check(&mut a, &Mat::from_fn(2, 2, |i, j| [[0.0, 2.0], [3.0, 0.0]][i][j]), &mut random);
    a.set_zero();
    assert_eq!(factor(&mut a).perturbed, 2);
    let mut s = Bordered::new(2, 2);
    for k in 0..2 {
        s.column_mut(k)[k] = 1.0;
        s.row_mut(k)[k] = 1.0;
    }
    s.factor(&mut a);
    let (mut f, mut g) = ([1.0, 2.0], [3.0, 4.0]);
    s.solve(&mut a, &mut f, &mut g);
    assert!(error(&[f, g].concat(), &[3.0, 4.0, 1.0, 2.0]) < 1e-14);
}

#[test]
fn complex_form_and_spectrum() {
    let mut random = Random(75);
    let a = arrow(random.band(8, 1, 2), 2, false, 1.0, &mut random);
    let b = arrow(random.band(8, 1, 2), 2, false, 1.0, &mut random);
    crate::spectra::check_complex(&a, &b, &mut a.complex(&b).unwrap());
    let found = a.spectrum(None).unwrap();
    let exact = to_dense(&assembled(&a)).spectrum(None).unwrap();
    assert!(crate::spectra::distance(&found, &exact) < 1e-12);
    let mut mass = Arrow::new(Band::new(8, 1, 2), 2);
    mass.core_mut().add_identity(1.0);
    assert!(a.spectrum(Some(&mass)).unwrap().len() < 10);
    let symmetric = Arrow::new(SymmetricBand::new(200, 1), 1);
    assert!(symmetric.spectrum(None).is_none() && symmetric.complex(&symmetric).is_none());
}

#[test]
fn lowest_eigenvalues_under_a_constraint() {
    // the multiplier is one negative of the inertia that is no eigenvalue
    let (k, m) = crate::arch::arch(40, 0.1);
    let n = k.dim();
    let mut a = Arrow::new(k.clone(), 1);
    let constraint: Vec<f64> = (0..n).map(|i| f64::from(i % 4 == 2)).collect();
    a.column_mut(0).copy_from_slice(&constraint);
    a.row_mut(0).copy_from_slice(&constraint);
    let inertia = factor(&mut a).inertia.unwrap();
    let mut l = Lanczos::new(n + 1, 4);
    let mass = |x: &[f64], y: &mut [f64]| {
        m.mul(&x[..n], &mut y[..n]);
        y[n] = 0.0;
    };
    let report = l.lowest(0.0, Some(inertia.0 - 1), mass, |x| a.solve(x), None);
    assert!(report.complete, "{report:?}");
    // the constraint as a penalty from both sides
    let mut mats = Dense::new(n);
    let stiff = |c: f64| {
        let mut s = k.clone();
        s.set_rank_one(c, &constraint);
        to_dense(&to_mat(&s))
    };
    mats.axpy(1.0, &to_dense(&to_mat(&m)));
    let mut values: Vec<f64> =
        stiff(1e7).spectrum(Some(&mats)).unwrap().iter().map(|z| z.0).collect();
    values.sort_by(f64::total_cmp);
    for i in 0..4 {
        let e = (l.values()[i] / values[i] - 1.0).abs();
        assert!(e < 1e-5, "{i}: {e:e} {:?}", l.values());
    }
}
