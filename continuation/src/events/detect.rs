//! Which special points lie within a step, and whether the step is short enough to tell.

use super::Watch;
use super::hermite::Cubic;
use crate::name::Name;
use crate::step::{Refusal, State};

/// A special point somewhere within a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Candidate {
    /// dp/ds changes sign.
    Fold,
    /// The orientation, or the number of unstable modes without a fold, changes; so many modes
    /// become critical.
    BranchPoint { kernel: usize },
    /// The real part of a complex pair of eigenvalues changes sign.
    Hopf,
    /// A real eigenvalue passes infinity.
    Infinite,
    /// The number of unstable modes passes this level where the Jacobian is regular.
    Stability { level: f64 },
    /// On a curve of special points, a real eigenvalue beside the critical ones passes zero.
    RealEigenvalue,
    /// Observable `observable` crosses `level`.
    Value { observable: usize, level: f64, stop: bool },
    /// The slope of an observable changes sign.
    Extremum { observable: usize },
    /// The parameter takes a value.
    Parameter { value: f64, role: Role },
}

/// What becomes of a step that ends where the parameter stands still to rounding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Plateau {
    /// It is refused: a longer one may reach the other side.
    Refuse,
    /// The same, and the parameter is not expected to be resolved on the way.
    Cross,
    /// It is taken: the branch goes on like that.
    Enter,
}

/// Why the parameter's value matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// The trace ends: the target.
    Target,
    /// The trace ends: a bound of the domain.
    Bound,
    /// The user wants a point there.
    Landing,
}

impl Candidate {
    /// The test function whose zero the special point is.
    pub(crate) fn test(&self, x: &State, orientation: i8) -> f64 {
        match *self {
            Candidate::Fold => x.tp,
            Candidate::Hopf => x.pair,
            Candidate::RealEigenvalue => x.real,
            Candidate::Infinite => x.far,
            Candidate::Stability { level } => x.unstable.map_or(f64::NAN, |n| n as f64 - level),
            Candidate::BranchPoint { .. } => f64::from(x.orientation * orientation),
            Candidate::Value { observable, level, .. } => x.values[observable] - level,
            Candidate::Extremum { observable } => x.slopes[observable],
            Candidate::Parameter { value, .. } => x.p - value,
        }
    }

    /// Whether the trace ends at it.
    pub(crate) fn ends_trace(&self) -> bool {
        match self {
            Candidate::Value { stop, .. } => *stop,
            Candidate::Parameter { role, .. } => *role != Role::Landing,
            _ => false,
        }
    }

    /// Parameter values are met by solving at them; they do not disturb other events.
    fn is_singular(&self) -> bool {
        !matches!(self, Candidate::Parameter { .. })
    }
}

/// The functions watched on a branch.
#[derive(Debug, Clone)]
pub(crate) struct Detector {
    watched: Vec<Candidate>,
    // largest magnitude of each observable so far: below a tiny fraction of it is noise
    magnitude: Vec<f64>,
    found: Vec<Candidate>,
    // set where the branch consists of special points of another problem
    extended: Option<Beside>,
    // whether stability is read from another matrix than the Jacobian
    separate: bool,
    // how often shorter steps did not explain a change of an uncertain count
    futile: usize,
    // what the latest step leaves open
    doubt: Option<&'static str>,
    plateau: Plateau,
    // whether the step is about the shortest there is
    finest: bool,
}

/// Which eigenvalues beside the critical ones make an event when they cross the imaginary axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Beside {
    pub(crate) pair: bool,
    pub(crate) zero: bool,
}

/// Whether `a → b` passes zero; an exact zero belongs to the step that arrives at it.
fn crosses(a: f64, b: f64) -> bool {
    a * b < 0.0 || (b == 0.0 && a != 0.0)
}

/// A pair that is unstable at `b` only, where no eigenvalue of `a` is and none was computed.
fn appears(a: &State, b: &State) -> bool {
    let stable = |x: &State| x.pair.is_nan() && x.count == Some(0);
    (stable(a) && b.unstable_pairs == 1) || (stable(b) && a.unstable_pairs == 1)
}

/// A parameter's part of the tangent, relative to its range, below which the branch is vertical.
const VERTICAL: f64 = 1e-9;
/// Mismatch of a Hermite cubic above which the function is not resolved.
const MAX_MISMATCH: f64 = 0.35;
/// Changes smaller than this fraction of an observable's magnitude are not looked into.
const NEGLIGIBLE: f64 = 1e-7;
/// Changes of uncertain counts that are followed up in vain before they are only noted: each costs a
/// score of short steps.
const MOST_FUTILE: usize = 12;
/// Part of a step within which an extremum is at a pitchfork met from its side: far less than two
/// special points would be apart, far more than a cubic is wrong in a step that resolves both.
const SAME_PLACE: f64 = 0.02;
/// Rounding level of an observable relative to its magnitude.
const NOISE: f64 = 1e-12;

impl Detector {
    /// Resolves names to indices.
    ///
    /// # Errors
    /// The first unknown observable.
    pub(crate) fn new(
        watches: &[Watch],
        observables: &[Name],
        target: Option<f64>,
        domain: Option<(f64, f64)>,
        extended: Option<Beside>,
    ) -> Result<Self, String> {
        let index =
            |name: &String| observables.iter().position(|o| o == name).ok_or_else(|| name.clone());
        let mut watched = Vec::new();
        for watch in watches {
            watched.push(match watch {
                Watch::Value { observable, level, stop } => {
                    Candidate::Value { observable: index(observable)?, level: *level, stop: *stop }
                }
                Watch::Extremum { observable } => {
                    Candidate::Extremum { observable: index(observable)? }
                }
                Watch::Parameter { value } => {
                    Candidate::Parameter { value: *value, role: Role::Landing }
                }
            });
        }
        if let Some(value) = target {
            watched.push(Candidate::Parameter { value, role: Role::Target });
        }
        if let Some((lo, hi)) = domain {
            for value in [lo, hi].into_iter().filter(|bound| bound.is_finite()) {
                watched.push(Candidate::Parameter { value, role: Role::Bound });
            }
        }
        let found = Vec::with_capacity(watched.len() + 2);
        let magnitude = vec![0.0; observables.len()];
        Ok(Detector {
            watched,
            magnitude,
            found,
            extended,
            separate: false,
            futile: 0,
            doubt: None,
            plateau: Plateau::Refuse,
            finest: false,
        })
    }

    /// Says whether stability is read from another matrix than the Jacobian.
    pub(crate) fn with_separate_stability(self, separate: bool) -> Self {
        Detector { separate, ..self }
    }

    /// Says what becomes of steps onto a plateau of the parameter.
    pub(crate) fn set_plateau(&mut self, plateau: Plateau) {
        self.plateau = plateau;
    }

    /// Says whether the step is about the shortest there is: several pairs that cross within it are one
    /// point.
    pub(crate) fn set_finest(&mut self, finest: bool) {
        self.finest = finest;
    }

    /// The observables that are watched.
    pub(crate) fn observables(&self) -> impl Iterator<Item = usize> + '_ {
        self.watched.iter().filter_map(|candidate| match candidate {
            Candidate::Value { observable, .. } | Candidate::Extremum { observable } => {
                Some(*observable)
            }
            _ => None,
        })
    }

    /// Largest magnitude of each observable so far.
    pub(crate) fn magnitudes(&self) -> &[f64] {
        &self.magnitude
    }

    /// Sets the magnitudes of observables.
    pub(crate) fn set_magnitudes(&mut self, magnitude: Vec<f64>) {
        self.magnitude = magnitude;
    }

    /// Learns the magnitudes of observables from two successive states: one of them alone may lie
    /// next to a pole.
    pub(crate) fn learn(&mut self, a: &State, b: &State) {
        for (m, (a, b)) in self.magnitude.iter_mut().zip(a.values.iter().zip(&b.values)) {
            let both = a.abs().min(b.abs());
            if both.is_finite() {
                *m = m.max(both);
            }
        }
    }

    /// The special points between `a` and `b`, a scaled length `h` apart; `range` is the scale of
    /// the parameter. `final_say` takes the step as it is, where it is too short to be divided
    /// further.
    pub(crate) fn detect(
        &mut self,
        a: &State,
        b: &State,
        h: f64,
        range: f64,
        final_say: bool,
    ) -> Result<(), Refusal> {
        self.found.clear();
        self.doubt = None;
        let p = Cubic { h, g: [a.p, b.p], s: [a.tp, b.tp] };
        // where the parameter stands still to rounding, its turns are noise
        let still = [a, b].map(|x| x.tp.abs() < VERTICAL * range);
        let vertical = still == [true, true];
        let into_noise = b.tp.abs() < NOISE * range;
        let enters = still == [false, true] && self.plateau != Plateau::Enter;
        if enters && !final_say && self.extended.is_none() {
            return Err(Refusal::Plateau);
        }
        let fold = crosses(a.tp, b.tp) && !vertical && !into_noise;
        let resolved = self.plateau == Plateau::Cross || !self.parameter_unresolved(&p);
        if !final_say && !vertical && !resolved {
            return Err(Refusal::Unresolved);
        }
        if let Some(beside) = self.extended {
            self.detect_beside_critical(a, b, beside, final_say)?;
        } else {
            if fold {
                self.found.push(Candidate::Fold);
            }
            if !vertical {
                self.detect_crossings(a, b, fold, final_say)?;
            } else if a.count != b.count || a.orientation != b.orientation {
                // no parameter tells where
                self.doubt = Some(
                    "stability changes while the parameter stands still to rounding, where special \
                     points are not looked for",
                );
            }
            if self.separate {
                self.detect_stability(a, b, final_say)?;
            }
        }
        for k in 0..self.watched.len() {
            let candidate = self.watched[k];
            if self.is_hit(&candidate, (a, b), &p, fold, final_say)? {
                self.found.push(candidate);
            }
        }
        if final_say || !self.are_several() { Ok(()) } else { Err(Refusal::SeveralEvents) }
    }

    /// Whether something that is watched lies between the ends; `p` is the parameter between them, which turns in a
    /// `fold`.
    fn is_hit(
        &self,
        candidate: &Candidate,
        (a, b): (&State, &State),
        p: &Cubic,
        fold: bool,
        final_say: bool,
    ) -> Result<bool, Refusal> {
        let h = p.h;
        match *candidate {
            Candidate::Value { observable, level, .. } => {
                let cubic = self.cubic(a, b, observable, level, h);
                if !final_say
                    && cubic.may_vanish()
                    && self.unresolved(&cubic, observable, cubic.hides_zeros())
                {
                    return Err(Refusal::Unresolved);
                }
                let noise = NOISE * self.magnitude[observable];
                Ok(crosses(cubic.g[0], cubic.g[1])
                    && cubic.g[0].abs().max(cubic.g[1].abs()) > noise)
            }
            Candidate::Extremum { observable } => {
                let cubic = self.cubic(a, b, observable, 0.0, h);
                if !final_say && self.unresolved(&cubic, observable, cubic.hides_extrema()) {
                    return Err(Refusal::Unresolved);
                }
                let noise = 10.0 * NOISE * self.magnitude[observable];
                Ok(crosses(cubic.s[0], cubic.s[1])
                    && h * cubic.s[0].abs().max(cubic.s[1].abs()) > noise)
            }
            Candidate::Parameter { value, .. } => {
                let turns = || p.extrema().into_iter().flatten();
                // the start itself does not count
                Ok(crosses(a.p - value, b.p - value)
                    || fold && turns().any(|x| crosses(a.p - value, p.value(x) - value)))
            }
            Candidate::Fold
            | Candidate::BranchPoint { .. }
            | Candidate::Hopf
            | Candidate::RealEigenvalue
            | Candidate::Infinite
            | Candidate::Stability { .. } => Ok(false),
        }
    }

    /// Whether more than one singular point was found. A pitchfork met from its side is both a fold and a branch
    /// point, and an extremum of everything that is the same on its two sides.
    fn are_several(&self) -> bool {
        let singular = self.found.iter().filter(|c| c.is_singular()).count();
        let extremum = |c: &&Candidate| matches!(c, Candidate::Extremum { .. });
        let pitchfork = singular == 2 + self.found.iter().filter(extremum).count()
            && matches!(
                self.found[..],
                [Candidate::Fold, Candidate::BranchPoint { kernel: 1 }, ..]
            );
        singular > 1 && !pitchfork
    }

    /// Branch points and Hopf points, by what changes between the ends.
    fn detect_crossings(
        &mut self,
        a: &State,
        b: &State,
        fold: bool,
        final_say: bool,
    ) -> Result<(), Refusal> {
        let flip = a.orientation * b.orientation < 0;
        if a.critical != b.critical && a.certified && b.certified {
            // the special point at the start is not in the step; a step must not end on one
            return if a.critical || final_say { Ok(()) } else { Err(Refusal::OnSpecialPoint) };
        }
        let counts = a.count.zip(b.count).filter(|_| a.certified && b.certified);
        let Some((before, after)) = counts else {
            // nor is a count that is none at all: the orientation remains
            return self.detect_uncertain(a, b, fold, flip, final_say);
        };
        let change = before.abs_diff(after);
        // the count changes, no determinant vanishes: through infinity, where its reciprocal is small
        if a.pairs == b.pairs && change == 1 && !flip && !fold && crosses(a.far, b.far) {
            self.found.push(Candidate::Infinite);
            return Ok(());
        }
        // a pair that meets on the real axis on the way may have crossed the imaginary one
        // first, hidden by a fold; across a plateau the step cannot be shorter
        let across = self.plateau == Plateau::Cross && fold && change == 1;
        if change > 0 && a.pairs != b.pairs && !final_say && !across {
            return Err(Refusal::Stability);
        }
        let pairs = a.unstable_pairs.abs_diff(b.unstable_pairs);
        let hopf = if a.pairs == b.pairs {
            // a pair that crosses beside a fold or a branch point, or beside another pair
            let alone = pairs == 1 && change == 2 && !fold && !flip;
            let divided = if pairs > 1 && !fold && !flip { self.finest } else { final_say };
            if pairs > 0 && !alone && !divided {
                return Err(Refusal::Stability);
            }
            pairs > 0
        } else {
            change == 2 && !fold && !flip && (crosses(a.pair, b.pair) || appears(a, b))
        };
        if hopf {
            self.found.push(Candidate::Hopf);
        }
        let change = change.saturating_sub(if hopf { 2 * pairs.max(1) } else { 0 });
        if hopf && change == 0 && !flip {
            return Ok(());
        }
        let kernel = match (flip, fold) {
            (true, true) if change > 0 && !final_say => return Err(Refusal::Stability),
            (true, true) => 1,
            (true, false) => change.max(1),
            (false, true) if change != 1 && !final_say => return Err(Refusal::Stability),
            (false, true) => 0,
            (false, false) if change == 1 && !final_say => return Err(Refusal::Stability),
            (false, false) => change,
        };
        if kernel > 0 {
            self.found.push(Candidate::BranchPoint { kernel });
        }
        Ok(())
    }

    /// The same where the counts are lower bounds. The orientation is exact: it tells whether the
    /// number of real eigenvalues that pass zero, besides the one of a fold, is odd. Every other
    /// change of the counts is followed up by shorter steps, and doubted where these do not explain
    /// it.
    fn detect_uncertain(
        &mut self,
        a: &State,
        b: &State,
        fold: bool,
        flip: bool,
        final_say: bool,
    ) -> Result<(), Refusal> {
        let change = match (a.count, b.count) {
            (Some(before), Some(after)) => before.abs_diff(after),
            _ => usize::from(fold != flip),
        };
        let hopf = change == 2 && !fold && !flip && crosses(a.pair, b.pair);
        if hopf {
            self.found.push(Candidate::Hopf);
            return Ok(());
        }
        // (found by the orientation, explained by it)
        let (kernel, explained) = match (flip, fold) {
            // a pitchfork met from its side: its eigenvalue comes back
            (true, true) => (1, 0),
            (true, false) => (1, 1),
            (false, true) => (0, 1),
            // two together, or a pair whose eigenvalues are not among the few
            (false, false) if change == 2 => (2, 2),
            (false, false) => (0, 0),
        };
        // an eigenvalue that has left the few makes one less without passing zero
        let excess = change.saturating_sub(explained);
        if excess > 1 || (excess == 1 && kernel == 0 && !fold) {
            if !final_say && !self.is_futile() {
                return Err(Refusal::Stability);
            }
            self.doubt_count();
        }
        if kernel > 0 {
            self.found.push(Candidate::BranchPoint { kernel });
        }
        Ok(())
    }

    /// Changes of a stability that is not read from the Jacobian.
    fn detect_stability(&mut self, a: &State, b: &State, final_say: bool) -> Result<(), Refusal> {
        let (Some(before), Some(after)) = (a.unstable, b.unstable) else { return Ok(()) };
        if before.abs_diff(after) > 1 && !final_say {
            return Err(Refusal::SeveralEvents);
        }
        if before != after {
            let level = 0.5 * (before as f64 + after as f64);
            self.found.push(Candidate::Stability { level });
        }
        Ok(())
    }

    /// On a curve of special points: branch points of the curve, and eigenvalues beside the
    /// critical ones that cross the imaginary axis.
    fn detect_beside_critical(
        &mut self,
        a: &State,
        b: &State,
        beside: Beside,
        final_say: bool,
    ) -> Result<(), Refusal> {
        if a.orientation * b.orientation < 0 {
            self.found.push(Candidate::BranchPoint { kernel: 1 });
        }
        let change = match (a.count, b.count) {
            (Some(before), Some(after)) => before.abs_diff(after),
            _ => 0,
        };
        let pair = crosses(a.pair, b.pair) && a.pairs == b.pairs;
        let clear = match change {
            0 => true,
            1 => !pair,
            2 => pair,
            _ => false,
        };
        if !clear && beside.pair && a.certified && b.certified && !final_say {
            return Err(Refusal::Stability);
        }
        if beside.zero && change % 2 == 1 && crosses(a.real, b.real) {
            self.found.push(Candidate::RealEigenvalue);
        }
        if beside.pair && change >= 2 && pair {
            self.found.push(Candidate::Hopf);
        }
        Ok(())
    }

    /// Whether a watched value of the parameter is passed on the way from `a` to `fold`, and so is
    /// passed again, or not seen, in the same step.
    pub(crate) fn passes_before(&self, a: f64, fold: f64) -> bool {
        self.watched.iter().any(|candidate| match candidate {
            Candidate::Parameter { value, .. } => crosses(a - value, fold - value),
            _ => false,
        })
    }

    /// Whether uncertain counts were followed up in vain too often.
    pub(crate) fn is_futile(&self) -> bool {
        self.futile >= MOST_FUTILE
    }

    /// Notes that an uncertain count changes in the step and nothing explains it.
    pub(crate) fn doubt_count(&mut self) {
        self.futile += 1;
        self.doubt = Some(
            "the number of unstable modes, which is a lower bound here, changes without a special \
             point that explains it",
        );
    }

    /// Leaves a doubt about a branch point that was only bracketed.
    pub(crate) fn doubt_crossing(&mut self) {
        self.doubt = Some(
            "a branch point is bracketed, but no singular point was met in the bracket: two branches may \
             pass there, too close to tell which of them goes on",
        );
    }

    /// What the step may hide, if the latest [`Detector::detect`] could not tell.
    pub(crate) fn doubt(&self) -> Option<&'static str> {
        self.doubt
    }

    /// The first value of the parameter between `a` and `b` at which the trace ends.
    pub(crate) fn end_between(&self, a: f64, b: f64) -> Option<Candidate> {
        let ends = self.watched.iter().filter(|candidate| match candidate {
            Candidate::Parameter { value, role } => {
                *role != Role::Landing && crosses(a - value, b - value) && b != *value
            }
            _ => false,
        });
        let distance = |candidate: &Candidate| match candidate {
            Candidate::Parameter { value, .. } => (value - a).abs(),
            _ => f64::INFINITY,
        };
        ends.min_by(|x, y| distance(x).total_cmp(&distance(y))).copied()
    }

    /// Whether the observable, which has an extremum in the step from `a` to `b`, has it at the
    /// distance `at`, as far as values and slopes at the ends tell.
    pub(crate) fn is_extremal_at(&self, a: &State, b: &State, k: usize, h: f64, at: f64) -> bool {
        let extrema = self.cubic(a, b, k, 0.0, h).extrema();
        extrema.into_iter().flatten().any(|x| (x - at).abs() < SAME_PLACE * h)
    }

    /// What the latest [`Detector::detect`] found.
    pub(crate) fn found(&self) -> &[Candidate] {
        &self.found
    }

    fn cubic(&self, a: &State, b: &State, k: usize, level: f64, h: f64) -> Cubic {
        Cubic { h, g: [a.values[k] - level, b.values[k] - level], s: [a.slopes[k], b.slopes[k]] }
    }

    /// Two folds within one step, or a parameter that runs astray between its ends.
    fn parameter_unresolved(&self, p: &Cubic) -> bool {
        let negligible = 1e-6 * p.h * (p.s[0].abs() + p.s[1].abs());
        p.hides_extrema() || (p.mismatch() > MAX_MISMATCH && (p.g[1] - p.g[0]).abs() > negligible)
    }

    fn unresolved(&self, cubic: &Cubic, k: usize, hidden: bool) -> bool {
        let [g0, g1] = cubic.g;
        let size = cubic.change();
        let negligible = NEGLIGIBLE * self.magnitude[k].max(g0.abs()).max(g1.abs());
        size > negligible && (hidden || cubic.mismatch() > MAX_MISMATCH)
    }
}
