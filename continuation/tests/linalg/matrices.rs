//! Factorisations, signs and inertia.

use continuation::linalg::{Band, Bordered, Dense, MAX_GROWTH, Matrix, SymmetricBand};
use faer::Mat;
use proptest::prelude::*;

use crate::support::*;

/// Both solves are backward stable and the sign of the determinant is right.
fn check_solves(a: &mut impl Matrix, random: &mut Random) {
    let mat = to_mat(a);
    let facts = factor(a);
    assert_eq!(facts.perturbed, 0);
    assert_eq!(facts.det_sign, Some(det_sign(&mat)));
    let b = random.vector(a.dim());
    let mut x = b.clone();
    a.solve(&mut x);
    let e = backward_error(&mat, &x, &b);
    assert!(e < 1e-14, "solve: {e:e}");
    let mut x = b.clone();
    a.solve_transpose(&mut x);
    let e = backward_error(&mat.transpose().to_owned(), &x, &b);
    assert!(e < 1e-14, "transposed solve: {e:e}");
}

#[test]
fn product_norm_and_entries_agree() {
    let mut random = Random(1);
    for (n, kd) in [(1, 0), (3, 7), (12, 0), (30, 7), (30, 8), (31, 11)] {
        let mut a = random.symmetric_band(n, kd);
        a.set_rank_one(0.7, &random.vector(n));
        let x = random.vector(n);
        let mut y = vec![0.0; n];
        a.mul(&x, &mut y);
        let largest = (0..n * n).fold(0.0, |m: f64, k| m.max(a.get(k / n, k % n).abs()));
        assert!(largest <= a.norm() && a.norm() < 3.0, "norm {} of {largest}", a.norm());
        let by_entries: Vec<f64> =
            (0..n).map(|i| (0..n).map(|j| a.get(i, j) * x[j]).sum()).collect();
        assert!(error(&y, &by_entries) < 1e-14, "n={n} kd={kd}");
    }
}

#[test]
fn random_general_matrices() {
    let mut random = Random(2);
    for n in [1, 2, 5, 40] {
        check_solves(&mut random.dense(n), &mut random);
        for (kl, ku) in [(0, 0), (1, 3), (3, 1), (7, 7)] {
            if n > 2 || kl == 0 {
                check_solves(&mut random.band(n, kl, ku), &mut random);
            }
        }
    }
}

#[test]
fn spectrum_and_symmetric_inertia_of_a_dense_matrix() {
    let mut a = Dense::new(2);
    a.set(0, 1, -2.0);
    a.set(1, 0, 2.0);
    let mut values = a.spectrum(None).unwrap();
    values.sort_by(|a, b| a.1.total_cmp(&b.1));
    assert!((values[0].1 + 2.0).abs() < 1e-14 && (values[1].1 - 2.0).abs() < 1e-14);
    assert_eq!(a.symmetric_inertia(), None);
    a.set(0, 1, 2.0);
    assert_eq!(a.symmetric_inertia(), Some((1, 1)));
    a.add(0, 0, f64::NAN);
    assert_eq!((a.symmetric_inertia(), a.spectrum(None)), (None, None));
}

#[test]
fn scaled_equations_do_not_change_a_dense_or_band_solution() {
    let mut random = Random(3);
    let n = 30;
    let plain = random.band(n, 2, 3);
    let scales: Vec<f64> = (0..n).map(|i| if i % 3 == 0 { 1e6 } else { 1e-6 }).collect();
    let (mut band, mut dense) = (Band::new(n, 2, 3), Dense::new(n));
    for j in 0..n {
        let (first, column) = plain.column(j);
        for (i, v) in (first..).zip(column) {
            band.set(i, j, v * scales[i]);
            dense.set(i, j, v * scales[i]);
        }
    }
    let b = random.vector(n);
    let exact = dense_solve(&to_mat(&plain), &b);
    let scaled: Vec<f64> = b.iter().zip(&scales).map(|(b, s)| b * s).collect();
    let mut x = scaled.clone();
    factor(&mut band);
    band.solve(&mut x);
    assert!(error(&x, &exact) < 1e-12, "{:e}", error(&x, &exact));
    x.copy_from_slice(&scaled);
    factor(&mut dense);
    dense.solve(&mut x);
    assert!(error(&x, &exact) < 1e-12, "{:e}", error(&x, &exact));
}

#[test]
fn zero_leading_pivot_is_eliminated_from_the_other_end() {
    let mut random = Random(4);
    let mut a = random.symmetric_band(40, 3);
    a.column_mut(0)[0] = 0.0;
    let mat = to_mat(&a);
    let facts = factor(&mut a);
    assert!(facts.growth <= MAX_GROWTH);
    let negative = negatives(&mat);
    assert_eq!(facts.inertia, Some((negative, 40 - negative)));
    check_solves(&mut a, &mut random);
}

#[test]
fn zero_pivots_at_both_ends_fall_back_to_lu() {
    let mut random = Random(5);
    for rank_one in [false, true] {
        let mut a = random.symmetric_band(40, 3);
        a.column_mut(0)[0] = 0.0;
        a.column_mut(39)[0] = 0.0;
        if rank_one {
            a.set_rank_one(2.0, &random.vector(40));
        }
        let facts = factor(&mut a);
        assert_eq!(facts.inertia, None); // growth 1/eps: nothing is known
        assert!(facts.growth < 100.0);
        check_solves(&mut a, &mut random);
    }
}

#[test]
fn inertia_survives_growth_that_its_backward_error_allows() {
    let mut random = Random(6);
    let mut a = random.symmetric_band(40, 3);
    a.column_mut(0)[0] = 1e-9;
    a.column_mut(39)[0] = 1e-9;
    let negative = negatives(&to_mat(&a));
    let facts = factor(&mut a);
    assert!(facts.growth < 100.0, "not from the LU: {}", facts.growth);
    assert_eq!(facts.inertia, Some((negative, 40 - negative)));
    check_solves(&mut a, &mut random);
}

#[test]
fn rank_one_term_of_any_size() {
    let mut random = Random(7);
    let n = 30;
    for c in [0.0, 1e-300, 1e-20, 1e-3, 1.0, 1e8, -2.0] {
        let mut a = random.symmetric_band(n, 4);
        let v = random.vector(n);
        a.set_rank_one(c, &v);
        let mat = to_mat(&a);
        let negative = negatives(&mat);
        check_solves(&mut a, &mut random);
        assert_eq!(factor(&mut a).inertia, Some((negative, n - negative)), "c = {c:e}");
    }
    // c -> infinity is the constraint v.x = 0
    let mut a = random.symmetric_band(n, 4);
    let v = random.vector(n);
    let mut constrained = Mat::zeros(n + 1, n + 1);
    for i in 0..n {
        (0..n).for_each(|j| constrained[(i, j)] = a.get(i, j));
        (constrained[(i, n)], constrained[(n, i)]) = (v[i], v[i]);
    }
    a.set_rank_one(1e30, &v);
    let facts = factor(&mut a);
    assert_eq!(facts.inertia.unwrap().0, negatives(&constrained) - 1);
    let b = random.vector(n);
    let mut x = b.clone();
    a.solve(&mut x);
    let exact = dense_solve(&constrained, &[b, vec![0.0]].concat());
    assert!(error(&x, &exact[..n]) < 1e-11);
}

#[test]
fn singular_band_cured_by_its_rank_one_term() {
    let mut random = Random(8);
    for smallest in [1e-4, -1e-8, 1e-12, 0.0] {
        let mut a = random.symmetric_band(30, 4);
        shift_smallest(&mut a, smallest);
        a.set_rank_one(1.5, &random.vector(30));
        let mat = to_mat(&a);
        let facts = factor(&mut a);
        assert_eq!(facts.perturbed, 0);
        assert_eq!(facts.det_sign, Some(det_sign(&mat)));
        assert_eq!(facts.inertia.unwrap().0, negatives(&mat));
        let b = random.vector(30);
        let mut x = b.clone();
        a.solve(&mut x);
        let e = error(&x, &dense_solve(&mat, &b));
        assert!(e < 1e-11, "smallest {smallest:e}: {e:e}");
    }
    // An exact zero on the diagonal of a diagonal band.
    let mut a = SymmetricBand::new(3, 1);
    (0..2).for_each(|i| a.add(i, i, 1.0 + i as f64));
    a.set_rank_one(4.0, &[0.0, 0.0, 0.5]);
    let facts = factor(&mut a);
    assert_eq!((facts.perturbed, facts.inertia, facts.det_sign), (0, Some((0, 3)), Some(1)));
    let mut x = [1.0, 2.0, 3.0];
    a.solve(&mut x);
    assert!(error(&x, &[1.0, 1.0, 3.0]) < 1e-15);
}

#[test]
fn rank_one_term_that_makes_the_matrix_singular() {
    let mut a = SymmetricBand::new(2, 1);
    a.add(0, 0, -1.0);
    a.add(1, 1, 1.0);
    a.set_rank_one(1.0, &[1.0, 0.0]);
    assert_eq!(factor(&mut a).perturbed, 1);
    let mut s = Bordered::new(2, 1);
    s.column_mut(0)[0] = 2.0;
    s.row_mut(0)[0] = 4.0;
    let facts = s.factor(&mut a);
    assert_eq!(facts.det_sign, Some(-1));
    let (mut f, mut g) = ([2.0, 3.0], [8.0]);
    s.solve(&mut a, &mut f, &mut g);
    assert!(error(&[f[0], f[1], g[0]], &[2.0, 3.0, 1.0]) < 1e-15);
}

#[test]
fn axpy_adds_bands_and_rank_one_terms() {
    let mut random = Random(9);
    let (mut a, mut b) = (random.symmetric_band(9, 2), random.symmetric_band(9, 2));
    b.set_rank_one(0.5, &random.vector(9));
    let expected = to_mat(&a) + to_mat(&b) * faer::Scale(3.0);
    a.axpy(2.0, &b);
    a.axpy(1.0, &b);
    assert!((to_mat(&a) - &expected).norm_max() < 1e-14);
    a.axpy(-3.0, &b);
    a.set_zero();
    assert_eq!((a.norm(), a.rank_one()), (0.0, None));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn inertia_of_random_bands(
        seed in any::<u64>(), n in 1usize..60, kd in 0usize..11, c in prop::option::of(1e-3..1e3)
    ) {
        let mut random = Random(seed);
        let mut a = random.symmetric_band(n, kd);
        if let Some(c) = c {
            a.set_rank_one(c, &random.vector(n));
        }
        let mat = to_mat(&a);
        let values = eigenvalues(&mat);
        let smallest = values.iter().fold(f64::INFINITY, |m: f64, v| m.min(v.abs()));
        prop_assume!(smallest > 1e-7 * a.norm());
        let facts = factor(&mut a);
        let negative = values.iter().filter(|v| **v < 0.0).count();
        prop_assert_eq!(facts.inertia, Some((negative, n - negative)));
        prop_assert_eq!(facts.det_sign, Some(if negative % 2 == 0 { 1 } else { -1 }));
        let b = random.vector(n);
        let mut x = b.clone();
        a.solve(&mut x);
        let e = backward_error(&mat, &x, &b);
        prop_assert!(e < 1e-13, "{:e}", e);
    }
}
