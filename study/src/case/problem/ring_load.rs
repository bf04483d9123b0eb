//! A case under a ring load: bending stiffness and a little gas, the path in degrees.

use super::{ProblemCase, Read};
use crate::case::MeshCase;
use crate::case::keys::{self, Absent, Key, Range, names};
use crate::case::resolve::{HOMES, Resolver};
use crate::case::write::{self, Lines};
use shell_contact::{RingGroups, Shell};

/// A shell under a ring load.
#[derive(Debug, Clone, PartialEq)]
pub struct RingLoadCase {
    /// The shell's material.
    pub shell: Shell,
    /// The dimensionless groups.
    pub groups: RingGroups,
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

const ANGLE: Range =
    Range { holds: |x| x > 0.0 && x < 90.0, words: "an angle between 0 and 90 degrees" };

impl Resolver<'_> {
    pub(in crate::case) fn ring_load(&mut self) -> Read {
        let tables = [
            "name",
            "problem",
            "shell",
            "dimensionless",
            "mesh",
            "path",
            "diagram",
            "map",
            "picture",
        ];
        self.reader.only(self.root, &tables, HOMES);
        let shell = self.shell();
        let groups = self.table("dimensionless", NAMES);
        let bending = self.required(groups, &keys::BENDING);
        let pressure = self.or_default(groups, &PRESSURE);
        let gas_exponent = self.or_default(groups, &GAS_EXPONENT);
        let mesh = self.fixed_mesh();
        let path = self.path(None, ANGLE, ANGLE);
        let problem = match (shell, bending, pressure, gas_exponent, mesh) {
            (Some(shell), Some(bending), Some(pressure), Some(gas_exponent), Some(mesh)) => {
                let groups = RingGroups { bending, pressure, gas_exponent };
                let case = RingLoadCase { shell, groups, mesh };
                Some(ProblemCase::RingLoad(case))
            }
            _ => None,
        };
        (problem, path)
    }
}

/// The case as a case file has it.
pub(super) fn write(out: &mut Lines, case: &RingLoadCase) {
    out.text("problem", "ring-load");
    write::shell(out, case.shell);
    out.table("dimensionless");
    out.number("bending", case.groups.bending);
    out.number("pressure", case.groups.pressure);
    out.number("gas_exponent", case.groups.gas_exponent);
    write::mesh(out, case.mesh);
}
