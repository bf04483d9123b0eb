//! Fits a curve and prints what is known of it.
//!
//! `cargo run --release --example fit_curve -- CURVE.csv hooke 1.2 1.58e-6 5e-8`: file, law, stiffness of the
//! lever in N/m, radius and its standard deviation in m.
#![allow(clippy::print_stdout)]

use identify::data::{Layout, read};
use identify::fit::{Setup, objective::Prior};
use identify::{Key, LawName, Parameters, Profiles, identify};
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, law, lever, radius, sd] = arguments.as_slice() else {
        return Err("expected: CURVE.csv LAW LEVER RADIUS SD".into());
    };
    let curve = read(file, &std::fs::read(file)?, &Layout::default())?;
    let law = LawName::of(law).ok_or("a law is hooke, mooney-rivlin or skalak")?;
    let mut known = Parameters::default();
    known[Key::SpringConstant] = lever.parse()?;
    known[Key::Radius] = radius.parse()?;
    let optical = Prior { key: Key::Radius, value: known[Key::Radius], sd: sd.parse()? };
    let setup = Setup::new(law, known, vec![optical]);
    for profiles in [Profiles::None, Profiles::WhereNeeded] {
        let start = Instant::now();
        let report = identify(&curve, &setup, &profiles)?.report;
        let seconds = start.elapsed().as_secs_f64();
        println!("{profiles:?}: {seconds:.2} s, {} evaluations", report.cost.evaluations);
        for e in report.derived.iter().chain(&report.parameters).filter(|e| e.method != "fixed") {
            println!("{:12} {:.4e} {} {:?}", e.key, e.value, e.unit, e.verdict);
        }
    }
    Ok(())
}
