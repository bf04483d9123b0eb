//! Exact spectra of spheres.

use crate::support::with_poisson;
use continuation::Matrix;
use shell_contact::density::Coefficients;
use shell_contact::film::NoFilm;
use shell_contact::membrane::Hooke;
use shell_contact::modes::{AsymmetricModes, Parity};
use shell_contact::{Law, Mesh, energy};

const NU: f64 = 0.3;
const KB: f64 = 1e-3;
const GAMMA: f64 = 0.05;

/// Spheroidal eigenvalues of order `l` of the stress-free sphere with surface tension, and the
/// toroidal one.
fn exact(l: usize) -> ([f64; 2], f64) {
    let n = (l * (l + 1)) as f64;
    let a = 1.0 / (1.0 - NU * NU);
    let big = n * (n - 1.0 + NU);
    // det [[a − μ, b], [b, d − μN]] = 0
    let (x, b, d) = (
        2.0 * (1.0 + NU) * a + KB * big + GAMMA * (n - 2.0),
        -(1.0 + NU) * n * a - KB * big,
        (a + KB) * big,
    );
    let (half, det) = (0.5 * (x + d / n), (x * d - b * b) / n);
    let root = (half * half - det).sqrt();
    // the smaller root without cancellation
    ([det / (half + root), half + root], (a + KB) * (1.0 - NU) * (n - 2.0) / 2.0)
}

#[test]
fn sphere_with_surface_tension_has_its_exact_spectrum_for_every_wave_number() {
    let problem = with_poisson(100, Law::Hooke, NU, [KB, 0.4, 0.0, 0.05, GAMMA, 1.3]);
    let mut modes = AsymmetricModes::new(problem.mesh());
    let u = problem.initial_state();
    modes.assemble(&problem, &u, &problem.parameters_at(1.5)).unwrap();
    let mut worst = 0.0_f64;
    for n in 0..=5 {
        for parity in Parity::BOTH {
            if n == 0 && parity == Parity::Symmetric {
                continue; // the half model's own: the gas takes part
            }
            let mut known = Vec::new();
            for l in n.max(1)..40_usize {
                let even = (l - n).is_multiple_of(2);
                let ([low, high], toroidal) = exact(l);
                if even == (parity == Parity::Symmetric) {
                    known.extend([low, high]);
                } else if n > 0 {
                    known.push(toroidal);
                }
            }
            known.sort_by(f64::total_cmp);
            let found =
                modes.spectrum(n, parity, 5).unwrap_or_else(|| panic!("n = {n}, {parity:?}"));
            for (found, known) in found.iter().zip(&known) {
                worst = worst.max((found - known).abs() / known.abs().max(1e-3));
            }
        }
    }
    assert!(worst < 2e-6, "{worst:e}");
}

/// The uniformly contracted sphere under external pressure, by Newton's method.
fn pressed(mesh: &Mesh, c: &Coefficients, pressure: f64) -> Vec<f64> {
    let law = Hooke { poisson: NU };
    let n = mesh.unknowns();
    let mut u = vec![0.0; n];
    let (mut r, mut v) = (vec![0.0; n], vec![0.0; n]);
    let mut j = continuation::linalg::SymmetricBand::new(n, 7);
    for _ in 0..8 {
        energy::volume_gradient(mesh, &u, &mut v).unwrap();
        r.iter_mut().zip(&v).for_each(|(r, v)| *r = pressure * v);
        j.set_zero();
        energy::add_linearisation(mesh, &u, &law, &NoFilm, c, -pressure, &mut r, &mut j).unwrap();
        j.factor(1e-300);
        j.solve(&mut r);
        u.iter_mut().zip(&r).for_each(|(u, r)| *u -= r);
    }
    u
}

/// A drop: where surface tension is everything, modes along the normal have `γ(l − 1)(l + 2)`. The
/// shell adds `2(1 + ν)/(1 − ν²)`, its resistance to a change of area, and less.
#[test]
fn sphere_under_much_surface_tension_oscillates_as_a_drop() {
    let gamma = 100.0;
    let problem = with_poisson(100, Law::Hooke, NU, [KB, 0.4, 0.0, 0.05, gamma, 1.3]);
    let mut modes = AsymmetricModes::new(problem.mesh());
    modes.assemble(&problem, &problem.initial_state(), &problem.parameters_at(1.5)).unwrap();
    for (n, l, parity) in [
        (1, 2.0, Parity::Antisymmetric),
        (2, 2.0, Parity::Symmetric),
        (0, 3.0, Parity::Antisymmetric),
    ] {
        let drop = gamma * (l - 1.0) * (l + 2.0) + 2.0 / (1.0 - NU);
        // tangential modes are as many as wavelengths allow, 20 apart
        let found = modes.spectrum(n, parity, 32).unwrap();
        let nearest = found.iter().map(|x| x - drop).min_by(|a, b| a.abs().total_cmp(&b.abs()));
        assert!(nearest.unwrap().abs() < 0.2, "n = {n}, l = {l}: {nearest:?}");
        assert!(*found.last().unwrap() > drop, "{}", found.last().unwrap());
    }
}

/// Determinant of the second variation of a sphere under external pressure `p` for the spherical
/// harmonic `l`, in closed form: displacement `(a P_l, b P_l')` along the normal and the meridian
/// of the sphere contracted by `λ`, `(λ² − 1)/(1 − ν) + p λ = 0`. With `L = l(l + 1)`, the mean
/// square of `P_l` taken as 1, `M = ∫ e_s e_φ` and `P_l''`, `cot S P_l'` integrated by parts.
fn determinant(l: usize, p: f64) -> f64 {
    let order = (l * (l + 1)) as f64;
    let half = 0.5 * p * (1.0 - NU);
    let stretch = (half * half + 1.0).sqrt() - half;
    let form = |a: f64, b: f64| {
        let (turn, trace) = ((a - b).powi(2), (2.0 * a - b * order).powi(2));
        let mixed = a * a - a * b * order + 0.5 * b * b * order;
        let squares = trace - 2.0 * mixed;
        let strain = stretch * stretch - 1.0;
        let membrane = (4.0 * stretch * stretch * (squares + 2.0 * NU * mixed)
            + 2.0 * (1.0 + NU) * strain * (squares + turn * order))
            / (8.0 * (1.0 - NU * NU));
        let bending = 0.5 * KB * turn / (stretch * stretch) * order * (order - 1.0 + NU);
        membrane + bending + p * stretch * (a * a + order * (0.5 * b * b - a * b))
    };
    let (aa, bb) = (form(1.0, 0.0), form(0.0, 1.0));
    let ab = 0.5 * (form(1.0, 1.0) - aa - bb);
    aa * bb - ab * ab
}

/// The pressure, in `4√k_b`, at which order `l` buckles.
fn buckling(l: usize) -> f64 {
    let unit = 4.0 * KB.sqrt();
    let (mut lo, mut hi) = (0.5, 1.7);
    assert!(determinant(l, lo * unit) > 0.0 && determinant(l, hi * unit) < 0.0);
    while hi - lo > 1e-14 {
        let middle = 0.5 * (lo + hi);
        if determinant(l, middle * unit) > 0.0 { lo = middle } else { hi = middle }
    }
    lo
}

/// Zoelly: the pressures of the orders `l` are those of every `n ≤ l` of the right class.
#[test]
fn pressed_sphere_buckles_at_zoellys_pressures_for_every_wave_number() {
    let mesh = Mesh::uniform(160).unwrap();
    let c = Coefficients {
        bending: KB,
        poisson: NU,
        b: 0.0,
        surface_tension: 0.0,
        adhesion: 0.0,
        film: 1.0,
        plate: 2.0,
    };
    let unit = 4.0 * KB.sqrt();
    let orders = [5, 4, 6, 7, 3].map(|l| (l, buckling(l)));
    // digits of an independent solver
    for ((_, found), known) in orders.iter().zip([0.968530, 1.019324, 1.054440, 1.243732]) {
        assert!((found - known).abs() < 6e-7, "{found} and {known}");
    }
    assert!((orders[4].1 - 1.295395476).abs() < 1e-9, "{}", orders[4].1);
    let mut modes = AsymmetricModes::new(&mesh);
    let mut total = |share: f64| -> Vec<[usize; 2]> {
        let u = pressed(&mesh, &c, share * unit);
        modes.assemble_with(&Hooke { poisson: NU }, &NoFilm, &c, -share * unit, &u).unwrap();
        (1..=8).map(|n| Parity::BOTH.map(|parity| modes.count(n, parity).negative)).collect()
    };
    for (k, &(_, at)) in orders.iter().enumerate() {
        for (side, passed) in [(-2e-6, k), (2e-6, k + 1)] {
            let counts = total(at + side);
            for n in 2..=8_usize {
                for (index, parity) in Parity::BOTH.into_iter().enumerate() {
                    let expected = orders[..passed]
                        .iter()
                        .filter(|(l, _)| {
                            *l >= n && (l - n).is_multiple_of(2) == (parity == Parity::Symmetric)
                        })
                        .count();
                    assert_eq!(counts[n - 1][index], expected, "n = {n}, {parity:?}, p = {at}");
                }
            }
        }
    }
}

/// Without a film every rigid motion is neutral; between plates without friction only translation
/// along them and the material's rotation are.
#[test]
fn neutral_modes_are_where_they_should_be_and_are_not_counted() {
    let free = with_poisson(80, Law::Hooke, NU, [KB, 0.4, 0.0, 0.05, GAMMA, 1.3]);
    let mut modes = AsymmetricModes::new(free.mesh());
    modes.assemble(&free, &free.initial_state(), &free.parameters_at(1.5)).unwrap();
    for (n, parity) in
        [(0, Parity::Antisymmetric), (1, Parity::Symmetric), (1, Parity::Antisymmetric)]
    {
        let lowest = modes.spectrum(n, parity, 1).unwrap()[0];
        assert!(lowest.abs() < 1e-9, "n = {n}, {parity:?}: {lowest:e}");
    }
    for n in 1..6 {
        for parity in Parity::BOTH {
            assert_eq!(modes.count(n, parity).negative, 0);
        }
    }
}
