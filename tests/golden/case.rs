//! A run of the binary with what it must print: the entries of `case.toml` and of `cases.toml`.

use crate::{canonical, compare, desk, root, word};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

/// `case.toml`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Case {
    /// Where the expected values come from.
    #[serde(default)]
    pub(crate) source: String,
    /// Arguments of `twin`.
    pub(crate) run: Vec<String>,
    /// Files to write beforehand, by name.
    #[serde(default)]
    files: BTreeMap<String, Composed>,
    /// Runs beforehand, which must succeed.
    #[serde(default)]
    before: Vec<Vec<String>>,
    /// File given on standard input.
    stdin: Option<String>,
    /// Exit status.
    status: i32,
    /// File with the expected standard output: JSON lines (every key given must be there with that value) or CSV.
    stdout: Option<String>,
    /// Expected standard output itself, as JSON lines.
    expected: Option<String>,
    /// Numbers may differ by this much.
    #[serde(default)]
    tolerance: f64,
    /// Of the numbers under these keys instead.
    #[serde(default)]
    tolerances: BTreeMap<String, f64>,
    /// Output of LinuxCNC's `rs274 -g`; the path elements that are printed must be its moves.
    moves: Option<String>,
    /// Texts that standard error must contain, however it is wrapped.
    #[serde(default)]
    stderr: Vec<String>,
    /// Texts that standard output must contain, however they are spaced.
    #[serde(default)]
    printed: Vec<String>,
    /// Numbers within texts on standard output.
    #[serde(default)]
    figures: Vec<Figure>,
    /// Texts that nothing printed may contain.
    #[serde(default)]
    absent: Vec<String>,
    /// Text that standard error must contain as it is, blanks and line ends included.
    picture: Option<String>,
    /// Columns of written tables whose differences from row to row are bounded.
    #[serde(default)]
    differences: Vec<Differences>,
    /// Pairs of files that are equal but for the numbers of their F words.
    #[serde(default)]
    equal_but_feeds: Vec<[String; 2]>,
}

/// A file put together from others.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Composed {
    /// Files, in this order.
    from: Vec<String>,
    /// Texts and their replacements; `{folder}` is the folder of the run.
    #[serde(default)]
    replace: Vec<[String; 2]>,
}

/// A number within a text.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Figure {
    /// The text; the number is at `#`.
    text: String,
    value: f64,
    tolerance: f64,
}

/// Differences of the columns of a table.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Differences {
    file: String,
    columns: Vec<String>,
    /// 1 for velocities, 2 for accelerations, 3 for jerks.
    order: u32,
    /// Time from row to row.
    cycle_s: f64,
    /// Largest absolute difference, per second to the power of the order.
    limit: f64,
}

/// What a run printed, and its exit status.
pub(crate) struct Printed {
    pub(crate) status: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Case {
    /// Runs the case in a folder, which may be a copy of its `home`; the error says everything that is wrong.
    pub(crate) fn check(&self, home: &Path, folder: &Path) -> Result<(), String> {
        self.write_files(home, folder)?;
        for arguments in &self.before {
            let printed = run(folder, arguments, None)?;
            if printed.status != Some(0) {
                return Err(format!("{arguments:?} failed:\n{}", printed.stderr));
            }
        }
        let printed = run(folder, &self.run, self.stdin.as_deref())?;
        let mut wrong = self.texts(&printed);
        wrong.extend(self.values(home, folder, &printed)?);
        if wrong.is_empty() {
            return Ok(());
        }
        Err(format!(
            "{}\n--- standard output\n{}\n--- standard error\n{}",
            wrong.join("\n"),
            printed.stdout,
            printed.stderr
        ))
    }

    /// Writes the files that the case needs.
    pub(crate) fn write_files(&self, home: &Path, folder: &Path) -> Result<(), String> {
        self.files.iter().try_for_each(|(name, composed)| {
            composed.write(home, folder, name).map_err(|error| format!("{name}: {error}"))
        })
    }

    /// Exit status and texts that are wrong.
    fn texts(&self, printed: &Printed) -> Vec<String> {
        let Printed { status, stdout, stderr } = printed;
        let mut wrong = Vec::new();
        if *status != Some(self.status) {
            wrong.push(format!("exit status {status:?}, expected {}", self.status));
        }
        for text in self.stderr.iter().filter(|text| !words(stderr).contains(&words(text))) {
            wrong.push(format!("standard error lacks {text:?}"));
        }
        for text in self.printed.iter().filter(|text| !words(stdout).contains(&words(text))) {
            wrong.push(format!("standard output lacks {text:?}"));
        }
        for text in &self.absent {
            if [stdout, stderr].iter().any(|printed| words(printed).contains(&words(text))) {
                wrong.push(format!("{text:?} is printed"));
            }
        }
        if let Some(picture) = &self.picture
            && !stderr.contains(picture.trim_matches('\n'))
        {
            wrong.push(format!("standard error lacks\n{picture}"));
        }
        wrong
    }

    /// Values that are wrong, on standard output and in written files.
    fn values(&self, home: &Path, folder: &Path, printed: &Printed) -> Result<Vec<String>, String> {
        let stdout = &printed.stdout;
        let read = |folder: &Path, name: &str| {
            fs::read_to_string(folder.join(name)).map_err(|error| format!("{name}: {error}"))
        };
        let mut wrong: Vec<_> =
            self.figures.iter().filter_map(|figure| figure.wrong(stdout)).collect();
        let json = |expected: &str| {
            compare::json_lines(expected, stdout, self.tolerance, &self.tolerances)
        };
        if let Some(name) = &self.stdout {
            let expected = read(home, name)?;
            wrong.extend(if Path::new(name).extension().is_some_and(|ending| ending == "csv") {
                compare::csv(&expected, stdout, self.tolerance)
            } else {
                json(&expected)
            });
        }
        wrong.extend(self.expected.as_deref().into_iter().flat_map(json));
        if let Some(name) = &self.moves {
            let bytes = fs::read(home.join(name)).map_err(|error| format!("{name}: {error}"))?;
            wrong.extend(canonical::compare(&String::from_utf8_lossy(&bytes), stdout)?);
        }
        for differences in &self.differences {
            wrong.extend(differences.wrong(&read(folder, &differences.file)?)?);
        }
        for [one, other] in &self.equal_but_feeds {
            let (one_text, other_text) = (read(folder, one)?, read(folder, other)?);
            if without_feeds(&one_text) != without_feeds(&other_text) {
                wrong.push(format!(
                    "{one} and {other} differ in more than F words:\n{one_text}\n{other_text}"
                ));
            }
        }
        Ok(wrong)
    }
}

impl Composed {
    fn write(&self, home: &Path, folder: &Path, name: &str) -> std::io::Result<()> {
        let mut text = String::new();
        for from in &self.from {
            text += &fs::read_to_string(home.join(word(from)))?;
        }
        for [from, to] in &self.replace {
            text = text.replace(from, &to.replace("{folder}", &folder.to_string_lossy()));
        }
        let path = folder.join(name);
        if let Some(above) = path.parent() {
            fs::create_dir_all(above)?;
        }
        fs::write(path, text)
    }
}

impl Figure {
    /// The message if no place with this text has the number.
    fn wrong(&self, printed: &str) -> Option<String> {
        let printed = words(printed);
        let (before, after) = self.text.split_once('#').unwrap_or((&self.text, ""));
        let found: Vec<f64> = printed
            .match_indices(before)
            .filter_map(|(at, _)| {
                let rest = &printed[at + before.len()..];
                let number = rest.split(|c: char| !"+-.0123456789".contains(c)).next()?;
                let follows = rest[number.len()..].starts_with(after);
                number.parse().ok().filter(|_| follows)
            })
            .collect();
        let fits = found.iter().any(|number| (number - self.value).abs() <= self.tolerance);
        let Self { text, value, tolerance } = self;
        (!fits).then(|| format!("{text:?} is {found:?}, expected {value} ± {tolerance}"))
    }
}

impl Differences {
    fn wrong(&self, table: &str) -> Result<Vec<String>, String> {
        let mut rows = csv::Reader::from_reader(table.as_bytes());
        let header = rows.headers().map_err(|error| error.to_string())?.clone();
        let records: Vec<_> =
            rows.records().collect::<Result<_, _>>().map_err(|error| error.to_string())?;
        let mut wrong = Vec::new();
        for name in &self.columns {
            let column = header.iter().position(|title| title == name);
            let column = column.ok_or_else(|| format!("no column {name}"))?;
            let mut values: Vec<f64> =
                records.iter().filter_map(|record| record.get(column)?.parse().ok()).collect();
            for _ in 0..self.order {
                values = values.windows(2).map(|pair| (pair[1] - pair[0]) / self.cycle_s).collect();
            }
            let peak = values.iter().fold(0.0_f64, |peak, value| peak.max(value.abs()));
            if values.is_empty() || peak > self.limit {
                wrong.push(format!("{name}: differences up to {peak}, limit {}", self.limit));
            }
        }
        Ok(wrong)
    }
}

/// Runs `twin` in a folder.
pub(crate) fn run(
    folder: &Path,
    arguments: &[String],
    stdin: Option<&str>,
) -> Result<Printed, String> {
    let mut child = Command::new(desk::BINARY)
        .args(arguments.iter().map(|argument| word(argument)))
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| error.to_string())?;
    if let (Some(name), Some(mut input)) = (stdin, child.stdin.take()) {
        let bytes = fs::read(folder.join(name)).map_err(|error| error.to_string())?;
        input.write_all(&bytes).map_err(|error| error.to_string())?;
    }
    let output = child.wait_with_output().map_err(|error| error.to_string())?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    Ok(Printed { status: output.status.code(), stdout, stderr })
}

/// The words of a text. Long messages are wrapped; the line in front of them is not a word.
fn words(text: &str) -> String {
    text.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
}

/// A program without its F words, comments kept.
fn without_feeds(program: &str) -> String {
    let mut kept = String::new();
    let mut rest = program.chars().peekable();
    let mut comment = false;
    while let Some(c) = rest.next() {
        comment = match c {
            '(' | ';' => true,
            ')' | '\n' => false,
            _ => comment,
        };
        if !comment && c.eq_ignore_ascii_case(&'f') {
            while rest.next_if(|c| " \t+-.0123456789".contains(*c)).is_some() {}
        } else if comment || !matches!(c, ' ' | '\t') {
            kept.push(c);
        }
    }
    kept
}

/// A copy of a folder, which runs may write to.
pub(crate) fn copy(folder: &Path) -> std::io::Result<tempfile::TempDir> {
    let copy = tempfile::tempdir()?;
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if let (true, Some(name)) = (path.is_file(), path.file_name()) {
            // Not `fs::copy`: the permissions of the original may forbid writing.
            fs::write(copy.path().join(name), fs::read(&path)?)?;
        }
    }
    Ok(copy)
}

/// Runs the cases of `tests/data`.
#[test]
fn every_case_of_tests_data() {
    let folder = root().join("tests/data");
    let mut folders: Vec<_> = fs::read_dir(&folder)
        .expect("tests/data is there")
        .map(|entry| entry.expect("readable").path())
        .filter(|path| path.join("case.toml").is_file())
        .collect();
    folders.sort();
    assert!(folders.len() >= 10, "only {} cases found", folders.len());
    let check = |folder: &Path| {
        let text =
            fs::read_to_string(folder.join("case.toml")).map_err(|error| error.to_string())?;
        let case: Case = toml::from_str(&text).map_err(|error| error.to_string())?;
        if case.source.len() < 20 {
            return Err("`source` does not say where the expected values come from".to_owned());
        }
        case.check(folder, folder)
    };
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

#[test]
fn figures_are_found_in_texts() {
    let figure = |value| Figure { text: "length # mm (".to_owned(), value, tolerance: 0.01 };
    assert_eq!(figure(62.83).wrong("length   3 mm\nlength 62.832 mm (0 rapid)"), None);
    assert!(figure(62.0).wrong("length 62.832 mm (0 rapid)").is_some());
    assert!(figure(62.83).wrong("length 62.832 cm (0 rapid)").is_some());
}

#[test]
fn only_feeds_may_differ() {
    let same = |one, other| without_feeds(one) == without_feeds(other);
    assert!(same("g1x1 F 3 0 0\nX2", "g1x1\nX2F9.5"));
    assert!(!same("g1x1 (F1)", "g1x1 (F2)"));
    assert!(!same("g1x1F2", "g1x2F2"));
}

#[test]
fn differences_are_bounded() {
    let differences = |limit| Differences {
        file: String::new(),
        columns: vec!["a".to_owned()],
        order: 2,
        cycle_s: 0.5,
        limit,
    };
    let table = "t,a\n0,0\n1,1\n2,3\n3,6\n";
    assert_eq!(differences(4.0).wrong(table), Ok(Vec::new()));
    assert_eq!(differences(3.9).wrong(table).map(|wrong| wrong.len()), Ok(1));
    assert!(differences(4.0).wrong("t,b\n0,0\n").is_err());
}
