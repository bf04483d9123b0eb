//! `arclen list`: everything that has a name.

use crate::exit::Exit;
use std::fmt::Write as _;
use study::case::{SHIPPED, SWEEPS, catalogue};

/// Print the names.
pub(super) fn list() -> Exit {
    let entries = catalogue();
    let names = SHIPPED.iter().map(|(name, _)| *name).chain(entries.iter().map(|e| &*e.name));
    let width = names.map(|name| name.len() + 2).max().unwrap_or(0);
    let mut out = String::from("cases\n");
    for (name, text) in SHIPPED {
        let _ = writeln!(out, "  {name:<width$}{}", summary(text));
    }
    out.push_str("sweeps\n");
    for (name, text) in SWEEPS {
        let _ = writeln!(out, "  {name:<width$}{}", summary(text));
    }
    if !entries.is_empty() {
        out.push_str("problems\n");
    }
    for entry in entries {
        let _ = writeln!(out, "  {:<width$}{}", entry.name, entry.summary);
    }
    super::print(&out)
}

/// The first sentence of a case file's opening comment.
fn summary(text: &str) -> String {
    let comment: Vec<&str> =
        text.lines().map_while(|line| line.strip_prefix('#')).map(str::trim).collect();
    let comment = comment.join(" ");
    let end = comment
        .match_indices(". ")
        .map(|(at, _)| at)
        .find(|at| !comment[..*at].ends_with("Fig"))
        .unwrap_or(comment.trim_end_matches('.').len());
    comment[..end].to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_case_says_what_it_is_in_a_line() {
        for (name, text) in SHIPPED.iter().chain(SWEEPS) {
            let line = summary(text);
            assert!((20..110).contains(&line.len()), "{name}: {line}");
        }
        assert_eq!(summary("# One (Fig. 3). Two.\na = 1"), "One (Fig. 3)");
        assert_eq!(summary("# One.\n# Two.\n"), "One");
        assert_eq!(summary("a = 1"), "");
    }
}
