//! What an earlier run left in a folder, and which of it is out of date.
//!
//! Every JSON that a command writes lists the files written with it and their CRC-32: the folder
//! says itself what is the program's. A file that has been changed since is somebody's work.

use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// The JSON of the commands whose results are those of the one case in `case.toml`.
const OF_A_CASE: [&str; 5] =
    ["events.json", "diagram.json", "orbits.json", "cycle.json", "map.json"];
const CASE: &str = "case.toml";

/// Files of a run, with their checksums.
pub type Files = BTreeMap<String, u32>;

/// A JSON with the list of files added at its end.
pub fn with_files(json: &str, files: &Files) -> String {
    let Some(text) = json.strip_suffix("\n}\n").filter(|_| !files.is_empty()) else {
        return json.to_owned();
    };
    let mut out = format!("{text},\n  \"files\": {{");
    for (at, (name, sum)) in files.iter().enumerate() {
        let comma = if at == 0 { "" } else { "," };
        let _ = write!(out, "{comma}\n    {}: \"{sum:08x}\"", Value::from(name.as_str()));
    }
    out + "\n  }\n}\n"
}

/// The files that earlier runs wrote to a folder.
#[derive(Debug, Default)]
pub struct Earlier {
    /// Those that the present run does not keep, unless it writes them again.
    stale: Files,
    /// JSON files that list them.
    lists: Vec<String>,
}

impl Earlier {
    /// What is in the folder before a run writes its files: `json` is the list that it replaces,
    /// `case` the text of its case, where it has one.
    pub fn read(folder: &Path, json: &str, case: Option<&str>) -> Self {
        let mut earlier = Earlier::default();
        let other = case.is_some_and(|case| {
            fs::read(folder.join(CASE)).is_ok_and(|kept| kept != case.as_bytes())
        });
        let of_a_case = OF_A_CASE.contains(&json) && other;
        let lists = OF_A_CASE.iter().filter(|list| of_a_case && **list != json).chain([&json]);
        for list in lists {
            let Some(files) = files_of(&folder.join(list)) else { continue };
            earlier.stale.extend(files);
            earlier.lists.push((*list).to_owned());
        }
        earlier
    }

    /// Removes what is out of date, as far as it is as it was written; `spared` are never removed.
    pub fn remove(self, folder: &Path, kept: &Files, spared: &[PathBuf]) {
        let spared: Vec<PathBuf> = spared.iter().filter_map(|p| fs::canonicalize(p).ok()).collect();
        let may_go = |path: &Path| {
            let is_file = fs::symlink_metadata(path).is_ok_and(|found| found.is_file());
            is_file && fs::canonicalize(path).is_ok_and(|found| !spared.contains(&found))
        };
        for (name, sum) in self.stale.iter().filter(|(name, _)| !kept.contains_key(*name)) {
            let path = folder.join(name);
            let is_own = fs::read(&path).is_ok_and(|bytes| crc32fast::hash(&bytes) == *sum);
            if is_own && may_go(&path) {
                // one that stays is out of date, and no more
                let _ = fs::remove_file(&path);
                if let Some(parent) = path.parent().filter(|parent| *parent != folder) {
                    // only an empty one goes
                    let _ = fs::remove_dir(parent);
                }
            }
        }
        for list in self.lists.iter().filter(|list| !kept.contains_key(*list)) {
            let path = folder.join(list);
            if may_go(&path) {
                let _ = fs::remove_file(path);
            }
        }
    }
}

/// The files that a JSON lists, if it lists some.
fn files_of(path: &Path) -> Option<Files> {
    let json: Value = serde_json::from_slice(&fs::read(path).ok()?).ok()?;
    let listed = json.get("files")?.as_object()?;
    let entry = |(name, sum): (&String, &Value)| {
        // nothing outside the folder is the program's
        let inside = Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
        let sum = u32::from_str_radix(sum.as_str()?, 16).ok()?;
        inside.then(|| (name.clone(), sum))
    };
    Some(listed.iter().filter_map(entry).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(folder: &Path, json: &str, case: &str, files: &[&str]) {
        let mut sums = Files::new();
        for name in files {
            let text = format!("{name} of {case}");
            fs::create_dir_all(folder.join(name).parent().unwrap()).unwrap();
            fs::write(folder.join(name), &text).unwrap();
            sums.insert((*name).to_owned(), crc32fast::hash(text.as_bytes()));
        }
        fs::write(folder.join(CASE), case).unwrap();
        fs::write(folder.join(json), with_files("{\n  \"a\": 1\n}\n", &sums)).unwrap();
    }

    fn run(folder: &Path, json: &str, case: &str, files: &[&str]) {
        let earlier = Earlier::read(folder, json, Some(case));
        write(folder, json, case, files);
        let kept = files.iter().chain(&[json, CASE]).map(|name| ((*name).to_owned(), 0)).collect();
        earlier.remove(folder, &kept, &[]);
    }

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_list_at_the_end_of_a_json_is_read_again() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("a.json");
        let mut files =
            Files::from([("b \"c\".csv".to_owned(), 7), ("data/x".to_owned(), u32::MAX)]);
        fs::write(&path, with_files("{\n  \"a\": 1\n}\n", &files)).unwrap();
        assert_eq!(files_of(&path).unwrap(), files);
        for outside in ["../x", "/x", "a/../../x"] {
            files.insert(outside.to_owned(), 1);
        }
        fs::write(&path, with_files("{\n  \"a\": 1\n}\n", &files)).unwrap();
        assert_eq!(files_of(&path).unwrap().len(), 2);
    }

    #[test]
    fn what_is_out_of_date_goes_and_what_is_not_the_program_s_stays() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path();
        run(folder, "diagram.json", "a", &["branch-0.csv", "branch-1.csv", "report.html", "d/e"]);
        run(folder, "events.json", "a", &["branch.csv"]);
        assert!(names(folder).contains(&"report.html".to_owned()));
        fs::write(folder.join("branch-7.csv"), "mine").unwrap();
        fs::write(folder.join("branch-1.csv"), "changed").unwrap();
        // the same command with another case, and then another command with a third one
        run(folder, "diagram.json", "b", &["branch-0.csv"]);
        let left = ["branch-0.csv", "branch-1.csv", "branch-7.csv", "case.toml", "diagram.json"];
        assert_eq!(names(folder), left);
        run(folder, "events.json", "c", &["branch.csv"]);
        let left = ["branch-1.csv", "branch-7.csv", "branch.csv", "case.toml", "events.json"];
        assert_eq!(names(folder), left);
    }
}
