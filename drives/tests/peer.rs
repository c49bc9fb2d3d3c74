//! Another program at the other end of the wire.

use std::{
    io::{BufRead, BufReader, Write},
    process::{Child, ChildStdin, ChildStdout, Command, Stdio},
};

/// A program under way, with its standard streams to talk to.
pub(crate) struct Peer {
    process: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
}

impl Peer {
    pub(crate) fn start(command: &mut Command) -> Self {
        let mut process = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let input = process.stdin.take();
        let output = BufReader::new(process.stdout.take().unwrap());
        Self { process, input, output }
    }

    /// A reading of a manual in Python, in this folder of the crate; `None`, and a word about it, without Python.
    pub(crate) fn reference(folder: &str) -> Option<Command> {
        let version = Command::new("python3").arg("--version").output();
        if !version.is_ok_and(|output| output.status.success()) {
            println!("no python3 here: not witnessed");
            return None;
        }
        let mut python = Command::new("python3");
        python.arg("-B").arg(format!("{}/{folder}", env!("CARGO_MANIFEST_DIR")));
        Some(python)
    }

    /// Its next line; empty at its end.
    pub(crate) fn line(&mut self) -> String {
        let mut line = String::new();
        self.output.read_line(&mut line).unwrap();
        line.trim_end().to_owned()
    }

    pub(crate) fn say(&mut self, line: &str) {
        writeln!(self.input.as_mut().unwrap(), "{line}").unwrap();
    }

    /// Has something done; what it says to that.
    pub(crate) fn have(&mut self, what: &str) -> String {
        self.say(what);
        self.line()
    }

    /// Tells it that nothing more comes, and waits for it.
    pub(crate) fn end(mut self) {
        drop(self.input.take());
        assert!(self.process.wait().unwrap().success());
    }
}
