use super::super::{Arrow, Band, Dense};
use super::*;

struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Of band matrices by their full spectra; what these cannot decide is left out.
fn check(a: &Band, mass: Option<&Band>, what: &str) -> Option<usize> {
    let full = |a: &Band| {
        let mut out = Dense::new(a.dim());
        a.entries(&mut |i, j, value| out.add(i, j, value));
        out
    };
    let count = count_right(a, mass)?;
    let spectrum = full(a).spectrum_with_errors(mass.map(full).as_ref())?;
    let certain = !count.critical
        && spectrum.values.iter().zip(&spectrum.errors).all(|((re, _), e)| re.abs() > *e);
    let right = spectrum.values.iter().filter(|(re, _)| *re > 0.0).count();
    if certain {
        assert_eq!(count.right, right, "{what}: {:?}", spectrum.values);
    }
    Some(count.factorisations)
}

fn random_band(random: &mut Random, n: usize, reach: usize, shift: f64) -> Band {
    let mut a = Band::new(n, reach, reach);
    for j in 0..n {
        for i in j.saturating_sub(reach)..(j + reach + 1).min(n) {
            a.set(i, j, random.between(-1.0, 1.0));
        }
        a.add(j, j, shift);
    }
    a
}

#[test]
fn counts_are_those_of_full_spectra() {
    let mut random = Random(1);
    let (mut said, mut cost) = (0, 0);
    for k in 0..60 {
        let n = 5 + (150.0 * random.between(0.0, 1.0)) as usize;
        let reach = 1 + k % 4;
        let shift = random.between(-4.0, 4.0);
        let a = random_band(&mut random, n, reach, shift);
        if let Some(factorisations) = check(&a, None, &format!("{k}")) {
            (said, cost) = (said + 1, cost + factorisations);
        }
    }
    println!("{said} of 60, {} factorisations each", cost / said);
    assert!(said == 60);
}

#[test]
fn with_masses() {
    let mut random = Random(2);
    let mut said = 0;
    for k in 0..40 {
        let n = 5 + (100.0 * random.between(0.0, 1.0)) as usize;
        let a = random_band(&mut random, n, 1, -0.5);
        let mut mass = Band::new(n, 1, 1);
        for i in 0..n {
            mass.set(i, i, 10f64.powf(random.between(-3.0, 1.0)));
        }
        for i in 1..n {
            let off = 0.3 * f64::min(mass.get(i, i), mass.get(i - 1, i - 1));
            mass.set(i, i - 1, off);
            mass.set(i - 1, i, off);
        }
        said += usize::from(check(&a, Some(&mass), &format!("{k}")).is_some());
    }
    assert!(said > 35, "{said}");
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
