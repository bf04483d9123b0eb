//! No special point is lost because the number of unstable modes is uncertain, in any storage.

#![allow(clippy::unwrap_used, clippy::panic)]

use continuation::Stability;
use continuation::linalg::{Band, Sparse};

mod crossings;
mod kuramoto_sivashinsky;

use crossings::{Modes, Random, check, in_every_storage, random_problems, trace};

#[test]
fn several_crossings_in_a_step() {
    let mut c = vec![0.501, 0.511, 0.522, 0.533];
    c.extend((0..56).map(|i| 2.0 + 0.1 * f64::from(i)));
    in_every_storage(&c, &[Vec::new(), Vec::new()], "four in a step");
}

#[test]
fn crossings_beyond_the_target() {
    let mut c = vec![0.99, 1.002, 1.004, 1.006];
    c.extend((0..56).map(|i| 2.0 + 0.1 * f64::from(i)));
    in_every_storage(&c, &[Vec::new(), Vec::new()], "beyond the target");
}

#[test]
fn random_crossings() {
    random_problems(0..60);
}

/// At an exactly singular matrix six pivots vanish, and the column of the parameter as well.
#[test]
fn pivots_that_vanish_together() {
    random_problems(314..315);
}

/// Counts that change in vain in four places before two crossings in the last step.
#[test]
fn vain_searches_before_crossings() {
    random_problems(700..701);
}

#[test]
fn many_unstable_modes_take_bounded_work() {
    let mut random = Random(2);
    for unstable in [30, 199] {
        let mut c: Vec<f64> = (0..200).map(|_| 1.5 + random.next()).collect();
        c[..unstable].iter_mut().for_each(|c| *c = -0.1 - *c);
        c[199] = 0.5;
        let layers = random.layers(200, false);
        let branch = trace(&Modes::<Band>::new(&c, layers.clone()), 0.0, 1.0);
        check(&branch, &c, "band");
        check(&trace(&Modes::<Sparse>::new(&c, layers), 0.0, 1.0), &c, "sparse");
        assert!(branch.statistics.newton_iterations < 300, "{:?}", branch.statistics);
    }
    // an energy of the wrong sign
    let c: Vec<f64> = (0..400).map(|i| -0.1 - 0.01 * f64::from(i)).collect();
    let layers = random.layers(400, true);
    let mut hessian = Modes::<Sparse>::new(&c, layers);
    hessian.sense = Stability::EnergyHessian;
    check(&trace(&hessian, 0.0, 1.0), &c, "energy");
}
