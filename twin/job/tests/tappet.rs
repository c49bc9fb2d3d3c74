//! Tests of tappet switching along jobs and programs, against closed forms.
//!
//! Where the master has constant velocity, it passes a tappet at (tappet position − master position) / velocity, less
//! the dead time.

use super::first_cycle::coupled_by;
use super::{Job, block, job, machine};
use crate::check::{CheckOptions, Outcome, check};
use crate::limit::Limits;
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile};
use twin_machine::Machine;
use twin_machine::tappets::Switched;
use twin_planner::controller::Override;

fn outcome(machine: &Machine, program: &ProgramFile) -> Outcome {
    let options = CheckOptions { limits: Limits::Programmed, ..CheckOptions::default() };
    let outcome = check(machine, program, options, &mut |_| {}).unwrap();
    assert_eq!(outcome.findings, []);
    outcome
}

/// Group, on or off, time in ms and position of the master of every change.
fn changes(switched: &Switched) -> Vec<(i16, bool, i64, f64)> {
    assert_eq!(switched.left_out, 0);
    let changes = switched.switches.iter().map(|one| {
        let master = one.master.as_ref().unwrap().position;
        (switched.signals[one.signal].group, one.on, one.time_ns / 1_000_000, master)
    });
    changes.collect()
}

/// The cycle, ms, at whose end a time, s, is over.
#[expect(clippy::cast_possible_truncation, reason = "some seconds")]
fn cycle(seconds: f64) -> i64 {
    (seconds * 1e3 - 1e-6).ceil() as i64
}

fn assert_changes(switched: &Switched, expected: &[(i16, bool, f64)], master: impl Fn(f64) -> f64) {
    let found = changes(switched);
    let times: Vec<_> = found.iter().map(|(group, on, ms, _)| (*group, *on, *ms)).collect();
    let wanted: Vec<_> =
        expected.iter().map(|(group, on, seconds)| (*group, *on, cycle(*seconds))).collect();
    assert_eq!(times, wanted);
    for (_, _, ms, position) in found {
        #[expect(clippy::cast_precision_loss, reason = "some seconds")]
        let wanted = master(ms as f64 * 1e-3);
        assert!((position - wanted).abs() < 1e-6, "{position} at {ms} ms is not {wanted}");
    }
}

/// Flat, so that X stays; its tappets in every mode.
const CAM: &str = r#"
name = "flat"
master = { min = 0, max = 1000, unit = "mm" }
slave = { min = -1, max = 1, unit = "mm" }
elements = [{ master = 0, slave = 0 }, { master = 1000, slave = 0 }]
tappets = [
  { group = 1, master = 50.1, passage = "positive", action = "on" },
  { group = 1, master = 70.1, passage = "positive", action = "off" },
  { group = 1, master = 75.1, passage = "negative", action = "on" },
  { group = 2, master = 90.1, action = "invert" },
  { group = 2, master = 95.1, action = "invert" },
  { group = 7, master = 100.1, action = "timed", delay_us = 5200, duration_us = 20000 },
]
"#;

/// The web goes at 200 mm/s from 0.1 s and 10 mm on, so that it is at x at 0.1 s + (x − 10 mm) / 200 mm/s.
const JOB: &str = r#"
duration_s = 1
[[start]]
axis = "X"
position_mm = 0
[[virtual_axes]]
name = "web"
kind = "linear"
max_acceleration_mm_per_s2 = 2000
[[blocks]]
block = "MC_CamIn"
axis = "X"
master = "web"
cam = "flat.toml"
dead_time_s = 0.0
[[blocks]]
block = "MC_MoveVelocity"
axis = "web"
velocity_mm_per_s = 200
with_previous = true
"#;

fn passes(x: f64) -> f64 {
    0.1 + (x - 10.0) / 200.0
}

/// The switching times of the cam by the time at which the master passes a position.
fn expected(passes: impl Fn(f64) -> f64) -> [(i16, bool, f64); 6] {
    [
        (1, true, passes(50.1)),
        (1, false, passes(70.1)),
        (2, true, passes(90.1)),
        (2, false, passes(95.1)),
        (7, true, passes(100.1) + 5.2e-3),
        (7, false, passes(100.1) + 25.2e-3),
    ]
}

fn with_cam(text: &str) -> Job {
    job(text).with("flat.toml", CAM)
}

#[test]
fn tappets_of_a_job_switch_when_the_master_passes_them() {
    let switched = outcome(&machine(), &with_cam(JOB).program).tappets;
    let names: Vec<_> = switched.signals.iter().map(ToString::to_string).collect();
    assert_eq!(names, ["tappet 1 of X", "tappet 2 of X", "tappet 7 of X"]);
    assert_changes(&switched, &expected(passes), |time| 10.0 + 200.0 * (time - 0.1));
    assert_eq!(switched.counts, [2, 2, 2]);
    assert!(switched.switches.iter().all(|one| one.master.as_ref().unwrap().axis == "web"));
}

/// With a dead time every action of a tappet comes earlier by it; delays and durations stay. At half the pace positions are
/// passed after twice the time, and looked for as long before: a dead time is one of the outputs and the devices behind them.
#[test]
fn dead_time_is_compensated_at_any_pace() {
    for (factor, dead_time) in [(1.0, 0.0073), (0.5, 0.0073), (0.25, 0.0073), (0.5, 0.0)] {
        let key = format!("dead_time_s = {dead_time:?}");
        let job = with_cam(&JOB.replace("dead_time_s = 0.0", &key));
        let mut settings = ReadSettings::default();
        settings.inputs.override_factor = Override::new(factor).unwrap();
        let path = job.folder.path().join("job.toml");
        let program = ProgramFile::new(&path, Some(Dialect::Job), settings).unwrap();
        let switched = outcome(&machine(), &program).tappets;
        let early = |x: f64| passes(x) / factor - dead_time;
        assert_changes(&switched, &expected(early), |time| 10.0 + 200.0 * (factor * time - 0.1));
    }
}

/// There and back between 0 and 60 mm: within the hysteresis band around 50.1 mm the tappet acts once.
#[test]
fn hysteresis_holds_a_tappet_back() {
    let moves = |positions: &[f64], keys: &str| {
        let block = |position: &f64| {
            let keys = format!("position_mm = {position:?}; velocity_mm_per_s = 100");
            block("MC_MoveAbsolute", "web", &keys)
        };
        let head = JOB.replace("duration_s = 1\n", "").replace("dead_time_s = 0.0", keys);
        let (head, _) = head.split_once("[[blocks]]\nblock = \"MC_MoveVelocity\"").unwrap();
        let cam = CAM.replace("passage = \"positive\", action = \"on\"", "action = \"invert\"");
        let job = job(&[head.to_owned(), positions.iter().map(block).collect()].concat());
        let switched = outcome(&machine(), &job.with("flat.toml", &cam).program).tappets;
        changes(&switched).iter().map(|(_, on, _, _)| *on).collect::<Vec<_>>()
    };
    let around = [52.0, 49.0, 52.0];
    assert_eq!(moves(&around, "tappet_hysteresis_mm = 0.0"), [true, false, true]);
    assert_eq!(moves(&around, "tappet_hysteresis_mm = 4.0"), [true]);
    // Beyond the band it acts again.
    assert_eq!(moves(&[55.0, 45.0], "tappet_hysteresis_mm = 4.0"), [true, false]);
}

/// X at 90 mm/s with 500 mm/s² along a program: at 8.1 mm after 0.18 s, then at constant velocity.
#[test]
fn tappets_of_the_machine_file_switch_in_programs() {
    let (folder, machine) = coupled_by("Y", "slave_absolute = false\n", CAM);
    let program = folder.path().join("along.cnc");
    std::fs::write(&program, "% along\nN10 G1 X150 F90 E500 E-500\n").unwrap();
    let program =
        ProgramFile::new(&program, Some(Dialect::Din66025), ReadSettings::default()).unwrap();
    let found = outcome(&machine, &program);
    let start = machine.axes[0].from_si(found.start.unwrap()[0]);
    assert!(start.abs() < 1e-9, "{start}");
    let expected = expected(|x| 0.18 + (x - 8.1) / 90.0);
    assert_changes(&found.tappets, &expected, |time| 8.1 + 90.0 * (time - 0.18));
    let place = found.tappets.switches[0].place;
    assert_eq!((place.line, place.block), (2, Some(10)));
}

/// Off at the end, on at the begin of a cam of 100 mm: forwards a pass is over before the next one begins, so that the signal is on
/// from the first seam on; backwards, where both count negative passages, it has been switched off last. The order of the
/// lines changes nothing.
#[test]
fn a_pass_is_over_before_the_next_one_begins() {
    let tappet = |place: f64, passage: &str, action: &str| {
        format!(
            "{{ group = 1, master = {place:?}, passage = \"{passage}\", action = \"{action}\" }}"
        )
    };
    for swapped in [false, true] {
        for (passage, velocity, expected) in [
            ("positive", 200.0, vec![(1, true, 0.1 + (100.0 - 60.0) / 200.0)]),
            ("negative", -200.0, vec![]),
        ] {
            let mut both = [tappet(0.0, passage, "on"), tappet(100.0, passage, "off")];
            if swapped {
                both.reverse();
            }
            let cam =
                CAM.replace("max = 1000", "max = 100").replace("master = 1000", "master = 100");
            let (head, _) = cam.split_once("tappets").unwrap();
            let cam = format!("{head}tappets = [{}]\n", both.join(", "));
            // 10 mm until it is up.
            let way = JOB.replace("name = \"web\"\n", "name = \"web\"\nstart_mm = 50\n");
            let way = way.replace(
                "s = 200\n",
                &format!("s = {}\ndirection = \"{passage}\"\n", f64::abs(velocity)),
            );
            let outcome = outcome(&machine(), &job(&way).with("flat.toml", &cam).program);
            assert_changes(&outcome.tappets, &expected, |time| 60.0 + 200.0 * (time - 0.1));
        }
    }
}
