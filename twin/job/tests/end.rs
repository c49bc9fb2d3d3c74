//! Tests of the end of jobs and of the defaults of block inputs, against closed forms.

use super::JobSetpoints;
use super::tests::{START, job, machine, moves, near, run, time};
use crate::finding::{Finding, Rule, Severity};
use crate::setpoint::AxisSetpoint;
use crate::setpoint_source::PlanItem;

fn ends(setpoints: &[AxisSetpoint]) -> f64 {
    let last = setpoints.last().unwrap();
    let motion = &last.axes;
    assert!(motion.velocity.iter().chain(motion.acceleration.iter()).all(|value| *value == 0.0));
    time(last)
}

const SHAFT: &str = "[[virtual_axes]]\nname = \"shaft\"\nkind = \"rotary\"\nperiod_deg = 360\n\
                     max_acceleration_deg_per_s2 = 3600\n";

fn block(name: &str, keys: &str) -> String {
    format!("[[blocks]]\nblock = \"{name}\"\naxis = \"X\"\n{keys}\n")
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
        let way = |one: &AxisSetpoint| one.axes.position[0] * 1e3;
        let over = setpoints.iter().find(|one| time(one) >= duration - 1e-9).unwrap();
        let braked = way(setpoints.last().unwrap()) - way(over);
        near(braked, 0.5 * velocity * velocity / 3000.0, velocity * 2e-3);
    }
}

/// A shift that would take 10⁶ s: at rest it ends at once, and behind a master that turns when that one stands, 0.1 s later.
#[test]
fn a_shift_of_the_phase_is_halted_at_the_end_of_the_job() {
    let shift = block(
        "MC_Phasing",
        "master = \"shaft\"\nphase_shift_mm = 1\nvelocity_mm_per_s = 1e-6\nat_s = 0",
    );
    let text = format!("duration_s = 1\n{START}{SHAFT}{shift}");
    near(ends(&moves(&text)), 1.0, 3e-3);
    let turns = "[[blocks]]\nblock = \"MC_MoveVelocity\"\naxis = \"shaft\"\nvelocity_deg_per_s = 36\n\
                 acceleration_deg_per_s2 = 360\nat_s = 0\n";
    let slow = SHAFT.replace("3600", "360");
    let setpoints = moves(&format!("duration_s = 1\n{START}{slow}{shift}{turns}"));
    near(ends(&setpoints), 1.1, 4e-3);
}

/// A distance on top of a gear that stands moves by itself, too.
#[test]
fn a_motion_on_top_of_a_slave_is_halted_at_the_end_of_the_job() {
    let text = format!(
        "duration_s = 1\n{START}{SHAFT}{}{}",
        block("MC_GearIn", "master = \"shaft\"\nratio_numerator = 1\nratio_denominator = 1"),
        block("MC_MoveSuperImposed", "distance_mm = 100\nvelocity_difference_mm_per_s = 1")
    );
    let setpoints = moves(&text);
    near(ends(&setpoints), 1.0, 4e-3);
    near(setpoints.last().unwrap().axes.position[0] * 1e3, 101.0, 0.01);
}

/// 3600 deg/s that fall with 0.01 deg/s² do so for 100 hours.
#[test]
fn a_job_that_does_not_come_to_rest_is_told() {
    let text = format!(
        "duration_s = 0.5\n{}[[blocks]]\nblock = \"MC_MoveVelocity\"\naxis = \"shaft\"\n\
         velocity_deg_per_s = 3600\nacceleration_deg_per_s2 = 36000\n",
        SHAFT.replace("3600", "0.01")
    );
    let (job, machine) = (job(&text), machine());
    let mut found = Vec::new();
    for item in JobSetpoints::open(&machine, &job.program).unwrap() {
        if let PlanItem::Diagnostic(finding) = item {
            found.push(finding);
        }
    }
    let [finding] = &found[..] else { panic!("{found:?}") };
    assert_eq!((finding.rule, finding.axis.as_deref()), (Rule::FunctionBlock, Some("shaft")));
    assert!(finding.message.contains("600 s after `duration_s`"), "{finding:?}");
}

/// What a ramp of `MC_CamIn` is not told is the axis's acceleration, and that acceleration for the deceleration.
#[test]
fn a_cam_ramps_in_with_the_acceleration_of_its_axis() {
    let cam = "name = \"c\"\nmaster = { min = 0, max = 360, unit = \"deg\" }\n\
               slave = { min = 0, max = 100, unit = \"mm\" }\n\
               elements = [{ master = 0, slave = 0 }, { master = 360, slave = 0 }]\n";
    let with = |rates: &str| {
        let keys = format!(
            "master = \"shaft\"\ncam = \"c.cam.toml\"\nstart_mode = \"ramp_in\"\nslave_offset_mm = 110\n\
             velocity_difference_mm_per_s = 50\n{rates}"
        );
        let job = job(&format!("duration_s = 1\n{START}{SHAFT}{}", block("MC_CamIn", &keys)));
        std::fs::write(job.folder.path().join("c.cam.toml"), cam).unwrap();
        let (setpoints, findings) = run(&job, &machine());
        assert_eq!(findings, [], "{rates}");
        setpoints
    };
    // 10 mm at 50 mm/s with 3000 mm/s²: 0.2 s and 50/3000 s.
    let setpoints = with("");
    let arrives = setpoints.iter().find(|one| one.axes.position[0] >= 0.11 - 1e-12).unwrap();
    near(time(arrives), 0.2 + 50.0 / 3000.0, 3e-3);
    assert_eq!(setpoints, with("acceleration_mm_per_s2 = 3000\ndeceleration_mm_per_s2 = 3000"));
    let slow = with("acceleration_mm_per_s2 = 500");
    assert_eq!(slow, with("acceleration_mm_per_s2 = 500\ndeceleration_mm_per_s2 = 500"));
    assert_ne!(slow, setpoints);
}

fn message(text: &str) -> Vec<Finding> {
    let (_, findings) = run(&job(text), &machine());
    findings
}

/// On X at 20 mm/s from 0 s on (0.4 mm less for its 500 mm/s²): 30 mm on top at 10 mm/s from 0.2 s on, of which 7.9 mm are done at
/// 1 s, and 10 mm back from there; a cycle is 0.01 mm. How the two stand in the file changes nothing.
#[test]
fn what_moves_on_top_is_taken_over_where_the_job_says_when() {
    let moves_on =
        block("MC_MoveVelocity", "velocity_mm_per_s = 20\nacceleration_mm_per_s2 = 500\nat_s = 0");
    let on_top = |distance: f64, at: &str| {
        let rates = "velocity_difference_mm_per_s = 10\nacceleration_mm_per_s2 = 500";
        block("MC_MoveSuperImposed", &format!("distance_mm = {distance:?}\n{rates}\n{at}"))
    };
    let blocks = [on_top(30.0, "at_s = 0.2"), on_top(-10.0, "at_s = 1")];
    for order in [[0, 1], [1, 0]] {
        let [one, other] = order.map(|index: usize| blocks[index].clone());
        let setpoints = moves(&format!("duration_s = 3\n{START}{moves_on}{one}{other}"));
        let over = setpoints.iter().find(|one| time(one) >= 2.5 - 1e-9).unwrap();
        near(over.axes.position[0] * 1e3, 100.0 + 20.0 * 2.5 - 0.4 + 7.9 - 10.0, 0.0101);
        near(over.axes.velocity[0] * 1e3, 20.0, 1e-9);
    }
    // One that begins in the same cycle has taken over from nobody who has moved.
    let found = message(&format!(
        "duration_s = 3\n{START}{moves_on}{}{}",
        on_top(30.0, "at_s = 0.2"),
        on_top(-10.0, "with_previous = true")
    ));
    let [finding] = found.as_slice() else { panic!("{found:?}") };
    let words = "MC_MoveSuperImposed of axis X has lost its axis to MC_MoveSuperImposed (line 22)";
    assert!(finding.message.starts_with(words), "{finding:?}");
}

const WEB: &str =
    "[[virtual_axes]]\nname = \"web\"\nkind = \"linear\"\nmax_acceleration_mm_per_s2 = 500\n";

fn web(velocity: f64, direction: &str) -> String {
    format!(
        "[[blocks]]\nblock = \"MC_MoveVelocity\"\naxis = \"web\"\nvelocity_mm_per_s = {velocity:?}\ndirection = \"{direction}\"\n"
    )
}

fn in_gear(place: f64, more: &str) -> String {
    block(
        "SMC_GearInPos",
        &format!(
            "master = \"web\"\nratio_numerator = 1\nratio_denominator = 2\nmaster_sync_position_mm = {place:?}\n\
             slave_sync_position_mm = 110\nmaster_start_distance_mm = 10\n{more}"
        ),
    )
}

/// A place that the master has left behind never comes: that is told as soon as it is known, 0.1 s into the job, whichever way
/// it goes and also by way of another gear; not where a block that begins at a time may turn it.
#[test]
fn who_waits_for_a_place_behind_its_master_is_told_at_once() {
    let halt = "[[blocks]]\nblock = \"MC_Halt\"\naxis = \"web\"\n";
    for (direction, place, sign) in [("positive", -200.0, 1.0), ("negative", 200.0, -1.0)] {
        let job = job(&format!("{START}{WEB}{}{}{halt}", web(50.0, direction), in_gear(place, "")));
        let (setpoints, findings) = run(&job, &machine());
        let [finding] = findings.as_slice() else { panic!("{findings:?}") };
        let words = format!(
            "SMC_GearInPos of axis X waits for ever: its master web moves away from {place} mm with 50 mm/s"
        );
        assert!(finding.message.starts_with(&words), "{finding:?}");
        let told = (finding.rule, finding.line, finding.axis.as_deref());
        assert_eq!(told, (Rule::FunctionBlock, 17, Some("X")));
        near(time(setpoints.last().unwrap()), 50.0 / 500.0, 4e-3);
        // In the direction of the place all is well, and so it is where the master turns at a time.
        moves(&format!("{START}{WEB}{}{}{halt}", web(50.0, direction), in_gear(-place, "")));
        let back = if sign > 0.0 { "negative" } else { "positive" };
        let turns = format!("{}at_s = 1\n", web(50.0, back));
        let gear = in_gear(place, "at_s = 0.2");
        let after = "[[blocks]]\nblock = \"MC_Halt\"\naxis = \"web\"\nat_s = 8\n";
        moves(&format!("{START}{WEB}{}{gear}{turns}{after}", web(50.0, direction)));
    }
    // X follows Y, which is in gear with the web.
    let between =
        "[[blocks]]\nblock = \"MC_GearIn\"\naxis = \"Y\"\nmaster = \"web\"\nratio_numerator = 1\n";
    let gear = in_gear(20.0, "").replace("\"web\"", "\"Y\"");
    let found = message(&format!("{START}{WEB}{between}{}{gear}", web(50.0, "positive")));
    let [finding] = found.as_slice() else { panic!("{found:?}") };
    assert!(finding.message.contains("its master Y moves away from 20 mm"), "{finding:?}");
}

/// A trigger that has been TRUE is not again, and a place behind an axis is not passed.
#[test]
fn probes_whose_trigger_never_comes_are_told_at_once() {
    let probe = block("MC_TouchProbe", "trigger = \"t\"");
    for (when, words) in [
        ("at_s = 0.05", "its trigger has been TRUE at 0.05 s"),
        ("axis = \"web\"\nposition_mm = -3", "axis web moves away from -3 mm"),
    ] {
        let trigger = format!("[[triggers]]\nname = \"t\"\n{when}\n");
        let job = job(&format!("{START}{WEB}{trigger}{}{probe}", web(50.0, "positive")));
        let (setpoints, findings) = run(&job, &machine());
        let [finding] = findings.as_slice() else { panic!("{findings:?}") };
        assert!(finding.message.contains(words), "{finding:?}");
        near(time(setpoints.last().unwrap()), 50.0 / 500.0, 6e-3);
    }
}

/// Two that wait for what never comes: 600 s after the last change, at 0.1 s. A place that is farther away than that is waited
/// for: 40 m at 50 mm/s are 800 s.
#[test]
fn a_job_in_which_nothing_changes_is_ended() {
    let late = "[[triggers]]\nname = \"t\"\nat_s = 0.05\n";
    let probe = |keys: &str| block("MC_TouchProbe", &format!("trigger = \"t\"\n{keys}"));
    let both = format!(
        "{START}{WEB}{late}{}{}{}",
        web(50.0, "positive"),
        in_gear(-200.0, ""),
        probe("with_previous = true")
    );
    let (setpoints, findings) = run(&job(&both), &machine());
    let [finding] = findings.as_slice() else { panic!("{findings:?}") };
    let words = "SMC_GearInPos of axis X waits for ever: nothing has changed for 600 s; axis web goes on with 50 mm/s";
    assert_eq!((finding.message.as_str(), finding.line), (words, 20));
    near(time(setpoints.last().unwrap()), 600.1, 0.01);
    let halt = "[[blocks]]\nblock = \"MC_Halt\"\naxis = \"web\"\n";
    let setpoints =
        moves(&format!("{START}{WEB}{}{}{halt}", web(50.0, "positive"), in_gear(4e4, "")));
    assert!(time(setpoints.last().unwrap()) > 800.0);
}

/// What comes is waited for: a trigger that is passed at constant velocity, and which the probe sees a cycle later; a gear whose
/// slave begins so gently that nothing seems to change, 700 s after the begin; a phase shift of 620 s, behind which the velocity
/// on top is braked.
#[test]
fn what_comes_is_waited_for() {
    let halt = "[[blocks]]\nblock = \"MC_Halt\"\naxis = \"web\"\n";
    let whole = |text: &str| {
        let (setpoints, findings) = run(&job(text), &machine());
        assert!(findings.iter().all(|it| it.severity != Severity::Error), "{findings:?}");
        time(setpoints.last().unwrap())
    };
    let probe = block("MC_TouchProbe", "trigger = \"t\"");
    for (place, direction) in [(5.0, "positive"), (123.37, "positive"), (-50.0, "negative")] {
        let trigger =
            format!("[[triggers]]\nname = \"t\"\naxis = \"web\"\nposition_mm = {place:?}\n");
        let ends = whole(&format!("{START}{WEB}{trigger}{}{probe}{halt}", web(50.0, direction)));
        // Up to speed in 0.1 s and 2.5 mm, to the place, and braked in 0.1 s.
        near(ends, 0.1 + (f64::abs(place) - 2.5) / 50.0 + 0.1, 5e-3);
    }
    let gear = in_gear(70.0, "");
    let ends = whole(&format!("{START}{WEB}{}{gear}{halt}", web(0.1, "positive")));
    near(ends, 70.0 / 0.1, 0.01);
    let shift = "master = \"web\"\nphase_shift_mm = 31\nvelocity_mm_per_s = 0.05\n";
    let shift = block("MC_Phasing", shift);
    let ends = whole(&format!("{START}{WEB}{}{shift}{halt}", web(1.0, "positive")));
    near(ends, 31.0 / 0.05, 0.1);
}
