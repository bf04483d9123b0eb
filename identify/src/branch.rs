//! The shell's branch of equilibria between two plates, with its sensitivities, dimensionless.
//!
//! The branch is traced in the plate's height `z0` and does not know the lever. At each of its points the
//! tangent `u_z = −H⁻¹R_z` costs one more factorisation, and gives every sensitivity without another
//! solve: with `F̂ = −(2π/√k̂_b) ∂E/∂z0`, and `R_q` the partial derivative of the residual,
//!
//! ```text
//! dF̂/dq |z0 = ∂F̂/∂q |u − (2π/√k̂_b) u_z · R_q
//! ```
//!
//! because `H` is symmetric. All is kept per arclength (`z_s`, `F̂_s`, `z_s dF̂/dq`), which stays finite
//! where the plate's distance turns back.

use crate::error::ModelError;
use crate::parameters::{Key, Parameters};
use continuation::{Matrix, ParamId, Problem, Settings, Tracer};
use shell_contact::LawName;
use shell_contact::contact::parameter;
use shell_contact::{ContactProblem, Dimensionless, Mesh, Resolution};
use std::f64::consts::PI;

/// What the branch depends on, dimensionless.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Group {
    /// `ln k̂_b`.
    Bending,
    /// `ln P̂_A`.
    Pressure,
    /// `ln Ŵ0`.
    Adhesion,
    /// `ln δ̂_A`.
    Film,
    /// `γ̂_BW` itself, which may be zero.
    SurfaceTension,
    /// The gas exponent.
    GasExponent,
    /// The Poisson ratio.
    Poisson,
    /// The share `b` of Mooney and Rivlin's law.
    MooneyB,
}

/// How many groups there are.
pub const GROUPS: usize = 8;

impl Group {
    /// All groups.
    pub const ALL: [Group; GROUPS] = [
        Group::Bending,
        Group::Pressure,
        Group::Adhesion,
        Group::Film,
        Group::SurfaceTension,
        Group::GasExponent,
        Group::Poisson,
        Group::MooneyB,
    ];
}

/// How much work a branch may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Elements from pole to equator.
    pub elements: usize,
    /// Most points.
    pub points: usize,
    /// Error of the force that interpolation between points may have, N.
    pub force_error: f64,
    /// Most corrections of the state, those of rejected steps included, on a mesh of 100 elements; fewer on a finer
    /// one, which takes longer for each.
    pub work: f64,
    /// Largest angle from point to point; what lies between is refined where the force asks for it.
    pub max_angle: f64,
}

impl Effort {
    /// The usual largest angle.
    pub const ANGLE: f64 = 0.35;
    /// That on the way to a fit.
    pub const WIDE: f64 = 0.6;
}

/// What a point costs beside its corrections: its sensitivities, in corrections.
const POINT_WORK: f64 = 2.0;
/// Rounds of refinement between points: each halves a step.
const ROUNDS: usize = 6;
/// Slope of the plate's height, per arclength, below which a step is next to a fold and is not halved at a
/// given height.
const STEEPEST: f64 = 0.05;
/// A correction of the interpolated state beyond which it was no guess.
const LONGEST_CORRECTION: f64 = 1e-2;
/// A correction after which the next would be rounding.
const SHORT_CORRECTION: f64 = 1e-4;

/// A point of the branch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Arclength.
    pub s: f64,
    /// `z0/R0`.
    pub z: f64,
    /// `dz0/ds`.
    pub dz: f64,
    /// `F̂`.
    pub force: f64,
    /// `dF̂/ds`.
    pub dforce: f64,
    /// `z_s dF̂/dq` at fixed `z0`, in the order of [`Group::ALL`]; zero for what was not asked for.
    pub by_group: [f64; GROUPS],
    /// Negative eigenvalues of the Hessian at fixed plate.
    pub unstable: usize,
}

/// A branch from the free shell inwards.
#[derive(Debug, Clone, PartialEq)]
pub struct ShellBranch {
    /// Its points in order.
    pub nodes: Vec<Node>,
    /// Whether it went as far as was asked.
    pub complete: bool,
    /// Whether it ended because it took more work than a branch may: the number of points and corrections.
    pub too_dear: Option<usize>,
    /// The poorest resolution of its points.
    pub resolution: Resolution,
    /// Jacobians assembled.
    pub assemblies: usize,
}

/// The dimensionless groups of physical parameters, Eq. (21).
pub fn groups(p: &Parameters) -> Dimensionless {
    let (chi, radius) = (p[Key::Chi], p[Key::Radius]);
    Dimensionless {
        bending: p[Key::Bending] / (chi * radius * radius),
        pressure: p[Key::Pressure] * radius / chi,
        adhesion: p[Key::Adhesion] / chi,
        film: p[Key::Film] / radius,
        surface_tension: p[Key::SurfaceTension] / chi,
        gas_exponent: p[Key::GasExponent],
    }
}

/// Which plate heights a branch spans.
pub struct Span<'a> {
    /// `z0` of the start, above 1.
    pub start: f64,
    /// Least `z0`.
    pub end: f64,
    /// Whether a point with this height and force is far enough.
    pub enough: &'a dyn Fn(f64, f64) -> bool,
    /// Asked at every point whether to stop.
    pub stop: &'a dyn Fn() -> bool,
}

/// Traces the branch and computes the sensitivities to the groups that `wanted` names.
///
/// # Errors
/// When the parameters are impossible, or the branch does not even begin.
pub fn trace(
    law: LawName,
    p: &Parameters,
    span: &Span<'_>,
    effort: Effort,
    wanted: &[Group],
) -> Result<ShellBranch, ModelError> {
    let shell = p.shell(law);
    let groups = groups(p);
    let mesh = Mesh::uniform(effort.elements)?;
    let problem = ContactProblem::new(&shell, &groups, mesh)?;
    let around = Around::new(&problem, wanted);
    let settings = Settings {
        target: Some(span.end),
        max_points: effort.points,
        // what is interpolated between points is good to 1e-5 of the force
        max_step: Some(0.035),
        max_angle: effort.max_angle,
        tolerance: 1e-9,
        event_tolerance: 1e-6,
        ..Settings::default()
    };
    let (u, at) = (problem.initial_state(), problem.parameters_at(span.start));
    let mut tracer = Tracer::new(&problem, "z0", &u, &at, settings)?;
    let mut branch = ShellBranch {
        nodes: Vec::new(),
        complete: false,
        too_dear: None,
        resolution: Resolution { per_film_length: f64::INFINITY, per_wavelength: f64::INFINITY },
        assemblies: 0,
    };
    let mut work = Work::new(&problem);
    let mut states: Vec<State> = Vec::new();
    let sites = problem.resolution_sites();
    let budget = (effort.work * 100.0 / effort.elements as f64).ceil() as usize;
    let mut spent = 0;
    while let Some(point) = tracer.next() {
        if (span.stop)() {
            return Err(ModelError::Stopped);
        }
        spent = tracer.statistics().newton_iterations + (POINT_WORK * states.len() as f64) as usize;
        if spent > budget {
            branch.too_dear = Some(budget);
            break;
        }
        // at a special point the tangent's own system is singular
        if point.event.is_some() {
            continue;
        }
        let at = problem.parameters_at(point.p);
        branch.resolution = branch.resolution.least(problem.resolution_at(&sites, &point.u, &at)?);
        let node = around.node(&point.u, &at, (point.s, point.dp_ds), point.unstable, &mut work)?;
        let far_enough = (span.enough)(point.p, node.force) || point.p <= span.end;
        states.push(State { node, u: point.u, tangent: work.tangent.clone() });
        if far_enough {
            branch.complete = true;
            break;
        }
    }
    let scale = (p[Key::Chi] * p[Key::Bending]).sqrt();
    // what is left of the budget; a point that is put in takes two corrections
    let most = (budget.saturating_sub(spent) as f64 / (POINT_WORK + 2.0)) as usize;
    let tolerance = effort.force_error / scale;
    let inserted = around.refine(&mut states, tolerance, most, span.stop, &mut work)?;
    branch.assemblies = tracer.statistics().newton_iterations + states.len() + inserted;
    branch.nodes = states.into_iter().map(|state| state.node).collect();
    Ok(branch)
}

/// A point with its state and `u_z`.
struct State {
    node: Node,
    u: Vec<f64>,
    tangent: Vec<f64>,
}

/// The problem, and what the force is to be differentiated by.
struct Around<'a> {
    problem: &'a ContactProblem,
    /// Each with its parameter, and that parameter's slope in the group.
    wanted: Vec<(Group, ParamId, f64)>,
}

impl<'a> Around<'a> {
    fn new(problem: &'a ContactProblem, wanted: &[Group]) -> Self {
        let g = problem.groups();
        let of = |group: Group| match group {
            Group::Bending => (parameter::BENDING, g.bending),
            Group::Pressure => (parameter::PRESSURE, g.pressure),
            Group::Adhesion => (parameter::ADHESION, g.adhesion),
            Group::Film => (parameter::FILM, g.film),
            Group::SurfaceTension => (parameter::SURFACE_TENSION, 1.0),
            Group::GasExponent => (parameter::GAS_EXPONENT, 1.0),
            Group::Poisson => (parameter::POISSON, 1.0),
            Group::MooneyB => (parameter::B, 1.0),
        };
        let wanted = wanted.iter().map(|&group| (group, of(group)));
        let known = wanted.filter(|(_, (which, _))| which.0 < problem.parameters().len());
        Around { problem, wanted: known.map(|(group, (which, by))| (group, which, by)).collect() }
    }

    /// The point at a state: arclength and `dz0/ds` are given.
    fn node(
        &self,
        u: &[f64],
        at: &[f64],
        (s, dz): (f64, f64),
        unstable: Option<usize>,
        work: &mut Work,
    ) -> Result<Node, ModelError> {
        let problem = self.problem;
        problem.linearise(u, at, &mut work.residual, &mut work.hessian)?;
        let facts = work.hessian.factor(f64::EPSILON * work.hessian.norm());
        problem.parameter_derivative(u, at, parameter::Z0, &mut work.tangent)?;
        work.hessian.solve(&mut work.tangent);
        for x in &mut work.tangent {
            *x = -*x;
        }
        let slope = |which: ParamId, du: &[f64], dp: f64| {
            // the force is the first observable, and has slopes of its own
            problem.observable_slope(0, u, at, which, du, dp).map(|s| s.unwrap_or(f64::NAN))
        };
        let counted = facts.inertia.map_or(0, |(negative, _)| negative);
        let bending = problem.groups().bending;
        let mut node = Node {
            s,
            z: at[parameter::Z0.0],
            dz,
            // ∂F̂/∂k̂_b at a fixed state is −F̂/(2k̂_b)
            force: slope(parameter::BENDING, &work.zero, -2.0 * bending)?,
            dforce: dz * slope(parameter::Z0, &work.tangent, 1.0)?,
            by_group: [0.0; GROUPS],
            unstable: unstable.unwrap_or(counted),
        };
        let g = problem.groups();
        let factor = 2.0 * PI / g.bending.sqrt();
        for &(group, which, scale) in &self.wanted {
            problem.parameter_derivative(u, at, which, &mut work.by_parameter)?;
            let at_fixed_state = slope(which, &work.zero, scale)?;
            let along: f64 = work.tangent.iter().zip(&work.by_parameter).map(|(a, b)| a * b).sum();
            node.by_group[group as usize] = dz * (at_fixed_state - factor * scale * along);
        }
        Ok(node)
    }

    /// Puts points, `most` at most, where the force between two of them is not known to `tolerance`; returns their
    /// number.
    /// The arclength of a new point is that of the interpolant of `z0`, so that this is exact, and what is
    /// refined is the force over it.
    fn refine(
        &self,
        states: &mut Vec<State>,
        tolerance: f64,
        most: usize,
        stop: &dyn Fn() -> bool,
        work: &mut Work,
    ) -> Result<usize, ModelError> {
        let mut inserted = 0;
        for _ in 0..ROUNDS {
            let errors = interpolation_errors(states);
            let mut refined = Vec::with_capacity(2 * states.len());
            let mut changed = false;
            for (k, state) in std::mem::take(states).into_iter().enumerate() {
                refined.push(state);
                let n = refined.len();
                if k > 0 && errors[k - 1] > tolerance && inserted < most {
                    if stop() {
                        return Err(ModelError::Stopped);
                    }
                    if let Some(between) = self.between(&refined[n - 2], &refined[n - 1], work) {
                        refined.insert(n - 1, between?);
                        inserted += 1;
                        changed = true;
                    }
                }
            }
            *states = refined;
            if !changed {
                break;
            }
        }
        Ok(inserted)
    }

    /// The point half-way between two, by Newton's method at the interpolated height; `None` next to a fold,
    /// or where the interpolated state is no guess.
    fn between(&self, a: &State, b: &State, work: &mut Work) -> Option<Result<State, ModelError>> {
        if a.node.dz * b.node.dz <= 0.0 || a.node.dz.abs().min(b.node.dz.abs()) < STEEPEST {
            return None;
        }
        let h = b.node.s - a.node.s;
        let z = 0.5 * (a.node.z + b.node.z) + 0.125 * h * (a.node.dz - b.node.dz);
        let dz = 1.5 * (b.node.z - a.node.z) / h - 0.25 * (a.node.dz + b.node.dz);
        let (sa, sb) = (0.125 * h * a.node.dz, 0.125 * h * b.node.dz);
        let mut u: Vec<f64> = (0..a.u.len())
            .map(|i| 0.5 * (a.u[i] + b.u[i]) + sa * a.tangent[i] - sb * b.tangent[i])
            .collect();
        let at = self.problem.parameters_at(z);
        for _ in 0..6 {
            let linear = self.problem.linearise(&u, &at, &mut work.residual, &mut work.hessian);
            linear.ok()?;
            work.hessian.factor(f64::EPSILON * work.hessian.norm());
            work.hessian.solve(&mut work.residual);
            let longest = work.residual.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            if longest.is_nan() || longest > LONGEST_CORRECTION {
                return None;
            }
            for (u, step) in u.iter_mut().zip(&work.residual) {
                *u -= step;
            }
            if longest < SHORT_CORRECTION {
                let s = 0.5 * (a.node.s + b.node.s);
                let node = self.node(&u, &at, (s, dz), None, work);
                return Some(node.map(|node| State { node, u, tangent: work.tangent.clone() }));
            }
        }
        None
    }
}

/// Error of the cubic Hermite interpolant of the force in the middle of each step, `h⁴/384` times its fourth
/// derivative, which is read off the third ones of neighbouring steps.
fn interpolation_errors(states: &[State]) -> Vec<f64> {
    let steps: Vec<(f64, f64, f64)> = states
        .windows(2)
        .map(|w| {
            let (a, b) = (&w[0].node, &w[1].node);
            let h = b.s - a.s;
            let third = 6.0 * (2.0 * (a.force - b.force) / h + a.dforce + b.dforce) / (h * h);
            (0.5 * (a.s + b.s), h, third)
        })
        .collect();
    (0..steps.len())
        .map(|k| {
            let (middle, h, third) = steps[k];
            let beside = [k.checked_sub(1), Some(k + 1)];
            let fourth = beside
                .into_iter()
                .flatten()
                .filter_map(|j| steps.get(j))
                .map(|other| ((other.2 - third) / (other.0 - middle)).abs())
                .fold(0.0, f64::max);
            h.powi(4) / 384.0 * fourth
        })
        .collect()
}

/// Space for one point.
struct Work {
    residual: Vec<f64>,
    tangent: Vec<f64>,
    by_parameter: Vec<f64>,
    zero: Vec<f64>,
    hessian: <ContactProblem as Problem>::Jacobian,
}

impl Work {
    fn new(problem: &ContactProblem) -> Self {
        let n = problem.dim();
        Work {
            residual: vec![0.0; n],
            tangent: vec![0.0; n],
            by_parameter: vec![0.0; n],
            zero: vec![0.0; n],
            hessian: problem.new_jacobian(),
        }
    }
}
