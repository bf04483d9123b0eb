//! `arclen list`: everything that has a name.

use crate::exit::Exit;
use std::fmt::Write as _;
use study::case::{SHIPPED, SWEEPS, catalogue, headline};

/// Print the names.
pub(super) fn list() -> Exit {
    let entries = catalogue();
    let names = SHIPPED.iter().map(|(name, _)| *name).chain(entries.iter().map(|e| &*e.name));
    let width = names.map(|name| name.len() + 2).max().unwrap_or(0);
    let mut out = String::from("cases\n");
    for (name, text) in SHIPPED {
        let _ = writeln!(out, "  {name:<width$}{}", headline(text));
    }
    out.push_str("sweeps\n");
    for (name, text) in SWEEPS {
        let _ = writeln!(out, "  {name:<width$}{}", headline(text));
    }
    if !entries.is_empty() {
        out.push_str("problems\n");
    }
    for entry in entries {
        let _ = writeln!(out, "  {:<width$}{}", entry.name, entry.summary);
    }
    super::print(&out)
}
