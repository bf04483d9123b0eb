//! Requests and answers of HTTP/1.1, as little of it as a page needs: one request for each connection, no
//! bodies, and bounds on everything that a stranger may send.

use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Most bytes of a target: a case has some thirty keys.
const LONGEST_TARGET: usize = 4096;
/// Most bytes of a request, its headers included; browsers send some hundreds.
const LONGEST_HEAD: usize = 16 * 1024;
/// Most headers.
const MOST_HEADERS: usize = 64;
/// How long a request may take to arrive, and an answer to be taken.
const PATIENCE: Duration = Duration::from_secs(5);

/// Why a request is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Refusal {
    /// Not HTTP, or not what the page sends.
    Malformed,
    /// Not from the page of this session.
    Forbidden,
    /// Nothing of that name.
    NotFound,
    /// Anything but GET.
    Method,
    /// It did not arrive in time.
    TooSlow,
    /// It has a body.
    Body,
    /// The target is too long.
    TargetTooLong,
    /// The headers are too many or too long.
    HeadersTooLarge,
    /// Too many connections at once.
    Busy,
    /// A version other than 1.0 and 1.1.
    Version,
}

impl Refusal {
    /// Status and reason.
    fn status(self) -> &'static str {
        match self {
            Refusal::Malformed => "400 Bad Request",
            Refusal::Forbidden => "403 Forbidden",
            Refusal::NotFound => "404 Not Found",
            Refusal::Method => "405 Method Not Allowed",
            Refusal::TooSlow => "408 Request Timeout",
            Refusal::Body => "413 Content Too Large",
            Refusal::TargetTooLong => "414 URI Too Long",
            Refusal::HeadersTooLarge => "431 Request Header Fields Too Large",
            Refusal::Busy => "503 Service Unavailable",
            Refusal::Version => "505 HTTP Version Not Supported",
        }
    }
}

/// A request without a body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Request {
    /// Path, without the query.
    pub(crate) path: String,
    /// Query, without the question mark.
    pub(crate) query: String,
    /// `Host`, once.
    pub(crate) host: Option<String>,
    /// `Origin`.
    pub(crate) origin: Option<String>,
    /// `Sec-Fetch-Site`, which browsers send.
    pub(crate) site: Option<String>,
}

/// Reads a request; `None` where nobody asked anything.
pub(crate) fn read(stream: &mut TcpStream) -> Result<Option<Request>, Refusal> {
    let deadline = Instant::now() + PATIENCE;
    let mut head = Vec::new();
    let mut part = [0; 2048];
    loop {
        let left = deadline.saturating_duration_since(Instant::now());
        if left.is_zero() || stream.set_read_timeout(Some(left)).is_err() {
            return Err(Refusal::TooSlow);
        }
        match stream.read(&mut part) {
            Ok(0) if head.is_empty() => return Ok(None),
            Ok(0) => return Err(Refusal::Malformed),
            Ok(count) => head.extend_from_slice(&part[..count]),
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
                return if head.is_empty() { Ok(None) } else { Err(Refusal::TooSlow) };
            }
            Err(_) => return Ok(None),
        }
        if let Some(request) = parse(&head)? {
            return Ok(Some(request));
        }
    }
}

/// The request, or `None` where more is to come.
fn parse(head: &[u8]) -> Result<Option<Request>, Refusal> {
    // the first line may be too long before it ends
    let line = head.iter().position(|byte| *byte == b'\n').unwrap_or(head.len());
    if line > LONGEST_TARGET + 16 {
        return Err(Refusal::TargetTooLong);
    }
    let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
    let mut request = httparse::Request::new(&mut headers);
    match request.parse(head) {
        Ok(httparse::Status::Complete(length)) if length > LONGEST_HEAD => {
            return Err(Refusal::HeadersTooLarge);
        }
        Ok(httparse::Status::Complete(_)) => {}
        Ok(httparse::Status::Partial) if head.len() > LONGEST_HEAD => {
            return Err(Refusal::HeadersTooLarge);
        }
        Ok(httparse::Status::Partial) => return Ok(None),
        Err(httparse::Error::TooManyHeaders) => return Err(Refusal::HeadersTooLarge),
        Err(httparse::Error::Version) => return Err(Refusal::Version),
        Err(_) => return Err(Refusal::Malformed),
    }
    let (Some(method), Some(target)) = (request.method, request.path) else {
        return Err(Refusal::Malformed);
    };
    if target.len() > LONGEST_TARGET {
        return Err(Refusal::TargetTooLong);
    }
    let named = |name: &str| {
        let own = request.headers.iter().filter(|header| header.name.eq_ignore_ascii_case(name));
        own.map(|header| std::str::from_utf8(header.value).unwrap_or("\u{fffd}").trim().to_owned())
            .collect::<Vec<_>>()
    };
    if method != "GET" {
        return Err(Refusal::Method);
    }
    let length = named("content-length");
    if !named("transfer-encoding").is_empty() || length.iter().any(|length| length != "0") {
        return Err(Refusal::Body);
    }
    // a name that is given twice could be read in two ways
    let once = |name: &str| -> Result<Option<String>, Refusal> {
        let mut values = named(name);
        if values.len() > 1 { Err(Refusal::Malformed) } else { Ok(values.pop()) }
    };
    if !target.starts_with('/') {
        return Err(Refusal::Malformed);
    }
    let (path, query) = target.split_once('?').unwrap_or((target, ""));
    Ok(Some(Request {
        path: path.to_owned(),
        query: query.to_owned(),
        host: once("host")?,
        origin: once("origin")?,
        site: once("sec-fetch-site")?,
    }))
}

/// What is sent back.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Answer {
    status: &'static str,
    kind: &'static str,
    /// Name under which a browser saves it.
    file: Option<String>,
    body: Vec<u8>,
}

impl Answer {
    /// A text of some media type.
    pub(crate) fn of(kind: &'static str, body: impl Into<Vec<u8>>) -> Answer {
        Answer { status: "200 OK", kind, file: None, body: body.into() }
    }

    /// The same, to be saved under a name.
    pub(crate) fn saved(self, name: impl Into<String>) -> Answer {
        Answer { file: Some(name.into()), ..self }
    }

    /// A refusal.
    pub(crate) fn refused(refusal: Refusal) -> Answer {
        let status = refusal.status();
        let kind = "text/plain; charset=utf-8";
        Answer { status, kind, file: None, body: format!("{status}\n").into_bytes() }
    }

    /// Sends it, and ends the connection.
    pub(crate) fn send(&self, stream: &mut TcpStream) -> io::Result<()> {
        let mut head = format!(
            "HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\n\
             Cache-Control: no-store\r\nContent-Security-Policy: {POLICY}\r\n\
             X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n\
             Cross-Origin-Resource-Policy: same-origin\r\nCross-Origin-Opener-Policy: same-origin\r\n",
            self.status,
            self.kind,
            self.body.len(),
        );
        if self.status.starts_with("405") {
            head.push_str("Allow: GET\r\n");
        }
        if let Some(name) = &self.file {
            head.push_str(&format!("Content-Disposition: attachment; filename=\"{name}\"\r\n"));
        }
        head.push_str("\r\n");
        stream.set_write_timeout(Some(PATIENCE))?;
        stream.set_nodelay(true)?;
        stream.write_all(&[head.as_bytes(), &self.body].concat())?;
        stream.flush()?;
        stream.shutdown(std::net::Shutdown::Write)?;
        // what is still on its way is read, or the other side might lose the answer
        stream.set_read_timeout(Some(Duration::from_millis(200)))?;
        let mut rest = [0; 2048];
        for _ in 0..64 {
            if stream.read(&mut rest).unwrap_or(0) == 0 {
                break;
            }
        }
        Ok(())
    }
}

/// What the page may load: its own files and answers, nothing else.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; \
                      connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<Option<Request>, Refusal> {
        parse(text.as_bytes())
    }

    #[test]
    fn a_request_is_read_however_it_is_cut() {
        let text = "GET /a/trace?n=1 HTTP/1.1\r\nHost: 127.0.0.1:5\r\nOrigin: http://x\r\n\r\n";
        for end in 0..text.len() {
            assert_eq!(of(&text[..end]), Ok(None), "{end}");
        }
        let request = of(text).unwrap().unwrap();
        assert_eq!((request.path.as_str(), request.query.as_str()), ("/a/trace", "n=1"));
        assert_eq!(request.host.as_deref(), Some("127.0.0.1:5"));
    }

    #[test]
    fn what_is_odd_is_refused() {
        let long = "x".repeat(LONGEST_TARGET + 1);
        let many = "A: b\r\n".repeat(MOST_HEADERS + 1);
        for (text, refusal) in [
            ("hello\r\n\r\n".to_owned(), Refusal::Malformed),
            ("GET * HTTP/1.1\r\n\r\n".to_owned(), Refusal::Malformed),
            ("GET http://a/ HTTP/1.1\r\n\r\n".to_owned(), Refusal::Malformed),
            ("GET / HTTP/2.0\r\n\r\n".to_owned(), Refusal::Version),
            ("GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n".to_owned(), Refusal::Malformed),
            ("GET / HTTP/1.1\r\nContent-Length: 3\r\n\r\nabc".to_owned(), Refusal::Body),
            ("GET / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n".to_owned(), Refusal::Body),
            ("POST / HTTP/1.1\r\nContent-Length: 3\r\n\r\nabc".to_owned(), Refusal::Method),
            ("OPTIONS / HTTP/1.1\r\n\r\n".to_owned(), Refusal::Method),
            (format!("GET /{long} HTTP/1.1\r\n\r\n"), Refusal::TargetTooLong),
            (format!("GET /{long}{long}"), Refusal::TargetTooLong),
            (format!("GET / HTTP/1.1\r\n{many}\r\n"), Refusal::HeadersTooLarge),
            (
                format!("GET / HTTP/1.1\r\nA: {}", "b".repeat(LONGEST_HEAD)),
                Refusal::HeadersTooLarge,
            ),
        ] {
            assert_eq!(of(&text), Err(refusal), "{}", &text[..text.len().min(60)]);
        }
    }
}
