//! Tests of set-points from the job, probes, and changes of cams, against closed forms.

use super::{START, block as on, findings, job, machine, moves, near, only, run, time};
use super::{virtual_axis, x, x_at as at};
use crate::check::{CheckOptions, check};
use crate::finding::{Finding, Rule, Severity};

fn block(name: &str, keys: &str) -> String {
    on(name, "X", keys)
}

/// Set-points at points over time: `delta_s`, `position_mm` and `velocity_mm_per_s`, each if there is one.
fn points(points: &[(f64, Option<f64>, Option<f64>)]) -> String {
    let point = |(delta, position, velocity): &(f64, Option<f64>, Option<f64>)| {
        let key = |name: &str, value: &Option<f64>| {
            value.map_or(String::new(), |value| format!(", {name} = {value}"))
        };
        let place = key("position_mm", position) + &key("velocity_mm_per_s", velocity);
        format!("{{ delta_s = {delta}{place} }}")
    };
    format!("points = [{}]", points.iter().map(point).collect::<Vec<_>>().join(", "))
}

fn positions<const N: usize>(pairs: [(f64, f64); N]) -> String {
    points(&pairs.map(|(delta, position)| (delta, Some(position), None)))
}

fn velocities<const N: usize>(pairs: [(f64, f64); N]) -> String {
    points(&pairs.map(|(delta, velocity)| (delta, None, Some(velocity))))
}

fn both<const N: usize>(triples: [(f64, f64, f64); N]) -> String {
    points(&triples.map(|(delta, position, velocity)| (delta, Some(position), Some(velocity))))
}

/// The findings of a check.
fn checked(text: &str) -> Vec<Finding> {
    let outcome = check(&machine(), &job(text).program, CheckOptions::default(), &mut |_| {});
    outcome.unwrap().findings
}

/// Velocities on straight lines: to 100 mm/s in 0.2 s (10 mm), 0.3 s with that (30 mm), to rest in 0.1 s (5 mm).
#[test]
fn velocities_from_the_job_are_followed() {
    let points = velocities([(0.2, 100.0), (0.3, 100.0), (0.1, 0.0)]);
    for name in ["SMC_FollowVelocity", "SMC_ControlAxisByVel"] {
        let setpoints = moves(&(START.to_owned() + &block(name, &points)));
        near(at(&setpoints, 0.1)[0], 102.5, 1e-9);
        near(at(&setpoints, 0.1)[2], 500.0, 1e-6);
        near(at(&setpoints, 0.35)[1], 100.0, 1e-9);
        near(at(&setpoints, 0.5)[0], 140.0, 1e-9);
        near(x(setpoints.last().unwrap())[0], 145.0, 1e-9);
        near(time(setpoints.last().unwrap()), 0.6, 3e-3);
    }
}

/// On the cubic 100 mm + 40·(3s² − 2s³) mm in 0.4 s, and back; straight lines without velocities.
#[test]
fn positions_from_the_job_are_followed() {
    let points = both([(0.4, 140.0, 0.0), (0.4, 100.0, 0.0)]);
    for name in ["SMC_FollowPositionVelocity", "SMC_ControlAxisByPosVel"] {
        let setpoints = moves(&(START.to_owned() + &block(name, &points)));
        near(at(&setpoints, 0.1)[0], 100.0 + 40.0 * (3.0 / 16.0 - 2.0 / 64.0), 1e-9);
        // In the middle 1.5 times the mean of 100 mm/s.
        near(at(&setpoints, 0.2)[1], 150.0, 1e-6);
        near(at(&setpoints, 0.4)[0], 140.0, 1e-9);
        near(at(&setpoints, 0.6)[0], 120.0, 1e-9);
        near(x(setpoints.last().unwrap())[0], 100.0, 1e-9);
    }
    let points = positions([(0.5, 101.0), (0.1, 101.0)]);
    let setpoints = moves(&(START.to_owned() + &block("SMC_FollowPosition", &points)));
    near(at(&setpoints, 0.25)[0], 100.5, 1e-9);
    near(at(&setpoints, 0.25)[1], 2.0, 1e-6);
    near(x(setpoints.last().unwrap())[0], 101.0, 1e-9);
}

const GAPS: &str = "; gap_velocity_mm_per_s = 100; gap_acceleration_mm_per_s2 = 1000; gap_deceleration_mm_per_s2 = 1000";

/// A jump of 50 mm within a cycle is bridged at 100 mm/s with 1000 mm/s²: up and down in 0.1 s and 5 mm each, 40 mm between in
/// 0.4 s. The set-points wait meanwhile (`bStopIpo`).
#[test]
fn jumps_of_watched_setpoints_are_bridged() {
    let jump = |hold: f64| positions([(0.001, 150.0), (hold, 150.0)]);
    let bridged = |hold: f64| {
        let keys = jump(hold) + GAPS;
        moves(&(START.to_owned() + &block("SMC_ControlAxisByPos", &keys)))
    };
    let setpoints = bridged(0.2);
    near(at(&setpoints, 0.1)[0], 105.0, 1e-6);
    near(at(&setpoints, 0.3)[1], 100.0, 1e-9);
    near(at(&setpoints, 0.6)[0], 150.0, 1e-6);
    near(time(setpoints.last().unwrap()), 0.8, 5e-3);
    // A hold of 1 s begins when the jump is bridged (manual 2.2.5: the interpolator waits until then).
    let setpoints = bridged(1.0);
    near(time(setpoints.last().unwrap()), 1.6, 5e-3);
    near(x(setpoints.last().unwrap())[0], 150.0, 1e-9);
    // Without supervision it is a jump, which the check reports.
    let setpoints = moves(&(START.to_owned() + &block("SMC_FollowPosition", &jump(0.2))));
    near(at(&setpoints, 0.001)[0], 150.0, 1e-9);
}

/// A line of 40 mm/s from rest is more than the 3000 mm/s² of X for a cycle of 1 ms. The first set-point is 0.04 mm away, which
/// takes 2·√(0.04/3000) s from rest to rest; then the set-points come to 40 mm/s in 40/3000 s, which costs half of that.
#[test]
fn watched_lines_do_not_stutter() {
    let points = positions([(1.0, 100.0), (0.1, 100.0)]);
    let start = "[[start]]\naxis = \"X\"\nposition_mm = 60\n";
    let text = start.to_owned() + &block("SMC_ControlAxisByPos", &points);
    let setpoints = moves(&text);
    let lost = 2.0 * (0.04_f64 / 3000.0).sqrt() + 0.5 * 40.0 / 3000.0;
    near(time(setpoints.last().unwrap()), 1.1 + lost, 5e-3);
    near(at(&setpoints, 0.5)[0], 60.0 + 40.0 * (0.5 - lost), 40.0 * 2e-3);
    near(at(&setpoints, 0.5)[1], 40.0, 1e-6);
    near(x(setpoints.last().unwrap())[0], 100.0, 1e-9);
    for setpoint in setpoints.iter().filter(|one| time(one) < 1.0) {
        assert!(x(setpoint)[2].abs() <= 3000.0 * (1.0 + 1e-6), "{:?}", x(setpoint));
        assert!((-1e-9..=40.0 + 1e-6).contains(&x(setpoint)[1]), "{:?}", x(setpoint));
    }
    // From 40 mm/s to rest within a cycle, the end of the line is not a jump (manual 2.2.5), but no axis can follow it:
    // that is reported.
    let findings = checked(&text);
    let found = findings.iter().find(|one| one.rule == Rule::AxisAcceleration);
    let found = found.unwrap_or_else(|| panic!("{findings:?}"));
    assert_eq!((found.severity, found.axis.as_deref()), (Severity::Error, Some("X")));
    assert_eq!(found.line, 5, "{found:?}");
}

/// Behind the jump of [`jumps_of_watched_setpoints_are_bridged`], 0.6 s, set-points that move on with 40 mm/s at once: they come
/// to that within the acceleration. With velocities they end at rest, in 0.1 s with 400 mm/s², and there is no finding.
#[test]
fn setpoints_that_move_on_behind_a_jump_come_to_speed() {
    let lines = positions([(0.001, 150.0), (1.0, 190.0)]);
    let cubics = both([(0.001, 150.0, 40.0), (1.0, 190.0, 40.0), (0.1, 192.0, 0.0)]);
    let lost = 0.5 * 40.0 / 3000.0;
    for (name, points, end, takes) in [
        ("SMC_ControlAxisByPos", lines, 190.0, 1.6),
        ("SMC_ControlAxisByPosVel", cubics, 192.0, 1.7),
    ] {
        let text = START.to_owned() + &block(name, &(points + GAPS));
        let setpoints = moves(&text);
        near(time(setpoints.last().unwrap()), takes + lost, 6e-3);
        near(at(&setpoints, 0.3)[1], 100.0, 1e-9);
        near(at(&setpoints, 1.1)[0], 150.0 + 40.0 * (0.5 - lost), 40.0 * 5e-3);
        near(at(&setpoints, 1.1)[1], 40.0, 1e-6);
        near(x(setpoints.last().unwrap())[0], end, 1e-9);
        for setpoint in setpoints.iter().filter(|one| time(one) < 1.6) {
            let [_, velocity, acceleration] = x(setpoint);
            assert!(velocity >= -1e-9, "{name} {}: {velocity}", time(setpoint));
            assert!(acceleration.abs() <= 3000.0 * (1.0 + 1e-6), "{name} {acceleration}");
        }
        if name == "SMC_ControlAxisByPosVel" {
            let found = checked(&text);
            assert!(found.iter().all(|one| one.rule != Rule::AxisAcceleration), "{found:?}");
        }
    }
}

/// Behind set-points an axis moves on from the last of them.
#[test]
fn the_next_block_takes_over_from_setpoints() {
    let follow = block("SMC_FollowVelocity", &velocities([(0.2, 100.0), (0.2, 0.0)]));
    let back = block("MC_MoveRelative", "distance_mm = -20; velocity_mm_per_s = 100");
    let setpoints = moves(&[START, &follow, &back].concat());
    near(x(setpoints.last().unwrap())[0], 100.0, 1e-9);
}

/// From 100 mm at 200 mm/s with 1000 mm/s², of which 20 mm and 0.2 s get it to speed: at 150 mm after 0.35 s.
#[test]
fn a_probe_records_where_its_trigger_comes() {
    let head = "[[triggers]]\nname = \"time\"\nat_s = 0.35\n[[triggers]]\nname = \"place\"\naxis = \"X\"\nposition_mm = 150\n";
    let far = super::FAR_RIGHT.to_owned() + "; with_previous = true";
    let with = |probe: &str| {
        let probe = block("MC_TouchProbe", &format!("trigger = {probe}"));
        [head, START, &probe, &block("MC_MoveRelative", &far)].concat()
    };
    for name in ["\"time\"", "\"place\""] {
        let (setpoints, findings) = run(&job(&with(name)), &machine());
        let note = only(&findings);
        assert_eq!((note.rule, note.severity), (Rule::FunctionBlock, Severity::Note));
        assert_eq!((note.line, note.axis.as_deref()), (7 + 6 + 2, Some("X")));
        let words: Vec<_> = note.message.split(' ').collect();
        let position: f64 = words[words.len() - 2].parse().unwrap();
        // Within two cycles of 0.2 mm.
        near(position, 150.0, 0.4 + 1e-9);
        near(x(setpoints.last().unwrap())[0], 200.0, 1e-9);
    }
    // Outside its window the trigger does not count: the probe waits until another block releases the trigger.
    let waits = with("\"place\"; first_position_mm = 160; last_position_mm = 170");
    let found = findings(&waits);
    assert!(found[0].message.contains("waits for ever"), "{found:?}");
    assert_eq!(findings(&(waits + &block("MC_AbortTrigger", "trigger = \"place\""))), []);
    // A trigger that no block waits for (410).
    let found = findings(&(head.to_owned() + &block("MC_AbortTrigger", "trigger = \"time\"")));
    assert!(found[0].message.contains("SMC_AT_TRIGGERNOTOCCUPIED"), "{found:?}");
    assert!(found.iter().all(|one| one.severity != Severity::Note));
}

/// Without a direction an axis goes on in the direction of its last motion (manual 5.3: `current`), forwards before the first.
#[test]
fn a_velocity_without_a_direction_goes_on_as_before() {
    let rates = "velocity_mm_per_s = 100; acceleration_mm_per_s2 = 1000";
    let on = block("MC_MoveVelocity", rates) + &block("MC_Halt", "deceleration_mm_per_s2 = 1000");
    for (distance, end) in [(20.0, 1.0), (-20.0, -1.0), (0.0, 1.0)] {
        let first = block("MC_MoveRelative", &format!("distance_mm = {distance}; {rates}"));
        let first = if distance == 0.0 { String::new() } else { first };
        let setpoints = moves(&[START, &first, &on].concat());
        // 5 mm up and 5 mm down, and a cycle or two between.
        near(x(setpoints.last().unwrap())[0], 100.0 + distance + end * 10.0, 0.3);
    }
}

/// Cams that fit each other at their ends: 0 to 30 mm in the first turn with 30 mm a turn, and in the second on to 90 mm with
/// 60 mm a turn at its end; the slave follows the first one until its `EndOfProfile` and the other one from that cycle on.
#[test]
fn cams_are_switched_between_at_the_end_of_the_profile() {
    let keys = "period_deg = 360; max_acceleration_deg_per_s2 = 36000";
    let head = format!("duration_s = 3\n{}{START}", virtual_axis("shaft", "rotary", keys));
    let [one, two] = ["one.cam.toml\"", "two.cam.toml\"; at_end_of_profile = true"].map(|cam| {
        let keys = "master = \"shaft\"; slave_absolute = false; periodic = false";
        block("MC_CamIn", &format!("{keys}; cam = \"{cam}"))
    });
    let turn = on("MC_MoveVelocity", "shaft", "velocity_deg_per_s = 360; at_s = 0");
    // The master's block between the two, too.
    for blocks in [format!("{one}{two}{turn}"), format!("{one}{turn}{two}")] {
        switches_at_the_end(&(head.clone() + &blocks));
    }
    let between = format!("{head}{one}{}{turn}{two}", block("MC_Halt", "at_s = 0.1"));
    let found = findings(&between);
    let words = "what moves axis \"X\" before this block";
    assert!(found.iter().any(|one| one.message.contains(words)), "{found:?}");
}

/// The two cams of `text` without a stop or a jump.
fn switches_at_the_end(text: &str) {
    let cam = |name: &str, from: f64, to: f64| {
        format!(
            "name = \"{name}\"\nmaster = {{ min = 0, max = 360, unit = \"deg\" }}\n\
             slave = {{ min = 0, max = 100, unit = \"mm\" }}\n\
             elements = [{{ master = 0, slave = 0, velocity = {} }}, {{ master = 360, slave = {}, velocity = {} }}]\n",
            from / 360.0,
            f64::midpoint(from, to),
            to / 360.0
        )
    };
    let job = job(text)
        .with("one.cam.toml", &cam("one", 30.0, 30.0))
        .with("two.cam.toml", &cam("two", 30.0, 60.0));
    let (setpoints, findings) = run(&job, &machine());
    assert_eq!(findings, []);
    // At 360°/s after 10 ms: at 1.8°, so that a turn is over 0.995 s later.
    let turn = |seconds: f64| seconds - 0.005;
    near(at(&setpoints, 0.8)[0], 100.0 + 30.0 * turn(0.8), 0.04);
    near(at(&setpoints, 0.8)[1], 30.0, 1e-3);
    // No stop and no jump where they change.
    for pair in setpoints.windows(2).filter(|pair| (0.1..1.9).contains(&time(&pair[0]))) {
        let [before, after] = [x(&pair[0]), x(&pair[1])];
        near(after[0] - before[0], 1e-3 * f64::midpoint(before[1], after[1]), 2e-3);
        assert!(after[1] > 29.0 && (after[1] - before[1]).abs() < 0.5, "{before:?} {after:?}");
    }
    // Another turn later it is at the end of the second one, 45 mm on: 30 + 30 to 60.
    near(x(setpoints.last().unwrap())[0], 100.0 + 30.0 + 45.0, 0.1);
}
