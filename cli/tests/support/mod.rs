//! Helpers of tests that run the program, damage what it keeps, and compare folders.
#![allow(clippy::unwrap_used, dead_code, reason = "helpers of tests; not every test needs all")]

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// The program in a folder; what it prints is not looked at.
pub(crate) fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_arclen"));
    command.args(arguments).current_dir(folder).stdout(Stdio::null());
    command
}

pub(crate) fn arclen(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().unwrap()
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

pub(crate) fn name(path: &Path) -> &str {
    path.file_name().unwrap().to_str().unwrap()
}

/// The files of a folder, in order.
pub(crate) fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = entries.filter(|path| path.is_file()).collect();
    files.sort();
    files
}

/// The same with those of the folders in it.
pub(crate) fn all_files(folder: &Path) -> Vec<PathBuf> {
    let mut all = files(folder);
    for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
        if entry.path().is_dir() {
            all.extend(all_files(&entry.path()));
        }
    }
    all.sort();
    all
}

pub(crate) fn names(folder: &Path) -> Vec<String> {
    files(folder).iter().map(|path| name(path).to_owned()).collect()
}

pub(crate) fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().map(Result::unwrap) {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// The files of a folder, its JSON without times and without the checksums of files with times.
pub(crate) fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    fn timeless(value: &mut Value) {
        match value {
            Value::Object(map) => {
                map.remove("seconds");
                map.values_mut().for_each(timeless);
            }
            Value::Array(all) => all.iter_mut().for_each(timeless),
            _ => {}
        }
    }
    let read = |path: PathBuf| {
        let name = name(&path).to_owned();
        let mut bytes = fs::read(&path).unwrap();
        if name.ends_with(".json") {
            let mut json: Value = serde_json::from_slice(&bytes).unwrap();
            timeless(&mut json);
            bytes = json.to_string().into_bytes();
        }
        (name, bytes)
    };
    files(folder).into_iter().map(read).collect()
}

#[track_caller]
pub(crate) fn equal(one: &Path, other: &Path, said: &str) {
    assert_eq!(names(one), names(other), "{said}");
    for ((name, a), (_, b)) in contents(one).into_iter().zip(contents(other)) {
        assert!(a == b, "{name} differs: {said}");
    }
}

/// Numbers that look random and are the same every time.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn below(&mut self, limit: usize) -> usize {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % limit
    }

    /// Damages a file in one of the ways in which files are damaged; says how.
    pub(crate) fn damage(&mut self, path: &Path) -> String {
        let mut bytes = fs::read(path).unwrap();
        let length = bytes.len().max(1);
        bytes.resize(length, 0);
        let how = match self.below(6) {
            0..=2 => {
                let (at, bit) = (self.below(length), self.below(8));
                bytes[at] ^= 1 << bit;
                format!("bit {bit} of byte {at}")
            }
            3 => {
                let at = self.below(length);
                bytes.truncate(at);
                format!("cut at {at}")
            }
            4 => {
                bytes.clear();
                "empty".to_owned()
            }
            _ => {
                let from = self.below(length);
                bytes[from..].fill(0);
                bytes.push(0);
                format!("zeros from {from}")
            }
        };
        fs::write(path, bytes).unwrap();
        format!("{}: {how}", path.display())
    }

    /// Does to one of these files, or to two of them, whatever may happen to files; says what.
    pub(crate) fn corrupt(&mut self, files: &[PathBuf]) -> String {
        let path = &files[self.below(files.len())];
        let other = &files[self.below(files.len())];
        let (shown, of) = (path.display(), other.display());
        match self.below(10) {
            0..=5 => self.damage(path),
            6 => {
                let mut bytes = fs::read(path).unwrap();
                let more = 1 + self.below(40);
                bytes.extend((0..more).map(|_| self.below(256) as u8));
                fs::write(path, bytes).unwrap();
                format!("{shown}: {more} bytes more")
            }
            7 => {
                fs::remove_file(path).unwrap();
                format!("{shown}: removed")
            }
            8 => {
                let (one, two) = (fs::read(path).unwrap(), fs::read(other).unwrap());
                fs::write(path, two).unwrap();
                fs::write(other, one).unwrap();
                format!("{shown} and {of}: exchanged")
            }
            _ => {
                fs::write(path, fs::read(other).unwrap()).unwrap();
                format!("{shown}: a copy of {of}")
            }
        }
    }
}
