//! The branches of a figure: resolved, traced side by side, and asked for states in between.

use super::FigureError;
use super::manifest::{Abscissa, CASES, Manifest, Ordinate, stem};
use continuation::{EventKind, NewtonSettings, newton};
use shell_contact::modes::{ScanSettings, Scanned, scan_branch};
use shell_contact::{ContactBranch, ContactProblem, Observation, Profile};
use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use study::case::{ContactCase, Override, ProblemCase, ResolvedCase, StabilityCase, load_text};
use study::run::{RunError, contact_branch};

/// A branch to be traced.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Job {
    /// The figure it belongs to.
    pub(super) figure: u32,
    /// Its name there.
    pub(super) name: String,
    /// For the legend.
    label: String,
    case: ResolvedCase,
    contact: ContactCase,
    /// Whether modes without the branch's symmetries are counted.
    scan: bool,
}

/// A traced branch.
#[derive(Debug)]
pub(crate) struct Traced {
    /// The figure it belongs to.
    pub figure: u32,
    /// Its name there.
    pub name: String,
    /// For the legend.
    pub label: String,
    /// The case.
    pub case: ResolvedCase,
    /// The problem.
    pub problem: ContactProblem,
    /// The branch.
    pub branch: ContactBranch,
    /// What is unstable along it beyond its own counts, if that was asked for.
    pub scanned: Option<Scanned>,
    radius: f64,
    chi: f64,
    pull: Option<usize>,
}

/// A state on a branch.
#[derive(Debug, Clone)]
pub(crate) struct State {
    u: Vec<f64>,
    /// Plate distance.
    pub z0: f64,
    /// What is reported of it.
    pub observation: Observation,
    /// Whether it is unstable at fixed plate distance.
    pub unstable: bool,
}

/// The branches of a figure, checked.
///
/// # Errors
/// When an override, the number of elements among them, is not allowed.
pub(super) fn jobs(manifest: &Manifest, overrides: &[Override]) -> Result<Vec<Job>, FigureError> {
    manifest
        .curves
        .iter()
        .map(|curve| {
            let of_figure = curve.set.iter().map(|text| Override::given_by("--set", text));
            let overrides: Vec<Override> = of_figure.chain(overrides.iter().cloned()).collect();
            let known = CASES.iter().find(|(name, _)| *name == curve.case);
            let (_, text) = known.ok_or_else(|| FigureError::Manifest {
                figure: manifest.number,
                detail: format!("no case \"{}\"", curve.case),
            })?;
            let name = format!("{}-{}", stem(manifest.number), curve.name);
            let file = format!("figure {}, curve {}", manifest.number, curve.name);
            let case = load_text(&file, &name, text, &overrides, &[])?.case;
            match &case.problem {
                ProblemCase::Contact(contact) => Ok(Job {
                    figure: manifest.number,
                    name: curve.name.clone(),
                    label: curve.label.clone(),
                    contact: contact.clone(),
                    case,
                    scan: manifest.scans() || curve.stability,
                }),
                _ => Err(FigureError::Manifest {
                    figure: manifest.number,
                    detail: format!("\"{}\" is no contact case", curve.case),
                }),
            }
        })
        .collect()
}

/// Traces all jobs, as many at a time as there are processors; the branches come in the order of
/// the jobs. `hear` is told how many are done; once `stop` is set, branches end where they are.
///
/// # Errors
/// The first branch that has no start.
pub(super) fn trace_all(
    jobs: Vec<Job>,
    stop: &AtomicBool,
    hear: &mut dyn FnMut(usize),
) -> Result<Vec<Traced>, RunError> {
    let workers = std::thread::available_parallelism().map_or(1, usize::from).min(jobs.len());
    let next = AtomicUsize::new(0);
    let mut traced: Vec<Option<Result<Traced, RunError>>> = jobs.iter().map(|_| None).collect();
    let (send, receive) = mpsc::channel();
    std::thread::scope(|scope| {
        for _ in 0..workers {
            let (send, next, jobs) = (send.clone(), &next, &jobs);
            scope.spawn(move || {
                loop {
                    let at = next.fetch_add(1, Ordering::Relaxed);
                    let Some(job) = jobs.get(at) else { return };
                    if send.send((at, trace(job, stop))).is_err() {
                        return;
                    }
                }
            });
        }
        drop(send);
        for (done, (at, result)) in receive.iter().enumerate() {
            traced[at] = Some(result);
            hear(done + 1);
        }
    });
    traced.into_iter().flatten().collect()
}

fn trace(job: &Job, stop: &AtomicBool) -> Result<Traced, RunError> {
    let go_on = |()| {
        if stop.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let (problem, branch) = contact_branch(&job.case, &job.contact, &mut |_| go_on(()))?;
    let counting = &mut |_| go_on(());
    let scanned = match job.case.stability {
        StabilityCase::Full { max_n } if job.scan => {
            let settings = ScanSettings { max_n, ..ScanSettings::default() };
            // a branch of admissible states is scanned to its end
            scan_branch(&problem, &branch.branch, &settings, counting).ok()
        }
        _ => None,
    };
    let (radius, chi) = match &job.contact.physical {
        Some(physical) => (physical.radius.si, physical.chi()),
        None => (1.0, 1.0),
    };
    let zero = EventKind::Zero("force".to_owned());
    let pull = branch.branch.events_of(&zero).next().map(|event| event.point);
    let (figure, name, label) = (job.figure, job.name.clone(), job.label.clone());
    let case = job.case.clone();
    Ok(Traced { figure, name, label, case, problem, branch, scanned, radius, chi, pull })
}

impl Traced {
    /// `k_b/(χR0²)`.
    pub(crate) fn bending(&self) -> f64 {
        self.problem.groups().bending
    }

    /// `h/R0` of a homogeneous shell of this bending stiffness.
    pub(crate) fn thickness(&self) -> f64 {
        let nu = self.problem.shell().poisson;
        (12.0 * (1.0 - nu * nu) * self.bending()).sqrt()
    }

    /// `R0` in metres; 1 for a dimensionless case.
    pub(crate) fn radius(&self) -> f64 {
        self.radius
    }

    /// `√(χk_b)` in newtons; in `χR0` for a dimensionless case.
    pub(crate) fn force_unit(&self) -> f64 {
        self.chi * self.radius * self.bending().sqrt()
    }

    /// `χ` in N/m; 1 for a dimensionless case.
    pub(crate) fn chi(&self) -> f64 {
        self.chi
    }

    /// Value of an observable at a point.
    pub(crate) fn observable(&self, point: usize, name: &str) -> f64 {
        let branch = &self.branch.branch;
        let at = branch.observables.iter().position(|known| known == name);
        at.map_or(f64::NAN, |k| branch.points[point].observables[k])
    }

    /// A plate distance on the horizontal axis; NaN where it has no place there.
    pub(crate) fn abscissa(&self, axis: Abscissa, z0: f64) -> f64 {
        let d = self.branch.deformation(z0).unwrap_or(f64::NAN);
        match axis {
            Abscissa::Deformation => d,
            Abscissa::Nm => d * self.radius * 1e9,
            Abscissa::ApproachUm => 2.0 * d * self.radius * 1e6,
            Abscissa::Thicknesses => d / self.thickness(),
            Abscissa::Distance => z0,
        }
    }

    /// The deformation that stands at a place of the horizontal axis.
    pub(crate) fn deformation(&self, axis: Abscissa, x: f64) -> f64 {
        match axis {
            Abscissa::Deformation => x,
            Abscissa::Nm => x * 1e-9 / self.radius,
            Abscissa::ApproachUm => 0.5e-6 * x / self.radius,
            Abscissa::Thicknesses => x * self.thickness(),
            Abscissa::Distance => self.branch.deformation(x).unwrap_or(f64::NAN),
        }
    }

    /// A reduced force on the vertical axis.
    pub(crate) fn ordinate(&self, axis: Ordinate, force: f64) -> f64 {
        match axis {
            Ordinate::Reduced => force,
            Ordinate::NanoNewton => force * self.force_unit() * 1e9,
            Ordinate::Benchmark => 1e6 * force * self.bending().sqrt() / (2.0 * PI),
        }
    }

    /// The state at a deformation: the `pass`-th time the branch takes it after the zero of the
    /// force, or, for −1, the last time before.
    pub(crate) fn state(&self, deformation: f64, pass: i32) -> Option<State> {
        let z0 = self.branch.zero_force? - deformation;
        let zero = self.pull?;
        let points = &self.branch.branch.points;
        if deformation == 0.0 && pass == 1 {
            return self.solve(points[zero].u.clone(), z0, false);
        }
        let crosses = |i: &usize| (points[*i].p - z0) * (points[*i + 1].p - z0) <= 0.0;
        let at = if pass < 0 {
            (0..zero).rev().filter(crosses).nth((-pass - 1) as usize)?
        } else {
            (zero..points.len().saturating_sub(1)).filter(crosses).nth((pass - 1).max(0) as usize)?
        };
        let (a, b) = (&points[at], &points[at + 1]);
        let share = if a.p == b.p { 0.0 } else { (z0 - a.p) / (b.p - a.p) };
        let u = a.u.iter().zip(&b.u).map(|(a, b)| a + share * (b - a)).collect();
        let unstable = a.unstable.max(b.unstable).is_some_and(|n| n > 0);
        self.solve(u, z0, unstable)
    }

    fn solve(&self, mut u: Vec<f64>, z0: f64, unstable: bool) -> Option<State> {
        let p = self.problem.parameters_at(z0);
        newton(&self.problem, &mut u, &p, &NewtonSettings::default()).ok()?;
        let observation = self.problem.observation(&u, &p).ok()?;
        Some(State { u, z0, observation, unstable })
    }

    /// The meridian of a state.
    pub(crate) fn profile(&self, state: &State, samples: usize) -> Option<Profile> {
        self.problem.profile(&state.u, &self.problem.parameters_at(state.z0), samples).ok()
    }
}
