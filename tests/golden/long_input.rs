//! Input without an end: what is read as a whole is refused, streams are read as they come.

use crate::desk::{Desk, Done};
use std::io::Write;
use std::process::Stdio;

/// Positions are converted line by line for ever; a line without an end is refused, and those before it are answered.
#[test]
fn lines_of_axes_end_in_time() {
    let desk = Desk::new();
    let mut command = desk.command("axes inverse -m machine.toml");
    let mut child = command.stdin(Stdio::piped()).spawn().expect("the binary starts");
    let mut input = child.stdin.take().expect("piped");
    let writer = std::thread::Builder::new().name("writer".to_owned()).spawn(move || {
        // The command ends before all of it is written.
        input.write_all(&b"10,20,5\r\n\"11\",20,5\r# 1\n".repeat(1000)).unwrap_or_default();
        input.write_all(&b"1".repeat(1 << 20)).unwrap_or_default();
    });
    let writer = writer.expect("a thread");
    let done = Done::from(child.wait_with_output().expect("it ends"));
    writer.join().expect("it ends");
    done.ended(2, "line 3001 has more than 65536 bytes, the most that are read");
    assert_eq!(done.stdout, "10,20,45\n11,20,45\n".repeat(1000));
}

/// A device has no end, whatever it is taken for.
#[cfg(unix)]
#[test]
fn files_without_an_end_are_refused() {
    let desk = Desk::new();
    desk.write("p.cnc", "% p\nN10 G1 X10 F50 E500 E-500\n");
    std::os::unix::fs::symlink("/dev/zero", desk.path("zero.toml")).expect("a link");
    let (job, text, table) = (1 << 20, 16 << 20, 256 << 20);
    for (line, most) in [
        ("check zero.toml -m machine.toml", job),
        ("check p.cnc -m machine.toml --variables zero.toml", text),
        ("check p.cnc -m machine.toml --faults zero.toml", text),
        ("check p.cnc -m machine.toml --limits programmed --by-position zero.toml", table),
        ("emulate interpcnc --link board --bench zero.toml", text),
        ("emulate interpcnc --link board --eeprom zero.toml", job),
        ("emulate smartdrive --link bus --eeprom zero.toml", job),
        ("emulate bim2ax --link module --eeprom zero.toml", job),
    ] {
        let said = format!("has more than {most} bytes, the most that are read; check that it is");
        desk.twin(line).ended(2, &said);
    }
}
