//! Special points: what they are and what their normal forms say.

use serde::{Deserialize, Serialize};
use std::fmt;

/// What kind of special point an event is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum EventKind {
    /// The parameter turns back (limit point).
    Fold,
    /// Another branch crosses.
    BranchPoint,
    /// A pair of complex eigenvalues crosses the imaginary axis.
    Hopf,
    /// A real eigenvalue passes infinity: the equations without a derivative can no longer be solved for
    /// their unknowns (singularity-induced bifurcation).
    SingularityInduced,
    /// A mode becomes unstable, or stable, where the Jacobian is regular
    /// ([`crate::Stability::SeparateHessian`]).
    StabilityChange,
    /// Two folds meet and vanish: the quadratic coefficient of a fold is zero.
    Cusp,
    /// A double eigenvalue zero with one eigenvector: a fold and a Hopf point meet.
    BogdanovTakens,
    /// A fold at which a pair of eigenvalues crosses the imaginary axis.
    ZeroHopf,
    /// A Hopf point whose first Lyapunov coefficient is zero.
    GeneralisedHopf,
    /// A Hopf point at which a second pair of eigenvalues crosses the imaginary axis.
    DoubleHopf,
    /// A Floquet multiplier of a cycle is −1: cycles of twice the period are born ([`crate::cycles`]).
    PeriodDoubling,
    /// A pair of complex Floquet multipliers of a cycle lies on the unit circle: a torus is born.
    NeimarkSacker,
    /// A zero of the named observable.
    Zero(String),
    /// A local minimum of the named observable along the branch.
    Minimum(String),
    /// A local maximum of the named observable along the branch.
    Maximum(String),
    /// The parameter takes a value asked for by [`crate::Watch::parameter`]. The end of the trace at
    /// [`crate::Settings::target`] is no event.
    Target,
    /// An observable takes a value other than zero ([`crate::Watch::Value`]): its name and `-value`;
    /// or a kind that an application has given a name of its own.
    Named(String),
}

impl fmt::Display for EventKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            EventKind::Fold => write!(f, "fold"),
            EventKind::BranchPoint => write!(f, "branch-point"),
            EventKind::Hopf => write!(f, "hopf"),
            EventKind::SingularityInduced => write!(f, "singularity-induced"),
            EventKind::StabilityChange => write!(f, "stability-change"),
            EventKind::Cusp => write!(f, "cusp"),
            EventKind::BogdanovTakens => write!(f, "bogdanov-takens"),
            EventKind::ZeroHopf => write!(f, "zero-hopf"),
            EventKind::GeneralisedHopf => write!(f, "generalised-hopf"),
            EventKind::DoubleHopf => write!(f, "double-hopf"),
            EventKind::PeriodDoubling => write!(f, "period-doubling"),
            EventKind::NeimarkSacker => write!(f, "neimark-sacker"),
            EventKind::Zero(name) => write!(f, "zero-{name}"),
            EventKind::Minimum(name) => write!(f, "{name}-minimum"),
            EventKind::Maximum(name) => write!(f, "{name}-maximum"),
            EventKind::Target => write!(f, "target"),
            EventKind::Named(name) => write!(f, "{name}"),
        }
    }
}

/// A located special point; its state is the [`crate::Point`] at `point`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// What it is.
    pub kind: EventKind,
    /// Index of its state in [`crate::Branch::points`].
    pub point: usize,
    /// Value of the continued parameter there.
    pub p: f64,
    /// Number of unstable modes before, along the branch; `None` as in [`crate::Point::unstable`].
    pub unstable_before: Option<usize>,
    /// Number of unstable modes after, along the branch.
    pub unstable_after: Option<usize>,
    /// Largest component of the residual at the located point, in the unit of `f`.
    pub residual: f64,
    /// Estimated error of the location, as a length in the problem's metric.
    pub error_estimate: f64,
    /// What the normal form says.
    #[serde(default)]
    pub detail: Detail,
    /// The critical eigenvector of a fold or Hopf point, where it was computed. Those of a branch
    /// point lie in its tangents: [`Event::critical_modes`] has them all.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub eigenvectors: Vec<Eigenvector>,
}

/// An eigenvector of `f_u` (of `f_u − λ M` with a mass matrix) to a critical eigenvalue `λ`, 0 or
/// `iω`; of Euclidean length 1.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Eigenvector {
    /// The real part, of length [`crate::Problem::dim`].
    pub re: Vec<f64>,
    /// The imaginary part; empty where the eigenvalue is zero.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub im: Vec<f64>,
}

impl Eigenvector {
    /// A real vector made one of length 1; `None` if it has none.
    pub(crate) fn real(mut re: Vec<f64>) -> Option<Self> {
        let length = re.iter().map(|x| x * x).sum::<f64>().sqrt();
        re.iter_mut().for_each(|x| *x /= length);
        re.iter().all(|x| x.is_finite()).then(|| Eigenvector { re, im: Vec::new() })
    }
}

/// What is shorter than this, beside the vectors that it was made from, is rounding.
const ROUNDING: f64 = 1e-6;

impl Event {
    /// The branches that meet at a branch point.
    pub fn crossing(&self) -> Option<&Crossing> {
        match &self.detail {
            Detail::Crossing(crossing) => Some(crossing),
            _ => None,
        }
    }

    /// The critical eigenvectors, as far as they are known: the null vector of a fold, the complex
    /// eigenvector of a Hopf point, and of a branch point those null vectors of `f_u`, orthonormal,
    /// that lie in the span of its tangents.
    pub fn critical_modes(&self) -> Vec<Eigenvector> {
        match &self.detail {
            Detail::Crossing(crossing) if self.eigenvectors.is_empty() => crossing.null_vectors(),
            _ => self.eigenvectors.clone(),
        }
    }

    /// The normal form of a period doubling.
    pub fn doubling(&self) -> Option<&DoublingForm> {
        match &self.detail {
            Detail::Doubling(doubling) => Some(doubling),
            _ => None,
        }
    }

    /// The normal form of a Hopf point.
    pub fn hopf(&self) -> Option<&HopfForm> {
        match &self.detail {
            Detail::Hopf(hopf) => Some(hopf),
            _ => None,
        }
    }
}

/// What the normal form says of a special point.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Detail {
    /// Nothing: a user event, or a form that could not be computed.
    #[default]
    None,
    /// Of a fold.
    Fold(FoldForm),
    /// Of a branch point.
    Crossing(Crossing),
    /// Of a Hopf point.
    Hopf(HopfForm),
    /// Of a period doubling.
    Doubling(DoublingForm),
}

/// A fold: `p - p₀ = ½ p″ s² + …`, or `c s⁴ + …` and so on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FoldForm {
    /// `d²p/ds²` in the problem's metric; positive where the parameter has a minimum.
    pub curvature: f64,
    /// Estimated error of it: as large as the values found where differences do not converge.
    #[serde(default)]
    pub curvature_error: f64,
    /// The power of `s` with which the parameter turns: 2, or for a flat fold, whose curvature is 0, an
    /// even number above. `None` where it is not known.
    #[serde(default)]
    pub order: Option<usize>,
}

/// How branches cross.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Shape {
    /// Two branches cross, both at an angle to the parameter's zero.
    Transcritical,
    /// One branch is vertical there: its two halves lie on the same side of the parameter.
    Pitchfork,
    /// The kernel has more than one dimension: several branches.
    Multiple,
    /// The reduced equations are degenerate to the order computed.
    Degenerate,
}

/// On which side the new solutions are, seen from the exchange of stability.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Criticality {
    /// The new solutions exist where the old one is unstable in the critical mode: soft loss of
    /// stability.
    Supercritical,
    /// They exist where the old one is stable in the critical mode: hard loss of stability.
    Subcritical,
}

/// A branch point: which branches meet there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Crossing {
    /// How they cross.
    pub shape: Shape,
    /// Of a pitchfork, where the problem says what stability means and the cubic coefficient is
    /// not zero.
    pub criticality: Option<Criticality>,
    /// Whether the branch that was traced is the pitchfork's own, met at its vertical tangent.
    pub from_side: bool,
    /// Dimension of the Jacobian's kernel.
    pub multiplicity: usize,
    /// `d²p/dx²` along the vertical branch of a pitchfork, `x` its arclength in the problem's
    /// metric; 0 otherwise.
    pub curvature: f64,
    /// Estimated error of it: as large as the values found where differences do not converge. A
    /// criticality is only claimed beyond it.
    #[serde(default)]
    pub curvature_error: f64,
    /// Tangent of the branch that was traced.
    pub traced: Direction,
    /// Tangents of the branches that leave, other than the one that was traced; each can be
    /// followed both ways.
    pub leaving: Vec<Direction>,
}

impl Crossing {
    /// Null vectors of `f_u`: what the tangents say about directions in which the parameter stays.
    fn null_vectors(&self) -> Vec<Eigenvector> {
        let tangents: Vec<&Direction> =
            std::iter::once(&self.traced).chain(&self.leaving).collect();
        // all but the steepest lose their share of the parameter to it
        let steepest = tangents.iter().max_by(|a, b| a.dp.abs().total_cmp(&b.dp.abs()));
        let Some(steepest) = steepest.filter(|tangent| tangent.dp != 0.0) else {
            return orthonormal(tangents.iter().map(|tangent| tangent.du.clone()));
        };
        let level = tangents.iter().filter(|tangent| !std::ptr::eq(**tangent, *steepest));
        orthonormal(level.map(|tangent| {
            let share = tangent.dp / steepest.dp;
            tangent.du.iter().zip(&steepest.du).map(|(a, b)| a - share * b).collect()
        }))
    }
}

/// An orthonormal basis of what the vectors span.
fn orthonormal(vectors: impl Iterator<Item = Vec<f64>>) -> Vec<Eigenvector> {
    let mut basis: Vec<Eigenvector> = Vec::new();
    let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    for mut vector in vectors {
        let before = length(&vector);
        for done in &basis {
            let along: f64 = done.re.iter().zip(&vector).map(|(a, b)| a * b).sum();
            vector.iter_mut().zip(&done.re).for_each(|(x, y)| *x -= along * y);
        }
        if length(&vector) > ROUNDING * before {
            basis.extend(Eigenvector::real(vector));
        }
    }
    basis
}

/// A tangent at a branch point, of unit length in the problem's metric: `du·M du + dp² = 1`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Direction {
    /// The unknowns' part, of length [`crate::Problem::dim`].
    pub du: Vec<f64>,
    /// The parameter's part; exactly 0 for a vertical branch.
    pub dp: f64,
    /// Where `dp` is 0: `p - p₀ ≈ bend x²`, `x` the multiple of the direction.
    pub bend: f64,
    /// Multiple of the direction at which the nonlinearity matters over the parameter's range.
    pub amplitude: f64,
    /// A state of the branch, where nearer ones do not tell it from its neighbours: at a double
    /// branch point with the symmetry of a polygon.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub offset: Option<Offset>,
}

/// A state of a branch that leaves a branch point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Offset {
    /// The multiple of the direction.
    pub multiple: f64,
    /// The unknowns there, less those of the branch point.
    pub du: Vec<f64>,
}

/// A period doubling: `p - p₀ = ½ p″ x² + …` along the doubled cycles, `x` their part along the critical
/// mode, of length 1 in the metric of [`CycleProblem`](crate::cycles::CycleProblem).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DoublingForm {
    /// `d²p/dx²`.
    pub curvature: f64,
    /// Estimated error of it.
    pub curvature_error: f64,
    /// Supercritical where the doubled cycles exist on the side of the parameter on which the single
    /// ones are unstable in the critical mode. `None` where the curvature is not told from 0, the counts
    /// of unstable multipliers on both sides are not certain, or the parameter turns there.
    pub criticality: Option<Criticality>,
}

/// A Hopf point: periodic solutions are born.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HopfForm {
    /// The imaginary part of the critical eigenvalues, positive: an angular frequency.
    pub frequency: f64,
    /// First Lyapunov coefficient `l₁` (Kuznetsov, *Elements of Applied Bifurcation Theory*, Eq.
    /// 10.35), with the eigenvector of Euclidean length 1: negative is supercritical.
    pub lyapunov: f64,
    /// Estimated error of it.
    pub lyapunov_error: f64,
    /// By its sign, where it exceeds its error.
    pub criticality: Option<Criticality>,
}
