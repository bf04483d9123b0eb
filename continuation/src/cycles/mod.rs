//! Periodic orbits of `M du/dt = f(u, p)` along a parameter: limit points, period doublings, tori.
//!
//! A cycle `u(t) = u(t + T)` is a solution of a boundary value problem on the unit interval, with the
//! period as a further unknown and a condition that fixes the phase (Doedel, Keller & Kernévez 1991):
//! ```text
//! M u′(τ) − T f(u(τ), p) = 0,   u(1) = u(0),   ∫₀¹ u·M_s ũ′ dτ = 0
//! ```
//! `ũ` is the cycle at which the mesh was adapted last, `M_s` the problem's metric. It is discretised by
//! orthogonal collocation (Ascher, Mattheij & Russell 1995): on each of `N` intervals `u` is a polynomial of
//! degree `m`, 2 to 7, continuous at the mesh points, that satisfies the equations at the `m` Gauss points.
//! The error is `O(h^{m+1})` everywhere and `O(h^{2m})` at the mesh points and for `T`. [`CycleProblem`] is
//! these equations as a [`Problem`](crate::Problem); any problem whose
//! [`stability`](crate::Problem::stability) is [`Dynamics`](crate::Stability::Dynamics) serves, with a mass
//! matrix of full rank or none.
//!
//! The Jacobian, a [`CycleMatrix`], condenses the unknowns inside the intervals and then eliminates the mesh
//! points one after the other with row exchanges between neighbours (Wright 1992): `O(N (n m)³)` operations
//! and no product of matrices around the cycle. What remains has the size `n + 1`.
//!
//! [`trace()`] follows a branch with the [`Tracer`](crate::Tracer) of equilibria. After a few points the mesh
//! is adapted: the intervals are distributed so that the derivative of order `m + 1` makes the same error
//! on each (de Boor 1973), their number follows the accuracy asked for, and the trace goes on across its
//! tangent. Cycles start from a Hopf point ([`SmallCycle::at_hopf`]), from a guess ([`Cycle::near`]) or from
//! a time series ([`Cycle::from_series`]).
//!
//! ```
//! use continuation::cycles::{CycleSettings, SmallCycle, trace};
//! use continuation::{DenseProblem, EventKind, Settings, Stability, Tracer};
//! use std::ops::ControlFlow;
//!
//! // the Brusselator: cycles are born at B = 2
//! let problem = DenseProblem::from_residual(2, &["B"], |u, p, r| {
//!     r[0] = 1.0 - (p[0] + 1.0) * u[0] + u[0] * u[0] * u[1];
//!     r[1] = p[0] * u[0] - u[0] * u[0] * u[1];
//! })
//! .with_stability(Stability::Dynamics);
//! let settings = Settings { target: Some(3.0), ..Settings::default() };
//! let equilibria = Tracer::new(&problem, "B", &[1.0, 1.0], &[1.0], settings.clone())?.run_quietly();
//! let hopf = equilibria.events_of(&EventKind::Hopf).next().unwrap();
//! let cycles = CycleSettings::default();
//! let small = SmallCycle::at_hopf(&problem, &equilibria, hopf, &cycles)?;
//! let branch = trace(&problem, "B", &small.cycle, &settings, &cycles, &[], &mut |_| {
//!     ControlFlow::Continue(())
//! })?;
//! let last = branch.cycles.last().unwrap();
//! assert!((last.cycle.period - 7.156_919_9).abs() < 1e-6);
//! assert_eq!((last.unstable, last.certified), (Some(0), true));
//! let highest = branch.branch.column("max_u[0]").unwrap();
//! assert!(highest.windows(2).all(|pair| pair[0] < pair[1]));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Multipliers
//! The condensed blocks give the matrices `G_j` that lead from one mesh point to the next. Floquet
//! multipliers are the eigenvalues of `G_{N−1} … G_0`, which is never formed (Fairgrieve & Jepson 1991 say
//! what is lost otherwise): orthogonal iteration around the cycle brings all `G_j` to triangular form at once,
//! a periodic Schur form up to blocks of multipliers of nearly the same modulus (Lust 2001). Small and large
//! multipliers keep their relative accuracy and are given by their logarithms ([`Multiplier`]).
//!
//! One multiplier is 1. How far the computed one is from it is reported
//! ([`CyclePoint::trivial_error`]), and is part of the error of all others; the other part is by how much
//! each changes when all intervals are halved and the cycle is solved again, one and a half times.
//! Between two such points on one mesh whose errors agree, errors are twice the larger ones. A count of
//! unstable multipliers is [certified](CyclePoint::certified) where the trivial one is identified and no other is
//! within twice its error of the unit circle. These errors are estimates, not bounds that were proven.
//! Where the trivial multiplier is off by more than 0.05 the mesh does not resolve the orbit, and no error is given.
//!
//! # Special points
//! Limit points ([`Fold`](crate::EventKind::Fold)) and branch points of cycles are those of the
//! collocation equations, met by the same methods as on branches of equilibria. Period doublings and
//! Neimark-Sacker points are zeros of `Π(1 + μ)` and `Π(μ_i μ_j − 1)`, scaled to order one, along the branch;
//! where two real multipliers have the product 1 nothing happens, and nothing is reported.
//! [`SmallCycle::at_doubling`] leads to the cycles of twice the period, [`SmallCycle::at_branch_point`] to a
//! branch that crosses. The error of a special point contains that of the discretisation: where the point
//! lies when all intervals are halved ([`CycleBranch::event_errors`]).
//!
//! Near a period doubling the parameter of the doubled cycles is `p₀ + ½ p″ x²`, `x` their amplitude:
//! [`DoublingForm`](crate::DoublingForm) has `p″` with its error, and calls the point super- or subcritical where
//! the sign is beyond it and the counts on both sides are certain.
//!
//! [`curve()`] follows limit points and period doublings in two parameters.
//!
//! [`explore()`] follows all cycles that leave the Hopf points of a list of branches, each once, and says what is open.
//!
//! A branch ends with [`PeriodUnbounded`](crate::StopReason::PeriodUnbounded) where the period grows while the
//! parameter comes to rest, and with [`CyclesVanish`](crate::StopReason::CyclesVanish) where the cycles shrink to
//! an equilibrium, and with [`PeriodHalved`](crate::StopReason::PeriodHalved) where doubled cycles come back to single
//! ones.
//!
//! # Limits
//! Mass matrices of full rank; `n m` at most [`MAX_BLOCK`]: blocks are dense whatever the storage of the
//! problem's Jacobian. Extrema are those of the polynomials, with the error `O(h^{m+1})`. Gauss collocation
//! damps no fast mode on steps that are long for it: multipliers of very stiff directions come out too large,
//! which their errors show. Within a canard explosion the parameter is the same to rounding, and its turns are not
//! found. Near the unit multiplier of a fold, and at a branch point, two multipliers are
//! close to 1 and neither is known better than the square root of rounding; counts are uncertain there. Whether
//! a torus is super- or subcritical is not said, and curves of tori are not followed; on curves of other special cycles
//! cusps alone are told, resonances are not. An approach to a homoclinic orbit is told by the period alone.
//!
//! # References
//! - U. M. Ascher, R. M. M. Mattheij and R. D. Russell, *Numerical Solution of Boundary Value Problems for
//!   Ordinary Differential Equations*, SIAM, 1995.
//! - E. J. Doedel, H. B. Keller and J. P. Kernévez, Numerical analysis and control of bifurcation problems (II),
//!   *Int. J. Bifurcation and Chaos* 1 (1991) 745-772.
//! - C. de Boor, Good approximation by splines with variable knots II, in *Lecture Notes in Mathematics* 363,
//!   Springer, 1973.
//! - T. F. Fairgrieve and A. D. Jepson, O.K. Floquet multipliers, *SIAM J. Numer. Anal.* 28 (1991) 1446-1462.
//! - K. Lust, Improved numerical Floquet multipliers, *Int. J. Bifurcation and Chaos* 11 (2001) 2389-2410.
//! - S. J. Wright, Stable parallel algorithms for two-point boundary value problems, *SIAM J. Sci. Stat. Comput.*
//!   13 (1992) 742-764.

mod basis;
mod between;
mod birth;
mod block;
mod collocation;
mod curve;
mod cycle;
mod cyclic;
mod doubling;
mod ends;
mod explore;
mod finer;
mod floquet;
mod functions;
mod interval;
mod matrix;
mod mesh;
mod observed;
mod point;
mod settings;
mod trace;

pub use birth::SmallCycle;
pub use collocation::{CycleProblem, MAX_BLOCK};
pub use curve::{CycleCurve, CycleCurvePoint, SpecialCycles, curve};
pub use cycle::{Cycle, CycleError};
pub use explore::{CycleOrigin, Explored, Follow, FollowedCycles, explore};
pub use floquet::Multiplier;
pub use matrix::CycleMatrix;
pub use point::CyclePoint;
pub use settings::CycleSettings;
pub use trace::{CycleBranch, trace};
