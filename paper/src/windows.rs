//! The stretches of a branch on which modes of one kind are unstable.

use super::curve::Traced;
use super::manifest::{Abscissa, PanelSpec};
use pictures::{Ink, Panel, PanelLine, Pen};
use shell_contact::modes::{Parity, Scanned};
use study::record::view::Curve;

/// How far from its number of waves a line is drawn, so that the two parities lie side by side.
const ASIDE: f64 = 0.12;

/// A stretch of a branch, in order along it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Window {
    /// Waves around the axis.
    pub(super) n: usize,
    /// Under reflection about the equator.
    pub(super) parity: Parity,
    /// Plate distances.
    pub(super) z0: Vec<f64>,
    /// Whether the branch itself counts unstable modes there.
    unstable: Vec<bool>,
    /// Whether it begins and ends where stability changes, not where the branch ends.
    pub(super) bounded: [bool; 2],
}

/// The windows of a branch whose stability was scanned, by `n` and parity, its own last.
pub(super) fn windows(traced: &Traced) -> Vec<Window> {
    let Some(scanned) = &traced.scanned else { return Vec::new() };
    let waves = scanned.events.iter().map(|event| event.n).max().unwrap_or(0);
    let mut windows = Vec::new();
    for n in 0..=waves {
        for parity in [Parity::Antisymmetric, Parity::Symmetric] {
            if n > 0 || parity == Parity::Antisymmetric {
                windows.extend(of_class(traced, scanned, n, parity));
            }
        }
    }
    windows.extend(own(traced));
    windows
}

fn new(n: usize, parity: Parity, bounded: bool) -> Window {
    Window { n, parity, z0: Vec::new(), unstable: Vec::new(), bounded: [bounded, false] }
}

/// Where the branch itself counts unstable modes: from one fold to the next.
fn own(traced: &Traced) -> Vec<Window> {
    let points = &traced.branch.branch.points;
    let unstable = |k: usize| points.get(k).is_some_and(|q| q.unstable.is_some_and(|n| n > 0));
    let mut found: Vec<Window> = Vec::new();
    for k in (0..points.len()).filter(|k| unstable(*k)) {
        if k == 0 || !unstable(k - 1) {
            found.push(new(0, Parity::Symmetric, k > 0));
            // the special point itself counts as one side or the other
            if let Some(fold) = k.checked_sub(1).filter(|at| points[*at].event.is_some()) {
                push(&mut found, points[fold].p, true);
            }
        }
        push(&mut found, points[k].p, true);
        if !unstable(k + 1)
            && let (Some(next), Some(window)) = (points.get(k + 1), found.last_mut())
        {
            window.bounded[1] = true;
            if points[k].event.is_none() && next.event.is_some() {
                push(&mut found, next.p, true);
            }
        }
    }
    found
}

/// Windows of one class of modes without the branch's symmetries.
fn of_class(traced: &Traced, scanned: &Scanned, n: usize, parity: Parity) -> Vec<Window> {
    let points = &traced.branch.branch.points;
    let count = |k: usize| match n {
        0 => scanned.points[k].antisymmetric,
        n => scanned.points[k].count(n, parity).map_or(0, |count| count.negative),
    };
    let mut found: Vec<Window> = Vec::new();
    let mut inside = false;
    for (k, point) in points.iter().enumerate().take(scanned.points.len()) {
        let unstable = point.unstable.is_some_and(|n| n > 0);
        if k == 0 && count(0) > 0 {
            inside = true;
            found.push(new(n, parity, false));
        }
        if inside {
            push(&mut found, point.p, unstable);
        }
        let here = scanned.events.iter().filter(|event| event.after_point == k);
        for event in here.filter(|event| (event.n, event.parity) == (n, Some(parity))) {
            let now = event.modes_after > 0;
            if now && !inside {
                found.push(new(n, parity, true));
            }
            if now || inside {
                push(&mut found, event.z0, unstable);
            }
            if let Some(window) = found.last_mut().filter(|_| inside && !now) {
                window.bounded[1] = true;
            }
            inside = now;
        }
    }
    found
}

fn push(windows: &mut [Window], z0: f64, unstable: bool) {
    if let Some(window) = windows.last_mut() {
        window.z0.push(z0);
        window.unstable.push(unstable);
    }
}

/// Windows as lines over the panel's axis, one row for each number of waves.
pub(super) fn panel(spec: &PanelSpec, curves: &[(usize, &Traced)], x: String) -> Panel {
    let mut lines = Vec::new();
    let mut waves = 0;
    for (traced, window) in
        curves.iter().flat_map(|(_, t)| windows(t).into_iter().map(move |w| (t, w)))
    {
        waves = waves.max(window.n);
        let (place, aside) = match window.parity {
            Parity::Symmetric => (1, ASIDE),
            Parity::Antisymmetric => (2, -ASIDE),
        };
        lines.push(PanelLine {
            label: window.parity.name().to_owned(),
            ink: Ink::Place(place),
            pen: Pen::Data,
            right: false,
            curve: Curve {
                x: window.z0.iter().map(|z0| traced.abscissa(spec.x, *z0)).collect(),
                y: vec![window.n as f64 + aside; window.z0.len()],
                unstable: window.unstable,
                ..Curve::default()
            },
        });
    }
    // the whole branch, not only where something is unstable
    let ends = curves.iter().flat_map(|(_, t)| {
        t.branch.branch.points.iter().map(|q| t.abscissa(spec.x, q.p)).filter(|x| x.is_finite())
    });
    let low = ends.clone().fold(f64::INFINITY, f64::min);
    let high = ends.fold(f64::NEG_INFINITY, f64::max);
    Panel {
        x,
        y: "waves around the axis n".to_owned(),
        lines,
        x_range: (low < high).then_some([low, high]),
        y_range: Some([-0.7, waves.max(4) as f64 + 0.7]),
        dashed: Some("between folds"),
        ..Panel::default()
    }
}

/// One row per window of the figure's branches.
///
/// # Errors
/// What the writer reports; memory does not fail, so none is expected.
pub(super) fn csv(traced: &[Traced]) -> Result<Vec<u8>, csv::Error> {
    let mut out = csv::Writer::from_writer(Vec::new());
    out.write_record([
        "curve",
        "n",
        "parity",
        "z0_from",
        "z0_to",
        "deformation_from",
        "deformation_to",
        "from",
        "to",
    ])?;
    for (traced, window) in traced.iter().flat_map(|t| windows(t).into_iter().map(move |w| (t, w)))
    {
        let [Some(from), Some(to)] = [window.z0.first(), window.z0.last()] else { continue };
        let deformation = |z0: f64| traced.abscissa(Abscissa::Deformation, z0);
        let word = |bounded: bool| if bounded { "onset" } else { "end of branch" };
        out.write_record([
            traced.name.as_str(),
            &window.n.to_string(),
            window.parity.name(),
            &from.to_string(),
            &to.to_string(),
            &deformation(*from).to_string(),
            &deformation(*to).to_string(),
            word(window.bounded[0]),
            word(window.bounded[1]),
        ])?;
    }
    out.into_inner().map_err(|error| csv::Error::from(error.into_error()))
}
