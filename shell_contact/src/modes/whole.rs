//! Modes with waves about a state that is not its own mirror image: the whole meridian.
//!
//! The elements are those of its two halves ([`crate::two_plates::Half`]), the lower one seen in a
//! mirror: `u` and `v` are the same there and `w` is counted downwards. Unknown `3k + f` is the
//! coefficient at knot `k = 0 … 2N` from the upper pole, the conditions of module `ends` hold at both
//! poles, and nothing is imposed at the equator. For `n = 1` both neutral motions are excluded by
//! `u − v = 0` at both poles, where they have different values. Axisymmetric modes are the problem's own.

use super::elements::{self, AT_POLE, Column, Element, Masses, ROWS};
use super::ends::{Ends, FIELDS, HALF_BANDWIDTH, Neutral, Slot};
use super::{Extent, ModeCount, Parity, bound, count_negative};
use crate::density::Coefficients;
use crate::device::{Device, Loading};
use crate::film::Potential;
use crate::gas::Gas;
use crate::membrane::Membrane;
use crate::meridian::Mesh;
use crate::two_plates::{MirrorHalf, Side, SupportedProblem, TwoPlatesProblem};
use continuation::EvalError;
use continuation::linalg::SymmetricBand;

/// The modes with waves of a state between two plates.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct WholeScan {
    /// Unstable modes of `n ≥ 1`, each pair `cos nφ`, `sin nφ` counted once.
    pub modes: usize,
    /// The smallest unstable `n ≥ 1`.
    pub first_n: Option<usize>,
    /// The largest `n` that was examined.
    pub n_max: usize,
    /// Whether every count is certain and the modes beyond `n_max` are stable by the bound.
    pub certain: bool,
    /// Counts of `n = 1, …, n_max`.
    pub by_wave: Vec<ModeCount>,
}

/// The second variation about a state of the whole shell, for every `n ≥ 1`.
#[derive(Debug, Clone)]
pub struct WholeModes<'a> {
    pub(super) mesh: &'a Mesh,
    /// What meets no pole, by power of `n²`: columns of the unknowns.
    inside: [Vec<Column>; 3],
    /// The elements next to either pole.
    poles: [[Element; AT_POLE]; 2],
    columns: Vec<Column>,
    pub(super) band: SymmetricBand,
    pub(super) masses: Masses,
    pub(super) mass: SymmetricBand,
    pub(super) scale: Vec<f64>,
    bound: f64,
}

/// A shell from pole to pole whose states have modes with waves, whatever holds it and its plates.
pub trait WholeShell: Loading {
    /// The mesh of either half.
    fn half_mesh(&self) -> &Mesh;
    /// Hands a state to the modes.
    ///
    /// # Errors
    /// When the state is not admissible.
    fn assemble_modes(
        &self,
        x: &[f64],
        p: &[f64],
        modes: &mut WholeModes<'_>,
    ) -> Result<(), EvalError>;
    /// The shell between its plates, without supports.
    fn between_plates(&self) -> &TwoPlatesProblem;
    /// The half model whose states are those of this problem that are mirror images, if it has any.
    fn mirror_half(&self) -> Option<MirrorHalf>;
    /// A state of that half under a plate at `z0` as one of this problem, with its parameter at `value`.
    fn joined_images(&self, u: &[f64], z0: f64, value: f64) -> Vec<f64>;
}

impl WholeShell for TwoPlatesProblem {
    fn between_plates(&self) -> &TwoPlatesProblem {
        self
    }

    fn mirror_half(&self) -> Option<MirrorHalf> {
        Some(MirrorHalf { shell: self.half_shell()?, device: Device::Grip })
    }

    fn joined_images(&self, u: &[f64], _: f64, _: f64) -> Vec<f64> {
        self.joined(u, u, 0.0)
    }

    fn half_mesh(&self) -> &Mesh {
        self.mesh()
    }

    fn assemble_modes(
        &self,
        x: &[f64],
        p: &[f64],
        modes: &mut WholeModes<'_>,
    ) -> Result<(), EvalError> {
        modes.assemble(self, x, p)
    }
}

/// Held, the equator stays in the mid-plane on the average over `φ` only: modes with waves are not held.
/// Nor do they move a plate on a spring.
impl WholeShell for SupportedProblem<'_> {
    fn between_plates(&self) -> &TwoPlatesProblem {
        self.shell()
    }

    fn mirror_half(&self) -> Option<MirrorHalf> {
        self.mirror_half_of()
    }

    /// The lower plate stands still: the shell goes half the way of the upper one.
    fn joined_images(&self, u: &[f64], z0: f64, value: f64) -> Vec<f64> {
        let lift = self.support().spring.map_or(0.0, |_| z0 - value);
        self.state(&self.shell().joined(u, u, lift), 2.0 * z0 - value)
    }

    fn half_mesh(&self) -> &Mesh {
        self.shell().mesh()
    }

    fn assemble_modes(
        &self,
        x: &[f64],
        p: &[f64],
        modes: &mut WholeModes<'_>,
    ) -> Result<(), EvalError> {
        let (u, c, gas) = self.inner(x, p)?;
        modes.assemble_between(self.shell(), u, &c, &gas)
    }
}

impl<'a> WholeModes<'a> {
    /// Room for the modes on a mesh of either half.
    pub fn new(mesh: &'a Mesh) -> WholeModes<'a> {
        let unknowns = FIELDS * (2 * mesh.elements() + 1);
        let zero = vec![[0.0; ROWS]; unknowns];
        WholeModes {
            mesh,
            inside: [zero.clone(), zero.clone(), zero.clone()],
            poles: [[Element::ZERO; AT_POLE], [Element::ZERO; AT_POLE]],
            columns: zero,
            band: SymmetricBand::new(unknowns, HALF_BANDWIDTH),
            masses: Masses::new(mesh),
            mass: SymmetricBand::new(unknowns, HALF_BANDWIDTH),
            scale: vec![1.0; unknowns],
            bound: 0.0,
        }
    }

    /// Takes the state `u` of a problem on the same mesh, with parameters `p`.
    ///
    /// # Errors
    /// When the state is not admissible.
    pub fn assemble(
        &mut self,
        problem: &TwoPlatesProblem,
        u: &[f64],
        p: &[f64],
    ) -> Result<(), EvalError> {
        let (c, gas) = problem.coefficients(u.len(), p)?;
        self.assemble_between(problem, u, &c, &gas)
    }

    /// The same with plates at heights of their own.
    fn assemble_between(
        &mut self,
        problem: &TwoPlatesProblem,
        u: &[f64],
        c: &[Coefficients; 2],
        gas: &Gas,
    ) -> Result<(), EvalError> {
        problem.admissible_between(u, c)?;
        let excess = gas.excess(0.5 * problem.volume(u)?);
        self.inside.iter_mut().for_each(|columns| columns.fill([0.0; ROWS]));
        self.bound = 0.0;
        let (above, below) = &problem.potentials;
        let law = &c[0].material(problem.shell.law);
        self.add(problem, Side::Top, law, above, &c[0], excess, u)?;
        self.add(problem, Side::Bottom, law, below, &c[1], excess, u)
    }

    /// Adds one half.
    #[allow(clippy::too_many_arguments, reason = "what a density needs to know")]
    fn add<L: Membrane, F: Potential>(
        &mut self,
        problem: &TwoPlatesProblem,
        side: Side,
        law: &L,
        film: &F,
        c: &Coefficients,
        excess: f64,
        u: &[f64],
    ) -> Result<(), EvalError> {
        let [top, bottom] = problem.halves();
        let half = if side == Side::Top { top } else { bottom };
        let place = Place { elements: self.mesh.elements(), side };
        let bound = bound::largest_wave(&half, u, law, film, c)?;
        // NaN is kept
        if bound > self.bound || bound.is_nan() {
            self.bound = bound;
        }
        let WholeModes { inside, poles, .. } = self;
        elements::elements(&half, u, law, film, c, excess, &mut |e, element| {
            if e < AT_POLE {
                poles[place.index()][e] = element.clone();
                return;
            }
            for (k, columns) in inside.iter_mut().enumerate() {
                let local = element.power(k);
                for b in 0..12 {
                    let (j, sign_b) = place.of(e, b);
                    for a in 0..12 {
                        let (i, sign_a) = place.of(e, a);
                        if i >= j {
                            columns[j][i - j] += sign_a * sign_b * local[a][b];
                        }
                    }
                }
            }
        });
        Ok(())
    }

    /// The wave number above which a patch of the shell is locally stable.
    pub fn wave_bound(&self) -> f64 {
        self.bound
    }

    /// The number of unstable modes of `n ≥ 1`.
    pub fn count(&mut self, n: usize) -> ModeCount {
        elements::sum_up(&self.inside, n, &mut self.columns);
        for (j, column) in self.columns.iter().enumerate() {
            let to = self.band.column_mut(j);
            to.copy_from_slice(&column[..to.len()]);
        }
        let knots = self.mesh.knots();
        let ends = Ends::new(knots, n, Parity::Symmetric, Neutral::Pinned);
        for side in Side::BOTH {
            let place = Place { elements: self.mesh.elements(), side };
            for e in 0..AT_POLE {
                let local = self.poles[place.index()][e].at(n as f64);
                let slots: [Slot; 12] = std::array::from_fn(|k| place.slot(&ends, e, k));
                for (a, slot_a) in slots.iter().enumerate() {
                    for (b, slot_b) in slots.iter().enumerate() {
                        for &(i, ci) in slot_a.terms() {
                            for &(j, cj) in slot_b.terms() {
                                if i >= j {
                                    self.band.add(i, j, ci * cj * local[a][b]);
                                }
                            }
                        }
                    }
                }
            }
            // unknowns that the conditions take away
            for (j, f) in (0..2).flat_map(|j| (0..FIELDS).map(move |f| (j, f))) {
                let own = FIELDS * j + f;
                if ends.slot(f, j as isize).terms().first().is_none_or(|term| term.0 != own) {
                    let i = FIELDS * place.knot(j as isize) + f;
                    self.band.add(i, i, 1.0);
                }
            }
        }
        count_negative(&mut self.band, &mut self.scale)
    }

    /// Examines every `n` up to the bound and a little beyond, further while the last are not stable,
    /// never beyond `max_n`.
    pub fn scan(&mut self, max_n: usize) -> WholeScan {
        let mut scan = WholeScan { certain: true, ..WholeScan::default() };
        let mut extent = Extent::new(self.bound, max_n);
        while let Some(n) = extent.next() {
            let count = self.count(n);
            extent.examined(count.negative == 0 && count.certain);
            scan.modes += count.negative;
            scan.certain &= count.certain;
            if count.negative > 0 && scan.first_n.is_none() {
                scan.first_n = Some(n);
            }
            scan.by_wave.push(count);
        }
        scan.n_max = extent.n;
        scan.certain &= extent.is_enough();
        scan
    }
}

/// Where the coefficients of a half stand among the unknowns.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub(super) elements: usize,
    pub(super) side: Side,
}

impl Place {
    fn index(self) -> usize {
        usize::from(self.side == Side::Bottom)
    }

    /// The knot of coefficient `j`, counted from the half's pole.
    fn knot(self, j: isize) -> usize {
        match self.side {
            Side::Top => j as usize,
            Side::Bottom => (2 * self.elements as isize - j) as usize,
        }
    }

    /// `w` is counted from the equator towards the half's plate.
    fn sign(self, f: usize) -> f64 {
        if f == 2 && self.side == Side::Bottom { -1.0 } else { 1.0 }
    }

    /// Unknown and sign of coefficient `k = 3i + f` of an element that meets no pole.
    fn of(self, e: usize, k: usize) -> (usize, f64) {
        let (i, f) = (k / FIELDS, k % FIELDS);
        (FIELDS * self.knot((e - 1 + i) as isize) + f, self.sign(f))
    }

    /// The same of one that may.
    pub(super) fn slot(self, ends: &Ends, e: usize, k: usize) -> Slot {
        let (j, f) = (e as isize - 1 + (k / FIELDS) as isize, k % FIELDS);
        if j > 1 {
            return Slot::new(&[(FIELDS * self.knot(j) + f, self.sign(f))]);
        }
        // with both neutral motions excluded a field follows from itself alone
        let own = ends.slot(f, j);
        let mut terms = [(0, 0.0); FIELDS];
        for (to, &(i, c)) in terms.iter_mut().zip(own.terms()) {
            *to = (FIELDS * self.knot((i / FIELDS) as isize) + f, self.sign(f) * c);
        }
        Slot::new(&terms[..own.terms().len()])
    }
}
