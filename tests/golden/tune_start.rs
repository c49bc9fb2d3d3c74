//! `twin tune cam` and `twin cam check` about the start: a proposal must start, or it is not proposed (error 626).

use crate::process::{Desk, number, object};
use serde_json::Value;
use std::fmt::Write;

/// Goes up in another way than down.
const LIFT: &str = r#"name = "lift"
master = { min = 0, max = 360, unit = "deg" }
slave = { min = 0, max = 100, unit = "mm", period = 100 }
elements = [
  { master = 0, slave = 0 },
  { master = 120, slave = 70 },
  { master = 180, slave = 100 },
  { master = 360, slave = 0 },
]
"#;

/// The lift, from its points alone; it rests beyond its ends.
fn lift(place: f64) -> f64 {
    let ease = |part: f64| part.powi(3) * (10.0 - 15.0 * part + 6.0 * part * part);
    match place {
        at if at < 0.0 => 0.0,
        at if at < 120.0 => 70.0 * ease(at / 120.0),
        at if at < 180.0 => 70.0 + 30.0 * ease((at - 120.0) / 60.0),
        at if at < 360.0 => 100.0 - 100.0 * ease((at - 180.0) / 180.0),
        _ => 0.0,
    }
}

/// A slave that is 1.8 deg ahead of where it should be, 400 deg/s from `first` on, with a little noise.
fn recorded(first: f64, samples: u32) -> String {
    let mut text = String::from("time_s,master_deg,slave_mm\n");
    for index in 0..samples {
        let mixed = u64::from(index + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9) >> 40;
        let noise = 0.02 * (f64::from(u32::try_from(mixed).expect("24 bits")) / 16_777_216.0 - 0.5);
        let master = first + 0.4 * f64::from(index);
        writeln!(text, "{},{master},{}", 0.001 * f64::from(index), lift(master + 1.8) + noise)
            .expect("text");
    }
    text
}

const TUNE: [&str; 7] = ["tune", "cam", "lift.toml", "--run", "run.csv", "--find", "master-offset"];

/// −1.8 undoes it. Put end to end, 358.2 is the same motion, and starts with the master at 0; passed once, it does not start,
/// and nothing is written; from 5 on −1.8 starts.
#[test]
fn what_is_proposed_starts_where_the_run_does() {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    desk.write("run.csv", &recorded(0.0, 880));
    let tune = |more: &[&str]| desk.twin(&[&TUNE[..], more].concat());
    let done = tune(&["--format", "json"]);
    done.ended(0, "");
    let found = object(&done.stdout);
    let offset = number(&found["coupling"]["master_offset"]);
    assert!((offset - 358.2).abs() < 0.02, "{found}");
    let (without, start) = (&found["start"]["told_without"]["master_offset"], &found["start"]);
    assert!((number(without) - (offset - 360.0)).abs() < 1e-9, "{start}");
    assert_eq!((&start["master"], &start["known_by"]), (&Value::from(0.0), &Value::from("run")));
    assert!((number(&start["min"]) + offset).abs() < 1e-9, "{start}");
    // Known as well as before, and the error is that of the noise: 0.02/√12.
    assert!(number(&found["fit"]["proposed"]["MasterOffset"]["half_width_95"]) > 0.0, "{found}");
    assert!(number(&found["fit"]["rms_after"]) < 0.007, "{found}");
    let done = tune(&[]);
    for words in [
        "MasterOffset is given as 358.",
        "with the master at 0 deg",
        "elsewhere it ends with error 626",
    ] {
        assert!(done.stdout.contains(words), "{words} in {}", done.stdout);
    }
    // What is written does start, and what was proposed without that would not.
    tune(&["--write", "new.toml"]).ended(0, "written to new.toml");
    let check = |name: &str, more: &[&str]| {
        desk.twin(&[&["cam", "check", name, "--master-start", "0"], more].concat())
    };
    check("new.toml", &[]).ended(0, "");
    check("lift.toml", &["--master-offset=-1.8"]).ended(1, "is at -1.8 of the cam");

    // Passed once it cannot start there: nothing is written.
    let once = tune(&["--once", "--write", "new.toml", "--force"]);
    once.ended(1, "MC_CamIn would not start").ended(1, "is at -1.8");
    let later = tune(&["--once", "--master-start", "5", "--format", "json"]);
    later.ended(0, "");
    let found = object(&later.stdout);
    assert!((number(&found["coupling"]["master_offset"]) + 1.8).abs() < 0.02, "{found}");
    assert!((number(&found["start"]["min"]) - 1.8).abs() < 0.02, "{found}");
    assert_eq!(found["limited"], Value::Null);
    let scaling = ["--once", "--master-start", "0", "--master-offset", "-3", "--write"];
    let tune = ["tune", "cam", "lift.toml", "--find", "slave-scaling", "--max-velocity", "300"];
    let master = ["--master-velocity", "400"];
    let done = desk.twin(&[&tune[..], &scaling, &master].concat());
    done.ended(1, "MC_CamIn would not start").ended(1, "from 3 to 363 deg");
    assert_eq!(std::fs::read_to_string(desk.path("lift.toml")).expect("there"), LIFT);
}

/// Without knowing where the master starts the check says from where to where it may be, with it where the slave has to be.
#[test]
fn the_check_says_where_it_starts() {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    let check = |more: &[&str]| {
        desk.twin(&[&["cam", "check", "lift.toml", "--master-offset", "25"], more].concat())
    };
    let done = check(&[]);
    done.ended(0, "");
    let said =
        "MC_CamIn starts with the master from -25 to 335 deg, elsewhere it ends with error 626";
    assert!(done.stdout.contains(said), "{}", done.stdout);
    // 95 of the cam.
    let done = check(&["--master-start", "70"]);
    let slave = format!("{:.2}", lift(95.0));
    let said = format!(
        "starts with the master at 70 deg: at 95 of the cam, which has the slave at {slave}"
    );
    assert!(done.stdout.contains(&said), "{said} in {}", done.stdout);
    let done = check(&["--master-start", "340", "--once"]);
    done.ended(1, "MC_CamIn ends with error 626: the master at 340 deg is at 365 of the cam")
        .ended(1, "start with the master from -25 to 335 deg");
    check(&["--master-start", "340"]).ended(1, "set MasterOffset -335 for the same motion");
    let done = check(&["--master-start", "340", "--format", "json"]);
    let start = &object(&done.stdout)["start"];
    assert_eq!(
        (&start["starts"], number(&start["place"])),
        (&Value::from(false), 365.0),
        "{start}"
    );
    let both = ["tune", "cam", "lift.toml", "--ramp-in", "0,0", "--master-start", "1"];
    desk.twin(&both).ended(2, "give one of them");
}
