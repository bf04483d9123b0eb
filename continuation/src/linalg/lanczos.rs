//! Shift-invert Lanczos for symmetric pencils.

use super::eigen::{EigenReport, EigenSettings, Noise, SmallSymmetric};
use super::vector::{add_scaled, dot};

/// Increase of [`Lanczos::score`] from which on a search has found something.
const FOUND: f64 = 1e-6;
/// Least number of steps from a random vector after which a search for copies may end.
const PROBE: usize = 6;
/// Solves that may pass without a missing eigenvalue before a random vector is tried, for the
/// first time; twice as many for the next ones.
const PATIENCE: usize = 20;
/// Random vectors tried for missing eigenvalues before they are given up.
const ATTEMPTS: usize = 3;
/// Relative residual at which a vector that is not wanted stays in the basis for a search.
const NEARLY: f64 = 1e-3;
/// Passes of Gram-Schmidt after which a vector counts as dependent.
const PASSES: usize = 5;
/// Basis vectors beyond the wanted ones.
const ROOM: usize = 30;
/// Coordinates that are rotated at a time in a restart.
const CHUNK: usize = 64;

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
    /// Norm of the part of the operator's action on a vector that lies outside of the basis.
    leak: Vec<f64>,
    /// Whether the next vector continues the last one.
    chained: bool,
    small: SmallSymmetric,
    probe: SmallSymmetric,
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
            leak: Vec::new(),
            chained: false,
            small: SmallSymmetric::new(0),
            probe: SmallSymmetric::new(0),
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

    fn reserve(&mut self, wanted: usize) {
        if wanted <= self.room && self.capacity > 0 {
            return;
        }
        self.room = wanted;
        let capacity = (2 * wanted + ROOM).min(self.n);
        let n = self.n;
        self.capacity = capacity;
        self.basis = vec![0.0; (capacity + 1) * n];
        self.mass_basis = vec![0.0; (capacity + 1) * n];
        self.t = vec![0.0; capacity * capacity];
        self.leak = vec![0.0; capacity];
        self.small = SmallSymmetric::new(capacity);
        self.probe = SmallSymmetric::new(capacity);
        self.ranking = Vec::with_capacity(capacity);
        self.rotated = vec![0.0; capacity * CHUNK];
        for list in [&mut self.values, &mut self.errors] {
            *list = Vec::with_capacity(wanted);
        }
        self.converged = Vec::with_capacity(wanted);
        self.order = Vec::with_capacity(wanted);
        self.vectors = vec![0.0; wanted * n];
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

    /// Builds the basis; returns whether nothing wanted is missing.
    fn iterate(
        &mut self,
        wanted: Wanted,
        count: usize,
        mass: &mut impl FnMut(&[f64], &mut [f64]),
        solve: &mut impl FnMut(&mut [f64]),
        start: Option<&[f64]>,
    ) -> bool {
        (self.m, self.solves, self.noise, self.chained) = (0, 0, Noise::new(), false);
        if count == 0 {
            return true;
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
        if self.append(false, mass).is_none() && !self.append_random(mass) {
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
            check = self.m + if probe.is_some() { 2 } else { steps(look.worst) };
            let enough = look.available == count;
            let converged = look.converged == look.available;
            if converged && enough && !self.to_be_probed(wanted) {
                return matches!(wanted, Wanted::Sides(..));
            }
            let found = self.score(look.available) > score + FOUND;
            if let Some(first) = probe {
                let over = converged && enough && !found && self.m >= first + PROBE;
                if over && self.settled(wanted, first, look.available) {
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
                let keep = self.settled_vectors(look.available);
                self.restart(keep, false);
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

    /// Applies the operator to the next vector, which gives a column of the projected matrix and
    /// the vector after it; false if there is none, the space being invariant.
    fn expand(
        &mut self,
        mass: &mut impl FnMut(&[f64], &mut [f64]),
        solve: &mut impl FnMut(&mut [f64]),
    ) -> bool {
        let (n, j, ld) = (self.n, self.m, self.capacity);
        self.w.copy_from_slice(&self.mass_basis[j * n..(j + 1) * n]);
        solve(&mut self.w);
        self.solves += 1;
        self.t[j * ld..][..=j].fill(0.0);
        if self.chained {
            self.leak[j - 1] = 0.0; // it went into this vector
        }
        self.m += 1;
        let rest = self.append(true, mass);
        self.leak[j] = rest.unwrap_or(0.0);
        for i in 0..j {
            self.t[j + i * ld] = self.t[i + j * ld];
        }
        self.chained = rest.is_some();
        self.chained
    }

    /// Orthogonalises `w` against the basis and appends it; its norm before normalisation, `None`
    /// if nothing is left of it. The coefficients go into the last column if it is `open`.
    fn append(&mut self, open: bool, mass: &mut impl FnMut(&[f64], &mut [f64])) -> Option<f64> {
        let (n, m, ld) = (self.n, self.m, self.capacity);
        let mut first = if open && self.chained { m.saturating_sub(2) } else { 0 };
        for _ in 0..=PASSES {
            let mut removed = 0.0;
            for i in first..m {
                let h = dot(&self.mass_basis[i * n..(i + 1) * n], &self.w);
                add_scaled(&mut self.w, -h, &self.basis[i * n..(i + 1) * n]);
                removed += h * h;
                if open {
                    self.t[i + (m - 1) * ld] += h;
                }
            }
            if first > 0 {
                first = 0; // the bulk is gone, now all of them
                continue;
            }
            mass(&self.w, &mut self.u);
            let square = dot(&self.w, &self.u);
            if !(square > 0.0 && square.is_finite()) || m == self.n {
                return None;
            }
            if square >= removed {
                let norm = square.sqrt();
                let (v, mv) = (&mut self.basis[m * n..], &mut self.mass_basis[m * n..]);
                for i in 0..n {
                    v[i] = self.w[i] / norm;
                    mv[i] = self.u[i] / norm;
                }
                return Some(norm);
            }
        }
        None
    }

    /// Makes a random vector the next one; false if the basis spans the whole space already.
    fn append_random(&mut self, mass: &mut impl FnMut(&[f64], &mut [f64])) -> bool {
        self.noise.fill(&mut self.w);
        self.chained = false;
        self.m < self.n && self.append(false, mass).is_some()
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
            let excess = self.residual(i) / (self.settings.tolerance * self.small.value(i).abs());
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

    /// Bound of the residual of Ritz vector `i`.
    fn residual(&self, i: usize) -> f64 {
        (0..self.m).map(|j| (self.leak[j] * self.small.component(i, j)).abs()).sum()
    }

    /// Sum of the logarithms of the wanted eigenvalues of the operator: grows when a copy takes
    /// the place of a smaller one.
    fn score(&self, available: usize) -> f64 {
        self.ranking[..available].iter().map(|&i| self.small.value(i).abs().ln()).sum()
    }

    /// Whether the basis from vector `first` on, taken alone, has seen the largest eigenvalue it
    /// can see, and that is not a wanted one.
    fn settled(&mut self, wanted: Wanted, first: usize, available: usize) -> bool {
        let positive_only = matches!(wanted, Wanted::Sides(..));
        let size = |value: f64| if positive_only { value } else { value.abs() };
        let least = self.ranking[..available]
            .iter()
            .map(|&i| size(self.small.value(i)))
            .filter(|v| *v > 0.0)
            .fold(f64::INFINITY, f64::min);
        let m = self.m - first;
        if !self.probe.decompose(&self.t, self.capacity, first, m) {
            return false;
        }
        let ends = if positive_only { [m - 1, m - 1] } else { [0, m - 1] };
        ends.into_iter().all(|i| {
            let residual = self.leak[self.m - 1] * self.probe.component(i, m - 1).abs();
            residual <= 0.5 * (least - size(self.probe.value(i)))
        })
    }

    /// The wanted vectors and as many after them as have nearly converged. Rounding makes the
    /// later vectors of a chain see the copies; they must not stay when their successor is lost.
    fn settled_vectors(&self, available: usize) -> usize {
        let near = |&i: &usize| self.residual(i) <= NEARLY * self.small.value(i).abs();
        let most = self.m.min(self.capacity.saturating_sub(2 * PROBE)).max(available);
        available + self.ranking[available..most].iter().take_while(|i| near(i)).count()
    }

    /// Replaces the basis by the first `keep` Ritz vectors. The next vector stays the next one,
    /// unless it is to be replaced.
    fn restart(&mut self, keep: usize, stays: bool) {
        let (n, m, ld) = (self.n, self.m, self.capacity);
        let keep = keep.min(m);
        for vectors in [&mut self.basis, &mut self.mass_basis] {
            for from in (0..n).step_by(CHUNK) {
                let width = CHUNK.min(n - from);
                for (r, &i) in self.ranking[..keep].iter().enumerate() {
                    let target = &mut self.rotated[r * CHUNK..][..width];
                    target.fill(0.0);
                    for j in 0..m {
                        let v = &vectors[j * n + from..][..width];
                        add_scaled(target, self.small.component(i, j), v);
                    }
                }
                for r in 0..keep {
                    vectors[r * n + from..][..width]
                        .copy_from_slice(&self.rotated[r * CHUNK..][..width]);
                }
            }
            vectors.copy_within(m * n..(m + 1) * n, keep * n);
        }
        // what leaks into the next vector will appear in the next column
        if self.chained && stays {
            self.leak[m - 1] = 0.0;
        }
        for r in 0..keep {
            self.u[r] = self.residual(self.ranking[r]);
            self.w[r] = self.small.value(self.ranking[r]);
        }
        for r in 0..keep {
            self.leak[r] = self.u[r];
            self.t[r * ld..][..keep].fill(0.0);
            self.t[r * (ld + 1)] = self.w[r];
        }
        self.m = keep;
        self.chained = false; // to all of them, not to the last alone
    }

    /// Eigenvectors, improved by one inverse iteration, eigenvalues and their errors.
    fn finish(
        &mut self,
        wanted: Wanted,
        shift: f64,
        mass: &mut impl FnMut(&[f64], &mut [f64]),
        solve: &mut impl FnMut(&mut [f64]),
    ) {
        let n = self.n;
        for list in [&mut self.values, &mut self.errors] {
            list.clear();
        }
        self.converged.clear();
        self.order.clear();
        if self.m == 0 || !self.small.decompose(&self.t, self.capacity, 0, self.m) {
            return;
        }
        let found = self.rank(wanted).min(self.room);
        let small = &self.small;
        self.ranking[..found]
            .sort_unstable_by(|&i, &j| small.value(j).abs().total_cmp(&small.value(i).abs()));
        for (r, &i) in self.ranking[..found].iter().enumerate() {
            let x = &mut self.vectors[r * n..(r + 1) * n];
            x.fill(0.0);
            for j in 0..self.m {
                add_scaled(x, self.small.component(i, j), &self.basis[j * n..(j + 1) * n]);
            }
        }
        // M x takes the place of the basis
        for r in 0..found {
            let estimate = self.residual(self.ranking[r]);
            let ritz = self.small.value(self.ranking[r]);
            let x = &mut self.vectors[r * n..(r + 1) * n];
            let (done, rest) = self.mass_basis.split_at_mut(r * n);
            let mx = &mut rest[..n];
            mass(x, mx);
            let y = &mut self.w;
            y.copy_from_slice(mx);
            solve(y);
            self.solves += 1;
            // A vector of larger θ that rounding left in this one hardly matters there.
            for (i, mv) in done.chunks_exact(n).enumerate() {
                let h = dot(mv, y);
                add_scaled(y, -h, &self.basis[i * n..(i + 1) * n]);
            }
            let theta = dot(mx, y);
            x.iter_mut().zip(y.iter()).for_each(|(x, y)| *x = y - theta * *x);
            mass(x, &mut self.u);
            let residual = dot(x, &self.u).max(0.0);
            let length = (theta * theta + residual).sqrt();
            // x is the residual now, and M y = M x θ + M r
            for i in 0..n {
                mx[i] = (mx[i] * theta + self.u[i]) / length;
                x[i] = y[i] / length;
            }
            self.basis[r * n..(r + 1) * n].copy_from_slice(x);
            let relative = residual.sqrt() / theta.abs();
            let distance = theta / (theta * theta + residual);
            self.values.push(shift + distance);
            self.errors.push(distance.abs() * relative.min(self.sharpened(r, ritz, relative)));
            let measured = relative <= self.settings.tolerance;
            self.converged.push(measured || estimate <= self.settings.tolerance * ritz.abs());
            self.order.push(r);
        }
    }

    /// The quadratic bound of a relative error: residual² / gap, without the values that are as
    /// near as the residual.
    fn sharpened(&self, r: usize, ritz: f64, residual: f64) -> f64 {
        let gap = (0..self.small.len())
            .filter(|&i| i != self.ranking[r])
            .map(|i| (self.small.value(i) / ritz - 1.0).abs())
            .filter(|gap| *gap > residual)
            .fold(1.0, f64::min);
        residual * residual / gap
    }

    /// Puts values, errors and flags into order; the vectors stay where they are.
    fn sort(&mut self, shift: f64, ascending: bool) {
        let (values, found) = (&self.values, self.values.len());
        let key = |i: usize| if ascending { values[i] } else { (values[i] - shift).abs() };
        self.order.sort_unstable_by(|&i, &j| key(i).total_cmp(&key(j)));
        for (r, &i) in self.order.iter().enumerate() {
            self.w[r] = self.values[i];
            self.u[r] = self.errors[i];
            self.ranking[r] = usize::from(self.converged[i]);
        }
        self.values.copy_from_slice(&self.w[..found]);
        self.errors.copy_from_slice(&self.u[..found]);
        for (flag, r) in self.converged.iter_mut().zip(&self.ranking) {
            *flag = *r == 1;
        }
    }
}

/// Steps until the next look: a decade and a half per step is fast.
fn steps(worst: f64) -> usize {
    ((worst.max(1.0).log10() / 1.5) as usize).clamp(1, 6)
}
