//! A share of a sweep, for the jobs of a cluster.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// The `index`-th of `of` shares: the cases whose number leaves `index − 1` when divided by `of`, so
/// that dear and cheap neighbourhoods are spread over all shares.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Shard {
    index: usize,
    of: usize,
}

impl Shard {
    /// The whole.
    pub const ALL: Shard = Shard { index: 1, of: 1 };

    /// Whether it is the whole.
    pub fn is_all(self) -> bool {
        self.of == 1
    }

    /// Whether a case belongs to it.
    pub fn holds(self, case: usize) -> bool {
        case % self.of == self.index - 1
    }

    /// What to add to the name of a folder.
    pub fn suffix(self) -> String {
        if self.is_all() { String::new() } else { format!("-{}-of-{}", self.index, self.of) }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

impl From<Shard> for String {
    fn from(shard: Shard) -> Self {
        shard.to_string()
    }
}

impl TryFrom<String> for Shard {
    type Error = String;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parts = text.split_once('/').map(|(k, n)| (k.trim().parse(), n.trim().parse()));
        match parts {
            Some((Ok(index), Ok(of))) if 1 <= index && index <= of => Ok(Shard { index, of }),
            _ => Err("expected k/n with k from 1 to n, for example 2/8".to_owned()),
        }
    }
}
