#![doc = include_str!("../docs/tour.md")]

mod any_problem;
pub mod branch;
mod by_reference;
pub mod codim2;
pub mod cycles;
pub mod deflation;
mod derivative_check;
pub mod diagram;
mod differences;
#[cfg(feature = "dual")]
mod dual_problem;
mod events;
pub mod guide;
pub mod linalg;
mod modes;
mod name;
mod near;
pub mod newton;
mod pool;
pub mod problem;
mod residual_problem;
pub mod samples;
mod settings;
mod singular;
mod sound;
mod step;
mod suspect;
pub mod tracer;

pub use branch::{
    Branch, Criticality, Crossing, Detail, Direction, DoublingForm, Doubt, Eigenvector, Event,
    EventKind, FoldForm, HopfForm, Offset, Point, RestartPoint, Shape, Statistics, Stop,
    StopReason,
};
pub use derivative_check::{DerivativeCheck, check_derivatives};
#[cfg(feature = "dual")]
pub use dual_problem::{DualProblem, Number, Residual};
pub use events::Watch;
pub use linalg::{Facts, Matrix};
pub use modes::{Modes, modes};
pub use name::{Name, literals};
pub use near::{NearBifurcation, NearError, NearKind, NearSettings, near_bifurcations};
pub use newton::{NewtonError, NewtonReport, NewtonSettings, newton};
pub use problem::{EvalError, Others, ParamId, Parameter, Problem, SpecialPoints, Stability};
pub use residual_problem::{
    BandProblem, BoxedResidual, DenseProblem, ResidualProblem, SparseProblem,
};
pub use settings::{Counting, Settings, SettingsError};
pub use sound::ProblemError;
pub use step::Refusal;
pub use suspect::WrongDerivative;
pub use tracer::{Progress, TraceError, Tracer, both_ways};
