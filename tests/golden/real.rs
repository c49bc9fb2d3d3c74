//! `twin run --drives real` on emulators in this process as the real devices, whose own state says what has become of it.

use crate::process::{Desk, Done, number};
use serde_json::Value;
use std::cell::RefCell;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;
use twin::clock::Clock;
use twin_drives::Control;
use twin_drives::bim2ax::emulator as module;
use twin_drives::bim2ax::{Contact, ModuleAxis};
use twin_drives::interpcnc::BoardAxis;
use twin_drives::interpcnc::emulator as board;
use twin_drives::smartdrive::emulator as bus;

fn clock() -> impl Fn() -> i64 + Send + Sync {
    let clock = Clock::start();
    move || clock.now_ns()
}

/// There and back, 0.7 s. All axes are at 0 where it begins.
const SHORT: &str = "% short\nN10 G1 X10 Y5 Z-35 U8 F50 E500 E-500\nN20 G1 X0 Y0 Z-40 U0\n";
/// Half a minute.
const LONG: &str = "% long\nN10 G1 X200 Y100 Z20 U60 F15 E300 E-300\nN20 G1 X0 Y0 Z-40 U0\n";

/// X and Y on a board, Z on a bus, U on a module; all of them have plenty of time to answer beside other tests.
fn mixture(desk: &Desk) -> String {
    let text = std::fs::read_to_string(desk.path("machine.toml")).expect("readable");
    let devices = "name = \"board\"\nkind = \"interpcnc\"\nport = \"board\"\nanswer_deadline_ms = 2000\n\n\
                   [[drives]]\nname = \"bus\"\nkind = \"smartdrive\"\nport = \"bus\"\nanswer_deadline_ms = 2000\n\
                   firmware = \"1.2.0\"\n\n\
                   [[drives]]\nname = \"module\"\nkind = \"bim2ax\"\nport = \"module\"\nanswer_deadline_ms = 2000";
    let u = "\n[[axes]]\nname = \"U\"\nkind = \"linear\"\nposition_min_mm = -100.0\nposition_max_mm = 100.0\n\
             max_velocity_mm_per_s = 100.0\nmax_acceleration_mm_per_s2 = 1000.0\ndrive = \"module\"\n\
             drive_axis = \"1\"\nincrements = 3200\nper_mm = 10.0\n";
    let old = "name = \"board\"\nkind = \"interpcnc\"\nport = \"/dev/ttyUSB0\"";
    let of_z = "drive = \"board\"\ndrive_axis = \"Z\"";
    assert!(text.contains(old) && text.contains(of_z));
    // A computer that is busy lets axes fall behind.
    let text = text.replace("max_following_error_mm = 0.5", "max_following_error_mm = 100.0");
    text.replace(old, devices).replace(of_z, "drive = \"bus\"\ndrive_address = 1") + u
}

/// Three devices that somebody has commissioned for the mixture, and its machine file.
struct Shop {
    desk: Desk,
    board: board::EmulatedBoard,
    bus: RefCell<Option<bus::EmulatedBus>>,
    module: module::EmulatedModule,
}

/// What `twin drive` sets on a drive of the bus and on a module.
const BUS: [&str; 5] = [
    "Trj_VelMax 2880",
    "Trj_AccMax 30000",
    "Trj_DecMax 30000",
    "Trj_PosMin -38400",
    "Trj_PosMax 76800",
];
const MODULE: [&str; 4] = [
    "acceleration-1 65535",
    "fast-speed-1 2400",
    "soft-limit-plus-1 32001",
    "soft-limit-minus-1 -32001",
];

fn a_board(link: &Path) -> board::EmulatedBoard {
    let options =
        board::EmulatorOptions { link: Some(link.to_owned()), ..board::EmulatorOptions::default() };
    board::EmulatedBoard::start(&options, clock()).expect("it starts")
}

fn a_bus(link: &Path) -> bus::EmulatedBus {
    let devices = vec![bus::DeviceOptions::default()];
    let link = Some(link.to_owned());
    let options = bus::EmulatorOptions { devices, link, ..bus::EmulatorOptions::default() };
    bus::EmulatedBus::start(&options, clock()).expect("it starts")
}

/// Its cam is 400 to 900 µsteps behind the start.
fn a_module(path: &Path) -> module::EmulatedModule {
    let mut options = module::EmulatorOptions::new(path);
    options.module.boot_ns = crate::drive::QUICK_BOOT_NS;
    for bench in &mut options.surroundings.benches {
        bench.cam = Some(Contact::between(-900, -400, true));
    }
    crate::drive::started(&options)
}

/// The firmware of drives starts within 300 ms: until then nobody answers.
fn listens(desk: &Desk, port: &str) {
    let status = ["drive", "smartdrive", "--port", port, "--deadline", "300", "status"];
    assert!((0..50).any(|_| desk.twin(&status).status == Some(0)), "nobody answers");
}

impl Shop {
    fn new() -> Self {
        let desk = Desk::new();
        desk.write("mixture.toml", &mixture(&desk));
        desk.write("short.cnc", SHORT);
        desk.write("long.cnc", LONG);
        let board = a_board(&desk.path("board"));
        let bus = RefCell::new(Some(a_bus(&desk.path("bus"))));
        let module = a_module(&desk.path("module"));
        let shop = Self { desk, board, bus, module };
        shop.by_hand("interpcnc", "board", "unlock");
        listens(&shop.desk, "bus");
        shop.commission_bus();
        for set in MODULE {
            shop.by_hand("bim2ax", "module", &format!("set {set}"));
        }
        shop.by_hand("bim2ax", "module", "reset");
        shop.by_hand("bim2ax", "module", "unlock 1");
        shop
    }

    /// Waits until the program has X on its way.
    fn under_way(&self) {
        let begun = |_| {
            std::thread::sleep(Duration::from_millis(10));
            self.board.look().expect("it runs").position(BoardAxis::X) > 5.0 * 320.0
        };
        assert!((0..6000).any(begun), "X does not move");
    }

    /// A cam that is never reached.
    fn hide_the_cam(&self) {
        let mut module = self.module.module();
        let mut surroundings = *module.surroundings();
        for bench in &mut surroundings.benches {
            bench.cam = Some(Contact::between(-4_000_000, -3_900_000, true));
        }
        module.set_surroundings(&surroundings);
    }

    fn commission_bus(&self) {
        for set in BUS {
            self.by_hand("smartdrive", "bus", &format!("set {set}"));
        }
        self.by_hand("smartdrive", "bus", "unlock");
    }

    /// Carries out every command of the start-up checks that sets something.
    #[track_caller]
    fn copy_commands(&self, done: &Done) {
        let said = ["set it: twin ", "then:   twin "];
        let commands = done.stderr.lines().filter_map(|line| {
            said.iter().find_map(|start| line.trim().strip_prefix(start)).map(|rest| {
                let command = rest.split("   (").next().unwrap_or(rest);
                command.split_whitespace().collect::<Vec<_>>()
            })
        });
        let commands: Vec<_> = commands.collect();
        assert!(commands.len() >= 3, "{}", done.stderr);
        for command in commands {
            self.desk.twin(&command).ended(0, "");
        }
    }

    #[track_caller]
    fn by_hand(&self, family: &str, port: &str, action: &str) {
        let words = ["drive", family, "--port", port, "--deadline", "2000"];
        let action = action.split(' ');
        let words: Vec<_> = words.into_iter().chain(action).collect();
        self.desk.twin(&words).ended(0, "");
    }

    /// Arguments of `twin run PROGRAM --drives real …`.
    fn arguments<'a>(program: &'a str, more: &'a str) -> Vec<&'a str> {
        let run = ["run", program, "-m", "mixture.toml", "--drives", "real"];
        run.into_iter().chain(more.split_whitespace()).collect()
    }

    fn run(&self, program: &str, more: &str) -> Done {
        self.desk.twin(&Self::arguments(program, more))
    }

    /// Homed by hand, but for the module, which has to be homed in any case.
    fn homed(&self, program: &str, more: &str) -> Done {
        self.run(program, &format!("--homed --home=U --yes {more}"))
    }

    /// Ends all devices; where their axes stand, in mm, and that they rest.
    #[track_caller]
    fn at_rest(self) -> [Option<f64>; 4] {
        let u = {
            let module = self.module.module();
            assert!(module.velocity(ModuleAxis::One).abs() < f64::EPSILON, "U moves");
            module.position(ModuleAxis::One) / 320.0
        };
        let board = self.board.stop().expect("it runs");
        assert!(board.status().moving().is_empty(), "the board moves");
        let [x, y] = [BoardAxis::X, BoardAxis::Y].map(|axis| board.position(axis) / 320.0);
        let z = self.bus.into_inner().map(|bus| {
            let devices = bus.stop().expect("it runs");
            assert!(devices[0].motion().1.abs() < f64::EPSILON, "Z moves");
            f64::from(devices[0].counter()) / 640.0
        });
        [Some(x), Some(y), z, Some(u)]
    }

    /// Nothing has moved.
    #[track_caller]
    fn untouched(self) {
        assert_eq!(self.at_rest(), [Some(0.0), Some(0.0), Some(0.0), Some(0.0)]);
    }
}

/// What a run on real drives shows is what was predicted, as far as that can be: an axis of speed v is as much farther away as it
/// moves while nobody corrects it longer than planned, the longest gap between samples (and 12 ms at most for what a time stamp
/// is uncertain by: an order to a module); and it is not far nearer either.
#[track_caller]
fn is_as_predicted(report: &Value, axes: &[&str]) {
    let gap = number(&report["drive_samples"]["longest_gap_ms"]) * 1e-3 + 0.012;
    for axis in axes {
        let predicted = number(&report["predicted_following"]["axes"][axis]["max"]);
        let found = number(&report["axis_error"][axis]["drives"]["max"]);
        let speed = number(&report["peak"][axis]["velocity"]["value"]);
        let told = format!("{axis}: {found}, predicted {predicted}");
        assert!(found <= predicted + speed * gap, "{told}");
        assert!(found >= 0.1 * predicted, "{told}");
    }
    let predicted = number(&report["predicted_following"]["tool_mm"]["max"]);
    let found = number(&report["tool_error_mm"]["drives"]["max"]);
    assert!(found <= predicted + 60.0 * gap && found >= 0.1 * predicted, "{found}, {predicted}");
}

#[test]
fn a_mixture_of_all_three_families_runs_to_its_end() {
    let shop = Shop::new();
    shop.by_hand("interpcnc", "board", "move X 3200 --speed 8000 --yes");
    let done = shop.homed("short.cnc", "--report run.json");
    done.ended(0, "axis U is home");
    for said in [
        "✓ connected: SmartDRIVE, address 1, firmware 1.2.0",
        "✓ the ENABLE input is closed",
        "✓ axis Z: the device's software limits are -60.0000 … 120.0000 mm",
        "✓ axis X: homed, as --homed says",
        "✓ axis U: will be homed first",
        "X board X board 10.000 mm 0.000 mm 100.0 mm/s",
        "U module 1 module 0.000 mm, homes first: 360.0 mm at most",
        // The program: 50 mm/s along √(10² + 5² + 5²) mm, on which U goes 8. Homing: 100 steps/s of 16 µsteps, 320 of them a mm.
        "10.000 mm 0.000 mm 100.0 mm/s 40.8 mm/s",
        "360.0 mm at most 5.0 mm/s 0.000 mm 25.0 mm/s 32.7 mm/s",
        // A deadline of 2 s, and twice that until no late answer can come any more.
        "one lost answer of device `board` takes up to 6000 ms; at the program's 40.8 mm/s (line",
        "axis X is then up to 244.95 mm off, more than its max_following_error of 100.00 mm",
    ] {
        done.ended(0, said);
    }
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
    shop.board.set_enable(false).expect("it runs");
    shop.by_hand("smartdrive", "bus", "set Trj_VelMax 500");
    shop.by_hand("smartdrive", "bus", "set Trj_PosMax 90000");
    let text = mixture(&shop.desk);
    shop.desk.write("mixture.toml", &text.replace("\"1.2.0\"", "\"1.3.0\""));
    let done = shop.run("short.cnc", "--homed --yes");
    for said in [
        "✗ device `board`: InterpCNC at board, address 1: the ENABLE input is open; closed is wanted",
        "(EE_ORIGINE_RESET_POS_SOFT) is 0; 1 is wanted",
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
    ] {
        done.ended(2, said);
    }
    // What is said can be copied: the parameters are right then.
    shop.copy_commands(&done);
    let done = shop.run("short.cnc", "--homed --yes");
    done.ended(2, "or `firmware = \"1.2.0\"` of [[drives]] \"bus\" in mixture.toml");
    assert!(
        ["Trj_VelMax", "140.6250", "EE_ORIGINE"].iter().all(|gone| !done.stderr.contains(gone)),
        "{}",
        done.stderr
    );
    shop.untouched();
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
    let run = Shop::arguments("long.cnc", "--homed --home=U --yes");
    let done = shop.desk.meanwhile("-INT", "axis U is home", &run, || {
        let run = ["run", "short.cnc", "-m", "other.toml", "--drives", "real", "--homed", "--yes"];
        let other = shop.desk.twin(&run);
        other.ended(
            2,
            "✗ device `board`: board, address 1: opening the port: another program has the port",
        );
        other.ended(
            2,
            "✗ device `bus`: bus, address 1: opening the port: another program has the port",
        );
        other.ended(2, "✗ device `module`: none: opening the port: No such file or directory");
    });
    done.ended(2, "stopped by the user");
}

#[test]
fn a_limit_that_is_tighter_than_the_program_is_told() {
    let shop = Shop::new();
    shop.by_hand("smartdrive", "bus", "set Trj_PosMax 1280");
    let done = shop.homed("short.cnc", "");
    done.ended(2, "are -60.0000 … 2.0000 mm; the program goes from 0.0000 to 5.0000 mm");
    shop.untouched();
}

#[test]
fn what_is_not_known_to_be_homed_does_not_run() {
    let shop = Shop::new();
    let done = shop.run("short.cnc", "--yes --home=U");
    for said in [
        "axis X: not known to be homed: its device does not keep that; if it is, --homed says so",
        "`twin drive interpcnc --port board --address 1 --deadline 2000 home Y --max-stroke 268800` homes it",
        "`twin drive smartdrive --port bus --address 1 --deadline 2000 home` homes it",
        "3 start-up checks have failed",
    ] {
        done.ended(2, said);
    }
    shop.run("short.cnc", "--yes --home=W").ended(2, "no axis `W` has a drive; X, Y, Z, U have");
    // One that has been off has lost its position, whatever the user says.
    shop.by_hand("smartdrive", "bus", "stop --now");
    let done = shop.homed("short.cnc", "");
    done.ended(2, "axis Z: not homed: its device has been locked or off");
    shop.untouched();
}

/// There is no switch within 100 steps: the board shows that, and nobody's word is better. Without an input no switch can come.
#[test]
fn an_axis_whose_homing_has_failed_is_not_homed_by_word() {
    let shop = Shop::new();
    shop.by_hand("interpcnc", "board", "set home-input-x 7");
    let board = ["drive", "interpcnc", "--port", "board", "--deadline", "2000"];
    let home = [&board[..], &["home", "X", "--max-stroke", "100", "--yes"]].concat();
    shop.desk.twin(&home).ended(2, "homing has failed, axis X");
    let done = shop.run("short.cnc", "--homed --home=U --yes");
    done.ended(2, "axis X: not homed: the board says that homing has failed");
}

#[test]
fn an_axis_without_a_home_switch_is_not_begun_to_be_homed() {
    let shop = Shop::new();
    let done = shop.run("short.cnc", "--homed --home=X,U --yes");
    done.ended(2, "axis X: it is to be homed, and the board knows no home switch for it");
    done.ended(2, "set home-input-x N, where N is its input");
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
    let done = shop.homed("short.cnc", "--report run.json");
    done.ended(2, "✗ device `bus`: bus, address 1: opening the port");
    done.ended(2, "✗ mixture.toml: device `module` has no `port`, which says where it is");
    done.ended(2, "2 start-up checks have failed: nothing has moved");
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
    let done = shop.homed("short.cnc", "");
    done.ended(2, "✗ device `board`: board, address 9: reading parameter");
    done.ended(2, "no answer within 300 ms");
    done.ended(2, "help: is the device powered? Are A and B of the line swapped");
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
    let twin = env!("CARGO_BIN_EXE_twin");
    let line = format!("{twin} {}", Shop::arguments("short.cnc", "--homed --home=U").join(" "));
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
        let done = shop.desk.twin(&["run", "short.cnc", "-m", "mixture.toml", option]);
        done.ended(2, &format!("{option} says nothing without --drives real"));
    }
    shop.untouched();
}

#[test]
fn ctrl_c_brings_everything_to_rest_on_the_path_and_nobody_else_has_the_ports() {
    let shop = Shop::new();
    let run = Shop::arguments("long.cnc", "--homed --home=U --yes --report run.json");
    let done = shop.desk.meanwhile("-INT", "axis U is home", &run, || {
        shop.under_way();
        // They belong to somebody.
        for (family, port) in [("interpcnc", "board"), ("smartdrive", "bus")] {
            let other = shop.desk.twin(&["drive", family, "--port", port, "status"]);
            other.ended(2, &format!("{port}, address 1: opening the port"));
        }
        let other = shop.desk.twin(&["drive", "bim2ax", "--port", "module", "status"]);
        other.ended(2, "module: opening the port: another program is the master of module: end it");
    });
    done.ended(2, "stopped by the user at line 2 (N10)");
    assert_eq!(shop.desk.read("run.json")["completed"], false);
    let [x, y, z, u] = shop.at_rest().map(|found| found.expect("it is there"));
    assert!(x > 1.0 && x < 199.0, "{x}");
    // On the straight line of the block, to an increment of each.
    for (found, part) in [(y, 0.5), (z, 0.3), (u, 0.3)] {
        assert!((found - part * x).abs() < 2.0 / 320.0, "{x} {y} {z} {u}");
    }
}

/// Whoever is its master, a module is stopped by hand for good, and the run notices.
#[test]
fn a_stop_by_hand_gets_through_to_the_module_of_a_run() {
    let shop = Shop::new();
    let run = Shop::arguments("long.cnc", "--homed --home=U --yes");
    let done = shop.desk.meanwhile("-CONT", "axis U is home", &run, || {
        shop.under_way();
        shop.by_hand("bim2ax", "module", "stop");
    });
    done.ended(2, "the drives failed at line 2 (N10): ");
    done.ended(2, "module");
    let [x, _, _, u] = shop.at_rest().map(|found| found.expect("it is there"));
    assert!(x > 1.0 && x < 199.0 && u < 59.0, "{x} {u}");
}

/// The driver of the board waits two seconds for each answer; the others do not go on for so long.
#[test]
fn a_device_that_keeps_silent_stops_all_others_on_the_path() {
    let shop = Shop::new();
    let deadline = "port = \"board\"\nanswer_deadline_ms = 2000";
    let text = mixture(&shop.desk);
    assert!(text.contains(deadline));
    let silent = format!("{deadline}\nlongest_silence_ms = 1000");
    shop.desk.write("mixture.toml", &text.replace(deadline, &silent));
    let run = Shop::arguments("long.cnc", "--homed --home=U --yes");
    let done = shop.desk.meanwhile("-CONT", "axis U is home", &run, || {
        shop.under_way();
        shop.board.control(Control::Disconnect(true)).expect("it runs");
        // The others come to rest; the driver of the board goes on asking.
        let rests = |_| {
            std::thread::sleep(Duration::from_millis(10));
            let bus = shop.bus.borrow();
            let devices = bus.as_ref().expect("it is there").look().expect("it runs");
            let still = devices[0].motion().1.abs() < f64::EPSILON;
            still && shop.module.module().velocity(ModuleAxis::One).abs() < f64::EPSILON
        };
        assert!((0..6000).any(rests), "the others go on");
    });
    done.ended(2, "device `board` has not answered for");
    done.ended(2, "(longest_silence_ms = 1000)");
    let [_, _, z, u] = shop.at_rest().map(|found| found.expect("it is there"));
    // On the straight line of the block, far from its end.
    assert!(u > 0.5 && u < 59.0 && (z - u).abs() < 2.0 / 320.0, "{z} {u}");
}

#[test]
fn a_device_that_dies_stops_all_others() {
    let shop = Shop::new();
    let run = Shop::arguments("long.cnc", "--homed --home=U --yes");
    let done = shop.desk.meanwhile("-CONT", "axis U is home", &run, || {
        shop.under_way();
        drop(shop.bus.borrow_mut().take());
    });
    // How far they come until nobody answers any more is the deadline's business.
    done.ended(2, "the drives failed at line");
    // The others are at rest on the path before its driver has given it up, unless this computer is busy.
    done.ended(2, "device `bus` has not answered for");
    done.ended(2, "; then: bus, address 1: ");
    let [x, y, _, u] = shop.at_rest();
    let [x, y, u] = [x, y, u].map(|found| found.expect("it is there"));
    assert!(x > 1.0 && x < 200.0 && y > 0.0 && u > 0.0, "{x} {y} {u}");
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
    let run = Shop::arguments("within.cnc", "--homed --home=U --yes");
    let done = shop.desk.twin(&run);
    done.ended(2, "homing axis U: it has gone 21.6 mm and not found its home");
    let [x, y, z, u] = shop.at_rest();
    assert_eq!([x, y, z], [Some(0.0); 3]);
    // 320 µsteps per mm; it brakes on its ramp behind that.
    let u = u.expect("it is there");
    assert!(u < -21.6 && u > -30.0, "{u} mm");
}

#[test]
fn ctrl_c_stops_homing_and_the_approach() {
    // The module looks for its cam until it is told to stop.
    let shop = Shop::new();
    shop.hide_the_cam();
    let run = Shop::arguments("short.cnc", "--homed --home=U --yes");
    let done = shop.desk.interrupted("-INT", "home axes, move all", &run);
    done.ended(2, "stopped by the user while axis U was homed");
    let [x, y, z, u] = shop.at_rest();
    assert_eq!([x, y, z], [Some(0.0); 3]);
    assert!(u.expect("it is there") < 0.0);

    // A long way to the start of the program: 300 mm with 100 mm/s.
    let shop = Shop::new();
    shop.desk.write("far.cnc", "% far\nN10 G92 X300 Y0 Z-40 U0\nN20 G1 X310 F50 E500 E-500\n");
    let run = Shop::arguments("far.cnc", "--homed --home=U --yes");
    let done = shop.desk.interrupted("-INT", "axis U is home", &run);
    done.ended(2, "stopped by the user on the way to the start of the program");
    let [x, ..] = shop.at_rest();
    let x = x.expect("it is there");
    assert!(x > 1.0 && x < 299.0, "{x}");
}

/// Two or three axes on devices of one family.
fn alone(desk: &Desk, family: &str, axes: &[(&str, &str)]) {
    let text = std::fs::read_to_string(desk.path("machine.toml")).expect("readable");
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
    desk.twin(&["drive", "interpcnc", "--port", "device", "--deadline", "2000", "unlock"])
        .ended(0, "");
    let run = Shop::arguments("short.cnc", "--homed --yes --report run.json");
    desk.twin(&run).ended(0, "");
    is_as_predicted(&desk.read("run.json"), &["X", "Y", "Z"]);
    let board = running.stop().expect("it runs");
    assert!(board.status().moving().is_empty());
    assert!(board.counters().iter().all(|counter| counter.abs() <= 1));
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
        let drive =
            ["drive", "smartdrive", "--port", "device", "--deadline", "2000", "--address", address];
        let [low, high] = [("Trj_PosMin", low), ("Trj_PosMax", high)]
            .map(|(name, value)| format!("set {name} {value}"));
        for action in [
            "set Trj_VelMax 2880",
            "set Trj_AccMax 30000",
            "set Trj_DecMax 30000",
            &low,
            &high,
            "unlock",
        ] {
            let words: Vec<_> = drive.into_iter().chain(action.split(' ')).collect();
            desk.twin(&words).ended(0, "");
        }
    }
    let run = Shop::arguments("short.cnc", "--homed --yes --report run.json");
    desk.twin(&run).ended(0, "");
    is_as_predicted(&desk.read("run.json"), &["X", "Y", "Z"]);
    let devices = running.stop().expect("it runs");
    assert!(devices.iter().all(|drive| drive.counter().abs() <= 1 && drive.motion().1 == 0.0));
}
