//! Equilibria against an independent solver of the same model (spherical unknowns, uniform cubic
//! B-splines, 800 elements).

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod support;
use shell_contact::{ContactProblem, Law};
use support::{contact, states_at, with_poisson};

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

const FIG05A: [f64; 6] = [
    9.365223474640798e-07,
    0.12705833333333336,
    1.5873015873015875e-06,
    0.002531645569620253,
    0.0,
    1.07,
];
const FIG05A_ROWS: [Row; 2] = [
    [
        0.995,
        0.05914725251231381,
        0.1270636672737349,
        4.188625868979656,
        0.991854894670952,
        2.493676940276769e-07,
        1.5995382409780787e-07,
        -2.0897632812126915e-07,
        4.3827290456806044e-10,
    ],
    [
        0.974,
        0.20188905872143859,
        0.1272618243630461,
        4.182530199733892,
        0.9482727091844028,
        1.7544448328168206e-06,
        3.061789429149241e-06,
        -2.5379633140434313e-07,
        6.365988420689333e-07,
    ],
];

const FIG07: [f64; 6] = [0.0027, 3.0, 0.002, 1.0 / 30.0, 0.0, 1.07];
const FIG07_ROWS: [Row; 2] = [
    [
        1.028,
        -0.11779449190610813,
        2.9992356822094255,
        4.189787823497245,
        1.0021104053356036,
        2.3425911201266062e-05,
        2.0319741444114462e-05,
        -0.0015689725218363771,
        3.8128018580312786e-07,
    ],
    [
        0.77,
        2.265262160962314,
        3.039182924520846,
        4.13829748150144,
        0.7378995789063064,
        0.017058443805272838,
        0.009191887661494173,
        -0.005656735075474679,
        0.0009850873969585983,
    ],
];

const FIG10: [f64; 6] = [0.0003, 0.003, 2e-06, 1.0 / 30.0, 0.0, 1.07];
const FIG10_ROWS: [Row; 2] = [
    [
        0.943,
        0.545507141683067,
        0.0030106488726785044,
        4.174941834537366,
        0.9294936726589984,
        0.0003538072254812052,
        0.0002265182040148184,
        4.60035480126587e-05,
        7.365052543244465e-08,
    ],
    [
        0.767,
        1.6954712149570499,
        0.0033195334065080242,
        3.810732227116938,
        0.5702643370808397,
        0.00307223526707334,
        0.004894164047616152,
        0.0001304065199162893,
        5.843059288056765e-05,
    ],
];

const FIG15: [f64; 6] = [0.0027, 3.0, 0.0002, 1.0 / 30.0, 0.0, 1.07];
const FIG15_ROWS: [Row; 2] = [
    [
        0.97,
        0.3307506681953559,
        3.0024887079525553,
        4.185545246168294,
        0.9521419588614541,
        0.0004459129332198293,
        0.00036730704470182426,
        -0.00012357013688629094,
        4.036797562576405e-06,
    ],
    [
        0.774,
        2.280489539511355,
        3.0361462866652973,
        4.142165548916512,
        0.7486650635042392,
        0.01580153033708776,
        0.007822665456298176,
        0.00013571455378892248,
        0.0008394000563406953,
    ],
];

const FIG16: [f64; 6] = [0.0027, 3.0, 0.02, 1.0 / 30.0, 0.0, 1.07];
const FIG16_ROWS: [Row; 3] = [
    [
        1.064,
        -1.4504696991967574,
        2.992012678568011,
        4.199239925300166,
        1.033109859549884,
        0.0033427358585381706,
        0.001712380321397919,
        -0.019778128534390753,
        4.176851148335529e-05,
    ],
    [
        0.892,
        -0.7595891176031333,
        3.0065044033672894,
        4.180320247708061,
        0.8584361002776171,
        0.0031830676632756886,
        0.009654469046180074,
        -0.04933713948138206,
        2.752677288932169e-05,
    ],
    [
        0.72,
        1.4796958933935629,
        3.0549418016877006,
        4.118343311512054,
        0.6870893072306301,
        0.025876820690138164,
        0.02088354164898022,
        -0.08145281351666284,
        0.0019239156048876382,
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
    check_shell(0.5, d, law, start, reference, tolerance, order);
}

fn check_shell(
    poisson: f64,
    d: [f64; 6],
    law: Law,
    start: f64,
    reference: &[Row],
    tolerance: f64,
    order: f64,
) {
    let meshes = [100, 200, 400].map(|n| rows(&with_poisson(n, law, poisson, d), start, reference));
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

#[test]
fn polymer_shell_of_elsner_fig_5() {
    check_shell(0.33, FIG05A, Law::Hooke, 1.005, &FIG05A_ROWS, 3e-6, 3.0);
}

#[test]
fn phospholipid_shell_fig_7() {
    check(FIG07, Law::MooneyRivlin { b: 1.0 }, 1.2, &FIG07_ROWS, 1e-6, 3.4);
}

#[test]
fn stiffer_bending_fig_10() {
    check(FIG10, Law::Hooke, 1.06, &FIG10_ROWS, 1e-6, 3.4);
}

#[test]
fn phospholipid_shell_weak_adhesion_fig_15() {
    check(FIG15, Law::MooneyRivlin { b: 1.0 }, 1.1, &FIG15_ROWS, 1e-6, 3.4);
}

#[test]
fn phospholipid_shell_strong_adhesion_past_snap_in_fig_16() {
    check(FIG16, Law::MooneyRivlin { b: 1.0 }, 1.3, &FIG16_ROWS, 1e-6, 3.4);
}

/// The physical parameters of Fig. 6 solved as a boundary-value problem by collocation
/// (AUTO-07p, 2e-7): z0, F, V/V0.
#[test]
fn collocation_of_the_boundary_value_problem_agrees() {
    let reference = [
        [1.05, -0.00148593, 1.00000104],
        [1.0, 0.13457528, 0.99982983],
        [0.98, 0.32646617, 0.99903857],
        [0.92, 0.60714769, 0.98421210],
        [0.83, 0.95594174, 0.92802034],
    ];
    let d = [(25.0_f64 / 1500.0).powi(2) / 9.0, 2.895e-3, 1e-4 / 52.5, 1.0 / 30.0, 0.0, 1.07];
    let problem = contact(400, Law::Hooke, d);
    let targets = reference.map(|r| r[0]);
    for ((u, _), [z0, force, ratio]) in states_at(&problem, 1.3, &targets).iter().zip(reference) {
        let o = problem.observation(u, &problem.parameters_at(z0)).unwrap();
        let v = o.volume * 3.0 / (4.0 * std::f64::consts::PI);
        let (df, dv) = (o.force - force, v - ratio);
        println!("z0 {z0}: force off by {df:.1e}, volume by {dv:.1e}");
        assert!(df.abs() < 3e-7 * force.abs().max(0.1) && dv.abs() < 2e-8);
    }
}
