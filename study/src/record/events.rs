//! `events.json`: special points, why the branch ended, what it cost.

use super::orbits::MultipliersOf;
use super::physical::{Laboratory, in_unit};
use super::result::{
    EventRecord, MaxwellRecord, ResolutionRecord, StabilityRecord, Table, TraceResult,
};
use crate::case::ResolvedCase;
use serde::ser::{Serialize, SerializeMap, Serializer};

/// The JSON, indented, with a newline at the end; NaN and infinities are null. Special points of a case in
/// physical units have their numbers in those too.
///
/// # Errors
/// What the writer reports; memory does not fail, so none is expected.
pub fn events_json(case: &ResolvedCase, result: &TraceResult) -> Result<String, serde_json::Error> {
    let laboratory = Laboratory::of(case, &[&result.table]);
    let mut text = serde_json::to_string_pretty(&Document(result, laboratory))?;
    text.push('\n');
    Ok(text)
}

struct Document<'a>(&'a TraceResult, Option<Laboratory>);

impl Serialize for Document<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Document(result, laboratory) = self;
        let laboratory = laboratory.as_ref();
        let events: Vec<EventOf<'_>> = result
            .events
            .iter()
            .map(|event| EventOf {
                event,
                parameter: &result.parameter,
                laboratory: laboratory.map(|laboratory| (laboratory, &result.table)),
            })
            .collect();
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("case", &result.case)?;
        map.serialize_entry("parameter", &result.parameter)?;
        map.serialize_entry("events", &events)?;
        if let Some(maxwell) = &result.maxwell {
            map.serialize_entry("maxwell", &maxwell_of(maxwell))?;
        }
        if let Some(stability) = &result.stability {
            map.serialize_entry("stability", &StabilityOf(stability))?;
        }
        if let Some(resolution) = &result.resolution {
            map.serialize_entry("resolution", &ResolutionOf(resolution))?;
        }
        map.serialize_entry("stopped_because", &result.stopped_because.to_string())?;
        map.serialize_entry("stopped_detail", &result.stopped_detail)?;
        map.serialize_entry("points", &result.points)?;
        map.serialize_entry("certified", &result.certified)?;
        map.serialize_entry("newton_iterations", &result.newton_iterations)?;
        map.serialize_entry("seconds", &result.seconds)?;
        map.end()
    }
}

/// What was examined.
pub(in crate::record) struct StabilityOf<'a>(pub(in crate::record) &'a StabilityRecord);

impl Serialize for StabilityOf<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("scan", if self.0.full { "full" } else { "axisymmetric" })?;
        if self.0.both_parities {
            map.serialize_entry("parities", &["symmetric", "antisymmetric"])?;
        }
        if self.0.full {
            map.serialize_entry("max_n", &self.0.max_n)?;
            map.serialize_entry("certain", &self.0.certain)?;
            map.serialize_entry("not_located", &self.0.not_located)?;
        }
        map.end()
    }
}

/// How well the elements resolve the solution.
pub(super) struct ResolutionOf<'a>(pub(super) &'a ResolutionRecord);

impl Serialize for ResolutionOf<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("enough", &self.0.enough)?;
        map.serialize_entry(self.0.parameter, &self.0.at)?;
        map.serialize_entry("elements_per_film_length", &self.0.per_film_length)?;
        map.serialize_entry("elements_per_wavelength", &self.0.per_wavelength)?;
        map.serialize_entry("elements", &self.0.elements)?;
        map.serialize_entry("elements_wanted", &self.0.wanted)?;
        if let Some(error) = &self.0.mesh_error {
            map.serialize_entry("force_mesh_error", &error.force)?;
            map.serialize_entry("force_mesh_error_at", &error.at)?;
            map.serialize_entry("force_mesh_error_points", &error.samples)?;
            entry(&mut map, "z0_mesh_error", error.z0)?;
        }
        if let Some(tolerance) = self.0.tolerance {
            map.serialize_entry("mesh_tolerance", &tolerance)?;
            map.serialize_entry("mesh_tolerance_met", &self.0.meets_tolerance())?;
        }
        map.end()
    }
}

/// A special point with the name of its parameter.
pub(super) struct EventOf<'a> {
    pub(super) event: &'a EventRecord,
    pub(super) parameter: &'a str,
    /// The units of a case that is in physical ones, with the branch whose columns say what has which.
    pub(super) laboratory: Option<(&'a Laboratory, &'a Table)>,
}

/// Numbers of a special point in physical units, the unit at the end of each name as in tables.
struct Physically<'a>(&'a EventOf<'a>, &'a Laboratory, &'a Table);

impl Serialize for Physically<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Physically(EventOf { event, parameter, .. }, laboratory, table) = self;
        let mut values = vec![(*parameter, event.parameter)];
        let others = [
            ("z0", event.z0),
            ("force", event.force),
            ("deformation", event.deformation),
            ("energy_total", event.energy_total),
        ];
        values.extend(others.into_iter().filter(|(name, _)| name != parameter));
        let mut map = serializer.serialize_map(None)?;
        for (name, value) in values {
            let Some(((unit, factor), value)) = laboratory.convert(table.unit(name)).zip(value)
            else {
                continue;
            };
            map.serialize_entry(&in_unit(name, unit), &(factor * value))?;
        }
        map.end()
    }
}

impl Serialize for EventOf<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let event = self.event;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("kind", &event.kind)?;
        map.serialize_entry("parameter", self.parameter)?;
        map.serialize_entry(self.parameter, &event.parameter)?;
        entry(&mut map, "z0", event.z0)?;
        if self.parameter != "force" {
            map.serialize_entry("force", &event.force)?;
        }
        map.serialize_entry("deformation", &event.deformation)?;
        map.serialize_entry("energy_total", &event.energy_total)?;
        map.serialize_entry("unstable_before", &event.unstable_before)?;
        map.serialize_entry("unstable_after", &event.unstable_after)?;
        map.serialize_entry("residual", &event.residual)?;
        map.serialize_entry("error_estimate", &event.error_estimate)?;
        if let Some(error) = &event.mesh_error {
            entry(&mut map, "mesh_error", error.z0)?;
            entry(&mut map, "force_mesh_error", error.force)?;
        }
        let form = &event.form;
        entry(&mut map, "type", form.kind)?;
        entry(&mut map, "criticality", form.criticality)?;
        entry(&mut map, "multiplicity", form.multiplicity)?;
        entry(&mut map, "branches", form.branches)?;
        entry(&mut map, "curvature", form.curvature)?;
        entry(&mut map, "order", form.order)?;
        entry(&mut map, "frequency", form.frequency)?;
        entry(&mut map, "lyapunov", form.lyapunov)?;
        entry(&mut map, "lyapunov_error", form.lyapunov_error)?;
        entry(&mut map, "certified", form.certified)?;
        if let Some(mode) = &event.mode {
            map.serialize_entry("n", &mode.n)?;
            map.serialize_entry("parity", mode.parity)?;
            map.serialize_entry("modes_before", &mode.before)?;
            map.serialize_entry("modes_after", &mode.after)?;
        }
        if let Some(cycle) = &event.cycle {
            map.serialize_entry("period", &cycle.period)?;
            map.serialize_entry("period_error", &cycle.period_error)?;
            map.serialize_entry("multipliers", &MultipliersOf(&cycle.multipliers))?;
            map.serialize_entry("trivial_error", &cycle.trivial_error)?;
        }
        if !event.observables.is_empty() {
            map.serialize_entry("observables", &Named(&event.observables))?;
        }
        if let Some((laboratory, table)) = self.laboratory {
            map.serialize_entry("physical", &Physically(self, laboratory, table))?;
        }
        map.end()
    }
}

/// Maxwell points as JSON.
pub(super) fn maxwell_of(points: &[MaxwellRecord]) -> Vec<MaxwellOf<'_>> {
    points.iter().map(MaxwellOf).collect()
}

/// A pair of states of equal potential; what both share is a number, the rest an array of two.
pub(super) struct MaxwellOf<'a>(&'a MaxwellRecord);

impl Serialize for MaxwellOf<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let point = self.0;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry(point.parameter, &point.value)?;
        if point.parameter != "z0" {
            map.serialize_entry("potential", &point.potential)?;
            map.serialize_entry("z0", &point.z0)?;
            map.serialize_entry("energy_totals", &point.energy)?;
        } else {
            map.serialize_entry("energy_total", &point.potential)?;
        }
        if point.parameter != "force" {
            map.serialize_entry("force", &point.force)?;
        }
        map.serialize_entry("unstable", &point.unstable)?;
        map.serialize_entry("error_estimate", &point.error_estimate)?;
        map.end()
    }
}

struct Named<'a>(&'a [(String, f64)]);

impl Serialize for Named<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

/// Writes an entry that may not apply.
fn entry<M: SerializeMap, V: Serialize>(
    map: &mut M,
    key: &str,
    value: Option<V>,
) -> Result<(), M::Error> {
    match value {
        Some(value) => map.serialize_entry(key, &value),
        None => Ok(()),
    }
}
