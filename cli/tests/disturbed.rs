//! 200 random corruptions and 50 kills over all commands that write or keep files: the same command
//! again gives the undisturbed result, or refuses and names what is wrong. No wrong number comes with
//! exit code 0.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

mod support;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::thread::sleep;
use std::time::{Duration, Instant};
use support::{Random, all_files, arclen, command, contents, copy, equal, files, name, stderr};

const SWEEP: &str = "problem = \"enz\"\n[[vary]]\nkey = \"path.max_step\"\nfrom = 0.5\nto = 1.5\n\
                     count = 8\n";
const LAB: &str = "[instrument]\nspring_constant_sd = \"5 %\"\nnoise = \"150 pN\"\n[shell]\nlaw = \"hooke\"\n\
                   [physical]\nradius = \"1.58 um\"\nradius_sd = \"50 nm\"\n";
const CURVE: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/../identify/tests/data/open-1-hard-knee.tab");

/// A command, without the folder of its results, and how often it is disturbed.
struct Job {
    arguments: &'static [&'static str],
    corruptions: usize,
    kills: usize,
}

/// Every command that leaves files. Those that keep what a long run has computed are disturbed most.
const JOBS: [Job; 10] = [
    Job { arguments: &["trace", "enz"], corruptions: 32, kills: 3 },
    Job {
        arguments: &["trace", "dlvo", "--elements", "60", "--no-pictures"],
        corruptions: 6,
        kills: 4,
    },
    Job {
        arguments: &["diagram", "mittelmann", "--set", "mesh.elements=8", "--no-pictures"],
        corruptions: 24,
        kills: 10,
    },
    Job { arguments: &["orbits", "brusselator", "--no-pictures"], corruptions: 8, kills: 4 },
    Job {
        arguments: &["map", "co-oxidation", "--over", "k", "--no-pictures"],
        corruptions: 12,
        kills: 4,
    },
    Job {
        arguments: &["cycle", "fig16", "--elements", "40", "--no-pictures"],
        corruptions: 8,
        kills: 4,
    },
    Job { arguments: &["sweep", "s.toml"], corruptions: 60, kills: 14 },
    Job { arguments: &["merge", "a", "b"], corruptions: 44, kills: 3 },
    Job {
        arguments: &["fit", CURVE, "--known", "lab.toml", "--no-pictures"],
        corruptions: 3,
        kills: 2,
    },
    Job {
        arguments: &["figure", "7", "--elements", "40", "--no-pictures"],
        corruptions: 3,
        kills: 2,
    },
];

#[test]
fn there_are_200_corruptions_and_50_kills() {
    assert_eq!(JOBS.iter().map(|job| job.corruptions).sum::<usize>(), 200);
    assert_eq!(JOBS.iter().map(|job| job.kills).sum::<usize>(), 50);
}

/// A place with what the commands start from.
struct Place {
    folder: tempfile::TempDir,
    job: &'static Job,
    /// Time of an undisturbed run.
    takes: Duration,
}

impl Place {
    /// With the undisturbed result in `whole`.
    fn new(job: &'static Job) -> Place {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("s.toml"), SWEEP).unwrap();
        fs::write(folder.path().join("lab.toml"), LAB).unwrap();
        let mut place = Place { folder, job, takes: Duration::ZERO };
        if job.arguments[0] == "merge" {
            for (shard, out) in [("1/2", "a"), ("2/2", "b")] {
                let run = ["sweep", "s.toml", "--shard", shard, "--out", out, "-q"];
                assert_eq!(arclen(place.path(), &run).status.code(), Some(0));
            }
        }
        let clock = Instant::now();
        let (code, message) = place.run("whole");
        place.takes = clock.elapsed();
        assert_eq!(code, Some(0), "{:?}: {message}", job.arguments);
        place
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }

    fn at(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    fn arguments<'a>(&self, out: &'a str) -> Vec<&'a str> {
        [self.job.arguments, &["-q", "--out", out]].concat()
    }

    fn run(&self, out: &str) -> (Option<i32>, String) {
        let output = arclen(self.path(), &self.arguments(out));
        (output.status.code(), stderr(&output))
    }

    /// Starts the command and sends it a signal after a part of the time that it takes.
    fn interrupt(&self, out: &str, signal: &str, part: f64) {
        let mut command = command(self.path(), &self.arguments(out));
        let mut child = command.stderr(Stdio::null()).spawn().unwrap();
        sleep(self.takes.mul_f64(part));
        if child.try_wait().unwrap().is_none() {
            let id = child.id().to_string();
            // it may end at this very moment
            let _ = std::process::Command::new("kill")
                .args(["-s", signal, &id])
                .stderr(Stdio::null())
                .status();
        }
        child.wait().unwrap();
    }
}

/// What a run may begin with: the whole result, or what an interrupted one has kept.
fn begun(place: &Place, trial: usize, random: &mut Random) -> PathBuf {
    let out = place.at("o");
    match (place.job.arguments[0], trial % 3) {
        ("diagram", 1 | 2) => {
            let part = 0.3 + 0.06 * random.below(10) as f64;
            place.interrupt("o", ["KILL", "INT"][trial % 2], part);
            fs::create_dir_all(&out).unwrap();
        }
        _ => copy(&place.at("whole"), &out),
    }
    out
}

fn corruptions(job: &'static Job, seed: u64) {
    let place = Place::new(job);
    let mut random = Random(seed);
    let (mut refused, mut reported, mut unfinished) = (0, 0, 0);
    for trial in 0..job.corruptions {
        let out = begun(&place, trial, &mut random);
        unfinished += usize::from(out.join("unfinished").exists());
        // a merge keeps nothing itself: what it reads are the shards
        let merge = job.arguments[0] == "merge";
        let kept: Vec<PathBuf> = if merge {
            copy(&place.at("a"), &place.at("safe-a"));
            copy(&place.at("b"), &place.at("safe-b"));
            ["a", "b"]
                .into_iter()
                .flat_map(|shard| all_files(&place.at(shard).join("cases")))
                .collect()
        } else {
            all_files(&out)
        };
        let said = match kept.is_empty() {
            true => "nothing was kept".to_owned(),
            false => random.corrupt(&kept),
        };
        let said = format!("{:?}, trial {trial}: {said}", job.arguments);
        let (code, message) = place.run("o");
        if code == Some(0) {
            same(&place.at("whole"), &out, &format!("{said}: {message}"));
            reported += usize::from(!message.is_empty());
        } else {
            refused += 1;
            assert!([2, 3].contains(&code.unwrap()), "{said}: {code:?} {message}");
            let named = kept.iter().any(|path| message.contains(name(path)))
                || message.contains("cases: ") && message.contains("another sweep")
                // what was damaged is the plan of a shard, and the shard is named
                || merge
                    && ["no results of a sweep", "not of the same sweep"]
                        .iter()
                        .any(|words| message.contains(words))
                || merge && code == Some(3); // a case is missing, and the result says so
            assert!(named, "{said}: {message}");
            // what is not complete has no number that the whole does not have
            if merge && code == Some(3) {
                is_part(&place.at("whole"), &out, &said);
            }
        }
        fs::remove_dir_all(&out).unwrap();
        if merge {
            for shard in ["a", "b"] {
                fs::remove_dir_all(place.at(shard)).unwrap();
                fs::rename(place.at(&format!("safe-{shard}")), place.at(shard)).unwrap();
            }
        }
    }
    println!("{:?}: {refused} refused, {reported} reported", job.arguments);
    assert!(job.arguments[0] != "diagram" || unfinished > 5, "{unfinished}");
}

/// The same results; what a sweep keeps of its cases beside them is not one.
fn same(one: &Path, other: &Path, said: &str) {
    equal(one, other, said);
    for entry in fs::read_dir(one).unwrap().map(Result::unwrap) {
        if entry.path().is_dir() && entry.file_name() != "cases" {
            same(&entry.path(), &other.join(entry.file_name()), said);
        }
    }
}

/// Every row of the tables of `part` is one of `whole`'s.
fn is_part(whole: &Path, part: &Path, said: &str) {
    for path in files(part).iter().filter(|path| name(path).ends_with(".csv")) {
        let rows = fs::read_to_string(whole.join(name(path))).unwrap();
        for row in fs::read_to_string(path).unwrap().lines() {
            assert!(rows.lines().any(|other| other == row), "{said}: {}: {row}", name(path));
        }
    }
}

fn kills(job: &'static Job, seed: u64) {
    let place = Place::new(job);
    let mut random = Random(seed);
    for trial in 0..job.kills {
        let signal = ["KILL", "TERM", "KILL", "INT", "HUP"][trial % 5];
        // before anything, in the midst of it, while files are written, after the end
        let part = 1.1 * random.below(1000) as f64 / 1000.0;
        place.interrupt("o", signal, part);
        let said = format!("{:?}: {signal} after {part} of {:?}", job.arguments, place.takes);
        let (code, message) = place.run("o");
        assert_eq!(code, Some(0), "{said}: {message}");
        same(&place.at("whole"), &place.at("o"), &said);
        let left: Vec<PathBuf> = all_files(&place.at("o"));
        let rubbish = left.iter().find(|path| name(path).starts_with(".arclen-"));
        assert!(rubbish.is_none(), "{said}: {rubbish:?}");
        assert!(!place.at("o/unfinished").exists(), "{said}");
        fs::remove_dir_all(place.at("o")).unwrap();
    }
}

macro_rules! jobs {
    ($($corrupted:ident $killed:ident $at:literal),+ $(,)?) => {$(
        #[test]
        fn $corrupted() {
            corruptions(&JOBS[$at], 11 + $at);
        }

        #[test]
        fn $killed() {
            kills(&JOBS[$at], 31 + $at);
        }
    )+};
}

jobs! {
    a_corrupted_trace a_killed_trace 0,
    a_corrupted_trace_of_a_shell a_killed_trace_of_a_shell 1,
    a_corrupted_diagram a_killed_diagram 2,
    corrupted_orbits killed_orbits 3,
    a_corrupted_map a_killed_map 4,
    a_corrupted_cycle a_killed_cycle 5,
    a_corrupted_sweep a_killed_sweep 6,
    corrupted_shards a_killed_merge 7,
    a_corrupted_fit a_killed_fit 8,
    a_corrupted_figure a_killed_figure 9,
}

/// Branches of a diagram, and cases of a sweep, that changed places are not taken for each other.
#[test]
fn whole_files_in_the_wrong_place_are_computed_again() {
    let place = Place::new(&JOBS[6]);
    let out = place.at("o");
    copy(&place.at("whole"), &out);
    let [one, two] =
        ["case-000001.cbor", "case-000004.cbor"].map(|name| out.join("cases").join(name));
    let (first, second) = (fs::read(&one).unwrap(), fs::read(&two).unwrap());
    fs::write(&one, second).unwrap();
    fs::write(&two, first).unwrap();
    let (code, message) = place.run("o");
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("case-000001.cbor: damaged"), "{message}");
    equal(&place.at("whole"), &out, "exchanged");

    let place = Place::new(&JOBS[2]);
    let branches = [0, 1].map(|id| place.at(&format!("o/unfinished/branch-{id}.cbor")));
    let mut part = 0.9;
    while !branches.iter().all(|path| path.exists()) {
        let _ = fs::remove_dir_all(place.at("o"));
        place.interrupt("o", "KILL", part);
        part = if part < 0.2 { 0.95 } else { part - 0.05 };
    }
    let [first, second] = branches.each_ref().map(|path| fs::read(path).unwrap());
    fs::write(&branches[0], second).unwrap();
    fs::write(&branches[1], first).unwrap();
    let (code, message) = place.run("o");
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("branch-0.cbor: damaged"), "{message}");
    equal(&place.at("whole"), &place.at("o"), "exchanged");

    let place = Place::new(&JOBS[7]);
    let cases = place.at("a/cases");
    let of_a = files(&cases);
    let cbor: Vec<&PathBuf> = of_a.iter().filter(|path| name(path).ends_with(".cbor")).collect();
    fs::copy(cbor[0], cbor[1]).unwrap();
    let (code, message) = place.run("o");
    assert_eq!(code, Some(3), "{message}");
    assert!(message.contains(name(cbor[1])), "{message}");
}

/// A plan whose numbers were changed is not that of the cases beside it.
#[test]
fn a_changed_plan_is_not_united_with_its_cases() {
    let place = Place::new(&JOBS[7]);
    for shard in ["a", "b"] {
        let plan = place.at(shard).join("cases/plan.json");
        let text = fs::read_to_string(&plan).unwrap();
        assert!(text.contains("1.5"), "{text}");
        fs::write(&plan, text.replace("1.5", "1.7")).unwrap();
    }
    let (code, message) = place.run("o");
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("plan.json"), "{message}");
    assert!(contents(&place.at("whole")).len() > 2 && !place.at("o").exists());
}
