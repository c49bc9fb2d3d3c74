//! `twin tune cam` as a process, on runs whose true values are known.

use crate::desk::{Desk, number};
use crate::tuning::{LIFT, lift, noise, recording};
use std::fmt::Write;

/// Three seconds at 400 deg/s, with a little noise: `MasterOffset` 25, `SlaveOffset` −4, tappets 8 ms late.
fn recorded() -> String {
    recording("time_s,master_deg,slave_mm,tappet_1", 1500, |index| {
        let time = f64::from(index) * 0.002 + 0.0007;
        let master = 400.0 * time;
        let seen = (400.0 * (time - 0.008) + 25.0).rem_euclid(360.0);
        let output = u8::from((50.0..200.0).contains(&seen));
        format!("{time},{master},{},{output}", lift(master + 25.0) - 4.0 + 0.1 * noise(index))
    })
}

#[test]
fn a_run_tells_offsets_and_the_dead_time() {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    desk.write("run.csv", &recorded());
    let tune = "tune cam lift.toml --run run.csv --slave wanted";
    let found = desk.twin(&format!("{tune} --format json -o fit.svg")).ended(0, "").object();
    for (name, truth) in [("MasterOffset", 25.0), ("SlaveOffset", -4.0)] {
        let estimate = &found["fit"]["estimates"][name];
        let (value, half) = (estimate["value"].as_f64(), estimate["half_width_95"].as_f64());
        let (value, half) = (value.expect("a value"), half.expect("an interval"));
        assert!((value - truth).abs() < 0.05 && half > 0.0 && half < 0.1, "{name}: {estimate}");
    }
    let dead = number(&found["dead_time"]["dead_time_s"]["value"]);
    assert!((dead - 0.008).abs() < 0.001, "{dead}");
    let picture = desk.text("fit.svg");
    for word in ["before", "after", "recorded", "error of the slave"] {
        assert!(picture.contains(word), "{word}");
    }
    // Nothing was written, and what is written keeps comments and is what was found.
    let text = || desk.text("lift.toml");
    assert_eq!(text(), LIFT);
    desk.twin(tune)
        .ended(0, "")
        .says("nothing is written without --write")
        .says("MasterOffset := ");
    desk.twin(&format!("{tune} --write")).ended(0, "written to lift.toml");
    let after = text();
    assert!(after.starts_with(LIFT) && after.contains("\n[coupling]\nmaster_offset = "), "{after}");
    // Another time there is nothing left to be found: the error is the noise.
    let again = desk.twin(&format!("{tune} --format json")).object();
    let (before, now) = (&again["fit"]["rms_before"], &again["fit"]["rms_after"]);
    assert!(
        (before.as_f64().expect("rms") - now.as_f64().expect("rms")).abs() < 1e-6,
        "{before} {now}"
    );
}

/// Twenty samples do not show whether their noise is independent, which is said; two hundred show it. What the slave is rounded to is
/// said.
#[test]
fn what_few_samples_do_not_show_is_said() {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    let run = |count: u32, step: f64| {
        desk.write(
            "run.csv",
            &recording("time_s,master_deg,slave_mm", count, |index| {
                let master = 720.0 * f64::from(index) / f64::from(count);
                let slave = lift(master + 25.0) - 4.0 + 0.1 * noise(index);
                let slave = if step > 0.0 { (slave / step).round() * step } else { slave };
                format!("{},{master},{slave}", master / 400.0)
            }),
        );
        let done = desk.twin("tune cam lift.toml --run run.csv --slave wanted");
        done.ended(0, "");
        done.stdout.clone()
    };
    let independent = "assume noise that is independent from sample to sample";
    let said = run(20, 0.0);
    assert!(
        said.contains(&format!("intervals of 20 samples (fewer than 50) {independent}")),
        "{said}"
    );
    let said = run(200, 2.0);
    assert!(said.contains("rounded to 2 mm"), "{said}");
    let said = run(200, 0.0);
    assert!(!said.contains(independent), "{said}");
}

/// A slave that is now 1° late and now not, for a hundred samples each, contradicts any one offset: no interval is told, and
/// nothing is proposed or written.
#[test]
fn a_slave_that_does_something_else_is_told() {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    desk.write(
        "run.csv",
        &recording("time_s,master_deg,slave_mm", 600, |index| {
            let master = 1.8 * f64::from(index);
            let late = f64::from(index / 100 % 2);
            format!("{},{master},{}", master / 400.0, lift(master - late))
        }),
    );
    let find = "--find master-offset,slave-offset,slave-scaling";
    let done = desk.twin(&format!("tune cam lift.toml --run run.csv --write {find}"));
    done.ended(1, "the slave does something that the cam does not describe");
    assert!(done.stderr.contains("MasterOffset -0.49"), "{}", done.stderr);
    assert!(!done.stdout.contains("95 %") && !done.stdout.contains(":="), "{}", done.stdout);
    assert_eq!(desk.text("lift.toml"), LIFT);
}

/// Units that the header names are those of the cam.
#[test]
fn a_run_in_other_units_is_told() {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    desk.write("run.csv", &recorded().replacen("master_deg", "master_mm", 1));
    desk.twin("tune cam lift.toml --run run.csv")
        .ended(2, "column `master_mm`: the master of the cam is in deg");
    desk.write("run.csv", &recorded().replacen("master_deg,slave_mm", "master_u,slave", 1));
    desk.twin("tune cam lift.toml --run run.csv --slave wanted").ended(0, "");
}

/// A slave 5 ms behind at 400 deg/s is lift(master − 2): `MasterOffset` 2 undoes it, and with that in effect nothing is left.
#[test]
fn a_slave_that_lags_gets_an_offset_that_leads() {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    let run = |in_effect: f64| {
        let run = recording("time_s,master_deg,slave_mm", 1500, |index| {
            let time = f64::from(index) * 0.002;
            // The noise of `recorded`, without which what rounding leaves over would be no noise.
            let slave = lift(400.0 * (time - 0.005) + in_effect) + 0.1 * noise(index);
            format!("{time},{},{slave}", 400.0 * time)
        });
        desk.write("run.csv", &run);
    };
    let tune = "tune cam lift.toml --run run.csv";
    run(0.0);
    let found = desk.twin(&format!("{tune} --write --format json"));
    let found = found.ended(0, "written to lift.toml").object();
    let offset = number(&found["coupling"]["master_offset"]);
    assert!((offset - 2.0).abs() < 0.02, "{found}");
    run(offset);
    let before = desk.text("lift.toml");
    assert!(before.contains("wanted_master_offset = 0"), "{before}");
    desk.twin(tune).ended(0, "").says("nothing is to be changed");
}

#[test]
fn what_the_data_do_not_say_is_said() {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    let run = |rows: std::ops::Range<u32>, slave: fn(u32) -> f64| {
        let mut text = String::from("time,master,slave\n");
        for index in rows {
            let master = f64::from(index) * 3.0;
            writeln!(text, "{},{master},{}", f64::from(index) * 0.01, slave(index)).expect("text");
        }
        text
    };
    desk.write("few.csv", &run(0..7, |index| lift(f64::from(index) * 3.0)));
    let tune = |name: &str| desk.twin(&format!("tune cam lift.toml --run {name} --write new.toml"));
    tune("few.csv").ended(1, "7 samples are too few for 2 unknowns");
    // The coupling slipped by 10 half way.
    desk.write(
        "slip.csv",
        &run(0..400, |index| lift(f64::from(index) * 3.0 + if index < 200 { 0.0 } else { 10.0 })),
    );
    tune("slip.csv").ended(1, "contradict each other");
    desk.write("other.csv", &run(0..400, |index| f64::from(index * 7919 % 1000)));
    tune("other.csv").ended(1, "offsets and scalings");
    // The way of another master, twice as fast in the middle.
    desk.write(
        "another.csv",
        &run(0..400, |index| lift(f64::from(index) * 3.0 + 6.0 * (f64::from(index) * 0.05).sin())),
    );
    tune("another.csv").ended(1, "no interval would be valid");
    assert!(!desk.path("new.toml").exists());
    desk.write("wrong.csv", "time,master,slave\n0,1,2\n0,2,3\n");
    tune("wrong.csv").ended(2, "wrong.csv: line 3: time 0 s is not later");
}

/// Onto a cam that rests at 10 mm, from 0: 10/2 + 2/1 s with 2 mm/s and 1 mm/s².
#[test]
fn a_ramp_and_what_it_takes() {
    let desk = Desk::new();
    desk.write("rest.toml", "name = \"rest\"\nmaster = { min = 0, max = 100 }\nslave = { min = 0, max = 20, period = 20 }\nelements = [{ master = 0, slave = 10 }]\n");
    let tune = "tune cam rest.toml --max-velocity 2 --max-acceleration 1 --ramp-in 0,0";
    let found = desk.twin(&format!("{tune} --format json")).ended(0, "").object();
    let duration = number(&found["ramp"]["duration_s"]);
    assert!((duration - 7.0).abs() < 1e-5, "{duration}");
    desk.twin(&format!("{tune} --within 8 --write")).ended(0, "written to rest.toml");
    let text = desk.text("rest.toml");
    for key in
        ["velocity_difference = ", "acceleration = ", "deceleration = ", "start_mode = \"ramp_in\""]
    {
        assert!(text.contains(key), "{text}");
    }
    desk.twin(&format!("{tune} --within 1")).ended(1, "not within 1 s");
    // 1 mm/s³: 1 s longer, each ramp takes 2/1 + 1/1 s on 3 mm.
    let parabolic = format!("{tune} --ramp parabolic");
    let found = desk.twin(&format!("{parabolic} --max-jerk 1 --format json")).ended(0, "").object();
    let duration = number(&found["ramp"]["duration_s"]);
    assert!((duration - 8.0).abs() < 1e-5, "{duration}");
    desk.twin(&parabolic).ended(2, "a ramp needs a limit of the slave's jerk");
}

/// The limit of the jerk is one of ramp and cam together: the axis's own is less by what the cam needs, and is told.
#[test]
fn a_ramp_and_its_cam_keep_the_jerk_together() {
    let desk = Desk::new();
    let limits =
        "--max-velocity 900 --max-acceleration 20000 --max-jerk 380000 --master-velocity 360";
    let tune = |more: &str| {
        let tune = "tune cam examples/cams/pick_and_place.toml --ramp-in 60,35,100";
        desk.twin(&format!("{tune} --ramp parabolic {limits} {more}"))
    };
    let ramp = &tune("--format json").ended(0, "").object()["ramp"];
    let [both, axis] = ["peak_jerk", "axis_jerk"].map(|name| ramp[name].as_f64().expect("a jerk"));
    let limit = 380_000.0;
    assert!(both <= limit * (1.0 + 1e-9) && axis < limit, "{both} {axis}");
    tune("--within 0.5").says("of the slave's axis: `max_jerk_…`");
    tune("--within 1 --minimise jerk").ended(0, "").says("ramp: on the cam after");
}

/// What is asked for in vain, and a sample that a sensor spoilt, are said so that it is clear what to do.
#[test]
fn mistakes_are_told() {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    let tune = |more: &str| desk.twin(&format!("tune cam lift.toml {more}"));
    tune("--find slave-scaling").ended(2, "none is given");
    tune("--ramp-in 0,35").ended(2, "a ramp needs a limit of the slave's velocity");
    desk.twin("cam check lift.toml --master-velocity -5")
        .ended(2, "-5 is less than 0: give the master's velocity without its sign");
    // 0 to 100 into 0 to 70.
    tune("--find slave-scaling --position-min 0 --position-max 70")
        .ended(0, "")
        .says("  slave_scaling = 0.7\n");
    let text = recorded();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let cells: Vec<_> = lines[700].split(',').map(str::to_owned).collect();
    let slave: f64 = cells[2].parse().expect("a number");
    lines[700] = format!("{},{},{},{}", cells[0], cells[1], slave + 5.0, cells[3]);
    desk.write("run.csv", &lines.join("\n"));
    tune("--run run.csv").ended(1, "line 701 (by ").ended(1, "the slave is far from");
    let still: Vec<_> =
        (0..60).map(|index| format!("{},90,{}", 0.01 * f64::from(index), 3)).collect();
    desk.write("still.csv", &format!("time,master,slave\n{}\n", still.join("\n")));
    tune("--run still.csv").ended(1, "the master is at 90 in all 60 samples");
}

/// Outputs of a group that the cam has not, two groups of different dead times, and a master in radians.
#[test]
fn recordings_of_something_else_are_told() {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    let tune = |name: &str| desk.twin(&format!("tune cam lift.toml --run {name}"));
    desk.write("nine.csv", &recorded().replace("tappet_1", "tappet_9"));
    tune("nine.csv")
        .ended(1, "the run has outputs of group 9 (`tappet_9`)")
        .ended(1, "its tappets are of group 1");
    let text = recording("time_s,master,slave_mm", 600, |index| {
        let (time, master) = (f64::from(index) * 0.005, f64::from(index) * 2.0);
        format!("{time},{},{}", master.to_radians(), lift(master))
    });
    desk.write("rad.csv", &text);
    tune("rad.csv").ended(1, "offsets and scalings: the data do not ");
    desk.write("named.csv", &text.replacen("master", "master_rad", 1));
    tune("named.csv").ended(2, "column `master_rad`: the master of the cam is in deg");
    let group = "{ group = 1, master = 200, passage = \"positive\", action = \"off\" },";
    let other = group.replace("group = 1", "group = 2");
    let on = other.replace("200", "80").replace("off", "on");
    desk.write("two.toml", &LIFT.replace(group, &format!("{group}\n  {on}\n  {other}")));
    desk.write(
        "two.csv",
        &recording("time_s,master_deg,slave_mm,tappet_1,tappet_2", 4000, |index| {
            let time = f64::from(index) * 0.001;
            let (master, at) =
                (400.0 * time, |late: f64| (400.0 * (time - late)).rem_euclid(360.0));
            let one = u8::from((50.0..200.0).contains(&at(0.005)));
            let two = u8::from((80.0..200.0).contains(&at(0.040)));
            format!("{time},{master},{:.4},{one},{two}", lift(master))
        }),
    );
    let done = desk.twin("tune cam two.toml --run two.csv --write new.toml");
    done.ended(1, "group 1 switches 0.00").ended(1, "group 2 switches 0.0");
    assert!(!done.stdout.contains("DeadTimeCompensation :=") && !desk.path("new.toml").exists());
}

/// The velocity that a picture of a cam calls allowed is, and each group of tappets has its own colour in the legend.
#[test]
fn a_picture_says_what_the_check_allows() {
    let desk = Desk::new();
    let more = "{ group = 2, master = 90, action = \"on\" }, { group = 2, master = 95, action = \"off\" },\n]\n";
    desk.write("lift.toml", &(LIFT.trim_end().trim_end_matches(']').to_owned() + more));
    for limit in ["1234", "3210", "4444", "977"] {
        let limit = format!("--max-velocity {limit}");
        desk.twin(&format!("cam plot lift.toml -o lift.svg {limit}")).ended(0, "");
        let picture = desk.text("lift.svg");
        let said = picture.split("at most ").nth(1).and_then(|rest| rest.split(' ').next());
        let said = said.expect("a velocity");
        desk.twin(&format!("cam check lift.toml --master-velocity {said} {limit}")).ended(0, "");
        for group in [1, 2] {
            assert!(picture.contains(&format!("tappets of group {group} that are on")));
        }
    }
}

/// The picture of a ramp shows the start: what the slave does before and after, its cam, and the limits. The values of the cam's file
/// take 10 u with 2 u/s and 1 u/s² in 7 s, those that are found with 4 u/s² in 5 + 0.5 s.
#[test]
fn the_picture_of_a_ramp_shows_the_start() {
    let desk = Desk::new();
    let cam = |coupling: &str| {
        desk.write(
            "rest.toml",
            &format!(
                "master = {{ min = 0, max = 360, unit = \"deg\" }}\nslave = {{ unit = \"mm\" }}\n\
                 elements = [{{ master = 0, slave = 10 }}, {{ master = 360, slave = 10 }}]\n{coupling}"
            ),
        );
    };
    let limits = "--master-velocity 30 --max-velocity 2 --max-acceleration 4";
    let tune = |more: &str| {
        let tune = "tune cam rest.toml --ramp-in 90,0 -o ramp.svg";
        desk.twin(&format!("{tune} {limits} {more}")).ended(0, "");
        desk.text("ramp.svg")
    };
    let values = "velocity_difference = 2\nacceleration = 1\ndeceleration = 1\n";
    cam(&format!("[coupling]\nstart_mode = \"ramp_in\"\n{values}"));
    desk.twin(&format!("tune cam rest.toml --ramp-in 90,0 -o ramp.png {limits}"))
        .ended(2, "ramp.png: pictures are SVG");
    assert!(!desk.path("ramp.png").exists());
    let picture = tune("");
    for word in [
        "start onto",
        "before: with the ramp, on its cam after 7 s",
        "after: with the ramp, on its cam after 5.5 s",
        "time (s); the master goes on from 90 deg with 30 deg/s",
        "position",
        "velocity",
        "acceleration",
        "(mm/s²)",
        "limit",
        // What the slave reaches: before, and after.
        "-1 … 1",
        "-4 … 4",
    ] {
        assert!(picture.contains(word), "{word}");
    }
    // Two curves in each row; the cam and the limits are dashed.
    let lines = picture.lines().filter(|line| line.starts_with("<polyline"));
    let (dashed, solid): (Vec<_>, Vec<_>) = lines.partition(|line| line.contains("dasharray"));
    assert_eq!((solid.len(), dashed.len()), (6, 3));
    let limits = picture.lines().filter(|line| line.starts_with("<line"));
    assert!(limits.filter(|line| line.contains("dasharray")).count() >= 4);
    assert!(!picture.contains("jerk"), "the cam's own picture");

    cam("");
    assert!(tune("").contains("before: without a ramp, a jump"));
}

/// The jerk of the master counts for the check: 70 mm over 120 deg, from rest to rest, have their greatest y′ half way, 1.875 ·
/// 70/120, so that 200,000 deg/s³ alone make 218,750 mm/s³ of the slave, and no velocity is slow enough.
#[test]
fn the_check_counts_the_jerk_of_the_master() {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    let check = "cam check lift.toml --format json --max-jerk 60000";
    let reason =
        desk.twin(&format!("{check} --master-jerk 200000")).object()["largest_master"]["reason"]
            .to_string();
    assert!(reason.contains("the slave's jerk reaches 218750 at master 60"), "{reason}");
}
