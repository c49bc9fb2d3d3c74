//! Tests of the end of jobs and of the defaults of block inputs, against closed forms.

use super::{START, block as on, findings, job, machine, moves, near, only, run, shaft, time};
use super::{virtual_axis, x};
use crate::finding::{Rule, Severity};
use crate::setpoint::AxisSetpoint;

fn ends(setpoints: &[AxisSetpoint]) -> f64 {
    let last = setpoints.last().unwrap();
    let motion = &last.axes;
    assert!(motion.velocity.iter().chain(motion.acceleration.iter()).all(|value| *value == 0.0));
    time(last)
}

fn block(name: &str, keys: &str) -> String {
    on(name, "X", keys)
}

/// X brakes with its 3000 mm/s² as soon as `duration_s` is over, from the velocity that its set-points have then.
#[test]
fn setpoints_are_halted_at_the_end_of_the_job() {
    let velocities = "points = [{ delta_s = 0.2, velocity_mm_per_s = 100 }, { delta_s = 3, velocity_mm_per_s = 100 }, \
                      { delta_s = 0.2, velocity_mm_per_s = 0 }]";
    let positions = "points = [{ delta_s = 10, position_mm = 300 }]";
    let both = "points = [{ delta_s = 10, position_mm = 300, velocity_mm_per_s = 0 }]";
    // The cubic has 6·200/10·s·(1 − s) mm/s.
    for (name, points, duration, velocity) in [
        ("SMC_FollowVelocity", velocities, 0.2, 100.0),
        ("SMC_ControlAxisByVel", velocities, 0.2, 100.0),
        ("SMC_FollowPosition", positions, 0.5, 20.0),
        ("SMC_ControlAxisByPos", positions, 0.5, 20.0),
        ("SMC_FollowPositionVelocity", both, 5.0, 30.0),
        ("SMC_ControlAxisByPosVel", both, 5.0, 30.0),
    ] {
        let text = format!("duration_s = {duration:?}\n{START}{}", block(name, points));
        let setpoints = moves(&text);
        near(ends(&setpoints), duration + velocity / 3000.0, 3e-3);
        let over = setpoints.iter().find(|one| time(one) >= duration - 1e-9).unwrap();
        let braked = x(setpoints.last().unwrap())[0] - x(over)[0];
        near(braked, 0.5 * velocity * velocity / 3000.0, velocity * 2e-3);
    }
}

/// A shift that would take 10⁶ s: at rest it ends at once, and behind a master that turns when the master stops, 0.1 s later.
#[test]
fn a_shift_of_the_phase_is_halted_at_the_end_of_the_job() {
    let keys = "master = \"shaft\"; phase_shift_mm = 1; velocity_mm_per_s = 1e-6; at_s = 0";
    let shift = block("MC_Phasing", keys);
    near(ends(&moves(&format!("duration_s = 1\n{START}{}{shift}", shaft(3600.0)))), 1.0, 3e-3);
    let keys = "velocity_deg_per_s = 36; acceleration_deg_per_s2 = 360; at_s = 0";
    let turns = on("MC_MoveVelocity", "shaft", keys);
    let setpoints = moves(&format!("duration_s = 1\n{START}{}{shift}{turns}", shaft(360.0)));
    near(ends(&setpoints), 1.1, 4e-3);
}

/// A superimposed distance moves by itself, too, while the gear below rests.
#[test]
fn a_motion_on_top_of_a_slave_is_halted_at_the_end_of_the_job() {
    let gear = "master = \"shaft\"; ratio_numerator = 1; ratio_denominator = 1";
    let on_top = "distance_mm = 100; velocity_difference_mm_per_s = 1";
    let (gear, on_top) = (block("MC_GearIn", gear), block("MC_MoveSuperImposed", on_top));
    let setpoints = moves(&format!("duration_s = 1\n{START}{}{gear}{on_top}", shaft(3600.0)));
    near(ends(&setpoints), 1.0, 4e-3);
    near(x(setpoints.last().unwrap())[0], 101.0, 0.01);
}

/// 3600 deg/s that fall with 0.01 deg/s² do so for 100 hours.
#[test]
fn a_job_that_does_not_come_to_rest_is_told() {
    let keys = "velocity_deg_per_s = 3600; acceleration_deg_per_s2 = 36000";
    let turn = on("MC_MoveVelocity", "shaft", keys);
    let found = findings(&format!("duration_s = 0.5\n{}{turn}", shaft(0.01)));
    let finding = only(&found);
    assert_eq!((finding.rule, finding.axis.as_deref()), (Rule::FunctionBlock, Some("shaft")));
    assert!(finding.message.contains("600 s after `duration_s`"), "{finding:?}");
}

/// The default acceleration of a ramp of `MC_CamIn` is the axis's, and that of the deceleration the acceleration.
#[test]
fn a_cam_ramps_in_with_the_acceleration_of_its_axis() {
    let cam = "name = \"c\"\nmaster = { min = 0, max = 360, unit = \"deg\" }\n\
               slave = { min = 0, max = 100, unit = \"mm\" }\n\
               elements = [{ master = 0, slave = 0 }, { master = 360, slave = 0 }]\n";
    let with = |rates: &str| {
        let keys = "master = \"shaft\"; cam = \"c.cam.toml\"; start_mode = \"ramp_in\"; slave_offset_mm = 110; \
                    velocity_difference_mm_per_s = 50";
        let cam_in = block("MC_CamIn", &format!("{keys}{rates}"));
        let job = job(&format!("duration_s = 1\n{START}{}{cam_in}", shaft(3600.0)));
        let (setpoints, findings) = run(&job.with("c.cam.toml", cam), &machine());
        assert_eq!(findings, [], "{rates}");
        setpoints
    };
    // 10 mm at 50 mm/s with 3000 mm/s²: 0.2 s and 50/3000 s.
    let setpoints = with("");
    let arrives = setpoints.iter().find(|one| one.axes.position[0] >= 0.11 - 1e-12).unwrap();
    near(time(arrives), 0.2 + 50.0 / 3000.0, 3e-3);
    let [slow, other] =
        [("; acceleration_mm_per_s2 = 500", 500), ("", 3000)].map(|(said, rate)| {
            let both =
                format!("; acceleration_mm_per_s2 = {rate}; deceleration_mm_per_s2 = {rate}");
            let found = with(said);
            assert_eq!(found, with(&both));
            found
        });
    assert_eq!(other, setpoints);
    assert_ne!(slow, setpoints);
}

/// On X at 20 mm/s from 0 s on (0.4 mm less for its 500 mm/s²): 30 mm on top at 10 mm/s from 0.2 s on, of which 7.9 mm are done at
/// 1 s, and 10 mm back from there; a cycle is 0.01 mm. The order of the two in the file changes nothing.
#[test]
fn what_moves_on_top_is_taken_over_where_the_job_says_when() {
    let rates = "velocity_mm_per_s = 20; acceleration_mm_per_s2 = 500; at_s = 0";
    let moves_on = block("MC_MoveVelocity", rates);
    let on_top = |distance: f64, at: &str| {
        let rates = "velocity_difference_mm_per_s = 10; acceleration_mm_per_s2 = 500";
        block("MC_MoveSuperImposed", &format!("distance_mm = {distance:?}; {rates}; {at}"))
    };
    let [one, other] = [on_top(30.0, "at_s = 0.2"), on_top(-10.0, "at_s = 1")];
    for both in [format!("{one}{other}"), format!("{other}{one}")] {
        let setpoints = moves(&format!("duration_s = 3\n{START}{moves_on}{both}"));
        let over = setpoints.iter().find(|one| time(one) >= 2.5 - 1e-9).unwrap();
        near(x(over)[0], 100.0 + 20.0 * 2.5 - 0.4 + 7.9 - 10.0, 0.0101);
        near(x(over)[1], 20.0, 1e-9);
    }
    // A block that begins in the same cycle takes over from a motion that has not moved.
    let other = on_top(-10.0, "with_previous = true");
    let found = findings(&format!("duration_s = 3\n{START}{moves_on}{one}{other}"));
    let words = "MC_MoveSuperImposed of axis X has lost its axis to MC_MoveSuperImposed (line 22)";
    assert!(only(&found).message.starts_with(words), "{found:?}");
}

/// X and Y start at 100 and 50 mm, with a master that is a web.
fn head() -> String {
    START.to_owned() + &virtual_axis("web", "linear", "max_acceleration_mm_per_s2 = 500")
}

fn web(velocity: f64, keys: &str) -> String {
    let keys = format!("velocity_mm_per_s = {velocity:?}; direction = {keys}");
    on("MC_MoveVelocity", "web", &keys)
}

fn halt(keys: &str) -> String {
    on("MC_Halt", "web", keys)
}

fn in_gear(place: f64, more: &str) -> String {
    let keys = "master = \"web\"; ratio_numerator = 1; ratio_denominator = 2";
    let places = format!("master_sync_position_mm = {place:?}; slave_sync_position_mm = 110");
    block("SMC_GearInPos", &format!("{keys}; {places}; master_start_distance_mm = 10{more}"))
}

const FORWARDS: &str = "\"positive\"";

/// The master never comes back to a position that it has passed: that is reported as soon as it is known, 0.1 s into the job,
/// in both directions and also through another gear; but not if a block with a time may turn the master.
#[test]
fn who_waits_for_a_place_behind_its_master_is_told_at_once() {
    for (direction, back, place) in
        [(FORWARDS, "\"negative\"", -200.0), ("\"negative\"", FORWARDS, 200.0)]
    {
        let with = |rest: &str| format!("{}{}{rest}", head(), web(50.0, direction));
        let job = job(&with(&(in_gear(place, "") + &halt(""))));
        let (setpoints, findings) = run(&job, &machine());
        let finding = only(&findings);
        let words = format!(
            "SMC_GearInPos of axis X waits for ever: its master web moves away from {place} mm at 50 mm/s"
        );
        assert!(finding.message.starts_with(&words), "{finding:?}");
        let found = (finding.rule, finding.line, finding.axis.as_deref());
        assert_eq!(found, (Rule::FunctionBlock, 17, Some("X")));
        near(time(setpoints.last().unwrap()), 50.0 / 500.0, 4e-3);
        // In the direction of the position all is well, and so it is when the master turns at a time.
        moves(&with(&(in_gear(-place, "") + &halt(""))));
        let turns = web(50.0, &format!("{back}; at_s = 1"));
        moves(&with(&(in_gear(place, "; at_s = 0.2") + &turns + &halt("at_s = 8"))));
    }
    // X follows Y, which is in gear with the web.
    let between = on("MC_GearIn", "Y", "master = \"web\"; ratio_numerator = 1");
    let gear = in_gear(20.0, "").replace("\"web\"", "\"Y\"");
    let found = findings(&format!("{}{}{between}{gear}", head(), web(50.0, FORWARDS)));
    assert!(only(&found).message.contains("its master Y moves away from 20 mm"), "{found:?}");
}

fn trigger(when: &str) -> String {
    format!("[[triggers]]\nname = \"t\"\n{when}\n")
}

/// A trigger that has been TRUE never comes again, nor does an axis pass a position behind it.
#[test]
fn probes_whose_trigger_never_comes_are_told_at_once() {
    let probe = block("MC_TouchProbe", "trigger = \"t\"");
    for (when, words) in [
        ("at_s = 0.05", "its trigger has been TRUE at 0.05 s"),
        ("axis = \"web\"\nposition_mm = -3", "axis web moves away from -3 mm"),
    ] {
        let text = format!("{}{}{}{probe}", head(), trigger(when), web(50.0, FORWARDS));
        let (setpoints, findings) = run(&job(&text), &machine());
        assert!(only(&findings).message.contains(words), "{findings:?}");
        near(time(setpoints.last().unwrap()), 50.0 / 500.0, 6e-3);
    }
}

/// Two blocks that wait for ever: 600 s after the last change, at 0.1 s. A position that takes longer is waited for: 40 m at
/// 50 mm/s are 800 s.
#[test]
fn a_job_in_which_nothing_changes_is_ended() {
    let probe = block("MC_TouchProbe", "trigger = \"t\"; with_previous = true");
    let both =
        [&head(), &trigger("at_s = 0.05"), &web(50.0, FORWARDS), &in_gear(-200.0, ""), &probe];
    let (setpoints, findings) = run(&job(&both.map(String::as_str).concat()), &machine());
    let finding = only(&findings);
    let words = "SMC_GearInPos of axis X waits for ever: nothing has changed for 600 s; axis web goes on with 50 mm/s";
    assert_eq!((finding.message.as_str(), finding.line), (words, 20));
    near(time(setpoints.last().unwrap()), 600.1, 0.01);
    let far = [head(), web(50.0, FORWARDS), in_gear(4e4, ""), halt("")].concat();
    assert!(time(moves(&far).last().unwrap()) > 800.0);
}

/// Events that come are waited for: a trigger that is passed at constant velocity, and which the probe sees a cycle later; a
/// gear whose slave begins so slowly that nothing seems to change, 700 s after the begin; a phase shift of 620 s, after which
/// the velocity on top is braked.
#[test]
fn what_comes_is_waited_for() {
    let whole = |blocks: &[String]| {
        let (setpoints, findings) = run(&job(&(head() + &blocks.concat())), &machine());
        assert!(findings.iter().all(|it| it.severity != Severity::Error), "{findings:?}");
        time(setpoints.last().unwrap())
    };
    let probe = block("MC_TouchProbe", "trigger = \"t\"");
    for (place, direction) in [(5.0, FORWARDS), (123.37, FORWARDS), (-50.0, "\"negative\"")] {
        let trigger = trigger(&format!("axis = \"web\"\nposition_mm = {place:?}"));
        let ends = whole(&[trigger, web(50.0, direction), probe.clone(), halt("")]);
        // Up to speed in 0.1 s and 2.5 mm, to the place, and braked in 0.1 s.
        near(ends, 0.1 + (f64::abs(place) - 2.5) / 50.0 + 0.1, 5e-3);
    }
    near(whole(&[web(0.1, FORWARDS), in_gear(70.0, ""), halt("")]), 70.0 / 0.1, 0.01);
    let shift =
        block("MC_Phasing", "master = \"web\"; phase_shift_mm = 31; velocity_mm_per_s = 0.05");
    near(whole(&[web(1.0, FORWARDS), shift, halt("")]), 31.0 / 0.05, 0.1);
}
