//! From a sweep file to its cases.

use super::axis::{Read, axes};
use super::plan::{self, Axis, Plan, Setting};
use super::shard::Shard;
use crate::case::document::{self, Node, Origin, Table, Value};
use crate::case::error::{CaseError, Complaint};
use crate::case::name::{own_name, plain_name};
use crate::case::reader::{Reader, Section};
use crate::case::resolve::resolve;
use crate::case::{
    CatalogueEntry, LoadError, LoadedCase, ProblemCase, ResolvedCase, SWEEPS, StabilityCase,
    load as load_case, source,
};
use crate::closest::closest;
use std::path::{Path, PathBuf};

/// More cases than this are a slip of the pen.
const MOST: usize = 10_000_000;

/// Why there is no sweep.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// The sweep file itself.
    #[error(transparent)]
    File(#[from] LoadError),
    /// The case that it starts from.
    #[error("{file}{origin}: case = {value}: {error}")]
    Base {
        /// The sweep file.
        file: String,
        /// The line.
        origin: Origin,
        /// What it names.
        value: String,
        /// What is wrong with it.
        error: Box<LoadError>,
    },
}

/// A sweep with all its cases.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// What varies.
    pub plan: Plan,
    /// The cases of this shard.
    pub cases: Vec<SweepCase>,
    /// The files that were read.
    pub inputs: Vec<PathBuf>,
}

/// One case of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepCase {
    /// Its number, from 0.
    pub index: usize,
    /// The case, or why its values are none.
    pub case: Result<ResolvedCase, String>,
}

/// The sweep in a file, or a shipped one by its name. Cases whose values are out of their ranges are kept with the reason; a file
/// in which every case is such, or in which anything else is wrong, is refused.
///
/// # Errors
/// When the file cannot be read, or something is wrong with it or with its base.
pub fn load(path: &Path, shard: Shard, catalogue: &[CatalogueEntry]) -> Result<Sweep, SweepError> {
    let file = path.display().to_string();
    let shipped = SWEEPS.iter().find(|(name, _)| *name == file);
    let text = match shipped {
        Some((_, text)) => (*text).to_owned(),
        None => source::read(path)?,
    };
    let stem = plain_name(&path.file_stem().unwrap_or_default().to_string_lossy());
    let folder = path.parent().unwrap_or(Path::new(""));
    let tree = document::parse(&file, &text, &[])?;
    let base = match tree.get("case").map(|node| &node.value) {
        Some(Value::Text(value)) => Some(base_path(folder, value)),
        _ => None,
    };
    let inputs = std::iter::once(path.to_path_buf()).chain(base).collect();
    Ok(Sweep { inputs, ..sweep(&file, &stem, folder, tree, shard, catalogue)? })
}

/// The file that a case's word means, if it means one.
fn base_path(folder: &Path, value: &str) -> PathBuf {
    let path = Path::new(value);
    let is_path = value.contains(['/', '\\']) || path.extension().is_some();
    if is_path { folder.join(path) } else { path.to_path_buf() }
}

pub(super) fn sweep(
    file: &str,
    stem: &str,
    folder: &Path,
    mut tree: Table,
    shard: Shard,
    catalogue: &[CatalogueEntry],
) -> Result<Sweep, SweepError> {
    let reader = Reader::new(file);
    let root = Section::root(&tree);
    let name = own_name(&reader, root).unwrap_or(stem).to_owned();
    let axes = axes(&reader, root);
    let base = reader.text(root, "case").zip(root.get("case"));
    let base = base.map(|(value, node)| from(file, folder, value, node, catalogue)).transpose()?;
    if !reader.has_no_errors() {
        return Err(LoadError::Invalid(reader.into_errors()).into());
    }
    for key in ["case", "vary", "name"] {
        tree.remove(key);
    }
    let tree = match base {
        None => tree,
        Some(mut base) => {
            lay(&mut base, tree);
            base
        }
    };
    expand(file, &name, &tree, axes, shard, catalogue)
}

/// The tree of the base case, everything written out.
fn from(
    file: &str,
    folder: &Path,
    value: &str,
    node: &Node,
    catalogue: &[CatalogueEntry],
) -> Result<Table, SweepError> {
    let path = base_path(folder, value);
    let refused = |error| SweepError::Base {
        file: file.to_owned(),
        origin: node.origin,
        value: node.raw.clone(),
        error: Box::new(error),
    };
    let loaded = load_case(&path, &[], catalogue).map_err(refused)?;
    let mut tree = document::parse(value, &loaded.case.to_toml(), &[]).map_err(refused)?;
    tree.remove("name");
    if !loaded.says_stability {
        // of a sweep it has another default
        tree.remove("stability");
    }
    forget_lines(&mut tree);
    Ok(tree)
}

/// Lines of another file mean nothing in messages about this one.
fn forget_lines(table: &mut Table) {
    for node in table.values_mut() {
        node.origin = Origin::File;
        if let Value::Table(inner) = &mut node.value {
            forget_lines(inner);
        }
    }
}

/// Lays one tree over another.
fn lay(under: &mut Table, over: Table) {
    for (key, node) in over {
        match (under.get_mut(&key), node) {
            (
                Some(Node { origin, value: Value::Table(inside), .. }),
                Node { origin: place, value: Value::Table(table), .. },
            ) => {
                *origin = place;
                lay(inside, table);
            }
            (_, node) => {
                under.insert(key, node);
            }
        }
    }
}

fn expand(
    file: &str,
    name: &str,
    tree: &Table,
    read: Vec<Read>,
    shard: Shard,
    catalogue: &[CatalogueEntry],
) -> Result<Sweep, SweepError> {
    let origins: Vec<Origin> = read.iter().map(|one| one.origin).collect();
    let axes: Vec<Axis> = read.into_iter().map(|one| one.axis).collect();
    let invalid = |errors| Err(LoadError::Invalid(errors).into());
    let conflict = |origin, key: &str, why: String| CaseError {
        file: file.to_owned(),
        origin,
        key: key.to_owned(),
        value: None,
        complaint: Complaint::Conflict(why),
    };
    let Some(count) = plan::count(&axes).filter(|count| *count <= MOST) else {
        let why = format!("these are more than {MOST} cases; vary less, or in coarser steps");
        return invalid(vec![conflict(Origin::File, "vary", why)]);
    };
    let mut cases = Vec::new();
    let mut first: Option<ResolvedCase> = None;
    let mut refused: Option<Vec<CaseError>> = None;
    for index in 0..count {
        let mut own = tree.clone();
        own.insert("name".to_owned(), node(Origin::File, &Setting::Text(name_of(name, index))));
        for ((axis, origin), setting) in axes.iter().zip(&origins).zip(plan::settings(&axes, index))
        {
            if let Err(part) = put(&mut own, &axis.key, node(*origin, setting)) {
                let why = format!("cannot vary: \"{part}\" is not a table");
                return invalid(vec![conflict(*origin, &axis.key, why)]);
            }
        }
        let case = match resolve(file, name, &own, catalogue) {
            Ok(loaded) => {
                let case = of_many(loaded);
                first.get_or_insert_with(|| case.clone());
                Ok(case)
            }
            Err(errors) if errors.iter().all(is_about_a_value) => {
                let reason = LoadError::Invalid(errors.clone()).to_string();
                refused.get_or_insert(errors);
                Err(reason)
            }
            Err(errors) => return invalid(errors.into_iter().map(of_a_sweep).collect()),
        };
        if shard.holds(index) {
            cases.push(SweepCase { index, case });
        }
    }
    let Some(first) = first else { return invalid(refused.unwrap_or_default()) };
    let plan = Plan {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        name: name.to_owned(),
        shard,
        parameter: first.problem.parameter(catalogue),
        axes,
        base: first.to_toml().lines().filter(|line| !line.is_empty()).map(str::to_owned).collect(),
    };
    Ok(Sweep { plan, cases, inputs: Vec::new() })
}

/// A case as one of many: of mirror images only modes of their own symmetry are counted, unless
/// somebody says `[stability]`, for the others cost twice the branch.
fn of_many(loaded: LoadedCase) -> ResolvedCase {
    let LoadedCase { mut case, says_stability, .. } = loaded;
    if !says_stability && matches!(case.problem, ProblemCase::Contact(_)) {
        case.stability = StabilityCase::Axisymmetric;
    }
    case
}

/// The name of a case: that of the sweep with its number.
fn name_of(sweep: &str, index: usize) -> String {
    format!("{sweep}-{index}")
}

/// Whether a key is right and only its value, in this case, is not.
fn is_about_a_value(error: &CaseError) -> bool {
    matches!(error.complaint, Complaint::OutOfRange { .. } | Complaint::Conflict(_))
}

/// What a sweep file allows besides the keys of a case.
fn of_a_sweep(mut error: CaseError) -> CaseError {
    if let Complaint::UnknownKey { allowed, suggestion, belongs } = &mut error.complaint
        && !error.key.contains('.')
    {
        allowed.extend(["case".to_owned(), "vary".to_owned()]);
        if belongs.is_none() {
            *suggestion =
                closest(&error.key, allowed.iter().map(String::as_str)).map(str::to_owned);
        }
    }
    error
}

fn node(origin: Origin, setting: &Setting) -> Node {
    let (raw, value) = match setting {
        Setting::Integer(value) => (value.to_string(), Value::Integer(Some(*value))),
        Setting::Real(value) => (format!("{value:?}"), Value::Real(*value)),
        Setting::Text(text) => {
            (format!("\"{}\"", document::shown(text)), Value::Text(text.clone()))
        }
    };
    Node { origin, raw, value }
}

/// Puts a value in its place; the part of the path that is no table is returned.
fn put(root: &mut Table, path: &str, node: Node) -> Result<(), String> {
    let mut table = root;
    let mut parts = path.split('.').peekable();
    while let Some(part) = parts.next() {
        if parts.peek().is_none() {
            table.insert(part.to_owned(), node);
            break;
        }
        let inner = table.entry(part.to_owned()).or_insert_with(|| Node {
            origin: node.origin,
            raw: "a table".to_owned(),
            value: Value::Table(Table::new()),
        });
        let Value::Table(inner) = &mut inner.value else { return Err(part.to_owned()) };
        table = inner;
    }
    Ok(())
}
