//! Counts along a traced branch, and where they change.
//!
//! Whatever holds the plates, the symmetric states of a shell lie on one curve in `(u, z0)`; the
//! modes looked for here do not feel the device. Between two points of the branch the curve is
//! parametrised by the distance along their chord, which does not mind folds: a state is found by
//! Newton's method in the plane across the chord, and a change of a count by bisection, sped up by
//! the secant of the eigenvalue that turns.

use super::{AsymmetricModes, ModeCount, ModeShape, Parity, Scan};
use crate::contact::{ContactProblem, parameter};
use crate::film::Potential;
use continuation::linalg::{Bordered, SymmetricBand};
use continuation::{Branch, EvalError, Problem};
use std::ops::ControlFlow;

/// Newton steps of a state between two points; quadratic convergence from a chord needs four.
const NEWTON_STEPS: usize = 12;

/// Size of a Newton step, in radii, that is rounding.
const CONVERGED: f64 = 1e-11;

/// Evaluations for one onset: plain bisection of a step of 0.05 to 1e-10 takes 29.
const EVALUATIONS: usize = 60;

/// Part of a step to which an onset beside a fold is enclosed, where `z0` does not tell.
const AT_FOLD: f64 = 1e-6;

/// How a branch is scanned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanSettings {
    /// The largest wave number that is examined.
    pub max_n: usize,
    /// Width in `z0` to which an onset is enclosed.
    pub tolerance: f64,
}

impl Default for ScanSettings {
    fn default() -> Self {
        ScanSettings { max_n: 40, tolerance: 1e-10 }
    }
}

/// A state at which a mode without the symmetries of the branch becomes unstable, or stable again.
#[derive(Debug, Clone, PartialEq)]
pub struct SymmetryBreaking {
    /// The branch's point before it; it lies between this one and the next.
    pub after_point: usize,
    /// Where between the two, from 0 to 1.
    pub share: f64,
    /// Plate distance.
    pub z0: f64,
    /// Unknowns of the contact problem.
    pub u: Vec<f64>,
    /// Waves around the axis.
    pub n: usize,
    /// Parity of the mode.
    pub parity: Parity,
    /// Unstable modes of this class before, along the branch.
    pub modes_before: usize,
    /// And after.
    pub modes_after: usize,
    /// Width in `z0` of the interval at whose ends the counts differ.
    pub error_estimate: f64,
    /// Eigenvalue of the mode at this state, zero but for the error.
    pub eigenvalue: f64,
    /// The mode.
    pub mode_shape: ModeShape,
}

/// A branch with what is unstable at each point beyond its own counts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scanned {
    /// One for each point of the branch that was reached.
    pub points: Vec<Scan>,
    /// Where a count changes, in order along the branch.
    pub events: Vec<SymmetryBreaking>,
    /// Changes between points that could not be enclosed: point before, `n`, parity.
    pub missed: Vec<(usize, usize, Parity)>,
}

/// Counts the unstable modes of every point of `branch` and locates the changes; `observer` is
/// told the number of points done and may end the work.
///
/// # Errors
/// When a point of the branch is no admissible state of the problem.
pub fn scan_branch<F: Potential>(
    problem: &ContactProblem<F>,
    branch: &Branch,
    settings: &ScanSettings,
    observer: &mut dyn FnMut(usize) -> ControlFlow<()>,
) -> Result<Scanned, EvalError> {
    let mut walk = Walk::new(problem);
    let mut scanned = Scanned::default();
    let height = branch.observables.iter().position(|name| name == "z0");
    let mut before: Option<(Vec<f64>, f64)> = None;
    for (index, point) in branch.points.iter().enumerate() {
        let z0 = height.map_or(point.p, |k| point.observables[k]);
        let u = &point.u[..problem.dim().min(point.u.len())];
        walk.modes.assemble(problem, u, &problem.parameters_at(z0))?;
        let scan = walk.modes.scan(settings.max_n);
        if let (Some((from, at)), Some(old)) = (&before, scanned.points.last()) {
            for (n, parity) in classes(old, &scan) {
                let counts = [class(old, n, parity), class(&scan, n, parity)];
                if counts[0].negative == counts[1].negative {
                    continue;
                }
                let chord = Chord { from, to: u, z0: [*at, z0], after_point: index - 1 };
                let ends = counts.map(|count| count.negative);
                let out = (&mut scanned.events, &mut scanned.missed);
                walk.locate(&chord, (n, parity), ends, settings, out);
            }
        }
        before = Some((u.to_vec(), z0));
        scanned.points.push(scan);
        if observer(index + 1).is_break() {
            break;
        }
    }
    scanned.events.sort_by(|a, b| {
        (a.after_point, a.share).partial_cmp(&(b.after_point, b.share)).unwrap_or(a.n.cmp(&b.n))
    });
    Ok(scanned)
}

/// All classes of two scans.
fn classes(a: &Scan, b: &Scan) -> impl Iterator<Item = (usize, Parity)> + use<> {
    let waves = a.n_max.max(b.n_max);
    let all = (1..=waves).flat_map(|n| Parity::BOTH.map(|parity| (n, parity)));
    std::iter::once((0, Parity::Antisymmetric)).chain(all)
}

/// The count of a class; beyond what was examined the bound says none.
fn class(scan: &Scan, n: usize, parity: Parity) -> ModeCount {
    if n == 0 {
        return ModeCount { negative: scan.antisymmetric, certain: scan.certain };
    }
    scan.count(n, parity).unwrap_or(ModeCount { negative: 0, certain: scan.certain })
}

/// Where in an enclosure a certain count is sought if that in the middle is not.
const ASIDE: [f64; 4] = [0.25, 0.75, 0.1, 0.9];

/// Two neighbouring points.
struct Chord<'a> {
    from: &'a [f64],
    to: &'a [f64],
    z0: [f64; 2],
    after_point: usize,
}

/// A state on the curve between them.
#[derive(Clone, Default)]
struct State {
    share: f64,
    z0: f64,
    u: Vec<f64>,
    count: usize,
    certain: bool,
    /// The eigenvalue nearest to zero.
    value: f64,
}

struct Walk<'a, F: Potential> {
    problem: &'a ContactProblem<F>,
    modes: AsymmetricModes<'a>,
    jacobian: SymmetricBand,
    bordered: Bordered,
    residual: Vec<f64>,
}

impl<'a, F: Potential> Walk<'a, F> {
    fn new(problem: &'a ContactProblem<F>) -> Self {
        let n = problem.dim();
        Walk {
            problem,
            modes: AsymmetricModes::new(problem.mesh()),
            jacobian: problem.new_jacobian(),
            bordered: Bordered::new(n, 1),
            residual: vec![0.0; n],
        }
    }

    /// Finds every change of the count of a class between two points.
    fn locate(
        &mut self,
        chord: &Chord<'_>,
        (n, parity): (usize, Parity),
        counts: [usize; 2],
        settings: &ScanSettings,
        (events, missed): (&mut Vec<SymmetryBreaking>, &mut Vec<(usize, usize, Parity)>),
    ) {
        let (mut from, target) = (0.0, counts[1]);
        let mut count = counts[0];
        // each pass encloses one state at which the count leaves its value; several in one step
        // are found one after the other
        for _ in 0..counts[0].max(counts[1]) + 2 {
            if count == target {
                return;
            }
            let ends = (from, count, target);
            let Some([lo, hi]) = self.enclose(chord, (n, parity), ends, settings) else { break };
            let state = if lo.value.abs() < hi.value.abs() { &lo } else { &hi };
            let p = self.problem.parameters_at(state.z0);
            if self.modes.assemble(self.problem, &state.u, &p).is_err() {
                break;
            }
            let mode = self.modes.nearest_zero(n, parity);
            events.push(SymmetryBreaking {
                after_point: chord.after_point,
                share: state.share,
                z0: state.z0,
                u: state.u.clone(),
                n,
                parity,
                modes_before: lo.count,
                modes_after: hi.count,
                error_estimate: (hi.z0 - lo.z0).abs().max(f64::EPSILON),
                eigenvalue: mode.value,
                mode_shape: mode.shape,
            });
            (from, count) = (hi.share, hi.count);
        }
        if count != target {
            missed.push((chord.after_point, n, parity));
        }
    }

    /// Two states close to each other, the first with the count at `ends.0`, the second without.
    fn enclose(
        &mut self,
        chord: &Chord<'_>,
        class: (usize, Parity),
        ends: (f64, usize, usize),
        settings: &ScanSettings,
    ) -> Option<[State; 2]> {
        let (from, count, target) = ends;
        let mut lo = self.state(chord, class, from)?;
        let mut hi = self.state(chord, class, 1.0)?;
        if lo.count != count || hi.count != target {
            return None;
        }
        let mut bisect = 0;
        for _ in 0..EVALUATIONS {
            let width = hi.share - lo.share;
            if (hi.z0 - lo.z0).abs() <= settings.tolerance && width < AT_FOLD || width < 1e-13 {
                return Some([lo, hi]);
            }
            let slope = (hi.value - lo.value) / width;
            let secant = lo.share - lo.value / slope;
            // beside the secant's zero, so that the next bracket is narrow on both sides
            let near = 0.25 * settings.tolerance / (chord.z0[1] - chord.z0[0]).abs().max(1e-9);
            let aim = if lo.value.abs() < hi.value.abs() { near } else { -near };
            let inside = |t: f64| t > lo.share && t < hi.share;
            let useful = lo.count.abs_diff(hi.count) == 1 && lo.value * hi.value < 0.0;
            let share = if useful && bisect < 2 && inside(secant + aim) {
                bisect += 1;
                secant + aim
            } else {
                bisect = 0;
                lo.share + 0.5 * width
            };
            let mut middle = self.state(chord, class, share)?;
            // beside the change a count may be rounding: certain ones on either side enclose it
            for aside in ASIDE {
                if middle.certain {
                    break;
                }
                middle = self.state(chord, class, lo.share + aside * width)?;
            }
            if !middle.certain {
                return Some([lo, hi]);
            }
            if middle.count == count {
                lo = middle;
            } else {
                hi = middle;
            }
        }
        None
    }

    /// The state at a share of the chord, with its count.
    fn state(
        &mut self,
        chord: &Chord<'_>,
        (n, parity): (usize, Parity),
        share: f64,
    ) -> Option<State> {
        let problem = self.problem;
        let at = |a: f64, b: f64| a + share * (b - a);
        let mut u: Vec<f64> = chord.from.iter().zip(chord.to).map(|(a, b)| at(*a, *b)).collect();
        let mut z0 = at(chord.z0[0], chord.z0[1]);
        // across the chord, in the metric of the continuation
        let along: Vec<f64> = chord.to.iter().zip(chord.from).map(|(b, a)| b - a).collect();
        let rise = chord.z0[1] - chord.z0[0];
        problem.metric(&along, self.bordered.row_mut(0));
        self.bordered.set_corner(0, 0, rise);
        let mut last = f64::INFINITY;
        for step in 0.. {
            let p = problem.parameters_at(z0);
            problem.linearise(&u, &p, &mut self.residual, &mut self.jacobian).ok()?;
            problem
                .parameter_derivative(&u, &p, parameter::Z0, self.bordered.column_mut(0))
                .ok()?;
            self.bordered.factor(&mut self.jacobian);
            let mut g = [0.0];
            self.bordered.solve(&mut self.jacobian, &mut self.residual, &mut g);
            let size = self.residual.iter().fold(g[0].abs(), |m, x| m.max(x.abs()));
            u.iter_mut().zip(&self.residual).for_each(|(u, d)| *u -= d);
            z0 -= g[0];
            if size < CONVERGED || (size < 1e2 * CONVERGED && size > 0.3 * last) {
                break;
            }
            if step == NEWTON_STEPS || !size.is_finite() {
                return None;
            }
            last = size;
        }
        self.modes.assemble(problem, &u, &problem.parameters_at(z0)).ok()?;
        let (count, value) = self.modes.count_and_value(n, parity);
        Some(State { share, z0, u, count: count.negative, certain: count.certain, value })
    }
}
