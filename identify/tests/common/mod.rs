//! Curves with known truth, and noise that is the same on every machine.

#![allow(dead_code, unreachable_pub, missing_docs, clippy::unwrap_used)]

use identify::data::{Curve, Direction, Layout, Segment, read};
use identify::fit::{Setup, objective::Prior};
use identify::model::Model;
use identify::{Key, LawName, Parameters};

/// A curve with its truth.
pub struct Known {
    pub curve: Curve,
    pub law: LawName,
    pub truth: Parameters,
    pub optical: Prior,
}

/// One of the shipped curves: name, law, χ, k_b, w0, δ_A, R0, optical R0, K, contact height.
pub fn open(which: usize) -> Known {
    let (name, text, law, values) = match which {
        1 => (
            "open-1.csv",
            include_str!("../data/open-1-hard-knee.csv"),
            LawName::Hooke,
            [37.4, 2.01129e-15, 2e-4, 20e-9, 1.62e-6, 1.58e-6, 1.2, 7.8030095e-6],
        ),
        2 => (
            "open-2.csv",
            include_str!("../data/open-2-soft-lipid.csv"),
            LawName::MooneyRivlin,
            [0.06, 4e-16, 2e-4, 40e-9, 1.4e-6, 1.44e-6, 0.06, 12.2588772e-6],
        ),
        _ => (
            "open-3.csv",
            include_str!("../data/open-3-soft-adhesive.csv"),
            LawName::MooneyRivlin,
            [0.045, 2.4e-16, 1.2e-3, 45e-9, 1.55e-6, 1.55e-6, 0.05, 13.6340636e-6],
        ),
    };
    let curve = read(name, text.as_bytes(), &Layout::default()).unwrap();
    let [chi, bending, adhesion, film, radius, optical, lever, contact] = values;
    let truth = parameters([chi, bending, adhesion, film, radius, lever, contact]);
    let optical = Prior { key: Key::Radius, value: optical, sd: 5e-8 };
    Known { curve, law, truth, optical }
}

/// χ, k_b, w0, δ_A, R0, K, contact height.
pub fn parameters(values: [f64; 7]) -> Parameters {
    use Key::{Adhesion, Bending, Chi, Contact, Film, Radius, SpringConstant};
    let keys = [Chi, Bending, Adhesion, Film, Radius, SpringConstant, Contact];
    let mut p = Parameters::default();
    for (key, value) in keys.into_iter().zip(values) {
        p[key] = value;
    }
    p
}

/// The true value of a quantity by its name.
pub fn truth(p: &Parameters, key: &str) -> f64 {
    identify::uncertainty::Quantity::of(key).unwrap().value(p)
}

impl Known {
    /// What a laboratory would ask: the lever known exactly, as it was when the curve was made.
    pub fn setup(&self) -> Setup {
        let mut base = Parameters::default();
        base[Key::SpringConstant] = self.truth[Key::SpringConstant];
        base[Key::Radius] = self.optical.value;
        let mut setup = Setup::new(self.law, base, vec![self.optical]);
        setup.spring_constant_sd = 0.0;
        setup
    }
}

/// Standard normal numbers from a seed.
pub struct Normal(pub u64);

impl Normal {
    /// The next number between 0 and 1.
    pub fn uniform(&mut self) -> f64 {
        // SplitMix64
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// The next number, by Box and Muller.
    pub fn next(&mut self) -> f64 {
        let (u, v) = (self.uniform().max(1e-300), self.uniform());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }
}

/// Heights of an approach and a retract, without forces.
pub fn heights(from: f64, to: f64, samples: usize) -> Curve {
    let line = |a: f64, b: f64| {
        (0..samples).map(|i| a + (b - a) * i as f64 / (samples - 1) as f64).collect::<Vec<f64>>()
    };
    let segment =
        |direction, height: Vec<f64>| Segment { direction, force: vec![0.0; height.len()], height };
    let segments = vec![
        segment(Direction::Approach, line(from, to)),
        segment(Direction::Retract, line(to, from)),
    ];
    Curve { name: "synthetic".to_owned(), segments, ..Curve::default() }
}

/// Fills a curve with the model's forces and noise.
pub fn fill(curve: &mut Curve, model: &Model, p: &Parameters, noise: f64, normal: &mut Normal) {
    let (branch, _) = model.branch(curve, p, &[]).unwrap();
    let force = model.predict(curve, &branch, p, &[], 1.0).force;
    let mut force = force.into_iter();
    for segment in &mut curve.segments {
        for f in &mut segment.force {
            *f = force.next().unwrap() + noise * normal.next();
        }
    }
}
