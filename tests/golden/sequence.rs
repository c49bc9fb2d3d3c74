//! Several programs on one machine, one after the other: the axes bridge the gap between them (manual 2.2.5, 11.7.1).

use crate::desk::{Desk, number};

/// 10 mm at 100 mm/s with 1000 mm/s²: 0.2 s, and ends at X 100.
const FIRST: &str = "% first\nN10 G92 X90 Y100\nN20 G1 X100 F100 E1000 E-1000\n";
/// The same from X 50.
const SECOND: &str = "% second\nN10 G92 X50 Y100\nN20 G1 X60 F100 E1000 E-1000\n";

/// X: 50 mm with 3000 mm/s², without reaching 400 mm/s.
fn bridged_s() -> f64 {
    2.0 * (50.0_f64 / 3000.0).sqrt() + 0.2
}

fn desk() -> Desk {
    let desk = Desk::new();
    desk.allow_late_drives();
    desk.write("first.cnc", FIRST);
    desk.write("second.cnc", SECOND);
    desk
}

#[test]
fn programs_run_one_after_the_other() {
    let desk = desk();
    let note = "X by -50.000 mm, in 0.258 s";
    let run = "run first.cnc second.cnc -m machine.toml --report r.json";
    for drives in ["none", "emulated"] {
        desk.twin(&format!("{run} --drives {drives} --limits axes")).ended(0, note);
        let [first, second] = ["r.json", "r.2.json"].map(|report| desk.read(report));
        assert_eq!(
            (&first["program"], &second["program"]),
            (&"first.cnc".into(), &"second.cnc".into())
        );
        assert!((second["completed"] == true) && (first["completed"] == true), "{second:#}");
        let executed = number(&second["executed_s"]);
        // Its time begins a cycle after the last set-point of the first program.
        let range = bridged_s() - 1e-3..bridged_s() + 5e-3;
        assert!(range.contains(&executed), "{executed}");
        // The drives are where the first program ended, and stay near the twin over the gap.
        let x = &second["axis_error"]["X"]["twin"]["max"];
        assert!(number(x) < 1.0, "{second:#}");
    }
    desk.twin("check --sequence first.cnc second.cnc -m machine.toml").ended(0, note);
    let alone = desk.twin("check first.cnc second.cnc -m machine.toml");
    assert!(!alone.stderr.contains("the one before ended"), "{}", alone.stderr);
}

/// All programs are checked before the first one moves anything.
#[test]
fn nothing_moves_if_a_later_program_is_unfit() {
    let desk = desk();
    desk.write("unfit.cnc", "% unfit\nN10 G92 X0 Y0 Z0\nN20 G1 X300 F500 E2000 E-2000\n");
    let run = "run first.cnc unfit.cnc -m machine.toml --limits programmed --report r.json";
    desk.twin(&format!("{run} --drives none")).ended(1, "axis-velocity");
    assert!(!desk.path("r.json").exists());
    assert_eq!(desk.read("r.2.json")["completed"], false);
}

#[test]
fn what_cannot_be_in_a_sequence_is_refused() {
    let desk = desk();
    desk.write(
        "job.toml",
        "[[blocks]]\nblock = \"MC_MoveAbsolute\"\naxis = \"X\"\nposition_mm = 10\n",
    );
    for command in ["check --sequence", "run --drives=none"] {
        desk.twin(&format!("{command} first.cnc job.toml -m machine.toml"))
            .ended(2, "cannot follow another program");
    }
    desk.twin("run first.cnc second.cnc -m machine.toml --serve")
        .ended(2, "--serve shows one program");
}
