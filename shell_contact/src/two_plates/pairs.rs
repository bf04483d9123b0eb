//! Asymmetric states as two springs in series.
//!
//! The two contacts of a shell see each other through the gas and the stress across the equator
//! alone, so that a state without mirror symmetry is nearly two halves of symmetric ones that carry
//! the same force, `F(ζ_a) = F(ζ_b)`, at the distance `ζ_a + ζ_b`. Seen over `ζ`, these are the points
//! at which the curve `F(ζ)` crosses its own mirror image about `ζ = z0`, other than the symmetric
//! states that lie on the mirror. Where the curve has several branches over one `ζ`, they include states
//! that no branch point of the symmetric curve leads to.

use super::TwoPlatesProblem;
use continuation::Branch;

/// Two states of a symmetric branch with the same force.
#[derive(Debug, Clone, PartialEq)]
pub struct SpringPair {
    /// Distances of the upper plate and of the lower from the equator, the upper one the smaller.
    pub plates: [f64; 2],
    /// The force that both carry.
    pub force: f64,
    /// A guess of the asymmetric state, for Newton's method.
    pub u: Vec<f64>,
}

/// All pairs at half the distance `z0`, from a branch of
/// [`ContactProblem`](crate::ContactProblem) in `z0` on the same mesh and with the same plate on
/// both sides, interpolated linearly between its points; in the order in which their first states
/// stand on the branch. The mirror image of each is a pair too and left out. Empty if the branch
/// has no observable `force`, or is not one in `z0`.
pub fn spring_pairs(problem: &TwoPlatesProblem, symmetric: &Branch, z0: f64) -> Vec<SpringPair> {
    let force = symmetric.observables.iter().position(|name| name == "force");
    let Some(force) = force.filter(|_| symmetric.parameter == "z0") else { return Vec::new() };
    let points = &symmetric.points;
    let place = |k: usize| (points[k].p, points[k].observables[force]);
    let mut pairs = Vec::new();
    for i in 1..points.len() {
        for k in i + 1..points.len() {
            let curve = [place(i - 1), place(i)];
            let image = [place(k - 1), place(k)].map(|(z, f)| (2.0 * z0 - z, f));
            let Some(shares) = crossing(curve, image) else { continue };
            let at = |end: usize, share: f64, value: &dyn Fn(usize) -> f64| {
                value(end - 1) + share * (value(end) - value(end - 1))
            };
            let along = |end: usize, share: f64| -> (f64, Vec<f64>) {
                let unknowns = points[end].u.len().min(points[end - 1].u.len());
                let u = (0..unknowns).map(|j| at(end, share, &|k| points[k].u[j])).collect();
                (at(end, share, &|k| points[k].p), u)
            };
            let mut states = [along(i, shares[0]), along(k, shares[1])];
            states.sort_by(|a, b| a.0.total_cmp(&b.0));
            let plates = [states[0].0, states[1].0];
            let shift = 0.5 * (plates[1] - plates[0]);
            pairs.push(SpringPair {
                plates,
                force: at(i, shares[0], &|k| place(k).1),
                u: problem.joined(&states[0].1, &states[1].1, shift),
            });
        }
    }
    pairs
}

/// Where two segments cross, as shares of either in `[0, 1)`: an end that two segments have in common
/// counts once.
fn crossing(a: [(f64, f64); 2], b: [(f64, f64); 2]) -> Option<[f64; 2]> {
    let (da, db) = ((a[1].0 - a[0].0, a[1].1 - a[0].1), (b[1].0 - b[0].0, b[1].1 - b[0].1));
    let between = (b[0].0 - a[0].0, b[0].1 - a[0].1);
    let det = da.0 * db.1 - da.1 * db.0;
    // parallel, to rounding of the products
    if det.abs() <= 1e-14 * (da.0.hypot(da.1) * db.0.hypot(db.1)) {
        return None;
    }
    let shares =
        [(between.0 * db.1 - between.1 * db.0) / det, (between.0 * da.1 - between.1 * da.0) / det];
    shares.iter().all(|share| (0.0..1.0).contains(share)).then_some(shares)
}

#[cfg(test)]
mod tests {
    use super::crossing;

    #[test]
    fn segments_cross_once() {
        let cross = |a, b| crossing(a, b);
        let (o, x, y, xy) = ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0));
        assert_eq!(cross([o, xy], [x, y]), Some([0.5, 0.5]));
        assert_eq!(cross([o, x], [y, xy]), None);
        assert_eq!(cross([o, x], [(2.0, -1.0), (2.0, 1.0)]), None);
        // the end belongs to the next segment
        assert_eq!(cross([o, x], [(1.0, -1.0), xy]), None);
        assert_eq!(cross([x, (2.0, 0.0)], [(1.0, -1.0), xy]), Some([0.0, 0.5]));
    }
}
