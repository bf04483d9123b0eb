//! Which sample was measured on which stable stretch of the branch.
//!
//! On approach the shell goes from stretch to stretch inwards, on retract outwards, each change a jump of the
//! lever. Where it jumped is what the data say: the changes with the least misfit, found by dynamic
//! programming over the samples in the order of time; a change must be worth [`WORTH`].

use crate::data::Direction;

/// Least gain in `χ²` for which a jump is assumed.
pub const WORTH: f64 = 30.0;

/// The stretch of each sample. `misfit[k][i]` is the squared weighted residual of sample `i` on stretch `k`;
/// an approach begins on the first stretch, a retract anywhere.
pub fn assign(direction: Direction, misfit: &[Vec<f64>]) -> Vec<usize> {
    let stretches = misfit.len();
    let samples = misfit.first().map_or(0, Vec::len);
    if stretches <= 1 || samples == 0 {
        return vec![0; samples];
    }
    let may_follow = |from: usize, to: usize| match direction {
        Direction::Approach => from <= to,
        Direction::Retract => from >= to,
    };
    let mut cost: Vec<f64> = (0..stretches)
        .map(|k| match direction {
            Direction::Approach if k > 0 => f64::INFINITY,
            _ => misfit[k][0],
        })
        .collect();
    // where the best way to each stretch came from, sample by sample
    let mut came: Vec<Vec<u8>> = vec![vec![0; samples]; stretches];
    for i in 1..samples {
        let mut next = vec![f64::INFINITY; stretches];
        for to in 0..stretches {
            for from in (0..stretches).filter(|&from| may_follow(from, to)) {
                let jump = if from == to { 0.0 } else { WORTH };
                let way = cost[from] + jump + misfit[to][i];
                if way < next[to] {
                    next[to] = way;
                    came[to][i] = from as u8;
                }
            }
        }
        cost = next;
    }
    let mut at = (0..stretches).min_by(|&a, &b| cost[a].total_cmp(&cost[b])).unwrap_or(0);
    let mut way = vec![at; samples];
    for i in (1..samples).rev() {
        at = came[at][i] as usize;
        way[i - 1] = at;
    }
    way
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_is_where_the_misfit_changes() {
        let on = |range: std::ops::Range<usize>| -> Vec<f64> {
            (0..40).map(|i| if range.contains(&i) { 1.0 } else { 9.0 }).collect()
        };
        let way = assign(Direction::Approach, &[on(0..13), on(13..40)]);
        assert_eq!(way.iter().position(|k| *k == 1), Some(13));
        // outwards only on retract
        let way = assign(Direction::Retract, &[on(0..13), on(13..40)]);
        assert!(way.windows(2).all(|w| w[0] >= w[1]));
    }

    #[test]
    fn noise_makes_no_jump() {
        let a: Vec<f64> = (0..50).map(|i| f64::from(i % 7)).collect();
        let b: Vec<f64> = (0..50).map(|i| f64::from((i + 3) % 7)).collect();
        let way = assign(Direction::Approach, &[a, b]);
        assert!(way.iter().all(|k| *k == way[0]));
    }
}
