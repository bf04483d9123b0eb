//! What the columns of tables are: a label and a unit for each name.

/// A column of a table.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Column {
    /// Its name, as in files.
    pub(super) name: &'static str,
    /// What it is, in words.
    pub(super) label: &'static str,
    /// Its unit; empty for counts, words and pure numbers.
    pub(super) unit: &'static str,
}

const fn column(name: &'static str, label: &'static str, unit: &'static str) -> Column {
    Column { name, label, unit }
}

/// Columns of shells between plates, under a device, or with a plate of their own at either pole.
pub(crate) const PLATES: &[Column] = &[
    column("point", "point", ""),
    column("direction", "direction", ""),
    column("step", "step", ""),
    column("z0", "plate distance", "R0"),
    column("base", "position of the base", "R0"),
    column("deformation", "deformation", "R0"),
    column("force", "force", "sqrt(chi k_b)"),
    column("unstable", "unstable modes", ""),
    column("pole_height", "height of the pole", "R0"),
    column("gas_pressure", "pressure of the gas", "chi/R0"),
    column("volume", "volume", "R0^3"),
    column("energy_total", "total energy", "chi R0^2"),
    column("energy_stretching", "energy of stretching", "chi R0^2"),
    column("energy_bending", "energy of bending", "chi R0^2"),
    column("energy_film", "energy of the film", "chi R0^2"),
    column("energy_gas", "energy of the gas", "chi R0^2"),
    column("energy_surface", "energy of the surface", "chi R0^2"),
    column("contact_radius", "contact radius", "R0"),
    column("bending", "bending modulus", "chi R0^2"),
    column("pressure", "ambient pressure", "chi/R0"),
    column("adhesion", "adhesion", "chi"),
    column("film", "thickness of the film", "R0"),
    column("adhesion_top", "adhesion of the upper plate", "chi"),
    column("film_top", "thickness of the upper film", "R0"),
    column("adhesion_bottom", "adhesion of the lower plate", "chi"),
    column("film_bottom", "thickness of the lower film", "R0"),
    column("surface_tension", "surface tension", "chi"),
    column("pole_top", "upper pole above the equator", "R0"),
    column("pole_bottom", "lower pole below the equator", "R0"),
    column("shift", "equator above the mid-plane", "R0"),
    column("force_bottom", "force on the lower plate", "sqrt(chi k_b)"),
    column("contact_radius_bottom", "contact radius at the lower plate", "R0"),
    column("unstable_antisymmetric", "unstable antisymmetric modes", ""),
    column("unstable_modes", "unstable modes with waves around the axis", ""),
    column("first_n", "fewest waves of an unstable mode", ""),
    column("stable", "stable", ""),
    column("event", "special point", ""),
];

/// Columns of shells under a ring load.
pub(crate) const RING: &[Column] = &[
    column("point", "point", ""),
    column("alpha", "contact angle", "degrees"),
    column("deflection_over_h", "deflection", "h"),
    column("force", "force", "2e-6 pi chi R0"),
    column("unstable", "unstable modes", ""),
    column("pole_height", "height of the pole", "R0"),
    column("ring_height", "height of the ring", "R0"),
    column("admissible", "shell inside the rings' planes", ""),
    column("energy_total", "total energy", "chi R0^2"),
    column("pole_over_h", "deflection of the pole", "h"),
    column("highest_over_h", "deflection of the highest point", "h"),
    column("event", "special point", ""),
];
