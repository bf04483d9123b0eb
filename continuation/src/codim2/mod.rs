//! Curves of special points in two parameters: what becomes of a fold, a Hopf point or a branch
//! point of `f(u, p, q) = 0` when `q` varies too.
//!
//! Each curve is the branch of an extended [`Problem`](crate::Problem) whose unknowns are those of
//! the original one and `p`, traced in `q` by the same [`Tracer`](crate::Tracer). Singularity is
//! expressed by *minimally augmented* equations: scalars of a bordered matrix that vanish exactly
//! where the Jacobian, or `f_u − iωM`, is singular (Griewank & Reddien 1984; Govaerts 2000):
//! ```text
//! fold:          f = 0,           g = 0,            | f_u  b | |v|   |0|
//! Hopf point:    f = 0,  Re g = 0,  Im g / ω = 0,   | cᵀ   0 | |g| = |1|,   bᵀw = 1,  f_uᵀw + c g = 0
//! branch point:  f + βb = 0,  G₁ = G₂ = 0
//! ```
//! With `g' = −wᵀ(f_u)'v` for any derivative, the extended Jacobian is that of the problem with one
//! or two full rows and columns, an [`Arrow`](crate::linalg::Arrow): the original matrix is all
//! that is factored, be it dense, banded, sparse or symmetric. `(f_u)'v` comes from one central
//! difference of the Jacobian along `v`, whose products with `w` are all of `g_u`; its step adapts
//! to how well two orders agree. The borders `b`, `c` follow the null vectors, with their
//! directions kept, so that the orientation of a curve means what it does for any branch.
//!
//! A curve does not turn at the special points of codimension two that lie on it: cusps
//! (`wᵀf_uu[v, v] = 0`) and Bogdanov-Takens points (`wᵀMv = 0`) are zeros of smooth functions on a
//! fold curve, generalised Hopf points (`l₁ = 0`) on a Hopf curve, which ends at Bogdanov-Takens
//! points; zero-Hopf and double-Hopf points are where other eigenvalues cross the imaginary axis.
//! These functions are observables of the extended problem, besides `p` and the original ones.
//!
//! ```
//! use continuation::codim2::FoldCurve;
//! use continuation::{EventKind, Settings, Tracer, samples::Cusp};
//! use std::ops::ControlFlow;
//!
//! // μ + λx − x³ = 0: from one of the folds at λ = 1 through the cusp at (0, 0) to the other
//! let settings = Settings { target: Some(2.0), ..Settings::default() };
//! let branch = Tracer::new(&Cusp, "mu", &[-1.5], &[-2.0, 1.0], settings)?
//!     .run(&mut |_| ControlFlow::Continue(()));
//! let fold = branch.events_of(&EventKind::Fold).next().unwrap();
//! let settings = Settings { domain: Some((-1.0, 2.0)), ..Settings::default() };
//! let curve = FoldCurve::at(&Cusp, &branch, fold, "lambda")?
//!     .trace(&settings, &[], &mut |_| ControlFlow::Continue(()))?;
//! let mu = curve.column("mu").unwrap();
//! for (point, mu) in curve.branch.points.iter().zip(&mu) {
//!     assert!((27.0 * mu * mu - 4.0 * point.p.powi(3)).abs() < 1e-9);
//! }
//! let cusp = curve.branch.events_of(&EventKind::Cusp).next().unwrap();
//! assert!(cusp.p.abs() < 1e-9 && mu[cusp.point].abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Limits
//! Second derivatives are differences of the Jacobian: special points are located to about 1e-10
//! of the natural amplitudes, generalised Hopf points to about 1e-8, as their error estimates say.
//! Curves of Hopf points need [`Matrix::complex`](crate::Matrix::complex), and allocate that matrix
//! at every evaluation.
//!
//! # References
//! - A. Griewank and G. W. Reddien, Characterization and computation of generalized turning points,
//!   *SIAM J. Numer. Anal.* 21 (1984) 176-185.
//! - W. Govaerts, *Numerical Methods for Bifurcations of Dynamical Equilibria*, SIAM, 2000.
//! - Yu. A. Kuznetsov, *Elements of Applied Bifurcation Theory*, ch. 8 and 10.

mod branch_point;
mod differences;
mod fold;
mod hopf;
mod null;
mod pair;
mod takens;
mod trace;
mod underlying;
mod work;

pub use branch_point::BranchPointCurve;
pub use fold::FoldCurve;
pub use hopf::HopfCurve;
pub use trace::Curve;
pub use underlying::CurveError;
