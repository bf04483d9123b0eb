//! From a curve and what is known of it to a report.

use crate::attend::{Attended, Stage};
use crate::data::Curve;
use crate::error::FitError;
use crate::fit::objective::{DerivedPrior, WHITE};
use crate::fit::{COARSE, COARSE_ERROR, Fitted, Setup, descent, elements, fit, refit};
use crate::parameters::{Key, Parameters};
use crate::record::{
    Baseline, Cost, Estimate, Jump, PriorRecord, ProfileRecord, PullOff, Quality, Report, Row,
};
use crate::remarks::{Findings, remarks, weakest};
use crate::uncertainty::profile::{Profile, profile};
use crate::uncertainty::verdict::{Reach, judge, reach};
use crate::uncertainty::{Derived, Linear, Quantity, linear};

/// Condition number beyond which the parabola is not trusted.
const ILL_CONDITIONED: f64 = 1e3;
/// `χ²/dof` beyond which no profile is followed unless it is asked for.
const MEANINGLESS: f64 = 10.0;
/// The quantities whose profiles are followed where it is not.
pub const PROFILED: [Quantity; 4] = [
    Quantity::Derived(Derived::Young),
    Quantity::Derived(Derived::Thickness),
    Quantity::Key(Key::Chi),
    Quantity::Key(Key::Bending),
];

/// Which profiles are followed.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Profiles {
    /// Those of the moduli where the covariance is not to be trusted.
    #[default]
    WhereNeeded,
    /// These.
    These(Vec<Quantity>),
    /// None: where they would be needed nothing is called identified.
    None,
}

/// A fit with all that is said of it.
#[derive(Debug, Clone)]
pub struct Identification {
    /// The report.
    pub report: Report,
    /// The samples with the model.
    pub rows: Vec<Row>,
    /// The parameters, fixed ones included.
    pub parameters: Parameters,
}

/// Fits a curve and says how well its parameters are known.
///
/// # Errors
/// When there is nothing to fit, or no start leads anywhere.
pub fn identify(
    curve: &Curve,
    setup: &Setup,
    profiles: &Profiles,
) -> Result<Identification, FitError> {
    identify_attended(curve, setup, profiles, Attended::default())
}

/// The same for somebody who waits: told of progress, and obeyed within a fraction of a millisecond when the fit is
/// to stop. What was found is reported then, with the warning `stopped`: the best shell so far, or the fit with
/// the profiles that were followed to their ends.
///
/// # Errors
/// As [`identify`]; [`FitError::Stopped`] when it is stopped before a first shell was found.
pub fn identify_attended(
    curve: &Curve,
    setup: &Setup,
    profiles: &Profiles,
    attended: Attended<'_>,
) -> Result<Identification, FitError> {
    let setup = &setup.with_lever();
    let mut fitted = fit(curve, setup, attended)?;
    let mut evaluations = 0;
    // a profile that finds a lower minimum starts the fit again from there, once
    for again in [true, false] {
        let known = linear(&fitted);
        let reach = reach(&fitted);
        let wanted = wanted(profiles, &fitted, &known, reach);
        let found = follow(&fitted, &known, &wanted);
        evaluations += found.iter().map(|p| p.evaluations).sum::<usize>();
        let better = found.iter().find_map(|p| p.better.clone());
        if let (Some(x), true) = (better, again && !attended.is_stopped()) {
            let before = fitted.clone();
            match refit(fitted, &x) {
                Ok(better) => {
                    fitted = better;
                    continue;
                }
                // a stop keeps what there was
                Err(FitError::Stopped) => fitted = before,
                Err(error) => return Err(error),
            }
        }
        return Ok(report(curve, setup, profiles, &fitted, &known, reach, &found, evaluations));
    }
    Err(FitError::NoStart)
}

/// Whether the covariance of the moduli may be believed.
fn is_parabola(fitted: &Fitted<'_>, known: &Linear, reach: Reach) -> bool {
    let regimes = reach.knee || reach.upturn;
    let bounds = known.at_bound.iter().any(|b| *b);
    let white = fitted.residuals.autocorrelation <= WHITE;
    regimes
        && !bounds
        && white
        && known.condition <= ILL_CONDITIONED
        && fitted.others.is_empty()
        && fitted.residuals.chi2_dof <= 2.0
}

fn wanted(profiles: &Profiles, fitted: &Fitted<'_>, known: &Linear, reach: Reach) -> Vec<Quantity> {
    match profiles {
        Profiles::None => Vec::new(),
        Profiles::These(these) => these.clone(),
        Profiles::WhereNeeded if is_parabola(fitted, known, reach) => Vec::new(),
        // intervals of a model that does not describe the curve say nothing
        Profiles::WhereNeeded if fitted.residuals.chi2_dof > MEANINGLESS => Vec::new(),
        Profiles::WhereNeeded => PROFILED.to_vec(),
    }
}

/// Profiles on a coarse mesh, about the minimum there.
fn follow(fitted: &Fitted<'_>, known: &Linear, wanted: &[Quantity]) -> Vec<Profile> {
    if wanted.is_empty() {
        return Vec::new();
    }
    let mut coarse = fitted.objective.clone();
    let p = coarse.parameters(&fitted.best.x);
    coarse.model.effort.elements = elements(&p, COARSE, 1.0);
    coarse.model.effort.force_error = 0.1 * COARSE_ERROR * coarse.noise;
    let limits = descent::Limits { evaluations: 10, tolerance: 1e-3, damping: descent::BOLD };
    let Some(minimum) = descent::descend(&coarse, &fitted.best.x, None, limits) else {
        return Vec::new();
    };
    wanted
        .iter()
        .enumerate()
        .filter_map(|(done, quantity)| {
            coarse.attended.tell(Stage::Profiles, done, wanted.len());
            let along = quantity.along(&coarse.free)?;
            let found = profile(&coarse, &minimum, *quantity, known.sd(&along));
            // half a profile is none
            found.filter(|_| !coarse.attended.is_stopped())
        })
        .collect()
}

#[allow(clippy::too_many_arguments)] // everything that is known of a fit
fn report(
    curve: &Curve,
    setup: &Setup,
    profiles: &Profiles,
    fitted: &Fitted<'_>,
    known: &Linear,
    reach: Reach,
    found: &[Profile],
    evaluations: usize,
) -> Identification {
    let objective = &fitted.objective;
    let p = objective.parameters(&fitted.best.x);
    let parabola = is_parabola(fitted, known, reach);
    let settled = fitted.best.converged && fitted.residuals.chi2_dof <= 2.0;
    let describe = |quantity: Quantity| {
        let profile = found.iter().find(|profile| profile.quantity == quantity);
        let moduli = PROFILED.contains(&quantity);
        // what fixes the moduli one by one is the knee or the upturn
        let regimes = !moduli || reach.knee || reach.upturn;
        let seen = !moduli || parabola || profile.is_some();
        let trusted = settled && regimes && seen && fitted.others.is_empty();
        estimate(quantity, setup, &p, fitted, known, profile, trusted)
    };
    let free = objective.free.iter().map(|key| describe(Quantity::Key(*key)));
    let fixed = Key::ALL
        .into_iter()
        .filter(|key| !objective.free.contains(key) && p[*key].is_finite())
        .map(|key| fixed(key, &p));
    let parameters: Vec<Estimate> = free.chain(fixed).collect();
    let derived: Vec<Estimate> = [Derived::Young, Derived::Thickness, Derived::ForceScale]
        .into_iter()
        .map(|d| describe(Quantity::Derived(d)))
        .collect();
    let (rows, jumps, pull_off) = samples(curve, fitted, &p);
    let findings = Findings { setup, fitted, reach, parameters: &parameters };
    let mut warnings = remarks(&findings, &rows);
    if *profiles == Profiles::None && !parabola {
        warnings.push(crate::record::Warning {
            code: "profile-needed",
            text: "the covariance of the moduli is not to be trusted here and no profile was followed: \
                   none of them is called identified"
                .to_owned(),
        });
    }
    if objective.attended.is_stopped() {
        warnings.push(crate::record::Warning {
            code: "stopped",
            text: "the fit was stopped before its end: this is the best that was found until then, without the \
                   profiles that were still to be followed"
                .to_owned(),
        });
    }
    let quality = Quality {
        chi2_dof: fitted.residuals.chi2_dof,
        noise: objective.noise,
        residual_autocorrelation: fitted.residuals.autocorrelation,
        widened: objective.widened,
        condition: known.condition,
        samples_used: objective.count(),
        samples: curve.len(),
        starts: fitted.starts,
        minima: 1 + fitted.others.len(),
        converged: fitted.best.converged,
        elements: objective.model.effort.elements,
    };
    let report = Report {
        curve: curve.name.clone(),
        law: setup.law.name(),
        contacts: setup.contacts,
        weakest_direction: weakest(fitted, known),
        contact: p[Key::Contact],
        baseline: Baseline { offset: p[Key::Offset], tilt: p[Key::Tilt] },
        parameters,
        derived,
        jumps,
        pull_off,
        reach,
        quality,
        warnings,
        profiles: found.iter().map(|profile| record(profile, &p)).collect(),
        cost: Cost { evaluations: fitted.evaluations + evaluations },
    };
    Identification { report, rows, parameters: p }
}

fn record(profile: &Profile, p: &Parameters) -> ProfileRecord {
    let value = profile.quantity.value(p);
    ProfileRecord {
        key: profile.quantity.name().to_owned(),
        values: profile.points.iter().map(|x| profile.quantity.shifted(value, x.offset)).collect(),
        points: profile.points.clone(),
    }
}

/// A quantity that was not fitted.
fn fixed(key: Key, p: &Parameters) -> Estimate {
    Estimate {
        key: key.name().to_owned(),
        value: p[key],
        unit: key.unit(),
        sd: None,
        sd_statistical: None,
        interval68: [None; 2],
        interval95: [None; 2],
        method: "fixed",
        prior: None,
        prior_pull: None,
        at_bound: false,
        verdict: None,
    }
}

fn estimate(
    quantity: Quantity,
    setup: &Setup,
    p: &Parameters,
    fitted: &Fitted<'_>,
    known: &Linear,
    profile: Option<&Profile>,
    trusted: bool,
) -> Estimate {
    let free = &fitted.objective.free;
    let value = quantity.value(p);
    let to_value = if quantity.is_logarithmic() { value } else { 1.0 };
    let along = quantity.along(free);
    let prior = match quantity {
        Quantity::Key(key) => setup.priors.iter().find(|prior| prior.key == key),
        Quantity::Derived(_) => None,
    };
    let derived = match quantity {
        Quantity::Derived(of) => setup.derived.iter().find(|prior| prior.of == of),
        Quantity::Key(_) => None,
    };
    let at_bound = along.as_ref().is_some_and(|along| {
        known.at_bound.iter().zip(along.iter()).any(|(bound, a)| *bound && *a != 0.0)
    });
    let sd = along.as_ref().map_or(f64::NAN, |along| known.sd(along));
    let own = along.as_ref().map_or(f64::NAN, |along| known.sd_at_known_lever(along));
    // half widths below and above, in the coordinate
    let widths = |factor: f64, interval: Option<[Option<f64>; 2]>| -> [Option<f64>; 2] {
        match interval {
            _ if at_bound => [None; 2],
            Some(ends) => ends.map(|end| end.map(f64::abs)),
            None => [Some(factor * sd); 2],
        }
    };
    let ends = |widths: [Option<f64>; 2]| {
        [
            widths[0].map(|w| quantity.shifted(value, -w)),
            widths[1].map(|w| quantity.shifted(value, w)),
        ]
    };
    let (half68, half95) =
        (widths(1.0, profile.map(|p| p.interval68)), widths(1.96, profile.map(|p| p.interval95)));
    let total = match half68 {
        [Some(low), Some(high)] => Some(0.5 * (low + high)),
        _ => None,
    };
    let prior_sd = prior.map(|prior| prior.in_coordinate().1);
    let prior_sd = prior_sd.or(derived.map(DerivedPrior::relative_sd));
    // of baseline and contact point what matters is how far they are known beside their range
    let verdict = if quantity.is_logarithmic() {
        let half = if half95.iter().all(Option::is_some) { half68 } else { [None; 2] };
        judge(half, prior_sd, trusted)
    } else {
        let typical = match quantity {
            Quantity::Key(Key::Contact) => 0.1 * p[Key::Radius],
            Quantity::Key(Key::Offset) => 20.0 * fitted.objective.noise,
            Quantity::Key(Key::Tilt) => 20.0 * fitted.objective.noise / p[Key::Radius],
            _ => value.abs().max(0.1),
        };
        judge(half68.map(|h| h.map(|h| h / typical)), prior_sd.map(|sd| sd / typical), trusted)
    };
    Estimate {
        key: quantity.name().to_owned(),
        value,
        unit: quantity.unit(),
        sd: total.map(|sd| sd * to_value),
        sd_statistical: (!at_bound && own.is_finite()).then_some(own * to_value),
        interval68: ends(half68),
        interval95: ends(half95),
        method: if profile.is_some() { "profile" } else { "covariance" },
        prior: prior
            .map(|prior| PriorRecord { value: prior.value, sd: prior.sd })
            .or(derived.map(|prior| PriorRecord { value: prior.value, sd: prior.sd })),
        prior_pull: prior
            .map(|prior| {
                let (centre, sd) = prior.in_coordinate();
                (prior.key.coordinate(value) - centre) / sd
            })
            .or(derived.map(|prior| prior.pull(p))),
        at_bound,
        verdict: Some(verdict),
    }
}

fn samples(curve: &Curve, fitted: &Fitted<'_>, p: &Parameters) -> (Vec<Row>, Vec<Jump>, PullOff) {
    let objective = &fitted.objective;
    let weight = 1.0 / objective.noise;
    let prediction = objective.model.predict(curve, &fitted.branch, p, &[], weight);
    let farthest = curve.farthest();
    let baseline = |height: f64| p[Key::Offset] + p[Key::Tilt] * (farthest - height);
    let (mut rows, mut jumps) = (Vec::new(), Vec::new());
    let (mut measured, mut modelled) = (0.0_f64, 0.0_f64);
    let mut i = 0;
    for segment in &curve.segments {
        for (k, (height, force)) in segment.height.iter().zip(&segment.force).enumerate() {
            let model = prediction.force[i];
            let level = baseline(*height);
            measured = measured.min(force - level);
            modelled = modelled.min(model - level);
            if k > 0 && prediction.stretch[i] != prediction.stretch[i - 1] {
                let stretch = &fitted.branch.stretches[prediction.stretch[i - 1]];
                let inwards = prediction.stretch[i] > prediction.stretch[i - 1];
                let (fold, is_fold) = match inwards {
                    true => (stretch.to, stretch.ends_at_fold),
                    false => (stretch.from, stretch.begins_at_fold),
                };
                jumps.push(Jump {
                    direction: segment.direction.name(),
                    height_measured: segment.height[k - 1],
                    height_modelled: is_fold.then_some(p[Key::Contact] - fold),
                    force_before: segment.force[k - 1] - level,
                    force_after: force - level,
                });
            }
            let z = prediction.height[i];
            rows.push(Row {
                segment: segment.direction.name(),
                piezo: *height,
                separation: 2.0 * p[Key::Radius] * z,
                approach_one_pole: p[Key::Radius] * (1.0 - z),
                force: *force,
                model,
                residual: force - model,
                used: objective.used[i],
            });
            i += 1;
        }
    }
    (rows, jumps, PullOff { measured, modelled })
}
