//! `twin run --drives real` on emulators in this process as the real devices, whose own state proves the result.

use crate::desk::{BINARY, Desk, number};
use crate::shop::{SHORT, Shop, a_board, clock, listens, mixture};
use serde_json::Value;
use std::io::Write;
use std::process::{Command, Stdio};
use twin_smartdrive::emulator as bus;

/// What a run on real drives shows is what was predicted, as far as that can be: an axis of speed v is as much farther away as it
/// moves while nobody corrects it longer than planned, the longest gap between samples of its device (and 12 ms at most for what a
/// time stamp is uncertain by: an order to a module); and it is not far nearer either.
#[track_caller]
fn is_as_predicted(report: &Value, axes: &[&str]) {
    let heard = &report["drive_samples"];
    for axis in axes {
        let device = report["predicted_following"]["axes"][axis]["device"].as_str();
        let device = &heard["devices"][device.expect("its name")];
        let gap = number(&device["longest_gap_ms"]) * 1e-3 + 0.012;
        let predicted = number(&report["predicted_following"]["axes"][axis]["max"]);
        let found = number(&report["axis_error"][axis]["drives"]["max"]);
        let speed = number(&report["peak"][axis]["velocity"]["value"]);
        let told = format!("{axis}: {found}, predicted {predicted}");
        assert!(found <= predicted + speed * gap, "{told}");
        assert!(found >= 0.1 * predicted, "{told}");
    }
    let gap = number(&heard["longest_gap_ms"]) * 1e-3 + 0.012;
    let predicted = number(&report["predicted_following"]["tool_mm"]["max"]);
    let found = number(&report["tool_error_mm"]["drives"]["max"]);
    assert!(found <= predicted + 60.0 * gap && found >= 0.1 * predicted, "{found}, {predicted}");
}

#[test]
fn a_mixture_of_all_three_families_runs_to_its_end() {
    let shop = Shop::new();
    shop.by_hand("interpcnc", "board", "move X 3200 --speed 8000 --yes");
    let done = shop.homed("short.cnc", "--report run.json -v");
    done.ended(0, "axis U is home");
    done.ended(0, "").reports(&[
        "✓ connected: SmartDRIVE, address 1, firmware 1.2.0",
        "✓ the ENABLE input is closed",
        "✓ axis Z: the device's software limits are -60.0000 … 120.0000 mm",
        "✓ axis X: homed according to --homed",
        // What counts 0 has perhaps just been switched on.
        "! axis Z: homed according to --homed",
        "take the positions of Y, Z, which count 0, for true",
        "✓ way to the start: ",
        "X to 0.000 mm; tool tip at X 0.000 Y 0.000 Z -40.000 mm",
        "homing axis U",
        "✓ axis U: will be homed first",
        "X board X board 10.000 mm 0.000 mm 100.0 mm/s",
        "U module 1 module 0.000 mm, homes first: 360.0 mm at most",
        // The program: 50 mm/s along √(10² + 5² + 5²) mm, on which U goes 8. Homing: 100 steps/s of 16 µsteps, 320 of them a mm.
        "10.000 mm 0.000 mm 100.0 mm/s 40.8 mm/s",
        "360.0 mm at most 5.0 mm/s 0.000 mm 25.0 mm/s 32.7 mm/s",
    ]);
    let report = shop.desk.read("run.json");
    assert_eq!(report["completed"], true);
    is_as_predicted(&report, &["X", "Y", "Z", "U"]);
    for found in shop.at_rest() {
        // Where the program ends, to an increment.
        assert!(found.expect("it is there").abs() < 1.01 / 320.0, "{found:?}");
    }
}

#[test]
fn every_check_that_fails_is_told_with_what_was_found_and_what_is_wanted() {
    let shop = Shop::new();
    shop.by_hand("interpcnc", "board", "set zero-after-homing 0");
    shop.board.happen(twin_interpcnc::emulator::Event::Enable(false)).expect("it runs");
    shop.by_hand("smartdrive", "bus", "set Trj_VelMax 500");
    shop.by_hand("smartdrive", "bus", "set Trj_PosMax 90000");
    let text = mixture(&shop.desk);
    shop.desk.write("mixture.toml", &text.replace("\"1.2.0\"", "\"1.3.0\""));
    let done = shop.run("short.cnc", "--homed --yes");
    done.ended(2, "").reports(&[
        "✗ device `board`: InterpCNC at board, address 1: the ENABLE input is open; closed is wanted",
        "(zero-after-homing) is 0; 1 is wanted",
        "✗ device `bus`: address 1: the firmware is 1.2.0; 1.3.0 is wanted",
        "✗ device `bus`: axis Z: parameter 30 at address 1 (Trj_VelMax) is 500 rpm; at least 2880 rpm is wanted",
        "✗ device `bus`: axis Z: the device's software limits are -60.0000 … 140.6250 mm; at least as tight as -60.0000 … 120.0000 mm is wanted",
        "✗ device `module`: axis U: not homed; `twin drive bim2ax --port module --deadline 2000 home 1` homes it",
        "set it: twin drive smartdrive --port bus --address 1 --deadline 2000 set Trj_VelMax 2880",
        "then: twin drive smartdrive --port bus --address 1 --deadline 2000 save",
        "of axis Z in mixture.toml",
        "set it: twin drive smartdrive --port bus --address 1 --deadline 2000 set Trj_PosMax 76801",
        "or `position_min_mm` and `position_max_mm` of axis Z in mixture.toml",
        "help: release the emergency stop",
        "start-up checks have failed: nothing has moved",
    ]);
    // What makes them count is said once for the drive, and once for the module.
    for (device, word) in [("smartdrive", "save"), ("bim2ax", "reset")] {
        let saving = |line: &&str| {
            line.contains(&format!("then:   twin drive {device}"))
                && line.contains(&format!(" {word} "))
        };
        let said = done.stderr.lines().filter(saving).count();
        assert_eq!(said, usize::from(device == "smartdrive"), "{}", done.stderr);
    }
    // What is said can be copied: the parameters are right then.
    shop.copy_commands(&done);
    let done = shop.run("short.cnc", "--homed --yes");
    done.ended(2, "or `firmware = \"1.2.0\"` of [[drives]] \"bus\" in mixture.toml");
    assert!(
        ["Trj_VelMax", "140.6250", "(zero-after-homing)"]
            .iter()
            .all(|gone| !done.stderr.contains(gone)),
        "{}",
        done.stderr
    );
    shop.untouched();
}

/// The ramps of segments are the board's own: they are looked at with all else, before anything moves.
#[test]
fn a_board_with_other_ramps_than_its_segments_moves_nothing() {
    let shop = Shop::new();
    let of_board = "kind = \"interpcnc\"\n";
    let buffered = format!("{of_board}following = \"buffered\"\nstart_stop_hz = 2000\n");
    let text = mixture(&shop.desk);
    shop.desk.write("mixture.toml", &text.replace(of_board, &buffered));
    shop.by_hand("interpcnc", "board", "set zero-after-homing 0");
    let done = shop.homed("short.cnc", "");
    done.ended(2, "").reports(&[
        "✗ device `board`: parameter 4 (default-acceleration) is 50 × 1000 steps/s²; 2000 × 1000 steps/s² is wanted",
        "✗ device `board`: parameter 5 (default-start-stop) is 200 steps/s; 2000 steps/s is wanted",
        "or `acceleration_khz_per_s = 50` of [[drives]] \"board\" in mixture.toml",
        "or `start_stop_hz = 200` of [[drives]] \"board\" in mixture.toml",
        "start-up checks have failed: nothing has moved",
    ]);
    shop.copy_commands(&done);
    shop.homed("short.cnc", "").ended(0, "✓ parameters: 4 of 4 as the machine file has them");
    shop.at_rest();
}

/// 500 rpm of 3200 µsteps are 26667/s, of which a drive keeps some to catch up with; the value that is named passes, whatever
/// it is, and one that is a little larger does not.
#[test]
fn the_key_of_the_machine_file_that_would_match_is_named_with_its_value() {
    let shop = Shop::new();
    shop.by_hand("smartdrive", "bus", "set Trj_VelMax 500");
    let done = shop.homed("short.cnc", "");
    let flat = done.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
    let value =
        flat.split("or `max_velocity_mm_per_s = ").nth(1).and_then(|rest| rest.split('`').next());
    let value: f64 = value.and_then(|text| text.parse().ok()).expect("a velocity");
    assert!((20.0..26_666.7 / 640.0).contains(&value), "{value}");
    let text = mixture(&shop.desk);
    for (velocity, passes) in [(value, true), (value + 0.1, false)] {
        let (before, of_z) = text.split_once("name = \"Z\"").expect("an axis");
        let old =
            of_z.lines().find(|line| line.starts_with("max_velocity_mm_per_s")).expect("a limit");
        let of_z = of_z.replacen(old, &format!("max_velocity_mm_per_s = {velocity:.3}"), 1);
        shop.desk.write("mixture.toml", &format!("{before}name = \"Z\"{of_z}"));
        let done = shop.homed("short.cnc", "");
        assert_eq!(
            !done.stderr.contains("(Trj_VelMax) is 500"),
            passes,
            "{velocity}: {}",
            done.stderr
        );
    }
}

#[test]
fn ports_that_others_have_are_named() {
    let shop = Shop::new();
    let other = mixture(&shop.desk).replace("port = \"module\"", "port = \"none\"");
    shop.desk.write("other.toml", &other);
    shop.disturbed("-INT", |_| {
        let run = "run short.cnc -m other.toml --drives real --homed --yes";
        shop.desk.twin(run).ended(2, "").reports(&[
            "✗ device `board`: board, address 1: opening the port: another program has the port",
            "✗ device `bus`: bus, address 1: opening the port: another program has the port",
            "✗ device `module`: none: opening the port: No such file or directory",
        ]);
    })
    .ended(2, "stopped by the user");
}

#[test]
fn a_limit_that_is_tighter_than_the_program_is_told() {
    let shop = Shop::new();
    shop.by_hand("smartdrive", "bus", "set Trj_PosMax 1280");
    shop.homed("short.cnc", "")
        .ended(2, "are -60.0000 … 2.0000 mm; the program goes from 0.0000 to 5.0000 mm");
    shop.untouched();
}

#[test]
fn what_is_not_known_to_be_homed_does_not_run() {
    let shop = Shop::new();
    let done = shop.run("short.cnc", "--yes --home=U");
    done.ended(2, "").reports(&[
        "axis X: whether it is homed is unknown, as its device does not store that; if it is, add --homed",
        "`twin drive interpcnc --port board --address 1 --deadline 2000 home Y --max-stroke 268800` homes it",
        "`twin drive smartdrive --port bus --address 1 --deadline 2000 home` homes it",
        "3 start-up checks have failed",
    ]);
    shop.run("short.cnc", "--yes --home=W").ended(2, "no axis `W` has a drive; X, Y, Z, U have");
    // One that has been off has lost its position, whatever the user says.
    shop.by_hand("smartdrive", "bus", "stop --now");
    shop.homed("short.cnc", "").ended(2, "axis Z: not homed: its device has been locked or off");
    shop.untouched();
}

/// There is no switch within 100 steps: the board shows that, and nobody's word is better. Without an input no switch can come.
#[test]
fn an_axis_whose_homing_has_failed_is_not_homed_by_word() {
    let shop = Shop::new();
    shop.by_hand("interpcnc", "board", "set home-input-x 7");
    shop.desk
        .twin("drive interpcnc --port board --deadline 2000 home X --max-stroke 100 --yes")
        .ended(2, "homing has failed, axis X");
    shop.run("short.cnc", "--homed --home=U --yes")
        .ended(2, "axis X: not homed: the board says that homing has failed");
}

/// 640 steps/s at 320 steps per mm, by the parameter that homing by hand tells, too.
#[test]
fn how_fast_a_board_homes_is_told_before_it_does() {
    let shop = Shop::new();
    shop.by_hand("interpcnc", "board", "set home-input-x 7");
    shop.by_hand("interpcnc", "board", "set home-speed-x 640");
    let done = shop.run("short.cnc", "--homed --home=X,U");
    done.ended(2, "nothing has moved");
    let said = format!("{}{}", done.stdout, done.stderr);
    let of_x = said.lines().find(|line| line.contains("board X")).expect("X is shown");
    assert!(of_x.contains("2.0 mm/s") && !said.contains("unknown"), "{said}");
    shop.untouched();
}

#[test]
fn an_axis_without_a_home_switch_is_not_begun_to_be_homed() {
    let shop = Shop::new();
    shop.run("short.cnc", "--homed --home=X,U --yes")
        .ended(2, "axis X needs homing, and the board has no home switch for it")
        .ended(2, "set home-input-x N, where N is its input");
    shop.untouched();
}

#[test]
fn devices_that_are_not_there_are_named() {
    let shop = Shop::new();
    // Switched off: nobody answers any more.
    drop(shop.bus.borrow_mut().take());
    let text = mixture(&shop.desk);
    let text = text.replace("port = \"module\"\n", "").replace("station = 1", "station = 2");
    shop.desk.write("mixture.toml", &text);
    shop.homed("short.cnc", "--report run.json")
        .ended(2, "✗ device `bus`: bus, address 1: opening the port")
        .ended(2, "✗ mixture.toml: device `module` needs a `port`: its serial port")
        .ended(2, "2 start-up checks have failed: nothing has moved");
    let report = shop.desk.read("run.json");
    assert_eq!((&report["completed"], &report["executed_s"]), (&false.into(), &0.0.into()));
    assert_eq!(shop.at_rest(), [Some(0.0), Some(0.0), None, Some(0.0)]);
}

#[test]
fn a_station_that_does_not_answer_is_named() {
    let shop = Shop::new();
    let text = mixture(&shop.desk);
    let text = text.replace("kind = \"interpcnc\"", "kind = \"interpcnc\"\nstation = 9");
    shop.desk.write(
        "mixture.toml",
        &text.replacen("answer_deadline_ms = 2000", "answer_deadline_ms = 300", 1),
    );
    shop.homed("short.cnc", "")
        .ended(2, "✗ device `board`: board, address 9: reading parameter")
        .ended(2, "no answer within 533 ms")
        .ended(2, "help: is the device powered? Are A and B of the line swapped");
    shop.untouched();
}

#[test]
fn nothing_moves_without_a_yes() {
    let shop = Shop::new();
    let done = shop.run("short.cnc", "--homed --home=U");
    done.ended(
        2,
        "nothing has moved, as there is no terminal to ask at; --yes moves without asking",
    );
    // A terminal at which somebody says no.
    let line = format!("{BINARY} {}", Shop::real("short.cnc", "--homed --home=U"));
    let mut child = Command::new("script")
        .args(["-qec", &line, "/dev/null"])
        .current_dir(shop.desk.path(""))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("script (util-linux) is there");
    child.stdin.take().expect("piped").write_all(b"n\n").expect("it listens");
    let output = child.wait_with_output().expect("it ends");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("[y/N]") && said.contains("nothing has moved"), "{said}");
    for option in ["--yes", "--homed", "--home"] {
        shop.desk
            .twin(&format!("run short.cnc -m mixture.toml {option}"))
            .ended(2, &format!("{option} has no effect without --drives real"));
    }
    shop.untouched();
}

/// A module does not limit the way to its cam: the run does, at one and a half times 1.2 times the 12 mm between the limits.
#[test]
fn a_home_that_is_nowhere_is_given_up() {
    let shop = Shop::new();
    shop.hide_the_cam();
    for action in
        ["set soft-limit-plus-1 1921", "set soft-limit-minus-1 -1921", "reset", "unlock 1"]
    {
        shop.by_hand("bim2ax", "module", action);
    }
    let text = mixture(&shop.desk);
    let wide = "position_min_mm = -100.0\nposition_max_mm = 100.0\nmax_velocity_mm_per_s = 100.0";
    assert!(text.contains(wide));
    let narrow = wide.replace("100.0\nposition", "6.0\nposition").replace("100.0\nmax", "6.0\nmax");
    shop.desk.write("mixture.toml", &text.replace(wide, &narrow));
    shop.desk.write("within.cnc", &SHORT.replace("U8", "U4"));
    let run = Shop::real("within.cnc", "--homed --home=U --yes");
    shop.desk.twin(&run).ended(2, "homing axis U: it has gone 21.6 mm and not found its home");
    let [x, y, z, u] = shop.at_rest();
    assert_eq!([x, y, z], [Some(0.0); 3]);
    // 320 µsteps per mm; it brakes on its ramp behind that.
    let u = u.expect("it is there");
    assert!(u < -21.6 && u > -30.0, "{u} mm");
}

/// Two or three axes on devices of one family.
pub(crate) fn alone(desk: &Desk, family: &str, axes: &[(&str, &str)]) {
    let text = desk.text("machine.toml");
    let device = format!("kind = \"{family}\"\nport = \"device\"\nanswer_deadline_ms = 2000");
    let text = text.replace("kind = \"interpcnc\"\nport = \"/dev/ttyUSB0\"", &device);
    let text = axes
        .iter()
        .fold(text, |text, (axis, place)| text.replace(&format!("drive_axis = \"{axis}\""), place));
    desk.write("mixture.toml", &text);
    desk.write("short.cnc", "% short\nN10 G1 X10 Y5 Z-35 F5 E50 E-50\nN20 G1 X0 Y0 Z-40\n");
}

#[test]
fn a_board_alone_runs_to_its_end() {
    let desk = Desk::new();
    alone(&desk, "interpcnc", &[]);
    let running = a_board(&desk.path("device"));
    desk.twin("drive interpcnc --port device --deadline 2000 unlock").ended(0, "");
    let run = Shop::real("short.cnc", "--homed --yes --report run.json");
    desk.twin(&run).ended(0, "");
    is_as_predicted(&desk.read("run.json"), &["X", "Y", "Z"]);
    let board = running.stop().expect("it runs");
    assert!(board.status().moving().is_empty());
    assert!(board.counters().iter().all(|counter| counter.abs() <= 1));
}

/// What the program switches is told before it is asked whether it may, how late it was afterwards.
#[test]
fn outputs_are_named_before_anything_moves() {
    let desk = Desk::new();
    alone(&desk, "interpcnc", &[]);
    let outputs = "
[[m_functions]]
m = 3
outputs_on = [1, 2]
outputs_off = [5]

[[m_functions]]
m = 4
outputs_off = [1]

[[cams]]
axis = \"Y\"
master = \"X\"
cam = \"cam.toml\"

[[tappet_outputs]]
axis = \"Y\"
group = 7
output = 4

[[tappet_outputs]]
axis = \"Y\"
group = 8
output = 6
";
    let machine = desk.text("mixture.toml");
    desk.write("mixture.toml", &(machine + outputs));
    desk.write(
        "cam.toml",
        "master = { min = 0, max = 100, unit = \"mm\" }
slave = { min = 0, max = 50, unit = \"mm\" }
elements = [{ master = 0, slave = 0 }, { master = 100, slave = 50 }]
tappets = [{ group = 7, master = 5, passage = \"every\", action = \"invert\" }]
",
    );
    let program = "% switches\nN10 G1 X10 F5 E50 E-50\nN20 M3\nN30 G1 X0\n";
    desk.write("switches.cnc", program);
    let running = a_board(&desk.path("device"));
    desk.twin("drive interpcnc --port device --deadline 2000 unlock").ended(0, "");
    let of_program =
        "M3 of the program switches on outputs 1, 2 and off output 5 of device `board`";
    let of_tappet = "output 4 of device `board` follows tappet 7 of Y";
    let asked = desk.twin(&Shop::real("switches.cnc", "--homed"));
    asked.ended(2, of_program);
    asked.ended(2, of_tappet);
    // M4 and tappet 8 are not in it.
    assert!(!asked.stderr.contains("M4") && !asked.stderr.contains("output 6"), "{}", asked.stderr);
    let done = desk.twin(&Shop::real("switches.cnc", "--homed --yes --report run.json"));
    done.ended(0, of_program);
    // Three by M3; tappet 7 is passed there and back.
    done.says("device `board`: outputs switched 5 times, confirmed ");
    let late = &desk.read("run.json")["switched_outputs"]["board"];
    assert_eq!(late["count"], 5);
    let [mean, latest] = ["mean_late_ms", "max_late_ms"].map(|key| number(&late[key]));
    assert!(0.0 < mean && mean <= latest, "{late}");
    running.stop().expect("it runs");
}

#[test]
fn a_bus_alone_runs_to_its_end() {
    let desk = Desk::new();
    let places =
        [("X", "drive_address = 1"), ("Y", "drive_address = 2"), ("Z", "drive_address = 3")];
    alone(&desk, "smartdrive", &places);
    let devices =
        [1, 2, 3].map(|address| bus::DeviceOptions { address, ..bus::DeviceOptions::default() });
    let options = bus::EmulatorOptions {
        devices: devices.to_vec(),
        link: Some(desk.path("device")),
        ..bus::EmulatorOptions::default()
    };
    let running = bus::EmulatedBus::start(&options, clock()).expect("it starts");
    listens(&desk, "device");
    // 320 and 640 µsteps per mm; X 400 mm/s and 1.2 times that are 2880 rpm, as Z has.
    for (address, low, high) in
        [("1", -16_000, 208_000), ("2", -80_000, 144_000), ("3", -38_400, 76_800)]
    {
        let drive = format!("drive smartdrive --port device --deadline 2000 --address {address}");
        let [low, high] = [("PosMin", low), ("PosMax", high)]
            .map(|(name, value)| format!("set Trj_{name} {value}"));
        let fast = ["set Trj_VelMax 2880", "set Trj_AccMax 30000", "set Trj_DecMax 30000"];
        for action in fast.into_iter().chain([&*low, &*high, "unlock"]) {
            desk.twin(&format!("{drive} {action}")).ended(0, "");
        }
    }
    let run = Shop::real("short.cnc", "--homed --yes --report run.json");
    desk.twin(&run).ended(0, "");
    is_as_predicted(&desk.read("run.json"), &["X", "Y", "Z"]);
    let devices = running.stop().expect("it runs");
    assert!(devices.iter().all(|drive| drive.counter().abs() <= 1 && drive.motion().1 == 0.0));
}
