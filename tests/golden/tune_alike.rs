//! `twin tune cam` with ambiguous fits: cams that match a run in more than one place.

use crate::process::{Desk, object};
use std::fmt::Write;

/// A cam of points at rest, 100 mm up and down as often as it says, with dwells between.
fn cam(points: &[(f64, f64)]) -> String {
    let points: Vec<_> = points
        .iter()
        .map(|(master, slave)| format!("  {{ master = {master}, slave = {slave} }},\n"))
        .collect();
    format!(
        "master = {{ min = 0, max = 360, unit = \"deg\" }}\nslave = {{ min = 0, max = 100, unit = \"mm\", period = 400 }}\n\
         elements = [\n{}]\n",
        points.concat()
    )
}

/// The same cam, from the quintic of two points at rest alone.
fn place(points: &[(f64, f64)], at: f64) -> f64 {
    let at = at.rem_euclid(360.0);
    let pair = points.windows(2).find(|pair| at <= pair[1].0).expect("on the cam");
    let part = (at - pair[0].0) / (pair[1].0 - pair[0].0);
    let lift = part.powi(3) * (10.0 - 15.0 * part + 6.0 * part * part);
    pair[0].1 + (pair[1].1 - pair[0].1) * lift
}

/// Two turns in two seconds: `MasterOffset`, `SlaveOffset` and `SlaveScaling` of the truth, and noise within ± 0.05.
fn recorded(points: &[(f64, f64)], [offset, shift, factor]: [f64; 3]) -> String {
    let mut text = String::from("time_s,master_deg,slave_mm\n");
    for index in 0..1000_u32 {
        let time = f64::from(index) * 0.002;
        let master = 360.0 * time;
        // Bits mixed so that neighbours have nothing to do with each other.
        let mixed = u64::from(index + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9) >> 40;
        let noise = 0.1 * (f64::from(u32::try_from(mixed).expect("24 bits")) / 16_777_216.0 - 0.5);
        let slave = factor * place(points, master + offset) + shift + noise;
        writeln!(text, "{time},{master},{slave:.6}").expect("text");
    }
    text
}

const DOUBLE_DWELL: [(f64, f64); 5] =
    [(0.0, 0.0), (90.0, 100.0), (180.0, 100.0), (270.0, 0.0), (360.0, 0.0)];
const RISE_RETURN: [(f64, f64); 3] = [(0.0, 0.0), (180.0, 100.0), (360.0, 0.0)];
const FIND: &str = "master-offset,slave-offset,slave-scaling";

/// Down is up with a mirrored slave, half a cam on: 100 − y(x + 180) is y(x). The slave that is not mirrored is taken.
#[test]
fn a_slave_is_not_mirrored() {
    let desk = Desk::new();
    for points in [&DOUBLE_DWELL[..], &RISE_RETURN] {
        desk.write("cam.toml", &cam(points));
        desk.write("run.csv", &recorded(points, [-1.8, 0.3, 1.02]));
        let tune = ["tune", "cam", "cam.toml", "--run", "run.csv", "--find", FIND];
        let done = desk.twin(&tune);
        done.ended(0, "");
        let done = desk.twin(&[&tune[..], &["--format", "json"]].concat());
        let found = object(&done.stdout);
        for (name, truth) in [("MasterOffset", -1.8), ("SlaveOffset", 0.3), ("SlaveScaling", 1.02)]
        {
            let value = found["fit"]["estimates"][name]["value"].as_f64().expect("a value");
            let half = found["fit"]["estimates"][name]["half_width_95"].as_f64().expect("known");
            assert!((value - truth).abs() < 0.02 && half < 0.02, "{name}: {value} ± {half}");
        }
        // What is proposed undoes it.
        let gain = found["coupling"]["slave_scaling"].as_f64().expect("a scaling");
        assert!((gain * 1.02 - 1.0).abs() < 1e-3, "{gain}");
    }
    // With the mirrored one in effect it is the other way round, and without --find it is named as what is missing.
    desk.write("run.csv", &recorded(&RISE_RETURN, [-1.8, 0.3, -1.02]));
    let tune = ["tune", "cam", "cam.toml", "--run", "run.csv", "--slave-scaling=-1"];
    let done = desk.twin(&[&tune[..], &["--find", FIND, "--format", "json"]].concat());
    done.ended(0, "");
    let found = object(&done.stdout);
    let value = found["fit"]["estimates"]["SlaveScaling"]["value"].as_f64().expect("a value");
    assert!((value + 1.02).abs() < 0.001, "{value}");
    desk.twin(&tune).ended(1, "With slave-scaling in --find, noise alone is left over");
}

/// A slave that fits mirrored alone is told as that.
#[test]
fn a_mirrored_slave_is_told() {
    let desk = Desk::new();
    let points = [(0.0, 0.0), (120.0, 100.0), (360.0, 0.0)];
    desk.write("cam.toml", &cam(&points));
    desk.write("run.csv", &recorded(&points, [0.0, 0.0, -1.0]));
    let done = desk.twin(&["tune", "cam", "cam.toml", "--run", "run.csv", "--find", FIND]);
    done.ended(0, "");
    let said = "the slave is mirrored: SlaveScaling has the other sign than what is wanted";
    assert!(done.stdout.contains(said), "{}", done.stdout);
}

/// Four lifts on a turn: a slave 10° off is taken as that, one 40° off may be 50° off the other way, and an interval says it.
#[test]
fn a_cam_that_repeats_itself() {
    let desk = Desk::new();
    let points: Vec<_> = (0..=8_u32)
        .map(|index| (45.0 * f64::from(index), if index % 2 == 0 { 0.0 } else { 100.0 }))
        .collect();
    desk.write("cam.toml", &cam(&points));
    let tune = |more: &[&str]| {
        desk.twin(&[&["tune", "cam", "cam.toml", "--run", "run.csv"], more].concat())
    };
    desk.write("run.csv", &recorded(&points, [-10.0, 0.0, 1.0]));
    let done = tune(&[]);
    done.ended(0, "");
    let proposed =
        object(&tune(&["--format", "json"]).stdout)["coupling"]["master_offset"].as_f64();
    assert!((proposed.expect("an offset") - 10.0).abs() < 0.01, "{proposed:?}");
    desk.write("run.csv", &recorded(&points, [-40.0, 0.0, 1.0]));
    tune(&[])
        .ended(1, "fit alike as MasterOffset")
        .ended(1, "--find master-offset=FROM..TO says which of them is meant");
    for (interval, at) in [("master-offset=-45..0", -40.0), ("master-offset=0..60", 50.0)] {
        let done = tune(&["--find", interval, "--format", "json"]);
        done.ended(0, "");
        let found = object(&done.stdout);
        let value = found["fit"]["estimates"]["MasterOffset"]["value"].as_f64().expect("a value");
        assert!((value - at).abs() < 0.01, "{interval}: {value}");
    }
    tune(&["--find", "master-offset=-30..-20"])
        .ended(1, "fits best as MasterOffset, which is not between -30 and -20");
}
