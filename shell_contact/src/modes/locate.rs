//! Where counts change between two points of a branch.
//!
//! The states between are parametrised by the distance along the chord, which does not mind folds:
//! each is found by Newton's method in the plane across the chord. A change is enclosed between two
//! states with different counts, by interpolation of the eigenvalue that turns where it helps and
//! by bisection where it does not. States are kept: every class that changes within the step begins
//! with what was computed for the others, and the two parities, which turn together above a few
//! waves, are evaluated at the same states.

use super::along::{ScanSettings, Scanned, SymmetryBreaking};
use super::{AsymmetricModes, ModeCount, ModeShape, Parity, WholeModes, WholeShell};
use crate::contact::ContactProblem;
use continuation::linalg::Bordered;
use continuation::{EvalError, ParamId, Problem};

/// Newton steps of a state between two points; quadratic convergence from a chord needs four.
const NEWTON_STEPS: usize = 12;

/// Size of a Newton step, in radii, that is rounding.
const CONVERGED: f64 = 1e-11;

/// Evaluations for one onset: plain bisection of a step of 0.05 to 1e-10 takes 29.
const EVALUATIONS: usize = 60;

/// Part of a step to which an onset beside a fold is enclosed, where `z0` does not tell.
const AT_FOLD: f64 = 1e-6;

/// Where in an enclosure a certain count is sought if that in the middle is not.
const ASIDE: [f64; 4] = [0.25, 0.75, 0.1, 0.9];

/// An interpolation has worked if the smaller eigenvalue of the enclosure falls by this factor;
/// otherwise the next step is a bisection. Regula falsi on a curved function gains less.
const GAIN: f64 = 8.0;

/// The parameter of the branch.
const PARAMETER: ParamId = ParamId(0);

/// States of a curve, and the modes about them.
pub(super) trait Counter {
    /// The problem whose states they are.
    type Problem: Problem;
    fn problem(&self) -> &Self::Problem;
    fn parameters_at(&self, value: f64) -> Vec<f64>;
    /// Takes a state.
    fn assemble(&mut self, u: &[f64], value: f64) -> Result<(), EvalError>;
    /// The count of a class and its eigenvalue nearest to zero, whose mode `x` becomes.
    fn count_and_value(&mut self, n: usize, parity: Parity, x: &mut Vec<f64>) -> (ModeCount, f64);
    /// The amplitudes of a mode and its parity.
    fn shape_of(&self, n: usize, parity: Parity, x: &[f64]) -> (ModeShape, Option<Parity>);
}

/// States of the half model: two classes for each number of waves.
pub(super) struct HalfCounter<'a> {
    pub(super) problem: &'a ContactProblem,
    pub(super) modes: AsymmetricModes<'a>,
}

impl Counter for HalfCounter<'_> {
    type Problem = ContactProblem;

    fn problem(&self) -> &ContactProblem {
        self.problem
    }

    fn parameters_at(&self, value: f64) -> Vec<f64> {
        self.problem.parameters_at(value)
    }

    fn assemble(&mut self, u: &[f64], value: f64) -> Result<(), EvalError> {
        self.modes.assemble(self.problem, u, &self.problem.parameters_at(value))
    }

    fn count_and_value(&mut self, n: usize, parity: Parity, x: &mut Vec<f64>) -> (ModeCount, f64) {
        self.modes.count_and_value(n, parity, x)
    }

    fn shape_of(&self, n: usize, parity: Parity, x: &[f64]) -> (ModeShape, Option<Parity>) {
        (self.modes.shape_of(n, parity, x), Some(parity))
    }
}

/// States of the whole meridian: one class, whose parity is that of the mode if it has one.
pub(super) struct WholeCounter<'a, P: WholeShell> {
    pub(super) problem: &'a P,
    pub(super) modes: WholeModes<'a>,
}

impl<P: WholeShell> Counter for WholeCounter<'_, P> {
    type Problem = P;

    fn problem(&self) -> &P {
        self.problem
    }

    fn parameters_at(&self, value: f64) -> Vec<f64> {
        self.problem.parameters_at(value)
    }

    fn assemble(&mut self, u: &[f64], value: f64) -> Result<(), EvalError> {
        let p = self.problem.parameters_at(value);
        self.problem.assemble_modes(u, &p, &mut self.modes)
    }

    fn count_and_value(&mut self, n: usize, _: Parity, x: &mut Vec<f64>) -> (ModeCount, f64) {
        self.modes.count_and_value(n, x)
    }

    fn shape_of(&self, n: usize, _: Parity, x: &[f64]) -> (ModeShape, Option<Parity>) {
        (self.modes.shape_of(n, x), self.modes.parity_of(x))
    }
}

/// Two neighbouring points.
pub(super) struct Chord<'a> {
    ends: [&'a [f64]; 2],
    z0: [f64; 2],
    after_point: usize,
    /// The chord in the metric of the continuation.
    normal: Vec<f64>,
}

impl<'a> Chord<'a> {
    /// From a point, the branch's number `after_point`, to the next.
    pub(super) fn new<P: Problem>(
        problem: &P,
        ends: [&'a [f64]; 2],
        z0: [f64; 2],
        after_point: usize,
    ) -> Chord<'a> {
        let along: Vec<f64> = ends[1].iter().zip(ends[0]).map(|(b, a)| b - a).collect();
        let mut normal = vec![0.0; along.len()];
        problem.metric(&along, &mut normal);
        Chord { ends, z0, after_point, normal }
    }

    fn rise(&self) -> f64 {
        self.z0[1] - self.z0[0]
    }
}

/// A class of modes whose count differs at the two points, and what is known of it between them.
pub(super) struct Class {
    n: usize,
    parity: Parity,
    counts: [usize; 2],
    /// By share.
    samples: Vec<Sample>,
    /// The last mode found, from which the next is sought.
    mode: Vec<f64>,
}

impl Class {
    /// With the counts at both points.
    pub(super) fn new(n: usize, parity: Parity, counts: [usize; 2]) -> Class {
        Class { n, parity, counts, samples: Vec::new(), mode: Vec::new() }
    }

    /// The samples around the first change after the share `from`, at which the count is `count`.
    fn bracket(&self, from: f64, count: usize) -> Option<usize> {
        let hi = self.samples.iter().position(|one| one.share > from && one.count != count)?;
        (hi > 0 && self.samples[hi - 1].share >= from).then(|| hi - 1)
    }

    /// The share at which the eigenvalue is expected to vanish between samples `at` and `at + 1`:
    /// from both and the nearer of their neighbours, if the eigenvalue is monotonic over the three.
    fn root(&self, at: usize) -> f64 {
        let [lo, hi] = [&self.samples[at], &self.samples[at + 1]];
        let secant = lo.share - lo.value * (hi.share - lo.share) / (hi.value - lo.value);
        let beyond = |x: &&Sample, near: &Sample, far: &Sample| {
            (x.value - near.value) * (near.value - far.value) > 0.0
        };
        let before = at.checked_sub(1).and_then(|k| self.samples.get(k));
        let before = before.filter(|x| beyond(x, lo, hi));
        let after = self.samples.get(at + 2).filter(|x| beyond(x, hi, lo));
        let third = match (before, after) {
            (Some(a), Some(b)) if lo.share - a.share > b.share - hi.share => Some(b),
            (a, b) => a.or(b),
        };
        let Some(third) = third else { return secant };
        // the share as a quadratic polynomial in the eigenvalue
        let points = [lo, hi, third];
        let mut root = 0.0;
        for (i, x) in points.iter().enumerate() {
            let others = points.iter().enumerate().filter(|(j, _)| *j != i);
            root += x.share * others.map(|(_, y)| -y.value / (x.value - y.value)).product::<f64>();
        }
        if root > lo.share && root < hi.share { root } else { secant }
    }
}

/// A class at a state.
#[derive(Clone)]
struct Sample {
    state: usize,
    share: f64,
    z0: f64,
    count: usize,
    /// The eigenvalue nearest to zero.
    value: f64,
    mode: Vec<f64>,
}

/// A state of the curve.
struct State {
    share: f64,
    z0: f64,
    u: Vec<f64>,
}

/// Finds changes of counts; its modes serve the points too.
pub(super) struct Locator<C: Counter> {
    pub(super) counter: C,
    jacobian: <C::Problem as Problem>::Jacobian,
    bordered: Bordered,
    residual: Vec<f64>,
    states: Vec<State>,
}

impl<C: Counter> Locator<C> {
    pub(super) fn new(counter: C) -> Self {
        let n = counter.problem().dim();
        Locator {
            jacobian: counter.problem().new_jacobian(),
            counter,
            bordered: Bordered::new(n, 1),
            residual: vec![0.0; n],
            states: Vec::new(),
        }
    }

    /// Finds every change of the counts of `classes` between two points, at the second of which the
    /// modes have just been assembled.
    pub(super) fn locate(
        &mut self,
        chord: &Chord<'_>,
        mut classes: Vec<Class>,
        settings: &ScanSettings,
        scanned: &mut Scanned,
    ) {
        self.states.clear();
        for end in [1, 0] {
            let state = State { share: end as f64, z0: chord.z0[end], u: chord.ends[end].to_vec() };
            let known = end == 1 || self.counter.assemble(&state.u, state.z0).is_ok();
            self.states.push(state);
            if known {
                for class in &mut classes {
                    // as it was counted, certain or not
                    self.sample(class, self.states.len() - 1);
                }
            }
        }
        for k in 0..classes.len() {
            let mut events = Vec::new();
            self.locate_class(chord, &mut classes[k..], settings, &mut events);
            let Class { n, parity, counts, .. } = classes[k];
            if events.last().map_or(counts[0], |event| event.modes_after) != counts[1] {
                scanned.missed.push((chord.after_point, n, parity));
            }
            scanned.events.append(&mut events);
        }
    }

    /// The changes of the first class; the second, if it has as many waves, is evaluated along.
    fn locate_class(
        &mut self,
        chord: &Chord<'_>,
        classes: &mut [Class],
        settings: &ScanSettings,
        events: &mut Vec<SymmetryBreaking>,
    ) {
        let counts = classes[0].counts;
        let (mut from, mut count) = (0.0, counts[0]);
        // each pass encloses one state at which the count leaves its value; several in one step
        // are found one after the other
        for _ in 0..counts[0].max(counts[1]) + 2 {
            if count == counts[1] {
                return;
            }
            let Some(at) = self.enclose(chord, classes, (from, count), settings) else { return };
            let class = &classes[0];
            let [lo, hi] = [&class.samples[at], &class.samples[at + 1]];
            let (nearer, other) = if lo.value.abs() < hi.value.abs() { (lo, hi) } else { (hi, lo) };
            let (shape, parity) = self.counter.shape_of(class.n, class.parity, &nearer.mode);
            events.push(SymmetryBreaking {
                after_point: chord.after_point,
                share: nearer.share,
                z0: nearer.z0,
                u: self.states[nearer.state].u.clone(),
                n: class.n,
                parity,
                modes_before: lo.count,
                modes_after: hi.count,
                error_estimate: (hi.z0 - lo.z0).abs().max(f64::EPSILON),
                other_end: (self.states[other.state].u.clone(), other.z0),
                eigenvalue: nearer.value,
                mode_shape: shape,
            });
            (from, count) = (hi.share, hi.count);
        }
    }

    /// Narrows the first change after `start`, a share and the count there, until its two samples,
    /// the one returned and the next, are close to each other.
    fn enclose(
        &mut self,
        chord: &Chord<'_>,
        classes: &mut [Class],
        start: (f64, usize),
        settings: &ScanSettings,
    ) -> Option<usize> {
        let (from, count) = start;
        let mut interpolate = true;
        for _ in 0..EVALUATIONS {
            let at = classes[0].bracket(from, count)?;
            let [lo, hi] = [&classes[0].samples[at], &classes[0].samples[at + 1]];
            let width = hi.share - lo.share;
            if (hi.z0 - lo.z0).abs() <= settings.tolerance && width < AT_FOLD || width < 1e-13 {
                return Some(at);
            }
            // just beyond the zero, so that the next enclosure is narrow on both sides
            let near = 0.25 * settings.tolerance / chord.rise().abs().max(1e-9);
            let aim = if lo.value.abs() < hi.value.abs() { near } else { -near };
            let guess = classes[0].root(at) + aim;
            // also where several turn nearly together, as those of both parities do
            let turns = lo.value * hi.value < 0.0;
            let useful = interpolate && turns && guess > lo.share && guess < hi.share;
            let start = lo.share;
            let smaller = lo.value.abs().min(hi.value.abs());
            let share = if useful { guess } else { start + 0.5 * width };
            let mut certain = self.evaluate(chord, classes, share)?;
            // beside the change a count may be rounding: certain ones on either side enclose it
            for aside in ASIDE {
                if certain {
                    break;
                }
                certain = self.evaluate(chord, classes, start + aside * width)?;
            }
            if !certain {
                return Some(at);
            }
            let at = classes[0].bracket(from, count)?;
            let [lo, hi] = [&classes[0].samples[at], &classes[0].samples[at + 1]];
            let now = lo.value.abs().min(hi.value.abs());
            interpolate = !useful || now * GAIN < smaller || hi.share - lo.share < 0.5 * width;
        }
        None
    }

    /// Samples the first class, and its other parity if that changes too, at a share; whether the
    /// first one's count is certain. `None` if there is no such state.
    fn evaluate(&mut self, chord: &Chord<'_>, classes: &mut [Class], share: f64) -> Option<bool> {
        let state = self.state(chord, share)?;
        self.states.push(state);
        let index = self.states.len() - 1;
        let (first, others) = classes.split_first_mut()?;
        if let Some(other) = others.first_mut().filter(|other| other.n == first.n) {
            self.sample(other, index);
        }
        Some(self.sample(first, index))
    }

    /// Samples a class at a state that has just been assembled. Inside the step an uncertain count
    /// is not kept.
    fn sample(&mut self, class: &mut Class, index: usize) -> bool {
        let State { share, z0, .. } = self.states[index];
        let (count, value) = self.counter.count_and_value(class.n, class.parity, &mut class.mode);
        let end = share == 0.0 || share == 1.0;
        if count.certain || end {
            let count = if end { class.counts[share as usize] } else { count.negative };
            let place = class.samples.partition_point(|one| one.share < share);
            let mode = class.mode.clone();
            class.samples.insert(place, Sample { state: index, share, z0, count, value, mode });
        }
        count.certain
    }

    /// The state at a share of the chord, its modes assembled.
    fn state(&mut self, chord: &Chord<'_>, share: f64) -> Option<State> {
        // between the two known states around it
        let known = |side: f64| {
            let on_side = self.states.iter().filter(move |one| side * (one.share - share) >= 0.0);
            on_side.min_by(|a, b| (a.share - share).abs().total_cmp(&(b.share - share).abs()))
        };
        let (a, b) = (known(-1.0)?, known(1.0)?);
        let part = if b.share > a.share { (share - a.share) / (b.share - a.share) } else { 0.0 };
        let mut u: Vec<f64> = a.u.iter().zip(&b.u).map(|(a, b)| a + part * (b - a)).collect();
        let mut z0 = a.z0 + part * (b.z0 - a.z0);
        self.bordered.row_mut(0).copy_from_slice(&chord.normal);
        self.bordered.set_corner(0, 0, chord.rise());
        let mut last = f64::INFINITY;
        let problem = self.counter.problem();
        for step in 0.. {
            let p = self.counter.parameters_at(z0);
            problem.linearise(&u, &p, &mut self.residual, &mut self.jacobian).ok()?;
            problem.parameter_derivative(&u, &p, PARAMETER, self.bordered.column_mut(0)).ok()?;
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
        self.counter.assemble(&u, z0).ok()?;
        Some(State { share, z0, u })
    }
}
