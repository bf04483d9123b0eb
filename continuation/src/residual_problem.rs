//! Problems from their residual alone, in every storage.

use crate::differences::{Ladder, magnitude, magnitudes};
use crate::linalg::{Band, Dense, Matrix, OutsidePattern, Sparse};
use crate::name::Name;
use crate::pool::Pool;
use crate::problem::{EvalError, ParamId, Parameter, Problem, Stability, check_finite};

/// `f(u, p) = 0` with a Jacobian of type `J` that is taken by differences: [`DenseProblem`],
/// [`BandProblem`] or [`SparseProblem`].
///
/// Differences are central, of order six, for every entry with a step of its own: found by comparing
/// steps at this state, so that neither the units of `u`, `f` and `p` nor earlier evaluations matter;
/// near 1e-13 for smooth `f`. At the edge of a domain they are one-sided. Columns that share no row are
/// moved together: a Jacobian costs 6 residuals and 4 more for each colour, several times that where `f`
/// varies on other lengths than the magnitude of `u`. [`Problem::derivative_error`] says how good they
/// are. A peak of `f` narrower than 4e-3 of the unknown and farther than its width from the state is
/// not seen, and need not be.
pub struct ResidualProblem<J, F> {
    n: usize,
    parameters: Vec<Parameter>,
    stability: Stability,
    f: F,
    empty: J,
    colours: Vec<Colour>,
    names: Vec<Name>,
    observables: Vec<Box<Observable>>,
    scratch: Pool<Scratch>,
}

/// A [`ResidualProblem`] with a dense Jacobian: for up to some tens of unknowns.
///
/// ```
/// use continuation::{DenseProblem, EventKind, Settings, Tracer};
/// use std::ops::ControlFlow;
///
/// // AUTO's demo `ab`: two folds, two Hopf points
/// let ab = DenseProblem::from_residual(2, &["p"], |u, p, r| {
///     let rate = p[0] * (1.0 - u[0]) * u[1].exp();
///     r[0] = -u[0] + rate;
///     r[1] = -u[1] + 18.0 * rate - 3.0 * u[1];
/// });
/// let settings = Settings { target: Some(0.25), ..Settings::default() };
/// let branch = Tracer::new(&ab, "p", &[0.0, 0.0], &[0.0], settings)?
///     .run(&mut |_| ControlFlow::Continue(()));
/// assert_eq!(branch.events_of(&EventKind::Fold).count(), 2);
/// assert_eq!(branch.events_of(&EventKind::Hopf).count(), 2);
/// # Ok::<(), continuation::TraceError>(())
/// ```
pub type DenseProblem<F> = ResidualProblem<Dense, F>;

/// A [`ResidualProblem`] with a banded Jacobian: chains, lines of cells, differential equations in
/// one dimension. One colour for each diagonal of the band.
///
/// ```
/// use continuation::{BandProblem, EventKind, Settings, Tracer};
/// use std::ops::ControlFlow;
///
/// // Bratu's problem u″ + p eᵘ = 0 on a line of 300 cells, u = 0 at both ends
/// let n = 300;
/// let h2 = 1.0 / ((n + 1) as f64).powi(2);
/// let bratu = BandProblem::from_residual(n, (1, 1), &["p"], |u, p, r| {
///     for i in 0..n {
///         let left = if i > 0 { u[i - 1] } else { 0.0 };
///         let right = if i + 1 < n { u[i + 1] } else { 0.0 };
///         r[i] = (left - 2.0 * u[i] + right) / h2 + p[0] * u[i].exp();
///     }
/// });
/// let settings = Settings { domain: Some((0.0, 4.0)), max_points: 100, ..Settings::default() };
/// let branch = Tracer::new(&bratu, "p", &vec![0.0; n], &[0.0], settings)?
///     .run(&mut |_| ControlFlow::Continue(()));
/// let fold = branch.events_of(&EventKind::Fold).next().expect("one fold");
/// assert!((fold.p - 3.51383).abs() < 1e-4);
/// # Ok::<(), continuation::TraceError>(())
/// ```
pub type BandProblem<F> = ResidualProblem<Band, F>;

/// A [`ResidualProblem`] with a sparse Jacobian: networks, differential equations in two dimensions.
pub type SparseProblem<F> = ResidualProblem<Sparse, F>;

/// A residual `f(u, p, r)` behind a pointer ([`ResidualProblem::boxed`]).
pub type BoxedResidual = Box<dyn Fn(&[f64], &[f64], &mut [f64]) + Send + Sync>;

/// A scalar function of unknowns and parameters.
type Observable = dyn Fn(&[f64], &[f64]) -> f64 + Send + Sync;

/// Columns of which no two have an entry in the same row.
struct Colour {
    columns: Vec<usize>,
    /// The column in which a row has an entry.
    owner: Vec<Option<u32>>,
}

struct Scratch {
    u: Vec<f64>,
    p: Vec<f64>,
    unit: Vec<f64>,
    ladder: Ladder,
}

impl Scratch {
    fn new(n: usize, parameters: usize) -> Self {
        let (u, p, unit) = (vec![0.0; n], vec![0.0; parameters], vec![0.0; n]);
        Scratch { u, p, unit, ladder: Ladder::new(n) }
    }
}

mod sealed {
    use crate::linalg::{Band, Dense, Matrix, Sparse};

    /// A storage that takes entries one by one.
    pub trait Entries: Matrix {
        fn put(&mut self, row: usize, column: usize, value: f64);
    }

    impl Entries for Dense {
        fn put(&mut self, row: usize, column: usize, value: f64) {
            self.set(row, column, value);
        }
    }

    impl Entries for Band {
        fn put(&mut self, row: usize, column: usize, value: f64) {
            self.set(row, column, value);
        }
    }

    impl Entries for Sparse {
        fn put(&mut self, row: usize, column: usize, value: f64) {
            if let Some(at) = self.position(row, column) {
                self.values_mut()[at] = value;
            }
        }
    }
}
use sealed::Entries;

impl<F: Fn(&[f64], &[f64], &mut [f64]) + Send + Sync> DenseProblem<F> {
    /// `n` unknowns, named parameters, and `f(u, p, r)` that writes the residual to `r`; read as
    /// `du/dt = f`, so that eigenvalues with positive real part are unstable. `u` and `r` have length
    /// `n`, `p` that of the names; every entry of `r` is to be written. A state without a value gives
    /// NaN, which the problem reports as an error.
    pub fn from_residual(n: usize, parameters: &[impl Clone + Into<Name>], f: F) -> Self {
        let all = |column: usize| Colour {
            columns: vec![column],
            owner: vec![u32::try_from(column).ok(); n],
        };
        Self::of(n, parameters, f, Dense::new(n), (0..n).map(all).collect())
    }
}

impl<F: Fn(&[f64], &[f64], &mut [f64]) + Send + Sync> BandProblem<F> {
    /// As [`DenseProblem::from_residual`], where `f[i]` depends on no other unknowns than
    /// `u[i − below]` to `u[i + above]`; `band` holds both.
    pub fn from_residual(
        n: usize,
        band: (usize, usize),
        parameters: &[impl Clone + Into<Name>],
        f: F,
    ) -> Self {
        let (below, above) = band;
        let period = below + above + 1;
        let colour = |first: usize| {
            let columns: Vec<usize> = (first..n).step_by(period).collect();
            let mut owner = vec![None; n];
            for &column in &columns {
                let rows = column.saturating_sub(above)..(column + below + 1).min(n);
                owner[rows].fill(u32::try_from(column).ok());
            }
            Colour { columns, owner }
        };
        let colours = (0..period.min(n)).map(colour).collect();
        Self::of(n, parameters, f, Band::new(n, below, above), colours)
    }
}

impl<F: Fn(&[f64], &[f64], &mut [f64]) + Send + Sync> SparseProblem<F> {
    /// As [`DenseProblem::from_residual`], where `f[i]` depends on `u[j]` for the `(i, j)` of `pattern`
    /// only. One colour more than a row has entries at most, usually.
    ///
    /// # Errors
    /// When an index of the pattern is not below `n`.
    pub fn from_residual(
        n: usize,
        pattern: &[(usize, usize)],
        parameters: &[impl Clone + Into<Name>],
        f: F,
    ) -> Result<Self, OutsidePattern> {
        let empty = Sparse::new(n, pattern)?;
        let colours = coloured(&empty);
        Ok(Self::of(n, parameters, f, empty, colours))
    }
}

/// Each column gets the first colour that none of its rows has.
fn coloured(pattern: &Sparse) -> Vec<Colour> {
    let n = pattern.dim();
    let mut colours: Vec<Colour> = Vec::new();
    for column in 0..n {
        let (rows, _) = pattern.column(column);
        let free = |colour: &Colour| rows.iter().all(|&row| colour.owner[row].is_none());
        let found = colours.iter().position(free).unwrap_or_else(|| {
            colours.push(Colour { columns: Vec::new(), owner: vec![None; n] });
            colours.len() - 1
        });
        colours[found].columns.push(column);
        for &row in rows {
            colours[found].owner[row] = u32::try_from(column).ok();
        }
    }
    colours
}

impl<J, F: Fn(&[f64], &[f64], &mut [f64]) + Send + Sync> ResidualProblem<J, F> {
    fn of(
        n: usize,
        names: &[impl Clone + Into<Name>],
        f: F,
        empty: J,
        colours: Vec<Colour>,
    ) -> Self {
        let parameters: Vec<Parameter> =
            names.iter().map(|name| Parameter::named(name.clone(), "", 1.0)).collect();
        let scratch = Pool::new(Scratch::new(n, parameters.len()));
        ResidualProblem {
            n,
            parameters,
            stability: Stability::Dynamics,
            f,
            empty,
            colours,
            names: Vec::new(),
            observables: Vec::new(),
            scratch,
        }
    }

    /// What the Jacobian's eigenvalues mean, if not [`Stability::Dynamics`].
    #[must_use]
    pub fn with_stability(mut self, stability: Stability) -> Self {
        self.stability = stability;
        self
    }

    /// Adds a scalar function of unknowns and parameters, to be reported at every point and to
    /// be watched ([`crate::Watch`]).
    #[must_use]
    pub fn observing(
        mut self,
        name: impl Into<Name>,
        value: impl Fn(&[f64], &[f64]) -> f64 + Send + Sync + 'static,
    ) -> Self {
        self.names.push(name.into());
        self.observables.push(Box::new(value));
        self
    }

    /// The same with a residual behind a pointer: a type that has a name and is the same for all
    /// residuals, so that the engine is compiled once for all of them.
    ///
    /// ```
    /// use continuation::{BoxedResidual, DenseProblem};
    ///
    /// let line = DenseProblem::from_residual(1, &["p"], |u, p, r| r[0] = u[0] - p[0]);
    /// let fold = DenseProblem::from_residual(1, &["p"], |u, p, r| r[0] = p[0] - u[0] * u[0]);
    /// let both: [DenseProblem<BoxedResidual>; 2] = [line.boxed(), fold.boxed()];
    /// ```
    #[must_use]
    pub fn boxed(self) -> ResidualProblem<J, BoxedResidual>
    where
        F: 'static,
    {
        let ResidualProblem {
            n,
            parameters,
            stability,
            f,
            empty,
            colours,
            names,
            observables,
            scratch,
        } = self;
        let f: BoxedResidual = Box::new(f);
        ResidualProblem { n, parameters, stability, f, empty, colours, names, observables, scratch }
    }

    /// A typical magnitude of a parameter ([`Parameter::scale`]), by default 1; without effect if there
    /// is no such parameter.
    #[must_use]
    pub fn with_scale(mut self, which: ParamId, scale: f64) -> Self {
        if let Some(parameter) = self.parameters.get_mut(which.0) {
            parameter.scale = scale;
        }
        self
    }

    /// Evaluates with work space.
    fn with<R>(&self, evaluate: impl FnOnce(&mut Scratch) -> R) -> R {
        self.scratch.with(|| Scratch::new(self.n, self.parameters.len()), evaluate)
    }

    /// The value in the middle, its rounding errors, and the magnitudes of the unknowns.
    fn centre(&self, scratch: &mut Scratch, u: &[f64], p: &[f64]) -> Result<(), EvalError> {
        let Scratch { u: place, p: values, unit, ladder } = scratch;
        magnitudes(u, 1.0, unit);
        ladder.look((u, p), (place, values), unit, &self.f);
        check_finite(ladder.value())
    }

    /// Derivatives along the columns of a colour: of every row along the column that it sees.
    fn along(&self, scratch: &mut Scratch, colour: &Colour, u: &[f64]) {
        let Scratch { u: place, p, unit, ladder } = scratch;
        for (by_row, owner) in ladder.unit.iter_mut().zip(&colour.owner) {
            *by_row = owner.map_or(0.0, |column| unit[column as usize]);
        }
        ladder.climb(|multiple, r| {
            for &k in &colour.columns {
                place[k] = u[k] + multiple * unit[k];
            }
            (self.f)(place, p, r);
        });
        for &k in &colour.columns {
            place[k] = u[k];
        }
    }

    /// Derivatives along a parameter.
    fn along_parameter(&self, scratch: &mut Scratch, which: ParamId) {
        let Scratch { u, p, ladder, .. } = scratch;
        let kept = p[which.0];
        let unit = magnitude(kept, self.parameters[which.0].scale);
        ladder.unit.fill(unit);
        ladder.climb(|multiple, r| {
            p[which.0] = kept + multiple * unit;
            (self.f)(u, p, r);
        });
        p[which.0] = kept;
    }
}

impl<J: Entries, F: Fn(&[f64], &[f64], &mut [f64]) + Send + Sync> Problem
    for ResidualProblem<J, F>
{
    type Jacobian = J;

    fn dim(&self) -> usize {
        self.n
    }

    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn new_jacobian(&self) -> J {
        self.empty.clone()
    }

    fn residual(&self, u: &[f64], p: &[f64], r: &mut [f64]) -> Result<(), EvalError> {
        (self.f)(u, p, r);
        check_finite(r)
    }

    fn jacobian(&self, u: &[f64], p: &[f64], j: &mut J) -> Result<(), EvalError> {
        self.with(|scratch| {
            self.centre(scratch, u, p)?;
            j.set_zero();
            for colour in &self.colours {
                self.along(scratch, colour, u);
                check_finite(&scratch.ladder.derivative)?;
                for (row, owner) in colour.owner.iter().enumerate() {
                    if let Some(column) = owner {
                        j.put(row, *column as usize, scratch.ladder.derivative[row]);
                    }
                }
            }
            Ok(())
        })
    }

    fn parameter_derivative(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        self.with(|scratch| {
            self.centre(scratch, u, p)?;
            self.along_parameter(scratch, which);
            out.copy_from_slice(&scratch.ladder.derivative);
            check_finite(out)
        })
    }

    fn derivative_error(
        &self,
        u: &[f64],
        p: &[f64],
        which: ParamId,
        du: &[f64],
        dp: f64,
        out: &mut [f64],
    ) -> Result<(), EvalError> {
        self.with(|scratch| {
            self.centre(scratch, u, p)?;
            out.fill(0.0);
            for colour in &self.colours {
                self.along(scratch, colour, u);
                for (row, owner) in colour.owner.iter().enumerate() {
                    if let Some(column) = owner {
                        out[row] += scratch.ladder.error[row] * du[*column as usize].abs();
                    }
                }
            }
            if dp != 0.0 {
                self.along_parameter(scratch, which);
                for (out, error) in out.iter_mut().zip(&scratch.ladder.error) {
                    *out += error * dp.abs();
                }
            }
            check_finite(out)
        })
    }

    fn stability(&self) -> Stability {
        self.stability
    }

    fn observables(&self) -> &[Name] {
        &self.names
    }

    fn observe(&self, u: &[f64], p: &[f64], out: &mut [f64]) -> Result<(), EvalError> {
        for (out, observable) in out.iter_mut().zip(&self.observables) {
            *out = observable(u, p);
        }
        Ok(())
    }
}
