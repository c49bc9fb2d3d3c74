//! `twin drive … stop`: the stop is sent first, whatever else is wrong.

use crate::desk::{BINARY, Desk, comes, started};
use crate::drive::{Hand, a_board, a_bus, a_module};
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use std::time::Duration;
use twin_bim2ax::emulator::{EmulatedModule, Event};
use twin_bim2ax::{Bim2AxDrive, Bim2AxDriveOptions, MemoryFile, ModuleAxis};
use twin_drives::{Drive, MAX_DRIVE_AXES};
use twin_interpcnc::{BoardAxis, emulator as board};
use twin_smartdrive::emulator as bus;

/// A module whose axis 1 runs far, and its master.
fn under_way() -> (EmulatedModule, Hand, Bim2AxDrive) {
    let (running, hand) = a_module();
    let memory = MemoryFile::open(running.path()).expect("a memory file");
    let mut options = Bim2AxDriveOptions::new();
    options.axes = vec![ModuleAxis::One];
    options.driver.deadline = Duration::from_millis(1500);
    let mut drive = Bim2AxDrive::new("module", memory, &options).expect("it is there");
    drive.enable().expect("it is in order");
    let mut target = [0; MAX_DRIVE_AXES];
    target[0] = -4_000_000;
    let mut speed = [0.0; MAX_DRIVE_AXES];
    speed[0] = 4000.0;
    drive.move_to(&target, &speed).expect("it moves");
    (running, hand, drive)
}

/// The same, and its master is gone.
fn runaway() -> (EmulatedModule, Hand) {
    let (running, hand, _) = under_way();
    (running, hand)
}

fn rests(running: &EmulatedModule) -> bool {
    running.module().velocity(ModuleAxis::One).abs() < f64::EPSILON
}

#[test]
fn a_bim2ax_with_a_wrong_check_sum_is_stopped() {
    for stop in ["stop", "stop --now"] {
        let (running, hand) = runaway();
        running.module().happen(Event::SpoilEeprom);
        assert!(!rests(&running));
        hand.does(stop);
        assert!(rests(&running), "{stop}");
    }
}

/// Read in the other byte order, the order for a hard stop would be that for homing.
#[test]
fn a_bim2ax_in_the_other_byte_order_is_stopped() {
    for stop in ["--little-endian stop", "--little-endian stop --now"] {
        let (running, hand) = runaway();
        hand.refuses("--little-endian status", "numbers come in the other order");
        assert!(!rests(&running));
        hand.does(stop).ended(0, "see --little-endian");
        assert!(rests(&running), "{stop}");
        let stood = running.module().shaft(ModuleAxis::One);
        // At rest, neither stop makes it move.
        hand.does(stop);
        assert!(running.module().shaft(ModuleAxis::One) == stood && rests(&running), "{stop}");
    }
}

/// One that is in alarm has stopped by itself; stopping it is not an error, and the others of the bus are left alone.
#[test]
fn a_smartdrive_is_stopped_whatever_state_it_is_in() {
    let (running, hand) = a_bus(Vec::new());
    hand.does("stop");
    hand.does("unlock");
    let alarms = twin_smartdrive::Alarms::OVERTEMPERATURE;
    running.control(bus::Event::Fault { alarms, present: true }.to(0)).expect("it runs");
    hand.does("stop");
    running.control(bus::Event::Fault { alarms, present: false }.to(0)).expect("it runs");
    assert_eq!(hand.does("stop --now").stdout, "off\n");
}

/// A memory file has one master; only a stop may come from another program.
#[test]
fn a_bim2ax_that_has_a_master_is_only_stopped_by_another() {
    let (running, hand, master) = under_way();
    for action in ["status", "unlock 1", "move 1 0 --yes"] {
        hand.refuses(action, "another program is the master of");
        assert!(!rests(&running), "{action}");
    }
    let done = hand.tries("stop");
    done.ended(1, "another program drives this module and may move it again");
    assert!(done.stdout.starts_with("at rest at "), "{}", done.stdout);
    assert!(rests(&running));
    drop(master);
    hand.does("status");
    hand.does("stop");
}

/// A program that waits (G4, M0) sees nothing of a stop and goes on after it: the stop says so.
#[test]
fn a_stop_of_a_bim2ax_whose_master_waits_is_no_end() {
    let (running, hand, mut master) = under_way();
    master.soft_stop().expect("it stops");
    comes(|| rests(&running));
    hand.tries("stop").ended(1, "may move it again");
    let (mut target, mut speed) = ([0; MAX_DRIVE_AXES], [0.0; MAX_DRIVE_AXES]);
    (target[0], speed[0]) = (-4_000_000, 4000.0);
    master.move_to(&target, &speed).expect("it moves again");
    comes(|| !rests(&running));
    master.soft_stop().unwrap_or_default();
}

/// Waits until X of a board moves.
pub(crate) fn under_way_on(running: &board::EmulatedBoard) {
    comes(|| running.look().expect("it runs").velocity(BoardAxis::X) != 0.0);
}

fn send(signal: &str, process: u32) {
    let sent = Command::new("kill").args([signal, &process.to_string()]).status();
    assert!(sent.expect("kill is there").success());
}

/// The window in which it was started is closed, or what has read its words has gone: the axes stop all the same.
#[test]
fn a_stop_needs_nobody_who_listens() {
    // What ends or suspends other programs would let the axes go on.
    for signal in ["-HUP", "-INT", "-QUIT", "-TSTP"] {
        let (running, hand) = a_board(1);
        hand.does("unlock");
        let mut jog = hand.command("move X 1000000 --speed 2000 --yes");
        let mut child =
            jog.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("a process");
        under_way_on(&running);
        // Whatever it says from now on fails.
        drop((child.stdout.take(), child.stderr.take()));
        send(signal, child.id());
        let ended = child.wait().expect("it ends");
        assert_eq!(ended.code(), Some(2), "{signal}");
        let board = running.stop().expect("it runs");
        assert!(board.status().moving().is_empty(), "{signal}");
        let stands = board.counters()[0];
        assert!((1..1_000_000).contains(&stands), "{signal}: {stands}");
    }
}

/// The same command, by a shell that has the signal ignored, as scripts do in the background and `nohup` does.
fn started_without(signal: &str, command: &Command) -> Command {
    let mut shell = started("sh");
    shell.args(["-c", &format!("trap '' {signal}; exec \"$@\""), "sh"]);
    // Without what has given the binary its signals back.
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    shell.args(words.skip_while(|word| *word != BINARY));
    if let Some(folder) = command.get_current_dir() {
        shell.current_dir(folder);
    }
    shell.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    shell
}

/// Whoever runs these tests in the background, or with `nohup`, has signals ignored; the tests that send them hold all the same.
#[test]
fn signals_get_through_whoever_runs_the_tests() {
    let this = std::env::current_exe().expect("this");
    let tested = ["drive_stop::a_stop_needs_nobody_who_listens", "--exact"];
    let mut shell = Command::new("sh");
    shell.args(["-c", "trap '' HUP INT QUIT TSTP; exec \"$@\"", "sh"]).arg(this).args(tested);
    let output = shell.stdin(Stdio::null()).output().expect("it starts");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && said.contains("1 passed"), "{said}");
}

/// A script that is started in the background has Ctrl-C ignored; axes stop on it all the same.
#[test]
fn what_moves_stops_on_ctrl_c_whoever_has_started_it() {
    let (running, hand) = a_board(1);
    hand.does("unlock");
    let jog = hand.command("move X 1000000 --speed 2000 --yes");
    let mut child = started_without("INT", &jog).spawn().expect("a process");
    under_way_on(&running);
    send("-INT", child.id());
    assert_eq!(child.wait().expect("it ends").code(), Some(2));
    let board = running.stop().expect("it runs");
    assert!(board.status().moving().is_empty());
    assert!((1..1_000_000).contains(&board.counters()[0]));
}

/// What serves others in the background of a script outlives the Ctrl-C of those, and says what ends it.
#[test]
fn an_emulator_in_the_background_says_what_ends_it() {
    let desk = Desk::new();
    let mut shell = started_without("INT", &desk.command("emulate smartdrive --link bus"));
    let mut child = shell.stderr(Stdio::piped()).spawn().expect("a process");
    let words = BufReader::new(child.stderr.take().expect("piped")).lines();
    let sign = words.map_while(Result::ok).find(|line| line.contains("ends it"));
    assert_eq!(
        sign.as_deref(),
        Some("SIGTERM ends it (Ctrl-C does not: it was started in the background).")
    );
    send("-INT", child.id());
    std::thread::sleep(Duration::from_millis(300));
    assert!(child.try_wait().expect("it can be asked").is_none(), "it has ended");
    send("-TERM", child.id());
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
}

/// Who starts it with `nohup` wants it to go on when the terminal is closed.
#[test]
fn what_is_to_outlive_its_terminal_does() {
    let (running, hand) = a_board(1);
    hand.does("unlock");
    let moved = hand.command("move X 6000 --speed 2000 --yes");
    let mut child = started_without("HUP", &moved).spawn().expect("a process");
    under_way_on(&running);
    send("-HUP", child.id());
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
    assert_eq!(running.stop().expect("it runs").counters()[0], 6000);
}
