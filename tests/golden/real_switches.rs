//! Start-up checks before a run on real drives: switches, homing and limits of the devices against the machine file.

use crate::shop::{Shop, mixture};

/// The machine file with more keys in the table of an axis, behind where it hangs on its device.
fn with_keys(shop: &Shop, keys: &[(&str, &str)]) {
    let text = keys.iter().fold(mixture(&shop.desk), |text, (place, lines)| {
        let (before, after) = text.split_once(place).expect("an axis");
        format!("{before}{place}\n{lines}{after}")
    });
    shop.desk.write("mixture.toml", &text);
}

const X: &str = "drive_axis = \"X\"";
const Z: &str = "drive_address = 1";
const U: &str = "drive_axis = \"1\"";

/// Parameters 104 and 106 of a board are the inputs of X's limit switches, 9 and 12 direction and speed of its homing (digest,
/// section 4); bit 1 of a module's coefficient is the direction of homing, bit 4 ignores end switches (5). 320 increments are a mm.
#[test]
fn switches_and_homing_are_held_against_the_machine_file() {
    let shop = Shop::new();
    let wanted = "limit_switches = \"both\"\nhome_direction = \"positive\"";
    with_keys(&shop, &[(X, wanted), (Z, wanted), (U, "home_direction = \"positive\"")]);
    let done = shop.run("short.cnc", "--homed --home=U --yes");
    done.ended(2, "").reports(&[
        "✗ device `board`: axis X: the board knows no limit switch for it; `limit_switches` is \"both\"",
        "set limit-minus-input-x N, where N is its input",
        "set limit-plus-input-x N, where N is its input",
        "or `limit_switches = \"none\"` of axis X in mixture.toml",
        "✗ device `board`: axis X: the board homes it towards -; `home_direction` says +",
        "set it: twin drive interpcnc --port board --address 1 --deadline 2000 set home-direction-x 1",
        "or `home_direction = \"negative\"` of axis X in mixture.toml",
        "! axis Z: its drive does not report which switches it has and where it homes to",
        "✗ device `module`: axis U: the module homes it towards - (coefficient bit 1); `home_direction` says +",
        "set it: twin drive bim2ax --port module --deadline 2000 set coefficient-1",
        "3 start-up checks have failed: nothing has moved",
    ]);
    // What is wanted there is; both are normally open, and their inputs off.
    for set in [
        "set limit-minus-input-x 7",
        "set limit-plus-input-x 8",
        "set home-input-x 5",
        "set home-direction-x 1",
        // 500 mm/s; the axis makes 400.
        "set home-speed-x 160000",
    ] {
        shop.by_hand("interpcnc", "board", set);
    }
    with_keys(&shop, &[(X, wanted), (U, "home_direction = \"negative\"")]);
    let done = shop.run("short.cnc", "--homed --home=U --yes");
    let told = "✗ device `board`: axis X: the board moves it towards its home switch at 500.000 mm/s (160000 steps/s); its max_velocity \
                is 400.000 mm/s";
    done.ended(2, told);
    done.ended(2, "set home-speed-x 128000");
    done.ended(2, "1 start-up check has failed");
    shop.by_hand("interpcnc", "board", "set home-speed-x 4000");
    let done = shop.homed("short.cnc", "");
    done.ended(
        0,
        "✓ axis X: limit switches - at IN7, NO and + at IN8, NO; no software limits in the board",
    );
    // The slow speed of the emulated board is 500 steps/s.
    done.ended(
        0,
        "✓ axis X: homes towards + at 12.500 mm/s, to its switch at IN5, and off it at 1.562 mm/s",
    );
}

/// `Trj_PosMin` and `Trj_PosMax` of 0 are no limits, and a board has none at all. What is left is said, and no check has passed.
/// `App_PosOffset` is what a drive counts at its home: 3200 µsteps are 5 mm.
#[test]
fn what_a_device_does_not_limit_is_told_with_what_is_left() {
    let shop = Shop::new();
    for set in ["set Trj_PosMin 0", "set Trj_PosMax 0", "set App_PosOffset 3200"] {
        shop.by_hand("smartdrive", "bus", set);
    }
    let done = shop.homed("short.cnc", "");
    done.ended(0, "").reports(&[
        "! axis X: the board knows no limit switch for it, and it has no software limits: only twin's own limits, ",
        "! axis Z: the software limits of its drive are off (Trj_PosMin is not below Trj_PosMax); only twin's own limits, -60.0000 … \
         120.0000 mm, keep it from its ends, and no longer than twin runs",
        "set Trj_PosMin -38401",
        "! axis Z: App_PosOffset is 3200 µsteps: where its home switch opens it counts 5.0000 mm, not 0",
        "✓ axis U: the device's software limits are",
    ]);
    assert!(!done.stderr.contains("✓ axis Z: the device's software limits"), "{}", done.stderr);
    // Beyond the limits of the axis no home can be: 128000 µsteps are 200 mm.
    shop.by_hand("smartdrive", "bus", "set App_PosOffset 128000");
    shop.homed("short.cnc", "")
        .ended(2, "it counts 200.0000 mm, not 0; its limits are -60.0000 … 120.0000 mm")
        .ended(2, "set App_PosOffset 0");
}

/// A board that leaves its counter as it is (parameter 128 is 0) says so after homing by hand, too.
#[test]
fn homing_by_hand_looks_at_the_counter() {
    let shop = Shop::new();
    for set in ["set home-input-x 5", "set zero-after-homing 0", "move X 640 --speed 8000 --yes"] {
        shop.by_hand("interpcnc", "board", set);
    }
    let home = "drive interpcnc --port board --deadline 2000 home X --max-stroke 5000 --yes";
    shop.press_home_behind(-320);
    shop.desk
        .twin(home)
        .ended(0, "")
        .says("the board leaves its counters as they are (zero-after-homing is 0)");
    shop.by_hand("interpcnc", "board", "set zero-after-homing 1");
    shop.by_hand("interpcnc", "board", "move X 640 --speed 8000 --yes");
    let done = shop.desk.twin(home);
    done.ended(0, "").says("axis X is home, at 0");
    assert!(!done.stdout.contains("zero-after-homing"), "{}", done.stdout);
}

/// An axis whose drive counts down where it goes up has its switches and its homing the other way round on the board. Ramps of 500
/// rpm/s are 26667 µsteps/s², of which 640 are a mm.
#[test]
fn a_drive_that_turns_the_other_way_and_gentle_ramps_are_told_for_what_they_are() {
    let shop = Shop::new();
    for set in ["set limit-plus-input-x 8", "set home-input-x 5", "set home-direction-x 0"] {
        shop.by_hand("interpcnc", "board", set);
    }
    shop.by_hand("smartdrive", "bus", "set Trj_AccMax 500");
    with_keys(
        &shop,
        &[
            (X, "limit_switches = \"negative\"\nhome_direction = \"positive\""),
            ("port = \"bus\"", "acceleration_rpm_per_s = 500"),
        ],
    );
    let text = shop.desk.text("mixture.toml");
    let (before, after) = text.split_once(X).expect("an axis");
    let after = after.replacen("increments = 3200", "increments = -3200", 1);
    shop.desk.write("mixture.toml", &format!("{before}{X}{after}"));
    let done = shop.run("short.cnc", "--homed --home=U");
    done.ended(2, "").reports(&[
        "! axis X: limit switches - at IN8, NO, and it has no software limits: only twin's own limits",
        "✓ axis X: homes towards + at 15.625 mm/s, to its switch at IN5",
        "! axis Z: the device's acceleration is 41.7 mm/s² at most, and plans use up to 2000.0 mm/s² (max_acceleration)",
        "nothing has moved",
    ]);
    shop.untouched();
}

/// A line that counts from the next power-up on is told, whatever is spoken now.
#[test]
fn a_line_that_a_board_has_stored_is_held_against_the_machine_file() {
    let shop = Shop::new();
    shop.by_hand("interpcnc", "board", "set modbus-speed 9600");
    shop.by_hand("interpcnc", "board", "set modbus-parity 1");
    let done = shop.homed("short.cnc", "");
    done.ended(
        0,
        "! parameter 101 (modbus-speed) is 9600, parameter 102 (modbus-parity) is 1: from the next power-up on it has another line",
    );
    for (parameter, value) in [("modbus-speed", 115_200), ("modbus-parity", 0)] {
        done.ended(0, &format!("set it: twin drive interpcnc --port board --address 1 --deadline 2000 set {parameter} {value}"));
    }
    shop.by_hand("interpcnc", "board", "set modbus-speed 115200");
    shop.by_hand("interpcnc", "board", "set modbus-parity 0");
    let done = shop.homed("short.cnc", "");
    done.ended(0, "parameters: 2 of 2 as the machine file has them");
    assert!(!done.stderr.contains("next power-up"), "{}", done.stderr);
}
