//! A branch in physical units: the same columns, beside the dimensionless ones, which stay as they are.

use super::result::{Cell, Table};
use crate::case::{PhysicalCase, PhysicalShell, ProblemCase, ResolvedCase};
use std::f64::consts::PI;

/// What one dimensionless unit of a shell is, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// `R0`, in m.
    pub length: f64,
    /// `sqrt(chi k_b)`, in N.
    pub force: f64,
    /// `chi / R0`, in Pa.
    pub pressure: f64,
    /// `chi R0²`, in J.
    pub energy: f64,
    /// `chi`, in N/m.
    pub tension: f64,
    /// `w0 / delta_A`, in Pa, the unit of the film's pressure; `None` without a film, and where two plates have
    /// films of different units.
    pub film_pressure: Option<f64>,
    /// Thickness `h` of the homogeneous wall with these moduli, in m.
    pub thickness: f64,
}

impl Scales {
    /// Those of a case; `None` for one that is not in physical units.
    pub fn of(case: &ResolvedCase) -> Option<Scales> {
        match &case.problem {
            ProblemCase::Contact(contact) => {
                let physical = contact.physical.as_ref()?;
                let film = physical.adhesion.si / physical.film.si;
                let (poisson, groups) = (contact.shell.poisson, &contact.groups);
                let wall = (12.0 * (1.0 - poisson * poisson) * groups.bending).sqrt();
                let thickness = physical.radius.si * wall;
                let force = physical.force_scale(groups);
                let (radius, chi) = (physical.radius.si, physical.chi());
                Some(Scales::new(radius, chi, (force, thickness), Some(film)))
            }
            ProblemCase::TwoPlates(plates) => {
                let physical = plates.physical.as_ref()?;
                let films = plates.physical_plates.iter().flatten();
                let mut units = films.map(|plate| plate.adhesion.si / plate.film.si);
                let first = units.next();
                let film = first.filter(|first| units.all(|other| other == *first));
                Some(Scales::of_shell(physical, plates.shell.poisson, film))
            }
            ProblemCase::RingLoad(ring) => {
                Some(Scales::of_shell(ring.physical.as_ref()?, ring.shell.poisson, None))
            }
            ProblemCase::Catalogue(_) => None,
        }
    }

    fn of_shell(shell: &PhysicalShell, poisson: f64, film: Option<f64>) -> Scales {
        let (force, thickness) = (shell.force_scale(poisson), shell.thickness(poisson));
        Scales::new(shell.radius.si, shell.stiffness.chi(), (force, thickness), film)
    }

    fn new(
        radius: f64,
        chi: f64,
        (force, thickness): (f64, f64),
        film_pressure: Option<f64>,
    ) -> Scales {
        Scales {
            length: radius,
            force,
            pressure: chi / radius,
            energy: chi * radius * radius,
            tension: chi,
            film_pressure,
            thickness,
        }
    }

    /// By how much the unit of forces between plates, `sqrt(chi k_b)`, exceeds that of the case where this is the
    /// bending group `k_b/(chi R0^2)`: along curves over it every point has its own.
    pub(super) fn force_unit_with(&self, bending: f64) -> f64 {
        bending.sqrt() * self.tension * self.length / self.force
    }

    /// `2e-6 pi chi R0`, the unit of forces under a ring load, in N.
    fn ring_force(&self) -> f64 {
        2e-6 * PI * self.tension * self.length
    }
}

/// The unit of forces between plates, as columns name it.
pub(super) const FORCE: &str = "sqrt(chi k_b)";
/// The column of curves over the bending group.
pub(super) const BENDING: &str = "bending";
/// The unit of forces under a ring load, as columns name it.
const RING_FORCE: &str = "2e-6 pi chi R0";

/// A unit and its size in SI units.
pub type Unit = (&'static str, f64);

const LENGTHS: [Unit; 3] = [("nm", 1e-9), ("um", 1e-6), ("mm", 1e-3)];
const FORCES: [Unit; 6] =
    [("pN", 1e-12), ("nN", 1e-9), ("uN", 1e-6), ("mN", 1e-3), ("N", 1.0), ("kN", 1e3)];
const PRESSURES: [Unit; 4] = [("Pa", 1.0), ("kPa", 1e3), ("MPa", 1e6), ("GPa", 1e9)];
const ENERGIES: [Unit; 7] = [
    ("aJ", 1e-18),
    ("fJ", 1e-15),
    ("pJ", 1e-12),
    ("nJ", 1e-9),
    ("uJ", 1e-6),
    ("mJ", 1e-3),
    ("J", 1.0),
];
const TENSIONS: [Unit; 3] = [("uN/m", 1e-6), ("mN/m", 1e-3), ("N/m", 1.0)];
const VOLUMES: [Unit; 3] = [("nm^3", 1e-27), ("um^3", 1e-18), ("mm^3", 1e-9)];

/// A unit gives way to the next one where numbers reach this; lengths of shells stay in nanometres
/// longer.
const LARGE: f64 = 1e3;

/// The units in which the numbers of a branch are easily read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhysicalUnits {
    /// Of distances.
    pub length: Unit,
    /// Of volumes.
    pub volume: Unit,
    /// Of forces.
    pub force: Unit,
    /// Of pressures.
    pub pressure: Unit,
    /// Of energies, bending moduli among them.
    pub energy: Unit,
    /// Of tensions, adhesion among them.
    pub tension: Unit,
    /// Of the film's pressure.
    pub film_pressure: Unit,
}

impl PhysicalUnits {
    /// The units for a branch: the largest number of each kind has one to three digits before the point.
    pub fn for_table(scales: &Scales, table: &Table) -> PhysicalUnits {
        PhysicalUnits::for_tables(scales, &[table])
    }

    /// The same for several branches, which share their units.
    pub fn for_tables(scales: &Scales, tables: &[&Table]) -> PhysicalUnits {
        let largest = |unit: &str| {
            let numbers = tables.iter().flat_map(|table| {
                let of_unit = table.columns().iter().filter(|name| table.unit(name) == unit);
                of_unit.flat_map(|name| table.numbers(name)).collect::<Vec<f64>>()
            });
            numbers
                .filter(|value| value.is_finite())
                .fold(0.0_f64, |largest, value| largest.max(value.abs()))
        };
        PhysicalUnits {
            // a shell of some micrometres is pressed by nanometres
            length: choose(&LENGTHS, scales.length * largest("R0") / 100.0),
            volume: choose(&VOLUMES, scales.length.powi(3) * largest("R0^3")),
            force: choose(
                &FORCES,
                f64::max(scales.force * largest(FORCE), scales.ring_force() * largest(RING_FORCE)),
            ),
            pressure: choose(&PRESSURES, scales.pressure * largest("chi/R0")),
            tension: choose(&TENSIONS, scales.tension * largest("chi")),
            energy: choose(&ENERGIES, scales.energy * largest("chi R0^2")),
            film_pressure: choose(&PRESSURES, scales.film_pressure.unwrap_or_default()),
        }
    }

    /// The physical unit of what has this dimensionless one, and what a number must be multiplied with.
    pub fn of(&self, scales: &Scales, unit: &str) -> Option<(&'static str, f64)> {
        let ((name, size), scale) = match unit {
            "R0" => (self.length, scales.length),
            "R0^3" => (self.volume, scales.length.powi(3)),
            FORCE => (self.force, scales.force),
            "chi/R0" => (self.pressure, scales.pressure),
            "chi R0^2" => (self.energy, scales.energy),
            "chi" => (self.tension, scales.tension),
            "w0/delta_A" => (self.film_pressure, scales.film_pressure?),
            "h" => (self.length, scales.thickness),
            RING_FORCE => (self.force, scales.ring_force()),
            _ => return None,
        };
        Some((name, scale / size))
    }
}

fn choose(units: &[Unit], largest: f64) -> Unit {
    let fits = |unit: &&Unit| largest < LARGE * unit.1;
    let last = units.last().copied().unwrap_or(("", 1.0));
    units.iter().find(fits).copied().unwrap_or(last)
}

/// The units of a case in physical units, and what they are worth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Laboratory {
    /// What one dimensionless unit is.
    pub scales: Scales,
    /// The units in which its numbers are written.
    pub units: PhysicalUnits,
}

impl Laboratory {
    /// That of a case with these tables; `None` for one that is not in physical units.
    pub fn of(case: &ResolvedCase, tables: &[&Table]) -> Option<Laboratory> {
        let scales = Scales::of(case)?;
        Some(Laboratory { scales, units: PhysicalUnits::for_tables(&scales, tables) })
    }

    /// The physical unit of what has this dimensionless one, and what a number must be multiplied with.
    pub fn convert(&self, unit: &str) -> Option<(&'static str, f64)> {
        self.units.of(&self.scales, unit)
    }

    /// Whether any column of a table has a unit here.
    pub fn converts(&self, table: &Table) -> bool {
        table.columns().iter().any(|name| self.convert(table.unit(name)).is_some())
    }

    /// A table in these units: its columns of names and numbers of points, then every column that has a
    /// unit, with its new unit at the end of its name (`z0_nm`, `force_nN`), then `event`.
    pub fn table(&self, case: &ResolvedCase, table: &Table) -> Table {
        const FIRST: [&str; 3] = ["point", "direction", "step"];
        let columns = table.columns();
        let first: Vec<usize> =
            FIRST.iter().filter_map(|name| columns.iter().position(|own| own == name)).collect();
        let mut titles: Vec<String> = first.iter().map(|at| columns[*at].clone()).collect();
        let mut numbers: Vec<Vec<f64>> = Vec::new();
        for name in columns {
            let Some((unit, factor)) = self.convert(table.unit(name)) else { continue };
            titles.push(in_unit(name.trim_end_matches("_over_h"), unit));
            let mut values = table.numbers(name);
            values.iter_mut().for_each(|value| *value *= factor);
            if table.unit(name) == FORCE && columns.iter().any(|own| own == BENDING) {
                let own = table.numbers(BENDING).into_iter();
                let units = own.map(|bending| self.scales.force_unit_with(bending));
                values.iter_mut().zip(units).for_each(|(value, unit)| *value *= unit);
            }
            numbers.push(values);
        }
        for (name, values) in of_the_laboratory(case, &self.scales, table) {
            let (unit, size) = self.units.length;
            titles.push(format!("{name}_{unit}"));
            numbers.push(values.into_iter().map(|value| value / size).collect());
        }
        titles.push("event".to_owned());
        let titles: Vec<&str> = titles.iter().map(String::as_str).collect();
        let mut out = Table::with_columns(&titles);
        let events: std::collections::BTreeMap<usize, &str> = table.words("event").collect();
        for (row, own) in table.rows().iter().enumerate() {
            let mut cells: Vec<Cell> = first.iter().map(|at| own[*at].clone()).collect();
            cells.extend(numbers.iter().map(|values| Cell::Real(values[row])));
            cells.push(events.get(&row).copied().unwrap_or("").into());
            out.push(cells);
        }
        out
    }
}

/// A table in physical units by itself. `None` for a case that is not in physical units.
pub fn physical_table(case: &ResolvedCase, table: &Table) -> Option<Table> {
    Some(Laboratory::of(case, &[table])?.table(case, table))
}

/// What a column is called that has this unit.
pub(super) fn in_unit(name: &str, unit: &str) -> String {
    format!("{name}_{}", unit.replace('^', "").replace('/', "_per_"))
}

/// A unit as people write it: tables do without the one letter that is not ASCII, and without raised digits.
pub fn spoken(unit: &str) -> String {
    let unit = unit.replace("^3", "³").replace("^2", "²");
    if unit.starts_with('u') { unit.replacen('u', "µ", 1) } else { unit }
}

/// The lengths that a laboratory names, in m, of a case that speaks of its lever or its path in such words: the
/// separation of the plates, the approach of one pole and of both, and under a lever the travel of its base.
fn of_the_laboratory(
    case: &ResolvedCase,
    scales: &Scales,
    table: &Table,
) -> Vec<(&'static str, Vec<f64>)> {
    let ProblemCase::Contact(contact) = &case.problem else { return Vec::new() };
    let named = |physical: &PhysicalCase| physical.lever.is_some() || physical.path.is_some();
    if !contact.physical.as_deref().is_some_and(named) {
        return Vec::new();
    }
    let z0 = table.numbers("z0");
    let of = |f: &dyn Fn(f64) -> f64| z0.iter().map(|z| f(*z) * scales.length).collect();
    let mut out: Vec<(&'static str, Vec<f64>)> = vec![
        ("separation", of(&|z| 2.0 * z)),
        ("approach_one_pole", of(&|z| 1.0 - z)),
        ("total", of(&|z| 2.0 * (1.0 - z))),
    ];
    if let Some(stiffness) = contact.device.stiffness() {
        let force = table.numbers("force");
        let piezo =
            z0.iter().zip(force).map(|(z, f)| 2.0 * scales.length * (1.0 - z + f / stiffness));
        out.push(("piezo", piezo.collect()));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::load;
    use crate::record::ContactRow;

    /// The polymer-coated shell that is shipped: `R0` = 1.5 um, `chi` = 52.5 N/m.
    fn polymer() -> ResolvedCase {
        load("polymer".as_ref(), &[], &[]).unwrap().case
    }

    #[test]
    fn numbers_are_those_of_the_laboratory() {
        let mut table = Table::contact();
        let row = ContactRow { z0: 0.9, force: 2.0, gas_pressure: 3e-3, ..ContactRow::default() };
        table.push(row.cells());
        let physical = physical_table(&polymer(), &table).unwrap();
        let of = |name: &str| physical.numbers(name)[0];
        assert!((of("z0_nm") - 1350.0).abs() < 1e-9);
        // E h³/(12 (1 − nu²)) = 2.1e9 · 1.5625e-23/9
        let bending = 2.1e9 * 1.5625e-23 / 9.0;
        let force = 2.0 * f64::sqrt(52.5 * bending);
        assert!((of("force_nN") / (force * 1e9) - 1.0).abs() < 1e-12, "{}", of("force_nN"));
        assert!((of("gas_pressure_kPa") - 105.0).abs() < 1e-9);
        assert!(physical.columns().contains(&"energy_total_aJ".to_owned()));
        assert_eq!(physical.columns().last().map(String::as_str), Some("event"));
        assert!(!physical.columns().iter().any(|name| name.starts_with("unstable")));
    }

    #[test]
    fn a_dimensionless_case_has_no_such_table() {
        let case = load("fig12".as_ref(), &[], &[]).unwrap().case;
        assert_eq!(physical_table(&case, &Table::contact()), None);
    }

    #[test]
    fn units_go_with_the_size_of_the_numbers() {
        let scales = Scales::of(&polymer()).unwrap();
        let unit = |force: f64| {
            let mut table = Table::contact();
            table.push(ContactRow { force, ..ContactRow::default() }.cells());
            PhysicalUnits::for_table(&scales, &table).force.0
        };
        assert_eq!([1e-9, 1e-3, 1.0, 100.0].map(unit), ["pN", "pN", "nN", "uN"]);
        // nothing is drawn of what is not finite
        assert_eq!(unit(f64::NAN), "pN");
    }
}
