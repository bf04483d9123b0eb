//! Krylov-Schur iteration for an operator that is not symmetric, real or complex.

use faer::{Mat, c64};

use super::eigen::{EigenSettings, Noise};
use super::scalar::{Scalar, eigen, norm};

/// Least number of steps from a random vector after which a search for copies may end.
const PROBE: usize = 10;
/// Increase of the score from which on a search has found something.
const FOUND: f64 = 1e-6;
/// Part of the residual that is due to vectors given up counts this many times less: each is
/// below the tolerance when it is given up, but they mix as copies are found.
const SLACK: f64 = 30.0;
/// Residual of an unwanted eigenvalue, relative to its distance from the wanted ones, at which a
/// search ends.
const MARGIN: f64 = 0.02;
/// Passes of Gram-Schmidt after which a vector counts as dependent.
const PASSES: usize = 4;
/// Basis vectors beyond the wanted ones.
const ROOM: usize = 24;
/// An eigenvalue of the operator below this part of the largest is zero: an infinite eigenvalue
/// of the pencil.
const INFINITE: f64 = 1e-14;
/// Part of an eigenvector that must be new for it to enter a basis; below it rounding would spoil
/// the space.
const DEPENDENT: f64 = 1e-5;
/// Distance of conjugates from each other's mirror image, relative to their imaginary part.
const CONJUGATE: f64 = 0.1;

/// An eigenvector of the operator, of length one.
pub(super) struct Ritz {
    pub(super) theta: c64,
    pub(super) vector: Vec<c64>,
    /// Error of `theta` relative to it.
    pub(super) error: f64,
    pub(super) converged: bool,
}

/// Outcome of [`dominant`].
pub(super) struct Dominant {
    pub(super) ritz: Vec<Ritz>,
    pub(super) applications: usize,
    pub(super) complete: bool,
}

/// The `k` eigenvalues of largest magnitude of the operator that `apply` replaces a vector by its
/// image under; one more if that would leave out a conjugate.
pub(super) fn dominant<T: Scalar>(
    n: usize,
    k: usize,
    settings: &EigenSettings,
    apply: impl FnMut(&mut [T]),
    start: Option<&[T]>,
) -> Dominant {
    let capacity = (2 * k + ROOM).min(n);
    let mut krylov = Krylov {
        n,
        k: k.min(n),
        settings,
        apply,
        capacity,
        m: 0,
        basis: Vec::with_capacity(capacity + 1),
        h: vec![T::ZERO; (capacity + 1) * capacity],
        lost: Vec::new(),
        beta: 0.0,
        chained: false,
        noise: Noise::new(),
        applications: 0,
    };
    let complete = krylov.iterate(start);
    let ritz = krylov.finish();
    let complete = complete && ritz.iter().all(|r| r.converged);
    Dominant { ritz, applications: krylov.applications, complete }
}

struct Krylov<'a, T, F> {
    n: usize,
    k: usize,
    settings: &'a EigenSettings,
    apply: F,
    capacity: usize,
    /// Vectors `0..m` have their column in `h`; vector `m` is the next one.
    m: usize,
    basis: Vec<Vec<T>>,
    /// Projected operator, columns of length `capacity + 1`.
    h: Vec<T>,
    /// Rows that the projected operator had when a next vector was given up for a random one:
    /// the images' components along that vector, which the basis lacks.
    lost: Vec<Vec<T>>,
    /// Component of the last vector's image along the next one, if that continues it.
    beta: f64,
    /// Whether the next vector continues the last one.
    chained: bool,
    noise: Noise,
    applications: usize,
}

/// Eigenvalues of the projected operator, by magnitude.
struct Look {
    theta: Vec<c64>,
    vectors: Mat<c64>,
    /// Residual along the next vector, and a bound of that along the vectors given up.
    next: Vec<f64>,
    lost: Vec<f64>,
    wanted: usize,
    converged: usize,
}

impl<T: Scalar, F: FnMut(&mut [T])> Krylov<'_, T, F> {
    /// Builds the basis; returns whether nothing wanted is missing.
    fn iterate(&mut self, start: Option<&[T]>) -> bool {
        if self.k == 0 {
            return true;
        }
        let mut w = vec![T::ZERO; self.n];
        match start {
            Some(start) => w.copy_from_slice(start),
            None => T::fill(&mut w, |x| self.noise.fill(x)),
        }
        // in advance: out of the null space of a mass matrix, into the dominant direction
        (self.apply)(&mut w);
        self.applications = 1;
        if self.append(w, false).is_none() && !self.append_random() {
            return false;
        }
        let mut check = (self.k + 4).max(6);
        let (mut probe, mut score): (Option<usize>, f64) = (None, f64::INFINITY);
        loop {
            let continued = self.expand();
            let full = self.m == self.capacity;
            let stop = self.applications >= self.settings.max_solves;
            if self.m < check && continued && !full && !stop {
                continue;
            }
            check = self.m + 3;
            let Some(look) = self.look() else { return false };
            if self.m == self.n {
                return true;
            }
            let done = look.wanted >= self.k && look.converged == look.wanted;
            if done && !self.settings.complete {
                return false; // not searched
            }
            let now = look.score(self.k);
            if done && let Some(first) = probe {
                let quiet = now <= score + FOUND && self.m >= first + PROBE;
                if quiet && look.settled(self.settings.tolerance) {
                    return true;
                }
            }
            if stop {
                return false;
            }
            if done && (probe.is_none() || now > score + FOUND) {
                self.restart(&look, look.wanted, false);
                (probe, score) = (Some(self.m), now);
                check = self.m + PROBE;
                if !self.append_random() {
                    return true;
                }
                continue;
            }
            if !continued && !self.append_random() {
                return true; // an invariant space, and there is nothing else
            }
            if full {
                let keep = look.wanted + (self.capacity.saturating_sub(look.wanted)) / 3;
                self.restart(&look, keep, true);
                probe = probe.map(|_| self.m);
                check = self.m + 4;
            }
        }
    }

    /// Applies the operator to the next vector; false if the space is invariant.
    fn expand(&mut self) -> bool {
        let (j, ld) = (self.m, self.capacity + 1);
        let mut w = self.basis[j].clone();
        (self.apply)(&mut w);
        self.applications += 1;
        self.h[j * ld..(j + 1) * ld].fill(T::ZERO);
        self.m += 1;
        let rest = self.append(w, true);
        self.beta = rest.unwrap_or(0.0);
        self.lost.iter_mut().for_each(|row| row.push(T::ZERO));
        if let Some(rest) = rest {
            self.h[j * ld + j + 1] = T::real(rest);
        }
        self.chained = rest.is_some();
        self.chained
    }

    /// Orthogonalises `w` against the basis and appends it; its norm before normalisation, `None`
    /// if nothing is left of it. The coefficients go into the last column if it is `open`.
    fn append(&mut self, mut w: Vec<T>, open: bool) -> Option<f64> {
        let (m, ld) = (self.m, self.capacity + 1);
        self.basis.truncate(m);
        for _ in 0..=PASSES {
            let mut removed = 0.0;
            for i in 0..m {
                let h = T::dot(&self.basis[i], &w);
                T::add_scaled(&mut w, T::ZERO - h, &self.basis[i]);
                removed += h.square();
                if open {
                    let entry = &mut self.h[i + (m - 1) * ld];
                    *entry = *entry + h;
                }
            }
            let length = norm(&w);
            if !(length > 0.0 && length.is_finite()) || m == self.n {
                return None;
            }
            if length * length >= removed {
                let inverse = T::real(1.0 / length);
                w.iter_mut().for_each(|w| *w = *w * inverse);
                self.basis.push(w);
                return Some(length);
            }
        }
        None
    }

    /// Makes a random vector the next one; false if the basis spans the whole space already.
    fn append_random(&mut self) -> bool {
        let mut w = vec![T::ZERO; self.n];
        T::fill(&mut w, |x| self.noise.fill(x));
        self.chained = false;
        self.m < self.n && self.append(w, false).is_some()
    }

    fn look(&self) -> Option<Look> {
        let m = self.m;
        let ld = self.capacity + 1;
        let (values, vectors) = eigen(m, |i, j| self.h[i + j * ld].complex())?;
        let mut rest: Vec<usize> = (0..m).collect();
        rest.sort_by(|&i, &j| values[j].norm().total_cmp(&values[i].norm()));
        let mut theta = Vec::with_capacity(m);
        let mut sorted = Mat::zeros(m, m);
        let mut add = |value: c64, i: usize, conjugate: bool| {
            let turn = |z: c64| if conjugate { z.conj() } else { z };
            (0..m).for_each(|k| sorted[(k, theta.len())] = turn(vectors[(k, i)]));
            theta.push(value);
        };
        while !rest.is_empty() {
            let i = rest.remove(0);
            let value = values[i];
            let mirror = |j: usize| (values[j] - value.conj()).norm();
            let partner = (0..rest.len()).min_by(|&a, &b| {
                mirror(rest[a]).total_cmp(&mirror(rest[b])) // conjugates side by side
            });
            match partner {
                _ if !T::REAL => add(value, i, false),
                Some(at) if mirror(rest[at]) <= CONJUGATE * value.im.abs() => {
                    let mean = 0.5 * (value + values[rest.remove(at)].conj());
                    let upper = mean.im > 0.0;
                    let mean = if upper { mean } else { mean.conj() };
                    add(mean, i, !upper);
                    add(mean.conj(), i, upper);
                }
                _ => add(c64::new(value.re, 0.0), i, false),
            }
        }
        let vectors = sorted;
        let next = (0..m).map(|j| self.beta * vectors[(m - 1, j)].norm()).collect();
        let part = |row: &Vec<T>, j: usize| -> f64 {
            let terms = row.iter().enumerate().map(|(i, b)| b.complex() * vectors[(i, j)]);
            terms.sum::<c64>().norm()
        };
        let lost = (0..m).map(|j| self.lost.iter().map(|row| part(row, j)).sum()).collect();
        let mut look = Look { theta, vectors, next, lost, wanted: 0, converged: 0 };
        look.wanted = look.whole_pairs::<T>(self.k.min(m));
        let tolerance = self.settings.tolerance;
        look.converged = (0..look.wanted).filter(|&i| look.is_converged(i, tolerance)).count();
        Some(look)
    }

    /// Replaces the basis by one of the space of the first `keep` eigenvectors. The next vector
    /// stays the next one, unless it is to be replaced.
    fn restart(&mut self, look: &Look, keep: usize, stays: bool) {
        let (m, ld) = (self.m, self.capacity + 1);
        let keep = look.whole_pairs::<T>(keep.min(m)).min(self.capacity.saturating_sub(2).max(1));
        let mut q: Vec<Vec<T>> = Vec::with_capacity(keep + 1);
        for j in 0..keep {
            if T::REAL && look.theta[j].im < 0.0 {
                continue; // its conjugate gave both parts
            }
            let s: Vec<c64> = (0..m).map(|i| look.vectors[(i, j)]).collect();
            // of a real eigenvalue one part is enough: the other is noise or another copy
            let most = q.len() + if T::REAL && look.theta[j].im == 0.0 { 1 } else { 2 };
            T::parts(&s, |mut part| {
                for _ in 0..2 {
                    for q in &q {
                        let h = T::dot(q, &part);
                        T::add_scaled(&mut part, T::ZERO - h, q);
                    }
                }
                let after = norm(&part);
                if after > DEPENDENT && q.len() < most {
                    part.iter_mut().for_each(|p| *p = *p * T::real(1.0 / after));
                    q.push(part);
                }
            });
        }
        let p = q.len();
        let rotated = |from: &[Vec<T>]| -> Vec<Vec<T>> {
            let combine = |q: &Vec<T>| {
                let mut v = vec![T::ZERO; self.n];
                from.iter().zip(q).for_each(|(from, q)| T::add_scaled(&mut v, *q, from));
                v
            };
            q.iter().map(combine).collect()
        };
        let next = self.basis.get(m).cloned();
        let mut basis = rotated(&self.basis[..m]);
        basis.extend(next);
        // H Q, then Qᴴ H Q and the row of the next vector
        let mut h = vec![T::ZERO; ld * self.capacity];
        for (j, qj) in q.iter().enumerate() {
            let mut hq = vec![T::ZERO; m];
            for (i, value) in qj.iter().enumerate() {
                T::add_scaled(&mut hq, *value, &self.h[i * ld..i * ld + m]);
            }
            for (i, qi) in q.iter().enumerate() {
                h[i + j * ld] = T::dot(qi, &hq);
            }
        }
        let row = |b: &[T]| -> Vec<T> {
            let product = |qj: &Vec<T>| b.iter().zip(qj).fold(T::ZERO, |s, (b, q)| s + *b * *q);
            q.iter().map(product).collect()
        };
        let mut lost: Vec<Vec<T>> = self.lost.iter().map(|b| row(b)).collect();
        if self.chained {
            let mut last = vec![T::ZERO; m];
            last[m - 1] = T::real(self.beta);
            let last = row(&last);
            if stays {
                last.iter().enumerate().for_each(|(j, b)| h[p + j * ld] = *b);
            } else {
                lost.push(last);
            }
        }
        (self.basis, self.h, self.lost, self.beta) = (basis, h, lost, 0.0);
        self.m = p;
        self.chained = false;
    }

    /// Eigenvectors, improved by one application of the operator, and error estimates.
    fn finish(&mut self) -> Vec<Ritz> {
        let Some(look) = (self.m > 0).then(|| self.look()).flatten() else {
            return Vec::new();
        };
        let m = self.m;
        let conditions = conditions(&look.vectors);
        let mut accepted: Vec<Vec<c64>> = Vec::new();
        let mut out: Vec<Ritz> = Vec::new();
        for j in 0..look.wanted {
            let theta = look.theta[j];
            if theta.norm() <= INFINITE * look.theta[0].norm() {
                break;
            }
            let conjugate = out
                .last()
                .filter(|last| T::REAL && theta.im < 0.0 && last.theta == theta.conj())
                .map(|last| Ritz {
                    theta,
                    vector: last.vector.iter().map(|x| x.conj()).collect(),
                    error: last.error,
                    converged: last.converged,
                });
            let ritz = match conjugate {
                Some(ritz) => ritz,
                None => {
                    let mut x = vec![c64::ZERO; self.n];
                    for i in 0..m {
                        let s = look.vectors[(i, j)];
                        x.iter_mut().zip(&self.basis[i]).for_each(|(x, v)| *x += v.complex() * s);
                    }
                    let parts = self.parts(&x, &accepted, theta.im == 0.0);
                    x = compose(&parts);
                    let y = compose(&self.images(parts));
                    // What rounding added along vectors of larger eigenvalues is no residual.
                    let mut d: Vec<c64> = y.iter().zip(&x).map(|(y, x)| y - theta * x).collect();
                    let measured = remainder(&mut d, &accepted) / theta.norm();
                    x.iter_mut().zip(&d).for_each(|(x, d)| *x = theta * *x + d);
                    let length = norm(&x);
                    x.iter_mut().for_each(|x| *x /= length);
                    let noise = f64::EPSILON * look.theta[0].norm() / theta.norm();
                    let estimate = (look.next[j] + look.lost[j]) / theta.norm();
                    Ritz {
                        theta,
                        vector: x,
                        error: (measured.max(estimate) + noise) * conditions[j],
                        converged: look.is_converged(j, self.settings.tolerance),
                    }
                }
            };
            let mut q = ritz.vector.clone();
            let length = remainder(&mut q, &accepted);
            if length > DEPENDENT {
                q.iter_mut().for_each(|q| *q /= length);
                accepted.push(q);
            }
            out.push(ritz);
        }
        out
    }

    /// The real and the imaginary part of an eigenvector, the phase chosen; of a `single` one, of
    /// a real eigenvalue, the part that is new beside those accepted.
    fn parts(&self, x: &[c64], accepted: &[Vec<c64>], single: bool) -> Vec<Vec<T>> {
        let mut parts = Vec::new();
        T::parts(x, |part| parts.push(part));
        if T::REAL && single {
            let new = |part: &Vec<T>| {
                let mut part: Vec<c64> = part.iter().map(|p| p.complex()).collect();
                remainder(&mut part, accepted)
            };
            let imaginary = parts.pop();
            if let (Some(re), Some(im)) = (parts.first_mut(), imaginary)
                && new(&im) > new(re)
            {
                *re = im;
            }
            for part in &mut parts {
                let inverse = T::real(1.0 / norm(part));
                part.iter_mut().for_each(|p| *p = *p * inverse);
            }
        }
        parts
    }

    fn images(&mut self, mut parts: Vec<Vec<T>>) -> Vec<Vec<T>> {
        for part in &mut parts {
            (self.apply)(part);
            self.applications += 1;
        }
        parts
    }
}

/// The complex vector of these parts.
fn compose<T: Scalar>(parts: &[Vec<T>]) -> Vec<c64> {
    let mut out = vec![c64::ZERO; parts.first().map_or(0, Vec::len)];
    for (part, factor) in parts.iter().zip([c64::new(1.0, 0.0), c64::new(0.0, 1.0)]) {
        out.iter_mut().zip(part).for_each(|(x, p)| *x += factor * p.complex());
    }
    out
}

/// Removes the parts along an orthonormal basis and returns the length of what is left.
fn remainder(x: &mut [c64], basis: &[Vec<c64>]) -> f64 {
    for q in basis {
        let h = c64::dot(q, x);
        c64::add_scaled(x, -h, q);
    }
    norm(x)
}

impl Look {
    /// `count`, or one more if that leaves out the conjugate of the last one.
    fn whole_pairs<T: Scalar>(&self, count: usize) -> usize {
        let cut =
            T::REAL && count > 0 && count < self.theta.len() && self.theta[count - 1].im > 0.0;
        count + usize::from(cut)
    }

    fn is_converged(&self, i: usize, tolerance: f64) -> bool {
        self.next[i] + self.lost[i] / SLACK <= tolerance * self.theta[i].norm()
    }

    /// Whether the largest eigenvalue beside the wanted ones, all of them converged, is known well
    /// enough to say that it is none of them.
    fn settled(&self, tolerance: f64) -> bool {
        let (least, i) = (self.theta[self.wanted - 1].norm(), self.wanted);
        self.theta.get(i).is_some_and(|candidate| {
            let residual = self.next[i] + self.lost[i] / SLACK;
            // or it is a copy of the least wanted one, beyond what was asked for
            residual <= (MARGIN * (least - candidate.norm())).max(tolerance * least)
        })
    }

    /// Sum of the logarithms of the first `k` eigenvalues: grows when a copy takes the place of a
    /// smaller one.
    fn score(&self, k: usize) -> f64 {
        self.theta[..k.min(self.theta.len())].iter().map(|t| t.norm().ln()).sum()
    }
}

/// Condition numbers of the eigenvalues from the matrix of eigenvectors of length one.
fn conditions(vectors: &Mat<c64>) -> Vec<f64> {
    use faer::linalg::solvers::DenseSolveCore;
    let m = vectors.nrows();
    let inverse = vectors.partial_piv_lu().inverse();
    (0..m).map(|i| (0..m).map(|j| inverse[(i, j)].norm_sqr()).sum::<f64>().sqrt()).collect()
}
