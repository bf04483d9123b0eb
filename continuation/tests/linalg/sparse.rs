//! Sparse LU against dense factorisations, over convection and diffusion in a square.

use continuation::linalg::{Bordered, Matrix, OutsidePattern, Sparse};
use std::time::Instant;

use crate::support::*;

/// Convection and diffusion on a square of `side²` cells, upwind, plus `shift` on the diagonal.
fn convection(side: usize, peclet: f64, shift: f64) -> Sparse {
    let n = side * side;
    let mut entries = Vec::new();
    for i in 0..n {
        if i % side > 0 {
            entries.extend([(i, i - 1), (i - 1, i)]);
        }
        if i >= side {
            entries.extend([(i, i - side), (i - side, i)]);
        }
    }
    let mut a = Sparse::new(n, &entries).unwrap();
    fill_convection(&mut a, side, peclet, shift);
    a
}

fn fill_convection(a: &mut Sparse, side: usize, peclet: f64, shift: f64) {
    for i in 0..side * side {
        let (x, y) = ((i % side) as f64 / side as f64 - 0.5, (i / side) as f64 / side as f64 - 0.5);
        let (u, v) = (-peclet * y, peclet * x);
        a.set(i, i, 4.0 + u.abs() + v.abs() + shift).unwrap();
        if i % side > 0 {
            a.set(i, i - 1, -1.0 - u.max(0.0)).unwrap();
            a.set(i - 1, i, -1.0 - (-u).max(0.0)).unwrap();
        }
        if i >= side {
            a.set(i, i - side, -1.0 - v.max(0.0)).unwrap();
            a.set(i - side, i, -1.0 - (-v).max(0.0)).unwrap();
        }
    }
}

/// Random pattern with about `per_row` entries per row.
fn scattered(n: usize, per_row: usize, random: &mut Random) -> Sparse {
    let index = |random: &mut Random| ((0.5 * (random.next() + 1.0)) * n as f64) as usize % n;
    let entries: Vec<_> = (0..n * per_row).map(|_| (index(random), index(random))).collect();
    let mut a = Sparse::new(n, &entries).unwrap();
    a.values_mut().iter_mut().for_each(|v| *v = random.next());
    a
}

fn check(a: &mut Sparse, random: &mut Random) {
    let mat = to_mat(a);
    let facts = factor(a);
    assert_eq!((facts.perturbed, facts.inertia), (0, None));
    assert_eq!(facts.det_sign, Some(det_sign(&mat)));
    let b = random.vector(a.dim());
    let mut x = b.clone();
    a.solve(&mut x);
    let e = backward_error(&mat, &x, &b);
    assert!(e < 1e-14, "solve: {e:e}");
    x.copy_from_slice(&b);
    a.solve_transpose(&mut x);
    let e = backward_error(&mat.transpose().to_owned(), &x, &b);
    assert!(e < 1e-14, "transposed solve: {e:e}");
}

#[test]
fn random_patterns() {
    let mut random = Random(50);
    for n in [1, 2, 5, 30, 60] {
        for per_row in [0, 1, 3, 10] {
            let mut a = scattered(n, per_row, &mut random);
            check(&mut a, &mut random);
            // the same pattern again, pivots kept or not
            for round in 0..4 {
                for v in a.values_mut() {
                    *v = if round % 2 == 0 {
                        *v * (1.0 + 0.1 * random.next())
                    } else {
                        random.next()
                    };
                }
                check(&mut a, &mut random);
            }
        }
    }
}

#[test]
fn zero_diagonals_of_multipliers() {
    // [K Cᵀ; C 0] with a constraint on every other unknown
    let mut random = Random(51);
    let n = 40_usize;
    let mut entries = Vec::new();
    for i in 0..n {
        entries.extend((i.saturating_sub(2)..(i + 3).min(n)).map(|j| (i, j)));
    }
    for k in 0..10 {
        entries.extend([(n + k, 4 * k), (4 * k, n + k), (n + k, 4 * k + 1), (4 * k + 1, n + k)]);
    }
    let mut a = Sparse::new(n + 10, &entries).unwrap();
    for &(i, j) in &entries {
        a.set(i, j, random.next() + if i == j { 4.0 } else { 0.0 }).unwrap();
    }
    (n..n + 10).for_each(|k| assert_eq!(a.get(k, k), 0.0));
    check(&mut a, &mut random);
}

#[test]
fn entries_products_and_pattern() {
    let mut a = Sparse::new(3, &[(0, 2), (2, 0), (0, 2)]).unwrap();
    assert_eq!(a.values().len(), 5);
    assert_eq!(a.set(1, 0, 1.0), Err(OutsidePattern { row: 1, column: 0 }));
    assert_eq!(a.add(7, 9, 1.0), Err(OutsidePattern { row: 7, column: 9 }));
    assert_eq!(Sparse::new(2, &[(0, 2)]).err(), Some(OutsidePattern { row: 0, column: 2 }));
    a.set(0, 2, 2.0).unwrap();
    a.add(0, 2, 0.5).unwrap();
    let at = a.position(2, 0).unwrap();
    a.values_mut()[at] = -3.0;
    a.add_identity(1.0);
    assert_eq!((a.get(0, 2), a.get(2, 0), a.get(1, 1), a.get(1, 0)), (2.5, -3.0, 1.0, 0.0));
    assert_eq!((a.position(1, 2), a.norm()), (None, 3.0));
    let mut b = a.clone();
    b.axpy(-2.0, &a);
    assert_eq!(to_mat(&b), to_mat(&a) * faer::Scale(-1.0));
    let (mut y, mut z) = (vec![0.0; 3], vec![0.0; 3]);
    a.mul_transpose(&[1.0, 2.0, 3.0], &mut y);
    let mat = to_mat(&a);
    (0..3).for_each(|j| z[j] = (0..3).map(|i| mat[(i, j)] * (i + 1) as f64).sum());
    assert_eq!(y, z);
    b.set_zero();
    assert_eq!(b.norm(), 0.0);
    let mut random = Random(52);
    let (mut re, mut im) = (convection(5, 3.0, 0.1), convection(5, 3.0, 0.1));
    re.values_mut().iter_mut().for_each(|v| *v += 0.1 * random.next());
    im.values_mut().iter_mut().for_each(|v| *v = random.next());
    crate::spectra::check_complex(&re, &im, &mut re.complex(&im).unwrap());
    assert_eq!(Sparse::new(0, &[]).unwrap().factor(0.0).det_sign, Some(1));
}

#[test]
fn exactly_singular_patterns() {
    // an empty row and an empty column, a zero matrix
    let mut a = Sparse::new(4, &[(0, 1), (1, 2), (2, 0)]).unwrap();
    for (i, j, v) in [(0, 1, 1.0), (1, 2, 2.0), (2, 0, 3.0)] {
        a.set(i, j, v).unwrap();
    }
    assert_eq!(factor(&mut a).perturbed, 1);
    let mut s = Bordered::new(4, 1);
    s.column_mut(0)[3] = 2.0;
    s.row_mut(0)[3] = 5.0;
    let facts = s.factor(&mut a);
    assert_eq!(facts.det_sign, Some(-1));
    let (mut f, mut g) = (vec![1.0, 2.0, 3.0, 4.0], [10.0]);
    s.solve(&mut a, &mut f, &mut g);
    assert!(error(&[&f[..], &g].concat(), &[1.0, 1.0, 1.0, 2.0, 2.0]) < 1e-15);
    a.set_zero();
    assert_eq!(factor(&mut a).perturbed, 4);
}

#[test]
fn singular_cores_with_one_and_two_borders() {
    let mut random = Random(53);
    let side = 7;
    let n = side * side;
    for peclet in [0.0, 6.0] {
        let plain = convection(side, peclet, 0.0);
        let mut values = to_dense(&to_mat(&plain)).spectrum(None).unwrap();
        values.retain(|z| z.1 == 0.0);
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        // without convection the second eigenvalue of the square is double
        for (defect, value) in [(1, values[0].0), (2, values[1].0)] {
            if defect == 2 && peclet > 0.0 {
                continue;
            }
            for off in [0.0, 1e-15, 1e-13, 1e-9, 1e-3] {
                let mut a = convection(side, peclet, off - value);
                let mut solver = Bordered::new(n, defect);
                let mut mat = faer::Mat::zeros(n + defect, n + defect);
                let core = to_mat(&a);
                (0..n * n).for_each(|k| mat[(k / n, k % n)] = core[(k / n, k % n)]);
                for k in 0..defect {
                    let (b, c) = (random.vector(n), random.vector(n));
                    (0..n).for_each(|i| (mat[(i, n + k)], mat[(n + k, i)]) = (b[i], c[i]));
                    solver.column_mut(k).copy_from_slice(&b);
                    solver.row_mut(k).copy_from_slice(&c);
                }
                let rhs = random.vector(n + defect);
                for round in 0..2 {
                    let facts = solver.factor(&mut a);
                    let sign = det_sign(&mat);
                    assert!(facts.det_sign.is_none_or(|s| s == sign), "{facts:?}");
                    assert!(defect == 2 || facts.det_sign.is_some());
                    let (mut f, mut g) = (rhs[..n].to_vec(), rhs[n..].to_vec());
                    solver.solve(&mut a, &mut f, &mut g);
                    let e = error(&[f, g].concat(), &dense_solve(&mat, &rhs));
                    assert!(e < 1e-11, "{defect}, off {off:e}, round {round}: {e:e} {facts:?}");
                    let (mut f, mut g) = (rhs[..n].to_vec(), rhs[n..].to_vec());
                    solver.solve_transpose(&mut a, &mut f, &mut g);
                    let transposed = mat.transpose().to_owned();
                    let e = error(&[f, g].concat(), &dense_solve(&transposed, &rhs));
                    assert!(e < 1e-11, "transposed {defect}, off {off:e}: {e:e} {facts:?}");
                }
            }
        }
    }
}

#[test]
fn ten_thousand_unknowns() {
    let side = 100;
    let mut a = convection(side, 20.0, 0.1);
    let n = side * side;
    let exact: Vec<f64> = (0..n).map(|i| (0.37 * i as f64).sin()).collect();
    let mut x = vec![0.0; n];
    for round in 0..2 {
        let start = Instant::now();
        let facts = factor(&mut a);
        let factored = start.elapsed();
        a.mul(&exact, &mut x);
        let start = Instant::now();
        a.solve(&mut x);
        println!(
            "round {round}: factor {factored:?}, solve {:?}, fill {}",
            start.elapsed(),
            a.fill()
        );
        assert_eq!(facts.perturbed, 0);
        assert!(error(&x, &exact) < 1e-11, "{:e}", error(&x, &exact));
        assert!(a.fill() < 1_000_000, "{}", a.fill());
        assert!(factored.as_secs_f64() < 2.0);
        fill_convection(&mut a, side, 25.0, 0.2);
    }
    let mut random = Random(54);
    let start = Instant::now();
    let mut b = scattered(3000, 3, &mut random);
    let facts = factor(&mut b);
    println!("scattered: {:?}, fill {}, {facts:?}", start.elapsed(), b.fill());
}

#[test]
fn scales_of_equations_do_not_matter() {
    let mut random = Random(55);
    let plain = convection(8, 10.0, 0.3);
    let n = plain.dim();
    let mut scaled = plain.clone();
    let scales: Vec<f64> = (0..n).map(|i| if i % 3 == 0 { 1e6 } else { 1e-6 }).collect();
    for j in 0..n {
        let rows = plain.column(j).0.to_vec();
        for i in rows {
            scaled.set(i, j, plain.get(i, j) * scales[i]).unwrap();
        }
    }
    let b = random.vector(n);
    let exact = dense_solve(&to_mat(&plain), &b);
    let mut x: Vec<f64> = b.iter().zip(&scales).map(|(b, s)| b * s).collect();
    factor(&mut scaled);
    scaled.solve(&mut x);
    assert!(error(&x, &exact) < 1e-12, "{:e}", error(&x, &exact));
}
