//! The moduli that simulated curves give back (Fig. 9).

use super::curve::Traced;
use serde::Serialize;
use shell_contact::identify::{
    Combination, Estimate, ForceCurve, Formulas, IdentifyError, Known, Reading, estimate,
};
use study::case::ProblemCase;

/// Estimated moduli, in SI units for a physical case.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Recovered(Estimate);

impl Recovered {
    /// `χ`.
    pub(crate) fn chi(&self) -> f64 {
        self.0.chi
    }

    /// `k_b`.
    pub(crate) fn bending(&self) -> f64 {
        self.0.bending
    }
}

/// What a curve gives back, beside what made it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct EstimateRow {
    /// The figure.
    pub figure: u32,
    /// The curve.
    pub curve: String,
    /// Which parts of it were combined.
    pub combination: String,
    /// Which formulas.
    pub formulas: String,
    /// Found and true: `χ` in N/m.
    pub chi: [Option<f64>; 2],
    /// `k_b` in N m.
    pub bending: [Option<f64>; 2],
    /// Young's modulus in Pa.
    pub young: [Option<f64>; 2],
    /// Thickness in m.
    pub thickness: [Option<f64>; 2],
    /// Which parts of the curve were used, or why there is no estimate.
    pub used: String,
}

/// The estimate from a branch by one combination.
///
/// # Errors
/// When the curve does not show the regimes.
pub(crate) fn recover(
    traced: &Traced,
    combination: Combination,
    formulas: Formulas,
) -> Result<Recovered, IdentifyError> {
    let points = &traced.branch.branch.points;
    let (mut deformation, mut force) = (Vec::new(), Vec::new());
    for (i, q) in points.iter().enumerate() {
        let d = traced.branch.deformation(q.p).unwrap_or(f64::NAN) * traced.radius();
        if d > deformation.last().copied().unwrap_or(0.0) {
            deformation.push(d);
            force.push(traced.observable(i, "force") * traced.force_unit());
        }
    }
    let curve = ForceCurve::new(&deformation, &force, Reading::OnePole)?;
    let g = traced.problem.groups();
    let known = Known {
        radius: traced.radius(),
        poisson: traced.problem.shell().poisson,
        pressure: g.pressure * traced.chi() / traced.radius(),
        gas_exponent: g.gas_exponent,
    };
    estimate(&curve, &known, combination, formulas).map(Recovered)
}

/// The table of Fig. 9.
pub(super) fn table(traced: &[Traced]) -> Vec<EstimateRow> {
    use Combination::{KneeDimple, SlopeDimple, SlopeKnee, SlopeUpturn};
    use Formulas::{Corrected, Printed};
    let hard = [
        (SlopeDimple, Printed),
        (SlopeKnee, Printed),
        (SlopeDimple, Corrected),
        (SlopeKnee, Corrected),
        (KneeDimple, Corrected),
    ];
    let soft = [(SlopeUpturn, Printed), (SlopeUpturn, Corrected)];
    let mut rows = Vec::new();
    for traced in traced.iter().filter(|t| t.figure == 9 && physical(t)) {
        let ways: &[(Combination, Formulas)] = if traced.name == "hard" { &hard } else { &soft };
        rows.extend(
            ways.iter().map(|(combination, formulas)| row(traced, *combination, *formulas)),
        );
    }
    rows
}

fn physical(traced: &Traced) -> bool {
    matches!(&traced.case.problem, ProblemCase::Contact(contact) if contact.physical.is_some())
}

fn row(traced: &Traced, combination: Combination, formulas: Formulas) -> EstimateRow {
    let thickness = traced.thickness() * traced.radius();
    let bending = traced.bending() * traced.chi() * traced.radius().powi(2);
    let found = recover(traced, combination, formulas);
    let used = match &found {
        Ok(found) => {
            let parts = found.0.parts.iter().map(|part| {
                let name = format!("{:?}", part.regime).to_lowercase();
                if part.from == part.to {
                    format!("{name} at {:.0} nm", part.to * 1e9)
                } else {
                    format!("{name} {:.0} to {:.0} nm", part.from * 1e9, part.to * 1e9)
                }
            });
            parts.collect::<Vec<_>>().join(", ")
        }
        Err(error) => error.to_string(),
    };
    let found = found.ok().map(|found| found.0);
    let pair = |of: fn(&Estimate) -> f64, known: f64| [found.as_ref().map(of), Some(known)];
    EstimateRow {
        figure: traced.figure,
        curve: traced.name.clone(),
        combination: match combination {
            Combination::SlopeDimple => "slope and dimple",
            Combination::SlopeKnee => "slope and knee",
            Combination::KneeDimple => "knee and dimple",
            Combination::SlopeUpturn => "slope and upturn",
        }
        .to_owned(),
        formulas: match formulas {
            Formulas::Printed => "printed",
            Formulas::Corrected => "corrected",
        }
        .to_owned(),
        chi: pair(|e| e.chi, traced.chi()),
        bending: pair(|e| e.bending, bending),
        young: pair(|e| e.young, traced.chi() / thickness),
        thickness: pair(|e| e.thickness, thickness),
        used,
    }
}
