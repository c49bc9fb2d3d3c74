//! `twin tune cam` with ambiguous fits: cams that match a run in more than one place.

use crate::desk::Desk;
use crate::tuning::{noise, recording, through};

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

/// Two turns in two seconds: `MasterOffset`, `SlaveOffset` and `SlaveScaling` of the truth, and noise within ± 0.05.
fn recorded(points: &[(f64, f64)], [offset, shift, factor]: [f64; 3]) -> String {
    recording("time_s,master_deg,slave_mm", 1000, |index| {
        let time = f64::from(index) * 0.002;
        let master = 360.0 * time;
        let slave = factor * through(points, master + offset) + shift + 0.1 * noise(index);
        format!("{time},{master},{slave:.6}")
    })
}

const FIND: &str = "master-offset,slave-offset,slave-scaling";

/// A slave that fits mirrored alone is told as that.
#[test]
fn a_mirrored_slave_is_told() {
    let desk = Desk::new();
    let points = [(0.0, 0.0), (120.0, 100.0), (360.0, 0.0)];
    desk.write("cam.toml", &cam(&points));
    desk.write("run.csv", &recorded(&points, [0.0, 0.0, -1.0]));
    let done = desk.twin(&format!("tune cam cam.toml --run run.csv --find {FIND}"));
    done.ended(0, "");
    done.says("the slave is mirrored: SlaveScaling has the other sign than what is wanted");
}

/// Four lifts on a turn: a slave 10° off is taken as that, one 40° off may be 50° off the other way, and an interval says it.
#[test]
fn a_cam_that_repeats_itself() {
    let desk = Desk::new();
    let points: Vec<_> = (0..=8_u32)
        .map(|index| (45.0 * f64::from(index), if index % 2 == 0 { 0.0 } else { 100.0 }))
        .collect();
    desk.write("cam.toml", &cam(&points));
    let tune = |more: &str| desk.twin(&format!("tune cam cam.toml --run run.csv {more}"));
    desk.write("run.csv", &recorded(&points, [-10.0, 0.0, 1.0]));
    let done = tune("");
    done.ended(0, "");
    let proposed = tune("--format json").object()["coupling"]["master_offset"].as_f64();
    assert!((proposed.expect("an offset") - 10.0).abs() < 0.01, "{proposed:?}");
    desk.write("run.csv", &recorded(&points, [-40.0, 0.0, 1.0]));
    tune("")
        .ended(1, "fit equally well as MasterOffset")
        .ended(1, "--find master-offset=FROM..TO says which of them is meant");
    for (interval, at) in [("master-offset=-45..0", -40.0), ("master-offset=0..60", 50.0)] {
        let found = tune(&format!("--find {interval} --format json")).ended(0, "").object();
        let value = found["fit"]["estimates"]["MasterOffset"]["value"].as_f64().expect("a value");
        assert!((value - at).abs() < 0.01, "{interval}: {value}");
    }
    tune("--find master-offset=-30..-20")
        .ended(1, "the best fit of MasterOffset is ")
        .ended(1, ", which is not between -30 and -20");
}
