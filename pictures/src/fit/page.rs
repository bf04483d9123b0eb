//! A fit as a page that stands alone: pictures, quantities with intervals and verdicts, jumps, warnings. It has
//! no script: there is nothing to move.

use super::picture;
use crate::page::{STYLE, escaped as escape};
use identify::record::{Estimate, Report};
use std::fmt::Write as _;
use study::case::PictureCase;
use study::fit::Outcome;
use study::fit::files::{fitted, interval, readable, verdict};

/// What a fit has beside the style of all pages.
const OWN_STYLE: &str = "
figure { background: #ffffff; overflow-x: auto; }
figure svg { display: block; width: 100%; min-width: 44rem; height: auto; }
th[scope=row] { position: static; background: none; color: inherit; text-align: left; font-size: inherit; }
td.words, th.words { text-align: left; }
.identified { color: var(--c2); } .weak { color: var(--c4); } .not-identifiable { color: var(--c1); }
main ul { margin: 0; padding-left: 1.2rem; }
main dl { display: grid; grid-template-columns: repeat(auto-fill, minmax(11rem, 1fr)); gap: 6px 14px; margin: 0; }
dt { color: var(--soft); font-size: .8rem; } dd { margin: 0; font-variant-numeric: tabular-nums; }
";

/// The page of a fit.
pub fn fit_report(outcome: &Outcome, look: &PictureCase) -> String {
    let report = &outcome.best.report;
    let name = report.curve.rsplit(['/', '\\']).next().unwrap_or_default();
    let title = escape(&format!("Fit of {name}"));
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>{title}</title>\n\
         <link rel=\"icon\" href=\"data:,\">\n<style>\n{STYLE}{OWN_STYLE}</style>\n</head>\n<body>\n\
         <header>\n<h1 id=\"title\">{title}</h1>\n<p id=\"subtitle\">{}</p>\n</header>\n<main id=\"main\">\n",
        escape(&subtitle(report))
    );
    warnings(&mut page, report);
    quantities(&mut page, report);
    let figures = [Some(picture::fit(outcome, look)), picture::profiles(report, look)];
    let names = ["Force, residuals and what is near contact", "Profile likelihood"];
    for (svg, name) in figures.into_iter().zip(names) {
        let Some(svg) = svg else { continue };
        // the declaration of a file is none inside a page
        let drawing = svg.find("<svg").map_or(svg.as_str(), |at| &svg[at..]);
        let _ = writeln!(page, "<figure aria-label=\"{name}\">\n{drawing}</figure>");
    }
    jumps(&mut page, report);
    residuals(&mut page, outcome);
    page.push_str("</main>\n</body>\n</html>\n");
    page
}

fn subtitle(report: &Report) -> String {
    let good = if report.is_good() { "" } else { "; not to be relied on: see the warnings" };
    format!(
        "{}; chi2/dof {:.3}; {}{good}",
        report.law, report.quality.chi2_dof, report.weakest_direction
    )
}

/// A section with a title.
fn section(page: &mut String, title: &str, content: &str) {
    let _ = writeln!(page, "<section>\n<h2>{title}</h2>\n{content}</section>");
}

fn warnings(page: &mut String, report: &Report) {
    if report.warnings.is_empty() {
        return;
    }
    let mut list = String::from("<ul>\n");
    for warning in &report.warnings {
        let (code, text) = (escape(warning.code), escape(&warning.text));
        let _ = writeln!(list, "<li><b>{code}</b>: {text}</li>");
    }
    section(page, "Warnings", &(list + "</ul>\n"));
}

fn quantities(page: &mut String, report: &Report) {
    let mut table = String::from(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Quantities\" style=\"max-height:none\">\n<table>\n\
         <tr><th scope=\"col\" class=\"words\">quantity</th><th scope=\"col\">value</th>\
         <th scope=\"col\" class=\"words\">verdict</th><th scope=\"col\">95 % interval</th>\
         <th scope=\"col\">68 % interval</th><th scope=\"col\">sd</th><th scope=\"col\" class=\"words\">by</th>\
         <th scope=\"col\">prior</th><th scope=\"col\">pull</th></tr>\n",
    );
    for e in fitted(report) {
        row(&mut table, e);
    }
    let fixed = report.parameters.iter().filter(|e| e.method == "fixed");
    for e in fixed {
        let _ = writeln!(
            table,
            "<tr><th scope=\"row\">{}</th><td>{}</td><td class=\"words\">kept</td><td></td><td></td><td></td>\
             <td></td><td></td><td></td></tr>",
            escape(&e.key),
            if e.unit.is_empty() || e.value == 0.0 {
                format!("{} {}", e.value, e.unit)
            } else {
                readable(e.value, e.unit)
            }
        );
    }
    section(page, "Quantities", &(table + "</table>\n</div>\n"));
}

fn row(table: &mut String, e: &Estimate) {
    let words = verdict(e);
    let class = words.replace(' ', "-");
    let sd = e.sd.map_or("open".to_owned(), |sd| readable(sd, e.unit));
    let prior = e.prior.as_ref().map_or(String::new(), |prior| {
        format!("{} ± {}", readable(prior.value, e.unit), readable(prior.sd, e.unit))
    });
    let pull = e.prior_pull.map_or(String::new(), |pull| format!("{pull:+.2} sd"));
    let bound = if e.at_bound { ", at a bound" } else { "" };
    let _ = writeln!(
        table,
        "<tr><th scope=\"row\">{}</th><td>{}</td><td class=\"words {class}\">{words}{bound}</td><td>{}</td>\
         <td>{}</td><td>{sd}</td><td class=\"words\">{}</td><td>{prior}</td><td>{pull}</td></tr>",
        escape(&e.key),
        readable(e.value, e.unit),
        interval(e, e.interval95),
        interval(e, e.interval68),
        e.method,
    );
}

fn jumps(page: &mut String, report: &Report) {
    if report.jumps.is_empty() {
        section(page, "Jumps", "<p>No jump was found.</p>\n");
        return;
    }
    let mut table = String::from(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Jumps\">\n<table>\n\
         <tr><th scope=\"col\" class=\"words\">direction</th><th scope=\"col\">height, measured</th>\
         <th scope=\"col\">height, model</th><th scope=\"col\">force before</th>\
         <th scope=\"col\">force after</th></tr>\n",
    );
    for jump in &report.jumps {
        let height = |h: f64| format!("{:.4} um", 1e6 * h);
        let _ = writeln!(
            table,
            "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            jump.direction,
            height(jump.height_measured),
            jump.height_modelled.map_or("none".to_owned(), height),
            readable(jump.force_before, "N"),
            readable(jump.force_after, "N"),
        );
    }
    section(page, "Jumps", &(table + "</table>\n</div>\n"));
}

fn residuals(page: &mut String, outcome: &Outcome) {
    let report = &outcome.best.report;
    let (quality, reach) = (&report.quality, &report.reach);
    let largest = outcome.best.rows.iter().filter(|row| row.used).map(|row| row.residual.abs());
    let largest = largest.fold(0.0, f64::max);
    let yes = |is: bool| if is { "yes" } else { "no" }.to_owned();
    let entries = [
        ("chi2/dof", format!("{:.4}", quality.chi2_dof)),
        ("noise", readable(quality.noise, "N")),
        ("largest residual used", readable(largest, "N")),
        ("autocorrelation of residuals", format!("{:.3}", quality.residual_autocorrelation)),
        ("variance widened by", format!("{:.3}", quality.widened)),
        ("samples used", format!("{} of {}", quality.samples_used, quality.samples)),
        ("condition", format!("{:.2e}", quality.condition)),
        ("minima", format!("{} from {} starts", quality.minima, quality.starts)),
        ("settled", yes(quality.converged)),
        ("elements", quality.elements.to_string()),
        ("pull-off, measured", readable(report.pull_off.measured, "N")),
        ("pull-off, model", readable(report.pull_off.modelled, "N")),
        ("knee in the data", yes(reach.knee)),
        ("upturn in the data", yes(reach.upturn)),
        ("largest deformation of a pole", format!("{:.3} R0", reach.deformation)),
        ("lever's share of the travel", format!("{:.1} %", 100.0 * reach.lever_share)),
    ];
    let mut list = String::from("<dl>\n");
    for (name, value) in entries {
        let _ = writeln!(list, "<div><dt>{name}</dt><dd>{}</dd></div>", escape(&value));
    }
    if outcome.laws.len() > 1 {
        for (law, fit) in &outcome.laws {
            let words = match fit {
                Ok(chi2) => format!("chi2/dof {chi2:.3}"),
                Err(error) => escape(&error.to_string()),
            };
            let _ = writeln!(list, "<div><dt>law {}</dt><dd>{words}</dd></div>", law.name());
        }
    }
    section(page, "Residuals and how far the curve goes", &(list + "</dl>\n"));
}
