//! `twin tune cam` and tappets: they keep their places on the master, in closed form.

use crate::process::{Desk, number, object};
use crate::tune_least::LIFT;
use serde_json::Value;
use std::fmt::Write;

/// The shipped cam without its coupling.
fn pick_and_place() -> String {
    let path = crate::root().join("examples/cams/pick_and_place.toml");
    let text = std::fs::read_to_string(path).expect("shipped");
    text.split("# How the cam is used").next().expect("a begin").to_owned()
}

/// The shipped cam, from its points alone: from rest to rest between them.
fn pick(place: f64) -> f64 {
    let points = [
        [0.0, 0.0],
        [40.0, 0.0],
        [140.0, 80.0],
        [180.0, 80.0],
        [260.0, 12.0],
        [300.0, 12.0],
        [360.0, 0.0],
    ];
    let at = place.rem_euclid(360.0);
    let pair = points.windows(2).find(|pair| at < pair[1][0]).expect("on the cam");
    let part = (at - pair[0][0]) / (pair[1][0] - pair[0][0]);
    pair[0][1] + (pair[1][1] - pair[0][1]) * part.powi(3) * (10.0 - 15.0 * part + 6.0 * part * part)
}

/// What a machine has in effect: `MasterOffset`, the tappets of group 1, and what is compensated, s.
#[derive(Clone, Copy)]
struct Effect {
    offset: f64,
    on: f64,
    off: f64,
    ahead: f64,
}

const VALVE: f64 = 0.0123;

impl Effect {
    /// Six turns at 360 deg/s, with a little noise, of a slave 5 ms behind and an output 12.3 ms behind its tappets.
    fn run(self) -> String {
        let mut text = String::from("time_s,master_deg,slave_mm,tappet_1\n");
        for index in 0..3000_u32 {
            let time = f64::from(index) * 0.002 + 0.0007;
            let mixed = u64::from(index + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9) >> 40;
            let noise = f64::from(u32::try_from(mixed).expect("24 bits")) / 16_777_216.0 - 0.5;
            let slave = pick(360.0 * (time - 0.005) + self.offset) + 0.04 * noise;
            let seen = 360.0 * (time - VALVE + self.ahead) + self.offset;
            let far = (self.off - self.on).rem_euclid(360.0);
            let output = u8::from((seen - self.on).rem_euclid(360.0) < far);
            writeln!(text, "{time},{},{slave},{output}", 360.0 * time).expect("text");
        }
        text
    }

    /// What a cam's file has.
    fn of(text: &str) -> Self {
        let number = |line: &str, key: &str| -> f64 {
            let rest = line.split(key).nth(1).unwrap_or_else(|| panic!("no {key} in {line}"));
            let end = rest.find([',', '\n', ' ']).unwrap_or(rest.len());
            rest[..end].parse().unwrap_or_else(|error| panic!("{error}: {rest}"))
        };
        let line = |words: &str| text.lines().find(|line| line.contains(words)).expect("a line");
        Self {
            offset: number(text, "\nmaster_offset = "),
            on: number(line("# close the gripper"), "master = "),
            off: number(line("# open it"), "master = "),
            ahead: number(text, "\ndead_time_s = "),
        }
    }
}

/// A slave 1.8 deg behind gets `MasterOffset` 1.8, and the tappets of 8 and 268 stand at 9.8 and 269.8 then: the valve, whose
/// 12.3 ms are compensated, switches where the master is at 8, at every velocity. Another run changes nothing.
#[test]
fn a_slave_that_lags_leaves_tappets_where_they_are() {
    let desk = Desk::new();
    desk.write("pp.toml", &pick_and_place());
    desk.write("run.csv", &Effect { offset: 0.0, on: 8.0, off: 268.0, ahead: 0.0 }.run());
    let tune = ["tune", "cam", "pp.toml", "--run", "run.csv"];
    let done = desk.twin(&tune);
    done.ended(0, "");
    for words in [
        "tappet of group 1 at 8 → 9.8",
        "of the cam stays at master 8 deg",
        "{ group = 1, master =",
    ] {
        assert!(done.stdout.contains(words), "{words} in {}", done.stdout);
    }
    let done = desk.twin(&[&tune[..], &["--format", "json", "--write"]].concat());
    done.ended(0, "written to pp.toml");
    let found = object(&done.stdout);
    let offset = number(&found["coupling"]["master_offset"]);
    assert!((offset - 1.8).abs() < 0.01, "{offset}");
    for (index, at) in [8.0, 268.0, 268.0].into_iter().enumerate() {
        let tappet = &found["tappets"][index];
        for (key, expected) in [
            ("cam_before", at),
            ("cam_after", at + offset),
            ("master_before", at),
            ("master_after", at),
        ] {
            assert!((number(&tappet[key]) - expected).abs() < 1e-9, "{key} in {tappet}");
        }
    }
    let estimate = &found["fit"]["proposed"]["MasterOffset"];
    assert_eq!(
        estimate["half_width_95"],
        found["fit"]["estimates"]["MasterOffset"]["half_width_95"]
    );
    let dead = &found["dead_time"]["dead_time_s"];
    let half = number(&dead["half_width_95"]);
    assert!((number(&dead["value"]) - VALVE).abs() <= half && half < 0.002, "{dead}");
    // The file, comments kept, and what the check says of it.
    let text = std::fs::read_to_string(desk.path("pp.toml")).expect("there");
    let now = Effect::of(&text);
    for line in pick_and_place().lines().filter(|line| !line.contains("{ group = ")) {
        assert!(text.contains(line), "{line}");
    }
    let checked = object(&desk.twin(&["cam", "check", "pp.toml", "--format", "json"]).stdout);
    for (index, at) in [8.0, 268.0, 268.0].into_iter().enumerate() {
        let master = number(&checked["tappets"][index]["master"]);
        assert!((master - at).abs() < 1e-9, "{checked}");
    }
    // Where the valve switches: on its tappet, for what of its dead time is not compensated.
    for velocity in [10.0, 90.0, 360.0, 720.0] {
        let switches = now.on - now.offset + velocity * (VALVE - now.ahead);
        assert!((switches - 8.0).abs() <= velocity * half + 1e-9, "{switches} at {velocity}");
    }
    desk.write("run.csv", &now.run());
    let done = desk.twin(&[&tune[..], &["--write"]].concat());
    done.ended(0, "");
    assert!(done.stdout.contains("nothing is to be changed"), "{}", done.stdout);
    assert!(!done.stdout.contains("tappet of group"), "{}", done.stdout);
    assert_eq!(std::fs::read_to_string(desk.path("pp.toml")).expect("there"), text);
}

/// A cam that is a table has no text that could be edited: what was found is written as a new TOML file.
#[test]
fn other_forms_are_written_as_toml() {
    let desk = Desk::new();
    desk.write("pp.toml", &pick_and_place());
    desk.twin(&["cam", "convert", "pp.toml", "pp.csv"]).ended(0, "");
    let limits = ["--max-velocity", "478.125", "--master-velocity", "360"];
    let tune = [&["tune", "cam", "pp.csv", "--find", "master-scaling"][..], &limits].concat();
    desk.twin(&[&tune[..], &["--write"]].concat()).ended(2, "is written as .toml");
    desk.twin(&[&tune[..], &["--write", "new.toml"]].concat()).ended(0, "written to new.toml");
    let text = std::fs::read_to_string(desk.path("new.toml")).expect("written");
    assert!(text.contains("master_scaling = 0.8333"), "{text}");
}

/// 68 mm over 80 deg, from rest to rest, have y′ = 15/8 · 0.85 at most: 573.75 mm/s at 360 deg/s. 478.125 allow 5/6 of it, tappets
/// stand at 5/6 of where they stood, and a pass takes 6/5 · 360 deg.
#[test]
fn a_scaling_that_keeps_limits_leaves_tappets_where_they_are() {
    let desk = Desk::new();
    desk.write("pp.toml", &pick_and_place());
    let limits = ["--max-velocity", "478.125", "--master-velocity", "360"];
    let tune = ["tune", "cam", "pp.toml", "--find", "master-scaling"];
    let done = desk.twin(&[&tune[..], &limits, &["--write", "new.toml"]].concat());
    done.ended(0, "written to new.toml");
    let part = 43.0 / 80.0 + 1.0 / 240.0_f64;
    let there = 80.0 - 68.0 * part.powi(3) * (10.0 - 15.0 * part + 6.0 * part * part);
    for words in [
        "tappet of group 1 at 8 → 6.66667 of the cam stays at master 8 deg",
        "tappet of group 1 at 268 → 223.333 of the cam stays at master 268 deg; the slave is at ",
        " mm there, it was at 12",
        "a pass of the cam takes 432 deg of the master, it took 360: with every further pass tappets come 72 deg later",
    ] {
        assert!(done.stdout.contains(words), "{words} in {}", done.stdout);
    }
    let told = done.stdout.split("the slave is at ").nth(1).and_then(|rest| rest.split(' ').next());
    let told: f64 = told.and_then(|text| text.parse().ok()).expect("a position");
    assert!((told - there).abs() < 1e-3, "{told} {there}");
    let checked = object(&desk.twin(&["cam", "check", "new.toml", "--format", "json"]).stdout);
    for (index, at) in [8.0, 268.0, 268.0].into_iter().enumerate() {
        let master = number(&checked["tappets"][index]["master"]);
        assert!((master - at).abs() < 1e-6, "{checked}");
    }
    // With another stroke the master passes them where it did, and the slave is elsewhere, which is told.
    let tune = ["tune", "cam", "pp.toml", "--find", "slave-scaling"];
    let done = desk.twin(&[&tune[..], &limits].concat());
    done.ended(0, "");
    let words = "tappet of group 1 at 268 of the cam stays at master 268 deg; the slave is at 10 mm there, it was at 12";
    assert!(done.stdout.contains(words), "{words} in {}", done.stdout);
    assert!(!done.stdout.contains("{ group ="), "{}", done.stdout);
}

/// Of a motion that was taught tappets are a part: laid 25 deg earlier they come 25 deg earlier.
#[test]
fn tappets_go_with_a_motion_that_is_wanted() {
    let desk = Desk::new();
    desk.write("pp.toml", &pick_and_place());
    let taught = Effect { offset: 26.8, on: 8.0, off: 268.0, ahead: 0.0 };
    desk.write("run.csv", &taught.run());
    let tune = ["tune", "cam", "pp.toml", "--run", "run.csv", "--slave", "wanted"];
    let done = desk.twin(&tune);
    done.ended(0, "");
    for words in [
        "tappets belong to the motion of the cam and go with it:",
        "tappet of group 1 at 8 of the cam goes from master 8 to -1",
    ] {
        assert!(done.stdout.contains(words), "{words} in {}", done.stdout);
    }
    let found = object(&desk.twin(&[&tune[..], &["--format", "json"]].concat()).stdout);
    let tappet = &found["tappets"][1];
    assert_eq!(tappet["cam_after"], 268.0);
    let master = number(&tappet["master_after"]);
    assert!((master - 243.0).abs() < 0.01, "{tappet}");
    assert_eq!(found["lines"]["tappets"], Value::Array(Vec::new()));
}

/// The lift, from its points alone.
fn place(at: f64) -> f64 {
    let ease = |part: f64| part.powi(3) * (10.0 - 15.0 * part + 6.0 * part * part);
    match at.rem_euclid(360.0) {
        at if at < 120.0 => 70.0 * ease(at / 120.0),
        at if at < 180.0 => 70.0 + 30.0 * ease((at - 120.0) / 60.0),
        at => 100.0 - 100.0 * ease((at - 180.0) / 180.0),
    }
}

/// Three seconds at 300 deg/s of the lift, 5 ms behind.
fn lift() -> String {
    let mut text = String::from("time_s,master_deg,slave_mm\n");
    for index in 0..1500_u32 {
        let time = f64::from(index) * 0.002;
        let mixed = u64::from(index + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9) >> 40;
        let noise = f64::from(u32::try_from(mixed).expect("24 bits")) / 16_777_216.0 - 0.5;
        let slave = place(300.0 * (time - 0.005)) + 0.02 * noise;
        writeln!(text, "{time},{},{slave}", 300.0 * time).expect("text");
    }
    text
}

/// A cam that is passed once has no other end: 359 + 1.5 is not on it.
#[test]
fn a_tappet_that_would_leave_its_cam_is_told() {
    let desk = Desk::new();
    let once = LIFT.replace(", period = 100", "").replace("master = 200", "master = 359");
    desk.write("lift.toml", &once);
    // One turn.
    let turn: Vec<_> = lift().lines().take(600).map(str::to_owned).collect();
    desk.write("run.csv", &turn.join("\n"));
    let tune = ["tune", "cam", "lift.toml", "--run", "run.csv", "--write"];
    let done = desk.twin(&tune);
    done.ended(1, "the tappet of group 1 at 359 of the cam must move to 360.");
    done.ended(1, "is not periodic");
    assert_eq!(std::fs::read_to_string(desk.path("lift.toml")).expect("there"), once);
    assert!(!done.stdout.contains("tappet of group"), "{}", done.stdout);
}
