//! The fit: a grid of starts on a coarse mesh, descents from the best, the best polished on a finer one.
//!
//! Nothing depends on clocks or chance: the same curve and the same knowledge give the same fit. Budgets are
//! numbers of points and of evaluations.

mod buckling;
pub mod descent;
pub mod guide;
pub mod objective;
mod search;
pub mod starts;

use crate::attend::{Attended, Stage};
use crate::branch::Effort;
use crate::data::{Curve, Direction, median};
use crate::error::FitError;
use crate::lever::LeverBranch;
use crate::model::Model;
use crate::parameters::{Key, Parameters};
use descent::{BOLD, CAREFUL, Limits, Minimum, descend, descend_from};
use guide::Guide;
use nalgebra::DVector;
use objective::{DerivedPrior, Objective, Prior, Residuals};
use search::search;
use shell_contact::LawName;
use starts::{Look, look};
use std::f64::consts::PI;

/// What the laboratory knows and asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// The membrane's law.
    pub law: LawName,
    /// Poles that deform: 2 (lever and substrate) or 1.
    pub contacts: u8,
    /// Known values, SI; NaN where nothing is known.
    pub base: Parameters,
    /// What is looked for.
    pub free: Vec<Key>,
    /// What is known of it.
    pub priors: Vec<Prior>,
    /// What is known of what follows from the moduli.
    pub derived: Vec<DerivedPrior>,
    /// Relative standard deviation of the lever's stiffness; 0: known exactly.
    pub spring_constant_sd: f64,
    /// Soft-L1 in place of squares.
    pub robust: bool,
    /// Segments that are fitted; both without.
    pub only: Option<Direction>,
    /// Piezo heights that are fitted, m; all without.
    pub range: Option<(f64, f64)>,
    /// Where the descent starts, such as the fit of the curve before; a grid without. Other minima are not
    /// looked for then.
    pub start: Option<Parameters>,
}

impl Setup {
    /// The usual fit: moduli, film, radius, contact point and baseline are looked for.
    pub fn new(law: LawName, base: Parameters, priors: Vec<Prior>) -> Setup {
        use Key::{Adhesion, Bending, Chi, Contact, Film, Offset, Radius, Tilt};
        Setup {
            law,
            contacts: 2,
            base,
            free: vec![Chi, Bending, Adhesion, Film, Radius, Contact, Offset, Tilt],
            priors,
            derived: Vec::new(),
            spring_constant_sd: 0.1,
            robust: false,
            only: None,
            range: None,
            start: None,
        }
    }

    /// The setup with the lever's stiffness among what is looked for and its calibration as a prior, unless
    /// it is known exactly. So what the optical radius or the pressure of the gas say of the lever counts.
    #[must_use]
    pub fn with_lever(&self) -> Setup {
        const K: Key = Key::SpringConstant;
        let mut setup = self.clone();
        let (value, sd) = (self.base[K], self.spring_constant_sd * self.base[K]);
        if sd > 0.0 && !self.priors.iter().any(|prior| prior.key == K) {
            setup.priors.push(Prior { key: K, value, sd });
            if !self.free.contains(&K) {
                setup.free.push(K);
            }
        }
        setup
    }
}

/// Fewest samples in contact.
pub const FEWEST_IN_CONTACT: usize = 12;
/// Fewest samples of baseline.
pub const FEWEST_OF_BASELINE: usize = 8;
/// Range of forces, in standard deviations of the noise, beyond which a curve without contact has no baseline.
const STEEP: f64 = 50.0;
/// Largest deflection of the lever in travels of the piezo: more than 1 is a wrong unit or calibration.
const MOST_DEFLECTION: f64 = 1.2;
/// Largest approach of the plates in the room that the bubble leaves them: more than 1 is a wrong unit, radius or
/// calibration; an onset in noise and a lever known to ten per cent need some room themselves.
const MOST_SQUEEZED: f64 = 1.5;
/// Least deflection that an instrument resolves, m: a hundredth of an atom.
const LEAST_DEFLECTION: f64 = 1e-12;
/// Samples of the thinned curve on which starts are compared.
const THINNED: usize = 400;
/// Elements per wavelength of the shell on the coarse mesh, and the fewest: forces are good to 1e-4.
const PER_WAVELENGTH: f64 = 15.0;
/// The fewest and the most elements, coarse.
pub(crate) const COARSE: (f64, f64) = (56.0, 120.0);
/// The same, fine: forces are good to 1e-5.
const FINE: (f64, f64) = (96.0, 320.0);
/// Error of the interpolated force, in standard deviations of the noise, coarse and fine.
pub(crate) const COARSE_ERROR: f64 = 0.2;
/// The same, fine: `√N` samples times this is little beside 1.
const FINE_ERROR: f64 = 0.005;
/// Most points of a branch.
const POINTS: usize = 500;
/// Most work for a branch, in corrections on 100 elements: 0.1 ms each, so that no evaluation takes half a second.
/// Those of a good fit take a tenth of it.
const MOST_WORK: f64 = 2900.0;
/// The same on the way to a fit: a mesh that does not resolve its film has a fold at every node.
const ROUGH_WORK: f64 = 920.0;
/// The same for the grid, unless it leaves too few starts.
const GRID_WORK: f64 = 400.0;
/// The fewest starts.
const FEWEST_STARTS: usize = 6;
/// `χ²/dof` beyond which the fine mesh has nothing to say: a few evaluations for the record.
const HOPELESS: f64 = 20.0;

/// A fit before its uncertainty.
#[derive(Debug, Clone)]
pub struct Fitted<'a> {
    /// The problem with the samples that count.
    pub objective: Objective<'a>,
    /// Its best minimum.
    pub best: Minimum,
    /// The residuals before the variance of the data was widened for them.
    pub residuals: Residuals,
    /// The branch there.
    pub branch: LeverBranch,
    /// Whether its mesh resolves it.
    pub branch_resolved: bool,
    /// Other minima that descents ended in, with their costs on the coarse mesh and that of the best.
    pub others: Vec<(Parameters, f64)>,
    /// Starts that were compared.
    pub starts: usize,
    /// Evaluations of the model.
    pub evaluations: usize,
    /// What the curve shows without a model.
    pub look: Look,
}

/// Elements for a shell, coarse or fine.
pub fn elements(p: &Parameters, (least, most): (f64, f64), factor: f64) -> usize {
    let b = crate::branch::groups(p).bending;
    let needed = PER_WAVELENGTH * factor * 0.25 / b.sqrt().sqrt();
    needed.clamp(least, most).ceil() as usize
}

/// Which samples of a curve a setup uses.
pub fn used_samples(curve: &Curve, setup: &Setup) -> Vec<bool> {
    let mut used = Vec::with_capacity(curve.len());
    for segment in &curve.segments {
        let direction = setup.only.is_none_or(|only| only == segment.direction);
        for height in &segment.height {
            let within = setup.range.is_none_or(|(a, b)| (a.min(b)..=a.max(b)).contains(height));
            used.push(direction && within);
        }
    }
    used
}

/// Checks that there is something to fit.
///
/// # Errors
/// Says which quantity is missing, or what of the curve is too little.
pub fn check<'a>(curve: &'a Curve, setup: &Setup) -> Result<(Objective<'a>, Look), FitError> {
    let p = &setup.base;
    for key in [Key::SpringConstant, Key::Radius] {
        if !p[key].is_finite() {
            return Err(FitError::Unknown { key: key.name() });
        }
    }
    for key in Key::ALL {
        let unused = key == Key::Contact || setup.free.contains(&key);
        if !unused && !p[key].is_finite() {
            return Err(FitError::Unknown { key: key.name() });
        }
    }
    let noise = curve.noise();
    let strongest =
        curve.segments.iter().flat_map(|s| &s.force).fold(0.0_f64, |m, f| m.max(f.abs()));
    // what differences of equal numbers leave is no noise
    if !(noise > 1e-14 * strongest && noise.is_finite()) {
        return Err(FitError::NoNoise);
    }
    let Some(look) = look(curve, noise, p[Key::SpringConstant]) else {
        // nothing that rises above the line through the farthest samples: flat, or steep from the start
        let forces = || curve.segments.iter().flat_map(|s| s.force.iter().copied());
        let range =
            forces().fold(f64::NEG_INFINITY, f64::max) - forces().fold(f64::INFINITY, f64::min);
        return Err(if range > STEEP * noise {
            FitError::NoBaseline { found: 0, fewest: FEWEST_OF_BASELINE }
        } else {
            FitError::NoContact { fewest: FEWEST_IN_CONTACT }
        });
    };
    let lever = p[Key::SpringConstant];
    let deflection = look.largest / lever;
    let travel = curve.farthest() - curve.nearest();
    if deflection > MOST_DEFLECTION * travel || deflection < LEAST_DEFLECTION {
        return Err(FitError::Deflection { force: look.largest, lever, deflection, travel });
    }
    if look.in_contact < FEWEST_IN_CONTACT {
        return Err(FitError::FewInContact { found: look.in_contact, fewest: FEWEST_IN_CONTACT });
    }
    if look.baseline < FEWEST_OF_BASELINE {
        return Err(FitError::NoBaseline { found: look.baseline, fewest: FEWEST_OF_BASELINE });
    }
    let radius = p[Key::Radius];
    let span = curve.farthest() - curve.nearest();
    if !(1e-3..=1e3).contains(&(span / radius)) {
        return Err(FitError::Scale { span, radius });
    }
    let squeezed = look.onset - curve.nearest() - deflection;
    let room = f64::from(setup.contacts) * radius;
    if squeezed > MOST_SQUEEZED * room {
        return Err(FitError::TooDeep { squeezed, room });
    }
    let model = Model {
        law: setup.law,
        contacts: setup.contacts,
        nominal_spring_constant: p[Key::SpringConstant],
        effort: Effort {
            elements: COARSE.0 as usize,
            points: POINTS,
            force_error: COARSE_ERROR * noise,
            work: ROUGH_WORK,
            max_angle: Effort::WIDE,
        },
    };
    let ln = |low: f64, high: f64| (low.ln(), high.ln());
    let bounds = setup.free.iter().map(|key| match key {
        Key::Chi => ln(1e-4, 1e5),
        Key::Bending => ln(1e-21, 1e-9),
        Key::Adhesion => ln(1e-8, 1.0),
        Key::Film => ln(2e-3 * radius, 0.25 * radius),
        Key::Radius => ln(radius / 4.0, radius * 4.0),
        Key::Pressure => ln(1.0, 1e9),
        Key::SpringConstant => ln(p[Key::SpringConstant] / 4.0, p[Key::SpringConstant] * 4.0),
        Key::Contact => (curve.nearest() - 2.0 * radius, curve.farthest() + 2.0 * radius),
        Key::SurfaceTension => (0.0, 10.0),
        Key::GasExponent => (0.0, 3.0),
        Key::Poisson => (if setup.law == LawName::Skalak { 0.0 } else { -0.9 }, 0.5),
        Key::MooneyB => (0.0, 1.0),
        Key::Offset | Key::Tilt => (f64::NEG_INFINITY, f64::INFINITY),
    });
    let objective = Objective {
        curve,
        used: used_samples(curve, setup),
        noise,
        widened: 1.0,
        model,
        base: *p,
        free: setup.free.clone(),
        priors: setup.priors.clone(),
        derived: setup.derived.clone(),
        attended: Attended::default(),
        bounds: bounds.collect(),
        robust: setup.robust,
        guide: None,
    };
    Ok((objective, look))
}

/// Fits a curve.
///
/// # Errors
/// When there is nothing to fit, or no start leads anywhere.
pub fn fit<'a>(
    curve: &'a Curve,
    setup: &Setup,
    attended: Attended<'a>,
) -> Result<Fitted<'a>, FitError> {
    let (mut full, look) = check(curve, setup)?;
    full.attended = attended;
    if let Some(start) = &setup.start {
        let x = full.place(start);
        let polished = polish(&mut full, &x)?;
        return Ok(Fitted {
            best: polished.best,
            residuals: polished.residuals,
            branch: polished.branch,
            branch_resolved: polished.resolved,
            others: Vec::new(),
            starts: 1,
            evaluations: polished.evaluations,
            look,
            objective: full,
        });
    }
    let stride = (curve.len() / THINNED).max(1);
    let thin_curve = curve.thinned(stride);
    let mut thin = Objective { curve: &thin_curve, ..full.clone() };
    thin.used = used_samples(&thin_curve, setup);
    let guide = Guide::of(curve, full.noise, &look);
    let mut found = search(&mut thin, &look, guide.as_ref());
    let none = || if attended.is_stopped() { FitError::Stopped } else { FitError::NoStart };
    let minima = &mut found.minima;
    let others = distinct(&thin, minima, stride as f64);
    if minima.is_empty() {
        return Err(none());
    }
    let first = minima.swap_remove(0);
    let polished = match polish(&mut full, &first.x) {
        Err(FitError::Stopped) => kept(&full, first).ok_or(FitError::Stopped)?,
        polished => polished?,
    };
    Ok(Fitted {
        best: polished.best,
        residuals: polished.residuals,
        branch: polished.branch,
        branch_resolved: polished.resolved,
        others,
        starts: found.starts,
        evaluations: found.evaluations + polished.evaluations,
        look,
        objective: full,
    })
}

/// A fit again, from another place.
///
/// # Errors
/// When the model has no value there.
pub fn refit<'a>(earlier: Fitted<'a>, x: &DVector<f64>) -> Result<Fitted<'a>, FitError> {
    let mut objective = earlier.objective;
    let polished = polish(&mut objective, x)?;
    Ok(Fitted {
        best: polished.best,
        residuals: polished.residuals,
        branch: polished.branch,
        branch_resolved: polished.resolved,
        evaluations: earlier.evaluations + polished.evaluations,
        objective,
        ..earlier
    })
}

/// What there is when a fit is stopped before its polish has begun, or the fine mesh has no value: a minimum on a
/// coarse one.
fn kept(full: &Objective<'_>, minimum: Minimum) -> Option<Polished> {
    let (x, evaluations) = (minimum.x, minimum.evaluations);
    let at = full.evaluate_on(&x, minimum.at.branch?);
    let best = Minimum { x, at, converged: false, evaluations };
    let residuals = full.residuals(&best.at);
    let (branch, resolution) = best.at.branch.clone()?;
    Some(Polished { best, residuals, branch, resolved: resolution.is_enough(), evaluations: 0 })
}

/// The end of a fit.
struct Polished {
    best: Minimum,
    residuals: Residuals,
    branch: LeverBranch,
    resolved: bool,
    evaluations: usize,
}

/// On all samples, then on the fine mesh without those beside jumps, and once more with the variance that the
/// residuals call for.
fn polish(full: &mut Objective<'_>, x: &DVector<f64>) -> Result<Polished, FitError> {
    let mut x = x.clone();
    let mut evaluations = 0;
    full.widened = 1.0;
    full.attended.tell(Stage::Polish, 0, 3);
    let attended = full.attended;
    let none = || if attended.is_stopped() { FitError::Stopped } else { FitError::NoStart };
    let mut rough = None;
    full.model.effort.elements = elements(&full.parameters(&x), COARSE, 1.0);
    full.model.effort.force_error = COARSE_ERROR * full.noise;
    full.model.effort.work = ROUGH_WORK;
    full.model.effort.max_angle = Effort::WIDE;
    if let Some(found) =
        descend(full, &x, None, Limits { evaluations: 25, tolerance: 1.0, damping: CAREFUL })
    {
        evaluations += found.evaluations;
        leave_out_jumps(full, &found);
        if full.robust {
            leave_out_outliers(full, &found);
        }
        x = found.x.clone();
        rough = Some(found);
    }
    full.attended.tell(Stage::Polish, 1, 3);
    full.model.effort.work = MOST_WORK;
    full.model.effort.max_angle = Effort::ANGLE;
    full.model.effort.force_error = FINE_ERROR * full.noise;
    full.model.effort.elements = elements(&full.parameters(&x), FINE, 2.0);
    let hopeless =
        rough.as_ref().is_some_and(|found| full.residuals(&found.at).chi2_dof > HOPELESS);
    let most = if hopeless { 6 } else { 40 };
    let limits = Limits { evaluations: most, tolerance: 1e-4, damping: BOLD };
    for last in [false, true] {
        let mut best = match descend(full, &x, None, limits) {
            Some(best) => best,
            // stopped on the way to the fine mesh, or too dear there
            None => return rough.and_then(|found| kept(full, found)).ok_or_else(none),
        };
        evaluations += best.evaluations;
        let residuals = full.residuals(&best.at);
        if residuals.widened() > 1.0 {
            full.widened = residuals.widened();
            // the same branches, and so the same model: nothing is traced for the first of them
            let branch = best.at.branch.take().ok_or_else(none)?;
            best =
                descend_from(full, best.x.clone(), full.evaluate_on(&best.x, branch), None, limits);
            evaluations += best.evaluations;
        }
        if attended.is_stopped() {
            best.converged = false;
        }
        let (branch, resolution) = best.at.branch.clone().ok_or_else(none)?;
        full.attended.tell(Stage::Polish, 2, 3);
        let finer = (full.model.effort.elements as f64 * resolution.factor()).ceil();
        if resolution.is_enough()
            || last
            || attended.is_stopped()
            || full.model.effort.elements as f64 >= FINE.1
        {
            let resolved = resolution.is_enough();
            return Ok(Polished { best, residuals, branch, resolved, evaluations });
        }
        full.widened = 1.0;
        full.model.effort.elements = finer.min(FINE.1) as usize;
        x = best.x;
    }
    Err(FitError::NoStart)
}

/// Leaves out the samples beside jumps, and those beyond the end of a stretch: there the model's slope is
/// infinite, and a straight line through it says nothing.
fn leave_out_jumps(objective: &mut Objective<'_>, found: &Minimum) {
    let stretch = &found.at.prediction.stretch;
    let beyond = &found.at.prediction.beyond;
    let mut first = 0;
    for segment in &objective.curve.segments {
        let end = first + segment.force.len();
        for i in first..end {
            if beyond[i] != 0.0 {
                objective.used[i] = false;
            }
            if i > first && stretch[i] != stretch[i - 1] {
                for near in i.saturating_sub(2).max(first)..(i + 2).min(end) {
                    objective.used[near] = false;
                }
            }
        }
        first = end;
    }
}

/// Residuals beyond this many standard deviations are no measurement of the bubble.
const OUTLIER: f64 = 6.0;
/// Largest share of the samples that may be left out as outliers; beyond it the model is wrong.
const MOST_OUTLIERS: f64 = 0.25;

/// Leaves out outliers, once soft-L1 has led to where the others lie, and reads the noise off the others.
fn leave_out_outliers(objective: &mut Objective<'_>, found: &Minimum) {
    let measured: Vec<f64> =
        objective.curve.segments.iter().flat_map(|s| s.force.iter().copied()).collect();
    let residual: Vec<f64> = measured
        .iter()
        .zip(&found.at.prediction.force)
        .map(|(measured, model)| (measured - model).abs())
        .collect();
    let used = |i: &usize| objective.used[*i];
    let mut sizes: Vec<f64> = (0..residual.len()).filter(used).map(|i| residual[i]).collect();
    // of normal numbers the median is 0.6745 standard deviations
    let Some(spread) = median(&mut sizes).map(|m| m / 0.674_49) else { return };
    let beyond: Vec<usize> =
        (0..residual.len()).filter(used).filter(|&i| residual[i] > OUTLIER * spread).collect();
    if beyond.is_empty() || beyond.len() as f64 > MOST_OUTLIERS * sizes.len() as f64 {
        return;
    }
    for i in beyond {
        objective.used[i] = false;
    }
    objective.noise = spread;
}

/// Minima that are neither the best nor within three standard deviations of it, but fit nearly as well:
/// `χ²` less than 25 larger, of all samples.
fn distinct(thin: &Objective<'_>, minima: &[Minimum], stride: f64) -> Vec<(Parameters, f64)> {
    let Some(best) = minima.first() else { return Vec::new() };
    let mut kept: Vec<&Minimum> = vec![best];
    for minimum in &minima[1..] {
        let near = kept.iter().any(|other| {
            let d: DVector<f64> = &minimum.x - &other.x;
            // the distance in standard deviations, squared
            d.dot(&(&other.at.normal * &d)) * stride < 9.0 * d.len() as f64 * PI.min(2.0)
        });
        if !near && (minimum.at.cost - best.at.cost) * stride < 25.0 {
            kept.push(minimum);
        }
    }
    kept[1..].iter().map(|m| (thin.parameters(&m.x), m.at.cost)).collect()
}
