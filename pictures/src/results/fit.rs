//! Files of fits of one curve or of many, and of plans of measurements.

use super::{Results, Wanted};
use crate::REPORT;
use crate::fit::{self as drawing, Drawn, draw_fit, fit_report};
use serde_json::json;
use std::collections::BTreeSet;
use study::case::PictureCase;
use study::fit::files::{self as tables, FIT, FitsRow, TABLES, fit_json, fits_csv};
use study::fit::plan::{PLAN, Plan};
use study::fit::{Outcome, Source};

const FITS: &str = "fits.csv";
const BATCH: &str = "fits.json";

/// Names of the files that fits of many curves leave besides the folders of the curves.
pub const FITS_NAMES: [&str; 2] = [BATCH, FITS];

/// Names of the files that a fit may leave.
pub fn fit_names() -> Vec<&'static str> {
    [FIT, REPORT].into_iter().chain(TABLES).chain(drawing::NAMES).collect()
}

/// What a fit leaves: the JSON alone unless files are wanted.
pub fn fit(outcome: &Outcome, look: &PictureCase, wanted: Option<Wanted>) -> Results {
    let mut made = Results::new(FIT, fit_json(outcome));
    if let Some(wanted) = wanted {
        made.files(files(outcome, look, wanted, Drawn::SvgAndPng));
    }
    made
}

/// What a fit leaves that found nothing, or was stopped.
pub fn no_fit(source: &Source, message: &str) -> Results {
    let text = json!({ "curve": source.label(), "error": message });
    Results::new::<String>(FIT, Ok(format!("{text:#}\n")))
}

/// What a plan of a measurement leaves.
pub fn plan(plan: &Plan) -> Results {
    Results::new(PLAN, plan.json())
}

/// What fits of many curves leave, or in words why a curve has none: the JSON alone unless files are wanted.
pub fn fits(
    sources: &[Source],
    outcomes: &[Result<Outcome, String>],
    look: &PictureCase,
    wanted: Option<Wanted>,
) -> Results {
    let (mut rows, mut listed, mut contents) = (Vec::new(), Vec::new(), Vec::new());
    let mut names: BTreeSet<String> = BTreeSet::new();
    for (source, outcome) in sources.iter().zip(outcomes) {
        let curve = source.label();
        match outcome {
            Ok(outcome) => {
                let name = unique(&mut names, source.stem());
                let report = &outcome.best.report;
                rows.push(FitsRow::of(report, &name));
                listed.push(json!({ "curve": curve, "folder": name, "good": report.is_good() }));
                contents.push((name, outcome));
            }
            Err(failure) => {
                rows.push(FitsRow::failed(&curve, failure));
                listed.push(json!({ "curve": curve, "error": failure }));
            }
        }
    }
    let text = json!({ "fits": listed });
    let mut made = Results::new::<String>(BATCH, Ok(format!("{text:#}\n")));
    let Some(wanted) = wanted else { return made };
    made.attempt(FITS, fits_csv(&rows));
    for (name, outcome) in contents {
        let json = made.take(fit_json(outcome)).map(|text| (FIT.to_owned(), text.into_bytes()));
        let own = made.take(files(outcome, look, wanted, Drawn::Svg));
        if let (Some(json), Some(own)) = (json, own) {
            for (file, bytes) in std::iter::once(json).chain(own) {
                made.file(format!("{name}/{file}"), bytes);
            }
        }
    }
    made
}

/// All files of a fit but the JSON.
fn files(
    outcome: &Outcome,
    look: &PictureCase,
    wanted: Wanted,
    usual: Drawn,
) -> Result<Vec<(String, Vec<u8>)>, String> {
    let drawn = if wanted.pictures { usual } else { Drawn::Nothing };
    let tables = tables::files(outcome).map_err(|error| error.to_string())?;
    let pictures = draw_fit(outcome, drawn, look).map_err(|error| error.to_string())?;
    let report = wanted.report.then(|| (REPORT.to_owned(), fit_report(outcome, look).into_bytes()));
    Ok(tables.into_iter().chain(pictures).chain(report).collect())
}

/// A name that is not taken yet.
fn unique(taken: &mut BTreeSet<String>, name: String) -> String {
    let mut candidate = name.clone();
    let mut k = 2;
    while !taken.insert(candidate.clone()) {
        candidate = format!("{name}-{k}");
        k += 1;
    }
    candidate
}
