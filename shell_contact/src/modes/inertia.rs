//! Negative eigenvalues of one wave number in both parities by one elimination.
//!
//! The parities differ by their conditions at the equator alone. `K = L D Lᵀ` is eliminated from the
//! pole, without pivoting, up to the last unknowns that the equator does not reach; what is left, a
//! dense block of twelve, is completed and eliminated for each parity. The signs of `D` are those
//! of the eigenvalues (Sylvester).

use super::LEAST_PIVOT;
use super::elements::{AT_EQUATOR, Column, Elements, ROWS, unit_pivots};
use super::ends::{Ends, FIELDS};
use continuation::linalg::MAX_GROWTH;
use continuation::linalg::kernel::{self, Arithmetic, Kernel};

/// Columns that the elements next to the equator contribute to.
const LAST: usize = FIELDS * (AT_EQUATOR + 2);

/// Storage of the elimination.
#[derive(Debug, Clone)]
pub(super) struct Elimination {
    /// One column for each unknown.
    pub(super) columns: Vec<Column>,
    /// Reciprocal diagonal entries, which pivots are compared to.
    scale: Vec<f64>,
}

/// What is known of a part of the pivots.
#[derive(Debug, Clone, Copy, Default)]
struct Pivots {
    negative: usize,
    /// One is rounding, or entries grew so much that rounding may have changed a sign.
    doubtful: bool,
}

impl Elimination {
    /// Room for `elements` elements.
    pub(super) fn new(elements: usize) -> Elimination {
        let unknowns = FIELDS * (elements + 1);
        Elimination { columns: vec![[0.0; ROWS]; unknowns], scale: vec![0.0; unknowns] }
    }

    /// The counts of both parities, of [`Parity::BOTH`](super::Parity::BOTH); `None` where they need more care than an
    /// elimination without pivoting.
    pub(super) fn negative(
        &mut self,
        elements: &Elements,
        ends: [&Ends; 2],
        n: usize,
    ) -> [Option<usize>; 2] {
        let knots = elements.count();
        let columns = &mut self.columns;
        elements.columns(n, columns);
        let mut add = |i: usize, j: usize, value: f64| columns[j][i - j] += value;
        elements.at_pole(ends[0], n, &mut add);
        unit_pivots(ends[0], 0..=1, false, &mut add);
        let shared = columns.len() - LAST;
        let tails = ends.map(|ends| {
            let mut tail = [[0.0; ROWS]; LAST];
            let mut add = |i: usize, j: usize, value: f64| tail[j - shared][i - j] += value;
            elements.at_equator(ends, n, &mut add);
            unit_pivots(ends, knots - 1..=knots, false, &mut add);
            tail
        });
        let reciprocal = |d: f64| if d != 0.0 { 1.0 / d.abs() } else { 1.0 };
        for (scale, column) in self.scale.iter_mut().zip(columns.iter()) {
            *scale = reciprocal(column[0]);
        }
        for k in 0..LAST {
            let both = tails.each_ref().map(|tail| reciprocal(columns[shared + k][0] + tail[k][0]));
            self.scale[shared + k] = both[0].max(both[1]);
        }
        let first = eliminate(columns, shared, &self.scale);
        if first.doubtful {
            return [None; 2];
        }
        tails.map(|tail| {
            // zero columns follow, as the elimination has no short ends
            let mut rest = [[0.0; ROWS]; 2 * LAST];
            let mut scale = [0.0; 2 * LAST];
            for k in 0..LAST {
                scale[k] = self.scale[shared + k];
                for i in 0..LAST - k {
                    rest[k][i] = columns[shared + k][i] + tail[k][i];
                }
            }
            let last = eliminate(&mut rest, LAST, &scale);
            (!last.doubtful).then_some(first.negative + last.negative)
        })
    }
}

/// Eliminates the first `count` columns, at least [`LAST`] fewer than there are.
fn eliminate(columns: &mut [Column], count: usize, scale: &[f64]) -> Pivots {
    kernel::run(Columns { columns, count, scale })
}

struct Columns<'a> {
    columns: &'a mut [Column],
    count: usize,
    scale: &'a [f64],
}

impl Kernel for Columns<'_> {
    type Output = Pivots;

    #[inline(always)]
    fn run<A: Arithmetic>(self) -> Pivots {
        let Columns { columns, count, scale } = self;
        let mut pivots = Pivots::default();
        let mut largest = [0.0; ROWS];
        let mut smallest = f64::INFINITY;
        for j in 0..count {
            let Some((column, next)) = columns[j..].split_first_mut() else { break };
            let (Some(next), Some(scale)) =
                (next.first_chunk_mut::<{ ROWS - 1 }>(), scale[j..].first_chunk::<ROWS>())
            else {
                break;
            };
            let d = column[0];
            pivots.negative += usize::from(d < 0.0);
            // not `min`: it would pass over a pivot that is not a number
            let size = d.abs() * scale[0];
            smallest = if size > smallest { smallest } else { size };
            let inverse = 1.0 / d;
            let l = kernel::eliminate::<A, { ROWS - 1 }, ROWS>(column, inverse, next);
            for i in 0..ROWS {
                let term = (column[i] * l[i]).abs() * scale[i];
                largest[i] = if term > largest[i] { term } else { largest[i] };
            }
        }
        let largest = largest.iter().fold(0.0, |m: f64, x| m.max(*x));
        pivots.doubtful = !(smallest >= LEAST_PIVOT && largest <= MAX_GROWTH);
        pivots
    }
}
