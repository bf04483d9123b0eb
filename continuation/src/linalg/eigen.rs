//! What the iterative eigenvalue solvers share: settings, report, random start vectors.

/// Settings of [`Lanczos`](super::Lanczos) and [`Arnoldi`](super::Arnoldi).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EigenSettings {
    /// Residual of an eigenvector of `(A − σM)⁻¹M`, relative to its eigenvalue `1/(λ − σ)`, at
    /// which it counts as converged. Eigenvalues of symmetric pencils are about twice as many
    /// digits accurate. Default 1e-8.
    pub tolerance: f64,
    /// Number of solves after which the iteration stops with what it has. Default 500.
    pub max_solves: usize,
    /// Whether to look for further copies of multiple eigenvalues before the result counts as
    /// complete: some six more solves for simple ones. Default true.
    pub complete: bool,
}

impl Default for EigenSettings {
    fn default() -> Self {
        Self { tolerance: 1e-8, max_solves: 500, complete: true }
    }
}

/// How an eigenvalue solver ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EigenReport {
    /// Number of solves.
    pub solves: usize,
    /// Number of eigenvalues that were asked for.
    pub wanted: usize,
    /// Number of those that converged.
    pub converged: usize,
    /// Whether nothing that was asked for is missing, as far as the solver could tell: all
    /// converged, and either the number on one side of the shift was given and met, or a further
    /// search from a random vector found no other copy.
    pub complete: bool,
}

/// Uniform numbers in (-1, 1), the same in every run.
#[derive(Debug, Clone)]
pub(super) struct Noise(u64);

impl Noise {
    pub(super) fn new() -> Self {
        Self(0x9e37_79b9_7f4a_7c15)
    }

    pub(super) fn fill(&mut self, x: &mut [f64]) {
        for x in x {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            *x = (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0;
        }
    }
}
