//! Bordered systems over regular, nearly singular and singular cores.

use continuation::linalg::{
    Band, Bordered, BorderedFacts, Dense, MAX_GROWTH, Matrix, Sparse, SymmetricBand,
};
use faer::Mat;
use proptest::prelude::*;

use crate::support::*;

/// The bordered matrix with random or given borders, dense.
pub(crate) struct Case {
    solver: Bordered,
    pub(crate) mat: Mat<f64>,
}

impl Case {
    pub(crate) fn new(a: &impl Matrix, m: usize, random: &mut Random, symmetric: bool) -> Self {
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
    pub(crate) fn check(&mut self, a: &mut impl Matrix, random: &mut Random) -> BorderedFacts {
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
    let mut tested = 0;
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
            if condition(&case.mat) > 1e4 {
                continue; // a forward error of 1e-11 is meant for regular matrices
            }
            tested += 1;
            if m <= 1 || noise == 1.0 {
                case.check(&mut a, &mut random);
            } else {
                let facts = case.check_solutions(&mut a, &mut random);
                let sign = det_sign(&case.mat);
                assert_eq!(facts.det_sign, Some(sign), "{facts:?}");
            }
        }
    }
    assert!(tested > 400, "{tested} cases");
    // Exactly zero.
    let mut zero = Dense::new(2);
    let mut case = Case::new(&zero, 2, &mut random, false);
    let exact = Some(det_sign(&case.mat));
    assert_eq!(case.check_solutions(&mut zero, &mut random).det_sign, exact);
}

/// `[0 b; c d] [5; 6]` is solved exactly.
fn check_scalar_cusp(mut a: impl Matrix) {
    for (b, c, d) in [(-1.0, 2.0, 0.0), (3e-6, 1e6, 1e-6), (4.0, 0.25, -7.0)] {
        let mut s = Bordered::new(1, 1);
        s.column_mut(0)[0] = b;
        s.row_mut(0)[0] = c;
        s.set_corner(0, 0, d);
        let facts = s.factor(&mut a);
        assert_eq!(facts.det_sign, Some(if b * c > 0.0 { -1 } else { 1 }));
        let (mut f, mut g) = ([6.0 * b], [5.0 * c + 6.0 * d]);
        s.solve(&mut a, &mut f, &mut g);
        assert!((f[0] - 5.0).abs() <= 1e-14 && (g[0] - 6.0).abs() <= 1e-14, "{f:?} {g:?}");
        let (mut f, mut g) = ([6.0 * c], [5.0 * b + 6.0 * d]);
        s.solve_transpose(&mut a, &mut f, &mut g);
        assert!((f[0] - 5.0).abs() <= 1e-14 && (g[0] - 6.0).abs() <= 1e-14, "{f:?} {g:?}");
    }
}

#[test]
fn scalar_cusp_at_its_fold() {
    check_scalar_cusp(Dense::new(1));
    check_scalar_cusp(Band::new(1, 0, 0));
    check_scalar_cusp(SymmetricBand::new(1, 0));
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

/// `copies` equal symmetric bands, interleaved, whose eigenvalue of smallest magnitude is moved to
/// `value(copy)`: a band of `copies` times the half-bandwidth that is singular so many times.
fn interleaved(random: &mut Random, copies: usize, value: impl Fn(usize) -> f64) -> SymmetricBand {
    let (n, kd) = (25, 2);
    let mut a = random.symmetric_band(n, kd);
    shift_smallest(&mut a, 0.0);
    let mut out = SymmetricBand::new(n * copies, kd * copies);
    for copy in 0..copies {
        for j in 0..n {
            for i in j..(j + kd + 1).min(n) {
                let shift = if i == j { value(copy) } else { 0.0 };
                out.add(i * copies + copy, j * copies + copy, a.get(i, j) + shift);
            }
        }
    }
    out
}

#[test]
fn cores_of_every_type_singular_two_and_three_times() {
    let mut random = Random(60);
    let mut tested = 0;
    for (copies, m) in [(1, 2), (2, 2), (1, 3), (2, 3), (3, 3)].into_iter().cycle().take(60) {
        for noise in [0.0, 1e-16, 1e-15, 1e-13, 1e-10, 1e-6, 1.0] {
            let factors = random.vector(copies);
            let mut symmetric = interleaved(&mut random, copies, |k| noise * factors[k]);
            let n = symmetric.dim();
            let kd = symmetric.half_bandwidth();
            let (mut band, mut dense) = (Band::new(n, kd, kd), Dense::new(n));
            let mut entries = Vec::new();
            for j in 0..n {
                entries.extend((j.saturating_sub(kd)..(j + kd + 1).min(n)).map(|i| (i, j)));
            }
            let mut sparse = Sparse::new(n, &entries).unwrap();
            for (i, j) in entries {
                let value = symmetric.get(i, j);
                band.set(i, j, value);
                dense.set(i, j, value);
                sparse.set(i, j, value).unwrap();
            }
            let same = random.next() > 0.0;
            let mut case = Case::new(&symmetric, m, &mut random, same);
            if condition(&case.mat) > 1e4 {
                continue;
            }
            tested += 1;
            let sign = det_sign(&case.mat);
            for facts in [
                case.check_solutions(&mut symmetric, &mut random),
                case.check_solutions(&mut band, &mut random),
                case.check_solutions(&mut dense, &mut random),
                case.check_solutions(&mut sparse, &mut random),
            ] {
                assert!(
                    facts.det_sign.is_none_or(|s| s == sign),
                    "{copies} {m} {noise:e} {facts:?}"
                );
                assert!(copies > 1 || facts.det_sign.is_some());
            }
        }
    }
    assert!(tested > 200, "{tested} cases");
}

/// Newton's matrix at a Hopf point: `A − i ω` is singular once, its real form twice.
#[test]
fn real_form_of_a_complex_matrix_that_is_singular() {
    let mut random = Random(61);
    for off in [0.0, 1e-15, 1e-12, 1e-8] {
        let n = 20;
        let mut a = random.band(n, 2, 2);
        let spectrum = to_dense(&to_mat(&a)).spectrum(None).unwrap();
        let (re, im) = spectrum.into_iter().find(|z| z.1 > 0.0).unwrap();
        a.add_identity(off - re);
        let mut imaginary = Band::new(n, 2, 2);
        imaginary.add_identity(-im);
        let mut form = a.complex(&imaginary).unwrap();
        let mut case = Case::new(&form, 2, &mut random, false);
        case.check_solutions(&mut form, &mut random);
        let dense = to_dense(&to_mat(&form));
        case.check_solutions(&mut dense.clone(), &mut random);
    }
}

/// A column of the border that is zero but for its corner, over a singular core: what a parameter
/// that does not act on a trivial solution leaves.
#[test]
fn columns_that_are_zero_but_for_their_corner() {
    let corner = |d: [[f64; 2]; 2], b: [[f64; 3]; 2], c: [[f64; 3]; 2], core: [f64; 3]| {
        let mut a = Dense::new(3);
        let mut solver = Bordered::new(3, 2);
        let mut mat = Mat::zeros(5, 5);
        for i in 0..3 {
            a.set(i, i, core[i]);
            mat[(i, i)] = core[i];
        }
        for k in 0..2 {
            solver.column_mut(k).copy_from_slice(&b[k]);
            solver.row_mut(k).copy_from_slice(&c[k]);
            (0..3).for_each(|i| (mat[(i, 3 + k)], mat[(3 + k, i)]) = (b[k][i], c[k][i]));
            for i in 0..2 {
                solver.set_corner(i, k, d[i][k]);
                mat[(3 + i, 3 + k)] = d[i][k];
            }
        }
        let facts = Case { solver, mat }.check(&mut a, &mut Random(5));
        assert!(facts.det_sign.is_some());
    };
    let zero = [0.0; 3];
    let [b, c] = [[1.0, 0.5, 0.2], [0.7, -0.3, 0.4]];
    // the singular core cured by the first border, the second column without entries beside it
    corner([[0.0, 5.0], [0.0, 1.0]], [b, zero], [c, c], [0.0, 2.0, 3.0]);
    corner([[0.0, 50.0], [0.0, 1.0]], [b, zero], [c, [0.1, 0.2, 0.3]], [0.0, 20.0, 30.0]);
    // the first column and its corner zero, its other end beside the second border
    corner([[0.0, 2.0], [3.0, 1.0]], [zero, b], [c, b], [1.0, 2.0, 3.0]);
}
