//! The shell from pole to pole between two plates.

use super::contact::{SAMPLES, drawn, event_record, loaded_path, no_start, path, row};
use super::family::Wanted;
use super::form::{StabilityColumns, certified};
use super::resolution::{Resolved, height};
use super::stability::Stability;
use super::{Observer, RunError, listen, states};
use crate::case::{PlateCase, ResolvedCase, TwoPlatesCase};
use crate::record::view::{self, Curve, Profile, Shape};
use crate::record::{Cell, ContactRow, EventRecord, Pictures, Table, TraceResult};
use continuation::{Branch, EvalError, Point, Tracer};
use shell_contact::film::Film;
use shell_contact::modes::{ScanSettings, Scanned, WholeShell};
use shell_contact::two_plates::{
    Plate, Support, SupportedProblem, SymmetricBranch, TwoPlatesGroups, TwoPlatesProblem,
    trace_symmetric,
};
use shell_contact::{ContactBranch, Mesh, Observation, Resolution, force_watches};
use std::time::Instant;

/// The columns that follow the fixed ones.
const OWN: [&str; 5] =
    ["pole_top", "pole_bottom", "shift", "force_bottom", "contact_radius_bottom"];

/// What a picture or a table of a state needs beside the branch.
pub(super) trait BetweenPlates: WholeShell {
    /// The meridian from the upper pole to the lower.
    fn meridian(&self, x: &[f64], p: &[f64]) -> Result<shell_contact::Profile, EvalError>;
    /// What is reported of a state of any shell.
    fn whole(&self, x: &[f64], p: &[f64]) -> Result<Observation, EvalError>;
    /// Heights of both plates.
    fn heights(&self, x: &[f64], p: &[f64]) -> Result<[f64; 2], EvalError>;
    /// How well the elements resolve a state, and how many a half has.
    fn resolution(&self, x: &[f64], p: &[f64]) -> Result<(Resolution, usize), EvalError>;
}

impl BetweenPlates for TwoPlatesProblem {
    fn meridian(&self, x: &[f64], p: &[f64]) -> Result<shell_contact::Profile, EvalError> {
        self.profile(x, p, SAMPLES)
    }

    fn whole(&self, x: &[f64], p: &[f64]) -> Result<Observation, EvalError> {
        Ok(self.observation(x, p)?.whole)
    }

    fn heights(&self, _: &[f64], p: &[f64]) -> Result<[f64; 2], EvalError> {
        Ok([p[0], -p[0]])
    }

    fn resolution(&self, x: &[f64], p: &[f64]) -> Result<(Resolution, usize), EvalError> {
        Ok((TwoPlatesProblem::resolution(self, x, p)?, self.mesh().elements()))
    }
}

impl BetweenPlates for SupportedProblem<'_> {
    fn meridian(&self, x: &[f64], p: &[f64]) -> Result<shell_contact::Profile, EvalError> {
        self.profile(x, p, SAMPLES)
    }

    fn whole(&self, x: &[f64], p: &[f64]) -> Result<Observation, EvalError> {
        Ok(self.observation(x, p)?.0.whole)
    }

    fn heights(&self, x: &[f64], p: &[f64]) -> Result<[f64; 2], EvalError> {
        self.plates(x, p)
    }

    fn resolution(&self, x: &[f64], p: &[f64]) -> Result<(Resolution, usize), EvalError> {
        Ok((SupportedProblem::resolution(self, x, p)?, self.shell().mesh().elements()))
    }
}

/// Does something with the problem of a case, its start and the name of its parameter.
pub(super) trait WithPlates {
    /// What comes of it.
    type Output;
    /// Does it; `p` holds the parameters at the start.
    fn with<P: BetweenPlates>(self, problem: &P, x: &[f64], p: &[f64]) -> Self::Output;
}

/// The problem of a case, of whichever type its supports make it.
pub(super) fn visit<V: WithPlates>(
    case: &ResolvedCase,
    plates: &TwoPlatesCase,
    visitor: V,
) -> Result<V::Output, RunError> {
    let refused = |error| RunError::Parameters { case: case.name.clone(), error };
    let shell = build(plates).map_err(refused)?;
    let start = case.path.start;
    let spring = plates.plates[0].and_then(|plate| plate.stiffness);
    let support = Support { held: plates.held, spring };
    if support == Support::default() {
        let (u, p) = (shell.initial_state(), shell.parameters_at(start));
        return Ok(visitor.with(&shell, &u, &p));
    }
    let problem = SupportedProblem::new(&shell, support).map_err(refused)?;
    let (x, p) = (problem.state(&shell.initial_state(), start), problem.parameters_at(start));
    Ok(visitor.with(&problem, &x, &p))
}

fn build(case: &TwoPlatesCase) -> Result<TwoPlatesProblem, shell_contact::ParameterError> {
    let [top, bottom] = case.plates;
    // a plate that is not there attracts nothing; its film has any length
    let other = top.or(bottom).map_or(1.0, |plate| plate.film);
    let plate = |plate: Option<PlateCase>| match plate {
        Some(plate) => Plate { adhesion: plate.adhesion, film: plate.film },
        None => Plate { adhesion: 0.0, film: other },
    };
    let groups = TwoPlatesGroups {
        bending: case.bending,
        pressure: case.pressure,
        surface_tension: case.surface_tension,
        gas_exponent: case.gas_exponent,
        top: plate(top),
        bottom: plate(bottom),
    };
    let mesh = Mesh::graded(case.mesh.elements, case.mesh.grading.unwrap_or(1.0))?;
    let [above, below] = case.plates.map(|plate| plate.map_or_else(Film::default, |p| p.potential));
    TwoPlatesProblem::with_potentials(&case.shell, &groups, mesh, (above, below))
}

/// Trace a case.
pub(super) fn run(
    case: &ResolvedCase,
    plates: &TwoPlatesCase,
    wanted: Wanted,
    observer: &mut Observer<'_>,
) -> Result<TraceResult, RunError> {
    visit(case, plates, Trace { case, wanted, observer })?
}

struct Trace<'t, 'o> {
    case: &'t ResolvedCase,
    wanted: Wanted,
    observer: &'t mut Observer<'o>,
}

impl WithPlates for Trace<'_, '_> {
    type Output = Result<TraceResult, RunError>;

    fn with<P: BetweenPlates>(self, problem: &P, x: &[f64], p: &[f64]) -> Self::Output {
        let Trace { case, wanted, observer } = self;
        let clock = Instant::now();
        let scan = Stability::scan(case);
        let (mut traced, waves) = follow(case, problem, (x, p), scan, observer)?;
        let stability = match waves {
            Some(waves) => Stability::of_symmetric(case, problem, &mut traced, waves),
            None => Stability::of_whole(case, problem, &mut traced, observer),
        };
        let seconds = clock.elapsed().as_secs_f64();
        let resolved = resolved(problem, &traced.branch);
        let mut shown = Pictures::default();
        if wanted != Wanted::Nothing {
            shown = pictures(resolved.titled(&case.name), problem, &traced, &stability);
        }
        if wanted == Wanted::States {
            let all = traced.branch.points.len();
            shown.states = states::of_two_plates(problem, &traced.branch, all);
        }
        let resolution = resolved.record();
        Ok(TraceResult {
            pictures: shown,
            resolution,
            ..result(case, &traced, &stability, seconds)
        })
    }
}

/// The branch that begins at the sphere. Of mirror images it is traced on half the shell, and has its modes
/// with waves too where they are asked for.
pub(super) fn follow<P: BetweenPlates>(
    case: &ResolvedCase,
    problem: &P,
    (x, p): (&[f64], &[f64]),
    scan: Option<ScanSettings>,
    observer: &mut Observer<'_>,
) -> Result<(ContactBranch, Option<Scanned>), RunError> {
    let name = &problem.parameters()[0].name;
    let settings = settings(case, name);
    let start = case.path.start;
    let images = trace_symmetric(problem, start, settings.clone(), scan, &mut listen(observer));
    let (branch, waves) = match images {
        Some(traced) => {
            let SymmetricBranch { branch, waves } =
                traced.map_err(|detail| no_start(case, detail))?;
            (branch, Some(waves))
        }
        None => {
            let branch = Tracer::new(problem, name, x, p, settings)
                .and_then(|tracer| tracer.watching(&force_watches()))
                .map(|tracer| tracer.run(&mut listen(observer)))
                .map_err(|detail| no_start(case, detail))?;
            (branch, None)
        }
    };
    Ok((ContactBranch::new(branch, None), waves))
}

/// Whether the elements of either half resolve the films and the shell along a branch.
fn resolved<P: BetweenPlates>(problem: &P, branch: &Branch) -> Resolved {
    let mut p = branch.parameters.clone();
    let mut elements = 0;
    let look = |point: &Point| {
        p[0] = point.p;
        let (found, number) = problem.resolution(&point.u, &p).ok()?;
        elements = number;
        Some(found)
    };
    let each = branch.points.iter().map(look).collect();
    Resolved::along(branch, elements, ("z0", height(branch)), each)
}

/// The tracer's settings in the parameter `name`.
pub(super) fn settings(case: &ResolvedCase, name: &str) -> continuation::Settings {
    if name == "z0" { path(case) } else { loaded_path(case) }
}

/// A traced branch as plain numbers, without pictures.
pub(super) fn result(
    case: &ResolvedCase,
    traced: &ContactBranch,
    scanned: &Stability,
    seconds: f64,
) -> TraceResult {
    let branch = &traced.branch;
    let stability = StabilityColumns::of(branch);
    let loaded = branch.parameter != "z0";
    let base = loaded.then(|| branch.parameter.clone());
    let mut table = Table::contact()
        .and(OWN.map(str::to_owned).to_vec())
        .and(base.into_iter().collect())
        .and(stability.titles())
        .and(scanned.titles());
    let columns = table.columns().len();
    for (index, point) in branch.points.iter().enumerate() {
        let mut cells = row(traced, index, point).cells();
        cells.extend(OWN.map(|name| observed(branch, index, name).into()));
        cells.extend(loaded.then(|| point.p.into()));
        cells.extend(stability.cells(point));
        cells.extend(scanned.cells(index, point));
        cells.resize(columns, Cell::Empty);
        table.push(cells);
    }
    let events = branch.events.iter().enumerate().map(|(k, event)| {
        let observables = vec![("shift".to_owned(), observed(branch, event.point, "shift"))];
        let mode = scanned.mode(branch, k);
        EventRecord { observables, mode, ..event_record(traced, event, loaded) }
    });
    TraceResult {
        case: case.name.clone(),
        parameter: branch.parameter.clone(),
        events: events.collect(),
        table,
        resolution: None,
        stopped_because: branch.stopped.reason,
        stopped_detail: branch.stopped.detail.clone(),
        points: branch.points.len(),
        certified: certified(branch),
        newton_iterations: branch.statistics.newton_iterations,
        seconds,
        maxwell: None,
        stability: Some(scanned.record()),
        shapes: scanned.shapes(branch),
        pictures: Pictures::default(),
    }
}

fn observed(branch: &Branch, index: usize, name: &str) -> f64 {
    let at = branch.observables.iter().position(|own| own == name);
    at.map_or(f64::NAN, |k| branch.points[index].observables[k])
}

/// A branch of a diagram, and its force over half the distance of the plates.
pub(super) fn on_diagram<P: BetweenPlates>(
    case: &ResolvedCase,
    problem: &P,
    traced: &ContactBranch,
    stability: &Stability,
) -> (TraceResult, Curve) {
    let curve = force_over(traced, stability, &rows(traced), &|row| row.z0);
    let resolution = resolved(problem, &traced.branch).record();
    (TraceResult { resolution, ..result(case, traced, stability, 0.0) }, curve)
}

fn rows(traced: &ContactBranch) -> Vec<ContactRow> {
    let points = traced.branch.points.iter().enumerate();
    points.map(|(index, point)| row(traced, index, point)).collect()
}

fn force_over(
    traced: &ContactBranch,
    stability: &Stability,
    rows: &[ContactRow],
    x: &dyn Fn(&ContactRow) -> f64,
) -> Curve {
    drawn(traced, stability, rows, "force", x, &|row| row.force)
}

fn pictures<P: BetweenPlates>(
    title: String,
    problem: &P,
    traced: &ContactBranch,
    stability: &Stability,
) -> Pictures {
    let rows = rows(traced);
    let (mut shapes, mut film_pressure) = (Vec::new(), Vec::new());
    for index in super::contact::chosen(&rows) {
        let point = &traced.branch.points[index];
        let mut p = traced.branch.parameters.clone();
        p[0] = point.p;
        let Ok(meridian) = problem.meridian(&point.u, &p) else { continue };
        let Ok(heights) = problem.heights(&point.u, &p) else { continue };
        let z0 = rows[index].z0;
        let own = point.unstable.is_some_and(|n| n > 0);
        let state = view::Stability::of(own, stability.is_asymmetric(index));
        let label = match traced.deformation(z0) {
            Some(d) => format!("Δ/R₀ = {d:.3}"),
            None => format!("z₀/R₀ = {z0:.3}"),
        };
        // the film of the upper plate: that of the other would lie over it
        let upper = meridian.sigma.len().div_ceil(2);
        film_pressure.push(Profile {
            label: label.clone(),
            sigma: meridian.sigma[..upper].to_vec(),
            value: meridian.disjoining_pressure[..upper].to_vec(),
            stability: state,
        });
        shapes.push(Shape {
            label,
            sigma: meridian.sigma,
            z: meridian.z,
            plate: heights[0],
            plate_below: Some(heights[1]),
            stability: state,
        });
    }
    let force = |x: &dyn Fn(&ContactRow) -> f64| force_over(traced, stability, &rows, x);
    Pictures {
        title,
        force_deformation: traced.zero_force.map(|_| force(&|row| row.deformation)),
        force_distance: Some(force(&|row| row.z0)),
        shapes,
        film_pressure,
        ..Pictures::default()
    }
}
