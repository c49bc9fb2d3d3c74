//! Emulated drives as processes of their own, and what is done to them through their control sockets.

use crate::process::Desk;
use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;

/// Says lines to a control socket and takes an answer for each.
fn told(socket: &Path, lines: &[&str]) -> Vec<String> {
    let mut stream = UnixStream::connect(socket).expect("it listens");
    let mut answers = BufReader::new(stream.try_clone().expect("a handle")).lines();
    let mut said = Vec::new();
    for line in lines {
        writeln!(stream, "{line}").expect("it reads");
        said.push(answers.next().expect("an answer").expect("text"));
    }
    said
}

#[test]
fn every_family_listens_to_its_control_socket() {
    let desk = Desk::new();
    let families = [
        ("interpcnc", "input 3 on", "input 33 on"),
        ("smartdrive", "input 1 limp on", "stall 2"),
        ("bim2ax", "contact 2 cam on", "contact 3 cam on"),
    ];
    for (family, good, bad) in families {
        let (link, socket) = (desk.path(family), desk.path("control"));
        let arguments =
            ["emulate", family, "--link", family, "--control", "control", "--speed", "10"];
        let done = desk.meanwhile("-INT", "Ctrl-C ends it", &arguments, || {
            // The socket is made before that is said; the device, too.
            assert!(link.symlink_metadata().is_ok(), "{family}");
            let said = told(&socket, &[good, bad, "dance"]);
            assert_eq!(said[0], "ok", "{family}");
            assert!(said[1].starts_with("error: ") && said[2].starts_with("error: "), "{said:?}");
            // Faults have the same words for all of them.
            let words = [
                "fault answer drop --next 1",
                "after 3 plug off",
                "fault request melt",
                "no-faults",
            ];
            let said = told(&socket, &words);
            assert_eq!((&*said[0], &*said[1], &*said[3]), ("ok", "ok", "ok"), "{family}");
            assert!(said[2].starts_with("error: "), "{said:?}");
        });
        done.ended(0, "");
        assert!(!link.exists() && !socket.exists(), "{family} leaves something behind");
    }
}

/// What is stored is there after the next start.
#[test]
fn what_a_device_stores_outlives_it() {
    let desk = Desk::new();
    let start = ["emulate", "smartdrive", "--link", "bus", "--eeprom", "flash"];
    desk.meanwhile("-INT", "Ctrl-C ends it", &start, || ()).ended(0, "address 1: 0 frames");
    let image = std::fs::read(desk.path("flash")).expect("it was written");
    assert!(!image.is_empty());
    desk.meanwhile("-INT", "Ctrl-C ends it", &start, || ()).ended(0, "");
    assert!(std::fs::read(desk.path("flash")).expect("it is there") == image);
    desk.twin(&["emulate", "smartdrive", "--link", "bus", "--turnaround-ms", "20000"])
        .ended(2, "--turnaround-ms");
    desk.write("taken", "mine");
    desk.twin(&["emulate", "interpcnc", "--link", "taken"]).ended(2, "taken");
}
