//! `twin drive … home --by-switch`: homing onto switches that the drive only reports.

use crate::drive::{a_board, a_bus, a_module, row};
use twin_bim2ax::emulator::Event;
use twin_bim2ax::{Contact, ModuleAxis};
use twin_interpcnc::BoardAxis;
use twin_interpcnc::emulator as board;

/// As a look at the switch takes, some tens of µsteps at the slow speed, with the time of this computer.
const LATE: f64 = 150.0;

/// The switch on DIR is pressed from 3000 to 1000 µsteps behind the start: backwards onto it, and slowly off it again, is home.
#[test]
fn a_smartdrive_is_homed_by_a_switch_at_an_input() {
    let (running, hand) = a_bus(Vec::new());
    // Inputs are GO, DIR, OFF, LIMP, LIMN. No home switch is known of this drive.
    hand.refuses("home --by-switch 0 --yes", "home switch");
    let ask = "home --by-switch 0 --input 2 --fast 3200 --slow 534 --max-way 5000";
    hand.refuses(ask, "towards - until input 2 says so, 5000 µsteps at most");
    hand.does(&format!("{ask} --yes")).says("drive 1 is home, at ");
    // TRJINIT 1, "la position actuelle devient 0": the drive's own counter shows it.
    hand.refuses(&format!("{ask} --home-position 10001 --yes"), "--max-slow-way");
    let devices = running.stop().expect("it runs");
    let home = devices[0].mechanical() - f64::from(devices[0].counter());
    assert!((home + 1000.0).abs() <= LATE, "{home}");
    assert_eq!(devices[0].counter(), 0);
}

/// The cam of axis 1 reaches from 400 µsteps behind the start on backwards.
#[test]
fn an_axis_of_a_bim2ax_is_homed_by_its_cam_and_by_an_input() {
    let (running, hand) = a_module();
    let mut surroundings = *running.module().surroundings();
    surroundings.benches[0].cam = Some(Contact::below(-400, true));
    running.module().happen(Event::Surroundings(Box::new(surroundings)));
    hand.refuses("home 1 2 --by-switch 0 --yes", "homes one axis at a time");
    // Inputs of the axis are its end switches + and -, and its cam.
    for switch in ["", " --input 3"] {
        let ask = format!("home 1 --by-switch 0{switch} --fast 3200 --slow 800 --max-way 8000");
        hand.does(&format!("{ask} --yes")).says("axis 1 is home, at ");
        let module = running.module();
        let shaft = i32::try_from(module.shaft(ModuleAxis::One)).expect("it has not gone far");
        let home = f64::from(shaft) - module.position(ModuleAxis::One);
        assert!((home + 400.0).abs() <= LATE, "{home}");
    }
}

/// The program that watches the switch is killed on its way there, which would be 50 s long: the axis rests at the end of its leg,
/// half a second's way from where it was then.
#[test]
fn an_axis_whose_program_is_killed_ends_within_a_leg() {
    let (running, hand) = a_board(1);
    let mut homing = hand
        .command("home X --by-switch 0 --input 7 --fast 2000 --max-way 100000 --yes")
        .stderr(std::process::Stdio::null())
        .spawn()
        .expect("it starts");
    let at = || running.look().expect("it runs").mechanical(BoardAxis::X);
    while at() > -2500.0 {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    homing.kill().expect("it runs");
    homing.wait().expect("it has run");
    let killed = at();
    while !running.look().expect("it runs").status().moving().is_empty() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let board = running.stop().expect("it runs");
    assert!(board.status().moving().is_empty());
    let stands = board.mechanical(BoardAxis::X);
    assert!(stands <= -2500.0 && stands >= killed - 1000.0, "killed at {killed}, at {stands}");
}

/// Home of X, steps from where it was switched on, after homing with these words; and the position of the axis then.
fn homed(words: &str) -> (f64, f64) {
    let (running, hand) = a_board(1);
    let cam = |input, from, to| {
        let axis = BoardAxis::X;
        board::Cam { input, axis, from, to, normally_closed: false }
    };
    // Backwards: an index pulse on IN6, the home switch on IN5, another pulse, a limit switch on IN7.
    let cams = vec![
        cam(6, -1200, -1100),
        cam(5, -2600, -1500),
        cam(6, -3100, -2900),
        cam(7, -9000, -4000),
    ];
    let bench = board::Bench { cams, encoder: None };
    running.control(board::Control::Event(board::Event::Bench(bench))).expect("it runs");
    hand.does("set limit-minus-input-x 7");
    let ask =
        format!("home X {words} --fast 1000 --slow 200 --max-way 8000 --max-slow-way 5000 --yes");
    hand.does(&ask).says("axis X is home, at ");
    let counter: f64 = row(&hand.does("status"), 0, "X")[1].parse().expect("a position");
    let board = running.stop().expect("it runs");
    assert!(board.status().moving().is_empty());
    let mechanical = board.mechanical(BoardAxis::X);
    (mechanical - counter, counter)
}

/// 2.2.7: fast in the direction until the switch closes, then slowly back (0 to 2) or on (4 to 6) until it opens; home is there (0,
/// 4) or the next index pulse (2, 6). What is seen is as late as a look, at most a quarter of a second of 200 steps/s.
#[test]
fn home_is_where_the_mode_and_the_options_say() {
    for (words, edge) in [
        ("--by-switch 2 --input 5 --index-input 6", -1200.0),
        ("--by-switch 6 --input 5 --index-input 6", -2900.0),
        // The switch signals a second late: 200 steps before its end.
        ("--by-switch 4 --input 5 --signal-delay 1000", -2400.0),
        ("--by-switch 0 --on-limit", -4000.0),
    ] {
        let (home, _) = homed(words);
        assert!((home - edge).abs() <= 50.0, "{words}: {home} instead of {edge}");
    }
    // It goes to 0 in the end.
    let (home, counter) = homed("--by-switch 0 --input 5 --home-position 250 --return-to-zero");
    assert!((home + 1750.0).abs() <= 50.0 && counter.abs() < 1e-9, "{home}, {counter}");
}
