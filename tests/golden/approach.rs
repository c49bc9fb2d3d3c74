//! The way to the start of a program on a real board, which is emulated in this process: its counters prove where the tool went.

use crate::desk::{Desk, Done};
use crate::shop::a_board;
use std::time::Duration;
use twin_interpcnc::BoardAxis;

/// Steps per mm of X and Y, and of Z; the tool is 60 mm long.
const STEPS: [f64; 3] = [320.0, 320.0, 640.0];

/// `machines/gantry3_vice.toml` on the board at `device`; its program starts in front of the fixed jaw, 10 mm below its top.
fn desk() -> Desk {
    let desk = Desk::new();
    let text = include_str!("../../machines/gantry3_vice.toml");
    let text = text.replace("/dev/ttyUSB0\"", "device\"\nanswer_deadline_ms = 2000");
    let text = text.replace("start_mm = [0.0, 0.0, 40.0]", "start_mm = [50.0, -40.0, -20.0]");
    let text = text.replace("max_following_error_mm = 0.5", "max_following_error_mm = 100.0");
    desk.write("vice.toml", &text);
    desk.write("part.ngc", "G21\nG1 X55 F600\nG1 X50\nM2\n");
    desk
}

fn by_hand(desk: &Desk, action: &str) {
    desk.twin(&format!("drive interpcnc --port device --deadline 2000 {action}")).ended(0, "");
}

/// Moves the tip by hand, mm.
fn put(desk: &Desk, tip: [f64; 3]) {
    by_hand(desk, "unlock");
    let axes = [tip[0], tip[1], tip[2] + 60.0];
    for ((name, position), steps) in ["X", "Y", "Z"].into_iter().zip(axes).zip(STEPS) {
        by_hand(desk, &format!("move {name} {} --speed 40000 --yes", position * steps));
    }
}

fn run(desk: &Desk) -> Done {
    desk.twin("run part.ngc -m vice.toml --drives real --homed --yes")
}

/// From behind the moving jaw, 20 mm below its top, over both jaws.
#[test]
fn the_tool_goes_over_the_jaws() {
    let desk = desk();
    let board = a_board(&desk.path("device"));
    put(&desk, [250.0, 230.0, -30.0]);
    let (done, highest) = std::thread::scope(|scope| {
        let running = scope.spawn(|| run(&desk));
        let mut highest = f64::NEG_INFINITY;
        while !running.is_finished() {
            let look = board.look().expect("it runs");
            let [y, z] = [BoardAxis::Y, BoardAxis::Z].map(|axis| look.position(axis));
            let (y, z) = (y / STEPS[1], z / STEPS[2] - 60.0);
            highest = highest.max(z);
            // Jaws from Y80 to Y100 and from Y160 to Y180, stock between them up to Z0, a tool of 6 mm.
            assert!(!(77.0..183.0).contains(&y) || z >= 0.0, "Y {y} Z {z}");
            std::thread::sleep(Duration::from_millis(1));
        }
        (running.join().expect("it ends"), highest)
    });
    done.ended(0, "").reports(&[
        "✓ way to the start: ",
        "Z to 70.000 mm; tool tip at X 250.000 Y 230.000 Z 10.000 mm",
        "Y to 60.000 mm; tool tip at X 250.000 Y 60.000 Z 10.000 mm",
        "Z to 40.000 mm; tool tip at X 250.000 Y 60.000 Z -20.000 mm",
    ]);
    assert!((highest - 10.0).abs() < 0.1, "{highest}");
}

#[test]
fn a_tip_in_a_jaw_moves_nothing() {
    let desk = desk();
    let board = a_board(&desk.path("device"));
    put(&desk, [250.0, 170.0, -15.0]);
    run(&desk).ended(2, "nothing has moved").reports(&[
        "✗ no way to the start of the program is clear: the tool is 5.000 mm deep in moving jaw where the axes are now",
        "with the tool tip at X 250.000 Y 170.000 Z -15.000 mm",
        "twin drive interpcnc --port device --address 1 --deadline 2000 jog Z 6400 --speed 6400",
    ]);
    let look = board.look().expect("it runs");
    let found = [BoardAxis::X, BoardAxis::Y, BoardAxis::Z].map(|axis| look.position(axis));
    let expected = [80_000.0, 54_400.0, 28_800.0];
    assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1.0));
    // What is said to be done frees it.
    by_hand(&desk, "jog Z 6400 --speed 6400 --yes");
    run(&desk).ended(0, "✓ way to the start: ");
}

/// Emulated drives are switched on at 0: here a clamp is there.
#[test]
fn emulated_drives_are_refused_too() {
    let desk = desk();
    let text = std::fs::read_to_string(desk.path("vice.toml")).expect("it has been written");
    let clamp = "\n[[obstacles]]\nname = \"clamp\"\nshape = \"box\"\nsize_mm = [20.0, 20.0, 40.0]\nposition_mm = [0.0, 0.0, -45.0]\n";
    desk.write("vice.toml", &(text + clamp));
    desk.twin("run part.ngc -m vice.toml").ended(2, "were not moved there").reports(&[
        "the tool is 13.000 mm deep in clamp",
        "emulated drives are switched on with every axis at 0",
    ]);
}
