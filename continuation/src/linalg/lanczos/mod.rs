//! Shift-invert Lanczos for symmetric pencils.

use super::eigen::{EigenReport, EigenSettings, Noise};
use super::small_symmetric::SmallSymmetric;
use super::vector::add_scaled;

mod basis;
mod vectors;

/// Increase of [`Lanczos::score`] from which on a search has found something.
const FOUND: f64 = 1e-6;
/// Least number of steps from a random vector after which a search for copies may end.
const PROBE: usize = 6;
/// Solves that may pass without a missing eigenvalue before a random vector is tried, for the
/// first time; twice as many for the next ones.
const PATIENCE: usize = 20;
/// Random vectors tried for missing eigenvalues before they are given up.
const ATTEMPTS: usize = 3;
/// Residual of an unwanted eigenvalue, relative to its distance from the wanted ones, at which a
/// search ends.
const MARGIN: f64 = 0.5;
/// Part of the residual that is due to vectors given up counts this many times less: each is
/// below the tolerance when it is given up, but they add up as copies are found.
const SLACK: f64 = 30.0;

/// Eigenvalues of `A x = λ M x` about a shift `σ`, with `A` symmetric and `M` symmetric positive
/// semidefinite, from solves with `A − σM`.
///
/// Lanczos iteration with `(A − σM)⁻¹M` in the inner product of `M`, fully reorthogonalised, with
/// thick restarts (Wu & Simon 2000). The projected matrix comes from the orthogonalisation itself,
/// so that a random vector can be put into the basis at any time; that is how copies of multiple
/// eigenvalues are found, which one starting vector never sees. Every eigenvector is improved by a
/// last inverse iteration, which frees it from the null space of `M` and measures its residual
/// (Nour-Omid, Parlett, Ericsson & Jensen 1987). Nothing is allocated between calls unless more
/// eigenvalues are wanted than ever before.
///
/// # Example
/// ```
/// use continuation::linalg::{Lanczos, Matrix, SymmetricBand};
/// let n = 100; // the second difference
/// let mut a = SymmetricBand::new(n, 1);
/// for i in 0..n {
///     a.add(i, i, 2.0);
///     if i > 0 { a.add(i, i - 1, -1.0); }
/// }
/// let facts = a.factor(0.0);
/// let below = facts.inertia.map(|(negative, _)| negative);
/// let mut lanczos = Lanczos::new(n, 3);
/// let identity = |x: &[f64], y: &mut [f64]| y.copy_from_slice(x);
/// let report = lanczos.lowest(0.0, below, identity, |x| a.solve(x), None);
/// assert!(report.complete);
/// let exact = 2.0 - 2.0 * (3.0 * std::f64::consts::PI / 101.0).cos();
/// assert!((lanczos.values()[2] - exact).abs() < 1e-14);
/// ```
///
/// # References
/// - K. Wu and H. Simon, Thick-restart Lanczos method for large symmetric eigenvalue problems,
///   *SIAM J. Matrix Anal. Appl.* 22 (2000) 602-616.
/// - B. Nour-Omid, B. N. Parlett, T. Ericsson and P. S. Jensen, How to implement the spectral
///   transformation, *Math. Comp.* 48 (1987) 663-673.
pub struct Lanczos {
    n: usize,
    k: usize,
    settings: EigenSettings,
    /// Number of eigenvalues there is room for.
    room: usize,
    capacity: usize,
    /// Vectors `0..m` have their column in `t`; vector `m` is the next one.
    m: usize,
    basis: Vec<f64>,
    mass_basis: Vec<f64>,
    t: Vec<f64>,
    /// Components of the images of the basis along next vectors that were given up for random
    /// ones, a row of `capacity` entries for each.
    lost: Vec<f64>,
    /// Component of the last vector's image along the next one, if that continues it.
    beta: f64,
    /// Whether the next vector continues the last one.
    chained: bool,
    small: SmallSymmetric,
    /// Ritz values by priority: the wanted ones first.
    ranking: Vec<usize>,
    w: Vec<f64>,
    u: Vec<f64>,
    rotated: Vec<f64>,
    noise: Noise,
    solves: usize,
    values: Vec<f64>,
    errors: Vec<f64>,
    converged: Vec<bool>,
    order: Vec<usize>,
    vectors: Vec<f64>,
}

/// Which eigenvalues are asked for, by those of the operator, `θ = 1/(λ − σ)`.
#[derive(Debug, Clone, Copy)]
enum Wanted {
    /// So many of largest magnitude.
    Nearest(usize),
    /// So many negative ones, and so many of the largest positive ones.
    Sides(usize, usize),
}

/// What the projected problem says.
struct Look {
    /// Number of wanted eigenvalues that the basis holds.
    available: usize,
    /// Number of those that converged.
    converged: usize,
    /// Largest residual of one of them relative to its tolerance.
    worst: f64,
}

impl Lanczos {
    /// Storage for `k` eigenvalues of pencils of dimension `n`, with the default settings.
    pub fn new(n: usize, k: usize) -> Self {
        let mut this = Self {
            n,
            k: k.min(n),
            settings: EigenSettings::default(),
            room: 0,
            capacity: 0,
            m: 0,
            basis: Vec::new(),
            mass_basis: Vec::new(),
            t: Vec::new(),
            lost: Vec::new(),
            beta: 0.0,
            chained: false,
            small: SmallSymmetric::new(0),
            ranking: Vec::new(),
            w: vec![0.0; n],
            u: vec![0.0; n],
            rotated: Vec::new(),
            noise: Noise::new(),
            solves: 0,
            values: Vec::new(),
            errors: Vec::new(),
            converged: Vec::new(),
            order: Vec::new(),
            vectors: Vec::new(),
        };
        this.reserve(k.min(n));
        this
    }

    /// The same with other settings.
    #[must_use]
    pub fn with_settings(mut self, settings: EigenSettings) -> Self {
        self.settings = settings;
        self
    }

    /// The `k` eigenvalues nearest to `shift`, nearest first.
    ///
    /// `mass(x, y)` sets `y = M x`, `solve(x)` replaces `x` by `(A − σM)⁻¹x`. A `start` vector
    /// near the wanted eigenvectors saves a few solves: see [`Lanczos::blend`].
    pub fn nearest(
        &mut self,
        shift: f64,
        mass: impl FnMut(&[f64], &mut [f64]),
        solve: impl FnMut(&mut [f64]),
        start: Option<&[f64]>,
    ) -> EigenReport {
        self.run(shift, Wanted::Nearest(self.k), false, mass, solve, start)
    }

    /// The `k` lowest eigenvalues, and all that lie below `shift`, in ascending order.
    ///
    /// `below` is the number of eigenvalues below the shift, known from the inertia of
    /// `A − σM` (less one for every multiplier whose row of `M` is zero). All of them are found,
    /// and the next above the shift to make up `k`; the count proves that none below is missing.
    /// Without it the `k` nearest to the shift are returned, in ascending order. The other
    /// arguments are those of [`Lanczos::nearest`].
    pub fn lowest(
        &mut self,
        shift: f64,
        below: Option<usize>,
        mass: impl FnMut(&[f64], &mut [f64]),
        solve: impl FnMut(&mut [f64]),
        start: Option<&[f64]>,
    ) -> EigenReport {
        let wanted = match below {
            None => Wanted::Nearest(self.k),
            Some(below) => {
                let below = below.min(self.n);
                Wanted::Sides(below, self.k.saturating_sub(below))
            }
        };
        self.run(shift, wanted, true, mass, solve, start)
    }

    /// The eigenvalues found by the latest call.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Eigenvector of value `i`, of length one in the norm of `M`.
    pub fn vector(&self, i: usize) -> &[f64] {
        &self.vectors[self.order[i] * self.n..][..self.n]
    }

    /// Bounds of the errors of the values, from residuals and from the distances to the other
    /// values; the rounding of the solves comes on top.
    pub fn errors(&self) -> &[f64] {
        &self.errors
    }

    /// Whether value `i` met the tolerance.
    pub fn is_converged(&self, i: usize) -> bool {
        self.converged[i]
    }

    /// The sum of the eigenvectors found, a good start at a neighbouring point.
    pub fn blend(&self, out: &mut [f64]) {
        out.fill(0.0);
        for i in 0..self.values.len() {
            add_scaled(out, 1.0, self.vector(i));
        }
    }

    fn run(
        &mut self,
        shift: f64,
        wanted: Wanted,
        ascending: bool,
        mut mass: impl FnMut(&[f64], &mut [f64]),
        mut solve: impl FnMut(&mut [f64]),
        start: Option<&[f64]>,
    ) -> EigenReport {
        let count = match wanted {
            Wanted::Nearest(k) => k,
            Wanted::Sides(below, above) => (below + above).min(self.n),
        };
        self.reserve(count);
        let complete = self.iterate(wanted, count, &mut mass, &mut solve, start);
        self.finish(wanted, shift, &mut mass, &mut solve);
        self.sort(shift, ascending);
        let converged = self.converged.iter().filter(|c| **c).count();
        let complete = complete && converged == self.values.len();
        EigenReport { solves: self.solves, wanted: count, converged, complete }
    }

    /// The first vector of a new basis; false where there is none, or none is wanted.
    fn begin(
        &mut self,
        count: usize,
        mass: &mut impl FnMut(&[f64], &mut [f64]),
        solve: &mut impl FnMut(&mut [f64]),
        start: Option<&[f64]>,
    ) -> bool {
        (self.m, self.solves, self.noise) = (0, 0, Noise::new());
        (self.chained, self.beta) = (false, 0.0);
        self.lost.clear();
        if count == 0 {
            return false;
        }
        // One application in advance: if a single eigenvalue dominates, as at a fold, the first
        // vector is its eigenvector and its size does not drown the others.
        match start {
            Some(start) => self.w.copy_from_slice(start),
            None => self.noise.fill(&mut self.w),
        }
        mass(&self.w, &mut self.u);
        self.w.copy_from_slice(&self.u);
        solve(&mut self.w);
        self.solves = 1;
        self.append(false, mass).is_some() || self.append_random(mass)
    }

    /// Builds the basis; returns whether nothing wanted is missing.
    fn iterate(
        &mut self,
        wanted: Wanted,
        count: usize,
        mass: &mut impl FnMut(&[f64], &mut [f64]),
        solve: &mut impl FnMut(&mut [f64]),
        start: Option<&[f64]>,
    ) -> bool {
        if !self.begin(count, mass, solve, start) {
            return true; // no mass, no eigenvalues
        }
        let (mut check, mut last_break) = ((count + 3).max(4), 0);
        let mut probe: Option<usize> = None;
        let (mut score, mut attempts) = (f64::INFINITY, 0);
        loop {
            let continued = self.expand(mass, solve);
            let full = self.m == self.capacity;
            let stop = self.solves >= self.settings.max_solves;
            if self.m < check && continued && !full && !stop {
                continue;
            }
            let Some(look) = self.look(wanted, count) else { return false };
            if self.m == self.n {
                return self.all_seen(wanted);
            }
            check = self.m + if probe.is_some() { 2 } else { steps(look.worst) };
            let enough = look.available == count;
            let converged = look.converged == look.available;
            if converged && enough && !self.to_be_probed(wanted) {
                return matches!(wanted, Wanted::Sides(..));
            }
            let found = self.score(look.available) > score + FOUND;
            if let Some(first) = probe {
                let over = converged && enough && !found && self.m >= first + PROBE;
                if over && self.settled(wanted, look.available) {
                    return true;
                }
            }
            if stop {
                return false;
            }
            let late = self.solves >= last_break + (PATIENCE << attempts);
            if converged && (if enough { probe.is_none() || found } else { late && continued }) {
                attempts += usize::from(!enough);
                if attempts > ATTEMPTS {
                    return false;
                }
                self.restart(look.available, false);
                (probe, last_break) = (Some(self.m), self.solves);
                score = self.score(look.available);
                check = self.m + PROBE;
                if !self.append_random(mass) {
                    return self.all_seen(wanted);
                }
                continue;
            }
            if !continued && !self.append_random(mass) {
                return self.all_seen(wanted);
            }
            if full {
                let keep = look.available + (self.capacity - look.available) / 3;
                self.restart(keep.min(self.capacity - 2), true);
                probe = probe.map(|_| self.m);
                check = self.m + 4;
            }
        }
    }

    /// Whether copies of the wanted eigenvalues are to be searched for.
    fn to_be_probed(&self, wanted: Wanted) -> bool {
        self.settings.complete && !matches!(wanted, Wanted::Sides(_, 0))
    }

    /// With a basis of the whole space: whether it holds what should be there.
    fn all_seen(&self, wanted: Wanted) -> bool {
        match wanted {
            Wanted::Nearest(_) => true,
            Wanted::Sides(below, _) => {
                (0..self.small.len()).filter(|&i| self.small.value(i) < 0.0).count() == below
            }
        }
    }

    /// Solves the projected problem and ranks its eigenvalues; `None` if it is not finite.
    fn look(&mut self, wanted: Wanted, count: usize) -> Option<Look> {
        if !self.small.decompose(&self.t, self.capacity, 0, self.m) {
            return None;
        }
        let available = self.rank(wanted).min(count);
        let (mut converged, mut worst) = (0, 0.0);
        for r in 0..available {
            let i = self.ranking[r];
            let excess = self.excess(i);
            converged += usize::from(excess <= 1.0);
            worst = f64::max(worst, excess);
        }
        Some(Look { available, converged, worst })
    }

    /// Sorts the Ritz values by priority and returns how many wanted ones there are.
    fn rank(&mut self, wanted: Wanted) -> usize {
        let small = &self.small;
        let m = small.len();
        let count = |side: f64| (0..m).filter(|&i| side * small.value(i) > 0.0).count();
        // values ascend: those wanted by side are the first and the last
        let (first, last) = match wanted {
            Wanted::Nearest(_) => (0, m),
            Wanted::Sides(below, above) => (count(-1.0).min(below), m - count(1.0).min(above)),
        };
        let rest = |i: usize| i >= first && i < last;
        // where the next negative one will come from
        let missing = matches!(wanted, Wanted::Sides(below, _) if first < below);
        self.ranking.clear();
        self.ranking.extend(0..m);
        self.ranking.sort_unstable_by(|&i, &j| {
            let size = small.value(j).abs().total_cmp(&small.value(i).abs());
            let size = if missing && rest(i) { i.cmp(&j) } else { size };
            rest(i).cmp(&rest(j)).then(size)
        });
        match wanted {
            Wanted::Nearest(k) => k.min(m),
            Wanted::Sides(..) => first + m - last,
        }
    }

    /// Residual of Ritz vector `i` along the next vector, and a bound of that along the vectors
    /// that were given up.
    fn residual(&self, i: usize) -> (f64, f64) {
        let lost = |row: &[f64]| {
            let terms = row[..self.m].iter().enumerate();
            terms.map(|(j, b)| b * self.small.component(i, j)).sum::<f64>().abs()
        };
        let next = self.beta * self.small.component(i, self.m - 1).abs();
        (next, self.lost.chunks_exact(self.capacity).map(lost).sum())
    }

    /// Residual of Ritz vector `i` relative to the tolerance; converged if at most 1.
    fn excess(&self, i: usize) -> f64 {
        let (next, lost) = self.residual(i);
        (next + lost / SLACK) / (self.settings.tolerance * self.small.value(i).abs())
    }

    /// Sum of the logarithms of the wanted eigenvalues of the operator: grows when a copy takes
    /// the place of a smaller one.
    fn score(&self, available: usize) -> f64 {
        self.ranking[..available].iter().map(|&i| self.small.value(i).abs().ln()).sum()
    }

    /// Whether the largest eigenvalue beside the wanted ones, all of them converged, is known well
    /// enough to say that it is none of them.
    fn settled(&self, wanted: Wanted, available: usize) -> bool {
        let value = |i: usize| match wanted {
            Wanted::Nearest(_) => self.small.value(i).abs(),
            Wanted::Sides(..) => self.small.value(i),
        };
        let sizes = self.ranking[..available].iter().map(|&i| value(i));
        let least = sizes.filter(|v| *v > 0.0).fold(f64::INFINITY, f64::min);
        self.ranking.get(available).is_some_and(|&i| {
            let (next, lost) = self.residual(i);
            // or it is a copy of the least wanted one, beyond what was asked for
            let margin = (MARGIN * (least - value(i))).max(self.settings.tolerance * least);
            next + lost / SLACK <= margin
        })
    }
}

/// Steps until the next look: a decade and a half per step is fast.
fn steps(worst: f64) -> usize {
    ((worst.max(1.0).log10() / 1.5) as usize).clamp(1, 6)
}
