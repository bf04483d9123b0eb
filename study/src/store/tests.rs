//! The output folder.

use super::folder::{Folder, FolderError};
use std::fs;

#[test]
fn checking_creates_nothing_and_writing_creates_all() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("a/b");
    let folder = Folder::check(&path, &["x.csv"]).unwrap();
    assert_eq!(fs::read_dir(place.path()).unwrap().count(), 0);
    folder.write(&[("x.csv".into(), b"1".to_vec())]).unwrap();
    folder.write(&[("x.csv".into(), b"2".to_vec()), ("y".into(), vec![])]).unwrap();
    assert_eq!(fs::read(path.join("x.csv")).unwrap(), b"2");
    let names: Vec<_> = fs::read_dir(&path).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names.len(), 2, "{names:?}");
}

#[cfg(unix)]
#[test]
fn files_can_be_read_by_those_whom_the_umask_allows() {
    use std::os::unix::fs::PermissionsExt;
    let place = tempfile::tempdir().unwrap();
    let plain = place.path().join("plain");
    fs::write(&plain, "").unwrap();
    let folder = Folder::check(place.path(), &[]).unwrap();
    folder.write(&[("x".into(), vec![])]).unwrap();
    let mode = |path: &std::path::Path| fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&place.path().join("x")), mode(&plain));
}

#[test]
fn what_is_in_the_way_is_named() {
    let place = tempfile::tempdir().unwrap();
    let file = place.path().join("file");
    fs::write(&file, "").unwrap();
    let error = Folder::check(&file.join("deep/out"), &[]).unwrap_err();
    assert!(matches!(error, FolderError::NotAFolder { .. }), "{error}");
    assert!(error.to_string().contains(&format!("{} is not a folder", file.display())), "{error}");
    fs::create_dir(place.path().join("branch.csv")).unwrap();
    let error = Folder::check(place.path(), &["branch.csv"]).unwrap_err();
    assert!(error.to_string().contains("branch.csv is a folder"), "{error}");
    let error = Folder::check(&place.path().join("new/../out"), &[]).unwrap_err();
    assert!(error.to_string().contains("after a folder to be made"), "{error}");
    assert!(matches!(Folder::check("".as_ref(), &[]), Err(FolderError::Empty)));
}

#[cfg(unix)]
#[test]
fn a_link_that_leads_nowhere_is_no_folder() {
    let place = tempfile::tempdir().unwrap();
    let link = place.path().join("link");
    std::os::unix::fs::symlink(place.path().join("gone"), &link).unwrap();
    assert!(Folder::check(&link.join("out"), &[]).is_err());
}

#[cfg(target_os = "linux")]
#[test]
fn a_place_that_refuses_is_found_out_before_the_work() {
    let error = Folder::check("/proc/arclen/out".as_ref(), &[]).unwrap_err();
    assert!(matches!(error, FolderError::NotWritable { .. }), "{error}");
    assert!(error.to_string().contains("/proc"), "{error}");
}
