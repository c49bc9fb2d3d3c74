//! Repair of a BIM2AX with a wrong EEPROM check sum, which accepts only parameters (manual 8.1): the report of
//! `twin drive`, and the restore from a backup.

use crate::desk::Desk;
use crate::drive::{a_module, row};
use crate::shop::{QUICK_BOOT_NS, clock};
use std::fs;
use twin_bim2ax::ModuleAxis;
use twin_bim2ax::emulator::{Eeprom, EmulatorOptions, Event};
use twin_bim2ax::protocol::parameter::{AxisParameter, Parameter};
use twin_interpcnc::emulator as board;

const WRONG: &str = "check sum of the EEPROM is wrong";

#[test]
fn a_module_with_a_wrong_check_sum_is_shown_and_does_not_move() {
    let (running, hand) = a_module();
    hand.does("unlock 1");
    running.module().happen(Event::SpoilEeprom);
    let reset = hand.tries("reset");
    reset.ended(1, "");
    reset.says("the check sum of its EEPROM is wrong");
    assert_eq!(
        row(&hand.does("scan"), 0, "BIM2AX-BOCM")[1..5],
        ["unknown", "unknown", "check", "sum"]
    );
    let status = hand.does("status").stdout;
    assert!(status.contains("phases off") && status.contains("it takes parameters"), "{status}");
    assert!(status.contains("`restore FILE`"), "{status}");
    for action in
        ["get", "get $0A", "unlock 1", "home 1 --yes", "jog 1 100 --yes", "move 1 100 --yes"]
    {
        hand.tries(action)
            .ended(2, WRONG)
            .ended(2, "`restore FILE` gives it the parameters of a backup");
    }
    hand.refuses("backup kept.txt", WRONG);
    assert!(!hand.desk.path("kept.txt").exists());
    hand.does("save");
    // Writing makes the sum right; what is written acts after RESET.
    hand.refuses("set fast-speed-1 0", "it takes 1 to 65535");
    let set = hand.does("set fast-speed-1 700").stdout;
    assert!(set.starts_with("fast-speed-1: ? -> 700\n"), "{set}");
    hand.does("reset");
    assert_eq!(row(&hand.does("get fast-speed-1"), 0, "$0A")[2], "700");
    assert_eq!(running.module().shaft(ModuleAxis::One), 0);
}

/// The EEPROM of a new card holds nothing; what a backup of another one has is in it afterwards.
#[test]
fn a_new_module_gets_the_parameters_of_a_backup() {
    let (other, hand) = a_module();
    hand.does("set soft-limit-minus-2 -100");
    hand.does("backup kept.txt");
    let kept = other.module().eeprom().clone();
    other.stop().expect("it runs");
    let image = hand.desk.path("eeprom");
    fs::write(&image, Eeprom::blank().to_bytes()).expect("written");
    let mut options = EmulatorOptions::new(&hand.desk.path("module"));
    options.module.boot_ns = QUICK_BOOT_NS;
    options.eeprom = Some(image);
    let running = module_of(&options);
    assert!(hand.tries("restore kept.txt").stdout.contains("? -> "));
    let restored = hand.does("restore kept.txt --yes").stdout;
    assert!(restored.contains("written: `reset`"), "{restored}");
    hand.does("reset");
    for number in 0..0x38 {
        let parameter = Parameter::from_number(number).expect("there is one");
        let (found, wanted) = (running.module().eeprom().get(parameter), kept.get(parameter));
        assert_eq!(found, wanted, "{number:02X}");
    }
    let minus = Parameter::Axis(AxisParameter::SoftMinus, ModuleAxis::Two);
    assert_eq!(running.module().eeprom().get(minus).cast_signed(), -100);
    hand.does("unlock 1");
    hand.does("move 1 200 --yes");
    assert_eq!(running.module().shaft(ModuleAxis::One), 200);
}

/// A module whose software runs, also where its watchdog has dropped (8.1).
fn module_of(options: &EmulatorOptions) -> twin_bim2ax::emulator::EmulatedModule {
    let running = twin_bim2ax::emulator::EmulatedModule::start(options, clock());
    let running = running.expect("it starts");
    std::thread::sleep(std::time::Duration::from_millis(400));
    running
}

/// A backup is what is left of a device that has failed.
#[test]
fn a_backup_takes_the_place_of_no_file_unasked() {
    let (_running, hand) = a_module();
    hand.does("backup kept.txt");
    let first = hand.desk.text("kept.txt");
    hand.does("set soft-limit-minus-2 -100");
    hand.refuses("backup kept.txt", "kept.txt: the file exists already and is left unchanged");
    let still = hand.desk.text("kept.txt");
    assert_eq!(still, first);
    hand.does("backup kept.txt --force");
    let second = hand.desk.text("kept.txt");
    assert_ne!(second, first);
}

/// 5.1: homing goes at the start-stop speed, 100 steps/s of 16 µsteps here, whatever the fast one is.
#[test]
fn homing_of_a_bim2ax_is_asked_about_with_the_speed_it_has() {
    let (_running, hand) = a_module();
    hand.does("unlock 1");
    hand.does("set fast-speed-1 2000");
    // 96000 µsteps take 60 s.
    hand.refuses("home 1", "at its start-stop speed of 1600 µsteps/s, 96000 µsteps at most");
    hand.does("set soft-limit-minus-1 -240000");
    hand.does("set soft-limit-plus-1 240000");
    hand.refuses("home 1", "for 310 s at most");
    hand.tries("home 1 --timeout 1 --yes").ended(0, "1600 µsteps at most");
}

/// Bits are given and shown as $1F, and so are those that can be given; a speed below 0 is a number, and not an option.
#[test]
fn what_a_parameter_takes_is_said_as_it_is_written() {
    let (_running, hand) = a_module();
    hand.refuses("set coefficient-1 $12345", "it takes $0000 to $FFFF (bits)");
    for family in
        ["bim2ax --port x move 1 5", "interpcnc --port x move X 5", "smartdrive --port x move 5"]
    {
        Desk::new()
            .twin(&format!("drive {family} --speed -5"))
            .ended(2, "invalid value '-5' for '--speed");
    }
}

#[test]
fn files_of_emulators_are_named_with_their_options() {
    let desk = Desk::new();
    desk.write("mine", "this is mine\n");
    for family in ["interpcnc", "smartdrive", "bim2ax"] {
        for (option, link, why) in [
            ("--eeprom", "link", "mine: this is no "),
            ("--control", "link", "mine: it is in use"),
            ("--link", "mine", "mine"),
        ] {
            let more = if option == "--link" { String::new() } else { format!("{option} mine") };
            let refused = desk.twin(&format!("emulate {family} --link {link} {more}"));
            refused.ended(2, &format!("{option} {why}"));
            assert!(!refused.stderr.contains("SmartDRIVE, addresses"), "{}", refused.stderr);
            assert!(!refused.stderr.contains("memory file link"), "{}", refused.stderr);
            assert!(!refused.stderr.contains("baud, on"), "{}", refused.stderr);
        }
    }
    assert_eq!(desk.text("mine"), "this is mine\n");
    assert!(!desk.path("mine.lock").exists());
}

/// What one stores the other would not know of, and replace.
#[test]
fn two_emulators_do_not_share_a_file() {
    let desk = Desk::new();
    let options = board::EmulatorOptions {
        eeprom: Some(desk.path("kept")),
        ..board::EmulatorOptions::default()
    };
    let first = board::EmulatedBoard::start(&options, clock()).expect("it starts");
    for family in ["interpcnc", "smartdrive", "bim2ax"] {
        desk.twin(&format!("emulate {family} --link other --eeprom kept"))
            .ended(2, "--eeprom kept: another emulator keeps its parameters in it");
    }
    first.stop().expect("it runs");
    board::EmulatedBoard::start(&options, clock()).expect("it is free again");
}
