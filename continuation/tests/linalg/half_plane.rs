//! Eigenvalues to the right of the imaginary axis: against full spectra, and of matrices whose eigenvalues
//! are known by construction, far from normal and close to the axis.

use super::support::{Random, to_dense, to_mat};
use continuation::linalg::{Arrow, Band, Matrix, Sparse, count_right};

/// `None` where the full spectrum cannot decide.
fn by_spectrum(a: &Band, mass: Option<&Band>) -> Option<usize> {
    let full = |a: &Band| to_dense(&to_mat(a));
    let spectrum = full(a).spectrum_with_errors(mass.map(full).as_ref())?;
    let mut pairs = spectrum.values.iter().zip(&spectrum.errors);
    let certain = pairs.all(|((re, _), error)| re.abs() > *error);
    certain.then(|| spectrum.values.iter().filter(|(re, _)| *re > 0.0).count())
}

#[test]
fn counts_are_those_of_full_spectra() {
    let mut random = Random(1);
    let (mut compared, mut cost) = (0, 0);
    for k in 0..60 {
        let n = 5 + (150.0 * random.next().abs()) as usize;
        let mut a = random.band(n, 1 + k % 4, 1 + k % 4);
        let shift = 4.0 * random.next();
        (0..n).for_each(|i| a.add(i, i, shift));
        let count = count_right(&a, None).unwrap();
        cost += count.factorisations;
        if let Some(right) = by_spectrum(&a, None) {
            assert_eq!((count.right, count.critical), (right, false), "{k}");
            compared += 1;
        }
    }
    println!("{compared} of 60 compared, {} factorisations each", cost / 60);
    assert!(compared > 50);
}

#[test]
fn with_masses() {
    let mut random = Random(2);
    let mut compared = 0;
    for k in 0..40 {
        let n = 5 + (100.0 * random.next().abs()) as usize;
        let mut a = random.band(n, 1, 1);
        let mut mass = Band::new(n, 1, 1);
        for i in 0..n {
            a.add(i, i, -0.5);
            mass.set(i, i, 10f64.powf(2.0 * random.next() - 1.0));
        }
        for i in 1..n {
            let off = 0.3 * f64::min(mass.get(i, i), mass.get(i - 1, i - 1));
            mass.set(i, i - 1, off);
            mass.set(i - 1, i, off);
        }
        if let (Some(count), Some(right)) =
            (count_right(&a, Some(&mass)), by_spectrum(&a, Some(&mass)))
        {
            assert_eq!((count.right, count.critical), (right, false), "{k}");
            compared += 1;
        }
    }
    assert!(compared > 35, "{compared}");
}

/// `T D T⁻¹` with blocks `[re −im; im re]` on the diagonal of `D` and `T` of two layers of 2 × 2 blocks, each
/// of a condition up to `skew`.
fn known(random: &mut Random, pairs: &[(f64, f64)], skew: f64) -> Sparse {
    let n = 2 * pairs.len();
    let layers: Vec<Vec<[f64; 4]>> = (0..2)
        .map(|_| (0..n / 2).map(|_| [1.0, skew * random.next(), 0.0, 1.0]).collect())
        .collect();
    let apply = |layer: usize, inverse: bool, x: &mut [f64]| {
        for k in 0..(n - layer) / 2 {
            let i = 2 * k + layer;
            let [_, b, ..] = layers[layer][k];
            x[i] += if inverse { -b } else { b } * x[i + 1];
        }
    };
    let reach = |j: usize| (j.saturating_sub(8)..(j + 9).min(n)).map(move |i| (i, j));
    let pattern: Vec<(usize, usize)> = (0..n).flat_map(reach).collect();
    let mut a = Sparse::new(n, &pattern).unwrap();
    let mut x = vec![0.0; n];
    for j in 0..n {
        x.fill(0.0);
        x[j] = 1.0;
        apply(0, true, &mut x);
        apply(1, true, &mut x);
        for (pair, (re, im)) in x.chunks_exact_mut(2).zip(pairs) {
            (pair[0], pair[1]) = (re * pair[0] - im * pair[1], im * pair[0] + re * pair[1]);
        }
        apply(1, false, &mut x);
        apply(0, false, &mut x);
        for (i, x) in x.iter().enumerate().filter(|(_, x)| **x != 0.0) {
            a.set(i, j, *x).unwrap();
        }
    }
    a
}

/// Pairs close to the axis on both sides, some of them close together, among clusters of hundreds; `T` from
/// orthogonal to a condition of 1e8. What is said is right, and of the first two kinds it is always said.
#[test]
fn known_spectra_far_from_normal() {
    let mut random = Random(3);
    let mut said = 0;
    for k in 0..24 {
        let mut pairs: Vec<(f64, f64)> = (0..320)
            .map(|i| match (k + i) % 3 {
                // a cluster, a line, a cloud
                0 => (-1.0 - 1e-3 * random.next(), 2.0),
                1 => (-(i as f64) - 0.5, 0.0),
                _ => (-30.0 * random.next().abs() - 0.1, 40.0 * random.next()),
            })
            .collect();
        let near = 10f64.powf(-3.0 + 3.0 * random.next());
        let first = 5.0 + 30.0 * random.next().abs();
        for i in 0..(k % 7) {
            let side = if random.next() < 0.0 { -near } else { near };
            pairs[40 * i] = (side, first + 3.0 * near * i as f64);
        }
        let right = 2 * pairs.iter().filter(|(re, _)| *re > 0.0).count();
        let a = known(&mut random, &pairs, [0.0, 1.0, 10.0, 100.0][k % 4]);
        let count = count_right(&a, None).filter(|count| !count.critical);
        assert!(count.is_some() || k % 4 >= 2, "{k}: nothing is said");
        if let Some(count) = count {
            assert_eq!(count.right, right, "{k}, {near:e}");
            said += 1;
        }
    }
    println!("{said} of 24 said");
}

/// Pairs a distance of 1e-6 from the axis, on either side, two of them closer than a step.
#[test]
fn pairs_beside_the_axis() {
    for (first, second) in [(1e-6, 1e-6), (-1e-6, 1e-6), (-1e-6, -1e-6), (1e-6, 2e-6)] {
        let n = 700;
        let mut a = Band::new(n, 1, 1);
        for i in 0..n {
            a.set(i, i, -1.0 - i as f64);
        }
        for (at, re, im) in [(0, first, 50.0), (350, second, 50.0 + 1e-5)] {
            a.set(at, at, re);
            a.set(at + 1, at + 1, re);
            a.set(at, at + 1, im);
            a.set(at + 1, at, -im);
        }
        let right = 2 * [first, second].iter().filter(|re| **re > 0.0).count();
        assert_eq!(count_right(&a, None).map(|count| count.right), Some(right));
    }
}

#[test]
fn on_the_axis_is_on_neither_side() {
    let said = |a: &Band| count_right(a, None).map(|count| (count.right, count.critical));
    let mut a = Band::new(50, 1, 1);
    (0..50).for_each(|i| a.set(i, i, -1.0 - i as f64));
    a.set(7, 7, 0.0);
    assert_eq!(said(&a), Some((0, true)));
    a.set(7, 7, 1e-3);
    assert_eq!(said(&a), Some((1, false)));
    // a pair on the axis
    for (i, j, value) in [(20, 20, 0.0), (21, 21, 0.0), (20, 21, 3.0), (21, 20, -3.0)] {
        a.set(i, j, value);
    }
    assert_eq!(said(&a), Some((1, true)));
    let pair = count_right(&a, None).and_then(|count| count.pair).unwrap_or_default();
    assert!((pair - 3.0).abs() < 1e-6, "{pair}");
}

#[test]
fn full_rows_and_columns() {
    let n = 900;
    let mut a = Arrow::new(Band::new(n, 1, 1), 1);
    (0..n).for_each(|i| a.core_mut().set(i, i, -1.0 - (i % 7) as f64));
    a.column_mut(0).fill(1.0);
    a.row_mut(0).fill(0.1);
    a.set_corner(0, 0, 2.0);
    // λ − 2 = Σ 0.1/(λ + 1 + i % 7) has one positive root, all others are negative
    assert_eq!(count_right(&a, None).map(|count| count.right), Some(1));
}
