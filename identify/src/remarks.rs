//! What deserves to be said of a fit, in words and with codes for programs.

use crate::fit::objective::WHITE;
use crate::fit::{Fitted, Setup};
use crate::parameters::Key;
use crate::record::{Estimate, Row, Warning};
use crate::uncertainty::verdict::Reach;
use crate::uncertainty::{Derived, Linear, Quantity};
use nalgebra::SymmetricEigen;

/// Share of the lever's deflection in the travel above which it hides the bubble.
const SOFT_LEVER: f64 = 0.95;
/// Residuals beyond this many standard deviations are outliers.
const OUTLIER: f64 = 5.0;

/// What remarks are made from.
pub(crate) struct Findings<'a> {
    /// What was asked.
    pub(crate) setup: &'a Setup,
    /// The fit.
    pub(crate) fitted: &'a Fitted<'a>,
    /// How far the curve goes.
    pub(crate) reach: Reach,
    /// The parameters as they are reported.
    pub(crate) parameters: &'a [Estimate],
}

/// All remarks on a fit.
pub(crate) fn remarks(found: &Findings<'_>, rows: &[Row]) -> Vec<Warning> {
    let Findings { setup, fitted, reach, parameters } = found;
    let residuals = fitted.residuals;
    let mut out = Vec::new();
    let mut say = |code: &'static str, text: String| out.push(Warning { code, text });
    if !(reach.knee || reach.upturn) {
        say(
            "before-knee",
            format!(
                "the curve ends at {:.1} % of the radius, before the knee and before the upturn: it \
                 fixes sqrt(chi k_b), not E and h one by one; press farther",
                100.0 * reach.deformation
            ),
        );
    }
    if reach.lever_share > SOFT_LEVER {
        say(
            "lever-too-soft",
            format!(
                "{:.0} % of the travel is deflection of the lever: it is too soft for this shell",
                100.0 * reach.lever_share
            ),
        );
    }
    for estimate in *parameters {
        if let Some(pull) = estimate.prior_pull.filter(|pull| pull.abs() > 2.0) {
            let key = &estimate.key;
            let text = format!("the data pull {key} {pull:+.1} standard deviations off its prior");
            say("prior-pulled", text);
        }
        if estimate.at_bound {
            let text = format!("{} is at a bound of the search: it has no interval", estimate.key);
            say("at-bound", text);
        }
    }
    if !fitted.best.converged {
        say("not-settled", "the descent did not settle: no number is called identified".to_owned());
    }
    if residuals.chi2_dof > 2.0 {
        say(
            "poor-fit",
            format!(
                "chi2/dof = {:.2}: the model does not describe this curve within its noise",
                residuals.chi2_dof
            ),
        );
    }
    if residuals.autocorrelation > WHITE {
        say(
            "correlated-residuals",
            format!(
                "residuals of neighbouring samples are correlated ({:.2}): noise that is not white, or \
                 a model that misses something; intervals are widened by {:.2}",
                residuals.autocorrelation,
                fitted.objective.widened.sqrt()
            ),
        );
    }
    if !fitted.others.is_empty() {
        say(
            "several-minima",
            format!(
                "{} other shells fit about as well; the numbers of one alone say too much",
                fitted.others.len()
            ),
        );
    }
    let noise = fitted.objective.noise;
    let far = |r: &&Row| r.residual.abs() > OUTLIER * noise;
    let outliers = rows.iter().filter(far).filter(|r| r.used || setup.robust).count();
    if outliers * 200 > rows.len() {
        let how = match setup.robust {
            true => "they count less, or not at all (fit.csv says which were used)",
            false => "try --robust",
        };
        say(
            "outliers",
            format!("{outliers} samples lie beyond {OUTLIER} standard deviations; {how}"),
        );
    }
    if fitted.look.pull_off == 0.0 && fitted.objective.free.contains(&Key::Adhesion) {
        let text =
            "no attraction is seen above the noise: adhesion and film length are upper bounds";
        say("no-pull-off", text.to_owned());
    }
    if !fitted.branch_resolved {
        let text = "the finest mesh allowed does not resolve the film of this fit";
        say("not-resolved", text.to_owned());
    }
    if fitted.objective.curve.segments.len() < 2 {
        say("one-segment", "the curve has one segment only".to_owned());
    }
    // what the lever's error dominates
    let limited: Vec<&str> = parameters
        .iter()
        .filter(|e| match (e.sd, e.sd_statistical) {
            (Some(all), Some(own)) => {
                Key::of(&e.key)
                    .is_some_and(|key| key.is_logarithmic() && key != Key::SpringConstant)
                    && all > 3.0 * own
                    && all > 0.03 * e.value
            }
            _ => false,
        })
        .map(|e| e.key.as_str())
        .collect();
    let lever = setup.priors.iter().find(|prior| prior.key == Key::SpringConstant);
    if !limited.is_empty() {
        say(
            "spring-constant",
            format!(
                "the lever's stiffness (sd {:.1} %) is what limits {}; calibrate it better, and say so in \
                 spring_constant_sd",
                100.0 * lever.map_or(f64::NAN, |prior| prior.in_coordinate().1),
                limited.join(", ")
            ),
        );
    }
    out
}

/// The combination of the shell's quantities that is known least, in words.
pub(crate) fn weakest(fitted: &Fitted<'_>, known: &Linear) -> String {
    let free = &fitted.objective.free;
    let own = [Key::Chi, Key::Bending, Key::Adhesion, Key::Film, Key::Radius];
    let at: Vec<usize> = (0..free.len()).filter(|k| own.contains(&free[*k])).collect();
    if at.is_empty() {
        return "nothing of the shell was fitted".to_owned();
    }
    let total = &known.covariance;
    let part = nalgebra::DMatrix::from_fn(at.len(), at.len(), |i, j| total[(at[i], at[j])]);
    let eigen = SymmetricEigen::new(part);
    let largest = eigen.eigenvalues.imax();
    let direction = eigen.eigenvectors.column(largest);
    let sd = eigen.eigenvalues[largest].max(0.0).sqrt();
    let mut order: Vec<usize> = (0..at.len()).collect();
    order.sort_by(|a, b| direction[*b].abs().total_cmp(&direction[*a].abs()));
    let (first, second) = (order[0], order.get(1).copied());
    let percent = |sd: f64| format!("{:.2} %", 100.0 * sd);
    let scale = Quantity::Derived(Derived::ForceScale).along(free);
    let scale = scale.map_or(f64::NAN, |along| known.sd(&along));
    let name = |k: usize| free[at[k]].name();
    let moduli = |k: usize| matches!(free[at[k]], Key::Chi | Key::Bending);
    match second {
        Some(second)
            if moduli(first) && moduli(second) && direction[first] * direction[second] < 0.0 =>
        {
            format!(
                "chi and k_b, and so E and h, trade off (sd {} along that direction): sqrt(chi k_b) is \
                 known to {}",
                percent(sd),
                percent(scale)
            )
        }
        Some(second) if direction[second].abs() > 0.4 => {
            let way = if direction[first] * direction[second] < 0.0 {
                "trade off"
            } else {
                "go together"
            };
            format!(
                "{} and {} {way} (sd {} along that direction); sqrt(chi k_b) is known to {}",
                name(first),
                name(second),
                percent(sd),
                percent(scale)
            )
        }
        _ => format!(
            "{} is known least (sd {}); sqrt(chi k_b) is known to {}",
            name(first),
            percent(sd),
            percent(scale)
        ),
    }
}
