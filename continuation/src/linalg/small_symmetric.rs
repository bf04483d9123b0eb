//! Eigenvalues and vectors of small symmetric matrices, without allocation.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::{Mat, MatRef, Par};

/// Ratio of the largest to the smallest eigenvalue above which the latter is polished.
const GRADED: f64 = 1e4;
/// Sweeps of rotations, at most; one or two do.
const SWEEPS: usize = 6;

/// Eigenvalues and vectors of small symmetric matrices, in storage allocated once.
pub(super) struct SmallSymmetric {
    vectors: Mat<f64>,
    values: Diag<f64>,
    /// `T S` and `Sᵀ T S`.
    product: Mat<f64>,
    projected: Mat<f64>,
    buffer: MemBuffer,
    m: usize,
}

impl SmallSymmetric {
    pub(super) fn new(capacity: usize) -> Self {
        let yes = ComputeEigenvectors::Yes;
        let scratch =
            self_adjoint_evd_scratch::<f64>(capacity.max(1), yes, Par::Seq, Default::default());
        Self {
            vectors: Mat::zeros(capacity, capacity),
            values: Diag::zeros(capacity),
            product: Mat::zeros(capacity, capacity),
            projected: Mat::zeros(capacity, capacity),
            buffer: MemBuffer::new(scratch),
            m: 0,
        }
    }

    /// Decomposes the block of `m` rows and columns from `first` on of the symmetric `t`, stored
    /// by columns of length `ld`; false if that fails (entries that are not finite).
    pub(super) fn decompose(&mut self, t: &[f64], ld: usize, first: usize, m: usize) -> bool {
        self.m = m;
        let block = MatRef::from_column_major_slice_with_stride(&t[first * (ld + 1)..], m, m, ld);
        let result = self_adjoint_evd(
            block,
            self.values.as_mut().column_vector_mut().subrows_mut(0, m).as_diagonal_mut(),
            Some(self.vectors.as_mut().submatrix_mut(0, 0, m, m)),
            Par::Seq,
            MemStack::new(&mut self.buffer),
            Default::default(),
        );
        if result.is_err() {
            return false;
        }
        let (mut least, mut largest) = (f64::INFINITY, 0.0);
        for i in 0..m {
            least = f64::min(least, self.values[i].abs());
            largest = f64::max(largest, self.values[i].abs());
        }
        if least * GRADED < largest {
            self.polish(block);
        }
        true
    }

    /// Makes the small eigenvalues of a graded matrix as accurate as the large ones.
    ///
    /// `G = Sᵀ T S` with the vectors `S` found so far is accurate entry by entry, relative to
    /// `√|g_ii g_jj|`, and nearly diagonal: a few rotations finish it.
    fn polish(&mut self, t: MatRef<'_, f64>) {
        let m = self.m;
        for j in 0..m {
            for i in 0..m {
                self.product[(i, j)] =
                    (0..m).map(|k| t[(i.max(k), i.min(k))] * self.vectors[(k, j)]).sum();
            }
        }
        for j in 0..m {
            for i in 0..=j {
                let value = (0..m).map(|k| self.vectors[(k, i)] * self.product[(k, j)]).sum();
                (self.projected[(i, j)], self.projected[(j, i)]) = (value, value);
            }
        }
        for _ in 0..SWEEPS {
            let mut rotated = false;
            for j in 1..m {
                for i in 0..j {
                    rotated |= self.rotate(i, j);
                }
            }
            if !rotated {
                break;
            }
        }
        for i in 0..m {
            self.values[i] = self.projected[(i, i)];
        }
        for i in 0..m {
            let least = (i..m).fold(i, |l, k| if self.values[k] < self.values[l] { k } else { l });
            if least != i {
                let (a, b) = (self.values[i], self.values[least]);
                (self.values[i], self.values[least]) = (b, a);
                for k in 0..m {
                    let (a, b) = (self.vectors[(k, i)], self.vectors[(k, least)]);
                    (self.vectors[(k, i)], self.vectors[(k, least)]) = (b, a);
                }
            }
        }
    }

    /// Jacobi's rotation of `G` and of the vectors, if entry `(i, j)` is above rounding.
    fn rotate(&mut self, i: usize, j: usize) -> bool {
        let g = &mut self.projected;
        let (p, q, off) = (g[(i, i)], g[(j, j)], g[(i, j)]);
        if off.abs() <= f64::EPSILON * (p * q).abs().sqrt() {
            return false;
        }
        let zeta = (q - p) / (2.0 * off);
        let t = if zeta < 0.0 { -1.0 } else { 1.0 } / (zeta.abs() + zeta.hypot(1.0));
        let c = 1.0 / t.hypot(1.0);
        let s = t * c;
        for k in 0..self.m {
            let (a, b) = (g[(k, i)], g[(k, j)]);
            (g[(k, i)], g[(k, j)]) = (c * a - s * b, s * a + c * b);
            let (a, b) = (self.vectors[(k, i)], self.vectors[(k, j)]);
            (self.vectors[(k, i)], self.vectors[(k, j)]) = (c * a - s * b, s * a + c * b);
        }
        for k in 0..self.m {
            let (a, b) = (g[(i, k)], g[(j, k)]);
            (g[(i, k)], g[(j, k)]) = (c * a - s * b, s * a + c * b);
        }
        (g[(i, j)], g[(j, i)]) = (0.0, 0.0);
        (g[(i, i)], g[(j, j)]) = (p - t * off, q + t * off);
        true
    }

    /// Number of eigenvalues.
    pub(super) fn len(&self) -> usize {
        self.m
    }

    /// Eigenvalue `i`, in ascending order.
    pub(super) fn value(&self, i: usize) -> f64 {
        self.values[i]
    }

    /// Component `j` of eigenvector `i`.
    pub(super) fn component(&self, i: usize, j: usize) -> f64 {
        self.vectors[(j, i)]
    }
}
