//! toppra, asked for the same paths in a process of its own (`tests/peers/toppra_seidel.py`).

use crate::path::Path as AxisPath;
use serde_json::{Value, json};
use std::env;
use std::ffi::OsString;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// The version that the numbers are about.
const PACKAGE: &str = "toppra==0.6.*";

/// A running peer.
pub struct Peer {
    child: Child,
    requests: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

/// What it says about a path.
#[derive(Clone, Copy, Debug)]
pub struct Answer {
    /// Duration of the profile, s; none where it fails.
    pub duration: Option<f64>,
    /// How long building the instance has taken, s.
    pub construct: f64,
    /// How long the passes over the path have taken, s.
    pub solve: f64,
}

impl Peer {
    /// None, with a line that says why, where there is no toppra.
    pub fn start() -> Option<Self> {
        let Some(python) = interpreter() else {
            println!("peer, toppra: skipped, there is no Python that has it (TWIN_TOPPRA_PYTHON)");
            return None;
        };
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/peers/toppra_seidel.py");
        let mut command = Command::new(&python);
        command.arg(script).stdin(Stdio::piped()).stdout(Stdio::piped());
        // One thread, as ours.
        for variable in ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"] {
            command.env(variable, "1");
        }
        let mut child = command.spawn().expect("the peer starts");
        let requests = child.stdin.take();
        let answers = BufReader::new(child.stdout.take().expect("a pipe"));
        Some(Self { child, requests, answers })
    }

    /// Takes a path and limits its velocity and acceleration, once.
    pub fn take(&mut self, path: &AxisPath) -> Answer {
        let order = |order: usize| -> Vec<&[f64]> {
            path.rates.iter().map(|rates| rates[order].as_slice()).collect()
        };
        let of = |limit: fn(&crate::path::Limits) -> f64| -> Vec<f64> {
            path.limits.iter().map(limit).collect()
        };
        self.ask(&json!({
            "s": path.nodes,
            "first": order(0),
            "second": order(1),
            "velocity": of(|limits| limits.velocity),
            "acceleration": of(|limits| limits.acceleration),
        }))
    }

    /// Once more the path taken last.
    pub fn again(&mut self) -> Answer {
        self.ask(&json!(1))
    }

    fn ask(&mut self, request: &Value) -> Answer {
        let requests = self.requests.as_mut().expect("a pipe until the end");
        writeln!(requests, "{request}").expect("the peer reads");
        let mut line = String::new();
        self.answers.read_line(&mut line).expect("the peer answers");
        let answer: Value = serde_json::from_str(&line).expect("an answer");
        let number = |key: &str| answer[key].as_f64();
        Answer {
            duration: number("duration"),
            construct: number("construct").expect("a time"),
            solve: number("solve").expect("a time"),
        }
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // It ends with its input.
        self.requests = None;
        if let Err(error) = self.child.wait() {
            println!("peer, toppra: {error}");
        }
    }
}

/// A Python that has toppra: the one named by `TWIN_TOPPRA_PYTHON`, the usual one, or one in a virtual environment of
/// its own below `target`, made here if it is not there yet.
fn interpreter() -> Option<OsString> {
    if let Some(python) = env::var_os("TWIN_TOPPRA_PYTHON") {
        assert!(has_toppra(&python), "TWIN_TOPPRA_PYTHON has no toppra");
        return Some(python);
    }
    let usual = OsString::from("python3");
    if has_toppra(&usual) {
        return Some(usual);
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let target = env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let folder = target.join("toppra-venv");
    let python = folder.join("bin").join("python").into_os_string();
    if !has_toppra(&python) {
        println!("peer, toppra: {PACKAGE} is installed in {}", folder.display());
        let made = runs(Command::new(&usual).args(["-m", "venv"]).arg(&folder));
        let install = ["-m", "pip", "install", "--quiet", PACKAGE];
        if !made || !runs(Command::new(&python).args(install)) {
            return None;
        }
    }
    has_toppra(&python).then_some(python)
}

fn has_toppra(python: &OsString) -> bool {
    runs(Command::new(python).args(["-c", "import toppra"]))
}

fn runs(command: &mut Command) -> bool {
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}
