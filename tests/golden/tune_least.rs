//! `twin tune cam` for the smallest peak: offsets, scalings and ramps, in closed form; and the protection of existing
//! files.

use crate::desk::{Desk, number};
use crate::tuning::LIFT;
use std::f64::consts::PI;

const REST: &str = "name = \"rest\"\nmaster = { min = 0, max = 100 }\nslave = { min = 0, max = 20, period = 20 }\nelements = [{ master = 0, slave = 10 }]\n";

/// From rest to rest y‴ is 60·h/w³ at most: most between 120 and 180, where 30 mm are gone in 60 deg. The jerk grows with the cube
/// of the master scaling, and both scalings end at the least of their intervals. Tappets keep their places on the master.
#[test]
fn scalings_for_the_least_jerk() {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    let tune = "tune cam lift.toml --master-velocity 300 --minimise jerk --find slave-scaling=0.8..1.2,master-scaling=0.9..1.1";
    let found = desk.twin(&format!("{tune} --format json")).ended(0, "").object();
    let before = 60.0 * 30.0 / 60.0_f64.powi(3) * 300.0_f64.powi(3);
    for (value, expected) in [
        (&found["least"]["before"], before),
        (&found["least"]["after"], before * 0.8 * 0.9_f64.powi(3)),
        (&found["coupling"]["master_scaling"], 0.9),
        (&found["coupling"]["slave_scaling"], 0.8),
    ] {
        assert!((number(value) / expected - 1.0).abs() < 1e-9, "{value} {expected}");
    }
    let done = desk.twin(&format!("{tune} --write gentle.toml"));
    done.ended(0, "written to gentle.toml");
    done.says_all(&[
        "held by the end of an interval, 0.8",
        " of the cam stays at master 50 deg; the slave is at ",
    ]);
    // The check says the same of what was written.
    let checked = desk.twin("cam check gentle.toml --master-velocity 300 --format json").object();
    let jerk = number(&checked["jerk"]["max"]).max(-number(&checked["jerk"]["min"]));
    assert!((jerk / number(&found["least"]["after"]) - 1.0).abs() < 1e-9, "{jerk}");
    // What is there stays, if it is not said.
    desk.twin(&format!("{tune} --write gentle.toml"))
        .ended(2, "the file exists already and is left unchanged");
    desk.twin(&format!("{tune} --write gentle.toml --force")).ended(0, "written");
    for (name, status, words) in [("gentle.toml", 2, "exists already"), ("new.csv", 0, "points")] {
        desk.twin(&format!("cam convert lift.toml {name}")).ended(status, words);
    }
    desk.twin("cam convert lift.toml gentle.toml --force").ended(0, "points");
}

/// The examples of the help that need no run are carried out as they are written.
#[test]
fn the_examples_of_the_help_work() {
    let desk = Desk::new();
    desk.write("cam.toml", LIFT);
    let help = desk.twin("tune cam --help").stdout;
    let (_, examples) = help.split_once("Examples:").expect("examples");
    let one_line = examples.split_whitespace().collect::<Vec<_>>().join(" ");
    let calls = one_line.split("twin ").skip(1).filter(|call| !call.contains("--run"));
    let mut count = 0;
    for call in calls {
        desk.twin(call).ended(0, "");
        count += 1;
    }
    assert_eq!(count, 2);
}

#[test]
fn what_nothing_holds_is_said() {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    let tune = |more: &str| desk.twin(&format!("tune cam lift.toml {more}"));
    let jerk = "--minimise jerk --find";
    tune(&format!("{jerk} slave-scaling")).ended(1, "SlaveScaling could become 0");
    tune(&format!("{jerk} slave-scaling=0.5..0.7 --max-velocity 0.1")).ended(
        1,
        "the end of an interval, 0.5 and the slave's limit of velocity, 0.1 leave nothing of SlaveScaling",
    );
    tune(&format!("{jerk} slave-scaling=1.1..0.9")).ended(2, "1.1 is more than 0.9");
    tune(&format!("{jerk} slave-scale")).ended(2, "is none of master-offset");
    tune(&format!("{jerk} master-offset")).ended(2, "offsets alone change no peak");
    tune("--minimise jerk").ended(2, "nothing is to be found");
    tune("--minimise jerk --run run.csv").ended(2, "cannot be used with");
    tune("--run nix.csv").ended(2, "cannot read run nix.csv");
}

/// 10 mm in 2 s, from rest to rest: J·T³/32 with parabolic ramps, J·T³/(4·π²) with sigmoid ones.
#[test]
fn ramps_with_the_least_jerk() {
    let desk = Desk::new();
    desk.write("rest.toml", REST);
    let limits = "--max-velocity 100 --max-acceleration 1000 --max-jerk 100000";
    let tune = |more: &str| desk.twin(&format!("tune cam rest.toml {limits} {more}"));
    let ramp = "--ramp-in 0,0 --within 2 --minimise jerk";
    for (kind, expected) in
        [("parabolic", 32.0 * 10.0 / 8.0), ("sigmoid", 4.0 * PI * PI * 10.0 / 8.0)]
    {
        let found = tune(&format!("{ramp} --ramp {kind} --format json")).ended(0, "").object();
        for key in ["peak_jerk", "axis_jerk"] {
            let jerk = number(&found["ramp"][key]);
            assert!((jerk / expected - 1.0).abs() < 1e-5, "{kind} {key}: {jerk} {expected}");
        }
        assert_eq!(found["ramp"]["ramp"], kind);
        tune(&format!("{ramp} --ramp {kind}")).says("of the slave's axis: `max_jerk_…`");
    }
    tune("--ramp-in 0,-1e9 --ramp sigmoid").ended(1, "which is more than 3600 s");
    tune("--ramp-in 0,0 --minimise jerk").ended(2, "--within");
}
