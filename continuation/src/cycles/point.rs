//! What is known of one cycle: multipliers, stability, errors.

use super::floquet::Multiplier;

/// Index of the multiplier nearest to 1.
pub(super) fn trivial(all: &[Multiplier]) -> Option<usize> {
    let one = Multiplier { log_modulus: 0.0, argument: 0.0, error: 0.0 };
    let off = |m: &Multiplier| m.distance(&one);
    (0..all.len()).min_by(|a, b| off(&all[*a]).total_cmp(&off(&all[*b])))
}
