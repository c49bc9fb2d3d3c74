//! `twin tune cam` within limits: the fit of a run as far as they allow, and the nearest motion that keeps them.

use crate::desk::{Desk, number};
use crate::tuning::{noise, recording, through};

/// The shipped cam that picks and places, from its points alone.
const PICK: &str = r#"name = "pick"
master = { min = 0, max = 360, unit = "deg" }
slave = { min = 0, max = 80, unit = "mm", period = 80 }
elements = [
  { master = 0, slave = 0 },      # down
  { master = 40, slave = 0 },
  { master = 140, slave = 80 },
  { master = 180, slave = 80 },
  { master = 260, slave = 12 },
  { master = 300, slave = 12 },
  { master = 360, slave = 0 },
]
"#;

/// The cam, in closed form.
fn pick(master: f64) -> f64 {
    through(&crate::tuning::PICK, master)
}

/// The largest acceleration at a velocity of the master: on the way down, 68 mm in 80 deg.
fn peak(velocity: f64) -> f64 {
    10.0 / 3.0_f64.sqrt() * 68.0 / 80.0_f64.powi(2) * velocity.powi(2)
}

const SAMPLES: u32 = 1200;

fn master(index: u32) -> f64 {
    300.0 * 0.003 * f64::from(index)
}

/// Three turns at 300 deg/s of a slave that is at 0.9 times what it is told, with a little noise.
fn recorded(shift: f64, factor: f64) -> String {
    recording("time_s,master_deg,slave_mm", SAMPLES, |index| {
        let at = master(index);
        let slave = 0.9 * (factor * pick(at) + shift) + 0.02 * noise(index);
        format!("{},{at},{slave}", 0.003 * f64::from(index))
    })
}

const TUNE: &str = "tune cam pick.toml --run run.csv --master-velocity 300 --position-max 85";

/// A gain of 0.9 asks for a scaling of 1/0.9. The acceleration allows limit/peak of it, and the position up to 85 the offset that
/// is left beside 80 times that; less of the scaling would leave more of the error.
#[test]
fn a_gain_is_undone_as_far_as_the_limits_let_it() {
    let desk = Desk::new();
    desk.write("pick.toml", PICK);
    desk.write("run.csv", &recorded(0.0, 1.0));
    let tune = format!("{TUNE} --find slave-scaling,slave-offset --max-acceleration 5800");
    let found = desk.twin(&format!("{tune} --format json -o fit.svg")).ended(0, "").object();
    let scaling = 5800.0 / peak(300.0);
    let offset = 85.0 - 80.0 * scaling;
    assert!((number(&found["coupling"]["slave_scaling"]) / scaling - 1.0).abs() < 1e-9, "{found}");
    assert!((number(&found["coupling"]["slave_offset"]) - offset).abs() < 1e-9, "{found}");
    let square = |index| {
        let wanted = pick(master(index));
        (0.9 * (scaling * wanted + offset) - wanted).powi(2)
    };
    let left = ((0..SAMPLES).map(square).sum::<f64>() / f64::from(SAMPLES)).sqrt();
    // Gain and shift are known from samples with noise.
    assert!((number(&found["limited"]["rms_left"]) - left).abs() < 1e-3, "{found} {left}");
    assert!(number(&found["limited"]["rms_without"]).abs() < 1e-12, "{found}");
    let after = (left * left + 0.02 * 0.02 / 12.0).sqrt();
    assert!((number(&found["fit"]["rms_after"]) - after).abs() < 1e-3, "{found} {after}");
    let picture = desk.text("fit.svg");
    assert!(picture.contains("before") && picture.contains("after"));
    let done = desk.twin(&format!("{tune} --write"));
    done.ended(0, "written to pick.toml");
    done.says_all(&[
        "held by the acceleration, 5800 mm/s² (1.111",
        "held by the position, 85 mm",
        "the limits of the slave leave an error of",
    ]);
    // What is written keeps the limits, and what is wanted stays.
    let text = desk.text("pick.toml");
    assert!(text.contains("wanted_slave_scaling = 1\n") && text.contains("# down"), "{text}");
    let limits = "--position-max 85 --max-acceleration 5800";
    desk.twin(&format!("cam check pick.toml --master-velocity 300 {limits}")).ended(0, "");
    // Another run, recorded with it, changes nothing.
    desk.write("run.csv", &recorded(offset, scaling));
    desk.twin(&tune).ended(0, "").says("nothing is to be changed");
}

/// What no offset and no scaling keeps is said, and nothing is written.
#[test]
fn limits_that_leave_nothing_are_told() {
    let desk = Desk::new();
    desk.write("pick.toml", PICK);
    // It does what is wanted.
    desk.write("run.csv", &recorded(0.0, 1.0 / 0.9));
    for (find, limits, words) in [
        (
            "slave-offset",
            "--max-acceleration 5000",
            "no SlaveOffset keeps the limits: the slave's limit of acceleration, 5000, is exceeded whatever it is",
        ),
        ("slave-scaling", "--position-min 10", "the slave's limit of position, 10"),
        ("slave-offset", "--position-min 20", "no SlaveOffset keeps the limits"),
    ] {
        let done = desk.twin(&format!("{TUNE} --find {find} {limits} --write"));
        done.ended(1, words);
        assert!(!done.stderr.contains("written to"), "{}", done.stderr);
    }
    assert_eq!(desk.text("pick.toml"), PICK);
}

/// Without a run: the slave keeps the limits with the least error to its motion so far, over a pass. No other of a grid of scalings
/// that keep them, each with its best offset between the limits of the position, is nearer.
#[test]
fn the_least_change_is_the_least() {
    let desk = Desk::new();
    desk.write("pick.toml", PICK);
    let limits = "--max-acceleration 7000 --max-velocity 500 --position-max 79 --position-min 1 --master-velocity 360";
    let find = "--find slave-scaling,slave-offset,master-scaling --format json";
    let tune = "tune cam pick.toml";
    let coupling = &desk
        .twin(&format!("{tune} {find} {limits} --write"))
        .ended(0, "written to pick.toml")
        .object()["coupling"];
    let [m, b, s] =
        ["master_scaling", "slave_offset", "slave_scaling"].map(|key| number(&coupling[key]));
    let error = |m: f64, b: f64, s: f64| {
        let square = |at: i32| {
            let at = f64::from(at) + 0.5;
            (s * pick(m * at) + b - pick(at)).powi(2)
        };
        ((0..360).map(square).sum::<f64>() / 360.0).sqrt()
    };
    // Velocity, acceleration and position in closed form: the cam goes from 0 to 80.
    let fast = |m: f64, s: f64| 1.875 * 68.0 / 80.0 * 360.0 * m * s;
    let hard = |m: f64, s: f64| peak(360.0) * m * m * s;
    let keeps = |m: f64, b: f64, s: f64| {
        let room = 1.0 + 1e-9;
        let moves = fast(m, s) <= 500.0 * room && hard(m, s) <= 7000.0 * room;
        moves && b >= 1.0 - 1e-9 && 80.0 * s + b <= 79.0 + 1e-9
    };
    assert!(keeps(m, b, s), "{coupling}");
    let mut least = f64::INFINITY;
    for i in 0..=100 {
        for j in 0..=200 {
            let (m, s) = (0.95 + 1e-3 * f64::from(i), 0.8 + 1e-3 * f64::from(j));
            for k in 0..=4 {
                let b = 1.0 + 0.25 * (78.0 - 80.0 * s) * f64::from(k);
                least = least.min(if keeps(m, b, s) { error(m, b, s) } else { least });
            }
        }
    }
    assert!(error(m, b, s) <= least, "{coupling} {} {least}", error(m, b, s));
    desk.twin(&format!("cam check pick.toml {limits}")).ended(0, "");
}

/// What holds each value is told without a run, too, and what changes with the others is told apart from it: the position alone
/// holds the offset of the slave, velocity or acceleration both scalings.
#[test]
fn what_holds_the_least_change_is_told() {
    let desk = Desk::new();
    desk.write("pick.toml", PICK);
    let tune =
        |more: &str| desk.twin(&format!("tune cam pick.toml --master-velocity 360 --find {more}"));
    let done = tune("slave-offset --position-min 1 --position-max 90");
    done.ended(0, "");
    done.says("SlaveOffset: 0 → 1 keeps the limits, held by the position, 1 mm\n");
    let done = tune("slave-scaling,master-scaling --max-acceleration 7000");
    done.ended(0, "");
    for name in ["SlaveScaling: 1 → 0.", "MasterScaling: 1 → 0."] {
        let line = done.stdout.lines().find(|line| line.starts_with(name)).expect("told");
        assert!(
            line.ends_with(" keeps the limits, held by the acceleration, 7000 mm/s²"),
            "{line}"
        );
    }
    let limits = "--max-acceleration 7000 --position-max 79";
    let found = tune(&format!("slave-scaling,slave-offset {limits} --format json")).object();
    let held = &found["within"]["held"];
    assert_eq!(
        held["SlaveScaling"],
        serde_json::json!(["the acceleration, 7000 mm/s²"]),
        "{found}"
    );
    assert_eq!(held["MasterScaling"], serde_json::json!([]));
    assert_eq!(found["within"]["from"], serde_json::json!([0.0, 1.0, 0.0, 1.0]));
}

/// 6,000 of the acceleration ask for 0.87 of the master alone: within 0.05 of it nothing does, if that was said, and the slave
/// gives way for the rest.
#[test]
fn an_interval_of_the_scaling_is_kept() {
    let desk = Desk::new();
    desk.write("pick.toml", PICK);
    let scaling = (6000.0 / peak(360.0)).sqrt();
    assert!(scaling < 0.9);
    let tune = |more: &str| {
        let limits = "--max-acceleration 6000 --master-velocity 360";
        desk.twin(&format!("tune cam pick.toml {limits} --find {more}"))
    };
    let json = |more: &str| tune(&format!("{more} --format json")).object();
    let found = json("master-scaling");
    assert!((number(&found["coupling"]["master_scaling"]) / scaling - 1.0).abs() < 1e-9, "{found}");
    tune("master-scaling=0.95..1.05")
        .ended(1, "no MasterScaling keeps the limits: the slave's limit of acceleration, 6000, and")
        .ended(1, "0.95");
    let found = json("master-scaling=0.95..1.05,slave-scaling");
    let master = number(&found["coupling"]["master_scaling"]);
    assert!((0.95..=1.05).contains(&master), "{found}");
    let rest = 6000.0 / peak(master * 360.0);
    assert!((number(&found["coupling"]["slave_scaling"]) / rest - 1.0).abs() < 1e-9, "{found}");
    // For the smallest peak its end is what holds it.
    let found = json("master-scaling=0.8..1.2 --minimise jerk");
    assert_eq!(found["coupling"]["master_scaling"], 0.8, "{found}");
}
