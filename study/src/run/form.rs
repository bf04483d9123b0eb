//! What a special point's normal form says, and what is known of the stability of a point, in the
//! words of the output files.

use crate::record::{Cell, FormRecord};
use continuation::{Branch, Criticality, Detail, Event, Point, Shape};

/// The normal form of a special point.
pub(super) fn form(branch: &Branch, event: &Event) -> FormRecord {
    let word = |criticality: Option<Criticality>| {
        criticality.map(|c| match c {
            Criticality::Supercritical => "supercritical",
            Criticality::Subcritical => "subcritical",
        })
    };
    let certified = branch.points.get(event.point).map(|point| point.certified);
    let unstable = event.unstable_before.is_some();
    let base = FormRecord { certified: certified.filter(|_| unstable), ..FormRecord::default() };
    match &event.detail {
        Detail::Fold(fold) => {
            let order = fold.order.filter(|order| *order > 2);
            FormRecord { curvature: Some(fold.curvature), order, ..base }
        }
        Detail::Crossing(crossing) => FormRecord {
            kind: Some(match crossing.shape {
                Shape::Transcritical => "transcritical",
                Shape::Pitchfork => "pitchfork",
                Shape::Multiple => "multiple",
                _ => "degenerate",
            }),
            criticality: word(crossing.criticality),
            multiplicity: Some(crossing.multiplicity),
            branches: Some(crossing.leaving.len()),
            curvature: (crossing.shape == Shape::Pitchfork
                && !crossing.curvature_error.is_infinite())
            .then_some(crossing.curvature),
            ..base
        },
        Detail::Hopf(hopf) => FormRecord {
            kind: word(hopf.criticality),
            criticality: word(hopf.criticality),
            frequency: Some(hopf.frequency),
            lyapunov: Some(hopf.lyapunov),
            lyapunov_error: Some(hopf.lyapunov_error),
            ..base
        },
        Detail::Doubling(doubling) => FormRecord {
            kind: word(doubling.criticality),
            criticality: word(doubling.criticality),
            curvature: Some(doubling.curvature),
            ..base
        },
        _ => base,
    }
}

/// Whether all numbers of unstable modes are certain and their changes explained; `None` where there
/// are none.
pub(super) fn certified(branch: &Branch) -> Option<bool> {
    branch.points.iter().any(|p| p.unstable.is_some()).then(|| branch.is_certain())
}

/// The columns that tell the stability of a point in more detail: whether the count is certain,
/// where not all are, and the eigenvalues that were asked for.
pub(super) struct StabilityColumns {
    certified: bool,
    complex: bool,
    count: usize,
}

impl StabilityColumns {
    pub(super) fn of(branch: &Branch) -> Self {
        let values = branch.points.iter().map(|p| &p.eigenvalues);
        StabilityColumns {
            certified: branch.points.iter().any(|p| p.unstable.is_some() && !p.certified),
            complex: values.clone().flatten().any(|(_, im)| *im != 0.0),
            count: values.map(Vec::len).max().unwrap_or(0),
        }
    }

    pub(super) fn titles(&self) -> Vec<String> {
        let mut titles = Vec::new();
        if self.certified {
            titles.push("certified".to_owned());
        }
        for k in 1..=self.count {
            titles.push(format!("eigenvalue_{k}"));
            if self.complex {
                titles.push(format!("eigenvalue_{k}_imaginary"));
            }
        }
        titles
    }

    pub(super) fn cells(&self, point: &Point) -> Vec<Cell> {
        let mut cells = Vec::new();
        if self.certified {
            cells.push(match point.unstable {
                Some(_) => if point.certified { "yes" } else { "no" }.into(),
                None => Cell::Empty,
            });
        }
        for (re, im) in &point.eigenvalues {
            cells.push((*re).into());
            if self.complex {
                cells.push((*im).into());
            }
        }
        cells
    }
}
