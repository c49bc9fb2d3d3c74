//! MuJoCo as peer: the same machines in a process of its own (`tests/peers/mujoco_machines.py`).

use crate::machines::{PERIOD, Task};
use crate::python::Package;
use nalgebra::Point3;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

const MUJOCO: Package =
    Package { name: "mujoco", requirement: "mujoco==4.0.*", variable: "TWIN_MUJOCO_PYTHON" };

/// A running peer.
pub struct Peer {
    child: Child,
    requests: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

impl Peer {
    /// None, with a line that says why, where MuJoCo is missing.
    pub fn start() -> Option<Self> {
        let mut command = MUJOCO.script("mujoco_machines.py")?;
        command.stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = command.spawn().expect("the peer starts");
        let requests = child.stdin.take();
        let answers = BufReader::new(child.stdout.take().expect("a pipe"));
        Some(Self { child, requests, answers })
    }

    /// Tool tip positions after each period.
    pub fn take(&mut self, task: &Task) -> Vec<Point3<f64>> {
        let set = task.set.iter().map(|set| [set.position, set.velocity, set.effort].concat());
        let answer = self.ask(&json!({
            "model": task.peer,
            "axes": task.axes,
            "position": task.start,
            "tool": task.tool.coords.as_slice(),
            "period": PERIOD,
            "set": set.collect::<Vec<_>>(),
            "kp": task.kp,
            "kd": task.kd,
        }));
        let tips: Vec<[f64; 3]> =
            serde_json::from_value(answer["tips"].clone()).expect("three numbers per period");
        tips.into_iter().map(Point3::from).collect()
    }

    /// The same machine once more: s per period.
    pub fn again(&mut self) -> f64 {
        self.ask(&json!(1))["period"].as_f64().expect("a time")
    }

    fn ask(&mut self, request: &Value) -> Value {
        let requests = self.requests.as_mut().expect("a pipe until the end");
        writeln!(requests, "{request}").expect("the peer reads");
        let mut line = String::new();
        self.answers.read_line(&mut line).expect("the peer answers");
        serde_json::from_str(&line).expect("an answer")
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // It ends with its input.
        self.requests = None;
        if let Err(error) = self.child.wait() {
            println!("peer, MuJoCo: {error}");
        }
    }
}
