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

/// The wire of every family takes the same words; what goes wrong on it is told by whoever speaks to the device, and one lost
/// answer is made up for.
#[test]
fn faults_of_the_wire_are_the_same_for_every_family() {
    let desk = Desk::new();
    for family in ["interpcnc", "smartdrive", "bim2ax"] {
        let socket = desk.path("control");
        let arguments =
            ["emulate", family, "--link", family, "--control", "control", "--speed", "2"];
        let status =
            || desk.twin(&["drive", family, "--port", family, "--deadline", "700", "status"]);
        let told = |line| assert_eq!(told(&socket, &[line]), ["ok"], "{family}: {line}");
        let done = desk.meanwhile("-INT", "Ctrl-C ends it", &arguments, || {
            // It may still start up.
            while status().status != Some(0) {}
            told("plug off");
            status().ended(2, family_word(family));
            told("plug on");
            told("fault answer drop --next 1");
            status().ended(0, "");
            told("after 1 plug off");
            status().ended(2, family_word(family));
            told("plug on");
            told("no-faults");
            status().ended(0, "");
        });
        done.ended(0, "");
    }
}

/// What errors of a family begin with.
fn family_word(family: &str) -> &'static str {
    match family {
        "interpcnc" => "station 1",
        "smartdrive" => "1",
        _ => "bim2ax",
    }
}
