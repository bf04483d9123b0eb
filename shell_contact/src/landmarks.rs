//! Landmarks of a force curve that are no bifurcations: its knee, and the first contact.
//!
//! * **Knee.** With `f(z0) = −dF/dz0` at fixed groups, exact from the tangent of the state, the first state past
//!   zero force at which `f` is half of its largest value since zero force. That largest value is the slope of the
//!   first contact (Reissner's, once the film is as thin as it gets): the cap gives way where it has fallen to half.
//!   There is no knee where the plate turns back before: then a fold ends the first contact.
//! * **Contact.** The first state at which the film above the pole is as thin as its potential's minimum,
//!   `z0 − z(0) = δ_A`: outside the film attracts the pole, inside it repels. `contact_radius` begins there.
//!
//! Both are located on a branch that was traced, under whatever device: equilibria are the same under all of them.
//! The contact may lie beside a fold, so that its plate is an unknown: Newton's method on `R(u, z0) = 0` and
//! `z0 − z(0) − δ_A = 0`, by block elimination.

use crate::contact::{ContactProblem, parameter};
use crate::device::Device;
use continuation::{Branch, Detail, EvalError, Event, EventKind, Matrix, Point, Problem};

/// Name of the special point at which the slope of the force has fallen to half.
pub const KNEE: &str = "knee";
/// Name of the special point at which the film at the pole turns from attraction to repulsion.
pub const CONTACT: &str = "contact";

/// Which landmarks are located.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Wanted {
    /// The knee.
    pub knee: bool,
    /// The first contact.
    pub contact: bool,
}

/// Newton steps at most; from an interpolated state three do.
const STEPS: usize = 12;
/// A correction after which the next is rounding.
const SHORT: f64 = 1e-11;
/// Evaluations of the slope at most, of its maximum and of its half each.
const EVALUATIONS: usize = 40;
/// Width of the bracket, in `R0`, at which a knee is located.
const WIDTH: f64 = 1e-12;
/// The smaller part of a golden section.
const GOLDEN: f64 = 0.381_966_011_250_105;

/// A state between two points of a branch.
struct State {
    u: Vec<f64>,
    z0: f64,
    slope: f64,
    force: f64,
    residual: f64,
    correction: f64,
}

/// Locates what is wanted on a branch of `problem` that was traced under `device`, and puts it among its points and
/// special points.
///
/// # Errors
/// When a state of the branch is not admissible, which none is that was traced.
pub fn locate(
    problem: &ContactProblem,
    device: Device,
    branch: &mut Branch,
    wanted: Wanted,
) -> Result<(), EvalError> {
    let mut found = Vec::new();
    if wanted.contact {
        found.extend(contact(problem, branch)?.map(|(k, state, error)| (k, state, error, CONTACT)));
    }
    if wanted.knee {
        found.extend(knee(problem, branch)?.map(|(k, state, error)| (k, state, error, KNEE)));
    }
    // from the end, so that the numbers of the points before stay
    found.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.z0.total_cmp(&b.1.z0)));
    for (after, state, error, name) in found {
        insert(problem, device, branch, (after, &state, error), name)?;
    }
    Ok(())
}

/// Half the distance of the plates at a point, whatever the continued parameter is.
fn height(branch: &Branch, point: &Point) -> f64 {
    let at = branch.observables.iter().position(|name| name == "z0");
    at.map_or(point.p, |k| point.observables[k])
}

fn observed(branch: &Branch, point: &Point, name: &str) -> f64 {
    let at = branch.observables.iter().position(|own| own == name);
    at.map_or(f64::NAN, |k| point.observables[k])
}

/// The solver of one problem.
struct Solver<'p> {
    problem: &'p ContactProblem,
    residual: Vec<f64>,
    tangent: Vec<f64>,
    hessian: <ContactProblem as Problem>::Jacobian,
}

impl<'p> Solver<'p> {
    fn new(problem: &'p ContactProblem) -> Self {
        let zero = vec![0.0; problem.dim()];
        let hessian = problem.new_jacobian();
        Solver { problem, residual: zero.clone(), tangent: zero, hessian }
    }

    /// `H v = R` and `H t = −R_z0` at a state: `v` goes to `residual`, `t` to `tangent`; returns `max |R|`.
    fn linearise(&mut self, u: &[f64], z0: f64) -> Result<f64, EvalError> {
        let at = self.problem.parameters_at(z0);
        self.problem.linearise(u, &at, &mut self.residual, &mut self.hessian)?;
        let largest = self.residual.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
        self.hessian.factor(f64::EPSILON * self.hessian.norm());
        self.hessian.solve(&mut self.residual);
        self.problem.parameter_derivative(u, &at, parameter::Z0, &mut self.tangent)?;
        self.hessian.solve(&mut self.tangent);
        self.tangent.iter_mut().for_each(|t| *t = -*t);
        Ok(largest)
    }

    /// The state of a plate at `z0` next to `u`, with its slope; `None` where Newton's method does not converge.
    fn held(&mut self, mut u: Vec<f64>, z0: f64) -> Result<Option<State>, EvalError> {
        for _ in 0..STEPS {
            let Ok(residual) = self.linearise(&u, z0) else { return Ok(None) };
            let correction = longest(&self.residual);
            if !correction.is_finite() {
                return Ok(None);
            }
            u.iter_mut().zip(&self.residual).for_each(|(u, v)| *u -= v);
            if correction < SHORT {
                return self.state(u, z0, residual, correction).map(Some);
            }
        }
        Ok(None)
    }

    /// The state next to `u` and `z0` at which the film above the pole is `film` thick.
    fn at_film(
        &mut self,
        mut u: Vec<f64>,
        mut z0: f64,
        film: f64,
    ) -> Result<Option<State>, EvalError> {
        let pole = |solver: &Self, u: &[f64], z0: f64, du: &[f64]| {
            // the pole's height is the second observable, and linear in the unknowns
            let at = solver.problem.parameters_at(z0);
            let slope = solver.problem.observable_slope(1, u, &at, parameter::Z0, du, 0.0)?;
            Ok::<f64, EvalError>(slope.unwrap_or(f64::NAN))
        };
        for _ in 0..STEPS {
            let Ok(residual) = self.linearise(&u, z0) else { return Ok(None) };
            let at = self.problem.parameters_at(z0);
            let miss = z0 - self.problem.observation(&u, &at)?.pole_height - film;
            // u changes by −v + t dz: miss + dz + pole(v) − pole(t) dz = 0
            let by_residual = pole(self, &u, z0, &self.residual)?;
            let by_plate = 1.0 - pole(self, &u, z0, &self.tangent)?;
            let step = -(miss + by_residual) / by_plate;
            let change = |(v, t): (&f64, &f64)| -v + t * step;
            let correction: Vec<f64> =
                self.residual.iter().zip(&self.tangent).map(change).collect();
            let size = longest(&correction).max(step.abs());
            if !size.is_finite() {
                return Ok(None);
            }
            u.iter_mut().zip(&correction).for_each(|(u, du)| *u += du);
            z0 += step;
            if size < SHORT {
                return self.state(u, z0, residual, size).map(Some);
            }
        }
        Ok(None)
    }

    fn state(
        &self,
        u: Vec<f64>,
        z0: f64,
        residual: f64,
        correction: f64,
    ) -> Result<State, EvalError> {
        let at = self.problem.parameters_at(z0);
        // the force is the first observable
        let slope = self.problem.observable_slope(0, &u, &at, parameter::Z0, &self.tangent, 1.0)?;
        let slope = -slope.unwrap_or(f64::NAN);
        let force = self.problem.observation(&u, &at)?.force;
        Ok(State { u, z0, slope, force, residual, correction })
    }
}

fn longest(x: &[f64]) -> f64 {
    x.iter().fold(0.0_f64, |m, x| if x.is_nan() { f64::NAN } else { m.max(x.abs()) })
}

/// The unknowns of the shell at a share of the way between two points.
fn between(dim: usize, a: &Point, b: &Point, share: f64) -> Vec<f64> {
    a.u[..dim].iter().zip(&b.u).map(|(a, b)| a + share * (b - a)).collect()
}

/// What is found: the number of the point before, the state, the error of its plate's height.
type Found = Option<(usize, State, f64)>;

fn contact(problem: &ContactProblem, branch: &Branch) -> Result<Found, EvalError> {
    let film = problem.groups().film;
    let gap = |point: &Point| height(branch, point) - observed(branch, point, "pole_height") - film;
    let first = branch.points.windows(2).position(|w| gap(&w[0]) > 0.0 && gap(&w[1]) <= 0.0);
    let Some(k) = first else { return Ok(None) };
    let (a, b) = (&branch.points[k], &branch.points[k + 1]);
    let share = gap(a) / (gap(a) - gap(b));
    let (from, to) = (height(branch, a), height(branch, b));
    let u = between(problem.dim(), a, b, share);
    let found = Solver::new(problem).at_film(u, from + share * (to - from), film)?;
    Ok(found.map(|state| {
        let error = state.correction.max(f64::EPSILON);
        (k, state, error)
    }))
}

fn knee(problem: &ContactProblem, branch: &Branch) -> Result<Found, EvalError> {
    let points = &branch.points;
    let kind = EventKind::Zero("force".to_owned());
    let Some(zero) = branch.events_of(&kind).next().map(|event| event.point) else {
        return Ok(None);
    };
    let mut solver = Solver::new(problem);
    let mut slope_at = |point: &Point| -> Result<f64, EvalError> {
        let u = &point.u[..problem.dim()];
        let z0 = height(branch, point);
        solver.linearise(u, z0)?;
        let at = problem.parameters_at(z0);
        let slope = problem.observable_slope(0, u, &at, parameter::Z0, &solver.tangent, 1.0)?;
        Ok(-slope.unwrap_or(f64::NAN))
    };
    let mut slopes: Vec<f64> = Vec::new();
    let mut largest = 0;
    for k in zero..points.len() {
        // the first contact ends where the plate turns back
        if k > zero && height(branch, &points[k]) >= height(branch, &points[k - 1]) {
            return Ok(None);
        }
        slopes.push(slope_at(&points[k])?);
        let last = slopes.len() - 1;
        if !slopes[last].is_finite() {
            return Ok(None);
        }
        if slopes[last] > slopes[largest] {
            largest = last;
        } else if last > largest && slopes[last] <= 0.5 * slopes[largest] {
            break;
        }
    }
    let last = slopes.len() - 1;
    if slopes[largest] <= 0.0 || slopes[last] > 0.5 * slopes[largest] {
        return Ok(None);
    }
    // the maximum lies in one of the steps beside the largest of the points
    let (low, high) = (zero + largest.saturating_sub(1), zero + (largest + 1).min(last));
    let place = |k: usize| height(branch, &points[k]);
    let state = |solver: &mut Solver<'_>, z0: f64, near: (usize, usize)| {
        // the plate goes down from point to point
        let k = (near.0..near.1).rev().find(|k| place(*k) >= z0).unwrap_or(near.0);
        let share = (place(k) - z0) / (place(k) - place(k + 1));
        solver.held(between(problem.dim(), &points[k], &points[k + 1], share), z0)
    };
    let mut top = slopes[largest];
    if high > low {
        let (mut a, mut b) = (place(high), place(low));
        let slope = |solver: &mut Solver<'_>, z0| {
            state(solver, z0, (low, high)).map(|s| s.map_or(f64::NAN, |s| s.slope))
        };
        let (mut x, mut y) = (a + GOLDEN * (b - a), b - GOLDEN * (b - a));
        let (mut at_x, mut at_y) = (slope(&mut solver, x)?, slope(&mut solver, y)?);
        // a maximum is flat: half of the digits of its place are all of its value
        while (b - a) > WIDTH.sqrt() && at_x.is_finite() && at_y.is_finite() {
            if at_x > at_y {
                (b, y, at_y) = (y, x, at_x);
                x = a + GOLDEN * (b - a);
                at_x = slope(&mut solver, x)?;
            } else {
                (a, x, at_x) = (x, y, at_y);
                y = b - GOLDEN * (b - a);
                at_y = slope(&mut solver, y)?;
            }
        }
        top = [at_x, at_y].into_iter().filter(|s| s.is_finite()).fold(top, f64::max);
    }
    // regula falsi that halves the weight of an end that stays (Illinois)
    let near = (zero + last - 1, zero + last);
    let (mut a, mut b) = (place(near.1), place(near.0));
    let (mut at_a, mut at_b) = (slopes[last] - 0.5 * top, slopes[last - 1] - 0.5 * top);
    let mut found: Option<State> = None;
    let mut error = b - a;
    let mut stayed = 0;
    for _ in 0..EVALUATIONS {
        let z0 = (a * at_b - b * at_a) / (at_b - at_a);
        let Some(one) = state(&mut solver, z0, near)? else { return Ok(None) };
        let value = one.slope - 0.5 * top;
        let steep = (at_b - at_a) / (b - a);
        error = (value / steep).abs().max(one.correction).max(f64::EPSILON);
        found = Some(one);
        if error <= WIDTH {
            break;
        }
        if value < 0.0 {
            (a, at_a) = (z0, value);
            at_b *= if stayed == 1 { 0.5 } else { 1.0 };
            stayed = 1;
        } else {
            (b, at_b) = (z0, value);
            at_a *= if stayed == -1 { 0.5 } else { 1.0 };
            stayed = -1;
        }
    }
    Ok(found.map(|state| (near.0, state, error)))
}

/// Puts a state after a point of the branch, as a special point.
fn insert(
    problem: &ContactProblem,
    device: Device,
    branch: &mut Branch,
    (after, state, error): (usize, &State, f64),
    name: &str,
) -> Result<(), EvalError> {
    let (a, b) = (&branch.points[after], &branch.points[after + 1]);
    let (from, to) = (height(branch, a), height(branch, b));
    let share = if from == to { 0.5 } else { ((state.z0 - from) / (to - from)).clamp(0.0, 1.0) };
    let s = a.s + share * (b.s - a.s);
    let mut observables =
        problem.observation(&state.u, &problem.parameters_at(state.z0))?.to_array().to_vec();
    let mut u = state.u.clone();
    let is_loaded = device != Device::Grip;
    if is_loaded {
        observables.push(state.z0);
        u.push(state.z0);
    }
    let p = device.parameter(state.z0, state.force);
    // along the branch a length of arc belongs to a distance of the plate
    let stretch = if from == to { 1.0 } else { ((b.s - a.s) / (to - from)).abs().max(1.0) };
    let same = a.unstable == b.unstable;
    let point = Point {
        s,
        p,
        u,
        dp_ds: a.dp_ds + share * (b.dp_ds - a.dp_ds),
        unstable: a.unstable.filter(|_| same),
        certified: a.certified && b.certified && same,
        eigenvalues: Vec::new(),
        observables,
        event: None,
    };
    let event = Event {
        kind: EventKind::Named(name.to_owned()),
        point: after + 1,
        p,
        unstable_before: a.unstable,
        unstable_after: b.unstable,
        residual: state.residual,
        error_estimate: error * stretch,
        detail: Detail::default(),
        eigenvectors: Vec::new(),
    };
    for known in &mut branch.events {
        known.point += usize::from(known.point > after);
    }
    branch.points.insert(after + 1, point);
    let at =
        branch.events.iter().position(|known| known.point > after).unwrap_or(branch.events.len());
    branch.events.insert(at, event);
    for (k, event) in branch.events.iter().enumerate() {
        branch.points[event.point].event = Some(k);
    }
    Ok(())
}
