//! Which values the cases of a sweep take.

use super::Shard;
use serde::{Deserialize, Serialize};

/// A value that a key takes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Setting {
    /// An integer.
    Integer(i64),
    /// Any other number.
    Real(f64),
    /// A word, or a quantity with its unit.
    Text(String),
}

impl Setting {
    /// The number that it is, if it is one.
    pub fn number(&self) -> Option<f64> {
        match self {
            Setting::Integer(value) => Some(*value as f64),
            Setting::Real(value) => Some(*value),
            Setting::Text(_) => None,
        }
    }
}

/// A key and its values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// The key's TOML path.
    pub key: String,
    /// Whether the values are evenly spaced in their logarithm.
    pub logarithmic: bool,
    /// Axes of the same word advance together.
    pub zip: Option<String>,
    /// Its values, in order.
    pub values: Vec<Setting>,
}

/// Everything about a sweep but its results: what its folder is recognised by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Version of the program.
    pub version: String,
    /// Name of the sweep.
    pub name: String,
    /// Which of its cases this run computes.
    pub shard: Shard,
    /// Name of the continued parameter.
    pub parameter: String,
    /// The axes, in the order of the file.
    pub axes: Vec<Axis>,
    /// The first case that is one, line by line.
    pub base: Vec<String>,
}

impl Plan {
    /// Number of cases, those of other shards included; `None` if no computer can count them.
    pub fn count(&self) -> Option<usize> {
        count(&self.axes)
    }

    /// The values of a case, in the order of the axes.
    pub fn settings(&self, case: usize) -> Vec<&Setting> {
        settings(&self.axes, case)
    }

    /// The two axes of a plane, if the sweep covers one: two independent keys, both of numbers.
    pub fn plane(&self) -> Option<(&Axis, &Axis)> {
        let [first, second] = self.axes.as_slice() else { return None };
        let numbers = |axis: &Axis| axis.values.iter().all(|value| value.number().is_some());
        let independent = groups(&self.axes).len() == 2;
        (independent && numbers(first) && numbers(second)).then_some((first, second))
    }
}

/// Number of combinations.
pub(super) fn count(axes: &[Axis]) -> Option<usize> {
    groups(axes).iter().try_fold(1_usize, |product, (length, _)| product.checked_mul(*length))
}

/// The values of a combination.
pub(super) fn settings(axes: &[Axis], case: usize) -> Vec<&Setting> {
    let groups = groups(axes);
    let mut chosen = vec![0; axes.len()];
    let mut rest = case;
    for (length, members) in groups.iter().rev() {
        for &member in members {
            chosen[member] = rest % length;
        }
        rest /= length;
    }
    axes.iter().zip(chosen).map(|(axis, at)| &axis.values[at]).collect()
}

/// Length and members of what advances together.
fn groups(axes: &[Axis]) -> Vec<(usize, Vec<usize>)> {
    let mut groups: Vec<(usize, Vec<usize>)> = Vec::new();
    for (at, axis) in axes.iter().enumerate() {
        let partner = axis.zip.as_ref().and_then(|word| {
            groups.iter_mut().find(|(_, members)| axes[members[0]].zip.as_ref() == Some(word))
        });
        match partner {
            Some((_, members)) => members.push(at),
            None => groups.push((axis.values.len(), vec![at])),
        }
    }
    groups
}
