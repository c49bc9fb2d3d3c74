//! Tests of set-points from the job, probes, and changes of cams, against closed forms.

use super::JobSetpoints;
use super::tests::{START, job, machine, moves, near, run, time};
use crate::check::{CheckOptions, check};
use crate::finding::{Finding, Rule, Severity};
use crate::setpoint::AxisSetpoint;
use crate::setpoint_source::PlanItem;

/// mm, mm/s, mm/s².
fn x(setpoint: &AxisSetpoint) -> [f64; 3] {
    let motion = &setpoint.axes;
    [motion.position[0], motion.velocity[0], motion.acceleration[0]].map(|value| value * 1e3)
}

fn at(setpoints: &[AxisSetpoint], seconds: f64) -> [f64; 3] {
    x(setpoints.iter().find(|one| (time(one) - seconds).abs() < 1e-9).unwrap())
}

fn block(name: &str, keys: &str) -> String {
    format!("[[blocks]]\nblock = \"{name}\"\naxis = \"X\"\n{keys}\n")
}

/// Velocities on straight lines: to 100 mm/s in 0.2 s (10 mm), 0.3 s with that (30 mm), to rest in 0.1 s (5 mm).
#[test]
fn velocities_from_the_job_are_followed() {
    let points = "points = [{ delta_s = 0.2, velocity_mm_per_s = 100 }, { delta_s = 0.3, velocity_mm_per_s = 100 }, \
                  { delta_s = 0.1, velocity_mm_per_s = 0 }]";
    for name in ["SMC_FollowVelocity", "SMC_ControlAxisByVel"] {
        let setpoints = moves(&(START.to_owned() + &block(name, points)));
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
    let points = "points = [{ delta_s = 0.4, position_mm = 140, velocity_mm_per_s = 0 }, \
                  { delta_s = 0.4, position_mm = 100, velocity_mm_per_s = 0 }]";
    for name in ["SMC_FollowPositionVelocity", "SMC_ControlAxisByPosVel"] {
        let setpoints = moves(&(START.to_owned() + &block(name, points)));
        near(at(&setpoints, 0.1)[0], 100.0 + 40.0 * (3.0 / 16.0 - 2.0 / 64.0), 1e-9);
        // In the middle 1.5 times the mean of 100 mm/s.
        near(at(&setpoints, 0.2)[1], 150.0, 1e-6);
        near(at(&setpoints, 0.4)[0], 140.0, 1e-9);
        near(at(&setpoints, 0.6)[0], 120.0, 1e-9);
        near(x(setpoints.last().unwrap())[0], 100.0, 1e-9);
    }
    let points =
        "points = [{ delta_s = 0.5, position_mm = 101 }, { delta_s = 0.1, position_mm = 101 }]";
    let setpoints = moves(&(START.to_owned() + &block("SMC_FollowPosition", points)));
    near(at(&setpoints, 0.25)[0], 100.5, 1e-9);
    near(at(&setpoints, 0.25)[1], 2.0, 1e-6);
    near(x(setpoints.last().unwrap())[0], 101.0, 1e-9);
}

/// A jump of 50 mm within a cycle is bridged at 100 mm/s with 1000 mm/s²: up and down in 0.1 s and 5 mm each, 40 mm between in
/// 0.4 s. The set-points wait meanwhile (`bStopIpo`).
#[test]
fn jumps_of_watched_setpoints_are_bridged() {
    let points = "points = [{ delta_s = 0.001, position_mm = 150 }, { delta_s = 0.2, position_mm = 150 }]\n\
                  gap_velocity_mm_per_s = 100\ngap_acceleration_mm_per_s2 = 1000\ngap_deceleration_mm_per_s2 = 1000";
    let setpoints = moves(&(START.to_owned() + &block("SMC_ControlAxisByPos", points)));
    near(at(&setpoints, 0.1)[0], 105.0, 1e-6);
    near(at(&setpoints, 0.3)[1], 100.0, 1e-9);
    near(at(&setpoints, 0.6)[0], 150.0, 1e-6);
    near(time(setpoints.last().unwrap()), 0.8, 5e-3);
    // A hold of 1 s begins when the jump is bridged (manual 2.2.5: the interpolator waits until then).
    let hold = points.replace("delta_s = 0.2", "delta_s = 1");
    let setpoints = moves(&(START.to_owned() + &block("SMC_ControlAxisByPos", &hold)));
    near(time(setpoints.last().unwrap()), 1.6, 5e-3);
    near(x(setpoints.last().unwrap())[0], 150.0, 1e-9);
    // Unwatched it is a jump, which the check tells.
    let unwatched = points.lines().next().unwrap();
    let setpoints = moves(&(START.to_owned() + &block("SMC_FollowPosition", unwatched)));
    near(at(&setpoints, 0.001)[0], 150.0, 1e-9);
}

/// A line of 40 mm/s from rest is more than the 3000 mm/s² of X for a cycle of 1 ms. The first set-point is 0.04 mm away, which
/// takes 2·√(0.04/3000) s from rest to rest; then the set-points come to 40 mm/s in 40/3000 s, which costs half of that.
#[test]
fn watched_lines_do_not_stutter() {
    let start = "[[start]]\naxis = \"X\"\nposition_mm = 60\n";
    let points =
        "points = [{ delta_s = 1, position_mm = 100 }, { delta_s = 0.1, position_mm = 100 }]";
    let text = start.to_owned() + &block("SMC_ControlAxisByPos", points);
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
    // From 40 mm/s to rest within a cycle, the end of the line is no jump (manual 2.2.5), but no axis can: that is told.
    let outcome = check(&machine(), &job(&text).program, CheckOptions::default(), &mut |_| {});
    let findings = outcome.unwrap().findings;
    let found = findings.iter().find(|one| one.rule == Rule::AxisAcceleration);
    let found = found.unwrap_or_else(|| panic!("{findings:?}"));
    assert_eq!((found.severity, found.axis.as_deref()), (Severity::Error, Some("X")));
    assert_eq!(found.line, 5, "{found:?}");
}

/// Behind the jump of [`jumps_of_watched_setpoints_are_bridged`], 0.6 s, set-points that move on with 40 mm/s at once: they come
/// to that within the acceleration. With velocities they end at rest, in 0.1 s with 400 mm/s², and nothing is left to be told.
#[test]
fn setpoints_that_move_on_behind_a_jump_come_to_speed() {
    let gaps = "gap_velocity_mm_per_s = 100\ngap_acceleration_mm_per_s2 = 1000\ngap_deceleration_mm_per_s2 = 1000";
    let lines =
        "points = [{ delta_s = 0.001, position_mm = 150 }, { delta_s = 1, position_mm = 190 }]";
    let cubics = "points = [{ delta_s = 0.001, position_mm = 150, velocity_mm_per_s = 40 }, \
                  { delta_s = 1, position_mm = 190, velocity_mm_per_s = 40 }, \
                  { delta_s = 0.1, position_mm = 192, velocity_mm_per_s = 0 }]";
    let lost = 0.5 * 40.0 / 3000.0;
    for (name, points, end, takes) in [
        ("SMC_ControlAxisByPos", lines, 190.0, 1.6),
        ("SMC_ControlAxisByPosVel", cubics, 192.0, 1.7),
    ] {
        let text = START.to_owned() + &block(name, &format!("{points}\n{gaps}"));
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
            let outcome =
                check(&machine(), &job(&text).program, CheckOptions::default(), &mut |_| {});
            let findings = outcome.unwrap().findings;
            assert!(findings.iter().all(|one| one.rule != Rule::AxisAcceleration), "{findings:?}");
        }
    }
}

/// Behind set-points an axis moves on from where they have left it.
#[test]
fn the_next_block_takes_over_from_setpoints() {
    let points = "points = [{ delta_s = 0.2, velocity_mm_per_s = 100 }, { delta_s = 0.2, velocity_mm_per_s = 0 }]";
    let setpoints = moves(
        &(START.to_owned()
            + &block("SMC_FollowVelocity", points)
            + &block("MC_MoveRelative", "distance_mm = -20\nvelocity_mm_per_s = 100")),
    );
    near(x(setpoints.last().unwrap())[0], 100.0, 1e-9);
}

#[test]
fn mistakes_in_setpoints_are_told() {
    for (name, keys, line, said) in [
        ("SMC_FollowVelocity", "", 1, "need `points`"),
        (
            "SMC_FollowVelocity",
            "points = [{ delta_s = 1, velocity_mm_per_s = 5 }]",
            4,
            "set-points end at rest",
        ),
        ("SMC_FollowPosition", "points = [{ delta_s = 0, position_mm = 5 }]", 4, "delta_s"),
        (
            "SMC_FollowPosition",
            "points = [{ delta_s = 1, velocity_mm_per_s = 5 }]",
            4,
            "position_mm",
        ),
        ("MC_TouchProbe", "trigger = \"mark\"", 4, "there are no [[triggers]]"),
        ("MC_MoveRelative", "at_end_of_profile = true", 4, "no MC_CamIn of the same axis"),
    ] {
        let (setpoints, findings) = run(&job(&block(name, keys)), &machine());
        assert_eq!(setpoints, [], "{keys}");
        let found = findings.iter().find(|one| one.message.contains(said) && one.line == line);
        assert!(found.is_some(), "{name} {keys}: {findings:?}");
    }
    for (trigger, line, said) in [
        ("name = \"mark\"\n", 1, "a trigger comes"),
        ("name = \"mark\"\nat_s = 1\naxis = \"X\"\nposition_mm = 1\n", 1, "a trigger comes"),
        ("name = \"mark\"\naxis = \"Q\"\nposition_mm = 1\n", 3, "no axis \"Q\""),
    ] {
        let text = format!("[[triggers]]\n{trigger}{}", block("MC_Halt", ""));
        let (_, findings) = run(&job(&text), &machine());
        let found = findings.iter().find(|one| one.message.contains(said) && one.line == line);
        assert!(found.is_some(), "{trigger}: {findings:?}");
    }
}

fn notes(findings: &[Finding]) -> Vec<&Finding> {
    findings.iter().filter(|one| one.severity == Severity::Note).collect()
}

/// From 100 mm at 200 mm/s with 1000 mm/s², of which 20 mm and 0.2 s get it to speed: at 150 mm after 0.35 s.
#[test]
fn a_probe_records_where_its_trigger_comes() {
    let head = "[[triggers]]\nname = \"time\"\nat_s = 0.35\n[[triggers]]\nname = \"place\"\naxis = \"X\"\nposition_mm = 150\n";
    let far = "distance_mm = 100\nvelocity_mm_per_s = 200\nacceleration_mm_per_s2 = 1000\nwith_previous = true";
    for name in ["time", "place"] {
        let text = head.to_owned()
            + START
            + &block("MC_TouchProbe", &format!("trigger = \"{name}\""))
            + &block("MC_MoveRelative", far);
        let (setpoints, findings) = run(&job(&text), &machine());
        let [note] = &findings[..] else { panic!("{findings:?}") };
        assert_eq!((note.rule, note.severity), (Rule::FunctionBlock, Severity::Note));
        assert_eq!((note.line, note.axis.as_deref()), (7 + 6 + 2, Some("X")));
        let words: Vec<_> = note.message.split(' ').collect();
        let position: f64 = words[words.len() - 2].parse().unwrap();
        // Within two cycles of 0.2 mm.
        near(position, 150.0, 0.4 + 1e-9);
        near(x(setpoints.last().unwrap())[0], 200.0, 1e-9);
    }
    // A window that it does not come in: the probe waits on, until it is let go.
    let window = "trigger = \"place\"\nfirst_position_mm = 160\nlast_position_mm = 170";
    let waits =
        head.to_owned() + START + &block("MC_TouchProbe", window) + &block("MC_MoveRelative", far);
    let (_, findings) = run(&job(&waits), &machine());
    assert!(findings[0].message.contains("waits for ever"), "{findings:?}");
    let let_go = waits + &block("MC_AbortTrigger", "trigger = \"place\"");
    let (_, findings) = run(&job(&let_go), &machine());
    assert_eq!(findings, []);
    // Nobody waits for it (410).
    let (_, findings) =
        run(&job(&(head.to_owned() + &block("MC_AbortTrigger", "trigger = \"time\""))), &machine());
    assert!(findings[0].message.contains("SMC_AT_TRIGGERNOTOCCUPIED"), "{findings:?}");
    assert!(notes(&findings).is_empty());
}

/// Without a direction an axis goes on as it has moved last (manual 5.3: `current`).
#[test]
fn a_velocity_without_a_direction_goes_on_as_before() {
    let on = "velocity_mm_per_s = 100\nacceleration_mm_per_s2 = 1000\n";
    for (distance, end) in [(20.0, 1.0), (-20.0, -1.0)] {
        let setpoints = moves(
            &(START.to_owned()
                + &block("MC_MoveRelative", &format!("distance_mm = {distance}\n{on}"))
                + &block("MC_MoveVelocity", on)
                + &block("MC_Halt", "deceleration_mm_per_s2 = 1000")),
        );
        // 5 mm up and 5 mm down, and a cycle or two between.
        near(x(setpoints.last().unwrap())[0], 100.0 + distance + end * 10.0, 0.3);
    }
    // One that has not moved yet goes forwards.
    let setpoints = moves(
        &(START.to_owned()
            + &block("MC_MoveVelocity", on)
            + &block("MC_Halt", "deceleration_mm_per_s2 = 1000")),
    );
    near(x(setpoints.last().unwrap())[0], 110.0, 0.3);
}

/// Cams that fit each other at their ends: 0 to 30 mm in the first turn with 30 mm a turn, and in the second on to 90 mm with
/// 60 mm a turn at its end; the slave follows the first one until its `EndOfProfile` and the other one from that cycle on.
#[test]
fn cams_are_switched_between_at_the_end_of_the_profile() {
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
    let shaft = "duration_s = 3\n[[virtual_axes]]\nname = \"shaft\"\nkind = \"rotary\"\nperiod_deg = 360\n\
                 max_acceleration_deg_per_s2 = 36000\n";
    let cam_in = |name: &str, keys: &str| {
        block(
            "MC_CamIn",
            &format!(
                "master = \"shaft\"\ncam = \"{name}.cam.toml\"\nslave_absolute = false\nperiodic = false\n{keys}"
            ),
        )
    };
    let [one, two] = [cam_in("one", ""), cam_in("two", "at_end_of_profile = true")];
    let turn = "[[blocks]]\nblock = \"MC_MoveVelocity\"\naxis = \"shaft\"\nvelocity_deg_per_s = 360\nat_s = 0\n";
    // The master's block between the two, too.
    for blocks in [format!("{one}{two}{turn}"), format!("{one}{turn}{two}")] {
        switches_at_the_end(&format!("{shaft}{START}{blocks}"), cam);
    }
    let between = format!("{one}{}{turn}{two}", block("MC_Halt", "at_s = 0.1"));
    let (_, findings) = run(&job(&format!("{shaft}{START}{between}")), &machine());
    assert!(
        findings.iter().any(|one| one.message.contains("what moves axis \"X\" before this block")),
        "{findings:?}"
    );
}

/// The two cams of `text`, as `cam` writes them, without a stop or a jump.
fn switches_at_the_end(text: &str, cam: impl Fn(&str, f64, f64) -> String) {
    let job = job(text);
    for (name, from, to) in [("one", 30.0, 30.0), ("two", 30.0, 60.0)] {
        let path = job.folder.path().join(format!("{name}.cam.toml"));
        std::fs::write(path, cam(name, from, to)).unwrap();
    }
    let mut setpoints = Vec::new();
    for item in JobSetpoints::open(&machine(), &job.program).unwrap() {
        match item {
            PlanItem::Axes(one) => setpoints.push(*one),
            other => panic!("{other:?}"),
        }
    }
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
