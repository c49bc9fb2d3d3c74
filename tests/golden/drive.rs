//! `twin drive` against emulators in this process, whose own state proves each action.

use crate::desk::{Desk, Done};
use crate::shop::{QUICK_BOOT_NS, clock, started};
use twin_bim2ax::emulator as module;
use twin_bim2ax::protocol::parameter::{AxisParameter, Parameter};
use twin_bim2ax::{Contact, ModuleAxis};
use twin_interpcnc::BoardAxis;
use twin_interpcnc::emulator as board;
use twin_smartdrive::Mode;
use twin_smartdrive::emulator as bus;

/// `twin drive FAMILY --port PATH OPTIONS ACTION`.
pub(crate) struct Hand {
    pub(crate) desk: Desk,
    words: String,
}

impl Hand {
    /// With a deadline that an emulator keeps while other tests and builds run.
    pub(crate) fn new(family: &str, port: &str, options: &str) -> Self {
        Self { desk: Desk::new(), words: format!("drive {family} --port '{port}' {options}") }
    }

    pub(crate) fn tries(&self, action: &str) -> Done {
        self.desk.twin(&format!("{} {action}", self.words))
    }

    /// The command itself, to be started.
    pub(crate) fn command(&self, action: &str) -> std::process::Command {
        self.desk.command(&format!("{} {action}", self.words))
    }

    /// It is done.
    #[track_caller]
    pub(crate) fn does(&self, action: &str) -> Done {
        let done = self.tries(action);
        done.ended(0, "");
        done
    }

    /// It is refused, with these words.
    #[track_caller]
    pub(crate) fn refuses(&self, action: &str, words: &str) {
        let done = self.tries(action);
        done.ended(2, words);
        assert_eq!(done.stdout, "");
    }

    /// Interrupted a second after it has said what it does.
    fn interrupted(&self, sign: &str, action: &str) -> Done {
        self.desk.interrupted("-INT", sign, &format!("{} {action}", self.words))
    }
}

/// The row of a table that has this word in this column, in words.
#[track_caller]
pub(crate) fn row<'a>(done: &'a Done, column: usize, word: &str) -> Vec<&'a str> {
    let mut rows = done.stdout.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
    let found = rows.find(|row| row.get(column) == Some(&word));
    found.unwrap_or_else(|| panic!("no {word} in column {column} of\n{}", done.stdout))
}

/// A board whose home switch of X is pressed from 1500 steps behind the start on, input 5.
pub(crate) fn a_board(address: u8) -> (board::EmulatedBoard, Hand) {
    let cam =
        board::Cam { input: 5, axis: BoardAxis::X, from: -3000, to: -1500, normally_closed: false };
    let options = board::EmulatorOptions {
        board: board::BoardOptions { address, ..board::BoardOptions::default() },
        bench: board::Bench { cams: vec![cam], encoder: None },
        ..board::EmulatorOptions::default()
    };
    let running = board::EmulatedBoard::start(&options, clock()).expect("it starts");
    let port = running.path().to_str().expect("a path").to_owned();
    let address = address.to_string();
    (running, Hand::new("interpcnc", &port, &format!("--station {address} --deadline 1500")))
}

#[test]
fn an_interpcnc_board_is_found_unlocked_and_moved() {
    let (running, hand) = a_board(4);
    let port = running.path().to_str().expect("a path");
    let scan = Hand::new("interpcnc", port, "--deadline 300");
    let found = scan.does("scan --stations 3-4");
    assert_eq!(row(&found, 0, "4")[1..3], ["115200", "baud,"]);
    scan.tries("scan --stations 7").ended(1, "no address answers");
    assert!(hand.does("status").stdout.contains("locked"));
    // A locked board takes moves and does nothing: nobody is asked.
    hand.refuses("move X 100 --yes", "the board is locked");
    let refused = hand.tries("move X 100 --yes");
    assert!(!refused.stderr.contains("move axis X"), "{}", refused.stderr);
    hand.refuses("home X", "the board is locked");
    assert_eq!(hand.does("unlock").stdout, "unlocked\n");
    hand.refuses(
        "move X 4000",
        "move axis X from 0 to 4000 steps at 1000 steps/s: nothing has moved",
    );
    let moved = hand.does("move X 4000 --speed 8000 --yes");
    assert!(moved.stderr.contains("move axis X from 0 to 4000 steps at 8000 steps/s"));
    hand.refuses("jog X -1500", "from 4000 to 2500");
    hand.does("jog X -1500 --speed 8000 --yes");
    hand.does("--yes jog B 700 --speed 8000");
    assert_eq!(row(&hand.does("status"), 0, "X"), ["X", "2500", "at", "rest"]);
    let board = running.stop().expect("it runs");
    assert_eq!(board.counters(), [2500, 0, 0, 0, 700]);
    assert!(!board.status().locked());
}

#[test]
fn an_interpcnc_board_homes_by_the_parameters_that_were_set() {
    let (running, hand) = a_board(1);
    hand.does("unlock");
    hand.refuses("set home-imput-x 5", "is `home-input-x` meant?");
    // There are 32 inputs, and 0 is none.
    let allowed = "(parameter 29) = 99 is impossible: it takes 0 to 32 (input, 0 = none)";
    hand.refuses("set home-input-x 99", allowed);
    hand.refuses("set home-direction-x 2", "it takes 0 to 1 (1 = positive)");
    hand.refuses("set 40000 1", "there is no parameter 40000: they are 0 to 383");
    hand.refuses("set home-speed-x -1", "it takes 0 to ");
    hand.does("set home-input-x 0");
    hand.refuses("home X --yes", "axis X has no home switch: `set home-input-x N`");
    hand.does("set home-input-x 5").says("parameter 29 (home-input-x): 0 -> 5");
    // Number 12 is EE_ORIGINE_SPEED_RAPIDE.
    for setting in
        ["12 4000", "home-direction-x 0", "home-acceleration-x 100", "home-start-stop 200"]
    {
        hand.does(&format!("set {setting}"));
    }
    for setting in ["home-slow-speed 500", "home-polarity 0", "zero-after-homing 1"] {
        hand.does(&format!("set {setting}"));
    }
    assert_eq!(row(&hand.does("get home-speed-x"), 0, "12")[..3], ["12", "home-speed-x", "4000"]);
    let all = hand.does("get");
    assert_eq!(row(&all, 1, "home-input-x")[2], "5");
    assert_eq!(row(&all, 1, "modbus-address")[2], "1");
    let said = "axis X from 0 towards - until input 5 says so, 5000 steps at most, at 4000 steps/s";
    hand.refuses("home X --max-stroke 5000", said);
    let homed = hand.does("home X --max-stroke 5000 --yes");
    assert_eq!(homed.stdout, "axis X is home, at 0\n");
    let board = running.stop().expect("it runs");
    assert!((board.mechanical(BoardAxis::X) + 1500.0).abs() <= 1.0);
    assert_eq!(board.counters(), [0; 5]);
}

#[test]
fn inputs_and_outputs_of_an_interpcnc_board() {
    let (running, hand) = a_board(1);
    running.happen(board::Event::Input { number: 17, level: true }).expect("it runs");
    let inputs = hand.does("inputs");
    assert_eq!((row(&inputs, 0, "17")[1], row(&inputs, 0, "16")[1]), ("on", "off"));
    hand.refuses("outputs 3=on", "the board is locked");
    hand.does("unlock");
    hand.refuses("outputs 33=on", "there are 1 to 32");
    hand.refuses("outputs 3=maybe", "neither on nor off");
    hand.does("outputs 3=on 32=on 4=on");
    let outputs = hand.does("outputs 4=off");
    assert_eq!((row(&outputs, 0, "3")[1], row(&outputs, 0, "4")[1]), ("on", "off"));
    hand.does("stop");
    let board = running.stop().expect("it runs");
    assert_eq!(board.outputs(), 1 << 2 | 1 << 31);
    let (running, hand) = a_board(1);
    hand.does("unlock");
    hand.does("stop --now");
    assert!(running.stop().expect("it runs").status().locked());
}

#[test]
fn ctrl_c_brings_the_axes_of_an_interpcnc_board_to_rest() {
    let (running, hand) = a_board(1);
    hand.does("unlock");
    hand.interrupted("move axis Y", "move Y 1000000 --speed 5000 --yes")
        .ended(2, "stopped by Ctrl-C; the axes are at rest");
    let board = running.stop().expect("it runs");
    assert!(board.status().moving().is_empty() && !board.status().locked());
    let stands = board.counters()[1];
    assert!((1..1_000_000).contains(&stands), "{stands}");
}

#[test]
fn a_port_that_is_not_there_is_named_with_station_and_command() {
    Hand::new("interpcnc", "no-such-port", "--station 9")
        .refuses("status", "no-such-port, address 9: opening the port");
    Hand::new("smartdrive", "no-such-port", "--address 9")
        .refuses("status", "no-such-port, address 9: opening the port");
    Hand::new("bim2ax", "no-such-file", "").refuses("status", "no-such-file: opening the port");
}

/// Drives at addresses 1 and 3, the home switch of the first on DIR, 1000 to 3000 µsteps behind the start.
pub(crate) fn a_bus(flash: Vec<Vec<u8>>) -> (bus::EmulatedBus, Hand) {
    let first = bus::DeviceOptions {
        cams: vec![bus::Cam { input: bus::Input::Dir, from: -3000.0, to: -1000.0 }],
        homing: bus::HomingOptions { input: bus::Input::Dir, ..bus::HomingOptions::default() },
        ..bus::DeviceOptions::default()
    };
    let third = bus::DeviceOptions { address: 3, ..bus::DeviceOptions::default() };
    let devices = vec![first, third];
    let options = bus::EmulatorOptions { devices, flash, ..bus::EmulatorOptions::default() };
    let running = bus::EmulatedBus::start(&options, clock()).expect("it starts");
    let port = running.path().to_str().expect("a path").to_owned();
    let hand = Hand::new("smartdrive", &port, "--deadline 1000");
    // Their firmware starts within 300 ms: until then nobody answers.
    assert!((0..50).any(|_| hand.tries("status").status == Some(0)), "nobody answers");
    (running, hand)
}

#[test]
fn smartdrives_are_found_unlocked_moved_and_homed() {
    let (running, hand) = a_bus(Vec::new());
    let port = running.path().to_str().expect("a path");
    let found = Hand::new("smartdrive", port, "--deadline 300").does("scan --addresses 1-3");
    assert_eq!(
        (row(&found, 0, "1")[1..3].to_vec(), found.stdout.lines().count()),
        (vec!["0,", "off"], 6)
    );
    hand.refuses("move 3200 --yes", "it is in mode 0, off: `unlock` first");
    assert_eq!(hand.does("unlock").stdout, "obeys the bus, at 0\n");
    assert_eq!(hand.does("unlock").stdout, "obeys the bus already, at 0\n");
    hand.refuses("move 3200", "from 0 to 3200 µsteps at 500 rpm: nothing has moved");
    hand.does("move 3200 --yes");
    hand.does("jog -700 --speed 300 --acceleration 1000 --yes");
    let status = hand.does("status");
    assert_eq!(row(&status, 0, "1")[1..], ["3,", "obeys", "the", "bus", "2500", "at", "rest"]);
    hand.refuses("home", "from 2500 to its switch, which is at 0 µsteps, at 120 rpm");
    assert_eq!(hand.does("home --yes").stdout, "home, at 0\n");
    let devices = running.stop().expect("it runs");
    assert_eq!((devices[0].mode(), devices[0].counter()), (Mode::Remote, 0));
    assert!((devices[0].mechanical() + 1000.0).abs() <= 1.0);
    assert_eq!((devices[1].mode(), devices[1].counter()), (Mode::Off, 0));
}

#[test]
fn parameters_of_a_smartdrive_are_set_and_saved() {
    let (running, hand) = a_bus(Vec::new());
    hand.refuses("set Trj_VelMx 300", "is `Trj_VelMax` meant?");
    hand.refuses("set 1 300", "there is no parameter 1");
    hand.refuses(
        "set Trj_VelMax 0",
        "Trj_VelMax (30) = 0 is impossible: it takes 1 to 32767 (rpm)",
    );
    hand.refuses(
        "set Mot_StepDivisor 17",
        "(44) = 17 is impossible: it takes 1, 2, 4, 8, 16, 32, 64",
    );
    hand.refuses("set 40000 1", "there is no parameter 40000: they are some of 0 to ");
    hand.refuses("set PID 7", "PID (12) is read-only");
    hand.does("set trj_velmax 300").says("Trj_VelMax (30): 500 -> 300 rpm");
    hand.does("set 26 -100000");
    // Number, name, value, saved, factory, unit.
    let shown = hand.does("get 30");
    assert_eq!(row(&shown, 0, "30"), ["30", "Trj_VelMax", "300", "500", "500", "rpm"]);
    hand.does("save");
    let all = hand.does("get");
    assert_eq!(row(&all, 1, "Trj_PosMin")[2..5], ["-100000", "-100000", "0"]);
    assert_eq!(row(&all, 2, "Alm_Supply")[3], "24");
    let devices = running.stop().expect("it runs");
    let (running, hand) = a_bus(devices.iter().map(bus::Device::flash).collect());
    assert_eq!(row(&hand.does("get Trj_VelMax"), 0, "30")[2..5], ["300", "300", "500"]);
    drop(running);
}

#[test]
fn inputs_and_outputs_of_a_smartdrive() {
    let (running, hand) = a_bus(Vec::new());
    let event = bus::Event::Input { input: bus::Input::LimP, level: true };
    running.control(event.to(0)).expect("it runs");
    let inputs = hand.does("inputs");
    assert_eq!((row(&inputs, 0, "LIMP")[1], row(&inputs, 0, "LIMN")[1]), ("on", "off"));
    // At rest, whatever has stopped it.
    let status = hand.does("status").stdout;
    assert!(status.contains("at rest, on LIMP") && !status.contains("LIMN"), "{status}");
    hand.does("outputs LED=on BRK=on");
    let outputs = hand.does("outputs brk=off");
    assert_eq!((row(&outputs, 0, "LED")[1], row(&outputs, 0, "BRK")[1]), ("on", "off"));
    hand.refuses("outputs GO=on", "there are RDY, BRK and LED");
    let devices = running.stop().expect("it runs");
    assert_eq!(devices[0].outputs() & 0b110, 0b100);
}

#[test]
fn ctrl_c_and_stop_bring_a_smartdrive_to_rest() {
    let (running, hand) = a_bus(Vec::new());
    hand.does("unlock");
    hand.interrupted("move the axis", "move 1000000 --speed 120 --yes")
        .ended(2, "stopped by Ctrl-C; the axes are at rest");
    hand.does("stop");
    let found = hand.does("status");
    let stands: i32 = row(&found, 0, "1")[5].parse().expect("a position");
    assert!((1..1_000_000).contains(&stands), "{stands}");
    assert_eq!(hand.does("stop --now").stdout, "off\n");
    let devices = running.stop().expect("it runs");
    assert_eq!((devices[0].mode(), devices[0].motion().1), (Mode::Off, 0.0));
}

/// A module on a memory file, both cams from −900 to −400 µsteps, a + end switch at 8000.
pub(crate) fn a_module() -> (module::EmulatedModule, Hand) {
    let hand = Hand::new("bim2ax", "module", "--deadline 1500");
    let mut options = module::EmulatorOptions::new(&hand.desk.path("module"));
    options.module.boot_ns = QUICK_BOOT_NS;
    for bench in &mut options.surroundings.benches {
        bench.cam = Some(Contact::between(-900, -400, true));
        bench.plus = Some(Contact::above(8000, true));
    }
    (started(&options), hand)
}

#[test]
fn a_bim2ax_is_found_unlocked_moved_and_homed() {
    let (running, hand) = a_module();
    let found = hand.does("scan");
    assert_eq!(row(&found, 0, "BIM2AX-BOCM")[1..], ["15", "2000", "mA", "1,", "2"]);
    assert!(hand.does("status").stdout.contains("homing not done"));
    hand.does("unlock 1 2");
    // A quarter of the rating.
    assert_eq!(running.module().current_ma(ModuleAxis::Two), 500);
    // 1000 steps/s of 16 µsteps.
    hand.refuses(
        "move 1 4000",
        "move axis 1 from 0 to 4000 µsteps at 16000 µsteps/s: nothing has moved",
    );
    hand.does("move 1 4000 --yes");
    hand.does("jog 1 -1500 --speed 500 --yes");
    hand.does("jog 2 -300 --yes");
    assert_eq!(row(&hand.does("status"), 0, "1")[1], "2500");
    assert_eq!(running.module().shaft(ModuleAxis::One), 2500);
    assert_eq!(running.module().shaft(ModuleAxis::Two), -300);
    hand.refuses("home 1", "axis 1 from 2500 towards - to its cam");
    assert_eq!(hand.does("home 1 --yes").stdout, "axis 1 is home, at 0\n");
    assert_eq!(row(&hand.does("status"), 0, "1")[1..3], ["0", "home"]);
    assert_eq!(running.module().shaft(ModuleAxis::One), -400);
}

#[test]
fn parameters_of_a_bim2ax_are_stored_and_act_after_a_reset() {
    let (running, hand) = a_module();
    hand.refuses("set fast-sped-1 500", "is `fast-speed-1` meant?");
    hand.refuses("set $42 1", "there is no parameter 66: they are 0 to 65, 98 and 99");
    hand.refuses(
        "set motor-current-1 2001",
        "($04) = 2001 is impossible: it takes 60 to 2000 (mA)",
    );
    hand.refuses("set drive-mode-1 7", "is impossible: it takes 0, 1, 2, 4, 16, ");
    hand.refuses("set software-version 3", "parameter cannot be written");
    let changed = hand.does("set fast-speed-1 500");
    assert_eq!(changed.stdout, "fast-speed-1: 1000 -> 500 steps/s\nit acts after `reset`\n");
    let changed = hand.does("set soft-limit-minus-2 -100");
    assert_eq!(changed.stdout, "soft-limit-minus-2: -4194303 -> -100 µsteps\n");
    assert_eq!(row(&hand.does("get $0A"), 0, "$0A"), ["$0A", "fast-speed-1", "500", "steps/s"]);
    let all = hand.does("get");
    assert_eq!(row(&all, 1, "reference-position-10-2")[0], "$29");
    assert_eq!(row(&all, 1, "current-rating")[2..], ["2000", "mA"]);
    let stored = |parameter, axis| {
        running.module().eeprom().get(Parameter::Axis(parameter, axis)).cast_signed()
    };
    assert_eq!(stored(AxisParameter::FastSpeed, ModuleAxis::One), 500);
    assert_eq!(stored(AxisParameter::SoftMinus, ModuleAxis::Two), -100);
    let before = running.module().starts();
    hand.does("reset");
    assert_eq!(running.module().starts(), before + 1);
}

#[test]
fn inputs_and_ends_of_a_bim2ax() {
    let (running, hand) = a_module();
    // The + end switch counts, its contact closes: coefficient bits 0, 7 and 14.
    hand.does("set coefficient-1 $4081");
    hand.does("reset");
    hand.does("unlock 1");
    hand.refuses("move 1 20000 --yes", "on the + end switch");
    let stands = running.module().shaft(ModuleAxis::One);
    // From 16000 µsteps/s to the start-stop speed of 1600 at 32000 µsteps/s²: 3960 µsteps further.
    assert!((11_955..=11_965).contains(&stands), "{stands}");
    let inputs = hand.does("inputs");
    assert_eq!(row(&inputs, 0, "1")[1..], ["on", "off", "off"]);
}

#[test]
fn ctrl_c_and_stop_bring_a_bim2ax_to_rest() {
    let (running, hand) = a_module();
    hand.does("unlock 1");
    hand.interrupted("move axis 1", "move 1 -1000000 --speed 200 --yes")
        .ended(2, "stopped by Ctrl-C; the axes are at rest");
    hand.does("stop");
    let stands = running.module().shaft(ModuleAxis::One);
    assert!((-999_999..0).contains(&stands), "{stands}");
    assert_eq!(hand.does("stop --now").stdout, format!("at rest at {stands}, 0\n"));
    assert!(running.module().velocity(ModuleAxis::One).abs() < f64::EPSILON);
}

/// Out to a file and back; what differs is shown and nothing is written without a yes.
#[test]
fn parameters_go_to_a_file_and_back() {
    let (board, of_board) = a_board(1);
    let (bus, of_bus) = a_bus(Vec::new());
    let (module, of_module) = a_module();
    for (hand, name, set, back, shown) in [
        (&of_board, "12", "4000", "get home-speed-x", "parameter 12"),
        (&of_bus, "Trj_VelMax", "300", "get Trj_VelMax", "(Trj_VelMax): 300 -> 500 rpm"),
        (&of_module, "soft-limit-minus-2", "-100", "get soft-limit-minus-2", ": -100 -> -4194303"),
    ] {
        hand.does("backup kept.txt").says("parameters of");
        hand.tries("backup kept.XML")
            .ended(2, "kept.XML: a backup is text, not XML; name it kept.txt");
        let before = hand.does(back).stdout;
        assert!(hand.does("restore kept.txt --yes").stdout.contains("0 to change"));
        hand.does(&format!("set {name} {set}"));
        hand.tries("restore kept.txt")
            .ended(2, "write 1 parameters of")
            .ended(2, "nothing has been written, as there is no terminal to ask at")
            .says(shown);
        hand.does("restore kept.txt --yes").says("written, and read back");
        assert_eq!(hand.does(back).stdout, before);
        std::fs::write(hand.desk.path("wrong.txt"), "nonsense\n").expect("written");
        hand.tries("restore wrong.txt --yes").ended(2, "wrong.txt:1");
        hand.tries("restore none.txt --yes").ended(2, "none.txt: cannot be read");
    }
    drop((board, bus, module));
}

/// The switch of X is pressed from 1500 to 3000 steps behind the start: backwards onto it, and slowly off it again, is home; that
/// is seen as late as a look at the switch takes, a few steps of 200 a second with the time of this computer.
#[test]
fn an_axis_is_homed_by_a_switch_that_the_drive_only_shows() {
    let (running, hand) = a_board(1);
    hand.refuses("home X Y --by-switch 0 --yes", "homes one axis at a time");
    hand.refuses("home X --by-switch 3 --yes", "the modes are 0, 1, 2, 4, 5 and 6");
    hand.refuses("home X --by-switch 2 --yes", "--index-input N names its input");
    hand.refuses(
        "home X --by-switch 0 --index-input 6 --yes",
        "--index-input has no effect in mode 0",
    );
    hand.refuses("home X --by-switch 4 --ignore-limits --yes", "limit switches");
    hand.refuses("home X --input 5", "--by-switch");
    // Nothing is announced of what cannot be.
    let none = hand.tries("home X --by-switch 0 --input 40 --yes");
    none.ended(2, "--input 40: the drive shows 32 inputs, 1 to 32");
    assert!(!none.stderr.contains("home axis X from"), "{}", none.stderr);
    hand.tries("home X --by-switch 0 --fast -200 --yes").ended(2, "'-200' for '--fast");
    let ask = "home X --by-switch 0 --input 5 --fast 1000 --slow 200 --max-way 5000";
    hand.refuses(ask, "home axis X from 0 towards - until input 5 says so, 5000 steps at most");
    hand.does(&format!("{ask} --yes")).says("axis X is home, at ");
    let counter = hand.does("status");
    let counter: f64 = row(&counter, 0, "X")[1].parse().expect("a position");
    let board = running.stop().expect("it runs");
    let mechanical = board.mechanical(BoardAxis::X);
    assert!(board.status().moving().is_empty() && mechanical > -1500.0, "{mechanical}");
    // 0 is where the switch opened, at most a quarter of a second late.
    let home = mechanical - counter;
    assert!((home + 1500.0).abs() <= 50.0, "{mechanical}, {counter}");

    // One that never comes.
    let (running, hand) = a_board(1);
    hand.tries("home X --by-switch 0 --input 7 --fast 4000 --max-way 800 --yes").ended(2, "");
    let board = running.stop().expect("it runs");
    assert!(board.status().moving().is_empty());
    assert!((board.mechanical(BoardAxis::X) + 800.0).abs() <= 1.0);
}

/// Folders, files, sockets and the ports of other families are named.
#[test]
fn what_is_no_port_is_named_with_what_is_wanted() {
    let (module, of_module) = a_module();
    let (board, _hand) = a_board(1);
    let desk = &of_module.desk;
    desk.write("note.txt", "mine");
    let _socket = std::os::unix::net::UnixListener::bind(desk.path("socket")).expect("a socket");
    std::os::unix::fs::symlink("/dev/pts/none", desk.path("dead")).expect("a link");
    let path = |name: &str| desk.path(name).to_str().expect("a path").to_owned();
    let memory = path("module");
    let terminal = board.path().to_str().expect("a path").to_owned();
    for (family, port, said) in [
        ("interpcnc", path(""), "it is a folder; wanted is a serial port"),
        ("smartdrive", path(""), "it is a folder; wanted is a serial port"),
        ("bim2ax", path(""), "it is a folder; wanted is the memory file"),
        ("interpcnc", path("note.txt"), "it is a file of 4 bytes; wanted is a serial port"),
        ("bim2ax", path("note.txt"), "it is a file of 4 bytes; wanted is the memory file"),
        ("smartdrive", path("socket"), "it is a socket"),
        ("bim2ax", path("socket"), "it is a socket"),
        (
            "smartdrive",
            memory.clone(),
            "as the memory of an emulated BIM2AX is; wanted is a serial",
        ),
        ("bim2ax", terminal, "it is a serial port or another device; wanted is the memory file"),
        (
            "interpcnc",
            "/dev/null".to_owned(),
            "it is a device, but no terminal; wanted is a serial",
        ),
        ("interpcnc", path("dead"), "the link leads to /dev/pts/none, which does not exist"),
    ] {
        Hand::new(family, &port, "").refuses("status", said);
    }
    drop((module, board));
}

/// Homing that takes too long is ended by a stop on the ramp, and reported with the position of the axis.
#[test]
fn homing_that_does_not_end_in_time_is_stopped() {
    // Drive 3 has no home switch.
    let (running, hand) = a_bus(Vec::new());
    hand.does("--address 3 unlock");
    let ask = "--address 3 home --timeout 1";
    hand.refuses(ask, "at 120 rpm, for 1 s at most, in the direction that the drive is set to");
    hand.tries(&format!("{ask} --yes"))
        .ended(2, "not finished within 1000 ms; the axes are at rest, at -")
        .ended(2, "it needs a longer --timeout");
    let devices = running.stop().expect("it runs");
    assert!(devices[1].counter() < 0 && devices[1].motion().1 == 0.0);
    // The cam of axis 2 is far away.
    let (running, hand) = a_module();
    let mut surroundings = *running.module().surroundings();
    surroundings.benches[1].cam = Some(Contact::below(-1_000_000, true));
    running.module().happen(module::Event::Surroundings(Box::new(surroundings)));
    hand.does("unlock 2");
    hand.refuses("home 2 --timeout 1", "towards - to its cam");
    hand.refuses("home 2 --timeout 1", "for 1 s at most");
    hand.tries("home 2 --timeout 1 --yes")
        .ended(2, "(homing): not finished within 1000 ms; the axes are at rest, at 1: 0, 2: -");
    assert!(running.module().velocity(ModuleAxis::Two).abs() < f64::EPSILON);
    assert!(running.module().shaft(ModuleAxis::Two) < 0);
}

/// After an alarm, a brown-out or an emergency stop: what to do next, in `status` and with what fails.
#[test]
fn what_to_do_next_is_said() {
    let (board, hand) = a_board(1);
    assert!(hand.does("status").stdout.contains("next: `unlock`, then `home`"));
    hand.tries("move X 10 --yes").ended(2, "help: `unlock`, then `home`");
    hand.does("unlock");
    assert!(!hand.does("status").stdout.contains("next:"));
    board.happen(board::Event::Enable(false)).expect("it runs");
    let open = |_| hand.does("status").stdout.contains("next: release the emergency stop");
    assert!((0..50).any(open), "it is not said");
    hand.tries("unlock").ended(2, "release the emergency stop");

    let (bus, hand) = a_bus(Vec::new());
    assert!(
        hand.does("status")
            .stdout
            .contains("next: `unlock`, which makes the position 0, then `home`")
    );
    hand.does("unlock");
    let alarms = twin_smartdrive::Alarms::OVERTEMPERATURE;
    bus.control(bus::Event::Fault { alarms, present: true }.to(0)).expect("it runs");
    let status = hand.does("status");
    status.says("next: remove the cause of the alarm, then `unlock`");
    bus.control(bus::Event::Fault { alarms, present: false }.to(0)).expect("it runs");
    bus.control(bus::Event::BrownOut { off_ns: 1_000_000 }.to(0)).expect("it runs");
    let off = |_| hand.tries("status").stdout.contains("next: `unlock`");
    assert!((0..50).any(off), "it is not said");

    let (module, hand) = a_module();
    let status = hand.does("status");
    assert!(
        status.stdout.contains("next for axis 1: `home` the axis")
            || status.stdout.contains("next for axis 1: `unlock` the axis"),
        "{}",
        status.stdout
    );
    drop((board, module));
}

/// Only actions that ask have a --yes, also before the action.
#[test]
fn only_what_asks_takes_a_yes() {
    for (family, asks) in [
        ("interpcnc", ["home", "jog", "move", "restore"]),
        ("smartdrive", ["home", "jog", "move", "restore"]),
        ("bim2ax", ["home", "jog", "move", "restore"]),
    ] {
        let hand = Hand::new(family, "nowhere", "");
        for action in asks {
            assert!(hand.does(&format!("{action} --help")).stdout.contains("--yes"), "{action}");
        }
        for action in ["scan", "status", "get", "set", "stop", "inputs", "backup"] {
            assert!(!hand.does(&format!("{action} --help")).stdout.contains("--yes"), "{action}");
        }
        hand.tries("--yes status").ended(2, "opening the port");
    }
}

/// An action that a family does not need or have is refused in words.
#[test]
fn what_a_family_does_not_have_is_said() {
    let none = |family| Hand::new(family, "nowhere", "");
    for (family, word) in [("interpcnc", "an InterpCNC keeps"), ("bim2ax", "a BIM2AX keeps")] {
        let said = none(family).does("save").stdout;
        assert!(said.contains(word) && said.contains("when they are set"), "{said}");
    }
    none("bim2ax").refuses("outputs", "a BIM2AX has no outputs");
    none("bim2ax").refuses("outputs 1=on", "a BIM2AX has no outputs");
    // Wrong words come with those there are.
    none("interpcnc").refuses("jog Q 5", "the axes are X, Y, Z, A, B");
    none("bim2ax").refuses("move 3 5", "the axes are 1 and 2");
    none("smartdrive").refuses("scan --addresses 0-40", "FIRST-LAST within 1-31");
    none("smartdrive").refuses("--address 32 status", "1..=31");
    for (family, word) in [("interpcnc", "sttaus"), ("smartdrive", "sttaus"), ("bim2ax", "sttaus")]
    {
        none(family).refuses(word, "status");
    }
}
