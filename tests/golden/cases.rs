//! Small inputs made after public reports of people who do this job, against values that do not come from twin.
//!
//! The folders are not part of the workspace: `cases` is in the folder `shared` next to it, and without it these tests
//! are skipped. `cases.toml` has an entry or more for every folder: what to run and what must be printed. An entry with
//! `later` is still wrong; its expectations are those of the right answer, and the test fails when they hold.

use crate::case::{self, Case};
use crate::root;
use std::collections::BTreeSet;
use std::fs;
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// An entry of `cases.toml`.
struct Entry {
    folder: String,
    /// What is missing, of a case that is still wrong.
    later: Option<String>,
    /// What to run; absent where a test of its own covers the folder.
    case: Option<Case>,
}

/// The folder with the cases, if it is there; says so if it is not.
fn cases() -> Option<PathBuf> {
    let folder = root().join("../shared/cases");
    if !folder.is_dir() {
        println!("skipped: no folder {}", folder.display());
        return None;
    }
    folder.canonicalize().ok()
}

/// The entries of `cases.toml`.
fn entries() -> Vec<Entry> {
    let file = root().join("tests/golden/cases.toml");
    let text = fs::read_to_string(file).expect("the data file is there");
    let mut tables: toml::Table = text.parse().expect("the data file is TOML");
    let cases = match tables.remove("cases") {
        Some(toml::Value::Array(cases)) => cases,
        other => panic!("`cases` is not a list: {other:?}"),
    };
    assert!(tables.is_empty(), "unknown keys: {tables:?}");
    cases.into_iter().map(entry).collect()
}

fn entry(value: toml::Value) -> Entry {
    let toml::Value::Table(mut table) = value else { panic!("{value} is not a table") };
    let mut take = |key: &str| {
        table.remove(key).map(|value| value.as_str().expect("text is expected").to_owned())
    };
    let folder = take("folder").expect("every entry names its folder");
    let (later, test) = (take("later"), take("test"));
    let case = if test.is_some() {
        assert!(table.is_empty(), "{folder}: an entry with `test` has no other keys: {table}");
        None
    } else {
        Some(table.try_into().unwrap_or_else(|error| panic!("{folder}: {error}")))
    };
    Entry { folder, later, case }
}

impl Entry {
    /// Runs the case in a copy of its folder.
    fn check(&self, cases: &Path) -> Result<(), String> {
        let Some(case) = &self.case else { return Ok(()) };
        let copy = case::copy(&cases.join(&self.folder)).map_err(|error| error.to_string())?;
        let result = case.check(copy.path());
        match (&self.later, result) {
            (None, result) => result.map_err(|error| format!("{:?}\n{error}", case.run)),
            (Some(_), Err(_)) => Ok(()),
            (Some(reason), Ok(())) => {
                Err(format!("{:?} is right now, but `later` says: {reason}", case.run))
            }
        }
    }
}

/// Does `act` with every item, on as many threads as there are processors; collects the errors in the order of the items.
fn in_parallel<T: Sync>(items: &[T], act: impl Fn(&T) -> Result<(), String> + Sync) -> Vec<String> {
    let next = Mutex::new(items.iter().enumerate());
    let errors = Mutex::new(Vec::new());
    let threads = std::thread::available_parallelism().map_or(1, NonZero::get);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let item = next.lock().expect("no thread panics").next();
                    let Some((index, item)) = item else { break };
                    if let Err(error) = act(item) {
                        errors.lock().expect("no thread panics").push((index, error));
                    }
                }
            });
        }
    });
    let mut errors = errors.into_inner().expect("no thread panics");
    errors.sort();
    errors.into_iter().map(|(_, error)| error).collect()
}

/// The names of the folders.
fn names(cases: &Path) -> BTreeSet<String> {
    fs::read_dir(cases)
        .expect("the folder is readable")
        .map(|entry| entry.expect("readable"))
        .filter(|entry| entry.path().is_dir())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect()
}

#[test]
fn every_case_is_right() {
    let Some(cases) = cases() else { return };
    let entries = entries();
    let folders = names(&cases);
    let mut failures: Vec<_> = folders
        .iter()
        .filter(|folder| !entries.iter().any(|entry| entry.folder == **folder))
        .map(|folder| format!("{folder}: no entry in cases.toml"))
        .collect();
    failures.extend(
        entries
            .iter()
            .filter(|entry| !folders.contains(&entry.folder))
            .map(|entry| format!("{}: an entry without a folder", entry.folder)),
    );
    failures.extend(in_parallel(&entries, |entry| {
        entry.check(&cases).map_err(|error| format!("{}: {error}", entry.folder))
    }));
    assert!(failures.is_empty(), "{} failures:\n{}", failures.len(), failures.join("\n\n"));
}
