//! What a request asks for: keys and values, percent-encoded, each with a bound.

use crate::http::Refusal;

/// Most keys and values of a request.
const MOST: usize = 48;
/// Longest value, decoded.
const LONGEST: usize = 160;

/// A query, decoded, in order.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Query(Vec<(String, String)>);

impl Query {
    /// Reads a query.
    pub(crate) fn of(text: &str) -> Result<Query, Refusal> {
        if text.is_empty() {
            return Ok(Query::default());
        }
        let parts: Vec<&str> = text.split('&').collect();
        if parts.len() > MOST {
            return Err(Refusal::Malformed);
        }
        let pair = |part: &&str| {
            let (key, value) = part.split_once('=').ok_or(Refusal::Malformed)?;
            Ok((decoded(key)?, decoded(value)?))
        };
        parts.iter().map(pair).collect::<Result<_, _>>().map(Query)
    }

    /// The value of a key that may stand once.
    pub(crate) fn once(&self, key: &str) -> Result<Option<&str>, Refusal> {
        let own = self.0.iter().filter(|(own, _)| own == key);
        let mut values = own.map(|(_, value)| value.as_str());
        let first = values.next();
        if values.next().is_some() { Err(Refusal::Malformed) } else { Ok(first) }
    }

    /// All values of a key, in order.
    pub(crate) fn all<'q>(&'q self, key: &'q str) -> impl Iterator<Item = &'q str> {
        self.0.iter().filter(move |(own, _)| own == key).map(|(_, value)| value.as_str())
    }

    /// Refuses keys that mean nothing.
    pub(crate) fn allow(&self, keys: &[&str]) -> Result<(), Refusal> {
        let known = self.0.iter().all(|(key, _)| keys.contains(&key.as_str()));
        if known { Ok(()) } else { Err(Refusal::Malformed) }
    }
}

fn decoded(text: &str) -> Result<String, Refusal> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        bytes.push(match byte {
            b'%' => {
                let mut digit = || rest.next().and_then(|b| char::from(b).to_digit(16));
                let (high, low) = digit().zip(digit()).ok_or(Refusal::Malformed)?;
                u8::try_from(16 * high + low).map_err(|_| Refusal::Malformed)?
            }
            b'+' => b' ',
            byte => byte,
        });
    }
    let text = String::from_utf8(bytes).map_err(|_| Refusal::Malformed)?;
    if text.len() > LONGEST || text.chars().any(char::is_control) {
        return Err(Refusal::Malformed);
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_decoded() {
        let query = Query::of("set=physical.film%3D%2250+nm%22&set=a%3D1&n=3").unwrap();
        assert_eq!(query.all("set").collect::<Vec<_>>(), ["physical.film=\"50 nm\"", "a=1"]);
        assert_eq!(query.once("n"), Ok(Some("3")));
        assert_eq!(query.once("at"), Ok(None));
        assert!(query.allow(&["set", "n"]).is_ok());
    }

    #[test]
    fn what_is_odd_is_malformed() {
        let many = vec!["a=1"; MOST + 1].join("&");
        let long = format!("a={}", "x".repeat(LONGEST + 1));
        let odd = ["a", "a=1&", "a=%", "a=%4", "a=%zz", "a=%ff", "a=%00", "a=%0a", &many, &long];
        for text in odd {
            assert_eq!(Query::of(text), Err(Refusal::Malformed), "{text}");
        }
        let twice = Query::of("n=1&n=2").unwrap();
        assert_eq!(twice.once("n"), Err(Refusal::Malformed));
        assert_eq!(twice.allow(&["set"]), Err(Refusal::Malformed));
    }
}
