//! Stability of an axisymmetric, equatorially symmetric state against everything else.
//!
//! The Hessian of [`ContactProblem`] sees perturbations that are axisymmetric and mirror images
//! about the equator. Here are the others: `n = 0` without the mirror symmetry, and
//! `(u cos nφ, v sin nφ, w cos nφ)` for `n ≥ 1`, each in the class of modes that are their own
//! mirror images and in the class that change sign. On the half meridian both are end conditions
//! ([`Parity`]); the pointwise second variation (module `density`) is the same, so that one
//! assembly serves all of them: the matrix is `K_n = Σ nᵏ K⁽ᵏ⁾`, `k = 0 … 4`.
//!
//! The measures of strain are those of the base state's energy, `C` and `U⁻¹b − 1` (no shallow or
//! small-strain theory), the film acts along `z` per deformed area, the plates stay horizontal, and
//! the gas enters by `−(P_G − P_A) δ²V` alone: these modes change neither the volume nor the force
//! to first order, so that neither the gas's stiffness nor the loading device matters.
//!
//! Two motions cost nothing and are left out of the counts: translation along the plates and, as
//! the film has no friction and the sphere is isotropic, the rotation of the shell's material under
//! its own dents (both `n = 1`). Without any film there are more (module `ends`): then counts of
//! `n = 0` and `n = 1` are uncertain. About a state that is not its own mirror image there are no two
//! classes, and the whole meridian is one matrix ([`WholeModes`], and [`scan_whole_branch`] along a
//! branch). Torsion (`n = 0`, along `φ`), friction and self-contact are
//! not examined.
//!
//! ```
//! use shell_contact::modes::{AsymmetricModes, Parity};
//! use shell_contact::{ContactProblem, Dimensionless, Law, Mesh, Shell};
//!
//! let groups = Dimensionless {
//!     bending: 3e-5,
//!     pressure: 3e-3,
//!     adhesion: 2e-6,
//!     film: 1.0 / 30.0,
//!     surface_tension: 0.0,
//!     gas_exponent: 1.07,
//! };
//! let shell = Shell { law: Law::Hooke, poisson: 0.5 };
//! let problem = ContactProblem::new(&shell, &groups, Mesh::uniform(50)?)?;
//! let mut modes = AsymmetricModes::new(problem.mesh());
//! modes.assemble(&problem, &problem.initial_state(), &problem.parameters_at(1.06))?;
//! // between attractive plates that it does not touch the bubble goes to one of them
//! assert_eq!(modes.count(0, Parity::Antisymmetric).negative, 1);
//! assert_eq!(modes.scan(20).modes, 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod along;
mod bound;
#[cfg(test)]
mod certify;
mod density;
mod eigen;
mod elements;
mod ends;
mod inertia;
mod locate;
mod whole;
mod whole_eigen;

pub use along::{ScanSettings, Scanned, SymmetryBreaking, scan_branch, scan_whole_branch};
pub use eigen::{Mode, ModeShape};
pub use whole::{WholeModes, WholeScan, WholeShell};

use crate::contact::ContactProblem;
use crate::density::Coefficients;
use crate::energy;
use crate::film::Potential;
use crate::membrane::Membrane;
use crate::meridian::Mesh;
use continuation::linalg::SymmetricBand;
use continuation::{EvalError, Matrix};
use elements::{Elements, Masses};
use ends::{Ends, Neutral};
use inertia::Elimination;

/// Pivots below this, relative to the diagonal of the scaled matrix, are rounding: a few
/// hundred units of the last place, as many as terms are summed into a pivot of half-bandwidth 11.
const LEAST_PIVOT: f64 = 128.0 * f64::EPSILON;

/// Wave numbers that are always examined, whatever the bound says: those of the reference states'
/// first instabilities begin at 2.
const FEWEST_WAVES: usize = 4;

/// Wave numbers beyond the bound that must be safe.
const MARGIN: usize = 2;

/// How a mode behaves under reflection about the equatorial plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Parity {
    /// It is its own mirror image.
    Symmetric,
    /// Its mirror image is its opposite: one side grows while the other heals.
    Antisymmetric,
}

impl Parity {
    /// Both.
    pub const BOTH: [Parity; 2] = [Parity::Symmetric, Parity::Antisymmetric];

    /// `symmetric` or `antisymmetric`.
    pub fn name(self) -> &'static str {
        match self {
            Parity::Symmetric => "symmetric",
            Parity::Antisymmetric => "antisymmetric",
        }
    }
}

/// The number of unstable modes of a class.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ModeCount {
    /// Negative eigenvalues.
    pub negative: usize,
    /// Whether rounding cannot have changed it; false at an onset.
    pub certain: bool,
}

/// The modes of a state that are not axisymmetric and equatorially symmetric.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Scan {
    /// Unstable modes of `n = 0` that break the equatorial symmetry.
    pub antisymmetric: usize,
    /// Whether that number is certain, whatever the others are.
    pub antisymmetric_certain: bool,
    /// Unstable modes of `n ≥ 1`, each pair `cos nφ`, `sin nφ` counted once.
    pub modes: usize,
    /// The smallest unstable `n ≥ 1`.
    pub first_n: Option<usize>,
    /// The largest `n` that was examined.
    pub n_max: usize,
    /// Whether every count is certain and the modes beyond `n_max` are stable by the bound.
    pub certain: bool,
    /// Counts of `n = 1, …, n_max`: symmetric, antisymmetric.
    pub by_wave: Vec<[ModeCount; 2]>,
}

impl Scan {
    /// Whether nothing that was examined is unstable, and all of it is certain.
    pub fn is_stable(&self) -> bool {
        self.certain && self.antisymmetric == 0 && self.modes == 0
    }

    /// The count of a class that was examined.
    pub fn count(&self, n: usize, parity: Parity) -> Option<ModeCount> {
        self.by_wave.get(n.checked_sub(1)?).map(|counts| match parity {
            Parity::Symmetric => counts[0],
            Parity::Antisymmetric => counts[1],
        })
    }
}

/// Which wave numbers are examined: up to the bound and `MARGIN` beyond, further while the last are
/// not stable, never beyond a largest.
struct Extent {
    n: usize,
    wanted: usize,
    max_n: usize,
    /// How many of the last are stable for certain.
    safe: usize,
    bounded: bool,
}

impl Extent {
    fn new(bound: f64, max_n: usize) -> Extent {
        // beyond 1000 waves the bound is no bound but a number that is not finite
        let wanted = FEWEST_WAVES.max(bound.min(1e3).ceil() as usize + MARGIN);
        Extent { n: 0, wanted, max_n, safe: 0, bounded: bound.is_finite() }
    }

    /// The next number to be examined.
    fn next(&mut self) -> Option<usize> {
        let goes_on = self.n < self.max_n && (self.n < self.wanted || self.safe < MARGIN);
        self.n += usize::from(goes_on);
        goes_on.then_some(self.n)
    }

    fn examined(&mut self, stable: bool) {
        self.safe = if stable { self.safe + 1 } else { 0 };
    }

    /// Whether nothing beyond is unstable, by the bound.
    fn is_enough(&self) -> bool {
        self.n >= self.wanted && self.safe >= MARGIN && self.bounded
    }
}

/// The second variation about a state, for every wave number. Allocates when it is made; a new
/// state, a count and a scan into an old [`Scan`] do not.
#[derive(Debug, Clone)]
pub struct AsymmetricModes<'a> {
    mesh: &'a Mesh,
    elements: Elements,
    elimination: Elimination,
    band: SymmetricBand,
    masses: Masses,
    mass: SymmetricBand,
    scale: Vec<f64>,
    bound: f64,
}

impl<'a> AsymmetricModes<'a> {
    /// Room for the modes on a mesh.
    pub fn new(mesh: &'a Mesh) -> AsymmetricModes<'a> {
        let band = elements::band(mesh.elements());
        AsymmetricModes {
            mesh,
            elements: Elements::new(mesh.elements()),
            elimination: Elimination::new(mesh.elements()),
            masses: Masses::new(mesh),
            mass: band.clone(),
            scale: vec![1.0; band.dim()],
            band,
            bound: 0.0,
        }
    }

    /// Takes the state `u` of a contact problem on the same mesh, with parameters `p`.
    ///
    /// # Errors
    /// When the state is not admissible.
    pub fn assemble(
        &mut self,
        problem: &ContactProblem,
        u: &[f64],
        p: &[f64],
    ) -> Result<(), EvalError> {
        let (c, gas) = problem.coefficients(u, p)?;
        let excess = gas.excess(energy::volume(self.mesh, u)?);
        let film = &problem.potential;
        self.assemble_with(&c.material(problem.shell.law), film, &c, excess, u)
    }

    /// Takes the state `u` under the excess pressure `P_G − P_A`.
    ///
    /// # Errors
    /// When the state is not admissible.
    pub fn assemble_with<L: Membrane, F: Potential>(
        &mut self,
        law: &L,
        film: &F,
        c: &Coefficients,
        excess: f64,
        u: &[f64],
    ) -> Result<(), EvalError> {
        energy::admissible(self.mesh, u, film.wall(c))?;
        elements::assemble(self.mesh, u, law, film, c, excess, &mut self.elements);
        self.bound = bound::largest_wave(self.mesh, u, law, film, c)?;
        Ok(())
    }

    /// The wave number above which a patch of the shell is locally stable (module `bound`).
    pub fn wave_bound(&self) -> f64 {
        self.bound
    }

    /// The number of unstable modes of a class; `n = 0`, symmetric, is what the half problem
    /// itself counts at constant gas pressure.
    pub fn count(&mut self, n: usize, parity: Parity) -> ModeCount {
        let ends = self.ends(n, parity, Neutral::Pinned);
        self.negative_below(&ends, n, 0.0)
    }

    /// The numbers of unstable modes of `n ≥ 1`, symmetric and antisymmetric.
    fn counts(&mut self, n: usize) -> [ModeCount; 2] {
        let ends = Parity::BOTH.map(|parity| self.ends(n, parity, Neutral::Pinned));
        let found = self.elimination.negative(&self.elements, ends.each_ref(), n);
        let mut counts = [ModeCount::default(); 2];
        for k in 0..2 {
            counts[k] = match found[k] {
                Some(negative) => ModeCount { negative, certain: true },
                None => self.negative_below(&ends[k], n, 0.0),
            };
        }
        counts
    }

    /// Examines every class up to the bound and `MARGIN` beyond, further while the last are not
    /// stable, never beyond `max_n`.
    pub fn scan(&mut self, max_n: usize) -> Scan {
        let mut scan = Scan::default();
        self.scan_into(max_n, &mut scan);
        scan
    }

    /// [`AsymmetricModes::scan`] without allocation when `scan` has been used before.
    pub fn scan_into(&mut self, max_n: usize, scan: &mut Scan) {
        let odd = self.count(0, Parity::Antisymmetric);
        scan.by_wave.clear();
        (scan.antisymmetric, scan.modes, scan.first_n) = (odd.negative, 0, None);
        (scan.antisymmetric_certain, scan.certain) = (odd.certain, odd.certain);
        let mut extent = Extent::new(self.bound, max_n);
        while let Some(n) = extent.next() {
            let counts = self.counts(n);
            let negative = counts[0].negative + counts[1].negative;
            let certain = counts[0].certain && counts[1].certain;
            extent.examined(negative == 0 && certain);
            scan.modes += negative;
            scan.certain &= certain;
            if negative > 0 && scan.first_n.is_none() {
                scan.first_n = Some(n);
            }
            scan.by_wave.push(counts);
        }
        scan.n_max = extent.n;
        scan.certain &= extent.is_enough();
    }

    fn ends(&self, n: usize, parity: Parity, neutral: Neutral) -> Ends {
        Ends::new(self.mesh.knots(), n, parity, neutral)
    }

    /// Sets the band to `K_n` of a class.
    fn matrix(&mut self, ends: &Ends, n: usize) {
        elements::matrix(&self.elements, ends, n, &mut self.elimination.columns, &mut self.band);
    }

    /// Factors `K_n − shift M`, scaled to a unit diagonal, and counts.
    fn negative_below(&mut self, ends: &Ends, n: usize, shift: f64) -> ModeCount {
        self.matrix(ends, n);
        if shift != 0.0 {
            self.masses.matrix(ends, n, &mut self.mass);
            self.band.axpy(-shift, &self.mass);
        }
        count_negative(&mut self.band, &mut self.scale)
    }
}

/// `x ← K⁻¹ x` with the factors of a band that `count_negative` scaled.
fn solve(band: &mut SymmetricBand, scale: &[f64], x: &mut [f64]) {
    x.iter_mut().zip(scale).for_each(|(x, s)| *x *= s);
    band.solve(x);
    x.iter_mut().zip(scale).for_each(|(x, s)| *x *= s);
}

/// Factors a band, scaled to a unit diagonal by `scale`, and counts.
fn count_negative(band: &mut SymmetricBand, scale: &mut [f64]) -> ModeCount {
    // a congruence keeps the inertia, and pivots of very unequal rows become comparable
    let dim = band.dim();
    for j in 0..dim {
        let d = band.column_mut(j)[0].abs();
        scale[j] = if d > 0.0 && d.is_finite() { 1.0 / d.sqrt() } else { 1.0 };
    }
    for j in 0..dim {
        let by = scale[j];
        for (k, entry) in band.column_mut(j).iter_mut().enumerate() {
            *entry *= by * scale[j + k];
        }
    }
    let facts = band.factor(LEAST_PIVOT);
    let negative = facts.inertia.map(|(negative, _)| negative);
    ModeCount {
        negative: negative.unwrap_or(0),
        certain: negative.is_some() && facts.perturbed == 0,
    }
}
