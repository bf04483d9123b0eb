//! The matrices and the bordered solver against dense factorisations and eigenvalues of faer.
#![allow(clippy::unwrap_used)]

use continuation::linalg::{
    Band, Bordered, BorderedFacts, Dense, MAX_GROWTH, Matrix, SymmetricBand,
};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use proptest::prelude::*;

/// Uniform numbers in (-1, 1), reproducible.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.next()).collect()
    }

    fn symmetric_band(&mut self, n: usize, kd: usize) -> SymmetricBand {
        let mut a = SymmetricBand::new(n, kd);
        for j in 0..n {
            a.column_mut(j).iter_mut().for_each(|entry| *entry = self.next());
        }
        a
    }

    fn band(&mut self, n: usize, kl: usize, ku: usize) -> Band {
        let mut a = Band::new(n, kl, ku);
        for j in 0..n {
            for i in j.saturating_sub(ku)..(j + kl + 1).min(n) {
                a.set(i, j, self.next());
            }
        }
        a
    }

    fn dense(&mut self, n: usize) -> Dense {
        let mut a = Dense::new(n);
        (0..n).for_each(|j| a.column_mut(j).iter_mut().for_each(|entry| *entry = self.next()));
        a
    }
}

/// The matrix by its action on unit vectors.
fn to_mat(a: &impl Matrix) -> Mat<f64> {
    let n = a.dim();
    let mut mat = Mat::zeros(n, n);
    let mut y = vec![0.0; n];
    for j in 0..n {
        let mut e = vec![0.0; n];
        e[j] = 1.0;
        a.mul(&e, &mut y);
        (0..n).for_each(|i| mat[(i, j)] = y[i]);
    }
    mat
}

fn dense_solve(a: &Mat<f64>, b: &[f64]) -> Vec<f64> {
    let rhs = Mat::from_fn(b.len(), 1, |i, _| b[i]);
    let x = a.full_piv_lu().solve(&rhs);
    (0..b.len()).map(|i| x[(i, 0)]).collect()
}

fn det_sign(a: &Mat<f64>) -> i8 {
    if a.determinant() < 0.0 { -1 } else { 1 }
}

fn eigenvalues(a: &Mat<f64>) -> Vec<f64> {
    a.self_adjoint_eigenvalues(Side::Lower).unwrap()
}

fn negatives(a: &Mat<f64>) -> usize {
    eigenvalues(a).iter().filter(|v| **v < 0.0).count()
}

fn max_abs(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

fn error(x: &[f64], exact: &[f64]) -> f64 {
    let difference: Vec<f64> = x.iter().zip(exact).map(|(a, b)| a - b).collect();
    max_abs(&difference) / max_abs(exact)
}

fn factor(a: &mut impl Matrix) -> continuation::Facts {
    let floor = f64::EPSILON * a.norm();
    a.factor(floor)
}

/// Residual of a solve relative to `|A| |x|`, with the dense copy of the matrix.
fn backward_error(a: &Mat<f64>, x: &[f64], b: &[f64]) -> f64 {
    let n = b.len();
    let mut worst: f64 = 0.0;
    let norm = (0..n)
        .flat_map(|i| (0..n).map(move |j| (i, j)))
        .fold(0.0, |m: f64, (i, j)| m.max(a[(i, j)].abs()));
    for i in 0..n {
        let r = b[i] - (0..n).map(|j| a[(i, j)] * x[j]).sum::<f64>();
        worst = worst.max(r.abs());
    }
    worst / (norm * max_abs(x) + max_abs(b))
}

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

/// The bordered matrix with random or given borders, dense.
struct Case {
    solver: Bordered,
    mat: Mat<f64>,
}

impl Case {
    fn new(a: &impl Matrix, m: usize, random: &mut Random, symmetric: bool) -> Self {
        let n = a.dim();
        let core = to_mat(a);
        let mut solver = Bordered::new(n, m);
        let mut mat = Mat::zeros(n + m, n + m);
        (0..n).for_each(|j| (0..n).for_each(|i| mat[(i, j)] = core[(i, j)]));
        for k in 0..m {
            let b = random.vector(n);
            let c = if symmetric { b.clone() } else { random.vector(n) };
            solver.column_mut(k).copy_from_slice(&b);
            solver.row_mut(k).copy_from_slice(&c);
            (0..n).for_each(|i| (mat[(i, n + k)], mat[(n + k, i)]) = (b[i], c[i]));
        }
        for k in 0..m {
            for i in 0..=k {
                let (above, below) = (random.next(), random.next());
                mat[(n + i, n + k)] = above;
                mat[(n + k, n + i)] = if symmetric || i == k { above } else { below };
            }
        }
        for k in 0..m {
            (0..m).for_each(|i| solver.set_corner(i, k, mat[(n + i, n + k)]));
        }
        Self { solver, mat }
    }

    /// Solves both ways; forward errors relative to dense solves, at most 1e-11.
    fn check(&mut self, a: &mut impl Matrix, random: &mut Random) -> BorderedFacts {
        let facts = self.check_solutions(a, random);
        assert_eq!(facts.det_sign, Some(det_sign(&self.mat)), "{facts:?}");
        facts
    }

    fn check_solutions(&mut self, a: &mut impl Matrix, random: &mut Random) -> BorderedFacts {
        let n = a.dim();
        let rhs = random.vector(self.mat.nrows());
        let facts = self.solver.factor(a);
        let (mut f, mut g) = (rhs[..n].to_vec(), rhs[n..].to_vec());
        self.solver.solve(a, &mut f, &mut g);
        let e = error(&[f, g].concat(), &dense_solve(&self.mat, &rhs));
        assert!(e < 1e-11, "solve: {e:e} {facts:?}");
        let (mut f, mut g) = (rhs[..n].to_vec(), rhs[n..].to_vec());
        self.solver.solve_transpose(a, &mut f, &mut g);
        let e = error(&[f, g].concat(), &dense_solve(&self.mat.transpose().to_owned(), &rhs));
        assert!(e < 1e-11, "transposed solve: {e:e} {facts:?}");
        facts
    }
}

/// Shifts the diagonal so that the eigenvalue of smallest magnitude becomes `value`.
fn shift_smallest(a: &mut SymmetricBand, value: f64) {
    let values = eigenvalues(&to_mat(a));
    let smallest =
        values.iter().fold(f64::INFINITY, |m: f64, v| if v.abs() < m.abs() { *v } else { m });
    (0..a.dim()).for_each(|i| a.add(i, i, value - smallest));
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
    let mut values = a.spectrum().unwrap();
    values.sort_by(|a, b| a.1.total_cmp(&b.1));
    assert!((values[0].1 + 2.0).abs() < 1e-14 && (values[1].1 - 2.0).abs() < 1e-14);
    assert_eq!(a.symmetric_inertia(), None);
    a.set(0, 1, 2.0);
    assert_eq!(a.symmetric_inertia(), Some((1, 1)));
    a.add(0, 0, f64::NAN);
    assert_eq!((a.symmetric_inertia(), a.spectrum()), (None, None));
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

#[test]
fn bordered_nearly_singular_cores() {
    let mut random = Random(10);
    for smallest in [1.0, 1e-4, 1e-8, -1e-10, 1e-13, 1e-15, 0.0] {
        for symmetric in [false, true] {
            let mut a = random.symmetric_band(40, 5);
            shift_smallest(&mut a, smallest);
            let mut dense = Dense::new(40);
            (0..1600).for_each(|k| dense.set(k / 40, k % 40, a.get(k / 40, k % 40)));
            let mut band = Band::new(40, 5, 5);
            for j in 0..40usize {
                (j.saturating_sub(5)..(j + 6).min(40)).for_each(|i| band.set(i, j, a.get(i, j)));
            }
            let mut case = Case::new(&a, 1, &mut random, symmetric);
            let facts = case.check(&mut a, &mut random);
            let negative = negatives(&case.mat);
            let expected = symmetric.then_some((negative, 41 - negative));
            assert_eq!(facts.inertia, expected, "smallest {smallest:e}");
            case.check(&mut dense, &mut random);
            case.check(&mut band, &mut random);
        }
    }
}

#[test]
fn bordered_cores_of_rank_defect_up_to_four() {
    let mut random = Random(11);
    for m in (0..=4).cycle().take(100) {
        for noise in [0.0, 1e-16, 1e-15, 1e-14, 1e-9, 1.0] {
            // Diagonal with m small entries, hidden by reflections.
            let n = 20;
            let (p, q) = (random.vector(n), random.vector(n));
            let (pp, qq) = (
                2.0 / p.iter().map(|v| v * v).sum::<f64>(),
                2.0 / q.iter().map(|v| v * v).sum::<f64>(),
            );
            let reflect =
                |v: &[f64], s: f64, i: usize, k: usize| f64::from(i == k) - s * v[i] * v[k];
            let diagonal: Vec<f64> = (0..n)
                .map(|i| if i < m { noise * random.next() } else { 1.0 + random.next().abs() })
                .collect();
            let mut a = Dense::new(n);
            for j in 0..n {
                for i in 0..n {
                    let entry =
                        (0..n).map(|k| reflect(&p, pp, i, k) * diagonal[k] * reflect(&q, qq, k, j));
                    a.set(i, j, entry.sum());
                }
            }
            let mut case = Case::new(&a, m, &mut random, false);
            if m <= 1 || noise == 1.0 {
                case.check(&mut a, &mut random);
            } else {
                let facts = case.check_solutions(&mut a, &mut random);
                let sign = det_sign(&case.mat);
                assert!(facts.det_sign.is_none_or(|s| s == sign), "{facts:?}");
            }
        }
    }
    // Exactly zero.
    let mut zero = Dense::new(2);
    let mut case = Case::new(&zero, 2, &mut random, false);
    assert_eq!(case.check_solutions(&mut zero, &mut random).det_sign, None);
}

#[test]
fn scalar_cusp_at_its_fold() {
    for (b, c, d) in [(-1.0, 2.0, 0.0), (3e-6, 1e6, 0.5), (4.0, 0.25, -7.0)] {
        let (mut dense, mut band, mut symmetric) =
            (Dense::new(1), Band::new(1, 0, 0), SymmetricBand::new(1, 0));
        let run = |a: &mut dyn FnMut(&mut Bordered, &mut [f64], &mut [f64]) -> BorderedFacts| {
            let mut s = Bordered::new(1, 1);
            s.column_mut(0)[0] = b;
            s.row_mut(0)[0] = c;
            s.set_corner(0, 0, d);
            let (mut f, mut g) = ([6.0 * b], [5.0 * c + 6.0 * d]);
            let facts = a(&mut s, &mut f, &mut g);
            assert!((f[0] - 5.0).abs() <= 1e-14 && (g[0] - 6.0).abs() <= 1e-14, "{f:?} {g:?}");
            assert_eq!(facts.det_sign, Some(if b * c > 0.0 { -1 } else { 1 }));
        };
        run(&mut |s, f, g| {
            let facts = s.factor(&mut dense);
            s.solve(&mut dense, f, g);
            facts
        });
        run(&mut |s, f, g| {
            let facts = s.factor(&mut band);
            s.solve(&mut band, f, g);
            facts
        });
        run(&mut |s, f, g| {
            let facts = s.factor(&mut symmetric);
            s.solve(&mut symmetric, f, g);
            facts
        });
    }
}

#[test]
fn schur_complement_and_core_solutions() {
    let mut random = Random(12);
    let mut a = random.dense(8);
    let mut case = Case::new(&a, 1, &mut random, false);
    let facts = case.solver.factor(&mut a);
    let column: Vec<f64> = (0..8).map(|i| case.mat[(i, 8)]).collect();
    let row: Vec<f64> = (0..8).map(|i| case.mat[(8, i)]).collect();
    let core = to_mat(&a);
    let w = dense_solve(&core, &column);
    assert!(error(case.solver.core_column_solution(0), &w) < 1e-12);
    let v = dense_solve(&core.transpose().to_owned(), &row);
    assert!(error(case.solver.core_row_solution(0), &v) < 1e-12);
    let schur = case.mat[(8, 8)] - row.iter().zip(&w).map(|(c, w)| c * w).sum::<f64>();
    assert!((facts.schur - schur).abs() < 1e-12 * schur.abs());
    assert!(
        (facts.schur - case.mat.determinant() / core.determinant()).abs() < 1e-11 * schur.abs()
    );
}

#[test]
fn bordered_singular_matrix_has_no_sign() {
    let mut a = Dense::new(2);
    a.set(0, 0, 1.0);
    let mut s = Bordered::new(2, 1);
    s.column_mut(0)[0] = 1.0;
    s.row_mut(0)[0] = 1.0;
    s.set_corner(0, 0, 1.0);
    let facts = s.factor(&mut a);
    assert_eq!((facts.det_sign, facts.perturbed), (None, 1));
}

#[test]
fn bordered_scale_invariance() {
    let mut random = Random(13);
    for (smallest, rows, columns, border_column, border_row) in [
        (0.5, 1e12, 1.0, 1.0, 1.0),
        (0.0, 1e12, 1.0, 1.0, 1.0),
        (0.0, 1e-12, 1.0, 1.0, 1.0),
        (1e-9, 1.0, 1e6, 1e-6, 1.0),
        (1e-9, 1.0, 1e-6, 1.0, 1e6),
        (0.3, 1.0, 1.0, 1e6, 1e6),
        (0.0, 1e-12, 1.0, 1e6, 1e6),
    ] {
        let n = 30;
        let mut a = random.symmetric_band(n, 3);
        shift_smallest(&mut a, smallest);
        let case = Case::new(&a, 1, &mut random, false);
        let mut scaled = SymmetricBand::new(n, 3);
        scaled.axpy(rows * columns, &a);
        let mut solver = Bordered::new(n, 1);
        for i in 0..n {
            solver.column_mut(0)[i] = rows * case.mat[(i, n)] * border_column;
            solver.row_mut(0)[i] = border_row * case.mat[(n, i)] * columns;
        }
        solver.set_corner(0, 0, border_row * case.mat[(n, n)] * border_column);
        let rhs = random.vector(n + 1);
        let exact = dense_solve(&case.mat, &rhs);
        let mut f: Vec<f64> = rhs[..n].iter().map(|v| v * rows).collect();
        let mut g = [rhs[n] * border_row];
        let facts = solver.factor(&mut scaled);
        solver.solve(&mut scaled, &mut f, &mut g);
        let mut z: Vec<f64> = f.iter().map(|v| v * columns).collect();
        z.push(g[0] * border_column);
        assert!(error(&z, &exact) < 1e-11, "{:e} {facts:?}", error(&z, &exact));
        assert_eq!(facts.det_sign, Some(det_sign(&case.mat)));
        assert!(facts.core.growth <= MAX_GROWTH);
    }
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

    #[test]
    fn bordered_random_bands(seed in any::<u64>(), n in 4usize..40, m in 0usize..5) {
        let mut random = Random(seed);
        let mut a = random.band(n, 2, 3);
        let mut case = Case::new(&a, m, &mut random, false);
        let rhs = random.vector(n + m);
        let facts = case.solver.factor(&mut a);
        prop_assert_eq!(facts.det_sign, Some(det_sign(&case.mat)));
        let (mut f, mut g) = (rhs[..n].to_vec(), rhs[n..].to_vec());
        case.solver.solve(&mut a, &mut f, &mut g);
        let e = backward_error(&case.mat, &[f, g].concat(), &rhs);
        prop_assert!(e < 1e-13, "{:e}", e);
    }
}
