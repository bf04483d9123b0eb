//! The files of figures: drawings, pictures, data, cases, claims, and the page.

use super::claims::{Claim, Source, Tally};
use super::manifest::{STABILITY, stem};
use super::page::page;
use super::ring::RingBranch;
use super::windows;
use super::{Computed, Figure};
use pictures::{DrawingError, Panel, Pen, png};
use study::case::PictureCase;
use study::record::branch_csv;
use study::run::contact_result;

/// Why a file could not be made.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// A picture.
    #[error("figure {figure}: {error}")]
    Png {
        /// The figure.
        figure: u32,
        /// What happened.
        error: DrawingError,
    },
    /// A table.
    #[error("{name}: {error}")]
    Csv {
        /// The file.
        name: String,
        /// What happened.
        error: csv::Error,
    },
    /// The claims.
    #[error("claims.json: {0}")]
    Json(#[from] serde_json::Error),
}

/// Name of the table of windows of instability.
pub(super) const WINDOWS: &str = "data/stability-windows.csv";

/// Name of the table behind a panel.
pub(super) fn data_name(figure: u32, letter: &str) -> String {
    let letter = if letter.is_empty() { "a" } else { letter };
    format!("data/{}-{}.csv", stem(figure), letter.replace(", ", "-").replace(' ', "-"))
}

/// All files: name and content. Without a `look` of pictures neither drawings nor pictures nor the page.
///
/// # Errors
/// When a picture or table cannot be made.
pub fn files(
    computed: &Computed,
    look: Option<&PictureCase>,
) -> Result<Vec<(String, Vec<u8>)>, FileError> {
    let mut files = vec![("claims.json".to_owned(), claims_json(&computed.claims)?.into_bytes())];
    let mut drawings = Vec::new();
    for figure in &computed.figures {
        let number = figure.manifest.number;
        if let Some(look) = look {
            drawings.push(figure.sheet.svg(look));
        }
        for (panel, spec) in figure.sheet.panels.iter().zip(&figure.manifest.panels) {
            let name = data_name(number, &spec.letter);
            let table = panel_csv(panel);
            let table = table.map_err(|error| FileError::Csv { name: name.clone(), error })?;
            files.push((name, table));
        }
        if figure.manifest.scans() {
            let name = WINDOWS.to_owned();
            let table = windows::csv(&figure.traced);
            let table = table.map_err(|error| FileError::Csv { name: name.clone(), error })?;
            files.push((name, table));
        }
        for traced in &figure.traced {
            let result = contact_result(&traced.case, &traced.branch, 0.0);
            let name = format!("data/{}-branch.csv", traced.case.name);
            let table = branch_csv(&result.table);
            let table = table.map_err(|error| FileError::Csv { name: name.clone(), error })?;
            files.push((name, table));
            files.push((format!("cases/{}.toml", traced.case.name), traced.case.to_toml().into()));
        }
    }
    for ring in &computed.rings {
        let name = format!("data/fig04-{}.csv", ring.label.replace(", ", "-").replace(' ', "-"));
        let table = ring_csv(ring).map_err(|error| FileError::Csv { name: name.clone(), error })?;
        files.push((name, table));
    }
    if let Some(look) = look {
        let made = pngs(&computed.figures, &drawings);
        for ((figure, svg), png) in computed.figures.iter().zip(&drawings).zip(made) {
            let number = figure.manifest.number;
            let png = png.map_err(|error| FileError::Png { figure: number, error })?;
            files.push((format!("{}.svg", stem(number)), svg.clone().into_bytes()));
            files.push((format!("{}.png", stem(number)), png));
        }
        // the page has the titles itself
        let panels: Vec<Vec<String>> =
            computed.figures.iter().map(|figure| figure.sheet.parts(look)).collect();
        files.push(("index.html".to_owned(), page(computed, &panels).into_bytes()));
    }
    Ok(files)
}

/// The pictures, made side by side.
fn pngs(figures: &[Figure], drawings: &[String]) -> Vec<Result<Vec<u8>, DrawingError>> {
    let workers = std::thread::available_parallelism().map_or(1, usize::from).max(1);
    let part = figures.len().div_ceil(workers).max(1);
    std::thread::scope(|scope| {
        let running: Vec<_> = drawings
            .chunks(part)
            .map(|part| scope.spawn(move || part.iter().map(|svg| png(svg)).collect::<Vec<_>>()))
            .collect();
        running.into_iter().flat_map(|worker| worker.join().unwrap_or_default()).collect()
    })
}

/// One row per point of every line.
fn panel_csv(panel: &Panel) -> Result<Vec<u8>, csv::Error> {
    let mut out = csv::Writer::from_writer(Vec::new());
    let plain = |text: &str| text.replace("_{", "_").replace("^{", "^").replace('}', "");
    out.write_record(["line", &plain(&panel.x), &plain(&panel.y), "kind", "unstable"])?;
    for line in panel.lines.iter().filter(|line| !line.label.is_empty()) {
        let kind = if line.pen == Pen::Law { "law" } else { "computed" };
        let label = plain(&line.label);
        for (i, (x, y)) in line.curve.x.iter().zip(&line.curve.y).enumerate() {
            if !(x.is_finite() && y.is_finite()) {
                continue;
            }
            let unstable = line.curve.unstable.get(i).copied().unwrap_or(false);
            let unstable = if unstable { "1" } else { "0" };
            out.write_record([&label, &format!("{x}"), &format!("{y}"), kind, unstable])?;
        }
    }
    out.flush()?;
    out.into_inner().map_err(|error| csv::Error::from(error.into_error()))
}

/// A branch of the ring load, in the columns of such a case.
fn ring_csv(ring: &RingBranch) -> Result<Vec<u8>, csv::Error> {
    let mut out = csv::Writer::from_writer(Vec::new());
    out.write_record([
        "point",
        "alpha",
        "deflection_over_h",
        "force",
        "unstable",
        "pole_over_h",
        "energy_total",
    ])?;
    for (i, q) in ring.points.iter().enumerate() {
        let unstable = if q.unstable { "1" } else { "0" };
        let [alpha, deflection, force, pole, energy] =
            [q.alpha, q.deflection, q.force, q.pole, q.energy].map(|x| format!("{x}"));
        out.write_record([&i.to_string(), &alpha, &deflection, &force, unstable, &pole, &energy])?;
    }
    out.into_inner().map_err(|error| csv::Error::from(error.into_error()))
}

/// `claims.json`.
fn claims_json(claims: &[Claim]) -> Result<String, serde_json::Error> {
    let mut text = serde_json::to_string_pretty(&serde_json::json!({ "claims": claims }))?;
    text.push('\n');
    Ok(text)
}

/// `figures.json`: what was computed, and what it says of the paper's claims.
///
/// # Errors
/// What the writer reports; none is expected.
pub fn json(computed: &Computed) -> Result<String, serde_json::Error> {
    let figures: Vec<_> = computed
        .figures
        .iter()
        .map(|figure| {
            let m = &figure.manifest;
            let panels: Vec<_> = m
                .panels
                .iter()
                .map(|p| serde_json::json!({ "letter": p.letter, "title": p.title }))
                .collect();
            let curves: Vec<_> = figure
                .traced
                .iter()
                .map(|t| {
                    let branch = &t.branch.branch;
                    serde_json::json!({
                        "name": t.name,
                        "case": format!("cases/{}.toml", t.case.name),
                        "csv": format!("data/{}-branch.csv", t.case.name),
                        "points": branch.points.len(),
                        "stopped_because": branch.stopped.reason.to_string(),
                    })
                })
                .collect();
            serde_json::json!({
                "figure": name(m.number),
                "title": m.title,
                "notes": m.notes,
                "panels": panels,
                "curves": curves,
            })
        })
        .collect();
    let document = serde_json::json!({
        "figures": figures,
        "claims": computed.claims,
        "estimates": computed.estimates,
        "incomplete": computed.early,
    });
    let mut text = serde_json::to_string_pretty(&document)?;
    text.push('\n');
    Ok(text)
}

/// The number of a figure of the paper, or the name of another.
fn name(figure: u32) -> serde_json::Value {
    if figure == STABILITY { "stability".into() } else { figure.into() }
}

/// For people: figures, verdicts, and what is incomplete.
pub fn summary(computed: &Computed) -> String {
    let numbers: Vec<String> = computed
        .figures
        .iter()
        .map(|f| name(f.manifest.number).to_string().replace('"', ""))
        .collect();
    let mut text = format!("figures {}\n", numbers.join(", "));
    for (source, whose) in
        [(Source::Paper, "claims of the paper"), (Source::Ours, "ours, no sentence of the paper")]
    {
        let tally = Tally::of(&computed.claims, source);
        if !tally.is_empty() {
            text += &format!("{whose}: {tally}\n");
        }
    }
    for line in &computed.early {
        text += &format!("incomplete: {line}\n");
    }
    text
}
