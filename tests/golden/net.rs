//! Regression net: hashes of the output of every program on every machine, so that moved code cannot change behaviour
//! unseen.
//!
//! The programs of `tests/data/net` and the shipped examples, each on every shipped machine: set-points, `check` and
//! `limit` as JSON. The hashes do not prove correctness; independent expectations are in the other tests. They prove
//! that a refactoring changed no output. An intended change of a verdict or a message rewrites them in a commit of its
//! own:
//!
//! ```sh
//! TWIN_NET=write cargo test -p twin --test golden -- net
//! ```
//!
//! `TWIN_NET_OUTPUT=DIR` keeps the hashed texts, so that those of two commits can be compared line by line.

use crate::desk::BINARY;
use crate::root;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};
use std::sync::Mutex;
use std::{env, fs, thread};

/// Hashed outputs of each program on each machine: a name, the command and what follows the program and the machine.
const OUTPUTS: [(&str, &str, &[&str]); 3] = [
    ("setpoints", "path", &["--format", "setpoints"]),
    ("check", "check", &["--limits", "programmed", "--drives", "predicted", "--format", "json"]),
    ("limit", "limit", &["--without", "axis-jerk", "--format", "json"]),
];
/// Machines with jerk limits. Solutions of convex programs differ between processors by more than the last bits, so that of
/// these plans the duration counts, s: to this part of it, and to a cycle.
const JERK_LIMITED: [&str; 3] = ["gantry3", "scara2", "tripod"];
const SAME_DURATION: f64 = 1e-4;
const CYCLE_S: f64 = 1e-3;

/// Significant digits that count: other processors may differ in the last bits of sines and solutions.
const DIGITS: usize = 6;
/// Numbers below this are rounding errors of 0.
const ZERO: f64 = 1e-7;

/// The files in `folder` with one of these endings, sorted.
pub(crate) fn files(folder: &str, endings: &[&str]) -> Vec<PathBuf> {
    let listed = fs::read_dir(root().join(folder)).expect("the folder is there");
    let mut files: Vec<_> = listed
        .map(|entry| entry.expect("readable").path())
        .filter(|path| {
            path.extension().is_some_and(|ending| endings.iter().any(|one| ending == *one))
        })
        .collect();
    files.sort();
    files
}

fn stem(path: &Path) -> String {
    path.file_stem().expect("a file").to_string_lossy().into_owned()
}

/// `text` with every number rounded to [`DIGITS`] significant digits.
pub(crate) fn rounded(text: &str) -> String {
    let numeric = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | 'e' | 'E');
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit() || c == '-') {
        out.push_str(&rest[..start]);
        let tail = &rest[start..];
        let token = &tail[..tail.find(|c| !numeric(c)).unwrap_or(tail.len())];
        match token.parse::<f64>() {
            Ok(value) if value.abs() < ZERO => out.push('0'),
            Ok(value) => write!(out, "{value:.*e}", DIGITS - 1).expect("a string"),
            Err(_) => out.push_str(token),
        }
        rest = &tail[token.len()..];
    }
    out + rest
}

/// Exit status and standard output of one command, rounded.
fn output(command: &str, program: &Path, machine: &Path, options: &[&str]) -> String {
    let (status, text) = ran(command, program, machine, options);
    // Paths of machine files depend on where the checkout is.
    let text = text.replace(&root().display().to_string(), "");
    format!("{}\n{status}", rounded(&text))
}

fn ran(command: &str, program: &Path, machine: &Path, options: &[&str]) -> (ExitStatus, String) {
    let folder = program.parent().expect("a folder");
    let ran = Command::new(BINARY)
        .arg(command)
        .arg(program.file_name().expect("a file"))
        .arg("--machine")
        .arg(machine)
        .args(options)
        .current_dir(folder)
        .output()
        .expect("the binary runs");
    (ran.status, String::from_utf8_lossy(&ran.stdout).into_owned())
}

/// Duration of the plan within the limits of the axes, s. No window of it may fail or exceed its limits.
fn duration(program: &Path, machine: &Path) -> String {
    let text = ran("limit", program, machine, &["--format", "json"]).1;
    let report: serde_json::Value = serde_json::from_str(&text).expect("a report");
    for windows in ["windows_failed", "windows_exceeded"] {
        assert_eq!(report[windows], 0, "{} on {}", program.display(), machine.display());
    }
    report["duration_s"].to_string()
}

/// Hashes that are equal, or durations that are nearly so.
fn same(expected: Option<&String>, found: Option<&String>) -> bool {
    let seconds = |text: Option<&String>| text.filter(|text| text.contains('.'))?.parse().ok();
    match [expected, found].map(seconds) {
        [Some::<f64>(expected), Some::<f64>(found)] => {
            (found - expected).abs() <= CYCLE_S.max(SAME_DURATION * expected) + 1e-9
        }
        _ => expected == found,
    }
}

#[test]
fn no_behaviour_changes_unseen() {
    let programs: Vec<_> = files("tests/data/net", &["cnc", "ngc"])
        .into_iter()
        .chain(files("examples", &["cnc", "ngc"]))
        .collect();
    let machines = files("machines", &["toml"]);
    let work: Vec<_> = programs
        .iter()
        .flat_map(|program| machines.iter().map(move |machine| (program, machine)))
        .collect();
    let kept = env::var_os("TWIN_NET_OUTPUT").map(PathBuf::from);
    let next = Mutex::new(work.iter());
    let found = Mutex::new(BTreeMap::new());
    let cores = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        for _ in 0..cores {
            scope.spawn(|| {
                loop {
                    let Some((program, machine)) = next.lock().expect("no panic").next() else {
                        return;
                    };
                    for (name, command, options) in OUTPUTS {
                        let text = output(command, program, machine, options);
                        let key = format!("{}\t{}\t{name}", stem(program), stem(machine));
                        if let Some(folder) = &kept {
                            let file = folder.join(key.replace('\t', "-"));
                            fs::write(file, &text).expect("TWIN_NET_OUTPUT is a folder");
                        }
                        let hash = crc32fast::hash(text.as_bytes());
                        found.lock().expect("no panic").insert(key, format!("{hash:08x}"));
                    }
                    if JERK_LIMITED.contains(&stem(machine).as_str()) {
                        let key = format!("{}\t{}\tduration", stem(program), stem(machine));
                        let duration = duration(program, machine);
                        found.lock().expect("no panic").insert(key, duration);
                    }
                }
            });
        }
    });
    let found = found.into_inner().expect("no panic");
    let path = root().join("tests/data/net/expected.tsv");
    if env::var_os("TWIN_NET").is_some_and(|value| value == "write") {
        let lines: Vec<_> = found.iter().map(|(key, hash)| format!("{key}\t{hash}\n")).collect();
        let lines = lines.concat();
        fs::write(&path, lines).expect("writable");
    }
    let text = fs::read_to_string(&path).expect("the hashes are there");
    let expected: BTreeMap<_, _> = text
        .lines()
        .filter_map(|line| line.rsplit_once('\t'))
        .map(|(key, hash)| (key.to_owned(), hash.to_owned()))
        .collect();
    let keys = expected.keys().chain(found.keys()).collect::<std::collections::BTreeSet<_>>();
    let changed: Vec<_> = keys
        .into_iter()
        .filter(|key| !same(expected.get(*key), found.get(*key)))
        .cloned()
        .collect();
    assert!(
        changed.is_empty(),
        "{} of {} outputs changed (see the head of tests/golden/net.rs):\n{}",
        changed.len(),
        expected.len(),
        changed.join("\n")
    );
}
