//! Whole runs of the `twin` binary against expectations that do not come from it.
//!
//! Every folder of `tests/data` is a case: `case.toml` says what to run, with which exit status it must end, what it
//! must print, and, always, where the expected values come from. Paths are relative to the folder; `machines/` and
//! `examples/` at the beginning of an argument are those of the workspace.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test that cannot be set up has failed"
)]

mod cam;
mod cam_extremes;
mod cam_forms;
mod check_limits;
mod collision;
mod compare;
mod drive;
mod drive_beforehand;
mod drive_home;
mod drive_repair;
mod drive_stop;
mod drive_words;
mod emulate;
mod explain;
mod in_loop;
mod job;
mod job_cams;
mod job_steps;
mod limit;
mod machine;
mod motors;
mod net;
mod path;
mod process;
mod program_text;
mod real;
mod real_encoders;
mod real_stops;
mod real_switches;
mod recording;
mod reference;
mod run_keys;
mod run_limits;
mod sequence;
mod shop;
mod surroundings;
mod switch_points;
mod targets;
mod tune_alike;
mod tune_cam;
mod tune_least;
mod tune_limits;
mod tune_recorded;
mod tune_start;
mod tune_tappets;
mod tuning;
mod urdf;
mod verdict;

use serde::Deserialize;
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// `case.toml`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Case {
    /// Where the expected values come from.
    source: String,
    /// Arguments of `twin`.
    run: Vec<String>,
    /// File given on standard input.
    stdin: Option<String>,
    /// Exit status.
    status: i32,
    /// File with the expected standard output: JSON lines (every key given must be there with that value) or CSV.
    stdout: Option<String>,
    /// Numbers may differ by this much.
    #[serde(default = "exact")]
    tolerance: f64,
    /// Of the numbers under these keys instead.
    #[serde(default)]
    tolerances: BTreeMap<String, f64>,
    /// Texts that standard error must contain, however it is wrapped.
    #[serde(default)]
    stderr: Vec<String>,
    /// Text that standard error must contain as it is, blanks and line ends included.
    picture: Option<String>,
}

fn exact() -> f64 {
    0.0
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("the workspace is above the crate")
        .to_owned()
}

/// A word of a command line. `machines/`, `examples/` and `tests/` at its beginning are those of the workspace.
fn word(word: &str) -> OsString {
    let shipped = ["machines/", "examples/", "tests/"].iter().any(|at| word.starts_with(at));
    if shipped { root().join(word).into_os_string() } else { word.into() }
}

fn folders(path: &Path) -> Vec<PathBuf> {
    let mut folders: Vec<_> = fs::read_dir(path)
        .expect("tests/data is there")
        .map(|entry| entry.expect("readable").path())
        .filter(|path| path.join("case.toml").is_file())
        .collect();
    folders.sort();
    folders
}

/// Runs one case; the error says everything that is wrong.
fn check(folder: &Path) -> Result<(), String> {
    let text = fs::read_to_string(folder.join("case.toml")).map_err(|error| error.to_string())?;
    let case: Case = toml::from_str(&text).map_err(|error| error.to_string())?;
    if case.source.len() < 20 {
        return Err("`source` does not say where the expected values come from".to_owned());
    }
    let mut child = Command::new(process::BINARY)
        .args(case.run.iter().map(|argument| word(argument)))
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| error.to_string())?;
    if let (Some(name), Some(mut stdin)) = (&case.stdin, child.stdin.take()) {
        let input = fs::read(folder.join(name)).map_err(|error| error.to_string())?;
        stdin.write_all(&input).map_err(|error| error.to_string())?;
    }
    let output = child.wait_with_output().map_err(|error| error.to_string())?;
    let (stdout, stderr) =
        (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    let mut wrong = Vec::new();
    if output.status.code() != Some(case.status) {
        wrong.push(format!("exit status {:?}, expected {}", output.status.code(), case.status));
    }
    for text in &case.stderr {
        // Long messages are wrapped; what counts is the words.
        let words = |text: &str| {
            text.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
        };
        if !words(&stderr).contains(&words(text)) {
            wrong.push(format!("standard error lacks {text:?}"));
        }
    }
    if let Some(picture) = &case.picture
        && !stderr.contains(picture.trim_matches('\n'))
    {
        wrong.push(format!("standard error lacks\n{picture}"));
    }
    if let Some(name) = &case.stdout {
        let expected = fs::read_to_string(folder.join(name)).map_err(|error| error.to_string())?;
        wrong.extend(if Path::new(name).extension().is_some_and(|ending| ending == "csv") {
            compare::csv(&expected, &stdout, case.tolerance)
        } else {
            compare::json_lines(&expected, &stdout, case.tolerance, &case.tolerances)
        });
    }
    if wrong.is_empty() {
        return Ok(());
    }
    Err(format!(
        "{}\n--- standard output\n{stdout}\n--- standard error\n{stderr}",
        wrong.join("\n")
    ))
}

#[test]
fn every_case_of_tests_data() {
    let folders = folders(&root().join("tests/data"));
    assert!(folders.len() >= 10, "only {} cases found", folders.len());
    let failures: Vec<_> = folders
        .iter()
        .filter_map(|folder| {
            check(folder).err().map(|error| format!("{}: {error}", folder.display()))
        })
        .collect();
    assert!(
        failures.is_empty(),
        "{} of {} cases:\n{}",
        failures.len(),
        folders.len(),
        failures.join("\n\n")
    );
}
