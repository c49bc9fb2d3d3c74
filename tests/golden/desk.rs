//! Test desk: a folder with a machine file, in which the binary runs.

use serde_json::Value;
use std::ffi::OsString;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;
use tempfile::TempDir;

/// Root folder of the workspace.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("the workspace is above the crate")
        .to_owned()
}

/// A word of a command line. `machines/`, `examples/` and `tests/` at its beginning are those of the workspace.
pub(crate) fn word(word: &str) -> OsString {
    let shipped = ["machines/", "examples/", "tests/"].iter().any(|at| word.starts_with(at));
    if shipped { root().join(word).into_os_string() } else { word.into() }
}

/// The binary.
pub(crate) const BINARY: &str = env!("CARGO_BIN_EXE_twin");

/// Signals that end or suspend programs, and their numbers.
const SIGNALS: [(&str, u32); 5] = [("HUP", 1), ("INT", 2), ("QUIT", 3), ("TERM", 15), ("TSTP", 20)];

/// A process with the signals as at a terminal: what `nohup`, or a script that works in the background, has ignored, everything
/// ignores that is started from there. `env` (GNU) gives such signals back, and becomes the program.
pub(crate) fn started(program: &str) -> Command {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    let ignored = SIGNALS.into_iter().filter(|(_, number)| mask & (1 << (number - 1)) != 0);
    let names: Vec<_> = ignored.map(|(name, _)| name).collect();
    if names.is_empty() {
        return Command::new(program);
    }
    let mut env = Command::new("env");
    env.arg(format!("--default-signal={}", names.join(","))).arg(program);
    env
}

/// The text of a file of the workspace.
pub(crate) fn shipped(name: &str) -> String {
    std::fs::read_to_string(root().join(name)).expect("it is shipped")
}

/// A folder with the portal's machine file, and what the tests put there.
pub(crate) struct Desk {
    folder: TempDir,
}

impl Desk {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let machine = shipped("tests/data/machines/gantry3.toml");
        let here = "start_mm = [0.0, 0.0, 20.0]";
        assert!(machine.contains(here));
        let desk = Self { folder };
        desk.write("machine.toml", &machine.replace(here, "start_mm = [0.0, 0.0, -40.0]"));
        desk
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).expect("written");
    }

    /// The text of a file that was written.
    #[track_caller]
    pub(crate) fn text(&self, name: &str) -> String {
        let text = std::fs::read_to_string(self.path(name));
        text.unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Replaces `from` in the machine file.
    #[track_caller]
    pub(crate) fn edit_machine(&self, from: &str, to: &str) {
        let machine = self.text("machine.toml");
        assert!(machine.contains(from), "{from}");
        self.write("machine.toml", &machine.replace(from, to));
    }

    /// Emulated drives may be late, as they are on a busy computer.
    pub(crate) fn allow_late_drives(&self) {
        self.edit_machine("max_following_error_mm = 0.5", "max_following_error_mm = 100.0");
    }

    /// Puts `more` at the end of the machine file.
    pub(crate) fn add_to_machine(&self, more: &str) {
        self.write("machine.toml", &(self.text("machine.toml") + more));
    }

    pub(crate) fn read(&self, name: &str) -> Value {
        let text = self.text(name);
        serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error} in\n{text}"))
    }

    /// `twin` with the words of a line; what is within '' is one word.
    pub(crate) fn command(&self, line: &str) -> Command {
        let mut command = started(BINARY);
        for (index, part) in line.split('\'').enumerate() {
            if index % 2 == 0 {
                command.args(part.split_whitespace().map(word));
            } else {
                command.arg(part);
            }
        }
        command.current_dir(self.folder.path()).stdin(Stdio::null());
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    pub(crate) fn twin(&self, line: &str) -> Done {
        Done::from(self.command(line).output().expect("the binary starts"))
    }

    /// `twin run` of `program`, interrupted by `signal` a second after it has announced what `sign` says.
    pub(crate) fn interrupted(&self, signal: &str, sign: &str, line: &str) -> Done {
        self.meanwhile(signal, sign, line, || std::thread::sleep(Duration::from_secs(1)))
    }

    /// `twin`, told to end by `signal` when `act` is done, which begins when it has announced what `sign` says.
    pub(crate) fn meanwhile(
        &self,
        signal: &str,
        sign: &str,
        line: &str,
        act: impl FnOnce(),
    ) -> Done {
        self.meanwhile_of(signal, sign, line, |_| act())
    }

    /// The same, for what is done to the process itself.
    pub(crate) fn meanwhile_of(
        &self,
        signal: &str,
        sign: &str,
        line: &str,
        act: impl FnOnce(&str),
    ) -> Done {
        let mut child = self.command(line).spawn().expect("the binary starts");
        let stderr = child.stderr.take().expect("piped");
        let mut lines = BufReader::new(stderr).lines().map_while(Result::ok);
        let mut seen = String::new();
        for line in lines.by_ref() {
            seen += &line;
            seen.push('\n');
            if line.contains(sign) {
                break;
            }
        }
        let process = child.id().to_string();
        act(&process);
        let sent = Command::new("kill").args([signal, &process]).status().expect("kill is there");
        assert!(sent.success(), "it has ended already:\n{seen}");
        for line in lines {
            seen += &line;
            seen.push('\n');
        }
        let output = wait(child);
        Done { stderr: seen, ..Done::from(output) }
    }
}

/// Waits until something holds, a minute at most.
#[track_caller]
pub(crate) fn comes(mut holds: impl FnMut() -> bool) {
    let held = (0..6000).any(|_| {
        let held = holds();
        if !held {
            std::thread::sleep(Duration::from_millis(10));
        }
        held
    });
    assert!(held, "it does not come");
}

/// Waits for a process that has been told to end.
fn wait(mut child: Child) -> Output {
    for _ in 0..600 {
        if child.try_wait().expect("it can be waited for").is_some() {
            return child.wait_with_output().expect("it has ended");
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    child.kill().expect("it can be killed");
    panic!("it goes on a minute after it was told to stop");
}

/// A process that has ended.
pub(crate) struct Done {
    pub(crate) status: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl From<Output> for Done {
    fn from(output: Output) -> Self {
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
        Self { status: output.status.code(), stdout, stderr }
    }
}

impl Done {
    /// It ended with `status`, and standard error says `words`, however it is wrapped.
    #[track_caller]
    pub(crate) fn ended(&self, status: i32, words: &str) -> &Self {
        assert_eq!(self.status, Some(status), "{}\n{}", self.stdout, self.stderr);
        self.reports(&[words])
    }

    /// Standard error says all of these words, however they are wrapped.
    #[track_caller]
    pub(crate) fn reports(&self, words: &[&str]) -> &Self {
        let flat = |text: &str| -> String {
            text.chars().filter(|c| !c.is_whitespace() && *c != '│').collect()
        };
        let stderr = flat(&self.stderr);
        for words in words {
            assert!(stderr.contains(&flat(words)), "{words} is not in\n{}", self.stderr);
        }
        self
    }

    /// Standard output has this text.
    #[track_caller]
    pub(crate) fn says(&self, text: &str) -> &Self {
        assert!(self.stdout.contains(text), "{text} is not in\n{}", self.stdout);
        self
    }

    /// The same for several texts.
    #[track_caller]
    pub(crate) fn says_all(&self, texts: &[&str]) -> &Self {
        texts.iter().fold(self, |done, text| done.says(text))
    }

    /// Standard output, which has a JSON value in each line.
    #[track_caller]
    pub(crate) fn rows(&self) -> Vec<Value> {
        self.stdout.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
    }

    /// Standard output, which is one JSON value.
    #[track_caller]
    pub(crate) fn object(&self) -> Value {
        let Self { stdout, stderr, .. } = self;
        serde_json::from_str(stdout)
            .unwrap_or_else(|error| panic!("{error} in\n{stdout}\n{stderr}"))
    }
}

/// `value` has exactly these keys, which blanks separate.
#[track_caller]
pub(crate) fn has_keys(value: &Value, keys: &str) {
    let object = value.as_object().unwrap_or_else(|| panic!("no object: {value}"));
    let mut found: Vec<_> = object.keys().map(String::as_str).collect();
    let mut wanted: Vec<_> = keys.split_whitespace().collect();
    found.sort_unstable();
    wanted.sort_unstable();
    assert_eq!(found, wanted);
}

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}
