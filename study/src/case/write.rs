//! A resolved case as a case file again: everything written out, nothing left to defaults.

use super::film;
use super::picture;
use super::{
    CatalogueCase, ContactCase, DiagramCase, MapCase, MeshCase, PathCase, PathEnd, PhysicalPath,
    ProblemCase, ResolvedCase, Shell, StabilityCase, Wanted,
};
use super::{Film, Law, PhysicalCase, PhysicalShell, Stiffness};
use crate::units::Quantity;
use std::fmt::Write as _;

impl ResolvedCase {
    /// The case as TOML; reading it gives the same case again.
    pub fn to_toml(&self) -> String {
        let mut out = Lines(String::new());
        out.line("# Resolved case: every default is written out.");
        out.text("name", &self.name);
        self.problem.write(&mut out);
        let given = match &self.problem {
            ProblemCase::Contact(case) => case.physical.as_ref().and_then(|p| p.path.as_ref()),
            ProblemCase::TwoPlates(case) => case.physical.as_ref().and_then(|p| p.path.as_ref()),
            _ => None,
        };
        let has_quantity = matches!(self.problem, ProblemCase::Contact(_));
        path(&mut out, &self.path, given, has_quantity);
        diagram(&mut out, &self.diagram);
        map(&mut out, self.map);
        if self.problem.has_modes() {
            stability(&mut out, self.stability);
        }
        picture::write(&mut out, &self.picture);
        out.0
    }
}

pub(super) fn contact(out: &mut Lines, case: &ContactCase) {
    out.text("problem", "contact");
    shell(out, case.shell);
    match &case.physical {
        None => {
            out.table("dimensionless");
            groups(out, "", case);
        }
        Some(given) => {
            out.table("physical");
            physical(out, given);
            out.line("# in dimensionless groups:");
            groups(out, "#   ", case);
        }
    }
    mesh(out, case.mesh);
    out.table("device");
    out.text("kind", case.device.name());
    let lever = case.physical.as_ref().and_then(|physical| physical.lever.as_ref());
    match (lever, case.device.stiffness()) {
        (Some(lever), Some(stiffness)) => {
            out.line("# of one lever on the whole bubble; per plate, in sqrt(chi k_b)/R0:");
            out.line(&format!("#   stiffness = {stiffness:?}"));
            out.text("stiffness", &lever.text);
        }
        (None, Some(stiffness)) => out.number("stiffness", stiffness),
        _ => {}
    }
    let Wanted { knee, contact } = case.events;
    if knee || contact {
        out.table("events");
        out.line(&format!("knee = {knee}"));
        out.line(&format!("contact = {contact}"));
    }
}

pub(super) fn catalogue(out: &mut Lines, case: &CatalogueCase) {
    out.text("problem", &case.name);
    if !case.parameters.is_empty() {
        out.table("parameters");
        for (name, value) in &case.parameters {
            out.number(name, *value);
        }
    }
    if let Some(elements) = case.elements {
        out.table("mesh");
        out.count("elements", elements);
    }
}

pub(super) fn shell(out: &mut Lines, shell: Shell) {
    out.table("shell");
    out.text("law", &shell.law.to_string());
    out.number("poisson", shell.poisson);
    if let Law::MooneyRivlin { b } = shell.law {
        out.number("b", b);
    }
}

fn groups(out: &mut Lines, prefix: &str, case: &ContactCase) {
    let groups = &case.groups;
    let all = [
        ("bending", groups.bending, "k_b / (chi R0^2)"),
        ("pressure", groups.pressure, "P_A R0 / chi"),
        ("adhesion", groups.adhesion, "w0 / chi"),
        ("film", groups.film, "delta_A / R0"),
        ("surface_tension", groups.surface_tension, "gamma_BW / chi"),
        ("gas_exponent", groups.gas_exponent, "polytropic exponent of the gas"),
    ];
    let all = all.map(|(key, value, meaning)| (key, format!("{value:?}"), meaning));
    for (key, value, meaning) in all.into_iter().chain(film::written(&case.potential)) {
        out.line(&format!("{prefix}{:<42} # {meaning}", format!("{key} = {value}")));
    }
}

fn physical(out: &mut Lines, given: &PhysicalCase) {
    out.text("radius", &given.radius.text);
    stiffness(out, &given.stiffness);
    out.text("pressure", &given.pressure.text);
    film(out, (&given.adhesion, &given.film, &given.forces), &given.potential);
    out.text("surface_tension", &given.surface_tension.text);
    out.number("gas_exponent", given.gas_exponent);
}

/// The groups of a shell without a film, or its quantities and the groups in a comment.
pub(super) fn shell_groups(
    out: &mut Lines,
    physical: Option<&PhysicalShell>,
    groups: &[(&str, f64)],
) {
    match physical {
        None => out.table("dimensionless"),
        Some(given) => {
            physical_shell(out, given);
            out.line("# in dimensionless groups:");
        }
    }
    for (key, value) in groups {
        match physical {
            None => out.number(key, *value),
            Some(_) => out.line(&format!("#   {key} = {value:?}")),
        }
    }
}

/// The table `[physical]` of a shell without a film.
fn physical_shell(out: &mut Lines, given: &PhysicalShell) {
    out.table("physical");
    out.text("radius", &given.radius.text);
    stiffness(out, &given.stiffness);
    out.text("pressure", &given.pressure.text);
    if let Some(tension) = &given.surface_tension {
        out.text("surface_tension", &tension.text);
    }
    out.number("gas_exponent", given.gas_exponent);
}

/// A film in physical units: adhesion, length and what they follow from.
pub(super) fn film(
    out: &mut Lines,
    (adhesion, length, forces): (&Quantity, &Quantity, &[(&'static str, Quantity)]),
    potential: &Film,
) {
    if forces.is_empty() {
        out.text("adhesion", &adhesion.text);
        out.text("film", &length.text);
    } else if let Some((key, value, _)) = film::written(potential).first() {
        out.line(&format!("{key} = {value}"));
        for (key, force) in forces {
            out.text(key, &force.text);
        }
    }
}

fn stiffness(out: &mut Lines, given: &Stiffness) {
    match given {
        Stiffness::Homogeneous { young, thickness } => {
            out.text("young", &young.text);
            out.text("thickness", &thickness.text);
        }
        Stiffness::Moduli { chi, bending } => {
            out.text("chi", &chi.text);
            out.text("bending", &bending.text);
        }
    }
}

pub(super) fn mesh(out: &mut Lines, mesh: MeshCase) {
    out.table("mesh");
    if let Some(tolerance) = mesh.tolerance {
        out.number("tolerance", tolerance);
        return;
    }
    out.count("elements", mesh.elements);
    if let Some(grading) = mesh.grading {
        out.number("grading", grading);
    }
}

fn path(out: &mut Lines, path: &PathCase, given: Option<&PhysicalPath>, has_quantity: bool) {
    out.table("path");
    match given {
        None => {
            out.number("start", path.start);
            out.number("end", path.end);
        }
        Some(given) => {
            if has_quantity {
                out.text("quantity", given.quantity.name());
            }
            for (key, end) in [("start", &given.start), ("end", &given.end)] {
                match end {
                    PathEnd::Number(value) => out.number(key, *value),
                    PathEnd::Quantity(quantity) => out.text(key, &quantity.text),
                }
            }
            out.line("# as the continued parameter:");
            out.line(&format!("#   start = {:?}", path.start));
            out.line(&format!("#   end = {:?}", path.end));
        }
    }
    if let Some(step) = path.max_step {
        out.number("max_step", step);
    }
    if let Some(step) = path.min_step {
        out.number("min_step", step);
    }
    out.count("max_points", path.max_points);
    if path.eigenvalues > 0 {
        out.count("eigenvalues", path.eigenvalues);
    }
}

fn diagram(out: &mut Lines, diagram: &DiagramCase) {
    out.table("diagram");
    out.count("depth", diagram.depth);
    out.count("max_branches", diagram.max_branches);
    out.text("search", if diagram.search { "near-bifurcations" } else { "none" });
    if let Some((low, high)) = diagram.within {
        out.number("from", low);
        out.number("to", high);
    }
    let default = DiagramCase::default();
    if (diagram.cycles, diagram.cycle_depth) != (default.cycles, default.cycle_depth) {
        out.line(&format!("cycles = {}", diagram.cycles));
        out.count("cycle_depth", diagram.cycle_depth);
    }
}

fn map(out: &mut Lines, map: MapCase) {
    if map != MapCase::default() {
        out.table("map");
    }
    for (key, value) in [("from", map.from), ("to", map.to)] {
        if let Some(value) = value {
            out.number(key, value);
        }
    }
}

fn stability(out: &mut Lines, stability: StabilityCase) {
    out.table("stability");
    match stability {
        StabilityCase::Full { max_n } => {
            out.text("scan", StabilityCase::NAMES[0]);
            out.count("max_n", max_n);
        }
        StabilityCase::Axisymmetric => out.text("scan", StabilityCase::NAMES[1]),
    }
}

/// TOML, line by line.
pub(super) struct Lines(String);

impl Lines {
    pub(super) fn line(&mut self, line: &str) {
        let _ = writeln!(self.0, "{line}");
    }

    pub(super) fn table(&mut self, name: &str) {
        self.line(&format!("\n[{name}]"));
    }

    pub(super) fn text(&mut self, key: &str, value: &str) {
        self.line(&format!("{} = {}", quoted(key), toml::Value::String(value.to_string())));
    }

    pub(super) fn number(&mut self, key: &str, value: f64) {
        self.line(&format!("{} = {value:?}", quoted(key)));
    }

    pub(super) fn count(&mut self, key: &str, value: usize) {
        self.line(&format!("{key} = {value}"));
    }
}

/// A key, in quotes if it must be.
fn quoted(key: &str) -> String {
    if !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c)) {
        return key.to_string();
    }
    toml::Value::String(key.to_string()).to_string()
}
