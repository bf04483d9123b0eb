//! The phase diagram of a plane of two parameters.

use super::axis::Axis;
use super::chart::{Chart, DrawError, Entry, Tile};
use super::palette;
use study::case::{PictureCase, shown};
use study::record::SweepResult;
use study::record::phase::Class;
use study::sweep;

/// Name of the picture.
pub const PHASE: &str = "phase.svg";

/// The phase diagram as SVG: one tile for each case, the first parameter to the right.
///
/// # Errors
/// When the sweep covers no plane, or the drawing library fails.
pub fn draw_phase(result: &SweepResult, picture: &PictureCase) -> Result<String, DrawError> {
    let plan = &result.plan;
    let Some((first, second)) = plan.plane() else {
        let detail = "the sweep does not vary two keys of numbers".to_owned();
        return Err(DrawError { picture: PHASE.to_owned(), detail });
    };
    let cells = (Cells::of(first), Cells::of(second));
    let (x, y) = (cells.0.axis(&first.key), cells.1.axis(&second.key));
    let mut met: Vec<Class> = Vec::new();
    let mut tiles = Vec::new();
    for record in &result.records {
        let class = record.phase.map_or(Class::Unknown, |phase| phase.class);
        let values = plan.settings(record.case);
        let [Some(a), Some(b)] = [0, 1].map(|at| values.get(at).and_then(|v| v.number())) else {
            continue;
        };
        if let (Some(across), Some(up)) = (cells.0.cell(a), cells.1.cell(b)) {
            let from = (across.0 / x.unit, up.0 / y.unit);
            let to = (across.1 / x.unit, up.1 / y.unit);
            tiles.push(Tile { from, to, color: palette::of_class(class) });
            if !met.contains(&class) {
                met.push(class);
            }
        }
    }
    let known = Class::ALL.into_iter().filter(|class| met.contains(class));
    let legend = known.map(|class| Entry::Tile {
        color: palette::of_class(class),
        label: words(class).to_owned(),
    });
    let chart = Chart::new(shown(&plan.name), x, y, (520, 440));
    let chart = Chart { tiles, legend: legend.collect(), ..chart };
    chart.with_axes(&picture.x, &picture.y).svg(picture)
}

fn words(class: Class) -> &'static str {
    match class {
        Class::Flat => "stays flat",
        Class::Buckles => "buckles",
        Class::BypassesBuckling => "bypasses buckling",
        Class::Hysteresis => "hysteresis",
        Class::Unknown => "not known",
    }
}

/// What a key is called on an axis.
fn title(key: &str) -> String {
    match key {
        "dimensionless.bending" => "bending stiffness k_{b}/(χR₀²)".to_owned(),
        "dimensionless.pressure" => "pressure P_{A}R₀/χ".to_owned(),
        "dimensionless.adhesion" => "adhesion w₀/χ".to_owned(),
        "dimensionless.film" => "film thickness δ_{A}/R₀".to_owned(),
        key => shown(key),
    }
}

/// The cells of an axis: each value's neighbourhood, halfway to the next ones.
struct Cells {
    logarithmic: bool,
    /// The values, sorted, in the units of the axis.
    values: Vec<f64>,
}

impl Cells {
    fn of(axis: &sweep::Axis) -> Self {
        let numbers: Vec<f64> = axis.values.iter().filter_map(sweep::Setting::number).collect();
        let positive = numbers.iter().all(|value| *value > 0.0);
        let wide = numbers.iter().copied().fold(0.0, f64::max)
            >= 50.0 * numbers.iter().copied().fold(f64::INFINITY, f64::min);
        // a list may be meant so too
        let logarithmic = positive && (axis.logarithmic || wide);
        let mut values = numbers;
        if logarithmic {
            values.iter_mut().for_each(|value| *value = value.log10());
        }
        values.sort_by(f64::total_cmp);
        values.dedup();
        Cells { logarithmic, values }
    }

    /// The boundary before the cell at a place, and after it.
    fn bounds(&self, at: usize) -> (f64, f64) {
        let here = self.values[at];
        let below = at.checked_sub(1).map(|i| self.values[i]);
        let above = self.values.get(at + 1).copied();
        let alone = if here == 0.0 { 0.5 } else { 0.1 * here.abs() };
        let down = below.map_or(above.map_or(alone, |a| 0.5 * (a - here)), |b| 0.5 * (here - b));
        let up = above.map_or(below.map_or(alone, |b| 0.5 * (here - b)), |a| 0.5 * (a - here));
        (here - down, here + up)
    }

    /// The cell of a value.
    fn cell(&self, value: f64) -> Option<(f64, f64)> {
        let value = if self.logarithmic { value.log10() } else { value };
        let at = self.values.iter().position(|own| *own == value)?;
        Some(self.bounds(at))
    }

    fn axis(&self, key: &str) -> Axis {
        let last = self.values.len().saturating_sub(1);
        let (low, high) = (self.bounds(0).0, self.bounds(last).1);
        if self.logarithmic {
            Axis::of_logarithms(&title(key), low, high)
        } else {
            Axis::exactly(&title(key), low, high, 7)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use study::record::phase::Phase;
    use study::record::{CaseRecord, Status};
    use study::sweep::{Plan, Setting, Shard};

    fn axis(key: &str, values: &[f64], logarithmic: bool) -> sweep::Axis {
        let values = values.iter().map(|value| Setting::Real(*value)).collect();
        sweep::Axis { key: key.to_owned(), logarithmic, zip: None, values }
    }

    /// A plane with these classes, in the order of the cases.
    fn result(axes: Vec<sweep::Axis>, classes: &[Class]) -> SweepResult {
        let record = |(case, class): (usize, &Class)| CaseRecord {
            status: Status::Finished,
            phase: Some(Phase {
                class: *class,
                folds: 0,
                pole_film: None,
                stiffness: None,
                softening: None,
                knee: None,
            }),
            ..CaseRecord::failed(case, String::new())
        };
        let plan = Plan {
            version: String::new(),
            name: "a < b".to_owned(),
            shard: Shard::ALL,
            parameter: "z0".to_owned(),
            axes,
            base: Vec::new(),
        };
        let records: Vec<CaseRecord> = classes.iter().enumerate().map(record).collect();
        SweepResult { plan, asked: records.len(), records, interrupted: false }
    }

    #[test]
    fn cells_meet_halfway_in_the_logarithm_and_cover_the_axis() {
        let cells = Cells::of(&axis("k", &[1e-2, 1e-4, 1e-3], true));
        assert_eq!(cells.cell(1e-3), Some((-3.5, -2.5)));
        assert_eq!(cells.cell(1e-2), Some((-2.5, -1.5)));
        assert_eq!(cells.cell(0.5), None);
        let axis_of = cells.axis("k");
        assert_eq!(
            (axis_of.low, axis_of.high, axis_of.ticks.as_slice()),
            (-4.5, -1.5, &[-4.0, -3.0, -2.0][..])
        );
        assert_eq!(axis_of.label(-3.0), "10⁻³");
        let linear = Cells::of(&axis("k", &[0.0, 1.0, 3.0], false));
        assert_eq!(linear.cell(1.0), Some((0.5, 2.0)));
        assert_eq!(linear.cell(0.0), Some((-0.5, 0.5)));
        let alone = Cells::of(&axis("k", &[2.0], false));
        assert_eq!(alone.cell(2.0), Some((1.8, 2.2)));
    }

    #[test]
    fn every_class_that_is_met_has_its_colour_and_its_word() {
        let axes = vec![
            axis("dimensionless.bending", &[1e-4, 1e-3], true),
            axis("path.end", &[0.7, 0.8], false),
        ];
        let classes = [Class::Flat, Class::Buckles, Class::Hysteresis, Class::Buckles];
        let svg = draw_phase(&result(axes.clone(), &classes), &PictureCase::default()).unwrap();
        for part in
            ["stays flat", "buckles", "hysteresis", "bending stiffness", "path.end", "a &lt; b"]
        {
            assert!(svg.contains(part), "{part}");
        }
        assert!(!svg.contains("bypasses"));
        // vermillion: one tile and its sample
        assert_eq!(svg.matches("#d55e00").count(), 2);
        let error = draw_phase(&result(axes[..1].to_vec(), &classes[..2]), &PictureCase::default())
            .unwrap_err();
        assert!(error.to_string().contains("does not vary two keys"));
    }
}
