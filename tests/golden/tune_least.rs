//! `twin tune cam` for the smallest peak: offsets, scalings and ramps, in closed form; and the protection of existing
//! files.

use crate::process::{Desk, number, object};
use std::f64::consts::PI;
use std::fmt::Write;

pub(crate) const LIFT: &str = r#"name = "lift"
master = { min = 0, max = 360, unit = "deg" }
slave = { min = 0, max = 100, unit = "mm", period = 100 }
elements = [
  { master = 0, slave = 0 },
  { master = 120, slave = 70 },
  { master = 180, slave = 100 },
  { master = 360, slave = 0 },
]
tappets = [
  { group = 1, master = 50, passage = "positive", action = "on" },
  { group = 1, master = 200, passage = "positive", action = "off" },
]
"#;

const REST: &str = "name = \"rest\"\nmaster = { min = 0, max = 100 }\nslave = { min = 0, max = 20, period = 20 }\nelements = [{ master = 0, slave = 10 }]\n";

/// From rest to rest y‴ is 60·h/w³ at most: most between 120 and 180, where 30 mm are gone in 60 deg. The jerk grows with the cube
/// of the master scaling, and both scalings end at the least of their intervals. Tappets keep their places on the master.
#[test]
fn scalings_for_the_least_jerk() {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    let tune = [
        "tune",
        "cam",
        "lift.toml",
        "--master-velocity",
        "300",
        "--minimise",
        "jerk",
        "--find",
        "slave-scaling=0.8..1.2,master-scaling=0.9..1.1",
    ];
    let done = desk.twin(&[&tune[..], &["--format", "json"]].concat());
    done.ended(0, "");
    let found = object(&done.stdout);
    let before = 60.0 * 30.0 / 60.0_f64.powi(3) * 300.0_f64.powi(3);
    for (value, expected) in [
        (&found["least"]["before"], before),
        (&found["least"]["after"], before * 0.8 * 0.9_f64.powi(3)),
        (&found["coupling"]["master_scaling"], 0.9),
        (&found["coupling"]["slave_scaling"], 0.8),
    ] {
        assert!((number(value) / expected - 1.0).abs() < 1e-9, "{value} {expected}");
    }
    let done = desk.twin(&[&tune[..], &["--write", "gentle.toml"]].concat());
    done.ended(0, "written to gentle.toml");
    for words in [
        "held by the end of an interval, 0.8",
        " of the cam stays at master 50 deg; the slave is at ",
    ] {
        assert!(done.stdout.contains(words), "{words} in {}", done.stdout);
    }
    // The check says the same of what was written.
    let check = ["cam", "check", "gentle.toml", "--master-velocity", "300", "--format", "json"];
    let checked = object(&desk.twin(&check).stdout);
    let jerk = number(&checked["jerk"]["max"]).max(-number(&checked["jerk"]["min"]));
    assert!((jerk / number(&found["least"]["after"]) - 1.0).abs() < 1e-9, "{jerk}");
    // What is there stays, if it is not said.
    desk.twin(&[&tune[..], &["--write", "gentle.toml"]].concat())
        .ended(2, "the file exists already and is left unchanged");
    desk.twin(&[&tune[..], &["--write", "gentle.toml", "--force"]].concat()).ended(0, "written");
    for (name, status, words) in [("gentle.toml", 2, "exists already"), ("new.csv", 0, "points")] {
        desk.twin(&["cam", "convert", "lift.toml", name]).ended(status, words);
    }
    desk.twin(&["cam", "convert", "lift.toml", "gentle.toml", "--force"]).ended(0, "points");
}

/// The examples of the help that need no run are carried out as they are written.
#[test]
fn the_examples_of_the_help_work() {
    let desk = Desk::new();
    desk.write("cam.toml", LIFT);
    let help = desk.twin(&["tune", "cam", "--help"]).stdout;
    let (_, examples) = help.split_once("Examples:").expect("examples");
    let one_line = examples.split_whitespace().collect::<Vec<_>>().join(" ");
    let calls = one_line.split("twin ").skip(1).filter(|call| !call.contains("--run"));
    let mut count = 0;
    for call in calls {
        desk.twin(&call.split_whitespace().collect::<Vec<_>>()).ended(0, "");
        count += 1;
    }
    assert_eq!(count, 2);
}

/// The lift, from its points alone.
fn lift(place: f64) -> f64 {
    let ease = |part: f64| part.powi(3) * (10.0 - 15.0 * part + 6.0 * part * part);
    match place.rem_euclid(360.0) {
        at if at < 120.0 => 70.0 * ease(at / 120.0),
        at if at < 180.0 => 70.0 + 30.0 * ease((at - 120.0) / 60.0),
        at => 100.0 - 100.0 * ease((at - 180.0) / 180.0),
    }
}

/// Three seconds at 300 deg/s of a slave 5 ms behind, 2 % too far and 3 mm beside, with a little noise: `MasterOffset` 1.5,
/// `SlaveScaling` 1/1.02. The run says how fast the master goes, so that the peaks are those of 300 deg/s.
#[test]
fn the_least_jerk_of_a_slave_that_was_recorded() {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    let mut text = String::from("time_s,master_deg,slave_mm\n");
    for index in 0..1500_u32 {
        let time = f64::from(index) * 0.002;
        let mixed = u64::from(index + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9) >> 40;
        let noise = f64::from(u32::try_from(mixed).expect("24 bits")) / 16_777_216.0 - 0.5;
        let slave = 1.02 * lift(300.0 * (time - 0.005)) + 3.0 + 0.02 * noise;
        writeln!(text, "{time},{},{slave}", 300.0 * time).expect("text");
    }
    desk.write("run.csv", &text);
    let tune = |more: &[&str]| {
        let start = ["tune", "cam", "lift.toml", "--run", "run.csv", "--minimise", "jerk"];
        desk.twin(&[&start[..], more].concat())
    };
    let find = ["--find", "slave-scaling=0.9..1.1"];
    let done = tune(&[&find[..], &["--format", "json"]].concat());
    done.ended(0, "");
    let found = object(&done.stdout);
    let at_one = 60.0 * 30.0 / 60.0_f64.powi(3) * 300.0_f64.powi(3);
    for (value, expected, room) in [
        (&found["master"]["velocity"], 300.0, 1e-9),
        (&found["coupling"]["master_offset"], 1.5, 5e-3),
        (&found["coupling"]["slave_scaling"], 0.9, 1e-12),
        (&found["coupling"]["slave_offset"], -3.0 / 1.02, 1e-3),
        (&found["least"]["from"][3], 1.0 / 1.02, 1e-4),
        (&found["least"]["before"], at_one / 1.02, 1e-4),
        (&found["least"]["after"], at_one * 0.9, 1e-9),
    ] {
        assert!((number(value) / expected - 1.0).abs() < room, "{value} {expected}");
    }
    // What is told on the command line counts, and what is now wanted is written.
    let fast = ["--master-velocity", "600", "--write", "new.toml"];
    let done = tune(&[&find[..], &fast].concat());
    done.ended(0, "written to new.toml");
    assert!(done.stdout.contains("held by the end of an interval, 0.9"), "{}", done.stdout);
    assert!(done.stdout.contains("the master goes 600 deg/s at most"), "{}", done.stdout);
    let written = std::fs::read_to_string(desk.path("new.toml")).expect("written");
    let wanted = written.lines().find_map(|line| line.strip_prefix("wanted_slave_scaling = "));
    let wanted: f64 = wanted.and_then(|text| text.parse().ok()).expect("a number");
    assert!((wanted - 0.9 * 1.02).abs() < 1e-4, "{wanted}");
    // A ramp from where both stand in the run: at 0, and 3 mm beside where the slave is to be.
    let limits = ["--max-velocity", "2000", "--max-acceleration", "90000", "--max-jerk", "1e8"];
    let ramp = ["--ramp-in", "0,-3", "--within", "0.5", "--ramp", "parabolic"];
    let done = tune(&[&find[..], &limits, &ramp, &["--format", "json"]].concat());
    done.ended(0, "");
    assert!(number(&object(&done.stdout)["ramp"]["duration_s"]) <= 0.5 + 1e-9, "{}", done.stdout);
    tune(&["--find", "master-offset"]).ended(2, "offsets alone change no peak");
}

#[test]
fn what_nothing_holds_is_said() {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    let tune = |more: &[&str]| desk.twin(&[&["tune", "cam", "lift.toml"], more].concat());
    let jerk = ["--minimise", "jerk", "--find"];
    tune(&[&jerk[..], &["slave-scaling"]].concat()).ended(1, "SlaveScaling could become 0");
    tune(&[&jerk[..], &["slave-scaling=0.5..0.7", "--max-velocity", "0.1"]].concat()).ended(
        1,
        "the end of an interval, 0.5 and the slave's limit of velocity, 0.1 leave nothing of SlaveScaling",
    );
    tune(&[&jerk[..], &["slave-scaling=1.1..0.9"]].concat()).ended(2, "1.1 is more than 0.9");
    tune(&[&jerk[..], &["slave-scale"]].concat()).ended(2, "is none of master-offset");
    tune(&[&jerk[..], &["master-offset"]].concat()).ended(2, "offsets alone change no peak");
    tune(&["--minimise", "jerk"]).ended(2, "nothing is to be found");
    tune(&["--minimise", "error", "--find", "slave-offset"]).ended(2, "needs a --run");
    tune(&["--find", "slave-scaling=0.9..1.1", "--max-velocity", "1"])
        .ended(2, "is for --minimise");
    tune(&["--run", "nix.csv"]).ended(2, "cannot read run nix.csv");
}

/// 10 mm in 2 s, from rest to rest: J·T³/32 with parabolic ramps, J·T³/(4·π²) with sigmoid ones.
#[test]
fn ramps_with_the_least_jerk() {
    let desk = Desk::new();
    desk.write("rest.toml", REST);
    let limits = ["--max-velocity", "100", "--max-acceleration", "1000", "--max-jerk", "100000"];
    let tune =
        |more: &[&str]| desk.twin(&[&["tune", "cam", "rest.toml"], &limits[..], more].concat());
    let ramp = ["--ramp-in", "0,0", "--within", "2", "--minimise", "jerk"];
    for (kind, expected) in
        [("parabolic", 32.0 * 10.0 / 8.0), ("sigmoid", 4.0 * PI * PI * 10.0 / 8.0)]
    {
        let done = tune(&[&ramp[..], &["--ramp", kind, "--format", "json"]].concat());
        done.ended(0, "");
        let found = object(&done.stdout);
        for key in ["peak_jerk", "axis_jerk"] {
            let jerk = number(&found["ramp"][key]);
            assert!((jerk / expected - 1.0).abs() < 1e-5, "{kind} {key}: {jerk} {expected}");
        }
        assert_eq!(found["ramp"]["ramp"], kind);
        let done = tune(&[&ramp[..], &["--ramp", kind]].concat());
        assert!(done.stdout.contains("of the slave's axis: `max_jerk_…`"), "{}", done.stdout);
    }
    tune(&["--ramp-in", "0,-1e9"]).ended(1, "which is more than 3600 s");
    tune(&["--ramp-in", "0,0", "--minimise", "jerk"]).ended(2, "--within");
}
