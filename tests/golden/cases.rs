//! Small inputs made after public reports of people who do this job, against values that do not come from twin.
//!
//! The folders are not part of the workspace: `cases` is in the folder `shared` next to it, and without it these tests
//! are skipped. `cases.toml` has an entry or more for every folder: what to run and what must be printed. An entry with
//! `later` is still wrong; its expectations are those of the right answer, and the test fails when they hold.

use crate::case::{self, Case, Printed};
use crate::root;
use serde::Deserialize;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// An entry of `cases` in `cases.toml`.
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

/// A known disagreement of two commands about the same program.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Known {
    /// `axes` or `programmed`.
    limits: String,
    /// What they disagree about, as `commands_agree` names it.
    what: Vec<String>,
    /// Folders and programs; all if there are none.
    #[serde(default)]
    programs: Vec<String>,
    /// Why, and what is missing.
    reason: String,
}

/// `cases.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Data {
    cases: Vec<toml::Value>,
    disagreements: Vec<Known>,
}

fn data() -> (Vec<Entry>, Vec<Known>) {
    let file = root().join("tests/golden/cases.toml");
    let text = fs::read_to_string(file).expect("the data file is there");
    let data: Data = toml::from_str(&text).unwrap_or_else(|error| panic!("{error}"));
    (data.cases.into_iter().map(entry).collect(), data.disagreements)
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
        let home = cases.join(&self.folder);
        let copy = case::copy(&home).map_err(|error| error.to_string())?;
        let result = case.check(&home, copy.path());
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
    let (entries, _) = data();
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

/// A program on a machine.
struct Job {
    folder: PathBuf,
    program: String,
    machine: String,
    /// Files that the machine needs.
    case: Option<usize>,
}

/// What two commands say differently about a job.
struct Disagreement {
    limits: &'static str,
    what: String,
    program: String,
    values: String,
}

/// The machine of a command line that reads programs.
fn machine(case: &Case) -> Option<&str> {
    let reads = matches!(case.run.first()?.as_str(), "check" | "limit" | "path");
    let at = case.run.iter().position(|word| word == "--machine")?;
    case.run.get(at + 1).map(String::as_str).filter(|_| reads)
}

/// Programs in a folder.
fn programs(folder: &Path) -> impl Iterator<Item = String> {
    let entries = fs::read_dir(folder).expect("the folder is readable");
    let names = entries.map(|entry| entry.expect("readable").file_name());
    names.filter_map(|name| {
        let name = name.into_string().ok()?;
        let ending = Path::new(&name).extension()?;
        (ending == "cnc" || ending == "ngc").then_some(name)
    })
}

/// Every program of the folders with every machine that an entry of the folder names, and the goldens of `check`.
fn jobs(cases: &Path, entries: &[Entry]) -> Vec<Job> {
    let mut jobs = BTreeMap::new();
    for (index, entry) in entries.iter().enumerate() {
        if let Some(case) = &entry.case
            && let Some(machine) = machine(case)
        {
            let folder = cases.join(&entry.folder);
            for program in programs(&folder) {
                let job = Job {
                    folder: folder.clone(),
                    program: program.clone(),
                    machine: machine.to_owned(),
                    case: Some(index),
                };
                jobs.insert((folder.clone(), program, machine.to_owned()), job);
            }
        }
    }
    for entry in fs::read_dir(root().join("tests/data")).expect("tests/data is there") {
        let folder = entry.expect("readable").path();
        let Ok(text) = fs::read_to_string(folder.join("case.toml")) else { continue };
        let case: Case = toml::from_str(&text).unwrap_or_else(|error| panic!("{error}"));
        if let ["check", program, "--machine", machine] =
            *case.run.iter().map(String::as_str).collect::<Vec<_>>()
        {
            let (program, machine) = (program.to_owned(), machine.to_owned());
            let key = (folder.clone(), program.clone(), machine.clone());
            jobs.insert(key, Job { folder, program, machine, case: None });
        }
    }
    jobs.into_values().collect()
}

/// Rule, line and axis of the errors of a report.
fn errors(report: &Value) -> BTreeSet<(String, u64, String)> {
    let findings = report["findings"].as_array().into_iter().flatten();
    let errors = findings.filter(|finding| finding["severity"] == "error");
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    errors
        .map(|error| {
            (text(&error["rule"]), error["line"].as_u64().unwrap_or(0), text(&error["axis"]))
        })
        .collect()
}

/// Whether numbers differ by more than a millionth.
fn differ(one: &Value, other: &Value) -> bool {
    match (one.as_f64(), other.as_f64()) {
        (Some(one), Some(other)) => {
            (one - other).abs() > 1e-6 * one.abs().max(other.abs()).max(1e-3)
        }
        _ => one != other,
    }
}

/// Duration of the longest program that is compared, by F and E alone, s.
const LONGEST_S: f64 = 10.65;

/// Longest program that is run on the simulated machine, s.
const LONGEST_RUN_S: f64 = 1.5;

/// The duration among the key figures of a program, s.
fn duration(info: &str) -> Option<f64> {
    let line = info.lines().find_map(|line| line.strip_prefix("duration"))?;
    line.trim().strip_suffix(" s")?.parse().ok()
}

impl Job {
    /// The disagreements of the commands, none if the program cannot be decoded or takes long.
    fn disagreements(&self, entries: &[Entry]) -> Result<Vec<Disagreement>, String> {
        let copy = case::copy(&self.folder).map_err(|error| error.to_string())?;
        let folder = copy.path();
        if let Some(case) = self.case.and_then(|index| entries[index].case.as_ref()) {
            case.write_files(&self.folder, folder)?;
        }
        let info = self.twin(folder, "path", &["--format", "info"])?;
        if info.status != Some(0) || duration(&info.stdout).is_none_or(|time| time > LONGEST_S) {
            return Ok(Vec::new());
        }
        let mut found = Vec::new();
        for limits in ["axes", "programmed"] {
            let options = ["--limits", limits, "--format", "json"];
            let check = self.twin(folder, "check", &options)?;
            let limit = self.twin(folder, "limit", &options)?;
            let reports = [&check, &limit].map(|printed| serde_json::from_str(&printed.stdout));
            let [Ok(checked), Ok(limited)] = reports else {
                if check.status == limit.status {
                    continue;
                }
                return Err(format!("no reports: {}{}", check.stderr, limit.stderr));
            };
            self.compare_limit(limits, &checked, &limited, &mut found);
            self.compare_run(folder, limits, (&check, &checked), &mut found)?;
        }
        Ok(found)
    }

    fn twin(&self, folder: &Path, command: &str, more: &[&str]) -> Result<Printed, String> {
        let words = [command, &self.program, "--machine", &self.machine];
        let words: Vec<_> = words.iter().chain(more).map(|&word| word.to_owned()).collect();
        case::run(folder, &words, None)
    }

    fn add(
        &self,
        found: &mut Vec<Disagreement>,
        limits: &'static str,
        what: String,
        values: String,
    ) {
        let folder = self.folder.file_name().unwrap_or_default().to_string_lossy();
        let program = format!("{folder}/{} on {}", self.program, self.machine);
        found.push(Disagreement { limits, what, program, values });
    }

    /// `check` and `limit`: errors, peaks, length and duration.
    fn compare_limit(
        &self,
        limits: &'static str,
        check: &Value,
        limit: &Value,
        found: &mut Vec<Disagreement>,
    ) {
        let (one, other) = (errors(check), errors(limit));
        for error in one.symmetric_difference(&other) {
            let by = if one.contains(error) { "check" } else { "limit" };
            let what = format!("error of {by} only: {}", error.0);
            self.add(found, limits, what, format!("line {} {}", error.1, error.2));
        }
        for key in ["length_mm", "duration_s"] {
            if differ(&check[key], &limit[key]) {
                self.add(found, limits, key.to_owned(), format!("{} {}", check[key], limit[key]));
            }
        }
        // Peaks of a program that ends in an error are those of the part before it.
        if !one.is_empty() || !other.is_empty() {
            return;
        }
        let peaks = check["peak"].as_object().into_iter().flatten();
        for (axis, peak) in peaks {
            for (quantity, key) in [
                ("position", "min"),
                ("position", "max"),
                ("velocity", "value"),
                ("acceleration", "value"),
                ("jerk", "value"),
            ] {
                let values = (&peak[quantity][key], &limit["peak"][axis][quantity][key]);
                if differ(values.0, values.1) {
                    let values = format!("{axis} {} {}", values.0, values.1);
                    self.add(found, limits, format!("peak {quantity}"), values);
                }
            }
        }
    }

    /// `check` and `run`: what refuses a program, or the report of a run.
    fn compare_run(
        &self,
        folder: &Path,
        limits: &'static str,
        (check, checked): (&Printed, &Value),
        found: &mut Vec<Disagreement>,
    ) -> Result<(), String> {
        let run = ["--limits", limits, "--drives", "none", "--report", "run.json"];
        if check.status == Some(0) {
            if checked["duration_s"].as_f64().is_none_or(|duration| duration > LONGEST_RUN_S) {
                return Ok(());
            }
            let ran = self.twin(folder, "run", &run)?;
            let text = fs::read_to_string(folder.join("run.json"));
            let text = text.map_err(|error| format!("{error}: {}", ran.stderr))?;
            let report: Value = serde_json::from_str(&text).map_err(|error| error.to_string())?;
            for key in ["findings", "peak", "length_mm", "duration_s"] {
                if checked[key] != report[key] {
                    let values = format!("{}\n{}", checked[key], report[key]);
                    self.add(found, limits, format!("run: {key}"), values);
                }
            }
            return Ok(());
        }
        let texts =
            [self.twin(folder, "check", &["--limits", limits])?, self.twin(folder, "run", &run)?];
        let [checked, refused] = texts.map(|printed| {
            let lines = [printed.stdout, printed.stderr].concat();
            let lines = lines.lines().filter(|line| !line.contains(" is read as "));
            (printed.status, lines.collect::<Vec<_>>().join("\n"))
        });
        if checked != refused {
            let values = format!("{checked:?}\n{refused:?}");
            self.add(found, limits, "run: refusal".to_owned(), values);
        }
        Ok(())
    }
}

impl Known {
    fn covers(&self, disagreement: &Disagreement) -> bool {
        let program = disagreement.program.as_str();
        self.limits == disagreement.limits
            && self.what.contains(&disagreement.what)
            && (self.programs.is_empty()
                || self.programs.iter().any(|name| program.starts_with(name)))
    }
}

/// `check`, `limit` and `run` plan the same motion, so they agree on errors and peaks.
#[test]
fn commands_agree() {
    let Some(cases) = cases() else { return };
    let (entries, known) = data();
    let jobs = jobs(&cases, &entries);
    assert!(jobs.len() > 100, "only {} programs found", jobs.len());
    let found = Mutex::new(Vec::new());
    let mut failures = in_parallel(&jobs, |job| {
        let disagreements = job.disagreements(&entries);
        let disagreements = disagreements
            .map_err(|error| format!("{}/{}: {error}", job.folder.display(), job.program))?;
        found.lock().expect("no thread panics").extend(disagreements);
        Ok(())
    });
    let found = found.into_inner().expect("no thread panics");
    for disagreement in &found {
        if !known.iter().any(|known| known.covers(disagreement)) {
            let Disagreement { limits, what, program, values } = disagreement;
            failures.push(format!("{program}, --limits {limits}: {what}: {values}"));
        }
    }
    for known in &known {
        if !found.iter().any(|disagreement| known.covers(disagreement)) {
            let Known { limits, what, reason, .. } = known;
            failures.push(format!("--limits {limits}, {what:?}: they agree now, but: {reason}"));
        }
    }
    failures.sort();
    assert!(failures.is_empty(), "{} failures:\n{}", failures.len(), failures.join("\n"));
}
