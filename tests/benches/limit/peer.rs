//! toppra as peer: the same paths in a process of its own (`tests/peers/toppra_seidel.py`).

use crate::path::Path as AxisPath;
use crate::python::Package;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

const TOPPRA: Package =
    Package { name: "toppra", requirement: "toppra==0.6.*", variable: "TWIN_TOPPRA_PYTHON" };

/// A running peer.
pub struct Peer {
    child: Child,
    requests: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

/// Its answer for a path.
#[derive(Clone, Copy, Debug)]
pub struct Answer {
    /// Duration of the profile, s; none where it fails.
    pub duration: Option<f64>,
    /// Time to build the instance, s.
    pub construct: f64,
    /// Time of the passes over the path, s.
    pub solve: f64,
}

impl Peer {
    /// None, with a line that says why, where toppra is missing.
    pub fn start() -> Option<Self> {
        let mut command = TOPPRA.script("toppra_seidel.py")?;
        command.stdin(Stdio::piped()).stdout(Stdio::piped());
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
