//! The page: everything in one file.

const TEMPLATE: &str = include_str!("../../assets/report.html");
pub(crate) const STYLE: &str = include_str!("../../assets/report.css");
const SCRIPT: &str = include_str!("../../assets/report.js");
const UPLOT: &str = include_str!("../../assets/uplot/uPlot.iife.min.js");
const UPLOT_STYLE: &str = include_str!("../../assets/uplot/uPlot.min.css");
const UPLOT_LICENCE: &str = include_str!("../../assets/uplot/LICENSE");

/// The page with its data.
pub(super) fn page(title: &str, json: &str) -> Result<String, serde_json::Error> {
    // no text of the data ends the element that it stands in
    let data = json.replace('<', "\\u003c");
    let parts = [
        ("title", escaped(title)),
        ("licence", UPLOT_LICENCE.trim().to_owned()),
        ("uplot-style", UPLOT_STYLE.trim().to_owned()),
        ("style", STYLE.to_owned()),
        ("data", data),
        ("uplot", UPLOT.trim().to_owned()),
        ("script", SCRIPT.to_owned()),
    ];
    let mut page = String::with_capacity(json.len() + 100_000);
    let mut rest = TEMPLATE;
    while let Some((before, after)) = rest.split_once("{{") {
        page.push_str(before);
        let Some((name, after)) = after.split_once("}}") else { break };
        let part = parts.iter().find(|(own, _)| *own == name);
        page.push_str(part.map_or("", |(_, text)| text));
        rest = after;
    }
    page.push_str(rest);
    Ok(page)
}

pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_stands_alone() {
        let page = page("a < b", r#"{"title":"</script><script>"}"#).unwrap_or_default();
        assert!(page.contains("<title>a &lt; b</title>"));
        assert!(!page.contains("{{"), "a part is missing");
        assert!(page.contains("\\u003c/script>\\u003cscript>"));
        assert_eq!(page.matches("</script>").count(), 3, "data, library, script");
        for reference in ["src=", "href=\"http", "href=\"/", "url(", "@import", "fetch("] {
            assert!(!page.contains(reference), "{reference}");
        }
        assert!(page.contains("Leon Sorokin"), "the licence of uPlot");
    }
}
