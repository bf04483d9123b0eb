//! Connections, and what each of them asks for.

use crate::controls::{Control, controls};
use crate::error::ExploreError;
use crate::guard::Guard;
use crate::http::{Answer, Refusal, Request, read};
use crate::query::Query;
use crate::trace::{Bench, Quality, Refused, settles};
use crate::{answer, words};
use serde::Serialize;
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;
use study::case::{CatalogueEntry, ResolvedCase};
use study::record::{PhysicalUnits, branch_csv, events_json, physical_table};

/// Connections at once; a browser opens six.
const MOST: usize = 24;
/// How often a request to stop is looked for.
const TICK: Duration = Duration::from_millis(50);
/// Bytes of a random token.
const TOKEN: usize = 16;

const JSON: &str = "application/json";
const TEXT: &str = "text/plain; charset=utf-8";

/// The page's own files: name, media type, content.
const FILES: [(&str, &str, &str); 4] = [
    ("", "text/html; charset=utf-8", include_str!("../assets/explore.html")),
    ("explore.css", "text/css; charset=utf-8", include_str!("../assets/explore.css")),
    ("explore.js", "text/javascript; charset=utf-8", include_str!("../assets/explore.js")),
    ("chart.js", "text/javascript; charset=utf-8", include_str!("../assets/chart.js")),
];

/// A page about one case, on the loopback interface.
#[derive(Debug)]
pub struct Explorer {
    listener: TcpListener,
    address: SocketAddr,
    guard: Guard,
    bench: Bench,
    controls: Vec<Control>,
    command: Vec<String>,
    units: Mutex<Option<PhysicalUnits>>,
    connections: AtomicUsize,
    stop: Arc<AtomicBool>,
}

impl Explorer {
    /// A page for a case that people call `word`, given by the words `command` after `arclen trace`; on a
    /// port of the loopback interface, any for 0. It is served by [`Self::run`] until `stop` is set.
    ///
    /// # Errors
    /// When the port cannot be had, or the system gives no random numbers.
    pub fn new(
        word: &str,
        command: Vec<String>,
        case: ResolvedCase,
        catalogue: Vec<CatalogueEntry>,
        port: u16,
        stop: Arc<AtomicBool>,
    ) -> Result<Explorer, ExploreError> {
        let unavailable = |source| ExploreError::Port { port, source };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(unavailable)?;
        let address = listener.local_addr().map_err(unavailable)?;
        let mut secret = [0; TOKEN];
        getrandom::fill(&mut secret).map_err(ExploreError::Token)?;
        let token: String = secret.iter().map(|byte| format!("{byte:02x}")).collect();
        let controls = controls(&case, &catalogue);
        let bench = Bench::new(word.to_owned(), case, catalogue, Arc::clone(&stop));
        let guard = Guard::new(address.port(), token);
        let (units, connections) = (Mutex::new(None), AtomicUsize::new(0));
        Ok(Explorer {
            listener,
            address,
            guard,
            bench,
            controls,
            command,
            units,
            connections,
            stop,
        })
    }

    /// The address of the page, its secret included.
    pub fn url(&self) -> String {
        self.guard.url()
    }

    /// Answers requests until it is told to stop.
    pub fn run(&self) {
        thread::scope(|scope| {
            scope.spawn(|| {
                while !self.stop.load(Ordering::SeqCst) {
                    thread::sleep(TICK);
                }
                // wakes the loop below
                drop(TcpStream::connect(self.address));
            });
            for stream in self.listener.incoming() {
                if self.stop.load(Ordering::SeqCst) {
                    break;
                }
                let Ok(mut stream) = stream else { continue };
                let others = self.connections.fetch_add(1, Ordering::SeqCst);
                scope.spawn(move || {
                    let answer = if others < MOST { self.serve(&mut stream) } else { busy() };
                    if let Some(answer) = answer {
                        // a page that was closed does not wait for its answer
                        let _ = answer.send(&mut stream);
                    }
                    self.connections.fetch_sub(1, Ordering::SeqCst);
                });
            }
        });
    }

    fn serve(&self, stream: &mut TcpStream) -> Option<Answer> {
        let asked = match read(stream) {
            Ok(request) => request?,
            Err(refusal) => return Some(Answer::refused(refusal)),
        };
        Some(self.answer(&asked).unwrap_or_else(Answer::refused))
    }

    fn answer(&self, request: &Request) -> Result<Answer, Refusal> {
        let name = self.guard.admit(request)?;
        let query = Query::of(&request.query)?;
        if let Some((_, kind, text)) = FILES.iter().find(|(own, ..)| *own == name) {
            query.allow(&[])?;
            return Ok(Answer::of(kind, *text));
        }
        match name {
            "case" => {
                query.allow(&[])?;
                Ok(self.case())
            }
            "trace" => {
                query.allow(&["set", "quality", "along"])?;
                self.trace(&query)
            }
            "file" => {
                query.allow(&["set", "name"])?;
                self.file(&query)
            }
            _ => Err(Refusal::NotFound),
        }
    }

    /// What can be moved, and what is known before anything is traced.
    fn case(&self) -> Answer {
        let case = self.bench.case();
        let problem = case.problem.name();
        let entry = self.bench.catalogue().iter().find(|entry| entry.name == problem);
        let physical = case.problem.is_physical();
        json(&Description {
            name: &case.name,
            problem,
            summary: entry.map_or("", |entry| entry.summary.as_str()),
            physical,
            settles: settles(case),
            controls: &self.controls,
            command: words(&self.command, &[]),
        })
    }

    /// The values that a request replaces: of controls only, each once.
    fn set(&self, query: &Query) -> Result<Vec<String>, Refusal> {
        let texts: Vec<String> = query.all("set").map(str::to_owned).collect();
        let mut keys: Vec<&str> = Vec::new();
        for text in &texts {
            let (key, _) = text.split_once('=').ok_or(Refusal::Malformed)?;
            let known = self.controls.iter().any(|control| control.key == key);
            if !known || keys.contains(&key) {
                return Err(Refusal::Malformed);
            }
            keys.push(key);
        }
        Ok(texts)
    }

    fn trace(&self, query: &Query) -> Result<Answer, Refusal> {
        let set = self.set(query)?;
        let quality = match (query.once("quality")?, query.once("along")?) {
            (Some("rest"), None) => Quality::Rest,
            (Some(word @ ("moving" | "settling")), Some(along)) => {
                let along = along.parse().ok().filter(|along: &f64| along.is_finite());
                let along = along.ok_or(Refusal::Malformed)?;
                match word {
                    "moving" => Quality::Moving { along },
                    _ => Quality::Settling { along },
                }
            }
            _ => return Err(Refusal::Malformed),
        };
        let command = words(&self.command, &set);
        // a case that has no branch is an answer, and no failure of the request
        Ok(match self.bench.trace(&set, quality) {
            Err(error) => json(&Failure { error: error.to_string(), command }),
            Ok(None) => Answer::of(JSON, "{\"superseded\":true}"),
            Ok(Some(traced)) => {
                let mut units = self.units.lock().unwrap_or_else(PoisonError::into_inner);
                let branch = answer::branch(&traced, &mut units);
                match (branch, serde_json::to_string(&command)) {
                    (Ok(branch), Ok(command)) => {
                        Answer::of(JSON, format!("{{\"command\":{command},\"branch\":{branch}}}"))
                    }
                    _ => json(&Failure { error: "the branch cannot be written".into(), command }),
                }
            }
        })
    }

    /// A file of the results, as `arclen trace` would write it.
    fn file(&self, query: &Query) -> Result<Answer, Refusal> {
        let set = self.set(query)?;
        let name = query.once("name")?.ok_or(Refusal::Malformed)?;
        let physical = pictures::PHYSICAL.contains(&name);
        let picture = physical || pictures::NAMES.contains(&name);
        let known = ["case.toml", "branch.csv", "branch-physical.csv", "events.json"];
        if !picture && !known.contains(&name) {
            return Err(Refusal::NotFound);
        }
        let file = format!("{}-{name}", self.bench.case().name);
        if name == "case.toml" {
            let made = self.bench.load(&set).map(|loaded| loaded.case.to_toml());
            return Ok(made.map_or_else(refused, |text| Answer::of(TEXT, text).saved(file)));
        }
        let traced = match self.bench.trace(&set, Quality::Rest) {
            Err(error) => return Ok(refused(error)),
            Ok(None) => return Err(Refusal::Busy),
            Ok(Some(traced)) => traced,
        };
        let table = &traced.result.table;
        let made = match name {
            "branch.csv" => branch_csv(table).ok().map(|csv| Answer::of("text/csv", csv)),
            "branch-physical.csv" => physical_table(&traced.case, table)
                .and_then(|table| branch_csv(&table).ok())
                .map(|csv| Answer::of("text/csv", csv)),
            "events.json" => {
                events_json(&traced.case, &traced.result).ok().map(|text| Answer::of(JSON, text))
            }
            _ => match physical {
                true => pictures::draw_physical(&traced.case, &traced.result),
                false => pictures::draw_all(&traced.case, &traced.result.pictures),
            }
            .ok()
            .and_then(|all| {
                let found = all.into_iter().find(|(own, _)| own == name);
                found.map(|(_, svg)| Answer::of("image/svg+xml", svg))
            }),
        };
        made.map(|answer| answer.saved(file)).ok_or(Refusal::NotFound)
    }
}

#[derive(Serialize)]
struct Description<'a> {
    name: &'a str,
    problem: &'a str,
    summary: &'a str,
    physical: bool,
    /// Whether it is worth while to ask for the case's own elements before its modes.
    settles: bool,
    controls: &'a [Control],
    command: String,
}

#[derive(Serialize)]
struct Failure {
    error: String,
    command: String,
}

fn json(document: &impl Serialize) -> Answer {
    let text = serde_json::to_string(document);
    Answer::of(JSON, text.unwrap_or_else(|error| format!("{{\"error\":\"{error}\"}}")))
}

fn refused(error: impl Into<Refused>) -> Answer {
    Answer::of(TEXT, format!("{}\n", error.into()))
}

fn busy() -> Option<Answer> {
    Some(Answer::refused(Refusal::Busy))
}
