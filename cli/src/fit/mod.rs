//! Fits of measured curves: what is known, the computation, and what becomes files.

pub(crate) mod files;
pub(crate) mod lab;
mod picture;
pub(crate) mod plan;

use identify::data::read;
use identify::data::read::LARGEST;
use identify::fit::Setup;
use identify::record::Warning;
use identify::uncertainty::Quantity;
use identify::{FitError, Identification, LawName, Profiles};
use lab::{Lab, Wishes};
use std::path::Path;

/// Difference of `χ²` below which two laws cannot be told apart.
const INDISTINGUISHABLE: f64 = 6.0;

/// What to fit with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Laws {
    /// That of the laboratory's file.
    Known,
    /// This one.
    One(LawName),
    /// Each; the best is reported.
    All,
}

/// A fit of one curve by one or several laws.
#[derive(Debug, Clone)]
pub(crate) struct Outcome {
    /// The best.
    pub(crate) best: Identification,
    /// Each law's `χ²/dof`, or why it has none.
    pub(crate) laws: Vec<(LawName, Result<f64, String>)>,
}

/// Why a curve has no fit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Failure {
    /// Its file, or what is known, is wrong.
    Input(String),
    /// Nothing fits it.
    NotFound(String),
}

impl Failure {
    /// What happened.
    pub(crate) fn message(&self) -> &str {
        match self {
            Failure::Input(message) | Failure::NotFound(message) => message,
        }
    }
}

/// Reads a list of quantities, or `none`.
pub(crate) fn profiles(text: Option<&str>) -> Result<Profiles, String> {
    match text.map(str::trim) {
        None => Ok(Profiles::WhereNeeded),
        Some("none") => Ok(Profiles::None),
        Some(list) => {
            let each = list.split(',').map(str::trim).map(|name| {
                Quantity::of(name).ok_or_else(|| {
                    format!(
                        "--profile {name}: unknown; allowed: none, or young, thickness, sqrt_chi_kb, \
                         chi, bending, adhesion, film, radius, apart by commas"
                    )
                })
            });
            Ok(Profiles::These(each.collect::<Result<_, _>>()?))
        }
    }
}

/// Fits a file.
pub(crate) fn fit_file(
    path: &Path,
    lab: &Lab,
    laws: Laws,
    wishes: Wishes<'_>,
    profiles: &Profiles,
) -> Result<Outcome, Failure> {
    let file = path.display().to_string();
    let input = |message: String| Failure::Input(message);
    let size = std::fs::metadata(path)
        .map_err(|error| input(format!("{file}: cannot be read: {error}")))?
        .len();
    if size > LARGEST {
        return Err(input(format!("{file}: longer than {LARGEST} bytes; this is not a curve")));
    }
    let bytes =
        std::fs::read(path).map_err(|error| input(format!("{file}: cannot be read: {error}")))?;
    let curve = read(&file, &bytes, &lab.layout).map_err(|error| input(error.to_string()))?;
    let chosen: Vec<LawName> = match laws {
        Laws::All => LawName::ALL.to_vec(),
        Laws::One(law) => vec![law],
        Laws::Known => match lab.law {
            Some(law) => vec![law],
            None => {
                return Err(input(
                    "shell.law: missing; say law = \"hooke\", \"mooney-rivlin\" or \"skalak\" in the file \
                     of known values, or --law NAME, or --law all"
                        .to_owned(),
                ));
            }
        },
    };
    let mut found: Vec<(LawName, Setup, Result<Identification, FitError>)> = Vec::new();
    for law in chosen {
        let setup = lab.setup(law, curve.spring_constant, wishes).map_err(input)?;
        let fitted = identify::identify(&curve, &setup, profiles);
        found.push((law, setup, fitted));
    }
    let chi2 = |i: &Identification| i.report.quality.chi2_dof;
    let laws: Vec<(LawName, Result<f64, String>)> = found
        .iter()
        .map(|(law, _, fit)| (*law, fit.as_ref().map(chi2).map_err(ToString::to_string)))
        .collect();
    found.sort_by(|a, b| {
        let of = |f: &Result<Identification, FitError>| f.as_ref().map_or(f64::INFINITY, chi2);
        of(&a.2).total_cmp(&of(&b.2))
    });
    let second = found.get(1).and_then(|(law, _, fit)| Some((*law, chi2(fit.as_ref().ok()?))));
    let Some((_, setup, best)) = found.into_iter().next() else {
        return Err(input("no law".to_owned()));
    };
    let mut best = best.map_err(|error| match error {
        FitError::NoStart | FitError::Model(_) => Failure::NotFound(format!("{file}: {error}")),
        other => Failure::Input(format!("{file}: {other}")),
    })?;
    if let (Some(stated), known) =
        (curve.spring_constant, setup.base[identify::Key::SpringConstant])
        && (stated / known - 1.0).abs() > 1e-6
    {
        let text = format!(
            "the curve's file states a spring constant of {stated} N/m; {known} N/m is taken, as the \
             file of known values says, and forces are those of the same deflections"
        );
        best.report.warnings.push(Warning { code: "spring-constant-differs", text });
    }
    for note in &curve.notes {
        best.report.warnings.push(Warning { code: "data", text: note.clone() });
    }
    if lab.radius_is_exact() && !setup.free.contains(&identify::Key::Radius) {
        let text =
            "the radius stands without an error (radius_sd) and is kept; an optical radius has one";
        best.report.warnings.push(Warning { code: "radius-exact", text: text.to_owned() });
    }
    if let Some((law, other)) = second {
        let dof = best.report.quality.samples_used as f64;
        if (other - chi2(&best)) * dof < INDISTINGUISHABLE {
            let text = format!(
                "the laws {} and {} describe the curve equally well; it does not reach strains that tell \
                 them apart",
                best.report.law,
                law.name()
            );
            best.report.warnings.push(Warning { code: "laws-indistinguishable", text });
        }
    }
    Ok(Outcome { best, laws })
}
