//! Work on the path of a cycle, by integration of the force over the plate's height.
//!
//! Between neighbouring points height and force are cubic Hermite polynomials of the arclength, with
//! the exact slopes of the discrete equilibria, and `∫F dz0` of the two is exact; a jump goes along
//! the device's line. A shell that differs from its mirror image may be given as its device holds it:
//! then the force is integrated over the device's parameter, `dΠ = −2√k_b F dp`, which a jump does
//! not change. Where a segment and its two halves differ, the curve's own state in the middle is
//! computed. The energies of the states are not used, so that a closed loop's area and the
//! energy dissipated by its jumps check each other.

use super::cycle::{Cycle, CyclePoint, Direction};
use super::walker::{Place, Tangent, Walker};
use super::{Device, Loading};
use continuation::EvalError;

/// Work done on the whole shell by both plates, in `χR0²`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Balance {
    /// On the way in, jumps included.
    pub approach: f64,
    /// On the way out.
    pub retract: f64,
    /// Their sum if the path is closed: `−2√k_b ∮F dz0`, positive if the loop dissipates.
    pub loop_area: Option<f64>,
    /// Estimated error of the sum.
    pub error_estimate: f64,
}

/// Differences of this part of the largest work are not pursued.
const NEGLIGIBLE: f64 = 1e-9;
/// Most halvings of a segment.
const DEEPEST: usize = 12;

/// The work on the path of a cycle of a shell under a grip, or held by the cycle's device if that is
/// no dead load: work is then that of the device's parameter.
///
/// # Errors
/// When the cycle is not one of this problem.
pub fn balance<P: Loading>(problem: &P, cycle: &Cycle) -> Result<Balance, EvalError> {
    let own = problem.device() != Device::Grip;
    let mut integral = Integral { walker: Walker::new(problem), own, tolerance: 0.0, error: 0.0 };
    let step = |pair: &[CyclePoint]| integral.height(&pair[1]) - integral.height(&pair[0]);
    let size: f64 = cycle.points.windows(2).map(|pair| (pair[0].force * step(pair)).abs()).sum();
    integral.tolerance = NEGLIGIBLE * size;
    let (mut approach, mut retract) = (0.0, 0.0);
    for (k, pair) in cycle.points.windows(2).enumerate() {
        let (a, b) = (&pair[0], &pair[1]);
        let jump = cycle.jumps.iter().find(|jump| jump.after == Some(k + 1));
        let part = match jump {
            Some(_) if own => 0.0,
            Some(jump) => cycle.device.work(jump.parameter, a.z0, b.z0),
            None => integral.between(a, b)?,
        };
        match b.direction {
            Direction::Approach => approach += part,
            Direction::Retract => retract += part,
        }
    }
    let unit = -2.0 * integral.walker.root();
    Ok(Balance {
        approach: unit * approach,
        retract: unit * retract,
        loop_area: cycle.closed.then_some(unit * (approach + retract)),
        error_estimate: unit.abs() * integral.error,
    })
}

struct Integral<'c, P: Loading> {
    walker: Walker<'c, P>,
    /// Whether the force is integrated over the device's parameter.
    own: bool,
    tolerance: f64,
    error: f64,
}

/// A place with its force and the curve's direction.
struct Node {
    place: Place,
    force: f64,
    tangent: Tangent,
}

impl<P: Loading> Integral<'_, P> {
    /// What the force is integrated over.
    fn height(&self, point: &CyclePoint) -> f64 {
        if self.own { point.parameter } else { point.z0 }
    }

    fn between(&mut self, a: &CyclePoint, b: &CyclePoint) -> Result<f64, EvalError> {
        let place = |p: &CyclePoint| Place { u: p.u.clone(), z0: self.height(p) };
        let (from, to) = (place(a), place(b));
        if self.walker.look_from_to(&from, &to) == 0.0 {
            return Ok(0.0);
        }
        let (at_a, at_b) = (self.walker.tangent(&from)?, self.walker.tangent(&to)?);
        let forces = (self.walker.force(&from)?, self.walker.force(&to)?);
        let a = Node { place: from, force: forces.0, tangent: at_a };
        let b = Node { place: to, force: forces.1, tangent: at_b };
        let whole = self.piece(&a, &b);
        self.refine(&a, &b, whole, 0)
    }

    /// Estimated length of the curve between two nodes.
    fn arc(&mut self, a: &Node, b: &Node) -> f64 {
        let chord = self.walker.look_from_to(&a.place, &b.place);
        let turn: Vec<f64> = a.tangent.du.iter().zip(&b.tangent.du).map(|(a, b)| b - a).collect();
        self.walker.look_along(&turn, b.tangent.dz0 - a.tangent.dz0);
        let turn = self.walker.size_of(&turn, b.tangent.dz0 - a.tangent.dz0);
        // an arc that turns by so much is that much longer than its chord
        chord * (1.0 + turn * turn / 24.0)
    }

    /// `∫F dz0` of the Hermite polynomials between two nodes.
    fn piece(&mut self, a: &Node, b: &Node) -> f64 {
        let arc = self.arc(a, b);
        let z = Cubic::new(a.place.z0, b.place.z0, arc * a.tangent.dz0, arc * b.tangent.dz0);
        let f = Cubic::new(a.force, b.force, arc * a.tangent.dforce, arc * b.tangent.dforce);
        // three points of Gauss are exact to degree five, the product's
        let x = 0.5 * 0.6_f64.sqrt();
        let at = |t: f64| f.value(t) * z.slope(t);
        (5.0 * at(0.5 - x) + 8.0 * at(0.5) + 5.0 * at(0.5 + x)) / 18.0
    }

    fn refine(&mut self, a: &Node, b: &Node, whole: f64, depth: usize) -> Result<f64, EvalError> {
        // the middle of the cubic through both
        let eighth = 0.125 * self.arc(a, b);
        let length = self.walker.look_from_to(&a.place, &b.place);
        let (ta, tb) = (&a.tangent, &b.tangent);
        let mix = |a: f64, b: f64, ta: f64, tb: f64| 0.5 * (a + b) + eighth * (ta - tb);
        let ends = a.place.u.iter().zip(&b.place.u);
        let mut place = Place {
            u: ends
                .zip(ta.du.iter().zip(&tb.du))
                .map(|((a, b), (s, t))| mix(*a, *b, *s, *t))
                .collect(),
            z0: mix(a.place.z0, b.place.z0, ta.dz0, tb.dz0),
        };
        let half = 0.5 * length * length;
        if self.walker.correct(&a.place, half, &mut place).is_none() {
            // at a branch point the tangent may be another branch's: from the middle of the chord
            let ends = a.place.u.iter().zip(&b.place.u);
            place.u = ends.map(|(a, b)| 0.5 * (a + b)).collect();
            place.z0 = 0.5 * (a.place.z0 + b.place.z0);
            if self.walker.correct(&a.place, half, &mut place).is_none() {
                let plain = 0.5 * (a.force + b.force) * (b.place.z0 - a.place.z0);
                self.error += (whole - plain).abs();
                return Ok(plain);
            }
        }
        let tangent = self.walker.tangent(&place)?;
        let force = self.walker.force(&place)?;
        let middle = Node { place, force, tangent };
        let halves = (self.piece(a, &middle), self.piece(&middle, b));
        let difference = halves.0 + halves.1 - whole;
        // fourth order: the halves err by a fifteenth of the difference
        if difference.abs() <= self.tolerance || depth >= DEEPEST {
            self.error += difference.abs() / 15.0;
            return Ok(halves.0 + halves.1 + difference / 15.0);
        }
        Ok(self.refine(a, &middle, halves.0, depth + 1)?
            + self.refine(&middle, b, halves.1, depth + 1)?)
    }
}

/// A cubic on `[0, 1]` from its values and slopes at the ends.
struct Cubic([f64; 4]);

impl Cubic {
    fn new(a: f64, b: f64, slope_a: f64, slope_b: f64) -> Self {
        let d = b - a;
        Cubic([a, slope_a, 3.0 * d - 2.0 * slope_a - slope_b, slope_a + slope_b - 2.0 * d])
    }

    fn value(&self, t: f64) -> f64 {
        let [c0, c1, c2, c3] = self.0;
        c0 + t * (c1 + t * (c2 + t * c3))
    }

    fn slope(&self, t: f64) -> f64 {
        let [_, c1, c2, c3] = self.0;
        c1 + t * (2.0 * c2 + t * 3.0 * c3)
    }
}
