//! Runs on real drives that are stopped, by the user or by a failure.

use crate::desk::comes;
use crate::shop::{Shop, mixture};
use std::time::Duration;
use twin_bim2ax::ModuleAxis;
use twin_drives::Control;
use twin_interpcnc::BoardAxis;

/// The driver of the board waits two seconds for each answer; the others do not go on for so long.
#[test]
fn a_device_that_keeps_silent_stops_all_others_on_the_path() {
    let shop = Shop::new();
    let deadline = "port = \"board\"\nanswer_deadline_ms = 2000";
    let text = mixture(&shop.desk);
    assert!(text.contains(deadline));
    let silent = format!("{deadline}\nlongest_silence_ms = 1000");
    shop.desk.write("mixture.toml", &text.replace(deadline, &silent));
    shop.disturbed("-CONT", |_| {
        shop.board.control(Control::Disconnect(true)).expect("it runs");
        // The others come to rest; the driver of the board goes on asking.
        comes(|| {
            let bus = shop.bus.borrow();
            let devices = bus.as_ref().expect("it is there").look().expect("it runs");
            let still = devices[0].motion().1.abs() < f64::EPSILON;
            still && shop.module.module().velocity(ModuleAxis::One).abs() < f64::EPSILON
        });
    })
    .ended(2, "the drives failed at line 2 (N10): device `board` has not answered for")
    .ended(2, "(longest_silence_ms = 1000)");
    let [_, _, z, u] = shop.at_rest().map(|found| found.expect("it is there"));
    // On the straight line of the block, far from its end.
    assert!(u > 0.5 && u < 59.0 && (z - u).abs() < 2.0 / 320.0, "{z} {u}");
}

#[test]
fn a_device_that_dies_stops_all_others() {
    let shop = Shop::new();
    let done = shop.disturbed("-CONT", |_| {
        drop(shop.bus.borrow_mut().take());
    });
    // How far they come until nobody answers any more is the deadline's business.
    done.ended(2, "the drives failed at line");
    // The others are at rest on the path before its driver has given it up, unless this computer is busy.
    done.ended(2, "device `bus` has not answered for");
    done.ended(2, "; then: device `bus`, axis Z: bus, address 1: ");
    // What is not known is not told.
    done.ended(2, "device `bus` was last heard of at ");
    done.ended(2, " mm; its position since then is not known");
    done.ended(2, "device `module` was last heard of at ");
    let [x, y, _, u] = shop.at_rest();
    let [x, y, u] = [x, y, u].map(|found| found.expect("it is there"));
    assert!(x > 1.0 && x < 200.0 && y > 0.0 && u > 0.0, "{x} {y} {u}");
}

/// Whoever is its master, a module is stopped by hand for good, and the run notices.
#[test]
fn a_stop_by_hand_gets_through_to_the_module_of_a_run() {
    let shop = Shop::new();
    shop.disturbed("-CONT", |_| {
        shop.by_hand("bim2ax", "module", "stop");
    })
    .ended(2, "the drives failed at line 2 (N10): ")
    .ended(2, "module");
    let [x, _, _, u] = shop.at_rest().map(|found| found.expect("it is there"));
    assert!(x > 1.0 && x < 199.0 && u < 59.0, "{x} {u}");
}

/// Its plan has ended meanwhile, and what comes after that is not made up for.
#[test]
fn a_run_that_was_frozen_does_not_go_on() {
    let shop = Shop::new();
    let done = shop.disturbed("-CONT", |process| {
        let send = |signal: &str| {
            let sent = std::process::Command::new("kill").args([signal, process]).status();
            assert!(sent.expect("kill is there").success());
        };
        send("-STOP");
        std::thread::sleep(Duration::from_secs(4));
        send("-CONT");
    });
    done.ended(2, "the drives failed at line 2 (N10): ");
    done.ended(2, "ms late; the axes were braked where they were");
    // Not the cable, not the supply.
    done.ended(2, "; this computer stood still for ");
    done.ended(2, "look first for what stopped this process (Ctrl-Z, a debugger)");
    assert!(!done.stderr.contains("supply"), "{}", done.stderr);
    let [x, y, z, u] = shop.at_rest().map(|found| found.expect("it is there"));
    // At 13 mm/s it has come a quarter of a second's way since, and a ramp; where it is due by then is 50 mm on.
    assert!(x > 5.0 && x < 30.0, "{x} {y} {z} {u}");
}

#[test]
fn ctrl_c_stops_homing_and_the_approach() {
    // The module looks for its cam until it is told to stop.
    let shop = Shop::new();
    shop.hide_the_cam();
    let run = Shop::real("short.cnc", "--homed --home=U --yes");
    shop.desk
        .interrupted("-INT", "home axes, move all", &run)
        .ended(2, "stopped by the user while homing axis U");
    let [x, y, z, u] = shop.at_rest();
    assert_eq!([x, y, z], [Some(0.0); 3]);
    assert!(u.expect("it is there") < 0.0);

    // A long way to the start of the program: 300 mm with 100 mm/s.
    let shop = Shop::new();
    shop.desk.write("far.cnc", "% far\nN10 G92 X300 Y0 Z-40 U0\nN20 G1 X310 F50 E500 E-500\n");
    let run = Shop::real("far.cnc", "--homed --home=U --yes");
    shop.desk
        .interrupted("-INT", "axis U is home", &run)
        .ended(2, "stopped by the user on the way to the start of the program");
    let [x, ..] = shop.at_rest();
    let x = x.expect("it is there");
    assert!(x > 1.0 && x < 299.0, "{x}");
}

#[test]
fn ctrl_c_brings_everything_to_rest_on_the_path_and_nobody_else_has_the_ports() {
    let shop = Shop::new();
    shop.disturbed("-INT", |_| {
        // They belong to somebody.
        for (family, port) in [("interpcnc", "board"), ("smartdrive", "bus")] {
            shop.desk
                .twin(&format!("drive {family} --port {port} status"))
                .ended(2, &format!("{port}, address 1: opening the port"));
        }
        shop.desk
            .twin("drive bim2ax --port module status")
            .ended(2, "module: opening the port: another program is the master of module: end it");
    })
    .ended(2, "stopped by the user at line 2 (N10)");
    assert_eq!(shop.desk.read("run.json")["completed"], false);
    let [x, y, z, u] = shop.at_rest().map(|found| found.expect("it is there"));
    assert!(x > 1.0 && x < 199.0, "{x}");
    // On the straight line of the block, to an increment of each.
    for (found, part) in [(y, 0.5), (z, 0.3), (u, 0.3)] {
        assert!((found - part * x).abs() < 2.0 / 320.0, "{x} {y} {z} {u}");
    }
}

/// To the end of the second line, and then nothing for a minute: a dwell, which RS274 has, and there U rests all the time, or a halt.
/// Where U is then, mm.
const WAITS: [(&str, &str, f64, &str); 2] = [
    ("waits.ngc", "G21 G90 G94\nG1 X10 Y5 Z-35 F2400\nG4 P60\nG1 X0 Y0 Z-40\nM2\n", 0.0, ""),
    (
        "waits.cnc",
        "% halt\nN10 G1 X10 Y5 Z-35 U8 F50 E500 E-500\nN20 M0\nN30 G1 X0 Y0 Z-40 U0\n",
        8.0,
        "--m-ack 60s",
    ),
];

/// A master that waits gives the module no orders: it is ended all the same, with its axes where the block before has left them.
#[test]
fn ctrl_c_ends_a_run_that_waits_with_a_module() {
    for (name, program, u, options) in WAITS {
        let shop = Shop::new();
        shop.desk.write(name, program);
        let more = format!("--homed --home=U --yes --report run.json {options}");
        let run = Shop::real(name, &more);
        let waiting = || {
            comes(|| {
                let board = shop.board.look().expect("it runs");
                let module = shop.module.module();
                let x = (board.position(BoardAxis::X) - 3200.0).abs() < 1.01;
                x && (module.position(ModuleAxis::One) - 320.0 * u).abs() < 1.01
                    && module.velocity(ModuleAxis::One).abs() < f64::EPSILON
            });
            // Into the wait.
            std::thread::sleep(Duration::from_millis(500));
        };
        shop.desk
            .meanwhile("-INT", "axis U is home", &run, waiting)
            .ended(2, "stopped by the user at line 3")
            .ended(2, "the axes braked along the path");
        assert_eq!(shop.desk.read("run.json")["completed"], false);
        let found = shop.at_rest().map(|found| found.expect("it is there"));
        for (found, wanted) in found.into_iter().zip([10.0, 5.0, 5.0, u]) {
            // Z counts from where it began, at -40 mm.
            assert!((found - wanted).abs() < 1.01 / 320.0, "{found}, {wanted}: {program}");
        }
    }
}

#[test]
fn a_signal_that_ends_a_run_is_called_by_its_name() {
    let shop = Shop::new();
    let done = shop.disturbed("-HUP", |_| ());
    done.ended(2, "stopped by the user at line 2 (N10)");
    done.ended(2, "what asked for it was SIGHUP, nobody at the keyboard");
    assert!(!done.stderr.contains("Ctrl-C"), "{}", done.stderr);
    let [x, ..] = shop.at_rest();
    assert!(x.is_some_and(|x| x > 1.0 && x < 199.0), "{x:?}");
}

/// The bus is a program of its own, which is killed: with it the near end of its pseudo-terminal goes, and reading and writing the
/// far end fail from then on, as on a USB adapter that is pulled out. (This process would hand its own terminals on to the run.)
#[test]
fn a_port_that_disappears_is_named_and_the_others_stop() {
    let shop = Shop::new();
    drop(shop.bus.borrow_mut().take());
    let mut bus = shop.desk.command("emulate smartdrive --link bus").spawn().expect("it starts");
    crate::shop::listens(&shop.desk, "bus");
    shop.commission_bus();
    let done = shop.disturbed("-CONT", |_| {
        bus.kill().expect("it runs");
        bus.wait().expect("it has ended");
        shop.others_come_to_rest();
    });
    done.ended(2, "the drives failed at line 2 (N10): device `bus`, axis Z: bus, address 1: ");
    done.ended(2, "the port is gone: is the adapter plugged in");
    assert!(!done.stderr.contains("no answer within"), "{}", done.stderr);
    let [x, y, z, u] = shop.at_rest();
    let [x, y, u] = [x, y, u].map(|found| found.expect("it is there"));
    assert_eq!(z, None);
    assert!(x > 1.0 && x < 199.0 && y < 100.0 && u < 60.0, "{x} {y} {u}");
}

/// Vector 33 of the digest: RESET for address 1. The drive starts its firmware (250 ms), and comes back switched off and at 0.
#[test]
fn a_reset_that_somebody_else_sends_ends_the_run() {
    use std::io::Write;
    let shop = Shop::new();
    // Before the run has the port to itself.
    let mut other =
        std::fs::OpenOptions::new().write(true).open(shop.desk.path("bus")).expect("it opens");
    shop.disturbed("-CONT", |_| {
        other.write_all(&[0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01]).expect("it is written");
        shop.others_come_to_rest();
    })
    .ended(2, "the drives failed at line 2 (N10): ")
    .ended(2, "bus, address 1: ")
    .ended(2, "the drive is in mode 0, not in 3");
    // Z has lost its position.
    let [x, _, z, u] = shop.at_rest().map(|found| found.expect("it is there"));
    assert!(x > 1.0 && x < 199.0 && u < 59.0, "{x} {u}");
    assert!(z.abs() < 1e-9, "{z}");
}
