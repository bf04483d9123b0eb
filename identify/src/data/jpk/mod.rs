//! Force curves of JPK instruments: `.jpk-force`, `.jpk-force-map`, `.jpk-qi-data`, `.jpk-qi-series`.
//!
//! A zip archive. A single curve has its segments under `segments/`, a map has curves under `index/NUMBER/` with
//! `segments/` in each. A segment has a header (`segment-header.properties`) and a binary file for each channel
//! (`channel`). The layout is not published; what is read here is what the archives among the test data of
//! the Python package afmformats (MIT) hold, and the forces are equal to the last bits.
//!
//! **Height.** The height over which the head moves is measured by a sensor (`measuredHeight`; in older files
//! `capacitiveSensorHeight` or `strainGaugeHeight`); `height` is the voltage on the piezo, in metres, and differs
//! from it by tens of per cent where the loop is closed on the sensor. The first of these that every segment has is
//! taken unless `height_column` names another.
//!
//! **Sign.** JPK's heights fall on approach and its deflection is positive when the lever is pushed; files in which
//! either goes the other way are refused as those of any other format are.

mod archive;
mod channel;
mod error;
mod properties;

pub use error::ArchiveError;

use super::{Curve, Direction, Layout, Segment};
use archive::Archive;
use channel::{Channel, SHARED, Told};
use properties::Properties;

/// Endings of the files that are read.
pub const ENDINGS: [&str; 4] = ["jpk-force", "jpk-force-map", "jpk-qi-data", "jpk-qi-series"];

/// Those that may hold several curves.
pub const MAPS: [&str; 2] = ["jpk-force-map", "jpk-qi-data"];

const FORCE: &str = "vDeflection";
/// Heights that a sensor measures, in the order in which they are preferred.
const MEASURED: [&str; 3] = ["measuredHeight", "capacitiveSensorHeight", "strainGaugeHeight"];
/// Heights that the voltage on the piezo says.
const PIEZO: [&str; 3] = ["height", "head-height", "cellhesion-height"];

/// The numbers of the curves in an archive; those of a map need not be contiguous.
///
/// # Errors
/// Where the archive cannot be read or holds none.
pub fn numbers(bytes: &[u8]) -> Result<Vec<usize>, ArchiveError> {
    curves(&Archive::open(bytes)?)
}

fn curves(archive: &Archive<'_>) -> Result<Vec<usize>, ArchiveError> {
    if !archive.numbers("segments/")?.is_empty() {
        return Ok(vec![0]);
    }
    match archive.numbers("index/")? {
        none if none.is_empty() => Err(ArchiveError::NoCurve),
        found => Ok(found),
    }
}

/// A segment that approaches or retracts.
struct Part {
    number: usize,
    folder: String,
    header: Properties,
    direction: Direction,
}

/// The curve that `layout` asks for; the only one, if it does not.
pub(super) fn curve(bytes: &[u8], layout: &Layout) -> Result<Curve, ArchiveError> {
    let mut archive = Archive::open(bytes)?;
    let all = curves(&archive)?;
    let (count, first, last) = (all.len(), all[0], all[all.len() - 1]);
    let number = match layout.curve {
        None if count == 1 => first,
        None => return Err(ArchiveError::ManyCurves { count, first, last }),
        Some(wanted) if all.contains(&wanted) => wanted,
        Some(wanted) => return Err(ArchiveError::NoSuchCurve { wanted, count, first, last }),
    };
    let single = !archive.numbers("segments/")?.is_empty();
    let root = if single { String::new() } else { format!("index/{number}/") };
    let common = if archive.has(SHARED) { Some(archive.properties(SHARED)?) } else { None };
    let general = archive.properties(&format!("{root}header.properties"))?;
    let mut curve = Curve::default();
    let parts = parts(&mut archive, &root, common.as_ref(), &general, &mut curve.notes)?;
    let force = wanted(&parts, layout.force_column.as_deref(), &[FORCE], "data.force_column")?;
    let heights = [MEASURED, PIEZO].concat();
    let height = wanted(&parts, layout.height_column.as_deref(), &heights, "data.height_column")?;
    if layout.height_column.is_none() && PIEZO.contains(&height.as_str()) {
        curve.notes.push(format!(
            "no sensor measured the height; {height}, which the voltage on the piezo says, is taken"
        ));
    }
    let told = Told { sensitivity: layout.sensitivity, spring_constant: layout.spring_constant };
    let (mut stated, mut unused) = (Told::default(), Vec::new());
    let sign = layout.force_sign.unwrap_or(1.0);
    let turn = if layout.height_rises == Some(true) { -1.0 } else { 1.0 };
    for part in &parts {
        let channels = channels(&part.header)?.join(", ");
        let mut load = |name| -> Result<_, ArchiveError> {
            let channel = Channel::new(name, &part.header, common.as_ref())?;
            let entry = format!("{}{}", part.folder, channel.file()?);
            let bytes = archive.channel(&entry)?;
            Ok((channel, entry, bytes))
        };
        let (channel, entry, bytes) = load(force.as_str())?;
        let mut forces = channel.force(&entry, &bytes, told)?;
        stated = channel.stated()?;
        unused = channel.unused(told)?;
        let (channel, entry, bytes) = load(height.as_str())?;
        let mut lengths = channel.height(&entry, &bytes, &channels)?;
        forces.iter_mut().for_each(|f| *f *= sign);
        lengths.iter_mut().for_each(|h| *h *= turn);
        if forces.is_empty() {
            curve.notes.push(format!("segment {} holds no samples", part.number));
            continue;
        }
        // a direction may be divided into segments with other speeds
        match curve.segments.last_mut().filter(|s| s.direction == part.direction) {
            Some(before) => {
                before.height.append(&mut lengths);
                before.force.append(&mut forces);
            }
            None => curve.segments.push(Segment {
                direction: part.direction,
                height: lengths,
                force: forces,
            }),
        }
    }
    curve.notes.append(&mut unused);
    if let (Some(file), Some(known)) = (stated.sensitivity, told.sensitivity)
        && (file / known - 1.0).abs() > 1e-6
    {
        curve.notes.push(format!(
            "the file states a sensitivity of {file:e} m/V; {known:e} m/V is taken, as the file of known values says"
        ));
    }
    curve.spring_constant = stated.spring_constant;
    Ok(curve)
}

/// The segments that approach or retract, in the order of time.
fn parts(
    archive: &mut Archive<'_>,
    root: &str,
    common: Option<&Properties>,
    general: &Properties,
    notes: &mut Vec<String>,
) -> Result<Vec<Part>, ArchiveError> {
    let numbers = archive.numbers(&format!("{root}segments/"))?;
    let (mut parts, mut pauses) = (Vec::new(), Vec::new());
    for &number in &numbers {
        let folder = format!("{root}segments/{number}/");
        let header = archive.properties(&format!("{folder}segment-header.properties"))?;
        match direction(&header, common)? {
            Some(direction) => parts.push(Part { number, folder, header, direction }),
            None => pauses.push(number.to_string()),
        }
    }
    if parts.is_empty() {
        let found = match pauses.as_slice() {
            [] => "none at all".to_owned(),
            some => format!("pauses alone: {}", some.join(", ")),
        };
        return Err(ArchiveError::OnlyPauses { found });
    }
    if !pauses.is_empty() {
        notes.push(format!("pauses are not fitted and left out: segment {}", pauses.join(", ")));
    }
    // an instrument that was stopped states more than it wrote
    if let Some((key, value)) = general.ending("force-segments.count")
        && value.trim().parse() != Ok(numbers.len())
    {
        notes.push(format!("{key} = {value}, but the archive holds {} segments", numbers.len()));
    }
    Ok(parts)
}

/// Which way a segment goes; a pause goes none.
fn direction(
    header: &Properties,
    common: Option<&Properties>,
) -> Result<Option<Direction>, ArchiveError> {
    const OWN: &str = "force-segment-header";
    let mut places = vec![(header, OWN.to_owned())];
    if let Some(number) = header.get(&format!("{OWN}.{OWN}-info.*")) {
        let missing = || ArchiveError::NoEntry { entry: SHARED.to_owned() };
        places.push((common.ok_or_else(missing)?, format!("{OWN}-info.{number}")));
    }
    let ends = ["settings.style", "settings.segment-settings.style"];
    let mut keys = places.iter().flat_map(|(properties, place)| {
        ends.map(|end| (&properties.entry, format!("{place}.{end}"), *properties))
    });
    let found = keys.find_map(|(entry, key, properties)| {
        let value = properties.get(&key)?;
        Some((entry, key, value))
    });
    let Some((entry, key, value)) = found else {
        let (properties, place) = &places[places.len() - 1];
        let key = format!("{place}.{}", ends[0]);
        return Err(ArchiveError::NoKey { entry: properties.entry.clone(), key });
    };
    match value {
        "extend" => Ok(Some(Direction::Approach)),
        "retract" => Ok(Some(Direction::Retract)),
        "pause" => Ok(None),
        other => Err(ArchiveError::Value {
            entry: entry.clone(),
            key,
            value: other.chars().take(40).collect(),
            allowed: "extend, retract or pause".to_owned(),
        }),
    }
}

fn channels(header: &Properties) -> Result<Vec<&str>, ArchiveError> {
    match header.get("channels.list") {
        Some(list) => Ok(list.split_whitespace().collect()),
        None => Err(ArchiveError::NoKey {
            entry: header.entry.clone(),
            key: "channels.list".to_owned(),
        }),
    }
}

/// The channel that is asked for, or the first of `names`, that all segments have.
fn wanted(
    parts: &[Part],
    told: Option<&str>,
    names: &[&str],
    option: &'static str,
) -> Result<String, ArchiveError> {
    let lists = parts.iter().map(|p| channels(&p.header)).collect::<Result<Vec<_>, _>>()?;
    let asked = told.map(|name| vec![name]);
    let names = asked.as_deref().unwrap_or(names);
    let all = |name: &&&str| lists.iter().all(|list| list.contains(*name));
    if let Some(name) = names.iter().find(all) {
        return Ok((*name).to_owned());
    }
    let lacks = lists.iter().position(|list| !names.iter().any(|name| list.contains(name)));
    let at = lacks.unwrap_or(0);
    Err(ArchiveError::NoChannel {
        entry: parts[at].header.entry.clone(),
        option,
        wanted: names.join("\" or \""),
        found: lists[at].join(", "),
    })
}
