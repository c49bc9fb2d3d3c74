//! Messages of `twin drive` and `twin emulate` about mistaken input.

use crate::desk::Desk;
use crate::drive::{Hand, a_board, a_bus, row};
use crate::shop::clock;
use twin_smartdrive::emulator as bus;

/// Number, name, value, saved, factory, unit: the working value is that of the file already, what is saved is not.
#[test]
fn a_restore_saves_what_is_not_saved_though_nothing_has_to_be_changed() {
    let (_running, hand) = a_bus(Vec::new());
    let copies = |saved: [&str; 2]| {
        assert_eq!(row(&hand.does("get Trj_VelMax"), 0, "30")[2..4], saved);
    };
    hand.does("set Trj_VelMax 300");
    hand.does("backup kept.txt");
    hand.does("restore kept.txt --yes").says("0 to change");
    copies(["300", "500"]);
    hand.tries("restore kept.txt --save")
        .ended(2, "save the parameters, of which the drive has not saved 1");
    copies(["300", "500"]);
    let saved = hand.does("restore kept.txt --yes --save");
    saved.says("saved, and read back");
    copies(["300", "300"]);
    hand.does("restore kept.txt --yes --save").says("the drive keeps all of them already");
}

/// There are 384 parameters.
#[test]
fn what_a_file_of_parameters_does_not_have_is_told() {
    let (_running, hand) = a_board(1);
    hand.does("backup whole.txt");
    let whole = hand.desk.text("whole.txt");
    let part: Vec<_> = whole.lines().filter(|line| !line.starts_with("0 12 ")).collect();
    assert_eq!(part.len() + 1, whole.lines().count(), "{whole}");
    hand.desk.write("part.txt", &part.join("\n"));
    let said = hand.does("restore part.txt --yes").stdout;
    assert!(said.contains("0 to change, 383 as they are"), "{said}");
    assert!(said.contains("parameter 12") && said.contains("is not in the file"), "{said}");
    let whole = hand.does("restore whole.txt --yes").stdout;
    assert!(!whole.contains("not in the file"), "{whole}");
}

#[test]
fn speeds_that_no_board_has_are_refused_and_others_say_how_to_go_on() {
    let (_running, hand) = a_board(1);
    hand.refuses(
        "set modbus-speed 12345",
        "= 12345 is not a speed of the board: it takes 4800, 9600",
    );
    let said = hand.does("set modbus-speed 9600").stdout;
    assert!(said.contains("switched off and on") && said.contains("--baud 9600"), "{said}");
    let said = hand.does("set modbus-address 7").stdout;
    assert!(said.contains("--address 7"), "{said}");
}

/// A file that is not the memory of a module is refused before anything is made next to it.
#[test]
fn a_file_that_is_no_memory_is_left_alone_and_a_module_is_not_looked_for_at_serial_ports() {
    let hand = Hand::new("bim2ax", "b.txt", "");
    hand.desk.write("b.txt", &"x".repeat(5000));
    hand.refuses("status", "it is a file of 5000 bytes");
    assert!(!hand.desk.path("b.txt.master").exists());
    let missing = Hand::new("bim2ax", "none", "").tries("status");
    missing.ended(2, "`twin emulate bim2ax --link PATH` makes");
    assert!(!missing.stderr.contains("ttyUSB"), "{}", missing.stderr);
    Hand::new("interpcnc", "none", "").tries("status").ended(2, "/dev/ttyUSB*");
}

#[test]
fn two_drives_of_a_line_have_two_addresses() {
    Desk::new()
        .twin("emulate smartdrive --link bus --address 1 --address 1")
        .ended(2, "--address 1 is given twice");
}

/// The drives of the bus are 1 and 3.
#[test]
fn a_drive_does_not_get_the_address_of_another() {
    let (_running, hand) = a_bus(Vec::new());
    hand.refuses("set ATB_Address 3", "another drive of the line answers at address 3 already");
    assert_eq!(row(&hand.does("get ATB_Address"), 1, "ATB_Address")[2], "1");
    let said = hand.does("set ATB_Address 2").stdout;
    assert!(said.contains("spoken to with --address 2"), "{said}");
    hand.does("--address 2 status");
    hand.does("--address 2 set ATB_Address 2");
}

/// Two at one address answer at the same time, and spoil what the other says.
#[test]
fn an_address_that_two_drives_have_is_shown() {
    let devices =
        [2, 2].map(|address| bus::DeviceOptions { address, ..bus::DeviceOptions::default() });
    let single = bus::DeviceOptions { address: 3, ..bus::DeviceOptions::default() };
    let devices = devices.into_iter().chain([single]).collect();
    let options = bus::EmulatorOptions { devices, ..bus::EmulatorOptions::default() };
    let running = bus::EmulatedBus::start(&options, clock()).expect("it starts");
    let port = running.path().to_str().expect("a path").to_owned();
    let hand = Hand::new("smartdrive", &port, "--deadline 500");
    let answers = |_| hand.tries("--address 3 status").status == Some(0);
    assert!((0..50).any(answers), "nobody answers");
    // Their messages differ, as their positions usually do.
    let alarms = twin_smartdrive::Alarms::OVERTEMPERATURE;
    running.control(bus::Event::Fault { alarms, present: true }.to(0)).expect("it runs");
    let found = hand.does("scan --addresses 2-3");
    found.says("address 2: answers garble each other: two devices");
    assert_eq!(row(&found, 0, "3")[1], "0,");
}

/// 1000 is what was set; INPUT 1 is GO.
#[test]
fn refused_targets_and_unknown_switches_name_where_to_look() {
    let (_running, hand) = a_bus(Vec::new());
    hand.does("set Trj_PosMin -1000");
    hand.does("set Trj_PosMax 1000");
    hand.does("unlock");
    // Nobody is asked about what cannot be.
    let beyond =
        "it cannot go to 5000 µsteps: Trj_PosMax (parameter 28) is 1000 µsteps (nothing was sent)";
    for way in ["move 5000", "move 5000 --yes", "jog 5000 --yes"] {
        hand.refuses(way, beyond);
    }
    hand.refuses("move -1001", "Trj_PosMin (parameter 26) is -1000 µsteps");
    hand.tries("home --by-switch 0 --yes").ended(2, "`--input N` says it");
    // No farther than the drive goes: 1000 µsteps, which end at a limit that is reported before.
    hand.tries("home --by-switch 0 --input 1 --max-way 1001 --yes")
        .ended(2, "--max-way 1001: the drive's own limit is at -1000 µsteps");
    hand.tries("home --by-switch 0 --input 1 --yes")
        .ended(2, "1000 µsteps at most (the drive's own limit is at -1000 µsteps)")
        .ended(2, "the home switch has not come within 1000 from 0; looked for at input 1")
        .ended(2, "the axis is at rest, at -1000 µsteps");
}

/// The switch at input 7 never comes: the axis is where its way ends.
#[test]
fn failed_homing_reports_the_position() {
    let (_running, hand) = a_board(1);
    hand.tries("home X --by-switch 0 --input 7 --max-way 300 --yes")
        .ended(2, "homing axis X: the home switch has not come within 300 from 0")
        .ended(2, "looked for at input 7, which is off: not pressed")
        .ended(2, "the axis is at rest, at -300 steps");
}
