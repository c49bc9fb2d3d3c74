//! pymodbus, at either end.

use std::{
    env,
    ffi::OsString,
    io::{BufRead, BufReader, Write},
    process::{Child, ChildStdin, ChildStdout, Command as Process, Stdio},
};

use super::{board, clock};

/// Version the tests are about.
const VERSION: &str = "3.16.1";

/// A script under way, with its standard streams to talk to.
struct Peer {
    process: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
}

impl Peer {
    /// `None`, and a word about it, without pymodbus.
    fn start(script: &str, port: &str) -> Option<Self> {
        let named = env::var_os("TWIN_PYMODBUS_PYTHON").filter(|python| !python.is_empty());
        let python = named.clone().unwrap_or_else(|| OsString::from("python3"));
        let asked = Process::new(&python)
            .args(["-c", "import pymodbus, serial; print(pymodbus.__version__)"])
            .output();
        let found = asked.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned());
        if !found.as_ref().is_ok_and(|found| found == VERSION) {
            assert!(named.is_none(), "TWIN_PYMODBUS_PYTHON has no pymodbus {VERSION}: {found:?}");
            println!("no pymodbus {VERSION} here (TWIN_PYMODBUS_PYTHON): not witnessed");
            return None;
        }
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/interpcnc/tests/peers/");
        let mut command = Process::new(python);
        command.args(["-B", &format!("{folder}{script}"), port]);
        let mut process = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let input = process.stdin.take();
        let output = BufReader::new(process.stdout.take().unwrap());
        Some(Self { process, input, output })
    }

    /// Its next line; empty at its end.
    fn line(&mut self) -> String {
        let mut line = String::new();
        self.output.read_line(&mut line).unwrap();
        line.trim_end().to_owned()
    }

    fn say(&mut self, line: &str) {
        writeln!(self.input.as_mut().unwrap(), "{line}").unwrap();
    }

    fn end(mut self) {
        drop(self.input.take());
        assert!(self.process.wait().unwrap().success());
    }
}

#[test]
fn pymodbus_is_the_master_of_the_emulated_board() {
    let board = board();
    let Some(mut master) = Peer::start("pymodbus_master.py", board.path().to_str().unwrap()) else {
        return;
    };
    let mut agreed = Vec::new();
    loop {
        let line = master.line();
        match *line.split(' ').collect::<Vec<_>>().as_slice() {
            ["agreed", part] => agreed.push(part.to_owned()),
            ["enable", closed] => board.set_enable(closed == "1").unwrap(),
            ["input", number, level] => {
                board.set_input(number.parse().unwrap(), level == "1").unwrap();
            }
            _ => break,
        }
        if !line.starts_with("agreed") {
            master.say("done");
        }
    }
    assert_eq!(agreed, ["blocks", "lock", "memory", "moves", "searches", "refusals"]);
    master.end();
}
