//! Emulated drives as processes of their own, and their control sockets.

use crate::desk::{Desk, Done, comes};
use crate::drive::row;
use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;

/// `twin drive` without questions.
fn by_hand(desk: &Desk, family: &str, port: &str, action: &str) -> Done {
    desk.twin(&format!("drive {family} --port {port} --deadline 1500 --yes {action}"))
}

/// Runs `act` next to `twin emulate` with these words, which Ctrl-C ends then.
#[track_caller]
fn emulated(desk: &Desk, words: &str, act: impl FnOnce()) -> Done {
    desk.meanwhile("-INT", "Ctrl-C ends it", &format!("emulate {words}"), act)
}

/// Says lines to a control socket and takes an answer for each.
fn message(socket: &Path, lines: &[&str]) -> Vec<String> {
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
        emulated(&desk, &format!("{family} --link {family} --control control --speed 10"), || {
            // The socket is made before that is said; the device, too.
            assert!(link.symlink_metadata().is_ok(), "{family}");
            let said = message(&socket, &[good, bad, "dance"]);
            assert_eq!(said[0], "ok", "{family}");
            assert!(said[1].starts_with("error: ") && said[2].starts_with("error: "), "{said:?}");
            // Faults have the same words for all of them.
            let words = [
                "fault answer drop --next 1",
                "after 3 plug off",
                "fault request melt",
                "no-faults",
            ];
            let said = message(&socket, &words);
            assert_eq!((&*said[0], &*said[1], &*said[3]), ("ok", "ok", "ok"), "{family}");
            assert!(said[2].starts_with("error: "), "{said:?}");
        })
        .ended(0, "");
        assert!(!link.exists() && !socket.exists(), "{family} leaves something behind");
    }
}

/// What is stored is there after the next start.
#[test]
fn what_a_device_stores_outlives_it() {
    let desk = Desk::new();
    let start = "smartdrive --link bus --eeprom flash";
    emulated(&desk, start, || ()).ended(0, "address 1: 0 frames");
    let image = std::fs::read(desk.path("flash")).expect("it was written");
    assert!(!image.is_empty());
    emulated(&desk, start, || ()).ended(0, "");
    assert!(std::fs::read(desk.path("flash")).expect("it is there") == image);
    desk.twin("emulate smartdrive --link bus --turnaround-ms 20000").ended(2, "--turnaround-ms");
    desk.write("taken", "mine");
    desk.twin("emulate interpcnc --link taken").ended(2, "taken");
}

/// The wire of every family takes the same words; faults on it are reported by the program that speaks to the device, and one lost
/// answer is made up for.
#[test]
fn faults_of_the_wire_are_the_same_for_every_family() {
    let desk = Desk::new();
    for family in ["interpcnc", "smartdrive", "bim2ax"] {
        let socket = desk.path("control");
        let status = || desk.twin(&format!("drive {family} --port {family} --deadline 700 status"));
        let message = |line| assert_eq!(message(&socket, &[line]), ["ok"], "{family}: {line}");
        emulated(&desk, &format!("{family} --link {family} --control control --speed 2"), || {
            // It may still start up.
            comes(|| status().status == Some(0));
            message("plug off");
            status().ended(2, family_word(family));
            message("plug on");
            message("fault answer drop --next 1");
            status().ended(0, "");
            message("after 1 plug off");
            status().ended(2, family_word(family));
            message("plug on");
            message("no-faults");
            status().ended(0, "");
        })
        .ended(0, "");
    }
}

/// What errors of a family begin with.
fn family_word(family: &str) -> &'static str {
    match family {
        "interpcnc" => "address 1",
        "smartdrive" => "1",
        _ => "bim2ax",
    }
}

/// The board's home switch, limit switch and encoder, from a file and from the command line.
#[test]
fn a_board_starts_with_switches_and_an_encoder() {
    let desk = Desk::new();
    let bench = "# around the board\ncam 5 x ..-300  # home\n\nencoder X 4000 3200 --turn 4000\n";
    desk.write("bench.txt", bench);
    let start = "interpcnc --link board --bench bench.txt --with 'cam 7 X 900.. --opens' --with 'input 9 on' --speed 4";
    let drive = |action: &str| by_hand(&desk, "interpcnc", "board", action);
    emulated(&desk, start, || {
        let inputs = drive("inputs");
        let level = |number| row(&inputs, 0, number)[1].to_owned();
        // One that opens is closed until it is pressed.
        assert_eq!([level("5"), level("7"), level("9")], ["off", "on", "on"]);
        drive("unlock").ended(0, "");
        for setting in [
            "home-input-x 5",
            "home-direction-x 0",
            "home-speed-x 4000",
            "home-acceleration-x 100",
            "home-start-stop 200",
            "home-slow-speed 500",
            "home-polarity 0",
            "zero-after-homing 1",
            "limit-plus-input-x 7",
            "limit-plus-polarity-x 1",
        ] {
            drive(&format!("set {setting}")).ended(0, "");
        }
        // 640 steps forth are 800 edges.
        drive("move X 640").ended(0, "");
        assert_eq!(row(&drive("inputs"), 0, "encoder")[1], "800");
        drive("home X").ended(0, "");
        // Home is where the switch opens, 300 steps behind the start: -375 edges.
        let edges: i32 = row(&drive("inputs"), 0, "encoder")[1].parse().expect("a number");
        assert!((-377..=-373).contains(&edges), "{edges}");
        // The limit switch is 900 steps from the start, 1200 from home.
        assert_eq!(drive("move X 3000").status, Some(2));
        let status = drive("status");
        status.says("on a limit switch");
        let position: i32 = row(&status, 0, "X")[1].parse().expect("a position");
        assert!((1200..1250).contains(&position), "{position}");
    })
    .ended(0, "");
}

/// A board before V2.1D has no registers for an encoder: a run with an encoder is refused, one without goes on to ask.
#[test]
fn an_older_board_has_no_encoder() {
    let desk = Desk::new();
    crate::real::alone(&desk, "interpcnc", &[]);
    let text = desk.text("mixture.toml");
    let section = "[drives.encoder]\naxis = \"X\"\npoints = 4\nper_increments = 1\ntolerance_increments = 48\n";
    let key = "answer_deadline_ms = 2000\n";
    desk.write("encoder.toml", &text.replace(key, &format!("{key}\n{section}\n")));
    emulated(&desk, "interpcnc --link device --older-than-v2.1d", || {
        desk.twin("drive interpcnc --port device --deadline 2000 unlock").ended(0, "");
        for (machine, said) in [
            ("encoder.toml", "the device has no encoder: boards have one from V2.1D on"),
            ("mixture.toml", "there is no terminal to ask at"),
        ] {
            desk.twin(&format!("run short.cnc -m {machine} --drives real --homed")).ended(2, said);
        }
    })
    .ended(0, "");
}

/// Home switch, limit switch and homing input of two drives.
#[test]
fn drives_of_a_bus_start_with_switches() {
    let desk = Desk::new();
    let start = "smartdrive --link bus --address 1,3 --speed 2 --with 'cam 3 dir -3000..-1000' \
                 --with 'homing 3 dir' --with 'cam 3 limp 2000..' --with 'cam 1 go ..500'";
    let drive = |action: &str| by_hand(&desk, "smartdrive", "bus", action);
    emulated(&desk, start, || {
        comes(|| drive("status").status == Some(0));
        assert_eq!(row(&drive("--address 3 inputs"), 0, "DIR")[1], "off");
        drive("--address 3 unlock").ended(0, "");
        drive("--address 3 home").ended(0, "");
        let found = drive("--address 3 status");
        assert_eq!(row(&found, 0, "3")[5], "0");
        // 1000 µsteps behind the start is home: the limit switch is 3000 µsteps from there.
        assert_eq!(drive("--address 3 move 9000").status, Some(2));
        let found = drive("--address 3 status");
        // It brakes on the switch, which stays pressed.
        let position: i32 = row(&found, 0, "3")[5].parse().expect("a position");
        assert!((3000..5000).contains(&position), "{position}");
        assert_eq!(row(&drive("--address 3 inputs"), 0, "LIMP")[1], "on");
        drive("unlock").ended(0, "");
        drive("jog -10").ended(0, "");
        assert_eq!(row(&drive("inputs"), 0, "GO")[1], "on");
    })
    .ended(0, "");
}

/// Cam, end switch, encoder and rating of a module.
#[test]
fn a_module_starts_with_switches_and_an_encoder() {
    let desk = Desk::new();
    let start = "bim2ax --link module --rating-ma 1000 --speed 2 --with 'place 1 cam -900..-400' \
                 --with 'place 1 plus 9000.. --opens' --with 'axis-plug 2 1234' \
                 --with 'encoder 1 incremental --points 2000 --microsteps 3200'";
    let drive = |action: &str| by_hand(&desk, "bim2ax", "module", action);
    emulated(&desk, start, || {
        comes(|| drive("status").status == Some(0));
        assert_eq!(row(&drive("scan"), 0, "BIM2AX-BOCM")[2..4], ["1000", "mA"]);
        drive("set encoder-definition-1 1").ended(0, "");
        drive("reset").ended(0, "");
        drive("unlock 1").ended(0, "");
        drive("move 1 3200").ended(0, "");
        let inputs = drive("inputs");
        inputs.says("incremental");
        let points = inputs.stdout.lines().find(|line| line.contains("incremental"));
        let points = points.and_then(|line| line.split_whitespace().nth(2)).expect("a row");
        assert_eq!(points, "2000");
        drive("home 1").ended(0, "");
        assert_eq!(row(&drive("status"), 0, "1")[1..3], ["0", "home"]);
    })
    .ended(0, "");
}

/// A master at another speed gets no answer, and a hint where to look; unless the emulator takes any.
#[test]
fn masters_at_another_speed_are_not_understood() {
    let desk = Desk::new();
    let status = |baud: &str| {
        let words = format!("drive interpcnc --port board --deadline 300 --baud {baud}");
        desk.twin(&format!("{words} status"))
    };
    let start = "interpcnc --link board --baud 19200";
    emulated(&desk, start, || {
        for _ in 0..2 {
            let silent = status("9600");
            // 300 ms, 77 bytes for 32 registers of 10 bits at 9600 baud, and a silence of 3.5 characters of 11 bits.
            silent.ended(2, "no answer within 384 ms");
            silent.ended(2, "are baud rate and parity those of the device?");
            status("19200").ended(0, "");
        }
    })
    .ended(0, "");
    emulated(&desk, &format!("{start} --any-baud"), || {
        status("9600").ended(0, "");
        status("19200").ended(0, "");
    })
    .ended(0, "");
}

/// A link that is left behind does not matter, though the next terminal may have the number of the last; one in use is.
#[test]
fn a_link_that_a_killed_emulator_has_left_is_replaced() {
    let desk = Desk::new();
    for family in ["interpcnc", "smartdrive", "bim2ax"] {
        let start = format!("emulate {family} --link {family}");
        let done = desk.meanwhile("-KILL", "Ctrl-C ends it", &start, || {
            desk.twin(&start).ended(2, "in use");
        });
        assert_eq!(done.status, None);
        assert!(desk.path(family).symlink_metadata().is_ok(), "it was left behind");
        emulated(&desk, &format!("{family} --link {family}"), || ()).ended(0, "");
    }
}

/// What a device has stored is there after a kill.
#[test]
fn what_is_stored_survives_a_kill() {
    let desk = Desk::new();
    let families = [
        ("interpcnc", &["set home-speed-x 4321"][..], "get home-speed-x", "4321"),
        ("smartdrive", &["set trj_velmax 321", "save"], "get trj_velmax", "321"),
        ("bim2ax", &["set fast-speed-1 432"], "get fast-speed-1", "432"),
    ];
    for (family, actions, question, answer) in families {
        let store = format!("{family}.store");
        for (link, signal) in [("first", "-KILL"), ("second", "-INT")] {
            let link = format!("{family}.{link}");
            let start = format!("emulate {family} --link {link} --eeprom {store}");
            let drive = |action: &str| {
                desk.twin(&format!("drive {family} --port {link} --deadline 1500 {action}"))
            };
            let done = desk.meanwhile(signal, "Ctrl-C ends it", &start, || {
                comes(|| drive("status").status == Some(0));
                if signal == "-KILL" {
                    for action in actions {
                        drive(action).ended(0, "");
                    }
                }
                let found = drive(question);
                assert!(found.stdout.contains(answer), "{family}: {}", found.stdout);
            });
            assert_eq!(done.status, if signal == "-KILL" { None } else { Some(0) });
        }
    }
    desk.write("wrong.store", "mine");
    for family in ["interpcnc", "smartdrive"] {
        desk.twin(&format!("emulate {family} --link other --eeprom wrong.store"))
            .ended(2, "wrong.store: this is not an image");
    }
}

/// What is wrong with words, where they stand, and what is allowed.
#[test]
fn words_that_are_wrong_are_named_with_their_line() {
    let desk = Desk::new();
    desk.write("bench.txt", "cam 5 X ..-300\ncam 33 X 1..2\n");
    let said = |family: &str, option: &str, value: &str, why: &str| {
        desk.twin(&format!("emulate {family} --link link {option} '{value}'")).ended(2, why);
    };
    said("interpcnc", "--bench", "bench.txt", "bench.txt:2: `cam 33 X 1..2`: invalid value '33'");
    said("interpcnc", "--bench", "bench.txt", "33 is not in 1..=32");
    said("interpcnc", "--bench", "none.txt", "--bench none.txt: No such file");
    said("interpcnc", "--with", "cam 5 Q 1..2", "[possible values: x, y, z, a, b]");
    said("interpcnc", "--with", "cam 5 X 9..2", "begins at 9, which must lie below its end 2");
    said("interpcnc", "--with", "dance", "there are enable, input");
    said("interpcnc", "--with", "cam 5", "<AXIS>");
    said("smartdrive", "--with", "cam 9 dir 1..2", "no drive has address 9; there are [1]");
    said("bim2ax", "--with", "place 1 cam 5", "expected FROM..TO");
    said("bim2ax", "--rating-ma", "3000", "1000, 2000 or 5000 mA");
}

/// Which words there are is told without a device, and so is what is missing.
#[test]
fn words_are_listed_without_a_device() {
    let desk = Desk::new();
    let families = [
        ("interpcnc", "cam", "stretch"),
        ("smartdrive", "homing", "timeout"),
        ("bim2ax", "place", "--opens"),
    ];
    for (family, word, about) in families {
        for start in [format!("emulate {family}"), format!("emulate {family} --link link")] {
            let all = desk.twin(&format!("{start} --with help"));
            all.ended(0, "").says_all(&[word, "no-faults"]);
            desk.twin(&format!("{start} --with 'help {word}'")).ended(0, "").says(about);
        }
        desk.twin(&format!("emulate {family}")).ended(2, "--link PATH is missing");
        let emulated = desk.twin(&format!("emulate {family} --assume help"));
        emulated.ended(0, "");
        // The same list by hand, without a device to ask.
        let driven = desk.twin(&format!("drive {family} --assume help"));
        driven.ended(0, "");
        assert_eq!(driven.stdout, emulated.stdout);
        // Help like any other: no error, and no wider than a terminal.
        assert!(!driven.stdout.contains("error") && driven.stderr.is_empty(), "{}", driven.stdout);
        let widest = driven.stdout.lines().map(|line| line.chars().count()).max();
        assert!(widest.is_some_and(|widest| widest <= 100), "{}", driven.stdout);
        let assumed = match family {
            "interpcnc" => "line_at_restart",
            "smartdrive" => "zero_rate",
            _ => "question of the manual",
        };
        driven.says(assumed);
    }
}

/// Assumptions by name, for device and driver.
#[test]
fn assumptions_are_chosen_by_name() {
    let desk = Desk::new();
    let families = [
        ("interpcnc", "locked_exception", "none or 1 to 255"),
        ("smartdrive", "step_from", "setpoint or target"),
        ("bim2ax", "cam_start", "edge-taken or far-edge"),
    ];
    for (family, name, allowed) in families {
        for (command, place, action) in
            [("emulate", "--link link", ""), ("drive", "--port no", "status")]
        {
            let assume = |said: &str| {
                desk.twin(&format!("{command} {family} {place} --assume {said} {action}"))
            };
            assume("help").ended(0, "").says(name);
            assume(&format!("{name}=5000"))
                .ended(2, &format!("{name} = `5000`: it can be {allowed}"));
            assume("nonsense=1").ended(2, name);
            assume(name).ended(2, "expected NAME=VALUE");
        }
    }
    // A board that refuses moves while it is locked says so itself.
    emulated(&desk, "interpcnc --link board --assume locked-exception=4", || {
        let drive = "drive interpcnc --port board --deadline 1500";
        let assumed = "--assume locked-exception=4 --yes move X 100";
        desk.twin(&format!("{drive} {assumed}")).ended(2, "the board is locked");
    })
    .ended(0, "");
}

/// A drive with older firmware that powers up in another mode than off.
#[test]
fn firmware_and_mode_of_a_smartdrive_are_chosen() {
    let desk = Desk::new();
    let chosen = "smartdrive --link bus --firmware 1.1.9.300 --power-up-mode 3";
    emulated(&desk, chosen, || {
        // 1.1.9 as the parameter has it, 4, 8 and 4 bits.
        let release = (1 << 12 | 1 << 4 | 9).to_string();
        for (action, said) in [("get Release", release.as_str()), ("status", "3, obeys the bus")] {
            by_hand(&desk, "smartdrive", "bus", action).ended(0, "").says(said);
        }
    })
    .ended(0, "");
    for (option, value) in
        [("--firmware", "1.2"), ("--firmware", "16.0.0"), ("--power-up-mode", "2")]
    {
        let start = format!("emulate smartdrive --link bus {option} {value}");
        desk.twin(&start).ended(2, &format!("'{value}'"));
    }
}
