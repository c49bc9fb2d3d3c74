//! `twin tune cam` and `twin cam check` about the start: a proposal must start, or it is not proposed (error 626).

use crate::desk::{Desk, number};
use crate::tuning::{LIFT, lift, noise, recording};
use serde_json::Value;

/// The lift without its tappets.
fn lift_alone() -> &'static str {
    LIFT.split_once("tappets").expect("it has some").0
}

/// A slave that is 1.8 deg ahead of where it should be, 400 deg/s from `first` on, with a little noise.
fn recorded(first: f64, samples: u32) -> String {
    recording("time_s,master_deg,slave_mm", samples, |index| {
        let master = first + 0.4 * f64::from(index);
        format!(
            "{},{master},{}",
            0.001 * f64::from(index),
            lift(master + 1.8) + 0.02 * noise(index)
        )
    })
}

/// −1.8 undoes it. Put end to end, 358.2 is the same motion, and starts with the master at 0; passed once, it does not start,
/// and nothing is written; from 5 on −1.8 starts.
#[test]
fn what_is_proposed_starts_where_the_run_does() {
    let desk = Desk::new();
    desk.write("lift.toml", lift_alone());
    desk.write("run.csv", &recorded(0.0, 880));
    let tune = |more: &str| {
        desk.twin(&format!("tune cam lift.toml --run run.csv --find master-offset {more}"))
    };
    let found = tune("--format json").ended(0, "").object();
    let offset = number(&found["coupling"]["master_offset"]);
    assert!((offset - 358.2).abs() < 0.02, "{found}");
    let (without, start) = (&found["start"]["told_without"]["master_offset"], &found["start"]);
    assert!((number(without) - (offset - 360.0)).abs() < 1e-9, "{start}");
    assert_eq!(start["master"], 0.0);
    assert!((number(&start["min"]) + offset).abs() < 1e-9, "{start}");
    // Known as well as before, and the error is that of the noise: 0.02/√12.
    assert!(number(&found["fit"]["proposed"]["MasterOffset"]["half_width_95"]) > 0.0, "{found}");
    assert!(number(&found["fit"]["rms_after"]) < 0.007, "{found}");
    tune("").says_all(&[
        "MasterOffset is given as 358.",
        "with the master at 0 deg",
        "elsewhere it ends with error 626",
    ]);
    // What is written does start, and what was proposed without that would not.
    tune("--write new.toml").ended(0, "written to new.toml");
    let check =
        |name: &str, more: &str| desk.twin(&format!("cam check {name} --master-start 0 {more}"));
    check("new.toml", "").ended(0, "");
    check("lift.toml", "--master-offset=-1.8").ended(1, "is at -1.8 of the cam");

    // Passed once it cannot start there: nothing is written.
    tune("--once --write new.toml --force")
        .ended(1, "MC_CamIn would not start")
        .ended(1, "is at -1.8");
    let found = tune("--once --master-start 5 --format json").ended(0, "").object();
    assert!((number(&found["coupling"]["master_offset"]) + 1.8).abs() < 0.02, "{found}");
    assert!((number(&found["start"]["min"]) - 1.8).abs() < 0.02, "{found}");
    assert_eq!(found["limited"], Value::Null);
    let tune = "tune cam lift.toml --find slave-scaling --max-velocity 300 --master-velocity 400";
    desk.twin(&format!("{tune} --once --master-start 0 --master-offset -3 --write"))
        .ended(1, "MC_CamIn would not start")
        .ended(1, "from 3 to 363 deg");
    assert_eq!(desk.text("lift.toml"), lift_alone());
}

/// Without knowing where the master starts the check says from where to where it may be, with it where the slave has to be.
#[test]
fn the_check_says_where_it_starts() {
    let desk = Desk::new();
    desk.write("lift.toml", lift_alone());
    let check = |more: &str| desk.twin(&format!("cam check lift.toml --master-offset 25 {more}"));
    check("").ended(0, "").says(
        "MC_CamIn starts with the master from -25 to 335 deg, elsewhere it ends with error 626",
    );
    // 95 of the cam.
    check("--master-start 70").says(&format!(
        "starts with the master at 70 deg: at 95 of the cam, which has the slave at {:.2}",
        lift(95.0)
    ));
    check("--master-start 340 --once")
        .ended(1, "MC_CamIn ends with error 626: the master at 340 deg is at 365 of the cam")
        .ended(1, "start with the master from -25 to 335 deg");
    check("--master-start 340").ended(1, "set MasterOffset -335 for the same motion");
    let start = &check("--master-start 340 --format json").object()["start"];
    assert!(start["starts"] == false && start["place"] == 365.0, "{start}");
    desk.twin("tune cam lift.toml --ramp-in 0,0 --master-start 1").ended(2, "cannot be used with");
}
