//! A fit as files: JSON, CSV, a case to trace, and words for people.

use super::Outcome;
use identify::Key;
use identify::record::{Estimate, Report};
use identify::uncertainty::verdict::Verdict;
use serde_json::{Value, json};
use std::fmt::Write as _;

/// Name of the fit's JSON.
pub const FIT: &str = "fit.json";
/// Names of its other files.
pub const TABLES: [&str; 2] = ["fit.csv", "case.toml"];

/// Why `fit.csv` could not be made.
#[derive(Debug, thiserror::Error)]
#[error("fit.csv: {0}")]
pub struct FileError(#[from] csv::Error);

/// The JSON of a fit.
///
/// # Errors
/// When it cannot be made.
pub fn fit_json(outcome: &Outcome) -> Result<String, serde_json::Error> {
    let mut value = serde_json::to_value(&outcome.best.report)?;
    if let Value::Object(fields) = &mut value
        && outcome.laws.len() > 1
    {
        let laws: Vec<Value> = outcome
            .laws
            .iter()
            .map(|(law, fit)| match fit {
                Ok(chi2) => json!({ "law": law.name(), "chi2_dof": chi2 }),
                Err(error) => {
                    json!({ "law": law.name(), "chi2_dof": null, "error": error.to_string() })
                }
            })
            .collect();
        fields.insert("laws".to_owned(), Value::Array(laws));
    }
    let mut text = serde_json::to_string_pretty(&value)?;
    text.push('\n');
    Ok(text)
}

/// The files of [`TABLES`].
///
/// # Errors
/// When the table cannot be written.
pub fn files(outcome: &Outcome) -> Result<Vec<(String, Vec<u8>)>, FileError> {
    let [csv, case] = TABLES.map(str::to_owned);
    Ok(vec![(csv, fit_csv(outcome)?), (case, case_toml(outcome).into_bytes())])
}

fn fit_csv(outcome: &Outcome) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in &outcome.best.rows {
        writer.serialize(row)?;
    }
    writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
}

/// The fitted shell as a case for `arclen trace`.
fn case_toml(outcome: &Outcome) -> String {
    let (p, report) = (&outcome.best.parameters, &outcome.best.report);
    let radius = p[Key::Radius];
    let height = |f: fn(f64, f64) -> f64, start: f64| {
        outcome.best.rows.iter().map(|row| 1.0 - row.approach_one_pole / radius).fold(start, f)
    };
    let (end, start) = (height(f64::min, f64::INFINITY), height(f64::max, 1.05));
    let mut out = String::new();
    let _ = write!(
        out,
        "# The shell that was fitted to {}.\nproblem = \"contact\"\n\n[shell]\nlaw = \"{}\"\npoisson = {:?}\n",
        report.curve.replace(['\n', '\r'], " "),
        report.law,
        p[Key::Poisson]
    );
    if report.law == "mooney-rivlin" {
        let _ = writeln!(out, "b = {:?}", p[Key::MooneyB]);
    }
    let _ = write!(
        out,
        "\n[physical]\nradius = \"{radius:e} m\"\nchi = \"{:e} N/m\"\nbending = \"{:e} N m\"\npressure = \
         \"{:e} Pa\"\nadhesion = \"{:e} N/m\"\nfilm = \"{:e} m\"\nsurface_tension = \"{:e} N/m\"\n\
         gas_exponent = {:?}\n\n[path]\nstart = {start:?}\nend = {end:?}\n\n\
         # under the lever of the measurement, which presses both poles, for \"arclen cycle\":\n\
         # [device]\n# kind = \"cantilever\"\n# stiffness = \"{:e} N/m\"\n",
        p[Key::Chi],
        p[Key::Bending],
        p[Key::Pressure],
        p[Key::Adhesion],
        p[Key::Film],
        p[Key::SurfaceTension],
        p[Key::GasExponent],
        p[Key::SpringConstant],
    );
    out
}

/// A value with a unit that suits it, such as `1.70 GPa`.
pub fn readable(value: f64, unit: &str) -> String {
    const PREFIXES: [(f64, &str); 10] = [
        (1e9, "G"),
        (1e6, "M"),
        (1e3, "k"),
        (1.0, ""),
        (1e-3, "m"),
        (1e-6, "u"),
        (1e-9, "n"),
        (1e-12, "p"),
        (1e-15, "f"),
        (1e-18, "a"),
    ];
    let usual = matches!(unit, "Pa" | "m" | "N" | "N/m");
    // beyond the prefixes only powers of ten are short
    let prefixed = (1e-18..1e12).contains(&value.abs());
    if !usual || !prefixed {
        return format!("{value:.4e} {unit}").trim().to_owned();
    }
    let (factor, prefix) =
        PREFIXES.into_iter().find(|(f, _)| value.abs() >= *f * 0.9995).unwrap_or((1e-18, "a"));
    format!("{:.4} {prefix}{unit}", value / factor)
}

/// What is fitted of a report, what follows from it first.
pub fn fitted(report: &Report) -> Vec<&Estimate> {
    let fitted = |e: &&Estimate| e.method != "fixed";
    report.derived.iter().filter(fitted).chain(report.parameters.iter().filter(fitted)).collect()
}

/// An interval in words.
pub fn interval(e: &Estimate, ends: [Option<f64>; 2]) -> String {
    // nothing is known where an end left the numbers of the machine
    let open = |x: &f64| *x == 0.0 && e.value != 0.0 || !x.is_finite();
    let end =
        |x: Option<f64>| x.filter(|x| !open(x)).map_or("open".to_owned(), |x| readable(x, e.unit));
    format!("{} to {}", end(ends[0]), end(ends[1]))
}

/// A verdict in words.
pub fn verdict(e: &Estimate) -> &'static str {
    match e.verdict {
        Some(Verdict::Identified) => "identified",
        Some(Verdict::Weak) => "weak",
        _ => "not identifiable",
    }
}

/// A table of what was found.
pub fn summary(outcome: &Outcome) -> String {
    let report = &outcome.best.report;
    let mut out = String::new();
    let quality = &report.quality;
    let _ = writeln!(
        out,
        "{}: {}, chi2/dof {:.3}, noise {}, {} of {} samples",
        report.curve,
        report.law,
        quality.chi2_dof,
        readable(quality.noise, "N"),
        quality.samples_used,
        quality.samples
    );
    let _ = writeln!(out, "{:<12} {:>18}  {:<41}  verdict", "", "value", "95 % interval");
    for e in fitted(report) {
        let (interval, verdict) = (interval(e, e.interval95), verdict(e));
        let value = readable(e.value, e.unit);
        let _ = writeln!(out, "{:<12} {value:>18}  {interval:<41}  {verdict}", e.key);
    }
    for jump in &report.jumps {
        let modelled =
            jump.height_modelled.map_or("none".to_owned(), |h| format!("{:.4} um", h * 1e6));
        let _ = writeln!(
            out,
            "jump on {} at {:.4} um (model: {modelled})",
            jump.direction,
            jump.height_measured * 1e6
        );
    }
    let _ = writeln!(out, "{}", report.weakest_direction);
    for warning in &report.warnings {
        let _ = writeln!(out, "warning ({}): {}", warning.code, warning.text);
    }
    out
}

/// A line of `fits.csv`.
#[derive(Debug, Clone, serde::Serialize)]
pub struct FitsRow {
    curve: String,
    folder: String,
    status: &'static str,
    reject: bool,
    law: String,
    young: Option<f64>,
    young_low: Option<f64>,
    young_high: Option<f64>,
    young_verdict: String,
    thickness: Option<f64>,
    thickness_low: Option<f64>,
    thickness_high: Option<f64>,
    thickness_verdict: String,
    chi: Option<f64>,
    bending: Option<f64>,
    sqrt_chi_kb: Option<f64>,
    adhesion: Option<f64>,
    film: Option<f64>,
    radius: Option<f64>,
    contact: Option<f64>,
    chi2_dof: Option<f64>,
    warnings: String,
    error: String,
}

impl FitsRow {
    /// The line of a fit.
    pub fn of(report: &Report, folder: &str) -> Self {
        let value = |key| report.estimate(key).map(|e| e.value);
        let end = |key, k: usize| report.estimate(key).and_then(|e| e.interval95[k]);
        let verdict = |key| {
            let verdict = report.estimate(key).and_then(|e| e.verdict);
            verdict.and_then(|v| serde_json::to_value(v).ok()?.as_str().map(str::to_owned))
        };
        let good = report.is_good();
        let codes: Vec<&str> = report.warnings.iter().map(|w| w.code).collect();
        FitsRow {
            curve: report.curve.clone(),
            folder: folder.to_owned(),
            status: if good { "fitted" } else { "poor" },
            reject: !good,
            law: report.law.to_owned(),
            young: value("young"),
            young_low: end("young", 0),
            young_high: end("young", 1),
            young_verdict: verdict("young").unwrap_or_default(),
            thickness: value("thickness"),
            thickness_low: end("thickness", 0),
            thickness_high: end("thickness", 1),
            thickness_verdict: verdict("thickness").unwrap_or_default(),
            chi: value("chi"),
            bending: value("bending"),
            sqrt_chi_kb: value("sqrt_chi_kb"),
            adhesion: value("adhesion"),
            film: value("film"),
            radius: value("radius"),
            contact: value("contact"),
            chi2_dof: Some(report.quality.chi2_dof),
            warnings: codes.join(" "),
            error: String::new(),
        }
    }

    /// The line of a curve without a fit.
    pub fn failed(curve: &str, error: &str) -> Self {
        FitsRow {
            curve: curve.to_owned(),
            folder: String::new(),
            status: "failed",
            reject: true,
            law: String::new(),
            young: None,
            young_low: None,
            young_high: None,
            young_verdict: String::new(),
            thickness: None,
            thickness_low: None,
            thickness_high: None,
            thickness_verdict: String::new(),
            chi: None,
            bending: None,
            sqrt_chi_kb: None,
            adhesion: None,
            film: None,
            radius: None,
            contact: None,
            chi2_dof: None,
            warnings: String::new(),
            error: error.to_owned(),
        }
    }
}

/// All lines.
///
/// # Errors
/// When they cannot be written.
pub fn fits_csv(rows: &[FitsRow]) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row)?;
    }
    writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_whatever_their_size() {
        for (value, unit, text) in [
            (1.703e9, "Pa", "1.7030 GPa"),
            (2.2e-8, "m", "22.0000 nm"),
            (-5e-11, "N", "-50.0000 pN"),
            (4e-16, "N m", "4.0000e-16 N m"),
            (2.5, "", "2.5000e0"),
            // ends of intervals that know nothing
            (1.2e200, "m", "1.2000e200 m"),
            (3e-40, "Pa", "3.0000e-40 Pa"),
            (0.0, "N", "0.0000e0 N"),
        ] {
            assert_eq!(readable(value, unit), text);
        }
    }
}
