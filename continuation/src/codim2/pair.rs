//! Null vectors of `f_u − iωM`, in real form: real and imaginary parts in turn.

use crate::any_problem::DynProblem;
use crate::linalg::{AnyMatrix, Bordered, Matrix};
use crate::step::dot;

/// Cosine between a border and the null vector below which the border is renewed.
const ALIGNED: f64 = 0.9;

/// The solution of `[A b; cᴴ 0] [v; g] = [0; 1]` with `A = f_u − iωM`, and that of the conjugate
/// transposed system.
#[derive(Clone)]
pub(super) struct PairNull {
    mass: AnyMatrix,
    bordered: Bordered,
    pub(super) right: Vec<f64>,
    pub(super) left: Vec<f64>,
    /// Real and imaginary parts of the null vectors.
    pub(super) parts: [Vec<f64>; 4],
    pub(super) g: [f64; 2],
    /// `wᴴ M v`.
    pub(super) product: [f64; 2],
    scratch: [Vec<f64>; 2],
}

/// Index of the real part of the right vector among [`PairNull::parts`]; its imaginary part and
/// the two of the left vector follow.
pub(super) const RIGHT: usize = 0;
/// Index of the real part of the left vector.
pub(super) const LEFT: usize = 2;

fn turned(x: &[f64], y: &mut [f64]) {
    for (x, y) in x.chunks_exact(2).zip(y.chunks_exact_mut(2)) {
        y.copy_from_slice(&[-x[1], x[0]]);
    }
}

impl PairNull {
    /// `None` where the matrix type knows no identity.
    pub(super) fn new(problem: &DynProblem<'_>) -> Option<Self> {
        let n = problem.dim();
        let mut mass = problem.new_jacobian();
        mass.set_zero();
        if !problem.mass(&mut mass) {
            mass.set_zero();
            if !mass.add_identity(1.0) {
                return None;
            }
        }
        let vector = || vec![0.0; n];
        let mut null = PairNull {
            mass,
            bordered: Bordered::new(2 * n, 2),
            right: (0..2 * n).map(|i| crate::singular::arbitrary(1, i)).collect(),
            left: (0..2 * n).map(|i| crate::singular::arbitrary(2, i)).collect(),
            parts: std::array::from_fn(|_| vector()),
            g: [0.0; 2],
            product: [0.0; 2],
            scratch: [vector(), vector()],
        };
        null.take();
        Some(null)
    }

    /// The larger one of the real and the imaginary part of the right vector.
    pub(super) fn larger_part(&self) -> &[f64] {
        let [a, b, ..] = &self.parts;
        if dot(a, a) >= dot(b, b) { a } else { b }
    }

    /// Solves for the null vectors; `None` where the matrix has no complex form, false where the
    /// result is not finite.
    pub(super) fn solve(&mut self, jacobian: &AnyMatrix, omega: f64) -> Option<bool> {
        let mut imaginary = self.mass.clone();
        imaginary.set_zero();
        imaginary.axpy(-omega, &self.mass);
        let mut matrix = jacobian.complex(&imaginary)?;
        self.bordered.factor(&mut matrix);
        let mut tail = [1.0, 0.0];
        self.left.fill(0.0);
        self.bordered.solve_transpose(&mut matrix, &mut self.left, &mut tail);
        tail = [1.0, 0.0];
        self.right.fill(0.0);
        self.bordered.solve(&mut matrix, &mut self.right, &mut tail);
        self.g = tail;
        let [a, b, c, d] = &mut self.parts;
        for (x, re, im) in [(&self.right, a, b), (&self.left, c, d)] {
            for (pair, (re, im)) in x.chunks_exact(2).zip(re.iter_mut().zip(im.iter_mut())) {
                (*re, *im) = (pair[0], pair[1]);
            }
        }
        let [a, b, c, d] = &self.parts;
        let [ma, mb] = &mut self.scratch;
        self.mass.mul(a, ma);
        self.mass.mul(b, mb);
        self.product = [dot(c, ma) + dot(d, mb), dot(c, mb) - dot(d, ma)];
        Some(self.right.iter().chain(&self.left).chain(&self.g).all(|x| x.is_finite()))
    }

    /// Replaces the borders where they are no longer near to the null vectors; whether it did.
    pub(super) fn renew(&mut self) -> bool {
        let cosine = |border: &[f64], null: &[f64]| {
            dot(border, null) / (dot(border, border) * dot(null, null)).sqrt()
        };
        let near = cosine(self.bordered.row(0), &self.right) > ALIGNED
            && cosine(self.bordered.column(0), &self.left) > ALIGNED;
        if !near {
            self.take();
        }
        !near
    }

    /// Replaces the borders by the null vectors, normalised and as real as their phase can make
    /// them: so `Im g` vanishes with `ω`, where they become real.
    pub(super) fn take(&mut self) {
        let PairNull { bordered, right, left, .. } = self;
        for x in [&mut *right, &mut *left] {
            let norm = dot(x, x).sqrt();
            let (mut re, mut im) = (0.0, 0.0);
            for z in x.chunks_exact(2) {
                re += z[0] * z[0] - z[1] * z[1];
                im += 2.0 * z[0] * z[1];
            }
            let (sin, cos) = (0.5 * f64::atan2(im, re)).sin_cos();
            for z in x.chunks_exact_mut(2) {
                let [re, im] = [z[0] / norm, z[1] / norm];
                z.copy_from_slice(&[cos * re + sin * im, cos * im - sin * re]);
            }
        }
        bordered.row_mut(0).copy_from_slice(right);
        turned(right, bordered.row_mut(1));
        bordered.column_mut(0).copy_from_slice(left);
        turned(left, bordered.column_mut(1));
    }
}
