//! From a tree of keys to a case: every key is checked, every default filled in.

use super::device;
use super::document::{Origin, Table};
use super::error::{CaseError, Complaint};
use super::keys::{self, ANY, Key, Kind, POISSON_SKALAK, Range, names};
use super::name::own_name;
use super::path::Scale;
use super::physical::{PhysicalCase, ShellKeys, Stiffness};
use super::picture;
use super::problem::BUILT_IN;
use super::reader::{Reader, Section};
use super::stability;
use super::{
    CatalogueCase, CatalogueEntry, ContactCase, DiagramCase, Dimensionless, ElementRange, Film,
    Law, LawName, LoadedCase, MapCase, MeshCase, PathCase, ProblemCase, ResolvedCase, Shell,
    Wanted,
};
use crate::closest::closest;
use std::cell::RefCell;

const SHELL: &[&str] = &names(&keys::SHELL);
const DIMENSIONLESS: &[&str] = &names(&keys::GROUPS);
const PHYSICAL: &[&str] = &names(&keys::PHYSICAL);
const MESH: &[&str] = &names(&keys::MESH);
const FIXED_MESH: &[&str] = &names(&keys::FIXED_MESH);
const PATH: &[&str] = &names(&keys::PATH);
const CONTACT_PATH: &[&str] = &names(&keys::CONTACT_PATH);
const EVENTS: &[&str] = &names(&keys::EVENTS);
const DIAGRAM: &[&str] = &names(&keys::DIAGRAM);
const MAP: &[&str] = &names(&keys::MAP);
const DEVICE: &[&str] = &names(&keys::DEVICE);
const STABILITY: &[&str] = &names(&keys::STABILITY);

/// Where a key may be at home, for those that stand in the wrong table.
pub(super) const HOMES: &[(&str, &[&str])] = &[
    ("shell", SHELL),
    ("dimensionless", DIMENSIONLESS),
    ("physical", PHYSICAL),
    ("mesh", MESH),
    ("path", CONTACT_PATH),
    ("events", EVENTS),
    ("diagram", DIAGRAM),
    ("map", MAP),
    ("device", DEVICE),
    ("stability", STABILITY),
    ("picture", picture::NAMES),
];

/// Steps shorter than this part of the way are lost in the rounding of the parameter.
const SHORTEST: f64 = 1e-16;

pub(super) const CONTACT_START: Range = Range {
    holds: |x| x > 1.0,
    words: "greater than 1: a contact case starts above the free shell, of radius 1",
};
/// Check a tree and fill in the defaults; `name` is the case's name unless it says one itself.
///
/// # Errors
/// Everything that is wrong with it, in order of appearance.
pub(crate) fn resolve(
    file: &str,
    name: &str,
    tree: &Table,
    catalogue: &[CatalogueEntry],
) -> Result<LoadedCase, Vec<CaseError>> {
    let reader = Reader::new(file);
    let resolver = Resolver {
        reader: &reader,
        root: Section::root(tree),
        notes: RefCell::default(),
        catalogue,
    };
    let loaded = resolver.run(name);
    match loaded {
        Some(loaded) if reader.has_no_errors() => Ok(loaded),
        _ => Err(reader.into_errors()),
    }
}

pub(super) struct Resolver<'a> {
    pub(super) reader: &'a Reader,
    pub(super) root: Section<'a>,
    notes: RefCell<Vec<String>>,
    catalogue: &'a [CatalogueEntry],
}

impl<'a> Resolver<'a> {
    fn run(mut self, default_name: &str) -> Option<LoadedCase> {
        if let Some(node) = self.root.get("vary") {
            let why = "such a file is for \"arclen sweep\"; for a single case, leave out [[vary]]";
            let why = Complaint::Conflict(why.to_string());
            self.reader.push(node.origin, "vary".to_string(), None, why);
            return None;
        }
        let name = match self.root.get("name") {
            None => Some(default_name.to_string()),
            Some(_) => own_name(self.reader, self.root).map(str::to_string),
        };
        let known: Vec<&str> = BUILT_IN
            .iter()
            .map(|(name, _)| *name)
            .chain(self.catalogue.iter().map(|entry| entry.name.as_str()))
            .collect();
        if self.root.get("problem").is_none() {
            let hint = format!("write problem = \"contact\", or one of {}", known.join(", "));
            self.reader.missing(self.root, "problem", hint);
        }
        let problem_name = self.reader.text(self.root, "problem")?;
        let problem = problem_name;
        let (problem, path) = match BUILT_IN.iter().find(|(own, _)| *own == problem) {
            Some((_, read)) => read(&mut self),
            None => match self.catalogue.iter().find(|entry| entry.name == problem) {
                Some(entry) => self.entry(entry),
                None => {
                    let node = self.root.get("problem")?;
                    let suggestion = closest(problem, known.iter().copied()).map(str::to_string);
                    let allowed = known.iter().map(ToString::to_string).collect();
                    let why = Complaint::UnknownWord { allowed, suggestion };
                    self.reader.refuse(self.root, "problem", node, why);
                    return None;
                }
            },
        };
        let diagram = path.as_ref().and_then(|path| self.diagram(path));
        let map = self.map();
        let stability = stability::stability(self.reader, self.table("stability", STABILITY));
        let picture = self.picture(&self.columns(problem_name));
        let case = ResolvedCase {
            name: name?,
            problem: problem?,
            path: path?,
            diagram: diagram?,
            map: map?,
            stability: stability?,
            picture: picture?,
        };
        let says_stability = self.root.get("stability").is_some();
        Some(LoadedCase { case, notes: self.notes.into_inner(), says_stability })
    }

    /// Something that deserves to be said.
    pub(super) fn note(&self, text: String) {
        self.notes.borrow_mut().push(text);
    }

    /// Columns of the branches of a problem that the axes of pictures may show.
    fn columns(&self, problem: &str) -> Vec<&'a str> {
        match self.catalogue.iter().find(|entry| entry.name == problem) {
            Some(entry) => entry
                .axes
                .iter()
                .map(|(name, _)| name.as_str())
                .chain(std::iter::once("unstable"))
                .collect(),
            None if problem == "ring-load" => picture::RING.to_vec(),
            None => picture::PLATES.to_vec(),
        }
    }

    /// A table whose keys are all known.
    pub(super) fn table(&self, name: &'static str, allowed: &[&str]) -> Section<'a> {
        let section = self.reader.section(self.root, name);
        self.reader.only(section, allowed, HOMES);
        section
    }

    pub(super) fn contact(&mut self) -> (Option<ProblemCase>, Option<PathCase>) {
        let tables = [
            "name",
            "problem",
            "shell",
            "dimensionless",
            "physical",
            "mesh",
            "path",
            "diagram",
            "map",
            "device",
            "stability",
            "events",
            "picture",
        ];
        self.reader.only(self.root, &tables, HOMES);
        let shell = self.shell();
        let dimensionless = self.table("dimensionless", DIMENSIONLESS);
        let physical = self.table("physical", PHYSICAL);
        let poisson = shell.map_or(0.5, |shell| shell.poisson);
        let parameters = match self.is_physical(dimensionless, physical) {
            Some(false) => self.groups(dimensionless).map(|(groups, film)| (groups, film, None)),
            Some(true) => self.physical(physical, poisson),
            None => None,
        };
        let mesh = self.mesh();
        let scale = match &parameters {
            Some((groups, _, Some(physical))) => {
                Scale::Known { radius: physical.radius.si, force: physical.force_scale(groups) }
            }
            _ if physical.exists() => Scale::Unknown,
            _ => Scale::None,
        };
        let device = device::device(self.reader, self.table("device", DEVICE), scale);
        let path = self.contact_path(device.as_ref().map(|(device, _)| *device), scale);
        let events = self.table("events", EVENTS);
        let knee = self.flag(events, &keys::KNEE);
        let contact = self.flag(events, &keys::CONTACT);
        let (path, given) = path.unzip();
        let problem = match (shell, parameters, mesh, device, knee, contact) {
            (Some(shell), Some(parameters), Some(mesh), Some(device), Some(k), Some(c)) => {
                let (groups, potential, physical) = parameters;
                let (device, lever) = device;
                let physical = physical.map(|physical| {
                    Box::new(PhysicalCase { lever, path: given.flatten(), ..*physical })
                });
                let events = Wanted { knee: k, contact: c };
                Some(ProblemCase::Contact(ContactCase {
                    shell,
                    groups,
                    potential,
                    physical,
                    mesh,
                    device,
                    events,
                }))
            }
            _ => None,
        };
        (problem, path)
    }

    /// The table `[path]` of a contact case.
    pub(super) fn contact_path_table(&self) -> Section<'a> {
        self.table("path", CONTACT_PATH)
    }

    /// The table `[path]` of other cases.
    pub(super) fn path_table(&self) -> Section<'a> {
        self.table("path", PATH)
    }

    fn entry(&mut self, entry: &CatalogueEntry) -> (Option<ProblemCase>, Option<PathCase>) {
        self.reader.only(
            self.root,
            &["name", "problem", "parameters", "mesh", "path", "diagram", "map", "picture"],
            HOMES,
        );
        let section = self.reader.section(self.root, "parameters");
        let names: Vec<&str> = entry.parameters.iter().map(|one| one.name.as_str()).collect();
        self.reader.only(section, &names, &[("path", &[entry.parameter.as_str()])]);
        let parameters = entry
            .parameters
            .iter()
            .map(|one| {
                Some((one.name.clone(), self.within(section, &one.name, one.allowed, one.default)?))
            })
            .collect::<Option<_>>();
        let mesh = self.table("mesh", if entry.elements.is_some() { &["elements"] } else { &[] });
        let elements = match entry.elements {
            None => Some(None),
            Some(elements) => self.elements(mesh, elements).map(Some),
        };
        let section = self.reader.section(self.root, "path");
        let path = self
            .path(Some((entry.start, entry.end)), ANY, ANY)
            .filter(|path| self.admits(section, "start", entry.start_allowed, path.start));
        let problem = match (parameters, elements) {
            (Some(parameters), Some(elements)) => Some(ProblemCase::Catalogue(CatalogueCase {
                name: entry.name.clone(),
                parameters,
                elements,
            })),
            _ => None,
        };
        (problem, path)
    }

    pub(super) fn shell(&mut self) -> Option<Shell> {
        let section = self.table("shell", SHELL);
        if section.get("law").is_none() {
            let hint = format!("give the law of the membrane: {}", LawName::NAMES.join(", "));
            self.reader.missing(section, "law", hint);
        }
        let law = self.reader.text(section, "law");
        if let (Some(word), Some(node)) = (law, section.get("law"))
            && !LawName::NAMES.contains(&word)
        {
            let suggestion = closest(word, LawName::NAMES).map(ToString::to_string);
            let allowed = LawName::NAMES.iter().map(ToString::to_string).collect();
            let why = Complaint::UnknownWord { allowed, suggestion };
            self.reader.refuse(section, "law", node, why);
        }
        let law = law.and_then(LawName::of);
        let poisson = if law == Some(LawName::Skalak) {
            let poisson = Key { kind: Kind::Number(POISSON_SKALAK), ..keys::POISSON };
            self.or_default(section, &poisson)
        } else {
            self.or_default(section, &keys::POISSON)
        };
        let b = self.number(section, &keys::B);
        let law = match law? {
            LawName::Hooke => Law::Hooke,
            LawName::Skalak => Law::Skalak,
            LawName::MooneyRivlin => {
                if section.get("b").is_none() {
                    let hint = "mooney-rivlin needs b, from 0 (neo-Hookean) to 1";
                    self.reader.missing(section, "b", hint);
                }
                Law::MooneyRivlin { b: b? }
            }
        };
        if b.is_some() && law.b().is_none() {
            self.note(format!("shell.b has no effect: {law} has no such parameter"));
        }
        Some(Shell { law, poisson: poisson? })
    }

    /// `bending`, `pressure`, `surface_tension` and `gas_exponent`.
    pub(super) fn groups_without_film(&self, section: Section<'_>) -> Option<[f64; 4]> {
        let bending = self.required(section, &keys::BENDING);
        let pressure = self.required(section, &keys::PRESSURE);
        let surface_tension = self.or_default(section, &keys::SURFACE_TENSION);
        let gas_exponent = self.or_default(section, &keys::GAS_EXPONENT);
        Some([bending?, pressure?, surface_tension?, gas_exponent?])
    }

    fn groups(&self, section: Section<'_>) -> Option<(Dimensionless, Film)> {
        let others = self.groups_without_film(section);
        let film = self.film(section);
        let [bending, pressure, surface_tension, gas_exponent] = others?;
        let (adhesion, film, potential) = film?;
        let groups =
            Dimensionless { bending, pressure, adhesion, film, surface_tension, gas_exponent };
        Some((groups, potential))
    }

    fn physical(
        &self,
        section: Section<'_>,
        poisson: f64,
    ) -> Option<(Dimensionless, Film, Option<Box<PhysicalCase>>)> {
        let shell = self.shell_quantities(section, &ShellKeys::OF_BUBBLES);
        let film = self.physical_film(section);
        let (shell, film) = (shell?, film?);
        let physical = PhysicalCase {
            radius: shell.radius,
            stiffness: shell.stiffness,
            pressure: shell.pressure,
            adhesion: film.adhesion,
            film: film.film,
            potential: film.potential,
            forces: film.forces,
            surface_tension: shell.surface_tension?,
            gas_exponent: shell.gas_exponent,
            lever: None,
            path: None,
        };
        let groups = physical.numbers().groups(poisson);
        self.admits_groups(section, &groups)?;
        Some((groups, physical.potential, Some(Box::new(physical))))
    }

    /// Complains about quantities whose dimensionless groups are not allowed; films of zero are none.
    pub(super) fn admits_groups(&self, section: Section<'_>, groups: &Dimensionless) -> Option<()> {
        let checks = [
            (keys::BENDING, groups.bending),
            (keys::PRESSURE, groups.pressure),
            (keys::ADHESION, groups.adhesion),
            (keys::FILM, groups.film),
            (keys::SURFACE_TENSION, groups.surface_tension),
        ];
        for (key, value) in checks {
            if !key.range().contains(value) {
                let why = Complaint::Conflict(format!(
                    "these parameters make the dimensionless {} {value:?}, which must be {}; \
                     check their units",
                    key.name,
                    key.range().words
                ));
                self.reader.push(section.origin, section.name.to_string(), None, why);
                return None;
            }
        }
        Some(())
    }

    /// Young's modulus and thickness, or the two moduli; not both, not halves of both.
    pub(super) fn stiffness(&self, section: Section<'_>) -> Option<Stiffness> {
        let given: Vec<&str> = ["young", "thickness", "chi", "bending"]
            .into_iter()
            .filter(|key| section.get(key).is_some())
            .collect();
        let quantity = |key| self.required_quantity(section, key);
        let homogeneous = given.iter().any(|key| matches!(*key, "young" | "thickness"));
        let moduli = given.iter().any(|key| matches!(*key, "chi" | "bending"));
        match (homogeneous, moduli) {
            (true, false) => {
                let young = quantity(&keys::YOUNG);
                let thickness = quantity(&keys::THICKNESS);
                Some(Stiffness::Homogeneous { young: young?, thickness: thickness? })
            }
            (false, true) => {
                let chi = quantity(&keys::CHI);
                let bending = quantity(&keys::PHYSICAL_BENDING);
                Some(Stiffness::Moduli { chi: chi?, bending: bending? })
            }
            (true, true) => {
                let why = format!(
                    "has {}; give either young and thickness, or chi and bending",
                    given.join(", ")
                );
                let place = given.iter().filter_map(|key| section.get(key)).map(|n| n.origin).max();
                let place = place.unwrap_or(section.origin);
                self.reader.push(place, "physical".to_string(), None, Complaint::Conflict(why));
                None
            }
            (false, false) => {
                let hint = "give young and thickness (\"2.1 GPa\", \"25 nm\"), \
                            or chi and bending (\"0.05 N/m\", \"3e-16 N m\")";
                self.reader.missing(section, "young", hint);
                None
            }
        }
    }

    /// A mesh of so many elements.
    pub(super) fn fixed_mesh(&self) -> Option<MeshCase> {
        self.mesh_of(self.table("mesh", FIXED_MESH))
    }

    /// A mesh of so many elements, or one for a tolerance. What is laid over a file takes the place of what the
    /// file says of either.
    fn mesh(&self) -> Option<MeshCase> {
        let section = self.table("mesh", MESH);
        let mesh = self.mesh_of(section);
        let Some(given) = section.get("tolerance") else { return mesh };
        let is_laid_over = |origin| matches!(origin, Origin::Given(_));
        for fixed in ["elements", "grading"] {
            let Some(node) = section.get(fixed) else { continue };
            match (is_laid_over(given.origin), is_laid_over(node.origin)) {
                (true, false) => {}
                (false, true) => return mesh,
                _ => {
                    let why =
                        format!("has {fixed} and tolerance; a tolerance chooses the elements");
                    let place = given.origin.max(node.origin);
                    self.reader.push(place, "mesh".to_string(), None, Complaint::Conflict(why));
                    return None;
                }
            }
        }
        let tolerance = self.number(section, &keys::TOLERANCE)?;
        let fixed = mesh?;
        Some(MeshCase { tolerance: Some(tolerance), grading: None, ..fixed })
    }

    fn mesh_of(&self, section: Section<'_>) -> Option<MeshCase> {
        let elements = self.count(section, &keys::ELEMENTS);
        let grading = match section.get("grading") {
            None => None,
            Some(_) => Some(self.number(section, &keys::GRADING)?),
        };
        Some(MeshCase { elements: elements?, grading, tolerance: None })
    }

    fn elements(&self, section: Section<'_>, range: ElementRange) -> Option<usize> {
        match section.get("elements") {
            None => Some(range.default),
            Some(_) => {
                let bound = |x: usize| i64::try_from(x).unwrap_or(i64::MAX);
                self.reader.count(section, "elements", bound(range.least), bound(range.most))
            }
        }
    }

    pub(super) fn path(
        &self,
        default: Option<(f64, f64)>,
        start_range: Range,
        end_range: Range,
    ) -> Option<PathCase> {
        let section = self.path_table();
        let needed = |key: &str, allowed: Range, default: Option<f64>| match default {
            Some(default) => self.or(section, key, allowed, default),
            None => self.reader.required(section, key, allowed),
        };
        let start = needed("start", start_range, default.map(|(start, _)| start));
        let end = needed("end", end_range, default.map(|(_, end)| end));
        self.path_between(section, start, end)
    }

    /// The path between two values of the parameter.
    pub(super) fn path_between(
        &self,
        section: Section<'_>,
        start: Option<f64>,
        end: Option<f64>,
    ) -> Option<PathCase> {
        let max_step = self.number(section, &keys::MAX_STEP);
        let min_step = self.number(section, &keys::MIN_STEP);
        let max_points = self.count(section, &keys::MAX_POINTS);
        let eigenvalues = self.count(section, &keys::EIGENVALUES);
        if let (Some(start), Some(end), Some(node)) = (start, end, section.get("end"))
            && start == end
        {
            let allowed = format!("different from path.start, which is {start:?} too");
            self.reader.refuse(section, "end", node, Complaint::OutOfRange { allowed });
        } else if let (Some(start), Some(end), Some(node)) = (start, end, section.get("start"))
            && start == end
        {
            let allowed = format!("different from path.end, which is {end:?} by default");
            self.reader.refuse(section, "start", node, Complaint::OutOfRange { allowed });
        }
        if let (Some(start), Some(end), Some(step)) = (start, end, max_step)
            && let Some(node) = section.get("max_step")
        {
            let least = SHORTEST * (end - start).abs();
            if step < least {
                let allowed = format!(
                    "at least {least:.1e}, {SHORTEST:.0e} of the way from path.start to path.end"
                );
                self.reader.refuse(section, "max_step", node, Complaint::OutOfRange { allowed });
            }
        }
        if let (Some(low), Some(high), Some(node)) = (min_step, max_step, section.get("min_step"))
            && low > high
        {
            let allowed = format!("at most path.max_step, which is {high:?}");
            self.reader.refuse(section, "min_step", node, Complaint::OutOfRange { allowed });
        }
        Some(PathCase {
            start: start?,
            end: end?,
            max_step,
            min_step,
            max_points: max_points?,
            eigenvalues: eigenvalues?,
        })
    }

    fn diagram(&self, path: &PathCase) -> Option<DiagramCase> {
        let section = self.table("diagram", DIAGRAM);
        let default = DiagramCase::default();
        let depth = self.count(section, &keys::DEPTH);
        let max_branches = self.count(section, &keys::MAX_BRANCHES);
        let (from, to) = (section.get("from"), section.get("to"));
        let bounds = if from.is_some() || to.is_some() {
            let from = self.required(section, &keys::DIAGRAM_FROM);
            let to = self.required(section, &keys::DIAGRAM_TO);
            Some((from?, to?))
        } else {
            None
        };
        let within = bounds.map(|(a, b)| (a.min(b), a.max(b)));
        if let (Some((low, high)), Some(node)) = (within, from)
            && (low == high || !(low..=high).contains(&path.start))
        {
            let allowed = format!(
                "such that path.start, which is {:?}, lies from it to diagram.to",
                path.start
            );
            self.reader.refuse(section, "from", node, Complaint::OutOfRange { allowed });
            return None;
        }
        let search = match section.get("search") {
            None => default.search,
            Some(_) => self.word(section, &keys::SEARCH)? == "near-bifurcations",
        };
        let cycles = self.flag(section, &keys::CYCLES)?;
        let cycle_depth = self.count(section, &keys::CYCLE_DEPTH)?;
        let (depth, max_branches) = (depth?, max_branches?);
        Some(DiagramCase { depth, max_branches, within, search, cycles, cycle_depth })
    }

    fn map(&self) -> Option<MapCase> {
        let section = self.table("map", MAP);
        let given = |key: &Key| match section.get(key.name) {
            None => Some(None),
            Some(_) => self.number(section, key).map(Some),
        };
        let (from, to) = (given(&keys::MAP_FROM)?, given(&keys::MAP_TO)?);
        if let (Some(low), Some(high), Some(node)) = (from, to, section.get("to"))
            && low >= high
        {
            let allowed = format!("greater than map.from, which is {low:?}");
            self.reader.refuse(section, "to", node, Complaint::OutOfRange { allowed });
        }
        Some(MapCase { from, to })
    }
}
