//! `twin tune cam` and tappets: they keep their places on the master, in closed form.

use crate::desk::{Desk, number, shipped};
use crate::tuning::{LIFT, PICK, lift, noise, recording, through};
use serde_json::Value;

/// The shipped cam without its coupling.
fn pick_and_place() -> String {
    let text = shipped("examples/cams/pick_and_place.toml");
    text.split("# How the cam is used").next().expect("a begin").to_owned()
}

/// The shipped cam, in closed form.
fn pick(master: f64) -> f64 {
    through(&PICK, master)
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

/// Five sixths of the velocity that the shipped cam asks for.
const LIMITS: &str = "--max-velocity 478.125 --master-velocity 360";

impl Effect {
    /// Six turns at 360 deg/s, with a little noise, of a slave 5 ms behind and an output 12.3 ms behind its tappets.
    fn run(self) -> String {
        recording("time_s,master_deg,slave_mm,tappet_1", 3000, |index| {
            let time = f64::from(index) * 0.002 + 0.0007;
            let slave = pick(360.0 * (time - 0.005) + self.offset) + 0.04 * noise(index);
            let seen = 360.0 * (time - VALVE + self.ahead) + self.offset;
            let far = (self.off - self.on).rem_euclid(360.0);
            let output = u8::from((seen - self.on).rem_euclid(360.0) < far);
            format!("{time},{},{slave},{output}", 360.0 * time)
        })
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
    let tune = "tune cam pp.toml --run run.csv";
    let done = desk.twin(tune);
    done.ended(0, "");
    done.says_all(&[
        "tappet of group 1 at 8 → 9.8",
        "of the cam stays at master 8 deg",
        "{ group = 1, master =",
    ]);
    let found =
        desk.twin(&format!("{tune} --format json --write")).ended(0, "written to pp.toml").object();
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
    let text = desk.text("pp.toml");
    let now = Effect::of(&text);
    for line in pick_and_place().lines().filter(|line| !line.contains("{ group = ")) {
        assert!(text.contains(line), "{line}");
    }
    let checked = desk.twin("cam check pp.toml --format json").object();
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
    let done = desk.twin(&format!("{tune} --write"));
    done.ended(0, "");
    done.says("nothing is to be changed");
    assert!(!done.stdout.contains("tappet of group"), "{}", done.stdout);
    assert_eq!(desk.text("pp.toml"), text);
}

/// A cam that is a table has no text that could be edited: what was found is written as a new TOML file.
#[test]
fn other_forms_are_written_as_toml() {
    let desk = Desk::new();
    desk.write("pp.toml", &pick_and_place());
    desk.twin("cam convert pp.toml pp.csv").ended(0, "");
    let tune = format!("tune cam pp.csv --find master-scaling {LIMITS}");
    desk.twin(&format!("{tune} --write")).ended(2, "is written as .toml");
    desk.twin(&format!("{tune} --write new.toml")).ended(0, "written to new.toml");
    let text = desk.text("new.toml");
    assert!(text.contains("master_scaling = 0.8333"), "{text}");
}

/// 68 mm over 80 deg, from rest to rest, have y′ = 15/8 · 0.85 at most: 573.75 mm/s at 360 deg/s. 478.125 allow 5/6 of it, tappets
/// stand at 5/6 of where they stood, and a pass takes 6/5 · 360 deg.
#[test]
fn a_scaling_that_keeps_limits_leaves_tappets_where_they_are() {
    let desk = Desk::new();
    desk.write("pp.toml", &pick_and_place());
    let done =
        desk.twin(&format!("tune cam pp.toml --find master-scaling {LIMITS} --write new.toml"));
    done.ended(0, "written to new.toml");
    let part = 43.0 / 80.0 + 1.0 / 240.0_f64;
    let there = 80.0 - 68.0 * part.powi(3) * (10.0 - 15.0 * part + 6.0 * part * part);
    done.says_all(&[
        "tappet of group 1 at 8 → 6.66667 of the cam stays at master 8 deg",
        "tappet of group 1 at 268 → 223.333 of the cam stays at master 268 deg; the slave is at ",
        " mm there, it was at 12",
        "a pass of the cam takes 432 deg of the master, it took 360: with every further pass tappets come 72 deg later",
    ]);
    let told = done.stdout.split("the slave is at ").nth(1).and_then(|rest| rest.split(' ').next());
    let told: f64 = told.and_then(|text| text.parse().ok()).expect("a position");
    assert!((told - there).abs() < 1e-3, "{told} {there}");
    let checked = desk.twin("cam check new.toml --format json").object();
    for (index, at) in [8.0, 268.0, 268.0].into_iter().enumerate() {
        let master = number(&checked["tappets"][index]["master"]);
        assert!((master - at).abs() < 1e-6, "{checked}");
    }
    // With another stroke the master passes them where it did, and the slave is elsewhere, which is told.
    let done = desk.twin(&format!("tune cam pp.toml --find slave-scaling {LIMITS}"));
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
    let tune = "tune cam pp.toml --run run.csv --slave wanted";
    let done = desk.twin(tune);
    done.ended(0, "");
    done.says_all(&[
        "tappets belong to the motion of the cam and go with it:",
        "tappet of group 1 at 8 of the cam goes from master 8 to -1",
    ]);
    let found = desk.twin(&format!("{tune} --format json")).object();
    let tappet = &found["tappets"][1];
    assert_eq!(tappet["cam_after"], 268.0);
    let master = number(&tappet["master_after"]);
    assert!((master - 243.0).abs() < 0.01, "{tappet}");
    assert_eq!(found["lines"]["tappets"], Value::Array(Vec::new()));
}

/// Three seconds at 300 deg/s of the lift, 5 ms behind.
fn recorded() -> String {
    recording("time_s,master_deg,slave_mm", 1500, |index| {
        let time = f64::from(index) * 0.002;
        let slave = lift(300.0 * (time - 0.005)) + 0.02 * noise(index);
        format!("{time},{},{slave}", 300.0 * time)
    })
}

/// A cam that is passed once has no other end: 359 + 1.5 is not on it.
#[test]
fn a_tappet_that_would_leave_its_cam_is_told() {
    let desk = Desk::new();
    let once = LIFT.replace(", period = 100", "").replace("master = 200", "master = 359");
    desk.write("lift.toml", &once);
    // One turn.
    let turn: Vec<_> = recorded().lines().take(600).map(str::to_owned).collect();
    desk.write("run.csv", &turn.join("\n"));
    let done = desk.twin("tune cam lift.toml --run run.csv --write");
    done.ended(1, "the tappet of group 1 at 359 of the cam must move to 360.");
    done.ended(1, "is not periodic");
    assert_eq!(desk.text("lift.toml"), once);
    assert!(!done.stdout.contains("tappet of group"), "{}", done.stdout);
}
