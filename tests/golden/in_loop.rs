//! Drives in the loop: emulated drives between set-points and the motors of the simulated machine.

use crate::desk::{Desk, number, shipped};

/// A portal whose axes have 320, 320 and 640 increments per mm, on a board and on a bus.
fn desk() -> Desk {
    let desk = Desk::new();
    let board = shipped("tests/data/machines/gantry3.toml");
    desk.write("cover.ngc", &shipped("examples/cover.ngc"));
    desk.write("vice.toml", &shipped("machines/gantry3_vice.toml"));
    desk.write("board.toml", &board);
    desk.write("looped.toml", &board.replace("\"interpcnc\"", "\"interpcnc\"\nin_loop = true"));
    let bus = board.replace("\"interpcnc\"", "\"smartdrive\"");
    let addresses = [("X", "1"), ("Y", "2"), ("Z", "3")].into_iter();
    let bus = addresses.fold(bus, |text, (axis, address)| {
        let [from, to] = [format!("drive_axis = \"{axis}\""), format!("drive_address = {address}")];
        text.replace(&from, &to)
    });
    desk.write("bus.toml", &bus);
    desk
}

const CHECK: &str = "check cover.ngc --physics --format json -m";

/// Axes accelerate with at most 1 m/s²; a board with three axes has a round of 26 ms, a bus one of 15 ms: what a plan with this
/// acceleration comes to in a round and a half is the most that a drive can be off, and some of it it is.
#[test]
fn check_sees_what_drives_make_of_the_set_points() {
    let desk = desk();
    let errors = |machine: &str, more: &str| -> Vec<f64> {
        let done = desk.twin(&format!("{CHECK} {machine} {more}"));
        let report = done.ended(0, "").object();
        ["X", "Y", "Z"]
            .map(|axis| number(&report["peak"][axis]["following_error"]["value"]))
            .to_vec()
    };
    let ideal = errors("board.toml", "");
    for (machine, round) in [("board.toml", 0.026), ("bus.toml", 0.015)] {
        let looped = errors(machine, "--drives-in-loop");
        let most = 0.5 * 1000.0 * f64::powi(1.5 * round, 2);
        for (ideal, looped) in ideal.iter().zip(&looped) {
            assert!(
                looped > ideal && *looped < ideal + most,
                "{machine}: {looped}, {ideal}, {most}"
            );
        }
    }
    // A key of the machine file does the same for its drive.
    assert_eq!(errors("looped.toml", ""), errors("board.toml", "--drives-in-loop"));
}

#[test]
fn a_run_has_its_twin_on_the_drives() {
    let desk = desk();
    let run = "run cover.ngc -m board.toml --drives none --report run.json";
    desk.twin(run).ended(0, "");
    let ideal = number(&desk.read("run.json")["tool_error_mm"]["twin"]["max"]);
    desk.twin(&format!("{run} --drives-in-loop")).ended(0, "");
    let report = desk.read("run.json");
    assert_eq!(report["completed"], true);
    let looped = number(&report["tool_error_mm"]["twin"]["max"]);
    assert!(looped > ideal && looped < ideal + 1.5, "{looped}, {ideal}");
}

#[test]
fn what_says_nothing_is_refused() {
    let desk = desk();
    desk.twin("check cover.ngc -m board.toml --drives-in-loop")
        .ended(2, "--drives-in-loop has no effect without --physics");
    desk.twin(&format!("{CHECK} machines/gantry3_motors.toml --drives-in-loop"))
        .ended(2, "names no [[drives]]");
}
