//! Equilibria against an independent solver of the same model (spherical unknowns, uniform cubic
//! B-splines, 800 elements).

mod support;
use shell_contact::{ContactProblem, Law};
use support::{contact, states_at};

/// z0, F, P_G, V, pole, stretching, bending, film, gas
type Row = [f64; 9];

const FIG06: [f64; 6] = [3e-5, 3e-3, 2e-6, 1.0 / 30.0, 0.0, 1.07];
const FIG06_ROWS: [Row; 3] = [
    [
        0.962,
        0.4242218825306401,
        0.0030112470820793393,
        4.17416670137901,
        0.9160296271343054,
        5.465488867581998e-05,
        7.208959751102167e-05,
        1.0635226861107618e-05,
        8.213665086845219e-08,
    ],
    [
        0.864,
        0.8213704566137059,
        0.003156501438985822,
        3.9943734672905364,
        0.7218782959417751,
        0.0002473935082849229,
        0.0005292716567295277,
        2.126047932659001e-05,
        1.4963830229886874e-05,
    ],
    [
        0.766,
        1.2486074769674158,
        0.003504745049442609,
        3.6221932936591372,
        0.5362173344090942,
        0.0005315654568245235,
        0.0012118362070235988,
        3.2622397750781286e-05,
        0.0001358292625740409,
    ],
];

const FIG12: [f64; 6] = [3e-5, 3e-3, 2e-3, 1.0 / 30.0, 0.0, 1.07];
const FIG12_ROWS: [Row; 3] = [
    [
        0.841,
        1.166891660135655,
        0.0031523757450322375,
        3.999258925898105,
        0.7172284938044647,
        0.001779126800146321,
        0.0008398199772617189,
        -0.005727014450435923,
        1.4209331130758949e-05,
    ],
    [
        0.776,
        1.1972666819769715,
        0.0034474190061084273,
        3.6784547325135986,
        0.5501938932270198,
        0.00132791904438552,
        0.0011340308527015906,
        -0.0048004006634947555,
        0.00010905277772892045,
    ],
    [
        0.68,
        1.8401799053145844,
        0.004114788041824668,
        3.1177393966129565,
        0.3547923570705477,
        0.0015320784643659316,
        0.0018530671798345786,
        -0.0046000436960010075,
        0.0005363643233293802,
    ],
];

const FIG18A: [f64; 6] = [2.7e-3, 3.0, 2e-3, 1.0 / 30.0, 0.08, 1.07];
const FIG18A_ROWS: [Row; 2] = [
    [
        1.027,
        -0.11693357730909087,
        3.15921327015264,
        4.189765077637986,
        1.0011906050711388,
        1.1624425457105467e-05,
        1.2488744355220954e-05,
        -0.001558332084501358,
        -0.00015559614467790923,
    ],
    [
        0.768,
        4.173203617640426,
        3.2083376116225715,
        4.129780276422319,
        0.7403341237894892,
        0.019038902702639873,
        0.007275283183101704,
        -0.004718673396261689,
        0.010860807161922803,
    ],
];

fn rows(problem: &ContactProblem, start: f64, reference: &[Row]) -> Vec<Row> {
    let targets: Vec<f64> = reference.iter().map(|r| r[0]).collect();
    let states = states_at(problem, start, &targets);
    states
        .iter()
        .zip(targets)
        .map(|((u, negative), z0)| {
            assert_eq!(*negative, 0);
            let o = problem.observation(u, &problem.parameters_at(z0)).unwrap();
            [
                z0,
                o.force,
                o.gas_pressure,
                o.volume,
                o.pole_height,
                o.energy_stretching,
                o.energy_bending,
                o.energy_film,
                o.energy_gas,
            ]
        })
        .collect()
}

fn worst(a: &Row, b: &Row) -> f64 {
    a.iter().zip(b).fold(0.0, |m, (a, b)| m.max(((a - b) / b).abs()))
}

fn check(d: [f64; 6], law: Law, start: f64, reference: &[Row], tolerance: f64, order: f64) {
    let meshes = [100, 200, 400].map(|n| rows(&contact(n, law, d), start, reference));
    for (k, expected) in reference.iter().enumerate() {
        let e = [0, 1, 2].map(|m| worst(&meshes[m][k], expected));
        let difference = |m: usize| (meshes[m][k][1] - meshes[m + 1][k][1]).abs();
        let observed = (difference(0) / difference(1)).log2();
        println!(
            "z0 {}: errors {:.1e} {:.1e} {:.1e}, order {observed:.2}",
            expected[0], e[0], e[1], e[2]
        );
        assert!(e[2] < tolerance, "z0 = {}: {:?} vs {expected:?}", expected[0], meshes[2][k]);
        assert!(observed > order, "z0 = {}: order {observed}", expected[0]);
    }
}

#[test]
fn polymer_shell_weak_adhesion_fig_6() {
    check(FIG06, Law::Hooke, 1.06, &FIG06_ROWS, 1e-6, 3.4);
}

#[test]
fn hard_shell_strong_adhesion_past_two_folds_fig_12() {
    check(FIG12, Law::Hooke, 1.15, &FIG12_ROWS, 3e-6, 3.4);
}

#[test]
fn phospholipid_shell_with_surface_tension_fig_18() {
    check(FIG18A, Law::MooneyRivlin { b: 1.0 }, 1.2, &FIG18A_ROWS, 1e-6, 3.4);
}
