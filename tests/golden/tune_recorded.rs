//! `twin tune cam` and the form of the recording: other units, few switchings, positions within a period.

use crate::desk::{Desk, number};
use crate::tuning::{recording, through};

const CAM: &str = r#"name = "lift"
master = { min = 0, max = 360, unit = "deg" }
slave = { min = 0, max = 50, unit = "mm", period = 50 }
elements = [
  { master = 0, slave = 0 },
  { master = 90, slave = 50 },
  { master = 120, slave = 50 },
  { master = 360, slave = 0 },
]
tappets = [
  { group = 1, master = 100, passage = "positive", action = "on" },
  { group = 1, master = 200, passage = "positive", action = "off" },
]
"#;

/// The cam, in closed form.
fn place(master: f64) -> f64 {
    through(&[(0.0, 0.0), (90.0, 50.0), (120.0, 50.0), (360.0, 0.0)], master)
}

/// Within ± 0.05 mm.
fn noise(index: u32) -> f64 {
    0.1 * crate::tuning::noise(index)
}

/// So many samples every 2 ms at 360 deg/s of a slave 0.02 mm beside its cam, in units of `size` mm, and an output 10 ms late.
fn recorded(count: u32, size: f64) -> String {
    recording("time_s,master_deg,slave_mm,tappet_1", count, |index| {
        let time = f64::from(index) * 0.002;
        let slave = (place(360.0 * time + 1.2) + 0.02 + noise(index)) / size;
        let on = (100.0..200.0).contains(&(360.0 * (time - 0.01)).rem_euclid(360.0));
        format!("{time},{},{slave:.7},{}", 360.0 * time, u8::from(on))
    })
}

const FIND: &str = "master-offset,slave-offset,slave-scaling";

/// A slave in inch makes 1/25.4 of its stroke: that is asked about, and taken only if somebody says so.
#[test]
fn a_slave_in_other_units_is_told() {
    let desk = Desk::new();
    desk.write("cam.toml", CAM);
    let tune = |find: &str| desk.twin(&format!("tune cam cam.toml --run run.csv --find {find}"));
    for (size, words) in [
        (25.4, "makes 0.03937 of the stroke that is wanted"),
        (0.4, "is it recorded in other units than the cam's?"),
    ] {
        desk.write("run.csv", &recorded(1000, size));
        tune(FIND).ended(1, words);
    }
    desk.write("run.csv", &recorded(1000, 25.4));
    tune("master-offset,slave-offset,slave-scaling=0.03..0.05").ended(0, "");
    desk.write("run.csv", &recorded(1000, 0.9));
    tune(FIND).ended(0, "");
}

/// An output that switched twice tells no dead time; offsets are proposed all the same.
#[test]
fn few_switchings_keep_nothing_back() {
    let desk = Desk::new();
    desk.write("cam.toml", CAM);
    // 100 and 200 deg are passed once.
    desk.write("run.csv", &recorded(400, 1.0));
    let tune =
        |more: &str| desk.twin(&format!("tune cam cam.toml --run run.csv --find {FIND} {more}"));
    let done = tune("--write");
    done.ended(0, "");
    done.says("2 switchings are too few for a dead time: 4 are needed");
    done.says("MasterOffset := 358.");
    desk.write("cam.toml", CAM);
    let said = tune("--format json").object();
    assert!(said["dead_time"].is_null() && said["refused"].is_null(), "{said}");
    assert!(said["no_dead_time"].as_str().expect("why").contains("2 switchings"));
    assert!((number(&said["fit"]["estimates"]["MasterOffset"]["value"]) - 1.2).abs() < 0.1);
}

/// A master within 0 to 360 of which the scaling is looked for, and one within a period that has to be told.
#[test]
fn a_master_within_its_period_goes_on() {
    let desk = Desk::new();
    desk.write("cam.toml", CAM);
    let run = |period: f64| {
        recording("time_s,master_deg,slave_mm", 1500, |index| {
            let master = 0.72 * f64::from(index);
            let slave = place(1.005 * master + 1.2) + noise(index);
            format!("{},{},{slave}", 0.002 * f64::from(index), master.rem_euclid(period))
        })
    };
    let tune = |more: &str| {
        let find = "master-offset,master-scaling,slave-offset";
        let all = format!("tune cam cam.toml --run run.csv --format json --find {find}");
        desk.twin(&format!("{all} {more}")).object()
    };
    for (period, more) in [(360.0, ""), (500.0, "--master-period 500")] {
        desk.write("run.csv", &run(period));
        let said = tune(more);
        assert!((number(&said["master"]["period"]) - period).abs() < 1e-9, "{said:#}");
        let found = &said["fit"]["estimates"]["MasterScaling"];
        assert!(
            (number(&found["value"]) - 1.005).abs() <= number(&found["half_width_95"]),
            "{found}"
        );
    }
}

/// A slave that gains leaves limits of its position, whatever period its cam's file has; one that passes its cam once keeps them.
#[test]
fn what_gains_leaves_its_limits() {
    let desk = Desk::new();
    desk.write(
        "rise.toml",
        "name = \"rise\"\nmaster = { min = 0, max = 100, unit = \"mm\" }\nslave = { unit = \"mm\", period = 300 }\n\
         elements = [ { master = 0, slave = 0 }, { master = 100, slave = 300 } ]\n",
    );
    let words = "the slave gains 300 mm in every pass of the cam and leaves its";
    let check = |more: &str| desk.twin(&format!("cam check rise.toml {more}"));
    check("--position-max 200").ended(1, words);
    check("--position-max 200").ended(1, "an axis with limits does not go round");
    check("-m machines/gantry3.toml --axis X").ended(1, words);
    check("--once --position-max 300").ended(0, "");
    check("--once --position-max 200").ended(1, "its limit is 200 mm");
    check("").ended(0, "");
    desk.twin("tune cam rise.toml --find slave-scaling --position-max 1000")
        .ended(1, "the slave gains 300 in every pass and leaves");
}
