//! What a user writes: residual, Jacobian, parameter derivative, and what stability means.

use crate::branch::EventKind;
use crate::linalg::{Matrix, OutsidePattern};
use crate::name::Name;
use std::borrow::Cow;

/// A parameter of a problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name used in tables and files.
    pub name: Name,
    /// Unit, for people; empty when dimensionless.
    pub unit: Name,
    /// A typical magnitude, positive, in the parameter's unit: difference steps are relative to it,
    /// and it stands for the range of a trace that has neither target nor domain.
    pub scale: f64,
}

impl Parameter {
    /// A parameter whose name and unit are literals; [`Parameter::named`] takes strings of any kind.
    pub const fn new(name: &'static str, unit: &'static str, scale: f64) -> Self {
        Parameter { name: Cow::Borrowed(name), unit: Cow::Borrowed(unit), scale }
    }

    /// A parameter with a name and a unit that may be made as the program runs.
    ///
    /// ```
    /// use continuation::Parameter;
    ///
    /// let loads: Vec<Parameter> =
    ///     (1..=3).map(|i| Parameter::named(format!("load_{i}"), "N", 1.0)).collect();
    /// assert_eq!(loads[2].name, "load_3");
    /// ```
    pub fn named(name: impl Into<Name>, unit: impl Into<Name>, scale: f64) -> Self {
        Parameter { name: name.into(), unit: unit.into(), scale }
    }
}

/// Index of a parameter in [`Problem::parameters`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub struct ParamId(pub usize);

/// Why `f` has no value at a state. Plain data: returning it allocates nothing.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EvalError {
    /// The state lies outside the domain of the model.
    #[error("{what} (value {value:.6e} at index {at})")]
    Inadmissible {
        /// What is violated.
        what: &'static str,
        /// Where: an index whose meaning belongs to the problem (quadrature point, component).
        at: usize,
        /// The offending value.
        value: f64,
    },
    /// An evaluation gave NaN or infinity.
    #[error("not a finite number at index {at}")]
    NotFinite {
        /// Index of the offending component.
        at: usize,
    },
    /// The Jacobian holds NaN or infinity.
    #[error("row {row} of the Jacobian is not finite")]
    JacobianNotFinite {
        /// The first such row.
        row: usize,
    },
    /// The continued parameter would leave [`crate::Settings::domain`]; the problem was not asked.
    #[error("the parameter would be {value:.6e}, beyond {bound:.6e}, a bound of the domain")]
    OutsideDomain {
        /// Its value.
        value: f64,
        /// The bound.
        bound: f64,
    },
    /// The problem ends the computation: a callback failed, say, or its user lost patience. No shorter
    /// step is tried; a trace ends with [`crate::StopReason::Interrupted`] and keeps what it has. A
    /// problem that returns this once returns it at every later evaluation.
    #[error("the problem ended the computation")]
    Aborted,
    /// The assembly of a matrix wrote an entry outside its pattern.
    #[error(transparent)]
    OutsidePattern(#[from] OutsidePattern),
}

/// What the eigenvalues of the Jacobian say about stability.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stability {
    /// The Jacobian is the Hessian of an energy: negative eigenvalues are unstable.
    EnergyHessian,
    /// As [`Stability::EnergyHessian`], but the Hessian is not the Jacobian:
    /// [`Problem::energy_hessian`] gives it. A mode may become unstable where the Jacobian is regular
    /// ([`EventKind::StabilityChange`]).
    SeparateHessian,
    /// The problem is `du/dt = f(u, p)`: eigenvalues with positive real part are unstable.
    Dynamics,
    /// The problem says nothing about stability.
    None,
}

/// Equilibria `f(u, p) = 0` of a problem with `dim` unknowns and a few parameters.
///
/// Slices in, `&mut` out. `u`, `r`, `out` of [`Problem::parameter_derivative`] and the vectors of
/// [`Problem::metric`] have length [`Problem::dim`]; `p` has that of [`Problem::parameters`]. Only
/// [`Problem::new_jacobian`] should allocate. States are tried that are no solutions, some of them
/// far from one: a method that has no value there returns an error and does not panic.
///
/// A problem may be evaluated by several threads at once. Work space that is not in the matrix stands behind a
/// lock, or is made anew.
///
/// [`crate::guide::tutorial`] builds one step by step; [`crate::check_derivatives`] tests it.
pub trait Problem: Send + Sync {
    /// Storage of the Jacobian; decides the linear algebra.
    type Jacobian: Matrix;

    /// Number of unknowns, at least 1.
    fn dim(&self) -> usize;
    /// The parameters, in the order in which `p` holds their values.
    fn parameters(&self) -> &[Parameter];
    /// A Jacobian with the problem's pattern, all zero.
    fn new_jacobian(&self) -> Self::Jacobian;
    /// `r = f(u, p)`; `r` holds anything before. The unit of `f` does not matter.
    ///
    /// # Errors
    /// When `f` has no value there.
    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError>;
    /// `j = ∂f/∂u`, row `i` the derivatives of `f_i`. `j` holds the entries of an earlier call: an
    /// assembly by adding begins with [`Matrix::set_zero`].
    ///
    /// # Errors
    /// When `f` has no value there.
    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut Self::Jacobian) -> Result<(), EvalError>;
    /// `out = ∂f/∂p[which]`; `out` holds anything before. The default takes differences of
    /// [`Problem::residual`], ten of them or more, with steps that are found anew each time, near 1e-13
    /// for smooth `f`; it allocates.
    ///
    /// # Errors
    /// When `f` has no value there.
    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        crate::differences::by_parameter(self, u, p, which, out).map(|_| ())
    }

    /// `out` = a bound, by component, of the error of `∂f/∂u du + ∂f/∂p[which] dp` as this problem
    /// computes it: events say how much of it moves them. The default is zero, for derivatives that are
    /// exact to rounding.
    ///
    /// # Errors
    /// When `f` has no value there.
    fn derivative_error(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        du: &[f64],
        dp: f64,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        let _ = (u, p, which, du, dp);
        out.fill(0.0);
        Ok(())
    }

    /// Residual and Jacobian together, for problems in which they share work. Must equal both
    /// computed apart.
    ///
    /// # Errors
    /// When `f` has no value there.
    fn linearise(
        &self,
        u: &[f64],
        p: &[f64],
        r: &mut [f64],
        j: &mut Self::Jacobian,
    ) -> Result<(), EvalError> {
        self.residual(u, p, r)?;
        self.jacobian(u, p, j)
    }

    /// `y = M x`, the symmetric positive semidefinite metric in which arclength is measured:
    /// `ds² = du·M du + dp²`. A mass matrix makes a length mean the same on every mesh; multipliers
    /// may have weight zero. `M` is constant; the default is the identity.
    fn metric(&self, x: &[f64], y: &mut [f64]) {
        y.copy_from_slice(x);
    }

    /// The natural magnitude that the unknowns share with a parameter, where the problem knows it.
    ///
    /// `Some(1.0)` says that unknowns and parameter are comparable as they are (lengths in the
    /// same unit, say); `None` has the tracer weigh them by their ranges along the branch.
    fn unknown_scale(&self, which: ParamId) -> Option<f64> {
        let _ = which;
        None
    }

    /// What the Jacobian's eigenvalues mean; by default nothing, and no mode is counted as unstable.
    fn stability(&self) -> Stability {
        Stability::None
    }

    /// Writes the constant mass matrix of `M du/dt = f(u, p)` to `m`, a matrix of the Jacobian's
    /// pattern that is all zero, and returns true; false (the default) is the identity.
    ///
    /// Eigenvalues are those of `f_u x = λ M x`; for an energy Hessian without a mass matrix `M`
    /// is the metric.
    fn mass(&self, m: &mut Self::Jacobian) -> bool {
        let _ = m;
        false
    }

    /// The matrix whose negative eigenvalues are unstable where it is not the Jacobian
    /// ([`Stability::SeparateHessian`]); symmetric, and of the Jacobian's pattern. `h` holds anything
    /// before. The default is the Jacobian.
    ///
    /// # Errors
    /// When it has no value there.
    fn energy_hessian(
        &self,
        u: &[f64],
        p: &[f64],
        h: &mut Self::Jacobian,
    ) -> Result<(), EvalError> {
        self.jacobian(u, p, h)
    }

    /// Number of negative eigenvalues that multipliers add to an energy Hessian; they are no
    /// instabilities. One for each constraint whose multiplier is among the unknowns.
    fn multipliers(&self) -> usize {
        0
    }

    /// How branches are read whose points are special points of another problem
    /// ([`crate::codim2`]); `None` (the default) where they are equilibria.
    fn special_points(&self) -> Option<&dyn SpecialPoints> {
        None
    }

    /// Names of the scalar functions of a state that are reported at every point and on which
    /// events can be placed ([`crate::Watch`]).
    fn observables(&self) -> &[Name] {
        &[]
    }

    /// `out[k]` = observable `k` at `(u, p)`, in the order of [`Problem::observables`]. Finite values
    /// only, where the branch is to be saved in a format without NaN.
    ///
    /// # Errors
    /// When an observable has no value there.
    fn observe(&self, u: &[f64], p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        let _ = (u, p, out);
        Ok(())
    }

    /// Derivative of observable `k` at `(u, p)` in the direction `(du, dp)` of `(u, p[which])`; `None`
    /// (the default) has the library take a central difference of [`Problem::observe`].
    ///
    /// # Errors
    /// When the observable has no value there.
    fn observable_slope(
        &self,
        k: usize,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        du: &[f64],
        dp: f64,
    ) -> Result<Option<f64>, EvalError> {
        let _ = (k, u, p, which, du, dp);
        Ok(None)
    }
}

/// How a branch is read whose points are special points of another problem.
///
/// The eigenvalues of its Jacobian mean nothing, and where it turns in its parameter nothing
/// happens: neither makes an event. Those of the other problem do.
pub trait SpecialPoints {
    /// The eigenvalues of the other problem at a point, those that make it special left out.
    ///
    /// # Errors
    /// Where that problem has no value.
    fn others(&self, u: &[f64], p: &[f64]) -> Result<Others, EvalError>;

    /// The natural size of the unknowns, in the metric.
    fn scale(&self) -> Option<f64> {
        None
    }

    /// The same for a curve that is measured by how far its unknowns move, where they do not.
    fn fallback_scale(&self) -> Option<f64> {
        None
    }

    /// How far the equations of the curve are from a double root, where they would not determine its
    /// points; compared with its values elsewhere on the curve. `None` where they have none.
    ///
    /// # Errors
    /// Where that problem has no value.
    fn separation(&self, u: &[f64], p: &[f64]) -> Result<Option<f64>, EvalError> {
        let _ = (u, p);
        Ok(None)
    }

    /// What a zero of an observable is, if it is a special point.
    fn zero(&self, observable: usize) -> Option<EventKind>;

    /// Estimated error of an observable that is computed by differences, at the latest point.
    fn error(&self, observable: usize) -> f64 {
        let _ = observable;
        0.0
    }

    /// What it is when a pair of the other eigenvalues crosses the imaginary axis; `None`: nothing.
    fn crossing_pair(&self) -> Option<EventKind> {
        None
    }

    /// What it is when one of the other eigenvalues passes zero; `None`: nothing, or found by other
    /// means.
    fn crossing_zero(&self) -> Option<EventKind> {
        None
    }
}

/// The eigenvalues beside the critical ones.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Others {
    /// Number of unstable ones; `None` if it is not known.
    pub unstable: Option<usize>,
    /// Whether the number and the list are complete.
    pub certified: bool,
    /// The eigenvalues, (real, imaginary) parts, as far as they are known.
    pub values: Vec<(f64, f64)>,
}

/// An entry that an assembly wrote outside the matrix's pattern, as an error.
pub(crate) fn check_pattern<A: Matrix>(a: &A) -> Result<(), EvalError> {
    a.misplaced().map_or(Ok(()), |entry| Err(entry.into()))
}

/// The first component that is not finite, as an error.
pub(crate) fn check_finite(r: &[f64]) -> Result<(), EvalError> {
    match r.iter().position(|x| !x.is_finite()) {
        Some(at) => Err(EvalError::NotFinite { at }),
        None => Ok(()),
    }
}
