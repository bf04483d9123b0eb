//! Eigenvalues and modes of a state: what is about to become, or is, unstable.
//!
//! Of an energy's Hessian the lowest eigenvalues of `H x = λ M x`, with the mass matrix or the
//! metric as `M`, so that they converge under mesh refinement; of `M du/dt = f` the ones with the
//! largest real part. Symmetric matrices by shift-invert Lanczos with the factorisation that is
//! there already, where the inertia proves that none is missing; small dense ones by their full
//! spectrum; others by shift-invert Arnoldi about zero, which proves nothing: an eigenvalue far from
//! zero with a large imaginary part can be missed.

use crate::any_problem::DynProblem;
use crate::linalg::{
    AnyMatrix, Arnoldi, Dense, EigenSettings, Lanczos, Matrix, Spectrum, count_right,
};
use crate::problem::{EvalError, Problem, Stability, check_finite, check_pattern};
use crate::settings::Counting;

/// The most unstable eigenvalues of a state, with their modes.
#[derive(Debug, Clone, PartialEq)]
pub struct Modes {
    /// Eigenvalues, (real, imaginary) parts, the most unstable first; fewer than asked for where the
    /// iteration found fewer.
    pub values: Vec<(f64, f64)>,
    /// Eigenvectors of real eigenvalues of symmetric problems, of length 1 in the norm of `M`;
    /// empty where only the values are computed (full spectra of dense matrices).
    pub vectors: Vec<Vec<f64>>,
    /// Whether it is certain that no more unstable eigenvalue is missing.
    pub certified: bool,
}

/// The `count` most unstable eigenvalues at a state, and their modes. The state need not be a
/// solution. Each vector has length [`Problem::dim`].
///
/// ```
/// use continuation::{modes, samples::Bratu};
/// // −u″ = λ eᵘ at λ = 0: the lowest eigenvalues of −u″ are near (kπ)²
/// let found = modes(&Bratu::new(400), &vec![0.0; 400], &[0.0], 3)?;
/// assert!(found.certified);
/// for (k, (value, _)) in found.values.iter().enumerate() {
///     let exact = ((k + 1) as f64 * std::f64::consts::PI).powi(2);
///     assert!((value / exact - 1.0).abs() < 1e-4);
/// }
/// # Ok::<(), continuation::EvalError>(())
/// ```
///
/// # Errors
/// Where the problem has no value at the state.
pub fn modes<P: Problem + ?Sized>(
    problem: &P,
    u: &[f64],
    p: &[f64],
    count: usize,
) -> Result<Modes, EvalError> {
    modes_of(&problem, u, p, count)
}

/// [`modes`] of a problem of unknown type.
pub(crate) fn modes_of(
    problem: &DynProblem<'_>,
    u: &[f64],
    p: &[f64],
    count: usize,
) -> Result<Modes, EvalError> {
    let mut jacobian = problem.new_jacobian();
    let mut r = vec![0.0; problem.dim()];
    problem.linearise(u, p, &mut r, &mut jacobian)?;
    check_finite(&r)?;
    if problem.stability() == Stability::SeparateHessian {
        problem.energy_hessian(u, p, &mut jacobian)?;
    }
    check_pattern(&jacobian)?;
    let floor = f64::EPSILON * jacobian.norm();
    let facts = jacobian.factor(floor);
    let mut solver = ModeSolver::new(problem, count);
    let mut values = Vec::new();
    let certified = solver.solve(problem, &mut jacobian, facts.inertia, &mut values);
    let vectors = solver.vectors(values.len());
    Ok(Modes { values, vectors, certified })
}

/// Eigenvalues beyond this multiple of `|J| / |M|` belong to fast modes.
const FAST: f64 = 1e7;
/// Dimension up to which all eigenvalues of any matrix are computed, as of a dense one: some
/// 10 ms a point.
const SMALL: usize = 120;
/// The same where they are asked for; `n³` operations a point, half a second at 400 unknowns.
const FULL: usize = crate::linalg::MAX_SPECTRUM;

/// Relative difference of two computations of one eigenvalue.
const SAME: f64 = 1e-6;

/// Solves after which the search for a few eigenvalues ends with what it has.
const MOST_SOLVES: usize = 200;

/// A real part that counts as zero: rounding of a well-conditioned eigenvalue, of whose likes none is
/// larger than `slow`.
pub(crate) fn zero(values: &[(f64, f64)], slow: f64) -> f64 {
    let largest = values.iter().fold(0.0, |m: f64, (re, im)| m.max(re.hypot(*im))).min(slow);
    4.0 * values.len() as f64 * f64::EPSILON * largest
}

/// Eigenvalues whose error is this many times what counts as zero are still told from zero by the
/// steps of a branch.
const RESOLVED: f64 = 1e4;

/// Whether the number of unstable eigenvalues is certain.
pub(crate) fn has_certain_signs(spectrum: &Spectrum, slow: f64) -> bool {
    spectrum.has_certain_signs(RESOLVED * zero(&spectrum.values, slow))
}

fn dense<A: Matrix>(a: &A) -> Dense {
    let n = a.dim();
    let mut full = Dense::new(n);
    let mut unit = vec![0.0; n];
    for j in 0..n {
        unit[j] = 1.0;
        a.mul(&unit, full.column_mut(j));
        unit[j] = 0.0;
    }
    full
}

/// Computes the most unstable eigenvalues from a factored Jacobian; storage is reused.
pub(crate) struct ModeSolver {
    wanted: usize,
    sense: Stability,
    multipliers: usize,
    mass: Option<AnyMatrix>,
    lanczos: Option<Lanczos>,
    start: Vec<f64>,
    warm: bool,
    /// Dimension up to which all eigenvalues are computed.
    small: usize,
    /// Whether the mass matrix is positive definite; `None` until it is asked for.
    definite: Option<bool>,
}

impl ModeSolver {
    pub(crate) fn new(problem: &DynProblem<'_>, wanted: usize) -> Self {
        // from here on the matrices that come in are the Hessian
        let sense = match problem.stability() {
            Stability::SeparateHessian => Stability::EnergyHessian,
            sense => sense,
        };
        let mut mass = problem.new_jacobian();
        mass.set_zero();
        let mass = problem.mass(&mut mass).then_some(mass);
        ModeSolver {
            wanted: wanted.min(problem.dim()),
            sense,
            multipliers: problem.multipliers(),
            mass,
            lanczos: None,
            start: Vec::new(),
            warm: false,
            small: SMALL,
            definite: None,
        }
    }

    /// The same with another way of counting.
    pub(crate) fn counting(mut self, counting: Counting) -> Self {
        self.small = match counting {
            Counting::Automatic => SMALL,
            Counting::Full => FULL,
            Counting::Few => 0,
        };
        self
    }

    /// Whether the inertia of the Jacobian counts the eigenvalues of the pencil.
    pub(crate) fn mass_is_definite(&mut self) -> bool {
        let Some(mass) = &mut self.mass else { return true };
        *self.definite.get_or_insert_with(|| {
            let facts = mass.factor(f64::EPSILON * mass.norm());
            let n = mass.dim();
            let part = mass.symmetric_part();
            let inertia = facts.inertia.is_some_and(|(_, positive)| positive == n);
            let symmetric = part.is_some_and(|part| part.whole && part.positive == n);
            facts.perturbed == 0 && (inertia || symmetric)
        })
    }

    /// All eigenvalues with their errors, where a full spectrum is affordable.
    pub(crate) fn spectrum(&self, jacobian: &AnyMatrix) -> Option<Spectrum> {
        jacobian.spectrum_with_errors(self.mass.as_ref()).or_else(|| {
            let small = jacobian.dim() <= self.small;
            let mass = || self.mass.as_ref().map(dense);
            small.then(|| dense(jacobian).spectrum_with_errors(mass().as_ref()))?
        })
    }

    /// Unstable eigenvalues of a matrix that is too large for its full spectrum, where that is asked for,
    /// and whether others lie on the imaginary axis; the pair nearest to that is added to `few` if it is
    /// not there. `None` where it is not asked for, and where the count is not certain.
    pub(crate) fn by_argument(
        &mut self,
        jacobian: &AnyMatrix,
        few: &mut Vec<(f64, f64)>,
    ) -> Option<(usize, bool)> {
        if self.small < FULL || !self.mass_is_definite() {
            return None;
        }
        let (n, mass) = (jacobian.dim(), self.mass.as_ref());
        let found = count_right(jacobian, mass)?;
        if let Some(omega) = found.pair {
            let near = Arnoldi::new(n, 1).nearest_to_imaginary(jacobian, mass, omega);
            let pair = near.and_then(|near| near.pairs.into_iter().find(|pair| pair.converged));
            if let Some((re, im)) = pair.map(|pair| pair.value).filter(|(_, im)| *im > 0.0) {
                let same = |(a, b): &(f64, f64)| (a - re).hypot(b - im) < SAME * re.hypot(im);
                if !few.iter().any(same) {
                    few.extend([(re, im), (re, -im)]);
                }
            }
        }
        if self.sense != Stability::EnergyHessian {
            return Some((found.right, found.critical));
        }
        // how many are on the axis is not known
        (!found.critical).then(|| (n - found.right, false))
    }

    /// Eigenvalues beyond this are those of fast modes, beside which the others keep their digits; only
    /// a mass matrix makes them.
    pub(crate) fn slow(&self, jacobian: &AnyMatrix) -> f64 {
        let by_mass = |mass: &AnyMatrix| FAST * jacobian.norm() / mass.norm();
        self.mass.as_ref().map_or(f64::INFINITY, by_mass)
    }

    /// The most unstable eigenvalues to `values`, most unstable first; whether that is certain.
    pub(crate) fn solve(
        &mut self,
        problem: &DynProblem<'_>,
        jacobian: &mut AnyMatrix,
        inertia: Option<(usize, usize)>,
        values: &mut Vec<(f64, f64)>,
    ) -> bool {
        values.clear();
        if self.wanted == 0 {
            return false;
        }
        if let Some((negative, positive)) = inertia {
            return self.symmetric(problem, jacobian, negative, positive, values);
        }
        let spectrum = self.spectrum(jacobian);
        let slow = self.slow(jacobian);
        let certain = spectrum.as_ref().is_some_and(|s| has_certain_signs(s, slow));
        let spectrum = match spectrum {
            Some(plain) => self.weighted(problem, jacobian).unwrap_or(plain.values),
            None => self.few(problem, jacobian, self.wanted),
        };
        self.pick(spectrum, values);
        certain
    }

    /// The most unstable ones of a spectrum, or of a part of it.
    pub(crate) fn pick(&self, mut spectrum: Vec<(f64, f64)>, values: &mut Vec<(f64, f64)>) {
        if self.wanted > 0 {
            self.sort(&mut spectrum);
            values.extend(spectrum.into_iter().take(self.wanted));
        }
    }

    /// The full spectrum of an energy's Hessian against the metric, where that is not the identity
    /// and no mass matrix takes its place; only where eigenvalues are wanted.
    pub(crate) fn weighted(
        &self,
        problem: &DynProblem<'_>,
        jacobian: &AnyMatrix,
    ) -> Option<Vec<(f64, f64)>> {
        let energy = self.sense == Stability::EnergyHessian;
        if self.wanted == 0 || !energy || self.mass.is_some() {
            return None;
        }
        let n = jacobian.dim();
        let mut metric = Dense::new(n);
        let mut unit = vec![0.0; n];
        let mut identity = true;
        for j in 0..n {
            unit[j] = 1.0;
            problem.metric(&unit, metric.column_mut(j));
            identity &= metric.column(j) == unit;
            unit[j] = 0.0;
        }
        if identity { None } else { dense(jacobian).spectrum(Some(&metric)) }
    }

    /// At least `count` eigenvalues nearest to zero, by iteration with the factors.
    pub(crate) fn few(
        &self,
        problem: &DynProblem<'_>,
        jacobian: &mut AnyMatrix,
        count: usize,
    ) -> Vec<(f64, f64)> {
        let energy = self.sense == Stability::EnergyHessian;
        let product = |x: &[f64], y: &mut [f64]| match &self.mass {
            Some(mass) => mass.mul(x, y),
            None if energy => problem.metric(x, y),
            None => y.copy_from_slice(x),
        };
        let settings =
            EigenSettings { tolerance: 1e-10, max_solves: MOST_SOLVES, ..EigenSettings::default() };
        let arnoldi = Arnoldi::new(problem.dim(), count.min(problem.dim())).with_settings(settings);
        let found = arnoldi.nearest(0.0, product, |x| jacobian.solve(x), None);
        found.pairs.iter().filter(|pair| pair.converged).map(|pair| pair.value).collect()
    }

    /// Sorts by instability.
    fn sort(&self, values: &mut [(f64, f64)]) {
        let sign = self.sign();
        values.sort_by(|a, b| (sign * b.0).total_cmp(&(sign * a.0)).then(b.1.total_cmp(&a.1)));
    }

    /// +1 where large eigenvalues are unstable, −1 where small ones are.
    fn sign(&self) -> f64 {
        if self.sense == Stability::EnergyHessian { -1.0 } else { 1.0 }
    }

    fn symmetric(
        &mut self,
        problem: &DynProblem<'_>,
        jacobian: &mut AnyMatrix,
        negative: usize,
        positive: usize,
        values: &mut Vec<(f64, f64)>,
    ) -> bool {
        let n = problem.dim();
        if self.lanczos.is_none() {
            self.lanczos = Some(Lanczos::new(n, self.wanted));
            self.start = vec![0.0; n];
        }
        let (sign, energy) = (self.sign(), self.sense == Stability::EnergyHessian);
        let Some(lanczos) = &mut self.lanczos else { return false };
        // the lowest of H, or those of −J
        let below = if energy { negative.saturating_sub(self.multipliers) } else { positive };
        let mass = self.mass.as_ref();
        let product = |x: &[f64], y: &mut [f64]| match mass {
            Some(mass) => mass.mul(x, y),
            None if energy => problem.metric(x, y),
            None => y.copy_from_slice(x),
        };
        let solve = |x: &mut [f64]| {
            jacobian.solve(x);
            if !energy {
                x.iter_mut().for_each(|x| *x = -*x);
            }
        };
        let start = self.warm.then_some(&self.start[..]);
        let report = lanczos.lowest(0.0, Some(below), product, solve, start);
        let all = lanczos.values().iter().take(self.wanted);
        values.extend(all.map(|v| (-sign * v, 0.0)));
        lanczos.blend(&mut self.start);
        self.warm = self.start.iter().all(|x| x.is_finite());
        report.complete
    }

    /// Eigenvectors of the latest symmetric solution.
    fn vectors(&self, count: usize) -> Vec<Vec<f64>> {
        let Some(lanczos) = &self.lanczos else { return Vec::new() };
        (0..count.min(lanczos.values().len())).map(|i| lanczos.vector(i).to_vec()).collect()
    }
}
