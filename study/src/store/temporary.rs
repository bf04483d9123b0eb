//! Names of files that are being written, by which those that a killed program left are known.

use std::fs;
use std::path::Path;
use std::time::Duration;

/// Files of other machines, or of older programs, are left alone until they are this old.
const OLD: Duration = Duration::from_secs(24 * 3600);
const PREFIX: &str = ".arclen-";
/// Letters and digits that the crate `tempfile` adds.
const RANDOM: usize = 6;

/// The beginning of the names of files that this program writes: where it runs, and its number.
pub(super) fn prefix() -> String {
    format!("{PREFIX}{}-{}-", place(), std::process::id())
}

/// Removes what programs that are gone left half written in a folder. One that cannot be removed
/// does no harm.
pub(super) fn tidy(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let Some(writer) = name.to_str().and_then(writer) else { continue };
        let old = || {
            let modified = entry.metadata().and_then(|found| found.modified());
            modified.is_ok_and(|at| at.elapsed().is_ok_and(|age| age > OLD))
        };
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if is_file && (writer == Writer::Gone || old()) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Writer {
    Gone,
    Unknown,
}

/// Who writes a file of this name, if it is one of these.
fn writer(name: &str) -> Option<Writer> {
    let rest = name.strip_prefix(PREFIX)?;
    let is_random =
        |part: &str| part.len() == RANDOM && part.bytes().all(|byte| byte.is_ascii_alphanumeric());
    let parts: Vec<&str> = rest.split('-').collect();
    match parts[..] {
        [random] if is_random(random) => Some(Writer::Unknown),
        [at, number, random] if is_random(random) && at.len() == 8 => {
            let number: u32 = number.parse().ok()?;
            let here = cfg!(target_os = "linux") && at == place();
            let runs = Path::new("/proc").join(number.to_string()).exists();
            // this program has not begun to write
            let gone = here && (!runs || number == std::process::id());
            Some(if gone { Writer::Gone } else { Writer::Unknown })
        }
        _ => None,
    }
}

/// Where the number of a process means something: this start of this machine, and in it the same
/// container.
fn place() -> String {
    let mut text = fs::read("/proc/sys/kernel/random/boot_id").unwrap_or_default();
    if let Ok(space) = fs::read_link("/proc/self/ns/pid") {
        text.extend(space.to_string_lossy().bytes());
    }
    format!("{:08x}", crc32fast::hash(&text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;
    use std::time::SystemTime;

    #[cfg(target_os = "linux")]
    #[test]
    fn only_what_nobody_writes_any_more_is_removed() {
        let place_ = tempfile::tempdir().unwrap();
        let make = |name: &str, age: Duration| {
            let file = File::create(place_.path().join(name)).unwrap();
            file.set_modified(SystemTime::now() - age).unwrap();
        };
        let (new, old) = (Duration::ZERO, 2 * OLD);
        // no machine has so many processes
        let gone = format!("{PREFIX}{}-4294967295-abcDE1", place());
        let parent = std::os::unix::process::parent_id();
        let alive = format!("{PREFIX}{}-{parent}-abcDE1", place());
        make(&gone, new);
        make(&alive, new);
        make(".arclen-00000000-1-abcdef", new);
        make(".arclen-00000000-2-abcdef", old);
        make(".arclen-abcdef", new);
        make(".arclen-abcdeg", old);
        make(".arclen-notes", old);
        make(".arclen-my-own-notes", old);
        make("branch.csv", old);
        tidy(place_.path());
        let mut left: Vec<String> = fs::read_dir(place_.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        left.sort();
        let mut kept = [
            &alive,
            ".arclen-00000000-1-abcdef",
            ".arclen-abcdef",
            ".arclen-my-own-notes",
            ".arclen-notes",
            "branch.csv",
        ]
        .map(str::to_owned);
        kept.sort();
        assert_eq!(left, kept);
    }
}
