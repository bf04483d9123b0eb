//! Fits of measured curves: what is known, the computation, and what becomes files.

mod error;
pub mod files;
pub mod lab;
pub mod plan;
#[cfg(test)]
mod tests;

pub use error::{Failure, Fault, Missing, PlanError, SetupError, Wish};

use crate::case::plain_name;
use identify::data::read::LARGEST;
use identify::data::{jpk, read};
use identify::fit::Setup;
use identify::record::Warning;
use identify::uncertainty::Quantity;
use identify::{Attended, FitError, Identification, LawName, Profiles, Progress};
use lab::{Lab, Wishes};
use std::path::{Path, PathBuf};

/// Difference of `χ²` below which two laws cannot be told apart.
const INDISTINGUISHABLE: f64 = 6.0;

/// What to fit with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Laws {
    /// That of the laboratory's file.
    Known,
    /// This one.
    One(LawName),
    /// Each; the best is reported.
    All,
}

/// A fit of one curve by one or several laws.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The best.
    pub best: Identification,
    /// Each law's `χ²/dof`, or why it has none.
    pub laws: Vec<(LawName, Result<f64, FitError>)>,
}

/// Reads a list of quantities, or `none`.
///
/// # Errors
/// When a quantity has no profile.
pub fn profiles(text: Option<&str>) -> Result<Profiles, SetupError> {
    match text.map(str::trim) {
        None => Ok(Profiles::WhereNeeded),
        Some("none") => Ok(Profiles::None),
        Some(list) => {
            let each = list.split(',').map(str::trim).map(|name| {
                Quantity::of(name)
                    .ok_or_else(|| SetupError::UnknownProfile { name: name.to_owned() })
            });
            Ok(Profiles::These(each.collect::<Result<_, _>>()?))
        }
    }
}

/// Where a curve is: a file, or a place in a map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// The file.
    pub path: PathBuf,
    /// Its number in a map of which all curves are fitted.
    pub number: Option<usize>,
}

impl Source {
    /// What messages call it.
    pub fn label(&self) -> String {
        let file = self.path.display();
        match self.number {
            None => file.to_string(),
            Some(number) => format!("{file}, curve {number}"),
        }
    }

    /// Its name among files: that of its file, and its number in a map.
    pub fn stem(&self) -> String {
        let name = plain_name(&self.path.file_stem().unwrap_or_default().to_string_lossy());
        self.number.map_or(name.clone(), |number| format!("{name}-{number}"))
    }
}

/// The curves of the files: of a map all, unless `data.curve` chooses one.
pub fn sources(paths: &[PathBuf], lab: &Lab) -> Vec<Source> {
    let one = |path: &PathBuf| {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let map = lab.layout.curve.is_none() && jpk::MAPS.contains(&ending.as_str());
        // what cannot be read is told when it is its turn
        let numbers = map.then(|| jpk::numbers(&bytes(path).ok()?).ok()).flatten();
        let source = |number| Source { path: path.clone(), number };
        match numbers.unwrap_or_default() {
            numbers if numbers.len() > 1 => numbers.into_iter().map(|n| source(Some(n))).collect(),
            _ => vec![source(None)],
        }
    };
    paths.iter().flat_map(one).collect()
}

/// The content of a file, unless it is too long for a curve.
fn bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    let file = || path.display().to_string();
    let unreadable = |source| Failure::Unreadable { file: file(), source };
    let size = std::fs::metadata(path).map_err(unreadable)?.len();
    if size > LARGEST {
        return Err(Failure::TooLong { file: file() });
    }
    std::fs::read(path).map_err(unreadable)
}

/// Fits a curve; `attended` may stop it, and then has what was found until then.
///
/// # Errors
/// Why there is no fit; [`Failure::fault`] says whether the input is wrong, or nothing fits, or it was stopped.
pub fn fit_file(
    source: &Source,
    lab: &Lab,
    laws: Laws,
    wishes: Wishes<'_>,
    profiles: &Profiles,
    attended: Attended<'_>,
) -> Result<Outcome, Failure> {
    if attended.is_stopped() {
        return Err(Failure::Fit { curve: source.label(), error: FitError::Stopped });
    }
    let file = source.path.display().to_string();
    let label = source.label();
    let bytes = bytes(&source.path)?;
    let mut layout = lab.layout(wishes);
    layout.curve = source.number.or(layout.curve);
    let mut curve = read(&file, &bytes, &layout).map_err(|error| Failure::Data {
        curve: label.clone(),
        file,
        error: Box::new(error),
    })?;
    curve.name.clone_from(&label);
    let chosen: Vec<LawName> = match laws {
        Laws::All => LawName::ALL.to_vec(),
        Laws::One(law) => vec![law],
        Laws::Known => lab.law.into_iter().collect(),
    };
    if let [law] = chosen[..] {
        Lab::allows(law, wishes)?;
    }
    let mut found: Vec<(LawName, Setup, Result<Identification, FitError>)> = Vec::new();
    let laws = chosen.len() as f64;
    for (done, law) in chosen.into_iter().enumerate() {
        let setup = lab.setup(law, curve.spring_constant, wishes)?;
        // each law has its share of the progress
        let tell = |progress: Progress| {
            if let Some(listener) = attended.listener {
                listener(Progress { share: (done as f64 + progress.share) / laws, ..progress });
            }
        };
        let own = Attended { listener: Some(&tell), ..attended };
        let fitted = identify::identify_attended(&curve, &setup, profiles, own);
        found.push((law, setup, fitted));
    }
    let chi2 = |i: &Identification| i.report.quality.chi2_dof;
    let laws: Vec<(LawName, Result<f64, FitError>)> = found
        .iter()
        .map(|(law, _, fit)| (*law, fit.as_ref().map(chi2).map_err(FitError::clone)))
        .collect();
    found.sort_by(|a, b| {
        let of = |f: &Result<Identification, FitError>| f.as_ref().map_or(f64::INFINITY, chi2);
        of(&a.2).total_cmp(&of(&b.2))
    });
    let second = found.get(1).and_then(|(law, _, fit)| Some((*law, chi2(fit.as_ref().ok()?))));
    let Some((_, setup, best)) = found.into_iter().next() else {
        return Err(SetupError::from(Missing::Law).into());
    };
    let mut best = best.map_err(|error| Failure::Fit { curve: label, error })?;
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
