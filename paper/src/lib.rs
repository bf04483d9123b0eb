//! The figures of the reference paper, computed.
//!
//! `manifest` says what each shows, `curve` traces its branches, `panels` turns them into
//! drawings, `claims` compares the paper's statements with what was computed, `page` shows it
//! all in one file.

mod claims;
mod curve;
mod estimates;
mod files;
mod laws;
mod manifest;
mod number;
mod page;
mod panels;
mod ring;
mod windows;

pub use files::{files, json, summary};

use claims::Claim;
use curve::Traced;
use estimates::EstimateRow;
use manifest::{FIGURES, Manifest, OWN, SCHEMATIC, STABILITY};
use pictures::Sheet;
use ring::RingBranch;
use std::sync::atomic::AtomicBool;
use study::case::{LoadError, Override};
use study::run::RunError;

/// Why figures cannot be computed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// No figure of that number.
    #[error("there is no figure \"{asked}\"; computed are {}, \"stability\", or \"all\"", known())]
    Unknown {
        /// What was asked for.
        asked: String,
    },
    /// Nothing is computed in that figure.
    #[error(
        "figure {number} is {what}: nothing is computed in it; computed are {}, or \"all\"",
        known()
    )]
    Schematic {
        /// Its number.
        number: u32,
        /// What it is.
        what: &'static str,
    },
    /// An option that does not go with the figure's cases.
    #[error(transparent)]
    Case(#[from] LoadError),
    /// An embedded manifest is wrong.
    #[error("figure {figure}: {detail}")]
    Manifest {
        /// The figure.
        figure: u32,
        /// What is wrong.
        detail: String,
    },
    /// A branch without a start.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// The figures that there are, in words.
fn known() -> String {
    FIGURES.iter().map(|(number, _)| number.to_string()).collect::<Vec<_>>().join(", ")
}

/// The numbers that were asked for, in order, each once.
///
/// # Errors
/// When one of them is no figure that is computed.
pub fn numbers(asked: &[String]) -> Result<Vec<u32>, FigureError> {
    let mut numbers = Vec::new();
    for word in asked {
        if word == "all" {
            numbers.extend(FIGURES.iter().map(|(number, _)| *number));
            continue;
        }
        if word == "stability" {
            numbers.push(STABILITY);
            continue;
        }
        let unknown = || FigureError::Unknown { asked: study::case::shown(word) };
        let number: u32 = word.parse().map_err(|_| unknown())?;
        if let Some((_, what)) = SCHEMATIC.iter().find(|(known, _)| *known == number) {
            return Err(FigureError::Schematic { number, what });
        }
        if !FIGURES.iter().any(|(known, _)| *known == number) {
            return Err(unknown());
        }
        numbers.push(number);
    }
    numbers.sort_unstable();
    numbers.dedup();
    Ok(numbers)
}

/// A computed figure.
pub(crate) struct Figure {
    /// What it shows.
    pub(crate) manifest: Manifest,
    /// The drawing.
    pub(crate) sheet: Sheet,
    /// Its branches.
    pub(crate) traced: Vec<Traced>,
}

/// Everything that was computed.
pub struct Computed {
    /// The figures.
    pub(crate) figures: Vec<Figure>,
    /// The paper's statements about them.
    pub(crate) claims: Vec<Claim>,
    /// Branches of the ring load, of Fig. 4.
    pub(crate) rings: Vec<RingBranch>,
    /// Moduli that curves give back.
    pub(crate) estimates: Vec<EstimateRow>,
    /// Branches that ended early, and why; states that were not reached.
    pub early: Vec<String>,
}

/// Where a computation stands.
#[derive(Debug, Clone, Copy)]
pub struct Progress {
    /// Branches that are done.
    pub done: usize,
    /// Branches in all.
    pub all: usize,
}

/// Checked work.
pub struct Plan {
    manifests: Vec<Manifest>,
    jobs: Vec<curve::Job>,
}

/// What is to be computed, with everything checked that can be before.
///
/// # Errors
/// When an override is not allowed.
pub fn plan(numbers: &[u32], overrides: &[Override]) -> Result<Plan, FigureError> {
    let (mut manifests, mut jobs) = (Vec::new(), Vec::new());
    let known = FIGURES.iter().chain([&OWN]);
    for (figure, text) in known.filter(|(number, _)| numbers.contains(number)) {
        let manifest = manifest::parse(text).map_err(|error| FigureError::Manifest {
            figure: *figure,
            detail: error.to_string(),
        })?;
        jobs.extend(curve::jobs(&manifest, overrides)?);
        manifests.push(manifest);
    }
    Ok(Plan { manifests, jobs })
}

impl Plan {
    /// Computes it.
    ///
    /// # Errors
    /// When a branch has no start.
    pub fn compute(
        self,
        stop: &AtomicBool,
        hear: &mut dyn FnMut(Progress),
    ) -> Result<Computed, FigureError> {
        let all = self.jobs.len();
        let traced = curve::trace_all(self.jobs, stop, &mut |done| hear(Progress { done, all }))?;
        let mut early: Vec<String> = traced
            .iter()
            .filter(|t| !t.branch.branch.stopped.reason.is_complete())
            .map(|t| {
                let stopped = &t.branch.branch.stopped;
                let at = t.branch.branch.points.last().map_or(f64::NAN, |q| q.p);
                let (reason, detail) = (stopped.reason, &stopped.detail);
                format!("figure {}, curve {}: {reason} at z0 = {at:.6}: {detail}", t.figure, t.name)
            })
            .collect();
        for t in &traced {
            let scanned = t.scanned.as_ref().map(|scanned| scanned.points.len());
            if scanned.is_some_and(|points| points < t.branch.branch.points.len()) {
                early.push(format!(
                    "{}, curve {}: stability not scanned to its end",
                    manifest::stem(t.figure),
                    t.name
                ));
            }
        }
        let rings: Vec<RingBranch> = self
            .manifests
            .iter()
            .filter(|m| m.panels.iter().any(|panel| panel.ring_load))
            .filter_map(|m| Some((m, traced.iter().find(|t| t.figure == m.number)?)))
            .flat_map(|(m, t)| {
                let shown = m.panels.iter().filter(|panel| panel.ring_load);
                let wanted: Vec<f64> =
                    shown.flat_map(|panel| &panel.states).copied().filter(|d| *d > 0.0).collect();
                ring::branches(t, &wanted, stop)
            })
            .collect();
        let claims = claims::of(&traced, &rings);
        let estimates = estimates::table(&traced);
        let mut rest = traced;
        let mut figures = Vec::new();
        for manifest in self.manifests {
            let (traced, others) = rest.into_iter().partition(|t| t.figure == manifest.number);
            rest = others;
            let traced: Vec<Traced> = traced;
            let views: Vec<&Traced> = traced.iter().collect();
            early.extend(panels::not_reached(&manifest, &views));
            let sheet = Sheet {
                title: manifest.heading(),
                subtitle: String::new(),
                panels: panels::panels(&manifest, &views, &rings),
            };
            figures.push(Figure { manifest, sheet, traced });
        }
        Ok(Computed { figures, claims, rings, estimates, early })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_say_which_figures_there_are() {
        let ask =
            |words: &[&str]| numbers(&words.iter().map(|w| (*w).to_owned()).collect::<Vec<_>>());
        assert_eq!(ask(&["12", "6", "12"]).unwrap(), [6, 12]);
        assert_eq!(ask(&["all"]).unwrap().len(), FIGURES.len());
        assert_eq!(ask(&["stability"]).unwrap(), [STABILITY]);
        let error = ask(&["21"]).unwrap_err().to_string();
        assert!(error.contains("\"21\"") && error.contains("19, 20"), "{error}");
        let error = ask(&["8"]).unwrap_err().to_string();
        assert!(error.contains("figure 8 is a sketch"), "{error}");
    }

    #[test]
    fn figures_at_few_elements_have_all_their_panels() {
        let stop = AtomicBool::new(false);
        let computed = plan(&[4, 12, 20], &[Override::new("mesh.elements=60")])
            .unwrap()
            .compute(&stop, &mut |_| {})
            .unwrap();
        assert!(computed.early.is_empty(), "{:?}", computed.early);
        for figure in &computed.figures {
            assert_eq!(figure.sheet.panels.len(), figure.manifest.panels.len());
            for (panel, spec) in figure.sheet.panels.iter().zip(&figure.manifest.panels) {
                assert!(panel.lines.len() >= spec.states.len().max(1), "{}", panel.title);
                let points = panel.lines.iter().map(|l| l.curve.x.len());
                assert!(points.min().unwrap() > 1);
            }
        }
        let names: Vec<String> = files(&computed, Some(&study::case::PictureCase::default()))
            .unwrap()
            .into_iter()
            .map(|(name, _)| name)
            .collect();
        for name in ["index.html", "claims.json", "fig12.svg", "fig20.png", "data/fig12-d.csv"] {
            assert!(names.iter().any(|n| n == name), "{name}: {names:?}");
        }
    }

    #[test]
    fn a_stopped_computation_keeps_what_there_is() {
        let computed = plan(&[7], &[Override::new("mesh.elements=60")])
            .unwrap()
            .compute(&AtomicBool::new(true), &mut |_| {})
            .unwrap();
        assert_eq!(computed.early.len(), 1);
        assert!(computed.early[0].contains("interrupted"), "{:?}", computed.early);
    }
}
