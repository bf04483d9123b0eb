//! Requests that a page would not send, and the statuses that refuse them.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use explore::Explorer;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use study::case::{Override, catalogue, load};

/// The page of a small case, while `run` asks it.
fn with_page(case: &str, run: impl FnOnce(&Page)) {
    let small = ["mesh.elements=60", "path.end=0.95"];
    let overrides: Vec<Override> = small
        .into_iter()
        .filter(|_| case == "fig12" || case == "polymer")
        .map(Override::new)
        .collect();
    let catalogue = catalogue();
    let loaded = load(case.as_ref(), &overrides, &catalogue).unwrap().case;
    let stop = Arc::new(AtomicBool::new(false));
    let command = vec![case.to_owned()];
    let explorer = Explorer::new(case, command, loaded, catalogue, 0, Arc::clone(&stop)).unwrap();
    let url = explorer.url();
    let rest = url.strip_prefix("http://").unwrap();
    let (host, path) = rest.split_once('/').unwrap();
    let page = Page { host: host.to_owned(), root: format!("/{path}") };
    std::thread::scope(|scope| {
        let serving = scope.spawn(|| explorer.run());
        // a test that fails ends the server too
        let _end = OnDrop(&stop);
        run(&page);
        stop.store(true, Ordering::SeqCst);
        serving.join().unwrap();
    });
}

struct OnDrop<'s>(&'s AtomicBool);

impl Drop for OnDrop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::SeqCst);
    }
}

struct Page {
    host: String,
    root: String,
}

impl Page {
    /// Sends bytes as they are; the answer.
    fn send(&self, bytes: &[u8]) -> String {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        stream.write_all(bytes).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        String::from_utf8_lossy(&answer).into_owned()
    }

    /// A request for something below the token, with further lines.
    fn ask(&self, target: &str, lines: &str) -> String {
        let (root, host) = (&self.root, &self.host);
        self.send(format!("GET {root}{target} HTTP/1.1\r\nHost: {host}\r\n{lines}\r\n").as_bytes())
    }
}

fn status(answer: &str) -> u16 {
    answer.split(' ').nth(1).and_then(|word| word.parse().ok()).unwrap_or(0)
}

fn body(answer: &str) -> &str {
    answer.split_once("\r\n\r\n").unwrap().1
}

#[test]
fn strangers_are_refused_with_the_right_status() {
    with_page("fig12", |page| {
        let Page { host, root } = page;
        let head = |line: &str| format!("{line}\r\nHost: {host}\r\n\r\n");
        let port = host.split(':').nth(1).unwrap();
        let long = "x".repeat(5000);
        let sets = "set=dimensionless.film%3D0.03&".repeat(60);
        let value = "9".repeat(200);
        let table: Vec<(u16, String)> = vec![
            (200, head(&format!("GET {root} HTTP/1.1"))),
            (200, format!("GET {root} HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n")),
            // who asks
            (403, format!("GET {root} HTTP/1.1\r\nHost: evil.example:{port}\r\n\r\n")),
            (403, format!("GET {root} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")),
            (403, format!("GET {root} HTTP/1.1\r\n\r\n")),
            (400, format!("GET {root} HTTP/1.1\r\nHost: {host}\r\nHost: evil.example\r\n\r\n")),
            (
                403,
                format!(
                    "GET {root} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://evil.example\r\n\r\n"
                ),
            ),
            (403, format!("GET {root} HTTP/1.1\r\nHost: {host}\r\nOrigin: null\r\n\r\n")),
            (
                403,
                format!(
                    "GET {root} HTTP/1.1\r\nHost: {host}\r\nSec-Fetch-Site: cross-site\r\n\r\n"
                ),
            ),
            (403, head("GET / HTTP/1.1")),
            (403, head("GET /trace?quality=rest HTTP/1.1")),
            (403, head(&format!("GET /{}/ HTTP/1.1", "0".repeat(32)))),
            // what is asked
            (404, head(&format!("GET {root}nothing HTTP/1.1"))),
            (404, head(&format!("GET {root}../case HTTP/1.1"))),
            (404, head(&format!("GET {root}file?name=../../etc/passwd HTTP/1.1"))),
            (405, head(&format!("POST {root}trace HTTP/1.1"))),
            (405, head(&format!("OPTIONS {root}trace HTTP/1.1"))),
            (405, head(&format!("HEAD {root} HTTP/1.1"))),
            (413, format!("GET {root} HTTP/1.1\r\nHost: {host}\r\nContent-Length: 5\r\n\r\nhello")),
            (
                413,
                format!(
                    "GET {root} HTTP/1.1\r\nHost: {host}\r\nTransfer-Encoding: chunked\r\n\r\n"
                ),
            ),
            (414, head(&format!("GET {root}{long} HTTP/1.1"))),
            (431, format!("GET {root} HTTP/1.1\r\nHost: {host}\r\n{}\r\n", "A: b\r\n".repeat(80))),
            (
                431,
                format!("GET {root} HTTP/1.1\r\nHost: {host}\r\nA: {}\r\n\r\n", "b".repeat(20_000)),
            ),
            (505, head(&format!("GET {root} HTTP/3.0"))),
            // how it is asked
            (400, "nonsense\r\n\r\n".to_owned()),
            (400, head("GET http://127.0.0.1/ HTTP/1.1")),
            (400, head(&format!("GET {root}trace HTTP/1.1"))),
            (400, head(&format!("GET {root}trace?quality=best HTTP/1.1"))),
            (400, head(&format!("GET {root}trace?quality=moving HTTP/1.1"))),
            (400, head(&format!("GET {root}trace?quality=moving&along=NaN HTTP/1.1"))),
            (400, head(&format!("GET {root}trace?quality=rest&quality=rest HTTP/1.1"))),
            (400, head(&format!("GET {root}trace?quality=rest&more=1 HTTP/1.1"))),
            (400, head(&format!("GET {root}trace?quality=rest&set=%zz HTTP/1.1"))),
            (400, head(&format!("GET {root}trace?quality=rest&set=nothing HTTP/1.1"))),
            (400, head(&format!("GET {root}trace?{sets}quality=rest HTTP/1.1"))),
            (400, head(&format!("GET {root}trace?quality=rest&set=path.end%3D{value} HTTP/1.1"))),
            // keys that the page does not offer, and one key twice
            (
                400,
                head(&format!("GET {root}trace?quality=rest&set=mesh.elements%3D100000 HTTP/1.1")),
            ),
            (
                400,
                head(&format!(
                    "GET {root}trace?quality=rest&set=path.end%3D1&set=path.end%3D1 HTTP/1.1"
                )),
            ),
        ];
        for (wanted, request) in table {
            let answer = page.send(request.as_bytes());
            assert_eq!(status(&answer), wanted, "{}", &request[..request.len().min(200)]);
            let lower = answer.to_lowercase();
            assert!(!lower.contains("access-control-"), "no foreign page may read an answer");
            assert!(lower.contains("content-security-policy: default-src 'none'"));
            assert!(lower.contains("x-content-type-options: nosniff"));
        }
    });
}

#[test]
fn half_a_request_holds_nobody_up() {
    with_page("fig12", |page| {
        let mut slow = TcpStream::connect(&page.host).unwrap();
        slow.write_all(b"GET / HT").unwrap();
        let clock = Instant::now();
        assert_eq!(status(&page.ask("case", "")), 200);
        assert!(clock.elapsed() < Duration::from_secs(3));
        let mut answer = String::new();
        slow.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
        slow.read_to_string(&mut answer).unwrap();
        assert_eq!(status(&answer), 408);
    });
}

#[test]
fn a_branch_is_told_as_json_and_a_bad_value_in_words() {
    with_page("fig12", |page| {
        let case: serde_json::Value = serde_json::from_str(body(&page.ask("case", ""))).unwrap();
        assert_eq!(case["problem"], "contact");
        assert_eq!(case["command"], "arclen trace fig12");
        let target = "trace?quality=rest&set=dimensionless.adhesion%3D3e-3";
        let told: serde_json::Value = serde_json::from_str(body(&page.ask(target, ""))).unwrap();
        assert_eq!(told["command"], "arclen trace fig12 --set dimensionless.adhesion=3e-3");
        let branch = &told["branch"];
        let points = branch["columns"]["force"].as_array().unwrap().len();
        assert_eq!(branch["stability"].as_array().unwrap().len(), points);
        assert_eq!(branch["states"].as_array().unwrap().len(), points);
        assert_eq!(branch["full"], true);
        let coarse = "trace?quality=moving&along=0.1&set=dimensionless.adhesion%3D3e-3";
        let told: serde_json::Value = serde_json::from_str(body(&page.ask(coarse, ""))).unwrap();
        let stability = told["branch"]["stability"].as_array().unwrap();
        assert!(stability.iter().all(|word| word != "stable"), "not every mode was looked at");
        let bad = "trace?quality=rest&set=dimensionless.film%3D-1";
        let told: serde_json::Value = serde_json::from_str(body(&page.ask(bad, ""))).unwrap();
        assert_eq!(
            told["error"],
            "fig12, page: dimensionless.film = -1: must be positive and finite"
        );
    });
}

#[test]
fn files_are_those_of_the_program() {
    with_page("polymer", |page| {
        let csv = page.ask("file?name=branch-physical.csv", "");
        assert!(csv.contains("attachment; filename=\"polymer-branch-physical.csv\""));
        assert!(body(&csv).starts_with("point,z0_nm,deformation_nm,force_nN,"), "{}", body(&csv));
        let toml = page.ask("file?name=case.toml&set=physical.film%3D40+nm", "");
        assert!(body(&toml).contains("film = \"40 nm\""));
        let svg = page.ask("file?name=force_distance.svg", "");
        assert!(body(&svg).starts_with("<svg"));
        assert_eq!(status(&page.ask("file?name=diagram.svg", "")), 404);
    });
    with_page("cusp", |page| {
        assert!(body(&page.ask("file?name=diagram.svg", "")).starts_with("<svg"));
        assert_eq!(status(&page.ask("file?name=branch-physical.csv", "")), 404);
    });
}
