//! Colours that people with any colour vision can tell apart (Okabe and Ito), and marker shapes.

use study::record::phase::Class;

/// Red, green and blue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Color(pub(super) u8, pub(super) u8, pub(super) u8);

/// `#rrggbb`.
pub(super) fn hex(color: Color) -> String {
    format!("#{:02x}{:02x}{:02x}", color.0, color.1, color.2)
}

const BLACK: Color = Color(0, 0, 0);
const BLUE: Color = Color(0, 114, 178);
const VERMILLION: Color = Color(213, 94, 0);
const GREEN: Color = Color(0, 158, 115);
const PURPLE: Color = Color(204, 121, 167);
const ORANGE: Color = Color(230, 159, 0);
const SKY: Color = Color(86, 180, 233);

/// The colour of what is unstable, on a line of one colour.
pub(super) const UNSTABLE: Color = VERMILLION;
/// The same of what is unstable to modes without its symmetries only.
pub(super) const ASYMMETRIC: Color = PURPLE;
/// Behind curves, where there are several states.
pub(super) const SEVERAL: Color = Color(253, 231, 213);
/// Grey of grids.
pub(super) const GRID: Color = Color(228, 228, 228);
/// Grey of lines that carry no data: zero, axis of symmetry, the sphere at rest.
pub(super) const FAINT: Color = Color(150, 150, 150);

/// The colour of a quantity, the same in every picture.
pub(super) fn of_quantity(label: &str) -> Color {
    match label {
        "force" => BLUE,
        "total" => BLACK,
        "stretching" => BLUE,
        "bending" => VERMILLION,
        "film" => GREEN,
        "gas" => PURPLE,
        "surface" => ORANGE,
        "hopf" => VERMILLION,
        "branch-point" => GREEN,
        "cycle-fold" => SKY,
        "period-doubling" => PURPLE,
        _ => BLUE,
    }
}

/// The colour of the state at a place of a list, the same in every picture.
pub(super) fn of_state(at: usize) -> Color {
    const STATES: [Color; 7] = [BLACK, BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY];
    STATES[at % STATES.len()]
}

/// The form of a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// A disc.
    Disc,
    /// A square.
    Square,
    /// A triangle, point up.
    Up,
    /// A triangle, point down.
    Down,
    /// A square on its corner.
    Diamond,
    /// The same, hollow.
    HollowDiamond,
    /// A ring.
    Ring,
    /// A diagonal cross.
    Cross,
}

/// The marker of a kind of special point.
pub(super) fn form(kind: &str) -> Form {
    match kind {
        "fold" => Form::Disc,
        "branch-point" => Form::Square,
        "zero-force" => Form::Up,
        "pull-off" => Form::Down,
        "knee" => Form::Diamond,
        "contact" => Form::Ring,
        "hopf" | "generalised-hopf" => Form::Ring,
        "period-doubling" => Form::Up,
        "neimark-sacker" => Form::Down,
        "cusp" | "cycle-cusp" => Form::Up,
        "bogdanov-takens" => Form::Square,
        "zero-hopf" => Form::Diamond,
        "double-hopf" => Form::HollowDiamond,
        other if other.ends_with("-maximum") => Form::Diamond,
        other if other.ends_with("-minimum") => Form::HollowDiamond,
        _ => Form::Cross,
    }
}

/// The colour of a class of a phase diagram: apart in lightness too.
pub(super) fn of_class(class: Class) -> Color {
    match class {
        Class::Flat => SKY,
        Class::Buckles => ORANGE,
        Class::BypassesBuckling => BLUE,
        Class::Hysteresis => VERMILLION,
        Class::Unknown => GRID,
    }
}
