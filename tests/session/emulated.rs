//! Runs of the simulated machine together with an emulated board on a pseudo-terminal.

use crate::simulated::CIRCLES;
use crate::{GANTRY3, Program, Recorder, SCARA2, machine, portal};
use std::cell::{Cell, RefCell};
use std::time::Duration;
use twin::attached::Attached;
use twin::check::CheckOptions;
use twin::emulated::connect;
use twin::hardware::{Hardware, HardwareError};
use twin::session::{Ending, Session, Stopped};
use twin::simulated::Simulated;
use twin_drives::DriveError;
use twin_interpcnc::emulator::{Board, Control, EmulatedBoard, Event};
use twin_interpcnc::protocol::registers::BoardAxis;
use twin_kinematics::AxisVector;
use twin_machine::Machine;

/// Part of their largest velocity with which axes come to the start.
const APPROACH: f64 = 0.25;

fn approach(hardware: &mut Hardware) -> Result<(), HardwareError> {
    while !hardware.ready()? {
        std::thread::sleep(Duration::from_millis(2));
    }
    Ok(())
}

/// The only device of a machine, a board.
fn board(machine: &Machine) -> (EmulatedBoard, Attached) {
    let mut connected = connect(machine).unwrap();
    let (Some((emulator, attached)), None) = (connected.pop(), connected.pop()) else {
        panic!("one device")
    };
    (*emulator.into().expect("a board"), attached)
}

fn drives(machine: &Machine, start: &AxisVector) -> (EmulatedBoard, Hardware) {
    let (board, attached) = board(machine);
    let hardware = Hardware::start(machine, vec![attached], start, machine.cycle_ns, APPROACH);
    (board, hardware.unwrap())
}

/// A run of `program` beside a board, at each cycle of which `each` may do something to the board or the user.
fn run(
    machine: &Machine,
    program: &Program,
    each: impl Fn(i64, &RefCell<Option<EmulatedBoard>>, &Cell<u32>),
) -> Outcome {
    let start = program.check(machine).start.unwrap();
    let (board, mut hardware) = drives(machine, &start);
    approach(&mut hardware).unwrap();
    let twin = Simulated::new(machine, &start).unwrap();
    let (board, interrupts) = (RefCell::new(Some(board)), Cell::new(0));
    let mut recorder = Recorder::with(|time_ns| each(time_ns, &board, &interrupts));
    let session = Session { hardware: Some(hardware), ..program.session(machine, twin) };
    let ending = session.run(&mut recorder, &|| interrupts.get()).unwrap();
    let recorder = recorder.ended();
    Outcome { ending, recorder, board: board.into_inner().map(|board| *board.stop().unwrap()) }
}

/// The circles on the portal, in which `once` does something to the board or the user at 0.5 s.
fn disturbed(once: impl Fn(&RefCell<Option<EmulatedBoard>>, &Cell<u32>)) -> (Machine, Outcome) {
    let machine = portal();
    let happened = Cell::new(false);
    let outcome = run(&machine, &Program::new(CIRCLES), |time_ns, board, interrupts| {
        if time_ns >= 500_000_000 && !happened.replace(true) {
            once(board, interrupts);
        }
    });
    (machine, outcome)
}

/// Makes something happen to a board.
fn happens(board: &RefCell<Option<EmulatedBoard>>, event: Event) {
    board.borrow().as_ref().unwrap().control(Control::Event(event)).unwrap();
}

struct Outcome {
    ending: Ending,
    recorder: Recorder<'static>,
    board: Option<Board>,
}

impl Outcome {
    /// The board's axes rest, where the last set-point is.
    #[track_caller]
    fn assert_drives_where_the_twin_is(&self, machine: &Machine) {
        self.assert_drives_at_rest();
        let wanted = self.recorder.last().wanted.axes;
        for ((axis, wanted), board_axis) in
            machine.axes.iter().zip(wanted.iter()).zip(BoardAxis::ALL)
        {
            let increments = wanted * axis.increments_per_si();
            let found = self.board.as_ref().unwrap().position(board_axis);
            assert!(
                (found - increments).abs() <= 1.0,
                "axis {}: {found}, not {increments}",
                axis.name
            );
        }
    }

    #[track_caller]
    fn assert_drives_at_rest(&self) {
        let board = self.board.as_ref().unwrap();
        assert!(board.status().moving().is_empty());
        assert!(BoardAxis::ALL.iter().all(|axis| board.velocity(*axis) == 0.0));
    }
}

#[test]
fn drives_and_simulated_machine_end_at_the_same_place() {
    let machine = machine(SCARA2);
    let program = Program::new(
        "% short\nN10 F150 E800 E-800\nN20 G1 X290 Y15\nN30 G2 X310 Y15 R10\nN40 G1 X300 Y0 Z12\n",
    );
    let outcome = run(&machine, &program, |_, _, _| {});
    assert!(outcome.ending.stopped.is_none(), "{:?}", outcome.ending.stopped);
    outcome.recorder.assert_twin_at_rest();
    outcome.assert_drives_where_the_twin_is(&machine);

    let Outcome { ending, recorder, .. } = outcome;
    assert_eq!(ending.executed_ns, program.check(&machine).duration_ns);
    assert!(recorder.heard.len() >= 10, "{} samples", recorder.heard.len());
    assert!(recorder.heard.is_sorted_by_key(|heard| heard.time_ns));
    let last = recorder.heard.last().unwrap();
    assert!(last.time_ns >= ending.executed_ns, "listened to the end");
    for ((axis, found), wanted) in
        machine.axes.iter().zip(last.drives.axes.iter()).zip(recorder.last().wanted.axes.iter())
    {
        let increments = (found - wanted) * axis.increments_per_si();
        assert!(increments.abs() <= 1.0, "axis {}: {increments} increments off", axis.name);
    }
    // Real and simulated machine are compared with the set-points and with each other.
    let tool = ending.comparison.tool;
    for statistics in [tool.twin, tool.drives, tool.drives_against_twin] {
        let (max, _) = statistics.maximum().unwrap();
        assert!(max > 0.0 && statistics.rms() > 0.0 && statistics.rms() <= max);
    }
    // They moved: 16 mm from the start at least, on both sides.
    let farthest =
        recorder.heard.iter().map(|heard| (heard.drives.tool.x - 0.3).abs()).fold(0.0, f64::max);
    assert!(farthest > 5e-3, "{farthest}");
}

#[test]
fn a_closed_path_shorter_than_the_horizon_is_followed_to_its_end() {
    // 0.2 s: planned to its end before the drives have begun, and they stand where it ends.
    let machine = portal();
    let program = Program::new("% there and back\nN10 G1 X5 F200 E2000 E-2000\nN20 G1 X0\n");
    let outcome = run(&machine, &program, |_, _, _| {});
    assert!(outcome.ending.stopped.is_none(), "{:?}", outcome.ending.stopped);
    outcome.assert_drives_where_the_twin_is(&machine);
    let last = outcome.recorder.heard.last().unwrap();
    assert!(last.time_ns >= outcome.ending.executed_ns, "{last:?}");
}

#[test]
fn a_board_that_dies_stops_the_simulated_machine_at_the_limits_of_its_axes() {
    // Powered down.
    let (machine, outcome) = disturbed(|board, _| drop(board.borrow_mut().take()));
    let Some(stopped @ Stopped::Drives { place, source }) = &outcome.ending.stopped else {
        panic!("{:?}", outcome.ending.stopped)
    };
    assert!(matches!(source, HardwareError::Drive { .. }), "{source:?}");
    assert!(stopped.to_string().starts_with("the drives failed at line 2 (N10)"), "{stopped}");
    assert!(stopped.to_string().contains("address 1: "), "{stopped}");
    assert_eq!(place.line, 2);
    assert!(outcome.ending.executed_ns < Program::new(CIRCLES).check(&machine).duration_ns);
    outcome.recorder.assert_twin_at_rest();
    assert_eq!(outcome.ending.off_path.map(|place| place.line), Some(2));
    // Off the path: v²/2A = 1.7 mm along the tangent at most.
    let radius = (outcome.recorder.last().wanted.tool - nalgebra::point![0.03, 0.0, -0.04]).norm();
    assert!((radius - 0.03).abs() > 1e-7 && (radius - 0.03).abs() < 1.7e-3, "{radius}");
}

#[test]
fn an_interrupt_brings_drives_and_simulated_machine_to_rest_at_the_same_place() {
    let (machine, outcome) = disturbed(|_, interrupts| interrupts.set(1));
    let stopped = &outcome.ending.stopped;
    assert!(matches!(stopped, Some(Stopped::Interrupted(place)) if place.line == 2), "{stopped:?}");
    assert!(outcome.ending.executed_ns < Program::new(CIRCLES).check(&machine).duration_ns);
    outcome.recorder.assert_twin_at_rest();
    outcome.assert_drives_where_the_twin_is(&machine);
    // It is told where that is: of the drives, what they said last, an increment (1/80 mm or less) from the set-points.
    let rest = outcome.ending.rest.as_ref().unwrap();
    let (heard_ns, drives) = rest.drives.unwrap();
    assert!(heard_ns >= rest.time_ns && rest.time_ns > rest.asked_ns.unwrap());
    for (axis, (drives, wanted)) in
        machine.axes.iter().zip(drives.axes.iter().zip(rest.wanted.axes.iter()))
    {
        let error = (drives - wanted) * axis.increments_per_si();
        assert!(error.abs() <= 1.0, "axis {}: {error} increments", axis.name);
    }
    assert!(rest.message(&machine).contains("; the drives were last heard of at "));
}

/// The error names what was found when the board was looked at again: right away where it answers, and after its silence.
#[test]
fn a_board_that_was_without_supply_is_found_restarted() {
    // A question and its repetition take 1.5 s at most, the look afterwards another 2 s.
    for off_ns in [0, 2_300_000_000] {
        let once = Cell::new(true);
        let (_, outcome) = disturbed(|board, _| {
            if once.replace(false) {
                happens(board, Event::BrownOut { off_ns });
            }
        });
        assert_eq!(outcome.recorder.last().path_velocity, 0.0);
        let Some(Stopped::Drives { source: HardwareError::Drive { source: error, .. }, .. }) =
            &outcome.ending.stopped
        else {
            panic!("{:?}", outcome.ending.stopped)
        };
        // A computer that is busy may ask again only when the board is back, and learns the same sooner.
        let silent = off_ns > 0 && matches!(**error, DriveError::Timeout { .. });
        assert!(silent || matches!(**error, DriveError::Locked { .. }), "{error}");
        let reason = outcome.ending.reason().unwrap();
        let cause =
            "device `board` answers again, at position 0 and not enabled: it has been restarted";
        assert!(reason.contains(cause) && !reason.contains("or the stop"), "{reason}");
        assert!(reason.contains("address 1: "), "{reason}");
    }
}

/// Off the path both brake to the same place; the third interrupt leaves the drives to their own ramps.
#[test]
fn further_interrupts_brake_the_drives_where_they_are() {
    for count in [2, 3] {
        let (machine, outcome) = disturbed(|_, interrupts| interrupts.set(count));
        let stopped = &outcome.ending.stopped;
        assert!(matches!(stopped, Some(Stopped::Interrupted(_))), "{count}: {stopped:?}");
        outcome.recorder.assert_twin_at_rest();
        outcome.assert_drives_at_rest();
        if count == 2 {
            assert_eq!(outcome.ending.off_path.map(|place| place.line), Some(2));
            outcome.assert_drives_where_the_twin_is(&machine);
        }
    }
}

/// An interrupt at the same time does not hide the error, and a lock that nothing but the ENABLE input has brought about is not
/// called a restart.
#[test]
fn an_open_enable_input_stops_the_run_and_is_named() {
    for count in [0, 1] {
        println!("{count} interrupts");
        let (_, outcome) = disturbed(|board, interrupts| {
            happens(board, Event::Enable(false));
            interrupts.set(count);
        });
        let Some(stopped @ Stopped::Drives { .. }) = &outcome.ending.stopped else {
            panic!("{count}: {:?}", outcome.ending.stopped)
        };
        assert!(stopped.to_string().contains("the ENABLE input is open"), "{count}: {stopped}");
        assert!(outcome.ending.restarted.is_empty(), "{:?}", outcome.ending.restarted);
        outcome.recorder.assert_twin_at_rest();
        outcome.assert_drives_at_rest();
        assert!(outcome.board.unwrap().status().locked());
    }
}

#[test]
fn a_board_without_enable_is_refused_before_anything_is_followed() {
    let machine = machine(SCARA2);
    let start = machine.start_axes().unwrap();
    let (board, attached) = board(&machine);
    board.happen(Event::Enable(false)).unwrap();
    let mut hardware =
        Hardware::start(&machine, vec![attached], &start, machine.cycle_ns, APPROACH).unwrap();
    let error = approach(&mut hardware).unwrap_err();
    assert!(error.to_string().contains("the ENABLE input is open"), "{error}");
    drop(hardware);
    assert!(board.stop().unwrap().status().moving().is_empty());
}

#[test]
fn drives_dropped_on_their_way_to_the_start_come_to_rest() {
    let machine = machine(SCARA2);
    let start = machine.start_axes().unwrap();
    let (board, mut hardware) = drives(&machine, &start);
    for _ in 0..50 {
        assert!(!hardware.ready().unwrap(), "97 degrees of B at 75 degrees per second");
        std::thread::sleep(Duration::from_millis(2));
    }
    drop(hardware);
    assert!(board.stop().unwrap().status().moving().is_empty());
}

/// Segments of straight lines end where they should, and are as near to the plan on the way as is said beforehand: they
/// are sent a few at a time, each from rest to rest.
#[test]
fn a_board_follows_by_segments() {
    let text = GANTRY3.replace("start_mm = [0.0, 0.0, 20.0]", "start_mm = [0.0, 0.0, -40.0]");
    let buffered = "kind = \"interpcnc\"\nfollowing = \"buffered\"\nstart_stop_hz = 2000";
    let machine = machine(&text.replace("kind = \"interpcnc\"", buffered));
    let program = Program::new("% lines\nN10 G1 X8 Y4 F40 E400 E-400\nN20 G1 X0 Y8 Z-35\n");
    let options = CheckOptions { limits: program.limits, drives: true, ..CheckOptions::default() };
    let checked = twin::check::check(&machine, &program.file, options, &mut |_| {}).unwrap();
    let predicted = checked.following.unwrap();
    let outcome = run(&machine, &program, |_, _, _| {});
    assert!(outcome.ending.stopped.is_none(), "{:?}", outcome.ending.stopped);
    let heard = outcome.recorder.heard.windows(2);
    let gap = heard.map(|pair| pair[1].time_ns - pair[0].time_ns).max().unwrap() as f64 * 1e-9;
    for axis in 0..3 {
        let (predicted, _) = predicted.axes[axis].unwrap().maximum().unwrap();
        let (found, _) = outcome.ending.comparison.axes[axis].drives.maximum().unwrap();
        let more = checked.peaks[axis].velocity.value * (gap + 1e-3);
        assert!(found <= predicted + more, "axis {axis}: {found}, predicted {predicted}, {more}");
    }
    outcome.assert_drives_where_the_twin_is(&machine);
}

/// At most as much farther away as an axis moves in the longest time in which nobody corrected it and in what a time stamp is
/// uncertain by (half of 2 ms of turnaround), and no order of magnitude nearer.
#[test]
fn a_run_is_as_far_from_its_plan_as_was_predicted() {
    let machine = portal();
    let program = Program::new(CIRCLES);
    let options = CheckOptions { limits: program.limits, drives: true, ..CheckOptions::default() };
    let checked = twin::check::check(&machine, &program.file, options, &mut |_| {}).unwrap();
    let predicted = checked.following.unwrap();
    let outcome = run(&machine, &program, |_, _, _| {});
    assert!(outcome.ending.stopped.is_none(), "{:?}", outcome.ending.stopped);
    let heard = outcome.recorder.heard.windows(2);
    let gap = heard.map(|pair| pair[1].time_ns - pair[0].time_ns).max().unwrap() as f64 * 1e-9;
    for axis in 0..2 {
        let predicted = predicted.axes[axis].unwrap();
        let found = outcome.ending.comparison.axes[axis].drives;
        let speed = checked.peaks[axis].velocity.value;
        let (largest, _) = predicted.maximum().unwrap();
        let (found_largest, _) = found.maximum().unwrap();
        let more = speed * (gap + 1e-3);
        let told = format!("axis {axis}: {found_largest}, predicted {largest}, {more}");
        assert!(found_largest <= largest + more && found_largest >= 0.1 * largest, "{told}");
        assert!(found.rms() <= predicted.rms() + more && found.rms() >= 0.1 * predicted.rms());
    }
}
