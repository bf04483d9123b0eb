//! Shells whose measurements are drawn: noise, and what the laboratory knows.

use crate::common::{Normal, fill, heights, parameters, truth};
use identify::branch::Effort;
use identify::data::Curve;
use identify::fit::{Setup, objective::Prior};
use identify::model::Model;
use identify::record::Report;
use identify::{Key, LawName, Parameters, Profiles, identify};
use std::ops::Range;

pub(crate) const KEYS: [&str; 10] = [
    "young",
    "thickness",
    "sqrt_chi_kb",
    "chi",
    "bending",
    "adhesion",
    "film",
    "radius",
    "spring_constant",
    "contact",
];

pub(crate) struct Specimen {
    pub(crate) law: LawName,
    truth: Parameters,
    from: f64,
    to: f64,
    noise: f64,
}

/// The first open curve: a hard shell past its knee.
pub(crate) fn hard() -> Specimen {
    Specimen {
        law: LawName::Hooke,
        truth: measured(
            [37.4, 2.01129e-15, 2e-4, 20e-9, 1.62e-6, 1.2, 7.8030095e-6],
            [-3.1e-9, 0.9e-3],
        ),
        from: 8.6088e-6,
        to: 7.1178e-6,
        noise: 1.5e-10,
    }
}

/// The second: a soft one at its upturn.
pub(crate) fn soft() -> Specimen {
    Specimen {
        law: LawName::MooneyRivlin,
        truth: measured(
            [0.06, 4e-16, 2e-4, 40e-9, 1.4e-6, 0.06, 12.2588772e-6],
            [0.42e-9, 0.11e-3],
        ),
        from: 13.1598e-6,
        to: 11.2149e-6,
        noise: 5e-11,
    }
}

fn measured(shell: [f64; 7], [offset, tilt]: [f64; 2]) -> Parameters {
    let mut p = parameters(shell);
    (p[Key::Offset], p[Key::Tilt]) = (offset, tilt);
    p
}

impl Specimen {
    /// A measurement of it: the curve, and what the laboratory knows.
    pub(crate) fn measure(&self, seed: u64) -> (Curve, Setup) {
        let truth = self.truth;
        let mut normal = Normal(seed);
        // what the microscope and the calibration say has errors of its own
        let radius = truth[Key::Radius] * (0.03 * normal.next()).exp();
        let optical = Prior { key: Key::Radius, value: radius, sd: 0.03 * radius };
        let nominal = truth[Key::SpringConstant] * (0.1 * normal.next()).exp();
        let mut curve = heights(self.from, self.to, 600);
        let model = Model {
            law: self.law,
            contacts: 2,
            nominal_spring_constant: nominal,
            effort: Effort {
                elements: 160,
                points: 600,
                force_error: 1e-3 * self.noise,
                work: f64::INFINITY,
                max_angle: Effort::ANGLE,
            },
        };
        fill(&mut curve, &model, &truth, self.noise, &mut normal);
        let mut base = Parameters::default();
        base[Key::SpringConstant] = nominal;
        base[Key::Radius] = optical.value;
        (curve, Setup::new(self.law, base, vec![optical]))
    }

    /// Whether each interval holds the truth; an open end holds everything.
    fn inside(&self, report: &Report) -> [bool; KEYS.len()] {
        KEYS.map(|key| {
            let [low, high] = report.estimate(key).unwrap().interval95;
            let truth = truth(&self.truth, key);
            low.is_none_or(|low| low < truth) && high.is_none_or(|high| truth < high)
        })
    }

    /// By quantity, in how many of the seeds the interval held the truth.
    pub(crate) fn count(&self, seeds: Range<u64>) -> [u64; KEYS.len()] {
        let mut count = [0; KEYS.len()];
        for seed in seeds {
            let (curve, mut setup) = self.measure(seed);
            setup.start = Some(self.truth);
            let found = identify(&curve, &setup, &Profiles::WhereNeeded).unwrap();
            within_priors(&found.report);
            for ((key, count), inside) in
                KEYS.into_iter().zip(&mut count).zip(self.inside(&found.report))
            {
                *count += u64::from(inside);
                if !inside {
                    let estimate = found.report.estimate(key).unwrap();
                    let truth = truth(&self.truth, key);
                    let ends = estimate.interval95.map(|end| end.map(|end| end / truth));
                    println!("{:?} {seed}: {key} {ends:?} by {}", self.law, estimate.method);
                }
            }
        }
        count
    }
}

/// What was known beforehand is not forgotten: no interval is wider than its prior alone.
fn within_priors(report: &Report) {
    for key in ["radius", "spring_constant"] {
        let estimate = report.estimate(key).unwrap();
        let prior = estimate.prior.unwrap();
        let [low, high] = estimate.interval95.map(|end| end.unwrap());
        let widest = 2.0 * 1.96 * prior.sd / prior.value;
        assert!((high / low).ln() < 1.001 * widest, "{key}: {low:e} to {high:e}, {prior:?}");
    }
}

/// What lets the others start at the truth: by how many standard deviations at most the fit from a grid of starts
/// ends elsewhere.
pub(crate) fn apart(specimen: &Specimen, seed: u64) -> f64 {
    let (curve, mut setup) = specimen.measure(seed);
    let by_grid = identify(&curve, &setup, &Profiles::None).unwrap();
    setup.start = Some(specimen.truth);
    let by_truth = identify(&curve, &setup, &Profiles::None).unwrap();
    let off = KEYS.map(|key| {
        let [grid, truth] = [&by_grid, &by_truth].map(|found| found.report.estimate(key).unwrap());
        (grid.value - truth.value).abs() / truth.sd.unwrap()
    });
    let most = off.into_iter().fold(0.0, f64::max);
    let chi2 = [&by_grid, &by_truth].map(|found| found.report.quality.chi2_dof);
    println!("{:?} {seed}: {most:.3} sd, chi2/dof {chi2:?}", specimen.law);
    most
}
