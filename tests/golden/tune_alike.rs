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

const FIND: &str = "master-offset,slave-offset,slave-scaling";

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
        .ended(1, "fit equally well as MasterOffset")
        .ended(1, "--find master-offset=FROM..TO says which of them is meant");
    for (interval, at) in [("master-offset=-45..0", -40.0), ("master-offset=0..60", 50.0)] {
        let done = tune(&["--find", interval, "--format", "json"]);
        done.ended(0, "");
        let found = object(&done.stdout);
        let value = found["fit"]["estimates"]["MasterOffset"]["value"].as_f64().expect("a value");
        assert!((value - at).abs() < 0.01, "{interval}: {value}");
    }
    tune(&["--find", "master-offset=-30..-20"])
        .ended(1, "the best fit of MasterOffset is ")
        .ended(1, ", which is not between -30 and -20");
}
