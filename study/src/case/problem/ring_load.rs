//! A case under a ring load: bending stiffness and a little gas, the path in degrees.

use super::{ProblemCase, Read};
use crate::case::keys::{self, Absent, Key, Range, names};
use crate::case::physical::ShellKeys;
use crate::case::reader::Section;
use crate::case::resolve::{HOMES, Resolver};
use crate::case::write::{self, Lines};
use crate::case::{MeshCase, PhysicalShell};
use shell_contact::{RingGroups, Shell};

/// A shell under a ring load.
#[derive(Debug, Clone, PartialEq)]
pub struct RingLoadCase {
    /// The shell's material.
    pub shell: Shell,
    /// The dimensionless groups.
    pub groups: RingGroups,
    /// The shell in physical units, if it was given in them.
    pub physical: Option<Box<PhysicalShell>>,
    /// The mesh.
    pub mesh: MeshCase,
}

/// `dimensionless.pressure` under a ring load.
const PRESSURE: Key = Key { default: Absent::Number(0.0), ..keys::PRESSURE };
/// `dimensionless.gas_exponent` under a ring load.
const GAS_EXPONENT: Key = Key { default: Absent::Number(0.0), ..keys::GAS_EXPONENT };
/// The table `[dimensionless]` under a ring load.
pub(in crate::case) const GROUPS: [Key; 3] = [keys::BENDING, PRESSURE, GAS_EXPONENT];
const NAMES: &[&str] = &names(&GROUPS);

/// `physical.pressure` under a ring load.
const PHYSICAL_PRESSURE: Key = Key { default: Absent::Word("0 Pa"), ..keys::PHYSICAL_PRESSURE };
/// The table `[physical]` under a ring load.
pub(in crate::case) const PHYSICAL: [Key; 7] = [
    keys::RADIUS,
    keys::YOUNG,
    keys::THICKNESS,
    keys::CHI,
    keys::PHYSICAL_BENDING,
    PHYSICAL_PRESSURE,
    GAS_EXPONENT,
];
const SHELL_KEYS: ShellKeys =
    ShellKeys { pressure: PHYSICAL_PRESSURE, surface_tension: None, gas_exponent: GAS_EXPONENT };
const PHYSICAL_NAMES: &[&str] = &names(&PHYSICAL);

const ANGLE: Range =
    Range { holds: |x| x > 0.0 && x < 90.0, words: "an angle between 0 and 90 degrees" };

impl Resolver<'_> {
    pub(in crate::case) fn ring_load(&mut self) -> Read {
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
            "picture",
        ];
        self.reader.only(self.root, &tables, HOMES);
        let shell = self.shell();
        let groups = self.table("dimensionless", NAMES);
        let physical = self.table("physical", PHYSICAL_NAMES);
        let groups = match self.is_physical(groups, physical) {
            Some(false) => self.ring_groups(groups).map(|groups| (groups, None)),
            Some(true) => {
                let poisson = shell.map_or(0.5, |shell| shell.poisson);
                self.physical_shell(physical, &SHELL_KEYS, poisson).map(|(all, physical)| {
                    let bending = all.bending;
                    let (pressure, gas_exponent) = (all.pressure, all.gas_exponent);
                    let groups = RingGroups { bending, pressure, gas_exponent };
                    (groups, Some(Box::new(physical)))
                })
            }
            None => None,
        };
        let mesh = self.fixed_mesh();
        let path = self.path(None, ANGLE, ANGLE);
        let problem = match (shell, groups, mesh) {
            (Some(shell), Some((groups, physical)), Some(mesh)) => {
                Some(ProblemCase::RingLoad(RingLoadCase { shell, groups, physical, mesh }))
            }
            _ => None,
        };
        (problem, path)
    }

    fn ring_groups(&self, section: Section<'_>) -> Option<RingGroups> {
        let bending = self.required(section, &keys::BENDING);
        let pressure = self.or_default(section, &PRESSURE);
        let gas_exponent = self.or_default(section, &GAS_EXPONENT);
        Some(RingGroups { bending: bending?, pressure: pressure?, gas_exponent: gas_exponent? })
    }
}

/// The case as a case file has it.
pub(super) fn write(out: &mut Lines, case: &RingLoadCase) {
    out.text("problem", "ring-load");
    write::shell(out, case.shell);
    let groups = [
        ("bending", case.groups.bending),
        ("pressure", case.groups.pressure),
        ("gas_exponent", case.groups.gas_exponent),
    ];
    write::shell_groups(out, case.physical.as_deref(), &groups);
    write::mesh(out, case.mesh);
}
