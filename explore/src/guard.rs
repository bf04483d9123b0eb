//! Who may ask: the page that this session served, and nobody else.
//!
//! Other pages in the same browser can send requests to the loopback interface. They know neither the
//! token, nor can they say a foreign `Host` (which is how names are rebound to this machine) or `Origin`.

use crate::http::{Refusal, Request};

/// What requests of a session must say.
#[derive(Debug, Clone)]
pub(crate) struct Guard {
    port: u16,
    token: String,
}

impl Guard {
    /// The guard of a session.
    pub(crate) fn new(port: u16, token: String) -> Guard {
        Guard { port, token }
    }

    /// The address of the page.
    pub(crate) fn url(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// The name that is asked for, below the token.
    pub(crate) fn admit<'r>(&self, request: &'r Request) -> Result<&'r str, Refusal> {
        let own = |name: &str| {
            ["127.0.0.1", "localhost"].iter().any(|host| name == format!("{host}:{}", self.port))
        };
        if !request.host.as_deref().is_some_and(own) {
            return Err(Refusal::Forbidden);
        }
        let origin = request.origin.as_deref();
        if !origin.is_none_or(|origin| origin.strip_prefix("http://").is_some_and(own)) {
            return Err(Refusal::Forbidden);
        }
        // a link that somebody clicked, or a page elsewhere that loads this one
        if request.site.as_deref().is_some_and(|site| !matches!(site, "same-origin" | "none")) {
            return Err(Refusal::Forbidden);
        }
        let path = request.path.strip_prefix('/').unwrap_or_default();
        let (token, name) = path.split_once('/').unwrap_or((path, ""));
        if !equal(token.as_bytes(), self.token.as_bytes()) {
            return Err(Refusal::Forbidden);
        }
        // without the last slash the page's files would be sought beside the token
        if path == token { Err(Refusal::NotFound) } else { Ok(name) }
    }
}

/// Whether two words are the same, in a time that does not tell where they differ.
fn equal(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |differ, (a, b)| differ | (a ^ b)) == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_line_of_defence_holds_alone() {
        let guard = Guard::new(80, "abc".to_owned());
        let good = Request {
            path: "/abc/trace".to_owned(),
            query: String::new(),
            host: Some("127.0.0.1:80".to_owned()),
            origin: None,
            site: None,
        };
        let words = |word: &str| Some(word.to_owned());
        assert_eq!(guard.admit(&good), Ok("trace"));
        for request in [
            Request { host: None, ..good.clone() },
            Request { host: words("evil.example:80"), ..good.clone() },
            Request { host: words("127.0.0.1:81"), ..good.clone() },
            Request { host: words("127.0.0.1"), ..good.clone() },
            Request { origin: words("http://evil.example"), ..good.clone() },
            Request { origin: words("https://127.0.0.1:80"), ..good.clone() },
            Request { origin: words("null"), ..good.clone() },
            Request { site: words("cross-site"), ..good.clone() },
            Request { site: words("same-site"), ..good.clone() },
            Request { path: "/".to_owned(), ..good.clone() },
            Request { path: "/abd/trace".to_owned(), ..good.clone() },
            Request { path: "/abcd/trace".to_owned(), ..good.clone() },
            Request { path: "/ab/trace".to_owned(), ..good.clone() },
            Request { path: "//abc/trace".to_owned(), ..good.clone() },
        ] {
            assert_eq!(guard.admit(&request), Err(Refusal::Forbidden), "{request:?}");
        }
        let own =
            Request { origin: words("http://localhost:80"), site: words("same-origin"), ..good };
        assert_eq!(guard.admit(&own), Ok("trace"));
        let bare = Request { path: "/abc".to_owned(), ..own };
        assert_eq!(guard.admit(&bare), Err(Refusal::NotFound));
    }
}
