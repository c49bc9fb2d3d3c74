//! Keys of a run at a terminal (`script` of util-linux gives the process one).

use crate::desk::{BINARY, Desk, number};
use std::io::{Read, Write};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// Two lines of 10 mm at 10 mm/s with 20 mm/s². The path passes the point between them without a stop: 2.5 s.
const PROGRAM: &str = "% steps\nN10 G1 X10 F10 E20 E-20\nN20 G1 X20\n";

/// One line with a stop at its end: L/v + v/a, s.
const ONE_LINE_S: f64 = 1.0 + 0.5;

fn run(desk: &Desk) -> Child {
    desk.write("steps.cnc", PROGRAM);
    let arguments = "run steps.cnc -m machine.toml --limits programmed --drives none --realtime";
    Command::new("script")
        .args(["-qec", &format!("{BINARY} {arguments} --report run.json"), "/dev/null"])
        .current_dir(desk.path(""))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("script (util-linux) is there")
}

/// Reads what the run writes until `text` has come.
fn wait_for(child: &mut Child, text: &str) {
    let mut written = Vec::new();
    let output = child.stdout.as_mut().expect("piped");
    while !String::from_utf8_lossy(&written).contains(text) {
        let mut byte = [0];
        let count = output.read(&mut byte).expect("readable");
        assert!(count > 0, "no `{text}` in {}", String::from_utf8_lossy(&written));
        written.extend(byte);
    }
}

/// Key `s`: the path stops at the end of every element. Key `n`: it waits there until `n` is pressed again.
#[test]
fn keys_step_through_a_program() {
    let desk = Desk::new();
    let mut child = run(&desk);
    let mut keys = child.stdin.take().expect("piped");
    let mut press = |key: &[u8]| keys.write_all(key).expect("it listens");
    wait_for(&mut child, "single step");
    press(b"s");
    wait_for(&mut child, "single step on, wait at the next stop off");
    press(b"n");
    wait_for(&mut child, "single step on, wait at the next stop on");
    // Longer than the first line takes: the path waits at its end.
    let pause = Duration::from_millis(2500);
    std::thread::sleep(pause);
    press(b"n");
    wait_for(&mut child, "single step on, wait at the next stop off");
    let mut rest = String::new();
    child.stdout.take().expect("piped").read_to_string(&mut rest).expect("readable");
    assert!(child.wait().expect("it ends").success(), "{rest}");
    let executed = number(&desk.read("run.json")["executed_s"]);
    assert!(executed >= pause.as_secs_f64() + ONE_LINE_S, "{executed} s");
}
