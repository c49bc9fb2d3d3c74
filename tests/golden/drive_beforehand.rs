//! Checks of `twin drive` before any motion: coupled axes, restarted devices, parameters that are written at rest only.

use crate::desk::{Done, comes};
use crate::drive::{Hand, a_board, a_bus, a_module, row};
use crate::drive_stop::under_way_on;
use std::process::{Child, Stdio};
use twin_interpcnc::BoardAxis;
use twin_interpcnc::emulator as board;
use twin_smartdrive::emulator as bus;

/// `EE_COUPLAGE_AXE`, parameter 86: 1 = A goes along with X, 2 = B does.
#[test]
fn an_axis_that_goes_along_with_x_is_named() {
    let (running, hand) = a_board(1);
    hand.does("unlock");
    hand.refuses("set coupling 5", "it takes 0 to 2 (0 = none, 1 = A with X, 2 = B with X)");
    hand.does("move B 300 --speed 4000 --yes");
    let set = hand.does("set coupling 2").stdout;
    let expected = "parameter 86 (coupling): 0 -> 2 (0 = none, 1 = A with X, 2 = B with X)\n";
    assert_eq!(set, expected);
    let asked = "move axis X from 0 to 400 steps at 1000 steps/s, and axis B with it (parameter 86, coupling) from 300 to 700: \
                 nothing has moved";
    hand.refuses("move X 400", asked);
    let moved = hand.does("jog X 400 --speed 4000 --yes");
    assert_eq!(moved.stdout, "axis X is at 400\naxis B, which has gone along, is at 700\n");
    // Alone it would be driven away from X.
    for alone in ["move B 0 --yes", "jog B 5 --yes", "home B --yes", "home X B --yes"] {
        hand.refuses(alone, "axis B goes along with X (parameter 86, coupling, is 2)");
    }
    hand.refuses("home B --by-switch 0 --input 5 --yes", "axis B goes along with X");
    assert_eq!(hand.does("move A 50 --speed 4000 --yes").stdout, "axis A is at 50\n");
    hand.does("set home-input-x 5");
    hand.does("set home-speed-x 4000");
    let asked = "100000 steps at most, at 4000 steps/s, and axis B with it (parameter 86, coupling) from 700";
    hand.refuses("home X", asked);
    let homed = hand.does("home X --by-switch 0 --input 5 --yes");
    assert!(homed.stderr.contains("axis X and axis B with it (parameter 86, coupling)"));
    homed.says("axis B, which has gone along, is at ");
    let board = running.stop().expect("it runs");
    let apart = board.mechanical(BoardAxis::B) - board.mechanical(BoardAxis::X);
    assert!((apart - 300.0).abs() <= 1.0, "{apart}");
}

/// Runs next to the test.
fn begun(hand: &Hand, action: &str) -> Child {
    let mut command = hand.command(action);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("a process")
}

/// What a process that was started has come to.
fn come_to(child: Child) -> (Option<i32>, String) {
    let done = child.wait_with_output().expect("it ends");
    (done.status.code(), String::from_utf8_lossy(&done.stderr).into_owned())
}

#[track_caller]
fn tells_of_the_restart(child: Child, shown: &str) {
    let (status, said) = come_to(child);
    // However wide the terminal is.
    let said: Vec<_> = said.split_whitespace().filter(|word| *word != "│").collect();
    let said = said.join(" ");
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains("the device shows itself as after a restart"), "{said}");
    assert!(
        said.contains(shown) && said.contains("the positions of the axes are not known"),
        "{said}"
    );
}

#[test]
fn a_board_that_was_off_meanwhile_does_not_stand_at_0() {
    let (running, hand) = a_board(1);
    hand.does("unlock");
    hand.does("move X 500 --speed 4000 --yes");
    let moves = begun(&hand, "move X 1000000 --speed 5000 --yes");
    under_way_on(&running);
    let event = board::Event::BrownOut { off_ns: 200_000_000 };
    running.control(board::Control::Event(event)).expect("it runs");
    tells_of_the_restart(moves, "the board is locked, and all its counters are 0");
}

/// Waits until the first drive of a bus moves.
fn under_way_on_bus(running: &bus::EmulatedBus) {
    comes(|| {
        let devices = running.look().expect("it runs");
        devices.first().is_some_and(|device| device.motion().1 != 0.0)
    });
}

#[test]
fn a_smartdrive_that_was_off_meanwhile_does_not_stand_at_0() {
    let (running, hand) = a_bus(Vec::new());
    hand.does("unlock");
    let moves = begun(&hand, "move 1000000 --speed 120 --yes");
    under_way_on_bus(&running);
    running.control(bus::Event::BrownOut { off_ns: 200_000_000 }.to(0)).expect("it runs");
    tells_of_the_restart(moves, "the drive does not obey the bus, and its position is 0");
}

/// What a parameter bends or ends is the motion of somebody else.
#[test]
fn parameters_are_written_at_rest() {
    let (running, hand) = a_board(1);
    hand.does("backup kept.txt");
    hand.does("unlock");
    running.look().expect("it runs");
    let far = board_moves(&running);
    hand.refuses("set coupling 0", "an axis moves: `stop` before `set`");
    hand.refuses("restore kept.txt --yes", "an axis moves: `stop` before `restore`");
    hand.does("stop");
    hand.does("set coupling 0");
    drop(far);

    let (running, hand) = a_bus(Vec::new());
    hand.does("unlock");
    let moves = begun(&hand, "move 1000000 --speed 120 --yes");
    under_way_on_bus(&running);
    // Its master is killed, and the axis goes on.
    let killed = killed(moves);
    assert!(killed, "it was at work");
    hand.refuses("set Trj_VelMax 300", "the axis moves: `stop` before `set`");
    hand.does("set Out_LED 0xFFFF");
    hand.does("stop");
    hand.does("set Trj_VelMax 300");
}

fn killed(mut child: Child) -> bool {
    let at_work = child.try_wait().expect("a process").is_none();
    child.kill().expect("it is killed");
    child.wait().expect("it ends");
    at_work
}

/// Y of a board goes far, and nobody looks after it.
fn board_moves(running: &board::EmulatedBoard) -> Done {
    let port = running.path().to_str().expect("a path");
    let hand = Hand::new("interpcnc", port, "--deadline 1500");
    let moves = begun(&hand, "move X 1000000 --speed 5000 --yes");
    under_way_on(running);
    assert!(killed(moves), "it was at work");
    hand.does("status")
}

/// Registers 4146 and 4147, 0 to 1023.
#[test]
fn analog_outputs_of_a_board_are_shown_and_set() {
    let (running, hand) = a_board(1);
    hand.refuses("outputs A1=512", "the board is locked");
    hand.does("unlock");
    let shown = hand.does("outputs A1=512 a2=1023 3=on");
    assert_eq!((row(&shown, 0, "A1")[1], row(&shown, 0, "A2")[1]), ("512", "1023"));
    hand.refuses("outputs A1=1024", "output A1 takes 0 to 1023");
    hand.refuses("outputs A3=5", "there are A1 and A2");
    assert_eq!(running.stop().expect("it runs").analog_outputs(), [512, 1023]);
}

/// Three bits of which the manual does not say what sets them.
#[test]
fn conditions_of_a_smartdrive_are_shown() {
    let (running, hand) = a_bus(Vec::new());
    hand.does("unlock");
    let words = ["busy", "signalled", "triggered"];
    let status = hand.does("status").stdout;
    assert!(words.iter().all(|word| !status.contains(word)), "{status}");
    for condition in [bus::Condition::Busy, bus::Condition::Signalled, bus::Condition::Triggered] {
        running.control(bus::Event::Condition(condition, true).to(0)).expect("it runs");
    }
    let status = hand.does("status").stdout;
    assert!(status.contains("at rest, busy, signalled, triggered"), "{status}");
    // A new motion clears the trigger.
    hand.does("jog 100 --yes");
    assert!(!hand.does("status").stdout.contains("triggered"));
}

/// "Annexe": Q1.15; "Variables" have numbers of their own.
#[test]
fn numbers_of_a_smartdrive_are_explained() {
    let (_running, hand) = a_bus(Vec::new());
    hand.refuses("set Cur_Idle 0.3", "it is written in 32768ths, and 0.3 is 9830");
    hand.refuses("set Trj_VelMax 0.3", "`0.3` is not a whole number");
    assert!(hand.does("set Cur_Idle 8192").stdout.contains("9830 -> 8192/32768\n"));
    assert_eq!(row(&hand.does("get Cur_Idle"), 0, "66")[5], "/32768");
    hand.refuses("get 75", "there is no parameter 75; variable 75 is Pos_Actual: say its name");
}

/// A programmed speed is capped by the fast speed, here 1000 steps/s of 16 µsteps; a motor without current gets it.
#[test]
fn what_a_move_of_a_bim2ax_does_besides_is_asked() {
    let (_running, hand) = a_module();
    let asked = "at 16000 µsteps/s (5000 is beyond the fast speed, 1000; in 16 µsteps/s each); its motor gets current";
    hand.refuses("move 1 4000 --speed 5000", asked);
    hand.does("unlock 1");
    hand.refuses("move 1 4000 --speed 500", "at 8000 µsteps/s: nothing has moved");
}
